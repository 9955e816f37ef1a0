//! glTF 2.0 in one binary file: one for each run, with a mesh for each body. The nodes of the body are the joints of a skin, and an
//! animation moves them: a point at X that follows joints i with weights w is at Σ w (X − Xᵢ + xᵢ), as the body carries it.
//! Numbers have single precision, as the format has.

use super::course::Course;
use super::influence::{self, MOST};
use super::narrow::{single, singles};
use super::surface::Surface;
use super::{FilesOf, OfBody};
use crate::sim::geometry::bounds;
use glam::DVec3;
use rayon::prelude::*;
use std::fmt::Write as _;
use std::io::{self, Write};

/// The most nodes of a body: joints are numbered by 16 bits.
pub(super) const MOST_NODES: usize = 65_535;
/// Bytes of motions that are arranged at once.
const AT_ONCE: usize = 1 << 26;

const VERTICES: &str = ",\"target\":34962";
const INDICES: &str = ",\"target\":34963";
const FLOAT: u32 = 5126;
const SHORT: u32 = 5123;
const INT: u32 = 5125;

/// The least length of the file of a run with so many frames (bytes).
pub(super) fn least_length(bodies: impl Iterator<Item = usize>, frames: usize) -> u64 {
    bodies.map(|nodes| 12 * nodes as u64 * frames as u64).sum()
}

/// The document and the blocks of binary data before the motions, in the order of their places in the file.
#[derive(Default)]
struct Document {
    nodes: Vec<String>,
    roots: Vec<usize>,
    meshes: Vec<String>,
    skins: Vec<String>,
    accessors: Vec<String>,
    views: Vec<String>,
    samplers: Vec<String>,
    channels: Vec<String>,
    /// The length of the binary data so far, with motions.
    length: u64,
    blocks: Vec<Chunk>,
}

/// A piece of the binary data.
enum Chunk {
    Bytes(Vec<u8>),
    /// The motions of the nodes of a body.
    Motions(usize),
}

impl Document {
    /// Appends binary data, and returns the number of its view.
    fn view(&mut self, block: Chunk, length: u64, target: &str) -> usize {
        let view = format!("{{\"buffer\":0,\"byteOffset\":{},\"byteLength\":{length}{target}}}", self.length);
        self.views.push(view);
        self.length += length;
        self.blocks.push(block);
        self.views.len() - 1
    }

    /// Appends an array of its own, and returns its number. `more` are further properties.
    fn array(&mut self, bytes: Vec<u8>, target: &str, component: u32, kind: &str, count: usize, more: &str) -> usize {
        let length = bytes.len() as u64;
        let view = self.view(Chunk::Bytes(bytes), length, target);
        self.accessor(view, 0, component, kind, count, more)
    }

    fn accessor(&mut self, view: usize, offset: u64, component: u32, kind: &str, count: usize, more: &str) -> usize {
        self.accessors.push(format!(
            "{{\"bufferView\":{view},\"byteOffset\":{offset},\"componentType\":{component},\"count\":{count},\
             \"type\":\"{kind}\"{more}}}"
        ));
        self.accessors.len() - 1
    }

    /// Appends a body: a mesh, its skin, and the motions of its joints at the times in the array `times`.
    fn body(&mut self, place: usize, body: &OfBody<Surface>, times: usize, frames: usize) {
        let (name, surface) = (body.title(), &body.shown);
        let (rest, joints) = (surface.body.rest(), surface.body.len());
        let name = serde_json::to_string(name).expect("a text");
        let points = surface.carried.as_ref().map_or(rest, |carried| &carried.rest);
        let (low, high) = bounds(points);
        let ends = |ends: DVec3| serde_json::to_string(&singles(ends).map(f64::from)).expect("numbers");
        let range = format!(",\"min\":{},\"max\":{}", ends(low), ends(high));
        let at =
            self.array(floats(points.iter().copied().flat_map(singles)), VERTICES, FLOAT, "VEC3", points.len(), &range);
        let followed: Vec<_> = match &surface.carried {
            None => (0..joints as u32).map(|node| vec![(node, 1.0)]).collect(),
            Some(carried) => {
                (0..points.len()).into_par_iter().map(|point| influence::of(carried, point, rest)).collect()
            }
        };
        let four = |of: &Vec<(u32, f64)>| -> [(u32, f64); MOST] {
            std::array::from_fn(|at| of.get(at).copied().unwrap_or_default())
        };
        let numbers = followed.iter().flat_map(four).flat_map(|(node, _)| (node as u16).to_le_bytes()).collect();
        let numbers = self.array(numbers, VERTICES, SHORT, "VEC4", points.len(), "");
        let weights = floats(followed.iter().flat_map(four).map(|(_, weight)| single(weight)));
        let weights = self.array(weights, VERTICES, FLOAT, "VEC4", points.len(), "");
        let attributes = format!(
            "\"attributes\":{{\"POSITION\":{at},\"JOINTS_0\":{numbers},\"WEIGHTS_0\":{weights}}},\"material\":0"
        );
        let mut primitives = Vec::new();
        let triangles =
            surface.faces.iter().flat_map(|face| (2..face.len()).flat_map(|at| [face[0], face[at - 1], face[at]]));
        let lines = surface.lines.iter().flatten().copied();
        for (mode, indices) in [(4, triangles.collect::<Vec<_>>()), (1, lines.collect())] {
            if !indices.is_empty() {
                let bytes = indices.iter().flat_map(|index| index.to_le_bytes()).collect();
                let array = self.array(bytes, INDICES, INT, "SCALAR", indices.len(), "");
                primitives.push(format!("{{{attributes},\"indices\":{array},\"mode\":{mode}}}"));
            }
        }
        if primitives.is_empty() {
            primitives.push(format!("{{{attributes},\"mode\":0}}"));
        }
        self.meshes.push(format!("{{\"name\":{name},\"primitives\":[{}]}}", primitives.join(",")));

        let back = |at: &DVec3| {
            let [x, y, z] = singles(-*at);
            [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, z, 1.0]
        };
        let back = self.array(floats(rest.iter().flat_map(back)), "", FLOAT, "MAT4", joints, "");
        let (mesh, skin, parent) = (self.meshes.len() - 1, self.skins.len(), self.nodes.len());
        let first = parent + 2;
        let all = list(first..first + joints);
        self.skins.push(format!("{{\"inverseBindMatrices\":{back},\"skeleton\":{parent},\"joints\":{all}}}"));
        self.nodes.push(format!("{{\"name\":\"nodes\",\"children\":{all}}}"));
        self.nodes.push(format!("{{\"name\":{name},\"mesh\":{mesh},\"skin\":{skin}}}"));
        self.roots.extend([parent, parent + 1]);
        let length = 12 * frames as u64;
        let view = self.view(Chunk::Motions(place), length * joints as u64, "");
        for (joint, at) in rest.iter().enumerate() {
            self.nodes.push(format!("{{\"translation\":{}}}", ends(*at)));
            let motion = self.accessor(view, length * joint as u64, FLOAT, "VEC3", frames, "");
            self.channels.push(format!(
                "{{\"sampler\":{},\"target\":{{\"node\":{},\"path\":\"translation\"}}}}",
                self.samplers.len(),
                first + joint
            ));
            self.samplers.push(format!("{{\"input\":{times},\"output\":{motion}}}"));
        }
    }

