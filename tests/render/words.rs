//! Positions of texts: nowhere overlapping, and the same in every frame.

use super::listed::{Composer, Listed, Mark, heights};
use super::{all, assert_words_are_clear, compose, fig4b, frame, parse, unknown};
use localshape::look::Labels;
use localshape::runner::Runner;
use localshape::runner::history::History;
use localshape::scene::Scene;

/// All texts, in a scene with a run that diverges and one that does not.
const ALL: &str = r#"
title = 'Everything that can be written'
gravity = [0, -9.8, 0]
time = { duration = 0.6, step = 0.005, frames_per_second = 20 }
body = { lattice = { cells = [3, 3, 3], side = 0.1 }, mass = 1.0, lowest = 0.3 }

[[run]]
name = 'Local shape'
model = { kind = 'shape-based', stiffness = 1e4 }

[[run]]
name = 'Mass-spring'
model = { kind = 'mass-spring', stiffness = 1e4, springs = 'edges+face-diagonals' }
integrator = 'explicit-euler'

[[run]]
name = 'A third model with a name that nobody would read to its end'
model = { kind = 'mass-spring', stiffness = 2e4, springs = 'all' }

[[obstacle]]
kind = 'floor'
restitution = 0.5

[view]
title = 'A title above all panels that says what the picture is about, at some length, for the sake of this test'
caption = 'A caption of several sentences. It is set in lines, and goes on until there are at least two of them at every size.'
labels = ['letters', 'name', 'model', 'clock', 'count', 'number', 'scale-bar', 'legend']
charts = ['shape_error']
colour = { by = 'strain' }
"#;

/// Scenes with all kinds of texts, at many sizes and in several layouts.
fn scenes() -> Vec<Scene> {
    let mut scenes = Vec::new();
    let sizes = [[320, 180], [640, 360], [1280, 720], [1920, 1080], [3000, 1688], [700, 1200], [1600, 400], [150, 150]];
    let arrangements = ["", "panels = 'column'", "theme = 'dark'\npanels = 'row'"];
    let shows = ["'surfaces'", "'springs'", "'springs', 'displacements'", "'surfaces', 'springs', 'displacements'"];
    for (number, show) in shows.into_iter().enumerate() {
        for (at, size) in sizes.into_iter().enumerate() {
            // Each pair of values occurs at least once.
            let more = arrangements[(number + at) % 3];
            scenes.push(parse(&format!("{ALL}\nsize = {size:?}\nshow = [{show}]\n{more}\n")));
        }
    }
    scenes
}

/// A chart takes its height from all rows of panels together, and type has the size that it has without a chart.
#[test]
fn a_chart_changes_no_size_of_type() {
    let text = ALL.replace("charts = ['shape_error']", "").replace("title = 'A title", "#").replace("caption = ", "#");
    let more = "[[run]]\nname = 'Fourth'\nmodel = { kind = 'shape-based', stiffness = 1e4 }\n[view]";
    let text = text.replace("[view]", more);
    let sizes = ["", "charts = ['shape_error']"].map(|chart| {
        let picture = {
            let scene = parse(&format!("{text}\nsize = [2000, 800]\npanels = 2\n{chart}\n"));
            compose(&scene, &frame(&scene, 0))
        };
        picture.words.iter().find(|word| word.text.ends_with("Fourth")).expect("the name").size
    });
    assert!((sizes[0] / sizes[1] - 1.0).abs() < 0.01, "{sizes:?}");
}

#[test]
fn no_words_overlap_and_none_leaves_the_picture() {
    for scene in scenes() {
        let picture = compose(&scene, &frame(&scene, scene.last_frame()));
        assert_words_are_clear(&picture, &format!("{:?}", picture.size));
    }
}

