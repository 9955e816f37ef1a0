//! Tests of `src/scene/resolve/elements.rs`.

use super::*;
use crate::scene::resolve::disorder::mended;

#[test]
fn the_mended_order_turns_an_element_right_side_out() {
    let corner = |x: i32, y: i32, z: i32| DVec3::new(f64::from(x), f64::from(y), f64::from(z)) + 100.0;
    let (o, x, y, z) = (corner(0, 0, 0), corner(1, 0, 0), corner(0, 1, 0), corner(0, 0, 1));
    let cube: Vec<_> = (0..8).map(|bits| corner(bits & 1, bits >> 1 & 1, bits >> 2)).collect();
    for (kind, corners, expected) in [
        (ElementKind::Polygon, vec![o, x, y], 0.5),
        (ElementKind::Tetrahedron, vec![o, x, y, z], 1.0 / 6.0),
        (ElementKind::Pyramid, vec![o, x, corner(1, 1, 0), y, z], 1.0 / 3.0),
        (ElementKind::Wedge, vec![o, x, y, z, corner(1, 0, 1), corner(0, 1, 1)], 0.5),
        (ElementKind::Hexahedron, cube, 1.0),
    ] {
        let right: Vec<u32> = (0..).take(corners.len()).collect();
        let wrong = mended(kind, &right).1;
        assert!((volume_by_faces(kind, &right, &corners) - expected).abs() < 1e-12, "{kind:?}");
        assert!((volume_by_faces(kind, &wrong, &corners) + expected).abs() < 1e-12, "{kind:?}");
        let mended = mended(kind, &wrong).1;
        assert!((volume_by_faces(kind, &mended, &corners) - expected).abs() < 1e-12, "{kind:?}");
    }
}
