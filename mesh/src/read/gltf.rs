//! glTF 2.0 (<https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>): the triangles of the scene as it rests, with the transforms of
//! its nodes, the weights of morph targets and the joints of skins. Its data is inside the file or in files beside it.

mod data;
mod document;

use super::builder::Builder;
use super::source::Source;
use super::{Beside, Cells, Limits, ReadError};
use data::Lists;
use glam::{DMat4, DQuat, DVec3, DVec4};
use gltf::mesh::Mode;
use gltf::scene::Transform;
use gltf::{Document, Node, Primitive, Semantic, Skin};

pub(super) fn read(bytes: &[u8], limits: &Limits, beside: &mut Beside<'_>) -> Result<Cells, ReadError> {
    let (document, blob, is_hidden) = document::read(bytes)?;
    let mut scene = Scene {
        lists: Lists::new(&document, blob, beside, limits)?,
        builder: Builder::new(limits),
        places: vec![None; document.nodes().len()],
    };
    let nodes = scene.place(&document, &is_hidden)?;
    nodes.iter().try_for_each(|node| scene.add(node))?;
    if scene.builder.is_empty() {
        let (message, help) = match scene.builder.cells.notes.is_empty() {
            true => (
                "no node of its scene has a mesh of triangles",
                "make the scene with meshes the default `scene`, or export it again",
            ),
            false => ("its meshes are hidden (KHR_node_visibility)", "make them visible, and export it again"),
        };
        return Err(ReadError::new(format!("shows nothing: {message}"), help));
    }
    scene.builder.finish(&Source::text(b""), 0)
}

/// The scene that a file shows.
struct Scene<'b> {
    lists: Lists<'b>,
    builder: Builder,
    /// The transform of each node of the scene with those above it.
    places: Vec<Option<DMat4>>,
}

