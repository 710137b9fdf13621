//! The words of the field in public text: documentation pages, doc comments, docstrings and messages use one word for one thing.
//!
//! Each [`Entry`] is a word or phrase that readers from the field do not understand at once, and the one to write instead. Matching
//! is by whole words, whatever the case and the line breaks; code between backticks, addresses of links and identifiers alone in a
//! string are left out.

use std::fmt::Write;
use std::path::{Path, PathBuf};

/// A word or phrase that public text does not use.
struct Entry {
    /// The phrase in lower case, its words separated by single spaces.
    phrase: &'static str,
    /// What to write instead.
    instead: &'static str,
    /// Files and folders, as their paths begin, where the phrase may stand.
    except: &'static [&'static str],
}

const fn entry(phrase: &'static str, instead: &'static str) -> Entry {
    Entry { phrase, instead, except: &[] }
}

impl Entry {
    const fn except(self, except: &'static [&'static str]) -> Self {
        Self { except, ..self }
    }
}

const ENTRIES: &[Entry] = &[
    entry("anew", "again, or reset"),
    entry("asked of", "requested, or commanded"),
    entry("by themselves", "individually, or separately"),
    entry("cannot tell", "cannot determine, or not identifiable"),
    entry("courses", "time series, or trajectories"),
    entry("do not tell", "not identifiable"),
    entry("far end", "which end: inlet, outlet, or the load's"),
    entry("foretold", "predicted"),
    entry("himself", "the user, or the caller"),
    entry("nobody", "no user, or no process"),
    entry("one's own", "custom"),
    entry("passage", "flow path, or port")
        .except(&["docs/identify.md", "crates/mckibben-cli/src/commands/identify.rs"]),
    entry("passages", "flow paths, or ports"),
    entry("plumbing", "air network"),
    entry("portrait", "trajectory plot"),
    entry("rubbing", "sliding state, or friction"),
    entry("somebody", "users, or the caller"),
    entry("sought", "unknown, or estimated"),
    entry("surroundings", "atmosphere"),
    entry("tally", "statistics, or counts"),
    entry("tells", "prints, reports, or determines"),
    entry("tenable", "positivity-preserving"),
    entry("tether", "series elastic coupling"),
    entry("to the last bit", "bit-identical"),
    entry("told", "commanded, printed, or reported"),
    entry("turned round", "inverted"),
    entry("untaut", "taut-end"),
    entry("whoever", "a caller that, or its owner"),
];

/// How no summary of a doc comment or docstring begins: it stands alone in an index.
const OPENING: &str = "the same";

/// A stretch of public text in lines, each with its number.
#[derive(Default)]
struct Text {
    lines: Vec<(usize, String)>,
    /// Whether its first line is a summary.
    is_doc: bool,
}

