//! All that a project needs to test its scenes against goldens; `UPDATE_GOLDENS=1 cargo test` makes those that are missing.

use localshape::golden::Suite;

#[test]
fn scenes_are_as_they_were() {
    let mut goldens = Suite::new("tests/goldens");
    goldens.scene("scenes/wrecking-ball.toml");
    goldens.finish();
}
