//! Figs 7 and 8: how adaptive children are placed, drawn from the events of the run in the tangent
//! plane.

use glam::{DVec2, DVec3};
use marching_particles::internal::lesson::{Event, Vector};
use marching_particles::internal::paper::Particle;
use std::fmt::Write as _;

/// Side of a panel, and of its caption.
const PANEL: f64 = 150.0;
const CAPTION: f64 = 34.0;

/// Room to the left and right of all panels.
const MARGIN: f64 = 8.0;

/// Panels in a row.
const COLUMNS: usize = 4;

/// What a panel shows lies within so many radii of the parent.
const SEEN: f64 = 3.2;

const STYLE: &str = "text{font:11px system-ui,sans-serif;fill:#333}circle{stroke-width:1.2;fill:none;stroke:#555}\
.parent{fill:#555;fill-opacity:.25}.father{stroke:#2a8a3e;fill:#2a8a3e;fill-opacity:.3}.known{stroke:#c0392b;fill:#c0392b;fill-opacity:.25}\
.child{stroke:#2563b0;fill:#2563b0;fill-opacity:.3}.now{stroke:#c46a00;fill:#f29b38;fill-opacity:.45}\
.no{stroke:#7d4fb0;stroke-dasharray:3 2}.on{stroke-dasharray:2 3}path,line{fill:none;stroke:#777;stroke-width:1}.way{stroke:#c46a00;stroke-width:1.6}\
.angle{stroke:#c46a00;stroke-width:3}.free{stroke:#2a8a3e;stroke-width:3}.dot{fill:#222;stroke:none}\
@media(prefers-color-scheme:dark){text{fill:#ccc}circle{stroke:#aaa}path,line{stroke:#888}.dot{fill:#eee}}";

/// One attempt to place a child.
#[derive(Clone, Debug, Default)]
pub(crate) struct Attempt {
    /// The point I of Fig. 7c.
    tangent: Option<Vector>,
    /// Places and radii: the start, after pushes from the parent, after pushes along the circle.
    start: (Vector, f64),
    pushed: Vec<(Vector, f64)>,
    turned: Vec<(Vector, f64)>,
    /// φ, τ and whether there is room.
    room: Option<(f64, f64, bool)>,
}

impl Attempt {
    fn last(&self) -> (Vector, f64) {
        *self.turned.last().or(self.pushed.last()).unwrap_or(&self.start)
    }

    fn fits(&self) -> bool {
        self.room.is_some_and(|(.., fits)| fits)
    }
}

/// All that was done around one particle.
pub(crate) struct Treated {
    particle: Particle,
    u: DVec3,
    w: DVec3,
    neighbours: Vec<Particle>,
    father: Option<Particle>,
    pub(crate) attempts: Vec<Attempt>,
}

