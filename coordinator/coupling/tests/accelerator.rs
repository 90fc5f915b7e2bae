//! The iterates of long vectors, to the bit: whatever the number of threads, and after a restart.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use coupling::accelerate::{Accelerator, build};
use coupling::settings::{Acceleration, Implicit};
use coupling::state::Reader;
use coupling::{Part, parts};

/// Windows, and the iterations of each.
const WINDOWS: usize = 5;
const ITERATIONS: usize = 6;

/// Two fields of several blocks, of which the ends do not fill any register.
fn fields() -> Vec<Part> {
    parts([("u", 40_003), ("v", 21_001)])
}

fn accelerator(acceleration: Acceleration, threads: usize) -> Box<dyn Accelerator> {
    let settings = Implicit { acceleration, threads, max_columns: 12, ..Implicit::default() };
    build(&settings, &fields())
}

/// The last iterates of some windows of x ↦ Λx + b, with another b in each.
fn iterates(accelerator: &mut dyn Accelerator, windows: std::ops::Range<usize>) -> Vec<Vec<u64>> {
    let length = fields()[1].range.end;
    let solve = |window: usize| {
        let right = |i: usize| ((i * (2 * window + 3)) as f64).sin();
        let (mut sent, mut returned) = (vec![0.0; length], vec![0.0; length]);
        accelerator.begin_window();
        for iteration in 1..=ITERATIONS {
            for (i, (returned, sent)) in returned.iter_mut().zip(&sent).enumerate() {
                *returned = 0.9 * (i as f64).cos() * sent + right(i);
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

const KINDS: [Acceleration; 3] =
    [Acceleration::Anderson, Acceleration::IqnIls, Acceleration::IqnImvj];

#[test]
fn threads_change_no_iterate() {
    for kind in KINDS {
        let one = iterates(&mut *accelerator(kind, 1), 0..WINDOWS);
        for threads in [2, 3] {
            let several = iterates(&mut *accelerator(kind, threads), 0..WINDOWS);
            assert!(one == several, "{}, {threads} threads", kind.word());
        }
    }
}

/// The last column of a window has met no other one when the state is saved.
#[test]
fn a_restart_changes_no_iterate() {
    for kind in KINDS {
        let mut whole = accelerator(kind, 1);
        let expected = iterates(&mut *whole, 0..WINDOWS);
        let (mut before, mut after) = (accelerator(kind, 2), accelerator(kind, 1));
        iterates(&mut *before, 0..3);
        let mut state = Vec::new();
        before.save(&mut state);
        after.restore(&mut Reader(&state)).unwrap();
        assert!(iterates(&mut *after, 3..WINDOWS) == expected[3..], "{}", kind.word());
        // That a state was saved changes nothing either.
        assert!(iterates(&mut *before, 3..WINDOWS) == expected[3..], "{}", kind.word());
    }
}
