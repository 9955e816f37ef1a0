//! Lines of progress.

use super::*;

/// Lines appear even if nothing is done for a long time.
#[test]
fn lines_come_without_a_terminal() {
    let mut lines = Vec::new();
    let found = told("one", 4, Duration::from_millis(1), &mut lines, |watch| {
        watch(1);
        thread::sleep(Duration::from_millis(100));
        7
    });
    let lines = String::from_utf8(lines).unwrap();
    assert_eq!(found, 7);
    assert!(lines.starts_with("one: ") && lines.lines().count() > 1, "{lines}");
    assert!(lines.lines().last().unwrap().starts_with("one: 25 % after "), "{lines}");
}
