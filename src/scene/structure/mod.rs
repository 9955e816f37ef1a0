//! Checks the structure of a scene file against the schema: keys, types, ranges, lengths and choices.
//!
//! `jsonschema` has about fifty dependencies and would replace little of this: it checks JSON without lines and
//! columns, reports of alternatives only that none fits, and suggests no similar key.

pub(super) mod expect;
mod keys;

use super::file::LARGEST;
use super::schema::{by_name, choices, variants};
use super::step::NamedStep;
use crate::look::typed::TypedColour;
use crate::reading::collector::{Collector, PathPart, written};
use crate::reading::words::{self, list, nearest, quoted};
use crate::sim::model::Ratio;
use expect::{expected, first_sentence, range};
use serde_json::{Map, Value as Json};
use std::collections::BTreeSet;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A checked file.
#[derive(Debug)]
pub(super) struct Checked {
    /// The file as JSON, without keys that have mistakes. Array entries with mistakes are null.
    pub(super) parts: Map<String, Json>,
    /// Top-level keys with mistakes in or below them.
    pub(super) flawed: BTreeSet<String>,
}

/// Checks a whole file.
pub(super) fn check(schema: &Json, root: &DeTable<'_>, report: &Collector<'_>) -> Checked {
    let mut walk = Walk { schema, report, path: Vec::new() };
    walk.table_rules(schema, root, 0..0);
    let (mut parts, mut flawed) = (Map::new(), BTreeSet::new());
    for (key, value) in root.iter() {
        let name = key.get_ref().as_ref();
        let before = walk.report.total();
        walk.path.push(PathPart::Key(name));
        let part = match (schema["properties"].get(name), value.get_ref()) {
            (None, _) => {
                walk.unknown_key(schema, name, key.span(), &[]);
                Json::Null
            }
            // The sound parts of these are used.
            (Some(inner), DeValue::Array(_) | DeValue::Table(_)) => walk.value(inner, value),
            (Some(inner), _) => walk.guarded(inner, value),
        };
        walk.path.pop();
        if walk.report.total() > before {
            flawed.insert(name.to_owned());
        }
        parts.insert(name.to_owned(), part);
    }
    Checked { parts, flawed }
}

struct Walk<'r, 'p> {
    /// The schema of the whole file.
    schema: &'r Json,
    report: &'r Collector<'r>,
    path: Vec<PathPart<'p>>,
}

