//! Contact in scene files: what it means, and every mistake in it.

use super::{bad, expect, good};
use localshape::sim::{BodyContact, Contacts, PairContact, Side};

/// Two blocks side by side, and obstacles of three kinds away from them.
const WORLD: &str = "\
time = { duration = 1 }
run = [
    { name = 'Both', model = { kind = 'shape-based', stiffness = 1e4 } },
    { name = 'Cube', bodies = ['cube'], model = { kind = 'shape-based', stiffness = 1e4 } },
]
body = [
    { name = 'bar', lattice = { cells = [2, 1, 1], side = 0.1 } },
    { name = 'cube', lattice = { cells = [1, 1, 1], side = 0.3 }, offset = [1, 0, 0] },
]
obstacle = [
    { kind = 'floor', name = 'ground', height = -1 },
    { kind = 'sphere', name = 'ball', centre = [0, 2, 0], radius = 0.1 },
    { kind = 'box', name = 'stone', centre = [0, -0.8, 0], size = [0.1, 0.1, 0.1] },
]
";

/// Adds lines to the world and expects exactly these mistakes in the addition.
#[track_caller]
fn case(added: &str, expected: &str) {
    expect(&bad(&format!("{WORLD}{added}")), WORLD.lines().count(), expected);
}

#[test]
fn surfaces_meet_unless_a_scene_says_nodes() {
    let plain = good(WORLD);
    let usual = Contacts { bodies: vec![BodyContact::default(); 2], ..Contacts::default() };
    assert_eq!(plain.contacts, Some(usual));
    assert_eq!(good(&format!("{WORLD}contact.rule = 'surfaces'")).digest, plain.digest);
    let nodes = good(&format!("{WORLD}contact.rule = 'nodes'"));
    assert_eq!(nodes.contacts, None);
    assert_ne!(nodes.digest, plain.digest);
}

#[test]
fn where_no_surfaces_can_meet_the_rule_changes_no_digest() {
    let one = "time.duration = 1\nobstacle = [{ kind = 'floor' }]
        run = [{ name = 'One', model = { kind = 'shape-based', stiffness = 1e4 } }]
        body = { lattice = { cells = [1, 1, 1], side = 0.1 }, lowest = 0.1 }\n";
    let digest = |text: &str| good(text).digest;
    let plain = digest(one);
    assert_eq!(digest(&format!("{one}contact.rule = 'nodes'")), plain);
    assert_eq!(digest(&format!("{one}contact.friction = 0.5")), plain);
    let own = one.replace("lowest", "self_contact = true, lowest");
    assert_ne!(digest(&own), plain);
    let ball = "obstacle = [{ kind = 'sphere', centre = [1, 1, 1], radius = 0.1 }";
    let beside = one.replace("obstacle = [{ kind = 'floor' }", ball);
    // Nodes met obstacles at first: the digest of such scenes has stayed.
    assert_ne!(digest(&beside), digest(&format!("{beside}contact.rule = 'nodes'")));
}

#[test]
fn all_settings_reach_the_bodies_of_each_run() {
    let added = "contact = { restitution = 0.4, friction = 0.6, pair = [
        { of = ['cube', 'bar'], friction = 0.1 }, { of = ['ball', 'cube'], restitution = 1, thickness = 0.01 }] }";
    let text =
        format!("{WORLD}{added}").replace("'cube', lattice", "'cube', self_contact = true, thickness = 0.02, lattice");
    let scene = good(&text);
    let own = BodyContact { thickness: Some(0.02), itself: true };
    let pair = |of, restitution, friction, thickness| PairContact { of, restitution, friction, thickness };
    let ball = |body| pair([Side::Obstacle(1), Side::Body(body)], Some(1.0), None, Some(0.01));
    let all = Contacts {
        restitution: 0.4,
        friction: 0.6,
        bodies: vec![BodyContact::default(), own],
        pairs: vec![pair([Side::Body(1), Side::Body(0)], None, Some(0.1), None), ball(1)],
    };
    assert_eq!(scene.contacts.as_ref(), Some(&all));
    // Alone the cube is body 0, and has no pair with the bar.
    assert_eq!(scene.runs[0].contacts(&all), all);
    assert_eq!(scene.runs[1].contacts(&all), Contacts { bodies: vec![own], pairs: vec![ball(0)], ..all });
}

