//! Diagnostics over time below the panels.

use super::listed::{Composer, Curve, Listed, Mark, line};
use super::{assert_words_are_clear, fig4b, gpu, parse, renderer, unknown};
use localshape::look::{Style, Theme};
use localshape::picture::{TextRun, Weight, left_out};
use localshape::runner::Frame;
use localshape::runner::Runner;
use localshape::runner::history::History;
use localshape::scene::Scene;
use localshape::sim::{Diagnostic, Status};

/// The scene of Fig. 4(b) with a chart, and some of its frames.
fn with_chart<const N: usize>(chart: Diagnostic, frames: [u64; N]) -> (Scene, [Frame; N]) {
    let (mut scene, _) = fig4b(0);
    scene.view.charts = vec![chart.into()];
    let mut runner = Runner::new(&scene, &[0, 1]);
    let frames = frames.map(|index| runner.frame(index));
    (scene, frames)
}

/// The picture of a frame by a composer that has the scene's time series.
fn compose(scene: &Scene, frame: &Frame) -> Listed {
    let [picture] = pictures(scene, std::array::from_ref(frame));
    picture
}

/// Pictures of frames by one composer that has the scene's time series.
fn pictures<const N: usize>(scene: &Scene, frames: &[Frame; N]) -> [Listed; N] {
    let runs: Vec<_> = frames[0].runs.iter().map(|run| run.run).collect();
    let composer = Composer::new(scene, &History::new(scene, &runs));
    frames.each_ref().map(|frame| composer.compose(frame))
}

/// The line of the present moment.
fn moments(picture: &Listed) -> Vec<&Curve> {
    picture.curves.iter().filter(|curve| curve.alpha == 0.75).collect()
}

/// The circles around present values.
fn circles(picture: &Listed) -> Vec<&Curve> {
    let is_closed = |points: &[[f32; 2]]| points.len() == 5 && (points[0][0] - points[4][0]).abs() < 1e-3;
    picture.curves.iter().filter(|curve| is_closed(&curve.points)).collect()
}

/// The middle of a circle.
fn middle(circle: &Curve) -> [f32; 2] {
    [0, 1].map(|axis| circle.points[1..].iter().map(|point| point[axis]).sum::<f32>() / 4.0)
}

/// The curves of time series: no other curves are as wide.
fn series(picture: &Listed) -> Vec<&Curve> {
    let all = picture.curves.iter().filter(|curve| curve.points.len() > 1 && curve.alpha == 1.0);
    let widest = all.clone().map(|curve| curve.width).fold(0.0, f32::max);
    all.filter(|curve| curve.width == widest).collect()
}

/// The leader lines from the ends of curves to their names.
fn is_leader(curve: &Curve) -> bool {
    curve.alpha == 0.7
}

/// The distance of a point from a segment.
fn off_segment(point: [f32; 2], ends: &[[f32; 2]]) -> f32 {
    let [point, from, to] = [point, ends[0], ends[1]].map(glam::Vec2::from);
    let way = to - from;
    let share = ((point - from).dot(way) / way.length_squared().max(1e-12)).clamp(0.0, 1.0);
    point.distance(from + share * way)
}

#[test]
fn nothing_but_the_present_moment_moves() {
    for chart in [Diagnostic::TurnedOver, Diagnostic::Kinetic, Diagnostic::Residual] {
        let (scene, frames) = with_chart(chart, [0, 3, 40, 180]);
        let pictures = pictures(&scene, &frames);
        // Below the captions of the panels.
        const CHART: f32 = 560.0;
        let still = |picture: &Listed| {
            let moving = [moments(picture), circles(picture)].concat();
            let curves = picture.curves.iter().filter(|curve| !moving.contains(curve) && curve.points[0][1] > CHART);
            let curves: Vec<_> = curves.cloned().collect();
            let marks: Vec<Mark> = picture.marks.iter().filter(|mark| mark.rectangle[1] > CHART).copied().collect();
            let words: Vec<TextRun> = picture.words.iter().filter(|run| run.baseline > CHART).cloned().collect();
            (curves, marks, words)
        };
        let first = still(&pictures[0]);
        assert!(!first.0.is_empty() && first.1.len() > 5 && first.2.len() > 5, "{chart:?}");
        let mut places = Vec::new();
        for picture in &pictures {
            assert_eq!(still(picture), first, "{chart:?}");
            // One chart for both runs.
            assert_eq!(moments(picture).len(), 1);
            places.push(moments(picture)[0].points[0][0]);
        }
        assert!(places.windows(2).all(|two| two[0] < two[1]), "{places:?}");
    }
}

