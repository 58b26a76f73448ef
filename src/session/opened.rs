//! Surfaces of opened files, images and triangle meshes, as the field of a session.

use super::{FieldAnswer, FieldRequest, ImageInfo, ModelFormula, Session, Source, check_box, image};
#[cfg(feature = "points")]
use super::{MeshInfo, OpenedMesh, mesh::MeshSurface};
use crate::extent::FALLBACK;
use crate::field::Field;
use crate::field::formula::Parameter;
use crate::image::{Image, ImageChoice, ImageSurface};
#[cfg(feature = "points")]
use crate::remesh::MeshOptions;
use crate::session::{Fault, FaultKind};
use crate::slices::{self, Estimated};
use std::sync::Arc;

/// The surface of a file, with the choices for it.
#[derive(Clone)]
#[expect(clippy::large_enum_variant, reason = "there is one in a session")]
pub(super) enum Surface {
    /// The surface of an image.
    Image(ImageSurface),
    /// The surface of a triangle mesh.
    #[cfg(feature = "points")]
    Mesh(MeshSurface),
}

impl Surface {
    fn field(&self) -> &(dyn Field + 'static) {
        match self {
            Self::Image(surface) => surface.field(),
            #[cfg(feature = "points")]
            Self::Mesh(surface) => &surface.field,
        }
    }

    fn shared(&self) -> Arc<dyn Field> {
        match self {
            Self::Image(surface) => Arc::new(surface.field().clone()),
            #[cfg(feature = "points")]
            Self::Mesh(surface) => Arc::new(surface.field.clone()),
        }
    }

    fn parameters(&self) -> Vec<Parameter> {
        match self {
            Self::Image(surface) => image::parameters(surface),
            #[cfg(feature = "points")]
            Self::Mesh(surface) => surface.parameters(),
        }
    }

    /// The named values that make the choice.
    fn choice(&self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Image(surface) => image::choice(surface).collect(),
            #[cfg(feature = "points")]
            Self::Mesh(surface) => surface.choice().collect(),
        }
    }

    /// Whether both are of one file.
    fn is_of_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Image(surface), Self::Image(other)) => surface.is_of(other.image()),
            #[cfg(feature = "points")]
            (Self::Mesh(surface), Self::Mesh(other)) => surface.mesh.is_same(&other.mesh),
            #[cfg(feature = "points")]
            _ => false,
        }
    }
}

/// The surface of a file, as a session samples it.
#[derive(Clone)]
pub struct OpenedSource {
    name: String,
    surface: Surface,
    /// The formula that uses the surface as an operand, if it is sampled instead.
    within: Option<ModelFormula>,
}

impl OpenedSource {
    /// The sampled field.
    pub(super) fn field(&self) -> &(dyn Field + 'static) {
        match &self.within {
            Some(formula) => &*formula.field,
            None => self.surface.field(),
        }
    }

    /// The sampled field, shared.
    pub(super) fn shared(&self) -> Arc<dyn Field> {
        match &self.within {
            Some(formula) => Arc::new(formula.field.clone()),
            None => self.surface.shared(),
        }
    }

    /// The surface, if it is sampled by itself.
    #[cfg(feature = "points")]
    pub(super) fn alone(&self) -> Option<&Surface> {
        self.within.is_none().then_some(&self.surface)
    }

    /// Whether nothing is known beyond the border of the file.
    pub(super) fn is_bordered(&self) -> bool {
        matches!(self.surface, Surface::Image(_))
    }

    /// The parameters of the formula, if there is one.
    pub(super) fn formula_parameters(&self) -> &[Parameter] {
        self.within.as_ref().map_or(&[], |formula| &formula.parameters)
    }

    /// The description of the field.
    pub(super) fn answer(&self, answer: FieldAnswer) -> FieldAnswer {
        let mut parameters = self.surface.parameters();
        let answer = match &self.surface {
            Surface::Image(surface) => {
                FieldAnswer { image: Some(ImageInfo::of(&self.name, surface)), ..answer }
            }
            #[cfg(feature = "points")]
            Surface::Mesh(surface) => FieldAnswer {
                mesh: Some(MeshInfo::new(&self.name, surface.mesh.notes(), &surface.field)),
                ..answer
            },
        };
        let Some(formula) = &self.within else { return FieldAnswer { parameters, ..answer } };
        let own: Vec<&str> = self.surface.choice().into_iter().map(|(name, _)| name).collect();
        let is_other =
            |p: &&Parameter| !own.contains(&&*p.name) && parameters.iter().all(|known| known.name != p.name);
        let others: Vec<Parameter> = formula.parameters.iter().filter(is_other).cloned().collect();
        parameters.extend(others);
        FieldAnswer {
            formula: formula.text.clone(),
            parameters,
            auto: formula.auto.clone(),
            mathml: Some(formula.mathml.clone()),
            ..answer
        }
    }
}

/// A file and the choices for its surface.
pub(super) enum Wanted {
    /// For the surface of an image.
    Image(Image, ImageChoice),
    /// For the surface of a triangle mesh.
    #[cfg(feature = "points")]
    Mesh(OpenedMesh, MeshOptions),
}

