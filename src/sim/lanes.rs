//! Vectors of doubles, and the choice of the widest vector set that the processor supports.
//!
//! A kernel is written once, generic over [`Lanes`], as a [`Work`]; [`Set::run`] compiles it for every vector set and
//! runs the chosen one. Each operation is one IEEE operation per lane, rounded once, so a kernel whose lanes are
//! independent has the same bits for every set. The bits of NaN are not defined.

#![expect(clippy::disallowed_methods, reason = "fused operations, written alike for every set")]
#![expect(unsafe_code, reason = "vector instructions, which a processor may lack, and unchecked loads and stores")]

use std::ops::{Add, Mul, Neg, Sub};
use std::sync::atomic::{AtomicUsize, Ordering};

/// An array of two, three, four or eight values, each by an expression of its index. `array::map` is not used because
/// closures are separate functions, compiled without the vector set and not always inlined.
macro_rules! each {
    (2, $at:ident => $value:expr) => {
        [
            {
                let $at = 0usize;
                $value
            },
            {
                let $at = 1usize;
                $value
            },
        ]
    };
    (3, $at:ident => $value:expr) => {
        [
            {
                let $at = 0usize;
                $value
            },
            {
                let $at = 1usize;
                $value
            },
            {
                let $at = 2usize;
                $value
            },
        ]
    };
    (4, $at:ident => $value:expr) => {
        [
            {
                let $at = 0usize;
                $value
            },
            {
                let $at = 1usize;
                $value
            },
            {
                let $at = 2usize;
                $value
            },
            {
                let $at = 3usize;
                $value
            },
        ]
    };
    (8, $at:ident => $value:expr) => {{
        let [a, b, c, d] = each!(4, $at => $value);
        let [e, f, g, h] = each!(4, low => {
            let $at = low + 4;
            $value
        });
        [a, b, c, d, e, f, g, h]
    }};
}
pub(in crate::sim) use each;

/// An unrolled loop over 0, 1, 2: if the compiler keeps a loop, it keeps its vectors in memory.
macro_rules! thrice {
    ($at:ident => $body:expr) => {{
        {
            let $at = 0usize;
            $body
        }
        {
            let $at = 1usize;
            $body
        }
        {
            let $at = 2usize;
            $body
        }
    }};
}
pub(in crate::sim) use thrice;

/// The largest number of lanes of any set. Arrays padded to a multiple of it suit all sets.
pub(in crate::sim) const MOST: usize = 8;

/// A vector of doubles, with operations on each lane.
///
/// Every function is `#[inline(always)]`, so that it becomes part of a function compiled for its set. Only [`Set::run`]
/// may name an implementation.
pub(in crate::sim) trait Lanes:
    Copy + Send + Sync + 'static + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// One truth value per lane.
    type Mask: Copy;
    /// The number of lanes, a power of two and at most [`MOST`].
    const WIDTH: usize;

    /// The same value in all lanes.
    fn splat(value: f64) -> Self;
    /// [`Self::WIDTH`] values from memory, of any alignment.
    ///
    /// # Safety
    /// They are readable.
    unsafe fn load(from: *const f64) -> Self;
    /// A precomputed distance for [`Self::load_beyond`].
    type Distance: Copy;
    /// The distance of so many values, less than [`MOST`].
    fn distance(values: usize) -> Self::Distance;
    /// [`Self::WIDTH`] values at a distance beyond an address that is aligned for [`MOST`] values. Where a vector is a
    /// cache line, this reads two whole lines, the second of which is `line` values after the first: loads that cross
    /// lines, or cross data that were just stored, are much slower. With narrower vectors the values are consecutive.
    ///
    /// # Safety
    /// [`MOST`] values are readable from both places, or twice as many from the first.
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
    /// `self / divisor`.
    fn div(self, divisor: Self) -> Self;
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

/// A computation that can be compiled for the lanes of each set.
pub(in crate::sim) trait Work {
    /// Its result.
    type Output;
    /// Computes the result. Implementations are `#[inline(always)]`.
    fn run<L: Lanes>(self) -> Self::Output;
}

