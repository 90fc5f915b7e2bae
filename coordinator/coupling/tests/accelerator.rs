//! Bit-identical iterates of long vectors: for any number of threads, and after a restart.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use coupling::StateReader;
use coupling::accelerate::{Accelerator, build};
use coupling::settings::{Acceleration, Implicit};
use coupling::{Part, parts};

/// Iterations of a window.
const ITERATIONS: usize = 6;

/// Two fields of several blocks; the ends do not fill a register.
fn fields(length: usize) -> Vec<Part> {
    parts([("u", length / 3), ("v", length - length / 3)])
}

fn accelerator(acceleration: Acceleration, length: usize, threads: usize) -> Box<dyn Accelerator> {
    let settings = Implicit { acceleration, threads, max_columns: 12, ..Implicit::default() };
    build(&settings, &fields(length))
}

/// Returns the last iterates of some windows of x ↦ Λx + b, with another b in each.
fn iterates(
    accelerator: &mut dyn Accelerator,
    length: usize,
    windows: std::ops::Range<usize>,
) -> Vec<Vec<u64>> {
    let solve = |window: usize| {
        let part = |i: usize, of: usize| (i % of) as f64 / of as f64;
        let (mut sent, mut returned) = (vec![0.0; length], vec![0.0; length]);
        accelerator.begin_window();
        for iteration in 1..=ITERATIONS {
            for (i, (returned, sent)) in returned.iter_mut().zip(&sent).enumerate() {
                *returned = 0.9 * part(i, 1009) * sent + part(i * (2 * window + 3), 997);
            }
            if iteration < ITERATIONS {
                accelerator.next(&mut sent, &returned);
            } else {
                accelerator.accept_window(&sent, &returned);
            }
        }
        sent.iter().map(|value| value.to_bits()).collect()
    };
    windows.map(solve).collect()
}

/// The length makes twelve columns worth two threads, in both passes of an iteration.
#[test]
fn threads_change_no_iterate() {
    let length = 700_001;
    for kind in [Acceleration::IqnIls, Acceleration::IqnImvj] {
        let one = iterates(&mut *accelerator(kind, length, 1), length, 0..3);
        let two = iterates(&mut *accelerator(kind, length, 2), length, 0..3);
        assert!(one == two, "{}", kind.word());
    }
}

/// The state is saved while the last column of a window still lacks its inner products.
#[test]
fn a_restart_changes_no_iterate() {
    let length = 20_003;
    for kind in [Acceleration::Anderson, Acceleration::IqnIls, Acceleration::IqnImvj] {
        let expected = iterates(&mut *accelerator(kind, length, 1), length, 0..5);
        let (mut before, mut after) = (accelerator(kind, length, 1), accelerator(kind, length, 1));
        iterates(&mut *before, length, 0..3);
        let mut state = Vec::new();
        before.save(&mut state);
        after.restore(&mut StateReader(&state)).unwrap();
        assert!(iterates(&mut *after, length, 3..5) == expected[3..], "{}", kind.word());
        // Saving a state does not change the iterates either.
        assert!(iterates(&mut *before, length, 3..5) == expected[3..], "{}", kind.word());
    }
}
