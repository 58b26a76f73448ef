//! The surface of a three-dimensional image as the field of a session.

use serde::Serialize;

/// The image whose surface is sampled, and the choices for it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct ImageInfo {
    /// Name of the file or the array.
    pub name: String,
    /// Voxels along each axis.
    pub size: [usize; 3],
    /// Smallest and largest voxel.
    pub range: [f64; 2],
    /// The label whose boundary is sampled instead of an iso value.
    pub label: Option<f64>,
    /// The value on the surface; for a label, the value of the distance from it.
    pub iso: f64,
    /// Width of the Gaussian in voxels, 0 for none.
    pub smooth: f64,
    /// Whether the width was chosen automatically, not by the user.
    pub is_smooth_chosen: bool,
    /// Standard deviation of the noise, in the values of the voxels.
    pub noise: f64,
    /// Whether darker voxels are inside.
    pub is_dark_inside: bool,
    /// Whether a surface that the border of the image cuts is closed there.
    pub is_closed: bool,
    /// Decisions that were made, in sentences.
    pub notes: Vec<String>,
}

/// Facts about an image, before its surface is chosen.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct ImageFacts {
    /// Voxels along each axis.
    pub size: [usize; 3],
    /// Distances between voxels along each axis.
    pub spacing: [f64; 3],
    /// Type of the voxels, such as `int16`.
    pub voxel_type: String,
    /// Smallest and largest voxel.
    pub range: [f64; 2],
    /// Number of voxels in each of 256 bins of equal width over the range.
    pub histogram: Vec<u64>,
    /// The iso value that Otsu's method chooses.
    pub otsu: f64,
    /// Its labels with their numbers of voxels, the background 0 included, if its values look like
    /// labels: up to 256 whole numbers.
    pub labels: Vec<LabelFacts>,
    /// Decisions of the reader, in sentences.
    pub notes: Vec<String>,
}

/// A label of an image.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct LabelFacts {
    /// The value of its voxels.
    pub value: f64,
    /// Number of its voxels.
    pub voxels: u64,
}

/// The size and type of an image, and the memory that it needs, from the header of its file.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct ImagePromise {
    /// Voxels along each axis; none if that takes the whole file.
    pub size: Option<[usize; 3]>,
    /// Type of the voxels, such as `int16`; empty if that takes the whole file.
    pub voxel_type: String,
    /// Bytes of memory for reading and filtering; 0 if that takes the whole file.
    pub memory: u64,
    /// Bytes of the voxels alone; 0 if that takes the whole file.
    pub bytes: u64,
}

#[cfg(feature = "images")]
pub(super) use with_images::{choice, parameters};

#[cfg(feature = "images")]
mod with_images {
    use super::super::opened::{Surface, Wanted};
    use super::super::{FieldAnswer, FieldRequest, Session};
    use super::{ImageFacts, ImageInfo, ImagePromise, LabelFacts};
    use crate::field::formula::Parameter;
    use crate::image::{Image, ImageChoice, ImageOutline, ImageSurface, Section};
    use crate::session::Fault;
    use std::collections::BTreeMap;

    /// Minimum number of steps of the iso value's slider over the range of the voxels.
    const STEPS: f64 = 200.0;
    /// Largest width of the Gaussian on its slider, in voxels.
    const WIDEST: f64 = 4.0;
    /// Maximum number of labels that are listed; an image with more values has grey values.
    const MOST_LABELS: usize = 256;

    /// The names of the choices among the parameters of a request.
    const NAMES: [&str; 5] = ["iso", "label", "smooth", "dark", "closed"];

    /// The choice made by named values.
    fn choice_of(values: &BTreeMap<String, f64>) -> ImageChoice {
        let [iso, label, smooth, dark, closed] = NAMES.map(|name| values.get(name).copied());
        let is_chosen = |value: Option<f64>| value.is_some_and(|value| value != 0.0);
        ImageChoice { iso, label, smooth, is_dark_inside: is_chosen(dark), is_closed: is_chosen(closed) }
    }

    /// The named values that make the choice of a surface.
    pub(in super::super) fn choice(surface: &ImageSurface) -> impl Iterator<Item = (&'static str, f64)> {
        let ImageChoice { iso, label, smooth, is_dark_inside, is_closed } = *surface.choice();
        let values = [iso, label, smooth, is_dark_inside.then_some(1.0), is_closed.then_some(1.0)];
        NAMES.into_iter().zip(values).filter_map(|(name, value)| Some((name, value?)))
    }

    impl ImageInfo {
        pub(in super::super) fn of(name: &str, surface: &ImageSurface) -> Self {
            let (image, choice) = (surface.image(), surface.choice());
            Self {
                name: name.to_owned(),
                size: image.size(),
                range: image.range(),
                label: choice.label,
                iso: surface.field().iso(),
                smooth: surface.smooth(),
                is_smooth_chosen: choice.smooth.is_none(),
                noise: surface.noise(),
                is_dark_inside: choice.is_dark_inside,
                is_closed: choice.is_closed,
                notes: surface.notes().to_vec(),
            }
        }
    }

