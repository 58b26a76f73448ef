//! Fields given by a formula such as `x^2/a^2 + y^2/b^2 + z^2/c^2 = 1`.
//!
//! # Language
//!
//! The coordinates `x y z`; numbers; the constants `pi`, `e`, `tau` and `phi` (the golden ratio); named parameters;
//! `+ - * / ^`, brackets, and products written side by side where there is one reading only (`2x`, `x y`, `xyz`,
//! `3(x + 1)`); the functions of [`FUNCTIONS`]; and one `=`, which stands for the difference of its sides. `^` binds
//! to the right and stronger than a sign in front: `-x^2` is −(x²). `2e3` is two thousand, `2e` twice Euler's
//! number. Raised digits, `−`, `×`, `·`, `÷`, `π`, `τ`, `φ` and full-width characters are understood.
//!
//! A name that is not known becomes a parameter by itself as long as there are at most
//! [`MAX_AUTOMATIC_PARAMETERS`] of them and it does not look like a slip of the keyboard.
//!
//! # From text to particles
//!
//! The text is parsed to a syntax tree and that to an SSA graph, in which equal operations are one node. The graph is
//! read as a second-order jet in double precision, as intervals and, compiled to a straight-line program, over
//! batches of points in single precision. Gradient and Hessian are graphs too, derived from the first one.

mod ast;
mod build;
mod derivative;
mod display;
mod error;
mod eval;
mod graph;
mod interval;
mod lex;
mod mathml;
mod operations;
mod parse;
mod powers;
mod program;
mod scalar;
#[cfg(test)]
mod tests;

pub use ast::{FUNCTIONS, FunctionInfo};
pub use error::{FormulaError, FormulaErrorKind, utf16_offset};

use super::{Enclosure, Field, Interval, Jet};
use crate::math::Sym3;
use ast::{COORDINATES, Constant, Equation, Function};
use glam::{DVec3, Vec3};
use graph::{Graph, Id};
use program::Program;

/// Longest formula, in bytes of UTF-8; longer text is refused before it is parsed.
pub const MAX_FORMULA_BYTES: usize = 4096;

/// Deepest nesting of brackets, calls, signs and exponents.
pub const MAX_DEPTH: usize = 64;

/// Most operations of a formula, integer powers counted by their products.
pub const MAX_OPERATIONS: usize = 4096;

/// Most unknown names that become parameters by themselves.
pub const MAX_AUTOMATIC_PARAMETERS: usize = 4;

/// A named number of a formula that can be changed without parsing it again.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Parameter {
    /// The name as it stands in the formula.
    pub name: String,
    /// What it is, for a person.
    pub label: String,
    /// Present value.
    pub value: f64,
    /// Least value that a slider offers.
    pub min: f64,
    /// Greatest value that a slider offers.
    pub max: f64,
    /// Step of a slider.
    pub step: f64,
}

impl Parameter {
    /// What an unknown name becomes: the value 1 on a range from 0 to 3.
    #[must_use]
    pub fn automatic(name: &str) -> Self {
        Self { name: name.into(), label: name.into(), value: 1.0, min: 0.0, max: 3.0, step: 0.01 }
    }
}

