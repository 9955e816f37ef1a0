//! VTK's formats in XML: unstructured grids (`.vtu`) and polygons (`.vtp`). Arrays are text, Base64 or raw bytes at the end of the file,
//! packed by zlib or not (<https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html>).

use super::cells::{Builder, Ghost};
use super::pvd::{attribute, unsound};
use super::source::{CUT, Coding, DAMAGED, Scalar, Source, quoted};
use super::{Cells, Format, Limits, ReadError, arrays, content, kinds};
use base64::Engine;
use base64::engine::general_purpose::STANDARD_NO_PAD;
use flate2::read::ZlibDecoder;
use glam::DVec3;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::borrow::Cow;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::io::Read;

/// An array of numbers where it stands in the file.
struct Array {
    /// Its name as typed.
    name: Vec<u8>,
    scalar: Scalar,
    /// The number of components of a point or a vector.
    columns: usize,
    /// Where it begins to be described.
    at: usize,
    place: Place,
}

enum Place {
    /// Text between two places of the file.
    Text(usize, usize),
    /// Base64 between two places of the file.
    Inline(usize, usize),
    /// The offset in the data at the end.
    Appended(usize),
}

/// Where arrays beside those of points and cells stand.
const POINT_DATA: &[u8] = b"PointData";
const CELL_DATA: &[u8] = b"CellData";

/// Elements whose arrays are all read, and the type of cells in them, if it is one.
const ELEMENTS: [(&[u8], i64); 6] =
    [(b"Points", 0), (b"Cells", -1), (b"Verts", 2), (b"Lines", 4), (b"Polys", 7), (b"Strips", 6)];

/// How the arrays of a file are written.
struct Layout<'b> {
    bytes: &'b [u8],
    coding: Coding,
    /// The type of lengths before arrays.
    header: Scalar,
    /// The name of the program by which arrays are packed; empty for none.
    packer: String,
    /// The data at the end, and whether they are raw.
    appended: Option<(&'b [u8], bool)>,
    /// The most numbers of all arrays that are no text and of the faces of polyhedra, and how many of them are left: several pieces
    /// may name the same data, and packed data may be small.
    most: usize,
    left: Cell<usize>,
}

/// The arrays of a piece by the names of their elements and their own.
type Piece = BTreeMap<Key, Array>;

/// The names of an element and of an array in it.
type Key = (Vec<u8>, Vec<u8>);

pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<Cells, ReadError> {
    // Raw data are no XML, so what stands before them is read alone.
    let begin = bytes.windows(13).position(|window| window == b"<AppendedData");
    let appended = match begin {
        Some(begin) => Some(appended(&bytes[begin..])?),
        None => None,
    };
    // Positions, velocities and displacements, and lists of the faces of polyhedra, where each corner belongs to several faces.
    let most = limits.points.saturating_mul(9).saturating_add(limits.corners.saturating_mul(12));
    let mut layout = Layout {
        bytes,
        coding: Coding::Little,
        header: Scalar::U32,
        packer: String::new(),
        appended,
        most,
        left: Cell::new(most),
    };
    let mut builder = Builder::new(limits);
    pieces(&bytes[..begin.unwrap_or(bytes.len())], begin.is_some(), &mut layout, &mut builder, limits)?;
    builder.finish(&Source::text(bytes), 0)
}

/// The data after the start tag, and whether they are raw.
fn appended(bytes: &[u8]) -> Result<(&[u8], bool), ReadError> {
    let position = |byte: u8| bytes.iter().position(|&found| found == byte);
    let (Some(tag), Some(begin)) = (position(b'>'), position(b'_')) else {
        return Err(ReadError::new("ends in its `<AppendedData>`; expected `_` and data", CUT));
    };
    let is_raw = match Reader::from_reader(&bytes[..=tag]).read_event() {
        Ok(Event::Start(tag)) => attribute(&tag, "encoding")?.as_deref() == Some("raw"),
        _ => false,
    };
    Ok((&bytes[(begin + 1).max(tag + 1)..], is_raw))
}

