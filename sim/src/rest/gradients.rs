//! Conjugate gradients along forces, to where there are none.
//!
//! Each iteration goes along a direction to where the force along it is zero, as far as forces change linearly: they are evaluated at one
//! trial, and interpolated. After some iterations they are evaluated where the bodies are. The better they have been interpolated, the later
//! they are evaluated again; near rest, where forces are linear, an iteration costs one evaluation.
//!
//! Masses are the weights: nodes at the border have less of both mass and stiffness. When as many evaluations as the stiffness of
//! [groups](super::coarse) takes were not enough, it is measured, and precedes the forces from then on; bodies that have turned since get a new one.
//!
//! J. Nocedal, S. Wright, Numerical Optimization (2006), chapter 5.2: the method of Polak and Ribière.

use super::coarse::{Coarse, Groups};
use super::{ENOUGH, Forces, MOST, SOUGHT};
use glam::DVec3;

/// Evaluations without half the residual, after which it does not fall: to the end of a search, and where it is small enough already.
const IDLE: [u64; 2] = [20_000, 1000];
/// The most iterations with interpolated forces.
const RARELY: u32 = 64;
/// The largest error of interpolated forces, as a share of them, with which they are evaluated less often.
const CLOSE: f64 = 0.1;

/// The longest way to where there should be no force along the direction, over that of the trial.
const FARTHER: f64 = 4.0;

/// The nodes and the way on which they are.
struct Way<'a> {
    forces: &'a mut Forces,
    /// The longest way of a node in an iteration (m).
    longest: f64,
    position: Vec<DVec3>,
    acceleration: Vec<DVec3>,
    direction: Vec<DVec3>,
    coarse: Option<Coarse<'a>>,
    /// Where the accelerations lead: the ways of nodes (m) with the stiffness of groups, the accelerations themselves without it.
    lead: Vec<DVec3>,
    /// The positions of a trial (m), and the accelerations there (m/s²).
    trial: Vec<DVec3>,
    there: Vec<DVec3>,
    /// How far the accelerations point along their lead, and along the direction.
    square: f64,
    slope: f64,
    /// The share of the direction in the last iteration, and the longest of the next one.
    share: f64,
    most: f64,
}

/// Moves nodes until the residual is small or does not fall, and returns where they are (m). None moves farther than `longest` (m) at a time.
pub(super) fn descend<'a>(forces: &'a mut Forces, groups: &'a Groups, longest: f64) -> Vec<DVec3> {
    let position = forces.world.state().position.clone();
    let mut way = Way::new(forces, longest, position);
    let mut residual = way.residual();
    let (mut best, mut since) = (residual, 0);
    let (mut often, mut age) = (1, 0);
    let mut since_coarse = 0;
    while residual > SOUGHT && way.forces.evaluations < MOST {
        if way.forces.evaluations > since + IDLE[usize::from(best < ENOUGH)] {
            break;
        }
        age += 1;
        let is_due = age >= often;
        match way.iterate(is_due) {
            Some(error) if is_due => {
                often = if error < CLOSE { RARELY.min(2 * often) } else { 1.max(often / 2) };
                age = 0;
                residual = way.residual();
                if residual < 0.5 * best {
                    (best, since) = (residual, way.forces.evaluations);
                }
                if way.forces.evaluations > since_coarse + groups.cost() {
                    way.take_coarse(groups);
                    since_coarse = way.forces.evaluations;
                }
            }
            Some(_) => {}
            None => (often, age) = (1, 0),
        }
    }
    way.position
}

impl<'a> Way<'a> {
    /// Along the forces at a position (m).
    fn new(forces: &'a mut Forces, longest: f64, position: Vec<DVec3>) -> Self {
        let (mut acceleration, trial, there, lead) = Default::default();
        forces.accelerations(&position, &mut acceleration);
        let direction = vec![DVec3::ZERO; acceleration.len()];
        let [square, slope, share, most] = [0.0; 4];
        let coarse = None;
        let mut way = Self {
            forces,
            longest,
            position,
            acceleration,
            direction,
            coarse,
            lead,
            trial,
            there,
            square,
            slope,
            share,
            most,
        };
        way.begin();
        // As far as the fastest node would go.
        way.share = way.forces.fast;
        way
    }

    /// Measures the stiffness of groups, and begins anew with it.
    fn take_coarse(&mut self, groups: &'a Groups) {
        self.coarse = Some(Coarse::new(groups, self.forces, self.longest, &self.position));
        self.begin();
        self.share = 1.0;
    }

