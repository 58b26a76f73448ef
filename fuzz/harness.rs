//! What must hold of any formula, file, image, mesh and request. Each function takes any bytes and
//! panics where something does not hold.
//!
//! libFuzzer calls them (`targets/`), and so does `tests/it/fuzz.rs`, with mutations of the files
//! in `seeds/`.

use glam::{DVec3, Vec3};
use marching_particles::Bounds;
use marching_particles::field::formula::Formula;
use marching_particles::field::{Enclosure, Field, Frame, Jet};
use marching_particles::field::{Interval, Sym3};
use marching_particles::image::{ImageChoice, RawVoxels, VoxelType};
use marching_particles::internal::session::{FieldRequest, Session};
use marching_particles::internal::slices::complete;
use marching_particles::pointcloud::job::Job;
use marching_particles::pointcloud::read::Reader;
use marching_particles::sampler::{Search, Settings};
use marching_particles::{Image, TriangleMesh};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// Numbers that are the same for the same bytes.
struct Random(Pcg32);

impl Random {
    fn of(bytes: &[u8]) -> Self {
        let fnv = |hash: u64, &byte: &u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        Self(Pcg32::seed_from_u64(bytes.iter().fold(0xcbf2_9ce4_8422_2325, fnv)))
    }

    fn between(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * f64::from(self.0.next_u32()) / 4_294_967_296.0
    }

    fn point(&mut self, half: f64) -> DVec3 {
        DVec3::from_array([(); 3].map(|()| self.between(-half, half)))
    }
}

/// A formula: a mistake in it has a place and a message; without one, it means the same once it is
/// printed, and all its readings agree: value, derivatives, bounds over boxes, and single points in
/// batches.
pub fn formula(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let mut random = Random::of(bytes);
    let mut field = match Formula::as_written(&text, &[]) {
        Ok(field) => field,
        Err(error) => {
            let (start, end) = (error.span.start, error.span.end);
            assert!(start <= end && text.is_char_boundary(start) && text.is_char_boundary(end), "{error:?}");
            assert!(!error.message.is_empty() && error.utf16_span(&text).start <= text.len(), "{error:?}");
            return;
        }
    };
    let printed = field.normal_form();
    match Formula::as_written(&printed, &[]) {
        Ok(again) => assert!(field.same_tree(&again), "{text} → {printed}"),
        // What is printed may be longer than what may be typed.
        Err(error) => assert!(printed.len() > text.len(), "{text} → {printed}: {error}"),
    }
    for name in field.auto().to_vec() {
        field.set_parameter(&name, random.between(-2.0, 2.0)).expect("a finite value");
    }
    let points = [(); 4].map(|()| random.point(3.0));
    check_derivatives(&field, &points);
    check_batch(&mut field, random.point(2.0).as_vec3(), 1 + random.0.next_u32() as usize % 40);
    // A sum is its own only factor, provided that its last term cancels nothing.
    let sum = match printed.rsplit_once("; ") {
        Some((definitions, surface)) => format!("{definitions}; ({surface}) + x^2 + 0.618034"),
        None => format!("({text}) + x^2 + 0.618034"),
    };
    if let Ok(mut sum) = Formula::as_written(&sum, &[]) {
        for name in sum.auto().to_vec() {
            sum.set_parameter(&name, random.between(-2.0, 2.0)).expect("a finite value");
        }
        let scale = 0.25_f64.powi(random.0.next_u32() as i32 & 15);
        let (lo, size) = (random.point(3.0), random.point(1.0).abs() * scale);
        check_value(&mut sum, random.point(3.0), size, random.point(1.0).abs() * scale);
        let places = [(); 2].map(|()| DVec3::from_array([(); 3].map(|()| random.between(0.0, 1.0))));
        check_enclosure(&mut sum, lo, size, places);
    }
}

