//! The recordings of runs: archives beside the scene, and the bodies in them.

use super::lists::{ListSource, Lists};
use super::{Typed, body, mesh};
use crate::reading::beside::{ending, missing};
use crate::reading::collector::Here;
use crate::reading::words::{count, hexadecimal, list, nearest};
use crate::scene::file::{Positive, RunFile, StatesFile, Up};
use crate::scene::recording::{Archive, Axes, Flaw, Recorded};
use crate::scene::sequence::{self, Sequence};
use crate::scene::{COURSE, SceneBody};
use crate::sim::{Body, Dimension, IndexLists, State};
use glam::DVec3;
use localshape_mesh::{Cells, ReadError, Volume};
use sha2::{Digest, Sha256};
use std::sync::Arc;

/// A recording of a run.
#[derive(Debug)]
pub(super) struct ReadRecording<'a> {
    recorded: Recorded,
    own: Own<'a>,
    source: ListSource<'a>,
}

/// The body that comes with a recording.
#[derive(Debug)]
enum Own<'a> {
    Nothing,
    /// Its nodes at rest and its elements.
    Rest(Box<Lists<'a>>),
    /// The points and cells of the first moment. The rest shape is not known.
    Moment {
        cells: Box<Cells>,
        /// Whether the cells are elements.
        has_elements: bool,
    },
}

impl<'a> ReadRecording<'a> {
    /// The recording of a run, if it has one; `None` after reporting its mistakes, too.
    pub(super) fn read(scene: &Typed<'a>, at: usize) -> Option<Self> {
        let Typed { folder, limits, report, .. } = *scene;
        let (run, here) = (scene.file.run[at].as_ref()?, report.to("run").to(at));
        let rate = scene.file.time.as_ref().map_or(1.0, |time| time.frames_per_second);
        let (source, chosen) = run.states.as_ref()?.source(&here);
        let (ListSource { body: place, file: Some((file, _)) }, known) = (&source, report.total()) else { return None };
        let path = folder.join(file);
        let scale = run.scale.map_or(1.0, |Positive(scale)| scale);
        let axes = Axes { up: run.up.unwrap_or_default(), scale };
        let open = || -> Result<_, Flaw> {
            if sequence::is_one(file) {
                let Sequence { archive, mut cells, has_elements, notes } = Sequence::read(folder, file, rate, limits)?;
                let note = |(message, help)| place.warn(format!("`{file}` {message}"), help);
                notes.into_iter().for_each(note);
                axes.place(&mut cells.points);
                let recorded = Archive::of(archive, &path, chosen, &run.name)?.recorded(axes, limits)?;
                return Ok((recorded, Own::Moment { cells: Box::new(cells), has_elements }));
            }
            if !path.exists() {
                let (message, help) = missing(&path, &["npz"]);
                return Err(Flaw { help, ..Flaw::new("", message) });
            }
            if let Some(help) = localshape_mesh::converter(&ending(&path)) {
                return Err(Flaw::new("", "is a file of a format that is not read").with_help(help));
            }
            if crate::scene::mesh::is_mesh(&path) {
                let help = "name those of all moments with a star, such as \"frames/*.obj\", or in a list (.pvd)";
                return Err(Flaw::new("", "is a file of one moment").with_help(help));
            }
            let mut archive = Archive::open(&path, chosen, &run.name)?;
            let (npz, name) = archive.parts();
            check_names(&npz.names(), name, file, place);
            let own = Lists::recorded(npz, name, source.clone(), limits).map(|mut own| {
                axes.place(&mut own.nodes);
                Own::Rest(Box::new(own))
            });
            let recorded = archive.recorded(axes, limits)?;
            if recorded.columns == 2 && axes.up == Up::Z {
                let up = here.to("up");
                up.wrong(format!("`{up}` is \"z\", but `{file}` is in the plane"), "expected \"x\" or \"y\"");
            }
            Ok((recorded, own.unwrap_or(Own::Nothing)))
        };
        match open() {
            Ok((recorded, own)) => (report.total() == known).then_some(Self { recorded, own, source }),
            Err(flaw) => source.tell(flaw),
        }
    }

    /// A digest of the recording and its body.
    pub(super) fn digest(&self) -> String {
        let own = match &self.own {
            Own::Nothing => String::new(),
            Own::Rest(lists) => lists.digest(),
            Own::Moment { cells, .. } => digest_of(cells),
        };
        self.recorded.digest.clone() + &own
    }

