//! Recordings beside the scene.

use super::archives::{Array, archive, doubles, indices};
use super::expect;
use glam::DVec3;
use localshape::runner::Runner;
use localshape::scene::{Limits, Scene, SceneError};
use localshape::sim::{Moment, Status};
use zip::CompressionMethod;

const SCENE: &str = "\
[time]
duration = 1
[body]
nodes = [[0, 0], [1, 0], [1, 1], [0, 1]]
elements = [[0, 1, 2], [0, 2, 3]]
[[run]]
name = 'Played'
states = 'played.npz'
";

const REST: [f64; 8] = [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0];

pub(super) fn load(scene: &str, bytes: &[u8]) -> (tempfile::TempDir, Result<Scene, SceneError>) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("played.npz"), bytes).unwrap();
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let scene = Scene::load(&folder.path().join("scene.toml"), &Limits::default());
    (folder, scene)
}

pub(super) fn stored(arrays: &[Array]) -> Vec<u8> {
    archive(arrays, CompressionMethod::Stored)
}

/// The square, whose nodes swing along x, at moments `apart` (s) up to 1 s.
fn swing(rate: f64, apart: f64) -> Vec<Array> {
    let moments = (1.0 / apart).round() as usize + 1;
    let times: Vec<_> = (0..moments).map(|at| at as f64 * apart).collect();
    let at =
        |time: &f64| REST.chunks(2).flat_map(move |rest| [rest[0] + (rate * time).sin(), rest[1]]).collect::<Vec<_>>();
    let position: Vec<f64> = times.iter().flat_map(at).collect();
    vec![
        doubles("time", &format!("({moments},)"), &times),
        doubles("position", &format!("({moments}, 4, 2)"), &position),
    ]
}

/// Between moments linear in time: within the largest acceleration times Δt²/8, and exact at them.
#[test]
fn positions_are_within_the_error_of_linear_interpolation() {
    let (rate, apart) = (5.0_f64, 0.05);
    let (_folder, scene) = load(SCENE, &stored(&swing(rate, apart)));
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    let mut world = scene.world(0);
    let bound = rate * rate * apart * apart / 8.0;
    let mut largest: f64 = 0.0;
    for at in 0..=400 {
        let time = f64::from(at) * 0.0025;
        world.advance_towards(Moment::at(time), u64::MAX);
        // The nearest step of the clock.
        let (time, state) = (world.snapshot().time, world.state());
        let error = (state.position[2].x - 1.0 - (rate * time).sin()).abs();
        let speed = (state.velocity[2].x - rate * (rate * time).cos()).abs();
        assert!(error <= bound * (1.0 + 1e-9), "{time} s: {error:e} and {bound:e}");
        let inner = time > apart && time < 1.0 - apart;
        assert!(!inner || speed < rate.powi(3) * apart * apart * (1.0 / 6.0 + 1.0 / 8.0), "{time} s: {speed}");
        largest = largest.max(error);
        if at % 20 == 0 {
            assert!(error < 1e-12, "{time} s is recorded");
        }
    }
    assert!(largest > 0.9 * bound && world.status() == Status::Ok);
}

#[test]
fn own_bodies_and_those_of_the_scene() {
    let same =
        [&swing(5.0, 0.5)[..], &[doubles("rest", "(4, 2)", &REST), indices("elements", "(2, 3)", &[0, 1, 2, 0, 2, 3])]];
    let (_folder, scene) = load(SCENE, &stored(&same.concat()));
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((scene.bodies.len(), &scene.runs[0].of[..]), (1, &[0][..]));
    let other = [
        &swing(5.0, 0.5)[..],
        &[
            doubles("rest", "(4, 2)", &REST),
            indices("elements", "(1, 4)", &[0, 1, 2, 3]),
            doubles("mass", "(4,)", &[2.0; 4]),
        ],
    ];
    let (_folder, scene) = load(SCENE, &stored(&other.concat()));
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((scene.bodies.len(), &scene.runs[0].of[..], scene.bodies[1].name.as_str()), (2, &[1][..], "Played"));
    assert_eq!((scene.runs[0].body().elements().len(), scene.runs[0].body().mass()[0]), (1, 2.0));
    let frame = Runner::new(&scene, &[0]).frame(60);
    assert_eq!(frame.runs[0].snapshot.position[1], DVec3::new(1.0 + 5.0_f64.sin(), 0.0, 0.0));
}

#[test]
fn what_a_recording_contains_is_in_the_digest() {
    let digest = |arrays: &[Array]| load(SCENE, &stored(arrays)).1.unwrap_or_else(|error| panic!("{error}")).digest;
    let one = swing(5.0, 0.5);
    let moved = swing(5.0 + 1e-12, 0.5);
    assert_eq!(digest(&one), digest(&one));
    assert_ne!(digest(&one), digest(&moved));
    assert_ne!(digest(&one), digest(&[&one[..], &[doubles("step", "()", &[0.5])]].concat()));
}

/// Expects one mistake, at the name of the file.
#[track_caller]
fn wrong(arrays: &[Array], expected: &str) {
    wrong_bytes(&stored(arrays), expected);
}

#[track_caller]
fn wrong_bytes(bytes: &[u8], expected: &str) {
    let error = load(SCENE, bytes).1.expect_err(expected);
    expect(&error, 0, &format!("8:10 {expected}\n"));
}

