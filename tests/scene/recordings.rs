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

fn load(scene: &str, bytes: &[u8]) -> (tempfile::TempDir, Result<Scene, SceneError>) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("played.npz"), bytes).unwrap();
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let scene = Scene::load(&folder.path().join("scene.toml"), &Limits::default());
    (folder, scene)
}

fn stored(arrays: &[Array]) -> Vec<u8> {
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
    assert_eq!((scene.runs[0].body().elements.len(), scene.runs[0].body().mass[0]), (1, 2.0));
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
    wrong(
        &[sound[0].clone(), indices("position", "(3, 4, 2)", &[0; 24])],
        "`played.npz: position` is int64; expected float64 or float32",
    );
    let mut by_columns = position.clone();
    by_columns.by_columns = true;
    wrong(
        &[sound[0].clone(), by_columns],
        "`played.npz: position` is stored column by column; expected rows, as by numpy.ascontiguousarray",
    );
    wrong_bytes(
        &archive(&sound, CompressionMethod::Deflated),
        "`played.npz: position` is compressed; expected an archive of numpy.savez, of which single moments can be read",
    );
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
