//! The part of a model that all implementations of [`Conduction`] share: inputs, outputs, state.

use super::conduction::{Conduction, InterfaceLoad};
use super::constriction::Constriction;
use super::fields::{RISE_INTEGRALS, SECTIONS, SURFACES};
use super::frame::{Frame, LEVELS};
use super::inputs::{checked, drive, refuse_without_height};
use super::previous_passages::Background;
use super::summary::{self, Peak, Solution};
use super::transforming::{self, Transforming};
use super::white_layer::{Cycle, WhiteLayer};
use crate::UPPER;
use crate::effects::friction_heat::Partition;
use crate::effects::volume_temperature::VOLUMES;
use heat::window::{Drive, Stage};
use proto::configuration::Mode;
use proto::field;
use proto::grid::{Grid, Structured};
use proto::model::{
    Inputs, Model, Outputs, StateError, Step, StepError, StepReport, first_non_finite,
};
use proto::state::{read_bytes, read_numbers, write_numbers};
use std::io::{self, Read, Write};

const STATE_VERSION: u8 = 2;
/// Largest depth searched for transformed steel in a stationary body, in lengths of the grid.
const DEEPEST: f64 = 2.0;
/// Share of the peak rise from which on an element counts as hottest.
const AS_HOT: f64 = 0.999;

/// Heat into the bodies, summed over the elements [W/m²].
#[derive(Clone, Copy, Default)]
struct Heat {
    /// Shares of the friction heat.
    shares: [f64; 2],
    /// Exchanged flux from the upper into the lower body.
    exchanged: f64,
}

/// A [`proto::model::Model`] built on a [`Conduction`].
pub struct ConductionModel<C> {
    frame: Frame,
    conduction: C,
    trial: [Vec<f64>; 2],
    accepted: [Vec<f64>; 2],
    solved: bool,
    /// Rises integrated over the depth after the last solve [K·m], if an effect needs them.
    integrals: Option<[Vec<f64>; 2]>,
    /// Effect of an electric current through the contact, if the case has one.
    constriction: Option<Constriction<C>>,
    /// Rises that earlier passages have left, if `bulk_heating` is active.
    background: Option<Background>,
    /// Speeds of both surfaces in the last solve [m/s].
    speeds: [f64; 2],
    /// Heat into the bodies in the last solve.
    heat: Heat,
    /// Heat into the bodies in the accepted state.
    accepted_heat: Heat,
    /// Transformed layers of a steady case in the accepted state.
    layers: [Option<WhiteLayer>; 2],
    /// Transformation followed in time, if `phase_transformation` is active in a transient case.
    transforming: Option<[Transforming; 2]>,
    /// Duration of the last window [s].
    duration: f64,
    /// Largest difference of the surface temperatures under friction over the largest rise, in the
    /// last solve; `None` if heat flows between the surfaces.
    trial_difference: Option<f64>,
    /// The same in the accepted state.
    difference: Option<f64>,
    /// Grids of the bodies' elements whose rises are written out.
    volumes: Vec<Grid>,
}

impl<C: Conduction> ConductionModel<C> {
    /// Creates the model with both bodies at their initial temperature.
    #[must_use]
    pub fn new(frame: Frame, volumes: Vec<Grid>, expands: bool) -> Self {
        let zero = vec![0.0; frame.grid.points()];
        Self {
            integrals: expands.then(|| [zero.clone(), zero.clone()]),
            conduction: C::new(&frame),
            constriction: Constriction::of(&frame),
            background: frame.memories.map(|memories| Background::new(memories, frame.grid.nj)),
            speeds: frame.scene.speeds,
            heat: Heat::default(),
            accepted_heat: Heat::default(),
            layers: [None, None],
            transforming: (frame.criterion.is_some() && frame.mode == Mode::Transient)
                .then(|| [Transforming::new(&frame.grid), Transforming::new(&frame.grid)]),
            duration: f64::INFINITY,
            trial_difference: None,
            difference: None,
            trial: [zero.clone(), zero.clone()],
            accepted: [zero.clone(), zero],
            solved: false,
            volumes,
            frame,
        }
    }

    fn write_integrals(&self, outputs: &mut dyn Outputs) {
        for (spec, integral) in RISE_INTEGRALS.iter().zip(self.integrals.iter().flatten()) {
            if let Some(values) = outputs.get(spec) {
                values.copy_from_slice(integral);
            }
        }
    }

