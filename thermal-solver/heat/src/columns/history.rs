//! The heat flux of earlier windows into one body.
//!
//! The flux of a window is needed until the body has carried its material across the whole grid; a
//! body at rest needs it for ever. Windows can be much shorter than that. To bound memory and work,
//! neighbouring windows of the past are merged into one window with their mean flux (weighted with
//! the durations), as long as their total duration does not exceed the smaller of
//!
//! - h/V, the time in which the material passes an element, and
//! - a quarter of their age, so that the recent past, to which the kernel 1/√τ gives most weight,
//!   stays resolved. In a body at rest, where this is the only bound, it is an eighth: merging then
//!   changes the rise under a flux that follows the temperature by less than 10⁻⁴.
//!
//! For windows of any length, at most two remain for each element of the row, and eight for each
//! factor of two between the window and h/V; at rest sixteen for each factor of two in time. A
//! merged window keeps its heat and the path of the material exactly. The newest window is never
//! merged, so that an accepted state reproduces the solve that led to it. Merging moves heat by
//! less than the merged duration D in time. For a flux into the body that changes at the rate q̇
//! the error of the rise stays below q̇ D^1.5/(24 β√π). In a moving body, D ≤ h/V, so that the
//! order is 1.5 in the element length. A constant flux is not changed.

use super::reconstruction::Flux;
use super::stencil::Segment;
use crate::window::Stage;
use grids::state::{read_bytes, read_numbers, write_numbers};
use std::collections::VecDeque;
use std::io::{self, Read, Write};

/// Largest duration of a merged window of a moving body, as a fraction of its age.
const PART_OF_AGE: f64 = 0.25;
/// The same of a body at rest.
const PART_AT_REST: f64 = 0.125;
/// Distance in widths √(4κτ) beyond which no heat has spread.
const SPREAD: f64 = 6.0;

/// A window: mean flux of the interface, and the share of it that enters the body.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    /// Duration [s]; infinite in steady motion.
    pub duration: f64,
    /// Surface speed of the body [m/s].
    pub speed: f64,
    /// Share of the flux that enters the body [-].
    pub share: f64,
    /// Sum of the element means [W/m²].
    pub heat: f64,
    /// The flux.
    pub flux: Flux,
}

/// Accepted windows of a body, newest first, and the trial window.
pub struct History {
    columns: usize,
    rows: usize,
    element_length: f64,
    /// Diffusivity with which heat spreads along the surface [m²/s]; 0 for conduction normal to the
    /// surface.
    diffusivity: f64,
    trial: Window,
    accepted: VecDeque<Window>,
    spare: Vec<Window>,
}

impl History {
    /// Creates an empty history for `rows` rows of `columns` elements of some length [m], along
    /// which heat spreads with a diffusivity [m²/s].
    #[must_use]
    pub fn new(columns: usize, rows: usize, element_length: f64, diffusivity: f64) -> Self {
        let expected = columns + 128;
        let mut spare = Vec::with_capacity(expected);
        spare.push(empty_window(columns, rows));
        Self {
            columns,
            rows,
            element_length,
            diffusivity,
            trial: empty_window(columns, rows),
            accepted: VecDeque::with_capacity(expected),
            spare,
        }
    }

    /// Returns the number of windows of some length \[s\] that a body keeps until `end` \[s\].
    /// `passage` is the time in which its material passes one of the `columns` elements \[s\],
    /// infinite at rest. Two neighbours together last longer than the bound of the merging, which
    /// limits their number; up to twice what is kept.
    #[must_use]
    pub fn expected_windows(columns: usize, passage: f64, window: f64, end: f64) -> usize {
        let all = end / window;
        let (part, longest, needed) = if passage.is_finite() {
            (PART_OF_AGE, passage, end.min(columns as f64 * passage))
        } else {
            (PART_AT_REST, f64::INFINITY, end)
        };
        // Windows up to the age from which on they are merged, up to that from which on they are
        // as long as they may be, and beyond.
        let oldest = needed.min(longest / part);
        let merged = (oldest / window * part / 2.0).max(1.0).ln();
        let beyond = (needed - oldest) / longest.max(window);
        let kept = 2.0 / part * (1.0 + merged) + 2.0 * beyond;
        (all.min(kept).ceil() as usize).max(1)
    }

    /// Returns the trial window, to be filled in.
    pub fn trial_mut(&mut self) -> &mut Window {
        &mut self.trial
    }

    /// Iterates over the windows of a state, newest first.
    pub fn windows(&self, stage: Stage) -> impl Iterator<Item = &Window> + Clone {
        (stage == Stage::Trial).then_some(&self.trial).into_iter().chain(&self.accepted)
    }

    /// Returns window `index` of a state, counted from the newest.
    #[must_use]
    pub fn window(&self, stage: Stage, index: usize) -> Option<&Window> {
        match (stage, index) {
            (Stage::Trial, 0) => Some(&self.trial),
            (Stage::Trial, _) => self.accepted.get(index - 1),
            (Stage::Accepted, _) => self.accepted.get(index),
        }
    }

