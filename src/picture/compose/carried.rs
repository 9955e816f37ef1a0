//! Fine surfaces that coarse bodies carry, in the meshes and lines of a picture.

use crate::look::BODIES;
use crate::picture::chart::needed;
use crate::picture::compose::fine::{Fine, NONE, OF_THREAD};
use crate::picture::compose::rim::{Rim, Turned};
use crate::picture::compose::surface::{Border, SurfaceLines, Surfaces};
use crate::picture::ears::newell;
use crate::picture::narrow::{narrow, narrow_count, narrow_point};
use crate::picture::page::{self, joined};
use crate::picture::shell::Side;
use crate::picture::{LineKind, Mesh, Vertex};
use crate::sim::geometry::{around, ordered};
use glam::DVec3;
use rayon::prelude::*;

/// Points of contours and creases that lie nearer than this to the straight line between others are left out (px).
const STRAIGHT: f64 = 0.15;

impl Surfaces<'_> {
    /// Adds a carried surface with its points at positions (m) to the meshes of sound and of turned-over elements, and its
    /// lines to the lines. `of_nodes` has the places of nodes on the scale of a field, if there is one.
    pub(super) fn add_carried(
        &self,
        fine: &Fine,
        points: &[DVec3],
        [over, broken]: [&[bool]; 2],
        of_nodes: &[f32],
        [sound, turned_over]: [&mut Mesh; 2],
        lines: &mut SurfaceLines,
    ) {
        let (origin, per_side) = (self.draft.origin, 1.0 / self.draft.side);
        let place = |at: &DVec3| narrow_point((at - origin) * per_side);
        let (eye, mut places) = (place(&self.draft.lens.eye), Vec::new());
        points.par_iter().with_min_len(OF_THREAD).map(place).collect_into_vec(&mut places);
        let gone = fine.gone(self.draft.bodies.assembly, broken);
        let faces = fine.seen(&places, &gone, eye);
        let vertex = |corner: usize| {
            let at = places[fine.points[corner] as usize];
            Vertex { position: at.to_array(), normal: fine.normal(corner, at, &faces, eye).to_array(), hatch: 0.0 }
        };
        let base = sound.vertices.len();
        sound.vertices.par_extend((0..fine.points.len()).into_par_iter().with_min_len(OF_THREAD).map(vertex));
        if !self.colours().is_empty() {
            sound.shades.resize(sound.vertices.len(), -1.0 - narrow_count(fine.body % BODIES));
        } else if self.draft.shades.is_some() {
            let shades = fine.shades(of_nodes);
            sound.shades.extend(fine.points.iter().map(|&point| shades[point as usize]));
        }
        let seen = faces.1;
        let is_whole = |at: usize| gone.get(at).is_none_or(|gone| !gone);
        let over = over.get(fine.elements.clone()).filter(|over| over.contains(&true)).unwrap_or_default();
        let turned =
            |&mover: &u32| if over.get(mover as usize).is_some_and(|&over| over) { Turned::Yes } else { Turned::No };
        let mut turned: Vec<_> = if over.is_empty() { Vec::new() } else { fine.movers.iter().map(turned).collect() };
        let mut rim = Rim::default();
        if !over.is_empty() {
            rim = Rim::new(fine, &self.draft.bodies.assembly.bodies()[fine.body], over, &mut turned);
            rim.add_corners(&mut sound.vertices, &mut sound.shades, base);
        }
        // From outside nobody sees the inside of a closed surface of which no part has turned over or is gone.
        let is_shut = fine.is_closed && turned.is_empty() && gone.is_empty();
        let sides: &[bool] = if is_shut { &[true] } else { &[true, false] };
        let is_sound = |at: usize| is_whole(at) && turned.get(at).is_none_or(|&turned| turned == Turned::No);
        let parts = |over: bool| rim.parts.iter().filter(move |part| part.2 == over && is_whole(part.0));
        for &side in sides {
            let shown = fine.triangles.iter().enumerate().filter(|&(at, _)| seen[at] == side && is_sound(at));
            let cut = parts(false).filter(|part| seen[part.0] == side).map(|part| part.1);
            let corners = shown.map(|(_, triangle)| *triangle).chain(cut);
            sound.triangles.extend(corners.map(|triangle| triangle.map(|corner| base as u32 + corner)));
        }
        if is_shut {
            let unseen = fine.triangles.iter().zip(&seen).filter(|(_, seen)| !**seen).map(|(triangle, _)| triangle);
            sound.unseen.extend(unseen.map(|triangle| triangle.map(|corner| base as u32 + corner)));
        }
        let is_over = |&(at, _): &(usize, &[u32; 3])| is_whole(at) && turned.get(at) == Some(&Turned::Yes);
        if !turned.is_empty() {
            let over = fine.triangles.iter().enumerate().filter(is_over).map(|(_, triangle)| *triangle);
            self.add_turned_over(fine, over.chain(parts(true).map(|part| part.1)), &rim, sound, turned_over, base);
        }
        self.add_lines(fine, points, (&seen, &gone), (&turned, &rim), lines);
    }

    /// Adds the contours, creases and borders of a carried surface, by which of its triangles are seen from their front and gone, and by how
    /// turned-over elements move them.
    fn add_lines(
        &self,
        fine: &Fine,
        points: &[DVec3],
        (seen, gone): (&[bool], &[bool]),
        (turned, rim): (&[Turned], &Rim),
        lines: &mut SurfaceLines,
    ) {
        let ends = |edge: usize| fine.edges[edge];
        let is_whole = |at: usize| gone.get(at).is_none_or(|gone| !gone);
        let side = |at: usize| seen.get(at).filter(|_| is_whole(at));
        let edges_where = |holds: &(dyn Fn([usize; 2]) -> bool + Sync)| -> Vec<_> {
            let holds = |beside: &[u32; 2]| holds(beside.map(|at| at as usize));
            let beside = fine.beside.par_iter().with_min_len(OF_THREAD).enumerate();
            beside.filter(|(_, beside)| holds(beside)).map(|(edge, _)| ends(edge)).collect()
        };
        for ends in self.long(&edges_where(&|[one, other]| side(one) != side(other)), points) {
            let line = self.draft.line(ends, LineKind::FineContour, 1.0);
            lines.drawn.push(line);
            lines.borders.push(Border { line, edge: None });
        }
        let are_seen = |&edge: &usize| fine.beside[edge].iter().all(|&at| seen[at as usize]);
        let creases: Vec<_> = fine.creases.iter().map(|&edge| edge as usize).filter(are_seen).map(ends).collect();
        let border = |ends| Border { line: self.draft.line(ends, LineKind::Edge, 1.0), edge: None };
        lines.borders.extend(self.long(&creases, points).into_iter().map(border));
        if turned.is_empty() {
            return;
        }
        // The colours change where turned-over elements begin.
        let state = |at: usize| turned.get(at).filter(|_| is_whole(at));
        let differ = |beside: [usize; 2]| {
            let states = beside.map(state);
            states[0] != states[1] && states.contains(&Some(&Turned::Yes)) && !states.contains(&Some(&Turned::Partly))
        };
        let new = |at: u32| points.len() as u32 + at;
        let cut = rim.lines.iter().filter(|(at, _)| is_whole(*at)).map(|(_, ends)| ends.map(new));
        let rims: Vec<_> = edges_where(&differ).into_iter().chain(cut).collect();
        let place = |corner: u32| points[fine.points[corner as usize] as usize];
        let more = (0..rim.corners.len() as u32).map(|at| rim.place(at, place));
        let points: Vec<_> = points.iter().copied().chain(more).collect();
        for ends in self.long(&rims, &points) {
            lines.borders.push(border(ends));
            lines.drawn.push(self.draft.line(ends, LineKind::AlarmContour, 1.0));
        }
    }

    /// Adds triangles of a carried surface that turned-over elements move. Their corners are in the mesh of sound elements, from a place
    /// on.
    fn add_turned_over(
        &self,
        fine: &Fine,
        triangles: impl Iterator<Item = [u32; 3]>,
        rim: &Rim,
        sound: &Mesh,
        turned_over: &mut Mesh,
        base: usize,
    ) {
        let period = self.hatches[fine.body].period;
        let mut places = vec![NONE; fine.points.len() + rim.corners.len()];
        let rest = |corner: u32| fine.surface.rest[fine.points[corner as usize] as usize];
        for triangle in triangles {
            let corner = |corner: u32| {
                let place = &mut places[corner as usize];
                if *place == NONE {
                    *place = turned_over.vertices.len() as u32;
                    let at = base + corner as usize;
                    let new = corner.checked_sub(fine.points.len() as u32);
                    let rest = new.map_or_else(|| rest(corner), |new| rim.place(new, rest));
                    let hatch = narrow(rest.dot(DVec3::ONE) / period);
                    turned_over.vertices.push(Vertex { hatch, ..sound.vertices[at] });
                    turned_over.shades.extend(sound.shades.get(at));
                }
                *place
            };
            let triangle = triangle.map(corner);
            turned_over.triangles.push(triangle);
        }
    }

    /// Adds the edges of faces that carry a surface to the lines: of sound elements those of faces towards the viewer, of
    /// turned-over elements all.
    pub(super) fn add_cage(&self, faces: &[Side], kind: LineKind, lines: &mut SurfaceLines) {
        let (mut nodes, mut edges) = (Vec::new(), Vec::new());
        for side in faces {
            self.corners(side, &mut nodes);
            let corners: Vec<_> = nodes.iter().map(|&node| self.at(node)).collect();
            if kind.is_alarm() || self.facing(corners[0], newell(&corners)) >= 0.0 {
                edges.extend(around(&nodes).map(ordered));
            }
        }
        edges.sort_unstable();
        edges.dedup();
        lines.drawn.extend(edges.into_iter().map(|ends| self.draft.line(ends.map(|node| self.at(node)), kind, 0.0)));
    }

    /// The ends (m) of lines between pairs of points, joined, and without points that could not be told from straight lines.
    fn long(&self, pairs: &[[u32; 2]], points: &[DVec3]) -> Vec<[DVec3; 2]> {
        let place = |point: u32| points[point as usize];
        let pixel = |point: u32| self.draft.lens.project(place(point)).map_or([f64::NAN; 2], |(pixel, _)| pixel);
        let mut all = Vec::with_capacity(pairs.len());
        for line in joined(pairs, |point| page::point(pixel(point).into())) {
            let needed = needed(&line.iter().map(|&point| pixel(point)).collect::<Vec<_>>(), STRAIGHT);
            let kept: Vec<_> =
                line.into_iter().zip(needed).filter(|&(_, kept)| kept).map(|(at, _)| place(at)).collect();
            all.extend(kept.windows(2).map(|ends| [ends[0], ends[1]]));
        }
        all
    }
}
