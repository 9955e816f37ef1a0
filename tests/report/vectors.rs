//! SVG files as Chromium shows them and PDF files as poppler shows them, beside the PNG files of the program.

use super::browser::Browser;
use std::path::Path;
use std::process::{Command, Stdio};

/// All figures of the paper, and a moment of each scene in the plane: the arguments that draw them.
const PICTURES: [(&str, &[&str]); 11] = [
    ("fig1", &["figure", "fig1"]),
    ("fig2", &["figure", "fig2"]),
    ("fig3", &["figure", "fig3"]),
    ("fig4a", &["figure", "fig4a"]),
    ("fig4b", &["figure", "fig4b"]),
    ("fig4c", &["figure", "fig4c"]),
    ("restore", &["figure", "restore"]),
    ("beams", &["render", "scenes/fig4a.toml", "--frames", "40"]),
    ("chain", &["render", "scenes/chain.toml", "--frames", "40"]),
    ("free-form", &["render", "scenes/free-form-plane.toml", "--frames", "40"]),
    ("wheel", &["render", "scenes/wheel.toml", "--frames", "40"]),
];
/// The largest mean difference of a channel, of 255: borders and letters are smoothed in different ways.
const NEAR: f64 = 1.0;

/// Draws a picture, if there is a device for it.
fn draw(arguments: &[&str], file: &Path) -> bool {
    let mut command = Command::new(env!("CARGO_BIN_EXE_localshape"));
    command.args(arguments).arg("-q").arg("-o").arg(file).stdin(Stdio::null());
    let output = command.output().expect("the program starts");
    let may_lack = std::env::var_os("LOCALSHAPE_REQUIRE_GPU").is_none_or(|value| value != "1");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() || output.status.code() == Some(3) && may_lack, "{arguments:?}: {told}");
    output.status.success()
}

/// The size of a PNG picture (px), and its colours in rows from the top left.
fn pixels(path: &Path) -> ([u32; 2], Vec<[u8; 3]>) {
    let file = std::io::BufReader::new(std::fs::File::open(path).expect("a picture"));
    let mut reader = png::Decoder::new(file).read_info().expect("a PNG picture");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut bytes).expect("a whole picture");
    assert_eq!(info.color_type, png::ColorType::Rgb);
    ([info.width, info.height], bytes.as_chunks().0.to_vec())
}

/// The mean difference of a channel.
fn difference(one: &[[u8; 3]], other: &[[u8; 3]]) -> f64 {
    assert_eq!(one.len(), other.len());
    let both = one.as_flattened().iter().zip(other.as_flattened());
    both.map(|(one, other)| f64::from(one.abs_diff(*other))).sum::<f64>() / (3 * one.len()) as f64
}

#[test]
fn a_browser_shows_the_same_as_the_png_file() {
    let Some(mut browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    for (name, arguments) in PICTURES {
        let [png, svg] = ["png", "svg"].map(|ending| folder.path().join(name).with_extension(ending));
        if !draw(arguments, &png) {
            localshape::internals::skipped("no graphics adapter");
            continue;
        }
        assert!(draw(arguments, &svg));
        let ([width, height], drawn) = pixels(&png);
        browser.resize([width, height]);
        let style = "<!doctype html><body style=\"margin: 0\">";
        browser.open(&format!("{style}<img width={width} height={height} src=\"file://{}\">", svg.display()));
        browser.until("the picture", "document.images[0].complete && document.images[0].naturalWidth > 0");
        let difference = difference(&drawn, &browser.pixels().1);
        assert!(difference <= NEAR, "{name}: {difference}");
    }
}

#[test]
fn a_reader_of_pdf_shows_the_same_as_the_png_file() {
    if Command::new("pdftocairo").arg("-v").stderr(Stdio::null()).status().is_err() {
        let missing = "there is no pdftocairo: `apt install poppler-utils`";
        assert!(std::env::var_os("LOCALSHAPE_REQUIRE_POPPLER").is_none_or(|value| value != "1"), "{missing}");
        localshape::internals::skipped(missing);
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    for (name, arguments) in PICTURES {
        let path = folder.path().join(name);
        let [png, pdf] = ["png", "pdf"].map(|ending| path.with_extension(ending));
        if !draw(arguments, &png) {
            localshape::internals::skipped("no graphics adapter");
            continue;
        }
        assert!(draw(arguments, &pdf));
        let ([width, height], drawn) = pixels(&png);
        let seen = folder.path().join("seen");
        let [across, down] = [width, height].map(|length| length.to_string());
        let mut shown = Command::new("pdftocairo");
        shown.args(["-png", "-singlefile", "-scale-to-x", &across, "-scale-to-y", &down]).arg(&pdf).arg(&seen);
        assert!(shown.status().expect("pdftocairo starts").success());
        let difference = difference(&drawn, &pixels(&seen.with_extension("png")).1);
        assert!(difference <= NEAR, "{name}: {difference}");
    }
}
