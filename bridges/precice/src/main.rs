//! Executable: splits its own arguments from those common to all participants.

#![forbid(unsafe_code)]

use clap::Parser;
use precice::launcher::coupled::Coupled;
use precice::launcher::placement::Placement;
use precice::launcher::program::ProgramCommand;
use precice::launcher::solver::ProgramSolver;
use precice::launcher::starter::Starter;
use precice::launcher::wire::Wire;
use precice_config::{Configuration, names};
use std::ffi::OsString;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

/// Maximum size of a configuration [byte].
const LARGEST: u64 = 1 << 22;

/// Starts a program with a preCICE adapter as a role of a case.
///
/// In the case: thermal.command = ["precice-participant", "precice-config.xml", "--participant",
/// "Solid", "--wire", "Heat-Flux <- friction_power", "--wire", "Temperature ->
/// lower_temperature", "--", "python3", "solid.py"]
///
/// The program is linked with the libprecice.so beside this executable, instead of preCICE's.
/// "Temperature - 293.15 -> lower_temperature": data that the program writes give a field, here the
/// rise above 293.15. "Heat-Flux <- 0.5 * friction_power": a field gives data that the program
/// reads. "Force -> wall_force [N]": with the unit of a new field. Data without a wire are fields
/// of the same name.
#[derive(Debug, Parser)]
#[command(name = "precice-participant", version, max_term_width = 100)]
struct Own {
    /// preCICE's configuration of the program.
    #[arg(value_name = "CONFIG.xml")]
    configuration: PathBuf,
    /// Name of the program's participant in the configuration.
    #[arg(long, value_name = "NAME")]
    participant: String,
    /// Data that give or receive a field; may be repeated.
    #[arg(long = "wire", value_name = "WIRE", allow_hyphen_values = true)]
    wires: Vec<String>,
    /// Axes of the case along which the program's coordinates run, such as "x,-z" [default: x,y,z].
    #[arg(long, value_name = "AXES", allow_hyphen_values = true)]
    axes: Option<String>,
    /// Coordinates of the program's origin in the case at the start [m] [default: 0,0,0].
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    origin: Option<String>,
    /// Velocity of the program's meshes in the case [m/s] [default: 0,0,0].
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    velocity: Option<String>,
    /// Folder in which the program runs [default: the current one].
    #[arg(long, value_name = "DIR")]
    directory: Option<PathBuf>,
    /// Resume a run by repeating its accepted windows; for programs that compute the same from the
    /// same values.
    #[arg(long)]
    resume_by_repeating: bool,
    /// Role to play [default: name of the participant in small letters].
    #[arg(long)]
    role: Option<String>,
    /// The program and its arguments.
    #[arg(last = true, required = true, value_name = "PROGRAM")]
    program: Vec<OsString>,
}

/// Option of all participants, beside those of a run. It follows the program's own arguments, which
/// may contain the same word.
const CONTRACT: &str = "--describe";

fn main() -> ExitCode {
    let all: Vec<OsString> = std::env::args_os().collect();
    let (own, contract) = all.split_at(beginning_of_contract(&all));
    let own = match Own::try_parse_from(own) {
        Ok(own) => own,
        Err(error) => {
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    match read(own, contract) {
        Ok(solver) => {
            let arguments = all[..1].iter().chain(contract).cloned();
            ExitCode::from(proto::participant::main_from(arguments, &solver))
        }
        Err(error) => {
            let _ = writeln!(std::io::stderr(), "error: {}", proto::text::visible(&error));
            ExitCode::FAILURE
        }
    }
}

/// Returns the index of the first argument that the coordinator has appended.
fn beginning_of_contract(all: &[OsString]) -> usize {
    match all {
        [.., last] if last == CONTRACT => all.len() - 1,
        [.., join, _, role, _] if join == "--join" && role == "--role" => all.len() - 4,
        _ => all.len(),
    }
}

fn read(own: Own, contract: &[OsString]) -> Result<ProgramSolver, String> {
    let Own { configuration: path, participant, wires, role, program, .. } = own;
    let placement =
        Placement::parse(own.axes.as_deref(), own.origin.as_deref(), own.velocity.as_deref())
            .map_err(|error| format!("the placement {error}"))?;
    let after = |word: &str| {
        let place = contract.iter().position(|argument| argument == word)?;
        contract.get(place + 1)
    };
    // The role that a run gives does not count: it is compared with the one that is described.
    let role = role.unwrap_or_else(|| names::role(&participant));
    let placeholder = program.first().and_then(|word| names::of_placeholder(word.to_str()?));
    if let Some(participant) = placeholder {
        return Err(format!(
            "the command still has the placeholder of an import; write the program of {participant} \
             in its place"
        ));
    }
    let text = proto::input_file::read_text(&path, LARGEST)
        .map_err(|error| format!("{}: {error}", path.display()))?;
    let configuration =
        Configuration::parse(&text).map_err(|error| format!("{}: {error}", path.display()))?;
    let wires = wires
        .iter()
        .map(|wire| Wire::parse(wire).map_err(|error| format!("the wire {wire:?} {error}")))
        .collect::<Result<Vec<_>, _>>()?;
    let coupled = Coupled::new(&configuration, &participant, &wires, placement)
        .map_err(|error| format!("{}: {error}", path.display()))?;
    let command = ProgramCommand { words: program, directory: own.directory };
    let folder = after("--join").map(PathBuf::from);
    Ok(ProgramSolver::new(Starter { role, coupled, command, folder }, own.resume_by_repeating))
}
