//! `coordinator new-solver`: writes a conforming solver into a folder.
//!
//! The solvers are copies, under another name, of the examples that the tests run.

use clap::{Args, ValueEnum};
use console::command::{Command, Context, Group};
use run::error::{RunError, file_failure};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::{env, fs};

const PYTHON: &str = include_str!("../../proto/python/examples/short_columns.py");
const C: &str = include_str!("../../proto/c/examples/short_columns.c");
const FORTRAN: &str = include_str!("../../proto/c/examples/short_columns.f90");
const RUST: &str = include_str!("../../proto/examples/short_columns.rs");

/// Options of `coordinator new-solver`.
#[derive(Debug, Args)]
pub(crate) struct NewSolverCommand {
    /// Name of the solver, and of its folder.
    #[arg(value_parser = name)]
    name: String,
    /// The language.
    #[arg(long, value_enum)]
    lang: Language,
    /// The sources of this project, of which solvers in C, Fortran and Rust need the library;
    /// absent: those that this program was built from.
    #[arg(long, value_name = "FOLDER")]
    sources: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Language {
    Python,
    C,
    Fortran,
    Rust,
}

/// Checks a name: lower-case letters, digits, `_` and `-`, a letter first. Programs replace `-` by
/// `_`, which every language allows.
fn name(text: &str) -> Result<String, String> {
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_' || c == '-';
    let begins = text.starts_with(|c: char| c.is_ascii_lowercase());
    match text.chars().all(plain) && begins && text.len() <= 31 {
        true => Ok(text.to_owned()),
        false => Err("a name has up to 31 lower-case letters, digits, _ and -, and begins with a \
                      letter"
            .to_owned()),
    }
}

/// Returns the name of files, programs and types of a solver.
fn identifier(name: &str) -> String {
    name.replace('-', "_")
}

/// A solver to write.
struct Template {
    /// Files by their paths in the folder.
    files: Vec<(String, String)>,
    /// Command that builds it, in its folder.
    build: Option<&'static str>,
    /// Command line that starts it, from the folder above.
    command: Vec<String>,
}

impl Command for NewSolverCommand {
    const NAME: &'static str = "new-solver";
    const GROUP: Group = Group::Solvers;
    const ABOUT: &'static str = "Write a conforming solver in Python, C, Fortran or Rust";
    const EXAMPLES: &'static [&'static str] = &["coordinator new-solver mine --lang python"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let name = &self.name;
        let Template { mut files, build, command } = match self.lang {
            Language::Python => python(name),
            Language::C => c(name, self)?,
            Language::Fortran => fortran(name, self)?,
            Language::Rust => rust(name, &sources(self)?),
        };
        files.push(("README.md".to_owned(), readme(name, build, &command)));
        let folder = Path::new(name);
        fs::create_dir(folder).map_err(|error| match error.kind() {
            ErrorKind::AlreadyExists => RunError::Usage(format!(
                "{name} is there already; choose another name, or move it away"
            )),
            _ => file_failure(folder, &error),
        })?;
        for (file, text) in &files {
            let path = folder.join(file);
            let inside = path.parent().expect("it is in the folder");
            let written = fs::create_dir_all(inside).and_then(|()| fs::write(&path, text));
            written.map_err(|error| file_failure(&path, &error))?;
        }
        let mut steps = format!(
            "{name}: {}\n",
            files.iter().map(|(file, _)| file.as_str()).collect::<Vec<_>>().join(", ")
        );
        for step in self::steps(name, build, &command) {
            steps += &format!("  {step}\n");
        }
        context.print(&steps)
    }
}

/// Returns the commands to type next.
fn steps(name: &str, build: Option<&str>, command: &[String]) -> Vec<String> {
    let build = build.map(|build| format!("(cd {name} && {build})"));
    let (words, list) = (command.join(" "), serde_json::json!(command));
    let conform = format!("coordinator conform --quick --role thermal -- {words}");
    let run =
        format!("coordinator run CASE --set thermal.model=short --set 'thermal.command={list}'");
    build.into_iter().chain([conform, run]).collect()
}

fn readme(name: &str, build: Option<&str>, command: &[String]) -> String {
    format!(
        "# {name}\n\nA thermal solver: heat conduction normal to the surface, in strips. It answers steady cases by the model `short`; put your own physics in its place.\n\n\
         ```sh\n{}\n```\n\n`conform` without `--quick` goes through the whole contract, which docs/write-a-solver.md of the project explains.\n",
        steps(name, build, command).join("\n")
    )
}

