//! The impulses that obstacles and bodies exert on bodies where they touch, and kinematic constraints on the nodes that they hold, for worlds
//! that are asked for them.
//!
//! They are added up over intervals of time. What steps have added since the last [`Impulses::keep`] waits: these steps may be taken
//! again. It is added in the order of time, and of nodes, so that sums have the same bits for any number of threads.

use super::Side;
use crate::world::Moment;
use glam::DVec3;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What exerts a force on a body, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "scene", derive(serde::Serialize, serde::Deserialize))]
pub enum Source {
    /// An obstacle.
    Obstacle(usize),
    /// A kinematic constraint.
    Grip(usize),
    /// Another body.
    Body(usize),
}

impl From<Side> for Source {
    fn from(side: Side) -> Self {
        match side {
            Side::Obstacle(number) => Self::Obstacle(number),
            Side::Body(number) => Self::Body(number),
        }
    }
}

/// The mean force that an obstacle, a kinematic constraint or another body exerts on a body, over an interval of time.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize, serde::Deserialize))]
pub struct Reaction {
    /// What exerts it.
    pub from: Source,
    /// The number of the body that it acts on.
    pub on: usize,
    /// The force (N).
    pub force: DVec3,
    /// Its torque about the origin (N m).
    pub torque: DVec3,
}

/// An impulse on a body in a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Felt {
    /// The end of the step (s).
    pub(crate) time: f64,
    /// The node that has it; [`SURFACE`] for an impulse on several nodes.
    pub(crate) node: usize,
    pub(crate) from: Source,
    pub(crate) on: usize,
    /// The change of momentum of the body (N s), and of its angular momentum about the origin (N m s).
    pub(crate) changes: [DVec3; 2],
}

/// In place of a node. Surfaces meet after nodes have met obstacles.
const SURFACE: usize = usize::MAX;

/// Impulses and angular impulses about the origin, of each obstacle, each kinematic constraint and then each body on each body.
#[derive(Debug)]
pub(crate) struct Impulses {
    obstacles: usize,
    grips: usize,
    bodies: usize,
    /// An interval ends at each multiple of this moment.
    every: Moment,
    sums: Mutex<Sums>,
}

#[derive(Clone, Debug, Default)]
struct Sums {
    /// The step with which the present interval began; whether there was one before, 0 or 1; the sums of the present interval
    /// (N s, N m s), and the means of the one before (N, N m).
    numbers: Vec<f64>,
    waiting: Vec<Felt>,
}

/// The first numbers of [`Sums::numbers`].
const HEAD: usize = 2;

impl Clone for Impulses {
    fn clone(&self) -> Self {
        Self { sums: Mutex::new(self.lock().clone()), ..*self }
    }
}

impl Impulses {
    /// None so far, from a step on.
    pub(crate) fn new([obstacles, grips, bodies]: [usize; 3], every: Moment, step: u64) -> Self {
        let mut numbers = vec![0.0; HEAD + 2 * 6 * (obstacles + grips + bodies) * bodies];
        numbers[0] = step as f64;
        Self { obstacles, grips, bodies, every, sums: Mutex::new(Sums { numbers, waiting: Vec::new() }) }
    }

    /// None so far, among so many obstacles and kinematic constraints.
    pub(crate) fn among(&self, [obstacles, grips]: [usize; 2], step: u64) -> Self {
        Self::new([obstacles, grips, self.bodies], self.every, step)
    }

    /// The numbers of obstacles and of kinematic constraints.
    pub(crate) fn surroundings(&self) -> [usize; 2] {
        [self.obstacles, self.grips]
    }

    fn lock(&self) -> MutexGuard<'_, Sums> {
        self.sums.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds an impulse of a step that may be taken again.
    pub(crate) fn feel(&self, felt: Felt) {
        self.lock().waiting.push(felt);
    }

    /// The same for surfaces, which meet in order. What follows from the same side in the same step is added up.
    pub(super) fn feel_surface(&self, time: f64, from: Source, on: usize, changes: [DVec3; 2]) {
        let waiting = &mut self.lock().waiting;
        match waiting.last_mut().filter(|last| (last.time, last.node, last.from, last.on) == (time, SURFACE, from, on))
        {
            Some(last) => last.changes.iter_mut().zip(changes).for_each(|(sum, one)| *sum += one),
            None => waiting.push(Felt { time, node: SURFACE, from, on, changes }),
        }
    }

    /// The number of impulses that wait.
    pub(crate) fn waiting(&self) -> usize {
        self.lock().waiting.len()
    }

    /// Forgets all that wait but the first of them: the steps since then are taken again, or not at all.
    pub(crate) fn forget(&self, but: usize) {
        self.lock().waiting.truncate(but);
    }

