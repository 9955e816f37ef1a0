//! The cause of a divergence, found by simulating the steps before it again, also with smaller steps.

use super::last_fit::fits;
use crate::reading::captions::quantity;
use crate::scene::{Run, Scene};
use crate::sim::geometry::bounds;
use crate::sim::stability::Stability;
use crate::sim::{Crew, Divergence, Grip, Integrator, Pose, State, Status};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The place and the cause of a divergence.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Cause {
    /// The first node of its body whose speed became too large or not a number.
    pub(crate) node: usize,
    /// The cause and the remedy, as sentences in one line.
    #[serde(rename = "cause")]
    pub(crate) words: String,
}

/// The number of steps between tests of a state.
const STRIDE: u64 = 64;
/// The number of times that steps are halved.
const HALVINGS: u32 = 5;
/// The most steps of an element that each part of the search simulates: about a second.
const MOST_ELEMENT_STEPS: u64 = 10_000_000;

impl Cause {
    /// Explains the divergence of a run after a sound state, with some threads. `None` if too many steps lie between.
    pub(crate) fn find(
        scene: &Scene,
        run: usize,
        sound: &State,
        divergence: Divergence,
        threads: usize,
    ) -> Option<Self> {
        let is_recorded = scene.runs[run].recording.is_some();
        if is_recorded || divergence.is_end || divergence.step - sound.steps > most_steps(&scene.runs[run]) {
            return None;
        }
        let mut world = scene.world(run);
        world.set_crew(Crew::new(threads));
        world.set_state(sound.clone());
        // The search begins at least a stride before the last state that fits.
        let (mut begin, mut fitting) = (sound.clone(), sound.clone());
        while world.status() == Status::Ok && world.steps() < divergence.step {
            world.advance(STRIDE.min(divergence.step - world.steps()));
            if world.status() == Status::Ok && fits(&scene.runs[run], &world.state().position) {
                begin = std::mem::replace(&mut fitting, world.state().clone());
            }
        }
        let (node, fastest) = world.runaway()?;
        let speed = quantity(fastest, "m/s");
        let why = Self::too_fast(scene, run, world.state().position[node], divergence);
        let why = why.unwrap_or_else(|| Self::by_steps(scene, run, &begin, divergence, threads));
        let (run, part) = (&scene.runs[run], divergence.part);
        let node = node - run.bodies.nodes(part).start;
        let element = divergence.element.map_or(String::new(), |element| format!(" of element {element}"));
        let body = run.body_names(scene).nth(part).map_or(String::new(), |name| format!(" of “{name}”"));
        Some(Self { node, words: format!("node {node}{element}{body} would move faster than {speed}: {why}") })
    }

    /// The cause of a divergence at a point (m) by something that moves too far in one step, if there is one.
    fn too_fast(scene: &Scene, run: usize, at: DVec3, divergence: Divergence) -> Option<String> {
        /// The distance of a step in sizes of an element.
        const FAR: f64 = 0.5;
        let (run, end) = (&scene.runs[run], divergence.time);
        let begin = end - run.step;
        let body = &run.bodies.bodies()[divergence.part];
        let size = |element: usize| {
            let nodes: Vec<_> = body
                .elements()
                .iter()
                .nth(element)
                .into_iter()
                .flatten()
                .map(|&node| body.rest()[node as usize])
                .collect();
            let (low, high) = bounds(&nodes);
            (high - low).max_element()
        };
        let size = divergence.element.map_or(body.extent(), size);
        let way = |from: Pose, to: Pose, pivot: DVec3| to.apply(pivot, from.undo(pivot, at)).distance(at);
        let obstacles = scene.obstacles.iter().enumerate().map(|(number, obstacle)| {
            (format!("obstacle[{number}]"), way(obstacle.pose(begin), obstacle.pose(end), obstacle.pivot))
        });
        let nodes = run.bodies.nodes(divergence.part);
        let is_near = |grip: &&Grip| grip.nodes.iter().any(|&node| nodes.contains(&(node as usize)));
        let grips = run.grips.iter().filter(|grip| grip.holds(begin) && grip.holds(end)).filter(is_near);
        let grips = grips.map(|grip| ("the grabbed part".to_owned(), way(grip.pose(begin), grip.pose(end), at)));
        let (name, way) = obstacles.chain(grips).max_by(|one, other| one.1.total_cmp(&other.1))?;
        (way > FAR * size).then(|| {
            let [way, size] = [way, size].map(|length| quantity(length, "m"));
            format!("{name} moves {way} in a step, and an element is {size} wide; move it more slowly, or take smaller steps")
        })
    }

