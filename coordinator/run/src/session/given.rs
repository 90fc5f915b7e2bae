//! Live values as they are given: sent once a window, and held to their limits.

use super::Session;
use super::live::{Provided, within};
use crate::error::{Failure, RunError};
use contract::step::Step;
use std::path::Path;
use std::time::Duration;

impl Session {
    /// Whether a value of a key may be given; the place of the key among the live values.
    ///
    /// # Errors
    /// What is wrong, in words: no such key, a value beyond its limits.
    pub fn judge(&self, key: &str, value: f64) -> Result<usize, String> {
        let keys = || self.live.sent.iter().map(|sent| sent.key.as_str()).collect::<Vec<_>>();
        let Some(place) = self.live.sent.iter().position(|sent| sent.key == key) else {
            let known = keys().join(", ");
            return Err(format!("`{key}` is no live value of this run; there are: {known}"));
        };
        let limits = self.live.sent[place].limits;
        if !within(limits, value) {
            let [least, most] = limits;
            return Err(format!(
                "{value} of `{key}` is not between {least} and {most}, the limits of the case"
            ));
        }
        Ok(place)
    }

    /// Gives the value of a key, from the next window that is solved on.
    ///
    /// # Errors
    /// As [`Session::judge`].
    pub fn give(&mut self, key: &str, value: f64) -> Result<(), String> {
        let place = self.judge(key, value)?;
        let sent = &mut self.live.sent[place];
        if sent.value.to_bits() != value.to_bits() {
            sent.value = value;
            self.live.window = None;
        }
        Ok(())
    }

    /// The live values that the coordinator gives, by key.
    pub fn given(&self) -> impl Iterator<Item = (&str, f64)> {
        self.live.sent.iter().map(|sent| (sent.key.as_str(), sent.value))
    }

    /// The value that a participant has given a key last in a window, if it gives it.
    #[must_use]
    pub fn provided(&self, key: &str, step: &Step) -> Option<f64> {
        let mut taps = self.live.provided.iter().map(|provided| &self.taps[provided.tap]);
        let sample = taps.find(|tap| tap.kind.name == key)?.sample.as_ref()?;
        (sample.header().window == step.window).then(|| sample.values().first().copied()).flatten()
    }

    /// The folder of the run, in memory, which goes with it.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.peers.info().folder
    }

    /// Lets time pass, with an eye on processes and signals.
    ///
    /// # Errors
    /// A process has ended; the user wants to stop.
    pub fn idle(&mut self, time: Duration) -> Result<(), RunError> {
        self.peers.idle(time, || ()).map_err(|stopped| self.peers.stopped(stopped))
    }

    /// Sends the values of a window, once.
    pub(super) fn send_live(&mut self, step: &Step) -> Result<(), RunError> {
        let window = Some((step.window, step.start, step.end));
        if self.live.window == window {
            return Ok(());
        }
        for place in 0..self.live.sent.len() {
            let sent = &mut self.live.sent[place];
            let published = sent.outlet.loan().and_then(|mut loan| {
                loan.values().fill(sent.value);
                sent.outlet.publish(loan, step)
            });
            published.map_err(|error| self.not_sent(&error))?;
            self.bytes_exchanged += size_of::<f64>() as u64;
        }
        self.live.window = window;
        Ok(())
    }

    /// What participants have given as live values of a window is within the limits of the case.
    pub(super) fn check_live(&self) -> Result<(), RunError> {
        for Provided { tap, limits } in &self.live.provided {
            let tap = &self.taps[*tap];
            let Some(value) = tap.values().and_then(|values| values.first()) else { continue };
            if !within(*limits, *value) {
                let ([least, most], key) = (limits, &tap.kind.name);
                return Err(RunError::Failed(Failure {
                    who: self.peers.all()[tap.producer].who(),
                    when: self.peers.phase.to_string(),
                    what: format!(
                        "it gives `{key}` the value {value}, which is not between {least} and {most}"
                    ),
                    fix: format!("write wider limits of `{key}`, or see why it gives that"),
                }));
            }
        }
        Ok(())
    }
}
