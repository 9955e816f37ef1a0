//! The buffers of a glTF file, and the lists of numbers in them.

use super::super::builder::too_many;
use super::super::source::{CUT, Coding, Scalar, Source, quoted};
use super::super::{Beside, Limits, ReadError};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec3;
use gltf::accessor::DataType;
use gltf::buffer::{Source as Data, View};
use gltf::{Accessor, Document};
use std::borrow::Cow;

pub(super) struct Lists<'b> {
    buffers: Vec<Cow<'b, [u8]>>,
    pub(super) limits: &'b Limits,
    /// How many numbers may still be read. Parts may share lists, and morph targets, too.
    left: usize,
}

impl<'b> Lists<'b> {
    /// The lists of a document, with the binary data of its file.
    pub(super) fn new(
        document: &Document,
        mut blob: Option<Cow<'b, [u8]>>,
        beside: &mut Beside<'_>,
        limits: &'b Limits,
    ) -> Result<Self, ReadError> {
        /// Numbers of a point or corner that are read: coordinates, and those of joints and several morph targets.
        const NUMBERS: usize = 64;
        let buffers =
            document.buffers().map(|buffer| data(&buffer, blob.take(), beside)).collect::<Result<Vec<_>, _>>()?;
        Ok(Self { buffers, limits, left: (limits.points.saturating_add(limits.corners)).saturating_mul(NUMBERS) })
    }

    pub(super) fn vectors(&mut self, accessor: &Accessor<'_>) -> Result<Vec<DVec3>, ReadError> {
        let numbers = self.numbers(accessor, 3, self.limits.points)?;
        Ok(numbers.chunks_exact(3).map(DVec3::from_slice).collect())
    }

    /// The numbers of a list with so many in each row.
    pub(super) fn numbers(
        &mut self,
        accessor: &Accessor<'_>,
        columns: usize,
        most: usize,
    ) -> Result<Vec<f64>, ReadError> {
        let (index, count) = (accessor.index(), accessor.count());
        let left = self.left.checked_sub(count.saturating_mul(columns)).filter(|_| count <= most);
        self.left = left.ok_or_else(|| {
            too_many(&count.to_string(), &format!("entries in its list {index}"), most.min(self.left / columns))
        })?;
        if accessor.dimensions().multiplicity() != columns {
            let found = accessor.dimensions().multiplicity();
            let message = format!("has {found} numbers in each entry of its list {index}; expected {columns}");
            return Err(ReadError::damaged(message));
        }
        // Integers may stand for the numbers from −1 or 0 to 1.
        let (scalar, largest) = match accessor.data_type() {
            DataType::I8 => (Scalar::I8, 127.0),
            DataType::U8 => (Scalar::U8, 255.0),
            DataType::I16 => (Scalar::I16, 32767.0),
            DataType::U16 => (Scalar::U16, 65535.0),
            DataType::U32 => (Scalar::U32, 1.0),
            DataType::F32 => (Scalar::F32, 1.0),
        };
        let mut all = match accessor.view() {
            Some(view) => self.rows(&view, accessor.offset(), count, columns, scalar)?,
            None => {
                // Zeros stand beside a list with data, which is as long.
                let bytes: usize = self.buffers.iter().map(|buffer| buffer.len()).sum();
                if count > bytes {
                    let message = format!(
                        "has {count} entries in its list {index}, which has no data of its own; expected at most {bytes}, the bytes of its buffers"
                    );
                    return Err(ReadError::damaged(message));
                }
                vec![0.0; count * columns]
            }
        };
        if let Some(sparse) = accessor.sparse() {
            let (indices, values) = (sparse.indices(), sparse.values());
            let of_index = [Scalar::U8, Scalar::U16, Scalar::U32][indices.index_type().size() / 2];
            let count = sparse.count().min(most);
            let places = self.rows(&indices.view(), indices.offset(), count, 1, of_index)?;
            let values = self.rows(&values.view(), values.offset(), count, columns, scalar)?;
            for (place, value) in places.into_iter().zip(values.chunks_exact(columns)) {
                let start = place as usize * columns;
                let row = all.get_mut(start..start + columns).ok_or_else(|| {
                    ReadError::damaged(format!("changes entry {place} of its list {index}, which has fewer"))
                })?;
                row.copy_from_slice(value);
            }
        }
        if accessor.normalized() && largest > 1.0 {
            // The lowest integer is −1 as well as that above it.
            all.iter_mut().for_each(|value| *value = (*value / largest).max(-1.0));
        }
        Ok(all)
    }