#[test]
fn the_present_moment_is_on_the_curves_and_hides_none() {
    let (scene, frames) = with_chart(Diagnostic::ShapeError, [0, 4, 57, 180]);
    for (frame, picture) in frames.iter().zip(pictures(&scene, &frames)) {
        let (line, series, circles) = (moments(&picture), series(&picture), circles(&picture));
        assert_eq!((line.len(), series.len(), circles.len()), (1, 2, 2));
        let place = |wanted: &Curve| picture.curves.iter().position(|curve| curve == wanted).expect("one of them");
        for ((run, one), circle) in frame.runs.iter().zip(series).zip(circles) {
            // The line is drawn before the curves; the circles are lines around them and cover nothing.
            assert!(place(line[0]) < place(one) && circle.width < 2.0);
            let ends = [one.points[0][0], one.points[one.points.len() - 1][0]];
            let expected = ends[0] + (ends[1] - ends[0]) * (run.snapshot.time / scene.duration) as f32;
            let [x, y] = middle(circle);
            assert!((x - expected).abs() < 0.3 && (line[0].points[0][0] - expected).abs() < 0.3, "{x} for {expected}");
            let off = one.points.windows(2).map(|two| off_segment([x, y], two)).fold(f32::MAX, f32::min);
            assert!(off < 0.15, "{off}");
            // The first run is solid, the second one dashed.
            assert_eq!(
                (!one.dash.is_empty(), one.colour),
                (run.run == 1, scene.runs[run.run].line(&picture.palette).colour)
            );
            assert_eq!(circle.colour, one.colour);
        }
    }
}

#[test]
fn a_short_story_has_a_scale_of_its_own_and_its_events_recur_in_the_panels() {
    let (scene, frames) = with_chart(Diagnostic::TurnedOver, [0, 4]);
    let [before, after] = pictures(&scene, &frames);
    let said = |text: &str| before.words.iter().filter(|word| word.text == text).collect::<Vec<_>>();
    // All changes are in the first 102 ms of 3 s.
    assert!(said("150 ms").len() == 1 && said("3 s").len() == 1, "two scales of time");
    // Curves on both scales, of both runs.
    assert_eq!(series(&before).len(), 4);
    for (number, words) in [("1", "first turned over at 20 ms"), ("2", "settles at 9 after 102 ms")] {
        let flags: Vec<_> = said(number).into_iter().filter(|word| word.weight == Weight::SemiBold).collect();
        let [chart, panel] = flags[..] else { panic!("a flag in the panel and one in the chart") };
        let [words] = said(words)[..] else { panic!("{words} is not said") };
        assert!((words.baseline - panel.baseline).abs() < 3.0);
        assert!(panel.span[1] < words.span[0] && words.span[0] > 640.0, "in the panel of the springs");
        assert!(chart.baseline > 560.0);
    }
    // Rings of past events are filled.
    let ring = |picture: &Listed, number: &str| {
        let is_flag = |word: &&TextRun| word.text == number && word.weight == Weight::SemiBold;
        let word = picture.words.iter().rfind(is_flag).expect("a number").clone();
        let is_below = |curve: &&Curve| {
            let [left, top, right, bottom] = word.bounds();
            curve.points.len() == 1
                && (left..right).contains(&curve.points[0][0])
                && (top..bottom).contains(&curve.points[0][1])
        };
        picture.curves.iter().rfind(is_below).expect("its ring").colour
    };
    let ground = before.palette.background;
    assert_eq!([ring(&before, "1"), ring(&before, "2"), ring(&after, "2")], [ground; 3]);
    assert_ne!(ring(&after, "1"), ground);
}

