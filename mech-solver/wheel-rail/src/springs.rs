//! The tractions of a patch of any outline by the simplified theory: FASTSIM, and FASTRIP.
//!
//! Each strip is treated as the middle strip of its own ellipse, with its length and f times its
//! pressure ([`elastic::fastsim`]). Its bound is half an ellipse. f is the mean over the elements
//! of the strip, and every node is bounded by the friction of its element. All strips have the
//! flexibilities of the equivalent ellipse ([`super::strips`]). With creepages ξ, η, φ at the
//! origin of the patch, and the additional slip off the plane, a strip with its middle at (x₀, t)
//! has the rigid slip ξ − φ t, η + φ x₀ there.
//!
//! Strip theory compares a strip with the ellipse by its pressure over its length, which is p₀/a in
//! all strips of an ellipse.
//!
//! **Energy.** With one flexibility the dissipated power equals that of the creepages, −V(ξF_x +
//! ηF_y + φM_z), to rounding, with M_z from the means of the cells. With strip theory the slip is
//! scaled by one factor to satisfy this balance.
//!
//! Source: Vollebregt, User guide for CONTACT (2022), for FASTSIM on patches that are no ellipse.
//! Deviation: the integration has its own cells, shorter towards the edges, whose tractions are
//! distributed to the elements; slip and power lie half an element ahead, as in [`super::fields`].

use super::creepage::{Rolling, RowSlip};
use super::fields::Fields;
use super::local::Window;
use super::pressed::NormalPatch;
use super::settings::{Settings, SpringOptions};
use super::strips::{PressedStrip, equivalent_ellipse};
use elastic::Elasticity;
use elastic::fastsim::bound::Bound;
use elastic::fastsim::flexibility::{Flexibilities, Kind, Springs};
use elastic::fastsim::integration::{Cell, Lattice, Strip, StripIntegration};
use elastic::fastsim::overlaps::overlaps;
use elastic::fastsim::strip_theory::StripTheory;
use elastic::kalker::creep_coefficients;
use half_space::friction::ElementFriction;
use half_space::tangential::{Creepage, ElementState};

/// Cells per strip.
const CELLS: usize = 40;

/// Input for the tractions of a patch.
struct TractionProblem<'a> {
    strips: &'a [PressedStrip],
    window: &'a Window,
    /// Friction of the elements of the window.
    elements: &'a ElementFriction,
    /// Coefficient of friction of every strip [-].
    friction: Vec<f64>,
    rolling: &'a Rolling,
    /// Additional rigid slip of every row of the window.
    besides: Vec<RowSlip>,
    bodies: Elasticity,
    kind: Kind,
    /// True if strip theory applies where strips stick.
    strip_theory: bool,
}

/// Tractions of a patch on springs.
#[derive(Clone, Debug, Default)]
pub(super) struct TractionSolution {
    /// Force on the wheel [N].
    pub(super) force: [f64; 2],
    /// Moment on the wheel about the normal through the patch's origin [N m].
    pub(super) moment: f64,
    /// Part of the friction power that is due to rigid slip off the plane [W].
    pub(super) off_plane: f64,
    /// Slipping area over the area of the contact [-].
    pub(super) slip_area_ratio: f64,
    /// Cells with the index of their strip; x from the middle of the strip.
    cells: Vec<(usize, Cell)>,
}

/// Solves a patch on springs and writes its fields, with the friction of its elements and the
/// additional rigid slip of its rows, if any.
pub(super) fn slide(
    pressed: &NormalPatch,
    rolling: &Rolling,
    (settings, springs): (&Settings, SpringOptions),
    (friction, besides): (&ElementFriction, Option<&[RowSlip]>),
    fields: &mut Fields,
) -> TractionSolution {
    let SpringOptions { kind, strip_theory } = springs;
    let window = &pressed.window;
    let strips = pressed.strips();
    let sliding = TractionProblem {
        elements: friction,
        friction: strips.iter().map(|strip| mean_of_row(strip.row, fields, friction)).collect(),
        strips: &strips,
        window,
        rolling,
        besides: match besides {
            Some(rows) => rows.to_vec(),
            None => vec![RowSlip::default(); window.counts()[1]],
        },
        bodies: settings.bodies,
        kind,
        strip_theory,
    };
    let slid = sliding.solve();
    sliding.write(&slid, fields);
    slid
}

/// Coefficient of friction of a row, the mean weighted with the pressure [-].
fn mean_of_row(row: usize, fields: &Fields, friction: &ElementFriction) -> f64 {
    let nx = fields.counts[0];
    friction.mean(row * nx..(row + 1) * nx, &fields.pressure)
}

/// The springs of a patch.
struct Bed {
    flexibilities: Flexibilities,
    springs: Springs,
    semi_axis_a: f64,
    poisson_ratio: f64,
}

