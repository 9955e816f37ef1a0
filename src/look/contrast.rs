//! Checks the contrast and the difference of colours.

use super::palette::Palette;
use crate::colour::{Colour, LINE_CONTRAST, Vision, contrast, difference, readable, written};
use crate::reading::collector::Collector;

/// The least difference of turned-over elements from others, for any colour vision (CIEDE2000).
const LEAST_DIFFERENCE: f64 = 20.0;

/// Checks the contrast of runs' chosen colours with the background, and their difference from turned-over elements.
pub(crate) fn check_runs(chosen: &[Option<Colour>], palette: &Palette, report: &Collector<'_>) {
    let like_alarm = |colour| too_like(colour, palette.alarm);
    for (at, &colour) in chosen.iter().enumerate() {
        let Some(colour) = colour else { continue };
        let here = report.to("run").to(at).to("colour");
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
            here.wrong(message, help);
        } else if let Some(found) = like_alarm(colour) {
            let alarm = written(palette.alarm);
            let message =
                format!("`run[{at}].colour` is too similar to the colour of turned-over elements, {alarm}: {found}");
            here.wrong(message, "choose another hue, or remove it");
        }
    }
}

/// How little a colour differs from that of turned-over elements, for the eyes that see the least difference; `None` if it
/// differs enough for all.
fn too_like(colour: Colour, alarm: Colour) -> Option<String> {
    let seen = Vision::ALL.map(|vision| (difference(colour, alarm, vision), vision.name()));
    let (found, eyes) = seen.into_iter().min_by(|one, other| one.0.total_cmp(&other.0))?;
    let found = Some(found).filter(|found| *found < LEAST_DIFFERENCE).map(rounded_down)?;
    Some(format!("to {eyes} they differ by {found} (CIEDE2000); expected at least {LEAST_DIFFERENCE}"))
}

/// A number rounded down to one decimal, so that a value just below a limit does not seem to meet it.
fn rounded_down(number: f64) -> f64 {
    (number * 10.0).floor() / 10.0
}
