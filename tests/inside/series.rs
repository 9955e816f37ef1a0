//! Time series in charts: their range, their steps and their mean.

use super::*;
use crate::scene::Limits;
use crate::sim::Diagnostics;

/// Values at 0, 1, 2 … s.
fn series(values: &[f64], diverged: bool) -> Series {
    let points = values.iter().enumerate().map(|(at, &value)| [at as f64, value]).collect();
    let style = LineStyle { colour: [0; 3], dash: &[] };
    let diverged = diverged.then_some(values.len() as f64);
    let (name, members) = Default::default();
    let times = Vec::new();
    Series {
        run: 0,
        name,
        style,
        is_count: false,
        is_part: false,
        divisor: 1.0,
        points,
        times,
        members,
        diverged,
        is_end: false,
    }
}

#[test]
fn one_range_holds_all_runs_and_zero() {
    let range = |all: &[&[f64]]| range(&all.iter().map(|values| series(values, false)).collect::<Vec<_>>(), true);
    assert_eq!(range(&[&[1.0, 2.0, 3.0], &[-0.5, 0.2]]), Some([-0.5, 3.0]));
    assert_eq!(range(&[&[3.0, 2.0, 5.0]]), Some([0.0, 5.0]));
    // A short peak is not a divergence, and neither is one run with much larger values than the other.
    assert_eq!(range(&[&[3000.0, 1.0, 0.1, 0.1, 0.1]]), Some([0.0, 3000.0]));
    assert_eq!(range(&[&[0.001; 8], &[0.1; 8]]), Some([0.0, 0.1]));
    // Zero is far from a volume that hardly changes, and a constant value has some room.
    assert_eq!(range(&[&[1.0, 1.05, 0.97]]), Some([0.97, 1.05]));
    let [low, high] = range(&[&[1.0, 1.0]]).unwrap();
    assert!(low < 1.0 && 1.0 < high && high - low < 0.03, "{low} {high}");
    assert_eq!((range(&[]), range(&[&[]])), (None, None));
    assert_eq!(range(&[&[0.0, 0.0]]), Some([0.0, 0.0]));
}

/// More moments than bodies, so that neither is taken for the other.
#[test]
fn each_of_several_bodies_has_a_curve_over_all_times() {
    let bodies = [("one", 0.0), ("other", 0.3)].map(|(name, x)| {
        let lattice = "lattice = { cells = [1, 1, 1], side = 0.1 }";
        format!("[[body]]\nname = '{name}'\n{lattice}\noffset = [{x:?}, 0, 0]\n")
    });
    let text = format!(
        "time = {{ duration = 0.1, frames_per_second = 20 }}\n{}[[run]]\nname = 'run'\n\
         model = {{ kind = 'shape-based', stiffness = 1e4 }}",
        bodies.concat()
    );
    let scene = Scene::parse(&text, "two.toml", &Limits::default()).unwrap_or_else(|error| panic!("{error}"));
    let moved = |kinetic: f64| Diagnostics { kinetic, ..Diagnostics::default() };
    let of_run = TimeSeries {
        times: vec![0.0, 0.1, 0.2],
        of_bodies: vec![[1.0, 2.0, 3.0].map(moved).to_vec(), [4.0, 5.0, 6.0].map(moved).to_vec()],
        ..TimeSeries::default()
    };
    let palette = scene.view.look.palette();
    let curves: Vec<_> = Series::of_bodies(Diagnostic::Kinetic, &of_run, (&scene, "run"), &palette).collect();
    assert_eq!(curves.iter().map(|curve| &*curve.name).collect::<Vec<_>>(), ["run · one", "run · other"]);
    assert_eq!(curves[0].style.colour, curves[1].style.colour);
    assert_eq!(curves[1].points, [[0.0, 4.0], [0.1, 5.0], [0.2, 6.0]]);
    assert_eq!(curves[0].points, [[0.0, 1.0], [0.1, 2.0], [0.2, 3.0]]);
}

