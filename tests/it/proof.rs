//! A property of random surfaces whose components are known: where the search says `proven`, every
//! component holds particles or is named in the report, with its place and its size. Where it does
//! not say so, the report says why.

use crate::cases;
use crate::runs::session;
use glam::DVec3;
use marching_particles::Bounds;
use marching_particles::Warning;
use marching_particles::internal::session::Session;
use marching_particles::sampler::{Doubt, Method, Sampling, Search, Settings, Unsampled};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// A component, or a family of parallel ones of which it is one.
#[derive(Clone, Copy, Debug)]
enum Piece {
    Sphere {
        centre: DVec3,
        radius: f64,
    },
    /// Around the z-axis.
    Torus {
        centre: DVec3,
        major: f64,
        minor: f64,
    },
    /// z = height + depth sin(wave x): a plane if the depth is 0.
    Sheet {
        height: f64,
        depth: f64,
        wave: f64,
    },
    /// |x|⁴ + |y|⁴ + |z|⁴ = radius⁴ around a centre: flat at the ends of its axes, and its function is flat in its middle.
    Quartic {
        centre: DVec3,
        radius: f64,
    },
    /// Faces, edges and corners around a centre.
    Cube {
        centre: DVec3,
        axes: [DVec3; 3],
        half: f64,
    },
    /// What two balls that meet have together, or in common.
    Balls {
        centres: [DVec3; 2],
        radius: f64,
        is_union: bool,
    },
}

impl Piece {
    fn formula(&self) -> String {
        let about = |c: DVec3| format!("(x-({})), (y-({})), (z-({}))", c.x, c.y, c.z);
        let powers = |c: DVec3, n: u32| {
            let terms: Vec<String> = about(c).split(", ").map(|t| format!("{t}^{n}")).collect();
            terms.join("+")
        };
        match *self {
            Self::Sphere { centre, radius } => format!("({}-({radius})^2)", powers(centre, 2)),
            Self::Torus { centre: c, major, minor } => {
                let [x, y, z] = c.to_array().map(|c| format!("({c})"));
                format!("((sqrt((x-{x})^2+(y-{y})^2)-{major})^2+(z-{z})^2-({minor})^2)")
            }
            Self::Sheet { height, depth, wave } => format!("(z-({height})-{depth}*sin({wave}*x))"),
            Self::Quartic { centre, radius } => format!("({}-({radius})^4)", powers(centre, 4)),
            Self::Cube { centre: c, axes, half } => {
                let side = |n: DVec3| {
                    format!("abs(({})*(x-({}))+({})*(y-({}))+({})*(z-({})))", n.x, c.x, n.y, c.y, n.z, c.z)
                };
                format!("(max({})-{half})", axes.map(side).join(","))
            }
            Self::Balls { centres, radius, is_union } => {
                let [a, b] = centres.map(|centre| format!("{}-({radius})^2", powers(centre, 2)));
                format!("{}({a},{b})", if is_union { "min" } else { "max" })
            }
        }
    }

    /// Distance of a point from it, to first order.
    fn distance(&self, p: DVec3) -> f64 {
        match *self {
            Self::Sphere { centre, radius } => ((p - centre).length() - radius).abs(),
            Self::Torus { centre, major, minor } => {
                let q = p - centre;
                (libm::hypot(q.truncate().length() - major, q.z) - minor).abs()
            }
            Self::Sheet { height, depth, wave } => {
                let (rise, slope) = (depth * libm::sin(wave * p.x), depth * wave * libm::cos(wave * p.x));
                ((p.z - height - rise) / libm::hypot(1.0, slope)).abs()
            }
            Self::Quartic { centre, radius } => {
                let q = p - centre;
                let value = (q * q * q * q).element_sum() - radius.powi(4);
                (value / (4.0 * (q * q * q).length())).abs()
            }
            Self::Cube { centre, axes, half } => {
                let sides = axes.map(|axis| axis.dot(p - centre).abs() - half);
                sides.into_iter().fold(f64::NEG_INFINITY, f64::max).abs()
            }
            Self::Balls { centres, radius, is_union } => {
                let [a, b] = centres.map(|centre| (p - centre).length() - radius);
                if is_union { a.min(b).abs() } else { a.max(b).abs() }
            }
        }
    }

