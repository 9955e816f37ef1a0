//! Palettes of animations.

use super::*;

fn palette(image: &Image) -> Palette {
    let mut counts = Counts::new();
    counts.add(&Counts::of(image));
    counts.palette()
}

#[test]
fn every_rank_is_there_once() {
    let mut ranks: Vec<u8> = ORDER.iter().flatten().copied().collect();
    ranks.sort_unstable();
    assert_eq!(ranks, (0..64).collect::<Vec<u8>>());
    assert!(ORDER[0][0] == 0 && ORDER[0][1] >= 32, "neighbours are far apart");
}

#[test]
fn few_colours_stay_as_they_are() {
    let image = Image { size: [3, 1], pixels: vec![252, 252, 250, 20, 30, 40, 252, 252, 250] };
    let palette = palette(&image);
    let numbers = palette.numbers(&image);
    let back: Vec<u8> = numbers.iter().flat_map(|&number| palette.colours[usize::from(number)]).collect();
    assert_eq!(back, image.pixels);
}

#[test]
fn a_course_of_many_colours_is_met_on_the_mean() {
    let [width, height] = [256, 64];
    let pixel = |at: usize| [(at % width) as u8, (at / width * 4) as u8, 255 - (at % width) as u8 / 2];
    let image = Image { size: [width as u32, height as u32], pixels: (0..width * height).flat_map(pixel).collect() };
    let palette = palette(&image);
    assert!(palette.colours.len() <= MOST);
    let numbers = palette.numbers(&image);
    let mut sum = 0.0;
    for (pixel, &number) in image.pixels.chunks_exact(3).zip(&numbers) {
        let [one, other] = [[pixel[0], pixel[1], pixel[2]], palette.colours[usize::from(number)]].map(oklab);
        sum += one.distance(other);
    }
    let mean = sum / numbers.len() as f64;
    assert!(mean < 0.03, "{mean}");
}
