//! What there is to choose and to read, described so that an interface can be generated from it: a new surface, setting
//! or figure needs no new code anywhere else.

use crate::field::formula::{FUNCTIONS, FunctionInfo, Parameter};
use crate::field::gallery::{self, Surface};
use crate::field::model::{MODELS, Model};
use crate::math::Bounds;
use crate::sampler::{GapPolicy, LawKind, Method, Placement, Sampling, Settings, SizeMode};
use serde::Serialize;

/// The whole description.
#[derive(Clone, Debug, Serialize)]
pub struct Description {
    /// Version of this crate.
    pub version: &'static str,
    /// Identifier of the surface to begin with.
    pub default_surface: &'static str,
    /// The gallery.
    pub surfaces: Vec<SurfaceEntry>,
    /// The models from points.
    pub models: &'static [Model],
    /// Settings of a run.
    pub settings: Vec<Setting>,
    /// Rows of the report.
    pub report: &'static [ReportRow],
    /// What can become of a child.
    pub fates: &'static [Fate],
    /// Functions of the formula language.
    pub functions: &'static [FunctionInfo],
    /// Ways to colour the particles.
    pub colours: &'static [Colour],
}

/// A gallery surface.
#[derive(Clone, Debug, Serialize)]
pub struct SurfaceEntry {
    /// Identifier.
    pub id: &'static str,
    /// Name.
    pub name: &'static str,
    /// Formula.
    pub formula: &'static str,
    /// Parameters with their ranges.
    pub parameters: Vec<Parameter>,
    /// Clip box.
    pub bounds: Bounds,
    /// Degree of the polynomial, if it is one.
    pub degree: Option<u32>,
    /// Genus, where the surface is closed, connected and smooth.
    pub genus: Option<u32>,
    /// Two sentences about it.
    pub story: &'static str,
}

/// A setting of a run.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Setting {
    /// Name in [`Settings`].
    pub name: &'static str,
    /// Name for a person.
    pub label: &'static str,
    /// Group it is shown in.
    pub group: &'static str,
    /// `number`, `integer` or `choice`.
    pub kind: &'static str,
    /// Default value.
    pub default: Value,
    /// Smallest value.
    pub min: Option<f64>,
    /// Largest value.
    pub max: Option<f64>,
    /// Step of a slider; on a logarithmic scale a factor minus one.
    pub step: Option<f64>,
    /// `linear` or `log`.
    pub scale: &'static str,
    /// Unit; `%` shows the value times 100.
    pub unit: &'static str,
    /// Values of a choice.
    pub choices: &'static [Choice],
    /// One line of explanation.
    pub help: &'static str,
    /// Shown only while all of these hold; always if there is none.
    pub when: &'static [Condition],
}

/// The value of a setting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// Of a number.
    Number(f64),
    /// Of a whole number.
    Integer(u64),
    /// Of the choice of the size.
    Size(SizeMode),
    /// Of the choice of the method.
    Method(Method),
    /// Of the choice about gaps.
    Gaps(GapPolicy),
    /// Of the choice between one size and many.
    Sampling(Sampling),
    /// Of the choice of the radius law.
    Law(LawKind),
    /// Of the choice of the placement.
    Placement(Placement),
}

/// Another setting's value, on which it depends whether a setting is shown.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Condition {
    /// Name of another setting.
    pub name: &'static str,
    /// One of its choices.
    pub value: &'static str,
    /// Whether it has that value then, or another one.
    pub equal: bool,
}

/// One value of a choice.
#[derive(Clone, Debug, Serialize)]
pub struct Choice {
    /// Value.
    pub value: &'static str,
    /// Name for a person.
    pub label: &'static str,
}

/// A row of the report.
#[derive(Clone, Debug, Serialize)]
pub struct ReportRow {
    /// Path into the report. What is null there has no place in the run.
    pub key: &'static str,
    /// Path of the upper end, if the row is a range that begins at `key`.
    pub to: Option<&'static str>,
    /// Path of the figure that stands in its place where that one is there: what a lattice of one size is the measure of says
    /// nothing of particles of many.
    pub unless: Option<&'static str>,
    /// Name for a person.
    pub label: &'static str,
    /// Group it is shown in.
    pub group: &'static str,
    /// Unit; `%` shows the value times 100.
    pub unit: &'static str,
    /// Digits after the point.
    pub digits: u8,
    /// The ideal value, in words.
    pub ideal: &'static str,
    /// Which way is better.
    pub better: Option<&'static str>,
    /// Definition and meaning.
    pub help: &'static str,
}

