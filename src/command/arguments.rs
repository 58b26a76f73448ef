//! The command line's arguments, as clap reads and explains them.

use crate::image::{VoxelSize, raw, voxel_size};
use crate::options::{SamplingOptions, number};
use crate::reading::{
    beyond_points, centres, choice_of_box, file_formats, frames, length, one_of, parameter, porosity, scale,
    sweep, thickness, value, vertices,
};
use crate::remesh::MeshArguments;
use crate::spacing::{SpacingOption, spacing, units};
use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use marching_particles::Bounds;
use marching_particles::export::{Bodies, Placement, Unit, UpAxis, Vertices};
use marching_particles::field::formula::Thickness;
use marching_particles::field::model;
use marching_particles::field::rbf::Pull;
use marching_particles::image::RawVoxels;
use marching_particles::internal::session::{
    BeyondPoints, BoxCell, BoxFaces, BoxMode, FileRecord, Language, SolidSettings, ValueText,
};
use marching_particles::run::Measured;
use marching_particles::{Format, gallery};
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Sample implicit surfaces f(x, y, z) = 0 with evenly spaced particles
#[derive(Debug, Parser)]
#[command(name = "marching-particles", version, arg_required_else_help = true, long_about = LONG_ABOUT, after_long_help = AFTER, max_term_width = 100)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,

    /// Number of threads, one for each processor by default; it does not change the result
    #[arg(long, value_name = "N", global = true)]
    pub(crate) threads: Option<NonZeroUsize>,
}

const LONG_ABOUT: &str = "\
Sample implicit surfaces f(x, y, z) = 0 with evenly spaced particles.

A front of particles grows over the surface, each one placing its neighbours around it in a hexagon, until the fronts \
meet; then the particles push each other apart. The result is points with normals, almost all with six neighbours at \
the same distance.";

const AFTER: &str = "\
Examples:
  marching-particles surfaces
  marching-particles sample torus --out torus.ply
  marching-particles sample ellipsoid --count 55748 --json
  marching-particles sample ellipsoid --adaptive --chord-error 0.01%
  marching-particles sample \"x^4 + y^4 + z^4 = a\" --param a=0.5 --box 1.2 --radius 1%";

/// The particles that the report measures.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum ReportKind {
    /// Nothing: no quality figures, no components and Euler number, no warnings based on them, and
    /// no columns valence, nearest and residual in the files
    None,
    /// The particles
    Short,
    /// The particles, and for comparison the front before its relaxation
    Full,
}

impl ReportKind {
    pub(crate) fn measured(self) -> Measured {
        match self {
            Self::None => Measured::Nothing,
            Self::Short => Measured::Particles,
            Self::Full => Measured::FrontToo,
        }
    }
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Sample a surface, write it to files and say how good it is
    #[command(long_about = SAMPLE_LONG, after_long_help = SAMPLE_AFTER)]
    Sample(Box<SampleArguments>),
    /// List the named surfaces
    Surfaces(Surfaces),
    /// Print a script that completes commands and options in a shell
    #[command(after_help = COMPLETIONS_AFTER)]
    Completions {
        /// The shell
        shell: Shell,
    },
    /// Write manual pages, one for each command
    Man {
        /// Directory for the pages, such as ~/.local/share/man/man1
        directory: PathBuf,
    },
    /// Move a surface by a parameter, and write the particles that follow it to numbered files
    #[command(long_about = SWEEP_LONG)]
    Sweep(Box<SweepArguments>),
}

const COMPLETIONS_AFTER: &str = "\
Example:
  marching-particles completions bash > ~/.local/share/bash-completion/completions/marching-particles";

const SWEEP_LONG: &str = "\
Move a surface by a parameter, and write the particles that follow it to numbered files.

The particles of the first frame are those of `sample`. In each frame they move to the new surface; crowded ones are removed, and new ones \
appear where the surface tears, grows or enters the box. A particle keeps its number, the column `identity` of ply and csv, as long as it \
exists. If the surface moves too far in one frame, has sharp edges or vanishes, a new run begins: give more frames.

