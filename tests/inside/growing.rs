//! Files that another process continues.

use super::*;

#[test]
fn it_goes_on_after_its_own_bytes_only() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    let mut first = Growing::open(&path, None).unwrap();
    first.append(b"some bytes").unwrap();
    let before = first.sync().unwrap();
    first.append(b" and more").unwrap();
    let written = std::fs::read(&path).unwrap();
    for at in 0..8 * before.length as usize {
        let mut damaged = written.clone();
        damaged[at / 8] ^= 1 << (at % 8);
        std::fs::write(&path, &damaged).unwrap();
        assert_eq!(Growing::open(&path, Some(before)).unwrap_err().kind(), ErrorKind::InvalidData, "bit {at}");
        assert!(std::fs::read(&path).unwrap() == damaged, "nothing is lost");
    }
    std::fs::write(&path, &written[..9]).unwrap();
    assert!(Growing::open(&path, Some(before)).is_err(), "cut short");
    std::fs::write(&path, &written).unwrap();
    let mut second = Growing::open(&path, Some(before)).unwrap();
    second.append(b", and others").unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"some bytes, and others");
    let mut read = [0; 5];
    second.read_at(5, &mut read).unwrap();
    assert_eq!(&read, b"bytes");
    second.append(b".").unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"some bytes, and others.");
}
