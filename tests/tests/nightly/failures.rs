//! A failing participant's message is never replaced by a report of a lost message, under any load.

use tests::harness::failures::failures_keep_their_words;

/// Default number of runs.
const STARTS: u64 = 1000;

/// Three threads per core keep the processors busy. `COSIM_FAILING_STARTS` sets the number of runs.
#[test]
fn failures_keep_their_words_under_load() {
    let named = std::env::var("COSIM_FAILING_STARTS").ok();
    let starts = named.map_or(STARTS, |text| text.parse().expect("a number of runs"));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    failures_keep_their_words(starts, 3 * cores);
}
