//! `coordinator import`: writes the case of a preCICE configuration.
//!
//! The case is checked before it is written, as by `coordinator check`, with a program in place of
//! each that is not known yet. Whatever the check refuses is to be done before the first run.

use case::RawCase;
use clap::Args;
use console::command::{Command, Context, Group};
use contract::field::TABLE;
use contract::input_file;
use precice_config::{Configuration, Import, ImportOptions, Note, NoteKind, Refusal, case_of};
use run::error::{RunError, file_failure, input_failure};
use run::fleet::Fleet;
use run::format::counted;
use run::plan::plan;
use run::results::write::replace;
use run::wrap;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

/// Name of the case if the folder of the configuration has none that is valid.
const DEFAULT: &str = "case";

/// Options of `coordinator import`.
#[derive(Debug, Args)]
pub(crate) struct ImportCommand {
    /// The configuration, `precice-config.xml`.
    #[arg(value_name = "CONFIGURATION")]
    configuration: PathBuf,
    /// The case to write [default: the name of the configuration's folder, and .toml].
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Program of a participant and its arguments, quoted as in a shell; may be repeated.
    #[arg(long = "command", value_name = "NAME=COMMAND", value_parser = program)]
    commands: Vec<(String, Vec<String>)>,
    /// Folder in which the program of a participant runs; may be repeated.
    #[arg(long = "directory", value_name = "NAME=DIR", value_parser = directory)]
    directories: Vec<(String, String)>,
    /// Replace an existing file.
    #[arg(long)]
    replace: bool,
}

/// Words of a shell, which only passes programs and arguments on.
const OF_SHELL: [&str; 10] = ["&&", "||", "|", ";", "&", ">", ">>", "<", "2>", "2>&1"];
/// First words that only a shell knows.
const BUILT_IN: [&str; 5] = ["cd", "export", "source", ".", "exec"];

/// Parses NAME=COMMAND.
fn program(option: &str) -> Result<(String, Vec<String>), String> {
    let (name, line) = option
        .split_once('=')
        .ok_or("write the name of a participant, an equals sign and its program")?;
    let words = shlex::split(line).ok_or("a quote is not closed")?;
    let first = words.first().ok_or("no program")?;
    let for_shell = words.iter().find(|word| OF_SHELL.contains(&word.as_str()));
    let assigns = |word: &str| {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
        word.split_once('=').is_some_and(|(variable, _)| variable.chars().all(plain))
    };
    let built_in = Some(first).filter(|word| BUILT_IN.contains(&word.as_str()) || assigns(word));
    if let Some(word) = for_shell.or(built_in) {
        return Err(format!(
            "`{word}` is for a shell, and the program is started without one; write \
             {name}=sh -c '…', and --directory {name}=DIR for the folder"
        ));
    }
    Ok((name.to_owned(), words))
}

/// Parses NAME=DIR.
fn directory(option: &str) -> Result<(String, String), String> {
    match option.split_once('=') {
        Some((name, folder)) if !folder.is_empty() => Ok((name.to_owned(), folder.to_owned())),
        _ => Err("write the name of a participant, an equals sign and a folder".to_owned()),
    }
}

/// Returns values by the names of their participants.
fn by_name<T: Clone>(
    option: &str,
    values: &[(String, T)],
) -> Result<BTreeMap<String, T>, RunError> {
    let mut found = BTreeMap::new();
    for (name, value) in values {
        if found.insert(name.clone(), value.clone()).is_some() {
            let reason = format!("{option} {name}=… is given twice");
            return Err(RunError::Usage(reason));
        }
    }
    Ok(found)
}

impl Command for ImportCommand {
    const NAME: &'static str = "import";
    const GROUP: Group = Group::Connect;
    const ABOUT: &'static str = "Write the case of a preCICE configuration. Whatever has no counterpart is listed, with its line";
    const EXAMPLES: &'static [&'static str] = &[
        "coordinator import precice-config.xml --out mine.toml",
        "coordinator import precice-config.xml --command Fluid=./fluid",
    ];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let path = &self.configuration;
        let text = input_file::read_text(path, precice_config::LARGEST as u64)
            .map_err(|error| input_failure(path, &error))?;
        let refused = |reason: String| RunError::Usage(format!("{}: {reason}", path.display()));
        let configuration =
            Configuration::parse(&text).map_err(|error| refused(error.to_string()))?;
        let out = self.out.clone().unwrap_or_else(|| PathBuf::from(default_name(path) + ".toml"));
        let mut options = ImportOptions {
            name: name_of(&out),
            path: path.display().to_string(),
            commands: by_name("--command", &self.commands)?,
            directories: by_name("--directory", &self.directories)?,
            reserved: TABLE.iter().map(|field| field.name.to_owned()).collect(),
            refusals: Vec::new(),
        };
        let import = |options: &ImportOptions| {
            case_of(&configuration, options).map_err(|error| refused(error.to_string()))
        };
        let complete = import(&with_programs(&configuration, &options))?;
        options.refusals = refusals(&out, &complete.text)?;
        let import = import(&options)?;
        self.write(&out, &import)?;
        context.print(&summary(&out, &configuration, &import.notes))?;
        match options.refusals.len() {
            0 => Ok(()),
            count => Err(RunError::Usage(format!(
                "{}: the case is written, and `coordinator check` refuses it for {}, which the list \
                 \"{}\" names",
                out.display(),
                counted(count as u64, "reason"),
                NoteKind::Todo.heading()
            ))),
        }
    }
}

