//! What a test program says at its end, as counts.

use crate::steps::words;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

/// How a step's notes on what was tested begin in the output of a Rust test.
const NOTE: &str = "tested: ";

/// Tests of a step; all zero for a step that runs no tests.
pub(crate) struct Counts {
    pub(crate) passed: u64,
    pub(crate) failed: u64,
    /// Skipped, ignored, or not collected.
    pub(crate) skipped: u64,
    /// What the summary says besides: why tests were skipped, what the machine decided about the tests.
    pub(crate) notes: Vec<String>,
}

impl Counts {
    pub(crate) const NONE: Self = Self { passed: 0, failed: 0, skipped: 0, notes: Vec::new() };

    pub(crate) fn add(&mut self, other: &Self) {
        self.passed += other.passed;
        self.failed += other.failed;
        self.skipped += other.skipped;
        self.notes.extend(other.notes.iter().cloned());
    }

    /// Reads a line of a Rust test program.
    fn see_rust(&mut self, line: &str) {
        if let Some(counts) = line.strip_prefix("test result: ") {
            self.passed += count_before(counts, " passed");
            self.failed += count_before(counts, " failed");
            self.skipped += count_before(counts, " ignored");
        } else if let Some(note) = line.strip_prefix(NOTE) {
            self.notes.push(note.to_owned());
        }
    }

    /// Reads a line of pytest: the last one holds the counts, and those before it the reasons of what was skipped.
    fn see_pytest(&mut self, line: &str) {
        if let Some(reason) = line.strip_prefix("SKIPPED ") {
            self.notes.push(format!("not run: {reason}"));
        }
        self.passed = count_before(line, " passed");
        self.failed = count_before(line, " failed") + count_before(line, " error");
        self.skipped = count_before(line, " skipped") + count_before(line, " xfailed");
    }
}

/// Runs Rust tests and counts them.
pub(crate) fn rust_tests(tests: &mut Command) -> Result<Counts, String> {
    counted(tests, Counts::see_rust)
}

/// Runs pytest and counts its tests.
pub(crate) fn pytest(tests: &mut Command) -> Result<Counts, String> {
    counted(tests.arg("-rs"), Counts::see_pytest)
}

/// Runs tests, prints their output, and counts by each line. It is an error if no test ran.
fn counted(tests: &mut Command, see: impl Fn(&mut Counts, &str)) -> Result<Counts, String> {
    let line = words(tests);
    let lost = |error| format!("`{line}` could not be run: {error}");
    let mut child = tests.stdout(Stdio::piped()).spawn().map_err(lost)?;
    let mut counts = Counts::NONE;
    if let Some(output) = child.stdout.take() {
        for line in BufReader::new(output).lines().map_while(Result::ok) {
            println!("{line}");
            see(&mut counts, &line);
        }
    }
    let status = child.wait().map_err(lost)?;
    if counts.passed + counts.failed == 0 {
        return Err(format!("`{line}` ran no test and ended with {status}"));
    }
    if status.success() || counts.failed > 0 { Ok(counts) } else { Err(format!("`{line}` ended with {status}")) }
}

/// The number that stands before a word: 12 for ` passed` in `ok. 12 passed; 0 failed`.
fn count_before(line: &str, word: &str) -> u64 {
    line.split_once(word)
        .and_then(|(before, _)| before.rsplit(|c: char| !c.is_ascii_digit()).next())
        .and_then(|digits| digits.parse().ok())
        .unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn program(script: &str) -> Command {
        let mut command = Command::new("sh");
        command.args(["-c", script]);
        command
    }

    fn figures(counts: &Counts) -> [u64; 3] {
        [counts.passed, counts.failed, counts.skipped]
    }

    #[test]
    fn rust_tests_of_several_programs_add_up_with_those_ignored() {
        let counts = rust_tests(&mut program(
            "echo 'tested: vector widths Baseline, Avx2'; \
             echo 'test result: ok. 12 passed; 0 failed; 1 ignored; 0 measured; 5 filtered out'; \
             echo 'test result: FAILED. 3 passed; 2 failed; 4 ignored; 0 measured; 0 filtered out'; exit 101",
        ))
        .expect("counts");
        assert_eq!(figures(&counts), [15, 2, 5]);
        assert_eq!(counts.notes, ["vector widths Baseline, Avx2"]);
    }

    #[test]
    fn pytest_gives_the_reason_of_what_it_skips() {
        let script = "echo 'SKIPPED [1] tests/test_torch.py:8: no PyTorch'; echo '7 passed, 1 skipped in 0.5s'";
        let counts = pytest(&mut program(script)).expect("counts");
        assert_eq!(figures(&counts), [7, 0, 1]);
        assert_eq!(counts.notes, ["not run: [1] tests/test_torch.py:8: no PyTorch"]);
    }

    #[test]
    fn a_step_without_a_test_fails() {
        let nothing = "echo 'test result: ok. 0 passed; 0 failed; 3 ignored; 0 measured; 9 filtered out'";
        assert!(rust_tests(&mut program(nothing)).is_err());
        assert!(pytest(&mut program("echo '3 skipped in 0.1s'")).is_err());
        assert!(pytest(&mut program("exit 5")).is_err());
    }

    #[test]
    fn a_program_that_breaks_off_fails_whatever_it_counted() {
        assert!(rust_tests(&mut program("echo 'test result: ok. 1 passed; 0 failed'; exit 101")).is_err());
    }
}
