//! An executable that takes part in a run, and where it is found.

use std::path::{Path, PathBuf};

/// An executable with its fixed arguments.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    /// Path of the executable, or a name on the search path.
    pub path: PathBuf,
    /// Arguments that precede ours.
    pub arguments: Vec<String>,
}

impl Program {
    /// The program of a role: the case's command, or `ROLE-solver`.
    #[must_use]
    pub fn of_role(role: &str, command: Option<&[String]>) -> Self {
        match command.and_then(<[String]>::split_first) {
            Some((name, arguments)) => {
                Self { path: beside_us(name), arguments: arguments.to_vec() }
            }
            None => Self { path: beside_us(&format!("{role}-solver")), arguments: Vec::new() },
        }
    }

    /// As it would be typed.
    #[must_use]
    pub fn command_line(&self) -> String {
        let words = std::iter::once(self.path.display().to_string());
        words.chain(self.arguments.iter().cloned()).collect::<Vec<_>>().join(" ")
    }

    /// The program's file name.
    #[must_use]
    pub fn name(&self) -> String {
        self.path.file_name().unwrap_or(self.path.as_os_str()).to_string_lossy().into_owned()
    }
}

/// A bare name means the program beside the coordinator, if there is one.
fn beside_us(name: &str) -> PathBuf {
    let bare = Path::new(name).components().count() == 1;
    match our_folder().map(|folder| folder.join(name)) {
        Some(path) if bare && path.is_file() => path,
        _ => PathBuf::from(name),
    }
}

/// The folder of this executable.
pub(crate) fn our_folder() -> Option<PathBuf> {
    Some(std::env::current_exe().ok()?.parent()?.to_path_buf())
}
