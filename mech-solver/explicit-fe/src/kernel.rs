//! Forces of a row of elements from the displacements of its four rows of nodes, vectorised along
//! the row.
//!
//! All quantities are in the frame of the element's middle. û are the sums of the displacements
//! over the Hadamard vectors ([`super::shape`]), H is their gradient, E = (H + Hᵀ + HᵀH)/2 Green's
//! strain, S = λ tr E + 2μE the stress (St. Venant & Kirchhoff), and P = (1 + H) S. Hourglass modes
//! are q_m = û_m − Σ_r X_mr H_r with the sums X of the positions. No linear field excites them, and
//! k q resists them. Forces follow by the transpose of these operations. A rigid motion of any
//! angle causes no force.
//!
//! A material that flows ([`Flow`]) has plastic strains e and the stress S = λ tr E + 2μ(E − e), by
//! a radial return to the yield surface of von Mises with linear isotropic and kinematic hardening.
//! In units of strain, with ξ = dev E − (1 + H_k/3μ) e,
//!
//! Δγ = max(0, |ξ| − √(2/3) (σ_y + H_i κ)/2μ)/(1 + (H_i + H_k)/3μ), e += Δγ ξ/|ξ|, κ += √(2/3) Δγ,
//!
//! because linear kinematic hardening gives the back stress (2/3) H_k e. The plastic work is σ_y
//! κ + H_i κ²/2 + H_k e:e/3, independent of the path (Simo & Hughes, Computational Inelasticity
//! (1998), box 3.1).
//!
//! Elements that have a share s of the stiffness and a share r of the yield stress use sλ, sμ, a
//! bound of √(2/3) (r σ_y + s H_i κ)/2sμ, and sk: the hardening moduli fall with the stiffness.
//!
//! The nodes of both ends of an element in a rolling body have their displacements in directions
//! that are turned by half an angle to either side of those of the middle.
//!
//! Source: Flanagan & Belytschko 1981 ("stiffness" form), total Lagrangian. Deviation: forces and
//! displacements are never gathered element by element. Along a row both are contiguous, and an
//! element's far end is its neighbour's near end.

use super::shape::Shape;
use pulp::{Simd, WithSimd};

/// Granularity of a row: the number of its elements is a multiple of this, whatever vectors the
/// machine has.
pub const LANES: usize = 8;

/// Plastic strains xx, yy, xy, yz, xz of an element, and κ.
pub const PLASTIC: usize = 6;

/// Plastic flow of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flow {
    /// Yield stress σ_y [Pa].
    pub yield_stress: f64,
    /// Moduli of linear isotropic and kinematic hardening, H_i and H_k: stress per plastic strain
    /// [Pa].
    pub hardening: [f64; 2],
}

/// Stiffness of the elements of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffness {
    /// Shape of the elements.
    pub shape: Shape,
    /// λV and μV [N·m].
    pub lame: [f64; 2],
    /// Stiffness of the hourglass modes [N/m].
    pub hourglass: f64,
    /// √(2/3) σ_y/2μ, H_i/3μ and H_k/3μ; 0 for a material that does not flow.
    pub flow: [f64; 3],
}

impl Stiffness {
    /// Creates the stiffness of a shape, with Lamé's constants λ and μ [Pa] and the share of the
    /// shear modulus that resists hourglass modes.
    #[must_use]
    pub fn new(shape: Shape, [lambda, mu]: [f64; 2], share: f64, flow: Option<Flow>) -> Self {
        let volume = shape.volume;
        let hourglass = share * mu * volume * shape.squares / 64.0;
        let flow =
            flow.map_or([0.0; 3], |Flow { yield_stress, hardening: [isotropic, kinematic] }| {
                let root = (2.0_f64 / 3.0).sqrt();
                [root * yield_stress / (2.0 * mu), isotropic / (3.0 * mu), kinematic / (3.0 * mu)]
            });
        Self { shape, lame: [lambda * volume, mu * volume], hourglass, flow }
    }
}

/// Components of a vector at the nodes of four rows: corner by corner; along, across and into the
/// body.
pub type Rows<T> = [[T; 3]; 4];

