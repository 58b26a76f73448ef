//! The three methods, from top to bottom: a front with its relaxation or refinement, more steps of
//! the relaxation, and particles that follow a moving surface. Each method of the [`Sampler`] named
//! here is one step; [`Desk`] says how steps are done in slices.

use super::Sampler;
use super::desk::{Desk, Stopped};
use super::phase::StopReason;
use super::refine::{Components, Refinement, Refusal};
use super::relaxation::{Grading, Sweep};

/// What follows after a front has covered the surface.
pub(super) enum Verdict {
    /// Another front, with other radii.
    Again,
    /// The relaxation.
    Relax,
    /// The refinement of the front, which is a coarse one.
    Refine(Components),
    /// The front is final, and the run ends for this reason.
    Stands(StopReason),
}

/// The paper's method (§4 and §5), or the refined one: fronts cover the surface, until their number
/// of particles is the wanted one, and are relaxed or refined.
pub(super) async fn sample(desk: Desk) -> StopReason {
    ended(&desk, place(&desk).await).await
}

async fn place(desk: &Desk) -> Result<StopReason, Stopped> {
    let reason = loop {
        desk.leaving(cover(desk), Sampler::leave_front).await?;
        match desk.with_field(Sampler::judge_front).await? {
            Verdict::Again => {}
            Verdict::Refine(mut components) => {
                let refined = refine(desk, &mut components);
                let refusal = desk.leaving(refined, Sampler::leave_refinement).await?;
                if desk.now(move |sampler| sampler.judge_refinement(components, refusal)).await? {
                    break StopReason::Complete;
                }
            }
            Verdict::Relax => {
                desk.now(Sampler::begin_relaxation).await?;
                desk.turn().await?;
                relax(desk).await?;
                break desk.now(|sampler| sampler.reason_for_end()).await?;
            }
            Verdict::Stands(reason) => break reason,
        }
    };
    audit(desk).await?;
    Ok(reason)
}

/// Covers the surface with particles: from its creases and tips, from seeds of the survey, from
/// witnesses of components that the survey has missed, and in the gaps that are left.
async fn cover(desk: &Desk) -> Result<(), Stopped> {
    let is_known = desk.now(Sampler::begin_attempt).await?;
    if is_known {
        // Over a component covered by an earlier front, one seed is enough.
        if desk.until(|sampler, probe, _| Some(sampler.begin_at_known(probe))).await? {
            grow(desk, true).await?;
        }
    } else {
        if desk.until(|sampler, probe, _| Some(sampler.begin_at_creases(probe))).await? {
            grow(desk, false).await?;
        }
        while desk.until(Sampler::find_seed).await? {
            grow(desk, false).await?;
        }
        if desk.now(Sampler::begin_search).await? {
            desk.turn().await?;
        }
        while desk.until(Sampler::find_witness).await? {
            grow(desk, true).await?;
        }
    }
    while desk.now(Sampler::begin_filling).await? {
        desk.until(Sampler::fill).await?;
        grow_levels(desk).await?;
    }
    Ok(())
}

/// Grows a front from a seed, which `is_witness` where the search has found it.
async fn grow(desk: &Desk, is_witness: bool) -> Result<(), Stopped> {
    grow_levels(desk).await?;
    desk.with_field(move |sampler, probe| sampler.end_front(probe, is_witness)).await
}

/// Lets a front grow level by level, until it has met itself, another one or the box everywhere
/// (paper §4.2 to §4.4): parents predict children, these are projected onto the surface, and those
/// that find room are the parents of the next level.
async fn grow_levels(desk: &Desk) -> Result<(), Stopped> {
    while !desk.now(|sampler| sampler.has_closed()).await? {
        desk.until(Sampler::place_children).await?;
        desk.until(Sampler::project_children).await?;
        desk.until(Sampler::settle_children).await?;
    }
    Ok(())
}