impl<'p> Walk<'_, 'p> {
    fn mistake(&mut self, span: Range<usize>, message: String, help: Option<String>) {
        self.report.at_span(span, &self.path, message, help);
    }

    fn here(&self) -> String {
        written(&self.path)
    }

    /// The first sentence of the description of a key; `None` for an entry of an array.
    fn meaning(&self, schema: &Json) -> Option<String> {
        let keyed = matches!(self.path.last(), Some(PathPart::Key(_)));
        schema.get("description").and_then(Json::as_str).filter(|_| keyed).map(|text| first_sentence(text).into())
    }

    /// A value as JSON, or null after a mistake in it.
    fn guarded(&mut self, schema: &Json, value: &'p Spanned<DeValue<'p>>) -> Json {
        let before = self.report.total();
        let json = self.value(schema, value);
        if self.report.total() == before { json } else { Json::Null }
    }

    fn entries(&mut self, schema: &Json, items: &'p [Spanned<DeValue<'p>>]) -> Vec<Json> {
        let nothing = Json::Bool(true);
        let inner = schema.get("items").unwrap_or(&nothing);
        // Those beyond the limit were reported together.
        let most = schema["maxItems"].as_u64().map_or(items.len(), |most| items.len().min(most as usize));
        let mut entries = Vec::with_capacity(most);
        for (index, item) in items[..most].iter().enumerate() {
            self.path.push(PathPart::Index(index));
            entries.push(self.guarded(inner, item));
            self.path.pop();
        }
        entries
    }

    fn value(&mut self, schema: &Json, value: &'p Spanned<DeValue<'p>>) -> Json {
        if schema.get("anyOf").is_some() {
            return match alternative(schema, value.get_ref()) {
                Some(branch) => self.value(branch, value),
                None => self.wrong_type(schema, value),
            };
        }
        if let Some((tag, kinds)) = variants(schema) {
            return match value.get_ref() {
                DeValue::Table(table) => self.variant(tag, &kinds, table, value.span()),
                _ => self.wrong_type(schema, value),
            };
        }
        if !fits(schema, value.get_ref()) {
            return self.wrong_type(schema, value);
        }
        match value.get_ref() {
            DeValue::String(text) => self.string(schema, text, value.span()),
            DeValue::Integer(_) | DeValue::Float(_) => self.number(schema, value),
            DeValue::Boolean(truth) => Json::Bool(*truth),
            DeValue::Datetime(date) => Json::String(date.to_string()),
            DeValue::Array(items) => {
                self.lengths(schema, "entries", "entry", items.len(), value.span());
                Json::Array(self.entries(schema, items))
            }
            DeValue::Table(table) => self.table(schema, table, value.span(), &[]),
        }
    }

    fn wrong_type(&mut self, schema: &Json, value: &Spanned<DeValue<'_>>) -> Json {
        let mut help = self.meaning(schema);
        if let [PathPart::Key(key)] = self.path[..] {
            match (schema["type"].as_str(), value.get_ref()) {
                (Some("array"), DeValue::Table(_)) => {
                    help = Some(format!("write [[{key}]], with double brackets: there may be several"));
                }
                (Some("object"), DeValue::Array(_)) => {
                    help = Some(format!("write [{key}], with single brackets: there is one"));
                }
                _ => {}
            }
        }
        if let (Some(text), Some(kind @ ("number" | "integer"))) = (value.get_ref().as_str(), schema["type"].as_str()) {
            help = unquoted(text, kind == "integer").or(help);
        }
        let message = format!("`{}` is {}; expected {}", self.here(), words::found(value.get_ref()), expected(schema));
        self.mistake(value.span(), message, help);
        Json::Null
    }

    fn string(&mut self, schema: &Json, text: &str, span: Range<usize>) -> Json {
        if let Some(choices) = choices(schema) {
            if !choices.contains(&text) {
                let expected = list(&choices, "or", quoted);
                let help = nearest(text, &choices).map(|name| format!("did you mean {}?", quoted(name)));
                self.mistake(span, format!("`{}` is {}; expected {expected}", self.here(), quoted(text)), help);
            }
        } else if let Some(found) = schema["format"].as_str().and_then(|format| formatted(format, text)) {
            match found {
                Ok(text) => return Json::String(text),
                Err((wrong, help)) => {
                    self.mistake(span, format!("`{}` is {}{wrong}", self.here(), quoted(text)), help);
                }
            }
        } else {
            self.free_text(schema, text, span);
        }
        Json::String(text.into())
    }

    /// Checks a text that may have any words.
    fn free_text(&mut self, schema: &Json, text: &str, span: Range<usize>) {
        self.lengths(schema, "characters", "character", text.chars().count(), span.clone());
        let may_break = schema["format"] == "lines";
        if let Some(control) = text.chars().find(|&c| c.is_control() && !(may_break && c == '\n')) {
            let kind = if may_break { "lines" } else { "one line" };
            let message = format!("`{}` contains the control character {control:?}; it is {kind} of text", self.here());
            self.mistake(span.clone(), message, None);
        }
        // Drawn texts have a maximum length; names of files have none.
        let is_drawn = schema.get("maxLength").is_some();
        if let Some(character) = text.chars().find(|&c| is_drawn && needs_shaping(c)) {
            let message = format!(
                "`{}` has {character:?}, which is drawn wrongly; expected characters that are written from left to \
                 right, unjoined and without combining marks",
                self.here()
            );
            let help =
                "use Latin, Greek, Cyrillic, Chinese, Japanese or Korean, with accented letters as single characters";
            self.report.warn(span, &self.path, message, Some(help.to_owned()));
        }
    }

    fn number(&mut self, schema: &Json, value: &Spanned<DeValue<'_>>) -> Json {
        let whole = schema["type"] == "integer";
        let (text, number) = match value.get_ref() {
            DeValue::Integer(integer) => (integer.to_string(), words::to_f64(integer)),
            DeValue::Float(float) => (float.to_string(), float.as_str().parse().unwrap_or(f64::NAN)),
            _ => return Json::Null,
        };
        let bound = |name: &str| schema[name].as_f64();
        let inside = bound("minimum").is_none_or(|least| number >= least)
            && bound("maximum").is_none_or(|most| number <= most)
            && bound("exclusiveMinimum").is_none_or(|above| number > above)
            && bound("exclusiveMaximum").is_none_or(|below| number < below);
        if number.is_finite() && inside && number.abs() <= LARGEST {
            match value.get_ref().as_integer().filter(|_| whole).map(words::to_json) {
                None => return Json::from(number),
                Some(Some(exact)) => return exact,
                Some(None) => {}
            }
        }
        let expected = if whole && inside {
            "a whole number of 64 bits".into()
        } else if !number.is_finite() && !text.starts_with(|c: char| c.is_ascii_digit()) {
            "a finite number".into()
        } else if inside {
            format!("a magnitude up to {LARGEST:e}")
        } else {
            range(if whole { "a whole number" } else { "a number" }, schema)
        };
        let help = self.meaning(schema);
        let text = words::shortened(&text);
        self.mistake(value.span(), format!("`{}` is {text}; expected {expected}", self.here()), help);
        Json::Null
    }

    /// Checks a length against `minItems` and `maxItems`, or `minLength` and `maxLength`.
    fn lengths(&mut self, schema: &Json, many: &str, one: &str, length: usize, span: Range<usize>) {
        let bound = |a: &str, b: &str| schema.get(a).or(schema.get(b)).and_then(Json::as_u64).map(|n| n as usize);
        let (least, most) = (bound("minItems", "minLength"), bound("maxItems", "maxLength"));
        if least.is_none_or(|least| length >= least) && most.is_none_or(|most| length <= most) {
            return;
        }
        let expected = match (least, most) {
            (Some(least), Some(most)) if least == most => format!("{least}"),
            (Some(least), Some(most)) if least + 1 == most => format!("{least} or {most}"),
            (Some(least), Some(most)) => format!("{least} to {most}"),
            (Some(least), None) => format!("at least {least}"),
            (None, Some(most)) => format!("at most {most}"),
            (None, None) => return,
        };
        let unit = if length == 1 { one } else { many };
        let found = if length == 0 { "is empty".into() } else { format!("has {length} {unit}") };
        self.mistake(span, format!("`{}` {found}; expected {expected}", self.here()), None);
    }

    fn variant(&mut self, tag: &str, kinds: &[(&str, &Json)], table: &'p DeTable<'p>, span: Range<usize>) -> Json {
        let names: Vec<_> = kinds.iter().map(|(name, _)| *name).collect();
        let Some(given) = table.get(tag) else {
            let message = format!("`{}` has no `{tag}`; expected {}", self.here(), list(&names, "or", quoted));
            let help = names.first().map(|name| format!("such as {tag} = {}", quoted(name)));
            self.mistake(span, message, help);
            return Json::Null;
        };
        match given.get_ref().as_str().and_then(|name| kinds.iter().find(|(known, _)| *known == name)) {
            Some((_, branch)) => self.table(branch, table, span, kinds),
            None => {
                let found = given.get_ref().as_str().map_or_else(|| words::found(given.get_ref()), quoted);
                let message = format!("`{}.{tag}` is {found}; expected {}", self.here(), list(&names, "or", quoted));
                let near = given.get_ref().as_str().and_then(|name| nearest(name, &names));
                self.mistake(given.span(), message, near.map(|name| format!("did you mean {}?", quoted(name))));
                Json::Null
            }
        }
    }

    /// A table. `kinds` are the names of its other kinds.
    fn table(&mut self, schema: &Json, table: &'p DeTable<'p>, span: Range<usize>, kinds: &[(&str, &Json)]) -> Json {
        self.table_rules(schema, table, span);
        let mut json = Map::new();
        for (key, value) in table.iter() {
            let name = key.get_ref().as_ref();
            self.path.push(PathPart::Key(name));
            match schema["properties"].get(name).or(by_name(schema)) {
                None => self.unknown_key(schema, name, key.span(), kinds),
                Some(inner) => {
                    let inner = self.guarded(inner, value);
                    if !inner.is_null() {
                        json.insert(name.into(), inner);
                    }
                }
            }
            self.path.pop();
        }
        Json::Object(json)
    }
}