    /// The sliders of a surface: the iso value, unless it is of a label, and the Gaussian.
    pub(in super::super) fn parameters(surface: &ImageSurface) -> Vec<Parameter> {
        let smooth = Parameter {
            name: NAMES[2].into(),
            label: "Smoothing".into(),
            value: surface.smooth(),
            min: 0.0,
            max: WIDEST.max(surface.smooth()),
            step: 0.1,
        };
        if surface.choice().label.is_some() {
            return vec![smooth];
        }
        let [min, max] = surface.image().range();
        let step = step_in(max - min);
        // At the ends there is no surface.
        let (first, last) = (min + step, max - step);
        let iso = Parameter {
            name: NAMES[0].into(),
            label: "Iso value".into(),
            value: surface.field().iso(),
            min: if first < last { first } else { min },
            max: if first < last { last } else { max },
            step,
        };
        vec![iso, smooth]
    }

    /// The largest power of ten, or half or a fifth of it, that fits at least [`STEPS`] times into
    /// a range.
    fn step_in(range: f64) -> f64 {
        let wanted = range / STEPS;
        let power = libm::pow(10.0, libm::floor(libm::log10(wanted)));
        [5.0, 2.0, 1.0].map(|part| part * power).into_iter().find(|step| *step <= wanted).unwrap_or(power)
    }

    impl ImageFacts {
        /// The facts of an image, found in slices of work.
        pub async fn of(image: &Image) -> Self {
            let labels = image.up_to(MOST_LABELS).await;
            let of = |label: &crate::image::Label| LabelFacts { value: label.value, voxels: label.voxels };
            let histogram = image.counted().await;
            Self {
                size: image.size(),
                spacing: image.placement().spacing(),
                voxel_type: image.voxel_type().to_string(),
                range: image.range(),
                histogram: histogram.counts().to_vec(),
                otsu: histogram.otsu(),
                labels: labels.iter().map(of).collect(),
                notes: image.notes().to_vec(),
            }
        }
    }

    impl ImagePromise {
        /// Size and type of the voxels by the header of a file, and the memory that reading them
        /// takes. Without an outline all are 0 or empty.
        #[must_use]
        pub fn of(outline: Option<&ImageOutline>) -> Self {
            Self {
                size: outline.map(|outline| outline.size),
                voxel_type: outline.map(|outline| outline.voxel_type.to_string()).unwrap_or_default(),
                memory: outline.map_or(0, ImageOutline::memory),
                bytes: outline.map_or(0, ImageOutline::bytes),
            }
        }
    }

    impl Session {
        /// Changes the field to the surface of an image. In the request, the parameters `iso`,
        /// `label`, `smooth` and, if not 0, `dark` and `closed` are an [`ImageChoice`]. Its formula
        /// has the surface as an operand, see [`Formula::with_model`]. The box is given by the
        /// request, or is fitted. [`Session::set_field`] without a surface and a formula changes
        /// the choice.
        ///
        /// [`Formula::with_model`]: crate::field::formula::Formula::with_model
        ///
        /// # Errors
        ///
        /// If the choice has no surface, the formula has a mistake or the box is not one; nothing
        /// is changed then.
        pub fn set_image(
            &mut self,
            image: &Image,
            name: &str,
            request: &FieldRequest,
        ) -> Result<FieldAnswer, Fault> {
            self.set_opened(name, request, Wanted::Image(image.clone(), choice_of(&request.parameters)))
        }

        /// The voxels of the present image in a plane: see [`Image::section`]. Labels are those of
        /// the nearest voxels, grey values are interpolated. None if the field is of no image.
        #[must_use]
        pub fn section(&self, section: &Section) -> Option<Vec<f32>> {
            match self.opened_surface()? {
                Surface::Image(surface) => {
                    Some(surface.image().section(section, surface.choice().label.is_none()))
                }
                #[cfg(feature = "points")]
                Surface::Mesh(_) => None,
            }
        }

        /// Does up to `budget` slices of the work of [`Session::set_image`] with these arguments,
        /// which then takes what is made. Returns the share that is done, 1 at the end. A call for
        /// another image or choice begins again.
        pub fn make_image(&mut self, image: &Image, request: &FieldRequest, budget: u32) -> f64 {
            self.make(Wanted::Image(image.clone(), choice_of(&request.parameters)), budget)
        }
    }
}

#[cfg(all(test, feature = "images"))]
mod tests {
    use crate::image::Image;
    use crate::run::{Measured, Report};
    use crate::sampler::{Phase, Settings};
    use crate::session::{FaultKind, FieldAnswer, FieldRequest, Session};
    use std::collections::BTreeMap;

    /// A ball of radius 8 voxels, with the value 0 on it and 100 one voxel inside.
    fn ball() -> Image {
        let off = |at: usize| (at % 24) as f64 - 11.4;
        let distance = |at: usize| (off(at).powi(2) + off(at / 24).powi(2) + off(at / 576).powi(2)).sqrt();
        let voxels: Vec<i16> =
            (0..24 * 24 * 24).map(|at| (100.0 * (8.0 - distance(at))).round() as i16).collect();
        Image::new([24; 3], voxels).expect("an image")
    }

