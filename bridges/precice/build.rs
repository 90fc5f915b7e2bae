//! Gives the library the name under which programs that use preCICE 3 look for it.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libprecice.so.3");
}
