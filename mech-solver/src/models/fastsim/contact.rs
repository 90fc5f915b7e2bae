//! The whole contact: creepage for a prescribed force, and totals over all cells.

use super::limits::Limits;
use super::sliding::Sliding;
use crate::case::ellipse::{Ellipse, Prescribed};
use crate::case::scene::Speeds;
use crate::figures::indicators::{SlipZone, add_slip_zone};
use crate::models::power_balance::{LARGEST_POWER_IMBALANCE, power_density, power_imbalance};
use crate::models::summary::extend;
use elastic::cut_off::{Shape, force_share};
use elastic::fastsim::flexibility::{Creepage, Flexibilities, Kind};
use elastic::fastsim::integration::{Cell, Lattice, Strip, StripIntegration, norm};
use elastic::fastsim::reduction::Reduction;
use elastic::fastsim::strip_theory::StripTheory;
use numerics::search::root_in_bracket;
use proto::configuration::Refusal;
use proto::readable::quantity;
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::ops::Range;

/// A checked case, before the march along the strips.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Problem {
    /// Normal contact.
    pub(super) ellipse: Ellipse,
    /// Prescribed creepage or force.
    pub(super) prescribed: Prescribed,
    /// Kalker's flexibilities.
    pub(super) flexibilities: Flexibilities,
    /// One or three flexibilities.
    pub(super) kind: Kind,
    /// Reduction of the initial slope of the creep curve.
    pub(super) reduction: Reduction,
    /// Poisson's ratio, if strip theory gives the traction in the stick zone.
    pub(super) strip_theory: Option<f64>,
    /// Strips and cells of the contact.
    pub(super) lattice: Lattice,
    /// Friction coefficient [-].
    pub(super) friction_coefficient: f64,
    /// Speeds of rolling and of the surfaces.
    pub(super) speeds: Speeds,
    /// True if surfaces may stick.
    pub(super) partial: bool,
}

impl Problem {
    fn friction_bound(&self) -> f64 {
        self.friction_coefficient * self.ellipse.normal_force
    }

    /// Simplified theory at a creepage, and the factor by which its flexibilities are divided.
    fn march(&self, creepage: Creepage) -> (StripIntegration, f64) {
        let Lattice { semi_axis_a: a, semi_axis_b: b, .. } = self.lattice;
        let reach = 3.0 * self.friction_bound() / (8.0 * a * a * b);
        let factor = self.reduction.at(creepage, a, self.gradient());
        let springs = self.flexibilities.springs(self.kind, creepage, reach).reduced(factor);
        let largest_bound = self.lattice.largest_bound(self.friction_bound());
        (StripIntegration { lattice: self.lattice, springs, creepage, largest_bound }, factor)
    }

    /// Polach's gradient of the tangential stress, relative to the creepage, G π a b C11/(4 f N)
    /// [-].
    fn gradient(&self) -> f64 {
        let Lattice { semi_axis_a: a, semi_axis_b: b, .. } = self.lattice;
        2.0 * PI * a * a * b / (3.0 * self.flexibilities.longitudinal * self.friction_bound())
    }

    /// Tangential theory at a creepage.
    fn tangential(&self, creepage: Creepage) -> Tangential {
        match self.partial {
            true => self.sticking(creepage),
            false => {
                Tangential::Sliding(Sliding::new(self.lattice, creepage, self.friction_bound()))
            }
        }
    }

    /// Tangential theory at a creepage, for surfaces that may stick.
    fn sticking(&self, creepage: Creepage) -> Tangential {
        let (march, factor) = self.march(creepage);
        let Some(poisson_ratio) = self.strip_theory else { return Tangential::Partial(march) };
        let Flexibilities { longitudinal, lateral, spin, .. } = self.flexibilities;
        let flexibilities = [longitudinal, lateral, spin].map(|own| own / factor);
        Tangential::Strips(StripTheory::new(march, flexibilities, poisson_ratio))
    }

    /// Solves the contact with one friction coefficient; reuses the memory of a discarded contact.
    pub(super) fn solve(&self, spent: Option<FastsimContact>) -> FastsimContact {
        self.solve_under(|_, _, bound| bound, 1.0, spent)
    }

    /// Solves the contact with the friction bounds of the elements.
    pub(super) fn solve_limited(
        &self,
        limits: &Limits<'_>,
        spent: Option<FastsimContact>,
    ) -> FastsimContact {
        let most = self.capacity(limits) / self.friction_bound();
        self.solve_under(|x, y, bound| limits.at(x, y, bound), most, spent)
    }

