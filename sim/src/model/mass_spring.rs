//! Springs between pairs of nodes, the model that the paper compares with (section 2, Eq. (1)).
//!
//! Force on node `i` from the spring to `j`: `−{k (1 − L/|p|) + D (v·p)/(p·p)} p`, with `p` and `v` the position and
//! velocity of `i` relative to `j` and `L` the natural length.
//!
//! Energy: `E = k/2 Σ (|p| − L)²`. A mirror image has the same energy, so an element that has turned over stays so.
//!
//! Springs can break ([`breaks_at`](MassSpring::breaks_at)), as in Ref. 2 of the paper (Norton and others 1991, "Animation of fracture by
//! physical modeling"), where "breakage is obtained in a three-dimensional flexible model as the limit of elastic behavior": a spring that is
//! stretched beyond a share of its natural length is taken out for good. They let whole cubes of springs break at once, so that no strings of springs
//! hang from the pieces (told by O'Brien and Hodgins 1999, "Graphical modeling and animation of brittle fracture"); here each spring breaks by itself, and
//! what breaks as a whole is an element of the shape model.

use super::{
    Breaking, ByLaw, Corners, ElasticModel, Element, ForceModel, Lanes, Late, Law, Properties, Report, Scratch,
    Setting, Share, Strained, Vectorised, blocks,
};
use crate::body::Body;
use crate::fill;
use crate::kernel::shapes::square;
use crate::kernel::springs::Stencil;
use crate::kernel::{Compiled, Conditions, Stepper};
use crate::lanes::each;
use crate::lists::IndexLists;
use crate::mode::Mode;
use crate::state::Nodes;
#[cfg(feature = "scene")]
use crate::topology::Springs;
use glam::DVec3;
#[cfg(feature = "scene")]
use std::collections::BTreeMap;
use std::sync::Arc;

/// What to write in place of a modulus. In uniform strain `W = k/2V Σ (L n·ε n)²` over springs with the directions `n`; the mean over all
/// rotations of the body has `λ = μ = k Σ L²/15V`, in the plane `k Σ L²/8A`.
#[cfg(feature = "scene")]
pub(super) const YOUNG: &str = "springs have a Poisson's ratio of their own, 1/4, in the plane 1/3; write `stiffness`: 6 E V/Σ L² with the volume \
                                V of the body and the lengths L of its springs, in the plane 3 E A/Σ L²; on cubes of side a about E a/2";

