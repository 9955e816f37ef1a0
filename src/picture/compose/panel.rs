//! Composes one panel from its parts.

use super::Composer;
use super::plane_body::PlaneBody;
use crate::look::{FloorStyle, Palette};
use crate::picture::arrows::{self, Arrows};
use crate::picture::camera::Lens;
use crate::picture::field::{self, NOWHERE, Shades};
use crate::picture::grip::Hands;
use crate::picture::layout::{self, Rectangle, Scale};
use crate::picture::narrow::{narrow, narrow_point};
use crate::picture::obstacle::{self, Site, Staged, Staging};
use crate::picture::plane::{self, node_radius};
use crate::picture::pointer::Pointers;
use crate::picture::shadow::key_light;
use crate::picture::surface::SurfaceLines;
use crate::picture::{Framing, Item, Line, Mesh, Obstacles, Panel, Sight};
use crate::scene::Scene;
use crate::sim::geometry;
use crate::sim::{Body, Dimension, RunFrame, Snapshot, Status};
use glam::{DVec2, DVec3};
use std::borrow::Cow;

/// Coordinates of diverged runs are clamped to this (sides).
const FARTHEST: f64 = 1e12;

/// Bodies smaller than the second size have narrower contours, down to this part of the width at the first size (px in
/// the reference picture); otherwise small bodies would be mostly outline.
const SMALL_BODY: [f64; 2] = [30.0, 150.0];
const LEAST_CONTOUR: f64 = 0.4;

/// One panel while it is composed, with the data for all its parts.
pub(super) struct Draft<'a> {
    pub(super) composer: &'a Composer<'a>,
    pub(super) scene: &'a Scene,
    pub(super) body: &'a Body,
    pub(super) run: Shown<'a>,
    pub(super) framing: &'a Framing,
    pub(super) viewport: Rectangle,
    /// The part of it without words.
    pub(super) clear: Rectangle,
    pub(super) scale: Scale,
    pub(super) lens: Lens,
    /// Unit vector towards the key light.
    pub(super) key: DVec3,
    /// The panel's origin (m).
    pub(super) origin: DVec3,
    /// The panel's unit of length (m).
    pub(super) side: f64,
    /// The nodes (m); empty if not all are known.
    pub(super) position: Cow<'a, [DVec3]>,
    /// The shown field.
    pub(super) shades: Option<Shades>,
    /// Its places on the colour scale at the nodes, if lines or discs show them.
    pub(super) of_nodes: Vec<f32>,
    /// Length of an element's edge at the body's distance (px).
    pub(super) element: f64,
    /// Whether the body lies in the plane.
    pub(super) flat: bool,
    /// Whether the run diverged and no fitting state of it is known.
    pub(super) diverged: bool,
    /// Whether the body is greyed because the run diverges or has diverged.
    pub(super) greyed: bool,
    /// The colours.
    pub(super) palette: Palette,
}

/// A run with its shown state.
#[derive(Clone, Copy)]
pub(super) struct Shown<'a> {
    pub(super) run: usize,
    pub(super) snapshot: &'a Snapshot,
}

impl<'a> Draft<'a> {
    /// Collects the data of a panel.
    pub(super) fn new(
        composer: &'a Composer<'a>,
        viewport: Rectangle,
        run: &'a RunFrame,
        framing: &'a Framing,
        scale: Scale,
    ) -> Self {
        let scene = composer.scene;
        let (view, body) = (&scene.view, &*scene.body);
        let greyed = run.shown().status != Status::Ok;
        let diverged = greyed && run.last_fit.is_none();
        let run = Shown { run: run.run, snapshot: run.shown() };
        let lens = Lens::new(view, framing, body.dimension, viewport.map(f64::from), scale.unit);
        // Without positions nothing is drawn.
        let position = if run.snapshot.position.len() == body.len() { &run.snapshot.position[..] } else { &[] };
        let position = finite(position, FARTHEST * view.side);
        // A greyed body shows no values.
        let field = if greyed { &[][..] } else { &run.snapshot.field[..] };
        // If springs show their strain, the body has no colours.
        let shown = view.colour.as_ref().filter(|_| composer.strain_of_springs(run.run).is_none());
        let shades = shown.map(|scale| Shades::new(body, scale, field));
        let of_nodes = match &shades {
            Some(shades) if !view.visible.surfaces || !composer.bare.is_empty() => shades.of_nodes(body),
            _ => Vec::new(),
        };
        let flat = body.dimension == Dimension::Plane;
        Self {
            composer,
            scene,
            body,
            run,
            framing,
            viewport,
            clear: layout::clear_of_words(viewport, view, scale),
            scale,
            key: key_light(&lens),
            origin: framing.target,
            side: view.side,
            position,
            shades,
            of_nodes,
            element: lens.focal * view.side / if flat { 1.0 } else { framing.distance },
            flat,
            diverged,
            greyed,
            palette: if greyed { composer.palette.greyed() } else { composer.palette },
            lens,
        }
    }

    /// Draws the panel, with items below and above lit bodies.
    pub(super) fn panel(&self, under: &mut Vec<Item>, above: &mut Vec<Item>) -> Panel {
        if self.flat { self.in_plane(None, under, above) } else { self.in_space(above) }
    }