/// A force that was averaged over an interval stands over the displacement in its middle, once, also on the way back.
#[test]
fn forces_stand_over_the_middle_of_their_intervals() {
    let moments: Vec<f64> = (0..=20).map(|at| 0.05 * f64::from(at)).collect();
    let way = |time: f64| if time <= 0.5 { time } else { 1.0 - time };
    let ways: Vec<_> = moments.iter().map(|&time| [time, way(time)]).collect();
    // The mean of the last whole fifth of a second.
    let forces: Vec<_> = moments.iter().map(|&time| [time, 10.0 * ((time + 1e-9) / 0.2).floor()]).collect();
    let (times, points) = of_intervals(&forces, &ways, 0.2, 1e-3);
    let expected = [(0.2, [0.1, 10.0]), (0.4, [0.3, 20.0]), (0.6, [0.5, 30.0]), (0.8, [0.3, 40.0]), (1.0, [0.1, 50.0])];
    assert_eq!(times.len(), 5, "{times:?}");
    for ((time, point), (at, [x, y])) in times.iter().zip(&points).zip(expected) {
        assert!((time - at).abs() < 1e-12 && (point[0] - x).abs() < 1e-12 && point[1] == y, "{time}: {point:?}");
    }
}

#[test]
fn diverged_runs_do_not_set_the_scale() {
    let calm = series(&[1.0, 2.0, 1.5, 1.0, 1.0, 1.0], false);
    let blown = series(&[1.0, 2.0, 5.0, 40.0, 1e9, 1e300], true);
    assert_eq!(range(&[calm, blown], true), Some([0.0, 5.0]));
    // Lasting values are shown in full, however late they begin.
    let late = series(&[0.0, 0.0, 0.0, 0.0, 9.0, 9.0], false);
    assert_eq!(range(&[series(&[0.0; 6], false), late], true), Some([0.0, 9.0]));
    // Counts are bounded by themselves.
    let counted = series(&[0.0, 0.0, 8.0], true);
    assert_eq!(range(&[series(&[1.0; 3], false), counted], false), Some([0.0, 8.0]));
    // A single run shows half of its values.
    let alone = series(&[1.0, 1.0, 1.0, 2.0, 1e3, 1e9], true);
    assert_eq!(range(&[alone], true), Some([0.0, 2.0]));
}

#[test]
fn counts_go_in_steps() {
    let steps = steps(&[[0.0, 0.0], [1.0, 0.0], [2.0, 3.0], [3.0, 3.0]]);
    assert_eq!(steps, [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 3.0], [3.0, 3.0]]);
}

#[test]
fn several_scenes_have_a_mean_within_their_band() {
    let mean = Series::mean(vec![series(&[0.0, 2.0, 4.0], false), series(&[2.0, 8.0], true)]).expect("two");
    assert_eq!(mean.points, [[0.0, 1.0], [1.0, 5.0]]);
    assert_eq!((mean.members.len(), mean.diverged), (2, Some(2.0)));
    let mean_of = |ends: [f64; 2]| {
        let of = |end| Series { diverged: Some(end), ..series(&[1.0, 2.0], false) };
        Series::mean(ends.map(of).into()).expect("two").diverged
    };
    assert_eq!([mean_of([5.0, 3.0]), mean_of([3.0, 5.0])], [Some(3.0); 2], "it ends with the first divergence");
    // The scale includes all members.
    assert_eq!(range(std::slice::from_ref(&mean), false), Some([0.0, 8.0]));
    // A single scene has no band.
    let alone = Series::mean(vec![series(&[1.0], false)]).expect("one");
    assert!(alone.members.is_empty() && alone.points == [[0.0, 1.0]]);
}

/// What is known at the end of an interval is the mean of it: a collision of 60 to 80 ms stood at 80 to 100 ms.
#[test]
fn mean_forces_are_steps_over_their_intervals() {
    let known = [[0.1, 5.0], [0.15, 5.0], [0.201, 7.0], [0.25, 7.0], [0.4, 1.0]];
    let expected = [[0.0, 5.0], [0.1, 5.0], [0.1, 7.0], [0.201, 7.0], [0.3, 1.0], [0.4, 1.0]];
    let found = over_intervals(&known, 0.1, 0.01);
    let apart = found.as_flattened().iter().zip(expected.as_flattened()).map(|(a, b): (&f64, &f64)| (a - b).abs());
    assert!(found.len() == expected.len() && apart.fold(0.0, f64::max) < 1e-12, "{found:?}");
}