Example:
  marching-particles sweep --formula \"x^4 + y^4 + z^4 - 5(x^2 + y^2 + z^2) + q\" --sweep q=11..14 --frames 90 --count 8000 --out frames";

/// Arguments of `sweep`.
#[derive(Debug, Args)]
pub(crate) struct SweepArguments {
    #[command(flatten)]
    pub(crate) surface: SurfaceArguments,

    /// The parameter that moves the surface, with its first and its last value
    #[arg(long, value_name = "NAME=FROM..TO", value_parser = sweep, allow_hyphen_values = true, help_heading = "Surface")]
    pub(crate) sweep: Sweep,

    /// Number of steps from the first to the last value; one more file is written
    #[arg(long, value_name = "N", default_value_t = 120, value_parser = frames, help_heading = "Surface")]
    pub(crate) frames: u32,

    #[command(flatten)]
    pub(crate) sampling: SamplingOptions,

    /// Directory for the files; created if it does not exist. Files of the same names are replaced
    #[arg(long, short, value_name = "DIRECTORY", help_heading = "Output")]
    pub(crate) out: PathBuf,

    /// Format of the files
    #[arg(long, value_name = "WORD", value_parser = one_of(&Format::ALL), default_value = "ply", help_heading = "Output")]
    pub(crate) format: (&'static str, Format),

    /// Print only errors, and show no progress bar
    #[arg(long, short, help_heading = "Output")]
    pub(crate) quiet: bool,
}

/// A parameter and the range that it sweeps.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sweep {
    pub(crate) name: String,
    pub(crate) from: f64,
    pub(crate) to: f64,
}

const SAMPLE_LONG: &str = "\
Sample a surface, write it to files and say how good it is.

Give a formula, the name of a surface, a file of points, a triangle mesh or a three-dimensional image. Say how fine: by the radius of the \
particles (neighbours are two radii apart), by the distance between neighbours, or by their number. Without --out and --mesh nothing is written, only measured.";

const SAMPLE_AFTER: &str = "\
Formulas:
  x y z, numbers, + - * / ^ %, brackets, and f = g. A product needs no sign where it is clear: 2x, x y, 3(x+1); 1/2x is (1/2)x.
  pi e tau phi; sqrt cbrt abs sign min max floor ceil round fract mod exp ln log10 log2 sin cos tan sec csc cot asin acos atan
  atan2 sinh cosh tanh sech csch coth asinh acosh atanh erf hypot clamp mix step smoothstep; smin(a,b,k) and smax(a,b,k) join
  smoothly by a cubic polynomial, smin2 and smax2 by a quadratic one. Negative is inside. Other names are parameters: --param a=2.
  Choices: if(x < 1 and not y > 0, a, b), or c ? a : b. Definitions come first: \"r = hypot(x,y); (r - 1)^2 + z^2 = 0.1\", and
  functions: \"f(a,b) = a^2 + b^2; f(x,y) = z\". Comments: // # /* */.
  Also read: |x|, x**2, sin 2x, f(x,y,z) = ..., LaTeX such as \\frac{x^{2}}{4}, and what MATLAB, Python, GLSL and Mathematica write.
  Every number of an option may be written so: --box pi, --radius sqrt(2)/50, --count 2*10^4.

