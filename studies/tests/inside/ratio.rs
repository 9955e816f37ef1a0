//! The ratio of computation times.

use super::*;
use crate::reading::{documented, markdown_rows, numbers, records, same};
use localshape::sim::Status;

fn quick(threads: usize) -> Ratio {
    Ratio { sides: vec![1, 2], rounds: 3, turn: 8, threads }
}

#[test]
fn every_arrangement_on_every_block() {
    let quick = quick(1);
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
    for (threads, time) in [(1, kind_of_time()), (2, "wall")] {
        let ratios = Ratios { protocol: quick(threads), comparisons: Vec::new() };
        assert!(ratios.text().contains(&format!("{time} time of {threads} thread")), "{}", ratios.text());
    }
}

/// After a divergence, steps would take no time.
#[test]
fn no_block_diverges_while_it_is_timed() {
    let Ratio { sides, rounds, turn, .. } = Ratio::new(1);
    let scene = block(sides[0]);
    for run in 0..scene.runs.len() {
        let mut world = scene.world(run);
        world.advance(u64::from(rounds) * turn / scene.bodies[0].body.elements().len() as u64);
        assert_eq!(world.status(), Status::Ok, "{}", scene.runs[run].name);
    }
}

#[test]
fn a_ratio_can_be_read_again() {
    let ratios = measure(&quick(1), &|_| true).expect("nobody stops it");
    let (text, table) = (ratios.text(), ratios.table());
    assert_eq!(table.heads, documented("ratio.csv"));
    let (cells, rows) = (markdown_rows(&text), records(&table.csv()));
    assert_eq!((cells.len(), rows.len()), (2 * SPRINGS.len(), 2 * SPRINGS.len()));
    for (cells, row) in cells.iter().zip(&rows) {
        let ratio = ["ratio_median", "ratio_lower", "ratio_upper"].map(|head| row[head].as_str());
        let [median, lower, upper] = ratio.map(|text| text.parse::<f64>().expect("a number"));
        assert!(0.0 < lower && lower <= median && median <= upper, "{row:?}");
        assert!(same(&numbers(&cells[6]), &ratio), "{cells:?} {row:?}");
        let times = ["shape_ns_median", "springs_ns_median"].map(|head| row[head].as_str());
        assert!(same(&[numbers(&cells[3]), numbers(&cells[4])].concat(), &times), "{cells:?} {row:?}");
        let number = |head: &str| row[head].parse::<f64>().expect("a number");
        let per_cube = number("spring_count") / number("cubes");
        let shown = [&cells[2], &cells[5], &cells[7]].map(|cell| numbers(cell)[0]);
        let exact = [per_cube, number("springs_ns_median") / per_cube, PRINTED].map(|number| number.to_string());
        assert!(same(&shown, &exact.each_ref().map(String::as_str)), "{cells:?} {row:?}");
        assert_eq!((&cells[0], &cells[1]), (&format!("{}³", number("cubes").cbrt()), &row["springs"]));
        assert!(text.contains(&format!("{} time of {} thread", row["time"], row["threads"])), "{text}");
    }
}
