//! `render`: frames and their metadata.

use crate::cli::support::{Place, SMALL, SMALL_FRAMES, lasting, run as run_command};
use localshape::internals::{Shown, Tags, read_tags, skipped};
use localshape::runner::History;
use localshape::{AdapterChoice, FrameFolder, Gpu, Limits, Renderer, Runner, Scene, compose};
use std::path::Path;
use std::sync::LazyLock;

/// Whether there is a graphics adapter; prints a message if not, and fails with `LOCALSHAPE_REQUIRE_GPU=1`.
pub(crate) fn can_draw() -> bool {
    static FOUND: LazyLock<bool> = LazyLock::new(|| {
        let found = Place::new().run("info --json").good().json();
        !found["adapters"].as_array().unwrap().is_empty()
    });
    let is_required = std::env::var_os("LOCALSHAPE_REQUIRE_GPU").is_some_and(|value| value == "1");
    assert!(*FOUND || !is_required, "no graphics adapter");
    if !*FOUND {
        skipped("no graphics adapter");
    }
    *FOUND
}

/// A place with `small.toml`, if there is a graphics adapter.
pub(crate) fn place_to_draw() -> Option<Place> {
    can_draw().then(Place::with_small)
}

fn tags(path: &Path) -> Tags {
    read_tags(path).expect("readable").expect("a frame of ours").1
}

/// Width, height and bytes of the pixels of a frame.
fn pixels(path: &Path) -> ([u32; 2], Vec<u8>) {
    let file = std::io::BufReader::new(std::fs::File::open(path).expect("a frame"));
    let mut reader = png::Decoder::new(file).read_info().expect("a picture");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a small picture")];
    let info = reader.next_frame(&mut bytes).expect("a whole picture");
    assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
    ([info.width, info.height], bytes)
}

/// A camera that follows, a chart and a plate depend on the course of the whole scene.
#[test]
fn the_library_writes_the_same_files_as_the_program() {
    let Some(place) = place_to_draw() else { return };
    let text = include_str!("../../scenes/fig4b.toml").replace("duration = 3.0", "duration = 0.5");
    place.write("drop.toml", &text.replace("size = [1280, 840]", "size = [320, 210]"));
    place.run("render drop.toml --frames 20").warned("the charts are left out");

    let scene = Scene::load(&place.path("drop.toml"), &Limits::default()).expect("a scene");
    let frame = Runner::new(&scene, &[0, 1]).frame(20);
    let gpu = Gpu::new(&AdapterChoice::Auto).expect("an adapter");
    let mut renderer = Renderer::new(&gpu, scene.view.size).expect("a device");
    let image = renderer.draw(&compose(&scene, &frame)).expect("a device");
    let mut folder = FrameFolder::create(place.path("library"), &scene).expect("a folder");
    folder.write_diagnostics(&frame).expect("a file");
    folder.write_picture(&frame, &image, &gpu).expect("a file");
    folder.finish().expect("a file");
    for file in ["frame_00020.png", "diagnostics.csv"] {
        let [own, programs] = ["library", "output/drop"].map(|folder| std::fs::read(place.path(folder).join(file)));
        assert!(own.expect("a file") == programs.expect("a file"), "{file}");
    }
}

#[test]
fn one_frame_can_be_a_file_of_vectors() {
    if !can_draw() {
        return;
    }
    let place = Place::with_small();
    let ran = place.run("render small.toml --frames 3 -o frame.svg").good();
    assert_eq!(ran.out, "frame.svg  96×64\n");
    let svg = place.read("frame.svg");
    assert!(svg.contains("localshape:frame 3\n") && svg.contains("<image "));
    place.run("render small.toml --frames 3 -o frame.svg --threads 1").good();
    assert_eq!(place.read("frame.svg"), svg, "the same bytes again");
    place.run("render small.toml --frames 3 -o frame.pdf").good();
    place.run("render small.toml --frames 3 -o frame.png").good();
    place.run("render small.toml --frames 3 -o folder").good();
    let [file, of_folder] = ["frame.png", "folder/frame_00003.png"].map(|name| pixels(&place.path(name)));
    assert_eq!(file, of_folder, "the frame alone is the frame of the sequence");
    place
        .run("render small.toml -o all.pdf")
        .bad(2, &["all.pdf is a file for one frame, but 7 are asked for", "--frames"]);
    place.run("render small.toml small.toml -o two.svg").bad(2, &["two.svg is a file for one frame"]);
    place.run("render small.toml --frames 3 --states -o one.svg").bad(2, &["one.svg gets one frame and nothing else"]);
    place.write("mine.pdf", "mine");
    place.run("render small.toml --frames 3 -o mine.pdf").bad(2, &["mine.pdf exists"]);
    assert_eq!(place.names("."), ["folder", "frame.pdf", "frame.png", "frame.svg", "mine.pdf", "small.toml"]);
}

