//! Replies, and what is required of them.

use crate::conform::fault::{Fault, broken};
use contract::configuration::Refusal;
use contract::message::{Failure, Reply, Status};

/// What came back for a command.
pub(in crate::conform) struct Answer {
    pub(in crate::conform) reply: Reply,
    pub(in crate::conform) status: Status,
    pub(in crate::conform) body: Vec<u8>,
    /// Name of the command.
    pub(super) what: String,
}

impl Answer {
    /// It has been done.
    pub(in crate::conform) fn done(self) -> Result<Self, Fault> {
        match self.status {
            Status::Done => Ok(self),
            _ => {
                let what = self.what.clone();
                broken(format!("{what} is not done: {}", self.reason()?))
            }
        }
    }

    /// It has failed or been refused, with a reason.
    pub(in crate::conform) fn not_done(self, because: &str) -> Result<String, Fault> {
        match self.status {
            Status::Done => broken(format!("{} is done in spite of {because}", self.what)),
            _ => self.reason(),
        }
    }

    /// It has been refused; key, reason and fix are there.
    pub(in crate::conform) fn refused(self, because: &str) -> Result<Refusal, Fault> {
        let what = self.what.clone();
        match self.status {
            Status::Refused => self.refusal(),
            Status::Done => broken(format!("{what} is done in spite of {because}")),
            Status::Failed => {
                let reason = self.reason()?;
                broken(format!("{what} fails with {because} ({reason}); it has to be refused"))
            }
        }
    }

    fn refusal(&self) -> Result<Refusal, Fault> {
        let refusal: Refusal = self.json("a refusal")?;
        if [&refusal.key, &refusal.reason, &refusal.fix].iter().any(|text| text.trim().is_empty()) {
            return broken(format!("its refusal lacks key, reason or fix: {refusal:?}"));
        }
        Ok(refusal)
    }

    fn reason(&self) -> Result<String, Fault> {
        if self.status == Status::Refused {
            return Ok(self.refusal()?.to_string());
        }
        let failure: Failure = self.json("a failure")?;
        match failure.error.trim().is_empty() {
            true => broken(format!("{} fails without saying why", self.what)),
            false => Ok(failure.error),
        }
    }

    /// The body, as what it has to be.
    pub(in crate::conform) fn json<T: serde::de::DeserializeOwned>(
        &self,
        what: &str,
    ) -> Result<T, Fault> {
        serde_json::from_slice(&self.body).map_err(|error| {
            Fault::Broken(format!("the reply to {} is not {what}: {error}", self.what))
        })
    }
}
