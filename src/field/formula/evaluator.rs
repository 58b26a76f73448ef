//! The evaluator of a formula, and of its smooth branches.

use super::branches::Branches;
use super::compiled::Compiled;
use super::graph::Id;
use super::interval::{BoxRows, FactorProgram};
use super::scalar::ABREAST;
use super::{Formula, eval, scalar};
use crate::field::{Bounded, Enclosure, Evaluator, Frame, Jet, Pieces};
use crate::math::{Bounds, Interval, LANES, Lanes, Sym3};
use crate::slices;
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Evaluates a formula or one of its smooth branches.
pub(super) struct FormulaEvaluator<'a> {
    formula: &'a Formula,
    frame: Frame,
    /// The compiled function that is evaluated instead of f: a branch, or f with the factors of
    /// products as choices.
    instead: Option<Arc<Compiled>>,
    /// Whether one branch is evaluated.
    is_branch: bool,
    /// The evaluator of the branch that was used last.
    branch: Option<Box<FormulaEvaluator<'a>>>,
    registers: Vec<Lanes>,
    /// Values of the nodes in double precision, with first and second derivatives, with first ones,
    /// and alone.
    jets: scalar::JetScratch,
    slopes: scalar::Jets<0>,
    /// Jets with first derivatives at several points.
    abreast: scalar::Jets<0, ABREAST>,
    doubles: Vec<f64>,
    bounds: Option<FormulaBounds>,
}

/// Memory of the bounds of a function.
struct FormulaBounds {
    /// The factors of f; if the surface has creases, those of each branch; if choices keep sheets
    /// apart, those of each sheet.
    factors: Vec<Factor>,
    /// f as a whole, if its branches meet in edges and bounds of them suffice for proofs.
    whole: Option<Factor>,
    /// Branches, and functions at the edges of some, whose bounds were asked for; by their nodes.
    pieces: Vec<(Id, Factor)>,
    /// Boxes in the coordinates of the formula.
    boxes: Vec<Bounds>,
}

/// The function that a factor belongs to.
#[derive(Clone, Copy)]
enum FactorOf {
    /// The function that is evaluated.
    Whole,
    /// The branch of this number.
    Branch(u32),
    /// The sheet of this index.
    Sheet(usize),
}

struct Factor {
    of: FactorOf,
    program: FactorProgram,
    first: BoxRows,
    second: BoxRows,
}

impl Factor {
    fn new(of: FactorOf, program: FactorProgram) -> Self {
        Self { of, program, first: BoxRows::default(), second: BoxRows::default() }
    }

    /// Bounds over a box, with the mean value forms, and in its middle.
    fn tight(&mut self, bounds: &Bounds) -> [Enclosure; 2] {
        let Self { program, first, second, .. } = self;
        let mut known = [Enclosure::UNKNOWN; 2];
        program.first.enclose(first, &[*bounds, Bounds::point(bounds.middle())], &mut known);
        let mut of_second = [Sym3::splat(Interval::EVERYTHING)];
        if let Some(program) = &program.second {
            program.enclose_second(second, &[*bounds], &mut of_second);
        }
        let [mut known, middle] = known;
        known.tighten(&middle, &of_second[0], 0.5 * bounds.size());
        [known, middle]
    }
}

impl FormulaBounds {
    /// The factor of this number; the number after the last is that of the whole.
    fn factor(&mut self, number: usize) -> (&mut Factor, &mut Vec<Bounds>) {
        let own = self.factors.get_mut(number).or(self.whole.as_mut());
        (own.expect("a factor of the field"), &mut self.boxes)
    }
}

impl<'a> FormulaEvaluator<'a> {
    pub(super) fn new(formula: &'a Formula, frame: Frame) -> Self {
        let instead = formula.branches.lock().split.clone();
        Self::of(formula, frame, instead, false)
    }

    fn of(formula: &'a Formula, frame: Frame, instead: Option<Arc<Compiled>>, is_branch: bool) -> Self {
        Self {
            formula,
            frame,
            instead,
            is_branch,
            branch: None,
            registers: Vec::new(),
            jets: Vec::new(),
            slopes: Vec::new(),
            abreast: Vec::new(),
            doubles: Vec::new(),
            bounds: None,
        }
    }

    /// Runs `find` on the branches of the formula, with the values of its parameters.
    fn on_branches<R>(&self, find: impl FnOnce(&mut Branches, &[f64]) -> R) -> R {
        find(&mut self.formula.branches.lock(), &self.formula.values)
    }

