//! Files that are whole or not there.
//!
//! A file is written under another name in the same folder and then renamed, so that a reader never meets half of it,
//! an older file stays as it was when something fails, and a killed process leaves at most a hidden temporary file, which
//! a later process clears. Every file of the program and of the Python package is written by this module.
//!
//! Checked by the tests below, and by those of the program, `tests/output.rs`.

use crate::failure::Failure;
use crate::temporary::Temporary;
pub use crate::temporary::{abandon_all, finished};
use std::fs::{File, OpenOptions};
use std::io::{BufWriter, Error, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Writes a whole file through `fill`, or nothing.
///
/// # Errors
/// [`Failure::output`] when the file cannot be made, `fill` fails, or the file cannot be put in place.
pub fn write_with<E: std::fmt::Display>(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> Result<(), E>,
) -> Result<(), Failure> {
    let mut pending = Pending::create(path)?;
    fill(pending.writer()).map_err(|error| Failure::output(path, error))?;
    pending.commit()
}

/// Writes a whole file from bytes, or nothing.
///
/// # Errors
/// As [`write_with`].
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    replace(path, bytes).map_err(|error| Failure::output(path, error))
}

/// Writes a whole file from bytes, or nothing; what stood there before is replaced.
pub fn replace(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut pending = Pending::begin(path)?;
    pending.write_all(bytes)?;
    pending.settle(Temporary::put)
}

/// Writes a whole file unless something of its name is there, and returns whether it did. Of several processes that try at once,
/// on whatever machines of a network file system, exactly one does.
///
/// # Errors
/// [`Failure::output`] when the file cannot be made.
pub fn write_new(path: &Path, bytes: &[u8]) -> Result<bool, Failure> {
    let made = || {
        let mut pending = Pending::begin(path)?;
        pending.write_all(bytes)?;
        match pending.settle(Temporary::put_new) {
            Ok(is_first) => Ok(is_first),
            // Where a file cannot be put in place without replacing, its name comes before its content, and a reader may have to
            // wait for it.
            Err(_) => match OpenOptions::new().write(true).create_new(true).open(path) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => Ok(false),
                Err(error) => Err(error),
                Ok(mut file) => {
                    let written = file.write_all(bytes).and_then(|()| file.sync_all());
                    if written.is_err() {
                        let _ = std::fs::remove_file(path);
                    }
                    written.map(|()| true)
                }
            },
        }
    };
    made().map_err(|error| Failure::output(path, error))
}

/// Finds out whether a file could be written, so that this is known before work is done for it. Nothing stays behind.
///
/// # Errors
/// As [`Pending::create`].
pub fn probe(path: &Path) -> Result<(), Failure> {
    Pending::create(path).map(drop)
}

/// A path as it can be compared: with its links followed, as far as it exists.
pub fn settled(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let in_folder = || Some(folder.canonicalize().ok()?.join(path.file_name()?));
    path.canonicalize().ok().or_else(in_folder).unwrap_or_else(|| path.to_path_buf())
}

/// Refuses to write over what is read, and two files of one name; `help` says how to name them.
///
/// # Errors
/// [`Failure::input`], which names the file.
pub fn distinct<'a>(
    read: impl IntoIterator<Item = &'a Path>,
    written: impl IntoIterator<Item = &'a Path>,
    help: &str,
) -> Result<(), Failure> {
    let mut known: Vec<PathBuf> = read.into_iter().map(settled).collect();
    for path in written {
        let here = settled(path);
        if known.contains(&here) {
            let title = format!("two of the files that are to be read and written are the same: `{}`", path.display());
            return Err(Failure::input(title, help));
        }
        known.push(here);
    }
    Ok(())
}

/// A file under way: it takes its name when it is committed, and is removed when it is dropped before.
#[derive(Debug)]
pub struct Pending {
    path: PathBuf,
    temporary: Temporary,
    writer: BufWriter<File>,
}

impl Pending {
    /// Begins a file, so that a folder that cannot be written to is known before any work is done.
    ///
    /// # Errors
    /// [`Failure::output`] when the folder cannot be written to, or `path` is a folder itself.
    pub fn create(path: &Path) -> Result<Self, Failure> {
        Self::begin(path).map_err(|error| Failure::output(path, error))
    }