#[test]
fn damaged_recordings_are_refused_with_place_and_remedy() {
    let times = |times: &[f64]| doubles("time", "(3,)", times);
    let sound = swing(5.0, 0.5);
    let position = &sound[1];
    let with_number = |at: usize, number: f64| {
        let mut array = position.clone();
        array.bytes[at * 8..][..8].copy_from_slice(&number.to_le_bytes());
        vec![sound[0].clone(), array]
    };
    wrong(
        &with_number(8 + 5, f64::NAN),
        "`played.npz: position[1][2][1]` is NaN; expected a finite number; write only the moments before the motion failed",
    );
    wrong(&with_number(0, 1e40), "`played.npz: position[0][0][0]` is 1");
    wrong(std::slice::from_ref(position), "`played.npz` has no array `time`, the time of each moment (s)");
    wrong(&sound[..1], "`played.npz` has no array `position`; it has `time`");
    wrong(
        &[times(&[0.0, 0.5, 0.5]), position.clone()],
        "`played.npz: time[2]` is 0.5, after 0.5; expected rising times",
    );
    wrong(
        &[times(&[0.0, f64::NAN, 0.5]), position.clone()],
        "`played.npz: time[1]` is NaN; expected a finite time (s)",
    );
    wrong(
        &[times(&[0.1, 0.5, 1.0]), position.clone()],
        "`played.npz: time[0]` is 0.1: the recording begins at 0.1 s; expected the start of the scene, 0 s",
    );
    wrong(
        &[doubles("time", "(2,)", &[0.0, 1.0]), position.clone()],
        "`played.npz: time` has the shape (2,); expected 3, one time for each moment of `position`",
    );
    let flat = doubles("position", "(3, 8)", &[0.0; 24]);
    wrong(
        &[sound[0].clone(), flat],
        "`played.npz: position` has the shape (3, 8); expected moments × nodes × 3, in the plane × 2",
    );
    let fewer = doubles("position", "(3, 3, 2)", &[0.0; 18]);
    wrong(&[sound[0].clone(), fewer.clone()], "`played.npz: position` has 3 nodes, and the bodies of the run have 4");
    let space = doubles("position", "(3, 4, 3)", &[0.5; 36]);
    wrong(
        &[sound[0].clone(), space],
        "`played.npz: position` leaves the plane of the scene; expected z = 0, or 2 coordinates",
    );
    let velocity = doubles("velocity", "(3, 3, 2)", &[0.0; 18]);
    wrong(
        &[&sound[..], &[velocity]].concat(),
        "`played.npz: velocity` has the shape (3, 3, 2); expected (3, 4, 2), as `position`",
    );
    wrong(
        &[&sound[..], &[doubles("step", "()", &[-1.0])]].concat(),
        "`played.npz: step` is -1; expected a time step (s) above 0",
    );
    wrong(&[&sound[..], &[doubles("rest", "(4, 2)", &REST)]].concat(), "`played.npz` has no array `elements`");
    wrong(
        &[&sound[..], &[doubles("mass", "(4,)", &[1.0; 4])]].concat(),
        "`played.npz: mass` belongs to a body, whose nodes at rest are missing",
    );
    let packed = archive(&sound, CompressionMethod::Deflated);
    wrong_bytes(&packed[..packed.len() - 400], "`played.npz` is a damaged NumPy archive, or is cut short");
    wrong_bytes(b"PK", "`played.npz` is a damaged NumPy archive, or is cut short");
    let runs = [
        doubles("a.position", "(1, 4, 2)", &REST),
        doubles("b.position", "(1, 4, 2)", &REST),
        doubles("time", "(1,)", &[0.0]),
    ];
    wrong(&runs, "`played.npz` has the runs \"a\" and \"b\"");
    let chosen = SCENE.replace("'played.npz'", "{ file = 'played.npz', run = 'c' }");
    let error = load(&chosen, &stored(&runs)).1.expect_err("an unknown run");
    assert!(error.to_string().contains("`played.npz` has no run \"c\""), "{error}");
    let chosen = SCENE.replace("'played.npz'", "{ file = 'played.npz', run = 'b' }");
    assert!(load(&chosen, &stored(&runs)).1.is_ok());
}

#[test]
fn arrays_that_are_not_read_are_told() {
    let warned = |name: &'static str| {
        let more = doubles(name, "(3, 4, 2)", &[0.0; 24]);
        let scene = load(SCENE, &stored(&[&swing(5.0, 0.5)[..], &[more]].concat())).1;
        let scene = scene.unwrap_or_else(|error| panic!("{error}"));
        scene.warnings.iter().fold(String::new(), |all, one| format!("{all}{}; {:?}", one.message, one.help))
    };
    assert_eq!(warned("velocity"), "");
    let message = warned("velocities");
    assert!(message.contains("`played.npz: velocities` is not an array of a recording, and is not read"), "{message}");
    assert!(message.contains("did you mean `velocity`?"), "{message}");
    // Of another run.
    assert_eq!(warned("other.velocities"), "");
}

/// Every block is read once, and its checksum compared.
#[test]
fn a_changed_number_is_found() {
    let mut bytes = stored(&swing(5.0, 0.5));
    let number = 1.0_f64.to_le_bytes();
    let at = bytes.windows(16).rposition(|two| two[8..] == number).expect("a coordinate");
    bytes[at + 8] ^= 1;
    wrong_bytes(&bytes, "`played.npz: position` cannot be read, the file is damaged or cut short (Invalid checksum)");
}

#[test]
fn energies_of_recordings_are_no_colours() {
    let scene = format!("{SCENE}[view]\ncolour = {{ by = 'elastic-energy' }}\n");
    let error = load(&scene, &stored(&swing(5.0, 0.5))).1.expect_err("no energies").to_string();
    assert!(error.contains("`view.colour.by` is \"elastic-energy\", which no run has"), "{error}");
}

#[test]
fn a_run_has_a_model_or_states() {
    let refused = |scene: &str, words: &str| {
        let error = load(scene, &stored(&swing(5.0, 0.5))).1.expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    };
    refused(&SCENE.replace("states = 'played.npz'", ""), "has neither `model`, `models` nor `states`; one is needed");
    refused(&format!("{SCENE}model = {{ kind = 'shape-based', stiffness = 1 }}"), "exclude each other");
    for key in ["step = 0.1", "tolerance = 1e-6", "integrator = 'velocity-verlet'", "kernel = 'reference'"] {
        refused(&format!("{SCENE}{key}"), "exclude each other");
    }
    refused(&SCENE.replace("played.npz", "plaid.npz"), "did you mean \"played.npz\"?");
    let time = "[time]\nstep = 0.1\nintegrator = 'dormand-prince'";
    // Steps of the scene are those of other runs.
    assert!(load(&SCENE.replace("[time]", &time.replace("step = 0.1\n", "")), &stored(&swing(5.0, 0.5))).1.is_ok());
}