/// Left, top, right and bottom of the legend's arrow as drawn.
fn key_arrow(picture: &Listed) -> Option<[f32; 4]> {
    let words = picture.words.iter().find(|word| word.text.starts_with("displacement "))?;
    let [left, top, _, bottom] = words.bounds();
    let is_beside = |mark: &&Mark| {
        let [x, y, width, _] = mark.rectangle;
        mark.shape == "arrow" && mark.along == Mark::UPRIGHT && x + width < left && top < y && y < bottom
    };
    let [x, y, width, height] = picture.marks.iter().rev().find(is_beside)?.rectangle;
    Some([x, y - 0.5 * height, x + width, y + 0.5 * height])
}

#[test]
fn no_words_overlap_and_none_leaves_the_picture_at_any_size_of_type() {
    let shown = "show = ['springs', 'displacements']\n";
    let mut arrows = 0;
    let sizes = [[640, 360], [1280, 720], [700, 1200], [1600, 400], [150, 150]];
    for (number, text_scale) in [(0, 0.5), (1, 1.0), (2, 1.5), (4, 3.0)] {
        // In low panels, charts with type of three times the size have no room for two rows.
        for chart in ["", "charts = ['shape_error']"].into_iter().filter(|chart| chart.is_empty() || text_scale < 3.0) {
            for (at, view) in
                ["", "caption = ''", "caption = '' # no legend", "panels = 'column'"].into_iter().enumerate()
            {
                let text = ALL.lines().filter(|line| !line.starts_with("charts"));
                let text: Vec<_> =
                    text.filter(|line| !view.contains("caption") || !line.starts_with("caption")).collect();
                let mut scene =
                    parse(&format!("{}\n{chart}\n{shown}text_scale = {text_scale}\n{view}\n", text.join("\n")));
                scene.view.labels.legend = !view.contains("no legend");
                // Each pair of type, view and size occurs at least once.
                for size in [0, 1, 2, 3].map(|next| sizes[(number + at + next) % 5]) {
                    scene.view.size = size;
                    let picture = compose(&scene, &Runner::new(&scene, &[0, 1, 2]).frame(3));
                    let place = format!("{size:?} at {text_scale} with {chart} {view}");
                    assert_words_are_clear(&picture, &place);
                    let arrow = key_arrow(&picture);
                    arrows += usize::from(arrow.is_some());
                    for word in &picture.words {
                        let [left, top, right, bottom] = word.bounds();
                        if let Some([x, y, to_x, to_y]) = arrow {
                            let is_over = x < right && left < to_x && y < bottom && top < to_y;
                            assert!(
                                !is_over,
                                "“{}” at {:?} lies over the key's arrow in {place}: {arrow:?}",
                                word.text,
                                word.bounds()
                            );
                        }
                    }
                }
            }
        }
    }
    assert!(arrows > 40, "{arrows}");
}

#[test]
fn panels_keep_half_of_the_picture_whatever_stands_around_them() {
    let long = "A caption that goes on and on. ".repeat(60);
    for (size, text_scale) in [([1280, 720], 1.0), ([1280, 720], 3.0), ([640, 360], 2.0), ([300, 500], 1.0)] {
        let text =
            ALL.replace("It is set in lines", &format!("{long}\\n{long} It is set in lines")).replace('\'', "\"");
        let text = format!("{text}\nsize = {size:?}\ntext_scale = {text_scale}\nshow = [\"springs\"]\n");
        let scene = parse(&text.replace(&long, &long[..900]));
        let picture = compose(&scene, &Runner::new(&scene, &[0, 1, 2]).frame(3));
        let [top, bottom] = [0, 1].map(|end| {
            let ends = picture.panels.iter().map(|panel| panel.viewport[1] + end * panel.viewport[3]);
            if end == 0 { ends.min() } else { ends.max() }.expect("panels") as f32
        });
        // Strips are within them, at most a third of their height.
        assert!(bottom - top >= 0.66 * 0.5 * picture.size[1] as f32 - 2.0, "{size:?} {text_scale}: {top} to {bottom}");
        assert_words_are_clear(&picture, &format!("{size:?} at {text_scale}"));
    }
}

