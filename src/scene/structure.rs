//! Checks the structure of a scene file against the schema: keys, types, ranges, lengths and choices.

use super::report::{Report, Way, written};
use super::schema::{choices, variants};
use super::step::FractionOfCycle;
use super::words::{self, list, nearest, quoted};
use serde_json::{Map, Value as Json};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The largest magnitude of any number (SI). Beyond it squares and volumes leave the range of double precision.
const LARGEST: f64 = 1e30;

/// Checks a whole file. The result is the file as JSON, without whatever has a mistake in it: a key of the top
/// level or an entry of a top-level array is there as a whole, or null, so that the sound parts can be looked at
/// further.
pub(super) fn check(schema: &Json, root: &DeTable<'_>, report: &mut Report<'_>) -> Map<String, Json> {
    let mut walk = Walk { report, path: Vec::new() };
    walk.table_rules(schema, root, 0..0);
    let mut sound = Map::new();
    for (key, value) in root.iter() {
        let name = key.get_ref().as_ref();
        walk.path.push(Way::Key(name));
        let part = match schema["properties"].get(name) {
            None => {
                walk.unknown_key(schema, name, key.span());
                Json::Null
            }
            Some(inner) => match value.get_ref().as_array() {
                Some(items) if inner["type"] == "array" => {
                    walk.lengths(inner, "entries", "entry", items.len(), value.span());
                    Json::Array(walk.entries(inner, items))
                }
                _ => walk.guarded(inner, value),
            },
        };
        walk.path.pop();
        sound.insert(name.into(), part);
    }
    sound
}

struct Walk<'r, 't, 'p> {
    report: &'r mut Report<'t>,
    path: Vec<Way<'p>>,
}

impl<'p> Walk<'_, '_, 'p> {
    fn mistake(&mut self, span: Range<usize>, message: String, help: Option<String>) {
        self.report.at_span(span, message, help);
    }

    fn here(&self) -> String {
        written(&self.path)
    }

    /// A value as JSON, or null if there is any mistake in it.
    fn guarded(&mut self, schema: &Json, value: &'p Spanned<DeValue<'p>>) -> Json {
        let before = self.report.total();
        let json = self.value(schema, value);
        if self.report.total() == before { json } else { Json::Null }
    }