/// A thrown cube in eleven moments, .1 s apart and with 1 s in file f, as NumPy writes it in other layouts.
#[test]
fn every_layout_of_numpy_has_the_same_moments() {
    let read = |bytes: &[u8], rate: f64| {
        let time = format!("time = {{ duration = {}, frames_per_second = {rate} }}", 10.0 / rate);
        let scene = format!(
            "{time}\nbody = {{ lattice = {{ cells = [1, 1, 1], side = 0.1 }} }}\n[[run]]\nname = 'R'\nstates = 'played.npz'"
        );
        let (_folder, scene) = load(&scene, bytes);
        let scene = scene.unwrap_or_else(|error| panic!("{error}"));
        assert!(scene.warnings.is_empty());
        let mut world = scene.world(0);
        let at = |count: i32| {
            world.advance_towards(Moment { count: count.into(), rate }, u64::MAX);
            world.state().position.clone()
        };
        (0..=10).flat_map(at).collect::<Vec<_>>()
    };
    let plain = read(include_bytes!("layouts/a.npz"), 10.0);
    assert_eq!(plain.len(), 88);
    let layouts: [(&str, &[u8], f64, f64); 9] = [
        ("Fortran order", include_bytes!("layouts/b.npz"), 10.0, 0.0),
        ("float32", include_bytes!("layouts/c.npz"), 10.0, 1e-7),
        ("big-endian", include_bytes!("layouts/d.npz"), 10.0, 0.0),
        ("big-endian float32 in Fortran order", include_bytes!("layouts/e.npz"), 10.0, 1e-7),
        ("times in int64", include_bytes!("layouts/f.npz"), 1.0, 0.0),
        ("elements in uint32, rest in float32", include_bytes!("layouts/g.npz"), 10.0, 0.0),
        ("Fortran order, reversed", include_bytes!("layouts/h.npz"), 10.0, 0.0),
        ("compressed", include_bytes!("layouts/x.npz"), 10.0, 0.0),
        ("times in float32", include_bytes!("layouts/z.npz"), 10.0, 2e-7),
    ];
    for (layout, bytes, rate, most) in layouts {
        let found = read(bytes, rate);
        let apart = found.iter().zip(&plain).map(|(found, plain)| found.distance(*plain)).fold(0.0, f64::max);
        assert!(found.len() == plain.len() && apart <= most, "{layout}: {apart:e}");
    }
    let objects = load(SCENE, include_bytes!("layouts/y.npz")).1.expect_err("objects").to_string();
    assert!(objects.contains("contains Python objects"), "{objects}");
}

/// Arrays of which single moments cannot be read are copied, unless they are too long.
#[test]
fn layouts_that_are_copied_have_a_limit() {
    for (bytes, is_copied) in [
        (&include_bytes!("layouts/a.npz")[..], false),
        (include_bytes!("layouts/b.npz"), true),
        (include_bytes!("layouts/x.npz"), true),
    ] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("played.npz"), bytes).unwrap();
        let space = SCENE.replace("[0, 0], [1, 0], [1, 1], [0, 1]", "[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 1]");
        let space = space.replace("[[0, 1, 2], [0, 2, 3]]", "[[0, 1, 2, 3]]");
        std::fs::write(folder.path().join("scene.toml"), space).unwrap();
        let loaded =
            |recorded| Scene::load(&folder.path().join("scene.toml"), &Limits { recorded, ..Limits::default() });
        loaded(88).unwrap_or_else(|error| panic!("{error}"));
        match loaded(87) {
            Err(error) if is_copied => expect(
                &error,
                0,
                "8:10 `played.npz` has 11 moments of 8 points; the limit is 87 points in all moments record fewer moments, or allow it with --allow-large",
            ),
            found => assert!(!is_copied && found.is_ok()),
        }
    }
}

/// Numbers of any type in either order of axes, packed or not: a square with whole coordinates.
#[test]
fn whole_numbers_are_positions_and_times() {
    let rows = [0, 0, 1, 0, 1, 1, 0, 1, 5, 0, 6, 0, 6, 1, 5, 1];
    let arrays = [indices("time", "(2,)", &[0, 1]), indices("position", "(2, 4, 2)", &rows)];
    // All moments of the first node's x, then of the second's, and so on.
    let columns: Vec<i64> =
        (0..8).flat_map(|at| [rows[(at % 4) * 2 + at / 4], rows[8 + (at % 4) * 2 + at / 4]]).collect();
    let mut turned = arrays.clone();
    turned[1] = indices("position", "(2, 4, 2)", &columns);
    turned[1].by_columns = true;
    for arrays in [arrays, turned] {
        for method in [CompressionMethod::Stored, CompressionMethod::Deflated] {
            let (_folder, scene) = load(SCENE, &archive(&arrays, method));
            let mut world = scene.unwrap_or_else(|error| panic!("{error}")).world(0);
            assert_eq!(world.state().position[2], DVec3::new(1.0, 1.0, 0.0));
            world.advance_towards(Moment::at(1.0), u64::MAX);
            assert_eq!(world.state().position[1..3], [DVec3::new(6.0, 0.0, 0.0), DVec3::new(6.0, 1.0, 0.0)]);
        }
    }
}

/// Programs with z up: (x, y, z) is (x, z, -y) in scenes, and velocities are turned and scaled like positions.
#[test]
fn recordings_are_put_upright_in_metres() {
    let corners = [0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0];
    let moved: Vec<f64> = corners.iter().enumerate().map(|(at, x)| x + [0.0, 0.0, 10.0][at % 3]).collect();
    let arrays = [
        doubles("time", "(2,)", &[0.0, 1.0]),
        doubles("position", "(2, 4, 3)", &[&corners[..], &moved].concat()),
        doubles("velocity", "(2, 4, 3)", &[0.0, 4.0, 10.0].repeat(8)),
        doubles("rest", "(4, 3)", &corners),
        indices("elements", "(1, 4)", &[0, 1, 2, 3]),
    ];
    let base =
        "time.duration = 1\nbody.lattice = { cells = [1, 1, 1], side = 1 }\nrun = [{ name = 'R', states = 'played.npz'";
    let shown = |keys: &str| {
        let (_folder, scene) = load(&format!("{base}{keys} }}]"), &stored(&arrays));
        let scene = scene.unwrap_or_else(|error| panic!("{error}"));
        let mut world = scene.world(0);
        world.advance_towards(Moment::at(1.0), u64::MAX);
        (scene.runs[0].body().rest().to_vec(), world.state().position.clone(), world.state().velocity[0], scene.digest)
    };
    let (rest, position, velocity, digest) = shown(", up = 'z', scale = 0.001");
    assert_eq!(rest, [[0.0; 3], [0.003, 0.0, 0.0], [0.0, 0.0, -0.002], [0.0, 0.001, 0.0]].map(DVec3::from));
    assert_eq!(position[3], DVec3::new(0.0, 0.011, 0.0));
    assert_eq!(velocity, DVec3::new(0.0, 0.01, -0.004));
    let (rest, position, velocity, other) = shown(", up = 'x'");
    assert_eq!((rest[1], position[0], velocity), (DVec3::Y * 3.0, DVec3::Z * 10.0, DVec3::new(-4.0, 0.0, 10.0)));
    assert_ne!(digest, other);
    let (rest, position, velocity, plain) = shown("");
    assert_eq!((rest[1], position[0], velocity), (DVec3::X * 3.0, DVec3::Z * 10.0, DVec3::new(0.0, 4.0, 10.0)));
    assert_eq!(shown(", up = 'y', scale = 1").3, plain, "the defaults");
    let refused = |text: &str, arrays: &[Array], words: &str| {
        let error = load(text, &stored(arrays)).1.expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    };
    let plane = SCENE.replace("states = ", "up = 'z'\nstates = ");
    refused(&plane, &swing(5.0, 0.5), "`run[0].up` is \"z\", but `played.npz` is in the plane");
    let model = SCENE.replace("states = 'played.npz'", "scale = 2\nmodel = { kind = 'shape-based', stiffness = 1 }");
    refused(&model, &swing(5.0, 0.5), "`run[0].scale` needs `states`");
    // With z up, a motion in the plane of x and z is one in the plane of the scene.
    let flat: Vec<f64> = REST.chunks(2).flat_map(|rest| [rest[0], 0.0, rest[1]]).collect();
    let arrays = [doubles("time", "(1,)", &[0.0]), doubles("position", "(1, 4, 3)", &flat)];
    let (_folder, scene) = load(&plane, &stored(&arrays));
    let state = scene.unwrap_or_else(|error| panic!("{error}")).world(0).state().clone();
    assert_eq!(state.position, REST.chunks(2).map(|rest| DVec3::new(rest[0], rest[1], 0.0)).collect::<Vec<_>>());
}

