//! The keys of a table: known, required, and needing or excluding each other.

use super::Walk;
use super::expect::first_sentence;
use crate::reading::collector::{PathPart, written};
use crate::reading::words::{list, nearest, quoted, shortened};
use serde_json::Value as Json;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

impl Walk<'_, '_> {
    /// Checks the keys that a table requires, and keys that need or exclude each other.
    pub(super) fn table_rules(&mut self, schema: &Json, table: &DeTable<'_>, span: Range<usize>) {
        let has = |name: &str| table.contains_key(name);
        for name in strings(schema.get("required")).filter(|name| !has(name)) {
            self.missing_key(schema, table, name, "", span.clone());
        }
        self.alternatives(schema, table, span.clone());
        let all_of = schema.get("allOf").and_then(Json::as_array).into_iter().flatten();
        for rule in all_of.chain([schema]).filter_map(|rule| rule.get("not")) {
            let pair: Vec<_> = strings(rule.get("required")).filter_map(|name| table.get_key_value(name)).collect();
            if pair.len() == strings(rule.get("required")).count() {
                self.exclusive(&pair);
            }
        }
        let Some(dependent) = schema.get("dependentRequired").and_then(Json::as_object) else { return };
        for (name, needed) in dependent {
            let Some((key, _)) = table.get_key_value(name.as_str()) else { continue };
            // Missing keys of an alternative were reported.
            let partner = |other: &str| {
                let begun = |set: &Json| {
                    strings(Some(set)).any(|key| key == name) && strings(Some(set)).any(|key| key == other)
                };
                schema["oneOf"].as_array().into_iter().flatten().any(|branch| begun(&branch["required"]))
            };
            for other in strings(Some(needed)).filter(|other| !has(other) && !partner(other)) {
                if !misspelt(schema, table, other) {
                    let message = format!("`{}.{name}` needs `{other}`", self.here());
                    self.mistake(key.span(), message, Some(format!("list `{other}`, or remove `{name}`")));
                }
            }
        }
    }

    /// Reports a missing key, unless an unknown key is similar.
    fn missing_key(&mut self, schema: &Json, table: &DeTable<'_>, name: &str, given: &str, span: Range<usize>) {
        if misspelt(schema, table, name) {
            return;
        }
        let property = &schema["properties"][name];
        let first = property["anyOf"].get(0).unwrap_or(property);
        let missing = match (self.path.is_empty(), first["type"].as_str()) {
            (true, Some("object")) => format!("there is no table [{name}]"),
            (true, Some("array")) => format!("there is no table [[{name}]]"),
            (true, _) => format!("there is no `{name}`"),
            (false, _) => format!("`{}` has {given}no `{name}`", self.here()),
        };
        let help = property["description"].as_str().map(|text| format!("`{name}`: {}", first_sentence(text)));
        self.mistake(span, missing, help);
    }

    /// Checks sets of keys: a table has exactly one complete set.
    fn alternatives(&mut self, schema: &Json, table: &DeTable<'_>, span: Range<usize>) {
        let branches = schema.get("oneOf").and_then(Json::as_array).into_iter().flatten();
        let sets: Vec<Vec<&str>> = branches.map(|branch| strings(branch.get("required")).collect()).collect();
        let given = |set: &Vec<&str>| -> Vec<_> { set.iter().filter_map(|name| table.get_key_value(*name)).collect() };
        let begun: Vec<_> = sets.iter().filter(|set| !given(set).is_empty()).collect();
        match begun.as_slice() {
            [] if sets.iter().flatten().any(|name| misspelt(schema, table, name)) => {}
            [] if !sets.is_empty() => {
                let all: Vec<_> = sets.iter().map(|set| list(set, "and", |name| format!("`{name}`"))).collect();
                let all = list(&all, "nor", |set| set.into());
                self.mistake(span, format!("`{}` has neither {all}; one is needed", self.here()), None);
            }
            [] => {}
            [only] => {
                let there = list(&names(&given(only)), "and", |key| format!("`{key}`"));
                for name in only.iter().filter(|name| !table.contains_key(**name)) {
                    self.missing_key(schema, table, name, &format!("{there} but "), span.clone());
                }
            }
            [one, .., other] => self.exclusive(&[given(one)[0], given(other)[0]]),
        }
    }

