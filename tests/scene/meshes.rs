//! Bodies of mesh files.

use localshape::scene::{Limits, Scene, SceneError};

const SCENE: &str = "\
[time]
duration = 1
[body]
mesh = 'body.ply'
density = 1000.0
[[run]]
name = 'Local shape'
model = { kind = 'shape-based', stiffness = 1e4 }
";

/// Reads a scene with files beside it.
fn load(scene: &str, files: &[(&str, &[u8])]) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    files.iter().for_each(|(name, bytes)| put(name, bytes));
    put("scene.toml", scene.as_bytes());
    Scene::load(&folder.path().join("scene.toml"), &Limits::default())
}

/// Expects a mistake with these parts in its message and help.
fn wrong(scene: &str, files: &[(&str, &[u8])], parts: &[&str]) {
    let error = load(scene, files).unwrap_err();
    let has_parts = |text: &str| parts.iter().all(|part| text.contains(part));
    let texts =
        error.mistakes().iter().map(|one| format!("{} {}", one.message, one.help.as_deref().unwrap_or_default()));
    assert!(texts.into_iter().any(|text| has_parts(&text)), "{error}\nexpected {parts:?}");
}

#[test]
fn files_that_are_no_meshes_are_named() {
    wrong(SCENE, &[("bodi.ply", b"")], &["`body.ply` is not there", "did you mean \"bodi.ply\"?"]);
    let named = |name: &str| SCENE.replace("body.ply", name);
    wrong(&named("body.npz"), &[("body.npz", b"PK")], &["`body.npz` is a NumPy archive", "`file` in place of `mesh`"]);
    wrong(&named("body.fbx"), &[("body.fbx", b"")], &["`body.fbx` is a .fbx file", ".obj, .stl", "Blender"]);
    wrong(&named("body.stll"), &[("body.stll", b"")], &["is a .stll file", "did you mean .stl?"]);
    wrong(&named("body"), &[("body", b"")], &["`body` has no ending; expected a mesh: .obj, .stl, .ply"]);
    wrong(&named("."), &[], &["`.` is a folder; expected a mesh"]);
}

#[test]
fn keys_of_meshes_belong_to_meshes() {
    let lattice = SCENE.replace("mesh = 'body.ply'", "lattice = { cells = [1, 1, 1], side = 1 }\nKEY");
    for (key, message) in [
        ("fill = {}", "`body.fill` needs `mesh`"),
        ("scale = 0.001", "`body.scale` needs `mesh`"),
        ("up = 'z'", "`body.up` needs `mesh`"),
        ("mesh = 'body.ply'", "has both `lattice` and `mesh`"),
    ] {
        wrong(&lattice.replace("KEY", key), &[], &[message]);
    }
    let fill = |fill: &str| SCENE.replace("density", &format!("fill = {{ {fill} }}\ndensity"));
    wrong(&fill("side = 0.1, cells = 3"), &[], &["`body.fill` has both `side` and `cells`"]);
    wrong(&fill("with = 'cube'"), &[], &["`body.fill.with` is \"cube\"", "did you mean \"cubes\"?"]);
    wrong(&fill("side = 0"), &[], &["`body.fill.side` is 0; expected a number greater than 0"]);
    wrong(&SCENE.replace("density", "scale = 'mm'\ndensity"), &[], &["`body.scale` is the string \"mm\"", "0.001"]);
}