/// What can become of a child.
#[derive(Clone, Debug, Serialize)]
pub struct Fate {
    /// Name, as in the report's counts.
    pub name: &'static str,
    /// Name for a person.
    pub label: &'static str,
    /// One line of explanation.
    pub help: &'static str,
}

/// A way to colour the particles.
#[derive(Clone, Debug, Serialize)]
pub struct Colour {
    /// Identifier.
    pub id: &'static str,
    /// Name for a person.
    pub label: &'static str,
    /// One line of explanation.
    pub help: &'static str,
    /// Unit of the legend.
    pub unit: &'static str,
}

/// Describes everything there is.
#[must_use]
pub fn describe() -> Description {
    Description {
        version: env!("CARGO_PKG_VERSION"),
        default_surface: gallery::SURFACES[0].id,
        surfaces: gallery::SURFACES.iter().map(surface).collect(),
        models: MODELS,
        settings: settings(),
        report: REPORT,
        fates: FATES,
        functions: FUNCTIONS,
        colours: COLOURS,
    }
}

fn surface(surface: &Surface) -> SurfaceEntry {
    SurfaceEntry {
        id: surface.id,
        name: surface.name,
        formula: surface.formula,
        parameters: surface.declared(),
        bounds: surface.bounds,
        degree: surface.degree,
        genus: surface.genus,
        story: surface.story,
    }
}

/// The settings, each with its range where that is not its own.
fn settings() -> Vec<Setting> {
    let range = |name: &str| Settings::RANGES.into_iter().find(|r| r.0 == name).map(|r| (r.1, r.2));
    let ranged = |setting: &Setting| {
        let (min, max) = range(setting.name).unzip();
        Setting { min: setting.min.or(min), max: setting.max.or(max), ..*setting }
    };
    SETTINGS.iter().map(ranged).collect()
}

const fn number(name: &'static str, label: &'static str, default: Value, step: f64) -> Setting {
    Setting {
        name,
        label,
        group: "Sampling",
        kind: if matches!(default, Value::Number(_)) { "number" } else { "integer" },
        default,
        min: None,
        max: None,
        step: Some(step),
        scale: "linear",
        unit: "",
        choices: &[],
        help: "",
        when: &[],
    }
}

const fn when(name: &'static str, value: &'static str) -> Condition {
    Condition { name, value, equal: true }
}

const DEFAULT: Settings = Settings::DEFAULT;
const UNIFORM: Condition = when("sampling", "uniform");
const ADAPTIVE: Condition = when("sampling", "adaptive");

