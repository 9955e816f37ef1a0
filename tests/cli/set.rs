//! `--set`: another value of a key for one command.

use crate::cli::support::{Place, SMALL, run};

/// Runs the program with words that may have spaces.
fn simulate(place: &Place, words: &[&str]) -> crate::cli::support::Ran {
    run(&mut place.command([&["simulate", "small.toml"], words].concat()))
}

/// The command gives the results of an edited file, and records the settings.
#[test]
fn a_set_value_is_that_of_an_edited_file() {
    let place = Place::with_small();
    let own_step = "one-diagonal\" }\nstep = \"T/60\"\n";
    for (folder, words, edited) in [
        (
            "number",
            &["--set", "run[0].model.stiffness=2e4"][..],
            SMALL.replacen("stiffness = 1e4", "stiffness = 2e4", 1),
        ),
        ("word", &["--set", "run[1].step=T/60"], SMALL.replace("one-diagonal\" }\n", own_step)),
        ("by name", &["--set", "run[\"Mass-spring\"].step=\"T/60\""], SMALL.replace("one-diagonal\" }\n", own_step)),
        ("by a bare name", &["--set", "run[Local shape].model.stiffness=2e4"], SMALL.replacen("1e4", "2e4", 1)),
        (
            "twice",
            &[
                "--set",
                "body.lattice.cells = [1, 1, 1]",
                "--set",
                "body.rotation.angle=3",
                "--set",
                "body.rotation.axis=[0, 1, 0]",
            ],
            SMALL
                .replace("[2, 1, 1]", "[1, 1, 1]")
                .replace("[body]", "[body]\nrotation = { axis = [0, 1, 0], angle = 3 }"),
        ),
        ("last", &["--set", "time.duration=9", "--set", "time.duration=0.05"], SMALL.replace("0.1\n", "0.05\n")),
    ] {
        place.write("small.toml", SMALL);
        simulate(&place, &[words, &["--states", "-o", folder]].concat()).good();
        place.write("small.toml", &edited);
        place.run("simulate small.toml --states -o edited --overwrite").good();
        let bytes = |folder: &str, name: &str| std::fs::read(place.path(folder).join(name)).unwrap();
        for name in ["diagnostics.csv", "states.npz"] {
            assert!(bytes(folder, name) == bytes("edited", name), "{folder}: {name}");
        }
        let [made, expected] = [folder, "edited"].map(|folder| place.json(&format!("{folder}/run.json")));
        assert_eq!(made["scene"]["digest"], expected["scene"]["digest"]);
        let told: Vec<_> = words.iter().filter(|word| **word != "--set").collect();
        assert_eq!((&made["set"], &expected["set"]), (&serde_json::json!(told), &serde_json::Value::Null));
    }
}

