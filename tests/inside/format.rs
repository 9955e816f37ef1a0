//! The formats of animations.

use super::*;

#[test]
fn endings_choose() {
    assert_eq!(Format::of(Path::new("a/b.GIF")), Ok(Format::Gif));
    let unknown = Format::of(Path::new("film.avi")).unwrap_err();
    for ending in [".gif", ".apng", ".mp4", ".webm", "the ending .avi"] {
        assert!(unknown.contains(ending), "{unknown}");
    }
    assert!(Format::of(Path::new("film")).unwrap_err().contains("no ending"));
}
