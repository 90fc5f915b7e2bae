//! Log filter from the directives of `RUST_LOG`.

use tracing_subscriber::filter::{LevelFilter, ParseError, Targets};

/// Returns the filter from `RUST_LOG`: directives `LEVEL`, `TARGET` and `TARGET=LEVEL`, separated
/// by commas. If the variable is empty or invalid, events of the level `default` are logged.
#[must_use]
pub fn wanted(default: LevelFilter) -> Targets {
    let directives = directives().and_then(Result::ok);
    directives.unwrap_or_else(|| Targets::new().with_default(default))
}

/// Explains why `RUST_LOG` is ignored, if it is.
#[must_use]
pub fn ignored() -> Option<String> {
    let error = directives()?.err()?;
    Some(format!("RUST_LOG is ignored: {error}; write LEVEL or TARGET=LEVEL, separated by commas"))
}

fn directives() -> Option<Result<Targets, String>> {
    let text = std::env::var("RUST_LOG").ok()?;
    (!text.trim().is_empty()).then(|| parse(&text))
}

fn parse(text: &str) -> Result<Targets, String> {
    // Otherwise such a directive would be parsed as a target name.
    if text.contains('[') {
        return Err("spans and fields are not filtered".to_owned());
    }
    text.parse().map_err(|error: ParseError| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directives_are_levels_targets_and_both() {
        let level = |text: &str, target: &str| {
            let targets = parse(text).unwrap();
            let levels = [LevelFilter::TRACE, LevelFilter::DEBUG, LevelFilter::INFO];
            let rank = |level: &LevelFilter| {
                level.into_level().is_some_and(|level| targets.would_enable(target, &level))
            };
            levels.into_iter().find(rank).unwrap_or(LevelFilter::OFF)
        };
        assert_eq!(level("debug", "proto::transport"), LevelFilter::DEBUG);
        assert_eq!(level("error,proto=debug", "proto::transport"), LevelFilter::DEBUG);
        assert_eq!(level("proto=debug", "coordinator"), LevelFilter::OFF);
        assert_eq!(level("proto", "proto::transport"), LevelFilter::TRACE);
        for wrong in ["proto[span]=debug", "proto=loud", "proto=info=debug"] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }
}
