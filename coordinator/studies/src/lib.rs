//! Studies: a case run many times, with a table and a page of the answers.
//!
//! [`study`] has the parts that they share: variants of a case, their runs, the folder and the file
//! of a study, its table and its page. A study is a module with its command; [`KINDS`] lists those
//! whose page `coordinator report` can make again.

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

/// Every kind of study that leaves a page.
pub const KINDS: [Kind; 6] = [
    kind::<cost::Study>(),
    kind::<ablate::Study>(),
    kind::<states::Study>(),
    kind::<sweep::Study>(),
    kind::<stability::Report>(),
    kind::<reproduce::Record>(),
];
