//! The names of frames.

/// The file name of frame `index`: `frame_00000.png`.
pub(crate) fn frame_file_name(index: u64) -> String {
    format!("frame_{index:05}.png")
}

/// The pattern of all frame names, for `run.json`.
pub(crate) const FRAME_FILES: &str = "frame_*.png";

/// The frame number from a file name.
pub(super) fn frame_number(name: &str) -> Option<u64> {
    let index = name.strip_prefix("frame_")?.strip_suffix(".png")?.parse().ok()?;
    (frame_file_name(index) == name).then_some(index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_names() {
        assert_eq!(frame_file_name(7), "frame_00007.png");
        assert_eq!(frame_file_name(123_456), "frame_123456.png");
        for name in ["frame_00000.png", "frame_99999.png", "frame_100000.png"] {
            assert!(frame_number(name).is_some(), "{name}");
        }
        for name in ["frame_0.png", "frame_000000.png", "frame_.png", "frame_+0001.png", "frame_00000.jpg", "a.png"] {
            assert_eq!(frame_number(name), None, "{name}");
        }
    }
}
