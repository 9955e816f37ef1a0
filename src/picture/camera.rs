//! The camera of a panel, in double precision.

use super::layout;
use super::narrow::narrow_rows;
use crate::look::{Camera, View, axes};
use crate::sim::Dimension;
use glam::{DVec3, DVec4, Mat4};

/// The distance of the target below the middle of the room between the text, in heights of that room: bodies rise.
const LOWERED: f64 = 0.032;
/// The height of that room in the reference picture, in heights of the panel.
const REFERENCE_ROOM: f64 = 0.75;
/// The narrowest panel that shows a body at full size, in heights. In narrower ones the whole scene is smaller.
const FULL_ASPECT: f64 = 640.0 / 720.0;
/// Distance of the near plane, relative to the camera's distance.
const NEAR: f64 = 0.02;

/// The target, distance and azimuth of the camera of a panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Framing {
    /// The point looked at, the origin of the panel (m).
    pub target: DVec3,
    /// Distance from the target (m).
    pub distance: f64,
    /// Azimuth of the camera (rad), as in [`Camera`].
    pub azimuth: f64,
    /// Whether the framing differs between frames.
    pub moves: bool,
}

impl Framing {
    /// The framing of a camera that stands still.
    pub(crate) fn still(camera: &Camera) -> Self {
        let Camera { target, distance, azimuth, .. } = *camera;
        Self { target, distance, azimuth, moves: false }
    }
}

/// The camera of one panel: maps points of the world (m) to pixels of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lens {
    /// Its position (m).
    pub eye: DVec3,
    /// Unit vector to the right of the panel.
    pub right: DVec3,
    /// Unit vector up along the panel.
    pub up: DVec3,
    /// Unit vector away from the viewer.
    pub forward: DVec3,
    /// Pixels for a slope of one; in the plane, for one metre.
    pub focal: f64,
    /// The pixel of the target.
    pub centre: [f64; 2],
    /// Distance of the near plane (m).
    pub near: f64,
    /// Whether sizes do not depend on the distance.
    pub orthographic: bool,
}

impl Lens {
    /// The camera of a view for one panel, whose left, top, width and height are given (px), with type of `unit` times
    /// the reference size.
    pub(crate) fn new(view: &View, framing: &Framing, dimension: Dimension, panel: [f64; 4], unit: f64) -> Self {
        let camera = &view.camera;
        let [above, below] = layout::rooms(view, panel[3], unit);
        let room = (panel[3] - (above + below) * unit).max(0.1 * panel[3]);
        let height = panel[3].min(panel[2] / FULL_ASPECT).min(room / REFERENCE_ROOM);
        let slope = height / 2.0 / libm::tan(camera.field_of_view / 2.0);
        let middle = (panel[3] + (above - below) * unit) / 2.0 + LOWERED * room;
        let centre = [panel[0] + panel[2] / 2.0, panel[1] + middle];
        let (azimuth, elevation) = match dimension {
            Dimension::Space => (framing.azimuth, camera.elevation),
            Dimension::Plane => (0.0, 0.0),
        };
        let [right, up, towards] = axes(azimuth, elevation);
        let orthographic = dimension == Dimension::Plane;
        Self {
            eye: framing.target + framing.distance * towards,
            right,
            up,
            forward: -towards,
            focal: if orthographic { slope / framing.distance } else { slope },
            centre,
            near: NEAR * framing.distance,
            orthographic,
        }
    }

    /// The pixel of a point, and its distance along the view (m); `None` for points not in front of the camera.
    pub(crate) fn project(&self, point: DVec3) -> Option<([f64; 2], f64)> {
        let from_eye = point - self.eye;
        let distance = from_eye.dot(self.forward);
        let scale = if self.orthographic { self.focal } else { self.focal / distance };
        let ahead = self.orthographic || distance >= self.near;
        let pixel = [self.centre[0] + scale * from_eye.dot(self.right), self.centre[1] - scale * from_eye.dot(self.up)];
        (ahead && pixel.iter().all(|at| at.is_finite())).then_some((pixel, distance))
    }

    /// The cosine of the angle between an outward `normal` at `point` and the direction to the viewer; 0 without a normal.
    pub(crate) fn facing(&self, point: DVec3, normal: DVec3) -> f64 {
        let view = if self.orthographic { self.forward } else { point - self.eye };
        let cosine = -normal.dot(view) / (normal.length() * view.length());
        if cosine.is_finite() { cosine } else { 0.0 }
    }

