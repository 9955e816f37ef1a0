//! Pictures as SVG and PDF: text stays text in embedded fonts, flat bodies are paths, and lit bodies are images.

use super::{compose, fig4b, frame, parse};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use localshape::look::Theme;
use localshape::picture::{Picture, compose_figure};
use localshape::runner::moments::Moments;
use localshape::scene::figure::Figure;
use localshape::vector::{Format, Page, bodies, write};
use std::io::Read;

fn figure(name: &str, theme: Theme) -> Picture {
    let mut figure = Figure::built_in(name).expect("a figure of the paper");
    figure.set_theme(theme);
    compose_figure(&figure, &Moments::new(&figure)).expect("room")
}

fn page<'a>(picture: &'a Picture, bodies: Option<&'a [u8]>) -> Page<'a> {
    let tags = &[];
    Page { picture, bodies, size_mm: Some([180.0, 90.0]), title: "A & B", maker: "a test", tags }
}

fn svg(picture: &Picture) -> String {
    String::from_utf8(write(&page(picture, None), Format::Svg).expect("a page")).expect("text")
}

/// The contents of all streams of a PDF file, unpacked.
fn streams(file: &[u8]) -> Vec<Vec<u8>> {
    let find =
        |from: usize, what: &[u8]| file[from..].windows(what.len()).position(|part| part == what).map(|at| from + at);
    let (mut at, mut found) = (0, Vec::new());
    while let Some(begin) = find(at, b"\nstream\n") {
        let mut bytes = Vec::new();
        flate2::read::ZlibDecoder::new(&file[begin + 8..]).read_to_end(&mut bytes).expect("a packed stream");
        at = find(begin, b"endstream").expect("its end");
        found.push(bytes);
    }
    found
}

/// The text of each `<text>` element, without the marks in it.
fn texts(svg: &str) -> Vec<String> {
    let inside = |element: &str| {
        let text = &element[element.find('>').expect("its end") + 1..element.find("</text>").expect("its end")];
        let parts = text.split('<').map(|part| part.rsplit('>').next().unwrap_or_default());
        parts
            .collect::<String>()
            .replace("&quot;", "\"")
            .replace("&lt;", "<")
            .replace("&gt;", ">")
            .replace("&amp;", "&")
    };
    svg.split("<text ").skip(1).map(inside).collect()
}

#[test]
fn text_stays_text() {
    for name in ["fig1", "fig2"] {
        let picture = figure(name, Theme::Light);
        let words: Vec<_> = picture.words.iter().map(|word| word.text.as_str()).collect();
        assert_eq!(texts(&svg(&picture)), words);
        let pdf = write(&page(&picture, None), Format::Pdf).expect("a page");
        let content = String::from_utf8_lossy(&streams(&pdf).concat()).into_owned();
        assert_eq!(content.matches("/ActualText").count(), words.len());
        for word in words.iter().filter(|word| word.is_ascii() && !word.contains(['(', ')'])) {
            assert!(content.contains(&format!("({word})")), "{word}");
        }
        assert!(content.contains("beginbfchar"), "a map of characters");
    }
}

/// The fonts of the page have the characters of the page, with the outlines of the whole font, and hardly more.
#[test]
fn fonts_are_embedded_with_the_glyphs_in_use() {
    let picture = figure("fig2", Theme::Light);
    let svg = svg(&picture);
    let fonts: Vec<_> =
        svg.split("data:font/otf;base64,").skip(1).map(|rest| rest.split(')').next().unwrap()).collect();
    assert_eq!(fonts.len(), 2);
    for (face, font) in (0_u8..).zip(fonts) {
        let bytes = STANDARD.decode(font).expect("base64");
        let whole = picture.fonts.face(face).bytes();
        assert!(bytes.len() < whole.len() / 2, "{} of {} bytes", bytes.len(), whole.len());
        let [part, whole] = [&bytes[..], whole].map(|bytes| ttf_parser::Face::parse(bytes, 0).expect("a font"));
        let mut used: Vec<_> = picture
            .words
            .iter()
            .flat_map(|word| word.text.chars().zip(&word.glyphs))
            .filter(|(_, glyph)| glyph.face == face)
            .map(|(character, _)| character)
            .collect();
        used.sort_unstable();
        used.dedup();
        assert!(usize::from(part.number_of_glyphs()) <= used.len() + 1);
        for character in used {
            let [own, other] = [&part, &whole].map(|font| font.glyph_index(character).expect("its glyph"));
            assert_eq!(part.glyph_bounding_box(own), whole.glyph_bounding_box(other), "{character}");
            assert_eq!(part.glyph_hor_advance(own), whole.glyph_hor_advance(other), "{character}");
        }
    }
}

