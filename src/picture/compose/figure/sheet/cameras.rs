//! The cameras of a sheet: all bodies are seen from the same distance, so that they can be compared, and none is cut.

use super::sheet_layout::SheetLayout;
use crate::look::Ghost;
use crate::picture::camera::{Framing, Lens};
use crate::picture::obstacle::{Site, Staging};
use crate::runner::history::NearObstacles;
use crate::runner::moments::Moments;
use crate::scene::Scene;
use crate::scene::figure::Sheet;
use crate::sim::geometry::{self, bounds};
use crate::sim::{Dimension, RunFrame, Shape, Snapshot, Status};
use glam::{DVec2, DVec3};

/// If bodies would be smaller than this part of their tiles, cameras follow the bodies column by column, and if that is
/// not enough, one by one.
const SMALLEST: f64 = 0.30;
/// The largest part of a tile that a body takes, even if the tile shows only a part of it.
const LARGEST: f64 = 0.8;
/// Bodies whose sizes differ by more than this factor are not shown at one scale.
const UNLIKE: f64 = 3.0;
/// The distance around the body up to which obstacles are considered (sizes of the body).
const AROUND: f64 = 1.0;
/// The share of spare room that is below bodies on the ground.
const BELOW_GROUND: f64 = 0.25;
/// A body is collapsed if no node is farther than this from a line (px).
const FLAT: f64 = 0.5;
/// Steps of the search; each reduces the error about ten times.
const STEPS: usize = 12;

/// The points that a tile must show.
pub(super) struct Cell {
    scene: usize,
    /// Corners (m).
    points: Vec<DVec3>,
}

/// The cells of a sheet, row by row.
pub(super) fn cells(scenes: &[Scene], reaches: &[NearObstacles], sheet: &Sheet, moments: &Moments) -> Vec<Vec<Cell>> {
    let cell = |column: usize, run: &RunFrame, others: &[RunFrame]| {
        let at = sheet.columns[column].scene;
        let ghost = ghost(&scenes[at], run, others);
        Cell { scene: at, points: points(&scenes[at], &reaches[at], run, ghost) }
    };
    let row = |(runs, others): (&Vec<RunFrame>, &Vec<Vec<RunFrame>>)| {
        runs.iter().zip(others).enumerate().map(|(column, (run, other))| cell(column, run, other)).collect()
    };
    moments.cells.iter().zip(&moments.others).map(row).collect()
}

/// The parts of the plates and walls of each scene near the shown nodes.
pub(super) fn reaches(scenes: &[Scene], sheet: &Sheet, moments: &Moments) -> Vec<NearObstacles> {
    let mut reaches = vec![NearObstacles::default(); scenes.len()];
    for (column, run) in moments.cells.iter().flat_map(|row| row.iter().enumerate()) {
        let (at, Snapshot { time, position, status, .. }) = (sheet.columns[column].scene, &run.snapshot);
        if *status == Status::Ok {
            reaches[at].add(&scenes[at], *time, position);
        }
    }
    reaches
}

/// The nodes of the body that is outlined over a run (m).
fn ghost(scene: &Scene, run: &RunFrame, others: &[RunFrame]) -> Vec<DVec3> {
    match scene.view.ghost {
        Some(Ghost::Rest) => scene.body.rest.iter().map(|&rest| run.snapshot.placement.place(rest)).collect(),
        Some(Ghost::Run(outlined)) => {
            let other = others.iter().find(|other| other.run == outlined);
            other.map_or_else(Vec::new, |other| other.snapshot.position.clone())
        }
        None => Vec::new(),
    }
}

/// The points of a run at a time (m): nodes, and obstacles and the nodes of a ghost near them.
fn points(scene: &Scene, reach: &NearObstacles, run: &RunFrame, ghost: Vec<DVec3>) -> Vec<DVec3> {
    let snapshot = run.shown();
    if snapshot.position.len() != scene.body.len() {
        return Vec::new();
    }
    let mut points = snapshot.position.clone();
    points.retain(|point| point.is_finite());
    if points.is_empty() {
        return points;
    }
    let extent = scene.body.extent();
    let (low, high) = bounds(&points);
    let [low, high] = [low - AROUND * extent, high + AROUND * extent];
    let lens =
        Lens::new(&scene.view, &Framing::still(&scene.view.camera), scene.body.dimension, [0.0, 0.0, 1.0, 1.0], 1.0);
    let site = Site {
        obstacles: &scene.obstacles,
        time: snapshot.time,
        frame: 1.0 / scene.frames_per_second,
        lens: &lens,
        origin: DVec3::ZERO,
        side: scene.view.side,
        extent,
        palette: &scene.view.look.palette(),
    };
    let start = bounds(&scene.initial.position).into();
    let position = &snapshot.position;
    let staging = Staging { site, cell: 1.0, ground: None, position, skin: None, soft: scene.view.side, start, reach };
    let mut near = Vec::new();
    for (at, obstacle) in scene.obstacles.iter().enumerate() {
        let pose = obstacle.pose(snapshot.time);
        let place = |point: DVec3| pose.apply(obstacle.pivot, point);
        let ball =
            |middle: DVec3, radius: f64| DVec3::AXES.map(|axis| [middle - radius * axis, middle + radius * axis]);
        match obstacle.shape {
            Shape::Floor { .. } => {}
            Shape::Plate { .. } if scene.body.dimension == Dimension::Space => {
                near.extend(staging.plate_corners(at).into_iter().flatten());
            }
            Shape::Plate { point, .. } => near.push(place(point)),
            Shape::Sphere { centre, radius } => near.extend(ball(place(centre), radius).concat()),
            Shape::Capsule { from, to, radius } => {
                near.extend([from, to].map(|end| ball(place(end), radius).concat()).concat());
            }
            Shape::Box { centre, half, rotation } => {
                let half = half.min(DVec3::splat(1e3 * extent));
                let corner = |at: i32| {
                    let sign = |bit: i32| if at >> bit & 1 == 1 { 1.0 } else { -1.0 };
                    place(centre + rotation * (half * DVec3::new(sign(0), sign(1), sign(2))))
                };
                near.extend((0..8).map(corner));
            }
        }
    }
    // Only the nearest part of distant objects is shown.
    let ghost = ghost.into_iter().filter(|point| point.is_finite());
    points.extend(near.into_iter().chain(ghost).map(|point| point.clamp(low, high)));
    points
}