/// A recording of a square whose nodes are at `x`, at times, with a step.
fn at(times: &[f64], step: f64, x: &[f64]) -> Vec<Array> {
    let position: Vec<f64> =
        x.iter().flat_map(|x| REST.chunks(2).flat_map(move |rest| [rest[0] + x, rest[1]])).collect();
    let shape: &'static str = Box::leak(format!("({}, 4, 2)", times.len()).into_boxed_str());
    let time: &'static str = Box::leak(format!("({},)", times.len()).into_boxed_str());
    vec![doubles("time", time, times), doubles("position", shape, &position), doubles("step", "()", &[step])]
}

/// The first step without a state is the one after the last moment, also where a frame is exactly there.
#[test]
fn a_recording_ends_in_the_step_after_its_last_moment() {
    let (_folder, scene) = load(SCENE, &stored(&at(&[0.0, 0.5, 1.0], 0.5, &[0.0, 1.0, 2.0])));
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    for (steps, is_ended) in [(2, false), (3, true), (4, true)] {
        let mut world = scene.world(0);
        world.advance(steps);
        assert_eq!(world.status() != Status::Ok, is_ended, "{steps} steps");
        world.settle();
        assert_eq!(world.state().position[0].x, 2.0, "the last state");
    }
}

/// A world that is set back shows the recorded state again, not the one that was put in its place.
#[test]
fn a_recording_that_starts_again_shows_its_moment() {
    let (_folder, scene) = load(SCENE, &stored(&at(&[0.0, 0.5, 1.0], 0.5, &[0.0, 1.0, 2.0])));
    let mut world = scene.unwrap_or_else(|error| panic!("{error}")).world(0);
    world.advance(1);
    world.settle();
    assert_eq!(world.state().position[0].x, 1.0);
    let mut other = world.state().clone();
    other.position.iter_mut().for_each(|node| node.x += 70.0);
    world.set_state(other);
    world.settle();
    assert_eq!(world.state().position[0].x, 1.0);
}

/// The slope of a parabola through three moments at unequal times is its own: t² at 0, .1 and .4 s.
#[test]
fn velocities_at_unequal_times_have_the_right_weights() {
    let times: [f64; 3] = [0.0, 0.1, 0.4];
    let scene = SCENE.replace("duration = 1", "duration = 0.4");
    let (_folder, scene) = load(&scene, &stored(&at(&times, 0.1, &times.map(|time| time * time))));
    let mut world = scene.unwrap_or_else(|error| panic!("{error}")).world(0);
    world.advance(1);
    world.settle();
    let velocity = world.state().velocity[0].x;
    assert!((velocity - 0.2).abs() < 1e-12, "{velocity}");
}

/// 3 · .1 s is one round-off after .3 s, and 1 · .3 s one before 3 · .1 s.
#[test]
fn a_moment_one_round_off_away_is_that_moment() {
    for (moment, step, steps) in [(0.3, 0.1, 3_u32), (0.1 * 3.0, 0.3, 1)] {
        let (_folder, scene) = load(SCENE, &stored(&at(&[0.0, moment, 1.0], step, &[-1e12, 1.0, 1e12])));
        let mut world = scene.unwrap_or_else(|error| panic!("{error}")).world(0);
        assert_ne!(step * f64::from(steps), moment);
        world.advance(steps.into());
        world.settle();
        assert_eq!(world.state().position[0].x, 1.0, "{moment:?}");
    }
}

/// Loads a scene in space with this body, and a run that shows a sequence of files beside it.
fn load_sequence(files: &[(&str, &[u8])], body: &str, states: &str, limits: &Limits) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    files.iter().for_each(|(name, bytes)| std::fs::write(folder.path().join(name), bytes).unwrap());
    let time = "[time]\nduration = 1\nframes_per_second = 10\n";
    let run = format!("[[run]]\nname = 'Played'\nstates = '{states}'\n");
    std::fs::write(folder.path().join("scene.toml"), format!("{time}{run}[body]\n{body}\n")).unwrap();
    Scene::load(&folder.path().join("scene.toml"), limits)
}

