//! Tables that grow during a run.

use crate::checkpoint::Checkpoint;
use crate::error::RunError;
use crate::plan::Plan;
use crate::plan::sampling::Sampled;
use crate::results::ResultFolder;
use crate::results::history::{self, HistoryTable};
use crate::results::iterations::IterationTable;
use crate::session::Session;
use crate::warnings::Warning;
use contract::history::Histories;
use contract::step::Step;
use std::collections::BTreeSet;

/// All tables of a run.
pub(super) struct Tables {
    pub(super) iterations: IterationTable,
    pub(super) history: HistoryTable,
}

/// Keys of a case that vary during a run, with their tables.
pub(super) struct Inputs<'a> {
    keys: Vec<&'a str>,
    tables: Vec<&'a Histories>,
    /// Values of the keys in accepted windows.
    sampled: Vec<Sampled>,
}

impl<'a> Inputs<'a> {
    /// Collects the input keys that any participant reads: from tables, from outside, or from
    /// another participant.
    pub(super) fn of(plan: &'a Plan) -> Self {
        let read = plan.participants.iter().filter_map(|p| p.configuration.histories.as_ref());
        let tables: Vec<&Histories> = read.filter(|histories| histories.live.is_none()).collect();
        let columns = tables.iter().flat_map(|histories| histories.values.keys());
        let live = plan.live.iter().map(|live| live.kind.name.as_str());
        let keys: BTreeSet<&str> = columns.map(String::as_str).chain(live).collect();
        Self { sampled: vec![Sampled::NONE; keys.len()], keys: keys.into_iter().collect(), tables }
    }

    /// Returns the heads of the columns: keys with SI units.
    fn heads(&self, plan: &Plan) -> Vec<String> {
        let head = |key: &&str| match unit(plan, key) {
            "1" => (*key).to_owned(),
            unit => format!("{key} [{unit}]"),
        };
        self.keys.iter().map(head).collect()
    }

    /// Keeps the values of an accepted window.
    pub(super) fn keep(&mut self, step: &Step, values: &[Option<f64>]) {
        for (sampled, value) in self.sampled.iter_mut().zip(values) {
            value.iter().for_each(|value| sampled.add(step, *value));
        }
    }

    /// Returns a warning for each column with a peak that no accepted window has used.
    pub(super) fn missed_peaks(&self, plan: &Plan) -> Vec<Warning> {
        let warning = |(key, sampled): (&&str, &Sampled)| {
            let columns = self.tables.iter().filter(|table| !table.rows);
            let table = columns.clone().find(|table| table.values.contains_key(*key))?;
            sampled.warning(table, key, unit(plan, key))
        };
        self.keys.iter().zip(&self.sampled).filter_map(warning).collect()
    }

    /// Returns the values of the inputs in a window.
    pub(super) fn values(&self, session: &Session, step: &Step) -> Vec<Option<f64>> {
        let value = |key: &&str| {
            let live = session.given().find(|(live, _)| live == key).map(|(_, value)| value);
            live.or_else(|| session.provided(key))
                .or_else(|| self.tables.iter().find_map(|table| table.value(key, step)))
        };
        self.keys.iter().map(value).collect()
    }
}

/// Returns the unit of a key; "1" if it has none.
fn unit<'a>(plan: &'a Plan, key: &str) -> &'a str {
    let described = plan.participants.iter().find_map(|p| p.description.key(key));
    described.map_or("1", |spec| spec.kind.unit())
}

impl Tables {
    /// Opens the tables of a run, from its beginning or from a checkpoint.
    pub(super) fn open(
        plan: &Plan,
        folder: &ResultFolder,
        from: Option<&Checkpoint>,
    ) -> Result<Self, RunError> {
        let paths = [folder.file("iterations.csv"), folder.file(history::FILE)];
        let given = plan.participants.iter().flat_map(|participant| &participant.figures);
        let given: Vec<&str> = given.map(String::as_str).collect();
        let figures = &plan.figures;
        if let Some(Checkpoint { state, .. }) = from {
            return Ok(Self {
                iterations: IterationTable::resume(&paths[0], state.table_bytes)?,
                history: HistoryTable::resume(&paths[1], state.history_bytes, figures, &given)?,
            });
        }
        let inputs = Inputs::of(plan).heads(plan);
        let roles: Vec<&str> = plan.participants.iter().map(|p| p.role.as_str()).collect();
        let fed_back = plan.fields.iter().filter(|field| !field.fed_back.is_empty());
        let measured = plan.fields.iter().filter(|field| plan.is_only_measured(field));
        let fields: Vec<String> =
            fed_back.chain(measured).map(|field| plan.shown(&field.kind.name)).collect();
        Ok(Self {
            iterations: IterationTable::create(&paths[0], &roles, &fields)?,
            history: HistoryTable::create(&paths[1], &inputs, figures, &given)?,
        })
    }

    /// Writes all buffered rows to the files.
    pub(super) fn flush(&mut self) -> Result<(), RunError> {
        self.iterations.rows.flush()?;
        self.history.rows.flush()
    }
}