/// If panels have no room to explain a number, the chart does not have it either.
#[test]
fn flags_are_those_that_panels_explain() {
    let (mut scene, _) = with_chart(Diagnostic::TurnedOver, [0]);
    let mut counts = Vec::new();
    for size in [[1280, 720], [500, 720], [300, 720], [1280, 260]] {
        scene.view.size = size;
        scene.view.columns = Some(2);
        let composer = Composer::new(&scene, &History::new(&scene, &[0, 1]));
        let picture = composer.compose(&Runner::new(&scene, &[0, 1]).frame(0));
        let is_number = |word: &&TextRun| ["1", "2"].contains(&&*word.text) && word.weight == Weight::SemiBold;
        let explained = |word: &&TextRun| word.text.starts_with("first turned") || word.text.starts_with("settles");
        let [numbers, words] = [&is_number as &dyn Fn(&&TextRun) -> bool, &explained]
            .map(|one| picture.words.iter().filter(|word| one(word)).count());
        assert_eq!(numbers, 2 * words, "{size:?}");
        counts.push(words);
    }
    assert!(counts[0] == 2 && counts.iter().any(|&count| count < 2), "{counts:?}");
}

/// A count that goes up and down in every second moment.
#[test]
fn what_chatters_is_a_band() {
    let (mut scene, [frame]) = with_chart(Diagnostic::TurnedOver, [0]);
    let mut history = History::new(&scene, &[0, 1]);
    for (at, diagnostics) in history.series[1].diagnostics.iter_mut().enumerate() {
        diagnostics.turned_over = 5 + 4 * (at % 2);
    }
    let composer = Composer::new(&scene, &history);
    let picture = composer.compose(&frame);
    let drawn: usize = series(&picture).iter().map(|curve| curve.points.len()).sum();
    assert!(drawn < 40, "{drawn} points of curves");
    let widest = picture.marks.iter().filter(|mark| mark.rectangle[1] > 560.0 && mark.rectangle[3] > 5.0);
    let widest = widest.map(|mark| mark.rectangle[2]).fold(0.0, f32::max);
    assert!(widest > 600.0, "a band over most of the chart, not {widest} px");
    // Each chart says what it is where there is room, and never half of that.
    let mut said = Vec::new();
    for (charts, height) in (1..=4).flat_map(|charts| [400, 560, 720].map(|height| (charts, height))) {
        (scene.view.charts, scene.view.size[1]) = (vec![Diagnostic::TurnedOver.into(); charts], height);
        let picture = Composer::new(&scene, &history).compose(&frame);
        let count = |line: &str| picture.words.iter().filter(|word| word.text == line).count();
        let lines = ["filled where it", "oscillates fast"].map(count);
        assert_eq!(lines[0], lines[1], "{charts} charts in {height} px");
        said.push(lines[0]);
    }
    assert!(said.contains(&1) && said.contains(&0), "{said:?}");
}

#[test]
fn the_present_moment_is_at_its_pixel() {
    let Some(gpu) = gpu("the_present_moment_is_at_its_pixel") else { return };
    for theme in [Theme::Light, Theme::Dark] {
        let (mut scene, frames) = with_chart(Diagnostic::ShapeError, [50]);
        scene.view.look = Style::of(theme);
        let [picture] = pictures(&scene, &frames);
        let mut renderer = renderer(gpu, scene.view.size);
        let image = renderer.draw(&picture).expect("the device works");
        let ground = picture.palette.background;
        let off = |x: u32, y: u32| -> u32 {
            image.get_pixel(x, y).0.iter().zip(ground).map(|(&a, b)| u32::from(a.abs_diff(b))).sum()
        };
        let [[x, top], [_, bottom]] = moments(&picture)[0].points[..] else { panic!("two ends") };
        let column = x.floor() as u32;
        let rows = (top as u32 + 2)..(bottom as u32 - 1);
        let seen = |column: u32| rows.clone().filter(|&row| off(column, row) > 150).count();
        // Two neighbours share a line between them; elsewhere lines cross only curves.
        let here = rows.clone().filter(|&row| (column - 1..=column + 1).map(|x| off(x, row)).sum::<u32>() > 300);
        assert!(here.count() > rows.len() / 2, "{theme:?}");
        for beside in [column - 12, column + 12] {
            assert!(seen(beside) < rows.len() / 4, "{theme:?}: {}", seen(beside));
        }
    }
}