Examples:
  marching-particles sample ellipsoid --count 55748 --out points.ply --json
  marching-particles sample torus --param r=0.25 --radius 1% --out torus.xyz --out torus.npy
  marching-particles sample \"x^4 - 5x^2 + y^4 - 5y^2 + z^4 - 5z^2 + 11.8\"
  marching-particles sample \"sin(x)cos(y) + sin(y)cos(z) + sin(z)cos(x)\" --box 5 --radius 0.05
  marching-particles sample gyroid --thickness 0.3 --closed --mesh part.stl
  marching-particles sample gyroid --thickness \"1 + 0.1z\" --closed --porosity 70% --mesh graded.stl
  marching-particles sample \"x^2 + y^2 + z^2 = 1\" --mesh ball.3mf --scale 25 --unit mm
  marching-particles sample gyroid --closed --size 40mm --wall 2mm --largest-part --mesh part.3mf
  marching-particles sample --like part.glb --radius 0.3% --mesh finer.glb
  marching-particles sample --points scan.ply --centres 400 --out even.ply --mesh even.glb
  marching-particles sample --points scan.ply --formula \"max(model, abs(z) - 0.1)\" --mesh slice.stl
  marching-particles sample --image scan.nii.gz --iso 300 --count 50000 --mesh bone.stl
  marching-particles sample --image organs.nrrd --label 3 --mesh liver.stl
  marching-particles sample --mesh-in part.stl --count 20000 --method refined --mesh even.stl
  marching-particles sample torus --mesh - --format glb --quiet | viewer
  marching-particles sample \"x^4 + y^4 + z^4 = a\" --param a=0.5 --count 5000 --print python
  marching-particles sample \"(x^2 + 9/4 y^2 + z^2 - 1)^3 = x^2 z^3 + 9/80 y^2 z^3\" --relax 0

Exit codes:
  0  done
  1  a file could not be read or written
  2  the command, the formula, a setting or a file of points, of a mesh or of an image cannot be understood
  3  there is nothing to sample: no surface in the box, a constant or undefined formula
  4  more particles than the limit; what was placed before it was reached is written";

