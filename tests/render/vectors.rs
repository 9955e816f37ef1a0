//! Pictures as SVG and PDF: text stays text in embedded fonts, flat bodies are paths, and lit bodies are images.

use super::listed::{Listed, compose_figure, line};
use super::{compose, draw, fig4b, frame, gpu, parse};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::Vec2;
use image::RgbImage;
use localshape::look::Theme;
use localshape::picture::{Item, Path};
use localshape::runner::moments::Moments;
use localshape::scene::figure::Figure;
use localshape::vector::{Format, Page, bodies, write};
use std::io::Read;

fn figure(name: &str, theme: Theme) -> Listed {
    let mut figure = Figure::built_in(name).expect("a figure of the paper");
    figure.set_theme(theme);
    compose_figure(&figure, &Moments::new(&figure)).expect("room")
}

fn page<'a>(picture: &'a Listed, bodies: Option<&'a [u8]>) -> Page<'a> {
    let tags = &[];
    Page { picture, bodies, size_mm: Some([180.0, 90.0]), title: "A & B", maker: "a test", tags }
}

fn svg(picture: &Listed) -> String {
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

/// Each piece of text begins where the layout has its first glyph, and its font then leads to the places of the others.
#[test]
fn glyphs_stand_where_the_layout_has_them() {
    let picture = figure("fig2", Theme::Light);
    let svg = svg(&picture);
    let mut pieces = 0;
    for (element, word) in svg.split("<text ").skip(1).zip(&picture.words) {
        let mut glyphs = word.glyphs.iter();
        for piece in element[..element.find("</text>").expect("its end")].split(" x=\"").skip(1) {
            let (place, rest) = piece.split_once('"').expect("its end");
            let text = rest.split_once('>').expect("its text").1.split('<').next().expect("its text");
            let mut place: f32 = place.parse().expect("a number");
            for glyph in glyphs.by_ref().take(text.replace("&amp;", "&").chars().count()) {
                assert!((place - glyph.x).abs() < 0.2, "{:?}: {text:?} at {place} for {}", word.text, glyph.x);
                let font = ttf_parser::Face::parse(picture.fonts.face(glyph.face).bytes(), 0).expect("a font");
                let advance = font.glyph_hor_advance(ttf_parser::GlyphId(glyph.id)).expect("a glyph");
                place += f32::from(advance) / f32::from(font.units_per_em()) * word.size;
            }
            pieces += 1;
        }
        assert!(glyphs.next().is_none(), "{:?}", word.text);
    }
    assert!(pieces > picture.words.len(), "some glyphs are kerned");
}

/// The operators of a page and their operands.
fn operations(picture: &Listed) -> Vec<Vec<String>> {
    let pdf = write(&page(picture, None), Format::Pdf).expect("a page");
    let is_page = |part: &&Vec<u8>| part.windows(4).any(|four| four == b" cm\n");
    let content = streams(&pdf).iter().find(is_page).map(|part| String::from_utf8_lossy(part).into_owned());
    content.expect("the page").lines().map(|line| line.split(' ').map(str::to_owned).collect()).collect()
}

/// PDF has one opacity for fills and for lines, and the end of a clip restores the values before it.
#[test]
fn opacities_and_colours_are_set_again_where_pdf_has_others() {
    let mut picture = figure("fig1", Theme::Light);
    picture.under.clear();
    let curve = |points: &[[f32; 2]], alpha| line(points, 4.0, &[], ([1, 2, 3], alpha));
    let [from, to] = [[10.0, 10.0], [50.0, 40.0]];
    picture.above = vec![curve(&[from], 0.5), curve(&[from, to], 1.0), curve(&[to], 0.5)];
    let states = |picture: &Listed| -> Vec<String> {
        operations(picture)
            .into_iter()
            .filter(|words| words.last().is_some_and(|last| last == "gs"))
            .map(|words| words[0].clone())
            .collect()
    };
    assert_eq!(states(&picture)[1..], ["/G500", "/G1000", "/G500"], "after the background");

    let colour = [40, 50, 60];
    let square = || Item::fill(Path::rectangle(Vec2::ZERO, Vec2::splat(9.0)), colour);
    let clip = Item::Clip { path: Path::circle(Vec2::ZERO, 5.0), items: vec![square()] };
    picture.above = vec![clip, square()];
    let fill = colour.map(|byte| f32::from(byte) / 255.0).map(|part| format!("{part}"));
    let sets =
        operations(&picture).iter().filter(|words| words.len() == 4 && words[3] == "rg" && words[..3] == fill).count();
    assert_eq!(sets, 2, "inside and after the clip");
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
    assert!(picture.panels.iter().all(|panel| panel.sight.flat) && bodies(&picture, None).is_none());
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
    let lit = bodies(&picture, Some([180.0, 90.0])).expect("lit panels");
    assert_eq!(lit.panels, picture.panels);
    assert!(lit.under.is_empty() && lit.above.is_empty());
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

/// On a page without millimetres, a pixel of the picture is 1/96 of an inch, and bodies have 300 pixels to an inch.
#[test]
fn lit_bodies_of_pages_are_fine_enough_for_print() {
    let (scene, frame) = fig4b(0);
    let picture = compose(&scene, &frame);
    let lit = bodies(&picture, None).expect("lit panels");
    assert_eq!(lit.size, [4000, 2250]);
    let pixels = [0].repeat(3 * 4000 * 2250);
    let page = Page { bodies: Some(&pixels), ..Page::new(&picture) };
    let pdf = String::from_utf8_lossy(&write(&page, Format::Pdf).expect("a page")).into_owned();
    // Two panels that fill the picture.
    assert_eq!(pdf.matches("/Width 2000").count(), 2);
    let svg = String::from_utf8(write(&page, Format::Svg).expect("a page")).expect("text");
    assert!(svg.contains("<image width=\"2000\" height=\"2250\"") && svg.contains("matrix(0.32 0 0 0.32 640 0)"));
    let Some(gpu) = gpu("lit_bodies_of_pages_are_fine_enough_for_print") else { return };
    // The look is the same, but finer: means of larger squares equal pixels.
    let [plain, fine] = [bodies(&picture, Some([1.0; 2])), Some(lit)].map(|lit| draw(gpu, &lit.expect("lit panels")));
    let square = |image: &RgbImage, [x, y]: [u32; 2], side: u32| {
        let pixels = (0..side * side).map(|at| f64::from(image.get_pixel(x + at % side, y + at / side)[1]));
        pixels.sum::<f64>() / f64::from(side * side)
    };
    let places = (0..90 * 160).map(|at| [at % 160, at / 160]);
    let off = places.map(|at| square(&plain, at.map(|x| 8 * x), 8) - square(&fine, at.map(|x| 25 * x), 25));
    let off: Vec<_> = off.map(f64::abs).collect();
    let (most, mean) = (off.iter().copied().fold(0.0, f64::max), off.iter().sum::<f64>() / off.len() as f64);
    assert!(most < 20.0 && mean < 0.5, "{most} {mean}");
}

/// A cover with the colour of the background hides the obstacle beyond the left side of its room.
#[test]
fn obstacles_that_leave_their_panel_fade() {
    let mut scene = parse(
        "time = { duration = 1, step = 'T/50', frames_per_second = 50 }
        run = [{ name = 'one', model = { kind = 'shape-based', stiffness = 1e3 } }]
        body = { nodes = [[0, 1], [1, 1], [0.5, 1.8]], elements = [[0, 1, 2]] }
        obstacle = [{ kind = 'capsule', from = [-9, 0.9], to = [0.2, 0.7], radius = 0.05 }]",
    );
    scene.view.camera.follow = false;
    let picture = compose(&scene, &frame(&scene, 0));
    assert_eq!(svg(&picture).matches("<image").count(), 1, "one side is covered");
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
