//! The text of panels: names, clock, counts and numbers, and the lines between panels.

use super::layout::steps::{APART, BESIDE, BOLD, MARGIN, NEAR, STRONG};
use super::layout::tree::Solved;
use super::layout::{self, Layout, Part, Rectangle, Scale, WordPlaces};
use super::tally::Tally;
use super::text::{Fonts, TextRun, Weight};
use super::wrap::{balanced, cut, wrapped};
use super::{Item, Panel, number};
use crate::colour::Colour;
use crate::look::{LineStyle, Palette};
use crate::reading::captions::{constants, parts_and_constants, stiffness_of_material, unusual_choices};
use crate::runner::RunFrame;
use crate::scene::{Run, Scene, brakes_rotation};
use crate::sim::model::ElasticModel;
use crate::sim::{Body, Divergence, Snapshot, Status};
use std::sync::Arc;

/// The name of counts.
const TURNED_OVER: &str = "turned over";
/// The text in place of a number for a run that diverges: the same before and after.
pub(in crate::picture) const DIVERGES: &str = "diverges";
/// The text after the end of a recording: long, short.
pub(in crate::picture) const RECORDING_ENDS: &str = "recording ends";
const ENDED: &str = "ended";
/// The widest time of a clock; room for it is reserved, so that nothing moves when the digits change.
const WIDEST_TIME: &str = "8888.8 s";
/// The largest part of a panel's inner width that the clock's label may take.
const LABEL_SHARE: f64 = 0.55;

/// The gap between a panel's letter and its name, and the height of small letters, in sizes of type.
const LETTER_GAP: f64 = 0.42;
const X_HEIGHT: f64 = 0.55;

/// The models of a run in short, for the second line of a picture: `27 cubes, k = 10 kN/m, ζ = 0.1`, of several bodies
/// without their parts; or where its states come from.
pub(super) fn short_description(scene: &Scene, run: &Run) -> String {
    if let Some(recording) = &run.recording {
        return recording.description();
    }
    let short = |words: fn(&dyn ElasticModel, &Body) -> String| -> Vec<_> {
        let rotation = |model: &dyn ElasticModel, body: &Body| {
            if brakes_rotation(model, body) && scene.braked(run).is_some() { ", also of rotation" } else { "" }
        };
        let all = |(model, body): (&dyn ElasticModel, &Arc<Body>)| {
            words(model, body)
                + rotation(model, body)
                + &unusual_choices(model, body)
                + &stiffness_of_material(model, body)
        };
        run.models_and_bodies().map(all).collect()
    };
    let models = short(constants);
    match &models[..] {
        [_] => short(parts_and_constants).concat(),
        [first, ..] if models.iter().all(|model| model == first) => format!("{} bodies, {first}", models.len()),
        _ => {
            let named = run.body_names(scene).zip(&models).map(|(name, model)| format!("{name} {model}"));
            named.collect::<Vec<_>>().join("; ")
        }
    }
}

/// Collects the text and the flat marks of a picture.
pub(crate) struct Writer<'a> {
    pub(super) palette: &'a Palette,
    pub(super) fonts: &'a Fonts,
    pub(super) scale: Scale,
    pub(super) marks: Vec<Item>,
    pub(super) curves: Vec<Item>,
    pub(super) words: Vec<TextRun>,
}

impl<'a> Writer<'a> {
    pub(super) fn new(palette: &'a Palette, fonts: &'a Fonts, scale: Scale) -> Self {
        let (marks, curves, words) = Default::default();
        Self { palette, fonts, scale, marks, curves, words }
    }

    /// Gives a halo to words over bodies, plates and, if there are any in the plane, slopes.
    pub(super) fn over_bodies(&mut self, panels: &[Panel], have_slopes: bool) {
        for word in &mut self.words {
            let is_under = |panel: &Panel| {
                let is_in_panel = || have_slopes && word.touches(panel.viewport);
                word.touches(panel.region) || panel.has_pane_at(word.bounds()) || is_in_panel()
            };
            // Numbers in discs have the colour of the ground.
            word.has_halo = word.colour != self.palette.background && panels.iter().any(is_under);
        }
    }

    /// Its items in the order in which they are drawn.
    pub(super) fn items(self) -> impl Iterator<Item = Item> {
        self.marks.into_iter().chain(self.curves).chain(self.words.into_iter().map(Item::Text))
    }
}

