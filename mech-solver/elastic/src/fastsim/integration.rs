//! Integration from the leading to the trailing edge of every strip.
//!
//! **Strips.** The strips stand at y = b sin θ with θ in equal steps h = π/n, n even, and have the
//! half length a η, η = cos θ, and the weight π b η/n. In θ the area π a b and the volume of the
//! parabolic bound, ∝ cos²θ and cos⁴θ, are exact to rounding, and a force ∝ η² to O(n⁻⁴). On the
//! contact grid strip j covers b sin(θ ± h/2), which differs from its weight by the factor
//! sin(h/2)/(h/2) common to all.
//!
//! **Cells.** A strip has m cells, of equal length Δ under the parabolic bound (see `bound` for the
//! elliptic one). With the traction p at a cell's front, the rigid slip w at its middle and the
//! springs L, the predictor p* = p − Δ w/L is the traction at its rear if |p*| ≤ g there; otherwise
//! the slip over V is s = L (p_rear − p*)/Δ, against the mean of the directions n and n_rear of the
//! tractions at both ends: p_rear = p* − ½μ(n + n_rear) with
//! |p_rear| = g, so that n_rear is the direction of p* − ½μ n with μ = (|p*|² − g²)/(g + p*·n).
//! Where spin turns the tractions this is of second order; along p* alone, as in a cell that does
//! not slip at its front, it is of first. In adhesion p is exact, since w is linear in x. The bound
//! g is exact at the nodes and linear between, with a factor that makes the trapezoidal sum of
//! every strip exact, so that full slip carries f N (`bound`). A cell in which slip begins is cut
//! there, where |p| = g, so that slip zones much shorter than a cell are resolved, and Kalker's
//! slopes with them.
//!
//! **Means.** A cell's traction is p̄ = (p + p_rear)/2. Then p̄·s = p̄·w + L(p_rear² − p²)/(2Δ).
//! The second term sums to zero over a strip, which ends with g = 0 on either side, so that Σ −p̄·s
//! ΔA = −(ξ F_x + η F_y + φ M_z) holds to rounding at every resolution. (Kalker's FASTSIM takes the
//! traction at one end of the cell, which leaves an error of first order.) With three flexibilities
//! M_z is replaced by ∫(L2/L3 x p_y − L1/L3 y p_x) dA, see `flexibility`.
//!
//! **Local friction.** A law beyond a single coefficient gives every node a bound of its own:
//! `limit` computes it from the position and from the bound under the mean coefficient. The sums
//! above are then those of the trapezoidal rule, of second order, and the power balance holds as
//! before.
//!
//! Where spin turns the slip within one cell, −p̄·s could be negative. Such a cell is halved until
//! the value is positive. The halving ends, because the value is positive once Δ |w|/L is below g
//! or p follows −w.
//!
//! Deviation from the source: the slip against the mean direction is this project's.
//!
//! Source: J. J. Kalker, A fast algorithm for the simplified theory of rolling contact, Vehicle
//! System Dynamics 11 (1982) 1–13.

use super::bound::Bound;
use super::flexibility::{Creepage, Springs};
use std::f64::consts::PI;

/// Strips and cells of an ellipse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Semi-axis a along x [m].
    pub semi_axis_a: f64,
    /// Semi-axis b along y [m].
    pub semi_axis_b: f64,
    /// Number n of strips, even.
    pub strips: usize,
    /// Number m of cells of a strip, at least two.
    pub cells: usize,
    /// Traction bound, which determines the cells.
    pub bound: Bound,
}

/// One strip of a lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strip {
    /// Lateral coordinate y of the strip [m].
    pub y: f64,
    /// Range of y that the strip covers on the grid [m].
    pub span: [f64; 2],
    /// Half length over a, η [-].
    pub eta: f64,
    /// Width of the strip in integrals [m].
    pub width: f64,
}

/// State of a cell, or of a part of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cell {
    /// Coordinate x of the rear and of the front [m].
    pub ends: [f64; 2],
    /// Mean traction on the upper body [Pa].
    pub traction: [f64; 2],
    /// Mean slip over V [-].
    pub slip: [f64; 2],
    /// The cell slips.
    pub slips: bool,
    /// Larger magnitude of traction at the two ends [Pa].
    pub largest_traction: f64,
}

impl Cell {
    /// Length [m].
    pub fn length(&self) -> f64 {
        self.ends[1] - self.ends[0]
    }

    /// x of the middle [m].
    pub fn middle(&self) -> f64 {
        0.5 * (self.ends[0] + self.ends[1])
    }
}