/// A field f(x, y, z) given by a formula.
///
/// ```
/// use marching_particles::field::Field;
/// use marching_particles::field::formula::FormulaField;
///
/// let mut field = FormulaField::parse("x^2/a^2 + y^2 + z^2 = 1", &[])?;
/// assert_eq!(field.auto(), ["a"]);
/// field.set_parameter("a", 2.0)?;
/// let jet = field.jet((2.0, 0.0, 0.0).into());
/// assert_eq!((jet.value, jet.gradient.x), (0.0, 1.0));
///
/// let error = FormulaField::parse("x^2 + sin y", &[]).unwrap_err();
/// assert_eq!((error.span.clone(), error.suggestion.as_deref()), (6..11, Some("sin(y)")));
/// # Ok::<(), marching_particles::field::formula::FormulaError>(())
/// ```
#[derive(Clone, Debug)]
pub struct FormulaField {
    text: String,
    equation: Equation,
    /// The equation that is evaluated, where it is another one.
    simple: Option<Equation>,
    parameters: Vec<Parameter>,
    automatic: Vec<String>,
    /// Declared names that the formula does not use.
    unused: Vec<String>,
    values: Vec<f64>,
    graph: Graph,
    root: Id,
    constant: bool,
    value_program: Program,
    gradient_program: Program,
    /// Compiled when first asked for: uniform sampling does without.
    hessian_program: Option<Program>,
    gradient: [Id; 3],
    /// Meaningful once the Hessian is compiled.
    hessian: [Id; 6],
    scratch: eval::Scratch,
    jets: scalar::JetScratch,
    /// Compiled when first asked for.
    parts: Vec<interval::Part>,
}

impl FormulaField {
    /// Reads a formula. Of the `declared` parameters, those that occur in the text become the field's, in their
    /// order; unknown names follow as automatic parameters, in order of appearance.
    ///
    /// # Errors
    ///
    /// Whatever [`FormulaErrorKind`] lists, with the span in bytes of `text`. The time and memory to reach an error
    /// are bounded by [`MAX_FORMULA_BYTES`], [`MAX_DEPTH`] and [`MAX_OPERATIONS`].
    pub fn parse(text: &str, declared: &[Parameter]) -> Result<Self, FormulaError> {
        check_declared(declared)?;
        let known: Vec<&str> = declared.iter().map(|parameter| parameter.name.as_str()).collect();
        let parsed = parse::parse(text, &known)?;
        let automatic = automatic_names(&parsed.names, &known)?;
        let used = |parameter: &&Parameter| parsed.names.iter().any(|(name, _)| *name == parameter.name);
        let mut parameters: Vec<Parameter> = declared.iter().filter(used).cloned().collect();
        let unused = declared.iter().filter(|p| !used(p)).map(|p| p.name.clone()).collect();
        parameters.extend(automatic.iter().map(|name| Parameter::automatic(name)));

        let mut field = Self {
            text: text.to_owned(),
            equation: parsed.equation,
            simple: None,
            values: parameters.iter().map(|parameter| parameter.value).collect(),
            parameters,
            automatic,
            unused,
            graph: Graph::default(),
            root: 0,
            constant: false,
            value_program: Program::default(),
            gradient_program: Program::default(),
            hessian_program: None,
            gradient: [0; 3],
            hessian: [0; 6],
            scratch: eval::Scratch::default(),
            jets: Vec::new(),
            parts: Vec::new(),
        };
        field.compile()?;
        Ok(field)
    }

    /// The field of the same surface that has a gradient on it, where f is a power of another function or a product with
    /// powers or repeated factors: u in the place of u², √u or |u|. Text, normal form and MathML stay those of the formula. The
    /// field itself where it is none of these.
    #[must_use]
    pub fn without_powers(mut self) -> Self {
        if self.simple.is_none()
            && let Some(simple) = powers::without_powers(&self.equation)
        {
            let typed = self.clone();
            self.simple = Some(simple);
            // Shorter than the formula, so that no limit is met; but if it were, the formula itself is still good.
            if self.compile().is_err() {
                return typed;
            }
        }
        self
    }

    /// The equation in the place of the formula, if [`FormulaField::without_powers`] has found one.
    #[must_use]
    pub fn evaluated_as(&self) -> Option<String> {
        self.simple.as_ref().map(display::plain_equation)
    }

