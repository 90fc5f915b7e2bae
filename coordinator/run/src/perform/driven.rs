//! A run driven from outside: the driver requests each window with its values, saves states and
//! returns to them.

use super::time_loop::{AcceptedWindow, RejectedWindow, TimeLoop};
use crate::error::{RunError, file_failure};
use crate::format::exact;
use crate::plan::{Participant, Plan};
use crate::results::counts::Counts;
use crate::results::vtk::FileSeries;
use contract::step::Step;
use coupling::windows::{WindowState, Windows};
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::time::Duration;

/// Tolerance of window ends, relative to the window length: an end this close to a window of the
/// case is that of the window.
const ROUNDING: f64 = 1e-9;

/// Largest number of saved states: each takes shared memory and files.
const MOST_STATES: usize = 4096;

/// The driver of a run.
pub trait Driver {
    /// Drives a run to its end.
    ///
    /// # Errors
    /// The error that ended the run.
    fn drive(&mut self, run: &mut Driven<'_, '_>) -> Result<(), RunError>;
}

/// The reason why a run did not do what its driver asked for.
#[derive(Debug)]
pub enum DriverError {
    /// The request is invalid for this reason; nothing has changed.
    Refused(String),
    /// The window has no answer. The run is in the state before the request.
    NoAnswer(RunError),
    /// The run has ended with this error.
    Ended(RunError),
}

impl DriverError {
    /// Returns the fault as the error of a run.
    #[must_use]
    pub fn into_error(self) -> RunError {
        match self {
            Self::Refused(reason) => RunError::Usage(reason),
            Self::NoAnswer(error) | Self::Ended(error) => error,
        }
    }
}

impl From<RunError> for DriverError {
    fn from(error: RunError) -> Self {
        Self::Ended(error)
    }
}

/// An accepted window.
#[derive(Clone, Debug, PartialEq)]
pub struct Accepted {
    /// The window.
    pub step: Step,
    /// Status of the window, as in `history.csv`.
    pub status: &'static str,
    /// Number of iterations.
    pub iterations: u32,
    /// Figures of `history.csv`, in the order of its columns; `None` for a missing one.
    pub figures: Vec<Option<f64>>,
}

/// A saved state of the run.
struct SavedState {
    folder: PathBuf,
    step: Step,
    given: Vec<(String, f64)>,
    coupling: Vec<u8>,
    iterate: Vec<f64>,
    time: WindowState,
    counts: Counts,
    /// The tables `iterations.csv` and `history.csv`.
    tables: [TableState; 2],
    series: Vec<FileSeries>,
}

/// A run in progress, as its driver sees it.
pub struct Driven<'m, 'a> {
    time_loop: &'m mut TimeLoop<'a>,
    kept: BTreeMap<u64, SavedState>,
    last: u64,
    /// State to restore before the next request is served.
    back_to: Option<u64>,
    /// The participants disagree on the window. Only restoring a saved state can continue.
    torn: bool,
}

impl<'m, 'a> Driven<'m, 'a> {
    pub(super) fn new(time_loop: &'m mut TimeLoop<'a>) -> Self {
        Self { time_loop, kept: BTreeMap::new(), last: 0, back_to: None, torn: false }
    }

