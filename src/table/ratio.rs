//! The ratio of computation times at the end of section 4 of the paper: 1.05 for the shape model and mass-spring.
//!
//! The paper gives neither body, springs nor machine. Here a block of cubes stands on a floor, the shape model has two
//! passes of Eq. (15), as the paper advises, and both models are vectorised. Whole steps are timed, as in a simulation,
//! and each named arrangement of springs has its own ratio. The models are measured in turns of a few milliseconds, and
//! each ratio is one of adjacent turns, so that other load of the machine affects both. With one thread, processor time
//! is measured, which does not include other processes; with more threads, or if the system does not provide it, wall
//! time.

use super::sheet::figure;
use super::{Sheet, Spread, Watch, scene, take_turns};
use crate::output::{Clock, Spent, exact};
use crate::scene::Scene;
use crate::sim::topology::Springs;
use crate::sim::words::typed;
use serde::Serialize;
use serde_json::{Value, json};

/// The names of the table's files: Markdown and CSV.
pub const FILES: [&str; 2] = ["ratio.md", "ratio.csv"];

/// The mark of the Markdown file, which records the options of the table.
pub fn mark(threads: usize) -> String {
    match threads {
        1 => "localshape table ratio".to_owned(),
        threads => format!("localshape table ratio --threads {threads}"),
    }
}

/// Computation time of the shape model divided by that of mass-spring, as printed in section 4.
pub const PRINTED: f64 = 1.05;

/// The arrangements of springs that are compared.
pub const SPRINGS: [Springs; 5] =
    [Springs::Edges, Springs::EdgesOneDiagonal, Springs::EdgesFaceDiagonals, Springs::EdgesBodyDiagonals, Springs::All];

/// What is measured.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Protocol {
    /// Cubes along each side of the blocks.
    pub sides: Vec<u32>,
    /// The number of turns of each model.
    pub rounds: u32,
    /// Cubes times steps in one turn.
    pub turn: u64,
}

impl Default for Protocol {
    /// From a body that fits into any cache to one that fits into few.
    fn default() -> Self {
        Self { sides: vec![3, 10, 20], rounds: 41, turn: 640_000 }
    }
}

impl Protocol {
    /// The total number of turns, which is the sum of what [`measure`] reports.
    pub fn work(&self) -> u64 {
        self.sides.len() as u64 * u64::from(self.rounds) * (1 + SPRINGS.len() as u64)
    }
}

/// The shape model and one arrangement of springs on one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Cubes along each side.
    pub side: u32,
    /// The arrangement of springs.
    pub springs: Springs,
    /// The number of springs.
    pub count: usize,
    /// Time of the shape model for one cube and step (ns).
    pub shape: Spread,
    /// Time of mass-spring for one cube and step (ns).
    pub mass_spring: Spread,
    /// The first divided by the second, turn by turn.
    pub ratio: Spread,
}

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Time {
    /// Processor time of one thread.
    Processor,
    /// Wall time.
    Wall,
}

impl Time {
    /// One kind of time for all turns, so that no ratio mixes two: processor time for one thread, if the system
    /// provides it.
    fn of(threads: usize, has_processor_time: bool) -> Self {
        if threads == 1 && has_processor_time { Self::Processor } else { Self::Wall }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Processor => "processor",
            Self::Wall => "wall",
        }
    }

    /// In seconds. Wall time, should the system stop providing processor time.
    fn of_spent(self, spent: Spent) -> f64 {
        spent.cpu.filter(|_| self == Self::Processor).unwrap_or(spent.wall)
    }
}

/// The ratios, measured on a number of threads of one machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Ratios {
    threads: usize,
    time: Time,
    rounds: u32,
    /// Block by block, in the order of [`SPRINGS`].
    pub comparisons: Vec<Comparison>,
}

