// Edges, contours and outlines as smooth lines. Each pixel gets the opacity of four kinds of lines: edges of turned-over
// elements, edges of others, the outer outline, and steps of depth inside the body. The largest wins, so that
// joints are as even as the rest.

struct Segment {
    @builtin(position) place: vec4<f32>,
    @location(0) @interpolate(flat) ends: vec4<f32>,
    @location(1) @interpolate(flat) depths: vec2<f32>,
    @location(2) @interpolate(flat) kind: u32,
    @location(3) @interpolate(flat) strength: f32,
}

const EDGE = 0u;
const ALARM_EDGE = 1u;
const CONTOUR = 2u;
const ALARM_CONTOUR = 3u;
const BAR = 4u;
const OBSTACLE_EDGE = 8u;
const OBSTACLE_CONTOUR = 9u;

// Opacities of hidden edges: of elements that are not inverted and of turned-over ones, behind surfaces that hide
// everything and behind those that hide nothing.
const HIDDEN = vec2<f32>(0.16, 0.62);
const SEEN_THROUGH = vec2<f32>(0.70, 0.95);

// Widths of lines (px in the reference picture).
const EDGE_WIDTH = 1.15;
const FLAT_EDGE_WIDTH = 1.5;
const ALARM_EDGE_WIDTH = 1.5;
const CONTOUR_WIDTH = 2.2;
const FLAT_CONTOUR_WIDTH = 2.5;
// As for the surfaces of turned-over elements. Moving all lines as far would let stubs of hidden ones show at corners.
const NEARER = 0.02;
// A line lies this much before its surface, as a part of the distance.
const OFFSET = 0.0016;
// From this step of depth on, a contour inside the body is drawn (soft units).
const STEP = 0.22;
// By less than this step (soft units) an obstacle does not hide the contour of another, or its own.
const ROUND_STEP = 0.8;
// Width of the lines of an element without faces (px in the reference picture).
const BAR_WIDTH = 2.2;
// Elements smaller than this (px) get fainter edges, or edges would cover everything.
const SMALL_ELEMENT = 26.0;
// Towards this size (px) edges fade out, because so close together they would flicker.
const SMALLEST_ELEMENT = vec2<f32>(4.0, 8.0);
// Folds inside the turned-over set of elements smaller than this (px) are fainter.
const SMALL_FOLDED = 8.0;

// The depth of the turned-over set by itself at one of the taps around a point.
fn alarm_depth_around(place: vec2<f32>, tap: u32) -> f32 {
    return load_alarm_depth(texel_around(place, tap));
}

// The width of the widest line of a kind (px in the reference picture).
fn widest(kind: u32) -> f32 {
    switch kind {
        case EDGE, OBSTACLE_EDGE: { return select(EDGE_WIDTH, FLAT_EDGE_WIDTH, panel.flatness > 0.5); }
        case ALARM_EDGE: { return ALARM_EDGE_WIDTH; }
        case BAR: { return BAR_WIDTH; }
        default: { return select(CONTOUR_WIDTH, FLAT_CONTOUR_WIDTH, panel.flatness > 0.5); }
    }
}

