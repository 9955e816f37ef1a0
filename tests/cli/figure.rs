//! `figure`: the paper's figures and a user's own, as files and on standard output.
use crate::cli::render::can_draw;
use crate::cli::support::{Place, SMALL};

const SHEET: &str = r#"
title = "Two cubes"
size = [320, 200]
[sheet]
scene = "small.toml"
moments = [0.0, 0.1]
charts = ["turned_over"]
"#;

fn place() -> Place {
    let place = Place::with_small();
    place.write("mine.toml", SHEET);
    place
}

fn place_to_draw() -> Option<Place> {
    can_draw().then(place)
}

/// Warnings of a scene are also reported for figures and goldens of it.
#[test]
fn scenes_are_warned_of() {
    let place = place();
    place.write("small.toml", &SMALL.replace("frames_per_second = 60", "frames_per_second = 1e-300"));
    place.write("mine.toml", &SHEET.replace("[0.0, 0.1]", "[0.0]").replace("charts = [\"turned_over\"]", ""));
    let words = "small.toml:7:21: at 1e-300 frames per second, 0.1 s have only one frame, the start\n";
    for command in ["figure mine.toml", "compare golden/mine mine.toml", "compare golden/small small.toml"] {
        let ran = place.run(command);
        assert!(ran.err.starts_with("warning: ") && ran.err.contains(words), "{command}: {ran:?}");
        let quiet = place.run(&format!("{command} --quiet"));
        assert!(!quiet.err.contains("warning: "), "{command}: {quiet:?}");
    }
}

#[test]
fn names_are_told() {
    let place = Place::new();
    assert!(place.run("figure").good().out.starts_with("figures: fig1, fig2, fig3, fig4a, fig4b, fig4c, restore"));
    assert!(place.run("figure --json").good().out.contains("\"restore\""));
}

#[test]
fn figures_are_made_told_and_made_again() {
    let Some(place) = place_to_draw() else { return };
    let ran = place.run("figure fig2 mine.toml fig2 --scale 0.5");
    let told = "warning: mine: not everything has room in 160×100: panels have no numbers; the charts are left out\n";
    assert_eq!((ran.status, &*ran.err), (Some(0), told));
    assert_eq!(ran.out, "output/figures/fig2.png  1280×576\noutput/figures/mine.png  160×100\n");
    place.run("figure all fig4 --scale 0.1 -o all -q").good();
    let all = ["fig1", "fig2", "fig3", "fig4a", "fig4b", "fig4c", "restore"].map(|name| format!("{name}.png"));
    assert_eq!(place.names("all"), all);
}

#[test]
fn the_numbers_behind_a_figure_are_told() {
    let Some(place) = place_to_draw() else { return };
    let ran = place.run("figure fig1 mine.toml fig1 -o all --json --size 320x200 --threads 1").good();
    let told: serde_json::Value = serde_json::from_str(&ran.out).expect("JSON");
    let [fig1, mine] = &told["figures"].as_array().expect("a list")[..] else { panic!("two figures: {}", ran.out) };
    let apex = &fig1["numbers"][0]["runs"][0]["forces_over_stiffness_and_side"][2];
    assert!((apex[1].as_f64().unwrap() - 0.5076).abs() < 5e-5, "{apex}");
    let cell = &mine["numbers"][1][1];
    assert_eq!((cell["run"].as_str(), cell["turned_over"].as_u64()), (Some("Mass-spring"), Some(0)));
    assert!(cell["time"].as_f64().unwrap() > 0.09);
    assert_eq!(place.names("all"), ["fig1.png", "mine.png"]);
    let before = std::fs::read(place.path("all/mine.png")).unwrap();
    assert!(!before.windows(4).any(|bytes| bytes == b"tIME"));
    // Repeated with another number of threads: the bytes are the same, and nothing is refused.
    place.run("figure mine.toml -o all --size 320x200 --threads 2 -q").good();
    assert_eq!(std::fs::read(place.path("all/mine.png")).unwrap(), before);
    let dark = place.run("figure mine.toml -o dark --size 320x200 --theme dark -q").good();
    assert_eq!(dark.out, "");
    assert_ne!(std::fs::read(place.path("dark/mine.png")).unwrap(), before);
}

#[test]
fn wrong_names_and_files_are_told() {
    let place = place();
    place.run("figure fig9").bad(2, &["no figure `fig9`", "did you mean `fig1`?", "fig4, all"]);
    place.run("figure restor").bad(2, &["did you mean `restore`?"]);
    place.run("figure sheet.toml").bad(2, &["sheet.toml: there is no such file"]);
    place
        .run("figure small.toml")
        .bad(2, &["small.toml:", "this is a scene, not a figure; `localshape render` draws it"]);
    place.write("wrong.toml", &SHEET.replace("small.toml", "smal.toml"));
    place.run("figure wrong.toml").bad(2, &["wrong.toml:5:9", "smal.toml: there is no such file", "small.toml"]);
    place.write("late.toml", &SHEET.replace("[0.0, 0.1]", "[0.0, 7.0]"));
    place.run("figure late.toml").bad(2, &["late.toml:6:17", "ends at 0.1 s"]);
    place.write("other/mine.toml", &SHEET.replace("small.toml", "../small.toml"));
    place.run("figure mine.toml other/mine.toml").bad(2, &["two figures would both be written to", "-o"]);
    place.run("figure fig1 --scale 9").bad(2, &["--scale", "0.1 to 4"]);
    place.run("figure fig1 --scale 2 --size 100x100").bad(2, &["--size"]);
    place.run("figure mine.toml --size 20x20").bad(2, &["mine: 20×20 is too small"]);
    place
        .run("render mine.toml")
        .bad(2, &["mine.toml:4:2: this is a figure, not a scene; `localshape figure` draws it"]);
    assert!(!place.path("output").exists());
}

