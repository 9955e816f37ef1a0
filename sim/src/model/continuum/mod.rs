//! Finite elements: what the models of a continuum share.
//!
//! The places of an element are a map of its places at rest, with the gradient `F`. Its energy is `Σ w ψ(F)`, the sum of the energy density
//! of a material law over points with weights, and the force on a node `−Σ w P ∇N`, with `P = ∂ψ/∂F` the first stress of Piola and
//! Kirchhoff and `∇N` the gradient at rest of the node's shape function. Triangles and tetrahedra have linear shape functions and one point.
//! Quadrilaterals and hexahedra have bilinear and trilinear ones and the points of Gauss at `±1/√3` in each direction (T. Hughes, "The finite
//! element method", 1987, chapter 3; O. Zienkiewicz, R. Taylor, "The finite element method", 5th ed. 2000, vol. 1, chapters 8 and 9; the
//! forces: E. Sifakis, J. Barbič, "FEM simulation of 3D deformable solids", SIGGRAPH courses 2012, chapter 4). These patterns integrate
//! parallelepipeds of a linear material exactly.
//!
//! Masses are those of the nodes. In the plane a material is a sheet of unit thickness under plane stress, and `λ` is
//! [that of the sheet](Material::lame).
//!
//! A node is damped by `−D` times its velocity without the rigid motion that fits its element best, with `D` in proportion to the elastic
//! constant that the element has in the shape model.

mod elements;
mod map;
mod modes;
mod nearest;

pub(in crate::model) use map::{Map, cofactors, dot, product};
pub(in crate::model) use nearest::with_nearest;

use super::{ByLaw, ElasticModel, ForceModel, Lanes, Misfit, Properties, Setting, Vectorised};
use crate::body::Body;
use crate::element::{Dimension, ElementKind};
use crate::kernel::{Compiled, Conditions};
use crate::material::{Damping, Material};
use crate::volume::volumes_at_rest;
use elements::Elements;
use glam::{DMat3, DVec3};
use modes::{GAUSS, bits};
use std::fmt::Debug;
use std::marker::PhantomData;
use std::sync::Arc;

/// The parameters of a model of a material in a scene file: of finite elements, and of `metric`.
#[cfg(feature = "scene")]
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("not" = { "required": ["damping", "damping_ratio"] }))]
pub struct Parameters {
    /// Young's modulus of the material (Pa; N/m in the plane). Cycles and damping ratios have the elastic constant `k` of the shape model's
    /// stiffest element for it.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub young: f64,
    /// Poisson's ratio of the material. Default: 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0), extend("exclusiveMaximum" = 0.5))]
    pub poisson: Option<f64>,
    /// Damping constant of the stiffest element (N s/m): of the velocities of its nodes without its rigid motion. Others have it in proportion
    /// to their elastic constants in the shape model. Default: 0. Not together with `damping_ratio`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub damping: Option<f64>,
    /// Damping as a ratio `ζ = D / 2√(km)`, with `m` the mass of the lightest node, as in `step = "T/50"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub damping_ratio: Option<f64>,
}

#[cfg(feature = "scene")]
impl Parameters {
    /// The model that `make` makes for a body from a material and a damping constant (N s/m).
    pub(in crate::model) fn model<M: ElasticModel + 'static>(
        &self,
        body: &Body,
        make: impl Fn(Material, f64) -> Result<M, Misfit>,
    ) -> Result<Arc<dyn ElasticModel>, Misfit> {
        let material = Material { young: self.young, poisson: self.poisson.unwrap_or(0.0) };
        let undamped = make(material, 0.0)?;
        let damping = super::damping(self.damping, self.damping_ratio, undamped.properties(body).stiffness, body)?;
        Ok(Arc::new(if damping == 0.0 { undamped } else { make(material, damping)? }))
    }
}

/// Defines the model of a material law, and its parameters in a scene file.
macro_rules! of_law {
    ($law:ident) => {
        /// The model of a material on a body, with the damping constant of the stiffest element (N s/m).
        ///
        /// # Errors
        /// A material that is none, and elements that the model does not take: of other kinds, without a volume, or that are turned
        /// inside out at rest at one of their points.
        pub fn model(
            body: &crate::body::Body,
            material: crate::material::Material,
            damping: f64,
        ) -> Result<std::sync::Arc<dyn super::ElasticModel>, super::Misfit> {
            Ok(std::sync::Arc::new(super::continuum::FiniteElements::<$law>::new(body, material, damping)?))
        }

        super::continuum::of_material!(|body, material, damping| {
            super::continuum::FiniteElements::<$law>::new(body, material, damping)
        });
    };
}
pub(in crate::model) use of_law;

