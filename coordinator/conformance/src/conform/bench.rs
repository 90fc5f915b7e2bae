//! The participant under test, the settings in which it is tested, and the processes that checks
//! share.
//!
//! A participant may take seconds to start, and some checks leave it in a well-defined state:
//! joined but not configured, or between two windows. Such a process is kept for the next check. A
//! process in which a check failed, or that a check has spoilt, is not. While one process is
//! checked, the next ones start.

use super::fault::{CheckFailure, Finding, broken};
use super::input::RecordedInputs;
use super::life::{Subject, TestProcess, Values};
use super::setting::{self, Request, Setting};
use contract::configuration::Configuration;
use contract::description::Description;
use contract::message::{Command, CommandKind};
use run::error::RunError;
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::num::NonZero;
use std::rc::Rc;

/// The participant under test, with all that it is tested with.
pub(super) struct TestBench {
    pub(super) subject: Subject,
    /// Every model in every mode, as configured by the case.
    pub(super) settings: Vec<Setting>,
    /// Models and modes that do not fit the case, with the reason.
    pub(super) left_out: Vec<String>,
    /// Models and modes for which planning failed, with the failure.
    pub(super) misled: Vec<String>,
    /// Whether to test only the cheapest setting, on small grids.
    pub(super) quick: bool,
    /// Processes that checks share.
    pub(super) lives: ProcessPool,
}

impl TestBench {
    /// Asks the program for its description, and configures all models and modes that it offers.
    /// Returns the bench, and a fault if the program does not describe itself.
    ///
    /// # Errors
    /// The program, case or recording does not exist, or the user has interrupted the command.
    pub(super) fn prepare(
        request: &Request,
        configures: bool,
    ) -> Result<(Self, Option<CheckFailure>), RunError> {
        if !request.program.exists() {
            let (role, program) = (request.role.clone(), request.program.clone());
            return Err(RunError::NoProgram { role, program });
        }
        let recorded = request.recording.as_deref();
        let recorded =
            recorded.map(|path| RecordedInputs::read(path, &request.role)).transpose()?;
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
            lives: ProcessPool::default(),
        };
        match bench.described() {
            Ok(description) => bench.subject.description = description,
            Err(CheckFailure::Interrupted(signal)) => {
                let when = format!("while {} was asked to describe", request.role);
                return Err(RunError::Interrupted { signal, when });
            }
            Err(failure) => return Ok((bench, Some(failure))),
        }
        if configures {
            let found = setting::all(request, &bench.subject.description, recorded.as_ref())?;
            (bench.settings, bench.left_out, bench.misled) =
                (found.settings, found.left_out, found.misled);
        }
        Ok((bench, None))
    }

    /// Asks the program for its description.
    fn described(&self) -> Result<Description, CheckFailure> {
        let mut life = TestProcess::start(&self.subject)?.joined()?;
        life.ask(Command::new(CommandKind::Describe), &[])?.done()?.json("a description")
    }

    /// Returns name and version, according to the description of the program.
    pub(super) fn program_name(&self) -> String {
        let Description { name, version, .. } = &self.subject.description;
        format!("{name} {version}").trim().to_owned()
    }

    /// Returns the cheapest setting, for checks that do not depend on the model.
    pub(super) fn first(&self) -> Result<&Setting, CheckFailure> {
        match self.settings.first() {
            Some(setting) => Ok(setting),
            None => {
                let why: Vec<&str> =
                    self.misled.iter().chain(&self.left_out).map(String::as_str).collect();
                broken(format!("it cannot be configured with this case: {}", why.join("; ")))
            }
        }
    }

    /// Runs a check in all settings, and returns its findings without repetitions.
    pub(super) fn each(
        &self,
        mut look: impl FnMut(&Setting) -> Result<Finding, CheckFailure>,
    ) -> Result<Finding, CheckFailure> {
        self.first()?;
        let (mut kept, mut inapplicable) = (Vec::new(), Vec::new());
        for setting in &self.settings {
            let (list, words) = match look(setting).map_err(|f| f.at(&setting.label()))? {
                Finding::Kept(words) => (&mut kept, words),
                Finding::Inapplicable(words) => (&mut inapplicable, words),
            };
            if !list.contains(&words) {
                list.push(words);
            }
        }
        match kept.is_empty() {
            false => Finding::kept(kept.join("; ")),
            true => Finding::inapplicable(inapplicable.join("; ")),
        }
    }
}

/// Returns the description of a program before it has given one.
fn nobody(role: &str) -> Description {
    Description {
        protocol: contract::PROTOCOL_VERSION,
        role: role.to_owned(),
        reusable: true,
        ..Description::default()
    }
}

/// All values that a fresh process publishes, in outputs and observed fields.
pub(super) struct Reference {
    /// Values of the first window, for inputs of variation 0.
    pub(super) first: Values,
    /// Values of the second window, for inputs of variation 1, after the first window was accepted
    /// without observation.
    pub(super) second: Values,
}

/// Running processes that are not in use.
#[derive(Default)]
pub(super) struct ProcessPool {
    /// A process that has joined and is not initialised.
    pub(super) joined: RefCell<Option<TestProcess>>,
    /// Processes between two windows, each with its configuration.
    pub(super) ready: RefCell<Vec<(Configuration, TestProcess)>>,
    /// Windows of fresh processes, see [`TestBench::reference`].
    pub(super) references: RefCell<Vec<(Configuration, Rc<Reference>)>>,
    /// Processes that are starting.
    pub(super) coming: RefCell<VecDeque<TestProcess>>,
    /// Whether any process has joined.
    pub(super) once: Cell<bool>,
    /// Whether a process was started, but none has ever joined.
    pub(super) never: Cell<bool>,
}