    /// Returns the past of a state, newest first; `amplitude` is 1/(β√π) of the body.
    pub fn past(
        &self,
        stage: Stage,
        amplitude: f64,
    ) -> impl Iterator<Item = (Segment, &Flux)> + Clone {
        self.windows(stage).map(move |window| {
            let segment = Segment {
                duration: window.duration,
                rate: window.speed / self.element_length,
                factor: window.share * amplitude,
            };
            (segment, &window.flux)
        })
    }

    /// Makes the trial window the newest accepted window, then drops and merges old windows.
    pub fn accept(&mut self) {
        self.forget();
        let mut window = self.spare.pop().unwrap_or_else(|| empty_window(self.columns, self.rows));
        std::mem::swap(&mut window, &mut self.trial);
        self.accepted.push_front(window);
        self.merge();
    }

    /// Drops windows whose material, with the heat spread from it, leaves the grid by the end of
    /// the trial window.
    fn forget(&mut self) {
        let length = self.columns as f64 * self.element_length;
        let (mut passed, mut age) = (0.0, 0.0);
        let needed = self.windows(Stage::Trial).take_while(|window| {
            let before = passed;
            let spread = match self.diffusivity > 0.0 {
                true => SPREAD * (4.0 * self.diffusivity * age).sqrt(),
                false => 0.0,
            };
            passed += window.speed * window.duration;
            age += window.duration;
            before < length + spread
        });
        let keep = needed.count() - 1;
        self.spare.extend(self.accepted.drain(keep..));
    }

    /// Merges neighbouring windows that are short for their age.
    fn merge(&mut self) {
        let Some(mut age) = self.accepted.front().map(|newest| newest.duration) else {
            return;
        };
        let mut index = 1;
        while index + 1 < self.accepted.len() {
            let (newer, older) = (&self.accepted[index], &self.accepted[index + 1]);
            let fastest = newer.speed.max(older.speed);
            let part = if fastest > 0.0 { PART_OF_AGE } else { PART_AT_REST };
            let longest = f64::min(part * age, self.element_length / fastest);
            if newer.duration + older.duration > longest {
                age += newer.duration;
                index += 1;
                continue;
            }
            let newer = self.accepted.remove(index).expect("the index is below the length");
            self.accepted[index].absorb(&newer);
            self.spare.push(newer);
        }
    }

    /// Writes the accepted windows, in the order in which [`History::restore`] reads them.
    ///
    /// # Errors
    /// Writing to `into` fails.
    pub fn save(&self, into: &mut dyn Write) -> io::Result<()> {
        into.write_all(&(self.accepted.len() as u64).to_le_bytes())?;
        for Window { duration, speed, share, heat, flux } in &self.accepted {
            write_numbers(into, &[*duration, *speed, *share, *heat])?;
            flux.save(into)?;
        }
        Ok(())
    }

    /// Restores the windows written by [`History::save`].
    ///
    /// # Errors
    /// Reading fails or the data do not fit; the history is then unchanged.
    pub fn restore(&mut self, from: &mut dyn Read) -> io::Result<()> {
        self.accepted = self.read(from)?;
        Ok(())
    }

    /// Restores the histories of two bodies, written one after the other.
    ///
    /// # Errors
    /// Reading fails or the data do not fit; both histories are then unchanged.
    pub fn restore_pair(pair: &mut [Self; 2], from: &mut dyn Read) -> io::Result<()> {
        let [first, second] = pair;
        let accepted = [first.read(from)?, second.read(from)?];
        [first.accepted, second.accepted] = accepted;
        Ok(())
    }

    fn read(&self, from: &mut dyn Read) -> io::Result<VecDeque<Window>> {
        let mut accepted = VecDeque::with_capacity(self.accepted.capacity());
        for _ in 0..u64::from_le_bytes(read_bytes(from)?) {
            let mut window = empty_window(self.columns, self.rows);
            let mut numbers = [0.0; 4];
            read_numbers(from, &mut numbers)?;
            [window.duration, window.speed, window.share, window.heat] = numbers;
            window.flux.restore(from)?;
            accepted.push_back(window);
        }
        Ok(accepted)
    }
}

impl Window {
    /// Replaces this window by the mean of itself and a neighbour.
    fn absorb(&mut self, other: &Self) {
        let (own, others) = (self.duration, other.duration);
        let mean = |a: f64, b: f64, of_a: f64, of_b: f64| {
            if a == b { a } else { (of_a * a + of_b * b) / (of_a + of_b) }
        };
        // Shares are weighted with the heat, so that the body keeps its own. If the heats differ in
        // sign, the weights are the durations instead.
        let (own_heat, others_heat) = (own * self.heat, others * other.heat);
        let (of_own, of_others) =
            if own_heat * others_heat > 0.0 { (own_heat, others_heat) } else { (own, others) };
        self.speed = mean(self.speed, other.speed, own, others);
        self.share = mean(self.share, other.share, of_own, of_others);
        self.heat = mean(self.heat, other.heat, own, others);
        self.flux.merge(own, &other.flux, others);
        self.duration = own + others;
    }
}

