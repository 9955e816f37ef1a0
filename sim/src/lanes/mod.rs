//! Vectors of doubles, and the choice of the widest vector set that the processor supports.
//!
//! A kernel is written once, generic over [`Lanes`], as a [`Work`]; [`Set::run`] compiles it for every vector set and
//! runs the chosen one. Each operation is one IEEE operation per lane, rounded once, so a kernel whose lanes are
//! independent has the same bits for every set. The bits of NaN are not defined.

#![expect(clippy::disallowed_methods, reason = "fused operations, written alike for every set")]
#![expect(unsafe_code, reason = "vector instructions, which a processor may lack, and unchecked loads and stores")]

use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::atomic::{AtomicUsize, Ordering};

/// An array of two, three, four or eight values, each by an expression of its index, and so an unrolled loop: if the compiler keeps a
/// loop, it keeps its vectors in memory. `array::map` is not used because closures are separate functions, compiled without the vector
/// set and not always inlined.
macro_rules! each {
    (2, $at:ident => $value:expr) => { each!([0, 1], $at => $value) };
    (3, $at:ident => $value:expr) => { each!([0, 1, 2], $at => $value) };
    (4, $at:ident => $value:expr) => { each!([0, 1, 2, 3], $at => $value) };
    (8, $at:ident => $value:expr) => { each!([0, 1, 2, 3, 4, 5, 6, 7], $at => $value) };
    ([$($index:literal),*], $at:ident => $value:expr) => {
        [$({ let $at: usize = $index; $value }),*]
    };
}
pub(crate) use each;

/// The largest number of lanes of any set. Arrays padded to a multiple of it suit all sets.
pub(crate) const MOST: usize = 8;

