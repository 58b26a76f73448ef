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
//! A fraction of two numbers multiplies the factor after it: `9/4y^2` is (9/4)y² and `1/2x` is
//! (1/2)x. After any other divisor, or if the factor is itself a number, as in `1/2pi`, there are
//! two readings, which the error offers.
//!
//! `if(c, a, b)` and `c ? a : b` choose by a condition: comparisons by `<`, `<=`, `>`, `>=`, joined
//! by `and`, `or` and `not` (`&&`, `||`, `!`). `a % b` is `mod(a, b)`, with the sign of b.
//! Conditions in braces after the formula limit the surface: `z = x*y {x^2 + y^2 < 1, z > 0}`.
//!
//! Definitions come before the surface, each ended by a `;` or its line:
//! `r = hypot(x, y); (r - 1)^2 + z^2 = 0.1`, `f(a, b) = a^2 + b^2; f(x, y) = z`. Comments are
//! `// …`, `# …`, `/* … */` and `(* … *)`.
//!
//! Other notations are accepted too: `|x|`, `**` and `==`, brackets of any kind, a function without
//! brackets where there is one reading (`sin 2x`, `sin^2 x cos y`, but not `sin x y`), the head of
//! a definition `f(x, y, z) = …`, what LaTeX has for all this (`\frac{1}{2}`, `\sqrt[3]{x}`,
//! `\left|x\right|`, `\sin\theta`), and what programs write: `x.^2`, `np.sin(x)`, `Sin[x]`, `pow(x,
//! 2.0f)`, `length(vec3(x, y, z))`, `lambda x, y, z: …`.
//!
//! An unknown name becomes an *automatic* parameter, unless it looks like a misspelling, like
//! functions written as one with their arguments, `xsinx`, or like the imaginary unit `i`. A text
//! with several readings is an error that offers each of them. A call of another program that draws
//! a formula, and an equation in polar, cylindrical or spherical coordinates, are errors that
//! suggest the formula of x, y and z.
//!
//! # Evaluation
//!
//! The text is parsed to a syntax tree, which is translated to a graph in static single-assignment
//! form. The graph is evaluated as a second-order jet in double precision, in interval arithmetic
//! over a few boxes at a time and, compiled to a straight-line program, in single precision over
//! batches of points. Gradient and Hessian are graphs too, derived from that of f. Where f takes
//! one of two operands, as a maximum does, each of its smooth branches is a graph as well.

mod ast;
mod branches;
mod build;
mod builder;
mod call;
mod colours;
mod compiled;
mod conditions;
mod control;
mod creases;
mod derivative;
mod display;
mod elsewhere;
mod error;
mod eval;
mod evaluator;
mod expression;
mod graph;
mod heads;
mod interval;
mod latex;
mod lex;
mod mathml;
mod names;
mod operand;
mod operations;
mod parse;
mod patches;
mod periods;
mod pieces;
mod polar;
mod porosity;
mod powers;
mod products;
mod program;
mod regular;
mod repair;
mod scalar;
mod separate;
mod solids;
mod spelling;
mod statements;
mod steps;
#[cfg(test)]
mod tests;
mod thickness;
mod token;
mod value;
mod wrapped;

#[doc(hidden)]
pub use ast::{FUNCTIONS, FunctionInfo};
pub use builder::Expr;
pub(crate) use colours::CHANNELS;
#[doc(hidden)]
pub use control::Grip;
#[doc(hidden)]
pub use error::utf16_offset;
pub use error::{FormulaError, FormulaErrorKind, Mended};
pub(crate) use expression::Noun;
#[doc(hidden)]
pub use lex::name_pattern;
#[doc(hidden)]
pub use mathml::{MathGroup, MathNode, MathToken};
#[doc(hidden)]
pub use operand::MODEL;
pub use porosity::PorosityError;
#[doc(hidden)]
pub use spelling::similar;
pub use thickness::Thickness;
pub use value::Value;
pub(crate) use value::{QUANTITIES, Source};

use super::{Evaluator, Facts, Field, Frame, Jet, Piecewise, UnitCell};
use crate::math::Bounds;
use crate::slices::Work;
use ast::Equation;
use branches::{Branches, SharedBranches};
use compiled::Compiled;
use core::any::Any;
use evaluator::FormulaEvaluator;
use glam::DVec3;
use graph::{Graph, Id, Node};
use operations::Binary;
use regular::Scales;
use serde::{Deserialize, Serialize};
use solids::Solid;
use std::borrow::Cow;
use std::sync::Arc;
use thickness::Shell;

