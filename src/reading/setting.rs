//! Values that a command sets in place of values in a file: `run[0].model.stiffness=1e4`.

use super::beside;
use super::collector::Collector;
use super::words::{found, list, nearest, quoted, shortened};
use std::borrow::Cow;
use std::ops::Range;
use std::str::FromStr;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// A key, written as messages write it, and a value in its place: `run[0].model.stiffness=1e4`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// The text as typed.
    text: String,
    /// The parts of the key, and their places in the text.
    parts: Vec<(Segment, Range<usize>)>,
    /// The place of the value in the text.
    value: Range<usize>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Segment {
    /// Into a table.
    Key(String),
    /// Into an array.
    Index(usize),
    /// To the entry of an array that has this `name`.
    Named(String),
}

impl FromStr for Setting {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const EXPECTED: &str = "expected KEY=VALUE, such as time.duration=2 or run[0].model.stiffness=1e4";
        let is_key = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
        let (mut parts, mut at) = (Vec::new(), 0);
        loop {
            let end = at + text[at..].find(|c| !is_key(c)).filter(|&length| length > 0).ok_or(EXPECTED)?;
            parts.push((Segment::Key(text[at..end].to_owned()), at..end));
            at = end;
            while let Some(rest) = text[at..].strip_prefix('[') {
                // A shell removes the quotation marks, unless others are around the option.
                let close = if rest.starts_with('"') { "\"]" } else { "]" };
                let length = rest.find(close).ok_or(EXPECTED)?;
                let inside = rest[..length].trim_start_matches('"');
                let index = inside.parse().ok().filter(|_| close == "]");
                let part = index.map_or_else(|| Segment::Named(inside.to_owned()), Segment::Index);
                let end = at + 1 + length + close.len();
                parts.push((part, at..end));
                at = end;
            }
            match text[at..].strip_prefix('.') {
                Some(_) => at += 1,
                None => break,
            }
        }
        let typed = text[at..].trim_start().strip_prefix('=').ok_or(EXPECTED)?;
        let (value, start) = (typed.trim(), text.len() - typed.trim_start().len());
        Ok(Self { parts, value: start..start + value.len(), text: text.to_owned() })
    }
}

impl Setting {
    /// The key as typed.
    pub fn key(&self) -> &str {
        self.parts.last().map_or("", |(_, last)| &self.text[..last.end])
    }

    /// The names in the key, without entries of arrays.
    pub(crate) fn keys(&self) -> Vec<&str> {
        let names = self.parts.iter().map(|(part, _)| if let Segment::Key(name) = part { Some(&**name) } else { None });
        names.flatten().collect()
    }

    /// The text as typed.
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// Sets the value in a file. `typed`, the text of this setting, begins at the byte `start` of a longer text.
    ///
    /// # Errors
    /// If the key leads nowhere, or the value is not TOML.
    pub(crate) fn apply<'t>(&self, root: &mut Spanned<DeValue<'t>>, typed: &'t str, start: usize) -> Result<(), Wrong> {
        let value = &typed[self.value.clone()];
        let at = |range: &Range<usize>| start + range.start..start + range.end;
        let new = match DeValue::parse(value) {
            Ok(new) => moved(new, start + self.value.start),
            // Text that begins like this is not a word without quotation marks.
            Err(_) if value.starts_with(['[', '{', '"', '\'']) => {
                let message = format!("`{}` is not TOML", shortened(value));
                let help = "in a shell, quotation marks need others around the whole: --set 'view.labels=[\"name\"]'";
                return Err(Wrong { span: at(&self.value), message, help: Some(help.to_owned()) });
            }
            Err(_) => Spanned::new(at(&self.value), DeValue::String(Cow::Borrowed(value))),
        };
        let mut slot = root;
        for (number, (part, span)) in self.parts.iter().enumerate() {
            let here = || self.text[..span.start].trim_end_matches('.');
            let then_array = self.parts.get(number + 1).is_some_and(|(next, _)| !matches!(next, Segment::Key(_)));
            let wrong = |(message, help)| Wrong { span: at(span), message, help };
            slot = match part {
                Segment::Key(key) => in_table(slot, key, at(span), then_array, here).map_err(wrong)?,
                Segment::Index(_) | Segment::Named(_) => in_array(slot, part, here()).map_err(wrong)?,
            };
        }
        *slot = new;
        Ok(())
    }
}

