//! The paper's concluding claim: free-form bodies of irregular elements keep their shape. Uses the shipped scenes.

use super::support::{after, shipped};
use localshape::sim::ElementKind;

#[test]
fn bears_of_irregular_elements_keep_their_shape_where_springs_fold() {
    for (name, kind, fewest) in
        [("free-form-plane", ElementKind::Polygon, 3), ("free-form-space", ElementKind::Other, 10)]
    {
        let scene = shipped(name, &[]);
        assert!(scene.bodies[0].body.kinds().iter().all(|&found| found == kind));
        let corners: std::collections::BTreeSet<_> = scene.bodies[0].body.elements().iter().map(<[u32]>::len).collect();
        assert!(corners.len() > 4, "elements of many shapes: {corners:?}");
        let shape = after(&scene, "Local shape", 6.0).diagnostics;
        assert_eq!(shape.turned_over, 0, "{name}");
        assert!(shape.shape_error < 0.02 * scene.bodies[0].body.extent(), "{name}: {}", shape.shape_error);
        let springs = after(&scene, "Mass-spring", 6.0).diagnostics;
        assert!(springs.turned_over >= fewest, "{name}: {}", springs.turned_over);
    }
}
