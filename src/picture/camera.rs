//! The camera of a panel, in double precision.

use super::layout;
use super::narrow::narrow_row;
use crate::look::{Camera, Follow, View, axes};
use crate::sim::body::Dimension;
use glam::{DVec3, DVec4, Mat4};

/// How far below the middle of the room between the text the point looked at is, in parts of that room's height: bodies
/// rise.
const LOWERED: f64 = 0.037;
/// Which part of a panel's height that room is in the reference picture.
const REFERENCE_ROOM: f64 = 0.75;
/// The narrowest panel that shows a body at full size, in heights; in narrower ones everything shrinks alike.
const FULL_ASPECT: f64 = 640.0 / 720.0;
/// Which part of a panel's height bodies may use between titles and captions.
const USABLE_HEIGHT: f64 = 0.70;
/// How far aside of the middle bodies may be, in heights of a panel.
const USABLE_WIDTH: f64 = 0.39;
/// Below this rise, in distances of the camera, following hardly begins.
const GENTLE_RISE: f64 = 0.045;
/// The highest rise that is followed, in distances of the camera. Bodies that fly higher leave the picture.
const HIGHEST_RISE: f64 = 40.0;
/// So far does the camera lag behind a fall, in its own distances.
const GENTLE_FALL: f64 = 0.025;
/// The deepest fall that is followed, in distances of the camera.
const DEEPEST_FALL: f64 = 1e9;
/// Distance of the nearest thing drawn, as a part of the camera's distance.
const NEAR: f64 = 0.02;

/// What a camera looks at in one frame, alike in all panels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Framing {
    /// The point looked at (m).
    pub target: DVec3,
    /// Where the target is, or how deep it has sunk, before it rises with a body (m): the origin of all panels.
    pub base: DVec3,
    /// Distance from the target (m).
    pub distance: f64,
    /// How far the camera has risen above where a body stands, twice (m): the height that the picture shows more.
    pub rise: f64,
}

impl Framing {
    /// The framing of a camera that does not follow.
    pub(crate) fn still(camera: &Camera) -> Self {
        let Camera { target, distance, rise, .. } = *camera;
        Self { target, base: target, distance, rise }
    }
}

/// Where the middles of the bodies shown are in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Middles {
    /// The lowest corner of the box around them (m); infinite if no body is shown.
    pub low: DVec3,
    /// The highest corner of that box (m).
    pub high: DVec3,
    /// Where the middle of the body is at the start of the scene (m).
    pub start: DVec3,
}

impl Middles {
    /// Those of the bodies whose middles are given, in a scene where the body starts with its middle at `start` (m).
    pub(crate) fn new(middles: impl IntoIterator<Item = DVec3>, start: DVec3) -> Self {
        let none = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY, start };
        middles.into_iter().fold(none, |all, at| Self { low: all.low.min(at), high: all.high.max(at), start })
    }

    /// How far their common middle has gone level from the start (m), and half their distance then (m).
    fn level(&self) -> Option<(DVec3, f64)> {
        let level = |way: DVec3| DVec3::new(way.x, 0.0, way.z);
        let (gone, apart) = (level(self.low.midpoint(self.high) - self.start), level(self.high - self.low));
        (gone.is_finite() && apart.is_finite()).then(|| (gone, apart.length() / 2.0))
    }
}

/// Where the camera looks when the bodies shown are at their `middles`.
///
/// If it follows the height, it shows as much more height as the highest body has risen above the point looked at: half
/// of it by looking higher and all of it by drawing back. Where there is nothing that ends a fall (`bottomless`), it
/// first sinks with the lowest body. All of it begins gently, so that small bounces do not move the camera. If it
/// follows the body, it also goes along level with the common middle, at once and all the way, and draws back as far as
/// the bodies of the panels part.
pub(crate) fn framing(camera: &Camera, middles: &Middles, bottomless: bool) -> Framing {
    let Camera { target, distance, rise, .. } = *camera;
    let heights = [middles.low.y, middles.high.y];
    let pull = |length: f64, gentle: f64, most: f64| {
        let length = length.min(most * distance);
        if length > 0.0 { length * length / (length + gentle * distance) } else { 0.0 }
    };
    let (gone, apart) = match camera.follow {
        Follow::Nothing => return Framing::still(camera),
        Follow::Height => (DVec3::ZERO, 0.0),
        Follow::Body => middles.level().unwrap_or_default(),
    };
    let farthest = DEEPEST_FALL * distance;
    let target = target + gone.clamp(DVec3::splat(-farthest), DVec3::splat(farthest));
    let sink = if bottomless { pull(target.y - heights[0], GENTLE_FALL, DEEPEST_FALL) } else { 0.0 };
    let base = target - sink * DVec3::Y;
    let risen = pull(heights[1] - base.y, GENTLE_RISE, HIGHEST_RISE);
    let slope = 2.0 * libm::tan(camera.field_of_view / 2.0);
    let back = risen * libm::cos(camera.elevation) / (slope * USABLE_HEIGHT);
    let aside = pull(apart, GENTLE_RISE, HIGHEST_RISE) / (slope * USABLE_WIDTH);
    Framing { target: base + 0.5 * risen * DVec3::Y, base, distance: distance + back + aside, rise: rise + risen }
}

