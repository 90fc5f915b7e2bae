//! Impulses, slip and work of the contact, summed over time on a plane of cells that travels with
//! it.
//!
//! A node of the upper surface distributes its values to the two cells between whose middles it
//! lies. The rows of cells are the rows of nodes. Sums over the plane therefore equal sums over the
//! nodes to rounding, and a passing node leaves a uniform trace.

use grids::Structured;

/// Sums over the cells of a plane.
#[derive(Clone, Debug)]
pub struct Plane {
    /// Grid of the cells.
    pub grid: Structured,
    /// Row of nodes of the first row of cells.
    pub first_row: usize,
    /// Normal impulse [N·s].
    pub normal: Vec<f64>,
    /// Tangential impulse on the upper body, along and across [N·s].
    pub tangential: [Vec<f64>; 2],
    /// Slip of the upper surface relative to the lower one, weighted with the normal impulse [N·m].
    pub slip: [Vec<f64>; 2],
    /// Friction work [J].
    pub work: Vec<f64>,
    /// Total time of the sums [s].
    pub time: f64,
    /// Length of a step [s].
    pub step: f64,
}

/// Contribution of a node in a step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Event {
    /// Normal impulse [N·s].
    pub normal: f64,
    /// Tangential impulse on the upper body [N·s].
    pub tangential: [f64; 2],
    /// Slip [m].
    pub slip: [f64; 2],
    /// Friction work [J].
    pub work: f64,
}

impl Plane {
    /// Creates a plane with all sums zero.
    #[must_use]
    pub fn new(grid: Structured, first_row: usize) -> Self {
        let zeros = || vec![0.0; grid.points()];
        Self {
            grid,
            first_row,
            normal: zeros(),
            tangential: [zeros(), zeros()],
            slip: [zeros(), zeros()],
            work: zeros(),
            time: 0.0,
            step: 0.0,
        }
    }

    /// Resets all sums to zero.
    pub fn clear(&mut self) {
        let Self { normal, tangential: [x, y], slip: [slip_x, slip_y], work, time, .. } = self;
        for sums in [normal, x, y, slip_x, slip_y, work] {
            sums.fill(0.0);
        }
        *time = 0.0;
    }

    /// Adds the contribution of a node of a row at a position [m]. Returns whether it is on the
    /// plane.
    pub fn add(&mut self, row: usize, x: f64, event: &Event) -> bool {
        let at = (x - self.grid.x(0)) / self.grid.dx();
        let column = at.floor();
        let (Some(row), true) = (row.checked_sub(self.first_row), column >= 0.0) else {
            return false;
        };
        let column = column as usize;
        if row >= self.grid.nj || column + 1 >= self.grid.ni {
            return false;
        }
        let part = at - at.floor();
        let cell = row * self.grid.ni + column;
        for (cell, share) in [(cell, 1.0 - part), (cell + 1, part)] {
            self.normal[cell] += share * event.normal;
            self.work[cell] += share * event.work;
            for k in 0..2 {
                self.tangential[k][cell] += share * event.tangential[k];
                self.slip[k][cell] += share * event.normal * event.slip[k];
            }
        }
        true
    }

    /// Mean of an impulse over time and area [Pa], or of a work [W/m²].
    #[must_use]
    pub fn mean(&self, sums: &[f64]) -> Vec<f64> {
        let scale = 1.0 / (self.time * self.grid.element_area());
        sums.iter().map(|sum| scale * sum).collect()
    }

    /// Mean slip velocity [m/s] where the surfaces touch.
    #[must_use]
    pub fn slip_velocity(&self, component: usize) -> Vec<f64> {
        let step = self.step;
        let weighted = self.slip[component].iter().zip(&self.normal);
        weighted
            .map(|(slip, normal)| if *normal > 0.0 { slip / (normal * step) } else { 0.0 })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_over_the_plane_are_sums_over_the_nodes() {
        let mut plane = Plane::new(Structured::contact_plane(-1.0, 0.0, 0.5, 1.0, 5, 3), 7);
        let event = Event { normal: 2.0, work: 3.0, slip: [0.1, 0.0], tangential: [1.0, 0.5] };
        assert!(plane.add(8, 0.3, &event));
        assert!(
            !plane.add(6, 0.3, &event) && !plane.add(8, 1.1, &event) && !plane.add(8, -1.1, &event)
        );
        assert_eq!(plane.normal.iter().sum::<f64>(), 2.0);
        assert!((plane.normal[5 + 2] - 0.8).abs() < 1e-15);
        (plane.time, plane.step) = (2.0, 0.5);
        assert!((plane.slip_velocity(0)[5 + 3] - 0.2).abs() < 1e-15);
        assert_eq!(plane.mean(&plane.work).iter().sum::<f64>() * 0.5 * 2.0, 3.0);
    }
}
