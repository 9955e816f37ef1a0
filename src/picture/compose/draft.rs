//! The data for all parts of a panel.

use super::Composer;
use super::bodies::Bodies;
use crate::colour::{LINE_CONTRAST, readable};
use crate::look::{BODIES, Palette};
use crate::picture::camera::Lens;
use crate::picture::field::Shades;
use crate::picture::layout::steps::SHORT;
use crate::picture::layout::{self, Rectangle, Scale};
use crate::picture::narrow::{narrow, narrow_count, narrow_point};
use crate::picture::plane::sides;
use crate::picture::shadow::key_light;
use crate::picture::{Colour, Framing, Line, LineKind};
use crate::runner::RunFrame;
use crate::scene::Scene;
use crate::sim::{Assembly, Body, Dimension, Snapshot, Status};
use glam::{DVec2, DVec3};
use std::borrow::Cow;
use std::cell::OnceCell;

/// Coordinates of diverged runs are clamped to this (sides).
const FARTHEST: f64 = 1e12;

/// One panel while it is composed, with the data for all its parts.
pub(super) struct Draft<'a> {
    pub(super) composer: &'a Composer<'a>,
    pub(super) scene: &'a Scene,
    pub(super) bodies: &'a Bodies<'a>,
    /// All bodies as one.
    pub(super) body: &'a Body,
    pub(super) run: usize,
    /// The shown state of the run.
    pub(super) snapshot: &'a Snapshot,
    pub(super) framing: &'a Framing,
    pub(super) viewport: Rectangle,
    /// The part of it without words.
    pub(super) clear: Rectangle,
    /// The part of it between words, over its whole width.
    pub(super) room: Rectangle,
    /// The runs at the same moment.
    pub(super) others: &'a [RunFrame],
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
    /// The points of the skin (m); empty if not all nodes are known.
    pub(super) skin: Vec<DVec3>,
    /// The boxes around its parts (px).
    pub(super) boxes: OnceCell<Vec<PixelBox>>,
    /// The shown field.
    pub(super) shades: Option<Shades>,
    /// Its places on the colour scale at the nodes, if lines or discs show them.
    pub(super) of_nodes: Vec<f32>,
    /// The colours of bodies, visible as lines.
    pub(super) lines_of_bodies: [Colour; BODIES],
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
        let (view, bodies) = (&scene.view, composer.bodies(run.run));
        let body = bodies.body();
        let snapshot = run.shown();
        let greyed = snapshot.status != Status::Ok;
        let lens = Lens::new(view, framing, body.dimension(), viewport.map(f64::from), scale.unit);
        // Without positions nothing is drawn.
        let position = if snapshot.position.len() == body.len() { &snapshot.position[..] } else { &[] };
        let position = finite(position, FARTHEST * view.side);
        // A greyed body shows no values.
        let field = if greyed { &[][..] } else { &snapshot.field[..] };
        // If springs show their strain, the body has no colours.
        let shown = view.colour.as_ref().filter(|_| composer.strain_of_springs(run.run).is_none());
        let shades = shown.map(|scale| Shades::new(body, scale, field));
        let of_nodes = match &shades {
            _ if view.visible.surfaces && bodies.bare.is_empty() => Vec::new(),
            Some(shades) => shades.of_nodes(body),
            None => places_of_bodies(bodies.assembly),
        };
        let flat = body.dimension() == Dimension::Plane;
        let clear = layout::clear_of_words(viewport, view, scale);
        let palette = if greyed { composer.palette.greyed() } else { composer.palette };
        Self {
            composer,
            scene,
            bodies,
            body,
            run: run.run,
            snapshot,
            framing,
            viewport,
            clear,
            room: [viewport[0], clear[1], viewport[2], clear[3]],
            others: &[],
            scale,
            key: key_light(lens.right),
            origin: framing.target,
            side: view.side,
            skin: bodies.skin.points(&position),
            boxes: OnceCell::new(),
            position,
            shades,
            of_nodes,
            element: lens.focal * bodies.side / if flat { 1.0 } else { framing.distance },
            flat,
            diverged: run.has_diverged() && run.last_fit.is_none(),
            greyed,
            palette,
            lines_of_bodies: if flat { palette.bodies_flat } else { palette.bodies }
                .map(|colour| readable(colour, palette.background, LINE_CONTRAST)),
            lens,
        }
    }

    /// The colours of lines and nodes with a place in `of_nodes`.
    pub(super) fn ramp(&self) -> &[Colour] {
        match self.shades {
            Some(_) => &self.composer.ramp,
            None => &self.lines_of_bodies,
        }
    }

    /// The sides of a part of the picture and of some room around it, where lines are cut: their ends are not seen (px).
    pub(super) fn around(&self, room: Rectangle) -> [f64; 4] {
        let ([left, top, right, bottom], more) = (sides(room.map(f64::from)), SHORT * self.scale.line());
        [left - more, top - more, right + more, bottom + more]
    }

    /// The pixel of a point (m), if it is before the camera.
    pub(super) fn pixel(&self, point: DVec3) -> Option<DVec2> {
        self.lens.project(point).map(|(pixel, _)| pixel.into())
    }

    /// The box around each part of the skin (px).
    pub(super) fn boxes(&self) -> &[PixelBox] {
        self.boxes.get_or_init(|| {
            let parts = self.bodies.parts.iter().cloned();
            parts.map(|part| PixelBox::new(&self.lens, self.skin.get(part).unwrap_or_default())).collect()
        })
    }

    /// The positions of the nodes that belong to more than broken elements (m).
    pub(super) fn whole(&self) -> Cow<'_, [DVec3]> {
        let whole = self.whole_nodes().filter(|_| !self.position.is_empty());
        let Some(whole) = whole else { return Cow::Borrowed(&self.position[..]) };
        self.position.iter().zip(whole).filter(|(_, whole)| *whole).map(|(&at, _)| at).collect()
    }

    /// Whether each node belongs to more than broken elements; `None` if no element is broken.
    pub(super) fn whole_nodes(&self) -> Option<Vec<bool>> {
        let broken = &self.snapshot.broken;
        broken.contains(&true).then(|| {
            let mut whole = vec![false; self.body.len()];
            let elements = self.body.elements().iter().zip(broken).filter(|(_, broken)| !*broken);
            elements.flat_map(|(nodes, _)| nodes).for_each(|&node| whole[node as usize] = true);
            whole
        })
    }

    /// The points of carried surfaces (m), body after body.
    pub(super) fn carried(&self) -> &[DVec3] {
        self.skin.get(self.bodies.skin.nodes.len()..).unwrap_or_default()
    }

    /// A line between two points (m).
    pub(super) fn line(&self, [from, to]: [DVec3; 2], kind: LineKind, strength: f64) -> Line {
        Line { from: self.relative(from), to: self.relative(to), kind, strength: narrow(strength) }
    }

    /// A point (m) in the panel's coordinates.
    pub(super) fn relative(&self, point: DVec3) -> [f32; 3] {
        narrow_point((point - self.origin) / self.side).to_array()
    }
}

