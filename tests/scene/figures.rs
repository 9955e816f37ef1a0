//! Figure files: every mistake is reported at its position, with a helpful message.

use super::expect;
use localshape::look::Theme;
use localshape::scene::figure::built_in::NAMES;
use localshape::scene::figure::{Content, Figure, Sheet};
use localshape::scene::{Limits, Scene, SceneError, description};
use std::path::Path;

/// Reads a figure beside the scene `fig4b.toml` of 3 s, a scene in the plane and one without a run `Mass-spring`.
fn load(text: &str) -> Result<Figure, SceneError> {
    let folder = tempfile::tempdir().expect("a folder");
    let lone = "time.duration = 1\nbody.lattice = { cells = [1, 1, 1], side = 1 }\n\
                run = [{ name = 'Local shape', model = { kind = 'shape-based', stiffness = 1 } }]\n";
    for (name, scene) in [
        ("fig4b.toml", super::shipped("fig4b.toml")),
        ("fig4a.toml", super::shipped("fig4a.toml")),
        ("lone.toml", lone.to_owned()),
        ("broken.toml", "time.duration = -1\n".to_owned()),
        ("figure.toml", text.to_owned()),
    ] {
        std::fs::write(folder.path().join(name), scene).expect("a file");
    }
    Figure::load(&folder.path().join("figure.toml"), &Limits::default())
}

