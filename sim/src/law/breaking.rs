//! Elements and springs that break.

use super::{Corners, Element, Law};
use crate::body::Body;
use crate::lanes::{Lanes, each};
use crate::lists::IndexLists;

/// A law that tells how strained its elements are.
pub(crate) trait Strained: Law {
    /// The strain of elements about which `whole` is all known. It is that of [`Field::Strain`](crate::Field::Strain), or of a spring its
    /// elongation over its natural length, which is below 0 if it is shortened.
    fn strain<L: Lanes>(&self, element: &Element<'_, L>, whole: &Self::Whole<L>) -> L;
}

/// A law whose elements have no force and no energy once their strain has exceeded a limit. Each remembers that in one more number, its last: 0
/// before, 1 from then on. Laws that do not break are compiled without it.
///
/// The strain decides in the evaluation itself, so that forces are still functions of nodes and memory alone.
#[derive(Clone)]
pub(crate) struct Breaking<W> {
    pub(crate) law: W,
    /// The greatest strain that an element bears.
    pub(crate) limit: f64,
}

/// What is known of elements, and whether they are broken.
#[derive(Clone, Copy)]
pub(crate) struct Bearing<T, L> {
    whole: T,
    /// 1 if it is broken, else 0.
    broken: L,
}

impl<W: Strained> Breaking<W> {
    /// Breaks elements that are strained too far.
    #[inline(always)]
    fn test<L: Lanes>(&self, element: &Element<'_, L>, of: &mut Bearing<W::Whole<L>, L>) {
        let strain = self.law.strain(element, &of.whole);
        let [before] = element.memory_from(W::MEMORY);
        of.broken = L::splat(1.0).select(L::splat(self.limit).lt(strain), before);
        element.remember_from(W::MEMORY, [of.broken]);
    }
}

/// A number of intact elements, 0 of broken ones.
#[inline(always)]
fn intact<L: Lanes>(number: L, broken: L) -> L {
    number.select(broken.lt(L::splat(0.5)), L::splat(0.0))
}

impl<W: Strained> Law for Breaking<W> {
    const OF_ELEMENT: usize = W::OF_ELEMENT;
    const OF_CORNER: usize = W::OF_CORNER;
    const MEMORY: usize = W::MEMORY + 1;
    const HAS_RESIDUAL: bool = W::HAS_RESIDUAL;
    type Whole<L: Lanes> = Bearing<W::Whole<L>, L>;

    fn elements(&self, body: &Body) -> Option<IndexLists> {
        self.law.elements(body)
    }

    fn relative_stiffness(&self, body: &Body) -> Option<Vec<f64>> {
        self.law.relative_stiffness(body)
    }

    fn is_damped(&self) -> bool {
        self.law.is_damped()
    }

    #[inline(always)]
    fn prepare<L: Lanes>(&self, rest: &Corners<'_, L>, of_element: &mut [L], of_corner: &mut [L]) {
        self.law.prepare(rest, of_element, of_corner);
    }

    #[inline(always)]
    fn whole<L: Lanes>(&self, element: &Element<'_, L>) -> Self::Whole<L> {
        let mut of = Bearing { whole: self.law.whole(element), broken: L::splat(0.0) };
        if self.law.passes() == 0 {
            self.test(element, &mut of);
        }
        of
    }

    fn passes(&self) -> u32 {
        self.law.passes()
    }

    #[inline(always)]
    fn refine<L: Lanes>(&self, pass: u32, element: &Element<'_, L>, of: &mut Self::Whole<L>) {
        self.law.refine(pass, element, &mut of.whole);
        if pass + 1 == self.law.passes() {
            self.test(element, of);
        }
    }

    /// With the forces that a node would compute once for all its elements, because some of these are broken.
    #[inline(always)]
    fn force<L: Lanes>(&self, element: &Element<'_, L>, corner: usize, of: &Self::Whole<L>) -> [L; 3] {
        let ([k, d], (p, v)) = (self.law.of_node(), element.corner(corner));
        let (k, d, force) = (L::splat(k), L::splat(d), self.law.force(element, corner, &of.whole));
        each!(3, axis => intact(d.neg_mul_add(v[axis], k.neg_mul_add(p[axis], force[axis])), of.broken))
    }

    #[inline(always)]
    fn energy<L: Lanes>(&self, element: &Element<'_, L>, rest: &Corners<'_, L>, shares: &mut [L]) -> L {
        let residual = self.law.energy(element, rest, shares);
        let mut of = self.whole(element);
        for pass in 0..self.passes() {
            self.refine(pass, element, &mut of);
        }
        for share in shares.iter_mut() {
            *share = intact(*share, of.broken);
        }
        intact(residual, of.broken)
    }
}
