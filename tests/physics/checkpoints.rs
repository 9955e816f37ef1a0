//! A simulation that another process continues, from any point, has the bits of an uninterrupted one.

use localshape::look::Plot;
use localshape::runner::growing::Growing;
use localshape::runner::history::History;
use localshape::runner::{Frames, Next, Progress, Runner};
use localshape::scene::{Limits, Scene};

/// Runs with different steps, with a path and forces that act for a while. The third run diverges.
const SCENE: &str = "
    gravity = [0, -9.8, 0]
    time = { duration = 0.3, frames_per_second = 20 }
    body.lattice = { cells = [2, 1, 1], side = 0.1 }
    body.velocity = [0, -2, 0]
    obstacle = [{ kind = 'floor', restitution = 0.5 }]
    grab = [{ nodes = [0], path = { keys = [{ time = 0.02 }, { time = 0.2, shift = [0, 0.2, 0] }] } }]
    view = { charts = ['energy'], paths = ['centre'] }
    [[run]]
    name = 'shape'
    model = { kind = 'shape-based', stiffness = 1e4 }
    step = 'T/70'
    [[run]]
    name = 'springs'
    model = { kind = 'mass-spring', stiffness = 1e4 }
    step = 'T/70'
    integrator = 'runge-kutta'
    [[run]]
    name = 'wild'
    model = { kind = 'mass-spring', stiffness = 1e4, springs = 'edges' }
    step = 'T/2'
";

/// The results of frames: their texts, the time series, and the drawn state of the run that diverges.
#[derive(Default, PartialEq)]
struct Taken {
    frames: Vec<String>,
    history: Option<String>,
}

fn frames<'a>(scene: &'a Scene, numbers: &[u64], waiting: Option<Growing>) -> Frames<'a> {
    let runner = Runner::new(scene, &[0, 1, 2]).with_time_series(&Plot::diagnostics()[..]);
    Frames::new(runner, numbers, waiting)
}

/// Takes all remaining results, or those of a number of calls.
fn take(frames: &mut Frames<'_>, slice: u64, calls: usize, taken: &mut Taken) {
    for _ in 0..calls {
        match frames.next(slice).expect("a file") {
            Next::Working => {}
            // NaN is not equal to itself, so texts are compared.
            Next::TimeSeries(history) => taken.history = Some(format!("{history:?}")),
            Next::Frame(frame) => taken.frames.push(format!("{frame:?}")),
            Next::Done => return,
        }
    }
}

fn through_a_file(progress: &Progress) -> Progress {
    postcard::from_bytes(&postcard::to_allocvec(progress).unwrap()).expect("what was written")
}

#[test]
fn wherever_it_stops_it_goes_on_with_the_same_bits() {
    let scene = Scene::parse(SCENE, "small.toml", &Limits::default()).unwrap_or_else(|error| panic!("{error}"));
    let numbers = [0, 2, 3, 6];
    for ahead in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("states");
        let store = |before| ahead.then(|| Growing::open(&path, before).unwrap());
        let mut whole = Taken::default();
        let mut all = frames(&scene, &numbers, store(None));
        take(&mut all, u64::MAX, usize::MAX, &mut whole);
        assert_eq!((whole.frames.len(), whole.history.is_some()), (numbers.len(), ahead));
        let series: History = all.take_history();
        let mut stops = 0;
        for calls in 0.. {
            let mut taken = Taken::default();
            let mut first = frames(&scene, &numbers, store(None));
            take(&mut first, 7, calls, &mut taken);
            let Some(progress) = first.progress().unwrap() else { break };
            assert_eq!(taken.frames.len(), progress.taken);
            let before = first.simulated();
            drop(first);
            let mut second = frames(&scene, &numbers, store(progress.waiting()));
            second.resume(through_a_file(&progress)).unwrap();
            assert_eq!(second.simulated(), before, "no step is taken twice");
            take(&mut second, 11, usize::MAX, &mut taken);
            assert!(taken == whole, "ahead: {ahead}, after {calls} calls");
            // Time series that were returned with the frames are not stored.
            assert_eq!(format!("{:?}", second.take_history()), format!("{series:?}"), "after {calls} calls");
            let total: Vec<_> = (0..3).map(|run| scene.frame_step(run, 6)).collect();
            assert_eq!(second.simulated(), total);
            stops += 1;
        }
        assert!(stops > 10, "{stops}");
    }
}

#[test]
fn progress_of_another_kind_is_refused() {
    let scene = Scene::parse(SCENE, "small.toml", &Limits::default()).unwrap();
    let store = || Some(Growing::new(tempfile::tempfile().unwrap()));
    let progress = |frames: &mut Frames<'_>, calls: usize| {
        take(frames, 7, calls, &mut Taken::default());
        through_a_file(&frames.progress().unwrap().expect("something is left"))
    };
    let refused = |mut frames: Frames<'_>, progress: Progress| {
        assert_eq!(frames.resume(progress).unwrap_err().kind(), std::io::ErrorKind::InvalidData);
    };
    let early = || progress(&mut frames(&scene, &[0, 2, 6], None), 4);
    refused(frames(&scene, &[0, 2, 6], store()), early());
    refused(frames(&scene, &[0, 2, 6], None), progress(&mut frames(&scene, &[0, 2, 6], store()), 4));
    refused(Frames::new(Runner::new(&scene, &[0, 1, 2]), &[0, 2, 6], None), early());
    refused(Frames::new(Runner::new(&scene, &[0, 1]), &[0, 2, 6], None), early());
    // It has passed the next of these frames.
    refused(frames(&scene, &[0, 1, 2, 3], None), progress(&mut frames(&scene, &[3, 6], None), 3));
    let other = Scene::parse(&SCENE.replace("[2, 1, 1]", "[2, 2, 1]"), "small.toml", &Limits::default()).unwrap();
    refused(frames(&other, &[0, 2, 6], None), early());
}
