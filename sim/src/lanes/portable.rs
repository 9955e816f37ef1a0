//! Single numbers, for any processor. Without fused operations a library computes the same bits, one by one: wider vectors would be more
//! code to build, and no faster.

use super::*;
use std::array::from_fn;

const N: usize = 1;

#[derive(Clone, Copy)]
pub(crate) struct Vector([f64; N]);

operators! { Vector,
    Add add (a, b) from_fn(|at| a[at] + b[at]);
    Sub sub (a, b) from_fn(|at| a[at] - b[at]);
    Mul mul (a, b) from_fn(|at| a[at] * b[at]);
    Div div (a, b) from_fn(|at| a[at] / b[at]);;
    -a from_fn(|at| -a[at])
}

impl Lanes for Vector {
    type Mask = [bool; N];
    consecutive!();
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
    lanewise! {
        mul_add(a, b, c) from_fn(|at| a[at].mul_add(b[at], c[at]));
        neg_mul_add(a, b, c) from_fn(|at| (-a[at]).mul_add(b[at], c[at]));
        mul_sub(a, b, c) from_fn(|at| a[at].mul_add(b[at], -c[at]));
        sqrt(a) a.map(f64::sqrt);
        max(a, b) from_fn(|at| if a[at] > b[at] { a[at] } else { b[at] });
        abs(a) a.map(f64::abs);
        shift_in(a, previous) from_fn(|at| if at == 0 { previous[N - 1] } else { a[at - 1] });
        shift_out(a, next) from_fn(|at| if at == N - 1 { next[0] } else { a[at + 1] });;
        lt(a, b) from_fn(|at| a[at] < b[at]);
        le(a, b) from_fn(|at| a[at] <= b[at]);
    }
    #[inline(always)]
    fn select(self, mask: [bool; N], other: Self) -> Self {
        Self(from_fn(|at| if mask[at] { self.0[at] } else { other.0[at] }))
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
