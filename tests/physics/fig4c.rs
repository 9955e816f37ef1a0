//! Fig. 4(c): a plate presses 3×3×3 cubes ten times. Uses the shipped scene.

use super::support::{after, shipped};

#[test]
fn springs_fold_up_at_the_first_press_and_the_shape_model_comes_back_from_all_ten() {
    let scene = shipped("fig4c", &[]);
    for (seconds, turned_over) in [(1.0, 0), (1.4, 9), (6.5, 9)] {
        let springs = after(&scene, "Mass-spring", seconds).diagnostics;
        assert_eq!(springs.turned_over, turned_over, "{seconds} s");
        let volume = if turned_over == 0 { 1.0 } else { 0.333 };
        assert!((springs.volume_ratio - volume).abs() < 0.005, "{seconds} s: {}", springs.volume_ratio);
    }
    // At the deepest press the body of the shape model has less than half of its volume and nothing turned over.
    for press in 0..10 {
        let pressed = after(&scene, "Local shape", 1.2 + 0.5 * f64::from(press)).diagnostics;
        assert!(pressed.turned_over == 0 && pressed.volume_ratio < 0.5, "press {press}: {pressed:?}");
    }
    // At rest again: volume .998, error .002 sides.
    let shape = after(&scene, "Local shape", 6.5).diagnostics;
    assert!((shape.volume_ratio - 0.998).abs() < 1e-3, "{}", shape.volume_ratio);
    assert!((shape.shape_error / 0.1 - 0.002).abs() < 5e-4, "{}", shape.shape_error);
}
