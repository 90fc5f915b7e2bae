//! Checks that the header under version control is up to date with the sources.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;

#[test]
fn the_header_is_the_sources() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).unwrap();
    let mut written = Vec::new();
    let builder = cbindgen::Builder::new().with_config(config).with_src(root.join("src/lib.rs"));
    builder.generate().unwrap().write(&mut written);
    let path = root.join("include/cosim.h");
    if std::env::var_os("COSIM_HEADER").is_some_and(|word| word == "write") {
        std::fs::write(&path, &written).unwrap();
    }
    let found = std::fs::read(&path).unwrap_or_default();
    assert!(
        found == written,
        "include/cosim.h is stale: COSIM_HEADER=write cargo test -p cosim-c --test header"
    );
}
