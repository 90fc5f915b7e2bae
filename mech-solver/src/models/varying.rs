//! Cases whose values vary: the scene of every window, and one grid for all of them.
//!
//! All windows of a history are on one grid, so that a solution starts from the one before and all
//! fields of a run are comparable. Its elements have the size that the case asks for in the smallest
//! contact, but not less than a third of that in the largest.

use crate::ellipse::{Ellipse, Extent};
use crate::scene::{GivenPatch, Scene};
use proto::configuration::{Configuration, Refusal};
use proto::model::{Step, StepError};

/// Contacts smaller than this share of the largest do not make the grid finer.
const SMALLEST: f64 = 1.0 / 3.0;

/// A configuration whose values vary.
#[derive(Clone, Debug)]
pub(super) struct Varying {
    configuration: Configuration,
}

impl Varying {
    /// Of a configuration, if any of its values varies.
    pub(super) fn of(configuration: &Configuration) -> Option<Self> {
        configuration.histories.as_ref()?;
        Some(Self { configuration: configuration.clone() })
    }

    /// The configuration of a window, of which no value varies.
    pub(super) fn configuration(&self, step: &Step) -> Configuration {
        let Configuration { role, model, mode, .. } = &self.configuration;
        Configuration {
            role: role.clone(),
            model: model.clone(),
            mode: *mode,
            case: self.configuration.case_at(step).into_owned(),
            histories: None,
            inputs: Vec::new(),
            outputs: Vec::new(),
            observed: Vec::new(),
            threads: self.configuration.threads,
        }
    }

    /// The scene of a window.
    ///
    /// # Errors
    /// Its values make no scene.
    pub(super) fn scene(&self, step: &Step) -> Result<Scene, StepError> {
        Scene::read(&self.configuration.case_at(step)).map_err(no_answer)
    }

    /// The ellipses of all rows that have one.
    fn ellipses(&self, given: Option<GivenPatch>) -> impl Iterator<Item = Ellipse> + '_ {
        let Configuration { case, histories, .. } = &self.configuration;
        let rows = 0..histories.as_ref().map_or(0, |histories| histories.times.len());
        rows.filter_map(move |row| {
            let case = histories.as_ref()?.at_row(case, row);
            Ellipse::solve(&Scene::read(&case).ok()?, given).ok()
        })
    }

    /// What a grid has to cover, and how finely, for all rows.
    ///
    /// # Errors
    /// No row has a contact.
    pub(super) fn extent(&self, given: Option<GivenPatch>) -> Result<Extent, Refusal> {
        let found = self.ellipses(given).fold(None, |extent: Option<Extent>, ellipse| {
            Some(extent.map_or(ellipse.extent(), |extent| extent.and(&ellipse.extent())))
        });
        let extent = found.ok_or_else(|| {
            let reason = "no row of the histories has a contact";
            Refusal::new("load", reason, "check the columns, their units and the radii")
        })?;
        Ok(Extent { finest: extent.finest.max(SMALLEST * extent.a), ..extent })
    }

    /// What the plan should say.
    pub(super) fn remark(&self, extent: &Extent) -> String {
        let rows = self.configuration.histories.as_ref().map_or(0, |h| h.times.len());
        let [least, most] = [extent.smallest, extent.a].map(|a| 1e3 * a);
        format!("{rows} rows on one grid; a from {least:.4} to {most:.4} mm")
    }
}

/// A row that is refused has no answer.
pub(super) fn no_answer(Refusal { key, reason, fix }: Refusal) -> StepError {
    StepError::NoSolution(format!("{key}: {reason}; {fix}"))
}
