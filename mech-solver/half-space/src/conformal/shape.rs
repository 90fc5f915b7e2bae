//! Two arcs that touch: the distance between them across, and the direction of the surface between.
//!
//! The surface of the contact is the arc of the mean curvature κ = ½(κ₁ + κ₂), so the direction at
//! the distance s along it is α = κs. The arc of a body passes through the origin with the
//! curvature κ_b. A normal to the surface meets it at the distance t where ½κ_b(y² + z²) = z. The
//! undeformed distance is t₁ − t₂ along the normal, plus x²/2 times the relative curvature of
//! rolling.

/// The arcs of body 1 (upper) and body 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arcs {
    /// Curvatures dα/ds [1/m]: negative where the surface bends down.
    pub curvatures: [f64; 2],
    /// 1/R₁ + 1/R₂ along x [1/m].
    pub rolling_curvature: f64,
}

/// Distance at points where a body has no surface, large enough to exclude contact [m].
const NOTHING: f64 = 1e3;

impl Arcs {
    /// Mean curvature κ [1/m].
    #[must_use]
    pub fn curvature(&self) -> f64 {
        0.5 * (self.curvatures[0] + self.curvatures[1])
    }

    /// Direction α of the surface [rad].
    #[must_use]
    pub fn direction(&self, s: f64) -> f64 {
        self.curvature() * s
    }

    /// Position (y, z) on the surface [m].
    #[must_use]
    pub fn place(&self, s: f64) -> [f64; 2] {
        let half = 0.5 * self.direction(s);
        let chord = if half.abs() > 1e-8 { s * half.sin() / half } else { s };
        [chord * half.cos(), chord * half.sin()]
    }

    /// Undeformed distance of the bodies [m].
    #[must_use]
    pub fn distance(&self, x: f64, s: f64) -> f64 {
        let [y, z] = self.place(s);
        let (sin, cos) = self.direction(s).sin_cos();
        let height = |curvature: f64| {
            let off = 0.5 * curvature * (y * y + z * z) - z;
            let slope = curvature * (z * cos - y * sin) - cos;
            let root = slope * slope - 2.0 * curvature * off;
            (root >= 0.0).then(|| -2.0 * off / (slope + root.sqrt().copysign(slope)))
        };
        match self.curvatures.map(height) {
            [Some(upper), Some(lower)] => upper - lower + 0.5 * self.rolling_curvature * x * x,
            _ => NOTHING,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Circles with centres on one line: distances by the law of cosines from the mean arc.
    #[test]
    fn distances_of_circles() {
        let (inner, outer) = (10e-3_f64, 10.2e-3_f64);
        let arcs = Arcs { curvatures: [-1.0 / outer, -1.0 / inner], rolling_curvature: 0.0 };
        let mean = 1.0 / arcs.curvature().abs();
        for s in [-9e-3, 1e-3, 6e-3] {
            let angle = s / mean;
            // Along the ray from the centre of the mean arc.
            let along = |radius: f64| {
                let d = radius - mean;
                // The centre of the circle is lower by d.
                -d * angle.cos() + (radius * radius - (d * angle.sin()).powi(2)).sqrt()
            };
            let exact = along(outer) - along(inner);
            assert!((arcs.distance(0.0, s) - exact).abs() < 1e-15, "{s}");
        }
    }

    #[test]
    fn flat_bodies_have_the_curvature_of_rolling() {
        let arcs = Arcs { curvatures: [0.0; 2], rolling_curvature: 2.0 };
        assert_eq!(arcs.distance(3e-3, 5e-3), 9e-6);
        assert_eq!(arcs.place(5e-3), [5e-3, 0.0]);
    }
}