fn pieces(
    text: &[u8],
    is_cut: bool,
    layout: &mut Layout<'_>,
    builder: &mut Builder<'_>,
    limits: &Limits,
) -> Result<(), ReadError> {
    let place = |at: u64| Source::text(text).place(at as usize);
    let mut reader = Reader::from_reader(text);
    let mut path: Vec<Vec<u8>> = Vec::new();
    let mut piece = Piece::new();
    // The array whose text follows.
    let mut open: Option<(Key, Array)> = None;
    let close = |open: &mut Option<(Key, Array)>, piece: &mut Piece, before: u64| {
        if let Some((key, mut array)) = open.take() {
            if let Place::Text(_, end) | Place::Inline(_, end) = &mut array.place {
                *end = before as usize;
            }
            piece.insert(key, array);
        }
    };
    let (mut is_begun, mut is_ended) = (false, false);
    loop {
        let before = reader.buffer_position();
        let event = reader.read_event().map_err(|error| unsound(&place(reader.error_position()), &error))?;
        let is_empty = matches!(event, Event::Empty(_));
        match event {
            Event::Start(tag) | Event::Empty(tag) => {
                // An array may contain elements about it after its numbers.
                close(&mut open, &mut piece, before);
                let name = tag.local_name().as_ref().as_bytes().to_vec();
                match &*name {
                    b"VTKFile" => {
                        is_begun = true;
                        header(&tag, layout)?;
                    }
                    _ if !is_begun => return Err(content::no_beginning(text, Format::Vtu, "`<VTKFile`")),
                    b"DataArray" => {
                        let places = [before as usize, reader.buffer_position() as usize];
                        open =
                            array(&tag, path.last().map_or(&[][..], |parent| &parent[..]), places, || place(before))?;
                        if is_empty {
                            close(&mut open, &mut piece, places[1] as u64);
                        }
                    }
                    _ => {}
                }
                if !is_empty {
                    path.push(name);
                }
            }
            Event::End(tag) => {
                path.pop();
                match tag.local_name().as_ref().as_bytes() {
                    b"DataArray" => close(&mut open, &mut piece, before),
                    b"Piece" => layout.piece(&std::mem::take(&mut piece), builder, limits)?,
                    b"VTKFile" => is_ended = true,
                    _ => {}
                }
            }
            Event::Eof => break,
            _ => {}
        }
    }
    match (is_begun, is_ended || is_cut) {
        (false, _) => Err(content::no_beginning(text, Format::Vtu, "`<VTKFile`")),
        (true, false) => Err(Source::text(text).ends("`</VTKFile>`")),
        (true, true) => Ok(()),
    }
}

fn header(tag: &BytesStart<'_>, layout: &mut Layout<'_>) -> Result<(), ReadError> {
    let kind = attribute(tag, "type")?.unwrap_or_default();
    if !matches!(&*kind, "UnstructuredGrid" | "PolyData") {
        let found = quoted(kind.as_bytes());
        let message = format!("is a VTK file of the type {found}; expected `UnstructuredGrid` or `PolyData`");
        let help = "write it as an unstructured grid: ParaView's filter `Append Datasets` makes one";
        return Err(ReadError::new(message, help));
    }
    if attribute(tag, "byte_order")?.as_deref() == Some("BigEndian") {
        layout.coding = Coding::Big;
    }
    if attribute(tag, "header_type")?.as_deref() == Some("UInt64") {
        layout.header = Scalar::U64;
    }
    layout.packer = attribute(tag, "compressor")?.unwrap_or_default();
    Ok(())
}

