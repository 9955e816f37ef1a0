//! States that moved, coloured by how far.

use super::record::Record;
use crate::gpu::Gpu;
use crate::look::{ColourMap, ColourScale};
use crate::picture::Composer;
use crate::render::{RenderError, Renderer};
use crate::runner::history::History;
use crate::scene::Scene;
use crate::sim::apart::distances;
use crate::sim::field::Field;
use crate::sim::snapshot::{Frame, RunFrame};

/// How far each node of the runs of a frame is from where a record has it (m), empty for runs whose nodes it does not have; `None`
/// if none has moved.
pub(super) fn distances_of(scene: &Scene, frame: &Frame, old: &Record) -> Option<Vec<Vec<f64>>> {
    let of_run = |run: &RunFrame| {
        let old = old.states.run(&scene.runs[run.run].name).and_then(|old| old.states.get(&frame.index));
        let known = old.and_then(|old| old.positions.as_ref()).filter(|known| known.at.len() == scene.body.len());
        let Some(known) = known else { return Vec::new() };
        let moved = distances(&run.snapshot.position, &known.at);
        moved.map(|distance| if distance > known.quantum { distance } else { 0.0 }).collect()
    };
    let all: Vec<Vec<_>> = frame.runs.iter().map(of_run).collect();
    all.iter().flatten().any(|&distance| distance > 0.0).then_some(all)
}

/// Draws a frame in a size (px) whose bodies are coloured by a distance of each node (m), with the time series of its scene if that
/// needs them. Bodies without distances keep their colour.
pub(super) fn draw_distances(
    gpu: &Gpu,
    scene: &Scene,
    size: [u32; 2],
    frame: &Frame,
    distances: &[Vec<f64>],
    history: Option<&History>,
) -> Result<Vec<u8>, RenderError> {
    let (mut scene, mut frame) = (scene.clone(), frame.clone());
    let view = &mut scene.view;
    let range = [0.0, distances.iter().flatten().copied().fold(0.0, f64::max)];
    view.colour = Some(ColourScale { field: Field::Displacement, range, map: ColourMap::default() });
    (view.size, view.labels.legend, view.ghost) = (size, true, None);
    for (run, distances) in frame.runs.iter_mut().zip(distances) {
        run.snapshot.field.clone_from(distances);
    }
    let mut composer = Composer::new(&scene).naming_field("distance", "from the expected place");
    history.into_iter().for_each(|history| composer.set_history(history));
    Ok(Renderer::new(gpu, size)?.draw(&composer.compose(&frame))?.into_raw())
}