    /// Solves the contact with tractions of at most `largest` [Pa]; `None` if they do not carry the
    /// prescribed force.
    pub(super) fn solve_cut_off(&self, largest: f64) -> Option<FastsimContact> {
        let ratio = largest / (self.friction_coefficient * self.ellipse.max_pressure);
        let most = force_share(Shape::HalfEllipse, ratio);
        let carried =
            !matches!(self.prescribed, Prescribed::ForceRatio(ratio) if ratio.abs() > most);
        carried.then(|| self.solve_under(|_, _, bound| bound.min(largest), most, None))
    }

    /// Longitudinal force if all springs slide along x, with the friction bounds of the elements
    /// [N].
    pub(super) fn capacity(&self, limits: &Limits<'_>) -> f64 {
        if self.friction_bound() == 0.0 {
            return 0.0;
        }
        let (march, _) = self.march([0.0; 3]);
        let strip = |strip: Strip| {
            let nodes = march.nodes(&strip).map(|(x, g)| (x, limits.at(x, strip.y, g)));
            let (mut sum, mut before) = (0.0, (0.0, 0.0));
            for (x, g) in nodes {
                sum += 0.5 * (before.1 + g) * (before.0 - x).max(0.0);
                before = (x, g);
            }
            strip.width * sum
        };
        self.lattice.strips().map(strip).sum()
    }

    /// Solves the contact under the local bound `limit`, a function of x, y and the bound at the
    /// mean coefficient. The whole contact can carry at most `most` · f N.
    fn solve_under(
        &self,
        limit: impl Fn(f64, f64, f64) -> f64 + Copy,
        most: f64,
        spent: Option<FastsimContact>,
    ) -> FastsimContact {
        let creepage = match self.prescribed {
            Prescribed::Creepage { xi, eta, phi } => [xi, eta, phi],
            Prescribed::ForceRatio(ratio) => {
                [self.longitudinal_creepage(ratio, most, limit), 0.0, 0.0]
            }
        };
        let tangential = self.tangential(creepage);
        let (mut strips, mut cells) =
            spent.map(|contact| (contact.strips, contact.cells)).unwrap_or_default();
        strips.clear();
        cells.clear();
        cells.reserve(self.lattice.strips * (self.lattice.cells + 1));
        let mut totals = Totals::default();
        for strip in self.lattice.strips() {
            let (mut own, first) = (Totals::default(), cells.len());
            let limit = |x: f64, bound: f64| limit(x, strip.y, bound);
            tangential.strip(&strip, limit, |cell| {
                own.add(cell, strip.y);
                cells.push(*cell);
            });
            totals.add_strip(&own, strip.width);
            strips.push((strip, first..cells.len()));
        }
        let mut contact = FastsimContact { problem: *self, creepage, strips, cells, totals };
        if self.strip_theory.is_some() && self.partial {
            contact.balance_slip();
        }
        contact
    }

    /// Creepage ξ whose longitudinal force is `ratio` · f N, with η = φ = 0; the whole contact
    /// carries at most `most` · f N.
    fn longitudinal_creepage(
        &self,
        ratio: f64,
        most: f64,
        limit: impl Fn(f64, f64, f64) -> f64 + Copy,
    ) -> f64 {
        /// Relative rounding error of a sum over all cells.
        const ROUNDING: f64 = 1e-12;
        /// Maximum number of doublings of the creepage until the whole contact slips.
        const DOUBLINGS: usize = 40;
        let target = ratio.abs();
        let force = |creep: f64| {
            let tangential = self.sticking([-creep, 0.0, 0.0]);
            Totals::of(&self.lattice, &tangential, limit).force[0] / self.friction_bound()
        };
        let (mut all, mut largest) = (self.full_slip_creepage(), most);
        if most != 1.0 {
            // Varying friction may reach full slip at a larger creepage than the mean coefficient.
            let slides = |creep: &f64| force(*creep) >= most * (1.0 - ROUNDING);
            let tried = (0..DOUBLINGS).map(|count| all * f64::from(count as u32).exp2());
            all = tried.clone().find(slides).unwrap_or(all);
            largest = force(all);
        }
        if target >= largest {
            return -ratio.signum() * all;
        }
        let excess = |creep: f64| force(creep) - target;
        // Adding zero turns −0 into 0.
        let creep = root_in_bracket([(0.0, -target), (all, largest - target)], excess);
        -ratio.signum() * creep.unwrap_or(all) + 0.0
    }

