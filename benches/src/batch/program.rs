//! Programs beside this one: compilers, and what they make.

use serde_json::Value;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Flags of the C++ compiler.
pub const FLAGS: [&str; 7] =
    ["-std=c++20", "-O3", "-march=native", "-mprefer-vector-width=512", "-ffast-math", "-fopenmp", "-Wall"];

/// Builds `source` into the folder of this program.
///
/// # Errors
/// With what to install when there is no compiler, and what it says when it refuses.
pub fn build(source: &Path) -> Result<PathBuf, String> {
    let program = std::env::current_exe()
        .map_err(|error| error.to_string())?
        .with_file_name(source.file_stem().ok_or_else(|| format!("{} is no source", source.display()))?);
    let compiler = std::env::var("CXX").unwrap_or_else(|_| "g++".into());
    let output = Command::new(&compiler).args(FLAGS).arg("-o").arg(&program).arg(source).output();
    let output = output.map_err(|error| format!("{compiler}: {error}; apt-get install -y g++"))?;
    if output.status.success() {
        Ok(program)
    } else {
        Err(format!("{} does not compile:\n{}", source.display(), String::from_utf8_lossy(&output.stderr)))
    }
}

/// Runs a program on `input` and reads the JSON that it prints.
///
/// # Errors
/// What the program says when it fails.
pub fn answer(command: &mut Command, input: &str) -> Result<Value, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut child = child.map_err(|error| format!("{name}: {error}"))?;
    if let Some(mut pipe) = child.stdin.take() {
        // A program that ends early breaks the pipe, and says why in its own words.
        let _ = pipe.write_all(input.as_bytes());
    }
    let output = child.wait_with_output().map_err(|error| error.to_string())?;
    if !output.status.success() {
        let message = String::from_utf8_lossy(&output.stderr);
        return Err(format!("{name}: {}", message.lines().last().unwrap_or("it failed and says nothing")));
    }
    serde_json::from_slice(&output.stdout).map_err(|error| format!("{name}: {error}"))
}
