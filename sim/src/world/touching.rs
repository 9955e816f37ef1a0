//! Forces of contact and of constraints, for those who ask for them.

use super::World;
use crate::contact::{ContactPoint, Impulses, Reaction, Side, Source};
use crate::diagnose::Outside;
use crate::diagnostics::Diagnostic;
use crate::dynamics::Dynamics;
use crate::limit::SpeedLimit;
use crate::state::{Runaway, State};
use crate::surroundings::Surroundings;
use crate::system::System;
use crate::world::Moment;

impl World {
    /// Keeps the mean forces of contact and of kinematic constraints from now on, over intervals of time: an interval ends with the step nearest
    /// to each multiple of the moment `every`, and with every step if it is shorter. The sums of a state that was just taken go on. Bodies move with the same bits as without, and a fast step
    /// costs a little more where nodes meet obstacles or are held. Forces of a recorded world are those that were recorded.
    ///
    /// The sum of the forces on a body times the length of an interval is the change of its momentum in it, but for gravity and loads. What one
    /// body exerts on another is the opposite of what that exerts on it. Obstacles exert nothing on nodes that are held while nodes meet
    /// obstacles. Surfaces also push nodes that are held, and what holds them pushes back. The torques are the change of the angular momentum
    /// about the origin; for nodes that are dragged to first order in the step, unless a vectorised Euler method moves them.
    ///
    /// # Panics
    /// If `every` is not above zero.
    pub fn keep_reactions(&mut self, every: Moment) {
        assert!(every.count / every.rate > 0.0, "an interval above zero");
        // A world that keeps none forgets the sums of its state as soon as it pauses. After further steps they are those of another moment.
        let is_just_taken = self.system.impulses.is_none() && self.steps() == self.state.steps;
        let of_state = is_just_taken.then(|| std::mem::take(&mut self.state.memory.contact));
        self.pause();
        of_state.into_iter().for_each(|sums| self.state.memory.contact = sums);
        let Surroundings { obstacles, grips, .. } = &self.system.surroundings;
        let sizes = [obstacles.len(), grips.len(), self.system.parts.len()];
        let mut impulses = Impulses::new(sizes, every, self.state.steps);
        impulses.load(&self.state.memory.contact, self.state.steps);
        impulses.store(&mut self.state.memory.contact);
        self.system.impulses = Some(impulses);
    }

    /// Does the same in a world that starts at [rest](crate::equilibrium), where the forces are those that hold it: the means over its first steps,
    /// which are not taken.
    ///
    /// # Panics
    /// If `every` is not above zero.
    pub fn keep_reactions_from_rest(&mut self, every: Moment) {
        /// As many as the search for rest looks at where surfaces meet.
        const STEPS: u64 = 16;
        let mut copy = self.clone();
        copy.keep_reactions(Moment { count: STEPS as f64, rate: 1.0 / self.step() });
        copy.advance(STEPS);
        self.keep_reactions(every);
        if let (Some(forces), Some(impulses)) = (copy.reactions(), self.system.impulses.as_mut()) {
            impulses.begin_with(&forces);
            impulses.store(&mut self.state.memory.contact);
        }
    }

    /// The mean forces in the last interval that has ended, of each obstacle, each constraint and then each body on each body; `None` before the
    /// first end, and if they are [not kept](Self::keep_reactions).
    pub fn reactions(&self) -> Option<Vec<Reaction>> {
        self.system.impulses.as_ref()?.forces(&self.state.memory.contact)
    }

