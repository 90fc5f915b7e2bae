//! Capabilities: effects name those that they need of a model, models those that they have, and
//! neither knows the other's name.

/// A capability that not every model has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Capability {
    /// Heat flows between the surfaces where they touch.
    Exchange,
    /// Heat flows through gaps between the surfaces.
    Gaps,
    /// Potentials of an electric current through the contact.
    Potentials,
    /// Rises of earlier passages add up.
    EarlierPassages,
    /// The rise of each body, integrated over its depth.
    RiseIntegrals,
    /// Properties depend on the temperature.
    VaryingProperties,
    /// Free surfaces lose heat.
    FreeSurfaces,
    /// Rises of elements, on volumes.
    Volumes,
}

impl Capability {
    /// Returns the words for a model without it, to follow the name of the model.
    #[must_use]
    pub fn lack(self) -> &'static str {
        match self {
            Self::Exchange => "lets no heat flow between the surfaces",
            Self::Gaps => "does not know of gaps between the surfaces",
            Self::Potentials => "does not find potentials",
            Self::EarlierPassages => "does not add up the rises of earlier passages",
            Self::RiseIntegrals => "does not integrate the rise over the depth",
            Self::VaryingProperties => "has properties that do not depend on the temperature",
            Self::FreeSurfaces => "loses no heat through free surfaces",
            Self::Volumes => "has no elements",
        }
    }
}

/// A capability that the value of a key needs, beyond those that its effect always needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Need {
    /// The key.
    pub key: &'static str,
    /// The capability that its value needs.
    pub capability: Capability,
    /// Change of the key that suits a model without it.
    pub instead: &'static str,
}
