//! AVX2 and AVX-512.

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
    Mul mul (a, b) unsafe { _mm256_mul_pd(a, b) };
    Div div (a, b) unsafe { _mm256_div_pd(a, b) };;
    -a unsafe { _mm256_xor_pd(a, _mm256_set1_pd(-0.0)) }
}
operators! { Avx512,
    Add add (a, b) unsafe { _mm512_add_pd(a, b) };
    Sub sub (a, b) unsafe { _mm512_sub_pd(a, b) };
    Mul mul (a, b) unsafe { _mm512_mul_pd(a, b) };
    Div div (a, b) unsafe { _mm512_div_pd(a, b) };;
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

/// Eight lanes of two vectors after one another, from a lane of the first on.
#[inline(always)]
unsafe fn rotated<const FROM: i32>(low: __m512d, high: __m512d) -> __m512d {
    let (low, high) = unsafe { (_mm512_castpd_si512(low), _mm512_castpd_si512(high)) };
    unsafe { _mm512_castsi512_pd(_mm512_alignr_epi64::<FROM>(high, low)) }
}

impl Lanes for Avx2 {
    type Mask = __m256d;
    consecutive!();
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
    lanewise! {
        mul_add(a, b, c) unsafe { _mm256_fmadd_pd(a, b, c) };
        neg_mul_add(a, b, c) unsafe { _mm256_fnmadd_pd(a, b, c) };
        mul_sub(a, b, c) unsafe { _mm256_fmsub_pd(a, b, c) };
        sqrt(a) unsafe { _mm256_sqrt_pd(a) };
        max(a, b) unsafe { _mm256_max_pd(a, b) };
        abs(a) unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), a) };
        // The upper half of `previous` and the lower half of `a`, then the odd lanes of that and the even ones of `a`.
        shift_in(a, previous) unsafe { _mm256_shuffle_pd::<0b0101>(_mm256_permute2f128_pd::<0x21>(previous, a), a) };
        // The odd lanes of `a`, and the even ones of its upper half and the lower half of `next`.
        shift_out(a, next) unsafe { _mm256_shuffle_pd::<0b0101>(a, _mm256_permute2f128_pd::<0x21>(a, next)) };;
        lt(a, b) unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(a, b) };
        le(a, b) unsafe { _mm256_cmp_pd::<_CMP_LE_OQ>(a, b) };
    }
    #[inline(always)]
    fn select(self, mask: __m256d, other: Self) -> Self {
        Self(unsafe { _mm256_blendv_pd(other.0, self.0, mask) })
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
    lanewise! {
        mul_add(a, b, c) unsafe { _mm512_fmadd_pd(a, b, c) };
        neg_mul_add(a, b, c) unsafe { _mm512_fnmadd_pd(a, b, c) };
        mul_sub(a, b, c) unsafe { _mm512_fmsub_pd(a, b, c) };
        sqrt(a) unsafe { _mm512_sqrt_pd(a) };
        max(a, b) unsafe { _mm512_max_pd(a, b) };
        abs(a) unsafe { _mm512_abs_pd(a) };
        shift_in(a, previous) unsafe { rotated::<7>(previous, a) };
        shift_out(a, next) unsafe { rotated::<1>(a, next) };;
        lt(a, b) unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b) };
        le(a, b) unsafe { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(a, b) };
    }
    #[inline(always)]
    fn select(self, mask: __mmask8, other: Self) -> Self {
        Self(unsafe { _mm512_mask_blend_pd(mask, other.0, self.0) })
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