/// The target and distance of the camera of each tile.
pub(super) fn framings(scenes: &[Scene], cells: &[Vec<Cell>], layout: &SheetLayout) -> Vec<Vec<Framing>> {
    let mut framings: Vec<Vec<_>> = cells
        .iter()
        .map(|row| row.iter().map(|cell| Framing::still(&scenes[cell.scene].view.camera)).collect())
        .collect();
    let classes = classes(scenes);
    let kinds = classes.iter().copied().max().map_or(0, |last| last + 1);
    for class in 0..kinds {
        let all: Vec<_> =
            (0..cells.len()).flat_map(|row| (0..cells[row].len()).map(move |column| [row, column])).collect();
        let own: Vec<_> = all.into_iter().filter(|&[row, column]| classes[cells[row][column].scene] == class).collect();
        let Some(&[row, column]) = own.first() else { continue };
        let scene = &scenes[cells[row][column].scene];
        let camera = TileCamera { scene, layout };
        // One view for all tiles, for each column, or for each tile.
        let ways: [fn([usize; 2]) -> [usize; 2]; 3] = [|_| [0, 0], |[_, column]| [0, column], |place| place];
        for (at, way) in ways.iter().enumerate() {
            let mut groups: Vec<([usize; 2], Vec<[usize; 2]>)> = Vec::new();
            for &place in &own {
                match groups.iter_mut().find(|(key, _)| *key == way(place)) {
                    Some((_, places)) => places.push(place),
                    None => groups.push((way(place), vec![place])),
                }
            }
            let points: Vec<Vec<DVec3>> = groups
                .iter()
                .map(|(_, places)| {
                    places.iter().flat_map(|&[row, column]| &cells[row][column].points).copied().collect()
                })
                .collect();
            let distance = points.iter().map(|points| camera.fit(points).distance).fold(camera.nearest(), f64::max);
            if at + 1 < ways.len() && camera.share(distance) < SMALLEST {
                continue;
            }
            for ((_, places), points) in groups.iter().zip(&points) {
                let framing = camera.aim(points, distance);
                places.iter().for_each(|&[row, column]| framings[row][column] = framing);
            }
            break;
        }
    }
    framings
}

/// The classes of scenes that are shown at one scale: the same direction of view, and bodies of similar sizes.
fn classes(scenes: &[Scene]) -> Vec<usize> {
    let alike = |one: &Scene, other: &Scene| {
        let [a, b] = [&one.view.camera, &other.view.camera];
        let sizes = [one, other].map(|scene| scene.body.extent().max(f64::MIN_POSITIVE));
        let ratio = sizes[0] / sizes[1];
        one.body.dimension == other.body.dimension
            && (a.azimuth, a.elevation, a.field_of_view) == (b.azimuth, b.elevation, b.field_of_view)
            && (1.0 / UNLIKE..=UNLIKE).contains(&ratio)
    };
    let mut firsts: Vec<usize> = Vec::new();
    let class = |at: usize| {
        firsts.iter().position(|&first| alike(&scenes[first], &scenes[at])).unwrap_or_else(|| {
            firsts.push(at);
            firsts.len() - 1
        })
    };
    (0..scenes.len()).map(class).collect()
}

/// The camera of a tile, independent of the tile's place.
struct TileCamera<'a> {
    scene: &'a Scene,
    layout: &'a SheetLayout,
}

