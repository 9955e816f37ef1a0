//! Table 1 of the paper (section 4): the errors of the rotations from Eq. (15).
//!
//! One free cube of side 0.1 m with 1 kg in each corner falls, until its lowest corner has fallen 1 m, "ten times the
//! height of the size of the cube", onto a floor with restitution 1. For 10 s from the step that ends with the first
//! contact, α of Eq. (18) is computed at every evaluation of the forces. Semi-implicit Euler, no damping, no friction.
//! The paper gives neither the orientation of the cube nor the number of starts, and the motion is chaotic: so there
//! are many starts at rest, with random orientations. The cubes of several starts are simulated together.

mod page;
mod printed;
mod text;

use crate::spread::Spread;
use crate::study::{Findings, Study, Watch, built_in, each};
use glam::{DVec3, DVec4, Vec4Swizzles};
use localshape::Scene;
use localshape::internals::random_unit;
use localshape::sim::{Assembly, State, Status};
use printed::{Printed, PrintedRow, ROWS, STIFFNESSES};
use rayon::prelude::*;
use std::cmp::Reverse;
use std::sync::Arc;

/// The paper's solver, then the exact one, by their names in scenes.
pub(crate) const SOLVERS: [&str; 2] = ["arctangent", "robust"];

/// The study.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Table1 {
    /// Number of starts with random orientations. A start does not depend on their number or on the machine.
    pub(crate) orientations: u32,
    /// Duration of the measurement from the first contact (s).
    pub(crate) duration: f64,
    /// The largest k/m that is measured (1/s²).
    pub(crate) stiffest: f64,
}

impl Table1 {
    /// The usual number of starts.
    pub(crate) const ORIENTATIONS: u32 = 51;

    /// The paper's 10 s and all its values of k/m.
    pub(crate) fn new(orientations: u32) -> Self {
        Self { orientations, duration: 10.0, stiffest: f64::INFINITY }
    }
}

impl Study for Table1 {
    fn work(&self) -> u64 {
        u64::from(self.orientations) * self.cases().iter().map(|case| self.evaluations(case)).sum::<u64>()
    }

    fn measure(&self, watch: &Watch<'_>) -> Option<Findings> {
        let results = measure(self, watch)?;
        let tables = vec![("table1", results.summary_table()), ("table1-orientations", results.start_table())];
        Some(Findings { text: results.text(), tables, page: Some(results.page()) })
    }
}

/// One solver in one row at one k/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Case {
    pub(crate) solver: &'static str,
    pub(crate) row: PrintedRow,
    /// Index of its k/m in [`STIFFNESSES`].
    pub(crate) stiffness: usize,
}

impl Case {
    /// k/m (1/s²).
    pub(crate) fn stiffness_over_mass(&self) -> f64 {
        STIFFNESSES[self.stiffness]
    }

    /// ΔT (s).
    pub(crate) fn step(&self) -> f64 {
        self.row.cases[self.stiffness].0
    }

    /// The paper's result, if this is its solver.
    pub(crate) fn printed(&self) -> Option<Printed> {
        (self.solver == SOLVERS[0]).then_some(self.row.cases[self.stiffness].1)
    }

    /// Number of passes, each of which solves Eq. (15); `None` for solvers without passes.
    pub(crate) fn passes(&self) -> Option<u32> {
        self.printed().map(|_| self.row.passes)
    }

    /// Unique among all cases.
    fn name(&self) -> String {
        format!("{} {} {:e}", self.solver, self.row.name, self.stiffness_over_mass())
    }
}

impl Table1 {
    /// All cases for each start, sorted by solver, k/m and row.
    pub(crate) fn cases(&self) -> Vec<Case> {
        let wanted = |stiffness: &usize| STIFFNESSES[*stiffness] <= self.stiffest;
        let mut cases = Vec::new();
        for solver in SOLVERS {
            for stiffness in (0..STIFFNESSES.len()).filter(wanted) {
                let rows = ROWS.into_iter().filter(|row| solver == SOLVERS[0] || row.passes == 1);
                cases.extend(rows.map(|row| Case { solver, row, stiffness }));
            }
        }
        cases
    }

    /// Number of evaluations of α in one start of a case.
    fn evaluations(&self, case: &Case) -> u64 {
        (self.duration / case.step()).round() as u64
    }
}

/// The initial orientation of the cube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Orientation {
    /// The axis, a unit vector.
    pub(crate) axis: DVec3,
    /// The angle (rad).
    pub(crate) angle: f64,
}

