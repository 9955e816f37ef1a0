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
        assert_eq!((&own.rest, &own.elements, &own.kinds), (&mesh.rest, &mesh.elements, &mesh.kinds));
        for scene in [&with_mesh, &alone] {
            assert_eq!(scene.world(0).state().position, mesh.rest);
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
        assert_eq!((scene.runs[0].body().len(), scene.runs[0].body().elements.len()), (8, 2));
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
        "6:10 `m_*.vtu` has 2 moments of 4 points; the limit is 7 points in all moments list fewer moments, or allow it with --allow-large",
    );
}
