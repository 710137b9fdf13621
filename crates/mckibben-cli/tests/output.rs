//! Files and messages whatever happens on the way: signals, a full disk, a terminal that takes nothing.
#![cfg(unix)]

use crate::common::Folder;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

/// A sweep that takes some seconds, in many parts.
fn long() -> String {
    let masses: Vec<String> = (0..600).map(|i| format!("\"{} lb\"", 3.0 + 0.02 * f64::from(i))).collect();
    format!(
        "[actuator]\npreset = \"colbrunn-2001\"\n[supply]\ngauge_pressure = \"100 psi\"\n[valve]\npreset = \"matrix-eight-channel\"\n\
         [command]\nkind = \"pwm\"\nfrequency = \"25 Hz\"\nduty = 0.5\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n\
         [run]\nduration = \"0.6 s\"\nstep = \"0.1 ms\"\n\
         [sweep]\nreductions = [\"length.final\"]\npart_rows = 8\n[sweep.vary]\n\"load.mass\" = [{}]\n",
        masses.join(", ")
    )
}

/// A sweep with a few short runs and then some that take minutes: it never ends before its signal comes.
fn endless() -> String {
    let durations = (1..=6).map(|i| format!("\"{i} ms\"")).chain((0..20).map(|i| format!("\"{} s\"", 10_000 + i)));
    let head = long().replace("part_rows = 8", "part_rows = 1");
    let head = head.split("[sweep.vary]").next().expect("a head").to_owned();
    format!("{head}[sweep.vary]\n\"run.duration\" = [{}]\n", durations.collect::<Vec<_>>().join(", "))
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten();
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Runs a line of the shell, in which `$0` is the program. Signals that the tests were started without, as in a background job
/// or under `nohup`, take effect again, where `env` can do so.
fn shell(folder: &Folder, line: &str) -> Command {
    let restored = "--default-signal=INT,HUP,TERM";
    let can = Command::new("env").args([restored, "true"]).stderr(Stdio::null()).status();
    let mut command = Command::new("env");
    if can.is_ok_and(|status| status.success()) {
        command.arg(restored);
    }
    command.current_dir(folder.path("")).env("NO_COLOR", "1");
    command.args(["sh", "-c", line, env!("CARGO_BIN_EXE_mckibben")]);
    command
}

fn begin(folder: &Folder, line: &str) -> Child {
    shell(folder, line).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("a shell")
}

/// Waits until something is so, while the process runs.
fn wait_until(child: &mut Child, is_so: impl Fn() -> bool) {
    while !is_so() {
        assert!(child.try_wait().expect("asked").is_none(), "it ended before it could be stopped");
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn send(child: &Child, signal: &str) {
    let status = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill");
    assert!(status.success());
}

fn error(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_signal_removes_what_is_under_way_and_keeps_what_is_finished() {
    let folder = Folder::new("output-signals");
    folder.file("sweep.toml", &endless());
    for (signal, name, code) in [("-INT", "SIGINT", 130), ("-TERM", "SIGTERM", 143), ("-HUP", "SIGHUP", 129)] {
        // One file, which is under way from the beginning.
        let mut child = begin(&folder, "exec \"$0\" sweep sweep.toml -o run.csv");
        wait_until(&mut child, || folder.names().iter().any(|name| name.starts_with(".run.csv.")));
        send(&child, signal);
        let output = child.wait_with_output().expect("ended");
        assert_eq!(output.status.code(), Some(code), "{}", error(&output));
        assert!(error(&output).contains(&format!("stopped by {name}: nothing was left behind")), "{}", error(&output));
        assert_eq!(folder.names(), ["sweep.toml"]);

        // Twice, as `timeout` does it to the process and to its group: the file under way is removed all the same.
        let mut child = begin(&folder, "exec \"$0\" sweep sweep.toml -o run.csv");
        wait_until(&mut child, || folder.names().iter().any(|name| name.starts_with(".run.csv.")));
        let twice = format!("kill {signal} {0}; kill {signal} {0} 2>/dev/null; true", child.id());
        assert!(Command::new("sh").args(["-c", &twice]).status().expect("sh").success());
        assert_eq!(child.wait_with_output().expect("ended").status.code(), Some(code));
        assert_eq!(folder.names(), ["sweep.toml"]);

        // Parts, some of which are finished.
        let out = folder.path("out");
        let finished = || names(&out).iter().filter(|name| name.starts_with("part-")).count();
        let mut child = begin(&folder, "exec \"$0\" sweep sweep.toml -o out");
        wait_until(&mut child, || finished() >= 3);
        send(&child, signal);
        let output = child.wait_with_output().expect("ended");
        assert_eq!(output.status.code(), Some(code), "{}", error(&output));
        let said = format!("{} of 26 parts are finished and stay in `out`", finished());
        assert!(error(&output).contains(&said), "{said} is not in {}", error(&output));
        assert!(names(&out).iter().all(|name| !name.starts_with('.')), "{:?}", names(&out));
        std::fs::remove_dir_all(&out).expect("there");
    }
}

#[test]
fn a_signal_that_was_ignored_stays_ignored() {
    let folder = Folder::new("output-ignored");
    folder.file("sweep.toml", &long());
    let mut child = begin(&folder, "trap '' INT HUP; exec \"$0\" sweep sweep.toml -o run.csv");
    wait_until(&mut child, || folder.names().iter().any(|name| name.starts_with(".run.csv.")));
    send(&child, "-INT");
    send(&child, "-HUP");
    let output = child.wait_with_output().expect("ended");
    // Where the system does not say what is ignored, the program is stopped.
    let is_known = Path::new("/proc/self/status").exists();
    assert_eq!(output.status.success(), is_known, "{}", error(&output));
    assert_eq!(folder.names().len(), if is_known { 2 } else { 1 });
}

#[test]
fn a_file_that_grows_too_large_is_named_with_what_stays() {
    let folder = Folder::new("output-full");
    // Later parts are larger; the disk has no room for the last ones.
    let text = long()
        .replace("reductions = [\"length.final\"]", "record = \"trajectories\"")
        .replace("part_rows = 8", "part_rows = 1")
        .replace("step = \"0.1 ms\"", "step = \"0.1 ms\"\nsample_interval = \"0.1 ms\"");
    let head = text.split("[sweep.vary]").next().expect("a head");
    folder.file(
        "sweep.toml",
        &format!("{head}[sweep.vary]\n\"run.duration\" = [\"1 ms\", \"2 ms\", \"3 ms\", \"1 s\", \"1.1 s\"]\n"),
    );
    // Files end at 64 blocks of 512 bytes; the signal for it would end the process.
    let output = shell(&folder, "trap '' XFSZ; ulimit -f 64; exec \"$0\" sweep sweep.toml -o out --jobs 1")
        .output()
        .expect("a shell");
    assert_eq!(output.status.code(), Some(4), "{}", error(&output));
    for words in
        ["part-00003.parquet` could not be written", "has space left", "3 of 5 parts are finished and stay in `out`"]
    {
        assert!(error(&output).contains(words), "{words} is not in {}", error(&output));
    }
    let expected = ["part-00000.parquet", "part-00001.parquet", "part-00002.parquet", "sweep.json"];
    assert_eq!(names(&folder.path("out")), expected);
    // With space again it goes on.
    let output = shell(&folder, "exec \"$0\" sweep sweep.toml -o out").output().expect("a shell");
    assert!(output.status.success(), "{}", error(&output));
    assert_eq!(names(&folder.path("out")).len(), 6);
    // A single file leaves nothing.
    let output = shell(&folder, "trap '' XFSZ; ulimit -f 64; exec \"$0\" sweep sweep.toml -o all.csv")
        .output()
        .expect("a shell");
    assert_eq!(output.status.code(), Some(4), "{}", error(&output));
    assert!(error(&output).contains("nothing was left behind"), "{}", error(&output));
    assert_eq!(folder.names(), ["out", "sweep.toml"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_terminal_that_takes_nothing_is_no_panic() {
    let folder = Folder::new("output-terminal");
    folder.file("sweep.toml", &long());
    for (line, code) in [
        ("exec \"$0\" simulate absent.toml 2>/dev/full", 2),
        ("exec \"$0\" nonsense 2>/dev/full", 2),
        ("exec \"$0\" simulate sweep.toml 2>/dev/full", 0),
        ("exec \"$0\" simulate sweep.toml >/dev/full 2>/dev/full", 4),
        ("exec \"$0\" presets >/dev/full", 4),
        ("exec \"$0\" simulate absent.toml 2>&-", 2),
    ] {
        let output = shell(&folder, line).output().expect("a shell");
        assert_eq!(output.status.code(), Some(code), "{line}: {}", error(&output));
    }
}
