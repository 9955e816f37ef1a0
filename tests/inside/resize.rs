//! Scaling pictures.

use super::*;

#[test]
fn light_is_kept() {
    let plain = |size: [u32; 2]| Image { size, pixels: [200, 7, 90].repeat((size[0] * size[1]) as usize) };
    assert_eq!(resized(plain([40, 30]), [13, 11]), plain([13, 11]));
    // A chequerboard of black and white has half the light.
    let pixels = (0..64 * 64).flat_map(|at| [if (at + at / 64) % 2 == 0 { 255 } else { 0 }; 3]).collect();
    let small = resized(Image { size: [64, 64], pixels }, [8, 8]);
    let middle = small.pixels[3 * (4 * 8 + 4)];
    assert!((186..=190).contains(&middle), "{middle}");
}
