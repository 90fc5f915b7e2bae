//! The choice of a method.

use contract::field::{FieldKind, Mapping};
use std::collections::BTreeMap;

/// How the value of a target element is made of those of source elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The value of the nearest element centre; the mean if several are equally near.
    NearestNeighbour,
    /// Bilinear between the element centres around the target's foot on the surface; constant
    /// beyond the outermost centres, so that nothing overshoots.
    NearestProjection,
    /// Wendland's C2 function with a linear polynomial on a few rings of elements.
    RadialBasis,
    /// Mean over the intersections of the elements, exact in a common plane.
    Intersection,
}

impl Method {
    /// Every method.
    pub const ALL: [Self; 4] =
        [Self::NearestNeighbour, Self::NearestProjection, Self::RadialBasis, Self::Intersection];

    /// Name in case files and reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::NearestNeighbour => "nearest-neighbour",
            Self::NearestProjection => "nearest-projection",
            Self::RadialBasis => "radial-basis",
            Self::Intersection => "intersection",
        }
    }

    /// The method of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }

    /// What suits a field that nobody chose a method for: second order without overshoot for point
    /// values, exact areas for densities.
    #[must_use]
    pub fn suited_to(preserves: Mapping) -> Self {
        match preserves {
            Mapping::Consistent => Self::NearestProjection,
            Mapping::Conservative => Self::Intersection,
        }
    }
}

/// How fields come to a consumer whose grid does not match.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Mappings {
    /// For every field; `None` for the one that suits it.
    pub method: Option<Method>,
    /// For single fields, by name; `None` for the one that suits it.
    pub fields: BTreeMap<String, Option<Method>>,
}

impl Mappings {
    /// The method for a field.
    #[must_use]
    pub fn method_of(&self, field: &FieldKind) -> Method {
        let chosen = self.fields.get(&field.name).unwrap_or(&self.method);
        chosen.unwrap_or_else(|| Method::suited_to(field.mapping))
    }
}