#[test]
fn a_frame_composed_alone_has_the_same_charts() {
    let (scene, frames) = with_chart(Diagnostic::TurnedOver, [0, 9]);
    let pictures = pictures(&scene, &frames);
    assert_eq!(compose(&scene, &frames[1]), pictures[1]);
    // Only one run, without the other and with its own scale.
    let alone = Frame { runs: vec![frames[1].runs[0].clone()], ..frames[1].clone() };
    let picture = compose(&scene, &alone);
    assert!(picture.curves.len() == 3 && series(&picture)[0].dash.is_empty() && circles(&picture).len() == 1);
    // Without the time series of the scene no chart is drawn.
    assert!(unknown(&scene).compose(&frames[1]).curves.is_empty());
}

#[test]
fn any_size_has_room_for_charts_or_none() {
    let (mut scene, [frame]) = with_chart(Diagnostic::ShapeError, [4]);
    let history = History::new(&scene, &[0, 1]);
    let sizes = [
        ([1, 1], Some(false)),
        ([64, 64], Some(false)),
        ([333, 77], Some(false)),
        ([65, 1025], None),
        ([240, 240], None),
        ([640, 360], Some(true)),
        ([480, 720], Some(true)),
        ([1280, 720], Some(true)),
        ([3840, 2160], Some(true)),
    ];
    for (size, any) in sizes {
        for columns in [1, 2] {
            scene.view.size = size;
            scene.view.columns = Some(columns);
            let composer = Composer::new(&scene, &history);
            let picture = composer.compose(&frame);
            assert!(any.is_none_or(|any| any != picture.curves.is_empty()), "{size:?} {columns}");
            for run in &picture.words {
                assert!(run.span[0] >= 0.0 && run.span[1] <= size[0] as f32, "{size:?} {columns}: {run:?}");
                assert!(run.baseline <= size[1] as f32, "{size:?} {columns}: {run:?}");
            }
            for (at, one) in picture.words.iter().enumerate() {
                for other in &picture.words[..at] {
                    let beside = one.span[1] <= other.span[0] || other.span[1] <= one.span[0];
                    let apart = (one.baseline - other.baseline).abs() >= 0.85 * one.size.min(other.size);
                    assert!(beside || apart, "{size:?} {columns}: `{}` and `{}`", one.text, other.text);
                }
            }
        }
    }
}

#[test]
fn what_a_model_does_not_have_is_said() {
    let (scene, [frame]) = with_chart(Diagnostic::Residual, [4]);
    let picture = compose(&scene, &frame);
    assert!(picture.words.iter().any(|run| run.text == "rad/s²"));
    // Only the existing curve has a name.
    let colour = scene.runs[0].line(&picture.palette).colour;
    assert!(series(&picture).iter().all(|curve| curve.colour == colour) && circles(&picture).len() == 1);
    let named = |name: &str| picture.words.iter().filter(|run| run.text == name).count();
    assert_eq!((named("Local shape"), named("Mass-spring")), (2, 1));

    let springs = Frame { runs: vec![frame.runs[1].clone()], ..frame };
    let picture = compose(&scene, &springs);
    assert!(picture.words.iter().any(|run| run.text == "none"));
    assert_eq!(picture.curves.len(), 1);
}