/// Each mistake is reported like one in the file, with the option as its place.
#[test]
fn mistakes_have_the_option_as_their_place() {
    let place = Place::with_small();
    for (setting, words) in [
        ("run[0].model.stifness=1", "unknown key `stifness` in `run[0].model`; did you mean `stiffness`?"),
        ("rum[0].model.stiffness=1", "unknown key `rum`; did you mean `run`?"),
        ("tyme.duration=1", "unknown key `tyme`; did you mean `time`?"),
        ("run[0].model.stiffness=-5", "`run[0].model.stiffness` is -5; expected a number greater than 0"),
        ("body.mass=much", "`body.mass` is the string \"much\"; expected a number"),
        (
            "body.mass=0,5",
            "`body.mass` is the string \"0,5\"; expected a number; write 0.5: a number without quotation",
        ),
        ("time.integrator=perfl", "did you mean \"pefrl\"?"),
        ("run[2].step=1", "there is no `run[2]`; `run` has 2 entries, numbers 0 to 1"),
        ("hold[0].from=1", "there is no `hold[0]`; `hold` has no entries"),
        ("hold[\"a\"].from=1", "no entry of `hold` has the name \"a\"; `hold` has no entries"),
        ("obstacle[a].friction=1", "no entry of `obstacle` has the name \"a\"; `obstacle` has one entry, number 0"),
        ("body.lattice.cells[3]=1", "there is no `body.lattice.cells[3]`; `body.lattice.cells` has 3 entries"),
        (
            "run[\"Local shap\"].step=1",
            "no entry of `run` has the name \"Local shap\"; their names are \"Local shape\" and",
        ),
        ("run.model.stiffness=1", "`run` is an array of 2; expected a table; write `run[0]` for its first entry"),
        ("body[0].mass=1", "`body` is a table; expected an array"),
        ("time.duration.end=1", "`time.duration` is the number 0.1; expected a table"),
        ("view.labels=[name]", "`[name]` is not TOML; in a shell, quotation marks need others around the whole"),
        ("view.shadow=[false, 1]", "`view.shadow` is an array of 2; expected true or false"),
        // Mistakes in the scene as a whole, at the value that causes them.
        ("body.velocity=[1, 2]", "`body.velocity` has 2 coordinates"),
    ] {
        simulate(&place, &["--set", setting]).bad(2, &[&format!("error: small.toml: --set {setting}: "), words]);
    }
    assert_eq!(place.names("."), ["small.toml"]);
    // All mistakes are found together, those in the file first.
    place.write("wrong.toml", &SMALL.replace("friction", "fricton"));
    let ran = place.run("check wrong.toml --set body.mas=1 --set run[7].step=1").bad(2, &["unknown key `fricton`"]);
    let places: Vec<_> =
        ran.err.lines().filter_map(|line| line.split_once("wrong.toml:")).map(|(_, rest)| rest).collect();
    assert!(places.len() == 3 && places[0].starts_with("22:1:"), "{ran:?}");
    assert!(places[1].starts_with(" --set body.mas=1: ") && places[2].starts_with(" --set run[7].step=1: "), "{ran:?}");
    for wrong in ["time.duration", "=1", "time..duration=1", "run[0=1", "run[0]x=1", ""] {
        simulate(&place, &["--set", wrong]).bad(2, &["expected KEY=VALUE, such as time.duration=2"]);
    }
}

#[test]
fn warnings_have_the_option_as_their_place() {
    let place = Place::with_small();
    let ran = simulate(&place, &["--set", "run[0].step=T/2", "--frames", "0-1"]).too_large_steps();
    assert!(ran.err.starts_with("warning: small.toml: --set run[0].step=T/2: "), "{ran:?}");
}

#[test]
fn check_and_resuming_repeat_the_option() {
    let place = Place::with_small();
    let ran = place.run("check small.toml --set time.duration=0.5 --json").good();
    assert_eq!(ran.json()["scenes"][0]["scene"]["duration"], 0.5);
    let ran = place.run("check small.toml --set run[0].step=T/2");
    assert!(ran.status == Some(0) && ran.err.contains("--set run[0].step=T/2"), "{ran:?}");
    #[cfg(unix)]
    {
        let typed = "simulate small.toml --set time.duration=1e5 -o out";
        let running = crate::cli::interrupt::start(&place, typed, "out/run.json");
        crate::cli::interrupt::signal(&running, &["INT"]);
        let ran = running.wait();
        let how = place.shown("simulate --resume small.toml --set time.duration=1e5 -o out");
        assert!(ran.out.contains(&format!("to go on: {how}\n")), "{ran:?}");
    }
}

/// In a figure, a setting holds for all scenes.
#[cfg(feature = "render")]
#[test]
fn figures_are_drawn_with_other_values() {
    if !crate::cli::render::can_draw() {
        return;
    }
    let place = Place::new();
    let digests = |options: &[&str]| {
        run(&mut place.command([&["figure", "fig1", "-o", "fig1.svg", "--overwrite"], options].concat())).good();
        let svg = place.read("fig1.svg");
        let scenes =
            svg.split("localshape:scene ").nth(1).expect("digests").split("localshape:").next().map(str::to_owned);
        scenes.expect("digests")
    };
    assert_ne!(digests(&[]), digests(&["--set", "title=Other"]));
    let ran = place.run("figure fig1 --set run[0].model.stifness=1");
    ran.bad(2, &["--set run[0].model.stifness=1: unknown key `stifness` in `run[0].model`"]);
}