    fn begin(path: &Path) -> std::io::Result<Self> {
        // A link stays a link: what it points to is replaced.
        let path = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
        if path.file_name().is_none() {
            return Err(Error::new(ErrorKind::InvalidInput, "the path names no file"));
        }
        // Renaming over a device or a pipe would put a plain file in its place.
        if std::fs::metadata(&path).is_ok_and(|there| !there.is_file()) {
            return Err(Error::new(ErrorKind::AlreadyExists, "there is something that is no plain file"));
        }
        let (temporary, file) = Temporary::begin(&path)?;
        Ok(Self { path, temporary, writer: BufWriter::new(file) })
    }

    /// Where the file will stand.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where its bytes go.
    pub fn writer(&mut self) -> &mut (dyn Write + Send) {
        &mut self.writer
    }

    /// Gives the file its name; what stood there before is replaced in the same instant.
    ///
    /// # Errors
    /// [`Failure::output`] when the last bytes cannot be written or the file cannot be renamed.
    pub fn commit(self) -> Result<(), Failure> {
        let path = self.path.clone();
        self.settle(Temporary::put).map_err(|error| Failure::output(&path, error))
    }

    /// Brings the last bytes to the disk and puts the file in place.
    fn settle<T>(self, put: impl FnOnce(Temporary, &Path) -> std::io::Result<T>) -> std::io::Result<T> {
        let Self { path, temporary, writer } = self;
        // Open, and so locked, until it is in place.
        let file = writer.into_inner()?;
        file.sync_all()?;
        put(temporary, &path)
    }
}

impl Write for Pending {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.writer.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.writer.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A separate folder for a test.
    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("mckibben-output-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        folder
    }

    #[test]
    fn of_many_that_begin_a_file_one_does() {
        let folder = folder("new");
        let path = folder.join("sweep.json");
        let first: Vec<bool> = std::thread::scope(|scope| {
            let write = |text: String| write_new(&path, text.as_bytes()).unwrap();
            let threads: Vec<_> = (0..32).map(|of| scope.spawn(move || write(format!("{of:04}")))).collect();
            threads.into_iter().map(|thread| thread.join().unwrap()).collect()
        });
        assert_eq!(first.iter().filter(|is_first| **is_first).count(), 1);
        let winner = first.iter().position(|is_first| *is_first).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), format!("{winner:04}"));
        assert_eq!(names(&folder), ["sweep.json"]);
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn what_is_read_is_not_written_over() {
        let folder = folder("distinct");
        let (study, data) = (folder.join("study.toml"), folder.join("data.csv"));
        write(&study, b"").unwrap();
        write(&data, b"").unwrap();
        let name = folder.file_name().unwrap().to_owned();
        let around = folder.join("..").join(name).join("data.csv");
        let refuses = |written: &[&Path]| distinct([&*study, &*data], written.iter().copied(), "help").is_err();
        assert!(refuses(&[&around]) && refuses(&[&folder.join("new.csv"), &study]));
        assert!(refuses(&[&folder.join("new.csv"), &folder.join("new.csv")]));
        assert!(!refuses(&[&folder.join("new.csv"), &folder.join("newer.csv"), &folder.join("none/data.csv")]));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(&data, folder.join("link.csv")).unwrap();
            assert!(refuses(&[&folder.join("link.csv")]));
        }
        std::fs::remove_dir_all(folder).unwrap();
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn a_failure_keeps_the_older_file_and_leaves_nothing() {
        let folder = folder("failure");
        let path = folder.join("run.csv");
        write(&path, b"old").unwrap();
        let failure = write_with(&path, |out| {
            let _ = out.write_all(b"half of the ne");
            Err("the disk is on fire")
        });
        assert_eq!(failure.unwrap_err().code(), 4);
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(names(&folder), ["run.csv"]);
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_folder_is_no_file_and_a_probe_leaves_nothing() {
        let folder = folder("probe");
        assert_eq!(probe(&folder).unwrap_err().code(), 4);
        assert_eq!(probe(&folder.join("absent").join("run.csv")).unwrap_err().code(), 4);
        probe(&folder.join("run.csv")).unwrap();
        assert!(names(&folder).is_empty());
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link() {
        let folder = folder("link");
        let (link, target) = (folder.join("link.csv"), folder.join("target.csv"));
        write(&target, b"old").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        write(&link, b"new").unwrap();
        assert!(link.is_symlink());
        assert_eq!(std::fs::read(&target).unwrap(), b"new");
        std::fs::remove_dir_all(folder).unwrap();
    }
}