/// A vector of doubles, with operations on each lane: one, two, four or eight numbers, of as many elements.
///
/// Every function is `#[inline(always)]`, so that it becomes part of a function compiled for its set of vectors. Only that chooses
/// an implementation.
pub trait Lanes:
    Copy
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// One truth value per lane.
    type Mask: Copy;
    /// The number of lanes, a power of two and at most 8.
    const WIDTH: usize;

    /// One value in all lanes.
    fn splat(value: f64) -> Self;
    /// [`Self::WIDTH`] values from memory, of any alignment.
    ///
    /// # Safety
    /// They are readable.
    unsafe fn load(from: *const f64) -> Self;
    /// A precomputed distance for [`Self::load_beyond`].
    type Distance: Copy;
    /// The distance of so many values, less than `MOST`.
    fn distance(values: usize) -> Self::Distance;
    /// [`Self::WIDTH`] values at a distance beyond an address that is aligned for `MOST` values. Where a vector is a
    /// cache line, this reads two whole lines, the second one `line` values after the first: loads that cross
    /// lines, or cross data that were just stored, are much slower. With narrower vectors the values are consecutive.
    ///
    /// # Safety
    /// `MOST` values are readable from both places, or twice as many from the first.
    unsafe fn load_beyond(from: *const f64, distance: Self::Distance, line: usize) -> Self;
    /// Writes [`Self::WIDTH`] values to memory, of any alignment.
    ///
    /// # Safety
    /// They are writable, and no other thread accesses them.
    unsafe fn store(self, to: *mut f64);
    /// `self · factor + summand`, rounded once.
    fn mul_add(self, factor: Self, summand: Self) -> Self;
    /// `summand − self · factor`, rounded once.
    fn neg_mul_add(self, factor: Self, summand: Self) -> Self;
    /// `self · factor − minuend`, rounded once.
    fn mul_sub(self, factor: Self, minuend: Self) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// The greater of both; `other` if one is NaN.
    fn max(self, other: Self) -> Self;
    /// The absolute value.
    fn abs(self) -> Self;
    /// `self < other`; false if one is NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`; false if one is NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// `self` where `mask` is true, `other` elsewhere.
    fn select(self, mask: Self::Mask, other: Self) -> Self;
    /// `[previous.last, self.first, …]`: all lanes move up by one.
    fn shift_in(self, previous: Self) -> Self;
    /// `[self.second, …, next.first]`: all lanes move down by one.
    fn shift_out(self, next: Self) -> Self;
    /// One bit per lane, the lowest for the first.
    fn bits(mask: Self::Mask) -> u32;
    /// The mask with these bits.
    fn mask(bits: u32) -> Self::Mask;
    /// True where both are.
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask;

    /// Prefetches a cache line that will be read soon. The address need not be valid.
    #[inline(always)]
    fn expect(_: *const f64) {}
    /// The columns of rows of eight doubles: lane `n` of column `c` is entry `c` of row `n`.
    ///
    /// # Safety
    /// Each row is readable.
    #[inline(always)]
    unsafe fn columns(row: impl Fn(usize) -> *const f64) -> [Self; 8] {
        let mut columns = [[0.0; MOST]; 8];
        for lane in 0..Self::WIDTH {
            // SAFETY: the caller's.
            let row = unsafe { *row(lane).cast::<[f64; 8]>() };
            columns.iter_mut().zip(row).for_each(|(column, value)| column[lane] = value);
        }
        columns.map(Self::from_array)
    }
    /// The columns of rows of four doubles.
    ///
    /// # Safety
    /// Each row is readable.
    #[inline(always)]
    unsafe fn columns_4(row: impl Fn(usize) -> *const f64) -> [Self; 4] {
        let mut columns = [[0.0; MOST]; 4];
        for lane in 0..Self::WIDTH {
            // SAFETY: the caller's.
            let row = unsafe { *row(lane).cast::<[f64; 4]>() };
            columns.iter_mut().zip(row).for_each(|(column, value)| column[lane] = value);
        }
        columns.map(Self::from_array)
    }
    /// Writes columns as rows of eight doubles, the row of the first lane first.
    ///
    /// # Safety
    /// Each row is writable, and no other thread accesses it.
    #[inline(always)]
    unsafe fn put_rows(columns: [Self; 8], row: impl Fn(usize) -> *mut f64) {
        let columns = columns.map(Self::to_array);
        for lane in 0..Self::WIDTH {
            // SAFETY: the caller's.
            unsafe { *row(lane).cast::<[f64; 8]>() = columns.map(|column| column[lane]) };
        }
    }
    /// Adds columns to rows of four doubles, one row after the other, as two rows may be the same.
    ///
    /// # Safety
    /// Each row is writable, and no other thread accesses it.
    #[inline(always)]
    unsafe fn add_rows(columns: [Self; 4], row: impl Fn(usize) -> *mut f64) {
        let columns = columns.map(Self::to_array);
        for lane in 0..Self::WIDTH {
            // SAFETY: the caller's.
            let sum = unsafe { &mut *row(lane).cast::<[f64; 4]>() };
            sum.iter_mut().zip(&columns).for_each(|(sum, column)| *sum += column[lane]);
        }
    }

    /// All lanes as an array; those beyond [`Self::WIDTH`] are 0.
    #[inline(always)]
    fn to_array(self) -> [f64; MOST] {
        let mut array = [0.0; MOST];
        // SAFETY: WIDTH ≤ MOST.
        unsafe { self.store(array.as_mut_ptr()) };
        array
    }

    /// The first lanes of an array.
    #[inline(always)]
    fn from_array(array: [f64; MOST]) -> Self {
        // SAFETY: WIDTH ≤ MOST.
        unsafe { Self::load(array.as_ptr()) }
    }

    /// The bits of a mask that is true in all lanes.
    const ALL: u32 = (1 << Self::WIDTH) - 1;
}

/// A single number, for what is computed for one element alone.
pub(crate) type One = portable::Vector;

/// A computation that can be compiled for the lanes of each set.
pub(crate) trait Work {
    /// Its result.
    type Output;
    /// Computes the result. Implementations are `#[inline(always)]`.
    fn run<L: Lanes>(self) -> Self::Output;
}

/// A vector set that this processor supports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Set(Kind);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
    #[cfg(target_arch = "aarch64")]
    Neon,
}

/// The greatest number of lanes of [`Set::best`].
pub(super) static WIDEST: AtomicUsize = AtomicUsize::new(MOST);

