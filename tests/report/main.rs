//! What a browser shows: the page of a comparison, which can be used by pointer and by keys, and animations.

mod browser;
#[cfg(feature = "render")]
mod players;
#[cfg(feature = "render")]
mod vectors;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use browser::{Browser, PLAIN, SHIFT};
use localshape::internals::{Displacement, FrameDifference, RunDifference};
use localshape::internals::{PicturePair, Report};
use serde_json::{Value, json};

/// Pictures are so large (px). A square of `INK` lies at the left of the expected ones, at the right of the actual ones.
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

/// A light gradient with a dark square whose upper left corner is given.
fn square_at([left, top]: [u32; 2]) -> Vec<u8> {
    png(SIZE, |x, y| {
        let is_inside = (left..left + SQUARE).contains(&x) && (top..top + SQUARE).contains(&y);
        if is_inside { INK } else { [200 + (x / 2) as u8, 200 + (y / 2) as u8, 220] }
    })
}

/// A picture that passes, or whose state moved.
fn sheet(name: &str, frame: Option<u64>, passes: bool) -> PicturePair {
    let visible = if passes { 3 } else { 512 };
    PicturePair {
        name: name.into(),
        frame,
        time: frame.map(|frame| frame as f64 / 60.0),
        verdict: if passes { "same state, pixels within tolerance" } else { "state moved" }.into(),
        words: format!("{visible} pixels differ by more than 2 of 255; 8 may"),
        passes,
        visible: Some(visible),
        allowed: Some(8),
        size: Some(SIZE),
        expected: Some(square_at(LEFT)),
        actual: Some(square_at(if passes { LEFT } else { RIGHT })),
        difference: Some(png(SIZE, |x, _| if x < 32 { [255; 3] } else { [226, 102, 28] })),
        distances: None,
    }
}

/// Two runs; the second one moves from frame 20 on, at first by less than the precision and at last by an unknown distance.
fn runs(frames: u64) -> Vec<RunDifference> {
    let run = |run: &str, moved_from: u64| {
        let moment = |frame: u64| {
            let moved = frame >= moved_from;
            let far = 1e-10 * 1.6_f64.powi(frame.saturating_sub(moved_from) as i32);
            let is_known = moved && frame < 38;
            let displacement = is_known.then_some(Displacement {
                frame,
                node: 12,
                distance: far,
                of_shape: 0.5 * far,
                precision: 1e-9,
            });
            FrameDifference { frame, time: Some(frame as f64 / 60.0), moved, displacement }
        };
        RunDifference { run: run.into(), precision: 1e-9, moments: (0..frames).map(moment).collect() }
    };
    vec![run("Local shape", u64::MAX), run("Mass-spring", 20)]
}

/// A sequence of 41 frames with five pictures, of which three failed.
fn sequence() -> Report {
    let pictures = [0, 10, 20, 30, 40].map(|frame| sheet(&format!("{frame:03}.png"), Some(frame), frame < 20));
    Report {
        title: "two cubes".into(),
        expected: "goldens/two".into(),
        actual: "output/two".into(),
        passes: false,
        verdict: "state moved".into(),
        findings: vec!["Mass-spring: first at frame 20; node 12 is off by 3.1e-4 m at frame 37".into()],
        accept: Some("localshape accept goldens/two output/two".into()),
        drawn_by: [Some("one adapter".into()), None],
        runs: runs(41),
        pictures: pictures.into(),
        first: 2,
    }
}

/// The name of the present picture.
const NAME: &str = "document.getElementById('name').textContent";
/// Which mode is on.
const MODE: &str = "document.querySelector('#modes [aria-pressed=true]').dataset.mode";
/// Whether all pictures in view are loaded.
const LOADED: &str = "[...document.images].every((image) => image.complete && image.naturalWidth > 0)";
/// Whether the charts are drawn, which happens at the first frame of the page.
const CHARTS: &str = "document.querySelector('#charts text') !== null";

