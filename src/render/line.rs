//! Lines over lit bodies, as items: edges, contours, springs and nodes. Their visibility is tested with the depths of the
//! picture, once for each pixel of their length.

use super::panel::palette;
use crate::gpu::Layers;
use crate::picture::measures::{
    ALARM_EDGE_ALPHA, ALARM_EDGE_WIDTH, BAR_ALPHA, BAR_WIDTH, CASING, EDGE_ALPHA, EDGE_WIDTH, LEAST_CASING, NEARER,
    OVER_BODIES, SOLID_OVER_BODIES, edging,
};
use crate::picture::{
    Bead, Colour, Item, Line, LineKind, Paint, Palette, Pane, Panel, Path, Pen, Picture, Rectangle, Second, Step,
    Stroke, around, clipped, newell, sides,
};
use glam::{DVec2, DVec3, DVec4, Vec2, Vec3};
use std::collections::{BTreeMap, HashSet};

/// Widths of hidden edges and of contours (px in the reference picture), from the widest contour to the narrowest.
const HIDDEN_WIDTH: f32 = 0.9;
const OUTLINE_WIDTH: f32 = 2.0;
const FOLD_WIDTH: f32 = 1.7;
const STEP_WIDTH: f32 = 1.5;
/// Opacities of hidden edges, and of contours inside the body and behind it.
const HIDDEN_ALPHA: f32 = 0.16;
const STEP_ALPHA: f32 = 0.85;
const FOLD_ALPHA: f32 = 0.80;
/// Opacities of edges of turned-over elements: visible, behind other elements, and behind turned-over ones.
const ALARM_ALPHAS: [f32; 3] = [ALARM_EDGE_ALPHA, 0.62, 0.15];
/// Width (px in the reference picture) and opacity of the edges of plates.
const PLATE_EDGE: f32 = 1.35;
const PLATE_EDGE_ALPHA: f32 = 0.86;

/// A line lies this much in front of its surface, relative to the distance, and fades over the second range of depths in
/// front of the surface and behind it, so that it does not appear suddenly.
const OFFSET: f32 = 0.0016;
const FADED: f32 = 0.0008;
/// From this step of depth on, a contour inside the body is drawn (soft units).
const STEP: f32 = 0.22;
/// Gaps of up to twice this length in contours of fine surfaces are closed (samples, a pixel apart).
const GAP: usize = 4;
/// Below this step (soft units) an obstacle does not hide its own contour or that of another.
const ROUND_STEP: f32 = 0.8;

/// Places in the pixel around a point, in different rows and columns. All together represent the pixel.
const TAPS: [Vec2; 4] =
    [Vec2::new(0.125, 0.375), Vec2::new(-0.375, 0.125), Vec2::new(0.375, -0.125), Vec2::new(-0.125, -0.375)];
/// The exponent by which the painter, which blends bytes (sRGB), comes near blending of linear light.
const IN_BYTES: f32 = 0.55;
/// Between these greens a colour is neither dark nor light.
const MEDIUM: [f32; 2] = [96.0, 160.0];
/// The step of the colours of a gradient (bytes).
const GRADED: f32 = 8.0;
/// The number of opacities of lines.
const LEVELS: usize = 8;

/// A panel with the depths of its bodies.
#[derive(Debug)]
pub(super) struct Depths<'a> {
    pub(super) panel: &'a Panel,
    /// The opacities of pixels, and the depths of all bodies, of turned-over elements alone, and of bodies with the obstacles before them.
    marks: &'a [[u8; 4]],
    all: &'a [f32],
    alone: Option<&'a [f32]>,
    with_obstacles: Option<&'a [f32]>,
    stride: usize,
    plates: Vec<Plate>,
}

/// The visible part of a plate.
#[derive(Debug)]
struct Plate {
    /// The corners (px), with their depths.
    corners: Vec<DVec3>,
    /// The normal of its depths over the picture.
    normal: DVec3,
    /// The part of a line that it leaves visible behind it.
    left: f32,
}

impl<'a> Depths<'a> {
    /// The layers have the picture, the depths of its bodies and, where it `has` them, of turned-over elements and of bodies with solid obstacles.
    pub(super) fn new(panel: &'a Panel, layers: Layers<'a>, [has_behind, has_solids]: [bool; 2]) -> Self {
        let alone = has_behind.then(|| layers.of(2));
        let with_obstacles = has_solids.then(|| layers.of(2 + usize::from(has_behind)));
        let (marks, all, stride) = (layers.of(0), layers.of(1), layers.stride());
        let depths = Self { panel, marks, all, alone, with_obstacles, stride, plates: Vec::new() };
        let panes = panel.obstacles.panes.iter().filter(|pane| !pane.grid);
        Self { plates: panes.filter_map(|pane| depths.plate(pane)).collect(), ..depths }
    }

