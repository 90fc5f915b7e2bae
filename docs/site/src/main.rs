//! Makes the documentation site in `target/site`, or in the folder that is named:
//! `cargo run --release --manifest-path docs/site/Cargo.toml`.

#![forbid(unsafe_code)]

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a command says how it ended")]

use std::path::{Path, PathBuf};
use std::process::ExitCode;

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut arguments = std::env::args_os().skip(1);
    let into = arguments.next().map_or_else(|| root.join("target/site"), PathBuf::from);
    if arguments.next().is_some() {
        eprintln!("usage: site [FOLDER]");
        return ExitCode::from(2);
    }
    match site::build(&root, &into) {
        Ok(site) => {
            println!(
                "{} pages, {} links: {}",
                site.pages,
                site.links,
                into.join("index.html").display()
            );
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
