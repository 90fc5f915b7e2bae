//! Start of a program, up to the first window.

use super::coupled::{Coupled, CoupledData};
use super::program::{Program, ProgramCommand, ProgramError};
use crate::protocol::{Answer, Mesh, Request, VERSION};
use proto::model::first_non_finite;
use std::path::PathBuf;

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
        let interface = &self.coupled.interface;
        match program.receive("before it created its participant")? {
            Request::Create { version, .. } if version != VERSION => {
                return Err(ProgramError::Order("uses a libprecice of another version"));
            }
            Request::Create { participant, .. } if participant != self.coupled.participant => {
                let reason = format!(
                    "the program creates the participant `{participant}`, and the command names `{}`",
                    self.coupled.participant
                );
                program.answer(&Answer::Refused(reason.clone()));
                return Err(ProgramError::Data(reason));
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
                Ok(Started { program, meshes, first })
            }
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
