//! The part of a frame that changed.

use super::*;

#[test]
fn the_changed_rectangle_is_the_smallest() {
    let all = |places: &'static [usize]| changed([5, 4], move |at| places.contains(&at));
    assert_eq!(all(&[]), [0, 0, 1, 1]);
    assert_eq!(all(&[0]), [0, 0, 1, 1]);
    assert_eq!(all(&[19]), [4, 3, 1, 1]);
    assert_eq!(all(&[7, 11]), [1, 1, 2, 2]);
    assert_eq!(all(&[4, 15]), [0, 0, 5, 4]);
    assert_eq!(all(&[6, 8]), [1, 1, 3, 1]);
}
