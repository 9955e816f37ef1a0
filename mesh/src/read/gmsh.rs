//! Gmsh's format in its versions 2.2 and 4.1 (<https://gmsh.info/doc/texinfo/gmsh.html>, “Gmsh file formats”).
//!
//! Named or numbered physical groups become groups of points. Of elements of higher order the corners are read, which Gmsh lists first.

mod kind;
mod old;

use super::builder::Builder;
use super::source::{Coding, DAMAGED, Scalar, Source, quoted};
use super::tags::Tags;
use super::{Cells, Format, Limits, ReadError, content};
pub(super) use kind::Kind;
use std::collections::HashMap;
use std::rc::Rc;

/// A dimension and the number of an entity or of a group.
type Key = (i64, i64);

struct Reader<'b> {
    source: Source<'b>,
    builder: Builder,
    /// How the numbers of the sections are written.
    coding: Coding,
    /// The type of counts in the version 4.1.
    size: Scalar,
    /// The physical groups of each entity.
    physical: HashMap<Key, Rc<[i64]>>,
    tags: Tags,
}

pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Cells, ReadError> {
    let mut source = Source::text(bytes);
    let mut word = source.word();
    while word == b"$Comments" {
        skip(&mut source, b"Comments")?;
        source.word();
        word = source.word();
    }
    if word != b"$MeshFormat" {
        return Err(content::no_beginning(bytes, Format::Gmsh, "`$MeshFormat`"));
    }
    let version = source.word();
    let is_old = match version {
        b"2" | b"2.0" | b"2.1" | b"2.2" => true,
        b"4.1" => false,
        _ => {
            let message = source.wrong(version, "version 2.2 or 4.1 of Gmsh's format").message;
            return Err(ReadError::new(message, "write it with `gmsh FILE -save -format msh41 -o NEW.msh`"));
        }
    };
    let kind = source.word();
    let size = match source.integer(Scalar::I32, "the size of a number")? {
        4 => Scalar::U32,
        8 => Scalar::U64,
        other => return Err(source.found(&other.to_string(), source.at - 1, "the size 4 or 8 of a number")),
    };
    source.line();
    let coding = match kind {
        b"0" => Coding::Text,
        b"1" => match source.take(4, "the number 1 in binary")? {
            [1, 0, 0, 0] => Coding::Little,
            [0, 0, 0, 1] => Coding::Big,
            _ => return Err(ReadError::new("has no number 1 in binary after its header", DAMAGED)),
        },
        _ => return Err(source.found(&quoted(kind), source.at.saturating_sub(1), "0 for text or 1 for binary")),
    };
    let mut reader =
        Reader { source, builder: Builder::new(limits), coding, size, physical: HashMap::new(), tags: Tags::default() };
    reader.end(b"MeshFormat")?;
    while !reader.source.is_done() {
        let word = reader.source.word();
        let Some(section) = word.strip_prefix(b"$") else {
            return Err(reader.source.wrong(word, "a section that begins with `$`"));
        };
        reader.source.line();
        match (section, is_old) {
            (b"PhysicalNames", _) => reader.physical_names()?,
            (b"Entities", false) => reader.with_coding(|reader| reader.entities(false))?,
            (b"PartitionedEntities", false) => reader.with_coding(|reader| reader.entities(true))?,
            (b"Nodes", true) => reader.old_nodes()?,
            (b"Nodes", false) => reader.with_coding(Reader::nodes)?,
            (b"Elements", true) => reader.old_elements()?,
            (b"Elements", false) => reader.with_coding(Reader::elements)?,
            // Periodic entities, data and others.
            _ => skip(&mut reader.source, section)?,
        }
        reader.end(section)?;
    }
    reader.builder.finish(&reader.source, 0)
}

/// Goes to the end of a section.
fn skip(source: &mut Source<'_>, section: &[u8]) -> Result<(), ReadError> {
    let end = [b"$End", section].concat();
    let length = source.rest().windows(end.len()).position(|window| window == end);
    source.at += length.ok_or_else(|| source.ends(&quoted(&end)))?;
    Ok(())
}

