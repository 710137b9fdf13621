//! Temporary files under way, made and put in place by the crate `tempfile`.
//!
//! This module adds what that crate leaves to a program: an interrupt removes the files under way, and a later process removes
//! those of a process that was killed. A temporary file is called `.NAME.MACHINE.RANDOM.tmp`, where
//!
//! | part | what |
//! |---|---|
//! | `NAME` | the file that it is to become |
//! | `MACHINE` | a random identifier of the running system, which changes at each start (Linux); `x` elsewhere |
//! | `RANDOM` | characters that make the name unique: the file is created exclusively |
//!
//! The process that writes it holds a lock on it, which ends with the process. So a file is abandoned where its name says that it
//! was begun on this machine and no process holds its lock. Locks of other machines on a network file system may not be
//! visible, so their files stay.
//!
//! Checked by the tests below, and by those of the program, `tests/output.rs` and `tests/sweep_folder.rs`.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs::{File, Permissions, TryLockError};
use std::io::{Error, ErrorKind, Result};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use tempfile::{Builder, TempPath};

/// How often a file is begun again that another process took for abandoned before it was locked.
const MOST_TRIED: u32 = 100;
/// How the name of a temporary file ends.
const ENDING: &str = ".tmp";

/// What this process has written so far.
#[derive(Debug)]
struct Ledger {
    /// Temporary files under way, by the number of each. One that is dropped is removed.
    under_way: BTreeMap<u64, TempPath>,
    /// How many files were begun.
    begun: u64,
    /// How many files took their final name.
    finished: u64,
}

/// Held while a file is begun, put in place or removed, so that an interrupt finds each of them in one state.
static LEDGER: Mutex<Ledger> = Mutex::new(Ledger { under_way: BTreeMap::new(), begun: 0, finished: 0 });

fn ledger() -> MutexGuard<'static, Ledger> {
    LEDGER.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The name of a temporary file, which is removed when this is dropped.
#[derive(Debug)]
pub(crate) struct Temporary(u64);

impl Temporary {
    /// Begins a temporary file for `path`, in the same folder, with the permissions of any new file. As long as the file is open
    /// it is locked.
    pub(crate) fn begin(path: &Path) -> Result<(Self, File)> {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let prefix = prefix(path);
        let mut builder = Builder::new();
        builder.prefix(&prefix).suffix(ENDING);
        if let Some(permissions) = usual_permissions() {
            builder.permissions(permissions);
        }
        let mut ledger = ledger();
        for _ in 0..MOST_TRIED {
            let (file, temporary) = builder.tempfile_in(folder)?.into_parts();
            if is_claimed(&file, &temporary) {
                let number = ledger.begun;
                ledger.begun += 1;
                ledger.under_way.insert(number, temporary);
                return Ok((Self(number), file));
            }
        }
        Err(Error::new(ErrorKind::AlreadyExists, "other processes remove the temporary file"))
    }

    /// Gives the file its name; what stood there before is replaced in the same instant.
    pub(crate) fn put(self, path: &Path) -> Result<()> {
        let mut ledger = ledger();
        let Some(temporary) = ledger.under_way.remove(&self.0) else { return Err(abandoned()) };
        temporary.persist(path)?;
        ledger.finished += 1;
        Ok(())
    }

    /// Gives the file its name unless something has it already; whether it did. Of several processes, one does.
    ///
    /// # Errors
    /// Also where the file system can neither rename without replacing nor make hard links.
    pub(crate) fn put_new(self, path: &Path) -> Result<bool> {
        let mut ledger = ledger();
        let Some(temporary) = ledger.under_way.remove(&self.0) else { return Err(abandoned()) };
        let put = match temporary.persist_noclobber(path) {
            Ok(()) => Ok(true),
            Err(refused) if refused.error.kind() == ErrorKind::AlreadyExists => Ok(false),
            Err(refused) => Err(refused.error),
        };
        ledger.finished += u64::from(matches!(put, Ok(true)));
        put
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // That it cannot be removed has nowhere to be said.
        ledger().under_way.remove(&self.0);
    }
}

/// Of a file that [`abandon_all`] has removed; not reached, as the ledger is never released after it.
fn abandoned() -> Error {
    Error::new(ErrorKind::NotFound, "the temporary file was removed")
}

/// How many files of this process took their final name.
pub fn finished() -> u64 {
    ledger().finished
}

/// Removes all temporary files under way, and lets none be begun or put in place from now on: the process is about to end. How
/// many files were finished.
pub fn abandon_all() -> u64 {
    let mut ledger = ledger();
    ledger.under_way.clear();
    let finished = ledger.finished;
    // Never released: every other caller waits for the end.
    std::mem::forget(ledger);
    finished
}

