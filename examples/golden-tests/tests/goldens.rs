//! A complete test of a project's scenes against goldens. `UPDATE_GOLDENS=1 cargo test` makes missing goldens.

use localshape::golden::Suite;

#[test]
fn scenes_are_as_they_were() {
    let mut goldens = Suite::new("tests/goldens");
    goldens.scene("scenes/wrecking-ball.toml");
    goldens.finish();
}