/// A browser with a page open, or `None` where there is no browser.
fn browser_with(report: &Report, hash: &str) -> Option<(Browser, String)> {
    let mut browser = Browser::start()?;
    let address = browser.open(&report.page(), hash);
    browser.until("the pictures", LOADED);
    Some((browser, address))
}

/// The places in the window where the square of the expected pictures lies, and where that of the actual ones does.
fn squares(browser: &mut Browser) -> [[f64; 2]; 2] {
    browser.until("the pictures", LOADED);
    let [left, top, width, _] = browser.place("#stage img");
    let scale = width / f64::from(SIZE[0]);
    let middle = |corner: u32| (f64::from(corner) + f64::from(SQUARE) / 2.0) * scale;
    [LEFT, RIGHT].map(|[x, y]| [left + middle(x), top + middle(y)])
}

/// Whether the expected square is seen, and whether the actual one is.
fn seen(browser: &mut Browser, squares: [[f64; 2]; 2]) -> [bool; 2] {
    browser.colours(squares).map(|colour| colour.iter().zip(INK).all(|(seen, ink)| seen.abs_diff(ink) < 12))
}

/// Waits until exactly so much is seen.
fn until_seen(browser: &mut Browser, squares: [[f64; 2]; 2], wanted: [bool; 2]) {
    let start = std::time::Instant::now();
    while seen(browser, squares) != wanted {
        assert!(start.elapsed().as_secs() < 30, "{wanted:?} is never seen");
    }
}

/// The JSON that stands in a page.
fn data(page: &str) -> Value {
    let json = page.split("id=\"data\">").nth(1).and_then(|rest| rest.split("</script>").next());
    serde_json::from_str(json.expect("the data")).expect("JSON")
}

#[test]
fn a_page_needs_nothing_else_and_shows_its_verdict_without_scripts() {
    let page = sequence().page();
    for outside in ["http:", "https:", "url(http", "@import", "//cdn", "src=\"", "<link rel=\"stylesheet"] {
        assert!(!page.contains(outside), "the page has {outside}");
    }
    assert!(page.contains("default-src 'none'; img-src data:; style-src 'sha256-"));
    for told in ["state moved", "3.1e-4 m<", "localshape accept goldens/two output/two", "one adapter"] {
        assert!(page.split("<noscript>").next().is_some_and(|head| head.contains(told)), "{told}");
    }
    let without = page.split("<noscript>").nth(1).and_then(|rest| rest.split("</noscript>").next()).expect("a list");
    assert_eq!(without.matches("<li>✕").count(), 3);
    assert!(without.contains("<code>040.png</code> 512 pixels differ"));
    // The pictures are in the data as they came.
    let address = data(&page)["pictures"][4]["actual"].as_str().expect("a picture").to_owned();
    let bytes = BASE64_STANDARD.decode(address.strip_prefix("data:image/png;base64,").expect("a PNG picture"));
    assert_eq!(bytes.expect("base64"), square_at(RIGHT));
}

const HOSTILE: &str =
    "</script><script>window.broken=1</script><!--\u{2028}\u{2029}<img src=x onerror=window.broken=1>{{data}}&\"'";

/// A report in which everything that is typed is hostile.
fn hostile() -> Report {
    let mut report = sequence();
    for text in [&mut report.title, &mut report.expected, &mut report.actual, &mut report.verdict] {
        *text = HOSTILE.into();
    }
    report.findings = vec![HOSTILE.into()];
    report.accept = Some(HOSTILE.into());
    report.drawn_by = [Some(HOSTILE.into()), Some(HOSTILE.into())];
    report.runs[1].run = HOSTILE.into();
    for sheet in &mut report.pictures {
        sheet.name.insert_str(0, HOSTILE);
        sheet.words = HOSTILE.into();
        sheet.verdict = HOSTILE.into();
    }
    report
}

#[test]
fn hostile_names_break_out_of_nothing() {
    let page = hostile().page();
    assert_eq!((page.matches("<script").count(), page.matches("</script>").count()), (2, 2));
    assert_eq!((page.matches("<img src").count(), page.matches("<!--").count()), (0, 0));
    assert_eq!(data(&page)["pictures"][0]["words"], HOSTILE);
    assert_eq!(data(&page)["runs"][1]["run"], HOSTILE);
}

