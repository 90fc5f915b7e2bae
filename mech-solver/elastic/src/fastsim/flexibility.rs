//! Springs of the simplified theory, fitted to Kalker's linear theory.
//!
//! With u = L p and adhesion everywhere a strip has the traction p_x = −(ξ/L)(a_y − x), and
//! likewise p_y. The sum over the ellipse is the force of the linear theory if
//!
//! - L1 = 8 a/(3 G C11) for ξ, L2 = 8 a/(3 G C22) for η,
//! - L3 = π a √(a/b)/(4 G C23) for the lateral force of φ.
//!
//! `three`: each creepage has its own flexibility, ∂p_x/∂x = ξ/L1 − φ y/L3 and
//! ∂p_y/∂x = η/L2 + φ x/L3 in adhesion. As springs these are u = (L1 p_x, L2 p_y) under the rigid
//! slip ξ − (L1/L3) φ y, η + (L2/L3) φ x. The slopes are Kalker's for every mixture of creepages.
//! The slip is not exactly against the traction where L1 ≠ L2, and its power differs slightly from
//! that of the spin φ.
//!
//! `single`: one L for all, so that slip is against the traction and has exactly the power of the
//! creepages. L gives the linear force the same component along the creepage as the three. With
//! c = 3πa/32, the length at which φ weighs as much as a creepage,
//! (ξ² + η² + c²φ²)/L = ξ²/L1 + η²/L2 + c²φ²/L3. For a single creepage L is the flexibility of that
//! creepage.
//!
//! This mean is the project's, and differs from FASTSIM as published.
//!
//! `kalker-1982`: one L for all as in FASTSIM as published, L = (|ξ| L1 + |η| L2 + |φ| √(ab)
//! L3)/√(ξ² + η² + ab φ²). For a single creepage L is again the flexibility of that creepage. For
//! mixed creepages L is larger than any mean, by up to √3, so that the linear force falls short of
//! Kalker's linear theory.
//!
//! `blended`: three at small creepage, one at large creepage, each L_i (1 − w) + w L between, with
//! w = min(1, |(ξ, η)|/(3 c_s)), c_s² = c_ξ² + c_η², c_ξ = f N/(G a b C11), c_η = f N/(G a b C22):
//! the creepages at which the linear theory reaches f N (Vollebregt, as in CONTACT r2707).
//!
//! Sources: J. J. Kalker, Vehicle System Dynamics 11 (1982) 1–13, for `three` and `kalker-1982`;
//! `single` is derived here.
//!
//! A reduction factor k (`reduction`) divides all flexibilities.

use crate::kalker::CreepCoefficients;
use std::f64::consts::PI;

/// Creepages ξ, η [-] and φ [rad/m].
pub type Creepage = [f64; 3];

/// Number of flexibilities, and the kind of mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One for all creepages, which keeps the component of the linear force along the creepage.
    Single,
    /// One for all creepages, by Kalker's weighted sum of 1982.
    Kalker1982,
    /// One for each creepage.
    Three,
    /// Three at small creepage, one at large.
    Blended,
}

impl Kind {
    /// Returns true if friction dissipates exactly the power of all creepages, including spin.
    pub fn balances_spin(self) -> bool {
        matches!(self, Self::Single | Self::Kalker1982)
    }
}

/// Kalker's three flexibilities [m/Pa].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flexibilities {
    /// Flexibility L1 of ξ [m/Pa].
    pub longitudinal: f64,
    /// Flexibility L2 of η [m/Pa].
    pub lateral: f64,
    /// Flexibility L3 of φ [m/Pa].
    pub spin: f64,
    /// Length at which φ weighs as much as a creepage, 3πa/32 [m].
    pub spin_length: f64,
    /// Length at which φ weighs as much as a creepage in Kalker's sum of 1982, √(ab) [m].
    pub mean_axis: f64,
}

