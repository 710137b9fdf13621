//! Temporary files: names that no other process has, which of them were abandoned, and which are under way here.
//!
//! A temporary file is called `.NAME.MACHINE-SPACE-PROCESS-NUMBER.tmp`, where
//!
//! | part | what |
//! |---|---|
//! | `NAME` | the file that it is to become |
//! | `MACHINE` | a random identifier of the running system, which changes at each start (Linux); `x` elsewhere |
//! | `SPACE` | the space of process numbers, which containers on one machine do not share |
//! | `PROCESS`, `NUMBER` | the process, and how many it had begun before |
//!
//! It is created exclusively, so two processes never write to one, on whatever machines of a network file system they run. From
//! there nobody can see whether a process on another machine is alive: an abandoned file is removed only where its name says
//! that it was begun on this machine, in this space, by a process that is gone. All others stay.
//!
//! Checked by the tests below, and by those of the program, `tests/output.rs`.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs::{File, OpenOptions};
use std::io::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

/// How many names are tried where files of such names are there already.
const MOST_TRIED: u32 = 10_000;

/// What this process has written so far.
#[derive(Debug, Default)]
struct Ledger {
    /// Temporary files under way.
    under_way: BTreeSet<PathBuf>,
    /// How many names were taken.
    begun: u64,
    /// How many files took their final name.
    finished: u64,
}

/// Held while a file is begun, put in place or removed, so that an interrupt finds each of them in one state.
static LEDGER: Mutex<Ledger> = Mutex::new(Ledger { under_way: BTreeSet::new(), begun: 0, finished: 0 });

fn ledger() -> MutexGuard<'static, Ledger> {
    LEDGER.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Begins a temporary file for `path`, in the same folder.