    /// The text of the document, whose length is a multiple of four bytes.
    fn text(&self, mark: &str, name: &str) -> String {
        let name = serde_json::to_string(name).expect("a text");
        let mut text = format!(
            "{{\"asset\":{{\"version\":\"2.0\",\"generator\":\"{mark}\"}},\"scene\":0,\"scenes\":[{{\"name\":{name},\"nodes\":{}}}],\
             \"materials\":[{{\"doubleSided\":true,\"pbrMetallicRoughness\":{{\"metallicFactor\":0}}}}],",
            list(self.roots.iter().copied())
        );
        for (key, entries) in [
            ("nodes", &self.nodes),
            ("meshes", &self.meshes),
            ("skins", &self.skins),
            ("accessors", &self.accessors),
            ("bufferViews", &self.views),
        ] {
            write!(text, "\"{key}\":[{}],", entries.join(",")).expect("writing to a string");
        }
        let (channels, samplers) = (self.channels.join(","), self.samplers.join(","));
        write!(
            text,
            "\"animations\":[{{\"name\":{name},\"channels\":[{channels}],\"samplers\":[{samplers}]}}],\
             \"buffers\":[{{\"byteLength\":{}}}]}}",
            self.length
        )
        .expect("writing to a string");
        let padded = text.len().next_multiple_of(4);
        text.extend(std::iter::repeat_n(' ', padded - text.len()));
        text
    }
}

/// Writes a run.
///
/// # Errors
/// If the file would be longer than the format allows, or cannot be written.
pub(super) fn write(
    to: &mut impl Write,
    (mark, name): (&str, &str),
    run: &FilesOf<Surface>,
    course: &mut Course<'_>,
) -> io::Result<()> {
    let frames = course.times.len();
    let mut document = Document::default();
    let [first, last] = [course.times[0], course.times[frames - 1]].map(|time| f64::from(single(time)));
    let range = format!(",\"min\":[{first}],\"max\":[{last}]");
    let times = floats(course.times.iter().map(|&time| single(time)));
    let times = document.array(times, "", FLOAT, "SCALAR", frames, &range);
    run.bodies.iter().enumerate().for_each(|(place, body)| document.body(place, body, times, frames));
    let text = document.text(mark, name);
    let total = 12 + 8 + text.len() as u64 + 8 + document.length;
    let short = |length: u64| u32::try_from(length).map_err(|_| io::ErrorKind::FileTooLarge);
    to.write_all(b"glTF")?;
    for number in [2, short(total)?, short(text.len() as u64)?] {
        to.write_all(&number.to_le_bytes())?;
    }
    to.write_all(b"JSON")?;
    to.write_all(text.as_bytes())?;
    to.write_all(&short(document.length)?.to_le_bytes())?;
    to.write_all(b"BIN\0")?;
    for block in &document.blocks {
        match block {
            Chunk::Bytes(bytes) => to.write_all(bytes)?,
            Chunk::Motions(place) => motions(to, &run.bodies[*place], course)?,
        }
    }
    Ok(())
}

/// Writes the positions of each node in all frames, node after node.
fn motions(to: &mut impl Write, body: &OfBody<Surface>, course: &mut Course<'_>) -> io::Result<()> {
    let (nodes, frames) = (body.nodes.clone(), course.times.len());
    let at_once = (AT_ONCE / (12 * frames)).max(1);
    for first in nodes.clone().step_by(at_once) {
        let some = first..nodes.end.min(first + at_once);
        let mut by_node = vec![[0.0_f32; 3]; some.len() * frames];
        for frame in 0..frames {
            for (node, at) in course.read("position", frame, &some)?.into_iter().enumerate() {
                by_node[node * frames + frame] = singles(at);
            }
        }
        to.write_all(&floats(by_node.into_iter().flatten()))?;
    }
    Ok(())
}

fn floats(numbers: impl Iterator<Item = f32>) -> Vec<u8> {
    numbers.flat_map(f32::to_le_bytes).collect()
}

/// A list of numbers.
fn list(numbers: impl Iterator<Item = usize>) -> String {
    format!("[{}]", numbers.map(|number| number.to_string()).collect::<Vec<_>>().join(","))
}