/// Defines the parameters of springs in a scene file, with those of one model.
#[cfg(feature = "scene")]
macro_rules! parameters {
    ($($(#[$attribute:meta])* $own:ident: $type:ty,)*) => {
        /// The parameters of the model in a scene file.
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
        #[serde(deny_unknown_fields)]
        #[schemars(extend("not" = { "required": ["damping", "damping_ratio"] }))]
        #[schemars(extend("x-instead" = { "young": crate::model::mass_spring::YOUNG }))]
        pub struct Parameters {
            /// Elastic constant of each spring at its natural length, `k_ij` of Eq. (1) (N/m). Springs take no `young`, because their Poisson's
            /// ratio is not free.
            #[schemars(extend("exclusiveMinimum" = 0))]
            pub stiffness: f64,
            $($(#[$attribute])* pub $own: $type,)*
            /// Damping constant of each spring, `D_ij` of Eq. (1) (N s/m). Default: 0. Not together with `damping_ratio`.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(range(min = 0.0))]
            pub damping: Option<f64>,
            /// Damping of each spring as a ratio `ζ = D / 2√(km)`, with its `stiffness` and `m` the mass of the lightest node, as in `step = "T/50"`.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schemars(range(min = 0.0))]
            pub damping_ratio: Option<f64>,
            /// The topology of the springs. Default: the springs that the body lists, else `edges+face-diagonals`.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            pub springs: Option<crate::topology::Springs>,
        }

        impl Parameters {
            /// What all models of springs have.
            fn of_springs(&self) -> crate::model::mass_spring::OfSprings {
                let &Self { stiffness, damping, damping_ratio, springs, .. } = self;
                crate::model::mass_spring::OfSprings { stiffness, damping, damping_ratio, springs }
            }
        }
    };
}
#[cfg(feature = "scene")]
pub(super) use parameters;

#[cfg(feature = "scene")]
parameters! {
    /// The elongation, as a share of the natural length, at which a spring breaks: it is taken out for good. Default: springs never break.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    breaks_at: Option<f64>,
}

/// The model with its parameters in SI units, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct MassSpring {
    /// Elastic constant `k_ij` of each spring (N/m).
    pub stiffness: f64,
    /// Damping constant `D_ij` of each spring (N s/m).
    pub damping: f64,
    /// The two nodes of each spring; the natural length is their distance at rest.
    pub springs: Arc<[[u32; 2]]>,
    /// The elongation, as a share of the natural length, at which a spring breaks; `None` if none does.
    pub breaks_at: Option<f64>,
}

#[cfg(feature = "scene")]
impl Parameters {
    /// A model with this elastic constant (N/m); the other parameters have their defaults.
    pub fn new(stiffness: f64) -> Self {
        Self { stiffness, damping: None, damping_ratio: None, springs: None, breaks_at: None }
    }
}

#[cfg(feature = "scene")]
impl super::TypedModel for Parameters {
    fn resolve(&self, body: &Body, listed: Option<&[[u32; 2]]>) -> Result<Arc<dyn ElasticModel>, super::Misfit> {
        let (springs, breaks_at) = (self.of_springs().model(body, listed)?, super::breaks_at(self.breaks_at)?);
        Ok(Arc::new(MassSpring { breaks_at, ..springs }))
    }

    fn most_springs(&self, elements: &BTreeMap<usize, u128>, listed: Option<u128>) -> u128 {
        self.of_springs().most(elements, listed)
    }
}

/// The springs of bodies that list none and of models that name none.
#[cfg(feature = "scene")]
const DEFAULT: Springs = Springs::EdgesFaceDiagonals;

/// The parameters that all models of springs have.
#[cfg(feature = "scene")]
pub(super) struct OfSprings {
    pub(super) stiffness: f64,
    pub(super) damping: Option<f64>,
    pub(super) damping_ratio: Option<f64>,
    pub(super) springs: Option<Springs>,
}

#[cfg(feature = "scene")]
impl OfSprings {
    /// The springs of a body that lists these, if it lists any.
    pub(super) fn model(&self, body: &Body, listed: Option<&[[u32; 2]]>) -> Result<MassSpring, super::Misfit> {
        let springs = match (self.springs, listed) {
            (None, Some(listed)) => listed.to_vec(),
            (named, _) => body.topology().springs(named.unwrap_or(DEFAULT)),
        };
        if springs.is_empty() {
            let topology = self.springs.unwrap_or(DEFAULT).name();
            let message = format!(
                "the topology `{topology}` puts no spring on the body's elements; take `all`, or list the springs in [body]"
            );
            return Err(super::Misfit { key: "springs", message });
        }
        let damping = super::damping(self.damping, self.damping_ratio, self.stiffness, body)?;
        Ok(MassSpring { stiffness: self.stiffness, damping, springs: springs.into(), breaks_at: None })
    }

    /// See [`ModelParameters::most_springs`](super::ModelParameters::most_springs).
    pub(super) fn most(&self, elements: &BTreeMap<usize, u128>, listed: Option<u128>) -> u128 {
        if let (None, Some(listed)) = (self.springs, listed) {
            return listed;
        }
        let on_one = |nodes: u128| {
            let pairs = nodes.saturating_mul(nodes.saturating_sub(1)) / 2;
            match self.springs.unwrap_or(DEFAULT) {
                // A convex solid has 3n − 6 edges at most.
                Springs::Edges => pairs.min(nodes.saturating_mul(3)),
                _ => pairs,
            }
        };
        let each = elements.iter().map(|(&nodes, &count)| on_one(nodes as u128).saturating_mul(count));
        each.fold(0, u128::saturating_add)
    }
}

impl ElasticModel for MassSpring {
    fn properties(&self, _: &Body) -> Properties {
        let own = self.of_springs("mass-spring");
        match self.breaks_at {
            Some(strain) => Properties { breakable: Some(1), ..own.with("breaks_at", Setting::Number(strain, "")) },
            None => own,
        }
    }

    fn springs(&self) -> &[[u32; 2]] {
        &self.springs
    }

    fn start(&self, _: &Body, _: &[DVec3]) -> Vec<f64> {
        vec![0.0; if self.breaks_at.is_some() { self.springs.len() } else { 0 }]
    }

    /// With displacements `u` the energy of a spring is at most `k/2 |uᵢ − uⱼ|²`, in which `|uᵢ − uⱼ|² ≤ (1/mᵢ + 1/mⱼ) (mᵢ |uᵢ|² +
    /// mⱼ |uⱼ|²)`.
    fn bound(&self, body: &Body) -> Option<Mode> {
        let mut sums = vec![0.0; body.len()];
        let parts = self.parts(body);
        for (spring, ends) in self.springs.iter().enumerate() {
            let [i, j] = ends.map(|node| node as usize);
            let part = parts.as_ref().map_or(1.0, |parts| parts[spring]);
            let sum = part * (1.0 / body.mass[i] + 1.0 / body.mass[j]);
            (sums[i], sums[j]) = (sums[i] + sum, sums[j] + sum);
        }
        let most = sums.into_iter().fold(0.0, f64::max);
        Some(Mode { stiffness: self.stiffness * most, damping: self.damping * most })
    }

    fn vectorised(&self) -> Option<&dyn Vectorised> {
        Some(self)
    }

    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel> {
        let (model, body) = (self.clone(), Arc::clone(body));
        match self.breaking() {
            Some(law) => Late::boxed(move || ByLaw::new(law, &body)),
            None => Late::boxed(move || SpringForces::new(model, &body)),
        }
    }
}

impl Vectorised for MassSpring {
    fn compile(&self, body: &Arc<Body>, conditions: &Conditions) -> Compiled {
        if let Some(law) = self.breaking() {
            return Compiled::once(law, body, conditions);
        }
        let stencil = Stencil::new(&self.springs, [self.stiffness, self.damping], body, conditions);
        self.by_law(body, conditions, stencil.map(|stencil| -> Box<dyn Stepper> { Box::new(stencil) }))
    }
}

impl MassSpring {
    /// The properties of a model that has these springs.
    pub(super) fn of_springs(&self, kind: &'static str) -> Properties {
        Properties::new(kind, self.stiffness).damped(self.damping)
    }

    /// The law of springs that break, if they do.
    fn breaking(&self) -> Option<Breaking<Spring<true>>> {
        self.breaks_at.map(|limit| Breaking { law: Spring(self.clone()), limit })
    }

    /// The relative stiffness of each spring; `None` if all are 1.
    pub(super) fn parts(&self, body: &Body) -> Option<Vec<f64>> {
        fill::parts(body, self.springs.iter().map(|ends| &ends[..]))
    }

    /// The code by the law of the springs, or with a faster stepper, if there is one.
    pub(crate) fn by_law(
        &self,
        body: &Arc<Body>,
        conditions: &Conditions,
        faster: Option<Box<dyn Stepper>>,
    ) -> Compiled {
        let stepper = faster.unwrap_or_else(|| match self.damping > 0.0 {
            true => Compiled::full(Spring::<true>(self.clone()), body, conditions),
            false => Compiled::full(Spring::<false>(self.clone()), body, conditions),
        });
        let energy = ByLaw::with(conditions.set, Spring::<false>(self.clone()), body);
        Compiled { stepper, energy: Box::new(energy) }
    }
}

/// Eq. (1) in lanes, with or without damping.
#[derive(Clone)]
struct Spring<const DAMPED: bool>(MassSpring);

impl<const DAMPED: bool> Law for Spring<DAMPED> {
    /// `k L` (N).
    const OF_ELEMENT: usize = 1;
    /// The force on the first node.
    type Whole<L: Lanes> = [L; 3];

    fn elements(&self, _: &Body) -> Option<IndexLists> {
        Some(self.0.springs.iter().map(|ends| &ends[..]).collect())
    }

    fn is_damped(&self) -> bool {
        DAMPED && self.0.damping > 0.0
    }

    #[inline(always)]
    fn prepare<L: Lanes>(&self, rest: &Corners<'_, L>, of_element: &mut [L], _: &mut [L]) {
        of_element[0] = L::splat(self.0.stiffness) * natural_length(rest);
    }

    #[inline(always)]
    fn whole<L: Lanes>(&self, spring: &Element<'_, L>) -> [L; 3] {
        self.0.force::<L, DAMPED>(spring)
    }

    #[inline(always)]
    fn force<L: Lanes>(&self, _: &Element<'_, L>, corner: usize, &force: &[L; 3]) -> [L; 3] {
        if corner == 0 { force } else { each!(3, axis => -force[axis]) }
    }

    #[inline(always)]
    fn energy<L: Lanes>(&self, spring: &Element<'_, L>, rest: &Corners<'_, L>, shares: &mut [L]) -> L {
        shares.fill(L::splat(0.5) * self.0.energy(spring, rest));
        L::splat(0.0)
    }
}

impl<const DAMPED: bool> Strained for Spring<DAMPED> {
    #[inline(always)]
    fn strain<L: Lanes>(&self, spring: &Element<'_, L>, _: &[L; 3]) -> L {
        let (zero, tension) = (L::splat(0.0), spring.of_element(0));
        let stretch = length(spring) * L::splat(self.0.stiffness) / tension - L::splat(1.0);
        // A spring without a natural length has no strain.
        stretch.select(zero.lt(tension), zero)
    }
}

/// The natural length of springs (m).
#[inline(always)]
pub(super) fn natural_length<L: Lanes>(rest: &Corners<'_, L>) -> L {
    let (near, far) = (rest.position(0), rest.position(1));
    let [x, y, z] = each!(3, axis => near[axis] - far[axis]);
    (x * x + y * y + z * z).sqrt()
}

/// The length of springs now (m).
#[inline(always)]
pub(super) fn length<L: Lanes>(spring: &Element<'_, L>) -> L {
    let (near, far) = (spring.corner(0).0, spring.corner(1).0);
    square(each!(3, axis => far[axis] - near[axis])).sqrt()
}

impl MassSpring {
    /// Eq. (1) in lanes: the force on the first nodes of springs (N), whose first constant is `k L` (N).
    #[inline(always)]
    pub(super) fn force<L: Lanes, const DAMPED: bool>(&self, spring: &Element<'_, L>) -> [L; 3] {
        let &Self { stiffness, damping, .. } = self;
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let ((near, slow), (far, fast)) = (spring.corner(0), spring.corner(1));
        let p = each!(3, axis => far[axis] - near[axis]);
        let [vx, vy, vz] = each!(3, axis => fast[axis] - slow[axis]);
        let squared = p[2].mul_add(p[2], p[1].mul_add(p[1], p[0] * p[0]));
        let inverse = one / squared.sqrt();
        let tension = spring.of_element(0);
        let along = if DAMPED {
            (vz.mul_add(p[2], vy.mul_add(p[1], vx * p[0])) * L::splat(damping)).mul_sub(inverse, tension)
        } else {
            -tension
        };
        // A spring between coincident nodes has no direction.
        let pull = along.mul_add(inverse, L::splat(stiffness)).select(zero.lt(squared), zero);
        each!(3, axis => pull * p[axis])
    }

    /// The energy of springs in lanes (J).
    #[inline(always)]
    pub(super) fn energy<L: Lanes>(&self, spring: &Element<'_, L>, rest: &Corners<'_, L>) -> L {
        let (near, far) = (rest.position(0), rest.position(1));
        let stretch = length(spring) - square(each!(3, axis => far[axis] - near[axis])).sqrt();
        L::splat(0.5 * self.stiffness) * stretch * stretch
    }
}

/// The springs of a body, prepared for evaluation.
struct SpringForces {
    model: MassSpring,
    /// `L_ij` of each spring (m).
    natural_length: Vec<f64>,
    /// The relative stiffness of each spring; `None` if all are 1.
    parts: Option<Vec<f64>>,
    /// Adds up the forces of springs on each node.
    gather: blocks::EntriesOfNode,
}

impl SpringForces {
    fn new(model: MassSpring, body: &Body) -> Self {
        let length = |&[i, j]: &[u32; 2]| (body.rest[i as usize] - body.rest[j as usize]).length();
        let natural_length = model.springs.iter().map(length).collect();
        let gather = blocks::EntriesOfNode::new(body.len(), (0..).zip(model.springs.iter().flatten().copied()));
        Self { parts: model.parts(body), model, natural_length, gather }
    }

    /// `k` (N/m) and `D` (N s/m) of a spring.
    fn constants(&self, spring: usize) -> [f64; 2] {
        let part = self.parts.as_ref().map_or(1.0, |parts| parts[spring]);
        [self.model.stiffness, self.model.damping].map(|full| full * part)
    }
}

impl ForceModel for SpringForces {
    fn add_forces(
        &self,
        at: Nodes<'_>,
        _memory: &[f64],
        _next: &mut [f64],
        scratch: &mut Scratch,
        forces: &mut [DVec3],
    ) {
        let Self { model, natural_length, gather, .. } = self;
        let (crew, on_ends) = scratch.parts(2 * natural_length.len());
        blocks::for_each_one(crew, on_ends.as_chunks_mut().0, &|spring, [on_first, on_second]| {
            let [i, j] = model.springs[spring].map(|node| node as usize);
            let [k, d] = self.constants(spring);
            *on_first = spring_force(
                at.position[i] - at.position[j],
                at.velocity[i] - at.velocity[j],
                natural_length[spring],
                k,
                d,
            );
            // A spring acts on its second node with the opposite force.
            *on_second = -*on_first;
        });
        gather.add(crew, on_ends, forces);
    }

    fn is_damped(&self) -> bool {
        self.model.damping > 0.0
    }

    fn report(&self, at: Nodes<'_>, _memory: &[f64], share: &mut Share<'_>) -> Report {
        let mut whole = 0.0;
        for (spring, (ends, &natural)) in self.model.springs.iter().zip(&self.natural_length).enumerate() {
            let [i, j] = ends.map(|node| at.position[node as usize]);
            let stretch = (i - j).length() - natural;
            let [k, _] = self.constants(spring);
            let energy = 0.5 * k * stretch * stretch;
            share(spring, ends, &[0.5 * energy; 2]);
            whole += energy;
        }
        Report { energy: Some(whole), residual: None }
    }
}

/// Eq. (1) for one spring: the force on node `i` (N) from its position `p` (m) and velocity `v` (m/s) relative to `j`,
/// the natural length `l` (m), `k` (N/m) and `d` (N s/m).
///
/// The formula is singular if both nodes are at one point, where a spring has no direction: the force is then zero.
#[doc(alias = "Eq. 1")]
fn spring_force(p: DVec3, v: DVec3, l: f64, k: f64, d: f64) -> DVec3 {
    let squared = p.dot(p);
    if squared == 0.0 {
        return DVec3::ZERO;
    }
    p * -(k * (1.0 - l / squared.sqrt()) + d * v.dot(p) / squared)
}

#[cfg(all(test, feature = "scene"))]
mod tests {
    use super::*;
    use crate::element::{Dimension, Solids};

    #[test]
    fn no_element_has_more_springs_than_are_said_before() {
        let named = [
            Springs::Edges,
            Springs::EdgesOneDiagonal,
            Springs::EdgesFaceDiagonals,
            Springs::EdgesBodyDiagonals,
            Springs::All,
        ];
        let cases = [
            (Dimension::Plane, Solids::Ordered),
            (Dimension::Space, Solids::Ordered),
            (Dimension::Space, Solids::Convex),
        ];
        for (nodes, (dimension, solids)) in (2..12).flat_map(|nodes| cases.map(|case| (nodes, case))) {
            let own: Vec<u32> = (0..nodes as u32).collect();
            let elements: IndexLists = [own.as_slice()].into_iter().collect();
            // On this curve every face of the hull is a triangle, so the hull has the greatest possible number of
            // edges.
            let height = if dimension == Dimension::Plane { 0.0 } else { 1.0 };
            let rest: Vec<_> =
                (0..nodes).map(|at| at as f64).map(|t| DVec3::new(t, t * t, height * t * t * t)).collect();
            let body =
                Body::builder(rest).dimension(dimension).elements(elements).solids(solids).build().expect("a body");
            for springs in named {
                let typed = Parameters { springs: Some(springs), ..Parameters::new(1.0) };
                let made = body.topology().springs(springs).len() as u128;
                assert!(
                    made <= typed.of_springs().most(&BTreeMap::from([(nodes, 1)]), None),
                    "{dimension:?}, {nodes} nodes, {springs:?}: {made}"
                );
            }
        }
    }
}
