//! Colours, fonts and lines: correct ones have the right effect, and every mistake is explained.

use super::mistakes::{PLANE, case};
use super::{WORLD, bad, expect, good};
use localshape::colour::contrast;
use localshape::look::{ColourMap, Ghost, Style, Theme, Traced};
use localshape::scene::{Limits, Scene, SceneError};

const FONT: &[u8] = include_bytes!("../../assets/fonts/LocalshapeSans-Regular.otf");
const SEMI_BOLD: &[u8] = include_bytes!("../../assets/fonts/LocalshapeSans-SemiBold.otf");

/// A scene with a view.
fn with(view: &str) -> String {
    format!("{WORLD}[body]\nlattice = {{ cells = [1, 1, 1], side = 1 }}\n[view]\n{view}\n")
}

fn look(view: &str) -> Style {
    good(&with(view)).view.look
}

#[test]
fn a_scene_that_says_nothing_has_the_look_of_its_theme() {
    assert_eq!(look(""), Style::of(Theme::Light));
    assert_eq!(look("theme = 'dark'"), Style::of(Theme::Dark));
    assert_eq!(look("theme = 'dark'\ntext_scale = 1"), Style::of(Theme::Dark));
}

/// Scenes of several runs, each with its lines.
fn of_runs(view: &str, runs: &[&str]) -> String {
    let run = |(at, said): (usize, &&str)| {
        format!("[[run]]\nname = 'Run {at}'\nmodel = {{ kind = 'shape-based', stiffness = 1 }}\n{said}\n")
    };
    let runs: String = runs.iter().enumerate().map(run).collect();
    let body = "[body]\nlattice = { cells = [1, 1, 1], side = 1 }";
    format!("time = {{ duration = 1, step = 0.01 }}\n{body}\n[view]\n{view}\n{runs}")
}

#[test]
fn runs_have_the_colours_of_their_models_or_their_own() {
    for theme in ["light", "dark"] {
        let springs = "[[run]]\nname = 'Springs'\nmodel = { kind = 'mass-spring', stiffness = 1 }";
        let chosen = "colour = '#4169e1'";
        let scene = good(&of_runs(&format!("theme = '{theme}'"), &["", "colour = 'royalblue'", chosen, springs]));
        let palette = scene.view.look.palette();
        let lines: Vec<_> = scene.runs.iter().map(|run| run.line(&palette)).collect();
        let own = [65, 105, 225];
        // On a light background the colour of the model resembles royal blue, and one that is left replaces it.
        let first = if theme == "light" { 2 } else { 0 };
        assert_eq!(
            lines.iter().map(|line| line.colour).collect::<Vec<_>>(),
            [palette.runs[first], own, own, palette.runs[first], palette.runs[1]]
        );
        // The same colour, but different dashes.
        assert!(lines[1].dash != lines[2].dash && lines[0].dash != lines[3].dash);
    }
    // Each line has enough contrast with the background.
    let scene = good(&of_runs("background = '#808080'", &[""; 8]));
    for run in &scene.runs {
        let line = run.line(&scene.view.look.palette());
        assert!(contrast(line.colour, [0x80; 3]) >= 3.0, "{line:?}");
    }
    let digest = |said: &str| good(&of_runs("", &[said])).digest;
    assert_eq!(digest("colour = 'royalblue'"), digest("colour = '#4169E1'"));
    assert_ne!(digest("colour = 'royalblue'"), digest(""));
}

#[test]
fn mistakes_of_colours_of_runs() {
    let told = |view: &str, colour: &str| {
        let text = of_runs(view, &["", &format!("colour = {colour}")]);
        let error = Scene::parse(&text, "scene.toml", &Limits::default()).expect_err(colour).to_string();
        assert!(error.contains("scene.toml:13:10: "), "{error}");
        error
    };
    assert!(told("", "'navi'").contains("`run[1].colour` is \"navi\"; expected digits such as"));
    assert!(told("", "'navi'").contains("did you mean \"navy\"?"));
    assert!(told("", "'#12345'").contains("three or six digits"));
    assert!(told("", "'#12345680'").contains("expected an opaque colour"));
    assert!(told("", "7").contains("`run[1].colour`"));
    assert!(
        told("", "'gold'")
            .contains("choose another hue; this one, made darker, would be similar to turned-over elements")
    );
    let faint = told("", "'skyblue'");
    assert!(
        faint.contains("has a contrast of 1.6 to 1 with the background #fbfbfa; expected at least 3 to 1"),
        "{faint}"
    );
    let named =
        faint.split("make it darker, such as \"").nth(1).and_then(|rest| rest.split('"').next()).expect("a colour");
    good(&of_runs("", &[&format!("colour = '{named}'")]));
    assert!(told("theme = 'dark'", "'navy'").contains("make it lighter, such as \"#"));
    let alarm = told("", "'#d45500'");
    assert!(
        alarm.contains("`run[1].colour` is too similar to the colour of turned-over elements, #e2661c: to "),
        "{alarm}"
    );
    assert!(alarm.contains("(CIEDE2000); expected at least 20") && alarm.contains("choose another hue"), "{alarm}");
}