impl Orientation {
    /// A sequence of uniformly distributed rotations: the first hashed point for this number that is in the unit ball
    /// of four dimensions, as a quaternion.
    pub(crate) fn random(number: u32) -> Self {
        const SEED: u32 = 1;
        let coordinate = |usage: u64| 2.0 * random_unit(SEED, u64::from(number), usage) - 1.0;
        let point = |attempt: u64| DVec4::from_array([0, 1, 2, 3].map(|axis| coordinate(4 * attempt + axis)));
        // Near the centre, directions have few digits.
        let usable = |point: &DVec4| (1e-6..=1.0).contains(&point.length_squared());
        let point = (0..).map(point).find(usable).expect("three of ten points lie in the ball");
        let vector = point.xyz();
        Self { axis: vector.normalize_or(DVec3::X), angle: 2.0 * libm::atan2(vector.length(), point.w) }
    }
}

/// The result of one start in one case: running statistics of α.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Statistics {
    /// Number of evaluations of α; fewer than planned if the simulation diverged.
    pub(crate) evaluations: u64,
    mean: f64,
    /// The sum of the squares of the distances from the mean.
    squares: f64,
    maximum: f64,
    /// Whether the simulation diverged.
    pub(crate) diverged: bool,
}

impl Statistics {
    fn add(&mut self, residual: f64) {
        self.evaluations += 1;
        // Welford 1962: avoids differences of large sums.
        let before = residual - self.mean;
        self.mean += before / self.evaluations as f64;
        self.squares += before * (residual - self.mean);
        // NaN is kept, as in the mean.
        if self.evaluations == 1 || !(self.maximum.is_nan() || self.maximum > residual) {
            self.maximum = residual;
        }
    }

    /// The mean, the standard deviation over all evaluations, and the maximum of α (rad/s²); NaN without evaluations.
    pub(crate) fn numbers(&self) -> [f64; 3] {
        let Self { evaluations, mean, squares, maximum, .. } = *self;
        if evaluations == 0 { [f64::NAN; 3] } else { [mean, (squares / evaluations as f64).sqrt(), maximum] }
    }
}

/// The results of the measurement.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Results {
    protocol: Table1,
    cases: Vec<Case>,
    orientations: Vec<Orientation>,
    /// The statistics of each start in each case.
    statistics: Vec<Statistics>,
}

/// The results of all starts in one case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Summary {
    pub(crate) case: Case,
    /// The means of all starts (rad/s²).
    pub(crate) mean: Spread,
    /// Their standard deviations (rad/s²).
    pub(crate) deviation: Spread,
    /// Their maxima (rad/s²).
    pub(crate) maximum: Spread,
    /// Number of starts that diverged.
    pub(crate) diverged: usize,
}

/// Measures Table 1 with the rayon thread pool of the caller; `None` if `watch`, which is called with the number of
/// further evaluations of α, stops the measurement. The result has the same bits for any number of threads.
pub(crate) fn measure(protocol: &Table1, watch: &Watch<'_>) -> Option<Results> {
    let cases = protocol.cases();
    let orientations: Vec<_> = (0..protocol.orientations).map(Orientation::random).collect();
    let starts = each(&orientations, &|_| watch(0), |orientation| start(orientation, &cases))?;
    let crowds: Vec<_> = starts.chunks(CROWD).collect();
    // The longest tasks come first, so that no thread is left with one of them at the end.
    let mut tasks: Vec<_> = (0..crowds.len() * cases.len()).collect();
    tasks.sort_by_key(|at| Reverse(protocol.evaluations(&cases[at % cases.len()])));
    let of_crowds = tasks.into_iter().par_bridge().map(|at| {
        let (crowd, case) = (at / cases.len(), at % cases.len());
        Some((at, measure_starts(crowds[crowd], case, protocol.evaluations(&cases[case]), watch)?))
    });
    let mut of_crowds: Vec<(usize, Vec<Statistics>)> = of_crowds.collect::<Option<_>>()?;
    of_crowds.sort_by_key(|&(at, _)| at);
    let start =
        |at: usize| of_crowds[at / CROWD * cases.len()..][..cases.len()].iter().map(move |(_, all)| all[at % CROWD]);
    let statistics = (0..starts.len()).flat_map(start).collect();
    Some(Results { protocol: *protocol, cases, orientations, statistics })
}

/// Number of cubes simulated together, as one body. With a single cube the overhead of a step would be as long as the
/// step, and lanes would be unused. The cubes do not touch, and their bits do not depend on the others.
const CROWD: usize = 32;

/// The corners of a cube.
const CORNERS: usize = 8;

