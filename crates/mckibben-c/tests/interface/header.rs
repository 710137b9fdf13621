//! The header is what cbindgen makes of the code.
//!
//! To write it: `MCKIBBEN_WRITE=1 cargo test --package mckibben-c --test interface header`.

use std::path::Path;

/// The files with an interface, in the order of the header.
const FILES: [&str; 5] = ["status", "plant", "step", "many", "simulation"];

#[test]
fn the_header_is_made_from_the_code() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(here.join("cbindgen.toml")).expect("how the header is made");
    let sources = FILES.map(|file| here.join(format!("src/{file}.rs")));
    let builder = sources.iter().fold(cbindgen::Builder::new().with_config(config), |made, file| made.with_src(file));
    let (mut due, path) = (Vec::new(), here.join("include/mckibben.h"));
    builder.generate().expect("an interface").write(&mut due);
    let due = String::from_utf8(due).expect("text");
    assert!(due.matches("mckibben_status mckibben_").count() > 15, "functions are missing:\n{due}");
    if std::env::var_os("MCKIBBEN_WRITE").is_some() {
        std::fs::write(&path, &due).expect("a folder");
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(kept == due, "include/mckibben.h is not what the code says: write it with MCKIBBEN_WRITE=1");
}