/// Measures the ratios with the rayon thread pool of the caller; `None` if `watch`, which is called after each turn,
/// stops the measurement.
pub fn measure(protocol: &Protocol, watch: &Watch<'_>) -> Option<Ratios> {
    let mut comparisons = Vec::new();
    let threads = rayon::current_num_threads();
    let time = Time::of(threads, Clock::thread().spent().cpu.is_some());
    for &side in &protocol.sides {
        let scene = block(side);
        let mut worlds: Vec<_> = (0..scene.runs.len()).map(|run| scene.world(run)).collect();
        let cubes = scene.body.elements.len() as u64;
        let steps = (protocol.turn / cubes).max(1);
        // The first access to memory is not timed.
        worlds.iter_mut().for_each(|world| world.advance(1));
        // ns for one cube and step.
        let times = take_turns(worlds.len(), protocol.rounds, watch, |run| {
            let clock = Clock::thread();
            worlds[run].advance(steps);
            time.of_spent(clock.spent()) * 1e9 / (steps * cubes) as f64
        })?;
        let (shape, others) = times.split_first()?;
        for ((&springs, times), run) in SPRINGS.iter().zip(others).zip(&scene.runs[1..]) {
            comparisons.push(Comparison {
                side,
                springs,
                count: run.model.springs().len(),
                shape: Spread::of(shape.iter().copied()),
                mass_spring: Spread::of(times.iter().copied()),
                ratio: Spread::of(shape.iter().zip(times).map(|(shape, springs)| shape / springs)),
            });
        }
    }
    Some(Ratios { threads, time, rounds: protocol.rounds, comparisons })
}

