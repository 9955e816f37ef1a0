//! The colours of a picture, and the two themes. Vermilion means "turned over" and nothing else.

use crate::colour::{Colour, contrast};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The colours of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Theme {
    /// Near-white ground, for papers.
    #[default]
    Light,
    /// Near-black ground, for talks.
    Dark,
}

/// The number of colours of bodies. Further bodies have the first ones again.
pub(crate) const BODIES: usize = 5;

/// The colours of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Palette {
    /// Behind everything.
    pub background: Colour,
    /// The floor.
    pub floor: Colour,
    /// The lines on the floor.
    pub grid: Colour,
    /// The colour of the floor in the shadow.
    pub shadow: Colour,
    /// The share of that colour in full shadow of the key light and of the sky.
    pub shadow_strength: [f32; 2],
    /// Elements in space that are not turned over, before lighting: a colour for each body of a run, of one hue in both themes.
    pub bodies: [Colour; BODIES],
    /// Such elements in the plane.
    pub bodies_flat: [Colour; BODIES],
    /// A node in the plane.
    pub node: Colour,
    /// A turned-over element, before lighting.
    pub alarm: Colour,
    /// Hatch and edges of turned-over elements.
    pub alarm_line: Colour,
    /// Words about turned-over elements.
    pub alarm_text: Colour,
    /// Signs of turned-over elements, which stand on white in any theme.
    pub alarm_on_white: Colour,
    /// Edges of elements that are not turned over, and steps of depth inside a body.
    pub edge: Colour,
    /// The outline of a body.
    pub outline: Colour,
    /// Opacity of the outline.
    pub outline_alpha: f32,
    /// A solid obstacle in space, before lighting.
    pub obstacle: Colour,
    /// A solid obstacle in the plane, and its outline.
    pub obstacle_flat: [Colour; 2],
    /// A transparent plate, and its sides.
    pub plate: Colour,
    /// The sides of a plate.
    pub plate_side: Colour,
    /// A wall or a slope.
    pub wall: Colour,
    /// Edges of transparent obstacles.
    pub pane_edge: Colour,
    /// Arrows of moving objects, and marks on held nodes.
    pub pointer: Colour,
    /// Names and numbers.
    pub text: Colour,
    /// All other text.
    pub second_text: Colour,
    /// The line of the floor in the plane.
    pub axis: Colour,
    /// Lines between panels.
    pub hairline: Colour,
    /// A square of the tally for an element that is not turned over.
    pub tally: Colour,
    /// A spring on the ground.
    pub spring: Colour,
    /// A spring on a surface.
    pub spring_on_body: Colour,
    /// The sides of lines that a field colours.
    pub casing: Colour,
    /// The lines of runs.
    pub runs: [Colour; 8],
}

impl Palette {
    /// The colours of a theme.
    pub(crate) fn of(theme: Theme) -> Self {
        match theme {
            Theme::Light => LIGHT,
            Theme::Dark => DARK,
        }
    }

    /// Whether it is made for light ground, such as paper.
    pub(crate) fn is_made_for_light(&self) -> bool {
        contrast(self.background, [0; 3]) >= contrast(self.background, [255; 3])
    }
}

const LIGHT: Palette = Palette {
    background: [0xfb, 0xfb, 0xfa],
    floor: [0xf3, 0xf4, 0xf5],
    grid: [0xc9, 0xce, 0xd6],
    shadow: [0x2d, 0x36, 0x45],
    shadow_strength: [0.38, 0.52],
    bodies: [[0x93, 0xa5, 0xba], [0x59, 0x5c, 0x98], [0x96, 0xda, 0xff], [0x71, 0x5c, 0x6a], [0x7b, 0x80, 0xbf]],
    bodies_flat: [[0xb9, 0xc7, 0xd6], [0x87, 0x8c, 0xcc], [0xfd, 0xf1, 0xa6], [0x93, 0x91, 0x94], [0xd1, 0xbb, 0xa9]],
    node: [0xff, 0xff, 0xff],
    alarm: [0xe2, 0x66, 0x1c],
    alarm_line: [0x5a, 0x1f, 0x00],
    alarm_text: [0xb8, 0x4a, 0x00],
    alarm_on_white: [0xb8, 0x4a, 0x00],
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
    runs: [
        [0x00, 0x72, 0xb2],
        [0x3c, 0x43, 0x4d],
        [0x1e, 0xa0, 0x87],
        [0x4d, 0x20, 0x01],
        [0x24, 0x9d, 0xb1],
        [0x40, 0x00, 0x54],
        [0x00, 0x00, 0xcb],
        [0x43, 0x5a, 0x44],
    ],
};