/// Row of elements and its rows of nodes, one node longer and padded to a multiple of [`LANES`]
/// beyond that.
pub struct Row<'a> {
    /// Number of elements.
    pub elements: usize,
    /// Stiffness of the elements.
    pub stiffness: &'a Stiffness,
    /// Displacements [m].
    pub displacement: Rows<&'a [f64]>,
    /// Shares of the stiffness and of the yield stress of each element; empty if all elements have
    /// the full values.
    pub shares: [&'a [f64]; 2],
}

/// Adds the forces of a row [N] to those of its rows of nodes.
pub struct Forces<'a, const CURVED: bool, const FLOWS: bool, const SOFTER: bool> {
    /// Row of elements.
    pub row: Row<'a>,
    /// Resisting forces at the nodes.
    pub force: Rows<&'a mut [f64]>,
    /// Plastic strains of the elements, one array after the other; empty for a material that does
    /// not flow.
    pub plastic: &'a mut [f64],
}

/// Computes the elastic energy of a row [J]: of the strain, and of the hourglass modes.
pub struct Energy<'a, const CURVED: bool, const FLOWS: bool, const SOFTER: bool> {
    /// Row of elements.
    pub row: Row<'a>,
    /// Plastic strains of the elements, as in [`Forces`].
    pub plastic: &'a [f64],
}

impl<const CURVED: bool, const FLOWS: bool, const SOFTER: bool> WithSimd
    for Forces<'_, CURVED, FLOWS, SOFTER>
{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, s: S) {
        let Self { row, force, plastic } = self;
        let lanes = S::F64_LANES;
        let groups = row.elements / lanes;
        let whole = LaneMaterial::new(s, row.stiffness);
        let shares = row.shares.map(|shares| S::as_simd_f64s(shares).0);
        let [near, far] = [0, 1].map(|from| views::<S>(&row.displacement, from, groups));
        let mut out = force.map(|row| row.map(|row| &mut S::as_mut_simd_f64s(row).0[..=groups]));
        let plastic = S::as_mut_simd_f64s(plastic).0;
        let zero = s.splat_f64s(0.0);
        let first = s.mask_between_m64s(0, 1).mask();
        // Forces that the far ends of the previous elements exert on the first node.
        let mut carried = [[zero; 3]; 4];
        #[allow(clippy::needless_range_loop, reason = "it indexes rows of six vectors alike")]
        for group in 0..groups {
            let material = &whole.of_group::<SOFTER>(s, &shares, group);
            let ends = Ends::read(s, &near, &far, group).turned::<CURVED>(s, material);
            let mut strains = [zero; PLASTIC];
            if FLOWS {
                for (k, strain) in strains.iter_mut().enumerate() {
                    *strain = plastic[k * groups + group];
                }
            }
            let Answer { mut ends, .. } = answer::<S, FLOWS>(s, material, &ends, &mut strains);
            if FLOWS {
                for (k, strain) in strains.iter().enumerate() {
                    plastic[k * groups + group] = *strain;
                }
            }
            ends = ends.turned_back::<CURVED>(s, material);
            for corner in 0..4 {
                for k in 0..3 {
                    let (sum, difference) = (ends.sum[corner][k], ends.difference[corner][k]);
                    let far = s.rotate_right_f64s(s.add_f64s(sum, difference), 1);
                    let from = s.select_f64s(first, carried[corner][k], far);
                    carried[corner][k] = far;
                    let own = s.add_f64s(s.sub_f64s(sum, difference), from);
                    out[corner][k][group] = s.add_f64s(out[corner][k][group], own);
                }
            }
        }
        for (out, carried) in out.iter_mut().flatten().zip(carried.iter().flatten()) {
            let last = s.select_f64s(first, *carried, zero);
            out[groups] = s.add_f64s(out[groups], last);
        }
    }
}

