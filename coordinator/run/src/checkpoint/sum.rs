//! CRC-64/XZ: reflected, polynomial 0x42F0E1EBA9EA3693 (ECMA-182), all ones before and after. It
//! tells a truncated or damaged file from a whole one; it is no protection against forgery.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Bytes of a stream that are looked at together.
const PIECE: usize = 1 << 16;

/// The polynomial, reflected.
const POLYNOMIAL: u64 = 0xC96C_5795_D787_0F42;

/// The remainders of all bytes.
const TABLE: [u64; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut remainder = byte as u64;
        let mut bit = 0;
        while bit < 8 {
            let carry = remainder & 1;
            remainder >>= 1;
            if carry == 1 {
                remainder ^= POLYNOMIAL;
            }
            bit += 1;
        }
        table[byte] = remainder;
        byte += 1;
    }
    table
};

/// The CRC-64 of some bytes.
#[must_use]
pub fn sum(bytes: &[u8]) -> u64 {
    !further(!0, bytes)
}

/// The CRC-64 of a file.
///
/// # Errors
/// It is no file, or cannot be read.
pub fn sum_of_file(path: &Path) -> io::Result<u64> {
    // Before it is opened: a pipe would wait for a writer.
    if !path.metadata()?.is_file() {
        return Err(io::Error::other("is no file"));
    }
    of_stream(File::open(path)?).map(|(_, sum)| sum)
}

/// Length and CRC-64 of a stream, of which only a piece is in memory at a time.
///
/// # Errors
/// Those of `from`.
pub(super) fn of_stream(mut from: impl Read) -> io::Result<(u64, u64)> {
    let (mut length, mut remainder, mut piece) = (0, !0, vec![0; PIECE]);
    loop {
        match from.read(&mut piece) {
            Ok(0) => return Ok((length, !remainder)),
            Ok(count) => {
                length += count as u64;
                remainder = further(remainder, &piece[..count]);
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

fn further(remainder: u64, bytes: &[u8]) -> u64 {
    let step = |sum: u64, byte: &u8| TABLE[(sum as u8 ^ byte) as usize] ^ (sum >> 8);
    bytes.iter().fold(remainder, step)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value of the catalogue of parametrised CRC algorithms.
    #[test]
    fn the_standard_check_value() {
        assert_eq!(sum(b"123456789"), 0x995D_C9BB_DF19_39FA);
        assert_eq!(sum(b""), 0);
    }

    #[test]
    fn a_stream_has_the_sum_of_its_bytes() {
        let bytes: Vec<u8> = (0..3 * PIECE + 7).map(|i| (i * i) as u8).collect();
        assert_eq!(of_stream(bytes.as_slice()).unwrap(), (bytes.len() as u64, sum(&bytes)));
    }
}
