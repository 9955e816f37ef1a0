//! Notes of interrupted studies.

use super::*;

fn folder(path: &Path, command: &str) -> Result<Folder, Failure> {
    Folder::new(path.to_owned(), "study", &format!("localshape-study {command}"), false)
}

#[test]
fn findings_are_found_again() {
    let place = tempfile::tempdir().expect("a folder");
    let notes = |digest: &str| folder(place.path(), "study 1").expect("it is ours").notes(digest);
    let made = notes("ab");
    assert!(!made.are_kept() && made.known("a 0.2").is_none());
    for (key, found) in [("a 0.2", "9"), ("a 0.4", "9"), ("b 0.8", "diverged")] {
        made.add(key, found);
    }
    // The program was killed during a write.
    let path = place.path().join("study.unfinished");
    let text = fs::read_to_string(&path).expect("findings");
    fs::write(&path, &text[..text.len() - 3]).expect("to cut it");
    let again = notes("ab");
    assert_eq!(["a 0.2", "a 0.4", "b 0.8"].map(|key| again.known(key)), [Some("9"), Some("9"), None]);
    again.add("b 0.8", "diverged");
    let all = notes("ab");
    assert_eq!(["a 0.2", "a 0.4", "b 0.8"].map(|key| all.known(key)), [Some("9"), Some("9"), Some("diverged")]);
    assert!(folder(place.path(), "study 2").is_err(), "of another command");
    assert!(notes("cd").known("a 0.2").is_none(), "of an edited scene");
    // The reader takes any bytes.
    let whole = fs::read(&path).expect("findings");
    for at in 0..whole.len() {
        fs::write(&path, &whole[..at]).expect("to cut it");
        Notes::new(path.clone(), all.head.clone());
        let damaged: Vec<_> = whole.iter().enumerate().map(|(i, b)| if i == at { b ^ 0x95 } else { *b }).collect();
        fs::write(&path, damaged).expect("to damage it");
        Notes::new(path.clone(), all.head.clone());
    }
    all.remove();
    assert!(!path.exists());
}
