//! A participant in C, compiled against the library of this project.

use super::{library, root};
use std::process::Command;

/// C program, compiled into a folder of its own.
#[derive(Debug)]
pub struct Compiled {
    folder: tempfile::TempDir,
}

impl Compiled {
    /// Compiles a source of the repository.
    pub fn from(source: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let (lib, root) = (library().display(), root());
        let mut cc = Command::new("cc");
        cc.args(["-std=c11", "-O2", "-Wall", "-Wextra", "-Werror", "-Iproto/c/include", source]);
        cc.args([
            format!("-L{lib}"),
            format!("-Wl,-rpath,{lib}"),
            "-Wl,--disable-new-dtags".to_owned(),
        ])
        .args(["-lcosim", "-lm"]);
        let built = cc.arg("-o").arg(folder.path().join("solver")).current_dir(root).output();
        let built = built.expect("a C compiler is on the search path as `cc`");
        assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
        Self { folder }
    }

    /// Path of the program.
    pub fn path(&self) -> String {
        self.folder.path().join("solver").display().to_string()
    }

    /// `--set ROLE.command=[...]` for this program, with an optional word before the standard
    /// arguments.
    pub fn command(&self, role: &str, word: Option<&str>) -> [String; 2] {
        let words = std::iter::once(self.folder.path().join("solver").display().to_string());
        let words: Vec<String> = words.chain(word.map(str::to_owned)).collect();
        ["--set".to_owned(), format!("{role}.command={words:?}")]
    }
}
