use localshape_sim::model::{ByLaw, Corners, ElasticModel, Element, ForceModel, Lanes, Law, Properties, Vectorised};
use localshape_sim::{Body, IndexLists, Springs};
use std::sync::Arc;

/// The model with its parameters.
#[derive(Clone, Debug)]
pub struct Rods {
    /// `k` (N/m).
    pub stiffness: f64,
}

impl ElasticModel for Rods {
    fn properties(&self, _: &Body) -> Properties {
        Properties::new("rods", self.stiffness)
    }

    fn vectorised(&self) -> Option<&dyn Vectorised> {
        Some(self)
    }

    fn prepare(&self, body: &Arc<Body>) -> Box<dyn ForceModel> {
        Box::new(ByLaw::new(self.clone(), body))
    }
}

impl Law for Rods {
    /// The squared length at rest (m²).
    const OF_ELEMENT: usize = 1;
    /// The force on the first end (N).
    type Whole<L: Lanes> = [L; 3];

    fn elements(&self, body: &Body) -> Option<IndexLists> {
        Some(body.topology().springs(Springs::All).iter().map(|ends| &ends[..]).collect())
    }

    #[inline(always)]
    fn prepare<L: Lanes>(&self, rest: &Corners<'_, L>, of_element: &mut [L], _: &mut [L]) {
        of_element[0] = square(between(rest.position(0), rest.position(1)));
    }

    #[inline(always)]
    fn whole<L: Lanes>(&self, rod: &Element<'_, L>) -> [L; 3] {
        let (p, squared) = (between(rod.corner(0).0, rod.corner(1).0), rod.of_element(0));
        let pull = L::splat(0.5 * self.stiffness) * (square(p) - squared) / squared;
        [pull * p[0], pull * p[1], pull * p[2]]
    }

    #[inline(always)]
    fn force<L: Lanes>(&self, _: &Element<'_, L>, corner: usize, &[x, y, z]: &[L; 3]) -> [L; 3] {
        if corner == 0 { [x, y, z] } else { [-x, -y, -z] }
    }

    #[inline(always)]
    fn energy<L: Lanes>(&self, rod: &Element<'_, L>, _: &Corners<'_, L>, shares: &mut [L]) -> L {
        let squared = rod.of_element(0);
        let excess = square(between(rod.corner(0).0, rod.corner(1).0)) - squared;
        // Half of the energy for each end.
        shares.fill(L::splat(self.stiffness / 16.0) / squared * excess * excess);
        L::splat(0.0)
    }
}

#[inline(always)]
fn between<L: Lanes>([ax, ay, az]: [L; 3], [bx, by, bz]: [L; 3]) -> [L; 3] {
    [bx - ax, by - ay, bz - az]
}

#[inline(always)]
fn square<L: Lanes>([x, y, z]: [L; 3]) -> L {
    x * x + y * y + z * z
}
