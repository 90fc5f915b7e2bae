//! Tools for participants and recordings. Checks of a participant against the whole contract
//! ([`conform`]) or a recording ([`replay`]); inspection and comparison ([`inspect`]) and export
//! ([`export`]) of recordings.

#![forbid(unsafe_code)]

pub mod conform;
pub mod export;
pub mod inspect;
pub mod recording_file;
pub mod replay;

/// Returns the settings of tests over arbitrary bytes: 400 cases, or the number in `FUZZ_CASES`.
#[cfg(test)]
fn fuzz_config() -> proptest::test_runner::Config {
    let cases = std::env::var("FUZZ_CASES").ok().and_then(|text| text.parse().ok());
    proptest::test_runner::Config::with_cases(cases.unwrap_or(400))
}
