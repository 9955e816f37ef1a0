//! What is seen of a body in files for other programs.

use super::*;

/// A tetrahedron with listed faces, of which one is seen from inside.
#[test]
fn listed_faces_without_an_inner_element_are_seen() {
    let rest = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let elements: IndexLists = [&[0_u32, 1, 2, 3][..]].into_iter().collect();
    let faces: IndexLists = [&[0_u32, 2, 1][..], &[0, 3, 1]].into_iter().collect();
    let body = Body::builder(rest).elements(elements).faces(faces).build().expect("a body");
    assert_eq!((&body.faces().inner[..], &body.faces().outer[..]), (&[Some(0), None][..], &[None, Some(0)][..]));
    let surface = Surface::of(&Arc::new(body));
    assert_eq!(surface.faces.iter().collect::<Vec<_>>(), [&[0, 2, 1], &[0, 3, 1]]);
}