    /// Draws a panel in the plane, which has no lit body; `behind` lies behind the body, and may lie anywhere in the
    /// panel.
    pub(super) fn in_plane(&self, behind: Option<Item>, under: &mut Vec<Item>, above: &mut Vec<Item>) -> Panel {
        let mut lines = SurfaceLines::default();
        let [sound, turned_over] = self.surfaces(&mut lines);
        self.marks_of_plane(under, above);
        let obstacles = obstacle::PlaneObstacles { site: self.site(), line_scale: self.scale.line() };
        obstacles.arrows(&self.pointers(self.viewport), above);
        let (obstacles, staged) = obstacles.draw();
        let region = if behind.is_some() { self.viewport } else { self.region(&staged.outermost) };
        let fading = self.fading(obstacles.iter().map(|[outline, ..]| outline.iter().copied()));
        let (lines, strokes) = (lines.drawn, self.strokes());
        let body = PlaneBody { draft: self, behind, obstacles, fading, sound, turned_over, lines, strokes };
        under.push(body.item(region));
        self.hands(above);
        self.arrows(above);
        self.without_body(region)
    }

    /// Draws a panel in space.
    fn in_space(&self, above: &mut Vec<Item>) -> Panel {
        let mut lines = SurfaceLines::default();
        let [sound, turned_over] = self.surfaces(&mut lines);
        let SurfaceLines { drawn: mut lines, borders } = lines;
        let of_body = lines.len();
        let mut arrows = Vec::new();
        let (mut obstacles, staged) = self.obstacles([&sound, &turned_over], &mut lines, &mut arrows);
        self.fade_obstacles(&mut obstacles, above);
        above.extend(arrows);
        let borders = borders.into_iter().map(|border| border.line).chain(lines[of_body..].iter().copied()).collect();
        self.hands(above);
        self.arrows(above);
        Panel {
            floor: self.floor(&staged),
            sound,
            turned_over,
            dotted: self.run.snapshot.flat.contains(&true),
            greyed: self.greyed,
            lines,
            borders,
            obstacles,
            strokes: self.strokes(),
            beads: self.beads(),
            ..self.without_body(self.region(&staged.outermost))
        }
    }

    /// The panel without a lit body.
    fn without_body(&self, region: Rectangle) -> Panel {
        let (floor, sound, turned_over, dotted, greyed) = Default::default();
        let (lines, borders, obstacles, strokes, beads) = Default::default();
        Panel {
            viewport: self.viewport,
            region,
            sight: self.sight(),
            floor,
            sound,
            turned_over,
            dotted,
            greyed,
            lines,
            borders,
            obstacles,
            strokes,
            beads,
            is_cut: self.is_cut(),
        }
    }

    /// Camera and light.
    fn sight(&self) -> Sight {
        let Self { lens, origin, side, .. } = self;
        Sight {
            clip: lens.clip(*origin, *side, self.viewport.map(f64::from)),
            eye: narrow_point((lens.eye - origin) / side),
            near: narrow(lens.near_in(*side)),
            focal: narrow(if self.flat { lens.focal * side } else { lens.focal }),
            key: narrow_point(self.key),
            flat: self.flat,
            line_scale: narrow(self.scale.line()),
            soft: narrow(self.composer.soft),
            element: narrow(self.element),
            contour_share: narrow(self.contour_share()),
            middle: self.middle(),
        }
    }

    /// The width of the body's contours, relative to the usual one.
    fn contour_share(&self) -> f64 {
        if self.diverged {
            return 1.0;
        }
        let nodes = self.composer.skin.nodes.iter().filter_map(|&node| self.position.get(node as usize));
        let pixels = nodes.filter_map(|&at| self.lens.project(at)).map(|(pixel, _)| DVec2::from(pixel));
        let none = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        let [low, high] = pixels.fold(none, |[low, high], at| [low.min(at), high.max(at)]);
        let widest = (high - low).max_element() / self.scale.line();
        let share = ((widest - SMALL_BODY[0]) / (SMALL_BODY[1] - SMALL_BODY[0])).clamp(0.0, 1.0);
        1.0 - (1.0 - LEAST_CONTOUR) * (1.0 - share * share * (3.0 - 2.0 * share))
    }

    /// The pixel of the body's middle.
    pub(super) fn middle(&self) -> [f32; 2] {
        let middle = self.position.iter().sum::<DVec3>() / self.position.len().max(1) as f64;
        self.lens.project(middle).map_or([0.0; 2], |(pixel, _)| pixel.map(narrow))
    }

