//! Diagrams of forces: the numbers of Figs. 1 and 2, and legibility.

use super::listed::{Listed, Mark, compose_figure, parts};
use localshape::picture::TextRun;
use localshape::runner::moments::Moments;
use localshape::scene::figure::Figure;

fn picture(name: &str, size: [u32; 2]) -> Listed {
    picture_with(name, size, 1.0)
}

/// A figure with a larger font.
fn picture_with(name: &str, size: [u32; 2], text_scale: f64) -> Listed {
    let mut figure = Figure::built_in(name).expect("a figure of the paper");
    figure.size = size;
    figure.look.text_scale = text_scale;
    compose_figure(&figure, &Moments::new(&figure)).expect("room")
}

fn texts(picture: &Listed) -> Vec<&str> {
    picture.words.iter().map(|word| word.text.as_str()).collect()
}

/// The number of occurrences of each text.
fn counts(picture: &Listed, wanted: &[&str]) -> Vec<usize> {
    let texts = texts(picture);
    wanted.iter().map(|wanted| texts.iter().filter(|text| *text == wanted).count()).collect()
}

#[test]
fn fig_1_says_the_forces_and_how_far_three_springs_are_off() {
    let picture = picture("fig1", [1280, 720]);
    // Shape forces (.0063, −.2023) (.0010, −.3053) (−.0072, .5076); .711 on the apex that has turned over.
    assert_eq!(counts(&picture, &["0.202", "0.305", "0.508", "0.711"]), [1; 4]);
    // Springs (−.3864, −.0644) (.5701, −.1425) (−.1837, .2069), wrong by 82°, 76° and 41°; .343 the wrong way.
    assert_eq!(counts(&picture, &["0.392", "0.588", "0.277", "0.343"]), [1; 4]);
    assert_eq!(counts(&picture, &["82° off", "76° off", "41° off", "180° off"]), [1; 4]);
    // Below each body is its rest shape.
    let turned_over = |panel: usize| parts(&picture.under[2 * panel..2 * panel + 2], "turned over").len();
    assert_eq!([0, 2].map(turned_over), [0, 1]);
}

#[test]
fn fig_2_says_that_one_diagonal_spring_prefers_a_direction() {
    let picture = picture("fig2", [1280, 576]);
    assert_eq!(counts(&picture, &["0.141", "0.495", "0.243", "1.051", "0.040", "0.061"]), [2; 6]);
    // The force points outward instead of inward.
    assert_eq!(counts(&picture, &["180° off"]), [2]);
}

/// Nodes hide no arrow: the short ones of the third model lie above them.
#[test]
fn short_arrows_can_be_seen() {
    let picture = picture("fig2", [1280, 576]);
    let figure = Figure::built_in("fig2").expect("a figure of the paper");
    let own = figure.scenes()[0].runs[2].line(&picture.palette).colour;
    let nodes = picture.marks.iter().rposition(|mark| mark.shape == "node").expect("nodes");
    let arrows = picture.marks[nodes..].iter().filter(|mark| mark.colour == own);
    assert_eq!(arrows.count(), 4);
}

#[test]
fn fig_3_shows_both_vectors_and_the_centre_in_the_plane_and_in_space() {
    let picture = picture("fig3", [1280, 720]);
    assert_eq!(counts(&picture, &["r", "R", "c"]), [2; 3]);
    let is_head = |mark: &&Mark| matches!(mark.shape, "arrow" | "point");
    // An arrow for each node of the pentagon and of the cube, and the legend's arrow.
    assert_eq!(picture.marks.iter().filter(is_head).count(), 5 + 8 + 1);
}

/// Left, top, right and bottom of a word (px).
fn edges(word: &TextRun) -> [f32; 4] {
    [word.span[0], word.baseline - 0.74 * word.size, word.span[1], word.baseline + 0.06 * word.size]
}

#[test]
fn no_label_overlaps_another_or_leaves_the_picture() {
    for name in ["fig1", "fig2", "fig3"] {
        let sizes = [[640, 360], [1280, 720], [2560, 1440], [900, 1200]];
        for (size, text_scale) in sizes.into_iter().flat_map(|size| [0.8, 1.0, 1.5].map(|scale| (size, scale))) {
            let picture = picture_with(name, size, text_scale);
            assert!(picture.words.len() > 4, "{name} {size:?}");
            for (at, word) in picture.words.iter().enumerate() {
                let [left, top, right, bottom] = edges(word);
                let inside = left >= 0.0 && top >= 0.0 && right <= size[0] as f32 && bottom <= size[1] as f32;
                assert!(inside, "{name} {size:?} {text_scale}: {:?} leaves the picture", word.text);
                for other in &picture.words[..at] {
                    let [left2, top2, right2, bottom2] = edges(other);
                    let apart = right <= left2 || right2 <= left || bottom <= top2 || bottom2 <= top;
                    // An index is at the foot of its letter.
                    let is_index = word.text == "i" || other.text == "i";
                    assert!(apart || is_index, "{name} {size:?} {text_scale}: {:?} over {:?}", word.text, other.text);
                }
            }
        }
    }
}

#[test]
fn a_figure_is_the_same_each_time() {
    assert_eq!(picture("fig1", [640, 360]), picture("fig1", [640, 360]));
}

#[test]
fn type_is_as_many_times_larger_as_a_figure_says() {
    let [usual, large] = [1.0, 1.5].map(|text_scale| picture_with("fig1", [2560, 1440], text_scale));
    let size = |picture: &Listed, text: &str| picture.words.iter().find(|word| word.text == text).map(|word| word.size);
    for text in ["Local shape", "Apex pushed in", "0.508", "82° off", "rest shape, best fit"] {
        let [usual, large] = [&usual, &large].map(|picture| size(picture, text).expect("written"));
        assert!((large / usual - 1.5).abs() < 1e-4, "{text}: {usual} and {large}");
    }
}

#[test]
fn a_body_at_rest_has_no_forces_and_floors_that_are_not_drawn_cut_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("a file");
        path
    };
    at(
        "rest.toml",
        "time.duration = 0
        body.lattice = { cells = [2, 2, 2], side = 0.1 }
        run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1e4 } }]
        obstacle = [{ kind = 'floor', height = -0.15 }, { kind = 'sphere', centre = [0, -0.15, 0.2], radius = 0.1 }]",
    );
    let path = at("figure.toml", "size = [900, 900]\nforces.scenes = ['rest.toml']");
    let figure = Figure::load(&path, &localshape::scene::Limits::default()).unwrap_or_else(|error| panic!("{error}"));
    let picture = compose_figure(&figure, &Moments::new(&figure)).expect("room");
    assert_eq!(counts(&picture, &["no forces"]), [1]);
    // Of 27 nodes, the inner one and those hidden by faces are faint, or not drawn.
    let nodes = |opaque: bool| {
        let is_one = |mark: &&Mark| mark.shape == "node" && (mark.opacity == 255) == opaque;
        picture.marks.iter().filter(is_one).count()
    };
    assert_eq!((nodes(true), nodes(false)), (19, 0));
    let panel = &picture.panels[0];
    assert!(panel.floor.is_none() && panel.obstacles.solids.len() == 1);
}
