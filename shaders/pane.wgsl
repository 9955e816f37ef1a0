// Transparent plates and walls: polygons with smooth borders and their edges, from the farthest to the nearest. All are
// drawn below the bodies, and above the bodies again where they are nearer.

@group(1) @binding(2) var lines: texture_2d<f32>;

struct PaneCorner {
    @builtin(position) place: vec4<f32>,
    @location(0) grid: vec2<f32>,
    @location(1) from_middle: vec2<f32>,
    // 0 at the border and 1 in the middle.
    @location(2) inward: f32,
    @location(3) above: f32,
    @location(4) clip: vec3<f32>,
    @location(5) @interpolate(flat) colour: vec4<f32>,
    @location(6) @interpolate(flat) lined: vec4<f32>,
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
// Edges: thickness (px in the reference picture) and opacity.
const EDGE = vec2<f32>(1.35, 0.86);
// The opacity of a pane in front of bodies, relative to its own, so that they stay visible.
const OVER_BODIES = 0.6;
// A wall in front of bodies hides even less of them.
const WALL_OVER_BODIES = 0.35;
// As for other lines: an edge is this much nearer than its faces, relative to the distance.
const OFFSET = 0.0016;

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
    return PaneCorner(place, grid, from_middle, inward, above, place.xyw, colour, lined);
}

// The share of a pixel in which a depth is in front of a body: 0 without a body.
fn before_bodies(pixel: vec2<f32>, depth: f32) -> f32 {
    let inside = pixel - panel.place.xy - panel.region.xy;
    if any(inside < vec2(0.0)) || any(inside >= panel.region.zw) {
        return 0.0;
    }
    let at = vec2<i32>(pixel - panel.place.xy);
    let here = load_depth(at);
    var share = select(0.0, 1.0, here > 0.0 && here < depth);
    // Outlines extend over the border of their body, where they have the depth of its neighbour.
    let opacity = textureLoad(lines, at, 0);
    let drawn = max(max(opacity.r, opacity.g), max(opacity.b, opacity.a));
    if drawn > share {
        let low = vec2<i32>(panel.region.xy);
        let high = low + vec2<i32>(panel.region.zw) - 1;
        let reach = i32(ceil(1.1 * panel.line_scale)) + 1;
        var nearest = 0.0;
        for (var step = 0; step < 9; step++) {
            let way = vec2(step % 3 - 1, step / 3 - 1);
            nearest = max(nearest, load_depth(clamp(at + way, low, high)));
            nearest = max(nearest, load_depth(clamp(at + reach * way, low, high)));
        }
        if nearest > 0.0 && nearest < depth {
            share = drawn;
        }
    }
    return share;
}

fn pane_colour(corner: PaneCorner) -> vec4<f32> {
    let soft_border = clamp(corner.inward / max(fwidth(corner.inward), 1e-9), 0.0, 1.0);
    var colour = corner.colour.rgb;
    var alpha = corner.colour.a;
    let across = vec2(
        length(vec2(dpdx(corner.grid.x), dpdy(corner.grid.x))),
        length(vec2(dpdx(corner.grid.y), dpdy(corner.grid.y))),
    );
    let rise = length(vec2(dpdx(corner.above), dpdy(corner.above)));
    if corner.lined.a < 0.5 {
        return vec4(colour, alpha * soft_border);
    }
    let width = max(across, vec2(1e-6));
    let thickness = max(panel.line_scale, 1.0);
    let off = abs(fract(corner.grid - 0.5) - 0.5) / width;
    let cells = clamp(0.5 * thickness + 0.5 - off, vec2(0.0), vec2(1.0))
        * (panel.line_scale / thickness) * (1.0 - smoothstep(vec2(0.12), vec2(0.4), width));
    // A line over a faint wall is nearly as strong as one over a strong wall.
    let line = GRID_ALPHA * max(cells.x, cells.y) * (0.35 + 0.65 * alpha);
    let near_floor = 1.0 - smoothstep(0.0, CREASE_HEIGHT * panel.soft, corner.above);
    colour *= 1.0 - CREASE_SHADE * near_floor;
    let crease = CREASE_ALPHA * clamp(0.9 * thickness + 0.5 - corner.above / max(rise, 1e-6), 0.0, 1.0);
    let drawn = max(line, crease);
    let both = alpha + drawn * (1.0 - alpha);
    colour = (colour * alpha * (1.0 - drawn) + corner.lined.rgb * drawn) / max(both, 1e-6);
    let round = 1.0 - smoothstep(FADE, 1.0, length(corner.from_middle));
    let at = corner.clip.xy / corner.clip.z * 0.5 + 0.5;
    let side = smoothstep(0.0, SIDE_FADE, min(at.x, 1.0 - at.x));
    let lower = smoothstep(0.0, LOWER_FADE, at.y);
    let upper = smoothstep(UPPER_FADE.x, UPPER_FADE.y, 1.0 - at.y);
    return vec4(colour, both * soft_border * round * side * lower * upper);
}

