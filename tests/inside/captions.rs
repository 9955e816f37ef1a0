//! Descriptions of models and elements, and quantities with units.

use super::*;
use crate::sim::Dimension;
use crate::sim::model::mass_spring::MassSpring;
use crate::sim::model::shape_based::ShapeBased;

fn body(dimension: Dimension, rest: &[[f64; 3]], elements: &[&[u32]]) -> Body {
    let rest: Vec<_> = rest.iter().copied().map(DVec3::from_array).collect();
    let mass = vec![1.0; rest.len()];
    Body::builder(rest)
        .dimension(dimension)
        .elements(elements.iter().copied().collect())
        .masses(mass)
        .build()
        .expect("a body")
}

/// The corners of a box far from the origin, with one more node above it.
fn block(height: f64) -> Vec<[f64; 3]> {
    let corner = |at: u32| [7.3 + 0.1 * f64::from(at & 1), height * f64::from(at >> 1 & 1), 0.1 * f64::from(at >> 2)];
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
    assert_eq!(parts_and_constants(&shape, &one), "1 cube, k = 10 kN/m, ζ = 0.3");
    let full = "1 cube, k = 10 kN/m, ζ = 0.3, rotation robust (exact), damping of relative-motion, \
                as a material E = 200 kPa, ν = 0";
    assert_eq!(description(&shape, &one), full);
    let spring = MassSpring { stiffness: 50.0, damping: 0.0, springs: [[0, 1]].into(), breaks_at: None };
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
    let cases = [
        (0.0, "0 m"),
        (0.3149, "315 mm"),
        (-1234.0, "-1.23 km"),
        (1e-9, "1 nm"),
        (1e-17, "10 am"),
        (2.5e-20, "2.5×10⁻²⁰ m"),
    ];
    for (value, text) in cases {
        assert_eq!(quantity(value, "m"), text);
    }
    assert_eq!(quantity(f64::NAN, "m"), "NaN m");
    assert_eq!([quantity(1234.0, "kg m/s"), quantity(1e5, "Pa")], ["1230 kg m/s", "100 kPa"]);
}

#[test]
fn powers_are_written_with_raised_digits() {
    assert_eq!([-12, -3, 0, 1, 4].map(power_of_ten), ["10⁻¹²", "10⁻³", "1", "10", "10⁴"]);
}

#[test]
fn numbers_keep_their_first_digits() {
    assert_eq!([1234.5, 0.000_123_45, 99.96].map(|value| rounded(value, 3)), [1230.0, 0.000_123, 100.0]);
    assert!(rounded(f64::NAN, 3).is_nan());
}
