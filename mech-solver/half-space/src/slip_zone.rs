//! Slip zones at the trailing edges of rows, resolved below the size of their elements.
//!
//! An element either sticks or slips, and its friction power is a mean. Where the slip zone is a
//! few elements wide, the border of adhesion and the density of the power are not known that way.
//! They follow from the sum of the power of a row, which is accurate to half a per cent in a zone
//! of one element.
//!
//! **Shape.** In a row with the trailing edge x_t and the leading edge x_l = x_t + 2c, the traction
//! bound is a half ellipse, g = k √((x − x_t)(x_l − x)). In Carter's strip the slip grows like a
//! root from the border of adhesion x_b = x_t + L, and the friction power is
//!
//! q = V C k² (x_l − x) √((x − x_t)(x_b − x)),   P = ∫ q dx = V C k² (π/8) L² (2c − L/2),
//!
//! with the compliance C of a half-plane: 2(1 − ν)/G along x, 2/G along y. The border and the edge
//! of an ellipse are inclined by ψ against y. Traction and slip along the unit vector e, with the
//! components e_n across the edge and e_t along it, then have
//! C = cos ψ (2(1 − ν) e_n² + 2 e_t²)/G, exactly for narrow zones and pure e_n or e_t.
//!
//! **Border.** A zone of up to three elements has the width that its power gives. In wider zones
//! the squares of the slip at the second and the third element from the border lie on a straight
//! line, s² ∝ (x_b − x)(x_l − x). Fromm's difference displaces its zero upstream by 0.20
//! elements, whatever the width and the position of the edges (Carter's strip: ± 0.03). The border
//! is at most half an element beyond the centres of the elements that slip and stick.
//!
//! **Power.** Between the edge and the border the density is that of the strip times the ratio of
//! the computed power to it, interpolated between the inner elements; narrow zones have none.
//! Numerical dissipation is included, and the sum stays.
//!
//! **Rows.** Trailing edges are ragged: an element is in contact if its centre is. In narrow zones
//! the powers of neighbouring rows err by 5 to 15 % in turn, and their means by 3 %. Neighbours
//! with narrow zones therefore exchange a quarter of their difference. This smooths the power
//! across by an error of second order.
//!
//! Source: F. W. Carter, Proc. Roy. Soc. A 112 (1926) 151. The application is this project's.

use super::aligned::{AlignedGrid, Chord};
use super::leading_edge::interpolated;
use super::tangential::{ElementState, TangentialState};
use elastic::Elasticity;
use grids::Structured;
use numerics::search::root_between;
use std::f64::consts::PI;

/// Least number of slipping elements from which the border follows from their slip.
const WIDE: usize = 4;
/// Displacement of the border that follows from the slip, by Fromm's difference [elements].
const DISPLACED: f64 = 0.20;
/// Distance of inner elements from the ends of the zone [elements].
const INNER: f64 = 1.5;

/// Least width of a zone [elements].
const NARROWEST: f64 = 0.01;

/// Contact in rows with known edges, and its tractions and slip.
#[derive(Clone, Copy, Debug)]
pub struct SlippingRows<'a> {
    /// Grid of the tractions.
    pub rows: &'a AlignedGrid,
    /// Edges of each row in contact.
    pub chords: &'a [Option<Chord>],
    /// Tractions, and slip over an element's length.
    pub state: &'a TangentialState,
    /// Traction bound [Pa].
    pub bound: &'a [f64],
    /// Constants of the bodies.
    pub elasticity: Elasticity,
    /// Speed of rolling [m/s].
    pub speed: f64,
}

/// Slip zone at the trailing edge of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrailingZone {
    /// Trailing edge of the contact [m].
    pub trailing: f64,
    /// Border of adhesion [m].
    pub border: f64,
    /// Leading edge of the contact [m].
    pub leading: f64,
    /// Friction power per width of the row [W/m].
    pub power: f64,
}

impl TrailingZone {
    /// Width along x [m].
    #[must_use]
    pub fn width(&self) -> f64 {
        self.border - self.trailing
    }

    /// Mean over an element of this centre and side of (x_l − x) √((x − x_t)(x_b − x)) [m²].
    fn mean(&self, x: f64, side: f64) -> f64 {
        let half = 0.5 * self.width();
        let middle = self.trailing + half;
        let integral = |x: f64| {
            let s = ((x - middle) / half).clamp(-1.0, 1.0);
            let root = (1.0 - s * s).max(0.0).sqrt();
            let area = 0.5 * half * half * (s * root + s.asin());
            (self.leading - middle) * area + (half * root).powi(3) / 3.0
        };
        (integral(x + 0.5 * side) - integral(x - 0.5 * side)) / side
    }
}

