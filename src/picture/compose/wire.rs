//! Lines instead of surfaces: the springs of a model, or the edges of the elements.

use super::draft::Draft;
use super::edges::Edges;
use crate::colour::{Colour, mixed};
use crate::look::ColourScale;
use crate::picture::field::{self, NOWHERE};
use crate::picture::measures::SMALL_ELEMENT;
use crate::picture::narrow::narrow;
use crate::picture::order::farthest_first;
use crate::picture::shell::is_broken;
use crate::picture::{Bead, Second, Stroke};
use crate::sim::Body;
use glam::DVec3;

/// Width of springs, of edges, of edges of turned-over elements and of elements without faces that a field colours (px
/// in the reference picture).
const SPRING: f64 = 1.9;
const EDGE: f64 = 1.3;
const ALARM_EDGE: f64 = 2.2;
const BARE: f64 = 2.0;
/// The extra width of lines that a field colours, as room for a casing.
const CASED: f64 = 1.9;
/// Opacity of a spring behind a surface (of 255).
const BEHIND: f64 = 28.0;
/// Small elements get thinner lines, down to this part of their width, and fainter ones behind surfaces. Elements without faces are lines
/// alone, and stay wider.
const THINNEST: f64 = 0.2;
const THINNEST_BARE: f64 = 0.6;
/// Springs of smaller elements (px) are left out behind surfaces: even the faintest would be too many.
const SEEN_THROUGH: f64 = 8.0;
/// The share of the background in the colour of the farthest line or node, as a depth cue without surfaces.
const HAZE: f64 = 0.62;
/// The reduction of this share for springs coloured by their strain, at full strain: these have the colours of the key.
const STRAINED_HAZE: f64 = 0.8;
/// The number of steps of strain by which springs are stacked; within a step the nearest lie on top.
const STRAIN_STEPS: f64 = 8.0;
/// A line between two places on a scale farther apart than this is divided, so that it shows the colours between.
const LONGEST_STEP: f64 = 0.05;

/// A line, and the distance of its middle from the eye (m).
type Placed = (f64, Stroke);

/// Draws the lines of one panel.
pub(super) struct Wire<'a> {
    draft: &'a Draft<'a>,
    /// The field that colours lines and nodes without surfaces: its colours, and a place for each node.
    pub(super) shades: Option<(&'a [Colour], &'a [f32])>,
    /// Whether lines stand for elements without faces.
    is_bare: bool,
    /// The least and the greatest depth of nodes (m), between which haze grows; `None` without haze.
    depths: Option<[f64; 2]>,
}

impl<'a> Wire<'a> {
    pub(super) fn new(draft: &'a Draft<'a>) -> Self {
        let shades = (!draft.of_nodes.is_empty()).then_some((draft.ramp(), &draft.of_nodes[..]));
        let depths = || {
            let depths = draft.position.iter().map(|point| point.dot(draft.lens.forward));
            depths.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
        };
        let depths = (!draft.scene.view.visible.surfaces).then(depths);
        let depths = depths.filter(|[low, high]| high - low >= 1e-9 * draft.side);
        Self { draft, shades, is_bare: false, depths }
    }

    /// The wire without the colours of a field if surfaces show them.
    pub(super) fn without_surfaces(&self) -> Self {
        Self { shades: self.shades.filter(|_| !self.surfaces()), ..*self }
    }

    /// Whether surfaces are drawn, too.
    fn surfaces(&self) -> bool {
        self.draft.scene.view.visible.surfaces
    }

    /// Whether springs inside the body are invisible.
    pub(super) fn hides_inside(&self) -> bool {
        self.surfaces() && self.draft.element < SEEN_THROUGH
    }

