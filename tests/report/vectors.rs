//! SVG files as Chromium shows them, beside the PNG files that the renderer drew.

use crate::browser::Browser;
use std::path::Path;
use std::process::{Command, Stdio};

const SIZE: [u32; 2] = [1280, 576];
/// The tolerance in uniform areas.
const NEAR: u8 = 3;

/// Draws a figure, if there is a device for it.
fn draw(folder: &Path, file: &str) -> bool {
    let mut command = Command::new(env!("CARGO_BIN_EXE_localshape"));
    command.current_dir(folder).args(["figure", "fig2", "-q", "--scale", "0.5", "-o", file]).stdin(Stdio::null());
    let output = command.output().expect("the program starts");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    let may_lack = std::env::var_os("LOCALSHAPE_REQUIRE_GPU").is_none_or(|value| value != "1");
    assert!(output.status.success() || file.ends_with("png") && may_lack, "{file}: {told}");
    output.status.success()
}

fn pixels(path: &Path) -> Vec<u8> {
    let file = std::io::BufReader::new(std::fs::File::open(path).expect("a picture"));
    let mut reader = png::Decoder::new(file).read_info().expect("a PNG picture");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut bytes).expect("a whole picture");
    assert_eq!([info.width, info.height], SIZE);
    bytes
}

#[test]
fn a_browser_shows_the_same_as_the_png_file() {
    let Some(mut browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    // Vectors of flat panels need no device.
    assert!(draw(folder, "fig2.svg"));
    if !draw(folder, "fig2.png") {
        localshape::internals::skipped("no graphics adapter");
        return;
    }
    let drawn = pixels(&folder.join("fig2.png"));
    let at = |x: u32, y: u32| {
        let at = 3 * (y * SIZE[0] + x) as usize;
        [drawn[at], drawn[at + 1], drawn[at + 2]]
    };
    browser.resize(SIZE);
    let file = folder.join("fig2.svg");
    let style = "<!doctype html><body style=\"margin: 0\">";
    let image = format!("{style}<img width={} height={} src=\"file://{}\">", SIZE[0], SIZE[1], file.display());
    browser.open(&image);
    browser.until("the picture", "document.images[0].complete && document.images[0].naturalWidth > 0");

    // In uniform areas colours are equal: bodies, ghosts, arrows, ground.
    let places: [[u32; 2]; 60 * 27] =
        std::array::from_fn(|at| [10 + 21 * (at as u32 % 60), 10 + 21 * (at as u32 / 60)]);
    let seen = browser.colours(places.map(|[x, y]| [f64::from(x), f64::from(y)]));
    let is_plain = |&[x, y]: &[u32; 2]| (0..49).all(|step| at(x - 3 + step % 7, y - 3 + step / 7) == at(x, y));
    let plain: Vec<_> = places.iter().zip(seen).filter(|(place, _)| is_plain(place)).collect();
    assert!(plain.len() > 1000);
    for (&[x, y], seen) in plain {
        let near = at(x, y).iter().zip(seen).all(|(one, other)| one.abs_diff(other) <= NEAR);
        assert!(near, "at {x}, {y}: drawn {:?}, seen {seen:?}", at(x, y));
    }

    // The name of the first model, in the embedded font: as much ink at the same place, column by column.
    const NAME: [u32; 4] = [28, 32, 130, 36];
    let places: [[f64; 2]; 130 * 36] =
        std::array::from_fn(|at| [NAME[0] + at as u32 % NAME[2], NAME[1] + at as u32 / NAME[2]].map(f64::from));
    let seen = browser.colours(places);
    let ink = |colour: [u8; 3]| f64::from(255 - colour[1]) / 255.0;
    // Ten columns together, because borders are smoothed differently.
    let mut columns = [[0.0; 13]; 2];
    for (&[x, y], seen) in places.iter().zip(seen) {
        let column = (x as u32 - NAME[0]) as usize / 10;
        columns[0][column] += ink(at(x as u32, y as u32));
        columns[1][column] += ink(seen);
    }
    let most = columns[0].iter().copied().fold(0.0, f64::max);
    assert!(most > 60.0, "letters are there: {columns:?}");
    let [drawn, seen] = columns;
    assert!(drawn.iter().zip(seen).all(|(one, other)| (one - other).abs() < 0.2 * most), "{drawn:?} {seen:?}");
}