impl<const CURVED: bool, const FLOWS: bool, const SOFTER: bool> WithSimd
    for Energy<'_, CURVED, FLOWS, SOFTER>
{
    type Output = [f64; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, s: S) -> [f64; 2] {
        let Self { row, plastic } = self;
        let plastic = S::as_simd_f64s(plastic).0;
        let groups = row.elements / S::F64_LANES;
        let whole = LaneMaterial::new(s, row.stiffness);
        let shares = row.shares.map(|shares| S::as_simd_f64s(shares).0);
        let [near, far] = [0, 1].map(|from| views::<S>(&row.displacement, from, groups));
        let mut sums = [s.splat_f64s(0.0); 2];
        for group in 0..groups {
            let material = &whole.of_group::<SOFTER>(s, &shares, group);
            let ends = Ends::read(s, &near, &far, group).turned::<CURVED>(s, material);
            let strain =
                |k: usize| if FLOWS { plastic[k * groups + group] } else { s.splat_f64s(0.0) };
            let mut strains = std::array::from_fn(strain);
            let Answer { energy, .. } = answer::<S, FLOWS>(s, material, &ends, &mut strains);
            for k in 0..2 {
                sums[k] = s.add_f64s(sums[k], energy[k]);
            }
        }
        sums.map(|sum| s.reduce_sum_f64s(sum))
    }
}

/// Vectors of the rows from a node on.
#[inline(always)]
fn views<'a, S: Simd>(rows: &Rows<&'a [f64]>, from: usize, groups: usize) -> Rows<&'a [S::f64s]> {
    let length = groups * S::F64_LANES;
    rows.map(|row| row.map(|row| &S::as_simd_f64s(&row[from..from + length]).0[..groups]))
}

/// Constants of a row, broadcast to all lanes.
#[derive(Clone, Copy)]
struct LaneMaterial<S: Simd> {
    along: [S::f64s; 4],
    across: [[S::f64s; 3]; 2],
    twist: [S::f64s; 3],
    bend: [S::f64s; 2],
    lame: [S::f64s; 2],
    hourglass: S::f64s,
    flow: [S::f64s; 3],
    turn: [S::f64s; 2],
}

impl<S: Simd> LaneMaterial<S> {
    #[inline(always)]
    fn new(s: S, stiffness: &Stiffness) -> Self {
        let all = |value: f64| s.splat_f64s(value);
        let Stiffness { shape, lame, hourglass, flow } = stiffness;
        Self {
            along: shape.along.map(all),
            across: shape.across.map(|row| row.map(all)),
            twist: shape.twist.map(all),
            bend: shape.bend.map(all),
            lame: lame.map(all),
            hourglass: all(*hourglass),
            flow: flow.map(all),
            turn: [all(shape.half_angle.cos()), all(shape.half_angle.sin())],
        }
    }
}

impl<S: Simd> LaneMaterial<S> {
    /// Constants of a group of elements, scaled by their shares of stiffness and yield stress if
    /// they are softer.
    #[inline(always)]
    fn of_group<const SOFTER: bool>(&self, s: S, shares: &[&[S::f64s]; 2], group: usize) -> Self {
        if !SOFTER {
            return *self;
        }
        let [stiffness, yields] = shares.map(|shares| shares[group]);
        let [stress, isotropic, kinematic] = self.flow;
        let stress = s.mul_f64s(stress, s.div_f64s(yields, stiffness));
        Self {
            lame: self.lame.map(|lame| s.mul_f64s(stiffness, lame)),
            hourglass: s.mul_f64s(stiffness, self.hourglass),
            flow: [stress, isotropic, kinematic],
            ..*self
        }
    }
}

/// Sums and differences of both ends along ξ, at the four corners; for forces, halves of them.
struct Ends<S: Simd> {
    sum: Rows<S::f64s>,
    difference: Rows<S::f64s>,
}

impl<S: Simd> Ends<S> {
    #[inline(always)]
    fn read(s: S, near: &Rows<&[S::f64s]>, far: &Rows<&[S::f64s]>, group: usize) -> Self {
        let zero = s.splat_f64s(0.0);
        let mut ends = Self { sum: [[zero; 3]; 4], difference: [[zero; 3]; 4] };
        for corner in 0..4 {
            for k in 0..3 {
                let (near, far) = (near[corner][k][group], far[corner][k][group]);
                ends.sum[corner][k] = s.add_f64s(near, far);
                ends.difference[corner][k] = s.sub_f64s(far, near);
            }
        }
        ends
    }