/// An array in an element, if it is read. It begins to be described at the first of two places, and its text begins at the other.
fn array(
    tag: &BytesStart<'_>,
    parent: &[u8],
    places: [usize; 2],
    place: impl Fn() -> String,
) -> Result<Option<(Key, Array)>, ReadError> {
    let typed = attribute(tag, "Name")?.unwrap_or_default().into_bytes();
    let is_data = parent == POINT_DATA || parent == CELL_DATA;
    let name = if is_data {
        let columns = attribute(tag, "NumberOfComponents")?.and_then(|number| number.trim().parse().ok());
        match arrays::wanted(&typed, parent == CELL_DATA, columns.unwrap_or(1)) {
            Some(name) => name.to_vec(),
            None => return Ok(None),
        }
    } else if ELEMENTS.iter().any(|(element, _)| *element == parent) {
        typed.clone()
    } else {
        return Ok(None);
    };
    let is_vector = parent == b"Points" || is_data && arrays::is_vector(&name);
    let scalar = scalar(&attribute(tag, "type")?.unwrap_or_default())?;
    let columns = if is_vector { columns(tag, &typed, &place)? } else { 1 };
    let [at, start] = places;
    let place = match attribute(tag, "format")?.as_deref() {
        Some("appended") => {
            let offset = attribute(tag, "offset")?.and_then(|offset| offset.trim().parse().ok());
            let missing = || ReadError::damaged(format!("has an array without an offset {}", place()));
            Place::Appended(offset.ok_or_else(missing)?)
        }
        Some("binary") => Place::Inline(start, start),
        Some("ascii") | None => Place::Text(start, start),
        Some(other) => {
            let (other, place) = (quoted(other.as_bytes()), place());
            let message =
                format!("has an array of the format {other} {place}; expected `ascii`, `binary` or `appended`");
            return Err(ReadError::damaged(message));
        }
    };
    Ok(Some(((parent.to_vec(), name), Array { name: typed, scalar, columns, at, place })))
}

/// The number of components of points and vectors: 3, or 2 in the plane.
fn columns(tag: &BytesStart<'_>, name: &[u8], place: impl Fn() -> String) -> Result<usize, ReadError> {
    let found = attribute(tag, "NumberOfComponents")?;
    match found.as_deref().map(str::trim) {
        None | Some("3") => Ok(3),
        Some("2") => Ok(2),
        Some(other) => {
            let name = quoted(if name.is_empty() { b"Points" } else { name });
            let message =
                format!("has {other} components in its array {name} {}; expected 3, or 2 in the plane", place());
            Err(ReadError::new(message, "write points and vectors with x, y and z"))
        }
    }
}

fn scalar(name: &str) -> Result<Scalar, ReadError> {
    Scalar::named(name.as_bytes()).ok_or_else(|| {
        let message = format!("has an array of the type {}; expected `Float64` or `Int64`", quoted(name.as_bytes()));
        ReadError::new(message, DAMAGED)
    })
}

/// A point or a vector by its components, those in the plane with z = 0.
fn vector(array: &Array, mut next: impl FnMut() -> Result<f64, ReadError>) -> Result<DVec3, ReadError> {
    Ok(DVec3::new(next()?, next()?, if array.columns == 3 { next()? } else { 0.0 }))
}

