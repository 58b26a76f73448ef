//! The surface that the arguments name, and the box of its run.

use crate::arguments::{BoxChoice, SurfaceArguments};
use crate::bar::bar;
use crate::failure::Failure;
use crate::image::{self, ImageInfo};
use crate::points;
use crate::remesh::{self, RemeshInfo};
use marching_particles::field::formula::{self, MODEL, Parameter, Thickness};
use marching_particles::field::model::{self, ModelInfo};
use marching_particles::internal::math::shortest_text;
use marching_particles::internal::session::{
    BoxFaces, Fault, FaultKind, FieldAnswer, FieldRequest, Session, SolidSettings, Source,
};
use marching_particles::pointcloud::fit::Fit;
use marching_particles::pointcloud::job::DEFAULT_CENTRES;
use marching_particles::remesh::MeshField;
use marching_particles::{Bounds, Field, Settings, gallery};
use std::path::Path;
use std::sync::Arc;

/// The fit to a file of points or a built-in model, if one is requested.
fn fit_points(arguments: &SurfaceArguments, quiet: bool) -> Result<Option<Fit>, Failure> {
    let model = arguments.surface.as_deref().and_then(model::find);
    let bar = bar(quiet || arguments.points.is_none() && model.is_none());
    let centres = arguments.centres.unwrap_or(DEFAULT_CENTRES);
    let fit = match (&arguments.points, model) {
        _ if (arguments.points.is_some() || model.is_some())
            && arguments.formula.is_none()
            && !arguments.parameters.is_empty() =>
        {
            return Err(Failure::Usage(
                "parameters are for formulas: a model from points has none, but as an operand of one \
                 (--formula \"max(model, z - h)\")"
                    .into(),
            ));
        }
        _ if arguments.beyond_points.is_some()
            && (arguments.points.is_none() || arguments.formula.is_some()) =>
        {
            return Err(Failure::Usage(
                "--beyond-points is for --points by themselves: as an operand of a formula they have all of \
                 their surface"
                    .into(),
            ));
        }
        (Some(path), _) => Some(points::of_file(path, centres, &bar)?),
        (None, Some(model)) => Some(points::of_model(model.id, centres, &bar)?),
        (None, None) if arguments.centres.is_some() => {
            return Err(Failure::Usage(
                "--centres is for --points and for the models that are made of points".into(),
            ));
        }
        (None, None) => None,
    };
    bar.finish_and_clear();
    Ok(fit)
}

/// Takes the surface that is given without an option for one with a name or for a formula. A word
/// that is nearly a name is taken for one, since no formula is.
pub(crate) fn read_text(arguments: &mut SurfaceArguments) -> Result<(), Failure> {
    /// Letters of the shortest word that is taken for a name with a mistake.
    const SHORTEST: usize = 4;
    let Some(text) = arguments.text.take() else { return Ok(()) };
    if Path::new(&text).is_file() {
        return Err(Failure::Usage(format!(
            "{text} is a file: --points, --mesh-in or --image takes it, by what it holds"
        )));
    }
    let is_word = text.len() >= SHORTEST && text.bytes().all(|c| c.is_ascii_alphanumeric() || c == b'-');
    let is_name = names().any(|name| name == text) || is_word && formula::similar(&text, names()).is_some();
    let is_chosen =
        arguments.surface.is_some() || arguments.points.is_some() || arguments.mesh.mesh_in.is_some();
    if is_name && !is_chosen {
        arguments.surface = Some(text);
    } else {
        arguments.formula = Some(text);
    }
    Ok(())
}

/// The names of all surfaces.
fn names() -> impl Iterator<Item = &'static str> {
    let surfaces = gallery::SURFACES.iter().map(|surface| surface.id);
    surfaces.chain(model::MODELS.iter().map(|model| model.id))
}

/// The source of a surface.
#[derive(Clone, Debug)]
pub(crate) enum Origin {
    Formula,
    /// Points, with the report of the fit.
    Points(ModelInfo),
    Image(ImageInfo),
    Mesh(Box<(MeshField, RemeshInfo)>),
}

