//! Material removed from both bodies by the contact, and the resulting profiles.
//!
//! Every point of a rotating body passes the whole contact along its row. A passage therefore
//! removes the same depth from the whole circumference of the row,
//!
//! h(y) = ∫ w dx / v,  w = k q_f (energy) or (K/H) p |s| (Archard) [m/s],
//!
//! with the speed v of the surface, the friction power density q_f, the pressure p and the slip
//! velocity s. The depths of all passages are added to the undeformed distance. A window stands for
//! a number of passages under the same contact.
//!
//! A row with a higher load wears more, and carries less in the next window. The wear of a window
//! must stay small compared with the change that the elastic bodies compensate. A change δh that
//! alternates from row to row changes the pressure by δp = δh E*π/(2Δy), with
//! 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂. If the passages of a window respond to such a change with
//! more than 2δh, the change grows.
//!
//! Source: Archard, J. Appl. Phys. 24 (1953) 981–988; Pearce & Sherratt, Wear 144 (1991) 343–351,
//! for wear by friction energy in railways.

use crate::case::scene::Scene;
use crate::terms::state::{Accepted, State};
use proto::bodies::Bodies;
use proto::configuration::{Configuration, Refusal};
use proto::field::FieldSpec;
use proto::grid::Structured;
use proto::model::{Outputs, StateError, StepError};
use proto::state::{read_numbers, write_numbers};
use serde_json::{Map, Value, json};
use std::f64::consts::PI;
use std::io::{self, Read, Write};

/// Wear law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Law {
    /// Volume worn per joule of friction work, of the upper and the lower body [m³/J].
    Energy([f64; 2]),
    /// Wear coefficient divided by hardness, K/H, of the upper and the lower body [1/Pa].
    Archard([f64; 2]),
}

impl Law {
    /// Unscaled recession rate of the surface at an element [W/m²]; the wear factor converts it to
    /// m/s.
    fn driving(&self, contact: &Accepted<'_>, element: usize) -> f64 {
        match self {
            Self::Energy(_) => contact.friction_power[element],
            Self::Archard(_) => {
                let (x, y) = contact.slip_velocity.split_at(contact.pressure.len());
                contact.normal_pressure[element] * x[element].hypot(y[element])
            }
        }
    }

    fn factors(&self) -> [f64; 2] {
        let (Self::Energy(factors) | Self::Archard(factors)) = *self;
        factors
    }
}

/// Reads the number of passages from a configuration in which nothing varies.
pub(crate) type ReadPasses = fn(&Configuration) -> Result<f64, Refusal>;

/// Depths worn off both bodies, row by row.
#[derive(Clone, Debug)]
pub(crate) struct Removal {
    law: Law,
    /// Number of passages per window, and the function that reads it from a configuration.
    passes: f64,
    read_passes: ReadPasses,
    /// Fields of the depths of the upper and the lower body.
    fields: [&'static FieldSpec; 2],
    /// Name of the section of the summary.
    section: &'static str,
    /// Names of the bodies in the case.
    names: Bodies,
    /// (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂ [1/Pa].
    compliance: f64,
    /// Positions of the rows.
    rows: Rows,
    /// Depths that one passage through the accepted contact removes from both bodies [m].
    passage: [Vec<f64>; 2],
    /// Depths of all accepted passages [m].
    worn: [Vec<f64>; 2],
}

/// Rows of a grid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Rows {
    first: f64,
    width: f64,
    count: usize,
}

