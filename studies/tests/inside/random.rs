//! Pseudo-random numbers.

use super::mix;

#[test]
fn it_is_split_mix_64() {
    // The first number of the published generator with the seed 0, and with 1234567.
    assert_eq!(mix(0), 0xe220_a839_7b1d_cdaf);
    assert_eq!(mix(1_234_567), 6_457_827_717_110_365_317);
}
