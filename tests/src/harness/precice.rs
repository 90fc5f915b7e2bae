//! Two programs with preCICE's interface, compiled as a user compiles them.

use super::{programs, root};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// Two programs of one source, in a folder of their own.
#[derive(Debug)]
pub struct Pair {
    folder: TempDir,
    /// Participants of the configuration.
    pub names: [&'static str; 2],
    source: &'static str,
}

impl Pair {
    /// Compiles a program.
    pub fn new(source: &'static str, names: [&'static str; 2]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let (compiler, standard) = match source.ends_with(".cpp") {
            true => ("c++", "-std=c++17"),
            false => ("cc", "-std=c11"),
        };
        let library = programs().display();
        let built = Command::new(compiler)
            .args([standard, "-O2", "-Wall", "-Wextra", "-Werror", "-Ibridges/precice/include"])
            .arg(format!("bridges/precice/tests/programs/{source}"))
            .args([format!("-L{library}").as_str(), "-lprecice", "-lm", "-o"])
            .arg(folder.path().join("program"))
            .current_dir(root())
            .output()
            .unwrap_or_else(|error| {
                panic!("a compiler is on the search path: {compiler}: {error}")
            });
        assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
        Self { folder, names, source }
    }

    /// Folder of the program.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Configuration of both programs.
    pub fn configuration(&self) -> PathBuf {
        let (name, _) = self.source.split_once('.').unwrap();
        let name = if matches!(name, "hostile" | "linked") { "dummy" } else { name };
        root().join("bridges/precice/tests/programs").join(format!("{name}.xml"))
    }

    /// Command line of a participant, with the arguments of its program after the configuration.
    pub fn words(&self, side: usize, arguments: &[&str]) -> Vec<String> {
        let launcher = programs().join("precice-participant").display().to_string();
        let configuration = self.configuration().display().to_string();
        let program = self.path().join("program").display().to_string();
        let name = self.names[side].to_owned();
        let own = [launcher, configuration.clone(), "--participant".to_owned(), name.clone()];
        let role = ["--role", ["first", "second"][side], "--resume-by-repeating"];
        let directory = ["--directory".to_owned(), self.path().display().to_string()];
        let own = own.into_iter().chain(role.map(str::to_owned)).chain(directory);
        let started = ["--".to_owned(), program, name, configuration];
        let arguments = arguments.iter().map(|word| (*word).to_owned());
        own.chain(started).chain(arguments).collect()
    }

    /// Writes a case of both programs, with the sections of its own.
    pub fn case(&self, arguments: [&[&str]; 2], sections: &str) -> String {
        let [first, second] = [0, 1].map(|side| self.words(side, arguments[side]));
        let text = format!(
            "[case]\nname = \"pair\"\n[first]\nmodel = \"program\"\ncommand = {first:?}\n\
             [second]\nmodel = \"program\"\ncommand = {second:?}\n{sections}"
        );
        let path = self.path().join("case.toml");
        fs::write(&path, text).unwrap();
        path.display().to_string()
    }

    /// Returns rows of numbers that a program has written.
    pub fn rows(&self, file: &str) -> Vec<Vec<f64>> {
        let text = fs::read_to_string(self.path().join(file)).unwrap();
        let row = |line: &str| line.split(',').map(|word| word.parse().unwrap()).collect();
        text.lines().skip(1).map(row).collect()
    }
}
