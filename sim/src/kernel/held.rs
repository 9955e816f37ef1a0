//! The nodes that grips hold in some steps, part by part, so that no part looks through those of the others.

use crate::contact::Source;
use crate::grip::Grip;
use crate::system::System;
use glam::DVec3;
use std::ops::Range;

/// The nodes that grips hold in steps in which no grip takes or releases nodes.
pub(crate) struct Held<'a> {
    system: &'a System,
    /// The grips that hold nodes: their numbers, and the middles of where their nodes were gripped (m).
    grips: Vec<(usize, &'a Grip, DVec3)>,
    /// Part by part, in each of them grip by grip.
    nodes: Vec<HeldNode>,
}

struct HeldNode {
    /// The number among all nodes.
    node: usize,
    /// Which of the grips that hold nodes.
    grip: usize,
    /// Where it was gripped (m).
    gripped: DVec3,
}

impl<'a> Held<'a> {
    /// Those of the step after `steps` steps. `memory` is that of grips in the step.
    pub(crate) fn new(system: &'a System, steps: u64, memory: &'a [f64]) -> Self {
        let end = system.interval(steps).end;
        let (mut grips, mut nodes) = (Vec::new(), Vec::new());
        for (number, (grip, memory)) in system.grips(memory).enumerate().filter(|(_, (grip, _))| grip.moves(end)) {
            let own = grip.nodes.iter().zip(Grip::gripped(memory));
            nodes.extend(own.map(|(&node, gripped)| HeldNode { node: node as usize, grip: grips.len(), gripped }));
            grips.push((number, grip, grip.middle(memory)));
        }
        nodes.sort_by_key(|held| system.parts.partition_point(|part| part.nodes.end <= held.node));
        Self { system, grips, nodes }
    }

    /// Those of a part.
    fn of(&self, part: &Range<usize>) -> &[HeldNode] {
        let first = self.nodes.partition_point(|held| held.node < part.start);
        let count = self.nodes[first..].partition_point(|held| held.node < part.end);
        &self.nodes[first..first + count]
    }

    /// Whether nodes of a part are held.
    pub(crate) fn hold(&self, part: &Range<usize>) -> bool {
        !self.of(part).is_empty()
    }

    /// Whether each node of a part is held; `None` if none is.
    pub(crate) fn mask(&self, part: &Range<usize>) -> Option<Vec<bool>> {
        self.hold(part).then(|| {
            let mut mask = vec![false; part.len()];
            self.of(part).iter().for_each(|held| mask[held.node - part.start] = true);
            mask
        })
    }

    /// Calls `place` for each held node of a part, after a share of a step of this number: with the number of the grip, and the number in
    /// the part, the position (m) and the velocity (m/s) of the node.
    pub(crate) fn place(
        &self,
        part: &Range<usize>,
        step: u64,
        share: f64,
        mut place: impl FnMut(usize, usize, DVec3, DVec3),
    ) {
        let interval = self.system.interval(step);
        let left = (1.0 - share) * interval.step;
        for own in self.of(part).chunk_by(|one, other| one.grip == other.grip) {
            let (number, grip, middle) = self.grips[own[0].grip];
            let way = grip.way(interval, middle);
            for held in own {
                let (to, speed) = way.of(held.gripped);
                place(number, held.node - part.start, to - speed * left, speed);
            }
        }
    }

    /// Whether what grips do is added up.
    pub(crate) fn is_felt(&self) -> bool {
        self.system.impulses.is_some()
    }

    /// Adds what a grip did to a node in a step of this number: its positions (m) and velocities (m/s) before and after.
    pub(crate) fn feel(&self, step: u64, [grip, node]: [usize; 2], before: [DVec3; 2], after: [DVec3; 2]) {
        self.system.feel(self.system.interval(step).end, Source::Grip(grip), node, before, after);
    }
}