impl Flexibilities {
    /// Flexibilities for semi-axes a, b [m] and a shear modulus [Pa].
    pub fn new(coefficients: &CreepCoefficients, [a, b]: [f64; 2], modulus: f64) -> Self {
        let creep = 8.0 * a / (3.0 * modulus);
        Self {
            longitudinal: creep / coefficients.c11,
            lateral: creep / coefficients.c22,
            spin: PI * a * (a / b).sqrt() / (4.0 * modulus * coefficients.c23),
            spin_length: 3.0 * PI * a / 32.0,
            mean_axis: (a * b).sqrt(),
        }
    }

    /// Springs for a creepage; L1 and L2 times `reach`, 3 f N/(8 a² b) [Pa/m], are c_ξ and c_η.
    pub fn springs(&self, kind: Kind, creepage: Creepage, reach: f64) -> Springs {
        match kind {
            Kind::Three => self.three(),
            Kind::Single => Springs::new([self.single(creepage); 2], [1.0; 2]),
            Kind::Kalker1982 => Springs::new([self.kalker_1982(creepage); 2], [1.0; 2]),
            Kind::Blended => self.blended(creepage, reach).three(),
        }
    }

    fn three(&self) -> Springs {
        Springs::new(
            [self.longitudinal, self.lateral],
            [self.longitudinal / self.spin, self.lateral / self.spin],
        )
    }

    fn blended(&self, creepage: Creepage, reach: f64) -> Self {
        const ALL: f64 = 3.0;
        let [xi, eta, _] = creepage;
        let saturation = reach * self.longitudinal.hypot(self.lateral);
        let weight = (xi.hypot(eta) / (ALL * saturation)).min(1.0);
        let single = self.single(creepage);
        let blend = |own: f64| own + weight * (single - own);
        Self {
            longitudinal: blend(self.longitudinal),
            lateral: blend(self.lateral),
            spin: blend(self.spin),
            ..*self
        }
    }

    fn kalker_1982(&self, [xi, eta, phi]: Creepage) -> f64 {
        let parts = [xi, eta, self.mean_axis * phi].map(f64::abs);
        let largest = parts.iter().copied().fold(0.0, f64::max);
        if largest == 0.0 {
            return self.longitudinal;
        }
        let [x, y, z] = parts.map(|part| part / largest);
        (x * self.longitudinal + y * self.lateral + z * self.spin) / (x * x + y * y + z * z).sqrt()
    }

    fn single(&self, [xi, eta, phi]: Creepage) -> f64 {
        let parts = [xi, eta, self.spin_length * phi];
        let largest = parts.iter().fold(0.0, |most: f64, part| most.max(part.abs()));
        if largest == 0.0 {
            return self.longitudinal;
        }
        let weights = parts.map(|part| (part / largest).powi(2));
        let [x, y, z] = weights;
        (x + y + z) / (x / self.longitudinal + y / self.lateral + z / self.spin)
    }
}

/// Springs u = (L_x p_x, L_y p_y) under a rigid slip with weighted spin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Springs {
    /// L_x and L_y [m/Pa].
    pub flexibility: [f64; 2],
    /// 1/L_x and 1/L_y [Pa/m].
    pub stiffness: [f64; 2],
    /// Weights of the spin in the rigid slip [-].
    spin: [f64; 2],
}

impl Springs {
    fn new(flexibility: [f64; 2], spin: [f64; 2]) -> Self {
        Self { flexibility, stiffness: flexibility.map(f64::recip), spin }
    }

    /// Returns the springs with flexibilities divided by a factor.
    pub fn reduced(self, factor: f64) -> Self {
        Self {
            flexibility: self.flexibility.map(|own| own / factor),
            stiffness: self.stiffness.map(|own| own * factor),
            spin: self.spin,
        }
    }

    /// Creepages of a strip whose middle is at x [m], in axes with the origin in the middle.
    pub fn in_the_middle(&self, [xi, eta, phi]: Creepage, x: f64) -> Creepage {
        [xi, eta + self.spin[1] * phi * x, phi]
    }