impl Layout<'_> {
    fn piece(&self, piece: &Piece, builder: &mut Builder<'_>, limits: &Limits) -> Result<(), ReadError> {
        let first = builder.points() as i64;
        if let Some(((_, name), array)) = piece.iter().find(|((parent, _), _)| parent == b"Points") {
            let name = if name.is_empty() { b"Points" } else { &**name };
            self.each(array, name, 3 * limits.points, |source| {
                let at = if source.coding == Coding::Text { source.at } else { array.at };
                builder.point_at(vector(array, || source.coordinate(array.scalar))?, at).map(drop)
            })?;
        }
        let count = builder.points() - first as usize;
        let get = |parent: &[u8], name: &[u8]| piece.get(&(parent.to_vec(), name.to_vec()));
        let place = |array: &Array| Source::text(self.bytes).place(array.at);
        let vectors = |name: &[u8], expected: &str| -> Result<Option<Vec<DVec3>>, ReadError> {
            let Some(array) = get(POINT_DATA, name) else { return Ok(None) };
            let mut vectors = Vec::new();
            self.each(array, &array.name, 3 * limits.points, |source| {
                vectors.push(vector(array, || source.float(array.scalar, expected))?);
                Ok(())
            })?;
            arrays::check(&array.name, vectors.len(), count, false, || place(array))?;
            Ok(Some(vectors))
        };
        vectors(arrays::VELOCITY, "a velocity")?.into_iter().for_each(|all| builder.velocities(all));
        let displacement = arrays::displacement(|name| get(POINT_DATA, name).is_some());
        vectors(displacement, "a displacement")?.into_iter().for_each(|all| builder.displacements(all));
        let integers = |parent: &[u8], name: &[u8]| match get(parent, name) {
            Some(array) => self.integers(array, name, 4 * limits.corners),
            None => Ok(Vec::new()),
        };
        // What tells ghosts, one for each point, and one for each of these cells of the file.
        let ghosts = |of_cells: bool, expected: usize| -> Result<Vec<Ghost>, ReadError> {
            let parent = if of_cells { CELL_DATA } else { POINT_DATA };
            let found = arrays::GHOSTS.into_iter().find_map(|name| Some((name, get(parent, name)?)));
            let Some((name, array)) = found else { return Ok(Vec::new()) };
            let numbers = integers(parent, name)?;
            arrays::check(&array.name, numbers.len(), expected, of_cells, || place(array))?;
            Ok(numbers.iter().map(|&number| arrays::ghost(name, number, of_cells)).collect())
        };
        builder.ghosts(first as usize, ghosts(false, count)?);
        let polyhedra = Polyhedra {
            streams: integers(b"Cells", b"faces")?,
            ends: integers(b"Cells", b"faceoffsets")?,
            points: integers(b"Cells", b"face_connectivity")?,
            faces: integers(b"Cells", b"face_offsets")?,
            members: integers(b"Cells", b"polyhedron_to_faces")?,
            cells: integers(b"Cells", b"polyhedron_offsets")?,
        };
        let corners = |list: &[i64]| -> Result<Vec<u32>, ReadError> {
            list.iter().map(|&index| corner(index, first, count as i64)).collect()
        };
        // Where the cells begin that each cell of the file becomes.
        let mut starts = Vec::new();
        for &(parent, kind) in &ELEMENTS[1..] {
            let [connectivity, offsets, types] =
                [&b"connectivity"[..], b"offsets", b"types"].map(|name| integers(parent, name));
            let (connectivity, offsets, types) = (connectivity?, offsets?, types?);
            if kind < 0 && types.len() != offsets.len() {
                let message = format!("has {} offsets of cells, but {} types", offsets.len(), types.len());
                return Err(ReadError::new(message, DAMAGED));
            }
            let mut start = 0;
            for (cell, &offset) in offsets.iter().enumerate() {
                let end = usize::try_from(offset).ok().filter(|&end| start <= end && end <= connectivity.len());
                let Some(end) = end else {
                    let message = format!(
                        "has the offset {offset} of cell {cell}; expected {start} to {}, the length of `connectivity`",
                        connectivity.len()
                    );
                    return Err(ReadError::new(message, DAMAGED));
                };
                let kind = if kind < 0 { types[cell] } else { kind };
                let list = &connectivity[start..end];
                start = end;
                starts.push(builder.cells.kinds.len());
                if kind == 42 {
                    let faces = polyhedra.faces_of(cell)?;
                    self.spend(faces.iter().map(|face| 1 + face.len()).sum())?;
                    let faces = faces.into_iter().map(corners).collect::<Result<Vec<_>, _>>()?;
                    kinds::polyhedron(&faces, &corners(list)?, builder)?;
                } else {
                    kinds::add(kind, &corners(list)?, builder)?;
                }
            }
        }
        let ghosts = ghosts(true, starts.len())?;
        builder.ghosts_of_cells(&starts, &ghosts);
        Ok(())
    }

    fn spend(&self, count: usize) -> Result<(), ReadError> {
        match self.left.get().checked_sub(count) {
            Some(left) => {
                self.left.set(left);
                Ok(())
            }
            None => Err(self.too_long()),
        }
    }

    fn too_long(&self) -> ReadError {
        let message = format!("has more than {} numbers in its arrays and faces", self.most);
        ReadError::new(message, COARSER)
    }

    fn integers(&self, array: &Array, name: &[u8], most: usize) -> Result<Vec<i64>, ReadError> {
        let mut numbers = Vec::new();
        self.each(array, name, most, |source| {
            if numbers.len() >= most {
                return Err(too_long(name, most));
            }
            numbers.push(source.integer(array.scalar, "an integer")?);
            Ok(())
        })?;
        Ok(numbers)
    }

    /// Reads an array of at most so many numbers until its end.
    fn each(
        &self,
        array: &Array,
        name: &[u8],
        most: usize,
        mut read: impl FnMut(&mut Source<'_>) -> Result<(), ReadError>,
    ) -> Result<(), ReadError> {
        let bytes;
        let mut source = match array.place {
            Place::Text(start, end) => Source::part(self.bytes, start, end),
            _ => {
                bytes = self.unpacked(array, name, most)?;
                let mut source = Source::part(&bytes, 0, bytes.len());
                source.coding = self.coding;
                source
            }
        };
        while !source.is_done() {
            read(&mut source).map_err(|error| {
                let message = format!("{}, in its array {}", error.message, quoted(name));
                ReadError { message, help: error.help }
            })?;
        }
        Ok(())
    }

    /// The bytes of an array that is no text.
    fn unpacked(&self, array: &Array, name: &[u8], most: usize) -> Result<Cow<'_, [u8]>, ReadError> {
        let size = array.scalar.size();
        let too_long = || if most < self.left.get() { too_long(name, most) } else { self.too_long() };
        let most = most.min(self.left.get()).saturating_mul(size);
        let cut = || ReadError::new(format!("ends in its array {}", quoted(name)), CUT);
        let (encoded, is_raw) = match array.place {
            Place::Text(start, end) | Place::Inline(start, end) => (&self.bytes[start..end], false),
            Place::Appended(offset) => {
                let (data, is_raw) = self.appended.ok_or_else(|| {
                    let message = format!("has no `<AppendedData>`, where its array {} should be", quoted(name));
                    ReadError::new(message, DAMAGED)
                })?;
                (data.get(offset..).ok_or_else(cut)?, is_raw)
            }
        };
        if encoded.trim_ascii().is_empty() && !is_raw {
            return Ok(Cow::Borrowed(&[]));
        }
        let get = |length: usize| -> Result<Cow<'_, [u8]>, ReadError> {
            let bytes = if is_raw { Cow::Borrowed(encoded) } else { Cow::Owned(from_base64(encoded, length)) };
            if bytes.len() < length { Err(cut()) } else { Ok(bytes) }
        };
        let word = self.header.size();
        let number = |bytes: &[u8], at: usize| {
            let word = &bytes[at * word..(at + 1) * word];
            let mut value = [0; 8];
            value[..word.len()].copy_from_slice(word);
            if self.coding == Coding::Big {
                value[..word.len()].reverse();
            }
            usize::try_from(u64::from_le_bytes(value)).unwrap_or(usize::MAX)
        };
        let first = number(&get(word)?, 0);
        if self.packer.is_empty() {
            if first > most {
                return Err(too_long());
            }
            let bytes = get(word + first)?;
            self.spend(first / size)?;
            return Ok(match bytes {
                Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[word..word + first]),
                Cow::Owned(mut bytes) => {
                    bytes.truncate(word + first);
                    bytes.drain(..word);
                    Cow::Owned(bytes)
                }
            });
        }
        if self.packer != "vtkZLibDataCompressor" {
            let message = format!("is packed by {}; expected `vtkZLibDataCompressor`", quoted(self.packer.as_bytes()));
            return Err(ReadError::new(message, "write it packed by zlib, or not packed"));
        }
        // The number of blocks, the length of each, that of the last, and the packed length of each.
        let words =
            first.checked_add(3).and_then(|words| words.checked_mul(word)).filter(|&length| length <= self.bytes.len());
        let words = words.ok_or_else(cut)?;
        let header = get(words)?;
        let lengths = (0..first).map(|block| number(&header, 3 + block));
        let total = lengths.clone().try_fold(words, usize::checked_add);
        let total = total.filter(|&total| total <= self.bytes.len()).ok_or_else(cut)?;
        let packed = get(total)?;
        let mut bytes = Vec::new();
        let mut start = words;
        for length in lengths {
            let block = ZlibDecoder::new(&packed[start..start + length]);
            let left = most - bytes.len();
            let is_read = block.take(left as u64 + 1).read_to_end(&mut bytes).is_ok();
            if bytes.len() > most {
                return Err(too_long());
            }
            if !is_read {
                return Err(ReadError::new(format!("has damaged packed data in its array {}", quoted(name)), DAMAGED));
            }
            start += length;
        }
        self.spend(bytes.len().max(total) / size)?;
        Ok(Cow::Owned(bytes))
    }
}

