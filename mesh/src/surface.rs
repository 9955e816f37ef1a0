//! Surfaces of triangles: what is wrong with them, and mending it.

use super::Group;
use super::edges::{EdgeUse, Sets, net};
use super::inside::Columns;
use super::read::Used;
use super::weld::joined;
use glam::DVec3;
use localshape_sim::geometry::bounds;

/// A surface of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Position of each point, in the unit of the file.
    pub points: Vec<DVec3>,
    /// The points of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Sets of points with a name.
    pub groups: Vec<Group>,
    /// What is left out of the file or not read, each as the predicate of a sentence about it.
    pub notes: Vec<String>,
}

/// What is wrong with a surface, by number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flaws {
    /// Points at the same place as another but for round-off, which were welded.
    pub welded: usize,
    /// Those of them that are not at exactly the same place.
    pub near: usize,
    /// Triangles without area, or with a corner that has no place, which were left out. Those without area that keep a
    /// surface closed stay.
    pub degenerate: usize,
    /// Triangles with the points of another, which were left out.
    pub doubled: usize,
    /// Triangles that were turned over, so that all of a piece look out.
    pub turned: usize,
    /// Edges of one triangle only.
    pub boundary: usize,
    /// Edges of three triangles or more.
    pub non_manifold: usize,
    /// Edges whose two triangles cannot both look out.
    pub inconsistent: usize,
    /// Separate pieces.
    pub pieces: usize,
}

/// The size and form of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measures {
    /// The volume inside, by the divergence theorem. It means little for a surface that is not closed.
    pub volume: f64,
    /// The sum of the areas of triangles.
    pub area: f64,
    /// Whether the surface has an inside and an outside: each edge is passed as often in one direction as in the other.
    pub closed: bool,
    /// Euler's characteristic, points − edges + triangles: 2 for each ball, and 2 less for each hole through it.
    pub euler: i64,
    /// The lowest coordinates.
    pub low: DVec3,
    /// The highest coordinates.
    pub high: DVec3,
}

