//! The threads that share one calculation: a pool for each process, made when it is first used there.
//!
//! After `fork` a child has the one thread that forked and none of a pool's, but the pool's memory looks as if they were there:
//! a thread that waits for them never returns. So a pool belongs to the process that made it, and a child that was
//! forked, as by `multiprocessing`, makes its own. Nothing here holds a lock while it is made, for a lock that another
//! thread held when the process forked stays shut in the child.

use mckibben_run::failure::Failure;
use mckibben_run::sweep::schedule::STACK;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::ptr;
use std::sync::atomic::{AtomicPtr, Ordering};

/// The threads of a process.
struct Pool {
    process: u32,
    threads: ThreadPool,
}

/// What the last process that needed threads has made; never freed, because threads may still work on it.
static POOL: AtomicPtr<Pool> = AtomicPtr::new(ptr::null_mut());

/// Does work on the threads of this process if it is much, and else on the caller's own. Its argument says whether to keep to the
/// caller's.
pub(crate) fn share<T: Send>(is_much: bool, work: impl FnOnce(bool) -> T + Send) -> Result<T, Failure> {
    if is_much { shared(|| work(false)) } else { Ok(work(true)) }
}

/// Does work that is shared among threads on those of this process.
pub(crate) fn shared<T: Send>(work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
    threads().map(|threads| threads.install(work))
}

/// The threads of this process.
pub(crate) fn threads() -> Result<&'static ThreadPool, Failure> {
    pool().map(|pool| &pool.threads)
}

fn pool() -> Result<&'static Pool, Failure> {
    let process = std::process::id();
    let known = POOL.load(Ordering::Acquire);
    // SAFETY: what is not null was made from a box that is never freed nor written to again.
    match unsafe { known.as_ref() } {
        Some(pool) if pool.process == process => return Ok(pool),
        _ => {}
    }
    let threads = ThreadPoolBuilder::new().stack_size(STACK).build().map_err(|error| {
        Failure::input(format!("threads cannot be started: {error}"), "ask for fewer by RAYON_NUM_THREADS")
    })?;
    let made = Box::into_raw(Box::new(Pool { process, threads }));
    let pool = match POOL.compare_exchange(known, made, Ordering::AcqRel, Ordering::Acquire) {
        Ok(_) => made,
        Err(first) => {
            // SAFETY: another thread of this process was faster, so no other code has seen this one.
            drop(unsafe { Box::from_raw(made) });
            first
        }
    };
    // SAFETY: as above; what was made is not null.
    Ok(unsafe { &*pool })
}
