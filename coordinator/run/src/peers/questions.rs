//! Questions to a participant before a run: its description, its advice on effects, and its layout
//! for a configuration.

use super::Peers;
use super::layout::layout_fault;
use crate::error::RunError;
use contract::advice::{Opinion, Scene};
use contract::configuration::{Configuration, Layout};
use contract::description::Description;
use contract::message::{Command, CommandKind};
use coupling::ParticipantIndex;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::time::Duration;

impl Peers {
    /// Asks a participant for its description.
    ///
    /// # Errors
    /// The participant fails, is late, or answers with something else.
    pub fn describe(
        &mut self,
        participant: ParticipantIndex,
        patience: Duration,
    ) -> Result<Description, RunError> {
        self.post(participant, Command::new(CommandKind::Describe), &[])?;
        self.answer(participant, patience, "description")
    }

    /// Asks a participant for its opinion on effects in a scene.
    ///
    /// # Errors
    /// The participant fails, is late, or answers with something else.
    pub fn advise(
        &mut self,
        participant: ParticipantIndex,
        scene: &Scene,
        patience: Duration,
    ) -> Result<Opinion, RunError> {
        self.post(participant, Command::new(CommandKind::Advise), &json(scene))?;
        let opinion: Opinion = self.answer(participant, patience, "advice")?;
        opinion.check().map_err(|fault| self.misbehaved(participant, fault))?;
        Ok(opinion)
    }

    /// Configures a participant, and returns its layout. A participant that has this configuration
    /// since planning is not asked again, unless a recording is to hold the answer.
    ///
    /// # Errors
    /// The participant refuses, fails or is late, or its layout does not fit the configuration.
    pub fn configure(
        &mut self,
        participant: ParticipantIndex,
        configuration: &Configuration,
        patience: Duration,
    ) -> Result<Layout, RunError> {
        let known = self.configured[participant].take().filter(|(known, _)| known == configuration);
        if let Some((_, layout)) = known.filter(|_| self.recorder.is_none()) {
            return Ok(layout);
        }
        self.post(participant, Command::new(CommandKind::Configure), &json(configuration))?;
        let layout: Layout = self.answer(participant, patience, "layout")?;
        if let Some(fault) = layout_fault(configuration, &layout) {
            return Err(self.misbehaved(participant, fault));
        }
        self.configured[participant] = Some((configuration.clone(), layout.clone()));
        Ok(layout)
    }

    /// Waits for the reply to a question, and reads its body.
    fn answer<T: DeserializeOwned>(
        &mut self,
        participant: ParticipantIndex,
        patience: Duration,
        what: &str,
    ) -> Result<T, RunError> {
        let message = self.done(participant, patience)?;
        serde_json::from_slice(message.body()).map_err(|error| {
            self.misbehaved(participant, format!("its {what} is not valid: {error}"))
        })
    }
}

fn json(question: &impl Serialize) -> Vec<u8> {
    serde_json::to_vec(question).expect("a question is plain data")
}
