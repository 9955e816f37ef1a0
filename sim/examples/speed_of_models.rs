//! The cost of a step with each model, beside the paper's: `cargo run --release -p localshape-sim --example speed_of_models`.
//!
//! All are measured in turn, on one thread, and the best of many samples counts. Where nodes are moved from the lattice, the paper's model has
//! its general kernel.
use glam::DVec3;
use localshape_sim::model::{ElasticModel, ModelParameters};
use localshape_sim::{Body, Crew, IndexLists, Integrator, State, Stepping, Surroundings, World};
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Instant;

const CELLS: u32 = 20;
const SIDE: f64 = 0.05;
const SAMPLES: usize = 12;
const STEPS: u64 = 40;

/// A block of cubes, or of five tetrahedra for each, with its nodes moved by up to a share of the side.
fn block(tetrahedra: bool, irregular: f64) -> Arc<Body> {
    let n = CELLS + 1;
    let mut seed = 1_u64;
    let mut noise = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let grid = |n: u32| (0..n).flat_map(move |z| (0..n).flat_map(move |y| (0..n).map(move |x| [x, y, z])));
    let rest: Vec<_> = grid(n)
        .map(|at| (DVec3::from_array(at.map(f64::from)) + DVec3::new(noise(), noise(), noise()) * irregular) * SIDE)
        .collect();
    let mut elements = IndexLists::default();
    for [x, y, z] in grid(CELLS) {
        let corner = |bit: u32| x + (bit & 1) + n * (y + (bit >> 1 & 1) + n * (z + (bit >> 2)));
        if !tetrahedra {
            elements.push(&[0, 1, 2, 3, 4, 5, 6, 7].map(corner));
            continue;
        }
        let flip = if (x + y + z) % 2 == 0 { 0 } else { 7 };
        for own in [[0, 1, 2, 4], [3, 2, 1, 7], [5, 1, 4, 7], [6, 4, 2, 7], [1, 2, 4, 7]] {
            let mut own = own.map(|bit: u32| corner(bit ^ flip));
            let [a, b, c, d] = own.map(|node| rest[node as usize]);
            if (b - a).cross(c - a).dot(d - a) < 0.0 {
                own.swap(0, 1);
            }
            elements.push(&own);
        }
    }
    let mass = vec![1e-3; rest.len()];
    Arc::new(Body::builder(rest).elements(elements).masses(mass).build().expect("a body"))
}

fn world(body: &Arc<Body>, model: &dyn ElasticModel) -> World {
    let spin = DVec3::new(1.0, 2.0, -0.5);
    let velocity = body.rest().iter().map(|&rest| spin.cross(rest) + DVec3::X * (0.2 * rest.y)).collect();
    let start = State::new(body.rest().to_vec(), velocity);
    let stepping = Stepping::new(Integrator::SemiImplicitEuler, 1e-4);
    let mut world = World::new(body, start, model, Surroundings::default(), stepping);
    world.set_crew(Crew::new(1));
    world
}

/// The models, each of one stiffness. Not all take tetrahedra.
fn models() -> Vec<Value> {
    let of_springs = |kind: &str| json!({ "kind": kind, "stiffness": 250.0, "springs": "edges+one-diagonal" });
    let of_material = |kind: &str| json!({ "kind": kind, "young": 1e4, "poisson": 0.3 });
    vec![
        json!({ "kind": "shape-based", "young": 1e4 }),
        of_material("shape-based"),
        json!({ "kind": "shape-based", "young": 1e4, "damping": 1e-3, "damping_of": "deformation" }),
        of_springs("mass-spring"),
        json!({ "kind": "limited-springs", "stiffness": 250.0, "limit": 0.5, "springs": "edges+one-diagonal" }),
        json!({ "kind": "volume-springs", "stiffness": 250.0, "bulk": 1e4, "springs": "edges+one-diagonal" }),
        of_material("metric"),
        of_material("linear"),
        of_material("corotational"),
        of_material("neo-hookean"),
        json!({ "kind": "corotational", "young": 1e4, "poisson": 0.3, "damping": 1e-3 }),
        of_material("xpbd"),
    ]
}

fn main() {
    for (tetrahedra, irregular) in [(false, 0.0), (false, 0.05), (true, 0.0)] {
        let body = block(tetrahedra, irregular);
        let case = |model: Value| {
            let parameters: ModelParameters = serde_json::from_value(model.clone()).expect("parameters of a model");
            let resolved = parameters.resolve(&body, None).ok()?;
            Some((model.to_string(), world(&body, &*resolved), f64::INFINITY))
        };
        let mut cases: Vec<(String, World, f64)> = models().into_iter().filter_map(case).collect();
        for _ in 0..SAMPLES {
            for (_, world, best) in &mut cases {
                let start = Instant::now();
                world.advance(STEPS);
                let each = start.elapsed().as_secs_f64() * 1e9 / (STEPS as f64 * body.elements().len() as f64);
                *best = best.min(each);
            }
        }
        let kind = if tetrahedra { "tetrahedra" } else { "hexahedra" };
        println!("{} {kind}, irregular {irregular}", body.elements().len());
        for (name, world, best) in &cases {
            let status = world.status();
            println!("  {best:7.1} ns per element and step, {:5.2}: {status:?} {name}", best / cases[0].2);
        }
    }
}
