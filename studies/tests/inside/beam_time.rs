//! Error against time, with few cells and short turns.

use super::*;
use crate::reading::documented;

#[test]
fn every_model_has_an_error_and_a_time() {
    let study = Time { across: vec![1], fine: [1, 2], rounds: 1, turn: 50 };
    let results = measure(&study, &|_| true).expect("nobody stops it");
    assert_eq!(results.timed.len(), Time::models().count());
    // The elastica ends at 0.4935, and shear adds a hundredth of it.
    assert!((results.reference - 0.4994).abs() < 0.02, "{}", results.reference);
    let springs = results.timed.iter().find(|one| one.model.name == "mass-spring").expect("springs");
    assert!((springs.across_length - 0.275).abs() < 0.01, "springs of the modulus of the beam: {springs:?}");
    for one in &results.timed {
        assert!(one.step > 0.0 && one.time.median > 0.0 && one.error.is_finite(), "{one:?}");
        assert!((0.0..1.0).contains(&one.across_length), "{one:?}");
    }
    // In small steps XPBD rests where the shape model does; what is left is in proportion to the square of the step.
    for (stepped, forced) in
        results.timed.iter().filter(|one| one.model.kind == "xpbd").zip(["hexahedra", "tetrahedra"])
    {
        let is_shape = |one: &&Timed| one.model.name == "shape-based" && one.model.elements.name(false) == forced;
        let shape = results.timed.iter().find(is_shape).expect("the shape model");
        let last = *stepped.softer.last().expect("a step");
        assert!((stepped.across_length / shape.across_length - 1.0 - last).abs() < 1e-4 && last < CLOSE, "{stepped:?}");
        for halved in stepped.softer.windows(2) {
            assert!((3.0..5.0).contains(&(halved[0] / halved[1])), "{stepped:?}");
        }
    }
    assert_eq!(results.table().heads, documented("beam-time.csv"));
    assert!(results.text().contains("| `mass-spring` | hexahedra | 1 | 8 |"));
}
