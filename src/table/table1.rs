//! Table 1 of the paper (section 4): how far the rotations that Eq. (15) finds are from the true ones.
//!
//! One free cube of side 0.1 m with 1 kg in each corner falls, until its lowest corner has fallen 1 m, "ten times the
//! height of the size of the cube", onto a floor that gives back everything. For 10 s from the step that ends with the
//! first contact, α of Eq. (18) is taken at every evaluation of the forces. Semi-implicit Euler, no damping, no
//! friction. The paper tells neither how the cube was turned nor how often this was done, and the motion is chaotic:
//! so there are many starts at rest, turned at random.

use super::sheet::figure;
use super::{Sheet, Spread, Watch, scene};
use crate::output::exact;
use crate::scene::{Scene, random};
use crate::sim::model::Report;
use crate::sim::snapshot::Status;
use glam::{DVec3, DVec4, Vec4Swizzles};
use rayon::prelude::*;
use serde::Serialize;
use serde_json::{Value, json};

/// The names of the table's files: itself, the same as CSV, and each start as CSV.
pub(crate) const FILES: [&str; 3] = ["table1.md", "table1.csv", "table1-orientations.csv"];

/// Mean, standard deviation and maximum of α (rad/s²), as printed; `None` where the paper says that it was too small to
/// be measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Printed {
    /// μ(α).
    pub mean: Option<f64>,
    /// σ(α).
    pub deviation: Option<f64>,
    /// max(α).
    pub maximum: Option<f64>,
}

/// One row of the paper's Table 1 for all its k/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Row {
    /// Its letter.
    pub name: &'static str,
    /// "Number of iteration": how often Eq. (15) is solved at each evaluation.
    pub passes: u32,
    /// For each of [`STIFFNESSES`] the time step ΔT (s), as printed, and what the paper found.
    pub cases: [(f64, Printed); 3],
}

/// The ratios k/m of the paper (1/s²), in its order.
pub(crate) const STIFFNESSES: [f64; 3] = [1e4, 1e5, 1e6];

/// The paper's Table 1 as printed.
pub(crate) const ROWS: [Row; 4] = {
    const fn printed(mean: f64, deviation: f64, maximum: f64) -> Printed {
        const fn measured(number: f64) -> Option<f64> {
            if number > 0.0 { Some(number) } else { None }
        }
        Printed { mean: measured(mean), deviation: measured(deviation), maximum: measured(maximum) }
    }
    const LESS: f64 = 0.0;
    [
        Row {
            name: "A",
            passes: 1,
            cases: [
                (0.006, printed(4.52554, 4.49862, 30.87597)),
                (0.002, printed(1.987712, 1.68312, 9.119262)),
                (0.0006, printed(1.301888, 1.297613, 7.570902)),
            ],
        },
        Row {
            name: "B",
            passes: 1,
            cases: [
                (0.0006, printed(0.032915, 0.037503, 0.320008)),
                (0.0002, printed(0.030974, 0.028445, 0.157926)),
                (0.00006, printed(0.005511, 0.005129, 0.034552)),
            ],
        },
        Row {
            name: "C",
            passes: 2,
            cases: [
                (0.006, printed(0.000493, 0.00211, 0.060352)),
                (0.002, printed(LESS, 0.000001, 0.000017)),
                (0.0006, printed(LESS, LESS, LESS)),
            ],
        },
        Row {
            name: "D",
            passes: 3,
            cases: [
                (0.006, printed(LESS, LESS, 0.000001)),
                (0.002, printed(LESS, LESS, LESS)),
                (0.0006, printed(LESS, LESS, LESS)),
            ],
        },
    ]
};

/// A way to find the rotation of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Solver {
    /// What scenes call it: `rotation = "…"` in a shape-based model.
    pub name: &'static str,
    /// In words.
    pub words: &'static str,
    /// Whether it is made of passes, of which there may be one or more. Without them rows C and D are row A.
    pub has_passes: bool,
}

