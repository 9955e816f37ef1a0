//! A page as PDF 1.7, with its fonts and images inside.

use super::Page;
use super::font::Subset;
use crate::output;
use crate::picture::{Colour, Image, Item, Paint, Path, Pen, Picture, Step, TextRun};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use glam::Vec2;
use pdf_writer::types::{
    CidFontType, FontFlags, FunctionShadingType, LineCapStyle, LineJoinStyle, Predictor, SystemInfo, UnicodeCmap,
};
use pdf_writer::{Content, Dict, Filter, Finish, Name, Pdf, Rect, Ref, Str, TextStr};
use std::io::Write;

/// Points of PDF in a millimetre.
const POINTS: f64 = 72.0 / 25.4;
/// The encoding: characters are numbers of glyphs.
const IDENTITY: SystemInfo<'static> = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

pub(super) fn file<'a>(page: &Page<'_>, items: impl Iterator<Item = &'a Item>, subsets: &[Subset<'_>]) -> Vec<u8> {
    let [width, height] = match page.size_mm {
        Some(lengths) => lengths.map(|length| (length * POINTS) as f32),
        None => page.picture.size.map(|length| 0.75 * length as f32),
    };
    let mut writer = Writer {
        pdf: Pdf::new(),
        next: Ref::new(1),
        content: Content::new(),
        picture: page.picture,
        subsets,
        alphas: Vec::new(),
        images: Vec::new(),
        shadings: Vec::new(),
        paint: [None; 2],
    };
    let [catalog, pages, sheet, content, info] = [0; 5].map(|_| writer.next.bump());
    // Near the beginning, where readers find it without reading the whole file.
    let mut about = writer.pdf.document_info(info);
    about.producer(TextStr(page.maker));
    if !page.title.is_empty() {
        about.title(TextStr(page.title));
    }
    for (name, text) in page.tags {
        about.pair(Name(format!("localshape:{name}").as_bytes()), TextStr(text));
    }
    about.finish();
    writer.pdf.catalog(catalog).pages(pages);
    writer.pdf.pages(pages).kids([sheet]).count(1);
    // The transformation from pixels of the picture, downwards, to points, upwards.
    let [x, y] = [width / page.picture.size[0] as f32, height / page.picture.size[1] as f32];
    writer.content.transform([x, 0.0, 0.0, -y, 0.0, height]);
    writer.content.set_line_join(LineJoinStyle::RoundJoin);
    items.for_each(|item| writer.item(item));
    let fonts: Vec<_> = subsets.iter().map(|subset| (subset.face, writer.font(subset))).collect();

    let Writer { mut pdf, content: drawn, alphas, images, shadings, mut next, .. } = writer;
    let states: Vec<_> = alphas.iter().map(|&alpha| (alpha, next.bump())).collect();
    for &(alpha, id) in &states {
        let alpha = f32::from(alpha) / ALPHAS;
        pdf.ext_graphics(id).stroking_alpha(alpha).non_stroking_alpha(alpha);
    }
    pdf.stream(content, &packed(&drawn.finish())).filter(Filter::FlateDecode);
    let mut sheet = pdf.page(sheet);
    sheet.media_box(Rect::new(0.0, 0.0, width, height)).parent(pages).contents(content);
    let mut resources = sheet.resources();
    let fonts = fonts.into_iter().map(|(face, id)| (usize::from(face), id));
    let states = states.into_iter().map(|(alpha, id)| (usize::from(alpha), id));
    put(resources.fonts(), 'F', fonts);
    put(resources.ext_g_states(), 'G', states);
    put(resources.x_objects(), 'I', images.into_iter().enumerate());
    put(resources.shadings(), 'S', shadings.into_iter().enumerate());
    resources.finish();
    sheet.finish();
    pdf.finish()
}

/// Opacities are distinguished to this precision.
const ALPHAS: f32 = 1000.0;

