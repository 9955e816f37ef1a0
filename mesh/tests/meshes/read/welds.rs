//! Points at one place, and those that are nearly there.

use super::{LIMITS, file, surface, surface_of};
use localshape_mesh::{Flaws, Format, Mesh, read, read_cells};

/// Volume, area, and numbers of points, triangles and pieces of a mended surface that is closed.
fn check(name: &str, [volume, area]: [f64; 2], [points, triangles, pieces]: [usize; 3]) -> Flaws {
    let (mended, flaws) = surface_of(name).mended();
    let measures = mended.measures();
    assert!(measures.closed, "{name}: {flaws:?}");
    assert!((measures.volume - volume).abs() < 1e-5 * volume, "{name}: {}", measures.volume);
    assert!((measures.area - area).abs() < 1e-5 * area, "{name}: {}", measures.area);
    assert_eq!((mended.points.len(), mended.triangles.len(), flaws.pieces), (points, triangles, pieces), "{name}");
    flaws
}

#[test]
fn boxes_are_read_however_they_are_written() {
    for name in [
        // A byte order mark, both ends of lines, continued lines, colours, comments, no last line feed.
        "odd-lines.obj",
        "carriage-returns.obj",
        // At 500 km and 4650 km from the origin, in double precision.
        "far.obj",
        "groups.obj",
        "unknown-point.obj",
        "unknown-point.ply",
        "unknown-point-binary.ply",
        // Binary files that begin with `solid` and `facet`, with data behind them, with spaces in place of zeros.
        "solid-in-header-a.stl",
        "solid-in-header-b.stl",
        "solid-in-header-c.stl",
        "solid-in-header-d.stl",
        "two-words.stl",
        "small-zeros.stl",
        "big-endian-ushort.ply",
        "crlf-header.ply",
        "crlf-text.ply",
        "int64.ply",
        "cr-header.ply",
        "int8-int16.ply",
        "draco-optional.gltf",
        "skinned.gltf",
    ] {
        check(name, [6.0, 22.0], [8, 12, 1]);
    }
    // Indices counted back from the last point so far.
    check("negative-blocks.obj", [12.0, 44.0], [16, 24, 2]);
    // Faces with a hole, which a bridge joins to their border. The corners of the bridge are listed twice.
    check("keyhole.obj", [12.0, 48.0], [16, 32, 1]);
    check("hollow.obj", [26.0, 60.0], [16, 24, 2]);
    check("morphed.gltf", [9.0, 30.0], [8, 12, 1]);
}

#[test]
fn zeros_with_round_off_are_one_point() {
    let flaws = check("small-zeros.stl", [6.0, 22.0], [8, 12, 1]);
    assert!(flaws.near > 0 && flaws.near == flaws.welded, "{flaws:?}");
    // Equal points are nothing to tell.
    assert_eq!(surface_of("two-words.stl").mended().1.near, 0);
}

#[test]
fn a_distance_joins_what_differs_in_the_last_digits() {
    let (bytes, format) = file("last-digits.stl");
    let (mended, flaws) = surface(&bytes, format).mended();
    assert_eq!((flaws.boundary, flaws.pieces, mended.points.len()), (36, 12, 36));
    assert_eq!(mended.closing_weld(), Some(1e-6), "corners are up to 7e-7 apart");
    let mut cells = read_cells(&bytes, format, &LIMITS).expect("sound");
    assert_eq!(cells.weld(1e-6), 28);
    let Ok(Mesh::Surface(welded)) = cells.mesh(format) else { panic!("a surface") };
    let measures = welded.measures();
    assert!(measures.closed && (measures.volume - 6.0).abs() < 1e-5, "{measures:?}");
    assert_eq!((welded.points.len(), welded.closing_weld()), (8, None));
    // A hole is no crack.
    let mut open = surface_of("odd-lines.obj");
    open.triangles.truncate(10);
    assert_eq!(open.closing_weld(), None);
}

#[test]
fn cells_with_points_of_their_own_are_joined_on_request() {
    let (bytes, format) = file("discontinuous.vtu");
    let Ok(Mesh::Volume(volume)) = read(&bytes, format, &LIMITS) else { panic!("cells") };
    assert_eq!((volume.points.len(), volume.cells.len()), (24, 6));
    let distance = volume.joining_weld().expect("equal points");
    assert!(distance < 1e-9, "{distance}");
    let mut cells = read_cells(&bytes, format, &LIMITS).expect("sound");
    assert_eq!(cells.weld(distance), 16);
    let Ok(Mesh::Volume(volume)) = cells.mesh(format) else { panic!("cells") };
    assert_eq!((volume.points.len(), volume.cells.len(), volume.joining_weld()), (8, 6, None));
}

/// Which of several points stays is a matter of their order alone, and no point moves farther than the distance.
#[test]
fn points_in_a_row_are_joined_with_the_first_within_the_distance() {
    let points: String = (0..3000).map(|at| format!("v {} {} 0\n", 0.75 * f64::from(at % 1000), at / 1000)).collect();
    let faces: String = (1..1000).map(|at| format!("f {at} {} {}\n", at + 1, at + 2000)).collect();
    let joined = |distance: f64| {
        let mut cells = read_cells((points.clone() + &faces).as_bytes(), Format::Obj, &LIMITS).expect("sound");
        (cells.weld(distance), cells.corners.indices().to_vec())
    };
    assert_eq!(joined(0.7).0, 0);
    // Every other point of a row stays: a row is not one point, although each is near to the next.
    let (count, corners) = joined(0.8);
    assert_eq!(count, 1500);
    assert!(corners.iter().all(|corner| corner % 2 == 0), "the first stays");
    // As grids of very many points that no gap along an axis divides.
    let several = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads").install(|| joined(0.8));
    assert_eq!(several, (count, corners));
}