#[test]
fn the_scale_bar_stays_when_its_run_blows_up() {
    let text = ALL.replace("name = 'Local shape'", "name = 'Local'");
    let text = text.replacen("stiffness = 1e4 }", "stiffness = 1e4 }\nintegrator = 'explicit-euler'", 1);
    let scene = parse(&text.replace("step = 0.005", "step = 0.02"));
    let (composer, mut runner) = (unknown(&scene), Runner::new(&scene, &[0]));
    let bar = |picture: &Listed| picture.words.iter().rfind(|word| word.text.ends_with("00 mm")).map(|word| word.span);
    let frames = [0, scene.last_frame()].map(|frame| composer.compose(&runner.frame(frame)));
    assert!(frames[1].words.iter().any(|word| word.text.starts_with("diverges")), "it blows up");
    assert!(bar(&frames[0]).is_some());
    assert_eq!(bar(&frames[0]), bar(&frames[1]));
}

/// Tallies of many elements become shorter before a scale bar is left out.
#[test]
fn the_scale_bar_finds_room_beside_shorter_tallies() {
    let run = |name: &str| format!("{{ name = '{name}', model = {{ kind = 'shape-based', stiffness = 2e3 }} }}");
    let scene = |runs: &[&str]| {
        let runs: Vec<_> = runs.iter().map(|name| run(name)).collect();
        parse(&format!(
            "time.duration = 0.1
            body.lattice = {{ cells = [12, 3, 3], side = 0.05 }}
            run = [{}]
            [view]
            labels = ['name', 'count', 'number', 'scale-bar']",
            runs.join(", ")
        ))
    };
    let drawn = |scene: &Scene| {
        let picture = compose(scene, &Runner::new(scene, &all(scene)).frame(0));
        let has_bar = picture.words.iter().any(|word| word.text.ends_with("0 mm") && !word.text.starts_with('0'));
        let tally = |mark: &&Mark| mark.colour == picture.palette.tally;
        (has_bar, picture.marks.iter().find(tally).expect("a tally").rectangle[2])
    };
    let [(one, usual), (three, shorter)] = [&["One"][..], &["One", "Two", "Three"]].map(|runs| drawn(&scene(runs)));
    assert!(one && three && shorter < 0.8 * usual, "{usual} {shorter}");
}

#[test]
fn everything_is_written_where_there_is_room() {
    let scene = parse(&format!("{ALL}\nsize = [1920, 1080]\nshow = ['springs', 'displacements']\n"));
    let picture = compose(&scene, &Runner::new(&scene, &[0, 1, 2]).frame(scene.last_frame()));
    let said: Vec<_> = picture.words.iter().map(|word| word.text.as_str()).collect();
    let expected = [
        "a",
        "b",
        "c",
        "Local shape",
        "Mass-spring",
        "600 ms",
        "0 of 27",
        "turned over",
        "shape error",
        "100 mm",
        "strain",
        "0.25",
    ];
    for words in expected {
        assert!(said.contains(&words), "“{words}” is not in {said:?}");
    }
    for beginning in ["A title above all", "A caption of several", "A third model", "displacement ", "diverges"] {
        assert!(said.iter().any(|words| words.starts_with(beginning)), "“{beginning}…” is not in {said:?}");
    }
}

/// Panels too small for words of the least size have fewer words.
#[test]
fn no_type_is_smaller_than_the_least() {
    for (size, columns) in [([1280, 720], 3), ([1600, 1000], 3), ([1920, 1080], 1), ([1280, 720], 2)] {
        let mut scene = parse(&ALL.replace("[view]", "[view]\nshow = ['springs', 'displacements']"));
        (scene.view.size, scene.view.columns) = (size, Some(columns));
        let composer = Composer::new(&scene, &History::new(&scene, &[0, 1, 2]));
        let picture = composer.compose(&Runner::new(&scene, &[0, 1, 2]).frame(3));
        let width = size[0] as f32 / if columns == 1 { 540.0 } else { 1080.0 };
        let least = 14.0 * width.min(size[1] as f32 / 720.0) - 0.01;
        assert!(picture.words.len() > 20, "{size:?}");
        for word in &picture.words {
            assert!(word.size >= least, "“{}” has {} px, less than {least}, in {size:?}", word.text, word.size);
        }
        assert_words_are_clear(&picture, &format!("{size:?} in {columns} columns"));
    }
}