impl Surface {
    pub(crate) fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|point| self.points[point as usize])
    }

    /// The size and form of the surface. Points that belong to no triangle do not count.
    pub fn measures(&self) -> Measures {
        let mut used = vec![false; self.points.len()];
        for &point in self.triangles.as_flattened() {
            used[point as usize] = true;
        }
        let all = || self.points.iter().zip(&used).filter(|(_, used)| **used).map(|(&point, _)| point);
        let (low, high) = match all().next() {
            Some(first) => all().fold((first, first), |(low, high), point| (low.min(point), high.max(point))),
            None => (DVec3::ZERO, DVec3::ZERO),
        };
        let (mut volume, mut area) = (0.0, 0.0);
        for &triangle in &self.triangles {
            let [a, b, c] = self.corners(triangle).map(|corner| corner - low);
            volume += a.dot(b.cross(c)) / 6.0;
            area += 0.5 * (b - a).cross(c - a).length();
        }
        let uses = EdgeUse::all(&self.triangles);
        let (mut edges, mut closed) = (0, !self.triangles.is_empty());
        for edge in uses.chunk_by(EdgeUse::same) {
            edges += 1;
            closed &= net(edge) == 0;
        }
        Measures { volume, area, closed, euler: all().count() as i64 - edges + self.triangles.len() as i64, low, high }
    }

    /// The surface without its flaws, as far as that is safe, and what they were.
    ///
    /// Points with the same coordinates to 10⁻¹² of the extent become one. Triangles without area and doubled ones are left out; of two with
    /// opposite sides both stay, a wall between two pieces, unless most of the surface is of that kind. Each piece is
    /// turned so that neighbours agree, which the fewest triangles determine, and that its volume is positive. A piece
    /// inside another is turned with that one: if it looked the other way in the file, it is a cavity.
    pub fn mended(&self) -> (Self, Flaws) {
        let mut flaws = Flaws::default();
        let mut surface = self.welded(&mut flaws);
        surface.drop_doubled(&mut flaws);
        surface.drop_flat(&mut flaws);
        surface.orient(&mut flaws);
        // Points of triangles that were left out belong to none.
        (surface.compact(), flaws)
    }

    /// Divides triangles until no edge is longer, unless there would be many times more than `most`.
    pub(crate) fn refine(&mut self, longest: f64, most: usize) {
        let parts = |&of: &[u32; 3]| {
            let [a, b, c] = self.corners(of);
            let area = (b - a).cross(c - a).length();
            1.0 + (4.0 * area / longest + a.distance(b) + b.distance(c) + c.distance(a)) / longest
        };
        let needed: f64 = self.triangles.iter().map(parts).sum();
        // Not true for a length of zero or one that is no number, either.
        let fits = needed <= 16.0 * most as f64 + 8.0 * self.triangles.len() as f64;
        let is_long = |&of: &[u32; 3]| {
            let [a, b, c] = self.corners(of);
            [a.distance(b), b.distance(c), c.distance(a)].into_iter().any(|length| length > longest)
        };
        if fits && self.triangles.iter().any(is_long) {
            while self.halve(longest) {}
        }
    }

    /// Divides longer edges in halves, and returns whether there were some.
    fn halve(&mut self, longest: f64) -> bool {
        let mut middles = vec![[None; 3]; self.triangles.len()];
        // The groups of each point, to which the middle between two of their points belongs, too.
        let mut groups_of = vec![Vec::new(); self.points.len()];
        for (group, at) in self.groups.iter().zip(0u32..) {
            group.points.iter().for_each(|&point| groups_of[point as usize].push(at));
        }
        for edge in EdgeUse::all(&self.triangles).chunk_by(EdgeUse::same) {
            let [low, high] = [edge[0].low, edge[0].high].map(|point| self.points[point as usize]);
            let middle = low.midpoint(high);
            // An edge as short as round-off has no middle.
            if low.distance(high) > longest && middle != low && middle != high {
                for one in edge {
                    let from = if one.forward { one.low } else { one.high };
                    let place = self.triangles[one.triangle as usize].iter().position(|&corner| corner == from);
                    middles[one.triangle as usize][place.unwrap_or(0)] = Some(self.points.len() as u32);
                }
                // Of two rising lists, the shorter one is gone through: a point in the middle of a fan may have very many groups.
                let [mut fewer, mut more] = [edge[0].low, edge[0].high].map(|point| &groups_of[point as usize]);
                if fewer.len() > more.len() {
                    std::mem::swap(&mut fewer, &mut more);
                }
                for &group in fewer.iter().filter(|group| more.binary_search(group).is_ok()) {
                    self.groups[group as usize].points.push(self.points.len() as u32);
                }
                self.points.push(middle);
            }
        }
        let mut triangles = Vec::with_capacity(2 * self.triangles.len());
        for (&[a, b, c], middles) in self.triangles.iter().zip(&middles) {
            match *middles {
                [None, None, None] => triangles.push([a, b, c]),
                [Some(ab), Some(bc), Some(ca)] => {
                    triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
                }
                [Some(ab), None, None] => triangles.extend([[a, ab, c], [ab, b, c]]),
                [None, Some(bc), None] => triangles.extend([[b, bc, a], [bc, c, a]]),
                [None, None, Some(ca)] => triangles.extend([[c, ca, b], [ca, a, b]]),
                [Some(ab), Some(bc), None] => self.cut_off([a, b, c], [ab, bc], &mut triangles),
                [None, Some(bc), Some(ca)] => self.cut_off([b, c, a], [bc, ca], &mut triangles),
                [Some(ab), None, Some(ca)] => self.cut_off([c, a, b], [ca, ab], &mut triangles),
            }
        }
        let divided = triangles.len() > self.triangles.len();
        self.triangles = triangles;
        divided
    }

    /// The parts of a triangle whose first two edges have middles. The rest beyond them is divided by its shorter diagonal.
    fn cut_off(&self, [a, b, c]: [u32; 3], [ab, bc]: [u32; 2], parts: &mut Vec<[u32; 3]>) {
        let length = |from: u32, to: u32| self.points[from as usize].distance_squared(self.points[to as usize]);
        parts.push([ab, b, bc]);
        if length(a, bc) <= length(ab, c) {
            parts.extend([[a, ab, bc], [a, bc, c]]);
        } else {
            parts.extend([[a, ab, c], [ab, bc, c]]);
        }
    }

    /// The surface with its points welded, without triangles of fewer than three points.
    fn welded(&self, flaws: &mut Flaws) -> Self {
        /// Programs write zeros as sines of half turns, parts of the extent as small as this.
        const ROUND_OFF: f64 = 1e-12;
        let is_place = |&point: &u32| self.points.get(point as usize).is_some_and(|point| point.is_finite());
        let mut used: Vec<u32> = self.triangles.as_flattened().iter().copied().filter(is_place).collect();
        used.sort_unstable();
        used.dedup();
        let (low, high) = bounds(&used.iter().map(|&point| self.points[point as usize]).collect::<Vec<_>>());
        let first = joined(&self.points, used.clone(), ROUND_OFF * (high - low).max_element());
        for &point in used.iter().filter(|&&point| first[point as usize] != point) {
            flaws.welded += 1;
            flaws.near += usize::from(self.points[first[point as usize] as usize] != self.points[point as usize]);
        }
        let mut triangles = Vec::with_capacity(self.triangles.len());
        for triangle in &self.triangles {
            if triangle.iter().all(is_place) {
                let [a, b, c] = triangle.map(|point| first[point as usize]);
                if a != b && b != c && c != a {
                    triangles.push([a, b, c]);
                }
            }
        }
        flaws.degenerate = self.triangles.len() - triangles.len();
        let groups = self.groups.iter().map(|group| group.renamed(&first)).collect();
        Self { points: self.points.clone(), triangles, groups, notes: self.notes.clone() }.compact()
    }

    /// The surface with those points only that belong to a triangle, in the same order.
    pub(crate) fn compact(mut self) -> Self {
        let used = Used::new(self.points.len(), self.triangles.as_flattened());
        if used.are_all() {
            self.groups.retain(|group| !group.points.is_empty());
            return self;
        }
        self.triangles.as_flattened_mut().iter_mut().for_each(|corner| *corner = used.new[*corner as usize]);
        Self { points: used.of(&self.points), groups: used.groups(&self.groups), ..self }
    }

    fn drop_doubled(&mut self, flaws: &mut Flaws) {
        // The points in rising order, and whether that is the triangle's direction.
        let key = |triangle: usize| {
            let of = self.triangles[triangle];
            let lowest = (0..3).min_by_key(|&at| of[at]).unwrap_or(0);
            let [a, b, c] = [0, 1, 2].map(|at| of[(lowest + at) % 3]);
            ([a, b.min(c), b.max(c)], b < c)
        };
        let mut order: Vec<usize> = (0..self.triangles.len()).collect();
        order.sort_by_cached_key(|&triangle| (key(triangle), triangle));
        let same = |&a: &usize, &b: &usize| key(a).0 == key(b).0;
        let two_sided = order.chunk_by(same).filter(|same| key(same[0]).1 != key(same[same.len() - 1]).1).count();
        let all = order.chunk_by(same).count();
        let mut keep = vec![false; self.triangles.len()];
        for same in order.chunk_by(same) {
            if 2 * two_sided > all {
                keep[same.iter().copied().min().unwrap_or(0)] = true;
            } else {
                same.chunk_by(|&a, &b| key(a) == key(b)).for_each(|one_sided| keep[one_sided[0]] = true);
            }
        }
        flaws.doubled = self.keep(&keep);
    }

    /// Drops triangles whose corners are on a line and that have an edge of their own: they close nothing.
    fn drop_flat(&mut self, flaws: &mut Flaws) {
        let mut keep = vec![true; self.triangles.len()];
        let is_flat = |triangle: u32| {
            let [a, b, c] = self.corners(self.triangles[triangle as usize]);
            (b - a).cross(c - a) == DVec3::ZERO
        };
        for edge in EdgeUse::all(&self.triangles).chunk_by(EdgeUse::same) {
            if edge.len() == 1 && is_flat(edge[0].triangle) {
                keep[edge[0].triangle as usize] = false;
            }
        }
        flaws.degenerate += self.keep(&keep);
    }

    /// Keeps some triangles, and returns the number of others.
    fn keep(&mut self, keep: &[bool]) -> usize {
        let before = self.triangles.len();
        let mut keep = keep.iter();
        self.triangles.retain(|_| keep.next().is_some_and(|keep| *keep));
        before - self.triangles.len()
    }

    /// Turns triangles over, and counts edges and pieces.
    fn orient(&mut self, flaws: &mut Flaws) {
        let uses = EdgeUse::all(&self.triangles);
        let count = self.triangles.len();
        // The neighbour at each edge of two triangles, and whether the two pass it in the same direction.
        let mut beside = vec![[None::<(u32, bool)>; 3]; count];
        let mut meet = |one: u32, other: u32, differs| {
            let free = beside[one as usize].iter_mut().find(|beside| beside.is_none());
            free.into_iter().for_each(|free| *free = Some((other, differs)));
        };
        let mut pieces = Sets::new(count);
        for edge in uses.chunk_by(EdgeUse::same) {
            match edge {
                [_] => flaws.boundary += 1,
                [a, b] => {
                    meet(a.triangle, b.triangle, a.forward == b.forward);
                    meet(b.triangle, a.triangle, a.forward == b.forward);
                }
                _ => flaws.non_manifold += 1,
            }
            edge.iter().for_each(|other| pieces.join(edge[0].triangle, other.triangle));
        }
        let mut turned: Vec<Option<bool>> = vec![None; count];
        for first in 0..count {
            if turned[first].is_some() {
                continue;
            }
            turned[first] = Some(false);
            let mut patch = vec![first as u32];
            let mut next = 0;
            while let Some(&triangle) = patch.get(next) {
                next += 1;
                for &(other, differs) in beside[triangle as usize].iter().flatten() {
                    if turned[other as usize].is_none() {
                        turned[other as usize] = Some(turned[triangle as usize] == Some(!differs));
                        patch.push(other);
                    }
                }
            }
            let minority = patch.iter().filter(|&&triangle| turned[triangle as usize] == Some(true)).count();
            if 2 * minority > patch.len() {
                patch.iter().for_each(|&triangle| {
                    turned[triangle as usize] = turned[triangle as usize].map(|turned| !turned);
                });
            }
        }
        let mut turned: Vec<bool> = turned.into_iter().map(|turned| turned == Some(true)).collect();
        flaws.inconsistent = uses
            .chunk_by(EdgeUse::same)
            .filter(|edge| match edge {
                [a, b] => (a.forward == b.forward) == (turned[a.triangle as usize] == turned[b.triangle as usize]),
                _ => false,
            })
            .count();
        let (piece_of, number) = pieces.numbered();
        flaws.pieces = number;
        let before = self.triangles.clone();
        self.turn(&turned);
        let outwards = self.outwards(&piece_of, number);
        turned.iter_mut().zip(&piece_of).for_each(|(turned, &piece)| *turned ^= !outwards[piece as usize]);
        self.triangles = before;
        self.turn(&turned);
        flaws.turned = turned.iter().filter(|turned| **turned).count();
    }

    fn turn(&mut self, turned: &[bool]) {
        self.triangles.iter_mut().zip(turned).filter(|(_, turned)| **turned).for_each(|(of, _)| of.swap(1, 2));
    }

    /// What each of so many pieces encloses, by the piece of each triangle.
    pub(crate) fn enclosed(&self, piece_of: &[u32], count: usize) -> Vec<Enclosed> {
        let uses = EdgeUse::all(&self.triangles);
        let mut middles = vec![(DVec3::ZERO, 0u32); count];
        for edge in uses.chunk_by(EdgeUse::same) {
            if net(edge) != 0 {
                let (sum, number) = &mut middles[piece_of[edge[0].triangle as usize] as usize];
                *sum += self.points[edge[0].low as usize] + self.points[edge[0].high as usize];
                *number += 2;
            }
        }
        let mut pieces = vec![Enclosed::default(); count];
        for (&triangle, &piece) in self.triangles.iter().zip(piece_of).rev() {
            pieces[piece as usize].first = self.corners(triangle)[0];
        }
        for (&triangle, &piece) in self.triangles.iter().zip(piece_of) {
            let ((sum, number), piece) = (middles[piece as usize], &mut pieces[piece as usize]);
            piece.is_open = number > 0;
            let origin = if piece.is_open { sum / f64::from(number) } else { piece.first };
            let [a, b, c] = self.corners(triangle).map(|corner| corner - origin);
            piece.volume += a.dot(b.cross(c)) / 6.0;
            piece.area += 0.5 * (b - a).cross(c - a).length();
        }
        pieces
    }

    /// Whether each piece can stay as it is.
    fn outwards(&self, piece_of: &[u32], count: usize) -> Vec<bool> {
        let pieces = self.enclosed(piece_of, count);
        // A sheet stays as it is.
        let is_out = |piece: usize| pieces[piece].is_solid() || pieces[piece].is_sheet();
        if count < 2 {
            return (0..count).map(is_out).collect();
        }
        let mut outermost: Vec<usize> = (0..count).collect();
        self.nested(piece_of, &pieces, |piece, around| {
            let others = around.iter().map(|&(other, _)| other);
            let found =
                others.reduce(|best, other| if pieces[other].size() > pieces[best].size() { other } else { best });
            outermost[piece] = found.unwrap_or(piece);
        });
        outermost.into_iter().map(is_out).collect()
    }

    /// Calls `visit` with each piece and the closed ones that go around its first point, with their winding numbers.
    pub(crate) fn nested(&self, piece_of: &[u32], pieces: &[Enclosed], mut visit: impl FnMut(usize, &[(usize, i32)])) {
        let columns = Columns::new(&self.points, &self.triangles);
        for (piece, Enclosed { first: from, .. }) in pieces.iter().enumerate() {
            let mut crossed = Vec::new();
            columns.crossings(from.y, from.z, |crossing| {
                let other = piece_of[crossing.triangle as usize] as usize;
                if other != piece && !pieces[other].is_open && crossing.is_after(from.x) {
                    crossed.push((other, crossing.sign));
                }
            });
            crossed.sort_unstable();
            let of_piece = |all: &[(usize, i32)]| (all[0].0, all.iter().map(|(_, sign)| sign).sum());
            let mut around: Vec<_> = crossed.chunk_by(|one, other| one.0 == other.0).map(of_piece).collect();
            around.retain(|&(_, winding)| winding != 0);
            visit(piece, &around);
        }
    }
}

/// What a piece of a surface encloses. An open one is closed by a fan of triangles over the middle of its open edges.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Enclosed {
    /// Negative if its triangles look inwards.
    volume: f64,
    area: f64,
    pub(crate) is_open: bool,
    /// A point of it.
    first: DVec3,
}

impl Enclosed {
    /// Whether it is flat but for round-off.
    fn is_sheet(&self) -> bool {
        self.size() <= 1e-9 * self.area * self.area.sqrt()
    }

    /// Its volume, whichever way it looks.
    pub(crate) fn size(&self) -> f64 {
        self.volume.abs()
    }

    pub(crate) fn is_solid(&self) -> bool {
        self.volume > 0.0 && !self.is_sheet()
    }
}
