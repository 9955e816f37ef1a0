//! Sound files of every kind are read. Damaged ones are refused or read, and never end the program. `fuzz/` looks for more.

use localshape::internals::untrusted::{GRID, LIST, PIECES, READERS, SCENE, SERIES, checkpoint_of_scene};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Random numbers, the same in every run.
struct Noise(u64);

impl Noise {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % end.max(1)
    }
}

/// Bytes that damages insert: ends of ranges, and bytes with a meaning in some format.
const HOSTILE: [&[u8]; 18] = [
    b"0",
    b"-1",
    b"1e308",
    b"-1e30",
    b"nan",
    b"inf",
    b"9223372036854775807",
    b"18446744073709551615",
    b"''",
    b"[]",
    b"{}",
    b"[[]]",
    b"\0",
    b"\xff\xff\xff\xff",
    b"\xff\xff\xff\xff\xff\xff\xff\x7f",
    b"\xc3",
    b"\"",
    b"\n",
];

/// A file with some bytes changed, inserted, removed or repeated.
fn damaged(seed: &[u8], noise: &mut Noise) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..=noise.below(4) {
        let at = noise.below(bytes.len());
        let end = at + noise.below((bytes.len() - at).min(24) + 1);
        match noise.below(6) {
            0 => bytes.truncate(at),
            1 => drop(bytes.drain(at..end)),
            2 => drop(bytes.splice(at..end, HOSTILE[noise.below(HOSTILE.len())].iter().copied())),
            3 => drop(bytes.splice(at..at, seed[at.min(seed.len())..end.min(seed.len())].to_vec())),
            4 => {
                // A number in a text: its digits are replaced as a whole.
                let is_digit = |byte: &u8| byte.is_ascii_digit();
                if let Some(first) = bytes[at..].iter().position(is_digit).map(|first| at + first) {
                    let last = first + bytes[first..].iter().take_while(|byte| is_digit(byte)).count();
                    bytes.splice(first..last, HOSTILE[noise.below(8)].iter().copied());
                }
            }
            _ => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << noise.below(8);
                }
            }
        }
    }
    bytes
}

/// Sound files of a reader, which `fuzz/seed` collects, too.
fn seeds(name: &str) -> Vec<Vec<u8>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let files = |folder: &str, ending: &str| -> Vec<Vec<u8>> {
        let entries = fs::read_dir(root.join(folder))
            .expect("a folder of the project")
            .map(|entry| entry.expect("an entry").path());
        let mut paths: Vec<_> = entries.filter(|path| path.extension().is_some_and(|found| found == ending)).collect();
        paths.sort();
        paths.iter().map(|path| fs::read(path).expect("a file")).collect()
    };
    match name {
        "scene" => {
            let mut texts = [files("scenes", "toml"), files("scenes/elements", "toml")].concat();
            // Meshes have readers of their own, and are larger than the limits here.
            texts.retain(|text| !String::from_utf8_lossy(text).contains("\nmesh = "));
            with_whole_paths(texts)
        }
        "setting" => [
            "run[0].model.stiffness=2e4",
            "run[\"springs\"].step=T/60",
            "obstacle[0].restitution = 0.5",
            "body.spin={ axis = [0, 1, 0], rate = 3 }",
            "view.labels=[\"letters\"]",
        ]
        .map(|text| text.as_bytes().to_vec())
        .into(),
        "figure" => with_whole_paths(files("figures", "toml")),
        "body" => files("tests/cli", "npz"),
        "obj" | "stl" | "ply" | "off" | "vtk" => files("mesh/tests/files", name),
        "gltf" => [files("mesh/tests/files", "gltf"), files("mesh/tests/files", "glb")].concat(),
        "gmsh" => files("mesh/tests/files", "msh"),
        "medit" => files("mesh/tests/files", "mesh"),
        "abaqus" => files("mesh/tests/files", "inp"),
        "vtu" => [files("mesh/tests/files", "vtu"), files("mesh/tests/files", "vtp")].concat(),
        "font" => files("assets/fonts", "otf"),
        "states" => vec![simulated("states.npz")],
        "recording" => {
            let layouts = files("tests/scene/layouts", "npz");
            // In Fortran order, big-endian and compressed.
            [1, 4, 8].into_iter().map(|at| layouts[at].clone()).chain([simulated("states.npz")]).collect()
        }
        "list" => vec![LIST.into()],
        "series" => vec![SERIES.into()],
        "pieces" => vec![PIECES.into()],
        "moment" => vec![GRID.into()],
        "summary" => vec![simulated("run.json")],
        "checkpoint" => vec![checkpoint_of_scene()],
        "state" => vec![localshape::sim::State::at_rest(vec![glam::DVec3::ONE; 3]).to_bytes()],
        "picture" => files("tests/golden/scenes/wheel", "png"),
        "golden" => files("tests/golden/scenes/wheel", "toml"),
        _ => panic!("{name} has no seeds"),
    }
}

