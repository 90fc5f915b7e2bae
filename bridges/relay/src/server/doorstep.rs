//! Callers that have not yet proven the key. Their number, also per address, and their time are
//! limited.
//!
//! If there is no room, the caller that has waited longest is dropped. An honest caller proves the
//! key within a round trip, so that idle callers cannot keep others out.

use std::collections::VecDeque;
use std::net::{IpAddr, Shutdown, TcpStream};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Maximum wait for the proof.
pub(super) const PATIENCE: Duration = Duration::from_secs(5);
/// Maximum number of waiting callers, in total and from one address.
const MOST: usize = 64;
const MOST_OF_ONE: usize = 16;

/// Waiting callers, longest wait first.
#[derive(Clone, Default)]
pub(super) struct Doorstep(Arc<Mutex<Callers>>);

#[derive(Default)]
struct Callers {
    waiting: VecDeque<Caller>,
    /// Number of callers so far.
    count: u64,
}

struct Caller {
    address: IpAddr,
    stream: TcpStream,
    number: u64,
}

/// Place of a waiting caller, freed on drop.
pub(super) struct Waiting {
    doorstep: Doorstep,
    number: u64,
}

impl Doorstep {
    /// Adds a caller; `None` if it has already disconnected.
    pub(super) fn enter(&self, stream: &TcpStream) -> Option<Waiting> {
        let address = stream.peer_addr().ok()?.ip();
        let stream = stream.try_clone().ok()?;
        let mut callers = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let Callers { waiting, count } = &mut *callers;
        let of_one = |caller: &Caller| caller.address == address;
        let leaves = match waiting.iter().filter(|caller| of_one(caller)).count() {
            MOST_OF_ONE.. => waiting.iter().position(of_one),
            _ => (waiting.len() >= MOST).then_some(0),
        };
        if let Some(gone) = leaves.and_then(|at| waiting.remove(at)) {
            let _ = gone.stream.shutdown(Shutdown::Both);
        }
        *count += 1;
        waiting.push_back(Caller { address, stream, number: *count });
        Some(Waiting { doorstep: self.clone(), number: *count })
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        let mut callers = self.doorstep.0.lock().unwrap_or_else(PoisonError::into_inner);
        callers.waiting.retain(|caller| caller.number != self.number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;
    use std::net::TcpListener;

    #[test]
    fn the_oldest_of_an_address_has_to_go() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let call = || {
            let caller = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
            (caller, listener.accept().unwrap().0)
        };
        let doorstep = Doorstep::default();
        let count = || doorstep.0.lock().unwrap().waiting.len();
        let mut waiting = Vec::new();
        for _ in 0..=MOST_OF_ONE {
            let (caller, stream) = call();
            waiting.push((doorstep.enter(&stream).unwrap(), caller, stream));
        }
        assert_eq!(count(), MOST_OF_ONE);
        let (_, first, _) = &mut waiting[0];
        assert_eq!(first.read(&mut [0]).unwrap(), 0, "its connection is closed");
        waiting[1].1.set_nonblocking(true).unwrap();
        assert!(waiting[1].1.read(&mut [0]).is_err(), "the next one's is open");
        waiting.clear();
        assert_eq!(count(), 0);
    }
}