const DARK: Palette = Palette {
    background: [0x12, 0x16, 0x1c],
    floor: [0x1a, 0x20, 0x28],
    grid: [0x3b, 0x45, 0x52],
    shadow: [0x00, 0x00, 0x00],
    shadow_strength: [0.62, 0.70],
    bodies: LIGHT.bodies,
    bodies_flat: [[0x6f, 0x83, 0x9b], [0x3f, 0x40, 0x79], [0x5f, 0x53, 0x00], [0x51, 0x53, 0x51], [0xd4, 0xc2, 0xb3]],
    node: [0xee, 0xf2, 0xf6],
    alarm: [0xf2, 0x7a, 0x2e],
    alarm_line: [0x3d, 0x14, 0x00],
    alarm_text: [0xff, 0x9b, 0x5c],
    alarm_on_white: [0xb8, 0x4a, 0x00],
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
    runs: [
        [0x56, 0xb4, 0xe9],
        [0xc3, 0xcb, 0xd5],
        [0x3a, 0xa9, 0x96],
        [0xff, 0xfd, 0x00],
        [0xc5, 0xec, 0xb9],
        [0x93, 0x60, 0x93],
        [0x59, 0x74, 0xf0],
        [0x8b, 0x59, 0x3d],
    ],
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::{Lab, Vision, cie76, ciede2000, encoded, lab, linear, seen_by};

    /// The light on faces, as in `shaders/surface.wgsl`: on all sides of the key light, facing up, level and down,
    /// standing on the floor and in the air.
    fn lights() -> Vec<[f64; 3]> {
        const KEY: [f64; 3] = [0.66, 0.635, 0.595];
        const SKY: [f64; 3] = [0.60, 0.635, 0.68];
        const GROUND: [f64; 3] = [0.27, 0.262, 0.25];
        let mut lights = vec![[1.0; 3]];
        for key in [0.0, 0.25, 0.5, 0.75, 1.0] {
            for upward in [-1.0, -0.5, 0.0, 0.5, 1.0_f64] {
                for contact in [0.72, 1.0] {
                    let contact = contact + (1.0 - contact) * upward.abs();
                    lights.push(std::array::from_fn(|at| {
                        let around = GROUND[at] + (SKY[at] - GROUND[at]) * (0.5 + 0.5 * upward);
                        KEY[at] * key + around * contact
                    }));
                }
            }
        }
        lights
    }

    fn brightness(light: [f64; 3]) -> f64 {
        0.2126 * light[0] + 0.7152 * light[1] + 0.0722 * light[2]
    }

    /// A turned-over element at a depth behind another one, from 0 to 1, as `shaders/surface.wgsl` mixes it.
    fn through(sound: [f64; 3], alarm: [f64; 3], light: [f64; 3], deep: f64) -> [f64; 3] {
        let colour: [f64; 3] = std::array::from_fn(|at| sound[at] * light[at]);
        let grey = brightness(colour);
        std::array::from_fn(|at| {
            let lit = alarm[at] * light[at];
            let unlit = lit * 0.86 / brightness(light).max(0.05);
            let alarm = lit + (unlit - lit) * 0.65 * deep;
            let grey = colour[at] + (grey - colour[at]) * 0.7;
            grey + (alarm - grey) * (1.0 - 0.4 * deep)
        })
    }

    /// The smallest difference of two colours for any colour-blind vision.
    fn apart(one: [f64; 3], other: [f64; 3], measure: fn(Lab, Lab) -> f64) -> f64 {
        let [one, other] = [one, other].map(|light| linear(encoded(light)));
        let visions = [Vision::Normal, Vision::Deuteranopia, Vision::Protanopia];
        let seen = visions.iter().flat_map(|&vision| seen_by(vision, one).into_iter().zip(seen_by(vision, other)));
        seen.map(|(one, other)| measure(lab(one), lab(other))).fold(f64::INFINITY, f64::min)
    }

    /// The difference is that of the colours alone: names in the key tell bodies apart where light brings colours nearer.
    #[test]
    fn bodies_differ_from_each_other() {
        for theme in [LIGHT, DARK] {
            for colours in [theme.bodies, theme.bodies_flat] {
                for (at, &one) in colours.iter().enumerate() {
                    for &other in &colours[..at] {
                        let found = apart(linear(one), linear(other), ciede2000);
                        assert!(found >= 13.0, "{one:x?} and {other:x?} differ by {found:.1}");
                    }
                }
            }
        }
    }

    #[test]
    fn turned_over_elements_differ_from_others() {
        let mut least = [f64::INFINITY; 4];
        for theme in [LIGHT, DARK] {
            let [tally, alarm] = [theme.tally, theme.alarm].map(linear);
            for (measure, sound) in
                [ciede2000, cie76].into_iter().flat_map(|one| theme.bodies.map(|body| (one, linear(body))))
            {
                for sound in theme.bodies_flat.map(linear).into_iter().chain([sound, tally]) {
                    let found = apart(sound, alarm, measure);
                    least[0] = least[0].min(found);
                    assert!(found >= 20.0, "as they are: {found:.1}");
                }
                for light in lights() {
                    let lit = |colour: [f64; 3]| std::array::from_fn(|at| colour[at] * light[at]);
                    let found = apart(lit(sound), lit(alarm), measure);
                    least[1] = least[1].min(found);
                    assert!(found >= 20.0, "in the light {light:.2?}: {found:.1}");
                    let found = apart(lit(sound), through(sound, alarm, light, 0.0), measure);
                    least[2] = least[2].min(found);
                    assert!(found >= 20.0, "just behind, in the light {light:.2?}: {found:.1}");
                    let found = apart(lit(sound), through(sound, alarm, light, 1.0), measure);
                    least[3] = least[3].min(found);
                    assert!(found >= 20.0, "deep inside, in the light {light:.2?}: {found:.1}");
                }
            }
        }
        println!("as they are, lit, just behind, deep inside: {least:.1?}");
    }
}
