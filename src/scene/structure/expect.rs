//! The expectations of a schema in words.

use crate::reading::words::{list, quoted};
use crate::scene::schema::choices;
use serde_json::Value as Json;

/// The types that a schema allows, in words.
pub(super) fn expected(schema: &Json) -> String {
    if let Some(branches) = schema.get("anyOf").and_then(Json::as_array) {
        let mut names: Vec<_> = branches.iter().map(expected).collect();
        names.dedup();
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

/// The numbers that a schema allows, in words.
pub(in crate::scene) fn range(noun: &str, schema: &Json) -> String {
    let bound = |keyword: &str| schema[keyword].as_f64();
    let (least, above, below) = (bound("minimum"), bound("exclusiveMinimum"), bound("exclusiveMaximum"));
    // The limit of 32 bits is an implementation detail.
    let most = bound("maximum").filter(|&most| most < f64::from(u32::MAX));
    match (least, most, above, below) {
        (Some(least), Some(most), ..) => format!("{noun} from {least} to {most}"),
        (Some(least), _, _, Some(below)) => format!("{noun} from {least} to less than {below}"),
        (Some(least), ..) => format!("{noun} of at least {least}"),
        (None, _, Some(above), Some(below)) => format!("{noun} between {above} and {below}"),
        (None, Some(most), Some(above), None) => format!("{noun} greater than {above}, up to {most}"),
        (None, None, Some(above), None) => format!("{noun} greater than {above}"),
        (None, Some(most), ..) => format!("{noun} of at most {most}"),
        _ => noun.into(),
    }
}

/// The first sentence of a description.
pub(in crate::scene) fn first_sentence(text: &str) -> &str {
    let ends = text.match_indices(". ").find(|(at, _)| text[at + 2..].starts_with(char::is_uppercase));
    ends.map_or(text, |(at, _)| &text[..=at])
}