#[test]
fn nothing_is_fetched_and_nothing_hostile_runs() {
    let Some((mut browser, address)) = browser_with(&hostile(), "") else { return };
    assert_eq!(browser.text("document.querySelector('h1').textContent.trim()"), HOSTILE);
    for key in ["1", "2", "3", "ArrowLeft", "ArrowRight", "?", "Escape"] {
        browser.press(key, PLAIN);
    }
    assert_eq!(browser.value("document.querySelectorAll('img[src=x]').length + Number('broken' in window)"), 0);
    let requests = browser.requests();
    assert!(requests.contains(&address), "the page itself is requested: {requests:?}");
    let foreign: Vec<_> = requests.iter().filter(|url| **url != address && !url.starts_with("data:")).collect();
    assert!(foreign.is_empty(), "{foreign:?}");
    assert_eq!(browser.complaints(), [""; 0]);
    // Nor could anything be fetched: a picture from elsewhere is refused by the page itself.
    let refused = "new Promise((done) => { document.addEventListener('securitypolicyviolation', (event) => \
                   done(event.effectiveDirective)); new Image().src = 'http://127.0.0.1:9/x.png'; })";
    assert_eq!(browser.text(refused), "img-src");
    assert_ne!(browser.complaints(), [""; 0], "errors are seen");
}

#[test]
fn it_works_by_keys_and_by_pointer() {
    let Some((mut browser, _)) = browser_with(&sequence(), "") else { return };
    it_works_by_keys(&mut browser);
    browser.open(&sequence().page(), "");
    browser.until("the pictures", LOADED);
    it_works_by_pointer(&mut browser);
}

