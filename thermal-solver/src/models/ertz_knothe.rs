//! Model `ertz-knothe`: the closed form of the paper's equations 9 to 12, row by row.
//!
//! Each row of the heat flux is replaced by the polynomial flux of equation 9. It approximates an
//! ellipse with semi-axis a_y, amplitude q₀ and centre x_c, and has its zeroth and second moments,
//! π/2 and π/8. The moments of the row therefore determine it:
//!
//! Q = ∫ q dx,  x_c = ∫ x q dx/Q,  a_y = 2 √(∫ (x − x_c)² q dx/Q),  q₀ = 2Q/(π a_y).
//!
//! Then T(x, z) = ε q₀/β · √(a_y/(πV)) · F(−(x − x_c)/a_y, z/δ_y) with δ_y = √(2κ a_y/V). The
//! function F is in [`heat::closed_form::polynomial`]. For full slip, where the flux of every row
//! is an ellipse, this is the paper's method; any other flux is replaced by the equivalent ellipse.
//! The moments are those of the piecewise parabolic flux of [`heat::columns::reconstruction`]. For
//! an elliptic flux their error is of order 2.5 in the element length.
//!
//! Below the surface the paper uses equations 13 and 14, for a uniform flux. They do not agree with
//! equation 10 on the surface. Here the polynomial flux itself is integrated in depth instead.

use super::conduction::{Conduction, Cost, InterfaceLoad, SolveStats};
use super::fields::fields;
use super::frame::Frame;
use super::names;
use super::normal_only::{along_the_surface, along_the_surface_at};
use super::setup::section_key;
use super::summary::Peak;
use crate::capability::Capability;
use crate::{LOWER, UPPER};
use heat::closed_form::polynomial;
use heat::columns::reconstruction::Flux;
use heat::columns::reconstruction::FluxRow;
use heat::window::{Drive, Stage};
use proto::accuracy::{Accuracy, Simplification};
use proto::description::ModelSpec;
use proto::model::StepError;
use proto::state::{read_numbers, write_numbers};
use std::f64::consts::PI;
use std::io::{self, Read, Write};

const SECONDS_PER_POINT: f64 = 30e-9;

/// Optional capabilities of the model.
pub const CAPABILITIES: &[Capability] = &[Capability::EarlierPassages];

/// Returns the description of the model.
#[must_use]
pub fn spec() -> ModelSpec {
    let (consumes, provides) = fields();
    ModelSpec {
        name: names::ERTZ_KNOTHE.to_owned(),
        summary: "closed form for the elliptic flux with the moments of each row".to_owned(),
        source: "Naeimi et al., eqs. 9-12, corrected; Ertz & Knothe, Wear 253 (2002) 498-508"
            .to_owned(),
        steady: true,
        transient: false,
        rewinds: true,
        varies_step: true,
        consumes,
        provides,
        keys: vec![section_key()],
        accuracy: Accuracy {
            refinement: None,
            simplifications: vec![
                along_the_surface(),
                Simplification::always(
                    "a polynomial approximates the elliptic flux",
                    0.005,
                    "Naeimi et al., eqs. 9-12, against the quadrature of the ellipse",
                ),
                Simplification::with(
                    "partial_slip",
                    "the heat of a row comes from one ellipse, wherever it arises",
                    0.08,
                    "`coordinator cost cases/wheel-rail.toml`",
                ),
            ],
        },
    }
}

/// Equivalent ellipse of a row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Ellipse {
    /// Heat of the row Q [W/m].
    heat: f64,
    /// Centre x_c [m].
    centre: f64,
    /// Semi-axis a_y [m]; 0 where there is no heat.
    semi_axis: f64,
}

/// Equivalent ellipses of all rows, and the window they belong to.
#[derive(Clone, Debug, PartialEq)]
struct Field {
    drive: Drive,
    rows: Vec<Ellipse>,
}

/// Model of the closed form by Ertz and Knothe.
pub struct ErtzKnothe {
    frame: Frame,
    flux: Flux,
    trial: Field,
    accepted: Field,
}

impl Conduction for ErtzKnothe {
    const TRANSIENT: bool = false;
    const SOLVES_STATIONARY_BODY: bool = false;
    const CAPABILITIES: &'static [Capability] = CAPABILITIES;
    const STATE_TAG: u8 = 1;

