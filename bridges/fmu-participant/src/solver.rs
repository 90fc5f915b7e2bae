//! FMU as a solver: its description, and its setup for a configuration.

use crate::archive::Archive;
use crate::description::{ModelDescription, Version};
use crate::figures::{Figures, figures};
use crate::model::{Parts, Running};
use crate::placed;
use crate::start;
use crate::wiring::Wiring;
use proto::accuracy::Accuracy;
use proto::configuration::{Configuration, Refusal};
use proto::description::{Description, ModelSpec};
use proto::field;
use proto::model::{Setup, Solver};
use proto::text::one_line;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Key of the end of the run, which an FMU may need before it starts.
/// Name of the only model.
const MODEL: &str = "co-simulation";

/// FMU with its wiring.
#[derive(Debug)]
pub struct Fmu {
    path: PathBuf,
    role: String,
    pub(crate) description: ModelDescription,
    pub(crate) wiring: Wiring,
    figures: Vec<Figures>,
}

impl Fmu {
    /// Reads an FMU and its wires for a role.
    ///
    /// # Errors
    /// Fails if the file or a wire is invalid.
    pub fn read(path: &Path, role: &str, wires: &[String]) -> Result<Self, String> {
        let text = Archive::open(path)?.text("modelDescription.xml")?;
        let description = ModelDescription::parse(&text)
            .map_err(|fault| format!("{}: modelDescription.xml {fault}", path.display()))?;
        let wiring = Wiring::read(wires, &description)
            .map_err(|fault| format!("{}: {fault}", path.display()))?;
        let figures = figures(&description);
        Ok(Self { path: path.to_owned(), role: role.to_owned(), description, wiring, figures })
    }

    fn source(&self) -> String {
        let ModelDescription { version, name, model_version, tool, .. } = &self.description;
        let fmi = match version {
            Version::Two => "2.0",
            Version::Three => "3.0",
        };
        let made = if tool.is_empty() { String::new() } else { format!(", made by {tool}") };
        let which =
            if model_version.is_empty() { String::new() } else { format!(" {model_version}") };
        one_line(&format!("FMU of FMI {fmi}: {name}{which}{made}")).into_owned()
    }

    fn model(&self) -> ModelSpec {
        let ModelDescription { name, words, keeps_states, varies_step, .. } = &self.description;
        let words = if words.is_empty() { name } else { words };
        let fields = |names: Vec<&str>| names.into_iter().map(str::to_owned).collect();
        ModelSpec {
            name: MODEL.to_owned(),
            summary: one_line(words).into_owned(),
            source: self.source(),
            steady: false,
            transient: true,
            rewinds: *keeps_states,
            varies_step: *varies_step,
            consumes: fields(self.wiring.takes.iter().map(|take| take.spec.name).collect()),
            provides: fields(self.wiring.gives.iter().map(|give| give.spec.name).collect()),
            keys: Vec::new(),
            accuracy: Accuracy::default(),
        }
    }
}

/// Solver that describes an FMU, or runs it.
#[derive(Debug)]
pub struct FmuSolver {
    fmu: Rc<Fmu>,
    /// Folder of the run, where the FMU is unpacked.
    folder: Option<PathBuf>,
}

impl FmuSolver {
    /// Creates a solver; `folder` is the folder of the run, if it takes part in one.
    #[must_use]
    pub fn new(fmu: Fmu, folder: Option<PathBuf>) -> Self {
        Self { fmu: Rc::new(fmu), folder }
    }
}

impl Solver for FmuSolver {
    fn description(&self) -> Description {
        let Fmu { role, description, wiring, figures, .. } = &*self.fmu;
        let mut keys = start::keys(role, description);
        if wiring.has_arrays() {
            keys.extend(placed::keys(role));
        }
        let own = wiring.gives.iter().filter(|give| field::find(give.spec.name).is_none());
        Description {
            protocol: proto::PROTOCOL_VERSION,
            name: "fmu-participant".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            role: role.clone(),
            standalone: true,
            estimates: true,
            advises: false,
            reusable: false,
            build: None,
            models: vec![self.fmu.model()],
            effects: Vec::new(),
            keys,
            fields: own.map(|give| give.kind.clone()).collect(),
            figures: figures.iter().flat_map(|figures| figures.specs(role)).collect(),
            diagrams: Vec::new(),
            renamed: Vec::new(),
        }
    }

    fn configure(&self, configuration: &Configuration) -> Result<Setup, Refusal> {
        let Fmu { role, description, wiring, .. } = &*self.fmu;
        let starts = start::read(role, description, &configuration.case)?;
        let (placed, layout) = placed::place(role, wiring, configuration)?;
        let end = configuration.windows.and_then(|windows| windows.end);
        let folder = self.folder.as_ref().map(|folder| folder.join(format!("fmu-{role}")));
        let fmu = Rc::clone(&self.fmu);
        Ok(Setup::new(layout, move |_| {
            let Fmu { path, role, description, figures, .. } = &*fmu;
            let failed = |reason: String| {
                let reason = format!("{}: {reason}", path.display());
                let fix = "correct the FMU or name a different one";
                Refusal::new(&format!("{role}.command"), reason, fix)
            };
            let unknown =
                || failed("an FMU is unpacked only for a run, and no run is given".to_owned());
            let folder = folder.ok_or_else(unknown)?;
            let placed =
                placed.ok_or_else(|| failed("the grid of an input is unknown".to_owned()))?;
            Archive::open(path).and_then(|mut archive| archive.unpack(&folder)).map_err(failed)?;
            // The FMU receives the path of its resources, which must exist even if it has none.
            std::fs::create_dir_all(folder.join("resources"))
                .map_err(|error| failed(format!("{}: {error}", folder.display())))?;
            let parts = Parts { role, description, figures, starts: &starts, placed, end };
            Ok(Box::new(Running::new(&folder, parts).map_err(failed)?))
        }))
    }
}
