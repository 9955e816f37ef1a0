//! The bodies of a run: the data that all their pictures share. Runs of the same bodies share it, too.

use crate::look::BODIES;
use crate::picture::arrows;
use crate::picture::compose::edges::Edges;
use crate::picture::compose::skin::Skin;
use crate::picture::ears::{Ears, bare_elements};
use crate::picture::shadow;
use crate::picture::shell::is_broken;
use crate::picture::tally::Tally;
use crate::scene::{Run, Scene, SceneBody};
use crate::sim::{Assembly, Body, Dimension, Snapshot};
use glam::DVec3;
use std::ops::Range;
use std::sync::Arc;

/// Bodies with more elements than this along a side get softer light, as if they had larger elements.
const SOFT_SHARE: f64 = 4.5;

/// The bodies of a run.
#[derive(Debug)]
pub(super) struct Bodies<'a> {
    pub(super) assembly: &'a Assembly,
    /// Length of an edge of the smallest elements (m).
    pub(super) side: f64,
    /// The unit of soft distances in light (sides of the panel).
    pub(super) soft: f64,
    /// The same on each body, for its hatch.
    pub(super) soft_of: Vec<f64>,
    /// The elements in rows.
    pub(super) tally: Tally,
    /// The signed area of each polygon of a body in the plane.
    rest_areas: Vec<f64>,
    /// The surface that is seen, and the edges of its faces' triangles if it casts a shadow.
    pub(super) skin: Skin,
    pub(super) seams: Vec<shadow::Edge>,
    /// The points of the skin that belong together: of the elements of each body, and of carried surfaces.
    pub(super) parts: Vec<Range<usize>>,
    /// Whether each element is inside a carried surface; empty if there is none.
    pub(super) inside: Vec<bool>,
    /// The surface of the elements, if others are seen in its place.
    cage: Option<Skin>,
    /// The triangles of faces that are not convex.
    pub(super) ears: Ears,
    /// Elements without faces.
    pub(super) bare: Vec<usize>,
    /// The edges of the elements, if surfaces are not shown.
    pub(super) edges: Edges,
    /// The nodes with arrows.
    pub(super) bearers: Vec<u32>,
    /// The place of each element among the colours of bodies and regions; empty for one body without regions.
    pub(super) colours: Vec<u8>,
}

impl<'a> Bodies<'a> {
    /// The bodies of a run of a scene.
    pub(super) fn new(scene: &'a Scene, run: &'a Run) -> Self {
        let (view, assembly, body) = (&scene.view, &*run.bodies, &**run.body());
        let side = run.of.iter().map(|&at| scene.bodies[at].side).fold(f64::INFINITY, f64::min);
        let soft = |(&at, body): (&usize, &Arc<Body>)| {
            let share = body.extent().max(f64::MIN_POSITIVE) / view.side / SOFT_SHARE;
            share.max(scene.bodies[at].side / view.side)
        };
        let soft_of: Vec<_> = run.of.iter().zip(assembly.bodies()).map(soft).collect();
        let rest_areas = match body.dimension() {
            Dimension::Plane => body.elements().iter().map(|nodes| area(nodes, body.rest())).collect(),
            Dimension::Space => Vec::new(),
        };
        let ears = Ears::new(body);
        let (skin, bare) = (Skin::new(assembly, &ears, view.visible.surfaces), bare_elements(body));
        let cage = (!skin.fine.is_empty()).then(|| Skin::new(assembly, &ears, false));
        let of_elements = cage.as_ref().unwrap_or(&skin);
        let throws_shadow = view.shadow && body.dimension() == Dimension::Space;
        Self {
            assembly,
            side,
            soft: soft_of.iter().sum::<f64>() / soft_of.len() as f64,
            soft_of,
            tally: Tally::new(assembly, side),
            rest_areas,
            seams: if throws_shadow { shadow::edges(&skin.triangles) } else { Vec::new() },
            edges: if view.visible.surfaces { Edges::default() } else { Edges::new(body) },
            bearers: if view.visible.displacements { bearers(body, of_elements, &bare) } else { Vec::new() },
            parts: skin.parts(assembly),
            inside: skin.inside(assembly),
            colours: colours(scene, run),
            skin,
            cage,
            ears,
            bare,
        }
    }

    /// All bodies as one.
    pub(super) fn body(&self) -> &'a Body {
        self.assembly.whole()
    }

    /// The surface of the elements.
    pub(super) fn cage(&self) -> &Skin {
        self.cage.as_ref().unwrap_or(&self.skin)
    }

    /// The nodes of each body.
    pub(super) fn nodes(&self) -> impl Iterator<Item = Range<usize>> {
        (0..self.assembly.bodies().len()).map(|at| self.assembly.nodes(at))
    }

    /// The smallest signed area of a polygon that is not broken over its area at rest, for bodies in the plane.
    pub(super) fn smallest_area_ratio(&self, snapshot: &Snapshot) -> Option<f64> {
        let body = self.body();
        if self.rest_areas.is_empty() || snapshot.position.len() != body.len() {
            return None;
        }
        let whole = (0..).zip(&self.rest_areas).filter(|&(at, rest)| *rest != 0.0 && !is_broken(&snapshot.broken, at));
        let areas = whole.map(|(at, rest)| (&body.elements()[at as usize], rest));
        areas.map(|(nodes, rest)| area(nodes, &snapshot.position) / rest).reduce(f64::min)
    }
}

/// The nodes with arrows: those on the surface, and those of elements without faces.
fn bearers(body: &Body, skin: &Skin, bare: &[usize]) -> Vec<u32> {
    let of_bare = bare.iter().flat_map(|&element| &body.elements()[element]);
    let mut nodes: Vec<u32> = skin.nodes.iter().chain(of_bare).copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    arrows::bearers(&nodes)
}

/// The signed area of a polygon in the xy-plane (m²).
fn area(nodes: &[u32], position: &[DVec3]) -> f64 {
    let at = |node: u32| position[node as usize].truncate() - position[nodes[0] as usize].truncate();
    nodes.windows(2).map(|two| 0.5 * at(two[0]).perp_dot(at(two[1]))).sum()
}

/// The place of each element of a run among the colours of bodies and regions; none for one body without regions.
fn colours(scene: &Scene, run: &Run) -> Vec<u8> {
    let (regions, first) = (scene.names_of_regions(), scene.most_bodies());
    if run.of.len() == 1 && scene.bodies[run.of[0]].regions.is_empty() {
        return Vec::new();
    }
    let place = |place: usize| (place % BODIES) as u8;
    let of_body = |(at, body): (usize, &usize)| {
        let SceneBody { body, regions: own, .. } = &scene.bodies[*body];
        let mut colours = vec![place(at); body.elements().len()];
        for region in own {
            let number = regions.iter().position(|name| *name == region.name).unwrap_or_default();
            region.elements.iter().for_each(|&element| colours[element as usize] = place(first + number));
        }
        colours
    };
    run.of.iter().enumerate().flat_map(of_body).collect()
}
