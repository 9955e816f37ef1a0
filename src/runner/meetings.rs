//! From which step on bodies go through each other, where contact of surfaces does not keep them apart.

use super::RunFrame;
use crate::reading::words::{list, several, short};
use crate::scene::Scene;
use crate::sim::{Contacts, Moment, Overlap, Side, State, Status, Surfaces, World};
use glam::DVec3;
use std::collections::BTreeSet;

/// Watches a run until two of its bodies overlap that were apart at the start.
///
/// It looks at steps, however they are divided into calls. Until the next look no node moves, at the present speeds, farther relative
/// to another than a quarter of an element. Where a look finds an overlap, the steps since the look before are taken again, one by one.
pub(super) struct Watch {
    surfaces: Surfaces,
    /// The pairs that overlap at the start, which the check of the scene tells.
    known: BTreeSet<[usize; 2]>,
    /// The least of the mean lengths of edges of each body (m).
    side: f64,
    /// The state of the last look.
    last: State,
    /// The step of the next look.
    next: u64,
}

impl Watch {
    /// The most steps between two looks: a look then costs little beside them.
    const MOST: f64 = 16.0;

    /// Watches a run from the start of its world; `None` if no two bodies of it can be told of.
    pub(super) fn new(scene: &Scene, run: usize, world: &World) -> Option<Self> {
        let run = &scene.runs[run];
        let bodies = run.of.len();
        // Nothing is known here of recorded bodies between their moments, and surfaces keep bodies apart.
        if bodies < 2 || run.recording.is_some() || scene.contacts.is_some() {
            return None;
        }
        let surfaces = Surfaces::new(run.bodies.bodies(), &[], &Contacts::default());
        let known: BTreeSet<_> = overlaps(&surfaces, &run.initial.position, |_| true).collect();
        let side = run.of.iter().map(|&body| scene.bodies[body].side).fold(f64::INFINITY, f64::min);
        let is_left = known.len() < bodies * (bodies - 1) / 2;
        is_left.then(|| Self { surfaces, known, side, last: world.state().clone(), next: 1 })
    }

    /// Goes on from the state of a world, which was looked at before.
    pub(super) fn goes_on(&mut self, world: &World) {
        self.last.clone_from(world.state());
        self.next = self.last.steps + 1;
    }

    /// Advances the world of a run as [`World::advance_towards`] does. Returns whether the moment has been reached, and the message
    /// about the first two bodies that overlap, after which there is nothing to watch.
    pub(super) fn advance(
        &mut self,
        scene: &Scene,
        run: usize,
        world: &mut World,
        (moment, mut left): (Moment, u64),
    ) -> (bool, Option<String>) {
        loop {
            let before = world.steps();
            let is_there = world.advance_towards(moment, left.min(self.next - before));
            let has_diverged = world.status() != Status::Ok;
            if world.steps() >= self.next || has_diverged {
                let found = self.look(scene, run, world);
                if found.is_some() || has_diverged {
                    return (is_there, found);
                }
            }
            left = left.saturating_sub(world.steps() - before);
            if is_there || left == 0 {
                return (is_there, None);
            }
        }
    }

    /// The message about the first two bodies that overlap in a step since the last look. The world stays as it is.
    pub(super) fn look(&mut self, scene: &Scene, run: usize, world: &mut World) -> Option<String> {
        world.settle();
        let Self { surfaces, known, side, last, next } = self;
        let (of, is_new) = (&scene.runs[run], |pair: [usize; 2]| !known.contains(&pair));
        let State { position, velocity, .. } = world.state();
        if overlaps(surfaces, position, is_new).next().is_none() {
            let mean = velocity.iter().sum::<DVec3>() / velocity.len() as f64;
            let fastest = velocity.iter().map(|speed| speed.distance(mean)).fold(0.0, f64::max);
            let steps = *side / 4.0 / (2.0 * fastest * of.step);
            last.clone_from(world.state());
            *next = last.steps + steps.clamp(1.0, Self::MOST) as u64;
            return None;
        }
        let present = world.state().clone();
        world.set_state(last.clone());
        let pair = loop {
            world.advance(1);
            if let Some(pair) = overlaps(surfaces, &world.state().position, is_new).next() {
                break pair;
            }
        };
        let [one, other] = pair.map(|body| &scene.bodies[of.of[body]].name);
        let (time, name) = (short(world.steps() as f64 * of.step), &of.name);
        world.set_state(present);
        let message = format!("“{one}” and “{other}” go through each other from {time} s on in “{name}”");
        Some(format!("{message}: bodies do not collide"))
    }
}

/// The message about surfaces that cross or lie in each other in a frame of a run, though contact keeps them apart; `None` if none do.
pub(crate) fn crossing(scene: &Scene, frame: &RunFrame) -> Option<String> {
    let RunFrame { run, snapshot, .. } = frame;
    let (of, count) = (&scene.runs[*run], snapshot.diagnostics.crossings);
    if count.is_nan() || count == 0.0 {
        return None;
    }
    let crossed = of.of.iter().zip(&snapshot.of_bodies).filter(|(_, own)| own.crossings > 0.0);
    // Only a single body has no name.
    let names: Vec<_> = crossed.map(|(&body, _)| &scene.bodies[body].name).filter(|name| !name.is_empty()).collect();
    let of_bodies = if names.is_empty() { "" } else { ", of " };
    let (names, time) = (list(&names, "and", |name| format!("“{name}”")), short(snapshot.time));
    let (shorter, pairs) = (short(of.step / 2.0), several(count as u64, "place"));
    let step = format!(
        "take a shorter step, such as {shorter} s; if that does not help, they are crumpled too much or dragged into each other"
    );
    Some(format!(
        "surfaces cross or lie in each other at {time} s in “{}”{of_bodies}{names} ({pairs}): {step}",
        of.name
    ))
}

/// The pairs of bodies among the `wanted` ones that overlap with nodes at given positions (m), in order. Bodies that touch do not overlap.
fn overlaps(
    surfaces: &Surfaces,
    position: &[DVec3],
    wanted: impl Fn([usize; 2]) -> bool,
) -> impl Iterator<Item = [usize; 2]> {
    let pair = |of: [Side; 2]| match of {
        [Side::Body(one), Side::Body(other)] => Some([one, other]),
        _ => None,
    };
    let found = surfaces.overlaps(position, 0.0, |of| pair(of).is_some_and(&wanted)).into_iter();
    found.filter(|Overlap { depth, .. }| *depth > 0.0).filter_map(move |Overlap { of, .. }| pair(of))
}

#[cfg(test)]
#[path = "../../tests/inside/meetings.rs"]
mod tests;
