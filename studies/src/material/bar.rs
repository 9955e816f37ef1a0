//! Bars along z that are held at one end and loaded at the other.

use super::balance::{dead, hold, rest_of};
use super::{Elements, Model, mean_shift};
use glam::DVec3;
use localshape::sim::model::ElasticModel;
use localshape::sim::{Body, Material, Surroundings};
use std::sync::Arc;

/// A bar.
pub(crate) struct Bar {
    pub(crate) body: Arc<Body>,
    /// Length of a cell's edges (m).
    side: f64,
    /// Width and depth, along y and x (m).
    pub(crate) section: [f64; 2],
    pub(crate) length: f64,
    /// Nodes at its first end, which may be held, and at its last one, which is loaded.
    pub(crate) ends: [Vec<usize>; 2],
}

impl Bar {
    /// A bar of cells of a side (m), along x, y and z, with a density (kg/m³).
    pub(crate) fn new(elements: Elements, cells: [u32; 3], side: f64, density: f64) -> Self {
        let body = elements.block(&cells, side, (0.0, 1), density);
        let [depth, width, length] = cells.map(|cells| f64::from(cells) * side);
        let ends = [-0.5, 0.5].map(|end| Self::layer(&body, end * length, side));
        Self { body, side, section: [width, depth], length, ends }
    }

    fn layer(body: &Body, height: f64, side: f64) -> Vec<usize> {
        (0..body.len()).filter(|&node| (body.rest()[node].z - height).abs() < 1e-6 * side).collect()
    }

    /// A load (N) on the loaded end, on each node in proportion to the area of the end around it.
    pub(crate) fn load(&self, total: DVec3) -> Vec<DVec3> {
        self.load_on(1, total)
    }

    fn load_on(&self, end: usize, total: DVec3) -> Vec<DVec3> {
        let end = &self.ends[end];
        let [low, high] = [f64::min, f64::max].map(|pick| {
            let rest = end.iter().map(|&node| self.body.rest()[node]);
            rest.reduce(|one, other| DVec3::new(pick(one.x, other.x), pick(one.y, other.y), 0.0)).unwrap_or_default()
        });
        let is_rim = |at: f64, low: f64, high: f64| (at - low).abs().min((at - high).abs()) < 1e-6 * self.side;
        let part = |rest: DVec3| {
            let rims = [is_rim(rest.x, low.x, high.x), is_rim(rest.y, low.y, high.y)];
            rims.iter().map(|&is_rim| if is_rim { 0.5 } else { 1.0 }).product::<f64>()
        };
        let whole: f64 = end.iter().map(|&node| part(self.body.rest()[node])).sum();
        let mut load = vec![DVec3::ZERO; self.body.len()];
        end.iter().for_each(|&node| load[node] = total * (part(self.body.rest()[node]) / whole));
        load
    }

    /// What a cantilever has around it: the hold of one end, and a load (N) on the other.
    pub(crate) fn under(&self, load: DVec3) -> Surroundings {
        Surroundings { grips: vec![hold(&self.ends[0])], loads: vec![dead(self.load(load))], ..Surroundings::default() }
    }

    /// The places of its nodes (m) as a cantilever under a load (N), from a start.
    pub(crate) fn bent(&self, model: &dyn ElasticModel, load: DVec3, start: Vec<DVec3>) -> Option<Vec<DVec3>> {
        rest_of(&[(Arc::clone(&self.body), model)], start, &self.under(load), 1.0)
    }

    /// The nodes of the layer nearest to a share of its length from its middle.
    pub(crate) fn layer_at(&self, share: f64) -> Vec<usize> {
        let height = libm::round((share + 0.5) * self.length / self.side) * self.side - 0.5 * self.length;
        Self::layer(&self.body, height, self.side)
    }

    /// The nodes of its loaded end with the least and with the greatest x.
    pub(crate) fn sides(&self) -> [Vec<usize>; 2] {
        [-0.5, 0.5].map(|share| {
            let is_there = |node: usize| (self.body.rest()[node].x - share * self.section[1]).abs() < 1e-6 * self.side;
            self.ends[1].iter().copied().filter(|&node| is_there(node)).collect()
        })
    }

    /// The mean displacement of its loaded end (m).
    pub(crate) fn tip(&self, position: &[DVec3]) -> DVec3 {
        mean_shift(&self.body, position, &self.ends[1])
    }

    /// `E I` (N m²), with the load across the depth.
    pub(crate) fn rigidity(&self, material: Material) -> f64 {
        let [width, depth] = self.section;
        material.young * width * depth * depth * depth / 12.0
    }

    /// A model of a material on the bar, and the material that it is there. For springs that is what one measures by pulling the bar.
    pub(crate) fn model(&self, model: &Model, material: Material) -> Option<(Arc<dyn ElasticModel>, Material)> {
        let made = model.on(&self.body, material, self.side)?;
        let is = if model.is_springs() { self.pulled(made.as_ref(), material)? } else { material };
        Some((made, is))
    }

    /// Young's modulus and Poisson's ratio between a quarter and three quarters of the length, of a free bar that is pulled at both ends by a
    /// little.
    fn pulled(&self, model: &dyn ElasticModel, about: Material) -> Option<Material> {
        const STRAIN: f64 = 1e-6;
        let [width, depth] = self.section;
        let load = STRAIN * about.young * width * depth;
        let ends = [0, 1].map(|end| self.load_on(end, DVec3::Z * load));
        let loads = ends[1].iter().zip(&ends[0]).map(|(&high, &low)| high - low).collect();
        let around = Surroundings { loads: vec![dead(loads)], ..Surroundings::default() };
        let found = rest_of(&[(Arc::clone(&self.body), model)], self.body.rest().to_vec(), &around, 1.0)?;
        let layers = [-0.25, 0.25].map(|share| self.layer_at(share));
        let [low, high] = [0, 1].map(|at| mean_shift(&self.body, &found, &layers[at]).z);
        let [bottom, top] = [0, 1].map(|at| self.body.rest()[layers[at][0]].z);
        let strain = (high - low) / (top - bottom);
        // The sides at half of the depth away from the middle.
        let middle: Vec<_> = layers.iter().flatten().copied().collect();
        let side = |sign: f64| -> Vec<usize> {
            let is_there = |&node: &usize| (self.body.rest()[node].x - 0.5 * sign * depth).abs() < 1e-6 * self.side;
            middle.iter().copied().filter(is_there).collect()
        };
        let [left, right] = [-1.0, 1.0].map(|sign| mean_shift(&self.body, &found, &side(sign)).x);
        Some(Material { young: load / (width * depth * strain), poisson: -(right - left) / depth / strain })
    }
}