    /// Takes the direction in which the accelerations lead.
    fn begin(&mut self) {
        self.find_lead();
        self.square = self.dot(&self.acceleration, &self.lead);
        self.turn(0.0);
    }

    fn find_lead(&mut self) {
        match &self.coarse {
            Some(coarse) => coarse.lead(&self.acceleration, self.forces, &mut self.lead),
            None => self.lead.clone_from(&self.acceleration),
        }
    }

    fn residual(&mut self) -> f64 {
        self.forces.residual(&self.position, &self.acceleration)
    }

    fn dot(&self, one: &[DVec3], other: &[DVec3]) -> f64 {
        self.forces.mass.iter().zip(one).zip(other).map(|((mass, one), &other)| mass * one.dot(other)).sum()
    }

    /// Takes the lead and a share of the direction as the next direction, or the lead alone, if the forces point against it.
    fn turn(&mut self, kept: f64) {
        let (mut slope, mut fastest) = (0.0, 0.0_f64);
        let both = self.acceleration.iter().zip(&self.lead);
        for ((way, (&acceleration, &lead)), mass) in self.direction.iter_mut().zip(both).zip(&self.forces.mass) {
            *way = lead + *way * kept;
            slope += mass * way.dot(acceleration);
            fastest = fastest.max(way.length_squared());
        }
        (self.slope, self.most) = (slope, self.longest / fastest.sqrt());
        if slope <= 0.0 && kept > 0.0 {
            self.turn(0.0);
        }
    }

    /// Evaluates the accelerations after a share of the direction. Returns how far they point along it; `None` if they are not finite.
    fn look(&mut self, share: f64) -> Option<f64> {
        self.trial.clear();
        self.trial.extend(self.position.iter().zip(&self.direction).map(|(&at, &way)| at + way * share));
        let is_finite = self.forces.accelerations(&self.trial, &mut self.there);
        is_finite.then(|| self.dot(&self.there, &self.direction))
    }

    /// One iteration, with the forces at its end evaluated if that `is_due`. Returns the error of those that were interpolated, as a share of
    /// them; `None` if forces are not finite where they were to be evaluated.
    fn iterate(&mut self, is_due: bool) -> Option<f64> {
        let trial = self.share.min(self.most);
        let Some(slope) = self.look(trial) else {
            self.share = 0.1 * trial;
            return None;
        };
        let share = if slope < self.slope { trial * self.slope / (self.slope - slope) } else { f64::INFINITY };
        // Round-off of forces that hardly change may call for any way.
        let share = share.min(FARTHER * trial).min(self.most);
        let part = share / trial;
        for (there, &here) in self.there.iter_mut().zip(&self.acceleration) {
            *there = here + (*there - here) * part;
        }
        if !is_due {
            self.go(share);
            return Some(0.0);
        }
        let guess = self.there.clone();
        let share = self.refine(share)?;
        let missed: Vec<_> = guess.iter().zip(&self.there).map(|(&guess, &found)| guess - found).collect();
        let error = self.dot(&missed, &missed) / self.dot(&self.there, &self.there);
        self.go(share);
        Some(error.sqrt())
    }

    /// Evaluates the forces after a share of the direction, and after others until they are nearly across it. Returns the last one.
    fn refine(&mut self, mut share: f64) -> Option<f64> {
        /// Forces across the direction have at most this share of those at its start.
        const ACROSS: f64 = 0.3;
        const TRIES: u32 = 10;
        for _ in 0..TRIES {
            let Some(slope) = self.look(share) else {
                share *= 0.1;
                continue;
            };
            if slope.abs() < ACROSS * self.slope || slope > 0.0 && share >= self.most {
                return Some(share);
            }
            let farther = if slope < self.slope { self.slope / (self.slope - slope) } else { f64::INFINITY };
            share = (share * farther.clamp(0.1, 3.0)).min(self.most);
        }
        let is_finite = self.look(share).is_some();
        self.share = if is_finite { share } else { 0.1 * share };
        is_finite.then_some(share)
    }

    /// Goes a share of the direction, to where the accelerations are those of the trial, and takes the next direction.
    fn go(&mut self, share: f64) {
        std::mem::swap(&mut self.acceleration, &mut self.there);
        self.find_lead();
        let before = self.dot(&self.lead, &self.there);
        let square = self.dot(&self.lead, &self.acceleration);
        let kept = (square - before) / std::mem::replace(&mut self.square, square);
        for (at, way) in self.position.iter_mut().zip(&self.direction) {
            *at += *way * share;
        }
        self.turn(kept.max(0.0));
        self.share = share;
    }
}
