//! Meshes of other projects are read or refused with a message, and never end the program: those of Debian's packages `libcgal-demo`
//! and `assimp-testmodels`, and those in folders named by `LOCALSHAPE_MESHES`. With `LOCALSHAPE_REQUIRE_MESHES=1` missing packages are a
//! failure.

use crate::common::near::outside;
use localshape_mesh::{Cage, Fill, Filled, Format, Limits, Mesh, Surface, fill, read};
use localshape_sim::geometry::bounds;
use localshape_sim::{Body, Solids};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The archive of `libcgal-demo`, and the folder of `assimp-testmodels`.
const ARCHIVE: &str = "/usr/share/doc/libcgal-dev/data.tar.gz";
const MODELS: &str = "/usr/share/assimp/models";

const LIMITS: Limits = Limits { points: 2_000_000, corners: 16_000_000 };

/// Whether a package is there, with a notice if not.
fn has(path: &str, package: &str) -> bool {
    if Path::new(path).exists() {
        return true;
    }
    let missing = format!("{path} is missing (apt install {package})");
    assert!(std::env::var_os("LOCALSHAPE_REQUIRE_MESHES").is_none_or(|value| value != "1"), "{missing}");
    eprintln!("skipped: {missing}");
    false
}

/// All files in a folder that have the ending of a format, in order.
fn meshes(folder: &Path) -> Vec<(PathBuf, Format)> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let ending = path.extension().map(|ending| ending.to_string_lossy().into_owned()).unwrap_or_default();
            match Format::of(&ending) {
                _ if path.is_dir() => folders.push(path),
                Some(format) => found.push((path, format)),
                None => {}
            }
        }
    }
    found.sort_by(|one, other| one.0.cmp(&other.0));
    found
}

/// Checks that each element has a part inside, and that no node is farther outside than an eighth of a cell.
fn assert_at_surface(filled: &Filled, side: f64, name: &str) {
    let Cage { nodes, elements, convex, .. } = filled.cage.clone();
    let (solids, mass) = (if convex { Solids::Convex } else { Solids::Ordered }, vec![1.0; nodes.len()]);
    let body = Body::builder(nodes).elements(elements).solids(solids).masses(mass).build().expect("a body");
    let found = outside(filled, &body, side);
    assert_eq!((found.far, found.empty), (0, 0), "{name}, {solids:?}: {found:?}");
}

/// Fills a surface with elements of every kind, or is told why not.
fn check_fills(surface: &Surface, name: &str) {
    /// More than twelve cubes along each side need, as tetrahedra.
    const MOST: usize = 50_000;
    /// Larger ones take longer, and have nothing else.
    const TRIANGLES: usize = 30_000;
    if surface.triangles.len() > TRIANGLES {
        return;
    }
    let (low, high) = bounds(&surface.points);
    let side = (high - low).max_element() / 12.0;
    for with in [Fill::Cubes { side }, Fill::Graded { side }, Fill::Tetrahedra { side }, Fill::Polyhedra { side }] {
        match fill(surface, with, MOST) {
            Ok(filled) => {
                let elements = filled.cage.elements.len();
                assert!((1..=MOST).contains(&elements), "{name}: {elements}");
                assert_eq!(filled.weights.len(), filled.surface.points.len(), "{name}");
                let ends_at_surface = matches!(with, Fill::Tetrahedra { .. } | Fill::Polyhedra { .. });
                if ends_at_surface && filled.surface.measures().closed {
                    assert_at_surface(&filled, side, name);
                }
            }
            Err(error) => {
                assert!(error.help.is_some() && error.message.len() < 400, "{name}: {error}");
                println!("{name} {with:?}: {error}");
            }
        }
    }
}

/// Reads all meshes in a folder. The surfaces among them are filled. Returns the number of those that are read, and the names and messages of the others.
fn answers(folder: &Path) -> (usize, Vec<(String, String)>) {
    let mut read_ones = 0;
    let mut refused = Vec::new();
    for (path, format) in meshes(folder) {
        let bytes = fs::read(&path).expect("a file");
        let name = path.strip_prefix(folder).expect("inside").display().to_string();
        match read(&bytes, format, &LIMITS) {
            Ok(Mesh::Surface(surface)) => {
                assert!(!surface.triangles.is_empty(), "{name}");
                let corners = surface.triangles.as_flattened();
                assert!(corners.iter().all(|&corner| (corner as usize) < surface.points.len()), "{name}");
                println!("{name}: {} points, {} triangles", surface.points.len(), surface.triangles.len());
                check_fills(&surface, &name);
                read_ones += 1;
            }
            Ok(Mesh::Volume(volume)) => {
                let corners = volume.cells.indices();
                assert!(corners.iter().all(|&corner| (corner as usize) < volume.points.len()), "{name}");
                println!("{name}: {:?}, {} cells", volume.dimension, volume.cells.len());
                read_ones += 1;
            }
            Err(error) => {
                assert!(error.message.len() < 400 && !error.message.contains('\n'), "{name}: {error}");
                let help = error.help.expect("a remedy");
                println!("{name} {} ({help})", error.message);
                refused.push((name, error.message));
            }
        }
    }
    (read_ones, refused)
}

#[test]
fn meshes_of_cgal_are_answered() {
    if !has(ARCHIVE, "libcgal-demo") {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let unpacked = Command::new("tar").arg("-xzf").arg(ARCHIVE).arg("-C").arg(folder.path()).status();
    assert!(unpacked.expect("tar").success());
    let (read, refused) = answers(folder.path());
    assert!(read > 100, "{read}: {refused:?}");
    for name in ["armadillo.off", "bunny00.off", "homer.off", "elephant.off", "cheese.off"] {
        assert!(refused.iter().all(|(refused, _)| !refused.ends_with(&format!("/{name}"))), "{name}");
    }
}

#[test]
fn meshes_of_assimp_are_answered() {
    if !has(MODELS, "assimp-testmodels") {
        return;
    }
    let (read, refused) = answers(Path::new(MODELS));
    assert!(read > 35, "{read}: {refused:?}");
    let message = |name: &str| &refused.iter().find(|(refused, _)| refused == name).expect(name).1;
    assert_eq!(message("invalid/empty.ply"), "is empty");
}

#[test]
fn meshes_in_a_folder_of_the_user_are_answered() {
    if let Some(folder) = std::env::var_os("LOCALSHAPE_MESHES") {
        answers(Path::new(&folder));
    }
}
