//! Toy participant `left`.

use std::process::ExitCode;

fn main() -> ExitCode {
    proto::participant::main(&tests::toy::Toy::LEFT)
}
