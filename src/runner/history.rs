//! The time series of a scene: its diagnostics from start to end, for charts, and the places of its bodies, for cameras
//! that follow them and for the drawn size of plates and walls. They depend on the scene only and not on the requested
//! frames.

use crate::look::{CameraBoxes, Hidden};
use crate::scene::{Reading, Run, Scene};
use crate::sim::geometry;
use crate::sim::{Diagnostics, Divergence, Moment, Reaction, Shape, World};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Least number of moments, if there are as many steps: the curve then looks smooth over the whole width of a picture.
const FEWEST_MOMENTS: u64 = 600;
/// The first of this many equal parts of the scene has as many moments again. Bodies are often dropped or thrown, and
/// charts show the early part on a scale of its own.
const EARLY: u64 = 16;
/// Greatest number of moments for any number of frames: charts have no higher resolution.
const MOST_MOMENTS: u64 = 2000;

/// The time series of runs of a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct History {
    /// Time of the scene's last frame (s).
    pub end: f64,
    /// The requested runs, in the requested order.
    pub series: Vec<TimeSeries>,
}

#[cfg(feature = "render")]
impl History {
    /// The place of the chosen azimuth among those of the camera. What diverges does not count.
    pub(crate) fn azimuth(&self) -> usize {
        let mut hidden = Hidden::default();
        let sound = self.series.iter().filter(|series| !series.diverges());
        sound.for_each(|series| hidden.merge(&series.hidden));
        hidden.choice()
    }
}

/// The time series of one run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TimeSeries {
    /// Index of the run in the scene.
    pub run: usize,
    /// The times of steps of this run (s), from the start to the scene's last frame; for a run that diverged, up to its
    /// last finite state.
    pub times: Vec<f64>,
    /// The diagnostics at each of these times. Diagnostics that were not requested are zero.
    pub diagnostics: Vec<Diagnostics>,
    /// The diagnostics of each body of the run, one series for each; empty for a run of one body, and if no diagnostics were
    /// requested.
    pub of_bodies: Vec<Vec<Diagnostics>>,
    /// What each chart that shows no diagnostic has, in the order of these charts, at each of these times.
    pub readings: Vec<Vec<Reading>>,
    /// The positions (m) of each point of the body that leaves a path ([`crate::look::View::paths`]), at each of these
    /// times.
    pub paths: Vec<Vec<DVec3>>,
    /// The boxes around the bodies at these times, if the scene's camera follows them.
    pub(crate) boxes: Vec<CameraBoxes>,
    /// What obstacles hide from a camera that turns.
    pub(crate) hidden: Hidden,
    /// The boxes around their nodes near plates and walls.
    pub(crate) reach: NearObstacles,
    /// The divergence of the run, if it diverged.
    pub divergence: Option<Divergence>,
}

impl TimeSeries {
    /// Whether it has the same run and the same quantities as an empty one.
    pub(crate) fn fits(&self, empty: &Self) -> bool {
        let moments = self.times.len();
        self.run == empty.run
            && self.diagnostics.len() == moments
            && self.of_bodies.len() == empty.of_bodies.len()
            && self.of_bodies.iter().all(|body| body.len() == moments)
            && self.readings.len() == empty.readings.len()
            && self.readings.iter().all(|of| of.len() == moments)
            && self.paths.len() == empty.paths.len()
            && self.paths.iter().all(|path| path.len() == moments)
    }

    /// Whether the run diverges. A recording that ends does not.
    #[cfg(feature = "render")]
    pub(crate) fn diverges(&self) -> bool {
        self.divergence.is_some_and(|divergence| !divergence.is_end)
    }

    /// Records the state at a time (s): diagnostics of all bodies together and of each, and nodes at positions (m).
    pub(crate) fn note(
        &mut self,
        scene: &Scene,
        time: f64,
        (all, of_bodies): (Diagnostics, Vec<Diagnostics>),
        position: &[DVec3],
    ) {
        let run = &scene.runs[self.run];
        self.times.push(time);
        self.diagnostics.push(all);
        self.of_bodies.iter_mut().zip(of_bodies).for_each(|(series, of_body)| series.push(of_body));
        let camera = &scene.view.camera;
        if camera.follow {
            self.boxes.extend(CameraBoxes::new(&scene.view, &run.bodies, position));
        }
        if camera.turns {
            // The start counts, too, in a scene of one moment.
            let lasting = self.times.iter().rev().nth(1).map_or(f64::MIN_POSITIVE, |before| time - before);
            self.hidden.add(camera, &scene.obstacles, [time, lasting], position);
        }
        self.reach.add(scene, run, time, position);
    }
}

