//! Many actuators at fixed steps: our speed against that of peers, at equal error.
//!
//! See README.md; in short: `cargo run --release --bin batch` in this folder.

mod engines;
mod memory;
mod ours;
mod peers;
mod program;
mod reference;
mod sizes;
mod work;

use reference::Reference;
use std::path::Path;
use std::process::ExitCode;
use work::Work;

/// The parts that can be requested; without an argument, all of them.
const PARTS: [&str; 4] = ["engines", "peers", "sizes", "memory"];

fn main() -> ExitCode {
    let parts: Vec<String> = std::env::args().skip(1).collect();
    let done = match &parts[..] {
        [part, rows] if part == memory::OF_A_BATCH => memory::of_a_batch(rows).map(|()| true),
        _ => run(parts),
    };
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

/// Whether all requested parts could be run.
fn run(parts: Vec<String>) -> Result<bool, String> {
    if let Some(unknown) = parts.iter().find(|part| !PARTS.contains(&part.as_str())) {
        return Err(format!("`{unknown}` is none of {}", PARTS.join(", ")));
    }
    let wants = |part: &str| parts.is_empty() || parts.iter().any(|one| one == part);
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let sources = here.join("peers");
    let work = Work::new()?;
    let mut missing = Vec::new();
    println!("{}", machine());
    if wants("engines") || wants("peers") {
        let reference = Reference::new(&work.rows(peers::CHECKED)?)?;
        if wants("engines") {
            println!();
            engines::print(&work, &reference)?;
        }
        if wants("peers") {
            println!();
            missing.extend(peers::compare(&work, &sources, &reference)?);
        }
    }
    if wants("sizes") {
        println!();
        sizes::print(&work)?;
    }
    if wants("memory") {
        println!();
        memory::batches()?;
        missing.extend(memory::sweep(&here.join("..")).err());
    }
    for message in &missing {
        println!("\nNOT MEASURED: {message}");
    }
    Ok(missing.is_empty())
}

/// The machine, and how busy it is with other work: a busy one makes every time longer, that on two cores most.
fn machine() -> String {
    let read = |path: &str| std::fs::read_to_string(path).unwrap_or_default();
    let processors = read("/proc/cpuinfo");
    let models: Vec<&str> = processors.lines().filter(|line| line.starts_with("model name")).collect();
    let model = models.first().and_then(|line| line.split_once(": ")).map_or("unknown", |(_, name)| name);
    let load = read("/proc/loadavg");
    format!("{} cores of {model}, load {} at the start", models.len(), load.split(' ').next().unwrap_or("unknown"))
}