/// The parts of a heading.
pub(super) struct Heading<'a> {
    /// The letter that names the panel in text; empty for none.
    pub(super) letter: String,
    /// The run's name, and the names of all runs shown.
    pub(super) name: &'a str,
    pub(super) names: &'a [&'a str],
    /// The style of the run's curves and arrows.
    pub(super) sample: Option<LineStyle>,
    /// The second line.
    pub(super) second: &'a str,
}

/// A number in a panel.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Number {
    /// The widest value of its kind. Its room is reserved, so that other text does not appear and disappear.
    widest: String,
    /// The number with its unit, and its name; then shorter wordings.
    wordings: Vec<[String; 2]>,
    /// Whether it is semi-bold, and written even if it is too small to read.
    is_loud: bool,
}

impl Number {
    fn weight(&self) -> Weight {
        if self.is_loud { Weight::SemiBold } else { Weight::Regular }
    }
}

impl Writer<'_> {
    /// The lines of a title and of a caption in a room of a width (px), with type of a scale.
    pub(super) fn titles(&self, scale: Scale, [title, caption]: [&str; 2], room: f64) -> [Vec<String>; 2] {
        [
            balanced(self.fonts, title, Weight::SemiBold, Part::Title.size(scale), room),
            wrapped(self.fonts, caption, Weight::Regular, Part::Caption.size(scale), room),
        ]
    }

    /// Writes lines into the boxes of a part of a page, from a left end (px), as many as have room, with type of a scale.
    pub(super) fn lines(&mut self, page: &Solved<Part>, part: Part, scale: Scale, lines: &[String], left: f64) {
        let (weight, colour) = match part {
            Part::Title | Part::Label(_) => (Weight::SemiBold, self.palette.text),
            _ => (Weight::Regular, self.palette.second_text),
        };
        let baselines: Vec<_> = layout::baselines(page, part, scale).collect();
        for (line, &baseline) in cut(lines.to_vec(), baselines.len()).iter().zip(&baselines) {
            self.left(line, weight, part.size(scale), colour, left, baseline);
        }
    }

    /// The lowest baseline of a title and a caption below it that leaves a length free at its right, in a room of a width
    /// (px).
    pub(super) fn beside(
        &self,
        page: &Solved<Part>,
        scale: Scale,
        titles: &[Vec<String>],
        [length, room]: [f64; 2],
    ) -> Option<f64> {
        let parts = [(Part::Title, Weight::SemiBold), (Part::Caption, Weight::Regular)].into_iter().zip(titles);
        let lines = parts.flat_map(|((part, weight), lines)| {
            let widths = lines.iter().map(move |line| self.fonts.width(line, weight, part.size(scale)));
            layout::baselines(page, part, scale).zip(widths)
        });
        let free = lines.filter(|(_, taken)| taken + APART * scale.unit + length <= room);
        free.map(|(baseline, _)| baseline).last()
    }

    /// Letter, name and second line, upper left. `taken` (px) is kept free at the right of the name.
    pub(super) fn heading(&mut self, panel: Rectangle, heading: &Heading<'_>, taken: f64) {
        let words = WordPlaces::new(self.scale, panel);
        let [title, caption] = [self.scale.title(), self.scale.caption()];
        let free = words.width() - if taken > 0.0 { taken + self.scale.gap() } else { 0.0 };
        let baseline = words.title;
        let [letter, reserved] = self.beside_name(heading);
        let left = words.left + letter;
        self.left(&heading.letter, Weight::SemiBold, title, self.palette.second_text, words.left, baseline);
        let free_for_name = free - (left - words.left) - reserved;
        // All names become smaller before one is cut.
        let size = self.size_of_names(heading, free_for_name);
        let name = self.fonts.told_apart(heading.name, heading.names, Weight::SemiBold, size, free_for_name);
        self.left(&name, Weight::SemiBold, size, self.palette.text, left, baseline);
        if let Some(sample) = heading.sample.filter(|_| Scale::legible(title) && !name.is_empty()) {
            let left = left + self.fonts.width(&name, Weight::SemiBold, size) + BESIDE * self.scale.unit;
            self.sample([left, baseline - X_HEIGHT / 2.0 * title], sample);
        }
        self.left(heading.second, Weight::Regular, caption, self.palette.second_text, words.left, words.second);
    }

    /// The common size of names in headings with a room (px). It is smaller than usual if one of them is too wide, but
    /// not smaller than other words.
    fn size_of_names(&self, heading: &Heading<'_>, room: f64) -> f64 {
        let title = self.scale.title();
        let names = heading.names.iter().copied().chain([heading.name]);
        let widest = names.map(|name| self.fonts.width(name, Weight::SemiBold, title)).fold(0.0, f64::max);
        (title * (room / widest.max(f64::MIN_POSITIVE))).clamp(self.scale.caption().min(title), title)
    }

    /// A sample of the line of a run, from a place (px).
    pub(super) fn sample(&mut self, [left, middle]: [f64; 2], LineStyle { colour, dash }: LineStyle) {
        let unit = self.scale.unit;
        let dash: Vec<_> = dash.iter().map(|length| length * unit).collect();
        let ends = [[left, middle], [left + MARGIN * unit, middle]];
        self.marks.push(Item::part("sample", [Item::curve(&ends, BOLD * unit, &dash, colour)]));
    }

    /// Whether the name of a heading is shortened in a room of a width (px).
    pub(super) fn is_shortened(&self, heading: &Heading<'_>, room: f64) -> bool {
        let [first, _] = self.heading_width(heading);
        let name = self.fonts.width(heading.name, Weight::SemiBold, self.scale.title());
        let least = self.size_of_names(heading, 0.0) / self.scale.title();
        first - (1.0 - least) * name > room
    }

    /// The widths of the letter before a name, with its gap, and of the sample behind it (px).
    fn beside_name(&self, heading: &Heading<'_>) -> [f64; 2] {
        let title = self.scale.title();
        let letter = self.fonts.width(&heading.letter, Weight::SemiBold, title) + LETTER_GAP * title;
        let has_sample = heading.sample.is_some() && !heading.name.is_empty();
        let sample = if has_sample { (BESIDE + MARGIN) * self.scale.unit } else { 0.0 };
        [if heading.letter.is_empty() { 0.0 } else { letter }, sample]
    }

    /// The widths of both lines of a heading (px), the first one with letter and sample.
    fn heading_width(&self, heading: &Heading<'_>) -> [f64; 2] {
        let [letter, sample] = self.beside_name(heading);
        let name = self.fonts.width(heading.name, Weight::SemiBold, self.scale.title());
        let second = self.fonts.width(heading.second, Weight::Regular, self.scale.caption());
        [letter + name + sample, second]
    }

    /// Whether the heading leaves no room for the clock.
    pub(super) fn is_crowded(&self, panel: Rectangle, heading: &Heading<'_>, label: &str) -> bool {
        let free = WordPlaces::new(self.scale, panel).width() - self.scale.gap();
        let clock = self.clock_room(panel, label);
        self.heading_width(heading).iter().zip(clock).any(|(heading, clock)| heading + clock > free)
    }

    /// The widths of the clock and its label (px) at any time.
    pub(super) fn clock_room(&self, panel: Rectangle, label: &str) -> [f64; 2] {
        let label = self.clock_label(panel, label);
        let time = self.fonts.width(WIDEST_TIME, Weight::Regular, self.scale.title());
        [time, self.fonts.width(&label, Weight::Regular, self.scale.caption())]
    }

    fn clock_label(&self, panel: Rectangle, label: &str) -> String {
        let room = LABEL_SHARE * WordPlaces::new(self.scale, panel).width();
        self.fonts.shortened(label, Weight::Regular, self.scale.caption(), room)
    }

    /// The clock with its label, upper right.
    pub(super) fn clock(&mut self, panel: Rectangle, time: &str, label: &str) {
        let words = WordPlaces::new(self.scale, panel);
        let [title, caption] = [self.scale.title(), self.scale.caption()];
        let time = self.fonts.shortened(time, Weight::Regular, title, words.width());
        self.right(&time, Weight::Regular, title, self.palette.text, words.right, words.title);
        let label = self.clock_label(panel, label);
        self.right(&label, Weight::Regular, caption, self.palette.second_text, words.right, words.second);
    }

    /// The width of the clock followed by its label (px) at any time.
    pub(super) fn clock_width(&self, around: Scale, label: &str) -> f64 {
        let beside = if label.is_empty() { 0.0 } else { around.gap() };
        let time = self.fonts.width(WIDEST_TIME, Weight::Regular, around.title());
        time + beside + self.fonts.width(label, Weight::Regular, around.caption())
    }

    /// The clock followed by its label, at the right of a picture of a width, with its baseline at a height (px).
    pub(super) fn clock_alone(&mut self, around: Scale, [width, baseline]: [f64; 2], time: &str, label: &str) {
        let (right, palette) = (width - self.scale.margin(), self.palette);
        let room = right - self.scale.margin() - self.clock_width(around, "") - around.gap();
        let label = self.fonts.shortened(label, Weight::Regular, around.caption(), room);
        self.right(&label, Weight::Regular, around.caption(), palette.second_text, right, baseline);
        let beside = self.clock_width(around, &label) - self.clock_width(around, "");
        self.right(time, Weight::Regular, around.title(), palette.text, right - beside, baseline);
    }

    /// Tally and count, lower left, each between two places from the left margin (px). The words below the count may go on to `end`: they
    /// tell how many elements are flat or, beside broken ones, turned over, or with names of bodies the count of each, if there is room.
    pub(super) fn count(
        &mut self,
        panel: Rectangle,
        (places, end): ([[f64; 2]; 2], f64),
        (tally, names): (&Tally, &[&str]),
        snapshot: &Snapshot,
    ) {
        let words = WordPlaces::new(self.scale, panel);
        let [title, caption] = [self.scale.title(), self.scale.caption()];
        let Snapshot { turned_over, flat, broken, broken_springs, .. } = snapshot;
        let states = [&turned_over[..], &flat[..], &broken[..]];
        let [over, flattened, gone] = states.map(|state| state.iter().filter(|&&is_so| is_so).count());
        let (count, state, which) = match broken.is_empty() {
            true => (over, TURNED_OVER, turned_over),
            // Without all of its springs an element may be whole.
            false if !broken_springs.is_empty() => (gone, "in pieces", broken),
            false => (gone, "broken", broken),
        };
        let (colour, second) = match (state, count) {
            (TURNED_OVER, 1..) => (self.palette.alarm_text, self.palette.alarm_text),
            _ => (self.palette.text, self.palette.second_text),
        };
        let [(first, tally_room), (left, free)] = places.map(|[from, to]| (words.left + from, to - from));
        let end = words.left + end;
        let corner = [first, words.caption];
        tally.draw(states, self.palette, self.scale, tally_room, corner, &mut self.marks);
        let [count, all] = [count, turned_over.len()].map(number::count);
        // The widest count decides, so that it is the same in all frames. A number with an ellipsis is another number.
        let wide = |text: &str| self.fonts.width(text, Weight::SemiBold, title);
        let wordings = [(format!("{all} of {all}"), format!("{count} of {all}")), (all, count)];
        if let Some((_, count)) = wordings.into_iter().find(|(widest, _)| wide(widest) <= free) {
            self.left(&count, Weight::SemiBold, title, colour, left, words.count);
        }
        let (also, what) = if state == TURNED_OVER { (flattened, "flat") } else { (over, TURNED_OVER) };
        let with_others = (also > 0).then(|| format!("{state}, {} {what}", number::count(also)));
        let of_bodies = of_bodies(state, names, tally.counts(which));
        let fits = |text: &String, room| self.fonts.width(text, Weight::Regular, caption) <= room;
        let with_others = with_others.filter(|text| fits(text, end - left));
        // What stands here in one frame stands here in all.
        let state = of_bodies.filter(|text| fits(text, free)).or(with_others).unwrap_or_else(|| state.to_owned());
        let free = free.max(end - left);
        if !Scale::legible(caption) {
            return;
        }
        let state = self.fonts.shortened(&state, Weight::Regular, caption, free);
        self.left(&state, Weight::Regular, caption, second, left, words.caption);
    }

    /// The width of the widest count of a number of elements (px), and of the widest count of the elements of bodies.
    pub(super) fn count_widths(&self, names: &[&str], tally: &Tally) -> [f64; 2] {
        let every = tally.sizes();
        let all = number::count(every.iter().sum());
        let widest = self.fonts.width(&format!("{all} of {all}"), Weight::SemiBold, self.scale.title());
        let caption = |text: &str| self.fonts.width(text, Weight::Regular, self.scale.caption());
        let least = widest.max(caption(TURNED_OVER)).ceil();
        let of_bodies = of_bodies(TURNED_OVER, names, every.into_iter());
        [of_bodies.map_or(least, |text| caption(&text).ceil().max(least)), least]
    }

    /// The widths of what stands at the lower right (px): that a run diverges, or the widest number, if there is one, in its longest and in its
    /// shortest wording.
    pub(super) fn number_widths(&self, usual: Option<&Number>) -> [f64; 2] {
        let diverged = self.fonts.width(DIVERGES, Weight::SemiBold, self.scale.title());
        let widest = |texts: fn(&[[String; 2]]) -> Option<&[String; 2]>| {
            usual.and_then(|usual| Some(self.number_width(usual, texts(&usual.wordings)?))).unwrap_or(0.0)
        };
        [widest(<[_]>::first), widest(<[_]>::last)].map(|width| width.max(diverged).ceil())
    }

    fn number_width(&self, number: &Number, [value, explained]: &[String; 2]) -> f64 {
        let wide = |text| self.fonts.width(text, number.weight(), self.scale.title());
        let explained = self.fonts.width(explained, Weight::Regular, self.scale.caption());
        wide(&number.widest).max(wide(value)).max(explained)
    }

    /// A number with its name, lower right, in the longest wording with room right of a place from the left margin (px).
    pub(super) fn number(&mut self, panel: Rectangle, taken: f64, number: &Number) {
        let words = WordPlaces::new(self.scale, panel);
        let [title, caption] = [self.scale.title(), self.scale.caption()];
        // A number without its name means nothing.
        if !Scale::legible(caption) && !number.is_loud {
            return;
        }
        let free = words.width() - taken - if taken > 0.0 { self.scale.gap() } else { 0.0 };
        let mut wordings = number.wordings.iter();
        let Some([value, explained]) = wordings.find(|texts| self.number_width(number, texts) <= free) else { return };
        self.right(value, number.weight(), title, self.palette.text, words.right, words.count);
        let colour = self.palette.second_text;
        self.right(explained, Weight::Regular, caption, colour, words.right, words.caption);
    }

    /// The width of a scale bar of a length with its words (px).
    pub(super) fn bar_width(&self, text: &str, pixels: f64) -> f64 {
        pixels.max(self.fonts.width(text, Weight::Regular, self.scale.caption())).ceil()
    }

    /// The first of some scale bars, in words and px, that fits between two places from the left margin, centred there.
    /// Returns its left and its right end (px).
    pub(super) fn scale_bar(
        &mut self,
        panel: Rectangle,
        [from, to]: [f64; 2],
        mut bars: impl Iterator<Item = (String, f64)>,
    ) -> Option<[f64; 2]> {
        let words = WordPlaces::new(self.scale, panel);
        let (unit, caption, colour) = (self.scale.unit, self.scale.caption(), self.palette.second_text);
        let (text, pixels) = bars.find(|(text, pixels)| self.bar_width(text, *pixels) <= to - from + 1e-6)?;
        let middle = words.left + from.midpoint(to);
        let [length, thickness] = [pixels, STRONG * self.scale.line()].map(|length| length.round().max(1.0));
        let (left, top) = ((middle - 0.5 * length).round(), (words.count - NEAR * unit).round());
        let tick = (NEAR * unit).round().max(thickness);
        let ends = [left, left + length - thickness].map(|x| [x, top - 0.5 * (tick - thickness), thickness, tick]);
        for [x, y, width, height] in [[left, top, length, thickness]].into_iter().chain(ends) {
            self.marks.push(Item::rectangle([x, y.round(), width, height], colour));
        }
        let wide = self.fonts.width(&text, Weight::Regular, caption);
        self.left(&text, Weight::Regular, caption, colour, middle - 0.5 * wide, words.caption);
        Some([-0.5, 0.5].map(|side| from.midpoint(to) + side * pixels.max(wide)))
    }

    /// Hairlines between adjacent panels.
    pub(super) fn hairlines(&mut self, layout: &Layout) {
        let side = self.scale.margin();
        let [top_inset, bottom_inset] = self.scale.edges.map(|edge| edge * self.scale.unit);
        // A hairline of one pixel between two pixels would fill half of both.
        let thickness = (2.0 * self.scale.unit).round().max(1.0);
        let (line, ground) = (self.palette.hairline, self.palette.background);
        let halved = if thickness < 2.0 { line } else { std::array::from_fn(|at| line[at].midpoint(ground[at])) };
        let bottoms = || layout.panels.iter().map(|&[_, top, _, height]| f64::from(top + height));
        for panel in &layout.panels {
            let [left, top, width, height] = panel.map(f64::from);
            let mut line = |rectangle| self.marks.push(Item::rectangle(rectangle, halved));
            let length = (height - top_inset - bottom_inset).round();
            if left > 0.0 && length > 0.0 {
                line([left - (thickness / 2.0).floor(), top + top_inset.round(), thickness, length]);
            }
            let above = bottoms().filter(|&bottom| bottom <= top).reduce(f64::max);
            if let Some(above) = above.filter(|_| width > 2.0 * side) {
                line([left + side.round(), above - (thickness / 2.0).floor(), (width - 2.0 * side).round(), thickness]);
            }
        }
    }

    pub(super) fn left(&mut self, text: &str, weight: Weight, size: f64, colour: Colour, left: f64, baseline: f64) {
        if Scale::legible(size) && !text.is_empty() {
            let run = self.fonts.lay_out(text, weight, size, colour, left, baseline);
            self.words.push(run);
        }
    }

    pub(super) fn right(&mut self, text: &str, weight: Weight, size: f64, colour: Colour, right: f64, baseline: f64) {
        let left = right - self.fonts.width(text, weight, size);
        self.left(text, weight, size, colour, left, baseline);
    }
}