/// A text in the format of a schema, as it is kept, or the rest of a message about it, and the remedy; `None` for other formats.
fn formatted(format: &str, text: &str) -> Option<Result<String, (String, Option<String>)>> {
    let same = || text.to_owned();
    match format {
        "fraction-of-T" => {
            let wrong = |expected| (format!("; {expected}, or seconds as a number"), None);
            Some(NamedStep::try_from(same()).map(|_| same()).map_err(wrong))
        }
        "fraction" => Some(text.parse::<Ratio>().map(|_| same()).map_err(|expected| (format!("; {expected}"), None))),
        // A name and its digits are the same colour.
        "colour" => Some(TypedColour::read(text).map(String::from)),
        _ => None,
    }
}

/// Whether text with a character needs shaping: it runs from right to left, is joined or reordered with its neighbours,
/// or combines with the previous one. Text is drawn from left to right, one glyph for each character.
fn needs_shaping(character: char) -> bool {
    matches!(
        u32::from(character),
        // Combining marks; Hebrew to Arabic; Devanagari to Myanmar; Jamo; Khmer and Mongolian; marks; presentation forms;
        // other scripts from right to left; other Indic scripts.
        0x300..=0x36f
            | 0x590..=0x8ff
            | 0x900..=0x109f
            | 0x1100..=0x11ff
            | 0x1700..=0x18af
            | 0x1900..=0x1cff
            | 0x1dc0..=0x1dff
            | 0x20d0..=0x20ff
            | 0xa800..=0xabff
            | 0xfb1d..=0xfdff
            | 0xfe20..=0xfe2f
            | 0xfe70..=0xfefc
            | 0x1_0800..=0x1_0fff
            | 0x1_1000..=0x1_1fff
            | 0x1_e800..=0x1_efff
    )
}

