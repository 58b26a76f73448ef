//! Fields given by a formula such as `x^2/a^2 + y^2/b^2 + z^2/c^2 = 1`.
//!
//! # Language
//!
//! A formula consists of the coordinates `x y z`, numbers, the constants `pi`, `e`, `tau` and `phi`
//! (the golden ratio), named parameters, the operators `+ - * / % ^`, brackets, and the functions
//! of [`FUNCTIONS`]. At most one `=` stands for the difference of its sides. A product may be
//! written without `*` where there is only one reading: `2x`, `x y`, `xyz`, `3(x + 1)`. `^` is
//! right-associative and binds more tightly than a leading sign: `-x^2` is −(x²). `2e3` is two
//! thousand, `2e` is twice Euler's number. Superscript digits, `−`, `×`, `·`, `÷`, `√`, `π`, `τ`,
//! `φ` and full-width characters are accepted.
//!
//! A fraction of two numbers multiplies what stands beside it: `9/4y^2` is (9/4)y² and `1/2x` is
//! (1/2)x. Beside any other divisor, and for what is a number itself, as in `1/2pi`, there are two
//! readings, which the error offers.
//!
//! `if(c, a, b)` and `c ? a : b` choose by a condition: comparisons by `<`, `<=`, `>`, `>=`, joined
//! by `and`, `or` and `not` (`&&`, `||`, `!`). `a % b` is `mod(a, b)`, with the sign of b.
//!
//! Definitions come before the surface, each ended by a `;` or its line:
//! `r = hypot(x, y); (r - 1)^2 + z^2 = 0.1`, `f(a, b) = a^2 + b^2; f(x, y) = z`. Comments are
//! `// …`, `# …`, `/* … */` and `(* … *)`.
//!
//! Other ways to write the same are read too: `|x|`, `**` and `==`, brackets of any kind, a
//! function without brackets where there is one reading (`sin 2x`, `sin^2 x cos y`, but not `sin x
//! y`), the head of a definition `f(x, y, z) = …`, what LaTeX has for all this (`\frac{1}{2}`,
//! `\sqrt[3]{x}`, `\left|x\right|`, `\sin\theta`), and what programs write: `x.^2`, `np.sin(x)`,
//! `Sin[x]`, `pow(x, 2.0f)`, `length(vec3(x, y, z))`, `lambda x, y, z: …`.
//!
//! An unknown name becomes an *automatic* parameter, unless it looks like a misspelling, or like
//! functions written as one with their arguments: `xsinx`. A text with several readings is an error
//! that offers each of them.
//!
//! # Evaluation
//!
//! The text is parsed to a syntax tree, which is translated to a graph in static single-assignment form. The graph is
//! evaluated as a second-order jet in double precision, in interval arithmetic over a few boxes at a time and, compiled
//! to a straight-line program, in single precision over batches of points. Gradient and Hessian are graphs too, derived
//! from that of f. Where f takes one of two operands, as a maximum does, each of its smooth branches is a graph as well.

mod ast;
mod branches;
mod build;
mod call;
mod compiled;
mod conditions;
mod control;
mod creases;
mod derivative;
mod display;
mod double;
mod elsewhere;
mod error;
mod eval;
mod graph;
mod interval;
mod latex;
mod lex;
mod mathml;
mod names;
mod operations;
mod parse;
mod periods;
mod powers;
mod program;
mod repair;
mod scalar;
mod solids;
mod spelling;
mod statements;
#[cfg(test)]
mod tests;
mod token;

pub use ast::{FUNCTIONS, FunctionInfo};
pub use control::Grip;
pub use error::{FormulaError, FormulaErrorKind, Mended, utf16_offset};
pub use lex::name_pattern;
pub use mathml::{MathGroup, MathNode, MathToken};

use super::{Bounded, BranchNumbers, Branched, Enclosure, Field, Jet, UnitCell};
use crate::math::{Bounds, Interval, LANES, Lanes, Sym3};
use crate::slices::Work;
use ast::Equation;
use branches::Branches;
use compiled::Compiled;
use glam::{DVec3, Vec3};
use graph::{Graph, Id};
use serde::{Deserialize, Serialize};
use solids::Solid;
use std::borrow::Cow;