    fn write_sections(&mut self, stage: Stage, outputs: &mut dyn Outputs) {
        let row = self.frame.section_row();
        for (body, section) in SECTIONS.iter().enumerate() {
            let Some(values) = outputs.get(section) else { continue };
            let spacing = self.frame.level_spacing(body);
            let depth = |level: usize| self.frame.depth(body, level as f64 * spacing);
            let depths: [f64; LEVELS] = std::array::from_fn(depth);
            self.conduction.section(stage, body, row, &depths, values);
            if let Some(constriction) = &mut self.constriction {
                constriction.add_section(stage, body, row, &depths, values);
            }
            // A section is thin compared with the depth of the earlier heat, which is uniform
            // across it.
            if let Some(background) = &self.background {
                let before = background.at(body, row);
                values.iter_mut().for_each(|rise| *rise += before);
            }
        }
    }

    /// Adds the rises that earlier passages have left to those of the surfaces.
    fn add_background(
        &mut self,
        drive: &Drive,
        flux: &[f64],
        heat: [f64; 2],
    ) -> Result<(), StepError> {
        let Some(background) = &mut self.background else { return Ok(()) };
        let area = self.frame.grid.element_area();
        background.take(&self.frame, drive, flux, heat.map(|sum| area * sum))?;
        for (body, rise) in self.trial.iter_mut().enumerate() {
            for (row, values) in rise.chunks_exact_mut(self.frame.grid.ni).enumerate() {
                let before = background.at(body, row);
                values.iter_mut().for_each(|rise| *rise += before);
            }
        }
        Ok(())
    }

    /// Returns the centre of the elements that are as hot as the hottest one. With a current the
    /// whole contact has nearly the same temperature.
    fn middle_of_hottest(&self, body: usize, rise: &[f64]) -> Option<Peak> {
        let grid = &self.frame.grid;
        let highest = rise.iter().copied().fold(0.0, f64::max);
        let hot = |(_, value): &(usize, &f64)| **value >= AS_HOT * highest;
        if highest <= 0.0 {
            return None;
        }
        let (mut x, mut y, mut count) = (0.0, 0.0, 0.0);
        for (at, _) in rise.iter().enumerate().filter(hot) {
            (x, y, count) = (x + grid.x(at % grid.ni), y + grid.y(at / grid.ni), count + 1.0);
        }
        let (x, y) = (x / count, y / count);
        let row = (((y - grid.y(0)) / grid.dy()).round().max(0.0) as usize).min(grid.nj - 1);
        Some(Peak { rise: self.rise_at(body, row, x, 0.0), x, y, row })
    }

    /// Follows the transformation over the accepted window; `trial` holds the rises at its start.
    fn transform_in_time(&mut self) {
        let Self { frame, conduction, transforming, trial, accepted, speeds, duration, .. } = self;
        let (Some(criterion), Some(bodies)) = (frame.criterion, transforming) else { return };
        let mut rises = vec![0.0; frame.grid.ni + frame.behind()];
        for (body, transforming) in bodies.iter_mut().enumerate() {
            let criterion = criterion.over(frame.scene.initial_temperatures[body]);
            let window = transforming::Window {
                rises: [&trial[body], &accepted[body]],
                duration: *duration,
                speed: speeds[body],
                diffusivity: frame.scene.materials[body].diffusivity(),
            };
            let highest = |row: usize, depth: f64| {
                let depth = [frame.depth(body, depth)];
                conduction.section(Stage::Accepted, body, row, &depth, &mut rises);
                rises.iter().copied().fold(0.0, f64::max)
            };
            transforming.follow(&window, &criterion, highest);
        }
    }

