//! Energies are computed only on request.

use glam::DVec3;
use localshape::runner::Runner;
use localshape::runner::moments::Taking;
use localshape::scene::figure::{Content, Figure};
use localshape::scene::{Limits, Scene};
use localshape::sim::model::{ElasticModel, ForceModel, Properties, Report, Scratch, Share};
use localshape::sim::{Body, Diagnostic, Diagnostics, Nodes, Scope};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A model that counts its reports.
#[derive(Debug)]
struct Counting {
    model: Arc<dyn ElasticModel>,
    reports: Arc<AtomicUsize>,
}

struct CountingForces {
    forces: Box<dyn ForceModel>,
    reports: Arc<AtomicUsize>,
}

impl ElasticModel for Counting {
    fn properties(&self, body: &Body) -> Properties {
        self.model.properties(body)
    }

    fn start(&self, body: &Body, position: &[DVec3]) -> Vec<f64> {
        self.model.start(body, position)
    }

    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel> {
        Box::new(CountingForces { forces: self.model.prepare(body), reports: Arc::clone(&self.reports) })
    }
}

impl ForceModel for CountingForces {
    fn add_forces(&self, at: Nodes<'_>, memory: &[f64], next: &mut [f64], scratch: &mut Scratch, forces: &mut [DVec3]) {
        self.forces.add_forces(at, memory, next, scratch, forces);
    }

    fn is_damped(&self) -> bool {
        self.forces.is_damped()
    }

    fn report(&self, at: Nodes<'_>, memory: &[f64], share: &mut Share<'_>) -> Report {
        self.reports.fetch_add(1, Ordering::Relaxed);
        self.forces.report(at, memory, share)
    }
}

/// Makes the models of a scene count their reports.
fn count(scene: &mut Scene) -> Arc<AtomicUsize> {
    let reports = Arc::new(AtomicUsize::new(0));
    for run in &mut scene.runs {
        run.models[0] = Arc::new(Counting { model: Arc::clone(&run.models[0]), reports: Arc::clone(&reports) });
    }
    reports
}

const SCENE: &str = "
    gravity = [0, -9.8, 0]
    time = { duration = 0.2, frames_per_second = 20 }
    body.lattice = { cells = [2, 1, 1], side = 0.1 }
    body.velocity = [0, -2, 0]
    obstacle = [{ kind = 'floor' }]
    run = [
        { name = 'shape', model = { kind = 'shape-based', stiffness = 1e4 } },
        { name = 'springs', model = { kind = 'mass-spring', stiffness = 1e4 } },
    ]
";

fn scene(view: &str) -> Scene {
    Scene::parse(&format!("{SCENE}\n{view}"), "small.toml", &Limits::default()).expect("sound")
}

#[test]
fn pictures_ask_for_energies_only_where_they_show_them() {
    for (view, asked) in [("", 0), ("view.charts = ['volume_ratio']", 0), ("view.charts = ['energy']", 2)] {
        let mut scene = scene(view);
        let reports = count(&mut scene);
        let mut runner = Runner::new(&scene, &[0, 1]).with_diagnostics(&scene.frame_diagnostics());
        let frame = runner.frame(4);
        assert_eq!(reports.swap(0, Ordering::Relaxed), asked, "{view}");
        // By default all energies are there.
        let all = Runner::new(&scene, &[0, 1]).frame(4);
        assert_eq!(reports.load(Ordering::Relaxed), 2);
        for (some, all) in frame.runs.iter().zip(&all.runs) {
            for &diagnostic in Diagnostic::ALL {
                let [some, all] = [some, all].map(|run| diagnostic.of(&run.snapshot.diagnostics));
                let is_shown = scene.frame_diagnostics().contains(&diagnostic);
                assert!(!is_shown || some.to_bits() == all.to_bits() && some != 0.0, "{diagnostic:?}: {some}");
            }
            assert_eq!(some.snapshot.turned_over, all.snapshot.turned_over);
            assert_eq!(some.snapshot.placements, all.snapshot.placements);
        }
    }
}

#[test]
fn kernels_compute_nothing_that_is_not_wanted() {
    let scene = scene("");
    let mut world = scene.world(0);
    world.advance(100);
    let all = world.diagnostics();
    for &wanted in Diagnostic::ALL {
        world.want(&[wanted]);
        let found = world.snapshot().diagnostics;
        assert_eq!(wanted.of(&found).to_bits(), wanted.of(&all).to_bits());
        let others = Diagnostic::ALL.iter().filter(|&&other| other != wanted && other.of(&found) != 0.0).count();
        assert_eq!(others, if wanted == Diagnostic::Energy { 3 } else { 0 }, "{wanted:?}");
    }
    world.want(&[]);
    assert_eq!(world.snapshot().diagnostics, Diagnostics::default());
}

#[test]
fn figures_ask_for_energies_only_where_they_show_them() {
    let mut figure = Figure::built_in("fig4b").expect("it comes with the program");
    let Content::Sheet(sheet) = &mut figure.content else { panic!("a contact sheet") };
    // The first moment is the start, without energy.
    sheet.columns.drain(..1);
    sheet.columns.truncate(2);
    let reports = count(&mut sheet.scenes[0]);
    let shown = sheet.rows.len() * sheet.columns.len();
    let (ratio, elastic) = (Diagnostic::VolumeRatio, Diagnostic::Elastic);
    for (scope, number, chart, asked) in [
        (Scope::Summaries, None, ratio, 0),
        (Scope::Summaries, Some(elastic), ratio, shown),
        (Scope::Frames, None, ratio, shown),
        (Scope::Summaries, None, elastic, 0),
    ] {
        let Content::Sheet(sheet) = &mut figure.content else { panic!("a contact sheet") };
        (sheet.number, sheet.charts) = (number, vec![chart.into()]);
        let mut taking = Taking::new(&figure, scope);
        while taking.advance(u64::MAX).is_some() {}
        let moments = taking.finish();
        let series = &moments.histories[0].series;
        let noted: usize = series.iter().map(|run| run.times.len()).sum();
        let expected = asked + if chart == elastic { noted } else { 0 };
        assert_eq!(reports.swap(0, Ordering::Relaxed), expected, "{scope:?}, {number:?}, {chart:?}");
        for run in moments.cells.iter().flatten() {
            let found = run.snapshot.diagnostics;
            assert!(found.volume_ratio > 0.0 && found.shape_error > 0.0);
            assert_eq!(found.elastic == 0.0, asked == 0);
        }
    }
}
