//! Description of surfaces, settings and figures, from which an interface can be generated: a new
//! surface, setting or figure needs no new code anywhere else.

use super::setting::{self, Setting};
use crate::export::{COLUMNS, Column, Presence, VERTICES, VerticesChoice};
use crate::field::formula::{FUNCTIONS, FunctionInfo, MAX_FORMULA_BYTES, Parameter, name_pattern};
use crate::field::gallery::{self, Surface, SurfaceGroup};
use crate::field::model::{self, MODELS, Model};
use crate::math::Bounds;
use crate::sampler::COUNT_ROOM;
use serde::Serialize;

/// The whole description.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Description {
    /// Version of this crate.
    pub version: &'static str,
    /// The gallery. Its first surface is shown at the start.
    pub surfaces: Vec<SurfaceEntry>,
    /// The models from points.
    pub models: &'static [Model],
    /// Settings of a run.
    pub settings: Vec<Setting>,
    /// Rows of the report.
    pub report: &'static [ReportRow],
    /// The fates of a child.
    pub fates: &'static [Fate],
    /// Functions of the formula language.
    pub functions: &'static [FunctionInfo],
    /// Ways to colour the particles.
    pub colours: &'static [Colour],
    /// Columns of PLY and CSV files.
    pub columns: Vec<&'static Column>,
    /// Ways to write the vertices of mesh files, the default first.
    pub vertices: &'static [VerticesChoice],
    /// Template of a new parameter, without its name.
    pub new_parameter: Parameter,
    /// Largest and smallest values that the core accepts.
    pub limits: Limits,
}

/// The limits of what the core accepts.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Limits {
    /// Longest formula, in bytes of UTF-8.
    pub formula_bytes: usize,
    /// The names that parameters may have, as a regular expression of JavaScript.
    pub name_pattern: String,
    /// Smallest diagonal of a clip box.
    pub diagonal_min: f64,
    /// Largest diagonal of a clip box.
    pub diagonal_max: f64,
    /// Largest coordinate of a clip box, in its diagonals.
    pub farthest_corner: f64,
    /// Room for the particles that are expected, as a multiple of them.
    pub count_room: f64,
    /// Smallest number of points of a model or a file that can be fitted, if it has as many.
    pub centres_min: u32,
    /// Largest number of points of a model or a file that can be fitted.
    pub centres_max: u32,
    /// Number of points that are fitted by default.
    pub centres: u32,
    /// Size of the largest file of points that is read.
    pub file_bytes: u32,
}

/// A surface in the gallery.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct SurfaceEntry {
    /// The surface.
    #[serde(flatten)]
    pub surface: &'static Surface,
    /// Parameters with their ranges.
    pub parameters: Vec<Parameter>,
    /// Name of the group of the surface in the gallery.
    pub group: &'static str,
}

/// A row of the report.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct ReportRow {
    /// Path of the figure in the report. A figure that is null there does not apply to the run.
    pub key: &'static str,
    /// Path of the upper end, if the row is a range that begins at `key`.
    pub to: Option<&'static str>,
    /// Path of the figure that replaces this one if the report has it: a figure that is relative to
    /// the lattice of one size does not apply to particles of many sizes.
    pub unless: Option<&'static str>,
    /// Name for a person.
    pub label: &'static str,
    /// Group in which the row is shown.
    pub group: &'static str,
    /// Unit; `%` shows the value times 100.
    pub unit: &'static str,
    /// Digits after the point.
    pub digits: u8,
    /// The ideal value, in words.
    pub ideal: &'static str,
    /// Whether lower or higher is better.
    pub better: Option<&'static str>,
    /// Definition and meaning.
    pub help: &'static str,
    /// Path to the list of places in the picture that the figure is about.
    pub places: Option<&'static str>,
}

/// A fate of a child.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Fate {
    /// Name, as in the report's counts.
    pub name: &'static str,
    /// Name for a person.
    pub label: &'static str,
    /// Explanation in one line.
    pub help: &'static str,
}

/// A way to colour the particles.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Colour {
    /// Identifier.
    pub id: ColourMode,
    /// Name for a person.
    pub label: &'static str,
    /// Explanation in one line.
    pub help: &'static str,
    /// Unit of the legend.
    pub unit: &'static str,
}

/// The quantity that colours the particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum ColourMode {
    /// Generation level.
    Level,
    /// Fate of the slots.
    Fate,
    /// Number of neighbours.
    Valence,
    /// Distance to the nearest particle.
    Nearest,
    /// Energy among the neighbours.
    Energy,
    /// Distance to the surface.
    Residual,
    /// Repulsion radius.
    Radius,
    /// Mean curvature.
    Curvature,
    /// Connected component.
    Component,
    /// Direction of the normal.
    Normal,
    /// A value by a formula.
    Value,
    /// The colours that the surface has.
    Own,
    /// No quantity: all particles have one colour.
    Plain,
}

