//! A bar for work that takes longer than a second: on a terminal only, on standard error, gone when the work is done.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use mckibben_run::progress::{Listener, Watcher, Work};
use std::sync::Arc;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::time::Duration;

/// How long work may take before a bar appears.
const PATIENCE: Duration = Duration::from_secs(1);

/// Draws a bar for each piece of work.
#[derive(Clone, Copy, Debug)]
pub struct Bars;

impl Listener for Bars {
    fn begin(&self, work: Work) -> Arc<dyn Watcher> {
        Arc::new(Bar::begin(work))
    }
}

/// The bar of work under way.
#[derive(Debug)]
struct Bar {
    bar: ProgressBar,
    /// Dropped with this value, which ends the thread that waits to show the bar.
    _done: Sender<()>,
}

impl Bar {
    fn begin(Work { name, parts, is_counted }: Work) -> Self {
        let template = match (parts, is_counted) {
            (Some(_), true) => "{msg} {wide_bar} {percent:>3} %  {per_sec}  {eta} left",
            (Some(_), false) => "{msg} {wide_bar} {percent:>3} %  {eta} left",
            (None, _) => "{spinner} {msg}, {elapsed} so far",
        };
        // Templates are constants; a faulty one would fall back to the plain style.
        let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar =
            ProgressBar::with_draw_target(parts, ProgressDrawTarget::hidden()).with_style(style).with_message(name);
        let (done, wait) = mpsc::channel::<()>();
        let shown = bar.clone();
        // A thread draws the bar, because the work may be one call that does not return for minutes.
        std::thread::spawn(move || {
            if wait.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                shown.set_draw_target(ProgressDrawTarget::stderr());
                shown.enable_steady_tick(Duration::from_millis(100));
            }
        });
        Self { bar, _done: done }
    }
}

impl Watcher for Bar {
    fn at(&self, parts: u64) {
        self.bar.set_position(parts);
    }

    /// On standard error, above the bar if there is one.
    fn say(&self, line: &str) {
        self.bar.suspend(|| crate::terminal::print_error(&format!("{line}\n")));
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
