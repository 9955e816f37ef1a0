//! The course of a scene: what its diagnostics do from its start to its end, for those who show a moment among all
//! others. It comes from a simulation of its own, so that it depends on the scene alone and not on the frames asked for.

use crate::scene::Scene;
use crate::sim::snapshot::{Diagnostics, Divergence, Status};
use crate::sim::world::World;
use rayon::prelude::*;

/// So many moments at least, as long as there are so many steps: a curve as wide as a picture then has no corners.
const FEWEST_MOMENTS: u64 = 600;
/// And no more than this, however many frames there are: no curve shows more.
const MOST_MOMENTS: u64 = 2000;

/// The course of runs of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct History {
    /// Time of the scene's last frame (s).
    pub end: f64,
    /// The runs asked for, in that order.
    pub courses: Vec<Course>,
}

/// The course of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// Index of the run in the scene.
    pub run: usize,
    /// The times of steps of this run (s), rising from the start to the scene's last frame. Of a run that diverged, up
    /// to its last finite state.
    pub times: Vec<f64>,
    /// The state's numbers at each of these times.
    pub diagnostics: Vec<Diagnostics>,
    /// Where the run blew up, if it did.
    pub divergence: Option<Divergence>,
}

impl History {
    /// Simulates runs of a scene from start to end.
    ///
    /// It takes about as long as simulating for pictures does; [`Rehearsal`] does the same in slices. It works on the
    /// rayon pool it is called from; the result has the same bits for any number of threads.
    ///
    /// # Panics
    /// If the scene has no such run.
    pub fn new(scene: &Scene, runs: &[usize]) -> Self {
        let mut rehearsal = Rehearsal::new(scene, runs);
        while !rehearsal.advance(u64::MAX) {}
        rehearsal.finish()
    }
}

/// A scene on its way from start to end, without fields and with diagnostics only where they are noted down.
pub struct Rehearsal {
    end: f64,
    parts: Vec<Part>,
}

/// One run on its way.
struct Part {
    world: World,
    /// Time step (s).
    step: f64,
    /// The steps to note down, rising.
    moments: Vec<u64>,
    course: Course,
}

impl Rehearsal {
    /// The given runs of a scene at their start.
    ///
    /// # Panics
    /// If the scene has no such run.
    pub fn new(scene: &Scene, runs: &[usize]) -> Self {
        let part = |&run: &usize| {
            let mut world = scene.world(run);
            world.show(None);
            let course = Course { run, times: Vec::new(), diagnostics: Vec::new(), divergence: None };
            Part { world, step: scene.runs[run].step, moments: moments(scene, run), course }
        };
        Self { end: scene.frame_time(scene.last_frame()), parts: runs.iter().map(part).collect() }
    }

    /// The same with more moments noted down: as many as usually of the whole scene between two that are looked at
    /// `closer` (s), if there are any, and the steps nearest to each of `shown` (s).
    pub fn with(mut self, scene: &Scene, closer: Option<[f64; 2]>, shown: &[f64]) -> Self {
        for part in &mut self.parts {
            let last = part.last();
            let step = |time: f64| ((time / scene.runs[part.course.run].step).round() as u64).min(last);
            let closely = closer.into_iter().flat_map(|[start, end]| {
                (0..=FEWEST_MOMENTS).map(move |at| start + (end - start) * at as f64 / FEWEST_MOMENTS as f64)
            });
            part.moments.extend(closely.chain(shown.iter().copied()).map(step));
            part.moments.sort_unstable();
            part.moments.dedup();
        }
        self
    }

    /// Goes on, each run by `most_steps` at most, and returns whether all runs are at their end. However the way is
    /// cut up, the course has the same bits.
    pub fn advance(&mut self, most_steps: u64) -> bool {
        let arrived = self.parts.par_iter_mut().map(|part| part.advance(most_steps));
        arrived.reduce(|| true, |one, other| one && other)
    }

    /// Steps done with so far, of all runs together.
    pub fn steps(&self) -> u64 {
        self.parts.iter().fold(0, |sum, part| sum.saturating_add(part.steps()))
    }

