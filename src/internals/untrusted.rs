//! Every reader of files by name, to be fuzzed (`fuzz/`) and tested with damaged files.
//!
//! A reader accepts or refuses any bytes. It never panics, and takes no more time and memory than limits and the length
//! of the file allow.

use crate::golden::{Pixels, is_record};
use crate::look::Plot;
use crate::mesh::{self, Fill, Format, Mesh};
use crate::output::{Access, Folder, Manifest, Whose, read_tags};
use crate::reading::setting::Setting;
use crate::runner::{Frames, Next, Progress, Runner, Stored};
use crate::scene::figure::Figure;
use crate::scene::{Limits, Scene};
use crate::sim::State;
use crate::sim::geometry::bounds;
use std::fs;
use std::path::Path;

/// A reader of files.
pub struct Reader {
    /// Its name, and the name of its fuzz target.
    pub name: &'static str,
    /// Reads a file with these bytes. Returns true if the file is accepted.
    pub read: fn(&[u8]) -> bool,
}

/// All readers.
pub const READERS: [Reader; 26] = [
    Reader { name: "scene", read: scene },
    Reader { name: "setting", read: setting },
    Reader { name: "figure", read: figure },
    Reader { name: "body", read: body },
    Reader { name: "obj", read: |bytes| mesh(bytes, Format::Obj) },
    Reader { name: "stl", read: |bytes| mesh(bytes, Format::Stl) },
    Reader { name: "ply", read: |bytes| mesh(bytes, Format::Ply) },
    Reader { name: "off", read: |bytes| mesh(bytes, Format::Off) },
    Reader { name: "gltf", read: |bytes| mesh(bytes, Format::Gltf) },
    Reader { name: "gmsh", read: |bytes| mesh(bytes, Format::Gmsh) },
    Reader { name: "vtk", read: |bytes| mesh(bytes, Format::Vtk) },
    Reader { name: "vtu", read: |bytes| mesh(bytes, Format::Vtu) },
    Reader { name: "medit", read: |bytes| mesh(bytes, Format::Medit) },
    Reader { name: "abaqus", read: |bytes| mesh(bytes, Format::Abaqus) },
    Reader { name: "font", read: font },
    Reader { name: "states", read: states },
    Reader { name: "recording", read: recording },
    Reader { name: "list", read: |bytes| list("list.pvd", "list.pvd", bytes) },
    Reader { name: "series", read: |bytes| list("list.vtu.series", "list.vtu.series", bytes) },
    Reader { name: "pieces", read: |bytes| list("list_0.pvtu", "list_*.pvtu", bytes) },
    Reader { name: "moment", read: moment },
    Reader { name: "checkpoint", read: checkpoint },
    Reader { name: "state", read: |bytes| State::from_bytes(bytes).is_some() },
    Reader { name: "summary", read: summary },
    Reader { name: "picture", read: picture },
    Reader { name: "golden", read: |bytes| std::str::from_utf8(bytes).is_ok_and(is_record) },
];

/// Reads a file by the reader of this name.
///
/// # Panics
/// There is no such reader.
pub fn read(name: &str, bytes: &[u8]) {
    (READERS.iter().find(|reader| reader.name == name).expect("a reader").read)(bytes);
}

/// Scenes that are read within milliseconds.
const LIMITS: Limits = Limits { nodes: 1000, corners: 8000, springs: 20_000, file: 1 << 20, recorded: 10_000 };

/// The scene to which states, checkpoints and bodies of tests belong.
pub const SCENE: &str = "
    gravity = [0, -9.8, 0]
    time = { duration = 0.1, frames_per_second = 60 }
    body.lattice = { cells = [1, 1, 1], side = 0.1 }
    obstacle = [{ kind = 'floor' }]
    [[run]]
    name = 'shape'
    model = { kind = 'shape-based', stiffness = 1e4 }
    [[run]]
    name = 'springs'
    model = { kind = 'mass-spring', stiffness = 1e4 }
";

/// The model of a run of [`SCENE`], in whose place recordings stand.
const MODEL: &str = "model = { kind = 'shape-based', stiffness = 1e4 }";

