//! Fields, springs, nodes, arrows and the arrangement of panels, tested by the numbers in the picture.

use super::listed::{Listed, Mark};
use super::{compose, fig4b, gpu, parse, renderer};
use localshape::colour::{Vision, difference, oklab};
use localshape::look::{ColourMap, ColourScale, EdgeStyle, Style, Theme, Visible};
use localshape::picture::{Item, Mesh, SHADES, Second};
use localshape::runner::Frame;
use localshape::runner::Runner;
use localshape::scene::Scene;
use localshape::sim::{Divergence, Field, Status};

const NOTHING: Visible = Visible::NONE;
const EVERYTHING: Visible = Visible {
    surfaces: true,
    nodes: true,
    springs: true,
    displacements: true,
    contacts: true,
    loads: true,
    cage: true,
};
const FIELDS: [Field; 4] = [Field::Strain, Field::Displacement, Field::Speed, Field::ElasticEnergy];

/// The scene of Fig. 4(b) with a field, and one of its frames.
fn with_field(field: Field, range: [f64; 2], index: u64) -> (Scene, Frame) {
    let (mut scene, _) = fig4b(0);
    scene.view.colour = Some(ColourScale { field, to: None, range, map: ColourMap::default() });
    let frame = Runner::new(&scene, &[0, 1]).frame(index);
    (scene, frame)
}

/// A body in the plane, in mid-air and out of shape.
fn plane(view: &str) -> (Scene, Frame) {
    let text = format!(
        "time = {{ duration = 1, step = 'T/50', frames_per_second = 60 }}
        [body]
        nodes = [[0, 0], [1, 0], [1, 1], [0, 1], [2, 0]]
        elements = [[0, 1, 2, 3], [1, 4, 2]]
        positions = [[0, 0], [1, 0.1], [1.3, 1.2], [0, 1], [0.8, 0.3]]
        [[run]]
        name = 'a'
        model = {{ kind = 'mass-spring', stiffness = 1e3, springs = 'all' }}
        [view]
        {view}"
    );
    let mut scene = parse(&text);
    scene.view.camera.follow = false;
    let frame = Runner::new(&scene, &[0]).frame(0);
    (scene, frame)
}

fn marks(picture: &Listed, shape: &str) -> Vec<Mark> {
    picture.marks.iter().copied().filter(|mark| mark.shape == shape && mark.opacity == 255).collect()
}

/// The start and the tip of an arrow (px).
fn ends(arrow: &Mark) -> [glam::Vec2; 2] {
    let [x, y, length, _] = arrow.rectangle;
    let start = glam::Vec2::new(x, y);
    [start, start + length * glam::Vec2::from(arrow.along)]
}

/// The pixel of a point in a panel's coordinates.
fn pixel(picture: &Listed, panel: usize, point: glam::Vec3) -> glam::Vec2 {
    let panel = &picture.panels[panel];
    let [left, top, width, height] = panel.viewport.map(|length| length as f32);
    let at = panel.sight.clip * point.extend(1.0);
    glam::Vec2::new(left + (0.5 + 0.5 * at.x / at.w) * width, top + (0.5 - 0.5 * at.y / at.w) * height)
}

#[test]
fn corners_stand_on_the_scale_where_their_values_do() {
    let (scene, mut frame) = with_field(Field::Speed, [2.0, 6.0], 4);
    let count = scene.bodies[0].body.len();
    frame.runs[0].snapshot.field = (0..count).map(|node| node as f64).collect();
    let picture = compose(&scene, &frame);
    assert_eq!(picture.ramp.len(), SHADES);
    let mesh = &picture.panels[0].sound;
    assert_eq!(mesh.shades.len(), mesh.vertices.len());
    // Corners of the surface at nodes have the value of their node.
    for (node, &at) in frame.runs[0].snapshot.position.iter().enumerate() {
        let origin = scene.view.camera.target;
        let expected = ((node as f32 - 2.0) / 4.0).clamp(0.0, 1.0);
        let place = ((at - origin) / scene.view.side).as_vec3();
        for (vertex, &shade) in mesh.vertices.iter().zip(&mesh.shades) {
            if glam::Vec3::from(vertex.position).distance(place) < 1e-4 {
                assert!((shade - expected).abs() < 1e-5, "{node}: {shade} for {expected}");
            }
        }
    }
    assert!(mesh.shades.contains(&0.0) && mesh.shades.contains(&1.0));
}

