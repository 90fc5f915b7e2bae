//! Writes and reads parts of a state as little-endian bytes.

use std::io::{self, Read, Write};

/// Writes numbers in sequence.
///
/// # Errors
/// Fails if writing to `into` fails.
pub fn write_numbers<'a>(
    into: &mut dyn Write,
    numbers: impl IntoIterator<Item = &'a f64>,
) -> io::Result<()> {
    numbers.into_iter().try_for_each(|number| into.write_all(&number.to_le_bytes()))
}

/// Reads numbers written by [`write_numbers`], as many as `numbers` has places.
///
/// # Errors
/// Fails if reading from `from` fails or `from` ends too early.
pub fn read_numbers<'a>(
    from: &mut dyn Read,
    numbers: impl IntoIterator<Item = &'a mut f64>,
) -> io::Result<()> {
    numbers.into_iter().try_for_each(|number| {
        *number = f64::from_le_bytes(read_bytes(from)?);
        Ok(())
    })
}

/// Reads the next `N` bytes.
///
/// # Errors
/// Fails if reading from `from` fails or `from` ends too early.
pub fn read_bytes<const N: usize>(from: &mut dyn Read) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    from.read_exact(&mut bytes)?;
    Ok(bytes)
}
