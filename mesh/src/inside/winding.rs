//! Triangles, and the parts of a sphere about a point that they hide.

use glam::{DVec2, DVec3};

/// Triangles, and the parts of a sphere that they hide.
pub(super) struct Caps {
    pub(super) triangles: Vec<[DVec3; 3]>,
    /// A binary tree in depth-first order; empty without triangles.
    nodes: Vec<Lump>,
}

/// Neighbouring triangles.
struct Lump {
    range: std::ops::Range<usize>,
    /// The mean of their middles, by area.
    middle: DVec3,
    /// From points farther away than this they look like one.
    reach: f64,
    /// The sum of their normals with the length of their area.
    area: DVec3,
    /// The node after this one and those below it.
    next: usize,
}

impl Caps {
    pub(super) fn new(triangles: Vec<[DVec3; 3]>) -> Self {
        let mut caps = Self { nodes: Vec::new(), triangles };
        if !caps.triangles.is_empty() {
            caps.build(0..caps.triangles.len());
        }
        caps
    }

    fn build(&mut self, range: std::ops::Range<usize>) {
        let triangles = &mut self.triangles[range.clone()];
        let middle = |[a, b, c]: &[DVec3; 3]| (*a + *b + *c) / 3.0;
        let (mut sum, mut weight, mut area) = (DVec3::ZERO, 0.0, DVec3::ZERO);
        for triangle in &*triangles {
            let [a, b, c] = *triangle;
            let own = 0.5 * (b - a).cross(c - a);
            // Triangles without area count a little, lest the sum be empty.
            let size = own.length() + f64::MIN_POSITIVE;
            sum += middle(triangle) * size;
            weight += size;
            area += own;
        }
        let mean = sum / weight;
        let radius = triangles.as_flattened().iter().map(|corner| corner.distance(mean)).fold(0.0, f64::max);
        // At this distance the errors of all lumps are together one or two hundredths, far less than matters to what is above ½. The
        // error of one is about its area times its radius by the third power of the distance.
        let reach = (2.0 * radius).max(2.7 * libm::cbrt(weight * radius));
        let at = self.nodes.len();
        let many = triangles.len() > 4;
        if many {
            let low = triangles.iter().map(middle).reduce(DVec3::min).unwrap_or(DVec3::ZERO);
            let high = triangles.iter().map(middle).reduce(DVec3::max).unwrap_or(DVec3::ZERO);
            let axis = (high - low).max_position();
            triangles.sort_by(|a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
        }
        self.nodes.push(Lump { range: range.clone(), middle: mean, reach, area, next: 0 });
        if many {
            let half = range.start.midpoint(range.end);
            self.build(range.start..half);
            self.build(half..range.end);
        }
        self.nodes[at].next = self.nodes.len();
    }

    /// The part of the sphere about a point that the triangles hide.
    pub(super) fn winding(&self, point: DVec3) -> f64 {
        let (mut sum, mut at, mut near) = (0.0, 0, HalfAngle::default());
        while let Some(lump) = self.nodes.get(at) {
            let to = lump.middle - point;
            let distance = to.length();
            if distance > lump.reach {
                sum += to.dot(lump.area) / (distance * distance * distance);
                at = lump.next;
            } else if lump.next == at + 1 {
                near.add(&self.triangles[lump.range.clone()], point);
                at = lump.next;
            } else {
                at += 1;
            }
        }
        (sum + near.solid_angle()) / (4.0 * std::f64::consts::PI)
    }
}

/// Half the solid angle of triangles seen from a point, positive from behind: a vector in a plane that each triangle turns by its own, so
/// that one arc tangent is enough, and its whole turns.
pub(super) struct HalfAngle {
    vector: DVec2,
    turns: f64,
}

impl Default for HalfAngle {
    fn default() -> Self {
        Self { vector: DVec2::X, turns: 0.0 }
    }
}

impl HalfAngle {
    /// Adds a few triangles, whose vectors are lengths to the third power.
    pub(super) fn add(&mut self, triangles: &[[DVec3; 3]], point: DVec3) {
        for half in triangles.iter().filter_map(|triangle| half_angle(triangle, point)) {
            let next = self.vector.rotate(half);
            let [was_left, turns_left, is_left] = [self.vector, half, next].map(|vector| vector.y >= 0.0);
            if was_left == turns_left && is_left != was_left {
                self.turns += if turns_left { 1.0 } else { -1.0 };
            }
            self.vector = next;
        }
        self.vector = self.vector.normalize_or(DVec2::X);
    }

    pub(super) fn solid_angle(&self) -> f64 {
        2.0 * (libm::atan2(self.vector.y, self.vector.x) + std::f64::consts::TAU * self.turns)
    }
}

/// A vector at the angle of half the solid angle of a triangle (A. van Oosterom and J. Strackee, 1983). There is none on the plane of the
/// triangle: on the triangle itself, half of the sphere is hidden from one side and half from the other.
fn half_angle(triangle: &[DVec3; 3], point: DVec3) -> Option<DVec2> {
    let [a, b, c] = triangle.map(|corner| corner - point);
    let [la, lb, lc] = [a, b, c].map(DVec3::length);
    let volume = a.dot(b.cross(c));
    (volume != 0.0).then(|| DVec2::new(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb, volume))
}