/// Maximum length of a formula in bytes of UTF-8. Longer text is refused before it is parsed, so
/// that the time per typed character is bounded.
pub const MAX_FORMULA_BYTES: usize = 4096;

/// Maximum nesting of brackets, calls, signs and exponents. The deepest formula takes less than 256
/// kB of the 1 MiB of stack in WebAssembly.
pub const MAX_DEPTH: usize = 64;

/// Maximum number of operations of a formula: one for each byte, which only powers can exceed. An
/// integer power counts as its products.
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

/// A surface of the gallery, as its formula knows it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GallerySurface {
    /// Its identifier.
    pub(crate) id: &'static str,
    /// The box that is sampled.
    pub(crate) bounds: Bounds,
    /// Whether it lies in the box for all values of its parameters.
    pub(crate) closed: bool,
}

/// Field f(x, y, z) given by a formula.
///
/// Copies share everything that does not depend on the values of the parameters. [Another
/// value](Formula::with) compiles nothing, unless it changes which function the formula is, as a
/// smooth minimum of width 0 does. The Hessian and the bounds are compiled when first needed.
///
/// ```
/// use marching_particles::{Field, Formula};
///
/// let field = Formula::parse("x^2/a^2 + y^2 + z^2 = 1")?.with("a", 2.0)?;
/// let jet = field.jet((2.0, 0.0, 0.0).into());
/// assert_eq!((jet.value, jet.gradient.x), (0.0, 1.0));
///
/// let error = Formula::parse("x^2 + sin y z").unwrap_err();
/// assert_eq!((error.span.clone(), error.suggestion.as_deref()), (6..11, Some("sin(y)")));
/// # Ok::<(), marching_particles::field::formula::FormulaError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Formula {
    written: Arc<WrittenFormula>,
    /// The surface of the gallery whose formula it is.
    named: Option<GallerySurface>,
    /// Equation of the same surface that is evaluated instead, if [`Formula::for_sampling`] has
    /// found one.
    simplified: Option<Arc<Equation>>,
    /// Whether solids are [brought into their regular form](regular), and the faces with which a
    /// cutter lies flush, in that form.
    is_regular: bool,
    flush: Arc<[String]>,
    /// The factors whose signs that form depends on.
    scales: Scales,
    /// The graph of the surface, and its node, from which a solid is made.
    surface: Arc<(Graph, Id)>,
    /// The solid that is sampled instead of the surface, if any: made by a thickness, a closing
    /// box, or both.
    solid: Solid,
    parameters: Vec<Parameter>,
    /// Values of `parameters`, as the compiled formula takes them.
    values: Vec<f64>,
    compiled: Compiled,
    /// The smooth branches of f.
    branches: SharedBranches,
}

/// A formula as it was written.
#[derive(Debug)]
struct WrittenFormula {
    text: String,
    equation: Equation,
    /// Names of the parameters that were not declared.
    automatic: Vec<String>,
    /// Declared names that the formula does not use.
    unused: Vec<String>,
    /// The columns of the colours that the formula gives, with their functions.
    columns: Vec<(&'static str, Formula)>,
    /// Names of definitions that neither the surface nor a colour depends on.
    idle: Vec<String>,
}

impl WrittenFormula {
    fn new(text: &str, equation: Equation, automatic: Vec<String>) -> Self {
        let (unused, columns, idle) = (Vec::new(), Vec::new(), equation.unused());
        Self { text: text.to_owned(), equation, automatic, unused, columns, idle }
    }
}

impl Formula {
    /// The field of a formula, whose unknown names become parameters: see [`Formula::with`].
    ///
    /// Powers and repeated factors are evaluated once: the surface is the same, and has a gradient
    /// on it.
    ///
    /// # Errors
    ///
    /// Any of [`FormulaErrorKind`], with its span in bytes of `text`.
    pub fn parse(text: &str) -> Result<Self, FormulaError> {
        Ok(Self::as_written(text, &[])?.for_sampling())
    }

    /// Returns the formula as that of a surface of the gallery.
    pub(crate) fn of_surface(self, surface: GallerySurface) -> Self {
        Self { named: Some(surface), ..self }
    }

