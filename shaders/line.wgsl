// Edges, contours and outlines as smooth lines. Each pixel gets the opacity of four kinds of lines: edges of
// turned-over elements, edges of others, the outer outline, and steps of depth inside the body. The largest opacity
// wins, so that joints are as even as the rest.

struct Segment {
    @builtin(position) place: vec4<f32>,
    @location(0) @interpolate(flat) ends: vec4<f32>,
    @location(1) @interpolate(flat) depths: vec2<f32>,
    @location(2) @interpolate(flat) kind: u32,
    // Opacity, and the first of its samples of visibility with their number.
    @location(3) @interpolate(flat) strength: f32,
    @location(4) @interpolate(flat) samples: vec2<u32>,
    // Values of a panel that all its pixels share.
    @location(5) @interpolate(flat) scales: vec4<f32>,
}

fn unpack(segment: Segment) {
    panel.line_scale = segment.scales.x;
    panel.contour_share = segment.scales.y;
    panel.element = segment.scales.z;
    panel.edging = segment.scales.w;
}

const EDGE = 0u;
const ALARM_EDGE = 1u;
const CONTOUR = 2u;
const ALARM_CONTOUR = 3u;
const BAR = 4u;
const OBSTACLE_EDGE = 8u;
const OBSTACLE_CONTOUR = 9u;
// The packed number of a line: its kind, its opacity (of 255), and its number of samples.
const KIND_BITS = 4u;
const STRENGTH_BITS = 8u;

// Opacities of hidden edges, of sound and of turned-over elements. The last digits of the first keep the bytes of
// earlier pictures.
const HIDDEN_ALPHA = 0.16000003;
const ALARM_HIDDEN_ALPHA = 0.62;

// A line lies this much in front of its surface, relative to the distance.
const OFFSET = 0.0016;
// Folds inside the turned-over set of elements smaller than this (px) are fainter.
const SMALL_FOLDED = 8.0;

// The width of the widest line of a kind (px in the reference picture).
fn widest(kind: u32) -> f32 {
    switch kind {
        case EDGE, OBSTACLE_EDGE: { return EDGE_WIDTH; }
        case ALARM_EDGE: { return ALARM_EDGE_WIDTH; }
        case BAR: { return BAR_WIDTH; }
        default: { return CONTOUR_WIDTH; }
    }
}

// A line: its two ends on the panel's region (px), and the bits of its depths, of the packed number, and of its first
// sample.
struct Line {
    ends: vec4<f32>,
    rest: vec4<u32>,
}

@group(2) @binding(1) var<storage, read> lines: array<Line>;

