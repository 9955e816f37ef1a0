//! `--write`: files for other programs, read by them.

use crate::cli::bodies::{BODIES, scene};
use crate::cli::support::{Place, SMALL, validated, viewers};
use std::collections::BTreeMap;
use std::path::Path;

/// Elements of all kinds in space: cubes, wedges, pyramids and tetrahedra.
pub(crate) const MIXED: &str = r#"
title = "Mixed"
gravity = [0, -9.8, 0]
time = { duration = 0.1, frames_per_second = 60 }
[body]
lattice = { cells = [3, 3, 3], side = 0.1, elements = "mixed", irregular = 0.2 }
lowest = 0.0
velocity = [0, -2, 0]
[[run]]
name = "Local shape"
model = { kind = "shape-based", stiffness = 1e4, damping_ratio = 0.1 }
[[obstacle]]
kind = "floor"
[view]
colour.by = "elastic-energy"
size = [96, 64]
"#;

/// Two prisms of seven nodes and more, as convex hulls, a bar and a triangle.
pub(crate) const HULLS: &str = r#"
title = "Hulls"
gravity = [0, -9.8, 0]
time = { duration = 0.05, frames_per_second = 60 }
[body]
nodes = [
    [0, 0, 0], [1, 0, 0], [1.5, 1, 0], [0.5, 1.6, 0], [-0.5, 1, 0],
    [0, 0, 1], [1, 0, 1], [1.5, 1, 1], [0.5, 1.6, 1], [-0.5, 1, 1], [0.5, 0.7, 2], [0.5, 3, 0], [0.5, 3, 1],
]
elements = [[3, 1, 4, 0, 2, 9, 5, 7, 6, 8], [5, 6, 7, 8, 9, 10], [3, 11], [3, 11, 12]]
convex = true
[[run]]
name = "Local shape"
model = { kind = "shape-based", stiffness = 1e4 }
"#;

/// All files below a folder but `run.json`, which has times.
pub(crate) fn files_below(place: &Place, folder: &str) -> BTreeMap<String, Vec<u8>> {
    fn collect(root: &Path, at: &Path, into: &mut BTreeMap<String, Vec<u8>>) {
        for entry in std::fs::read_dir(at).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                collect(root, &path, into);
            } else {
                let name = path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/");
                into.insert(name, std::fs::read(&path).unwrap());
            }
        }
    }
    let (root, mut files) = (place.path(folder), BTreeMap::new());
    collect(&root, &root, &mut files);
    files.remove("run.json");
    files
}

/// Reads grids by VTK and compares them with `states.npz`, bit for bit.
const VTK: &str = r#"
import numpy
import xml.etree.ElementTree
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
from vtkmodules.util.numpy_support import vtk_to_numpy

def grid(path):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    assert reader.GetErrorCode() == 0, path
    return reader.GetOutput()

def of(filtered, name):
    filtered.Update()
    return vtk_to_numpy(filtered.GetOutput().GetCellData().GetArray(name))

states = numpy.load("out/states.npz")
runs = [name.removesuffix(".position") for name in states.files if name.endswith(".position")]
for run in runs:
    own = lambda name: states[f"{run}.{name}"] if f"{run}.{name}" in states.files else states[name]
    listed = xml.etree.ElementTree.parse(f"out/{run}.pvd").findall("Collection/DataSet")
    times = [float(one.get("timestep")) for one in listed]
    # Frames that show the same step are listed once.
    assert sorted(set(times)) == sorted(set(own("time"))), (run, times)
    names = list(states["bodies"]) if "bodies" in states.files else [None]
    bodies = own("body") if "bodies" in states.files else numpy.zeros(len(own("rest")), int)
    shown = [names[at] for at in sorted(set(bodies))]
    volume = None
    for frame, time in enumerate(own("time")):
        here = [one for one in listed if float(one.get("timestep")) == time]
        assert [one.get("name") for one in here] == shown and [int(one.get("part")) for one in here] == list(range(len(here)))
        grids = [grid("out/" + one.get("file")) for one in here]
        assert all(one.GetFieldData().GetArray("TimeValue").GetValue(0) == time for one in grids)
        points = numpy.concatenate([vtk_to_numpy(one.GetPoints().GetData()) for one in grids])
        assert points.tobytes() == states[f"{run}.position"][frame].tobytes(), (run, frame)
        velocity = numpy.concatenate([vtk_to_numpy(one.GetPointData().GetArray("velocity")) for one in grids])
        assert velocity.tobytes() == states[f"{run}.velocity"][frame].tobytes(), (run, frame)
    first = grids[0]
    # At the start no element is pressed flat.
    for one in [grid("out/" + one.get("file")) for one in listed[:len(shown)]]:
        for cell in map(one.GetCell, range(one.GetNumberOfCells())):
            corners = vtk_to_numpy(cell.GetPoints().GetData()).copy()
            for face in range(cell.GetNumberOfFaces()):
                face = vtk_to_numpy(cell.GetFace(face).GetPoints().GetData()) - corners.mean(axis=0)
                outward = sum(numpy.linalg.det(face[[0, at - 1, at]]) for at in range(2, len(face)))
                assert outward > 0, (cell.GetClassName(), outward)
    cells = sum(one.GetNumberOfCells() for one in grids)
    assert cells == len(own("elements")), cells
    kinds = sorted({one.GetCellType(cell) for one in grids for cell in range(one.GetNumberOfCells())})
    arrays = lambda data: [data.GetArrayName(at) for at in range(data.GetNumberOfArrays())]
    sizes = vtkCellSizeFilter()
    sizes.SetInputData(grid("out/" + listed[0].get("file")))
    size = of(sizes, "Volume") + of(sizes, "Area")
    print(run, kinds, arrays(first.GetPointData()), arrays(first.GetCellData()), round(float(size.sum()), 9), bool((size >= 0).all()))