    /// Smallest creep at which every cell slips [-]. On the longest strip, the traction predictor
    /// of the first cell, Δ w/L, reaches the bound at the cell's rear end; behind it the bound
    /// rises more slowly. In strip theory, the creep at which d = a on that strip.
    fn full_slip_creepage(&self) -> f64 {
        let Lattice { semi_axis_a, bound, cells, .. } = self.lattice;
        let largest = self.lattice.largest_bound(self.friction_bound());
        let steepest = match self.strip_theory {
            Some(_) => 3.0 * PI * PI / 16.0 * largest,
            None => bound.steepest(largest, cells),
        };
        let creep = steepest * self.flexibilities.longitudinal / semi_axis_a;
        self.reduction.unreduced(creep, self.gradient())
    }
}

/// Tangential theory that gives the tractions at a creepage.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Tangential {
    /// Stick zone by springs.
    Partial(StripIntegration),
    /// Stick zone by strip theory.
    Strips(StripTheory),
    /// No stick zone.
    Sliding(Sliding),
}

impl Tangential {
    fn strip(&self, strip: &Strip, limit: impl Fn(f64, f64) -> f64, visit: impl FnMut(&Cell)) {
        match self {
            Self::Partial(march) => march.strip(strip, limit, visit),
            Self::Strips(theory) => theory.strip(strip, limit, visit),
            Self::Sliding(sliding) => sliding.strip(strip, limit, visit),
        }
    }
}

/// Totals over all cells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Totals {
    /// Creep forces F_x and F_y [N].
    force: [f64; 2],
    /// Spin moment M_z [N m].
    moment: f64,
    /// Friction power divided by V [N].
    power: f64,
    /// Slip area [m²].
    slip_area: f64,
    /// Largest traction [Pa].
    largest_traction: f64,
    /// Largest slip divided by V [-].
    largest_slip: f64,
}

impl Totals {
    fn of(
        lattice: &Lattice,
        tangential: &Tangential,
        limit: impl Fn(f64, f64, f64) -> f64,
    ) -> Self {
        let mut totals = Self::default();
        for strip in lattice.strips() {
            let mut own = Self::default();
            let limit = |x: f64, bound: f64| limit(x, strip.y, bound);
            tangential.strip(&strip, limit, |cell| own.add(cell, strip.y));
            totals.add_strip(&own, strip.width);
        }
        totals
    }

    fn add(&mut self, cell: &Cell, y: f64) {
        let ([x, lateral], length) = (cell.traction, cell.length());
        self.force[0] += x * length;
        self.force[1] += lateral * length;
        self.moment += (cell.middle() * lateral - y * x) * length;
        self.power += power_density(cell.traction, cell.slip) * length;
        self.slip_area += if cell.slips { length } else { 0.0 };
        self.largest_traction = self.largest_traction.max(cell.largest_traction);
        self.largest_slip = self.largest_slip.max(norm(cell.slip));
    }

    fn add_strip(&mut self, strip: &Self, width: f64) {
        self.force[0] += strip.force[0] * width;
        self.force[1] += strip.force[1] * width;
        self.moment += strip.moment * width;
        self.power += strip.power * width;
        self.slip_area += strip.slip_area * width;
        self.largest_traction = self.largest_traction.max(strip.largest_traction);
        self.largest_slip = self.largest_slip.max(strip.largest_slip);
    }
}

/// A solved contact.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FastsimContact {
    /// Case that was solved.
    pub(super) problem: Problem,
    /// Creepage, prescribed or computed.
    pub(super) creepage: Creepage,
    /// Strips, with the range of their cells.
    strips: Vec<(Strip, Range<usize>)>,
    cells: Vec<Cell>,
    totals: Totals,
}

impl FastsimContact {
    /// Strips with their cells, each from the leading to the trailing edge.
    pub(super) fn strips(&self) -> impl Iterator<Item = (&Strip, &[Cell])> {
        self.strips.iter().map(|(strip, cells)| (strip, &self.cells[cells.clone()]))
    }

    /// Force on the upper body [N].
    pub(super) fn force(&self) -> [f64; 3] {
        let [x, y] = self.totals.force;
        [x, y, self.problem.ellipse.normal_force]
    }

    /// Scales the slip so that the friction power equals the power of the creepages.
    fn balance_slip(&mut self) {
        let factor = self.creep_power() / self.totals.power;
        if !factor.is_finite() || factor < 0.0 {
            return;
        }
        for cell in &mut self.cells {
            cell.slip = cell.slip.map(|part| factor * part);
        }
        self.totals.power *= factor;
        self.totals.largest_slip *= factor;
    }

    /// Power of the creepages divided by V, −(ξ F_x + η F_y + φ M_z) [N].
    fn creep_power(&self) -> f64 {
        let [x, y] = self.totals.force;
        let [xi, eta, phi] = self.creepage;
        // Adding zero turns −0 into 0.
        -(xi * x + eta * y + phi * self.totals.moment) + 0.0
    }