    /// Rotates from the directions of the nodes to those of the middle.
    #[inline(always)]
    fn turned<const CURVED: bool>(mut self, s: S, material: &LaneMaterial<S>) -> Self {
        if !CURVED {
            return self;
        }
        let [c, sine] = material.turn;
        for (sum, difference) in self.sum.iter_mut().zip(&mut self.difference) {
            let ([x, _, z], [dx, _, dz]) = (*sum, *difference);
            sum[0] = s.negate_mul_add_f64s(sine, dz, s.mul_f64s(c, x));
            difference[0] = s.negate_mul_add_f64s(sine, z, s.mul_f64s(c, dx));
            sum[2] = s.mul_add_f64s(sine, dx, s.mul_f64s(c, z));
            difference[2] = s.mul_add_f64s(sine, x, s.mul_f64s(c, dz));
        }
        self
    }

    /// Transpose of [`Ends::turned`].
    #[inline(always)]
    fn turned_back<const CURVED: bool>(mut self, s: S, material: &LaneMaterial<S>) -> Self {
        if !CURVED {
            return self;
        }
        let [c, sine] = material.turn;
        for (sum, difference) in self.sum.iter_mut().zip(&mut self.difference) {
            let ([x, _, z], [dx, _, dz]) = (*sum, *difference);
            sum[0] = s.mul_add_f64s(sine, dz, s.mul_f64s(c, x));
            difference[0] = s.mul_add_f64s(sine, z, s.mul_f64s(c, dx));
            sum[2] = s.negate_mul_add_f64s(sine, dx, s.mul_f64s(c, z));
            difference[2] = s.negate_mul_add_f64s(sine, x, s.mul_f64s(c, dz));
        }
        self
    }
}

/// Sum, η, ζ and ηζ of four corners.
#[inline(always)]
fn hadamard<S: Simd>(s: S, [a, b, c, d]: [S::f64s; 4]) -> [S::f64s; 4] {
    let (near, near_eta) = (s.add_f64s(b, a), s.sub_f64s(b, a));
    let (deep, deep_eta) = (s.add_f64s(d, c), s.sub_f64s(d, c));
    [
        s.add_f64s(near, deep),
        s.add_f64s(near_eta, deep_eta),
        s.sub_f64s(deep, near),
        s.sub_f64s(deep_eta, near_eta),
    ]
}

/// Response of elements to displacements: forces, and energies of strain and hourglass modes.
struct Answer<S: Simd> {
    ends: Ends<S>,
    energy: [S::f64s; 2],
}

/// a·b + c·d + e·f + g.
#[inline(always)]
fn products<S: Simd>(s: S, [a, b, c, d, e, f, g]: [S::f64s; 7]) -> S::f64s {
    s.mul_add_f64s(a, b, s.mul_add_f64s(c, d, s.mul_add_f64s(e, f, g)))
}