/// Arguments of `sample`.
#[derive(Debug, Args)]
pub(crate) struct SampleArguments {
    /// Repeat the run that a PLY, OBJ, GLB or 3MF file was saved from, by this program or its page:
    /// surface, box, settings and values. For a CSV file they are in a file of the same name with
    /// .json appended. Options given beside --like override those of the file; with another
    /// surface, only the settings are taken from it
    #[arg(long, value_name = "FILE", help_heading = "Surface")]
    pub(crate) like: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) surface: SurfaceArguments,

    /// Choose the thickness of the shell so that it leaves this share of the box empty, measured by
    /// the volume of the mesh: 70% or 0.7. Needs --closed and takes up to two more runs. A
    /// --thickness by a formula is scaled. For formulas
    #[arg(long, value_name = "SHARE%", value_parser = porosity, requires = "closed", conflicts_with_all = ["points", "image", "mesh_in"], help_heading = "Surface")]
    pub(crate) porosity: Option<f64>,

    #[command(flatten)]
    pub(crate) sampling: SamplingOptions,

    /// Distance between neighbours, twice the radius: a length, a share of the box diagonal, or a
    /// formula of x, y, z and the parameters, such as "0.02 + 0.1 hypot(x, y)". --grading limits
    /// how fast sizes change; a note says where particles lie closer than the formula asks for this
    /// reason. With --adaptive the smaller size counts; with --count the formula gives the
    /// proportions of the sizes
    #[arg(
        long, value_name = "LENGTH|FORMULA", value_parser = spacing, allow_hyphen_values = true,
        conflicts_with = "radius_share", help_heading = "Sampling"
    )]
    pub(crate) spacing: Option<SpacingOption>,

    /// Smallest distance between neighbours: replaces smaller, zero and negative values of
    /// --spacing
    #[arg(long, value_name = "LENGTH", value_parser = units, requires = "spacing", help_heading = "Sampling")]
    pub(crate) spacing_min: Option<f64>,

    /// Largest distance between neighbours: replaces larger values of --spacing
    #[arg(long, value_name = "LENGTH", value_parser = units, requires = "spacing", help_heading = "Sampling")]
    pub(crate) spacing_max: Option<f64>,

    /// File of the particles, in the format of its extension: ply (position, normal, radius, level,
    /// parent, valence, distance to the nearest particle, residual, and whether a singular point is
    /// near), csv (the same; a .json file of the same name holds the record), xyz or npy (position,
    /// normal). Normals follow the gradient of f: they point inward where f is larger inside. May
    /// be repeated; existing files are replaced
    #[arg(long, short, value_name = "FILE", help_heading = "Output")]
    pub(crate) out: Vec<PathBuf>,

    /// Add a column to the files, NAME=FORMULA, such as "H=(k_1+k_2)/2": a formula of x, y, z, the
    /// normal n_x, n_y, n_z, the principal curvatures k_1 >= k_2, the direction d_x, d_y, d_z of
    /// k_1, radius, level, area (the part of the mesh area that belongs to the particle), edge (the
    /// distance to the nearest sharp edge or rim) and the parameters. ply and csv name the column,
    /// npy has it after the normal, glb as the attribute _NAME in capitals. May be repeated
    #[arg(
        long = "value", value_name = "NAME=FORMULA", value_parser = value, allow_hyphen_values = true,
        help_heading = "Output"
    )]
    pub(crate) values: Vec<ValueText>,

    /// File of the triangle mesh, in the format of its extension: glb (with normals, and generation
    /// levels as colours), 3mf (with its unit), stl, obj or ply (with normals). Closed surfaces
    /// face outward. May be repeated; existing files are replaced. --method refined makes better
    /// triangles
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(crate) mesh: Vec<PathBuf>,

    /// Format of what is written to standard output, with `-` as the name in --out or --mesh. The
    /// report then goes to standard error
    #[arg(long, value_name = "WORD", value_parser = file_formats(), help_heading = "Output")]
    pub(crate) format: Option<String>,

    /// Vertices on sharp edges in glb, obj and ply files of --mesh: one, or one for each side with
    /// its own normal. stl and 3mf have no normals
    #[arg(long, value_name = "WORD", value_parser = vertices(), default_value = "joined", help_heading = "Output")]
    pub(crate) vertices: Vertices,

    /// Length of one unit of the formula in the files of --mesh, measured in --unit
    #[arg(long, value_name = "NUMBER", value_parser = scale, default_value_t = 1.0, help_heading = "Output")]
    pub(crate) scale: f64,

    /// Unit of the files of --mesh: 3mf names it, and glb is converted to metres. Without it
    /// numbers are written as they are: metres in glb, millimetres in 3mf
    #[arg(long, value_name = "WORD", value_parser = one_of(&Unit::ALL), help_heading = "Output")]
    pub(crate) unit: Option<(&'static str, Unit)>,

    /// Longest side of the mesh in the files of --mesh, such as 40mm, 4cm or 1.5in; without a unit
    /// in millimetres. Replaces --scale and --unit
    #[arg(
        long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true,
        conflicts_with_all = ["scale", "unit"], help_heading = "Output"
    )]
    pub(crate) size: Option<Length>,

    /// Thickness of the shell in the files of --mesh, such as 2mm, instead of --thickness. Needs
    /// --size, which takes up to two more runs to meet it, or --scale and --unit
    #[arg(
        long, value_name = "LENGTH", value_parser = length, allow_hyphen_values = true,
        conflicts_with_all = ["thickness", "porosity", "points", "image", "mesh_in", "print"], help_heading = "Output"
    )]
    pub(crate) wall: Option<Length>,

    /// Write only the largest part of the mesh, by area, to the files of --mesh; the walls of its
    /// hollows belong to it
    #[arg(long, help_heading = "Output")]
    pub(crate) largest_part: bool,

    /// Axis of the formula that points up. It is written as z in the files of --mesh, in glb as y
    #[arg(long, value_name = "AXIS", value_parser = one_of(&UpAxis::ALL), default_value = "z", help_heading = "Output")]
    pub(crate) up: (&'static str, UpAxis),

    /// What the report measures; measuring can take longer than sampling
    #[arg(long, value_name = "WORD", value_enum, default_value_t = ReportKind::Short, help_heading = "Output")]
    pub(crate) report: ReportKind,

    /// Print one line of JSON instead of text
    #[arg(long, help_heading = "Output")]
    pub(crate) json: bool,

    /// Print a program that makes these particles instead of sampling them: in Rust, for the
    /// package for npm (js), for the Python package, or as a command (shell). No file is written.
    /// For formulas, not for points, images or meshes
    #[arg(long, value_name = "LANGUAGE", value_parser = one_of(&Language::ALL), conflicts_with_all = ["json", "porosity", "image", "mesh_in"], help_heading = "Output")]
    pub(crate) print: Option<(&'static str, Language)>,

    /// Print only errors and the line of --json, and show no progress bar
    #[arg(long, short, help_heading = "Output")]
    pub(crate) quiet: bool,
}

/// Arguments that choose the surface.
#[derive(Debug, Args)]
pub(crate) struct SurfaceArguments {
    /// The surface: a formula, as for --formula, or the name of one that `surfaces` lists, as for
    /// --surface. A formula that begins with a minus sign needs --formula
    #[arg(value_name = "FORMULA|NAME", conflicts_with_all = ["formula", "image"], help_heading = "Surface")]
    pub(crate) text: Option<String>,

    /// Named surface; `surfaces` lists them [default: the first one]
    #[arg(long, value_name = "ID", help_heading = "Surface")]
    pub(crate) surface: Option<String>,

    /// Formula of the surface. With --surface it replaces the formula of that surface. With
    /// --points, --mesh-in or a model, `model` in the formula is their function, as an operand of
    /// max, min, smin, smax or abs, or with a number added: "max(model, z)" cuts it
    #[arg(long, value_name = "TEXT", allow_hyphen_values = true, help_heading = "Surface")]
    pub(crate) formula: Option<String>,

    /// File of points, or of a mesh whose vertices are taken: PLY, OBJ, STL, OFF, GLB, 3MF, PCD, or
    /// text with one point on a line (XYZ, PTS, CSV), up to 50 MB; `-` is standard input. A smooth
    /// surface is fitted to all points. Normals come from the file, else from its faces, else they
    /// are estimated
    #[arg(long, value_name = "FILE", conflicts_with = "surface", help_heading = "Surface")]
    pub(crate) points: Option<PathBuf>,

    /// File of a three-dimensional image: NIfTI (.nii, .nii.gz, .hdr), NRRD, NumPy (.npy),
    /// MetaImage (.mha, .mhd), Gaussian cube or a stack of TIFF pictures. The surface lies where
    /// the image has the value --iso. Coordinates are those of the file: millimetres in medical
    /// images
    #[arg(
        long, value_name = "FILE", help_heading = "Surface",
        conflicts_with_all = ["surface", "formula", "points", "mesh_in", "parameters", "closed", "thickness"]
    )]
    pub(crate) image: Option<PathBuf>,

    /// Value of --image on the surface, between its darkest and its brightest voxel [default: the
    /// value of Otsu's method, which separates dark from bright voxels best]
    #[arg(long, value_name = "NUMBER", value_parser = number, requires = "image", allow_hyphen_values = true, help_heading = "Surface")]
    pub(crate) iso: Option<f64>,

    /// Label whose boundary is sampled, for an --image whose voxels are whole numbers that say to
    /// which body they belong
    #[arg(long, value_name = "NUMBER", value_parser = number, requires = "image", conflicts_with = "iso", help_heading = "Surface")]
    pub(crate) label: Option<f64>,

    /// Width in voxels of a Gaussian filter, in the plane of the slices: over the voxels of
    /// --image, against noise and rounding [default: by the measured noise, 0 or 0.7 to 2], or over
    /// the distances from --label, against steps [default: the root mean square of the distances
    /// between voxels, 1 for cubes]
    #[arg(long, value_name = "VOXELS", value_parser = number, requires = "image", help_heading = "Surface")]
    pub(crate) smooth: Option<f64>,

    /// Take the darker voxels of --image as the inside, instead of the brighter ones
    #[arg(long, requires = "image", help_heading = "Surface")]
    pub(crate) dark_inside: bool,

    /// Close the surface at the border of --image, where it would end with a rim
    #[arg(long, requires = "image", help_heading = "Surface")]
    pub(crate) close_border: bool,

    /// Layout of --image if it has no known header: the numbers of voxels along x, y and z, their
    /// type, and if needed `big` for big-endian numbers and the bytes to skip before the voxels:
    /// 256x256x128,uint16,big,skip=512
    #[arg(long, value_name = "FORM", value_parser = raw, requires = "image", help_heading = "Surface")]
    pub(crate) raw: Option<RawVoxels>,

    /// Distances between the voxels of --image along its axes, instead of those in the file
    #[arg(long, value_name = "XxYxZ", value_parser = voxel_size, requires = "image", help_heading = "Surface")]
    pub(crate) voxel_size: Option<VoxelSize>,

    #[command(flatten)]
    pub(crate) mesh: MeshArguments,

    /// Number of points, 100 to 800, that are centres of the fit to --points or to a model: more
    /// reproduce finer details and take longer [default: 200]
    #[arg(long, value_name = "N", help_heading = "Surface", value_parser = centres)]
    pub(crate) centres: Option<u32>,

    /// Whether the surface of --points is `cut` at the border of the points, or `kept` as far as it
    /// continues beyond them. Gaps of a few spacings of the points are bridged [default: cut]
    #[arg(long, value_name = "WORD", value_parser = beyond_points, help_heading = "Surface")]
    pub(crate) beyond_points: Option<BeyondPoints>,

    /// Value of a parameter; repeat it for each parameter
    #[arg(long = "param", value_name = "NAME=VALUE", value_parser = parameter, help_heading = "Surface")]
    pub(crate) parameters: Vec<(String, f64)>,

    /// Box to sample in: `fit` for one around the surface of a formula, which is searched for up to
    /// ±10,000; surfaces without end are cut. `fixed` for the box of a named surface, ±2 for a
    /// formula; H for -H..H on each axis; three half-widths; or two corners as six numbers
    /// separated by commas. A named surface keeps its own box [default: fit]
    #[arg(
        long = "box", alias = "bounds", value_name = "fit|fixed|NUMBERS", value_parser = choice_of_box, allow_hyphen_values = true,
        help_heading = "Surface"
    )]
    pub(crate) bounds: Option<BoxChoice>,

    /// Close what the box cuts with the faces of the box: the solid f ≤ 0 in the box, with sharp
    /// edges. For formulas
    #[arg(long, conflicts_with = "points", help_heading = "Surface")]
    pub(crate) closed: bool,

    /// Give opposite faces of the box of --closed the same particles and triangles, up to the shift
    /// and to the last bit, along every axis on which the box is a whole number of periods wide.
    /// Without --box it is one period wide. The column `periodic` of ply and csv has the pairs
    #[arg(long, requires = "closed", help_heading = "Surface")]
    pub(crate) periodic: bool,

    /// The box that is sampled around a solid that a box closes, read from a file.
    #[arg(skip)]
    pub(crate) sampled: Option<Bounds>,

    /// Pulls on the surface of a model, read from a file.
    #[arg(skip)]
    pub(crate) pulls: Vec<Pull>,

    /// Sample a shell of this thickness around the surface, |f| ≤ T/2 |∇f|, instead of the surface:
    /// a number, or a formula of x, y, z and the parameters, such as "0.1 + 0.05z". Where it is
    /// negative there is no shell. For formulas
    #[arg(
        long, value_name = "T", conflicts_with = "points", value_parser = thickness, allow_hyphen_values = true,
        help_heading = "Surface"
    )]
    pub(crate) thickness: Option<Thickness>,
}