    /// |friction power − power of the creepages| divided by the sum of both magnitudes.
    fn power_imbalance(&self) -> f64 {
        let (taken, given) = (self.totals.power, self.creep_power());
        power_imbalance(taken, given, taken.abs() + given.abs())
    }

    /// Refuses a friction power that differs from the power of the creepages. Several flexibilities
    /// under spin are exempt, since they do not balance; the slip of strip theory is scaled to
    /// balance.
    pub(super) fn check_power(&self) -> Result<(), Refusal> {
        let Problem { partial, kind, strip_theory, .. } = self.problem;
        let exact = kind.balances_spin() || self.creepage[2] == 0.0;
        let claimed = !partial || strip_theory.is_some() || exact;
        let imbalance = self.power_imbalance();
        if !claimed || imbalance <= LARGEST_POWER_IMBALANCE {
            return Ok(());
        }
        let reason = format!(
            "friction dissipates {}, but the creep forces supply {}",
            quantity(self.problem.speeds.rolling * self.totals.power, "W", 7),
            quantity(self.problem.speeds.rolling * self.creep_power(), "W", 7)
        );
        Err(Refusal::new("mech.resolution", reason, "write another resolution"))
    }

    /// Width of the slip zone in elements of this length [m].
    fn slip_zone(&self, dx: f64) -> SlipZone {
        let mut zone = SlipZone::default();
        for (strip, cells) in self.strips() {
            for run in cells.chunk_by(|one, next| one.slips == next.slips) {
                if !run[0].slips {
                    zone.add_stick();
                    continue;
                }
                let of = |cell: &Cell| power_density(cell.traction, cell.slip) * cell.length();
                let length: f64 = run.iter().map(Cell::length).sum();
                let power: f64 = run.iter().map(of).sum();
                zone.add_run(length / dx, strip.width * power.max(0.0));
            }
        }
        zone
    }