    /// The surface of the gallery whose formula it is.
    pub(crate) fn surface(&self) -> Option<GallerySurface> {
        self.named
    }

    /// Returns the formula with another value of a parameter. Parameters that [`Formula::parse`]
    /// finds have the value 1.
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
    /// The field's parameters are those of `declared` that occur in the text, in the order of
    /// declaration, followed by the unknown names as automatic parameters, in order of appearance.
    ///
    /// # Errors
    ///
    /// Any of [`FormulaErrorKind`], with its span in bytes of `text`. The time and memory that it
    /// takes to find an error are bounded by [`MAX_FORMULA_BYTES`], [`MAX_DEPTH`] and
    /// [`MAX_OPERATIONS`].
    #[doc(hidden)]
    pub fn as_written(text: &str, declared: &[Parameter]) -> Result<Self, FormulaError> {
        check_declared(declared)?;
        let known: Vec<&str> = declared.iter().map(|parameter| &*parameter.name).collect();
        let (parsed, automatic) = syntax(text, &known).map_err(|error| {
            if error.kind == FormulaErrorKind::TooLong {
                return error;
            }
            wrapped::error(text, &known).unwrap_or_else(|| repair::throughout(text, &known, error))
        })?;
        wrapped::one_path(text).map_or(Ok(()), Err)?;
        let used = |parameter: &&Parameter| parsed.names.iter().any(|(name, _)| *name == parameter.name);
        let mut parameters: Vec<Parameter> = declared.iter().filter(used).cloned().collect();
        let unused = declared.iter().filter(|p| !used(p)).map(|p| p.name.to_string()).collect();
        parameters.extend(automatic.iter().map(|name| Parameter::automatic(name)));

        let compiled = Compiled::new(&parsed.equation, &parameters)?;
        let mut written = WrittenFormula { unused, ..WrittenFormula::new(text, parsed.equation, automatic) };
        let colours = parsed.colours.checked()?;
        written.idle.retain(|name| colours.iter().all(|colour| !colour.needs(name)));
        let columns = colours.iter().map(|colour| value::of_colour(colour, &parameters));
        written.columns = columns.collect::<Result<_, _>>()?;
        Ok(Self::of(written, parameters, compiled))
    }

    /// The field of an equation with automatic parameters of these names, to be evaluated as it is
    /// written.
    fn of_equation(text: &str, equation: Equation, automatic: Vec<String>) -> Result<Self, FormulaError> {
        let parameters: Vec<Parameter> = automatic.iter().map(|name| Parameter::automatic(name)).collect();
        let compiled = Compiled::new(&equation, &parameters)?;
        Ok(Self::of(WrittenFormula::new(text, equation, automatic), parameters, compiled))
    }

    fn of(written: WrittenFormula, parameters: Vec<Parameter>, compiled: Compiled) -> Self {
        let values: Vec<f64> = parameters.iter().map(|parameter| parameter.value).collect();
        Self {
            written: Arc::new(written),
            named: None,
            simplified: None,
            is_regular: false,
            flush: Arc::default(),
            scales: Scales::default(),
            surface: Arc::new(compiled.graph.part(compiled.root)),
            solid: Solid::default(),
            branches: SharedBranches::new(Branches::new(&compiled, &values)),
            values,
            compiled,
            parameters,
        }
    }

    /// Field of the same surface in the form that is sampled. Powers and repeated factors are taken
    /// once: u instead of u², √u or |u|. A solid ends where one of its functions is undefined, and
    /// a face that is cut flush leaves no skin.
    ///
    /// The gradient of u² vanishes on the surface u = 0, so that there is no normal; the gradient
    /// of u does not. Text, normal form and MathML stay as they are. A field without any of this is
    /// returned unchanged.
    #[must_use]
    #[doc(hidden)]
    pub fn for_sampling(mut self) -> Self {
        if self.is_regular {
            return self;
        }
        self.is_regular = true;
        if let Some(simplified) = powers::without_powers(&self.written.equation)
            // The simplified equation is shorter, so it exceeds no limit; if it did, the formula
            // itself would be used.
            && let Ok(compiled) = Compiled::new(&simplified, &self.parameters)
        {
            self.simplified = Some(Arc::new(simplified));
            self.surface = Arc::new(compiled.graph.part(compiled.root));
            self.use_compiled(compiled);
        }
        let (graph, root) = &*self.surface;
        let (values, scales) = (&self.values, &mut self.scales);
        let changes = regular::within_limits(graph, *root, values, scales).is_some()
            || regular::regular(graph, *root, values, scales).is_some();
        if changes || self.solid != Solid::default() {
            self.make_solid();
        }
        self
    }