/// Maximum length of a formula in bytes of UTF-8. Longer text is refused before it is parsed, so that the time that a typed character
/// takes is bounded: a sum of this length is parsed and compiled in a millisecond, a product of five hundred factors in nine.
pub const MAX_FORMULA_BYTES: usize = 4096;

/// Maximum nesting of brackets, calls, signs and exponents. So deep a formula takes less than 256 kB of stack, of the 1 MiB that there is in
/// WebAssembly.
pub const MAX_DEPTH: usize = 64;

/// Maximum number of operations of a formula: one for each byte, which only powers can exceed. An integer power counts as its products.
pub const MAX_OPERATIONS: usize = MAX_FORMULA_BYTES;

/// A named number of a formula, which can be changed without parsing the formula again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Parameter {
    /// Name in the formula.
    pub name: Cow<'static, str>,
    /// Label for the user.
    pub label: Cow<'static, str>,
    /// Current value.
    pub value: f64,
    /// Smallest value of the slider.
    pub min: f64,
    /// Largest value of the slider.
    pub max: f64,
    /// Step of the slider.
    pub step: f64,
}

impl Parameter {
    /// Automatic parameter of an unknown name, with value 1 and a slider from 0 to 3.
    #[must_use]
    pub fn automatic(name: &str) -> Self {
        Self {
            name: name.to_owned().into(),
            label: name.to_owned().into(),
            value: 1.0,
            min: 0.0,
            max: 3.0,
            step: 0.01,
        }
    }
}

/// Field f(x, y, z) given by a formula.
///
/// Batched evaluation does not allocate once it is warm; the Hessian and the bounds are compiled when first asked for.
///
/// ```
/// use marching_particles::{Field, Formula};
///
/// let mut field = Formula::parse("x^2/a^2 + y^2 + z^2 = 1")?.with("a", 2.0)?;
/// let jet = field.jet((2.0, 0.0, 0.0).into());
/// assert_eq!((jet.value, jet.gradient.x), (0.0, 1.0));
///
/// let error = Formula::parse("x^2 + sin y z").unwrap_err();
/// assert_eq!((error.span.clone(), error.suggestion.as_deref()), (6..11, Some("sin(y)")));
/// # Ok::<(), marching_particles::FormulaError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Formula {
    text: String,
    equation: Equation,
    /// Equation of the same surface that is evaluated instead, if [`Formula::without_powers`] has found one.
    simplified: Option<Equation>,
    /// The graph of the surface, and its node, from which a solid is made.
    surface: (Graph, Id),
    /// The solid that is sampled in place of the surface, if one is: a sheet of some thickness, closed by a box or not.
    solid: Solid,
    parameters: Vec<Parameter>,
    /// Names of the parameters that were not declared.
    automatic: Vec<String>,
    /// Declared names that the formula does not use.
    unused: Vec<String>,
    /// Values of `parameters`, as the compiled formula takes them.
    values: Vec<f64>,
    compiled: Compiled,
    /// The smooth branches of f, one of which may be evaluated in its place.
    branches: Branches,
    scratch: EvaluationScratch,
    /// The scale of arsinh(f/s), which the batched methods give in double precision; they give f without one.
    double: Option<f64>,
    /// The point from which positions are counted, [`Field::origin`].
    origin: DVec3,
}

/// Memory that evaluations use again.
#[derive(Clone, Debug, Default)]
struct EvaluationScratch {
    registers: Vec<Lanes>,
    /// Values of the nodes in double precision, with derivatives up to the second, with first ones, and alone.
    jets: scalar::JetScratch,
    slopes: Vec<scalar::ForwardJet<0>>,
    doubles: Vec<f64>,
    /// Boxes in the coordinates of the formula.
    boxes: Vec<Bounds>,
}

impl Formula {
    /// The field of a formula, whose unknown names become parameters: see [`Formula::with`].
    ///
    /// Powers and repeated factors stand once in what is evaluated, which has the same surface and a gradient on it.
    ///
    /// # Errors
    ///
    /// Any of [`FormulaErrorKind`], with its span in bytes of `text`.
    pub fn parse(text: &str) -> Result<Self, FormulaError> {
        Ok(Self::as_written(text, &[])?.without_powers())
    }

