//! Text in lines, and where a phrase stands in it.

/// Text in lines, each with its number.
#[derive(Default)]
pub(super) struct Text {
    pub(super) lines: Vec<(usize, String)>,
    /// Whether its first line is a summary.
    pub(super) is_doc: bool,
}

impl Text {
    /// The words of an identifier or a path, which are separated by underscores, other signs and capitals.
    pub(super) fn of_name((line, name): (usize, String)) -> Self {
        let mut words = String::new();
        for letter in name.chars() {
            let is_begin = letter.is_uppercase() && words.ends_with(char::is_lowercase);
            words.extend(is_begin.then_some(' '));
            words.push(if letter.is_alphanumeric() { letter } else { ' ' });
        }
        Self { lines: vec![(line, words)], is_doc: false }
    }
}

pub(super) fn numbered(text: &str) -> Vec<(usize, String)> {
    text.lines().enumerate().map(|(at, line)| (at + 1, line.to_owned())).collect()
}

/// Where a phrase stands as whole words.
pub(super) fn places<'a>(words: &'a str, phrase: &'a str) -> impl Iterator<Item = usize> + 'a {
    let is_word = |letter: char| letter.is_alphanumeric() || letter == '_';
    words
        .match_indices(phrase)
        .map(|(at, _)| at)
        .filter(move |at| !words[..*at].ends_with(is_word) && !words[at + phrase.len()..].starts_with(is_word))
}

/// The text in lower case with single spaces, and the line of each byte; without code, and without addresses of links.
pub(super) fn plain(text: &Text) -> (String, Vec<usize>) {
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
