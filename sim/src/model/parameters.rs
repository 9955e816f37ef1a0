//! Models as scene files have them: the list of models, and what their parameters share.

use super::{ElasticModel, Misfit, Properties, Setting};
use crate::body::Body;
use crate::material::Material;
use serde::Deserialize;
use serde::de::value::MapDeserializer;
use serde::de::{IntoDeserializer, Visitor};
use std::collections::BTreeMap;
use std::str::FromStr;
use std::sync::Arc;

/// Defines [`ModelParameters`] from a list of models.
macro_rules! models {
    ($($(#[$doc:meta])* $name:ident => $module:ident,)*) => {
        /// A model as written in a scene file: `model = { kind = "…", … }`.
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
        #[serde(tag = "kind", rename_all = "kebab-case")]
        pub enum ModelParameters {
            $($(#[$doc])* $name(super::$module::Parameters),)*
        }

        $(
            impl From<super::$module::Parameters> for ModelParameters {
                fn from(parameters: super::$module::Parameters) -> Self {
                    Self::$name(parameters)
                }
            }
        )*

        impl ModelParameters {
            fn typed(&self) -> &dyn TypedModel {
                match self {
                    $(Self::$name(parameters) => parameters,)*
                }
            }
        }
    };
}

// The list of elastic models.
models! {
    /// Elasticity of volume elements that keep their shape (paper, section 3).
    ShapeBased => shape_based,
    /// Springs between pairs of nodes (paper, section 2).
    MassSpring => mass_spring,
    /// Springs whose elongation is limited (paper, Ref. 4; the formula is our own reading).
    LimitedSprings => limited_springs,
    /// Springs and a pressure that keeps the volume of each element (paper, Ref. 3).
    VolumeSprings => volume_springs,
    /// Finite elements of a material under small displacements: Hooke's law (paper, Ref. 5). Of tetrahedra and hexahedra, in the plane of
    /// triangles and quadrilaterals.
    Linear => linear,
    /// Finite elements of a material with Hooke's law for the strain without rotation. Of the same elements.
    Corotational => corotational,
    /// Finite elements of a stable neo-Hookean material, for large deformations. Of the same elements.
    NeoHookean => neo_hookean,
    /// Elastically deformable models: the energy of a changed metric, on lattices (paper, Ref. 1).
    Metric => metric,
    /// Extended position-based dynamics, with the shape of each element as a constraint. It steps itself, stably with any step, and damps what a
    /// step does not resolve: a body with the angular velocity `ω` (rad/s) loses the part `ω² ΔT` of its angular momentum each second.
    Xpbd => xpbd,
}

impl ModelParameters {
    /// The model for a body. `springs` are those listed for the body, if there is a list.
    ///
    /// # Errors
    /// Parameters that contradict each other or do not fit the body.
    pub fn resolve(&self, body: &Body, springs: Option<&[[u32; 2]]>) -> Result<Arc<dyn ElasticModel>, Misfit> {
        self.typed().resolve(body, springs)
    }

    /// The parameters of a model with these properties; `None` for a model that is not in the list.
    pub fn of(properties: &Properties) -> Option<Self> {
        let kind = ("kind", Setting::Choice(properties.kind));
        let all = properties.parameters.iter().map(|parameter| (parameter.name, parameter.value));
        Self::deserialize(MapDeserializer::new([kind].into_iter().chain(all))).ok()
    }

    /// A parameter that is given and has no effect on a body, with the reason and the remedy; `None` if all have one.
    pub fn without_effect(&self, body: &Body) -> Option<Misfit> {
        self.typed().without_effect(body)
    }

    /// An upper bound for the number of springs that the model makes. `elements` has the number of elements for each
    /// number of nodes; `listed` is the number of springs that the body lists, if it lists any.
    pub fn most_springs(&self, elements: &BTreeMap<usize, u128>, listed: Option<u128>) -> u128 {
        self.typed().most_springs(elements, listed)
    }
}

impl IntoDeserializer<'_> for Setting {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

impl<'de> serde::Deserializer<'de> for Setting {
    type Error = serde::de::value::Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Self::Error> {
        match self {
            Self::Number(number, _) => visitor.visit_f64(number),
            Self::Count(count) => visitor.visit_u32(count),
            Self::Choice(name) => visitor.visit_str(name),
        }
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf option unit unit_struct newtype_struct seq tuple
        tuple_struct map struct enum identifier ignored_any
    }
}

/// The parameters of one model in a scene file.
pub(super) trait TypedModel {
    /// See [`ModelParameters::resolve`].
    fn resolve(&self, body: &Body, springs: Option<&[[u32; 2]]>) -> Result<Arc<dyn ElasticModel>, Misfit>;

    /// See [`ModelParameters::without_effect`].
    fn without_effect(&self, _body: &Body) -> Option<Misfit> {
        None
    }

    /// See [`ModelParameters::most_springs`].
    fn most_springs(&self, _elements: &BTreeMap<usize, u128>, _listed: Option<u128>) -> u128 {
        0
    }
}

/// The damping constant (N s/m), from either parameter: the constant, or the ratio `ζ = D / 2√(km)`; 0 if neither is
/// given. `m` is the mass of the [lightest](Body::lightest) node, as in [`Properties::shortest_period`](super::Properties::shortest_period): the masses of other nodes do
/// not decide whether a damping ratio and a step in periods are stable together.
pub(super) fn damping(constant: Option<f64>, ratio: Option<f64>, stiffness: f64, body: &Body) -> Result<f64, Misfit> {
    match (constant, ratio) {
        (Some(_), Some(_)) => {
            let message = "both `damping` and `damping_ratio` are given; keep one of them";
            Err(Misfit { key: "damping_ratio", message: message.into() })
        }
        (Some(constant), None) => Ok(constant),
        (None, Some(ratio)) => Ok(2.0 * ratio * (stiffness * body.lightest()).sqrt()),
        (None, None) => Ok(0.0),
    }
}

/// The strain at which elements or springs break, if they do.
pub(super) fn breaks_at(given: Option<f64>) -> Result<Option<f64>, Misfit> {
    // The schema has the same bound; scenes made in code pass it by.
    match given {
        Some(strain) if !(strain > 0.0 && strain.is_finite()) => {
            let message =
                format!("`breaks_at` is {strain}; expected a strain above 0, such as 0.1 for a tenth of the length");
            Err(Misfit { key: "breaks_at", message })
        }
        _ => Ok(given),
    }
}

/// The elastic constant (N/m), that of the stiffest element, from either parameter: the constant, or a material.
pub(super) fn stiffness(
    constant: Option<f64>,
    young: Option<f64>,
    poisson: Option<f64>,
    body: &Body,
) -> Result<(f64, Option<Material>), Misfit> {
    match (constant, young) {
        (Some(constant), None) if poisson.is_none() => Ok((constant, None)),
        (Some(_), None) => {
            let message = "`poisson` is a property of a material; give `young` in place of `stiffness`";
            Err(Misfit { key: "poisson", message: message.into() })
        }
        (None, Some(young)) => {
            let material = Material { young, poisson: poisson.unwrap_or(0.0) };
            super::check(material, body)?;
            Ok((material.stiffness(body).into_iter().fold(0.0, f64::max), Some(material)))
        }
        (Some(_), Some(_)) => {
            Err(Misfit { key: "young", message: "both `stiffness` and `young` are given; keep one of them".into() })
        }
        (None, None) => {
            let message = "neither `stiffness` (N/m) nor `young` (Pa) is given; give one of them";
            Err(Misfit { key: "stiffness", message: message.into() })
        }
    }
}

/// A number from 0 to 1, in a scene file also as a fraction such as `"1/3"`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(try_from = "TypedRatio")]
pub struct Ratio(pub f64);

/// A [`Ratio`] as written in a scene file.
#[derive(serde::Deserialize, schemars::JsonSchema)]
#[serde(untagged)]
enum TypedRatio {
    /// From 0 to 1.
    Number(#[schemars(range(min = 0.0, max = 1.0))] f64),
    /// A fraction of whole numbers.
    Fraction(#[schemars(extend("format" = "fraction"))] String),
}

impl TryFrom<TypedRatio> for Ratio {
    type Error = String;

    fn try_from(typed: TypedRatio) -> Result<Self, String> {
        match typed {
            TypedRatio::Number(number) => Ok(Self(number)),
            TypedRatio::Fraction(text) => text.parse(),
        }
    }
}

impl FromStr for Ratio {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let whole = |text: &str| text.trim().parse::<u32>().ok().map(f64::from);
        let value = text.split_once('/').and_then(|(above, below)| Some(whole(above)? / whole(below)?));
        let expected = || "expected a number from 0 to 1, or a fraction such as \"1/3\"".to_owned();
        value.filter(|value| (0.0..=1.0).contains(value)).map(Self).ok_or_else(expected)
    }
}

impl schemars::JsonSchema for Ratio {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Ratio".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        <TypedRatio as schemars::JsonSchema>::json_schema(generator)
    }
}
