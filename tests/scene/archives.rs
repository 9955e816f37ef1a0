//! Bodies in a NumPy archive beside the scene.

use super::expect;
use glam::DVec3;
use localshape::scene::{Limits, Scene, SceneError, description};
use localshape::sim::ElementKind;
use std::io::Write;
use std::path::{Path, PathBuf};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// One array in an archive.
#[derive(Clone)]
pub(super) struct Array {
    name: &'static str,
    descr: String,
    shape: String,
    pub(super) bytes: Vec<u8>,
    pub(super) by_columns: bool,
}

pub(super) fn doubles(name: &'static str, shape: &str, numbers: &[f64]) -> Array {
    let bytes = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    Array { name, descr: "'<f8'".into(), shape: shape.into(), bytes, by_columns: false }
}

pub(super) fn indices(name: &'static str, shape: &str, numbers: &[i64]) -> Array {
    let bytes = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    Array { name, descr: "'<i8'".into(), shape: shape.into(), bytes, by_columns: false }
}

impl Array {
    fn file(&self) -> Vec<u8> {
        let order = if self.by_columns { "True" } else { "False" };
        let head = format!("{{'descr': {}, 'fortran_order': {order}, 'shape': {}, }}\n", self.descr, self.shape);
        let mut file = b"\x93NUMPY\x01\x00".to_vec();
        file.extend((head.len() as u16).to_le_bytes());
        file.extend(head.bytes());
        file.extend(&self.bytes);
        file
    }
}

