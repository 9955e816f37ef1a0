//! Symplectic integrators of high order that scenes do not offer. They require forces that depend on positions only.

use localshape::sim::integrate::Composition;

/// E. Forest, R. Ruth, Physica D 43, 105 (1990), with `θ = 1/(2 − ∛2)`.
pub(crate) const FOREST_RUTH: Composition =
    Composition { drifts: &[0.5 * THETA, 0.5 - 0.5 * THETA], kicks: &[THETA, 1.0 - 2.0 * THETA] };
const THETA: f64 = 1.351_207_191_959_657_8;

/// S. Blanes, P. Moan, Journal of Computational and Applied Mathematics 142, 313 (2002), table 3: SRKN14a, of order 6.
pub(crate) const BLANES_MOAN: Composition = Composition {
    drifts: &[
        0.037_859_319_840_611_6,
        0.102_635_633_102_435,
        -0.025_867_888_266_558_7,
        0.314_241_403_071_447,
        -0.130_144_459_517_415,
        0.106_417_700_369_543,
        -0.008_794_243_128_510_58,
        // The sum of all shares is 1.
        0.207_305_069_056_895_36,
    ],
    kicks: &[
        0.091_719_152_624_461_65,
        0.183_983_170_005_006,
        -0.056_534_365_832_888_27,
        0.004_914_688_774_712_854,
        0.143_761_127_168_358,
        0.328_567_693_746_804,
        -0.196_411_466_486_454_23,
    ],
};

/// W. Kahan, R.-C. Li, Mathematics of Computation 66, 1089 (1997), table 1: s17odr8a, of order 8, as a composition of steps
/// of drift, kick and drift.
pub(crate) const KAHAN_LI: Composition = Composition {
    drifts: &[
        0.5 * GAMMA[0],
        0.5 * (GAMMA[0] + GAMMA[1]),
        0.5 * (GAMMA[1] + GAMMA[2]),
        0.5 * (GAMMA[2] + GAMMA[3]),
        0.5 * (GAMMA[3] + GAMMA[4]),
        0.5 * (GAMMA[4] + GAMMA[5]),
        0.5 * (GAMMA[5] + GAMMA[6]),
        0.5 * (GAMMA[6] + GAMMA[7]),
        0.5 * (GAMMA[7] + GAMMA[8]),
    ],
    kicks: &GAMMA,
};
const GAMMA: [f64; 9] = [
    0.130_202_483_088_890_08,
    0.561_162_981_775_108_4,
    -0.389_474_962_644_847_3,
    0.158_841_906_555_155_6,
    -0.395_903_894_133_237_6,
    0.184_539_640_978_315_7,
    0.258_374_387_686_322_04,
    0.295_011_723_609_310_3,
    -0.605_508_533_830_034_5,
];

#[cfg(test)]
#[path = "../tests/inside/methods.rs"]
mod tests;