/// The bounds of a sum over a box around a point hold the value there, and say where it has none.
pub fn check_value(field: &mut Formula, p: DVec3, below: DVec3, above: DVec3) {
    let mut out = [Enclosure::UNKNOWN];
    field.evaluator(Frame::default()).bounded().expect("a formula has bounds").enclose(
        0,
        &[Bounds::new(p - below, p + above)],
        &mut out,
    );
    let [Enclosure { value: bounds, defined, .. }] = out;
    let value = field.jet(p).value;
    let context = || format!("{} at {p}, {below} {above}: {value}, {out:?}", field.text());
    assert!(!bounds.lo.is_nan() && !bounds.hi.is_nan(), "{}", context());
    // An intermediate result beyond the numbers makes 0·∞ of what is 0
    // (`tests/it/formula_properties.rs` asks for more of tamer formulas), and at a pole the sign of
    // a zero decides that of the infinity.
    if !value.is_nan() && (value.is_finite() || defined) {
        assert!(bounds.holds(value), "{}", context());
    }
}

/// The bounds of the derivatives over a box hold those at a point of it, and its mean slopes
/// between two points, given as shares of its size.
pub fn check_enclosure(field: &mut Formula, lo: DVec3, size: DVec3, places: [DVec3; 2]) {
    let mut out = [Enclosure::UNKNOWN];
    let around = Bounds::new(lo, lo + size);
    field.evaluator(Frame::default()).bounded().expect("a formula has bounds").enclose(
        0,
        &[around],
        &mut out,
    );
    let [known] = out;
    if !(known.defined && known.continuous) {
        return;
    }
    let [p, q] = places.map(|share| (lo + size * share).min(lo + size));
    let gradient = field.transformed_jet(p).gradient;
    for axis in 0..3 {
        let (bounds, slope) = (known.gradient[axis], gradient[axis]);
        assert!(bounds.lo <= bounds.hi, "{}: {known:?}", field.text());
        let is_within = !slope.is_finite() || bounds.holds(slope);
        assert!(is_within, "{}: {gradient} at {p}, not in {known:?}", field.text());
    }
    let mut second = [Sym3::splat(Interval::EVERYTHING)];
    field.evaluator(Frame::default()).bounded().expect("a formula has bounds").enclose_second(
        0,
        &[around],
        &mut second,
    );
    let h = field.transformed_jet(p).hessian;
    for (bounds, exact) in second[0].entries().into_iter().zip(h.entries()) {
        let is_within = !known.smooth || !exact.is_finite() || bounds.holds(exact);
        assert!(is_within, "{}: {h:?} at {p}, not in {second:?}", field.text());
    }
    // By the mean value theorem f(q) − f(p) is a slope within the bounds times q − p, even across
    // kinks.
    let (from, to) = (field.jet(p).value, field.jet(q).value);
    let mut rise = Interval::new(0.0, 0.0);
    for axis in 0..3 {
        let way = q[axis] - p[axis];
        rise = rise + known.gradient[axis] * way;
    }
    let slack = 1e-11 * (from.abs() + to.abs() + known.value.lo.abs() + known.value.hi.abs())
        + rounding(field, p)
        + rounding(field, q);
    let rise = rise.widened(slack);
    // False for NaN.
    let is_outside = to - from < rise.lo || to - from > rise.hi;
    assert!(!is_outside, "{}: {from} at {p} and {to} at {q}, but {known:?}", field.text());
}

/// How far rounding may move the value at a point, by the bounds there: terms may be millions of
/// times as large as their sum.
fn rounding(field: &mut Formula, p: DVec3) -> f64 {
    let mut out = [Enclosure::UNKNOWN];
    field.evaluator(Frame::default()).bounded().expect("a formula has bounds").enclose(
        0,
        &[Bounds::point(p)],
        &mut out,
    );
    out[0].value.hi - out[0].value.lo
}

