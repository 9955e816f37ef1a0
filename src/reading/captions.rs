//! Models, elements, choices and quantities in words, for captions and messages.

use crate::sim::model::{ElasticModel, Parameter, Properties, Setting};
use crate::sim::{Body, Dimension, ElementKind, Material};
use glam::DVec3;
use serde::Serialize;

/// A model with all choices that change the result, such as the rotation solver, and the material that it is.
pub fn description(model: &dyn ElasticModel, body: &Body) -> String {
    let is_material = model.material(body).filter(|_| model.properties(body).given_material().is_none());
    let as_material = is_material.map_or_else(String::new, |is| format!(", as a material {}", material(is, body)));
    parts_and_constants(model, body) + &choices(model, body) + &stiffness_of_material(model, body) + &as_material
}

/// The elastic constant of a model whose material was given: `, k = 10 kN/m`.
pub(crate) fn stiffness_of_material(model: &dyn ElasticModel, body: &Body) -> String {
    let properties = model.properties(body);
    let stiffness = || format!(", k = {}", quantity(properties.stiffness, "N/m"));
    properties.given_material().map_or_else(String::new, |_| stiffness())
}

/// All choices of a model that change the result, such as `, rotation robust (exact)`.
fn choices(model: &dyn ElasticModel, body: &Body) -> String {
    let properties = model.properties(body);
    let rotation = match (properties.get("rotation"), properties.get("passes")) {
        (Some(Setting::Choice("planar")), _) => ", rotations by Eq. (9)".to_owned(),
        (Some(Setting::Choice(rotation)), Some(Setting::Count(passes))) => {
            format!(", rotation {rotation} with {passes} pass{}", if passes == 1 { "" } else { "es" })
        }
        (Some(Setting::Choice(rotation)), _) => format!(", rotation {rotation} (exact)"),
        _ => String::new(),
    };
    let is_chosen = properties.parameters.iter().any(|parameter| parameter.name == "damping_of");
    let damping = match properties.get("damping_of") {
        Some(Setting::Choice(of)) if properties.damping > 0.0 && is_chosen => format!(", damping of {of}"),
        Some(Setting::Choice(of)) if properties.damping > 0.0 => format!(" of {of}"),
        _ => String::new(),
    };
    let iterations = match properties.get("iterations") {
        Some(Setting::Count(1)) => ", one iteration a step".to_owned(),
        Some(Setting::Count(count)) => format!(", {count} iterations a step"),
        _ => String::new(),
    };
    rotation + &damping + &limits(&properties) + &iterations
}

/// The unusual choices of a model, which captions append to its damping, such as `, exact rotations`.
#[cfg(feature = "render")]
pub(crate) fn unusual_choices(model: &dyn ElasticModel, body: &Body) -> String {
    let properties = model.properties(body);
    let damping = match properties.get("damping_of") {
        Some(Setting::Choice("deformation")) if properties.damping > 0.0 => " of deformation",
        _ => "",
    };
    let rotation = match properties.get("rotation") {
        Some(Setting::Choice("vector-length")) => ", θ = |w|",
        Some(Setting::Choice("linear-update")) => ", Eq. (16)",
        Some(Setting::Choice("robust")) => ", exact rotations",
        _ => "",
    };
    format!("{damping}{}{rotation}", limits(&properties))
}

/// The further parameters of a model: factors, limits and moduli.
fn limits(properties: &Properties) -> String {
    let word = |&Parameter { name, value }: &Parameter| match (name, value) {
        ("bending", Setting::Number(factor, _)) if factor != 1.0 => format!(", β = {}", fraction(factor)),
        ("breaks_at", Setting::Number(strain, _)) => format!(", breaks at {strain}"),
        ("limit", Setting::Number(limit, _)) => format!(", elongation below {limit} of the length"),
        ("bulk", Setting::Number(bulk, unit)) => format!(", κ = {}", quantity(bulk, unit)),
        _ => String::new(),
    };
    properties.parameters.iter().map(word).collect()
}

/// A number as a fraction, if it is between 0 and 1 and the denominator is small.
fn fraction(number: f64) -> String {
    let below = (2..10).map(f64::from).find(|below| (number * below - (number * below).round()).abs() < 1e-12);
    match below.filter(|_| number > 0.0 && number < 1.0) {
        Some(below) => format!("{}/{below}", (number * below).round()),
        None => number.to_string(),
    }
}