    /// Whether smaller steps from the start of the search get past the divergence.
    fn by_steps(scene: &Scene, run: usize, begin: &State, divergence: Divergence, threads: usize) -> String {
        let Run { step, integrator, .. } = scene.runs[run];
        let hint = match integrator {
            Integrator::ExplicitEuler => ", but `explicit-euler` adds energy in each step",
            _ => "",
        };
        let mut finer = scene.clone();
        let mut left = most_steps(&scene.runs[run]);
        let mut tried = None;
        for halving in (1..=HALVINGS).filter(|_| !integrator.is_adaptive()) {
            let parts = 1_u64 << halving;
            // The search simulates twice as far.
            let steps = (divergence.step - begin.steps).saturating_mul(2 * parts);
            if steps > left {
                break;
            }
            left -= steps;
            finer.runs[run].step = step / parts as f64;
            let mut world = finer.world(run);
            world.set_crew(Crew::new(threads));
            let mut state = State { steps: begin.steps.saturating_mul(parts), ..begin.clone() };
            // The integrator starts anew with other steps.
            state.memory.integrator.clear();
            world.set_state(state);
            world.advance(steps);
            if world.status() == Status::Ok && fits(&scene.runs[run], &world.state().position) {
                let [long, short] = [step, step / parts as f64].map(|step| quantity(step, "s"));
                let stiffer = Self::stiffer(scene, run, divergence.part);
                let stiffer = stiffer.map_or(String::new(), |words| format!("; {words}, so give a shorter `step`"));
                return format!(
                    "steps of {long} are too long; with steps of {short} it does not diverge there{hint}{stiffer}"
                );
            }
            tried = Some(parts);
        }
        let tried = tried.map_or(String::new(), |parts| format!("steps of 1/{parts} do not help{hint}; "));
        let stiffer = Self::stiffer(scene, run, divergence.part);
        let stiffer = stiffer.map_or(String::new(), |words| format!(", or take shorter steps: {words}"));
        format!("{tried}look at the motion before it{stiffer}")
    }

    /// Why steps that are stable for a body at rest may be too long, if they are stable there and not for certain in any state.
    fn stiffer(scene: &Scene, run: usize, part: usize) -> Option<String> {
        let Run { step, integrator, models, bodies, .. } = &scene.runs[run];
        let certain = Stability::certain(&bodies.bodies()[part], &*models[part], *integrator, scene.mass_damping);
        if certain.is_some_and(|certain| *step <= certain) {
            return None;
        }
        let limit = Stability::of_each(bodies, models, *integrator, scene.restraint(run))[part].largest;
        let words = || {
            format!(
                "up to {} they are stable at rest, but this model can stiffen when it is stretched",
                quantity(limit, "s")
            )
        };
        (*step <= limit && limit.is_finite()).then(words)
    }
}

/// The most steps of a run that each part of the search simulates.
fn most_steps(run: &Run) -> u64 {
    MOST_ELEMENT_STEPS / (run.body().elements().len() as u64).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runner::tests::read;

    fn cause(more: &str, run: &str) -> (Cause, Divergence) {
        let text = format!(
            "gravity = [0, -9.8, 0]
            time = {{ duration = 1, frames_per_second = 20 }}
            body.lattice = {{ cells = [2, 1, 1], side = 0.1 }}
            {more}
            [[run]]
            name = 'run'
            {run}"
        );
        let scene = read(&text);
        let mut world = scene.world(0);
        let mut sound = world.state().clone();
        while world.status() == Status::Ok {
            sound.clone_from(world.state());
            world.advance(100);
            assert!(world.steps() < 1_000_000, "it diverges");
        }
        let Status::Diverged(divergence) = world.status() else { panic!("it diverges") };
        (Cause::find(&scene, 0, &sound, divergence, 1).expect("it diverges again"), divergence)
    }

    #[test]
    fn a_step_that_is_too_long_is_named_with_one_that_is_not() {
        let (Cause { node, words }, divergence) = cause(
            "body.velocity = [0, -2, 0]\nobstacle = [{ kind = 'floor', restitution = 0.5 }]",
            "model = { kind = 'mass-spring', stiffness = 1e4, springs = 'edges' }\nstep = 'T/2'",
        );
        let element = divergence.element.expect("all nodes are in elements");
        assert!(words.starts_with(&format!("node {node} of element {element} would move faster than ")), "{words}");
        // T is 62.8 ms.
        assert!(
            words.contains("m/s: steps of 31.4 ms are too long; with steps of 7.85 ms it does not diverge"),
            "{words}"
        );
    }

    #[test]
    fn a_model_that_stiffens_is_named_where_its_step_would_be_stable_at_rest() {
        let (Cause { words, .. }, _) = cause(
            "hold = [{ nodes = 'left' }]
            grab = [{ nodes = 'right', path.keys = [{ time = 0 }, { time = 1, shift = [0.8, 0, 0] }] }]",
            "model = { kind = 'limited-springs', stiffness = 1e4, limit = 0.3 }\nstep = 'auto'",
        );
        assert!(words.contains(" they are stable at rest, but this model can stiffen when it is stretched"), "{words}");
        // With the shape model no state of the body is stiffer than its bound.
        let (Cause { words, .. }, _) = cause("", "model = { kind = 'shape-based', stiffness = 1e4 }\nstep = 'T/2'");
        assert!(!words.contains("stiffen"), "{words}");
    }

    #[test]
    fn explicit_euler_is_told_that_it_adds_energy() {
        let (Cause { words, .. }, _) = cause(
            "body.spin = { axis = [0, 0, 1], rate = 3 }",
            "model = { kind = 'shape-based', stiffness = 1e4 }\nintegrator = 'explicit-euler'\nstep = 'T/10'",
        );
        assert!(words.contains("`explicit-euler` adds energy in each step"), "{words}");
    }
}
