//! Stated errors of many random contacts.

use tests::harness::coverage::cover;

/// Stated errors of 200 random contacts cover the true ones in 95 of 100. Errors that change sign
/// at random are less than a tenth of such a bound in 16 of 100; 45 are accepted, since errors of
/// three grids hardly show their size.
///
/// The table of docs/theory/accuracy.md: `cargo test --release --workspace --test nightly --
/// coverage --nocapture`.
#[test]
fn stated_errors_cover_the_true_ones() {
    for coverage in cover(200, &[20, 40], 80) {
        println!("{coverage:?}");
        assert!(100 * coverage.covered >= 95 * coverage.cases, "{coverage:?}");
        assert!(100 * coverage.too_large <= 45 * coverage.cases, "{coverage:?}");
    }
}