/// The paper's solver as read here, then better ones.
pub(crate) const SOLVERS: [Solver; 3] = [
    Solver { name: "arctangent", words: "Eq. (15)", has_passes: true },
    Solver { name: "symmetric", words: "Eq. (15) with the symmetric part of its matrix", has_passes: true },
    Solver { name: "exact", words: "exact rotation", has_passes: false },
];

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Protocol {
    /// How many starts, turned at random: each is the same in any number of them, on every machine.
    pub orientations: u32,
    /// Time measured from the first contact on (s).
    pub duration: f64,
    /// The largest k/m that is measured (1/s²).
    pub stiffest: f64,
}

impl Default for Protocol {
    /// The paper's 10 s and all its k/m.
    fn default() -> Self {
        Self { orientations: 51, duration: 10.0, stiffest: f64::INFINITY }
    }
}

/// One solver in one row at one k/m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Case {
    /// How rotations are found.
    pub solver: Solver,
    /// The row.
    pub row: Row,
    /// Index of its k/m in [`STIFFNESSES`].
    pub stiffness: usize,
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

    /// What the paper found, if this is its solver.
    pub(crate) fn printed(&self) -> Option<Printed> {
        (self.solver == SOLVERS[0]).then_some(self.row.cases[self.stiffness].1)
    }

    /// How often Eq. (15) is solved; `None` for solvers that do without.
    pub(crate) fn passes(&self) -> Option<u32> {
        self.solver.has_passes.then_some(self.row.passes)
    }

    /// Unique among all cases.
    fn name(&self) -> String {
        format!("{} {} {:e}", self.solver.name, self.row.name, self.stiffness_over_mass())
    }
}

impl Protocol {
    /// Everything that is measured for each start, solver by solver, k/m by k/m, row by row.
    pub(crate) fn cases(&self) -> Vec<Case> {
        let wanted = |stiffness: &usize| STIFFNESSES[*stiffness] <= self.stiffest;
        let mut cases = Vec::new();
        for solver in SOLVERS {
            for stiffness in (0..STIFFNESSES.len()).filter(wanted) {
                let rows = ROWS.into_iter().filter(|row| solver.has_passes || row.passes == 1);
                cases.extend(rows.map(|row| Case { solver, row, stiffness }));
            }
        }
        cases
    }

    /// How often α is taken in one course of a case.
    fn evaluations(&self, case: &Case) -> u64 {
        (self.duration / case.step()).round() as u64
    }

    /// How often α is taken in all: what [`measure`] tells its watch comes to this.
    pub(crate) fn work(&self) -> u64 {
        u64::from(self.orientations) * self.cases().iter().map(|case| self.evaluations(case)).sum::<u64>()
    }

    /// The mark of the Markdown file, by which it is known again: how it is made.
    pub(crate) fn mark(&self) -> String {
        format!("localshape table table1 --orientations {}", self.orientations)
    }
}

/// How the cube is turned at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Orientation {
    /// The axis, a unit vector.
    pub axis: DVec3,
    /// The angle (rad).
    pub angle: f64,
}

impl Orientation {
    /// One of endlessly many, evenly spread over all rotations: the first of the points hashed for its number that lies
    /// in the unit ball of four dimensions, as a quaternion.
    pub(crate) fn random(number: u32) -> Self {
        const SEED: u32 = 1;
        let coordinate = |usage: u64| 2.0 * random::unit(SEED, u64::from(number), usage) - 1.0;
        let point = |attempt: u64| DVec4::from_array([0, 1, 2, 3].map(|axis| coordinate(4 * attempt + axis)));
        // Near the middle a direction has few digits.
        let usable = |point: &DVec4| (1e-6..=1.0).contains(&point.length_squared());
        let point = (0..).map(point).find(usable).expect("three of ten points lie in the ball");
        let vector = point.xyz();
        Self { axis: vector.normalize_or(DVec3::X), angle: 2.0 * libm::atan2(vector.length(), point.w) }
    }
}

