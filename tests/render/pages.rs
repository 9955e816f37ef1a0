//! The list of a picture as text, and pictures of extreme sizes. No device is needed.

use super::listed::compose_figure;
use super::{compose, frame, parse};
use localshape::picture::{Item, Path, Step};
use localshape::render::Renderer;
use localshape::runner::moments::Moments;
use localshape::scene::figure::Figure;
use std::fmt::Write;

const SCENE: &str = "
    time = { duration = 1, step = 'T/50', frames_per_second = 50 }
    run = [{ name = 'Local shape', model = { kind = 'shape-based', stiffness = 1e3 } }]
    body = { nodes = [[0, 1], [1, 1], [0.5, 1.8]], elements = [[0, 1, 2]], spin = { rate = 1 } }
    obstacle = [{ kind = 'floor' }, { kind = 'sphere', centre = [2, 0.5], radius = 0.3 }]
    view = { size = [320, 240], labels = ['name', 'count'] }
";

/// The points of a path in words; `…` stands for those after the fourth.
fn told(path: &Path) -> String {
    let mut points: Vec<_> = path.points().iter().map(|at| format!("{:.1},{:.1}", at.x, at.y)).collect();
    if points.len() > 4 {
        points.splice(4.., ["…".to_owned()]);
    }
    let curved = if path.0.iter().any(|step| matches!(step, Step::Cubic(_))) { "curve " } else { "" };
    format!("{curved}{}", points.join(" "))
}

fn tell(items: &[Item], depth: usize, text: &mut String) {
    let paint = |colour: [u8; 3], alpha: f32| {
        let [r, g, b] = colour;
        if alpha < 1.0 { format!("#{r:02x}{g:02x}{b:02x} {alpha:.2}") } else { format!("#{r:02x}{g:02x}{b:02x}") }
    };
    for item in items {
        let (line, inside) = match item {
            Item::Fill { path, paint: with } => {
                (format!("fill {} {}", paint(with.colour, with.alpha), told(path)), &[][..])
            }
            Item::Stroke { path, pen, paint: with } => {
                (format!("stroke {} width {:.1} {}", paint(with.colour, with.alpha), pen.width, told(path)), &[][..])
            }
            Item::Blend { path, colours, .. } => {
                (format!("blend of {} colours {}", colours.len(), told(path)), &[][..])
            }
            Item::Image(image) => (format!("image {}×{}", image.size[0], image.size[1]), &[][..]),
            Item::Text(run) => {
                let place = format!("{:.1},{:.1}", run.span[0], run.baseline);
                (format!("text {} size {:.1} {place} “{}”", paint(run.colour, 1.0), run.size, run.text), &[][..])
            }
            Item::Clip { path, items } => (format!("clip {}", told(path)), &items[..]),
            Item::Part { name, items } => ((*name).to_owned(), &items[..]),
        };
        writeln!(text, "{:1$}{line}", "", 2 * depth).expect("into memory");
        tell(inside, depth + 1, text);
    }
}

/// `UPDATE_GOLDENS=1` writes the file anew.
#[test]
fn the_list_of_a_small_scene_is_known() {
    let scene = parse(SCENE);
    let picture = compose(&scene, &frame(&scene, 0));
    let mut text = String::new();
    for (place, items) in [("under", &picture.under), ("above", &picture.above)] {
        writeln!(text, "{place}").expect("into memory");
        tell(items, 1, &mut text);
    }
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/render/page.txt");
    if std::env::var("UPDATE_GOLDENS").is_ok_and(|value| value == "1") {
        std::fs::write(&file, &text).expect("a file");
    }
    assert_eq!(text, std::fs::read_to_string(&file).unwrap_or_default(), "UPDATE_GOLDENS=1 renews page.txt");
    let docs = include_str!("../../docs/pictures.md");
    let shown = docs.split("```text\n").last().and_then(|rest| rest.split("```").next()).expect("a list");
    assert!(text.starts_with(shown.trim_end_matches("…\n")), "docs/pictures.md shows its beginning");
}

#[test]
fn pictures_of_any_shape_are_drawn() {
    for size in [[16, 16], [16384, 16], [16, 16384]] {
        let mut scene = parse(SCENE);
        scene.view.size = size;
        let picture = compose(&scene, &frame(&scene, 0));
        let drawn = Renderer::new(None, size).and_then(|mut renderer| renderer.draw(&picture));
        assert_eq!(drawn.expect("no device is needed").dimensions(), (size[0], size[1]));
        let mut figure = Figure::built_in("fig4a").expect("a figure of the paper");
        figure.size = size;
        if let Ok(picture) = compose_figure(&figure, &Moments::new(&figure)) {
            Renderer::new(None, size).and_then(|mut renderer| renderer.draw(&picture)).expect("no device is needed");
        }
    }
}
