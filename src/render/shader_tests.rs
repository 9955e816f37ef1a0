//! All shaders are valid, and their structs have the layout of the structs in Rust. Needs no graphics device.

use super::ground::GroundUniform;
use super::panel::{OccluderUniform, PanelUniform};
use super::surface::Variant;
use super::{PANEL_SHADER, ground, pane};
use crate::picture::MOST_OCCLUDERS;
use std::mem::offset_of;
use wgpu::naga;

fn parse(parts: &[&str]) -> naga::Module {
    let text = super::pipeline::joined(parts);
    let module = naga::front::wgsl::parse_str(&text).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&text)));
    let (flags, capabilities) = (naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
    naga::valid::Validator::new(flags, capabilities)
        .validate(&module)
        .unwrap_or_else(|error| panic!("{}", error.emit_to_string(&text)));
    module
}

#[test]
fn shaders_are_valid() {
    parse(&[PANEL_SHADER, ground::SHADER]);
    for occluders in 0..=MOST_OCCLUDERS {
        for bits in 0..8 {
            let [tinted, edged, shadowed] = [1, 2, 4].map(|bit| bits & bit > 0);
            parse(&[&Variant { occluders, tinted, edged, shadowed }.parts()]);
        }
    }
    parse(&pane::PARTS);
}

/// Names and places of the fields of a struct, and its size.
fn layout(module: &naga::Module, name: &str) -> (Vec<(String, usize)>, usize) {
    let found = module.types.iter().find(|(_, item)| item.name.as_deref() == Some(name));
    let Some((_, naga::Type { inner: naga::TypeInner::Struct { members, span }, .. })) = found else {
        panic!("there is no struct {name}")
    };
    let fields = members.iter().map(|member| (member.name.clone().unwrap_or_default(), member.offset as usize));
    (fields.collect(), *span as usize)
}

macro_rules! same_layout {
    ($module:expr, $shader:literal, $rust:ty, $($field:ident)*) => {
        let ours = vec![$((stringify!($field).to_owned(), offset_of!($rust, $field))),*];
        assert_eq!(layout(&$module, $shader), (ours, size_of::<$rust>()));
    };
}

#[test]
fn structs_are_laid_out_alike_on_both_sides() {
    let module = parse(&[PANEL_SHADER, ground::SHADER]);
    same_layout!(module, "Panel", PanelUniform,
        clip eye near key edging up floor alarm contour_share alarm_line soft edge key_texel obstacle key_map middle key_layer line_scale bodies
        fade_distance fade_room fade_strength occluders);
    same_layout!(module, "Occluder", OccluderUniform, first second rotation);
    same_layout!(module, "Ground", GroundUniform,
        first second fade fade_at_words key sky background floor grid shadow viewport);
}

#[test]
fn the_scale_of_a_field_has_as_many_colours_on_both_sides() {
    let module = parse(&[&Variant { occluders: 0, tinted: true, edged: false, shadowed: true }.parts()]);
    let ramp = module.global_variables.iter().find(|(_, variable)| variable.name.as_deref() == Some("ramp"));
    let (_, ramp) = ramp.expect("the scale");
    let naga::TypeInner::Array { size: naga::ArraySize::Constant(count), stride, .. } = module.types[ramp.ty].inner
    else {
        panic!("the scale is an array")
    };
    assert_eq!([count.get() as usize, stride as usize], [crate::picture::SHADES, 16]);
}
