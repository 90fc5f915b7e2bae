//! Builds the logger of FMI 2.0. It takes a variable number of arguments, and Rust cannot define
//! such a function.

fn main() {
    println!("cargo::rerun-if-changed=src/logger.c");
    cc::Build::new().file("src/logger.c").std("c11").warnings(true).compile("fmu_logger");
}