impl Lattice {
    /// All strips, from y = −b to y = b; strips at ±y are mirror images to the last bit.
    pub fn strips(&self) -> impl Iterator<Item = Strip> {
        let Self { semi_axis_b: b, strips, .. } = *self;
        let step = PI / strips as f64;
        (0..strips).map(move |index| {
            let steps = index as f64 + 0.5 - 0.5 * strips as f64;
            let angle = |offset: f64| step * (steps + offset);
            let eta = angle(0.0).cos();
            Strip {
                y: b * angle(0.0).sin(),
                span: [angle(-0.5), angle(0.5)].map(|angle| b * angle.sin()),
                eta,
                width: b * step * eta,
            }
        })
    }

    /// Coordinate x at which cell `index` of a strip, counted from the leading edge, starts [m].
    #[inline]
    pub fn node(&self, strip: &Strip, index: usize) -> f64 {
        self.bound.node(index, self.cells, self.semi_axis_a * strip.eta)
    }

    /// Sum over the strips of half an ellipsoid of height one, 2/3 π a b (1 + O(n⁻⁴)) [m²].
    pub fn half_ellipsoid(&self) -> f64 {
        let strip = |strip: Strip| strip.width * self.semi_axis_a * strip.eta * strip.eta;
        0.5 * PI * self.strips().map(strip).sum::<f64>()
    }

    /// Bound at the centre that makes the sum f N [Pa].
    pub fn largest_bound(&self, friction_bound: f64) -> f64 {
        match self.bound {
            Bound::Parabolic => 2.0 * friction_bound / (PI * self.semi_axis_a * self.semi_axis_b),
            Bound::Elliptic => friction_bound / self.half_ellipsoid(),
        }
    }
}

/// Data of the integration along the strips of one contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StripIntegration {
    /// Strips and cells.
    pub lattice: Lattice,
    /// Springs of the surfaces.
    pub springs: Springs,
    /// Creepage.
    pub creepage: Creepage,
    /// Traction bound at the centre [Pa].
    pub largest_bound: f64,
}

impl StripIntegration {
    /// Coordinate x and traction bound under the mean coefficient at the nodes of a strip [m, Pa].
    pub fn nodes(&self, strip: &Strip) -> impl Iterator<Item = (f64, f64)> + '_ {
        let strip = *strip;
        (0..=self.lattice.cells).map(move |index| self.node(&strip, index))
    }

    #[inline]
    fn node(&self, strip: &Strip, index: usize) -> (f64, f64) {
        let Lattice { bound, cells, .. } = self.lattice;
        let largest = bound.of_strip(self.largest_bound, strip.eta);
        (self.lattice.node(strip, index), largest * bound.shape(index, cells))
    }

    /// Visits the cells of a strip from the leading to the trailing edge. `limit` computes the
    /// bound from x and the bound under the mean coefficient.
    pub fn strip(
        &self,
        strip: &Strip,
        limit: impl Fn(f64, f64) -> f64,
        mut visit: impl FnMut(&Cell),
    ) {
        let node = |index: usize| {
            let (x, bound) = self.node(strip, index);
            Node { x, bound: limit(x, bound) }
        };
        let mut front = Front { node: node(0), traction: Traction::default() };
        for index in 1..=self.lattice.cells {
            let rear = node(index);
            let mut predictor = self.predictor(strip.y, &front, rear);
            if let Some(onset) = onset(&front, rear, &predictor) {
                let unbounded = Node { bound: f64::INFINITY, ..onset };
                let sticking = self.predictor(strip.y, &front, unbounded);
                let reached =
                    self.advance(strip.y, &front, unbounded, sticking, HALVINGS, &mut visit);
                front = Front { node: onset, traction: reached };
                predictor = self.predictor(strip.y, &front, rear);
            }
            let reached = self.advance(strip.y, &front, rear, predictor, HALVINGS, &mut visit);
            front = Front { node: rear, traction: reached };
        }
    }

    /// Traction at the rear of a cell in adhesion.
    #[inline]
    fn predictor(&self, y: f64, front: &Front, rear: Node) -> Traction {
        let rigid = self.springs.rigid_slip(self.creepage, 0.5 * (rear.x + front.node.x), y);
        let length = front.node.x - rear.x;
        let change = |i: usize| length * rigid[i] * self.springs.stiffness[i];
        Traction::of(std::array::from_fn(|i| front.traction.vector[i] - change(i)))
    }

    /// Integrates over one cell with this predictor; returns the traction at the rear.
    #[inline]
    fn advance(
        &self,
        y: f64,
        front: &Front,
        rear: Node,
        predictor: Traction,
        halvings: u32,
        visit: &mut impl FnMut(&Cell),
    ) -> Traction {
        let mut cell = Cell { ends: [rear.x, front.node.x], ..Cell::default() };
        let mut reached = predictor;
        if predictor.size > rear.bound {
            reached = slipping(front, &predictor, rear.bound);
            let per_length = cell.length().recip();
            cell.slip = std::array::from_fn(|i| {
                let change = reached.vector[i] - predictor.vector[i];
                self.springs.flexibility[i] * change * per_length
            });
            cell.slips = true;
        }
        let before = front.traction;
        cell.traction = std::array::from_fn(|i| 0.5 * (before.vector[i] + reached.vector[i]));
        cell.largest_traction = before.size.max(reached.size);
        if halvings > 0 && dot(cell.traction, cell.slip) > 0.0 {
            return self.halve(y, front, rear, halvings - 1, visit);
        }
        visit(&cell);
        reached
    }

    /// Integrates over both halves of a cell.
    #[cold]
    fn halve(
        &self,
        y: f64,
        front: &Front,
        rear: Node,
        halvings: u32,
        visit: &mut impl FnMut(&Cell),
    ) -> Traction {
        let middle =
            Node { x: 0.5 * (rear.x + front.node.x), bound: 0.5 * (rear.bound + front.node.bound) };
        let predictor = self.predictor(y, front, middle);
        let reached = self.advance(y, front, middle, predictor, halvings, visit);
        let front = Front { node: middle, traction: reached };
        let predictor = self.predictor(y, &front, rear);
        self.advance(y, &front, rear, predictor, halvings, visit)
    }
}