/// Largest number of processes that are started ahead.
const MOST_AHEAD: usize = 4;

impl TestBench {
    /// Returns whether a process was started, but none has ever joined.
    pub(super) fn never_joined(&self) -> bool {
        self.lives.never.get()
    }

    /// Returns a process that has joined its own run and is not initialised.
    pub(super) fn joined(&self) -> Result<TestProcess, CheckFailure> {
        let kept = self.lives.joined.borrow_mut().take();
        kept.filter(|life| life.ended().is_none()).map_or_else(|| self.fresh(), Ok)
    }

    /// Keeps a process that a check has left as [`TestBench::joined`] returned it.
    pub(super) fn keep_joined(&self, life: TestProcess) {
        self.lives.joined.borrow_mut().get_or_insert(life);
    }

    /// Returns a process that has joined and received no command yet.
    pub(super) fn fresh(&self) -> Result<TestProcess, CheckFailure> {
        let ProcessPool { coming, once, never, .. } = &self.lives;
        let next = coming.borrow_mut().pop_front();
        let joined = next
            .map_or_else(|| TestProcess::start(&self.subject), Ok)
            .and_then(TestProcess::joined);
        match &joined {
            Ok(_) => {
                once.set(true);
                self.start_ahead();
            }
            Err(_) => never.set(!once.get()),
        }
        joined
    }

    /// Starts as many processes as can start at the same time, up to [`MOST_AHEAD`].
    fn start_ahead(&self) {
        let at_once = std::thread::available_parallelism().map_or(1, NonZero::get).min(MOST_AHEAD);
        let mut coming = self.lives.coming.borrow_mut();
        while coming.len() < at_once
            && let Ok(life) = TestProcess::start(&self.subject)
        {
            coming.push_back(life);
        }
    }

    /// Returns a process that is ready for its very first window.
    pub(super) fn ready(&self, setting: &Setting) -> Result<TestProcess, CheckFailure> {
        let mut life = self.joined()?;
        life.prepare(setting)?;
        Ok(life)
    }

    /// Returns a process that is ready for some window.
    pub(super) fn between(&self, setting: &Setting) -> Result<TestProcess, CheckFailure> {
        let mut ready = self.lives.ready.borrow_mut();
        let of = |(of, life): &(Configuration, TestProcess)| {
            *of == setting.configuration && life.ended().is_none()
        };
        match ready.iter().position(of) {
            Some(index) => Ok(ready.swap_remove(index).1),
            None => {
                drop(ready);
                self.ready(setting)
            }
        }
    }

    /// Keeps a process that a check has left between two windows, with the later one solved or not.
    /// One process for each configuration is kept, because a process may take much memory.
    pub(super) fn keep(&self, setting: &Setting, life: TestProcess) {
        let mut ready = self.lives.ready.borrow_mut();
        if setting.rewinds && ready.iter().all(|(of, _)| *of != setting.configuration) {
            ready.push((setting.configuration.clone(), life));
        }
    }

    /// Returns two windows of a fresh process, for comparison.
    pub(super) fn reference(&self, setting: &Setting) -> Result<Rc<Reference>, CheckFailure> {
        let known = self.lives.references.borrow();
        if let Some((_, reference)) = known.iter().find(|(of, _)| *of == setting.configuration) {
            return Ok(Rc::clone(reference));
        }
        drop(known);
        let step = setting.step(0);
        let first = self.ready(setting)?.published(&step, 0)?;
        let mut life = self.ready(setting)?;
        life.solve_with(&step, 0)?;
        life.accept(&step, false)?;
        let second = life.published(&life.next(setting), 1)?;
        self.keep(setting, life);
        let reference = Rc::new(Reference { first, second });
        let known = (setting.configuration.clone(), Rc::clone(&reference));
        self.lives.references.borrow_mut().push(known);
        Ok(reference)
    }

    /// Runs a check in all settings whose windows may be solved more than once.
    pub(super) fn each_rewinding(
        &self,
        mut look: impl FnMut(&Setting) -> Result<Finding, CheckFailure>,
    ) -> Result<Finding, CheckFailure> {
        self.each(|setting| match setting.rewinds {
            true => look(setting),
            false => Finding::inapplicable("it solves every window once"),
        })
    }

    /// Runs a check in all settings whose windows may be solved more than once. The check starts
    /// and ends with a process between two windows.
    pub(super) fn each_rewinding_between(
        &self,
        mut look: impl FnMut(&Setting, &mut TestProcess) -> Result<Finding, CheckFailure>,
    ) -> Result<Finding, CheckFailure> {
        self.each_rewinding(|setting| self.look_between(setting, &mut look))
    }

    fn look_between(
        &self,
        setting: &Setting,
        look: &mut impl FnMut(&Setting, &mut TestProcess) -> Result<Finding, CheckFailure>,
    ) -> Result<Finding, CheckFailure> {
        let mut life = self.between(setting)?;
        let seen = look(setting, &mut life)?;
        self.keep(setting, life);
        Ok(seen)
    }

    /// Runs a check in all settings. The check starts and ends with a process between two windows.
    pub(super) fn each_between(
        &self,
        mut look: impl FnMut(&Setting, &mut TestProcess) -> Result<Finding, CheckFailure>,
    ) -> Result<Finding, CheckFailure> {
        self.each(|setting| self.look_between(setting, &mut look))
    }
}
