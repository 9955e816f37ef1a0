//! The model the paper improves on: springs between pairs of nodes (section 2, Eq. (1)).
//!
//! Force on node `i` from the spring to `j`: `−{k (1 − L/|p|) + D (v·p)/(p·p)} p`, with `p` and `v` the position and
//! velocity of `i` relative to `j` and `L` the natural length.
//!
//! Energy: `E = k/2 Σ (|p| − L)²`. A mirror image has the same energy, which is why a turned-over element stays so.

use super::{ElasticModel, ForceModel, Known, Misfit, Needs, Report, Scratch, Share, TypedModel, blocks};
use crate::sim::body::{Body, Dimension, ElementKind};
use crate::sim::census::Census;
use crate::sim::state::Nodes;
use crate::sim::topology::Springs;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What a scene types for this model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("not" = { "required": ["damping", "damping_ratio"] }))]
pub struct Parameters {
    /// Elastic constant of each spring, `k_ij` of Eq. (1) (N/m).
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub stiffness: f64,
    /// Damping constant of each spring, `D_ij` of Eq. (1) (N s/m). Default: 0. Not together with `damping_ratio`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub damping: Option<f64>,
    /// Damping as a ratio `ζ = D / 2√(km)`, with `m` the mass of the lightest node, as in `step = "T/50"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub damping_ratio: Option<f64>,
    /// Where the springs are. Default: those that the body lists, else `edges+face-diagonals`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub springs: Option<Springs>,
}

/// The model with its parameters resolved.
#[derive(Clone, Debug, PartialEq)]
pub struct MassSpring {
    /// Elastic constant `k_ij` of each spring (N/m).
    pub stiffness: f64,
    /// Damping constant `D_ij` of each spring (N s/m).
    pub damping: f64,
    /// The two nodes of each spring; the natural length is their distance at rest.
    pub springs: Vec<[u32; 2]>,
}

impl Parameters {
    /// With an elastic constant (N/m), and all else as it is by default.
    pub fn new(stiffness: f64) -> Self {
        Self { stiffness, damping: None, damping_ratio: None, springs: None }
    }
}

impl TypedModel for Parameters {
    fn resolve(&self, body: &Body, listed: Option<&[[u32; 2]]>) -> Result<Arc<dyn ElasticModel>, Misfit> {
        let mut springs = match (self.springs, listed) {
            (None, Some(listed)) => listed.to_vec(),
            (named, _) => body.topology().springs(named.unwrap_or(DEFAULT)),
        };
        // The doubles that were taken out are several times as many.
        springs.shrink_to_fit();
        if springs.is_empty() {
            let topology = self.springs.unwrap_or(DEFAULT).name();
            let message = format!(
                "the topology `{topology}` puts no spring on the body's elements; take `all`, or list the springs in [body]"
            );
            return Err(Misfit { key: "springs", message });
        }
        let damping = super::damping(self.damping, self.damping_ratio, self.stiffness, body)?;
        Ok(Arc::new(MassSpring { stiffness: self.stiffness, damping, springs }))
    }

    fn needs(&self, census: &Census) -> Needs {
        /// A pair of nodes in a list that grows by doubling (bytes).
        const PAIR: u128 = 16;
        /// Its nodes twice, its natural length, its force, its two entries in the sums, and their sorting (bytes).
        /// A block of 64³ cubes with both models took 1978 bytes a cube; the whole estimate says 2060.
        const SPRING: u128 = 75;
        let (written, springs) = match (self.springs, census.springs) {
            (None, Some(listed)) => (listed, listed),
            (named, _) => springs_at_most(named.unwrap_or(DEFAULT), census),
        };
        Needs { springs, making: written.saturating_mul(PAIR), working: springs.saturating_mul(SPRING) }
    }
}

/// The springs of bodies that list none.
const DEFAULT: Springs = Springs::EdgesFaceDiagonals;

