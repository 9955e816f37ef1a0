//! Contact sheets: nothing overlaps or is cut off, and the text agrees with the simulation.

use super::assert_words_are_clear;
use super::charts::alike;
use super::listed::{Listed, Mark, compose_figure};
use glam::Vec3;
use localshape::picture::{Panel, TextRun, Weight};
use localshape::runner::moments::Moments;
use localshape::scene::Limits;
use localshape::scene::figure::{Content, Figure, Sheet};
use localshape::sim::Status;
use std::sync::LazyLock;

const SHEETS: [&str; 4] = ["fig4a", "fig4b", "fig4c", "restore"];
/// The smallest font size (px).
const SMALLEST_TYPE: f32 = 5.0;

fn sheet(figure: &Figure) -> &Sheet {
    let Content::Sheet(sheet) = &figure.content else { panic!("a contact sheet") };
    sheet
}

/// A user's figure of shipped scenes.
fn own(text: &str) -> Figure {
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("own.toml");
    std::fs::write(&path, text.replace("scene = '", &format!("scene = '{scenes}"))).expect("a file");
    Figure::load(&path, &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Sheets with other layouts than the paper's.
fn others() -> Vec<Figure> {
    let moments = |count: usize| (0..count).map(|at| format!("{}", at as f64 * 0.07)).collect::<Vec<_>>().join(", ");
    let rows = |count: usize| {
        let row = |at: usize| format!("[[sheet.row]]\nrun = 'Mass-spring'\ntime = {}\n", at as f64 * 0.1);
        (0..count).map(row).collect::<String>()
    };
    let long = "A text that goes on and on, as captions do. ".repeat(8);
    [
        format!("[sheet]\nscene = 'fig4b.toml'\nmoments = [{}]\ncharts = ['turned_over', 'kinetic']\n", moments(40)),
        format!("[sheet]\nscene = 'fig4b.toml'\n[[sheet.column]]\nlabel = 'A label that is long'\n{}", rows(20)),
        format!(
            "title = '{}'\ncaption = '{long}'\n[sheet]\nscene = 'fig4b.toml'\nmoments = [0.02, 0.021, 0.022, 1, 2.99, 3]\n\
             charts = ['turned_over', 'shape_error', 'volume_ratio', 'kinetic', 'elastic', 'residual']\n",
            &long[..190]
        ),
        "[sheet]\nscene = 'fig4b.toml'\nmoments = [0, 0.3, 0.6, 1]\nnumber = 'volume_ratio'\n".to_owned(),
        "[sheet]\nscene = 'fig4a.toml'\nmoments = [0, 0.7, 1.45, 2.2, 5]\n".to_owned(),
        "[sheet]\nscene = 'fig4a.toml'\nmoments = [0.5]\n".to_owned(),
        "title = 'x'\n[sheet]\nscene = 'explicit-euler.toml'\nmoments = [0, 0.5, 1]\ncharts = ['energy']\n".to_owned(),
        "title = 'Several'\n[sheet]\n[[sheet.column]]\nscene = 'fig4b.toml'\ntime = 0.03\nlabel = 'dropped'\n\
         [[sheet.column]]\nscene = 'fig4c.toml'\ntime = 1.2\nlabel = 'pressed'\n\
         [[sheet.column]]\nscene = 'fig4a.toml'\ntime = 1.5\nlabel = 'in the plane'\n"
            .to_owned(),
    ]
    .iter()
    .map(|text| own(text))
    .collect()
}

/// Figures with their simulated states, shared by all tests.
type Shown = Vec<(Figure, Moments)>;

fn show(figures: impl IntoIterator<Item = Figure>) -> Shown {
    let shown = |figure: Figure| {
        let moments = Moments::new(&figure);
        (figure, moments)
    };
    figures.into_iter().map(shown).collect()
}

/// The figures of [`SHEETS`].
static PAPER: LazyLock<Shown> = LazyLock::new(|| show(SHEETS.iter().filter_map(|name| Figure::built_in(name))));

fn all() -> impl Iterator<Item = &'static (Figure, Moments)> {
    static OTHERS: LazyLock<Shown> = LazyLock::new(|| show(others()));
    PAPER.iter().chain(OTHERS.iter())
}

/// The texts in a tile.
fn within<'p>(picture: &'p Listed, panel: &'p Panel) -> impl Iterator<Item = &'p TextRun> {
    let [left, top, width, height] = panel.viewport.map(|length| length as f32);
    let inside = move |word: &&TextRun| {
        let [x, y, x2, y2] = word.bounds();
        left <= x && x2 <= left + width && top <= y && y2 <= top + height
    };
    picture.words.iter().filter(inside)
}

#[test]
fn no_words_overlap_and_all_can_be_read() {
    const SIZES: [[u32; 2]; 8] =
        [[2400, 1350], [1200, 675], [640, 360], [480, 270], [3000, 1700], [700, 1200], [200, 150], [64, 64]];
    for (number, (figure, moments)) in all().enumerate() {
        let mut figure = figure.clone();
        for (at, size) in SIZES.into_iter().enumerate() {
            figure.size = size;
            // Every figure at every size, and two figures with type of every size.
            let times = [1.0, 1.5, 3.0][(number + at) % 3];
            figure.look.text_scale = times;
            let picture = compose_figure(&figure, moments).expect("room");
            let figure = format!("{size:?} of {} with type {times} times as large", figure.title);
            assert_words_are_clear(&picture, &figure);
            for word in &picture.words {
                assert!(word.size >= SMALLEST_TYPE, "“{}” in {figure} is {} px high", word.text, word.size);
            }
        }
    }
}

/// The font sizes (px) of texts.
fn sizes(picture: &Listed) -> std::collections::BTreeMap<&str, f32> {
    picture.words.iter().map(|word| (word.text.as_str(), word.size)).collect()
}

#[test]
fn type_is_as_many_times_larger_as_a_figure_says() {
    let usual = "title = 'A title'\ncaption = 'In a few words'\n\
                 [sheet]\nscene = 'fig4b.toml'\nmoments = [0, 0.5, 1]\ncharts = ['turned_over', 'shape_error']\n";
    let picture = |text: &str| {
        let figure = own(text);
        compose_figure(&figure, &Moments::new(&figure)).expect("room")
    };
    let (plain, large) = (picture(usual), picture(&format!("text_scale = 1.5\n{usual}")));
    let (plain_sizes, large_sizes) = (sizes(&plain), sizes(&large));
    let words =
        ["A title", "In a few words", "Local shape", "500 ms", "Turned over", "of 27 cubes", "Shape error", "9"];
    for word in words {
        let times = large_sizes[word] / plain_sizes[word];
        assert!((times - 1.5).abs() < 1e-4, "“{word}” is {times} times larger");
    }
    // The bodies have the space without texts, which is most of it.
    let heights = [&plain, &large].map(|picture| picture.panels[0].viewport[3] as f32);
    assert!(heights[1] > 0.8 * heights[0], "{heights:?}");
    assert_eq!(picture(&format!("text_scale = 1\n{usual}")), plain);
}

#[test]
fn every_body_is_inside_its_tile_and_all_are_seen_at_one_scale() {
    for (figure, moments) in all() {
        let mut figure = figure.clone();
        for size in [[2400, 1350], [640, 360], [900, 1400]] {
            figure.size = size;
            let picture = compose_figure(&figure, moments).expect("room");
            let runs: Vec<_> = moments.cells.iter().flatten().collect();
            assert_eq!(runs.len(), picture.panels.len());
            let columns = &sheet(&figure).columns;
            let mut scales = vec![None; sheet(&figure).scenes.len()];
            for (at, (panel, run)) in picture.panels.iter().zip(runs).enumerate() {
                // All tiles of a scene are seen from the same distance.
                let scale = panel.sight.element;
                let first = *scales[columns[at % columns.len()].scene].get_or_insert(scale);
                assert!((scale / first - 1.0).abs() < 1e-4, "{scale} and {first} in {}", figure.title);
                if run.snapshot.status != Status::Ok {
                    continue;
                }
                for vertex in panel.sound.vertices.iter().chain(&panel.turned_over.vertices) {
                    let at = panel.sight.clip * Vec3::from(vertex.position).extend(1.0);
                    let place = at.truncate().truncate() / at.w;
                    assert!(place.abs().max_element() <= 0.999, "{place} in {:?} of {}", panel.viewport, figure.title);
                }
            }
            // Tiles lie side by side, within the picture.
            for (at, one) in picture.panels.iter().enumerate() {
                let [x, y, width, height] = one.viewport;
                assert!(x + width <= size[0] && y + height <= size[1], "{:?} in {size:?}", one.viewport);
                for other in &picture.panels[..at] {
                    let [x2, y2, width2, height2] = other.viewport;
                    assert!(x + width <= x2 || x2 + width2 <= x || y + height <= y2 || y2 + height2 <= y);
                }
            }
        }
    }
}

#[test]
fn floors_of_the_paper_are_at_one_height() {
    for (figure, moments) in &PAPER[1..3] {
        let name = &figure.name;
        let picture = compose_figure(figure, moments).expect("room");
        let floors: Vec<_> = picture.panels.iter().map(|panel| panel.floor.as_ref().expect("a floor").height).collect();
        assert!(floors.iter().all(|height| (height - floors[0]).abs() < 1e-6), "{name}: {floors:?}");
        let eye = picture.panels[0].sight.eye;
        assert!(picture.panels.iter().all(|panel| panel.sight.eye.distance(eye) < 1e-4));
    }
}

#[test]
fn counts_are_those_that_were_simulated() {
    for (figure, moments) in PAPER.iter() {
        let picture = compose_figure(figure, moments).expect("room");
        for (panel, run) in picture.panels.iter().zip(moments.cells.iter().flatten()) {
            let expected = run.snapshot.diagnostics.turned_over;
            let count = within(&picture, panel).find(|word| word.weight == Weight::SemiBold).expect("a count");
            let flat = run.snapshot.flat.iter().filter(|&&flat| flat).count();
            let told = within(&picture, panel).find(|word| word.text.ends_with(" flat")).map(|word| word.text.clone());
            // The tally shows them, too, where there is no room.
            assert!(told.is_none_or(|told| flat > 0 && told == format!("{flat} flat")), "{}", figure.title);
            assert_eq!(count.text, expected.to_string(), "{}", figure.title);
            let colour = if expected > 0 { picture.palette.alarm_text } else { picture.palette.second_text };
            assert_eq!(count.colour, colour);
            let [left, top, width, height] = panel.viewport.map(|length| length as f32);
            let struck = picture.marks.iter().filter(|mark| {
                let [x, y, ..] = mark.rectangle;
                mark.shape == "struck" && left <= x && x < left + width && top <= y && y < top + height
            });
            assert_eq!(struck.count(), expected, "{}", figure.title);
            // One square for each element, and one inside it for each flat one.
            let squares = picture.marks.iter().filter(|mark| {
                let [x, y, across, high] = mark.rectangle;
                let inside = left <= x && x < left + width && top <= y && y < top + height;
                inside && across == high && matches!(mark.shape, "rectangle" | "struck")
            });
            assert_eq!(squares.count(), run.snapshot.turned_over.len() + flat, "{}", figure.title);
        }
    }
}

/// The statements of docs/paper.md about Fig. 4: which elements stay turned over, and the remaining volume.
#[test]
fn the_last_columns_show_what_the_paper_tells() {
    for ((name, over, volume), (figure, moments)) in
        [("fig4a", 1, 0.86), ("fig4b", 9, 0.34), ("fig4c", 9, 0.33)].into_iter().zip(PAPER.iter())
    {
        assert_eq!(figure.name, name);
        let [shape, springs] = [0, 1].map(|row| &moments.cells[row].last().expect("a column").snapshot);
        assert_eq!((shape.diagnostics.turned_over, springs.diagnostics.turned_over), (0, over), "{name}");
        assert!((springs.diagnostics.volume_ratio - volume).abs() < 0.015, "{name}: {:?}", springs.diagnostics);
        let least = if name == "fig4a" { 0.99 } else { 0.97 };
        assert!(shape.diagnostics.volume_ratio > least, "{name}: {:?}", shape.diagnostics);
    }
    let springs = &PAPER[0].1.cells[1][4].snapshot;
    assert_eq!(springs.turned_over, [false, false, false, false, false, true], "the triangle 1 0 6");
}

/// The letters in rings, from left to right, with the middles of their words.
fn rings(picture: &Listed, top: f32) -> Vec<(&str, f32)> {
    let letters = picture.words.iter().filter(|word| {
        word.weight == Weight::SemiBold && word.baseline > top && word.text.chars().all(|c| c.is_ascii_lowercase())
    });
    letters.map(|word| (word.text.as_str(), (word.span[0] + word.span[1]) / 2.0)).collect()
}

#[test]
fn letters_ascend_above_columns_and_over_time() {
    let close = own(
        "[sheet]\nscene = 'fig4b.toml'\nmoments = [0.02, 0.021, 0.022, 0.023, 1, 2.99, 3]\ncharts = ['turned_over']\n",
    );
    for (figure, moments) in PAPER.iter().chain(&show([close])) {
        let mut figure = figure.clone();
        figure.size = [1600, 900];
        let picture = compose_figure(&figure, moments).expect("room");
        let count = sheet(&figure).columns.len();
        let letters: Vec<_> = (b'a'..).take(count).map(|byte| char::from(byte).to_string()).collect();
        let top = picture.panels[0].viewport[1] as f32;
        for (letter, panel) in letters.iter().zip(&picture.panels) {
            let above =
                picture.words.iter().find(|word| word.text == *letter && word.baseline < top).expect("a heading");
            assert_eq!(above.span[0], panel.viewport[0] as f32);
        }
        let rings = rings(&picture, top);
        let expected = if sheet(&figure).charts.is_empty() { &[][..] } else { &letters };
        assert_eq!(rings.iter().map(|(letter, _)| *letter).collect::<Vec<_>>(), expected);
        for two in rings.windows(2) {
            assert!(two[1].1 - two[0].1 >= 20.0, "rings of 20 px do not touch: {rings:?}");
        }
    }
}

#[test]
fn what_blew_up_is_said_and_has_no_count() {
    let figure = own("[sheet]\nscene = 'explicit-euler.toml'\nmoments = [0, 1.5]\n");
    let moments = Moments::new(&figure);
    let picture = compose_figure(&figure, &moments).expect("room");
    let last = picture.panels.last().expect("a tile");
    let said: Vec<_> = within(&picture, last).map(|word| word.text.as_str()).collect();
    assert!(said.len() == 1 && said[0].starts_with("diverges at "), "{said:?}");
}

#[test]
fn a_body_without_width_is_drawn_as_a_line_or_a_dot() {
    let figure = Figure::built_in("restore").expect("a figure of the program");
    let picture = compose_figure(&figure, &Moments::new(&figure)).expect("room");
    let lengths: Vec<_> = picture.curves.iter().map(|curve| curve.points.len()).collect();
    // The point, the line, and both again for the springs.
    assert_eq!(lengths, [1, 2, 1, 2]);
}

/// A sheet of a scene with eight runs of one model, and its states.
fn of_alike(runs: usize, sheet: &str) -> (Figure, Moments) {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).expect("a file");
    write("alike.toml", alike(runs, "light"));
    // The same runs except for the first, in another order.
    let mut others: Vec<_> = alike(runs, "light").split("[[run]]").map(str::to_owned).collect();
    if runs > 2 {
        others.swap(2, 3);
    }
    others.remove(1);
    write("others.toml", others.join("[[run]]"));
    write("sheet.toml", sheet.to_owned());
    let figure = Figure::load(&folder.path().join("sheet.toml"), &Limits::default());
    let figure = figure.unwrap_or_else(|error| panic!("{error}"));
    let moments = Moments::new(&figure);
    (figure, moments)
}