struct Writer<'a> {
    pdf: Pdf,
    next: Ref,
    content: Content,
    picture: &'a Picture,
    subsets: &'a [Subset<'a>],
    /// The opacities in use, in thousandths.
    alphas: Vec<u16>,
    images: Vec<Ref>,
    shadings: Vec<Ref>,
    /// The current colours of fills and of strokes, with their opacities. The end of a clip resets them.
    paint: [Option<(Colour, u16)>; 2],
}

impl Writer<'_> {
    fn item(&mut self, item: &Item) {
        match item {
            Item::Fill { path, paint } => {
                if !path.is_empty() {
                    self.set(0, *paint);
                    self.path(path);
                    self.content.fill_nonzero();
                }
            }
            Item::Stroke { path, pen, paint } => {
                self.set(1, *paint);
                self.stroke(path, pen);
            }
            Item::Blend { path, ends, colours } => self.blend(path, *ends, colours),
            Item::Image(image) => self.image(image),
            Item::Text(run) => {
                super::halo(self.picture, run).iter().for_each(|halo| self.item(halo));
                self.run(run);
            }
            Item::Clip { path, items } => {
                self.content.save_state();
                self.path(path);
                self.content.clip_nonzero().end_path();
                items.iter().for_each(|item| self.item(item));
                self.content.restore_state();
                self.paint = [None; 2];
            }
            Item::Part { items, .. } => items.iter().for_each(|item| self.item(item)),
        }
    }

    /// Sets the colour of fills or strokes, and the opacity of both.
    fn set(&mut self, use_of: usize, Paint { colour, alpha }: Paint) {
        let alpha = (alpha * ALPHAS).round() as u16;
        let wanted = Some((colour, alpha));
        if self.paint[use_of] == wanted {
            return;
        }
        if !self.alphas.contains(&alpha) {
            self.alphas.push(alpha);
        }
        self.content.set_parameters(Name(name('G', alpha.into()).as_bytes()));
        let [r, g, b] = light(colour);
        match use_of {
            0 => self.content.set_fill_rgb(r, g, b),
            _ => self.content.set_stroke_rgb(r, g, b),
        };
        self.paint[use_of] = wanted;
        // One opacity holds for both.
        self.paint[1 - use_of] = self.paint[1 - use_of].filter(|(_, other)| *other == alpha);
    }

    fn path(&mut self, path: &Path) {
        for step in &path.0 {
            match *step {
                Step::Move(to) => self.content.move_to(fine(to.x), fine(to.y)),
                Step::Line(to) => self.content.line_to(fine(to.x), fine(to.y)),
                Step::Cubic([a, b, to]) => {
                    let [x1, y1, x2, y2, x, y] = [a.x, a.y, b.x, b.y, to.x, to.y].map(fine);
                    self.content.cubic_to(x1, y1, x2, y2, x, y)
                }
                Step::Close => self.content.close_path(),
            };
        }
    }

    fn stroke(&mut self, path: &Path, pen: &Pen) {
        let cap = if pen.round { LineCapStyle::RoundCap } else { LineCapStyle::ButtCap };
        self.content.set_line_width(fine(pen.width)).set_line_cap(cap);
        self.content.set_dash_pattern(pen.dash.iter().map(|&length| fine(length)), 0.0);
        self.path(path);
        self.content.stroke();
    }

    fn blend(&mut self, path: &Path, ends: [Vec2; 2], colours: &[Colour]) {
        let [function, shading] = [self.next.bump(), self.next.bump()];
        let mut between = self.pdf.sampled_function(function, colours.as_flattened());
        between.domain([0.0, 1.0]).range([0.0, 1.0].repeat(3)).size([colours.len() as i32]).bits_per_sample(8);
        between.finish();
        let mut axial = self.pdf.function_shading(shading);
        axial.shading_type(FunctionShadingType::Axial).color_space().device_rgb();
        axial.coords([ends[0].x, ends[0].y, ends[1].x, ends[1].y]).function(function).extend([true; 2]);
        axial.finish();
        self.content.save_state();
        self.set(0, Paint { colour: colours[0], alpha: 1.0 });
        self.path(path);
        self.content.clip_nonzero().end_path();
        self.content.shading(Name(name('S', self.shadings.len()).as_bytes()));
        self.content.restore_state();
        self.paint = [None; 2];
        self.shadings.push(shading);
    }

    fn image(&mut self, Image { size, pixels, place }: &Image) {
        let id = self.next.bump();
        let has_alpha = pixels.len() as u64 == 4 * u64::from(size[0]) * u64::from(size[1]);
        let mask = has_alpha.then(|| {
            let mask = self.next.bump();
            let alpha: Vec<u8> = pixels.chunks_exact(4).map(|pixel| pixel[3]).collect();
            self.pixels(mask, *size, png::ColorType::Grayscale, &alpha, None);
            mask
        });
        let channels = if has_alpha { 4 } else { 3 };
        let colours: Vec<u8> = pixels.chunks_exact(channels).flat_map(|pixel| &pixel[..3]).copied().collect();
        self.pixels(id, *size, png::ColorType::Rgb, &colours, mask);
        let [corner, right, down] = place;
        // The unit square of an image has its first row on top.
        let left_below = *corner + *down;
        self.content.save_state();
        self.set(0, Paint { colour: [0; 3], alpha: 1.0 });
        self.content.transform([right.x, right.y, -down.x, -down.y, left_below.x, left_below.y]);
        self.content.x_object(Name(name('I', self.images.len()).as_bytes()));
        self.content.restore_state();
        self.paint = [None; 2];
        self.images.push(id);
    }

    /// Writes pixels. PDF reads the packed rows of PNG.
    fn pixels(&mut self, id: Ref, [width, height]: [u32; 2], kind: png::ColorType, pixels: &[u8], mask: Option<Ref>) {
        let rows = output::packed([width, height], kind, pixels, |encoder| output::Compression::Small.apply(encoder));
        let mut image = self.pdf.image_xobject(id, &rows);
        image.filter(Filter::FlateDecode);
        image.width(width as i32).height(height as i32).bits_per_component(8);
        match kind {
            png::ColorType::Grayscale => image.color_space().device_gray(),
            _ => image.color_space().device_rgb(),
        };
        image.decode_parms().predictor(Predictor::PngOptimum).colors(kind.samples() as i32).columns(width as i32);
        if let Some(mask) = mask {
            image.s_mask(mask);
        }
    }

    fn run(&mut self, run: &TextRun) {
        self.set(0, run.colour.into());
        // Digits stand in cells of one width. Readers would take the space around narrow digits for blanks.
        self.content.begin_marked_content_with_properties(Name(b"Span")).properties().actual_text(TextStr(&run.text));
        self.content.begin_text();
        for group in run.glyphs.chunk_by(|one, other| one.face == other.face) {
            let Some(subset) = self.subsets.iter().find(|subset| subset.face == group[0].face) else { continue };
            self.content.set_font(Name(name('F', subset.face.into()).as_bytes()), run.size);
            self.content.set_text_matrix([1.0, 0.0, 0.0, -1.0, fine(group[0].x), fine(run.baseline)]);
            let mut line = self.content.show_positioned();
            let mut parts = line.items();
            let mut pen = group[0].x;
            for glyph in group {
                let off = ((pen - glyph.x) / run.size * 1000.0).round();
                if off != 0.0 {
                    parts.adjust(off);
                    pen -= off / 1000.0 * run.size;
                }
                let number = subset.glyph(glyph.id);
                parts.show(Str(&number.to_be_bytes()));
                pen += subset.widths[usize::from(number)] / 1000.0 * run.size;
            }
        }
        self.content.end_text();
        self.content.end_marked_content();
    }

    fn font(&mut self, subset: &Subset<'_>) -> Ref {
        let [font, descendant, descriptor, characters, data] = [0; 5].map(|_| self.next.bump());
        let (bytes, is_postscript) = subset.for_pdf();
        let own = subset.name(6).unwrap_or_default();
        let own: String = own.chars().filter(|&sign| sign == '-' || sign.is_ascii_alphanumeric()).collect();
        // Names of font parts begin with six letters.
        let letter = |at: u8| char::from(b'A' + (subset.face + at) % 26);
        let own = format!("{}+{own}", (0..6).map(letter).collect::<String>());
        let (kind, subtype) = match is_postscript {
            true => (CidFontType::Type0, "-Identity-H"),
            false => (CidFontType::Type2, ""),
        };
        self.pdf
            .type0_font(font)
            .base_font(Name(format!("{own}{subtype}").as_bytes()))
            .encoding_predefined(Name(b"Identity-H"))
            .descendant_font(descendant)
            .to_unicode(characters);
        let mut cid = self.pdf.cid_font(descendant);
        cid.subtype(kind).base_font(Name(own.as_bytes())).system_info(IDENTITY).font_descriptor(descriptor);
        cid.default_width(0.0).widths().consecutive(0, subset.widths.iter().copied());
        if !is_postscript {
            cid.cid_to_gid_map_predefined(Name(b"Identity"));
        }
        cid.finish();
        let whole = &subset.whole;
        let thousandths = |length: i16| f32::from(length) * 1000.0 / f32::from(whole.units_per_em());
        let bounds = whole.global_bounding_box();
        let [left, bottom, right, top] = [bounds.x_min, bounds.y_min, bounds.x_max, bounds.y_max].map(thousandths);
        let mut about = self.pdf.font_descriptor(descriptor);
        about.name(Name(own.as_bytes())).flags(FontFlags::SYMBOLIC).bbox(Rect::new(left, bottom, right, top));
        about.italic_angle(whole.italic_angle()).ascent(thousandths(whole.ascender()));
        about.descent(thousandths(whole.descender()));
        about.cap_height(thousandths(whole.capital_height().unwrap_or(whole.ascender())));
        // Fonts do not tell the thickness of their stems; a tenth of the weight is usual.
        about.stem_v(f32::from(whole.weight().to_number()) / 5.0);
        match is_postscript {
            true => about.font_file3(data),
            false => about.font_file2(data),
        };
        about.finish();
        let mut map = UnicodeCmap::new(Name(b"Characters"), IDENTITY);
        let mut mapped = Vec::new();
        for (&character, &glyph) in &subset.characters {
            // Blanks of several kinds share a glyph.
            if !mapped.contains(&glyph) {
                map.pair(glyph, character);
                mapped.push(glyph);
            }
        }
        self.pdf.cmap(characters, &packed(&map.finish())).filter(Filter::FlateDecode);
        let packed = packed(bytes);
        let mut file = self.pdf.stream(data, &packed);
        file.filter(Filter::FlateDecode);
        match is_postscript {
            true => file.pair(Name(b"Subtype"), Name(b"CIDFontType0C")),
            false => file.pair(Name(b"Length1"), bytes.len() as i32),
        };
        file.finish();
        font
    }
}

/// Names resources of one kind by a letter and a number.
fn put(mut dictionary: Dict<'_>, letter: char, resources: impl Iterator<Item = (usize, Ref)>) {
    for (number, id) in resources {
        dictionary.pair(Name(name(letter, number).as_bytes()), id);
    }
}

fn name(letter: char, number: usize) -> String {
    format!("{letter}{number}")
}

fn light(colour: Colour) -> [f32; 3] {
    colour.map(|byte| f32::from(byte) / 255.0)
}

/// A length with three decimals, for short files.
fn fine(length: f32) -> f32 {
    (length * 1000.0).round() / 1000.0
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).and_then(|()| encoder.finish()).expect("into memory")
}