/// The number of elements of each named body in a state, in words; `None` without names.
fn of_bodies(state: &str, names: &[&str], counts: impl Iterator<Item = usize>) -> Option<String> {
    let each: Vec<_> =
        names.iter().zip(counts).map(|(name, count)| format!("{name} {}", number::count(count))).collect();
    (!each.is_empty()).then(|| format!("{state}: {}", each.join(", ")))
}

/// The letter of a panel: a to z, then aa, ab and so on.
pub(super) fn letter(at: usize) -> String {
    let last = char::from(b'a' + (at % 26) as u8);
    if at < 26 { last.to_string() } else { format!("{}{last}", letter(at / 26 - 1)) }
}

/// Replaces the number of a run that diverges within the shown time of a scene that lasts `span` (s): when it diverges, and which moment is
/// shown from then on.
pub(super) fn divergence(run: &RunFrame, span: f64) -> Option<Number> {
    let Status::Diverged(Divergence { time, is_end, .. }) = run.shown().status else { return None };
    let (loud, at) = (diverges(run), format!("at {}", number::time(time, span)));
    let whole = shown_moment(run, time, span).map(|shown| [format!("{loud} {at}"), shown]);
    let alone = [[loud.to_owned(), at.clone()], [loud.to_owned(), String::new()]];
    let short = [[ENDED.to_owned(), at], [ENDED.to_owned(), String::new()]].into_iter().filter(|_| is_end);
    let wordings = whole.into_iter().chain(alone).chain(short).collect();
    Some(Number { widest: String::new(), wordings, is_loud: true })
}

