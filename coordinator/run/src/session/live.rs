//! Live values: values of the case that are given during the run.
//!
//! A live value is sent either by the coordinator, on `field/coordinator/KEY` before the first
//! iteration of a window, or by a participant, like any other field. Both must stay within the
//! limits of the case.

use super::fields::{Consumer, FieldIndex, FieldPublisher};
use crate::peers::{COORDINATOR, Peers};
use crate::plan::{LiveValue, Plan};
use contract::live::Live;
use contract::message::Topic;
use contract::step::Step;
use coupling::ParticipantIndex;
use proto::transport::TransportError;

/// A live value that the coordinator sends.
#[derive(Debug)]
pub(super) struct CoordinatorLiveValue {
    pub(super) key: String,
    pub(super) limits: [f64; 2],
    pub(super) value: f64,
    pub(super) readers: Vec<Consumer>,
    pub(super) publisher: FieldPublisher,
}

/// A live value that a participant sends, with its limits.
#[derive(Clone, Debug)]
pub(super) struct ParticipantLiveValue {
    pub(super) field: FieldIndex,
    pub(super) limits: [f64; 2],
    pub(super) readers: Vec<ParticipantIndex>,
    /// Value with which the readers solved last. Its participant may have sent a newer one since,
    /// for the next window.
    pub(super) used: Option<f64>,
}

/// All live values of a run.
#[derive(Debug, Default)]
pub(super) struct LiveValues {
    pub(super) sent: Vec<CoordinatorLiveValue>,
    pub(super) provided: Vec<ParticipantLiveValue>,
    /// Window of the newest samples: index, start and end [s].
    pub(super) window: Option<(u64, f64, f64)>,
}

fn service(key: &str) -> String {
    format!("field/{COORDINATOR}/{key}")
}

/// Returns whether a value is within its limits.
pub(super) fn within([least, most]: [f64; 2], value: f64) -> bool {
    least <= value && value <= most
}

/// Returns the topics of the live values that a participant receives from the coordinator.
pub(super) fn topics(plan: &Plan, one: ParticipantIndex) -> impl Iterator<Item = Topic> {
    let own = move |live: &&LiveValue| live.provider.is_none() && live.readers.contains(&one);
    plan.live.iter().filter(own).map(|live| Topic {
        field: live.kind.name.clone(),
        service: service(&live.kind.name),
        grid: Live::grid(),
        subscribers: live.readers.len(),
        geometry: None,
    })
}

impl LiveValues {
    /// Opens the topics of a plan.
    pub(super) fn open(plan: &Plan, peers: &Peers) -> Result<Self, TransportError> {
        let mut sent = Vec::new();
        let mut provided = Vec::new();
        for LiveValue { kind, first, limits, provider, readers } in &plan.live {
            let (key, limits) = (kind.name.clone(), *limits);
            if provider.is_some() {
                let field = plan.fields.iter().position(|field| field.kind.name == key);
                let field =
                    field.expect("what a participant provides is a field of the run").into();
                let readers = readers.clone();
                provided.push(ParticipantLiveValue { field, limits, readers, used: None });
                continue;
            }
            let (of, grid) = (service(&key), Live::grid());
            let publisher = FieldPublisher::open(
                peers.endpoint(),
                &of,
                kind,
                &grid,
                readers.len(),
                peers.recorder(),
            )?;
            let readers = readers.iter().map(|&one| Consumer::new(plan, &key, one)).collect();
            sent.push(CoordinatorLiveValue { key, limits, value: *first, readers, publisher });
        }
        Ok(Self { sent, provided, window: None })
    }

    /// Returns the index of the key among the live values of the coordinator, if the value is
    /// valid.
    ///
    /// # Errors
    /// The key does not exist, or the value is beyond its limits; the message names the reason.
    pub(super) fn judge(&self, key: &str, value: f64) -> Result<usize, String> {
        let Some(place) = self.sent.iter().position(|sent| sent.key == key) else {
            let keys = self.sent.iter().map(|sent| sent.key.as_str());
            let known = keys.collect::<Vec<_>>().join(", ");
            return Err(format!("`{key}` is not a live value of this run; known: {known}"));
        };
        let limits = self.sent[place].limits;
        if !within(limits, value) {
            let [least, most] = limits;
            return Err(format!(
                "{value} of `{key}` is not between {least} and {most}, the limits of the case"
            ));
        }
        Ok(place)
    }

    /// Sets the value of a key, from the next solved window on.
    ///
    /// # Errors
    /// The errors of [`LiveValues::judge`].
    pub(super) fn give(&mut self, key: &str, value: f64) -> Result<(), String> {
        let place = self.judge(key, value)?;
        let sent = &mut self.sent[place];
        if sent.value.to_bits() != value.to_bits() {
            sent.value = value;
            self.window = None;
        }
        Ok(())
    }

    /// Sends the values of a window once, and returns their size [byte].
    pub(super) fn send(&mut self, step: &Step) -> Result<u64, TransportError> {
        let window = Some((step.window, step.start, step.end));
        if self.window == window {
            return Ok(0);
        }
        for sent in &mut self.sent {
            let mut loan = sent.publisher.loan()?;
            loan.values().fill(sent.value);
            sent.publisher.publish(loan, step)?;
        }
        self.window = window;
        Ok((self.sent.len() * size_of::<f64>()) as u64)
    }
}