/// Scenes and figures with whole paths of bodies and scenes, which can be read from any folder.
fn with_whole_paths(texts: Vec<Vec<u8>>) -> Vec<Vec<u8>> {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").display().to_string();
    let whole = |text: Vec<u8>| {
        let text = String::from_utf8(text).expect("UTF-8").replace("../scenes", &scenes);
        let beside = |text: String, key: &str| text.replace(&format!("{key} = \""), &format!("{key} = \"{scenes}/"));
        ["file", "states"].into_iter().fold(text, beside).into_bytes()
    };
    texts.into_iter().map(whole).collect()
}

/// A file with results of the scene of these tests.
fn simulated(name: &str) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("scene.toml"), SCENE).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_localshape"));
    let made = command.current_dir(folder.path()).args("simulate scene.toml --states -q -o out".split(' ')).status();
    assert!(made.expect("the program").success());
    fs::read(folder.path().join("out").join(name)).expect("results")
}

#[test]
fn no_damage_ends_the_program() {
    for reader in &READERS {
        let (seeds, mut noise) = (seeds(reader.name), Noise(7));
        assert!(!seeds.is_empty(), "{}", reader.name);
        for (at, seed) in seeds.iter().enumerate() {
            assert!((reader.read)(seed), "{}: the sound file {at} is refused", reader.name);
        }
        if let Some(corpus) = std::env::var_os("LOCALSHAPE_SEEDS") {
            let path = |at: usize| Path::new(&corpus).join(reader.name).join(format!("seed-{at}"));
            seeds.iter().enumerate().for_each(|(at, seed)| fs::write(path(at), seed).expect("a folder for the corpus"));
        }
        for round in 0..200 {
            let bytes = damaged(&seeds[round % seeds.len()], &mut noise);
            let read = || (reader.read)(&bytes);
            if std::panic::catch_unwind(read).is_err() {
                panic!("{}, round {round}: {:?}", reader.name, String::from_utf8_lossy(&bytes));
            }
        }
    }
}

/// Nothing is allocated for numbers that the file does not have.
#[cfg(feature = "render")]
#[test]
fn states_that_unfold_to_more_than_their_file_are_refused() {
    use std::io::Write;
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("scene.toml"), SCENE).expect("a file");
    let length = 1 << 24;
    let text = format!("{{'descr': '|u1', 'fortran_order': False, 'shape': ({length},), }}\n");
    let mut archive = zip::ZipWriter::new(fs::File::create(folder.path().join("packed.npz")).expect("a file"));
    archive.start_file("localshape.npy", zip::write::SimpleFileOptions::default()).expect("a file");
    let head = [b"\x93NUMPY\x01\x00", &(text.len() as u16).to_le_bytes()[..], text.as_bytes()].concat();
    archive.write_all(&[head, vec![0; length]].concat()).expect("a file");
    archive.finish().expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_localshape"));
    let made = command.current_dir(folder.path()).args("render scene.toml --from-states packed.npz -o out".split(' '));
    let made = made.output().expect("the program");
    let message = String::from_utf8_lossy(&made.stderr).into_owned();
    assert_eq!(made.status.code(), Some(2), "{message}");
    assert!(message.contains("packed.npz `localshape` is packed, or longer than the file"), "{message}");
}