/// Which moment is shown of a run that diverges at a time (s), in words, if it is another one.
pub(super) fn shown_moment(run: &RunFrame, time: f64, span: f64) -> Option<String> {
    let shown = number::time(run.last_fit.as_ref()?.time, span);
    (shown != number::time(time, span)).then(|| format!("shown as at {shown}"))
}

/// The word for a run that diverges or whose recording ends.
pub(super) fn diverges(run: &RunFrame) -> &'static str {
    match run.shown().status {
        Status::Diverged(Divergence { is_end: true, .. }) => RECORDING_ENDS,
        _ => DIVERGES,
    }
}

/// The number at the lower right of a run that has not diverged, of a body of an extent (m).
pub(super) fn number(extent: f64, snapshot: &Snapshot, area_ratio: Option<f64>) -> Number {
    let (value, widest, names) = match area_ratio {
        Some(ratio) => (number::ratio(ratio), "−0.00".to_owned(), ["smallest area ratio", "area ratio"]),
        None => {
            let length = |metres: f64| number::length(metres, extent);
            (length(snapshot.diagnostics.shape_error), length(0.888 * extent), ["shape error", "error"])
        }
    };
    let wordings = names.map(|name| [value.clone(), name.to_owned()]).to_vec();
    Number { widest, wordings, is_loud: false }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{BodyBuilder, Lattice, Limits, Scene};
    use crate::sim::model::shape_based;

    #[test]
    fn captions_name_unusual_choices() {
        let body = BodyBuilder::lattice(Lattice::new([1; 3], 0.1)).mass(1.0);
        let shape = shape_based::Parameters { damping: Some(60.0), ..shape_based::Parameters::new(1e4) };
        let scene = Scene::builder("cube", body).run("shape", shape).build(&Limits::default()).expect("a scene");
        let caption = short_description(&scene, &scene.runs[0]);
        assert_eq!(caption, "1 cube, k = 10 kN/m, ζ = 0.3, exact rotations");
    }

    #[test]
    fn letters_go_on_after_the_last() {
        assert_eq!([0, 25, 26, 51, 52, 701, 702].map(letter), ["a", "z", "aa", "az", "ba", "zz", "aaa"]);
    }
}
