//! Taking part in a run in the place of the participant at the server.

use super::connection::{Connection, Membership, leave, out_of_turn};
use super::participant::LocalParticipant;
use super::serve::Service;
use super::{Client, ClientError};
use crate::frame::Frame;
use proto::run_dir::RunDir;
use std::io::Write;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// From one look at the coordinator to the next.
const LOOK: Duration = Duration::from_millis(50);

/// Takes part in a run.
///
/// # Errors
/// The run cannot be joined, the server not reached; or how the participant there has ended.
pub fn join(client: &Client, folder: &Path, role: &str) -> Result<(), ClientError> {
    let run = RunDir::join(folder, role).map_err(ClientError::of)?;
    let info = run.info().clone();
    let watch = run.watch().map_err(ClientError::of)?;
    // Declared first: whatever ends the process, ports close before the run's folder is left.
    let membership: Membership = Arc::new(Mutex::new(Some(run)));
    let finished = Arc::new(Mutex::new(false));
    follow(move || watch.is_alive(), Arc::clone(&membership), Arc::clone(&finished));
    let connection = Connection::open(client, &membership)?;
    let description = connection.description()?;
    if description.role != role {
        let (name, plays) = (&description.name, &description.role);
        return Err(ClientError::of(format!(
            "{}: the program there, `{name}`, plays `{plays}`, not `{role}`",
            client.address
        )));
    }
    connection.send(&Frame::Join { packing: client.packing })?;
    let answer = connection.next()?;
    if Frame::read(&answer).map_err(ClientError::of)? != Frame::Joined {
        return Err(out_of_turn());
    }
    let (participant, heart) = LocalParticipant::open(&info, role).map_err(ClientError::of)?;
    connection.link.listen(Some(heart));
    let mut service = Service::new(participant, &connection, description, client.packing);
    // The coordinator ends after the reply to `Finish`, which is no fault any more.
    let served = service.serve(|| *finished.lock().unwrap_or_else(PoisonError::into_inner) = true);
    drop(service);
    // Its ports belong to the node, which closes after them.
    connection.link.listen(None);
    served?;
    connection.close();
    Ok(())
}

/// Ends the process when the coordinator is dead, whatever is waited for, until the run is finished.
fn follow(
    is_alive: impl Fn() -> bool + Send + 'static,
    membership: Membership,
    finished: Arc<Mutex<bool>>,
) -> JoinHandle<()> {
    std::thread::spawn(move || {
        while is_alive() {
            std::thread::sleep(LOOK);
        }
        // Held until the process ends: the run is not finished meanwhile.
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

    /// For a run that is not finished this would end the process of the test.
    #[test]
    fn a_coordinator_that_ends_after_the_run_is_no_fault() {
        let finished = Arc::new(Mutex::new(true));
        follow(|| false, Membership::default(), finished).join().unwrap();
    }
}