/// Derivatives by transformation of the formula are those of forward jets, but for rounding.
pub fn check_derivatives(field: &Formula, points: &[DVec3]) {
    /// The bounds on rounding hold for the operations of the graph. Jets do those within one node
    /// in an order of their own, which takes a few times as many.
    const ORDERS: f64 = 8.0;
    /// What underflows to 0 on one of the ways counts as no difference, even times 10¹⁵⁰.
    const UNDERFLOW: f64 = 1e-154;
    let numbers = |jet: Jet| {
        let (g, h) = (jet.gradient, jet.hessian);
        [jet.value, g.x, g.y, g.z, h.xx, h.xy, h.xz, h.yy, h.yz, h.zz]
    };
    for (&p, rounding) in points.iter().zip(field.rounding(points)) {
        let (jet, other) = (numbers(field.jet(p)), numbers(field.transformed_jet(p)));
        for ((a, b), rounding) in jet.into_iter().zip(other).zip(rounding) {
            // A branch that is not taken may overflow, and so may an intermediate result.
            let is_same = !a.is_finite() || !b.is_finite() || (a - b).abs() <= ORDERS * rounding + UNDERFLOW;
            assert!(is_same, "{} at {p}: {jet:?} but {other:?}: {rounding:e}", field.text());
        }
    }
}

/// A point gives the same bits alone and in a batch, and the same value whatever is asked for with
/// it.
fn check_batch(field: &mut Formula, first: Vec3, length: usize) {
    let points: Vec<Vec3> = (0..length).map(|k| first * (k as f32 * 0.01 + 1.0)).collect();
    let (mut value, mut gradient) = (vec![0.0; length], vec![Vec3::ZERO; length]);
    let mut hessian = vec![Sym3::default(); length];
    field.evaluator(Frame::default()).hessians(&points, &mut value, &mut gradient, &mut hessian);
    let k = length / 2;
    let (mut alone, mut slope, mut second) = ([0.0], [Vec3::ZERO], [Sym3::default()]);
    field.evaluator(Frame::default()).hessians(&points[k..=k], &mut alone, &mut slope, &mut second);
    let same = |a: f32, b: f32| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
    let is_same = same(value[k], alone[0])
        && (0..3).all(|axis| same(gradient[k][axis], slope[0][axis]))
        && same(hessian[k].xy, second[0].xy);
    assert!(is_same, "{} at {}: {} {}", field.text(), points[k], value[k], alone[0]);
}

/// A file of points: it is read or refused in words, what is read is finite, and a surface is
/// fitted to it or refused. The first byte chooses the extension of its name.
pub fn file(bytes: &[u8]) {
    /// Steps that no job on so small a file needs.
    const MOST_STEPS: u32 = 1_000_000;
    /// Larger ones are read, not solved: that takes a second.
    const MOST_SOLVED: usize = 64;
    let Some((&first, content)) = bytes.split_first() else { return };
    let name = ["a", "a.ply", "a.obj", "a.stl", "a.xyz", "a.off", "a.pcd", "a.pts"][usize::from(first) % 8];
    let tell = |fraction: f64| assert!((0.0..=1.0).contains(&fraction), "{fraction}");
    let mesh = match Reader::new(name, content.to_vec()).and_then(|reader| complete(reader.read(tell))) {
        Ok(mesh) => mesh,
        Err(error) => {
            assert!(!error.to_string().is_empty(), "an error without words: {error:?}");
            return;
        }
    };
    let (cloud, _) = complete(mesh.into_cloud(tell)).expect("memory enough");
    assert!(cloud.position.iter().all(|p| p.is_finite()));
    assert!(cloud.normal.iter().all(|n| (n.length() - 1.0).abs() < 1e-9), "{:?}", cloud.normal);
    if cloud.len() <= MOST_SOLVED
        && let Ok(mut job) = Job::file(name, content.to_vec(), 20)
    {
        let mut steps = 0;
        while job.step(10_000).is_ok_and(|progress| !progress.done) {
            steps += 1;
            assert!(steps < MOST_STEPS, "the job does not end");
        }
    }
}

/// One of so many requests is sampled, which takes a thousand times as long as to read one.
const SAMPLED: u32 = 16;

