//! Gives the shared library its name (SONAME) on Linux, so that a program that was linked to it by a path finds it by its name.
//!
//! Checked by `tests/system/install.rs`.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|system| system == "linux") {
        println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libmckibben_c.so");
    }
}
