//! A system that is advanced together: bodies with their models, obstacles and kinematic constraints.

use super::contact::{End, Felt, Impulses, Obstacle, Source, Stage, Timing};
use super::crew::Crew;
use super::grip::Grip;
use super::limit::SpeedLimit;
use super::model::{Projected, Scratch};
use super::motion::Interval;
use super::part::Part;
use super::state::{Divergence, Memory, Nodes, Runaway, State};
use super::surroundings::Surroundings;
use super::work::Work;
use glam::DVec3;
use std::ops::Range;
use std::sync::Arc;

/// All parts and their surroundings.
#[derive(Clone)]
pub(super) struct System {
    pub(super) parts: Vec<Part>,
    /// Mass of each node (kg).
    pub(super) mass: Vec<f64>,
    pub(super) surroundings: Surroundings,
    /// Contact of surfaces, applied after grips; `None` if no two can meet.
    pub(super) contact: Option<Stage>,
    /// Where impulses of contact are added up, if they are asked for.
    pub(super) impulses: Option<Impulses>,
    /// The work of forces from outside, if there are any.
    pub(super) work: Option<Work>,
    /// The order of the method, above 2 or not.
    pub(super) is_fine: bool,
    /// Time step ΔT (s).
    pub(super) step: f64,
    pub(super) crew: Arc<Crew>,
}

impl System {
    /// The obstacles that nodes meet, with their numbers: half-spaces alone where surfaces meet the others.
    pub(super) fn met_by_nodes(&self) -> Vec<(usize, &Obstacle)> {
        let is_met =
            |(_, obstacle): &(usize, &Obstacle)| self.surroundings.contacts.is_none() || obstacle.shape.is_half_space();
        self.surroundings.obstacles.iter().enumerate().filter(is_met).collect()
    }

    /// Whether grips hold each node at the end of a step, if impulses are asked for; they feel none of obstacles.
    pub(super) fn unfeeling(&self, interval: Interval, constraints: &[f64]) -> Vec<bool> {
        let mut held = vec![false; self.impulses.as_ref().map_or(0, |_| self.mass.len())];
        if !held.is_empty() {
            self.held(interval, constraints).for_each(|(_, node, ..)| held[node] = true);
        }
        held
    }

    /// Adds what an obstacle or a grip does to a node in a step that ends at a time (s), with its positions (m) and velocities (m/s) before and
    /// after.
    pub(super) fn feel(&self, time: f64, from: Source, node: usize, before: [DVec3; 2], after: [DVec3; 2]) {
        if let Some(impulses) = self.impulses.as_ref().filter(|_| before != after) {
            let on = self.parts.partition_point(|part| part.nodes.end <= node);
            let [before, after] = [before, after].map(|[at, speed]| [speed, at.cross(speed)]);
            let changes = [0, 1].map(|of| (after[of] - before[of]) * self.mass[node]);
            impulses.feel(Felt { time, node, from, on, changes });
        }
    }

    /// The nodes of bodies that meet half-spaces with their carried surface: they meet no obstacle.
    pub(super) fn apart(&self) -> Vec<Range<usize>> {
        let is_apart = |part: &&Part| self.surroundings.contacts.is_some() && part.body.meets_by_surface();
        self.parts.iter().filter(is_apart).map(|part| part.nodes.clone()).collect()
    }

    /// Makes contact of surfaces anew, as the surroundings say.
    pub(super) fn renew_contact(&mut self) {
        let Surroundings { contacts, obstacles, .. } = &self.surroundings;
        let bodies: Vec<_> = self.parts.iter().map(|part| Arc::clone(&part.body)).collect();
        let stage = contacts.as_ref().map(|contacts| Stage::new(contacts, &bodies, obstacles));
        self.contact = stage.filter(Stage::can_meet);
    }

    /// Counts the work of forces from outside from a state on, after some work (J) on each part.
    pub(super) fn renew_work(&mut self, sums: Vec<f64>, state: &State) {
        let (parts, begin) = (self.parts.iter().map(|part| part.nodes.clone()), self.interval(state.steps).begin);
        self.work = Work::new(&self.surroundings, parts, self.is_fine, sums, begin, state.nodes());
    }

    /// Whether the work of forces from outside is added up before the step after `steps` steps: where they change.
    pub(super) fn adds_work(&self, steps: u64) -> bool {
        let changes = |step: u64| !self.surroundings.are_steady(self.interval(step));
        self.work.is_some() && (changes(steps) || steps > 0 && changes(steps - 1))
    }

    /// The time interval of the step after `steps` steps.
    pub(super) fn interval(&self, steps: u64) -> Interval {
        Interval { begin: steps as f64 * self.step, end: (steps + 1) as f64 * self.step, step: self.step }
    }

