//! The structure of a glTF file, validated.

use super::super::source::{CUT, DAMAGED, quoted};
use super::super::{Format, ReadError, content};
use gltf::Document;
use gltf::binary::Glb;
use gltf::json::deserialize::{from_slice, from_value};
use gltf::json::validation::{Error, Validate};
use gltf::json::{Root, Value};
use std::borrow::Cow;
use std::collections::BTreeSet;

/// The structure of a file, the binary data of a `.glb`, and whether each node is hidden.
type Parts<'b> = (Document, Option<Cow<'b, [u8]>>, Vec<bool>);

pub(super) fn read(bytes: &[u8]) -> Result<Parts<'_>, ReadError> {
    /// The length of the header of a `.glb`, which the length in it includes.
    const HEADER: u32 = 12;
    let no = |text: String| {
        let text = text.replace(['\n', '\r'], " ");
        ReadError::new(format!("is no sound glTF 2.0 file: {text}"), DAMAGED)
    };
    let (text, blob) = if bytes.starts_with(b"glTF") {
        let length = bytes.get(8..).and_then(|rest| rest.first_chunk()).map(|length| u32::from_le_bytes(*length));
        if length.is_none_or(|length| length < HEADER) {
            return Err(ReadError::new("ends in its header of 12 bytes", CUT));
        }
        if bytes[4..8] == 1u32.to_le_bytes() {
            return Err(old());
        }
        let Glb { json, bin, .. } = Glb::from_slice(bytes).map_err(|error| no(error.to_string()))?;
        (json, bin)
    } else {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        if !text.trim_ascii_start().starts_with(b"{") {
            return Err(content::no_beginning(bytes, Format::Gltf, "`{` or `glTF`"));
        }
        (Cow::Borrowed(text), None)
    };
    let mut value: Value = from_slice(&text).map_err(|error| match error.is_eof() {
        true => ReadError::new("ends in its JSON", CUT),
        false => no(error.to_string()),
    })?;
    check_version(&value)?;
    let is_hidden = value.get("nodes").and_then(Value::as_array).into_iter().flatten().map(is_hidden).collect();
    // Scenes may leave out their lists of nodes.
    for scene in value.get_mut("scenes").and_then(Value::as_array_mut).into_iter().flatten() {
        if let Some(scene) = scene.as_object_mut() {
            scene.entry("nodes").or_insert(Value::Array(Vec::new()));
        }
    }
    let root: Root = from_value(value).map_err(|error| no(error.to_string()))?;
    check_extensions(&root)?;
    // The validation looks up the lists of attributes before it checks that they are there.
    let lists = root.accessors.len();
    let mut attributes = root.meshes.iter().flat_map(|mesh| &mesh.primitives).flat_map(|part| part.attributes.values());
    if let Some(list) = attributes.find(|list| list.value() >= lists) {
        return Err(no(format!("a mesh names the list {} of {lists}", list.value())));
    }
    let mut first = None;
    root.validate(&root, gltf::json::Path::new, &mut |path, error| {
        let path = path().to_string();
        // Boxes around points are not needed, and often left out.
        let is_needed = !path.ends_with(".min") && !path.ends_with(".max") && error != Error::Unsupported;
        if is_needed && first.is_none() {
            first = Some(format!("{path}: {error}"));
        }
    });
    match first {
        Some(error) => Err(no(error)),
        None => Ok((Document::from_json_without_validation(root), blob, is_hidden)),
    }
}

/// Refuses a file that needs what is not read here.
fn check_extensions(root: &Root) -> Result<(), ReadError> {
    /// Those about looks and data, which change no place of a point, and those for coordinates as integers and for hidden nodes.
    const READ: &str = "KHR_mesh_quantization KHR_node_visibility KHR_lights_ KHR_materials_ KHR_texture_ KHR_xmp EXT_lights_ \
                        EXT_mesh_features EXT_structural_metadata EXT_texture_ MSFT_texture_";
    // A scene without its copies is another, although the format leaves them to the reader if they are only used.
    let copies = root.extensions_used.iter().filter(|name| *name == "EXT_mesh_gpu_instancing");
    let is_read = |name: &&String| READ.split(' ').any(|read| name.starts_with(read));
    let needed = root.extensions_required.iter().filter(|name| !is_read(name)).chain(copies);
    let names: BTreeSet<_> = needed.map(|name| quoted(name.as_bytes())).collect();
    if names.is_empty() {
        return Ok(());
    }
    let message = format!("needs extensions that are not read: {}", Vec::from_iter(names).join(", "));
    Err(ReadError::new(
        message,
        "export it again without compression and extensions, and with copies as meshes of their own",
    ))
}

/// Whether a node is hidden with all below it (`KHR_node_visibility`).
fn is_hidden(node: &Value) -> bool {
    let extension = node.get("extensions").and_then(|extensions| extensions.get("KHR_node_visibility"));
    extension.and_then(|extension| extension.get("visible")).and_then(Value::as_bool) == Some(false)
}

/// Refuses a file of version 1.0, which names things where 2.0 numbers them, and one that needs a later version. Those of 2.1 and later may
/// be read as 2.0 if they do not say otherwise.
fn check_version(value: &Value) -> Result<(), ReadError> {
    let asset = |key: &str| value.get("asset").and_then(|asset| asset.get(key)).and_then(Value::as_str);
    let are_named = ["meshes", "nodes"].iter().any(|key| value.get(key).is_some_and(Value::is_object));
    if are_named || asset("version").is_some_and(|version| version.starts_with('1')) {
        return Err(old());
    }
    let later = match (asset("version"), asset("minVersion")) {
        (_, Some(least)) if !matches!(least, "1.0" | "2.0") => least,
        (Some(version), _) if version.split('.').next() != Some("2") => version,
        _ => return Ok(()),
    };
    let message = format!("is a glTF file of the version {}; expected 2.0", quoted(later.as_bytes()));
    Err(ReadError::new(message, "export it again as glTF 2.0 (.glb)"))
}

fn old() -> ReadError {
    ReadError::new("is a glTF 1.0 file; expected 2.0", "export it again as glTF 2.0 (.glb)")
}
