//! Lines over lit bodies, as items: edges, contours, springs and nodes. Their visibility is tested with the depths of the
//! picture, once for each pixel of their length.

use super::panel::palette;
use crate::gpu::Layers;
use crate::picture::measures::{ALARM_EDGE_WIDTH, BAR_ALPHA, BAR_WIDTH, CASING, LEAST_CASING, edging};
use crate::picture::{
    Bead, Colour, Item, Line, LineKind, Paint, Palette, PaneCorner, Panel, Path, Pen, Picture, Rectangle, Second, Step,
    Stroke,
};
use glam::{DVec2, DVec3, DVec4, Vec2, Vec3};
use std::collections::HashSet;

/// Widths of edges and contours (px in the reference picture), from the widest contour to the narrowest.
const EDGE_WIDTH: f32 = 1.15;
const HIDDEN_WIDTH: f32 = 0.9;
const OUTLINE_WIDTH: f32 = 2.0;
const FOLD_WIDTH: f32 = 1.7;
const STEP_WIDTH: f32 = 1.5;
/// Opacities of visible and of hidden edges, and of contours inside the body and behind it.
const EDGE_ALPHA: f32 = 0.80;
const HIDDEN_ALPHA: f32 = 0.16;
const STEP_ALPHA: f32 = 0.85;
const FOLD_ALPHA: f32 = 0.80;
/// Opacities of edges of turned-over elements: visible, behind other elements, and behind turned-over ones.
const ALARM_ALPHAS: [f32; 3] = [0.95, 0.62, 0.15];
/// Folds inside the turned-over set of elements smaller than this (px) are fainter.
const SMALL_FOLDED: f32 = 8.0;
/// Width (px in the reference picture) and opacity of the edges of plates.
const PLATE_EDGE: f32 = 1.35;
const PLATE_EDGE_ALPHA: f32 = 0.86;
/// The opacity of a plate in front of bodies, relative to its own, as in the shader.
const OVER_BODIES: f32 = 0.6;

/// Lines of turned-over elements, springs and nodes are this much nearer (sides), like surfaces of turned-over elements.
pub(super) const NEARER: f32 = 0.02;
/// A line lies this much in front of its surface, relative to the distance, and fades over the second range of depths in
/// front of the surface and behind it, so that it does not appear suddenly.
const OFFSET: f32 = 0.0016;
const FADED: f32 = 0.0008;
/// From this step of depth on, a contour inside the body is drawn (soft units).
const STEP: f32 = 0.22;
/// Below this step (soft units) an obstacle does not hide its own contour or that of another.
const ROUND_STEP: f32 = 0.8;

/// Places in the pixel around a point, in different rows and columns. All together represent the pixel.
const TAPS: [Vec2; 4] =
    [Vec2::new(0.125, 0.375), Vec2::new(-0.375, 0.125), Vec2::new(0.375, -0.125), Vec2::new(-0.125, -0.375)];
/// The exponent by which the painter, which blends bytes (sRGB), comes near blending of linear light.
const IN_BYTES: f32 = 0.55;
/// The number of opacities of lines.
const LEVELS: usize = 8;

/// A panel with the depths of its bodies.
#[derive(Debug)]
pub(super) struct Tested<'a> {
    pub(super) panel: &'a Panel,
    /// The opacities of pixels, and the depths of all bodies and of turned-over elements alone.
    marks: &'a [[u8; 4]],
    depths: &'a [f32],
    alone: Option<&'a [f32]>,
    stride: usize,
    /// The corners of plates (px and depth), with the part of a line that each leaves visible behind it.
    plates: Vec<(Vec<Vec3>, f32)>,
}