#[test]
fn a_run_that_blows_up_ends_with_a_cross() {
    let text = include_str!("../../scenes/explicit-euler.toml");
    let scene = parse(text);
    let mut runner = Runner::new(&scene, &[1, 2]);
    let frame = runner.frame(scene.last_frame());
    let Status::Diverged(divergence) = frame.runs[1].snapshot.status else { panic!("this one blows up") };
    let picture = compose(&scene, &frame);
    let is_arm = |curve: &&Curve| {
        let is_short = matches!(curve.points[..], [[left, _], [right, _]] if (2.0..20.0).contains(&(right - left)));
        is_short && !is_leader(curve)
    };
    let arms: Vec<_> = picture.curves.iter().filter(is_arm).collect();
    assert_eq!(arms.len(), 2);
    let middle = |curve: &Curve| (curve.points[0][0] + curve.points[1][0]) / 2.0;
    let all = series(&picture);
    let of_calm: Vec<_> = all.iter().filter(|one| one.dash == all[0].dash).collect();
    assert_eq!(middle(arms[0]), middle(arms[1]));
    // The time of the divergence as a fraction of the width, which the line of the present moment now shows.
    let now = moments(&picture)[0].points[0];
    let start = of_calm[0].points[0][0];
    let expected = start + (now[0] - start) * (divergence.time / frame.time) as f32;
    assert!((middle(arms[0]) - expected).abs() < 0.5, "{} for {expected}", middle(arms[0]));
    assert!(picture.words.iter().any(|word| word.text.starts_with("diverges at ")), "a flag says it");
    // The other run's curve is not compressed, and only that run has a value now.
    assert_eq!(circles(&picture).len(), 1);
    let height = moments(&picture)[0].points[1][1] - of_calm[0].points[0][1];
    assert!(height > 10.0, "the calm curve is {height} px high");
    assert!(picture.curves.iter().flat_map(|curve| &curve.points).all(|[_, y]| (0.0..=840.0).contains(y)));
}

/// A curve of many pieces looks like one.
#[test]
fn joints_do_not_show() {
    let Some(gpu) = gpu("joints_do_not_show") else { return };
    let (mut scene, frame) = fig4b(0);
    scene.view.size = [200, 100];
    let mut renderer = renderer(gpu, scene.view.size);
    let mut draw = |points: Vec<[f32; 2]>, dash: &[f32]| {
        let mut picture = compose(&scene, &frame);
        picture.panels.clear();
        picture.above = vec![line(&points, 2.2, dash, ([0; 3], 0.5))];
        renderer.draw(&picture).expect("the device works")
    };
    for (from, to) in [([10.0, 20.3], [190.0, 20.3]), ([10.0, 10.0], [190.0, 77.0]), ([99.7, 95.0], [102.0, 5.0])] {
        for dash in [&[][..], &[7.0, 4.0], &[11.0, 3.0, 2.5, 3.0], &[7.0, 3.0, 2.5, 3.0, 2.5, 3.0]] {
            let at = |share: f32| [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])];
            let whole = draw(vec![from, to], dash);
            let pieces = draw((0..=60).map(|at_piece| at(at_piece as f32 / 60.0)).collect(), dash);
            let off = whole.iter().zip(pieces.iter()).map(|(a, b)| a.abs_diff(*b)).max();
            assert!(off <= Some(3), "{from:?} {to:?} {dash:?}: {off:?}");
            assert!(whole.pixels().any(|pixel| pixel[0] < 160));
        }
    }
    // Nowhere is it darker than its own opacity, even at sharp turns.
    let zigzag = (0..30).map(|at| [10.0 + 3.0 * at as f32, if at % 2 == 0 { 20.0 } else { 80.0 }]).collect();
    let darkest = draw(zigzag, &[]).pixels().map(|pixel| pixel[0]).min();
    assert!(darkest >= Some(124), "{darkest:?}");
}

/// A bar that sags in runs of one model, which differ in stiffness.
pub(crate) fn alike(runs: usize, theme: &str) -> String {
    let run = |at: usize| {
        let stiffness = (at + 1) * 500;
        format!("[[run]]\nname = 'k = {stiffness}'\nmodel = {{ kind = 'shape-based', stiffness = {stiffness} }}\n")
    };
    let runs: String = (0..runs).map(run).collect();
    format!(
        "gravity = [0, -9.8, 0]\ntime = {{ duration = 0.4, frames_per_second = 20 }}\n\
         body = {{ lattice = {{ cells = [3, 1, 1], side = 0.1 }}, mass = 0.1 }}\n{runs}\
         [[hold]]\nnodes = {{ low = [-0.16, 0, -1], high = [-0.14, 1, 1] }}\n\
         [view]\nsize = [1600, 900]\ntheme = '{theme}'\ncharts = ['energy']\n"
    )
}