/// The scene of a sequence that is not of its body.
fn of_sequence(files: &[(&str, &[u8])], states: &str) -> Scene {
    const BLOCK: &str = "lattice = { cells = [1, 1, 1], side = 0.1 }";
    load_sequence(files, BLOCK, states, &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Cells in VTK's order, along axes and turned over; lines, faces and points of none; hulls.
#[test]
fn a_moment_has_the_elements_of_the_same_file_as_a_mesh() {
    let cells = include_bytes!("../../mesh/tests/files/cells-base64.vtu");
    let hulls = include_bytes!("../../mesh/tests/files/hulls.vtu");
    for (bytes, warnings) in [(&cells[..], 1), (&hulls[..], 0)] {
        let files = [("cells.vtu", bytes), ("cells_7.vtu", bytes)];
        let body = "mesh = 'cells.vtu'\nup = 'y'\ndensity = 1";
        let with_mesh = load_sequence(&files, body, "cells_*.vtu", &Limits::default());
        let with_mesh = with_mesh.unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(with_mesh.runs[0].of, [0], "the body of the scene");
        let mesh = with_mesh.runs[0].body();
        let alone = of_sequence(&files, "cells_*.vtu");
        assert_eq!(alone.runs[0].of, [1], "a body of its own");
        let own = alone.runs[0].body();
        assert_eq!((own.rest(), own.elements(), own.kinds()), (mesh.rest(), mesh.elements(), mesh.kinds()));
        for scene in [&with_mesh, &alone] {
            assert_eq!(scene.world(0).state().position, mesh.rest());
            let is_turned = |message: &str| message.contains("turned inside out, and are turned over");
            assert_eq!(scene.warnings.iter().filter(|one| is_turned(&one.message)).count(), warnings);
        }
    }
}

/// A tetrahedron, or a hull of four points, moved along x, as a grid.
fn tetrahedron(kind: u8, x: f64) -> Vec<u8> {
    let (y, z) = (x + 1.0, x);
    let array = |kind: &str, name: &str, more: &str, numbers: &str| {
        format!("<DataArray type='{kind}' Name='{name}' {more} format='ascii'>{numbers}</DataArray>")
    };
    let points = array("Float64", "Points", "NumberOfComponents='3'", &format!("{x} 0 0 {y} 0 0 {z} 1 0 {z} 0 1"));
    let lists =
        [("Int64", "connectivity", "0 1 2 3"), ("Int64", "offsets", "4"), ("UInt8", "types", &kind.to_string())];
    let lists = lists.map(|(kind, name, numbers)| array(kind, name, "", numbers)).concat();
    format!(
        "<VTKFile type='UnstructuredGrid' version='1.0' byte_order='LittleEndian'><UnstructuredGrid>\
         <Piece NumberOfPoints='4' NumberOfCells='1'><Points>{points}</Points><Cells>{lists}</Cells></Piece>\
         </UnstructuredGrid></VTKFile>"
    )
    .into_bytes()
}

/// A list of grids: times, files and parts.
fn list(sets: &[(f64, &str, &str)]) -> Vec<u8> {
    let set = |(time, file, part): &(f64, &str, &str)| format!("<DataSet timestep='{time}' file='{file}' {part}/>");
    let sets: String = sets.iter().map(set).collect();
    format!("<VTKFile type='Collection'><Collection>{sets}</Collection></VTKFile>").into_bytes()
}

#[test]
fn the_kinds_of_cells_are_in_the_digest() {
    let [tetrahedron, hull] = [10, 41].map(|kind| of_sequence(&[("m_0.vtu", &tetrahedron(kind, 0.0))], "m_*.vtu"));
    assert_eq!(tetrahedron.world(0).state().position, hull.world(0).state().position);
    assert_ne!(tetrahedron.digest, hull.digest);
}

#[test]
fn files_of_one_time_are_bodies_of_a_moment_or_the_same_state() {
    let (a, b) = (tetrahedron(10, 0.0), tetrahedron(10, 3.0));
    let load = |sets: &[(f64, &str, &str)]| {
        let files = [("a.vtu", &a[..]), ("b.vtu", &b[..]), ("list.pvd", &list(sets)[..])];
        let body = "lattice = { cells = [1, 1, 1], side = 0.1 }";
        load_sequence(&files, body, "list.pvd", &Limits::default())
    };
    let sound = |sets: &[(f64, &str, &str)]| load(sets).unwrap_or_else(|error| panic!("{error}"));
    for parts in [["", ""], ["part='0'", "part='1'"]] {
        let scene = sound(&[(0.0, "a.vtu", parts[0]), (0.0, "b.vtu", parts[1])]);
        assert_eq!((scene.runs[0].body().len(), scene.runs[0].body().elements().len()), (8, 2));
        assert_eq!(scene.runs[0].recording.as_ref().unwrap().moments(), 1);
    }
    // Frames nearer than a time step.
    for part in ["", "part='0'"] {
        let scene = sound(&[(0.0, "a.vtu", part), (0.5, "b.vtu", part), (0.5, "b.vtu", part), (1.0, "a.vtu", part)]);
        let mut world = scene.world(0);
        world.advance_towards(Moment::at(0.5), u64::MAX);
        assert_eq!(world.state().position[0], DVec3::X * 3.0);
        assert_eq!(world.state().velocity[0], DVec3::ZERO, "the mean of both sides");
    }
    let error = load(&[(0.0, "a.vtu", "part='0'"), (0.0, "b.vtu", "part='0'")]).expect_err("two states");
    expect(
        &error,
        0,
        "6:10 `list.pvd: b.vtu` is at 0 s in another state than a.vtu; expected rising times if they are bodies of one moment, list them in a .pvd file with a `part` each",
    );
}

#[test]
fn moments_are_bounded_before_they_are_copied() {
    let grids = [0.0, 1.0].map(|x| tetrahedron(10, x));
    let files = [("m_0.vtu", &grids[0][..]), ("m_1.vtu", &grids[1][..])];
    let load = |recorded| {
        let body = "lattice = { cells = [1, 1, 1], side = 0.1 }";
        load_sequence(&files, body, "m_*.vtu", &Limits { recorded, ..Limits::default() })
    };
    let recording = load(8).unwrap_or_else(|error| panic!("{error}")).runs[0].recording.clone().expect("a recording");
    assert!(recording.path.ends_with("m_*.vtu"), "{:?}: the file as typed", recording.path);
    let error = load(7).expect_err("too many");
    expect(
        &error,
        0,
        "6:10 `m_*.vtu` has 2 moments of 4 points; the limit is 7 points in all moments record fewer moments, or allow it with --allow-large",
    );
}

/// A tetrahedron as a surface, moved along x.
fn surface(format: &str, x: f64) -> Vec<u8> {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|[a, b, c]| [a + x, b, c]);
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let row = |point: [f64; 3]| point.map(|number| number.to_string()).join(" ");
    let text = match format {
        "obj" => {
            let points = points.map(|point| format!("v {}\n", row(point))).concat();
            points + &faces.map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1)).concat()
        }
        "ply" => {
            let head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n\
                        element face 4\nproperty list uchar int vertex_indices\nend_header\n";
            let points = points.map(|point| row(point) + "\n").concat();
            format!("{head}{points}{}", faces.map(|[a, b, c]| format!("3 {a} {b} {c}\n")).concat())
        }
        _ => {
            let corner = |at: usize| format!("vertex {}\n", row(points[at]));
            let facet = |face: [usize; 3]| {
                format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", face.map(corner).concat())
            };
            format!("solid t\n{}endsolid t\n", faces.map(facet).concat())
        }
    };
    text.into_bytes()
}

/// The x of the first node at each of the frames, which are .1 s apart.
fn course(scene: &Scene, frames: u32) -> Vec<f64> {
    let mut world = scene.world(0);
    let at = |frame: u32| {
        world.advance_towards(Moment { count: frame.into(), rate: 10.0 }, u64::MAX);
        (world.state().position[0].x * 1e6).round() / 1e6
    };
    (0..frames).map(at).collect()
}

