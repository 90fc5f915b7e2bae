//! The coupling state as bytes: little-endian numbers, vectors with their length before them.

/// A state that does not fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the coupling state does not fit: {0}")]
pub struct StateMismatch(pub &'static str);

/// Reads what was written, in the same order.
#[derive(Clone, Copy, Debug)]
pub struct Reader<'a>(pub &'a [u8]);

impl Reader<'_> {
    /// The next whole number.
    ///
    /// # Errors
    /// There are no more bytes.
    pub fn u64(&mut self) -> Result<u64, StateMismatch> {
        let (head, rest) =
            self.0.split_first_chunk().ok_or(StateMismatch("it ends before its end"))?;
        self.0 = rest;
        Ok(u64::from_le_bytes(*head))
    }

    /// The next number.
    ///
    /// # Errors
    /// There are no more bytes.
    pub fn f64(&mut self) -> Result<f64, StateMismatch> {
        self.u64().map(f64::from_bits)
    }

    /// The next vector, which has to have the length of `values`.
    ///
    /// # Errors
    /// It has another length, or there are no more bytes.
    pub fn f64s(&mut self, values: &mut [f64]) -> Result<(), StateMismatch> {
        if self.u64()? != values.len() as u64 {
            return Err(StateMismatch("a vector has another length"));
        }
        values.iter_mut().try_for_each(|value| {
            *value = self.f64()?;
            Ok(())
        })
    }
}

/// Writes a vector, its length before it.
pub fn put_f64s(into: &mut Vec<u8>, values: &[f64]) {
    into.extend((values.len() as u64).to_le_bytes());
    into.extend(values.iter().flat_map(|value| value.to_le_bytes()));
}
