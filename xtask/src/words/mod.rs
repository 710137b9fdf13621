//! The words of the field: documentation, messages, comments, names in the code and names of files use one word for one thing.
//!
//! Each [`Entry`] is a word or phrase that readers from the field do not understand at once, and the one to write instead. Matching
//! is by whole words, whatever the case and the line breaks; an identifier has the words between its underscores and capitals.
//! Code between backticks, addresses of links, keys with their values and identifiers alone in a string are left out.

mod source;
mod text;

use std::fmt::Write;
use std::path::{Path, PathBuf};
use text::{Text, numbered, places, plain};

/// A word or phrase that is not used.
struct Entry {
    /// The phrase in lower case, its words separated by single spaces.
    phrase: &'static str,
    /// What to write instead.
    instead: &'static str,
}

const fn entry(phrase: &'static str, instead: &'static str) -> Entry {
    Entry { phrase, instead }
}

const ENTRIES: &[Entry] = &[
    entry("anew", "again, or reset"),
    entry("asked of", "requested, or commanded"),
    entry("by themselves", "individually, or separately"),
    entry("cannot tell", "cannot determine, or not identifiable"),
    entry("courses", "time series, or trajectories"),
    entry("do not tell", "not identifiable"),
    entry("everybody", "all users, or all solvers"),
    entry("far end", "which end: inlet, outlet, or the load's"),
    entry("foretell", "predict"),
    entry("foretold", "predicted"),
    entry("glide", "advance"),
    entry("glides", "advances"),
    entry("hear", "receive"),
    entry("heard", "received, or handled"),
    entry("hears", "receives"),
    entry("himself", "the user, or the caller"),
    entry("nobody", "no user, or no process"),
    entry("one's own", "custom"),
    entry("passage", "flow path, or port"),
    entry("passages", "flow paths, or ports"),
    entry("plumbing", "air network"),
    entry("portrait", "trajectory plot"),
    entry("rubbing", "sliding state, or friction"),
    entry("rubs", "slides, or has friction"),
    entry("somebody", "users, or the caller"),
    entry("sought", "unknown, or estimated"),
    entry("surroundings", "atmosphere"),
    entry("tallies", "statistics, or counts"),
    entry("tally", "statistics, or counts"),
    entry("tells", "prints, reports, or determines"),
    entry("tenable", "positivity-preserving"),
    entry("tether", "series elastic coupling"),
    entry("tethered", "coupled in series"),
    entry("tethers", "series elastic couplings"),
    entry("to the last bit", "bit-identical"),
    entry("told", "commanded, printed, or reported"),
    entry("turned round", "inverted"),
    entry("unheard", "pending"),
    entry("untaut", "taut-end"),
    entry("whoever", "a caller that, or its owner"),
];

/// How no summary of a doc comment or docstring begins: it stands alone in an index.
const OPENING: &str = "the same";

/// Refuses words of the list in the repository.
pub(crate) fn check(root: &Path) -> Result<(), String> {
    let mut found = String::new();
    for path in files(root)? {
        let text = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let name = path.strip_prefix(root).unwrap_or(&path).to_string_lossy().replace('\\', "/");
        for (line, phrase, instead) in hits(&name, &text) {
            let _ = writeln!(found, "{name}:{line}: \"{phrase}\": {instead}");
        }
    }
    if found.is_empty() {
        return Ok(());
    }
    eprint!("{found}");
    Err(format!("{} words that readers do not know (xtask/src/words/mod.rs)", found.lines().count()))
}

/// The files that are read: documentation, and source of every kind.
fn files(root: &Path) -> Result<Vec<PathBuf>, String> {
    let mut files = Vec::new();
    let is_read = |name: &str| name.starts_with("README") || name == "CHANGELOG.md";
    files.extend(
        list(root)?
            .into_iter()
            .filter(|path| path.is_file() && path.file_name().is_some_and(|name| is_read(&name.to_string_lossy()))),
    );
    collect(&root.join("docs"), "md", &mut files)?;
    for folder in ["python/mckibben", "python/tests", "examples/python", "benches/python"] {
        collect(&root.join(folder), "py", &mut files)?;
    }
    for folder in ["benches/src", "xtask/src"] {
        collect(&root.join(folder), "rs", &mut files)?;
    }
    for folder in list(&root.join("crates"))?.into_iter().filter(|path| path.is_dir()) {
        collect(&folder, "rs", &mut files)?;
        files.extend(Some(folder.join("README.md")).filter(|path| path.is_file()));
    }
    // The list itself.
    files.retain(|path| !path.starts_with(root.join("xtask/src/words")));
    files.sort();
    Ok(files)
}