#[test]
fn surfaces_of_every_format_and_negative_numbers_are_sequences() {
    for format in ["obj", "ply", "stl"] {
        let files: Vec<_> = (-2..=2).map(|at| (format!("f{at}.{format}"), surface(format, f64::from(at)))).collect();
        let files: Vec<_> = files.iter().map(|(name, bytes)| (name.as_str(), &bytes[..])).collect();
        let scene = of_sequence(&files, &format!("f*.{format}"));
        assert_eq!(course(&scene, 5), [-2.0, -1.0, 0.0, 1.0, 2.0], "{format}");
        assert_eq!(scene.runs[0].body().elements().len(), 4, "{format}");
        assert!(scene.warnings.is_empty());
        // Without a zero in between, a hyphen stands before the numbers of another sequence.
        let two: Vec<_> = files.iter().filter(|(name, _)| !name.contains('0')).copied().collect();
        let error = load_sequence(
            &two,
            "lattice = { cells = [1, 1, 1], side = 1 }",
            &format!("f*.{format}"),
            &Limits::default(),
        );
        let error = error.expect_err("two sequences").to_string();
        assert!(error.contains("has several sequences, f-… and f…; expected one"), "{error}");
        let only: Vec<_> = two.iter().filter(|(name, _)| name.contains('-')).copied().collect();
        assert_eq!(course(&of_sequence(&only, &format!("f*.{format}")), 2), [-1.0, -2.0], "a hyphen before 1 and 2");
    }
}

/// Sorted by the digits behind the point, 0.5 would come before 0.25.
#[test]
fn times_in_names_are_no_numbers_of_files() {
    let of = |names: [&str; 3], pattern: &str| {
        let files: Vec<_> = names.iter().zip([0.0, 1.0, 2.0]).map(|(name, x)| (*name, surface("obj", x))).collect();
        let files: Vec<_> = files.iter().map(|(name, bytes)| (*name, &bytes[..])).collect();
        load_sequence(&files, "lattice = { cells = [1, 1, 1], side = 1 }", pattern, &Limits::default())
    };
    let wrong = |names: [&str; 3], pattern: &str| {
        let error = of(names, pattern).expect_err("times").to_string();
        assert!(error.contains("has numbers that are not whole, such as that of t_"), "{error}");
        assert!(error.contains("number the files in their order, or list them with their times in a .pvd"), "{error}");
    };
    for pattern in ["t_*.obj", "t_0.*.obj"] {
        wrong(["t_0.25.obj", "t_0.5.obj", "t_0.75.obj"], pattern);
    }
    for names in [
        ["t_0,25.obj", "t_0,5.obj", "t_0,75.obj"],
        ["t_0p25.obj", "t_0p5.obj", "t_0p75.obj"],
        ["t_0.25.obj", "t_0.50.obj", "t_0.75.obj"],
        ["t_0.75.obj", "t_1.0.obj", "t_1.25.obj"],
        ["t_1e-3.obj", "t_2e-3.obj", "t_1e-2.obj"],
    ] {
        wrong(names, "t_*.obj");
    }
    for names in [
        ["t_v2.8.obj", "t_v2.9.obj", "t_v2.10.obj"],
        ["t_1.0001.obj", "t_1.0002.obj", "t_1.0003.obj"],
        ["step8.obj", "step9.obj", "step10.obj"],
    ] {
        let scene = of(names, &format!("{}*.obj", &names[0][..2])).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(course(&scene, 3), [0.0, 1.0, 2.0], "{names:?}");
    }
}

/// The cells of `.mesh` and `.inp` files are elements, not surfaces.
#[test]
fn sequences_of_cells_of_medit_and_abaqus_are_bodies_of_cells() {
    let medit = |x: f64| {
        format!(
            "MeshVersionFormatted 2\nDimension 3\nVertices 4\n{x} 0 0 0\n{} 0 0 0\n{x} 1 0 0\n{x} 0 1 0\n\
             Tetrahedra 1\n1 2 3 4 0\nEnd\n",
            x + 1.0
        )
    };
    let abaqus = |x: f64| {
        format!(
            "*NODE\n1, {x}, 0, 0\n2, {}, 0, 0\n3, {x}, 1, 0\n4, {x}, 0, 1\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n",
            x + 1.0
        )
    };
    for (ending, of) in [("mesh", &medit as &dyn Fn(f64) -> String), ("inp", &abaqus)] {
        let [first, second] = [0.0, 1.0].map(of);
        let names = [0, 1].map(|at| format!("m{at}.{ending}"));
        let files = [(names[0].as_str(), first.as_bytes()), (names[1].as_str(), second.as_bytes())];
        let scene = of_sequence(&files, &format!("m*.{ending}"));
        let elements = &scene.runs[0].body().elements();
        assert_eq!((elements.len(), elements[0].len(), course(&scene, 2)), (1, 4, vec![0.0, 1.0]), "{ending}");
    }
}

/// The triangles of STL files have corners of their own: two tetrahedra that touch at the start, or later, are the same bodies.
#[test]
fn corners_of_stl_files_are_joined_as_at_the_start() {
    let facets = |x: f64| {
        let [one, other] = [0.0, x].map(|x| String::from_utf8(surface("stl", x)).unwrap());
        (one + &other).into_bytes()
    };
    // The second has its first corner where the first has its second at 1 m.
    let (apart, touching) = (facets(2.0), facets(1.0));
    let scene = of_sequence(&[("a0.stl", &apart[..]), ("a1.stl", &touching)], "a*.stl");
    assert_eq!(scene.runs[0].body().len(), 8);
    let body = "lattice = { cells = [1, 1, 1], side = 1 }";
    let torn = load_sequence(&[("a0.stl", &touching[..]), ("a1.stl", &apart)], body, "a*.stl", &Limits::default());
    let torn = torn.expect_err("torn").to_string();
    assert!(torn.contains("`a*.stl: a1.stl` has corners apart that are at one place in a0.stl"), "{torn}");
}

/// Point data of a tetrahedron at rest.
fn with_data(name: &str, components: usize, x: f64) -> Vec<u8> {
    let numbers = std::iter::repeat_n(x.to_string() + &" 0".repeat(components - 1), 4).collect::<Vec<_>>().join(" ");
    let data = format!(
        "<PointData><DataArray type='Float64' Name='{name}' NumberOfComponents='{components}' format='ascii'>{numbers}\
         </DataArray></PointData><Points>"
    );
    String::from_utf8(tetrahedron(10, 0.0)).unwrap().replace("<Points>", &data).into_bytes()
}