pub(super) fn archive(arrays: &[Array], method: CompressionMethod) -> Vec<u8> {
    let mut zip = ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for array in arrays {
        zip.start_file(format!("{}.npy", array.name), SimpleFileOptions::default().compression_method(method)).unwrap();
        zip.write_all(&array.file()).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

/// A unit square of two triangles.
fn square() -> Vec<Array> {
    vec![
        doubles("nodes", "(4, 2)", &[0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0]),
        indices("elements", "(2, 3)", &[0, 1, 2, 0, 2, 3]),
    ]
}

const SCENE: &str = "\
[time]
duration = 1
[body]
file = 'body.npz'
[[run]]
name = 'Local shape'
model = { kind = 'shape-based', stiffness = 1e4 }
[[run]]
name = 'Mass-spring'
model = { kind = 'mass-spring', stiffness = 1e4 }
";

/// Writes a new file, as overwriting waits for the disk.
fn put(path: &Path, bytes: &[u8]) {
    let _ = std::fs::remove_file(path);
    std::fs::write(path, bytes).unwrap();
}

/// A folder with a scene and its body.
struct Place(tempfile::TempDir);

impl Place {
    fn new(body: &[u8]) -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        place.put_body(body);
        place
    }

    fn put_body(&self, bytes: &[u8]) {
        put(&self.path().with_file_name("body.npz"), bytes);
    }

    fn path(&self) -> PathBuf {
        self.0.path().join("scene.toml")
    }

    fn load(&self, scene: &str, limits: &Limits) -> Result<Scene, SceneError> {
        put(&self.path(), scene.as_bytes());
        Scene::load(&self.path(), limits)
    }
}

#[track_caller]
fn good(body: &[u8], scene: &str) -> Scene {
    Place::new(body).load(scene, &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Expects exactly these mistakes, all at the name of the file.
#[track_caller]
fn wrong(body: &[u8], expected: &[&str]) {
    let error = Place::new(body).load(SCENE, &Limits::default()).expect_err(&format!("{expected:?}"));
    expect(&error, 0, &expected.iter().map(|words| format!("4:8 {words}\n")).collect::<String>());
}

fn with(change: impl Fn(&mut Vec<Array>)) -> Vec<u8> {
    let mut arrays = square();
    change(&mut arrays);
    archive(&arrays, CompressionMethod::Stored)
}

/// Written by NumPy 2.4 with `savez` and `savez_compressed`: a cube and a pyramid of -1-padded rows in int64, springs in
/// int32, faces in int16, positions in Fortran order, velocities in float32, masses in float64.
const BY_NUMPY: [&[u8]; 2] = [include_bytes!("numpy.npz"), include_bytes!("numpy_compressed.npz")];

#[test]
fn archives_written_by_numpy_are_read_compressed_or_not() {
    for bytes in BY_NUMPY {
        let scene = good(bytes, SCENE);
        let body = &scene.bodies[0].body;
        assert_eq!(body.kinds(), [ElementKind::Hexahedron, ElementKind::Pyramid]);
        assert_eq!(&body.elements()[1], [4, 5, 7, 6, 8]);
        assert_eq!(body.rest()[8], DVec3::new(0.5, 0.5, 1.5));
        assert_eq!(scene.runs[0].initial.position[8], DVec3::new(0.75, 0.75, 2.25));
        assert_eq!(scene.runs[0].initial.position[1], DVec3::new(1.5, 0.0, 0.0));
        assert!(scene.runs[0].initial.velocity.iter().all(|&velocity| velocity == -DVec3::Y));
        assert_eq!(body.mass()[8], 9.0);
        assert_eq!((&body.faces().nodes[0], &body.faces().nodes[1]), (&[4, 5, 7, 6][..], &[4, 5, 8][..]));
        assert_eq!((body.faces().inner[0], body.faces().outer[0]), (Some(0), Some(1)));
        assert!(description(scene.runs[1].models[0].as_ref(), body).starts_with("2 springs,"));
    }
    assert_eq!(good(BY_NUMPY[0], SCENE).digest, good(BY_NUMPY[1], SCENE).digest);
}

#[test]
fn a_body_from_a_file_is_the_same_as_one_in_the_scene() {
    let scene = good(
        &with(|_| ()),
        &SCENE.replace(
            "file = 'body.npz'",
            "file = 'body.npz'\nmass = 2\nlowest = 3\nrotation.angle = 0.1\noffset = [1, 2]\nvelocity = [0, -1]",
        ),
    );
    let typed = SCENE.replace(
        "file = 'body.npz'",
        "nodes = [[0, 0], [1, 0], [1, 1], [0, 1]]\nelements = [[0, 1, 2], [0, 2, 3]]\nmass = 2\nlowest = 3\nrotation.angle = 0.1\noffset = [1, 2]\nvelocity = [0, -1]",
    );
    let typed = super::good(&typed);
    assert_eq!(scene.bodies[0].body, typed.bodies[0].body);
    assert_eq!(scene.runs[0].initial, typed.runs[0].initial);
    assert_eq!(scene.view.side, typed.view.side);
}

#[test]
fn every_type_and_order_of_numbers_means_the_same() {
    let plain = good(&with(|_| ()), SCENE);
    let narrow = with(|arrays| {
        let numbers: [f32; 8] = [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0];
        arrays[0].bytes = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        arrays[0].descr = "'<f4'".into();
        (arrays[1].bytes, arrays[1].descr) = (vec![0, 1, 2, 0, 2, 3], "'|u1'".into());
    });
    let by_columns = with(|arrays| {
        arrays[0] = doubles("nodes", "(4, 2)", &[0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0]);
        arrays[1] = indices("elements", "(2, 3)", &[0, 0, 1, 2, 2, 3]);
        arrays.iter_mut().for_each(|array| array.by_columns = true);
    });
    let padded = with(|arrays| arrays[1] = indices("elements", "(2, 4)", &[0, 1, 2, -1, 0, 2, 3, -1]));
    let compressed = archive(&square(), CompressionMethod::Deflated);
    let big_endian = with(|arrays| {
        for array in arrays.iter_mut() {
            array.bytes.chunks_exact_mut(8).for_each(<[u8]>::reverse);
            array.descr = array.descr.replace('<', ">");
        }
    });
    for other in [narrow, by_columns, padded, compressed, big_endian] {
        let other = good(&other, SCENE);
        assert_eq!((&other.bodies[0].body, &other.digest), (&plain.bodies[0].body, &plain.digest));
    }
}

#[test]
fn the_digest_follows_what_is_in_the_file_and_not_its_name() {
    let plain = good(&with(|_| ()), SCENE).digest;
    let moved = Place::new(&[]);
    std::fs::create_dir(moved.0.path().join("bodies")).unwrap();
    std::fs::write(moved.0.path().join("bodies/other.npz"), with(|_| ())).unwrap();
    let scene = moved.load(&SCENE.replace("body.npz", "bodies/other.npz"), &Limits::default()).unwrap();
    assert_eq!(scene.digest, plain);
    let mut digests = vec![plain];
    for change in [
        with(|arrays| arrays[0].bytes[8] ^= 1),
        with(|arrays| arrays[1] = indices("elements", "(2, 3)", &[0, 1, 3, 1, 2, 3])),
        with(|arrays| arrays[1] = indices("elements", "(1, 4)", &[0, 1, 2, 3])),
        with(|arrays| arrays.push(indices("springs", "(1, 2)", &[0, 1]))),
        with(|arrays| arrays.push(indices("springs", "(1, 2)", &[1, 0]))),
        with(|arrays| arrays.push(indices("faces", "(1, 3)", &[0, 1, 2]))),
        with(|arrays| arrays.push(indices("faces", "(0, 3)", &[]))),
        with(|arrays| arrays.push(doubles("positions", "(4, 2)", &[0.5; 8]))),
        with(|arrays| arrays.push(doubles("velocities", "(4, 2)", &[0.5; 8]))),
        with(|arrays| arrays.push(doubles("masses", "(4,)", &[0.5; 4]))),
    ] {
        digests.push(good(&change, SCENE).digest);
    }
    let all = digests.len();
    digests.sort();
    digests.dedup();
    assert_eq!(digests.len(), all);
}

#[test]
fn files_that_are_no_archives() {
    let whole = with(|_| ());
    wrong(b"", &["`body.npz` is empty; expected a NumPy archive"]);
    wrong(b"v 0 0 0\nv 1 0 0\n", &["`body.npz` is not a NumPy archive (.npz)"]);
    wrong(&square()[0].file(), &["`body.npz` is a single array (.npy); expected several"]);
    wrong(&whole[..whole.len() - 30], &["`body.npz` is a damaged NumPy archive, or is cut short"]);
    wrong(&whole[..100], &["is a damaged NumPy archive, or is cut short"]);
    let mut damaged = whole.clone();
    // A coordinate that does not match the checksum.
    let at = damaged.windows(8).position(|bytes| bytes == 1f64.to_le_bytes()).unwrap();
    damaged[at + 7] ^= 1;
    wrong(&damaged, &["`body.npz: nodes` cannot be read, the file is damaged or cut short"]);
}

/// Sets a compression method in the headers of all entries, local and central.
fn said_to_be_compressed_by(method: u16, mut bytes: Vec<u8>) -> Vec<u8> {
    for at in 0..bytes.len() - 12 {
        match &bytes[at..at + 4] {
            b"PK\x03\x04" => bytes[at + 8..at + 10].copy_from_slice(&method.to_le_bytes()),
            b"PK\x01\x02" => bytes[at + 10..at + 12].copy_from_slice(&method.to_le_bytes()),
            _ => {}
        }
    }
    bytes
}

#[test]
fn archives_of_other_compressions_are_not_called_damaged() {
    for (method, name) in [(12, "bzip2"), (14, "lzma"), (93, "zstd")] {
        let message = |array| {
            format!(
                "`body.npz: {array}` is compressed by {name}, which is not read; write it with numpy.savez or numpy.savez_compressed"
            )
        };
        wrong(&said_to_be_compressed_by(method, with(|_| ())), &[&message("nodes"), &message("elements")]);
    }
}

/// The header of an array may have any length, written with two bytes or with four.
#[test]
fn heads_of_every_length_and_version() {
    let plain = good(&with(|_| ()), SCENE);
    let in_archive = |nodes: &[u8]| {
        let mut zip = ZipWriter::new(std::io::Cursor::new(Vec::new()));
        let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
        for (name, bytes) in [("nodes.npy", nodes), ("elements.npy", &square()[1].file())] {
            zip.start_file(name, stored).unwrap();
            zip.write_all(bytes).unwrap();
        }
        zip.finish().unwrap().into_inner()
    };
    // Padded to a length; the header has the length `told`.
    let file = |version: u8, length: usize, told: u32| {
        let Array { descr, shape, bytes, .. } = &square()[0];
        let head = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}");
        let mut file = vec![0x93, b'N', b'U', b'M', b'P', b'Y', version, 0];
        match version {
            1 => file.extend((told as u16).to_le_bytes()),
            _ => file.extend(told.to_le_bytes()),
        }
        file.extend(format!("{head:<0$}\n", length - 1).bytes());
        file.extend(bytes);
        in_archive(&file)
    };
    for version in [1, 2, 3] {
        for length in [70, 118, 255, 256, 300, 511, 1000, 4096] {
            assert_eq!(
                good(&file(version, length, length as u32), SCENE).bodies[0].body,
                plain.bodies[0].body,
                "{version}, {length}"
            );
        }
        // With a length that is slightly too small or too large the numbers begin elsewhere.
        for told in [117, 119, 126] {
            wrong(&file(version, 118, told), &["`body.npz: nodes` has the shape (4, 2), which does not fit"]);
        }
        for (length, told) in [(118, 374), (118, 4097), (4097, 4097)] {
            wrong(&file(version, length, told), &["`body.npz: nodes` has no complete header"]);
        }
    }
    for version in [2, 3] {
        // Lengths beyond any file, by the third and by the fourth byte alone.
        for told in [118 + (1 << 16), 118 + (1 << 24)] {
            wrong(&file(version, 118, told), &["`body.npz: nodes` has no complete header"]);
        }
    }
    wrong(&file(4, 118, 118), &["`body.npz: nodes` is written in version 4 of NumPy's format; expected 1, 2 or 3"]);
}

#[test]
fn meshes_get_a_hint_to_what_is_read() {
    let place = Place::new(&[]);
    for ending in ["obj", "STL", "ply", "msh", "vtk", "vtu", "gltf", "glb", "node", "ele", "3mf"] {
        let name = format!("mesh.{ending}");
        std::fs::write(place.path().with_file_name(&name), "PK? v 0 0 0").unwrap();
        let error = place.load(&SCENE.replace("body.npz", &name), &Limits::default()).unwrap_err();
        let [mistake] = error.mistakes() else { panic!("{error}") };
        let help = mistake.help.as_deref().unwrap_or_default();
        let (ending, found) = (ending.to_lowercase(), format!("{} {help}", mistake.message));
        let expected = match &*ending {
            "node" | "ele" | "3mf" => {
                format!("`{name}` is a mesh (.{ending}), which is not read; expected a NumPy archive")
            }
            _ => format!("`{name}` is a mesh (.{ending}) write mesh = \"{name}\" in place of `file`"),
        };
        assert!(found.starts_with(&expected), "{found}");
    }
    wrong(
        b"solid mesh",
        &["`body.npz` is not a NumPy archive (.npz); expected one written by numpy.savez write it with numpy.savez"],
    );
}

/// Twelve unit cubes in a row, each with its corners in an order: places in bit order.
fn row_of_cubes(order: impl Fn(usize) -> [usize; 8]) -> Vec<u8> {
    row_of_cubes_counted_from(0, order)
}

fn row_of_cubes_counted_from(first: usize, order: impl Fn(usize) -> [usize; 8]) -> Vec<u8> {
    let node = |x: usize, y: usize, z: usize| (4 * x + 2 * z + y + first) as i64;
    let nodes: Vec<f64> = (0..13 * 4).flat_map(|at| [at / 4, at % 2, at / 2 % 2].map(|to| to as f64)).collect();
    let elements =
        (0..12).flat_map(|cube| order(cube).map(|corner| node(cube + (corner & 1), corner >> 1 & 1, corner >> 2)));
    let elements: Vec<i64> = elements.collect();
    let arrays = [doubles("nodes", "(52, 3)", &nodes), indices("elements", "(12, 8)", &elements)];
    archive(&arrays, CompressionMethod::Stored)
}

#[test]
fn elements_that_are_all_wrong_in_one_way_have_one_mistake() {
    let right = [0, 1, 2, 3, 4, 5, 6, 7];
    let turned = [4, 5, 6, 7, 0, 1, 2, 3];
    let around = [0, 1, 3, 2, 4, 5, 7, 6];
    assert_eq!(good(&row_of_cubes(|_| right), SCENE).bodies[0].body.elements().len(), 12);
    wrong(
        &row_of_cubes(|_| turned),
        &["all 12 elements of `body.npz: elements` are turned inside out at rest write convex = true in [body] \
           for nodes in any order, or take the nodes of each in the order [4, 5, 6, 7, 0, 1, 2, 3] for hexahedra"],
    );
    wrong(
        &row_of_cubes(|_| around),
        &[
            "all 12 elements of `body.npz: elements` list their corners around their sides, as VTK, Gmsh and Abaqus do; \
           expected x fastest, then y, then z take the nodes of each in the order [0, 1, 3, 2, 4, 5, 7, 6]; or \
           write convex = true in [body]",
        ],
    );
    wrong(
        &row_of_cubes(|_| [0, 1, 2, 3, 4, 6, 5, 7]),
        &["all 12 elements of `body.npz: elements` have no volume: their nodes are in planes, or not in their order \
           write convex = true in [body] for nodes in any order"],
    );
    // The suggested remedy works.
    for order in [turned, around] {
        good(&row_of_cubes(|_| order), &SCENE.replace("file =", "convex = true\nfile ="));
        assert_eq!(order.map(|place| order[place]), right);
    }
    // Among wrong elements, the first few are named.
    wrong(
        &row_of_cubes(|cube| if cube == 3 { right } else { turned }),
        &["11 of 12 elements of `body.npz: elements` are turned inside out at rest: 0, 1, 2, 4, 5 and 6 more \
           write convex = true in [body] for nodes in any order, or take the nodes of each in the order ["],
    );
    wrong(
        &row_of_cubes(|cube| if cube < 2 { turned } else { right }),
        &["2 of 12 elements of `body.npz: elements` are turned inside out at rest: 0 and 1 write convex = true"],
    );
    wrong(
        &with(|arrays| arrays[1] = indices("elements", "(2, 3)", &[0, 2, 1, 0, 3, 2])),
        &[
            "all 2 elements of `body.npz: elements` are clockwise; expected counter-clockwise list the nodes of each backwards",
        ],
    );
}

#[test]
fn nodes_counted_from_one_are_told_and_nothing_that_follows() {
    wrong(
        &row_of_cubes_counted_from(1, |_| [0, 1, 2, 3, 4, 5, 6, 7]),
        &["`body.npz: elements[11][7]`: there is no node 52; the body has nodes 0 to 51 nodes are counted from 0"],
    );
}

/// With another program's order, parts of a ring have some volume of either sign, so that inverting them seems to help.
#[test]
fn hexahedra_in_the_order_of_other_programs_are_told_from_turned_ones() {
    let ring = |order: [usize; 8]| {
        let node = |to: usize| {
            let angle = std::f64::consts::TAU * (to / 4) as f64 / 12.0;
            let radius = [0.15, 0.25][to / 2 % 2];
            [(to % 2) as f64, radius * angle.cos(), radius * angle.sin()]
        };
        let nodes: Vec<f64> = (0..48).flat_map(node).collect();
        let corner = |part: usize, corner: usize| (4 * ((part + (corner >> 2)) % 12) + (corner & 3)) as i64;
        let elements: Vec<i64> = (0..12).flat_map(|part| order.map(|place| corner(part, place))).collect();
        archive(
            &[doubles("nodes", "(48, 3)", &nodes), indices("elements", "(12, 8)", &elements)],
            CompressionMethod::Stored,
        )
    };
    assert_eq!(good(&ring([0, 1, 2, 3, 4, 5, 6, 7]), SCENE).bodies[0].body.elements().len(), 12);
    for other in [[0, 1, 3, 2, 4, 5, 7, 6], [4, 5, 7, 6, 0, 1, 3, 2]] {
        wrong(&ring(other), &["all 12 elements of `body.npz: elements` list their corners around their sides"]);
    }
    wrong(&ring([4, 5, 6, 7, 0, 1, 2, 3]), &["all 12 elements of `body.npz: elements` are turned inside out"]);
}

#[test]
fn a_file_that_is_not_there() {
    let place = Place::new(&with(|_| ()));
    let load = |name: &str| {
        let error = place.load(&SCENE.replace("body.npz", name), &Limits::default()).unwrap_err();
        assert_eq!(error.mistakes().len(), 1, "{error}");
        error.to_string()
    };
    let missing = load("bodi.npz");
    assert!(missing.contains("`bodi.npz` is not there (looked for ") && missing.contains("did you mean \"body.npz\"?"));
    assert!(load("no/such/folder.npz").contains("is not there"));
    assert!(load(".").contains("is a folder; expected a NumPy archive"));
    // A text has no folder: its file is searched for in the current one.
    let error = super::bad(SCENE).to_string();
    let full = std::env::current_dir().unwrap().join("body.npz");
    assert!(error.contains(&format!("`body.npz` is not there (looked for {})", full.display())), "{error}");
    let absolute = place.path().with_file_name("body.npz");
    super::good(&SCENE.replace("body.npz", &absolute.display().to_string()));
}

#[test]
fn arrays_that_are_none() {
    wrong(&with(|arrays| drop(arrays.remove(0))), &["`body.npz` has no array `nodes`"]);
    wrong(
        &with(|arrays| arrays[1].name = "element"),
        &[
            "`body.npz: element` is not an array of a body did you mean `elements`?",
            "`body.npz` has no array `elements`",
        ],
    );
    wrong(
        &with(|arrays| (arrays[0].name, arrays[1].name) = ("points", "cells")),
        &[
            "`body.npz: points` is not an array of a body did you mean `nodes`?",
            "`body.npz: cells` is not an array of a body did you mean `elements`?",
            "`body.npz` has no array `nodes`",
            "`body.npz` has no array `elements`",
        ],
    );
    wrong(
        &with(|arrays| arrays[0].shape = "(8,)".into()),
        &["`body.npz: nodes` has the shape (8,); expected one row for each node with 2 or 3 coordinates"],
    );
    wrong(&with(|arrays| arrays[0].shape = "(2, 4)".into()), &["has the shape (2, 4); expected one row"]);
    wrong(
        &with(|arrays| arrays[1].shape = "(6, 1)".into()),
        &["`body.npz: elements` has the shape (6, 1); expected one row for each of the elements with at least 2 nodes"],
    );
    wrong(&with(|arrays| arrays[1].shape = "(6,)".into()), &["`body.npz: elements` has the shape (6,)"]);
    wrong(&with(|arrays| arrays[1] = indices("elements", "(0, 3)", &[])), &["`body.npz: elements` is empty"]);
    wrong(&with(|arrays| arrays[0] = doubles("nodes", "(0, 3)", &[])), &["`body.npz: nodes` is empty"]);
    wrong(&with(|arrays| arrays[0].descr = "'<c8'".into()), &["has numbers of the type \"<c8\"; expected float64"]);
    wrong(&with(|arrays| arrays[0].descr = "[('x', '<f8')]".into()), &["`body.npz: nodes` has rows of several fields"]);
    wrong(&with(|arrays| arrays[1].descr = "'|O'".into()), &["`body.npz: elements` contains Python objects"]);
    wrong(
        &with(|arrays| arrays[1].descr = "'<f8'".into()),
        &["`body.npz: elements` is float64; expected integers, as by"],
    );
    wrong(&with(|arrays| arrays[1].descr = "junk".into()), &["`body.npz: elements` has no complete header"]);
    wrong(&with(|arrays| arrays[0].shape = "(4, -2)".into()), &["`body.npz: nodes` has no complete header"]);
    wrong(
        &with(|arrays| arrays.push(indices("springs", "(2, 3)", &[0, 1, 2, 1, 2, 3]))),
        &["`body.npz: springs` has the shape (2, 3); expected one row for each spring with 2 nodes"],
    );
    wrong(
        &with(|arrays| arrays.push(indices("faces", "(1, 2)", &[0, 1]))),
        &["`body.npz: faces` has the shape (1, 2)"],
    );
    wrong(
        &with(|arrays| arrays.push(doubles("masses", "(4, 1)", &[1.0; 4]))),
        &["`body.npz: masses` has the shape (4, 1)"],
    );
    wrong(
        &with(|arrays| arrays.push(doubles("velocities", "(4, 3)", &[1.0; 12]))),
        &["`body.npz: velocities` has the shape (4, 3); expected one row for each node with 2 coordinates"],
    );
}

#[test]
fn what_is_said_to_be_enormous_is_refused_before_it_is_read() {
    for shape in ["(1000000000000, 3)", "(18446744073709551615, 3)", "(4000000, 3)"] {
        wrong(&with(|arrays| arrays[0].shape = shape.into()), &["which does not fit the 64 bytes that are stored"]);
    }
    let place = Place::new(&with(|_| ()));
    let few = Limits { nodes: 3, ..Limits::default() };
    let error = place.load(SCENE, &few).unwrap_err().to_string();
    assert!(
        error.contains("`body.npz: nodes` has 4 nodes; the limit is 3") && error.contains("--allow-large"),
        "{error}"
    );
    let little = Limits { corners: 5, ..Limits::default() };
    let error = place.load(SCENE, &little).unwrap_err().to_string();
    assert!(error.contains("`body.npz: elements` has 6 entries; the limit is 5"), "{error}");
    // The archive is small enough, but the scene made of it is not.
    let error = place.load(SCENE, &Limits { springs: 5, ..Limits::default() }).unwrap_err().to_string();
    assert!(error.contains("this makes 4 nodes, 2 elements and up to 6 springs, at least"), "{error}");
}

#[test]
fn numbers_that_cannot_be() {
    wrong(
        &with(|arrays| arrays[0] = doubles("nodes", "(4, 2)", &[0.0, 0.0, 1.0, f64::NAN, 1e31, 1.0, 0.0, 1.0])),
        &[
            "`body.npz: nodes[1][1]` is NaN; expected a finite number",
            "`body.npz: nodes[2][0]` is 10000000000000000000000000000000; expected a magnitude up to 1e30",
        ],
    );
    wrong(
        &with(|arrays| arrays.push(doubles("masses", "(4,)", &[1.0, 0.0, f64::INFINITY, -1.0]))),
        &[
            "`body.npz: masses[1]` is 0; expected a number greater than 0",
            "`body.npz: masses[2]` is inf; expected a finite number",
            "`body.npz: masses[3]` is -1; expected a number greater than 0",
        ],
    );
    wrong(
        &with(|arrays| arrays.push(doubles("masses", "(3,)", &[1.0; 3]))),
        &["`body.npz: masses` has 3 entries, and the body has 4 nodes; expected one for each"],
    );
    wrong(
        &with(|arrays| arrays[1] = indices("elements", "(3, 3)", &[0, 1, -1, 0, -1, 2, -2, 2, 3])),
        &[
            "`body.npz: elements[1][1]` is -1, but a node follows; expected -1 only at the end",
            "`body.npz: elements[2][0]` is -2; expected the number of a node",
        ],
    );
    wrong(
        &with(|arrays| arrays[1] = indices("elements", "(2, 3)", &[0, 1, 2, 3, -1, -1])),
        &["`body.npz: elements[1]` has 1 node; expected at least 2"],
    );
    wrong(
        &with(|arrays| arrays.push(indices("faces", "(1, 3)", &[0, 1, -1]))),
        &["`body.npz: faces[0]` has 2 nodes; expected at least 3"],
    );
}

#[test]
fn lists_of_a_file_are_checked_like_those_of_a_scene() {
    let elements = |numbers: &'static [i64]| with(move |arrays| arrays[1] = indices("elements", "(2, 3)", numbers));
    wrong(
        &elements(&[0, 1, 2, 0, 2, 4]),
        &["`body.npz: elements[1][2]`: there is no node 4; the body has nodes 0 to 3 nodes are counted from 0"],
    );
    wrong(&elements(&[0, 1, 2, 0, 2, 2]), &["node 2 occurs twice in `body.npz: elements[1]`"]);
    wrong(
        &elements(&[0, 1, 2, 2, 0, 1]),
        &[
            "`body.npz: elements[1]` has the same nodes as `body.npz: elements[0]`",
            "`body.npz: nodes[3]`: node 3 belongs to no element and no spring",
        ],
    );
    wrong(
        &elements(&[0, 1, 2, 0, 3, 2]),
        &["`body.npz: elements[1]` is clockwise; expected counter-clockwise write [2, 3, 0]"],
    );
    wrong(
        &with(|arrays| arrays[0] = doubles("nodes", "(4, 2)", &[0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 2.0, 2.0])),
        &["`body.npz: elements[1]` has no area"],
    );
    wrong(
        &with(|arrays| arrays[0] = doubles("nodes", "(4, 2)", &[5.0; 8])),
        &[
            "`body.npz: elements[0]` has no extent: all its nodes are at [5, 5]",
            "`body.npz: elements[1]` has no extent",
        ],
    );
    wrong(
        &with(|arrays| arrays.push(indices("springs", "(2, 2)", &[0, 1, 1, 0]))),
        &["`body.npz: springs[1]` has the same nodes as `body.npz: springs[0]`"],
    );
    wrong(
        &with(|arrays| arrays.push(indices("faces", "(1, 3)", &[0, 1, 7]))),
        &["`body.npz: faces[0][2]`: there is no node 7"],
    );
}

#[test]
fn a_scene_does_not_say_what_its_file_says() {
    let arrays = with(|arrays| {
        arrays.push(doubles("masses", "(4,)", &[1.0; 4]));
        arrays.push(doubles("velocities", "(4, 2)", &[0.0; 8]));
        arrays.push(doubles("positions", "(4, 2)", &[0.0; 8]));
    });
    let both = SCENE
        .replace("file = 'body.npz'", "file = 'body.npz'\nmass = 1\nvelocity = [0, 1]\nstart = { shape = 'point' }");
    let error = Place::new(&arrays).load(&both, &Limits::default()).unwrap_err();
    for key in ["density", "mass_total"] {
        let both = SCENE.replace("file = 'body.npz'", &format!("file = 'body.npz'\n{key} = 1"));
        let error = Place::new(&arrays).load(&both, &Limits::default()).unwrap_err();
        let [mistake] = error.mistakes() else { panic!("{error}") };
        assert_eq!(mistake.message, format!("`body.{key}` and `body.npz: masses` exclude each other"));
        let without = with(|arrays| arrays.retain(|array| array.name != "masses"));
        let scene = Place::new(&without).load(&both, &Limits::default()).unwrap();
        assert!((scene.bodies[0].body.mass().iter().sum::<f64>() - 1.0).abs() < 1e-15, "a square of 1 m²");
    }
    let lines: Vec<_> = error.mistakes().iter().map(|mistake| (mistake.line, mistake.message.as_str())).collect();
    assert_eq!(
        lines,
        [
            (5, "`body.mass` and `body.npz: masses` exclude each other"),
            (6, "`body.velocity` and `body.npz: velocities` exclude each other"),
            (7, "`body.start` and `body.npz: positions` exclude each other"),
        ]
    );
}

/// Reading any file gives a scene or mistakes, never a panic, and never exhausts memory.
#[test]
fn any_bytes_in_an_archive() {
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut below = |bound: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % bound as u64) as usize
    };
    let small = Limits { nodes: 5000, corners: 50_000, springs: 100_000, file: 1 << 20, ..Limits::default() };
    let place = Place::new(&[]);
    for bytes in BY_NUMPY {
        for _ in 0..1500 {
            let mut bytes = bytes.to_vec();
            for _ in 0..=below(3) {
                let at = below(bytes.len());
                match below(5) {
                    0 => bytes[at] = b"0123456789,() -'<>"[below(18)],
                    1 => bytes[at] ^= 1 << below(8),
                    2 => bytes[at] = 0xff,
                    3 if bytes.len() > 1 => drop(bytes.remove(at)),
                    _ => bytes.truncate(at.max(1)),
                }
            }
            place.put_body(&bytes);
            match place.load(SCENE, &small) {
                Ok(scene) => assert!(scene.runs[0].initial.position.iter().all(|at| at.is_finite())),
                Err(error) => assert!(error.mistakes().iter().all(|mistake| mistake.line > 0), "{error}"),
            }
        }
    }
}

#[test]
fn the_path_is_taken_from_the_scene_and_not_from_the_current_folder() {
    let place = Place::new(&with(|_| ()));
    assert!(!Path::new("body.npz").exists());
    assert_eq!(place.load(SCENE, &Limits::default()).unwrap().bodies[0].body.len(), 4);
}