/// Returns the whole description.
#[must_use]
pub fn describe() -> Description {
    Description {
        version: env!("CARGO_PKG_VERSION"),
        surfaces: surfaces(),
        models: MODELS,
        settings: setting::with_spacing(),
        report: REPORT,
        fates: FATES,
        functions: FUNCTIONS,
        colours: COLOURS,
        // The page saves the result of a run.
        columns: COLUMNS.iter().filter(|column| column.presence != Presence::Moved).collect(),
        vertices: VERTICES,
        new_parameter: Parameter::automatic(""),
        limits: Limits {
            formula_bytes: MAX_FORMULA_BYTES,
            name_pattern: name_pattern(),
            diagonal_min: *Bounds::DIAGONALS.start(),
            diagonal_max: *Bounds::DIAGONALS.end(),
            farthest_corner: Bounds::FARTHEST_CORNER,
            count_room: COUNT_ROOM,
            centres_min: *model::CENTRES.start(),
            centres_max: *model::CENTRES.end(),
            centres: model::DEFAULT_CENTRES,
            file_bytes: model::MAX_FILE_BYTES,
        },
    }
}

fn surfaces() -> Vec<SurfaceEntry> {
    let entries = |group: &'static SurfaceGroup| {
        group.surfaces.iter().map(|surface| SurfaceEntry {
            surface,
            parameters: surface.parameters.to_vec(),
            group: group.name,
        })
    };
    gallery::GROUPS.iter().flat_map(entries).collect()
}

/// A row of a count without an ideal.
const fn row(key: &'static str, label: &'static str, group: &'static str) -> ReportRow {
    let (to, unless, better, places) = (None, None, None, None);
    ReportRow { key, to, unless, label, group, unit: "", digits: 0, ideal: "", better, help: "", places }
}

impl ReportRow {
    const fn to(self, upper: &'static str) -> Self {
        Self { to: Some(upper), ..self }
    }

    const fn unless(self, other: &'static str) -> Self {
        Self { unless: Some(other), ..self }
    }

    const fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    const fn digits(self, digits: u8) -> Self {
        Self { digits, ..self }
    }

    const fn ideal(self, ideal: &'static str) -> Self {
        Self { ideal, ..self }
    }

    /// The lower, the better.
    const fn down_to(self, ideal: &'static str) -> Self {
        Self { ideal, better: Some("lower"), ..self }
    }

    /// The higher, the better.
    const fn up_to(self, ideal: &'static str) -> Self {
        Self { ideal, better: Some("higher"), ..self }
    }

    const fn places(self, places: &'static str) -> Self {
        Self { places: Some(places), ..self }
    }

    const fn help(self, help: &'static str) -> Self {
        Self { help, ..self }
    }
}

const PAIRS: &str = "places.pairs";
const HOLES: &str = "places.holes";