/// Refuses words of the list in the public text of the repository.
pub(crate) fn check(root: &Path) -> Result<(), String> {
    let mut found = String::new();
    for path in public(root)? {
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
    Err(format!("{} words that readers do not know (xtask/src/words.rs)", found.lines().count()))
}

/// The files that hold public text.
fn public(root: &Path) -> Result<Vec<PathBuf>, String> {
    let mut files = Vec::new();
    let top = std::fs::read_dir(root).map_err(|error| format!("{}: {error}", root.display()))?;
    let is_read = |name: &str| name.starts_with("README") || name == "CHANGELOG.md";
    files.extend(
        top.filter_map(|entry| Some(entry.ok()?.path()))
            .filter(|path| path.is_file() && path.file_name().is_some_and(|name| is_read(&name.to_string_lossy()))),
    );
    collect(&root.join("docs"), "md", &mut files)?;
    collect(&root.join("python/mckibben"), "py", &mut files)?;
    let crates = std::fs::read_dir(root.join("crates")).map_err(|error| format!("crates: {error}"))?;
    for folder in crates.filter_map(|entry| Some(entry.ok()?.path())) {
        collect(&folder.join("src"), "rs", &mut files)?;
        files.extend(Some(folder.join("README.md")).filter(|path| path.is_file()));
    }
    files.sort();
    Ok(files)
}

fn collect(folder: &Path, ending: &str, files: &mut Vec<PathBuf>) -> Result<(), String> {
    let listed = std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    for path in listed.filter_map(|entry| Some(entry.ok()?.path())) {
        if path.is_dir() {
            collect(&path, ending, files)?;
        } else if path.extension().is_some_and(|of| of == ending) {
            files.push(path);
        }
    }
    Ok(())
}

/// Line, phrase and what to write instead, in the order of the lines.
fn hits(name: &str, text: &str) -> Vec<(usize, &'static str, &'static str)> {
    let texts = match name.rsplit('.').next() {
        Some("rs") => rust(text),
        Some("py") => python(text),
        _ => vec![Text { lines: numbered(text), is_doc: false }],
    };
    let excepted = |except: &[&str]| except.iter().any(|start| name.starts_with(start));
    let mut found = Vec::new();
    for text in texts {
        let (words, lines) = plain(&text);
        for entry in ENTRIES.iter().filter(|entry| !excepted(entry.except)) {
            found.extend(places(&words, entry.phrase).map(|at| (lines[at], entry.phrase, entry.instead)));
        }
        if text.is_doc && places(&words, OPENING).next() == Some(0) {
            found.push((lines[0], OPENING, "a verb or a noun phrase that stands alone"));
        }
    }
    found.sort_unstable();
    found
}

fn numbered(text: &str) -> Vec<(usize, String)> {
    text.lines().enumerate().map(|(at, line)| (at + 1, line.to_owned())).collect()
}

/// Where a phrase stands as whole words.
fn places<'a>(words: &'a str, phrase: &'a str) -> impl Iterator<Item = usize> + 'a {
    let is_word = |letter: char| letter.is_alphanumeric() || letter == '_';
    words
        .match_indices(phrase)
        .map(|(at, _)| at)
        .filter(move |at| !words[..*at].ends_with(is_word) && !words[at + phrase.len()..].starts_with(is_word))
}

/// The text in lower case with single spaces, and the line of each byte; without code, and without addresses of links.
fn plain(text: &Text) -> (String, Vec<usize>) {
    let (mut words, mut lines) = (String::new(), Vec::new());
    let (mut fence, mut is_code, mut address) = (None::<bool>, false, false);
    for (number, line) in &text.lines {
        if let Some(info) = line.trim_start().strip_prefix("```") {
            // Equations in a block of text are read, code is not.
            fence = if fence.is_some() { None } else { Some(info.trim() == "text") };
            is_code = false;
            continue;
        }
        if fence == Some(false) {
            continue;
        }
        if line.trim().is_empty() {
            (is_code, address) = (false, false);
        }
        let mut before = ' ';
        for letter in line.chars().chain([' ']) {
            if letter == '`' {
                is_code = !is_code;
            }
            if !is_code && before == ']' && letter == '(' {
                address = true;
            }
            let is_read = !is_code && !address && letter != '`';
            let is_spaced = letter.is_whitespace() && words.ends_with(' ');
            if is_read && !is_spaced {
                let letter = if letter.is_whitespace() { ' ' } else { letter };
                if !(words.is_empty() && letter == ' ') {
                    words.extend(letter.to_lowercase());
                    lines.resize(words.len(), *number);
                }
            }
            if address && letter == ')' {
                address = false;
            }
            before = letter;
        }
    }
    (words, lines)
}

/// Doc comments and string literals of Rust source; a literal of one word is a name.
fn rust(source: &str) -> Vec<Text> {
    let mut texts: Vec<Text> = Vec::new();
    let mut comment = Text { is_doc: true, ..Text::default() };
    let letters: Vec<char> = source.chars().collect();
    let (mut at, mut line) = (0, 1);
    let starts = |at: usize, with: &str| with.chars().enumerate().all(|(i, c)| letters.get(at + i) == Some(&c));
    while at < letters.len() {
        if starts(at, "//") {
            let end = (at..letters.len()).find(|i| letters[*i] == '\n').unwrap_or(letters.len());
            let text: String = letters[at..end].iter().collect();
            if let Some(doc) = text.strip_prefix("//!").or(text.strip_prefix("///").filter(|_| !starts(at, "////"))) {
                if comment.lines.last().is_some_and(|(last, _)| last + 1 != line) {
                    texts.push(std::mem::replace(&mut comment, Text { is_doc: true, ..Text::default() }));
                }
                comment.lines.push((line, doc.to_owned()));
            }
            at = end;
            continue;
        }
        if starts(at, "/*") {
            let mut depth = 0;
            while at < letters.len() {
                match (starts(at, "/*"), starts(at, "*/")) {
                    (true, _) => (depth, at) = (depth + 1, at + 2),
                    (_, true) => (depth, at) = (depth - 1, at + 2),
                    _ => {
                        line += usize::from(letters[at] == '\n');
                        at += 1;
                    }
                }
                if depth == 0 {
                    break;
                }
            }
            continue;
        }
        let begins_a_word = at == 0 || !(letters[at - 1].is_alphanumeric() || letters[at - 1] == '_');
        let hashes = letters[at..].iter().skip(1).take_while(|letter| **letter == '#').count();
        let is_raw = letters[at] == 'r' && letters.get(at + 1 + hashes) == Some(&'"');
        let is_raw = is_raw && (begins_a_word || (at > 0 && matches!(letters[at - 1], 'b' | 'c')));
        if is_raw || letters[at] == '"' {
            let (begin, close) =
                if is_raw { (at + hashes + 2, format!("\"{}", "#".repeat(hashes))) } else { (at + 1, "\"".to_owned()) };
            let (mut end, mut literal, first) = (begin, String::new(), line);
            while end < letters.len() && !starts(end, &close) {
                if !is_raw && letters[end] == '\\' {
                    // A line break that is continued is none; any other escape stands for one letter.
                    let next = letters.get(end + 1).copied().unwrap_or(' ');
                    literal.push(match next {
                        '\n' => '\n',
                        '"' => '"',
                        _ => ' ',
                    });
                    end += 2;
                } else {
                    literal.push(letters[end]);
                    end += 1;
                }
            }
            line += literal.matches('\n').count();
            push_literal(&mut texts, &literal, first);
            at = end + close.chars().count();
            continue;
        }
        if letters[at] == '\'' {
            // A letter between quotes; otherwise a lifetime.
            match letters.get(at + 1) {
                Some('\\') => {
                    at += 3;
                    while at < letters.len() && letters[at] != '\'' {
                        at += 1;
                    }
                }
                Some(_) if letters.get(at + 2) == Some(&'\'') => at += 2,
                _ => {}
            }
        }
        line += usize::from(letters.get(at) == Some(&'\n'));
        at += 1;
    }
    texts.push(comment);
    texts
}

/// Strings of Python source, of which those in three quotes are docstrings.
fn python(source: &str) -> Vec<Text> {
    let mut texts: Vec<Text> = Vec::new();
    let letters: Vec<char> = source.chars().collect();
    let (mut at, mut line) = (0, 1);
    while at < letters.len() {
        let letter = letters[at];
        if letter == '#' {
            at = (at..letters.len()).find(|i| letters[*i] == '\n').unwrap_or(letters.len());
            continue;
        }
        if letter == '"' || letter == '\'' {
            let quotes =
                if letters.get(at + 1) == Some(&letter) && letters.get(at + 2) == Some(&letter) { 3 } else { 1 };
            let closes = |end: usize| (0..quotes).all(|i| letters.get(end + i) == Some(&letter));
            let (mut end, mut literal, first) = (at + quotes, String::new(), line);
            while end < letters.len() && !closes(end) {
                let step = if letters[end] == '\\' { 2 } else { 1 };
                literal.extend(letters[end..letters.len().min(end + step)].iter().skip(step - 1));
                end += step;
            }
            line += literal.matches('\n').count();
            push_literal(&mut texts, &literal, first);
            if let Some(text) = texts.last_mut().filter(|_| quotes == 3) {
                text.is_doc = true;
            }
            at = end + quotes;
            continue;
        }
        line += usize::from(letter == '\n');
        at += 1;
    }
    texts
}

/// Adds a literal that begins in a line, without the code that it formats in braces.
fn push_literal(texts: &mut Vec<Text>, literal: &str, first: usize) {
    let mut is_code = false;
    let literal: String = literal
        .chars()
        .filter(|letter| {
            is_code = (is_code || *letter == '{') && *letter != '}';
            !is_code || *letter == '\n'
        })
        .collect();
    let is_name = !literal.trim().contains(char::is_whitespace);
    let lines = if is_name { Vec::new() } else { numbered(&literal) };
    let lines = lines.into_iter().map(|(number, line)| (number + first - 1, line)).collect();
    texts.push(Text { lines, is_doc: false });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(name: &str, text: &str) -> Vec<(usize, &'static str)> {
        hits(name, text).into_iter().map(|(line, phrase, _)| (line, phrase)).collect()
    }

    #[test]
    fn a_planted_word_is_found_in_its_line() {
        let page = "# Air\n\nHeat goes to the\nsurroundings; `passage` is a key, [this](a/passage.rs) a file.\nA law turned\nround.\n";
        assert_eq!(found("docs/air.md", page), [(4, "surroundings"), (5, "turned round")]);
        let source = "//! A Passage.\n\n/// The same\n/// valve.\nfn a<'a>() -> &'a str {\n    // Set anew.\n    let c = '\"';\n    \"is set \\\n     anew\"\n}\n";
        assert_eq!(found("crates/a/src/a.rs", source), [(1, "passage"), (3, "the same"), (9, "anew")]);
        let raw = "const A: &str = r#\"\nsays \"somebody\" else\"#;\n/// Of nobody.\nstruct B;\n";
        assert_eq!(found("crates/a/src/a.rs", raw), [(2, "somebody"), (3, "nobody")]);
        let python = "\"\"\"The same\n\nIt is set anew.\n\"\"\"\n# somebody\nraise E(f'{told} of nobody')\n";
        assert_eq!(found("python/mckibben/a.py", python), [(1, "the same"), (3, "anew"), (6, "nobody")]);
    }

    #[test]
    fn a_clean_text_is_left_alone() {
        let page = "The atmosphere. `anew`\n\n```rust\nlet passage = anew();\n```\nOn the same page: passage_of.\n";
        assert_eq!(found("docs/air.md", page), []);
        let source = "/// Two of the same kind.\nfn passage() {\n    let key = \"passage\";\n    // Set anew.\n}\n";
        assert_eq!(found("crates/a/src/a.rs", source), []);
        let python = "\"\"\"Return the same.\"\"\"\nsought = 'anew'\n";
        assert_eq!(found("python/mckibben/a.py", python), []);
        assert_eq!(found("docs/identify.md", "    passage = 1\n"), []);
    }

    #[test]
    fn public_text_has_the_words_of_the_field() {
        assert_eq!(check(&crate::steps::root()), Ok(()));
    }
}