#[test]
fn names_of_pairs() {
    case(
        "[[contact.pair]]\nof = ['cub', 'bar']\nfriction = 1",
        "2:7 there is no body or obstacle \"cub\" did you mean \"cube\"?",
    );
    case(
        "[[contact.pair]]\nof = ['x', 'bar']\nfriction = 1",
        "2:7 there is no body or obstacle \"x\" the names are \"bar\", \"cube\", \"ground\", \"ball\" and \"stone\"",
    );
    case(
        "[[contact.pair]]\nof = ['cube', 'cube']\nfriction = 1",
        "2:6 this is a pair of \"cube\" with itself a body with `self_contact = true` meets itself",
    );
    case(
        "[[contact.pair]]\nof = ['ball', 'stone']\nfriction = 1",
        "2:6 \"ball\" and \"stone\" are obstacles, which do not meet name a body",
    );
    case(
        "[[contact.pair]]\nof = ['bar', 'ground']\nfriction = 1",
        "2:14 \"ground\" is a half-space, which all bodies meet in the same way give the obstacle its own",
    );
    case(
        "[[contact.pair]]\nof = ['cube', 'bar']\nfriction = 1\n[[contact.pair]]\nof = ['bar', 'cube']\nfriction = 2",
        "5:6 \"bar\" and \"cube\" are a pair already, `contact.pair[0]` keep one of the two",
    );
    let apart = WORLD.replace("'Both'", "'Bar', bodies = ['bar']");
    let pair = "[[contact.pair]]\nof = ['cube', 'bar']\nfriction = 1";
    let lines = apart.lines().count();
    expect(
        &bad(&format!("{apart}{pair}")),
        lines,
        "2:6 the pair changes nothing, as no run simulates \"cube\" and \"bar\"",
    );
    case("[[contact.pair]]\nof = ['cube', 'bar']", "2:6 the pair of \"cube\" and \"bar\" changes nothing");
    case("[[contact.pair]]\nof = ['cube']\nfriction = 1", "2:6 `contact.pair[0].of` has 1 entry; expected");
    let twice = |from: &str, to: &str, expected: &str| expect(&bad(&WORLD.replace(from, to)), 0, expected);
    twice("'ball'", "'ground'", "12:31 two obstacles are called \"ground\": `obstacle[0]` and `obstacle[1]`");
    twice("'ball'", "'cube'", "12:31 a body and an obstacle are called \"cube\" give the obstacle another name");
}

#[test]
fn numbers_out_of_range() {
    for (added, expected) in [
        ("contact.restitution = 1.5", "1:23 `contact.restitution` is 1.5; expected a number from 0 to 1"),
        ("contact.friction = -0.5", "1:20 `contact.friction` is -0.5; expected a number of at least 0"),
        (
            "[[contact.pair]]\nof = ['cube', 'bar']\nthickness = -0.1",
            "3:13 `contact.pair[0].thickness` is -0.1; expected a number greater than 0",
        ),
        (
            "[[contact.pair]]\nof = ['cube', 'bar']\nthickness = 0.2",
            "3:13 the thickness 200 mm is larger than a cell of the body \"bar\", 100 mm expected at most 100 mm",
        ),
        ("contact.rule = 'faces'", "1:16 `contact.rule` is \"faces\"; expected \"surfaces\" or \"nodes\""),
        ("contact = 'nodes'", "1:11 `contact` is the string \"nodes\"; expected a table"),
    ] {
        case(added, expected);
    }
    let thick = |value: &str| bad(&WORLD.replace("'bar', lattice", &format!("'bar', thickness = {value}, lattice")));
    expect(&thick("0.2"), 0, "7:33 the thickness 200 mm is larger than a cell of the body \"bar\", 100 mm");
    expect(&thick("0"), 0, "7:33 `body[0].thickness` is 0; expected a number greater than 0");
}

#[test]
fn settings_of_surfaces_beside_nodes() {
    let nodes = format!("{WORLD}[contact]\nrule = 'nodes'\n");
    let idle = |key: &str| format!("`{key}` has no effect, as `contact.rule` is \"nodes\"");
    let of_contact = |added: &str, place: &str, key: &str| {
        expect(&bad(&format!("{nodes}{added}")), nodes.lines().count(), &format!("{place} {}", idle(key)));
    };
    of_contact("friction = 1", "1:1", "contact.friction");
    of_contact("[[contact.pair]]\nof = ['cube', 'bar']\nfriction = 1", "1:11", "contact.pair");
    let of_body = nodes.replace("'bar', lattice", "'bar', self_contact = true, lattice");
    expect(&bad(&of_body), 0, &format!("7:21 {}", idle("body[0].self_contact")));
}