pub(crate) fn create(path: &Path) -> Result<(PathBuf, File)> {
    let mut ledger = ledger();
    for _ in 0..MOST_TRIED {
        let temporary = path.with_file_name(name_of(path, ledger.begun));
        ledger.begun += 1;
        match OpenOptions::new().write(true).create_new(true).open(&temporary) {
            Ok(file) => {
                ledger.under_way.insert(temporary.clone());
                return Ok((temporary, file));
            }
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    Err(Error::new(ErrorKind::AlreadyExists, "too many temporary files of this name stand beside it"))
}

/// Gives a temporary file its name; what stood there before is replaced in the same instant.
pub(crate) fn put(temporary: &Path, path: &Path) -> Result<()> {
    let mut ledger = ledger();
    std::fs::rename(temporary, path)?;
    ledger.under_way.remove(temporary);
    ledger.finished += 1;
    Ok(())
}

/// Gives a temporary file its name unless something has it already; whether it did. Of several processes, one does.
///
/// # Errors
/// Also where the file system has no hard links.
pub(crate) fn put_new(temporary: &Path, path: &Path) -> Result<bool> {
    let mut ledger = ledger();
    let linked = match std::fs::hard_link(temporary, path) {
        Ok(()) => true,
        Err(error) if error.kind() == ErrorKind::AlreadyExists => false,
        Err(error) => return Err(error),
    };
    ledger.under_way.remove(temporary);
    ledger.finished += u64::from(linked);
    // It has its name, or is of no use: that a second one stays harms nothing.
    let _ = std::fs::remove_file(temporary);
    Ok(linked)
}

/// Removes a temporary file that is not wanted any more.
pub(crate) fn remove(temporary: &Path) {
    let mut ledger = ledger();
    // Nothing can be said from here, and the failure that led here is being said.
    let _ = std::fs::remove_file(temporary);
    ledger.under_way.remove(temporary);
}

/// How many files of this process took their final name.
pub fn finished() -> u64 {
    ledger().finished
}

/// Removes all temporary files under way, and lets none be begun or put in place from now on: the process is about to end. How
/// many files were finished.
pub fn abandon_all() -> u64 {
    let mut ledger = ledger();
    for temporary in std::mem::take(&mut ledger.under_way) {
        let _ = std::fs::remove_file(temporary);
    }
    let finished = ledger.finished;
    // Never released: whoever asks for it waits for the end.
    std::mem::forget(ledger);
    finished
}

/// Removes the temporary files in a folder that processes of this machine have abandoned. That one cannot be removed harms nothing.
pub(crate) fn clear_abandoned(folder: &Path, of: impl Fn(&str) -> bool) {
    let Some(here) = place() else { return };
    let entries = std::fs::read_dir(folder).into_iter().flatten().filter_map(std::result::Result::ok);
    for entry in entries {
        let name = entry.file_name();
        let author = name.to_str().and_then(Author::of);
        if author.is_some_and(|author| author.place == here && of(author.file) && is_gone(author.process)) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// What the name of a temporary file says.
#[derive(Debug, Eq, PartialEq)]
struct Author<'a> {
    file: &'a str,
    place: &'a str,
    process: u32,
}

impl<'a> Author<'a> {
    fn of(name: &'a str) -> Option<Self> {
        let (file, author) = name.strip_prefix('.')?.strip_suffix(".tmp")?.rsplit_once('.')?;
        let (author, number) = author.rsplit_once('-')?;
        let (place, process) = author.rsplit_once('-')?;
        number.parse::<u64>().ok()?;
        Some(Self { file, place, process: process.parse().ok()? })
    }
}

fn name_of(path: &Path, number: u64) -> OsString {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}-{}-{number}.tmp", place().unwrap_or("x"), std::process::id()));
    name
}

/// Where process numbers mean what they mean here, as `MACHINE-SPACE`; `None` where that is not known.
fn place() -> Option<&'static str> {
    static PLACE: OnceLock<Option<String>> = OnceLock::new();
    let find = || {
        let machine = std::fs::read_to_string("/proc/sys/kernel/random/boot_id").ok()?;
        let machine: String = machine.chars().filter(char::is_ascii_hexdigit).take(16).collect();
        // `pid:[4026531836]`
        let space = std::fs::read_link("/proc/self/ns/pid").ok()?;
        let space: String = space.to_str()?.chars().filter(char::is_ascii_digit).collect();
        (machine.len() == 16 && !space.is_empty()).then(|| format!("{machine}-{space}"))
    };
    PLACE.get_or_init(find).as_deref()
}

/// Whether no process of this space has a number.
#[cfg(unix)]
fn is_gone(process: u32) -> bool {
    let number = i32::try_from(process).ok().and_then(rustix::process::Pid::from_raw);
    // Any other answer, such as that it belongs to another user, is one of a process.
    number.is_some_and(|number| rustix::process::test_kill_process(number) == Err(rustix::io::Errno::SRCH))
}

#[cfg(not(unix))]
fn is_gone(_: u32) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_says_who_has_begun_it() {
        let name = name_of(Path::new("out/part-00001.parquet"), 7).into_string().unwrap();
        let author = Author::of(&name).unwrap();
        assert_eq!((author.file, author.process), ("part-00001.parquet", std::process::id()));
        assert_eq!(Some(author.place), place().or(Some("x")));
        for other in ["part-00001.parquet", ".part-00001.parquet.1234.tmp", ".a.b-1-2-3.swp", ".a.tmp", "..tmp"] {
            assert_eq!(Author::of(other), None, "{other}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn only_what_is_known_to_be_abandoned_is_removed() {
        let folder = std::env::temp_dir().join(format!("mckibben-temporary-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let here = place().expect("Linux says on which machine it is");
        // A process that has ended and was waited for.
        let mut process = std::process::Command::new("true").spawn().unwrap();
        let gone = process.id();
        process.wait().unwrap();
        let alive = std::process::id();
        let other = format!("0000000000000000-{}", here.rsplit_once('-').unwrap().1);
        let kept = [
            format!(".part.{here}-{alive}-0.tmp"),
            format!(".part.{other}-{gone}-0.tmp"),
            format!(".part.x-{gone}-0.tmp"),
            format!(".other.{here}-{gone}-0.tmp"),
            format!(".part.{gone}.tmp"),
            ".part.swp".to_owned(),
            "part".to_owned(),
        ];
        let removed = [format!(".part.{here}-{gone}-0.tmp"), format!(".part.{here}-{gone}-12.tmp")];
        kept.iter().chain(&removed).for_each(|name| std::fs::write(folder.join(name), name).unwrap());
        clear_abandoned(&folder, |file| file == "part");
        assert!(kept.iter().all(|name| folder.join(name).exists()));
        assert!(removed.iter().all(|name| !folder.join(name).exists()));
        std::fs::remove_dir_all(folder).unwrap();
    }
}