const REPORT: &[ReportRow] = &[
    row("count", "Particles", "Run")
        .help("Particles on the surface."),
    row("radius_min", "Radius", "Run").to("radius_max").digits(4)
        .help("Repulsion radius, in the units of x, y and z; of the smallest particle and of the largest where they differ."),
    row("levels", "Generation levels", "Run")
        .help("Rings of particles, each placed by the one before it."),
    row("components_seeded", "Fronts", "Run")
        .help("Fronts started, each from a point that no particle covered: at least one for every component of the surface."),
    row("gaps_filled", "Gaps filled", "Run")
        .help("Particles placed after the fronts had met, in gaps wide enough for one."),
    row("evaluations_per_particle", "Evaluations per particle", "Run").digits(2).down_to("about 2")
        .help("Field evaluations of the front divided by the particles it placed."),
    row("quality.six_neighbours", "Six neighbours", "Order").unit("%").digits(1).up_to("100 %")
        .help("Share of the particles with exactly six natural neighbours, those of their Voronoi cell in the tangent plane. A closed surface of genus 0 must have at least twelve without."),
    row("quality.bond_order", "Hexagonal order ψ₆", "Order").digits(3).up_to("1")
        .help("Mean of |mean of exp(6iθ) over the natural neighbours|: 1 for a perfect hexagonal lattice."),
    row("quality.mean_smallest_angle", "Mean smallest angle", "Triangles").unit("°").digits(1).up_to("60°")
        .help("Mean over the triangles of natural neighbours of their smallest angle."),
    row("quality.smallest_angle", "Smallest angle", "Triangles").unit("°").digits(1).up_to("60°").unless("smallest_angle")
        .help("Smallest angle of any triangle of natural neighbours."),
    row("smallest_angle", "Smallest angle, with the border", "Mesh").unit("°").digits(1).up_to("60°")
        .help("Smallest angle of any triangle of the mesh, as it stands in its file: those at its border among them, which the other figures leave out."),
    row("quality.triangles_below_30", "Angles below 30°", "Triangles").unit("%").digits(2).down_to("0 %")
        .help("Share of the triangles with an angle below 30°."),
    row("quality.triangles_above_90", "Angles above 90°", "Triangles").unit("%").digits(2).down_to("0 %")
        .help("Share of the triangles with an angle above 90°."),
    row("quality.cover", "Largest hole", "Spacing").digits(2).down_to("1").unless("quality.cover_local").places(HOLES)
        .help("Radius of the largest empty disc on the surface over that of a perfect hexagonal lattice of as many particles."),
    row("quality.cover_local", "Largest hole", "Spacing").digits(2).down_to("1").places(HOLES)
        .help("Radius of the largest empty disc on the surface over that of a perfect hexagonal lattice of particles as large as those around it."),
    row("quality.wide_holes", "Holes wider than 1.4", "Spacing").down_to("0").places(HOLES)
        .help("Empty discs on the surface that are wider than 1.4, measured as the largest one. Of discs that overlap so far that the middle of one lies in the other, one counts. A missing particle leaves a hole of 1.73."),
    row("quality.rho", "Closest pair", "Spacing").digits(3).up_to("1").unless("quality.overlap_min").places(PAIRS)
        .help("Distance of the closest pair over the spacing of a perfect hexagonal lattice of as many particles: the normalised Poisson-disk radius."),
    row("quality.overlap_min", "Closest pair", "Spacing").digits(3).up_to("1").places(PAIRS)
        .help("Smallest distance of two neighbours over the sum of their radii."),
    row("quality.crowded", "Pairs nearer than 0.75", "Spacing").down_to("0").places(PAIRS)
        .help("Pairs of particles that are nearer to each other than 0.75, measured as the closest one."),
    row("quality.spacing_variation", "Spacing variation", "Spacing").unit("%").digits(1).down_to("0 %").unless("quality.size_variation")
        .help("Standard deviation of the distance to the nearest neighbour over its mean."),
    row("quality.size_variation", "Spacing variation", "Spacing").unit("%").digits(1).down_to("0 %")
        .help("Standard deviation over mean of the distance between natural neighbours over the sum of their radii."),
    row("quality.edge_variation", "Edge variation", "Spacing").unit("%").digits(1).down_to("0 %").unless("quality.size_variation")
        .help("Standard deviation of the distance between natural neighbours over its mean."),
    row("quality.error_max", "Largest residual", "Accuracy").digits(6).down_to("0")
        .help("Largest distance |f|/|∇f| from the surface over the spacing of a perfect lattice."),
    row("quality.error_mean", "Mean residual", "Accuracy").digits(6).down_to("0")
        .help("Mean distance |f|/|∇f| from the surface over the spacing of a perfect lattice."),
    row("quality.area", "Area", "Surface").unit("units²").digits(3)
        .help("Area of the triangles of natural neighbours."),
    row("volume", "Volume", "Surface").unit("units³").digits(3)
        .help("Volume that the mesh encloses, exact to its triangles, where the particles are joined to a closed one."),
    row("inside", "Inside", "Surface")
        .help("Sign of f inside of the closed parts of the surface. Files of the mesh face outward whether f is smaller or larger there; the normals of particles follow the gradient of f."),
    row("quality.euler", "Sample Euler number", "At this radius")
        .help("Vertices − edges + faces of the triangles of natural neighbours: 2 − 2g for a closed surface of genus g, summed over its components. It is that of the sample: where the surface is as thin as a particle, a smaller radius may show another one."),
    row("components", "Sample components", "At this radius")
        .help("Components of the graph of natural neighbours of the particles. It is that of the sample: a neck or a needle as thin as a particle may divide it. Parts that are joined only at a singular point count separately."),
    row("pairs", "Periodic pairs", "Surface")
        .help("Pairs of particles on opposite faces of the box that are the same but for the shift."),
    row("border", "Border particles", "Surface")
        .help("Particles where the box cuts the surface: a child of theirs would have been outside."),
    row("search", "All components found", "Surface").ideal("proven")
        .help("Proven: interval arithmetic shows a witness on every component of the surface in the box, and that each witness is on the component of a particle or counted in the next row. By search: a component smaller than the cells of the search can be missing. That is all that can be had of models from points; of a formula a note says why."),
    row("sampled.missing", "Without particles", "Surface").down_to("0")
        .help("Witnessed components without a particle: each is too small or too near another one for this radius. The notes name their places and sizes."),
    row("undecided_cells", "Undecided cells", "Surface").down_to("0")
        .help("Cells of the box in which the proof could neither find a component nor rule one out, and witnesses of which it could not tell whether a particle is on their component."),
    row("singular_points", "Singular points", "Surface")
        .help("Places where f has no gradient on the surface, such as the tip of a cone; a curve of them counts as one. Particles within 2r of one are marked in the exported files."),
    row("creases", "Creases", "Surface")
        .help("Curves on which the surface has an edge, from corner to corner or closed. Particles lie on them exactly, with a normal for each side."),
    row("corners", "Corners", "Surface")
        .help("Particles at which creases meet or end."),
    row("edges_found", "Edges found", "Surface")
        .help("How the edges were found where the field does not tell its pieces: on a grid of values of f. Nothing is proven: edges of a part smaller than a cell of the grid may be missed. A smaller box misses less."),
    row("seams", "Smooth joins", "Surface")
        .help("Curves along which patches of the surface meet without an edge, which meet at an edge elsewhere, as where a fillet fades out. Particles lie on them."),
];

