//! The recordings of runs: archives beside the scene, and the bodies in them.

use super::body::ResolvedBody;
use super::lists::{ListSource, Lists};
use super::{Place, body};
use crate::reading::beside::{missing, similar};
use crate::reading::collector::{Collector, key_path};
use crate::reading::words::{count, list, nearest};
use crate::scene::file::{RunFile, StatesFile};
use crate::scene::limits::Limits;
use crate::scene::recording::{Archive, Flaw, Recorded};
use crate::scene::sequence::{self, Sequence};
use crate::scene::{COURSE, Together};
use crate::sim::{Assembly, Dimension, State};
use std::path::Path;
use std::sync::Arc;

/// A recording of a run.
#[derive(Debug)]
pub(super) struct ReadRecording {
    pub(super) recorded: Arc<Recorded>,
    /// The body in its archive, if it has one.
    own: Option<Lists>,
    /// The name of its file as typed.
    file: String,
    alike: Alike,
}

/// When a body in a file is that of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Alike {
    /// Nodes at rest and elements are equal.
    Whole,
    /// Elements are equal. Files of single moments do not tell the rest shape.
    Elements,
    /// There are as many nodes. Surfaces do not tell elements.
    Nodes,
}

/// What a recording shows.
pub(super) enum Shown {
    /// The bodies of its run.
    Bodies(State),
    /// A body of its own.
    Own(Box<ResolvedBody>),
}

impl ReadRecording {
    /// The recording of a run, if it has one; `None` after reporting its mistakes, too.
    pub(super) fn read(
        folder: &Path,
        at: usize,
        run: &RunFile,
        rate: f64,
        limits: &Limits,
        report: &mut Collector<'_>,
    ) -> Option<Self> {
        let (file, chosen) = run.states.as_ref()?.parts();
        let sequence = sequence::is_one(file).then(|| Sequence::read(folder, file, rate, limits)).transpose();
        let sequence = sequence.map_err(|flaw| told(at, run, file, flaw, report)).ok()?;
        let path = sequence.as_ref().map_or_else(|| folder.join(file), |made| made.archive.path().to_owned());
        let alike = match sequence.as_ref().map(|made| made.has_elements) {
            None => Alike::Whole,
            Some(true) => Alike::Elements,
            Some(false) => Alike::Nodes,
        };
        if !path.exists() {
            let near = similar(&path, &["npz"]).map(|near| format!("did you mean {near:?}?"));
            report.at(&place(at, run), format!("`{file}` {}", missing(&path)), near);
            return None;
        }
        let known = report.total();
        let open = |report: &mut Collector<'_>| -> Result<_, Flaw> {
            let mut archive = Archive::open(&path, chosen, &run.name)?;
            let (npz, name) = archive.parts();
            check_names(&npz.names(), name, file, &place(at, run), report);
            let own = Lists::recorded(npz, name, source(at, run), limits, report);
            Ok((archive.recorded()?, own))
        };
        match open(report) {
            Ok((recorded, own)) => {
                let (recorded, file) = (Arc::new(recorded), file.to_owned());
                (report.total() == known).then_some(Self { recorded, own, file, alike })
            }
            Err(flaw) => {
                told(at, run, file, flaw, report);
                None
            }
        }
    }

    /// A digest of the recording and its body.
    pub(super) fn digest(&self) -> String {
        let own = self.own.as_ref().map(Lists::digest).unwrap_or_default();
        self.recorded.digest.clone() + &own
    }

    /// Whether the body in the archive is the scene's, and how the recording moves it; `None` after reporting a mistake.
    /// `all` are the bodies of the run, and `dimension` is that of the scene.
    pub(super) fn shown(
        &self,
        at: usize,
        run: &RunFile,
        all: &Together,
        dimension: Dimension,
        report: &mut Collector<'_>,
    ) -> Option<Shown> {
        let (file, place) = (&self.file, place(at, run));
        let Recorded { columns, is_flat, .. } = *self.recorded;
        let wrong = match (dimension, columns) {
            (Dimension::Space, 2) => Some("has 2 coordinates for each node, and the scene is in space; expected 3"),
            (Dimension::Plane, 3) if !is_flat => {
                Some("leaves the plane of the scene; expected z = 0, or 2 coordinates")
            }
            _ => None,
        };
        if let Some(wrong) = wrong {
            report.at(&place, format!("`{file}: position` {wrong}"), None);
            return None;
        }
        let (nodes, known) = (self.recorded.nodes, report.total());
        let start = self.recorded.start();
        let start = State::new(start.position, start.velocity);
        let Some(own) = &self.own else {
            let expected = all.bodies.whole().len();
            if nodes == expected {
                return Some(Shown::Bodies(start));
            }
            let [nodes, expected] = [nodes, expected].map(|nodes| count(nodes as u128));
            let message = format!("`{file}: position` has {nodes} nodes, and the bodies of the run have {expected}");
            let help = "expected the same nodes, or a body of its own: the arrays `rest` and `elements`";
            report.at(&place, message, help.to_owned());
            return None;
        };
        if own.nodes.len() != nodes {
            let [nodes, rest] = [nodes, own.nodes.len()].map(|nodes| count(nodes as u128));
            let message = format!("`{file}: position` has {nodes} nodes, and `rest` has {rest}; expected as many");
            report.at(&place, message, None);
            return None;
        }
        if dimension == Dimension::Plane && own.nodes.iter().any(|node| node.z != 0.0) {
            let message = format!("`{file}: rest` leaves the plane of the scene; expected z = 0, or 2 coordinates");
            report.at(&place, message, None);
            return None;
        }
        if is_same(own, &all.bodies, self.alike) {
            return Some(Shown::Bodies(start));
        }
        if run.bodies.is_some() {
            let message = format!("`{file}` has another body than those in `bodies`");
            report.at(&place, message, "remove `bodies`, so that its own body is shown".to_owned());
            return None;
        }
        let mut own = own.clone();
        own.dimension = dimension;
        let made = body::recorded(own, run.name.clone(), start, report)?;
        (report.total() == known).then(|| Shown::Own(Box::new(made)))
    }
}

