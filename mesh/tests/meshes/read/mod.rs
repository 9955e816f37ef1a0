//! Files of every format are read as they are written, and broken ones are told.

mod abaqus;
mod bounds;
mod collapsed;
mod cube;
mod displacements;
mod gltf;
mod gmsh;
mod lists;
mod medit;
mod numbers;
mod polygons;
mod texts;
mod vtk;
mod welds;

use glam::DVec3;
use localshape_mesh::{Format, Limits, Mesh, Surface, Volume, read};
use localshape_sim::geometry::{kind, volume_by_faces};
use localshape_sim::{Dimension, Solids};

const LIMITS: Limits = Limits { points: 1_000_000, corners: 8_000_000 };

/// What is said of cells of higher order.
const STRAIGHT: [&str; 1] = ["has cells of higher order, of which the corners are read: their edges become straight"];

/// A file in `tests/files`.
fn file(name: &str) -> (Vec<u8>, Format) {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files").join(name);
    let ending = name.rsplit('.').next().expect("an ending");
    (std::fs::read(path).expect("a file"), Format::of(ending).expect("a format"))
}

fn bytes_of(name: &str) -> Vec<u8> {
    file(name).0
}

fn mesh(bytes: impl AsRef<[u8]>, format: Format) -> Mesh {
    read(bytes.as_ref(), format, &LIMITS).unwrap_or_else(|error| panic!("{error} ({:?})", error.help))
}

fn volume(bytes: impl AsRef<[u8]>, format: Format) -> Volume {
    match mesh(bytes, format) {
        Mesh::Volume(volume) => volume,
        Mesh::Surface(surface) => panic!("{surface:?}"),
    }
}

fn surface(bytes: impl AsRef<[u8]>, format: Format) -> Surface {
    match mesh(bytes, format) {
        Mesh::Surface(surface) => surface,
        Mesh::Volume(volume) => panic!("{volume:?}"),
    }
}

fn surface_of(name: &str) -> Surface {
    let (bytes, format) = file(name);
    surface(&bytes, format)
}

/// The message and the remedy of a refusal.
fn refusal(bytes: impl AsRef<[u8]>, format: Format) -> String {
    let error = read(bytes.as_ref(), format, &LIMITS).expect_err("a refusal");
    format!("{} ({})", error.message, error.help.expect("a remedy"))
}

/// The volume of each cell, negative if it is not in the order of its kind.
fn each(volume: &Volume) -> Vec<f64> {
    let of = |cell: &[u32]| volume_by_faces(kind(volume.dimension, volume.solids, cell.len()), cell, &volume.points);
    volume.cells.iter().map(of).collect()
}

fn whole(volume: &Volume) -> f64 {
    each(volume).iter().sum()
}

/// The number of points in each group, with its name.
fn groups(volume: &Volume) -> Vec<(&str, usize)> {
    volume.groups.iter().map(|group| (&*group.name, group.points.len())).collect()
}

/// The positions of the points of a group.
fn group(volume: &Volume, name: &str) -> Vec<[f64; 3]> {
    let group = volume.groups.iter().find(|group| group.name == name).unwrap_or_else(|| panic!("{name}"));
    group.points.iter().map(|&point| volume.points[point as usize].to_array()).collect()
}

/// The volumes of one element of each kind, with the lengths 1: a tetrahedron, a pyramid, a wedge and a cube.
const OF_KINDS: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 0.5, 1.0];

fn check_kinds(found: &Volume) {
    assert_eq!((found.dimension, found.solids, found.turned), (Dimension::Space, Solids::Ordered, 0));
    assert_eq!(found.points.len(), 23);
    let volumes = each(found);
    assert_eq!(volumes.len(), 4);
    assert!(volumes.iter().zip(OF_KINDS).all(|(found, expected)| (found - expected).abs() < 1e-12), "{volumes:?}");
}

/// The corners of a unit cube, x fastest, then y, then z.
fn cube() -> [DVec3; 8] {
    std::array::from_fn(|bits| DVec3::new((bits & 1) as f64, (bits >> 1 & 1) as f64, (bits >> 2) as f64))
}

/// The sides of a unit cube, counter-clockwise from outside.
const SIDES: [[usize; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

/// The triangles of a unit cube.
fn triangles() -> Vec<[usize; 3]> {
    SIDES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect()
}

fn lines(points: impl IntoIterator<Item = DVec3>) -> String {
    points.into_iter().map(|p| format!("{} {} {}\n", p.x, p.y, p.z)).collect()
}

fn stl() -> (String, Vec<u8>) {
    let mut text = String::from("solid a cube of facet\n");
    let mut binary = b"solid but binary".to_vec();
    binary.resize(80, b' ');
    binary.extend(12u32.to_le_bytes());
    for triangle in triangles() {
        text += " facet normal 0 0 0\n  outer loop\n";
        binary.extend([0; 12]);
        for corner in triangle.map(|corner| cube()[corner]) {
            text += &format!("   vertex {:e} {} {}\n", corner.x, corner.y, corner.z);
            corner.to_array().iter().for_each(|&value| binary.extend((value as f32).to_le_bytes()));
        }
        text += "  endloop\n endfacet\n";
        binary.extend([7, 7]);
    }
    (text + "endsolid a cube\n", binary)
}