    fn entries(&mut self, schema: &Json, items: &'p [Spanned<DeValue<'p>>]) -> Vec<Json> {
        let nothing = Json::Bool(true);
        let inner = schema.get("items").unwrap_or(&nothing);
        let mut entries = Vec::with_capacity(items.len());
        for (index, item) in items.iter().enumerate() {
            self.path.push(Way::Index(index));
            entries.push(self.guarded(inner, item));
            self.path.pop();
        }
        entries
    }

    fn value(&mut self, schema: &Json, value: &'p Spanned<DeValue<'p>>) -> Json {
        if let Some(branches) = schema.get("anyOf").and_then(Json::as_array) {
            return match branches.iter().find(|branch| fits(branch, value.get_ref())) {
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
            DeValue::Table(table) => self.table(schema, table, value.span()),
        }
    }

    fn wrong_type(&mut self, schema: &Json, value: &Spanned<DeValue<'_>>) -> Json {
        let mut help = schema.get("description").and_then(Json::as_str).map(String::from);
        if let [Way::Key(key)] = self.path[..] {
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
        let message = format!("`{}` is {}; expected {}", self.here(), words::found(value.get_ref()), expected(schema));
        self.mistake(value.span(), message, help);
        Json::Null
    }

    fn string(&mut self, schema: &Json, text: &str, span: Range<usize>) -> Json {
        if let Some(choices) = choices(schema) {
            if !choices.contains(&text) {
                let message =
                    format!("`{}` is {}; expected {}", self.here(), quoted(text), list(&choices, "or", quoted));
                self.mistake(
                    span,
                    message,
                    nearest(text, &choices).map(|name| format!("did you mean {}?", quoted(name))),
                );
            }
        } else if schema["format"] == "fraction-of-T" {
            if let Err(expected) = text.parse::<FractionOfCycle>() {
                let message = format!("`{}` is {}; {expected}, or seconds as a number", self.here(), quoted(text));
                self.mistake(span, message, None);
            }
        } else {
            self.lengths(schema, "characters", "character", text.chars().count(), span.clone());
            if let Some(control) = text.chars().find(|c| c.is_control()) {
                let message =
                    format!("`{}` holds the control character {control:?}; it is one line of text", self.here());
                self.mistake(span, message, None);
            }
        }
        Json::String(text.into())
    }

    fn number(&mut self, schema: &Json, value: &Spanned<DeValue<'_>>) -> Json {
        let whole = schema["type"] == "integer";
        let (text, number) = match value.get_ref() {
            DeValue::Integer(integer) => (integer.to_string(), words::to_f64(integer)),
            DeValue::Float(float) => (float.to_string(), float.as_str().parse().unwrap_or(f64::NAN)),
            _ => return Json::Null,
        };
        let bound = |name: &str| schema.get(name).and_then(Json::as_f64);
        let (least, most) = (bound("minimum"), bound("maximum"));
        let (above, below) = (bound("exclusiveMinimum"), bound("exclusiveMaximum"));
        let inside = least.is_none_or(|least| number >= least)
            && most.is_none_or(|most| number <= most)
            && above.is_none_or(|above| number > above)
            && below.is_none_or(|below| number < below);
        if number.is_finite() && inside && number.abs() <= LARGEST {
            // Whole numbers are within the 32 bits of their range here.
            return if whole { Json::from(number as i64) } else { Json::from(number) };
        }
        let expected = if !number.is_finite() && !text.starts_with(|c: char| c.is_ascii_digit()) {
            "a finite number".into()
        } else if inside {
            format!("a magnitude up to {LARGEST:e}")
        } else {
            range(if whole { "a whole number" } else { "a number" }, least, most, above, below)
        };
        let help = schema.get("description").and_then(Json::as_str).map(String::from);
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
            Some((_, branch)) => self.table(branch, table, span),
            None => {
                let found = words::found(given.get_ref());
                let message = format!("`{}.{tag}` is {found}; expected {}", self.here(), list(&names, "or", quoted));
                let near = given.get_ref().as_str().and_then(|name| nearest(name, &names));
                self.mistake(given.span(), message, near.map(|name| format!("did you mean {}?", quoted(name))));
                Json::Null
            }
        }
    }

    fn table(&mut self, schema: &Json, table: &'p DeTable<'p>, span: Range<usize>) -> Json {
        self.table_rules(schema, table, span);
        let mut json = Map::new();
        for (key, value) in table.iter() {
            let name = key.get_ref().as_ref();
            self.path.push(Way::Key(name));
            match schema["properties"].get(name) {
                None => self.unknown_key(schema, name, key.span()),
                Some(inner) => {
                    json.insert(name.into(), self.value(inner, value));
                }
            }
            self.path.pop();
        }
        Json::Object(json)
    }

    /// Which keys a table needs, which need each other and which exclude each other.
    fn table_rules(&mut self, schema: &Json, table: &DeTable<'_>, span: Range<usize>) {
        let has = |name: &str| table.contains_key(name);
        let within = match self.path.as_slice() {
            [] => String::new(),
            path => format!("`{}` has ", written(path)),
        };
        for name in strings(schema.get("required")).filter(|name| !has(name)) {
            let property = &schema["properties"][name];
            let missing = match (self.path.is_empty(), property["type"].as_str()) {
                (true, Some("object")) => format!("there is no table [{name}]"),
                (true, Some("array")) => format!("there is no table [[{name}]]"),
                (true, _) => format!("there is no `{name}`"),
                (false, _) => format!("{within}no `{name}`"),
            };
            let help = property["description"].as_str().map(|text| format!("`{name}`: {text}"));
            self.mistake(span.clone(), missing, help);
        }
        let sets: Vec<Vec<&str>> = match schema.get("oneOf").and_then(Json::as_array) {
            Some(branches) => branches.iter().map(|branch| strings(branch.get("required")).collect()).collect(),
            None => Vec::new(),
        };
        let first_key = |set: &Vec<&str>| set.iter().find_map(|name| table.get_key_value(*name));
        let begun: Vec<_> = sets.iter().filter(|set| first_key(set).is_some()).collect();
        let name_set = |set: &Vec<&str>| list(set, "and", |name| format!("`{name}`"));
        match begun.as_slice() {
            [] if !sets.is_empty() => {
                let all: Vec<_> = sets.iter().map(name_set).collect();
                self.mistake(
                    span,
                    format!("{within}neither {}; one is needed", list(&all, "nor", |set| set.into())),
                    None,
                );
            }
            [] => {}
            [only] => {
                for name in only.iter().filter(|name| !has(name)) {
                    let given: Vec<_> = only.iter().copied().filter(|name| has(name)).collect();
                    let message = format!("{within}{} but no `{name}`", name_set(&given));
                    let help = schema["properties"][name]["description"].as_str();
                    self.mistake(span.clone(), message, help.map(|text| format!("`{name}`: {text}")));
                }
            }
            [one, .., other] => {
                if let (Some((first, _)), Some((second, _))) = (first_key(one), first_key(other)) {
                    let message = format!("{within}both `{}` and `{}`; keep one", first.get_ref(), second.get_ref());
                    let later = if first.span().start > second.span().start { first } else { second };
                    self.mistake(later.span(), message, None);
                }
            }
        }
        self.dependencies(schema, table, &sets);
    }

    fn dependencies(&mut self, schema: &Json, table: &DeTable<'_>, sets: &[Vec<&str>]) {
        let Some(dependent) = schema.get("dependentRequired").and_then(Json::as_object) else { return };
        for (name, needed) in dependent {
            let Some((key, _)) = table.get_key_value(name.as_str()) else { continue };
            for other in strings(Some(needed)).filter(|other| !table.contains_key(*other)) {
                // An alternative that is begun but not complete has been said already.
                if !sets.iter().any(|set| set.contains(&name.as_str()) && set.contains(&other)) {
                    let message = format!("`{}.{name}` needs `{other}`", self.here());
                    self.mistake(key.span(), message, Some(format!("list `{other}`, or take `{name}` out")));
                }
            }
        }
    }

    fn unknown_key(&mut self, schema: &Json, name: &str, span: Range<usize>) {
        let known: Vec<&str> =
            schema["properties"].as_object().into_iter().flatten().map(|(key, _)| key.as_str()).collect();
        let place = match &self.path[..] {
            [before @ .., _] if !before.is_empty() => format!(" in `{}`", written(before)),
            _ => String::new(),
        };
        let help = match nearest(name, &known) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("known here: {}", known.join(", ")),
        };
        self.mistake(span, format!("unknown key `{}`{place}", words::shortened(name)), Some(help));
    }
}

