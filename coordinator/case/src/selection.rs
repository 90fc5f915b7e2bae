//! What the case selects: roles, models, effects and the mode.

use super::tree::Table;
use contract::configuration::Mode;
use contract::description::{Description, EffectSpec, ModelSpec};

/// A participant that has described itself, and what the case makes of it.
#[derive(Clone, Debug)]
pub(super) struct Player<'a> {
    pub(super) role: &'a str,
    pub(super) description: &'a Description,
    /// Its section is in the case.
    pub(super) present: bool,
    /// It is present, and stands alone or claims an active effect.
    pub(super) needed: bool,
    /// The chosen model, if it has that model.
    pub(super) model: Option<&'a ModelSpec>,
}

/// The kinds of case in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TimingWord {
    Steady,
    Sequence,
    Transient,
}

impl TimingWord {
    /// The word of `time.mode`.
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Steady => "steady",
            Self::Sequence => "sequence",
            Self::Transient => "transient",
        }
    }

    /// What a model has to answer.
    pub(super) fn mode(self) -> Mode {
        match self {
            Self::Steady | Self::Sequence => Mode::Steady,
            Self::Transient => Mode::Transient,
        }
    }
}

/// What the case selects.
#[derive(Clone, Debug)]
pub(super) struct Selection<'a> {
    pub(super) players: Vec<Player<'a>>,
    /// Names under `effects`, known or not, sorted: the order of the tables in a case has no influence.
    pub(super) effects: Vec<String>,
    pub(super) timing: TimingWord,
}

impl<'a> Selection<'a> {
    /// Reads the selection from a case that may be wrong in any way.
    pub(super) fn new(tree: &Table, descriptions: &'a [(String, Description)]) -> Self {
        let mut effects = tree.names("effects");
        effects.sort_unstable();
        let player = |(role, description): &'a (String, Description)| {
            let present = tree.table(role).is_some();
            let claims = description.effects.iter().any(|e| effects.contains(&e.name));
            let chosen = tree.text(&format!("{role}.model"));
            Player {
                role,
                description,
                present,
                needed: present && (description.standalone || claims),
                model: description.models.iter().find(|m| Some(m.name.as_str()) == chosen),
            }
        };
        let players = descriptions.iter().map(player).collect();
        let timing = match tree.text("time.mode") {
            Some("transient") => TimingWord::Transient,
            Some("sequence") => TimingWord::Sequence,
            _ => TimingWord::Steady,
        };
        Self { players, effects, timing }
    }

    /// The participants that claim an effect, with their part in it.
    pub(super) fn claimants(
        &self,
        effect: &str,
    ) -> impl Iterator<Item = (&Player<'a>, &'a EffectSpec)> {
        let effect = effect.to_owned();
        self.players.iter().flat_map(move |player| {
            let claimed = player.description.effects.iter().find(|e| e.name == effect);
            claimed.map(|spec| (player, spec))
        })
    }

    /// All participants which were asked for their keys.
    pub(super) fn asked(&self) -> Vec<&str> {
        let roles = self.players.iter().map(|player| player.role);
        std::iter::once("the coordinator").chain(roles).collect()
    }
}