impl<'a> Tested<'a> {
    pub(super) fn new(panel: &'a Panel, layers: Layers<'a>, has_behind: bool) -> Self {
        let alone = has_behind.then(|| layers.of(2));
        let (marks, depths, stride) = (layers.of(0), layers.of(1), layers.stride());
        let tested = Self { panel, marks, depths, alone, stride, plates: Vec::new() };
        let corner = |corner: &PaneCorner| tested.place(tested.clipped(corner.position), 0.0).as_vec3();
        let panes = panel.obstacles.panes.iter().filter(|pane| !pane.grid);
        let plates = panes.map(|pane| (pane.corners.iter().map(corner).collect(), 1.0 - OVER_BODIES * pane.alpha));
        Self { plates: plates.collect(), ..tested }
    }

    /// A point in clip space. Double precision keeps lines that reach far beyond the picture in their places.
    fn clipped(&self, at: [f32; 3]) -> DVec4 {
        self.panel.sight.clip.as_dmat4() * Vec3::from(at).as_dvec3().extend(1.0)
    }

    /// The place of a point in clip space in the picture (px), and its depth, this much nearer (sides). Depths are linear on
    /// the screen, like places.
    fn place(&self, at: DVec4, nearer: f32) -> DVec3 {
        let [left, top, width, height] = self.panel.viewport.map(f64::from);
        let near = f64::from(self.panel.sight.near);
        let share = DVec2::new(at.x, -at.y) / at.w.max(near) * 0.5 + 0.5;
        let depth = at.z / (at.w - f64::from(nearer)).max(near);
        (DVec2::new(left, top) + share * DVec2::new(width, height)).extend(depth)
    }

    /// The part of a line that plates in front of it leave visible.
    fn through_plates(&self, at: &Sample) -> f32 {
        let is_before = |corners: &[Vec3]| {
            let around = || corners.iter().zip(corners.iter().cycle().skip(1));
            let side = |(a, b): (&Vec3, &Vec3)| (b - a).truncate().perp_dot(at.middle - a.truncate());
            if around().map(side).any(|side| side < 0.0) && around().map(side).any(|side| side > 0.0) {
                return false;
            }
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let off = (at.middle - corners[0].truncate()).dot(normal.truncate());
            corners[0].z - off / normal.z > at.depth * (1.0 + OFFSET)
        };
        self.plates.iter().filter(|(corners, _)| is_before(corners)).map(|(_, left)| left).product()
    }

    /// The place of the pixel at a point, or of the nearest pixel of the region.
    pub(super) fn pixel(&self, at: Vec2) -> usize {
        let [left, top, width, height] = self.panel.region;
        let within = |at: f32, start: u32, length: u32| (at.max(0.0) as u32).clamp(start, start + length - 1) as usize;
        within(at.y, top, height) * self.stride + within(at.x, left, width)
    }

    /// The depth of bodies at a point: 0 on the ground.
    pub(super) fn depth(&self, at: Vec2) -> f32 {
        self.depths[self.pixel(at)]
    }

    /// The depth of turned-over elements alone.
    pub(super) fn depth_alone(&self, at: Vec2) -> f32 {
        self.alone.map_or(0.0, |depths| depths[self.pixel(at)])
    }

    /// The opacity of an obstacle at a point; 0 on bodies and ground.
    fn obstacle(&self, at: Vec2) -> f32 {
        match self.marks[self.pixel(at)][3] {
            u8::MAX => 0.0,
            opacity => f32::from(opacity) / 254.0,
        }
    }

    pub(super) fn distance(&self, depth: f32) -> f32 {
        self.panel.sight.near / depth.max(1e-9)
    }

    /// The part of a line in a rectangle (px), this much nearer (sides).
    pub(super) fn segment(&self, ends: [[f32; 3]; 2], within: Rectangle, nearer: f32) -> Option<Segment> {
        let near = f64::from(self.panel.sight.near);
        let [mut a, mut b] = ends.map(|end| self.clipped(end));
        if a.w < near && b.w < near {
            return None;
        }
        if a.w < near {
            a = a.lerp(b, (near - a.w) / (b.w - a.w));
        } else if b.w < near {
            b = b.lerp(a, (near - b.w) / (a.w - b.w));
        }
        let [from, to] = [a, b].map(|end| self.place(end, nearer));
        let [left, top, width, height] = within.map(f64::from);
        let room = [DVec2::new(left, top), DVec2::new(left + width, top + height)];
        let [start, end] = shares_within(from.truncate(), to.truncate(), room)?;
        Some(Segment([start, end].map(|share| from.lerp(to, share).as_vec3())))
    }