"#;

/// What VTK tells of the grids of a scene in `out`.
fn told(place: &Place, text: &str, options: &str) -> Option<String> {
    let python = viewers()?;
    place.write("scene.toml", text);
    let ran = place.run(&format!("simulate scene.toml -o out --states --write vtu{options} --overwrite"));
    assert_eq!(ran.status, Some(0), "{ran:?}");
    Some(python(&place.path("."), VTK).trim().to_owned())
}

#[test]
fn vtk_reads_the_states_of_all_kinds_of_elements() {
    let place = Place::new();
    let Some(mixed) = told(&place, MIXED, "") else { return };
    assert_eq!(mixed, "Local shape [10, 12, 13, 14] ['velocity', 'elastic-energy'] ['turned_over'] 0.027 True");
    // A prism over a pentagon, a pyramid on it, a bar and a triangle.
    let hulls = told(&place, HULLS, "").unwrap();
    let (area, height) = (1.0 * (1.0 + 2.0) / 2.0 + 0.6 * 2.0 / 2.0, 1.0 + 1.0 / 3.0);
    let size = area * height + 1.4 / 2.0;
    assert_eq!(
        hulls,
        format!("Local shape [3, 5, 42] ['velocity'] ['turned_over'] {} True", (size * 1e9_f64).round() / 1e9)
    );
}

/// Steps of 20 ms at 60 frames per second: two frames show the third step.
fn slow() -> String {
    MIXED
        .replace("frames_per_second = 60", "frames_per_second = 60, step = 0.02")
        .replace("stiffness = 1e4", "stiffness = 10")
        // So soft, it would lie flat.
        .replace("-9.8", "-0.1")
}

#[test]
fn frames_of_the_same_step_are_listed_once() {
    let place = Place::new();
    place.write("slow.toml", &slow());
    place.run("simulate slow.toml --write vtu -o out").good();
    let list = place.read("out/Local shape.pvd");
    let times: Vec<_> =
        list.split("timestep=\"").skip(1).map(|rest| rest.split('"').next().unwrap().parse::<f64>().unwrap()).collect();
    assert_eq!(times, [0, 1, 2, 3, 4, 5].map(|step| f64::from(step) * 0.02));
    assert!(list.contains("body_00003.vtu") && !list.contains("body_00004.vtu"), "{list}");
    assert_eq!(place.names("out/Local shape").len(), 7);
    told(&place, &slow(), "");
}

#[test]
fn vtk_reads_each_body_as_a_part() {
    let place = Place::new();
    let Some(told_of_all) = told(&place, &crate::cli::bodies::of_their_own(), " --frames 0-6x2") else { return };
    let all: Vec<_> = told_of_all.lines().collect();
    assert_eq!(all.len(), 3, "{told_of_all}");
    assert!(all[0].starts_with("all [5, 9] ['velocity'] ['turned_over']"), "{told_of_all}");
    assert!(all[1].starts_with("coarse [9] ") && all[2].starts_with("fine [5, 9] "), "{told_of_all}");
    assert_eq!(place.names("out/all").len(), 2 * 4);
}

#[test]
fn files_are_listed_and_frames_are_those_asked_for() {
    let place = Place::with_small();
    place.run("simulate small.toml --write vtu --frames 1,4 --only Mass-spring -o out").good();
    assert_eq!(place.names("out"), ["Mass-spring", "Mass-spring.pvd", "diagnostics.csv", "run.json"]);
    assert_eq!(place.names("out/Mass-spring"), ["body_00001.vtu", "body_00004.vtu"]);
    let files = &place.json("out/run.json")["files"];
    assert_eq!(*files, serde_json::json!(["diagnostics.csv", "Mass-spring.pvd", "Mass-spring/*.vtu"]));
    place.run("simulate small.toml --write stl").bad(2, &["'stl'", "--write", "vtu"]);
    place.run("simulate small.toml --write").bad(2, &["--write", "vtu"]);
    let same = SMALL.replace("\"Mass-spring\"", "\"local shape\"");
    place.write("same.toml", &same);
    let ran = place.run("simulate same.toml --write vtu");
    ran.bad(2, &["--write: in “Two cubes” the runs “Local shape” and “local shape” would have the same files"]);
    place.write("odd.toml", &SMALL.replace("\"Mass-spring\"", "\"..\""));
    place.run("simulate odd.toml --write vtu -o odd/inner").good();
    assert_eq!(place.names("odd"), ["inner"]);
    assert_eq!(
        place.names("odd/inner"),
        ["Local shape", "Local shape.pvd", "__", "__.pvd", "diagnostics.csv", "run.json"]
    );
}