    /// Adds what waits to the sums: no step until now will be taken again.
    pub(crate) fn keep(&self) {
        let mut sums = self.lock();
        let waiting = std::mem::take(&mut sums.waiting);
        self.add(waiting, &mut sums.numbers);
    }

    fn add(&self, mut waiting: Vec<Felt>, numbers: &mut [f64]) {
        waiting.sort_by(|one, other| one.time.total_cmp(&other.time).then(one.node.cmp(&other.node)));
        for Felt { from, on, changes: [impulse, turn], .. } in waiting {
            let first = HEAD + self.place(from, on);
            let added = impulse.to_array().into_iter().chain(turn.to_array());
            numbers[first..first + 6].iter_mut().zip(added).for_each(|(sum, one)| *sum += one);
        }
    }

    fn place(&self, from: Source, on: usize) -> usize {
        let from = match from {
            Source::Obstacle(number) => number,
            Source::Grip(number) => self.obstacles + number,
            Source::Body(number) => self.obstacles + self.grips + number,
        };
        6 * (from * self.bodies + on)
    }

    /// Writes all numbers for a state.
    pub(crate) fn store(&self, numbers: &mut Vec<f64>) {
        let sums = self.lock();
        numbers.clone_from(&sums.numbers);
        self.add(sums.waiting.clone(), numbers);
    }

    /// Takes the numbers of a state at a step. Those of other obstacles or bodies do not count.
    pub(crate) fn load(&mut self, numbers: &[f64], step: u64) {
        let sums = self.sums.get_mut().unwrap_or_else(PoisonError::into_inner);
        sums.waiting.clear();
        if numbers.len() == sums.numbers.len() {
            sums.numbers.copy_from_slice(numbers);
        } else {
            sums.numbers.fill(0.0);
            sums.numbers[0] = step as f64;
        }
    }

    /// Takes forces as the means of the interval before the present one.
    pub(crate) fn begin_with(&mut self, forces: &[Reaction]) {
        let places: Vec<_> = forces.iter().map(|one| self.place(one.from, one.on)).collect();
        let sums = self.sums.get_mut().unwrap_or_else(PoisonError::into_inner);
        sums.numbers[1] = 1.0;
        let means = HEAD + (sums.numbers.len() - HEAD) / 2;
        for (Reaction { force, torque, .. }, place) in forces.iter().zip(places) {
            let mean = force.to_array().into_iter().chain(torque.to_array());
            sums.numbers[means + place..][..6].iter_mut().zip(mean).for_each(|(number, mean)| *number = mean);
        }
    }

    /// The first step after which an interval ends, later than a step, with steps of ΔT (s).
    pub(crate) fn next_end(&self, after: u64, step: f64) -> u64 {
        let Moment { count, rate } = self.every;
        let every = count / rate;
        if every <= step {
            return after + 1;
        }
        let end = |number: f64| Moment { count: number * count, rate }.step(step);
        // Round-off may be on either side.
        let near = ((after as f64 + 0.5) * step / every).floor();
        [0.0, 1.0, 2.0].map(|more| end(near + more)).into_iter().find(|&end| end > after).unwrap_or(u64::MAX)
    }

    /// Ends an interval after a step; steps are of ΔT (s).
    pub(crate) fn end(&mut self, after: u64, step: f64) {
        self.keep();
        let Sums { numbers, .. } = self.sums.get_mut().unwrap_or_else(PoisonError::into_inner);
        let (head, rest) = numbers.split_at_mut(HEAD);
        let time = (after as f64 - head[0]) * step;
        if time > 0.0 {
            let (sums, means) = rest.split_at_mut(rest.len() / 2);
            means.iter_mut().zip(sums).for_each(|(mean, sum)| *mean = std::mem::take(sum) / time);
            (head[0], head[1]) = (after as f64, 1.0);
        }
    }

    /// The mean forces in the last interval that has ended, by numbers from [`Self::store`]; `None` before the first end.
    pub(crate) fn forces(&self, numbers: &[f64]) -> Option<Vec<Reaction>> {
        let (&[_, known], rest) = numbers.split_first_chunk::<HEAD>()?;
        let means = &rest[rest.len() / 2..];
        let around = (0..self.obstacles).map(Source::Obstacle).chain((0..self.grips).map(Source::Grip));
        let sources = around.chain((0..self.bodies).map(Source::Body));
        let pairs = sources.flat_map(|from| (0..self.bodies).map(move |on| (from, on)));
        let found = pairs.filter(|&(from, on)| from != Source::Body(on)).map(|(from, on)| {
            let [x, y, z, a, b, c] = std::array::from_fn(|at| means[self.place(from, on) + at]);
            Reaction { from, on, force: DVec3::new(x, y, z), torque: DVec3::new(a, b, c) }
        });
        (known == 1.0).then(|| found.collect())
    }
}
