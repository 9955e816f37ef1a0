//! Pages in a browser: the page of a comparison, whose slider works by pointer and by keys, and animations.

mod browser;
#[cfg(feature = "render")]
mod players;
#[cfg(feature = "render")]
mod vectors;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use browser::Browser;
use localshape::internals::{Page, PicturePair};
use serde_json::json;

/// The size of pictures (px). A square of `INK` is at the left of expected pictures, at the right of actual ones.
const SIZE: [u32; 2] = [64, 48];
const SQUARE: u32 = 16;
const INK: [u8; 3] = [20, 28, 40];
const LEFT: [u32; 2] = [8, 16];
const RIGHT: [u32; 2] = [40, 16];

fn png(size: [u32; 2], pixel: impl Fn(u32, u32) -> [u8; 3]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, size[0], size[1]);
    encoder.set_color(png::ColorType::Rgb);
    let bytes: Vec<u8> =
        (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y])).flat_map(|[x, y]| pixel(x, y)).collect();
    let mut writer = encoder.write_header().expect("a PNG picture");
    writer.write_image_data(&bytes).expect("a PNG picture");
    writer.finish().expect("a PNG picture");
    file
}

/// A light gradient with a dark square at an upper left corner.
fn square_at([left, top]: [u32; 2]) -> Vec<u8> {
    png(SIZE, |x, y| {
        let is_inside = (left..left + SQUARE).contains(&x) && (top..top + SQUARE).contains(&y);
        if is_inside { INK } else { [200 + (x / 2) as u8, 200 + (y / 2) as u8, 220] }
    })
}

/// A picture that passes, or whose state moved.
fn pair(name: &str, passes: bool) -> PicturePair {
    let count = if passes { 3 } else { 512 };
    let actual = square_at(if passes { LEFT } else { RIGHT });
    let difference = png(SIZE, |x, _| if x < 32 { [255; 3] } else { [226, 102, 28] });
    PicturePair {
        name: name.into(),
        words: format!("{count} pixels differ by more than 16 of 255 (8 may)"),
        passes,
        files: [square_at(LEFT), difference, actual].map(Some),
    }
}

/// Five pictures, three of them failed, the worst first.
fn report() -> Page {
    Page {
        title: "two cubes".into(),
        passes: false,
        verdict: "state moved".into(),
        findings: vec!["state moved: Mass-spring, first at frame 20: node 12 by 310 µm".into()],
        accept: Some("localshape compare --bless goldens/two two.toml".into()),
        pictures: [40, 30, 20, 10, 0].map(|frame| pair(&format!("{frame:03}.png"), frame < 20)).into(),
        others: vec!["050.png: identical".into()],
    }
}

/// Whether all pictures in view are loaded.
const LOADED: &str = "[...document.images].every((image) => image.complete && image.naturalWidth > 0)";

/// A browser with a page open, or `None` without a browser.
fn browser_with(report: &Page) -> Option<(Browser, String)> {
    let mut browser = Browser::start()?;
    let address = browser.open(&report.html());
    browser.until("the pictures", LOADED);
    Some((browser, address))
}

/// Waits until the slider shows or hides the expected square, and the actual one.
fn until_seen(browser: &mut Browser, wanted: [bool; 2]) {
    let [left, top, width, _] = browser.place(".slider div");
    let scale = width / f64::from(SIZE[0]);
    let middle = |corner: u32| (f64::from(corner) + f64::from(SQUARE) / 2.0) * scale;
    let squares = [LEFT, RIGHT].map(|[x, y]| [left + middle(x), top + middle(y)]);
    let start = std::time::Instant::now();
    let is_ink = |colour: [u8; 3]| colour.iter().zip(INK).all(|(seen, ink)| seen.abs_diff(ink) < 12);
    while browser.colours(squares).map(is_ink) != wanted {
        assert!(start.elapsed().as_secs() < 30, "{wanted:?} is never seen");
    }
}

/// Text, style and script are small enough to be read.
#[test]
fn the_page_is_small() {
    let lines = include_str!("../../src/golden/page/page.html").lines().count();
    assert!(lines <= 300, "{lines}");
}

#[test]
fn a_page_needs_nothing_else_and_shows_everything_without_scripts() {
    let page = report().html();
    for outside in ["http:", "https:", "url(", "@import", "//cdn", "<link rel=\"stylesheet"] {
        assert!(!page.contains(outside), "the page has {outside}");
    }
    assert!(page.contains("default-src 'none'; img-src data:; style-src 'sha256-"));
    for told in ["state moved", "310 µm", "localshape compare --bless goldens/two two.toml", "050.png: identical"] {
        assert!(page.contains(told), "{told}");
    }
    assert_eq!((page.matches("<h2>✕").count(), page.matches("<img").count()), (3, 15));
    // The pictures are in their original order.
    assert!(page.contains(&format!("data:image/png;base64,{}", BASE64_STANDARD.encode(square_at(RIGHT)))));
}

const HOSTILE: &str =
    "</script><script>window.broken=1</script><!--\u{2028}<img src=x onerror=window.broken=1>{{pictures}}&\"'";

/// A report in which every typed text is hostile.
fn hostile() -> Page {
    let mut report = report();
    (report.title, report.verdict, report.accept) = (HOSTILE.into(), HOSTILE.into(), Some(HOSTILE.into()));
    (report.findings, report.others) = (vec![HOSTILE.into()], vec![HOSTILE.into()]);
    for pair in &mut report.pictures {
        pair.name.insert_str(0, HOSTILE);
        pair.words = HOSTILE.into();
    }
    report
}