/// Updates the plastic strains by radial return, and subtracts them from the strains.
#[inline(always)]
fn yielding<S: Simd>(
    s: S,
    [stress, isotropic, kinematic]: &[S::f64s; 3],
    plastic: &mut [S::f64s; PLASTIC],
    normal: &mut [S::f64s; 3],
    shear: &mut [S::f64s; 3],
) {
    let all = |value: f64| s.splat_f64s(value);
    let (one, half) = (all(1.0), all(0.5));
    let mean = s.mul_f64s(all(1.0 / 3.0), s.add_f64s(normal[0], s.add_f64s(normal[1], normal[2])));
    let [pxx, pyy, pxy, pyz, pxz, grown] = *plastic;
    let shared = s.add_f64s(one, *kinematic);
    // ξ of xx, yy, xy, yz, xz; that of zz makes the trace zero.
    let away = |strain: S::f64s, plastic: S::f64s| s.negate_mul_add_f64s(shared, plastic, strain);
    let xi = [
        away(s.sub_f64s(normal[0], mean), pxx),
        away(s.sub_f64s(normal[1], mean), pyy),
        away(s.mul_f64s(half, shear[0]), pxy),
        away(s.mul_f64s(half, shear[1]), pyz),
        away(s.mul_f64s(half, shear[2]), pxz),
    ];
    let zz = s.add_f64s(xi[0], xi[1]);
    let normals = products(s, [xi[0], xi[0], xi[1], xi[1], zz, zz, all(0.0)]);
    let shears = products(s, [xi[2], xi[2], xi[3], xi[3], xi[4], xi[4], all(0.0)]);
    let squares = s.mul_add_f64s(all(2.0), shears, normals);
    let size = s.max_f64s(s.sqrt_f64s(squares), all(f64::MIN_POSITIVE));
    // √(2/3) H_i κ/2μ is √(3/2) κ times H_i/3μ.
    let root = all(1.5_f64.sqrt());
    let bound = s.mul_add_f64s(s.mul_f64s(root, *isotropic), grown, *stress);
    let beyond = s.max_f64s(s.sub_f64s(size, bound), all(0.0));
    let more = s.div_f64s(beyond, s.add_f64s(shared, *isotropic));
    let scale = s.div_f64s(more, size);
    for (plastic, xi) in plastic.iter_mut().zip(xi) {
        *plastic = s.mul_add_f64s(scale, xi, *plastic);
    }
    plastic[5] = s.mul_add_f64s(all((2.0_f64 / 3.0).sqrt()), more, grown);
    let [pxx, pyy, pxy, pyz, pxz, _] = *plastic;
    normal[0] = s.sub_f64s(normal[0], pxx);
    normal[1] = s.sub_f64s(normal[1], pyy);
    normal[2] = s.add_f64s(normal[2], s.add_f64s(pxx, pyy));
    for (shear, plastic) in shear.iter_mut().zip([pxy, pyz, pxz]) {
        *shear = s.negate_mul_add_f64s(all(2.0), plastic, *shear);
    }
}