@vertex
fn segment(
    @builtin(vertex_index) corner: u32,
    @location(0) start: vec3<f32>,
    @location(1) end: vec3<f32>,
    @location(2) kind: u32,
    @location(3) strength: f32,
) -> Segment {
    let ends = ends_of(start, end);
    if !ends.seen {
        return Segment(NOWHERE, vec4(0.0), vec2(0.0), kind, strength);
    }
    let size = panel.region.zw;
    let from_pixel = pixel_of(ends.a, size);
    let to_pixel = pixel_of(ends.b, size);
    let nearer = select(0.0, NEARER, kind == ALARM_EDGE || kind == ALARM_CONTOUR);
    let depths = vec2(ends.a.z / max(ends.a.w - nearer, panel.near), ends.b.z / max(ends.b.w - nearer, panel.near));
    let place = strip_corner(corner, from_pixel, to_pixel, 0.5 * max(widest(kind) * panel.line_scale, 1.0) + 0.5, size);
    return Segment(place, vec4(from_pixel, to_pixel) + panel.region.xyxy, depths, kind, strength);
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

// The visibility of an edge, and how much of it lies behind a body.
fn edge_shares(at: Beside, kind: u32, tap: u32) -> vec2<f32> {
    // Of a face seen at a grazing angle, what is a pixel nearer to the viewer lies before its edge. So the farther side counts.
    let across = 0.75 * vec2(-at.along.y, at.along.x);
    let here = tap_depth(at.middle, tap);
    let sides = vec2(tap_depth(at.middle + across, tap), tap_depth(at.middle - across, tap));
    let beside = select(sides, vec2(here), sides <= vec2(0.0));
    let seen = visible_share(at.depth * (1.0 + OFFSET), min(here, min(beside.x, beside.y)));
    // Obstacles hide all edges; their own edges are seen through clear surfaces only.
    let through = !(seen < 1.0 && is_obstacle(at.middle, tap));
    return vec2(seen, select(0.0, 1.0 - seen, through));
}

// How much of a contour is outer outline, how much is a step of depth inside the body, and how much is hidden.
fn contour_shares(at: Beside, kind: u32, tap: u32) -> vec3<f32> {
    let here = tap_depth(at.middle, tap);
    let normal = vec2(-at.along.y, at.along.x);
    let across = normal * (0.9 + 1.3 * panel.line_scale);
    let sides = vec2(tap_depth(at.middle + across, tap), tap_depth(at.middle - across, tap));
    let nearer = max(sides.x, sides.y);
    let farther = min(sides.x, sides.y);
    let step = STEP * panel.soft;
    let distance = distance_of(at.depth);
    // Surfaces that end in a contour are seen at a grazing angle and come much nearer within a pixel.
    let covered_by = distance - distance_of(max(farther, min(here, nearer)));
    var shown = 1.0 - smoothstep(0.4 * step, 0.6 * step, covered_by);
    let obstacles = vec2(
        is_obstacle(at.middle + across, tap),
        is_obstacle(at.middle - across, tap),
    );
    if kind == OBSTACLE_CONTOUR {
        // Round obstacles come nearer still: only other things than obstacles hide their contours fully.
        let least = panel.soft * select(vec2(0.5 * STEP), vec2(ROUND_STEP), obstacles);
        let before_it = vec2(distance) - vec2(distance_of(sides.x), distance_of(sides.y));
        let free = 1.0 - smoothstep(0.8 * least, 1.2 * least, before_it);
        shown = select(0.0, free.x * free.y, any(obstacles));
    }
    // Obstacles hide all contours behind them.
    var clear = 1.0;
    if kind != OBSTACLE_CONTOUR && is_obstacle(at.middle, tap) {
        clear = visible_share(at.depth * (1.0 + OFFSET), here);
    }
    var outline = 0.0;
    if farther <= 0.0 {
        // Background beside it: part of the outline. A fold of the surface that covers it slightly must be very close.
        let close = normal * select(-0.9, 0.9, sides.x <= sides.y);
        outline = select(shown, 1.0, tap_depth(at.middle + close, tap) <= 0.0);
    }
    // Where one thing ends before another, a contour is drawn however close they are.
    let deep = smoothstep(0.8 * step, 1.2 * step, distance_of(farther) - distance_of(nearer));
    let meets = obstacles.x != obstacles.y;
    let stepped = (1.0 - outline) * shown * select(deep, 1.0, meets);
    return clear * vec3(outline, stepped, 1.0 - outline - stepped);
}

// Where a pixel is beside a line.
struct Beside {
    // The nearest point of the line, and the line's direction.
    middle: vec2<f32>,
    along: vec2<f32>,
    distance: f32,
    depth: f32,
}

fn beside(segment: Segment) -> Beside {
    let start = segment.ends.xy;
    let difference = segment.ends.zw - start;
    let pixel = segment.place.xy;
    let share = clamp(dot(pixel - start, difference) / max(dot(difference, difference), 1e-6), 0.0, 1.0);
    let middle = start + share * difference;
    let along = difference / max(length(difference), 1e-6);
    return Beside(middle, along, length(pixel - middle), mix(segment.depths.x, segment.depths.y, share));
}

// Visibility is tested at the taps around the nearest point of the line, so that lines end smoothly. Each kind of line that reads
// more than others has a pipeline of its own: a software driver would read all of it for every line.

struct EdgeLook {
    // Opacity where the edge is seen, but for its width.
    strength: f32,
    // Visibility, and how much lies behind a body, of all taps.
    shares: vec2<f32>,
    // Opacity behind surfaces of elements that are not inverted, and of turned-over ones.
    hidden_alpha: vec2<f32>,
}

fn edge_look(at: Beside, kind: u32) -> EdgeLook {
    let element = panel.line_share * panel.element;
    let strength = min(1.0, element / SMALL_ELEMENT) * smoothstep(SMALLEST_ELEMENT.x, SMALLEST_ELEMENT.y, element);
    var shares = vec2(0.0);
    for (var tap = 0u; tap < TAPS; tap++) {
        shares += edge_shares(at, kind, tap) / f32(TAPS);
    }
    return EdgeLook(strength, shares, mix(SEEN_THROUGH, HIDDEN, panel.opacity));
}

@fragment
fn edge_opacity(segment: Segment) -> @location(0) vec4<f32> {
    let at = beside(segment);
    let kind = segment.kind;
    let scale = panel.line_scale;
    let look = edge_look(at, kind);
    let shares = look.shares;
    if kind == BAR {
        let seen = select(shares.x, 1.0, panel.flatness > 0.5);
        let alpha = 0.85 * seen + look.hidden_alpha.x * (1.0 - seen);
        return vec4(alpha * covered(at.distance, BAR_WIDTH * scale), 0.0, 0.0, 0.0);
    }
    if panel.flatness > 0.5 {
        return vec4(0.75 * look.strength * covered(at.distance, FLAT_EDGE_WIDTH * scale), 0.0, 0.0, 0.0);
    }
    let of_obstacle = kind == OBSTACLE_EDGE;
    let seen = 0.80 * select(look.strength, 1.0, of_obstacle) * covered(at.distance, EDGE_WIDTH * scale);
    let weak = look.hidden_alpha.x * look.strength * look.strength * covered(at.distance, 0.9 * scale);
    let hidden = select(weak, (1.0 - panel.opacity) * seen, of_obstacle);
    return vec4(shares.x * seen + segment.strength * shares.y * hidden, 0.0, 0.0, 0.0);
}

@fragment
fn alarm_edge_opacity(segment: Segment) -> @location(0) vec4<f32> {
    let at = beside(segment);
    let look = edge_look(at, ALARM_EDGE);
    // Turned-over elements hide more of it than others.
    var free = 0.0;
    for (var tap = 0u; tap < TAPS; tap++) {
        free += visible_share(at.depth * (1.0 + OFFSET), alarm_depth_around(at.middle, tap)) / f32(TAPS);
    }
    let behind = mix(0.15, look.hidden_alpha.y, free);
    let alpha = select(0.95 * look.shares.x + behind * look.shares.y, 0.95, panel.flatness > 0.5);
    let width = ALARM_EDGE_WIDTH * panel.line_scale * panel.contour_share;
    return vec4(0.0, look.strength * alpha * covered(at.distance, width), 0.0, 0.0);
}

struct ContourLook {
    // Opacities of the outline and of steps of depth.
    outline: f32,
    step: f32,
    // How much of it is hidden.
    hidden: f32,
    // The scale of its width.
    width: f32,
}

fn contour_look(at: Beside, segment: Segment) -> ContourLook {
    var shares = vec3(0.0);
    for (var tap = 0u; tap < TAPS; tap++) {
        shares += contour_shares(at, segment.kind, tap) / f32(TAPS);
    }
    shares *= segment.strength;
    // Small bodies would be mostly outline.
    let width = panel.line_scale * select(panel.contour_share, 1.0, segment.kind == OBSTACLE_CONTOUR);
    let outline = shares.x * covered(at.distance, CONTOUR_WIDTH * width);
    return ContourLook(outline, 0.85 * shares.y * covered(at.distance, 1.5 * width), shares.z, width);
}

@fragment
fn contour_opacity(segment: Segment) -> @location(0) vec4<f32> {
    let at = beside(segment);
    if panel.flatness > 0.5 {
        return vec4(0.0, 0.0, covered(at.distance, FLAT_CONTOUR_WIDTH * panel.line_scale), 0.0);
    }
    let look = contour_look(at, segment);
    return vec4(0.0, 0.0, look.outline, look.step);
}

@fragment
fn alarm_contour_opacity(segment: Segment) -> @location(0) vec4<f32> {
    let at = beside(segment);
    let scale = panel.line_scale;
    if panel.flatness > 0.5 {
        return vec4(0.0, covered(at.distance, FLAT_CONTOUR_WIDTH * scale), 0.0, 0.0);
    }
    let look = contour_look(at, segment);
    // Where the set ends, its outline is drawn at full strength.
    let across = vec2(-at.along.y, at.along.x) * (0.9 + 1.3 * scale);
    var ends = 0.0;
    for (var tap = 0u; tap < TAPS; tap++) {
        let farther = min(
            alarm_depth_around(at.middle + across, tap),
            alarm_depth_around(at.middle - across, tap),
        );
        ends += select(0.0, 1.0, farther <= 0.0) / f32(TAPS);
    }
    let smallness = min(1.0, panel.line_share * panel.element / SMALL_FOLDED);
    let fold = mix(smallness * smallness, 1.0, ends);
    let through = 0.80 * fold * look.hidden * covered(at.distance, 1.7 * look.width);
    return vec4(0.0, look.step + through, look.outline, 0.0);
}