    /// Steps that all runs together take to their end.
    pub fn steps_at_end(&self) -> u64 {
        self.parts.iter().fold(0, |sum, part| sum.saturating_add(part.last()))
    }

    /// What was noted down until now.
    pub fn finish(self) -> History {
        History { end: self.end, courses: self.parts.into_iter().map(|part| part.course).collect() }
    }
}

impl Part {
    /// Goes on by a number of steps at most and returns whether this is the end.
    fn advance(&mut self, most_steps: u64) -> bool {
        let mut left = most_steps;
        while let (Some(&moment), None) = (self.moments.get(self.course.times.len()), self.course.divergence) {
            let steps = moment - self.world.steps();
            self.world.advance(steps.min(left));
            if let Status::Diverged(divergence) = self.world.status() {
                // The last finite state is that before the step which was given up.
                let last = divergence.step - 1;
                if self.course.times.is_empty() || last > self.moments[self.course.times.len() - 1] {
                    self.note(last);
                }
                self.course.divergence = Some(divergence);
            } else if steps > left {
                return false;
            } else {
                left -= steps;
                self.note(moment);
            }
        }
        true
    }

    /// Notes down the present state as that after a step.
    fn note(&mut self, step: u64) {
        self.course.times.push(step as f64 * self.step);
        self.course.diagnostics.push(self.world.diagnostics());
    }

    /// The last step to note down.
    fn last(&self) -> u64 {
        self.moments.last().copied().unwrap_or(0)
    }

    /// Steps done with; what a run that blew up does not have to take is done with, too.
    fn steps(&self) -> u64 {
        if self.course.divergence.is_some() { self.last() } else { self.world.steps() }
    }
}