    /// Springs, the farthest first. With a scale and its colours, each has the colour of its strain, and more strained
    /// ones lie above the others.
    pub(super) fn springs(&self, springs: &[[u32; 2]], strain: Option<(&[Colour], ColourScale)>) -> Vec<Stroke> {
        let palette = &self.draft.palette;
        if let Some((ramp, scale)) = strain {
            let strokes = springs.iter().map(|&nodes| {
                let strain = spring_strain(self.draft.body, &self.draft.position, nodes);
                let share = strained_share(strain, scale.range);
                let place = field::place(scale.of_spring(strain), scale.range);
                let own = if place == NOWHERE { palette.spring } else { field::colour(ramp, place) };
                let ends = nodes.map(|node| self.draft.position[node as usize]);
                let haze = STRAINED_HAZE * self.haze(ends[0].midpoint(ends[1])) * (1.0 - share);
                let [own, casing] = [own, palette.casing].map(|colour| mixed(colour, palette.background, haze));
                let (depth, stroke) = self.straight(ends, [own; 2], Some(casing), SPRING);
                (depth, ((share * STRAIN_STEPS).round(), stroke))
            });
            let mut strokes: Vec<_> = farthest_first(strokes.collect()).collect();
            strokes.sort_by(|(one, _), (other, _)| one.total_cmp(other));
            return strokes.into_iter().map(|(_, stroke)| stroke).collect();
        }
        let mut strokes = Vec::with_capacity(springs.len());
        for &ends in springs {
            self.stroke(ends, palette.spring, SPRING, &mut strokes);
        }
        if self.surfaces() {
            let second = Second::OnBody(palette.spring_on_body);
            strokes.iter_mut().for_each(|(_, stroke)| stroke.second = second);
        }
        farthest_first(strokes).collect()
    }

    /// The edges of all elements, the farthest first, and the edges of turned-over ones again above them.
    pub(super) fn edges(
        &self,
        edges: &Edges,
        [turned_over, broken]: [&[bool]; 2],
        only_turned_over: bool,
    ) -> Vec<Stroke> {
        let palette = &self.draft.palette;
        let (mut strokes, mut alarm) = (Vec::new(), Vec::new());
        let whole = || edges.of_elements.iter().enumerate().filter(|(at, _)| !is_broken(broken, *at as u32));
        if !only_turned_over {
            for &ends in edges.of_whole(broken).iter() {
                self.stroke(ends, palette.spring, EDGE, &mut strokes);
            }
            for (element, edges) in whole().filter(|(_, edges)| edges.is_empty()) {
                self.element(element, edges, palette.spring, EDGE, &mut strokes);
            }
        }
        let plain = Wire { shades: None, ..*self };
        for (element, edges) in whole().filter(|(at, _)| turned_over.get(*at).is_some_and(|&over| over)) {
            plain.element(element, edges, palette.alarm, ALARM_EDGE, &mut alarm);
        }
        farthest_first(strokes).chain(farthest_first(alarm)).collect()
    }

    /// Elements without faces, coloured by a field like the surfaces beside them.
    pub(super) fn bare(&self, elements: &[usize], [turned_over, broken]: [&[bool]; 2]) -> Vec<Stroke> {
        let (mut strokes, lines, palette) = (Vec::new(), Wire { is_bare: true, ..*self }, &self.draft.palette);
        for &element in elements.iter().filter(|&&element| !is_broken(broken, element as u32)) {
            let edges = self.draft.body.topology().edges_of(element);
            lines.element(element, &edges, palette.edge, BARE, &mut strokes);
            if turned_over.get(element).is_some_and(|&over| over) {
                let plain = Wire { shades: None, ..lines };
                plain.element(element, &edges, palette.alarm, EDGE, &mut strokes);
            }
        }
        strokes.into_iter().map(|(_, stroke)| stroke).collect()
    }

    /// Nodes, the farthest first.
    pub(super) fn beads(&self, radius: f64) -> Vec<Bead> {
        let nodes = self.draft.position.iter().enumerate().map(|(node, &at)| (self.depth(at), node));
        let bead = |node: usize| {
            // A disc is light, so that its rim is visible; distant rims are fainter.
            let faded = 0.8 * self.haze(self.draft.position[node]);
            Bead {
                at: self.draft.relative(self.draft.position[node]),
                radius: narrow(radius),
                colour: mixed(
                    self.place_colour(node as u32).unwrap_or(self.draft.palette.node),
                    self.draft.palette.background,
                    0.5 * faded,
                ),
                rim: mixed(self.draft.palette.edge, self.draft.palette.background, faded),
            }
        };
        farthest_first(nodes.collect()).map(bead).collect()
    }

