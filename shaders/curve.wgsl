// Flat curves over the finished picture, as straight pieces that fit together, blended as sRGB values like marks and
// words.

struct Piece {
    // Both ends (px).
    @location(0) ends: vec4<f32>,
    // Normals of the lines between this piece and its neighbours; zero at the ends of a curve.
    @location(1) joints: vec4<f32>,
    // sRGB and opacity.
    @location(2) colour: vec4<f32>,
    // Width, start in the pattern, and length of the pattern (px): 0 for a solid curve.
    @location(3) pattern: vec3<f32>,
    // The lengths of up to three dashes and gaps (px); 0 for missing ones.
    @location(4) dashes: vec4<f32>,
    @location(5) last_dash: vec2<f32>,
}

struct Corner {
    @builtin(position) place: vec4<f32>,
    @location(0) @interpolate(flat) ends: vec4<f32>,
    @location(1) @interpolate(flat) joints: vec4<f32>,
    @location(2) @interpolate(flat) colour: vec4<f32>,
    @location(3) @interpolate(flat) pattern: vec3<f32>,
    @location(4) @interpolate(flat) dashes: vec4<f32>,
    @location(5) @interpolate(flat) last_dash: vec2<f32>,
}

struct Canvas {
    size: vec2<f32>,
    unused: vec2<f32>,
}

@group(0) @binding(0) var<uniform> canvas: Canvas;

// Unit vector from one end to the other; to the right for a dot.
fn direction(ends: vec4<f32>) -> vec2<f32> {
    let way = ends.zw - ends.xy;
    let distance = length(way);
    return select(vec2(1.0, 0.0), way / max(distance, 1e-9), distance > 0.0);
}

@vertex
fn piece(@builtin(vertex_index) index: u32, piece: Piece) -> Corner {
    let reach = 0.5 * piece.pattern.x + 1.0;
    let along = direction(piece.ends);
    let end = select(piece.ends.xy - reach * along, piece.ends.zw + reach * along, (index & 1u) == 1u);
    let at = end + select(-reach, reach, (index >> 1u) == 1u) * vec2(-along.y, along.x);
    let place = vec4(at / canvas.size * vec2(2.0, -2.0) + vec2(-1.0, 1.0), 0.5, 1.0);
    return Corner(place, piece.ends, piece.joints, piece.colour, piece.pattern, piece.dashes, piece.last_dash);
}

@fragment
fn piece_colour(corner: Corner) -> @location(0) vec4<f32> {
    let from_start = corner.place.xy - corner.ends.xy;
    let from_end = corner.place.xy - corner.ends.zw;
    // Each pixel belongs to one of two joined pieces, so that no joint is covered twice. Both compute the same bits.
    let before = dot(from_start, corner.joints.xy) < 0.0;
    let after = any(corner.joints.zw != vec2(0.0)) && dot(from_end, corner.joints.zw) >= 0.0;
    if before || after {
        return vec4(0.0);
    }
    let along = direction(corner.ends);
    let gone = clamp(dot(from_start, along), 0.0, length(corner.ends.zw - corner.ends.xy));
    let off = length(from_start - gone * along);
    let half_width = 0.5 * corner.pattern.x;
    // Curves thinner than a pixel are fainter instead.
    var covered = saturate(half_width + 0.5 - off) - saturate(0.5 - half_width - off);
    let period = corner.pattern.z;
    if period > 0.0 {
        let place = corner.pattern.y + gone;
        let phase = place - period * floor(place / period);
        let first = corner.dashes.x;
        let second = first + corner.dashes.y;
        let third = second + corner.dashes.z + corner.dashes.w;
        // The depth inside a dash, of this pattern or the first of the next.
        var inside = max(min(phase, first - phase), phase - period);
        if corner.dashes.z > 0.0 {
            inside = max(inside, min(phase - second, second + corner.dashes.z - phase));
        }
        if corner.last_dash.x > 0.0 {
            inside = max(inside, min(phase - third, third + corner.last_dash.x - phase));
        }
        covered *= saturate(0.5 + inside);
    }
    return vec4(corner.colour.rgb, corner.colour.a * covered);
}