    /// Returns the formula with another value of a parameter. Parameters that [`Formula::parse`] finds have the value 1.
    ///
    /// # Errors
    ///
    /// [`FormulaErrorKind::BadParameter`] if there is no such parameter or the value is not finite.
    pub fn with(mut self, name: &str, value: f64) -> Result<Self, FormulaError> {
        self.set_parameter(name, value)?;
        Ok(self)
    }

    /// Parses and compiles a formula, to be evaluated as it is written.
    ///
    /// The field's parameters are those of `declared` that occur in the text, in the order of declaration, followed by
    /// the unknown names as automatic parameters, in order of appearance.
    ///
    /// # Errors
    ///
    /// Any of [`FormulaErrorKind`], with its span in bytes of `text`. The time and memory that it takes to find an
    /// error are bounded by [`MAX_FORMULA_BYTES`], [`MAX_DEPTH`] and [`MAX_OPERATIONS`].
    #[doc(hidden)]
    pub fn as_written(text: &str, declared: &[Parameter]) -> Result<Self, FormulaError> {
        check_declared(declared)?;
        let known: Vec<&str> = declared.iter().map(|parameter| &*parameter.name).collect();
        let (parsed, automatic) =
            syntax(text, &known).map_err(|error| repair::throughout(text, &known, error))?;
        let used = |parameter: &&Parameter| parsed.names.iter().any(|(name, _)| *name == parameter.name);
        let mut parameters: Vec<Parameter> = declared.iter().filter(used).cloned().collect();
        let unused = declared.iter().filter(|p| !used(p)).map(|p| p.name.to_string()).collect();
        parameters.extend(automatic.iter().map(|name| Parameter::automatic(name)));

        let compiled = Compiled::new(&parsed.equation, &parameters)?;
        let values: Vec<f64> = parameters.iter().map(|parameter| parameter.value).collect();
        Ok(Self {
            text: text.to_owned(),
            simplified: None,
            surface: compiled.graph.part(compiled.root),
            solid: Solid::default(),
            branches: Branches::new(&compiled, &values),
            values,
            automatic,
            unused,
            compiled,
            equation: parsed.equation,
            parameters,
            scratch: EvaluationScratch::default(),
            double: None,
            origin: DVec3::ZERO,
        })
    }

    /// Field of the same surface in which powers and repeated factors stand once: u in place of u², √u or |u|.
    ///
    /// The gradient of u² vanishes on the surface u = 0, so that there is no normal; the gradient of u does not. Text,
    /// normal form and MathML remain those of the formula. A field without such factors is returned unchanged.
    #[must_use]
    #[doc(hidden)]
    pub fn without_powers(mut self) -> Self {
        if self.simplified.is_none()
            && let Some(simplified) = powers::without_powers(&self.equation)
            // The simplified equation is shorter, so it meets no limit; if it did, the formula itself would still do.
            && let Ok(compiled) = Compiled::new(&simplified, &self.parameters)
        {
            self.simplified = Some(simplified);
            self.surface = compiled.graph.part(compiled.root);
            self.use_compiled(compiled);
            if self.solid != Solid::default() {
                self.make_solid();
            }
        }
        self
    }

    /// The program for the bounds of a factor of f, or of its branches.
    fn factor(&mut self, factor: usize) -> &mut interval::FactorProgram {
        if self.branches.factors.is_empty() {
            &mut self.compiled.factors(&self.values)[factor]
        } else {
            self.branches.factor(factor, &self.values)
        }
    }

    /// Field of the solid that the faces of a box close: max(f, x − `bounds.max[0]`, `bounds.min[0]` − x, …), which is negative in the
    /// box where f is. It is to be sampled in a larger box. The faces of the box are creases of the surface. Text and MathML remain
    /// those of the formula, whose surface is no longer periodic.
    #[must_use]
    pub fn closed_by(mut self, bounds: &Bounds) -> Self {
        self.solid.closed = Some(*bounds);
        self.make_solid();
        self
    }

    /// [`Formula::closed_by`], and opposite faces of the box are to be the same along every axis on which it is a whole number of
    /// [periods](Formula::surface_periods) wide: [`Field::unit_cell`] says which.
    #[must_use]
    pub fn repeated_in(mut self, bounds: &Bounds) -> Self {
        self.solid.is_cell = true;
        self.closed_by(bounds)
    }