#[test]
fn a_background_takes_the_theme_whose_text_can_be_read_on_it() {
    for (view, theme, background) in [
        ("background = 'black'", Theme::Dark, [0; 3]),
        ("background = '#102040'\ntheme = 'light'", Theme::Dark, [0x10, 0x20, 0x40]),
        ("background = 'ivory'\ntheme = 'dark'", Theme::Light, [255, 255, 240]),
        ("background = 'ivory'", Theme::Light, [255, 255, 240]),
    ] {
        let look = look(view);
        assert_eq!((look.theme, look.palette().background), (theme, background), "{view}");
        for text in [look.palette().text, look.palette().second_text, look.palette().alarm_text] {
            assert!(contrast(text, background) >= 4.5, "{view}: {text:x?}");
        }
    }
}

#[test]
fn scales_have_named_colours_and_factors() {
    let scene = good(&with("colour = { by = 'speed', map = 'viridis' }\ntext_scale = 1.5"));
    assert_eq!(scene.view.colour.map(|colour| colour.map), Some(ColourMap::Viridis));
    assert_eq!(scene.view.look.text_scale, 1.5);
    let usual = good(&with("colour = { by = 'speed' }"));
    assert_eq!(usual.view.colour.map(|colour| colour.map), Some(ColourMap::MintIndigo));
}

#[test]
fn the_digest_follows_what_colours_mean() {
    let digest = |view: &str| good(&with(view)).digest;
    let plain = digest("");
    for same in ["text_scale = 1", "shadow = true"] {
        assert_eq!(digest(same), plain, "{same}");
    }
    assert_eq!(digest("background = 'white'"), digest("background = '#fff'"));
    assert_eq!(digest("colour.by = 'speed'"), digest("colour = { by = 'speed', map = 'mint-indigo' }"));
    let mut all: Vec<_> = [
        "",
        "background = 'white'",
        "text_scale = 1.1",
        "shadow = false",
        "colour.by = 'speed'",
        "colour = { by = 'speed', map = 'greys' }",
    ]
    .map(digest)
    .to_vec();
    all.sort();
    all.dedup();
    assert_eq!(all.len(), 6);
}

#[track_caller]
fn view(to: &str, expected: &str) {
    case(PLANE, "size = [640, 360]", to, expected);
}

#[test]
fn mistakes_of_colours() {
    view("background = 'transparent'", "20:14 is \"transparent\", which is transparent; expected an opaque colour");
    view("background = '#ffffff00'", "20:14 , which is transparent; expected an opaque colour");
    view("background = 7", "20:14 is the whole number 7; expected a string The background");
    view("background = 'stelblue'", "20:14 `view.background` is \"stelblue\"; expected digits such as \"#93a5ba\"");
    view("background = 'stelblue'", "20:14 did you mean \"steelblue\"?");
    view("background = '93a5ba'", "20:14 write \"#93a5ba\"");
    view("background = '#93a5b'", "20:14 expected three or six digits, such as \"#93a5ba\"");
    view("background = ''", "20:14 `view.background` is \"\"; expected digits");
    view("colours = { body = 'red' }", "20:1 unknown key `colours` in `view` did you mean `colour`?");
    view("color = 'red'", "20:1 unknown key `color` in `view` did you mean `colour`?");
}

