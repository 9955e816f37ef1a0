//! Input files of Abaqus and CalculiX (`.inp`): nodes, elements, and sets of both
//! (<https://abaqus-docs.mit.edu/2017/English/SIMACAEKEYRefMap/simakey-c-intro.htm>, <https://www.calculix.de>).

mod keyword;
mod sets;

use super::builder::Builder;
use super::gmsh::Kind;
use super::meshing::BESIDE;
use super::source::{DAMAGED, Scalar, Source};
use super::tags::{self, Tags};
use super::{Cells, Format, Limits, ReadError, content};
use keyword::Keyword;
use std::collections::BTreeMap;

struct Reader<'b> {
    source: Source<'b>,
    builder: Builder,
    /// The numbers of nodes and of elements.
    tags: [Tags; 2],
    /// The sets of nodes and of elements by their names in capitals: the name as typed, and the members.
    sets: [BTreeMap<String, (String, Vec<u32>)>; 2],
    /// The number of elements of each type that is not read.
    skipped: BTreeMap<String, usize>,
    /// The numbers of parts and of instances.
    parts: [usize; 2],
    /// The number of sets of an assembly that name no instance.
    left_out: usize,
    /// Whether keywords are about an assembly, whose nodes are points of reference with numbers of their own.
    is_assembly: bool,
}

const NODES: usize = 0;
const ELEMENTS: usize = 1;

pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Cells, ReadError> {
    let (mut source, builder) = (Source::text(bytes), Builder::new(limits));
    source.continues = false;
    let (tags, sets, skipped, parts, left_out, is_assembly) = Default::default();
    let mut reader = Reader { source, builder, tags, sets, skipped, parts, left_out, is_assembly };
    let mut is_begun = false;
    while let Some(line) = line(&mut reader.source) {
        if line.rest().starts_with(b"*") {
            let keyword = Keyword::new(line, &mut reader.source);
            reader.read(&keyword)?;
            is_begun = true;
        } else if !is_begun {
            return Err(content::no_beginning(bytes, Format::Abaqus, "a keyword, such as `*NODE`"));
        }
    }
    reader.finish()
}

/// The next line that is neither empty nor a comment.
fn line<'b>(source: &mut Source<'b>) -> Option<Source<'b>> {
    std::iter::from_fn(|| source.next_line()).find(|line| !line.rest().starts_with(b"**"))
}

/// The next line of data, before the next keyword.
fn data<'b>(source: &mut Source<'b>) -> Option<Source<'b>> {
    let mut next = source.clone();
    let found = line(&mut next).filter(|line| !line.rest().starts_with(b"*"))?;
    *source = next;
    Some(found)
}

/// What is read alone in a field.
fn alone<T>(mut field: Source<'_>, read: impl FnOnce(&mut Source<'_>) -> Result<T, ReadError>) -> Result<T, ReadError> {
    let found = read(&mut field)?;
    let more = field.word();
    if more.is_empty() { Ok(found) } else { Err(field.wrong(more, "a comma")) }
}

fn integer(field: Source<'_>, expected: &str) -> Result<i64, ReadError> {
    alone(field, |field| field.integer(Scalar::I64, expected))
}

/// Letters as they are compared.
fn capitals(text: &str) -> String {
    text.split_whitespace().collect::<String>().to_uppercase()
}

