//! Charts of single things, probes, and what they measure.

use super::{bad, expect, good};
use localshape::look::{Measure, Plot, PlotOf};
use localshape::runner::History;
use localshape::scene::{BodyBuilder, Lattice, Limits, NodeSet, Reading, Scene, Side};
use localshape::sim::model::shape_based;

/// A bar whose left end is held while the right one is pulled by a tenth and back.
const WORLD: &str = "\
time = { duration = 1, step = 1e-3 }
run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1e4, damping_ratio = 0.5 } }]
body = { lattice = { cells = [4, 1, 1], side = 0.1 }, density = 1000 }
hold = [{ nodes = 'left' }]
obstacle = [{ kind = 'floor', name = 'ground', height = -1 }]
grab = [{ nodes = 'right', path.keys = [{ time = 0 }, { time = 0.6, shift = [0.04, 0, 0] }, { time = 1 }] }]
";

/// The readings of a chart of the world, which has a probe.
fn readings(plot: PlotOf) -> (Vec<f64>, Vec<Reading>) {
    let probe = "probe = [{ name = 'end', nodes = 'right' }]\n";
    let text = "view.charts = [{ plot = 'force', of = 'hold[0]' }]\n";
    let mut scene = good(&format!("{WORLD}{probe}{text}"));
    scene.view.charts = vec![Plot::Of(plot)];
    let mut series = History::for_pictures(&scene, &[0]).series.remove(0);
    (series.times, series.readings.remove(0))
}

#[test]
fn charts_name_things_that_are_there() {
    let case = |chart: &str, expected: &str| expect(&bad(&format!("{WORLD}view.charts = [{chart}]")), 6, expected);
    case("{ plot = 'force', of = 'hold[1]' }", "1:39 is \"hold[1]\"; expected an obstacle, a hold, a grab");
    case("{ plot = 'force', of = 'grond' }", "1:39 did you mean \"ground\"?");
    case("{ plot = 'displacement', of = 'end' }", "1:46 expected a probe, a hold, a grab or an obstacle");
    case("{ plot = 'force', of = 'hold[0]', against = 'x' }", "1:60 `view.charts[0].against` is \"x\"");
    case(
        "{ plot = 'force', of = 'hold[0]', against = 'hold[0]' }",
        "1:16 `view.charts[0]` has no `along`, and \"hold[0]\" has no path give the direction",
    );
    case(
        "{ plot = 'force', of = 'hold[0]', along = [0, 1] }",
        "1:58 `view.charts[0].along` has 2 coordinates; expected 3",
    );
    case("{ plot = 'force', of = 'hold[0]', along = [0, 0, 0] }", "1:58 is zero, so it has no direction");
    case(
        "{ plot = 'force', of = 'hold[0]', on = 'a' }",
        "1:55 is \"a\"; expected one of several bodies that a force or a torque acts on; there is none",
    );
    case("{ plot = 'weight', of = 'hold[0]' }", "1:25 expected \"force\", \"torque\" or \"displacement\"");
    case("'hold_forc'", "1:16 did you mean \"hold_force\"?");
    let twice = "{ plot = 'force', of = 'hold[0]' }, { plot = 'force', of = 'hold[0]' }";
    case(twice, "1:52 as is `view.charts[0]`");
    case(
        "{ plot = 'energy', by = 'body' }",
        "1:16 is of each body, but no run has several write the name of the diagnostic alone",
    );
    case("{ plot = 'energy1', by = 'body' }", "1:25 did you mean \"energy\"?");
    case("{ plot = 'energy', by = 'bodies' }", "1:40 expected \"body\"");
}

#[test]
fn probes_have_names_of_their_own() {
    let case = |probe: &str, expected: &str| expect(&bad(&format!("{WORLD}probe = [{probe}]")), 6, expected);
    case("{ name = 'end', nodes = 'tpo' }", "1:34 did you mean \"top\"?");
    case("{ name = 'ground', nodes = 'right' }", "1:19 an obstacle and a probe are called \"ground\"");
    case("{ name = 'hold[0]', nodes = 'right' }", "1:19 a constraint and a probe are called \"hold[0]\"");
    case("{ nodes = 'right' }", "1:10 `probe[0]` has no `name`");
    let two = "{ name = 'a', nodes = 'right' }, { name = 'a', nodes = 'left' }";
    case(two, "1:52 two probes are called \"a\"");
}

