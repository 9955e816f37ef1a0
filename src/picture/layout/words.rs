//! The rows of words in a panel, above and below its body.

use super::Part;
use super::scale::{ASCENT, Rectangle, Scale};
use super::steps::{GAP, NEAR, ROW};
use super::tree::{self, Node};
use crate::look::{Labels, Plot, View};

/// The part of a panel that its body keeps.
const BODY: f64 = 0.56;

/// The text in a panel.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::picture) struct WordsShown {
    pub(in crate::picture) labels: Labels,
    /// Whether there is a second line, with the model and the start of the clock.
    pub(in crate::picture) second: bool,
    /// Whether there is a line for events.
    pub(in crate::picture) events: bool,
    /// The heights above and below the body (px).
    rooms: [f64; 2],
    /// The rows without room.
    pub(in crate::picture) left_out: Vec<Part>,
}

/// The text in a panel of a height (px), with `unit` pixels per pixel of the reference picture. If not all of it fits
/// beside the body, first the events are left out, then the second line, then the text below.
pub(in crate::picture) fn written(view: &View, height: f64, unit: f64) -> WordsShown {
    let scale = Scale::at(unit).within(view);
    let Labels { letters, name, model, clock, count, number, scale_bar, .. } = view.labels;
    let (second, events) = (model || clock, view.charts.iter().any(Plot::is_over_time));
    let [has_heading, has_numbers] = [letters || name || second || events, count || number || scale_bar];
    let edge = |end: usize, has_words| Node::new(Part::Edge, if has_words { scale.edges[end] } else { ROW } * unit);
    let row = |part: Part, rank: u8| Node::new(part, part.height(scale)).rank(rank);
    let numbers = || Node::new(Part::Numbers, scale.numbers().iter().sum()).rank(2);
    let nodes: Vec<_> = std::iter::once(edge(0, has_heading))
        .chain(has_heading.then(|| row(Part::Name, 3)))
        .chain(second.then(|| row(Part::Second, 1)))
        .chain(events.then(|| row(Part::Events, 0)))
        .chain([Node::new(Part::Body, BODY * height).stretched()])
        .chain(has_numbers.then(numbers))
        .chain([edge(1, has_numbers)])
        .collect();
    let mut solved = tree::column(&nodes, [0.0, 0.0, 0.0, height]);
    // Rows that cannot be read stay empty, and rows below a name without room.
    let sizes = [Part::Name, Part::Second, Part::Events].map(|part| (part, part.size(scale)));
    let sizes = sizes.into_iter().chain([(Part::Numbers, scale.title())]);
    let nameless = |part| solved.get(Part::Name).is_none() && part != Part::Numbers;
    let empty = sizes.filter(|&(part, size)| solved.get(part).is_some() && (nameless(part) || !Scale::legible(size)));
    solved.left_out.extend(empty.map(|(part, _)| part).collect::<Vec<_>>());
    let has = |part| solved.get(part).is_some() && !solved.left_out.contains(&part);
    let [above, room] = solved.get(Part::Body).map_or([0.0, height], |[_, top, _, height]| [top, height]);
    let (names, numbers) = (has(Part::Name), has(Part::Numbers));
    // A row keeps its place where the row above it has nothing to say.
    WordsShown {
        labels: Labels {
            letters: letters && names,
            name: name && names,
            model: model && has(Part::Second),
            clock: clock && names,
            count: count && numbers,
            number: number && numbers,
            // A count says something without the small words below it.
            scale_bar: scale_bar && numbers && Scale::legible(scale.caption()),
            ..view.labels
        },
        second: has(Part::Second),
        events: has(Part::Events),
        rooms: [above, height - above - room],
        left_out: solved.left_out,
    }
}

/// The heights for words above and below the body (px in the reference picture), in a panel of a height (px), where the
/// pixels of the reference picture have a size of `unit` pixels.
pub(in crate::picture) fn rooms(view: &View, height: f64, unit: f64) -> [f64; 2] {
    written(view, height, unit).rooms.map(|room| room / unit)
}

/// The places of the words in a panel (px).
pub(in crate::picture) struct WordPlaces {
    /// The left and the right end of their room.
    pub(in crate::picture) left: f64,
    pub(in crate::picture) right: f64,
    // Baselines.
    pub(in crate::picture) title: f64,
    pub(in crate::picture) second: f64,
    pub(in crate::picture) events: f64,
    pub(in crate::picture) count: f64,
    pub(in crate::picture) caption: f64,
}

impl WordPlaces {
    pub(in crate::picture) fn new(scale: Scale, panel: Rectangle) -> Self {
        let [name, second] = [Part::Name, Part::Second].map(|part| part.height(scale));
        let [count, below] = scale.numbers();
        let [left, start, width, height] = panel.map(f64::from);
        let [top, bottom] = scale.edges.map(|edge| edge * scale.unit);
        let bottom = height - bottom;
        let [large, small] = [scale.title(), scale.caption()].map(|size| ASCENT * size);
        Self {
            left: left + scale.margin(),
            right: left + width - scale.margin(),
            title: start + (top + large),
            second: start + (top + name + small),
            events: start + (top + name + second + small),
            count: start + (bottom - below - count + large),
            caption: start + (bottom - below + small),
        }
    }

    /// The width of their room.
    pub(in crate::picture) fn width(&self) -> f64 {
        (self.right - self.left).max(0.0)
    }
}

/// The part of a panel of a view between its lines of text, inside its margins.
pub(in crate::picture) fn clear_of_words(panel: Rectangle, view: &View, scale: Scale) -> Rectangle {
    let [left, top, width, height] = panel;
    let [above, below] = written(view, f64::from(height), scale.unit).rooms;
    let inside = |at: f64, length: u32| at.clamp(0.0, f64::from(length)) as u32;
    let side = inside(scale.margin(), width / 2);
    let above = inside(above + NEAR * scale.unit, height);
    let below = inside(f64::from(height) - below - GAP * scale.unit, height).max(above);
    [left + side, top + above, width - 2 * side, below - above]
}
