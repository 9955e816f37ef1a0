//! The JSON Schema of scene files, made from the types in [`super::file`].

use super::file::{LISTS, SceneFile};
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde_json::{Map, Value, json};
use std::sync::LazyLock;

/// The JSON Schema (draft 2020-12) of scene files: every key with its meaning, unit, range and default.
///
/// It is one tree without references, to be read from top to bottom. Scene files are checked against this tree; see
/// [`Scene::parse`](super::Scene::parse).
///
/// ```
/// let schema = localshape::scene::schema();
/// assert_eq!(schema["properties"]["time"]["properties"]["duration"]["type"], "number");
/// ```
pub fn schema() -> Value {
    SCHEMA.clone()
}

/// The schema, made once.
pub(super) static SCHEMA: LazyLock<Value> = LazyLock::new(|| schema_of::<SceneFile>("Scene file of localshape"));

/// The schema of scenes made in code. Their runs may have models of the caller's own, and the entries of their lists are not written.
/// Messages do not explain keys: the builders are documented.
pub(super) static SCHEMA_OF_CODE: LazyLock<Value> = LazyLock::new(|| {
    let mut schema = schema();
    let run = schema["properties"]["run"]["items"].as_object_mut();
    run.expect("a table").shift_remove("oneOf").expect("keys that a run needs");
    for body in ["/properties/body/anyOf/0", "/properties/body/anyOf/1/items"] {
        let body = schema.pointer_mut(body).expect("one body, or several");
        LISTS.iter().for_each(|list| body["properties"][list]["items"] = json!({}));
    }
    retain(&mut schema, |key, value| key != "description" || !value.is_string());
    schema
});

/// The schema of a file's type.
pub(super) fn schema_of<T: JsonSchema>(title: &str) -> Value {
    let settings = SchemaSettings::draft2020_12().with(|settings| settings.inline_subschemas = true);
    let mut schema = settings.into_generator().into_root_schema_for::<T>().to_value();
    tidy(&mut schema);
    schema["title"] = title.into();
    schema
}

/// Adapts the generated schema to TOML: no null, descriptions on one line, no single alternatives, and a description of
/// every `kind`.
fn tidy(schema: &mut Value) {
    match schema {
        Value::Array(items) => items.iter_mut().for_each(tidy),
        Value::Object(table) => {
            drop_null(table);
            share_keys(table);
            if let Some(Value::String(text)) = table.get_mut("description") {
                *text = text.replace('\n', " ");
            }
            if table.get("format").and_then(Value::as_str) == Some("uint32") && !table.contains_key("maximum") {
                table.insert("maximum".into(), u32::MAX.into());
            }
            if let Some(default) = table.get_mut("default") {
                retain(default, |_, value| !value.is_null());
            }
            describe_kind(table);
            table.iter_mut().filter(|(key, _)| *key != "default").for_each(|(_, value)| tidy(value));
        }
        _ => {}
    }
}

/// Removes the null of an absent optional key, and the alternative of one that this leaves.
fn drop_null(table: &mut Map<String, Value>) {
    if let Some(Value::Array(types)) = table.get_mut("type") {
        types.retain(|name| name != "null");
        if let [only] = types.as_slice() {
            let only = only.clone();
            table.insert("type".into(), only);
        }
    }
    if table.get("default") == Some(&Value::Null) {
        table.shift_remove("default");
    }
    let Some(Value::Array(branches)) = table.get_mut("anyOf") else { return };
    branches.retain(|branch| branch["type"] != "null");
    if let [Value::Object(only)] = branches.as_slice() {
        let only = only.clone();
        table.shift_remove("anyOf");
        for (key, value) in only {
            table.entry(key).or_insert(value);
        }
        // The alternative may itself have had a null.
        drop_null(table);
    }
}

/// Gives each variant of a tagged table the keys and rules of the table that contains the variants.
fn share_keys(table: &mut Map<String, Value>) {
    let is_variant = |branch: &Value| branch["properties"].is_object();
    if !table.contains_key("properties") || !table.get("oneOf").is_some_and(|branches| is_variant(&branches[0])) {
        return;
    }
    let [keys, rule] = ["properties", "not"].map(|key| table.shift_remove(key).unwrap_or_default());
    table.shift_remove("type");
    for branch in table.get_mut("oneOf").and_then(Value::as_array_mut).into_iter().flatten() {
        let own = branch["properties"].as_object_mut().into_iter();
        own.zip(keys.as_object()).for_each(|(own, keys)| own.extend(keys.clone()));
        branch["additionalProperties"] = false.into();
        branch["not"] = rule.clone();
    }
}

/// Gives the key that names a variant the description of the variant.
fn describe_kind(table: &mut Map<String, Value>) {
    let Some(description) = table.get("description").cloned() else { return };
    let Some(Value::Object(properties)) = table.get_mut("properties") else { return };
    for property in properties.values_mut().filter_map(Value::as_object_mut) {
        if property.contains_key("const") {
            property.entry("description").or_insert_with(|| description.clone());
        }
    }
}

/// Keeps those entries of tables, at any depth, for which `keeps` is true.
pub(super) fn retain(value: &mut Value, keeps: fn(&str, &Value) -> bool) {
    match value {
        Value::Object(table) => {
            table.retain(|key, value| keeps(key, value));
            table.values_mut().for_each(|value| retain(value, keeps));
        }
        Value::Array(items) => items.iter_mut().for_each(|value| retain(value, keeps)),
        _ => {}
    }
}

/// The variants of a `oneOf` of tables by name, and the key that names them; `None` for other schemas.
pub(super) fn variants(schema: &Value) -> Option<(&str, Vec<(&str, &Value)>)> {
    let branches = schema.get("oneOf")?.as_array()?;
    let properties = branches.first()?.get("properties")?.as_object()?;
    let (tag, _) = properties.iter().find(|(_, property)| property.get("const").is_some())?;
    let named = branches.iter().map(|branch| Some((branch["properties"][tag]["const"].as_str()?, branch)));
    Some((tag, named.collect::<Option<_>>()?))
}

/// The strings that a schema allows, if it has a list.
pub(super) fn choices(schema: &Value) -> Option<Vec<&str>> {
    if let Some(only) = schema.get("const") {
        return Some(vec![only.as_str()?]);
    }
    if let Some(several) = schema.get("enum") {
        return several.as_array()?.iter().map(Value::as_str).collect();
    }
    let branches = schema.get("oneOf")?.as_array()?;
    branches.iter().map(choices).collect::<Option<Vec<_>>>().map(|lists| lists.concat())
}

/// The schema of the entries of a table whose keys are names, such as `models`.
pub(super) fn by_name(schema: &Value) -> Option<&Value> {
    schema.get("additionalProperties").filter(|entry| entry.is_object())
}
