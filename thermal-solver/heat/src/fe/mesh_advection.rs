//! Advection of a body's mesh through the moving frame in a window, step by step.

use super::scheme::{Coefficients, Scheme};
use grids::state::{read_bytes, read_numbers, write_numbers};
use std::io::{self, Read, Write};

/// Fraction of an element that counts as rounding.
const ROUNDING: f64 = 1e-9;
/// Steps, in parts of the first step, with which a cold body begins: the surface follows a flux
/// that begins at once to 0.5 %. With a single step, which is one of backward Euler, the first rise
/// would be 11 % too low, the second 6 %.
const BEGINNING: [f64; 3] = [1.0 / 7.0, 2.0 / 7.0, 4.0 / 7.0];
/// Columns beyond the length of the mesh after which no earlier content is left on it.
const REPLACED: usize = 8;

/// Position of a mesh, with data of its last step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Position {
    /// Distance of the columns in front of their nominal positions, in elements, below one.
    pub front: f64,
    /// Columns by which the mesh was shifted in the last step.
    pub shifted: usize,
    /// Duration of the last step [s].
    pub step: f64,
    /// Number of steps since the body was cold.
    pub steps: u64,
}

/// One of the equal steps of a window, or a part of it.
#[derive(Clone, Copy)]
struct Stride {
    /// Duration [s].
    duration: f64,
    /// Distance in elements.
    way: f64,
}

impl Position {
    /// Writes the position.
    ///
    /// # Errors
    /// Writing to `into` fails.
    pub fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        write_numbers(into, &[self.front, self.step])?;
        into.write_all(&(self.shifted as u64).to_le_bytes())?;
        into.write_all(&self.steps.to_le_bytes())
    }

    /// Restores the position written by [`Position::save`].
    ///
    /// # Errors
    /// The data end too early, or are not a valid position.
    pub fn restore(from: &mut dyn Read) -> io::Result<Self> {
        let mut numbers = [0.0; 2];
        read_numbers(from, &mut numbers)?;
        let [front, step] = numbers;
        let shifted = u64::from_le_bytes(read_bytes(from)?) as usize;
        let steps = u64::from_le_bytes(read_bytes(from)?);
        if shifted > 1 || !(0.0..1.0).contains(&front) {
            return Err(io::Error::other("the mesh has no valid position"));
        }
        Ok(Self { front, shifted, step, steps })
    }
}

/// One time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Duration [s].
    pub duration: f64,
    /// Number of columns by which the mesh is shifted at the beginning of the step, relative to the
    /// state one step ago and to the state two steps ago.
    pub shifts: [usize; 2],
    /// Coefficients of the scheme.
    pub by: Coefficients,
    /// Duration of this step over that of the previous step.
    pub over_last: f64,
    /// Distance of the columns in front of their nominal positions in the middle of the step, in
    /// elements.
    pub middle: f64,
}

impl Step {
    /// Computes the heat that columns receive in the step from these means of the flux. For a
    /// scheme with memory, the means of the previous step enter as well: the scheme combines both
    /// heats as it combines the temperature changes that they cause.
    pub fn receive(&self, means: &[f64], last: &mut [f64], heat: &mut [f64]) {
        let [new, _, old] = self.by.a;
        heat.copy_from_slice(means);
        if old != 0.0 {
            let before = last[self.shifts[0]..].iter().copied().chain(std::iter::repeat(0.0));
            for (heat, before) in heat.iter_mut().zip(before) {
                *heat = new * *heat + old * self.over_last * before;
            }
        }
        last.copy_from_slice(&means[..last.len()]);
    }
}

/// The steps of a window.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshAdvection {
    /// The steps.
    pub steps: Vec<Step>,
    /// Whether nothing on the mesh before the window remains at its end: the mesh starts cold.
    pub fresh: bool,
    /// Position of the mesh at the end.
    pub position: Position,
}

