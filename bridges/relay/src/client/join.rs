//! Takes part in a run on behalf of the remote participant.

use super::connection::{Connection, Membership, leave, out_of_turn};
use super::participant::LocalParticipant;
use super::serve::Service;
use super::{Client, ClientError};
use crate::frame::Frame;
use contract::description::Description;
use proto::run_dir::RunDir;
use std::io::Write;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// Interval between checks of the coordinator.
const LOOK: Duration = Duration::from_millis(50);

/// Takes part in a run until the run is finished.
///
/// # Errors
/// Fails if the run cannot be joined, the server cannot be reached, or the remote participant
/// fails.
pub fn join(client: &Client, folder: &Path, role: &str) -> Result<(), ClientError> {
    let run = RunDir::join(folder, role).map_err(ClientError::of)?;
    let info = run.info().clone();
    let watch = run.watch().map_err(ClientError::of)?;
    // Declared first, so that ports close before the process leaves the folder of the run.
    let membership: Membership = Arc::new(Mutex::new(Some(run)));
    let finished = Arc::new(Mutex::new(false));
    follow(move || watch.is_alive(), Arc::clone(&membership), Arc::clone(&finished));
    let connection = Connection::open(client, &membership)?;
    connection.send(&Frame::Join { packing: client.packing })?;
    let description = joined(&connection)?;
    if description.role != role {
        let (name, plays) = (&description.name, &description.role);
        return Err(ClientError::of(format!(
            "{}: the remote program, `{name}`, plays `{plays}`, not `{role}`",
            client.address
        )));
    }
    let (participant, heart) = LocalParticipant::open(&info, role).map_err(ClientError::of)?;
    connection.link.listen(Some(heart));
    let mut service = Service::new(participant, &connection, description, client.packing);
    // The coordinator may end after the reply to `Finish`; this is no error.
    let served = service.serve(|| *finished.lock().unwrap_or_else(PoisonError::into_inner) = true);
    drop(service);
    // Ports of the participant belong to its node and must close first.
    connection.link.listen(None);
    served?;
    connection.close();
    Ok(())
}

/// Waits until the remote program has joined its run, and returns its description.
fn joined(connection: &Connection) -> Result<Description, ClientError> {
    let answer = connection.next()?;
    match Frame::read(&answer).map_err(ClientError::of)? {
        Frame::Joined { description } => serde_json::from_slice(description).map_err(|error| {
            ClientError::of(format!("the description of the remote program is not valid: {error}"))
        }),
        _ => Err(out_of_turn()),
    }
}

/// Ends the process if the coordinator dies before the run is finished.
fn follow(
    is_alive: impl Fn() -> bool + Send + 'static,
    membership: Membership,
    finished: Arc<Mutex<bool>>,
) -> JoinHandle<()> {
    std::thread::spawn(move || {
        while is_alive() {
            std::thread::sleep(LOOK);
        }
        // Held until the process ends, so that the run cannot be marked as finished meanwhile.
        let finished = finished.lock().unwrap_or_else(PoisonError::into_inner);
        if *finished {
            return;
        }
        let _ = writeln!(std::io::stderr(), "error: the coordinator has ended; this run is over");
        leave(&membership, 1);
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If the run were not marked as finished, this would end the test process.
    #[test]
    fn a_coordinator_that_ends_after_the_run_is_no_fault() {
        let finished = Arc::new(Mutex::new(true));
        follow(|| false, Membership::default(), finished).join().unwrap();
    }
}
