//! Program of a participant, and the place where it is found.

use crate::linked::{LinkedSolver, LinkedSolvers};
use std::path::{Path, PathBuf};

/// An executable with its fixed arguments.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    /// Path of the executable, or a name on the search path.
    pub path: PathBuf,
    /// Arguments that precede those of the coordinator.
    pub arguments: Vec<String>,
    /// Linked solver that runs instead of the executable.
    pub(crate) linked: Option<LinkedSolver>,
}

impl Program {
    /// Returns an executable, by path or by a name on the search path, with arguments that precede
    /// those of the coordinator.
    #[must_use]
    pub fn new(path: PathBuf, arguments: Vec<String>) -> Self {
        Self { path, arguments, linked: None }
    }

    /// Returns the program of a role: the command of the case, or `ROLE-solver`.
    #[must_use]
    pub fn of_role(role: &str, command: Option<&[String]>) -> Self {
        match command.and_then(<[String]>::split_first) {
            Some((name, arguments)) => Self::new(beside_us(name), arguments.to_vec()),
            None => Self::new(beside_us(&format!("{role}-solver")), Vec::new()),
        }
    }

    /// Returns the program of a role, replaced by a linked solver if there is one.
    pub(crate) fn of_role_or_linked(
        role: &str,
        command: Option<&[String]>,
        solvers: &LinkedSolvers,
    ) -> Self {
        let program = Self::of_role(role, command);
        let is_bare = program.arguments.is_empty();
        let linked = solvers.get(&program.name()).filter(|_| is_bare);
        Self { linked, ..program }
    }

    /// Returns the command line as typed in a shell.
    #[must_use]
    pub fn command_line(&self) -> String {
        let words = std::iter::once(self.path.display().to_string());
        words.chain(self.arguments.iter().cloned()).collect::<Vec<_>>().join(" ")
    }

    /// Returns the file name of the program.
    #[must_use]
    pub fn name(&self) -> String {
        self.path.file_name().unwrap_or(self.path.as_os_str()).to_string_lossy().into_owned()
    }
}

/// Returns the program beside the coordinator for a bare name, if it exists.
fn beside_us(name: &str) -> PathBuf {
    let bare = Path::new(name).components().count() == 1;
    match our_folder().map(|folder| folder.join(name)) {
        Some(path) if bare && path.is_file() => path,
        _ => PathBuf::from(name),
    }
}

/// Returns the folder of this executable.
pub(crate) fn our_folder() -> Option<PathBuf> {
    Some(std::env::current_exe().ok()?.parent()?.to_path_buf())
}