    /// The period of the surface, which no box closes, along each axis: see [`Field::periods`].
    #[must_use]
    pub fn surface_periods(&self) -> [Option<f64>; 3] {
        let (graph, root) = &self.surface;
        [0, 1, 2].map(|axis| periods::period(graph, *root, axis, &self.values))
    }

    /// Field of the sheet of this thickness around the surface: |f| − t/2 |∇f|, which is negative where the distance from the surface
    /// is less than t/2 to first order. A box [closes](Formula::closed_by) the sheet, not the solid. Text and MathML remain those of
    /// the formula.
    #[must_use]
    pub fn thickened(mut self, thickness: f64) -> Self {
        self.solid.thickness = Some(thickness);
        self.make_solid();
        self
    }

    /// Field of the surface itself again, after [`Formula::thickened`] and [`Formula::closed_by`].
    #[must_use]
    pub fn without_solid(mut self) -> Self {
        if self.solid != Solid::default() {
            self.solid = Solid::default();
            self.make_solid();
        }
        self
    }

    /// Thickness of the sheet that is sampled in place of the surface, see [`Formula::thickened`].
    #[must_use]
    pub fn thickness(&self) -> Option<f64> {
        self.solid.thickness
    }

    /// The box whose faces close the solid, see [`Formula::closed_by`].
    #[must_use]
    pub fn closing_box(&self) -> Option<Bounds> {
        self.solid.closed
    }

    /// Compiles what the surface is made to, anew from f.
    fn make_solid(&mut self) {
        let (mut graph, f) = self.surface.clone();
        let root = self.solid.made_of(&mut graph, f);
        let (graph, root) = graph.part(root);
        self.use_compiled(Compiled::from_graph(graph, root, &self.values));
    }

    fn use_compiled(&mut self, compiled: Compiled) {
        self.branches = Branches::new(&compiled, &self.values);
        self.compiled = compiled;
    }

    /// Text that was parsed.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Formula in normal form: with explicit products and no redundant brackets. It is ASCII except for Greek names,
    /// and parsing it gives the same field.
    #[must_use]
    #[doc(hidden)]
    pub fn normal_form(&self) -> String {
        display::plain_equation(&self.equation)
    }

    /// Whether both formulas have the same syntax tree, regardless of spans.
    #[must_use]
    #[doc(hidden)]
    pub fn same_tree(&self, other: &Self) -> bool {
        self.equation == other.equation
    }

    /// Formula in presentation MathML: the content of a `math` element.
    #[must_use]
    #[doc(hidden)]
    pub fn mathml(&self) -> MathNode {
        mathml::equation(&self.equation)
    }

    /// Parameters that the formula uses: the declared ones, then the automatic ones.
    #[must_use]
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// Names of the parameters that were not declared.
    #[must_use]
    pub fn auto(&self) -> &[String] {
        &self.automatic
    }

