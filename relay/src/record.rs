//! Sealed records, of which a link is made: a length (u16, little-endian) and as many sealed bytes, numbered
//! from 0 in each direction. What was changed, repeated or left out does not open.

use snow::StatelessTransportState;
use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::Instant;

/// The longest record (Noise, revision 34, 3), and the bytes of it that are a message's.
pub(crate) const RECORD: usize = 65_535;
pub(crate) const PIECE: usize = RECORD - TAG - 1;
pub(crate) const TAG: usize = 16;
/// What a record is: a piece of a message, its last one, or a sign of life.
pub(crate) const MORE: u8 = 0;
pub(crate) const LAST: u8 = 1;
pub(crate) const SIGN: u8 = 2;

/// A connection whose ends have shaken hands.
pub(crate) struct Sealed {
    pub(crate) stream: TcpStream,
    pub(crate) noise: StatelessTransportState,
}

/// Why a caller is not let in.
pub(crate) enum Unproven {
    Late(io::Error),
    Wrong,
}

impl Sealed {
    pub(crate) fn new(stream: TcpStream, noise: StatelessTransportState) -> Self {
        Self { stream, noise }
    }

    /// Sends the first record, which only an end with the key can.
    pub(crate) fn prove(&self) -> io::Result<()> {
        let mut records = Vec::new();
        seal(&self.noise, 0, &[SIGN], &mut records);
        (&self.stream).write_all(&records)
    }

    /// Takes the first record of a caller.
    pub(crate) fn proven(&self, until: Instant) -> Result<(), Unproven> {
        let (mut length, mut record) = ([0; 2], [0; TAG + 1]);
        read_by(&self.stream, &mut length, until).map_err(Unproven::Late)?;
        if usize::from(u16::from_le_bytes(length)) != record.len() {
            return Err(Unproven::Wrong);
        }
        read_by(&self.stream, &mut record, until).map_err(Unproven::Late)?;
        let mut said = [0; 1];
        match self.noise.read_message(0, &record, &mut said) {
            Ok(1) if said == [SIGN] => Ok(()),
            _ => Err(Unproven::Wrong),
        }
    }
}

/// Appends a sealed record.
pub(crate) fn seal(noise: &StatelessTransportState, number: u64, plain: &[u8], into: &mut Vec<u8>) {
    let (from, length) = (into.len(), plain.len() + TAG);
    into.extend((length as u16).to_le_bytes());
    into.resize(from + 2 + length, 0);
    let sealed = noise.write_message(number, plain, &mut into[from + 2..]);
    assert_eq!(sealed.ok(), Some(length), "a piece fits into a record");
}

/// Reads what must have come by then.
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
