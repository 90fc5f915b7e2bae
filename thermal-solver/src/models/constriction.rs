//! Electric current through a stationary contact, and the temperatures it causes
//! ([`crate::effects::joule_heat`]).
//!
//! The potentials are computed by a second instance of the thermal model. Its bodies have the
//! conductivity 1/ρ, and the upper one is initially 1 V above the lower one, so that the exchanged
//! flow is the conductance of the contact.

use super::conduction::{Conduction, InterfaceLoad};
use super::frame::Frame;
use crate::effects::contact_conductance::Conductance;
use crate::effects::joule_heat::Current;
use crate::{LOWER, UPPER};
use heat::Material;
use heat::window::{Drive, Stage};
use proto::model::StepError;
use proto::state::{read_numbers, write_numbers};
use serde_json::{Value, json};
use std::io::{self, Read, Write};

/// Film conductance that represents the absence of a film, relative to that of the better conductor
/// over the length of the grid. The relative error of the potentials is the inverse.
const NO_FILM: f64 = 1e9;

/// Current through the contact, and the model of its potentials.
pub(super) struct Constriction<C> {
    current: Current,
    /// Product λρ of both bodies [V²/K].
    products: [f64; 2],
    potentials: C,
    /// Potentials relative to the far ends, for 1 V over the contact [V].
    rises: [Vec<f64>; 2],
    /// Voltage U over the contact [V].
    voltage: f64,
    /// Constants c of both bodies [K/V].
    constants: [f64; 2],
}

impl<C: Conduction> Constriction<C> {
    /// Creates the model of a case with a current; `None` without one.
    pub(super) fn of(frame: &Frame) -> Option<Self> {
        let current = frame.current?;
        let mut electric = frame.clone();
        electric.current = None;
        for (material, resistivity) in
            electric.scene.materials.iter_mut().zip(current.resistivities)
        {
            *material = Material { conductivity: 1.0 / resistivity, ..*material };
        }
        electric.scene.initial_temperatures = [1.0, 0.0];
        let length = frame.grid.ni as f64 * frame.grid.dx();
        let best = electric.scene.materials.iter().map(|one| one.conductivity).fold(0.0, f64::max);
        electric.conductance =
            Some(Conductance { conductance: NO_FILM * best / length, hardness: None, gas: None });
        let products = [UPPER, LOWER]
            .map(|body| frame.scene.materials[body].conductivity * current.resistivities[body]);
        let zeros = vec![0.0; frame.grid.points()];
        Some(Self {
            current,
            products,
            potentials: C::new(&electric),
            rises: [zeros.clone(), zeros],
            voltage: 0.0,
            constants: [0.0; 2],
        })
    }

    /// Computes the potentials under a pressure, and adds the rises due to the current to those of
    /// the surfaces [K]. Returns the operation count.
    pub(super) fn solve(
        &mut self,
        frame: &Frame,
        drive: &Drive,
        rub: &InterfaceLoad<'_>,
        rise: &mut [Vec<f64>; 2],
    ) -> Result<u64, StepError> {
        let none = vec![0.0; rub.flux.len()];
        let rub = InterfaceLoad { flux: &none, pressure: rub.pressure, gap: None };
        let work = self.potentials.solve(drive, &rub, &mut self.rises)?;
        let conductance = frame.grid.element_area() * self.potentials.exchanged().unwrap_or(0.0);
        if conductance <= 0.0 {
            return Err(StepError::NoSolution(
                "the surfaces do not touch: no current flows".to_owned(),
            ));
        }
        self.voltage = self.current.current / conductance;
        // The voltage divides in proportion to the resistivities, because the contact is the same
        // for both bodies.
        let sum: f64 = self.current.resistivities.iter().sum();
        let falls = self.current.resistivities.map(|one| self.voltage * one / sum);
        self.constants = Current::constants(falls, self.products);
        for body in [UPPER, LOWER] {
            for (rise, potential) in rise[body].iter_mut().zip(&self.rises[body]) {
                *rise += self.warmth(body, *potential);
            }
        }
        Ok(work.operations)
    }

    /// Rise at a point whose potential differs by `potential` from that of the far end, for 1 V
    /// over the contact [K].
    fn warmth(&self, body: usize, potential: f64) -> f64 {
        let fall = self.voltage * potential.abs();
        self.constants[body] * fall - 0.5 * fall * fall / self.products[body]
    }

    /// Accepts the potentials of the last solve.
    pub(super) fn accept(&mut self) {
        self.potentials.accept();
    }

    /// Writes the accepted state.
    ///
    /// # Errors
    /// Writing to `into` fails.
    pub(super) fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        write_numbers(into, self.constants.iter().chain([&self.voltage]))?;
        self.potentials.save(into)
    }

    /// Reads a state that [`Constriction::save`] wrote.
    ///
    /// # Errors
    /// Reading fails; the state is then unchanged.
    pub(super) fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        let mut numbers = [0.0; 3];
        read_numbers(from, &mut numbers)?;
        self.potentials.restore(from)?;
        let [upper, lower, voltage] = numbers;
        (self.constants, self.voltage) = ([upper, lower], voltage);
        Ok(())
    }

    /// Adds the rises due to the current to a section; arguments as in [`Conduction::section`].
    pub(super) fn add_section(
        &mut self,
        stage: Stage,
        body: usize,
        row: usize,
        depths: &[f64],
        rise: &mut [f64],
    ) {
        let mut potentials = vec![0.0; rise.len()];
        let depths: Vec<f64> = depths.iter().map(|depth| self.own_depth(body, *depth)).collect();
        self.potentials.section(stage, body, row, &depths, &mut potentials);
        for (rise, potential) in rise.iter_mut().zip(potentials) {
            *rise += self.warmth(body, potential);
        }
    }

    /// Rise due to the current at a point; arguments as in [`Conduction::rise_at`].
    pub(super) fn rise_at(&self, body: usize, row: usize, x: f64, depth: f64) -> f64 {
        let depth = self.own_depth(body, depth);
        self.warmth(body, self.potentials.rise_at(body, row, x, depth))
    }

    /// Converts a depth z/(2√κ) of the heat to that of the potentials [√s], whose κ contains 1/ρ
    /// instead of λ.
    fn own_depth(&self, body: usize, depth: f64) -> f64 {
        depth * self.products[body].sqrt()
    }

    /// Returns the section `current` of the summary.
    pub(super) fn figures(&self) -> Value {
        let (voltage, current) = (self.voltage, self.current.current);
        let sum: f64 = self.current.resistivities.iter().sum();
        json!({
            "voltage_v": voltage,
            "resistance_ohm": voltage / current,
            "power_w": voltage * current,
            "rise_k": self.warmth(UPPER, self.current.resistivities[UPPER] / sum),
        })
    }
}