/// What one start came to in one case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Course {
    /// How often α was taken; fewer than wanted if it blew up. If never, all that follows is not-a-number.
    pub evaluations: u64,
    /// Its mean (rad/s²).
    pub mean: f64,
    /// Its standard deviation (rad/s²), over all evaluations.
    pub deviation: f64,
    /// Its maximum (rad/s²).
    pub maximum: f64,
    /// Whether the simulation blew up.
    pub diverged: bool,
}

/// Table 1, measured.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Table1 {
    protocol: Protocol,
    cases: Vec<Case>,
    orientations: Vec<Orientation>,
    /// For each start, for each case.
    courses: Vec<Course>,
}

/// What all starts came to in one case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Summary {
    /// The case.
    pub case: Case,
    /// The means of all starts (rad/s²).
    pub mean: Spread,
    /// Their standard deviations (rad/s²).
    pub deviation: Spread,
    /// Their maxima (rad/s²).
    pub maximum: Spread,
    /// How many of them blew up.
    pub diverged: usize,
}

/// Measures Table 1 on the pool of threads that it is called on; `None` if `watch`, which is told how many more times α
/// was taken, stops it. The result has the same bits for any number of threads.
pub(crate) fn measure(protocol: &Protocol, watch: &Watch<'_>) -> Option<Table1> {
    let cases = protocol.cases();
    let orientations: Vec<_> = (0..protocol.orientations).map(Orientation::random).collect();
    let starts = orientations.par_iter().map(|orientation| watch(0).then(|| start(orientation, &cases)));
    let starts: Vec<Scene> = starts.collect::<Option<_>>()?;
    let courses = (0..starts.len() * cases.len()).into_par_iter().map(|at| {
        let (start, case) = (at / cases.len(), at % cases.len());
        course(&starts[start], case, protocol.evaluations(&cases[case]), watch)
    });
    let courses = courses.collect::<Option<_>>()?;
    Some(Table1 { protocol: *protocol, cases, orientations, courses })
}

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
        let (name, rotation, stiffness) = (case.name(), case.solver.name, case.stiffness_over_mass());
        let passes = case.passes().map_or(String::new(), |passes| format!(", passes = {passes}"));
        text += &format!(
            "[[run]]
            name = '{name}'
            step = {:?}
            kernel = 'reference'
            model = {{ kind = 'shape-based', stiffness = {stiffness:?}, rotation = '{rotation}'{passes} }}
            ",
            case.step()
        );
    }
    scene(&text, "table1")
}

/// Lets one start run its course in one case.
fn course(start: &Scene, case: usize, evaluations: u64, watch: &Watch<'_>) -> Option<Course> {
    /// Steps after which the watch is asked.
    const SLICE: u64 = 4096;
    let mut world = start.world(case);
    // Nothing but the floor sends a corner upwards.
    while world.status() == Status::Ok && world.state().velocity.iter().all(|velocity| velocity.y <= 0.0) {
        world.advance(1);
    }
    let mut residuals = Residuals::default();
    let mut told = 0;
    while residuals.taken < evaluations && world.status() == Status::Ok {
        // The step that follows evaluates its forces here.
        residuals.add(world.report(0).residual(Report::ROTATION).unwrap_or(f64::NAN));
        world.advance(1);
        if residuals.taken % SLICE == 0 {
            if !watch(residuals.taken - told) {
                return None;
            }
            told = residuals.taken;
        }
    }
    let diverged = world.status() != Status::Ok;
    watch(evaluations - told).then(|| residuals.course(diverged))
}

/// Values of α so far.
#[derive(Clone, Copy, Debug, Default)]
struct Residuals {
    taken: u64,
    mean: f64,
    squares: f64,
    maximum: Option<f64>,
}