/// A list of grids for the reader of lists.
pub const LIST: &str = "<?xml version=\"1.0\"?>
<!-- step 0.0005 -->
<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\"><Collection>
<DataSet timestep=\"0\" part=\"0\" file=\"grid.vtu\"/>
<DataSet timestep=\"0.05\" part=\"0\" file=\"grid.vtu\"/>
</Collection></VTKFile>";

/// The same list in JSON, and the pieces of a grid.
pub const SERIES: &str = r#"{ "files": [{ "name": "grid.vtu", "time": 0 }, { "name": "grid.vtu", "time": 0.05 }] }"#;
pub const PIECES: &str = r#"<VTKFile type="PUnstructuredGrid"><Piece Source="grid.vtu"/></VTKFile>"#;

/// The grid that they name: a cube.
pub const GRID: &str = "<?xml version=\"1.0\"?>
<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\"><UnstructuredGrid>
<Piece NumberOfPoints=\"8\" NumberOfCells=\"1\">
<PointData><DataArray type=\"Float32\" Name=\"velocity\" NumberOfComponents=\"3\" format=\"ascii\">
0 1 0 0 1 0 0 1 0 0 1 0 0 1 0 0 1 0 0 1 0 0 1 0
</DataArray></PointData>
<Points><DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"ascii\">
0 0 0 0.1 0 0 0 0.1 0 0.1 0.1 0 0 0 0.1 0.1 0 0.1 0 0.1 0.1 0.1 0.1 0.1
</DataArray></Points>
<Cells>
<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 3 2 4 5 7 6</DataArray>
<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">8</DataArray>
<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">12</DataArray>
</Cells></Piece></UnstructuredGrid></VTKFile>";

/// Reads a scene and takes its first steps.
fn scene(bytes: &[u8]) -> bool {
    std::str::from_utf8(bytes).is_ok_and(|text| begin(Scene::parse(text, "fuzz.toml", &LIMITS)))
}

/// Takes the first steps of a scene, and composes its first picture. Returns true if there is a scene.
fn begin<E>(scene: Result<Scene, E>) -> bool {
    let Ok(scene) = scene else { return false };
    let frame = Runner::new(&scene, &(0..scene.runs.len()).collect::<Vec<_>>()).frame(0);
    #[cfg(feature = "render")]
    crate::picture::Composer::new(&scene, &Default::default()).compose(&frame);
    drop(frame);
    for run in 0..scene.runs.len() {
        let mut world = scene.world(run);
        world.advance(3);
        world.snapshot();
    }
    true
}

/// Reads [`SCENE`] with an option `--set` of these bytes.
fn setting(bytes: &[u8]) -> bool {
    let setting = std::str::from_utf8(bytes).ok().and_then(|text| text.parse::<Setting>().ok());
    setting.is_some_and(|setting| {
        in_folder("scene.toml", SCENE.as_bytes(), |path| begin(Scene::load_with(path, &[setting], &LIMITS)))
    })
}

fn figure(bytes: &[u8]) -> bool {
    in_folder("figure.toml", bytes, |path| Figure::load(path, &LIMITS).is_ok())
}

/// Reads a NumPy archive as the body of a scene.
fn body(bytes: &[u8]) -> bool {
    beside(
        "body.npz",
        bytes,
        &SCENE.replace("body.lattice = { cells = [1, 1, 1], side = 0.1 }", "body = { file = 'body.npz', lowest = 0 }"),
    )
}

/// Reads a mesh, and fills a surface with elements of every kind.
fn mesh(bytes: &[u8], format: Format) -> bool {
    let limits = mesh::Limits { points: LIMITS.nodes as usize, corners: LIMITS.corners as usize };
    // A file that is named beside has the same bytes.
    let cells = mesh::read_cells_with(bytes, format, &limits, &mut |_| Ok(bytes.to_vec()));
    let found = cells.and_then(|cells| cells.mesh(format));
    if let Ok(Mesh::Surface(surface)) = &found {
        let (low, high) = bounds(&surface.points);
        let side = (high - low).max_element() / 6.0;
        for fill in [Fill::Cubes { side }, Fill::Graded { side }, Fill::Tetrahedra { side }, Fill::Polyhedra { side }] {
            // Whether it can be filled is another question.
            let _ = mesh::fill(surface, fill, 1000);
        }
    }
    found.is_ok()
}