    /// The recording, its state at the start, and its body unless it is the scene's; `None` after reporting a mistake. `whole` are all bodies of
    /// the run as one; `is_beside` says whether other runs are simulated.
    pub(super) fn shown(
        self,
        run: &RunFile,
        whole: &Body,
        is_beside: bool,
    ) -> Option<(Arc<Recorded>, State, Option<SceneBody>)> {
        let source = self.source;
        let (report, known) = (source.body.report, source.body.report.total());
        // Archives tell masses, or have the default that is documented for them.
        let is_moment = matches!(self.own, Own::Moment { .. });
        let (recorded, own) = match self.own.of(self.recorded, whole, &source) {
            Ok((recorded, own)) => (Arc::new(recorded), own),
            Err(flaw) => return source.tell(flaw),
        };
        let start = recorded.start();
        let start = State::new(start.position, start.velocity);
        let Some((own, turned, notes)) = own else { return Some((recorded, start, None)) };
        if run.bodies.is_some() {
            let help = "remove `bodies`, so that its own body is shown";
            return source.tell(Flaw::new("", "has another body than those in `bodies`").with_help(help));
        }
        if let Some((file, place)) = &source.file {
            mesh::warn_of_turned(turned, own.elements.len(), file, place);
            notes.iter().for_each(|note| place.warn(format!("`{file}` {note}"), None));
            if is_moment && is_beside {
                let nodes = count(own.nodes.len() as u128);
                let message =
                    format!("`{file}` has no masses: energies and momenta count each of its {nodes} nodes with 1 kg");
                place.warn(message, "do not compare them with those of other runs, or give `mass` in a NumPy archive");
            }
        }
        let made = body::recorded(own, run.name.clone(), start.clone())?;
        (report.total() == known).then_some((recorded, start, Some(made)))
    }
}

/// A body of a recording's own, the number of its elements that were turned over, and the parts left out of its file.
type Listed<'a> = (Lists<'a>, usize, Vec<String>);

impl<'a> Own<'a> {
    /// The recording of a body, and the body unless it is the whole of a run.
    fn of(
        self,
        recorded: Recorded,
        whole: &Body,
        source: &ListSource<'a>,
    ) -> Result<(Recorded, Option<Listed<'a>>), Flaw> {
        let dimension = whole.dimension();
        let wrong = match (dimension, recorded.columns) {
            (Dimension::Space, 2) => "has 2 coordinates for each node, and the scene is in space; expected 3",
            (Dimension::Plane, 3) if !recorded.is_flat => {
                "leaves the plane of the scene; expected z = 0, or 2 coordinates"
            }
            _ => "",
        };
        if !wrong.is_empty() {
            return Err(Flaw::new("position", wrong));
        }
        let is_as_long = recorded.nodes == whole.len();
        let [nodes, expected] = [recorded.nodes, whole.len()].map(|nodes| count(nodes as u128));
        match self {
            Self::Nothing if is_as_long => Ok((recorded, None)),
            Self::Nothing => {
                let message = format!("has {nodes} nodes, and the bodies of the run have {expected}");
                let help = "expected the same nodes, or a body of its own: the arrays `rest` and `elements`";
                Err(Flaw::new("position", message).with_help(help))
            }
            Self::Rest(own) if own.nodes.len() != recorded.nodes => {
                let rest = count(own.nodes.len() as u128);
                Err(Flaw::new("position", format!("has {nodes} nodes, and `rest` has {rest}; expected as many")))
            }
            Self::Rest(own) if dimension == Dimension::Plane && own.nodes.iter().any(|node| node.z != 0.0) => {
                Err(Flaw::new("rest", "leaves the plane of the scene; expected z = 0, or 2 coordinates"))
            }
            Self::Rest(own) => {
                let is_same = are_near(&own.nodes, whole) && are_alike(&own.elements, whole.elements());
                Ok((recorded, (!is_same).then_some((Lists { dimension, ..*own }, 0, Vec::new()))))
            }
            // First with all points: nodes of springs may belong to no cell.
            Self::Moment { cells, has_elements, .. }
                if is_as_long && (!has_elements || are_alike(&cells.corners, whole.elements())) =>
            {
                Ok((recorded, None))
            }
            Self::Moment { cells, .. } => {
                let wrong = |error: ReadError| Flaw { help: error.help, ..Flaw::new("", error.message) };
                let Volume { places, solids, points: nodes, cells: elements, turned, notes, .. } =
                    cells.elements(dimension).map_err(wrong)?;
                let is_same = nodes.len() == whole.len() && are_alike(&elements, whole.elements());
                let own = Lists { solids, ..Lists::new(source.clone(), dimension, nodes, elements) };
                Ok((recorded.only(places), (!is_same).then_some((own, turned, notes))))
            }
        }
    }
}

