//! The system's programs, and where the library lies.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Where the crate lies.
pub(crate) fn here() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Where the library lies that these tests were built with.
pub(crate) fn library() -> PathBuf {
    let this = std::env::current_exe().expect("this program");
    let folder = this.parent().expect("a folder").to_owned();
    for file in ["libmckibben_c.so", "libmckibben_c.a"] {
        assert!(folder.join(file).exists(), "{file} is not in {}", folder.display());
    }
    folder
}

/// An empty folder for the files of a test.
pub(crate) fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Runs a program to its end; what it printed.
pub(crate) fn run(command: &mut Command) -> String {
    let name = command.get_program().to_string_lossy().into_owned();
    let done = command.output().unwrap_or_else(|error| {
        panic!(
            "`{name}` could not be started: {error}; on Debian: apt-get install gcc g++ valgrind pkg-config cmake make"
        )
    });
    let (out, error) = (String::from_utf8_lossy(&done.stdout), String::from_utf8_lossy(&done.stderr));
    assert!(done.status.success(), "{command:?} ended with {}:\n{out}\n{error}", done.status);
    out.into_owned()
}

/// Compiles an example with warnings as errors; `flags` come last, with what it is linked to.
pub(crate) fn compile(source: &str, program: &Path, flags: &[&str]) {
    let (compiler, standard) = if source.ends_with(".c") { ("cc", "-std=c99") } else { ("c++", "-std=c++17") };
    let mut command = Command::new(compiler);
    command.args([standard, "-O1", "-g", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-ffp-contract=off"]);
    command.arg("-I").arg(here().join("include")).arg(here().join("examples").join(source));
    run(command.arg("-o").arg(program).args(flags));
}

/// Flags that link a program to the shared library.
pub(crate) fn shared() -> [String; 3] {
    let folder = library().display().to_string();
    [format!("-L{folder}"), format!("-Wl,-rpath,{folder}"), "-lmckibben_c".to_owned()]
}

/// The scenario of the arm.
pub(crate) fn arm() -> PathBuf {
    here().join("../../examples/plant/arm.toml")
}