#[test]
fn files_belong_to_their_scene() {
    let place = Place::with_small();
    place.run("simulate small.toml --write vtu").good();
    place.write("output/small/Local shape/notes.vtu", "mine");
    // Another version of the scene, with other frames: no file of the first is left.
    place.write("small.toml", &SMALL.replace("restitution = 0.5", "restitution = 0.6"));
    let ran = place.run("simulate small.toml --write vtu --only Mass-spring --frames 0-2").good();
    assert!(ran.out.starts_with("output/small: replacing the results of another version of small.toml"), "{ran:?}");
    assert_eq!(
        place.names("output/small"),
        ["Local shape", "Mass-spring", "Mass-spring.pvd", "diagnostics.csv", "run.json"]
    );
    assert_eq!(place.names("output/small/Local shape"), ["notes.vtu"]);
    assert_eq!(place.names("output/small/Mass-spring").len(), 3);
    // A file of another program.
    place.write("out/Mass-spring/body_00001.vtu", "<VTKFile/>");
    let ran = place.run("simulate small.toml --write vtu -o out");
    let name = Path::new("Mass-spring").join("body_00001.vtu");
    ran.bad(2, &["out holds", name.to_str().unwrap(), "was not written by localshape"]);
    place.run("simulate small.toml --write vtu -o out --overwrite").good();
    // A file of another scene.
    place.write("other.toml", &SMALL.replace("Two cubes", "Cubes"));
    place.run("simulate other.toml --write vtu -o out").bad(2, &["out holds the results of another scene"]);
    std::fs::remove_file(place.path("out/run.json")).unwrap();
    place.run("simulate other.toml --write vtu -o out").bad(2, &["out holds", "another scene"]);
}

/// An interrupted command has the files of all frames until then, and another one goes on from there.
#[cfg(unix)]
#[test]
fn files_after_an_interruption_are_those_without_one() {
    let place = Place::new();
    place.write("scene.toml", &crate::cli::support::lasting("8"));
    place.run("simulate scene.toml --write vtu --write obj -o whole").good();
    for (signal, sign) in [("TERM", "out/Local shape/body_00003.vtu"), ("KILL", "out/Local shape/body_00020.vtu")] {
        let typed = "simulate scene.toml --write vtu --write obj -o out";
        let running = crate::cli::interrupt::start(&place, typed, sign);
        crate::cli::interrupt::signal(&running, &[signal]);
        running.wait();
        let before = place.names("out/Local shape").len();
        assert!((4..962).contains(&before), "{before}");
        if signal == "TERM" {
            let listed = place.read("out/Local shape.pvd").matches("<DataSet").count();
            assert_eq!(listed, place.json("out/run.json")["frames"]["recorded"].as_u64().unwrap() as usize);
            assert_eq!(2 * listed, before);
            for name in ["Mass-spring/body_00002.vtu", "Mass-spring/frame_00002.obj"] {
                let words = format!("{name}, which is missing, damaged or replaced since; restore it");
                let path = place.path("out").join(name);
                let bytes = std::fs::read(&path).unwrap();
                std::fs::remove_file(&path).unwrap();
                place.run(&format!("{typed} --resume")).bad(2, &[&words]);
                let mut damaged = bytes.clone();
                damaged[bytes.len() / 2] ^= 1;
                std::fs::write(&path, damaged).unwrap();
                place.run(&format!("{typed} --resume")).bad(2, &[&words]);
                std::fs::write(&path, bytes).unwrap();
            }
            place.run("simulate scene.toml -o out --resume").bad(2, &["other frames, runs, states, files or size"]);
        }
        place.run(&format!("{typed} --resume")).good();
        assert!(files_below(&place, "out") == files_below(&place, "whole"), "{signal}");
        std::fs::remove_dir_all(place.path("out")).unwrap();
    }
}