    /// Whether f is the same everywhere for any values of the parameters. Such a field has no surface.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.compiled.is_constant
    }

    /// Sets the value of a parameter, which may lie outside the range of its slider. A declared parameter that the
    /// formula does not use is accepted and has no effect.
    ///
    /// # Errors
    ///
    /// [`FormulaErrorKind::BadParameter`] if there is no such parameter or the value is not finite.
    pub fn set_parameter(&mut self, name: &str, value: f64) -> Result<(), FormulaError> {
        if !value.is_finite() {
            let message = format!("The parameter `{name}` needs a finite value");
            return Err(FormulaError::new(FormulaErrorKind::BadParameter, 0..0, message));
        }
        let Some(index) = self.parameters.iter().position(|parameter| parameter.name == name) else {
            if self.unused.iter().any(|unused| unused == name) {
                return Ok(());
            }
            let message = format!("The formula has no parameter `{name}`");
            return Err(FormulaError::new(FormulaErrorKind::BadParameter, 0..0, message));
        };
        self.parameters[index].value = value;
        self.values[index] = value;
        self.compiled.set_parameters(&self.values);
        self.branches.set_parameters(&self.values);
        Ok(())
    }

    /// Whether the batched methods compute in double precision.
    fn is_double(&self) -> bool {
        self.double.is_some() || self.origin != DVec3::ZERO
    }

    /// Runs `enclose` on boxes in the coordinates of the formula that hold these boxes.
    fn on_formula_boxes<R>(
        &mut self,
        boxes: &[Bounds],
        enclose: impl FnOnce(&mut Self, &[Bounds]) -> R,
    ) -> R {
        if self.origin == DVec3::ZERO {
            return enclose(self, boxes);
        }
        let mut moved = core::mem::take(&mut self.scratch.boxes);
        moved.clear();
        moved.extend(boxes.iter().map(|own| {
            let [lo, hi] = [own.lo(), own.hi()].map(|corner| (self.origin + corner).to_array());
            Bounds { min: lo.map(f64::next_down), max: hi.map(f64::next_up) }
        }));
        let result = enclose(self, &moved);
        self.scratch.boxes = moved;
        result
    }

    /// f, ∇f and ∇∇f at `p`, computed in double precision from the transformed graphs that the batched programs are
    /// compiled from. It equals [`Field::jet`] up to rounding and is derived independently of it.
    #[doc(hidden)]
    pub fn transformed_jet(&mut self, p: DVec3) -> Jet {
        let compiled = self.branches.active(&mut self.compiled);
        compiled.transformed_jet(&self.values, place(self.origin, p))
    }
}

/// A point that is counted from `origin`, in the coordinates of the formula.
fn place(origin: DVec3, p: DVec3) -> DVec3 {
    // Adding 0 would take the sign off −0, to the other side of a jump.
    if origin == DVec3::ZERO { p } else { origin + p }
}

/// Syntax tree of `text`, and its undeclared names.
fn syntax(text: &str, declared: &[&str]) -> Result<(statements::Parsed, Vec<String>), FormulaError> {
    let parsed = statements::parse(text, declared)?;
    let automatic = automatic_names(text, &parsed, declared)?;
    Ok((parsed, automatic))
}

/// The number that a text without names stands for, in the language of formulas: `2*pi`, `1e-3`,
/// `sqrt(2)/3`.
///
/// # Errors
///
/// Any of [`FormulaErrorKind`], with its span in bytes of `text`: [`FormulaErrorKind::UnknownName`]
/// for a coordinate or a parameter.
pub fn number(text: &str) -> Result<f64, FormulaError> {
    let statements::Parsed { equation, names } = statements::parse(text, &[])?;
    let varying = equation.left.any(&|kind| matches!(kind, ast::ExprKind::Coordinate(_)));
    let mut graph = Graph::default();
    let number = match build::build(
        &mut graph,
        &equation,
        &names.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
    )? {
        root if equation.right.is_none() => graph.as_constant(root),
        _ => None,
    };
    let span = names.first().map_or(0..text.len(), |(_, span)| span.clone());
    number.filter(|_| !varying && names.is_empty()).ok_or_else(|| {
        FormulaError::new(FormulaErrorKind::UnknownName, span, format!("`{text}` is not a number"))
    })
}

/// Checks that every declared parameter has a usable name, range and value.
fn check_declared(declared: &[Parameter]) -> Result<(), FormulaError> {
    let bad = |message: String| Err(FormulaError::new(FormulaErrorKind::BadParameter, 0..0, message));
    for (index, Parameter { name, value, min, max, step, .. }) in declared.iter().enumerate() {
        if !lex::is_name(name) {
            return bad(format!("`{name}` cannot be the name of a parameter: a letter comes first"));
        }
        if spelling::is_known(name) || matches!(&**name, "and" | "or" | "not") {
            return bad(format!("`{name}` has a meaning of its own and cannot be a parameter"));
        }
        if declared[..index].iter().any(|other| other.name == *name) {
            return bad(format!("The parameter `{name}` is declared twice"));
        }
        if ![value, min, max, step].iter().all(|number| number.is_finite()) || min > max || *step < 0.0 {
            return bad(format!("The parameter `{name}` needs finite numbers, min ≤ max and a step ≥ 0"));
        }
    }
    Ok(())
}

