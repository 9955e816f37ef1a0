//! Filled surfaces in motion: cubes that are hardly filled do not shorten the step, and a bar hangs as its material lets it.

use crate::common::{ball, ring};
use glam::DVec3;
use localshape_mesh::{Cage, Fill, Filled, Surface, fill};
use localshape_sim::geometry::volumes_at_rest;
use localshape_sim::model::ModelParameters;
use localshape_sim::model::shape_based::{Parameters, ShapeBased};
use localshape_sim::stability::{Restraint, Stability};
use localshape_sim::{
    Body, Carried, Crew, Grip, Integrator, Motion, Obstacle, Shape, Solids, State, Status, Stepping, Surroundings,
    World, equilibrium,
};
use std::sync::Arc;

/// Density (kg/m³).
const DENSITY: f64 = 1000.0;

/// A surface filled with cubes of a side (m).
fn body(surface: &Surface, side: f64) -> Arc<Body> {
    filled(surface, Fill::Cubes { side })
}

/// A filled surface, with masses in proportion to what is filled.
fn filled(surface: &Surface, with: Fill) -> Arc<Body> {
    let Filled { cage: Cage { nodes, elements, filled, convex, .. }, surface, weights, .. } =
        fill(surface, with, 100_000).expect("it has an inside");
    let count = nodes.len();
    let solids = if convex { Solids::Convex } else { Solids::Ordered };
    let Surface { points: rest, triangles, .. } = surface;
    let carried = Arc::new(Carried { rest, triangles, weights });
    let body = Body::builder(nodes).elements(elements).solids(solids).fill(filled).carried(carried).build();
    let body = body.expect("a cage has sound elements");
    let mut masses = vec![0.0; count];
    for (element, volume) in volumes_at_rest(&body).into_iter().enumerate() {
        let part = body.fill().map_or(1.0, |fill| fill[element]);
        let nodes = &body.elements()[element];
        nodes.iter().for_each(|&node| masses[node as usize] += DENSITY * part * volume / nodes.len() as f64);
    }
    let body = body.with_masses(masses).expect("masses above 0");
    Arc::new(body)
}

/// One full cube.
fn cube(side: f64) -> Arc<Body> {
    body(&crate::common::block(DVec3::ZERO, DVec3::splat(side)), side)
}

/// The volume in the carried surface (m³), with the nodes at positions (m).
fn volume(body: &Body, nodes: &[DVec3]) -> f64 {
    let carried = body.carried().expect("a surface");
    let points = carried.positions(nodes);
    let of = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|point| points[point as usize] - points[0]);
        a.dot(b.cross(c)) / 6.0
    };
    carried.triangles.iter().map(of).sum()
}

/// The mean sinking of a bar of height 1 (m) that hangs from its top at rest, relative to that of its material: ρgL²/3E.
fn sinking(bar: &Surface, with: Fill) -> f64 {
    let (young, gravity) = (1e5, 0.05);
    let body = filled(bar, with);
    let model = ModelParameters::ShapeBased(Parameters::of_material(young)).resolve(&body, None).expect("a material");
    let top = body.rest().iter().fold(f64::NEG_INFINITY, |top: f64, rest| top.max(rest.y));
    let nodes = (0u32..).zip(body.rest()).filter(|(_, rest)| rest.y > top - 1e-9).map(|(node, _)| node).collect();
    let grips = vec![Grip { nodes, from: 0.0, until: f64::INFINITY, motion: Motion::Still }];
    let around = Surroundings { gravity: -DVec3::Y * gravity, grips, ..Surroundings::default() };
    let start = State::at_rest(body.rest().to_vec());
    let found =
        equilibrium(&[(Arc::clone(&body), &*model)], &start, &around, 1e-3, Crew::new(1)).expect("a state of rest");
    let sunk = body.rest().iter().zip(&found.position).zip(body.mass());
    let sunk: f64 = sunk.map(|((rest, now), mass)| mass * (rest.y - now.y)).sum();
    sunk / body.mass().iter().sum::<f64>() / (DENSITY * gravity / (3.0 * young))
}

