//! The paper's numbers as text.

use super::as_printed;

#[test]
fn the_papers_figures_have_three_digits_or_six_decimals() {
    for (number, text) in [
        (30.875_97, "30.9"),
        (4.498_62, "4.50"),
        (1.297_613, "1.30"),
        (9.999, "10.0"),
        (0.320_008, "0.320"),
        (0.030_974, "0.0310"),
        (0.000_493, "0.000493"),
        (0.000_017, "0.000017"),
        (0.000_001, "0.000001"),
    ] {
        assert_eq!(as_printed(number), text);
    }
}