#[cfg(feature = "render")]
#[test]
fn files_beside_pictures_are_those_of_a_simulation() {
    if !crate::cli::render::can_draw() {
        return;
    }
    let place = Place::with_small();
    place.run("simulate small.toml --write vtu --states -o made").good();
    let files = |folder: &str| {
        let mut files = files_below(&place, folder);
        files.retain(|name, _| !name.ends_with(".png") && !name.ends_with(".npz"));
        files
    };
    place.run("render small.toml --write vtu -o drawn").good();
    assert!(files("drawn") == files("made"));
    place.run("render small.toml --write vtu --from-states made/states.npz -o stored").good();
    assert!(files("stored") == files("made"));
    for shard in ["1/2", "2/2"] {
        place.run(&format!("render small.toml --write vtu --shard {shard} -o shards")).good();
    }
    place.run("simulate small.toml -o shards").good();
    assert!(files("shards") == files("made"));
    place.run("render small.toml --frames 1 -o one.png --write vtu").bad(2, &["one.png gets one frame", "--write"]);
}

/// A scene in the plane has points with z = 0.
#[test]
fn planes_have_points_in_space() {
    let place = Place::new();
    place.write(
        "plane.toml",
        &scene(&[1], "[[run]]\nname = \"a\"\nmodel = { kind = \"shape-based\", stiffness = 1e4 }\n"),
    );
    place.run("simulate plane.toml --write vtu --frames 0 -o out").good();
    assert_eq!(place.names("out/a"), [format!("{}_00000.vtu", BODIES[1].0)]);
    let grid = place.read("out/a/cube_00000.vtu");
    assert!(grid.contains("NumberOfPoints=\"9\" NumberOfCells=\"4\""), "{grid}");
}

/// Reads files of the course, and of frames as surfaces, and compares them with `states.npz`.
const OTHERS: &str = r##"
import glob, json, numpy, struct, sys
from pxr import Usd, UsdGeom
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
from vtkmodules.util.numpy_support import vtk_to_numpy

states = numpy.load("out/states.npz")
names = list(states["bodies"]) if "bodies" in states.files else ["body"]

def read_obj(path):
    time, bodies, lists = None, [], []
    for line in open(path):
        words = line.split()
        if words[:2] == ["#", "time"]:
            time = float(words[2])
        elif words[0] == "o":
            bodies.append((" ".join(words[1:]), []))
        elif words[0] == "v":
            bodies[-1][1].append([float(word) for word in words[1:]])
        elif words[0] in "fl":
            lists.append([int(word) - 1 for word in words[1:]])
    return time, bodies, lists

def read_glb(path):
    data = open(path, "rb").read()
    magic, version, length, size, kind = struct.unpack_from("<4sIII4s", data)
    assert (magic, version, length, kind) == (b"glTF", 2, len(data), b"JSON")
    document, binary = json.loads(data[20:20 + size]), data[20 + size + 8:]
    def array(at):
        accessor = document["accessors"][at]
        view = document["bufferViews"][accessor["bufferView"]]
        kind = {5126: "<f4", 5123: "<u2", 5125: "<u4"}[accessor["componentType"]]
        columns = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[accessor["type"]]
        count = accessor["count"]
        start = view["byteOffset"] + accessor["byteOffset"]
        return numpy.frombuffer(binary, kind, count * columns, start).reshape(count, columns)
    return document, array

def points_of_glb(document, array, frame):
    """The points of each mesh in a frame, moved by its skin."""
    animation = document["animations"][0]
    output = lambda channel: array(animation["samplers"][channel["sampler"]]["output"])
    moved = {channel["target"]["node"]: output(channel)[frame].astype(float) for channel in animation["channels"]}
    for node in document["nodes"]:
        if "mesh" not in node:
            continue
        skin = document["skins"][node["skin"]]
        attributes = document["meshes"][node["mesh"]]["primitives"][0]["attributes"]
        at, joints, weights = (array(attributes[key]) for key in ("POSITION", "JOINTS_0", "WEIGHTS_0"))
        back = array(skin["inverseBindMatrices"])[:, 12:15].astype(float)
        place = numpy.array([moved[joint] for joint in skin["joints"]]) + back
        yield node["name"], (weights[:, :, None] * (at[:, None, :].astype(float) + place[joints])).sum(axis=1)