#[test]
fn runs_of_one_model_are_told_apart_and_named_at_the_ends_of_their_curves() {
    for runs in [2, 3, 8, 10] {
        let text = "[sheet]\nscene = 'alike.toml'\nmoments = [0, 0.4]\ncharts = ['energy', 'shape_error']\n";
        let (mut figure, moments) = of_alike(runs, text);
        // The second sheet has too little room for many names.
        for size in [[1200, 675], [1200, 360], [400, 300]] {
            figure.size = size;
            let picture = compose_figure(&figure, &moments).expect("room");
            assert_words_are_clear(&picture, &format!("{runs} in {size:?}"));
        }
        figure.size = [2400, 1350];
        let picture = compose_figure(&figure, &moments).expect("room");
        assert_words_are_clear(&picture, "");
        let curves: Vec<_> = picture.curves.iter().filter(|curve| curve.points.len() > 3).collect();
        assert_eq!(curves.len(), 2 * runs);
        let looks: Vec<_> = curves[..runs].iter().map(|curve| (curve.colour, curve.dash.clone())).collect();
        for (at, look) in looks.iter().enumerate() {
            assert!(!looks[..at].contains(look), "{look:?} stands for two runs");
            if runs <= 8 {
                assert!(looks[..at].iter().all(|other| other.0 == look.0 && other.1 != look.1), "{look:?}");
            }
        }
        let scene = &sheet(&figure).scenes[0];
        for (chart, curves) in curves.chunks(runs).enumerate() {
            // Names are in the order of the ends of the curves, from top to bottom.
            let mut ends: Vec<_> = scene
                .runs
                .iter()
                .zip(curves)
                .map(|(run, curve)| {
                    assert_eq!(curve.colour, run.line(&picture.palette).colour);
                    let [x, y] = curve.points[curve.points.len() - 1];
                    let names = picture.words.iter().filter(|word| word.text == run.name && word.span[0] > x);
                    let name =
                        names.min_by(|one, other| (one.baseline - y).abs().total_cmp(&(other.baseline - y).abs()));
                    let name = name.unwrap_or_else(|| panic!("{} is named right of chart {chart} of {runs}", run.name));
                    assert!(name.span[0] - x < 80.0, "{name:?}");
                    (y, name.baseline)
                })
                .collect();
            ends.sort_by(|one, other| one.0.total_cmp(&other.0));
            assert!(ends.windows(2).all(|two| two[1].1 - two[0].1 >= 0.9 * 21.0), "{ends:?}");
        }
    }
}

