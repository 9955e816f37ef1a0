//! The colours of a scene: chosen colours replace the theme's, and related colours follow them.

use super::palette::{Palette, Theme};
use super::view::Colours;
use crate::colour::{
    Colour, LEAST_CONTRAST, LINE_CONTRAST, Oklab, best_of, contrast, from_oklab, mixed, oklab, readable,
};

/// The contrast of text whose colour is chosen here, with some reserve for a floor below it.
const GOOD_CONTRAST: f64 = 5.0;
/// The lightness (Oklab) of an alarm colour below which the hatch is lighter, and by how much.
const DARK_ALARM: f64 = 0.48;
const LIGHTER_HATCH: f64 = 0.36;

impl Palette {
    /// The theme whose text is legible on a background: the requested one, if possible.
    pub(crate) fn theme_on(background: Option<Colour>, theme: Theme) -> Theme {
        let Some(ground) = background else { return theme };
        let other = if theme == Theme::Light { Theme::Dark } else { Theme::Light };
        let [own, others] = [theme, other].map(|theme| contrast(Self::of(theme).text, ground));
        if own >= LEAST_CONTRAST || own >= others { theme } else { other }
    }

    /// The colours of a theme with the scene's colours, and with related colours that follow them.
    pub(crate) fn with(theme: Theme, background: Option<Colour>, given: &Colours) -> Self {
        let theme = Self::of(theme);
        let mut own = theme;
        if let Some(ground) = background {
            own.background = ground;
            own.floor = like(ground, theme.background, theme.floor);
            own.grid = like(ground, theme.background, theme.grid);
            if contrast(own.text, ground) < LEAST_CONTRAST {
                own.text = best_of(&[own.text, [0; 3], [255; 3]], ground);
            }
            if ground != theme.background {
                own.set_secondary_colours(&theme);
            }
        }
        if let Some(body) = given.body {
            own.sound = body;
            own.sound_flat = like(body, theme.sound, theme.sound_flat);
            own.tally = like(body, theme.sound, theme.tally);
            own.edge = readable(own.edge, body, LINE_CONTRAST);
            own.spring_on_body = readable(own.spring_on_body, body, LINE_CONTRAST);
        }
        if let Some(alarm) = given.turned_over {
            own.alarm = alarm;
            own.alarm_line = hatch(alarm, &theme);
            own.alarm_text = alarm;
            own.alarm_on_white = readable(alarm, [255; 3], GOOD_CONTRAST);
        }
        own.alarm_text = readable(own.alarm_text, own.background, GOOD_CONTRAST.min(most_contrast(own.background)));
        own
    }

    /// Sets the colours of secondary text and of lines: between the text and the background, at the same relative
    /// distances as in the theme, and legible.
    fn set_secondary_colours(&mut self, theme: &Self) {
        let (text, ground) = (self.text, self.background);
        let between = |colour: Colour| mixed(text, ground, share(theme.text, theme.background, colour));
        let least = LEAST_CONTRAST.min(contrast(text, ground));
        let own = share(theme.text, theme.background, theme.second_text);
        let fainter = (0..=20).map(|step| mixed(text, ground, own * f64::from(20 - step) / 20.0));
        self.second_text = { fainter }.find(|&second| contrast(second, ground) >= least).unwrap_or(text);
        self.axis = between(theme.axis);
        self.hairline = between(theme.hairline);
    }
}

/// A colour that relates to `own` as `other` relates to `counterpart` in the theme: in lightness and in colourfulness.
fn like(own: Colour, counterpart: Colour, other: Colour) -> Colour {
    let [own, counterpart, other] = [own, counterpart, other].map(oklab);
    let Oklab([lightness, a, b]) = own;
    let lightness = (lightness + other.0[0] - counterpart.0[0]).clamp(0.0, 1.0);
    // The chroma of greys is nearly zero.
    let times = ((other.chroma() + 0.01) / (counterpart.chroma() + 0.01)).min(1.5);
    from_oklab(Oklab([lightness, times * a, times * b]))
}

/// The hatch on turned-over elements of a colour: darker as in the theme, or lighter on dark ones.
fn hatch(alarm: Colour, theme: &Palette) -> Colour {
    let Oklab([lightness, a, b]) = oklab(alarm);
    if lightness < DARK_ALARM {
        return from_oklab(Oklab([lightness + LIGHTER_HATCH, a, b]));
    }
    like(alarm, theme.alarm, theme.alarm_line)
}