/// The remedy for large files.
const COARSER: &str = "make the mesh coarser, with a decimation of the program that wrote it";

fn too_long(name: &[u8], most: usize) -> ReadError {
    let message = format!("has more than {most} numbers in its array {}", quoted(name));
    ReadError::new(message, COARSER)
}

/// A corner of a piece with so many points, which begin at `first`.
fn corner(index: i64, first: i64, count: i64) -> Result<u32, ReadError> {
    if (0..count).contains(&index) {
        return Ok((index + first) as u32);
    }
    Err(ReadError::damaged(match count {
        0 => format!("names point {index}, but has no points"),
        _ => format!("names point {index}, but has points 0 to {}", count - 1),
    }))
}

/// The first bytes of Base64, at least so many if they are there. Padding ends a part, after which another one begins.
fn from_base64(text: &[u8], length: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut part = Vec::new();
    let end = |part: &mut Vec<u8>, bytes: &mut Vec<u8>| {
        let is_sound = STANDARD_NO_PAD.decode_vec(&*part, bytes).is_ok();
        part.clear();
        is_sound
    };
    for &byte in text {
        match byte {
            b'=' => {
                if !part.is_empty() && !end(&mut part, &mut bytes) {
                    return bytes;
                }
            }
            b' ' | b'\t' | b'\r' | b'\n' => {}
            // The end of the element.
            b'<' => break,
            _ => part.push(byte),
        }
        if part.len() == 1 << 12 && !end(&mut part, &mut bytes) || bytes.len() >= length {
            return bytes;
        }
    }
    end(&mut part, &mut bytes);
    bytes
}