const SETTINGS: &[Setting] = &[
    Setting {
        kind: "choice",
        step: None,
        choices: &[
            Choice { value: "uniform", label: "Uniform" },
            Choice { value: "adaptive", label: "Adaptive" },
        ],
        help: "One size everywhere, or sizes that follow the curvature: small particles where the surface bends, large ones where it is flat.",
        ..number("sampling", "Sampling", Value::Sampling(DEFAULT.sampling), 0.0)
    },
    Setting {
        kind: "choice",
        step: None,
        choices: &[Choice { value: "radius", label: "Radius" }, Choice { value: "count", label: "Count" }],
        help: "Give the size of the particles (or, for adaptive sampling, its law), or how many there should be.",
        ..number("size_mode", "Size by", Value::Size(DEFAULT.size_mode), 0.0)
    },
    Setting {
        scale: "log",
        unit: "%",
        help: "Repulsion radius r as a share of the box diagonal; neighbours sit 2r apart. The paper shows 2 % and 0.6 %.",
        when: &[UNIFORM, when("size_mode", "radius")],
        ..number("radius_share", "Radius", Value::Number(DEFAULT.radius_share), 0.01)
    },
    Setting {
        scale: "log",
        unit: "particles",
        help: "Wanted number of particles, met within 3 %. Adaptive sampling scales all radii by one factor.",
        when: &[when("size_mode", "count")],
        ..number("count", "Count", Value::Integer(DEFAULT.count as u64), 0.01)
    },
    Setting {
        kind: "choice",
        step: None,
        choices: &[
            Choice { value: "chord_error", label: "Chord error" },
            Choice { value: "max_curvature", label: "Largest curvature" },
            Choice { value: "sum_of_curvatures", label: "Sum of curvatures" },
        ],
        help: "How the radius follows from the principal curvatures. The paper takes their sum, which vanishes on saddles.",
        when: &[ADAPTIVE],
        ..number("radius_law", "Radius law", Value::Law(DEFAULT.radius_law), 0.0)
    },
    Setting {
        scale: "log",
        unit: "%",
        help: "Largest gap between the surface and a triangle of neighbours, as a share of the box diagonal.",
        when: &[ADAPTIVE, when("radius_law", "chord_error")],
        ..number("chord_error", "Chord error", Value::Number(DEFAULT.chord_error), 0.01)
    },
    Setting {
        scale: "log",
        unit: "× 1/κ",
        help: "Radius of a particle over the radius of curvature under it: half the angle between the normals of neighbours.",
        when: &[ADAPTIVE, Condition { equal: false, ..when("radius_law", "chord_error") }],
        ..number("curvature_scale", "Curvature scale", Value::Number(DEFAULT.curvature_scale), 0.01)
    },
    Setting {
        scale: "log",
        unit: "%",
        group: "Advanced",
        help: "No particle is smaller than this share of the box diagonal.",
        when: &[ADAPTIVE],
        ..number("radius_min_share", "Smallest radius", Value::Number(DEFAULT.radius_min_share), 0.01)
    },
    Setting {
        scale: "log",
        unit: "%",
        group: "Advanced",
        help: "No particle is larger than this share of the box diagonal.",
        when: &[ADAPTIVE],
        ..number("radius_max_share", "Largest radius", Value::Number(DEFAULT.radius_max_share), 0.01)
    },
    Setting {
        group: "Advanced",
        help: "Slope L of the radius along the surface. The radii of neighbours differ by the factor (1 + L)/(1 − L) at most: 1.5 for 0.2.",
        when: &[ADAPTIVE],
        ..number("grading", "Grading", Value::Number(DEFAULT.grading), 0.01)
    },
    Setting {
        kind: "choice",
        step: None,
        group: "Advanced",
        choices: &[
            Choice { value: "direct", label: "Direct" },
            Choice { value: "faithful", label: "As in the paper" },
        ],
        help: "Where a child touches its parent and its neighbour is solved for, or found by pushing it step by step.",
        when: &[ADAPTIVE],
        ..number("placement", "Placement", Value::Placement(DEFAULT.placement), 0.0)
    },
    Setting {
        max: Some(100.0),
        unit: "steps",
        help: "Steps of repulsion after the generation: Gaussian for one size, by overlap for many. The paper takes ten.",
        ..number("relax_steps", "Relaxation", Value::Integer(DEFAULT.relax_steps as u64), 1.0)
    },
    Setting {
        kind: "choice",
        step: None,
        group: "Advanced",
        choices: &[Choice { value: "front", label: "Front" }, Choice { value: "refined", label: "Refined" }],
        help: "A front and relaxation, as in the paper, or a coarse front that is brought into order and refined: more even, on closed smooth surfaces.",
        when: &[UNIFORM],
        ..number("method", "Method", Value::Method(DEFAULT.method), 0.0)
    },
    Setting {
        unit: "× 2r",
        group: "Advanced",
        help: "A child joins an existing particle within this distance. Smaller places more and closer particles where fronts meet, larger leaves wider gaps.",
        when: &[UNIFORM],
        ..number("match_tolerance", "Match tolerance", Value::Number(DEFAULT.match_tolerance), 0.01)
    },
    Setting {
        kind: "choice",
        step: None,
        group: "Advanced",
        choices: &[Choice { value: "fill", label: "Fill" }, Choice { value: "leave", label: "Leave" }],
        help: "Where fronts meet, gaps can be wide enough for a particle. The paper leaves them to the relaxation.",
        ..number("gaps", "Gaps", Value::Gaps(DEFAULT.gaps), 0.0)
    },
    Setting {
        min: Some(0.0),
        max: Some(999_999.0),
        group: "Advanced",
        help: "Chooses the point on the surface where the front begins.",
        ..number("seed", "Seed", Value::Integer(DEFAULT.seed), 1.0)
    },
    Setting {
        scale: "log",
        unit: "particles",
        group: "Advanced",
        help: "The run stops when it has placed this many.",
        ..number("max_particles", "Limit", Value::Integer(DEFAULT.max_particles as u64), 0.01)
    },
];

