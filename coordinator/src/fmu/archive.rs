//! The archive of an FMU: descriptions, resources and library. Files have no times, so that equal
//! cases give equal bytes.

use super::description::{self, About, structured};
use super::variables::{Variable, Variables};
use contact_fmu::manifest::{self, Input, Manifest, Of};
use contract::configuration::Configuration;
use run::error::{RunError, file_failure};
use run::plan::{Participant, Plan, Planned};
use run::record::case_files;
use std::fs::File;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// Library of every FMU, found beside the coordinator.
const LIBRARY: &str = "libcontact_fmu.so";

/// Parts of an FMU.
pub(super) struct Parts<'a> {
    /// Name of the case, and of the FMU.
    pub(super) name: &'a str,
    pub(super) title: Option<&'a str>,
    /// Text of the case or the surrogate. Equal texts give equal FMUs.
    pub(super) text: &'a str,
    pub(super) of: Of,
    pub(super) variables: &'a Variables,
    /// Resources, without the manifest.
    pub(super) entries: Vec<Entry>,
}

/// Writes an FMU, by default to NAME.fmu. Returns a text about it for the terminal.
///
/// # Errors
/// The library is missing, or the file cannot be written.
pub(super) fn write(parts: Parts<'_>, path: Option<PathBuf>) -> Result<String, RunError> {
    let Parts { name, title, text, of, variables, mut entries } = parts;
    let begin = |one: &Variable| {
        let start = one.input.map_or(f64::NAN, |(first, _)| first);
        Input { key: one.key.clone(), start }
    };
    let manifest = Manifest {
        token: token(text, variables),
        of,
        inputs: variables.inputs.iter().map(begin).collect(),
        outputs: variables.outputs.iter().map(|one| one.key.clone()).collect(),
    };
    let identifier = identifier(name);
    let about = About { name, title, identifier: &identifier, version: env!("CARGO_PKG_VERSION") };
    let plain = |name: &str, content: String| Entry {
        name: name.to_owned(),
        content: content.into_bytes(),
        executable: false,
    };
    let json = serde_json::to_string_pretty(&manifest).expect("a manifest is plain data");
    let described = description::model_description(&about, variables, &manifest);
    entries.insert(0, plain("modelDescription.xml", described));
    entries.push(plain(&format!("resources/{}", manifest::FILE), json));
    entries.push(plain("documentation/index.html", description::page(name, title, variables)));
    let name_inside = format!("binaries/{}-linux/{identifier}.so", std::env::consts::ARCH);
    entries.push(Entry { name: name_inside, content: library()?, executable: true });
    let path = path.unwrap_or_else(|| PathBuf::from(format!("{name}.fmu")));
    write_archive(&path, &entries)?;
    Ok(shown(&path, variables))
}

/// Returns a text about the FMU for the terminal.
fn shown(path: &Path, variables: &Variables) -> String {
    let mut text = format!("{}\n", path.display());
    for input in &variables.inputs {
        text += &format!("  input   {} [{}]\n", structured(&input.key), input.unit);
    }
    text + &format!("  outputs {}\n", variables.outputs.len())
}

/// Returns the token of an FMU: equal for equal content, variables and version.
fn token(text: &str, variables: &Variables) -> String {
    let half = |salt: u8| {
        let mut hasher = DefaultHasher::new();
        salt.hash(&mut hasher);
        (env!("COORDINATOR_VERSION"), text).hash(&mut hasher);
        variables.all().for_each(|one| (&one.key, &one.unit).hash(&mut hasher));
        hasher.finish()
    };
    format!("{{{:016x}{:016x}}}", half(0), half(1))
}

/// Returns a valid identifier of C.
fn identifier(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    format!("case_{}", name.chars().map(plain).collect::<String>())
}

/// Finds the library beside this executable. Tests may have built a newer one in `deps`.
fn library() -> Result<Vec<u8>, RunError> {
    let own =
        std::env::current_exe().map_err(|error| file_failure(Path::new("coordinator"), &error))?;
    let beside = own.with_file_name(LIBRARY);
    let built = own.with_file_name("deps").join(LIBRARY);
    let changed = |path: &PathBuf| path.metadata().and_then(|file| file.modified()).ok();
    let newest = [&beside, &built].into_iter().max_by_key(|path| changed(path));
    let path = newest.filter(|path| path.is_file()).unwrap_or(&beside);
    std::fs::read(path).map_err(|error| {
        RunError::Usage(format!(
            "{}: {error}; the library of FMUs has to stand beside the coordinator: `cargo build \
             --release` makes it, copy target/release/{LIBRARY} there",
            path.display()
        ))
    })
}

/// The resources of a case.
pub(super) struct Resources {
    pub(super) entries: Vec<Entry>,
    /// Options that give files of the case their names inside the FMU.
    pub(super) options: Vec<String>,
    /// Executables inside the FMU.
    pub(super) programs: Vec<String>,
    /// Commands of the case outside the FMU, by role.
    pub(super) outside: Vec<(String, String)>,
}

/// Options of every FMU: fields are not written.
pub(super) const OPTIONS: [&str; 1] = ["output.fields=none"];

/// Collects the resources.
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

/// Returns the path at a key of a configuration.
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

/// A file of the archive.
pub(super) struct Entry {
    pub(super) name: String,
    pub(super) content: Vec<u8>,
    pub(super) executable: bool,
}

/// Writes an archive under another name first, so that only a complete one has its name.
///
/// # Errors
/// The file cannot be written.
fn write_archive(path: &Path, entries: &[Entry]) -> Result<(), RunError> {
    let failed = |error: &io::Error| file_failure(path, error);
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let draft = tempfile::Builder::new()
        .prefix(".fmu-")
        .tempfile_in(folder.unwrap_or(Path::new(".")))
        .map_err(|error| failed(&error))?;
    archive(draft.as_file(), entries).map_err(|error| failed(&error))?;
    draft.persist(path).map_err(|error| failed(&error.error))?;
    let mode = std::os::unix::fs::PermissionsExt::from_mode(0o644);
    std::fs::set_permissions(path, mode).map_err(|error| failed(&error))
}

fn archive(file: &File, entries: &[Entry]) -> io::Result<()> {
    let mut zip = ZipWriter::new(BufWriter::new(file));
    for Entry { name, content, executable } in entries {
        let mode = if *executable { 0o755 } else { 0o644 };
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(zip::DateTime::default())
            .unix_permissions(mode);
        zip.start_file(name, options).map_err(io::Error::other)?;
        zip.write_all(content)?;
    }
    zip.finish().map_err(io::Error::other)?.flush()
}
