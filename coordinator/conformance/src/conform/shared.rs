//! How checks come by their processes: a shared one as it was left, or a fresh one.

use super::bench::Bench;
use super::fault::{Fault, Seen};
use super::life::Life;
use super::lives::{Lives, Reference};
use super::setting::Setting;
use contract::configuration::Configuration;
use std::num::NonZero;
use std::rc::Rc;

/// Most processes that are started ahead.
const MOST_AHEAD: usize = 4;

impl Bench {
    /// A process was started, and none has ever joined.
    pub(super) fn never_joined(&self) -> bool {
        self.lives.never.get()
    }

    /// A process that has joined a run of its own and is not initialised.
    pub(super) fn joined(&self) -> Result<Life, Fault> {
        let kept = self.lives.joined.borrow_mut().take();
        kept.filter(|life| life.ended().is_none()).map_or_else(|| self.fresh(), Ok)
    }

    /// A check has left it as [`Bench::joined`] found it.
    pub(super) fn keep_joined(&self, life: Life) {
        self.lives.joined.borrow_mut().get_or_insert(life);
    }

    /// A process that has joined and received nothing yet.
    pub(super) fn fresh(&self) -> Result<Life, Fault> {
        let Lives { coming, once, never, .. } = &self.lives;
        let next = coming.borrow_mut().pop_front();
        let joined = next.map_or_else(|| Life::start(&self.subject), Ok).and_then(Life::joined);
        match &joined {
            Ok(_) => {
                once.set(true);
                self.start_ahead();
            }
            Err(_) => never.set(!once.get()),
        }
        joined
    }

    /// Starts as many processes as can start at the same time.
    fn start_ahead(&self) {
        let at_once = std::thread::available_parallelism().map_or(1, NonZero::get).min(MOST_AHEAD);
        let mut coming = self.lives.coming.borrow_mut();
        while coming.len() < at_once
            && let Ok(life) = Life::start(&self.subject)
        {
            coming.push_back(life);
        }
    }

    /// A process that is ready for its very first window.
    pub(super) fn ready(&self, setting: &Setting) -> Result<Life, Fault> {
        let mut life = self.joined()?;
        life.prepare(setting)?;
        Ok(life)
    }

    /// A process that is ready for some window.
    pub(super) fn between(&self, setting: &Setting) -> Result<Life, Fault> {
        let mut ready = self.lives.ready.borrow_mut();
        let of = |(of, life): &(Configuration, Life)| {
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

    /// A check has left it between two windows, the later one solved or not. One of each configuration
    /// is kept: a process may take much memory.
    pub(super) fn keep(&self, setting: &Setting, life: Life) {
        let mut ready = self.lives.ready.borrow_mut();
        if setting.rewinds && ready.iter().all(|(of, _)| *of != setting.configuration) {
            ready.push((setting.configuration.clone(), life));
        }
    }

    /// Two windows of a fresh process, to compare others with.
    pub(super) fn reference(&self, setting: &Setting) -> Result<Rc<Reference>, Fault> {
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

    /// Goes through all settings whose windows may be solved more than once.
    pub(super) fn each_rewinding(
        &self,
        mut look: impl FnMut(&Setting) -> Result<Seen, Fault>,
    ) -> Result<Seen, Fault> {
        self.each(|setting| match setting.rewinds {
            true => look(setting),
            false => Seen::inapplicable("it solves every window once"),
        })
    }

    /// The same with a process of each that is between two windows and is left so.
    pub(super) fn each_rewinding_between(
        &self,
        mut look: impl FnMut(&Setting, &mut Life) -> Result<Seen, Fault>,
    ) -> Result<Seen, Fault> {
        self.each_rewinding(|setting| self.look_between(setting, &mut look))
    }

    fn look_between(
        &self,
        setting: &Setting,
        look: &mut impl FnMut(&Setting, &mut Life) -> Result<Seen, Fault>,
    ) -> Result<Seen, Fault> {
        let mut life = self.between(setting)?;
        let seen = look(setting, &mut life)?;
        self.keep(setting, life);
        Ok(seen)
    }

    /// Goes through all settings, with a process of each that is between two windows and is left so.
    pub(super) fn each_between(
        &self,
        mut look: impl FnMut(&Setting, &mut Life) -> Result<Seen, Fault>,
    ) -> Result<Seen, Fault> {
        self.each(|setting| self.look_between(setting, &mut look))
    }
}
