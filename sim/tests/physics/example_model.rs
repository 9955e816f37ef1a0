use glam::DVec3;
use localshape_sim::model::{ElasticModel, ForceModel, Report, Scratch, Share};
use localshape_sim::{Body, Nodes, Springs};
use std::sync::Arc;

/// The model with its parameters.
#[derive(Clone, Debug)]
pub struct Rods {
    /// `k` (N/m).
    pub stiffness: f64,
}

impl ElasticModel for Rods {
    fn stiffness(&self) -> f64 {
        self.stiffness
    }

    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel> {
        let rods = body.topology().springs(Springs::All).into_iter();
        let squared = |[i, j]: [u32; 2]| body.rest[i as usize].distance_squared(body.rest[j as usize]);
        Box::new(RodForces { stiffness: self.stiffness, rods: rods.map(|rod| (rod, squared(rod))).collect() })
    }
}

struct RodForces {
    stiffness: f64,
    /// The ends of each rod, and its squared length at rest (m²).
    rods: Vec<([u32; 2], f64)>,
}

impl ForceModel for RodForces {
    fn add_forces(&self, at: Nodes<'_>, _: &[f64], _: &mut [f64], _: &mut Scratch, forces: &mut [DVec3]) {
        for &([i, j], squared) in &self.rods {
            let (i, j) = (i as usize, j as usize);
            let p = at.position[i] - at.position[j];
            let force = p * (-0.5 * self.stiffness * (p.length_squared() - squared) / squared);
            forces[i] += force;
            forces[j] -= force;
        }
    }

    fn is_damped(&self) -> bool {
        false
    }

    fn report(&self, at: Nodes<'_>, _: &[f64], share: &mut Share<'_>) -> Report {
        let mut whole = 0.0;
        for (rod, (ends, squared)) in self.rods.iter().enumerate() {
            let [i, j] = ends.map(|node| at.position[node as usize]);
            let excess = i.distance_squared(j) - squared;
            let energy = self.stiffness / (8.0 * squared) * excess * excess;
            share(rod, ends, &[0.5 * energy; 2]);
            whole += energy;
        }
        Report { energy: Some(whole), residuals: Vec::new() }
    }
}
