// Edges, contours and outlines as smooth lines. Each pixel gets the opacity of four kinds of lines: edges of sound
// elements, edges of turned-over ones, the outer outline, and steps of depth inside the body. The largest wins, so that
// joints are as even as the rest.

struct Segment {
    @builtin(position) place: vec4<f32>,
    @location(0) @interpolate(flat) ends: vec4<f32>,
    @location(1) @interpolate(flat) depths: vec2<f32>,
    @location(2) @interpolate(flat) kind: u32,
}

const EDGE = 0u;
const ALARM_EDGE = 1u;
const CONTOUR = 2u;
const ALARM_CONTOUR = 3u;
const OBSTACLE_EDGE = 8u;
const OBSTACLE_CONTOUR = 9u;

// Opacities of hidden edges: of those of sound elements and of those of turned-over ones, behind surfaces that hide
// everything and behind those that hide nothing.
const HIDDEN = vec2<f32>(0.16, 0.62);
const SEEN_THROUGH = vec2<f32>(0.70, 0.95);

// Half the width of the widest line, and a pixel for its smooth border (px in the reference picture).
const REACH = 1.25;
// As for the surfaces of turned-over elements. Moving all lines as far would let stubs of hidden ones show at corners.
const NEARER = 0.02;
// A line lies this much before its surface, as a part of the distance.
const OFFSET = 0.0016;
// From this step of depth on, a contour inside the body is drawn (soft units).
const STEP = 0.22;
// By less than this step (soft units) an obstacle does not hide the contour of another, or its own.
const ROUND_STEP = 0.8;
// Elements smaller than this (px) get fainter edges, or there would be nothing but edges.
const SMALL_ELEMENT = 26.0;
// Towards this size (px) edges fade out: so close together they would only flicker.
const SMALLEST_ELEMENT = vec2<f32>(1.5, 4.0);
// Folds inside the turned-over set of elements smaller than this (px) are fainter.
const SMALL_FOLDED = 8.0;

@vertex
fn segment(
    @builtin(vertex_index) corner: u32,
    @location(0) start: vec3<f32>,
    @location(1) end: vec3<f32>,
    @location(2) kind: u32,
) -> Segment {
    let ends = ends_of(start, end);
    if !ends.seen {
        return Segment(NOWHERE, vec4(0.0), vec2(0.0), kind);
    }
    let size = panel.region.zw;
    let from_pixel = pixel_of(ends.a, size);
    let to_pixel = pixel_of(ends.b, size);
    let nearer = select(0.0, NEARER, kind == ALARM_EDGE || kind == ALARM_CONTOUR);
    let depths = vec2(ends.a.z / max(ends.a.w - nearer, panel.near), ends.b.z / max(ends.b.w - nearer, panel.near));
    let place = strip_corner(corner, from_pixel, to_pixel, REACH * panel.line_scale + 1.0, size);
    return Segment(place, vec4(from_pixel, to_pixel) + panel.region.xyxy, depths, kind);
}

fn distance_of(depth: f32) -> f32 {
    return panel.near / max(depth, 1e-9);
}

// The opacity of a line of a width (px) at a distance from its middle.
fn covered(distance: f32, width: f32) -> f32 {
    // Lines thinner than a pixel are fainter instead.
    let drawn = max(width, 1.0);
    return clamp(0.5 * drawn + 0.5 - distance, 0.0, 1.0) * (width / drawn);
}