/// Undeclared names, which become automatic parameters, if none looks like a misspelling.
fn automatic_names(
    text: &str,
    parsed: &statements::Parsed,
    declared: &[&str],
) -> Result<Vec<String>, FormulaError> {
    let defined = parsed.equation.definitions.iter().map(|definition| definition.name.as_str());
    let meant: Vec<&str> = declared.iter().copied().chain(defined).collect();
    let all: Vec<&str> =
        meant.iter().copied().chain(parsed.names.iter().map(|(name, _)| name.as_str())).collect();
    let unknown = parsed.names.iter().filter(|(name, _)| !declared.contains(&name.as_str()));
    let mut automatic = Vec::new();
    for (name, span) in unknown {
        if let Some(error) = spelling::unlikely_parameter(text, name, span, &meant, &all) {
            return Err(error);
        }
        automatic.push(name.clone());
    }
    Ok(automatic)
}

impl Field for Formula {
    fn periods(&self) -> [Option<f64>; 3] {
        if self.solid.closed.is_some() { [None; 3] } else { self.surface_periods() }
    }

    fn unit_cell(&self) -> Option<UnitCell> {
        let bounds = self.solid.closed.filter(|_| self.solid.is_cell)?;
        let (size, periods) = (bounds.size(), self.surface_periods());
        let repeats = [0, 1, 2].map(|axis| periods[axis].is_some_and(|p| periods::is_whole(size[axis], p)));
        Some(UnitCell { bounds: bounds.relative_to(self.origin()), repeats })
    }

    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        let is_double = self.is_double();
        let compiled = self.branches.active(&mut self.compiled);
        if is_double {
            for (&p, value) in points.iter().zip(value) {
                let exact =
                    compiled.value(&self.values, place(self.origin, p.as_dvec3()), &mut self.scratch.doubles);
                *value = double::value(exact, self.double);
            }
            return;
        }
        let value = &mut value[..points.len()];
        eval::run(&compiled.value_program, &mut self.scratch.registers, points, |first, [f]| {
            value[first..].iter_mut().zip(f.0).for_each(|(value, f)| *value = f);
        });
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        let is_double = self.is_double();
        let compiled = self.branches.active(&mut self.compiled);
        if is_double {
            for (k, &p) in points.iter().enumerate() {
                let exact = compiled.gradient(
                    &self.values,
                    place(self.origin, p.as_dvec3()),
                    &mut self.scratch.doubles,
                );
                (value[k], gradient[k]) = double::gradient(exact, self.double);
            }
            return;
        }
        let (value, gradient) = (&mut value[..points.len()], &mut gradient[..points.len()]);
        eval::run(&compiled.gradient_program, &mut self.scratch.registers, points, |first, [f, x, y, z]| {
            let slots = value[first..].iter_mut().zip(&mut gradient[first..]);
            for (k, (value, gradient)) in slots.take(LANES).enumerate() {
                (*value, *gradient) = (f.0[k], Vec3::new(x.0[k], y.0[k], z.0[k]));
            }
        });
    }

    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        let is_double = self.is_double();
        let compiled = self.branches.active(&mut self.compiled);
        if is_double {
            for (k, &p) in points.iter().enumerate() {
                let jet =
                    compiled.jet(&self.values, place(self.origin, p.as_dvec3()), &mut self.scratch.jets);
                (value[k], gradient[k], hessian[k]) = double::hessian(&jet, self.double);
            }
            return;
        }
        let n = points.len();
        let (value, gradient, hessian) = (&mut value[..n], &mut gradient[..n], &mut hessian[..n]);
        let program = compiled.hessian_program(&self.values);
        let store = |first: usize, results: [&Lanes; 10]| {
            let slots = value[first..].iter_mut().zip(&mut gradient[first..]).zip(&mut hessian[first..]);
            for (k, ((value, gradient), hessian)) in slots.take(LANES).enumerate() {
                let [f, x, y, z, xx, xy, xz, yy, yz, zz] = results.map(|lanes| lanes.0[k]);
                (*value, *gradient) = (f, Vec3::new(x, y, z));
                *hessian = Sym3 { xx, xy, xz, yy, yz, zz };
            }
        };
        eval::run(program, &mut self.scratch.registers, points, store);
    }

    fn value_and_gradient(&mut self, p: DVec3) -> (f64, DVec3) {
        let compiled = self.branches.active(&mut self.compiled);
        let (value, gradient) =
            compiled.first_order(&self.values, place(self.origin, p), &mut self.scratch.slopes);
        self.double.map_or((value, gradient), |scale| (value / scale, gradient / scale))
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        let compiled = self.branches.active(&mut self.compiled);
        let jet = compiled.jet(&self.values, place(self.origin, p), &mut self.scratch.jets);
        self.double.map_or(jet, |scale| double::scaled(jet, scale))
    }

    fn use_double(&mut self, scale: Option<f64>) {
        self.double = scale;
    }

    fn bounded(&mut self) -> Option<&mut dyn Bounded> {
        Some(self)
    }

    fn origin(&self) -> DVec3 {
        self.origin
    }

    /// With another origin than zero the batched methods compute in double precision, which takes longer: the coordinates of the
    /// formula have more digits than single precision holds.
    fn set_origin(&mut self, origin: DVec3) {
        self.origin = origin;
    }

    fn branched(&mut self) -> Option<&mut dyn Branched> {
        Some(self)
    }

    fn why_constant(&self) -> Option<String> {
        let has_coordinates =
            self.surface.0.nodes().iter().any(|node| matches!(node, graph::Node::Coordinate(_)));
        if has_coordinates {
            None
        } else {
            self.parameters.first().map(|first| spelling::no_coordinate(&first.name))
        }
    }

    /// The equation that [`Formula::without_powers`] has found.
    fn sampled_as(&self) -> Option<String> {
        self.simplified.as_ref().map(display::plain_equation)
    }
}