fn it_works_by_keys(browser: &mut Browser) {
    assert_eq!(browser.text(NAME), "020.png", "what the report says is shown first");
    for (key, held, name) in [
        ("ArrowRight", PLAIN, "030.png"),
        ("ArrowLeft", PLAIN, "020.png"),
        ("ArrowLeft", PLAIN, "010.png"),
        ("]", PLAIN, "020.png"),
        ("ArrowRight", SHIFT, "030.png"),
        ("[", PLAIN, "020.png"),
        ("[", PLAIN, "020.png"),
        // Among those that failed there is nothing before it.
        ("f", PLAIN, "020.png"),
        ("ArrowLeft", PLAIN, "020.png"),
        ("f", PLAIN, "020.png"),
        ("ArrowLeft", PLAIN, "010.png"),
    ] {
        browser.press(key, held);
        assert_eq!(browser.text(NAME), name, "after {key}");
    }
    for (key, mode) in [("2", "slider"), ("3", "blink"), ("1", "side"), ("v", "slider"), ("b", "blink"), ("v", "side")]
    {
        browser.press(key, PLAIN);
        assert_eq!(browser.text(MODE), mode, "after {key}");
        // The colours of the difference are explained where it is shown.
        let room = browser.number("document.getElementById('difference-key').getBoundingClientRect().height");
        assert_eq!(room > 0.0, mode == "side", "after {key}");
    }
    // Of pictures that a held key passes only the last is announced to screen readers.
    let told = browser.value(
        "new Promise((done) => { \
         new MutationObserver((records) => done(records.flatMap(({ addedNodes }) => [...addedNodes].map((node) => node.data)))) \
         .observe(document.getElementById('announced'), { childList: true }); \
         for (const key of ['ArrowLeft', 'ArrowRight', 'ArrowRight', 'ArrowLeft']) \
         document.body.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true })); })",
    );
    assert_eq!(told, json!(["010.png: 3 pixels differ by more than 2 of 255; 8 may"]));
    // Zoom, from what fits to one to one and back; a view larger than its pane is moved about in.
    let scale = "document.getElementById('scale').textContent";
    let fit = browser.text(scale);
    browser.press("z", PLAIN);
    assert_eq!(browser.text(scale), "100 %");
    (0..20).for_each(|_| browser.press("+", PLAIN));
    assert_eq!(browser.text(scale), "1600 %");
    assert_eq!(browser.text("getComputedStyle(document.images[0]).imageRendering"), "pixelated");
    let shift = "new DOMMatrix(getComputedStyle(document.images[0]).transform).e";
    let before = browser.number(shift);
    browser.press("d", PLAIN);
    assert!(browser.number(shift) < before);
    assert_eq!(
        browser.value("new Set([...document.images].map((image) => getComputedStyle(image).transform)).size"),
        1
    );
    browser.press("-", PLAIN);
    assert_eq!(browser.text(scale), "1200 %");
    browser.press("0", PLAIN);
    assert_eq!(browser.text(scale), fit);
    browser.press("?", PLAIN);
    assert_eq!(browser.value("document.getElementById('keys').open"), true);
    browser.press("ArrowRight", PLAIN);
    assert_eq!(browser.text(NAME), "010.png", "while the keys are shown, they do nothing else");
    browser.press("Escape", PLAIN);
    assert_eq!(browser.value("document.getElementById('keys').open"), false);

    // Arrows move what has the focus. In the strip they go from frame to frame, and Enter chooses the nearest picture.
    browser.tab_to("strip");
    let told = "document.getElementById('strip').getAttribute('aria-valuetext')";
    (0..7).for_each(|_| browser.press("ArrowRight", PLAIN));
    let words = browser.text(told);
    assert!(words.starts_with("Frame 17 at 283.3 ms") && words.contains("Mass-spring: same state"), "{words}");
    assert_eq!(browser.text(NAME), "010.png");
    browser.press("Enter", PLAIN);
    assert_eq!(browser.text(NAME), "020.png");
    assert!(browser.text(told).contains("Mass-spring: moved by less than 1 nm"));
    browser.press("End", PLAIN);
    assert_eq!(browser.text(NAME), "040.png");
    assert!(browser.text(told).contains("Mass-spring: moved, distance unknown"));
    // On the slider they move the divider, and no other picture is shown.
    browser.press("2", PLAIN);
    browser.tab_to("divider");
    browser.press("Home", PLAIN);
    (0..3).for_each(|_| browser.press("ArrowRight", PLAIN));
    assert_eq!(browser.text("document.getElementById('divider').value"), "1.5");
    assert_eq!(browser.text(NAME), "040.png");
    browser.press("1", PLAIN);
    assert_eq!(browser.text(MODE), "side", "keys that a slider does not use go on working");
    // In the list, too.
    browser.tab_to("list");
    browser.press("Home", PLAIN);
    assert_eq!(browser.text(NAME), "000.png");
    browser.press("ArrowRight", PLAIN);
    assert_eq!(browser.text("document.getElementById('list').selectedOptions[0].textContent"), "✓ 010.png");
    // Buttons are pressed by the keys that press buttons.
    browser.press("3", PLAIN);
    browser.tab_to("run");
    browser.press(" ", PLAIN);
    assert_eq!(browser.text("document.getElementById('run').textContent"), "Start");
    assert_eq!(browser.complaints(), [""; 0]);
}

/// Both in one browser, whose start takes longer than either.
#[test]
fn pictures_lie_over_each_other() {
    let Some((mut browser, _)) = browser_with(&sequence(), "#picture=030.png&mode=slider") else { return };
    the_slider_uncovers_the_other_picture(&mut browser);
    browser.open(&sequence().page(), "#picture=040.png&mode=blink");
    the_blink_blinks(&mut browser);
}

