//! Start of a program, up to the first window.

use super::coupled::{Coupled, CoupledData};
use super::program::{Program, ProgramCommand, ProgramError};
use crate::protocol::{Answer, Mesh, Request, VERSION};
use proto::model::first_non_finite;
use std::path::PathBuf;

/// Longest name of a participant in a message [character].
const LONGEST_NAME: usize = 60;
/// Reason of a second participant in one program, or in a process that it has started.
pub(super) const SECOND_PARTICIPANT: &str = "creates a second participant";

/// Everything that is needed to start a program, possibly several times.
#[derive(Clone, Debug)]
pub struct Starter {
    /// Role in the run.
    pub role: String,
    /// Meshes and data of the program.
    pub coupled: Coupled,
    /// Command line.
    pub command: ProgramCommand,
    /// Folder of the run, if the participant takes part in one.
    pub folder: Option<PathBuf>,
}

/// A program that waits for its first window.
#[derive(Debug)]
pub struct Started {
    /// The program.
    pub program: Program,
    /// Meshes of the program, in coordinates of its own.
    pub meshes: Vec<Mesh>,
    /// Initial values of the written data.
    pub first: Vec<Vec<f64>>,
}

impl Starter {
    /// Starts the program, which may compute on `threads` threads, and waits for its meshes.
    ///
    /// # Errors
    /// Fails if no run is given, or the program ends or does not behave as its interface demands.
    pub fn start(&self, threads: usize) -> Result<Started, ProgramError> {
        let Some(folder) = &self.folder else {
            return Err(ProgramError::Order("is started only for a run, and no run is given"));
        };
        let folder = folder.join(format!("precice-{}", self.role));
        let mut program = Program::start(&self.command, &folder, threads)?;
        match self.begin(&mut program) {
            Ok((meshes, first)) => Ok(Started { program, meshes, first }),
            Err(error) => {
                program.refuse(&error);
                Err(error)
            }
        }
    }

    /// Gives the program its interface; returns its meshes and initial values.
    fn begin(&self, program: &mut Program) -> Result<(Vec<Mesh>, Vec<Vec<f64>>), ProgramError> {
        let interface = &self.coupled.interface;
        match program.receive("before it created its participant")? {
            Request::Create { version, .. } if version != VERSION => {
                return Err(ProgramError::Order("uses a libprecice of another version"));
            }
            Request::Create { participant, .. } if participant != self.coupled.participant => {
                let participant: String = participant.chars().take(LONGEST_NAME).collect();
                return Err(ProgramError::Data(format!(
                    "the program creates the participant `{participant}`, and the command names `{}`",
                    self.coupled.participant
                )));
            }
            Request::Create { .. } => program.answer(&Answer::Interface(interface.clone())),
            _ => return Err(ProgramError::Order("does not create a participant first")),
        }
        match program.receive("before it called initialize")? {
            Request::Initialise { meshes, values: first } => {
                if meshes.len() != interface.meshes.len() {
                    return Err(ProgramError::Order("sends the wrong number of meshes"));
                }
                check(&self.coupled.written, &sizes(&meshes), &first)?;
                Ok((meshes, first))
            }
            Request::Create { .. } => Err(ProgramError::Order(SECOND_PARTICIPANT)),
            Request::Advance { .. } => Err(ProgramError::Order("advances before initialize")),
            _ => Err(ProgramError::Order("finalises before initialize")),
        }
    }
}

/// Returns the numbers of vertices of meshes.
pub(super) fn sizes(meshes: &[Mesh]) -> Vec<usize> {
    meshes.iter().map(|mesh| mesh.points.len()).collect()
}

/// Checks values that the program has written against the sizes of its meshes.
pub(super) fn check(
    written: &[CoupledData],
    sizes: &[usize],
    values: &[Vec<f64>],
) -> Result<(), ProgramError> {
    if values.len() != written.len() {
        return Err(ProgramError::Order("sends the wrong number of data"));
    }
    for (data, values) in written.iter().zip(values) {
        if values.len() != sizes[data.info.mesh] * data.info.components {
            return Err(ProgramError::Order("sends the wrong number of values"));
        }
        if let Some(index) = first_non_finite(values) {
            let (name, value) = (&data.info.name, values[index]);
            return Err(ProgramError::Data(format!("the program writes {value} as `{name}`")));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::launcher::placement::Placement;
    use crate::protocol::{self, Interface};
    use std::ffi::OsString;
    use std::time::{Duration, Instant};

    fn starter() -> Starter {
        let coupled = Coupled {
            participant: "Solid".to_owned(),
            interface: Interface::default(),
            read: Vec::new(),
            written: Vec::new(),
            placement: Placement::parse(None, None, None).unwrap(),
            source: String::new(),
        };
        let words = vec![OsString::from("program")];
        let command = ProgramCommand { words, directory: None };
        Starter { role: "solid".to_owned(), coupled, command, folder: None }
    }

    /// The program hears the reason, and the launcher goes on without waiting for its end.
    #[test]
    fn a_refused_program_is_told_why_at_once() {
        let create =
            |version, name: &str| Request::Create { version, participant: name.to_owned() };
        for (requests, told) in [
            (vec![create(VERSION + 1, "Solid")], "uses a libprecice of another version"),
            (vec![create(VERSION, "Air")], "creates the participant `Air`, and the command names"),
            (vec![create(VERSION, "Solid"), create(VERSION, "Solid")], SECOND_PARTICIPANT),
            (
                vec![create(VERSION, "Solid"), Request::Advance { values: Vec::new(), steps: 1 }],
                "advances before initialize",
            ),
        ] {
            let (mut program, mut other) = Program::hanging();
            let answers = std::thread::spawn(move || {
                let mut buffer = Vec::new();
                let mut answer = None;
                for request in requests {
                    protocol::send(&mut other, &request, &mut buffer).unwrap();
                    answer = protocol::receive::<Answer>(&mut other, &mut buffer).ok();
                }
                answer
            });
            let begun = Instant::now();
            let error = starter().begin(&mut program).unwrap_err();
            program.refuse(&error);
            drop(program);
            assert!(begun.elapsed() < Duration::from_secs(10), "{:?}", begun.elapsed());
            assert!(error.to_string().contains(told), "{error}");
            assert_eq!(answers.join().unwrap(), Some(Answer::Refused(error.to_string())));
        }
    }
}