/// A request as the page sends it, `{"field": …, "settings": …}`.
fn parsed(bytes: &[u8]) -> Option<(FieldRequest, Settings)> {
    let mut given = serde_json::from_slice::<serde_json::Value>(bytes).ok()?;
    let mut take = |name: &str| given.get_mut(name).map(serde_json::Value::take).unwrap_or_default();
    let field = serde_json::from_value(take("field")).ok()?;
    let settings = serde_json::from_value(take("settings")).ok()?;
    Some((field, settings))
}

/// A request: its field and its settings are taken or refused in words, and one of [`SAMPLED`] is
/// checked by [`whole_request`].
pub fn request(bytes: &[u8]) {
    if Random::of(bytes).0.next_u32().is_multiple_of(SAMPLED) {
        return whole_request(bytes);
    }
    let Some((field, settings)) = parsed(bytes) else { return };
    if let Err(error) = Session::new().set_field(&field) {
        assert!(!error.to_string().is_empty(), "{field:?}");
    }
    if let Err(error) = settings.validate() {
        assert!(!error.to_string().is_empty(), "{settings:?}");
    }
}

/// A request and its run, which ends within a bounded number of evaluations with finite particles.
/// What is proven is whole, and the particles depend neither on the size of the steps nor on what
/// the session did before.
pub fn whole_request(bytes: &[u8]) {
    let Some((field, settings)) = parsed(bytes) else { return };
    // Small runs, so that there are many.
    let mut settings = settings;
    settings.max_particles = settings.max_particles.min(500);
    settings.relax_steps = settings.relax_steps.min(3);
    settings.radius_share = settings.radius_share.max(0.02);
    settings.count = settings.count.min(500);
    let mut session = Session::new();
    let Some(outcome) = run(&mut session, &field, &settings, 20_000) else { return };
    if outcome.digest.is_multiple_of(8) {
        session.report();
        let again = run(&mut session, &field, &settings, 977).map(|outcome| outcome.digest);
        assert_eq!(Some(outcome.digest), again, "{field:?} {settings:?}");
    }
}

/// What is known of a run without its report.
pub struct Outcome {
    pub digest: u64,
    pub search: Search,
}

/// Runs a request, in steps of `budget` units, and checks its particles; nothing if it is refused.
pub fn run(
    session: &mut Session,
    request: &FieldRequest,
    settings: &Settings,
    budget: u32,
) -> Option<Outcome> {
    /// Evaluations that no run of so few particles needs.
    const MOST: u64 = 20_000_000;
    let context = || format!("{request:?} {settings:?}");
    if let Err(error) = session.set_field(request) {
        assert!(!error.to_string().is_empty(), "{}", context());
        return None;
    }
    while session.fit(&|_| *settings, false, budget).is_none() {}
    if let Err(error) = session.start(settings) {
        assert!(!error.to_string().is_empty(), "{}", context());
        return None;
    }
    let evaluations = loop {
        let progress = session.run.step(budget);
        if progress.stop_reason.is_some() {
            break progress.evaluations;
        }
    };
    assert!(evaluations < MOST, "{}: {evaluations} evaluations", context());
    for (p, n) in session.run.particles().local.iter().zip(&session.run.particles().normal) {
        assert!(p.is_finite() && (n.length() - 1.0).abs() < 1e-4, "{}: {p} {n}", context());
    }
    let (search, sampled) = (session.run.sampler().search(), session.run.sampler().sampled());
    let is_whole = search != Search::Proven || sampled.missing == Some(sampled.without.len());
    assert!(is_whole, "{}: {sampled:?}", context());
    Some(Outcome { digest: session.run.particles().digest(), search })
}

