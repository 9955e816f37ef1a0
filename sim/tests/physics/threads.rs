//! The same bits for any number of threads.

use super::support::{Noise, floor, lattice, mass_spring, shape_based};
use glam::DVec3;
use localshape_sim::model::ElasticModel;
use localshape_sim::model::shape_based::{DampingReading, RotationReading, ShapeBased};
use localshape_sim::{
    Body, Crew, Grip, Integrator, Kernel, Motion, Obstacle, Offset, Shape, Springs, State, Stepping, Surroundings,
    World,
};
use std::sync::Arc;

#[test]
fn states_have_the_same_bits_for_1_2_and_8_threads() {
    // Large enough that forces, springs and nodes are all divided into several blocks.
    let body = lattice(12, 0.1);
    let mut noise = Noise(2);
    let position: Vec<_> = body.rest().iter().map(|&rest| rest + noise.vector() * 0.01).collect();
    let velocity = vec![DVec3::new(0.3, -5.0, 0.1); body.len()];
    let start = State::new(position, velocity);
    let amplitude = Offset { shift: DVec3::new(0.1, 0.2, 0.0), rotation: DVec3::Z * 0.3 };
    let swinging = Obstacle {
        shape: Shape::Sphere { centre: DVec3::new(0.6, -0.2, 0.6), radius: 0.4 },
        pivot: DVec3::new(0.6, 1.0, 0.6),
        motion: Motion::Swing { period: 0.05, phase: 0.0, amplitude },
        restitution: 0.3,
        friction: 0.5,
        friction_of: Default::default(),
    };
    let around = Surroundings {
        gravity: DVec3::new(0.0, -9.8, 0.0),
        obstacles: vec![floor(0.5, 0.3), swinging],
        grips: vec![Grip { nodes: vec![2000, 2100], from: 0.001, until: 0.01, motion: Motion::Still }],
        ..Surroundings::default()
    };
    let shape = shape_based(1e4, 20.0);
    let length = ShapeBased { rotation: RotationReading::VectorLength, ..shape.clone() };
    let linear = ShapeBased {
        rotation: RotationReading::LinearUpdate,
        damping_of: DampingReading::Deformation,
        ..shape.clone()
    };
    let spring = mass_spring(&body, 1e4, 20.0, Springs::EdgesOneDiagonal);
    let exact = ShapeBased { rotation: RotationReading::Robust, ..shape.clone() };
    let undamped = ShapeBased { damping: 0.0, ..exact.clone() };
    for (model, integrator, kernel) in [
        (&shape as &dyn ElasticModel, Integrator::SemiImplicitEuler, Kernel::Fast),
        (&exact, Integrator::SemiImplicitEuler, Kernel::Fast),
        (&exact, Integrator::ExplicitEuler, Kernel::Fast),
        (&exact, Integrator::VelocityVerlet, Kernel::Fast),
        (&undamped, Integrator::VelocityVerlet, Kernel::Fast),
        (&undamped, Integrator::Pefrl, Kernel::Fast),
        (&exact, Integrator::RungeKutta, Kernel::Reference),
        (&undamped, Integrator::Pefrl, Kernel::Reference),
        (&spring, Integrator::SemiImplicitEuler, Kernel::Fast),
        (&shape, Integrator::SemiImplicitEuler, Kernel::Reference),
        (&spring, Integrator::SemiImplicitEuler, Kernel::Reference),
        (&length, Integrator::VelocityVerlet, Kernel::Reference),
        (&linear, Integrator::ExplicitEuler, Kernel::Reference),
        (&exact, Integrator::DormandPrince, Kernel::Reference),
        (&exact, Integrator::BackwardEuler, Kernel::Reference),
    ] {
        let ends = [1, 2, 8].map(|threads| {
            let stepping = Stepping { kernel, ..Stepping::new(integrator, 1e-3) };
            let mut world = World::new(&body, start.clone(), model, around.clone(), stepping);
            world.set_crew(Crew::new(threads));
            world.advance(match integrator {
                // Hundreds of steps of its own in each.
                Integrator::DormandPrince => 2,
                _ => 15,
            });
            world.state().clone()
        });
        assert!(ends[0] == ends[1] && ends[0] == ends[2], "{model:?} {kernel:?}");
        assert!(ends[0] != start);
    }
}

/// A gentle motion needs no global solver; mirrored elements do, and all codes count the same ones.
#[test]
fn rotations_that_need_the_global_solver_are_counted_by_every_code_alike() {
    /// Of a mirrored cube all rotations about many axes are nearly as good as the best one.
    const MIRRORED: f64 = -0.999_999;
    let whole = lattice(6, 0.1);
    // The general code for the second body, which lacks one corner of a cube.
    let short = whole.elements().iter().enumerate().map(|(at, nodes)| &nodes[usize::from(at == 7)..]).collect();
    let (rest, mass) = (whole.rest().to_vec(), whole.mass().to_vec());
    let short = Arc::new(Body::builder(rest).elements(short).masses(mass).build().expect("a body"));
    for (body, crush, rotation) in [
        (&whole, 0.9, RotationReading::Robust),
        (&whole, 0.9, RotationReading::Arctangent),
        (&whole, MIRRORED, RotationReading::Robust),
        (&whole, MIRRORED, RotationReading::Arctangent),
        (&short, 0.9, RotationReading::Robust),
        (&short, MIRRORED, RotationReading::Robust),
        (&short, MIRRORED, RotationReading::Arctangent),
    ] {
        let position = body.rest().iter().map(|rest| *rest * DVec3::new(1.0, 1.0, crush));
        let start = State::at_rest(position.collect());
        let model = ShapeBased { rotation, ..shape_based(1e4, 20.0) };
        let count = |kernel: Kernel, threads: usize, calls: u64| {
            let stepping = Stepping { kernel, ..Stepping::new(Integrator::VelocityVerlet, 1e-4) };
            let mut world = World::new(body, start.clone(), &model, Surroundings::default(), stepping);
            world.set_crew(Crew::new(threads));
            (0..calls).for_each(|_| world.advance(12 / calls));
            world.diagnostics().global_rotations
        };
        let found = count(Kernel::Fast, 1, 1);
        for (kernel, threads, calls) in [(Kernel::Fast, 2, 1), (Kernel::Fast, 1, 4), (Kernel::Reference, 1, 3)] {
            assert_eq!(count(kernel, threads, calls), found, "{crush} {rotation:?} {kernel:?} {threads} {calls}");
        }
        assert_eq!(found > 0.0, crush < 0.0, "{rotation:?}: {found}");
    }
}