// Three corners for each line: a software driver takes longer to begin an instance than to draw it.
@vertex
fn segment(@builtin(vertex_index) vertex: u32) -> Segment {
    panel = panel_data;
    let line = lines[vertex / 3u];
    let ends = line.ends;
    let look = line.rest.z;
    let kind = extractBits(look, 0u, KIND_BITS);
    let strength = f32(extractBits(look, KIND_BITS, STRENGTH_BITS)) / 255.0;
    let samples = vec2(line.rest.w, look >> (KIND_BITS + STRENGTH_BITS));
    let reach = 0.5 * max(widest(kind) * panel.line_scale, 1.0) + 0.5;
    let place = triangle_corner(vertex % 3u, ends.xy, ends.zw, reach, panel.region.zw);
    let scales = vec4(panel.line_scale, panel.contour_share, panel.element, panel.edging);
    let depths = bitcast<vec2<f32>>(line.rest.xy);
    return Segment(place, ends + panel.region.xyxy, depths, kind, strength, samples, scales);
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

// The place of a pixel beside a line.
struct Beside {
    // The nearest point of the line, and the line's direction.
    middle: vec2<f32>,
    along: vec2<f32>,
    distance: f32,
    depth: f32,
    // The part of the line before that point.
    share: f32,
}

fn beside(segment: Segment) -> Beside {
    let start = segment.ends.xy;
    let difference = segment.ends.zw - start;
    let pixel = segment.place.xy;
    let share = clamp(dot(pixel - start, difference) / max(dot(difference, difference), 1e-6), 0.0, 1.0);
    let middle = start + share * difference;
    let along = difference / max(length(difference), 1e-6);
    return Beside(middle, along, length(pixel - middle), mix(segment.depths.x, segment.depths.y, share), share);
}

// The tested visibility of lines, line after line: see `visibility.wgsl`.
@group(1) @binding(4) var visibility: texture_2d<f32>;

const VISIBILITY_WIDTH = 2048u;

fn visibility_place(sample: u32) -> vec2<u32> {
    return vec2(sample % VISIBILITY_WIDTH, sample / VISIBILITY_WIDTH);
}

// The visibility of a line at a part of its length, between the two samples around it.
fn visibility_at(segment: Segment, share: f32) -> vec4<f32> {
    let along = share * f32(segment.samples.y - 1u);
    let before = min(u32(along), segment.samples.y - 2u);
    let first = segment.samples.x + before;
    let one = textureLoad(visibility, visibility_place(first), 0);
    let other = textureLoad(visibility, visibility_place(first + 1u), 0);
    return mix(one, other, along - f32(before));
}

@fragment
fn edge_opacity(segment: Segment) -> @location(0) vec4<f32> {
    unpack(segment);
    let at = beside(segment);
    let scale = panel.line_scale;
    let kind = segment.kind;
    let shares = visibility_at(segment, at.share);
    let strength = panel.edging;
    let of_obstacle = kind == OBSTACLE_EDGE;
    let seen = EDGE_ALPHA * select(strength, 1.0, of_obstacle) * covered(at.distance, EDGE_WIDTH * scale);
    let weak = HIDDEN_ALPHA * strength * strength * covered(at.distance, 0.9 * scale);
    let hidden = select(weak, 0.0, of_obstacle);
    let edge = shares.x * seen + segment.strength * shares.y * hidden;
    let bar = mix(HIDDEN_ALPHA, BAR_ALPHA, shares.x) * covered(at.distance, BAR_WIDTH * scale);
    return vec4(select(edge, bar, kind == BAR), 0.0, 0.0, 0.0);
}

@fragment
fn alarm_edge_opacity(segment: Segment) -> @location(0) vec4<f32> {
    unpack(segment);
    let at = beside(segment);
    let shares = visibility_at(segment, at.share);
    // Turned-over elements hide more of a line than others.
    let behind = mix(0.15, ALARM_HIDDEN_ALPHA, shares.z);
    let alpha = ALARM_EDGE_ALPHA * shares.x + behind * shares.y;
    let width = ALARM_EDGE_WIDTH * panel.line_scale * panel.contour_share;
    return vec4(0.0, panel.edging * alpha * covered(at.distance, width), 0.0, 0.0);
}

struct ContourLook {
    // Opacities of the outline, of steps of depth, and of hidden lines.
    outline: f32,
    step: f32,
    hidden: f32,
}

fn contour_look(distance: f32, segment: Segment, shares: vec4<f32>) -> ContourLook {
    // Small bodies would be mostly outline.
    let width = panel.line_scale * select(panel.contour_share, 1.0, segment.kind == OBSTACLE_CONTOUR);
    let shown = segment.strength * shares;
    return ContourLook(
        shown.x * covered(distance, CONTOUR_WIDTH * width),
        0.85 * shown.y * covered(distance, 1.5 * width),
        0.80 * shown.z * covered(distance, 1.7 * width),
    );
}

@fragment
fn contour_opacity(segment: Segment) -> @location(0) vec4<f32> {
    unpack(segment);
    let at = beside(segment);
    let look = contour_look(at.distance, segment, visibility_at(segment, at.share));
    return vec4(0.0, 0.0, look.outline, look.step);
}

@fragment
fn alarm_contour_opacity(segment: Segment) -> @location(0) vec4<f32> {
    unpack(segment);
    let at = beside(segment);
    let shares = visibility_at(segment, at.share);
    let look = contour_look(at.distance, segment, shares);
    let smallness = min(1.0, panel.element / SMALL_FOLDED);
    // At the end of the set, its outline is drawn at full strength.
    let fold = mix(smallness * smallness, 1.0, shares.w);
    return vec4(0.0, look.step + fold * look.hidden, look.outline, 0.0);
}
