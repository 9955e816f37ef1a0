// Marks and words on top of everything, blended as sRGB values, as type requires.

struct Mark {
    // Left, top, width and height (px).
    @location(0) rectangle: vec4<f32>,
    // Unit vector along its width.
    @location(1) along: vec2<f32>,
    // sRGB; alpha is the opacity of the mark.
    @location(2) colour: vec4<f32>,
    @location(3) second: vec4<f32>,
    // Left and top in the atlas of glyphs.
    @location(4) glyph: vec2<u32>,
    @location(5) shape: u32,
}

struct Corner {
    @builtin(position) place: vec4<f32>,
    @location(0) @interpolate(flat) rectangle: vec4<f32>,
    @location(1) @interpolate(flat) colour: vec4<f32>,
    @location(2) @interpolate(flat) second: vec4<f32>,
    @location(3) @interpolate(flat) glyph: vec2<u32>,
    @location(4) @interpolate(flat) shape: u32,
    @location(5) @interpolate(flat) along: vec2<f32>,
}

struct Canvas {
    size: vec2<f32>,
    unused: vec2<f32>,
}

@group(0) @binding(0) var<uniform> canvas: Canvas;
@group(0) @binding(1) var glyphs: texture_2d<f32>;

const STRUCK = 1u;
const NODE = 3u;
const COUNTER_CLOCKWISE = 4u;
const CLOCKWISE = 5u;
const FADING = 6u;
const SHADOW = 7u;
const SMOOTH = 8u;
const ARROW = 9u;
const BLEND = 10u;
const POINT = 11u;
const PIN = 12u;
const HAND = 13u;

// The opacity of a halo.
const HALO = 0.75;

// The ring arrow: radius and thickness relative to the mark, start and end of its line (rad, counter-clockwise from the
// right), length and half width of its head.
const RING = 0.80;
const THICKNESS = vec2<f32>(0.14, 0.22);
const BEGIN = 0.9;
const END = -0.25;
const HEAD = vec2<f32>(0.72, 0.42);

// The opacity of a ring arrow. Coordinates run from −1 to 1, upwards; a pixel has the size `pixel`.
fn ring_arrow(at: vec2<f32>, thickness: f32, pixel: f32) -> f32 {
    let off_ring = abs(length(at) - RING) - 0.5 * thickness;
    let angle = atan2(at.y, at.x);
    // Distance from the ends of the line, along it.
    let open = min(angle - END, BEGIN - angle) * RING;
    let ring = min(0.5 - off_ring / pixel, 0.5 - open / pixel);
    let along = vec2(-sin(END), cos(END));
    let from_base = at - RING * vec2(cos(END), sin(END));
    let t = dot(from_base, along);
    let s = abs(dot(from_base, vec2(along.y, -along.x)));
    let slant = vec2(HEAD.x, HEAD.y) / length(HEAD);
    let side = s * slant.x - (HEAD.x - t) * slant.y;
    let head = min(0.5 - side / pixel, 0.5 + t / pixel);
    return saturate(max(ring, head));
}

// A mark with a halo: the distance of a pixel outside it (px).
fn with_halo(colour: vec4<f32>, halo: vec3<f32>, outside: f32, width: f32) -> vec4<f32> {
    let inner = saturate(0.5 - outside);
    let outer = HALO * saturate(0.5 + width - outside);
    let alpha = inner + outer * (1.0 - inner);
    return vec4((colour.rgb * inner + halo * outer * (1.0 - inner)) / max(alpha, 1e-6), alpha);
}

// A long arrow in widths of its head: length and depth of notch of the head, thickness of the shaft, and the halo. The
// head of a short arrow is this part of its length, and the whole arrow is scaled with it.
const ARROW_HEAD = vec2<f32>(1.235, 0.2);
const ARROW_SHAFT = 0.247;
const ARROW_HALO = 0.17647;
// The share of the halo's room that it fills, so that it is equally wide in pictures of all sizes: 2.5 of the 3 pixels
// around a long arrow in the reference picture. Half a pixel is left for its smooth border.
const ARROW_HALO_FILLED = 0.83333;
const ARROW_SHORT = 0.62;