#[test]
fn a_field_of_elements_is_flat_on_each() {
    let (scene, mut frame) = with_field(Field::Strain, [0.0, 27.0], 4);
    frame.runs[0].snapshot.field = (0..27).map(f64::from).collect();
    let mesh = &compose(&scene, &frame).panels[0].sound;
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|at| mesh.shades[at as usize] * 27.0);
        assert!((a - b).abs() < 1e-4 && (b - c).abs() < 1e-4 && (a - a.round()).abs() < 1e-4, "{a} {b} {c}");
    }
}

#[test]
fn odd_values_are_drawn_like_any_others() {
    for field in FIELDS {
        let (mut scene, mut frame) = with_field(field, [0.0, 1e-3], 4);
        for visible in [EVERYTHING, Visible { springs: true, nodes: true, ..NOTHING }] {
            scene.view.visible = visible;
            let snapshot = &mut frame.runs[1].snapshot;
            for (value, odd) in snapshot.field.iter_mut().zip([f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300, -5.0]) {
                *value = odd;
            }
            snapshot.position[3].x = 1e300;
            snapshot.status =
                Status::Diverged(Divergence { time: 0.03, step: 7, part: 0, element: None, is_end: false });
            let picture = compose(&scene, &frame);
            for panel in &picture.panels {
                for mesh in [&panel.sound, &panel.turned_over] {
                    assert!(mesh.shades.iter().all(|&at| (-1.0 - 1e-6..=1.0).contains(&at)), "{field:?}");
                }
                assert!(panel.strokes.iter().flat_map(|stroke| stroke.ends).flatten().all(f32::is_finite));
            }
            // A field that was not computed colours nothing, and is not an error.
            frame.runs[0].snapshot.field.clear();
            compose(&scene, &frame);
            frame = Runner::new(&scene, &[0, 1]).frame(4);
        }
    }
}

#[test]
fn nothing_of_it_is_there_unless_it_is_asked_for() {
    let (scene, frame) = fig4b(4);
    let picture = compose(&scene, &frame);
    assert!(picture.ramp.is_empty() && marks(&picture, "arrow").is_empty());
    for panel in &picture.panels {
        assert!(panel.strokes.is_empty() && panel.beads.is_empty() && panel.sound.shades.is_empty());
        assert_eq!(panel.viewport[3], 720);
    }
}

#[test]
fn the_bar_has_round_numbers_under_its_own_colours() {
    let (mut scene, frame) = with_field(Field::Displacement, [0.0, 0.05], 4);
    for theme in [Theme::Light, Theme::Dark] {
        scene.view.look = Style::of(theme);
        let picture = compose(&scene, &frame);
        let bar = marks(&picture, "colours");
        assert_eq!(bar.len(), 1);
        let is_ramp = |item: &Item| matches!(item, Item::Blend { colours, .. } if *colours == picture.ramp);
        assert!(picture.above.iter().any(is_ramp));
        let [left, right] = [bar[0].rectangle[0], bar[0].rectangle[0] + bar[0].rectangle[2]];
        let said = |text: &str| picture.words.iter().find(|run| run.text == text).expect(text);
        assert!(said("displacement").span[1] < left);
        // The last number ends with the bar.
        assert!((said("50 mm").span[1] - right).abs() < 0.6);
        for (text, share) in [("0", 0.0), ("25", 0.5)] {
            let middle = (said(text).span[0] + said(text).span[1]) / 2.0;
            assert!((middle - (left + share * (right - left))).abs() < 0.6, "{text}");
        }
    }
}

