//! Upper bound of the highest frequency of small vibrations of a body, which limits the stable
//! step.
//!
//! Central differences are stable for Δt ≤ 2/ω, where ω² is the largest value of Rayleigh's
//! quotient uᵀKu/uᵀMu. The stiffness K and the lumped mass M are sums over parts of the body, and a
//! quotient of sums is at most the largest quotient of the terms:
//!
//! ω² ≤ max over the parts p of the largest eigenvalue of K_p u = ω² M_p u.
//!
//! Single elements as parts, with ρV/8 at each of eight nodes, give Flanagan & Belytschko's ω² ≤ 8
//! (λ+2μ)/ρ · Σ B² (Int. J. Numer. Meth. Engng 17 (1981) 679–706; B as in [`super::shape`]). A
//! lattice of cubes has a third of it, 4 (λ+2μ)/(ρ h²): a single element can shorten along all
//! three axes at once, but its neighbours cannot follow. Deviation from the source: a part is a
//! layer of elements, one element deep, over the whole width and length of the body. Displacements
//! along the rows are sums of waves u e^{iθn} with the number n of the node. At the ends of an
//! element they split into two classes,
//!
//! - E: u_x differs between the ends, u_y and u_z are equal, with the amplitudes sin(θ/2) u_x,
//!   cos(θ/2) u_y, cos(θ/2) u_z;
//! - O: u_x is equal, u_y and u_z differ, with the amplitudes cos(θ/2) u_x, sin(θ/2) u_y, sin(θ/2)
//!   u_z,
//!
//! so that K(θ) = D_E K_E D_E + D_O K_O D_O is real, and block tridiagonal across with blocks of
//! two nodes. uᵀK(θ)u is α + R cos(θ − φ) with α ≥ R ≥ 0. It is therefore at most 1/cos²(π/2N)
//! times the largest of its values at θ = 2πj/N. All σM − K(θ_j) have a Cholesky factorisation if
//! and only if σ is above their eigenvalues; bisection finds σ.
//!
//! Rows with fixed ends are infinite rows in which some nodes do not move: the bound holds. At free
//! ends an element has no neighbour on one side. There both classes are taken separately, D = 1,
//! which is the bound with elements as parts along x. Elements that are softer than their row have
//! a smaller K: the bound holds for them too.
//!
//! Sources: the quotient of sums, Irons & Treharne, Proc. 3rd Conf. Matrix Methods in Structural
//! Mechanics (1971); Fried, J. Sound Vib. 22 (1972) 407–418.

use super::kernel::Stiffness;
use super::shape::SIGNS;
use nalgebra::{SMatrix, SVector};
use std::f64::consts::PI;

/// Number N of waves in 2π; the bound is higher by 1/cos(π/2N), 0.12 %.
const WAVES: usize = 32;
/// Relative width at which the bisection for ω² ends.
const WIDTH: f64 = 1e-4;

/// Corners of the quadrilateral in the order of the nodes of a layer: upper and lower left, upper
/// and lower right.
const CORNERS: [usize; 4] = [0, 2, 1, 3];

type Pair = SMatrix<f64, 6, 6>;
type OfElement = SMatrix<f64, 12, 12>;

/// Factors of (u_x, u_y and u_z) in the classes E and O.
type Amplitudes = [[f64; 2]; 2];

/// Returns an upper bound of the highest angular frequency [1/s] of a body with rows of elements of
/// these stiffnesses, `across` rows per layer, and a density [kg/m³]. The body is free, or fixed at
/// its ends, sides and bottom if `held`.
#[must_use]
pub fn highest(rows: &[Stiffness], across: usize, density: f64, held: bool) -> f64 {
    let waves: Vec<Amplitudes> = if held {
        let of_wave = |j: usize| {
            let (sine, cosine) = (PI * j as f64 / WAVES as f64).sin_cos();
            [[sine, cosine], [cosine, sine]]
        };
        (0..=WAVES / 2).map(of_wave).collect()
    } else {
        vec![[[1.0; 2], [0.0; 2]], [[0.0; 2], [1.0; 2]]]
    };
    let (mut square, last) = (0.0, rows.len() / across - 1);
    for (at, rows) in rows.chunks_exact(across).enumerate() {
        // Sides and bottom of a fixed body do not move.
        let moves = |j: usize| {
            let [left, right, below] = [j > 0, j < across - 1, at < last].map(|it| it || !held);
            [left, left && below, right, right && below]
        };
        let elements: Vec<Element> =
            rows.iter().enumerate().map(|(j, row)| Element::new(row, density, moves(j))).collect();
        for wave in &waves {
            let layer = Layer::new(&elements, wave);
            if !layer.is_below(square) {
                square = layer.bound(square);
            }
        }
    }
    let between = if held { (0.5 * PI / WAVES as f64).cos() } else { 1.0 };
    f64::sqrt(square) / between
}

/// Element matrices. Rows and columns are ordered by corner as in [`CORNERS`], with x, y, z at
/// each.
struct Element {
    /// K_E and K_O [N/m].
    classes: [OfElement; 2],
    /// Mass of both ends of a corner [kg].
    mass: f64,
}

impl Element {
    /// Creates an element; corners that do not move keep their mass.
    fn new(row: &Stiffness, density: f64, moves: [bool; 4]) -> Self {
        let held = |i: usize, j: usize| !(moves[i / 3] && moves[j / 3]);
        let classes = [[true, false, false], [false, true, true]].map(|differs| {
            class(row, differs)
                .map_with_location(|i, j, value| if held(i, j) { 0.0 } else { value })
        });
        Self { classes, mass: 0.25 * density * row.shape.volume }
    }

