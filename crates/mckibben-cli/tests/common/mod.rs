//! What the tests of the program share: a folder for each test, and the program.

use assert_cmd::Command;
use std::path::{Path, PathBuf};

/// A muscle that lifts 5 lb under pulses at 25 Hz, for 0.3 s.
pub(crate) const PULSES: &str = r#"[supply]
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
[run]
duration = "0.3 s"
"#;

/// A folder that is gone when the test is over.
pub(crate) struct Folder(PathBuf);

impl Folder {
    /// An empty folder.
    pub(crate) fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("mckibben-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).expect("a folder for temporary files");
        Self(path)
    }

    /// A path in it.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Writes a file into it.
    pub(crate) fn file(&self, name: &str, text: &str) -> PathBuf {
        std::fs::write(self.path(name), text).expect("writable");
        self.path(name)
    }

    /// The names of all that is in it, sorted.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).expect("readable");
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// The program, to be run in it.
    pub(crate) fn mckibben(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_mckibben"));
        command.current_dir(&self.0).env("NO_COLOR", "1");
        command
    }

    /// What the program prints when it is sent a signal after a while.
    #[cfg(unix)]
    pub(crate) fn interrupted(
        &self,
        arguments: &[&str],
        signal: &str,
        after: std::time::Duration,
    ) -> std::process::Output {
        let child = std::process::Command::new(env!("CARGO_BIN_EXE_mckibben"))
            .args(arguments)
            .current_dir(&self.0)
            .env("NO_COLOR", "1")
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .expect("it starts");
        std::thread::sleep(after);
        let kill = ["-s".to_owned(), signal.trim_start_matches("SIG").to_owned(), child.id().to_string()];
        assert!(std::process::Command::new("kill").args(kill).status().expect("kill").success());
        child.wait_with_output().expect("ended")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A file of this repository.
pub(crate) fn of_repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

/// Whether this process was started with a signal as ignored, as by `nohup`: its children ignore it too.
#[cfg(unix)]
pub(crate) fn is_ignored(signal: u32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).unwrap_or("0");
    u64::from_str_radix(mask.trim(), 16).is_ok_and(|mask| mask & (1 << (signal - 1)) != 0)
}