/// The names of arrays in a recording.
const ARRAYS: [&str; 9] = ["position", "time", "velocity", "rest", "elements", "faces", "mass", "step", "engine"];
/// Further arrays in states of this program.
const OWN: [&str; 4] = ["memory", "body", "bodies", COURSE];

/// Reports arrays of a body without its nodes, and warns of arrays that are not read.
fn check_names(names: &[String], run: &str, file: &str, place: &Place, report: &mut Collector<'_>) {
    let key = |name: &str| name.strip_prefix(run).and_then(|rest| rest.strip_prefix('.')).unwrap_or(name).to_owned();
    // Those with a point belong to other runs.
    let keys: Vec<_> = names.iter().map(|name| (name, key(name))).filter(|(_, key)| !key.contains('.')).collect();
    let has_rest = keys.iter().any(|(_, key)| key == "rest");
    for (name, key) in &keys {
        if ["elements", "faces", "mass"].contains(&&**key) && !has_rest {
            let message = format!("`{file}: {name}` belongs to a body, whose nodes at rest are missing");
            report.at(place, message, "expected `rest` and `elements` beside it, or neither".to_owned());
        } else if !ARRAYS.contains(&&**key) && !OWN.contains(&&**key) {
            let help = match nearest(key, &ARRAYS) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("known here: {}", list(&ARRAYS, "and", str::to_owned)),
            };
            report.warn(place, format!("`{file}: {name}` is not an array of a recording, and is not read"), help);
        }
    }
}

impl StatesFile {
    /// The file, and the chosen run in it.
    fn parts(&self) -> (&str, Option<&str>) {
        match self {
            Self::File(file) => (file, None),
            Self::OfRun(chosen) => (&chosen.file, chosen.run.as_deref()),
        }
    }
}

/// Reports a mistake in a file.
fn told(at: usize, run: &RunFile, file: &str, flaw: Flaw, report: &mut Collector<'_>) {
    let Flaw { place: found, message, help } = flaw;
    let found = if found.is_empty() { file.to_owned() } else { format!("{file}: {found}") };
    report.at(&place(at, run), format!("`{found}` {message}"), help);
}

/// The place of the file's name in the scene.
fn place(at: usize, run: &RunFile) -> Place {
    match run.states {
        Some(StatesFile::OfRun(_)) => key_path!["run", at, "states", "file"].to_vec(),
        _ => key_path!["run", at, "states"].to_vec(),
    }
}

fn source(at: usize, run: &RunFile) -> ListSource {
    let file = run.states.as_ref().map(|states| (states.parts().0.to_owned(), place(at, run)));
    ListSource { body: place(at, run), file }
}

/// Whether a body in an archive is made of the same nodes and elements as the bodies of a run.
fn is_same(own: &Lists, bodies: &Assembly, alike: Alike) -> bool {
    /// The greatest distance of two equal nodes, as a share of the body's size: single precision is enough.
    const APART: f64 = 1e-6;
    let whole = bodies.whole();
    let near = APART * whole.extent();
    let is_near = |(one, other): (&glam::DVec3, &glam::DVec3)| one.distance(*other) <= near;
    // Grids list the corners of some elements in another order.
    let sorted = |nodes: &[u32]| {
        let mut nodes = nodes.to_vec();
        nodes.sort_unstable();
        nodes
    };
    let is_element =
        |(one, other): (&[u32], &[u32])| one == other || alike == Alike::Elements && sorted(one) == sorted(other);
    let has_elements =
        || own.elements.len() == whole.elements.len() && own.elements.iter().zip(whole.elements.iter()).all(is_element);
    own.nodes.len() == whole.len()
        && (alike == Alike::Nodes || has_elements())
        && (alike != Alike::Whole || own.nodes.iter().zip(&whole.rest).all(is_near))
}