impl Scene<'_> {
    /// The nodes of the scene that are not hidden in the order of the tree, with the places of all noted.
    fn place<'d>(&mut self, document: &'d Document, is_hidden: &[bool]) -> Result<Vec<Node<'d>>, ReadError> {
        // The nodes to visit, the next last, with the transform of what is above them and whether that is shown.
        let mut next: Vec<(Node<'_>, DMat4, bool)> = Vec::new();
        let root = |node| (node, DMat4::IDENTITY, true);
        match document.default_scene().or_else(|| document.scenes().next()) {
            Some(scene) => next.extend(scene.nodes().map(root)),
            None => {
                let mut is_root = vec![true; document.nodes().len()];
                document.nodes().flat_map(|node| node.children()).for_each(|child| is_root[child.index()] = false);
                next.extend(document.nodes().filter(|node| is_root[node.index()]).map(root));
            }
        }
        next.reverse();
        let (mut nodes, mut hidden) = (Vec::new(), 0);
        while let Some((node, above, is_above_shown)) = next.pop() {
            let is_shown = is_above_shown && is_hidden.get(node.index()) != Some(&true);
            let place = above * matrix(node.transform());
            if self.places[node.index()].replace(place).is_some() {
                let message = format!("has the node {} below two others, or below itself", node.index());
                return Err(ReadError::damaged(message));
            }
            let children: Vec<_> = node.children().map(|child| (child, place, is_shown)).collect();
            next.extend(children.into_iter().rev());
            if is_shown {
                nodes.push(node);
            } else {
                hidden += usize::from(node.mesh().is_some());
            }
        }
        if hidden > 0 {
            let note = format!("has meshes that it hides (KHR_node_visibility), which are left out: {hidden}");
            self.builder.cells.notes.push(note);
        }
        Ok(nodes)
    }

    /// Adds the mesh of a node.
    fn add(&mut self, node: &Node<'_>) -> Result<(), ReadError> {
        let Some(mesh) = node.mesh() else { return Ok(()) };
        let place = self.places[node.index()].unwrap_or_default();
        let joints = node.skin().map(|skin| self.joints(&skin)).transpose()?;
        let weights = node.weights().or(mesh.weights()).unwrap_or_default();
        mesh.primitives().try_for_each(|primitive| self.triangles(&primitive, place, joints.as_deref(), weights))
    }

    /// The matrices by which the joints of a skin place its points.
    fn joints(&mut self, skin: &Skin<'_>) -> Result<Vec<DMat4>, ReadError> {
        let (index, count) = (skin.index(), skin.joints().count());
        let inverse: Vec<_> = match skin.inverse_bind_matrices() {
            // As many as joints, which are nodes, or some more.
            Some(list) => self.lists.numbers(&list, 16, 4 * self.places.len())?,
            None => DMat4::IDENTITY.to_cols_array().repeat(count),
        };
        if inverse.len() < 16 * count {
            let found = inverse.len() / 16;
            let message = format!("has {found} inverse matrices for {count} joints of its skin {index}");
            return Err(ReadError::damaged(message));
        }
        let matrix = |(joint, inverse): (Node<'_>, &[f64])| {
            let place = self.places[joint.index()].ok_or_else(|| {
                let message = format!("has the joint {} of its skin {index} outside of its scene", joint.index());
                ReadError::new(message, "export it again with its skeleton, or with the pose applied to the mesh")
            })?;
            Ok(place * DMat4::from_cols_slice(inverse))
        };
        skin.joints().zip(inverse.chunks_exact(16)).map(matrix).collect()
    }

    /// The positions of the points of a part, moved by morph targets.
    fn positions(&mut self, primitive: &Primitive<'_>, weights: &[f32]) -> Result<Vec<DVec3>, ReadError> {
        let Some(list) = primitive.get(&Semantic::Positions) else { return Ok(Vec::new()) };
        let mut positions = self.lists.vectors(&list)?;
        for (target, &weight) in primitive.morph_targets().zip(weights).filter(|(_, weight)| **weight != 0.0) {
            let Some(moves) = target.positions().map(|list| self.lists.vectors(&list)).transpose()? else { continue };
            if moves.len() != positions.len() {
                let [found, expected] = [&moves, &positions].map(Vec::len);
                let message = format!("has a morph target of {found} points for a part with {expected}");
                return Err(ReadError::damaged(message));
            }
            positions.iter_mut().zip(moves).for_each(|(position, moves)| *position += f64::from(weight) * moves);
        }
        Ok(positions)
    }

    /// The points of a part of a skin, each at the mean of where its joints bring it, and whether they mirror the first. `None` if it
    /// names no joints.
    fn skinned(
        &mut self,
        primitive: &Primitive<'_>,
        joints: &[DMat4],
        points: &[DVec3],
    ) -> Result<Option<(Vec<DVec3>, bool)>, ReadError> {
        let (most, mut sums, mut turn) = (self.lists.limits.points, Vec::new(), 0.0);
        for set in 0.. {
            let lists = [Semantic::Joints(set), Semantic::Weights(set)].map(|semantic| primitive.get(&semantic));
            let [Some(indices), Some(weights)] = lists else { break };
            let (indices, weights) = (self.lists.numbers(&indices, 4, most)?, self.lists.numbers(&weights, 4, most)?);
            sums.resize(points.len(), DVec4::ZERO);
            let each = indices.iter().zip(&weights).take(4 * points.len()).enumerate();
            for (at, (&index, &weight)) in each.filter(|(_, (_, weight))| **weight != 0.0) {
                let Some(joint) = joints.get(index as usize) else {
                    let message = format!("names joint {index} of a skin with {} joints", joints.len());
                    return Err(ReadError::damaged(message));
                };
                sums[at / 4] += weight * joint.transform_point3(points[at / 4]).extend(1.0);
                turn += if at < 4 { weight * joint.determinant() } else { 0.0 };
            }
        }
        if let Some(at) = sums.iter().position(|sum| sum.w <= 0.0) {
            let message = format!("has point {at} of a part without weights, which its skin needs");
            return Err(ReadError::new(message, "export it again with weights for all points, or without its skin"));
        }
        let points = || sums.iter().map(|sum| sum.truncate() / sum.w).collect();
        Ok((!sums.is_empty()).then(|| (points(), turn < 0.0)))
    }

    /// Adds the triangles of a part of a mesh. Points and lines are left out.
    fn triangles(
        &mut self,
        primitive: &Primitive<'_>,
        place: DMat4,
        joints: Option<&[DMat4]>,
        weights: &[f32],
    ) -> Result<(), ReadError> {
        let mode = primitive.mode();
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            return Ok(());
        }
        let positions = self.positions(primitive, weights)?;
        let (first, count) = (self.builder.points(), positions.len());
        self.builder.expect((first + count) as u64, 0)?;
        // Joints place a mesh, whatever the node that has it.
        let skinned = joints.map_or(Ok(None), |joints| self.skinned(primitive, joints, &positions))?;
        let (positions, is_mirrored) = skinned.unwrap_or_else(|| {
            (positions.iter().map(|&point| place.transform_point3(point)).collect(), place.determinant() < 0.0)
        });
        positions.into_iter().try_for_each(|point| self.builder.point(point).map(drop))?;
        let corners: Vec<usize> = match primitive.indices() {
            Some(list) => {
                let indices = self.lists.numbers(&list, 1, self.lists.limits.corners)?;
                indices.into_iter().map(|index| index as usize).collect()
            }
            None => (0..count).collect(),
        };
        if let Some(index) = corners.iter().find(|index| **index >= count) {
            return Err(ReadError::damaged(format!("names point {index} of a part with {count} points")));
        }
        let places = |at: usize| match mode {
            Mode::TriangleStrip if at.is_multiple_of(2) => [at, at + 1, at + 2],
            Mode::TriangleStrip => [at + 1, at, at + 2],
            Mode::TriangleFan => [0, at + 1, at + 2],
            _ => [3 * at, 3 * at + 1, 3 * at + 2],
        };
        let triangles = if mode == Mode::Triangles { corners.len() / 3 } else { corners.len().saturating_sub(2) };
        (0..triangles).try_for_each(|at| {
            let [a, b, c] = places(at).map(|place| (first + corners[place]) as u32);
            // A mirrored part is turned over.
            self.builder.face(&if is_mirrored { [a, c, b] } else { [a, b, c] })
        })
    }
}

fn matrix(transform: Transform) -> DMat4 {
    match transform {
        Transform::Matrix { matrix } => DMat4::from_cols_array_2d(&matrix.map(|column| column.map(f64::from))),
        Transform::Decomposed { translation, rotation, scale } => {
            let rotation = DQuat::from_array(rotation.map(f64::from));
            let length = rotation.length_squared();
            let rotation = if length > 0.0 && length.is_finite() { rotation.normalize() } else { DQuat::IDENTITY };
            let [scale, translation] = [scale, translation].map(|vector| DVec3::from(vector.map(f64::from)));
            DMat4::from_scale_rotation_translation(scale, rotation, translation)
        }
    }
}
