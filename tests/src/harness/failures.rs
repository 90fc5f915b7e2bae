//! Repeated runs with a participant that fails while the other one is working.

use super::{Place, case, sets};

/// Starts `starts` runs in which one participant fails, at the start or in a window, while the
/// other one is working or has just replied; `busy` threads keep the processors busy. Asserts that
/// every run reports the message of the failed participant.
pub fn failures_keep_their_words(starts: u64, busy: usize) {
    let stop = std::sync::atomic::AtomicBool::new(false);
    std::thread::scope(|scope| {
        for _ in 0..busy {
            scope.spawn(|| {
                while !stop.load(std::sync::atomic::Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            });
        }
        let failed = std::panic::catch_unwind(|| (0..starts).for_each(fail));
        stop.store(true, std::sync::atomic::Ordering::Relaxed);
        if let Err(panic) = failed {
            std::panic::resume_unwind(panic);
        }
    });
}

/// Performs the run with this number, which determines the failing participant, the time of the
/// failure, and the time for which the other one works.
fn fail(number: u64) {
    let (failing, working) =
        if number.is_multiple_of(2) { ("right", "left") } else { ("left", "right") };
    let (window, milliseconds) = (number / 2 % 4, [0, 1, 30][(number / 8 % 3) as usize]);
    let at_start = number % 16 >= 14;
    let fault = match at_start {
        true => format!("{failing}.fault=refuse-build"),
        false => format!("{failing}.fault=error"),
    };
    let settings = [
        "coupling.scheme=parallel-explicit".to_owned(),
        fault,
        format!("{failing}.fault_window={window}"),
        format!("{working}.delay={}", 1e-3 * f64::from(milliseconds)),
        format!("{working}.build_delay={}", 1e-3 * f64::from(milliseconds)),
    ];
    let settings: Vec<&str> = settings.iter().map(String::as_str).collect();
    let place = Place::new();
    let ended = place.run(&case("exchange.toml"), &sets(&settings));
    let (code, words) = match at_start {
        true => (2, "cannot be built".to_owned()),
        false => (1, format!("{failing} (toy) failed in window {window}, iteration 1: ")),
    };
    let told = ended.stderr.contains(&words);
    let told = told && (at_start || ended.stderr.contains("told to fail"));
    assert!(ended.code == Some(code) && told, "run {number}: {:?} {}", ended.code, ended.stderr);
    place.assert_nothing_left();
}