    /// Where bodies touch obstacles, other bodies and themselves in the present state, by positions alone. Nodes touch an obstacle at a
    /// thousandth of the size of the body, surfaces at 1.1 times the distance that is kept.
    pub fn contact_points(&self) -> Vec<ContactPoint> {
        /// Relative to the size of a body.
        const NEAR: f64 = 1e-3;
        let System { parts, contact, .. } = &self.system;
        let (position, time) = (&self.state.position, self.system.interval(self.state.steps).begin);
        let (met, apart) = (self.system.met_by_nodes(), self.system.apart());
        let mut found = Vec::new();
        for (on, part) in parts.iter().enumerate().filter(|(_, part)| !apart.contains(&part.nodes)) {
            let near = NEAR * part.body.extent();
            for &(number, obstacle) in &met {
                let own = position[part.nodes.clone()].iter().filter(|&&at| obstacle.depth(at, time) > -near);
                found.extend(own.map(|&at| ContactPoint { from: Side::Obstacle(number), on, at }));
            }
        }
        found.extend(contact.iter().flat_map(|stage| stage.points(position, time)));
        found
    }

    /// The numbers of pairs of facets that cross each other in the present state, of surfaces that meet: of each two bodies, a body and an
    /// obstacle, or a body with itself, where there are some. Of what lies inside another surface and crosses none of its facets, all facets
    /// count. In the plane facets are sides. `None` in a world whose surfaces do not meet
    /// ([`Surroundings::contacts`](crate::Surroundings::contacts)).
    pub fn crossings(&self) -> Option<Vec<([Side; 2], usize)>> {
        self.system.surroundings.contacts.as_ref()?;
        let (stage, time) = (self.system.contact.as_ref(), self.system.interval(self.state.steps).begin);
        Some(stage.map_or_else(Vec::new, |stage| stage.crossings(&self.state.position, time)))
    }

    /// What diagnostics tell of each body from outside: the mean force of contact and its torque, the work of loads, and the crossings of its
    /// own and those that it shares with other bodies. Work and crossings take time, and are told only if they are wanted.
    pub(super) fn outside(&self, wanted: &[Diagnostic]) -> Vec<Outside> {
        let mut all = vec![Outside::default(); self.system.parts.len()];
        let work = wanted.contains(&Diagnostic::Work).then(|| self.work()).flatten();
        all.iter_mut().zip(work.into_iter().flatten()).for_each(|(outside, work)| outside.work = Some(work));
        for Reaction { from, on, force, torque } in self.reactions().iter().flatten() {
            let Outside { contact, grips, .. } = &mut all[*on];
            let sums = if matches!(from, Source::Grip(_)) { grips } else { contact };
            let [sum, turning] = sums.unwrap_or_default();
            *sums = Some([sum + *force, turning + *torque]);
        }
        let counted = wanted.contains(&Diagnostic::Crossings).then(|| self.crossings()).flatten();
        if counted.is_some() {
            all.iter_mut().for_each(|outside| outside.crossings = Some([0; 2]));
        }
        for (sides, count) in counted.iter().flatten() {
            let is_shared = matches!(sides, [Side::Body(one), Side::Body(other)] if one != other);
            for side in &sides[..if is_shared { 2 } else { 1 }] {
                let Side::Body(body) = side else { continue };
                all[*body].crossings.iter_mut().for_each(|sums| sums[usize::from(is_shared)] += count);
            }
        }
        all
    }
}

impl System {
    /// Takes steps, and ends the intervals of contact forces on the way. Nothing is repeated across an end.
    pub(super) fn advance_intervals(
        &mut self,
        dynamics: &mut dyn Dynamics,
        limit: &SpeedLimit,
        state: &mut State,
        count: u64,
    ) -> Result<(), Runaway> {
        let mut left = count;
        while let Some(impulses) = self.impulses.as_ref().filter(|_| left > 0 && !dynamics.is_recorded()) {
            let begin = dynamics.steps(state);
            let end = impulses.next_end(begin, self.step);
            let steps = left.min(end - begin);
            dynamics.advance(self, limit, state, steps)?;
            left -= steps;
            if begin + steps == end {
                dynamics.settle(state);
                dynamics.restart();
                let step = self.step;
                self.impulses.iter_mut().for_each(|impulses| impulses.end(end, step));
            }
        }
        dynamics.advance(self, limit, state, left)
    }
}
