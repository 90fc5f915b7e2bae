//! What instances of FMI 2.0 and 3.0 have alike: a library, states, an end.

use crate::description::{ModelDescription, Version};
use crate::library::{Component, Loaded, States};
use crate::slave::{Fault, Health, Kept};

type Terminate = unsafe extern "C" fn(Component) -> i32;
type Free = unsafe extern "C" fn(Component);

/// An instance, which ends with this.
#[derive(Debug)]
pub struct Instance {
    /// As functions of FMI name it.
    pub component: Component,
    /// What it has said, and whether it can be used.
    pub health: Health,
    states: Option<States>,
    terminate: Terminate,
    free: Free,
    started: bool,
}

impl Instance {
    /// Takes over an instance that `make` makes, which is given a place for messages.
    ///
    /// # Errors
    /// A function is missing; the FMU makes none.
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
            let said = health.logger.take().unwrap_or_else(|| "it does not say why".to_owned());
            return Err(format!("the FMU makes no instance: {said}"));
        }
        Ok(Self { component, health, states, terminate, free, started: false })
    }

    /// Calls a function of the instance, unless it is beyond use.
    ///
    /// # Errors
    /// What the function returns.
    pub fn call(
        &mut self,
        name: &str,
        function: impl FnOnce(Component) -> i32,
    ) -> Result<(), Fault> {
        self.health.usable()?;
        let status = function(self.component);
        self.health.check(name, status)
    }

    /// It has left its initialisation, and has to be terminated.
    pub fn has_started(&mut self) {
        self.started = true;
    }

    fn states(&mut self) -> Result<(&States, Component, &mut Health), Fault> {
        self.health.usable()?;
        match &self.states {
            Some(states) => Ok((states, self.component, &mut self.health)),
            None => Err(Fault("the FMU keeps no states (canGetAndSetFMUstate)".to_owned())),
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
        // SAFETY: the instance lives, and nobody uses it after this.
        unsafe {
            if self.started {
                (self.terminate)(self.component);
            }
            (self.free)(self.component);
        }
    }
}
