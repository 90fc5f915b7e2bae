//! When the power of a contact adds up.

/// Largest imbalance of power that is accepted: above what the turns of pressure and tractions of
/// different bodies leave, 2e-7 in the worst of a thousand contacts.
pub(crate) const LARGEST_POWER_IMBALANCE: f64 = 1e-6;

/// |taken − given| over the magnitudes of all that is exchanged \[-\]; 0 where nothing is, or so little
/// that its products have no digits left.
pub(crate) fn power_imbalance(taken: f64, given: f64, exchanged: f64) -> f64 {
    const FAINT: f64 = f64::MIN_POSITIVE / f64::EPSILON;
    let off = (taken - given).abs();
    if off <= FAINT && exchanged <= FAINT { 0.0 } else { off / exchanged }
}
