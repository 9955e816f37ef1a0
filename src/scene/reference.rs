//! The reference of scene files and figure files as Markdown, made from their schemas.

use super::figure;
use super::schema::{by_name, choices, schema, variants};
use super::structure::expect::{first_sentence, range};
use serde_json::Value;

/// The reference of scene files.
pub(crate) fn scenes() -> String {
    written(include_str!("reference/scenes.md"), &schema())
}

/// The reference of figure files.
pub(crate) fn figures() -> String {
    written(include_str!("reference/figures.md"), &figure::schema())
}

/// An introduction, then one section for each table.
fn written(introduction: &str, schema: &Value) -> String {
    let mut reference =
        Reference { text: introduction.to_owned(), sections: Vec::new(), lists: Vec::new(), next: Vec::new() };
    reference.text += "\n## Top level\n";
    reference.body(schema, "");
    reference.finish();
    reference.text
}

/// An unfinished reference.
struct Reference<'s> {
    text: String,
    /// Tables that have a section, each with its path. A table that occurs at several paths has one section.
    sections: Vec<(&'s Value, String)>,
    /// Written lists of choices, each with the path of its key. Other keys refer to it.
    lists: Vec<(&'s Value, String)>,
    /// Tables of the last section. Their sections follow it.
    next: Vec<(&'s Value, String)>,
}

impl<'s> Reference<'s> {
    /// The sections of nested tables, depth first.
    fn finish(&mut self) {
        for (table, path) in std::mem::take(&mut self.next) {
            let (depth, heading) = match (path.contains('.'), table["type"] == "array") {
                (true, _) => ("###", path.clone()),
                (false, true) => ("##", format!("[[{path}]]")),
                (false, false) => ("##", format!("[{path}]")),
            };
            self.text += &format!("\n{depth} `{heading}`\n");
            let (_, more) = split(description(table));
            let each = Some(description(&table["items"])).filter(|each| !description(table).starts_with(each));
            for text in [Some(more), each].into_iter().flatten().filter(|text| !text.is_empty()) {
                self.text += &format!("\n{text}\n");
            }
            let tables = tables_of(table);
            for (at, one) in tables.iter().enumerate() {
                if at > 0 {
                    self.text += &format!("\nOr: {}\n", description(one));
                }
                self.body(one, &path);
            }
            self.finish();
        }
    }

    /// The keys of a table, or of each kind of it.
    fn body(&mut self, table: &'s Value, path: &str) {
        let Some((tag, kinds)) = variants(table) else { return self.keys(table, path, |_, _| true) };
        let (_, first) = kinds[0];
        let shared = |key: &str, value: &Value| kinds.iter().all(|(_, kind)| kind["properties"][key] == *value);
        for (name, kind) in &kinds {
            self.text += &format!("\n**`{tag} = \"{name}\"`**: {}\n", description(kind));
            self.keys(kind, path, |key, value| key != tag && !shared(key, value));
        }
        let mut properties = first["properties"].as_object().into_iter().flatten();
        if properties.any(|(key, value)| shared(key, value)) {
            self.text += &format!("\nKeys of every `{tag}`:\n");
            self.keys(first, path, shared);
        }
    }

    /// The selected keys of a table, as a list.
    fn keys(&mut self, table: &'s Value, path: &str, wanted: impl Fn(&str, &Value) -> bool) {
        let Some(properties) = table["properties"].as_object() else { return };
        let required = table["required"].as_array();
        self.text.push('\n');
        for (key, value) in properties.iter().filter(|(key, value)| wanted(key, value)) {
            let (mut kind, mut meaning) = (kind(value), description(value).to_owned());
            if table_of(value).is_some() {
                let (table, path) = self.section(value, path, key);
                // The section repeats the rest, unless it was written for a key with another meaning.
                if description(table) == meaning {
                    meaning = split(description(value)).0;
                }
                kind = format!("[{kind}](#{})", path.replace('.', ""));
            }
            if required.is_some_and(|required| required.iter().any(|name| name == key)) {
                kind += ", required";
            } else if let Some(default) = value.get("default").and_then(default) {
                kind += &format!(", default `{default}`");
            }
            let choices = described_choices(value);
            if let Some((_, path)) = self.lists.iter().find(|(known, _)| Some(*known) == choices) {
                self.text += &format!("- **`{key}`** ({kind}, as for `{path}`): {meaning}\n");
                continue;
            }
            self.text += &format!("- **`{key}`** ({kind}): {meaning}\n");
            for choice in choices.into_iter().flat_map(entries) {
                self.text += &format!("  - `{}`: {}\n", choice["const"], description(choice));
            }
            self.lists.extend(choices.map(|choices| (choices, joined(path, key))));
        }
    }

    /// The section of a table, which is written later unless it exists.
    fn section(&mut self, table: &'s Value, path: &str, key: &str) -> (&'s Value, String) {
        let inner = |table| table_of(table).expect("a table");
        let is_same = |known| ["properties", "oneOf"].iter().all(|part| inner(known)[part] == inner(table)[part]);
        if let Some(known) = self.sections.iter().find(|(known, _)| is_same(known)) {
            return known.clone();
        }
        let section = (table, joined(path, key));
        self.sections.push(section.clone());
        self.next.push(section.clone());
        section
    }
}

fn joined(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

/// The first sentence of a description with its default, for the list of keys, and the other sentences, for a section.
fn split(description: &str) -> (String, &str) {
    let first = first_sentence(description);
    let rest = description[first.len()..].trim();
    match rest.find("Default: ") {
        Some(at) => (format!("{first} {}", &rest[at..]), rest[..at].trim()),
        None => (first.to_owned(), rest),
    }
}

fn description(schema: &Value) -> &str {
    schema["description"].as_str().unwrap_or_default()
}

/// The table that a key holds, alone, in an array, by name, or as one of several alternatives.
fn table_of(schema: &Value) -> Option<&Value> {
    if schema["properties"].is_object() || variants(schema).is_some() {
        return Some(schema);
    }
    let alternatives = schema["anyOf"].as_array().into_iter().flatten();
    schema.get("items").into_iter().chain(by_name(schema)).chain(alternatives).find_map(table_of)
}

/// The tables that a key holds: several if they are alternatives.
fn tables_of(schema: &Value) -> Vec<&Value> {
    match schema.get("items").unwrap_or(schema)["anyOf"].as_array() {
        Some(alternatives) => {
            let mut tables: Vec<_> = alternatives.iter().filter_map(table_of).collect();
            tables.dedup_by_key(|table| &table["properties"]);
            tables
        }
        None => table_of(schema).into_iter().collect(),
    }
}

/// The type of a value in words, with its range.
fn kind(schema: &Value) -> String {
    if let Some(alternatives) = schema["anyOf"].as_array() {
        let mut kinds: Vec<_> = alternatives.iter().map(kind).collect();
        kinds.dedup();
        return kinds.join(" or ");
    }
    if let Some(choices) = choices(schema) {
        // Choices with descriptions have a list of their own.
        let described = described_choices(schema).is_some();
        let quoted: Vec<_> = choices.iter().map(|choice| format!("`\"{choice}\"`")).collect();
        return if described { "string".into() } else { quoted.join(" or ") };
    }
    match (schema["type"].as_str(), schema["format"].as_str()) {
        (Some("number"), _) => range("number", schema),
        (Some("integer"), _) => range("whole number", schema),
        (Some("boolean"), _) => "`true` or `false`".into(),
        (Some("string"), Some("colour")) => "colour".into(),
        (Some("string"), Some("fraction")) => "fraction such as `\"1/3\"`".into(),
        (Some("string"), Some("fraction-of-T")) => "fraction of T or `\"auto\"`".into(),
        (Some("string"), _) => "string".into(),
        (Some("array"), _) if is_vector(schema) => "vector".into(),
        (Some("array"), _) => {
            let entries = plural(&kind(&schema["items"]));
            match (schema["minItems"].as_u64(), schema["maxItems"].as_u64()) {
                (Some(least), Some(most)) if least == most => format!("array of {least} {entries}"),
                (Some(least), Some(most)) => format!("array of {least} to {most} {entries}"),
                (Some(1), None) => format!("array of one or more {entries}"),
                (Some(least), None) => format!("array of at least {least} {entries}"),
                (None, Some(most)) => format!("array of at most {most} {entries}"),
                (None, None) => format!("array of {entries}"),
            }
        }
        _ => by_name(schema).map_or_else(|| "table".into(), |entry| format!("table of {}", plural(&kind(entry)))),
    }
}

/// Whether an array holds the coordinates of a vector, two or three numbers of any size.
fn is_vector(schema: &Value) -> bool {
    let any = schema["items"].as_object().is_some_and(|items| {
        items.get("type").is_some_and(|kind| kind == "number") && !items.contains_key("exclusiveMinimum")
    });
    any && schema["minItems"] == 2 && schema["maxItems"] == 3
}

/// The plural of each alternative of a type in words.
fn plural(kind: &str) -> String {
    let nouns = ["array", "number", "string", "colour", "vector", "table"];
    let plural = |alternative: &str| match nouns.iter().find(|noun| alternative.contains(*noun)) {
        Some(noun) => alternative.replacen(noun, &format!("{noun}s"), 1),
        None => alternative.to_owned(),
    };
    kind.split(" or ").map(plural).collect::<Vec<_>>().join(" or ")
}

/// The strings with descriptions that a value or its entries may be.
fn described_choices(schema: &Value) -> Option<&Value> {
    let inner = if schema["type"] == "array" { &schema["items"] } else { schema };
    let lists = [&inner["oneOf"], &inner["anyOf"][0]["oneOf"], &inner["anyOf"][1]["oneOf"]];
    lists.into_iter().find(|list| list[0]["const"].is_string())
}

fn entries(array: &Value) -> impl Iterator<Item = &Value> {
    array.as_array().into_iter().flatten()
}

/// A default as typed; `None` for tables and empty values.
fn default(value: &Value) -> Option<String> {
    match value {
        Value::Object(_) => None,
        Value::Array(items) if items.is_empty() => None,
        Value::String(text) if text.is_empty() => None,
        Value::Number(number) => number.as_f64().map(|number| format!("{}", (number * 1e4).round() / 1e4)),
        other => Some(other.to_string()),
    }
}
