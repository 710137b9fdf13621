//! The peers: what they are, how they are made, and the table.

use crate::engines::Measurement;
use crate::ours::Engine;
use crate::program;
use crate::reference::{Error, Reference};
use crate::work::{STEPS, Work};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Rows that every peer steps.
pub const ROWS: usize = 1024;
/// Rows, the first ones, whose answers are compared.
pub const CHECKED: usize = 64;
/// Errors up to which a peer's answer is the same answer. A heavy mass that bounces on the taut braid magnifies any
/// difference, so the worst row says only that none left the others.
const AGREEMENT: Error = Error { median: 1e-5, worst: 1e-2 };
/// How much larger than ours an error is that still counts as equal.
const EQUAL: f64 = 1.1;
/// Into how many equal steps a peer may divide each of 0.1 ms for that.
const DIVISIONS: [u64; 5] = [1, 2, 4, 8, 16];

/// What a peer takes from the state at each evaluation, instead of holding it over a step that it divides where it ends.
const NOTHING_LOCATED: &str = "sgn(v), slack and taut at each evaluation: no stick, nothing located";

/// A program that is called as `COMMAND THREADS REPEATS CHECKED`, gets the work's text, and prints the shortest time in s
/// and the last states of the first rows.
struct Peer {
    name: &'static str,
    command: Vec<PathBuf>,
    repeats: u32,
    /// What it does not do that our engine does.
    lacks: &'static str,
}

/// Measures all peers, prints the table, and gives the names of those that are missing with the reason.
///
/// # Errors
/// When an answer is wrong.
pub fn compare(work: &Work, sources: &Path, reference: &Reference) -> Result<Vec<String>, String> {
    let (peers, mut missing) = peers(sources);
    let mine = Measurement::take(Engine::usual(), work, reference)?;
    let rows = work.rows(ROWS)?;
    let texts = DIVISIONS.iter().map(|divisions| work.text(*divisions, &rows)).collect::<Result<Vec<_>, _>>()?;
    println!("{ROWS} rows, {STEPS} steps of 0.1 ms; error of {CHECKED} rows, in length or pressure over its range");
    println!(
        "{:<22} {:>21} {:>21} {:>13} {:>19} {:>20}",
        "", "ns/actuator-step", "million steps/s", "ratio to ours", "error", "at our median error"
    );
    println!(
        "{:<22} {:>10} {:>10} {:>10} {:>10} {:>6} {:>6} {:>9} {:>9} {:>9} {:>10}",
        "", "one core", "two", "one core", "two", "one", "two", "median", "worst", "divisions", "ratio, one"
    );
    println!("{} {:>9} {:>10}", line("mckibben", mine.seconds, mine.error, &mine), 1, 1);
    let mut notes = Vec::new();
    let mut wrong = Vec::new();
    for peer in peers {
        match peer.measure(&texts, reference, &mine) {
            Ok((error, text)) => {
                println!("{text}");
                notes.push(format!("{:<22} {}", peer.name, peer.lacks));
                if !error.is_within(AGREEMENT) {
                    wrong.push(format!("{} is off by {error:?}", peer.name));
                }
            }
            Err(message) => missing.push(format!("{}: {message}", peer.name)),
        }
    }
    println!("what they lack that ours does; all: a fault of its own for a row that leaves the physics");
    notes.iter().for_each(|note| println!("{note}"));
    if wrong.is_empty() { Ok(missing) } else { Err(wrong.join("\n")) }
}

/// The time in ns of an actuator-step in a run of all rows and steps.
pub fn nanoseconds(seconds: f64) -> f64 {
    seconds * 1e9 / (ROWS as f64 * STEPS as f64)
}

fn line(name: &str, seconds: [f64; 2], error: Error, mine: &Measurement) -> String {
    let [one, two] = seconds.map(nanoseconds);
    let [ratio_one, ratio_two] = [0, 1].map(|n| seconds[n] / mine.seconds[n]);
    let Error { median, worst } = error;
    format!(
        "{name:<22} {one:>10.2} {two:>10.2} {:>10.2} {:>10.2} {ratio_one:>6.2} {ratio_two:>6.2} {median:>9.1e} {worst:>9.1e}",
        1e3 / one,
        1e3 / two
    )
}

/// The peers that are available here, and why the others are not.
fn peers(sources: &Path) -> (Vec<Peer>, Vec<String>) {
    let mut peers = Vec::new();
    let mut missing = Vec::new();
    match program::build(&sources.join("step.cpp")) {
        Ok(program) => {
            println!("C++ built with {}", program::FLAGS.join(" "));
            let forms = [
                ("C++, one power", "textbook", NOTHING_LOCATED),
                ("C++, by hand", "polynomial", NOTHING_LOCATED),
                ("C++, located", "located", "a valve of its own for each row; the same instants are located"),
            ];
            for (name, form, lacks) in forms {
                peers.push(Peer { name, command: vec![program.clone(), form.into()], repeats: 20, lacks });
            }
        }
        Err(message) => missing.push(message),
    }
    match python(sources) {
        Ok(python) => {
            let scripts =
                [("Numba", "numba_step.py", 20), ("JAX", "jax_step.py", 20), ("heyoka", "heyoka_taylor.py", 5)];
            for (name, script, repeats) in scripts {
                let command = vec![python.clone(), sources.join(script)];
                peers.push(Peer { name, command, repeats, lacks: NOTHING_LOCATED });
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
    /// Its error at our steps, and its line of the table.
    fn measure(&self, texts: &[String], reference: &Reference, mine: &Measurement) -> Result<(Error, String), String> {
        let [one, two] = [self.run(&texts[0], 1, self.repeats)?, self.run(&texts[0], 2, self.repeats)?];
        let [first, second] = [&one.1, &two.1].map(|states| reference.error(states));
        let error = Error { median: first.median.max(second.median), worst: first.worst.max(second.worst) };
        let text = line(self.name, [one.0, two.0], error, mine);
        Ok((error, format!("{text} {}", self.at_our_error(texts, (one.0, first), reference, mine)?)))
    }

    /// Into how many steps it must divide ours to be as near to the truth, and its time on one core then, over ours.
    fn at_our_error(
        &self,
        texts: &[String],
        mut taken: (f64, Error),
        reference: &Reference,
        mine: &Measurement,
    ) -> Result<String, String> {
        for (index, divisions) in DIVISIONS.iter().enumerate() {
            if index > 0 {
                let repeats = (self.repeats / *divisions as u32).max(2);
                let (seconds, states) = self.run(&texts[index], 1, repeats)?;
                taken = (seconds, reference.error(&states));
            }
            if taken.1.median <= EQUAL * mine.error.median {
                return Ok(format!("{divisions:>9} {:>10.2}", taken.0 / mine.seconds[0]));
            }
        }
        Ok(format!("{:>9} {:>10}", format!("over {}", DIVISIONS[DIVISIONS.len() - 1]), "-"))
    }

    fn run(&self, text: &str, threads: u32, repeats: u32) -> Result<(f64, Vec<[f64; 4]>), String> {
        let [program, arguments @ ..] = &self.command[..] else { return Err("there is nothing to run".into()) };
        let mut command = Command::new(program);
        command.args(arguments).args([threads, repeats, CHECKED as u32].map(|number| number.to_string()));
        let answer = program::answer(&mut command, text)?;
        let seconds = answer["seconds"].as_f64().ok_or("it gives no time")?;
        let states = serde_json::from_value(answer["states"].clone()).map_err(|error| error.to_string())?;
        Ok((seconds, states))
    }
}