/// The faces of polyhedra, in the old layout or in that of VTK 9.4.
struct Polyhedra {
    /// The number of faces of each polyhedron, and for each face the number of its points and the points.
    streams: Vec<i64>,
    /// Where the stream of each cell ends, or −1.
    ends: Vec<i64>,
    /// The points of all faces, and where those of each end.
    points: Vec<i64>,
    faces: Vec<i64>,
    /// The faces of all polyhedra, and where those of each cell end.
    members: Vec<i64>,
    cells: Vec<i64>,
}

impl Polyhedra {
    fn faces_of(&self, cell: usize) -> Result<Vec<&[i64]>, ReadError> {
        self.find(cell).ok_or_else(|| {
            let message = format!("has no sound faces of the polyhedron that is cell {cell}");
            ReadError::new(message, DAMAGED)
        })
    }

    fn find(&self, cell: usize) -> Option<Vec<&[i64]>> {
        if self.cells.is_empty() {
            let end = usize::try_from(*self.ends.get(cell)?).ok()?;
            let before = self.ends[..cell]
                .iter()
                .rev()
                .find(|&&end| end >= 0)
                .map_or(Some(0), |&end| usize::try_from(end).ok())?;
            return kinds::faces(self.streams.get(before..end)?);
        }
        let part = |ends: &[i64], at: usize| -> Option<std::ops::Range<usize>> {
            let end = usize::try_from(*ends.get(at)?).ok()?;
            let start = if at == 0 { 0 } else { usize::try_from(ends[at - 1]).ok()? };
            Some(start..end)
        };
        let members = self.members.get(part(&self.cells, cell)?)?;
        members.iter().map(|&face| self.points.get(part(&self.faces, usize::try_from(face).ok()?)?)).collect()
    }
}
