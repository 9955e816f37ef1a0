// The floor with its grid and the soft shadows on it. It fades out before the horizon.

struct Ground {
    // Unit vectors along the grid. w is added to coordinates so that lines of the grid are at whole cells.
    first: vec4<f32>,
    second: vec4<f32>,
    // Start and end of the fade; the heights below the upper and above the lower side of the panel over which the floor fades (px).
    fade: vec2<f32>,
    fade_at_words: vec2<f32>,
    // For key light and sky: corner, inverse length and opacity of the shadow.
    key: vec4<f32>,
    sky: vec4<f32>,
    // Linear colours. w has the layers of the two shadows and the distance of the grid's lines.
    background: vec4<f32>,
    floor: vec4<f32>,
    grid: vec4<f32>,
    shadow: vec4<f32>,
    // Left, top, width and height of the panel (px).
    viewport: vec4<f32>,
}

@group(1) @binding(0) var<uniform> ground_data: Ground;
// A private copy, as for the panel.
var<private> ground: Ground;
// Each texel holds the four cells around a corner of the grid, so that one reading is enough.
@group(1) @binding(1) var shades: texture_2d_array<f32>;

struct Corner {
    @builtin(position) place: vec4<f32>,
    @location(0) on_floor: vec2<f32>,
    @location(1) @interpolate(flat) viewport: vec4<f32>,
    @location(2) @interpolate(flat) fades: vec4<f32>,
    @location(3) @interpolate(flat) background: vec4<f32>,
    @location(4) @interpolate(flat) floor: vec4<f32>,
    @location(5) @interpolate(flat) grid: vec4<f32>,
    @location(6) @interpolate(flat) shadow: vec4<f32>,
    @location(7) @interpolate(flat) lines: vec3<f32>,
    @location(8) @interpolate(flat) key: vec4<f32>,
    @location(9) @interpolate(flat) sky: vec4<f32>,
}

fn unpack(corner: Corner) {
    ground.viewport = corner.viewport;
    ground.fade = corner.fades.xy;
    ground.fade_at_words = corner.fades.zw;
    ground.background = corner.background;
    ground.floor = corner.floor;
    ground.grid = corner.grid;
    ground.shadow = corner.shadow;
    ground.first.w = corner.lines.x;
    ground.second.w = corner.lines.y;
    panel.line_scale = corner.lines.z;
    ground.key = corner.key;
    ground.sky = corner.sky;
}

// The part of the panel's width over which the floor fades on each side.
const SIDE_FADE = 0.16;
const GRID_ALPHA = 0.85;

@vertex
fn corner(@builtin(vertex_index) index: u32) -> Corner {
    panel = panel_data;
    ground = ground_data;
    let sign = vec2(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    let on_floor = sign * ground.fade.y;
    let position = panel.up * panel.floor + ground.first.xyz * on_floor.x + ground.second.xyz * on_floor.y;
    return Corner(
        panel.clip * vec4(position, 1.0),
        on_floor,
        ground.viewport,
        vec4(ground.fade, ground.fade_at_words),
        ground.background,
        ground.floor,
        ground.grid,
        ground.shadow,
        vec3(ground.first.w, ground.second.w, panel.line_scale),
        ground.key,
        ground.sky,
    );
}

// An ordered dither: from −½ to ½, evenly spread over each 8×8 pixels (B. E. Bayer, 1973).
fn dither(pixel: vec2<f32>) -> f32 {
    let at = vec2<u32>(pixel);
    let x = at.x ^ at.y;
    let y = at.y;
    let order = ((x & 1u) << 5u) | ((y & 1u) << 4u) | ((x & 2u) << 2u) | ((y & 2u) << 1u) | ((x & 4u) >> 1u) | ((y & 4u) >> 2u);
    return (f32(order) + 0.5) / 64.0 - 0.5;
}

// The light of about 0.8 steps of a byte of sRGB, from the derivative of its curve. A whole step and rounding could
// change exact bytes, such as the plain background.
fn byte_step(light: f32) -> f32 {
    return sqrt(light) * (1.2 + 0.7 * light) / 255.0;
}

// A loop without rounds ends at once, where a software driver would read both sides of an `if` for each pixel.
fn taken(shade: vec4<f32>, layer: f32, on_floor: vec2<f32>) -> f32 {
    let at = (on_floor - shade.xy) * shade.z;
    let is_inside = shade.w > 0.0 && all(at >= vec2(0.0)) && all(at <= vec2(1.0));
    let cells = f32(textureDimensions(shades).x - 1u);
    let place = saturate(at) * cells + 0.5;
    let corner = floor(place);
    let beyond = place - corner;
    var taken = 0.0;
    for (var round = select(1, 0, is_inside); round < 1; round++) {
        let four = textureLoad(shades, vec2<i32>(corner), i32(layer), 0);
        let rows = mix(four.xz, four.yw, beyond.x);
        taken = shade.w * mix(rows.x, rows.y, beyond.y);
    }
    return taken;
}

@fragment
fn floor_colour(corner: Corner) -> @location(0) vec4<f32> {
    unpack(corner);
    let at = corner.on_floor;
    let left = (1.0 - taken(ground.key, ground.background.w, at)) * (1.0 - taken(ground.sky, ground.floor.w, at));
    let pixel = corner.place.xy - ground.viewport.xy;
    let size = ground.viewport.zw;
    let radius = length(at);
    let round = 1.0 - smoothstep(ground.fade.x, ground.fade.y, radius);
    let side = smoothstep(0.0, SIDE_FADE * size.x, min(pixel.x, size.x - pixel.x));
    let words = smoothstep(0.55 * ground.fade_at_words, ground.fade_at_words, vec2(pixel.y, size.y - pixel.y));
    let fade = round * side * words.x * words.y;
    let line = grid_lines((at + vec2(ground.first.w, ground.second.w)) / ground.grid.w);
    var colour = mix(ground.floor.rgb, ground.grid.rgb, GRID_ALPHA * max(line.x, line.y));
    colour = mix(ground.shadow.rgb, colour, left);
    let faded = mix(ground.background.rgb, colour, fade);
    // Without dithering, wide shadows show the borders of their 256 steps.
    return vec4(faded + dither(corner.place.xy) * byte_step(faded.g), 0.0);
}