    /// The bounds of f, or of the branch that is evaluated.
    fn bounds(&mut self) -> &mut FormulaBounds {
        let Self { formula, instead, is_branch, bounds, .. } = self;
        bounds.get_or_insert_with(|| {
            let values = &formula.values;
            let mut branches = formula.branches.lock();
            let mut programs: Vec<(FactorOf, FactorProgram)> = Vec::new();
            let mut add = |of: FactorOf, own: &[FactorProgram]| {
                programs.extend(own.iter().map(|program| (of, program.clone())));
            };
            if !*is_branch {
                for (number, own) in branches.factors.clone() {
                    let compiled = branches.compiled(number, values).expect("a branch that has factors");
                    add(FactorOf::Branch(number), &compiled.factors()[own..=own]);
                }
                for (k, sheet) in branches.sheets.iter().enumerate() {
                    add(FactorOf::Sheet(k), &sheet.programs);
                }
            }
            if programs.is_empty() {
                let own = instead.as_ref().filter(|_| *is_branch).map_or(&formula.compiled, |branch| branch);
                programs.extend(own.factors().iter().map(|program| (FactorOf::Whole, program.clone())));
            }
            // Where factors cross, no direction leads out of all of them; limits end the surface.
            let is_edged = !*is_branch
                && !branches.factors.is_empty()
                && branches.products.is_empty()
                && !branches.is_rewritten
                && !branches.has_limits();
            let whole = is_edged.then(|| Factor::new(FactorOf::Whole, formula.compiled.whole()));
            let factors = programs.into_iter().map(|(of, program)| Factor::new(of, program)).collect();
            FormulaBounds { factors, whole, pieces: Vec::new(), boxes: Vec::new() }
        })
    }
}

/// The compiled function that is evaluated. A method would borrow the buffers, too.
fn active<'b>(formula: &'b Formula, instead: &'b Option<Arc<Compiled>>) -> &'b Compiled {
    instead.as_deref().unwrap_or(&formula.compiled)
}

impl Evaluator for FormulaEvaluator<'_> {
    fn frame(&self) -> Frame {
        self.frame
    }

    fn another(&self) -> Box<dyn Evaluator + '_> {
        Box::new(Self::of(self.formula, self.frame, self.instead.clone(), self.is_branch))
    }

    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        let (compiled, frame) = (active(self.formula, &self.instead), self.frame);
        if frame.is_double() {
            for (&p, value) in points.iter().zip(value) {
                *value = frame.value(compiled.value(frame.place(p.as_dvec3()), &mut self.doubles));
            }
            return;
        }
        let value = &mut value[..points.len()];
        eval::run(&compiled.value_program, &mut self.registers, points, |first, [f]| {
            value[first..].iter_mut().zip(f.0).for_each(|(value, f)| *value = f * frame.scale);
        });
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        let (compiled, frame) = (active(self.formula, &self.instead), self.frame);
        if frame.is_double() {
            for (k, &p) in points.iter().enumerate() {
                let exact = compiled.gradient(frame.place(p.as_dvec3()), &mut self.doubles);
                (value[k], gradient[k]) = frame.gradient(exact);
            }
            return;
        }
        let (value, gradient) = (&mut value[..points.len()], &mut gradient[..points.len()]);
        let store = |first: usize, [f, x, y, z]: [&Lanes; 4]| {
            let slots = value[first..].iter_mut().zip(&mut gradient[first..]);
            for (k, (value, gradient)) in slots.take(LANES).enumerate() {
                *value = f.0[k] * frame.scale;
                *gradient = Vec3::new(x.0[k], y.0[k], z.0[k]) * frame.scale;
            }
        };
        eval::run(&compiled.gradient_program, &mut self.registers, points, store);
    }

    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        let (compiled, frame) = (active(self.formula, &self.instead), self.frame);
        if frame.is_double() {
            for (k, &p) in points.iter().enumerate() {
                let jet = compiled.jet(frame.place(p.as_dvec3()), &mut self.jets);
                (value[k], gradient[k], hessian[k]) = frame.hessian(&jet);
            }
            return;
        }
        let n = points.len();
        let (value, gradient, hessian) = (&mut value[..n], &mut gradient[..n], &mut hessian[..n]);
        let store = |first: usize, results: [&Lanes; 10]| {
            let slots = value[first..].iter_mut().zip(&mut gradient[first..]).zip(&mut hessian[first..]);
            for (k, ((value, gradient), hessian)) in slots.take(LANES).enumerate() {
                let [f, x, y, z, xx, xy, xz, yy, yz, zz] = results.map(|lanes| lanes.0[k] * frame.scale);
                (*value, *gradient) = (f, Vec3::new(x, y, z));
                *hessian = Sym3 { xx, xy, xz, yy, yz, zz };
            }
        };
        eval::run(compiled.hessian_program(), &mut self.registers, points, store);
    }

    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        let compiled = active(self.formula, &self.instead);
        let [result] = compiled.first_order([self.frame.place(p)], &mut self.slopes);
        self.frame.exact(result)
    }

    fn exact_gradients(&mut self, points: &[Vec3], value: &mut [f64], gradient: &mut [DVec3]) {
        let (compiled, frame) = (active(self.formula, &self.instead), self.frame);
        let outputs = value.chunks_mut(ABREAST).zip(gradient.chunks_mut(ABREAST));
        for (points, (value, gradient)) in points.chunks(ABREAST).zip(outputs) {
            // The last group is padded with its first point.
            let place = |k: usize| frame.place(points.get(k).unwrap_or(&points[0]).as_dvec3());
            let results = compiled.first_order(core::array::from_fn(place), &mut self.abreast);
            for ((value, gradient), result) in value.iter_mut().zip(gradient).zip(results).take(points.len())
            {
                (*value, *gradient) = frame.exact(result);
            }
        }
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        let compiled = active(self.formula, &self.instead);
        self.frame.jet(compiled.jet(self.frame.place(p), &mut self.jets))
    }

    fn bounded(&mut self) -> Option<&mut dyn Bounded> {
        self.bounds();
        Some(self)
    }

    fn pieces(&mut self) -> Option<&mut dyn Pieces> {
        Some(self)
    }
}