fn the_slider_uncovers_the_other_picture(browser: &mut Browser) {
    assert_eq!((browser.text(NAME), browser.text(MODE)), ("030.png".into(), "slider".into()));
    let places = squares(browser);
    // Half and half: the expected square at the left, the actual one at the right.
    until_seen(browser, places, [true, true]);
    let [left, top, width, height] = browser.place(".view");
    let at = |part: f64| [left + part * width, top + 0.9 * height];
    browser.drag(at(0.5), at(0.99));
    until_seen(browser, places, [true, false]);
    browser.drag(at(0.99), at(0.01));
    until_seen(browser, places, [false, true]);
    browser.tab_to("divider");
    browser.press("End", PLAIN);
    until_seen(browser, places, [true, false]);
    // In a picture that is larger than its view it is taken hold of near the divider; elsewhere the picture is moved.
    (0..3).for_each(|_| browser.press("+", PLAIN));
    let [left, top, width, height] = browser.place(".view");
    let at = |part: f64| [left + part * width, top + 0.9 * height];
    let shift = "new DOMMatrix(getComputedStyle(document.images[0]).transform).e";
    let before = browser.number(shift);
    browser.drag(at(0.5), at(0.4));
    assert!((browser.number(shift) - (before - 0.1 * width)).abs() <= 2.0);
    assert_eq!(browser.text("document.getElementById('divider').value"), "100");
    browser.drag(at(0.995), at(0.25));
    assert!((browser.number("Number(document.getElementById('divider').value)") - 25.0).abs() < 1.0);
    assert_eq!(browser.complaints(), [""; 0]);
}

fn the_blink_blinks(browser: &mut Browser) {
    let places = squares(browser);
    for wanted in [[true, false], [false, true], [true, false]] {
        until_seen(browser, places, wanted);
    }
    // Stopped, it stays at what it says that it shows; by hand, the other one comes.
    browser.press("b", PLAIN);
    assert_eq!(browser.text("document.getElementById('run').textContent"), "Start");
    let shown = "document.getElementById('stage').dataset.shown";
    for _ in 0..3 {
        let wanted = match browser.text(shown).as_str() {
            "expected" => [true, false],
            other => [false, other == "actual"],
        };
        until_seen(browser, places, wanted);
        browser.press(" ", PLAIN);
    }
    // Who asks for less motion stops it, and starts it himself.
    browser.press("b", PLAIN);
    assert_eq!(browser.text("document.getElementById('run').textContent"), "Stop");
    browser.pretend("prefers-reduced-motion", "reduce");
    browser.until("a stop", "document.getElementById('run').textContent === 'Start'");
    browser.open(&sequence().page(), "#picture=040.png&mode=blink");
    assert_eq!(browser.text("document.getElementById('run').textContent"), "Start");
    assert_eq!(browser.text(shown), "expected");
    browser.press(" ", PLAIN);
    assert_eq!(browser.text(shown), "actual");
    browser.click_on("#run");
    browser.until("blinking", &format!("{shown} === 'expected'"));
    assert_eq!(browser.complaints(), [""; 0]);
}

fn it_works_by_pointer(browser: &mut Browser) {
    // The strip: numbers under the pointer, the nearest picture by a click.
    browser.until("the charts", CHARTS);
    let [left, top, width, height] = browser.place("#strip");
    browser.point([left + width - 20.0, top + height / 2.0]);
    assert!(browser.text("document.getElementById('reading').textContent").starts_with("Frame 40"));
    browser.click([left + width - 40.0, top + height / 2.0]);
    assert_eq!(browser.text(NAME), "040.png");
    browser.press("ArrowLeft", PLAIN);
    assert_eq!(browser.text(NAME), "030.png", "after a click arrows go on choosing pictures");
    browser.click_on("#list option:nth-child(2)");
    assert_eq!(browser.text(NAME), "010.png");
    browser.click_on("#only");
    assert_eq!(browser.text(NAME), "020.png");
    assert_eq!(browser.value("document.querySelectorAll('#list option').length"), 3);
    browser.until("an address that leads here", "location.hash === '#picture=020.png&mode=side'");

    // The wheel enlarges with Ctrl, and what is under the pointer stays there.
    browser.until("the pictures", LOADED);
    let [left, top, width, height] = browser.place("figure:nth-child(2) .view");
    let pointer = [left + 0.3 * width, top + 0.6 * height];
    let under = format!(
        "(() => {{ const box = document.images[1].getBoundingClientRect(); return ({} - box.left) / box.width; }})()",
        pointer[0]
    );
    let before = browser.number(&under);
    let enlarged = "parseFloat(document.getElementById('scale').textContent)";
    let fit = browser.number(enlarged);
    browser.wheel(pointer, -120.0);
    browser.until("the zoom", &format!("{enlarged} > {}", 1.3 * fit));
    assert!((browser.number(&under) - before).abs() < 0.01);
    let shifts = "[...document.images].map((image) => new DOMMatrix(getComputedStyle(image).transform).e)";
    let before = browser.value(shifts);
    browser.drag(pointer, [pointer[0] + 20.0, pointer[1]]);
    let after = browser.value(shifts);
    for side in 0..3 {
        let moved = after[side].as_f64().unwrap_or_default() - before[side].as_f64().unwrap_or_default();
        assert!((moved - 20.0).abs() <= 1.0, "all views move together: {before} {after}");
    }
    browser.click_on("#fit");
    assert_eq!(browser.number(enlarged), fit);

    // The command is copied, or at least selected.
    browser.click_on("#copy");
    let told = "document.getElementById('announced').textContent";
    browser.until("the command", &format!("['Copied', 'Selected'].includes({told})"));
    if browser.text(told) == "Selected" {
        assert_eq!(browser.text("getSelection().toString()"), "localshape accept goldens/two output/two");
    }
    browser.until("the button as it was", "document.getElementById('copy').textContent === 'Copy'");
    assert_eq!(browser.complaints(), [""; 0]);
}

