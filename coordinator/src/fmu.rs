//! `coordinator fmu`: a case as an FMU, for simulations that couple by FMI.
//!
//! | file | what |
//! |---|---|
//! | `variables.rs` | inputs and outputs of the FMU of a plan |
//! | `description.rs` | `modelDescription.xml` |
//! | `page.rs` | the documentation inside |
//! | `resources.rs` | the case, its files and the executables |
//! | `pack.rs` | the archive |
//! | `make.rs` | all of it, in order |

mod description;
mod make;
mod pack;
mod page;
mod resources;
mod variables;

pub(crate) use make::{Arguments, main};
