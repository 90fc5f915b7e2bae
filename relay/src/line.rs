//! A conversation with the other end once both have shown that they have the key: messages of any length, in
//! pieces that are sealed, and signs of life beside them.
//!
//! A piece has its number in the clear, and one byte that says whether it is the last of its message. What does
//! not open is not from the other end, and is left out. On the lane of messages the numbers count up by one.

use crate::fabric::{Hold, LANES, Lane};
use crate::frame::{Frame, Malformed};
use crate::seal::{Seal, TAG};
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Bytes of a message in one piece.
const PIECE: usize = 256 << 10;
/// What stands before the sealed part: the number.
const NUMBER: usize = 8;
/// What a message may be, before there are fields.
pub(crate) const SHORT: usize = 256 << 20;

/// The lane of messages, and that of signs of life.
const MESSAGES: usize = 0;
const LIFE: usize = 1;

/// Why there is no message.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Fault {
    #[error("{0}")]
    Network(#[from] crate::fabric::FabricError),
    #[error(transparent)]
    Malformed(#[from] Malformed),
    #[error("a piece of a message was lost: number {found} came instead of {expected}")]
    Missing { found: u64, expected: u64 },
    #[error("the other end sends more than {most} bytes at once")]
    TooLong { most: usize },
}

/// Sends; any thread may.
pub(crate) struct Sending {
    seal: Seal,
    lanes: [Mutex<(u64, Lane)>; LANES],
}

impl Sending {
    pub(crate) fn new(seal: Seal, lanes: [Lane; LANES]) -> Self {
        Self { seal, lanes: lanes.map(|lane| Mutex::new((0, lane))) }
    }

    /// Sends a message.
    pub(crate) fn send(&self, frame: &Frame<'_>) -> Result<(), Fault> {
        self.on(MESSAGES, frame)
    }

    /// Sends a sign of life.
    pub(crate) fn sign(&self, frame: &Frame<'_>) -> Result<(), Fault> {
        self.on(LIFE, frame)
    }

    fn on(&self, lane: usize, frame: &Frame<'_>) -> Result<(), Fault> {
        let (head, rest) = frame.write();
        let (mut head, mut rest) = (&head[..], rest);
        let mut sending = self.lanes[lane].lock().unwrap_or_else(PoisonError::into_inner);
        let (number, way) = &mut *sending;
        loop {
            *number += 1;
            let from_head = head.len().min(PIECE);
            let from_rest = rest.len().min(PIECE - from_head);
            let is_last = from_head == head.len() && from_rest == rest.len();
            let mut piece = Vec::with_capacity(NUMBER + 1 + from_head + from_rest + TAG);
            piece.extend(number.to_le_bytes());
            piece.push(is_last.into());
            piece.extend(&head[..from_head]);
            piece.extend(&rest[..from_rest]);
            (head, rest) = (&head[from_head..], &rest[from_rest..]);
            self.seal.close(lane as u8, *number, &mut piece, NUMBER);
            way.send(piece)?;
            if is_last {
                return Ok(());
            }
        }
    }
}

/// Receives on one lane.
pub(crate) struct Incoming {
    lane: usize,
    seal: std::sync::Arc<Seal>,
    arrivals: Receiver<Vec<u8>>,
    number: u64,
    message: Vec<u8>,
    /// The longest message that is put together [byte].
    pub(crate) most: usize,
}

impl Incoming {
    /// Both lanes: of messages, and of signs of life.
    pub(crate) fn both(seal: Seal, arrivals: [Receiver<Vec<u8>>; LANES]) -> [Self; LANES] {
        let (seal, mut lane) = (std::sync::Arc::new(seal), 0..);
        arrivals.map(|arrivals| Self {
            lane: lane.next().expect("there is no end of numbers"),
            seal: std::sync::Arc::clone(&seal),
            arrivals,
            number: 0,
            message: Vec::new(),
            most: SHORT,
        })
    }

    /// The next message, if it is all there.
    pub(crate) fn poll(&mut self) -> Result<Option<Vec<u8>>, Fault> {
        loop {
            match self.arrivals.try_recv() {
                Ok(piece) => {
                    if let Some(message) = self.take(piece)? {
                        return Ok(Some(message));
                    }
                }
                Err(TryRecvError::Empty | TryRecvError::Disconnected) => return Ok(None),
            }
        }
    }

    /// The next message, if it is all there before so much time has passed without a piece of it.
    pub(crate) fn within(&mut self, patience: Duration) -> Result<Option<Vec<u8>>, Fault> {
        loop {
            match self.arrivals.recv_timeout(patience) {
                Ok(piece) => {
                    if let Some(message) = self.take(piece)? {
                        return Ok(Some(message));
                    }
                }
                Err(RecvTimeoutError::Timeout) => return Ok(None),
                Err(RecvTimeoutError::Disconnected) => {
                    std::thread::sleep(patience);
                    return Ok(None);
                }
            }
        }
    }

    /// A piece has come; the message of which it is the last.
    fn take(&mut self, mut piece: Vec<u8>) -> Result<Option<Vec<u8>>, Fault> {
        let Some((number, sealed)) = piece.split_first_chunk_mut::<NUMBER>() else {
            return Ok(None);
        };
        let number = u64::from_le_bytes(*number);
        // One that has been here before does not count again.
        if number <= self.number {
            return Ok(None);
        }
        let Some([is_last, content @ ..]) = self.seal.open(self.lane as u8, number, sealed) else {
            return Ok(None);
        };
        if self.lane == MESSAGES && number != self.number + 1 {
            return Err(Fault::Missing { found: number, expected: self.number + 1 });
        }
        self.number = number;
        if self.message.len() + content.len() > self.most {
            return Err(Fault::TooLong { most: self.most });
        }
        self.message.extend_from_slice(content);
        Ok((*is_last != 0).then(|| std::mem::take(&mut self.message)))
    }
}

/// A conversation.
pub(crate) struct Line {
    pub(crate) sending: std::sync::Arc<Sending>,
    pub(crate) messages: Incoming,
    pub(crate) life: Incoming,
    pub(crate) hold: Hold,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::key::Key;
    use crate::seal::Drawn;
    use proptest::prelude::*;
    use std::sync::mpsc::{SyncSender, sync_channel};

    /// A seal, what arrives, and where it is received.
    fn line() -> (Seal, SyncSender<Vec<u8>>, Incoming) {
        let drawn = Drawn { home: [1; 32], far: [2; 32] };
        let seals = || Seal::both(&Key::of(&[3; 32]), &drawn).0;
        let ((sender, arrivals), (_, life)) = (sync_channel(64), sync_channel(1));
        let [messages, _] = Incoming::both(seals(), [arrivals, life]);
        (seals(), sender, messages)
    }

    fn piece(seal: &Seal, number: u64, is_last: bool, content: &[u8]) -> Vec<u8> {
        let mut piece = [&number.to_le_bytes()[..], &[is_last.into()], content].concat();
        seal.close(MESSAGES as u8, number, &mut piece, NUMBER);
        piece
    }

    #[test]
    fn pieces_make_messages_and_what_is_not_of_the_other_end_is_left_out() {
        let (seal, arrives, mut incoming) = line();
        let first = piece(&seal, 1, false, b"one ");
        for piece in
            [first.clone(), b"?".to_vec(), vec![0xff; 100], first, piece(&seal, 2, true, b"two")]
        {
            arrives.send(piece).unwrap();
        }
        assert_eq!(incoming.poll().unwrap().unwrap(), b"one two");
        assert!(incoming.poll().unwrap().is_none());
    }

    #[test]
    fn a_piece_that_is_missing_and_a_message_without_end_are_named() {
        let (seal, arrives, mut incoming) = line();
        arrives.send(piece(&seal, 2, true, b"two")).unwrap();
        let fault = incoming.poll().unwrap_err().to_string();
        assert_eq!(fault, "a piece of a message was lost: number 2 came instead of 1");
        let (seal, arrives, mut incoming) = line();
        incoming.most = 1000;
        for number in 1..12 {
            arrives.send(piece(&seal, number, false, &[0; 100])).unwrap();
        }
        let fault = incoming.poll().unwrap_err().to_string();
        assert_eq!(fault, "the other end sends more than 1000 bytes at once");
    }

    proptest! {
        #![proptest_config(crate::fuzz_config())]

        #[test]
        fn no_bytes_pass_without_the_key(pieces in proptest::collection::vec(proptest::collection::vec(any::<u8>(), 0..100), 0..20)) {
            let (_, arrives, mut incoming) = line();
            for piece in pieces {
                arrives.send(piece).unwrap();
            }
            prop_assert!(incoming.poll().unwrap().is_none());
        }
    }
}