impl Residuals {
    fn add(&mut self, residual: f64) {
        self.taken += 1;
        // Welford 1962: no difference of large sums.
        let before = residual - self.mean;
        self.mean += before / self.taken as f64;
        self.squares += before * (residual - self.mean);
        // What is no number stays so, as in the mean.
        self.maximum = match self.maximum {
            Some(maximum) if maximum.is_nan() || maximum > residual => Some(maximum),
            _ => Some(residual),
        };
    }

    /// What they come to; not-a-number if there are none.
    fn course(self, diverged: bool) -> Course {
        let Self { taken, mean, squares, maximum } = self;
        Course {
            evaluations: taken,
            mean: if taken > 0 { mean } else { f64::NAN },
            deviation: (squares / taken as f64).sqrt(),
            maximum: maximum.unwrap_or(f64::NAN),
            diverged,
        }
    }
}

/// A figure of the paper in three digits, or fewer where its six decimals end before.
fn as_printed(number: f64) -> String {
    let short = format!("{number:.2e}");
    let exponent = short.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok()).unwrap_or(0);
    format!("{number:.*}", (2 - exponent).clamp(0, 6) as usize)
}

impl Table1 {
    /// What all starts came to, case by case in the order of [`Protocol::cases`].
    pub(crate) fn summaries(&self) -> Vec<Summary> {
        let summary = |(at, &case): (usize, &Case)| {
            let courses = || self.courses.iter().skip(at).step_by(self.cases.len());
            Summary {
                case,
                mean: Spread::of(courses().map(|course| course.mean)),
                deviation: Spread::of(courses().map(|course| course.deviation)),
                maximum: Spread::of(courses().map(|course| course.maximum)),
                diverged: courses().filter(|course| course.diverged).count(),
            }
        };
        self.cases.iter().enumerate().map(summary).collect()
    }

    /// The contents of [`FILES`].
    pub(crate) fn files(&self) -> [String; 3] {
        [self.markdown(), self.summary_sheet().csv(), self.course_sheet().csv()]
    }

    /// The table for people.
    pub(crate) fn markdown(&self) -> String {
        let Protocol { orientations, duration, .. } = self.protocol;
        let plural = if orientations == 1 { "" } else { "s" };
        let mut text = format!(
            "<!-- {} -->\n\
            # Table 1: evaluation values of approximation errors\n\n\
            α of Eq. (18) in rad/s², at every evaluation of the forces in the {duration} s from the first contact on, of \
            a free cube of side 0.1 m with 1 kg in each corner that falls 1 m onto a floor with restitution 1. g = 9.8 \
            m/s², neither damping nor friction, semi-implicit Euler. μ, σ and max are the mean of α, its standard deviation \
            and its largest value; k/m is in 1/s². Row A has one pass of the solver at each evaluation and steps of a tenth \
            of the cycle, row B steps of a hundredth, row C two passes, row D three. The paper's figures are those of one start that it \
            does not tell; ours are medians over {orientations} start{plural} at rest, turned at random, with the range \
            over all of them in parentheses, but for σ. A dash among the paper's figures: below the lower limit of its \
            measurable range; a dash for passes: the solver has none. Figures around 1e-9 and below are round-off.\n\n\
            ## The paper's solver: Eq. (15), θ = atan |w|, true rotations accumulated, each evaluation starting from \
            the last\n\n",
            self.protocol.mark()
        );
        let summaries = self.summaries();
        let (ours, others): (Vec<_>, Vec<_>) = summaries.iter().partition(|summary| summary.case.printed().is_some());
        let range =
            |spread: Spread| format!("{} ({} – {})", figure(spread.median), figure(spread.least), figure(spread.most));
        let dash = |printed: Option<f64>| printed.map_or("–".to_owned(), as_printed);
        let mut sheet = Sheet::new([
            "k/m",
            "row",
            "passes",
            "ΔT (s)",
            "μ, paper",
            "μ, here",
            "σ, paper",
            "σ, here",
            "max, paper",
            "max, here",
        ]);
        for Summary { case, mean, deviation, maximum, .. } in ours {
            let printed = case.row.cases[case.stiffness].1;
            sheet.rows.push([
                format!("{:e}", case.stiffness_over_mass()),
                case.row.name.to_owned(),
                case.row.passes.to_string(),
                case.step().to_string(),
                dash(printed.mean),
                range(mean),
                dash(printed.deviation),
                figure(deviation.median),
                dash(printed.maximum),
                range(maximum),
            ]);
        }
        text += &sheet.markdown(2);
        text += "\n## Better solvers on the same starts\n\n";
        let mut sheet = Sheet::new(["solver", "k/m", "row", "passes", "ΔT (s)", "μ", "σ", "max"]);
        for Summary { case, mean, deviation, maximum, .. } in others {
            sheet.rows.push([
                case.solver.words.to_owned(),
                format!("{:e}", case.stiffness_over_mass()),
                case.row.name.to_owned(),
                case.passes().map_or("–".to_owned(), |passes| passes.to_string()),
                case.step().to_string(),
                range(mean),
                figure(deviation.median),
                range(maximum),
            ]);
        }
        text += &sheet.markdown(3);
        let diverged: usize = summaries.iter().map(|summary| summary.diverged).sum();
        if diverged > 0 {
            text += &format!("\n{diverged} of {} simulations blew up, and count until then.\n", self.courses.len());
        }
        text
    }

