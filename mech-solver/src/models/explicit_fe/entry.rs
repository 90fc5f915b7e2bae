//! Registry entry and description of the model.

use super::keys::{RESOLUTION, own_keys};
use super::setup::configure;
use crate::case::resolution;
use crate::case::scene::contact_keys;
use crate::case::shape;
use crate::registry::entry::ModelEntry;
use crate::terms::Kind;
use proto::accuracy::{Accuracy, Refinement, Simplification};
use proto::description::{ModelSpec, names};
use proto::field;

/// Registry entry of this model.
pub(in crate::models) const MODEL: ModelEntry = ModelEntry {
    name: "explicit-fe",
    spec,
    takes: &[
        Kind::Adhesion,
        Kind::Layer,
        Kind::Expansion,
        Kind::Softening,
        Kind::Flow,
        Kind::Axle,
        Kind::HeatShare,
    ],
    configure,
};
/// Source of the measured errors.
const STUDY: &str = "wheel-rail-fe against wheel-rail (docs/paper-elements.md)";

fn spec() -> ModelSpec {
    let mut keys = [contact_keys(), own_keys()].concat();
    keys.extend(shape::keys());
    keys.push(resolution::key(RESOLUTION));
    ModelSpec {
        name: MODEL.name.to_owned(),
        summary: "explicit finite elements of both bodies, rolling until steady".to_owned(),
        source: "Flanagan & Belytschko, Int. J. Numer. Meth. Engng 17 (1981) 679-706; Carpenter, Taylor & \
                 Katona, ibid. 32 (1991) 103-128"
            .to_owned(),
        steady: true,
        transient: true,
        rewinds: true,
        varies_step: true,
        consumes: Vec::new(),
        provides: names(&[&field::PRESSURE, &field::TRACTION, &field::SLIP_VELOCITY]),
        keys,
        accuracy: Accuracy {
            refinement: Some(Refinement {
                key: resolution::RESOLUTION.to_owned(),
                levels: vec![5, 7, 10, 13, 20],
                order: 1.0,
                error: 0.05,
                source: STUDY.to_owned(),
            }),
            simplifications: vec![Simplification::always(
                "blocks of elements that are fixed six semi-axes away",
                0.01,
                STUDY,
            )],
        },
    }
}