    /// The part that a node belongs to, and the first element of that part that contains it.
    fn place_of(&self, node: usize) -> (usize, Option<usize>) {
        let part = self.parts.partition_point(|part| part.nodes.end <= node);
        let Part { body, nodes, .. } = &self.parts[part];
        let own = (node - nodes.start) as u32;
        (part, body.elements.iter().position(|nodes| nodes.contains(&own)))
    }

    /// The greatest speed of nodes from a state on.
    pub(super) fn speed_limit(&self, state: &State) -> SpeedLimit {
        let since = self.interval(state.steps).begin;
        let of = |part: &Part| SpeedLimit::new(part, state.nodes(), &self.surroundings, self.step, since);
        self.parts.iter().map(of).reduce(SpeedLimit::max).unwrap_or_default()
    }

    /// Where and when a run diverges whose next step is not taken.
    pub(super) fn divergence(&self, state: &State, runaway: Runaway) -> Divergence {
        let (time, step) = (self.interval(state.steps).end, state.steps + 1);
        let (part, element) = self.place_of(runaway.node);
        Divergence { time, step, part, element, is_end: false }
    }

    /// Whether forces depend on velocities.
    pub(super) fn is_damped(&self) -> bool {
        self.surroundings.mass_damping > 0.0 || self.parts.iter().any(|part| part.forces.is_damped())
    }

    /// Gravity, damping of masses and forces from outside at a time (s), then the elastic models' Eq. (1) or Eq. (4): writes the force on each node (N), and
    /// the models' `next` memory. Models that project positions exert none.
    pub(super) fn forces(
        &self,
        time: f64,
        at: Nodes<'_>,
        memory: &[f64],
        next: &mut [f64],
        scratch: &mut Scratch,
        forces: &mut [DVec3],
    ) {
        scratch.share(&self.crew);
        for (force, &mass) in forces.iter_mut().zip(&self.mass) {
            *force = self.surroundings.gravity * mass;
        }
        if self.surroundings.mass_damping > 0.0 {
            for ((force, &mass), &velocity) in forces.iter_mut().zip(&self.mass).zip(at.velocity) {
                *force -= velocity * (self.surroundings.mass_damping * mass);
            }
        }
        self.surroundings.push(time, at.position, forces);
        for part in self.parts.iter().filter(|part| part.projection.is_none()) {
            let (memory, next) = (&memory[part.memory.clone()], &mut next[part.memory.clone()]);
            part.forces.add_forces(part.nodes_of(at), memory, next, scratch, &mut forces[part.nodes.clone()]);
        }
    }

    /// Lets models project the positions of their nodes in a step, of which `next` has the free end, and writes their velocities and
    /// memory. Returns whether one does.
    pub(super) fn project(&self, interval: Interval, state: &State, next: &mut State) -> bool {
        if self.parts.iter().all(|part| part.projection.is_none()) {
            return false;
        }
        self.place_held(interval, 1.0, next);
        let mut inverse_mass: Vec<f64> = self.mass.iter().map(|mass| mass.recip()).collect();
        let mut impulse = vec![DVec3::ZERO; inverse_mass.len()];
        self.held(interval, &next.memory.constraints).for_each(|(_, node, ..)| inverse_mass[node] = 0.0);
        for part in &self.parts {
            let Some(projection) = &part.projection else { continue };
            let (memory, nodes) = (part.memory.clone(), part.nodes.clone());
            let own = Projected {
                position: &mut next.position[nodes.clone()],
                inverse_mass: &inverse_mass[nodes.clone()],
                impulse: &mut impulse[nodes.clone()],
            };
            let before = &state.memory.model[memory.clone()];
            projection.project(own, interval.step, before, &mut next.memory.model[memory]);
            for node in nodes.filter(|&node| inverse_mass[node] > 0.0) {
                next.velocity[node] = (next.position[node] - state.position[node]) / interval.step;
            }
        }
        for (number, node, at, speed) in self.held(interval, &next.memory.constraints) {
            let pushed = speed + impulse[node] / self.mass[node];
            self.feel(interval.end, Source::Grip(number), node, [at, pushed], [at, speed]);
        }
        true
    }

    /// Whether a grip becomes active at the beginning of the step after `steps` steps.
    pub(super) fn takes(&self, steps: u64, memory: &[f64]) -> bool {
        let end = self.interval(steps).end;
        self.grips(memory).any(|(grip, memory)| grip.takes(end, memory))
    }

    /// Whether a grip that held nodes at the beginning of the step after `steps` steps does not hold them at its end.
    pub(super) fn releases(&self, steps: u64) -> bool {
        let Interval { begin, end, .. } = self.interval(steps);
        self.surroundings.grips.iter().any(|grip| grip.moves(begin) && !grip.moves(end))
    }

