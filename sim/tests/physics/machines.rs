//! The same bits on every machine.

use super::INTEGRATORS;
use super::conformance::{bodies, cases};
use super::support::floor;
use glam::DVec3;
use localshape_sim::{Integrator, Kernel, State, Stepping, Surroundings, World};

/// Digests of the states after some steps of every model with elements of every kind: of each integrator, with its vectorised steps
/// if it has them, and with reference code. A change of the physics changes them on purpose; the failure tells the new ones.
const DIGESTS: [(Integrator, [u64; 2]); 7] = [
    (Integrator::SemiImplicitEuler, [0x8f6f_6e0f_5724_ee82, 0x57da_dd2d_97eb_33a0]),
    (Integrator::ExplicitEuler, [0xc6c0_7ef3_93c4_89e7, 0x161d_631d_7ec2_cb1f]),
    (Integrator::VelocityVerlet, [0xf711_53e0_af26_a690, 0xa2e8_13f0_3e79_504f]),
    (Integrator::Pefrl, [0x2405_a9c0_994d_6e9e, 0x1e0b_8edb_b6d7_c772]),
    (Integrator::RungeKutta, [0xb218_111f_fc66_85f2, 0xb218_111f_fc66_85f2]),
    (Integrator::DormandPrince, [0x0944_9cd3_4f4f_98f8, 0x0944_9cd3_4f4f_98f8]),
    (Integrator::BackwardEuler, [0xfe8d_df7f_1f45_db47, 0xfe8d_df7f_1f45_db47]),
];

/// The digest FNV-1a of more bytes.
fn digest(before: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(before, |digest, &byte| (digest ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn states_have_the_bits_of_every_machine() {
    let around = Surroundings { gravity: DVec3::Y * -9.8, obstacles: vec![floor(0.5, 0.3)], ..Surroundings::default() };
    let found = INTEGRATORS.map(|integrator| {
        let digests = [Kernel::Fast, Kernel::Reference].map(|kernel| {
            let mut found = 0xcbf2_9ce4_8422_2325;
            for body in &bodies() {
                for case in cases(body, if integrator == Integrator::Pefrl { 0.0 } else { 7.0 }) {
                    let start = State::new(body.rest().to_vec(), vec![DVec3::new(0.4, -3.0, 0.0); body.len()]);
                    let stepping = Stepping { kernel, ..Stepping::new(integrator, 1e-3) };
                    let mut world = World::new(body, start, case.model.as_ref(), around.clone(), stepping);
                    world.advance(5);
                    found = digest(found, &world.state().to_bytes());
                }
            }
            found
        });
        (integrator, digests)
    });
    assert_eq!(found, DIGESTS, "{found:#x?}");
}