    /// The visibility of an edge, and the part of it behind a body.
    fn edge(&self, at: &Sample) -> [f32; 2] {
        // A face seen at a grazing angle has points in front of its edge a pixel nearer to the viewer. So the farther side
        // counts.
        let across = 0.75 * at.along.perp();
        mean(|tap| {
            let middle = at.middle + tap;
            let beside = [self.depth(middle + across), self.depth(middle - across)];
            let farthest = beside.into_iter().filter(|&depth| depth > 0.0).fold(self.depth(middle), f32::min);
            let seen = at.visible(farthest);
            // Obstacles hide all edges.
            [seen, if seen < 1.0 && self.obstacle(middle) > 0.0 { 0.0 } else { 1.0 - seen }]
        })
    }

    /// The share of a contour that is outer outline, that is a step of depth inside the body, and that is hidden.
    fn contour(&self, at: &Sample, of_obstacle: bool) -> [f32; 3] {
        let normal = at.along.perp();
        let across = normal * (0.9 + 1.3 * self.panel.sight.line_scale);
        let (soft, distance) = (self.panel.sight.soft, self.distance(at.depth));
        let step = STEP * soft;
        mean(|tap| {
            let middle = at.middle + tap;
            let here = self.depth(middle);
            let places = [middle + across, middle - across];
            let sides = [self.depth(places[0]), self.depth(places[1])];
            let obstacles = [self.obstacle(places[0]) > 0.0, self.obstacle(places[1]) > 0.0];
            let (nearer, farther) = (sides[0].max(sides[1]), sides[0].min(sides[1]));
            // Surfaces that end in a contour are seen at a grazing angle, and come much nearer within a pixel.
            let covered = distance - self.distance(farther.max(here.min(nearer)));
            let mut shown = 1.0 - smooth(covered, 0.4 * step, 0.6 * step);
            if of_obstacle {
                // Round obstacles come nearer still: only other objects hide their contours fully.
                let free = [0, 1].map(|side| {
                    let least = soft * if obstacles[side] { ROUND_STEP } else { 0.5 * STEP };
                    1.0 - smooth(distance - self.distance(sides[side]), 0.8 * least, 1.2 * least)
                });
                shown = if obstacles.contains(&true) { free[0] * free[1] } else { 0.0 };
            }
            // Obstacles hide all contours behind them.
            let clear = if !of_obstacle && self.obstacle(middle) > 0.0 { at.visible(here) } else { 1.0 };
            let mut outline = 0.0;
            if farther <= 0.0 {
                // Background beside it: part of the outline. A fold of the surface that covers it slightly must be very close.
                let close = normal * if sides[0] <= sides[1] { 0.9 } else { -0.9 };
                outline = if self.depth(middle + close) <= 0.0 { 1.0 } else { shown };
            }
            // Where one object ends in front of another, a contour is drawn at any distance.
            let apart = self.distance(farther) - self.distance(nearer);
            let deep = if obstacles[0] == obstacles[1] { smooth(apart, 0.8 * step, 1.2 * step) } else { 1.0 };
            let stepped = (1.0 - outline) * shown * deep;
            [clear * outline, clear * stepped, clear * (1.0 - outline - stepped)]
        })
    }