    /// The plan of the run.
    #[must_use]
    pub fn plan(&self) -> &'a Plan {
        self.time_loop.plan
    }

    /// Returns the keys of the figures of an accepted window, in order.
    pub fn figures(&self) -> impl Iterator<Item = &str> {
        self.time_loop.tables.history.keys()
    }

    /// Returns the reason why this run cannot return to a state; `None` if it can.
    #[must_use]
    pub fn one_way(&self) -> Option<String> {
        let once = |p: &&Participant| {
            let model = p.description.models.iter().find(|m| m.name == p.configuration.model);
            model.is_some_and(|model| !model.rewinds)
        };
        if let Some(one) = self.time_loop.plan.participants.iter().find(once) {
            return Some(format!("{} can solve a window only once", one.role));
        }
        let moves = self.time_loop.session.has_moving_grid();
        moves.then(|| "a grid of the run moves, and cannot move back".to_owned())
    }

    /// Lets time pass while watching processes and signals.
    ///
    /// # Errors
    /// A process has ended, or the user has interrupted the run.
    pub fn idle(&mut self, time: Duration) -> Result<(), RunError> {
        self.time_loop.session.idle(time)
    }

    /// Sets live keys from the next window on: all of them, or none.
    ///
    /// # Errors
    /// A key does not exist, or a value is beyond its limits. The message names the window.
    pub fn give(&mut self, values: &BTreeMap<String, f64>) -> Result<(), DriverError> {
        self.settle()?;
        let window = self.time_loop.time.state().index;
        let session = &mut *self.time_loop.session;
        let judged =
            values.iter().try_for_each(|(key, value)| session.judge(key, *value).map(drop));
        let given = judged
            .and_then(|()| values.iter().try_for_each(|(key, value)| session.give(key, *value)));
        given.map_err(|reason| DriverError::Refused(format!("window {window}: {reason}")))
    }

    /// Solves the next window with these values of live keys, and accepts it. The window ends at
    /// `end` \[s\], or has the length given in the case; in a steady case it is a row at this time.
    /// `observe` writes the fields of the window.
    ///
    /// # Errors
    /// An end before the start, or an invalid value: nothing has changed. A window without an
    /// answer. An error that ends the run.
    pub fn step(
        &mut self,
        values: &BTreeMap<String, f64>,
        end: Option<f64>,
        observe: bool,
    ) -> Result<Accepted, DriverError> {
        self.settle()?;
        if self.torn {
            let reason = "the participants disagree on the last window: restore a state";
            return Err(DriverError::Refused(reason.to_owned()));
        }
        let step = self.next(end)?;
        self.give(values)?;
        match self.time_loop.attempt(&step, observe) {
            Ok(AcceptedWindow { status, iterations }) => {
                let given = self.time_loop.session.figures();
                let figures = self.time_loop.tables.history.values(given);
                Ok(Accepted { step, status, iterations, figures })
            }
            Err(RejectedWindow { error, ended: true, .. }) => Err(DriverError::Ended(error)),
            Err(RejectedWindow { error, torn, .. }) => {
                self.torn = torn;
                Err(DriverError::NoAnswer(error))
            }
        }
    }

    /// Returns the next window, up to this end.
    fn next(&self, end: Option<f64>) -> Result<Step, DriverError> {
        let WindowState { index, start, .. } = *self.time_loop.time.state();
        let Windows::Open { window } = self.time_loop.plan.windows else {
            unreachable!("a run that is driven has open windows")
        };
        let end = match (window, end) {
            (None, end) => end.unwrap_or(start),
            (Some(window), None) => whole(start + window, window),
            (Some(window), Some(end)) => whole(end, window),
        };
        let (start, fits) = match window {
            None => (end, end.is_finite() && end >= start),
            Some(_) => (start, end.is_finite() && end > start),
        };
        if fits {
            return Ok(Step { window: index, iteration: 0, start, end });
        }
        let start = self.time_loop.time.state().start;
        let [start, end] = [start, end].map(exact);
        Err(DriverError::Refused(format!(
            "window {index} begins at {start} s and cannot end at {end} s"
        )))
    }

    /// Saves the state after the last accepted window, and returns its number.
    ///
    /// # Errors
    /// No window has been accepted, the run cannot return to a state, or too many states are kept.
    /// An error that ends the run.
    pub fn save(&mut self) -> Result<u64, DriverError> {
        self.settle()?;
        if let Some(why) = self.one_way() {
            return Err(DriverError::Refused(format!("no state can be saved: {why}")));
        }
        if self.time_loop.counts.windows == 0 {
            let reason = "there is no state before the first window: to return to the beginning, start the run again";
            return Err(DriverError::Refused(reason.to_owned()));
        }
        if self.torn {
            return Err(DriverError::Refused(
                "the last window has no answer, and no state to save".to_owned(),
            ));
        }
        if self.kept.len() == MOST_STATES {
            let reason = format!("the limit of {MOST_STATES} saved states is reached: free one");
            return Err(DriverError::Refused(reason));
        }
        self.last += 1;
        let folder = self.time_loop.session.folder().join(format!("state-{}", self.last));
        fs::create_dir(&folder).map_err(|error| file_failure(&folder, &error))?;
        let kept = self.time_loop.keep(folder)?;
        self.kept.insert(self.last, kept);
        Ok(self.last)
    }

    /// Returns to a saved state, which stays saved.
    ///
    /// # Errors
    /// No state has this number.
    pub fn restore(&mut self, state: u64) -> Result<(), DriverError> {
        if !self.kept.contains_key(&state) {
            return Err(DriverError::Refused(format!("there is no state {state}")));
        }
        // Restoring waits for the next request: of two restorations in a row, only the last one
        // matters.
        self.back_to = Some(state);
        Ok(())
    }

    /// Discards a saved state.
    ///
    /// # Errors
    /// No state has this number. An error that ends the run.
    pub fn free(&mut self, state: u64) -> Result<(), DriverError> {
        if self.back_to == Some(state) {
            self.settle()?;
        }
        match self.kept.remove(&state) {
            Some(kept) => {
                fs::remove_dir_all(&kept.folder)
                    .map_err(|error| file_failure(&kept.folder, &error))?;
                Ok(())
            }
            None => Err(DriverError::Refused(format!("there is no state {state}"))),
        }
    }

    /// Carries out a pending [`Driven::restore`], if there is one.
    ///
    /// # Errors
    /// An error that ends the run.
    pub fn settle(&mut self) -> Result<(), DriverError> {
        let Some(state) = self.back_to.take() else { return Ok(()) };
        self.time_loop.back_to(&self.kept[&state])?;
        self.tables_back_to(state)?;
        self.torn = false;
        Ok(())
    }

    /// Returns the tables to a state. Rows that are cut stay available to the other states.
    fn tables_back_to(&mut self, state: u64) -> Result<(), RunError> {
        let [iterations, history] = self.kept[&state].tables.clone();
        let tables = &mut *self.time_loop.tables;
        let (at, then) = (iterations.start(), history.start());
        let cut = [tables.iterations.rows.cut(at)?, tables.history.rows.cut(then)?];
        for kept in self.kept.values_mut() {
            kept.tables[0].cut(at, &cut[0]);
            kept.tables[1].cut(then, &cut[1]);
        }
        tables.iterations.rows.append(iterations.rest())?;
        tables.history.rows.append(history.rest())
    }
}

