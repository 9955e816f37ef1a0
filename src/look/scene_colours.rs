//! The colours of a scene: a chosen background replaces the theme's, and related colours follow it.

use super::palette::{Palette, Theme};
use crate::colour::{Colour, LEAST_CONTRAST, best_of, contrast, mixed, readable};

/// The contrast of text whose colour is chosen here, with some reserve for a floor below it.
const GOOD_CONTRAST: f64 = 5.0;

impl Palette {
    /// The theme whose text is legible on a background: the requested one, if possible.
    pub(crate) fn theme_on(background: Option<Colour>, theme: Theme) -> Theme {
        let Some(ground) = background else { return theme };
        let other = if theme == Theme::Light { Theme::Dark } else { Theme::Light };
        let [own, others] = [theme, other].map(|theme| contrast(Self::of(theme).text, ground));
        if own >= LEAST_CONTRAST || own >= others { theme } else { other }
    }

    /// The colours of a theme on a background. Floor, lines and secondary text are between the text and the background,
    /// at the same relative distances as in the theme. Words are legible.
    pub(crate) fn with(theme: Theme, background: Option<Colour>) -> Self {
        let theme = Self::of(theme);
        let Some(ground) = background.filter(|ground| *ground != theme.background) else { return theme };
        let is_legible = contrast(theme.text, ground) >= LEAST_CONTRAST;
        let text = if is_legible { theme.text } else { best_of(&[theme.text, [0; 3], [255; 3]], ground) };
        let share = |colour| share(theme.text, theme.background, colour);
        let between = |colour| mixed(text, ground, share(colour));
        let least = LEAST_CONTRAST.min(contrast(text, ground));
        let own = share(theme.second_text);
        let mut fainter = (0..=20).map(|step| mixed(text, ground, own * f64::from(20 - step) / 20.0));
        // Black or white has a contrast of at least 4.58 with any ground.
        let most = contrast([0; 3], ground).max(contrast([255; 3], ground));
        Self {
            background: ground,
            floor: between(theme.floor),
            grid: between(theme.grid),
            text,
            second_text: fainter.find(|&second| contrast(second, ground) >= least).unwrap_or(text),
            axis: between(theme.axis),
            hairline: between(theme.hairline),
            alarm_text: readable(theme.alarm_text, ground, GOOD_CONTRAST.min(most)),
            ..theme
        }
    }
}

/// The share of the way from one colour to another at which a colour lies.
fn share(from: Colour, to: Colour, colour: Colour) -> f64 {
    let sum = |colour: Colour| f64::from(colour.map(u32::from).iter().sum::<u32>());
    ((sum(colour) - sum(from)) / (sum(to) - sum(from))).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_can_be_read_on_whatever_they_stand_on() {
        for palette in [Theme::Light, Theme::Dark].map(Palette::of) {
            let texts = [palette.text, palette.second_text, palette.alarm_text];
            let grounds = [palette.background, palette.floor];
            let pairs = texts.into_iter().flat_map(|text| grounds.map(|ground| (text, ground)));
            for (text, ground) in pairs.chain([(palette.alarm_on_white, [255; 3])]) {
                let found = contrast(text, ground);
                assert!(found >= LEAST_CONTRAST, "{text:x?} on {ground:x?} has a contrast of {found:.2}");
            }
        }
    }

    #[test]
    fn any_background_has_words_that_can_be_read() {
        for red in [0, 60, 120, 128, 150, 200, 255] {
            for green in [0, 60, 110, 120, 128, 180, 255] {
                for blue in [0, 120, 255] {
                    let ground = [red, green, blue];
                    for theme in [Theme::Light, Theme::Dark] {
                        let theme = Palette::theme_on(Some(ground), theme);
                        let own = Palette::with(theme, Some(ground));
                        for text in [own.text, own.second_text, own.alarm_text] {
                            assert!(contrast(text, ground) >= LEAST_CONTRAST, "{text:x?} on {ground:x?}");
                        }
                    }
                }
            }
        }
        assert_eq!(Palette::theme_on(Some([0; 3]), Theme::Light), Theme::Dark);
        assert_eq!(Palette::theme_on(Some([255; 3]), Theme::Dark), Theme::Light);
        assert_eq!(Palette::theme_on(Some([0xff, 0xf8, 0xe8]), Theme::Light), Theme::Light);
        assert_eq!(Palette::theme_on(None, Theme::Dark), Theme::Dark);
    }
}