/// Returns the options with a program for every participant.
fn with_programs(configuration: &Configuration, options: &ImportOptions) -> ImportOptions {
    let mut complete = options.clone();
    for participant in &configuration.participants {
        let program = || vec!["program".to_owned()];
        complete.commands.entry(participant.name.clone()).or_insert_with(program);
    }
    complete
}

/// Returns the reasons for which `coordinator check` refuses a case.
fn refusals(out: &Path, text: &str) -> Result<Vec<Refusal>, RunError> {
    let checked = RawCase::parse(&out.display().to_string(), text)
        .map_err(RunError::from)
        .and_then(|raw| plan(raw, &mut Fleet::for_one_run()).map(drop));
    let refusal = |one: &case::Problem| Refusal {
        key: one.key.clone(),
        reason: one.reason.clone(),
        fix: one.fix.clone(),
    };
    match checked {
        Ok(()) => Ok(Vec::new()),
        Err(error) if error.is_interrupt() => Err(error),
        Err(RunError::Case(problems)) => Ok(problems.list().iter().map(refusal).collect()),
        Err(error) => {
            let reason = match error {
                RunError::Failed(failure) => format!("{}: {}", failure.who, failure.what),
                other => other.to_string(),
            };
            Ok(vec![Refusal { reason, ..Refusal::default() }])
        }
    }
}

impl ImportCommand {
    /// Writes the case. An existing file stays as it is without `--replace`.
    fn write(&self, out: &Path, import: &Import) -> Result<(), RunError> {
        if self.replace {
            return replace(out, import.text.as_bytes());
        }
        let file = File::options().write(true).create_new(true).open(out);
        let mut file = file.map_err(|error| match error.kind() {
            ErrorKind::AlreadyExists => {
                let fix = "choose another name by --out, or replace it by --replace";
                RunError::Usage(format!("{} exists already; {fix}", out.display()))
            }
            _ => file_failure(out, &error),
        })?;
        file.write_all(import.text.as_bytes()).map_err(|error| file_failure(out, &error))
    }
}

/// Returns the name of the folder that contains a file, if a case can have it.
fn default_name(path: &Path) -> String {
    let whole = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    let folder = whole.parent().and_then(Path::file_name);
    valid(folder.map(|name| name.to_string_lossy().into_owned()))
}

/// Returns the name of the case in a file.
fn name_of(out: &Path) -> String {
    valid(out.file_stem().map(|stem| stem.to_string_lossy().into_owned()))
}

fn valid(name: Option<String>) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    let fits = |name: &String| {
        (1..=64).contains(&name.len()) && name.chars().all(plain) && !name.starts_with('.')
    };
    name.filter(fits).unwrap_or_else(|| DEFAULT.to_owned())
}

/// Returns the notes by kind, and the command to type next.
fn summary(out: &Path, configuration: &Configuration, notes: &[Note]) -> String {
    let participants = counted(configuration.participants.len() as u64, "participant");
    let mut summary = format!("{}: {participants}\n", out.display());
    for kind in NoteKind::ALL {
        let mut of_kind = notes.iter().filter(|note| note.kind == kind).peekable();
        if of_kind.peek().is_some() {
            summary += &format!("\n{}:\n", kind.heading());
        }
        of_kind.for_each(|note| summary += &(wrap::columns(&format!("  {note}")) + "\n"));
    }
    summary + &format!("\nnext: coordinator check {}\n", out.display())
}

#[cfg(test)]
mod tests {
    use super::*;
    use case::{RawCase, check_without_participants};