/// The names of arrays in a recording.
const ARRAYS: [&str; 9] = ["position", "time", "velocity", "rest", "elements", "faces", "mass", "step", "engine"];
/// Further arrays in states of this program.
const OWN: [&str; 4] = ["memory", "body", "bodies", COURSE];

/// Reports arrays of a body without its nodes, and warns of arrays that are not read.
fn check_names(names: &[String], run: &str, file: &str, here: &Here<'_>) {
    let key = |name: &str| name.strip_prefix(run).and_then(|rest| rest.strip_prefix('.')).unwrap_or(name).to_owned();
    // Those with a point belong to other runs.
    let keys: Vec<_> = names.iter().map(|name| (name, key(name))).filter(|(_, key)| !key.contains('.')).collect();
    let has_rest = keys.iter().any(|(_, key)| key == "rest");
    for (name, key) in &keys {
        if ["elements", "faces", "mass"].contains(&&**key) && !has_rest {
            let message = format!("`{file}: {name}` belongs to a body, whose nodes at rest are missing");
            here.wrong(message, "expected `rest` and `elements` beside it, or neither");
        } else if !ARRAYS.contains(&&**key) && !OWN.contains(&&**key) {
            let help = match nearest(key, &ARRAYS) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("known here: {}", list(&ARRAYS, "and", str::to_owned)),
            };
            here.warn(format!("`{file}: {name}` is not an array of a recording, and is not read"), help);
        }
    }
}

impl StatesFile {
    /// Their file and its place in a run of the scene, and the chosen run in it.
    fn source<'a>(&self, run: &Here<'a>) -> (ListSource<'a>, Option<&str>) {
        let (file, place, chosen) = match self {
            Self::File(file) => (file, run.to("states"), None),
            Self::OfRun(of) => (&of.file, run.to("states").to("file"), of.run.as_deref()),
        };
        (ListSource { body: place.clone(), file: Some((file.clone(), place)) }, chosen)
    }
}

impl ListSource<'_> {
    /// Reports a mistake in a recording.
    fn tell<T>(&self, Flaw { place, message, help }: Flaw) -> Option<T> {
        let (file, at) = self.file.as_ref()?;
        let found = if place.is_empty() { file.clone() } else { self.name(&place, &[]) };
        at.wrong(format!("`{found}` {message}"), help);
        None
    }
}

/// Whether these are the nodes of a body at rest. Single precision is enough.
fn are_near(nodes: &[DVec3], whole: &Body) -> bool {
    /// The greatest distance of two equal nodes, as a share of the body's size.
    const APART: f64 = 1e-6;
    let near = APART * whole.extent();
    nodes.len() == whole.len() && nodes.iter().zip(whole.rest()).all(|(one, other)| one.distance(*other) <= near)
}

/// Whether elements have the same nodes. Programs list those of some kinds in other orders.
fn are_alike(one: &IndexLists, other: &IndexLists) -> bool {
    let sorted = |nodes: &[u32]| {
        let mut nodes = nodes.to_vec();
        nodes.sort_unstable();
        nodes
    };
    let is_alike = |(one, other): (&[u32], &[u32])| one == other || sorted(one) == sorted(other);
    one.len() == other.len() && one.iter().zip(other.iter()).all(is_alike)
}

/// A digest of cells. Their points are positions of the recording.
fn digest_of(cells: &Cells) -> String {
    let mut hash = Sha256::new();
    for (kind, corners) in cells.kinds.iter().zip(cells.corners.iter()) {
        hash.update([*kind as u8]);
        hash.update((corners.len() as u64).to_le_bytes());
        corners.iter().for_each(|corner| hash.update(corner.to_le_bytes()));
    }
    hexadecimal(&hash.finalize())
}