    /// A plate; `None` if it lies behind the viewer, or is seen from its edge and covers nothing.
    fn plate(&self, pane: &Pane) -> Option<Plate> {
        let corners: Vec<_> = pane.corners.iter().map(|corner| self.in_clip_space(corner.position)).collect();
        let sides = around(&corners).filter_map(|(&a, &b)| self.before_eye([a, b])).flatten();
        let corners: Vec<_> = sides.map(|at| self.place(at, 0.0)).collect();
        let normal = newell(&corners);
        (normal.z.abs() > 1e-3).then_some(Plate { corners, normal, left: 1.0 - OVER_BODIES * pane.alpha })
    }

    /// A point in clip space. Double precision keeps lines that reach far beyond the picture in their places.
    fn in_clip_space(&self, at: [f32; 3]) -> DVec4 {
        self.panel.sight.clip.as_dmat4() * Vec3::from(at).as_dvec3().extend(1.0)
    }

    /// The part of a line in clip space that is before the near plane.
    fn before_eye(&self, [a, b]: [DVec4; 2]) -> Option<[DVec4; 2]> {
        let near = f64::from(self.panel.sight.near);
        let cut = |from: DVec4, to| if from.w < near { from.lerp(to, (near - from.w) / (to.w - from.w)) } else { from };
        (a.w.max(b.w) >= near).then(|| [cut(a, b), cut(b, a)])
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

    /// The part of a line of a body that plates and solid obstacles in front of it leave visible.
    fn through_obstacles(&self, at: &Sample) -> f32 {
        let [left] = mean(|tap| {
            let middle = at.middle + tap;
            let is_before = self.obstacle(middle) > 0.0;
            [if is_before { 1.0 - SOLID_OVER_BODIES * (1.0 - at.visible(self.depth(middle))) } else { 1.0 }]
        });
        left * self.through_plates(at)
    }

    /// The part of a line that plates in front of it leave visible.
    fn through_plates(&self, at: &Sample) -> f32 {
        let is_before = |plate: &&Plate| {
            let off = at.middle.as_dvec2() - plate.corners[0].truncate();
            let depth = plate.corners[0].z - off.dot(plate.normal.truncate()) / plate.normal.z;
            let at_side = |(a, b): (&DVec3, &DVec3)| (b - a).truncate().perp_dot(at.middle.as_dvec2() - a.truncate());
            let sides = || around(&plate.corners).map(at_side);
            let is_inside = sides().all(|side| side >= 0.0) || sides().all(|side| side <= 0.0);
            is_inside && depth > f64::from(at.depth * (1.0 + OFFSET))
        };
        self.plates.iter().filter(is_before).map(|plate| plate.left).product()
    }

    /// The place of the pixel at a point, or of the nearest pixel of the panel.
    fn pixel(&self, at: Vec2) -> usize {
        let [left, top, width, height] = self.panel.viewport;
        let within = |at: f32, start: u32, length: u32| (at.max(0.0) as u32).clamp(start, start + length - 1) as usize;
        within(at.y, top, height) * self.stride + within(at.x, left, width)
    }

    /// The depth of bodies at a point: 0 elsewhere.
    pub(super) fn depth_of_bodies(&self, at: Vec2) -> f32 {
        self.all[self.pixel(at)]
    }

    /// The depth of bodies and solid obstacles at a point: 0 on the ground.
    pub(super) fn depth(&self, at: Vec2) -> f32 {
        self.with_obstacles.unwrap_or(self.all)[self.pixel(at)]
    }

    /// The depth of turned-over elements alone.
    pub(super) fn depth_alone(&self, at: Vec2) -> f32 {
        self.alone.map_or(0.0, |depths| depths[self.pixel(at)])
    }

    /// The opacity of an obstacle at a point, without what bodies behind it take of it; 0 where none is before bodies and ground.
    fn obstacle(&self, at: Vec2) -> f32 {
        let bodies = self.depth_of_bodies(at);
        if self.depth(at) <= bodies {
            return 0.0;
        }
        let whole = if bodies > 0.0 { 255.0 * SOLID_OVER_BODIES } else { 255.0 };
        (f32::from(self.marks[self.pixel(at)][3]) / whole).min(1.0)
    }

    pub(super) fn distance(&self, depth: f32) -> f32 {
        self.panel.sight.near / depth.max(1e-9)
    }

    /// The part of a line in a rectangle (px), this much nearer (sides).
    pub(super) fn segment(&self, ends: [[f32; 3]; 2], within: Rectangle, nearer: f32) -> Option<Segment> {
        let [from, to] = self.before_eye(ends.map(|end| self.in_clip_space(end)))?.map(|end| self.place(end, nearer));
        let (start, way) = (from.truncate(), (to - from).truncate());
        let shares = clipped(start, way, sides(within.map(f64::from)), [0.0, 1.0])?;
        Some(Segment(shares.map(|share| from.lerp(to, share).as_vec3())))
    }

    /// The visibility of an edge among depths, and the part of it behind a body.
    fn edge(&self, at: &Sample, depth: fn(&Self, Vec2) -> f32) -> [f32; 2] {
        // A face seen at a grazing angle has points in front of its edge a pixel nearer to the viewer. So the farther side
        // counts.
        let across = 0.75 * at.along.perp();
        mean(|tap| {
            let middle = at.middle + tap;
            let beside = [depth(self, middle + across), depth(self, middle - across)];
            let farthest = beside.into_iter().filter(|&depth| depth > 0.0).fold(depth(self, middle), f32::min);
            let seen = at.visible(farthest);
            [seen, 1.0 - seen]
        })
    }

    /// The share of a contour that is outer outline, that is a step of depth inside the body, and that is hidden.
    fn contour(&self, at: &Sample, kind: LineKind) -> [f32; 3] {
        let (of_obstacle, is_fine) = (kind == LineKind::ObstacleContour, kind == LineKind::FineContour);
        let normal = at.along.perp();
        // Fine surfaces have many contours beside each other: only the outermost is the outline.
        let reach = if is_fine { 0.0 } else { 1.3 };
        let across = normal * (0.9 + reach * self.panel.sight.line_scale);
        let (soft, distance) = (self.panel.sight.soft, self.distance(at.depth));
        let step = STEP * soft;
        // Bodies are seen through obstacles.
        let depth = if of_obstacle { Self::depth } else { Self::depth_of_bodies };
        mean(|tap| {
            let middle = at.middle + tap;
            let here = depth(self, middle);
            let places = [middle + across, middle - across];
            let sides = places.map(|place| depth(self, place));
            let obstacles = places.map(|place| of_obstacle && self.obstacle(place) > 0.0);
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
            let mut outline = 0.0;
            if farther <= 0.0 {
                // Background beside it: part of the outline. A fold of the surface that covers it slightly must be very close.
                let close = normal * if sides[0] <= sides[1] { 0.9 } else { -0.9 };
                outline = if depth(self, middle + close) <= 0.0 { 1.0 } else { shown };
            }
            // Where one object ends in front of another, a contour is drawn at any distance.
            let apart = self.distance(farther) - self.distance(nearer);
            let deep = if obstacles[0] == obstacles[1] { smooth(apart, 0.8 * step, 1.2 * step) } else { 1.0 };
            let stepped = (1.0 - outline) * shown * deep;
            [outline, stepped, 1.0 - outline - stepped]
        })
    }

    /// The opacities of a line at a sample, relative to those of up to three pens.
    fn levels(&self, line: &Line, at: &Sample) -> [usize; 3] {
        // Obstacles fade at the sides of their room.
        let faded = || TAPS.map(|tap| self.obstacle(at.middle + 4.0 * tap)).into_iter().fold(0.0, f32::max);
        let opacities = match line.kind {
            LineKind::Edge | LineKind::Bar => {
                let [seen, behind] = self.edge(at, Self::depth_of_bodies);
                [line.strength * behind, seen, 0.0]
            }
            LineKind::ObstacleEdge => [0.0, self.edge(at, Self::depth)[0] * faded(), 0.0],
            LineKind::AlarmEdge => {
                let [seen, behind] = self.edge(at, Self::depth_of_bodies);
                // Turned-over elements hide more of a line than others.
                let [free] = mean(|tap| [at.visible(self.depth_alone(at.middle + tap))]);
                let [visible, behind_others, behind_these] = ALARM_ALPHAS;
                [seen * visible + behind * (behind_these + free * (behind_others - behind_these)), 0.0, 0.0]
            }
            LineKind::Contour | LineKind::FineContour => {
                let [outline, step, _] = self.contour(at, line.kind);
                [line.strength * step, line.strength * outline, 0.0]
            }
            LineKind::ObstacleContour => {
                let [outline, step, _] = self.contour(at, line.kind).map(|share| share * faded());
                [step, outline, 0.0]
            }
            LineKind::AlarmContour => {
                let [outline, step, hidden] = self.contour(at, line.kind).map(|share| line.strength * share);
                // At the end of the set, its outline is drawn at full strength.
                let across = at.along.perp() * (0.9 + 1.3 * self.panel.sight.line_scale);
                let [ends] = mean(|tap| {
                    let sides = [across, -across].map(|way| self.depth_alone(at.middle + tap + way));
                    [if sides[0].min(sides[1]) <= 0.0 { 1.0 } else { 0.0 }]
                });
                let folds = self.panel.sight.folds;
                let strength = folds + ends * (1.0 - folds);
                // Of many elements the outline alone is drawn.
                [if folds > 0.0 { step } else { step * ends }, outline, hidden * strength]
            }
        };
        let is_of_obstacle = matches!(line.kind, LineKind::ObstacleEdge | LineKind::ObstacleContour);
        let left = if is_of_obstacle { self.through_plates(at) } else { self.through_obstacles(at) };
        opacities.map(|opacity| level(left * opacity))
    }

    /// A coloured line of a body, or an edge of a plate.
    fn stroke(&self, stroke: &Stroke, alpha: f32, is_plate: bool, items: &mut Vec<Item>) {
        let Some(segment) = self.segment(stroke.ends, self.panel.viewport, NEARER) else { return };
        let behind = f32::from(stroke.behind) / 255.0;
        let depth = if is_plate { Self::depth } else { Self::depth_of_bodies };
        let left = |at: &Sample| if is_plate { 1.0 } else { self.through_obstacles(at) };
        let looks: Vec<_> = segment
            .samples()
            .map(|(at, share)| {
                let across = 2.0 * at.along.perp();
                let [seen, inside] = mean(|tap| {
                    let here = depth(self, at.middle + tap);
                    let is_inside = [across, -across].iter().all(|way| depth(self, at.middle + tap + *way) > 0.0);
                    [at.visible(here), if here > 0.0 && is_inside { 1.0 } else { 0.0 }]
                });
                let [from, to] = stroke.colours;
                let plain = std::array::from_fn(|at| {
                    let [from, to] = [from[at], to[at]].map(f32::from);
                    (((from + share * (to - from)) / GRADED).round() * GRADED) as u8
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
                    add(&path, stroke.width, casing, in_bytes(alpha, casing), items);
                    let sides = (CASING * stroke.width).max(LEAST_CASING);
                    add(&path, stroke.width - 2.0 * sides, colour, in_bytes(alpha, colour), items);
                }
                _ => add(&path, stroke.width, colour, in_bytes(alpha, colour), items),
            }
        }
    }

    /// A node; `None` if it is hidden or outside the panel.
    fn bead(&self, bead: &Bead) -> Option<Item> {
        let [at, _] = self.before_eye([self.in_clip_space(bead.at); 2])?.map(|at| self.place(at, NEARER).as_vec3());
        let middle = at.truncate();
        let [left, top, width, height] = self.panel.viewport.map(|length| length as f32);
        let corner = Vec2::new(left, top);
        if middle.distance(middle.clamp(corner, corner + Vec2::new(width, height))) > bead.radius {
            return None;
        }
        // It is cut off by depths in front of a ball twice as large, and fades over its radius.
        let radius = (bead.radius / self.panel.sight.focal).min(0.25);
        let front = at.z * (1.0 + OFFSET) / (1.0 - 2.0 * radius);
        let shown = |depth: f32| 0.5 + 0.5 * (front - depth) / (radius.max(FADED) * depth.max(1e-9));
        let around = [Vec2::ZERO, Vec2::X, -Vec2::X, Vec2::Y, -Vec2::Y];
        let [seen] = mean(|tap| {
            let shown = around.map(|way| shown(self.depth_of_bodies(middle + tap + 1.5 * way)).clamp(0.0, 1.0));
            [shown.iter().sum::<f32>() / around.len() as f32]
        });
        Item::rimmed(middle.as_dvec2(), bead.radius.into(), bead.colour, bead.rim).faded(seen.into())
    }
}

/// The opacity in bytes of a colour that has an opacity in linear light, in which dark lines cover less, and light ones more.
fn in_bytes(alpha: f32, colour: Colour) -> f32 {
    let (dark, light) = (1.0 - (1.0 - alpha).powf(IN_BYTES), alpha.powf(IN_BYTES));
    dark + smooth(colour[1].into(), MEDIUM[0], MEDIUM[1]) * (light - dark)
}

/// Adds a line to items: to the last one, if it looks alike.
fn add(path: &Path, width: f32, colour: Colour, alpha: f32, items: &mut Vec<Item>) {
    let (pen, paint) = (Pen { round: false, ..Pen::solid(width) }, Paint { colour, alpha });
    match items.last_mut() {
        Some(Item::Stroke { path: last, pen: other, paint: same }) if *other == pen && *same == paint => {
            last.0.extend_from_slice(&path.0);
        }
        _ => items.push(Item::stroke(path.clone(), pen, paint)),
    }
}

/// Lines of one pen, in the order of drawing.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
enum Style {
    Hidden,
    HiddenBar,
    Edge,
    Bar,
    ObstacleEdge,
    AlarmEdge,
    AlarmStep,
    AlarmFold,
    Step,
    FineStep,
    ObstacleStep,
    Outline,
    ObstacleOutline,
}

impl Style {
    /// The styles of a kind of lines.
    fn of(kind: LineKind) -> [Self; 3] {
        match kind {
            LineKind::Edge => [Self::Hidden, Self::Edge, Self::Edge],
            LineKind::Bar => [Self::HiddenBar, Self::Bar, Self::Bar],
            LineKind::ObstacleEdge => [Self::ObstacleEdge; 3],
            LineKind::AlarmEdge => [Self::AlarmEdge; 3],
            LineKind::Contour => [Self::Step, Self::Outline, Self::Outline],
            LineKind::FineContour => [Self::FineStep, Self::Outline, Self::Outline],
            LineKind::AlarmContour => [Self::AlarmStep, Self::Outline, Self::AlarmFold],
            LineKind::ObstacleContour => [Self::ObstacleStep, Self::ObstacleOutline, Self::ObstacleOutline],
        }
    }

    /// Width (px), colour and opacity in a panel.
    fn pen(self, panel: &Panel, palette: &Palette) -> (f32, Colour, f32) {
        let Palette { edge, outline, alarm_line, outline_alpha, .. } = *palette;
        let (strength, scale) = (edging(panel.sight.element), panel.sight.line_scale);
        // Small bodies would be mostly outline.
        let own = scale * panel.sight.contour_share;
        match self {
            Self::Hidden => (HIDDEN_WIDTH * scale, edge, HIDDEN_ALPHA * strength * strength),
            Self::HiddenBar => (BAR_WIDTH * scale, outline, HIDDEN_ALPHA),
            Self::Edge => (EDGE_WIDTH * scale, edge, EDGE_ALPHA * strength),
            Self::Bar => (BAR_WIDTH * scale, outline, BAR_ALPHA),
            Self::ObstacleEdge => (EDGE_WIDTH * scale, edge, EDGE_ALPHA),
            Self::AlarmEdge => (ALARM_EDGE_WIDTH * own, alarm_line, strength),
            Self::AlarmStep => (STEP_WIDTH * own, alarm_line, STEP_ALPHA),
            Self::AlarmFold => (FOLD_WIDTH * own, alarm_line, FOLD_ALPHA),
            Self::Step | Self::FineStep => (STEP_WIDTH * own, edge, STEP_ALPHA),
            Self::ObstacleStep => (STEP_WIDTH * scale, edge, STEP_ALPHA),
            Self::Outline => (OUTLINE_WIDTH * own, outline, outline_alpha),
            Self::ObstacleOutline => (OUTLINE_WIDTH * scale, outline, outline_alpha),
        }
    }
}

/// The lines and nodes of a panel, in the order in which they are drawn; `None` if there are none.
pub(super) fn item(depths: &Depths<'_>, picture: &Picture) -> Option<Item> {
    let panel = depths.panel;
    let (mut items, palette) = (Vec::new(), palette(picture, panel));
    let mut paths: BTreeMap<Style, [Path; LEVELS]> = BTreeMap::new();
    let mut drawn = HashSet::new();
    let lines = if panel.region[2..].contains(&0) { &[] } else { &panel.lines[..] };
    let continues = |one: &Line, next: &Line| [one, next].iter().all(|line| is_fine(line)) && one.to == next.from;
    for chain in lines.chunk_by(continues) {
        let sampled = |line: &Line| {
            let nearer = if line.kind.is_alarm() { NEARER } else { 0.0 };
            let segment = depths.segment([line.from, line.to], panel.region, nearer)?;
            let levels: Vec<_> = segment.samples().map(|(at, _)| depths.levels(line, &at)).collect();
            Some((segment, levels))
        };
        let mut parts: Vec<_> = chain.iter().filter_map(sampled).collect();
        if is_fine(&chain[0]) {
            close_gaps(&mut parts.iter_mut().flat_map(|(_, levels)| levels).collect::<Vec<_>>());
        }
        for (segment, levels) in parts {
            for (at, style) in Style::of(chain[0].kind).into_iter().enumerate() {
                let levels: Vec<_> = levels.iter().map(|levels| levels[at]).collect();
                // Coverage of a line drawn twice would add up: both sets of elements have contours along common edges.
                if levels.iter().all(|&level| level == 0) || !drawn.insert((style, segment.key())) {
                    continue;
                }
                for (run, level) in runs(&levels).into_iter().filter(|&(_, level)| level > 0) {
                    let part = segment.part(run, levels.len()).0;
                    // At the end of a fold the edges of triangles turn back beside each other. Their opacities would add up to a knot, so
                    // each level is drawn with all that are stronger.
                    let least = if style == Style::FineStep { 1 } else { level };
                    for level in least..=level {
                        let path = &mut paths.entry(style).or_default()[level - 1].0;
                        let continues = is_fine(&chain[0]) && are_joined(path, &part);
                        path.extend(&part[usize::from(continues)..]);
                    }
                }
            }
        }
    }
    for (style, paths) in paths {
        let (width, colour, alpha) = style.pen(panel, &palette);
        let of_level = |level: usize| in_bytes(alpha * level as f32 / LEVELS as f32, colour);
        for (level, path) in (1..).zip(paths).filter(|(_, path)| !path.is_empty()) {
            // What the levels below do not cover yet.
            let alpha = match style {
                Style::FineStep => 1.0 - (1.0 - of_level(level)) / (1.0 - of_level(level - 1)),
                _ => of_level(level),
            };
            add(&path, width, colour, alpha, &mut items);
        }
    }
    panel.strokes.iter().for_each(|stroke| depths.stroke(stroke, 1.0, false, &mut items));
    items.extend(panel.beads.iter().filter_map(|bead| depths.bead(bead)));
    for &ends in &panel.obstacles.edges {
        let (colours, width) = ([palette.pane_edge; 2], PLATE_EDGE * panel.sight.line_scale);
        let edge = Stroke { ends, colours, second: Second::None, behind: 0, width };
        depths.stroke(&edge, PLATE_EDGE_ALPHA, true, &mut items);
    }
    (!items.is_empty()).then(|| Item::inside(panel.viewport, items))
}

/// Whether a line is a contour of a fine surface.
fn is_fine(line: &Line) -> bool {
    line.kind == LineKind::FineContour
}

/// Closes short gaps in a contour: pixels are too coarse to tell an outline from a fold of the surface close to it.
fn close_gaps(samples: &mut [&mut [usize; 3]]) {
    for at in 0..3 {
        let levels: Vec<_> = samples.iter().map(|levels| levels[at]).collect();
        let around = |levels: &[usize], best: fn(usize, usize) -> usize| -> Vec<usize> {
            let near = |at: usize| &levels[at.saturating_sub(GAP)..(at + GAP + 1).min(levels.len())];
            (0..levels.len()).map(|at| near(at).iter().copied().fold(levels[at], best)).collect()
        };
        let closed = around(&around(&levels, usize::max), usize::min);
        samples.iter_mut().zip(closed).for_each(|(levels, level)| levels[at] = level);
    }
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

    /// Its ends in quarters of a pixel, the lower one first.
    fn key(&self) -> [[i32; 2]; 2] {
        let mut ends = self.0.map(|end| (4.0 * end.truncate()).round().as_ivec2().to_array());
        ends.sort_unstable();
        ends
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

/// Whether a line ends where another one begins.
fn are_joined(line: &[Step], next: &[Step]) -> bool {
    const CLOSE: f32 = 1e-3;
    matches!((line.last(), next.first()), (Some(Step::Line(end)), Some(Step::Move(start))) if end.distance(*start) < CLOSE)
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
