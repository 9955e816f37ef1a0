//! Scenes that end when all runs are at rest.

use super::Typed;
use crate::reading::words::{list, quoted, short};
use crate::scene::file::EndFile;
use crate::scene::{AtRest, Scene};
use crate::sim::{Crew, Load, Status};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// The kinetic energy of a body at rest, as a share of its greatest so far: a thousandth of the speed.
const STILL: f64 = 1e-6;
/// The forces that are left at rest, as a share of gravity and loads on a body, or of the greatest that were left without these.
const BALANCED: f64 = 1e-3;
/// Parts of the time between frames at whose ends the kinetic energy is looked at. Oscillations are not still at all of them.
const PARTS: [u64; 8] = [1, 2, 3, 5, 7, 11, 13, 16];

/// A body that goes a smaller part of its size in the time of a frame stands still to round-off.
const ROUND_OFF: f64 = 1e-9;

/// Why a run does not come to rest.
enum Restless {
    Moves,
    Diverges,
}

/// Ends the scene at the first frame at which all runs are at rest, if it asks for it: simulates them until then.
pub(super) fn end(typed: &Typed<'_>, scene: &mut Scene) {
    let asked = typed.file.time.as_ref().and_then(|time| time.until);
    let (Some(EndFile::Rest), 0) = (asked, typed.report.total()) else { return };
    let found: Vec<_> = (0..scene.runs.len()).into_par_iter().map(|run| rest(scene, run)).collect();
    if found.iter().all(Result::is_ok) {
        let last = found.iter().flatten().map(|rest| rest.frame).max().unwrap_or(0);
        scene.duration = scene.frame_time(last);
        scene.runs.iter_mut().zip(found).for_each(|(run, found)| run.comes_to_rest = found.ok());
        return;
    }
    let of = |diverges: bool| {
        let runs = scene.runs.iter().zip(&found);
        let names: Vec<_> = runs
            .filter(|(_, found)| found.as_ref().is_err_and(|why| matches!(why, Restless::Diverges) == diverges))
            .map(|(run, _)| &run.name)
            .collect();
        (!names.is_empty()).then(|| (list(&names, "and", quoted), names.len() == 1))
    };
    let here = typed.report.to("time").to("until");
    if let Some((names, is_one)) = of(true) {
        let message = format!("{names} diverge{} before rest", if is_one { "s" } else { "" });
        here.warn(message, "take shorter steps");
    }
    if let Some((names, is_one)) = of(false) {
        let (is, duration) = (if is_one { "is" } else { "are" }, short(scene.duration));
        let help = "make `duration` longer, or give more damping, such as `mass_damping = 2`";
        here.warn(format!("{names} {is} not at rest after {duration} s"), help);
    }
}

/// What is known of the motion of a body.
struct Swinging {
    nodes: Range<usize>,
    /// The kinetic energy (J) of a body that stands still to round-off.
    still: f64,
    /// The greatest kinetic energy (J), and the greatest forces that were left (N), so far.
    greatest: [f64; 2],
}

/// When a run comes to rest.
fn rest(scene: &Scene, number: usize) -> Result<AtRest, Restless> {
    let run = &scene.runs[number];
    if run.recording.is_some() {
        return Ok(AtRest { frame: 0, kinetic_energy: 0.0, residual: 0.0 });
    }
    // As long as something outside moves, rest does not last.
    let moving =
        scene.obstacles.iter().map(|obstacle| obstacle.motion.end()).chain(run.grips.iter().map(|grip| grip.end()));
    let changes = moving.chain(run.loads.iter().map(|load| load.course().end())).fold(0.0, f64::max);
    let mass = run.body().mass();
    let bodies = run.bodies.bodies().iter().enumerate().map(|(at, body)| {
        let speed = ROUND_OFF * body.extent() * scene.frames_per_second;
        let still = 0.5 * body.mass().iter().sum::<f64>() * speed * speed;
        Swinging { nodes: run.bodies.nodes(at), still, greatest: [0.0; 2] }
    });
    let mut bodies: Vec<_> = bodies.collect();
    let mut world = scene.world(number);
    world.set_crew(Crew::new(run.threads(scene.runs.len())));
    for frame in 1..=scene.last_frame() {
        let (from, to) = (world.steps(), world.steps_at(scene.moment(frame)));
        let (before, mut most) = (world.state().velocity.clone(), vec![0.0_f64; bodies.len()]);
        for part in PARTS {
            world.advance(from + (to - from) * part / 16 - world.steps());
            let energy = |node: usize| 0.5 * world.state().velocity[node].length_squared() * mass[node];
            let energies = bodies.iter().map(|body| body.nodes.clone().map(energy).sum());
            most.iter_mut().zip(energies).for_each(|(most, energy)| *most = most.max(energy));
        }
        if world.status() != Status::Ok {
            return Err(Restless::Diverges);
        }
        let mut loads: Vec<_> = mass.iter().map(|&mass| scene.gravity * mass).collect();
        run.loads.iter().for_each(|load| load.add(scene.frame_time(frame), &world.state().position, &mut loads));
        let velocity = &world.state().velocity;
        let gained = |node: usize| (velocity[node] - before[node]) * (mass[node] * scene.frames_per_second);
        // Without a step nothing is known.
        let (mut is_at_rest, mut residual) = (to > from && scene.frame_time(frame - 1) >= changes, 0.0_f64);
        for (Swinging { nodes, still, greatest }, &most) in bodies.iter_mut().zip(&most) {
            let (left, load) = (size(nodes.clone().map(gained)), size(loads[nodes.clone()].iter().copied()));
            *greatest = [greatest[0].max(most), greatest[1].max(left)];
            let share = if load > 0.0 {
                left / load
            } else if left > 0.0 && most > *still {
                left / greatest[1]
            } else {
                0.0
            };
            residual = residual.max(share);
            is_at_rest &= most <= *still || most <= STILL * greatest[0] && share <= BALANCED;
        }
        if is_at_rest {
            return Ok(AtRest { frame, kinetic_energy: most.into_iter().fold(0.0, f64::max), residual });
        }
    }
    Err(Restless::Moves)
}

/// The root of the sum of squares.
fn size(vectors: impl Iterator<Item = DVec3>) -> f64 {
    vectors.map(DVec3::length_squared).sum::<f64>().sqrt()
}
