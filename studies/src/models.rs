//! Elastic models by their names in scene files, with parameters that make them alike: one material, one damping.

use localshape::sim::model::{ElasticModel, ModelParameters};
use localshape::sim::{Body, Material};
use serde_json::{Map, Value, json};
use std::sync::Arc;

/// The names of all models.
pub(crate) fn kinds() -> Vec<String> {
    let schema = Value::from(schemars::schema_for!(ModelParameters));
    let models = schema["oneOf"].as_array().expect("a choice of models");
    models.iter().map(|model| model["properties"]["kind"]["const"].as_str().expect("a name").to_owned()).collect()
}

/// Whether a model consists of springs, which have a constant in place of a material.
pub(crate) fn is_springs(kind: &str) -> bool {
    matches!(kind, "mass-spring" | "limited-springs" | "volume-springs")
}

/// What models have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Alike {
    material: Material,
    /// The elastic constant `k` of springs, and of the shape model in place of the material (N/m).
    springs: f64,
    shapes: Option<f64>,
}

impl Alike {
    /// Poisson's ratio of materials beside an elastic constant.
    const POISSON: f64 = 0.3;
    /// The bulk modulus of springs that keep volumes over Young's modulus: that of a material with this ratio.
    const BULK: f64 = 1.0 / (3.0 * (1.0 - 2.0 * Self::POISSON));
    /// The greatest elongation of limited springs over their natural length.
    const LIMIT: f64 = 0.5;

    /// A material, on elements for which the shape model has the constant `unit` (m) with the modulus 1: half of the side of cubes.
    pub(crate) fn material(material: Material, unit: f64) -> Self {
        Self { material, springs: material.young * unit, shapes: None }
    }

    /// An elastic constant `k` (N/m), on such elements.
    pub(crate) fn constant(constant: f64, unit: f64) -> Self {
        let young = if unit > 0.0 { constant / unit } else { 0.0 };
        Self { material: Material { young, poisson: Self::POISSON }, springs: constant, shapes: Some(constant) }
    }

    /// An elastic constant `k` (N/m) of the stiffest element of a body.
    pub(crate) fn on_body(constant: f64, body: &Body) -> Self {
        let units = Material { young: 1.0, poisson: 0.0 }.stiffness(body);
        Self::constant(constant, units.into_iter().fold(0.0, f64::max))
    }

    /// The parameters of a model, with the key of its damping. XPBD has that of its steps alone.
    fn keys(&self, kind: &str, (damped, damping): (&str, f64)) -> Map<String, Value> {
        let mut keys = Map::from_iter([("kind".to_owned(), json!(kind))]);
        let mut add = |key: &str, value: f64| keys.insert(key.to_owned(), json!(value));
        let constant = match kind {
            "shape-based" | "xpbd" => self.shapes,
            _ => is_springs(kind).then_some(self.springs),
        };
        if let Some(constant) = constant {
            add("stiffness", constant);
        } else {
            add("young", self.material.young);
            add("poisson", self.material.poisson);
        }
        match kind {
            "volume-springs" => add("bulk", self.material.young * Self::BULK),
            "limited-springs" => add("limit", Self::LIMIT),
            _ => None,
        };
        if damping > 0.0 && kind != "xpbd" {
            add(damped, damping);
        }
        keys
    }

    /// A model for a body, with `D` (N s/m) and perhaps a further key. `None` if the model does not take the elements of the body.
    pub(crate) fn model(
        &self,
        body: &Body,
        kind: &str,
        damping: f64,
        more: Option<[&str; 2]>,
    ) -> Option<Arc<dyn ElasticModel>> {
        let mut keys = self.keys(kind, ("damping", damping));
        keys.extend(more.map(|[key, value]| (key.to_owned(), json!(value))));
        let parameters: ModelParameters = serde_json::from_value(keys.into()).expect("the parameters of a model");
        parameters.resolve(body, None).ok()
    }

    /// A model in a scene file, with `ζ`.
    pub(crate) fn typed(&self, kind: &str, damping_ratio: f64) -> String {
        let keys = self.keys(kind, ("damping_ratio", damping_ratio));
        let keys: Vec<_> = keys.iter().map(|(key, value)| format!("{key} = {value}")).collect();
        format!("{{ {} }}", keys.join(", "))
    }
}
