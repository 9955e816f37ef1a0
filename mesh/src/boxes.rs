//! Boxes by their places.

use glam::{DVec3, I64Vec3};
use std::ops::Range;

/// Boxes with their lowest and highest corners, and cells of space with those that meet each, in rising order.
pub(crate) struct Boxes {
    all: Vec<(DVec3, DVec3)>,
    low: DVec3,
    cell: f64,
    counts: I64Vec3,
    starts: Vec<usize>,
    items: Vec<u32>,
}

impl Boxes {
    /// Boxes in a grid between two corners of space, with cells of this side, or larger ones if there were far more cells than boxes, as
    /// about a slanted rod.
    pub(crate) fn new(all: Vec<(DVec3, DVec3)>, (low, high): (DVec3, DVec3), mut cell: f64) -> Self {
        let counts = |cell: f64| ((high - low) / cell).floor() + 1.0;
        while counts(cell).element_product() > 16.0 * all.len() as f64 + 65536.0 {
            cell *= 2.0;
        }
        let (counts, items) = (counts(cell).as_i64vec3(), Vec::new());
        let starts = vec![0; counts.element_product() as usize + 1];
        let mut boxes = Self { all, low, cell, counts, starts, items };
        let mut starts = boxes.starts.clone();
        boxes.visit(|cell, _| starts[cell + 1] += 1);
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let (mut ends, mut items) = (starts.clone(), vec![0; starts[starts.len() - 1]]);
        boxes.visit(|cell, item| {
            items[ends[cell]] = item;
            ends[cell] += 1;
        });
        (boxes.starts, boxes.items) = (starts, items);
        boxes
    }

    /// Calls `visit` with each box and each cell that it meets.
    fn visit(&self, mut visit: impl FnMut(usize, u32)) {
        for (item, &(low, high)) in (0..).zip(&self.all) {
            self.rows(low, high).flatten().for_each(|cell| visit(cell, item));
        }
    }

    /// The boxes in each cell that are there.
    pub(crate) fn in_cells(&self) -> impl Iterator<Item = &[u32]> {
        self.starts.windows(2).map(|ends| &self.items[ends[0]..ends[1]])
    }

    pub(crate) fn meet(&self, one: u32, (low, high): (DVec3, DVec3)) -> bool {
        let own = self.all[one as usize];
        own.0.cmple(high).all() && own.1.cmpge(low).all()
    }

    /// The boxes that hold a point.
    pub(crate) fn around(&self, point: DVec3) -> impl Iterator<Item = u32> {
        self.at(self.cell(point)).iter().copied().filter(move |&item| self.meet(item, (point, point)))
    }

    /// The boxes that meet a box; some of them several times.
    pub(crate) fn within(&self, low: DVec3, high: DVec3) -> impl Iterator<Item = u32> {
        let rows = self.rows(low, high).flat_map(|row| &self.items[self.starts[row.start]..self.starts[row.end]]);
        rows.copied().filter(move |&item| self.meet(item, (low, high)))
    }

    /// The nearest of the triangles in the boxes to a point, and its distance, up to a greatest one.
    pub(crate) fn nearest(&self, corners: impl Fn(u32) -> [DVec3; 3], point: DVec3, most: f64) -> Option<(u32, f64)> {
        let cell = self.cell(point);
        let (mut best, mut nearest) = (None, most);
        for ring in 0.. {
            // Those in this ring are at least so far away.
            if nearest <= (ring - 1) as f64 * self.cell {
                break;
            }
            for at in self.ring(cell, ring) {
                // Most cells beside that of the point are empty, or farther away than what is there.
                let items = self.at(at);
                if items.is_empty() || self.gap(at, point) > nearest {
                    continue;
                }
                for &item in items {
                    let (low, high) = self.all[item as usize];
                    if point.distance_squared(point.clamp(low, high)) > nearest * nearest {
                        continue;
                    }
                    let distance = point.distance(nearest_of(corners(item), point));
                    if distance < nearest || (distance == nearest && best.is_none_or(|best| item < best)) {
                        (best, nearest) = (Some(item), distance);
                    }
                }
            }
        }
        Some((best?, nearest))
    }

    /// The cell of a point, which may be outside of the grid.
    fn cell(&self, point: DVec3) -> I64Vec3 {
        ((point - self.low) / self.cell).floor().clamp(DVec3::splat(-1e9), DVec3::splat(1e9)).as_i64vec3()
    }

    /// The cell of a point by its place in lists, if there is one.
    pub(crate) fn place(&self, point: DVec3) -> Option<usize> {
        self.index(self.cell(point))
    }

    fn index(&self, cell: I64Vec3) -> Option<usize> {
        let is_in = cell.cmpge(I64Vec3::ZERO).all() && cell.cmplt(self.counts).all();
        is_in.then(|| ((cell.z * self.counts.y + cell.y) * self.counts.x + cell.x) as usize)
    }