/// The appearance of a curve: colour and dashes, relative to the first dash.
fn look_of(curve: &Curve) -> ([u8; 3], Vec<i32>) {
    let first = curve.dash.first().copied().unwrap_or(1.0);
    (curve.colour, curve.dash.iter().map(|length| (length / first * 100.0).round() as i32).collect())
}

fn each_differs<T: PartialEq + std::fmt::Debug>(all: &[T]) {
    for (at, one) in all.iter().enumerate() {
        assert!(!all[..at].contains(one), "{one:?} stands for two runs");
    }
}

#[test]
fn eight_runs_of_one_model_are_told_apart() {
    for theme in ["light", "dark"] {
        let scene = parse(&alike(8, theme));
        let all: Vec<_> = (0..8).collect();
        let frame = Runner::new(&scene, &all).frame(scene.last_frame());
        let picture = compose(&scene, &frame);
        // The same line is below the name.
        let own = picture.curves.iter().filter(|curve| curve.points.len() > 2 && curve.alpha == 1.0);
        let own: Vec<_> = own.filter(|curve| !circles(&picture).contains(curve)).collect();
        assert_eq!(own.len(), 8);
        let looks: Vec<_> = own.iter().map(|curve| look_of(curve)).collect();
        assert!(looks.iter().all(|look| look.0 == looks[0].0), "one model has one colour");
        each_differs(&looks.iter().map(|look| look.1.clone()).collect::<Vec<_>>());
        for (run, curve) in scene.runs.iter().zip(&own) {
            let line = run.line(&picture.palette);
            assert_eq!((line.colour, line.dash.len()), (curve.colour, curve.dash.len()));
            let name = picture.words.iter().rfind(|word| word.text == run.name).expect("a name above the panel");
            let [_, top, right, bottom] = name.bounds();
            let sample = picture.marks.iter().find(|mark| {
                let [x, y, ..] = mark.rectangle;
                mark.shape == "sample" && x > right && x < right + 40.0 && top < y && y < bottom
            });
            assert_eq!(sample.expect("a sample beside it").colour, line.colour);
        }
        // All names stand at the ends of the curves, legible and apart from each other.
        for run in &scene.runs {
            let names: Vec<_> = picture.words.iter().filter(|word| word.text == run.name).collect();
            assert_eq!(names.len(), 2, "{}", run.name);
        }
        assert_words_are_clear(&picture, theme);
        // They are also apart from the present values, which are now at the end.
        for circle in circles(&picture) {
            let [x, y] = middle(circle);
            let radius = circle.points[0][0] - x + circle.width / 2.0;
            for word in &picture.words {
                let [left, top, right, bottom] = word.bounds();
                let beside = x + radius <= left || right <= x - radius;
                assert!(beside || y + radius <= top || bottom <= y - radius, "a circle over “{}”", word.text);
            }
        }
        // Each run keeps its line for any selection of runs.
        let few = Frame { runs: vec![frame.runs[6].clone(), frame.runs[2].clone()], ..frame.clone() };
        let picture = compose(&scene, &few);
        let shown = picture.curves.iter().filter(|curve| curve.points.len() > 3 && !circles(&picture).contains(curve));
        let shown: Vec<_> = shown.map(look_of).collect();
        assert!(shown.iter().all(|look| [&looks[6], &looks[2]].contains(&look)) && shown.len() == 2, "{shown:?}");
    }
}