/// Returns a multiple of the window if the time is one within rounding, as a run with fixed windows
/// has it; otherwise the time.
fn whole(time: f64, window: f64) -> f64 {
    let whole = (time / window).round() * window;
    if (whole - time).abs() <= ROUNDING * window { whole } else { time }
}

impl TimeLoop<'_> {
    /// Saves the state after the last window into a folder.
    fn keep(&mut self, folder: PathBuf) -> Result<SavedState, RunError> {
        let step = *self.coupling.step();
        self.session.save(&step, &folder)?;
        let mut coupling = Vec::new();
        self.coupling.save(&mut coupling);
        let given = self.session.given().map(|(key, value)| (key.to_owned(), value)).collect();
        Ok(SavedState {
            folder,
            step,
            given,
            coupling,
            iterate: self.coupling.sent().to_vec(),
            time: self.time.state().clone(),
            counts: *self.counts,
            tables: [
                TableState::at(self.tables.iterations.rows.mark()?),
                TableState::at(self.tables.history.rows.mark()?),
            ],
            series: self.fields.series().to_vec(),
        })
    }

    /// Returns the run to a saved state.
    fn back_to(&mut self, kept: &SavedState) -> Result<(), RunError> {
        self.go_to(&kept.step, &kept.folder, &kept.iterate, &kept.coupling, &kept.time)?;
        for (key, value) in &kept.given {
            self.session.give(key, *value).map_err(RunError::Usage)?;
        }
        let bytes_exchanged = self.session.bytes_exchanged();
        *self.counts = Counts { bytes_exchanged, ..kept.counts };
        self.fields.resume(kept.series.clone());
        Ok(())
    }
}

/// Content of a table at a saved state, without a full copy: a length, up to which the content is
/// still in the file, and the rows behind it that have been cut since.
#[derive(Clone, Debug, Default, PartialEq)]
struct TableState {
    start: u64,
    rest: Vec<u8>,
}

impl TableState {
    /// Returns the state of a table that now has this length \[byte\].
    fn at(length: u64) -> Self {
        Self { start: length, rest: Vec::new() }
    }

    /// Returns the length to which the table is cut \[byte\]; [`TableState::rest`] then follows.
    fn start(&self) -> u64 {
        self.start
    }

    /// Returns the rows behind the start.
    fn rest(&self) -> &[u8] {
        &self.rest
    }

    /// Notes that the table has been cut to this length, and that these rows were behind the cut.
    fn cut(&mut self, length: u64, rows: &[u8]) {
        if self.start > length {
            let own = usize::try_from(self.start - length).unwrap_or(usize::MAX).min(rows.len());
            self.rest.splice(0..0, rows[..own].iter().copied());
            self.start = length;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_window_without_an_end_has_the_length_of_the_case() {
        let window = 1e-4;
        // The bits of a run with fixed windows.
        let mut start = 0.0;
        for index in 0..1000 {
            start = whole(start + window, window);
            assert_eq!(start, f64::from(index + 1) * window);
        }
        assert_eq!(whole(2.5e-4 + window, window), 3.5e-4);
        assert_eq!(whole(0.5e-4 + window, window), 0.5e-4 + window);
    }

    /// Cuts and extends a table at will, and checks that every state returns to its content.
    fn play(moves: &[(bool, u8)]) {
        let mut table: Vec<u8> = Vec::new();
        let mut kept: Vec<(TableState, Vec<u8>)> = Vec::new();
        for (number, (back, which)) in moves.iter().enumerate() {
            if *back && !kept.is_empty() {
                let place = usize::from(*which) % kept.len();
                let (start, rest) = (kept[place].0.start(), kept[place].0.rest().to_vec());
                let cut = table.split_off(start as usize);
                kept.iter_mut().for_each(|(branch, _)| branch.cut(start, &cut));
                table.extend(rest);
                assert_eq!(table, kept[place].1);
            } else {
                table.extend(vec![number as u8; usize::from(*which % 5)]);
                kept.push((TableState::at(table.len() as u64), table.clone()));
            }
        }
    }

    proptest! {
        #[test]
        fn every_state_has_what_it_held(moves in prop::collection::vec(any::<(bool, u8)>(), 0..60)) {
            play(&moves);
        }
    }
}
