//! Parts common to instances of FMI 2.0 and 3.0: library, states, termination.

use crate::description::{ModelDescription, Version};
use crate::library::{Component, Loaded, States};
use crate::slave::{Fault, Health, Kept};

type Terminate = unsafe extern "C" fn(Component) -> i32;
type Free = unsafe extern "C" fn(Component);

/// Instance of an FMU, freed on drop.
#[derive(Debug)]
pub struct Instance {
    /// Handle passed to functions of FMI.
    pub component: Component,
    /// Log messages, and whether the instance is still usable.
    pub health: Health,
    states: Option<States>,
    terminate: Terminate,
    free: Free,
    started: bool,
}

impl Instance {
    /// Creates an instance by `make`, which receives the logger.
    ///
    /// # Errors
    /// Fails if a function is missing or the FMU creates no instance.
    pub fn new(
        library: &Loaded,
        of: &ModelDescription,
        make: impl FnOnce(&Health) -> Component,
    ) -> Result<Self, String> {
        let states = States::find(library, of)?;
        let [terminate, free] = match of.version {
            Version::Two => ["fmi2Terminate", "fmi2FreeInstance"],
            Version::Three => ["fmi3Terminate", "fmi3FreeInstance"],
        };
        // SAFETY: both versions of FMI give these types to these names.
        let (terminate, free) = unsafe { (library.function(terminate)?, library.function(free)?) };
        let health = Health::default();
        let component = make(&health);
        if component.is_null() {
            let said = health.logger.take().unwrap_or_else(|| "no reason given".to_owned());
            return Err(format!("the FMU created no instance: {said}"));
        }
        Ok(Self { component, health, states, terminate, free, started: false })
    }

    /// Calls a function of the instance, unless a fatal error occurred before.
    ///
    /// # Errors
    /// Fails if the function returns an error, or after a fatal error.
    pub fn call(
        &mut self,
        name: &str,
        function: impl FnOnce(Component) -> i32,
    ) -> Result<(), Fault> {
        self.health.usable()?;
        let status = function(self.component);
        self.health.check(name, status)
    }

    /// Marks the initialisation as complete: the instance must be terminated before it is freed.
    pub fn has_started(&mut self) {
        self.started = true;
    }

    fn states(&mut self) -> Result<(&States, Component, &mut Health), Fault> {
        self.health.usable()?;
        match &self.states {
            Some(states) => Ok((states, self.component, &mut self.health)),
            None => Err(Fault("the FMU cannot save states (canGetAndSetFMUstate)".to_owned())),
        }
    }

    pub(crate) fn keep(&mut self, state: &mut Kept) -> Result<(), Fault> {
        let (states, of, health) = self.states()?;
        states.keep(of, health, state)
    }

    pub(crate) fn return_to(&mut self, state: &Kept) -> Result<(), Fault> {
        let (states, of, health) = self.states()?;
        states.return_to(of, health, state)
    }

    pub(crate) fn bytes(&mut self, state: &Kept) -> Result<Vec<u8>, Fault> {
        let (states, of, health) = self.states()?;
        states.write(of, health, state)
    }

    pub(crate) fn read_bytes(&mut self, bytes: &[u8], state: &mut Kept) -> Result<(), Fault> {
        let (states, of, health) = self.states()?;
        states.read(of, health, bytes, state)
    }

    pub(crate) fn free(&mut self, state: &mut Kept) {
        if let Ok((states, of, _)) = self.states() {
            states.free(of, state);
        }
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        if self.health.fatal {
            return;
        }
        // SAFETY: the instance lives and is not used afterwards.
        unsafe {
            if self.started {
                (self.terminate)(self.component);
            }
            (self.free)(self.component);
        }
    }
}
