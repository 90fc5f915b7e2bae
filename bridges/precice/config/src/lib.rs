//! Configurations of preCICE 3, `precice-config.xml`: data, meshes, participants and coupling
//! schemes, with the line of each element.
//!
//! ```
//! use precice_config::Configuration;
//!
//! let text = r#"<precice-configuration>
//!   <data:scalar name="Temperature" />
//!   <mesh name="Plate" dimensions="2"><use-data name="Temperature" /></mesh>
//!   <mesh name="Air" dimensions="2"><use-data name="Temperature" /></mesh>
//!   <participant name="Solid">
//!     <provide-mesh name="Plate" />
//!     <write-data name="Temperature" mesh="Plate" />
//!   </participant>
//!   <participant name="Fluid">
//!     <provide-mesh name="Air" />
//!     <receive-mesh name="Plate" from="Solid" />
//!     <read-data name="Temperature" mesh="Air" />
//!     <mapping:nearest-neighbor direction="read" from="Plate" to="Air" constraint="consistent" />
//!   </participant>
//! </precice-configuration>"#;
//! let configuration = Configuration::parse(text)?;
//!
//! let fluid = configuration.participant("Fluid").ok_or("no such participant")?;
//! let reads = &fluid.reads[0];
//! assert_eq!((reads.data.as_str(), configuration.components(reads)), ("Temperature", 1));
//! assert_eq!(fluid.mappings[0].line, 13);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | module | content |
//! |---|---|
//! | [`configuration`], [`participant`], [`scheme`], [`acceleration`] | the configuration, by its elements |
//! | [`import`], [`names`], [`notes`] | the case of a configuration; its names; elements without a counterpart |
//! | [`error`] | errors, with their lines |
//! | `markup`, `element`, `words` | XML within limits; elements and their attributes |
//! | `parse`, `consistency` | the text as a configuration; checks of the names: unique, defined and in their place |

#![forbid(unsafe_code)]

pub mod acceleration;
pub mod configuration;
mod consistency;
mod element;
pub mod error;
pub mod import;
mod markup;
pub mod names;
pub mod notes;
mod parse;
pub mod participant;
pub mod scheme;
mod words;

pub use configuration::Configuration;
pub use error::ConfigError;
pub use import::{Import, ImportError, ImportOptions, Refusal, case_of};
pub use markup::LARGEST;
pub use notes::{Note, NoteKind};
