//! Friction power, and the tolerance of the power balance of a contact.

/// Largest accepted imbalance of power. It is above the error left by the alternations of pressure
/// and tractions of different bodies: 2e-7 in the worst of a thousand contacts.
pub(crate) const LARGEST_POWER_IMBALANCE: f64 = 1e-6;

/// |taken − given| divided by the magnitudes of all exchanged power \[-\]. Returns 0 if no power is
/// exchanged, or so little that the products underflow.
pub(crate) fn power_imbalance(taken: f64, given: f64, exchanged: f64) -> f64 {
    const FAINT: f64 = f64::MIN_POSITIVE / f64::EPSILON;
    let off = (taken - given).abs();
    if off <= FAINT && exchanged <= FAINT { 0.0 } else { off / exchanged }
}

/// Friction power density −p_t · v of a traction and a slip velocity, both means over one element
/// of a solution for which their product is exact.
pub(super) fn power_density(traction: [f64; 2], slip_velocity: [f64; 2]) -> f64 {
    // Subtracting from zero turns −0 into 0.
    0.0 - (traction[0] * slip_velocity[0] + traction[1] * slip_velocity[1])
}
