//! The solvers of rotations: the angle error of each against its time for each element, for elements turned by more or
//! less since the last rotation and strained up to inversion, and what each makes of degenerate elements.
//!
//! All methods are plain code in double precision, called for one element after the other, as the reference code of the
//! simulation does. They take turns, in an order that is rotated, and each time is the median of its turns: other load of
//! the machine affects all alike. Processor time is measured, or wall time if the system does not provide it.

pub(crate) mod degenerate;
pub(crate) mod method;
mod reference;
pub(crate) mod sample;
#[cfg(test)]
#[path = "tests.rs"]
mod solver_tests;
mod text;

use crate::output::Clock;
use crate::table::{Spread, Watch, take_turns};
use degenerate::{CLASSES, Outcome};
use glam::DQuat;
use method::Method;
use sample::{Kind, Sample};
use std::hint::black_box;

/// The number of passes of iterations on degenerate elements: what has not converged by then stalls.
const MANY: u32 = 20;

/// What is measured.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Protocol {
    /// Strains of elements.
    pub(crate) strains: Vec<f64>,
    /// Angles from the last rotation (rad).
    pub(crate) increments: Vec<f64>,
    /// The number of elements of each kind.
    pub(crate) elements: usize,
    /// How often each method goes through them in a turn.
    pub(crate) repeats: u32,
    /// The number of turns of each method.
    pub(crate) rounds: u32,
}

impl Default for Protocol {
    fn default() -> Self {
        Self {
            strains: vec![0.0, 0.1, 0.5, 0.9, 1.0, 1.5],
            increments: vec![1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0],
            elements: 512,
            repeats: 4,
            rounds: 15,
        }
    }
}

impl Protocol {
    /// The kinds of elements.
    fn kinds(&self) -> Vec<Kind> {
        let of = |&strain| self.increments.iter().map(move |&increment| Kind::Warm { strain, increment });
        self.strains.iter().flat_map(of).chain([Kind::Cold]).collect()
    }

    /// The number of turns of all methods, which is the sum of what [`measure`] reports.
    pub(crate) fn work(&self) -> u64 {
        self.kinds().len() as u64 * u64::from(self.rounds) * method::all().len() as u64
    }
}

/// One method on one kind of elements.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Measured {
    /// The number of the method.
    method: usize,
    /// The elements.
    kind: Kind,
    /// The median and the greatest error (rad); infinite if any result is not a number.
    pub(crate) median: f64,
    /// The greatest error (rad).
    pub(crate) worst: f64,
    /// Time for each element (ns).
    pub(crate) time: Spread,
    /// The share of elements that needed the global solver, for the default.
    pub(crate) global: Option<f64>,
}

/// What was found on one machine.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Results {
    protocol: Protocol,
    methods: Vec<Method>,
    measured: Vec<Measured>,
    /// What each solver makes of each class, after [`MANY`] passes.
    outcomes: Vec<(Method, [Outcome; CLASSES.len()])>,
    /// Whether times are processor time.
    is_processor_time: bool,
}

/// Measures all methods; `None` if `watch`, which is called after each turn, stops the measurement.
pub(crate) fn measure(protocol: &Protocol, watch: &Watch<'_>) -> Option<Results> {
    let methods = method::all();
    let is_processor_time = Clock::thread().spent().cpu.is_some();
    let mut measured = Vec::new();
    for kind in protocol.kinds() {
        let (elements, sought): (Vec<_>, Vec<_>) = sample::samples(kind, protocol.elements).into_iter().unzip();
        let turn = |number: usize| {
            let (method, clock) = (black_box(&methods[number]), Clock::thread());
            for _ in 0..protocol.repeats {
                elements.iter().for_each(|element| method.work(black_box(element)));
            }
            let spent = clock.spent();
            spent.cpu.unwrap_or(spent.wall) * 1e9 / (f64::from(protocol.repeats) * elements.len() as f64)
        };
        // The first turns warm caches and are not counted.
        let _ = (0..methods.len()).map(turn).sum::<f64>();
        let times = take_turns(methods.len(), protocol.rounds, watch, turn)?;
        for (number, (method, times)) in methods.iter().zip(times).enumerate() {
            let mut errors: Vec<_> =
                elements.iter().zip(&sought).map(|(one, &sought)| error(method, one, sought)).collect();
            errors.sort_by(f64::total_cmp);
            let globals: Option<Vec<bool>> = elements.iter().map(|one| method.is_global(one)).collect();
            let share = |all: Vec<bool>| all.iter().filter(|&&one| one).count() as f64 / all.len() as f64;
            measured.push(Measured {
                method: number,
                kind,
                median: errors[errors.len() / 2],
                worst: errors[errors.len() - 1],
                time: Spread::of(times),
                global: globals.map(share),
            });
        }
    }
    let mut solvers: Vec<_> = methods.iter().map(|method| method.with_passes(MANY)).collect();
    solvers.dedup();
    let outcomes = solvers.into_iter().map(|solver| {
        let outcomes = CLASSES.map(|class| degenerate::outcome(&solver, &class));
        (solver, outcomes)
    });
    let outcomes = outcomes.collect();
    Some(Results { protocol: protocol.clone(), methods, measured, outcomes, is_processor_time })
}

