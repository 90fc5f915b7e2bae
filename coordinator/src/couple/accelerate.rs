//! The next iterate of the fields that close a loop.

/// Chooses the next iterate. Sees slices only: one vector of everything that is fed back.
pub trait Accelerator {
    /// `sent` went into this iteration, `returned` came out of it; both have the same length. On
    /// return `sent` holds what goes into the next iteration.
    fn next(&mut self, sent: &mut [f64], returned: &[f64]);

    /// The window is done; what was learned may serve the next one.
    fn accept_window(&mut self);
}

/// What came out goes in.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unaccelerated;

impl Accelerator for Unaccelerated {
    fn next(&mut self, sent: &mut [f64], returned: &[f64]) {
        sent.copy_from_slice(returned);
    }

    fn accept_window(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unaccelerated_passes_on_what_came_back() {
        let mut sent = [1.0, 2.0];
        Unaccelerated.next(&mut sent, &[3.0, 4.0]);
        assert_eq!(sent, [3.0, 4.0]);
    }
}