    /// The table for programs, all digits.
    fn summary_sheet(&self) -> Sheet<17> {
        let mut sheet = Sheet::new([
            "solver",
            "row",
            "stiffness_over_mass",
            "passes",
            "step",
            "paper_mean",
            "paper_deviation",
            "paper_maximum",
            "orientations",
            "mean_median",
            "mean_least",
            "mean_most",
            "deviation_median",
            "maximum_median",
            "maximum_least",
            "maximum_most",
            "diverged",
        ]);
        let number = |number: Option<f64>| number.map_or(String::new(), exact);
        for Summary { case, mean, deviation, maximum, diverged } in self.summaries() {
            let printed = case.printed();
            sheet.rows.push([
                case.solver.name.to_owned(),
                case.row.name.to_owned(),
                exact(case.stiffness_over_mass()),
                case.passes().map_or(String::new(), |passes| passes.to_string()),
                exact(case.step()),
                number(printed.and_then(|printed| printed.mean)),
                number(printed.and_then(|printed| printed.deviation)),
                number(printed.and_then(|printed| printed.maximum)),
                self.orientations.len().to_string(),
                exact(mean.median),
                exact(mean.least),
                exact(mean.most),
                exact(deviation.median),
                exact(maximum.median),
                exact(maximum.least),
                exact(maximum.most),
                diverged.to_string(),
            ]);
        }
        sheet
    }

    /// Each start in each case, all digits.
    fn course_sheet(&self) -> Sheet<15> {
        let mut sheet = Sheet::new([
            "solver",
            "row",
            "stiffness_over_mass",
            "passes",
            "step",
            "orientation",
            "axis_x",
            "axis_y",
            "axis_z",
            "angle",
            "evaluations",
            "mean",
            "deviation",
            "maximum",
            "status",
        ]);
        for (at, case) in self.cases.iter().enumerate() {
            let courses = self.courses.iter().skip(at).step_by(self.cases.len());
            for (number, (Orientation { axis, angle }, course)) in self.orientations.iter().zip(courses).enumerate() {
                sheet.rows.push([
                    case.solver.name.to_owned(),
                    case.row.name.to_owned(),
                    exact(case.stiffness_over_mass()),
                    case.passes().map_or(String::new(), |passes| passes.to_string()),
                    exact(case.step()),
                    number.to_string(),
                    exact(axis.x),
                    exact(axis.y),
                    exact(axis.z),
                    exact(*angle),
                    course.evaluations.to_string(),
                    exact(course.mean),
                    exact(course.deviation),
                    exact(course.maximum),
                    if course.diverged { "diverged" } else { "ok" }.to_owned(),
                ]);
            }
        }
        sheet
    }

