//! The peers: what they are, how they are made, and the table.

use crate::ours::ours;
use crate::peak::Peak;
use crate::program;
use crate::reference::{Error, Reference};
use crate::work::{Row, STEPS, Work};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Rows that everybody steps.
const ROWS: usize = 1024;
/// Rows, the first ones, whose answers are compared.
const CHECKED: usize = 64;
/// Calls of ours of which the shortest counts.
const REPEATS: u32 = 8;

/// A program that is called as `COMMAND THREADS REPEATS CHECKED`, gets the work's text, and prints the shortest time in s
/// and the last states of the first rows.
struct Peer {
    name: &'static str,
    command: Vec<PathBuf>,
    repeats: u32,
}

/// What somebody took and gave.
struct Measurement {
    /// Time in s for all rows and steps, on one thread and on two.
    seconds: [f64; 2],
    error: Error,
}

/// Measures everybody, prints the table, and gives the names of those that are missing with the reason.
///
/// # Errors
/// When an answer is wrong.
pub fn compare(work: &Work, sources: &Path, peak: Option<&Peak>, flops: u64) -> Result<Vec<String>, String> {
    let rows = work.rows(ROWS)?;
    let reference = Reference::new(&rows[..CHECKED])?;
    let text = work.text(STEPS, &rows)?;
    let mine = ourselves(&rows, &reference)?;
    println!("{ROWS} rows, {STEPS} steps of 0.1 ms; error of {CHECKED} rows, in length or pressure over its range");
    println!("{:<22} {:>21} {:>21} {:>13} {:>19}", "", "ns/actuator-step", "million steps/s", "ratio to ours", "error");
    println!(
        "{:<22} {:>10} {:>10} {:>10} {:>10} {:>6} {:>6} {:>9} {:>9}",
        "", "one core", "two", "one core", "two", "one", "two", "median", "worst"
    );
    line("mckibben", &mine, &mine);
    let (peers, mut missing) = peers(sources);
    let mut wrong = Vec::new();
    for peer in peers {
        match peer.measure(&text, &reference) {
            Ok(taken) => {
                line(peer.name, &taken, &mine);
                if !taken.error.agrees() {
                    wrong.push(format!("{} is off by {:?}", peer.name, taken.error));
                }
            }
            Err(message) => missing.push(format!("{}: {message}", peer.name)),
        }
    }
    if let Some(peak) = peak {
        let rate = flops as f64 / nanoseconds(mine.seconds[0]);
        let share = 100.0 * rate / peak.double;
        println!("mckibben on one core: {rate:.1} Gflop/s, {share:.1} % of the multiply-add peak");
    }
    if !mine.error.agrees() {
        wrong.push(format!("mckibben is off by {:?}", mine.error));
    }
    if wrong.is_empty() { Ok(missing) } else { Err(wrong.join("\n")) }
}

fn ourselves(rows: &[Row], reference: &Reference) -> Result<Measurement, String> {
    let mut seconds = [f64::INFINITY; 2];
    let mut states = Vec::new();
    for (shortest, threads) in seconds.iter_mut().zip([1, 2]) {
        for _ in 0..REPEATS {
            let run = ours(rows, STEPS, threads)?;
            *shortest = shortest.min(run.seconds);
            states = run.states;
        }
    }
    Ok(Measurement { seconds, error: reference.error(&states) })
}

fn nanoseconds(seconds: f64) -> f64 {
    seconds * 1e9 / (ROWS as f64 * STEPS as f64)
}

fn line(name: &str, taken: &Measurement, mine: &Measurement) {
    let [one, two] = taken.seconds.map(nanoseconds);
    let [ratio_one, ratio_two] = [0, 1].map(|n| taken.seconds[n] / mine.seconds[n]);
    let Error { median, worst } = taken.error;
    println!(
        "{name:<22} {one:>10.2} {two:>10.2} {:>10.2} {:>10.2} {ratio_one:>6.3} {ratio_two:>6.3} {median:>9.1e} {worst:>9.1e}",
        1e3 / one,
        1e3 / two
    );
}

/// Everybody who can be had here, and why the others cannot.
fn peers(sources: &Path) -> (Vec<Peer>, Vec<String>) {
    let mut peers = Vec::new();
    let mut missing = Vec::new();
    match program::build(&sources.join("step.cpp")) {
        Ok(program) => {
            println!("C++ built with {}", program::FLAGS.join(" "));
            let forms =
                [("C++, one power", "textbook"), ("C++, by hand", "polynomial"), ("C++, turns located", "turns")];
            for (name, form) in forms {
                peers.push(Peer { name, command: vec![program.clone(), form.into()], repeats: 40 });
            }
        }
        Err(message) => missing.push(message),
    }
    match python(sources) {
        Ok(python) => {
            let scripts =
                [("Numba", "numba_step.py", 40), ("JAX", "jax_step.py", 40), ("heyoka", "heyoka_taylor.py", 10)];
            for (name, script, repeats) in scripts {
                peers.push(Peer { name, command: vec![python.clone(), sources.join(script)], repeats });
            }
        }
        Err(message) => missing.push(message),
    }
    (peers, missing)
}

/// The interpreter of `.venv` beside `peers/`, made here with the packages of `requirements.txt`.
fn python(sources: &Path) -> Result<PathBuf, String> {
    let requirements = sources.join("requirements.txt");
    let wanted = std::fs::read_to_string(&requirements).map_err(|error| error.to_string())?;
    let folder = sources.with_file_name(".venv");
    let python = folder.join("bin/python");
    let installed = folder.join("requirements.txt");
    if std::fs::read_to_string(&installed).is_ok_and(|text| text == wanted) {
        return Ok(python);
    }
    println!("installing {} into {}", requirements.display(), folder.display());
    let base = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    let mut make = Command::new(base);
    make.args(["-m", "venv"]).arg(&folder);
    let mut install = Command::new(&python);
    install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r"]).arg(&requirements);
    for command in [&mut make, &mut install] {
        let status = command.status().map_err(|error| format!("Python: {error}"))?;
        if !status.success() {
            return Err(format!("Python's packages cannot be installed: {command:?} failed"));
        }
    }
    std::fs::write(&installed, wanted).map_err(|error| error.to_string())?;
    Ok(python)
}

impl Peer {
    fn measure(&self, text: &str, reference: &Reference) -> Result<Measurement, String> {
        let [one, two] = [self.run(text, 1)?, self.run(text, 2)?];
        let [first, second] = [&one.1, &two.1].map(|states| reference.error(states));
        let error = Error { median: first.median.max(second.median), worst: first.worst.max(second.worst) };
        Ok(Measurement { seconds: [one.0, two.0], error })
    }

    fn run(&self, text: &str, threads: u32) -> Result<(f64, Vec<[f64; 4]>), String> {
        let [program, arguments @ ..] = &self.command[..] else { return Err("there is nothing to run".into()) };
        let mut command = Command::new(program);
        command.args(arguments).args([threads, self.repeats, CHECKED as u32].map(|number| number.to_string()));
        let answer = program::answer(&mut command, text)?;
        let seconds = answer["seconds"].as_f64().ok_or("it gives no time")?;
        let states = serde_json::from_value(answer["states"].clone()).map_err(|error| error.to_string())?;
        Ok((seconds, states))
    }
}
