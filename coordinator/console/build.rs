//! The shipped cases that need no other file, as scenes of `coordinator new`.

use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

fn main() {
    let folder =
        Path::new(&env::var("CARGO_MANIFEST_DIR").expect("Cargo sets it")).join("../../cases");
    println!("cargo:rerun-if-changed={}", folder.display());
    let mut files: Vec<_> = fs::read_dir(&folder)
        .expect("the cases lie in the repository")
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|end| end == "toml"))
        .collect();
    files.sort();
    // The scene that is meant if none is named: the first that the project was made for.
    let mut list = String::from(
        "/// The scene that is meant if none is named.\npub const FIRST: &str = \"wheel-rail\";\n",
    );
    list += "/// Names and texts of all of them.\npub const SCENES: &[(&str, &str)] = &[\n";
    for path in files {
        let text = fs::read_to_string(&path).expect("a case is a text");
        // A column of a table, a measured profile, or a program that lies somewhere.
        let named = ["file =", "profile =", "\ncommand =", ".csv\""];
        let alone = named.iter().all(|part| !text.contains(part));
        if let (true, Some(name)) = (alone, path.file_stem().and_then(|stem| stem.to_str())) {
            writeln!(list, "    ({name:?}, include_str!({:?})),", path.display().to_string())
                .expect("a text grows");
        }
    }
    list += "];\n";
    let out = Path::new(&env::var("OUT_DIR").expect("Cargo sets it")).join("scenes.rs");
    // A file that is written again would be newer than what was built of it.
    if fs::read_to_string(&out).ok().as_ref() != Some(&list) {
        fs::write(out, list).expect("the folder for what is made is there");
    }
}