    /// Floors, nodes and ring arrows of the plane.
    fn marks_of_plane(&self, under: &mut Vec<Item>, above: &mut Vec<Item>) {
        let visible = self.scene.view.visible;
        let flat = plane::PlaneMarks {
            body: self.body,
            ears: &self.composer.ears,
            position: &self.position,
            turned_over: &self.run.snapshot.turned_over,
            lens: &self.lens,
            moves: self.framing.moves,
            viewport: self.viewport,
            clear: self.clear,
            floors: [self.scene.view.floor != FloorStyle::None, self.scene.view.shadow],
            scale: self.scale,
            palette: &self.palette,
        };
        flat.floors(&self.scene.obstacles, self.run.snapshot.time, under);
        if visible.surfaces && !self.diverged {
            flat.signs(above);
        }
        if visible.nodes && !self.diverged {
            let colour = |node: usize| {
                let place = self.of_nodes.get(node).copied().filter(|&place| place != NOWHERE);
                place.filter(|_| !visible.surfaces).map(|place| field::colour(&self.composer.ramp, place))
            };
            flat.nodes(self.element, &colour, above);
        }
    }

    /// The obstacles at the moment of the panel.
    fn site(&self) -> Site<'_> {
        Site {
            obstacles: &self.scene.obstacles,
            time: self.run.snapshot.time,
            frame: 1.0 / self.scene.frames_per_second,
            lens: &self.lens,
            origin: self.origin,
            side: self.side,
            extent: self.composer.extent,
            palette: &self.composer.palette,
        }
    }

    /// All obstacles in space but the ground, with their lines and marks.
    fn obstacles(&self, surfaces: [&Mesh; 2], lines: &mut Vec<Line>, above: &mut Vec<Item>) -> (Obstacles, Staged) {
        let staging = Staging {
            site: self.site(),
            cell: self.cell(),
            ground: geometry::ground(&self.scene.obstacles, self.run.snapshot.time),
            position: &self.position,
            skin: (self.scene.view.visible.surfaces && !self.diverged).then_some(&self.composer.skin),
            soft: self.composer.soft * self.side,
            start: self.composer.start_box,
            reach: &self.composer.reach,
        };
        staging.arrows(&self.pointers(self.viewport), above);
        staging.pierced(&surfaces, lines);
        staging.draw(lines)
    }

    /// Marks on nodes that are held or dragged.
    fn hands(&self, above: &mut Vec<Item>) {
        if self.diverged {
            return;
        }
        let hands = Hands {
            grips: &self.scene.grips,
            time: self.run.snapshot.time,
            frame: 1.0 / self.scene.frames_per_second,
            position: &self.position,
            skin: &self.composer.skin,
            element: self.element,
            viewport: self.viewport,
            scale: self.scale,
            palette: &self.composer.palette,
            pointers: &self.pointers(self.between_words()),
        };
        hands.draw(above);
    }

    /// Displacements.
    fn arrows(&self, above: &mut Vec<Item>) {
        let view = &self.scene.view;
        if !view.visible.displacements || self.diverged || self.position.is_empty() {
            return;
        }
        let arrows = Arrows {
            lens: &self.lens,
            room: self.clear,
            size: arrows::size(self.element, self.scale.unit),
            node: if view.visible.nodes { node_radius(self.scale, self.element) } else { 0.0 },
            times: view.arrow_scale,
            colour: match self.scene.runs.get(self.run.run) {
                Some(run) if view.colour.is_none() => run.line(&self.composer.palette).colour,
                // An arrow of the run's colour would not stand out among the colours of a field.
                _ => self.composer.palette.text,
            },
            halo: self.composer.palette.background,
        };
        arrows.draw(&self.facing_bearers(), &self.body.rest, &self.position, &self.run.snapshot.placement, above);
    }

    /// The nodes with arrows and their opacity: 0 if all faces of a node in space are turned away.
    fn facing_bearers(&self) -> Vec<(u32, f64)> {
        let Composer { skin, bearers, .. } = self.composer;
        if !self.scene.view.visible.surfaces {
            return bearers.iter().map(|&node| (node, 1.0)).collect();
        }
        let on_skin = skin.visible(&self.position, &self.lens);
        let mut visible = vec![1.0; self.position.len()];
        skin.nodes.iter().for_each(|&node| visible[node as usize] = on_skin[node as usize]);
        bearers.iter().map(|&node| (node, visible[node as usize])).collect()
    }

    /// The part of the panel without words, over its whole width.
    pub(super) fn between_words(&self) -> Rectangle {
        let ([left, _, width, _], [_, top, _, height]) = (self.viewport, self.clear);
        [left, top, width, height]
    }

    /// A point (m) in the panel's coordinates.
    pub(super) fn relative(&self, point: DVec3) -> [f32; 3] {
        narrow_point((point - self.origin) / self.side).to_array()
    }

    /// Draws the arrows of moving objects, in a room.
    fn pointers(&self, room: Rectangle) -> Pointers<'_> {
        Pointers { lens: &self.lens, room, scale: self.scale, palette: &self.composer.palette }
    }
}

/// Clamps too large coordinates, so that arithmetic with them stays finite.
fn finite(points: &[DVec3], farthest: f64) -> Cow<'_, [DVec3]> {
    if points.iter().all(|point| point.abs().cmple(DVec3::splat(farthest)).all()) {
        return Cow::Borrowed(points);
    }
    let one = |value: f64| if value.is_nan() { 0.0 } else { value.clamp(-farthest, farthest) };
    points.iter().map(|&DVec3 { x, y, z }| DVec3::new(one(x), one(y), one(z))).collect()
}