    /// The table as one document.
    pub(crate) fn json(&self) -> Value {
        let row = |summary: &Summary| {
            let Summary { case, mean, deviation, maximum, diverged } = summary;
            json!({
                "solver": case.solver.name,
                "row": case.row.name,
                "stiffness_over_mass": case.stiffness_over_mass(),
                "passes": case.passes(),
                "step": case.step(),
                "paper": case.printed(),
                "mean": mean,
                "deviation": deviation,
                "maximum": maximum,
                "diverged": diverged,
            })
        };
        let rows: Vec<_> = self.summaries().iter().map(row).collect();
        json!({ "orientations": self.orientations.len(), "duration": self.protocol.duration, "rows": rows })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orientations_are_evenly_spread() {
        let count = 4000;
        let all: Vec<_> = (0..count).map(Orientation::random).collect();
        let mean = all.iter().map(|one| one.axis).sum::<DVec3>() / f64::from(count);
        assert!(mean.length() < 0.05, "{mean}");
        assert!(all.iter().all(|one| (one.axis.length() - 1.0).abs() < 1e-15 && one.angle >= 0.0));
        // Of evenly spread rotations the part (θ − sin θ)/π has an angle below θ; angles beyond half a turn are of the
        // other axis.
        let below = all.iter().filter(|one| one.angle.min(std::f64::consts::TAU - one.angle) < 2.0).count();
        let expected = (2.0 - 2f64.sin()) / std::f64::consts::PI;
        assert!((below as f64 / f64::from(count) - expected).abs() < 0.03, "{below}");
    }

    #[test]
    fn rows_are_those_printed() {
        let cases = Protocol::default().cases();
        assert_eq!(cases.len(), 12 + 12 + 6);
        assert_eq!(cases.iter().filter(|case| case.printed().is_some()).count(), 12);
        // "ΔT is fixed at 1/10 of the cycle of elastic oscillation", in row B at 1/100.
        for case in cases {
            let cycle = std::f64::consts::TAU / case.stiffness_over_mass().sqrt();
            let parts = if case.row.name == "B" { 100.0 } else { 10.0 };
            assert!((case.step() * parts / cycle - 1.0).abs() < 0.05, "{}", case.name());
        }
    }

    #[test]
    fn what_was_not_taken_is_no_number() {
        let course = |residuals: &[f64]| {
            let mut taken = Residuals::default();
            residuals.iter().for_each(|&residual| taken.add(residual));
            taken.course(false)
        };
        let Course { mean, deviation, maximum, .. } = course(&[1.0, 4.0, 1.0]);
        assert_eq!((mean, deviation, maximum), (2.0, 2f64.sqrt(), 4.0));
        for bad in [&[][..], &[f64::NAN, 1.0], &[1.0, f64::NAN, 2.0]] {
            let Course { evaluations, mean, deviation, maximum, .. } = course(bad);
            assert_eq!(evaluations, bad.len() as u64);
            assert!(mean.is_nan() && deviation.is_nan() && maximum.is_nan(), "{bad:?}");
        }
    }

    #[test]
    fn the_papers_figures_have_three_digits_or_six_decimals() {
        for (number, text) in [
            (30.875_97, "30.9"),
            (4.498_62, "4.50"),
            (1.297_613, "1.30"),
            (9.999, "10.0"),
            (0.320_008, "0.320"),
            (0.030_974, "0.0310"),
            (0.000_493, "0.000493"),
            (0.000_017, "0.000017"),
            (0.000_001, "0.000001"),
        ] {
            assert_eq!(as_printed(number), text);
        }
    }

    #[test]
    fn a_watch_stops_it() {
        let short = Protocol { orientations: 1, duration: 1.0, stiffest: 1e4 };
        assert_eq!(measure(&short, &|_| false), None);
    }
}