impl TileCamera<'_> {
    fn lens(&self, framing: &Framing) -> Lens {
        let [width, height] = self.layout.tile_size().map(f64::from);
        let view = &self.scene.view;
        Lens::new(view, framing, self.scene.body.dimension, [0.0, 0.0, width, height], self.layout.tile_scale.unit)
    }

    fn framing(target: DVec3, distance: f64) -> Framing {
        Framing { target, distance, moves: false }
    }

    /// Pixels per metre at a distance (m).
    fn pixels(&self, distance: f64) -> f64 {
        let lens = self.lens(&Self::framing(DVec3::ZERO, distance));
        lens.focal / if lens.orthographic { 1.0 } else { distance }
    }

    /// The share of the room for bodies that the body at rest takes at a distance (m).
    fn share(&self, distance: f64) -> f64 {
        let [left, top, right, bottom] = self.layout.body_room();
        self.pixels(distance) * self.scene.body.extent() / (right - left).min(bottom - top).max(1.0)
    }

    /// The least distance of any tile (m).
    fn nearest(&self) -> f64 {
        // Pixels per metre fall with the distance.
        let usual = self.usual();
        usual * self.share(usual) / LARGEST
    }

    fn usual(&self) -> f64 {
        self.scene.view.camera.distance.max(f64::MIN_POSITIVE)
    }

    /// The nearest framing with all points in the room for bodies.
    fn fit(&self, points: &[DVec3]) -> Framing {
        let mut framing = self.start(points, self.usual());
        let [left, top, right, bottom] = self.layout.body_room();
        for _ in 0..STEPS {
            let lens = self.lens(&framing);
            let Some((low, high)) = seen(&lens, points) else {
                framing.distance *= 2.0;
                continue;
            };
            let wanted = DVec2::new(right - left, bottom - top).max(DVec2::ONE);
            let times = ((high - low) / wanted).max_element().max(1e-3);
            framing = self.centred(&lens, &framing, (low, high));
            framing.distance *= times;
        }
        framing
    }

    /// The framing at a distance (m) with points in the middle of the room for bodies.
    fn aim(&self, points: &[DVec3], distance: f64) -> Framing {
        let mut framing = self.start(points, distance);
        for _ in 0..STEPS {
            let lens = self.lens(&framing);
            let Some((low, high)) = seen(&lens, points) else { break };
            framing = self.centred(&lens, &framing, (low, high));
        }
        framing
    }

    fn start(&self, points: &[DVec3], distance: f64) -> Framing {
        let (low, high) = bounds(points);
        let target = if points.is_empty() { self.scene.view.camera.target } else { low.midpoint(high) };
        Self::framing(target, distance)
    }

    /// The framing moved so that a box of the picture (px) is in the middle of the room for bodies, or lower if there
    /// is ground.
    fn centred(&self, lens: &Lens, framing: &Framing, (low, high): (DVec2, DVec2)) -> Framing {
        let [left, top, right, bottom] = self.layout.body_room();
        let has_ground = geometry::ground(&self.scene.obstacles, 0.0).is_some();
        let below = if has_ground { BELOW_GROUND } else { 0.5 } * ((bottom - top) - (high.y - low.y)).max(0.0);
        let wanted =
            DVec2::new((left + right) / 2.0, (bottom - below - (high.y - low.y) / 2.0).max((top + bottom) / 2.0));
        let off = (low.midpoint(high) - wanted) / self.pixels(framing.distance);
        Self::framing(framing.target + off.x * lens.right - off.y * lens.up, framing.distance)
    }
}

/// The ends of a collapsed body as a line in its tile (px), or the same point twice; `None` for other bodies.
pub(super) fn collapsed(
    scene: &Scene,
    layout: &SheetLayout,
    [row, column]: [usize; 2],
    framing: &Framing,
    run: &RunFrame,
) -> Option<[DVec2; 2]> {
    let [left, top, ..] = layout.tile(row, column).map(f64::from);
    let lens = TileCamera { scene, layout }.lens(framing);
    let nodes = run.shown().position.iter();
    let pixels: Option<Vec<_>> =
        nodes.map(|&node| Some(DVec2::from(lens.project(node)?.0) + DVec2::new(left, top))).collect();
    let pixels = pixels.filter(|_| run.snapshot.status == Status::Ok)?;
    let farthest = |from: DVec2| {
        pixels.iter().copied().max_by(|a, b| a.distance_squared(from).total_cmp(&b.distance_squared(from)))
    };
    let one = farthest(*pixels.first()?)?;
    let other = farthest(one)?;
    let along = (other - one).normalize_or_zero();
    let off = |pixel: &DVec2| if along == DVec2::ZERO { 0.0 } else { along.perp_dot(*pixel - one).abs() };
    (pixels.len() > 1 && pixels.iter().all(|pixel| off(pixel) < FLAT)).then_some([one, other])
}

/// The box around points on the picture (px); `None` if there are none, or not all are in front of the camera.
fn seen(lens: &Lens, points: &[DVec3]) -> Option<(DVec2, DVec2)> {
    let mut ends = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for &point in points {
        let pixel = DVec2::from(lens.project(point)?.0);
        ends = (ends.0.min(pixel), ends.1.max(pixel));
    }
    (!points.is_empty()).then_some(ends)
}