/// A mistake in a setting, and its place in the text of all settings.
pub(crate) struct Wrong {
    span: Range<usize>,
    message: String,
    help: Option<String>,
}

impl Wrong {
    /// Reports the mistake, unless one in the same setting is known, such as an unknown key.
    pub(crate) fn report(self, report: &Collector<'_>) {
        if !report.has_mistake_in_line_of(self.span.start) {
            report.at_span(self.span, &[], self.message, self.help);
        }
    }
}

/// The value of a key in the table at `here`. A missing one is created, as an array or a table according to the next
/// part of the key.
fn in_table<'s, 't>(
    slot: &'s mut Spanned<DeValue<'t>>,
    key: &str,
    span: Range<usize>,
    then_array: bool,
    here: impl Fn() -> &'s str,
) -> Result<&'s mut Spanned<DeValue<'t>>, beside::Wrong> {
    let what = found(slot.get_ref());
    let DeValue::Table(table) = slot.get_mut() else {
        let is_array = what.starts_with("an array");
        let here = here();
        let help = is_array.then(|| format!("write `{here}[0]` for its first entry"));
        return Err((format!("`{here}` is {what}; expected a table"), help));
    };
    if !table.contains_key(key) {
        let empty = if then_array { DeValue::Array(DeArray::default()) } else { DeValue::Table(DeTable::new()) };
        table.insert(Spanned::new(span.clone(), Cow::Owned(key.to_owned())), Spanned::new(span, empty));
    }
    Ok(table.get_mut(key).expect("there is one now"))
}

/// The entry of the array at `here`.
fn in_array<'s, 't>(
    slot: &'s mut Spanned<DeValue<'t>>,
    part: &Segment,
    here: &str,
) -> Result<&'s mut Spanned<DeValue<'t>>, beside::Wrong> {
    let what = found(slot.get_ref());
    let DeValue::Array(entries) = slot.get_mut() else {
        return Err((format!("`{here}` is {what}; expected an array"), None));
    };
    let named =
        |entry: &Spanned<DeValue<'_>>| entry.get_ref().as_table()?.get("name")?.get_ref().as_str().map(str::to_owned);
    let names: Vec<_> = entries.iter().filter_map(named).collect();
    let count = entries.len();
    let entries_are = match count {
        0 => "has no entries".to_owned(),
        1 => "has one entry, number 0".to_owned(),
        _ => format!("has {count} entries, numbers 0 to {}", count - 1),
    };
    let index = match part {
        Segment::Index(index) => *index,
        Segment::Named(name) => {
            entries.iter().position(|entry| named(entry).as_ref() == Some(name)).ok_or_else(|| {
                let rest = match &names[..] {
                    [] => format!("`{here}` {entries_are}"),
                    names => format!("their names are {}", list(names, "and", quoted)),
                };
                let names: Vec<_> = names.iter().map(String::as_str).collect();
                let help = nearest(name, &names).map(|near| format!("did you mean {}?", quoted(near)));
                (format!("no entry of `{here}` has the name {}; {rest}", quoted(name)), help)
            })?
        }
        Segment::Key(_) => unreachable!("the caller tells keys from entries"),
    };
    entries.get_mut(index).ok_or_else(|| (format!("there is no `{here}[{index}]`; `{here}` {entries_are}"), None))
}

/// A value whose text is moved by some bytes.
fn moved(value: Spanned<DeValue<'_>>, by: usize) -> Spanned<DeValue<'_>> {
    let shifted = |span: Range<usize>| span.start + by..span.end + by;
    let span = shifted(value.span());
    let inner = match value.into_inner() {
        DeValue::Array(entries) => DeValue::Array(entries.into_iter().map(|entry| moved(entry, by)).collect()),
        DeValue::Table(table) => {
            let entries = table.into_iter().map(|(key, value)| {
                let span = shifted(key.span());
                (Spanned::new(span, key.into_inner()), moved(value, by))
            });
            DeValue::Table(entries.collect())
        }
        plain => plain,
    };
    Spanned::new(span, inner)
}