    /// How often it may be named. The search has a point near each highest point of a piece, and
    /// on a hollow edge, and does not always prove that the piece connects them.
    fn most_named(&self) -> usize {
        match self {
            Self::Balls { is_union: true, .. } => 3,
            _ => 1,
        }
    }

    /// Largest distance between two of its points; none if the box cuts it.
    fn width(&self) -> Option<f64> {
        match *self {
            Self::Sphere { radius, .. } => Some(2.0 * radius),
            _ => None,
        }
    }
}

/// Smallest gap above which sheets have to be told apart in a box of half-width 1, where two units
/// in the last place are 2⁻²²: 48 of these, and half as much again.
const RESOLVED: f64 = 2e-5;
/// Usual share of gaps below a thousandth of the radius.
const TINY_SHARE: f64 = 0.2;

struct Random {
    source: Pcg32,
    /// Share of gaps that are drawn from 10⁻⁷ on.
    tiny_share: f64,
    /// Smallest gap drawn.
    least_gap: f64,
}

impl Random {
    fn unit(&mut self) -> f64 {
        f64::from(self.source.next_u32()) / 4_294_967_296.0
    }

    fn between(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.unit()
    }

    /// A length whose logarithm is uniform.
    fn length(&mut self, lo: f64, hi: f64) -> f64 {
        lo * libm::pow(hi / lo, self.unit())
    }

    fn count(&mut self, lo: u32, hi: u32) -> u32 {
        lo + self.source.next_u32() % (hi - lo + 1)
    }

    fn direction(&mut self) -> DVec3 {
        loop {
            let p = DVec3::new(self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(-1.0, 1.0));
            if (0.01..1.0).contains(&p.length_squared()) {
                return p / p.length();
            }
        }
    }

    fn near_middle(&mut self, most: f64) -> DVec3 {
        self.direction() * self.between(0.0, most)
    }

    /// A gap between sheets, from a thousandth of the radius of a particle to ten of them, now and
    /// then from 10⁻⁷ on.
    fn gap(&mut self, r: f64) -> f64 {
        let gap = if self.unit() < self.tiny_share {
            self.length(1e-7, 1e-3 * r)
        } else {
            self.length(1e-3 * r, 10.0 * r)
        };
        self.least_gap = self.least_gap.min(gap);
        gap
    }
}

/// What was asked and what was answered.
struct Case {
    formula: String,
    pieces: Vec<Piece>,
    settings: Settings,
}

fn says(warnings: &[Warning], words: &str) -> bool {
    warnings.iter().any(|warning| warning.to_string().contains(words))
}

