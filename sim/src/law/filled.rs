//! Elements that are filled in part, or differ in stiffness.

use super::{Corners, Element, Law};
use crate::body::Body;
use crate::lanes::{Lanes, each};
use crate::lists::IndexLists;

/// A law whose forces, energies and residuals are multiplied by the relative stiffness of each element, which is the last of its
/// constants. It is a law of its own, so that the steps of full elements of one stiffness are compiled without it.
#[derive(Clone)]
pub(crate) struct Filled<W>(pub(crate) W);

impl<W: Law> Law for Filled<W> {
    const OF_ELEMENT: usize = W::OF_ELEMENT + 1;
    const OF_CORNER: usize = W::OF_CORNER;
    const MEMORY: usize = W::MEMORY;
    const HAS_RESIDUAL: bool = W::HAS_RESIDUAL;
    type Whole<L: Lanes> = W::Whole<L>;

    fn elements(&self, body: &Body) -> Option<IndexLists> {
        self.0.elements(body)
    }

    fn relative_stiffness(&self, body: &Body) -> Option<Vec<f64>> {
        self.0.relative_stiffness(body)
    }

    fn is_damped(&self) -> bool {
        self.0.is_damped()
    }

    #[inline(always)]
    fn prepare<L: Lanes>(&self, rest: &Corners<'_, L>, of_element: &mut [L], of_corner: &mut [L]) {
        self.0.prepare(rest, &mut of_element[..W::OF_ELEMENT], of_corner);
        of_element[W::OF_ELEMENT] = rest.part();
    }

    fn of_node(&self) -> [f64; 2] {
        self.0.of_node()
    }

    #[inline(always)]
    fn whole<L: Lanes>(&self, element: &Element<'_, L>) -> W::Whole<L> {
        self.0.whole(element)
    }

    fn passes(&self) -> u32 {
        self.0.passes()
    }

    #[inline(always)]
    fn refine<L: Lanes>(&self, pass: u32, element: &Element<'_, L>, whole: &mut W::Whole<L>) {
        self.0.refine(pass, element, whole);
    }

    #[inline(always)]
    fn force<L: Lanes>(&self, element: &Element<'_, L>, corner: usize, whole: &W::Whole<L>) -> [L; 3] {
        let (part, force) = (element.of_element(W::OF_ELEMENT), self.0.force(element, corner, whole));
        each!(3, axis => force[axis] * part)
    }

    #[inline(always)]
    fn energy<L: Lanes>(&self, element: &Element<'_, L>, rest: &Corners<'_, L>, shares: &mut [L]) -> L {
        let (part, residual) = (element.of_element(W::OF_ELEMENT), self.0.energy(element, rest, shares));
        shares.iter_mut().for_each(|share| *share = *share * part);
        residual * part
    }
}