impl Reader<'_> {
    /// Reads a section whose numbers are text or binary.
    fn with_coding(&mut self, read: fn(&mut Self) -> Result<(), ReadError>) -> Result<(), ReadError> {
        self.source.coding = self.coding;
        read(self)?;
        self.source.coding = Coding::Text;
        Ok(())
    }

    fn end(&mut self, section: &[u8]) -> Result<(), ReadError> {
        let word = self.source.word();
        let expected = [b"$End", section].concat();
        if word == expected { Ok(()) } else { Err(self.source.wrong(word, &quoted(&expected))) }
    }

    fn int(&mut self, expected: &str) -> Result<i64, ReadError> {
        self.source.integer(Scalar::I32, expected)
    }

    fn count(&mut self, expected: &str) -> Result<u64, ReadError> {
        self.source.count(self.size, expected)
    }

    fn physical_names(&mut self) -> Result<(), ReadError> {
        for _ in 0..self.source.count(Scalar::I32, "the number of names")? {
            let dimension = self.source.integer(Scalar::I32, "the dimension of a group")?;
            let tag = self.source.integer(Scalar::I32, "the number of a group")?;
            let line = self.source.line().trim_ascii();
            let name = line.strip_prefix(b"\"").and_then(|name| name.strip_suffix(b"\"")).unwrap_or(line);
            self.builder.set_names.insert((dimension, tag), String::from_utf8_lossy(name).into_owned());
        }
        Ok(())
    }

    /// Reads the groups of entities. The elements of a partitioned mesh belong to entities of the partitions.
    fn entities(&mut self, is_partitioned: bool) -> Result<(), ReadError> {
        let number = "the number of an entity";
        if is_partitioned {
            self.count("the number of partitions")?;
            let ghosts = self.count("the number of ghost entities")?;
            self.source.skip(2 * ghosts.min(u64::MAX / 2), Scalar::I32, number)?;
        }
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = self.count("the number of entities")?;
        }
        for (dimension, count) in (0..).zip(counts) {
            for _ in 0..count {
                let tag = self.int(number)?;
                if is_partitioned {
                    // The dimension and the number of its parent.
                    self.source.skip(2, Scalar::I32, number)?;
                    let partitions = self.count("the number of partitions of an entity")?;
                    self.source.skip(partitions, Scalar::I32, "the number of a partition")?;
                }
                // A point, or two corners of a box.
                self.source.skip(if dimension == 0 { 3 } else { 6 }, Scalar::F64, "a coordinate")?;
                let mut physical = Vec::new();
                for _ in 0..self.count("the number of groups of an entity")? {
                    // A negative number stands for the other orientation.
                    physical.push(self.int("the number of a group")?.saturating_abs());
                }
                if dimension > 0 {
                    let bounds = self.count("the number of entities around an entity")?;
                    self.source.skip(bounds, Scalar::I32, number)?;
                }
                physical.sort_unstable();
                physical.dedup();
                self.physical.insert((dimension, tag), physical.into());
            }
        }
        Ok(())
    }

    fn nodes(&mut self) -> Result<(), ReadError> {
        let blocks = self.count("the number of blocks of nodes")?;
        let all = self.count("the number of nodes")?;
        self.builder.expect(all, 0)?;
        self.count("the least number of a node")?;
        self.count("the highest number of a node")?;
        let mut tags = Vec::new();
        for _ in 0..blocks {
            let dimension = self.int("the dimension of an entity")?;
            self.int("the number of an entity")?;
            let parameters = if self.int("0 or 1")? == 0 { 0 } else { dimension.clamp(0, 3) as u64 };
            let count = self.count("the number of nodes in a block")?;
            tags.clear();
            for _ in 0..count {
                tags.push(self.source.integer(self.size, "the number of a node")?);
            }
            for &tag in &tags {
                let point = self.source.point(Scalar::F64)?;
                let at = self.source.at - 1;
                self.source.skip(parameters, Scalar::F64, "a parameter")?;
                self.tags.node(tag, point, at, &self.source, &mut self.builder)?;
            }
        }
        Ok(())
    }

    fn elements(&mut self) -> Result<(), ReadError> {
        let blocks = self.count("the number of blocks of elements")?;
        self.count("the number of elements")?;
        self.count("the least number of an element")?;
        self.count("the highest number of an element")?;
        for _ in 0..blocks {
            let dimension = self.int("the dimension of an entity")?;
            let entity = self.int("the number of an entity")?;
            let start = self.source.at;
            let number = self.int("the type of an element")?;
            let kind = self.kind(number, start)?;
            let groups = self.physical.get(&(dimension, entity)).cloned().unwrap_or_default();
            for _ in 0..self.count("the number of elements in a block")? {
                self.source.integer(self.size, "the number of an element")?;
                self.element(kind, self.size, dimension, &groups)?;
            }
        }
        Ok(())
    }

    /// The kind of elements of a type.
    fn kind(&self, number: i64, start: usize) -> Result<Kind, ReadError> {
        Kind::of(number).ok_or_else(|| {
            let message = self.source.found(&number.to_string(), start, "a known type of elements").message;
            ReadError::new(message, "write elements of first order: `Mesh.ElementOrder = 1` in Gmsh")
        })
    }

    fn element(&mut self, kind: Kind, scalar: Scalar, dimension: i64, groups: &[i64]) -> Result<(), ReadError> {
        let mut corners = [0; 8];
        for at in 0..kind.nodes {
            let start = self.source.at;
            let tag = self.source.integer(scalar, "the number of a node")?;
            if let Some(corner) = corners[..kind.corners].get_mut(at) {
                *corner = self.tags.find(tag, "node", start, &self.source)?;
            }
        }
        let corners = &corners[..kind.corners];
        self.builder.is_curved |= kind.nodes > kind.corners;
        for &group in groups {
            self.builder.number((dimension, group), corners)?;
        }
        self.builder.around(kind.cell, corners)
    }
}