/// A camera at work on one panel: maps points of the world (m) to pixels of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lens {
    /// Where it stands (m).
    pub eye: DVec3,
    /// Unit vector to the right of the panel.
    pub right: DVec3,
    /// Unit vector up along the panel.
    pub up: DVec3,
    /// Unit vector away from the viewer.
    pub forward: DVec3,
    /// Pixels for a slope of one; in the plane, for one metre.
    pub focal: f64,
    /// The pixel of the point looked at.
    pub centre: [f64; 2],
    /// Distance of the nearest thing drawn (m).
    pub near: f64,
    /// Whether things keep their size at any distance.
    pub orthographic: bool,
}

impl Lens {
    /// The camera of a view for one panel, whose left, top, width and height are given (px), with type of `unit` times
    /// the reference size.
    pub(crate) fn new(view: &View, framing: &Framing, dimension: Dimension, panel: [f64; 4], unit: f64) -> Self {
        let camera = &view.camera;
        let [above, below] = layout::rooms(view, panel[3], unit);
        let room = (panel[3] - (above + below) * unit).max(0.1 * panel[3]);
        // Narrower margins have the effect of a larger panel with usual ones.
        let gained = layout::gained(view);
        let [across, along] = [0, 1].map(|axis| (panel[2 + axis] + gained[axis] * unit).max(0.1 * panel[2 + axis]));
        let height = along.min(across / FULL_ASPECT).min(room / REFERENCE_ROOM);
        let slope = height / 2.0 / libm::tan(camera.field_of_view / 2.0);
        let middle = (panel[3] + (above - below) * unit) / 2.0 + LOWERED * room;
        let centre = [panel[0] + panel[2] / 2.0, panel[1] + middle];
        let (azimuth, elevation) = match dimension {
            Dimension::Space => (camera.azimuth, camera.elevation),
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

    /// Whether a plane through `point` with an outward `normal` shows its outside.
    pub(crate) fn sees(&self, point: DVec3, normal: DVec3) -> bool {
        let view = if self.orthographic { self.forward } else { point - self.eye };
        normal.dot(view) < 0.0
    }

    /// The matrix from points relative to `origin`, in units of `unit` (m), to clip space of the panel. Its fourth
    /// coordinate is the distance along the view in that unit, so that nothing in it depends on how small or large a
    /// body is. Depth is 1 at the near plane and 0 infinitely far; in the plane it is ½ throughout, at a distance of 1.
    pub(crate) fn clip(&self, origin: DVec3, unit: f64, panel: [f64; 4]) -> Mat4 {
        let [left, top, width, height] = panel;
        let shift = [2.0 * (self.centre[0] - left) / width - 1.0, 1.0 - 2.0 * (self.centre[1] - top) / height];
        let row = |axis: DVec3, factor: f64| (axis * factor).extend((origin - self.eye).dot(axis) / unit * factor);
        let focal = if self.orthographic { self.focal * unit } else { self.focal };
        let x = row(self.right, 2.0 * focal / width);
        let y = row(self.up, 2.0 * focal / height);
        let away = if self.orthographic { DVec4::W } else { row(self.forward, 1.0) };
        let near = self.near_in(unit) * DVec4::W;
        let rows = [x + shift[0] * away, y + shift[1] * away, near, away].map(narrow_row);
        Mat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose()
    }

    /// Distance of the nearest thing drawn, in the terms of [`Self::clip`].
    pub(crate) fn near_in(&self, unit: f64) -> f64 {
        if self.orthographic { 0.5 } else { self.near / unit }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::narrow::narrow_point;

    fn at_heights(heights: [f64; 2]) -> Middles {
        let [low, high] = heights.map(|height| height * DVec3::Y);
        Middles { low, high, start: DVec3::ZERO }
    }

    const PANEL: [f64; 4] = [640.0, 0.0, 640.0, 720.0];

    fn view() -> View {
        View {
            camera: Camera {
                azimuth: 31_f64.to_radians(),
                elevation: 17_f64.to_radians(),
                field_of_view: 20_f64.to_radians(),
                target: DVec3::new(0.0, 0.15, 0.0),
                distance: 2.55,
                rise: 0.0,
                follow: Follow::Height,
            },
            columns: 2,
            side: 0.1,
            ..View::default()
        }
    }

    fn lens(highest: f64) -> Lens {
        let view = view();
        Lens::new(&view, &framing(&view.camera, &at_heights([highest; 2]), false), Dimension::Space, PANEL, 1.0)
    }

    #[test]
    fn the_target_stands_a_little_below_the_middle() {
        let (pixel, distance) = lens(0.0).project(DVec3::new(0.0, 0.15, 0.0)).unwrap();
        assert!((pixel[0] - 960.0).abs() < 1e-9 && (pixel[1] - 0.535 * 720.0).abs() < 1.0, "{pixel:?}");
        assert!((distance - 2.55).abs() < 1e-12);
    }

    #[test]
    fn a_body_at_rest_fills_a_third_of_the_height() {
        let lens = lens(0.15);
        let [low, high] = [0.0, 0.3].map(|y| lens.project(DVec3::new(0.0, y, 0.0)).unwrap().0[1]);
        assert!((225.0..245.0).contains(&(low - high)), "{}", low - high);
    }

    #[test]
    fn matrix_and_projection_agree() {
        let lens = lens(0.7);
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
    fn following_keeps_a_rising_body_and_the_floor_in_the_picture() {
        for step in 0..=140 {
            let height = 0.15 + f64::from(step) * 0.01;
            let lens = lens(height);
            for corner in 0..8 {
                let sign = |bit: usize| if corner >> bit & 1 == 1 { 0.15 } else { -0.15 };
                for centre in [0.15, height] {
                    let point = DVec3::new(sign(0), centre + sign(1), sign(2));
                    let (pixel, _) = lens.project(point).unwrap();
                    assert!((640.0 + 60.0..1280.0 - 60.0).contains(&pixel[0]), "{height}: {pixel:?}");
                    assert!((100.0..640.0).contains(&pixel[1]), "{height}: {pixel:?}");
                }
            }
        }
    }

    #[test]
    fn following_keeps_a_falling_body_in_the_picture() {
        let view = view();
        for step in 0..400 {
            let fallen = f64::from(step * step) * 0.01;
            for apart in [0.0, 0.5] {
                let heights = [0.15 - fallen, 0.15 - fallen + apart];
                let framing = framing(&view.camera, &at_heights(heights), true);
                let lens = Lens::new(&view, &framing, Dimension::Space, PANEL, 1.0);
                for corner in 0..16 {
                    let sign = |bit: usize| if corner >> bit & 1 == 1 { 0.15 } else { -0.15 };
                    let point = DVec3::new(sign(0), heights[corner >> 3] + sign(1), sign(2));
                    let (pixel, _) = lens.project(point).unwrap();
                    assert!((100.0..640.0).contains(&pixel[1]), "{fallen} {apart}: {pixel:?}");
                }
            }
        }
    }

    #[test]
    fn following_is_smooth_and_rests_near_the_floor() {
        let camera = view().camera;
        assert_eq!(framing(&camera, &at_heights([0.1; 2]), false).distance, camera.distance);
        assert!(framing(&camera, &at_heights([0.17; 2]), false).distance < 1.03 * camera.distance);
        let distances: Vec<_> =
            (0..3000).map(|step| framing(&camera, &at_heights([f64::from(step) * 0.001; 2]), false).distance).collect();
        for three in distances.windows(3) {
            let (first, second) = (three[1] - three[0], three[2] - three[1]);
            assert!(first >= 0.0 && (second - first).abs() < 1e-3 * camera.distance, "{three:?}");
        }
        for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            for follow in [Follow::Height, Follow::Body] {
                for bottomless in [false, true] {
                    let camera = Camera { follow, ..camera.clone() };
                    let middles = Middles { low: DVec3::splat(odd), high: DVec3::splat(odd), start: DVec3::ZERO };
                    let framing = framing(&camera, &middles, bottomless);
                    assert!(framing.target.is_finite() && framing.distance.is_finite(), "{odd}");
                }
            }
        }
    }

    #[test]
    fn following_the_body_goes_along_level_with_the_common_middle() {
        let height = view().camera;
        let camera = Camera { follow: Follow::Body, ..height.clone() };
        let start = DVec3::new(0.3, 0.15, -0.2);
        let together = framing(&camera, &Middles::new([start + 7.0 * DVec3::X; 2], start), false);
        let resting = framing(&height, &Middles::new([start; 2], start), false);
        assert!((together.target - resting.target).distance(7.0 * DVec3::X) < 1e-12);
        assert_eq!(together.distance, resting.distance);
        // Both bodies stay in the picture when they part.
        let view = View { camera: camera.clone(), ..view() };
        for step in 0..60 {
            let apart = 0.05 * f64::from(step);
            let middles = [-apart, apart].map(|x| DVec3::new(5.0 + x, 0.15, 0.0));
            let framing = framing(&camera, &Middles::new(middles, DVec3::new(0.0, 0.15, 0.0)), false);
            let lens = Lens::new(&view, &framing, Dimension::Space, PANEL, 1.0);
            for middle in middles {
                let (pixel, _) = lens.project(middle).unwrap();
                assert!((640.0 + 70.0..1280.0 - 70.0).contains(&pixel[0]), "{apart}: {pixel:?}");
            }
        }
        // Without any body that could be followed the camera is where it began.
        assert_eq!(framing(&camera, &Middles::new([], start), false).target, camera.target);
    }

    #[test]
    fn narrow_panels_show_the_body_smaller_not_cut() {
        let view = view();
        let framing = framing(&view.camera, &at_heights([0.0; 2]), false);
        let lens = Lens::new(&view, &framing, Dimension::Space, [0.0, 0.0, 200.0, 720.0], 0.37);
        let [left, right] = [-0.2, 0.2].map(|x| lens.project(DVec3::new(x, 0.15, 0.0)).unwrap().0[0]);
        assert!(20.0 < left && right < 180.0, "{left} {right}");
    }
}