fn list(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let listed = std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    Ok(listed.filter_map(|entry| Some(entry.ok()?.path())).collect())
}

fn collect(folder: &Path, ending: &str, files: &mut Vec<PathBuf>) -> Result<(), String> {
    for path in list(folder)? {
        if path.is_dir() {
            collect(&path, ending, files)?;
        } else if path.extension().is_some_and(|of| of == ending) {
            files.push(path);
        }
    }
    Ok(())
}

/// Line, phrase and what to write instead, in the order of the lines.
fn hits(path: &str, text: &str) -> Vec<(usize, &'static str, &'static str)> {
    let mut texts = match path.rsplit('.').next() {
        Some("rs") => source::rust(text),
        Some("py") => source::python(text),
        _ => vec![Text { lines: numbered(text), ..Text::default() }],
    };
    texts.push(Text::of_name((1, path.to_owned())));
    let mut found = Vec::new();
    for text in &texts {
        let (words, lines) = plain(text);
        for entry in ENTRIES {
            let at = places(&words, entry.phrase);
            found.extend(at.map(|at| (lines[at], entry.phrase, entry.instead)));
        }
        if text.is_doc && places(&words, OPENING).next() == Some(0) {
            found.push((lines[0], OPENING, "a verb or a noun phrase that stands alone"));
        }
    }
    found.sort_unstable();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(name: &str, text: &str) -> Vec<(usize, &'static str)> {
        hits(name, text).into_iter().map(|(line, phrase, _)| (line, phrase)).collect()
    }

    #[test]
    fn a_planted_word_is_located_in_its_line() {
        let page = "# Air\n\nHeat goes to the\nsurroundings; `passage` is a key, [this](a/passage.rs) a file.\nA law turned\nround.\n";
        assert_eq!(found("docs/air.md", page), [(4, "surroundings"), (5, "turned round")]);
        let source = "//! A Passage.\n\n/// The same\n/// valve.\nfn a<'a>() -> &'a str {\n    let c = '\"';\n    \"is set \\\n     anew\"\n}\n";
        assert_eq!(found("crates/a/src/a.rs", source), [(1, "passage"), (3, "the same"), (8, "anew")]);
        let raw = "const A: &[u8] = br#\"\nsays \"somebody\" else\"#;\n/// Of nobody.\nstruct B;\n";
        assert_eq!(found("crates/a/src/a.rs", raw), [(2, "somebody"), (3, "nobody")]);
        let python = "\"\"\"The same\n\nIt is set anew.\n\"\"\"\nraise E(f'{told} of nobody')\n";
        assert_eq!(found("python/mckibben/a.py", python), [(1, "the same"), (3, "anew"), (5, "nobody")]);
    }

    #[test]
    fn comments_and_names_are_read() {
        let source = "// Set anew\nfn with_passage(it: &Told) { it.a_tally() } // It is turned\n// round.\n/* heard */\nuse a::anew;\n";
        let expected = [(1, "anew"), (2, "passage"), (2, "tally"), (2, "told"), (2, "turned round"), (5, "anew")];
        assert_eq!(found("crates/a/tests/a.rs", source), expected);
        assert_eq!(found("xtask/src/a.rs", "fn it_is_turned_round() {}\n"), [(1, "turned round")]);
        assert_eq!(
            found("python/tests/a.py", "# somebody\nsought = HeardOf()\n"),
            [(1, "somebody"), (2, "heard"), (2, "sought")]
        );
        assert_eq!(found("crates/a/src/read/told.rs", ""), [(1, "told")]);
    }

    #[test]
    fn a_clean_text_passes() {
        let page = "The atmosphere. `anew`\n\n```rust\nlet passage = anew();\n```\nOn the same page: passage_of.\n";
        assert_eq!(found("docs/air.md", page), []);
        let source = "/// Two of the same kind.\nfn valve() {\n    let key = \"passage\";\n    // `told`: see.\n}\n";
        assert_eq!(found("crates/a/src/a.rs", source), []);
        assert_eq!(found("python/mckibben/a.py", "\"\"\"Return the same.\"\"\"\nestimated = 'anew'\n"), []);
    }

    #[test]
    fn the_repository_has_the_words_of_the_field() {
        assert_eq!(check(&crate::steps::root()), Ok(()));
    }
}
