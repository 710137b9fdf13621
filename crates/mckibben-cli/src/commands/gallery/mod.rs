//! `mckibben gallery`: a page with a figure of every scenario file under a folder.
//!
//! | file | its idea |
//! |---|---|
//! | `picture` | which figure a file gets, and the command that draws it |
//! | `page` | the page |
//!
//! Beside the page stand the figures as SVG and the files' texts, in the folders of the files. A file that fails has its
//! message on the page in place of a figure; a study of `mckibben identify` is no scenario and is left out. Symbolic links are
//! followed within the folder that is shown, and within the one that is written to, and no further. Checked by
//! `tests/gallery.rs`.

mod page;
mod picture;

use crate::terminal;
use mckibben_run::failure::Failure;
use mckibben_run::output;
use mckibben_run::progress::Progress;
use mckibben_run::quantities::counted;
use mckibben_scenario::Style;
use page::{Entry, Group};
use std::path::{Path, PathBuf};

/// Arguments of `mckibben gallery`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  mckibben gallery
  mckibben gallery studies --output studies-gallery

A file is simulated. It gets the curves of `mckibben curves` or the plot of `mckibben linearize` where that is the first \
command that its comments name, and the figure of `mckibben sweep` where it has a sweep of at most 100 runs. A prescribed \
motion is drawn as tension over length. A symbolic link to a file outside of the folder is left out.

Exit codes:
  0  done
  2  there is no such folder, or no scenario file in it; nothing was written
  3  a file failed; the page is written and shows why
  4  the page or a figure could not be written")]
pub struct GalleryArguments {
    /// The folder whose scenario files are shown, with those below it.
    #[arg(value_name = "FOLDER", default_value = "examples")]
    pub folder: PathBuf,
    /// The folder for the page; it is made if it is not there.
    #[arg(short, long, value_name = "DIR", default_value = "gallery")]
    pub output: PathBuf,
}

/// Draws every scenario file and writes the page.
///
/// # Errors
/// There is nothing to show, a file failed, or something could not be written.
pub fn run(arguments: &GalleryArguments) -> Result<(), Failure> {
    let Scenarios { files, outside } = Scenarios::under(&arguments.folder)?;
    if outside > 0 {
        let links = if outside == 1 {
            "1 symbolic link that leads".to_owned()
        } else {
            format!("{outside} symbolic links that lead")
        };
        terminal::print_error(&format!("left out: {links} out of `{}`\n", arguments.folder.display()));
    }
    std::fs::create_dir_all(&arguments.output).map_err(|error| Failure::output(&arguments.output, error))?;
    let mut groups: Vec<Group> = Vec::new();
    let progress = Progress::begin("drawing", Some(files.len() as u64));
    for (file, done) in files.iter().zip(1..) {
        let (group, entry) = shown(arguments, file)?;
        match groups.last_mut().filter(|last| last.name == group) {
            Some(last) => last.entries.push(entry),
            None => groups.push(Group { name: group, entries: vec![entry] }),
        }
        progress.at(done);
    }
    drop(progress);
    // The page comes last, so that where it stands everything that it refers to stands too.
    let path = arguments.output.join("index.html");
    write(arguments, &path, page::html(&arguments.folder.display().to_string(), &groups).as_bytes())?;
    let entries = groups.iter().flat_map(|group| &group.entries);
    let failed: Vec<&str> = entries.filter(|entry| entry.drawn.is_err()).map(|entry| entry.file.as_str()).collect();
    let drawn = counted((files.len() - failed.len()) as u64, "figure");
    terminal::print(&terminal::wrote(&path, &format!(", {drawn}")))?;
    if failed.is_empty() {
        return Ok(());
    }
    let (count, names) = (failed.len(), failed.join(", "));
    let all = counted(files.len() as u64, "file");
    Err(Failure::stopped(format!("{count} of {all} failed: {names}; {} shows why", path.display())))
}