impl Pieces for FormulaEvaluator<'_> {
    /// The numbers do not depend on earlier requests, except those beyond the first 256.
    fn label(&mut self, p: DVec3) -> u32 {
        let place = self.frame.place(p);
        self.on_branches(|branches, values| branches.patch_at(values, place))
    }

    fn labels_in(&mut self, bounds: &Bounds) -> Option<Vec<u32>> {
        let bounds = self.frame.outward(bounds);
        self.on_branches(|branches, values| branches.patches_within(values, &bounds))
    }

    fn tangent_pairs(&mut self) -> Vec<[u32; 2]> {
        self.on_branches(|branches, _| branches.apart.clone())
    }

    fn has_limits(&mut self) -> bool {
        self.on_branches(|branches, _| branches.has_limits())
    }

    fn is_limit(&mut self, branch: u32) -> bool {
        self.on_branches(|branches, values| branches.is_limit(branch, values))
    }

    fn piece(&mut self, label: u32) -> &mut dyn Evaluator {
        let compiled = self.on_branches(|branches, values| branches.patch(label, values));
        let (formula, frame) = (self.formula, self.frame);
        let own = self.branch.get_or_insert_with(|| Box::new(Self::of(formula, frame, None, true)));
        let is_same = match (&own.instead, &compiled) {
            (Some(known), Some(compiled)) => Arc::ptr_eq(known, compiled),
            (None, None) => true,
            _ => false,
        };
        if !is_same {
            (own.instead, own.bounds) = (compiled, None);
        }
        &mut **own
    }

    fn edge_cells(&mut self, bounds: &Bounds, width: f64) -> Vec<Bounds> {
        let bounds = self.frame.outward(bounds);
        let cells = self
            .on_branches(|branches, values| slices::complete(branches.cells_between(values, &bounds, width)));
        cells.iter().map(|cell| cell.relative_to(self.frame.origin)).collect()
    }
}