/// Defines the parameters in a scene file of a model of a material.
macro_rules! of_material {
    (|$body:ident, $material:ident, $damping:ident| $make:expr) => {
        /// The parameters of the model in a scene file.
        #[cfg(feature = "scene")]
        #[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
        #[serde(transparent)]
        pub struct Parameters(pub super::continuum::Parameters);

        #[cfg(feature = "scene")]
        impl super::TypedModel for Parameters {
            fn resolve(
                &self,
                $body: &crate::body::Body,
                _: Option<&[[u32; 2]]>,
            ) -> Result<std::sync::Arc<dyn super::ElasticModel>, super::Misfit> {
                self.0.model($body, |$material, $damping| $make)
            }
        }
    };
}
pub(in crate::model) use of_material;

/// The law of a material, in the plane (`D` = 2) and in space (`D` = 3).
pub(in crate::model) trait Stress: Clone + Copy + Debug + Send + Sync + 'static {
    /// The name of the model in a scene file.
    const NAME: &'static str;

    /// `P` (Pa) in proportion to `[μ, λ]` (Pa), of `F`.
    fn stress<L: Lanes, const D: usize>(moduli: [L; 2], f: &Map<L, D>) -> Map<L, D>;

    /// `ψ` (J/m³), 0 at rest.
    fn energy<L: Lanes, const D: usize>(moduli: [L; 2], f: &Map<L, D>) -> L;
}

/// A model of finite elements with its parameters in SI units, checked.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::model) struct FiniteElements<S> {
    material: Material,
    /// The greatest elastic constant of the shape model for it (N/m).
    stiffness: f64,
    /// Damping constant `D` of the stiffest element (N s/m).
    damping: f64,
    of: PhantomData<S>,
}

impl<S: Stress> FiniteElements<S> {
    /// The model of a material on a body, with the damping constant of the stiffest element (N s/m).
    ///
    /// # Errors
    /// As `of_law` says of `model`.
    pub(in crate::model) fn new(body: &Body, material: Material, damping: f64) -> Result<Self, Misfit> {
        let kinds = body.elements.iter().zip(&body.kinds).enumerate();
        for (at, (nodes, &kind)) in kinds {
            let (is_taken, taken) = match body.dimension {
                Dimension::Plane => (matches!(nodes.len(), 3 | 4), "triangles and quadrilaterals"),
                Dimension::Space => {
                    (matches!(kind, ElementKind::Tetrahedron | ElementKind::Hexahedron), "tetrahedra and hexahedra")
                }
            };
            if !is_taken {
                let found = name(kind, nodes.len());
                let message = format!(
                    "`{}` takes {taken}; element {at} is {found}; `shape-based` takes elements of every kind",
                    S::NAME
                );
                return Err(Misfit { key: "kind", message });
            }
        }
        if let Some(element) = volumes_at_rest(body).iter().position(|&volume| volume <= 0.0) {
            let measure = if body.dimension == Dimension::Plane { "area" } else { "volume" };
            let message = format!(
                "element {element} has no {measure} at rest: it is flat, or its nodes are in the wrong order; `{}` cannot do without",
                S::NAME
            );
            return Err(Misfit { key: "kind", message });
        }
        super::check(material, body)?;
        if let Some(element) = body.elements.iter().position(|nodes| is_folded(body, nodes)) {
            let message = format!(
                "element {element} is folded: at rest it is turned inside out near one of its nodes; move its nodes, or divide it"
            );
            return Err(Misfit { key: "kind", message });
        }
        let stiffness = material.stiffness(body).into_iter().fold(0.0, f64::max);
        Ok(Self { material, stiffness, damping, of: PhantomData })
    }

    fn law<const D: usize, const CORNERS: usize>(&self, body: &Body) -> Elements<S, D, CORNERS> {
        let (shear, lame) = (self.material.shear(), self.material.lame(body.dimension));
        let is_affine = body.elements.iter().all(|nodes| is_affine(body, nodes));
        Elements { shear, lame, damping: Damping::new(self.damping, body), is_affine, of: PhantomData }
    }
}