impl Removal {
    /// Creates the removal of a configuration, without any wear so far.
    ///
    /// # Errors
    /// A number of passages that is refused.
    pub(crate) fn new(
        law: Law,
        (configuration, read_passes): (&Configuration, ReadPasses),
        scene: &Scene,
        (fields, section): ([&'static FieldSpec; 2], &'static str),
    ) -> Result<Self, Refusal> {
        Ok(Self {
            law,
            passes: read_passes(configuration)?,
            read_passes,
            fields,
            section,
            names: scene.names.clone(),
            compliance: scene.contact_compliance(),
            rows: Rows::default(),
            passage: Default::default(),
            worn: Default::default(),
        })
    }

    /// Sets the grid of the contact; called before all other methods.
    pub(crate) fn place(&mut self, grid: &Structured) {
        self.rows = Rows { first: grid.y(0), width: grid.dy(), count: grid.nj };
        let zeros = vec![0.0; grid.nj];
        self.passage = [zeros.clone(), zeros.clone()];
        self.worn = [zeros.clone(), zeros];
    }

    /// Reads the number of passages of the next window.
    ///
    /// # Errors
    /// A number of passages that is refused.
    pub(crate) fn follow(&mut self, row: &Configuration) -> Result<(), Refusal> {
        self.passes = (self.read_passes)(row)?;
        Ok(())
    }

    /// Total depth worn off both bodies at a lateral position [m], linear between the rows.
    pub(crate) fn depth(&self, y: f64) -> f64 {
        let Rows { first, width, count } = self.rows;
        if count == 0 {
            return 0.0;
        }
        let place = ((y - first) / width).clamp(0.0, (count - 1) as f64);
        let low = (place as usize).min(count.saturating_sub(2));
        let share = place - low as f64;
        let of = |worn: &Vec<f64>| {
            let high = worn[(low + 1).min(count - 1)];
            worn[low] + share * (high - worn[low])
        };
        self.worn.iter().map(of).sum()
    }

    /// Depths that one passage removes from both bodies in a row of elements [m].
    fn depths(&self, grid: &Structured, contact: &Accepted<'_>, row: usize) -> [f64; 2] {
        let elements = row * grid.ni..(row + 1) * grid.ni;
        let driving: f64 = elements.map(|at| self.law.driving(contact, at)).sum();
        let mut depths = self.law.factors();
        for (depth, speed) in depths.iter_mut().zip(contact.surface_speed) {
            let per_speed = if *depth == 0.0 { 0.0 } else { *depth / speed };
            *depth = per_speed * driving * grid.dx();
        }
        depths
    }

    /// Adds the passages of the accepted contact to the worn depths.
    pub(crate) fn take(&mut self, grid: &Structured, contact: &Accepted<'_>) {
        for row in 0..self.rows.count {
            for (body, depth) in self.depths(grid, contact, row).into_iter().enumerate() {
                self.passage[body][row] = depth;
            }
        }
        for (worn, passage) in self.worn.iter_mut().zip(&self.passage) {
            for (sum, depth) in worn.iter_mut().zip(passage) {
                *sum += self.passes * depth;
            }
        }
    }

    /// Refuses a contact that wears more in a window than the profile can follow.
    ///
    /// # Errors
    /// More passages in a window than the profile can follow.
    pub(crate) fn refuse_too_much(
        &self,
        grid: &Structured,
        contact: &Accepted<'_>,
    ) -> Result<(), StepError> {
        let stiffness = 0.5 * PI / (self.compliance * self.rows.width);
        let mut largest = 0.0_f64;
        for row in 0..self.rows.count {
            let elements = &contact.normal_pressure[row * grid.ni..(row + 1) * grid.ni];
            let pressure = elements.iter().copied().fold(0.0, f64::max);
            if pressure > 0.0 {
                let [upper, lower] = self.depths(grid, contact, row);
                largest = largest.max(stiffness * (upper + lower) / pressure);
            }
        }
        let most = (2.0 / largest).floor();
        if self.passes <= most {
            return Ok(());
        }
        Err(StepError::NoSolution(format!(
            "{} passages in one window remove more from single rows of elements than their neighbours can compensate: write at most {most} in a row of the \
             history, or a smaller mech.lateral_resolution",
            self.passes
        )))
    }

    /// Writes the requested fields of the accepted depths, on every element of the grid.
    pub(crate) fn write(&self, outputs: &mut dyn Outputs) {
        for (field, worn) in self.fields.iter().zip(&self.worn) {
            let Some(values) = outputs.get(field) else { continue };
            let columns = values.len() / self.rows.count;
            for (row, depth) in values.chunks_exact_mut(columns).zip(worn) {
                row.fill(*depth);
            }
        }
    }

    /// Name and content of the section of `summary.json`.
    pub(crate) fn summary(&self) -> (&'static str, Value) {
        let section = |body: usize| {
            let [passage, worn] = [&self.passage[body], &self.worn[body]];
            let largest = |of: &[f64]| of.iter().copied().fold(0.0, f64::max);
            let area = |of: &[f64]| of.iter().sum::<f64>() * self.rows.width;
            json!({
                "depth_per_passage_m": largest(passage),
                "area_per_passage_m2": area(passage),
                "max_depth_m": largest(worn),
                "worn_area_m2": area(worn),
            })
        };
        let named = self.names.0.iter().enumerate();
        let bodies: Map<_, _> = named.map(|(body, name)| (name.clone(), section(body))).collect();
        (self.section, Value::Object(bodies))
    }
}

impl State for Removal {
    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        write_numbers(into, self.worn.iter().chain(&self.passage).flatten())
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        Ok(read_numbers(from, self.worn.iter_mut().chain(&mut self.passage).flatten())?)
    }
}