#[test]
fn large_type_wraps_and_gives_the_clock_a_place_of_its_own() {
    let said = |text_scale: f64| {
        let (mut scene, frame) = fig4b(4);
        scene.view.title = "27 cubes dropped from 5 m: springs turn the lowest layer inside out".to_owned();
        scene.view.look.text_scale = text_scale;
        let picture = compose(&scene, &frame);
        assert_words_are_clear(&picture, &text_scale.to_string());
        let top = picture.panels[0].viewport[1] as f32;
        let clock = picture.words.iter().find(|word| word.text == "67 ms").expect("a clock").baseline - top;
        let name = picture.words.iter().find(|word| word.text == "Mass-spring").expect("a whole name").baseline - top;
        let title = picture.words.iter().filter(|word| word.baseline < top).map(|word| word.text.clone());
        (title.collect::<Vec<_>>(), clock < name)
    };
    assert!(!said(1.0).1);
    let (title, clock_above) = said(1.8);
    assert!(title.len() >= 2 && title[0].starts_with("27 cubes") && clock_above, "{title:?}");
    assert!(title.iter().all(|line| !line.contains('…')), "{title:?}");
}

#[test]
fn words_stay_where_they_are() {
    for text in [ALL.replace("integrator = 'explicit-euler'", "").replace("step = 0.005, ", ""), {
        super::plain().replace("camera.distance = 2.65", "")
    }] {
        let scene = parse(&text);
        let (composer, mut runner) = (unknown(&scene), Runner::new(&scene, &all(&scene)));
        // Heights go with their bodies.
        let mut words = |frame| {
            let picture = composer.compose(&runner.frame(frame));
            let heights = heights(&picture);
            picture.words.iter().filter(|word| !heights.contains(word)).cloned().collect::<Vec<_>>()
        };
        let first = words(0);
        for frame in 1..=scene.last_frame().min(60) {
            let words = words(frame);
            assert_eq!(words.len(), first.len(), "words come or go in frame {frame}");
            for (now, before) in words.iter().zip(&first) {
                assert_eq!((now.baseline, now.size), (before.baseline, before.size), "{}", now.text);
                // Numbers of any length keep one end, and words with the number of flat elements the left one; all other texts keep
                // both.
                let kept = [0, 1].map(|end| (now.span[end] - before.span[end]).abs() < 1e-3);
                let is_number = [now, before]
                    .iter()
                    .all(|word| word.text.starts_with(|c: char| c.is_ascii_digit() || "−<".contains(c)));
                let is_flat = [now, before].iter().any(|word| word.text.ends_with(" flat"));
                let stays = match (is_number, is_flat) {
                    (true, _) => kept.contains(&true),
                    (false, true) => kept[0] && [now, before].iter().all(|word| word.text.starts_with("turned over")),
                    (false, false) => kept == [true; 2],
                };
                assert!(stays, "“{}” has moved from “{}” in frame {frame}", now.text, before.text);
            }
        }
    }
}

#[test]
fn what_is_not_wanted_is_not_written() {
    let (mut scene, frame) = fig4b(4);
    let all = compose(&scene, &frame).words.len();
    let labels = scene.view.labels;
    for (wanted, words) in [
        (Labels { count: false, ..labels }, "turned over"),
        (Labels { number: false, ..labels }, "shape error"),
        (Labels { clock: false, ..labels }, "after first contact"),
        (Labels { name: false, ..labels }, "Local shape"),
        (Labels { model: false, ..labels }, "27 cubes, k = 10 kN/m, ζ = 0.1"),
    ] {
        let has = |picture: &Listed| picture.words.iter().any(|word| word.text == words);
        scene.view.labels = labels;
        assert!(has(&compose(&scene, &frame)), "“{words}” is missing");
        scene.view.labels = wanted;
        let picture = compose(&scene, &frame);
        assert!(picture.words.len() < all);
        assert!(!has(&picture), "“{words}” is there");
    }
}

