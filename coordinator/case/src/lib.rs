//! The case file, from text to a validated [`Case`].
//!
//! ```text
//! bytes ──RawCase::read──► RawCase ──set, unset──► RawCase ──validate(descriptions)──► Case
//! ```
//!
//! A [`RawCase`] is TOML whose keys remember their places. [`validate`] checks it against the
//! descriptions of its participants; [`check_without_participants`] needs no participant. Both
//! report all errors at once, each with its place, key, reason and fix:
//!
//! ```
//! use case::{RawCase, check_without_participants};
//!
//! let text = "[case]\nname = \"rolling\"\ntitel = \"A wheel\"\n[mech]\nmodel = \"half-space\"\n";
//! let raw = RawCase::parse("rolling.toml", text)?;
//! let problems = check_without_participants(&raw).unwrap_err();
//!
//! let expected = r#"
//! error: rolling.toml:3:1: case.titel: unknown key; not read by the coordinator
//!   3 | titel = "A wheel"
//!     | ^^^^^
//!   fix: write `case.title`
//!
//! 1 error in rolling.toml"#;
//! assert_eq!(problems.to_string(), expected.trim_start());
//! assert_eq!(problems.list()[0].key, "case.titel");
//! # Ok::<(), case::Problems>(())
//! ```
//!
//! [`contract::description::KeySpec`] declares the coordinator's own keys ([`schema`]) and those of
//! the participants (their descriptions), and the same code checks both. Keys, units and ranges
//! have no other source. Values of the coordinator's keys become [`Timing`], [`Coupling`],
//! [`Output`] and [`Limits`]; the schema takes its defaults from them.
//!
//! # Modules
//!
//! | file | content |
//! |---|---|
//! | `tree.rs`, `raw.rs` | TOML with places; [`RawCase`], and options that change it |
//! | `settings.rs`, `schema.rs` | the coordinator's settings with their defaults; names, units and ranges |
//! | `selection.rs`, `known.rs`, `alternatives.rs` | selection of a case; known keys; alternatives |
//! | `validate.rs` | the steps of a validation, and the type that each produces |
//! | `checked_keys.rs`, `check.rs`, `varying.rs` | first step: each key by itself, columns of tables and live values |
//! | `filled_case.rs`, `missing.rs`, `rules.rs` | second step: defaults; missing keys, and rules between keys |
//! | `diagnostics.rs`, `case.rs` | [`Problems`]; [`Case`] |
//!
//! # Decisions
//!
//! The types do not show these decisions:
//! - A section is a participant if its role has a description. A participant that does not stand
//!   alone and claims no active effect is idle: its keys may be in the case but are not required.
//! - A key may be read only by another model of a participant, by an inactive effect, or by the
//!   default program of a role that another program plays. Such a key is accepted, so that a case
//!   survives `--set mech.model=...` and `--set thermal.command=...`; its value must still be of
//!   the right kind. [`Case::unread`] lists it, which becomes a warning. An effect that no
//!   participant offers is an error, because ignoring it would change the result.
//! - Exactly one of the alternatives of a group (`one_of`) must be given whenever one of them is
//!   read. An alternative set by an option replaces those of the file; two set by options, or two
//!   in the file, are an error.
//! - A key of an alternative is required, or has its default, only if the alternative is given.
//! - In a table to which `name_in` keys refer (`materials`), only the referenced entries are read.
//! - Names with a dot are refused: everywhere else a dotted key addresses a value.

#![forbid(unsafe_code)]

mod alternatives;
mod case;
mod check;
mod checked_keys;
mod diagnostics;
mod filled_case;
mod known;
mod missing;
mod raw;
mod rules;
pub mod schema;
mod selection;
mod settings;
#[cfg(test)]
mod tests;
mod tree;
mod validate;
mod varying;

pub use alternatives::Replaced;
pub use case::Case;
pub use checked_keys::LiveKey;
pub use contract::quantity::{QuantityError, parse_quantity};
pub use contract::unit::si_exponents;
pub use diagnostics::{Place, Problem, Problems};
pub use known::Unread;
pub use raw::{RawCase, RawParticipant};
pub use settings::{Control, Coupling, Limits, Output, OutputFields, ParticipantCase, Timing};
pub use validate::{StandaloneCheck, check_without_participants, validate};
