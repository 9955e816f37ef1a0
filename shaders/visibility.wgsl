// The visibility of lines, tested before they are drawn: once for each pixel of their length, not for each pixel that
// they cover. The tests are made at the taps around the point of the line, so that lines end smoothly. Each kind of
// line has a pipeline, as the tests differ.

// Consecutive samples along one line: the line, and its first sample.
@group(2) @binding(0) var<storage, read> chunks: array<vec2<u32>>;
@group(2) @binding(2) var found: texture_storage_2d<rgba8unorm, write>;
// The first chunk to test, and the number of chunks.
@group(2) @binding(3) var<uniform> range: vec2<u32>;

const CHUNK = 4u;
const GROUP = 128u;

// From this step of depth on, a contour inside the body is drawn (soft units).
const STEP = 0.22;
// Below this step (soft units) an obstacle does not hide its own contour or that of another.
const ROUND_STEP = 0.8;

// Whether a solid obstacle, marked by its opacity, is at one of the taps around a point. `AMONG` tells whether there are
// any.
fn is_obstacle(place: vec2<f32>, tap: u32) -> bool {
    return AMONG && abs(textureLoad(body_colour, texel_around(place, tap), 0).a - OBSTACLE) < 0.001;
}

// The depth of the turned-over set alone at one of the taps around a point.
fn alarm_depth_around(place: vec2<f32>, tap: u32) -> f32 {
    return load_alarm_depth(texel_around(place, tap));
}

// The visibility of an edge, and the part of it behind a body.
fn edge_shares(at: Beside, tap: u32) -> vec2<f32> {
    // A face seen at a grazing angle has points in front of its edge a pixel nearer to the viewer. So the farther side
    // counts.
    let across = 0.75 * vec2(-at.along.y, at.along.x);
    let here = tap_depth(at.middle, tap);
    let sides = vec2(tap_depth(at.middle + across, tap), tap_depth(at.middle - across, tap));
    let beside = select(sides, vec2(here), sides <= vec2(0.0));
    let seen = visible_share(at.depth * (1.0 + OFFSET), min(here, min(beside.x, beside.y)));
    // Obstacles hide all edges.
    let through = !(seen < 1.0 && is_obstacle(at.middle, tap));
    return vec2(seen, select(0.0, 1.0 - seen, through));
}

// The share of a contour that is outer outline, that is a step of depth inside the body, and that is hidden.
fn contour_shares(at: Beside, kind: u32, tap: u32) -> vec3<f32> {
    let here = tap_depth(at.middle, tap);
    let normal = vec2(-at.along.y, at.along.x);
    let across = normal * (0.9 + 1.3 * panel.line_scale);
    let sides = vec2(tap_depth(at.middle + across, tap), tap_depth(at.middle - across, tap));
    let nearer = max(sides.x, sides.y);
    let farther = min(sides.x, sides.y);
    let step = STEP * panel.soft;
    let distance = distance_of(at.depth);
    // Surfaces that end in a contour are seen at a grazing angle, and come much nearer within a pixel.
    let covered_by = distance - distance_of(max(farther, min(here, nearer)));
    var shown = 1.0 - smoothstep(0.4 * step, 0.6 * step, covered_by);
    let obstacles = vec2(
        is_obstacle(at.middle + across, tap),
        is_obstacle(at.middle - across, tap),
    );
    if kind == OBSTACLE_CONTOUR {
        // Round obstacles come nearer still: only other objects hide their contours fully.
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
    // Where one object ends in front of another, a contour is drawn at any distance.
    let deep = smoothstep(0.8 * step, 1.2 * step, distance_of(farther) - distance_of(nearer));
    let meets = obstacles.x != obstacles.y;
    let stepped = (1.0 - outline) * shown * select(deep, 1.0, meets);
    return clear * vec3(outline, stepped, 1.0 - outline - stepped);
}

// One sample of a line.
struct Sample {
    at: Beside,
    kind: u32,
    place: vec2<u32>,
    exists: bool,
}

fn sample_of(thread: vec3<u32>, groups: vec3<u32>) -> Sample {
    panel = panel_data;
    let index = thread.y * groups.x * GROUP + thread.x;
    let within = index / CHUNK < range.y;
    let chunk = chunks[range.x + min(index / CHUNK, range.y - 1u)];
    let line = lines[chunk.x];
    let look = line.rest.z;
    let kind = extractBits(look, 0u, KIND_BITS);
    let count = look >> (KIND_BITS + STRENGTH_BITS);
    let number = chunk.y + index % CHUNK;
    let depths = bitcast<vec2<f32>>(line.rest.xy);
    let share = f32(number) / f32(count - 1u);
    let difference = line.ends.zw - line.ends.xy;
    let along = difference / max(length(difference), 1e-6);
    let middle = panel.region.xy + line.ends.xy + share * difference;
    let at = Beside(middle, along, 0.0, mix(depths.x, depths.y, share), share);
    return Sample(at, kind, visibility_place(line.rest.w + number), within && number < count);
}

// Edges: the visibility, and the part behind a body.
@compute @workgroup_size(GROUP)
fn edges(@builtin(global_invocation_id) thread: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let one = sample_of(thread, groups);
    if !one.exists {
        return;
    }
    var shares = vec2(0.0);
    for (var tap = 0u; tap < TAPS; tap++) {
        shares += edge_shares(one.at, tap) / f32(TAPS);
    }
    textureStore(found, one.place, vec4(shares, 0.0, 0.0));
}

// Edges of turned-over elements: also whether none of these hides it.
@compute @workgroup_size(GROUP)
fn alarm_edges(@builtin(global_invocation_id) thread: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let one = sample_of(thread, groups);
    if !one.exists {
        return;
    }
    var shares = vec2(0.0);
    var free = 0.0;
    for (var tap = 0u; tap < TAPS; tap++) {
        shares += edge_shares(one.at, tap) / f32(TAPS);
        free += visible_share(one.at.depth * (1.0 + OFFSET), alarm_depth_around(one.at.middle, tap)) / f32(TAPS);
    }
    textureStore(found, one.place, vec4(shares, free, 0.0));
}

// Contours: the share that is outer outline, that is a step of depth inside the body, and that is hidden.
@compute @workgroup_size(GROUP)
fn contours(@builtin(global_invocation_id) thread: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let one = sample_of(thread, groups);
    if !one.exists {
        return;
    }
    var shares = vec3(0.0);
    for (var tap = 0u; tap < TAPS; tap++) {
        shares += contour_shares(one.at, one.kind, tap) / f32(TAPS);
    }
    textureStore(found, one.place, vec4(shares, 0.0));
}

// Contours of turned-over elements: also whether the set ends there.
@compute @workgroup_size(GROUP)
fn alarm_contours(@builtin(global_invocation_id) thread: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let one = sample_of(thread, groups);
    if !one.exists {
        return;
    }
    let at = one.at;
    let across = vec2(-at.along.y, at.along.x) * (0.9 + 1.3 * panel.line_scale);
    var shares = vec3(0.0);
    var ends = 0.0;
    for (var tap = 0u; tap < TAPS; tap++) {
        shares += contour_shares(at, one.kind, tap) / f32(TAPS);
        let farther = min(alarm_depth_around(at.middle + across, tap), alarm_depth_around(at.middle - across, tap));
        ends += select(0.0, 1.0, farther <= 0.0) / f32(TAPS);
    }
    textureStore(found, one.place, vec4(shares, ends));
}
