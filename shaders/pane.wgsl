// Transparent plates and walls, from the farthest to the nearest, over bodies and ground: less where bodies lie behind
// them, and not at all where bodies lie in front.

@group(1) @binding(0) var drawn_depth: texture_depth_2d;

struct PaneCorner {
    @builtin(position) place: vec4<f32>,
    @location(0) grid: vec2<f32>,
    @location(1) from_middle: vec2<f32>,
    // 0 at the border and 1 in the middle.
    @location(2) inward: f32,
    @location(3) above: f32,
    @location(4) clip: vec3<f32>,
    @location(5) position: vec3<f32>,
    @location(6) @interpolate(flat) colour: vec4<f32>,
    @location(7) @interpolate(flat) lined: vec4<f32>,
}

// The start of the fade in the circle of a wall.
const FADE = 0.45;
// The parts of the panel's width and height in which walls fade out: at the sides, below, and above, at the words.
const SIDE_FADE = 0.14;
const LOWER_FADE = 0.13;
const UPPER_FADE = vec2<f32>(0.11, 0.20);
// The opacity of a grid on a wall, and of the line where the wall meets the floor.
const GRID_ALPHA = 0.85;
const CREASE_ALPHA = 0.85;
// Below this height above the floor (soft units) a wall is this much darker.
const CREASE_HEIGHT = 0.8;
const CREASE_SHADE = 0.10;
// The opacity of a wall in front of bodies, relative to its own: it hides even less of them than a plate.
const WALL_OVER_BODIES = 0.35;
// The opacity of a shadow on a transparent pane, relative to its own. Its normal counts as being at one angle to the light everywhere.
const PANE_SHADOW = 0.8;
const PANE_COSINE = 0.7;

@vertex
fn pane_corner(
    @location(0) position: vec3<f32>,
    @location(1) inward: f32,
    @location(2) grid: vec2<f32>,
    @location(3) from_middle: vec2<f32>,
    @location(4) colour: vec4<f32>,
    @location(5) lined: vec4<f32>,
) -> PaneCorner {
    panel = panel_data;
    let place = panel.clip * vec4(position, 1.0);
    let above = dot(position, panel.up) - panel.floor;
    return PaneCorner(place, grid, from_middle, inward, above, place.xyw, position, colour, lined);
}

// The colour of a wall with its grid, and its opacity.
fn wall(corner: PaneCorner) -> vec4<f32> {
    let rise = length(vec2(dpdx(corner.above), dpdy(corner.above)));
    let alpha = corner.colour.a;
    let thickness = max(panel.line_scale, 1.0);
    let cells = grid_lines(corner.grid);
    // A line over a faint wall is nearly as strong as one over a strong wall.
    let line = GRID_ALPHA * max(cells.x, cells.y) * (0.35 + 0.65 * alpha);
    let near_floor = 1.0 - smoothstep(0.0, CREASE_HEIGHT * panel.soft, corner.above);
    let plain = corner.colour.rgb * (1.0 - CREASE_SHADE * near_floor);
    let crease = CREASE_ALPHA * clamp(0.9 * thickness + 0.5 - corner.above / max(rise, 1e-6), 0.0, 1.0);
    let drawn = max(line, crease);
    let both = alpha + drawn * (1.0 - alpha);
    let colour = (plain * alpha * (1.0 - drawn) + corner.lined.rgb * drawn) / max(both, 1e-6);
    let round = 1.0 - smoothstep(FADE, 1.0, length(corner.from_middle));
    let at = corner.clip.xy / corner.clip.z * 0.5 + 0.5;
    let side = smoothstep(0.0, SIDE_FADE, min(at.x, 1.0 - at.x));
    let lower = smoothstep(0.0, LOWER_FADE, at.y);
    let upper = smoothstep(UPPER_FADE.x, UPPER_FADE.y, 1.0 - at.y);
    return vec4(colour, both * round * side * lower * upper);
}

@fragment
fn pane_colour(corner: PaneCorner) -> @location(0) vec4<f32> {
    panel = panel_data;
    let soft_border = saturate(corner.inward / max(fwidth(corner.inward), 1e-9));
    let is_wall = corner.lined.a > 0.5;
    let own = select(corner.colour, wall(corner), is_wall);
    let behind = textureLoad(drawn_depth, vec2<i32>(corner.place.xy), 0);
    let over_bodies = select(0.0, select(OVER_BODIES, WALL_OVER_BODIES, is_wall), behind < corner.place.z);
    let left = select(1.0, over_bodies, behind > 0.0);
    // A shadow is a thin dark layer.
    let shadow = PANE_SHADOW * (1.0 - reached(corner.position, PANE_COSINE));
    let opacity = min(own.a * (1.0 + shadow), 1.0);
    return vec4(own.rgb * (own.a / max(opacity, 1e-6)), opacity * soft_border * left);
}