    /// The edges of an element or, if it has none, lines from its middle to its nodes.
    fn element(&self, element: usize, edges: &[[u32; 2]], colour: Colour, width: f64, strokes: &mut Vec<Placed>) {
        edges.iter().for_each(|&ends| self.stroke(ends, colour, width, strokes));
        if edges.is_empty() {
            let nodes = &self.draft.body.elements()[element];
            let at = |node: u32| self.draft.position[node as usize];
            let middle = nodes.iter().map(|&node| at(node)).sum::<DVec3>() / nodes.len() as f64;
            strokes.extend(nodes.iter().map(|&node| {
                let own = self.place_colour(node);
                let casing = own.map(|_| self.draft.palette.casing);
                self.straight([middle, at(node)], [own.unwrap_or(colour); 2], casing, width)
            }));
        }
    }

    /// A line between two nodes, divided where its colours require it.
    fn stroke(&self, [a, b]: [u32; 2], colour: Colour, width: f64, strokes: &mut Vec<Placed>) {
        let [from, to] = [a, b].map(|node| self.draft.position[node as usize]);
        let faded = |colour, point| mixed(colour, self.draft.palette.background, self.haze(point));
        let places = self.shades.map(|(ramp, places)| (ramp, [a, b].map(|node| places[node as usize])));
        let Some((ramp, places)) = places.filter(|(_, places)| !places.contains(&NOWHERE)) else {
            let colours = [from, to].map(|end| faded(colour, end));
            return strokes.push(self.straight([from, to], colours, None, width));
        };
        let places = places.map(f64::from);
        let pieces = ((places[1] - places[0]).abs() / LONGEST_STEP).ceil().max(1.0);
        for piece in 0..pieces as usize {
            let shares = [piece, piece + 1].map(|at| at as f64 / pieces);
            let ends = shares.map(|share| from.lerp(to, share));
            let colours = shares.map(|share| field::colour(ramp, narrow(places[0] + (places[1] - places[0]) * share)));
            let casing = faded(self.draft.palette.casing, from.lerp(to, shares[0].midpoint(shares[1])));
            strokes.push(self.straight(ends, colours, Some(casing), width));
        }
    }

    /// A straight line. A casing keeps lines of all colours visible, over surfaces, the ground and other lines.
    fn straight(&self, ends: [DVec3; 2], colours: [Colour; 2], casing: Option<Colour>, width: f64) -> Placed {
        let width = if casing.is_some() { CASED * width } else { width };
        let thinnest = if self.is_bare { THINNEST_BARE } else { THINNEST };
        let strength = (self.draft.element / f64::from(SMALL_ELEMENT)).clamp(0.0, 1.0);
        let behind = (BEHIND * strength * strength).round() as u8;
        let stroke = Stroke {
            ends: ends.map(|end| self.draft.relative(end)),
            colours,
            second: casing.map_or(Second::None, Second::Casing),
            behind: if self.surfaces() { behind.max(1) } else { 0 },
            width: narrow(width * self.draft.scale.line() * strength.max(thinnest)),
        };
        (self.depth(ends[0].midpoint(ends[1])), stroke)
    }

    /// The distance of a point from the eye (m), along its line of sight.
    fn depth(&self, point: DVec3) -> f64 {
        (point - self.draft.lens.eye).dot(self.draft.lens.forward)
    }

    fn place_colour(&self, node: u32) -> Option<Colour> {
        let (ramp, places) = self.shades?;
        let place = places.get(node as usize).copied().filter(|&place| place != NOWHERE)?;
        Some(field::colour(ramp, place))
    }

    /// The share of the background at a point; zero with surfaces.
    fn haze(&self, point: DVec3) -> f64 {
        let deep = |[low, high]: [f64; 2]| (point.dot(self.draft.lens.forward) - low) / (high - low);
        self.depths.map_or(0.0, |depths| HAZE * deep(depths).clamp(0.0, 1.0))
    }
}

/// The strain of a spring relative to a scale between two strains: 1 at its nearer end, or beyond.
fn strained_share(strain: f64, [low, high]: [f64; 2]) -> f64 {
    let ends = [-low, high].into_iter().filter(|&end| end > 0.0);
    let share = strain.abs() / ends.fold(f64::INFINITY, f64::min);
    if share.is_nan() { 0.0 } else { share.min(1.0) }
}

/// The change of the distance of two nodes over their distance at rest; NaN if that is zero.
pub(super) fn spring_strain(body: &Body, position: &[DVec3], ends: [u32; 2]) -> f64 {
    let length = |points: &[DVec3]| points[ends[0] as usize].distance(points[ends[1] as usize]);
    let rest = length(body.rest());
    if rest > 0.0 { length(position) / rest - 1.0 } else { f64::NAN }
}