#[test]
fn a_point_says_that_values_lie_beyond_the_scale() {
    for (range, points) in [([0.0, 1e9], 0), ([0.0, 1e-3], 1), ([5.0, 1e9], 1), ([5.0, 6.0], 2)] {
        let (scene, frame) = with_field(Field::Speed, range, 4);
        let drawn = marks(&compose(&scene, &frame), "point");
        // Each node has an outline.
        assert_eq!(drawn.len(), 2 * points, "{range:?}");
    }
}

#[test]
fn springs_are_those_of_the_model() {
    let (mut scene, frame) = fig4b(4);
    let counts =
        |scene: &Scene| compose(scene, &frame).panels.iter().map(|panel| panel.strokes.len()).collect::<Vec<_>>();
    scene.view.visible = Visible { surfaces: true, springs: true, ..NOTHING };
    assert_eq!(counts(&scene), [0, 306]);
    let picture = compose(&scene, &frame);
    assert!(picture.panels[1].strokes.iter().all(|stroke| stroke.behind > 0 && stroke.second != Second::None));
    // Without surfaces, the shape model shows the edges of its elements, and turned-over ones stand out on both.
    scene.view.visible = Visible { springs: true, ..NOTHING };
    let edges = 3 * 3 * 16;
    assert_eq!(counts(&scene)[0], edges);
    assert_eq!(counts(&scene)[1], 306 + 9 * 12);
    assert!(
        compose(&scene, &frame).panels.iter().all(|panel| panel.sound.triangles.is_empty() && panel.lines.is_empty())
    );
    // Without both, both models show edges.
    scene.view.visible = Visible { nodes: true, ..NOTHING };
    assert_eq!(counts(&scene), [edges, edges + 9 * 12]);
}

#[test]
fn nodes_in_space_are_discs_from_back_to_front() {
    let (mut scene, frame) = fig4b(4);
    scene.view.visible.nodes = true;
    let picture = compose(&scene, &frame);
    let panel = &picture.panels[0];
    assert_eq!(panel.beads.len(), 64);
    let distance = |at: [f32; 3]| glam::Vec3::from(at).distance(panel.sight.eye);
    let w = |at: [f32; 3]| (panel.sight.clip * glam::Vec3::from(at).extend(1.0)).w;
    assert!(panel.beads.windows(2).all(|two| w(two[0].at) >= w(two[1].at) - 1e-4));
    assert!(panel.beads.iter().all(|bead| bead.radius > 3.0 && distance(bead.at) > panel.sight.near));
}

#[test]
fn many_nodes_are_drawn_when_asked_for() {
    let text = |view: &str| {
        format!(
            "time = {{ duration = 1, step = 'T/50', frames_per_second = 60 }}
            body = {{ lattice = {{ cells = [20, 20], side = 0.01 }} }}
            [[run]]
            name = 'a'
            model = {{ kind = 'shape-based', stiffness = 1e3 }}
            [view]
            {view}"
        )
    };
    for (view, expected) in [("", 0), ("show = ['surfaces', 'nodes']", 21 * 21)] {
        let scene = parse(&text(view));
        let picture = compose(&scene, &Runner::new(&scene, &[0]).frame(0));
        let discs = marks(&picture, "node");
        assert_eq!(discs.len(), expected);
        assert!(discs.iter().all(|disc| disc.rectangle[2] < 8.0), "small ones");
    }
}