carried = "carried" in sys.argv[1:]
for run in [name.removesuffix(".position") for name in states.files if name.endswith(".position")]:
    own = lambda name: states[f"{run}.{name}"] if f"{run}.{name}" in states.files else states[name]
    times, position, velocity = own("time"), states[f"{run}.position"], states[f"{run}.velocity"]
    bodies = own("body") if "bodies" in states.files else numpy.zeros(len(own("rest")), int)
    shown = [names[at] for at in sorted(set(bodies))]
    expected = lambda frame: [position[frame][bodies == at] for at in sorted(set(bodies))]
    stage = Usd.Stage.Open(f"out/{run}.usda")
    assert UsdGeom.GetStageUpAxis(stage) == "Y" and UsdGeom.GetStageMetersPerUnit(stage) == 1
    rate = stage.GetTimeCodesPerSecond()
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (times[0] * rate, times[-1] * rate)
    meshes = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    curves = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.BasisCurves)]
    assert stage.GetDefaultPrim().GetMetadata("displayName") == run
    # Frames that show the same step are one sample.
    kept = numpy.unique(times)
    faces = 0
    for mesh in map(UsdGeom.Mesh, meshes):
        counts, indices = mesh.GetFaceVertexCountsAttr().Get(), mesh.GetFaceVertexIndicesAttr().Get()
        good, why = UsdGeom.Mesh.ValidateTopology(indices, counts, len(mesh.GetPointsAttr().Get(times[0] * rate)))
        assert good, why
        assert mesh.GetSubdivisionSchemeAttr().Get() == "none" and mesh.GetPointsAttr().GetTimeSamples() == [time * rate for time in kept]
        faces += len(counts)
    document, array = read_glb(f"out/{run}.glb")
    seconds = array(document["animations"][0]["samplers"][0]["input"])[:, 0]
    assert (seconds == kept.astype("f4")).all()
    for frame, time in enumerate(times):
        if meshes and len(meshes) == len(shown) and not carried:
            for mesh, points, at in zip(map(UsdGeom.Mesh, meshes), expected(frame), sorted(set(bodies))):
                found = numpy.array(mesh.GetPointsAttr().Get(time * rate))
                assert (found == points.astype("f4")).all(), (run, frame)
                moving = numpy.array(mesh.GetVelocitiesAttr().Get(time * rate))
                assert (moving == velocity[frame][bodies == at].astype("f4")).all()
                low, high = mesh.GetExtentAttr().Get(time * rate)
                assert (numpy.array(low) == found.min(axis=0)).all() and (numpy.array(high) == found.max(axis=0)).all()
        moment, written, lists = read_obj(sorted(glob.glob(f"out/{glob.escape(run)}/frame_*.obj"))[frame])
        assert moment == time and [name for name, _ in written] == shown, (moment, time, written)
        reference = [numpy.array(points) for _, points in written]
        if not carried:
            assert all((one == other).all() for one, other in zip(reference, expected(frame)))
        else:
            found = numpy.array(UsdGeom.Mesh(meshes[0]).GetPointsAttr().Get(time * rate))
            assert (found == reference[0].astype("f4")).all()
            reader = vtkXMLUnstructuredGridReader()
            reader.SetFileName(f"out/{run}-surface/body_{frame:05}.vtu")
            reader.Update()
            assert (vtk_to_numpy(reader.GetOutput().GetPoints().GetData()) == reference[0]).all()
        skinned = list(points_of_glb(document, array, int(numpy.searchsorted(kept, time))))
        assert [name for name, _ in skinned] == shown
        apart = max(numpy.abs(one - other).max() for (_, one), other in zip(skinned, reference))
        # Eight nodes of a cube are followed by four, which is the same for affine motions, as at the start.
        assert apart < (1e-6 if not carried or frame == 0 else 2e-3), (run, frame, apart)
    print(run, len(shown), faces, len(curves), sum(len(one) == 2 for one in lists), len(lists))
"##;

/// What USD and own readers tell of the files of a scene in `out`, after the validator of glTF has found nothing.
fn others(place: &Place, text: &str, word: &str, options: &str) -> Option<String> {
    let python = viewers()?;
    place.write("scene.toml", text);
    let ran =
        place.run(&format!("simulate scene.toml -o out --states --write usd,gltf --write obj{options} --overwrite"));
    assert_eq!(ran.status, Some(0), "{ran:?}");
    for name in place.names("out").iter().filter(|name| name.ends_with(".glb")) {
        validated(&place.path("out").join(name));
    }
    let script = OTHERS.replace("sys.argv[1:]", &format!("[\"{word}\"]"));
    Some(python(&place.path("."), &script).trim().to_owned())
}

#[test]
fn other_programs_read_the_states_of_all_kinds_of_elements() {
    let place = Place::new();
    let Some(mixed) = others(&place, MIXED, "", "") else { return };
    assert!(mixed.starts_with("Local shape 1 ") && mixed.contains(" 0 0 "), "{mixed}");
    // Six faces of the prism, five more of the pyramid, and a triangle; a bar.
    assert_eq!(others(&place, HULLS, "", "").unwrap(), "Local shape 1 12 1 1 13");
}

#[test]
fn other_programs_read_frames_of_the_same_step_once() {
    let place = Place::new();
    let Some(told) = others(&place, &slow(), "", "") else { return };
    assert!(told.starts_with("Local shape 1 "), "{told}");
}

#[test]
fn other_programs_read_each_of_several_bodies() {
    let place = Place::new();
    let Some(told) = others(&place, &crate::cli::bodies::of_their_own(), "", " --frames 0-4x2,6") else { return };
    let runs: Vec<_> = told.lines().map(|line| line.split(' ').take(2).collect::<Vec<_>>()).collect();
    assert_eq!(runs, [["all", "2"], ["coarse", "1"], ["fine", "1"]], "{told}");
}