    /// Evaluates the transformation in the accepted state.
    fn transform(&mut self) {
        if self.transforming.is_some() {
            return self.transform_in_time();
        }
        let Self { frame, conduction, background, accepted, layers, speeds, .. } = self;
        let Some(criterion) = frame.criterion else { return };
        let columns = frame.grid.ni;
        let mut rises = vec![0.0; columns + frame.behind()];
        for body in 0..2 {
            let mut criterion = criterion.over(frame.scene.initial_temperatures[body]);
            let rests = speeds[body] == 0.0;
            if rests {
                // Points of a stationary body stay hot: the cooling rate is not a criterion.
                criterion.critical_rate = 0.0;
            }
            let passing = frame.grid.dx() / speeds[body];
            let deepest = match rests {
                true => DEEPEST * columns as f64 * frame.grid.dx(),
                false => (LEVELS - 1) as f64 * frame.level_spacing(body),
            };
            let along = |row: usize, depth: f64| {
                let depth = [frame.depth(body, depth)];
                conduction.section(Stage::Accepted, body, row, &depth, &mut rises);
                let before = background.as_ref().map_or(0.0, |before| before.at(body, row));
                rises.iter_mut().for_each(|rise| *rise += before);
                match rests {
                    true => Cycle::at_rest(&rises),
                    false => Cycle::of(&rises, passing, criterion.start),
                }
            };
            // Rows below the start temperature do not transform; of these only the hottest is
            // evaluated, for its margin.
            let highest = |row: &usize| {
                let values = &accepted[body][row * columns..(row + 1) * columns];
                values.iter().copied().fold(0.0, f64::max)
            };
            let hottest = (0..frame.grid.nj).max_by(|a, b| highest(a).total_cmp(&highest(b)));
            let rows = (0..frame.grid.nj)
                .filter(|row| Some(*row) == hottest || highest(row) >= criterion.start);
            let layer = WhiteLayer::of(rows, &criterion, deepest, along);
            let warm = |row: &[f64]| row.iter().filter(|rise| **rise >= criterion.start).count();
            let longest = accepted[body].chunks_exact(columns).map(warm).max().unwrap_or(0);
            layers[body] = Some(match rests {
                true => layer.with_length(longest as f64 * frame.grid.dx()),
                false => layer,
            });
        }
    }

    /// Returns the largest difference of the surface temperatures where friction heats them, over
    /// the largest rise. `None` if the model computes the heat that flows between the surfaces.
    fn difference(&self, flux: &[f64]) -> Option<f64> {
        if self.frame.conductance.is_some() || self.frame.partition == Partition::Continuity {
            return None;
        }
        let [upper, lower] = self.frame.scene.initial_temperatures;
        let [of_upper, of_lower] = &self.trial;
        let (mut apart, mut largest) = (0.0_f64, 0.0_f64);
        let rises = of_upper.iter().zip(of_lower);
        for (_, (one, other)) in flux.iter().zip(rises).filter(|(flux, _)| **flux > 0.0) {
            apart = apart.max((upper - lower + one - other).abs());
            largest = largest.max(one.abs()).max(other.abs());
        }
        (largest > 0.0).then_some(apart / largest)
    }

    /// Refuses rises that are not finite, such as those of speeds whose powers overflow.
    fn refuse_no_numbers(&self, drive: &Drive) -> Result<(), StepError> {
        for (body, rise) in self.trial.iter().enumerate() {
            if let Some(index) = first_non_finite(rise) {
                let (name, value, speed) =
                    (&self.frame.scene.names.0[body], rise[index], drive.speeds[body]);
                return Err(StepError::NoSolution(format!(
                    "the rise of `{name}` is {value} K at {speed:e} m/s; write another motion.speed"
                )));
            }
        }
        Ok(())
    }

    /// Restores the heat conduction, and the potentials of a current; both or neither.
    fn restore_conduction(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        let Some(constriction) = &mut self.constriction else {
            return Ok(self.conduction.restore(from)?);
        };
        let mut before = Vec::new();
        constriction.save(&mut before)?;
        constriction.restore(from)?;
        if let Err(error) = self.conduction.restore(from) {
            constriction.restore(&mut before.as_slice())?;
            return Err(error.into());
        }
        Ok(())
    }

    fn header(&self) -> [u8; 17] {
        let mut header = [0; 17];
        header[0] = C::STATE_TAG;
        header[1..9].copy_from_slice(&(self.frame.grid.ni as u64).to_le_bytes());
        header[9..].copy_from_slice(&(self.frame.grid.nj as u64).to_le_bytes());
        header
    }
}

