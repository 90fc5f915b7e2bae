//! Prescribed load or approach of a normal contact.

/// Prescribed load or approach of a normal contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Prescribed {
    /// Normal force N [N].
    Load(f64),
    /// Approach δ of the bodies [m].
    Approach(f64),
}
