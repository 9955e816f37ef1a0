//! The digest of a scene's meaning.

use super::file::{BodyFile, ContactRule, Coordinates, Positive, SceneFile};
use super::schema::{SCHEMA, by_name, retain, variants};
use crate::look::print::SizeFile;
use crate::reading::words::hexadecimal;
use crate::sim::FrictionOf;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::io::{self, BufWriter, Write};

/// Digests of the files that a scene names.
#[derive(Debug, Default)]
pub(super) struct FileDigests {
    /// The file of each body, with the key that names it.
    pub(super) bodies: Vec<Option<(&'static str, String)>>,
    /// The recording of each run.
    pub(super) runs: Vec<Option<String>>,
    /// The font file.
    pub(super) regular: Option<String>,
    /// The font file for names and counts.
    pub(super) semi_bold: Option<String>,
}

/// SHA-256 of a typed scene without mistakes as canonical JSON, 64 hexadecimal digits. The lists of bodies, which may have millions of
/// entries, are written without a copy. One body is a table in canonical JSON, several are a list.
///
/// Canonical JSON has sorted keys, every number in the shortest form that reads back to the same double, and no key
/// with its default. So comments, layout, order of keys, the notation of numbers (`1e4` or `10000.0`) and explicit
/// defaults do not change the digest, nor do keys that are added to the format later. A default that the schema
/// describes only in words, such as `passes = 2`, changes the digest when typed.
///
/// The name of a file is replaced by the digest of its content.
pub(super) fn digest(typed: &SceneFile, files: FileDigests) -> String {
    // The types have only finite numbers and text keys, which JSON can represent.
    let mut value = serde_json::to_value(typed).unwrap_or_default();
    for (at, recording) in files.runs.into_iter().enumerate() {
        recording.into_iter().for_each(|recording| value["run"][at]["states"] = recording.into());
    }
    if let Some(regular) = files.regular {
        value["view"]["font"] = json!({ "regular": regular, "semi_bold": files.semi_bold });
    }
    if let Ok(size) = SizeFile::deserialize(&value["view"]["size"]) {
        value["view"]["size"] = json!(size);
    }
    retain(&mut value, |_, value| !value.is_null());
    with_friction(&mut value);
    with_contact(&mut value);
    without_defaults(&mut value, &SCHEMA);
    // Tables in which only defaults were typed.
    let is_empty = |value: &Value| *value == json!({});
    if let Some(Value::Object(view)) = value.get_mut("view") {
        view.retain(|_, value| !is_empty(value));
    }
    if value.get("view").is_some_and(is_empty) {
        value.as_object_mut().map(|scene| scene.remove("view"));
    }
    let mut bodies = match value["body"].take() {
        Value::Array(several) => several,
        one => vec![one],
    };
    for (body, file) in bodies.iter_mut().zip(files.bodies) {
        file.into_iter().for_each(|(key, file)| body[key] = file.into());
        without_defaults(body, &SCHEMA["properties"]["body"]["anyOf"][0]);
        body.as_object_mut().into_iter().for_each(|body| body.retain(|_, value| !is_empty(value)));
        body.sort_all_objects();
    }
    value.sort_all_objects();
    let written = bodies.iter().zip(typed.body.iter().flatten());
    let mut written: Vec<_> =
        written.map(|(body, typed)| Canonical::Table(table(body).into_iter().chain(lists(typed)).collect())).collect();
    let mut scene = table(&value);
    scene.insert("body", if written.len() == 1 { written.remove(0) } else { Canonical::List(written) });
    let mut hash = Hash(Sha256::new());
    serde_json::to_writer(BufWriter::new(&mut hash), &scene).expect("hashing cannot fail");
    hexadecimal(&hash.0.finalize())
}

/// An entry of the canonical scene.
#[derive(Serialize)]
#[serde(untagged)]
enum Canonical<'a> {
    Value(&'a Value),
    Table(BTreeMap<&'a str, Canonical<'a>>),
    List(Vec<Canonical<'a>>),
    Points(&'a [Coordinates]),
    Indices(&'a [Vec<u32>]),
    Pairs(&'a [[u32; 2]]),
    Numbers(&'a [Positive]),
}

/// The entries of a table.
fn table(value: &Value) -> BTreeMap<&str, Canonical<'_>> {
    value.as_object().into_iter().flatten().map(|(key, value)| (key.as_str(), Canonical::Value(value))).collect()
}

/// The lists of a body.
fn lists(body: &BodyFile) -> impl Iterator<Item = (&str, Canonical<'_>)> {
    let lists = [
        ("nodes", body.nodes.as_deref().map(Canonical::Points)),
        ("elements", body.elements.as_deref().map(Canonical::Indices)),
        ("springs", body.springs.as_deref().map(Canonical::Pairs)),
        ("faces", body.faces.as_deref().map(Canonical::Indices)),
        ("positions", body.positions.as_deref().map(Canonical::Points)),
        ("velocities", body.velocities.as_deref().map(Canonical::Points)),
        ("masses", body.masses.as_deref().map(Canonical::Numbers)),
    ];
    lists.into_iter().filter_map(|(key, list)| Some((key, list?)))
}

/// Hashes the bytes that are written to it.
struct Hash(Sha256);

impl Write for Hash {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Names what friction is of where it is of paths. Its default was of velocities at first, which stays without a name, so that scenes
/// that mean the same keep their digests.
fn with_friction(value: &mut Value) {
    let obstacles = value.get_mut("obstacle").and_then(Value::as_array_mut).into_iter().flatten();
    for obstacle in obstacles.filter_map(Value::as_object_mut) {
        if obstacle.get("friction").and_then(Value::as_f64).is_some_and(|friction| friction > 0.0) {
            let of = obstacle.remove("friction_of").unwrap_or_else(|| json!(FrictionOf::default()));
            if of != json!(FrictionOf::Velocity) {
                obstacle.insert("friction_of".to_owned(), of);
            }
        }
    }
}

/// Names contact of surfaces where some can meet. Nodes alone met obstacles at first, which stays without a name, as above.
fn with_contact(value: &mut Value) {
    let is_of_nodes = value["contact"]["rule"] == json!(ContactRule::Nodes);
    let has_extent = |obstacle: &Value| !["floor", "plate"].contains(&obstacle["kind"].as_str().unwrap_or_default());
    let has_several =
        |run: &Value| run["bodies"].as_array().or(value["body"].as_array()).is_some_and(|of| of.len() > 1);
    let meets_itself = |body: &Value| body["self_contact"] == true;
    let can_meet = value["run"].as_array().is_some_and(|runs| runs.iter().any(has_several))
        || value["obstacle"].as_array().is_some_and(|obstacles| obstacles.iter().any(has_extent))
        || meets_itself(&value["body"])
        || value["body"].as_array().is_some_and(|bodies| bodies.iter().any(meets_itself));
    if is_of_nodes || !can_meet {
        value.as_object_mut().map(|scene| scene.remove("contact"));
    } else {
        value["contact"]["rule"] = json!(ContactRule::Surfaces);
    }
}

/// Removes every entry with the default of the schema as its value.
fn without_defaults(value: &mut Value, schema: &Value) {
    let schema = match variants(schema) {
        Some((tag, kinds)) => match kinds.iter().find(|(name, _)| value[tag] == **name) {
            Some((_, branch)) => branch,
            None => return,
        },
        None => schema,
    };
    match value {
        Value::Object(table) => {
            table.retain(|key, value| schema["properties"][key].get("default") != Some(value));
            for (key, value) in table.iter_mut() {
                without_defaults(value, schema["properties"].get(key).or(by_name(schema)).unwrap_or(&Value::Null));
            }
        }
        Value::Array(items) => items.iter_mut().for_each(|item| without_defaults(item, &schema["items"])),
        _ => {}
    }
}
