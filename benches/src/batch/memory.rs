//! The memory that batches need at most, and `mckibben sweep` for a million rows.

use crate::ours::Engine;
use crate::program;
use crate::work::Work;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// A million runs of the work, a valve's period each.
const SWEEP: &str = r#"
[actuator]
preset = "colbrunn-2001"
[supply]
gauge_pressure = "100 psi"
[valve]
preset = "matrix-eight-channel"
[command]
kind = "pwm"
frequency = "25 Hz"
duty = 0.5
[load]
kind = "hanging-mass"
mass = "5 lb"
[initial]
gauge_pressure = "0 psi"
length = "equilibrium"
[run]
duration = "40 ms"
step = "0.1 ms"
sample_interval = "10 ms"
method = "rk4"
engine = "fixed-step"
[sweep]
design = "sobol"
rows = 1000000
reductions = ["length.final", "tension.peak"]
[sweep.vary]
"load.mass" = { from = "3 lb", to = "15 lb" }
"supply.gauge_pressure" = { from = "60 psi", to = "110 psi" }
"#;

/// The argument with which this program starts itself to measure the memory of one batch; the number of rows follows.
pub const OF_A_BATCH: &str = "memory-of-a-batch";
/// Rows of the batches.
const SIZES: [usize; 4] = [1_000, 10_000, 100_000, 1_000_000];
/// Steps that a batch takes meanwhile.
const STEPS: u64 = 10;

/// Makes one batch, steps it, and prints what this process had in memory at most, in KiB.
///
/// # Errors
/// When that is not a number, or a row fails.
pub fn of_a_batch(rows: &str) -> Result<(), String> {
    let rows = Work::new()?.rows(rows.parse().map_err(|_| format!("`{rows}` is no number of rows"))?)?;
    let of_rows = own_mark()?;
    Engine::usual().run(rows, STEPS, 2)?;
    println!("[{of_rows}, {}]", own_mark()?);
    Ok(())
}

fn own_mark() -> Result<u64, String> {
    high_water_mark(std::process::id()).ok_or_else(|| "this system does not say what a process has in memory".into())
}

/// Prints the memory of batches of several sizes, each in a separate process.
///
/// # Errors
/// When one fails.
pub fn batches() -> Result<(), String> {
    println!("largest resident memory of a batch: its rows as they are given, then with the blocks made of them");
    println!("{:>9} {:>11} {:>11} {:>13}", "rows", "rows, MiB", "batch, MiB", "KiB for a row");
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    for size in SIZES {
        let mut command = Command::new(&program);
        let marks = program::answer(command.arg(OF_A_BATCH).arg(size.to_string()), "")?;
        let [rows, batch]: [f64; 2] = serde_json::from_value(marks).map_err(|error| error.to_string())?;
        println!("{size:>9} {:>11.0} {:>11.0} {:>13.2}", rows / 1024.0, batch / 1024.0, batch / size as f64);
    }
    Ok(())
}

/// Builds the program, runs the sweep, and prints the child's largest resident memory.
///
/// # Errors
/// When the program cannot be built, has no `sweep`, or fails.
pub fn sweep(workspace: &Path) -> Result<(), String> {
    let program = build(workspace)?;
    let has_sweep = Command::new(&program).args(["sweep", "--help"]).output().map_err(|error| error.to_string())?;
    if !has_sweep.status.success() {
        return Err(format!("{} has no subcommand sweep", program.display()));
    }
    let folder = std::env::temp_dir().join(format!("mckibben-sweep-memory-{}", std::process::id()));
    std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    let measured = run_sweep(&program, &folder);
    std::fs::remove_dir_all(&folder).map_err(|error| error.to_string())?;
    let (kibibytes, bytes) = measured?;
    println!(
        "mckibben sweep of 1000000 rows: at most {:.0} MiB in memory, {:.0} MiB of results",
        kibibytes as f64 / 1024.0,
        bytes as f64 / 1_048_576.0
    );
    Ok(())
}

/// The program that `MCKIBBEN` names, or one built from the sources.
fn build(workspace: &Path) -> Result<PathBuf, String> {
    if let Some(program) = std::env::var_os("MCKIBBEN") {
        return Ok(program.into());
    }
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let target = program.parent().ok_or("this program lies in no folder")?.join("program");
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let status = Command::new(cargo)
        .args(["build", "--release", "--quiet", "--package", "mckibben-cli", "--target-dir"])
        .arg(&target)
        .current_dir(workspace)
        .status();
    match status {
        Ok(status) if status.success() => Ok(target.join("release/mckibben")),
        _ => Err("the program does not build".into()),
    }
}

/// Largest resident memory in KiB while the sweep ran, and the size of what it wrote in bytes.
fn run_sweep(program: &Path, folder: &Path) -> Result<(u64, u64), String> {
    let (file, results) = (folder.join("sweep.toml"), folder.join("results"));
    std::fs::write(&file, SWEEP).map_err(|error| error.to_string())?;
    let mut command = Command::new(program);
    command.arg("sweep").arg(&file).arg("--output").arg(&results).arg("--quiet");
    let mut child = command.stderr(Stdio::inherit()).spawn().map_err(|error| error.to_string())?;
    let mut largest = 0;
    let status = loop {
        // The mark never falls, so the last look before the end is at most one interval old.
        largest = high_water_mark(child.id()).unwrap_or(largest);
        if let Some(status) = child.try_wait().map_err(|error| error.to_string())? {
            break status;
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    if !status.success() {
        return Err(format!("mckibben sweep: {status}"));
    }
    let entries = std::fs::read_dir(&results).map_err(|error| error.to_string())?;
    let sizes = entries.filter_map(|entry| Some(entry.ok()?.metadata().ok()?.len()));
    Ok((largest, sizes.sum()))
}

fn high_water_mark(process: u32) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse().ok()
}
