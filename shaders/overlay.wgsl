// Marks and words on top of everything. They are blended as sRGB values, the way type is made for.

struct Mark {
    // Left, top, width and height (px).
    @location(0) rectangle: vec4<f32>,
    // sRGB.
    @location(1) colour: vec4<f32>,
    @location(2) second: vec4<f32>,
    // Left and top in the atlas of glyphs.
    @location(3) glyph: vec2<u32>,
    @location(4) shape: u32,
}

struct Corner {
    @builtin(position) place: vec4<f32>,
    @location(0) @interpolate(flat) rectangle: vec4<f32>,
    @location(1) @interpolate(flat) colour: vec4<f32>,
    @location(2) @interpolate(flat) second: vec4<f32>,
    @location(3) @interpolate(flat) glyph: vec2<u32>,
    @location(4) @interpolate(flat) shape: u32,
}

struct Canvas {
    size: vec2<f32>,
    unused: vec2<f32>,
}

@group(0) @binding(0) var<uniform> canvas: Canvas;
@group(0) @binding(1) var glyphs: texture_2d<f32>;

const FILLED = 0u;
const STRUCK = 1u;
const GLYPH = 2u;

@vertex
fn corner(@builtin(vertex_index) index: u32, mark: Mark) -> Corner {
    let at = mark.rectangle.xy + mark.rectangle.zw * vec2(f32(index & 1u), f32(index >> 1u));
    let place = vec4(at / canvas.size * vec2(2.0, -2.0) + vec2(-1.0, 1.0), 0.5, 1.0);
    return Corner(place, mark.rectangle, mark.colour, mark.second, mark.glyph, mark.shape);
}

@fragment
fn mark_colour(corner: Corner) -> @location(0) vec4<f32> {
    let at = corner.place.xy - corner.rectangle.xy;
    if corner.shape == GLYPH {
        let texel = vec2<i32>(corner.glyph) + vec2<i32>(floor(at));
        return vec4(corner.colour.rgb, textureLoad(glyphs, texel, 0).r);
    }
    if corner.shape == STRUCK {
        let size = corner.rectangle.zw;
        let off = abs(at.x / size.x + at.y / size.y - 1.0) / length(1.0 / size);
        let line = clamp(0.07 * (size.x + size.y) + 0.5 - off, 0.0, 1.0);
        return vec4(mix(corner.colour.rgb, corner.second.rgb, line), 1.0);
    }
    return vec4(corner.colour.rgb, 1.0);
}