/// Says whether the search was proven; panics if it says so and a component is neither sampled nor
/// named.
fn holds(case: &Case, context: &str) -> bool {
    let Case { formula, pieces, settings } = case;
    let mut session = session(formula, Bounds::cube(1.0));
    session.start(settings).unwrap_or_else(|e| panic!("{formula}: {e}"));
    while session.run.step(100_000).stop_reason.is_none() {}
    let sampled = session.run.sampler().sampled();
    let doubts = session.run.sampler().doubts();
    if session.run.sampler().search() != Search::Proven {
        let warnings = session.report().warnings;
        let is_told = |doubt: &Doubt| match doubt {
            Doubt::Unresolved { .. } => says(&warnings, "too close for single precision"),
            Doubt::Cells { .. } => says(&warnings, "of the box open"),
            Doubt::Witnesses { .. } => {
                says(&warnings, "it is not proven that") || says(&warnings, "too close for single precision")
            }
            Doubt::Creases => says(&warnings, "component with an edge may be missing"),
            _ => false,
        };
        assert!(
            !doubts.is_empty() && doubts.iter().all(is_told),
            "{context}: {formula}: {doubts:?} {warnings:?}"
        );
        return false;
    }
    assert_eq!(doubts, [], "{context}: {formula}");
    let nearest = |p: DVec3| {
        let distances = pieces.iter().map(|piece| piece.distance(p)).enumerate();
        distances.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
    };
    let mut is_told = vec![false; pieces.len()];
    for p in &session.run.particles().local {
        nearest(p.as_dvec3()).iter().for_each(|&k| is_told[k] = true);
    }
    let mut names = vec![0; pieces.len()];
    for &Unsampled { position, reach, goes_on } in &sampled.without {
        let place = DVec3::from_array(position);
        let Some(k) = nearest(place) else { continue };
        is_told[k] = true;
        // What is larger than is followed may have witnesses too far from one another to be
        // connected.
        names[k] += usize::from(!goes_on);
        // Only what the box cuts, or what is larger than is followed, goes on.
        if let (false, Some(width)) = (goes_on, pieces[k].width()) {
            let is_right = (0.9 * width..=1.1 * width).contains(&reach);
            assert!(is_right, "{context}: {formula} at {place}: {reach} for {width}");
        }
        assert!(goes_on || sampled.above.is_none_or(|above| above >= reach), "{context}: {sampled:?}");
    }
    let is_right = |(piece, &n): (&Piece, &usize)| n <= piece.most_named();
    let are_right = pieces.iter().zip(&names).all(is_right);
    assert!(are_right, "{context}: {formula} names a piece too often: {sampled:?}");
    assert!(
        is_told.iter().all(|&told| told),
        "{context}: {formula}, {settings:?}: {is_told:?} of {pieces:?}"
    );
    true
}

/// Runs the cases of a family. At least this share of those without a gap below [`RESOLVED`] must
/// be proven. The search takes the factors of a formula one by one.
fn family(name: &str, share: f64, make: impl Fn(&mut Random, f64) -> Vec<Piece>) {
    family_of(name, share, (75, TINY_SHARE), |factors| factors.join("*"), make);
}

/// The same, of formulas made from their factors by `join`; of so many cases in all, with tiny gaps
/// for so large a share.
fn family_of(
    name: &str,
    share: f64,
    (all, tiny_share): (u64, f64),
    join: impl Fn(&[String]) -> String,
    make: impl Fn(&mut Random, f64) -> Vec<Piece>,
) {
    let (mut proven, mut resolved) = (0, 0);
    for seed in cases::seeds(all) {
        let mut random = Random { source: Pcg32::seed_from_u64(seed), tiny_share, least_gap: f64::INFINITY };
        let r = random.between(0.05, 0.09);
        let pieces = make(&mut random, r);
        let formula: Vec<String> = pieces.iter().map(Piece::formula).collect();
        let adaptive = random.unit() < 0.2;
        let settings = settings!(radius_share: r / 12.0_f64.sqrt(),
            relax_steps: random.count(0, 3),
            seed,
            sampling: if adaptive { Sampling::Adaptive } else { Sampling::Uniform },
            // Adaptive particles about as large as uniform ones: with the usual error all cases
            // take 2.6 times as long.
            chord_error: 1e-3; ..Settings::default());
        let case = Case { formula: join(&formula), pieces, settings };
        let is_proven = holds(&case, &format!("{name} {seed}"));
        if random.least_gap >= RESOLVED {
            resolved += 1;
            proven += u64::from(is_proven);
        }
    }
    cases::assert_share(proven, resolved, share, &format!("{name} without a tiny gap, proven"));
}

/// Spheres, each around the one before it.
fn nested(random: &mut Random, r: f64, count: impl Fn(&mut Random) -> u32) -> Vec<Piece> {
    let (centre, mut radius) = (random.near_middle(0.1), random.between(0.2, 0.5));
    let mut all = vec![Piece::Sphere { centre, radius }];
    for _ in 1..count(random) {
        radius += random.gap(r).min(0.1);
        all.push(Piece::Sphere { centre, radius });
    }
    all
}

