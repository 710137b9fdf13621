//! The folder of a sweep: one file for each part, and `sweep.json`, which says what they are parts of.
//!
//! A part appears whole, by renaming, and is never touched again: a process that is killed loses the parts under way and
//! no other, and whoever starts it again goes on with what is missing. `sweep.json` holds the sweep in a form in which
//! equal sweeps are equal texts, so that the parts of two sweeps never come together.

use super::plan::Plan;
use crate::failure::Failure;
use crate::output;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use std::fs::File;
use std::path::{Path, PathBuf};

/// The name of the file that says what the folder holds.
const MANIFEST: &str = "sweep.json";

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
        let told = |name: &str, what: &str| {
            let (here, there) = (&self.0[name], &other[name]);
            (here != there).then(|| format!("{what} {there} there and {here} here"))
        };
        let lines = |value: &serde_json::Value| -> Vec<String> {
            let lines = value["sweep"].as_array().cloned().unwrap_or_default();
            lines.iter().map(|line| line.as_str().unwrap_or_default().to_owned()).collect()
        };
        told("mckibben", "the version of mckibben is")
            .or_else(|| {
                let (here, there) = (lines(&self.0), lines(other));
                let at = here.iter().zip(&there).position(|(a, b)| a != b).unwrap_or(here.len().min(there.len()));
                let line = |of: &[String]| of.get(at).map_or("nothing".to_owned(), |line| format!("`{}`", line.trim()));
                (here != there).then(|| format!("{} stands there in place of {}", line(&there), line(&here)))
            })
            .or_else(|| told("part_rows", "the rows of a part are"))
            .unwrap_or_else(|| "its sweep.json differs".to_owned())
    }
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
        let failed = |error: std::io::Error| Failure::output(path, error);
        std::fs::create_dir_all(path).map_err(failed)?;
        let folder = Self { path: path.to_owned() };
        let file = path.join(MANIFEST);
        if let Ok(text) = std::fs::read_to_string(&file) {
            let found: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
            if found == manifest.0 {
                return Ok(folder);
            }
            return Err(Failure::input(
                format!("`{}` holds another sweep: {}", path.display(), manifest.difference(&found)),
                "give --output a folder of its own, or delete this one",
            ));
        }
        let foreign = std::fs::read_dir(path).map_err(failed)?.filter_map(Result::ok);
        // Hidden files are those of the system, and what a killed process left.
        let mut foreign =
            foreign.map(|entry| entry.file_name()).filter(|name| !name.to_string_lossy().starts_with('.'));
        if let Some(name) = foreign.next() {
            return Err(Failure::input(
                format!("`{}` is no folder of a sweep: it holds `{}`", path.display(), name.to_string_lossy()),
                "give --output a folder that is empty or not there yet, or a name with .csv or .parquet at its end",
            ));
        }
        output::write(&file, manifest.text().as_bytes())?;
        folder.clear_remains(MANIFEST);
        Ok(folder)
    }

    /// Where a part stands when it is finished.
    pub fn part(&self, part: u64) -> PathBuf {
        self.path.join(name(part))
    }

    /// How many runs of a part failed, if the part is finished.
    ///
    /// # Errors
    /// [`Failure::input`] when there is a file in its place that is not this part.
    pub fn finished(&self, plan: &Plan, part: u64) -> Result<Option<u64>, Failure> {
        let path = self.part(part);
        let Ok(file) = File::open(&path) else { return Ok(None) };
        let rows = plan.rows_of(part);
        let expected = [(PART, part.to_string()), (ROWS, format!("{}..{}", rows.start, rows.end))];
        let failed = || {
            let reader = SerializedFileReader::new(file).ok()?;
            let notes = reader.metadata().file_metadata().key_value_metadata()?.clone();
            let value = |key: &str| notes.iter().find(|pair| pair.key == key)?.value.clone();
            let is_this = expected.iter().all(|(key, expected)| value(key).as_ref() == Some(expected));
            value(FAILED)?.parse().ok().filter(|_| is_this)
        };
        failed().map(Some).ok_or_else(|| {
            let title = format!("`{}` is damaged or not part {part} of this sweep", path.display());
            Failure::input(title, "delete it, and what was in it will be done again")
        })
    }

    /// Removes what killed processes left of a part that is finished now.
    pub fn clear_remains_of(&self, part: u64) {
        self.clear_remains(&name(part));
    }

    /// Removes the temporary files of a file. That one cannot be removed harms nothing.
    fn clear_remains(&self, name: &str) {
        let beginning = format!(".{name}.");
        let entries = std::fs::read_dir(&self.path).into_iter().flatten().filter_map(Result::ok);
        for entry in entries {
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.starts_with(&beginning) && name.ends_with(".tmp") {
                let _ = std::fs::remove_file(entry.path());
            }
        }
    }
}

fn name(part: u64) -> String {
    format!("part-{part:05}.parquet")
}
