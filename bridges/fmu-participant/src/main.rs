//! Executable: splits its own arguments from those common to all participants.

#![forbid(unsafe_code)]

use clap::Parser;
use fmu_participant::solver::{Fmu, FmuSolver};
use std::ffi::OsString;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

/// Plays an FMU (FMI 2.0 or 3.0, co-simulation) as a role of a case.
///
/// In the case: vehicle.command = ["fmu-participant", "vehicle.fmu", "--role", "vehicle",
/// "--wire", "Q -> load.normal_force", "--wire", "Fx, Fy, Fz <- contact_force"]
///
/// "Q -> load.normal_force": an output gives a field, or the value of a key. "Fx, Fy, Fz <-
/// contact_force": inputs receive a field, one component each. "P <- integral(friction_power)" and
/// "T <- mean(lower_temperature)": an input receives the integral or the mean over the surface.
#[derive(Debug, Parser)]
#[command(name = "fmu-participant", version, max_term_width = 100)]
struct Own {
    /// The FMU to run.
    #[arg(value_name = "FMU")]
    path: PathBuf,
    /// Variables that give or receive a field; may be repeated.
    #[arg(long = "wire", value_name = "WIRE")]
    wires: Vec<String>,
    /// Role to play [default: name of the file].
    #[arg(long)]
    role: Option<String>,
}

/// Options common to all participants; the arguments from the first one on belong to the
/// participant.
const CONTRACT: [&str; 2] = ["--describe", "--join"];

fn main() -> ExitCode {
    let all: Vec<OsString> = std::env::args_os().collect();
    let begins = |argument: &OsString| CONTRACT.iter().any(|word| argument == word);
    let place = all.iter().position(begins).unwrap_or(all.len());
    let (own, asked) = all.split_at(place);
    let own = match Own::try_parse_from(own) {
        Ok(own) => own,
        Err(error) => {
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    match read(own, asked) {
        Ok(solver) => {
            let program = all[..1].iter().chain(asked).cloned();
            ExitCode::from(proto::participant::main_from(program, &solver))
        }
        Err(error) => {
            let _ = writeln!(std::io::stderr(), "error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn read(own: Own, asked: &[OsString]) -> Result<FmuSolver, String> {
    let Own { path, wires, role } = own;
    let after = |word: &str| {
        let place = asked.iter().position(|argument| argument == word)?;
        asked.get(place + 1)
    };
    let stem = || path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    // The role that a run gives does not count: it is compared with the one that is described.
    let role = role.or_else(stem).unwrap_or_default();
    let fmu = Fmu::read(&path, &role, &wires)?;
    Ok(FmuSolver::new(fmu, after("--join").map(PathBuf::from)))
}
