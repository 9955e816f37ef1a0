//! The properties of a scene that only drawing needs.

use super::{Run, Scene};
use crate::look::{LineStyle, Palette, Plot};
use crate::sim::Diagnostic;
use crate::sim::geometry::bounds;
use crate::sim::model::ElasticModel;
use glam::DVec3;
use std::sync::Arc;

impl Scene {
    /// The diagnostics of a frame in its picture: the number of each run, and the present value in a chart.
    pub(crate) fn frame_diagnostics(&self) -> Vec<Diagnostic> {
        self.view.charts.iter().filter_map(Plot::diagnostic).chain([Diagnostic::ShapeError]).collect()
    }

    /// The size of the bodies of all runs (m).
    pub(crate) fn extent(&self) -> f64 {
        self.runs.iter().map(Run::extent).fold(0.0, f64::max)
    }

    /// The runs whose bodies no earlier run has, and for each run the place of the one with its bodies among them.
    pub(crate) fn distinct_bodies(&self) -> (Vec<usize>, Vec<usize>) {
        let mut distinct: Vec<usize> = Vec::new();
        let place = |(at, run): (usize, &Run)| {
            let known = distinct.iter().position(|&other| Arc::ptr_eq(&self.runs[other].bodies, &run.bodies));
            known.unwrap_or_else(|| {
                distinct.push(at);
                distinct.len() - 1
            })
        };
        let places = self.runs.iter().enumerate().map(place).collect();
        (distinct, places)
    }
}

impl Run {
    /// The size of its largest body at rest (m).
    pub(crate) fn largest(&self) -> f64 {
        self.bodies.bodies().iter().map(|body| body.extent()).fold(0.0, f64::max)
    }

    /// The size of its bodies together (m): of the largest one at rest, and of the box around their middles at the start.
    pub(crate) fn extent(&self) -> f64 {
        let middle = |at: usize| {
            let nodes = &self.initial.position[self.bodies.nodes(at)];
            nodes.iter().sum::<DVec3>() / nodes.len().max(1) as f64
        };
        let middles: Vec<_> = (0..self.bodies.bodies().len()).map(middle).collect();
        let (low, high) = bounds(&middles);
        self.largest() + (high - low).max_element()
    }

    /// The springs of the models of all its bodies.
    pub(crate) fn springs(&self) -> Vec<[u32; 2]> {
        let parts = self.models.iter().enumerate();
        let of_body = |(at, model): (usize, &Arc<dyn ElasticModel>)| {
            let first = self.bodies.nodes(at).start as u32;
            let springs: Vec<_> = model.springs().iter().map(|ends| ends.map(|node| first + node)).collect();
            springs
        };
        parts.flat_map(of_body).collect()
    }

    /// The run's line in pictures of a palette.
    pub(crate) fn line(&self, palette: &Palette) -> LineStyle {
        palette.line(self.place, self.colour)
    }
}
