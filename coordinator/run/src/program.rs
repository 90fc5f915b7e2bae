//! Program of a participant, and the place where it is found.
//!
//! A participant without `command` is the program `ROLE-solver`. The coordinator looks for it in
//! its own folder and then on the search path.

use crate::linked::{LinkedSolver, LinkedSolvers};
use rustix::fs::{Access, access};
use std::env;
use std::ffi::OsStr;
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
        let words = std::iter::once(program.name()).chain(program.arguments.iter().cloned());
        let linked = solvers.get(&words.collect::<Vec<_>>().join(" "));
        Self { linked, ..program }
    }

    /// Returns the files that the command names, by the number of their word: the executable, and
    /// arguments such as the script of an interpreter. Names are looked up on the search path, as
    /// the start of the program does. A linked solver has none.
    #[must_use]
    pub fn files(&self) -> Vec<(usize, PathBuf)> {
        if self.linked.is_some() {
            return Vec::new();
        }
        let search = env::var_os("PATH").unwrap_or_default();
        let program = located(&self.path, &search);
        let argument = |word: &String| {
            let as_it_stands = Some(PathBuf::from(word)).filter(|path| path.is_file());
            as_it_stands.or_else(|| located(Path::new(word), &search))
        };
        let all = std::iter::once(program).chain(self.arguments.iter().map(argument));
        all.enumerate().filter_map(|(number, path)| Some((number, path?))).collect()
    }

    /// Returns whether there is such a program.
    #[must_use]
    pub fn exists(&self) -> bool {
        let search = env::var_os("PATH").unwrap_or_default();
        self.linked.is_some() || located(&self.path, &search).is_some()
    }

    /// Returns the programs beside the coordinator that look like participants, with their roles.
    pub(crate) fn installed() -> Vec<(String, Self)> {
        let Some(folder) = our_folder() else { return Vec::new() };
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        let mut found: Vec<_> = entries
            .filter_map(|entry| {
                let name = entry.file_name().into_string().ok()?;
                let role = name.strip_suffix("-solver")?.to_owned();
                Some((role, Self::new(entry.path(), Vec::new())))
            })
            .collect();
        found.sort_by(|a, b| a.0.cmp(&b.0));
        found
    }

    /// Returns whether the program lies beside the coordinator, as those of this project do.
    #[must_use]
    pub(crate) fn is_ours(&self) -> bool {
        our_folder().is_some_and(|folder| self.path.parent() == Some(&*folder))
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

/// Returns the file that is started for a path or a name on the search path, if there is one.
fn located(word: &Path, search: &OsStr) -> Option<PathBuf> {
    let is_file = |path: &PathBuf| path.is_file();
    match word.components().count() {
        1 if !word.is_absolute() => env::split_paths(search)
            .map(|folder| folder.join(word))
            .find(|path| is_file(path) && access(path, Access::EXEC_OK).is_ok()),
        _ => Some(word.to_owned()).filter(is_file),
    }
}

/// Returns the folder of this executable.
fn our_folder() -> Option<PathBuf> {
    Some(std::env::current_exe().ok()?.parent()?.to_path_buf())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::os::unix::fs::PermissionsExt;

    /// The first executable of a name on the search path is the one that starts. A file that
    /// cannot be executed, and one in the working folder, do not count.
    #[test]
    fn a_name_is_the_first_executable_on_the_search_path() {
        let place = tempfile::tempdir().unwrap();
        let folders = ["a", "b", "c"].map(|name| place.path().join(name));
        for (folder, mode) in folders.iter().zip([0o644, 0o755, 0o755]) {
            fs::create_dir(folder).unwrap();
            let path = folder.join("my-thermal");
            fs::write(&path, "").unwrap();
            fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
        }
        let search = env::join_paths(&folders).unwrap();
        let found = located(Path::new("my-thermal"), &search);
        assert_eq!(found, Some(folders[1].join("my-thermal")));
        assert_eq!(located(Path::new("Cargo.toml"), &search), None);
        let named = folders[0].join("my-thermal");
        assert_eq!(located(&named, &search), Some(named));
    }

    /// Bare arguments may name programs as well, as behind `mpirun`.
    #[test]
    fn arguments_may_be_files_and_programs() {
        let words = ["-n", "2", "Cargo.toml", "sh", "no-such-file"].map(str::to_owned);
        let program = Program::new("env".into(), words.to_vec());
        let numbers: Vec<usize> = program.files().into_iter().map(|(number, _)| number).collect();
        assert_eq!(numbers, [0, 3, 4]);
    }
}
