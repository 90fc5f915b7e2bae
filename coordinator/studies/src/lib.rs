//! Studies run a case many times with changed values, and collect the results in a table and a
//! page.
//!
//! [`study`] holds the shared parts: variants of a case, their runs, the folder and the file of a
//! study, its table and its page. Every study is a module with a command of its own. [`KINDS`]
//! lists the studies whose page `coordinator report` can rebuild.

#![forbid(unsafe_code)]

pub mod ablate;
pub mod accuracy;
pub mod advise;
pub mod ask;
pub mod cost;
pub mod fit;
pub mod reproduce;
pub mod stability;
pub mod states;
pub mod study;
pub mod sweep;

use study::output::{Kind, kind};

/// All kinds of study that leave a page.
pub const KINDS: [Kind; 6] = [
    kind::<cost::Study>(),
    kind::<ablate::Study>(),
    kind::<states::Study>(),
    kind::<sweep::Study>(),
    kind::<stability::Report>(),
    kind::<reproduce::Record>(),
];