@fragment
fn opacity(segment: Segment) -> @location(0) vec4<f32> {
    let start = segment.ends.xy;
    let difference = segment.ends.zw - start;
    let pixel = segment.place.xy;
    let share = clamp(dot(pixel - start, difference) / max(dot(difference, difference), 1e-6), 0.0, 1.0);
    let middle = start + share * difference;
    let distance = length(pixel - middle);
    let depth = mix(segment.depths.x, segment.depths.y, share);
    let before = depth * (1.0 + OFFSET);
    let here = depth_at(middle);
    let visible = before >= here || panel.flatness > 0.5;
    let scale = panel.line_scale;
    // Nothing is seen through an obstacle, and of an obstacle nothing through anything but clear surfaces.
    if !visible && segment.kind != OBSTACLE_CONTOUR && is_obstacle(texel_of(middle)) {
        return vec4(0.0);
    }
    if segment.kind == OBSTACLE_EDGE {
        let through = select(1.0 - panel.opacity, 1.0, visible);
        return vec4(0.80 * through * covered(distance, 1.15 * scale), 0.0, 0.0, 0.0);
    }
    let strength = min(1.0, panel.element / SMALL_ELEMENT)
        * smoothstep(SMALLEST_ELEMENT.x, SMALLEST_ELEMENT.y, panel.element);
    if segment.kind == EDGE && panel.flatness > 0.5 {
        return vec4(0.75 * strength * covered(distance, 1.5 * scale), 0.0, 0.0, 0.0);
    }
    let hidden_alpha = mix(SEEN_THROUGH, HIDDEN, panel.opacity);
    if segment.kind == EDGE {
        let seen = 0.80 * strength * covered(distance, 1.15 * scale);
        let hidden = hidden_alpha.x * strength * strength * covered(distance, 0.9 * scale);
        return vec4(select(hidden, seen, visible), 0.0, 0.0, 0.0);
    }
    if segment.kind == ALARM_EDGE {
        let behind_alarm = textureLoad(alarm_depth, vec2<i32>(middle), 0) > before;
        let hidden = select(hidden_alpha.y, 0.15, behind_alarm);
        let alpha = select(hidden, 0.95, visible) * strength;
        return vec4(0.0, alpha * covered(distance, 1.5 * scale), 0.0, 0.0);
    }
    if panel.flatness > 0.5 {
        let outline = covered(distance, 2.5 * scale);
        return select(vec4(0.0, 0.0, outline, 0.0), vec4(0.0, outline, 0.0, 0.0), segment.kind == ALARM_CONTOUR);
    }
    // A contour: what lies on its two sides decides.
    let along = difference / max(length(difference), 1e-6);
    let normal = vec2(-along.y, along.x);
    let across = normal * (0.9 + 1.3 * scale);
    let sides = vec2(depth_at(middle + across), depth_at(middle - across));
    let nearer = max(sides.x, sides.y);
    let farther = min(sides.x, sides.y);
    // Surfaces that end in a contour are seen at a grazing angle and come much nearer within a pixel.
    var shown = distance_of(depth) - distance_of(max(farther, min(here, nearer))) < 0.5 * STEP * panel.soft;
    let obstacles = vec2(is_obstacle(texel_of(middle + across)), is_obstacle(texel_of(middle - across)));
    if segment.kind == OBSTACLE_CONTOUR {
        // Round ones come nearer still: only what is not of their kind hides them at once.
        let before_it = vec2(distance_of(depth)) - vec2(distance_of(sides.x), distance_of(sides.y));
        shown = any(obstacles) && all(before_it < panel.soft * select(vec2(0.5 * STEP), vec2(ROUND_STEP), obstacles));
    }
    // Nothing beside it: part of the outline. If a fold of the surface covers it by a hair, it must be very close.
    let close = normal * 0.9;
    let open = min(depth_at(middle + close), depth_at(middle - close)) <= 0.0;
    if farther <= 0.0 && (shown || open) {
        return vec4(0.0, 0.0, covered(distance, 2.2 * scale), 0.0);
    }
    // Where one thing ends before another, a contour is drawn however close they are.
    let meets = obstacles.x != obstacles.y;
    if shown && (meets || distance_of(farther) - distance_of(nearer) > STEP * panel.soft) {
        let step = 0.85 * covered(distance, 1.5 * scale);
        return select(vec4(0.0, 0.0, 0.0, step), vec4(0.0, step, 0.0, 0.0), segment.kind == ALARM_CONTOUR);
    }
    if segment.kind == ALARM_CONTOUR {
        // Where the set ends, its outline is drawn at full strength.
        let ends = textureLoad(alarm_depth, texel_of(middle + across), 0) <= 0.0
            || textureLoad(alarm_depth, texel_of(middle - across), 0) <= 0.0;
        let smallness = min(1.0, panel.element / SMALL_FOLDED);
        let fold = select(smallness * smallness, 1.0, ends);
        return vec4(0.0, 0.80 * fold * covered(distance, 1.7 * scale), 0.0, 0.0);
    }
    return vec4(0.0);
}
