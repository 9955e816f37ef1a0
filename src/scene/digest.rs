//! The digest of a scene's meaning.

use super::schema::{SCHEMA, variants, without_nulls};
use serde::Serialize;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

/// Digests of the files that a scene names.
#[derive(Debug, Default)]
pub(super) struct FileDigests {
    /// The body file.
    pub(super) body: Option<String>,
    /// The font file.
    pub(super) regular: Option<String>,
    /// The font file for names and counts.
    pub(super) semi_bold: Option<String>,
}

/// SHA-256 of the typed scene as canonical JSON, 64 hexadecimal digits.
///
/// Canonical means: keys sorted, every number in the shortest form that reads back to the same double, no key
/// whose value is its default. So comments, layout, order of keys, the notation of numbers (`1e4` or `10000.0`) and
/// explicit defaults do not change the digest, nor do keys that are added to the format later. Defaults that the schema
/// describes only in words, such as `passes = 2`, do count when they are typed.
///
/// The name of a file is replaced by the digest of its content.
pub(super) fn digest(typed: &impl Serialize, files: FileDigests) -> String {
    // The types have only finite numbers and text keys, which JSON can represent.
    let mut value = serde_json::to_value(typed).unwrap_or_default();
    if let Some(body) = files.body {
        value["body"]["file"] = body.into();
    }
    if let Some(regular) = files.regular {
        value["view"]["font"] = json!({ "regular": regular, "semi_bold": files.semi_bold });
    }
    without_nulls(&mut value);
    without_defaults(&mut value, &SCHEMA);
    value.sort_all_objects();
    Sha256::digest(value.to_string().as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Removes every entry whose value is the default that the schema names.
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
                without_defaults(value, &schema["properties"][key]);
            }
        }
        Value::Array(items) => items.iter_mut().for_each(|item| without_defaults(item, &schema["items"])),
        _ => {}
    }
}