#[test]
fn of_nested_spheres_none_is_missing_without_a_word() {
    family("nested spheres", 0.99, |random, r| nested(random, r, |random| random.count(2, 4)));
}

/// The function of one shell, or of two, by maxima and a minimum of those of their sheets.
#[test]
fn of_the_sheets_of_shells_none_is_missing_without_a_word() {
    let join = |sheets: &[String]| {
        let shells = sheets.chunks(2).map(|pair| format!("max({}, -{})", pair[1], pair[0]));
        shells.reduce(|all, shell| format!("min({all}, {shell})")).expect("a shell")
    };
    family_of("shells", 0.99, (50, TINY_SHARE), join, |random, r| {
        nested(random, r, |random| 2 * random.count(1, 2))
    });
}

#[test]
fn of_stacked_sheets_none_is_missing_without_a_word() {
    family("stacked sheets", 0.97, |random, r| {
        let is_plane = random.unit() < 0.5;
        let wave = random.length(3.0, 60.0);
        // The slope is at most a half.
        let depth = if is_plane { 0.0 } else { random.between(0.0, 0.5) / wave };
        let mut height = random.between(-0.6, 0.0);
        let mut all = vec![Piece::Sheet { height, depth, wave }];
        for _ in 1..random.count(2, 4) {
            height += random.gap(r).min(0.2);
            all.push(Piece::Sheet { height, depth, wave });
        }
        all
    });
}

#[test]
fn of_tiny_spheres_beside_a_large_one_none_is_missing_without_a_word() {
    family("tiny beside large", 0.98, |random, r| {
        let (centre, large) = (random.near_middle(0.1), random.between(0.3, 0.6));
        let mut all = vec![Piece::Sphere { centre, radius: large }];
        let mut placed: Vec<(DVec3, f64)> = Vec::new();
        for _ in 0..random.count(1, 4) {
            let (radius, gap) =
                (random.length(0.05 * r, 3.0 * r).min(0.2), random.length(1e-3 * r, 3.0 * r).min(0.1));
            let side = if random.unit() < 0.7 { 1.0 } else { -1.0 };
            let at = centre + random.direction() * (large + side * (radius + gap));
            let is_free =
                placed.iter().all(|&(other, size)| (other - at).length() > size + radius + 1e-3 * r);
            if is_free
                && (side > 0.0 || radius + gap < 0.5 * large)
                && (at.abs().max_element() + radius) < 1.0
            {
                placed.push((at, radius));
                all.push(Piece::Sphere { centre: at, radius });
            }
        }
        all
    });
}

fn scattered(random: &mut Random, r: f64) -> Vec<Piece> {
    let mut placed: Vec<(DVec3, f64)> = Vec::new();
    for _ in 0..random.count(3, 8) {
        let (at, radius) = (random.near_middle(0.7), random.length(0.3 * r, 5.0 * r).min(0.28));
        let near = placed.iter().map(|&(other, size)| (other - at).length() - size - radius);
        // Now and then it touches another one nearly.
        let gap = near.fold(f64::INFINITY, f64::min);
        if gap > 0.2 * r {
            let grown = radius + if random.unit() < 0.5 { (gap - 0.01 * r).min(0.1) } else { 0.0 };
            placed.push((at, if at.abs().max_element() + grown < 1.0 { grown } else { radius }));
        }
    }
    placed.into_iter().map(|(centre, radius)| Piece::Sphere { centre, radius }).collect()
}

#[test]
fn of_scattered_spheres_none_is_missing_without_a_word() {
    family("scattered spheres", 0.99, scattered);
}

/// All components are searched at once, in cells of very different values of f.
#[test]
fn of_scattered_spheres_of_one_factor_none_is_missing_without_a_word() {
    let join = |factors: &[String]| format!("atan({})", factors.join("*"));
    family_of("scattered spheres of one factor", 0.99, (50, 0.0), join, scattered);
}

