// The data of a panel that every pass reads. Lengths are in sides from the panel's origin, colours are linear.

struct Occluder {
    // The middle of a box, and the reach of the obstacle around it.
    first: vec4<f32>,
    // Half the sides of the box; 1 if the obstacle is transparent.
    second: vec4<f32>,
    // The rotation of the box, as a quaternion.
    rotation: vec4<f32>,
}

const BODIES = 5;

struct Panel {
    // From the panel's coordinates to clip space of its viewport; depth is near / distance.
    clip: mat4x4<f32>,
    // The position of the eye; distance of the near plane.
    eye: vec3<f32>,
    near: f32,
    // Towards the key light; opacity of edges, before the factors for their elements.
    key: vec3<f32>,
    edging: f32,
    // The floor's outward normal, and its height along the normal.
    up: vec3<f32>,
    floor: f32,
    // Colour of turned-over elements; width of contours of bodies, from 0 to 1.
    alarm: vec3<f32>,
    contour_share: f32,
    // Colour of their hatch and edges; unit of soft distances in light.
    alarm_line: vec3<f32>,
    soft: f32,
    // Colour of the edges of sound elements; the width of a texel of the map of the key light, as a depth of it.
    edge: vec3<f32>,
    key_texel: f32,
    // Colour of obstacles.
    obstacle: vec4<f32>,
    // From the panel's coordinates to the box of the map of the key light.
    key_map: mat4x4<f32>,
    // The middle of the body in the picture (px); the layer of that map, or −1; thickness of lines relative to the reference.
    middle: vec2<f32>,
    key_layer: f32,
    line_scale: f32,
    // Colours of sound elements, for each body.
    bodies: array<vec4<f32>, BODIES>,
    // The distances over which solid obstacles fade from the left, upper, right and lower side of their room (px); these
    // sides (px); and the strength of the fading at each.
    fade_distance: vec4<f32>,
    fade_room: vec4<f32>,
    fade_strength: vec4<f32>,
    // The obstacles near the body; unused entries have no effect.
    occluders: array<Occluder, 5>,
}

@group(0) @binding(0) var<uniform> panel_data: Panel;

// A private copy for the functions below, made by vertex shaders. Where it pays, fragment shaders get frequently used
// values from the corners, as constant varyings: a software driver reads a uniform buffer anew for each lane.
var<private> panel: Panel;

// The part of a pixel that lines of a grid at whole numbers cover, in each direction.
fn grid_lines(cells: vec2<f32>) -> vec2<f32> {
    let across = vec2(length(vec2(dpdx(cells.x), dpdy(cells.x))), length(vec2(dpdx(cells.y), dpdy(cells.y))));
    let width = max(across, vec2(1e-6));
    let thickness = max(panel.line_scale, 1.0);
    let off = abs(fract(cells - 0.5) - 0.5) / width;
    return clamp(0.5 * thickness + 0.5 - off, vec2(0.0), vec2(1.0))
        * (panel.line_scale / thickness) * (1.0 - smoothstep(vec2(0.12), vec2(0.4), width));
}

// Powers of a colour's brightness, weighted like the eye.
const LUMINANCE = vec3<f32>(0.2126, 0.7152, 0.0722);