#[test]
fn runs_of_one_name_have_one_line_in_all_scenes_of_a_figure() {
    let text = "[sheet]\n[[sheet.column]]\nscene = 'alike.toml'\ntime = 0\n[[sheet.column]]\nscene = 'others.toml'\ntime = 0\n\
                [[sheet.row]]\nrun = 'k = 1000'\n[[sheet.row]]\nrun = 'k = 1500'\n";
    let (figure, _) = of_alike(4, text);
    let [first, second] = figure.scenes() else { panic!("two scenes") };
    assert_eq!(
        second.runs.iter().map(|run| run.name.as_str()).collect::<Vec<_>>(),
        ["k = 1500", "k = 1000", "k = 2000"]
    );
    let palette = &figure.look.palette();
    // Runs that the first scene does not have get new lines.
    let text = "[sheet]\n[[sheet.column]]\nscene = 'others.toml'\ntime = 0\n[[sheet.column]]\nscene = 'alike.toml'\ntime = 0\n\
                [[sheet.row]]\nrun = 'k = 1000'\n[[sheet.row]]\nrun = 'k = 1500'\n";
    let (lacking, _) = of_alike(4, text);
    let [few, all] = lacking.scenes() else { panic!("two scenes") };
    assert_eq!((few.runs.len(), all.runs.len()), (3, 4));
    let lines: Vec<_> = all.runs.iter().map(|run| run.line(palette)).collect();
    for (at, line) in lines.iter().enumerate() {
        assert!(lines[..at].iter().all(|other| other.colour == line.colour && other.dash != line.dash), "{lines:?}");
    }
    for run in &second.runs {
        let same = first.runs.iter().find(|same| same.name == run.name).expect("a run of that name");
        assert_eq!(run.line(palette), same.line(palette), "{}", run.name);
    }
}