/// The scenario files of a folder.
struct Scenarios {
    /// Relative to the folder: first its own, then those of each folder in it, by name.
    files: Vec<PathBuf>,
    /// How many symbolic links to other places were left out.
    outside: usize,
}

impl Scenarios {
    fn under(folder: &Path) -> Result<Self, Failure> {
        let unreadable = |error: std::io::Error| {
            let title = format!("the folder `{}` could not be read: {error}", folder.display());
            Failure::input(title, "give a folder that holds scenario files, such as the `examples` of the repository")
        };
        let root = folder.canonicalize().map_err(unreadable)?;
        let (mut files, mut outside) = (Vec::new(), 0);
        let mut open = vec![PathBuf::new()];
        while let Some(inner) = open.pop() {
            for entry in std::fs::read_dir(folder.join(&inner)).map_err(unreadable)? {
                let entry = entry.map_err(unreadable)?;
                let path = inner.join(entry.file_name());
                let kind = entry.file_type().map_err(unreadable)?;
                if kind.is_dir() {
                    open.push(path);
                    continue;
                }
                if path.extension().is_none_or(|ending| ending != "toml") {
                    continue;
                }
                match entry.path().canonicalize() {
                    // What a link leads to would be published, wherever it is.
                    Ok(target) if kind.is_symlink() && !target.starts_with(&root) => outside += 1,
                    Ok(target) if !target.is_file() || is_study(&target) => {}
                    // A link to nothing is one that fails.
                    _ => files.push(path),
                }
            }
        }
        if files.is_empty() {
            let title = format!("there is no scenario file (.toml) under `{}`", folder.display());
            return Err(Failure::input(title, "give a folder that holds some"));
        }
        files.sort_by(|a, b| (a.parent(), a.file_name()).cmp(&(b.parent(), b.file_name())));
        Ok(Self { files, outside })
    }
}

/// Whether a file is a study of `mckibben identify`, which is no scenario.
fn is_study(path: &Path) -> bool {
    std::fs::read_to_string(path).is_ok_and(|text| text.lines().any(|line| line.trim_end() == "[study]"))
}

/// Draws a file and writes what the page refers to; the name of its group and what the page shows.
fn shown(arguments: &GalleryArguments, file: &Path) -> Result<(String, Entry), Failure> {
    let source = arguments.folder.join(file);
    let text = std::fs::read(&source).map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).unwrap_or_default();
    let target = arguments.output.join(file);
    let folder = target.parent().unwrap_or(&arguments.output);
    within(arguments, folder)?;
    std::fs::create_dir_all(folder).map_err(|error| Failure::output(folder, error))?;
    write(arguments, &target.with_extension("toml.txt"), text.as_bytes())?;
    let drawn = picture::of(&source, &text);
    let drawn = match drawn {
        Ok(picture) => {
            write(arguments, &target.with_extension("svg"), picture.svg.as_bytes())?;
            Ok((picture.command, picture.note))
        }
        Err(failure) => Err(failure.render(Style::Plain)),
    };
    let group = file.parent().map(|parent| parent.to_string_lossy().into_owned()).unwrap_or_default();
    let file = file.to_string_lossy().into_owned();
    Ok((group, Entry { title: page::first_sentence(&text).unwrap_or_else(|| file.clone()), file, drawn }))
}

/// Writes a file of the page.
fn write(arguments: &GalleryArguments, path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    within(arguments, path)?;
    output::write(path, bytes)
}

/// Refuses to write where a symbolic link leads out of the folder for the page.
fn within(arguments: &GalleryArguments, path: &Path) -> Result<(), Failure> {
    let there = path.ancestors().find(|place| place.is_symlink() || place.exists()).unwrap_or(path);
    // One of no target is as bad: it would be made there.
    let target = if there.exists() { there.canonicalize().ok() } else { None };
    let root = arguments.output.canonicalize().map_err(|error| Failure::output(&arguments.output, error))?;
    match target {
        Some(target) if target.starts_with(&root) => Ok(()),
        _ => Err(Failure::output(path, format!("a symbolic link leads out of `{}`", arguments.output.display()))),
    }
}