    /// The opacities of a line at a sample, relative to those of up to three pens.
    fn look(&self, line: &Line, at: &Sample) -> [usize; 3] {
        // Obstacles fade at the sides of their room.
        let faded = || TAPS.map(|tap| self.obstacle(at.middle + 4.0 * tap)).into_iter().fold(0.0, f32::max);
        let opacities = match line.kind {
            LineKind::Edge | LineKind::Bar => {
                let [seen, behind] = self.edge(at);
                [line.strength * behind, seen, 0.0]
            }
            LineKind::ObstacleEdge => [0.0, self.edge(at)[0] * faded(), 0.0],
            LineKind::AlarmEdge => {
                let [seen, behind] = self.edge(at);
                // Turned-over elements hide more of a line than others.
                let [free] = mean(|tap| [at.visible(self.depth_alone(at.middle + tap))]);
                let [visible, behind_others, behind_these] = ALARM_ALPHAS;
                [seen * visible + behind * (behind_these + free * (behind_others - behind_these)), 0.0, 0.0]
            }
            LineKind::Contour => {
                let [outline, step, _] = self.contour(at, false);
                [line.strength * step, line.strength * outline, 0.0]
            }
            LineKind::ObstacleContour => {
                let [outline, step, _] = self.contour(at, true).map(|share| share * faded());
                [step, outline, 0.0]
            }
            LineKind::AlarmContour => {
                let [outline, step, hidden] = self.contour(at, false).map(|share| line.strength * share);
                // At the end of the set, its outline is drawn at full strength.
                let across = at.along.perp() * (0.9 + 1.3 * self.panel.sight.line_scale);
                let [ends] = mean(|tap| {
                    let sides = [across, -across].map(|way| self.depth_alone(at.middle + tap + way));
                    [if sides[0].min(sides[1]) <= 0.0 { 1.0 } else { 0.0 }]
                });
                let smallness = (self.panel.sight.element / SMALL_FOLDED).min(1.0).powi(2);
                [step, outline, hidden * (smallness + ends * (1.0 - smallness))]
            }
        };
        let left = self.through_plates(at);
        opacities.map(|opacity| level(left * opacity))
    }

    /// A coloured line.
    fn stroke(&self, stroke: &Stroke, alpha: f32, left: impl Fn(&Sample) -> f32, items: &mut Vec<Item>) {
        let Some(segment) = self.segment(stroke.ends, self.panel.viewport, NEARER) else { return };
        let behind = f32::from(stroke.behind) / 255.0;
        let looks: Vec<_> = segment
            .samples()
            .map(|(at, share)| {
                let across = 2.0 * at.along.perp();
                let [seen, inside] = mean(|tap| {
                    let here = self.depth(at.middle + tap);
                    let is_inside = [across, -across].iter().all(|way| self.depth(at.middle + tap + *way) > 0.0);
                    [at.visible(here), if here > 0.0 && is_inside { 1.0 } else { 0.0 }]
                });
                let [from, to] = stroke.colours;
                let plain = std::array::from_fn(|at| {
                    (f32::from(from[at]) + share * (f32::from(to[at]) - f32::from(from[at]))).round() as u8 & !7
                });
                let colour = match stroke.second {
                    Second::OnBody(other) if inside > 0.5 => other,
                    _ if from == to => from,
                    _ => plain,
                };
                (level(left(&at) * (behind + seen * (1.0 - behind))), colour)
            })
            .collect();
        for (run, (level, colour)) in runs(&looks) {
            let alpha = alpha * level as f32 / LEVELS as f32;
            let path = segment.part(run, looks.len());
            match stroke.second {
                Second::Casing(casing) => {
                    add(&path, stroke.width, casing, alpha, items);
                    let sides = (CASING * stroke.width).max(LEAST_CASING);
                    add(&path, stroke.width - 2.0 * sides, colour, alpha, items);
                }
                _ => add(&path, stroke.width, colour, alpha, items),
            }
        }
    }

