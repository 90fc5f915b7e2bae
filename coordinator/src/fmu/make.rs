//! An FMU of a case.

use super::description::{self, About, structured};
use super::pack::{self, Entry};
use super::page;
use super::resources::{self, OPTIONS, Resources};
use super::variables::Variables;
use crate::case_arguments::CaseArguments;
use crate::drive::planned;
use crate::output;
use clap::Args;
use contact_fmu::manifest::{self, Input, Manifest};
use contract::description::KeySpec;
use run::error::{RunError, file_failure};
use run::plan::{Plan, Planned};
use std::collections::BTreeSet;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

/// The library that goes into every FMU, beside the coordinator.
const LIBRARY: &str = "libcontact_fmu.so";

/// The command line of `coordinator fmu`.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    of: CaseArguments,
    /// The FMU that is written [default: NAME.fmu].
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Writes an FMU for co-simulation, of FMI 3.0.
///
/// # Errors
/// That of the case, one without live values, the file system.
pub(crate) fn main(asked: &Arguments, quiet: bool) -> Result<(), RunError> {
    let mut of = asked.of.clone();
    of.set.extend(OPTIONS.map(str::to_owned));
    let planned = planned(&of)?;
    let plan = &planned.plan;
    let variables = Variables::of(plan);
    if variables.inputs.is_empty() {
        return Err(without_inputs(&planned));
    }
    let Resources { mut entries, options, programs, outside } = resources::gather(&planned)?;
    let input = |one: &super::variables::Variable| {
        let start = one.input.map_or(f64::NAN, |(first, _)| first);
        Input { key: one.key.clone(), start }
    };
    let manifest = Manifest {
        token: token(&planned, &variables),
        options,
        programs,
        inputs: variables.inputs.iter().map(input).collect(),
        outputs: variables.outputs.iter().map(|one| one.key.clone()).collect(),
    };
    let identifier = identifier(&plan.name);
    let about = About {
        name: &plan.name,
        title: plan.title.as_deref(),
        identifier: &identifier,
        version: env!("CARGO_PKG_VERSION"),
    };
    let text = |name: &str, content: String| Entry {
        name: name.to_owned(),
        content: content.into_bytes(),
        executable: false,
    };
    let json = serde_json::to_string_pretty(&manifest).expect("a manifest is plain data");
    entries
        .insert(0, text("modelDescription.xml", description::text(&about, &variables, &manifest)));
    entries.push(text(&format!("resources/{}", manifest::FILE), json));
    let page = page::text(&plan.name, plan.title.as_deref(), &variables);
    entries.push(text("documentation/index.html", page));
    let name = format!("binaries/{}-linux/{identifier}.so", std::env::consts::ARCH);
    entries.push(Entry { name, content: library()?, executable: true });
    let path = asked.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.fmu", plan.name)));
    pack::write(&path, &entries)?;
    for (role, command) in outside {
        tracing::warn!(
            "`{command}`, which plays {role}, is not in the FMU: it has to be on every machine that runs it"
        );
    }
    if quiet { Ok(()) } else { output::print(&shown(&path, &variables)) }
}

/// What was made, for a person.
fn shown(path: &Path, variables: &Variables) -> String {
    let mut text = format!("{}\n", path.display());
    for input in &variables.inputs {
        text += &format!("  input   {} [{}]\n", structured(&input.key), input.unit);
    }
    text + &format!("  outputs {}\n", variables.outputs.len())
}

/// There is nothing to drive the case by.
fn without_inputs(planned: &Planned) -> RunError {
    let Planned { case, plan } = planned;
    let reason = "an FMU has the live values of its case as inputs, and this case has none";
    let keys: Vec<String> = may_vary(plan).into_iter().collect();
    let fix = format!(
        "write one of {} as {{ at = ..., from = ..., to = ... }}: its first value, and the limits \
         of all others",
        keys.join(", ")
    );
    let problem = case.problem_at("case.name", reason, fix);
    case.report(vec![problem]).expect("there is a problem").into()
}

/// The keys of a case that may vary.
fn may_vary(plan: &Plan) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for one in &plan.participants {
        let description = &one.description;
        let models = description.models.iter().flat_map(|model| &model.keys);
        let effects = description.effects.iter().flat_map(|effect| &effect.keys);
        let all = description.keys.iter().chain(models).chain(effects);
        let read = |spec: &&KeySpec| spec.varies && one.configuration.case.has(&spec.path);
        found.extend(all.filter(read).map(|spec| spec.path.clone()));
    }
    found
}

/// The same for the same case, variables and version.
fn token(planned: &Planned, variables: &Variables) -> String {
    let half = |salt: u8| {
        let mut hasher = DefaultHasher::new();
        salt.hash(&mut hasher);
        (env!("COORDINATOR_VERSION"), planned.case.text()).hash(&mut hasher);
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
            "{}: {error}; the library of FMUs stands beside the coordinator: `cargo build --release` \
             makes it",
            path.display()
        ))
    })
}
