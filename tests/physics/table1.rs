//! Table 1 at one k/m: what must hold of its rows, whatever the machine.

use localshape::table::ratio;
use localshape::table::table1::{Protocol, ROWS, SOLVERS, Summary, Table1, measure};

/// Some starts at the smallest k/m. The paper's 10 s, for at ΔT = T/10 rebounds feed energy, and errors grow with it.
const SHORT: Protocol = Protocol { orientations: 9, duration: 10.0, stiffest: 1e4 };

fn on_threads(threads: usize) -> Table1 {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of threads");
    pool.install(|| measure(&SHORT, &|_| true)).expect("nobody stops it")
}

#[test]
fn each_row_is_as_far_from_the_others_as_in_the_paper() {
    let table = on_threads(2);
    let summaries = table.summaries();
    let of = |solver: usize, row: &str| -> Summary {
        let found = summaries.iter().find(|one| one.case.solver == SOLVERS[solver] && one.case.row.name == row);
        *found.unwrap_or_else(|| panic!("no row {row} of {}", SOLVERS[solver].name))
    };
    let [a, b, c, d] = ROWS.map(|row| of(0, row.name));
    // The ranges that an independent implementation found.
    assert!((3.2..14.0).contains(&a.mean.median), "{a:?}");
    assert!((0.012..0.040).contains(&b.mean.median), "{b:?}");
    assert!((4e-5..3e-3).contains(&c.mean.median), "{c:?}");
    assert!(c.maximum.median < 1e-2 * a.maximum.median, "{c:?}");
    assert!(d.maximum.median < 1e-5, "{d:?}");
    // Better solvers: the symmetric matrix by a pass, the exact rotation to round-off.
    assert!(of(1, "A").mean.median < 0.3 * a.mean.median);
    assert!(of(1, "C").mean.median < 1e-2 * c.mean.median);
    assert!(of(2, "A").maximum.most < 1e-10);
    assert!(summaries.iter().all(|summary| summary.diverged == 0));
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    assert_eq!(on_threads(1).files(), on_threads(3).files());
}

/// Each start is the same in any number of them.
#[test]
fn more_starts_change_none() {
    let rows = |orientations| {
        let [_, _, sheet] = measure(&Protocol { orientations, duration: 0.1, ..SHORT }, &|_| true).unwrap().files();
        sheet.lines().map(str::to_owned).collect::<Vec<_>>()
    };
    let (few, many) = (rows(2), rows(3));
    assert!(few.iter().all(|row| many.contains(row)), "{few:#?}");
}

#[test]
fn a_ratio_can_be_read_again() {
    let protocol = ratio::Protocol { sides: vec![1, 2], rounds: 3, turn: 8 };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool of threads");
    let [markdown, sheet] = pool.install(|| ratio::measure(&protocol, &|_| true)).expect("nobody stops it").files();
    let mut reader = csv::Reader::from_reader(sheet.as_bytes());
    let column = |name: &str| reader.headers().unwrap().iter().position(|head| head == name).expect("the column");
    let [median, lower, upper] = ["ratio_median", "ratio_lower", "ratio_upper"].map(column);
    let rows: Vec<_> = reader.records().map(|row| row.expect("a row")).collect();
    assert_eq!(rows.len(), 2 * ratio::SPRINGS.len());
    for row in &rows {
        let [median, lower, upper] = [median, lower, upper].map(|at| row[at].parse::<f64>().expect("a number"));
        assert!(0.0 < lower && lower <= median && median <= upper, "{row:?}");
    }
    assert!(markdown.contains("other") && markdown.contains("1.05") && markdown.contains("of 1 thread"), "{markdown}");
}
