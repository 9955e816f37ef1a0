//! The ratio of computation times at the end of section 4 of the paper: 1.05 for the shape model and mass-spring.
//!
//! The paper gives neither body, springs nor machine. Here a block of cubes stands on a floor, the shape model has two
//! passes of Eq. (15), as the paper advises, and both models are vectorised. Whole steps are timed, as in a simulation,
//! and each named arrangement of springs has its own ratio. The models are measured in turns of a few milliseconds, and
//! each ratio is one of adjacent turns, so that other load of the machine affects both. With one thread, processor time
//! is measured, which does not include other processes; with more threads, or if the system does not provide it, wall
//! time.

use crate::spread::Spread;
use crate::study::{Findings, Study, Watch, built_in};
use crate::table::{Table, figure};
use crate::turns::{kind_of_time, seconds, spent, take_turns};
use localshape::Scene;
use localshape::internals::typed;
use localshape::sim::Springs;

/// Computation time of the shape model divided by that of mass-spring, as printed in section 4.
pub(crate) const PRINTED: f64 = 1.05;

/// The arrangements of springs that are compared.
pub(crate) const SPRINGS: [Springs; 5] =
    [Springs::Edges, Springs::EdgesOneDiagonal, Springs::EdgesFaceDiagonals, Springs::EdgesBodyDiagonals, Springs::All];

/// The study.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Ratio {
    /// Cubes along each side of the blocks.
    pub(crate) sides: Vec<u32>,
    /// The number of turns of each model.
    pub(crate) rounds: u32,
    /// Cubes times steps in one turn.
    pub(crate) turn: u64,
    pub(crate) threads: usize,
}

impl Ratio {
    /// The blocks range from one that fits into any cache to one that fits into few.
    pub(crate) fn new(threads: usize) -> Self {
        Self { sides: vec![3, 10, 20], rounds: 41, turn: 640_000, threads }
    }

    /// The kind of time of all turns, so that no ratio mixes two: with one thread its own time, else wall time.
    fn kind_of_time(&self) -> &'static str {
        if self.threads == 1 { kind_of_time() } else { "wall" }
    }
}

impl Study for Ratio {
    fn work(&self) -> u64 {
        self.sides.len() as u64 * u64::from(self.rounds) * (1 + SPRINGS.len() as u64)
    }

    fn measure(&self, watch: &Watch<'_>) -> Option<Findings> {
        let ratios = measure(self, watch)?;
        Some(Findings { text: ratios.text(), tables: vec![("ratio", ratios.table())], page: None })
    }
}

/// The shape model and one arrangement of springs on one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Comparison {
    /// Cubes along each side, and in the block.
    pub(crate) side: u32,
    pub(crate) cubes: u64,
    /// The arrangement of springs.
    pub(crate) springs: Springs,
    /// The number of springs.
    pub(crate) count: usize,
    /// Time of the shape model for one cube and step (ns).
    pub(crate) shape: Spread,
    /// Time of mass-spring for one cube and step (ns).
    pub(crate) mass_spring: Spread,
    /// The ratio of both times, turn by turn.
    pub(crate) ratio: Spread,
}

/// The ratios, measured on one machine.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ratios {
    protocol: Ratio,
    /// Block by block, in the order of [`SPRINGS`].
    pub(crate) comparisons: Vec<Comparison>,
}

/// Measures with the rayon thread pool of the caller; `None` if `watch`, which is called after each turn, stops it.
pub(crate) fn measure(protocol: &Ratio, watch: &Watch<'_>) -> Option<Ratios> {
    let mut comparisons = Vec::new();
    for &side in &protocol.sides {
        let scene = block(side);
        let mut worlds: Vec<_> = (0..scene.runs.len()).map(|run| scene.world(run)).collect();
        let cubes = scene.runs[0].body().elements().len() as u64;
        let steps = (protocol.turn / cubes).max(1);
        // The first access to memory is not timed.
        worlds.iter_mut().for_each(|world| world.advance(1));
        // ns for one cube and step.
        let times = take_turns(worlds.len(), protocol.rounds, watch, |run| {
            let task = || worlds[run].advance(steps);
            let time = if protocol.threads == 1 { seconds(task) } else { spent(task).wall };
            time * 1e9 / (steps * cubes) as f64
        })?;
        let (shape, others) = times.split_first()?;
        for ((&springs, times), run) in SPRINGS.iter().zip(others).zip(&scene.runs[1..]) {
            comparisons.push(Comparison {
                side,
                cubes,
                springs,
                count: run.models[0].springs().len(),
                shape: Spread::of(shape.iter().copied()),
                mass_spring: Spread::of(times.iter().copied()),
                ratio: Spread::of(shape.iter().zip(times).map(|(shape, springs)| shape / springs)),
            });
        }
    }
    Some(Ratios { protocol: protocol.clone(), comparisons })
}