    /// Everything that is evaluated, from the equation and the names of the parameters.
    fn compile(&mut self) -> Result<(), FormulaError> {
        let equation = self.simple.as_ref().unwrap_or(&self.equation);
        let names: Vec<&str> = self.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
        let mut graph = Graph::default();
        let root = build::build(&mut graph, equation, &names)?;
        self.value_program = Program::compile(&graph, &[root]);
        if self.value_program.operations() > MAX_OPERATIONS {
            return Err(build::too_complex(&equation.left));
        }
        graph.let_zero_annihilate();
        let gradient = cheaper_gradient(&mut graph, root);
        self.gradient_program = Program::compile(&graph, &[root, gradient[0], gradient[1], gradient[2]]);
        let steps = graph.nodes()[..=root as usize].iter().any(|node| {
            matches!(node, graph::Node::Unary(operations::Unary::Floor | operations::Unary::Sign, _))
        });
        let flat = gradient.iter().all(|&id| graph.as_constant(id) == Some(0.0));
        self.constant = graph.is_uniform(root) || (flat && !steps);
        (self.graph, self.root, self.gradient, self.hessian) = (graph, root, gradient, [root; 6]);
        self.hessian_program = None;
        self.parts.clear();
        self.update();
        Ok(())
    }

    /// The text that was parsed.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The formula in normal form: explicit products, ASCII only where the text was, no superfluous brackets.
    /// Parsing it gives the same field.
    #[must_use]
    pub fn normal_form(&self) -> String {
        display::plain_equation(&self.equation)
    }

    /// Whether both formulas have the same syntax tree, wherever their symbols stand.
    #[must_use]
    pub fn same_tree(&self, other: &Self) -> bool {
        self.equation == other.equation
    }

    /// The formula as a MathML `math` element, display style; names and numbers are escaped.
    #[must_use]
    pub fn mathml(&self) -> String {
        mathml::equation(&self.equation)
    }

    /// The parameters that the formula uses.
    #[must_use]
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// Names of the parameters that were not declared.
    #[must_use]
    pub fn auto(&self) -> &[String] {
        &self.automatic
    }

    /// Whether f is the same everywhere, whatever the parameters: then there is no surface, or no inside and
    /// outside.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.constant
    }

    /// Changes a parameter; the range of its slider does not bind. A declared parameter that the formula does not
    /// use is accepted and has no effect.
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
        self.update();
        Ok(())
    }

    /// f, ∇f and ∇∇f at `p` through the transformed graphs that the batches are compiled from, but in double
    /// precision: equal to [`Field::jet`] up to rounding, by an independent route.
    pub fn transformed_jet(&mut self, p: DVec3) -> Jet {
        self.compile_hessian();
        let mut values: Vec<f64> = Vec::with_capacity(self.graph.len());
        for node in self.graph.nodes() {
            values.push(node.evaluate(&self.values, p.to_array(), |id| values[id as usize]));
        }
        let value = |id: Id| values[id as usize];
        let [xx, xy, xz, yy, yz, zz] = self.hessian.map(value);
        Jet {
            value: value(self.root),
            gradient: DVec3::from_array(self.gradient.map(value)),
            hessian: Sym3 { xx, xy, xz, yy, yz, zz },
        }
    }

    fn update(&mut self) {
        self.value_program.set_parameters(&self.values);
        self.gradient_program.set_parameters(&self.values);
        if let Some(program) = &mut self.hessian_program {
            program.set_parameters(&self.values);
        }
        for part in &mut self.parts {
            part.first.set_parameters(&self.values);
            if let Some(program) = &mut part.second {
                program.set_parameters(&self.values);
            }
        }
    }

    fn compile_parts(&mut self) {
        if self.parts.is_empty() {
            self.parts = interval::parts(&mut self.graph, self.root, self.gradient);
            self.update();
        }
    }

    fn compile_hessian(&mut self) {
        if self.hessian_program.is_none() {
            let hessian = cheaper_hessian(&mut self.graph, self.gradient);
            let mut outputs = vec![self.root];
            outputs.extend(self.gradient);
            outputs.extend(hessian);
            self.hessian = hessian;
            let mut program = Program::compile(&self.graph, &outputs);
            program.set_parameters(&self.values);
            self.hessian_program = Some(program);
        }
    }
}

