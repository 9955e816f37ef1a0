//! NEON.

use super::*;
use std::arch::aarch64::*;

#[derive(Clone, Copy)]
pub(super) struct Vector(float64x2_t);

// SAFETY of every block below: every processor of this architecture has NEON. For pointers see `load` and `store`.
operators! { Vector,
    Add add (a, b) unsafe { vaddq_f64(a, b) };
    Sub sub (a, b) unsafe { vsubq_f64(a, b) };
    Mul mul (a, b) unsafe { vmulq_f64(a, b) };
    Div div (a, b) unsafe { vdivq_f64(a, b) };;
    -a unsafe { vnegq_f64(a) }
}

impl Lanes for Vector {
    type Mask = uint64x2_t;
    consecutive!();
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
    lanewise! {
        mul_add(a, b, c) unsafe { vfmaq_f64(c, a, b) };
        neg_mul_add(a, b, c) unsafe { vfmsq_f64(c, a, b) };
        mul_sub(a, b, c) unsafe { vfmaq_f64(vnegq_f64(c), a, b) };
        sqrt(a) unsafe { vsqrtq_f64(a) };
        max(a, b) unsafe { vbslq_f64(vcltq_f64(b, a), a, b) };
        abs(a) unsafe { vabsq_f64(a) };
        shift_in(a, previous) unsafe { vextq_f64::<1>(previous, a) };
        shift_out(a, next) unsafe { vextq_f64::<1>(a, next) };;
        lt(a, b) unsafe { vcltq_f64(a, b) };
        le(a, b) unsafe { vcleq_f64(a, b) };
    }
    #[inline(always)]
    fn select(self, mask: uint64x2_t, other: Self) -> Self {
        Self(unsafe { vbslq_f64(mask, self.0, other.0) })
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