/// Surfaces have the friction of paths; nodes have that of an obstacle.
#[test]
fn friction_of_an_obstacle_that_surfaces_meet() {
    let of =
        |friction_of: &str| WORLD.replace("name = 'ball',", &format!("name = 'ball', friction = 0.5{friction_of},"));
    good(&of(""));
    let idle =
        "12:55 `friction_of` has no effect, as surfaces meet this obstacle: their friction acts on the path remove it";
    expect(&bad(&of(", friction_of = 'velocity'")), 0, idle);
    good(&format!("{}contact.rule = 'nodes'", of(", friction_of = 'velocity'")));
}

/// Nodes meet half-spaces, so that a thickness keeps no distance from them.
#[test]
fn a_thickness_without_a_surface_to_meet() {
    let alone =
        WORLD.lines().filter(|line| !line.contains("'Both'") && !line.starts_with("    { kind")).collect::<Vec<_>>();
    let alone = alone.join("\n") + "\n";
    let thick = |world: &str| world.replace("offset = [1, 0, 0]", "offset = [1, 0, 0], thickness = 0.01");
    good(&alone);
    let idle = "7:99 the thickness of the body \"cube\" changes nothing: nothing meets its surface, and floors and plates meet its nodes remove it";
    expect(&bad(&thick(&alone)), 0, idle);
    good(&thick(&alone).replace("thickness", "self_contact = true, thickness"));
    // Bodies of different runs do not meet; those of one run do.
    let other = alone.replace(
        "run = [",
        "run = [{ name = 'Bar', bodies = ['bar'], model = { kind = 'shape-based', stiffness = 1e4 } },",
    );
    expect(&bad(&thick(&other)), 0, idle);
    good(&thick(WORLD));
}

/// A body of two layers at one place, whose nodes are not the same.
#[test]
fn layers_of_one_body_at_one_place() {
    let layers = "run = [{ name = 'One', model = { kind = 'shape-based', stiffness = 1e3 } }]
time.duration = 0.1
[body]
nodes = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, -1]]
elements = [[0, 1, 2, 3], [4, 6, 5, 7]]
";
    good(layers);
    let told = "3:1 the body touches itself at the start, at node 0: contact cannot part them move these nodes apart, join them";
    expect(&bad(&format!("{layers}self_contact = true")), 0, told);
}

/// Contact keeps surfaces apart, but cannot part them.
#[test]
fn bodies_that_overlap_or_touch_at_the_start() {
    let moved = |to: &str| WORLD.replace("offset = [1, 0, 0]", &format!("offset = {to}"));
    // They stand side by side from 0.25 m on.
    let message = |to: &str| match to {
        "[0.2, 0, 0]" => {
            "reach 50 mm into each other at the start, at node 5 of \"bar\": contact cannot part them move"
        }
        _ => "touch at the start, at node",
    };
    for to in ["[0.2, 0, 0]", "[0.25, 0, 0]", "[0, 0.1, 0]", "[0, -0.3, 0]", "[0, 0, -0.2]"] {
        expect(&bad(&moved(to)), 0, &format!("8:5 \"bar\" and \"cube\" {}", message(to)));
        assert_eq!(good(&format!("{}contact.rule = 'nodes'", moved(to))).contacts, None);
    }
    for to in ["[0.26, 0, 0]", "[0, 0.11, 0]", "[0, 0, -0.21]"] {
        good(&moved(to));
    }
    // Nearer than the distance that they keep.
    let thrown = "8:5 \"bar\" and \"cube\" are 1 mm apart at the start, at node 5 of \"bar\": contact keeps them 8.05 mm apart, and the first \
                  step would throw them there move one of them, with `offset` or `lowest`, write contact.separate = true, or give their";
    expect(&bad(&moved("[0.251, 0, 0]")), 0, thrown);
    good(&format!("{}contact.separate = true", moved("[0.251, 0, 0]")));
    good(&format!("{}[[contact.pair]]\nof = ['bar', 'cube']\nthickness = 0.001", moved("[0.251, 0, 0]")));
    // Its upper side is at the height of the bar's lower one.
    let stone = |centre: &str| WORLD.replace("[0, -0.8, 0]", centre);
    let message = "13:5 the body \"bar\" touches this box at the start, at node 1 move one of them";
    expect(&bad(&stone("[0, -0.05, 0]")), 0, message);
    good(&stone("[0, -0.06, 0]"));
    let near =
        "13:5 the body \"bar\" is 100 µm from this box at the start, at node 0: contact keeps them 2.01 mm apart";
    expect(&bad(&stone("[0, -0.0501, 0]")), 0, near);
    let deep = "13:5 the body \"bar\" reaches 10 mm into this box at the start, at node";
    expect(&bad(&stone("[0, -0.04, 0]")), 0, deep);
}