/// The gradient of `root`, by the cheaper of a backward and three forward sweeps.
fn cheaper_gradient(graph: &mut Graph, root: Id) -> [Id; 3] {
    let backward = derivative::backward(graph, root);
    let forward = [0, 1, 2].map(|axis| derivative::forward(graph, &[root], axis)[0]);
    let cost = |graph: &Graph, [x, y, z]: [Id; 3]| program::cost(graph, &[root, x, y, z]);
    if cost(graph, forward) <= cost(graph, backward) { forward } else { backward }
}

/// The Hessian (xx, xy, xz, yy, yz, zz) from the gradient, by the cheaper of forward and backward sweeps.
fn cheaper_hessian(graph: &mut Graph, gradient: [Id; 3]) -> [Id; 6] {
    let [gx, gy, gz] = gradient;
    let columns = [0, 1, 2].map(|axis| derivative::forward(graph, &gradient, axis));
    let forward = [columns[0][0], columns[1][0], columns[2][0], columns[1][1], columns[2][1], columns[2][2]];
    let [x, y, z] = [gx, gy, gz].map(|component| derivative::backward(graph, component));
    let backward = [x[0], x[1], x[2], y[1], y[2], z[2]];
    let cost = |graph: &Graph, hessian: [Id; 6]| {
        let mut outputs = gradient.to_vec();
        outputs.extend(hessian);
        program::cost(graph, &outputs)
    };
    if cost(graph, forward) <= cost(graph, backward) { forward } else { backward }
}

