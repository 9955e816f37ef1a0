//! Sizes and stiffnesses of a scene that are hardly meant.

use super::mesh::longest;
use super::{Run, Scene, SceneBody};
use crate::reading::captions::{quantity, rounded};
use crate::reading::words::{list, quoted, short};
use crate::sim::geometry::node_volumes;
use crate::sim::model::ElasticModel;
use crate::sim::{Body, Dimension, State};
use glam::DVec3;
use std::sync::Arc;

/// Longer bodies are rarely meant to be that long (m).
pub(super) const LONG: f64 = 50.0;

/// A body that hardly carries its own weight.
struct Soft<'a> {
    run: usize,
    body: &'a SceneBody,
    model: &'a dyn ElasticModel,
    /// Its height (m) and its modulus (Pa; N/m in the plane).
    height: f64,
    young: f64,
    /// `ρ g h / E`: the strain of its lowest layer, twice the mean one.
    strain: f64,
}

impl Scene {
    /// The message and remedy for a run whose recording is of another size than the bodies that other runs simulate or, without these,
    /// than its own at rest, or is very long.
    pub(super) fn misfits(&self, number: usize) -> Option<[String; 2]> {
        /// The least ratio. Units of length differ by 100 or 1000.
        const FAR: f64 = 100.0;
        let of_rest = |run: &Run| run.bodies.bodies().iter().map(|body| longest(body.rest())).fold(0.0, f64::max);
        let simulated = self.runs.iter().filter(|run| run.recording.is_none()).map(of_rest).fold(0.0, f64::max);
        let run = self.runs.get(number).filter(|run| run.recording.is_some())?;
        let of_body = |body| longest(&run.initial.position[run.bodies.nodes(body)]);
        let recorded = (0..run.of.len()).map(of_body).fold(0.0, f64::max);
        let (expected, whose) =
            if simulated > 0.0 { (simulated, "the simulated bodies") } else { (of_rest(run), "its body at rest") };
        let (name, ratio) = (quoted(&run.name), recorded / expected);
        if recorded > 0.0 && expected > 0.0 && !(1.0 / FAR..FAR).contains(&ratio) {
            let [times, recorded, expected] = [rounded(ratio, 2), recorded, expected].map(short);
            let message = format!(
                "the recording of {name} is {times} times as long as {whose}: {recorded} m beside {expected} m"
            );
            let scale = short(libm::exp10(-libm::round(libm::log10(ratio))));
            let help = format!("lengths are in metres: write scale = {scale} in this run if its unit is another one");
            return Some([message, help]);
        }
        // This program writes metres, and its time step.
        let is_own = run.recording.as_ref().is_some_and(|recording| recording.step.is_some());
        (simulated == 0.0 && recorded >= LONG && !is_own).then(|| {
            let message = format!("the recording of {name} is {} m long, as no `scale` is given", short(recorded));
            let help = "write scale = 0.001 in this run if its unit is the millimetre, scale = 1 if it is the metre";
            [message, help.to_owned()]
        })
    }

    /// The message for the bodies that their own weight flattens or draws out, the remedy for the softest one, and its run.
    pub(super) fn too_soft(&self) -> Option<(usize, [String; 2])> {
        /// The mean strain from which on a body is told of. Linear theory then compresses its lowest layer by two thirds: of
        /// the shape that was meant nothing is left.
        const FLAT: f64 = 1.0 / 3.0;
        /// The mean strain of the remedy.
        const FIRM: f64 = 0.1;
        let is_carried = |run: &Run| !self.obstacles.is_empty() || !run.grips.is_empty();
        if self.gravity == DVec3::ZERO || !self.runs.iter().any(is_carried) {
            return None;
        }
        let volumes: Vec<f64> = self.bodies.iter().map(|body| node_volumes(&body.body).iter().sum()).collect();
        let parts = self.runs.iter().enumerate().flat_map(|(number, run)| {
            let parts = run.parts(self).enumerate().zip(run.of.iter().map(|&body| volumes[body]));
            parts.filter_map(move |((place, part), volume)| self.soft(number, place, part, volume))
        });
        let found: Vec<_> = parts.filter(|soft| soft.strain / 2.0 > FLAT).collect();
        let Soft { run, body, model, height, young, strain } =
            found.iter().max_by(|one, other| one.strain.total_cmp(&other.strain))?;
        let mut names: Vec<_> = found.iter().map(|soft| &self.runs[soft.run].name).collect();
        names.dedup();
        let unit = if body.body.dimension() == Dimension::Plane { "N/m" } else { "Pa" };
        let of = if body.name.is_empty() { "the body".to_owned() } else { quoted(&body.name) };
        let message = format!(
            "{of} is too soft to carry its own weight in {}: ρ g h / E = {}, with a height h of {} m and E = {}",
            list(&names, "and", quoted),
            rounded(*strain, 2),
            short(*height),
            quantity(*young, unit)
        );
        let times = strain / 2.0 / FIRM;
        let properties = model.properties(&body.body);
        let firm = match properties.given_material() {
            Some(typed) => format!("young = {:e}", rounded(times * typed.young, 2)),
            None => format!("stiffness = {:e}", rounded(times * properties.stiffness, 2)),
        };
        Some((*run, [message, format!("with {firm} the weight changes its height by a tenth")]))
    }

    /// How soft a body with a volume (m³; m² in the plane) at a place of a run is; `None` without one, or if it may fall for ever.
    fn soft<'a>(
        &'a self,
        number: usize,
        place: usize,
        (model, body): (&'a dyn ElasticModel, &'a SceneBody),
        volume: f64,
    ) -> Option<Soft<'a>> {
        let (run, up) = (&self.runs[number], -self.gravity.normalize_or_zero());
        let nodes = run.bodies.nodes(place);
        let is_gripped = run.grips.iter().any(|grip| grip.nodes.iter().any(|node| nodes.contains(&(*node as usize))));
        if volume <= 0.0 || self.obstacles.is_empty() && !is_gripped {
            return None;
        }
        let heights = run.initial.position[nodes].iter().map(|at| at.dot(up));
        let (low, high) =
            heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (at.min(low), at.max(high)));
        let (height, density) = (high - low, body.body.mass().iter().sum::<f64>() / volume);
        let young = modulus(model, &body.body, up, volume)?;
        let strain = density * self.gravity.length() * height / young;
        Some(Soft { run: number, body, model, height, young, strain })
    }
}

/// Young's modulus of a model on a body with a volume: of its material, or else from its energy when the body is compressed a
/// little along a direction.
fn modulus(model: &dyn ElasticModel, body: &Arc<Body>, along: DVec3, volume: f64) -> Option<f64> {
    const STRAIN: f64 = 1e-3;
    if let Some(material) = model.material(body) {
        return Some(material.young);
    }
    let squeezed = body.rest().iter().map(|&at| at - along * (STRAIN * along.dot(at))).collect();
    let (forces, memory) = (model.prepare(body), model.start(body, body.rest()));
    let report = forces.report(State::at_rest(squeezed).nodes(), &memory, &mut |_, _, _| ());
    report.energy.map(|energy| 2.0 * energy / (STRAIN * STRAIN * volume)).filter(|&young| young > 0.0)
}
