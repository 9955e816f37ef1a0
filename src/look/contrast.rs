//! Checks the contrast and the difference of colours.

use super::palette::Palette;
use super::view::Colours;
use crate::colour::{Colour, LINE_CONTRAST, Vision, contrast, difference, readable, written};
use crate::reading::collector::{Collector, PathPart};
use std::fmt;

/// The least difference of turned-over elements from others, for any colour vision (CIEDE2000).
const LEAST_DIFFERENCE: f64 = 20.0;

fn path(role: &str) -> [PathPart<'_>; 3] {
    [PathPart::Key("view"), PathPart::Key("colours"), PathPart::Key(role)]
}

/// Checks the contrast of runs' chosen colours with the background, and their difference from turned-over elements.
pub(crate) fn check_runs(chosen: &[Option<Colour>], palette: &Palette, report: &mut Collector<'_>) {
    let like_alarm = |colour| TooLike::find([(colour, ())], palette.alarm);
    for (at, &colour) in chosen.iter().enumerate() {
        let Some(colour) = colour else { continue };
        let path = [PathPart::Key("run"), PathPart::Index(at), PathPart::Key("colour")];
        let found = contrast(colour, palette.background);
        if found < LINE_CONTRAST {
            let message = format!(
                "`run[{at}].colour` has a contrast of {} to 1 with the background {}; expected at least {LINE_CONTRAST} \
                 to 1",
                rounded_down(found),
                written(palette.background)
            );
            let other = readable(colour, palette.background, LINE_CONTRAST);
            let towards = if palette.is_made_for_light() { "darker" } else { "lighter" };
            let help = match like_alarm(other) {
                None => format!("make it {towards}, such as \"{}\"", written(other)),
                Some(_) => {
                    format!("choose another hue; this one, made {towards}, would be similar to turned-over elements")
                }
            };
            report.at(&path, message, help);
        } else if let Some(found) = like_alarm(colour) {
            let alarm = written(palette.alarm);
            let message =
                format!("`run[{at}].colour` is too similar to the colour of turned-over elements, {alarm}: {found}");
            report.at(&path, message, "choose another hue, or remove it".to_owned());
        }
    }
}

/// Checks the difference of turned-over elements from others.
pub(super) fn check_alarm(typed: &Colours, palette: &Palette, report: &mut Collector<'_>) {
    let (key, other) = match (typed.turned_over, typed.body) {
        (Some(_), _) => ("turned_over", "the body's"),
        (None, Some(_)) => ("body", "the colour of turned-over elements,"),
        (None, None) => return,
    };
    let sound = [(palette.sound, "in space"), (palette.sound_flat, "in the plane")];
    let Some(found) = TooLike::find(sound, palette.alarm) else { return };
    let opposite = written(if key == "body" { palette.alarm } else { found.colour });
    let message = format!("`view.colours.{key}` is too similar to {other} {opposite} {}: {found}", found.place);
    report.at(&path(key), message, "choose another hue, or make one of them much lighter than the other".to_owned());
}

/// A colour that may be mistaken for the colour of turned-over elements.
struct TooLike<T> {
    colour: Colour,
    /// Its use.
    place: T,
    difference: f64,
    vision: Vision,
}

impl<T: Copy> TooLike<T> {
    /// The colour most similar to that of turned-over elements for any colour vision; `None` if all differ enough.
    fn find(colours: impl IntoIterator<Item = (Colour, T)>, alarm: Colour) -> Option<Self> {
        let seen = colours.into_iter().flat_map(|(colour, place)| Vision::ALL.map(|vision| (colour, place, vision)));
        let measured = seen.map(|(colour, place, vision)| {
            let difference = difference(colour, alarm, vision);
            Self { colour, place, difference, vision }
        });
        let nearest = measured.min_by(|one, other| one.difference.total_cmp(&other.difference));
        nearest.filter(|nearest| nearest.difference < LEAST_DIFFERENCE)
    }
}

impl<T> fmt::Display for TooLike<T> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (eyes, found) = (self.vision.name(), rounded_down(self.difference));
        write!(out, "to {eyes} they differ by {found} (CIEDE2000); expected at least {LEAST_DIFFERENCE}")
    }
}

/// A number rounded down to one decimal, so that a value just below a limit does not seem to meet it.
fn rounded_down(number: f64) -> f64 {
    (number * 10.0).floor() / 10.0
}