/// A straight arrow would say that a torque is a force, and equal arrows that a load is a contact.
#[test]
fn the_key_has_a_sample_of_each_kind_of_arrow() {
    let scene = parse(
        "gravity = [0, -9.8, 0]
        time = { duration = 0.1, step = 0.005 }
        body = { lattice = { cells = [2, 2, 2], side = 0.1 }, mass = 1.0 }
        contact = { restitution = 0.1 }
        run = [{ name = 'shape', model = { kind = 'shape-based', stiffness = 1e4 } }]
        obstacle = [{ kind = 'floor' }]
        [[load]]
        nodes = 'top'
        force = [0, 0, 5]
        [[load]]
        nodes = 'top'
        torque = [0, 2, 0]
        [view]
        show = ['surfaces', 'loads', 'contacts']
        labels = ['legend']",
    );
    let picture = compose(&scene, &frame(&scene, 0));
    let named = |name: &str| picture.words.iter().any(|run| run.text.starts_with(name));
    assert!(named("load ") && named("torque 2 N m") && named("contact force "), "{:?}", picture.words);
    // The key lies below the panel: a straight arrow, that of the torque's arc, and a hollow one, with the ground inside.
    let bottom = (picture.panels[0].viewport[1] + picture.panels[0].viewport[3]) as f32;
    let arrows = || picture.marks.iter().filter(|mark| mark.shape == "arrow" && mark.rectangle[1] > bottom);
    assert_eq!(arrows().count(), 3);
    assert_eq!(arrows().filter(|arrow| arrow.colour == picture.palette.background).count(), 1);
}

/// A cut arrow with its head at the border would look like a smaller force.
#[test]
fn arrows_that_leave_their_panel_have_a_break() {
    let broken = |scale: f64| {
        let scene = parse(&format!(
            "time = {{ duration = 0.1, step = 0.005 }}
            body = {{ lattice = {{ cells = [2, 2, 2], side = 0.1 }}, mass = 1.0 }}
            run = [{{ name = 'shape', model = {{ kind = 'shape-based', stiffness = 1e4 }} }}]
            load = [{{ nodes = 'top', force = [0, 5, 0] }}]
            view = {{ show = ['surfaces', 'loads'], labels = ['name'], arrow_scale = {scale} }}"
        ));
        let picture = compose(&scene, &frame(&scene, 0));
        let of = |shape: &str| picture.marks.iter().filter(|mark| mark.shape == shape).count();
        [of("arrow"), of("broken arrow")]
    };
    assert_eq!((broken(0.5), broken(20.0)), ([1, 0], [0, 1]));
}

/// A load without any sign of it would look like none.
#[test]
fn small_loads_are_dots_and_the_key_tells_so() {
    let shown = |force: f64, load: &str| {
        let scene = parse(&format!(
            "time = {{ duration = 0.1, step = 0.005 }}
            body = {{ lattice = {{ cells = [2, 2, 2], side = 0.1 }}, mass = 1.0 }}
            run = [{{ name = 'shape', model = {{ kind = 'shape-based', stiffness = 1e4 }} }}]
            load = [{{ nodes = 'top', force = [0, {force}, 0] }}, {{ nodes = 'bottom', force = [0, 5, 0]{load} }}]
            view = {{ show = ['surfaces', 'loads'], labels = ['legend'] }}"
        ));
        let picture = compose(&scene, &frame(&scene, 0));
        let bottom = (picture.panels[0].viewport[1] + picture.panels[0].viewport[3]) as f32;
        let in_panel = || picture.marks.iter().filter(|mark| mark.rectangle[1] < bottom);
        let of = |shape: &str| in_panel().filter(|mark| mark.shape == shape).count();
        let told = picture.words.iter().any(|run| run.text.ends_with("dots: smaller loads"));
        (of("arrow"), of("node"), told)
    };
    assert_eq!(shown(5.0, ""), (2, 0, false));
    assert_eq!(shown(0.001, ""), (1, 1, true));
    // A load that rises begins as nothing, and soon as a dot.
    assert_eq!(shown(5.0, ", ramp = 0.1"), (1, 0, true));
}
