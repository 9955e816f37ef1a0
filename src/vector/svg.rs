//! A page as SVG 1.1, with its fonts and images inside.

use super::Page;
use super::font::Subset;
use crate::colour::written;
use crate::output::{Compression, encode};
use crate::picture::{Colour, Glyph, Image, Item, Paint, Path, Pen, Picture, Step, TextRun, Weight};
use crate::reading::words::escaped;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::Vec2;
use std::fmt::Write;

pub(super) fn file<'a>(page: &Page<'_>, items: impl Iterator<Item = &'a Item>, subsets: &[Subset<'_>]) -> Vec<u8> {
    let mut svg = Svg { text: String::new(), picture: page.picture, subsets, names: 0 };
    svg.head(page);
    items.for_each(|item| svg.item(item));
    svg.text += "</svg>\n";
    svg.text.into_bytes()
}

struct Svg<'a> {
    text: String,
    picture: &'a Picture,
    subsets: &'a [Subset<'a>],
    /// The number of named clips and blends.
    names: usize,
}

impl Svg<'_> {
    fn add(&mut self, words: std::fmt::Arguments<'_>) {
        self.text.write_fmt(words).expect("into memory");
    }

    fn head(&mut self, page: &Page<'_>) {
        let [width, height] = page.picture.size;
        let [wide, high] = match page.size_mm {
            Some(lengths) => lengths.map(|length| format!("{length}mm")),
            None => [width, height].map(|length| length.to_string()),
        };
        self.add(format_args!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
             width=\"{wide}\" height=\"{high}\" viewBox=\"0 0 {width} {height}\">\n"
        ));
        if !page.title.is_empty() {
            self.add(format_args!("<title>{}</title>\n", escaped(page.title)));
        }
        self.add(format_args!("<metadata>\n{}\n", escaped(page.maker)));
        for (name, text) in page.tags {
            self.add(format_args!("localshape:{name} {}\n", escaped(text)));
        }
        self.text += "</metadata>\n<style>\n";
        for subset in self.subsets {
            let font = STANDARD.encode(subset.for_browsers());
            let face = subset.face;
            // One font serves all weights, so the browser must not make it bolder.
            self.add(format_args!(
                "@font-face{{font-family:\"face{face}\";font-weight:100 900;src:url(data:font/otf;base64,{font})}}\n"
            ));
        }
        self.text += "text{white-space:pre;font-kerning:none;font-variant-ligatures:none}\n</style>\n";
    }

    fn item(&mut self, item: &Item) {
        match item {
            Item::Fill { path, paint } => {
                let (data, paint) = (data(path), fill(*paint));
                self.add(format_args!("<path d=\"{data}\"{paint}/>\n"));
            }
            Item::Stroke { path, pen, paint } => {
                let (data, pen) = (data(path), stroke(pen, *paint));
                self.add(format_args!("<path d=\"{data}\" fill=\"none\"{pen}/>\n"));
            }
            Item::Blend { path, ends, colours } => self.blend(path, *ends, colours),
            Item::Image(image) => self.image(image),
            Item::Text(run) => {
                super::halo(self.picture, run).iter().for_each(|halo| self.item(halo));
                self.run(run);
            }
            Item::Clip { path, items } => {
                let (name, data) = (self.names, data(path));
                self.names += 1;
                self.add(format_args!(
                    "<clipPath id=\"c{name}\"><path d=\"{data}\"/></clipPath>\n<g clip-path=\"url(#c{name})\">\n"
                ));
                items.iter().for_each(|item| self.item(item));
                self.text += "</g>\n";
            }
            Item::Part { items, .. } => items.iter().for_each(|item| self.item(item)),
        }
    }

    fn blend(&mut self, path: &Path, ends: [Vec2; 2], colours: &[Colour]) {
        let (name, data) = (self.names, data(path));
        self.names += 1;
        let [x1, y1, x2, y2] = [ends[0].x, ends[0].y, ends[1].x, ends[1].y].map(number);
        self.add(format_args!(
            "<linearGradient id=\"b{name}\" gradientUnits=\"userSpaceOnUse\" x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\">"
        ));
        for (at, &colour) in colours.iter().enumerate() {
            let (place, colour) = (at as f64 / (colours.len() - 1) as f64, written(colour));
            self.add(format_args!("<stop offset=\"{place:.5}\" stop-color=\"{colour}\"/>"));
        }
        self.add(format_args!("</linearGradient><path d=\"{data}\" fill=\"url(#b{name})\"/>\n"));
    }

    fn image(&mut self, image: &Image) {
        let png = STANDARD.encode(encode(image.size, &image.pixels, &[], Compression::Small));
        let [corner, right, down] = image.place;
        let matrix = [right.x, right.y, down.x, down.y, corner.x, corner.y];
        let [width, height] = image.size;
        // Pixels are placed as units of the page, then transformed: a unit square would be too small for some programs.
        let matrix = std::array::from_fn(|at: usize| match at {
            0 | 1 => f64::from(matrix[at]) / f64::from(width),
            2 | 3 => f64::from(matrix[at]) / f64::from(height),
            _ => f64::from(matrix[at]),
        });
        let [a, b, c, d, e, f] = matrix;
        self.add(format_args!(
            "<image width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
             transform=\"matrix({a} {b} {c} {d} {e} {f})\" xlink:href=\"data:image/png;base64,{png}\"/>\n"
        ));
    }

    /// A line of text. Glyphs that are kerned carry their own position.
    fn run(&mut self, run: &TextRun) {
        let weight = match run.weight {
            Weight::Regular => 400,
            Weight::SemiBold => 600,
        };
        let (size, baseline, colour) = (number(run.size), number(run.baseline), written(run.colour));
        self.add(format_args!(
            "<text xml:space=\"preserve\" y=\"{baseline}\" font-size=\"{size}\" font-weight=\"{weight}\" fill=\"{colour}\""
        ));
        let characters: Vec<_> = run.text.chars().zip(&run.glyphs).collect();
        let pieces: Vec<_> = characters.chunk_by(|(_, one), (_, other)| self.goes_on(run.size, one, other)).collect();
        if pieces.len() > 1 {
            self.text.push('>');
        }
        for piece in &pieces {
            let glyph = piece[0].1;
            let (place, family) = (number(glyph.x), self.family(glyph.face));
            let text = escaped(&piece.iter().map(|(character, _)| character).collect::<String>());
            match pieces.len() {
                1 => self.add(format_args!(" x=\"{place}\" font-family=\"{family}\">{text}")),
                _ => self.add(format_args!("<tspan x=\"{place}\" font-family=\"{family}\">{text}</tspan>")),
            }
        }
        self.text += "</text>\n";
    }

    /// Whether a glyph stands where the font alone would set it after another.
    fn goes_on(&self, size: f32, one: &Glyph, other: &Glyph) -> bool {
        const NEAR: f32 = 0.05;
        let subset = self.subsets.iter().find(|subset| subset.face == one.face);
        let end = subset.map(|subset| one.x + size / 1000.0 * subset.widths[usize::from(subset.glyph(one.id))]);
        one.face == other.face && end.is_some_and(|end| (end - other.x).abs() < NEAR)
    }

    /// The embedded font, then the same font on the computer, then a similar one.
    fn family(&self, face: u8) -> String {
        let own = self.subsets.iter().find(|subset| subset.face == face).and_then(|subset| subset.name(1));
        let own = own.map_or(String::new(), |name| format!(" '{}',", escaped(&name.replace(['\'', '\\'], ""))));
        format!("face{face},{own} Inter, sans-serif")
    }
}

