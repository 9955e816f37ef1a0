//! The shadows that bodies and obstacles cast on each other.

use super::{compose, draw, fig4b, frame, gpu, parse};
use glam::{DVec3, Vec3};
use localshape::picture::Picture;
use localshape::scene::Scene;

const WORLD: &str = "
    contact = { rule = 'nodes' }
    time = { duration = 1, step = 'T/50', frames_per_second = 50 }
    run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1e3 } }]
    body = { lattice = { cells = [2, 2, 2], side = 0.1 }, lowest = 0.1 }
    [view]
    size = [320, 240]
    labels = []
    show = ['surfaces']
    camera = { target = [0, 0.2, 0], distance = 2, azimuth = 0.5, elevation = 0.6 }
";
/// The middle of the upper side of the body (m).
const TOP: DVec3 = DVec3::new(0.0, 0.3, 0.0);

/// A picture of the start.
fn start(scene: &Scene) -> Picture {
    Picture::clone(&compose(scene, &frame(scene, 0)))
}

/// A small ball at a distance (m) from a point towards the key light.
fn ball(towards: Vec3, from: DVec3, distance: f64) -> String {
    let [x, y, z] = (from + distance * towards.as_dvec3()).to_array();
    format!("[[obstacle]]\nkind = 'sphere'\ncentre = [{x}, {y}, {z}]\nradius = 0.04\n")
}

#[test]
fn only_surfaces_that_can_shade_each_other_have_a_map() {
    let has_map = |text: &str| start(&parse(text)).panels[0].sight.key_map.is_some();
    let plate = "[[obstacle]]\nkind = 'plate'\npoint = [0, 0.8, 0]\nnormal = [0, -1, 0]\n";
    let near = "[[obstacle]]\nkind = 'sphere'\ncentre = [0, 0.5, 0]\nradius = 0.1\n";
    assert!(!has_map(WORLD) && !has_map(&format!("{WORLD}\n[[obstacle]]\nkind = 'floor'\n")));
    assert!(has_map(&format!("{WORLD}\n{near}")) && has_map(&format!("{WORLD}\n{plate}")));
    assert!(!has_map(&format!("{}\n{near}", WORLD.replace("labels", "shadow = false\nlabels"))));
    let two = "body = [{ name = 'a', lattice = { cells = [1, 1, 1], side = 0.1 } },
        { name = 'b', lattice = { cells = [1, 1, 1], side = 0.1 }, offset = [0.3, 0, 0] }]\n";
    let one = WORLD.lines().find(|line| line.contains("body")).expect("a body");
    assert!(has_map(&WORLD.replace(one, two)));
    // A body that folds shades itself.
    let of_springs = |index: u64| {
        let (scene, frame) = fig4b(index);
        compose(&scene, &frame).panels[1].sight.key_map.is_some()
    };
    assert!(!of_springs(0) && of_springs(20));
}

#[test]
fn a_ball_shades_the_body_below_it_and_nothing_else() {
    let Some(gpu) = gpu("a_ball_shades_the_body_below_it_and_nothing_else") else { return };
    let plain = parse(WORLD);
    let alone = start(&plain);
    let towards = alone.panels[0].sight.key;
    let seen = |picture: &Picture, point: DVec3| {
        let from_origin = ((point - plain.view.camera.target) / plain.view.side).as_vec3();
        let at = picture.panels[0].sight.clip * from_origin.extend(1.0);
        [(0.5 + 0.5 * at.x / at.w) * 320.0, (0.5 - 0.5 * at.y / at.w) * 240.0].map(|place| place as u32)
    };
    // Too far for its ambient light to count. Only the shadow of the ball is drawn.
    let shaded = |from: DVec3| {
        let mut picture = start(&parse(&format!("{WORLD}\n{}", ball(towards, from, 0.6))));
        picture.panels[0].obstacles.occluders.clear();
        picture
    };
    let with = shaded(TOP);
    assert_eq!(with.panels[0].sight.clip, alone.panels[0].sight.clip);
    let [without, with] = [&alone, &with].map(|picture| draw(gpu, picture));
    let green = |image: &image::RgbImage, point: DVec3| {
        let [x, y] = seen(&alone, point);
        super::linear(image.get_pixel(x, y)[1])
    };
    let [lit, dark] = [&without, &with].map(|image| green(image, TOP + DVec3::new(0.02, 0.0, 0.02)));
    // Of the green of the key light, .635, a tenth is left; that of the sky, .635, stays.
    let key = 0.635 * (f64::from(towards.y) + 0.12) / 1.12;
    let expected = (0.1 * key + 0.635) / (key + 0.635);
    assert!((dark / lit - expected).abs() < 0.02, "{dark} of {lit} in place of {expected}");
    // Beside the shadow nothing is darker: surfaces do not shade themselves.
    let far = draw(gpu, &shaded(TOP + DVec3::new(3.0, 0.0, 0.0)));
    let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]].map(|[x, z]| TOP + 0.08 * DVec3::new(x, 0.0, z));
    for point in corners {
        assert_eq!(green(&with, point), green(&without, point), "{point}");
    }
    assert!(far == without, "surfaces shade themselves");
}

/// Maps of earlier pictures leave nothing behind, also where a picture needs more of them.
#[test]
fn a_renderer_draws_shadows_as_a_new_one_does() {
    let Some(gpu) = gpu("a_renderer_draws_shadows_as_a_new_one_does") else { return };
    let (none, one) = (parse(WORLD), parse(&format!("{WORLD}\n{}", ball(Vec3::Y, TOP, 0.2))));
    let runs = "run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1e3 } },
        { name = 'two', model = { kind = 'shape-based', stiffness = 1e3 } }]\n";
    let line = WORLD.lines().find(|line| line.contains("run =")).expect("a run");
    let two = parse(&format!("{}\n{}", WORLD.replace(line, runs), ball(Vec3::Y, TOP, 0.2)));
    let mut pictures = [none, one, two].map(|scene| start(&scene)).to_vec();
    // A map in the second panel alone.
    let mut second = pictures[2].clone();
    second.panels[0].sight.key_map = None;
    pictures.extend([second, pictures[1].clone(), pictures[0].clone()]);
    let mut renderer = super::renderer(gpu, pictures[0].size);
    for (at, picture) in pictures.iter().enumerate() {
        assert!(renderer.draw(picture).expect("drawn") == draw(gpu, picture), "picture {at}");
    }
}