#[test]
fn frames_for_print_say_their_resolution_and_refuse_small_type() {
    if !can_draw() {
        return;
    }
    let place = Place::new();
    let sized = |size: &str| SMALL.replace("size = [96, 64]", &format!("size = {size}"));
    place.write("print.toml", &sized("{ mm = [90, 60], dpi = 100 }\ntext_scale = { pt = 8 }"));
    place.run("render print.toml --frames 0").warned("the descriptions of 2 runs are shortened");
    let file = std::io::BufReader::new(std::fs::File::open(place.path("output/print/frame_00000.png")).unwrap());
    let reader = png::Decoder::new(file).read_info().expect("a picture");
    let info = reader.info();
    assert_eq!(([info.width, info.height], info.pixel_dims.map(|dims| dims.xppu)), ([354, 236], Some(3937)));
    place.write("tiny.toml", &sized("{ mm = [60, 40] }"));
    place.run("render tiny.toml").bad(2, &["tiny.toml:24:8: at 60 × 40 mm the smallest type would be"]);
    // It can be simulated.
    let ran = place.run("check tiny.toml");
    let words = "warning: tiny.toml: `view.size`: at 60 × 40 mm the smallest type would be ";
    assert!(ran.status == Some(0) && ran.err.starts_with(words) && ran.err.contains("make `size` larger"), "{ran:?}");
    assert!(!place.path("output/tiny").exists());
}

/// A theme is a value of the scene, so that frames of two themes are never mixed.
#[test]
fn another_theme_is_told_and_drawn() {
    let Some(place) = place_to_draw() else { return };
    place.run("render small.toml --frames 3 -o light").good();
    place.run("render small.toml --frames 3 --theme dark -o dark").good();
    place.run("render small.toml --frames 3 --set view.theme=dark -o set").good();
    let frame = |folder: &str| std::fs::read(place.path(folder).join("frame_00003.png")).unwrap();
    assert!(frame("dark") == frame("set") && frame("dark") != frame("light"));
    assert_eq!(place.json("dark/run.json")["set"], serde_json::json!(["view.theme=dark"]));
    place.run("render small.toml --frames 4 --theme dark -o light").bad(2, &["the results of another version"]);
    place.run("render small.toml --theme blue").bad(2, &["--theme", "light, dark"]);
}

#[test]
fn moments_have_the_frames_nearest_to_them() {
    let Some(place) = place_to_draw() else { return };
    let ran = place.run("render small.toml --at 0.1s,18ms -o some").good();
    assert!(ran.out.starts_with("0.1 s: frame 6, at 0.1 s\n0.018 s: frame 1, at 0.01667 s\nTwo cubes\n"), "{ran:?}");
    assert_eq!(place.names("some"), ["diagnostics.csv", "frame_00001.png", "frame_00006.png", "run.json"]);
    let ran = place.run("render small.toml --at 0.05 -o one.png").good();
    assert_eq!(ran.out, "0.05 s: frame 3, at 0.05 s\none.png  96×64\n");
    assert_eq!(tags(&place.path("one.png")).frame(), Some(3));
    place
        .run("render small.toml --at 2s")
        .bad(2, &["--at: in “Two cubes” there is no frame at 2 s; the last one is at 0.1 s"]);
    place.run("render small.toml --at soon").bad(2, &["`soon` is not a time; expected one such as 2s, 500ms or 2"]);
    place.run("render small.toml --at -1").bad(2, &["`-1` is not a time"]);
    place.run("render small.toml --at 1 --frames 1").bad(2, &["--at", "--frames"]);
    place.run("render small.toml --at 0,0.05 -o one.png").bad(2, &["2 are asked for", "--at 0.5s"]);
}

