//! The floor of a panel, its grid and its shadows.

use super::bodies::Bodies;
use super::draft::Draft;
use crate::look::{CameraBox, CameraBoxes, FloorStyle, axes, azimuths};
use crate::picture::Floor;
use crate::picture::compose::obstacle::Staged;
use crate::picture::layout;
use crate::picture::layout::steps::{MARGIN, NEAR};
use crate::picture::narrow::{narrow, narrow_point};
use crate::picture::shadow::{Casters, Plane, Shade, key_light};
use crate::picture::shell::{boundaries, triangles};
use crate::runner::history::History;
use crate::scene::Scene;
use crate::sim::geometry;
use crate::sim::{Motion, Obstacle, Shape};
use glam::DVec3;

/// The distances at which floor, grid and shadow begin and end to fade (sizes of the body around the target).
const FLOOR_FADE: [f64; 2] = [0.7, 2.0];
/// The floor extends farther by the distance of the shadow beyond the first distance from the target, at most by the
/// third one; the second one smooths the start (sizes of the body).
const STILL_NEAR: f64 = 0.5;
const GENTLY: f64 = 0.3;
const FARTHEST_SHADOW: f64 = 2.0;
/// Distance of the camera above which the floor is wider (sizes of the body).
const USUAL_DISTANCE: f64 = 12.0;
/// The most grid cells across a body, so that its lines are a side apart or more: for a lattice, whose cells the grid
/// repeats, and for any other body, beside which a fine grid would distract.
const MOST_CELLS: [f64; 2] = [10.0, 5.0];
/// The least sine of a floor's angle for which its grid is wide enough to show no moiré.
const FLATTEST: f64 = 0.2;
/// The darkness of the shadow of a body without surfaces, relative to one with surfaces.
const SHEER: f64 = 0.38;

/// The greatest distance (m) on the ground of the shadow of a body from the middle of all, in a course before a camera that follows them; `None`
/// without a course.
pub(super) fn shadow_way(scene: &Scene, history: &History) -> Option<f64> {
    let camera = &scene.view.camera;
    let azimuth = azimuths(camera).nth(history.azimuth()).unwrap_or(camera.azimuth);
    let key = key_light(axes(azimuth, camera.elevation)[0]);
    let way = |(&time, seen): (&f64, &CameraBoxes)| {
        let (normal, height) = geometry::ground(&scene.obstacles, time)?;
        let plane = Plane::new(normal, height - normal.dot(seen.centre));
        let of_body = |body: &CameraBox| plane.shadow(body.centre - seen.centre, key).length();
        seen.bodies.iter().map(of_body).reduce(f64::max)
    };
    let sound = history.series.iter().filter(|series| !series.diverges());
    sound.flat_map(|series| series.times.iter().zip(&series.boxes)).filter_map(way).reduce(f64::max)
}