fn off_segment(at: vec2<f32>, from_end: vec2<f32>, to_end: vec2<f32>) -> f32 {
    let along = to_end - from_end;
    let share = saturate(dot(at - from_end, along) / max(dot(along, along), 1e-9));
    return length(at - from_end - share * along);
}

// The distance of a point outside an arrow (px), for a mark of a size, negative inside; and the width of its halo.
fn off_arrow(at: vec2<f32>, size: vec2<f32>) -> vec2<f32> {
    let wide = size.y / (1.0 + 2.0 * ARROW_HALO);
    let pad = wide * ARROW_HALO;
    let tip = size.x - 2.0 * pad;
    let head = min(ARROW_HEAD.x * wide, ARROW_SHORT * tip);
    let part = head / (ARROW_HEAD.x * wide);
    let half_head = 0.5 * wide * part;
    let half_shaft = 0.5 * ARROW_SHAFT * wide * part;
    let back = tip - head;
    let notch = ARROW_HEAD.y * wide * part;
    let p = vec2(at.x - pad, abs(at.y - 0.5 * size.y));
    let joint = vec2(back + notch * (1.0 - half_shaft / max(half_head, 1e-6)), half_shaft);
    let barb = vec2(back, half_head);
    let point = vec2(tip, 0.0);
    let off = min(
        min(off_segment(p, vec2(0.0), vec2(0.0, half_shaft)), off_segment(p, vec2(0.0, half_shaft), joint)),
        min(off_segment(p, joint, barb), off_segment(p, barb, point)),
    );
    let in_shaft = p.x >= 0.0 && p.x <= back + notch && p.y <= half_shaft;
    let side = (p.x - barb.x) * (point.y - barb.y) - (p.y - barb.y) * (point.x - barb.x);
    let rear = p.x >= back + notch * (1.0 - p.y / max(half_head, 1e-6));
    let inside = in_shaft || (rear && side > 0.0 && p.y <= half_head);
    return vec2(select(off, -off, inside), ARROW_HALO_FILLED * pad * max(part, 0.5));
}

// The part of a pixel between the upper corners of a rectangle and below its upper side.
fn within(at: vec2<f32>, size: vec2<f32>) -> f32 {
    return saturate(at.x + 0.5) * saturate(size.x - at.x + 0.5) * saturate(at.y + 0.5);
}

// The reach of a mark beyond its rectangle (px): its smooth border, and the heads of ring arrows.
fn room_around(mark: Mark) -> f32 {
    switch mark.shape {
        case NODE, PIN, HAND, FADING, SHADOW, ARROW: { return 1.0; }
        case COUNTER_CLOCKWISE, CLOCKWISE: { return 0.5 * (RING + HEAD.y - 1.0) * mark.rectangle.z + 1.0; }
        default: { return 0.0; }
    }
}

@vertex
fn corner(@builtin(vertex_index) index: u32, mark: Mark) -> Corner {
    let side = vec2(f32(index & 1u), f32(index >> 1u));
    let corner = mark.rectangle.zw * side + room_around(mark) * (2.0 * side - 1.0);
    let at = mark.rectangle.xy + corner.x * mark.along + corner.y * vec2(-mark.along.y, mark.along.x);
    let place = vec4(at / canvas.size * vec2(2.0, -2.0) + vec2(-1.0, 1.0), 0.5, 1.0);
    return Corner(place, mark.rectangle, mark.colour, mark.second, mark.glyph, mark.shape, mark.along);
}

// A pixel in the mark's own coordinates.
fn in_mark(corner: Corner) -> vec2<f32> {
    let from_corner = corner.place.xy - corner.rectangle.xy;
    return vec2(dot(from_corner, corner.along), dot(from_corner, vec2(-corner.along.y, corner.along.x)));
}

@fragment
fn glyph_colour(corner: Corner) -> @location(0) vec4<f32> {
    let texel = vec2<i32>(corner.glyph) + vec2<i32>(floor(in_mark(corner)));
    return vec4(corner.colour.rgb, textureLoad(glyphs, texel, 0).r);
}