/// The contrast of black or white, whichever is larger, with a ground; never less than 4.58.
fn most_contrast(ground: Colour) -> f64 {
    contrast([0; 3], ground).max(contrast([255; 3], ground))
}

/// The share of the way from one colour to another at which a colour lies.
fn share(from: Colour, to: Colour, colour: Colour) -> f64 {
    let sum = |colour: Colour| f64::from(colour.map(u32::from).iter().sum::<u32>());
    ((sum(colour) - sum(from)) / (sum(to) - sum(from))).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn typed(text: &str) -> Option<Colour> {
        Some(crate::colour::parse(text).unwrap_or_else(|error| panic!("{text}: {error:?}")))
    }

    /// Each colour of words with each colour of their ground.
    fn words(palette: &Palette) -> Vec<(Colour, Colour)> {
        let texts = [palette.text, palette.second_text, palette.alarm_text];
        let grounds = [palette.background, palette.floor];
        let mut pairs: Vec<_> = texts.iter().flat_map(|&text| grounds.map(|ground| (text, ground))).collect();
        pairs.push((palette.alarm_on_white, [255; 3]));
        pairs
    }

    #[test]
    fn words_can_be_read_on_whatever_they_stand_on() {
        for theme in [Theme::Light, Theme::Dark].map(Palette::of) {
            for (text, ground) in words(&theme) {
                let found = contrast(text, ground);
                assert!(found >= LEAST_CONTRAST, "{text:x?} on {ground:x?} has a contrast of {found:.2}");
            }
        }
    }

    #[test]
    fn what_is_not_given_follows() {
        let given = Colours { body: typed("#8fbc8f"), turned_over: typed("#7b2d8b") };
        for theme in [Theme::Light, Theme::Dark] {
            let (own, of_theme) = (Palette::with(theme, None, &given), Palette::of(theme));
            assert_eq!((own.sound, own.alarm), ([0x8f, 0xbc, 0x8f], [0x7b, 0x2d, 0x8b]));
            // Green, and lighter or darker than the body as in the theme.
            for (colour, others) in [(own.sound_flat, of_theme.sound_flat), (own.tally, of_theme.tally)] {
                assert!(colour[1] > colour[0] && colour[1] > colour[2], "{colour:x?}");
                let lighter = |one: Colour, other: Colour| oklab(one).0[0] - oklab(other).0[0];
                assert!((lighter(colour, own.sound) - lighter(others, of_theme.sound)).abs() < 0.02, "{colour:x?}");
            }
            assert!(contrast(own.alarm_line, own.alarm) > 1.5);
            for (text, ground) in words(&own) {
                assert!(contrast(text, ground) >= LEAST_CONTRAST, "{text:x?} on {ground:x?}");
            }
            let same = (own.background, own.text, own.grid, own.outline, own.second_text);
            assert_eq!(
                same,
                (of_theme.background, of_theme.text, of_theme.grid, of_theme.outline, of_theme.second_text)
            );
        }
        assert_eq!(Palette::with(Theme::Dark, None, &Colours::default()), Palette::of(Theme::Dark));
        assert_eq!(Palette::with(Theme::Light, None, &Colours::default()), Palette::of(Theme::Light));
    }

    #[test]
    fn a_dark_body_gets_light_edges_and_a_dark_alarm_a_light_hatch() {
        let given = Colours { body: typed("#202830"), turned_over: typed("#603000") };
        let own = Palette::with(Theme::Light, None, &given);
        assert!(oklab(own.edge).0[0] > oklab(own.sound).0[0] && contrast(own.edge, own.sound) >= LINE_CONTRAST);
        assert!(oklab(own.alarm_line).0[0] > oklab(own.alarm).0[0] + 0.2);
    }

    #[test]
    fn any_background_has_words_that_can_be_read() {
        for red in [0, 60, 120, 128, 150, 200, 255] {
            for green in [0, 60, 110, 120, 128, 180, 255] {
                for blue in [0, 120, 255] {
                    let ground = [red, green, blue];
                    for theme in [Theme::Light, Theme::Dark] {
                        let theme = Palette::theme_on(Some(ground), theme);
                        let own = Palette::with(theme, Some(ground), &Colours::default());
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
