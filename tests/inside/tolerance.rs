//! The distance of pictures, and the tolerance.

use super::*;

const SIZE: [usize; 2] = [400, 300];

/// A dark square on light ground, after a change.
fn picture(change: impl FnOnce(&mut [[u8; 3]])) -> Pixels {
    let [width, height] = SIZE;
    let is_dark = |at: usize| (100..300).contains(&(at % width)) && (50..250).contains(&(at / width));
    let mut pixels: Vec<[u8; 3]> = (0..width * height).map(|at| [if is_dark(at) { 50 } else { 200 }; 3]).collect();
    change(&mut pixels);
    Pixels { size: SIZE.map(|side| side as u32), bytes: pixels.concat(), on_black: None, label: None }
}

fn distance(change: impl FnOnce(&mut [[u8; 3]])) -> Distance {
    Distance::new(&picture(|_| ()), &picture(change)).expect("of one size")
}

#[test]
fn limits_are_kept_to_the_pixel() {
    let ground = |count: usize, by: u8| distance(|pixels| pixels[..count].fill([200, 200 + by, 200]));
    let told = ground(1200, FAINT + 1);
    let mean = 3.0 * f64::from(FAINT + 1) / BLOCK as f64;
    let expected = Distance { unequal: 1200, differing: [1200, 0], allowed: [1200, 36], largest: FAINT + 1, mean };
    assert_eq!(told, expected);
    assert!(told.is_allowed() && !ground(1201, FAINT + 1).is_allowed());
    assert!(ground(10_000, 1).is_allowed() && !ground(10_000, FAINT).is_allowed());
    assert!(ground(36, STRONG + 1).is_allowed());
    assert!(!ground(37, STRONG + 1).is_allowed() && ground(37, STRONG).is_allowed());
    let told = ground(37, 50).to_string();
    assert_eq!(
        told,
        "37 pixels differ by more than 16 of 255 (36 may), 37 by more than 2 (1200 may), the mean of 16×16 pixels by 3.1 (1.5 may)"
    );
}

/// Drivers may disagree about some pixels along a border, but not about all of them, about two rows or about an object.
#[test]
fn borders_may_wander_by_a_pixel_here_and_there() {
    let [width, _] = SIZE;
    let moved = |by: usize, every: usize| {
        distance(|pixels| {
            for row in pixels.chunks_exact_mut(width).skip(50).take(200).step_by(every) {
                row.rotate_right(by);
            }
        })
    };
    let here_and_there = moved(1, 8);
    assert_eq!((here_and_there.unequal, here_and_there.differing), (50, [0, 0]));
    assert!(here_and_there.is_allowed() && !moved(1, 4).is_allowed());
    // The whole square moves by a pixel. Each pixel is near one of its colour.
    assert_eq!((moved(1, 1).is_allowed(), moved(1, 1).differing), (false, [0, 0]));
    assert!(!moved(2, 1).is_allowed() && moved(2, 1).differing[1] >= 400);
    let line = distance(|pixels| pixels[20 * width..20 * width + 40].fill([120; 3]));
    assert_eq!((line.is_allowed(), line.differing), (false, [40, 40]));
    let single = Pixels { size: [1, 1], bytes: vec![7; 3], on_black: None, label: None };
    let other = Pixels { bytes: vec![9; 3], ..single.clone() };
    assert_eq!(Distance::new(&single, &other).expect("of one size").largest, 2);
    assert_eq!(Distance::new(&single, &picture(|_| ())), None);
}

/// A hatch of a part of the picture at nine tenths of its strength: few pixels differ, and each only a little.
#[test]
fn lines_may_not_fade() {
    let hatched = |by: u8| {
        picture(|pixels| {
            for (at, pixel) in pixels.iter_mut().enumerate() {
                let [x, y] = [at % SIZE[0], at / SIZE[0]];
                if x < 64 && y < 48 && x % 4 == 0 {
                    *pixel = [200 - by; 3];
                }
            }
        })
    };
    let faded = Distance::new(&hatched(150), &hatched(135)).expect("of one size");
    assert_eq!((faded.is_allowed(), faded.differing), (false, [768, 0]));
    assert!(faded.mean > 3.0, "{faded}");
}