/// A folder whose frames differ in size or runs would not be a sequence.
#[test]
fn frames_of_another_size_or_with_other_runs_are_refused_unless_told() {
    let Some(place) = place_to_draw() else { return };
    place.run("render small.toml --frames 0-2").good();
    place.run("render small.toml --frames 3").good();
    for command in ["--size 80x60", "--only Mass-spring"] {
        let ran = place.run(&format!("render small.toml --frames 1 {command}"));
        ran.bad(2, &["output/small holds frames of this scene of 96×64 pixels", "-o", "--overwrite"]);
    }
    assert_eq!(place.names("output/small").len(), 2 + 4);
    place.run("render small.toml --frames 1 --size 80x60 --overwrite").good();
    assert_eq!(place.names("output/small"), ["diagnostics.csv", "frame_00001.png", "run.json"]);
    // Numbers may stand beside any frames of the scene.
    place.run("simulate small.toml").good();
}

#[test]
fn frames_diagnostics_and_summary() {
    let Some(place) = place_to_draw() else { return };
    let ran = place.run("render small.toml").good();
    assert!(ran.out.contains("7 frames of 96×64 in output/small"), "{}", ran.out);
    assert!(ran.out.contains("drawing") && ran.out.contains("encoding"), "{}", ran.out);
    let names = place.names("output/small");
    assert_eq!(names.len(), SMALL_FRAMES + 2);
    assert_eq!((names[0].as_str(), names[1].as_str()), ("diagnostics.csv", "frame_00000.png"));

    let run = place.json("output/small/run.json");
    assert_eq!(run["frames"]["written"], SMALL_FRAMES);
    assert_eq!(run["frames"]["size"], serde_json::json!([96, 64]));
    let adapter = run["adapter"].as_str().expect("the adapter's name");
    for stage in ["simulate", "compose", "draw", "encode", "total"] {
        assert!(run["times"][stage]["wall"].as_f64().unwrap() > 0.0, "{stage}: {run}");
    }

    let path = place.path("output/small/frame_00006.png");
    let (size, bytes) = pixels(&path);
    assert_eq!(size, [96, 64]);
    assert!(bytes.iter().any(|&byte| byte != bytes[0]), "something is to be seen");
    let tags = tags(&path);
    assert_eq!((tags.adapter.as_str(), tags.version.as_str()), (adapter, env!("CARGO_PKG_VERSION")));
    assert_eq!(tags.scenes, [run["scene"]["digest"].as_str().unwrap()]);
    let states: Vec<_> = tags.states.iter().map(|(digest, run)| (run.as_str(), digest.as_str())).collect();
    let last = |run: usize, place: &Place| place.json("output/small/run.json")["runs"][run]["last"]["state"].clone();
    assert_eq!(
        states,
        [("Local shape", last(0, &place).as_str().unwrap()), ("Mass-spring", last(1, &place).as_str().unwrap())]
    );
    let table = place.read("output/small/diagnostics.csv");
    let time = table.lines().last().unwrap().split(',').nth(3).unwrap();
    assert_eq!(tags.shows, Shown::Frame { frame: 6, time: time.parse().unwrap() });
}

/// Drawing never changes the simulation, and equal runs give equal files.
#[test]
fn again_and_without_pictures() {
    let Some(place) = place_to_draw() else { return };
    place.run("render small.toml -o one --threads 1").good();
    place.run("render small.toml -o two --threads 3").good();
    place.run("simulate small.toml -o numbers").good();
    assert_eq!(place.read("one/diagnostics.csv"), place.read("numbers/diagnostics.csv"));
    for name in place.names("one").into_iter().filter(|name| name != "run.json") {
        let bytes = |folder: &str| std::fs::read(place.path(folder).join(&name)).unwrap();
        assert!(bytes("one") == bytes("two"), "{name} differs");
    }
}