/// Replaces the name `short_columns`, in all its spellings.
fn renamed(text: &str, name: &str) -> String {
    let identifier = identifier(name);
    let camel: String = identifier.split('_').map(capital).collect();
    let dashed = identifier.replace('_', "-");
    text.replace("short_columns", &identifier)
        .replace("ShortColumns", &camel)
        .replace("short-columns", &dashed)
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters
        .next()
        .map_or(String::new(), |first| first.to_ascii_uppercase().to_string() + letters.as_str())
}

fn python(name: &str) -> Template {
    let file = format!("{}.py", identifier(name));
    let command = vec!["python3".to_owned(), format!("{name}/{file}")];
    Template { files: vec![(file, renamed(PYTHON, name))], build: None, command }
}

fn c(name: &str, asked: &NewSolverCommand) -> Result<Template, RunError> {
    let program = identifier(name);
    let build = format!(
        "{program}: {program}.c\n\tcc -std=c11 -O2 -Wall -Wextra -I$(INCLUDE) $< {LINKED} -lm -o $@\n"
    );
    made(name, asked, (format!("{program}.c"), renamed(C, name)), &build)
}

fn fortran(name: &str, asked: &NewSolverCommand) -> Result<Template, RunError> {
    let program = identifier(name);
    let build = format!(
        "{program}: {program}.f90\n\tgfortran -std=f2018 -O2 -Wall -Wno-unused-dummy-argument $(INCLUDE)/cosim.f90 $< {LINKED} -o $@\n"
    );
    made(name, asked, (format!("{program}.f90"), renamed(FORTRAN, name)), &build)
}

/// Command of a Makefile that links a program.
const LINKED: &str = "-L$(LIBRARY) -Wl,-rpath,$(LIBRARY) -lcosim";

/// Returns a program over the C library, with a Makefile.
fn made(
    name: &str,
    asked: &NewSolverCommand,
    source: (String, String),
    build: &str,
) -> Result<Template, RunError> {
    let (include, library) = library(asked)?;
    let (include, library) = (include.display(), library.display());
    let make = format!(
        "# Header and library of the project; in its sources `cargo build --release` makes the latter.\nINCLUDE = {include}\nLIBRARY = {library}\n\n{build}"
    );
    let files = vec![source, ("Makefile".to_owned(), make)];
    Ok(Template {
        files,
        build: Some("make"),
        command: vec![format!("./{name}/{}", identifier(name))],
    })
}

/// Returns the folders of the headers and of the library for C and Fortran: those of an archive, or
/// the sources and the folder of the executables.
fn library(asked: &NewSolverCommand) -> Result<(PathBuf, PathBuf), RunError> {
    let program = env::current_exe().and_then(|program| program.canonicalize());
    let program = program.map_err(|error| file_failure(Path::new("coordinator"), &error))?;
    let beside = program.parent().expect("a program is in a folder");
    let archive = beside.parent().filter(|folder| folder.join("include/cosim.h").is_file());
    match archive.filter(|_| asked.sources.is_none()) {
        Some(folder) => Ok((folder.join("include"), folder.join("lib"))),
        None => Ok((sources(asked)?.join("proto/c/include"), beside.to_owned())),
    }
}

fn rust(name: &str, sources: &Path) -> Template {
    let dashed = name.replace('_', "-");
    let manifest = format!(
        "[package]\nname = \"{dashed}\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[dependencies]\nproto = {{ path = {:?} }}\nserde_json = \"1.0\"\n\n\
         # It stands alone, wherever its folder is.\n[workspace]\n",
        sources.join("proto").display().to_string()
    );
    Template {
        files: vec![
            ("Cargo.toml".to_owned(), manifest),
            ("src/main.rs".to_owned(), renamed(RUST, name)),
        ],
        build: Some("cargo build --release"),
        command: vec![format!("./{name}/target/release/{dashed}")],
    }
}

/// Returns the folder with the sources.
fn sources(asked: &NewSolverCommand) -> Result<PathBuf, RunError> {
    let built_from = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = asked.sources.as_deref().unwrap_or(&built_from);
    let found = folder
        .canonicalize()
        .ok()
        .filter(|folder| folder.join("proto/c/include/cosim.h").is_file());
    found.ok_or_else(|| {
        let shown = folder.display();
        RunError::Usage(format!("{shown} has no sources of this project (proto/c/include/cosim.h); name their folder by --sources"))
    })
}