fn empty_window(columns: usize, rows: usize) -> Window {
    Window { duration: 0.0, speed: 0.0, share: 0.0, heat: 0.0, flux: Flux::zero(columns, rows) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn push(history: &mut History, duration: f64, means: &[f64], speed: f64) {
        let window = history.trial_mut();
        (window.duration, window.speed, window.share) = (duration, speed, speed / 8.0);
        window.heat = means.iter().sum();
        window.flux.reconstruct(means);
        history.accept();
    }

    fn assert_expected(most: usize, expected: usize) {
        assert!(most <= expected && expected <= 2 * most, "{most} kept, {expected} expected");
    }

    #[test]
    fn short_windows_stay_bounded_and_cover_the_grid() {
        let (columns, h, speed) = (16, 1e-3, 1.0);
        let mut history = History::new(columns, 1, h, 0.0);
        let mut most = 0;
        for _ in 0..60_000 {
            push(&mut history, 1e-6, &[1.0; 16], speed);
            most = most.max(history.accepted.len());
        }
        // Ten factors of two lie between 1e-6 s and h/V.
        assert_expected(most, History::expected_windows(columns, h / speed, 1e-6, 0.06));
        let covered: f64 = history.windows(Stage::Accepted).map(|w| w.duration).sum();
        assert!(covered >= columns as f64 * h / speed && covered < 1.1 * columns as f64 * h);
        assert!(
            history.accepted.len() + history.spare.len() <= most + 1,
            "the memory of dropped windows is reused"
        );
    }

    #[test]
    fn merging_keeps_heat_time_and_way() {
        let mut history = History::new(4, 1, 1.0, 0.0);
        let (mut heat, mut way, mut time) = (0.0, 0.0, 0.0);
        for step in 0..300 {
            let amount = 1.0 + f64::from(step % 5);
            let (duration, speed) = (1e-3, 1.0 + 1e-3 * f64::from(step));
            push(&mut history, duration, &[0.0, amount, 2.0 * amount, 0.0], speed);
            time += duration;
            heat += 3.0 * amount * speed / 8.0 * duration;
            way += speed * duration;
        }
        assert!(history.accepted.len() < 100, "{}", history.accepted.len());
        let sum = |of: &dyn Fn(&Window) -> f64| -> f64 {
            history.windows(Stage::Accepted).map(|w| of(w) * w.duration).sum()
        };
        // Tolerance: rounding of three hundred terms.
        assert!((sum(&|_| 1.0) / time - 1.0).abs() < 1e-12);
        assert!((sum(&|w| w.speed) / way - 1.0).abs() < 1e-12);
        assert!((sum(&|w| w.share * w.heat) / heat - 1.0).abs() < 1e-12);
    }

    /// A body at rest needs its whole past, but sixteen windows for each factor of two in time.
    #[test]
    fn a_body_at_rest_keeps_its_heat_in_few_windows() {
        let mut history = History::new(4, 1, 1e-3, 0.0);
        let mut most = 0;
        for _ in 0..100_000 {
            push(&mut history, 1e-4, &[1.0; 4], 0.0);
            most = most.max(history.accepted.len());
        }
        assert_expected(most, History::expected_windows(4, f64::INFINITY, 1e-4, 10.0));
        let time: f64 = history.windows(Stage::Accepted).map(|w| w.duration).sum();
        // Tolerance: rounding of 10⁵ terms.
        assert!((time - 10.0).abs() < 1e-9, "{time}");
    }

    #[test]
    fn long_windows_and_steady_motion_forget_the_rest() {
        let mut history = History::new(4, 1, 1.0, 0.0);
        for _ in 0..3 {
            push(&mut history, 10.0, &[1.0; 4], 1.0);
        }
        assert_eq!(history.accepted.len(), 1);
        assert!(History::expected_windows(4, 1.0, 10.0, 30.0) <= 3);
        push(&mut history, f64::INFINITY, &[2.0; 4], 1.0);
        assert_eq!(history.accepted.len(), 1);
        assert_eq!(history.accepted[0].heat, 8.0);
    }

    #[test]
    fn a_truncated_state_changes_nothing() {
        let mut history = History::new(4, 1, 1.0, 0.0);
        push(&mut history, 0.5, &[1.0; 4], 1.0);
        push(&mut history, 0.5, &[2.0; 4], 1.0);
        let before = history.accepted.clone();
        let mut bytes = Vec::new();
        history.save(&mut bytes).unwrap();
        assert!(history.restore(&mut &bytes[..bytes.len() - 1]).is_err());
        assert_eq!(history.accepted, before);
        history.restore(&mut bytes.as_slice()).unwrap();
        assert_eq!(history.accepted, before);
    }
}
