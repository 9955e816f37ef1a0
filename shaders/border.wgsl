// Smooth borders of surfaces: where their colours change at a line, what a pixel that the line crosses gains from the area that
// lies on the other side. What several lines add is summed, as each covers another part of the pixel.

// A line is hidden by what lies before it by more than so many pixels are wide there.
const HIDDEN_BY = 6.0;
// From this distance (px) to the line on, rounding cannot make a pixel belong to the other side.
const SURE = 0.004;

// The part of a pixel that lies on the side of a line to which its normal points, if the middle of the pixel is so far on that
// side (px).
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

// Of the turned-over set, which has a depth of its own.
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
    // How far from its middle a pixel reaches, along the line and across.
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
    // Faces meet in a crease on both of its sides, so it is hidden by what is before the nearer one. A contour has the surface
    // on one side: it is hidden if all that is around it is before it.
    let is_crease = segment.kind == EDGE || segment.kind == ALARM_EDGE;
    let beside = select(min(min(depths.x, depths.y), depths.z), max(depths.x, depths.y), is_crease);
    let distance = distance_of(mix(segment.depths.x, segment.depths.y, share));
    let is_hidden = distance * (1.0 - HIDDEN_BY / panel.focal) > distance_of(beside);
    // Where a set is seen through others, its hidden edges would count, too, where they end at its outline.
    if is_hidden || (segment.kind == ALARM_EDGE && min(depths.x, depths.y) <= 0.0) {
        discard;
    }
    let own = decoded_body(textureLoad(body_colour, own_texel, 0));
    let one = decoded_body(textureLoad(body_colour, select(first, own_texel, off < -SURE), 0));
    let other = decoded_body(textureLoad(body_colour, select(second, own_texel, off > SURE), 0));
    let seen = mix(one, other, area_beyond(off, normal));
    return (seen - own) * within / (2.0 * reach);
}
