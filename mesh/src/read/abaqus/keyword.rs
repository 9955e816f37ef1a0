//! Keywords and their parameters.

use super::{capitals, data};
use crate::read::ReadError;
use crate::read::source::Source;
use std::collections::HashMap;

pub(super) struct Keyword<'b> {
    pub(super) line: Source<'b>,
    /// Its name in capitals.
    pub(super) name: String,
    /// The names of its parameters in capitals, and their values as typed.
    pub(super) parameters: HashMap<String, String>,
}

impl<'b> Keyword<'b> {
    /// The keyword in a line and in those that continue it. Programs also write a comma behind the last parameter.
    pub(super) fn new(line: Source<'b>, source: &mut Source<'b>) -> Self {
        let words = |line: &Source<'_>| String::from_utf8_lossy(line.rest().trim_ascii()).into_owned();
        let mut text = words(&line);
        while text.ends_with(',') {
            let mut next = source.clone();
            let Some(more) = data(&mut next).map(|more| words(&more)).filter(|more| is_parameter(more)) else { break };
            text += &more;
            *source = next;
        }
        let mut parts = text[1..].split(',');
        let name = capitals(parts.next().unwrap_or_default());
        let parameter = |part: &str| {
            let (name, value) = part.split_once('=').unwrap_or((part, ""));
            (capitals(name), value.trim().trim_matches('"').to_owned())
        };
        Self { line, name, parameters: parts.map(parameter).collect() }
    }

    pub(super) fn get(&self, parameter: &str) -> Option<&str> {
        self.parameters.get(parameter).map(|value| &**value)
    }

    /// The value of a parameter that it needs.
    pub(super) fn needed(&self, parameter: &str) -> Result<&str, ReadError> {
        let found = self.get(parameter).filter(|value| !value.is_empty());
        found.ok_or_else(|| self.wrong(&format!("the keyword with `{parameter}`")))
    }

    pub(super) fn wrong(&self, expected: &str) -> ReadError {
        self.line.found(&format!("*{}", self.name), self.line.at, expected)
    }
}

/// Whether a line begins with a parameter, not with data: with a name and a value, or with a name that has none.
fn is_parameter(line: &str) -> bool {
    let first = line.split(',').next().unwrap_or_default();
    first.contains('=') || ["GENERATE", "INTERNAL", "UNSORTED"].contains(&&*capitals(first))
}