/// An expression of the law of the elements of a body.
macro_rules! by_law {
    ($model:ident, $body:ident, $law:ident => $value:expr) => {
        match ($body.dimension, $body.elements.iter().all(|nodes| nodes.len() == 4)) {
            (Dimension::Plane, _) => {
                let $law = $model.law::<2, 4>($body);
                $value
            }
            (Dimension::Space, true) => {
                let $law = $model.law::<3, 4>($body);
                $value
            }
            (Dimension::Space, false) => {
                let $law = $model.law::<3, 8>($body);
                $value
            }
        }
    };
}

impl<S: Stress> ElasticModel for FiniteElements<S> {
    fn properties(&self, body: &Body) -> Properties {
        let undamped = Properties::new(S::NAME, self.stiffness).of_material(Some(self.material), body.dimension);
        undamped.damped(self.damping).fixed("damping_of", Setting::Choice("deformation"))
    }

    fn vectorised(&self) -> Option<&dyn Vectorised> {
        Some(self)
    }

    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel> {
        by_law!(self, body, law => Box::new(ByLaw::new(law, body)))
    }
}

impl<S: Stress> Vectorised for FiniteElements<S> {
    fn compile(&self, body: &Arc<Body>, conditions: &Conditions) -> Compiled {
        by_law!(self, body, law => Compiled::once(law, body, conditions))
    }
}

/// What an element is, in words.
fn name(kind: ElementKind, nodes: usize) -> String {
    match kind {
        ElementKind::Segment => "a segment".into(),
        ElementKind::Polygon => format!("a polygon of {nodes} nodes"),
        ElementKind::Triangle => "a triangle, which has no volume".into(),
        ElementKind::Tetrahedron => "a tetrahedron".into(),
        ElementKind::Pyramid => "a pyramid".into(),
        ElementKind::Wedge => "a wedge".into(),
        ElementKind::Hexahedron => "a hexahedron".into(),
        ElementKind::Other => format!("a polyhedron of {nodes} nodes in any order"),
    }
}

/// The corners of a quadrilateral or hexahedron by their bits; `None` for other elements.
fn corners_by_bits(body: &Body, nodes: &[u32]) -> Option<Vec<DVec3>> {
    let at = |corner: usize| body.rest[nodes[corner] as usize];
    match (body.dimension, nodes.len()) {
        (Dimension::Plane, 4) => Some((0..4).map(|corner| at(bits::<2>(corner))).collect()),
        (Dimension::Space, 8) => Some((0..8).map(at).collect()),
        _ => None,
    }
}

/// Whether the map of an element from its parent has a gradient without volume, or turned inside out, at one of its points.
fn is_folded(body: &Body, nodes: &[u32]) -> bool {
    let Some(corners) = corners_by_bits(body, nodes) else { return false };
    let sign = |of: usize, axis: usize| if of >> axis & 1 == 1 { 1.0 } else { -1.0 };
    let axes = if body.dimension == Dimension::Plane { 2 } else { 3 };
    let slope = |point: usize, axis: usize| -> DVec3 {
        if axis >= axes {
            return DVec3::Z;
        }
        let others = || (0..axes).filter(|&other| other != axis);
        let factor = |corner: usize| -> f64 {
            others().map(|other| 1.0 + sign(corner, other) * sign(point, other) * GAUSS).product()
        };
        (0..corners.len()).map(|corner| corners[corner] * (sign(corner, axis) * factor(corner))).sum()
    };
    let determinant = |point: usize| DMat3::from_cols(slope(point, 0), slope(point, 1), slope(point, 2)).determinant();
    (0..corners.len()).any(|point| determinant(point) <= 0.0)
}

/// Whether an element is a simplex, a parallelogram or a parallelepiped, to the round-off of its coordinates.
fn is_affine(body: &Body, nodes: &[u32]) -> bool {
    const ROUND_OFF: f64 = 1e-14;
    let Some(corners) = corners_by_bits(body, nodes) else { return true };
    let size = corners.iter().fold(0.0, |size: f64, corner| size.max(corner.abs().max_element()));
    let mode = |of: usize| -> DVec3 {
        let sign = |corner: usize| if (of & !corner).count_ones().is_multiple_of(2) { 1.0 } else { -1.0 };
        corners.iter().enumerate().map(|(corner, at)| *at * sign(corner)).sum()
    };
    let mut mixed = (0..corners.len()).filter(|of| of.count_ones() > 1);
    mixed.all(|of| mode(of).abs().max_element() <= ROUND_OFF * size)
}