/// A material of a body: `E = 200 kPa, ν = 0.3`.
fn material(Material { young, poisson }: Material, body: &Body) -> String {
    let unit = if body.dimension() == Dimension::Plane { "N/m" } else { "Pa" };
    format!("E = {}, ν = {}", quantity(young, unit), rounded(poisson, 3))
}

/// The parts of a body in a model, and the constants of the model: `27 cubes, k = 10 kN/m, ζ = 0.1`.
pub(crate) fn parts_and_constants(model: &dyn ElasticModel, body: &Body) -> String {
    format!("{}, {}", parts(model, body), constants(model, body))
}

/// The parts of a body in a model: `27 cubes`.
fn parts(model: &dyn ElasticModel, body: &Body) -> String {
    match (model.springs().len(), elements(body).as_slice()) {
        (1, _) => "1 spring".to_owned(),
        (0, [(count, name)]) => format!("{count} {name}"),
        (0, _) => format!("{} elements", body.elements().len()),
        (count, _) => format!("{count} springs"),
    }
}

/// The constants of a model of a body: `k = 10 kN/m, ζ = 0.1`, or `E = 200 kPa, ν = 0, ζ = 0.1`, as they were given.
pub(crate) fn constants(model: &dyn ElasticModel, body: &Body) -> String {
    let properties = model.properties(body);
    let (k, damping) = (properties.stiffness, properties.damping);
    let of_material = properties.given_material().map(|given| material(given, body));
    let mut text = of_material.unwrap_or_else(|| format!("k = {}", quantity(k, "N/m")));
    if damping > 0.0 {
        text += &format!(", ζ = {}", rounded(damping / (2.0 * (k * body.lightest()).sqrt()), 3));
    }
    text
}

/// The number of elements of each kind, with the name of the kind, singular or plural. Polygons are named by their
/// number of sides; hexahedra are cubes if all of them are, and quadrilaterals are squares if all of them are.
pub(crate) fn elements(body: &Body) -> Vec<(usize, &'static str)> {
    use ElementKind::*;
    // Polygons with more than six sides are one group.
    let group = |nodes: &[u32], kind| if kind == Polygon { (kind, nodes.len().min(7)) } else { (kind, 0) };
    let of = |wanted| {
        body.elements()
            .iter()
            .zip(body.kinds())
            .map(|(nodes, &kind)| (nodes, group(nodes, kind)))
            .filter(move |one| one.1 == wanted)
    };
    let names = |wanted: (ElementKind, usize)| match wanted {
        (Segment, _) => ["segment", "segments"],
        (Polygon, 3) | (Triangle, _) => ["triangle", "triangles"],
        (Polygon, 4) if of(wanted).all(|(nodes, _)| is_square(nodes, body.rest())) => ["square", "squares"],
        (Polygon, 4) => ["quadrilateral", "quadrilaterals"],
        (Polygon, 5) => ["pentagon", "pentagons"],
        (Polygon, 6) => ["hexagon", "hexagons"],
        (Polygon, _) => ["polygon", "polygons"],
        (Tetrahedron, _) => ["tetrahedron", "tetrahedra"],
        (Pyramid, _) => ["pyramid", "pyramids"],
        (Wedge, _) => ["wedge", "wedges"],
        (Hexahedron, _) if of(wanted).all(|(nodes, _)| is_cube(nodes, body.rest())) => ["cube", "cubes"],
        (Hexahedron, _) => ["hexahedron", "hexahedra"],
        (Other, _) if of(wanted).count() == body.elements().len() => ["element", "elements"],
        (Other, _) => ["other element", "other elements"],
    };
    let polygons = (3..=7).map(|sides| (Polygon, sides));
    let others = [Triangle, Tetrahedron, Pyramid, Wedge, Hexahedron, Other].map(|kind| (kind, 0));
    let groups = [(Segment, 0)].into_iter().chain(polygons).chain(others);
    let counted = groups.map(|group| (of(group).count(), group)).filter(|(count, _)| *count > 0);
    counted.map(|(count, group)| (count, names(group)[usize::from(count > 1)])).collect()
}