/// Reads the font of a scene, and writes with it.
fn font(bytes: &[u8]) -> bool {
    beside("font.ttf", bytes, &format!("view.font.regular = 'font.ttf'\n{SCENE}"))
}

/// Reads a NumPy archive as the recording of a run.
fn recording(bytes: &[u8]) -> bool {
    beside("states.npz", bytes, &SCENE.replace(MODEL, "states = 'states.npz'"))
}

/// Reads a list of grids as the recording of a run with these states, beside the grid that it names.
fn list(name: &str, states: &str, bytes: &[u8]) -> bool {
    in_folder(name, bytes, |path| {
        fs::write(path.with_file_name("grid.vtu"), GRID).expect("a file");
        let file = path.with_file_name("scene.toml");
        fs::write(&file, SCENE.replace(MODEL, &format!("states = '{states}'"))).expect("a file");
        begin(Scene::load(&file, &LIMITS))
    })
}

/// Reads a grid as the only moment of the recording of a run.
fn moment(bytes: &[u8]) -> bool {
    beside("moment_0.vtu", bytes, &SCENE.replace(MODEL, "states = 'moment_*.vtu'"))
}

fn sound() -> Scene {
    Scene::parse(SCENE, "scene.toml", &LIMITS).expect("sound")
}

/// The frames that checkpoints are of.
fn frames(scene: &Scene) -> Frames<'_> {
    let runner = Runner::new(scene, &[0, 1]).with_time_series(&Plot::diagnostics()[..]);
    Frames::new(runner, &[2, 4], None)
}

/// Reads the states of [`SCENE`] up to its first frame.
fn states(bytes: &[u8]) -> bool {
    in_folder("states.npz", bytes, |path| {
        let scene = sound();
        let Ok(stored) = Stored::open(path, &scene, &[0, 1], &[0]) else { return false };
        let Ok(mut frames) = Frames::stored(Runner::new(&scene, &[0, 1]), &[0], stored) else { return false };
        loop {
            match frames.next(1) {
                Ok(Next::TimeSeries(_)) => {}
                next => return matches!(next, Ok(Next::Frame(_))),
            }
        }
    })
}

/// Continues [`SCENE`] from a checkpoint, without the digest that would refuse every damage.
fn checkpoint(bytes: &[u8]) -> bool {
    let Ok(progress) = postcard::from_bytes::<Progress>(bytes) else { return false };
    let scene = sound();
    let mut frames = frames(&scene);
    let is_sound = frames.resume(progress).is_ok();
    for _ in 0..100 {
        if !is_sound || !matches!(frames.next(10), Ok(Next::Working | Next::Frame(_))) {
            break;
        }
    }
    is_sound
}

/// Reads `run.json` of a folder with results of [`SCENE`].
fn summary(bytes: &[u8]) -> bool {
    in_folder("run.json", bytes, |path| {
        let scene = sound();
        let (runs, files) = (vec!["shape".to_owned()], Vec::new());
        let manifest = Manifest { runs, frames: vec![0], states: false, files, pictures: None };
        let folder = path.parent().expect("a folder");
        Folder::inspect(folder, Whose::of(&scene), manifest, Access::default()).is_ok()
    })
}

/// Reads the metadata and the pixels of a picture.
fn picture(bytes: &[u8]) -> bool {
    in_folder("picture.png", bytes, |path| read_tags(path).is_ok_and(|_| Pixels::from_bytes(bytes).is_ok()))
}

/// A checkpoint for that reader.
pub fn checkpoint_of_scene() -> Vec<u8> {
    let scene = sound();
    let mut frames = frames(&scene);
    frames.next(3).expect("no file is needed");
    let progress = frames.progress().expect("no file is needed").expect("frames are left");
    postcard::to_allocvec(&progress).expect("plain data")
}

/// Reads a scene with a file of these bytes beside it.
fn beside(name: &str, bytes: &[u8], scene: &str) -> bool {
    in_folder(name, bytes, |path| {
        let file = path.with_file_name("scene.toml");
        fs::write(&file, scene).expect("a file");
        begin(Scene::load(&file, &LIMITS))
    })
}

/// Calls `read` with a file of these bytes, in a folder of its own.
fn in_folder(name: &str, bytes: &[u8], read: impl FnOnce(&Path) -> bool) -> bool {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    fs::write(&path, bytes).expect("a file");
    read(&path)
}