    /// Each grip with its part of the memory.
    pub(super) fn grips<'a>(&'a self, memory: &'a [f64]) -> impl Iterator<Item = (&'a Grip, &'a [f64])> {
        let mut rest = memory;
        self.surroundings.grips.iter().map(move |grip| {
            let (own, others) = rest.split_at(grip.width());
            rest = others;
            (grip, own)
        })
    }

    /// For each node that a grip holds at the end of a step: the number of the grip, the node, its position (m) and its velocity (m/s).
    pub(super) fn held<'a>(
        &'a self,
        interval: Interval,
        memory: &'a [f64],
    ) -> impl Iterator<Item = (usize, usize, DVec3, DVec3)> {
        self.grips(memory).enumerate().flat_map(move |(number, (grip, memory))| {
            grip.moved(interval, memory).map(move |(node, to, speed)| (number, node, to, speed))
        })
    }

    /// Calls `change` with each grip and its part of the memory.
    pub(super) fn change_grips(&self, memory: &mut [f64], mut change: impl FnMut(&Grip, &mut [f64])) {
        let mut rest = memory;
        for grip in &self.surroundings.grips {
            let (own, others) = rest.split_at_mut(grip.width());
            change(grip, own);
            rest = others;
        }
    }

    /// Applies obstacles, grips and contact at the end of a step from `before` to `after`. `acceleration` (m/s²) is
    /// constant in the step for each node; `None` if nodes moved at constant velocity.
    pub(super) fn constrain(
        &self,
        interval: Interval,
        before: &State,
        after: &mut State,
        acceleration: Option<&[DVec3]>,
        timing: Timing,
    ) {
        let State { position, velocity, memory: Memory { constraints, .. }, .. } = after;
        let (met, apart, held) = (self.met_by_nodes(), self.apart(), self.unfeeling(interval, constraints));
        for nodes in self.parts.iter().map(|part| part.nodes.clone()).filter(|nodes| !apart.contains(nodes)) {
            let acceleration = acceleration.map(|all| &all[nodes.clone()]);
            for &(number, obstacle) in &met {
                let (own, speeds) = (&mut position[nodes.clone()], &mut velocity[nodes.clone()]);
                let before: Option<Vec<_>> =
                    self.impulses.as_ref().map(|_| own.iter().copied().zip(speeds.iter().copied()).collect());
                obstacle.at(interval.end, interval.step).rebound_all(own, speeds, acceleration);
                for (node, (at, speed)) in
                    nodes.clone().zip(before.into_iter().flatten()).filter(|&(node, _)| !held[node])
                {
                    let after = [position[node], velocity[node]];
                    self.feel(interval.end, Source::Obstacle(number), node, [at, speed], after);
                }
            }
        }
        for (_, node, to, speed) in self.held(interval, constraints) {
            (position[node], velocity[node]) = (to, speed);
        }
        let Some(stage) = &self.contact else { return };
        let some = |all: &[DVec3]| stage.nodes.iter().map(|&node| all[node as usize]).collect();
        let [start, mut end] = [[&before.position, &before.velocity], [&*position, &*velocity]]
            .map(|[at, speed]| State::new(some(at), some(speed)));
        let (changed, impulses, before) = (&mut Vec::new(), self.impulses.as_ref(), start.nodes());
        let State { position: places, velocity: speeds, .. } = &mut end;
        self.meet(End { interval, before, position: places, velocity: speeds, timing, changed, impulses }, constraints);
        for number in changed.iter().map(|&number| number as usize) {
            let node = stage.nodes[number] as usize;
            (position[node], velocity[node]) = (end.position[number], end.velocity[number]);
        }
    }

    /// Lets surfaces meet at the end of a step. `constraints` is the memory of grips in the step.
    pub(super) fn meet(&self, end: End<'_>, constraints: &[f64]) {
        let Some(stage) = &self.contact else { return };
        let held = self.held(end.interval, constraints).map(|(number, node, ..)| [number, node]);
        stage.resolve(end, held, &self.crew);
    }

    /// Places the nodes that grips hold at the end of a step where they are after a `share` of it, with their velocity in
    /// the step.
    pub(super) fn place_held(&self, interval: Interval, share: f64, next: &mut State) {
        let State { position, velocity, memory: Memory { constraints, .. }, .. } = next;
        let left = (1.0 - share) * interval.step;
        for (_, node, to, speed) in self.held(interval, constraints) {
            (position[node], velocity[node]) = (to - speed * left, speed);
        }
    }

    /// Adds what grips do to the nodes that they hold at the end of a step, which have other velocities in `next` so far.
    pub(super) fn feel_grips(&self, interval: Interval, next: &State) {
        if self.impulses.is_none() {
            return;
        }
        for (number, node, at, speed) in self.held(interval, &next.memory.constraints) {
            self.feel(interval.end, Source::Grip(number), node, [at, next.velocity[node]], [at, speed]);
        }
    }
}