#[test]
fn a_sheet_colours_all_its_scenes_by_one_field() {
    let columns =
        "[[sheet.column]]\nscene = 'fig4b.toml'\ntime = 0.03\n[[sheet.column]]\nscene = 'stretch.toml'\ntime = 1.5\n";
    let figure = own(&format!(
        "[sheet]\ncolour = {{ by = 'displacement', map = 'viridis' }}\nrow = [{{ run = 'Local shape' }}]\n{columns}"
    ));
    let scales: Vec<_> = figure.scenes().iter().map(|scene| scene.view.colour.expect("a field")).collect();
    // Half of the way of a grab that stretches and turns: its shift, and 2.5 rad at the distance of a side.
    let way = 0.5 * (f64::hypot(0.5, 0.2) + 2.5 * 0.1);
    assert!(scales[0] == scales[1] && scales[0].range[0] == 0.0, "{scales:?}");
    assert!((scales[0].range[1] - way).abs() < 1e-12, "{scales:?}");
    let picture = compose_figure(&figure, &Moments::new(&figure)).expect("there is room");
    assert!(!picture.ramp.is_empty());
    for panel in &picture.panels {
        assert_eq!(panel.sound.shades.len(), panel.sound.vertices.len());
        assert!(panel.sound.shades.iter().any(|&shade| shade > 0.05));
    }
    assert!(picture.words.iter().any(|run| run.text == "displacement"));
}

/// Sheets of several scenes also have a tally. One scene has too many elements in a layer for squares, and the key
/// explains the tally.
#[test]
fn tallies_of_a_sheet_have_one_style() {
    let column = |scene: &str| format!("[[sheet.column]]\nscene = '{scene}.toml'\ntime = 0\n");
    let words = |columns: &str| {
        let figure = own(&format!("title = 'x'\n[sheet]\n{columns}"));
        let picture = compose_figure(&figure, &Moments::new(&figure)).expect("room");
        let key = picture.words.iter().find(|run| run.text.starts_with("turned over")).expect("a key").text.clone();
        let of_tally = |mark: &&Mark| mark.colour == picture.palette.tally;
        (key, picture.marks.iter().filter(of_tally).count())
    };
    let [one, other] = [column("fig4b"), column("rod")];
    assert_eq!(words(&one), ("turned over (one square per cube, lowest layer at the bottom)".to_owned(), 2 * 27));
    assert_eq!(words(&other), ("turned over".to_owned(), 2));
    assert_eq!(words(&(one + &other)), ("turned over".to_owned(), 4));
}