/// A row of `diagnostics.csv` between frames: the diagnostics of all bodies of a run together, and of each if it has several.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct TableRow {
    /// The time of the step (s).
    pub(crate) time: f64,
    pub(crate) all: Diagnostics,
    pub(crate) of_bodies: Vec<Diagnostics>,
    /// The mean forces of contact, if they are kept and known.
    pub(crate) reactions: Vec<Reaction>,
    /// The displacements of probes, as [`Scene::all_displaced`] has them.
    pub(crate) displaced: Vec<[f64; 6]>,
}

/// For each obstacle of a scene the box around all nodes that have been near it (m), relative to the obstacle at the
/// start; `None` for all but plates and walls.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct NearObstacles(pub(crate) Vec<Option<[DVec3; 2]>>);

impl NearObstacles {
    /// Nodes are near a plate or a wall up to this distance (sizes of their body).
    const NEAR: f64 = 0.6;
    /// A body that has grown more than this many times is about to diverge, and does not count.
    const MOST_GROWTH: f64 = 10.0;

    /// Adds the nodes of a run at positions (m) at a time (s).
    pub(crate) fn add(&mut self, scene: &Scene, run: &Run, time: f64, position: &[DVec3]) {
        self.0.resize(scene.obstacles.len(), None);
        for (at, body) in run.bodies.bodies().iter().enumerate() {
            // Without positions there is nothing near.
            let nodes = position.get(run.bodies.nodes(at));
            nodes.into_iter().for_each(|nodes| self.add_body(scene, time, body.extent(), nodes));
        }
    }

    fn add_body(&mut self, scene: &Scene, time: f64, extent: f64, position: &[DVec3]) {
        let (low, high) = geometry::bounds(position);
        if (high - low).max_element() > Self::MOST_GROWTH * extent {
            return;
        }
        let near = Self::NEAR * extent;
        let ground = geometry::ground(&scene.obstacles, time);
        for (obstacle, reached) in scene.obstacles.iter().zip(&mut self.0) {
            let (normal, height) = match obstacle.shape {
                Shape::Plate { point, normal } => (normal, normal.dot(point)),
                Shape::Floor { normal, height } if obstacle.floor(time) != ground => (normal, height),
                _ => continue,
            };
            let pose = obstacle.pose(time);
            for at in position.iter().map(|&node| pose.undo(obstacle.pivot, node)) {
                if (normal.dot(at) - height).abs() < near {
                    let [low, high] = reached.unwrap_or([at; 2]);
                    *reached = Some([low.min(at), high.max(at)]);
                }
            }
        }
    }
}