impl SurfaceArguments {
    /// Adds values for those parameters that have none.
    fn add_parameters(&mut self, values: BTreeMap<String, f64>) {
        for (name, value) in values {
            if !self.parameters.iter().any(|(given, _)| *given == name) {
                self.parameters.push((name, value));
            }
        }
    }
}

impl SampleArguments {
    /// Orientation and scale of the mesh in its files. `longest_side` is the length of its longest
    /// side in the formula's coordinates.
    pub(crate) fn placement(&self, longest_side: f64) -> Placement {
        let (scale, unit) = match self.size {
            Some(size) if longest_side > 0.0 => (size.value / longest_side, Some(size.unit)),
            Some(size) => (1.0, Some(size.unit)),
            None => (self.scale, self.unit.map(|(_, unit)| unit)),
        };
        Placement { scale, unit, up: self.up.1 }
    }

    /// The bodies of the mesh that are written to its files.
    pub(crate) fn bodies(&self) -> Bodies {
        if self.largest_part { Bodies::Largest } else { Bodies::All }
    }

    /// Fills in from a file's record what was not given on the command line.
    pub(crate) fn complete(&mut self, record: FileRecord) {
        self.take_even_spacing();
        // A given radius means particles of one size.
        if let (None, Some(text), false) = (&self.spacing, &record.spacing, self.sampling.has_radius()) {
            self.spacing = Some(SpacingOption::Formula(text.formula.clone()));
            (self.spacing_min, self.spacing_max) = (text.smallest, text.largest);
        }
        let surface = &mut self.surface;
        let is_model = surface.points.is_some()
            || surface.surface.as_deref().is_some_and(|id| model::find(id).is_some());
        if record.model.is_some() && is_model {
            surface.bounds = surface.bounds.or(Some(BoxChoice::Given(record.bounds)));
            surface.pulls = record.pulls;
            surface.formula = surface.formula.take().or(Some(record.formula).filter(|text| !text.is_empty()));
            surface.add_parameters(record.parameters);
            self.add_values(record.values);
            return self.sampling.complete(&record.settings, self.spacing.is_some());
        }
        if surface.surface.is_none()
            && surface.formula.is_none()
            && surface.points.is_none()
            && surface.image.is_none()
            && surface.mesh.mesh_in.is_none()
        {
            let own = record.surface.as_deref().and_then(gallery::find).map(|own| record.solid.own_box(own));
            if surface.bounds.is_none() && own != Some(record.bounds) {
                surface.bounds = Some(BoxChoice::Given(record.faces.unwrap_or(record.bounds)));
                surface.sampled = record.faces.map(|_| record.bounds);
            }
            surface.surface = record.surface;
            surface.formula = Some(record.formula);
            surface.add_parameters(record.parameters);
            surface.closed |= record.solid.box_faces == BoxFaces::Closed;
            surface.periodic |= record.solid.box_cell == BoxCell::Periodic;
            // A porosity requires another thickness than the one in the file.
            let kept = record
                .solid
                .thickened()
                .filter(|thickness| self.porosity.is_none() || matches!(thickness, Thickness::Formula(_)))
                .filter(|_| self.wall.is_none());
            surface.thickness = surface.thickness.take().or(kept.cloned());
            self.add_values(record.values);
        }
        self.sampling.complete(&record.settings, self.spacing.is_some());
    }