impl TractionProblem<'_> {
    /// Solves the tractions.
    fn solve(&self) -> TractionSolution {
        let mut slid = TractionSolution::default();
        let bed = self.bed();
        for (index, strip) in self.strips.iter().enumerate() {
            self.march(&bed, index, self.creepage(strip), |cell| slid.cells.push((index, *cell)));
        }
        self.sum(&mut slid);
        slid
    }

    /// ξ, η and φ in the axes of the patch, including the additional slip of this row.
    fn creepage(&self, strip: &PressedStrip) -> Creepage {
        let [xi, eta, phi] = self.rolling.creepage;
        let RowSlip { slip: [x, y], spin } = self.besides[strip.row];
        [xi + x, eta + y, phi + spin]
    }

    fn along(&self, strip: &PressedStrip) -> f64 {
        self.window.along(1, strip.row)
    }

    /// Springs of the equivalent ellipse.
    fn bed(&self) -> Bed {
        let spacing = self.window.sides[1];
        let [a, b] = equivalent_ellipse(self.strips, spacing);
        let Elasticity { shear_compliance, poisson_compliance, .. } = self.bodies;
        let poisson_ratio = poisson_compliance / shear_compliance;
        let coefficients = creep_coefficients(a / b, poisson_ratio);
        let flexibilities = Flexibilities::new(&coefficients, [a, b], shear_compliance.recip());
        let loads = self.strips.iter().zip(&self.friction);
        let bound: f64 = loads.map(|(strip, friction)| friction * load(strip, spacing)).sum();
        let reach = 3.0 * bound / (8.0 * a * a * b);
        let springs = flexibilities.springs(self.kind, self.rolling.creepage, reach);
        Bed { flexibilities, springs, semi_axis_a: a, poisson_ratio }
    }

    /// Visits the cells of a strip from its leading to its trailing edge.
    fn march(&self, bed: &Bed, index: usize, creepage: Creepage, visit: impl FnMut(&Cell)) {
        let PressedStrip { middle, half_length, pressure, .. } = self.strips[index];
        let eta = half_length / bed.semi_axis_a;
        let lattice = Lattice {
            semi_axis_a: bed.semi_axis_a,
            semi_axis_b: bed.semi_axis_a,
            strips: 1,
            cells: CELLS,
            bound: Bound::Elliptic,
        };
        let march = StripIntegration {
            lattice,
            springs: bed.springs,
            creepage: bed.springs.in_the_middle(creepage, middle),
            largest_bound: self.friction[index] * pressure / eta,
        };
        let width = self.window.sides[1];
        let y = self.along(&self.strips[index]);
        let strip = Strip { y, span: [y - 0.5 * width, y + 0.5 * width], eta, width };
        let [nx, _] = self.window.counts();
        let PressedStrip { row, .. } = self.strips[index];
        let limit = |x: f64, bound: f64| {
            let column = (middle + x) / self.window.sides[0] + self.window.half[0] as f64;
            let column = (column.round().max(0.0) as usize).min(nx - 1);
            self.elements.limit(row * nx + column, self.friction[index], bound)
        };
        if !self.strip_theory {
            return march.strip(&strip, limit, visit);
        }
        let Flexibilities { longitudinal, lateral, spin, .. } = bed.flexibilities;
        let own = [longitudinal, lateral, spin];
        StripTheory::of_strip(march, creepage, middle, own, bed.poisson_ratio)
            .strip(&strip, limit, visit);
    }

    /// Sums over the cells, after scaling the slip for strip theory.
    fn sum(&self, slid: &mut TractionSolution) {
        let (mut taken, mut off_plane, mut slips, mut all) = (0.0, 0.0, 0.0, 0.0);
        for (index, cell) in &slid.cells {
            let strip = &self.strips[*index];
            let area = self.window.sides[1] * cell.length();
            let [px, py] = cell.traction.map(|p| p * area);
            let [x, y] = [strip.middle + cell.middle(), self.along(strip)];
            slid.force[0] += px;
            slid.force[1] += py;
            slid.moment += x * py - y * px;
            taken -= px * cell.slip[0] + py * cell.slip[1];
            let RowSlip { slip: [more_x, more_y], spin } = self.besides[strip.row];
            off_plane -= px * more_x + py * (more_y + spin * x);
            all += area;
            slips += if cell.slips { area } else { 0.0 };
        }
        slid.off_plane = self.rolling.speed * off_plane;
        slid.slip_area_ratio = if slips > 0.0 { slips / all } else { 0.0 };
        let [xi, eta, phi] = self.rolling.creepage;
        let given = off_plane - (xi * slid.force[0] + eta * slid.force[1] + phi * slid.moment);
        let factor = given / taken;
        if self.strip_theory && factor.is_finite() && factor > 0.0 {
            slid.cells.iter_mut().for_each(|(_, cell)| cell.slip = cell.slip.map(|s| factor * s));
        }
    }

    /// Distributes the result to the elements of the window's fields.
    fn write(&self, slid: &TractionSolution, fields: &mut Fields) {
        let [nx, _] = self.window.counts();
        let dx = self.window.sides[0];
        let (speed, difference) = (self.rolling.speed, fields.difference);
        let mut slips = vec![0.0; self.window.points()];
        for (index, cell) in &slid.cells {
            let strip = &self.strips[*index];
            let first = strip.row * nx;
            // Positions in elements, from the trailing edge of the first one. Slip and power may
            // lie half an element ahead.
            let place =
                |x: f64, ahead: f64| (strip.middle + x) / dx + self.window.half[0] as f64 + ahead;
            overlaps(cell.ends.map(|x| place(x, 0.5)), nx, |i, length| {
                for (field, traction) in fields.traction.iter_mut().zip(cell.traction) {
                    field[first + i] += length * traction;
                }
                slips[first + i] += if cell.slips { length } else { -length };
            });
            let power = -(cell.traction[0] * cell.slip[0] + cell.traction[1] * cell.slip[1]);
            overlaps(cell.ends.map(|x| place(x, 0.5 - difference.middle())), nx, |i, length| {
                for (field, slip) in fields.slip_velocity.iter_mut().zip(cell.slip) {
                    field[first + i] += length * slip * speed;
                }
                fields.friction_power[first + i] += length * power * speed;
            });
        }
        for ((element, slips), p) in fields.element.iter_mut().zip(&slips).zip(&fields.pressure) {
            if *p > 0.0 {
                let slip = *slips > 0.0;
                *element = if slip { ElementState::Slip } else { ElementState::Adhesion };
            }
        }
    }
}

/// Load of a strip [N].
fn load(strip: &PressedStrip, spacing: f64) -> f64 {
    0.5 * std::f64::consts::PI * strip.pressure * strip.half_length * spacing
}