/// A length with up to two decimals.
fn number(length: f32) -> String {
    // A sum with zero is no negative zero.
    ((f64::from(length) * 100.0).round() / 100.0 + 0.0).to_string()
}

/// A path as the attribute `d`.
fn data(path: &Path) -> String {
    let mut text = String::new();
    let mut add = |letter: char, points: &[Vec2]| {
        text.push(letter);
        for (at, point) in points.iter().enumerate() {
            let blank = if at > 0 { " " } else { "" };
            write!(text, "{blank}{} {}", number(point.x), number(point.y)).expect("into memory");
        }
    };
    for step in &path.0 {
        match step {
            Step::Move(to) => add('M', &[*to]),
            Step::Line(to) => add('L', &[*to]),
            Step::Cubic(points) => add('C', points),
            Step::Close => add('Z', &[]),
        }
    }
    text
}

fn fill(Paint { colour, alpha }: Paint) -> String {
    let colour = written(colour);
    let alpha = if alpha < 1.0 { format!(" fill-opacity=\"{alpha:.3}\"") } else { String::new() };
    format!(" fill=\"{colour}\"{alpha}")
}

fn stroke(pen: &Pen, Paint { colour, alpha }: Paint) -> String {
    let (colour, width) = (written(colour), number(pen.width));
    let cap = if pen.round { " stroke-linecap=\"round\"" } else { "" };
    let alpha = if alpha < 1.0 { format!(" stroke-opacity=\"{alpha:.3}\"") } else { String::new() };
    let dash = match pen.dash[..] {
        [] => String::new(),
        _ => {
            let lengths: Vec<_> = pen.dash.iter().map(|&length| number(length)).collect();
            format!(" stroke-dasharray=\"{}\"", lengths.join(" "))
        }
    };
    format!(" stroke=\"{colour}\" stroke-width=\"{width}\"{cap} stroke-linejoin=\"round\"{dash}{alpha}")
}
