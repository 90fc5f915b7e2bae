//! Participants and recordings: a participant put through the whole contract ([`conform`]) or through
//! a recording ([`replay`]); a recording looked at ([`inspect`]) and written for other tools
//! ([`export`]).

pub mod conform;
pub mod export;
pub mod inspect;
pub mod replay;

/// Cases of the tests over arbitrary bytes: a few hundred, or as many as `FUZZ_CASES` says.
#[cfg(test)]
fn fuzz_config() -> proptest::test_runner::Config {
    let cases = std::env::var("FUZZ_CASES").ok().and_then(|text| text.parse().ok());
    proptest::test_runner::Config::with_cases(cases.unwrap_or(400))
}
