//! Named surfaces, each with a formula, parameters, a box and known properties.

mod closed;
mod many;
mod open;
mod periodic;
mod singular;

use super::formula::{Formula, GallerySurface, Parameter};
use crate::math::Bounds;
use serde::Serialize;
use std::borrow::Cow;
use std::sync::LazyLock;

/// A named surface.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Surface {
    /// Identifier: lower case, words joined by hyphens.
    pub id: &'static str,
    /// Name for the user.
    pub name: &'static str,
    /// Formula of f, or an equation; f < 0 inside.
    pub formula: &'static str,
    /// Parameters of the formula, in the order of their sliders.
    #[serde(skip)]
    pub parameters: &'static [Parameter],
    /// Box that is sampled.
    pub bounds: Bounds,
    /// Algebraic degree; none for a transcendental surface.
    pub degree: Option<u32>,
    /// Whether the surface is closed, so that it lies in the box for all values of the parameters.
    #[serde(skip)]
    pub closed: bool,
    /// Genus with the default parameters; none unless the surface is closed, connected and free of
    /// self-intersections.
    pub genus: Option<u32>,
    /// Whether the surface with the default parameters has no singular point.
    #[serde(skip)]
    pub smooth: bool,
    /// Words by which people look for the surface and that its name, formula and story do not have,
    /// in lower case, with spaces between them. Each suggests the surface if it is typed alone.
    pub words: &'static str,
    /// Two sentences about the surface.
    pub story: &'static str,
    /// Reference to a text about the surface.
    pub source: &'static str,
}

/// Surfaces that teach the same thing.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceGroup {
    /// Name for the user.
    pub name: &'static str,
    /// The surfaces of the group, the simplest first.
    pub surfaces: &'static [Surface],
}

impl Surface {
    /// The formula for sampling, with the default values of the parameters. It knows its name and
    /// box: a run whose settings have no box takes place in this one, and the record of its files
    /// names the surface.
    ///
    /// ```
    /// use marching_particles::{Settings, gallery, sample};
    ///
    /// let torus = gallery::find("torus").ok_or("no such surface")?;
    /// let thin = sample(torus.field().with("r", 0.2)?, &Settings::with_count(1_000))?;
    /// assert_eq!(thin.bounds(), torus.bounds);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    ///
    /// Never: a test parses every formula of the gallery.
    #[must_use]
    pub fn field(&self) -> Formula {
        Formula::as_written(self.formula, self.parameters)
            .unwrap_or_else(|error| panic!("gallery surface `{}`: {error}", self.id))
            .for_sampling()
            .of_surface(GallerySurface { id: self.id, bounds: self.bounds, closed: self.closed })
    }
}

/// The surfaces that are looked for by a word which is not their name.
pub fn by_word(word: &str) -> impl Iterator<Item = &'static Surface> {
    let word = word.to_lowercase();
    SURFACES.iter().filter(move |surface| surface.words.split(' ').any(|own| own == word))
}

/// Surface with the identifier `id`.
#[must_use]
pub fn find(id: &str) -> Option<&'static Surface> {
    SURFACES.iter().find(|surface| surface.id == id)
}

const fn parameter(
    name: &'static str,
    label: &'static str,
    value: f64,
    [min, max, step]: [f64; 3],
) -> Parameter {
    Parameter { name: Cow::Borrowed(name), label: Cow::Borrowed(label), value, min, max, step }
}

/// Base of the open surfaces: they state only the properties in which they differ from it.
const OPEN: Surface = Surface {
    id: "",
    name: "",
    formula: "",
    parameters: &[],
    bounds: Bounds::cube(1.0),
    degree: None,
    closed: false,
    genus: None,
    smooth: true,
    words: "",
    story: "",
    source: "",
};

/// Base of the closed surfaces.
const CLOSED: Surface = Surface { closed: true, ..OPEN };

/// The gallery. Its first surface is the default.
pub static GROUPS: &[SurfaceGroup] = &[
    SurfaceGroup { name: "Closed", surfaces: closed::SURFACES },
    SurfaceGroup { name: "Parts", surfaces: many::SURFACES },
    SurfaceGroup { name: "Singular", surfaces: singular::SURFACES },
    SurfaceGroup { name: "Periodic", surfaces: periodic::SURFACES },
    SurfaceGroup { name: "Open", surfaces: open::SURFACES },
];

/// All surfaces of the gallery, group by group.
pub static SURFACES: LazyLock<Vec<Surface>> =
    LazyLock::new(|| GROUPS.iter().flat_map(|group| group.surfaces).copied().collect());
