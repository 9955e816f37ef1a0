//! VTK's unstructured grids in XML, as described on the page “VTK XML formats” of its documentation. All arrays are in the file, in
//! base64, which every reader of the format knows. Points and numbers have double precision.

use crate::sim::{Body, ElementKind};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use glam::DVec3;

/// Numbers of points or of cells.
pub(super) enum Column<'a> {
    Vectors(&'a str, &'a [DVec3]),
    Numbers(&'a str, &'a [f64]),
    Flags(&'a str, &'a [bool]),
}

/// The cells of a grid, which are the same in all frames.
pub(super) struct Cells {
    count: usize,
    xml: String,
}

impl Cells {
    /// The elements of a body.
    pub(super) fn of_body(body: &Body) -> Self {
        let mut lists = CellArrays::default();
        let topology = body.topology();
        for (element, (nodes, &kind)) in body.elements().iter().zip(body.kinds()).enumerate() {
            let mut faces: Vec<Vec<u32>> = Vec::new();
            if kind == ElementKind::Other {
                topology.for_each_face(element, |face| faces.push(face.to_vec()));
            }
            match (kind, &faces[..]) {
                (ElementKind::Segment, _) => lists.push(3, nodes),
                (ElementKind::Polygon, _) if nodes.len() == 4 => lists.push(9, nodes),
                (ElementKind::Polygon, _) if nodes.len() > 4 => lists.push(7, nodes),
                (ElementKind::Polygon | ElementKind::Triangle, _) => lists.push(5, nodes),
                (ElementKind::Tetrahedron, _) => lists.push(10, nodes),
                (ElementKind::Hexahedron, _) => lists.push(12, &[0, 1, 3, 2, 4, 5, 7, 6].map(|at: usize| nodes[at])),
                // The first triangle looks towards the second since VTK 9.7; before, it looked away.
                (ElementKind::Wedge, _) => lists.push(13, nodes),
                (ElementKind::Pyramid, _) => lists.push(14, nodes),
                // All nodes in a line, or in a plane.
                (ElementKind::Other, []) => lists.push(2, nodes),
                (ElementKind::Other, [face]) => lists.push(7, face),
                (ElementKind::Other, faces) => {
                    lists.push(42, nodes);
                    lists.push_faces(faces);
                }
            }
        }
        lists.finish()
    }

    /// Triangles.
    pub(super) fn of_triangles(triangles: &[[u32; 3]]) -> Self {
        let mut lists = CellArrays::default();
        triangles.iter().for_each(|triangle| lists.push(5, triangle));
        lists.finish()
    }
}

/// The arrays of cells.
#[derive(Default)]
struct CellArrays {
    connectivity: Vec<i64>,
    offsets: Vec<i64>,
    types: Vec<u8>,
    /// The number of faces of a polyhedron, then the number of nodes and the nodes of each face.
    faces: Vec<i64>,
    /// Where the faces of each cell end, -1 for cells whose type tells their faces.
    face_offsets: Vec<i64>,
}

impl CellArrays {
    /// Appends a cell of a type of VTK.
    fn push(&mut self, kind: u8, nodes: &[u32]) {
        self.connectivity.extend(nodes.iter().map(|&node| i64::from(node)));
        self.offsets.push(self.connectivity.len() as i64);
        self.types.push(kind);
        self.face_offsets.push(-1);
    }

    /// Adds the faces of the last cell.
    fn push_faces(&mut self, faces: &[Vec<u32>]) {
        self.faces.push(faces.len() as i64);
        for face in faces {
            self.faces.push(face.len() as i64);
            self.faces.extend(face.iter().map(|&node| i64::from(node)));
        }
        if let Some(last) = self.face_offsets.last_mut() {
            *last = self.faces.len() as i64;
        }
    }

    fn finish(self) -> Cells {
        let mut xml = "<Cells>\n".to_owned();
        integers(&mut xml, "connectivity", &self.connectivity);
        integers(&mut xml, "offsets", &self.offsets);
        array(&mut xml, "types", "UInt8", 1, &self.types);
        if !self.faces.is_empty() {
            integers(&mut xml, "faces", &self.faces);
            integers(&mut xml, "faceoffsets", &self.face_offsets);
        }
        xml += "</Cells>\n";
        Cells { count: self.types.len(), xml }
    }
}

/// A grid at a time (s): the positions of its points (m), its cells, and further numbers of both.
pub(super) fn document(
    mark: &str,
    time: f64,
    cells: &Cells,
    points: &[DVec3],
    of_points: &[Column<'_>],
    of_cells: &[Column<'_>],
) -> Vec<u8> {
    let mut xml = format!(
        "<?xml version=\"1.0\"?>\n<!-- {mark} -->\n\
         <VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
         <UnstructuredGrid>\n<FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" \
         format=\"ascii\">{time}</DataArray>\n</FieldData>\n\
         <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
        points.len(),
        cells.count
    );
    for (group, columns) in [("PointData", of_points), ("CellData", of_cells)] {
        xml += &format!("<{group}>\n");
        for column in columns {
            match column {
                Column::Vectors(name, vectors) => array(&mut xml, name, "Float64", 3, &vector_bytes(vectors)),
                Column::Numbers(name, numbers) => {
                    let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
                    array(&mut xml, name, "Float64", 1, &bytes);
                }
                Column::Flags(name, flags) => {
                    array(&mut xml, name, "UInt8", 1, &flags.iter().map(|&flag| u8::from(flag)).collect::<Vec<u8>>());
                }
            }
        }
        xml += &format!("</{group}>\n");
    }
    xml += "<Points>\n";
    array(&mut xml, "Points", "Float64", 3, &vector_bytes(points));
    xml += "</Points>\n";
    xml += &cells.xml;
    xml += "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
    xml.into_bytes()
}

/// Appends an array: its length in bytes and its bytes, together in base64.
fn array(xml: &mut String, name: &str, kind: &str, components: usize, bytes: &[u8]) {
    *xml +=
        &format!("<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"binary\">");
    BASE64_STANDARD.encode_string([&(bytes.len() as u64).to_le_bytes(), bytes].concat(), xml);
    *xml += "</DataArray>\n";
}

fn integers(xml: &mut String, name: &str, numbers: &[i64]) {
    array(xml, name, "Int64", 1, &numbers.iter().flat_map(|one| one.to_le_bytes()).collect::<Vec<_>>());
}

fn vector_bytes(vectors: &[DVec3]) -> Vec<u8> {
    vectors.iter().flat_map(crate::output::states::vector_bytes).collect()
}
