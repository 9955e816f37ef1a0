//! Reading any file gives a scene or mistakes, never a panic.

use super::shipped;
use localshape::scene::{Limits, Scene, SceneError};
use std::collections::BTreeSet;

/// A small generator of numbers (xorshift), the same on every machine.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % bound as u64) as usize
    }
}

/// The limits are small enough for a mutated count not to make a case slow.
const SMALL: Limits = Limits { nodes: 5000, corners: 50_000, springs: 100_000, file: 1 << 20, recorded: 50_000 };

const EXPLICIT: &str = include_str!("explicit.toml");

/// Generated bodies.
const RULES: [&str; 6] = [
    "lattice = { cells = [3, 2, 2], side = [0.1, 0.2, 0.3], elements = 'mixed', irregular = 0.4, seed = 7 }",
    "lattice = { cells = [3, 2], side = 0.1, elements = 'mixed', irregular = 0.4, seed = 7 }",
    "lattice = { cells = [2, 2, 2], side = 0.1, elements = 'tetrahedra', irregular = 0.4, seed = 7 }",
    "disc = { radius = 0.3, rings = 3, sectors = 12 }",
    "bars = { count = 5, length = 0.1, direction = [1, 0] }",
    "nodes = [[0,0,0],[1,0,0],[0,1,0],[0,0,1],[1,1,0],[1,0,1],[0,1,1]]\nelements = [[0,1,2,3,4,5,6]]\nfaces = [[0,1,4,2]]",
];

/// Scenes of all kinds.
fn scenes() -> Vec<String> {
    let made = RULES.map(|rule| {
        let run = "name = 'a'\nmodel = { kind = 'mass-spring', stiffness = 1e3 }";
        format!("time = {{ duration = 1 }}\n[body]\n{rule}\nlowest = 0\n[[run]]\n{run}\n")
    });
    [shipped("fig4b.toml"), shipped("three-bodies.toml"), shipped("meshes.toml"), EXPLICIT.to_owned()]
        .into_iter()
        .chain(made)
        .collect()
}

/// Reads a text, and checks that reported positions are in it. Returns true if it is a scene.
fn read(text: &str) -> bool {
    match Scene::parse(text, "mutated.toml", &SMALL) {
        Ok(scene) => {
            let mut coordinates = scene.runs[0].initial.position.iter().chain(&scene.runs[0].initial.velocity);
            assert!(coordinates.all(|vector| vector.is_finite()) && scene.bodies[0].body.len() <= 5000);
            assert!(scene.runs.iter().all(|run| run.step > 0.0 && run.step.is_finite()));
            assert!(!scene.summary().to_string().is_empty());
            true
        }
        Err(error) => {
            let lines = text.split('\n').count();
            assert!(error.mistakes().iter().all(|mistake| (1..=lines).contains(&mistake.line) && mistake.column > 0));
            assert!(!error.to_string().is_empty());
            false
        }
    }
}

#[test]
fn mutated_bytes() {
    let mut numbers = Numbers(0x2545_f491_4f6c_dd1d);
    for scene in scenes() {
        assert!(read(&scene), "{scene}");
        for _ in 0..600 {
            let mut bytes = scene.clone().into_bytes();
            for _ in 0..=numbers.below(3) {
                let at = numbers.below(bytes.len());
                match numbers.below(4) {
                    0 => bytes[at] = b"0123456789.-+e[]{}=\"'#,\n aT_"[numbers.below(28)],
                    1 => bytes[at] ^= 1 << numbers.below(8),
                    2 if bytes.len() > 1 => drop(bytes.remove(at)),
                    _ => bytes.truncate(at.max(1)),
                }
            }
            read(&String::from_utf8_lossy(&bytes));
        }
    }
}

#[test]
fn swapped_values() {
    let values = [
        "0",
        "-1",
        "1e300",
        "-1e-320",
        "1e30",
        "1e-30",
        "nan",
        "inf",
        "99999999999999999999",
        "[]",
        "[[]]",
        "[1, 2]",
        "[1, 2, 3]",
        "{}",
        "''",
        "'T/50'",
        "'T/1e308'",
        "'1e-308 T'",
        "true",
        "1979-05-27",
        "[{}]",
        "[[0, 1], [1, 2]]",
        "4294967295",
        "\"\\u0000\"",
    ];
    for scene in scenes() {
        assert!(read(&scene), "{scene}");
        for (at, _) in scene.match_indices(" = ") {
            let (before, after) = scene.split_at(at + 3);
            // Up to the end of the value, of its table or of its line, in this order.
            let ends =
                [after.find([',', '}', '\n', '#']), after.find([']', '\n']).map(|end| end + 1), after.find('\n')];
            let ends: BTreeSet<_> = ends.into_iter().flatten().collect();
            for (number, end) in ends.into_iter().enumerate() {
                // All values up to the first end; up to the others they take turns.
                let (first, every) = if number == 0 { (0, 1) } else { (at % 4, 4) };
                for value in values.iter().skip(first).step_by(every) {
                    read(&format!("{before}{value}{}", after.get(end..).unwrap_or_default()));
                }
            }
        }
    }
}

#[test]
fn any_bytes_in_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bytes.toml");
    let mut numbers = Numbers(88_172_645_463_325_252);
    for length in 0..200 {
        let bytes: Vec<u8> = (0..length).map(|_| numbers.below(256) as u8).collect();
        std::fs::write(&path, bytes).unwrap();
        let error = Scene::load(&path, &SMALL).unwrap_err();
        assert!(!matches!(error, SceneError::Missing { .. } | SceneError::Unreadable { .. }), "{error}");
    }
}
