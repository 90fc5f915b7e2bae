//! Participant that breaks the protocol; written on the transport services directly.

use std::process::ExitCode;

fn main() -> ExitCode {
    tests::rogue::main()
}