    fn new(frame: &Frame) -> Self {
        let drive = Drive { duration: f64::INFINITY, speeds: [1.0; 2], shares: [0.0; 2] };
        let cold = Field { drive, rows: vec![Ellipse::default(); frame.grid.nj] };
        Self {
            frame: frame.clone(),
            flux: Flux::zero(frame.grid.ni, frame.grid.nj),
            trial: cold.clone(),
            accepted: cold,
        }
    }

    fn cost(frame: &Frame) -> Cost {
        let points = frame.grid.points();
        let flux = Flux::bytes(frame.grid.ni, frame.grid.nj);
        Cost {
            solve_seconds: points as f64 * SECONDS_PER_POINT,
            memory_bytes: flux + 8 * 4 * points as u64,
        }
    }

    fn remarks(_: &Frame) -> Vec<String> {
        vec!["each row of the heat flux becomes the ellipse with its moments".to_owned()]
    }

    fn left_out(frame: &Frame) -> Option<Simplification> {
        along_the_surface_at(frame)
    }

    fn solve(
        &mut self,
        drive: &Drive,
        rub: &InterfaceLoad<'_>,
        rise: &mut [Vec<f64>; 2],
    ) -> Result<SolveStats, StepError> {
        let flux = rub.flux;
        self.flux.reconstruct(flux);
        self.trial.drive = *drive;
        for (row, ellipse) in self.trial.rows.iter_mut().enumerate() {
            *ellipse = fitted(&self.frame, self.flux.row(row), row)?;
        }
        self.trial.surfaces(&self.frame, rise);
        let warm = self.trial.rows.iter().filter(|row| row.semi_axis > 0.0).count();
        let heat: f64 = self.trial.rows.iter().map(|row| row.heat).sum();
        let heat = drive.shares.map(|share| share * heat / self.frame.grid.dx());
        Ok(SolveStats { operations: (warm * self.frame.grid.ni) as u64, heat })
    }

    fn accept(&mut self) {
        std::mem::swap(&mut self.trial, &mut self.accepted);
    }

    fn section(&mut self, stage: Stage, body: usize, row: usize, depths: &[f64], rise: &mut [f64]) {
        let field = match stage {
            Stage::Trial => &self.trial,
            Stage::Accepted => &self.accepted,
        };
        for (depth, rise) in depths.iter().zip(rise.chunks_exact_mut(self.frame.grid.ni)) {
            field.along(&self.frame, body, row, *depth, rise);
        }
    }

    fn rise_at(&self, body: usize, row: usize, x: f64, depth: f64) -> f64 {
        self.accepted.rise(&self.frame, body, row, x, depth)
    }

    fn peak(&self, body: usize, rise: &[f64]) -> Option<Peak> {
        let (xi, _) = polynomial::peak();
        let columns = self.frame.grid.ni;
        let asked = |row: usize| rise[row * columns..][..columns].iter().any(|rise| *rise > 0.0);
        let warmest = |ellipse: &Ellipse| ellipse.heat / ellipse.semi_axis.sqrt();
        let warm = self.accepted.rows.iter().enumerate();
        let (row, ellipse) = warm
            .filter(|(_, ellipse)| ellipse.semi_axis > 0.0 && ellipse.heat > 0.0)
            .filter(|(row, _)| asked(*row))
            .reduce(|a, b| if warmest(b.1) > warmest(a.1) { b } else { a })?;
        let x = ellipse.centre - xi * ellipse.semi_axis;
        Some(Peak { rise: self.rise_at(body, row, x, 0.0), x, y: self.frame.grid.y(row), row })
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        let Field { drive, rows } = &self.accepted;
        write_numbers(into, drive.speeds.iter().chain(&drive.shares))?;
        rows.iter().try_for_each(|row| write_numbers(into, &[row.heat, row.centre, row.semi_axis]))
    }

    fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        let mut accepted = self.accepted.clone();
        let Field { drive, rows } = &mut accepted;
        read_numbers(from, drive.speeds.iter_mut().chain(&mut drive.shares))?;
        for row in rows {
            read_numbers(from, [&mut row.heat, &mut row.centre, &mut row.semi_axis])?;
        }
        self.accepted = accepted;
        Ok(())
    }
}

