//! `coordinator fmu`: a case or a surrogate as an FMU, for simulations that couple by FMI.
//!
//! | file | what |
//! |---|---|
//! | `variables.rs` | inputs and outputs of the FMU of a plan, or of a surrogate |
//! | `description.rs` | `modelDescription.xml` |
//! | `page.rs` | the documentation inside |
//! | `resources.rs` | the case, its files and the executables |
//! | `pack.rs` | the archive |
//! | `whole.rs` | all of it, in order |
//! | `of_case.rs`, `of_surrogate.rs` | from a case, from a surrogate |
//! | `make.rs` | the command line |

mod description;
mod make;
mod of_case;
mod of_surrogate;
mod pack;
mod page;
mod resources;
mod variables;
mod whole;

pub(crate) use make::{Arguments, main};