/// Why the work on a mesh ends early.
enum Halt {
    Stopped,
    Refused(Refusal),
}

impl From<Stopped> for Halt {
    fn from(_: Stopped) -> Self {
        Self::Stopped
    }
}

impl From<Refusal> for Halt {
    fn from(refusal: Refusal) -> Self {
        Self::Refused(refusal)
    }
}

/// Why a mesh was given up, if it was, once the work on it has ended.
fn refusal(result: Result<(), Halt>) -> Result<Option<Refusal>, Stopped> {
    match result {
        Ok(()) => Ok(None),
        Err(Halt::Refused(refusal)) => Ok(Some(refusal)),
        Err(Halt::Stopped) => Err(Stopped),
    }
}

/// Refines the components of a coarse front: orders its few particles, and keeps that order while
/// each level multiplies their number by four. Each level is checked against f itself, since
/// patches are refined by their own functions. Returns the reason if the front is refused.
async fn refine(desk: &Desk, components: &mut Components) -> Result<Option<Refusal>, Stopped> {
    refusal(make_levels(desk, components).await)
}

async fn make_levels(desk: &Desk, components: &mut Components) -> Result<(), Halt> {
    let levels = components.most_halvings() + 1;
    for to_come in (0..levels).rev() {
        for (k, share) in components.at_level(to_come) {
            desk.now(move |sampler| sampler.begin_level(levels, to_come, share)).await?;
            let mesh = components.refinement(k);
            if mesh.to_come() > to_come {
                divide(desk, mesh).await?;
            }
            make_passes(desk, mesh).await?;
            let mut rings = mesh.begin_order();
            let ordered =
                desk.until_on(mesh, move |_, mesh, _, left| mesh.put_in_order(&mut rings, left)).await?;
            components.end_level(k, ordered);
        }
        let mut inspected = None;
        desk.until_on(components, move |sampler, components, probe, left| {
            if inspected.is_none() {
                sampler.show_level(components, to_come, left);
            }
            sampler.inspect_level(inspected.get_or_insert(0), probe, left)
        })
        .await??;
    }
    Ok(())
}

/// Divides every face into four, and projects the particles of the finer mesh onto the surface.
async fn divide(desk: &Desk, mesh: &mut Refinement) -> Result<(), Halt> {
    let mut division = mesh.begin_division();
    let mut coarse = desk.until_on(mesh, move |_, mesh, _, left| mesh.divide(&mut division, left)).await?;
    desk.until_on(mesh, move |sampler, mesh, probe, left| sampler.land(mesh, &mut coarse, probe, left))
        .await??;
    Ok(())
}

/// Makes the passes of a level, or of a frame of a mesh that follows a surface, by its recipe.
async fn make_passes(desk: &Desk, mesh: &mut Refinement) -> Result<(), Halt> {
    while let Some(mut rest) = mesh.begin_pass() {
        desk.until_on(mesh, move |sampler, mesh, probe, left| {
            sampler.make_pass(mesh, &mut rest, probe, left)
        })
        .await??;
    }
    Ok(())
}

/// More steps of a relaxation that has begun, on the particles of a finished run.
pub(super) async fn relax_further(desk: Desk) -> StopReason {
    let reason = async {
        relax(&desk).await?;
        audit(&desk).await?;
        desk.now(|sampler| sampler.reason_for_end()).await
    };
    let reason = reason.await;
    ended(&desk, reason).await
}

/// The relaxation (§4.5 and the end of §5).
async fn relax(desk: &Desk) -> Result<(), Stopped> {
    desk.leaving(make_steps(desk), Sampler::leave_step).await
}

