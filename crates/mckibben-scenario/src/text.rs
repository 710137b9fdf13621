//! The text of a scenario: read from a file or a stream, and refused in one message where it is plainly something else.
//!
//! | what comes | what is said |
//! |---|---|
//! | more than [`MOST`] bytes | that no scenario is so large |
//! | bytes that are no UTF-8, or a zero byte | that it is a binary file, and which, where its first bytes say so |
//! | a table in CSV | that it is a table |
//! | more than [`MANY`] mistakes in the syntax | that it is not TOML, with the first mistake |
//!
//! Checked by the tests below and by the program's `tests/bad_input.rs`.

use crate::diagnostic::{Class, Diagnostic, Diagnostics};
use std::io::Read;

/// Bytes that a scenario has at most: a force map of the largest size takes a few megabytes.
const MOST: u64 = 64 << 20;

/// Mistakes in the syntax that are reported one by one; a text with more is no scenario.
pub(crate) const MANY: usize = 20;

/// What to give in place of something else.
const INSTEAD: &str =
    "give the path of a scenario file, which is TOML in UTF-8; `mckibben init muscle.toml` writes one to start from";

/// The first bytes of files that come from programs like this one.
const KINDS: [(&[u8], &str); 6] = [
    (b"PAR1", "a Parquet file"),
    (b"\x89PNG", "a picture"),
    (b"%PDF", "a PDF document"),
    (b"PK\x03\x04", "a ZIP archive, as a functional mock-up unit is"),
    (b"\xff\xfe", "text in UTF-16: save it as UTF-8"),
    (b"\xfe\xff", "text in UTF-16: save it as UTF-8"),
];

/// Reads a text to its end; `name` stands in messages.
pub(crate) fn read(reader: impl Read, name: &str) -> Result<String, Diagnostics> {
    let unreadable = |title| Diagnostics::from(Diagnostic::whole(Class::Unreadable, name, title).help(INSTEAD));
    let mut bytes = Vec::new();
    reader
        .take(MOST + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| unreadable(format!("`{name}` cannot be read: {error}")))?;
    let kind = KINDS.iter().find(|(begin, _)| bytes.starts_with(begin)).map(|(_, kind)| *kind);
    if kind.is_none() && !bytes.contains(&0) {
        if bytes.len() as u64 > MOST {
            return Err(unreadable(format!("`{name}` has more than {} MiB, and no scenario is so large", MOST >> 20)));
        }
        return String::from_utf8(bytes).map_err(|error| {
            let at = error.utf8_error().valid_up_to();
            unreadable(format!("`{name}` is no scenario: it is not UTF-8 from byte {at} on"))
        });
    }
    let kind = kind.unwrap_or("a binary file");
    Err(unreadable(format!("`{name}` is no scenario: it is {kind}")))
}

/// That a text is a table in CSV, which no TOML can be: its first two lines have separators, the same number, and neither an equals
/// sign nor the bracket of a section.
pub(crate) fn refused(name: &str, text: &str) -> Option<Diagnostic> {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let (first, second) = (lines.next()?, lines.next()?);
    let is_toml = |line: &str| line.contains('=') || line.starts_with('[');
    if is_toml(first) || is_toml(second) {
        return None;
    }
    [',', ';', '\t'].into_iter().find_map(|separator| {
        let cells = |line: &str| line.split(separator).count();
        if cells(first) < 2 || cells(first) != cells(second) {
            return None;
        }
        let columns = cells(first);
        let title = format!("`{name}` is no scenario: it is a table of {columns} columns in CSV");
        Some(Diagnostic::whole(Class::Syntax, name, title).help(INSTEAD))
    })
}

/// One message in place of many mistakes in the syntax, of which the first is given.
pub(crate) fn instead_of_many(name: &str, mistakes: usize, first: &Diagnostic) -> Diagnostic {
    let (line, title) = (first.line().unwrap_or(1), first.title());
    let title = format!("`{name}` is no scenario: it has {mistakes} mistakes of syntax; in line {line}, {title}");
    Diagnostic::whole(Class::Syntax, name, title).help(INSTEAD)
}

#[cfg(test)]
mod tests {
    use crate::Document;
    use std::io::Read;

    /// The only message about some bytes.
    fn message(bytes: &[u8]) -> String {
        let found = Document::read(bytes, "given").expect_err("no scenario");
        assert_eq!(found.count(), 1, "{found}");
        found.to_string()
    }

    #[test]
    fn what_is_plainly_no_scenario_has_one_message() {
        let table = "time_s,length_m\n0,0.1\n".to_owned() + &"1,0.2\n".repeat(10_000);
        for (bytes, words) in [
            (&b"PAR1\x15\x04"[..], "it is a Parquet file"),
            (b"\x7fELF\0\0\0", "it is a binary file"),
            (b"[load]\nkind = \"\xe4\"", "not UTF-8 from byte 15 on"),
            (b"\xff\xfe[\0l\0", "save it as UTF-8"),
            (table.as_bytes(), "it is a table of 2 columns in CSV"),
            (b"t;x\n0;1\n", "it is a table of 2 columns in CSV"),
            ("words without end\n".repeat(1000).as_bytes(), "mistakes of syntax; in line 1"),
        ] {
            let message = message(bytes);
            assert!(message.contains(words) && message.contains("mckibben init"), "{message}");
        }
    }

    /// Mistakes in what is meant as a scenario are reported one by one, also where a list stands on separate lines.
    #[test]
    fn mistakes_in_a_scenario_keep_their_places() {
        let found = Document::parse("[load]\nkind = = 1\n[run]\nduration = = 2\n", "muscle.toml").unwrap_err();
        assert!(found.count() >= 2 && found.iter().all(|of| of.line().is_some()), "{found}");
        assert!(Document::parse("a = [\n1, 2,\n3, 4,\n]\n", "list.toml").is_ok());
    }

    #[test]
    fn a_stream_without_end_is_refused() {
        let found = Document::read(std::io::repeat(b'#').take(u64::MAX), "endless").unwrap_err();
        assert!(found.to_string().contains("more than 64 MiB"), "{found}");
    }
}
