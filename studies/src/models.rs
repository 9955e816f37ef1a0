//! Elastic models by their names in scene files, with parameters that make them alike: one stiffness, one damping.

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

/// Poisson's ratio of materials, and the bulk modulus of springs that keep volumes over the modulus of such a material.
const POISSON: f64 = 0.3;
const BULK: f64 = 1.0 / (3.0 * (1.0 - 2.0 * POISSON));
/// The greatest elongation of limited springs over their natural length.
const LIMIT: f64 = 0.5;

/// The parameters of a model with an elastic constant `k` (N/m) or Young's modulus (Pa) of as stiff a material, without damping.
fn elastic(kind: &str, stiffness: f64, young: f64) -> Map<String, Value> {
    let mut keys = Map::from_iter([("kind".to_owned(), json!(kind))]);
    let mut add = |key: &str, value: Value| keys.insert(key.to_owned(), value);
    match kind {
        "linear" | "corotational" | "neo-hookean" | "metric" => {
            add("young", json!(young));
            add("poisson", json!(POISSON))
        }
        _ => add("stiffness", json!(stiffness)),
    };
    match kind {
        "volume-springs" => add("bulk", json!(young * BULK)),
        "limited-springs" => add("limit", json!(LIMIT)),
        _ => None,
    };
    keys
}

/// Whether a model takes a damping constant. XPBD has that of its steps alone.
fn is_damped(kind: &str) -> bool {
    kind != "xpbd"
}

/// A model for a body, as stiff as the shape model with `k` (N/m), and with `D` (N s/m). `more` are further keys. `None` if the model does not
/// take the elements of the body.
pub(crate) fn on(
    body: &Body,
    kind: &str,
    stiffness: f64,
    damping: f64,
    more: &Map<String, Value>,
) -> Option<Arc<dyn ElasticModel>> {
    let of_unit = Material { young: 1.0, poisson: 0.0 }.stiffness(body).into_iter().fold(0.0, f64::max);
    let young = if of_unit > 0.0 { stiffness / of_unit } else { 0.0 };
    let mut keys = elastic(kind, stiffness, young);
    keys.extend(more.clone());
    if is_damped(kind) {
        keys.insert("damping".to_owned(), json!(damping));
    }
    let parameters: ModelParameters = serde_json::from_value(keys.into()).expect("the parameters of a model");
    parameters.resolve(body, None).ok()
}

/// A model in a scene file, on cubes or squares of a side (m), with `k` (N/m) and `ζ`.
pub(crate) fn typed(kind: &str, stiffness: f64, side: f64, damping_ratio: f64) -> String {
    let mut keys = elastic(kind, stiffness, 2.0 * stiffness / side);
    if is_damped(kind) && damping_ratio > 0.0 {
        keys.insert("damping_ratio".to_owned(), json!(damping_ratio));
    }
    let keys: Vec<_> = keys.iter().map(|(key, value)| format!("{key} = {value}")).collect();
    format!("{{ {} }}", keys.join(", "))
}