    /// Field of the solid that the faces of a box close: max(f, x − `bounds.max[0]`,
    /// `bounds.min[0]` − x, …), which is negative in the box where f is. Sample it in a larger box.
    /// The faces of the box are creases of the surface, which is no longer periodic. Text and
    /// MathML stay as they are.
    #[must_use]
    pub fn closed_by(mut self, bounds: &Bounds) -> Self {
        self.solid.closed = Some(*bounds);
        self.make_solid();
        self
    }

    /// Like [`Formula::closed_by`], with opposite faces of the box equal along every axis on which
    /// it is a whole number of [periods](Formula::surface_periods) wide: [`Facts::unit_cell`] says
    /// which.
    #[must_use]
    pub fn repeated_in(mut self, bounds: &Bounds) -> Self {
        self.solid.is_cell = true;
        self.closed_by(bounds)
    }

    /// The period along each axis of the surface, or of the shell around it, before a box closes
    /// it: see [`Facts::periods`].
    #[must_use]
    pub fn surface_periods(&self) -> [Option<f64>; 3] {
        let (graph, root) = &*self.surface;
        let (mut graph, mut root) = (Cow::Borrowed(graph), *root);
        if let Some(shell) = &self.solid.shell {
            let graph = graph.to_mut();
            let half = shell.half(graph);
            // Any function of both has the periods that they have in common.
            root = graph.intern(Node::Binary(Binary::Max, root, half));
        }
        [0, 1, 2].map(|axis| periods::period(&graph, root, axis, &self.values))
    }

    /// Field of the shell of this thickness around the surface: |f| − t/2 |∇f|, which is negative
    /// where the distance from the surface is less than t/2 to first order. A box
    /// [closes](Formula::closed_by) the shell, not the solid. Text and MathML stay as they are.
    #[must_use]
    pub fn thickened(mut self, thickness: f64) -> Self {
        self.solid.shell = Some(Shell::even(thickness));
        self.make_solid();
        self
    }

    /// [`Formula::thickened`] by a thickness t(x, y, z), an expression in the coordinates and the
    /// parameters of this formula: |f| − t/2 |∇f|, with t and ∇f at the same point. The shell ends
    /// in an edge where t falls to 0, and is empty where t is negative or undefined.
    ///
    /// ```
    /// use marching_particles::{Bounds, Formula, Settings, sample};
    ///
    /// let plane = Formula::parse("z = 0")?.thickened_by("0.2 + 0.1 x")?;
    /// // A wedge of the heights 0.1 and 0.3 at its ends.
    /// let wedge = sample(plane.closed_by(&Bounds::cube(1.0)), &Settings::with_count(1_000))?;
    /// assert!(wedge.volume().is_some_and(|volume| (volume - 0.8).abs() < 1e-3));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Any of [`FormulaErrorKind`], with its span in bytes of `thickness`:
    /// [`FormulaErrorKind::UnknownName`] for a name that is no parameter of the formula.
    pub fn thickened_by(mut self, thickness: impl Into<Thickness>) -> Result<Self, FormulaError> {
        self.solid.shell = Some(Shell::new(&thickness.into(), &self.parameters)?);
        self.make_solid();
        Ok(self)
    }