impl Set {
    /// The widest set that this processor supports and [`WIDEST`] allows.
    pub(crate) fn best() -> Self {
        let widest = WIDEST.load(Ordering::Relaxed);
        Self::all().filter(|set| set.lanes() <= widest).last().unwrap_or(Self(Kind::Portable))
    }

    /// The number of lanes.
    pub(super) fn lanes(self) -> usize {
        match self.0 {
            Kind::Portable => portable::Vector::WIDTH,
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => x86::Avx2::WIDTH,
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => x86::Avx512::WIDTH,
            #[cfg(target_arch = "aarch64")]
            Kind::Neon => neon::Vector::WIDTH,
        }
    }

    /// All sets that this processor supports, the narrowest first. Results have the same bits for all of them.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        let kinds = [
            Some(Kind::Portable),
            #[cfg(target_arch = "x86_64")]
            (is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")).then_some(Kind::Avx2),
            #[cfg(target_arch = "x86_64")]
            (is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("fma")).then_some(Kind::Avx512),
            #[cfg(target_arch = "aarch64")]
            Some(Kind::Neon),
        ];
        // The interpreter Miri supports few vector instructions.
        kinds.into_iter().flatten().filter(|&kind| !cfg!(miri) || kind == Kind::Portable).map(Self)
    }

    /// Computes `work` with the lanes of this set.
    #[inline]
    pub(crate) fn run<W: Work>(self, work: W) -> W::Output {
        match self.0 {
            Kind::Portable => work.run::<portable::Vector>(),
            // SAFETY: sets are made only by `all`, which has found these features in the processor.
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => unsafe { x86::avx2(work) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => unsafe { x86::avx512(work) },
            #[cfg(target_arch = "aarch64")]
            Kind::Neon => work.run::<neon::Vector>(),
        }
    }
}

/// The vector instructions with which the fast kernels step on this processor: their name, and their width (bits).
pub fn vectors() -> (&'static str, usize) {
    let set = Set::best();
    let name = match set.0 {
        Kind::Portable => "portable",
        #[cfg(target_arch = "x86_64")]
        Kind::Avx2 => "AVX2",
        #[cfg(target_arch = "x86_64")]
        Kind::Avx512 => "AVX-512",
        #[cfg(target_arch = "aarch64")]
        Kind::Neon => "NEON",
    };
    (name, 64 * set.lanes())
}

/// Operators that are one operation per lane.
macro_rules! operators {
    ($vector:ty, $($trait:ident $name:ident ($a:ident, $b:ident) $body:expr;)*; -$c:ident $neg:expr) => {
        $(impl $trait for $vector {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                let ($a, $b) = (self.0, other.0);
                Self($body)
            }
        })*
        impl Neg for $vector {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                let $c = self.0;
                Self($neg)
            }
        }
    };
}

/// Functions of [`Lanes`] as operations on the values inside: first functions that make vectors, then, after two semicolons,
/// comparisons.
macro_rules! lanewise {
    ($($name:ident($a:ident $(, $b:ident)*) $value:expr;)*; $($test:ident($c:ident, $d:ident) $mask:expr;)*) => {
        $(#[inline(always)]
        fn $name(self $(, $b: Self)*) -> Self {
            let ($a, $($b,)*) = (self.0, $($b.0,)*);
            Self($value)
        })*
        $(#[inline(always)]
        fn $test(self, other: Self) -> Self::Mask {
            let ($c, $d) = (self.0, other.0);
            $mask
        })*
    };
}

/// How vectors that are no whole cache line are loaded from a distance.
macro_rules! consecutive {
    () => {
        type Distance = usize;
        #[inline(always)]
        fn distance(values: usize) -> usize {
            values
        }
        #[inline(always)]
        unsafe fn load_beyond(from: *const f64, distance: usize, _: usize) -> Self {
            // SAFETY: the caller's.
            unsafe { Self::load(from.add(distance)) }
        }
    };
}

#[cfg(target_arch = "aarch64")]
mod neon;
mod portable;
#[cfg(test)]
mod tests;
#[cfg(target_arch = "x86_64")]
mod x86;
