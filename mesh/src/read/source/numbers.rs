//! Numbers, as text or as bytes.

use super::words::{comma, integer, is_no_number, real};
use super::{Coding, DAMAGED, Source};
use crate::read::ReadError;
use glam::DVec3;

/// A type of binary numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::read) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    /// The type of a name in PLY or in VTK's files, in capital letters or not.
    pub(in crate::read) fn named(name: &[u8]) -> Option<Self> {
        Some(match &*name.to_ascii_lowercase() {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" | b"unsigned_char" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" | b"unsigned_short" => Self::U16,
            // Indices have 32 bits in VTK's legacy format.
            b"int" | b"int32" | b"vtkidtype" => Self::I32,
            b"uint" | b"uint32" | b"unsigned_int" => Self::U32,
            // No standard of PLY has these, but large meshes do.
            b"long" | b"int64" | b"vtktypeint64" => Self::I64,
            b"unsigned_long" | b"uint64" | b"vtktypeuint64" => Self::U64,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    pub(in crate::read) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

/// A point or a vector of two or three components, those in the plane with z = 0.
#[inline]
pub(in crate::read) fn vector(
    components: usize,
    mut next: impl FnMut() -> Result<f64, ReadError>,
) -> Result<DVec3, ReadError> {
    Ok(DVec3::new(next()?, next()?, if components == 3 { next()? } else { 0.0 }))
}

impl Source<'_> {
    /// So many numbers, not looked at: in text, words.
    pub(in crate::read) fn skip(&mut self, count: u64, scalar: Scalar, expected: &str) -> Result<(), ReadError> {
        if self.coding == Coding::Text {
            for _ in 0..count {
                if self.word().is_empty() {
                    return Err(self.ends(expected));
                }
            }
            return Ok(());
        }
        let length = usize::try_from(count).ok().and_then(|count| count.checked_mul(scalar.size()));
        self.take(length.unwrap_or(usize::MAX), expected)?;
        Ok(())
    }

    #[inline]
    fn array<const N: usize>(&mut self, expected: &str) -> Result<[u8; N], ReadError> {
        match self.rest().first_chunk::<N>() {
            Some(bytes) => {
                self.at += N;
                let mut bytes = *bytes;
                if self.coding == Coding::Big {
                    bytes.reverse();
                }
                Ok(bytes)
            }
            None => Err(self.ends(expected)),
        }
    }

    /// A number: a coordinate, for example.
    #[inline]
    pub(in crate::read) fn float(&mut self, scalar: Scalar, expected: &str) -> Result<f64, ReadError> {
        self.number(scalar, expected, false)
    }

    /// A number, or NaN if it may be unknown.
    #[inline]
    fn number(&mut self, scalar: Scalar, expected: &str, may_be_unknown: bool) -> Result<f64, ReadError> {
        if self.coding != Coding::Text {
            return match scalar {
                Scalar::F32 => Ok(f64::from(f32::from_le_bytes(self.array(expected)?))),
                Scalar::F64 => Ok(f64::from_le_bytes(self.array(expected)?)),
                _ => Ok(self.integer(scalar, expected)? as f64),
            };
        }
        let word = self.word();
        match real(word).filter(|value| value.is_finite()) {
            Some(value) => Ok(value),
            None if may_be_unknown && is_no_number(word) => Ok(f64::NAN),
            None => Err(match comma(word) {
                Some(help) => ReadError::new(self.wrong(word, expected).message, help),
                None => self.wrong(word, expected),
            }),
        }
    }

    /// A coordinate of a point, or what programs write for one that they do not know, which is read as NaN.
    #[inline]
    pub(in crate::read) fn coordinate(&mut self, scalar: Scalar) -> Result<f64, ReadError> {
        self.number(scalar, "a coordinate", true)
    }

    /// The coordinates of a point, one after the other. Those that are no numbers are NaN.
    #[inline]
    pub(in crate::read) fn point(&mut self, scalar: Scalar) -> Result<DVec3, ReadError> {
        vector(3, || self.coordinate(scalar))
    }

    /// An integer: an index, for example.
    #[inline]
    pub(in crate::read) fn integer(&mut self, scalar: Scalar, expected: &str) -> Result<i64, ReadError> {
        if self.coding == Coding::Text {
            let word = self.word();
            return integer(word).ok_or_else(|| self.wrong(word, expected));
        }
        let start = self.at;
        let whole = |value: f64| (value.fract() == 0.0 && value.abs() < 1e15).then_some(value as i64);
        let value = match scalar {
            Scalar::I8 => Some(i8::from_le_bytes(self.array(expected)?).into()),
            Scalar::U8 => Some(u8::from_le_bytes(self.array(expected)?).into()),
            Scalar::I16 => Some(i16::from_le_bytes(self.array(expected)?).into()),
            Scalar::U16 => Some(u16::from_le_bytes(self.array(expected)?).into()),
            Scalar::I32 => Some(i32::from_le_bytes(self.array(expected)?).into()),
            Scalar::U32 => Some(u32::from_le_bytes(self.array(expected)?).into()),
            Scalar::I64 => Some(i64::from_le_bytes(self.array(expected)?)),
            Scalar::U64 => i64::try_from(u64::from_le_bytes(self.array(expected)?)).ok(),
            Scalar::F32 => whole(f32::from_le_bytes(self.array(expected)?).into()),
            Scalar::F64 => whole(f64::from_le_bytes(self.array(expected)?)),
        };
        value.ok_or_else(|| {
            ReadError::new(format!("has a number out of range {}; expected {expected}", self.place(start)), DAMAGED)
        })
    }

    /// A number of things that follow.
    pub(in crate::read) fn count(&mut self, scalar: Scalar, expected: &str) -> Result<u64, ReadError> {
        let start = self.at;
        let count = self.integer(scalar, expected)?;
        u64::try_from(count).map_err(|_| self.found(&count.to_string(), start, expected))
    }
}
