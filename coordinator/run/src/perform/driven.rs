//! A run that is driven from outside: its windows, one by one, with the values that hold in each, and its
//! states, which are kept and returned to.

use super::branch::Branch;
use super::march::{Attempt, March, Missed};
use crate::error::{RunError, file_failure};
use crate::plan::{Participant, Plan};
use crate::results::summary::Counts;
use crate::results::vtk::FileSeries;
use contract::step::Step;
use coupling::windows::{WindowState, Windows};
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::time::Duration;

/// An end this close to a window of the case, relative to its length, is that of the window.
const ROUNDING: f64 = 1e-9;

/// More states than this are not kept: each takes shared memory, and files.
const MOST_STATES: usize = 4096;

/// What drives a run.
pub trait Driver {
    /// Drives it to its end.
    ///
    /// # Errors
    /// What has ended it otherwise.
    fn drive(&mut self, run: &mut Driven<'_, '_>) -> Result<(), RunError>;
}

/// Why a run did not do what it was asked for.
#[derive(Debug)]
pub enum Fault {
    /// It cannot be asked for, and nothing has changed; in words.
    Refused(String),
    /// The window has no answer. The run is where it was before.
    NoAnswer(RunError),
    /// The run is over.
    Ended(RunError),
}

impl Fault {
    /// The end of a run.
    #[must_use]
    pub fn into_error(self) -> RunError {
        match self {
            Self::Refused(reason) => RunError::Usage(reason),
            Self::NoAnswer(error) | Self::Ended(error) => error,
        }
    }
}

impl From<RunError> for Fault {
    fn from(error: RunError) -> Self {
        Self::Ended(error)
    }
}

/// A window that was accepted.
#[derive(Clone, Debug, PartialEq)]
pub struct Accepted {
    /// The window.
    pub step: Step,
    /// How it has ended, as `history.csv` says it.
    pub status: &'static str,
    /// Iterations that it took.
    pub iterations: u32,
    /// The figures of `history.csv`, in the order of its columns; `None` where there is none.
    pub figures: Vec<Option<f64>>,
}

/// A state that is kept.
struct Kept {
    folder: PathBuf,
    step: Step,
    given: Vec<(String, f64)>,
    coupling: Vec<u8>,
    iterate: Vec<f64>,
    time: WindowState,
    counts: Counts,
    /// The tables `iterations.csv` and `history.csv`.
    tables: [Branch; 2],
    series: Vec<FileSeries>,
}

/// A run on its way, in the hands of who drives it.
pub struct Driven<'m, 'a> {
    march: &'m mut March<'a>,
    kept: BTreeMap<u64, Kept>,
    last: u64,
    /// The state to return to before anything else is done.
    back_to: Option<u64>,
    /// Not everybody is at the same window: only an earlier state helps.
    torn: bool,
}

impl<'m, 'a> Driven<'m, 'a> {
    pub(super) fn new(march: &'m mut March<'a>) -> Self {
        Self { march, kept: BTreeMap::new(), last: 0, back_to: None, torn: false }
    }

