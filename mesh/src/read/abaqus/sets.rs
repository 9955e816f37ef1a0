//! Sets of nodes and of elements.

use super::keyword::Keyword;
use super::{ELEMENTS, NODES, Reader, capitals, data, integer};
use crate::read::ReadError;
use crate::read::source::{DAMAGED, Source, quoted};

impl Reader<'_> {
    pub(super) fn set(&mut self, kind: usize, keyword: &Keyword<'_>) -> Result<(), ReadError> {
        let name = keyword.needed(["NSET", "ELSET"][kind])?;
        let missing = |what: &str, name: &str, field: &Source<'_>| {
            let (name, place) = (quoted(name.as_bytes()), field.place(field.at));
            ReadError::new(format!("names the {what} {name} {place}, which it does not have before"), DAMAGED)
        };
        let set = |kind: usize, name: &str, field: &Source<'_>| {
            let found = self.sets[kind].get(&capitals(name));
            found.map(|(_, members)| members).ok_or_else(|| missing("set", name, field))
        };
        let mut members = Vec::new();
        if let (NODES, Some(elements)) = (kind, keyword.get("ELSET")) {
            let elements = set(ELEMENTS, elements, &keyword.line)?;
            for &element in elements {
                let corners = &self.builder.cells.corners[element as usize];
                members.extend(corners);
                self.builder.spend(corners.len())?;
            }
        }
        while let Some(line) = data(&mut self.source) {
            if keyword.parameters.contains_key("GENERATE") {
                let [from, more, step] = generated(&line)?;
                self.builder.spend(usize::try_from(more).unwrap_or(usize::MAX))?;
                members.extend((0..=more).filter_map(|at| self.tags[kind].get(from + at * step)));
                continue;
            }
            for (_, field) in line.fields() {
                let word = String::from_utf8_lossy(field.rest().trim_ascii());
                match word.parse().map(|number| self.tags[kind].get(number)) {
                    Err(_) => {
                        let others = set(kind, word.trim_matches('"'), &field)?;
                        self.builder.spend(others.len())?;
                        members.extend(others);
                    }
                    // Its type may be one that is not read.
                    Ok(None) if kind == ELEMENTS && !self.skipped.is_empty() => {}
                    Ok(None) => return Err(missing(["node", "element"][kind], &word, &field)),
                    Ok(Some(member)) => members.push(member),
                }
            }
        }
        members.sort_unstable();
        members.dedup();
        self.add(kind, Some(name), members);
        Ok(())
    }
}

/// The first number of a range, how many steps follow, and the step.
fn generated(line: &Source<'_>) -> Result<[i64; 3], ReadError> {
    let expected = "a first number, a last one and a step";
    let numbers: Vec<i64> = line.fields().map(|(_, field)| integer(field, expected)).collect::<Result<_, _>>()?;
    match numbers[..] {
        [from, to] if from <= to => Ok([from, to.saturating_sub(from), 1]),
        [from, to, step] if from <= to && step > 0 => Ok([from, to.saturating_sub(from) / step, step]),
        _ => Err(line.found(&String::from_utf8_lossy(line.rest().trim_ascii()), line.at, expected)),
    }
}
