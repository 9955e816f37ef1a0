//! Gmsh's format in its versions 2.2 and 4.1 (<https://gmsh.info/doc/texinfo/gmsh.html>, “Gmsh file formats”).
//!
//! Named or numbered physical groups become groups of points. Of elements of higher order the corners are read, which Gmsh lists first.

use super::cells::{Builder, CellKind, along};
use super::source::{Coding, DAMAGED, Scalar, Source, quoted};
use super::{Cells, Format, Limits, ReadError, content};
use glam::DVec3;
use std::collections::{BTreeMap, HashMap};
use std::rc::Rc;

/// A dimension and the number of an entity or of a group.
type Key = (i64, i64);

struct Reader<'b, 'l> {
    source: Source<'b>,
    builder: Builder<'l>,
    /// How the numbers of the sections are written.
    coding: Coding,
    /// The type of counts in the version 4.1.
    size: Scalar,
    /// The names of physical groups.
    names: HashMap<Key, String>,
    /// The physical groups of each entity.
    physical: HashMap<Key, Rc<[i64]>>,
    tags: Tags,
    /// The points of each physical group.
    groups: BTreeMap<Key, Vec<u32>>,
    /// The points in all groups.
    grouped: usize,
    limits: &'l Limits,
}

pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Cells, ReadError> {
    let mut source = Source::text(bytes);
    if source.word() != b"$MeshFormat" {
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
    let mut reader = Reader {
        source,
        builder: Builder::new(limits),
        coding,
        size,
        names: HashMap::new(),
        physical: HashMap::new(),
        tags: Tags::default(),
        groups: BTreeMap::new(),
        grouped: 0,
        limits,
    };
    reader.end(b"MeshFormat")?;
    while !reader.source.is_done() {
        let word = reader.source.word();
        let Some(section) = word.strip_prefix(b"$") else {
            return Err(reader.source.wrong(word, "a section that begins with `$`"));
        };
        reader.source.line();
        match (section, is_old) {
            (b"PhysicalNames", _) => reader.physical_names()?,
            (b"Entities", false) => reader.with_coding(Reader::entities)?,
            (b"Nodes", true) => reader.old_nodes()?,
            (b"Nodes", false) => reader.with_coding(Reader::nodes)?,
            (b"Elements", true) => reader.old_elements()?,
            (b"Elements", false) => reader.with_coding(Reader::elements)?,
            // Periodic entities, data and others.
            _ => reader.skip(section)?,
        }
        reader.end(section)?;
    }
    let Reader { source, mut builder, names, groups, .. } = reader;
    for ((dimension, tag), points) in groups {
        let name = names.get(&(dimension, tag)).cloned().unwrap_or_else(|| {
            let kind = ["point", "curve", "surface", "volume"].get(dimension as usize).copied().unwrap_or("group");
            format!("{kind} {tag}")
        });
        builder.group(name, points);
    }
    builder.finish(&source, 0)
}

impl Reader<'_, '_> {
    /// Reads a section whose numbers are text or binary.
    fn with_coding(&mut self, read: fn(&mut Self) -> Result<(), ReadError>) -> Result<(), ReadError> {
        self.source.coding = self.coding;
        read(self)?;
        self.source.coding = Coding::Text;
        Ok(())
    }

    /// Goes to the end of a section.
    fn skip(&mut self, section: &[u8]) -> Result<(), ReadError> {
        let end = [b"$End", section].concat();
        let rest = self.source.rest();
        match rest.windows(end.len()).position(|window| window == end) {
            Some(length) => {
                self.source.at += length;
                Ok(())
            }
            None => Err(self.source.ends(&quoted(&end))),
        }
    }

    /// Reads the end of a section.
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

    fn coordinates(&mut self) -> Result<DVec3, ReadError> {
        let mut next = || self.source.float(Scalar::F64, "a coordinate");
        Ok(DVec3::new(next()?, next()?, next()?))
    }

    fn physical_names(&mut self) -> Result<(), ReadError> {
        for _ in 0..self.source.count(Scalar::I32, "the number of names")? {
            let dimension = self.source.integer(Scalar::I32, "the dimension of a group")?;
            let tag = self.source.integer(Scalar::I32, "the number of a group")?;
            let line = self.source.line().trim_ascii();
            let name = line.strip_prefix(b"\"").and_then(|name| name.strip_suffix(b"\"")).unwrap_or(line);
            self.names.insert((dimension, tag), String::from_utf8_lossy(name).into_owned());
        }
        Ok(())
    }

    fn entities(&mut self) -> Result<(), ReadError> {
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = self.count("the number of entities")?;
        }
        for (dimension, count) in (0..).zip(counts) {
            for _ in 0..count {
                let tag = self.int("the number of an entity")?;
                // A point, or two corners of a box.
                self.source.skip(if dimension == 0 { 3 } else { 6 }, Scalar::F64, "a coordinate")?;
                let mut physical = Vec::new();
                for _ in 0..self.count("the number of groups of an entity")? {
                    // A negative number stands for the other orientation.
                    physical.push(self.int("the number of a group")?.saturating_abs());
                }
                if dimension > 0 {
                    let bounds = self.count("the number of entities around an entity")?;
                    self.source.skip(bounds, Scalar::I32, "the number of an entity")?;
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
                let point = self.coordinates()?;
                self.source.skip(parameters, Scalar::F64, "a parameter")?;
                self.tags.push(tag, self.builder.point(point)?);
            }
        }
        Ok(())
    }

    fn old_nodes(&mut self) -> Result<(), ReadError> {
        let count = self.source.count(Scalar::I32, "the number of nodes")?;
        self.builder.expect(count, 0)?;
        self.source.line();
        self.source.coding = self.coding;
        for _ in 0..count {
            let tag = self.int("the number of a node")?;
            let point = self.coordinates()?;
            self.tags.push(tag, self.builder.point(point)?);
        }
        self.source.coding = Coding::Text;
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

    fn old_elements(&mut self) -> Result<(), ReadError> {
        let count = self.source.count(Scalar::I32, "the number of elements")?;
        self.source.line();
        self.source.coding = self.coding;
        let mut done = 0;
        while done < count {
            // In binary files, elements of one type with one number of tags stand together.
            let is_text = self.coding == Coding::Text;
            if is_text {
                self.int("the number of an element")?;
            }
            let start = self.source.at;
            let number = self.int("the type of an element")?;
            let kind = self.kind(number, start)?;
            let together = if is_text { 1 } else { self.source.count(Scalar::I32, "a number of elements")?.max(1) };
            let tags = self.source.count(Scalar::I32, "the number of tags")?;
            for _ in 0..together {
                if !is_text {
                    self.int("the number of an element")?;
                }
                // The first tag is the physical group.
                let mut physical = 0;
                for at in 0..tags {
                    let tag = self.int("a tag")?;
                    physical = if at == 0 { tag.saturating_abs() } else { physical };
                }
                let groups = if physical == 0 { &[][..] } else { &[physical] };
                self.element(kind, Scalar::I32, kind.dimension, groups)?;
            }
            done += together;
        }
        self.source.coding = Coding::Text;
        Ok(())
    }

    /// The kind of elements of a type.
    fn kind(&self, number: i64, start: usize) -> Result<Kind, ReadError> {
        Kind::of(number).ok_or_else(|| {
            let message = self.source.found(&number.to_string(), start, "a known type of elements").message;
            ReadError::new(message, "write elements of first order: `Mesh.ElementOrder = 1` in Gmsh")
        })
    }

    /// Reads the nodes of an element.
    fn element(&mut self, kind: Kind, scalar: Scalar, dimension: i64, groups: &[i64]) -> Result<(), ReadError> {
        let mut corners = [0; 8];
        for at in 0..kind.nodes {
            let start = self.source.at;
            let tag = self.source.integer(scalar, "the number of a node")?;
            if let Some(corner) = corners[..kind.corners].get_mut(at) {
                *corner = self.tags.get(tag).ok_or_else(|| {
                    let message = format!("names node {tag} {}, which it does not have", self.source.place(start));
                    ReadError::new(message, DAMAGED)
                })?;
            }
        }
        let corners = &corners[..kind.corners];
        for &group in groups {
            self.grouped += corners.len();
            if self.grouped > 4 * self.limits.corners {
                let most = self.limits.corners;
                let message = format!("has groups with more than {} nodes", 4 * most);
                return Err(ReadError::new(message, "put each element into one physical group or few"));
            }
            self.groups.entry((dimension, group)).or_default().extend(corners);
        }
        match *corners {
            [a, b, c, d, e, f, g, h] => self.builder.cell(kind.cell, &along(&[a, b, c, d, e, f, g, h])),
            _ => self.builder.cell(kind.cell, corners),
        }
    }
}

/// A type of elements.
#[derive(Clone, Copy)]
struct Kind {
    cell: CellKind,
    dimension: i64,
    /// The number of its corners, which are the first of its nodes.
    corners: usize,
    nodes: usize,
}

impl Kind {
    fn of(number: i64) -> Option<Self> {
        use CellKind::{Hexahedron, Line, Point, Polygon, Pyramid, Tetrahedron, Wedge};
        let (cell, dimension, corners, nodes) = match number {
            15 => (Point, 0, 1, 1),
            1 => (Line, 1, 2, 2),
            8 => (Line, 1, 2, 3),
            26..=28 => (Line, 1, 2, number as usize - 22),
            2 => (Polygon, 2, 3, 3),
            9 => (Polygon, 2, 3, 6),
            20 => (Polygon, 2, 3, 9),
            21 => (Polygon, 2, 3, 10),
            22 => (Polygon, 2, 3, 12),
            23 | 24 => (Polygon, 2, 3, 15),
            25 => (Polygon, 2, 3, 21),
            3 => (Polygon, 2, 4, 4),
            16 => (Polygon, 2, 4, 8),
            10 => (Polygon, 2, 4, 9),
            36 => (Polygon, 2, 4, 16),
            37 => (Polygon, 2, 4, 25),
            38 => (Polygon, 2, 4, 36),
            4 => (Tetrahedron, 3, 4, 4),
            11 => (Tetrahedron, 3, 4, 10),
            29 => (Tetrahedron, 3, 4, 20),
            30 => (Tetrahedron, 3, 4, 35),
            31 => (Tetrahedron, 3, 4, 56),
            5 => (Hexahedron, 3, 8, 8),
            17 => (Hexahedron, 3, 8, 20),
            12 => (Hexahedron, 3, 8, 27),
            92 => (Hexahedron, 3, 8, 64),
            93 => (Hexahedron, 3, 8, 125),
            6 => (Wedge, 3, 6, 6),
            18 => (Wedge, 3, 6, 15),
            13 => (Wedge, 3, 6, 18),
            90 => (Wedge, 3, 6, 40),
            91 => (Wedge, 3, 6, 75),
            7 => (Pyramid, 3, 5, 5),
            19 => (Pyramid, 3, 5, 13),
            14 => (Pyramid, 3, 5, 14),
            118 => (Pyramid, 3, 5, 30),
            _ => return None,
        };
        Some(Self { cell, dimension, corners, nodes })
    }
}

/// The point of each number of a node. Most files count nodes one after the other.
#[derive(Default)]
struct Tags {
    first: i64,
    count: u32,
    /// The points of numbers, once they are not consecutive.
    other: Option<HashMap<i64, u32>>,
}

impl Tags {
    fn push(&mut self, tag: i64, point: u32) {
        if self.count == 0 {
            self.first = tag;
        }
        let (first, count) = (self.first, self.count);
        if self.other.is_none() && first.checked_add(count.into()) != Some(tag) {
            self.other = Some((0..count).map(|at| (first + i64::from(at), at)).collect());
        }
        if let Some(other) = &mut self.other {
            other.insert(tag, point);
        }
        self.count += 1;
    }

    fn get(&self, tag: i64) -> Option<u32> {
        match &self.other {
            Some(other) => other.get(&tag).copied(),
            None => u32::try_from(tag.checked_sub(self.first)?).ok().filter(|&point| point < self.count),
        }
    }
}
