//! The programs of the system that the tests in C need, and the place of the library in a release.
//!
//! | in an archive | what |
//! |---|---|
//! | `lib/` | the shared and the static library |
//! | `include/mckibben.h` | the interface |
//! | `lib/pkgconfig/mckibben.pc`, `lib/cmake/mckibben/` | where pkg-config and CMake find them |

use crate::dist::{copy, create, output, write};
use crate::python::target_folder;
use crate::steps::{cargo, command, succeed};
use std::path::Path;

/// Programs that the tests start, and the packages of Debian that have them.
const PROGRAMS: [(&str, &str); 6] = [
    ("cc", "gcc"),
    ("c++", "g++"),
    ("valgrind", "valgrind"),
    ("pkg-config", "pkg-config"),
    ("cmake", "cmake"),
    ("make", "make"),
];

/// What the library is on one system or another.
const LIBRARIES: [&str; 6] = [
    "libmckibben_c.so",
    "libmckibben_c.dylib",
    "libmckibben_c.a",
    "mckibben_c.dll",
    "mckibben_c.dll.lib",
    "mckibben_c.lib",
];

/// Installs what is missing for the tests in C where apt can do it without asking: as root, or by `sudo` without a
/// password. Elsewhere the tests say what to install.
pub(crate) fn tools(root: &Path) -> Result<(), String> {
    let folders: Vec<_> =
        std::env::var_os("PATH").map(|path| std::env::split_paths(&path).collect()).unwrap_or_default();
    let is_there = |program: &str| folders.iter().any(|folder: &std::path::PathBuf| folder.join(program).exists());
    let missing = PROGRAMS.iter().filter(|(program, _)| !is_there(program)).map(|(_, package)| *package);
    let missing: Vec<&str> = missing.collect();
    if missing.is_empty() || !cfg!(target_os = "linux") || !is_there("apt-get") {
        return Ok(());
    }
    println!("installing {}", missing.join(", "));
    let is_root = output(command(root, "id").arg("-u"))?.trim() == "0";
    let apt = |arguments: &[&str]| {
        let mut apt = command(root, if is_root { "apt-get" } else { "sudo" });
        if !is_root {
            apt.args(["-n", "apt-get"]);
        }
        succeed(apt.args(["--quiet", "--yes"]).args(arguments).env("DEBIAN_FRONTEND", "noninteractive"))
    };
    let install = || apt(&[&["install", "--no-install-recommends"], &missing[..]].concat());
    install().or_else(|_| apt(&["update"]).and_then(|()| install()))
}

/// Builds the library as it is published, puts it into an archive's folder, and tries it from there.
pub(crate) fn release(root: &Path, into: &Path) -> Result<(), String> {
    // A library for Rust besides would leave link-time optimisation out.
    let mut build = cargo(root);
    build.args(["rustc", "--locked", "--profile", "dist", "--package", "mckibben-c", "--lib"]);
    succeed(build.args(["--crate-type", "cdylib,staticlib"]))?;
    let (own, built) = (root.join("crates/mckibben-c"), target_folder(root).join("dist"));
    for folder in ["include", "lib/pkgconfig", "lib/cmake/mckibben"] {
        create(&into.join(folder))?;
    }
    for file in LIBRARIES.iter().filter(|file| built.join(file).exists()) {
        copy(&built.join(file), &into.join("lib").join(file))?;
    }
    copy(&own.join("include/mckibben.h"), &into.join("include/mckibben.h"))?;
    let config = "mckibben-config.cmake";
    copy(&own.join("package").join(config), &into.join("lib/cmake/mckibben").join(config))?;
    for (file, to) in [("mckibben.pc", "lib/pkgconfig"), ("mckibben-config-version.cmake", "lib/cmake/mckibben")] {
        let template = own.join("package").join(format!("{file}.in"));
        let template =
            std::fs::read_to_string(&template).map_err(|error| format!("{}: {error}", template.display()))?;
        write(&into.join(to).join(file), &template.replace("@VERSION@", env!("CARGO_PKG_VERSION")))?;
    }
    if cfg!(target_os = "linux") {
        let (program, library) = (into.with_extension("tried"), into.join("lib"));
        let mut compile = command(root, "cc");
        compile.arg(own.join("examples/hanging_mass.c")).arg("-I").arg(into.join("include")).arg("-L").arg(&library);
        succeed(compile.args(["-lmckibben_c", "-o"]).arg(&program))?;
        succeed(command(root, &program).env("LD_LIBRARY_PATH", &library))?;
        std::fs::remove_file(&program).map_err(|error| format!("{}: {error}", program.display()))?;
    }
    Ok(())
}