impl Treated {
    /// Reads what was done around each particle from the events of a run without relaxation, whose
    /// particles at the end are given.
    pub(crate) fn all(events: &[Event], particles: &[Particle]) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        for event in events {
            match event {
                Event::Taken { particle } => {
                    let own = particles[*particle as usize];
                    all.push(Self {
                        particle: own,
                        u: DVec3::X,
                        w: DVec3::Y,
                        neighbours: Vec::new(),
                        father: own.parent.map(|parent| particles[parent as usize]),
                        attempts: Vec::new(),
                    });
                }
                _ => {
                    if let Some(treated) = all.last_mut() {
                        treated.note(event, particles);
                    }
                }
            }
        }
        all
    }

    fn note(&mut self, event: &Event, particles: &[Particle]) {
        match event {
            Event::Gathered { neighbours, .. } => {
                self.neighbours = neighbours.iter().map(|near| particles[near.particle as usize]).collect();
            }
            Event::Frame { u, w, .. } => (self.u, self.w) = ((*u).into(), (*w).into()),
            Event::Start { tangent, position, radius, .. } => {
                let (tangent, start) = (*tangent, (*position, *radius));
                self.attempts.push(Attempt { tangent, start, ..Attempt::default() });
            }
            _ => {}
        }
        let Some(attempt) = self.attempts.last_mut() else { return };
        match *event {
            Event::Push { position, radius, .. } => attempt.pushed.push((position, radius)),
            Event::PushOnCircle { position, radius, .. } => attempt.turned.push((position, radius)),
            Event::Room { phi_rad, tau_rad, fits, .. } => attempt.room = Some((phi_rad, tau_rad, fits)),
            _ => {}
        }
    }

    /// Whether the particle shows all that Fig. 8 shows: children with room and without, and
    /// neighbours that were there.
    pub(crate) fn is_telling(&self) -> bool {
        let with_room = self.attempts.iter().filter(|attempt| attempt.fits()).count();
        with_room >= 1
            && self.attempts.len() - with_room >= 1
            && self.attempts.len() <= 5
            && self.near().count() >= 2
    }

    /// The neighbours that can be seen.
    fn near(&self) -> impl Iterator<Item = &Particle> {
        let p = self.particle.p();
        let reach = 2.9 * self.particle.radius;
        self.neighbours.iter().filter(move |other| {
            other.p().distance(p) < reach
                && Some(**other) != self.father
                && other.n().dot(self.particle.n()) > 0.0
        })
    }

    /// A place in the tangent plane at its true distance, in units of the panel.
    fn flat(&self, place: Vector) -> DVec2 {
        let offset = DVec3::from(place) - self.particle.p();
        let flat = DVec2::new(offset.dot(self.u), -offset.dot(self.w));
        flat.normalize_or_zero() * offset.length() * self.scale()
    }

    fn scale(&self) -> f64 {
        0.5 * PANEL / (SEEN * self.particle.radius)
    }
}

/// A drawing of panels.
struct Panels<'a> {
    of: &'a Treated,
    body: String,
    count: usize,
}

impl Panels<'_> {
    /// Begins a panel with the parent and its circle.
    fn begin(&mut self, caption: &str) {
        if self.count > 0 {
            self.body += "</g>";
        }
        let (column, row) = (self.count % COLUMNS, self.count / COLUMNS);
        let (x, y) = ((column as f64 + 0.5) * PANEL, row as f64 * (PANEL + CAPTION) + 0.5 * PANEL);
        let letter = char::from(b'a' + self.count as u8);
        let _ = write!(
            self.body,
            "<g transform=\"translate({x:.1} {y:.1})\"><text x=\"{:.1}\" y=\"{:.1}\">({letter}) {caption}</text>",
            6.0 - 0.5 * PANEL,
            0.5 * PANEL + 16.0
        );
        self.count += 1;
        let of = self.of;
        self.disc("parent", (of.particle.position, of.particle.radius));
        self.disc("on", (of.particle.position, of.particle.radius));
    }

    fn disc(&mut self, class: &str, (place, radius): (Vector, f64)) {
        let p = self.of.flat(place);
        let r = radius * self.of.scale();
        let _ =
            write!(self.body, "<circle class=\"{class}\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"{r:.1}\"/>", p.x, p.y);
    }

    /// The way that a child has gone, push by push.
    fn way(&mut self, places: impl Iterator<Item = Vector>) {
        let points: Vec<String> = places
            .map(|place| {
                let p = self.of.flat(place);
                format!("{:.1} {:.1}", p.x, p.y)
            })
            .collect();
        let _ = write!(self.body, "<path class=\"way\" d=\"M{}\"/>", points.join("L"));
    }

    /// A line from the parent through a place.
    fn ray(&mut self, place: Vector) {
        let p = self.of.flat(place);
        let _ = write!(self.body, "<line x2=\"{:.1}\" y2=\"{:.1}\"/>", p.x, p.y);
        let _ = write!(self.body, "<circle class=\"dot\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"2.4\"/>", p.x, p.y);
    }

    /// An angle on the circle around the parent, about the direction of a place.
    fn angle(&mut self, class: &str, place: Vector, angle_rad: f64, share: f64) {
        let r = share * self.of.particle.radius * self.of.scale();
        let p = self.of.flat(place);
        let middle = p.to_angle();
        let (a, b) = (middle - 0.5 * angle_rad, middle + 0.5 * angle_rad);
        let at = |angle: f64| DVec2::from_angle(angle) * r;
        let (from, to) = (at(a), at(b));
        let large = u8::from(angle_rad > core::f64::consts::PI);
        let _ = write!(
            self.body,
            "<path class=\"{class}\" d=\"M{:.1} {:.1}A{r:.1} {r:.1} 0 {large} 1 {:.1} {:.1}\"/>",
            from.x, from.y, to.x, to.y
        );
    }

    fn end(mut self, title: &str) -> String {
        self.body += "</g>";
        let rows = self.count.div_ceil(COLUMNS);
        let (width, height) = (COLUMNS as f64 * PANEL + 2.0 * MARGIN, rows as f64 * (PANEL + CAPTION));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"-{MARGIN} 0 {width} {height}\" role=\"img\"><title>{title}</title>\
             <style>{STYLE}</style>{}</svg>\n",
            self.body
        )
    }
}