const fn row(
    key: &'static str,
    label: &'static str,
    (group, unit, digits): (&'static str, &'static str, u8),
    (ideal, better): (&'static str, Option<&'static str>),
    help: &'static str,
) -> ReportRow {
    ReportRow { key, to: None, unless: None, label, group, unit, digits, ideal, better, help }
}

const LOWER: Option<&str> = Some("lower");
const HIGHER: Option<&str> = Some("higher");

const REPORT: &[ReportRow] = &[
    row("count", "Particles", ("Run", "", 0), ("", None), "Particles on the surface."),
    ReportRow {
        to: Some("radius_max"),
        ..row(
            "radius_min",
            "Radius",
            ("Run", "", 4),
            ("", None),
            "Repulsion radius, in the units of x, y and z; of the smallest particle and of the largest where they differ.",
        )
    },
    row(
        "levels",
        "Generation levels",
        ("Run", "", 0),
        ("", None),
        "Rings of particles, each placed by the one before it.",
    ),
    row(
        "components_seeded",
        "Fronts",
        ("Run", "", 0),
        ("", None),
        "Fronts started, each from a point that no particle covered: at least one for every component of the surface.",
    ),
    row(
        "gaps_filled",
        "Gaps filled",
        ("Run", "", 0),
        ("", None),
        "Particles placed after the fronts had met, in gaps wide enough for one.",
    ),
    row(
        "evaluations_per_particle",
        "Evaluations per particle",
        ("Run", "", 2),
        ("about 2", LOWER),
        "Field evaluations of the front divided by the particles it placed.",
    ),
    row(
        "quality.six",
        "Six neighbours",
        ("Order", "%", 1),
        ("100 %", HIGHER),
        "Share of the particles with exactly six natural neighbours, those of their Voronoi cell in the tangent plane. A closed surface of genus 0 must have at least twelve without.",
    ),
    row(
        "quality.psi6",
        "Hexagonal order ψ₆",
        ("Order", "", 3),
        ("1", HIGHER),
        "Mean of |mean of exp(6iθ) over the natural neighbours|: 1 for a perfect hexagonal lattice.",
    ),
    row(
        "quality.ang_min_mean",
        "Mean smallest angle",
        ("Triangles", "°", 1),
        ("60°", HIGHER),
        "Mean over the triangles of natural neighbours of their smallest angle.",
    ),
    row(
        "quality.ang_min",
        "Smallest angle",
        ("Triangles", "°", 1),
        ("60°", HIGHER),
        "Smallest angle of any triangle of natural neighbours.",
    ),
    row(
        "quality.lt30",
        "Angles below 30°",
        ("Triangles", "%", 2),
        ("0 %", LOWER),
        "Share of the triangles with an angle below 30°.",
    ),
    row(
        "quality.gt90",
        "Angles above 90°",
        ("Triangles", "%", 2),
        ("0 %", LOWER),
        "Share of the triangles with an angle above 90°.",
    ),
    ReportRow {
        unless: Some("quality.cover_local"),
        ..row(
            "quality.cover",
            "Largest hole",
            ("Spacing", "", 2),
            ("1", LOWER),
            "Radius of the largest empty disc on the surface over that of a perfect hexagonal lattice of as many particles.",
        )
    },
    ReportRow {
        unless: Some("quality.overlap_min"),
        ..row(
            "quality.rho",
            "Closest pair",
            ("Spacing", "", 3),
            ("1", HIGHER),
            "Distance of the closest pair over the spacing of a perfect hexagonal lattice of as many particles: the normalised Poisson-disk radius.",
        )
    },
    ReportRow {
        unless: Some("quality.size_cv"),
        ..row(
            "quality.nn_cv",
            "Spacing variation",
            ("Spacing", "%", 1),
            ("0 %", LOWER),
            "Standard deviation of the distance to the nearest neighbour over its mean.",
        )
    },
    row(
        "quality.size_cv",
        "Spacing variation",
        ("Spacing", "%", 1),
        ("0 %", LOWER),
        "Standard deviation over mean of the distance between natural neighbours over the sum of their radii.",
    ),
    row(
        "quality.cover_local",
        "Largest hole",
        ("Spacing", "", 2),
        ("1", LOWER),
        "Radius of the largest empty disc on the surface over that of a perfect hexagonal lattice of particles as large as those around it.",
    ),
    row(
        "quality.overlap_min",
        "Closest pair",
        ("Spacing", "", 3),
        ("1", HIGHER),
        "Smallest distance of two neighbours over the sum of their radii.",
    ),
    ReportRow {
        unless: Some("quality.size_cv"),
        ..row(
            "quality.edge_cv",
            "Edge variation",
            ("Spacing", "%", 1),
            ("0 %", LOWER),
            "Standard deviation of the distance between natural neighbours over its mean.",
        )
    },
    row(
        "quality.err_max",
        "Largest residual",
        ("Accuracy", "", 6),
        ("0", LOWER),
        "Largest distance |f|/|∇f| from the surface over the spacing of a perfect lattice.",
    ),
    row(
        "quality.err_mean",
        "Mean residual",
        ("Accuracy", "", 6),
        ("0", LOWER),
        "Mean distance |f|/|∇f| from the surface over the spacing of a perfect lattice.",
    ),
    row(
        "quality.area",
        "Area",
        ("Surface", "units²", 3),
        ("", None),
        "Area of the triangles of natural neighbours.",
    ),
    row(
        "quality.euler",
        "Euler number",
        ("Surface", "", 0),
        ("", None),
        "Vertices − edges + faces of the triangles of natural neighbours: 2 − 2g for a closed surface of genus g, summed over its components.",
    ),
    row(
        "components",
        "Connected components",
        ("Surface", "", 0),
        ("", None),
        "Components of the mesh of natural neighbours. Parts that are joined only at a singular point count separately.",
    ),
    row(
        "search",
        "All components found",
        ("Surface", "", 0),
        ("proven", None),
        "Proven: interval arithmetic shows that a front began on every component of the surface in the box. By dense search: the field was evaluated at the nodes of a grid, which can miss a component smaller than its cells.",
    ),
    row(
        "undecided_cells",
        "Undecided cells",
        ("Surface", "", 0),
        ("0", LOWER),
        "Cells of the box in which the proof could neither find a component nor rule one out.",
    ),
    row(
        "singular_points",
        "Singular points",
        ("Surface", "", 0),
        ("", None),
        "Places where f has no gradient on the surface, such as the tip of a cone; a curve of them counts as one. Particles within 2r of one are marked in the exported files.",
    ),
];

