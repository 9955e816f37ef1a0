//! The solvers of rotations: the angle error of each against its time for each element, for elements with different
//! increments since the last rotation and strains up to inversion, and the outcome of each for degenerate elements.
//!
//! All solvers are plain code in double precision, called for one element after another, like the reference code of the
//! simulation. They take turns, in a rotated order, and each time is the median of its turns: other load of the machine
//! affects all alike. Processor time is measured, or wall time if the system does not provide it.

mod closed_form;
mod degenerate;
mod mueller;
mod newton;
mod page;
mod reference;
mod sample;
mod solver;
#[cfg(test)]
#[path = "../../tests/inside/rotation.rs"]
mod solver_tests;
mod text;

use crate::spread::Spread;
use crate::study::{Findings, Study, Watch};
use crate::turns::{seconds, take_turns};
use degenerate::{CLASSES, Outcome};
use glam::DQuat;
use sample::{Kind, Sample};
use solver::Solver;
use std::hint::black_box;

/// The number of passes of iterations on degenerate elements. An iteration that has not converged by then stalls.
const MANY: u32 = 20;

/// The study.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rotation {
    /// Strains of elements.
    pub(crate) strains: Vec<f64>,
    /// Angles from the last rotation (rad).
    pub(crate) increments: Vec<f64>,
    /// The number of elements of each kind.
    pub(crate) elements: usize,
    /// The number of times that each solver processes them in a turn.
    pub(crate) repeats: u32,
    /// The number of turns of each solver.
    pub(crate) rounds: u32,
}

impl Rotation {
    pub(crate) fn usual() -> Self {
        Self {
            strains: vec![0.0, 0.1, 0.5, 0.9, 1.0, 1.5],
            increments: vec![1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0],
            elements: 512,
            repeats: 4,
            rounds: 15,
        }
    }

    /// The kinds of elements.
    fn kinds(&self) -> Vec<Kind> {
        let of = |&strain| self.increments.iter().map(move |&increment| Kind::Warm { strain, increment });
        self.strains.iter().flat_map(of).chain([Kind::Cold]).collect()
    }
}

impl Study for Rotation {
    fn work(&self) -> u64 {
        self.kinds().len() as u64 * u64::from(self.rounds) * solver::all().len() as u64
    }

    fn measure(&self, watch: &Watch<'_>) -> Option<Findings> {
        let results = measure(self, watch)?;
        let (text, tables) = (results.text(), vec![("rotation", results.table())]);
        Some(Findings { text, tables, page: Some(results.page()) })
    }
}

/// One solver on one kind of elements.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Measured {
    /// The number of the solver.
    solver: usize,
    /// The elements.
    kind: Kind,
    /// The median and the greatest error (rad); infinite if any result is not a number.
    pub(crate) median: f64,
    pub(crate) worst: f64,
    /// Time for each element (ns).
    pub(crate) time: Spread,
    /// The share of elements that needed the global solver, for the default.
    pub(crate) global: Option<f64>,
}

/// The findings on one machine.
#[derive(Clone, Debug)]
pub(crate) struct Results {
    protocol: Rotation,
    solvers: Vec<Solver>,
    measured: Vec<Measured>,
    /// The outcomes of each solver for each class, after [`MANY`] passes.
    outcomes: Vec<(&'static str, [Outcome; CLASSES.len()])>,
}

/// Measures all solvers; `None` if `watch`, which is called after each turn, stops the measurement.
pub(crate) fn measure(protocol: &Rotation, watch: &Watch<'_>) -> Option<Results> {
    let mut solvers = solver::all();
    let mut measured = Vec::new();
    for kind in protocol.kinds() {
        let (elements, sought): (Vec<_>, Vec<_>) = sample::samples(kind, protocol.elements).into_iter().unzip();
        let turn = |number: usize| {
            let work = black_box(&solvers[number]).work();
            let all = || (0..protocol.repeats).for_each(|_| elements.iter().for_each(|one| work(black_box(one))));
            seconds(all) * 1e9 / (f64::from(protocol.repeats) * elements.len() as f64)
        };
        // The first turns warm caches and are not counted.
        let _ = (0..solvers.len()).map(turn).sum::<f64>();
        let times = take_turns(solvers.len(), protocol.rounds, watch, turn)?;
        for (number, (solver, times)) in solvers.iter().zip(times).enumerate() {
            let error = |(element, &sought): (&Sample, &DQuat)| {
                let found = solver.rotation(element);
                if found.is_finite() { reference::angle(found, sought) } else { f64::INFINITY }
            };
            let mut errors: Vec<_> = elements.iter().zip(&sought).map(error).collect();
            errors.sort_by(f64::total_cmp);
            let globals: Option<Vec<bool>> = elements.iter().map(|one| solver.is_global(one)).collect();
            let share = |all: Vec<bool>| all.iter().filter(|&&one| one).count() as f64 / all.len() as f64;
            measured.push(Measured {
                solver: number,
                kind,
                median: errors[errors.len() / 2],
                worst: errors[errors.len() - 1],
                time: Spread::of(times),
                global: globals.map(share),
            });
        }
    }
    let all = solvers.clone();
    solvers.dedup_by_key(|solver| solver.name);
    let of_class = |solver: &Solver| CLASSES.map(|class| degenerate::outcome(&solver.with_passes(MANY), &class));
    let outcomes = solvers.iter().map(|solver| (solver.name, of_class(solver))).collect();
    Some(Results { protocol: protocol.clone(), solvers: all, measured, outcomes })
}
