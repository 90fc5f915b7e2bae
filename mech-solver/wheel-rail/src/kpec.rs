//! KPEC: the normal contact by virtual penetration, corrected by an equivalent ellipse.
//!
//! The undeformed bodies penetrate each other by δ − h. They are taken to be in contact where they
//! penetrate by more than a share of δ. Kik and Piotrowski use one share for all patches, 0.45 δ.
//! Here the share varies across the patch such that an ellipse is reproduced. A is half the
//! curvature of the deepest row along x. B is that of the parabola across the patch which is as
//! wide as the penetration is at δ/2, about its middle y_m. Hertz's contact of A and B has the
//! semi-axes a and b at the approach δ. The region
//!
//! h < A a² − (A a² − B b²) (y − y_m)²/b², between 0 and δ,
//!
//! is in contact; for h = A x² + B y² this is the whole ellipse. The pressure of a row is half an
//! ellipse over its length 2l, proportional to √(l² − (x − x₀)²). All rows share one factor, chosen
//! such that the surfaces are displaced by δ where they penetrate deepest.
//!
//! The theory uses the deepest place and the ends of the penetration at δ/2. Its force therefore
//! jumps where these jump: where a second place becomes the deepest, or joins the region deeper
//! than δ/2.
//!
//! Sources: Kik, Piotrowski, A fast, approximate method to calculate normal load at contact between
//! wheel and rail, Proc. 2nd Mini Conf. on Contact Mechanics and Wear of Rail/Wheel Systems,
//! Budapest (1996); Piotrowski, Kik, Vehicle System Dynamics 46 (2008) 27–48; Vollebregt, User
//! guide for CONTACT (2022), for the correction. Deviation: positions, ends and lengths between
//! elements follow from parabolas, so that the force is continuous in the height of the wheel.

use super::local::Window;
use super::parabolas::{Deepest, Parabola, Parabolas};
use super::strips::{PressedStrip, write_pressure};
use elastic::Elasticity;
use elastic::hertz::elliptic_contact;
use half_space::influence::Influence;
use std::f64::consts::PI;

/// Share of the penetration at which its width is measured.
const HALF: f64 = 0.5;
/// Squared distance, relative to the squared diagonal of an element, beyond which an element acts
/// as a point load plus the moments of its extent. The relative error is 1e-5.
const FAR: f64 = 16.0;
/// Lower bound of half the curvature across [1/m].
pub(super) const FLATTEST: f64 = 0.1;

/// Strips of a contact, from right to left; empty if the bodies do not penetrate.
pub(super) fn strips(
    parabolas: &Parabolas,
    window: &Window,
    bodies: Elasticity,
) -> Vec<PressedStrip> {
    let Some(deepest) = parabolas.deepest() else { return Vec::new() };
    let approach = -deepest.parabola.gap;
    let level = Level::of(parabolas, &deepest, bodies.contact_compliance());
    let strip = |(row, own): (usize, &Parabola)| {
        let height = own.gap + approach;
        let square = (level.at(parabolas.along(row), approach) - height) / own.bend;
        let half_length = square.max(0.0).sqrt();
        (square > 0.0).then_some(PressedStrip {
            row,
            middle: own.place,
            half_length,
            pressure: half_length,
        })
    };
    let mut strips: Vec<PressedStrip> = parabolas.of_patch().filter_map(strip).collect();
    // Until here pressures have the unit of a length.
    let displaced = displacement(&strips, window, bodies, [deepest.parabola.place, deepest.along]);
    strips.iter_mut().for_each(|strip| strip.pressure *= approach / displaced);
    strips
}

/// Height below which the bodies touch, as a function of the row.
struct Level {
    /// Level in the middle, and its decrease at b [m].
    middle: f64,
    less: f64,
    place: f64,
    semi_axis_b: f64,
}

impl Level {
    fn of(parabolas: &Parabolas, deepest: &Deepest, compliance: f64) -> Self {
        let approach = -deepest.parabola.gap;
        let ends = [false, true].map(|up| end(parabolas, deepest, up));
        let place = 0.5 * (ends[0] + ends[1]);
        let half = 0.5 * (ends[1] - ends[0]);
        let [bend_x, bend_y] =
            [deepest.parabola.bend, (HALF * approach / (half * half)).max(FLATTEST)];
        let unit = elliptic_contact(bend_x, bend_y, 1.0, compliance);
        let square = |axis: f64| axis * axis * approach / unit.approach;
        let [a2, b2] = [square(unit.semi_axis_a), square(unit.semi_axis_b)];
        let less = bend_x * a2 - bend_y * b2;
        Self { middle: bend_x * a2, less, place, semi_axis_b: b2.sqrt() }
    }

    fn at(&self, along: f64, approach: f64) -> f64 {
        let off = (along - self.place) / self.semi_axis_b;
        (self.middle - self.less * off * off).clamp(0.0, approach)
    }
}

/// Position where the penetration of a patch last falls below δ/2, to the left or to the right [m].
fn end(parabolas: &Parabolas, deepest: &Deepest, up: bool) -> f64 {
    let gap = deepest.parabola.gap;
    let inside = |(row, own): (usize, &Parabola)| (own.gap <= (1.0 - HALF) * gap).then_some(row);
    let mut rows = parabolas.of_patch().filter_map(inside);
    // The square root of the height over the deepest place is linear in the distance if the shape
    // is a parabola.
    let root = |own: &Parabola| (own.gap - gap).max(0.0).sqrt();
    let level = (-HALF * gap).sqrt();
    let (last, sign) = if up { (rows.last(), 1.0) } else { (rows.next(), -1.0) };
    let Some(last) = last else {
        // Narrower than a row: use the width of a parabola through the neighbouring row.
        let beside = if up { Some(deepest.row + 1) } else { deepest.row.checked_sub(1) };
        let rise = parabolas.at(beside).map_or(level, root).max(f64::MIN_POSITIVE);
        return deepest.along + sign * parabolas.spacing * (level / rise).min(1.0);
    };
    let next = if up { Some(last + 1) } else { last.checked_sub(1) };
    let own = parabolas.at(Some(last)).map_or(0.0, root);
    let share = match parabolas.at(next).map(root) {
        Some(next) if next > own => ((level - own) / (next - own)).clamp(0.0, 1.0),
        _ => 0.5,
    };
    parabolas.along(last) + sign * share * parabolas.spacing
}

/// Displacement of the surfaces at a point of the patch by the pressure of the strips [m].
fn displacement(
    strips: &[PressedStrip],
    window: &Window,
    bodies: Elasticity,
    [x, along]: [f64; 2],
) -> f64 {
    let influence = Influence::of_elements(window.sides, bodies);
    let [nx, _] = window.counts();
    let mut pressure = vec![0.0; window.points()];
    write_pressure(strips, window, 1.0, &mut pressure);
    let pressed = pressure.iter().enumerate().filter(|(_, p)| **p > 0.0);
    let [dx, dy] = window.sides;
    let of = |(at, p): (usize, &f64)| {
        let [i, j] = [at % nx, at / nx];
        let [x, y] = [x - window.along(0, i), along - window.along(1, j)];
        let square = x * x + y * y;
        if square < FAR * (dx * dx + dy * dy) {
            return p * influence.zz_at(x, y);
        }
        // Point load in the middle, corrected for its extent.
        let spread = (dx * dx * (3.0 * x * x - square) + dy * dy * (3.0 * y * y - square))
            / (24.0 * square * square);
        p * bodies.contact_compliance() / PI * dx * dy * (1.0 + spread) / square.sqrt()
    };
    pressed.map(of).sum()
}