    /// Adds the values of a record, except those that the command line names itself.
    fn add_values(&mut self, mut recorded: Vec<ValueText>) {
        recorded.retain(|own| self.values.iter().all(|given| given.name != own.name));
        self.values.splice(0..0, recorded);
    }
}

impl SurfaceArguments {
    /// The solid that the options ask for.
    pub(crate) fn solid(&self) -> SolidSettings {
        let is_fixed = self.bounds == Some(BoxChoice::Fixed);
        SolidSettings {
            box_mode: if is_fixed { BoxMode::Fixed } else { BoxMode::Fit },
            box_faces: if self.closed { BoxFaces::Closed } else { BoxFaces::Open },
            box_cell: if self.periodic { BoxCell::Periodic } else { BoxCell::Lone },
            thickness: self.thickness.clone().unwrap_or_default(),
            beyond_points: self.beyond_points.unwrap_or_default(),
        }
    }
}

/// The choice of the box to sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum BoxChoice {
    Fit,
    Fixed,
    Given(Bounds),
}

impl BoxChoice {
    pub(crate) fn given(self) -> Option<Bounds> {
        match self {
            Self::Given(bounds) => Some(bounds),
            Self::Fit | Self::Fixed => None,
        }
    }
}

/// Arguments of `surfaces`.
#[derive(Debug, Args)]
pub(crate) struct Surfaces {
    /// Print one line of JSON instead of text
    #[arg(long)]
    pub(crate) json: bool,
}

/// A length in a file, with its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Length {
    pub(crate) value: f64,
    pub(crate) unit: Unit,
}

impl Length {
    pub(crate) fn metres(self) -> f64 {
        self.value * self.unit.metres()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn command_is_consistent() {
        Arguments::command().debug_assert();
    }
}