/// The steps of a run to note down: those of all frames with some between them, or of evenly chosen frames.
fn moments(scene: &Scene, run: usize) -> Vec<u64> {
    let last = scene.last_frame();
    let mut steps: Vec<u64> = if last == 0 {
        vec![0]
    } else if last > MOST_MOMENTS {
        let frame = |at: u64| (u128::from(at) * u128::from(last) / u128::from(MOST_MOMENTS)) as u64;
        (0..=MOST_MOMENTS).map(|at| scene.frame_step(run, frame(at))).collect()
    } else {
        let parts = FEWEST_MOMENTS.div_ceil(last);
        let pace = scene.frames_per_second * scene.runs[run].step;
        // At whole frames that is the frame's own step, to the bit.
        (0..=last * parts).map(|at| (at as f64 / parts as f64 / pace).round() as u64).collect()
    };
    steps.dedup();
    steps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Limits;
    use crate::sequence::Sequence;

    fn scene(duration: &str, rate: &str, step: &str) -> Scene {
        let text = format!(
            "gravity = [0, -9.8, 0]
            time = {{ duration = {duration}, frames_per_second = {rate} }}
            body.lattice = {{ cells = [2, 1, 1], side = 0.1 }}
            body.velocity = [0, -2, 0]
            obstacle = [{{ kind = 'floor', restitution = 0.5 }}]
            [[run]]
            name = 'shape'
            model = {{ kind = 'shape-based', stiffness = 1e4 }}
            [[run]]
            name = 'springs'
            model = {{ kind = 'mass-spring', stiffness = 1e4 }}
            step = '{step}'"
        );
        Scene::parse(&text, "small.toml", &Limits::default()).unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn every_frame_is_in_it_with_moments_between_them() {
        let scene = scene("0.5", "60", "T/70");
        let history = History::new(&scene, &[0, 1]);
        let mut sequence = Sequence::new(&scene, &[0, 1]);
        for index in 0..=scene.last_frame() {
            for (run, course) in sequence.frame(index).runs.iter().zip(&history.courses) {
                let at = course.times.iter().position(|time| time.to_bits() == run.snapshot.time.to_bits());
                let at = at.unwrap_or_else(|| panic!("frame {index} is missing"));
                // NaN equals nothing: compared as text.
                assert_eq!(format!("{:?}", course.diagnostics[at]), format!("{:?}", run.snapshot.diagnostics));
            }
        }
        for course in &history.courses {
            assert!(course.times.len() > 300 && course.times.len() <= 601, "{}", course.times.len());
            assert!(course.times.windows(2).all(|two| two[0] < two[1]));
            assert_eq!(course.times.len(), course.diagnostics.len());
            let step = scene.runs[course.run].step;
            assert!(course.times.iter().all(|time| (time / step - (time / step).round()).abs() < 1e-9));
        }
        assert_eq!(history.end, 0.5);
    }

    #[test]
    fn however_it_is_cut_up_it_is_the_same() {
        let scene = scene("0.1", "20", "T/2");
        let whole = format!("{:?}", History::new(&scene, &[0, 1]));
        for slice in [1, 3, 1000] {
            let mut rehearsal = Rehearsal::new(&scene, &[0, 1]);
            while !rehearsal.advance(slice) {
                assert!(rehearsal.steps() < rehearsal.steps_at_end());
            }
            assert_eq!(rehearsal.steps(), rehearsal.steps_at_end());
            assert_eq!(format!("{:?}", rehearsal.finish()), whole);
        }
        assert_eq!(History::new(&scene, &[1]).courses[0].run, 1);
    }

    #[test]
    fn many_frames_are_sampled_and_few_moments_are_all_taken() {
        let long = scene("100", "600", "T/70");
        let steps = moments(&long, 0);
        assert_eq!(steps.len() as u64, MOST_MOMENTS + 1);
        assert_eq!((steps[0], steps[2000]), (0, long.frame_step(0, long.last_frame())));
        // Fewer steps than moments: each of them once.
        let short = scene("0.01", "100", "T/70");
        let steps = moments(&short, 1);
        assert_eq!(steps, (0..=short.frame_step(1, 1)).collect::<Vec<_>>());
        // A scene of one frame.
        assert_eq!(moments(&scene("0.1", "1", "T/70"), 0), [0]);
    }

    #[test]
    fn what_is_looked_at_closely_has_more_moments() {
        let scene = scene("3", "60", "T/70");
        let usual = History::new(&scene, &[0, 1]);
        let mut rehearsal = Rehearsal::new(&scene, &[0, 1]).with(&scene, Some([0.0, 0.1]), &[1.2345, 9.0]);
        while !rehearsal.advance(u64::MAX) {}
        let closer = rehearsal.finish();
        for (usual, closer) in usual.courses.iter().zip(&closer.courses) {
            assert!(closer.times.windows(2).all(|two| two[0] < two[1]));
            let step = scene.runs[closer.run].step;
            let early = closer.times.iter().filter(|&&time| time < 0.1).count();
            assert!((early as f64 - 0.1 / step).abs() < 2.0, "every step of a few: {early}");
            assert!(closer.times.iter().any(|time| (time - 1.2345).abs() <= 0.5001 * step));
            // All else is there, with the same bits.
            for (at, time) in usual.times.iter().enumerate() {
                let same = closer.times.iter().position(|other| other == time).expect("kept");
                assert_eq!(format!("{:?}", usual.diagnostics[at]), format!("{:?}", closer.diagnostics[same]));
            }
            assert_eq!(closer.times.last(), usual.times.last());
        }
    }

    #[test]
    fn a_run_that_blows_up_ends_there() {
        let scene = scene("2", "60", "T/2");
        let history = History::new(&scene, &[0, 1]);
        let [whole, short] = &history.courses[..] else { panic!("two runs") };
        assert_eq!(whole.divergence, None);
        assert!((whole.times.last().unwrap() - 2.0).abs() < scene.runs[0].step);
        let divergence = short.divergence.expect("such long steps blow up");
        let last = (divergence.step - 1) as f64 * scene.runs[1].step;
        assert_eq!(short.times.last(), Some(&last));
        assert!(last < divergence.time && divergence.time < 2.0);
        assert!(short.diagnostics.iter().all(|diagnostics| diagnostics.kinetic.is_finite()));
    }
}