/// A size in millimetres is one in pixels at a resolution, and type in points has that size there.
#[test]
fn sizes_for_print() {
    let scene = good(&with("size = { mm = [180, 101] }"));
    let print = scene.view.print.clone().expect("for print");
    assert_eq!((scene.view.size, print.mm, print.dpi), ([2126, 1193], [180.0, 101.0], 300.0));
    let coarse = good(&with("size = { mm = [180, 101], dpi = 100 }")).view;
    assert_eq!(coarse.size, [709, 398]);
    for dpi in [100, 300] {
        let view = good(&with(&format!("size = {{ mm = [180, 101], dpi = {dpi} }}\ntext_scale = {{ pt = 8 }}"))).view;
        // 720 lines of the reference picture are 101 mm high, and most type has 16 lines.
        let points = 16.0 * view.look.text_scale * f64::from(view.size[1]) / 720.0 * 72.0 / f64::from(dpi);
        assert!((points - 8.0).abs() < 1e-9, "{points}");
    }
    assert_eq!(good(&with("size = [640, 360]")).view.print, None);
}

#[test]
fn mistakes_of_maps_and_factors() {
    view(
        "colour = { by = 'speed', map = 'jet' }",
        "20:32 is \"jet\"; expected \"mint-indigo\", \"viridis\", \"cividis\", \"magma\", \"greys\"",
    );
    view("colour = { by = 'speed', map = 'viridiss' }", "20:32 did you mean \"viridis\"?");
    view("text_scale = 0.4", "20:14 `view.text_scale` is 0.4; expected a number from 0.5 to 3");
    view("text_scale = 3.1", "20:14 expected a number from 0.5 to 3");
    view("text_scale = '2'", "20:14 is the string \"2\"; expected a number");
    view("text_scale = { pt = 4 }", "20:21 `view.text_scale.pt` is 4; expected a number from 5 to 72");
    view("text_scale = { pt = 7 }", "20:14 type of 7 pt needs a size in print, but this picture has one in pixels");
    view("size = { mm = [180] }", "20:15 `view.size.mm` has 1 entry; expected 2");
    view("size = { mm = [4, 101] }", "20:16 `view.size.mm[0]` is 4; expected a number from 5 to 2000");
    view("size = { mm = [180, 101], dpi = 30 }", "20:33 expected a number from 72 to 1200");
    view("size = { mm = [2000, 10], dpi = 300 }", "20:8 23622 × 118 pixels at 300 dpi; expected 16 to 16384");
    view("size = { dpi = 300 }", "20:8 mm");
    view(
        "size = { mm = [40, 20] }\ntext_scale = { pt = 20 }",
        "21:14 type of 20 pt does not fit a picture of this size; expected ",
    );
    view("shadow = 'no'", "20:10 `view.shadow` is the string \"no\"; expected true or false");
}

/// The limits of type that are told can be typed.
#[test]
fn limits_of_type_that_are_told_are_allowed() {
    for size in [[40, 20], [85, 40], [85, 85], [89, 62], [180, 101]] {
        let with_type = |pt: &str| with(&format!("size = {{ mm = {size:?} }}\ntext_scale = {{ pt = {pt} }}"));
        let message = bad(&with_type("72")).mistakes()[0].message.clone();
        let told = message.split_once("expected ").and_then(|(_, limits)| limits.strip_suffix(" pt"));
        let (_, most) = told.and_then(|limits| limits.split_once(" to ")).expect("limits");
        // No picture has type below 5 pt.
        let points: f64 = most.parse().expect("a number");
        // A column of a journal can have type of 8 pt.
        assert!(size[0] < 85 || points >= 8.0, "{message}");
        match points >= 5.0 {
            true => assert!(good(&with_type(most)).view.look.text_scale > 3.8, "{message}"),
            false => assert!(size == [40, 20], "{message}"),
        }
    }
}

/// A folder with a scene that names fonts, and files beside it.
struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    fn file(&self, name: &str, bytes: &[u8]) -> &Self {
        std::fs::write(self.0.path().join(name), bytes).expect("a file");
        self
    }

    fn load(&self, font: &str) -> Result<Scene, SceneError> {
        let text = with(&format!("font = {{ {font} }}"));
        self.file("scene.toml", text.as_bytes());
        Scene::load(&self.0.path().join("scene.toml"), &Limits::default())
    }

    #[track_caller]
    fn bad(&self, font: &str, column: usize, words: &[&str]) {
        let error = self.load(font).expect_err("a mistake");
        words.iter().for_each(|words| expect(&error, 0, &format!("10:{column} {words}")));
    }
}