@fragment
fn pane_below(corner: PaneCorner) -> @location(0) vec4<f32> {
    panel = panel_data;
    return pane_colour(corner);
}

@fragment
fn pane_above(corner: PaneCorner) -> @location(0) vec4<f32> {
    panel = panel_data;
    let colour = pane_colour(corner);
    let left = select(OVER_BODIES, WALL_OVER_BODIES, corner.lined.a > 0.5);
    return vec4(colour.rgb, left * colour.a * before_bodies(corner.place.xy, corner.place.z));
}

struct EdgePiece {
    @builtin(position) place: vec4<f32>,
    @location(0) @interpolate(flat) ends: vec4<f32>,
    @location(1) @interpolate(flat) depths: vec2<f32>,
    @location(2) @interpolate(flat) colour: vec3<f32>,
}

@vertex
fn edge_corner(
    @builtin(vertex_index) corner: u32,
    @location(0) start: vec3<f32>,
    @location(1) end: vec3<f32>,
    @location(2) colour: vec3<f32>,
    @location(3) size: vec2<f32>,
    @location(4) viewport: vec2<f32>,
) -> EdgePiece {
    panel = panel_data;
    let ends = ends_of(start, end);
    if !ends.seen {
        return EdgePiece(NOWHERE, vec4(0.0), vec2(0.0), colour);
    }
    let from_pixel = pixel_of(ends.a, size);
    let to_pixel = pixel_of(ends.b, size);
    let place = strip_corner(corner, from_pixel, to_pixel, EDGE.x * panel.line_scale + 1.0, size);
    let depths = vec2(ends.a.z / ends.a.w, ends.b.z / ends.b.w);
    return EdgePiece(place, vec4(from_pixel, to_pixel) + viewport.xyxy, depths, colour);
}

// Opacity and depth of an edge at a pixel.
fn edge_at(piece: EdgePiece) -> vec2<f32> {
    let start = piece.ends.xy;
    let difference = piece.ends.zw - start;
    let share = clamp(dot(piece.place.xy - start, difference) / max(dot(difference, difference), 1e-6), 0.0, 1.0);
    let distance = length(piece.place.xy - start - share * difference);
    let width = EDGE.x * panel.line_scale;
    let drawn = max(width, 1.0);
    let covered = clamp(0.5 * drawn + 0.5 - distance, 0.0, 1.0) * (width / drawn);
    return vec2(EDGE.y * covered, mix(piece.depths.x, piece.depths.y, share) * (1.0 + OFFSET));
}

@fragment
fn edge_below(piece: EdgePiece) -> @location(0) vec4<f32> {
    panel = panel_data;
    return vec4(piece.colour, edge_at(piece).x);
}

@fragment
fn edge_above(piece: EdgePiece) -> @location(0) vec4<f32> {
    panel = panel_data;
    let edge = edge_at(piece);
    return vec4(piece.colour, edge.x * before_bodies(piece.place.xy, edge.y));
}
