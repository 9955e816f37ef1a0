//! Lines, polygons and rectangles of the picture.

use glam::DVec2;

/// The part of a straight line inside a rectangle, which is given by its four sides, as a range of multiples of a
/// direction from a point of the line (Liang and Barsky).
pub(crate) fn clipped(
    start: DVec2,
    along: DVec2,
    [left, top, right, bottom]: [f64; 4],
    [mut from, mut to]: [f64; 2],
) -> Option<[f64; 2]> {
    for (at, step, low, high) in [(start.x, along.x, left, right), (start.y, along.y, top, bottom)] {
        if step.abs() < 1e-12 {
            // The line is parallel to these two sides, outside or between them.
            if at < low || at > high {
                return None;
            }
        } else {
            let [one, other] = [low, high].map(|side| (side - at) / step);
            (from, to) = (from.max(one.min(other)), to.min(one.max(other)));
        }
    }
    (to > from).then_some([from, to])
}

/// The part of the straight line between two points inside a rectangle, which is given by its four sides.
pub(super) fn cut([from, to]: [DVec2; 2], sides: [f64; 4]) -> Option<[DVec2; 2]> {
    Some(clipped(from, to - from, sides, [0.0, 1.0])?.map(|share| from.lerp(to, share)))
}

/// The pieces of a line through points inside a rectangle, which is given by its four sides.
pub(super) fn pieces(points: &[[f64; 2]], sides: [f64; 4]) -> Vec<Vec<[f64; 2]>> {
    // A point is a line without a length.
    let points = if let &[only] = points { &[only; 2] } else { points };
    let mut pieces: Vec<Vec<_>> = Vec::new();
    for ends in points.windows(2).filter_map(|two| cut([two[0].into(), two[1].into()], sides)) {
        let [from, to] = ends.map(|end| end.to_array());
        match pieces.last_mut() {
            Some(piece) if piece.last() == Some(&from) => piece.push(to),
            _ => pieces.push(vec![from, to]),
        }
    }
    pieces
}

/// The left, top, right and bottom side of a rectangle of a width and a height (px).
pub(crate) fn sides([left, top, width, height]: [f64; 4]) -> [f64; 4] {
    [left, top, left + width, top + height]
}

/// The whole line, as a range for [`clipped`].
pub(super) const WHOLE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// The sides of a polygon: each corner with the next.
pub(crate) fn around<T>(corners: &[T]) -> impl Iterator<Item = (&T, &T)> {
    corners.iter().zip(corners.iter().cycle().skip(1))
}

/// Whether a polygon winds around a point.
pub(super) fn is_inside(polygon: &[DVec2], point: DVec2) -> bool {
    let crossed = around(polygon).filter(|(a, b)| {
        (a.y > point.y) != (b.y > point.y) && point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y)
    });
    crossed.count() % 2 == 1
}

/// The distance of a point from the straight line between two others.
pub(super) fn from_side(point: DVec2, a: DVec2, b: DVec2) -> f64 {
    let share = (point - a).dot(b - a) / (b - a).length_squared().max(f64::MIN_POSITIVE);
    point.distance(a.lerp(b, share.clamp(0.0, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_to_their_rectangle() {
        let (rectangle, slant) = (sides([10.0, 20.0, 40.0, 30.0]), DVec2::ONE.normalize());
        let clip = |start, along| clipped(start, along, rectangle, WHOLE);
        assert_eq!(clip(DVec2::new(0.0, 30.0), DVec2::X), Some([10.0, 50.0]));
        assert_eq!(clip(DVec2::new(0.0, 10.0), DVec2::X), None);
        assert_eq!(clip(DVec2::new(30.0, 0.0), -DVec2::Y), Some([-50.0, -20.0]));
        let [from, to] = clip(DVec2::new(10.0, 20.0), slant).unwrap();
        assert!(from.abs() < 1e-12 && (to - 30.0 * 2.0_f64.sqrt()).abs() < 1e-12, "{from} {to}");
        assert_eq!(clip(DVec2::new(60.0, 0.0), slant), None);
    }

    #[test]
    fn lines_leave_at_the_border_and_come_back() {
        let room = [f64::NEG_INFINITY, 0.0, f64::INFINITY, 10.0];
        let points = [[0.0, 5.0], [1.0, -5.0], [2.0, -55.0], [3.0, 5.0], [4.0, 25.0], [5.0, -15.0]];
        let expected: [&[[f64; 2]]; 3] = [
            &[[0.0, 5.0], [0.5, 0.0]],
            &[[2.0 + 55.0 / 60.0, 0.0], [3.0, 5.0], [3.25, 10.0]],
            &[[4.375, 10.0], [4.625, 0.0]],
        ];
        let off = |(one, other): (&[f64; 2], &[f64; 2])| DVec2::from(*one).distance((*other).into());
        let found = pieces(&points, room);
        assert!(found.iter().zip(expected).all(|(one, other)| one.len() == other.len()), "{found:?}");
        assert!(found.iter().flatten().zip(expected.concat().iter()).all(|two| off(two) < 1e-12), "{found:?}");
        assert_eq!(pieces(&points, sides([0.0, -100.0, 5.0, 200.0])), [points]);
        assert_eq!(pieces(&points[..1], room), [[points[0]; 2]]);
        assert!(pieces(&[], room).is_empty() && pieces(&[[0.0, 1e300], [1.0, 1e300]], room).is_empty());
    }

    #[test]
    fn points_are_told_inside_from_outside() {
        let square = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        assert!(is_inside(&square, DVec2::splat(0.5)));
        assert!(!is_inside(&square, DVec2::new(1.5, 0.5)) && !is_inside(&square, DVec2::new(-0.5, 0.5)));
    }
}
