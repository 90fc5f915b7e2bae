//! An FMU, of what a case or a surrogate gives.

use super::description::{self, About, structured};
use super::pack::{self, Entry};
use super::page;
use super::variables::{Variable, Variables};
use contact_fmu::manifest::{self, Input, Manifest, Of};
use run::error::{RunError, file_failure};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

/// The library that goes into every FMU, beside the coordinator.
const LIBRARY: &str = "libcontact_fmu.so";

/// What an FMU is made of.
pub(super) struct Parts<'a> {
    /// Name of the case, and of the FMU.
    pub(super) name: &'a str,
    pub(super) title: Option<&'a str>,
    /// A case or a surrogate, as text: the same gives the same FMU.
    pub(super) text: &'a str,
    pub(super) of: Of,
    pub(super) variables: &'a Variables,
    /// Resources, without the manifest.
    pub(super) entries: Vec<Entry>,
}

/// Writes an FMU, to NAME.fmu where no path is named; where it is, and what has been made, for a person.
///
/// # Errors
/// The file system; there is no library.
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
    let described = description::text(&about, variables, &manifest);
    entries.insert(0, plain("modelDescription.xml", described));
    entries.push(plain(&format!("resources/{}", manifest::FILE), json));
    entries.push(plain("documentation/index.html", page::text(name, title, variables)));
    let name_inside = format!("binaries/{}-linux/{identifier}.so", std::env::consts::ARCH);
    entries.push(Entry { name: name_inside, content: library()?, executable: true });
    let path = path.unwrap_or_else(|| PathBuf::from(format!("{name}.fmu")));
    pack::write(&path, &entries)?;
    Ok(shown(&path, variables))
}

/// What was made, for a person.
fn shown(path: &Path, variables: &Variables) -> String {
    let mut text = format!("{}\n", path.display());
    for input in &variables.inputs {
        text += &format!("  input   {} [{}]\n", structured(&input.key), input.unit);
    }
    text + &format!("  outputs {}\n", variables.outputs.len())
}

/// The same for the same content, variables and version.
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

/// A name of C.
fn identifier(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    format!("case_{}", name.chars().map(plain).collect::<String>())
}

/// The library, from beside this executable; where both are built, tests may have left a newer one in `deps`.
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
