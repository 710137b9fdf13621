//! The text in source files: comments, string literals and identifiers.

use super::text::{Text, numbered};

/// Source that is read from its begin, and what has been read of it.
#[derive(Default)]
struct Reader {
    letters: Vec<char>,
    at: usize,
    line: usize,
    texts: Vec<Text>,
    /// The comment that goes on in the next line.
    comment: Text,
    /// Identifiers as words.
    names: Text,
}

/// Comments, string literals and identifiers of Rust source.
pub(super) fn rust(source: &str) -> Vec<Text> {
    let mut reader = Reader::new(source);
    while let Some(letter) = reader.letter(0) {
        let hashes = reader.letters[reader.at..].iter().skip(1).take_while(|letter| **letter == '#').count();
        if reader.starts("//") {
            let line = reader.rest_of_line();
            let doc = line.strip_prefix("//!").or(line.strip_prefix("///").filter(|doc| !doc.starts_with('/')));
            reader.push_comment(doc.unwrap_or(&line[2..]), doc.is_some());
        } else if reader.starts("/*") {
            reader.skip_block();
        } else if letter == 'r' && reader.letter(1 + hashes) == Some('"') {
            reader.at += 2 + hashes;
            reader.literal(&format!("\"{}", "#".repeat(hashes)), false);
        } else if letter == '"' {
            reader.at += 1;
            reader.literal("\"", true);
        } else if letter == '\'' {
            reader.skip_quote();
        } else {
            reader.code(letter);
        }
    }
    reader.texts()
}

/// Comments, string literals and identifiers of Python source; strings in three quotes are docstrings.
pub(super) fn python(source: &str) -> Vec<Text> {
    let mut reader = Reader::new(source);
    while let Some(letter) = reader.letter(0) {
        if letter == '#' {
            let line = reader.rest_of_line();
            reader.push_comment(&line[1..], false);
        } else if letter == '"' || letter == '\'' {
            let three = letter.to_string().repeat(3);
            let quotes = if reader.starts(&three) { 3 } else { 1 };
            reader.at += quotes;
            reader.literal(&three[..quotes], true);
            if let Some(text) = reader.texts.last_mut() {
                text.is_doc = quotes == 3;
            }
        } else {
            reader.code(letter);
        }
    }
    reader.texts()
}

impl Reader {
    fn new(source: &str) -> Self {
        Self { letters: source.chars().collect(), line: 1, ..Self::default() }
    }

    fn letter(&self, ahead: usize) -> Option<char> {
        self.letters.get(self.at + ahead).copied()
    }

    fn starts(&self, with: &str) -> bool {
        with.chars().enumerate().all(|(ahead, letter)| self.letter(ahead) == Some(letter))
    }

    fn step(&mut self) {
        self.line += usize::from(self.letter(0) == Some('\n'));
        self.at += 1;
    }

    fn rest_of_line(&mut self) -> String {
        let line: String = self.letters[self.at..].iter().take_while(|letter| **letter != '\n').collect();
        self.at += line.chars().count();
        line
    }

    /// Adds a line to the comment above it, if there is one of its kind.
    fn push_comment(&mut self, line: &str, is_doc: bool) {
        let goes_on = self.comment.lines.last().is_some_and(|(last, _)| last + 1 == self.line);
        if !goes_on || self.comment.is_doc != is_doc {
            self.texts.push(std::mem::replace(&mut self.comment, Text { is_doc, ..Text::default() }));
        }
        self.comment.lines.push((self.line, line.to_owned()));
    }

    fn skip_block(&mut self) {
        let mut depth = 0;
        while self.letter(0).is_some() {
            match (self.starts("/*"), self.starts("*/")) {
                (true, _) => (depth, self.at) = (depth + 1, self.at + 2),
                (_, true) => (depth, self.at) = (depth - 1, self.at + 2),
                _ => self.step(),
            }
            if depth == 0 {
                break;
            }
        }
    }

    /// Skips a letter between quotes, or the quote of a lifetime.
    fn skip_quote(&mut self) {
        match self.letter(1) {
            Some('\\') => {
                self.at += 3;
                while self.letter(0).is_some_and(|letter| letter != '\'') {
                    self.at += 1;
                }
                self.at += 1;
            }
            Some(_) if self.letter(2) == Some('\'') => self.at += 3,
            _ => self.at += 1,
        }
    }

    /// Reads a literal from behind its opening quotes to its closing ones.
    fn literal(&mut self, close: &str, has_escapes: bool) {
        let (mut literal, first) = (String::new(), self.line);
        while self.letter(0).is_some() && !self.starts(close) {
            let is_escape = has_escapes && self.letter(0) == Some('\\');
            if is_escape {
                self.at += 1;
            }
            // A line break that is continued is none; any other escape stands for one letter.
            match self.letter(0) {
                Some(letter) if !is_escape || letter == '\n' || letter == '"' => literal.push(letter),
                _ => literal.push(' '),
            }
            self.step();
        }
        self.at += close.chars().count();
        self.push_literal(&literal, first);
    }

    /// Adds a literal that begins in a line, without the code that it formats in braces; a literal of one word is a name.
    fn push_literal(&mut self, literal: &str, first: usize) {
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
        self.texts.push(Text { lines, ..Text::default() });
    }

    /// Reads a letter of code, or an identifier that begins there.
    fn code(&mut self, letter: char) {
        let is_letter = |letter: &&char| letter.is_alphanumeric() || **letter == '_';
        let name: String = self.letters[self.at..].iter().take_while(is_letter).collect();
        // Prefixes of literals are none.
        if !(letter.is_alphabetic() || letter == '_') || matches!(name.as_str(), "b" | "br" | "c" | "cr" | "f" | "rf") {
            return self.step();
        }
        self.names.lines.push((self.line, name.clone()));
        self.at += name.chars().count();
    }

    fn texts(mut self) -> Vec<Text> {
        let names = std::mem::take(&mut self.names.lines);
        self.texts.push(self.comment);
        self.texts.extend(names.into_iter().map(Text::of_name));
        self.texts
    }
}