    fn rows(
        &self,
        view: &View<'_>,
        offset: usize,
        count: usize,
        columns: usize,
        scalar: Scalar,
    ) -> Result<Vec<f64>, ReadError> {
        let (buffer, start, size) = (view.buffer().index(), view.offset(), scalar.size() * columns);
        let part = || self.buffers.get(buffer)?.get(start..start.checked_add(view.length())?)?.get(offset..);
        let beyond = || ReadError::new(format!("has data beyond the end of its buffer {buffer}"), CUT);
        let (part, stride) = (part().ok_or_else(beyond)?, view.stride().unwrap_or(size));
        let mut numbers = Vec::new();
        for row in 0..count {
            let bytes = part.get(row.saturating_mul(stride)..).and_then(|rest| rest.get(..size)).ok_or_else(beyond)?;
            let mut source = Source::binary(bytes, Coding::Little);
            for _ in 0..columns {
                numbers.push(source.float(scalar, "a number")?);
            }
        }
        Ok(numbers)
    }
}

/// The data of a buffer. Only the first may be the binary data of the file.
fn data<'b>(
    buffer: &gltf::Buffer<'_>,
    blob: Option<Cow<'b, [u8]>>,
    beside: &mut Beside<'_>,
) -> Result<Cow<'b, [u8]>, ReadError> {
    let index = buffer.index();
    match buffer.source() {
        Data::Bin if index == 0 => blob.ok_or_else(|| ReadError::new("ends before its binary data", CUT)),
        Data::Bin => Err(ReadError::damaged(format!("has no data for its buffer {index}"))),
        Data::Uri(uri) => match uri.strip_prefix("data:").map(|data| data.split_once(";base64,")) {
            Some(Some((_, text))) => STANDARD
                .decode(text.trim())
                .map(Cow::Owned)
                .map_err(|error| ReadError::damaged(format!("has damaged Base64 in its buffer {index}: {error}"))),
            Some(None) => Err(ReadError::new(format!("has no Base64 in its buffer {index}"), ONE_FILE)),
            None => {
                let name = name_beside(uri)?;
                beside(&name).map(Cow::Owned).map_err(|ReadError { message, help }| ReadError {
                    message: format!("has its data in {}, which {message}", quoted(name.as_bytes())),
                    help: help.or_else(|| Some(ONE_FILE.to_owned())),
                })
            }
        },
    }
}

/// The remedy for data elsewhere.
const ONE_FILE: &str = "put its `.bin` file beside it, or export it as one file, `.glb`";

/// The name of a file beside, from its address. Files elsewhere are nothing that a mesh may read.
fn name_beside(uri: &str) -> Result<String, ReadError> {
    let name = decoded(uri);
    let leaves = name.starts_with(['/', '\\']) || name.split(['/', '\\']).any(|part| part == "..");
    let elsewhere = match () {
        () if name.contains(':') => "by an address",
        () if leaves => "outside of its folder",
        () => return Ok(name.replace('\\', "/")),
    };
    let message = format!("has its data {elsewhere}, {}; expected a file beside it", quoted(uri.as_bytes()));
    Err(ReadError::new(message, ONE_FILE))
}

/// A text with the bytes that `%20` and others stand for.
fn decoded(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [byte, after @ ..] = rest {
        let digits = after.get(..2).filter(|digits| *byte == b'%' && digits.iter().all(u8::is_ascii_hexdigit));
        let code = digits.and_then(|digits| u8::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok());
        bytes.push(code.unwrap_or(*byte));
        rest = if code.is_some() { &after[2..] } else { after };
    }
    String::from_utf8(bytes).unwrap_or_else(|_| uri.to_owned())
}