/// A block of cubes that stands on a floor: the shape model, then each arrangement of springs.
fn block(side: u32) -> Scene {
    let mut text = format!(
        "gravity = [0, -9.8, 0]
        time = {{ duration = 1, step = 'T/50' }}
        body = {{ lattice = {{ cells = [{side}, {side}, {side}], side = 0.1 }}, mass = 1, lowest = 0 }}
        obstacle = [{{ kind = 'floor', restitution = 0.5, friction = 0.3 }}]
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
    scene(&text, "ratio")
}

impl Ratios {
    /// The contents of [`FILES`].
    pub fn files(&self) -> [String; 2] {
        [self.markdown(), self.sheet().csv()]
    }

    /// The table for people.
    pub fn markdown(&self) -> String {
        let (threads, rounds, time) = (self.threads, self.rounds, self.time.name());
        let mut text = format!(
            "<!-- {} -->\n\
            # Computation time of the shape model over that of mass-spring\n\n\
            Whole steps of blocks of cubes on a floor, {time} time of {threads} thread{} ({} {}). Both models are vectorised \
            (`kernel = \"fast\"`): the shape model, with two passes of Eq. (15), by the fused kernel of lattices, mass-spring by \
            the kernel of springs that repeat from node to node. Medians of {rounds} rounds in which all models take turns, \
            of ratios with their quartiles in parentheses. The paper \
            gives {PRINTED}, without naming body, springs and machine. Other machines, and other load on this one, give \
            other times. Springs that cubes share are computed once.\n\n",
            mark(threads),
            if threads == 1 { "" } else { "s" },
            std::env::consts::ARCH,
            std::env::consts::OS,
        );
        let row = |one: &Comparison| {
            let per_cube = one.per_cube();
            let Spread { lower, median, upper, .. } = one.ratio;
            [
                ("cubes", format!("{}³", one.side)),
                ("springs", typed(&one.springs)),
                ("springs per cube", figure(per_cube)),
                ("shape, ns per cube", figure(one.shape.median)),
                ("springs, ns per cube", figure(one.mass_spring.median)),
                ("springs, ns per spring", figure(one.mass_spring.median / per_cube)),
                ("ratio", format!("{} ({} – {})", figure(median), figure(lower), figure(upper))),
                ("paper", PRINTED.to_string()),
            ]
        };
        text += &Sheet::of(self.comparisons.iter().map(row)).markdown(2);
        text
    }

    /// The table as CSV data, with all digits.
    fn sheet(&self) -> Sheet {
        let row = |one: &Comparison| {
            [
                ("cubes", one.cubes().to_string()),
                ("springs", typed(&one.springs)),
                ("spring_count", one.count.to_string()),
                ("threads", self.threads.to_string()),
                ("time", self.time.name().to_owned()),
                ("rounds", self.rounds.to_string()),
                ("shape_ns_median", exact(one.shape.median)),
                ("shape_ns_lower", exact(one.shape.lower)),
                ("shape_ns_upper", exact(one.shape.upper)),
                ("springs_ns_median", exact(one.mass_spring.median)),
                ("springs_ns_lower", exact(one.mass_spring.lower)),
                ("springs_ns_upper", exact(one.mass_spring.upper)),
                ("ratio_median", exact(one.ratio.median)),
                ("ratio_lower", exact(one.ratio.lower)),
                ("ratio_upper", exact(one.ratio.upper)),
                ("ratio_least", exact(one.ratio.least)),
                ("ratio_most", exact(one.ratio.most)),
            ]
        };
        Sheet::of(self.comparisons.iter().map(row))
    }

    /// The table as one JSON document.
    pub fn json(&self) -> Value {
        let row = |one: &Comparison| {
            json!({
                "cubes": one.cubes(),
                "springs": typed(&one.springs),
                "spring_count": one.count,
                "shape_ns": one.shape,
                "springs_ns": one.mass_spring,
                "ratio": one.ratio,
            })
        };
        let rows: Vec<_> = self.comparisons.iter().map(row).collect();
        json!({ "paper": PRINTED, "threads": self.threads, "time": self.time, "rounds": self.rounds, "rows": rows })
    }
}

impl Comparison {
    fn cubes(&self) -> u64 {
        u64::from(self.side) * u64::from(self.side) * u64::from(self.side)
    }

    fn per_cube(&self) -> f64 {
        self.count as f64 / self.cubes() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::snapshot::Status;

    #[test]
    fn every_arrangement_on_every_block() {
        let quick = Protocol { sides: vec![1, 2], rounds: 2, turn: 8 };
        let turns = std::sync::atomic::AtomicU64::new(0);
        let count = |more| turns.fetch_add(more, std::sync::atomic::Ordering::Relaxed) < u64::MAX;
        let ratios = measure(&quick, &count).expect("it is never stopped");
        assert_eq!(turns.into_inner(), quick.work());
        assert_eq!(ratios.comparisons.len(), 2 * SPRINGS.len());
        assert_eq!(ratios.comparisons[4].count, 28);
        assert!(ratios.comparisons.iter().all(|one| one.ratio.least > 0.0 && one.ratio.most.is_finite()));
        assert_eq!(measure(&quick, &|_| false), None);
    }

    #[test]
    fn the_clock_is_said() {
        let times = [(1, true), (1, false), (2, true)]
            .map(|(threads, has_processor_time)| Time::of(threads, has_processor_time));
        assert_eq!(times, [Time::Processor, Time::Wall, Time::Wall]);
        let spent = Spent { wall: 2.0, cpu: Some(1.0) };
        assert_eq!(times.map(|time| time.of_spent(spent)), [1.0, 2.0, 2.0]);
        for (threads, time) in [1, 1, 2].into_iter().zip(times) {
            let ratios = Ratios { threads, time, rounds: 3, comparisons: Vec::new() };
            assert!(ratios.markdown().contains(&format!("{} time of {threads} thread", time.name())));
            assert_eq!(ratios.json()["time"], time.name());
        }
    }

    /// After a divergence steps would take no time.
    #[test]
    fn no_block_diverges_while_it_is_timed() {
        let Protocol { sides, rounds, turn } = Protocol::default();
        let scene = block(sides[0]);
        for run in 0..scene.runs.len() {
            let mut world = scene.world(run);
            world.advance(u64::from(rounds) * turn / scene.body.elements.len() as u64);
            assert_eq!(world.status(), Status::Ok, "{}", scene.runs[run].name);
        }
    }
}
