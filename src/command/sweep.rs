//! Subcommand `sweep`: moves a surface and writes the particles that follow it to numbered files.

use crate::arguments::{Sweep, SweepArguments};
use crate::bar::bar;
use crate::failure::{Failure, LIMIT};
use crate::output::OutputFile;
use crate::surface::{choose, fit, read_text};
use marching_particles::internal::session::{FieldRequest, Session};
use marching_particles::quality::Measurements;
use marching_particles::sampler::FollowError;
use marching_particles::{Bounds, Particles, StopReason, export};
use std::io::Write;
use std::process::ExitCode;

/// Number of parameter values, spread over the range, for which a box is fitted. In between, a size
/// that grows and shrinks as a parabola is larger by at most (1/8)² of the growth, 1.6 %; a fitted
/// box has a margin of 5 % on every side.
const FITTED: u32 = 9;

pub(crate) fn run(mut arguments: SweepArguments) -> Result<ExitCode, Failure> {
    read_text(&mut arguments.surface)?;
    let (sweep, frames) = (arguments.sweep.clone(), arguments.frames);
    let (extension, format) = arguments.format;
    let in_directory = |error| Failure::File { path: arguments.out.clone(), error };
    std::fs::create_dir_all(&arguments.out).map_err(in_directory)?;
    arguments.sampling.check(false)?;
    let settings_in = |bounds: &Bounds| arguments.sampling.settings(bounds);
    if arguments.surface.mesh.mesh_in.is_some() {
        let message = "--mesh-in has no parameter that could move its surface: sweep a formula";
        return Err(Failure::Usage(message.to_owned()));
    }
    if arguments.surface.image.is_some() {
        let message = "--image has no parameter that could move its surface: sweep a formula";
        return Err(Failure::Usage(message.to_owned()));
    }
    let mut session = Session::without_surface();
    // The swept parameter must exist.
    arguments.surface.parameters.retain(|(name, _)| *name != sweep.name);
    arguments.surface.parameters.push((sweep.name.clone(), sweep.from));
    choose(&mut session, &arguments.surface, arguments.quiet)?;
    for k in 0..FITTED {
        set_at(&mut session, &sweep, f64::from(k) / f64::from(FITTED - 1), None)?;
        fit(&mut session, &settings_in, k > 0)?;
        if session.answer().reach.is_none() {
            // The box is given, or belongs to the surface.
            break;
        }
    }
    // A solid's box is fitted again in every frame.
    let bounds = Some(session.run.bounds()).filter(|_| !arguments.surface.closed);
    let bar = bar(arguments.quiet);
    bar.set_length(u64::from(frames) + 1);
    let digits = frames.to_string().len();
    let mut counted = Counted { least: usize::MAX, ..Counted::default() };
    for frame in 0..=frames {
        set_at(&mut session, &sweep, f64::from(frame) / f64::from(frames), bounds)?;
        let settings = fit(&mut session, &settings_in, false)?;
        if let Err(error) = session.follow(&settings, false) {
            session.start(&settings)?;
            counted.begin_anew(frame, error);
        }
        let run = &mut session.run;
        let stop_reason = loop {
            if let Some(reason) = run.step(u32::MAX).stop_reason {
                break reason;
            }
        };
        let mut particles = run.particles().clone();
        counted.number(&mut particles);
        let path = arguments.out.join(format!("{frame:0digits$}.{extension}"));
        for output in OutputFile::beside(&[&path])? {
            output.write(|out| export::write(&format.into(), &particles, &Measurements::default(), out))?;
        }
        counted.note(run.count(), stop_reason);
        bar.set_position(u64::from(frame) + 1);
    }
    bar.finish_and_clear();
    let Counted { least, most, next, anew, empty, capped, .. } = counted;
    if most == 0 {
        return Err(Failure::Nothing("there is no surface in any frame".to_owned()));
    }
    let again = match anew.as_slice() {
        // This error's own message is for programs that use the library.
        [_, (frame, FollowError::NotCovered), ..] => {
            let why = "the frame before has too few particles, or was stopped";
            format!(", of {} runs; in frame {frame} the second begins: {why}", anew.len())
        }
        [_, (frame, error), ..] => {
            format!(", of {} runs; in frame {frame} the second begins: {error}", anew.len())
        }
        _ => String::new(),
    };
    if !arguments.quiet {
        let mut out = std::io::stdout().lock();
        let directory = arguments.out.display();
        writeln!(
            out,
            "{} files in {directory}: {least} to {most} particles, {next} in all{again}",
            frames + 1
        )?;
    }
    if empty > 0 {
        eprintln!("warning: there is no surface in {empty} of {} frames", frames + 1);
    }
    if capped > 0 {
        eprintln!(
            "warning: {capped} of {} frames stopped at the limit of particles: choose larger ones, or raise --max-particles",
            frames + 1
        );
        return Ok(ExitCode::from(LIMIT));
    }
    Ok(ExitCode::SUCCESS)
}

/// The numbers of particles, and of their identities, in the frames so far.
#[derive(Default)]
struct Counted {
    least: usize,
    most: usize,
    /// Number of identities before the current run.
    before: u32,
    /// The next unused identity.
    next: u32,
    /// The frames that were sampled anew, and why the particles before could not follow.
    anew: Vec<(u32, FollowError)>,
    /// Frames without particles.
    empty: u32,
    /// Frames that stopped at the limit of particles.
    capped: u32,
}

impl Counted {
    /// Records that another run begins, with particles that did not exist before.
    fn begin_anew(&mut self, frame: u32, error: FollowError) {
        self.before = self.next;
        self.anew.push((frame, error));
    }

    /// Numbers the particles of a frame so that identities are unique across all runs.
    fn number(&mut self, particles: &mut Particles) {
        particles.identity = particles.identities();
        for number in &mut particles.identity {
            *number += self.before;
            self.next = self.next.max(*number + 1);
        }
    }

    fn note(&mut self, count: usize, stop_reason: StopReason) {
        (self.least, self.most) = (self.least.min(count), self.most.max(count));
        self.empty += u32::from(count == 0);
        self.capped += u32::from(stop_reason == StopReason::Cap);
    }
}

/// Sets the session's surface to a share of the sweep.
fn set_at(session: &mut Session, sweep: &Sweep, share: f64, bounds: Option<Bounds>) -> Result<(), Failure> {
    let value = sweep.from + (sweep.to - sweep.from) * share;
    let parameters = [(sweep.name.clone(), value)].into();
    let request = FieldRequest { parameters, bounds, ..FieldRequest::default() };
    session.set_field(&request).map(drop).map_err(|fault| Failure::Usage(fault.message))
}
