// Bodies and their lines over the ground.

struct Corner {
    @builtin(position) place: vec4<f32>,
    @location(0) @interpolate(flat) region: vec4<f32>,
    @location(1) @interpolate(flat) shift: vec4<f32>,
    @location(2) @interpolate(flat) edge: vec3<f32>,
    @location(3) @interpolate(flat) alarm_line: vec3<f32>,
    @location(4) @interpolate(flat) outline: vec4<f32>,
}

@vertex
fn corner(@builtin(vertex_index) index: u32) -> Corner {
    panel = panel_data;
    // The viewport is the body's region.
    let place = vec4(f32(index & 1u) * 2.0 - 1.0, f32(index >> 1u) * 2.0 - 1.0, 0.5, 1.0);
    let outline = vec4(panel.outline, panel.outline_alpha);
    return Corner(place, panel.region, panel.place, panel.edge, panel.alarm_line, outline);
}

fn over(colour: vec4<f32>, above: vec3<f32>, alpha: f32) -> vec4<f32> {
    return mix(colour, vec4(above, 1.0), alpha);
}

// The body at a texel of the panel's region, or at the nearest texel in the region.
fn body_at(at: vec2<i32>) -> vec4<f32> {
    let low = vec2<i32>(panel.region.xy);
    let high = low + vec2<i32>(panel.region.zw) - 1;
    return decoded_body(textureLoad(body_colour, clamp(at, low, high), 0));
}

// The colour of a pixel with the light of borders. Each border mixes the pixel with a neighbour, so the result stays
// within the colours of all neighbours.
fn with_borders(at: vec2<i32>) -> vec4<f32> {
    let own = body_at(at);
    let gained = textureLoad(borders, at, 0);
    var least = own;
    var most = own;
    // A software driver runs both branches, but leaves a loop that all its lanes have left.
    let count = select(0, 4, any(gained != vec4(0.0)));
    var step = vec2(1, 0);
    for (var side = 0; side < count; side++) {
        let beside = body_at(at + step);
        least = min(least, beside);
        most = max(most, beside);
        step = vec2(-step.y, step.x);
    }
    return clamp(own + gained, least, most);
}

fn layered_at(corner: Corner) -> vec4<f32> {
    panel.region = corner.region;
    panel.place = corner.shift;
    panel.edge = corner.edge;
    panel.alarm_line = corner.alarm_line;
    panel.outline = corner.outline.rgb;
    panel.outline_alpha = corner.outline.a;
    let at = vec2<i32>(corner.place.xy - panel.place.xy);
    let opacity = textureLoad(line_opacity, at, 0);
    var colour = with_borders(at);
    colour = over(colour, panel.edge, opacity.r);
    colour = over(colour, panel.alarm_line, opacity.g);
    colour = over(colour, panel.edge, opacity.a);
    return over(colour, panel.outline, opacity.b * panel.outline_alpha);
}

@fragment
fn layered(corner: Corner) -> @location(0) vec4<f32> {
    return layered_at(corner);
}

// The reach of outlines beyond bodies, also where they cross pixels (px in the reference picture).
const LINE_REACH = 2.0;

// Whether a body is at a texel of the region: its opacity is greater than that of obstacles.
fn stays(at: vec2<i32>) -> bool {
    return body_at(at).a > OBSTACLE + 0.001;
}

@fragment
fn layered_fading(corner: Corner) -> @location(0) vec4<f32> {
    let colour = layered_at(corner);
    let pixel = corner.place.xy;
    let at = vec2<i32>(pixel - panel.place.xy);
    // The outer halves of outlines are beside bodies.
    let reach = i32(ceil(LINE_REACH * panel_data.line_scale));
    let beside = body_at(at).a == 0.0 && (stays(at + vec2(reach, 0)) || stays(at - vec2(reach, 0))
        || stays(at + vec2(0, reach)) || stays(at - vec2(0, reach)));
    let room = panel_data.fade_room;
    let inside = vec4(pixel - room.xy, room.zw - pixel);
    let left = 1.0 - panel_data.fade_strength * (1.0 - smoothstep(vec4(0.0), panel_data.fade_distance, inside));
    return colour * select(left.x * left.y * left.z * left.w, 1.0, beside || stays(at));
}
