//! Boxes around points, and which of them are near each other.

use super::surface::Surface;
use glam::DVec3;

/// A box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub(super) low: DVec3,
    pub(super) high: DVec3,
}

impl Extent {
    /// The box around all points of a surface, whose nodes are at these places (m).
    pub(super) fn of(surface: &Surface, at: &[DVec3]) -> Self {
        match surface.lever > 1.0 {
            true => Self::around(surface.places(at)),
            false => Self::around(surface.nodes.iter().map(|&node| at[node as usize])),
        }
    }

    pub(super) fn around(points: impl Iterator<Item = DVec3>) -> Self {
        let none = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
        points.fold(none, |Self { low, high }, point| Self { low: low.min(point), high: high.max(point) })
    }

    pub(super) fn grown(self, by: f64) -> Self {
        Self { low: self.low - by, high: self.high + by }
    }

    pub(super) fn common(&self, other: &Self) -> Self {
        Self { low: self.low.max(other.low), high: self.high.min(other.high) }
    }

    fn meets(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }

    /// The distance between two boxes (m).
    pub(super) fn distance(&self, other: &Self) -> f64 {
        (self.low - other.high).max(other.low - self.high).max(DVec3::ZERO).length()
    }

    pub(super) fn size(&self) -> DVec3 {
        self.high - self.low
    }

    /// Its two longest axes, the longest first.
    pub(super) fn longest_axes(&self) -> [usize; 2] {
        let (size, mut axes) = (self.size(), [0, 1, 2]);
        axes.sort_by(|&one, &other| size[other].total_cmp(&size[one]));
        [axes[0], axes[1]]
    }

    pub(super) fn middle(&self) -> DVec3 {
        0.5 * (self.low + self.high)
    }

    /// The greatest coordinate (m).
    pub(super) fn farthest(&self) -> f64 {
        self.low.abs().max(self.high.abs()).max_element()
    }
}

/// The features whose boxes meet a box.
pub(super) fn near(features: impl Iterator<Item = (u32, Extent)>, common: &Extent) -> Vec<(u32, Extent)> {
    features.filter(|(_, extent)| extent.meets(common)).collect()
}

/// Calls `found` with the features whose boxes are nearer than a reach (m) along each axis, by a sweep along one axis in rows across it.
pub(super) fn sweep(
    [one, other]: [&Vec<(u32, Extent)>; 2],
    reach: f64,
    [axis, across]: [usize; 2],
    mut found: impl FnMut([u32; 2]),
) {
    // The last row has all that is beyond.
    let rows = (other.len() / 16).clamp(1, 256);
    let widest = |axis: usize| other.iter().map(|(_, extent)| extent.high[axis] - extent.low[axis]).fold(0.0, f64::max);
    let (long, wide) = (widest(axis), widest(across));
    let least = other.iter().map(|(_, extent)| extent.low[across]).fold(f64::INFINITY, f64::min);
    let row = |at: f64| ((at - least) / (wide + 2.0 * reach)).clamp(0.0, (rows - 1) as f64) as usize;
    let of = |(_, extent): &(u32, Extent)| row(extent.low[across]);
    let mut sorted = other.clone();
    sorted.sort_by(|a, b| of(a).cmp(&of(b)).then(a.1.low[axis].total_cmp(&b.1.low[axis])));
    let mut begins = vec![0; rows + 1];
    sorted.iter().for_each(|one| begins[of(one) + 1] += 1);
    (0..rows).for_each(|row| begins[row + 1] += begins[row]);
    for (first, extent) in one {
        let grown = extent.grown(reach);
        for row in row(grown.low[across] - wide)..=row(grown.high[across]) {
            let sorted = &sorted[begins[row]..begins[row + 1]];
            let from = sorted.partition_point(|(_, other)| other.low[axis] < grown.low[axis] - long);
            let beside = sorted[from..].iter().take_while(|(_, other)| other.low[axis] <= grown.high[axis]);
            beside.filter(|(_, other)| grown.meets(other)).for_each(|(second, _)| found([*first, *second]));
        }
    }
}