/// Other programs show the surface that cubes carry.
#[test]
fn other_programs_read_carried_surfaces() {
    let place = Place::new();
    let corners =
        ["1 0 0", "-1 0 0", "0 1 0", "0 -1 0", "0 0 1", "0 0 -1"].map(|corner| format!("v {corner}\n")).concat();
    let faces =
        ["1 3 5", "3 2 5", "2 4 5", "4 1 5", "3 1 6", "2 3 6", "4 2 6", "1 4 6"].map(|face| format!("f {face}\n"));
    place.write("octahedron.obj", &(corners + &faces.concat()));
    let body = "mesh = \"octahedron.obj\"\nscale = 0.1\nmass_total = 1\nfill = { with = \"cubes\", cells = 4 }";
    let text =
        MIXED.replace("lattice = { cells = [3, 3, 3], side = 0.1, elements = \"mixed\", irregular = 0.2 }", body);
    let Some(told) = others(&place, &text.replace("colour.by = \"elastic-energy\"\n", ""), "carried", " --write vtu")
    else {
        return;
    };
    // Triangles larger than elements are divided.
    assert!(told.starts_with("Local shape 1 ") && told.contains(" 0 0 "), "{told}");
    assert_eq!(place.read("out/Local shape-surface.pvd").matches("<DataSet").count(), 7);
}

#[test]
fn a_skin_has_no_more_nodes_than_its_format_has_numbers_for() {
    let place = Place::new();
    place.write("large.toml", &SMALL.replace("cells = [2, 1, 1]", "cells = [400, 40, 3]"));
    let ran = place.run("simulate large.toml --write gltf --frames 0");
    ran.bad(2, &["--write: in “Two cubes” \"body\" has 65 764 nodes, and a skin of glTF at most 65 535; write usd"]);
    assert!(!place.path("output").exists());
    #[cfg(feature = "render")]
    place
        .run("render large.toml --write usd --shard 1/2")
        .bad(2, &["--write usd and gltf: a shard has no whole course"]);
}

/// Files of the course hold the frames until an interruption, and all after the next command.
#[cfg(unix)]
#[test]
fn courses_after_an_interruption_are_those_without_one() {
    let place = Place::new();
    place.write("scene.toml", &crate::cli::support::lasting("20"));
    place.run("simulate scene.toml --write usd,gltf,obj -o whole").good();
    let typed = "simulate scene.toml --write usd,gltf,obj -o out";
    let running = crate::cli::interrupt::start(&place, typed, "out/Local shape/frame_00003.obj");
    crate::cli::interrupt::signal(&running, &["TERM"]);
    running.wait();
    let recorded = place.json("out/run.json")["frames"]["recorded"].as_u64().unwrap();
    let stage = place.read("out/Mass-spring.usda");
    let samples = stage.split("points.timeSamples").nth(1).unwrap().split('}').next().unwrap().matches(": [").count();
    assert_eq!(samples as u64, recorded);
    assert!(place.path("out/Mass-spring.glb").exists() && !place.path("out/states.npz").exists());
    place.run(&format!("{typed} --resume")).good();
    assert!(files_below(&place, "out") == files_below(&place, "whole"));
}

/// A scene whose runs show these files in place of their models.
fn played(scene: &str, file: &str) -> String {
    let line = |line: &str| if line.starts_with("model = ") { format!("states = \"{file}\"") } else { line.to_owned() };
    scene.lines().map(|one| line(one) + "\n").collect()
}

/// The states of frames in `diagnostics.csv`: kinetic energy, momenta and shape.
fn told_states(place: &Place, folder: &str) -> Vec<String> {
    let table = place.read(&format!("{folder}/diagnostics.csv"));
    let state = |line: &str| {
        let cells: Vec<_> = line.split(',').collect();
        [&cells[..5], &cells[6..13], &cells[14..17]].concat().join(",")
    };
    table.lines().map(state).collect()
}