/// The angle error of a method (rad).
fn error(method: &Method, element: &Sample, sought: DQuat) -> f64 {
    let found = method.rotation(element);
    if found.is_finite() { reference::angle(found, sought) } else { f64::INFINITY }
}

impl Results {
    /// The methods with their numbers.
    pub(crate) fn methods(&self) -> Vec<(usize, &Method)> {
        self.methods.iter().enumerate().collect()
    }

    /// A method at a strain, with its increments (rad).
    pub(crate) fn of(&self, method: usize, strain: f64) -> impl Iterator<Item = (f64, &Measured)> {
        self.measured.iter().filter(move |one| one.method == method).filter_map(move |one| match one.kind {
            Kind::Warm { strain: own, increment } if own == strain => Some((increment, one)),
            _ => None,
        })
    }

    /// A method at a strain and an increment (rad).
    pub(crate) fn at(&self, method: usize, strain: f64, increment: f64) -> Option<&Measured> {
        self.of(method, strain).find(|(own, _)| *own == increment).map(|(_, one)| one)
    }

    /// A method on elements with any stretches and any last rotation.
    fn cold(&self, method: usize) -> Option<&Measured> {
        self.measured.iter().find(|one| one.method == method && one.kind == Kind::Cold)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quick() -> Protocol {
        Protocol { strains: vec![0.5], increments: vec![0.01, 0.3], elements: 8, repeats: 1, rounds: 2 }
    }

    #[test]
    fn every_method_on_every_kind_of_elements() {
        let turns = std::sync::atomic::AtomicU64::new(0);
        let count = |more| turns.fetch_add(more, std::sync::atomic::Ordering::Relaxed) < u64::MAX;
        let results = measure(&quick(), &count).expect("it is never stopped");
        assert_eq!(turns.into_inner(), quick().work());
        assert_eq!(results.measured.len(), 3 * results.methods.len());
        assert!(results.measured.iter().all(|one| one.time.least >= 0.0 && one.time.most.is_finite()));
        assert_eq!(measure(&quick(), &|_| false), None);
    }

    #[test]
    fn columns_are_documented() {
        let results = measure(&quick(), &|_| true).expect("it is never stopped");
        let page = include_str!("../../../docs/files.md");
        let section = page.split("\n## ").find(|section| section.starts_with("`rotation.csv`")).expect("its section");
        let cells = section.lines().filter_map(|line| line.strip_prefix("| `")?.split(" | ").next());
        let documented: Vec<_> = cells.flat_map(|cell| cell.split(", ")).map(|name| name.trim_matches('`')).collect();
        let csv = results.csv();
        assert_eq!(csv.lines().next().expect("heads").split(',').collect::<Vec<_>>(), documented);
        assert_eq!(csv.lines().count(), 1 + results.measured.len());
    }

    #[test]
    fn errors_are_the_same_on_every_run() {
        let errors = || {
            let results = measure(&quick(), &|_| true).expect("it is never stopped");
            results.measured.iter().map(|one| (one.median, one.worst)).collect::<Vec<_>>()
        };
        assert_eq!(errors(), errors());
    }
}
