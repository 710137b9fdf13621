//! The folder of a sweep: one file for each part, and `sweep.json`, which says what they are parts of.
//!
//! A part appears whole, by renaming, and is never touched again: a process that is killed loses the parts under way and
//! no other, and a user who starts it again goes on with what is missing, once each part that is there was held to its checksum.
//! `sweep.json` holds the sweep in a form in which equal sweeps are equal texts, so that the parts of two sweeps never come
//! together. It is created once, whole, by whichever process comes first; all others read it. So any number of processes, on any
//! number of machines, may begin on one folder at once.
//!
//! Checked by the program's `tests/sweep.rs` and `tests/sweep_folder.rs`.

use super::plan::Plan;
use super::warned::{WARNINGS, WarnedRuns};
use crate::failure::Failure;
use crate::quantities::count;
use crate::table::{Seal, seal};
use crate::{output, temporary};
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use std::fs::File;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The name of the file that says what the folder holds.
const MANIFEST: &str = "sweep.json";

/// How often, and at which intervals, a manifest is looked for that another process has made: a network file system may show it
/// late, and one without hard links shows it before its content.
const LOOKS: u32 = 100;
const INTERVAL: Duration = Duration::from_millis(50);

/// Key of a part's metadata: its index.
pub const PART: &str = "mckibben.part";
/// Key of a part's metadata: its rows as `FIRST..END`.
pub const ROWS: &str = "mckibben.rows";
/// Key of a part's metadata: how many of its runs failed.
pub const FAILED: &str = "mckibben.failed";

/// What a sweep is: equal for equal sweeps only.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Manifest(serde_json::Value);

impl Manifest {
    /// The manifest of a sweep whose canonical text is `text`, recorded as `record` says.
    pub fn new(plan: &Plan, text: &str) -> Self {
        Self(serde_json::json!({
            "mckibben": env!("CARGO_PKG_VERSION"),
            "runs": plan.rows,
            "part_rows": plan.part_rows,
            "parts": plan.parts(),
            "sweep": text.lines().collect::<Vec<_>>(),
        }))
    }

    fn text(&self) -> String {
        format!("{:#}\n", self.0)
    }

    /// In what another manifest differs, in words.
    fn difference(&self, other: &serde_json::Value) -> String {
        let difference_of = |name: &str, what: &str| {
            let (here, there) = (&self.0[name], &other[name]);
            (here != there).then(|| format!("{what} {there} there and {here} here"))
        };
        let lines = |value: &serde_json::Value| -> Vec<String> {
            let lines = value["sweep"].as_array().cloned().unwrap_or_default();
            lines.iter().map(|line| line.as_str().unwrap_or_default().to_owned()).collect()
        };
        difference_of("mckibben", "the version of mckibben is")
            .or_else(|| {
                let (here, there) = (lines(&self.0), lines(other));
                let at = here.iter().zip(&there).position(|(a, b)| a != b).unwrap_or(here.len().min(there.len()));
                let line = |of: &[String]| of.get(at).map_or("nothing".to_owned(), |line| format!("`{}`", line.trim()));
                (here != there).then(|| format!("{} stands there in place of {}", line(&there), line(&here)))
            })
            .or_else(|| difference_of("part_rows", "the rows of a part are"))
            .unwrap_or_else(|| "its sweep.json differs".to_owned())
    }
}

/// What is known of a part that is finished.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct FinishedPart {
    /// How many of its runs failed.
    pub failed: u64,
    /// The warnings of its runs.
    pub warned: WarnedRuns,
}