#[test]
fn displacements_of_points_at_rest_are_added_and_told() {
    let warnings = |scene: &Scene| scene.warnings.iter().map(|one| one.message.clone()).collect::<Vec<_>>().join("\n");
    let of = |name: &str, components: usize| {
        let files: Vec<_> = (0..3).map(|at| with_data(name, components, 0.5 * f64::from(at))).collect();
        of_sequence(&[("m0.vtu", &files[0]), ("m1.vtu", &files[1]), ("m2.vtu", &files[2])], "m*.vtu")
    };
    for (name, components) in
        [("displacement", 3), ("Displacement", 3), ("DISPLACEMENT", 3), ("U", 3), ("u", 3), ("displacement", 2)]
    {
        let scene = of(name, components);
        assert_eq!(course(&scene, 3), [0.0, 0.5, 1.0], "{name}");
        assert_eq!(scene.runs[0].body().rest()[0], DVec3::ZERO, "the shape at rest");
        let told = "`m*.vtu` has points that do not move, to which their array `displacement` or `U` is added";
        assert_eq!(warnings(&scene), told);
    }
    // Points that are written anew with single precision are at rest, too.
    let files = [0.0, 1e-7, 3e-7].map(|by| {
        let text = String::from_utf8(with_data("U", 3, 1e6 * by)).unwrap();
        text.replace("'3' format='ascii'>0 0 0 1", &format!("'3' format='ascii'>{by} 0 0 1")).into_bytes()
    });
    let scene = of_sequence(&[("m0.vtu", &files[0]), ("m1.vtu", &files[1]), ("m2.vtu", &files[2])], "m*.vtu");
    assert!(course(&scene, 3)[2] > 0.29 && warnings(&scene).contains("to which their array"), "{}", warnings(&scene));
    // A tool that has no displacements beside a body that has them.
    let (one, other, tool) = (with_data("U", 3, 0.0), with_data("U", 3, 0.5), tetrahedron(10, 7.0));
    let parts = [
        (0.0, "a.vtu", "part='0'"),
        (0.0, "t.vtu", "part='1'"),
        (0.1, "b.vtu", "part='0'"),
        (0.1, "t.vtu", "part='1'"),
    ];
    let files = [("a.vtu", &one[..]), ("b.vtu", &other), ("t.vtu", &tool), ("l.pvd", &list(&parts))];
    let scene = of_sequence(&files, "l.pvd");
    assert_eq!(course(&scene, 2), [0.0, 0.5]);
    assert!(warnings(&scene).contains("is added; t.vtu has none"), "{}", warnings(&scene));
    // Nor do moves of the tool matter; but all files of a body have the array.
    let moved = tetrahedron(10, 8.0);
    let parts = [
        (0.0, "a.vtu", "part='0'"),
        (0.0, "t.vtu", "part='1'"),
        (0.1, "b.vtu", "part='0'"),
        (0.1, "u.vtu", "part='1'"),
    ];
    let at = |b: &[u8]| {
        let files = [("a.vtu", &one[..]), ("b.vtu", b), ("t.vtu", &tool), ("u.vtu", &moved), ("l.pvd", &list(&parts))];
        load_sequence(&files, "lattice = { cells = [1, 1, 1], side = 1 }", "l.pvd", &Limits::default())
    };
    assert_eq!(course(&at(&other).unwrap_or_else(|error| panic!("{error}")), 2), [0.0, 0.5]);
    let error = at(&tetrahedron(10, 0.0)).expect_err("no array").to_string();
    assert!(error.contains("b.vtu` has no `displacement` for each point, and files of other moments have"), "{error}");
    // A body of millimetres.
    let long = String::from_utf8(tetrahedron(10, 0.0))
        .unwrap()
        .replace("0 0 0 1 0 0 0 1 0 0 0 1", "0 0 0 90 0 0 0 90 0 0 0 90");
    let scene = of_sequence(&[("m0.vtu", long.as_bytes())], "m*.vtu");
    assert!(warnings(&scene).ends_with("is 90 m long, as no `scale` is given"), "{}", warnings(&scene));
    // What cannot be applied is told.
    for scene in [of("temperature", 1), of("u", 1)] {
        assert_eq!(course(&scene, 3), [0.0; 3]);
        assert_eq!(warnings(&scene), "`m*.vtu` does not move: its 3 moments have the same points");
    }
    // Points that move have been displaced already.
    let moved = |x: f64| {
        String::from_utf8(with_data("U", 3, x))
            .unwrap()
            .replace("'3' format='ascii'>0 0 0 1", &format!("'3' format='ascii'>{x} 0 0 1"))
    };
    let files = [moved(0.0), moved(0.25)];
    let scene = of_sequence(&[("m0.vtu", files[0].as_bytes()), ("m1.vtu", files[1].as_bytes())], "m*.vtu");
    assert_eq!((course(&scene, 2), warnings(&scene)), (vec![0.0, 0.25], String::new()));
    let one = of_sequence(&[("m0.vtu", &with_data("U", 3, 1.0))], "m*.vtu");
    assert_eq!(warnings(&one), "`m*.vtu` has one moment, to whose points its array `displacement` or `U` is not added");
}

/// Surfaces have no density, and nothing tells their masses.
#[test]
fn a_sequence_beside_a_simulated_run_is_told_to_have_no_masses() {
    let files: Vec<_> = (0..2).map(|at| (format!("f{at}.obj"), surface("obj", f64::from(at)))).collect();
    let simulated = "[[run]]\nname = 'S'\nmodel = { kind = 'shape-based', stiffness = 1e4 }\n";
    for (other, told) in [("", 0), (simulated, 1)] {
        let scene = format!(
            "{other}[[run]]\nname = 'R'\nstates = 'f*.obj'\n[time]\nduration = 1\n\
             [body]\nlattice = {{ cells = [1, 1, 1], side = 0.1 }}\n"
        );
        let folder = tempfile::tempdir().unwrap();
        files.iter().for_each(|(name, bytes)| std::fs::write(folder.path().join(name), bytes).unwrap());
        std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
        let scene = Scene::load(&folder.path().join("scene.toml"), &Limits::default()).unwrap();
        let is_told =
            |message: &str| message.starts_with("`f*.obj` has no masses: energies and momenta count each of its ");
        assert_eq!(scene.warnings.iter().filter(|one| is_told(&one.message)).count(), told, "{:?}", scene.warnings);
    }
}