/// The second body goes along the axis on which it is nearest to the side, and `check` tells its way.
#[test]
fn bodies_are_moved_apart_where_a_scene_says_so() {
    let near = WORLD.replace("offset = [1, 0, 0]", "offset = [0.2, 0, 0]");
    let scene = good(&format!("{near}contact.separate = true"));
    let way = scene.bodies[1].separated;
    // 50 mm and the distances that both keep.
    assert!(scene.bodies[0].separated == glam::DVec3::ZERO && way.x > 0.05 && way.x < 0.06 && way.y == 0.0, "{way}");
    let before = good(&format!("{near}contact.rule = 'nodes'"));
    let both = before.bodies[1].initial.position.iter().zip(&scene.bodies[1].initial.position);
    assert!(both.clone().all(|(&from, &to)| from + way == to));
    assert_eq!(scene.runs[0].initial.position[12..], scene.bodies[1].initial.position);
    assert!(scene.summary().to_string().contains("moved by (0.05"), "{}", scene.summary());
    // Between a floor and a lid there is no way.
    let lid = "{ kind = 'plate', point = [0, 0.08, 0], normal = [0, -1, 0] }";
    let shut = WORLD.replace("height = -1", "height = 0.02").replace("obstacle = [", &format!("obstacle = [{lid},"));
    let found = bad(&format!("{shut}contact.separate = true")).to_string();
    assert!(found.contains("; `contact.separate` did not part them"), "{found}");
    // Where nothing overlaps nothing moves, and nodes cannot be separated.
    assert_eq!(good(&format!("{WORLD}contact.separate = true")).bodies[1].separated, glam::DVec3::ZERO);
    let idle = "1:1 `contact.separate` has no effect, as `contact.rule` is \"nodes\"";
    case("contact = { separate = true, rule = 'nodes' }", &idle.replacen("1:1", "1:13", 1));
}

/// The cube has cells of .3 m, the bar of .1 m.
#[test]
fn steps_in_which_nodes_move_far_are_told() {
    let fast = |speed: &str, step: &str| {
        let moving = WORLD.replace("offset = [1, 0, 0]", &format!("offset = [1, 0, 0], velocity = [-{speed}, 0, 0]"));
        let mut warnings = good(&moving.replace("duration = 1", &format!("duration = 1, step = {step}"))).warnings;
        warnings.retain(|warning| warning.message.contains("sideways"));
        warnings
    };
    let found = fast("80", "1e-3");
    assert_eq!(found.len(), 1, "{found:?}");
    let expected =
        "nodes of \"Both\" move 80 mm in a step relative to others, at 80 m/s at the start, and a cell has 100 mm";
    assert!(found[0].message.starts_with(expected), "{found:?}");
    assert_eq!(fast("40", "1e-3"), []);
    let pulled = WORLD.replace("duration = 1", "duration = 1, step = 1e-3")
        + "[[grab]]\nbody = 'cube'\nnodes = 'right'\npath.keys = [{ time = 0 }, { time = 0.1, shift = [-6, 0, 0] }]\n";
    let told = good(&pulled)
        .warnings
        .iter()
        .any(|one| one.message.contains("along its path") && one.message.contains("sideways"));
    assert!(told, "{:?}", good(&pulled).warnings);
    assert_eq!(fast("80", "5e-4"), []);
}

#[test]
fn surfaces_do_not_break_with_their_elements() {
    let breaking = WORLD
        .replace("'Both', model = { kind = 'shape-based',", "'Both', model = { breaks_at = 0.1, kind = 'shape-based',");
    let warnings = good(&breaking).warnings;
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert_eq!(warnings[0].message, "elements of \"Both\" break, but the surface that meets others stays whole");
    assert_eq!(good(&format!("{breaking}contact.rule = 'nodes'")).warnings, []);
}
