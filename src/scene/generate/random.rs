//! Pseudo-random numbers that are the same on every machine.
//!
//! Each number is a hash of its index and its use, so the order of drawing has no effect: SplitMix64 (G. Steele, D. Lea, C. Flood, "Fast
//! splittable pseudorandom number generators", OOPSLA 2014).

/// A number for an index and a use: the finaliser over both.
pub(super) fn hash(seed: u32, index: u64, usage: u64) -> u64 {
    [u64::from(seed), index, usage].into_iter().fold(0, |state, part| mix(state.wrapping_add(part)))
}

/// A number from 0 to below 1; see `hash`.
pub fn unit(seed: u32, index: u64, usage: u64) -> f64 {
    share(hash(seed, index, usage))
}

/// The number from 0 to below 1 at a place of the generator's sequence with the seed 0.
pub(crate) fn nth(place: u32) -> f64 {
    share(mix(u64::from(place).wrapping_mul(STEP)))
}

fn share(bits: u64) -> f64 {
    // A double holds the upper 53 bits.
    (bits >> 11) as f64 / (1u64 << 53) as f64
}

/// The difference of two states.
const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

/// One number of the generator from its state.
fn mix(state: u64) -> u64 {
    let z = state.wrapping_add(STEP);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_split_mix_64() {
        // The first number of the published generator with the seed 0, and with 1234567.
        assert_eq!(mix(0), 0xe220_a839_7b1d_cdaf);
        assert_eq!(mix(1_234_567), 6_457_827_717_110_365_317);
    }

    #[test]
    fn numbers_fill_their_range_and_do_not_depend_on_each_other() {
        let count = 30_000;
        for usage in 0..3 {
            let mean = |of: &dyn Fn(u64) -> f64| (0..count).map(of).sum::<f64>() / count as f64;
            assert!((mean(&|index| unit(1, index, usage)) - 0.5).abs() < 0.01);
            let product = mean(&|index| unit(1, index, usage) * unit(1, index + 1, usage));
            assert!((product - 0.25).abs() < 0.01);
            assert!((mean(&|index| unit(1, index, usage) * unit(2, index, usage)) - 0.25).abs() < 0.01);
            assert!((mean(&|index| unit(1, index, usage) * unit(1, index, usage + 1)) - 0.25).abs() < 0.01);
        }
    }
}