impl SlippingRows<'_> {
    /// Returns the slip zone of each row at its trailing edge, and a friction power [W/m²] on the
    /// regular grid.
    /// Rows without such a zone, and slip elsewhere, leave by overlap of elements.
    #[must_use]
    pub fn power_on_grid(&self, power: &[f64]) -> (Vec<Option<TrailingZone>>, Vec<f64>) {
        let nx = self.rows.grid().ni;
        let mut elsewhere = power.to_vec();
        let rows = elsewhere.chunks_exact_mut(nx).enumerate();
        let mut sums: Vec<_> = rows.map(|(row, power)| self.take(row, power)).collect();
        self.exchange(&mut sums);
        let zone = |(row, sum): (usize, Option<f64>)| sum.map(|sum| self.zone(row, sum));
        let zones: Vec<_> = sums.into_iter().enumerate().map(zone).collect();
        let mut onto_grid = self.rows.onto_grid(&elsewhere);
        let rows = onto_grid.chunks_exact_mut(nx).zip(power.chunks_exact(nx)).enumerate();
        for (row, (values, power)) in rows {
            if let Some(zone) = &zones[row] {
                self.add(row, zone, power, values);
            }
        }
        (zones, onto_grid)
    }

    /// Adds the power of a zone to a row of the regular grid.
    fn add(&self, row: usize, zone: &TrailingZone, power: &[f64], values: &mut [f64]) {
        let grid = self.rows.grid();
        let (side, offset) = (grid.dx(), self.rows.offset(row));
        let inner = |x: f64| x - INNER * side > zone.trailing && x + INNER * side < zone.border;
        let ratio = |(i, q): (usize, &f64)| {
            let x = grid.x(i) + offset;
            inner(x).then(|| (i, q / zone.mean(x, side)))
        };
        let ratios: Vec<(usize, f64)> = power.iter().enumerate().filter_map(ratio).collect();
        let at = |i: usize| interpolated(&ratios, i as f64 - offset / side);
        let density = |i: usize| zone.mean(grid.x(i), side) * at(i);
        let densities: Vec<f64> = (0..values.len()).map(density).collect();
        let scale = zone.power / (densities.iter().sum::<f64>() * side);
        values.iter_mut().zip(densities).for_each(|(value, density)| *value += scale * density);
    }

    /// Takes the power of the slip zone at the trailing edge from the elements of a row [W/m²]:
    /// all but that of slip elsewhere. `None` for rows without adhesion or with unknown edges, and
    /// where slip elsewhere has more power. Under spin, elements at the edge may stick behind a
    /// slip zone, and the numerical dissipation of the row would heat them.
    fn take(&self, row: usize, power: &mut [f64]) -> Option<f64> {
        let (_, stick) = self.chords.get(row).copied().flatten().zip(self.first_stick(row))?;
        let elements = self.elements(row);
        let slips = |i: usize| i > stick && elements[i] == ElementState::Slip;
        let own = || (0..power.len()).filter(|i| !slips(*i));
        let sum: f64 = own().map(|i| power[i]).sum();
        let upstream: f64 = (0..power.len()).filter(|i| slips(*i)).map(|i| power[i]).sum();
        if sum <= 0.0 || upstream > power[..stick].iter().sum() {
            return None;
        }
        let own: Vec<usize> = own().collect();
        own.into_iter().for_each(|i| power[i] = 0.0);
        Some(sum)
    }

    /// Moves a quarter of the difference of the powers of neighbouring rows with narrow zones.
    fn exchange(&self, sums: &mut [Option<f64>]) {
        let narrow = |row: usize| self.slipping(row).is_some_and(|count| count < WIDE);
        let before = sums.to_vec();
        for row in 1..sums.len() {
            if let (Some(low), Some(high)) = (before[row - 1], before[row])
                && (narrow(row - 1) || narrow(row))
            {
                let moved = 0.25 * (high - low);
                sums[row - 1] = sums[row - 1].map(|sum| sum + moved);
                sums[row] = sums[row].map(|sum| sum - moved);
            }
        }
    }

    /// Slip zone of a row with this sum of powers [W/m²], that slips at its trailing edge or, on a
    /// coarse grid, should.
    fn zone(&self, row: usize, sum: f64) -> TrailingZone {
        let grid = self.rows.grid();
        let chord = self.chords[row].expect("rows with a power have edges");
        let stick = self.first_stick(row).expect("rows with a power stick");
        let count = self.slipping(row).unwrap_or(0);
        let zone = |width: f64| TrailingZone {
            trailing: chord.trailing,
            border: chord.trailing + width,
            leading: chord.leading,
            power: sum * grid.dx(),
        };
        let place = |i: usize| grid.x(i) + self.rows.offset(row) - chord.trailing;
        let least = if count > 0 { place(stick - 1) } else { 0.0 };
        let [least, most] = [least - 0.5 * grid.dx(), place(stick) + 0.5 * grid.dx()];
        let width = match count {
            WIDE.. => self.width_by_slip(row, stick, &chord),
            _ => self
                .width_by_power(row, stick - count..stick + 1, &zone(0.0))
                .unwrap_or_else(|| place(stick)),
        };
        let width = width.max(least).min(most).min(chord.leading - chord.trailing);
        zone(width.max(NARROWEST * grid.dx()))
    }

    /// Width of a zone by the slip of the second and the third element from the border.
    fn width_by_slip(&self, row: usize, stick: usize, chord: &Chord) -> f64 {
        let grid = self.rows.grid();
        let x = |i: usize| grid.x(i) + self.rows.offset(row);
        let [slip_x, slip_y] = &self.state.slip;
        let square = |i: usize| {
            let at = row * grid.ni + i;
            (slip_x[at].powi(2) + slip_y[at].powi(2)) / (chord.leading - x(i))
        };
        let [near, far] = [stick - 2, stick - 3];
        let border = x(near) + grid.dx() * square(near) / (square(far) - square(near));
        border - DISPLACED * grid.dx() - chord.trailing
    }

    /// Width of a zone by its power and the direction of the tractions of some elements. `None`
    /// without a traction bound.
    fn width_by_power(
        &self,
        row: usize,
        elements: std::ops::Range<usize>,
        zone: &TrailingZone,
    ) -> Option<f64> {
        let grid = self.rows.grid();
        let length = zone.leading - zone.trailing;
        let own = |field: &[f64]| field[row * grid.ni..][..grid.ni].to_vec();
        let load = own(self.bound).iter().sum::<f64>() * grid.dx();
        let slope = 8.0 * load / (PI * length * length);
        let [x, y] = self
            .state
            .traction
            .each_ref()
            .map(|traction| own(traction)[elements.clone()].iter().sum::<f64>());
        let compliance = self.compliance(self.inclination(row), [x, y]);
        let scale = self.speed * compliance * slope * slope * PI / 8.0;
        let excess = |width: f64| scale * width * width * (length - 0.5 * width) - zone.power;
        if excess(length) <= 0.0 {
            return (scale > 0.0).then_some(length);
        }
        root_between([0.0, length], excess)
    }

    /// Compliance C of a half-plane for an edge inclined by tan ψ under tractions in this direction
    /// [1/Pa].
    fn compliance(&self, inclination: f64, [x, y]: [f64; 2]) -> f64 {
        let cosine = 1.0 / inclination.hypot(1.0);
        let across = cosine * (x - inclination * y);
        let share = across.powi(2) / (x * x + y * y);
        let [along_x, along_y] =
            [self.elasticity.contact_compliance(), self.elasticity.shear_compliance];
        2.0 * cosine * (share * along_x + (1.0 - share) * along_y)
    }

    /// Inclination dx/dy of the trailing edge in a row.
    fn inclination(&self, row: usize) -> f64 {
        let chord = |row: usize| self.chords.get(row).copied().flatten();
        let beside = [row.checked_sub(1), Some(row), Some(row + 1)];
        let known: Vec<(usize, f64)> = beside
            .into_iter()
            .flatten()
            .filter_map(|row| chord(row).map(|chord| (row, chord.trailing)))
            .collect();
        match (known.first(), known.last()) {
            (Some((low, from)), Some((high, to))) if high > low => {
                (to - from) / ((high - low) as f64 * self.rows.grid().dy())
            }
            _ => 0.0,
        }
    }

    fn elements(&self, row: usize) -> &[ElementState] {
        let grid: &Structured = self.rows.grid();
        &self.state.element[row * grid.ni..(row + 1) * grid.ni]
    }

    /// Number of elements that slip at the trailing edge of a row; `None` without adhesion.
    fn slipping(&self, row: usize) -> Option<usize> {
        let elements = self.elements(row);
        let first = elements.iter().position(|element| *element != ElementState::Exterior)?;
        Some(self.first_stick(row)? - first)
    }

    /// First element of a row that sticks.
    fn first_stick(&self, row: usize) -> Option<usize> {
        self.elements(row).iter().position(|element| *element == ElementState::Adhesion)
    }
}
