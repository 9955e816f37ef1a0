//! glTF 2.0: the triangles of the scene, with the transforms of its nodes. The data must be inside the file, as in `.glb` or as
//! Base64 in `.gltf`.

use super::cells::Builder;
use super::source::{CUT, DAMAGED, Source, quoted};
use super::{Cells, Limits, ReadError};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::{DMat4, DQuat, DVec3};
use gltf::accessor::DataType;
use gltf::buffer::{Source as Data, View};
use gltf::json::validation::{Error, Validate};
use gltf::mesh::Mode;
use gltf::scene::Transform;
use gltf::{Accessor, Document, Node, Primitive, Semantic};
use std::borrow::Cow;

pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Cells, ReadError> {
    let (document, blob) = document(bytes)?;
    let buffers = document.buffers().map(|buffer| data(&buffer, blob.as_deref())).collect::<Result<Vec<_>, _>>()?;
    let mut builder = Builder::new(limits);
    // The nodes to visit, the next last.
    let mut nodes: Vec<(Node<'_>, DMat4)> = Vec::new();
    match document.default_scene().or_else(|| document.scenes().next()) {
        Some(scene) => nodes.extend(scene.nodes().map(|node| (node, DMat4::IDENTITY))),
        None => {
            let mut is_root = vec![true; document.nodes().len()];
            document.nodes().flat_map(|node| node.children()).for_each(|child| is_root[child.index()] = false);
            nodes.extend(document.nodes().filter(|node| is_root[node.index()]).map(|node| (node, DMat4::IDENTITY)));
        }
    }
    nodes.reverse();
    let mut is_visited = vec![false; document.nodes().len()];
    while let Some((node, above)) = nodes.pop() {
        if std::mem::replace(&mut is_visited[node.index()], true) {
            let message = format!("has the node {} below two others, or below itself", node.index());
            return Err(ReadError::new(message, DAMAGED));
        }
        let transform = above * matrix(node.transform());
        if let Some(mesh) = node.mesh() {
            for primitive in mesh.primitives() {
                triangles(&primitive, transform, &buffers, limits, &mut builder)?;
            }
        }
        let children: Vec<_> = node.children().map(|child| (child, transform)).collect();
        nodes.extend(children.into_iter().rev());
    }
    builder.finish(&Source::text(b""), 0)
}

/// The validated structure of a file, and the binary data of a `.glb`.
fn document(bytes: &[u8]) -> Result<(Document, Option<Vec<u8>>), ReadError> {
    /// The length of the header of a `.glb`, which the length in it includes.
    const HEADER: u32 = 12;
    if bytes.starts_with(b"glTF") {
        let length = bytes.get(8..).and_then(|rest| rest.first_chunk()).map(|length| u32::from_le_bytes(*length));
        if length.is_none_or(|length| length < HEADER) {
            return Err(ReadError::new("ends in its header of 12 bytes", CUT));
        }
        if bytes[4..8] == 1u32.to_le_bytes() {
            return Err(old());
        }
    }
    let no = |text: String| {
        let text = text.replace(['\n', '\r'], " ");
        ReadError::new(format!("is no sound glTF 2.0 file: {text}"), DAMAGED)
    };
    let found = gltf::Gltf::from_slice_without_validation(bytes);
    let found = found.map_err(|error| if is_old(bytes) { old() } else { no(error.to_string()) })?;
    let json = found.document.into_json();
    if json.asset.version.starts_with("1.") {
        return Err(old());
    }
    // Points packed by these cannot be read. Other extensions concern materials and lights.
    let packed = |name: &&String| ["KHR_draco_mesh_compression", "EXT_meshopt_compression"].contains(&name.as_str());
    if let Some(name) = json.extensions_required.iter().find(packed) {
        let message = format!("has its mesh packed by {}; expected plain data", quoted(name.as_bytes()));
        return Err(ReadError::new(message, "export it again without compression"));
    }
    // The validation looks up the lists of attributes before it checks that they are there.
    let lists = json.accessors.len();
    let mut attributes = json.meshes.iter().flat_map(|mesh| &mesh.primitives).flat_map(|part| part.attributes.values());
    if let Some(list) = attributes.find(|list| list.value() >= lists) {
        return Err(no(format!("a mesh names the list {} of {lists}", list.value())));
    }
    let mut first = None;
    json.validate(&json, gltf::json::Path::new, &mut |path, error| {
        let path = path().to_string();
        // Boxes around points are not needed, and often left out.
        let is_needed = !path.ends_with(".min") && !path.ends_with(".max") && error != Error::Unsupported;
        if is_needed && first.is_none() {
            first = Some(format!("{path}: {error}"));
        }
    });
    match first {
        Some(error) => Err(no(error)),
        None => Ok((Document::from_json_without_validation(json), found.blob)),
    }
}

/// Whether a file that is not read as version 2.0 is one of version 1.0, which names things where 2.0 numbers them.
fn is_old(bytes: &[u8]) -> bool {
    let value: gltf::json::Value = gltf::json::deserialize::from_slice(bytes).unwrap_or_default();
    let version = value.get("asset").and_then(|asset| asset.get("version")).and_then(|version| version.as_str());
    let are_named = ["meshes", "nodes"].iter().any(|key| value.get(key).is_some_and(gltf::json::Value::is_object));
    are_named || version.is_some_and(|version| version.starts_with('1'))
}

fn old() -> ReadError {
    ReadError::new("is a glTF 1.0 file; expected 2.0", "export it again as glTF 2.0 (.glb)")
}

/// The data of a buffer. Only the first may be the binary data of the file.
fn data<'b>(buffer: &gltf::Buffer<'_>, blob: Option<&'b [u8]>) -> Result<Cow<'b, [u8]>, ReadError> {
    let index = buffer.index();
    match buffer.source() {
        Data::Bin if index == 0 => {
            blob.map(Cow::Borrowed).ok_or_else(|| ReadError::new("ends before its binary data", CUT))
        }
        Data::Bin => Err(ReadError::new(format!("has no data for its buffer {index}"), DAMAGED)),
        Data::Uri(uri) => match uri.strip_prefix("data:").and_then(|data| data.split_once(";base64,")) {
            Some((_, text)) => STANDARD
                .decode(text.trim())
                .map(Cow::Owned)
                .map_err(|error| ReadError::new(format!("has damaged Base64 in its buffer {index}: {error}"), DAMAGED)),
            None => {
                let message = format!("has its data in another file, {}; expected data inside", quoted(uri.as_bytes()));
                Err(ReadError::new(message, "export it as one file, `.glb`"))
            }
        },
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

/// Adds the triangles of a part of a mesh. Points and lines are left out.
fn triangles(
    primitive: &Primitive<'_>,
    transform: DMat4,
    buffers: &[Cow<'_, [u8]>],
    limits: &Limits,
    builder: &mut Builder<'_>,
) -> Result<(), ReadError> {
    if !matches!(primitive.mode(), Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
        return Ok(());
    }
    let Some(positions) = primitive.get(&Semantic::Positions) else { return Ok(()) };
    let first = builder.points();
    builder.expect((first + positions.count()) as u64, 0)?;
    for point in numbers(&positions, 3, buffers, limits.points)?.chunks_exact(3) {
        builder.point(transform.transform_point3(DVec3::new(point[0], point[1], point[2])))?;
    }
    let count = builder.points() - first;
    let corner = |index: usize| match index < count {
        true => Ok((first + index) as u32),
        false => {
            let message = format!("names point {index} of a part with {count} points");
            Err(ReadError::new(message, DAMAGED))
        }
    };
    let corners = match primitive.indices() {
        Some(indices) => {
            let indices = numbers(&indices, 1, buffers, limits.corners)?;
            indices.into_iter().map(|index| corner(index as usize)).collect::<Result<Vec<_>, _>>()?
        }
        None => (0..count).map(corner).collect::<Result<Vec<_>, _>>()?,
    };
    // A mirrored part is turned over.
    let is_mirrored = transform.determinant() < 0.0;
    let mut add = |[a, b, c]: [u32; 3]| builder.face(&if is_mirrored { [a, c, b] } else { [a, b, c] });
    match primitive.mode() {
        Mode::TriangleStrip => {
            let turned = |(at, list): (usize, &[u32])| match at % 2 {
                0 => [list[0], list[1], list[2]],
                _ => [list[1], list[0], list[2]],
            };
            corners.windows(3).enumerate().map(turned).try_for_each(add)
        }
        Mode::TriangleFan => (2..corners.len()).try_for_each(|at| add([corners[0], corners[at - 1], corners[at]])),
        _ => corners.chunks_exact(3).try_for_each(|list| add([list[0], list[1], list[2]])),
    }
}

/// The numbers of a list with so many in each row.
fn numbers(
    accessor: &Accessor<'_>,
    columns: usize,
    buffers: &[Cow<'_, [u8]>],
    most: usize,
) -> Result<Vec<f64>, ReadError> {
    let (index, count) = (accessor.index(), accessor.count());
    if count > most {
        let message = format!("has {count} entries in its list {index}; at most {most} are read");
        return Err(ReadError::new(message, "make the mesh coarser, with a decimation of the program that wrote it"));
    }
    if accessor.dimensions().multiplicity() != columns {
        let found = accessor.dimensions().multiplicity();
        let message = format!("has {found} numbers in each entry of its list {index}; expected {columns}");
        return Err(ReadError::new(message, DAMAGED));
    }
    let kind = accessor.data_type();
    // Integers may stand for the numbers from −1 or 0 to 1.
    let scale = match kind {
        _ if !accessor.normalized() => 1.0,
        DataType::I8 => 1.0 / 127.0,
        DataType::U8 => 1.0 / 255.0,
        DataType::I16 => 1.0 / 32767.0,
        DataType::U16 => 1.0 / 65535.0,
        DataType::U32 | DataType::F32 => 1.0,
    };
    let mut all = match accessor.view() {
        Some(view) => rows(&view, accessor.offset(), count, columns, kind, buffers)?,
        None => vec![0.0; count * columns],
    };
    if let Some(sparse) = accessor.sparse() {
        let (indices, values) = (sparse.indices(), sparse.values());
        let kind_of_index = match indices.index_type() {
            gltf::accessor::sparse::IndexType::U8 => DataType::U8,
            gltf::accessor::sparse::IndexType::U16 => DataType::U16,
            gltf::accessor::sparse::IndexType::U32 => DataType::U32,
        };
        let count = sparse.count().min(most);
        let places = rows(&indices.view(), indices.offset(), count, 1, kind_of_index, buffers)?;
        let values = rows(&values.view(), values.offset(), count, columns, kind, buffers)?;
        for (place, value) in places.into_iter().zip(values.chunks_exact(columns)) {
            let start = place as usize * columns;
            let row = all.get_mut(start..start + columns).ok_or_else(|| {
                ReadError::new(format!("changes entry {place} of its list {index}, which has fewer"), DAMAGED)
            })?;
            row.copy_from_slice(value);
        }
    }
    all.iter_mut().for_each(|value| *value *= scale);
    Ok(all)
}

/// The numbers of a part of a buffer.
fn rows(
    view: &View<'_>,
    offset: usize,
    count: usize,
    columns: usize,
    kind: DataType,
    buffers: &[Cow<'_, [u8]>],
) -> Result<Vec<f64>, ReadError> {
    let size = kind.size() * columns;
    let stride = view.stride().unwrap_or(size);
    let bytes = || {
        let start = view.offset();
        let part = buffers.get(view.buffer().index())?.get(start..start.checked_add(view.length())?)?.get(offset..)?;
        let length = match count {
            0 => 0,
            _ => stride.checked_mul(count - 1)?.checked_add(size)?,
        };
        part.get(..length)
    };
    let bytes = bytes().ok_or_else(|| {
        ReadError::new(format!("has data beyond the end of its buffer {}", view.buffer().index()), CUT)
    })?;
    let mut numbers = Vec::with_capacity(count * columns);
    for row in 0..count {
        for column in 0..columns {
            let at = row * stride + column * kind.size();
            let [a, b, c, d] = std::array::from_fn(|byte| bytes.get(at + byte).copied().unwrap_or(0));
            numbers.push(match kind {
                DataType::I8 => i8::from_le_bytes([a]).into(),
                DataType::U8 => a.into(),
                DataType::I16 => i16::from_le_bytes([a, b]).into(),
                DataType::U16 => u16::from_le_bytes([a, b]).into(),
                DataType::U32 => u32::from_le_bytes([a, b, c, d]).into(),
                DataType::F32 => f32::from_le_bytes([a, b, c, d]).into(),
            });
        }
    }
    Ok(numbers)
}