    const TEXT: &str = r#"<precice-configuration>
      <data:scalar name="Load" />
      <data:scalar name="Way" />
      <mesh name="M" dimensions="2"><use-data name="Load" /><use-data name="Way" /></mesh>
      <participant name="A">
        <provide-mesh name="M" />
        <write-data name="Load" mesh="M" /><read-data name="Way" mesh="M" />
      </participant>
      <participant name="B">
        <receive-mesh name="M" from="A" />
        <write-data name="Way" mesh="M" /><read-data name="Load" mesh="M" />
        <watch-point name="W" mesh="M" coordinate="0;0" />
      </participant>
      <coupling-scheme:KIND>
        <participants first="A" second="B" />
        <time-window-size value="0.1" METHOD />
        <max-time value="1" />
        <exchange data="Load" mesh="M" from="A" to="B" />
        <exchange data="Way" mesh="M" from="B" to="A" />
        INSIDE
      </coupling-scheme:KIND>
    </precice-configuration>"#;

    fn import(kind: &str, method: &str, inside: &str) -> (Configuration, Import) {
        let text = TEXT.replace("KIND", kind).replace("METHOD", method).replace("INSIDE", inside);
        let configuration = Configuration::parse(&text).unwrap();
        let options = ImportOptions { name: "pair".to_owned(), ..ImportOptions::default() };
        let import = case_of(&configuration, &options).unwrap();
        (configuration, import)
    }

    /// Every key that an import writes is one of a case, with a value in its range.
    #[test]
    fn imported_cases_are_valid() {
        let inside = "<max-iterations value=\"9\" /><min-iterations value=\"9\" />\
            <relative-convergence-measure data=\"Way\" mesh=\"M\" limit=\"1e-3\" />\
            <absolute-convergence-measure data=\"Load\" mesh=\"M\" limit=\"1e-300\" />\
            <residual-relative-convergence-measure data=\"Load\" mesh=\"M\" limit=\"1\" />\
            <acceleration:IQN-ILS><data name=\"Way\" mesh=\"M\" /><filter limit=\"0\" />\
            <initial-relaxation value=\"7\" /><max-used-iterations value=\"5000\" />\
            <preconditioner type=\"residual\" /></acceleration:IQN-ILS>";
        for (kind, method, inside) in [
            ("serial-explicit", "", ""),
            ("serial-explicit", "method=\"first-participant\"", ""),
            ("serial-implicit", "method=\"first-participant\"", inside),
            ("serial-implicit", "", inside),
            ("parallel-implicit", "", inside),
        ] {
            let (_, import) = import(kind, method, inside);
            let raw = RawCase::parse("pair.toml", &import.text).unwrap();
            let checked = check_without_participants(&raw);
            let checked = checked.unwrap_or_else(|problems| panic!("{problems}\n{}", import.text));
            assert_eq!((checked.name.as_str(), checked.participants.len()), ("pair", 2));
        }
    }

    #[test]
    fn the_summary_fits_a_terminal_and_names_the_next_command() {
        let (configuration, import) = import("serial-explicit", "", "");
        let text = summary(Path::new("pair.toml"), &configuration, &import.notes);
        assert!(text.starts_with("pair.toml: 2 participants\n"), "{text}");
        assert!(text.ends_with("next: coordinator check pair.toml\n"), "{text}");
        assert!(text.contains("\nWithout a counterpart:\n  line"), "{text}");
        assert!(text.lines().all(|line| line.chars().count() <= wrap::WIDTH), "{text}");
    }

    #[test]
    fn programs_are_quoted_as_in_a_shell() {
        let words = |text: &str| program(text).map(|(name, words)| (name, words.join("|")));
        let expected = ("Fluid".to_owned(), "python3|my solver.py|--a=b".to_owned());
        assert_eq!(words("Fluid=python3 'my solver.py' --a=b"), Ok(expected));
        for wrong in [
            "Fluid",
            "Fluid=",
            "Fluid='open",
            "Fluid=cd fluid && ./run.sh",
            "Fluid=./run.sh > log",
            "Fluid=OMP_NUM_THREADS=2 ./fluid",
        ] {
            assert!(words(wrong).is_err(), "{wrong}");
        }
        assert!(words("Fluid=sh -c 'cd fluid && ./run.sh'").is_ok());
        assert!(words("Fluid=./a=b").is_ok());
    }

    #[test]
    fn names_are_valid_for_a_case() {
        assert_eq!(name_of(Path::new("a/heat-1.toml")), "heat-1");
        for odd in ["a/ß.toml", ".hidden", "a b.toml"] {
            assert_eq!(name_of(Path::new(odd)), DEFAULT, "{odd}");
        }
    }
}