#[test]
fn what_is_not_there_is_said_and_nothing_is_too_much() {
    let mut report = sequence();
    let [one, two, three, four, _] = &mut report.pictures[..] else { panic!("five pictures") };
    (one.verdict, one.actual, one.difference, one.passes) = ("missing".into(), None, None, false);
    (two.verdict, two.expected, two.difference, two.visible) = ("extra".into(), None, None, None);
    two.actual = Some(b"no picture".into());
    (three.expected, three.actual, three.difference) = (None, None, None);
    four.actual = Some(png([32, 96], |_, _| INK));
    two.distances = Some(square_at(RIGHT));
    let Some((mut browser, _)) = browser_with(&report, "#picture=000.png") else { return };
    let captions = "[...document.querySelectorAll('figure')].map((figure) => figure.innerText.replace(/\\s+/g, ' '))";
    let seen = browser.value(captions);
    assert_eq!(seen, json!(["Expected 64 × 48", "Difference nothing to compare", "Actual missing"]));
    assert_eq!(browser.value("document.getElementById('difference-key').hidden"), true);
    let distances =
        "[document.getElementById('distances').hidden, document.querySelector('#distances img')?.naturalWidth ?? 0]";
    assert_eq!(browser.value(distances), json!([true, 0]));
    browser.press("ArrowRight", PLAIN);
    browser.until("the pictures", LOADED);
    browser.until("a state coloured by distances", "document.querySelector('#distances img').naturalWidth === 64");
    assert_eq!(browser.value(distances), json!([false, 64]));
    let seen = browser.value(captions);
    assert_eq!(seen[0], "Expected missing: nothing like it was expected");
    assert_eq!(seen[2], "Actual this picture cannot be shown");
    browser.press("ArrowRight", PLAIN);
    assert_eq!(browser.value(captions)[2], "Actual not embedded in this report");
    assert_eq!(browser.value(distances), json!([true, 0]));
    browser.press("ArrowRight", PLAIN);
    browser.until("the pictures", LOADED);
    browser.until("sizes", "document.querySelectorAll('.size')[2].textContent === '32 × 96'");
    let scales = "[...document.images].map((image) => image.getBoundingClientRect().width / image.naturalWidth)";
    let scales = browser.value(scales);
    assert_eq!((&scales[0], &scales[1]), (&scales[2], &scales[2]), "pictures of two sizes are shown at one scale");

    // Whatever is told of a frame, the charts stay where they are.
    let many_runs = Report { runs: vec![runs(41); 4].concat(), ..sequence() };
    browser.open(&many_runs.page(), "");
    browser.until("the charts", CHARTS);
    let heights = "(() => { const [strip, charts] = ['strip', 'charts'].map((id) => document.getElementById(id)); \
                   return new Set(Array.from({ length: 41 }, (_, frame) => { strip.value = frame; \
                   strip.dispatchEvent(new Event('input')); return charts.getBoundingClientRect().top; })).size; })()";
    assert_eq!(browser.value(heights), 1);
    // Words in the table of all numbers are not broken.
    browser.click_on("summary");
    browser.until("the table", "document.querySelector('#numbers th') !== null");
    let lines =
        "document.querySelector('#numbers tr').offsetHeight / parseFloat(getComputedStyle(document.body).lineHeight)";
    assert!(browser.number(lines) < 2.0);

    // No line breaks within a number, such as `3.1e-4 m`.
    for narrow in (150..360).step_by(10) {
        browser.resize([narrow, 900]);
        let lines = "[...document.querySelectorAll('.number')].map((number) => number.getClientRects().length)";
        assert_eq!(browser.value(lines), json!([1, 1, 1, 1]), "numbers at {narrow} px");
    }

    // Any number of pictures on any screen.
    let single = Report { runs: vec![], pictures: vec![sheet("only.png", None, false)], first: 0, ..sequence() };
    let nothing = Report { runs: vec![], pictures: vec![], ..sequence() };
    let states_only = Report { pictures: vec![], ..sequence() };
    let mut many = Report { runs: runs(2000), first: 0, ..sequence() };
    let unseen = PicturePair { expected: None, actual: None, difference: None, ..sheet("", None, false) };
    let named = |frame| PicturePair { name: format!("frame-{frame:05}.png"), frame: Some(frame), ..unseen.clone() };
    many.pictures = (0..2000).map(named).collect();
    let whole = sequence();
    for (report, width) in
        [(&single, 360), (&nothing, 360), (&states_only, 360), (&whole, 360), (&whole, 420), (&many, 360)]
    {
        browser.resize([width, 900]);
        browser.open(&report.page(), "");
        browser.until("the pictures", LOADED);
        // No words of the charts lie over others, or over a button.
        let collisions = "(() => { const boxes = [...document.querySelectorAll('#charts text, #runs li, #reading, button')]
            .map((one) => one.getBoundingClientRect()).filter(({ width }) => width > 0);
            const apart = (a, b) => a.right <= b.left + 1 || b.right <= a.left + 1 || a.bottom <= b.top + 1 || b.bottom <= a.top + 1;
            return boxes.flatMap((a, at) => boxes.slice(at + 1).filter((b) => !apart(a, b))).length; })()";
        if !report.runs.is_empty() {
            browser.until("the charts", CHARTS);
            assert_eq!(browser.value(collisions), 0, "{} pictures in {width} px", report.pictures.len());
        }
        let too_wide = "document.documentElement.scrollWidth - innerWidth";
        assert!(browser.number(too_wide) <= 0.0, "{} pictures in {width} px", report.pictures.len());
        for key in ["End", "ArrowRight", "2", "3", "f", "+", "]"] {
            browser.press(key, PLAIN);
        }
        assert_eq!(browser.complaints(), [""; 0], "{} pictures in {width} px", report.pictures.len());
    }
    assert_eq!(browser.text(NAME), "frame-00002.png");
    browser.resize([2560, 900]);
    browser.until("a wide strip", "document.getElementById('charts').getBoundingClientRect().width > 2000");
    assert_eq!(browser.complaints(), [""; 0]);
}

#[test]
fn without_scripts_the_verdict_is_shown() {
    let Some((mut browser, _)) = browser_with(&sequence(), "") else { return };
    browser.order("Emulation.setScriptExecutionDisabled", json!({ "value": true }));
    browser.open(&sequence().page(), "");
    assert_eq!(browser.value("document.querySelector('main').hidden"), true);
    assert_eq!(browser.value("document.querySelectorAll('noscript li').length"), 5);
    let told = browser.text("document.body.innerText");
    assert!(told.contains("State moved") || told.contains("state moved"), "{told}");
    assert!(told.contains("✕ 040.png 512 pixels differ"), "{told}");
}