#[inline(always)]
fn answer<S: Simd, const FLOWS: bool>(
    s: S,
    material: &LaneMaterial<S>,
    ends: &Ends<S>,
    plastic: &mut [S::f64s; PLASTIC],
) -> Answer<S> {
    let LaneMaterial { along, across: [by, bz], twist, bend, lame, hourglass, flow, .. } = material;
    let (zero, half) = (s.splat_f64s(0.0), s.splat_f64s(0.5));
    let mut h = [[zero; 3]; 3];
    // Modes ξη, ξζ, ξηζ and ηζ of every component, then the forces that resist them.
    let mut q = [[zero; 4]; 3];
    let mut resisted = zero;
    for k in 0..3 {
        let corners = |rows: &Rows<S::f64s>| [rows[0][k], rows[1][k], rows[2][k], rows[3][k]];
        let even = hadamard(s, corners(&ends.sum));
        let odd = hadamard(s, corners(&ends.difference));
        let mut hx = s.mul_f64s(along[0], odd[0]);
        for m in 1..4 {
            hx = s.mul_add_f64s(along[m], odd[m], hx);
        }
        let (mut hy, mut hz) = (s.mul_f64s(by[0], even[1]), s.mul_f64s(bz[0], even[1]));
        for m in 1..3 {
            hy = s.mul_add_f64s(by[m], even[m + 1], hy);
            hz = s.mul_add_f64s(bz[m], even[m + 1], hz);
        }
        for m in 0..3 {
            q[k][m] = s.negate_mul_add_f64s(twist[m], hx, odd[m + 1]);
        }
        let bent = s.negate_mul_add_f64s(bend[0], hy, even[3]);
        q[k][3] = s.negate_mul_add_f64s(bend[1], hz, bent);
        for q in &mut q[k] {
            resisted = s.mul_add_f64s(*q, *q, resisted);
            *q = s.mul_f64s(*hourglass, *q);
        }
        h[k] = [hx, hy, hz];
    }
    let [[h00, h01, h02], [h10, h11, h12], [h20, h21, h22]] = h;
    let strain = |a: [S::f64s; 3], own: S::f64s| {
        s.mul_add_f64s(half, products(s, [a[0], a[0], a[1], a[1], a[2], a[2], zero]), own)
    };
    let mut normal =
        [strain([h00, h10, h20], h00), strain([h01, h11, h21], h11), strain([h02, h12, h22], h22)];
    // Twice the shear strains.
    let mut shear = [
        products(s, [h00, h01, h10, h11, h20, h21, s.add_f64s(h01, h10)]),
        products(s, [h01, h02, h11, h12, h21, h22, s.add_f64s(h12, h21)]),
        products(s, [h00, h02, h10, h12, h20, h22, s.add_f64s(h02, h20)]),
    ];
    if FLOWS {
        yielding(s, flow, plastic, &mut normal, &mut shear);
    }
    let ([e0, e1, e2], [g01, g12, g02]) = (normal, shear);
    let [lambda, mu] = *lame;
    let trace = s.mul_f64s(lambda, s.add_f64s(e0, s.add_f64s(e1, e2)));
    let twice = s.add_f64s(mu, mu);
    let [s00, s11, s22] = [e0, e1, e2].map(|e| s.mul_add_f64s(twice, e, trace));
    let [s01, s12, s02] = [g01, g12, g02].map(|g| s.mul_f64s(mu, g));
    let stress = [[s00, s01, s02], [s01, s11, s12], [s02, s12, s22]];
    let strained = products(s, [s00, e0, s11, e1, s22, e2, zero]);
    let strained = products(s, [s01, g01, s12, g12, s02, g02, strained]);
    let energy = [s.mul_f64s(half, strained), s.mul_f64s(half, s.mul_f64s(*hourglass, resisted))];

    let mut ends = Ends::<S> { sum: [[zero; 3]; 4], difference: [[zero; 3]; 4] };
    for k in 0..3 {
        let [hx, hy, hz] = h[k];
        let mut p = [zero; 3];
        for (r, p) in p.iter_mut().enumerate() {
            *p = products(s, [hx, stress[0][r], hy, stress[1][r], hz, stress[2][r], stress[k][r]]);
        }
        let [mut px, mut py, mut pz] = p;
        for m in 0..3 {
            px = s.negate_mul_add_f64s(q[k][m], twist[m], px);
        }
        py = s.negate_mul_add_f64s(q[k][3], bend[0], py);
        pz = s.negate_mul_add_f64s(q[k][3], bend[1], pz);
        let odd = [
            s.mul_f64s(px, along[0]),
            s.mul_add_f64s(px, along[1], q[k][0]),
            s.mul_add_f64s(px, along[2], q[k][1]),
            s.mul_add_f64s(px, along[3], q[k][2]),
        ];
        let even = [
            s.mul_add_f64s(py, by[0], s.mul_f64s(pz, bz[0])),
            s.mul_add_f64s(py, by[1], s.mul_f64s(pz, bz[1])),
            s.mul_add_f64s(py, by[2], s.mul_add_f64s(pz, bz[2], q[k][3])),
        ];
        let (sub_scaled, more) = (s.sub_f64s(odd[0], odd[1]), s.add_f64s(odd[0], odd[1]));
        let (deep_less, deep_more) = (s.sub_f64s(odd[2], odd[3]), s.add_f64s(odd[2], odd[3]));
        ends.difference[0][k] = s.sub_f64s(sub_scaled, deep_less);
        ends.difference[1][k] = s.sub_f64s(more, deep_more);
        ends.difference[2][k] = s.add_f64s(sub_scaled, deep_less);
        ends.difference[3][k] = s.add_f64s(more, deep_more);
        let (sub_scaled, more) = (s.sub_f64s(even[1], even[2]), s.add_f64s(even[1], even[2]));
        ends.sum[0][k] = s.sub_f64s(s.sub_f64s(zero, even[0]), sub_scaled);
        ends.sum[1][k] = s.sub_f64s(even[0], more);
        ends.sum[2][k] = s.sub_f64s(sub_scaled, even[0]);
        ends.sum[3][k] = s.add_f64s(even[0], more);
    }
    Answer { ends, energy }
}