impl Reader<'_> {
    fn read(&mut self, keyword: &Keyword<'_>) -> Result<(), ReadError> {
        let has = |parameter: &str| keyword.get(parameter).is_some();
        let is_partial = match &*keyword.name {
            "INCLUDE" | "NGEN" | "NFILL" | "NCOPY" | "NMAP" | "ELGEN" | "ELCOPY" | "SYSTEM" => true,
            "NODE" if keyword.get("SYSTEM").is_some_and(|system| !system.eq_ignore_ascii_case("R")) => true,
            "NODE" | "ELEMENT" | "NSET" | "ELSET" => has("INPUT") || has("OFFSET"),
            _ => false,
        };
        if is_partial {
            let message = keyword.wrong("all nodes and elements in this file, with x, y and z").message;
            return Err(ReadError::new(message, "write the whole mesh from the program that made it"));
        }
        match &*keyword.name {
            "NODE" | "ELEMENT" if self.is_assembly => Ok(()),
            "NSET" | "ELSET" if self.is_assembly && !has("INSTANCE") => {
                self.left_out += 1;
                Ok(())
            }
            "NODE" => self.nodes(keyword),
            "ELEMENT" => self.elements(keyword),
            "NSET" => self.set(NODES, keyword),
            "ELSET" => self.set(ELEMENTS, keyword),
            "PART" | "INSTANCE" => self.part(keyword),
            "ASSEMBLY" | "ENDINSTANCE" | "ENDASSEMBLY" => {
                self.is_assembly = keyword.name != "ENDASSEMBLY";
                Ok(())
            }
            // Materials, loads, steps and others.
            _ => Ok(()),
        }
    }

    /// Begins the only part or the only instance, which may have nodes and elements of its own.
    fn part(&mut self, keyword: &Keyword<'_>) -> Result<(), ReadError> {
        self.is_assembly = false;
        let known = &mut self.parts[usize::from(keyword.name == "INSTANCE")];
        *known += 1;
        let mut is_other = *known > 1;
        while let Some(line) = data(&mut self.source) {
            for (_, field) in line.fields() {
                is_other |= alone(field, |field| field.float(Scalar::F64, "a translation"))? != 0.0;
            }
        }
        if is_other {
            let message = keyword.wrong("a single part with a single instance, which is not moved").message;
            return Err(ReadError::new(
                message,
                "write it without parts, which is an attribute of models in Abaqus/CAE",
            ));
        }
        Ok(())
    }

    /// Adds members to the set that a keyword names.
    fn add(&mut self, kind: usize, name: Option<&str>, members: impl IntoIterator<Item = u32>) {
        if let Some(name) = name {
            self.sets[kind].entry(capitals(name)).or_insert((name.to_owned(), Vec::new())).1.extend(members);
        }
    }

    fn nodes(&mut self, keyword: &Keyword<'_>) -> Result<(), ReadError> {
        let mut members = Vec::new();
        while let Some(line) = data(&mut self.source) {
            let (mut tag, mut point) = (None, [0.0; 3]);
            for (at, field) in line.fields() {
                if at == 0 {
                    tag = Some(integer(field, "the number of a node")?);
                } else if let Some(number) = point.get_mut(at - 1) {
                    *number = alone(field, |field| field.coordinate(Scalar::F64))?;
                } else {
                    let place = line.place(line.at);
                    let message = format!("has more than a number and three coordinates of a node {place}");
                    return Err(ReadError::new(message, "write decimal points, not commas, and no normals"));
                }
            }
            let tag = tag.ok_or_else(|| line.found(",", line.at, "the number of a node"))?;
            members.push(self.tags[NODES].node(tag, point.into(), line.at, &line, &mut self.builder)?);
        }
        self.add(NODES, keyword.get("NSET"), members);
        Ok(())
    }

    fn elements(&mut self, keyword: &Keyword<'_>) -> Result<(), ReadError> {
        let name = capitals(keyword.needed("TYPE")?);
        let (kind, first) = (kind(&name), self.builder.cells.kinds.len() as u32);
        // The number and the nodes of an element, which may go on in further lines.
        let (mut tag, mut found) = (None, Vec::new());
        let mut last = keyword.line.clone();
        while let Some(line) = data(&mut self.source) {
            let Some(kind) = kind else {
                let is_last = !line.rest().trim_ascii_end().ends_with(b",");
                *self.skipped.entry(name.clone()).or_default() += usize::from(is_last);
                continue;
            };
            for (_, field) in line.fields() {
                let start = field.at;
                let number = integer(field, "the number of a node")?;
                match tag {
                    None => tag = Some(number),
                    Some(_) => found.push(self.tags[NODES].find(number, "node", start, &line)?),
                }
            }
            last = line;
            if let Some(number) = tag.filter(|_| found.len() == kind.nodes) {
                let before = self.tags[ELEMENTS].get(number).map(|before| before as usize);
                let new = self.builder.cells.kinds.len();
                self.builder.is_curved |= kind.nodes > kind.corners;
                self.builder.around(kind.cell, &found[..kind.corners])?;
                let cells = &self.builder.cells;
                let is_equal = |before: usize| {
                    cells.kinds[before] == cells.kinds[new] && cells.corners[before] == cells.corners[new]
                };
                if before.is_some_and(|before| !is_equal(before)) {
                    return Err(tags::twice("element", number, "", last.place(last.at)));
                }
                self.tags[ELEMENTS].push(number, new as u32);
                tag = None;
                found.clear();
            } else if found.len() > kind.nodes {
                break;
            }
        }
        if let (Some(_), Some(Kind { nodes, .. })) = (tag, kind) {
            let (count, place) = (found.len(), last.place(last.at));
            let message = format!("has an element with {count} nodes {place}; expected {nodes}, as {name} has");
            return Err(ReadError::new(message, DAMAGED));
        }
        self.add(ELEMENTS, keyword.get("ELSET"), first..self.builder.cells.kinds.len() as u32);
        Ok(())
    }

    fn finish(mut self) -> Result<Cells, ReadError> {
        if !self.skipped.is_empty() {
            let all = self.skipped.iter().take(8).map(|(name, count)| format!("{count} of the type {name}"));
            let note = format!("has elements that are not read: {}", all.collect::<Vec<_>>().join(", "));
            if self.builder.is_empty() {
                return Err(ReadError::new(note, "mesh the object with solid, plane or shell elements"));
            }
            self.builder.cells.notes.push(note);
        }
        if self.left_out > 0 {
            let note = format!("has sets of its assembly without `INSTANCE`, which are not read: {}", self.left_out);
            self.builder.cells.notes.push(note);
        }
        let thin = self.builder.cells.kinds.iter().filter(|kind| !kind.is_solid()).count();
        if (1..self.builder.cells.kinds.len()).contains(&thin) {
            self.builder.cells.notes.push(format!("{BESIDE}: {thin}"));
        }
        let [nodes, elements] = self.sets;
        for (key, (name, members)) in elements {
            // Programs write the elements at a face beside its nodes, under one name.
            if !nodes.contains_key(&key) {
                let corners = members.iter().flat_map(|&member| &self.builder.cells.corners[member as usize]);
                let points: Vec<u32> = corners.copied().collect();
                self.builder.spend(points.len())?;
                self.builder.group(name, points);
            }
        }
        nodes.into_values().for_each(|(name, members)| self.builder.group(name, members));
        self.builder.finish(&self.source, 1)
    }
}

/// The kind of the elements of a type: a family, the number of nodes, of which the corners stand first, and letters.
fn kind(name: &str) -> Option<Kind> {
    /// The families of lines, of faces and of solids.
    const FAMILIES: [&str; 3] = ["T2D T3D", "CPS CPE M3D R3D SFM3D STRI S", "C3D DC3D AC3D SC"];
    let mut all =
        (1..).zip(FAMILIES).flat_map(|(dimension, all)| all.split(' ').map(move |family| (dimension, family)));
    all.find_map(|(dimension, family)| {
        let rest = name.strip_prefix(family)?;
        let end = rest.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(rest.len());
        // Elements with a V have a variable number of nodes.
        Kind::with(dimension, rest[..end].parse().ok().filter(|_| !rest.ends_with('V'))?)
    })
}