/// The scene of one start, with a run for each case.
fn start(orientation: &Orientation, cases: &[Case]) -> Scene {
    let Orientation { axis: DVec3 { x, y, z }, angle } = orientation;
    let mut text = format!(
        "gravity = [0, -9.8, 0]
        time.duration = 1
        obstacle = [{{ kind = 'floor', restitution = 1, friction = 0 }}]
        [body]
        lattice = {{ cells = [1, 1, 1], side = 0.1 }}
        mass = 1
        rotation = {{ axis = [{x:?}, {y:?}, {z:?}], angle = {angle:?} }}
        lowest = 1
        "
    );
    for case in cases {
        let (name, rotation, stiffness) = (case.name(), case.solver, case.stiffness_over_mass());
        let passes = case.passes().map_or(String::new(), |passes| format!(", passes = {passes}"));
        // With other round-off, chaotic motion would give other numbers. Without passes, α is round-off itself.
        let kernel = if case.passes().is_some() { "reference" } else { "fast" };
        text += &format!(
            "[[run]]
            name = '{name}'
            step = {:?}
            kernel = '{kernel}'
            model = {{ kind = 'shape-based', stiffness = {stiffness:?}, rotation = '{rotation}'{passes} }}
            ",
            case.step()
        );
    }
    built_in(&text, "table1")
}

/// The cubes of several starts as one body.
fn crowd<'a>(starts: impl Iterator<Item = &'a Scene>, first: &Scene) -> Scene {
    let (mut bodies, mut initial) = (Vec::new(), State::default());
    for start in starts {
        let run = &start.runs[0];
        bodies.push(Arc::clone(run.body()));
        initial.position.extend_from_slice(&run.initial.position);
        initial.velocity.extend_from_slice(&run.initial.velocity);
    }
    let bodies = Arc::new(Assembly::from(Assembly::new(bodies).whole()));
    let mut scene = first.clone();
    for run in &mut scene.runs {
        (run.bodies, run.initial) = (Arc::clone(&bodies), initial.clone());
    }
    scene
}

/// Simulates one or more starts in one case.
fn measure_starts(starts: &[Scene], case: usize, evaluations: u64, watch: &Watch<'_>) -> Option<Vec<Statistics>> {
    /// Number of steps between calls of the watch.
    const SLICE: u64 = 512;
    // Never one cube alone: it would be a lattice, whose kernel has different round-off.
    let cubes = starts.iter().chain(starts).take(starts.len().max(2));
    let mut world = crowd(cubes, &starts[0]).world(case);
    let mut has_landed = vec![false; starts.len()];
    let mut statistics = vec![Statistics::default(); starts.len()];
    let all = evaluations * starts.len() as u64;
    let (mut taken, mut reported) = (0, 0);
    let mut before = Vec::new();
    while taken < all {
        before.clone_from(&world.state().position);
        world.advance(1);
        if world.status() != Status::Ok {
            break;
        }
        // They are not needed before the first cube has landed.
        let alphas = if has_landed.contains(&true) { world.residuals(0, &before) } else { Vec::new() };
        for (at, statistics) in statistics.iter_mut().enumerate() {
            if !has_landed[at] {
                // Only the floor can make a corner move upwards.
                let velocities = &world.state().velocity[at * CORNERS..][..CORNERS];
                has_landed[at] = velocities.iter().any(|velocity| velocity.y > 0.0);
            } else if statistics.evaluations < evaluations {
                statistics.add(alphas[at]);
                taken += 1;
            }
        }
        if world.steps() % SLICE == 0 {
            if !watch(taken - reported) {
                return None;
            }
            reported = taken;
        }
    }
    let diverged = world.status() != Status::Ok;
    if diverged && starts.len() > 1 {
        // A divergence stops all cubes, so each start is repeated alone.
        let alone = |start| measure_starts(std::slice::from_ref(start), case, evaluations, &|_| watch(0));
        let statistics = starts.iter().map(alone).collect::<Option<Vec<_>>>()?.concat();
        return watch(all - reported).then_some(statistics);
    }
    if diverged && has_landed[0] {
        // The rejected step had evaluated its forces in this state.
        statistics[0].add(world.report(0).residual.unwrap_or(f64::NAN));
    }
    statistics.iter_mut().for_each(|one| one.diverged = diverged);
    watch(all - reported).then_some(statistics)
}

impl Results {
    /// The results of all starts, case by case in the order of [`Table1::cases`].
    pub(crate) fn summaries(&self) -> Vec<Summary> {
        let summary = |(at, &case): (usize, &Case)| {
            let of_starts = || self.statistics.iter().skip(at).step_by(self.cases.len());
            let [mean, deviation, maximum] =
                [0, 1, 2].map(|number| Spread::of(of_starts().map(|one| one.numbers()[number])));
            Summary { case, mean, deviation, maximum, diverged: of_starts().filter(|one| one.diverged).count() }
        };
        self.cases.iter().enumerate().map(summary).collect()
    }
}

#[cfg(test)]
#[path = "../../tests/inside/table1.rs"]
mod tests;