impl MeshAdvection {
    /// Plans a window of this duration [s] at this speed [elements/s] on a mesh of `columns`
    /// columns. Steps are at most one element and at most `longest` [s]; the first step of a cold
    /// body is divided.
    pub fn plan(
        &mut self,
        from: &Position,
        [duration, speed, longest]: [f64; 3],
        columns: usize,
        scheme: Scheme,
    ) {
        let way = duration * speed;
        let count = (way * (1.0 - ROUNDING)).max(duration / longest * (1.0 - ROUNDING)).ceil();
        let count = count.max(1.0);
        let (step, part) = (duration / count, way / count);
        self.fresh = way > (columns + REPLACED) as f64;
        let count = if self.fresh { (columns + REPLACED) as f64 / part } else { count };
        let whole = Stride { duration: step, way: part };
        let part = |share: f64| Stride { duration: share * step, way: share * part };
        self.position = if self.fresh { Position::default() } else { *from };
        self.steps.clear();
        for index in 0..count.ceil() as usize {
            // A fresh mesh is cold long before the end of the window.
            if index == 0 && self.position.steps == 0 && !self.fresh {
                BEGINNING.map(part).into_iter().for_each(|stride| self.add(stride, scheme));
            } else {
                self.add(whole, scheme);
            }
        }
    }

    /// Adds a step after the position, and moves the position to its end.
    fn add(&mut self, Stride { duration, way }: Stride, scheme: Scheme) {
        let at = self.position;
        let over = if at.step > 0.0 { duration / at.step } else { 1.0 };
        let mut front = at.front - way;
        if front.abs() < ROUNDING {
            front = 0.0;
        }
        let shift = if front < 0.0 { 1 } else { 0 };
        front += shift as f64;
        if front > 1.0 - ROUNDING {
            front = 0.0;
        }
        self.steps.push(Step {
            duration,
            shifts: [shift, shift + at.shifted],
            by: scheme.coefficients(at.steps, over),
            over_last: 1.0 / over,
            middle: front + 0.5 * way,
        });
        self.position = Position { front, shifted: shift, step: duration, steps: at.steps + 1 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(from: &Position, way: f64) -> MeshAdvection {
        let mut creep = MeshAdvection::default();
        creep.plan(from, [1.0, way, f64::INFINITY], 50, Scheme::CrankNicolson);
        creep
    }

    #[test]
    fn whole_elements_stay_at_their_places() {
        let creep = plan(&Position { steps: 9, ..Position::default() }, 3.0);
        assert_eq!(creep.steps.len(), 3);
        assert!(creep.steps.iter().all(|step| step.shifts[0] == 1 && step.middle == 0.5));
        assert_eq!(creep.position.front, 0.0);
    }

    /// The first step of a cold body is divided; its parts end where the whole step would.
    #[test]
    fn a_cold_body_begins_with_short_steps() {
        let creep = plan(&Position::default(), 3.0);
        assert_eq!(creep.steps.len(), 5);
        let shifts: Vec<usize> = creep.steps.iter().map(|step| step.shifts[0]).collect();
        assert_eq!((shifts, creep.position.front), (vec![1, 0, 0, 1, 1], 0.0));
        let time: f64 = creep.steps.iter().map(|step| step.duration).sum();
        assert!((time - 1.0).abs() < 1e-15, "{time}");
    }

    /// The mesh moves as far as the body, for any windows. Tolerance: rounding.
    #[test]
    fn shifts_and_places_add_up_to_the_way() {
        let (mut at, mut shifted, mut way) = (Position::default(), 0, 0.0);
        for part in [0.3, 1.7, 0.0, 0.3, 2.25, 1e-3, 7.0] {
            let creep = plan(&at, part);
            shifted += creep.steps.iter().map(|step| step.shifts[0]).sum::<usize>();
            way += part;
            at = creep.position;
            assert!((0.0..1.0).contains(&at.front));
            assert!((shifted as f64 - at.front - way).abs() < 1e-8, "{shifted} {} {way}", at.front);
        }
    }

    #[test]
    fn a_long_window_keeps_only_what_is_on_the_mesh() {
        let creep = plan(&Position { front: 0.5, ..Position::default() }, 1e9);
        assert!(creep.fresh && creep.steps.len() == 58);
    }
}