impl Branched for Formula {
    fn crease_cells(&mut self, bounds: &Bounds, width: f64, numbers: BranchNumbers) -> Work<'_, Vec<Bounds>> {
        let bounds = self.on_formula_boxes(&[*bounds], |_, boxes| boxes[0]);
        Box::pin(async move {
            let cells =
                self.branches.crease_cells(&self.compiled, &self.values, &bounds, width, numbers).await;
            cells.iter().map(|cell| cell.relative_to(self.origin)).collect()
        })
    }

    /// The numbers are the same whatever was asked before, but for those beyond the first 256, and they outlast a change of the
    /// parameters, unless that brings the width of a smooth minimum to 0 or an exponent to 1.
    fn branch_at(&mut self, p: DVec3) -> u32 {
        self.branches.at(&self.values, place(self.origin, p))
    }

    fn branches_in(&mut self, bounds: &Bounds) -> Option<Vec<u32>> {
        self.on_formula_boxes(&[*bounds], |field, boxes| field.branches.within(&field.values, &boxes[0]))
    }

    /// # Panics
    ///
    /// If no branch has this number.
    fn select_branch(&mut self, branch: Option<u32>) {
        self.branches.select(branch, &self.values);
    }
}

impl Bounded for Formula {
    fn operations(&mut self) -> usize {
        self.compiled.value_program.instructions.len()
    }

    fn factors(&mut self) -> usize {
        match self.branches.factors.len() {
            0 => self.compiled.factors(&self.values).len(),
            of_branches => of_branches,
        }
    }

    fn enclose(&mut self, factor: usize, boxes: &[Bounds], out: &mut [Enclosure]) {
        self.on_formula_boxes(boxes, |field, boxes| {
            field.factor(factor).first.enclose(boxes, out);
            if !field.branches.factors.is_empty() {
                field.branches.leave_out(factor, &field.values, boxes, out);
            }
        });
    }

    fn is_zero_of(&mut self, factor: usize, zero: DVec3) -> bool {
        let place = place(self.origin, zero);
        self.branches.factors.is_empty() || self.branches.is_given_by(factor, &self.values, place)
    }

    fn enclose_second(&mut self, factor: usize, boxes: &[Bounds], out: &mut [Sym3<Interval>]) {
        self.on_formula_boxes(boxes, |field, boxes| match &mut field.factor(factor).second {
            Some(program) => program.enclose_second(boxes, out),
            None => out[..boxes.len()].fill(Sym3::splat(Interval::EVERYTHING)),
        });
    }
}
