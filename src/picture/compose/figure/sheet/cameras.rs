//! The cameras of a sheet: one scale for all bodies that can be compared, and one view for the tiles of a column.

use super::sheet_layout::SheetLayout;
use crate::look::CameraBoxes;
use crate::picture::camera::Framing;
use crate::picture::compose::draft::Draft;
use crate::picture::framing::{self, Seen, SeenMoment};
use crate::runner::RunFrame;
use crate::runner::history::NearObstacles;
use crate::runner::moments::Moments;
use crate::scene::Scene;
use crate::scene::figure::Sheet;
use crate::sim::geometry;
use glam::DVec2;
use std::borrow::Cow;

/// Bodies whose sizes differ by more than this factor are not shown at one scale.
const UNLIKE: f64 = 3.0;
/// A body is collapsed if no node is farther than this from a line (px).
const FLAT: f64 = 0.5;

/// The target and distance of the cameras of each column.
pub(super) fn framings(scenes: &[Scene], sheet: &Sheet, moments: &Moments, layout: &SheetLayout) -> Vec<Framing> {
    let scene = |column: usize| &scenes[sheet.columns[column].scene];
    let [left, top, right, bottom] = layout.body_room();
    let room = [left, top, right - left, bottom - top];
    let columns = 0..sheet.columns.len();
    let mut framings: Vec<_> = columns.clone().map(|column| Framing::still(&scene(column).view.camera)).collect();
    let mut kinds: Vec<Vec<(usize, Seen)>> = Vec::new();
    for column in columns {
        let moment = |run: &RunFrame| {
            let (shown, scene, is_sound) = (run.shown(), scene(column), !run.has_diverged());
            let seen = CameraBoxes::new(&scene.view, &scene.runs[run.run].bodies, &shown.position)?;
            Some(SeenMoment { time: shown.time, run: run.run, seen: Cow::Owned(seen), is_sound })
        };
        let of_runs: Vec<_> = moments.cells.iter().filter_map(|row| moment(&row[column])).collect();
        let Some(seen) = Seen::new(scene(column), 0, &of_runs, false) else { continue };
        match kinds.iter_mut().find(|kind| are_alike([kind[0].0, column].map(scene))) {
            Some(kind) => kind.push((column, seen)),
            None => kinds.push(vec![(column, seen)]),
        }
    }
    for kind in kinds {
        let first = scene(kind[0].0);
        let [width, height] = layout.tile_size;
        let lens = framing::from_a_metre(first, [0, 0, width, height], layout.tile_scale);
        let mut of_columns: Vec<_> = kind.iter().map(|(_, seen)| *seen).collect();
        if geometry::ground(&first.obstacles, 0.0).is_some() {
            Seen::level(&mut of_columns);
        }
        for ((column, _), shot) in kind.iter().zip(framing::shots(&of_columns, &lens, room, 1.0)) {
            framings[*column] = Framing {
                target: shot.offset,
                distance: lens.focal / shot.pixels,
                azimuth: shot.azimuth,
                moves: false,
            };
        }
    }
    framings
}

/// Whether scenes are shown at one scale: the same direction of view, and bodies of similar sizes.
fn are_alike([one, other]: [&Scene; 2]) -> bool {
    let seen = [one, other].map(|scene| {
        let camera = &scene.view.camera;
        (scene.dimension(), camera.azimuth, camera.elevation, camera.field_of_view)
    });
    let [small, large] = [one, other].map(Scene::extent);
    seen[0] == seen[1] && small.max(large) <= UNLIKE * small.min(large)
}

/// The parts of the plates and walls of each scene near the shown nodes.
pub(super) fn reaches(scenes: &[Scene], sheet: &Sheet, moments: &Moments) -> Vec<NearObstacles> {
    let mut reaches = vec![NearObstacles::default(); scenes.len()];
    for (column, run) in moments.cells.iter().flat_map(|row| row.iter().enumerate()) {
        let at = sheet.columns[column].scene;
        if !run.has_diverged() {
            reaches[at].add(&scenes[at], &scenes[at].runs[run.run], run.snapshot.time, &run.snapshot.position);
        }
    }
    reaches
}

/// The ends of a collapsed body as a line in its tile (px), or the same point twice; `None` for other bodies.
pub(super) fn collapsed(draft: &Draft<'_>) -> Option<[DVec2; 2]> {
    let pixels = draft.position.iter().map(|&node| draft.lens.project(node).map(|(pixel, _)| DVec2::from(pixel)));
    let pixels: Vec<_> = pixels.collect::<Option<_>>().filter(|_| !draft.greyed)?;
    let farthest = |from: DVec2| {
        pixels.iter().copied().max_by(|a, b| a.distance_squared(from).total_cmp(&b.distance_squared(from)))
    };
    let one = farthest(*pixels.first()?)?;
    let other = farthest(one)?;
    let along = (other - one).normalize_or_zero();
    let off = |pixel: &DVec2| if along == DVec2::ZERO { 0.0 } else { along.perp_dot(*pixel - one).abs() };
    (pixels.len() > 1 && pixels.iter().all(|pixel| off(pixel) < FLAT)).then_some([one, other])
}
