//! Models, elements, choices and quantities in words, for captions and messages.

use crate::sim::model::ElasticModel;
use crate::sim::{Body, ElementKind};
use glam::DVec3;
use serde::Serialize;

/// A model in short, for the second line of a picture: `27 cubes, k = 10 kN/m, ζ = 0.1`.
pub(crate) fn short_description(model: &dyn ElasticModel, body: &Body) -> String {
    parts_and_constants(model, body) + &model.unusual_choices(body)
}

/// A model with all choices that change the result, such as the rotation solver.
pub fn description(model: &dyn ElasticModel, body: &Body) -> String {
    parts_and_constants(model, body) + &model.choices(body)
}

fn parts_and_constants(model: &dyn ElasticModel, body: &Body) -> String {
    let parts = match (model.springs().len(), elements(body).as_slice()) {
        (1, _) => "1 spring".to_owned(),
        (0, [(count, name)]) => format!("{count} {name}"),
        (0, _) => format!("{} elements", body.elements.len()),
        (count, _) => format!("{count} springs"),
    };
    let (k, damping) = (model.stiffness(), model.damping());
    let mut text = format!("{parts}, k = {}", quantity(k, "N/m"));
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
        body.elements
            .iter()
            .zip(&body.kinds)
            .map(|(nodes, &kind)| (nodes, group(nodes, kind)))
            .filter(move |one| one.1 == wanted)
    };
    let names = |wanted: (ElementKind, usize)| match wanted {
        (Segment, _) => ["segment", "segments"],
        (Polygon, 3) | (Triangle, _) => ["triangle", "triangles"],
        (Polygon, 4) if of(wanted).all(|(nodes, _)| is_square(nodes, &body.rest)) => ["square", "squares"],
        (Polygon, 4) => ["quadrilateral", "quadrilaterals"],
        (Polygon, 5) => ["pentagon", "pentagons"],
        (Polygon, 6) => ["hexagon", "hexagons"],
        (Polygon, _) => ["polygon", "polygons"],
        (Tetrahedron, _) => ["tetrahedron", "tetrahedra"],
        (Pyramid, _) => ["pyramid", "pyramids"],
        (Wedge, _) => ["wedge", "wedges"],
        (Hexahedron, _) if of(wanted).all(|(nodes, _)| is_cube(nodes, &body.rest)) => ["cube", "cubes"],
        (Hexahedron, _) => ["hexahedron", "hexahedra"],
        (Other, _) if of(wanted).count() == body.elements.len() => ["element", "elements"],
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
pub(crate) fn typed(choice: &impl Serialize) -> String {
    serde_json::to_value(choice).ok().and_then(|name| name.as_str().map(String::from)).unwrap_or_default()
}

/// SI prefixes and their factors.
const PREFIXES: [(f64, &str); 7] =
    [(1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n")];

/// The SI prefix that leaves one to three digits before the decimal point, and its factor.
pub(crate) fn prefix(size: f64) -> (f64, &'static str) {
    // Rounding may have made the number slightly less than a power of a thousand.
    PREFIXES.into_iter().find(|(factor, _)| size >= 0.999_999 * factor).unwrap_or(PREFIXES[PREFIXES.len() - 1])
}

/// A quantity with three significant digits and a prefix of its unit: `315 mm`.
pub(crate) fn quantity(value: f64, unit: &str) -> String {
    match value.abs() {
        0.0 => format!("0 {unit}"),
        1e-9..1e12 => {
            let (factor, prefix) = prefix(value.abs());
            format!("{} {prefix}{unit}", rounded(value / factor, 3))
        }
        _ => format!("{value:.2e} {unit}"),
    }
}

/// A number rounded to so many significant digits.
pub(crate) fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::model::mass_spring::MassSpring;
    use crate::sim::model::shape_based::ShapeBased;
    use crate::sim::{Dimension, Solids};

    fn body(dimension: Dimension, rest: &[[f64; 3]], elements: &[&[u32]]) -> Body {
        let rest: Vec<_> = rest.iter().copied().map(DVec3::from_array).collect();
        let mass = vec![1.0; rest.len()];
        Body::new(dimension, rest, mass, elements.iter().copied().collect(), Solids::Ordered, None)
    }

    /// The corners of a box far from the origin, with one more node above it.
    fn block(height: f64) -> Vec<[f64; 3]> {
        let corner =
            |at: u32| [7.3 + 0.1 * f64::from(at & 1), height * f64::from(at >> 1 & 1), 0.1 * f64::from(at >> 2)];
        (0..8).map(corner).chain([[7.35, 1.0, 0.05]]).collect()
    }

    #[test]
    fn a_cube_is_a_hexahedron_with_equal_sides_and_right_angles() {
        let one: &[u32] = &[0, 1, 2, 3, 4, 5, 6, 7];
        let words = |rest: &[[f64; 3]]| elements(&body(Dimension::Space, rest, &[one]));
        assert_eq!(words(&block(0.1)), [(1, "cube")]);
        assert_eq!(words(&block(0.11)), [(1, "hexahedron")]);
        let mut bent = block(0.1);
        bent[7][0] += 0.01;
        assert_eq!(words(&bent), [(1, "hexahedron")]);
    }

    #[test]
    fn descriptions_have_parts_constants_and_choices() {
        let one = body(Dimension::Space, &block(0.1), &[&[0, 1, 2, 3, 4, 5, 6, 7]]);
        let shape = ShapeBased { damping: 60.0, ..ShapeBased::new(1e4) };
        assert_eq!(short_description(&shape, &one), "1 cube, k = 10 kN/m, ζ = 0.3, exact rotations");
        let full = "1 cube, k = 10 kN/m, ζ = 0.3, rotation robust (exact), damping of relative-motion";
        assert_eq!(description(&shape, &one), full);
        let spring = MassSpring { stiffness: 50.0, damping: 0.0, springs: [[0, 1]].into() };
        assert_eq!(description(&spring, &one), "1 spring, k = 50 N/m");
    }

    #[test]
    fn each_kind_has_its_count() {
        let (cube, top): (&[u32], &[u32]) = (&[0, 1, 2, 3, 4, 5, 6, 7], &[2, 3, 7, 6, 8]);
        let mixed = elements(&body(Dimension::Space, &block(0.1), &[cube, top, &[0, 1, 2], &[0, 1, 2, 3, 4, 5, 8]]));
        assert_eq!(mixed, [(1, "triangle"), (1, "pyramid"), (1, "cube"), (1, "other element")]);
        let plane = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let words = |lists: &[&[u32]]| elements(&body(Dimension::Plane, &plane, lists));
        assert_eq!(words(&[&[0, 1, 2], &[0, 2, 3]]), [(2, "triangles")]);
        assert_eq!(words(&[&[0, 1, 2, 3], &[0, 1, 2]]), [(1, "triangle"), (1, "square")]);
        let trapezium = [plane[0], plane[1], [0.9, 1.0, 0.0], plane[3]];
        assert_eq!(elements(&body(Dimension::Plane, &trapezium, &[&[0, 1, 2, 3]])), [(1, "quadrilateral")]);
    }

    #[test]
    fn quantities_have_three_digits_and_a_prefix() {
        let cases = [(0.0, "0 m"), (0.3149, "315 mm"), (-1234.0, "-1.23 km"), (1e-9, "1 nm"), (1e-17, "1.00e-17 m")];
        for (value, text) in cases {
            assert_eq!(quantity(value, "m"), text);
        }
        assert_eq!(quantity(f64::NAN, "m"), "NaN m");
    }

    #[test]
    fn numbers_keep_their_first_digits() {
        assert_eq!([1234.5, 0.000_123_45, 99.96].map(|value| rounded(value, 3)), [1230.0, 0.000_123, 100.0]);
        assert!(rounded(f64::NAN, 3).is_nan());
    }
}