#[test]
fn some_frames_of_one_run_in_another_size() {
    let Some(place) = place_to_draw() else { return };
    let ran = place.run("render small.toml --frames 2,4-6x2 --only Mass-spring --size 63x41 --timings --states").good();
    for word in ["3 frames of 63×41", "wall ms", "encode and write"] {
        assert!(ran.out.contains(word), "{word}: {}", ran.out);
    }
    let frames = ["frame_00002.png", "frame_00004.png", "frame_00006.png"];
    let names = place.names("output/small");
    assert_eq!(names, ["diagnostics.csv", frames[0], frames[1], frames[2], "run.json", "states.npz"]);
    let path = place.path("output/small/frame_00004.png");
    assert_eq!(pixels(&path).0, [63, 41]);
    assert_eq!(tags(&path).states.iter().map(|(_, run)| run.as_str()).collect::<Vec<_>>(), ["Mass-spring"]);

    // A frame drawn alone is equal to the same frame drawn with others.
    place.run("render small.toml --frames 4 --only Mass-spring --size 63x41 -o alone").good();
    assert!(std::fs::read(path).unwrap() == std::fs::read(place.path("alone/frame_00004.png")).unwrap());
}

/// The small scene with a strip, which needs more height.
fn with_strip(text: &str) -> String {
    text.replace("size = [96, 64]", "size = [640, 420]\ncharts = [\"shape_error\"]")
}

#[test]
fn strips_are_the_same_whichever_frames_are_drawn() {
    let Some(place) = place_to_draw() else { return };
    place.write("strip.toml", &with_strip(SMALL));
    place.run("render strip.toml").good();
    place.run("render strip.toml --frames 3 -o alone --threads 1").good();
    let bytes = |path: &str| std::fs::read(place.path(path)).unwrap();
    assert!(bytes("output/strip/frame_00003.png") == bytes("alone/frame_00003.png"));
    place.run("render small.toml --frames 3 --size 640x420 -o without").good();
    let [with, without] = ["alone", "without"].map(|folder| pixels(&place.path(folder).join("frame_00003.png")).1);
    assert!(with != without);
    // A strip does not change any number.
    place.run("simulate strip.toml -o numbers").good();
    assert_eq!(place.read("output/strip/diagnostics.csv"), place.read("numbers/diagnostics.csv"));

    place.run("render strip.toml --only Mass-spring -o one").good();
    place.run("render strip.toml --only Mass-spring --frames 3 -o other").good();
    assert!(bytes("one/frame_00003.png") == bytes("other/frame_00003.png"));
}

#[cfg(unix)]
#[test]
fn interrupted_while_simulating_ahead() {
    let Some(place) = place_to_draw() else { return };
    place.write("long.toml", &with_strip(&lasting("100000")));
    let running = crate::cli::interrupt::start(&place, "render long.toml --frames 0", "output/long/run.json");
    crate::cli::interrupt::signal(&running, &["INT"]);
    assert_eq!(running.wait().status, Some(130));
    assert_eq!(crate::cli::interrupt::results(&place, "output/long"), ["diagnostics.csv", "run.json"]);
    let run = place.json("output/long/run.json");
    assert_eq!((&run["outcome"], run["frames"]["recorded"].as_u64()), (&"interrupted".into(), Some(0)));
}

#[test]
fn adapters() {
    let Some(place) = place_to_draw() else { return };
    for (folder, more) in [("default", ""), ("auto", " --adapter auto")] {
        place.run(&format!("render small.toml --frames 3 -o {folder}{more}")).good();
    }
    let bytes = |folder: &str| std::fs::read(place.path(folder).join("frame_00003.png")).unwrap();
    assert!(bytes("default") == bytes("auto"), "auto is the default");
    let adapter = place.json("auto/run.json")["adapter"].as_str().unwrap().to_owned();
    let name = adapter.split([' ', '(']).next().unwrap();
    place.run(&format!("render small.toml --frames 3 -o named --adapter {name}")).good();
    place.run("render small.toml --adapter sundial -o none").bad(3, &["sundial", name]);
    assert!(!place.path("none").exists(), "nothing is written before it is known that it can be drawn");
}

#[test]
fn json_with_pictures() {
    let Some(place) = place_to_draw() else { return };
    let document = place.run("render small.toml --frames 0 --json").good().json();
    assert_eq!(document["scenes"][0]["frames"]["written"], 1);
    assert_eq!(document["scenes"][0]["outcome"], "done");
    assert_eq!(document["scenes"][0]["files"], serde_json::json!(["diagnostics.csv", "frame_*.png"]));
}

