//! Paths of bodies up to the present moment.

use super::KeyPlace;
use crate::look::{Traced, View};
use crate::picture::Item;
use crate::picture::chart::simplified;
use crate::picture::compose::Composer;
use crate::picture::compose::draft::Draft;
use crate::picture::layout::steps::{STRONG, THIN};
use crate::picture::legend::{Sample, SampleKind};
use crate::picture::plane::pieces;
use crate::runner::history::TimeSeries;
use glam::DVec2;

/// The opacity of the halo of a path.
const HALO_ALPHA: f64 = 0.6;
/// Radius of the dot at the end of a path, in widths.
const DOT: f64 = 1.7;

/// A line with a part for each run.
pub(super) fn samples(composer: &Composer<'_>, _: &KeyPlace) -> Vec<Sample> {
    let colour = |series: &TimeSeries| composer.scene.runs[series.run].line(&composer.palette).colour;
    let kind = SampleKind::Path(composer.traced.iter().map(colour).collect());
    vec![Sample { names: names(&composer.scene.view), kind }]
}

/// Paths of the centre and of nodes up to the present moment, for the known part of the run's time series.
pub(super) fn draw(draft: &Draft<'_>, curves: &mut Vec<Item>) {
    let snapshot = draft.snapshot;
    let own = draft.composer.traced.iter().find(|series| series.run == draft.run);
    let Some(own) = own.filter(|_| snapshot.position.len() == draft.body.len()) else { return };
    let (colour, halo) =
        (draft.scene.runs[draft.run].line(&draft.composer.palette).colour, draft.composer.palette.background);
    let mut items = Vec::new();
    for (traced, path) in draft.scene.view.paths.iter().zip(&own.paths) {
        let width = if *traced == Traced::Centre { STRONG } else { THIN };
        let past = own.times.iter().take_while(|&&time| time < snapshot.time).count();
        let now = traced.of(draft.body, &snapshot.position);
        let way = path.iter().take(past).copied().chain([now]);
        let seen: Vec<_> = way.map(|at| draft.pixel(at).map(|pixel| pixel.to_array())).collect();
        // Points behind the camera divide the line.
        let parts = seen.split(Option::is_none).map(|part| part.iter().flatten().copied().collect::<Vec<_>>());
        let parts = parts.filter(|part| part.len() > 1);
        let lines: Vec<_> = parts.flat_map(|part| pieces(&part, draft.around(draft.room))).collect();
        for (more, paint) in [(STRONG, (halo, HALO_ALPHA)), (0.0, (colour, 1.0))] {
            let line = draft.scale.line();
            items.extend(lines.iter().map(|way| Item::curve(&simplified(way), (width + more) * line, &[], paint)));
            let dot = |pixel: DVec2| Item::disc(pixel.to_array(), (DOT * width + 0.75 * more) * line, paint.0);
            items.extend(draft.pixel(now).map(dot));
        }
    }
    curves.push(Item::inside(draft.room, items));
}

/// The names of a view's paths in the key, from the longest wording to the shortest. The path of the centre is thicker.
fn names(view: &View) -> Vec<String> {
    let paths = &view.paths;
    let nodes: Vec<_> = paths
        .iter()
        .filter_map(|traced| if let Traced::Node(node) = traced { Some(node.to_string()) } else { None })
        .collect();
    let all = nodes.join(", ");
    match (nodes.len() < paths.len(), nodes.len()) {
        (_, 0) => vec!["path of the centre".to_owned()],
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
