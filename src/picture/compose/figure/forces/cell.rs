//! The cells of a diagram of forces: their contents, and the places of their bodies.

use crate::picture::camera::{Framing, Lens};
use crate::picture::compose::Composer;
use crate::picture::compose::draft::Draft;
use crate::picture::layout::{Rectangle, Scale};
use crate::runner::moments;
use crate::scene::Scene;
use crate::sim::{RunFrame, Snapshot};
use glam::{DVec2, DVec3};

/// Room inside a cell above and below its contents (px in the reference picture).
const ROW_ROOM: [f64; 2] = [44.0, 22.0];

/// The contents of one cell.
pub(super) struct Cell<'a> {
    pub(super) composer: &'a Composer<'a>,
    pub(super) scene: &'a Scene,
    pub(super) frame: RunFrame,
    /// The force on each node over the stiffness (m): its arrow.
    pub(super) ways: Vec<DVec3>,
    /// The arrows of the run for comparison, with its index.
    pub(super) compared: Option<(usize, Vec<DVec3>)>,
    /// The nodes of the rest shape in its best fit (m), drawn faintly behind the body.
    pub(super) ghost: Vec<DVec3>,
    /// The camera of the scene, turned to the middle of the body.
    pub(super) framing: Framing,
    /// Left, top, width and height (px).
    pub(super) room: [f64; 4],
}

impl<'a> Cell<'a> {
    pub(super) fn new(
        composer: &'a Composer<'a>,
        runs: &[moments::Forces],
        run: usize,
        compare: Option<usize>,
        room: [f64; 4],
    ) -> Self {
        let scene = composer.scene;
        let snapshot = runs[run].snapshot.clone();
        let ways = |run: usize| {
            let stiffness = scene.runs[run].model.stiffness();
            runs[run].on_nodes.iter().map(|&force| force / stiffness).collect::<Vec<_>>()
        };
        Self {
            composer,
            scene,
            ways: ways(run),
            compared: compare.map(|run| (run, ways(run))),
            ghost: scene.body.rest.iter().map(|&at| snapshot.placement.place(at)).collect(),
            framing: {
                let middle = snapshot.placement.centre;
                Framing { target: middle, ..Framing::still(&scene.view.camera) }
            },
            frame: RunFrame::new(run, snapshot),
            room,
        }
    }

    pub(super) fn snapshot(&self) -> &Snapshot {
        &self.frame.snapshot
    }

    /// The middle of the nodes (m).
    pub(super) fn middle(&self) -> DVec3 {
        self.snapshot().placement.centre
    }

    /// The axes of the picture to the right and up.
    fn axes(&self) -> [DVec3; 2] {
        let camera = Framing::still(&self.scene.view.camera);
        let lens = Lens::new(&self.scene.view, &camera, self.scene.body.dimension, [0.0, 0.0, 64.0, 64.0], 1.0);
        [lens.right, lens.up]
    }

    /// The box around the contents, seen from far away: to the right and up from the middle of the body (m).
    fn extent(&self) -> [DVec2; 2] {
        let axes = self.axes();
        let position = &self.snapshot().position;
        let tips = |ways: &[DVec3]| position.iter().zip(ways).map(|(&at, &way)| at + way).collect::<Vec<_>>();
        let compared = self.compared.as_ref().map(|(_, ways)| tips(ways)).unwrap_or_default();
        let all = position.iter().chain(&self.ghost).copied().chain(tips(&self.ways)).chain(compared);
        let seen = all.map(|at| DVec2::from(axes.map(|axis| (at - self.middle()).dot(axis))));
        seen.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
    }

    /// The cell as a panel, seen at a scale (px/m) with the middle of its body at a pixel.
    pub(super) fn draft(&self, scale: Scale, pixels: f64, centre: DVec2) -> Draft<'_> {
        let [left, top, width, height] = self.room;
        let [right, bottom] = [left + width, top + height].map(|at| at.round() as u32);
        let [left, top] = [left, top].map(|at| at.round() as u32);
        let viewport: Rectangle = [left, top, right - left, bottom - top];
        let mut draft = Draft::new(self.composer, viewport, &self.frame, &self.framing, scale);
        let lens = &mut draft.lens;
        lens.focal = if lens.orthographic { pixels } else { pixels * self.framing.distance };
        lens.centre = centre.to_array();
        draft.element = pixels * draft.side;
        draft
    }
}

/// The largest scale at which all cells fit (px/m), and the pixel of the middle of each cell's body. Bodies are aligned
/// in columns and rows; rows share the height by their needs.
pub(super) fn fit(
    cells: &mut [Cell<'_>],
    columns: usize,
    side_room: f64,
    scale: Scale,
    has_names: bool,
) -> Option<(f64, Vec<DVec2>)> {
    let rows = cells.len() / columns;
    let extents: Vec<_> = cells.iter().map(Cell::extent).collect();
    let join = |one: [DVec2; 2], other: [DVec2; 2]| [one[0].min(other[0]), one[1].max(other[1])];
    let of_row = |row: usize| extents[row * columns..][..columns].iter().copied().reduce(join);
    let of_rows: Vec<[DVec2; 2]> = (0..rows).map(of_row).collect::<Option<_>>()?;
    let whole = of_rows.iter().copied().reduce(join)?;
    let [_, top, width, height] = cells.first()?.room;
    let unit = scale.unit;
    let [above, below] = [ROW_ROOM[usize::from(!has_names)], ROW_ROOM[1]].map(|length| scale.of_type(length) * unit);
    let needed: f64 = of_rows.iter().map(|[low, high]| high.y - low.y).sum();
    let across = (width - 2.0 * side_room) / (whole[1].x - whole[0].x).max(1e-9);
    let down = (height - rows as f64 * (above + below)) / needed.max(1e-9);
    let pixels = across.min(down);
    if !(pixels > 0.0 && pixels.is_finite()) {
        return None;
    }
    // Spare height goes between the rows.
    let spare = ((height - rows as f64 * (above + below) - needed * pixels) / rows as f64).max(0.0);
    let mut at = top;
    let mut centres = Vec::new();
    for (row, [low, high]) in of_rows.iter().enumerate() {
        let taken = above + below + spare + (high.y - low.y) * pixels;
        for cell in &mut cells[row * columns..][..columns] {
            cell.room[1] = at;
            cell.room[3] = taken;
            let middle = cell.room[0] + 0.5 * width;
            let x = middle - 0.5 * (whole[0].x + whole[1].x) * pixels;
            let y = at + above + 0.5 * spare + high.y * pixels;
            centres.push(DVec2::new(x, y).round());
        }
        at += taken;
    }
    Some((pixels, centres))
}