/// Fig. 7: the first two children of a seed.
pub(crate) fn first_two(seed: &Treated) -> String {
    let [first, second] = [&seed.attempts[0], &seed.attempts[1]];
    let mut panels = Panels { of: seed, body: String::new(), count: 0 };
    panels.begin("P⁰ starts on C");
    panels.disc("now", first.start);
    panels.begin("it is pushed away");
    panels.disc("no", first.start);
    panels.disc("now", first.last());
    panels.way([first.start.0, first.last().0].into_iter());
    panels.begin("I, and S on C");
    panels.disc("child", first.last());
    if let Some(tangent) = second.tangent {
        panels.ray(tangent);
    }
    panels.ray(second.start.0);
    panels.begin("P¹ starts at S");
    panels.disc("child", first.last());
    panels.disc("now", second.start);
    panels.begin("it is pushed away");
    let pushed = *second.pushed.last().unwrap_or(&second.start);
    panels.disc("child", first.last());
    panels.disc("no", second.start);
    panels.disc("now", pushed);
    panels.way(core::iter::once(second.start.0).chain(second.pushed.iter().map(|(place, _)| *place)));
    panels.begin("along C, off P⁰");
    panels.disc("child", first.last());
    panels.disc("no", pushed);
    panels.disc("now", second.last());
    panels.way(core::iter::once(pushed.0).chain(second.turned.iter().map(|(place, _)| *place)));
    let (phi, tau, fits) = second.room.unwrap_or_default();
    let words = format!("φ {:.0}°, τ {:.0}°: {}", phi.to_degrees(), tau.to_degrees(), verdict(fits));
    panels.begin(&words);
    panels.disc("child", first.last());
    panels.disc("now", second.last());
    panels.angle("angle", second.last().0, phi, 1.12);
    panels.end("The first two children of a seed, event by event")
}

fn verdict(fits: bool) -> &'static str {
    if fits { "added" } else { "no room" }
}

/// Fig. 8: the children of a particle among neighbours.
pub(crate) fn among_neighbours(treated: &Treated) -> String {
    let mut panels = Panels { of: treated, body: String::new(), count: 0 };
    let draw_known = |panels: &mut Panels| {
        let known: Vec<Particle> = treated.near().copied().collect();
        for other in known {
            panels.disc("known", (other.position, other.radius));
        }
        if let Some(father) = treated.father {
            panels.disc("father", (father.position, father.radius));
        }
    };
    panels.begin("neighbours, father");
    draw_known(&mut panels);
    for (k, attempt) in treated.attempts.iter().enumerate() {
        let (phi, tau, fits) = attempt.room.unwrap_or_default();
        panels.begin(&format!("φ {:.0}°, τ {:.0}°: {}", phi.to_degrees(), tau.to_degrees(), verdict(fits)));
        draw_known(&mut panels);
        for before in treated.attempts[..k].iter().filter(|before| before.fits()) {
            panels.disc("child", before.last());
        }
        panels.disc("now", attempt.last());
        let way = attempt.pushed.iter().chain(&attempt.turned).map(|(place, _)| *place);
        panels.way(core::iter::once(attempt.start.0).chain(way));
        panels.angle("angle", attempt.last().0, phi, 1.12);
    }
    panels.begin("the result");
    draw_known(&mut panels);
    for attempt in &treated.attempts {
        panels.disc(if attempt.fits() { "child" } else { "no" }, attempt.last());
    }
    panels.end("The children of a particle among neighbours, event by event")
}
