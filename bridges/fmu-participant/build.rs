//! The one function that Rust cannot define: a logger with a variable number of arguments (FMI 2.0).

fn main() {
    println!("cargo::rerun-if-changed=src/logger.c");
    cc::Build::new().file("src/logger.c").std("c11").warnings(true).compile("fmu_logger");
}