    /// Section `contact` of `summary.json`, for fields on elements of this length [m].
    pub(super) fn summary(&self, dx: f64) -> Value {
        let (totals, ellipse, speed) =
            (&self.totals, &self.problem.ellipse, self.problem.speeds.rolling);
        let mut contact = ellipse.summary();
        let area = PI * ellipse.semi_axis_a * ellipse.semi_axis_b;
        let creep = json!({
            "creep_force_x_n": totals.force[0],
            "creep_force_y_n": totals.force[1],
            "spin_moment_nm": totals.moment,
            "traction_coefficient": totals.force[0] / ellipse.normal_force,
            "creepage_xi": self.creepage[0],
            "creepage_eta": self.creepage[1],
            "creepage_phi_per_m": self.creepage[2],
            "slip_area_ratio": totals.slip_area / area,
            "max_slip_velocity_m_per_s": speed * totals.largest_slip,
            "max_traction_pa": totals.largest_traction,
            "friction_power_w": speed * totals.power,
            "creep_power_w": speed * self.creep_power(),
            "power_imbalance": self.power_imbalance(),
        });
        extend(&mut contact, creep);
        add_slip_zone(&mut contact, &self.slip_zone(dx));
        ellipse.indicators.add_to(&mut contact);
        json!({ "contact": contact })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use elastic::fastsim::bound::Bound;

    /// Uniform friction coefficient.
    const MEAN: fn(f64, f64, f64) -> f64 = |_, _, bound| bound;

    /// Contact of CONTACT's example fastsim, with the flexibilities printed by CONTACT: a = 8 mm, b
    /// = 4 mm, f = 0.3, N = 82 kN, η = −6.25e-4, φ = 0.625/m.
    fn published(bound: Bound) -> StripIntegration {
        let lattice =
            Lattice { semi_axis_a: 8e-3, semi_axis_b: 4e-3, strips: 400, cells: 800, bound };
        let flexibilities = Flexibilities {
            longitudinal: 4.937e-14,
            lateral: 5.152e-14,
            spin: 4.090e-14,
            spin_length: 1.0,
            mean_axis: 1.0,
        };
        let creepage = [0.0, -6.25e-4, 0.625];
        let springs = flexibilities.springs(Kind::Three, creepage, 1.0);
        let largest_bound = lattice.largest_bound(0.3 * 82e3);
        StripIntegration { lattice, springs, creepage, largest_bound }
    }

    /// CONTACT r2707, examples/fastsim.inp, cases 2 and 5 (FASTSIM, parabolic bound): F_y = −15.05
    /// kN on 40 elements across and −15.64 kN on 200, −15.79 kN by extrapolation; M_z = −39.00 and
    /// −37.98 N m, −37.73 N m by extrapolation. The tolerance covers the extrapolation and the
    /// printed digits.
    #[test]
    fn published_result() {
        let march = published(Bound::Parabolic);
        let totals = Totals::of(&march.lattice, &Tangential::Partial(march), MEAN);
        assert!((totals.force[1] / -15.79e3 - 1.0).abs() < 3e-3, "{totals:?}");
        assert!((totals.moment / -37.73 - 1.0).abs() < 3e-3, "{totals:?}");
        assert!(totals.force[0].abs() < 1e-9 * 82e3, "{totals:?}");
    }

    /// Same example, cases 3 and 6 (elliptic bound) and 4 and 7 (FASTRIP), on 40, 200, 400 and 800
    /// elements across. The first two grids are shipped with CONTACT, the others were computed with
    /// it. F_y = −14.80, −14.65, −14.63, −14.62 and −15.83, −15.85, −15.85, −15.85 kN. M_z =
    /// −48.29, −45.30, −44.94, −44.76 and −48.16, −47.57, −47.52, −47.49 N m. First-order
    /// extrapolation gives −14.61 and −15.85 kN, −44.58 and −47.46 N m. The tolerance covers the
    /// printed digits, 5 N and 5 N mm of each, and the 400 strips of 800 cells used here.
    #[test]
    fn published_results_under_the_elliptic_bound() {
        let march = published(Bound::Elliptic);
        let coefficients = elastic::kalker::creep_coefficients(2.0, 0.28);
        let own = Flexibilities::new(&coefficients, [8e-3, 4e-3], 82e9);
        let own = [own.longitudinal, own.lateral, own.spin];
        let strips = Tangential::Strips(StripTheory::new(march, own, 0.28));
        for (tangential, force, moment) in
            [(Tangential::Partial(march), -14.61e3, -44.58), (strips, -15.85e3, -47.46)]
        {
            let totals = Totals::of(&march.lattice, &tangential, MEAN);
            assert!((totals.force[1] / force - 1.0).abs() < 1e-3, "{totals:?}");
            assert!((totals.moment / moment - 1.0).abs() < 1e-3, "{totals:?}");
            assert!(totals.force[0].abs() < 1e-9 * 82e3, "{totals:?}");
        }
    }

    /// CONTACT r2707, examples/tractcurv.inp, cases 91 to 120: a = 6.304 mm, b = 12.61 mm, N =
    /// 106.7 kN, k_0 = 0.54, α = 0.02, β = 0.62, friction 0.1368 + 0.2232 · 2^(−v/0.99) at 10 m/s.
    /// F_x was computed with CONTACT on 480 × 440 elements for this test (its shipped output is on
    /// 48 × 44), and extrapolated from both with the first order of its elements. The tolerance
    /// covers the printed digits of both, and the second order of 40 elements across.
    #[test]
    fn published_creep_curve_of_less_slope() {
        let (a, b, bound) = (6.304e-3, 12.61e-3, Bound::Parabolic);
        let lattice = Lattice { semi_axis_a: a, semi_axis_b: b, strips: 200, cells: 200, bound };
        let flexibilities = Flexibilities {
            longitudinal: 5.491e-14,
            lateral: 6.774e-14,
            spin: 4.526e-14,
            spin_length: 1.0,
            mean_axis: 1.0,
        };
        for (xi, force) in [
            (1e-5, 131.0),
            (1e-3, 10.17e3),
            (3e-3, 20.60e3),
            (4e-3, 23.45e3),
            (8e-3, 29.06e3),
            (0.014, 31.59e3),
            (0.022, 32.26e3),
            (0.04, 31.44e3),
            (0.065, 29.36e3),
            (0.1, 26.39e3),
            (0.25, 18.73e3),
        ] {
            let creepage = [xi, 0.0, 0.0];
            let friction_bound = 106.7e3 * (0.1368 + 0.2232 * (-10.0_f64 * xi / 0.99).exp2());
            // G C11 = 8 a/(3 L1).
            let gradient =
                2.0 * PI * a * a * b / (3.0 * flexibilities.longitudinal * friction_bound);
            let factor = Reduction::new(0.54, 0.02, 0.62).at(creepage, a, gradient);
            let springs = flexibilities.springs(Kind::Blended, creepage, 1.0).reduced(factor);
            let largest_bound = lattice.largest_bound(friction_bound);
            let march = StripIntegration { lattice, springs, creepage, largest_bound };
            let found = -Totals::of(&lattice, &Tangential::Partial(march), MEAN).force[0];
            assert!((found / force - 1.0).abs() < 2e-3, "{xi}: {found}");
        }
    }
}
