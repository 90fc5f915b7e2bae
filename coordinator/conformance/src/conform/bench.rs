//! What all checks of one participant share: what it says of itself, and its settings.

use super::fault::{Fault, Seen, broken};
use super::lives::Lives;
use super::recorded::Recorded;
use super::request::Request;
use super::setting::{self, Setting};
use super::subject::Subject;
use contract::description::Description;
use run::error::RunError;
use std::future::Future;

/// The participant under test, and everything it is tested with.
pub(super) struct Bench {
    pub(super) subject: Subject,
    /// Every model in every mode, as the case configures it.
    pub(super) settings: Vec<Setting>,
    /// Models and modes that the case does not fit, and why.
    pub(super) left_out: Vec<String>,
    /// Models and modes that it could not even be planned with, and how it failed.
    pub(super) misled: Vec<String>,
    /// Only the cheapest setting, and small grids.
    pub(super) quick: bool,
    /// The processes that checks share.
    pub(super) lives: Lives,
}

impl Bench {
    /// Asks the program what it is and configures all that it offers; beside the bench, why the
    /// program does not describe itself, if it does not.
    ///
    /// # Errors
    /// There is no such program, case or recording, or the user wants to stop.
    pub(super) fn prepare(
        request: &Request,
        configures: bool,
    ) -> Result<(Self, Option<Fault>), RunError> {
        let recorded = request.recording.as_deref();
        let recorded = recorded.map(|path| Recorded::read(path, &request.role)).transpose()?;
        let mut bench = Self {
            subject: Subject {
                role: request.role.clone(),
                program: request.program.clone(),
                description: nobody(&request.role),
                patience: request.patience,
            },
            settings: Vec::new(),
            left_out: Vec::new(),
            misled: Vec::new(),
            quick: request.quick,
            lives: Lives::default(),
        };
        match wait_for(bench.subject.program.describe(&bench.subject.role, bench.subject.patience))
        {
            Ok(description) => bench.subject.description = description,
            Err(RunError::Failed(failure)) => {
                return Ok((bench, Some(Fault::Broken(failure.what))));
            }
            Err(other) => return Err(other),
        }
        if configures {
            let found = setting::all(request, &bench.subject.description, recorded.as_ref())?;
            (bench.settings, bench.left_out, bench.misled) =
                (found.settings, found.left_out, found.misled);
        }
        Ok((bench, None))
    }

    /// Name and version, as the program describes itself.
    pub(super) fn program_name(&self) -> String {
        let Description { name, version, .. } = &self.subject.description;
        format!("{name} {version}").trim().to_owned()
    }

    /// The cheapest setting, for what does not depend on the model.
    pub(super) fn first(&self) -> Result<&Setting, Fault> {
        match self.settings.first() {
            Some(setting) => Ok(setting),
            None => {
                let why: Vec<&str> =
                    self.misled.iter().chain(&self.left_out).map(String::as_str).collect();
                broken(format!("it cannot be configured with this case: {}", why.join("; ")))
            }
        }
    }

    /// Goes through all settings; what was seen in them, equal words once.
    pub(super) fn each(
        &self,
        mut look: impl FnMut(&Setting) -> Result<Seen, Fault>,
    ) -> Result<Seen, Fault> {
        self.first()?;
        let (mut kept, mut inapplicable) = (Vec::new(), Vec::new());
        for setting in &self.settings {
            let (list, words) = match look(setting).map_err(|f| f.at(&setting.label()))? {
                Seen::Kept(words) => (&mut kept, words),
                Seen::Inapplicable(words) => (&mut inapplicable, words),
            };
            if !list.contains(&words) {
                list.push(words);
            }
        }
        match kept.is_empty() {
            false => Seen::kept(kept.join("; ")),
            true => Seen::inapplicable(inapplicable.join("; ")),
        }
    }
}

/// Waits for what a program answers outside of a run.
pub(super) fn wait_for<T>(
    answer: impl Future<Output = Result<T, RunError>>,
) -> Result<T, RunError> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let failed = |error| run::error::file_failure(std::path::Path::new("tokio"), &error);
    runtime.map_err(failed)?.block_on(answer)
}

/// What is known of a program before it has said anything.
fn nobody(role: &str) -> Description {
    Description {
        protocol: contract::PROTOCOL_VERSION,
        name: String::new(),
        version: String::new(),
        role: role.to_owned(),
        standalone: false,
        estimates: false,
        advises: false,
        reusable: true,
        models: Vec::new(),
        effects: Vec::new(),
        keys: Vec::new(),
        fields: Vec::new(),
        figures: Vec::new(),
        diagrams: Vec::new(),
        renamed: Vec::new(),
    }
}
