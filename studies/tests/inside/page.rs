//! Pages: the places of their parts.

use super::*;

#[test]
fn all_is_on_the_page() {
    let map = |columns: usize, rows: usize| Map {
        name: ["A run".to_owned(), "what it is of, ".repeat(20)],
        across: (0..columns).map(|at| libm::exp10(3.0 + at as f64 / 4.0)).collect(),
        up: (0..rows).map(|at| 0.05 + 0.1 * at as f64).collect(),
        cells: (0..columns * rows).map(|at| [Some(0), Some(1), None][at % 3]).collect(),
        ticks: vec![(0.5, ["0.5".to_owned(), "T/18".to_owned()])],
        lines: vec![(1.0, "predicted limit"), (0.7, "stretched")],
        axes: ["k/m (1/s²)", "share", "step"].map(str::to_owned),
    };
    let page = Page {
        title: "Maps".to_owned(),
        caption: vec!["one line".to_owned()],
        contents: Contents::Maps(vec![map(13, 12), map(1, 1), map(0, 0)], 2),
    };
    let (areas, high) = page.areas();
    let (.., Room { around: [left, above, right, below], .. }) = page.parts();
    for (at, one) in areas.iter().enumerate() {
        assert!(one[0] - left >= MARGIN && one[2] + right <= WIDE - MARGIN && one[3] + below <= high, "{areas:?}");
        let apart = |other: &Area| one[0] - left > other[2] + right || one[1] - above >= other[3] + below;
        assert!(areas[..at].iter().all(apart), "{areas:?}");
    }
    assert!(high > 600.0);
    let diagram = page.diagram();
    let svg = vector::write(&vector::Page::new(diagram.picture()), vector::Format::Svg).expect("built-in fonts");
    let svg = String::from_utf8(svg).expect("a text");
    // One for each cell, and one in the legend.
    for (colour, count) in [("#b9c7d6", 13 * 4 + 1 + 1), ("#e2661c", 13 * 4 + 1)] {
        assert_eq!(svg.matches(colour).count(), count, "{colour}");
    }
}