/// Refuses declared parameters that could not be used.
fn check_declared(declared: &[Parameter]) -> Result<(), FormulaError> {
    let bad = |message: String| Err(FormulaError::new(FormulaErrorKind::BadParameter, 0..0, message));
    for (index, Parameter { name, value, min, max, step, .. }) in declared.iter().enumerate() {
        if !lex::is_name(name) {
            return bad(format!("`{name}` cannot be the name of a parameter: a letter comes first"));
        }
        if COORDINATES.contains(&name.as_str())
            || Constant::find(name).is_some()
            || Function::find(name).is_some()
        {
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

/// The unknown names, if they may all become parameters by themselves.
fn automatic_names(
    names: &[(String, core::ops::Range<usize>)],
    declared: &[&str],
) -> Result<Vec<String>, FormulaError> {
    let unknown: Vec<&(String, core::ops::Range<usize>)> =
        names.iter().filter(|(name, _)| !declared.contains(&name.as_str())).collect();
    for (name, span) in &unknown {
        let Some((meant, message)) = slip(name, declared) else { continue };
        return Err(FormulaError::new(FormulaErrorKind::UnknownName, span.clone(), message)
            .suggest(meant)
            .names(vec![name.clone()]));
    }
    let list: Vec<String> = unknown.iter().map(|(name, _)| name.clone()).collect();
    if let Some((name, span)) = unknown.get(MAX_AUTOMATIC_PARAMETERS) {
        let message = format!(
            "Unknown name `{name}`: only {MAX_AUTOMATIC_PARAMETERS} names become sliders by themselves; add a slider `{name}`"
        );
        return Err(FormulaError::new(FormulaErrorKind::UnknownName, span.clone(), message).names(list));
    }
    Ok(list)
}

/// What `name` is probably a slip of, and the sentence that says so.
fn slip(name: &str, declared: &[&str]) -> Option<(String, String)> {
    // `x2` is far more often a square than a parameter, and `cosx` a cosine.
    if let Some((axis, digit)) = name.split_at_checked(1)
        && COORDINATES.contains(&axis)
        && let Ok(exponent) = digit.parse::<u8>()
    {
        let meant = format!("{axis}^{exponent}");
        let message = format!("Unknown name `{name}`: did you mean `{meant}`? Or add a slider `{name}`");
        return Some((meant, message));
    }
    for function in Function::ALL {
        if let Some(rest) = name.strip_prefix(function.name())
            && !rest.is_empty()
            && rest.bytes().all(|b| matches!(b, b'x' | b'y' | b'z'))
        {
            let meant = format!("{}({rest})", function.name());
            let message = format!("Unknown name `{name}`: did you mean `{meant}`? Or add a slider `{name}`");
            return Some((meant, message));
        }
    }
    if let Some(meant) = parse::elsewhere(name) {
        let message = format!("Unknown name `{name}`: did you mean `{meant}(…)`? Or add a slider `{name}`");
        return Some((meant.to_owned(), message));
    }
    if name.chars().count() == 1 && !COORDINATES.iter().any(|axis| axis.eq_ignore_ascii_case(name)) {
        return None;
    }
    let words = COORDINATES
        .into_iter()
        .chain(Constant::ALL.map(Constant::name))
        .chain(Function::ALL.iter().map(|function| function.name()))
        .chain(declared.iter().copied());
    // A name that only differs by a digit or an index, such as `phi0` or `r_1`, is meant to differ.
    let indexed = name.ends_with(|c: char| c.is_ascii_digit()) || name.contains('_');
    let meant = parse::similar(name, words).filter(|meant| {
        let long = name.chars().count() >= 3 && meant.chars().count() >= 3;
        meant.eq_ignore_ascii_case(name) || (long && !indexed)
    })?;
    let message = format!("Unknown name `{name}`: did you mean `{meant}`? Or add a slider `{name}`");
    Some((meant.to_owned(), message))
}

impl Field for FormulaField {
    fn values(&mut self, points: &[Vec3], value: &mut [f32]) {
        let value = &mut value[..points.len()];
        eval::run(&self.value_program, &mut self.scratch, points, &mut eval::Values(value));
    }

    fn gradients(&mut self, points: &[Vec3], value: &mut [f32], gradient: &mut [Vec3]) {
        let mut sink =
            eval::Gradients { value: &mut value[..points.len()], gradient: &mut gradient[..points.len()] };
        eval::run(&self.gradient_program, &mut self.scratch, points, &mut sink);
    }

    fn hessians(
        &mut self,
        points: &[Vec3],
        value: &mut [f32],
        gradient: &mut [Vec3],
        hessian: &mut [Sym3<f32>],
    ) {
        self.compile_hessian();
        let program = self.hessian_program.as_ref().expect("just compiled");
        let mut sink = eval::Hessians {
            value: &mut value[..points.len()],
            gradient: &mut gradient[..points.len()],
            hessian: &mut hessian[..points.len()],
        };
        eval::run(program, &mut self.scratch, points, &mut sink);
    }

    fn jet(&mut self, p: DVec3) -> Jet {
        scalar::jet(&self.graph, self.root, &self.values, p, &mut self.jets)
    }

    fn interval(&mut self, lo: DVec3, hi: DVec3) -> Interval {
        self.compile_parts();
        self.parts[0].first.whole([lo, hi])
    }

    fn has_bounds(&self) -> bool {
        true
    }

    fn parts(&mut self) -> usize {
        self.compile_parts();
        self.parts.len()
    }

    fn enclose(&mut self, part: usize, boxes: &[[DVec3; 2]], out: &mut [Enclosure]) {
        self.compile_parts();
        self.parts[part].first.enclose(boxes, out);
    }

    fn enclose_second(&mut self, part: usize, boxes: &[[DVec3; 2]], out: &mut [[[f64; 2]; 6]]) {
        self.compile_parts();
        match &mut self.parts[part].second {
            Some(program) => program.enclose_second(boxes, out),
            None => out[..boxes.len()].fill([[f64::NEG_INFINITY, f64::INFINITY]; 6]),
        }
    }
}