    /// Checks that the surface can have this thickness.
    ///
    /// # Errors
    ///
    /// Those of [`Formula::thickened_by`].
    pub(crate) fn check_thickness(&self, thickness: &Thickness) -> Result<(), FormulaError> {
        Shell::new(thickness, &self.parameters).map(drop)
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

    /// Thickness of the shell that is sampled instead of the surface, see [`Formula::thickened`].
    #[must_use]
    pub fn thickness(&self) -> Option<&Thickness> {
        self.solid.shell.as_ref().map(|shell| &shell.thickness)
    }

    /// The box whose faces close the solid, see [`Formula::closed_by`].
    #[must_use]
    pub fn closing_box(&self) -> Option<Bounds> {
        self.solid.closed
    }

    /// Whether the closing box is a cell, see [`Formula::repeated_in`].
    pub(crate) fn is_cell(&self) -> bool {
        self.solid.closed.is_some() && self.solid.is_cell
    }

    /// Compiles the solid made of the surface again, from f.
    fn make_solid(&mut self) {
        let (mut graph, mut f) = (*self.surface).clone();
        // A box alone closes the solid behind the surface, which needs no limits.
        let is_surface = self.solid.shell.is_some() || self.solid.closed.is_none();
        self.scales = Scales::default();
        if self.is_regular
            && is_surface
            && let Some(within) = regular::within_limits(&graph, f, &self.values, &mut self.scales)
        {
            (graph, f) = within;
        }
        let root = self.solid.made_of(&mut graph, f);
        let (mut graph, mut root) = graph.part(root);
        self.flush = Arc::default();
        let scales = &mut self.scales;
        if self.is_regular
            && let Some(regular) = regular::regular(&graph, root, &self.values, scales)
        {
            let text = |&face: &Id| format!("{} = 0", display::node(&regular.graph, face, &self.parameters));
            self.flush = regular.flush.iter().map(text).collect();
            (graph, root) = regular.graph.part(regular.root);
        }
        self.use_compiled(Compiled::from_graph(graph, root, &self.values));
    }

    fn use_compiled(&mut self, compiled: Compiled) {
        self.branches = SharedBranches::new(Branches::new(&compiled, &self.values));
        self.compiled = compiled;
    }

    /// Text that was parsed.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.written.text
    }

    /// Formula in normal form: with explicit products and no redundant brackets. It is ASCII except
    /// for Greek names, and parsing it gives the same field.
    #[must_use]
    #[doc(hidden)]
    pub fn normal_form(&self) -> String {
        display::plain_equation(&self.written.equation)
    }

    /// Whether both formulas have the same syntax tree, regardless of spans.
    #[must_use]
    #[doc(hidden)]
    pub fn same_tree(&self, other: &Self) -> bool {
        self.written.equation == other.written.equation
    }

    /// Formula in presentation MathML: the content of a `math` element.
    #[must_use]
    #[doc(hidden)]
    pub fn mathml(&self) -> MathNode {
        mathml::equation(&self.written.equation, &self.written.columns)
    }

    /// Parameters that the formula uses: the declared ones, then the automatic ones.
    #[must_use]
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// Names of the parameters that were not declared.
    #[must_use]
    pub fn auto(&self) -> &[String] {
        &self.written.automatic
    }

    /// Whether f is the same everywhere for any values of the parameters. Such a field has no
    /// surface.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.compiled.is_constant
    }

    /// Sets the value of a parameter, which may lie outside the range of its slider. A declared
    /// parameter that the formula does not use is accepted and has no effect.
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
            if self.written.unused.iter().any(|unused| unused == name) {
                return Ok(());
            }
            let message = format!("The formula has no parameter `{name}`");
            return Err(FormulaError::new(FormulaErrorKind::BadParameter, 0..0, message));
        };
        self.parameters[index].value = value;
        self.values[index] = value;
        if self.scales.have_turned(&self.values) {
            self.make_solid();
            return Ok(());
        }
        self.compiled.set_parameters(&self.values);
        self.branches.set_parameters(&self.values);
        Ok(())
    }

    /// f, ∇f and ∇∇f at `p`, computed in double precision from the transformed graphs that the
    /// batched programs are compiled from. It equals [`Field::jet`] up to rounding and is derived
    /// independently of it.
    #[doc(hidden)]
    #[must_use]
    pub fn transformed_jet(&self, p: DVec3) -> Jet {
        self.compiled.transformed_jet(p)
    }

    /// Bounds on the differences that rounding makes between [`Field::jet`] and
    /// [`Formula::transformed_jet`] at each of `points`, with the order of the operations within
    /// one node left aside: of the value, the gradient, and the Hessian (xx, xy, xz, yy, yz, zz).
    #[doc(hidden)]
    #[must_use]
    pub fn rounding(&self, points: &[DVec3]) -> Vec<[f64; 10]> {
        self.compiled.rounding(points)
    }

    /// Returns this formula with other branches.
    fn with_branches(&self, branches: Branches) -> Arc<dyn Piecewise> {
        let compiled = self.compiled.clone();
        Arc::new(Self { branches: SharedBranches::new(branches), compiled, ..self.clone() })
    }
}

