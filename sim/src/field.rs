//! Scalar fields over a body, for the colours of pictures.

use super::body::Body;
use super::crew::Crew;
use super::kernel;
use super::lanes::Set;
use super::placement::Placement;
use super::state::Nodes;

/// A number for each node or each element of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "scene", serde(rename_all = "kebab-case"))]
pub enum Field {
    /// Relative deformation of each element: `√(Σ |r − M R0|² / Σ |R0|²)` with the best rotation `M`. Zero for any
    /// rigid motion, and `a` for an element scaled by `1 + a`.
    Strain,
    /// Distance of each node from its position in the best rigid fit of the rest shape (m).
    Displacement,
    /// Speed of each node (m/s).
    Speed,
    /// Elastic energy of each node (J): its part of each element's, and half of each spring's. The sum over the nodes is
    /// the body's.
    ElasticEnergy,
    /// Distance of each node from the same node of the run `to` at the same moment (m), until that run diverges. That run
    /// has no values.
    Distance,
}

/// The places of the values of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    /// One for each node.
    Nodes,
    /// One for each element.
    Elements,
}

impl Field {
    /// The places of its values.
    pub fn support(self) -> Support {
        match self {
            Self::Strain => Support::Elements,
            Self::Displacement | Self::Speed | Self::ElasticEnergy | Self::Distance => Support::Nodes,
        }
    }

    /// Its name in captions.
    pub fn name(self) -> &'static str {
        match self {
            Self::Strain => "strain",
            Self::Displacement => "displacement",
            Self::Speed => "speed",
            Self::ElasticEnergy => "elastic energy",
            Self::Distance => "distance",
        }
    }

    /// Its unit; empty for a dimensionless number.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Strain => "",
            Self::Displacement | Self::Distance => "m",
            Self::Speed => "m/s",
            Self::ElasticEnergy => "J",
        }
    }

    /// Its definition, in a few words beside its name in keys.
    pub fn definition(self) -> &'static str {
        match self {
            Self::Strain => "RMS distance from the rest shape, over its size",
            Self::Displacement => "distance from the best fit of the rest shape",
            Self::Speed => "of each node",
            Self::ElasticEnergy => "share of each node",
            Self::Distance => "between equal nodes",
        }
    }

    /// The field at a state. `energies` is the elastic energy of each node (J), for [`Field::ElasticEnergy`]. One state has
    /// no values of [`Field::Distance`]: see [`RunFrame::measure`](crate::RunFrame::measure).
    pub(super) fn values(
        self,
        body: &Body,
        state: Nodes<'_>,
        placement: &Placement,
        energies: Vec<f64>,
        crew: &Crew,
    ) -> Vec<f64> {
        match self {
            Self::Strain => kernel::strains(Set::best(), body, state.position, placement.turn, crew),
            Self::Displacement => {
                let nodes = body.rest.iter().zip(state.position);
                nodes.map(|(&rest, &now)| now.distance(placement.place(rest))).collect()
            }
            Self::Speed => state.velocity.iter().map(|velocity| velocity.length()).collect(),
            Self::ElasticEnergy => energies,
            Self::Distance => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::Dimension;
    use crate::state::State;
    use glam::{DQuat, DVec3};

    #[test]
    fn strain_is_the_scale_of_a_scaled_element_and_nothing_for_a_turned_one() {
        let turn = DQuat::from_xyzw(0.3, -0.4, 0.1, 0.8).normalize();
        for (dimension, height) in [(Dimension::Plane, 0.0), (Dimension::Space, 1.0)] {
            let top = DVec3::new(0.4, 0.5, height);
            let rest = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y, top];
            let body = Body::builder(rest.clone())
                .dimension(dimension)
                .elements([&[0, 1, 2, 3][..]].into_iter().collect())
                .build()
                .expect("a body");
            let turn = if dimension == Dimension::Plane { DQuat::from_xyzw(0.0, 0.0, 0.6, 0.8) } else { turn };
            for scale in [1.0, 1.25, 0.4] {
                let now = State::at_rest(rest.iter().map(|&point| DVec3::ONE + scale * (turn * point)).collect());
                let crew = Crew::new(1);
                let strain = Field::Strain.values(&body, now.nodes(), &Placement::default(), Vec::new(), &crew);
                assert!((strain[0] - (scale - 1.0).abs()).abs() < 1e-14, "{scale}: {strain:?}");
            }
        }
    }
}
