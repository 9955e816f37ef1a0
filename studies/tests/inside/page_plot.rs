//! Plots of any numbers.

use super::super::{Contents, Page};
use super::*;

fn plots(points: Vec<[f64; 2]>) -> Vec<Plot> {
    let curve = |name: &str, points| Line { name: name.to_owned(), family: "linear".into(), is_strong: false, points };
    let plot = |points: &Vec<[f64; 2]>| Plot {
        name: "plot".to_owned(),
        axes: ["time (ns)", "error (rad)"],
        curves: vec![curve("one", points.clone()), curve("two", points.clone())],
        slopes: Some(([1e4, 1e-4], vec![2.0, 5.0])),
    };
    vec![plot(&points), plot(&vec![[3e5, 1e-3]])]
}

const AREA: Area = [100.0, 100.0, 600.0, 500.0];

/// The charts of these plots.
fn charts(plots: &[Plot]) -> Vec<Chart> {
    let ranges = |plot: &Plot| [0, 1].map(|axis| range(plots, axis, plot.axes[axis]));
    plots.iter().map(|plot| plot.chart(AREA, &families(plots), ranges(plot))).collect()
}

/// The dots of a chart's curves (px).
fn dots(chart: &Chart) -> Vec<[f64; 2]> {
    let points = chart.layers.iter().filter_map(|layer| match layer {
        Layer::Dots { points, .. } => Some(points),
        _ => None,
    });
    points.flatten().map(|&point| chart.at(AREA, point)).collect()
}

#[test]
fn a_decade_is_equally_long_everywhere_and_plots_share_their_axes() {
    let plots = plots(vec![[1.0, 1e-12], [10.0, 1e-9], [100.0, 1e-6]]);
    let charts = charts(&plots);
    let [one, other] = [0, 1].map(|at| dots(&charts[at]));
    assert!((one[1][0] - one[0][0] - (one[2][0] - one[1][0])).abs() < 1e-9);
    assert!((one[1][1] - one[0][1] - (one[2][1] - one[1][1])).abs() < 1e-9 && one[1][1] < one[0][1]);
    // 3e5 is outside the range of the first plot, and widens it.
    assert!(one[2][0] < 400.0 && other[0][0] > 500.0);
    assert_eq!([&charts[0].x, &charts[0].y], [&charts[1].x, &charts[1].y]);
    let names = |chart: &Chart| match &chart.annotations[..] {
        [Annotation::Names { names, .. }] => names.len(),
        _ => 0,
    };
    assert_eq!(charts.iter().map(names).collect::<Vec<_>>(), [2, 2]);
}

#[test]
fn all_is_on_the_page_whatever_the_numbers() {
    for points in [vec![], vec![[0.0, -1.0]], vec![[f64::NAN, 1.0]], vec![[1e-300, f64::INFINITY]], vec![[2.0; 2]]] {
        let plots = plots(points);
        for [x, y] in charts(&plots).iter().flat_map(dots) {
            let [left, top, right, bottom] = AREA;
            assert!((left..=right).contains(&x) && (top..=bottom).contains(&y), "{x} {y}");
        }
        let (title, caption) = ("Title".to_owned(), vec!["Words".to_owned()]);
        let page = Page { title, caption, contents: Contents::Plots(plots) };
        page.diagram();
    }
}