fn sheet(text: &str) -> Sheet {
    match load(text).map(|figure| figure.content) {
        Ok(Content::Sheet(sheet)) => sheet,
        Ok(Content::Forces(_)) => panic!("no sheet"),
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn every_mistake_is_said_where_it_is() {
    let cases: &[(&str, &str)] = &[
        ("title = 'x'", "1:1 the figure shows nothing: expected a table `[sheet]` or `[forces]`"),
        ("[sheet]\nscene = 'fig4b.toml'\nmoments = [0]\n[forces]\nscenes = ['fig4b.toml']", "1:1 keep one of them"),
        ("[sheet]\nscene = 'fig4b.toml'\nmoment = [0]", "3:1 unknown key `moment` in `sheet`"),
        ("[sheet]\nscene = 'fig4b.toml'", "1:1 the sheet has no columns: expected `moments` or `[[sheet.column]]`"),
        ("[sheet]\nscene = 'fig4b.toml'\nmoments = []", "3:11 `sheet.moments`"),
        (
            "text_scale = 0.4\n[sheet]\nscene = 'fig4b.toml'\nmoments = [0]",
            "1:14 `text_scale` is 0.4; expected a number from 0.5 to 3",
        ),
        (
            "text_scale = 3.1\n[forces]\nscenes = ['fig4b.toml']",
            "1:14 `text_scale` is 3.1; expected a number from 0.5 to 3",
        ),
        ("[sheet]\nscene = 'nowhere.toml'\nmoments = [0]", "2:9 nowhere.toml: there is no such file"),
        ("[sheet]\nmoments = [0]", "2:1 the moments have no `scene`"),
        ("[sheet]\n[[sheet.column]]\ntime = 0", "2:1 the column has no scene: expected `scene` here or in `[sheet]`"),
        (
            "[sheet]\nscene = 'fig4b.toml'\nmoments = [0]\n[[sheet.column]]\ntime = 0",
            "3:1 both `moments` and `column` are given",
        ),
        ("[sheet]\nscene = 'fig4b.toml'\nmoments = [0, 3.5]", "3:15 ends at 3 s; expected a moment up to then"),
        ("[sheet]\nscene = 'fig4b.toml'\n[[sheet.column]]\ntime = 9", "4:8 ends at 3 s"),
        ("[sheet]\nscene = 'fig4b.toml'\nmoments = [-1]", "3:12 expected a number of at least 0"),
        (
            "[sheet]\nscene = 'fig4b.toml'\n[[sheet.column]]\nlabel = 'x'",
            "3:1 the column has no `time`, and neither has the row “Local shape”",
        ),
        (
            "[sheet]\nscene = 'fig4b.toml'\nmoments = [0]\n[[sheet.row]]\nrun = 'Local shap'",
            "5:7 has no run “Local shap”; its runs are “Local shape” and “Mass-spring”",
        ),
        (
            "[sheet]\n[[sheet.column]]\nscene = 'fig4b.toml'\ntime = 0\n[[sheet.column]]\nscene = 'lone.toml'\ntime = 0",
            "1:1 has no run “Mass-spring”; its runs are “Local shape”",
        ),
        (
            "[sheet]\nscene = 'fig4b.toml'\n[[sheet.column]]\n[[sheet.row]]\nrun = 'Local shape'\ntime = 4",
            "6:8 ends at 3 s",
        ),
        (
            "[sheet]\nscene = 'fig4b.toml'\nmoments = [0]\nstrips = ['energy']",
            "4:1 unknown key `strips` in `sheet` known here: ",
        ),
        ("[sheet]\nscene = 'fig4b.toml'\nmoments = [0]\ncharts = ['shape_eror']", "4:11 did you mean \"shape_error\"?"),
        (
            "[sheet]\ncharts = ['energy']\n[[sheet.column]]\nscene = 'fig4b.toml'\ntime = 0\n[[sheet.column]]\n\
             scene = 'fig4a.toml'\ntime = 0",
            "2:1 charts over several scenes have one axis of time, but “3×3×3 cubes dropped on a floor” ends at 3 s",
        ),
        (
            "[sheet]\nscene = 'fig4b.toml'\nmoments = [0, 1]\ncharts = ['energy']\nfrom = 0.5",
            "5:8 the axis of time begins at 0.5 s, but there is a moment at 0 s",
        ),
        (
            "[sheet]\nscene = 'fig4b.toml'\nmoments = [3]\ncharts = ['energy']\nfrom = 4",
            "5:8 but the scene ends at 3 s",
        ),
        (
            "[sheet]\nscene = 'fig4b.toml'\nmoments = [1]\ncharts = ['energy']\nfrom = 0.5\nsplit = 0.5",
            "6:9 goes from 0.5 to 3 s; expected a moment between, found 0.5",
        ),
        (
            "[sheet]\nscene = 'fig4b.toml'\nmoments = [1]\ncharts = ['energy', 'energy']",
            "4:21 `sheet.charts[1]` is \"energy\", as is `sheet.charts[0]`",
        ),
        (
            "[sheet]\nscene = 'fig4b.toml'\nmoments = [1]\nsplit = 1",
            "4:1 `sheet.split` is about charts, but there are none",
        ),
        (
            "[sheet]\nscene = 'fig4b.toml'\nmoments = [1]\n[[sheet.row]]\nrun = 'Mass-spring'\ntime = 2",
            "6:1 both a row and a column give the moment of the same picture",
        ),
        (
            "[sheet]\nscene = 'fig4b.toml'\ncharts = ['energy']\n[[sheet.column]]\n[[sheet.row]]\nrun = 'Mass-spring'\ntime = 2",
            "7:1 charts mark the moments of columns",
        ),
        ("[forces]\nscenes = ['fig4b.toml', 'none.toml']", "2:25 none.toml: there is no such file"),
        ("[forces]\nscenes = ['fig4b.toml']\ncompare = 'Local shap'", "3:11 did you mean “Local shape”?"),
        ("[forces]\nscenes = ['fig4b.toml']\nnotes = ['a', 'b', 'c']", "3:9 more notes (3) than runs (2)"),
    ];
    for &(text, expected) in cases {
        let Err(error) = load(text) else { panic!("this was taken for a good figure:\n{text}") };
        expect(&error, 0, expected);
    }
}

#[test]
fn type_is_as_large_as_the_figure_or_else_its_first_scene_says() {
    let sheet = "[sheet]\nscene = 'fig4b.toml'\nmoments = [0]";
    let scale = |text: &str| load(text).unwrap_or_else(|error| panic!("{error}")).look.text_scale;
    assert_eq!(scale(sheet), 1.0);
    assert_eq!(scale(&format!("text_scale = 1.5\n{sheet}")), 1.5);
    let mut dark = load(&format!("text_scale = 2\n{sheet}")).unwrap_or_else(|error| panic!("{error}"));
    dark.set_theme(Theme::Dark);
    assert_eq!((dark.look.text_scale, dark.look.theme), (2.0, Theme::Dark));
}

#[test]
fn mistakes_in_a_scene_are_shown_in_the_scene() {
    let Err(error) = load("[sheet]\nscene = 'broken.toml'\nmoments = [0]") else { panic!("a broken scene") };
    assert!(error.to_string().contains("broken.toml:1:"), "{error}");
}

#[test]
fn what_is_not_said_follows_from_the_scene() {
    let found = sheet("[sheet]\nscene = 'fig4b.toml'\nmoments = [0, 1.5]");
    let rows: Vec<_> = found.rows.iter().map(|row| (row.run.as_str(), row.label.as_str())).collect();
    assert_eq!(rows, [("Local shape", "Local shape"), ("Mass-spring", "Mass-spring")]);
    assert_eq!((found.scenes.len(), found.columns.len(), found.from, found.split), (1, 2, 0.0, None));
    assert_eq!(found.cell(1, 1), (0, 1, 1.5));
    // Rows may give the moments, and a scene that is named twice is read once.
    let found = sheet(
        "[sheet]\nscene = 'fig4b.toml'\n[[sheet.column]]\n[[sheet.column]]\nscene = 'fig4b.toml'\n\
         [[sheet.row]]\nrun = 'Mass-spring'\ntime = 0.5",
    );
    assert_eq!((found.scenes.len(), found.cell(0, 1)), (1, (0, 1, 0.5)));
}

#[test]
fn figures_of_the_program_are_those_in_the_folder() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("figures");
    for name in NAMES {
        let there = Figure::load(&folder.join(name).with_extension("toml"), &Limits::default());
        let there = there.unwrap_or_else(|error| panic!("{error}"));
        let within = Figure::built_in(name).expect("one of the names");
        // All resolved values, except positions in the file. NaN is not equal to itself, so texts are compared.
        let [there, within] = [there, within].map(|figure| {
            let files = figure.scenes().iter().filter_map(|scene| scene.file.clone());
            let text = format!("{figure:?}");
            files.fold(text, |text, file| text.replace(&format!("file: {:?}", Some(file)), "file: None"))
        });
        let [there, within] = [there, within].map(|text| text.replace(", ", ",\n"));
        let differs = there.lines().zip(within.lines()).find(|(one, other)| one != other);
        assert!(there == within, "{name}: {differs:?}");
    }
}

/// A caption repeats numbers of its scenes; they must agree.
#[test]
fn captions_say_what_the_scenes_are() {
    for name in ["fig4a", "fig4b", "fig4c", "restore"] {
        let figure = Figure::built_in(name).expect("one of the names");
        let caption = figure.caption.to_lowercase();
        let mut parts = 0;
        let mut says = |what: String| {
            assert!(caption.contains(&what.to_lowercase()), "{name}: {what:?} is not in {:?}", figure.caption);
            parts += 1;
        };
        for scene in figure.scenes() {
            for run in &scene.runs {
                let words = description(run.models[0].as_ref(), &scene.bodies[0].body);
                let part =
                    |name: &str| words.split(", ").find_map(|part| part.strip_prefix(name)).expect("a parameter");
                says(format!("stiffness {},", part("k = ")));
                says(format!("damping ratio {},", part("ζ = ")));
            }
            assert!(scene.bodies[0].body.mass().iter().all(|&mass| mass == scene.bodies[0].body.mass()[0]));
            says(format!("{} kg per node,", scene.bodies[0].body.mass()[0]));
            for obstacle in &scene.obstacles {
                if obstacle.restitution > 0.0 {
                    says(format!("restitution {},", obstacle.restitution));
                }
                says(format!("friction {}.", obstacle.friction));
            }
            assert_eq!(scene.gravity == glam::DVec3::ZERO, caption.contains("no gravity"));
        }
        assert!(parts >= 6, "{name}");
    }
    // "dropped from … m", and how long that takes.
    let lowest = |scene: &Scene| scene.runs[0].initial.position.iter().fold(f64::INFINITY, |low, at| low.min(at.y));
    let figure = Figure::built_in("fig4a").expect("one of the names");
    let scene = &figure.scenes()[0];
    let (height, gravity) = (lowest(scene), -scene.gravity.y);
    assert!(figure.title.contains(&format!("dropped from {height} m")), "{}", figure.title);
    let fall = format!("the fall takes {:.2} s", (2.0 * height / gravity).sqrt());
    assert!(figure.caption.contains(&fall), "{fall}: {}", figure.caption);
    let figure = Figure::built_in("fig4b").expect("one of the names");
    let scene = &figure.scenes()[0];
    assert_eq!(lowest(scene), 0.0);
    let height = scene.runs[0].initial.velocity[0].y.powi(2) / (-2.0 * scene.gravity.y);
    assert!(figure.title.contains(&format!("dropped from {height:.0} m")), "{}", figure.title);
    assert!((height - height.round()).abs() < 1e-3, "{height}");
}
