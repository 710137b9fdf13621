//! Units of work on threads, and their results in order.
//!
//! At most `AHEAD` units for each thread are under way or wait for an earlier one, so the memory does not grow with
//! the number of units.

use crate::failure::Failure;
use rayon::ThreadPoolBuilder;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;

/// Bytes of stack of a thread that runs plants: without optimisation the numbers of a block are copied on it several times over.
pub const STACK: usize = 16 << 20;

/// Units under way for each thread, so that none waits for work while a long one holds up the order.
const AHEAD: usize = 4;

/// Does `work` on each unit on `jobs` threads, and hands the results to `each` on this thread, in the order of the units.
///
/// # Errors
/// What `each` returns, after which no further unit is begun; and when the threads cannot be made.
pub fn in_order<U: Send, T: Send>(
    jobs: usize,
    mut units: impl Iterator<Item = U>,
    work: impl Fn(&U) -> T + Sync,
    mut each: impl FnMut(U, T) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let pool = ThreadPoolBuilder::new()
        .num_threads(jobs)
        .stack_size(STACK)
        .build()
        .map_err(|error| Failure::input(format!("{jobs} threads cannot be started: {error}"), "ask for fewer"))?;
    let (work, cancelled) = (&work, &AtomicBool::new(false));
    pool.in_place_scope_fifo(|scope| {
        let (send, receive) = mpsc::channel();
        let mut waiting = BTreeMap::new();
        let (mut begun, mut next) = (0, 0);
        loop {
            while begun < next + AHEAD * jobs {
                let Some(unit) = units.next() else { break };
                let (send, index) = (send.clone(), begun);
                scope.spawn_fifo(move |_| {
                    if !cancelled.load(Ordering::Relaxed) {
                        let result = catch_unwind(AssertUnwindSafe(|| work(&unit)));
                        // There is no receiver only when the work has been given up.
                        let _ = send.send((index, unit, result));
                    }
                });
                begun += 1;
            }
            if next == begun {
                return Ok(());
            }
            // This function holds a sender, so there is always something to receive.
            let Ok((index, unit, result)) = receive.recv() else { return Ok(()) };
            waiting.insert(index, (unit, result));
            while let Some((unit, result)) = waiting.remove(&next) {
                let done = match result {
                    Ok(result) => each(unit, result),
                    Err(panic) => {
                        cancelled.store(true, Ordering::Relaxed);
                        resume_unwind(panic)
                    }
                };
                if let Err(failure) = done {
                    cancelled.store(true, Ordering::Relaxed);
                    return Err(failure);
                }
                next += 1;
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicUsize;

    #[test]
    fn results_come_in_order_and_few_wait() {
        for jobs in [1, 2, 5] {
            let begun = AtomicUsize::new(0);
            let mut seen = Vec::new();
            let work = |unit: &u64| {
                begun.fetch_add(1, Ordering::Relaxed);
                // The first of every few is the slowest.
                std::thread::sleep(std::time::Duration::from_micros(if unit.is_multiple_of(7) { 900 } else { 10 }));
                unit * unit
            };
            let each = |unit: u64, square: u64| {
                assert_eq!(square, unit * unit);
                assert!(begun.load(Ordering::Relaxed) <= seen.len() + AHEAD * jobs);
                seen.push(unit);
                Ok(())
            };
            in_order(jobs, 0..100, work, each).unwrap();
            assert_eq!(seen, (0..100).collect::<Vec<_>>());
        }
    }

    #[test]
    fn a_failure_ends_the_work() {
        let begun = AtomicUsize::new(0);
        let work = |_: &u64| begun.fetch_add(1, Ordering::Relaxed);
        let each = |unit: u64, _| if unit == 3 { Err(Failure::stopped("enough")) } else { Ok(()) };
        let failure = in_order(2, 0..10_000, work, each).unwrap_err();
        assert_eq!(failure, Failure::stopped("enough"));
        assert!(begun.load(Ordering::Relaxed) < 100);
    }

    #[test]
    #[should_panic(expected = "unit 5")]
    fn a_panic_is_passed_on() {
        let work = |unit: &u64| assert_ne!(*unit, 5, "unit 5");
        let _ = in_order(2, 0..100, work, |_, ()| Ok(()));
    }
}