#[test]
fn our_own_files_played_back_have_the_states_of_the_run() {
    let place = Place::new();
    let bodies = scene(&[0, 1, 2], "[[run]]\nname = \"soft\"\nmodel = { kind = \"shape-based\", stiffness = 1e4 }\n");
    for (name, text, run) in [
        ("mixed", MIXED, "Local shape"),
        ("bodies", &bodies, "soft"),
        ("hulls", HULLS, "Local shape"),
        // Two frames show the same step.
        ("slow", &slow(), "Local shape"),
    ] {
        let text = &text.replace("colour.by = \"elastic-energy\"\n", "");
        place.write(&format!("{name}.toml"), text);
        place.run(&format!("simulate {name}.toml --write vtu,obj -o {name}")).good();
        place.write("played.toml", &played(text, &format!("{name}/{run}.pvd")));
        place.run("simulate played.toml -o played --write vtu --overwrite").good();
        assert_eq!(told_states(&place, "played"), told_states(&place, name));
        // The grids that are written again have the same points and velocities.
        let grid = |folder: &str| {
            let mut files = files_below(&place, folder);
            files.retain(|file, _| file.ends_with(".vtu"));
            let part = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap().split_once("<VTKFile").unwrap().1.to_owned();
            files.into_values().map(part).collect::<Vec<_>>()
        };
        assert!(grid("played") == grid(name), "{name}");
        // Surfaces have no velocities.
        place.write("surfaces.toml", &played(text, &format!("{name}/{run}/*.obj")));
        place.run("simulate surfaces.toml -o surfaces --write obj --overwrite").good();
        let surfaces = |folder: &str| {
            let mut files = files_below(&place, folder);
            files.retain(|file, _| file.ends_with(".obj"));
            let part = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap().split_once("# time").unwrap().1.to_owned();
            files.into_values().map(part).collect::<Vec<_>>()
        };
        assert!(surfaces("surfaces") == surfaces(name), "{name}");
    }
}

/// Writes a column of two hexahedra and two wedges, one of them turned over, beside a line and a point of none, at three moments by
/// VTK.
const COLUMN: &str = r#"
import numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter
from vtkmodules.util.numpy_support import numpy_to_vtk

layer = [[0, 0], [1, 0], [1, 1], [0, 1]]
points = numpy.array([[9, 9, 9]] + [[x, y, z] for z in range(4) for x, y in layer], float)
at = lambda z, corners: [1 + 4 * z + corner for corner in corners]
cells = [(12, at(0, range(4)) + at(1, range(4))), (12, at(1, range(4)) + at(2, range(4))), (3, [1, 5]),
         (13, at(2, [0, 1, 2]) + at(3, [0, 1, 2])), (13, at(3, [0, 2, 3]) + at(2, [0, 2, 3]))]
sets = ""
for frame, time in enumerate([0, 0.05, 0.1]):
    moved = points + [0, 0, 4 * time] + 0.1 * time * points[:, [1, 2, 0]] ** 2
    grid, listed = vtkUnstructuredGrid(), vtkPoints()
    listed.SetData(numpy_to_vtk(moved, deep=True))
    grid.SetPoints(listed)
    for kind, corners in cells:
        grid.InsertNextCell(kind, len(corners), corners)
    velocity = numpy_to_vtk(moved[:, [2, 0, 1]].copy(), deep=True)
    velocity.SetName("velocity")
    grid.GetPointData().AddArray(velocity)
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(f"column_{frame}.vtu")
    writer.SetInputData(grid)
    assert writer.Write()
    numpy.save(f"column_{frame}.npy", moved[1:])
    sets += f"<DataSet timestep='{time}' part='0' file='column_{frame}.vtu'/>"
open("column.pvd", "w").write(f"<VTKFile type='Collection'><Collection>{sets}</Collection></VTKFile>")
"#;

/// Compares the states of the run with the points of the grids.
const PLAYED: &str = r#"
import numpy
states = numpy.load("out/states.npz")
for frame in range(3):
    moved = numpy.load(f"column_{frame}.npy")
    position = states["Played.position"] if "Played.position" in states.files else states["position"]
    velocity = states["Played.velocity"] if "Played.velocity" in states.files else states["velocity"]
    assert position[frame].tobytes() == moved.tobytes(), frame
    assert velocity[frame].tobytes() == moved[:, [2, 0, 1]].tobytes(), frame
print(len(states["elements"] if "elements" in states.files else states["Played.elements"]))
"#;

/// Grids of VTK are played back as they are, whether they are of a body of the scene or one of its own.
#[test]
fn grids_of_vtk_played_back_have_its_points() {
    let place = Place::new();
    let Some(python) = viewers() else { return };
    python(&place.path("."), COLUMN);
    let time = "time = { duration = 0.1, frames_per_second = 20 }\n";
    for body in ["mesh = \"column_0.vtu\"\nup = \"y\"\ndensity = 1", "lattice = { cells = [2, 1, 1], side = 0.1 }"] {
        place.write(
            "scene.toml",
            &format!("{time}[body]\n{body}\n[[run]]\nname = \"Played\"\nstates = \"column.pvd\"\n"),
        );
        place.run("simulate scene.toml --states --write vtu -o out --overwrite").good();
        assert_eq!(python(&place.path("."), PLAYED).trim(), "4", "{body}");
        // As VTK sees it, no element is turned over.
        let told = place.read("out/diagnostics.csv");
        assert_eq!(told.lines().count(), 4, "{told}");
    }
}

