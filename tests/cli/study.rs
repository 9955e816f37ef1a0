//! `study stability` on a scene: its files, and what it refuses.

use crate::support::{Place, SMALL};

#[test]
fn maps_the_stability_of_a_scene() {
    #[cfg(feature = "render")]
    if !crate::render::can_draw() {
        return;
    }
    let place = Place::with_small();
    let command = "study stability small.toml -o maps";
    let ran = place.run(command).good();
    assert!(ran.out.starts_with("<!-- localshape study stability small.toml -->\n"), "{}", ran.out);
    let read = || std::fs::read_to_string(place.path("maps/stability.csv")).expect("the table");
    let table = read();
    // Two runs, thirteen stiffnesses and twelve steps.
    assert_eq!(table.lines().count(), 1 + 2 * 13 * 12);
    let diverged = table.lines().filter(|line| line.contains(",diverged,"));
    let shares: Vec<f64> =
        diverged.map(|line| line.split(',').nth(6).expect("a share").parse().expect("a number")).collect();
    assert!(!shares.is_empty() && shares.iter().all(|&share| share > 1.0), "{shares:?}");
    let mut names = vec!["stability.csv", "stability.md"];
    names.extend(cfg!(feature = "render").then_some(["stability.png", "stability.svg"]).into_iter().flatten());
    assert_eq!(place.names("maps"), names);
    assert_eq!(place.run(&format!("{command} --threads 1")).good().status, Some(0));
    assert_eq!(read(), table, "for any number of threads");
    place.run(&format!("{command} --full")).bad(2, &["maps", "study stability small.toml"]);
    place.write("still.toml", &SMALL.replace("duration = 0.1", "duration = 0"));
    place.run("study stability still.toml").bad(2, &["`time.duration` is 0"]);
    let adaptive = SMALL.replace("[[run]]\n", "[[run]]\nintegrator = \"dormand-prince\"\n");
    place.write("adaptive.toml", &adaptive);
    place.run("study stability adaptive.toml").bad(2, &["find their own steps: there is nothing to map"]);
    // What another command has made until it was interrupted is not lost.
    let cells = "localshape study stability other.toml 0.1.0 ab\n";
    place.write("begun/stability.unfinished", cells);
    place
        .run("study stability small.toml -o begun")
        .bad(2, &["`localshape study stability other.toml`", "--overwrite"]);
    assert_eq!(place.read("begun/stability.unfinished"), cells);
}