#[test]
fn wrong_options() {
    let place = Place::with_small();
    place.run("render small.toml --size 1280").bad(2, &["--size", "1280x720"]);
    place.run("render small.toml --size 0x4").bad(2, &["--size", "16384"]);
    assert_eq!(place.names("."), ["small.toml"]);
}

/// Frames of another scene are not mixed with those of this one, even if the summary is missing.
#[test]
fn frames_of_another_scene() {
    let Some(place) = place_to_draw() else { return };
    place.write("other.toml", &lasting("0.05"));
    place.run("render small.toml -o out").good();
    std::fs::remove_file(place.path("out/run.json")).unwrap();
    std::fs::remove_file(place.path("out/diagnostics.csv")).unwrap();
    place.run("render other.toml -o out").bad(2, &["frames of another scene", "--overwrite"]);
    place.run("simulate other.toml -o out").bad(2, &["frames of another scene", "--overwrite"]);
    place.run("render other.toml -o out --overwrite").good();
    let frames: Vec<_> = place.names("out").into_iter().filter(|name| name.ends_with(".png")).collect();
    assert_eq!(frames.len(), 4, "{frames:?}");

    // Frames of the same scene stay.
    place.run("render other.toml -o out --frames 1").good();
    assert_eq!(place.names("out").len(), 4 + 2);
}

#[cfg(target_os = "linux")]
#[test]
fn without_a_driver() {
    let place = Place::with_small();
    let nowhere = place.path("nowhere.json");
    let run = |arguments: &str| {
        let mut command = place.command(arguments.split(' '));
        run_command(command.env("VK_DRIVER_FILES", &nowhere).env("VK_ICD_FILENAMES", &nowhere))
    };
    run("render small.toml").bad(3, &["mesa-vulkan-drivers"]);
    assert_eq!(place.names("."), ["small.toml"]);
    run("simulate small.toml").good();
}

#[test]
fn a_diverged_run_is_drawn_to_the_end() {
    let Some(place) = place_to_draw() else { return };
    place.write("wild.toml", &SMALL.replace("step = \"T/50\"", "step = \"T/2\"").replace("0.1\n", "5.0\n"));
    place.run("render wild.toml --frames 0-300x100").too_large_steps();
    let tags = |frame: &str| tags(&place.path("output/wild").join(frame));
    assert_eq!(tags("frame_00200.png").states, tags("frame_00300.png").states);
}

#[test]
fn says_which_runs_leave_their_panels() {
    if !can_draw() {
        return;
    }
    let place = Place::with_small();
    place.write("beside.toml", &SMALL.replace("[view]", "[view]\ncamera.target = [2, 0, 0]"));
    let ran = place.run("render beside.toml --frames 0,3").good();
    assert!(
        ran.out.contains("warning: Mass-spring leaves its panel in 2 of 2 frames, first in frame 0"),
        "{}",
        ran.out
    );
    assert_eq!(place.json("output/beside/run.json")["runs"][1]["cut"], serde_json::json!([0, 3]));
    assert!(!place.run("render small.toml --frames 0,3").good().out.contains("warning"));
    assert_eq!(place.json("output/small/run.json")["runs"][1]["cut"], serde_json::Value::Null);
}

#[cfg(unix)]
#[test]
fn interrupted_while_drawing() {
    let Some(place) = place_to_draw() else { return };
    place.write("long.toml", &lasting("1000"));
    let running = crate::cli::interrupt::start(&place, "render long.toml", "output/long/frame_00003.png");
    crate::cli::interrupt::signal(&running, &["INT"]);
    assert_eq!(running.wait().status, Some(130));
    let run = place.json("output/long/run.json");
    let written = run["frames"]["written"].as_u64().unwrap();
    assert_eq!(run["frames"]["recorded"].as_u64(), Some(written));
    let names = crate::cli::interrupt::results(&place, "output/long");
    assert_eq!(names.len() as u64, written + 2);
    for name in names.iter().filter(|name| name.ends_with(".png")) {
        pixels(&place.path("output/long").join(name));
    }
}