    /// K(θ) [N/m].
    fn stiffness(&self, wave: &Amplitudes) -> OfElement {
        let scaled = |[along, across]: [f64; 2], class: &OfElement| {
            let factor = |at: usize| if at.is_multiple_of(3) { along } else { across };
            class.map_with_location(|i, j, value| factor(i) * factor(j) * value)
        };
        scaled(wave[0], &self.classes[0]) + scaled(wave[1], &self.classes[1])
    }
}

/// Stiffness of an element [N/m] for displacements whose components marked by `differs` are ∓u at
/// the near and the far end, while the others are u at both; the linearisation of
/// [`super::kernel`].
fn class(row: &Stiffness, differs: [bool; 3]) -> OfElement {
    let Stiffness { shape, lame: [lambda, mu], hourglass, .. } = row;
    let signs: [[f64; 3]; 4] = CORNERS.map(|corner| {
        let [_, eta, zeta] = SIGNS[2 * corner];
        [eta, zeta, eta * zeta]
    });
    // Linear functional of the amplitudes: one component, with a weight for each corner.
    let of_component = |component: usize, weight: &dyn Fn([f64; 3]) -> f64| {
        let mut row = SVector::<f64, 12>::zeros();
        for (corner, signs) in signs.into_iter().enumerate() {
            row[3 * corner + component] = 2.0 * weight(signs);
        }
        row
    };
    // ∂u_k/∂x, ∂u_k/∂y, ∂u_k/∂z of every component k.
    let gradient: [[SVector<f64, 12>; 3]; 3] = std::array::from_fn(|k| {
        std::array::from_fn(|r| match (r, differs[k]) {
            (0, true) => {
                let [b0, b1, b2, b3] = shape.along;
                of_component(k, &|[eta, zeta, both]| b0 + b1 * eta + b2 * zeta + b3 * both)
            }
            (1 | 2, false) => {
                let [b0, b1, b2] = shape.across[r - 1];
                of_component(k, &|[eta, zeta, both]| b0 * eta + b1 * zeta + b2 * both)
            }
            _ => SVector::zeros(),
        })
    });
    let mut stiffness = OfElement::zeros();
    // Displacements at the nodes are rotated to the directions of the element's middle.
    let (sine, cosine) = shape.half_angle.sin_cos();
    let mut add = |weight: f64, functional: SVector<f64, 12>| {
        let mut row = functional;
        for corner in 0..4 {
            let (x, z) = (functional[3 * corner], functional[3 * corner + 2]);
            row[3 * corner] = cosine * x + sine * z;
            row[3 * corner + 2] = cosine * z - sine * x;
        }
        stiffness += weight * row * row.transpose();
    };
    add(*lambda, gradient[0][0] + gradient[1][1] + gradient[2][2]);
    for k in 0..3 {
        let next = (k + 1) % 3;
        add(2.0 * mu, gradient[k][k]);
        add(*mu, gradient[k][next] + gradient[next][k]);
        if differs[k] {
            for mode in 0..3 {
                let sum = of_component(k, &|signs| signs[mode]);
                add(*hourglass, sum - shape.twist[mode] * gradient[k][0]);
            }
        } else {
            let sum = of_component(k, &|signs| signs[2]);
            let [bend_y, bend_z] = shape.bend;
            add(*hourglass, sum - bend_y * gradient[k][1] - bend_z * gradient[k][2]);
        }
    }
    stiffness
}

/// A layer of elements under a wave: pairs of an upper and a lower node from one side to the other.
struct Layer {
    /// Stiffness of every pair with itself, and with the next one [N/m].
    own: Vec<Pair>,
    next: Vec<Pair>,
    /// Mass of every pair in each direction [kg].
    mass: Vec<f64>,
}

impl Layer {
    fn new(elements: &[Element], wave: &Amplitudes) -> Self {
        let pairs = elements.len() + 1;
        let (mut own, mut mass) = (vec![Pair::zeros(); pairs], vec![0.0; pairs]);
        let mut next = Vec::with_capacity(elements.len());
        for (at, element) in elements.iter().enumerate() {
            let stiffness = element.stiffness(wave);
            own[at] += stiffness.fixed_view::<6, 6>(0, 0);
            own[at + 1] += stiffness.fixed_view::<6, 6>(6, 6);
            next.push(stiffness.fixed_view::<6, 6>(0, 6).into_owned());
            mass[at] += element.mass;
            mass[at + 1] += element.mass;
        }
        Self { own, next, mass }
    }

    /// Returns true if all eigenvalues ω² are below σ, by factorising σM − K from one side to the
    /// other.
    fn is_below(&self, sigma: f64) -> bool {
        let mut before = Pair::zeros();
        for (at, (own, mass)) in self.own.iter().zip(&self.mass).enumerate() {
            let shifted = Pair::identity() * (sigma * mass) - own - before;
            let Some(factors) = shifted.cholesky() else { return false };
            if let Some(next) = self.next.get(at) {
                before = next.transpose() * factors.solve(next);
            }
        }
        true
    }

    /// Tight upper bound of all eigenvalues [1/s²], at least `least`.
    fn bound(&self, least: f64) -> f64 {
        let quotients =
            self.own.iter().zip(&self.mass).map(|(own, mass)| own.diagonal().max() / mass);
        let mut low = quotients.fold(least, f64::max);
        let mut high = 2.0 * low;
        while !self.is_below(high) {
            (low, high) = (high, 2.0 * high);
        }
        while high > (1.0 + WIDTH) * low {
            let middle = 0.5 * (low + high);
            *(if self.is_below(middle) { &mut high } else { &mut low }) = middle;
        }
        high
    }
}