impl Bounded for FormulaEvaluator<'_> {
    fn operations(&self) -> usize {
        self.formula.compiled.value_program.instructions.len()
    }

    fn factors(&self) -> usize {
        self.bounds.as_ref().map_or(0, |bounds| bounds.factors.len())
    }

    fn enclose(&mut self, factor: usize, boxes: &[Bounds], out: &mut [Enclosure]) {
        let (frame, formula, is_branch) = (self.frame, self.formula, self.is_branch);
        let (Factor { of, program, first, .. }, moved) = self.bounds().factor(factor);
        let boxes = in_formula(frame, boxes, moved);
        program.first.enclose(first, boxes, out);
        let (mut branches, values) = (formula.branches.lock(), &formula.values);
        match *of {
            FactorOf::Branch(branch) => branches.leave_out(branch, values, boxes, out),
            FactorOf::Sheet(sheet) => branches.leave_out_sheet(sheet, values, boxes, out),
            FactorOf::Whole if !is_branch => branches.leave_out_limits(values, boxes, out),
            FactorOf::Whole => {}
        }
        frame.scale_bounds(&mut out[..boxes.len()]);
    }

    fn gives(&mut self, factor: usize, p: DVec3) -> bool {
        let of = self.bounds().factor(factor).0.of;
        let place = self.frame.place(p);
        self.on_branches(|branches, values| match of {
            FactorOf::Whole => true,
            FactorOf::Branch(branch) => branches.at(values, place) == branch,
            FactorOf::Sheet(sheet) => branches.is_on_sheet(sheet, values, place),
        })
    }

    fn edged(&mut self) -> Option<usize> {
        let bounds = self.bounds();
        bounds.whole.as_ref().map(|_| bounds.factors.len())
    }

    fn pieces_in(&mut self, bounds: &Bounds, out: &mut Vec<Enclosure>) -> bool {
        let (frame, formula) = (self.frame, self.formula);
        let FormulaBounds { whole: Some(whole), pieces, boxes: moved, .. } = self.bounds() else {
            return false;
        };
        out.clear();
        let mut of_whole = [Enclosure::UNKNOWN];
        let here = in_formula(frame, core::slice::from_ref(bounds), moved);
        whole.program.first.enclose(&mut whole.first, here, &mut of_whole);
        let [Enclosure { defined, continuous, may_vanish, .. }] = of_whole;
        if !may_vanish {
            return true;
        }
        let (mut branches, values) = (formula.branches.lock(), &formula.values);
        let Some((numbers, edges)) = branches.met_in(values, &here[0]) else { return false };
        let mut enclosed = |branches: &Branches, node: Id| {
            let k = pieces.iter().position(|piece| piece.0 == node).unwrap_or_else(|| {
                let program = branches.bounds_of(node, values);
                pieces.push((node, Factor::new(FactorOf::Whole, program)));
                pieces.len() - 1
            });
            let [mut piece, middle] = pieces[k].1.tight(&here[0]);
            piece.defined &= defined;
            piece.continuous &= continuous;
            [piece, middle]
        };
        let may_vanish = |[piece, _]: &[Enclosure; 2]| piece.may_vanish && !piece.value.excludes_zero();
        let mut found: Vec<[Enclosure; 2]> = Vec::new();
        for number in numbers {
            found.extend(Some(enclosed(&branches, branches.root_of(number))).filter(may_vanish));
        }
        for part in edges {
            match branches.edge_in(part, values, &here[0]) {
                None => {}
                Some(functions) if functions.is_empty() => found.push([Enclosure::UNKNOWN; 2]),
                Some(functions) => {
                    // It vanishes where all of them do.
                    let known: Vec<[Enclosure; 2]> =
                        functions.into_iter().map(|node| enclosed(&branches, node)).collect();
                    found.extend(known.iter().filter(|_| known.iter().all(may_vanish)));
                }
            }
        }
        out.extend([0, 1].into_iter().flat_map(|place| found.iter().map(move |piece| piece[place])));
        frame.scale_bounds(out);
        true
    }

    fn enclose_second(&mut self, factor: usize, boxes: &[Bounds], out: &mut [Sym3<Interval>]) {
        let frame = self.frame;
        let (Factor { program, second, .. }, moved) = self.bounds().factor(factor);
        match &program.second {
            Some(program) => program.enclose_second(second, in_formula(frame, boxes, moved), out),
            None => out[..boxes.len()].fill(Sym3::splat(Interval::EVERYTHING)),
        }
        frame.scale_second(&mut out[..boxes.len()]);
    }
}

/// Boxes in the coordinates of the formula that hold these boxes of the frame.
fn in_formula<'b>(frame: Frame, boxes: &'b [Bounds], moved: &'b mut Vec<Bounds>) -> &'b [Bounds] {
    if frame.origin == DVec3::ZERO {
        return boxes;
    }
    moved.clear();
    moved.extend(boxes.iter().map(|bounds| frame.outward(bounds)));
    moved
}