#[test]
fn fonts_are_found_beside_the_scene_and_count_by_what_is_in_them() {
    let place = Place::new();
    place.file("a.otf", FONT).file("b.otf", SEMI_BOLD);
    let one = place.load("regular = 'a.otf'").unwrap();
    assert_eq!(one.view.look.font.regular.as_deref(), Some(FONT));
    assert_eq!(one.view.look.font.semi_bold, None);
    let both = place.load("regular = 'a.otf', semi_bold = 'b.otf'").unwrap();
    assert_eq!(both.view.look.font.semi_bold.as_deref(), Some(SEMI_BOLD));
    let absolute = format!("regular = '{}'", place.0.path().join("a.otf").display());
    let copied = place.file("c.otf", FONT).load("regular = 'c.otf'").unwrap();
    assert_eq!(one.digest, copied.digest);
    assert_eq!(one.digest, place.load(&absolute).unwrap().digest);
    assert_ne!(one.digest, both.digest);
    assert_ne!(one.digest, place.load("regular = 'b.otf'").unwrap().digest);
    assert_ne!(one.digest, good(&with("")).digest);
    // Fonts are not printed in logs.
    assert!(format!("{:?}", one.view).len() < 5000);
}

#[cfg(feature = "render")]
#[test]
fn characters_that_no_font_has_are_told() {
    let warnings = |line: &str| {
        let told = good(&with(line)).warnings;
        told.into_iter().map(|one| (one.place, one.message)).collect::<Vec<_>>()
    };
    assert_eq!(warnings("title = 'β = 1/3, ΔT² ≤ 4 – “a”\u{200b}'"), []);
    let message = "no font has \"⅓\" (U+2153), so that its code is drawn in its place".to_owned();
    assert_eq!(warnings("title = 'β = ⅓'"), [("view.title".to_owned(), message.clone())]);
    let message =
        "no font has \"⅓\" (U+2153) and \"龍\" (U+9F8D), so that their codes are drawn in their place".to_owned();
    assert_eq!(warnings("caption = 'a ⅓ and ⅓ 龍'"), [("view.caption".to_owned(), message.clone())]);
    let named = good(&with("").replacen("name = '", "name = 'Пружины ", 1)).warnings;
    let told = named.first().map(|one| (one.place.as_str(), one.message.starts_with("no font has \"П\" (U+041F), ")));
    assert_eq!(told, Some(("run[0].name", true)), "{named:?}");
}

#[test]
fn mistakes_of_fonts() {
    let place = Place::new();
    place
        .file("sans.otf", FONT)
        .file("empty.ttf", b"")
        .file("web.woff2", b"wOF2abcd")
        .file("text.ttf", b"no font at all");
    std::fs::create_dir(place.0.path().join("folder.ttf")).unwrap();
    place.bad("regular = 'absent.ttf'", 20, &["`absent.ttf` is not there (looked for ", "absent.ttf)"]);
    place.bad("regular = 'sanz.otf'", 20, &["`sanz.otf` is not there", "did you mean \"sans.otf\"?"]);
    place.bad("regular = 'folder.ttf'", 20, &["`folder.ttf` is a folder; expected a TrueType or OpenType font"]);
    place.bad("regular = 'empty.ttf'", 20, &["`empty.ttf` is empty; expected"]);
    place.bad(
        "regular = 'text.ttf'",
        20,
        &["`text.ttf` is not a font; expected a TrueType or OpenType font (.ttf, .otf, .ttc)"],
    );
    place.bad("regular = 'web.woff2'", 20, &["`web.woff2` is a font packed for web pages (WOFF)"]);
    place.bad("regular = 'sans.otf', semi_bold = 'text.ttf'", 44, &["`text.ttf` is not a font"]);
    place.bad("regular = ''", 20, &["`view.font.regular` is empty; expected at least 1"]);
    place.bad("semi_bold = 'sans.otf'", 8, &["`view.font` has no `regular`"]);
    place.bad("regular = 'sans.otf', bold = 'sans.otf'", 32, &["unknown key `bold` in `view.font`", "`semi_bold`"]);
    let long = std::fs::File::create(place.0.path().join("long.ttf")).unwrap();
    long.set_len((64 << 20) + 1).unwrap();
    place.bad("regular = 'long.ttf'", 20, &["`long.ttf` is larger than 64 MiB, the most that a font may have"]);
    view("font = 'sans.otf'", "20:8 `view.font` is the string \"sans.otf\"; expected a table");
}

