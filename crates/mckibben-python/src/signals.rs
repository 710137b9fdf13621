//! Ctrl-C while the core works: Python's signals are checked now and then, and what one of them raises ends the work.
//!
//! Python runs its handlers on the main thread, between instructions of the interpreter; as long as a call does not return
//! Ctrl-C has no effect unless it is checked. Work on the caller's own thread checks by a [`Watch`]; for work on the threads of
//! the pool, [`interruptible`] checks from the caller's thread, which waits for them.

use crate::exceptions::{OrException, exception};
use crate::pool;
use crate::typed::Progress;
use mckibben::Error;
use mckibben_run::failure::Failure;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

/// How often work goes on between two checks of the clock, and how long between two checks of Python's signals.
const CALLS_PER_CHECK: u32 = 16;
const PATIENCE: Duration = Duration::from_millis(50);

/// Checks Python's signals from the working thread, while the interpreter is released, and reports progress.
#[derive(Default)]
pub(crate) struct Watch {
    calls: u32,
    last_check: Option<Instant>,
    raised: Option<PyErr>,
    /// A function of Python, and the time in s at which the work ends.
    progress: Option<(Py<PyAny>, f64)>,
}

impl Watch {
    pub(crate) fn new() -> Self {
        Self { last_check: Some(Instant::now()), ..Self::default() }
    }

    /// Calls `progress(time, end)` now and then. What it raises ends the work.
    pub(crate) fn reporting(self, progress: Option<Progress<'_>>, end: f64) -> Self {
        Self { progress: progress.map(|progress| (progress.0.unbind(), end)), ..self }
    }

    /// Goes on unless a signal has raised something; `time` in s is what has been reached.
    pub(crate) fn at(&mut self, time: f64) -> Result<(), Error> {
        self.calls = self.calls.wrapping_add(1);
        if !self.calls.is_multiple_of(CALLS_PER_CHECK)
            || self.last_check.is_some_and(|last_check| last_check.elapsed() < PATIENCE)
        {
            return Ok(());
        }
        self.last_check = Some(Instant::now());
        let check = |py: Python<'_>| {
            py.check_signals()?;
            self.progress.as_ref().map_or(Ok(()), |(progress, end)| progress.call1(py, (time, *end)).map(drop))
        };
        Python::attach(check).map_err(|error| {
            self.raised = Some(error);
            Error::Interrupted { time }
        })
    }

    /// What came of the work, unless a signal ended it.
    pub(crate) fn outcome<T, E: Into<Failure>>(self, result: Result<T, E>) -> PyResult<T> {
        self.raised.map_or_else(|| result.or_exception(), Err)
    }
}

/// What work on the pool's threads calls now and then with the time in s that it has reached; an error ends it.
pub(crate) type Check<'a> = dyn Fn(f64) -> Result<(), Error> + Sync + 'a;

/// Does work on the threads of this process, while the caller's thread checks signals.
pub(crate) fn interruptible<T: Send>(py: Python<'_>, work: impl FnOnce(&Check<'_>) -> T + Send) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    let watch = |time: f64| match stop.load(Ordering::Relaxed) {
        true => Err(Error::Interrupted { time }),
        false => Ok(()),
    };
    followed(py, |_| Ok(()), || stop.store(true, Ordering::Relaxed), || work(&watch))
}

/// Does work on the threads of this process, while the caller's thread checks signals and calls `report` now and then.
/// What one of them raises calls `stop`, and is raised when the work has ended.
pub(crate) fn followed<T: Send>(
    py: Python<'_>,
    report: impl Fn(Python<'_>) -> PyResult<()> + Sync,
    stop: impl Fn() + Sync,
    work: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    match followed_to_its_end(py, report, stop, work)? {
        (Some(error), _) => Err(error),
        (None, value) => Ok(value),
    }
}

/// Does work as [`followed`] does, and returns what a signal or `report` has raised with the outcome of the work that `stop` has
/// ended: work that has a result at any time.
pub(crate) fn followed_to_its_end<T: Send>(
    py: Python<'_>,
    report: impl Fn(Python<'_>) -> PyResult<()> + Sync,
    stop: impl Fn() + Sync,
    work: impl FnOnce() -> T + Send,
) -> PyResult<(Option<PyErr>, T)> {
    let (mut raised, mut outcome) = (None, None);
    py.detach(|| {
        let (done, wait) = mpsc::channel();
        pool::threads().map(|threads| {
            threads.in_place_scope(|scope| {
                // The sender goes with the work: where that panics, waiting ends and the scope passes the panic on.
                scope.spawn(move |_| {
                    let _ = done.send(work());
                });
                loop {
                    match wait.recv_timeout(PATIENCE) {
                        Ok(value) => outcome = Some(value),
                        Err(RecvTimeoutError::Disconnected) => {}
                        Err(RecvTimeoutError::Timeout) => {
                            if raised.is_none()
                                && let Err(error) = Python::attach(|py| py.check_signals().and_then(|()| report(py)))
                            {
                                raised = Some(error);
                                stop();
                            }
                            continue;
                        }
                    }
                    break;
                }
            });
        })
    })
    .or_exception()?;
    match (raised, outcome) {
        (raised, Some(value)) => Ok((raised, value)),
        (Some(error), None) => Err(error),
        (None, None) => Err(exception(&Failure::stopped("the work ended without an outcome"))),
    }
}