/// Finished files are kept, and the summary has the outcome.
#[cfg(unix)]
#[test]
fn a_frame_that_cannot_be_written() {
    let Some(place) = place_to_draw() else { return };
    place.write("long.toml", &lasting("10"));
    let running = crate::cli::interrupt::start(&place, "render long.toml -o out", "out/run.json");
    // A folder in the place of a file fails early.
    place.write("out/frame_00300.png/notes.txt", "mine");
    running.wait().bad(4, &["cannot write out/frame_00300.png"]);
    assert_eq!(place.json("out/run.json")["outcome"], "failed");
    assert!(read_tags(&place.path("out/frame_00299.png")).unwrap().is_some());
    assert!(place.read("out/diagnostics.csv").lines().count() > 2 * 300);
    // A slow machine has written a checkpoint before.
    let is_unfinished = |name: &&String| name.starts_with('.') && *name != ".localshape-checkpoint.partial";
    assert_eq!(place.names("out").iter().filter(is_unfinished).count(), 0);
}

/// A name with the ending of another picture format is hardly meant for a folder.
#[test]
fn formats_that_are_not_written_are_refused() {
    let place = Place::new();
    place.write("small.toml", SMALL);
    for name in ["frame.jpg", "frame.JPEG", "film.mp4"] {
        let told = format!("-o {name}: a picture is written as .png, .svg or .pdf; expected one of these");
        place.run(&format!("render small.toml --frames 0 -o {name}")).bad(2, &[&told]);
    }
}

/// Pictures cannot show a run that is left out; a simulation needs no other run.
#[test]
fn runs_that_others_are_compared_with_cannot_be_left_out() {
    let place = Place::new();
    let distance = "colour = { by = \"distance\", to = \"Local shape\" }";
    for (key, typed) in [("colour.to", distance), ("ghost", "ghost = \"Local shape\"")] {
        place.write("ghost.toml", &format!("{SMALL}{typed}\n"));
        let told = format!(
            "--only leaves out the run “Local shape”, which `view.{key}` of “Two cubes” needs; add --only 'Local shape'"
        );
        place.run("render ghost.toml --only Mass-spring").bad(2, &[&told]);
    }
    place.write("to.toml", &format!("{SMALL}colour = {{ by = \"distance\", to = \"Mass-spring\" }}\n"));
    let told = "--only leaves just the run “Mass-spring”, from which `view.colour.to` of “Two cubes” measures";
    place.run("render to.toml --only Mass-spring").bad(2, &[told]);
    place.run("simulate ghost.toml --only Mass-spring").good();
    if can_draw() {
        place.run("render ghost.toml --frames 2").good();
    }
}

/// A wall between the body and the usual camera turns the camera by a twelfth, unless the scene names an azimuth.
#[test]
fn the_camera_turns_to_where_no_obstacle_hides_the_body() {
    let Some(place) = place_to_draw() else { return };
    let wall = "[[obstacle]]\nkind = \"box\"\ncentre = [0.3, 0.1, 0.5]\nsize = [0.3, 2.0, 0.02]\nrotation = { axis = [0, 1, 0], angle = 0.541 }\n";
    let azimuth = |scene: &str| {
        place.write("wall.toml", scene);
        place.run("render wall.toml --overwrite --size 480x320 --frames 0").good();
        place.json("output/wall/run.json")["frames"]["azimuth"].as_f64().expect("an azimuth").to_degrees().round()
    };
    assert_eq!(azimuth(SMALL), 31.0);
    assert_eq!(azimuth(&(SMALL.to_owned() + wall)), 61.0);
    assert_eq!(azimuth(&(SMALL.replace("[view]", "[view]\ncamera.azimuth = 0.0") + wall)), 0.0);
}