/// A step is kept only if it lowers the energy. At the end all particles are projected onto the
/// surface as closely as single precision allows, and radii that vary are graded once more.
async fn make_steps(desk: &Desk) -> Result<(), Stopped> {
    if !desk.now(|sampler| sampler.relaxation().is_only_graded()).await? {
        sum_forces(desk, Grading::WhereUneven).await?;
        desk.now(|sampler| sampler.relaxation().record_first()).await?;
        while !desk.now(|sampler| sampler.relaxation().is_even()).await? {
            sweep(desk, Sweep::Move).await?;
            sum_forces(desk, Grading::WhereUneven).await?;
            if desk.now(|sampler| sampler.relaxation().judge()).await? {
                desk.turn().await?;
            } else {
                sweep(desk, Sweep::TakeBack).await?;
                sum_forces(desk, Grading::WhereUneven).await?;
            }
        }
        sweep(desk, Sweep::Polish).await?;
        if !desk.now(|sampler| sampler.relaxation().distrust_lists()).await? {
            return Ok(());
        }
    }
    list_neighbours(desk, Grading::Always).await
}

/// The forces on all particles and their energy, from complete lists of neighbours.
async fn sum_forces(desk: &Desk, grading: Grading) -> Result<(), Stopped> {
    list_neighbours(desk, grading).await?;
    sweep(desk, Sweep::SumForces).await
}

/// Lists the neighbours of particles whose lists are stale, and lowers radii that are too large
/// compared with a neighbour's.
async fn list_neighbours(desk: &Desk, grading: Grading) -> Result<(), Stopped> {
    let (wants_lists, wants_grid) = desk.now(|sampler| sampler.relaxation().wants_lists()).await?;
    if wants_grid {
        sweep(desk, Sweep::FillGrid).await?;
    }
    if wants_lists {
        sweep(desk, Sweep::RenewLists).await?;
    }
    if desk.now(move |sampler| sampler.relaxation().wants_grading(grading)).await? {
        sweep(desk, Sweep::Grade).await?;
        while desk.now(|sampler| sampler.relaxation().has_lowered()).await? {
            sweep(desk, Sweep::Grade).await?;
        }
    }
    Ok(())
}

async fn sweep(desk: &Desk, sweep: Sweep) -> Result<(), Stopped> {
    desk.until(move |sampler, probe, left| sampler.sweep(sweep, probe, left)).await
}

/// Finds out which components hold particles.
async fn audit(desk: &Desk) -> Result<(), Stopped> {
    desk.now(Sampler::begin_audit).await?;
    desk.until(Sampler::audit).await
}

/// Marks the particles next to singular points, even if the run was stopped.
async fn ended(desk: &Desk, reason: Result<StopReason, Stopped>) -> StopReason {
    desk.finally(Sampler::mark).await;
    reason.unwrap_or(StopReason::Cancelled)
}

/// A frame of particles that follow a moving surface: with the mesh of a refined run, as long as
/// the mesh can follow.
pub(super) async fn follow(desk: Desk) -> StopReason {
    follow_surface(&desk).await.unwrap_or(StopReason::Cancelled)
}

async fn follow_surface(desk: &Desk) -> Result<StopReason, Stopped> {
    if let Some(mut mesh) = desk.now(Sampler::begin_mesh).await? {
        let refusal = refusal(make_passes(desk, &mut mesh.refinement).await)?;
        if desk.now(move |sampler| sampler.judge_mesh(mesh, refusal)).await? {
            return Ok(StopReason::Complete);
        }
    }
    loop {
        desk.now(Sampler::begin_transport).await?;
        sweep(desk, Sweep::Transport).await?;
        let steps = desk.with_field(Sampler::settle).await?;
        for _ in 0..steps {
            desk.now(|sampler| sampler.relaxation().distrust_grid()).await?;
            sum_forces(desk, Grading::Always).await?;
            sweep(desk, Sweep::Move).await?;
        }
        if desk.now(|sampler| sampler.particles().is_empty()).await? {
            return Ok(StopReason::NoSurface);
        }
        if !desk.with_field(Sampler::end_frame).await? {
            return Ok(StopReason::Complete);
        }
    }
}
