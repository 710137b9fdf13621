//! Text in lines.

/// Breaks text into lines of at most `width` characters, each after `indent`; a word that is longer stands alone.
pub fn wrap(text: &str, indent: &str, width: usize) -> String {
    let mut lines = String::new();
    let mut line = indent.to_owned();
    for word in text.split(' ') {
        let filled = line.chars().count();
        if filled > indent.len() && filled + 1 + word.chars().count() > width {
            lines.push_str(line.trim_end());
            lines.push('\n');
            line = indent.to_owned();
        } else if filled > indent.len() {
            line.push(' ');
        }
        line.push_str(word);
    }
    lines + line.trim_end()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_no_longer_than_asked() {
        let text = wrap("one two three four five six", "  ", 12);
        assert_eq!(text, "  one two\n  three four\n  five six");
    }
}