/// The strings in a JSON array.
fn strings(list: Option<&Json>) -> impl Iterator<Item = &str> {
    list.and_then(Json::as_array).into_iter().flatten().filter_map(Json::as_str)
}

/// Whether a value is of the type that a schema without alternatives asks for.
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

/// The types that a schema allows, in words.
fn expected(schema: &Json) -> String {
    if let Some(branches) = schema.get("anyOf").and_then(Json::as_array) {
        let names: Vec<_> = branches.iter().map(expected).collect();
        return list(&names, "or", |name| name.into());
    }
    if let Some(choices) = choices(schema) {
        return list(&choices, "or", quoted);
    }
    match schema.get("type").and_then(Json::as_str) {
        Some("number") => "a number",
        Some("integer") => "a whole number",
        Some("string") => "a string",
        Some("boolean") => "true or false",
        Some("array") => "an array",
        _ => "a table",
    }
    .into()
}

fn range(noun: &str, least: Option<f64>, most: Option<f64>, above: Option<f64>, below: Option<f64>) -> String {
    match (least, most, above, below) {
        (Some(least), Some(most), ..) => format!("{noun} from {least} to {most}"),
        (Some(least), ..) => format!("{noun} of at least {least}"),
        (None, _, Some(above), Some(below)) => format!("{noun} between {above} and {below}"),
        (None, _, Some(above), None) => format!("{noun} greater than {above}"),
        (None, Some(most), ..) => format!("{noun} of at most {most}"),
        _ => noun.into(),
    }
}