    fn request(values: &[(&str, f64)]) -> FieldRequest {
        let parameters: BTreeMap<String, f64> =
            values.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
        FieldRequest { parameters, ..FieldRequest::default() }
    }

    /// The digest of a run on the present field.
    fn digest(session: &mut Session) -> u64 {
        session.start(&Settings::with_count(400)).expect("a run");
        while session.run.step(10_000).phase != Phase::Done {}
        session.run.particles().digest()
    }

    fn iso(answer: &FieldAnswer) -> f64 {
        answer.image.as_ref().expect("an image").iso
    }

    #[test]
    fn another_iso_value_gives_what_opening_at_it_gives() {
        let (mut moved, mut fresh) = (Session::new(), Session::new());
        let image = ball();
        moved.set_image(&image, "ball", &request(&[("iso", 0.0)])).expect("a field");
        let first = digest(&mut moved);
        for value in [150.0, 300.0, 100.0] {
            let answer = moved.set_field(&request(&[("iso", value)])).expect("a field");
            assert_eq!(iso(&answer), value);
        }
        fresh.set_image(&ball(), "ball", &request(&[("iso", 100.0)])).expect("a field");
        let last = digest(&mut moved);
        assert_ne!(first, last);
        assert_eq!(last, digest(&mut fresh));
        // Parameters that are not named stay.
        let answer = moved.set_field(&request(&[("dark", 1.0)])).expect("a field");
        assert_eq!(iso(&answer), 100.0);
        assert!(answer.image.is_some_and(|image| image.is_dark_inside));
    }

    /// Triangles of natural neighbours leave gaps along the narrow edges of the caps.
    #[test]
    fn a_report_closes_what_the_mesh_closes_also_without_a_request_for_the_mesh() {
        let off = |at: usize| (at % 20) as f64 - 9.4;
        let distance = |at: usize| libm::hypot(off(at), off(at / 20));
        let rod = Image::new([20; 3], (0..8_000).map(|at| 6.0 - distance(at)).collect::<Vec<f64>>());
        let rod = rod.expect("an image");
        for count in [800, 2_500] {
            let mut session = Session::new();
            let closed = request(&[("iso", 0.0), ("smooth", 0.0), ("closed", 1.0)]);
            session.set_image(&rod, "rod", &closed).expect("a field");
            session.start(&Settings::with_count(count)).expect("a run");
            while session.run.step(10_000).phase != Phase::Done {}
            let report = loop {
                if let Some(report) = session.measure(Measured::Particles, 5) {
                    break report;
                }
            };
            let euler = |report: &Report| report.measures.quality.expect("figures").connectivity.euler;
            assert_eq!((euler(&report), report.proof.components), (2, 1), "{count}");
            assert_eq!(euler(&session.report()), 2, "{count}");
        }
    }

    #[test]
    fn a_field_made_in_slices_is_the_one_made_at_once() {
        let (mut sliced, mut whole) = (Session::new(), Session::new());
        let image = ball();
        let wanted = request(&[("iso", 150.0), ("smooth", 0.8)]);
        // Another choice begins again, and one that is made is not made again.
        assert!(sliced.make_image(&image, &request(&[("iso", 300.0)]), 3) < 1.0);
        let mut shares = Vec::new();
        while shares.last() != Some(&1.0) {
            shares.push(sliced.make_image(&image, &wanted, 1));
        }
        assert!(shares.len() > 20 && shares.is_sorted(), "{shares:?}");
        assert_eq!(sliced.make_image(&image, &wanted, 1), 1.0);
        sliced.set_image(&image, "ball", &wanted).expect("a field");
        whole.set_image(&image, "ball", &wanted).expect("a field");
        assert_eq!(digest(&mut sliced), digest(&mut whole));
        // An iso value without a surface is refused when the field is set, not while it is made.
        assert_eq!(sliced.make_image(&image, &request(&[("iso", 1e6)]), u32::MAX), 1.0);
        let fault = sliced.set_image(&image, "ball", &request(&[("iso", 1e6)])).expect_err("refused");
        assert_eq!(fault.kind, FaultKind::Image);
        assert_eq!(iso(&sliced.answer()), 150.0);
    }

    #[test]
    fn a_surface_that_is_not_there_leaves_the_one_before_it() {
        let mut session = Session::new();
        let image = ball();
        session.set_image(&image, "ball", &request(&[("iso", 0.0)])).expect("a field");
        for values in [[("iso", 1e6)], [("label", 12_345.0)], [("smooth", -1.0)]] {
            let fault = session.set_image(&image, "ball", &request(&values)).expect_err("refused");
            assert_eq!(fault.kind, FaultKind::Image, "{fault}");
            assert_eq!(iso(&session.answer()), 0.0);
        }
        let formula = FieldRequest { formula: Some("x^2 + y^2 = 1".to_owned()), ..FieldRequest::default() };
        assert!(session.set_field(&formula).expect("a field").image.is_none());
    }
}