impl<C: Conduction> Model for ConductionModel<C> {
    fn solve(
        &mut self,
        step: &Step,
        inputs: &dyn Inputs,
        outputs: &mut dyn Outputs,
    ) -> Result<StepReport, StepError> {
        self.solved = false;
        let flux = checked(inputs, &field::FRICTION_POWER, self.frame.grid.points())?;
        let drive = drive(&self.frame, C::SOLVES_STATIONARY_BODY, C::REPEATS, step, inputs)?;
        (self.speeds, self.duration) = (drive.speeds, drive.duration);
        if self.integrals.is_some() && !C::ENDS {
            refuse_without_height(&self.frame, &drive)?;
        }
        let pressure = match self.frame.feels_pressure() {
            true => Some(checked(inputs, &field::PRESSURE, self.frame.grid.points())?.values),
            false => None,
        };
        let gap = match self.frame.feels_gap() {
            true => Some(checked(inputs, &field::GAP, self.frame.grid.points())?.values),
            false => None,
        };
        let rub = InterfaceLoad { flux: flux.values, pressure, gap };
        let work = self.conduction.solve(&drive, &rub, &mut self.trial)?;
        self.refuse_no_numbers(&drive)?;
        let exchanged = self.conduction.exchanged().unwrap_or(0.0);
        self.heat = Heat { shares: work.heat, exchanged };
        self.add_background(&drive, flux.values, work.heat)?;
        let mut operations = work.operations;
        if let Some(constriction) = &mut self.constriction {
            operations += constriction.solve(&self.frame, &drive, &rub, &mut self.trial)?;
        }
        self.trial_difference = self.difference(flux.values);
        self.solved = true;
        for (surface, rise) in SURFACES.iter().zip(&self.trial) {
            if let Some(values) = outputs.get(surface) {
                values.copy_from_slice(rise);
            }
        }
        for (body, integral) in self.integrals.iter_mut().flatten().enumerate() {
            operations += self.conduction.rise_integral(body, integral);
        }
        self.write_integrals(outputs);
        self.write_sections(Stage::Trial, outputs);
        let area = self.frame.grid.element_area();
        Ok(StepReport {
            substeps: 1,
            inner_iterations: 0,
            work: operations,
            received_power: Some(area * work.heat[0] + area * work.heat[1]),
            wanted_window: None,
        })
    }

    fn first_outputs(&mut self, outputs: &mut dyn Outputs) {
        for spec in SECTIONS.into_iter().chain(&VOLUMES) {
            if let Some(values) = outputs.get(spec) {
                values.fill(0.0);
            }
        }
        for body in 0..2 {
            let first = self.conduction.first(body);
            for (spec, value) in [SURFACES[body], RISE_INTEGRALS[body]].into_iter().zip(first) {
                if let Some(values) = outputs.get(spec) {
                    values.fill(value);
                }
            }
        }
    }

    fn accept(&mut self) {
        if self.solved {
            std::mem::swap(&mut self.trial, &mut self.accepted);
            self.accepted_heat = self.heat;
            self.difference = self.trial_difference;
            self.conduction.accept();
            self.constriction.iter_mut().for_each(Constriction::accept);
            self.transform();
            self.solved = false;
        }
    }

    fn observe(&mut self, outputs: &mut dyn Outputs) {
        for (surface, rise) in SURFACES.iter().zip(&self.accepted) {
            if let Some(values) = outputs.get(surface) {
                values.copy_from_slice(rise);
            }
        }
        self.write_integrals(outputs);
        self.write_sections(Stage::Accepted, outputs);
        for (body, volume) in VOLUMES.iter().enumerate() {
            if let Some(values) = outputs.get(volume) {
                self.conduction.rises_in(body, values);
            }
        }
    }

    fn moved_grids(&self) -> &[Grid] {
        &self.volumes
    }

    fn summary(&self) -> serde_json::Value {
        let mut summary = summary::temperature(&self.frame.scene.names, self);
        let Heat { shares, exchanged } = self.accepted_heat;
        let area = self.frame.grid.element_area();
        if self.frame.conductance.is_some() {
            summary["exchange"]["heat_w"] = (area * exchanged).into();
        }
        if let Some(difference) = self.difference {
            summary["surfaces"]["relative_difference"] = difference.into();
        }
        if let Some(constriction) = &self.constriction {
            summary["current"] = constriction.figures();
        }
        for (body, name) in self.frame.scene.names.0.iter().enumerate() {
            if self.conduction.exchanged().is_some() {
                let received = if body == UPPER { -exchanged } else { exchanged };
                summary["temperature"][name]["heat_w"] = (area * (shares[body] + received)).into();
            }
            if let Some(background) = &self.background {
                let [bulk, residual] = background.figures(body);
                summary["temperature"][name]["bulk_rise_k"] = bulk.into();
                summary["temperature"][name]["residual_rise_k"] = residual.into();
            }
            if let Some(layer) = &self.layers[body] {
                summary["white_layer"][name] = layer.figures(self.frame.grid.dy());
            }
            if let Some(bodies) = &self.transforming {
                summary["white_layer"][name] = bodies[body].figures();
            }
        }
        summary
    }

    fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        into.write_all(&[STATE_VERSION])?;
        into.write_all(&self.header())?;
        write_numbers(into, &[self.difference.unwrap_or(f64::NAN)])?;
        write_numbers(into, self.accepted.iter().flatten())?;
        write_numbers(into, self.integrals.iter().flatten().flatten())?;
        write_numbers(into, self.background.iter().flat_map(Background::numbers))?;
        let Heat { shares, exchanged } = &self.accepted_heat;
        write_numbers(into, self.speeds.iter().chain(shares).chain([exchanged]))?;
        self.transforming.iter().flatten().try_for_each(|body| body.save(into))?;
        self.constriction.iter().try_for_each(|constriction| constriction.save(into))?;
        self.conduction.save(into)
    }

    fn restore(&mut self, from: &mut dyn Read) -> Result<(), StateError> {
        let [version] = read_bytes(from)?;
        if version != STATE_VERSION {
            return Err(StateError(format!("its version is {version}, not {STATE_VERSION}")));
        }
        if read_bytes(from)? != self.header() {
            let (columns, rows) = (self.frame.grid.ni, self.frame.grid.nj);
            let reason = format!("another model or grid than this one of {columns} x {rows}");
            return Err(StateError(reason));
        }
        let mut difference = f64::NAN;
        read_numbers(from, [&mut difference])?;
        let mut accepted = self.accepted.clone();
        read_numbers(from, accepted.iter_mut().flatten())?;
        let mut integrals = self.integrals.clone();
        read_numbers(from, integrals.iter_mut().flatten().flatten())?;
        let mut background = self.background.clone();
        read_numbers(from, background.iter_mut().flat_map(Background::numbers_mut))?;
        let (mut speeds, mut heat) = (self.speeds, Heat::default());
        let sums = heat.shares.iter_mut().chain([&mut heat.exchanged]);
        read_numbers(from, speeds.iter_mut().chain(sums))?;
        let transforming = match &self.transforming {
            Some([upper, lower]) => Some([upper.restored(from)?, lower.restored(from)?]),
            None => None,
        };
        self.restore_conduction(from)?;
        (self.speeds, self.accepted_heat) = (speeds, heat);
        self.transforming = transforming;
        self.accepted = accepted;
        self.integrals = integrals;
        self.background = background;
        self.layers = [None, None];
        self.difference = difference.is_finite().then_some(difference);
        self.solved = false;
        if self.transforming.is_none() {
            self.transform();
        }
        Ok(())
    }
}

impl<C: Conduction> Solution for ConductionModel<C> {
    fn grid(&self) -> &Structured {
        &self.frame.grid
    }

    fn surface(&self, body: usize) -> &[f64] {
        &self.accepted[body]
    }

    fn peak(&self, body: usize, rise: &[f64]) -> Option<Peak> {
        let peak = match self.constriction {
            Some(_) => self.middle_of_hottest(body, rise)?,
            None => self.conduction.peak(body, rise)?,
        };
        Some(Peak { rise: peak.rise + self.background(body, peak.row), ..peak })
    }

    fn rise_at(&self, body: usize, row: usize, x: f64, depth: f64) -> f64 {
        let depth = self.frame.depth(body, depth);
        let current =
            self.constriction.as_ref().map_or(0.0, |one| one.rise_at(body, row, x, depth));
        self.conduction.rise_at(body, row, x, depth) + current
    }

    fn depth_scale(&self, body: usize) -> f64 {
        self.frame.level_spacing(body)
    }

    fn background(&self, body: usize, row: usize) -> f64 {
        self.background.as_ref().map_or(0.0, |background| background.at(body, row))
    }
}