/// Lists in any order; those of runs that were started again; with paths of Windows; of pieces; and in JSON.
#[test]
fn lists_of_other_programs_are_read() {
    let [a, b, c] = [0.0, 1.0, 2.0].map(|x| tetrahedron(10, x));
    let load = |states: &str, bytes: &[u8]| {
        let files =
            [("a.vtu", &a[..]), ("b.vtu", &b[..]), ("c.vtu", &c[..]), ("two.pvtu", PIECES.as_bytes()), (states, bytes)];
        of_sequence(&files, states)
    };
    let unsorted = load("l.pvd", &list(&[(0.0, "a.vtu", ""), (0.2, "c.vtu", ""), (0.1, "b.vtu", "")]));
    assert_eq!((course(&unsorted, 3), unsorted.warnings.len()), (vec![0.0, 1.0, 2.0], 0));
    // Each body over all times, one after another.
    let sets = [
        (0.0, "a.vtu", "part='0'"),
        (0.1, "b.vtu", "part='0'"),
        (0.0, "b.vtu", "part='1'"),
        (0.1, "c.vtu", "part='1'"),
    ];
    let bodies = load("l.pvd", &list(&sets));
    assert_eq!((bodies.runs[0].body().len(), bodies.warnings.len()), (8, 0));
    assert_eq!(course(&bodies, 2), [0.0, 1.0]);
    // So too with one part for all, where each time has as many files.
    let sets = [(0.0, "a.vtu"), (0.1, "b.vtu"), (0.0, "b.vtu"), (0.1, "c.vtu")];
    let bodies = load("l.pvd", &list(&sets.map(|(time, file)| (time, file, "part='0'"))));
    assert_eq!((bodies.runs[0].body().len(), course(&bodies, 2)), (8, vec![0.0, 1.0]));
    let told = "`l.pvd` has one `part` for several files of each time, which are taken as bodies of one moment";
    assert_eq!(bodies.warnings.iter().map(|told| &*told.message).collect::<Vec<_>>(), [told]);
    // Started again at .1 s after .3 s: what was at .1 and .3 s is of the first start.
    let sets = [(0.0, "a.vtu"), (0.1, "c.vtu"), (0.3, "c.vtu"), (0.1, "b.vtu"), (0.2, "c.vtu"), (0.4, "a.vtu")];
    let again = load("l.pvd", &list(&sets.map(|(time, file)| (time, file, "part='0'"))));
    assert_eq!(course(&again, 5), [0.0, 1.0, 2.0, 1.0, 0.0], "linear between .2 and .4 s");
    let told =
        "`l.pvd` has the time 0.1 s again after later ones: 2 moments are left out, which a later start replaces";
    assert_eq!(again.warnings.iter().map(|one| one.message.as_str()).collect::<Vec<_>>(), [told]);
    let windows = load("l.pvd", &list(&[(0.0, ".\\a.vtu", ""), (0.1, ".\\b.vtu", "")]));
    assert_eq!(course(&windows, 2), [0.0, 1.0]);
    let pieces = load("l.pvd", &list(&[(0.0, "two.pvtu", ""), (0.1, "two.pvtu", "")]));
    assert_eq!((pieces.runs[0].body().len(), pieces.runs[0].body().elements().len()), (8, 2));
    let series = r#"{ "file-series-version": "1.0", "files": [{ "name": "a.vtu", "time": 0 }, { "name": "c.vtu", "time": 0.2 }] }"#;
    assert_eq!(course(&load("l.vtu.series", series.as_bytes()), 3), [0.0, 1.0, 2.0]);
}

/// Two pieces of a grid.
const PIECES: &str = "<VTKFile type='PUnstructuredGrid'><PUnstructuredGrid><PPoints/><Piece Source='a.vtu'/>\
                      <Piece Source='c.vtu'/></PUnstructuredGrid></VTKFile>";

#[test]
fn damaged_lists_are_told() {
    let refused = |file: &str, states: &str, text: &str, words: &str| {
        let grid = tetrahedron(10, 0.0);
        let files = [("a.vtu", &grid[..]), (file, text.as_bytes())];
        let error = load_sequence(&files, "lattice = { cells = [1, 1, 1], side = 1 }", states, &Limits::default());
        let error = error.expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    };
    let series = |text: &str, words: &str| refused("l.vtu.series", "l.vtu.series", text, words);
    series("", "`l.vtu.series` is no list of files over time: EOF");
    series(r#"{ "files": [] }"#, "`l.vtu.series` lists no file; expected { \"files\"");
    series("{ \"files\": [\n{ \"name\": \"a.vtu\" }] }", "missing field `time` at line 2");
    series(r#"{ "files": [{ "name": "b.vtu", "time": 0 }] }"#, "`l.vtu.series: b.vtu` is not there");
    let pieces = |text: &str, words: &str| refused("p0.pvtu", "p*.pvtu", text, words);
    pieces("<VTKFile type='PUnstructuredGrid'/>", "`p*.pvtu: p0.pvtu` names no file: it has no `<Piece>`");
    pieces("<VTKFile type='PUnstructuredGrid'><Piece/></VTKFile>", "has a `<Piece>` without `Source` in line 1");
    pieces("<VTKFile type='PImageData'/>", "of the type `PImageData`; expected `PUnstructuredGrid` or `PPolyData`");
    pieces("<VTKFile type='PPolyData'><Piece Source='b.vtp'/></VTKFile>", "`p*.pvtu: b.vtp` is not there");
    let windows = "<VTKFile type='Collection'><DataSet timestep='0' file='x\\a.vtu'/></VTKFile>";
    refused("l.pvd", "l.pvd", windows, "x/a.vtu)");
    refused("b.obj", "b.obj", "v 0 0 0", "`b.obj` is a file of one moment");
    refused(
        "a0.toml",
        "a*.toml",
        "",
        "`a*.toml: a0.toml` is neither a grid (.vtu, .vtp, .pvtu, .vtk, .msh, .inp, .mesh) nor a surface",
    );
}

/// A body of a recording has no key `convex`, so that the order of nodes is the only remedy.
#[test]
fn an_element_of_a_recording_that_is_inside_out() {
    let nodes = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [1., 1., 1.]].concat();
    let of = |elements: [i64; 8]| {
        stored(&[
            doubles("time", "(2,)", &[0.0, 1.0]),
            doubles("position", "(2, 5, 3)", &nodes.repeat(2)),
            doubles("rest", "(5, 3)", &nodes),
            indices("elements", "(2, 4)", &elements),
        ])
    };
    let scene = SCENE.replace(
        "nodes = [[0, 0], [1, 0], [1, 1], [0, 1]]\nelements = [[0, 1, 2], [0, 2, 3]]",
        "lattice = { cells = [1, 1, 1], side = 1 }",
    );
    let (_folder, right) = load(&scene, &of([0, 1, 2, 3, 1, 2, 3, 4]));
    let (_folder, wrong) = load(&scene, &of([0, 2, 1, 3, 1, 3, 2, 4]));
    right.unwrap_or_else(|error| panic!("{error}"));
    let help = wrong.unwrap_err().mistakes()[0].help.clone();
    assert_eq!(help.as_deref(), Some("take the nodes of each in the order [0, 2, 1, 3] for tetrahedra"));
}
