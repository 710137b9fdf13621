//! Ctrl-C while the core works: Python's signals are looked at now and then, and what one of them raises ends the work.
//!
//! Python runs its handlers on the main thread, between instructions of the interpreter; as long as a call does not return
//! nobody hears Ctrl-C unless it is looked for. Work on the caller's own thread looks by a [`Watch`]; for work on the threads
//! of the pool, [`heard`] looks from the caller's thread, which waits for them.

use crate::pool;
use crate::raised::{Raised, exception};
use mckibben::Error;
use mckibben_run::failure::Failure;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

/// Between two looks at the clock work goes on as often as this, and between two at Python's signals so long.
const HEARD: u32 = 16;
const PATIENCE: Duration = Duration::from_millis(50);

/// Looks at Python's signals from the thread that works, while the interpreter is released.
pub(crate) struct Watch {
    calls: u32,
    looked: Instant,
    raised: Option<PyErr>,
}

impl Watch {
    pub(crate) fn new() -> Self {
        Self { calls: 0, looked: Instant::now(), raised: None }
    }

    /// Goes on unless a signal has raised something; `time` in s is what has been reached.
    pub(crate) fn at(&mut self, time: f64) -> Result<(), Error> {
        self.calls = self.calls.wrapping_add(1);
        if !self.calls.is_multiple_of(HEARD) || self.looked.elapsed() < PATIENCE {
            return Ok(());
        }
        self.looked = Instant::now();
        Python::attach(|py| py.check_signals()).map_err(|error| {
            self.raised = Some(error);
            Error::Interrupted { time }
        })
    }

    /// What came of the work, unless a signal ended it.
    pub(crate) fn outcome<T, E: Into<Failure>>(self, result: Result<T, E>) -> PyResult<T> {
        self.raised.map_or_else(|| result.raised(), Err)
    }
}

/// What work on the pool's threads calls now and then with the time in s that it has reached; an error ends it.
pub(crate) type Heard<'a> = dyn Fn(f64) -> Result<(), Error> + Sync + 'a;

/// Does work on the threads of this process, while the caller's thread listens for signals.
pub(crate) fn heard<T: Send>(py: Python<'_>, work: impl FnOnce(&Heard<'_>) -> T + Send) -> PyResult<T> {
    let (stop, mut raised, mut outcome) = (AtomicBool::new(false), None, None);
    py.detach(|| {
        let watch = |time: f64| match stop.load(Ordering::Relaxed) {
            true => Err(Error::Interrupted { time }),
            false => Ok(()),
        };
        let (watch, (done, wait)) = (&watch, mpsc::channel());
        pool::threads().map(|threads| {
            threads.in_place_scope(|scope| {
                // The sender goes with the work: where that panics, waiting ends and the scope passes the panic on.
                scope.spawn(move |_| {
                    let _ = done.send(work(watch));
                });
                loop {
                    match wait.recv_timeout(PATIENCE) {
                        Ok(value) => outcome = Some(value),
                        Err(RecvTimeoutError::Disconnected) => {}
                        Err(RecvTimeoutError::Timeout) => {
                            if let Err(error) = Python::attach(|py| py.check_signals()) {
                                raised = Some(error);
                                stop.store(true, Ordering::Relaxed);
                            }
                            continue;
                        }
                    }
                    break;
                }
            });
        })
    })
    .raised()?;
    match (raised, outcome) {
        (Some(error), _) => Err(error),
        (None, Some(value)) => Ok(value),
        (None, None) => Err(exception(&Failure::stopped("the work ended without an outcome"))),
    }
}
