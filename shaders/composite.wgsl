// Bodies and their lines, laid over the ground.

@group(1) @binding(2) var lines: texture_2d<f32>;
// What pixels gain that borders cross.
@group(1) @binding(3) var borders: texture_2d<f32>;

@vertex
fn corner(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    // The viewport is the body's region.
    return vec4(f32(index & 1u) * 2.0 - 1.0, f32(index >> 1u) * 2.0 - 1.0, 0.5, 1.0);
}

fn over(colour: vec4<f32>, above: vec3<f32>, alpha: f32) -> vec4<f32> {
    return mix(colour, vec4(above, 1.0), alpha);
}

@fragment
fn layered(@builtin(position) place: vec4<f32>) -> @location(0) vec4<f32> {
    let at = vec2<i32>(place.xy - panel.place.xy);
    let opacity = textureLoad(lines, at, 0);
    var colour = saturate(decoded_body(textureLoad(body_colour, at, 0)) + textureLoad(borders, at, 0));
    colour = over(colour, panel.edge, opacity.r);
    colour = over(colour, panel.alarm_line, opacity.g);
    colour = over(colour, panel.edge, opacity.a);
    return over(colour, panel.outline, opacity.b * panel.outline_alpha);
}
