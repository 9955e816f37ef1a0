//! Headers of arrays, types and whole numbers.

use super::*;

#[test]
fn heads_are_read_as_numpy_writes_them() {
    let text = "{'descr': '<f8', 'fortran_order': False, 'shape': (64, 3), }          \n";
    assert_eq!(value(text, "descr").and_then(quoted_text), Some("<f8"));
    assert!(value(text, "fortran_order").unwrap().starts_with("False"));
    assert_eq!(value(text, "shape").and_then(tuple), Some(vec![64, 3]));
    assert_eq!(tuple("(3L,)"), Some(vec![3]));
    assert_eq!(tuple("()"), Some(vec![]));
    assert_eq!((tuple("(3"), tuple("(-1, 2)"), tuple("(99999999999999999999,)")), (None, None, None));
    assert_eq!((value(text, "size"), quoted_text("<f8"), quoted_text("'<f8")), (None, None, None));
}

#[test]
fn types_are_known_or_refused_in_words() {
    assert_eq!(Dtype::of("<f8"), Ok((Dtype::Float64, false)));
    assert_eq!(Dtype::of("|u1"), Ok((Dtype::Unsigned(1), false)));
    assert_eq!(Dtype::of(">i4"), Ok((Dtype::Signed(4), true)));
    for (name, words) in [
        ("=f8", "of the type \"=f8\""),
        ("<f2", "of the type \"<f2\""),
        ("<c16", "of the type"),
        ("|O", "Python objects"),
        ("<U7", "of the type"),
        ("", "of the type"),
        ("é", "of the type"),
    ] {
        assert!(Dtype::of(name).unwrap_err().contains(words), "{name}");
    }
}

#[test]
fn whole_numbers_of_all_widths_keep_their_sign() {
    for bytes in [1, 2, 4, 8] {
        let mut raw = (-1i64).to_le_bytes()[..bytes].to_vec();
        raw.extend(&5i64.to_le_bytes()[..bytes]);
        let mut numbers = Values { bytes: raw, dtype: Dtype::Signed(bytes), by_columns: false, rows: 1, columns: 2 };
        assert_eq!((numbers.whole(0, 0), numbers.whole(0, 1)), (-1, 5));
        numbers.dtype = Dtype::Unsigned(bytes);
        let largest = if bytes == 8 { i64::MAX } else { (1 << (8 * bytes)) - 1 };
        assert_eq!((numbers.whole(0, 0), numbers.double(0, 1)), (largest, 5.0));
    }
}

/// Whole rows, whole columns, and parts of both are held together.
#[test]
fn columns_become_rows() {
    for [rows, nodes, axes] in [[1, 1, 3], [500, 1, 3], [500, 7, 2], [3, 200, 3], [40, 40, 3], [1, 400, 3], [7, 18, 1]]
    {
        let number = |row: u64, node: u64, axis: u64| ((row * nodes + node) * axes + axis) as u16;
        let all =
            |[a, b, c]: [u64; 3]| (0..a).flat_map(move |a| (0..b).flat_map(move |b| (0..c).map(move |c| [a, b, c])));
        let of_columns: Vec<u8> =
            all([axes, nodes, rows]).flat_map(|[axis, node, row]| number(row, node, axis).to_le_bytes()).collect();
        let mut from = tempfile::tempfile().unwrap();
        from.write_all(&of_columns).unwrap();
        let mut found = Vec::new();
        let mut copy = by_rows(&mut from, [rows, nodes, axes], 2).unwrap();
        copy.rewind().and_then(|()| copy.read_to_end(&mut found)).unwrap();
        let expected: Vec<u8> = (0..(rows * nodes * axes) as u16).flat_map(u16::to_le_bytes).collect();
        assert!(found == expected, "{rows} × {nodes} × {axes}");
    }
}