/// Several bodies have one curve a run, or on request one each, with a name. Curves whose names have no room are left out, and counted.
#[test]
fn bodies_have_curves_with_names_or_none() {
    let body = |at: u32| {
        let lattice = "lattice = { cells = [1, 1, 1], side = 0.1 }";
        let offset = format!("offset = [{}, {}, 0]", 0.2 * f64::from(at), 0.01 * f64::from(at));
        format!("[[body]]\nname = 'body {at}'\n{lattice}\n{offset}\n")
    };
    let charts = |count: u32, charts: &str| {
        let bodies: String = (0..count).map(body).collect();
        // Of one model, and so of one colour.
        let runs: String = ["soft", "stiff"]
            .map(|name| format!("[[run]]\nname = '{name}'\nmodel = {{ kind = 'shape-based', stiffness = 1e3 }}\n"))
            .concat();
        let scene = parse(&format!(
            "gravity = [0, -9.8, 0]\ntime = {{ duration = 0.2 }}\n{bodies}{runs}\
             [view]\nsize = [1280, 840]\ncharts = [{charts}]\n"
        ));
        let frame = Runner::new(&scene, &[0, 1]).frame(3);
        compose(&scene, &frame)
    };
    let is_name = |word: &&TextRun| word.text.contains(" · ");
    let whole = charts(3, "'kinetic'");
    assert_eq!((series(&whole).len(), whole.words.iter().filter(is_name).count()), (2, 0));
    let split = charts(3, "{ plot = 'kinetic', by = 'body' }");
    let mut names: Vec<_> = split.words.iter().filter(is_name).map(|word| word.text.clone()).collect();
    names.sort_unstable();
    let expected = ["soft", "stiff"].map(|run| [0, 1, 2].map(|at| format!("{run} · body {at}")));
    assert_eq!(names, expected.concat());
    let looks: Vec<_> = series(&split).into_iter().map(look_of).collect();
    assert_eq!(looks.len(), 6, "{looks:?}");
    each_differs(&looks);
    let many = charts(12, "{ plot = 'kinetic', by = 'body' }");
    let named = many.words.iter().filter(is_name).count();
    let told = many.words.iter().find(|word| word.text.ends_with(" of 24 curves")).map(|word| word.text.clone());
    assert!((2..24).contains(&named) && told == Some(format!("{named} of 24 curves")), "{named} {told:?}");
    assert_eq!(series(&many).len(), named);
    // Both runs are among them.
    let of_soft = many.words.iter().filter(is_name).filter(|word| word.text.starts_with("soft")).count();
    assert!((named / 2..=named.div_ceil(2)).contains(&of_soft), "{of_soft} of {named}");
}

/// At the usual sizes and in the usual columns one chart shows all curves, and names them.
#[test]
fn one_chart_names_the_curves_of_many_runs() {
    for size in [[1280, 720], [1600, 1000]] {
        for runs in 2..=12 {
            let columns = runs.min(3);
            let view = format!("{size:?}\npanels = {columns}");
            let text = alike(runs, "light").replace("[1600, 900]", &view);
            let scene = parse(&text);
            let all: Vec<_> = (0..runs).collect();
            let picture = compose(&scene, &Runner::new(&scene, &all).frame(scene.last_frame()));
            let case = format!("{runs} runs in {size:?}");
            assert_eq!((moments(&picture).len(), circles(&picture).len()), (1, runs), "{case}");
            let bottom = picture.panels.iter().map(|panel| panel.viewport[1] + panel.viewport[3]).max();
            let bottom = bottom.expect("panels") as f32;
            let is_there = |name: &str| picture.words.iter().any(|word| word.text == name && word.baseline > bottom);
            let named = scene.runs.iter().filter(|run| is_there(&run.name)).count();
            assert!(named >= runs.min(7), "{named} of {case}");
            assert_words_are_clear(&picture, &case);
        }
    }
}

#[test]
fn what_stands_for_more_than_eight_runs_differs_in_colour_or_dashes() {
    let scene = parse(&alike(64, "light"));
    each_differs(&scene.runs.iter().map(|run| run.line(&scene.view.look.palette())).collect::<Vec<_>>());
}

/// A test machine: below the charts over time, without their moment, and with a ring at the present values.
#[test]
fn a_chart_against_a_displacement_has_an_axis_of_its_own() {
    let scene = parse(
        "time = { duration = 1, step = 1e-3 }\nbody = { lattice = { cells = [4, 1], side = 0.1 }, density = 1000 }\n\
         run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1e4, damping_ratio = 0.5 } }]\n\
         hold = [{ nodes = 'left' }]\n\
         grab = [{ nodes = 'right', path.keys = [{ time = 0 }, { time = 0.5, shift = [0.04, 0] }, { time = 1 }] }]\n\
         view = { size = [1280, 900], charts = [{ plot = 'force', of = 'grab[0]', against = 'grab[0]' }, 'kinetic'] }\n",
    );
    let frames = [15, 45].map(|index| Runner::new(&scene, &[0]).frame(index));
    let pictures = pictures(&scene, &frames);
    for picture in &pictures {
        let at = |text: &str| picture.words.iter().find(|word| word.text == text).map(|word| word.baseline);
        let [time, own] = [at("Kinetic energy"), at("Force of grab[0]")];
        assert!(time.is_some() && time < own && own < at("against displacement"), "{time:?} {own:?}");
        let rings: Vec<_> = circles(picture).into_iter().map(middle).collect();
        assert_eq!((moments(picture).len(), rings.len()), (1, 2), "{rings:?}");
        assert!(at("40 mm").is_some_and(|axis| Some(axis) > own), "numbers of its own below it");
    }
    // On the way back the force is smaller at the same displacement: damping takes work.
    let [there, back] = pictures.each_ref().map(|picture| middle(circles(picture)[1]));
    assert!(back[1] > there[1] + 1.0, "{there:?} {back:?}");
}

