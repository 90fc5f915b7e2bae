//! Pieces of a state, little-endian, on their way to and from a file.

use std::io::{self, Read, Write};

/// Writes numbers one after the other.
///
/// # Errors
/// Those of `into`.
pub fn write_numbers<'a>(
    into: &mut dyn Write,
    numbers: impl IntoIterator<Item = &'a f64>,
) -> io::Result<()> {
    numbers.into_iter().try_for_each(|number| into.write_all(&number.to_le_bytes()))
}

/// Reads numbers that [`write_numbers`] wrote, as many as there are places.
///
/// # Errors
/// Those of `from`, which may end too early.
pub fn read_numbers<'a>(
    from: &mut dyn Read,
    numbers: impl IntoIterator<Item = &'a mut f64>,
) -> io::Result<()> {
    numbers.into_iter().try_for_each(|number| {
        *number = f64::from_le_bytes(read_bytes(from)?);
        Ok(())
    })
}

/// The next bytes.
///
/// # Errors
/// Those of `from`, which may end too early.
pub fn read_bytes<const N: usize>(from: &mut dyn Read) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    from.read_exact(&mut bytes)?;
    Ok(bytes)
}