/// Sets the session's surface to the one that the arguments name.
pub(crate) fn choose(
    session: &mut Session,
    arguments: &SurfaceArguments,
    quiet: bool,
) -> Result<Origin, Failure> {
    let (solid, given) = (arguments.solid(), arguments.bounds.and_then(BoxChoice::given));
    let refused = |fault| refused_field(arguments, fault);
    if let Some((field, info)) = image::of_arguments(arguments)? {
        session.set_function(Arc::new(field), given).map_err(refused)?;
        session.choose(solid).map_err(|fault| Failure::Usage(fault.message))?;
        return Ok(Origin::Image(info));
    }
    if let Some((field, info)) = remesh::of_arguments(arguments)? {
        let request = FieldRequest {
            formula: arguments.formula.clone(),
            parameters: arguments.parameters.iter().cloned().collect(),
            bounds: given,
            ..FieldRequest::default()
        };
        let answer = session.set_model(Arc::new(field.clone()), &request).map_err(refused)?;
        check_parameters(arguments, &answer)?;
        session.choose(solid).map_err(|fault| Failure::Usage(fault.message))?;
        return Ok(Origin::Mesh(Box::new((field, info))));
    }
    let mut request =
        FieldRequest { bounds: given, pulls: arguments.pulls.clone(), ..FieldRequest::default() };
    if let Some(fit) = fit_points(arguments, quiet)? {
        if solid.box_faces == BoxFaces::Closed || solid.thickened().is_some() {
            return Err(Failure::Usage(
                "--closed and --thickness are for formulas, not for models from points".into(),
            ));
        }
        session.choose(solid).map_err(|fault| Failure::Usage(fault.message))?;
        request.formula.clone_from(&arguments.formula);
        request.parameters = arguments.parameters.iter().cloned().collect();
        let answer = session.set_points(fit.data, fit.info.clone(), fit.bounds, &request).map_err(refused)?;
        check_parameters(arguments, &answer)?;
        return Ok(Origin::Points(fit.info));
    }
    request.formula.clone_from(&arguments.formula);
    request.surface.clone_from(&arguments.surface);
    if request.surface.is_none() && request.formula.is_none() {
        request.surface = Some(gallery::SURFACES[0].id.to_owned());
    }
    let named = request.surface.as_deref().and_then(gallery::find);
    // A replaced formula keeps the values of the surface's parameters.
    let own = named.iter().flat_map(|surface| surface.parameters).map(|p| (p.name.to_string(), p.value));
    request.parameters = own.chain(arguments.parameters.iter().cloned()).collect();
    request.declare = arguments.parameters.iter().map(|(name, _)| Parameter::automatic(name)).collect();
    let answer = session.set_field(&request).map_err(refused)?;
    if answer.auto.iter().any(|name| name == MODEL) {
        return Err(Failure::Usage(
            "the formula takes a model as an operand: give its points with --points, or name one with \
             --surface"
                .into(),
        ));
    }
    check_parameters(arguments, &answer)?;
    // The thickness may use names of the formula.
    session.choose(solid.clone()).map_err(|fault| refused_solid(&solid, fault))?;
    Ok(Origin::Formula)
}

/// Why a solid was refused.
pub(crate) fn refused_solid(solid: &SolidSettings, fault: Fault) -> Failure {
    match (&fault.kind, &solid.thickness) {
        (FaultKind::Thickness, Thickness::Formula(text)) => {
            Failure::Formula { text: text.clone(), fault: Box::new(fault) }
        }
        _ => Failure::Usage(fault.message),
    }
}

/// Refuses a value for a parameter that the formula does not have.
fn check_parameters(arguments: &SurfaceArguments, answer: &FieldAnswer) -> Result<(), Failure> {
    for (name, _) in &arguments.parameters {
        if !answer.parameters.iter().any(|parameter| parameter.name == *name) {
            let known: Vec<&str> = answer.parameters.iter().map(|p| &*p.name).collect();
            let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
            return Err(Failure::Usage(format!(
                "the formula has no parameter `{name}`; its parameters: {known}"
            )));
        }
    }
    Ok(())
}

/// Finds the box of the next run. Returns the settings for it.
pub(crate) fn fit(
    session: &mut Session,
    settings_in: &dyn Fn(&Bounds) -> Settings,
    only_grows: bool,
) -> Result<Settings, Failure> {
    while session.fit(settings_in, only_grows, u32::MAX).is_none() {}
    if let Source::Formula(formula) = session.run.field()
        && formula.facts().unit_cell.is_some_and(|cell| cell.repeats == [false; 3])
    {
        return Err(Failure::Usage(not_periodic(formula.surface_periods())));
    }
    Ok(settings_in(&session.run.bounds()))
}

/// Why no two faces of a box are equal, for a surface with these periods.
fn not_periodic(periods: [Option<f64>; 3]) -> String {
    let known: Vec<String> = ["x", "y", "z"]
        .iter()
        .zip(periods)
        .filter_map(|(axis, period)| Some(format!("{} along {axis}", shortest_text(period?))))
        .collect();
    if known.is_empty() {
        return "--periodic is for surfaces that repeat along x, y or z, and this one is not known to"
            .to_owned();
    }
    format!(
        "--periodic takes a box that is a whole number of periods wide along x, y or z: the surface has a period of {}",
        known.join(", ")
    )
}

/// Why a surface was refused.
fn refused_field(arguments: &SurfaceArguments, fault: Fault) -> Failure {
    match (&fault.kind, &arguments.surface) {
        (FaultKind::UnknownSurface, Some(id)) => Failure::Usage(unknown_surface(id)),
        (FaultKind::Formula(_), _) => {
            Failure::Formula { text: arguments.formula.clone().unwrap_or_default(), fault: Box::new(fault) }
        }
        _ => Failure::Usage(fault.message),
    }
}

fn unknown_surface(id: &str) -> String {
    let meant: Vec<String> = gallery::by_word(id).map(|surface| format!("`{}`", surface.id)).collect();
    match formula::similar(id, names()) {
        _ if !meant.is_empty() => format!("there is no surface `{id}`: did you mean {}?", meant.join(" or ")),
        Some(guess) => format!("there is no surface `{id}`: did you mean `{guess}`?"),
        None => format!("there is no surface `{id}`; `marching-particles surfaces` lists them"),
    }
}
