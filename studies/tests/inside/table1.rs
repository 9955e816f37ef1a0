//! Table 1: its rows as printed, and at one k/m properties of them that hold on any machine.

use super::*;
use crate::reading::{documented, markdown_rows, numbers, records, same};
use localshape::sim::World;

/// Some starts at the smallest k/m. The paper's 10 s, as rebounds add energy at ΔT = T/10, and errors grow with it.
const SHORT: Table1 = Table1 { orientations: 9, duration: 10.0, stiffest: 1e4 };

fn on_threads(threads: usize) -> Results {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads");
    pool.install(|| measure(&SHORT, &|_| true)).expect("nobody stops it")
}

#[test]
fn each_row_is_as_far_from_the_others_as_in_the_paper() {
    let table = on_threads(2);
    let summaries = table.summaries();
    let of = |solver: usize, row: &str| -> Summary {
        let found = summaries.iter().find(|one| one.case.solver == SOLVERS[solver] && one.case.row.name == row);
        *found.unwrap_or_else(|| panic!("no row {row} of {}", SOLVERS[solver]))
    };
    let [a, b, c, d] = ROWS.map(|row| of(0, row.name));
    // The ranges found by an independent implementation.
    assert!((3.2..14.0).contains(&a.mean.median), "{a:?}");
    assert!((0.012..0.040).contains(&b.mean.median), "{b:?}");
    assert!((4e-5..3e-3).contains(&c.mean.median), "{c:?}");
    assert!(c.maximum.median < 1e-2 * a.maximum.median, "{c:?}");
    assert!(d.maximum.median < 1e-6, "{d:?}");
    assert!(of(1, "A").maximum.most < 1e-10, "the exact rotation to round-off");
    assert!(summaries.iter().all(|summary| summary.diverged == 0));

    let (cells, rows) = (markdown_rows(&table.text()), records(&table.summary_table().csv()));
    assert_eq!((cells.len(), rows.len()), (6, 6));
    let ranges = ["mean_median", "mean_least", "mean_most", "deviation_median", "maximum_median"];
    for (cells, row) in cells.iter().zip(&rows) {
        // The paper's own solver comes first, with the paper's numbers beside ours.
        let [mean, deviation, maximum] = if cells.len() == 10 { [5, 7, 9] } else { [4, 5, 6] }.map(|at| &cells[at]);
        let shown = [numbers(mean), numbers(deviation), numbers(maximum)].concat();
        let all: Vec<_> =
            ranges.iter().chain(&["maximum_least", "maximum_most"]).map(|head| row[*head].as_str()).collect();
        assert!(same(&shown, &all), "{cells:?} {all:?}");
        if cells.len() == 10 {
            let paper = ["paper_mean", "paper_deviation", "paper_maximum"].map(|head| row[head].as_str());
            for (cell, paper) in [4, 6, 8].map(|at| &cells[at]).into_iter().zip(paper) {
                assert!(if paper.is_empty() { cell == "–" } else { same(&numbers(cell), &[paper]) }, "{cell} {paper}");
            }
        }
    }
}

/// In row A rebounds add energy. The solver is not the cause: exact rotations gain energy, too. With ten times shorter
/// steps, as in row B, rebounds add little, as stated in `docs/paper.md`.
#[test]
fn rebounds_feed_energy_where_a_cycle_has_ten_steps() {
    let gained = |number: u32, step: f64| {
        let Orientation { axis, angle } = Orientation::random(number);
        let text = format!(
            "gravity = [0, -9.8, 0]
            time = {{ duration = 20, step = {step} }}
            body = {{ lattice = {{ cells = [1, 1, 1], side = 0.1 }}, lowest = 1, \
                      rotation = {{ axis = [{:?}, {:?}, {:?}], angle = {angle:?} }} }}
            obstacle = [{{ kind = 'floor', restitution = 1, friction = 0 }}]
            run = [{{ name = 'exact', kernel = 'reference', model = {{ kind = 'shape-based', stiffness = 1e4 }} }}]",
            axis.x, axis.y, axis.z
        );
        let scene = built_in(&text, "energy");
        let energy = |world: &World| world.diagnostics().energy;
        let mut world = scene.world(0);
        let before = energy(&world);
        // A fall of 1 m, then 10 s.
        world.advance(((10.0 + (2.0f64 / 9.8).sqrt()) / step).round() as u64);
        energy(&world) / before
    };
    let of_fifteen = |step: f64| Spread::of((0..15).map(|number| gained(number, step)));
    let (tenth, hundredth) = (of_fifteen(0.006), of_fifteen(0.0006));
    assert!((tenth.least - 1.22).abs() < 0.01 && (tenth.most - 4.64).abs() < 0.01, "{tenth:?}");
    assert!((tenth.median - 2.33).abs() < 0.01, "{tenth:?}");
    assert!(hundredth.least > 0.9 && hundredth.most < 1.1, "{hundredth:?}");
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let files = |threads| {
        let table = on_threads(threads);
        (table.text(), table.summary_table().csv(), table.start_table().csv())
    };
    assert_eq!(files(1), files(3));
}

/// The result of a start does not depend on the number of starts.
#[test]
fn more_starts_change_none() {
    let rows = |orientations| {
        let table = measure(&Table1 { orientations, duration: 0.1, ..SHORT }, &|_| true).unwrap();
        table.start_table().csv().lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let many = rows(17);
    for few in [rows(1), rows(3)] {
        assert!(few.iter().all(|row| many.contains(row)), "{few:#?}");
    }
}

#[test]
fn orientations_are_evenly_spread() {
    let count = 4000;
    let all: Vec<_> = (0..count).map(Orientation::random).collect();
    let mean = all.iter().map(|one| one.axis).sum::<DVec3>() / f64::from(count);
    assert!(mean.length() < 0.05, "{mean}");
    assert!(all.iter().all(|one| (one.axis.length() - 1.0).abs() < 1e-15 && one.angle >= 0.0));
    // The fraction (θ − sin θ)/π of uniformly distributed rotations has an angle below θ. Angles beyond half a turn
    // belong to the opposite axis.
    let below = all.iter().filter(|one| one.angle.min(std::f64::consts::TAU - one.angle) < 2.0).count();
    let expected = (2.0 - 2f64.sin()) / std::f64::consts::PI;
    assert!((below as f64 / f64::from(count) - expected).abs() < 0.03, "{below}");
}

#[test]
fn rows_are_those_printed() {
    let cases = Table1::new(51).cases();
    assert_eq!(cases.len(), 12 + 6);
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
    let one = |residuals: &[f64]| {
        let mut taken = Statistics::default();
        residuals.iter().for_each(|&residual| taken.add(residual));
        assert_eq!(taken.evaluations, residuals.len() as u64);
        taken.numbers()
    };
    assert_eq!(one(&[1.0, 4.0, 1.0]), [2.0, 2f64.sqrt(), 4.0]);
    for bad in [&[][..], &[f64::NAN, 1.0], &[1.0, f64::NAN, 2.0]] {
        assert!(one(bad).iter().all(|number| number.is_nan()), "{bad:?}");
    }
}

#[test]
fn a_watch_stops_it() {
    let short = Table1 { orientations: 1, duration: 1.0, ..SHORT };
    assert_eq!(measure(&short, &|_| false), None);
}

#[test]
fn columns_are_documented() {
    let table = measure(&Table1 { orientations: 1, duration: 0.1, ..SHORT }, &|_| true).expect("nobody stops it");
    assert_eq!(table.summary_table().heads, documented("table1.csv"));
    assert_eq!(table.start_table().heads, documented("table1-orientations.csv"));
}
