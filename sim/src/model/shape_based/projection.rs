//! Eq. (4) as compliant constraints on positions, for [`xpbd`](crate::model::xpbd).

use super::{Elements, Fit, ShapeBased, Stretch, mean, moment_at_rest};
use crate::body::Body;
use crate::material::spread;
use crate::model::{Projected, Projection};
use glam::DVec3;
use std::sync::Arc;

impl ShapeBased {
    /// The constraints of a body. Its damping takes no part in them.
    pub(in crate::model) fn constraints(&self, body: &Arc<Body>) -> Box<dyn Projection> {
        Box::new(Elements::new(self.clone(), body))
    }
}

impl Projection for Elements {
    fn project(&self, mut all: Projected<'_>, step: f64, memory: &[f64], next: &mut [f64]) {
        let (width, mut slopes, mut globals) = (self.solver.width(), Vec::new(), 0.0);
        for element in 0..self.body.elements.len() {
            let ([k, _], (nodes, rest)) = (self.constants(element), self.element(element));
            let own = Moved { nodes, compliance: 1.0 / (k * step * step), step };
            let next = &mut next[element * width..][..width];
            let Fit { centre, at_rest, rotation, is_global } =
                self.fit(element, all.position, self.of(element, memory), next);
            globals += f64::from(u8::from(is_global));
            let stretch = self.stretch(element, at_rest);
            slopes.clear();
            let mut squares = 0.0;
            for (&node, &rest) in nodes.iter().zip(rest) {
                let (r, turned) = (all.position[node as usize] - centre, rotation * rest);
                let affine = stretch.map_or(r, |Stretch { map, .. }| map * rest);
                let (bent, off) = (r - affine, affine - turned);
                slopes.push(bent * self.model.bending + off);
                squares += self.model.bending * bent.length_squared() + off.length_squared();
            }
            own.project(squares, &slopes, &mut all);
            if self.model.volume(self.body.dimension) > 0.0 {
                let at_rest = moment_at_rest(rest, nodes, mean(nodes, all.position), all.position);
                let Some(Stretch { pressure, volume, .. }) = self.stretch(element, at_rest) else { continue };
                slopes.clear();
                slopes.extend(rest.iter().map(|&rest| pressure * rest));
                own.project(volume, &slopes, &mut all);
            }
        }
        if self.solver.counts()
            && let (Some(before), Some(after)) = (memory.last(), next.last_mut())
        {
            *after = before + globals;
        }
    }

    /// One iteration resolves the constraint of an element, with the pull `p = w |∇C| λ` on a node. In balance its neighbours pull by `−p`
    /// together. Half of them come later in the step, so that the element ends it wider by `p/2` than the `α̃ λ` of its stiffness: by the
    /// factor `1 + w/2α̃`, with the mean `w` of its nodes. Elements count by their energies in the same strain.
    fn softening(&self, step: f64) -> f64 {
        let mut sums = [0.0; 2];
        for (element, nodes) in self.body.elements.iter().enumerate() {
            let [stiffness, _] = self.constants(element);
            let (energy, count) = (stiffness * spread(&self.body, nodes).0, nodes.len() as f64);
            let light = nodes.iter().map(|&node| 1.0 / self.body.mass[node as usize]).sum::<f64>() / count;
            sums = [sums[0] + energy, sums[1] + energy * (0.5 * light * stiffness * step * step)];
        }
        1.0 + sums[1] / sums[0]
    }
}

/// The nodes of an element that a constraint moves.
struct Moved<'a> {
    nodes: &'a [u32],
    /// `α̃ = 1/(k ΔT²)` (1/kg).
    compliance: f64,
    /// ΔT (s).
    step: f64,
}

impl Moved<'_> {
    /// Projects the constraint `C` with the energy `k/2 C²`, given `C²` (m²) and `C ∇C` (m) of each node. With a multiplier that begins
    /// at 0, `λ = −C / (Σ w |∇C|² + α̃)` and `Δx = w ∇C λ`. The impulse on a node is `∇C λ/ΔT`.
    fn project(&self, squared: f64, slopes: &[DVec3], all: &mut Projected<'_>) {
        let Projected { position, inverse_mass, impulse } = all;
        let of_nodes = || self.nodes.iter().map(|&node| node as usize).zip(slopes);
        let sum: f64 = of_nodes().map(|(node, slope)| inverse_mass[node] * slope.length_squared()).sum();
        let below = sum + self.compliance * squared;
        // Where the constraint is met it has no direction, and where all nodes are held and it is rigid, nothing moves.
        if below > 0.0 {
            let share = squared / below;
            for (node, &slope) in of_nodes() {
                position[node] -= slope * (inverse_mass[node] * share);
                if inverse_mass[node] == 0.0 {
                    impulse[node] -= slope * (share / self.step);
                }
            }
        }
    }
}
