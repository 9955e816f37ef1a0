//! The peak arithmetic performance of the machine, in multiply-adds.

use crate::lanes::{Lanes, Set, WIDEST, Work};
use std::sync::atomic::Ordering;

/// The number of doubles in the widest vectors of this processor that [`limit_lanes`] allows.
pub fn lanes() -> usize {
    Set::best().lanes()
}

/// Limits the width of vectors, in doubles, of simulations made from now on and of [`multiply_adds`], so that
/// benchmarks can compare widths. The bits of states do not depend on it.
pub fn limit_lanes(most: usize) {
    WIDEST.store(most, Ordering::Relaxed);
}

/// Multiplies and adds in all lanes of the widest vectors of this processor, in twelve independent chains, and returns
/// the number of multiply-adds of single lanes. A step of the shape model on a lattice needs at least 320 of them for
/// each box: 155 to gather, scatter, damp and move, 165 for one pass of the rotation.
pub fn multiply_adds(rounds: u64) -> u64 {
    Set::best().run(Chains { rounds })
}

struct Chains {
    rounds: u64,
}

impl Work for Chains {
    type Output = u64;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u64 {
        const CHAINS: usize = 12;
        let (factor, summand) = (L::splat(std::hint::black_box(0.999_999)), L::splat(std::hint::black_box(1e-9)));
        let mut chains = [L::splat(1.0); CHAINS];
        for _ in 0..self.rounds {
            for chain in &mut chains {
                *chain = chain.mul_add(factor, summand);
            }
        }
        std::hint::black_box(chains.map(Lanes::to_array));
        self.rounds * (CHAINS * L::WIDTH) as u64
    }
}