    /// Rigid slip over V at (x, y) [-].
    pub fn rigid_slip(&self, [xi, eta, phi]: Creepage, x: f64, y: f64) -> [f64; 2] {
        [xi - self.spin[0] * phi * y, eta + self.spin[1] * phi * x]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const THREE: Flexibilities = Flexibilities {
        longitudinal: 2.0,
        lateral: 3.0,
        spin: 5.0,
        spin_length: 0.1,
        mean_axis: 0.2,
    };

    #[test]
    fn one_creepage_alone_has_its_own_flexibility() {
        for (creepage, expected) in [
            ([-1e-3, 0.0, 0.0], 2.0),
            ([0.0, 1e-300, 0.0], 3.0),
            ([0.0, 0.0, -1e200], 5.0),
            ([0.0; 3], 2.0),
        ] {
            for kind in [Kind::Single, Kind::Kalker1982] {
                assert_eq!(THREE.springs(kind, creepage, 1.0).flexibility, [expected; 2]);
            }
        }
    }

    /// The mean lies between the three flexibilities and does not depend on the size of the
    /// creepage.
    #[test]
    fn mixed_creepages() {
        let mixed = [1e-3, -2e-3, 0.03];
        let flexibility = THREE.springs(Kind::Single, mixed, 1.0).flexibility[0];
        assert!((flexibility - 14.0 / (1.0 / 2.0 + 4.0 / 3.0 + 9.0 / 5.0)).abs() < 1e-14);
        let larger = mixed.map(|part| 1e3 * part);
        let same = THREE.springs(Kind::Single, larger, 1.0).flexibility[0];
        assert!((same / flexibility - 1.0).abs() < 1e-15);
    }

    /// Kalker's sum of 1982 computed by hand, for parts in the ratios 3:4:0 and 1:2:2.
    #[test]
    fn the_sum_of_1982() {
        for (creepage, expected) in [
            ([3e-3, -4e-3, 0.0], (3.0 * 2.0 + 4.0 * 3.0) / 5.0),
            ([1e-3, 2e-3, -0.01], (2.0 + 2.0 * 3.0 + 2.0 * 5.0) / 3.0),
        ] {
            let springs = THREE.springs(Kind::Kalker1982, creepage, 1.0);
            assert!((springs.flexibility[0] - expected).abs() < 1e-14, "{springs:?}");
            assert_eq!((springs.flexibility[1], springs.spin), (springs.flexibility[0], [1.0; 2]));
        }
    }

    /// CONTACT r2707, example fastsim, has the flexibilities 4.937, 5.152 and 4.090e-14 m/Pa for
    /// a = 8 mm, b = 4 mm, f N = 24.6 kN, G = 82 GPa, ν = 0.28, η = −6.25e-4 and φ = 0.625/m.
    /// Tolerance: another interpolation of Kalker's coefficients.
    #[test]
    fn flexibilities_of_contact() {
        let [a, b] = [8e-3, 4e-3];
        let coefficients = crate::kalker::creep_coefficients(a / b, 0.28);
        let own = Flexibilities::new(&coefficients, [a, b], 82e9);
        let blended = own.blended([0.0, -6.25e-4, 0.625], 3.0 * 24.6e3 / (8.0 * a * a * b));
        for (found, printed) in [
            (blended.longitudinal, 4.937e-14),
            (blended.lateral, 5.152e-14),
            (blended.spin, 4.090e-14),
        ] {
            assert!((found / printed - 1.0).abs() < 0.02, "{blended:?} {own:?}");
        }
        assert_eq!(own.blended([1.0, 0.0, 0.0], 1.0).longitudinal, own.longitudinal);
        let none = own.blended([0.0; 3], 1.0);
        assert_eq!(none, own);
        let much = own.blended([3.0, 4.0, 5.0], 1.0);
        let single = own.single([3.0, 4.0, 5.0]);
        assert!(
            (much.spin / single - 1.0).abs() < 1e-15 && (much.lateral / single - 1.0).abs() < 1e-15
        );
    }
}