#[test]
fn several_charts_have_one_axis_of_time() {
    let (mut scene, [frame]) = with_chart(Diagnostic::TurnedOver, [90]);
    scene.view.charts = vec![Diagnostic::TurnedOver.into(), Diagnostic::Energy.into()];
    scene.view.size = [1280, 840];
    let picture = compose(&scene, &frame);
    let said = |text: &str| picture.words.iter().filter(|word| word.text == text).collect::<Vec<_>>();
    let names = ["Turned over", "Total energy"].map(|name| said(name)[..].first().map(|word| word.baseline));
    assert!(names[0].is_some() && names[0] < names[1], "{names:?}");
    // The moment is marked in both, at one place, and the times are written once.
    let [one, other] = moments(&picture)[..] else { panic!("a line in each chart") };
    assert_eq!(one.points[0][0], other.points[0][0]);
    assert_eq!((circles(&picture).len(), said("3 s").len(), said("Mass-spring").len()), (4, 1, 3));
    // Charts without room leave the others in place.
    scene.view.title = "A title".to_owned();
    let more = [Diagnostic::Kinetic, Diagnostic::ShapeError, Diagnostic::Elastic, Diagnostic::Momentum];
    scene.view.charts.extend(more.map(Into::into));
    let shown = moments(&compose(&scene, &frame)).len();
    assert!((2..6).contains(&shown), "{shown}");
    assert!(left_out(&scene).contains(&format!("only {shown} of 6 charts have room")));
}

#[test]
fn a_chart_of_what_is_broken_says_what_breaks() {
    let brittle =
        |text: String| text.replace("energy", "broken").replace("'shape-based',", "'shape-based', breaks_at = 9,");
    let said = |text: &str| {
        let scene = parse(text);
        let picture = compose(&scene, &Runner::new(&scene, &[0, 1]).frame(0));
        picture.words.into_iter().map(|word| word.text).collect::<Vec<_>>()
    };
    let same = brittle(alike(2, "light"));
    assert!(said(&same).contains(&"of 3 cubes".to_owned()), "{:?}", said(&same));
    let mixed = same.replacen("'shape-based'", "'mass-spring'", 1);
    assert!(said(&mixed).contains(&"% of elements, springs".to_owned()), "{:?}", said(&mixed));
    // The same share of 60 springs and of 3 cubes.
    let scene = parse(&mixed);
    let mut frame = Runner::new(&scene, &[0, 1]).frame(0);
    for (run, broken) in frame.runs.iter_mut().zip([0.3, 0.015]) {
        run.snapshot.diagnostics.broken = broken;
    }
    let heights: Vec<_> = circles(&compose(&scene, &frame)).iter().map(|circle| circle.points[0][1]).collect();
    assert!(heights.len() == 2 && (heights[0] - heights[1]).abs() < 1e-3, "{heights:?}");
}

#[test]
fn an_axis_that_does_not_begin_at_zero_says_so() {
    for (diagnostic, is_said) in [("volume_ratio", true), ("energy", false)] {
        let scene = parse(&alike(2, "light").replace("energy", diagnostic));
        let picture = compose(&scene, &Runner::new(&scene, &[0, 1]).frame(0));
        assert_eq!(picture.words.iter().any(|word| word.text == "not from zero"), is_said, "{diagnostic}");
    }
}