    fn at(&self, cell: I64Vec3) -> &[u32] {
        self.index(cell).map_or(&[], |cell| &self.items[self.starts[cell]..self.starts[cell + 1]])
    }

    /// The cells that a box meets, by their places in lists: those beside each other along x together.
    fn rows(&self, low: DVec3, high: DVec3) -> impl Iterator<Item = Range<usize>> + use<> {
        let (low, high) = (self.cell(low).max(I64Vec3::ZERO), self.cell(high).min(self.counts - 1));
        let (counts, length) = (self.counts, high.x - low.x + 1);
        let rows = (low.z..=high.z).flat_map(move |z| (low.y..=high.y).map(move |y| [y, z]));
        let first = move |[y, z]: [i64; 2]| ((z * counts.y + y) * counts.x + low.x) as usize;
        rows.filter(move |_| length > 0).map(first).map(move |first| first..first + length as usize)
    }

    /// How far a cell is from a point, less what round-off may add.
    fn gap(&self, cell: I64Vec3, point: DVec3) -> f64 {
        let (at, low) = ((point - self.low) / self.cell, cell.as_dvec3());
        self.cell * (at.distance(at.clamp(low, low + 1.0)) - 1e-6)
    }

    /// The cells that are so many cells away along an axis, and no farther along others.
    fn ring(&self, middle: I64Vec3, ring: i64) -> impl Iterator<Item = I64Vec3> + use<> {
        let along = move || -ring..=ring;
        let rows = along().flat_map(move |z| along().map(move |y| [y, z]));
        rows.flat_map(move |[y, z]| {
            let is_whole = y.abs() == ring || z.abs() == ring;
            let step = if is_whole { 1 } else { 2 * ring as usize };
            along().step_by(step).map(move |x| middle + I64Vec3::new(x, y, z))
        })
    }
}

/// The point of a triangle that is nearest to another point (m). The triangle may be a line or a point.
pub(crate) fn nearest_of([a, b, c]: [DVec3; 3], point: DVec3) -> DVec3 {
    let on_line = |from: DVec3, to: DVec3| {
        let along = to - from;
        from + along * (along.dot(point - from) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
    };
    let normal = (b - a).cross(c - a);
    let is_left = |from: DVec3, to: DVec3| normal.dot((to - from).cross(point - from)) >= 0.0;
    if normal != DVec3::ZERO && is_left(a, b) && is_left(b, c) && is_left(c, a) {
        return point - normal * (normal.dot(point - a) / normal.length_squared());
    }
    let sides = [on_line(a, b), on_line(b, c), on_line(c, a)];
    let nearer = |one: DVec3, other: DVec3| {
        if other.distance_squared(point) < one.distance_squared(point) { other } else { one }
    };
    nearer(nearer(sides[0], sides[1]), sides[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No point of a triangle is nearer, and some are as near. One without area has its nearest point, too.
    #[test]
    fn no_point_of_a_triangle_is_nearer() {
        let triangle = [DVec3::new(0.1, 0.0, 0.2), DVec3::new(1.0, 0.3, 0.0), DVec3::new(0.2, 0.9, -0.3)];
        let flat = [triangle[0], triangle[1], triangle[0].lerp(triangle[1], 0.5)];
        for triangle in [triangle, flat, [triangle[0]; 3]] {
            let [a, b, c] = triangle;
            for at in 0..1000u32 {
                let point = DVec3::from_array([at % 10, at / 10 % 10, at / 100].map(|n| f64::from(n) * 0.3 - 1.2));
                let place = nearest_of(triangle, point);
                let areas = [[a, b], [b, c], [c, a]].map(|[from, to]| (from - place).cross(to - place).length());
                let whole = (b - a).cross(c - a).length();
                assert!((areas.iter().sum::<f64>() - whole).abs() < 1e-12, "{point}: {place} is not in the triangle");
                let least = place.distance(point);
                let all = (0..=20).flat_map(|i| (0..=20 - i).map(move |j| [i, j].map(f64::from)));
                let all = all.map(|[i, j]| a + (b - a) * i / 20.0 + (c - a) * j / 20.0);
                let nearest = all.map(|at| at.distance(point)).fold(f64::INFINITY, f64::min);
                assert!((least - 1e-12..least + 0.05).contains(&nearest), "{point}: {least} {nearest}");
            }
        }
    }

    #[test]
    fn a_grid_has_no_more_cells_than_boxes_need() {
        let boxes: Vec<_> = (0..1000).map(|n| DVec3::splat(100.0 * f64::from(n))).map(|low| (low, low + 1.0)).collect();
        let grid = Boxes::new(boxes.clone(), (DVec3::ZERO, DVec3::splat(1e5)), 1.0);
        assert!(grid.counts.element_product() < 100_000);
        for (item, &(low, _)) in (0u32..).zip(&boxes) {
            assert!(grid.around(low + 0.5).any(|found| found == item));
        }
        assert_eq!(Boxes::new(boxes, (DVec3::ZERO, DVec3::splat(40.0)), 1.0).cell, 1.0);
    }
}