    /// A node.
    fn bead(&self, bead: &Bead) -> Option<Item> {
        let segment = self.segment([bead.at; 2], self.panel.viewport, NEARER)?;
        let (at, _) = segment.samples().next()?;
        // It is cut off by depths in front of a ball twice as large, and fades over its radius.
        let radius = (bead.radius / self.panel.sight.focal).min(0.25);
        let front = at.depth * (1.0 + OFFSET) / (1.0 - 2.0 * radius);
        let shown = |depth: f32| 0.5 + 0.5 * (front - depth) / (radius.max(FADED) * depth.max(1e-9));
        let around = [Vec2::ZERO, Vec2::X, -Vec2::X, Vec2::Y, -Vec2::Y];
        let [seen] = mean(|tap| {
            let shown = around.map(|way| shown(self.depth(at.middle + tap + 1.5 * way)).clamp(0.0, 1.0));
            [shown.iter().sum::<f32>() / around.len() as f32]
        });
        Item::rimmed(at.middle.as_dvec2(), bead.radius.into(), bead.colour, bead.rim).faded(seen.into())
    }
}

/// Adds a line to items: to the last one, if it looks alike.
fn add(path: &Path, width: f32, colour: Colour, alpha: f32, items: &mut Vec<Item>) {
    // Opacities are meant for linear light, in which dark lines cover less, and light ones more.
    let alpha = if colour[1] < 128 { 1.0 - (1.0 - alpha).powf(IN_BYTES) } else { alpha.powf(IN_BYTES) };
    let (pen, paint) = (Pen { round: false, ..Pen::solid(width) }, Paint { colour, alpha });
    match items.last_mut() {
        Some(Item::Stroke { path: last, pen: other, paint: same }) if *other == pen && *same == paint => {
            last.0.extend_from_slice(&path.0);
        }
        _ => items.push(Item::stroke(path.clone(), pen, paint)),
    }
}

/// The pen of lines of one look.
#[derive(Clone, Copy)]
enum Ink {
    Hidden,
    HiddenBar,
    Edge,
    Bar,
    ObstacleEdge,
    AlarmEdge,
    AlarmStep,
    AlarmFold,
    Step,
    ObstacleStep,
    Outline,
    ObstacleOutline,
}

impl Ink {
    /// All, in the order of drawing.
    const ALL: [Self; 12] = [
        Self::Hidden,
        Self::HiddenBar,
        Self::Edge,
        Self::Bar,
        Self::ObstacleEdge,
        Self::AlarmEdge,
        Self::AlarmStep,
        Self::AlarmFold,
        Self::Step,
        Self::ObstacleStep,
        Self::Outline,
        Self::ObstacleOutline,
    ];

    /// The pens of a kind of lines.
    fn of(kind: LineKind) -> [Self; 3] {
        match kind {
            LineKind::Edge => [Self::Hidden, Self::Edge, Self::Edge],
            LineKind::Bar => [Self::HiddenBar, Self::Bar, Self::Bar],
            LineKind::ObstacleEdge => [Self::ObstacleEdge; 3],
            LineKind::AlarmEdge => [Self::AlarmEdge; 3],
            LineKind::Contour => [Self::Step, Self::Outline, Self::Outline],
            LineKind::AlarmContour => [Self::AlarmStep, Self::Outline, Self::AlarmFold],
            LineKind::ObstacleContour => [Self::ObstacleStep, Self::ObstacleOutline, Self::ObstacleOutline],
        }
    }

