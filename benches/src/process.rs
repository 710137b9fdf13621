//! Peers in other languages: programs that read the problem and print their answer.

use crate::peer::{Peer, Solution};
use crate::problem::Problem;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// A program that is called as `PROGRAM ARGUMENTS METHOD TOLERANCE REPEATS`, gets the problem's text, and prints
/// `seconds evaluations steps guard-evaluations events` and then a line with length and pressure for each sample.
pub struct Process {
    /// Name in the table.
    pub name: String,
    /// What is run.
    pub program: PathBuf,
    /// Arguments before the method.
    pub arguments: Vec<String>,
    /// Name of the method.
    pub method: String,
    /// How often a quoted run is repeated.
    pub repeats: u32,
}

impl Peer for Process {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn repeats(&self) -> u32 {
        self.repeats
    }

    fn solve(&self, problem: &Problem, tolerance: f64, repeats: u32) -> Result<Solution, String> {
        let mut child = Command::new(&self.program)
            .args(&self.arguments)
            .args([&self.method, &format!("{tolerance:e}"), &repeats.to_string()])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| format!("{}: {error}", self.program.display()))?;
        if let Some(mut input) = child.stdin.take() {
            input.write_all(problem.text().as_bytes()).map_err(|error| error.to_string())?;
        }
        let output = child.wait_with_output().map_err(|error| error.to_string())?;
        if !output.status.success() {
            let message = String::from_utf8_lossy(&output.stderr);
            return Err(message.lines().last().unwrap_or("it failed and says nothing").to_owned());
        }
        parse(&String::from_utf8_lossy(&output.stdout)).ok_or_else(|| "its answer cannot be read".to_owned())
    }
}

fn parse(text: &str) -> Option<Solution> {
    let mut lines = text.lines();
    let head: Vec<f64> = lines.next()?.split(' ').map(|word| word.parse().ok()).collect::<Option<_>>()?;
    let [seconds, evaluations, steps, _guard_evaluations, events] = head[..] else { return None };
    let row = |line: &str| {
        let (length, pressure) = line.split_once(' ')?;
        Some([length.parse().ok()?, pressure.parse().ok()?])
    };
    Some(Solution {
        seconds,
        evaluations: evaluations as u64,
        steps: steps as u64,
        events: events as u64,
        samples: lines.map(row).collect::<Option<_>>()?,
    })
}