#[test]
fn hostile_names_break_out_of_nothing() {
    let page = hostile().html();
    assert_eq!((page.matches("<script").count(), page.matches("</script>").count()), (1, 1));
    assert_eq!((page.matches("<img src").count(), page.matches("<!--").count()), (0, 0));
}

#[test]
fn nothing_is_fetched_and_nothing_hostile_runs() {
    let Some((mut browser, address)) = browser_with(&hostile()) else { return };
    assert_eq!(browser.text("document.querySelector('h1').textContent.trim()"), format!("{HOSTILE}: {HOSTILE}"));
    assert_eq!(browser.value("document.querySelectorAll('img[src=x]').length + Number('broken' in window)"), 0);
    let requests = browser.requests();
    assert!(requests.contains(&address), "the page itself is requested: {requests:?}");
    let foreign: Vec<_> = requests.iter().filter(|url| **url != address && !url.starts_with("data:")).collect();
    assert!(foreign.is_empty(), "{foreign:?}");
    assert_eq!(browser.complaints(), [""; 0]);
    // Nothing can be fetched either: the page refuses a picture from elsewhere.
    let refused = "new Promise((done) => { document.addEventListener('securitypolicyviolation', (event) => \
                   done(event.effectiveDirective)); new Image().src = 'http://127.0.0.1:9/x.png'; })";
    assert_eq!(browser.text(refused), "img-src");
    assert_ne!(browser.complaints(), [""; 0], "errors are seen");
}

#[test]
fn the_slider_works_by_pointer_and_by_keys() {
    let Some((mut browser, _)) = browser_with(&report()) else { return };
    // Half and half: the expected square at the left, the actual one at the right.
    until_seen(&mut browser, [true, true]);
    let [left, top, width, height] = browser.place(".slider div");
    let at = |part: f64| [left + part * width, top + 0.9 * height];
    let divider = "document.querySelector('.slider input').value";
    browser.drag(at(0.5), at(0.99));
    until_seen(&mut browser, [true, false]);
    browser.drag(at(0.99), at(0.01));
    until_seen(&mut browser, [false, true]);
    // The divider is at the pointer.
    browser.drag(at(0.01), at(0.25));
    assert!((browser.text(divider).parse::<f64>().expect("a number") - 25.0).abs() <= 1.0);
    let line = format!("parseFloat(getComputedStyle(document.querySelector('.slider div'), '::after').left) / {width}");
    assert!((browser.number(&line) - 0.25).abs() < 0.02);
    browser.press("End");
    until_seen(&mut browser, [true, false]);
    browser.press("Home");
    until_seen(&mut browser, [false, true]);
    (0..3).for_each(|_| browser.press("ArrowRight"));
    assert_eq!(browser.text(divider), "1.5");
    // Every picture has a slider, and keys reach it.
    assert_eq!(browser.value("document.querySelectorAll('.slider input').length"), 5);
    browser.press("Tab");
    assert_eq!(browser.value("[...document.querySelectorAll('.slider input')].indexOf(document.activeElement)"), 1);
    browser.press("End");
    assert_eq!(
        browser.value("[...document.querySelectorAll('.slider input')].map(({ value }) => Number(value))"),
        json!([1.5, 100, 50, 50, 50])
    );
    assert_eq!(browser.complaints(), [""; 0]);
}

#[test]
fn anything_fits_any_screen() {
    let mut odd = report();
    let [missing, extra, unreadable, large, _] = &mut odd.pictures[..] else { panic!("five pictures") };
    (missing.files[1], missing.files[2]) = (None, None);
    (extra.files[0], extra.files[1]) = (None, None);
    unreadable.files = [None, None, None];
    large.files[2] = Some(png([3000, 96], |_, _| INK));
    odd.findings.push("a_very_long_name_without_a_blank_".repeat(20));
    odd.pictures[0].name = "long".repeat(50);
    let nothing = Page { pictures: vec![], others: vec![], accept: None, ..report() };
    let many = Page { others: (0..2000).map(|at| format!("{at}.png: identical")).collect(), ..report() };
    let Some((mut browser, _)) = browser_with(&odd) else { return };
    for (report, sliders) in [(&odd, 2), (&nothing, 0), (&many, 5)] {
        for width in [320, 390, 800, 2560] {
            browser.resize([width, 844]);
            browser.open(&report.html());
            browser.until("the pictures", LOADED);
            let wide = "document.documentElement.scrollWidth - innerWidth";
            assert!(browser.number(wide) <= 0.0, "{} pictures in {width} px", report.pictures.len());
            assert_eq!(browser.value("document.querySelectorAll('.slider').length"), sliders);
            // On a phone pictures stand below each other, else side by side.
            let tops = "new Set([...document.querySelectorAll('.row:first-of-type')].slice(0, 1).flatMap((row) => \
                        [...row.children].map((figure) => figure.getBoundingClientRect().top))).size";
            let rows = if width < 700 { 3 } else { 1 };
            assert_eq!(browser.value(tops), if sliders == 0 { 0 } else { rows }, "{width} px");
            assert_eq!(browser.complaints(), [""; 0], "{} pictures in {width} px", report.pictures.len());
        }
    }
}

#[test]
fn without_scripts_everything_but_the_slider_is_shown() {
    let Some((mut browser, _)) = browser_with(&report()) else { return };
    browser.order("Emulation.setScriptExecutionDisabled", json!({ "value": true }));
    browser.open(&report().html());
    assert_eq!(browser.value("document.querySelectorAll('.slider').length"), 0);
    let told = browser.text("document.body.innerText");
    for words in ["state moved", "040.png", "512 pixels differ by more than 16 of 255"] {
        assert!(told.contains(words), "{words}: {told}");
    }
    assert_eq!(browser.value("[...document.images].filter(({ height }) => height > 0).length"), 15);
}
