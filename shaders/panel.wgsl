// The data of a panel that every pass reads. Lengths are in sides from the panel's origin, colours are linear.

// The opacity stored for an obstacle, by which later passes recognise it. The difference to opaque is invisible.
const OBSTACLE = 254.0 / 255.0;

struct Occluder {
    // The middle of a box, and the reach of the obstacle around it.
    first: vec4<f32>,
    // Half the sides of the box; 1 if the obstacle is transparent.
    second: vec4<f32>,
    // The rotation of the box, as a quaternion.
    rotation: vec4<f32>,
}

struct Panel {
    // From the panel's coordinates to clip space of the target; depth is near / distance.
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
    // Colour of sound elements; length of an element's edge (px).
    sound: vec3<f32>,
    element: f32,
    // Colour of turned-over elements; thickness of lines relative to the reference.
    alarm: vec3<f32>,
    line_scale: f32,
    // Colour of their hatch and edges.
    alarm_line: vec3<f32>,
    outline_alpha: f32,
    // Colour of the edges of sound elements; pixels for a slope of one.
    edge: vec3<f32>,
    focal: f32,
    // Colour of the outline; unit of soft distances in light and of steps in depth.
    outline: vec3<f32>,
    soft: f32,
    // Colour of obstacles; width of contours of bodies, from 0 to 1.
    obstacle: vec3<f32>,
    contour_share: f32,
    // Left, top, width and height of the body's region in the textures of bodies (px).
    region: vec4<f32>,
    // Its left and top in the picture (px), minus its left and top in those textures; the middle of the body in the
    // picture (px).
    place: vec4<f32>,
    // Left, top, width and height of the panel in the picture (px).
    viewport: vec4<f32>,
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

// Powers of a colour's brightness, weighted like the eye.
const LUMINANCE = vec3<f32>(0.2126, 0.7152, 0.0722);

// Widths of edges and contours in space (px in the reference picture). In the plane they are wider.
const EDGE_WIDTH = 1.15;
const CONTOUR_WIDTH = 2.2;
// The opacity of visible edges.
const EDGE_ALPHA = 0.80;