/// The box around points in the picture.
pub(super) struct PixelBox {
    /// The lower and the upper corner of the box around points before the camera (px).
    pub(super) corners: [DVec2; 2],
    /// Whether all points are before the camera.
    pub(super) is_ahead: bool,
}

impl PixelBox {
    /// The box around points (m).
    pub(super) fn new<'p>(lens: &Lens, points: impl IntoIterator<Item = &'p DVec3>) -> Self {
        let mut all = Self { corners: [DVec2::INFINITY, DVec2::NEG_INFINITY], is_ahead: true };
        for &point in points {
            let [low, high] = all.corners;
            match lens.project(point).map(|(pixel, _)| DVec2::from(pixel)) {
                Some(pixel) => all.corners = [low.min(pixel), high.max(pixel)],
                None => all.is_ahead = false,
            }
        }
        all
    }
}

/// The place of each node among the colours of bodies; empty for one body.
fn places_of_bodies(bodies: &Assembly) -> Vec<f32> {
    let all = (0..bodies.bodies().len()).filter(|_| bodies.bodies().len() > 1);
    let place = |body: usize| narrow_count(body % BODIES) / narrow_count(BODIES - 1);
    all.flat_map(|body| std::iter::repeat_n(place(body), bodies.nodes(body).len())).collect()
}

/// Clamps too large coordinates, so that arithmetic with them stays finite.
fn finite(points: &[DVec3], farthest: f64) -> Cow<'_, [DVec3]> {
    if points.iter().all(|point| point.abs().cmple(DVec3::splat(farthest)).all()) {
        return Cow::Borrowed(points);
    }
    let one = |value: f64| if value.is_nan() { 0.0 } else { value.clamp(-farthest, farthest) };
    points.iter().map(|&DVec3 { x, y, z }| DVec3::new(one(x), one(y), one(z))).collect()
}