#[test]
fn panels_in_the_plane_are_paths_alone() {
    let picture = figure("fig1", Theme::Light);
    assert!(picture.panels.iter().all(|panel| panel.sight.flat) && bodies(&picture).is_none());
    let svg = svg(&picture);
    assert!(!svg.contains("<image") && svg.matches("<path").count() > 40);
    let [begun, ended] = ["<g ", "</g>"].map(|mark| svg.matches(mark).count());
    assert!(begun == ended && begun > 0);
    assert!(svg.starts_with("<svg ") && svg.contains("width=\"180mm\" height=\"90mm\"") && svg.ends_with("</svg>\n"));
    assert!(svg.contains("<title>A &amp; B</title>"));
    let dark = self::svg(&figure("fig1", Theme::Dark));
    assert!(svg != dark && svg.matches("<path").count() == dark.matches("<path").count());
}

/// The non-empty part of a lit panel becomes an image; words, marks and curves stay vectors.
#[test]
fn lit_bodies_are_images_without_words() {
    let (scene, frame) = fig4b(0);
    let picture = compose(&scene, &frame);
    let lit = bodies(&picture).expect("lit panels");
    assert_eq!(lit.panels, picture.panels);
    assert!(lit.words.is_empty() && lit.marks.is_empty() && lit.curves.is_empty());
    let [width, height] = picture.size;
    let mut pixels = picture.palette.background.repeat((width * height) as usize);
    // Three pixels beside each other in the second panel.
    let at = 3 * (300 * width + 900) as usize;
    pixels[at..at + 9].fill(0);
    let svg = String::from_utf8(write(&page(&picture, Some(&pixels)), Format::Svg).expect("a page")).unwrap();
    let images: Vec<_> = svg.split("<image ").skip(1).collect();
    assert_eq!(images.len(), 1);
    assert!(images[0].starts_with("width=\"3\" height=\"1\"") && images[0].contains("matrix(1 0 0 1 900 300)"));
    assert_eq!(texts(&svg).len(), picture.words.len());
    let pdf = write(&page(&picture, Some(&pixels)), Format::Pdf).expect("a page");
    assert!(String::from_utf8_lossy(&pdf).contains("/Width 3"));
}

/// Strips inside the obstacle extend across the left side of its room.
#[test]
fn obstacles_that_leave_their_panel_fade() {
    let mut scene = parse(
        "time = { duration = 1, step = 'T/50', frames_per_second = 50 }
        run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1e3 } }]
        body = { nodes = [[0, 1], [1, 1], [0.5, 1.8]], elements = [[0, 1, 2]] }
        obstacle = [{ kind = 'capsule', from = [-9, 0.9], to = [0.2, 0.7], radius = 0.05 }]",
    );
    scene.view.camera.follow = false;
    let mut picture = compose(&scene, &frame(&scene, 0));
    let fading = picture.panels[0].obstacles.fade.expect("it leaves the panel");
    assert_eq!(fading.strength, [1.0, 0.0, 0.0, 0.0]);
    let strips = |picture: &Picture| svg(picture).matches("fill-opacity").count();
    let with = strips(&picture);
    picture.panels[0].obstacles.fade = None;
    assert!((with - strips(&picture)).abs_diff(fading.distance[0] as usize) < 4, "{with}");
}

#[test]
fn the_same_picture_gives_the_same_bytes() {
    let picture = figure("fig2", Theme::Light);
    for format in [Format::Svg, Format::Pdf] {
        let file = || write(&page(&picture, None), format).expect("a page");
        assert_eq!(file(), file());
    }
    let pdf = write(&page(&picture, None), Format::Pdf).expect("a page");
    assert!(pdf.starts_with(b"%PDF-1.7") && pdf.ends_with(b"%%EOF\n") || pdf.ends_with(b"%%EOF"));
    // Points of 180 × 90 mm.
    assert!(String::from_utf8_lossy(&pdf).contains("[0 0 510.23"), "the size of the page");
}
