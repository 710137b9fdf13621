//! SIGINT, SIGTERM and SIGHUP: what is under way is removed, what is finished stays, and the exit code says which it was.
//!
//! | signal | exit code |
//! |---|---|
//! | SIGHUP | 129 |
//! | SIGINT (Ctrl-C) | 130 |
//! | SIGTERM | 143 |
//!
//! A signal that the process was started with as ignored, as by
//! `nohup`, stays ignored. A second signal ends the process at once, but not within a second of the first: `timeout` and shells
//! signal a process and its group, which reach it twice. Work that has a result at any time, such as a search, ends
//! with what it has at the first signal (`ending`): its files are written, and the exit code is that of the signal. Checked by
//! `tests/output.rs` and `tests/identify_ends.rs`.

use std::sync::atomic::{AtomicI32, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// Signals that come within this time of one are one with it.
const TOGETHER: Duration = Duration::from_secs(1);

/// What ends the work under way with what it has.
type End = Box<dyn FnOnce() + Send>;

static ENDING: Mutex<Option<End>> = Mutex::new(None);
/// The signal that has ended work so; zero for none.
static ENDED_BY: AtomicI32 = AtomicI32::new(0);

/// Takes part in [`ending`]; dropped where the work is done.
#[derive(Debug)]
pub(crate) struct Ending(());

impl Drop for Ending {
    fn drop(&mut self) {
        set(None);
    }
}

/// Ends work with what it has, by `end`, at the first signal before the value returned is dropped.
pub(crate) fn ending(end: impl FnOnce() + Send + 'static) -> Ending {
    set(Some(Box::new(end)));
    Ending(())
}

/// The exit code of the signal that has ended work with what it had, if one has.
pub(crate) fn code() -> Option<u8> {
    match ENDED_BY.load(Ordering::Relaxed) {
        0 => None,
        signal => u8::try_from(128 + signal).ok(),
    }
}

fn set(end: Option<End>) {
    *ENDING.lock().unwrap_or_else(PoisonError::into_inner) = end;
}

/// Listens from now on.
#[cfg(unix)]
pub fn listen() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    let caught = [(SIGHUP, "SIGHUP"), (SIGINT, "SIGINT"), (SIGTERM, "SIGTERM")];
    let caught: Vec<(i32, &'static str)> = caught.into_iter().filter(|(signal, _)| !is_ignored(*signal)).collect();
    let Ok(mut signals) = signal_hook::iterator::Signals::new(caught.iter().map(|(signal, _)| signal)) else { return };
    std::thread::spawn(move || {
        let mut ending = false;
        let mut last: Option<Instant> = None;
        for signal in signals.forever() {
            if last.is_some_and(|last| last.elapsed() < TOGETHER) {
                continue;
            }
            last = Some(Instant::now());
            if ending {
                std::process::exit(128 + signal);
            }
            let name = caught.iter().find(|(of, _)| *of == signal).map_or("a signal", |(_, name)| *name);
            let end_with_result = ENDING.lock().unwrap_or_else(PoisonError::into_inner).take();
            if let Some(end_with_result) = end_with_result {
                ENDED_BY.store(signal, Ordering::Relaxed);
                crate::terminal::print_error(&format!("{name}: the search ends with the best values so far\n"));
                end_with_result();
                continue;
            }
            ending = true;
            // Not on this thread: a file system that does not answer must not block a second signal.
            std::thread::spawn(move || end(signal, name));
        }
    });
}

/// Listens from now on, where there are signals.
#[cfg(not(unix))]
pub fn listen() {}

#[cfg(unix)]
fn end(signal: i32, name: &str) -> ! {
    let words = match stays(mckibben_run::output::abandon_all()) {
        None => "nothing was left behind".to_owned(),
        Some(stays) => format!("what was under way was removed; {stays}"),
    };
    crate::terminal::print_error(&format!("stopped by {name}: {words}\n"));
    std::process::exit(128 + signal)
}

/// Whether the process ignored a signal before it listened, where that can be known.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask & (1 << (signal - 1)) != 0
}

/// What is said of a program that is ended while files of it are finished, where it has more to say than their number.
static STAYS: OnceLock<Box<dyn Fn() -> String + Send + Sync>> = OnceLock::new();

/// Words for what stays when this program ends before its work is done.
pub(crate) fn on_end(words: impl Fn() -> String + Send + Sync + 'static) {
    // The first says it: a program does one thing.
    let _ = STAYS.set(Box::new(words));
}

/// What stays when this program ends now, so many of its files being finished; `None` for nothing.
pub(crate) fn stays(finished: u64) -> Option<String> {
    match (STAYS.get(), finished) {
        (Some(words), _) => Some(words()),
        (None, 0) => None,
        (None, 1) => Some("1 file that was finished stays".to_owned()),
        (None, _) => Some(format!("{finished} files that were finished stay")),
    }
}
