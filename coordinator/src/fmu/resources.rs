//! What an FMU has inside to run its case: the case, the files that it names, and the executables.

use super::pack::Entry;
use contract::configuration::Configuration;
use run::error::{RunError, file_failure};
use run::plan::{Participant, Plan, Planned};
use run::record::case_files;
use std::path::{Path, PathBuf};

/// The resources of a case.
pub(super) struct Resources {
    pub(super) entries: Vec<Entry>,
    /// Options that name files of the case as they are called inside.
    pub(super) options: Vec<String>,
    /// Executables inside.
    pub(super) programs: Vec<String>,
    /// Commands of the case that are not inside, by role.
    pub(super) outside: Vec<(String, String)>,
}

/// Options that every FMU has: it writes no field.
pub(super) const OPTIONS: [&str; 1] = ["output.fields=none"];

/// Gathers the resources.
///
/// # Errors
/// A file cannot be read.
pub(super) fn gather(planned: &Planned) -> Result<Resources, RunError> {
    let Planned { case, plan } = planned;
    let text =
        Entry { name: inside("case.toml"), content: case.text().into_bytes(), executable: false };
    let mut found = Resources {
        entries: vec![text],
        options: Vec::new(),
        programs: Vec::new(),
        outside: Vec::new(),
    };
    for (file, content) in case_files(plan)? {
        let path = plan.participants.iter().find_map(|one| named(&one.configuration, &file.key));
        let end = path.as_deref().and_then(Path::extension).and_then(|end| end.to_str());
        let end = end.map(|end| format!(".{end}")).unwrap_or_default();
        let name = format!("files/{}{end}", file.key);
        found.options.extend(["--set".to_owned(), format!("{}={name:?}", file.key)]);
        found.entries.push(Entry { name: inside(&name), content, executable: false });
    }
    let own =
        std::env::current_exe().map_err(|error| file_failure(Path::new("coordinator"), &error))?;
    found.program("coordinator", &own)?;
    found.participants(plan, own.parent())?;
    Ok(found)
}

fn inside(name: &str) -> String {
    format!("resources/{name}")
}

/// The path at a key of a configuration.
fn named(configuration: &Configuration, key: &str) -> Option<PathBuf> {
    configuration.case.get(key).and_then(|value| value.as_str()).map(PathBuf::from)
}

impl Resources {
    fn participants(&mut self, plan: &Plan, beside: Option<&Path>) -> Result<(), RunError> {
        for Participant { role, program, .. } in &plan.participants {
            let name = program.name();
            match beside {
                Some(folder) if program.path == folder.join(&name) => {
                    self.program(&name, &program.path)?;
                }
                _ => self.outside.push((role.clone(), program.command_line())),
            }
        }
        Ok(())
    }

    fn program(&mut self, name: &str, path: &Path) -> Result<(), RunError> {
        if self.programs.iter().any(|known| known == name) {
            return Ok(());
        }
        let content = std::fs::read(path).map_err(|error| file_failure(path, &error))?;
        self.entries.push(Entry { name: inside(name), content, executable: true });
        self.programs.push(name.to_owned());
        Ok(())
    }
}