/// A vector set that this processor supports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::sim) struct Set(Kind);

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
    pub(in crate::sim) fn best() -> Self {
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
    pub(in crate::sim) fn all() -> impl Iterator<Item = Self> {
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
    pub(in crate::sim) fn run<W: Work>(self, work: W) -> W::Output {
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

/// Arrays, for any processor. Without fused operations a library computes the same bits.
mod portable {
    use super::*;
    use std::array::from_fn;

    const N: usize = 2;

    #[derive(Clone, Copy)]
    pub(super) struct Vector([f64; N]);

    operators! { Vector,
        Add add (a, b) from_fn(|at| a[at] + b[at]);
        Sub sub (a, b) from_fn(|at| a[at] - b[at]);
        Mul mul (a, b) from_fn(|at| a[at] * b[at]);;
        -a from_fn(|at| -a[at])
    }

    impl Vector {
        #[inline(always)]
        fn each(self, other: Self, one: impl Fn(f64, f64) -> f64) -> Self {
            Self(from_fn(|at| one(self.0[at], other.0[at])))
        }
        #[inline(always)]
        fn test(self, other: Self, one: impl Fn(f64, f64) -> bool) -> [bool; N] {
            from_fn(|at| one(self.0[at], other.0[at]))
        }
    }

    impl Lanes for Vector {
        type Mask = [bool; N];
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
        const WIDTH: usize = N;
        #[inline(always)]
        fn splat(value: f64) -> Self {
            Self([value; N])
        }
        #[inline(always)]
        unsafe fn load(from: *const f64) -> Self {
            // SAFETY: the caller's; an array has the alignment of its entries.
            Self(unsafe { *from.cast::<[f64; N]>() })
        }
        #[inline(always)]
        unsafe fn store(self, to: *mut f64) {
            // SAFETY: as above.
            unsafe { *to.cast::<[f64; N]>() = self.0 }
        }
        #[inline(always)]
        fn mul_add(self, factor: Self, summand: Self) -> Self {
            Self(from_fn(|at| self.0[at].mul_add(factor.0[at], summand.0[at])))
        }
        #[inline(always)]
        fn neg_mul_add(self, factor: Self, summand: Self) -> Self {
            (-self).mul_add(factor, summand)
        }
        #[inline(always)]
        fn mul_sub(self, factor: Self, minuend: Self) -> Self {
            self.mul_add(factor, -minuend)
        }
        #[inline(always)]
        fn div(self, divisor: Self) -> Self {
            self.each(divisor, |a, b| a / b)
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(self.0.map(f64::sqrt))
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            self.each(other, |a, b| if a > b { a } else { b })
        }
        #[inline(always)]
        fn abs(self) -> Self {
            Self(self.0.map(f64::abs))
        }
        #[inline(always)]
        fn lt(self, other: Self) -> [bool; N] {
            self.test(other, |a, b| a < b)
        }
        #[inline(always)]
        fn le(self, other: Self) -> [bool; N] {
            self.test(other, |a, b| a <= b)
        }
        #[inline(always)]
        fn select(self, mask: [bool; N], other: Self) -> Self {
            Self(from_fn(|at| if mask[at] { self.0[at] } else { other.0[at] }))
        }
        #[inline(always)]
        fn shift_in(self, previous: Self) -> Self {
            Self(from_fn(|at| if at == 0 { previous.0[N - 1] } else { self.0[at - 1] }))
        }
        #[inline(always)]
        fn shift_out(self, next: Self) -> Self {
            Self(from_fn(|at| if at == N - 1 { next.0[0] } else { self.0[at + 1] }))
        }
        #[inline(always)]
        fn bits(mask: [bool; N]) -> u32 {
            mask.iter().rev().fold(0, |bits, &lane| bits << 1 | u32::from(lane))
        }
        #[inline(always)]
        fn mask(bits: u32) -> [bool; N] {
            from_fn(|at| bits >> at & 1 == 1)
        }
        #[inline(always)]
        fn both(a: [bool; N], b: [bool; N]) -> [bool; N] {
            from_fn(|at| a[at] && b[at])
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::*;
    use std::arch::x86_64::*;

    /// Runs `work` compiled for AVX2.
    ///
    /// # Safety
    /// The processor supports these features.
    #[target_feature(enable = "avx2,fma")]
    pub(super) unsafe fn avx2<W: Work>(work: W) -> W::Output {
        work.run::<Avx2>()
    }

    /// Runs `work` compiled for AVX-512.
    ///
    /// # Safety
    /// The processor supports these features.
    #[target_feature(enable = "avx512f,avx2,fma")]
    pub(super) unsafe fn avx512<W: Work>(work: W) -> W::Output {
        work.run::<Avx512>()
    }

    #[derive(Clone, Copy)]
    pub(super) struct Avx2(__m256d);
    #[derive(Clone, Copy)]
    pub(super) struct Avx512(__m512d);

    // SAFETY of every block below: only `avx2` and `avx512` name these types, and their callers ensure that the
    // processor supports them. For pointers see the conditions of `load` and `store`.
    operators! { Avx2,
        Add add (a, b) unsafe { _mm256_add_pd(a, b) };
        Sub sub (a, b) unsafe { _mm256_sub_pd(a, b) };
        Mul mul (a, b) unsafe { _mm256_mul_pd(a, b) };;
        -a unsafe { _mm256_xor_pd(a, _mm256_set1_pd(-0.0)) }
    }
    operators! { Avx512,
        Add add (a, b) unsafe { _mm512_add_pd(a, b) };
        Sub sub (a, b) unsafe { _mm512_sub_pd(a, b) };
        Mul mul (a, b) unsafe { _mm512_mul_pd(a, b) };;
        -a unsafe { _mm512_castsi512_pd(_mm512_xor_epi64(_mm512_castpd_si512(a), _mm512_set1_epi64(i64::MIN))) }
    }

    /// Transposes four rows.
    #[inline(always)]
    fn transposed(a: __m256d, b: __m256d, c: __m256d, d: __m256d) -> [Avx2; 4] {
        unsafe {
            let (even_low, odd_low) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
            let (even_high, odd_high) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
            [
                Avx2(_mm256_permute2f128_pd::<0x20>(even_low, even_high)),
                Avx2(_mm256_permute2f128_pd::<0x20>(odd_low, odd_high)),
                Avx2(_mm256_permute2f128_pd::<0x31>(even_low, even_high)),
                Avx2(_mm256_permute2f128_pd::<0x31>(odd_low, odd_high)),
            ]
        }
    }

    /// Transposes the quarters of four vectors.
    #[inline(always)]
    fn quarters(a: __m512d, b: __m512d, c: __m512d, d: __m512d) -> [Avx512; 4] {
        unsafe {
            let (low, high) = (_mm512_shuffle_f64x2::<0x88>(a, b), _mm512_shuffle_f64x2::<0x88>(c, d));
            let (low_odd, high_odd) = (_mm512_shuffle_f64x2::<0xdd>(a, b), _mm512_shuffle_f64x2::<0xdd>(c, d));
            [
                Avx512(_mm512_shuffle_f64x2::<0x88>(low, high)),
                Avx512(_mm512_shuffle_f64x2::<0x88>(low_odd, high_odd)),
                Avx512(_mm512_shuffle_f64x2::<0xdd>(low, high)),
                Avx512(_mm512_shuffle_f64x2::<0xdd>(low_odd, high_odd)),
            ]
        }
    }

    /// Transposes eight rows.
    #[inline(always)]
    fn transposed_8(r: [__m512d; 8]) -> [Avx512; 8] {
        unsafe {
            // Interleaves pairs of rows, the even columns and the odd ones; then collects the same column of all pairs.
            let [c0, c2, c4, c6] = quarters(
                _mm512_unpacklo_pd(r[0], r[1]),
                _mm512_unpacklo_pd(r[2], r[3]),
                _mm512_unpacklo_pd(r[4], r[5]),
                _mm512_unpacklo_pd(r[6], r[7]),
            );
            let [c1, c3, c5, c7] = quarters(
                _mm512_unpackhi_pd(r[0], r[1]),
                _mm512_unpackhi_pd(r[2], r[3]),
                _mm512_unpackhi_pd(r[4], r[5]),
                _mm512_unpackhi_pd(r[6], r[7]),
            );
            [c0, c1, c2, c3, c4, c5, c6, c7]
        }
    }

    impl Lanes for Avx2 {
        type Mask = __m256d;
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
        const WIDTH: usize = 4;
        #[inline(always)]
        fn splat(value: f64) -> Self {
            Self(unsafe { _mm256_set1_pd(value) })
        }
        #[inline(always)]
        unsafe fn load(from: *const f64) -> Self {
            Self(unsafe { _mm256_loadu_pd(from) })
        }
        #[inline(always)]
        unsafe fn store(self, to: *mut f64) {
            unsafe { _mm256_storeu_pd(to, self.0) }
        }
        #[inline(always)]
        fn mul_add(self, factor: Self, summand: Self) -> Self {
            Self(unsafe { _mm256_fmadd_pd(self.0, factor.0, summand.0) })
        }
        #[inline(always)]
        fn neg_mul_add(self, factor: Self, summand: Self) -> Self {
            Self(unsafe { _mm256_fnmadd_pd(self.0, factor.0, summand.0) })
        }
        #[inline(always)]
        fn mul_sub(self, factor: Self, minuend: Self) -> Self {
            Self(unsafe { _mm256_fmsub_pd(self.0, factor.0, minuend.0) })
        }
        #[inline(always)]
        fn div(self, divisor: Self) -> Self {
            Self(unsafe { _mm256_div_pd(self.0, divisor.0) })
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(unsafe { _mm256_sqrt_pd(self.0) })
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            Self(unsafe { _mm256_max_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn abs(self) -> Self {
            Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
        }
        #[inline(always)]
        fn lt(self, other: Self) -> __m256d {
            unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn le(self, other: Self) -> __m256d {
            unsafe { _mm256_cmp_pd::<_CMP_LE_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn select(self, mask: __m256d, other: Self) -> Self {
            Self(unsafe { _mm256_blendv_pd(other.0, self.0, mask) })
        }
        #[inline(always)]
        fn shift_in(self, previous: Self) -> Self {
            // The upper half of `previous` and the lower half of `self`, then the odd lanes of that and the even ones
            // of `self`.
            Self(unsafe { _mm256_shuffle_pd::<0b0101>(_mm256_permute2f128_pd::<0x21>(previous.0, self.0), self.0) })
        }
        #[inline(always)]
        fn shift_out(self, next: Self) -> Self {
            // The odd lanes of `self`, and the even ones of its upper half and the lower half of `next`.
            Self(unsafe { _mm256_shuffle_pd::<0b0101>(self.0, _mm256_permute2f128_pd::<0x21>(self.0, next.0)) })
        }
        #[inline(always)]
        fn bits(mask: __m256d) -> u32 {
            unsafe { _mm256_movemask_pd(mask) as u32 }
        }
        #[inline(always)]
        fn mask(bits: u32) -> __m256d {
            unsafe {
                let lanes = _mm256_set_epi64x(8, 4, 2, 1);
                let own = _mm256_and_si256(_mm256_set1_epi64x(i64::from(bits)), lanes);
                _mm256_castsi256_pd(_mm256_cmpeq_epi64(own, lanes))
            }
        }
        #[inline(always)]
        fn both(a: __m256d, b: __m256d) -> __m256d {
            unsafe { _mm256_and_pd(a, b) }
        }
        #[inline(always)]
        fn expect(line: *const f64) {
            unsafe { _mm_prefetch::<_MM_HINT_T0>(line.cast()) }
        }
        #[inline(always)]
        unsafe fn columns(row: impl Fn(usize) -> *const f64) -> [Self; 8] {
            let [a, b, c, d] = each!(4, lane => row(lane));
            unsafe {
                let low = each!(4, lane => _mm256_loadu_pd([a, b, c, d][lane]));
                let high = each!(4, lane => _mm256_loadu_pd([a, b, c, d][lane].add(4)));
                let [c0, c1, c2, c3] = transposed(low[0], low[1], low[2], low[3]);
                let [c4, c5, c6, c7] = transposed(high[0], high[1], high[2], high[3]);
                [c0, c1, c2, c3, c4, c5, c6, c7]
            }
        }
        #[inline(always)]
        unsafe fn columns_4(row: impl Fn(usize) -> *const f64) -> [Self; 4] {
            let rows = each!(4, lane => unsafe { _mm256_loadu_pd(row(lane)) });
            transposed(rows[0], rows[1], rows[2], rows[3])
        }
        #[inline(always)]
        unsafe fn put_rows(c: [Self; 8], row: impl Fn(usize) -> *mut f64) {
            let low = transposed(c[0].0, c[1].0, c[2].0, c[3].0);
            let high = transposed(c[4].0, c[5].0, c[6].0, c[7].0);
            each!(4, lane => unsafe {
                _mm256_storeu_pd(row(lane), low[lane].0);
                _mm256_storeu_pd(row(lane).add(4), high[lane].0);
            });
        }
        #[inline(always)]
        unsafe fn add_rows(c: [Self; 4], row: impl Fn(usize) -> *mut f64) {
            let rows = transposed(c[0].0, c[1].0, c[2].0, c[3].0);
            each!(4, lane => unsafe {
                _mm256_storeu_pd(row(lane), _mm256_add_pd(_mm256_loadu_pd(row(lane)), rows[lane].0));
            });
        }
    }

    impl Lanes for Avx512 {
        type Mask = __mmask8;
        type Distance = __m512i;
        #[inline(always)]
        fn distance(values: usize) -> __m512i {
            unsafe { _mm512_add_epi64(_mm512_set_epi64(7, 6, 5, 4, 3, 2, 1, 0), _mm512_set1_epi64(values as i64)) }
        }
        #[inline(always)]
        unsafe fn load_beyond(from: *const f64, distance: __m512i, line: usize) -> Self {
            Self(unsafe { _mm512_permutex2var_pd(_mm512_load_pd(from), distance, _mm512_load_pd(from.add(line))) })
        }
        const WIDTH: usize = 8;
        #[inline(always)]
        fn splat(value: f64) -> Self {
            Self(unsafe { _mm512_set1_pd(value) })
        }
        #[inline(always)]
        unsafe fn load(from: *const f64) -> Self {
            Self(unsafe { _mm512_loadu_pd(from) })
        }
        #[inline(always)]
        unsafe fn store(self, to: *mut f64) {
            unsafe { _mm512_storeu_pd(to, self.0) }
        }
        #[inline(always)]
        fn mul_add(self, factor: Self, summand: Self) -> Self {
            Self(unsafe { _mm512_fmadd_pd(self.0, factor.0, summand.0) })
        }
        #[inline(always)]
        fn neg_mul_add(self, factor: Self, summand: Self) -> Self {
            Self(unsafe { _mm512_fnmadd_pd(self.0, factor.0, summand.0) })
        }
        #[inline(always)]
        fn mul_sub(self, factor: Self, minuend: Self) -> Self {
            Self(unsafe { _mm512_fmsub_pd(self.0, factor.0, minuend.0) })
        }
        #[inline(always)]
        fn div(self, divisor: Self) -> Self {
            Self(unsafe { _mm512_div_pd(self.0, divisor.0) })
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(unsafe { _mm512_sqrt_pd(self.0) })
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            Self(unsafe { _mm512_max_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn abs(self) -> Self {
            Self(unsafe { _mm512_abs_pd(self.0) })
        }
        #[inline(always)]
        fn lt(self, other: Self) -> __mmask8 {
            unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn le(self, other: Self) -> __mmask8 {
            unsafe { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn select(self, mask: __mmask8, other: Self) -> Self {
            Self(unsafe { _mm512_mask_blend_pd(mask, other.0, self.0) })
        }
        #[inline(always)]
        fn shift_in(self, previous: Self) -> Self {
            Self(unsafe {
                let (low, high) = (_mm512_castpd_si512(previous.0), _mm512_castpd_si512(self.0));
                _mm512_castsi512_pd(_mm512_alignr_epi64::<7>(high, low))
            })
        }
        #[inline(always)]
        fn shift_out(self, next: Self) -> Self {
            Self(unsafe {
                let (low, high) = (_mm512_castpd_si512(self.0), _mm512_castpd_si512(next.0));
                _mm512_castsi512_pd(_mm512_alignr_epi64::<1>(high, low))
            })
        }
        #[inline(always)]
        fn bits(mask: __mmask8) -> u32 {
            u32::from(mask)
        }
        #[inline(always)]
        fn mask(bits: u32) -> __mmask8 {
            bits as __mmask8
        }
        #[inline(always)]
        fn both(a: __mmask8, b: __mmask8) -> __mmask8 {
            a & b
        }
        #[inline(always)]
        fn expect(line: *const f64) {
            unsafe { _mm_prefetch::<_MM_HINT_T0>(line.cast()) }
        }
        #[inline(always)]
        unsafe fn columns(row: impl Fn(usize) -> *const f64) -> [Self; 8] {
            transposed_8(each!(8, lane => unsafe { _mm512_loadu_pd(row(lane)) }))
        }
        #[inline(always)]
        unsafe fn columns_4(row: impl Fn(usize) -> *const f64) -> [Self; 4] {
            // Rows n and n + 2 side by side, so that unpacking gives pairs of adjacent rows in the quarters.
            let [a, b, _, _, c, d, _, _] = each!(8, lane => unsafe {
                let low = _mm512_castpd256_pd512(_mm256_loadu_pd(row(lane)));
                _mm512_insertf64x4::<1>(low, _mm256_loadu_pd(row((lane + 2) % MOST)))
            });
            unsafe {
                let (even_low, even_high) = (_mm512_unpacklo_pd(a, b), _mm512_unpacklo_pd(c, d));
                let (odd_low, odd_high) = (_mm512_unpackhi_pd(a, b), _mm512_unpackhi_pd(c, d));
                [
                    Self(_mm512_shuffle_f64x2::<0x88>(even_low, even_high)),
                    Self(_mm512_shuffle_f64x2::<0x88>(odd_low, odd_high)),
                    Self(_mm512_shuffle_f64x2::<0xdd>(even_low, even_high)),
                    Self(_mm512_shuffle_f64x2::<0xdd>(odd_low, odd_high)),
                ]
            }
        }
        #[inline(always)]
        unsafe fn put_rows(c: [Self; 8], row: impl Fn(usize) -> *mut f64) {
            let rows = transposed_8(each!(8, column => c[column].0));
            each!(8, lane => unsafe { _mm512_storeu_pd(row(lane), rows[lane].0) });
        }
        #[inline(always)]
        unsafe fn add_rows(c: [Self; 4], row: impl Fn(usize) -> *mut f64) {
            unsafe {
                let first = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11);
                let last = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
                let (xy, zw) = (_mm512_unpacklo_pd(c[0].0, c[1].0), _mm512_unpacklo_pd(c[2].0, c[3].0));
                let even = [_mm512_permutex2var_pd(xy, first, zw), _mm512_permutex2var_pd(xy, last, zw)];
                let (xy, zw) = (_mm512_unpackhi_pd(c[0].0, c[1].0), _mm512_unpackhi_pd(c[2].0, c[3].0));
                let odd = [_mm512_permutex2var_pd(xy, first, zw), _mm512_permutex2var_pd(xy, last, zw)];
                // Rows 0 and 2, 1 and 3, 4 and 6, 5 and 7.
                let pairs = [even[0], odd[0], even[1], odd[1]];
                each!(8, lane => {
                    let two = pairs[lane / 4 * 2 + lane % 2];
                    let own = if lane & 2 == 0 { _mm512_castpd512_pd256(two) } else { _mm512_extractf64x4_pd::<1>(two) };
                    _mm256_storeu_pd(row(lane), _mm256_add_pd(_mm256_loadu_pd(row(lane)), own));
                });
            }
        }
    }
}

#[cfg(target_arch = "aarch64")]
mod neon {
    use super::*;
    use std::arch::aarch64::*;

    #[derive(Clone, Copy)]
    pub(super) struct Vector(float64x2_t);

    // SAFETY of every block below: every processor of this architecture has NEON. For pointers see `load` and `store`.
    operators! { Vector,
        Add add (a, b) unsafe { vaddq_f64(a, b) };
        Sub sub (a, b) unsafe { vsubq_f64(a, b) };
        Mul mul (a, b) unsafe { vmulq_f64(a, b) };;
        -a unsafe { vnegq_f64(a) }
    }

    impl Lanes for Vector {
        type Mask = uint64x2_t;
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
        const WIDTH: usize = 2;
        #[inline(always)]
        fn splat(value: f64) -> Self {
            Self(unsafe { vdupq_n_f64(value) })
        }
        #[inline(always)]
        unsafe fn load(from: *const f64) -> Self {
            Self(unsafe { vld1q_f64(from) })
        }
        #[inline(always)]
        unsafe fn store(self, to: *mut f64) {
            unsafe { vst1q_f64(to, self.0) }
        }
        #[inline(always)]
        fn mul_add(self, factor: Self, summand: Self) -> Self {
            Self(unsafe { vfmaq_f64(summand.0, self.0, factor.0) })
        }
        #[inline(always)]
        fn neg_mul_add(self, factor: Self, summand: Self) -> Self {
            Self(unsafe { vfmsq_f64(summand.0, self.0, factor.0) })
        }
        #[inline(always)]
        fn mul_sub(self, factor: Self, minuend: Self) -> Self {
            self.mul_add(factor, -minuend)
        }
        #[inline(always)]
        fn div(self, divisor: Self) -> Self {
            Self(unsafe { vdivq_f64(self.0, divisor.0) })
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(unsafe { vsqrtq_f64(self.0) })
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            self.select(other.lt(self), other)
        }
        #[inline(always)]
        fn abs(self) -> Self {
            Self(unsafe { vabsq_f64(self.0) })
        }
        #[inline(always)]
        fn lt(self, other: Self) -> uint64x2_t {
            unsafe { vcltq_f64(self.0, other.0) }
        }
        #[inline(always)]
        fn le(self, other: Self) -> uint64x2_t {
            unsafe { vcleq_f64(self.0, other.0) }
        }
        #[inline(always)]
        fn select(self, mask: uint64x2_t, other: Self) -> Self {
            Self(unsafe { vbslq_f64(mask, self.0, other.0) })
        }
        #[inline(always)]
        fn shift_in(self, previous: Self) -> Self {
            Self(unsafe { vextq_f64::<1>(previous.0, self.0) })
        }
        #[inline(always)]
        fn shift_out(self, next: Self) -> Self {
            Self(unsafe { vextq_f64::<1>(self.0, next.0) })
        }
        #[inline(always)]
        fn bits(mask: uint64x2_t) -> u32 {
            unsafe { (vgetq_lane_u64::<0>(mask) & 1 | vgetq_lane_u64::<1>(mask) & 2) as u32 }
        }
        #[inline(always)]
        fn mask(bits: u32) -> uint64x2_t {
            let lane = |at: u32| if bits >> at & 1 == 1 { u64::MAX } else { 0 };
            unsafe { vsetq_lane_u64::<1>(lane(1), vdupq_n_u64(lane(0))) }
        }
        #[inline(always)]
        fn both(a: uint64x2_t, b: uint64x2_t) -> uint64x2_t {
            unsafe { vandq_u64(a, b) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every operation on three vectors: its results, lane after lane.
    struct Everything([[f64; MOST]; 3]);

    impl Work for Everything {
        type Output = Vec<Vec<f64>>;
        #[inline(always)]
        fn run<L: Lanes>(self) -> Vec<Vec<f64>> {
            // Eight lanes of each operation, in as many vectors as the width needs.
            let mut all = vec![Vec::new(); 19];
            let mut previous = L::splat(9.0);
            for first in (0..MOST).step_by(L::WIDTH) {
                // SAFETY: WIDTH divides MOST.
                let [a, b, c] = self.0.each_ref().map(|array| unsafe { L::load(array[first..].as_ptr()) });
                let next = self.0[0].get(first + L::WIDTH).map_or(9.0, |&value| value);
                let flag = |mask| {
                    assert_eq!(L::bits(L::mask(L::bits(mask))), L::bits(mask));
                    L::splat(1.0).select(mask, L::splat(0.0))
                };
                let results = [
                    a + b,
                    a - b,
                    a * b,
                    -a,
                    a.mul_add(b, c),
                    a.neg_mul_add(b, c),
                    a.mul_sub(b, c),
                    a.div(b),
                    a.abs().sqrt(),
                    a.max(b),
                    a.abs(),
                    flag(a.lt(b)),
                    flag(a.le(b)),
                    c.select(a.lt(b), a),
                    a.shift_in(previous),
                    a.shift_out(L::splat(next)),
                    flag(L::both(a.lt(b), b.le(c))),
                    flag(L::mask(0b0110_1001 >> first)),
                    L::from_array(a.to_array()),
                ];
                previous = a;
                for (out, result) in all.iter_mut().zip(results) {
                    out.extend_from_slice(&result.to_array()[..L::WIDTH]);
                }
            }
            all
        }
    }

    #[test]
    fn every_set_does_what_one_lane_after_the_other_would() {
        let a = [1.0, -0.1, 3e200, 5.0, 0.0, f64::NAN, 7.0 / 3.0, -1e-300];
        let b = [1.0 / 3.0, 0.3, -2e150, 5.0, -0.0, 1.0, 0.7, 1e-20];
        let c = [-1.0 / 3.0, 0.03, 1.0, f64::INFINITY, 4.0, 2.0, f64::NAN, 3.0];
        let each =
            |one: &dyn Fn(f64, f64, f64) -> f64| -> Vec<f64> { (0..MOST).map(|at| one(a[at], b[at], c[at])).collect() };
        let flag = f64::from;
        let expected = [
            each(&|a, b, _| a + b),
            each(&|a, b, _| a - b),
            each(&|a, b, _| a * b),
            each(&|a, _, _| -a),
            each(&|a, b, c| a.mul_add(b, c)),
            each(&|a, b, c| (-a).mul_add(b, c)),
            each(&|a, b, c| a.mul_add(b, -c)),
            each(&|a, b, _| a / b),
            each(&|a, _, _| a.abs().sqrt()),
            each(&|a, b, _| if a > b { a } else { b }),
            each(&|a, _, _| a.abs()),
            each(&|a, b, _| flag(a < b)),
            each(&|a, b, _| flag(a <= b)),
            each(&|a, b, c| if a < b { c } else { a }),
            [9.0].into_iter().chain(a).take(MOST).collect(),
            a.into_iter().skip(1).chain([9.0]).collect(),
            each(&|a, b, c| flag(a < b && b <= c)),
            [1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0].to_vec(),
            a.to_vec(),
        ];
        // The bits of NaN are not defined.
        let bits = |all: &[Vec<f64>]| -> Vec<Vec<u64>> {
            all.iter()
                .map(|one| one.iter().map(|v| if v.is_nan() { u64::MAX } else { v.to_bits() }).collect())
                .collect()
        };
        for set in Set::all() {
            assert_eq!(bits(&set.run(Everything([a, b, c]))), bits(&expected), "{set:?}");
        }
        assert!(Set::all().any(|set| set == Set::best()));
    }
}
