//! Toy participant `right`.

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&tests::toy::Toy::RIGHT)
}
