//! Participant with a later version of the protocol.

use std::process::ExitCode;
use tests::toy::Toy;

fn main() -> ExitCode {
    proto::participant::main(&Toy { protocol: 999, ..Toy::LEFT })
}