/// Whether a quadrilateral in the plane has equal sides and right angles at rest, up to rounding.
fn is_square(nodes: &[u32], rest: &[DVec3]) -> bool {
    let corner = |at: usize| rest[nodes[at] as usize] - rest[nodes[0] as usize];
    let [one, other] = [corner(1), corner(3)];
    let size = one.length();
    let slack = 1e-9 * size.max(rest[nodes[0] as usize].length());
    (corner(2) - (one + other)).length() <= slack && (DVec3::new(-one.y, one.x, 0.0) - other).length() <= slack
}

/// Whether a hexahedron has equal edges and right angles at rest, up to rounding.
fn is_cube(nodes: &[u32], rest: &[DVec3]) -> bool {
    let corner = |at: usize| rest[nodes[at] as usize] - rest[nodes[0] as usize];
    let axes @ [x, y, z] = [corner(1), corner(2), corner(4)];
    let size = x.length();
    let slack = 1e-9 * size.max(rest[nodes[0] as usize].length());
    let is_square = |a: DVec3, b: DVec3| (b.length() - size).abs() <= slack && (a.dot(b) / size).abs() <= slack;
    let is_at = |at: usize, place: DVec3| corner(at).distance_squared(place) <= slack * slack;
    let [xy, yz] = [x + y, y + z];
    (0..3).all(|a| is_square(axes[a], axes[(a + 1) % 3]))
        && is_at(3, xy)
        && is_at(5, x + z)
        && is_at(6, yz)
        && is_at(7, xy + z)
}

/// The value of an enum as written in a scene.
pub fn typed(choice: &impl Serialize) -> String {
    serde_json::to_value(choice).ok().and_then(|name| name.as_str().map(String::from)).unwrap_or_default()
}

/// SI prefixes and their factors.
const PREFIXES: [(f64, &str); 13] = [
    (1e18, "E"),
    (1e15, "P"),
    (1e12, "T"),
    (1e9, "G"),
    (1e6, "M"),
    (1e3, "k"),
    (1.0, ""),
    (1e-3, "m"),
    (1e-6, "µ"),
    (1e-9, "n"),
    (1e-12, "p"),
    (1e-15, "f"),
    (1e-18, "a"),
];

/// The SI prefix that leaves one to three digits before the decimal point, and its factor.
pub(crate) fn prefix(size: f64) -> (f64, &'static str) {
    if size == 0.0 {
        return (1.0, "");
    }
    // Rounding may have made the number slightly less than a power of a thousand.
    PREFIXES.into_iter().find(|(factor, _)| size >= 0.999_999 * factor).unwrap_or(PREFIXES[PREFIXES.len() - 1])
}

/// Whether a unit takes a prefix: `kkg m/s` would be wrong.
pub(crate) fn takes_prefix(unit: &str) -> bool {
    !unit.is_empty() && !["kg", "rad"].iter().any(|without| unit.starts_with(without))
}

/// A quantity with three significant digits and, where its unit takes one, a prefix: `315 mm`. Beyond all prefixes it has a power of ten.
pub(crate) fn quantity(value: f64, unit: &str) -> String {
    let plain = if takes_prefix(unit) { 1e-18..1e21 } else { 1e-3..1e5 };
    let value = rounded(value, 3);
    match value.abs() {
        0.0 => format!("0 {unit}"),
        size if plain.contains(&size) => {
            let (factor, prefix) = if takes_prefix(unit) { prefix(size) } else { (1.0, "") };
            format!("{} {prefix}{unit}", rounded(value / factor, 3))
        }
        size if size.is_finite() => format!("{} {unit}", scientific(value)),
        _ => format!("{value} {unit}"),
    }
}

/// A number as a factor and, unless that is 1, a power of ten: `3×10⁵`.
pub(crate) fn scientific(value: f64) -> String {
    let text = format!("{value:e}");
    let (factor, power) = text.split_once('e').unwrap_or((&text, "0"));
    if power == "0" { factor.to_owned() } else { format!("{factor}×{}", power_of_ten(power.parse().unwrap_or(0))) }
}

/// A power of ten, typeset.
pub(crate) fn power_of_ten(power: i32) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match power {
        0 => "1".to_owned(),
        1 => "10".to_owned(),
        _ => {
            let digits = power.to_string();
            let raised = digits.chars().map(|sign| sign.to_digit(10).map_or('⁻', |digit| RAISED[digit as usize]));
            format!("10{}", raised.collect::<String>())
        }
    }
}

/// A number rounded to a number of significant digits.
pub(crate) fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

#[cfg(test)]
#[path = "../../tests/inside/captions.rs"]
mod tests;
