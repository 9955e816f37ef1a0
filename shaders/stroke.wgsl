// Coloured lines, and nodes as discs that face the viewer, over the finished bodies. Parts behind a surface are fainter
// or not drawn.

struct Stroke {
    @builtin(position) place: vec4<f32>,
    @location(0) @interpolate(flat) ends: vec4<f32>,
    @location(1) @interpolate(flat) depths: vec2<f32>,
    @location(2) @interpolate(flat) first: vec4<f32>,
    @location(3) @interpolate(flat) second: vec4<f32>,
    @location(4) @interpolate(flat) other: vec4<f32>,
    // Width of a line or radius of a disc (px).
    @location(5) @interpolate(flat) size: f32,
    @location(6) @interpolate(flat) kind: u32,
}

// Shapes besides plain lines: a line with another colour over surfaces, a disc, and a line with another colour at its
// sides.
const LINE_ON_BODY = 1u;
const DISC = 2u;
const CASED_LINE = 3u;

// As for the surfaces of turned-over elements.
const NEARER = 0.02;
// A line lies this much in front of its surface, relative to the distance.
const OFFSET = 0.0016;
// A disc is cut off by depths in front of a ball this much larger. It fades over half of that in front and behind:
// depths of a sheet seen nearly from its side change too much within a pixel for a step.
const FRONT = 2.0;

@vertex
fn stroke(
    @builtin(vertex_index) corner: u32,
    @location(0) start: vec3<f32>,
    @location(1) end: vec3<f32>,
    @location(2) first: vec4<f32>,
    @location(3) second: vec4<f32>,
    @location(4) other: vec4<f32>,
    @location(5) size: f32,
    @location(6) kind: u32,
) -> Stroke {
    panel = panel_data;
    let ends = ends_of(start, end);
    if !ends.seen {
        return Stroke(NOWHERE, vec4(0.0), vec2(0.0), first, second, other, size, kind);
    }
    let room = panel.viewport.zw;
    let from_pixel = pixel_of(ends.a, room);
    let to_pixel = pixel_of(ends.b, room);
    let depths = vec2(ends.a.z / max(ends.a.w - NEARER, panel.near), ends.b.z / max(ends.b.w - NEARER, panel.near));
    let reach = select(0.5 * size, size, kind == DISC) + 1.0;
    let place = strip_corner(corner, from_pixel, to_pixel, reach, room);
    return Stroke(place, vec4(from_pixel, to_pixel) + panel.viewport.xyxy - panel.place.xyxy, depths, first, second, other, size, kind);
}

// An sRGB colour as linear light.
fn decoded(colour: vec3<f32>) -> vec3<f32> {
    return select(pow((colour + 0.055) / 1.055, vec3(2.4)), colour / 12.92, colour <= vec3(0.04045));
}

// The visibility of a disc, at one tap of the pixel around its middle.
fn disc_share(middle: vec2<f32>, before: f32, tap: u32) -> f32 {
    // At an outline, the next pixel may be background.
    let beside = min(
        min(tap_depth(middle + vec2(1.5, 0.0), tap), tap_depth(middle - vec2(1.5, 0.0), tap)),
        min(tap_depth(middle + vec2(0.0, 1.5), tap), tap_depth(middle - vec2(0.0, 1.5), tap)),
    );
    return visible_share(before, min(tap_depth(middle, tap), beside));
}

// The part of a disc's pixel that surfaces do not cut off. Surfaces up to three pixels away count, too, for balls larger
// by as much: else the pixel would appear at once where an outline inside the body passes.
fn uncut_share(pixel: vec2<f32>, before: f32, size: f32) -> f32 {
    var shown = 0.0;
    var nearest = 0.0;
    for (var away = 0; away < 4; away++) {
        for (var at = 0; at < 9; at++) {
            nearest = max(nearest, load_depth(texel_of(pixel + vec2<f32>(away * (vec2(at % 3, at / 3) - 1)))));
        }
        // The radius of the ball, relative to the distance.
        let nearness = min(0.5 / FRONT, (size + f32(away)) / panel.focal);
        let front = before / (1.0 - FRONT * nearness);
        let faded = max(0.5 * FRONT * nearness, FADED_DEPTH) * max(nearest, 1e-9);
        shown += 0.25 * saturate(0.5 + 0.5 * (front - nearest) / faded);
    }
    return shown;
}

// The visibility of a line, and the part of it over a surface, not along an outline against the ground.
fn line_shares(middle: vec2<f32>, across: vec2<f32>, before: f32, tap: u32) -> vec2<f32> {
    let here = tap_depth(middle, tap);
    let inside = here > 0.0 && min(tap_depth(middle + across, tap), tap_depth(middle - across, tap)) > 0.0;
    return vec2(visible_share(before, here), select(0.0, 1.0, inside));
}

@fragment
fn stroke_colour(stroke: Stroke) -> @location(0) vec4<f32> {
    panel = panel_data;
    let start = stroke.ends.xy;
    let difference = stroke.ends.zw - start;
    let pixel = stroke.place.xy - panel.place.xy;
    let unbounded = dot(pixel - start, difference) / max(dot(difference, difference), 1e-6);
    let share = saturate(unbounded);
    let middle = start + share * difference;
    let distance = length(pixel - middle);
    let before = mix(stroke.depths.x, stroke.depths.y, share) * (1.0 + OFFSET);
    if stroke.kind == DISC {
        let inward = stroke.size - distance;
        var shown = 0.0;
        for (var tap = 0u; tap < TAPS; tap++) {
            shown += disc_share(middle, before, tap) / f32(TAPS);
        }
        let colour = mix(stroke.second.rgb, stroke.first.rgb, saturate(inward - BEAD_RIM * stroke.size + 0.5));
        return vec4(decoded(colour), saturate(inward + 0.5) * shown * uncut_share(pixel, before, stroke.size));
    }
    // Lines thinner than a pixel are fainter instead.
    let drawn = max(stroke.size, 1.0);
    var covered = stroke.first.a * saturate(0.5 * drawn + 0.5 - distance) * (stroke.size / drawn);
    if covered <= 0.0 {
        return vec4(0.0);
    }
    let along = difference / max(length(difference), 1e-6);
    let across = 2.0 * vec2(-along.y, along.x);
    var shares = vec2(0.0);
    for (var tap = 0u; tap < TAPS; tap++) {
        shares += line_shares(middle, across, before, tap) / f32(TAPS);
    }
    var own = mix(stroke.first.rgb, stroke.second.rgb, share);
    if stroke.kind == CASED_LINE {
        let casing = max(CASING * stroke.size, LEAST_CASING);
        own = mix(stroke.other.rgb, own, saturate(0.5 * stroke.size - casing + 0.5 - distance));
        // Pieces of one line fit together only with straight ends.
        covered *= saturate(0.5 + min(unbounded, 1.0 - unbounded) * length(difference));
    }
    let colour = mix(own, stroke.other.rgb, select(0.0, shares.y, stroke.kind == LINE_ON_BODY));
    // Round ends of many faint lines would add up to a dot.
    let hidden = select(0.0, stroke.other.a, unbounded == share);
    return vec4(decoded(colour), covered * mix(hidden, 1.0, shares.x));
}
