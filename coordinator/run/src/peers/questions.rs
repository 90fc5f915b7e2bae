//! Questions to a participant before a run: its description, and its layout for a configuration.

use super::Peers;
use super::layout::layout_fault;
use crate::error::RunError;
use contract::configuration::{Configuration, Layout};
use contract::description::Description;
use contract::message::{Command, CommandKind};
use coupling::ParticipantIndex;
use std::time::Duration;

impl Peers {
    /// Asks a participant for its description.
    ///
    /// # Errors
    /// The participant fails, is late, or answers with something else.
    pub fn describe(
        &mut self,
        one: ParticipantIndex,
        patience: Duration,
    ) -> Result<Description, RunError> {
        self.post(one, Command::new(CommandKind::Describe), &[], true)?;
        let message = self.done(one, patience)?;
        serde_json::from_slice(message.body())
            .map_err(|error| self.misbehaved(one, format!("its description is not valid: {error}")))
    }

    /// Configures a participant, and returns its layout. A participant that has this configuration
    /// since planning is not asked again, unless a recording is to hold the answer.
    ///
    /// # Errors
    /// The participant refuses, fails or is late, or its layout does not fit the configuration.
    pub fn configure(
        &mut self,
        one: ParticipantIndex,
        configuration: &Configuration,
        patience: Duration,
    ) -> Result<Layout, RunError> {
        let known = self.configured[one].take().filter(|(known, _)| known == configuration);
        if let Some((_, layout)) = known.filter(|_| self.recorder.is_none()) {
            return Ok(layout);
        }
        let body = serde_json::to_vec(configuration).expect("a configuration is plain data");
        self.post(one, Command::new(CommandKind::Configure), &body, true)?;
        let message = self.done(one, patience)?;
        let layout: Layout = serde_json::from_slice(message.body())
            .map_err(|error| self.misbehaved(one, format!("its layout is not valid: {error}")))?;
        if let Some(fault) = layout_fault(configuration, &layout) {
            return Err(self.misbehaved(one, fault));
        }
        self.configured[one] = Some((configuration.clone(), layout.clone()));
        Ok(layout)
    }
}
