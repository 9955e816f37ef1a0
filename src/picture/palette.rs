//! The colours. Vermilion means "turned over" and nothing else.

use crate::scene::Theme;

/// An opaque colour: red, green, blue, as sRGB bytes.
pub type Colour = [u8; 3];

/// The colours of a theme.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Palette {
    /// Behind everything.
    pub background: Colour,
    /// The floor.
    pub floor: Colour,
    /// The lines on the floor.
    pub grid: Colour,
    /// What the floor's colour goes to in the shadow.
    pub shadow: Colour,
    /// How far it goes there for full shadow of the key light and of the sky.
    pub shadow_strength: [f32; 2],
    /// A sound element in space, before light falls on it.
    pub sound: Colour,
    /// A sound element in the plane.
    pub sound_flat: Colour,
    /// A node in the plane.
    pub node: Colour,
    /// A turned-over element, before light falls on it.
    pub alarm: Colour,
    /// Hatch and edges of turned-over elements.
    pub alarm_line: Colour,
    /// Words about turned-over elements.
    pub alarm_text: Colour,
    /// Edges of sound elements, and steps of depth inside a body.
    pub edge: Colour,
    /// The outline of a body.
    pub outline: Colour,
    /// Opacity of the outline.
    pub outline_alpha: f32,
    /// A solid obstacle in space, before light falls on it.
    pub obstacle: Colour,
    /// A solid obstacle in the plane, and its outline.
    pub obstacle_flat: [Colour; 2],
    /// A transparent plate, and its sides.
    pub plate: Colour,
    /// The sides of a plate.
    pub plate_side: Colour,
    /// A wall or a slope.
    pub wall: Colour,
    /// Edges of what is transparent.
    pub pane_edge: Colour,
    /// Arrows of what moves, and marks of what is held.
    pub pointer: Colour,
    /// Names and numbers.
    pub text: Colour,
    /// Everything else that is written.
    pub second_text: Colour,
    /// The line of the floor in the plane.
    pub axis: Colour,
    /// Lines between panels.
    pub hairline: Colour,
    /// A square of the tally for a sound element.
    pub tally: Colour,
    /// A spring on the ground.
    pub spring: Colour,
    /// A spring on a surface.
    pub spring_on_body: Colour,
    /// The sides of lines that a field colours.
    pub casing: Colour,
    /// An arrow of a model without springs, and of one with springs.
    pub arrows: [Colour; 2],
}

impl Palette {
    /// The colours of a theme.
    pub fn of(theme: Theme) -> Self {
        match theme {
            Theme::Light => LIGHT,
            Theme::Dark => DARK,
        }
    }

    /// Signs on sound elements in the plane: their edges' colour, a third of the way to the elements' own.
    pub(super) fn sign(&self) -> Colour {
        std::array::from_fn(|at| ((2 * u16::from(self.edge[at]) + u16::from(self.sound_flat[at])) / 3) as u8)
    }

    /// The alarm's colour for signs on white, whatever the theme.
    pub(super) fn alarm_on_white() -> Colour {
        LIGHT.alarm_text
    }
}

const LIGHT: Palette = Palette {
    background: [0xfb, 0xfb, 0xfa],
    floor: [0xf3, 0xf4, 0xf5],
    grid: [0xc9, 0xce, 0xd6],
    shadow: [0x2d, 0x36, 0x45],
    shadow_strength: [0.38, 0.52],
    sound: [0x93, 0xa5, 0xba],
    sound_flat: [0xb9, 0xc7, 0xd6],
    node: [0xff, 0xff, 0xff],
    alarm: [0xe2, 0x66, 0x1c],
    alarm_line: [0x5a, 0x1f, 0x00],
    alarm_text: [0xb8, 0x4a, 0x00],
    edge: [0x1f, 0x2a, 0x38],
    outline: [0x14, 0x1c, 0x27],
    outline_alpha: 1.0,
    obstacle: [0xc3, 0xbe, 0xb6],
    obstacle_flat: [[0xdd, 0xd8, 0xcf], [0x7a, 0x74, 0x6a]],
    plate: [0xd3, 0xd6, 0xda],
    plate_side: [0xb9, 0xc2, 0xcd],
    wall: [0xe3, 0xe7, 0xec],
    pane_edge: [0x2a, 0x33, 0x3e],
    pointer: [0x3c, 0x43, 0x4d],
    text: [0x1b, 0x23, 0x2e],
    second_text: [0x5c, 0x66, 0x72],
    axis: [0x7a, 0x84, 0x91],
    hairline: [0xd8, 0xdc, 0xe1],
    tally: [0xc0, 0xca, 0xd6],
    spring: [0x3c, 0x43, 0x4d],
    spring_on_body: [0x3c, 0x43, 0x4d],
    casing: [0x5c, 0x66, 0x72],
    arrows: [[0x00, 0x72, 0xb2], [0x3c, 0x43, 0x4d]],
};

const DARK: Palette = Palette {
    background: [0x12, 0x16, 0x1c],
    floor: [0x1a, 0x20, 0x28],
    grid: [0x3b, 0x45, 0x52],
    shadow: [0x00, 0x00, 0x00],
    shadow_strength: [0.62, 0.70],
    sound: [0xa3, 0xb5, 0xca],
    sound_flat: [0x6f, 0x83, 0x9b],
    node: [0xee, 0xf2, 0xf6],
    alarm: [0xf2, 0x7a, 0x2e],
    alarm_line: [0x3d, 0x14, 0x00],
    alarm_text: [0xff, 0x9b, 0x5c],
    edge: [0x0b, 0x10, 0x17],
    outline: [0xdc, 0xe5, 0xef],
    outline_alpha: 0.62,
    obstacle: [0x6c, 0x69, 0x64],
    obstacle_flat: [[0x38, 0x36, 0x33], [0x9a, 0x94, 0x8a]],
    plate: [0x4a, 0x55, 0x63],
    plate_side: [0x6b, 0x79, 0x8a],
    wall: [0x24, 0x2c, 0x36],
    pane_edge: [0xa9, 0xb6, 0xc5],
    pointer: [0xdc, 0xe3, 0xea],
    text: [0xee, 0xf2, 0xf6],
    second_text: [0x9c, 0xa8, 0xb6],
    axis: [0x6b, 0x76, 0x83],
    hairline: [0x2c, 0x34, 0x3f],
    tally: [0x56, 0x63, 0x73],
    spring: [0xc3, 0xcb, 0xd5],
    spring_on_body: [0x1d, 0x25, 0x30],
    casing: [0x0b, 0x10, 0x17],
    arrows: [[0x56, 0xb4, 0xe9], [0xc3, 0xcb, 0xd5]],
};

#[cfg(test)]
mod tests {
    use super::*;

    fn luminance(colour: Colour) -> f64 {
        let linear = colour.map(|byte| {
            let encoded = f64::from(byte) / 255.0;
            if encoded <= 0.040_45 { encoded / 12.92 } else { libm::pow((encoded + 0.055) / 1.055, 2.4) }
        });
        0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    }

    #[test]
    fn words_stand_out_from_the_ground() {
        for palette in [LIGHT, DARK] {
            for text in [palette.text, palette.second_text, palette.alarm_text] {
                let (a, b) = (luminance(text), luminance(palette.background));
                let contrast = (a.max(b) + 0.05) / (a.min(b) + 0.05);
                assert!(contrast >= 5.0, "{text:x?} has a contrast of {contrast:.2}");
            }
        }
    }
}
