// Smooth borders of surfaces. A pixel that a line between two colours crosses gets the colour of the other side for the
// area there. Gains from several lines are summed, because each covers another part of the pixel.

// A line is hidden by depths that are nearer by more than this many pixels.
const HIDDEN_BY = 6.0;
// Beyond this distance (px) from the line, rounding cannot put a pixel on the other side.
const SURE = 0.004;

// The part of a pixel on the side of a line to which its normal points, by the distance of its middle from the line
// (px).
fn area_beyond(off: f32, normal: vec2<f32>) -> f32 {
    let wide = max(abs(normal.x), abs(normal.y));
    let narrow = min(abs(normal.x), abs(normal.y));
    let left = 0.5 * (wide + narrow) - abs(off);
    let smaller = select(0.5 - abs(off) / wide, left * left / (2.0 * wide * max(narrow, 1e-6)), left < narrow);
    return select(smaller, 1.0 - smaller, off > 0.0);
}

@fragment
fn border_colour(segment: Segment) -> @location(0) vec4<f32> {
    return gained(segment, false);
}

// The depth of the turned-over set alone.
@fragment
fn alarm_border_colour(segment: Segment) -> @location(0) vec4<f32> {
    return gained(segment, true);
}

fn depth_of(texel: vec2<i32>, of_alarm: bool) -> f32 {
    if of_alarm {
        return load_alarm_depth(texel);
    }
    return load_depth(texel);
}

fn gained(segment: Segment, of_alarm: bool) -> vec4<f32> {
    panel = panel_data;
    let start = segment.ends.xy;
    let difference = segment.ends.zw - start;
    let extent = length(difference);
    let along = difference / max(extent, 1e-6);
    let normal = vec2(-along.y, along.x);
    let from_start = segment.place.xy - start;
    let off = dot(from_start, normal);
    let gone = dot(from_start, along);
    // Half the size of a pixel along the line and across.
    let reach = 0.5 * (abs(normal.x) + abs(normal.y));
    let within = min(gone + reach, extent) - max(gone - reach, 0.0);
    if abs(off) >= reach || within <= 0.0 {
        discard;
    }
    // The neighbours across the line.
    let is_steep = abs(normal.x) > abs(normal.y);
    let across = select(vec2(0.0, sign(normal.y)), vec2(sign(normal.x), 0.0), is_steep);
    let first = texel_of(segment.place.xy - across);
    let second = texel_of(segment.place.xy + across);
    let own_texel = texel_of(segment.place.xy);
    let share = saturate(gone / max(extent, 1e-6));
    let depths = vec3(depth_of(first, of_alarm), depth_of(second, of_alarm), depth_of(own_texel, of_alarm));
    // A crease has faces on both sides, so depths before the nearer one hide it. A contour has the surface on one side,
    // so it is hidden if all depths around it are before it.
    let is_crease = segment.kind == EDGE || segment.kind == ALARM_EDGE;
    let beside = select(min(min(depths.x, depths.y), depths.z), max(depths.x, depths.y), is_crease);
    let distance = distance_of(mix(segment.depths.x, segment.depths.y, share));
    let is_hidden = distance * (1.0 - HIDDEN_BY / panel.focal) > distance_of(beside);
    // Hidden edges of a set that is visible through others would count where they end at its outline.
    if is_hidden || (segment.kind == ALARM_EDGE && min(depths.x, depths.y) <= 0.0) {
        discard;
    }
    let own = decoded_body(textureLoad(body_colour, own_texel, 0));
    let one = decoded_body(textureLoad(body_colour, select(first, own_texel, off < -SURE), 0));
    let other = decoded_body(textureLoad(body_colour, select(second, own_texel, off > SURE), 0));
    let seen = mix(one, other, area_beyond(off, normal));
    return (seen - own) * within / (2.0 * reach);
}