#[test]
fn of_nested_tori_and_flat_minima_none_is_missing_without_a_word() {
    family("tori and flat minima", 0.99, |random, r| {
        let centre = random.near_middle(0.05);
        let (major, mut minor) = (random.between(0.5, 0.6), random.between(0.1, 0.2));
        let mut all = vec![Piece::Torus { centre, major, minor }];
        if random.unit() < 0.7 {
            minor += random.gap(r).min(0.1);
            all.push(Piece::Torus { centre, major, minor });
        }
        if random.unit() < 0.5 {
            // In the hole of the torus, whose radius is at least 0.2.
            all.push(Piece::Quartic { centre, radius: random.length(0.3 * r, 0.12) });
        }
        all
    });
}

/// Bodies with edges, from a tenth of a particle to many, and no two of them together.
#[test]
fn of_bodies_with_edges_none_is_missing_without_a_word() {
    let join = |bodies: &[String]| {
        bodies.iter().skip(1).fold(bodies[0].clone(), |all, body| format!("min({all}, {body})"))
    };
    family_of("bodies with edges", 0.97, (40, 0.0), join, |random, r| {
        let mut placed: Vec<(DVec3, f64)> = Vec::new();
        let mut all = Vec::new();
        for _ in 0..random.count(2, 6) {
            let (centre, reach) = (random.near_middle(0.7), random.length(0.1 * r, 6.0 * r).min(0.28));
            let is_free =
                placed.iter().all(|&(other, size)| (other - centre).length() > size + reach + 0.2 * r);
            if !is_free {
                continue;
            }
            placed.push((centre, reach));
            let axis = random.direction();
            let across = axis.any_orthonormal_vector();
            all.push(match random.count(0, 2) {
                0 => Piece::Cube {
                    centre,
                    axes: [axis, across, axis.cross(across)],
                    half: reach / 3.0_f64.sqrt(),
                },
                1 => {
                    let radius = random.between(0.55, 0.9) * reach;
                    let offset = axis * (reach - radius);
                    Piece::Balls { centres: [centre - offset, centre + offset], radius, is_union: true }
                }
                _ => {
                    // The rim is as far from the centre as the body reaches.
                    let offset = axis * (random.between(0.3, 1.0) * reach);
                    let radius = libm::hypot(reach, offset.length());
                    Piece::Balls { centres: [centre - offset, centre + offset], radius, is_union: false }
                }
            });
        }
        all
    });
}

#[test]
fn a_later_run_on_a_surface_begins_with_the_witnesses_of_the_first() {
    // One ball lies between the nodes of the survey.
    let two = ("min(norm(x,y,z) - 0.7, norm(x - 0.93, y - 0.93, z - 0.93) - 0.01) = 0", 1.0);
    let gyroid = ("sin(x) cos(y) + sin(y) cos(z) + sin(z) cos(x) = 0", 6.3);
    for (formula, half) in [two, gyroid] {
        let front = settings!(radius_share: 0.004, method: Method::Front; ..Settings::default());
        let other = settings!(method: Method::Refined, seed: 3; ..front);
        let run = |session: &mut Session, settings: &Settings| {
            session.start(settings).expect("valid settings");
            let mut steps = 0;
            while session.run.step(4_096).stop_reason.is_none() {
                steps += 1;
            }
            let report = session.report();
            (steps, format!("{} {:?} {}", report.digest, report.proof, report.growth.components_seeded))
        };
        let begun = || session(formula, Bounds::cube(half));
        let (mut session, mut fresh) = (begun(), begun());
        let (steps, found) = run(&mut session, &front);
        let later = run(&mut session, &other);
        assert_eq!(later.1, run(&mut fresh, &other).1, "{formula}: another method and seed");
        let (fewer, again) = run(&mut session, &front);
        assert_eq!(again, found, "{formula}: the same settings");
        assert!(fewer < steps, "{formula}: {fewer} steps after {steps}, without a search");
    }
}