/// The moments of the time series of a run, rising: all frames with moments between them, or evenly chosen frames. The
/// beginning of the scene and the interval `closer` (s) each have as many moments as the whole scene usually has; the steps
/// nearest to each of `shown` (s) are added.
pub(crate) fn moments(scene: &Scene, world: &World, closer: Option<[f64; 2]>, shown: &[f64]) -> Vec<Moment> {
    let last = scene.last_frame();
    let rate = scene.frames_per_second;
    let mut moments: Vec<Moment> = if last == 0 {
        vec![scene.moment(0)]
    } else if last > MOST_MOMENTS {
        let frame = |at: u64| (u128::from(at) * u128::from(last) / u128::from(MOST_MOMENTS)) as u64;
        (0..=MOST_MOMENTS).map(|at| scene.moment(frame(at))).collect()
    } else {
        let parts = FEWEST_MOMENTS.div_ceil(last);
        // At whole frames this is exactly the frame's own step.
        (0..=last * parts).map(|at| Moment { count: at as f64 / parts as f64, rate }).collect()
    };
    let end = world.steps_at(scene.moment(last));
    let early = [0.0, scene.frame_time(last) / EARLY as f64];
    let closely = std::iter::once(early).chain(closer).flat_map(|[start, end]| {
        (0..=FEWEST_MOMENTS).map(move |at| start + (end - start) * at as f64 / FEWEST_MOMENTS as f64)
    });
    let more = closely.chain(shown.iter().copied()).map(Moment::at);
    moments.extend(more.map(|moment| if world.steps_at(moment) > end { scene.moment(last) } else { moment }));
    moments.sort_by_key(|&moment| world.steps_at(moment));
    moments.dedup_by_key(|moment| world.steps_at(*moment));
    moments
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::look::Plot;
    use crate::runner::Runner;
    use crate::runner::tests::{read, scene};

    #[test]
    fn every_frame_is_in_it_with_moments_between_them() {
        let scene = scene("0.5", "60", "T/70");
        let history = History::new(&scene, &[0, 1]);
        let mut runner = Runner::new(&scene, &[0, 1]);
        for index in 0..=scene.last_frame() {
            for (run, series) in runner.frame(index).runs.iter().zip(&history.series) {
                let at = series.times.iter().position(|time| time.to_bits() == run.snapshot.time.to_bits());
                let at = at.unwrap_or_else(|| panic!("frame {index} is missing"));
                // NaN is not equal to itself, so texts are compared.
                assert_eq!(format!("{:?}", series.diagnostics[at]), format!("{:?}", run.snapshot.diagnostics));
            }
        }
        for series in &history.series {
            assert!(series.times.len() > 300 && series.times.len() <= 1201, "{}", series.times.len());
            assert!(series.times.windows(2).all(|two| two[0] < two[1]));
            assert_eq!(series.times.len(), series.diagnostics.len());
            let step = scene.runs[series.run].step;
            assert!(series.times.iter().all(|time| (time / step - (time / step).round()).abs() < 1e-9));
        }
        assert_eq!(history.end, 0.5);
    }

    #[test]
    fn however_it_is_cut_up_it_is_the_same() {
        let scene = scene("0.1", "20", "T/2");
        let end = scene.moment(scene.last_frame());
        let whole = format!("{:?}", History::new(&scene, &[0, 1]));
        for slice in [1, 3, 1000] {
            let mut runner = Runner::new(&scene, &[0, 1]).with_time_series(&Plot::diagnostics()[..]);
            while !runner.advance_towards(end, slice) {
                assert!(runner.steps() < runner.steps_at(end));
            }
            assert_eq!(runner.steps(), runner.steps_at(end));
            assert_eq!(format!("{:?}", runner.take_history()), whole);
        }
        assert_eq!(History::new(&scene, &[1]).series[0].run, 1);
    }

    #[test]
    fn rows_between_frames_change_no_picture() {
        let record = |rate: &str| {
            let scene = scene("0.1", rate, "T/70");
            let mut runner = Runner::new(&scene, &[0, 1]).with_time_series(&Plot::diagnostics()[..]).with_rows();
            runner.advance_towards(scene.moment(scene.last_frame()), u64::MAX);
            (format!("{:?}", runner.take_history()), runner.runs[0].rows.take().map(|rows| rows.len()))
        };
        let [(usual, none), (same, rows)] = ["20", "20, every = 1e-6"].map(record);
        assert_eq!(
            (none, rows),
            (None, Some(scene("0.1", "20", "T/70").frame_step(0, 2) as usize)),
            "each step has one"
        );
        assert_eq!(usual, same);
    }

    #[test]
    fn many_frames_are_sampled_and_few_moments_are_all_taken() {
        let long = scene("100", "600", "T/70");
        let steps = |scene: &Scene, run: usize| -> Vec<u64> {
            let world = scene.world(run);
            moments(scene, &world, None, &[]).into_iter().map(|moment| world.steps_at(moment)).collect()
        };
        let sampled = steps(&long, 0);
        assert!((MOST_MOMENTS..=MOST_MOMENTS + FEWEST_MOMENTS + 2).contains(&(sampled.len() as u64)));
        assert_eq!((sampled[0], sampled.last()), (0, Some(&long.frame_step(0, long.last_frame()))));
        // Fewer steps than moments: each step once.
        let short = scene("0.01", "100", "T/70");
        assert_eq!(steps(&short, 1), (0..=short.frame_step(1, 1)).collect::<Vec<_>>());
        // A scene of one frame.
        assert_eq!(steps(&scene("0.1", "1", "T/70"), 0), [0]);
    }

    #[test]
    fn what_is_looked_at_closely_has_more_moments() {
        let scene = scene("3", "60", "T/70");
        let usual = History::new(&scene, &[0, 1]);
        let mut runner = Runner::new(&scene, &[0, 1]).with_closer_time_series(
            &Plot::diagnostics(),
            Some([0.0, 0.1]),
            &[1.2345, 9.0],
        );
        runner.advance_towards(scene.moment(scene.last_frame()), u64::MAX);
        let closer = runner.take_history();
        for (usual, closer) in usual.series.iter().zip(&closer.series) {
            assert!(closer.times.windows(2).all(|two| two[0] < two[1]));
            let step = scene.runs[closer.run].step;
            let early = closer.times.iter().filter(|&&time| time < 0.1).count();
            assert!((early as f64 - 0.1 / step).abs() < 2.0, "every step of a few: {early}");
            assert!(closer.times.iter().any(|time| (time - 1.2345).abs() <= 0.5001 * step));
            // All other moments are there, with the same bits.
            for (at, time) in usual.times.iter().enumerate() {
                let same = closer.times.iter().position(|other| other == time).expect("kept");
                assert_eq!(format!("{:?}", usual.diagnostics[at]), format!("{:?}", closer.diagnostics[same]));
            }
            assert_eq!(closer.times.last(), usual.times.last());
        }
    }

    #[test]
    fn several_bodies_have_a_series_each() {
        let bodies =
            ["lattice = { cells = [2, 1, 1], side = 0.1 }", "lattice = { cells = [1, 1, 1], side = 0.2 }\nmass = 2"];
        let history = |bodies: &[&str]| {
            let body = |(at, body): (usize, &&str)| format!("[[body]]\nname = '{at}'\nvelocity = [0, -2, 0]\n{body}\n");
            let bodies: String = bodies.iter().enumerate().map(body).collect();
            let text = format!(
                "gravity = [0, -9.8, 0]
                contact = {{ rule = 'nodes' }}
                time = {{ duration = 0.1, step = 1e-3, frames_per_second = 20 }}
                {bodies}
                [[obstacle]]
                kind = 'floor'
                [[run]]
                name = 'shape'
                model = {{ kind = 'shape-based', stiffness = 1e4 }}"
            );
            History::new(&read(&text), &[0]).series.remove(0)
        };
        let all = history(&bodies);
        assert_eq!((all.of_bodies.len(), all.diagnostics.len()), (2, all.times.len()));
        for (of_body, body) in all.of_bodies.iter().zip(bodies) {
            let alone = history(&[body]);
            assert_eq!((&alone.times, alone.of_bodies.len()), (&all.times, 0));
            // NaN is not equal to itself, so texts are compared.
            assert_eq!(format!("{of_body:?}"), format!("{:?}", alone.diagnostics));
        }
    }

    #[test]
    fn a_run_that_blows_up_ends_there() {
        let scene = scene("2", "60", "T/2");
        let history = History::new(&scene, &[0, 1]);
        let [whole, short] = &history.series[..] else { panic!("two runs") };
        assert_eq!(whole.divergence, None);
        assert!((whole.times.last().unwrap() - 2.0).abs() < scene.runs[0].step);
        let divergence = short.divergence.expect("such long steps blow up");
        let last = (divergence.step - 1) as f64 * scene.runs[1].step;
        assert_eq!(short.times.last(), Some(&last));
        assert!(short.times.windows(2).all(|two| two[0] < two[1]), "the last state is noted once");
        assert!(last < divergence.time && divergence.time < 2.0);
        assert!(short.diagnostics.iter().all(|diagnostics| diagnostics.kinetic.is_finite()));
    }
}