/// The remedy for a text that holds a number, perhaps with a decimal comma.
fn unquoted(text: &str, is_whole: bool) -> Option<String> {
    let number = text.trim().replacen(',', ".", 1);
    let is_one = number.chars().all(|c| c.is_ascii_digit() || "+-.eE_".contains(c));
    let table = format!("number = {number}");
    let typed = DeTable::parse(&table).ok().filter(|_| is_one)?;
    let kind = |one: &DeValue<'_>| matches!(one, DeValue::Integer(_)) || !is_whole && matches!(one, DeValue::Float(_));
    typed.get_ref().get("number").filter(|one| kind(one.get_ref()))?;
    let comma = if text.contains(',') { ", with a decimal point" } else { "" };
    Some(format!("write {number}: a number without quotation marks{comma}"))
}

/// The alternative of a schema that has the type of a value, of several tables the first one that knows most of its keys.
fn alternative<'s>(schema: &'s Json, value: &DeValue<'_>) -> Option<&'s Json> {
    let known = |branch: &&Json| {
        let keys = value.as_table().into_iter().flat_map(|table| table.keys());
        keys.filter(|key| branch["properties"].get(key.get_ref().as_ref()).is_some()).count()
    };
    schema.get("anyOf")?.as_array()?.iter().filter(|branch| fits(branch, value)).rev().max_by_key(known)
}

/// Whether a value has the type of a schema without alternatives.
fn fits(schema: &Json, value: &DeValue<'_>) -> bool {
    let name = schema.get("type").and_then(Json::as_str).or_else(|| choices(schema).map(|_| "string"));
    match name {
        Some("number") => matches!(value, DeValue::Integer(_) | DeValue::Float(_)),
        Some("integer") => value.is_integer(),
        Some("string") => value.is_str(),
        Some("boolean") => value.is_bool(),
        Some("array") => value.is_array(),
        Some("object") => value.is_table(),
        _ => true,
    }
}
