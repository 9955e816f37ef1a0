//! What the scene looks like: colours, type, lines and margins.

use super::file::{ShowFile, ViewFile};
use super::palette::{LEAST_CONTRAST, LINE_CONTRAST, Palette};
use super::ramp::ramp;
use super::typed::{BackgroundFile, ColoursFile};
use super::view::{FloorStyle, FontFiles, Look, Theme};
use crate::colour::{Colour, Sight, contrast, difference, readable, written};
use crate::reading::report::{Report, Way};

/// How different turned-over elements look from sound ones, at least, to anybody (CIEDE2000).
const LEAST_DIFFERENCE: f64 = 20.0;

/// The look, or `None` if there is a mistake in it.
pub(crate) fn resolve(typed: &ViewFile, font: FontFiles, report: &mut Report<'_>) -> Option<Look> {
    let background = match typed.background {
        Some(BackgroundFile::Colour(colour)) => Some(colour.0),
        Some(BackgroundFile::Transparent) | None => None,
    };
    let theme = Palette::theme_on(background, typed.theme);
    let palette = Palette::with(theme, background, &typed.colours);
    let known = report.total();
    let transparent = typed.background == Some(BackgroundFile::Transparent);
    // Where no floor is drawn there are no words on it.
    let floor = typed.colours.floor.filter(|_| !transparent && typed.floor != FloorStyle::None);
    check_text(&typed.colours, floor.map(|floor| floor.0), &palette, report);
    check_alarm(&typed.colours, &palette, report);
    check_field(typed, theme, &palette, report);
    (report.total() == known).then(|| {
        let (text_scale, line_scale, margin) = (typed.text_scale, typed.line_scale, typed.margin);
        Look { theme, palette, transparent, font, text_scale, line_scale, margin }
    })
}

fn way(role: &str) -> [Way<'_>; 3] {
    [Way::Key("view"), Way::Key("colours"), Way::Key(role)]
}

/// Words must be readable, on the floor, too.
fn check_text(typed: &ColoursFile, floor: Option<Colour>, palette: &Palette, report: &mut Report<'_>) {
    if let Some(floor) = floor {
        let texts = [palette.text, palette.second_text, palette.alarm_text];
        let found = texts.map(|text| contrast(text, floor)).into_iter().fold(f64::INFINITY, f64::min);
        if found < LEAST_CONTRAST {
            let message = format!(
                "text on `view.colours.floor` would have a contrast of {} to 1; expected at least {LEAST_CONTRAST} to 1",
                rounded_down(found)
            );
            report.at(&way("floor"), message, "bring the floor nearer to the background".to_owned());
        }
    }
    let Some(text) = typed.text.map(|text| text.0) else { return };
    let found = contrast(text, palette.background);
    if found < LEAST_CONTRAST {
        let message = format!(
            "`view.colours.text` has a contrast of {} to 1 with the background {}; expected at least {LEAST_CONTRAST} to 1",
            rounded_down(found),
            written(palette.background)
        );
        let towards = if palette.is_made_for_light() { "darker" } else { "lighter" };
        report.at(&way("text"), message, format!("make it {towards}, or remove it: it follows the background"));
    }
}

/// The colours that runs have of their own must be seen on the background, and not be taken for that of turned-over
/// elements.
pub(crate) fn check_runs(chosen: &[Option<Colour>], palette: &Palette, report: &mut Report<'_>) {
    let like_alarm = |colour: Colour| {
        let measured = Sight::ALL.map(|sight| (difference(colour, palette.alarm, sight), sight));
        let nearest = measured.into_iter().min_by(|one, other| one.0.total_cmp(&other.0));
        nearest.filter(|(found, _)| *found < LEAST_DIFFERENCE)
    };
    for (at, &colour) in chosen.iter().enumerate() {
        let Some(colour) = colour else { continue };
        let path = [Way::Key("run"), Way::Index(at), Way::Key("colour")];
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
        } else if let Some((found, sight)) = like_alarm(colour) {
            let message = format!(
                "`run[{at}].colour` is too similar to that of turned-over elements, {}: to {} they differ by {} (CIEDE2000); \
                 expected at least {LEAST_DIFFERENCE}",
                written(palette.alarm),
                sight.name(),
                rounded_down(found)
            );
            report.at(&path, message, "choose another hue, or remove it".to_owned());
        }
    }
}

/// Nobody may take a turned-over element for a sound one.
fn check_alarm(typed: &ColoursFile, palette: &Palette, report: &mut Report<'_>) {
    let (key, other) = match (typed.turned_over, typed.body) {
        (Some(_), _) => ("turned_over", "the body's"),
        (None, Some(_)) => ("body", "that of turned-over elements,"),
        (None, None) => return,
    };
    let pairs = [(palette.sound, "in space"), (palette.sound_flat, "in the plane")];
    let seen = pairs.iter().flat_map(|&(sound, place)| Sight::ALL.map(|sight| (sound, place, sight)));
    let measured = seen.map(|(sound, place, sight)| (difference(sound, palette.alarm, sight), sound, place, sight));
    let nearest = measured.min_by(|one, other| one.0.total_cmp(&other.0));
    let Some((found, sound, place, sight)) = nearest.filter(|(found, ..)| *found < LEAST_DIFFERENCE) else { return };
    let opposite: Colour = if key == "body" { palette.alarm } else { sound };
    let message = format!(
        "`view.colours.{key}` is too similar to {other} {} {place}: to {} they differ by {} (CIEDE2000); expected at least \
         {LEAST_DIFFERENCE}",
        written(opposite),
        sight.name(),
        rounded_down(found)
    );
    report.at(&way(key), message, "choose another hue, or make one of them much lighter than the other".to_owned());
}

/// Nor for one that a field colours, where no hatch tells them apart.
fn check_field(typed: &ViewFile, theme: Theme, palette: &Palette, report: &mut Report<'_>) {
    let shows_surfaces = typed.show.as_ref().is_none_or(|shown| shown.contains(&ShowFile::Surfaces));
    let Some(colour) = typed.colour.as_ref().filter(|_| !typed.hatch && shows_surfaces) else { return };
    let shades = ramp(colour.map, theme);
    let seen = shades.iter().flat_map(|&shade| Sight::ALL.map(|sight| (shade, sight)));
    let measured = seen.map(|(shade, sight)| (difference(shade, palette.alarm, sight), shade, sight));
    let nearest = measured.min_by(|one, other| one.0.total_cmp(&other.0));
    let Some((found, shade, sight)) = nearest.filter(|(found, ..)| *found < LEAST_DIFFERENCE) else { return };
    let message = format!(
        "without hatching, only their colour distinguishes turned-over elements from the field, and {} is too similar to \
         {} on its scale: to {} they differ by {} (CIEDE2000); expected at least {LEAST_DIFFERENCE}",
        written(palette.alarm),
        written(shade),
        sight.name(),
        rounded_down(found)
    );
    let help = "remove `hatch`, or choose another `view.colour.map` or `view.colours.turned_over`".to_owned();
    report.at(&[Way::Key("view"), Way::Key("hatch")], message, help);
}

/// A number with one digit behind the point, never more than it is: what falls short by a little must not look enough.
fn rounded_down(number: f64) -> f64 {
    (number * 10.0).floor() / 10.0
}