    /// Whether the camera sees the outside of a plane through `point` with an outward `normal`.
    pub(crate) fn sees(&self, point: DVec3, normal: DVec3) -> bool {
        let view = if self.orthographic { self.forward } else { point - self.eye };
        normal.dot(view) < 0.0
    }

    /// The matrix from points relative to `origin`, in units of `unit` (m), to clip space of the panel. Its fourth
    /// coordinate is the distance along the view in that unit, so its entries do not depend on the size of the body.
    /// Depth is 1 at the near plane and 0 infinitely far; in the plane it is ½ throughout, at a distance of 1.
    pub(crate) fn clip(&self, origin: DVec3, unit: f64, panel: [f64; 4]) -> Mat4 {
        let [left, top, width, height] = panel;
        let shift = [2.0 * (self.centre[0] - left) / width - 1.0, 1.0 - 2.0 * (self.centre[1] - top) / height];
        let row = |axis: DVec3, factor: f64| (axis * factor).extend((origin - self.eye).dot(axis) / unit * factor);
        let focal = if self.orthographic { self.focal * unit } else { self.focal };
        let x = row(self.right, 2.0 * focal / width);
        let y = row(self.up, 2.0 * focal / height);
        let away = if self.orthographic { DVec4::W } else { row(self.forward, 1.0) };
        let near = self.near_in(unit) * DVec4::W;
        narrow_rows([x + shift[0] * away, y + shift[1] * away, near, away])
    }

    /// Distance of the near plane, in the unit of [`Self::clip`].
    pub(crate) fn near_in(&self, unit: f64) -> f64 {
        if self.orthographic { 0.5 } else { self.near / unit }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::narrow::narrow_point;

    const PANEL: [f64; 4] = [640.0, 0.0, 640.0, 720.0];

    fn view() -> View {
        View {
            camera: Camera {
                azimuth: 31_f64.to_radians(),
                elevation: 17_f64.to_radians(),
                field_of_view: 20_f64.to_radians(),
                target: DVec3::new(0.0, 0.15, 0.0),
                distance: 2.55,
                follow: false,
                turns: false,
            },
            columns: Some(2),
            side: 0.1,
            ..View::default()
        }
    }

    fn lens() -> Lens {
        let view = view();
        Lens::new(&view, &Framing::still(&view.camera), Dimension::Space, PANEL, 1.0)
    }

    #[test]
    fn the_target_stands_a_little_below_the_middle() {
        let (pixel, distance) = lens().project(DVec3::new(0.0, 0.15, 0.0)).unwrap();
        assert!((pixel[0] - 960.0).abs() < 1e-9 && (pixel[1] - 0.535 * 720.0).abs() < 1.0, "{pixel:?}");
        assert!((distance - 2.55).abs() < 1e-12);
    }

    #[test]
    fn a_body_at_rest_fills_a_third_of_the_height() {
        let lens = lens();
        let [low, high] = [0.0, 0.3].map(|y| lens.project(DVec3::new(0.0, y, 0.0)).unwrap().0[1]);
        assert!((225.0..245.0).contains(&(low - high)), "{}", low - high);
    }

    #[test]
    fn matrix_and_projection_agree() {
        let lens = lens();
        let (origin, unit) = (DVec3::new(0.1, 0.2, 0.3), 0.1);
        let clip = lens.clip(origin, unit, PANEL);
        for point in [DVec3::ZERO, DVec3::new(0.2, 0.4, -0.1), DVec3::new(-0.3, 1.0, 0.4)] {
            let at = clip * narrow_point((point - origin) / unit).extend(1.0);
            let (pixel, distance) = lens.project(point).unwrap();
            let x = PANEL[0] + PANEL[2] * f64::from(0.5 + 0.5 * at.x / at.w);
            let y = PANEL[1] + PANEL[3] * f64::from(0.5 - 0.5 * at.y / at.w);
            assert!((x - pixel[0]).abs() < 1e-3 && (y - pixel[1]).abs() < 1e-3, "{x} {y} {pixel:?}");
            assert!((f64::from(at.z / at.w) - lens.near / distance).abs() < 1e-6);
            assert!((f64::from(at.w) - distance / unit).abs() < 1e-5, "{at}");
        }
    }

    #[test]
    fn narrow_panels_show_the_body_smaller_not_cut() {
        let view = view();
        let framing = Framing::still(&view.camera);
        let lens = Lens::new(&view, &framing, Dimension::Space, [0.0, 0.0, 200.0, 720.0], 0.37);
        let [left, right] = [-0.2, 0.2].map(|x| lens.project(DVec3::new(x, 0.15, 0.0)).unwrap().0[0]);
        assert!(20.0 < left && right < 180.0, "{left} {right}");
    }
}
