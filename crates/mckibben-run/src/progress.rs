//! Progress of long work, reported to a listener.
//!
//! There is none unless a host sets it, for the calls that it makes within [`with_listener`]: the program draws bars,
//! Python calls back. Reports change no result.

use std::cell::RefCell;
use std::fmt;
use std::sync::Arc;

/// The description of a piece of work.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Work {
    /// What is done, such as `simulating`.
    pub name: &'static str,
    /// How many parts it has; `None` where that is not known.
    pub parts: Option<u64>,
    /// Whether a part is a thing that people count, such as a run.
    pub is_counted: bool,
}

/// A host that receives progress. Its methods may be called from any thread.
pub trait Listener: Send + Sync {
    /// Work begins.
    fn begin(&self, work: Work) -> Arc<dyn Watcher>;
}

/// Follows one piece of work, until it is dropped.
pub trait Watcher: Send + Sync {
    /// So many parts are done.
    fn at(&self, parts: u64);

    /// A sentence that is worth reading before the work is done.
    fn say(&self, line: &str);
}

thread_local! {
    static LISTENER: RefCell<Option<Arc<dyn Listener>>> = const { RefCell::new(None) };
}

/// Does work that reports to a listener; after it, the one before is back.
pub fn with_listener<T>(listener: Arc<dyn Listener>, work: impl FnOnce() -> T) -> T {
    /// Puts the listener back, also where the work ends by a panic.
    struct Before(Option<Arc<dyn Listener>>);
    impl Drop for Before {
        fn drop(&mut self) {
            LISTENER.set(self.0.take());
        }
    }
    let _before = Before(LISTENER.replace(Some(listener)));
    work()
}

/// Work under way.
pub struct Progress(Option<Arc<dyn Watcher>>);

impl fmt::Debug for Progress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Progress").field(&self.0.is_some()).finish()
    }
}

impl Progress {
    /// Begins work of so many parts, or of unknown length, under a name such as `simulating`.
    pub fn begin(name: &'static str, parts: Option<u64>) -> Self {
        Self::of(Work { name, parts, is_counted: false })
    }

    /// Begins work of so many parts whose rate is worth knowing, such as runs.
    pub fn counted(name: &'static str, parts: u64) -> Self {
        Self::of(Work { name, parts: Some(parts), is_counted: true })
    }

    fn of(work: Work) -> Self {
        Self(LISTENER.with_borrow(|listener| listener.as_ref().map(|listener| listener.begin(work))))
    }

    /// Says how many parts are done.
    pub fn at(&self, parts: u64) {
        if let Some(watcher) = &self.0 {
            watcher.at(parts);
        }
    }

    /// Says a sentence.
    pub fn say(&self, line: &str) {
        if let Some(watcher) = &self.0 {
            watcher.say(line);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[derive(Clone, Default)]
    struct Recorder(Arc<Mutex<Vec<String>>>);

    impl Listener for Recorder {
        fn begin(&self, work: Work) -> Arc<dyn Watcher> {
            self.say(&format!("{} of {:?}", work.name, work.parts));
            Arc::new(self.clone())
        }
    }

    impl Watcher for Recorder {
        fn at(&self, parts: u64) {
            self.say(&parts.to_string());
        }

        fn say(&self, line: &str) {
            self.0.lock().unwrap().push(line.to_owned());
        }
    }

    #[test]
    fn a_listener_receives_its_own_calls_and_no_others() {
        let (outer, inner) = (Recorder::default(), Recorder::default());
        with_listener(Arc::new(outer.clone()), || {
            with_listener(Arc::new(inner.clone()), || Progress::begin("fitting", None).at(1));
            let progress = Progress::counted("runs", 2);
            std::thread::scope(|scope| scope.spawn(|| progress.at(2)).join()).unwrap();
        });
        Progress::begin("nothing", None).say("no listener");
        let calls = |of: &Recorder| of.0.lock().unwrap().join(", ");
        assert_eq!([calls(&inner), calls(&outer)], ["fitting of None, 1", "runs of Some(2), 2"]);
    }
}
