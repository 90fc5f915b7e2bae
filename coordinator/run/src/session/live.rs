//! Values of the case that are given as the run goes: sent by the coordinator on
//! `field/coordinator/KEY` before the first iteration of a window, or by a participant as any field.

use super::index::TapIndex;
use super::outlet::Outlet;
use super::subscription::position;
use super::tap::Consumer;
use crate::peers::{COORDINATOR, Peers};
use crate::plan::{LiveValue, Plan};
use contract::live::Live;
use contract::message::Topic;
use coupling::ParticipantIndex;
use proto::transport::TransportError;

/// One that the coordinator sends.
#[derive(Debug)]
pub(super) struct Sent {
    pub(super) key: String,
    pub(super) limits: [f64; 2],
    pub(super) value: f64,
    pub(super) readers: Vec<Consumer>,
    pub(super) outlet: Outlet,
}

/// One that a participant sends, and the limits that it keeps to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Provided {
    pub(super) tap: TapIndex,
    pub(super) limits: [f64; 2],
}

/// All of a run.
#[derive(Debug, Default)]
pub(super) struct LiveValues {
    pub(super) sent: Vec<Sent>,
    pub(super) provided: Vec<Provided>,
    /// The window that the newest samples are of.
    pub(super) window: Option<(u64, f64, f64)>,
}

fn service(key: &str) -> String {
    format!("field/{COORDINATOR}/{key}")
}

/// A value keeps to its limits.
pub(super) fn within([least, most]: [f64; 2], value: f64) -> bool {
    least <= value && value <= most
}

/// The topics of those that a participant receives from the coordinator.
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
                let tap = plan.fields.iter().position(|field| field.kind.name == key);
                let tap = tap.expect("what a participant provides is a field of the run").into();
                provided.push(Provided { tap, limits });
                continue;
            }
            let (of, grid) = (service(&key), Live::grid());
            let outlet = Outlet::open(
                peers.endpoint(),
                &of,
                (kind, &grid),
                readers.len(),
                peers.recorder(),
            )?;
            let readers = readers.iter().map(|&one| position(plan, &key, one)).collect();
            sent.push(Sent { key, limits, value: *first, readers, outlet });
        }
        Ok(Self { sent, provided, window: None })
    }
}
