//! Participants of the tests, in one program. The first argument names the participant:
//! `toy left --describe`.

use proto::model::Solver;
use std::process::ExitCode;
use tests::linear::Linear;
use tests::long::Long;
use tests::lumped::Lumped;
use tests::moving::Moving;
use tests::toy::Toy;
use tests::volume::Block;

/// Participant with a later version of the protocol.
const FUTURE: Toy = Toy { protocol: 999, ..Toy::LEFT };

fn main() -> ExitCode {
    let mut arguments: Vec<_> = std::env::args_os().collect();
    let name = if arguments.len() > 1 { arguments.remove(1) } else { Default::default() };
    let solver: &dyn Solver = match name.to_str() {
        Some("body") => &Lumped::Body,
        Some("future") => &FUTURE,
        Some("left") => &Toy::LEFT,
        Some("long") => &Long,
        Some("mover") => &Moving::Mover,
        Some("operator") => &Linear::Operator,
        Some("plate") => &Moving::Plate,
        Some("relay") => &Linear::Relay,
        Some("right") => &Toy::RIGHT,
        Some("rogue") => return ExitCode::from(tests::rogue::main_from(arguments)),
        Some("source") => &Lumped::Source,
        Some("volume") => &Block,
        _ => panic!("there is no participant {name:?}"),
    };
    ExitCode::from(proto::participant::main_from(arguments, solver))
}