/// Pictures of a recording are those of the run.
#[cfg(feature = "render")]
#[test]
fn our_own_files_played_back_give_the_pictures_of_the_run() {
    let Some(place) = crate::cli::render::place_to_draw() else { return };
    let text = MIXED
        .replace("colour.by = \"elastic-energy\"", "camera.distance = 2\nlabels = [\"name\", \"clock\", \"number\"]");
    place.write("mixed.toml", &text);
    place.run("render mixed.toml --write vtu -o mixed").good();
    place.write("played.toml", &played(&text, "mixed/Local shape.pvd"));
    place.run("render played.toml -o played").good();
    let pictures = |folder: &str| {
        let mut files = files_below(&place, folder);
        files.retain(|file, _| file.ends_with(".png"));
        files
            .into_values()
            .map(|bytes| localshape::internals::Pixels::from_bytes(&bytes).unwrap().bytes)
            .collect::<Vec<_>>()
    };
    let (own, again) = (pictures("mixed"), pictures("played"));
    assert_eq!(own.len(), 7);
    assert!(own == again);
}

/// A run of surfaces alone has a body of its own.
#[test]
fn surfaces_of_other_programs_are_bodies_of_their_own() {
    let place = Place::with_small();
    for frame in 1..=5 {
        let height = 0.1 * f64::from(frame);
        let corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
        let corner = |[x, y, z]: [i32; 3]| format!("v {} {} {}\n", x, f64::from(y) + height, z);
        let faces = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
        place.write(&format!("thrown/tetra_{frame:04}.obj"), &(corners.map(corner).concat() + faces));
    }
    let run = "[[run]]\nname = \"Thrown\"\nstates = \"thrown/tetra_*.obj\"\n";
    place.write("scene.toml", &SMALL.replace("[[obstacle]]", &format!("{run}[[obstacle]]")));
    let no_masses = "has no masses: energies and momenta count each of its 4 nodes with 1 kg";
    let played = place.run("simulate scene.toml --only Thrown --write vtu -o out");
    assert!(played.status == Some(0) && played.err.contains(no_masses), "{played:?}");
    let run = &place.json("out/run.json")["runs"][0];
    assert_eq!(run["status"], "ended");
    // Five moments at 60 frames per second.
    assert!((run["time"].as_f64().unwrap() - 4.0 / 60.0).abs() < 1e-12, "{run}");
    let told = place.run("check scene.toml");
    assert!(told.out.contains("tetra_*.obj, recorded, 5 states") && told.err.contains(no_masses), "{told:?}");
}

#[test]
fn broken_sequences_are_told() {
    let place = Place::with_small();
    place.run("simulate small.toml --write vtu,obj --only Mass-spring -o out").good();
    let refused = |file: &str, words: &[&str]| {
        place.write("played.toml", &SMALL.replace("model = { kind = \"mass-spring\", stiffness = 1e4, damping_ratio = 0.1, springs = \"edges+one-diagonal\" }", &format!("states = \"{file}\"")));
        place.run("simulate played.toml -o played").bad(2, words);
    };
    let list = place.read("out/Mass-spring.pvd");
    refused("out/Mass.pvd", &["`out/Mass.pvd` is not there", "Mass-spring.pvd"]);
    place.write("out/broken.pvd", &list.replace("body_00003", "body_00013"));
    refused("out/broken.pvd", &["`out/broken.pvd: body_00013.vtu` is not there"]);
    place.write("out/broken.pvd", &list.replace("Mass-spring/body_00003.vtu", "../small.toml"));
    refused("out/broken.pvd", &["`out/broken.pvd: small.toml` is neither a grid"]);
    place.write("out/broken.pvd", &list.replace("Collection", "Grid"));
    refused("out/broken.pvd", &["is a VTK file of the type `Grid`; expected `Collection`"]);
    place.write("out/broken.pvd", "<VTKFile type=\"Collection\"></VTKFile>");
    refused("out/broken.pvd", &["lists no file"]);
    let grid = place.read("out/Mass-spring/body_00002.vtu");
    place.write("out/Mass-spring/body_00002.vtu", &grid[..grid.len() / 2]);
    refused("out/Mass-spring.pvd", &["`out/Mass-spring.pvd: body_00002.vtu` "]);
    place.write("three.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    std::fs::copy(place.path("three.obj"), place.path("out/Mass-spring/frame_00003.obj")).unwrap();
    refused("out/Mass-spring/*.obj", &["frame_00003.obj` has 3 points, and frame_00002.obj has 12; expected the same"]);
    std::fs::rename(place.path("out/Mass-spring/frame_00003.obj"), place.path("out/Mass-spring/other_00003.obj"))
        .unwrap();
    refused("out/Mass-spring/*.obj", &["has several sequences, frame_… and other_…", "write more of the name"]);
    refused("out/Mass-spring/*.stl", &["names no file"]);
    refused("*.stl", &["names no file (looked in .)"]);
    refused("none/*.obj", &["cannot be read"]);
    refused("*/frame_*.obj", &["does not name numbered files"]);
}
