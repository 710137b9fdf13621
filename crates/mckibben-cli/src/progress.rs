//! A bar for work that takes longer than a second: on a terminal only, on standard error, gone when the work is done.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::time::Duration;

/// How long work may take before anything is shown.
const PATIENCE: Duration = Duration::from_secs(1);

/// Whether no bars are wanted.
static SILENT: AtomicBool = AtomicBool::new(false);

/// No bars are shown from now on, whatever takes how long: another program is the host.
pub fn silence() {
    SILENT.store(true, Ordering::Relaxed);
}

/// Work under way.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    /// Dropped with this value, which ends the thread that waits to show the bar.
    _done: Sender<()>,
}

impl Progress {
    /// Begins work of `total` parts, or of unknown length, under a name such as `simulating`.
    pub fn begin(name: &'static str, total: Option<u64>) -> Self {
        let template = match total {
            Some(_) => "{msg} {wide_bar} {percent:>3} %  {eta} left",
            None => "{spinner} {msg}, {elapsed} so far",
        };
        Self::with_template(name, total, template)
    }

    /// Begins work of `total` parts whose rate is worth knowing, such as runs.
    pub fn counted(name: &'static str, total: u64) -> Self {
        Self::with_template(name, Some(total), "{msg} {wide_bar} {percent:>3} %  {per_sec}  {eta} left")
    }

    fn with_template(name: &'static str, total: Option<u64>, template: &str) -> Self {
        // Templates are constants; a faulty one would fall back to the plain style.
        let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar =
            ProgressBar::with_draw_target(total, ProgressDrawTarget::hidden()).with_style(style).with_message(name);
        let (done, wait) = mpsc::channel::<()>();
        if SILENT.load(Ordering::Relaxed) {
            return Self { bar, _done: done };
        }
        let shown = bar.clone();
        // A thread shows the bar, because the work may be one call that does not return for minutes.
        std::thread::spawn(move || {
            if wait.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                shown.set_draw_target(ProgressDrawTarget::stderr());
                shown.enable_steady_tick(Duration::from_millis(100));
            }
        });
        Self { bar, _done: done }
    }

    /// Prints a line on standard error, above the bar if one is shown; nothing where another program is the host.
    pub fn say(&self, line: &str) {
        if !SILENT.load(Ordering::Relaxed) {
            self.bar.suspend(|| crate::terminal::print_error(&format!("{line}\n")));
        }
    }

    /// Says how many parts are done.
    pub fn at(&self, parts: u64) {
        self.bar.set_position(parts);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