/// Removes the temporary files in a folder that processes of this machine have abandoned. That one cannot be removed harms nothing.
pub(crate) fn clear_abandoned(folder: &Path, of: impl Fn(&str) -> bool) {
    let Some(here) = machine() else { return };
    let entries = std::fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    for entry in entries {
        let name = entry.file_name();
        if !name.to_str().and_then(|name| begun_on(here, name)).is_some_and(&of) {
            continue;
        }
        // Removed while the lock is held, so that no process begins a file and loses it after it has seen that it is there.
        if let Ok(file) = File::options().read(true).write(true).open(entry.path())
            && file.try_lock().is_ok()
        {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Locks a new file; whether it is still there and no other process has taken the lock to remove it. Where files cannot
/// be locked, they are never removed.
fn is_claimed(file: &File, path: &Path) -> bool {
    machine().is_none() || (!matches!(file.try_lock(), Err(TryLockError::WouldBlock)) && path.exists())
}

/// How the name of a temporary file for `path` begins.
fn prefix(path: &Path) -> OsString {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}.", machine().unwrap_or("x")));
    name
}

/// The file that a temporary file of this name, begun on a machine, is to become.
fn begun_on<'a>(machine: &str, name: &'a str) -> Option<&'a str> {
    let (begins, _) = name.strip_prefix('.')?.strip_suffix(ENDING)?.rsplit_once('.')?;
    begins.strip_suffix(machine)?.strip_suffix('.')
}

/// The running system; `None` where it does not say.
fn machine() -> Option<&'static str> {
    static MACHINE: OnceLock<Option<String>> = OnceLock::new();
    let find = || {
        let machine = std::fs::read_to_string("/proc/sys/kernel/random/boot_id").ok()?;
        let machine: String = machine.chars().filter(char::is_ascii_hexdigit).take(16).collect();
        (machine.len() == 16).then_some(machine)
    };
    MACHINE.get_or_init(find).as_deref()
}

/// The permissions that a new file has before the process's mask is applied; a temporary file of `tempfile` would be for its
/// owner alone.
#[cfg(unix)]
fn usual_permissions() -> Option<Permissions> {
    use std::os::unix::fs::PermissionsExt as _;
    Some(Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn usual_permissions() -> Option<Permissions> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> std::path::PathBuf {
        let folder = std::env::temp_dir().join(format!("mckibben-temporary-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        folder
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_name_says_where_it_was_begun_and_what_it_becomes() {
        let here = machine().unwrap_or("x");
        let name = format!("{}a1B2c3.tmp", prefix(Path::new("out/part-00001.parquet")).into_string().unwrap());
        assert_eq!(begun_on(here, &name), Some("part-00001.parquet"));
        assert_eq!(begun_on("0123456789abcdef", &name), None);
        for other in ["part-00001.parquet", ".part-00001.parquet.a1B2c3.tmp", ".a.x.swp", ".a.tmp", "..tmp"] {
            assert_eq!(begun_on(here, other), None, "{other}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn only_what_is_known_to_be_abandoned_is_removed() {
        let folder = folder("abandoned");
        let here = machine().expect("Linux says on which machine it is");
        let kept = [
            ".part.0000000000000000.abcdef.tmp".to_owned(),
            ".part.x.abcdef.tmp".to_owned(),
            format!(".other.{here}.abcdef.tmp"),
            ".part.swp".to_owned(),
            "part".to_owned(),
        ];
        let removed = [format!(".part.{here}.abcdef.tmp"), format!(".part.{here}.123456.tmp")];
        kept.iter().chain(&removed).for_each(|name| std::fs::write(folder.join(name), name).unwrap());
        let (temporary, file) = Temporary::begin(&folder.join("part")).unwrap();
        clear_abandoned(&folder, |file| file == "part");
        assert!(kept.iter().all(|name| folder.join(name).exists()));
        assert!(removed.iter().all(|name| !folder.join(name).exists()));
        assert_eq!(names(&folder).len(), kept.len() + 1, "the live one stays: {:?}", names(&folder));
        drop((temporary, file));
        assert_eq!(names(&folder).len(), kept.len());
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_file_has_the_permissions_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = folder("permissions");
        let (temporary, file) = Temporary::begin(&folder.join("run.csv")).unwrap();
        temporary.put(&folder.join("run.csv")).unwrap();
        drop(file);
        std::fs::write(folder.join("usual"), "").unwrap();
        let [run, usual] = ["run.csv", "usual"].map(|name| folder.join(name).metadata().unwrap().permissions().mode());
        assert_eq!(run, usual);
        std::fs::remove_dir_all(folder).unwrap();
    }
}