// Rectangles, the most frequent marks. A software driver would run the code of all shapes for each pixel.
@fragment
fn rectangle_colour(corner: Corner) -> @location(0) vec4<f32> {
    return corner.colour;
}

@fragment
fn mark_colour(corner: Corner) -> @location(0) vec4<f32> {
    let opaque = opaque_colour(corner);
    return vec4(opaque.rgb, opaque.a * corner.colour.a);
}

// The colour of a pixel of an opaque mark, and the part of the pixel that it covers.
fn opaque_colour(corner: Corner) -> vec4<f32> {
    let at = in_mark(corner);
    if corner.shape == STRUCK {
        let size = corner.rectangle.zw;
        let off = abs(at.x / size.x + at.y / size.y - 1.0) / length(1.0 / size);
        let line = clamp(0.045 * (size.x + size.y) + 0.5 - off, 0.0, 1.0);
        return vec4(mix(corner.colour.rgb, corner.second.rgb, line), 1.0);
    }
    let middle = vec2(2.0, -2.0) * at / corner.rectangle.zw + vec2(-1.0, 1.0);
    let pixel = 2.0 / corner.rectangle.z;
    switch corner.shape {
        case NODE: {
            let inward = (1.0 - length(middle)) / pixel;
            let rim = 0.16 * corner.rectangle.z;
            return vec4(mix(corner.second.rgb, corner.colour.rgb, saturate(inward - rim + 0.5)), saturate(inward + 0.5));
        }
        case COUNTER_CLOCKWISE: {
            return vec4(corner.colour.rgb, ring_arrow(middle, THICKNESS.x, pixel));
        }
        case CLOCKWISE: {
            return vec4(corner.colour.rgb, ring_arrow(vec2(-middle.x, middle.y), THICKNESS.y, pixel));
        }
        case FADING: {
            let left = saturate(1.0 - at.y / corner.rectangle.w);
            return vec4(corner.colour.rgb, 0.75 * left * left * within(at, corner.rectangle.zw));
        }
        case SHADOW: {
            let left = saturate(1.0 - at.y / corner.rectangle.w);
            let across = smoothstep(1.0, 0.55, abs(middle.x));
            return vec4(corner.colour.rgb, 0.42 * across * left * left * within(at, corner.rectangle.zw));
        }
        case PIN: {
            let radius = 0.5 * corner.rectangle.z;
            let outside = (radius * (abs(middle.x) + abs(middle.y)) - 0.74 * radius) * 0.70710678;
            return with_halo(corner.colour, corner.second.rgb, outside, 0.17 * radius);
        }
        case HAND: {
            let radius = 0.5 * corner.rectangle.z;
            let from_middle = radius * length(middle);
            let outside = min(from_middle - 0.36 * radius, abs(from_middle - 0.76 * radius) - 0.11 * radius);
            return with_halo(corner.colour, corner.second.rgb, outside, 0.12 * radius);
        }
        case SMOOTH: {
            let inside = min(at, corner.rectangle.zw - at);
            return vec4(corner.colour.rgb, saturate(inside.x) * saturate(inside.y));
        }
        case ARROW: {
            let arrow = off_arrow(at, corner.rectangle.zw);
            let inside = saturate(0.5 - arrow.x);
            let around = saturate(0.5 + arrow.y - arrow.x);
            return vec4(mix(corner.second.rgb, corner.colour.rgb, inside), max(inside, 0.92 * around));
        }
        case BLEND: {
            return vec4(mix(corner.colour.rgb, corner.second.rgb, at.x / corner.rectangle.z), 1.0);
        }
        case POINT: {
            let size = corner.rectangle.zw;
            let slant = vec2(0.5 * size.y, size.x);
            let off = dot(vec2(at.x - size.x, abs(at.y - 0.5 * size.y)), slant) / length(slant);
            return vec4(corner.colour.rgb, saturate(0.5 - off));
        }
        default: {
            return vec4(corner.colour.rgb, 1.0);
        }
    }
}