/// A folder that belongs to a sweep.
#[derive(Clone, Debug)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Makes the folder of a sweep, or takes up one that holds the same sweep.
    ///
    /// # Errors
    /// [`Failure::input`] when it holds something else, [`Failure::output`] when it cannot be written to.
    pub fn open(path: &Path, manifest: &Manifest) -> Result<Self, Failure> {
        std::fs::create_dir_all(path).map_err(|error| Failure::output(path, error))?;
        let folder = Self { path: path.to_owned() };
        let file = path.join(MANIFEST);
        if !file.exists() {
            if let Some(name) = folder.foreign()? {
                return Err(Failure::input(
                    format!("`{}` is no folder of a sweep: it holds `{name}`", path.display()),
                    "give a folder that is empty or not there yet, or a name with .csv, .parquet or .mat at its end",
                ));
            }
            if output::write_new(&file, manifest.text().as_bytes())? {
                return Ok(folder);
            }
        }
        let found = folder.manifest()?;
        if found != manifest.0 {
            return Err(Failure::input(
                format!("`{}` holds another sweep: {}", path.display(), manifest.difference(&found)),
                "give a folder of its own, or delete this one",
            ));
        }
        folder.clear_remains();
        Ok(folder)
    }

    /// The manifest that is there, or is about to be.
    fn manifest(&self) -> Result<serde_json::Value, Failure> {
        let path = self.path.join(MANIFEST);
        for _ in 0..LOOKS {
            let refused = match std::fs::read(&path) {
                Ok(bytes) => serde_json::from_slice(&bytes).map_err(|error| (error.to_string(), error.is_eof())),
                Err(error) => Err((error.to_string(), error.kind() == ErrorKind::NotFound)),
            };
            match refused {
                Ok(found) => return Ok(found),
                Err((why, false)) => return Err(self.unreadable(&why)),
                Err((_, true)) => std::thread::sleep(INTERVAL),
            }
        }
        Err(self.unreadable("it has no content"))
    }

    fn unreadable(&self, why: &str) -> Failure {
        let title = format!("`{}` cannot be read: {why}", self.path.join(MANIFEST).display());
        Failure::input(title, "give a folder of its own, or delete this one")
    }

    /// The name of something in the folder that is of no sweep; a sweep that another process has begun meanwhile is none.
    fn foreign(&self) -> Result<Option<String>, Failure> {
        // Hidden files are those of the system, and temporary ones.
        let names = self.names().map_err(|error| Failure::output(&self.path, error))?;
        let mut foreign = names.iter().filter(|name| !name.starts_with('.'));
        // The manifest is older than any part; a listing of a network file system may know it before the file does.
        let is_sweep = names.iter().any(|name| name == MANIFEST);
        Ok(foreign.next().filter(|_| !is_sweep && !self.path.join(MANIFEST).exists()).cloned())
    }

    fn names(&self) -> std::io::Result<Vec<String>> {
        let entries = std::fs::read_dir(&self.path)?.filter_map(Result::ok);
        Ok(entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect())
    }

    /// Where a part stands when it is finished.
    pub fn part(&self, part: u64) -> PathBuf {
        self.path.join(name(part))
    }

    /// What is known of the runs of a part, if the part is finished. One without a checksum, or without its warnings, of an earlier version, is not.
    ///
    /// # Errors
    /// [`Failure::input`] when there is a file in its place that is damaged or not this part.
    pub fn finished(&self, plan: &Plan, part: u64) -> Result<Option<FinishedPart>, Failure> {
        let path = self.part(part);
        let refused = |what: &str| {
            let title = format!("`{}` is {what}", path.display());
            Failure::input(title, "delete it, and what was in it will be done again")
        };
        let file = match File::open(&path) {
            Ok(file) => file,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(refused(&format!("there and cannot be read: {error}"))),
        };
        match read_part(file, plan, part) {
            Found::Whole(known) => Ok(Some(known)),
            Found::Unfinished => Ok(None),
            Found::Damaged => Err(refused(&format!("damaged or not part {part} of this sweep"))),
        }
    }

    /// Writes a part that was computed elsewhere, whole, once its bytes were held to what [`Folder::finished`] asks of a part.
    ///
    /// # Errors
    /// [`Failure::input`] when the bytes are not this part, [`Failure::output`] when it cannot be written.
    pub fn put(&self, plan: &Plan, part: u64, bytes: &[u8]) -> Result<(), Failure> {
        plan.check_part(part)?;
        let path = self.part(part);
        let copy = || {
            let mut copy = tempfile::tempfile()?;
            copy.write_all(bytes)?;
            Ok::<_, std::io::Error>(copy)
        };
        let copy = copy().map_err(|error| Failure::output(&path, error))?;
        match read_part(copy, plan, part) {
            Found::Whole(_) => output::write(&path, bytes),
            Found::Unfinished | Found::Damaged => Err(Failure::input(
                format!("`bytes`, {} of them, are not part {part} of this sweep, or not the whole of it", bytes.len()),
                format!("give what `part({part})` of this sweep returned; nothing was written"),
            )),
        }
    }

    /// What stays in the folder when its sweep is ended before it is done, in words.
    pub fn stays(&self, plan: &Plan) -> String {
        let is_part = |name: &&String| name.starts_with("part-") && name.ends_with(".parquet");
        let there = self.names().unwrap_or_default().iter().filter(is_part).count() as u64;
        let (parts, folder) = (count(plan.parts()), self.path.display());
        match there {
            0 => format!("none of {parts} parts in `{folder}` is finished"),
            _ if there == plan.parts() => format!("all {parts} parts are finished and stay in `{folder}`"),
            _ => {
                let there = count(there);
                format!(
                    "{there} of {parts} parts are finished and stay in `{folder}`; the same command goes on with the others"
                )
            }
        }
    }

    /// Removes what processes of this machine that are gone have left of parts and of the manifest.
    pub fn clear_remains(&self) {
        temporary::clear_abandoned(&self.path, |name| name == MANIFEST || name.starts_with("part-"));
    }
}

/// What a file is.
enum Found {
    Whole(FinishedPart),
    /// Without a checksum, or without its warnings: of an earlier version.
    Unfinished,
    /// Damaged, or another file.
    Damaged,
}

/// Holds a file to its checksum, and to what a part says of itself.
fn read_part(mut file: File, plan: &Plan, part: u64) -> Found {
    match seal(&mut file) {
        Ok(Seal::Whole) => {}
        Ok(Seal::Missing) => return Found::Unfinished,
        Ok(Seal::Damaged) | Err(_) => return Found::Damaged,
    }
    let rows = plan.rows_of(part);
    let expected = [(PART, part.to_string()), (ROWS, format!("{}..{}", rows.start, rows.end))];
    let found = || {
        let reader = SerializedFileReader::new(file).ok()?;
        let notes = reader.metadata().file_metadata().key_value_metadata()?.clone();
        let value = |key: &str| notes.iter().find(|pair| pair.key == key)?.value.clone();
        let is_this = expected.iter().all(|(key, expected)| value(key).as_ref() == Some(expected));
        let Some(warned) = value(WARNINGS) else { return Some(Found::Unfinished).filter(|_| is_this) };
        let (failed, warned) = (value(FAILED)?.parse().ok()?, WarnedRuns::from_json(&warned)?);
        Some(Found::Whole(FinishedPart { failed, warned })).filter(|_| is_this)
    };
    found().unwrap_or(Found::Damaged)
}

fn name(part: u64) -> String {
    format!("part-{part:05}.parquet")
}
