//! Arrays, for any processor. Without fused operations a library computes the same bits.

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