/// Traction at the rear of a cell that slips there, with this predictor and bound.
#[inline]
fn slipping(front: &Front, predictor: &Traction, bound: f64) -> Traction {
    let Traction { vector: before, size } = front.traction;
    let mut towards = *predictor;
    if size > 0.0 && size >= front.node.bound * (1.0 - AT_THE_BOUND) {
        let direction = before.map(|component| component / size);
        let along = bound + dot(predictor.vector, direction);
        if along > 0.0 {
            let slip = (predictor.size - bound) * (predictor.size + bound) / along;
            let vector = [0, 1].map(|i| predictor.vector[i] - 0.5 * slip * direction[i]);
            towards = Traction::of(vector);
        }
    }
    let share = bound / towards.size;
    Traction { vector: towards.vector.map(|component| component * share), size: bound }
}

/// Point at which a cell that sticks at its front begins to slip. |p + t d| = g + t e, with the
/// changes d of the traction and e of the bound over the cell, has one root t in (0, 1), since the
/// left side is smaller at t = 0 and larger at t = 1.
#[inline]
fn onset(front: &Front, rear: Node, predictor: &Traction) -> Option<Node> {
    let (node, traction) = (front.node, &front.traction);
    if predictor.size <= rear.bound || traction.size >= node.bound * (1.0 - AT_THE_BOUND) {
        return None;
    }
    let scale = predictor.size.max(node.bound);
    let (start, end) = (traction.vector.map(|p| p / scale), predictor.vector.map(|p| p / scale));
    let (bound, change) = (node.bound / scale, (rear.bound - node.bound) / scale);
    let difference = [end[0] - start[0], end[1] - start[1]];
    let square = dot(difference, difference) - change * change;
    let linear = dot(start, difference) - bound * change;
    let constant = bound * bound - dot(start, start);
    let root = (linear * linear + square * constant).max(0.0).sqrt();
    let share = constant / (linear + root);
    let inside = share > AT_THE_BOUND && share < 1.0 - AT_THE_BOUND;
    inside.then_some(Node {
        x: node.x - share * (node.x - rear.x),
        bound: node.bound + share * (rear.bound - node.bound),
    })
}

/// Tractions this close to the bound count as slipping, and parts of a cell this short are not
/// split off.
const AT_THE_BOUND: f64 = 1e-9;
/// Limit of halvings of a cell with the wrong sign: its length is then below rounding.
const HALVINGS: u32 = 50;

/// An end of a cell.
#[derive(Clone, Copy)]
struct Node {
    /// Coordinate x [m].
    x: f64,
    /// Traction bound [Pa].
    bound: f64,
}

/// A traction and its magnitude [Pa].
#[derive(Clone, Copy, Default)]
struct Traction {
    vector: [f64; 2],
    size: f64,
}

impl Traction {
    #[inline]
    fn of(vector: [f64; 2]) -> Self {
        Self { vector, size: norm(vector) }
    }
}

/// The front of a cell.
#[derive(Clone, Copy)]
struct Front {
    node: Node,
    traction: Traction,
}

/// Magnitude, computed without overflow or underflow.
pub fn norm(vector: [f64; 2]) -> f64 {
    const SAFE: std::ops::Range<f64> = 1e-280..1e280;
    let square = dot(vector, vector);
    if SAFE.contains(&square) { square.sqrt() } else { vector[0].hypot(vector[1]) }
}

/// Inner product.
pub fn dot(left: [f64; 2], right: [f64; 2]) -> f64 {
    left[0] * right[0] + left[1] * right[1]
}
