//! Scenes that end when all runs are at rest.

use super::Typed;
use crate::reading::collector::{Collector, key_path};
use crate::reading::words::{list, quoted, short};
use crate::scene::file::EndFile;
use crate::scene::{AtRest, Scene};
use crate::sim::{Crew, Load, Status};
use glam::DVec3;
use rayon::prelude::*;

/// The kinetic energy of rest, as a share of the greatest so far: a thousandth of the speed.
const STILL: f64 = 1e-6;
/// The forces that are left at rest, as a share of gravity and loads.
const BALANCED: f64 = 1e-3;
/// Parts of the time between frames at whose ends the kinetic energy is looked at. Oscillations are not still at all of them.
const PARTS: [u64; 8] = [1, 2, 3, 5, 7, 11, 13, 16];

/// Ends the scene at the first frame at which all runs are at rest, if it asks for it: simulates them until then.
pub(super) fn end(typed: &Typed<'_>, scene: &mut Scene, report: &mut Collector<'_>) {
    let asked = typed.file.time.as_ref().and_then(|time| time.until);
    let (Some(EndFile::Rest), 0) = (asked, report.total()) else { return };
    let found: Vec<_> = (0..scene.runs.len()).into_par_iter().map(|run| rest(scene, run)).collect();
    let restless: Vec<_> =
        (scene.runs.iter().zip(&found)).filter(|(_, found)| found.is_none()).map(|(run, _)| &run.name).collect();
    if restless.is_empty() {
        let last = found.iter().flatten().map(|rest| rest.frame).max().unwrap_or(0);
        scene.duration = scene.frame_time(last);
        scene.runs.iter_mut().zip(found).for_each(|(run, found)| run.comes_to_rest = found);
    } else {
        let names = list(&restless, "and", quoted);
        let message = format!(
            "{names} {} not at rest after {} s",
            if restless.len() == 1 { "is" } else { "are" },
            short(scene.duration)
        );
        let help = "make `duration` longer, or give more damping, such as `mass_damping = 2`";
        report.warn(&key_path!["time", "until"], message, help);
    }
}

/// When a run comes to rest; `None` if it does not.
fn rest(scene: &Scene, number: usize) -> Option<AtRest> {
    let run = &scene.runs[number];
    if run.recording.is_some() {
        return Some(AtRest { frame: 0, kinetic_energy: 0.0, residual: 0.0 });
    }
    // As long as something outside moves, rest does not last.
    let moving =
        scene.obstacles.iter().map(|obstacle| obstacle.motion.end()).chain(run.grips.iter().map(|grip| grip.end()));
    let changes = moving.chain(run.loads.iter().map(|load| load.course().end())).fold(0.0, f64::max);
    let mass = run.body().mass();
    let mut world = scene.world(number);
    world.set_crew(Crew::new(run.threads(scene.runs.len())));
    let mut greatest: f64 = 0.0;
    for frame in 1..=scene.last_frame() {
        let (from, to) = (world.steps(), world.steps_at(scene.moment(frame)));
        let (before, mut most) = (world.state().velocity.clone(), 0.0_f64);
        for part in PARTS {
            world.advance(from + (to - from) * part / 16 - world.steps());
            let energies =
                world.state().velocity.iter().zip(mass).map(|(speed, mass)| 0.5 * mass * speed.length_squared());
            most = most.max(energies.sum());
        }
        if world.status() != Status::Ok {
            return None;
        }
        greatest = greatest.max(most);
        if most > STILL * greatest || scene.frame_time(frame - 1) < changes {
            continue;
        }
        let time = scene.frame_time(frame);
        let mut loads: Vec<_> = mass.iter().map(|&mass| scene.gravity * mass).collect();
        run.loads.iter().for_each(|load| load.add(time, &world.state().position, &mut loads));
        let gained = world.state().velocity.iter().zip(&before).zip(mass);
        let left = gained.map(|((now, before), &mass)| (*now - *before) * (mass * scene.frames_per_second));
        let (left, load) = (size(left), size(loads.into_iter()));
        let residual = if load > 0.0 { left / load } else { 0.0 };
        if residual <= BALANCED {
            return Some(AtRest { frame, kinetic_energy: most, residual });
        }
    }
    None
}

/// The root of the sum of squares.
fn size(vectors: impl Iterator<Item = DVec3>) -> f64 {
    vectors.map(DVec3::length_squared).sum::<f64>().sqrt()
}
