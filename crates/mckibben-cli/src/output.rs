//! Files that are whole or not there.
//!
//! A file is written under another name in the same folder and then renamed, so that a reader never meets half of it,
//! an older file stays as it was when something fails, and a killed process leaves at most a hidden temporary file.
//!
//! Checked by the tests below and by `tests/simulate.rs`.

use crate::failure::Failure;
use std::ffi::OsString;
use std::fs::File;
use std::io::{BufWriter, Write};
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
    write_with(path, |out| out.write_all(bytes))
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
    let beside = || Some(folder.canonicalize().ok()?.join(path.file_name()?));
    path.canonicalize().ok().or_else(beside).unwrap_or_else(|| path.to_path_buf())
}

/// A file under way: it takes its name when it is committed, and is removed when it is dropped before.
#[derive(Debug)]
pub struct Pending {
    path: PathBuf,
    temporary: PathBuf,
    writer: Option<BufWriter<File>>,
    nothing: std::io::Sink,
}

impl Pending {
    /// Begins a file, so that a folder that cannot be written to is known before any work is done.
    ///
    /// # Errors
    /// [`Failure::output`] when the folder cannot be written to, or `path` is a folder itself.
    pub fn create(path: &Path) -> Result<Self, Failure> {
        let failed = |error: std::io::Error| Failure::output(path, error);
        // A link stays a link: what it points to is replaced.
        let path = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
        let path = path.as_path();
        let Some(file_name) = path.file_name() else {
            return Err(Failure::output(path, "the path names no file"));
        };
        // Renaming over a device or a pipe would put a plain file in its place.
        if std::fs::metadata(path).is_ok_and(|there| !there.is_file()) {
            return Err(Failure::output(path, "there is something that is no plain file"));
        }
        let mut name = OsString::from(".");
        name.push(file_name);
        name.push(format!(".{}.tmp", std::process::id()));
        let temporary = path.with_file_name(name);
        let file = File::create(&temporary).map_err(failed)?;
        Ok(Self { path: path.to_path_buf(), temporary, writer: Some(BufWriter::new(file)), nothing: std::io::sink() })
    }

    /// Where the file will stand.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where its bytes go.
    pub fn writer(&mut self) -> &mut (dyn Write + Send) {
        match &mut self.writer {
            Some(writer) => writer,
            None => &mut self.nothing,
        }
    }

    /// Gives the file its name; what stood there before is replaced in the same instant.
    ///
    /// # Errors
    /// [`Failure::output`] when the last bytes cannot be written or the file cannot be renamed.
    pub fn commit(mut self) -> Result<(), Failure> {
        let Some(writer) = self.writer.take() else { return Ok(()) };
        let done = writer
            .into_inner()
            .map_err(|error| error.into_error())
            .and_then(|file| file.sync_all())
            .and_then(|()| std::fs::rename(&self.temporary, &self.path));
        if let Err(error) = done {
            // The first error is the one worth telling.
            let _ = std::fs::remove_file(&self.temporary);
            return Err(Failure::output(&self.path, error));
        }
        Ok(())
    }
}

impl Write for Pending {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.writer().write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.writer().flush()
    }
}

impl Drop for Pending {
    fn drop(&mut self) {
        if self.writer.take().is_some() {
            // Nothing can be told from here, and the failure that led here has been told.
            let _ = std::fs::remove_file(&self.temporary);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder of its own for a test.
    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("mckibben-output-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        folder
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
