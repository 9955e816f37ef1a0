//! The kinds of elements, with their faces and edges.

/// Whether a body lives in the plane or in space.
///
/// A body in the plane is stored with `z = 0`, moves in the xy-plane only and is drawn flat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Two coordinates; elements are polygons, listed counter-clockwise.
    Plane,
    /// Three coordinates.
    Space,
}

/// The kind of an element, which defines its faces, its edges and how its volume is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ElementKind {
    /// Two nodes.
    Segment,
    /// Three or more nodes in the plane, counter-clockwise.
    Polygon,
    /// Three nodes in space: a two-sided face without a volume.
    Triangle,
    /// Four nodes in space; seen from node 3, the triangle 0, 1, 2 is counter-clockwise.
    Tetrahedron,
    /// Five nodes in space: a quadrilateral 0, 1, 2, 3 in order around, and the apex 4.
    Pyramid,
    /// Six nodes in space: a triangle 0, 1, 2 and the opposite one 3, 4, 5.
    Wedge,
    /// Eight nodes in space, numbered with x fastest, then y, then z.
    Hexahedron,
    /// Any other number of nodes in space, in any order. Its faces and edges are those of its convex hull at rest.
    /// Nodes inside the hull are on no edge: of the named springs only `edges+body-diagonals` and `all` attach to them.
    Other,
}

/// How elements of four, five, six and eight nodes in space are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Solids {
    /// As tetrahedra, pyramids, wedges and hexahedra, with the order of nodes of their kind.
    #[default]
    Ordered,
    /// As the convex hulls of their nodes, like elements with other numbers of nodes: for example octahedra and
    /// bipyramids.
    Convex,
}

/// The kind of an element from the number of its nodes.
pub fn kind(dimension: Dimension, solids: Solids, nodes: usize) -> ElementKind {
    match (dimension, nodes) {
        (Dimension::Space, 4..) if solids == Solids::Convex => ElementKind::Other,
        (_, 2) => ElementKind::Segment,
        (Dimension::Plane, _) => ElementKind::Polygon,
        (Dimension::Space, 3) => ElementKind::Triangle,
        (Dimension::Space, 4) => ElementKind::Tetrahedron,
        (Dimension::Space, 5) => ElementKind::Pyramid,
        (Dimension::Space, 6) => ElementKind::Wedge,
        (Dimension::Space, 8) => ElementKind::Hexahedron,
        (Dimension::Space, _) => ElementKind::Other,
    }
}

/// The faces of an element of a kind in space, as positions in its own node list, counter-clockwise from outside.
///
/// Polygons, segments and other elements have no table; see [`Elements`](super::topology::Elements).
pub(crate) fn face_table(kind: ElementKind) -> &'static [&'static [u8]] {
    match kind {
        ElementKind::Segment | ElementKind::Polygon | ElementKind::Other => &[],
        ElementKind::Triangle => &[&[0, 1, 2]],
        ElementKind::Tetrahedron => &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]],
        ElementKind::Pyramid => &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
        ElementKind::Wedge => &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]],
        ElementKind::Hexahedron => {
            &[&[0, 4, 6, 2], &[1, 3, 7, 5], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 2, 3, 1], &[4, 5, 7, 6]]
        }
    }
}

/// The edges of an element of a kind that has a table of faces, as positions in its own node list.
pub(super) fn edge_table(kind: ElementKind) -> &'static [[u8; 2]] {
    match kind {
        ElementKind::Segment => &[[0, 1]],
        ElementKind::Polygon | ElementKind::Other => &[],
        ElementKind::Triangle => &[[0, 1], [1, 2], [0, 2]],
        ElementKind::Tetrahedron => &[[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]],
        ElementKind::Pyramid => &[[0, 1], [1, 2], [2, 3], [0, 3], [0, 4], [1, 4], [2, 4], [3, 4]],
        ElementKind::Wedge => &[[0, 1], [1, 2], [0, 2], [3, 4], [4, 5], [3, 5], [0, 3], [1, 4], [2, 5]],
        ElementKind::Hexahedron => {
            &[[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]]
        }
    }
}

/// Calls `visit` with the nodes of each face of one element, counter-clockwise seen from outside. The only face of a
/// polygon is itself; segments and elements of other kinds have none here.
///
/// # Panics
/// If there are fewer nodes than the kind has.
pub fn for_each_face(kind: ElementKind, nodes: &[u32], mut visit: impl FnMut(&[u32])) {
    if kind == ElementKind::Polygon {
        return visit(nodes);
    }
    for face in face_table(kind) {
        let mut own = [0; 4];
        for (own, &at) in own.iter_mut().zip(*face) {
            *own = nodes[at as usize];
        }
        visit(&own[..face.len()]);
    }
}

/// The sides of a polygon: each node with the next.
pub fn around(face: &[u32]) -> impl Iterator<Item = [u32; 2]> + '_ {
    face.iter().enumerate().map(|(at, &node)| [node, face[(at + 1) % face.len()]])
}

/// A pair with the smaller index first.
pub fn ordered([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
