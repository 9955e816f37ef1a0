//! NEON.

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
