//! Optional capabilities of models. Effects list those that they need and models those that they
//! have, so that neither refers to the other by name.

/// Optional capability of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Capability {
    /// Heat exchange between surfaces in contact.
    Exchange,
    /// Heat exchange through gaps between the surfaces.
    Gaps,
    /// Potentials of an electric current through the contact.
    Potentials,
    /// Superposition of the rises left by earlier passages.
    EarlierPassages,
    /// Rise of each body integrated over its depth.
    RiseIntegrals,
    /// Material properties that depend on the temperature.
    VaryingProperties,
    /// Heat loss through free surfaces.
    FreeSurfaces,
    /// Rises of the elements, on volume grids.
    Volumes,
}

impl Capability {
    /// Returns the text for a model without the capability, to follow the name of the model.
    #[must_use]
    pub fn lack(self) -> &'static str {
        match self {
            Self::Exchange => "does not exchange heat between the surfaces",
            Self::Gaps => "does not support gaps between the surfaces",
            Self::Potentials => "does not compute potentials",
            Self::EarlierPassages => "does not add up the rises of earlier passages",
            Self::RiseIntegrals => "does not integrate the rise over depth",
            Self::VaryingProperties => "supports only properties that do not depend on temperature",
            Self::FreeSurfaces => "does not lose heat through free surfaces",
            Self::Volumes => "has no elements",
        }
    }
}

/// Capability required by the value of a key, in addition to those that the effect always needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Need {
    /// Key of the value.
    pub key: &'static str,
    /// Capability that the value needs.
    pub capability: Capability,
    /// Alternative value or action for a model without the capability, if there is one.
    pub instead: Option<&'static str>,
}
