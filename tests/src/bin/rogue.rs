//! A participant written by hand on the services themselves, which breaks the contract.

use std::process::ExitCode;

fn main() -> ExitCode {
    tests::rogue::main()
}