#[test]
fn arrows_end_at_their_nodes() {
    // In space, nodes that face the viewer have arrows; in the plane, all with long enough displacements.
    let (mut scene, frame) = fig4b(4);
    scene.view.visible.displacements = true;
    let (flat, flat_frame) = plane("show = ['surfaces', 'displacements']");
    for (scene, frame, least) in [(&scene, &frame, 40), (&flat, &flat_frame, 4)] {
        let picture = compose(scene, frame);
        let arrows = marks(&picture, "arrow");
        let (key, in_panels) = arrows.split_last().expect("the arrow of the key");
        assert!(in_panels.len() >= least, "{}", in_panels.len());
        let below =
            picture.panels.iter().map(|panel| (panel.viewport[1] + panel.viewport[3]) as f32).fold(0.0, f32::max);
        assert!(key.rectangle[1] > below && in_panels.iter().all(|arrow| arrow.rectangle[1] < below), "one key");
        assert!(arrows.iter().all(|arrow| arrow.colour == picture.palette.text), "paths and runs have other colours");
        for arrow in in_panels {
            let near = |point: glam::Vec2, of_start: bool| {
                frame.runs.iter().enumerate().any(|(panel, run)| {
                    let snapshot = &run.snapshot;
                    (0..scene.bodies[0].body.len()).any(|node| {
                        let start = snapshot.placements[0].place(scene.bodies[0].body.rest()[node]);
                        let at = if of_start { start } else { snapshot.position[node] };
                        // The camera looks at the origin of the panel's coordinates.
                        let relative = (at - scene.view.camera.target) / scene.view.side;
                        pixel(&picture, panel, relative.as_vec3()).distance(point) < 0.05
                    })
                })
            };
            let [start, tip] = ends(arrow);
            assert!(near(tip, false) && near(start, true), "{arrow:?}");
        }
    }
}

#[test]
fn longer_arrows_begin_at_the_same_places() {
    let (mut scene, frame) = plane("show = ['surfaces', 'displacements']");
    let lengths = |scene: &Scene| {
        let picture = compose(scene, &frame);
        let arrows: Vec<_> = marks(&picture, "arrow").iter().map(ends).collect();
        arrows
    };
    let once = lengths(&scene);
    scene.view.arrow_scale = 1.5;
    let more = lengths(&scene);
    for [start, tip] in &once[..once.len() - 1] {
        let longer = more.iter().find(|[other, _]| other.distance(*start) < 0.01);
        assert!(longer.is_some_and(|[_, end]| (*end - start).distance(1.5 * (tip - start)) < 0.01));
    }
}

#[test]
fn the_key_arrow_is_as_long_as_it_says() {
    let (mut scene, _) = fig4b(0);
    scene.view.visible.displacements = true;
    let mut said = Vec::new();
    for index in [0, 4, 40] {
        let frame = Runner::new(&scene, &[0, 1]).frame(index);
        let picture = compose(&scene, &frame);
        let arrows = marks(&picture, "arrow");
        let key = arrows.last().expect("a key");
        let text = &picture.words.iter().find(|run| run.text.starts_with("displacement ")).expect("its words").text;
        let millimetres: f32 =
            text.trim_start_matches("displacement ").trim_end_matches(" mm").parse().expect("a length");
        let [start, tip] = ends(key);
        let sides = millimetres / 1e3 / scene.view.side as f32;
        assert!((tip.distance(start) - sides * picture.panels[0].sight.element).abs() < 0.05, "{text}");
        said.push(text.clone());
    }
    assert!(said.windows(2).all(|two| two[0] == two[1]), "{said:?}");
}

/// The boxes of all texts and marks of the legend and of the panels, without marks on bodies (px).
fn boxes(picture: &Listed) -> Vec<([f32; 4], String)> {
    let words = picture.words.iter().map(|run| {
        let top = run.baseline - 0.74 * run.size;
        ([run.span[0], top, run.span[1], run.baseline + 0.05 * run.size], run.text.clone())
    });
    let tally = picture.marks.iter().filter(|mark| {
        let struck = matches!(mark.shape, "struck" | "colours" | "point");
        // The outline of a point is below it.
        (struck && mark.colour != picture.palette.axis)
            || (mark.shape == "rectangle" && mark.colour == picture.palette.tally)
    });
    let tally = tally.map(|mark| {
        let [left, top, width, height] = mark.rectangle;
        let left = if mark.along[0] < 0.0 { left - width } else { left };
        let top = if mark.along[0] < 0.0 { top - height } else { top };
        ([left, top, left + width, top + height], format!("{:?}", mark.shape))
    });
    // The only arrow below all panels is that of the legend.
    let lowest = picture.panels.iter().map(|panel| panel.viewport[1] + panel.viewport[3]).max().unwrap_or(0) as f32;
    let key = picture.marks.iter().filter(|mark| mark.shape == "arrow" && mark.rectangle[1] > lowest);
    let key = key.map(|arrow| {
        let ([start, tip], half) = (ends(arrow), 0.5 * arrow.rectangle[3]);
        ([start.x, start.y - half, tip.x, tip.y + half], "key arrow".to_owned())
    });
    words.chain(tally).chain(key).collect()
}

