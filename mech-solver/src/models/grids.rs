//! Names of the grids that models have in common.

/// Name of the grid that covers the contact.
pub const CONTACT_GRID: &str = "contact";
/// Name of the grid of quantities that belong to a whole body: one element as large as the
/// contact's grid.
pub const RIGID_GRID: &str = "rigid";