impl Field {
    /// Computes the surface rises of both bodies, with one evaluation of F for the two.
    fn surfaces(&self, frame: &Frame, [upper, lower]: &mut [Vec<f64>; 2]) {
        let columns = frame.grid.ni;
        let rows = upper.chunks_exact_mut(columns).zip(lower.chunks_exact_mut(columns));
        for (row, (upper, lower)) in rows.enumerate() {
            let Ellipse { centre, semi_axis, .. } = self.rows[row];
            if semi_axis == 0.0 {
                upper.fill(0.0);
                lower.fill(0.0);
                continue;
            }
            let amplitudes = [UPPER, LOWER].map(|body| self.amplitude(frame, body, row));
            for (i, (upper, lower)) in upper.iter_mut().zip(lower).enumerate() {
                let shape = polynomial::surface((centre - frame.grid.x(i)) / semi_axis);
                (*upper, *lower) = (amplitudes[UPPER] * shape, amplitudes[LOWER] * shape);
            }
        }
    }

    /// ε q₀/β · √(a_y/(πV)) of a warm row [K].
    fn amplitude(&self, frame: &Frame, body: usize, row: usize) -> f64 {
        let Ellipse { heat, semi_axis, .. } = self.rows[row];
        let flux = self.drive.shares[body] * 2.0 * heat / (PI * semi_axis);
        flux * frame.amplitude(body) * (semi_axis / self.drive.speeds[body]).sqrt()
    }

    fn rise(&self, frame: &Frame, body: usize, row: usize, x: f64, depth: f64) -> f64 {
        let Ellipse { centre, semi_axis, .. } = self.rows[row];
        if semi_axis == 0.0 {
            return 0.0;
        }
        // z/delta with z = 2 c sqrt(kappa) and delta = sqrt(2 kappa a/V).
        let zeta = depth * (2.0 * self.drive.speeds[body] / semi_axis).sqrt();
        let shape = polynomial::in_depth((centre - x) / semi_axis, zeta);
        self.amplitude(frame, body, row) * shape
    }

    fn along(&self, frame: &Frame, body: usize, row: usize, depth: f64, rise: &mut [f64]) {
        for (i, value) in rise.iter_mut().enumerate() {
            *value = self.rise(frame, body, row, frame.grid.x(i), depth);
        }
    }
}

/// Returns the ellipse with the heat, the centroid and the variance of a row.
fn fitted(frame: &Frame, row: FluxRow<'_>, number: usize) -> Result<Ellipse, StepError> {
    let (first, end) = row.support;
    let moments = (first..end).fold([0.0; 3], |sums, i| {
        let element = element_moments(row.edge[i], row.middle[i], row.edge[i + 1]);
        // Shift from the left edge of the element to that of the first element.
        let way = (i - first) as f64;
        let [m0, m1, m2] = element;
        let shifted = [m0, m1 + way * m0, m2 + way * (2.0 * m1 + way * m0)];
        std::array::from_fn(|p| sums[p] + shifted[p])
    });
    if end == 0 {
        return Ok(Ellipse::default());
    }
    let (h, left) = (frame.grid.dx(), frame.grid.x(first) - 0.5 * frame.grid.dx());
    let mean = moments[1] / moments[0];
    let variance = moments[2] / moments[0] - mean * mean;
    if variance > 0.0 {
        return Ok(Ellipse {
            heat: h * moments[0],
            centre: left + h * mean,
            semi_axis: 2.0 * h * variance.sqrt(),
        });
    }
    Err(StepError::NoSolution(format!(
        "the heat flux of row {number} changes its sign and is not representable by an ellipse: \
         its variance is {variance:e} elements squared"
    )))
}

/// Moments 0, 1 and 2 of an element's parabola about its left edge, in element lengths.
fn element_moments(before: f64, middle: f64, after: f64) -> [f64; 3] {
    [
        (before + middle + after) / 3.0,
        before / 12.0 + middle / 6.0 + after / 4.0,
        before / 30.0 + middle / 10.0 + after / 5.0,
    ]
}