#[test]
fn files_of_others_are_kept() {
    let Some(place) = place_to_draw() else { return };
    place.write("out/mine.png", "mine");
    place.run("figure mine.toml -o out").bad(2, &["out", "mine.png, which is not a figure of this program"]);
    assert_eq!(place.read("out/mine.png"), "mine");
    place.run("figure mine.toml -o out --overwrite --size 80x64 -q").good();
    place.write("file", "");
    place.run("figure mine.toml -o file").bad(4, &["file"]);
    place.run("figure mine.toml -o file/below").bad(4, &["file"]);
}

/// The resolution in a PNG file, pixels per metre, as programs read it first.
fn pixels_a_metre(path: &std::path::Path) -> Option<u32> {
    let file = std::io::BufReader::new(std::fs::File::open(path).expect("a picture"));
    let reader = png::Decoder::new(file).read_info().expect("a PNG picture");
    reader.info().pixel_dims.map(|dims| dims.xppu)
}

/// Vectors of flat bodies need no device.
#[test]
fn a_file_name_chooses_the_format() {
    let place = place();
    let ran = place.run("figure fig2 -o paper/fig2.svg").good();
    assert_eq!(ran.out, "paper/fig2.svg  2560×1152\n");
    assert!(place.read("paper/fig2.svg").contains(">back to the rest shape</text>"));
    let first = place.read("paper/fig2.svg");
    place.run("figure fig2 -o paper/fig2.svg --threads 1 -q").good();
    assert_eq!(place.read("paper/fig2.svg"), first, "the same bytes again");
    place.run("figure fig2 -o fig2.PDF").good();
    assert!(std::fs::read(place.path("fig2.PDF")).unwrap().starts_with(b"%PDF-1.7"));
    place.run("figure fig2 -o fig2.PDF").good();
    place.run("figure fig1 fig2 -o both.pdf").bad(2, &["both.pdf is a file for one figure, but 2 are asked for"]);
    place.write("mine.svg", "<svg >drawn by hand</svg>");
    place.run("figure fig2 -o mine.svg").bad(2, &["mine.svg exists and was not made by this command", "--overwrite"]);
    place.run("figure fig2 -o mine.svg --overwrite").good();
    assert!(!place.path("both.pdf").exists() && place.read("mine.svg").contains("localshape:figure fig2"));
}

#[test]
fn figures_for_print_have_their_size_and_no_small_type() {
    let place = place();
    let forces = |size: &str| format!("{size}\n[forces]\nscenes = [\"small.toml\"]\n");
    let small = SMALL.replace(
        "lattice = { cells = [2, 1, 1], side = 0.1 }",
        "nodes = [[0, 0], [1, 0], [0, 1]]\nelements = [[0, 1, 2]]",
    );
    place.write(
        "small.toml",
        &small.replace("velocity = [0, -2, 0]", "").replace("gravity = [0, -9.8, 0]", "gravity = [0, -9.8]"),
    );
    place.write("print.toml", &forces("size = { mm = [180, 101] }"));
    let ran = place.run("figure print.toml -o print.svg").good();
    assert_eq!(ran.out, "print.svg  180 × 101 mm\n");
    assert!(place.read("print.svg").contains("width=\"180mm\" height=\"101mm\""));
    place.write("tiny.toml", &forces("title = \"x\"\nsize = { mm = [80, 45] }"));
    place
        .run("figure tiny.toml -o tiny.svg")
        .bad(2, &["tiny.toml:2:8: at 80 × 45 mm the smallest type would be ", " pt; expected at least 5 pt"]);
    assert!(!place.path("tiny.svg").exists());
    place.write("large.toml", &forces("size = { mm = [80, 60] }\ntext_scale = { pt = 7 }"));
    place.run("figure large.toml -o large.svg").good();
    if can_draw() {
        place.run("figure print.toml -o print.png").good();
        // 300 pixels per inch.
        assert_eq!(pixels_a_metre(&place.path("print.png")), Some(11811));
        place.run("figure fig2 --scale 0.25 -o fig2.png").good();
        assert_eq!(pixels_a_metre(&place.path("fig2.png")), None);
    }
}

/// A diagram that is too small for its contents is an error, not an empty picture.
#[test]
fn what_has_no_room_is_told() {
    let Some(place) = place_to_draw() else { return };
    let names: Vec<_> = (0..12).map(|at| format!("'{at}.toml'")).collect();
    names.iter().for_each(|name| place.write(name.trim_matches('\''), SMALL));
    place.write("tall.toml", &format!("[forces]\nscenes = [{}]", names.join(", ")));
    place.run("figure tall.toml --size 320x200").bad(2, &["tall: at 320×200 the figure is too small for its contents"]);
    assert_eq!(place.names("output/figures"), [""; 0]);
}
