//! What contact sees of the end of a step.

use super::Impulses;
use crate::motion::Interval;
use crate::state::Nodes;
use glam::DVec3;

/// The velocity with which nodes moved in a step, and the one that decides a rebound.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Timing {
    /// They moved with the velocity at the end, as by semi-implicit Euler. The mean of those at the start and at the end decides.
    #[default]
    End,
    /// They moved with the mean of those at the start and at the end, as by other methods. The one at the start decides: the impulse acts as
    /// if it were given there.
    Start,
}

impl Timing {
    /// The shares of the change of velocity in the step, from the end backwards, for the rebound and for the motion.
    pub(super) fn lags(self) -> [f64; 2] {
        match self {
            Self::End => [0.5, 0.0],
            Self::Start => [1.0, 0.5],
        }
    }
}

/// The end of a step, as contact sees and changes it: the nodes of surfaces, without gaps between their numbers.
pub(crate) struct End<'a> {
    pub(crate) interval: Interval,
    /// At the start of the step.
    pub(crate) before: Nodes<'a>,
    pub(crate) position: &'a mut [DVec3],
    pub(crate) velocity: &'a mut [DVec3],
    pub(crate) timing: Timing,
    /// Takes the nodes that contact changes.
    pub(crate) changed: &'a mut Vec<u32>,
    /// Where impulses are added up, if anywhere.
    pub(crate) impulses: Option<&'a Impulses>,
}

/// How a node moves at the end of a step: what contact reads only of those that come near enough, in one line of the cache.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Motion {
    /// At the end of the step (m/s).
    pub(super) velocity: DVec3,
    /// The velocity at the start of the step minus that at its end, before contact (m/s).
    pub(super) slowed: DVec3,
    /// 1/m (1/kg), zero for nodes that are held and points of obstacles.
    pub(super) inverse_mass: f64,
    /// Whether contact has changed it.
    pub(super) is_changed: bool,
}

impl Motion {
    /// That of a point with a velocity (m/s) that contact cannot change.
    pub(super) fn held(velocity: DVec3) -> Self {
        Self { velocity, slowed: DVec3::ZERO, inverse_mass: 0.0, is_changed: false }
    }
}

/// The nodes of surfaces, and after them the points of obstacles, in a step.
#[derive(Clone, Debug, Default)]
pub(super) struct Ends {
    /// Where they are at the start of the step (m).
    pub(super) start: Vec<DVec3>,
    /// Where they are at its end (m), and how they move there.
    pub(super) position: Vec<DVec3>,
    pub(super) motion: Vec<Motion>,
    /// The nodes that grips hold, in rising order, each with its grip.
    pub(super) held: Vec<[usize; 2]>,
    /// ΔT (s).
    pub(super) step: f64,
    pub(super) timing: Timing,
}

impl Ends {
    /// Takes the motion of nodes, and of points of obstacles, whose positions at the start and at the end are known.
    pub(super) fn take(&mut self, inverse_mass: &[f64], end: &End<'_>) {
        let Self { start, position, motion, held, step, timing } = self;
        (*step, *timing) = (end.interval.step, end.timing);
        motion.clear();
        let velocities = end.before.velocity.iter().zip(&*end.velocity);
        motion.extend(velocities.zip(inverse_mass).map(|((&before, &velocity), &inverse_mass)| {
            let slowed = before - velocity;
            Motion { velocity, slowed, inverse_mass, is_changed: false }
        }));
        let points = start.iter().zip(&*position).skip(inverse_mass.len());
        motion.extend(points.map(|(&from, &to)| Motion::held((to - from) / *step)));
        held.sort_unstable();
        held.iter().for_each(|&[node, _]| motion[node].inverse_mass = 0.0);
    }

    /// Counts what contact has changed so far as a part of the step, before what is to come.
    pub(super) fn go_on(&mut self, end: &End<'_>) {
        for (motion, &before) in self.motion.iter_mut().zip(end.before.velocity).filter(|(motion, _)| motion.is_changed)
        {
            motion.slowed = before - motion.velocity;
        }
    }

    /// Writes the nodes that contact has changed.
    pub(super) fn give(&self, end: &mut End<'_>) {
        let all = self.position.iter().zip(&self.motion).zip(&mut *end.position).zip(&mut *end.velocity);
        for (number, (((&at, motion), position), velocity)) in (0..).zip(all) {
            if motion.is_changed {
                (*position, *velocity) = (at, motion.velocity);
                end.changed.push(number);
            }
        }
    }
}
