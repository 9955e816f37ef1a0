//! Paths of bodies up to the present moment.

use super::Composer;
use super::draft::Draft;
use crate::look::Traced;
use crate::picture::Item;
use crate::picture::chart::simplified;
use crate::picture::layout::Rectangle;
use crate::picture::layout::steps::{STRONG, THIN};
use crate::picture::plane::pieces;
use crate::runner::history::TimeSeries;
use glam::DVec2;

/// The opacity of the halo of a path.
const HALO_ALPHA: f64 = 0.6;
/// Radius of the dot at the end of a path, in widths.
const DOT: f64 = 1.7;

impl Composer<'_> {
    /// The names of the paths in the key, from the longest wording to the shortest; none if there are no paths. The
    /// path of the centre is thicker.
    pub(super) fn path_names(&self) -> Vec<String> {
        let paths = &self.scene.view.paths;
        let nodes: Vec<_> = paths
            .iter()
            .filter_map(|traced| if let Traced::Node(node) = traced { Some(node.to_string()) } else { None })
            .collect();
        let all = nodes.join(", ");
        match (nodes.len() < paths.len(), nodes.len()) {
            (false, 0) => Vec::new(),
            (true, 0) => vec!["path of the centre".to_owned()],
            (false, 1) => vec![format!("path of node {all}")],
            (false, count) => vec![format!("paths of nodes {all}"), format!("paths of {count} nodes")],
            (true, count) => {
                let plural = if count == 1 { "" } else { "s" };
                let wordings = [format!("node{plural} {all}"), format!("{count} node{plural}")];
                let [named, counted] = wordings.map(|nodes| format!("paths: centre (thick), {nodes}"));
                vec![named, counted.clone(), counted.replace(" (thick)", "")]
            }
        }
    }
}

impl Draft<'_> {
    /// The paths up to the present moment inside a part of the picture, for the known part of the run's time series.
    pub(super) fn paths(&self, series: &[TimeSeries], room: Rectangle, curves: &mut Vec<Item>) {
        let snapshot = &self.run.snapshot;
        let own = series.iter().find(|series| series.run == self.run.run);
        let Some(own) = own.filter(|_| snapshot.position.len() == self.body.len()) else { return };
        let (colour, halo) =
            (self.scene.runs[self.run.run].line(&self.composer.palette).colour, self.composer.palette.background);
        let mut items = Vec::new();
        for (traced, path) in self.scene.view.paths.iter().zip(&own.paths) {
            let width = if *traced == Traced::Centre { STRONG } else { THIN };
            let past = own.times.iter().take_while(|&&time| time < snapshot.time).count();
            let now = traced.of(self.body, &snapshot.position);
            let way = path.iter().take(past).copied().chain([now]);
            let seen: Vec<_> = way.map(|at| self.pixel(at).map(|pixel| pixel.to_array())).collect();
            // Points behind the camera divide the line.
            let parts = seen.split(Option::is_none).map(|part| part.iter().flatten().copied().collect::<Vec<_>>());
            let parts = parts.filter(|part| part.len() > 1);
            let lines: Vec<_> = parts.flat_map(|part| pieces(&part, self.around(room))).collect();
            for (more, paint) in [(STRONG, (halo, HALO_ALPHA)), (0.0, (colour, 1.0))] {
                let line = self.scale.line();
                items.extend(lines.iter().map(|way| Item::curve(&simplified(way), (width + more) * line, &[], paint)));
                let dot = |pixel: DVec2| Item::disc(pixel.to_array(), (DOT * width + 0.75 * more) * line, paint.0);
                items.extend(self.pixel(now).map(dot));
            }
        }
        curves.push(Item::inside(room, items));
    }
}
