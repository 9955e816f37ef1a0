//! Stanford triangles: a header that lists elements and their properties, and then their values as text or binary numbers
//! (<http://paulbourke.net/dataformats/ply/>).

use super::builder::Builder;
use super::source::{Coding, DAMAGED, Scalar, Source, quoted};
use super::{Cells, Format, Limits, ReadError, content};
use glam::DVec3;

/// An element of the header.
struct Element<'b> {
    name: &'b [u8],
    count: u64,
    properties: Vec<Property<'b>>,
}

/// A number, or a list with the type of its length.
struct Property<'b> {
    name: &'b [u8],
    length: Option<Scalar>,
    scalar: Scalar,
}

pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Cells, ReadError> {
    let mut source = Source::text(bytes);
    let (coding, elements) = header(bytes, &mut source)?;
    let mut builder = Builder::new(limits);
    let count = |name: &[u8]| elements.iter().find(|element| element.name == name).map_or(0, |element| element.count);
    builder.expect(count(b"vertex"), count(b"face"))?;
    source.coding = coding;
    for element in &elements {
        match element.name {
            b"vertex" => points(element, &mut source, &mut builder)?,
            b"face" => faces(element, &mut source, &mut builder, false)?,
            b"tristrips" => faces(element, &mut source, &mut builder, true)?,
            // An element without properties takes no bytes, whatever its number.
            _ if element.properties.is_empty() => {}
            _ => {
                for _ in 0..element.count {
                    element.properties.iter().try_for_each(|property| skip(property, &mut source))?;
                }
            }
        }
    }
    builder.tell_rest(&mut source);
    builder.finish(&source, 0)
}

fn header<'b>(bytes: &'b [u8], source: &mut Source<'b>) -> Result<(Coding, Vec<Element<'b>>), ReadError> {
    if source.line().trim_ascii() != b"ply" {
        return Err(content::no_beginning(bytes, Format::Ply, "`ply`"));
    }
    let has_feeds = bytes[..source.at].ends_with(b"\n");
    let mut coding = None;
    let mut elements: Vec<Element<'_>> = Vec::new();
    loop {
        let start = source.at;
        if source.is_done() {
            return Err(source.ends("`end_header`"));
        }
        source.at = start;
        let text = source.line();
        let mut line = Source::text(text);
        let wrong = |word: &[u8], expected: &str| source.found(&quoted(word), start, expected);
        match line.word() {
            b"format" => {
                coding = Some(match line.word() {
                    b"ascii" => Coding::Text,
                    b"binary_little_endian" => Coding::Little,
                    b"binary_big_endian" => Coding::Big,
                    word => return Err(wrong(word, "`ascii`, `binary_little_endian` or `binary_big_endian`")),
                });
            }
            b"element" => {
                let (name, count) = (line.word(), line.word());
                let count = std::str::from_utf8(count).ok().and_then(|word| word.parse().ok());
                let count = count.ok_or_else(|| wrong(text, "the number of an element"))?;
                elements.push(Element { name, count, properties: Vec::new() });
            }
            b"property" => {
                let element = elements.last_mut().ok_or_else(|| wrong(text, "`element` before it"))?;
                let scalar =
                    |word: &[u8]| Scalar::named(word).ok_or_else(|| wrong(word, "a type, such as `float` or `int`"));
                let (length, kind) = match line.word() {
                    b"list" => (Some(scalar(line.word())?), line.word()),
                    word => (None, word),
                };
                element.properties.push(Property { length, scalar: scalar(kind)?, name: line.word() });
            }
            b"end_header" => {
                let coding = coding.ok_or_else(|| wrong(text, "`format` before it"))?;
                // Where lines end with a carriage return alone, a line feed behind it is the first byte of the data.
                if !has_feeds {
                    source.at = (start + text.len() + 1).min(bytes.len());
                }
                return Ok((coding, elements));
            }
            // Comments. Blender 2.4 writes one without its keyword.
            _ => {}
        }
    }
}

fn skip(property: &Property<'_>, source: &mut Source<'_>) -> Result<(), ReadError> {
    let count = match property.length {
        Some(length) => source.count(length, "the length of a list")?,
        None => 1,
    };
    source.skip(count, property.scalar, "a number")
}

fn points(element: &Element<'_>, source: &mut Source<'_>, builder: &mut Builder) -> Result<(), ReadError> {
    let axis = |name: &[u8]| element.properties.iter().position(|found| found.name == name && found.length.is_none());
    let (Some(x), Some(y), Some(z)) = (axis(b"x"), axis(b"y"), axis(b"z")) else {
        return Err(ReadError::new("has no properties `x`, `y` and `z` of `vertex` in its header", DAMAGED));
    };
    for _ in 0..element.count {
        let mut point = DVec3::ZERO;
        for (at, property) in element.properties.iter().enumerate() {
            match at {
                _ if at == x => point.x = source.coordinate(property.scalar)?,
                _ if at == y => point.y = source.coordinate(property.scalar)?,
                _ if at == z => point.z = source.coordinate(property.scalar)?,
                _ => skip(property, source)?,
            }
        }
        builder.point_at(point, source.at - 1)?;
    }
    Ok(())
}

/// Reads polygons, or strips of triangles in which −1 begins a new strip.
fn faces(
    element: &Element<'_>,
    source: &mut Source<'_>,
    builder: &mut Builder,
    are_strips: bool,
) -> Result<(), ReadError> {
    let is_list = |property: &&Property<'_>| property.length.is_some();
    let known = |property: &&Property<'_>| [&b"vertex_indices"[..], b"vertex_index"].contains(&property.name);
    let lists = || element.properties.iter().filter(is_list);
    let Some(indices) = lists().find(known).or_else(|| lists().next()) else {
        if element.count == 0 {
            return Ok(());
        }
        return Err(ReadError::new("has no list `vertex_indices` of `face` in its header", DAMAGED));
    };
    let mut corners = Vec::new();
    for _ in 0..element.count {
        for property in &element.properties {
            let Some(length) = property.length.filter(|_| std::ptr::eq(property, indices)) else {
                skip(property, source)?;
                continue;
            };
            corners.clear();
            for _ in 0..source.count(length, "the number of corners of a face")? {
                let start = source.at;
                let index = source.integer(property.scalar, "the index of a point")?;
                if are_strips && index == -1 {
                    builder.strip(&corners)?;
                    corners.clear();
                } else {
                    corners.push(builder.corner(index, start, source)?);
                }
            }
            if are_strips { builder.strip(&corners)? } else { builder.face(&corners)? }
        }
    }
    Ok(())
}