/// A body that is held, with a camera that stands still, is drawn once if no clock runs.
#[test]
fn frames_of_the_same_states_are_drawn_once() {
    let Some(place) = place_to_draw() else { return };
    let held =
        lasting("0.1") + "labels = [\"name\", \"count\"]\n[[hold]]\nnodes = { low = [-9, -9, -9], high = [9, 9, 9] }\n";
    let repeated = |scene: &str| {
        place.write("held.toml", scene);
        place.run("render held.toml --overwrite --size 480x320").good();
        place.json("output/held/run.json")["frames"]["repeated"].as_u64()
    };
    assert_eq!(repeated(&held.replace("\"count\"", "\"clock\"")), None);
    assert_eq!(repeated(&held), Some(SMALL_FRAMES as u64 - 1));
    let last = format!("output/held/frame_{:05}.png", SMALL_FRAMES - 1);
    let bytes = std::fs::read(place.path(&last)).expect("a frame");
    place.run(&format!("render held.toml --overwrite --size 480x320 --frames {}", SMALL_FRAMES - 1)).good();
    assert_eq!(std::fs::read(place.path(&last)).expect("a frame"), bytes, "as drawn alone");
}

/// Mesa's software driver writes beyond its memory with narrow vectors.
#[test]
#[cfg(target_os = "linux")]
fn widths_of_vectors_that_crash_the_driver_are_not_passed_on() {
    let Some(place) = place_to_draw() else { return };
    place.run("render small.toml --frames 3 -o usual").good();
    for (width, is_taken) in [("256", true), ("512", true), ("128", false), ("", true), ("wide", false)] {
        let mut command = place.command(["render", "small.toml", "--frames", "3", "-o", "made", "--overwrite"]);
        let made = run_command(command.env("LP_NATIVE_VECTOR_WIDTH", width));
        assert_eq!(made.status, Some(0), "{width}: {made:?}");
        let warning =
            format!("warning: LP_NATIVE_VECTOR_WIDTH is {width}, with which software drivers may crash; expected 256");
        assert_eq!(made.err.contains(&warning), !is_taken, "{width}: {made:?}");
        let frame = |folder: &str| std::fs::read(place.path(format!("{folder}/frame_00003.png"))).expect("a frame");
        assert!(width == "512" || frame("made") == frame("usual"), "{width}");
        let mut command = place.command(["render", "small.toml", "--frames", "3", "-o", "quiet", "--overwrite", "-q"]);
        assert_eq!(run_command(command.env("LP_NATIVE_VECTOR_WIDTH", width)).err, "", "{width}");
    }
}

/// A chart names values between frames, which `run.json` has, too.
#[test]
fn charts_and_numbers_agree() {
    let place = Place::new();
    place.write("disc.toml", &crate::cli::support::disc("2").replace(", every = 0.004", ", frames_per_second = 5"));
    place.run("render disc.toml -o out").good();
    let scene = Scene::load(&place.path("disc.toml"), &Limits::default()).expect("a scene");
    let history = History::for_pictures(&scene, &[0]);
    let series = &history.series[0];
    let curve = series.times.iter().zip(&series.diagnostics).map(|(&time, all)| [all.kinetic, time]);
    let most = curve.reduce(|one, other| if other[0] > one[0] { other } else { one }).expect("moments");
    let run = place.json("out/run.json")["runs"][0].clone();
    let told = |end: &str, key: &str| ["value", "time"].map(|part| run[end][key][part].as_f64().expect("a number"));
    assert_eq!(told("greatest", "kinetic"), most);
    let text = place.read("out/diagnostics.csv");
    let columns = |row: &str| -> Vec<f64> { row.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect() };
    let rows: Vec<_> = text.lines().skip(1).map(columns).collect();
    let of_frames = rows.iter().map(|row| row[4]).fold(0.0, f64::max);
    assert!(of_frames < most[0], "{of_frames} {most:?}");
    // No chart shows the elastic energy.
    let most = rows.iter().map(|row| [row[5], row[3]]).reduce(|one, other| if other[0] > one[0] { other } else { one });
    assert_eq!(Some(told("greatest", "elastic")), most);
    assert!(run["greatest"].get("broken").is_none(), "its model has none");
    // The same from stored states.
    place.run("render disc.toml --states -o states").good();
    place.run("render disc.toml --from-states states/states.npz -o stored").good();
    for folder in ["states", "stored"] {
        let other = place.json(&format!("{folder}/run.json"))["runs"][0].clone();
        assert_eq!((&other["least"], &other["greatest"]), (&run["least"], &run["greatest"]), "{folder}");
    }
}