/// What holds one end of a bar carries what pulls the other, and the displacement is that of the path.
#[test]
fn what_is_measured_is_what_happens() {
    let (times, pull) = readings(PlotOf::new(Measure::Force, "grab[0]").against("grab[0]"));
    let (_, hold) = readings(PlotOf::new(Measure::Force, "hold[0]").along([-1.0, 0.0, 0.0]));
    let (_, size) = readings(PlotOf::new(Measure::Force, "hold[0]"));
    let (_, end) = readings(PlotOf::new(Measure::Displacement, "end").along([1.0, 0.0, 0.0]));
    let at = times.iter().position(|time| (time - 0.6).abs() < 1e-9).expect("a frame");
    assert!((pull[at].against - 0.04).abs() < 1e-12 && (end[at].value - 0.04).abs() < 1e-12, "{:?}", pull[at]);
    assert!(end[at].range.iter().all(|end| (end - 0.04).abs() < 1e-12));
    assert!(pull[at].value > 5.0 && (pull[at].value - hold[at].value).abs() < 0.1 * pull[at].value, "{:?}", hold[at]);
    assert!((hold[at].value - size[at].value).abs() < 1e-3 * size[at].value, "{:?}", size[at]);
    assert!(pull[0].value.is_nan(), "before the first interval");
}

/// Of two boxes on a floor, the upper one presses on the lower one with its weight, and the floor carries both.
#[test]
fn forces_between_two_bodies_are_charts() {
    let scene = "gravity = [0, -10, 0]\ntime = { duration = 1, frames_per_second = 10, step = 1e-3 }\nmass_damping = 20\n\
                 body = [{ name = 'low', lattice = { cells = [2, 1, 2], side = 0.1 }, density = 100, lowest = 1e-3 },\n\
                 { name = 'high', lattice = { cells = [1, 1, 1], side = 0.1 }, density = 100, lowest = 0.106 }]\n\
                 run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1e4 } }]\n\
                 obstacle = [{ kind = 'floor', name = 'ground' }]\n";
    let last = |of: &str, on: &str| {
        let chart = format!("{{ plot = 'force', of = '{of}', on = '{on}', along = [0, 1, 0] }}");
        let scene = good(&format!("{scene}view.charts = [{chart}]\n"));
        History::for_pictures(&scene, &[0]).series.remove(0).readings[0].last().expect("readings").value
    };
    for (of, on, force) in
        [("high", "low", -1.0), ("low", "high", 1.0), ("ground", "low", 5.0), ("ground", "high", 0.0)]
    {
        assert!((last(of, on) - force).abs() < 0.05, "{of} on {on}: {}", last(of, on));
    }
    let wrong = |chart: &str, words: &str| expect(&bad(&format!("{scene}view.charts = [{chart}]")), 7, words);
    wrong(
        "{ plot = 'force', of = 'low', on = 'low' }",
        "1:51 expected one of several bodies that a force or a torque acts on: \"high\"",
    );
    wrong(
        "{ plot = 'displacement', of = 'ground', on = 'low' }",
        "1:61 expected no `on`, which is a body that a force or a torque acts on",
    );
}

#[test]
fn a_scene_in_code_has_probes_and_charts() {
    let body = BodyBuilder::lattice(Lattice::new([2, 1, 1], 0.1));
    let chart = PlotOf::new(Measure::Displacement, "end");
    let scene = Scene::builder("bar", body).run("one", shape_based::Parameters::new(1e4));
    let scene = scene.probe("end", NodeSet::side(Side::Right)).charts([chart.clone()]).build(&Limits::default());
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((scene.probes[0].nodes[0].len(), scene.view.charts.clone()), (4, vec![Plot::Of(chart)]));
    assert!(scene.summary().to_string().contains("  probe     end: 4 nodes\n"), "{}", scene.summary());
}