/// A block of cubes on a floor: the shape model, then each arrangement of springs.
fn block(side: u32) -> Scene {
    let mut text = format!(
        "gravity = [0, -9.8, 0]
        time = {{ duration = 1, step = 'T/50' }}
        body = {{ lattice = {{ cells = [{side}, {side}, {side}], side = 0.1 }}, mass = 1, lowest = 0 }}
        obstacle = [{{ kind = 'floor', restitution = 0.5, friction = 0.3, friction_of = 'velocity' }}]
        [[run]]
        name = 'shape'
        model = {{ kind = 'shape-based', stiffness = 1e4, damping_ratio = 0.1, passes = 2 }}
        "
    );
    for springs in SPRINGS.map(|springs| typed(&springs)) {
        text += &format!(
            "[[run]]
            name = '{springs}'
            model = {{ kind = 'mass-spring', stiffness = 1e4, damping_ratio = 0.1, springs = '{springs}' }}
            "
        );
    }
    built_in(&text, "ratio")
}

impl Ratios {
    /// The table as text.
    fn text(&self) -> String {
        let Ratio { threads, rounds, .. } = self.protocol;
        let row = |one: &Comparison| {
            let per_cube = one.count as f64 / one.cubes as f64;
            let Spread { lower, median, upper, .. } = one.ratio;
            [
                ("cubes", format!("{}³", one.side).into()),
                ("springs", typed(&one.springs).into()),
                ("springs per cube", figure(per_cube).into()),
                ("shape, ns per cube", figure(one.shape.median).into()),
                ("springs, ns per cube", figure(one.mass_spring.median).into()),
                ("springs, ns per spring", figure(one.mass_spring.median / per_cube).into()),
                ("ratio", format!("{} ({} – {})", figure(median), figure(lower), figure(upper)).into()),
                ("paper", PRINTED.to_string().into()),
            ]
        };
        format!(
            include_str!("ratio.md"),
            kind_of_time = self.protocol.kind_of_time(),
            threads = format_args!("{threads} thread{}", if threads == 1 { "" } else { "s" }),
            machine = format_args!("{} {}", std::env::consts::ARCH, std::env::consts::OS),
            rounds = rounds,
            printed = PRINTED,
            table = Table::of(self.comparisons.iter().map(row)).markdown(2),
        )
    }

    /// All numbers, with all digits.
    fn table(&self) -> Table {
        let row = |one: &Comparison| {
            [
                ("cubes", one.cubes.into()),
                ("springs", typed(&one.springs).into()),
                ("spring_count", one.count.into()),
                ("threads", self.protocol.threads.into()),
                ("time", self.protocol.kind_of_time().into()),
                ("rounds", self.protocol.rounds.into()),
                ("shape_ns_median", one.shape.median.into()),
                ("shape_ns_lower", one.shape.lower.into()),
                ("shape_ns_upper", one.shape.upper.into()),
                ("springs_ns_median", one.mass_spring.median.into()),
                ("springs_ns_lower", one.mass_spring.lower.into()),
                ("springs_ns_upper", one.mass_spring.upper.into()),
                ("ratio_median", one.ratio.median.into()),
                ("ratio_lower", one.ratio.lower.into()),
                ("ratio_upper", one.ratio.upper.into()),
                ("ratio_least", one.ratio.least.into()),
                ("ratio_most", one.ratio.most.into()),
            ]
        };
        Table::of(self.comparisons.iter().map(row))
    }
}

#[cfg(test)]
#[path = "../tests/inside/ratio.rs"]
mod tests;