const FATES: &[Fate] = &[
    Fate { name: "added", label: "Added", help: "A new particle was placed." },
    Fate { name: "matched", label: "Matched", help: "A particle of the same sheet sits there already." },
    Fate {
        name: "not_converged",
        label: "Not converged",
        help: "The circle around the parent met no point of the surface.",
    },
    Fate { name: "outside", label: "Outside", help: "The point lies outside the clip box." },
    Fate { name: "undefined", label: "Undefined", help: "f has no value or no gradient there." },
    Fate { name: "capped", label: "Capped", help: "The limit on particles was reached." },
];

const COLOURS: &[Colour] = &[
    Colour {
        id: "level",
        label: "Generation level",
        help: "Rings in the order in which they were placed; the colours repeat every twelve levels.",
        unit: "",
    },
    Colour {
        id: "fate",
        label: "Fate of the children",
        help: "Interior, at the border of the box, or next to a place where a child found no surface.",
        unit: "",
    },
    Colour {
        id: "valence",
        label: "Neighbours",
        help: "Number of natural neighbours; six is ideal.",
        unit: "",
    },
    Colour {
        id: "nearest",
        label: "Nearest distance",
        help: "Distance to the nearest particle over 2r.",
        unit: "× 2r",
    },
    Colour {
        id: "radius",
        label: "Radius",
        help: "Repulsion radius, from the smallest particle to the largest.",
        unit: "",
    },
    Colour {
        id: "curvature",
        label: "Mean curvature",
        help: "(κ₁ + κ₂)/2: orange where the surface bulges outward as a sphere does, blue where it is hollow, grey where it is flat or bends both ways alike.",
        unit: "1/length",
    },
    Colour {
        id: "component",
        label: "Connected component",
        help: "Components of the mesh of natural neighbours, the largest first. The colours repeat after twelve.",
        unit: "",
    },
    Colour { id: "normal", label: "Normal", help: "Direction of the outward normal.", unit: "" },
    Colour { id: "plain", label: "Plain", help: "One colour.", unit: "" },
];