    /// Width (px), colour and opacity in a panel.
    fn look(self, panel: &Panel, palette: &Palette) -> (f32, Colour, f32) {
        let Palette { edge, outline, alarm_line, outline_alpha, .. } = *palette;
        let (strength, scale) = (edging(panel.sight.element), panel.sight.line_scale);
        // Small bodies would be mostly outline.
        let own = scale * panel.sight.contour_share;
        match self {
            Self::Hidden => (HIDDEN_WIDTH * scale, edge, HIDDEN_ALPHA * strength * strength),
            Self::HiddenBar => (BAR_WIDTH * scale, edge, HIDDEN_ALPHA),
            Self::Edge => (EDGE_WIDTH * scale, edge, EDGE_ALPHA * strength),
            Self::Bar => (BAR_WIDTH * scale, edge, BAR_ALPHA),
            Self::ObstacleEdge => (EDGE_WIDTH * scale, edge, EDGE_ALPHA),
            Self::AlarmEdge => (ALARM_EDGE_WIDTH * own, alarm_line, strength),
            Self::AlarmStep => (STEP_WIDTH * own, alarm_line, STEP_ALPHA),
            Self::AlarmFold => (FOLD_WIDTH * own, alarm_line, FOLD_ALPHA),
            Self::Step => (STEP_WIDTH * own, edge, STEP_ALPHA),
            Self::ObstacleStep => (STEP_WIDTH * scale, edge, STEP_ALPHA),
            Self::Outline => (OUTLINE_WIDTH * own, outline, outline_alpha),
            Self::ObstacleOutline => (OUTLINE_WIDTH * scale, outline, outline_alpha),
        }
    }
}

/// The lines and nodes of a panel, in the order in which they are drawn.
pub(super) fn items(tested: &Tested<'_>, picture: &Picture) -> Vec<Item> {
    let panel = tested.panel;
    let (mut items, palette) = (Vec::new(), palette(picture, panel));
    if panel.region[2] == 0 || panel.region[3] == 0 {
        return items;
    }
    let mut paths: Vec<[Path; LEVELS]> = Ink::ALL.map(|_| Default::default()).into();
    let mut drawn = HashSet::new();
    for line in &panel.lines {
        let nearer = if line.kind.is_alarm() { NEARER } else { 0.0 };
        let Some(segment) = tested.segment([line.from, line.to], panel.region, nearer) else { continue };
        let looks: Vec<_> = segment.samples().map(|(at, _)| tested.look(line, &at)).collect();
        for (at, ink) in Ink::of(line.kind).into_iter().enumerate() {
            for (run, look) in runs(&looks.iter().map(|look| look[at]).collect::<Vec<_>>()) {
                let part = segment.part(run, looks.len());
                // Coverage of a line drawn twice would add up: both sets of elements have contours along common edges.
                if look > 0 && drawn.insert((ink as usize, key(&part))) {
                    paths[ink as usize][look - 1].0.extend(part.0);
                }
            }
        }
    }
    for (ink, paths) in Ink::ALL.into_iter().zip(paths) {
        let (width, colour, alpha) = ink.look(panel, &palette);
        for (level, path) in (1..).zip(paths).filter(|(_, path)| !path.0.is_empty()) {
            add(&path, width, colour, alpha * level as f32 / LEVELS as f32, &mut items);
        }
    }
    let left = |at: &Sample| tested.through_plates(at);
    panel.strokes.iter().for_each(|stroke| tested.stroke(stroke, 1.0, left, &mut items));
    items.extend(panel.beads.iter().filter_map(|bead| tested.bead(bead)));
    for &ends in &panel.obstacles.edges {
        let (colours, width) = ([palette.pane_edge; 2], PLATE_EDGE * panel.sight.line_scale);
        let edge = Stroke { ends, colours, second: Second::None, behind: 0, width };
        tested.stroke(&edge, PLATE_EDGE_ALPHA, |_| 1.0, &mut items);
    }
    items
}

/// The ends of a line in quarters of a pixel, the lower one first.
fn key(line: &Path) -> [[i32; 2]; 2] {
    let mut ends = [0, 1].map(|at| match line.0[at] {
        Step::Move(end) | Step::Line(end) => (4.0 * end).round().as_ivec2().to_array(),
        Step::Cubic(_) | Step::Close => [0; 2],
    });
    ends.sort_unstable();
    ends
}

/// A line in the picture: its ends (px), with their depths.
pub(super) struct Segment(pub(super) [Vec3; 2]);

/// A point of a line with its depth, and the line's direction.
struct Sample {
    middle: Vec2,
    along: Vec2,
    depth: f32,
}