/// Syntax tree of `text`, and its undeclared names.
fn syntax(text: &str, declared: &[&str]) -> Result<(statements::Parsed, Vec<String>), FormulaError> {
    let parsed = statements::parse(text, declared)?;
    let automatic = automatic_names(text, &parsed, declared)?;
    match polar::error(text, &parsed, declared) {
        Some(error) => Err(error),
        None => Ok((parsed, automatic)),
    }
}

/// The number that a text without names stands for, in the language of formulas: `2*pi`, `1e-3`,
/// `sqrt(2)/3`.
///
/// # Errors
///
/// Any of [`FormulaErrorKind`], with its span in bytes of `text`: [`FormulaErrorKind::UnknownName`]
/// for a coordinate or a parameter.
pub fn number(text: &str) -> Result<f64, FormulaError> {
    let statements::Parsed { equation, names, .. } = statements::parse(text, &[])?;
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
            return bad(format!(
                "`{name}` cannot be the name of a parameter: a name is a letter, then letters, digits and _"
            ));
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
    fn value_and_gradient(&self, p: DVec3) -> (f64, DVec3) {
        FormulaEvaluator::new(self, Frame::default()).value_and_gradient(p)
    }

    fn jet(&self, p: DVec3) -> Jet {
        FormulaEvaluator::new(self, Frame::default()).jet(p)
    }

    /// Around another origin than zero batches are computed in double precision, which takes
    /// longer.
    fn evaluator(&self, frame: Frame) -> Box<dyn Evaluator + '_> {
        Box::new(FormulaEvaluator::new(self, frame))
    }

    fn facts(&self) -> Facts {
        let of_surface = self.surface_periods();
        let is_closed = self.solid.closed.is_some();
        let has_coordinates = self.surface.0.nodes().iter().any(|node| matches!(node, Node::Coordinate(_)));
        let first = self.parameters.first().filter(|_| !has_coordinates);
        Facts {
            periods: if is_closed { [None; 3] } else { of_surface },
            unit_cell: self.solid.closed.filter(|_| self.solid.is_cell).map(|bounds| {
                let size = bounds.size();
                let is_repeated =
                    |axis: usize| of_surface[axis].is_some_and(|p| periods::is_whole(size[axis], p));
                UnitCell { bounds, repeats: [0, 1, 2].map(is_repeated) }
            }),
            sampled_as: self.simplified.as_deref().map(display::plain_equation),
            flush_faces: self.flush.to_vec(),
            unused: self.written.idle.clone(),
            why_constant: first.map(|first| spelling::no_coordinate(&first.name)),
            ..Facts::default()
        }
    }

    fn piecewise(&self) -> Option<&dyn Piecewise> {
        Some(self)
    }

    fn columns(&self) -> Vec<(&'static str, Value)> {
        value::of_columns(&self.written.columns, &self.parameters)
    }

    /// An offset of the solid is another function than its text.
    fn formula(&self) -> Option<&Formula> {
        (!self.solid.is_turned()).then_some(self)
    }
}

impl Piecewise for Formula {
    fn pieces_in<'a>(
        &'a self,
        bounds: &Bounds,
        width: f64,
        _: u32,
    ) -> Work<'a, (Vec<Bounds>, Arc<dyn Piecewise>)> {
        let bounds = *bounds;
        Box::pin(async move {
            let (cells, branches) = Branches::found_in(&self.compiled, &self.values, &bounds, width).await;
            (cells, self.with_branches(branches))
        })
    }

    /// The numbers of branches outlast a change of the parameters, unless that brings the width of
    /// a smooth minimum to 0 or an exponent to 1.
    fn with_pieces_of(&self, other: &dyn Piecewise) -> Arc<dyn Piecewise> {
        let other = (other as &dyn Any).downcast_ref::<Self>();
        let is_same = |other: &&Self| Arc::ptr_eq(&self.compiled.graph, &other.compiled.graph);
        let Some(other) = other.filter(is_same) else { return Arc::new(self.clone()) };
        let mut branches = other.branches.lock().clone();
        branches.set_parameters(&self.values);
        self.with_branches(branches)
    }

    fn turned(&self, is_negative: bool, shift: f64) -> Arc<dyn Field> {
        let mut turned = self.clone();
        turned.solid.turn(is_negative, shift);
        turned.make_solid();
        Arc::new(turned)
    }
}
