//! Encrypted records of a link: a length (u16, little-endian), a kind, and `length` encrypted
//! bytes.
//!
//! The nonce contains the kind of the record and its number in its direction, from 0. A record that
//! was changed, repeated or dropped fails to decrypt.

use snow::StatelessTransportState;
use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::Instant;

/// Maximum length of an encrypted record (Noise, revision 34, 3), and the part available for a
/// message.
const SEALED: usize = 65_535;
pub(crate) const PIECE: usize = SEALED - TAG;
const TAG: usize = 16;
/// Bytes of length and kind, ahead of the encrypted bytes.
const HEADER: usize = 3;
/// Maximum bytes of a record.
pub(crate) const RECORD: usize = HEADER + SEALED;
/// Number of records that fit into the buffer of a reader.
const BATCH: usize = 4;

/// Kind of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Kind {
    /// Piece of a message.
    More = 0,
    /// Last piece of a message.
    Last = 1,
    /// Sign of life.
    Sign = 2,
}

impl Kind {
    fn from_number(number: u8) -> Option<Self> {
        [Self::More, Self::Last, Self::Sign].into_iter().find(|kind| *kind as u8 == number)
    }

    fn nonce(self, number: u64) -> u64 {
        4 * number + self as u64
    }
}

/// Connection after the handshake.
pub(crate) struct Sealed {
    pub(crate) stream: TcpStream,
    pub(crate) noise: StatelessTransportState,
}

/// Reason why a caller is not accepted.
pub(crate) enum Unproven {
    Late(io::Error),
    Wrong,
}

impl Sealed {
    pub(crate) fn new(stream: TcpStream, noise: StatelessTransportState) -> Self {
        Self { stream, noise }
    }

    /// Sends the first record, which requires the key.
    pub(crate) fn prove(&self) -> io::Result<()> {
        let mut records = Vec::new();
        seal(&self.noise, 0, Kind::Sign, &[], &mut records);
        (&self.stream).write_all(&records)
    }

    /// Reads and checks the first record of a caller.
    pub(crate) fn proven(&self, until: Instant) -> Result<(), Unproven> {
        let mut record = [0; HEADER + TAG];
        read_by(&self.stream, &mut record, until).map_err(Unproven::Late)?;
        let proof = self.noise.read_message(Kind::Sign.nonce(0), &record[HEADER..], &mut []);
        proof.map(|_| ()).map_err(|_| Unproven::Wrong)
    }
}

/// Appends a sealed record to `into`.
pub(crate) fn seal(
    noise: &StatelessTransportState,
    number: u64,
    kind: Kind,
    piece: &[u8],
    into: &mut Vec<u8>,
) {
    let (from, length) = (into.len() + HEADER, piece.len() + TAG);
    into.extend((length as u16).to_le_bytes());
    into.push(kind as u8);
    into.resize(from + length, 0);
    let sealed = noise.write_message(kind.nonce(number), piece, &mut into[from..]);
    assert_eq!(sealed.ok(), Some(length), "a piece fits into a record");
}

/// Reader of records from a stream.
pub(crate) struct Records<R> {
    stream: R,
    number: u64,
    /// Buffer of received bytes; those from `start` to `end` are not yet decrypted.
    bytes: Vec<u8>,
    start: usize,
    end: usize,
}

/// Reason why the next record cannot be read.
pub(crate) enum NoRecord {
    Network(io::Error),
    /// The record was not sealed by the other end, or is out of order.
    Wrong,
}

impl<R: Read> Records<R> {
    /// Creates a reader; `number` is the number of the first record.
    pub(crate) fn new(stream: R, number: u64) -> Self {
        Self { stream, number, bytes: vec![0; BATCH * RECORD], start: 0, end: 0 }
    }

    /// Appends the decrypted content of the next record to `into`.
    pub(crate) fn open(
        &mut self,
        noise: &StatelessTransportState,
        into: &mut Vec<u8>,
    ) -> Result<Kind, NoRecord> {
        self.fill(HEADER)?;
        let [low, high, kind] = self.bytes[self.start..][..HEADER] else { unreachable!() };
        let length = usize::from(u16::from_le_bytes([low, high]));
        self.fill(HEADER + length)?;
        let kind = Kind::from_number(kind).ok_or(NoRecord::Wrong)?;
        let record = &self.bytes[self.start + HEADER..][..length];
        let at = into.len();
        // Room for the tag lets the record be decrypted in place.
        into.resize(at + length, 0);
        let opened = noise.read_message(kind.nonce(self.number), record, &mut into[at..]);
        into.truncate(at + opened.map_err(|_| NoRecord::Wrong)?);
        self.number += 1;
        self.start += HEADER + length;
        Ok(kind)
    }

    /// Reads until `count` bytes are available.
    fn fill(&mut self, count: usize) -> Result<(), NoRecord> {
        if self.start + count > self.bytes.len() {
            self.bytes.copy_within(self.start..self.end, 0);
            (self.start, self.end) = (0, self.end - self.start);
        }
        while self.end - self.start < count {
            match self.stream.read(&mut self.bytes[self.end..]) {
                Ok(0) => return Err(NoRecord::Network(io::ErrorKind::UnexpectedEof.into())),
                Ok(read) => self.end += read,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(NoRecord::Network(error)),
            }
        }
        Ok(())
    }
}

/// Fills `bytes`; fails if they do not arrive before `until`.
pub(crate) fn read_by(
    mut stream: &TcpStream,
    bytes: &mut [u8],
    until: Instant,
) -> Result<(), io::Error> {
    let mut read = 0;
    while read < bytes.len() {
        let left = until.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        stream.set_read_timeout(Some(left))?;
        match stream.read(&mut bytes[read..]) {
            Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(count) => read += count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
            Err(error) => return Err(error),
        }
    }
    stream.set_read_timeout(None)
}