    /// Reports keys that exclude each other, at the later one.
    fn exclusive(&mut self, keys: &[(&Spanned<DeString<'_>>, &Spanned<DeValue<'_>>)]) {
        let last = keys.iter().map(|(key, _)| key.span()).max_by_key(|span| span.start);
        let names = list(&names(keys), "and", |key| format!("`{key}`"));
        self.mistake(
            last.unwrap_or(0..0),
            format!("`{}` has both {names}, which exclude each other", self.here()),
            Some("keep one".into()),
        );
    }

    /// Reports an unknown key of a table of one kind. Other `kinds` may have it.
    pub(super) fn unknown_key(&mut self, schema: &Json, name: &str, span: Range<usize>, kinds: &[(&str, &Json)]) {
        // There may be millions of mistakes, and finding a similar name takes long.
        if self.report.only_counted() {
            return;
        }
        let known = known(schema);
        let place = match &self.path[..] {
            [before @ .., _] if !before.is_empty() => format!(" in `{}`", written(before)),
            _ => String::new(),
        };
        let of_kinds = kinds.iter().filter(|(_, kind)| kind["properties"].get(name).is_some());
        let mut others: Vec<_> = of_kinds.map(|(kind, _)| format!("kind = {}", quoted(kind))).collect();
        let help = match nearest(name, &known).filter(|_| others.is_empty()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => {
                let keys =
                    self.path.iter().filter_map(|part| if let PathPart::Key(key) = part { Some(*key) } else { None });
                let here = keys.collect::<Vec<_>>().join(".");
                let elsewhere = elsewhere(self.schema, name).into_iter();
                let tables = elsewhere.filter(|table| here != format!("{table}.{name}"));
                others.extend(tables.map(|table| format!("`{table}`")));
                let others = list(&others, "or", str::to_owned);
                let known = format!("known here: {}", known.join(", "));
                if others.is_empty() { known } else { format!("`{name}` belongs to {others}; {known}") }
            }
        };
        let help = schema["x-instead"][name].as_str().map_or(help, str::to_owned);
        self.mistake(span, format!("unknown key `{}`{place}", shortened(name)), Some(help));
    }
}

/// The strings in a JSON array.
fn strings(list: Option<&Json>) -> impl Iterator<Item = &str> {
    list.and_then(Json::as_array).into_iter().flatten().filter_map(Json::as_str)
}

fn names<'a>(keys: &[(&'a Spanned<DeString<'_>>, &Spanned<DeValue<'_>>)]) -> Vec<&'a str> {
    keys.iter().map(|(key, _)| key.get_ref().as_ref()).collect()
}

/// The keys that a table may have.
fn known(schema: &Json) -> Vec<&str> {
    schema["properties"].as_object().into_iter().flatten().map(|(key, _)| key.as_str()).collect()
}

/// Whether a table has an unknown key similar to this one.
fn misspelt(schema: &Json, table: &DeTable<'_>, name: &str) -> bool {
    let known = known(schema);
    let unknown = table.keys().map(|key| key.get_ref().as_ref()).filter(|key| !known.contains(key));
    unknown.take(1000).any(|key| nearest(key, &known) == Some(name))
}

/// The tables in which a key is known, such as `view.camera`. Deep ones are left out if one near the top has it.
fn elsewhere(schema: &Json, name: &str) -> Vec<String> {
    let properties = || tables(schema).filter_map(|table| table["properties"].as_object()).flatten();
    let knows = |inner: &Json| tables(inner).any(|table| table["properties"].get(name).is_some());
    let here: Vec<_> = properties().filter(|(_, inner)| knows(inner)).map(|(key, _)| key.clone()).collect();
    if !here.is_empty() {
        return here;
    }
    let deeper = |(key, inner)| elsewhere(inner, name).first().map(|found| format!("{key}.{found}"));
    properties().find_map(deeper).into_iter().collect()
}

/// The tables that a schema describes: itself, its entries, and the variants and alternatives of either.
fn tables<'s>(schema: &'s Json) -> impl Iterator<Item = &'s Json> {
    let both = [schema, &schema["items"]].into_iter();
    let variants = |one: &'s Json| ["oneOf", "anyOf"].into_iter().filter_map(|key| one[key].as_array()).flatten();
    both.flat_map(move |one| std::iter::once(one).chain(variants(one)))
}