/// How many pairs are written down for a named topology, and how many springs these can be at most once each is kept
/// only once.
fn springs_at_most(topology: Springs, census: &Census) -> (u128, u128) {
    let all = |nodes: usize| (nodes as u128) * (nodes as u128).saturating_sub(1) / 2;
    let pairs = |kind, nodes: usize| {
        // On the edges, one for each face with a diagonal, and all pairs of each face.
        let (edges, one_diagonal, in_faces) = match kind {
            ElementKind::Segment => (1, 0, 0),
            ElementKind::Polygon => (nodes as u128, (nodes as u128).saturating_sub(3), all(nodes)),
            ElementKind::Triangle => (3, 0, 3),
            ElementKind::Tetrahedron => (6, 0, 12),
            ElementKind::Pyramid => (8, 1, 18),
            ElementKind::Wedge => (9, 3, 24),
            ElementKind::Hexahedron => (12, 6, 36),
            // A convex solid has at most 3n − 6 edges and 2n − 8 diagonals in fans over its faces; its edges are in
            // two faces, any other pair in one at most.
            ElementKind::Other => {
                let edges = (3 * nodes as u128).saturating_sub(6);
                (edges, (2 * nodes as u128).saturating_sub(8), all(nodes).saturating_add(edges))
            }
        };
        match topology {
            Springs::Edges => edges,
            Springs::EdgesOneDiagonal => edges + one_diagonal,
            Springs::EdgesFaceDiagonals => edges + in_faces,
            Springs::EdgesBodyDiagonals => edges + all(nodes),
            Springs::All => all(nodes),
        }
    };
    let written = census.sum(pairs);
    let mut kept = census.sum(|kind, nodes| pairs(kind, nodes).min(all(nodes)));
    if census.lattice {
        // Half of a node's neighbours along edges, across faces and through cells: each spring has two nodes.
        let (edges, faces, cells) = match census.dimension {
            Dimension::Plane => (2, 2, 0),
            Dimension::Space => (3, 6, 4),
        };
        let to_each_node = match topology {
            Springs::Edges => edges,
            Springs::EdgesOneDiagonal | Springs::EdgesFaceDiagonals => edges + faces,
            Springs::EdgesBodyDiagonals => edges + cells,
            Springs::All => edges + faces + cells,
        };
        kept = kept.min(census.nodes.saturating_mul(to_each_node));
    }
    (written, kept)
}

impl ElasticModel for MassSpring {
    fn stiffness(&self) -> f64 {
        self.stiffness
    }

    fn describe(&self, body: &Body) -> String {
        let count = self.springs.len();
        let springs = format!("{count} spring{}", if count == 1 { "" } else { "s" });
        super::describe(&springs, self.stiffness, self.damping, body)
    }

    fn springs(&self) -> &[[u32; 2]] {
        &self.springs
    }

    fn known(&self) -> Option<Known<'_>> {
        Some(Known::MassSpring(self))
    }

    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel> {
        let length = |&[i, j]: &[u32; 2]| (body.rest[i as usize] - body.rest[j as usize]).length();
        Box::new(Lattice {
            natural_length: self.springs.iter().map(length).collect(),
            gather: blocks::SignedGather::new(body.len(), &self.springs),
            model: self.clone(),
        })
    }
}

/// A body's springs.
struct Lattice {
    model: MassSpring,
    /// `L_ij` of each spring (m).
    natural_length: Vec<f64>,
    /// Of the force of each spring on its first node, of which its second gets the opposite, the sums for each node.
    gather: blocks::SignedGather,
}

impl ForceModel for Lattice {
    fn add_forces(
        &self,
        at: Nodes<'_>,
        _memory: &[f64],
        _next: &mut [f64],
        scratch: &mut Scratch,
        forces: &mut [DVec3],
    ) {
        let Self { model, natural_length, gather } = self;
        let spring_forces = scratch.vectors(natural_length.len());
        blocks::for_each_one(spring_forces, &|spring, out| {
            let [i, j] = model.springs[spring].map(|node| node as usize);
            *out = spring_force(
                at.position[i] - at.position[j],
                at.velocity[i] - at.velocity[j],
                natural_length[spring],
                model.stiffness,
                model.damping,
            );
        });
        gather.add(spring_forces, forces);
    }

    fn is_damped(&self) -> bool {
        self.model.damping > 0.0
    }

    fn report(&self, at: Nodes<'_>, _memory: &[f64], share: &mut Share<'_>) -> Report {
        let mut whole = 0.0;
        for (spring, (ends, &natural)) in self.model.springs.iter().zip(&self.natural_length).enumerate() {
            let [i, j] = ends.map(|node| at.position[node as usize]);
            let stretch = (i - j).length() - natural;
            let energy = 0.5 * self.model.stiffness * stretch * stretch;
            share(spring, ends, &[0.5 * energy; 2]);
            whole += energy;
        }
        Report { energy: Some(whole), residuals: Vec::new() }
    }
}