impl Wanted {
    fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Image(image, choice), Self::Image(other, its)) => image.is_same(other) && choice == its,
            #[cfg(feature = "points")]
            (Self::Mesh(mesh, options), Self::Mesh(other, its)) => mesh.is_same(other) && options == its,
            #[cfg(feature = "points")]
            _ => false,
        }
    }

    /// Makes the surface, given the one before it.
    fn work(&self, before: Option<Surface>) -> Estimated<'static, Result<Surface, Fault>> {
        match self {
            Self::Image(image, choice) => {
                let before = match before {
                    Some(Surface::Image(before)) => Some(before),
                    #[cfg(feature = "points")]
                    _ => None,
                    #[cfg(not(feature = "points"))]
                    None => None,
                };
                let expected = image.slices_of(choice);
                let work = image.clone().surface_in_slices(*choice, before);
                let work = async {
                    work.await.map(Surface::Image).map_err(|error| Fault::new(FaultKind::Image, &error))
                };
                Estimated::new(Box::pin(work), expected)
            }
            #[cfg(feature = "points")]
            Self::Mesh(mesh, options) => {
                let before = match before {
                    Some(Surface::Mesh(before)) => Some(before),
                    _ => None,
                };
                let work = MeshSurface::made(mesh.clone(), *options, before);
                Estimated::new(Box::pin(async { work.await.map(Surface::Mesh) }), mesh.field_slices())
            }
        }
    }
}

/// The surface that is made for the next change of the field.
pub(super) struct Making {
    wanted: Wanted,
    work: Estimated<'static, Result<Surface, Fault>>,
    made: Option<Result<Surface, Fault>>,
}

impl Session {
    /// The surface of the present field, if it is one of a file.
    pub(super) fn opened_surface(&self) -> Option<&Surface> {
        match self.run.field() {
            Source::Opened(present) => Some(&present.surface),
            _ => None,
        }
    }

    /// The work on a field from a file: the one under way, or a new one if another is wanted.
    fn making(&mut self, wanted: Wanted) -> Making {
        match self.making.take().filter(|making| making.wanted.is_same(&wanted)) {
            Some(making) => *making,
            None => {
                let work = wanted.work(self.opened_surface().cloned());
                Making { wanted, work, made: None }
            }
        }
    }

    /// Does up to `budget` slices of the work to make a surface; returns the share that is done.
    pub(super) fn make(&mut self, wanted: Wanted, budget: u32) -> f64 {
        let mut making = self.making(wanted);
        if making.made.is_none() {
            making.made = making.work.advance(budget);
        }
        let share = if making.made.is_some() { 1.0 } else { making.work.fraction().min(0.999) };
        self.making = Some(Box::new(making));
        share
    }

    /// Changes the field to a surface of a file, with the formula and the box of a request.
    pub(super) fn set_opened(
        &mut self,
        name: &str,
        request: &FieldRequest,
        wanted: Wanted,
    ) -> Result<FieldAnswer, Fault> {
        let own = request.bounds.unwrap_or(FALLBACK);
        check_box(&own)?;
        let Making { work, made, .. } = self.making(wanted);
        let surface = made.unwrap_or_else(|| slices::in_pool(|| work.complete()))?;
        let before = match self.run.field() {
            Source::Opened(before) => Some(&**before),
            _ => None,
        };
        let within = match &request.formula {
            Some(text) => Some(Self::model_formula(text, &surface.shared(), request)?),
            None => None,
        };
        // Whether the file is the same, and whether its surface is, too.
        let is_kept =
            before.is_some_and(|before| before.surface.is_of_same(&surface) && before.within == within);
        let is_same = is_kept && before.is_some_and(|before| before.surface.choice() == surface.choice());
        let is_open = request.bounds.is_none();
        let keeps_box = is_kept && is_open && self.fitting.is_fitted;
        let source = Source::Opened(Box::new(OpenedSource { name: name.to_owned(), surface, within }));
        self.run.set_field(source, is_same);
        self.surface = None;
        self.declared.clear();
        if !is_same {
            self.fitting.restart();
        }
        if !keeps_box {
            self.fitting.discard();
            self.fitting.is_given = !is_open;
            (self.own, self.clip, self.reach) = (own, own, None);
            self.run.set_bounds(own, None);
        }
        Ok(self.answer())
    }

    /// Changes the choices for the present file: values that the request does not name stay. None
    /// if the field is not from a file.
    pub(super) fn change_opened(&mut self, request: &FieldRequest) -> Option<Result<FieldAnswer, Fault>> {
        let Source::Opened(present) = self.run.field() else { return None };
        let (surface, name) = (present.surface.clone(), present.name.clone());
        let mut request = request.clone();
        for (name, value) in surface.choice() {
            request.parameters.entry(name.to_owned()).or_insert(value);
        }
        request.bounds = request.bounds.or(self.fitting.is_given.then_some(self.own));
        Some(match surface {
            Surface::Image(surface) => self.set_image(surface.image(), &name, &request),
            #[cfg(feature = "points")]
            Surface::Mesh(surface) => self.set_mesh(&surface.mesh, &name, &request),
        })
    }
}
