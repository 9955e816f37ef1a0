//! The properties of views, palettes and bodies that only drawing needs.

use super::palette::Palette;
use super::print::Print;
use super::run_lines::{DASHES, LinePlace};
use super::view::{ColourScale, EdgeStyle, Labels};
use crate::colour::{Colour, LEAST_CONTRAST, LINE_CONTRAST, Oklab, from_oklab, mixed, oklab, readable};
use crate::reading::captions::rounded;

/// The smallest type that is printed (pt).
const LEAST_POINTS: f64 = 5.0;
/// The share of the background in the greys of a diverged run.
const GREYED: f64 = 0.45;

/// The style of the line of a run: of its curves in charts and of samples beside its name. Its arrows have the same
/// colour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LineStyle {
    /// Its colour.
    pub colour: Colour,
    /// Lengths of its dashes and gaps in turn (px in the reference picture); empty for a solid line.
    pub dash: &'static [f64],
}

impl Palette {
    /// The colour of signs on sound elements in the plane: the edges' colour, a third of the way to the elements'.
    pub(crate) fn sign(&self) -> Colour {
        std::array::from_fn(|at| ((2 * u16::from(self.edge[at]) + u16::from(self.bodies_flat[0][at])) / 3) as u8)
    }

    /// The tint of ghosts of shapes on the background.
    pub(crate) fn edge_on_ground(&self) -> Colour {
        if self.is_made_for_light() { self.edge } else { self.outline }
    }

    /// The palette with the colours of bodies and their lines greyed, for a diverged run.
    pub(crate) fn greyed(&self) -> Self {
        let grey = |colour| {
            let grey = from_oklab(Oklab([oklab(colour).0[0], 0.0, 0.0]));
            mixed(grey, self.background, GREYED)
        };
        let Self { bodies, bodies_flat, node, alarm, alarm_line, edge, outline, spring, spring_on_body, .. } = *self;
        let [bodies, bodies_flat] = [bodies, bodies_flat].map(|colours| colours.map(grey));
        let [node, alarm] = [node, alarm].map(grey);
        let [alarm_line, edge, outline] = [alarm_line, edge, outline].map(grey);
        let [spring, spring_on_body] = [spring, spring_on_body].map(grey);
        Self { bodies, bodies_flat, node, alarm, alarm_line, edge, outline, spring, spring_on_body, ..*self }
    }

    /// The legible colour for words on the background that is nearest to a given one.
    pub(crate) fn text_like(&self, colour: Colour) -> Colour {
        readable(colour, self.background, LEAST_CONTRAST)
    }

    /// The line of a run, the same in every picture of its scene. Colours are made lighter or darker to be visible on the background.
    pub(crate) fn line(&self, place: LinePlace, chosen: Option<Colour>) -> LineStyle {
        let colour = chosen.unwrap_or(self.runs[place.colour]);
        LineStyle { colour: readable(colour, self.background, LINE_CONTRAST), dash: DASHES[place.dash] }
    }

    /// The dashes (px in the reference picture) of a curve, by its number among those of its colour. The first is solid; there are eight.
    pub(crate) fn dash(&self, number: usize) -> &'static [f64] {
        DASHES[number % DASHES.len()]
    }
}

impl Print {
    /// Why type of a size (px) is not printed, and the remedy; `None` if it is large enough.
    pub(crate) fn too_small(&self, pixels: f64) -> Option<[String; 2]> {
        let (points, [width, height]) = (self.points(pixels), self.mm);
        (points < LEAST_POINTS - 1e-6).then(|| {
            let message = format!(
                "at {width} × {height} mm the smallest type would be {} pt; expected at least {LEAST_POINTS} pt",
                rounded(points, 2)
            );
            [message, "make `size` larger, or type with `text_scale`".to_owned()]
        })
    }

    /// Where the size is given, for messages; `file` has it.
    pub(crate) fn place(&self, file: &str) -> String {
        match self.at {
            (0, _) => file.to_owned(),
            (line, column) => format!("{file}:{line}:{column}"),
        }
    }
}

impl Labels {
    /// Whether panels have words.
    pub(crate) fn are_in_panels(&self) -> bool {
        let Self { letters, name, model, clock, count, number, scale_bar: _, legend: _ } = *self;
        [letters, name, model, clock, count, number].contains(&true)
    }
}

impl EdgeStyle {
    /// Whether edges in front of the body, and behind it, are drawn.
    pub(crate) fn are_drawn(self) -> [bool; 2] {
        [self != Self::Outline, self == Self::All]
    }
}

impl ColourScale {
    /// The value of a spring with a relative change of length.
    pub(crate) fn of_spring(&self, strain: f64) -> f64 {
        if self.range[0] < 0.0 { strain } else { strain.abs() }
    }
}
