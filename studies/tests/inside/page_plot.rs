//! Plots of any numbers.

use super::super::{Contents, Page};
use super::*;

fn plots(points: Vec<[f64; 2]>) -> Vec<Plot> {
    let curve = |name: &str, points| Line { name: name.to_owned(), family: 0, is_strong: false, points };
    let plot = |points: &Vec<[f64; 2]>| Plot {
        name: "plot".to_owned(),
        axes: ["time (ns)".to_owned(), "error (rad)".to_owned()],
        curves: vec![curve("one", points.clone()), curve("two", points.clone())],
        slopes: Some(([1e4, 1e-4], vec![2.0, 5.0])),
    };
    vec![plot(&points), plot(&vec![[3e5, 1e-3]])]
}

/// The frames of these plots beside each other.
fn frames(plots: &[Plot]) -> Vec<Frame> {
    let area = |number: usize| [100.0 + 600.0 * number as f64, 100.0, 600.0 + 600.0 * number as f64, 500.0];
    let ranges = |plot: &Plot| [0, 1].map(|axis| range(plots, axis, &plot.axes[axis]));
    plots.iter().enumerate().map(|(at, plot)| Frame::new(plot, area(at), ranges(plot))).collect()
}

#[test]
fn a_decade_is_equally_long_everywhere_and_plots_share_their_axes() {
    let plots = plots(vec![[1.0, 1e-12], [10.0, 1e-9], [100.0, 1e-6]]);
    let frames = frames(&plots);
    // The first two lines are slopes.
    let dots = &frames[0].lines[2].points;
    assert!((dots[1][0] - dots[0][0] - (dots[2][0] - dots[1][0])).abs() < 1e-9);
    assert!((dots[1][1] - dots[0][1] - (dots[2][1] - dots[1][1])).abs() < 1e-9 && dots[1][1] < dots[0][1]);
    // 3e5 is outside the range of the first plot, and widens it.
    assert!(dots[2][0] < 400.0 && frames[1].lines[2].points[0][0] > 1100.0);
    assert_eq!([&frames[0].chart.x, &frames[0].chart.y], [&frames[1].chart.x, &frames[1].chart.y]);
}

#[test]
fn names_do_not_cover_each_other() {
    let plots = plots(vec![[1.0, 1e-12], [10.0, 1e-9], [100.0, 1e-6]]);
    for frame in frames(&plots) {
        let names = frame.names(&Diagram::new([1280, 600]));
        let names: Vec<Area> = names.into_iter().flatten().map(|place| place.area).collect();
        // Two curves and two slopes.
        assert_eq!(names.len(), 4);
        for (at, one) in names.iter().enumerate() {
            assert!(names[..at].iter().all(|&other| shared(*one, other) == 0.0), "{names:?}");
            let [left, top, right, bottom] = frame.area;
            assert!(one[0] >= left && one[1] >= top && one[2] <= right && one[3] <= bottom, "{names:?}");
        }
    }
}

#[test]
fn all_is_on_the_page_whatever_the_numbers() {
    for points in [vec![], vec![[0.0, -1.0]], vec![[f64::NAN, 1.0]], vec![[1e-300, f64::INFINITY]], vec![[2.0; 2]]] {
        let plots = plots(points);
        for frame in frames(&plots) {
            let [left, top, right, bottom] = frame.area;
            for &[x, y] in frame.lines.iter().flat_map(|line| &line.points) {
                assert!((left..=right).contains(&x) && (top..=bottom).contains(&y), "{x} {y}");
            }
        }
        let (title, caption) = ("Title".to_owned(), vec!["Words".to_owned()]);
        let page = Page { title, caption, columns: 2, contents: Contents::Plots(plots) };
        page.diagram();
    }
}