#[test]
fn a_hanging_bar_sinks_as_far_as_its_material_lets_it() {
    let bar = |wide: f64| {
        crate::common::block(DVec3::new(-0.5 * wide, 0.0, -0.5 * wide), DVec3::new(0.5 * wide, 1.0, 0.5 * wide))
    };
    for cells in [9.0, 10.0, 15.0, 20.0] {
        let side = 1.0 / cells;
        let cubes = [Fill::Cubes { side }, Fill::Graded { side }].map(|with| (with, 0.03));
        // The lattice of elements that end at the surface has planes at the sides of the bar. Its cells are no cubes, and stiffer along the
        // longer axis.
        let at_surface = [Fill::Tetrahedra { side }, Fill::Polyhedra { side }].map(|with| (with, 0.06));
        for wide in [0.25, 0.26, 0.55] {
            for (with, bound) in cubes.into_iter().chain(at_surface) {
                let ratio = sinking(&bar(wide), with);
                assert!((ratio - 1.0).abs() < bound, "{wide} m, {with:?}: {ratio}");
            }
        }
        for (wide, (with, _)) in [4.0, 5.0].into_iter().flat_map(|wide| at_surface.map(|with| (wide * side, with))) {
            let ratio = sinking(&bar(wide), with);
            assert!((ratio - 1.0).abs() < 0.03, "{wide} m, {with:?}: {ratio}");
        }
    }
}

#[test]
fn bodies_of_cubes_have_the_step_of_one_full_cube() {
    let side = 0.2;
    let one = cube(side);
    assert_eq!(one.fill(), None);
    for (name, surface) in [("ball", ball(DVec3::new(0.03, 0.01, 1.02), 1.0, 40)), ("ring", ring(1.0, 0.35, 40))] {
        let body = body(&surface, side);
        let fill = body.fill().expect("cubes at the surface");
        let least = fill.iter().copied().fold(1.0, f64::min);
        assert!(least < 0.01, "{name}: {least}");
        assert!((body.lightest() / one.lightest() - 1.0).abs() < 1e-9, "{name}: {}", body.lightest());
        let ratio = 0.1;
        let stiffness = 1e5;
        let damping = 2.0 * ratio * (stiffness * body.lightest()).sqrt();
        let model = ShapeBased { damping, ..ShapeBased::new(stiffness) };
        let integrator = Integrator::SemiImplicitEuler;
        let limit = |body| Stability::of(body, &model, integrator, Restraint::default()).largest;
        assert!(limit(&body) > 0.999 * limit(&one), "{name}: {} {}", limit(&body), limit(&one));
        // It falls onto a floor with nearly the largest step.
        let step = 0.9 * limit(&one);
        let low = body.rest().iter().fold(f64::INFINITY, |low: f64, rest| low.min(rest.z));
        let floor = Obstacle {
            shape: Shape::Floor { normal: DVec3::Z, height: low - 0.05 },
            motion: Motion::Still,
            pivot: DVec3::ZERO,
            restitution: 0.3,
            friction: 0.3,
            friction_of: Default::default(),
        };
        let gravity = DVec3::Z * -9.8;
        let around = Surroundings { gravity, obstacles: vec![floor], ..Surroundings::default() };
        let start = State::at_rest(body.rest().to_vec());
        let mut world = World::new(&body, start, &model, around, Stepping::new(integrator, step));
        let before = world.diagnostics();
        // Of 1 m of height (J).
        let weight = 9.8 * body.mass().iter().sum::<f64>();
        for _ in 0..20 {
            world.advance((0.1 / step) as u64);
            let now = world.diagnostics();
            assert!(world.status() == Status::Ok, "{name}: {:?}", world.status());
            // Rebounds at large steps add some.
            assert!(now.energy < before.energy + 0.1 * weight, "{name}: {} {weight}", now.energy - before.energy);
            // What is filled of the cubes has nearly the volume in the surface.
            let ratio = volume(&body, &world.state().position) / volume(&body, body.rest());
            assert!((ratio - now.volume_ratio).abs() < 0.02 && ratio > 0.7, "{name}: {ratio} {}", now.volume_ratio);
        }
        let end = world.diagnostics();
        assert!(end.kinetic < 0.01 * weight, "{name} comes to rest: {} {weight}", end.kinetic);
    }
}