#[test]
fn nothing_overlaps_in_any_arrangement() {
    let (mut scene, frame) = with_field(Field::ElasticEnergy, [0.0, 12.5], 4);
    scene.view.visible = EVERYTHING;
    for count in [1, 2, 3, 4, 6, 9, 12] {
        let runs: Vec<_> = (0..count).map(|at| frame.runs[at % 2].clone()).collect();
        let frame = Frame { runs, ..frame.clone() };
        // Each arrangement once.
        for columns in [1, 2, 3].into_iter().filter(|&columns| columns < count).chain([count]) {
            for size in [[1280, 720], [640, 360], [720, 1280], [480, 480], [1920, 1080], [300, 200]] {
                scene.view.size = size;
                scene.view.columns = Some(columns);
                let picture = compose(&scene, &frame);
                assert_eq!(picture.panels.len(), count);
                let clocks = picture.words.iter().filter(|run| run.text == "67 ms").count();
                assert!(clocks <= 1, "{count} {columns} {size:?}: {clocks} clocks");
                let boxes = boxes(&picture);
                for (at, (one, name)) in boxes.iter().enumerate() {
                    let inside = one[0] >= 0.0 && one[1] >= 0.0 && one[2] <= size[0] as f32 && one[3] <= size[1] as f32;
                    assert!(inside, "{count} {columns} {size:?}: {name} at {one:?}");
                    for (other, other_name) in &boxes[..at] {
                        let apart = one[2] <= other[0] + 0.1
                            || other[2] <= one[0] + 0.1
                            || one[3] <= other[1] + 0.1
                            || other[3] <= one[1] + 0.1;
                        assert!(apart, "{count} {columns} {size:?}: {name} {one:?} and {other_name} {other:?}");
                    }
                }
                // Bodies stay above the legend.
                let lowest = picture.panels.iter().map(|panel| panel.viewport[1] + panel.viewport[3]).max();
                let bar = marks(&picture, "colours");
                if let (Some(lowest), Some(bar)) = (lowest, bar.first()) {
                    assert!(bar.rectangle[1] + bar.rectangle[3] > lowest as f32 && lowest < size[1]);
                }
            }
        }
    }
}

#[test]
fn every_combination_is_drawn_the_same_twice() {
    let Some(gpu) = gpu("every_combination_is_drawn_the_same_twice") else { return };
    let (mut scene, frame) = with_field(Field::Speed, [0.0, 10.0], 4);
    scene.view.size = [320, 180];
    let (plain, plain_frame) = fig4b(4);
    let mut plain = plain;
    plain.view.size = [320, 180];
    let mut renderer = renderer(gpu, scene.view.size);
    let before = renderer.draw(&compose(&plain, &plain_frame)).expect("the device works");
    let mut last = before.clone();
    for bits in 1..16_u32 {
        let bit = |at: u32| bits >> at & 1 == 1;
        scene.view.visible =
            Visible { surfaces: bit(0), nodes: bit(1), springs: bit(2), displacements: bit(3), ..NOTHING };
        let image = renderer.draw(&compose(&scene, &frame)).expect("the device works");
        assert!(image != last, "{bits:b}");
        assert_eq!(image, renderer.draw(&compose(&scene, &frame)).expect("the device works"), "{bits:b}");
        last = image;
    }
    assert_eq!(before, renderer.draw(&compose(&plain, &plain_frame)).expect("the device works"));
}