/// The file of a mesh: it is read and mended, or refused in words, and a mended mesh is one.
pub fn mesh(bytes: &[u8]) {
    let mesh = TriangleMesh::read("a", bytes.to_vec());
    // Counts in a short file can make a large mesh.
    if mesh.as_ref().is_ok_and(|mesh| mesh.faces().len() > 2_000) {
        return;
    }
    let solid = match mesh.and_then(|mesh| mesh.solid()) {
        Ok(solid) => solid,
        Err(error) => {
            let message = error.to_string();
            assert!(!message.is_empty() && !message.chars().any(char::is_control), "{error:?}");
            return;
        }
    };
    let (mesh, count) = (solid.mesh(), solid.mesh().vertices().len());
    assert!(mesh.vertices().iter().all(|p| p.is_finite()) && mesh.area() > 0.0, "{mesh:?}");
    let is_face = |&[a, b, c]: &[u32; 3]| a != b && b != c && c != a && (a.max(b).max(c) as usize) < count;
    assert!(mesh.faces().iter().all(is_face), "{mesh:?}");
    assert!(solid.border_loops() <= solid.border_edges(), "{mesh:?}");
    assert_eq!(solid.is_closed(), solid.border_edges() == 0 && solid.fan_edges() == 0);
}

/// A file of an image: it is refused with a message, or it is an image whose voxels are finite,
/// with a surface between its darkest and its brightest voxel whose field has finite values there.
pub fn image(bytes: &[u8]) {
    /// Parts a header from the file beside it.
    const BESIDE: &[u8] = b"\n~beside~\n";
    let explained = |message: String| {
        assert!(!message.is_empty() && !message.chars().any(char::is_control), "{message:?}");
    };
    let mut random = Random::of(bytes);
    // The same bytes without a header.
    let raw = RawVoxels {
        size: core::array::from_fn(|_| random.between(0.0, 6.0) as usize),
        voxel_type: VoxelType::ALL[random.between(0.0, 9.99) as usize],
        is_big_endian: random.between(0.0, 1.0) < 0.5,
        skip: random.between(0.0, 20.0) as u64,
    };
    if let Err(error) = Image::read_raw(bytes.to_vec(), &raw) {
        explained(error.to_string());
    }
    let parted = bytes.windows(BESIDE.len()).position(|window| window == BESIDE);
    let (header, data) = match parted {
        Some(at) => (&bytes[..at], Some(&bytes[at + BESIDE.len()..])),
        None => (bytes, None),
    };
    let beside = |name: &str| data.map(<[u8]>::to_vec).ok_or_else(|| format!("{name} is not there"));
    let image = match Image::read("scan.hdr", header.to_vec(), beside) {
        Ok(image) => image,
        Err(error) => return explained(error.to_string()),
    };
    if let Some(outline) = Image::outline("scan.hdr", header).expect("what is read has an outline") {
        assert_eq!((outline.size, outline.voxel_type), (image.size(), image.voxel_type()));
    }
    let [min, max] = image.range();
    assert!(min.is_finite() && max.is_finite() && min < max, "{image:?}");
    let voxels: usize = image.size().iter().product();
    assert!(voxels <= image.bytes() && image.size().iter().all(|&n| n >= 2), "{image:?}");
    // Thousands of files are tried.
    if voxels > 20_000 {
        return;
    }
    let mut chosen = |share: f64| random.between(0.0, 1.0) < share;
    let choice = ImageChoice {
        iso: None,
        label: if chosen(0.3) { image.labels().first().map(|label| label.value) } else { None },
        smooth: if chosen(0.5) { Some(0.8) } else { None },
        is_dark_inside: chosen(0.3),
        is_closed: chosen(0.3),
    };
    let field = match image.surface(&choice, None) {
        Ok(surface) => surface.field().clone(),
        Err(error) => return explained(error.to_string()),
    };
    for _ in 0..4 {
        let index = DVec3::from_array(image.size().map(|n| random.between(0.0, (n - 1) as f64)));
        let p = image.placement().point(index);
        let back = image.placement().index(p) - index;
        if p.is_finite() && back.abs().max_element() < 1e-6 {
            assert!(!field.value(p).is_nan(), "{image:?} at {index}");
        }
    }
}