/// Eq. (1), one spring: the force on node `i` (N) from its position `p` (m) and velocity `v` (m/s) relative to `j`,
/// the natural length `l` (m), `k` (N/m) and `d` (N s/m).
///
/// The formula is singular for coincident nodes, where a spring has no direction: there the force is zero.
#[doc(alias = "Eq. 1")]
fn spring_force(p: DVec3, v: DVec3, l: f64, k: f64, d: f64) -> DVec3 {
    let squared = p.dot(p);
    if squared == 0.0 {
        return DVec3::ZERO;
    }
    p * -(k * (1.0 - l / squared.sqrt()) + d * v.dot(p) / squared)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::body::IndexLists;
    use crate::sim::body::Solids;
    use crate::sim::hull::Hulls;
    use crate::sim::topology::{self, Elements};
    use std::collections::BTreeMap;

    const NAMED: [Springs; 5] = [
        Springs::Edges,
        Springs::EdgesOneDiagonal,
        Springs::EdgesFaceDiagonals,
        Springs::EdgesBodyDiagonals,
        Springs::All,
    ];

    #[test]
    fn no_element_has_more_springs_than_are_counted_before() {
        let cases = [
            (Dimension::Plane, Solids::Ordered),
            (Dimension::Space, Solids::Ordered),
            (Dimension::Space, Solids::Convex),
        ];
        for (nodes, (dimension, solids)) in (2..12).flat_map(|nodes| cases.map(|case| (nodes, case))) {
            let own: Vec<u32> = (0..nodes as u32).collect();
            let elements: IndexLists = [own.as_slice()].into_iter().collect();
            let kinds = [topology::kind(dimension, solids, nodes)];
            let census = Census {
                dimension,
                nodes: nodes as u128,
                solids,
                elements: BTreeMap::from([(nodes, 1)]),
                lattice: false,
                springs: None,
            };
            // A solid with triangles only, a prism, a flat polygon, and what has no faces at all.
            let corner = |shape: usize, at: usize| {
                let (half, at) = (nodes / 2, at as f64);
                match shape {
                    0 => DVec3::new(at, at * at, at * at * at),
                    1 => DVec3::new(
                        (at as usize % half) as f64,
                        ((at as usize % half) as f64).powi(2),
                        (at as usize / half) as f64,
                    ),
                    2 => DVec3::new(at, at * at, 0.0),
                    _ => DVec3::new(at, 0.0, 0.0),
                }
            };
            for shape in 0..4 {
                let rest: Vec<_> = (0..nodes).map(|at| corner(shape, at)).collect();
                let hulls = Hulls::new(&elements, &kinds, &rest);
                for named in NAMED {
                    let (written, kept) = springs_at_most(named, &census);
                    let made = Elements { nodes: &elements, kinds: &kinds, hulls: &hulls, rest: &rest }
                        .springs(named)
                        .len() as u128;
                    assert!(made <= kept && kept <= written, "{named:?} of {nodes}: {made}, {kept}, {written}");
                }
            }
        }
    }

    #[test]
    fn a_block_has_about_as_many_springs_as_are_counted_before() {
        let cells = 6;
        let at = |x: u32, y: u32, z: u32| x + (cells + 1) * (y + (cells + 1) * z);
        let mut elements = IndexLists::default();
        for (x, y, z) in (0..cells).flat_map(|z| (0..cells).flat_map(move |y| (0..cells).map(move |x| (x, y, z)))) {
            elements.push(&[0, 1, 2, 3, 4, 5, 6, 7].map(|bit| at(x + (bit & 1), y + (bit >> 1 & 1), z + (bit >> 2))));
        }
        let count = elements.len();
        let census = Census {
            dimension: Dimension::Space,
            nodes: 343,
            solids: Solids::Ordered,
            elements: BTreeMap::from([(8, count as u128)]),
            lattice: true,
            springs: None,
        };
        for named in NAMED {
            let (written, kept) = springs_at_most(named, &census);
            let kinds = vec![ElementKind::Hexahedron; count];
            let rest = vec![DVec3::ZERO; 343];
            let made = Elements { nodes: &elements, kinds: &kinds, hulls: &Hulls::default(), rest: &rest }
                .springs(named)
                .len() as u128;
            assert!(made <= kept && kept <= 2 * made && kept <= written, "{named:?}: {made}, {kept}, {written}");
        }
    }
}