#[test]
fn the_plane_shows_the_colours_of_the_bar() {
    let Some(gpu) = gpu("the_plane_shows_the_colours_of_the_bar") else { return };
    for theme in [Theme::Light, Theme::Dark] {
        let (mut scene, mut frame) = plane("show = ['surfaces']\ncolour = { by = 'strain', range = [0, 1] }");
        scene.view.look = Style::of(theme);
        scene.view.size = [320, 180];
        frame.runs[0].snapshot.turned_over = vec![false; 2];
        for at in [0, 20, SHADES - 1] {
            frame.runs[0].snapshot.field = vec![at as f64 / (SHADES - 1) as f64; 2];
            let picture = compose(&scene, &frame);
            let mut renderer = renderer(gpu, scene.view.size);
            let image = renderer.draw(&picture).expect("the device works");
            let near = |pixel: &image::Rgb<u8>| pixel.0.iter().zip(picture.ramp[at]).all(|(&a, b)| a.abs_diff(b) <= 2);
            let [x, y, width, height] = picture.panels[0].region;
            let body = image::imageops::crop_imm(&image, x, y, width, height).to_image();
            let count = body.pixels().filter(|pixel| near(pixel)).count();
            assert!(count > 300, "{theme:?} {at}: {count}");
        }
    }
}

#[test]
fn light_keeps_the_colours_of_the_key() {
    use ColourMap::{Cividis, Greys, Magma, MintIndigo, PurpleGreen, VioletGreen, Viridis};
    let Some(gpu) = gpu("light_keeps_the_colours_of_the_key") else { return };
    let (mut scene, mut frame) = with_field(Field::Speed, [0.0, 1.0], 4);
    let view = &mut scene.view;
    (view.size, view.edges) = ([200, 160], EdgeStyle::Outline);
    frame.runs.truncate(1);
    let mut renderer = localshape::render::Renderer::new(gpu, scene.view.size).expect("a size that can be drawn");
    let maps = [MintIndigo, Viridis, Cividis, Magma, Greys, VioletGreen, PurpleGreen];
    for (map, theme) in maps.into_iter().flat_map(|map| [Theme::Light, Theme::Dark].map(|theme| (map, theme))) {
        scene.view.look = Style::of(theme);
        scene.view.colour = Some(ColourScale { field: Field::Speed, to: None, range: [0.0, 1.0], map });
        for at in [0, 16, 32, 47, SHADES - 1] {
            frame.runs[0].snapshot.field.fill(at as f64 / (SHADES - 1) as f64);
            let mut picture = compose(&scene, &frame);
            (picture.words, picture.marks) = Default::default();
            picture.panels[0].borders.clear();
            picture.panels[0].lines.clear();
            let key = picture.ramp[at];
            let image = renderer.draw(&picture).expect("the device works");
            picture.panels[0].sound = Mesh::default();
            let ground = renderer.draw(&picture).expect("the device works");
            let on_body = image.pixels().zip(ground.pixels()).filter(|(body, ground)| body != ground);
            let colours: Vec<_> = on_body.map(|(body, _)| body.0).collect();
            assert!(colours.len() > 800, "{map:?} {theme:?} {at}: {}", colours.len());
            let most = colours.iter().map(|&colour| difference(colour, key, Vision::Normal)).fold(0.0, f64::max);
            assert!(most <= 5.0, "{map:?} {theme:?} {at}: {most} from {key:x?}");
            // Faces are distinguishable nevertheless.
            let lightness = colours.iter().map(|&colour| oklab(colour).0[0]);
            let (least, most) = lightness.fold((1.0, 0.0), |(a, b): (f64, f64), at| (a.min(at), b.max(at)));
            assert!(most / least > 1.03, "{map:?} {theme:?} {at}: {least} {most}");
        }
    }
}