#[test]
fn fonts_that_are_damaged_or_lack_letters_are_refused() {
    let place = Place::new();
    place.file("cut.otf", &FONT[..300]).file("blank.otf", &without_letters());
    place.bad("regular = 'cut.otf'", 20, &["`cut.otf` begins like a font but is damaged or cut short"]);
    place.bad(
        "regular = 'blank.otf'",
        20,
        &["`blank.otf` has no outline for 62 of the digits and Latin letters, '0' among them"],
    );
}

/// The built-in font with an empty table of characters.
fn without_letters() -> Vec<u8> {
    let mut bytes = FONT.to_vec();
    let tables = usize::from(u16::from_be_bytes([bytes[4], bytes[5]]));
    let entry = (0..tables).map(|at| 12 + 16 * at).find(|&at| &bytes[at..at + 4] == b"cmap").expect("a font has one");
    let word = |bytes: &[u8], at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    let start = word(&bytes, entry + 8);
    // No subtable.
    bytes[start + 2..start + 4].fill(0);
    bytes
}

#[test]
fn fonts_may_lie_in_a_folder_of_their_own() {
    let place = Place::new();
    std::fs::create_dir(place.0.path().join("fonts")).unwrap();
    place.file("fonts/sans.otf", FONT);
    assert!(place.load("regular = 'fonts/sans.otf'").is_ok());
}

/// Runs to compare bodies with.
#[test]
fn ghosts_name_runs() {
    let named = |view: &str| good(&PLANE.replace("[view]\n", &format!("[view]\n{view}\n"))).view;
    assert_eq!(named("ghost = 'rest'").ghost, Some(Ghost::Rest));
    assert_eq!(named("ghost = 'Mass-spring'").ghost, Some(Ghost::Run(1)));
}

#[test]
fn mistakes_of_ghosts() {
    let view = |view: &str, expected: &str| {
        case(PLANE, "size = [640, 360]", view, expected);
    };
    view("ghost = 'Mass spring'", "20:9 there is no run \"Mass spring\" did you mean \"Mass-spring\"?");
    let all = "expected \"Local shape\", \"Mass-spring\" or \"rest\"";
    view("ghost = 'nobody'", &format!("20:9 {all}"));
    // Frames of runs with different steps are not at the same moments.
    let other_step = PLANE.replace("name = 'Mass-spring'\n", "name = 'Mass-spring'\nstep = 0.001\n");
    let ghost = |name: &str| format!("ghost = '{name}'");
    for (view, column) in [(ghost("Local shape"), 9), (ghost("Mass-spring"), 9)] {
        let text = bad(&other_step.replace("size = [640, 360]", &view));
        let [found] = text.mistakes() else { panic!("{text}") };
        assert_eq!((found.line, found.column), (21, column), "{text}");
        assert!(found.message.ends_with("their frames are not at the same moments"), "{text}");
    }
    let same = PLANE.replace("name = 'Mass-spring'", "name = 'rest'");
    case(&same, "size = [640, 360]", "ghost = 'rest'", "20:9 means the rest shape, but `run[1]` has this name, too");
}

/// A chart without a curve would show nothing.
#[test]
fn charts_of_what_no_run_has_are_refused() {
    let other = "which no run has only shape-based models in space count them; plot another diagnostic";
    let chart = |of: &str| format!("charts = ['{of}']");
    case(PLANE, "size = [640, 360]", &chart("global_rotations"), &format!("20:11 {other}"));
    good(&PLANE.replace("size = [640, 360]", &chart("residual")));
    let twice = "charts = ['energy', 'turned_over', 'energy']";
    case(
        PLANE,
        "size = [640, 360]",
        twice,
        "20:36 is \"energy\", as is `view.charts[0]` expected each diagnostic once",
    );
}

#[test]
fn paths_are_read() {
    let view = |typed: &str| PLANE.replace("size = [640, 360]", typed);
    assert_eq!(good(&view("paths = ['centre', 3]")).view.paths, [Traced::Centre, Traced::Node(3)]);
    for (typed, expected) in [
        ("paths = ['middle']", "20:10 \"middle\""),
        ("paths = [0, 4]", "20:13 there is no node 4; the body has nodes 0 to 3"),
        ("paths = [1, 'centre', 1]", "20:23 this path is listed a second time"),
    ] {
        expect(&bad(&view(typed)), 0, expected);
    }
}