    /// What runs.
    #[must_use]
    pub fn plan(&self) -> &'a Plan {
        self.march.plan
    }

    /// The keys of the figures of an accepted window, in order.
    pub fn figures(&self) -> impl Iterator<Item = &str> {
        self.march.tables.history.keys()
    }

    /// Why no state of this run can be returned to, if none can.
    #[must_use]
    pub fn one_way(&self) -> Option<String> {
        let once = |p: &&Participant| {
            let model = p.description.models.iter().find(|m| m.name == p.configuration.model);
            model.is_some_and(|model| !model.rewinds)
        };
        if let Some(one) = self.march.plan.participants.iter().find(once) {
            return Some(format!("{} can solve a window once only", one.role));
        }
        let moves = self.march.session.has_moving_grid();
        moves.then(|| "a grid of the run moves, and cannot move back".to_owned())
    }

    /// Lets time pass, with an eye on processes and signals.
    ///
    /// # Errors
    /// A process has ended; the user wants to stop.
    pub fn idle(&mut self, time: Duration) -> Result<(), RunError> {
        self.march.session.idle(time)
    }

    /// Gives values of live keys, from the next window on: all of them, or none.
    ///
    /// # Errors
    /// No such key, a value beyond its limits, named with the window.
    pub fn give(&mut self, values: &BTreeMap<String, f64>) -> Result<(), Fault> {
        self.settle()?;
        let window = self.march.time.state().index;
        let session = &mut *self.march.session;
        let judged =
            values.iter().try_for_each(|(key, value)| session.judge(key, *value).map(drop));
        let given = judged
            .and_then(|()| values.iter().try_for_each(|(key, value)| session.give(key, *value)));
        given.map_err(|reason| Fault::Refused(format!("window {window}: {reason}")))
    }

    /// Solves the next window, with these values of live keys, and accepts it. It ends at a time [s], or
    /// is as long as the case says; of a steady case it is a row at this time. `observe` writes its fields.
    ///
    /// # Errors
    /// An end before the start, a value that cannot be given: nothing has changed then; a window without
    /// an answer; the end of the run.
    pub fn step(
        &mut self,
        values: &BTreeMap<String, f64>,
        end: Option<f64>,
        observe: bool,
    ) -> Result<Accepted, Fault> {
        self.settle()?;
        if self.torn {
            let reason =
                "the last window has no answer that everybody could accept: restore a state";
            return Err(Fault::Refused(reason.to_owned()));
        }
        let step = self.next(end)?;
        self.give(values)?;
        match self.march.attempt(&step, observe) {
            Ok(Attempt { status, iterations }) => {
                let given = self.march.session.figures();
                let figures = self.march.tables.history.values(given);
                Ok(Accepted { step, status, iterations, figures })
            }
            Err(Missed { error, ended: true, .. }) => Err(Fault::Ended(error)),
            Err(Missed { error, torn, .. }) => {
                self.torn = torn;
                Err(Fault::NoAnswer(error))
            }
        }
    }

    /// The next window, up to this end.
    fn next(&self, end: Option<f64>) -> Result<Step, Fault> {
        let WindowState { index, start, .. } = *self.march.time.state();
        let Windows::Open { window } = self.march.plan.windows else {
            unreachable!("a run that is driven has open windows")
        };
        let end = match (window, end) {
            (None, end) => end.unwrap_or(start),
            (Some(window), None) => (index + 1) as f64 * window,
            (Some(window), Some(end)) => {
                let whole = (end / window).round() * window;
                if (whole - end).abs() <= ROUNDING * window { whole } else { end }
            }
        };
        let (start, fits) = match window {
            None => (end, end.is_finite() && end >= start),
            Some(_) => (start, end.is_finite() && end > start),
        };
        if fits {
            return Ok(Step { window: index, iteration: 0, start, end });
        }
        let start = self.march.time.state().start;
        Err(Fault::Refused(format!("window {index} begins at {start} s and cannot end at {end} s")))
    }

    /// Keeps the state after the last window that was accepted; its number.
    ///
    /// # Errors
    /// There is none, or it cannot be returned to; the end of the run.
    pub fn save(&mut self) -> Result<u64, Fault> {
        self.settle()?;
        if let Some(why) = self.one_way() {
            return Err(Fault::Refused(format!("no state can be kept: {why}")));
        }
        if self.march.counts.windows == 0 {
            let reason = "there is no state before the first window: start the run again";
            return Err(Fault::Refused(reason.to_owned()));
        }
        if self.torn {
            return Err(Fault::Refused("the last window has no answer to keep".to_owned()));
        }
        if self.kept.len() == MOST_STATES {
            let reason = format!("{MOST_STATES} states are kept, and no more can be: free one");
            return Err(Fault::Refused(reason));
        }
        self.last += 1;
        let folder = self.march.session.folder().join(format!("state-{}", self.last));
        fs::create_dir(&folder).map_err(|error| file_failure(&folder, &error))?;
        let kept = self.march.keep(folder)?;
        self.kept.insert(self.last, kept);
        Ok(self.last)
    }

    /// Returns to a state that is kept, which stays.
    ///
    /// # Errors
    /// There is none of this number.
    pub fn restore(&mut self, state: u64) -> Result<(), Fault> {
        if !self.kept.contains_key(&state) {
            return Err(Fault::Refused(format!("there is no state {state}")));
        }
        // Only when something follows: of two states in a row nobody sees the first one.
        self.back_to = Some(state);
        Ok(())
    }

    /// Forgets a state.
    ///
    /// # Errors
    /// There is none of this number; the end of the run.
    pub fn free(&mut self, state: u64) -> Result<(), Fault> {
        if self.back_to == Some(state) {
            self.settle()?;
        }
        match self.kept.remove(&state) {
            Some(kept) => {
                fs::remove_dir_all(&kept.folder)
                    .map_err(|error| file_failure(&kept.folder, &error))?;
                Ok(())
            }
            None => Err(Fault::Refused(format!("there is no state {state}"))),
        }
    }

    /// Goes back, if that is due.
    ///
    /// # Errors
    /// The end of the run.
    pub fn settle(&mut self) -> Result<(), Fault> {
        let Some(state) = self.back_to.take() else { return Ok(()) };
        self.march.back_to(&self.kept[&state])?;
        self.tables_back_to(state)?;
        self.torn = false;
        Ok(())
    }
}

impl Driven<'_, '_> {
    /// The tables hold what they held at a state; what is cut is kept for the other states.
    fn tables_back_to(&mut self, state: u64) -> Result<(), RunError> {
        let [iterations, history] = self.kept[&state].tables.clone();
        let tables = &mut *self.march.tables;
        let (at, then) = (iterations.start(), history.start());
        let cut = [tables.iterations.cut(at)?, tables.history.cut(then)?];
        for kept in self.kept.values_mut() {
            kept.tables[0].cut(at, &cut[0]);
            kept.tables[1].cut(then, &cut[1]);
        }
        tables.iterations.append(iterations.rest())?;
        tables.history.append(history.rest())
    }
}

impl March<'_> {
    /// Writes the state after the last window into a folder.
    fn keep(&mut self, folder: PathBuf) -> Result<Kept, RunError> {
        let step = *self.coupling.step();
        self.session.save(&step, &folder)?;
        let mut coupling = Vec::new();
        self.coupling.save(&mut coupling);
        let given = self.session.given().map(|(key, value)| (key.to_owned(), value)).collect();
        Ok(Kept {
            folder,
            step,
            given,
            coupling,
            iterate: self.coupling.sent().to_vec(),
            time: self.time.state().clone(),
            counts: *self.counts,
            tables: [
                Branch::at(self.tables.iterations.mark()?),
                Branch::at(self.tables.history.mark()?),
            ],
            series: self.fields.series().to_vec(),
        })
    }

    fn back_to(&mut self, kept: &Kept) -> Result<(), RunError> {
        self.go_to(&kept.step, &kept.folder, (&kept.iterate, &kept.coupling, &kept.time))?;
        for (key, value) in &kept.given {
            self.session.give(key, *value).map_err(RunError::Usage)?;
        }
        let bytes_exchanged = self.session.bytes_exchanged();
        *self.counts = Counts { bytes_exchanged, ..kept.counts };
        self.fields.resume(kept.series.clone());
        Ok(())
    }
}