impl Draft<'_> {
    /// The ground, if there is any.
    pub(super) fn floor(&self, staged: &Staged) -> Option<Floor> {
        if self.flat {
            return None;
        }
        let (normal, height) = geometry::ground(&self.scene.obstacles, self.snapshot.time)?;
        let (plane, anchor) = self.plane(normal, height);
        let view = &self.scene.view;
        let farther = self.farther(&plane);
        let fade = FLOOR_FADE.map(|sizes| sizes * self.composer.extent / self.side * self.widening() + farther);
        let cell = self.cell();
        let grid = plane.axes.map(|axis| narrow(((self.origin - anchor) / self.side).dot(axis).rem_euclid(cell)));
        let rooms = layout::rooms(view, f64::from(self.viewport[3]), self.scale.unit);
        // No grid lies behind words above and below the body. Without words the floor extends to the border.
        let has_words = self.clear != self.viewport;
        let fade_at_words = rooms.map(|room| if has_words { (room + MARGIN) * self.scale.unit } else { 0.5 });
        Some(Floor {
            normal: narrow_point(plane.normal),
            axes: plane.axes.map(narrow_point),
            height: narrow(plane.height),
            cell: narrow(cell),
            grid,
            fade: fade.map(narrow),
            fade_at_words: fade_at_words.map(narrow),
            is_filled: view.floor != FloorStyle::None,
            has_grid: view.floor == FloorStyle::Grid,
            shades: self.shadows(staged, &plane, fade[1]),
        })
    }

    /// The extra width of the floor (sides), so that the shadow of a body that moves away or flies high still falls on it. It is the same in
    /// all frames of a camera that stands still, and of one that follows a known course.
    fn farther(&self, plane: &Plane) -> f64 {
        let size = self.composer.extent / self.side;
        // A smooth start.
        let wider = |beyond: f64| beyond * beyond / (beyond + GENTLY * size);
        if !self.framing.moves {
            return wider(FARTHEST_SHADOW * size);
        }
        let now = || {
            let middles = self.bodies.nodes().map(|nodes| self.centre(nodes));
            let gone = middles.map(|middle| plane.shadow((middle - self.origin) / self.side, self.key).length());
            gone.fold(0.0, f64::max)
        };
        let gone = match self.composer.shadow_way {
            Some(way) => way / self.side,
            None if self.diverged || self.position.is_empty() => return 0.0,
            None => now(),
        };
        wider((gone - STILL_NEAR * size).clamp(0.0, FARTHEST_SHADOW * size))
    }

    /// The plane of the ground, and a point on lines of its grid (m): the origin of the world, moved with the floor.
    fn plane(&self, normal: DVec3, height: f64) -> (Plane, DVec3) {
        let time = self.snapshot.time;
        let mut plane = Plane::new(normal, (height - normal.dot(self.origin)) / self.side);
        let mut anchor = DVec3::ZERO;
        let moving = |one: &&Obstacle| one.motion != Motion::Still && one.floor(time) == Some((normal, height));
        if let Some(moving) = self.scene.obstacles.iter().find(moving)
            && let Shape::Floor { normal, .. } = moving.shape
        {
            let pose = moving.pose(time);
            plane.axes = Plane::new(normal, 0.0).axes.map(|axis| pose.rotation * axis);
            anchor = pose.apply(moving.pivot, DVec3::ZERO);
        }
        (plane, anchor)
    }

    /// The shadows of key light and sky, within `reach` of the point on the ground below the target (sides).
    fn shadows(&self, staged: &Staged, plane: &Plane, reach: f64) -> [Shade; 2] {
        let mut shades = if self.scene.view.shadow && self.key.dot(plane.normal) > 0.05 {
            self.casters(staged).shades(plane, self.key, reach, self.bodies.soft)
        } else {
            std::array::from_fn(|_| Shade { corner: [0.0; 2], length: 1.0, cells: Vec::new() })
        };
        // A body without surfaces lets most light through.
        if !self.scene.view.visible.surfaces {
            let cells = shades.iter_mut().flat_map(|shade| &mut shade.cells);
            cells.for_each(|cell| *cell = (f64::from(*cell) * SHEER).round() as u8);
        }
        shades
    }

    /// The shadow casters: body and solid obstacles.
    fn casters(&self, staged: &Staged) -> Casters {
        let Bodies { skin, seams, .. } = self.bodies;
        let relative = |at: &DVec3| (at - self.origin) / self.side;
        let broken = &self.snapshot.broken;
        let mut casters = Casters::default();
        if let Some(nodes) = self.skin.get(..skin.nodes.len()).filter(|_| !broken.contains(&true)) {
            casters.extend(nodes.iter().map(relative), &skin.triangles, seams, skin.triangles.len());
        } else if !self.skin.is_empty() {
            let [mut sides, _] = boundaries(self.body, &[], broken);
            sides.retain(|side| !self.is_covered(side));
            casters.add(self.position.iter().map(relative), &triangles(self.body, &sides));
        }
        let mut carried = self.carried();
        for fine in skin.fine.iter().filter(|_| !self.skin.is_empty()) {
            let (own, others) = carried.split_at(fine.surface.rest.len());
            let gone = fine.gone(self.bodies.assembly, broken);
            if gone.is_empty() {
                casters.add_shape(fine.shape.points.iter().map(|&at| relative(&own[at as usize])), &fine.shape);
            } else {
                let whole = fine.surface.triangles.iter().zip(gone).filter(|(_, gone)| !gone);
                casters.add(own.iter().map(relative), &whole.map(|(&triangle, _)| triangle).collect::<Vec<_>>());
            }
            carried = others;
        }
        casters.add(staged.shadow_points.iter().map(relative), &staged.shadow_triangles);
        casters
    }

    /// The factor by which the floor is wider than usual: distant parts fade at about the same place in the panel. A
    /// camera that a scene places far away shows more than a body, on one floor throughout.
    pub(super) fn widening(&self) -> f64 {
        let usual = USUAL_DISTANCE * self.composer.extent;
        let farther = (self.framing.distance / usual).max(1.0);
        if self.scene.view.camera.follow { farther.sqrt() } else { farther }
    }

    /// The distance of the grid's lines (sides).
    pub(super) fn cell(&self) -> f64 {
        let camera = &self.scene.view.camera;
        let most = MOST_CELLS[usize::from(!self.scene.view.has_cells)];
        // Cameras do not zoom, so cells are the same in all frames.
        let pixels =
            self.lens.focal * self.side / self.framing.distance * libm::sin(camera.elevation).abs().max(FLATTEST);
        cell(self.composer.extent / self.side, most, NEAR / pixels)
    }
}

/// The distance of the grid's lines (sides) for a body of an extent (sides), which spans at most `most` cells, and no
/// less than `least` (sides): 1, 2, 5, 10, 20, …
fn cell(extent: f64, most: f64, least: f64) -> f64 {
    let mut cells = 1.0;
    for factor in [2.0, 2.5, 2.0].into_iter().cycle().take(36) {
        if extent / cells <= most && cells >= least {
            break;
        }
        cells *= factor;
    }
    cells
}
