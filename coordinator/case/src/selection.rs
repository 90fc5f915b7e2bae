//! Selection of a case: roles, models, effects and the mode in time.

use super::raw::RawCase;
use super::schema::WELL_KNOWN_ROLES;
use super::settings::TimeMode;
use super::tree::Table;
use contract::description::{Description, EffectSpec, ModelSpec};
use std::sync::Arc;

/// A described participant, and its part in the case.
#[derive(Clone, Debug)]
pub(super) struct SelectedParticipant<'a> {
    pub(super) role: &'a str,
    pub(super) description: &'a Description,
    /// Whether the case has a section of this role.
    pub(super) present: bool,
    /// Whether the participant is present, and stands alone or claims an active effect.
    pub(super) needed: bool,
    /// The chosen model, if the participant offers it.
    pub(super) model: Option<&'a ModelSpec>,
}

/// Participants, effects and the mode in time that a case selects.
#[derive(Clone, Debug)]
pub(super) struct Selection<'a> {
    pub(super) players: Vec<SelectedParticipant<'a>>,
    /// Names under `effects`, known or not. Sorted, so that the order of tables in a case has no
    /// influence.
    pub(super) effects: Vec<String>,
    pub(super) timing: TimeMode,
}

impl<'a> Selection<'a> {
    /// Reads the selection from a case that may contain any error.
    pub(super) fn new(tree: &Table, descriptions: &'a [(String, Arc<Description>)]) -> Self {
        let mut effects = tree.names("effects");
        effects.sort_unstable();
        let player = |(role, description): &'a (String, Arc<Description>)| {
            let present = tree.table(role).is_some();
            let claims = description.effects.iter().any(|e| effects.contains(&e.name));
            let chosen = tree.text(&format!("{role}.model"));
            SelectedParticipant {
                role,
                description,
                present,
                needed: present && (description.standalone || claims),
                model: description.models.iter().find(|m| Some(m.name.as_str()) == chosen),
            }
        };
        let players = descriptions.iter().map(player).collect();
        let timing = tree.text("time.mode").and_then(TimeMode::from_word).unwrap_or_default();
        Self { players, effects, timing }
    }

    /// Returns the participants that claim an effect, with their roles in it.
    pub(super) fn claimants(
        &self,
        effect: &str,
    ) -> impl Iterator<Item = (&SelectedParticipant<'a>, &'a EffectSpec)> {
        let effect = effect.to_owned();
        self.players.iter().flat_map(move |player| {
            let claimed = player.description.effects.iter().find(|e| e.name == effect);
            claimed.map(|spec| (player, spec))
        })
    }

    /// Returns the coordinator and all participants whose keys are known.
    pub(super) fn asked(&self) -> Vec<&str> {
        let roles = self.players.iter().map(|player| player.role);
        std::iter::once("the coordinator").chain(roles).collect()
    }

    /// Returns roles without a description that are well known or have a command in the case.
    pub(super) fn undescribed(&self, case: &RawCase) -> Vec<String> {
        let unknown = |role: &str| self.players.iter().all(|player| player.role != role);
        let meant = |role: &str| {
            let has = |name: &str| case.has(&format!("{role}.{name}"));
            WELL_KNOWN_ROLES.contains(&role) || has("command") || has("attach")
        };
        let roles = case.participants().into_iter().map(|participant| participant.role);
        roles.filter(|role| unknown(role) && meant(role)).collect()
    }
}