impl Sample {
    /// The visibility at a surface of a depth.
    fn visible(&self, surface: f32) -> f32 {
        let depth = self.depth * (1.0 + OFFSET);
        (0.5 + 0.5 * (depth - surface) / (FADED * surface.max(1e-9))).clamp(0.0, 1.0)
    }
}

impl Segment {
    /// Samples along it, about a pixel apart, with their shares of its length.
    fn samples(&self) -> impl Iterator<Item = (Sample, f32)> {
        let [from, to] = self.0;
        let way = (to - from).truncate();
        let (length, along) = (way.length(), way.normalize_or(Vec2::X));
        let last = length.ceil().max(1.0);
        (0..=last as u32).map(move |at| {
            let share = at as f32 / last;
            let here = from.lerp(to, share);
            (Sample { middle: here.truncate(), along, depth: here.z }, share)
        })
    }

    /// The part around consecutive samples of a number.
    fn part(&self, run: std::ops::Range<usize>, count: usize) -> Path {
        let [from, to] = self.0.map(Vec3::truncate);
        let place = |at: usize| match at {
            0 => from,
            _ if at == count => to,
            _ => from.lerp(to, (at as f32 - 0.5) / (count - 1) as f32),
        };
        Path(vec![Step::Move(place(run.start)), Step::Line(place(run.end))])
    }
}

/// Runs of equal values.
fn runs<T: Copy + PartialEq>(values: &[T]) -> Vec<(std::ops::Range<usize>, T)> {
    let mut start = 0;
    let run = |run: &[T]| {
        start += run.len();
        (start - run.len()..start, run[0])
    };
    values.chunk_by(T::eq).map(run).collect()
}

/// One of a few opacities.
fn level(opacity: f32) -> usize {
    (opacity * LEVELS as f32).round() as usize
}

/// The mean of values at all places in a pixel.
fn mean<const COUNT: usize>(of: impl Fn(Vec2) -> [f32; COUNT]) -> [f32; COUNT] {
    let mut sum = [0.0; COUNT];
    for tap in TAPS {
        sum.iter_mut().zip(of(tap)).for_each(|(sum, one)| *sum += one / TAPS.len() as f32);
    }
    sum
}

/// A smooth step from 0 to 1 between two values.
fn smooth(at: f32, from: f32, to: f32) -> f32 {
    let share = ((at - from) / (to - from)).clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}

/// The ends of a line's part in a rectangle, as shares of the line.
fn shares_within(from: DVec2, to: DVec2, [low, high]: [DVec2; 2]) -> Option<[f64; 2]> {
    let way = to - from;
    let (mut start, mut end) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        if way[axis] == 0.0 {
            if from[axis] < low[axis] || from[axis] > high[axis] {
                return None;
            }
            continue;
        }
        let [one, other] = [low, high].map(|side| (side[axis] - from[axis]) / way[axis]);
        (start, end) = (start.max(one.min(other)), end.min(one.max(other)));
    }
    (start <= end).then_some([start, end])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_to_what_may_be_seen() {
        let room = [DVec2::ZERO, DVec2::new(10.0, 5.0)];
        let within = |from: [f64; 2], to: [f64; 2]| shares_within(from.into(), to.into(), room);
        assert_eq!(within([1.0, 1.0], [9.0, 4.0]), Some([0.0, 1.0]));
        assert_eq!(within([-10.0, 2.0], [30.0, 2.0]), Some([0.25, 0.5]));
        assert_eq!(within([3.0, -1e3], [3.0, -1.0]), None);
        assert_eq!(within([-1.0, 6.0], [12.0, 6.0]), None);
        assert_eq!(within([4.0, 4.0], [4.0, 4.0]), Some([0.0, 1.0]));
        // The line passes a corner.
        assert_eq!(within([-2.0, 4.0], [4.0, 10.0]), None);
    }
}