const FATES: &[Fate] = &[
    Fate { name: "added", label: "Added", help: "A new particle was placed." },
    Fate { name: "matched", label: "Matched", help: "A particle of the same sheet sits there already." },
    Fate {
        name: "not_converged",
        label: "Not converged",
        help: "The circle around the parent met no point of the surface.",
    },
    Fate {
        name: "outside",
        label: "Outside",
        help: "The point lies outside the clip box, or beyond a crease or a smooth join, off the patch of its parent.",
    },
    Fate { name: "undefined", label: "Undefined", help: "f has no value or no gradient there." },
    Fate { name: "capped", label: "Capped", help: "The limit on particles was reached." },
];

const COLOURS: &[Colour] = &[
    Colour {
        id: ColourMode::Level,
        label: "Generation level",
        help: "Rings in the order in which they were placed, from blue at the seed to sand at the last one, with a light ring every eighth level.",
        unit: "",
    },
    Colour {
        id: ColourMode::Fate,
        label: "Fate of the children",
        help: "Interior, at the border of the box or beside a crease or a smooth join, or next to a place where a child found no surface.",
        unit: "",
    },
    Colour {
        id: ColourMode::Valence,
        label: "Neighbours",
        help: "Number of natural neighbours; six is ideal.",
        unit: "",
    },
    Colour {
        id: ColourMode::Nearest,
        label: "Nearest distance",
        help: "Distance to the nearest particle over 2r.",
        unit: "× 2r",
    },
    Colour {
        id: ColourMode::Energy,
        label: "Energy",
        help: "Repulsion of a particle by its natural neighbours, over that by six at the ideal distance: less beside a hole, more in a crowd.",
        unit: "",
    },
    Colour {
        id: ColourMode::Residual,
        label: "Residual",
        help: "Distance to the surface to first order, |f|/|∇f|, over the radius. The ramp goes by powers of ten.",
        unit: "× r",
    },
    Colour {
        id: ColourMode::Radius,
        label: "Radius",
        help: "Repulsion radius, from the smallest particle to the largest.",
        unit: "",
    },
    Colour {
        id: ColourMode::Curvature,
        label: "Mean curvature",
        help: "(κ₁ + κ₂)/2: orange where the surface bulges outward as a sphere does, blue where it is hollow, grey where it is flat or bends both ways alike.",
        unit: "1/length",
    },
    Colour {
        id: ColourMode::Component,
        label: "Connected component",
        help: "Components of the mesh of natural neighbours, the largest first. The colours repeat after twelve.",
        unit: "",
    },
    Colour { id: ColourMode::Normal, label: "Normal", help: "Direction of the outward normal.", unit: "" },
    Colour {
        id: ColourMode::Value,
        label: "A formula",
        help: "A value by a formula of x, y, z and of the particle: n_x, n_y, n_z, k_1, k_2, d_x, d_y, d_z, radius, level, area, edge. Files have it as the column value.",
        unit: "",
    },
    Colour {
        id: ColourMode::Own,
        label: "Its own colours",
        help: "Those of an opened mesh, or of the formula: colour = … gives a number, c_rgb = (…, …, …) red, green and blue from 0 to 1.",
        unit: "",
    },
    Colour { id: ColourMode::Plain, label: "Plain", help: "One colour.", unit: "" },
];
