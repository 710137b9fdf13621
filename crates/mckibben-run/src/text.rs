//! Text in lines and columns, for people.

/// From one column to the next.
pub const GAP: &str = "  ";

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

/// At which side of its column a cell stands.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Side {
    /// At the left: words.
    Left,
    /// At the right: numbers.
    Right,
}

/// Aligned columns: prints the rows of a table as lines.
///
/// Widths count characters. A cell that is wider than its column moves those behind it.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Alignment {
    columns: Vec<(Side, usize)>,
    gap: &'static str,
}

impl Alignment {
    /// Columns with their widths, and [`GAP`] between two.
    pub fn new(columns: impl IntoIterator<Item = (Side, usize)>) -> Self {
        Self { columns: columns.into_iter().collect(), gap: GAP }
    }

    /// The columns with nothing between two, but a blank where two cells would touch.
    #[must_use]
    pub fn without_gaps(self) -> Self {
        Self { gap: "", ..self }
    }

    /// The columns, as much wider as the cells of these rows need.
    #[must_use]
    pub fn fit<'r, C: AsRef<str> + 'r>(mut self, rows: impl IntoIterator<Item = &'r [C]>) -> Self {
        for row in rows {
            for ((_, width), cell) in self.columns.iter_mut().zip(row) {
                *width = (*width).max(cell.as_ref().chars().count());
            }
        }
        self
    }

    /// The cells of a row as a line, without blanks at its end.
    pub fn line<C: AsRef<str>>(&self, cells: &[C]) -> String {
        let mut line = String::new();
        for (place, ((side, width), cell)) in self.columns.iter().zip(cells).enumerate() {
            let cell = cell.as_ref();
            let is_full = *side == Side::Left || cell.chars().count() >= *width;
            let touches = !cell.is_empty() && is_full && line.ends_with(|last: char| last != ' ');
            let gap = match place {
                0 => "",
                _ if self.gap.is_empty() && touches => " ",
                _ => self.gap,
            };
            line += &match side {
                Side::Left => format!("{gap}{cell:<width$}"),
                Side::Right => format!("{gap}{cell:>width$}"),
            };
        }
        line.truncate(line.trim_end().len());
        line
    }

    /// A line under the head of each column.
    pub fn rule(&self) -> String {
        self.line(&self.columns.iter().map(|(_, width)| "─".repeat(*width)).collect::<Vec<_>>())
    }
}

/// A name in a column of `names` characters and text behind it, which is broken at `width` characters and goes on under itself.
pub fn entry(name: &str, names: usize, text: &str, width: usize) -> String {
    let columns = Alignment::new([(Side::Left, 0), (Side::Left, names), (Side::Left, 0)]);
    let text = wrap(text, &" ".repeat(names + 2 * GAP.len()), width);
    columns.line(&["", name, text.trim_start()]) + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_no_longer_than_requested() {
        let text = wrap("one two three four five six", "  ", 12);
        assert_eq!(text, "  one two\n  three four\n  five six");
    }

    #[test]
    fn cells_stand_under_each_other_by_their_characters() {
        let rows = [["Δp", "1.5", "a"], ["length", "−10.25", ""]];
        let columns =
            Alignment::new([(Side::Left, 0), (Side::Right, 4), (Side::Left, 0)]).fit(rows.iter().map(|row| &row[..]));
        assert_eq!(rows.map(|row| columns.line(&row)), ["Δp         1.5  a", "length  −10.25"]);
        assert_eq!(columns.rule(), "──────  ──────  ─");
        assert_eq!(columns.clone().without_gaps().line(&["x", "2", "y"]), "x          2 y");
        // A name and a number that fill their columns do not touch.
        assert_eq!(columns.without_gaps().line(&["length", "−10.25", ""]), "length −10.25");
    }

    #[test]
    fn an_entry_goes_on_under_itself() {
        assert_eq!(entry("load", 6, "one two three", 18), "  load    one two\n          three\n");
    }
}
