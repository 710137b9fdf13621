//! Which columns a figure shows, and in which panels.
//!
//! | panel | shown unless columns are named |
//! |---|---|
//! | angle, position, length, load distance | of joints, loads and actuators with a separate load |
//! | stiffness, air mass, torque and others | where a controller has a set point of them |
//! | gauge pressure | of every actuator, of its regulator, and set points |
//! | tension | of every actuator |
//! | supply pressure | of supplies whose pressure changes |
//!
//! A panel in which nothing changes is left out, and the note says what it is.

use super::quantity::{MEASURED, SET_POINT, shown, tolerance};
use super::source::{Column, Source};
use crate::failure::Failure;
use crate::quantities::{digits, plain};
use crate::units::Shown;

/// A run with its name among others.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run<'s> {
    /// Its name in the legend; empty for a run alone.
    pub(crate) label: &'s str,
    pub(crate) source: &'s Source,
}

/// A curve of a panel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line<'s> {
    /// The index of its run.
    pub(crate) run: usize,
    pub(crate) source: &'s Source,
    pub(crate) column: &'s Column,
}

/// The curves of one panel.
#[derive(Clone, Debug)]
pub(crate) struct Group<'s> {
    /// The words of the axis.
    pub(crate) title: String,
    /// The SI unit.
    pub(crate) unit: String,
    /// The least difference that is shown.
    pub(crate) floor: f64,
    pub(crate) lines: Vec<Line<'s>>,
}

/// The panels with what is said of those that are left out.
#[derive(Clone, Debug)]
pub(crate) struct Choice<'s> {
    pub(crate) groups: Vec<Group<'s>>,
    pub(crate) notes: Vec<String>,
}

impl Group<'_> {
    /// The least, the greatest and the largest magnitude of its values in SI.
    pub(crate) fn extent(&self) -> (f64, f64, f64) {
        let values = self.lines.iter().flat_map(|line| &line.column.values);
        let (low, high) = extremes(values);
        (low, high, low.abs().max(high.abs()))
    }

    /// The least difference that it shows, in SI.
    pub(crate) fn tolerance(&self) -> f64 {
        tolerance(self.floor, self.extent().2)
    }

    /// The unit that it is shown in.
    pub(crate) fn shown(&self) -> Shown {
        shown(&self.unit, self.extent().2)
    }

    /// What it is, where nothing of it changes; runs that differ are a change.
    fn constant(&self) -> Option<String> {
        let least = self.tolerance();
        let mut values: Vec<(&str, f64)> = Vec::new();
        for line in &self.lines {
            let of = &line.column.of;
            let (low, high) = extremes(&line.column.values);
            if high - low > least || of.place == SET_POINT {
                return None;
            }
            let other = self.lines.iter().filter(|other| other.column.name == line.column.name);
            if other.flat_map(|other| other.column.values.first()).any(|value| (value - high).abs() > least) {
                return None;
            }
            if line.run == self.lines[0].run {
                values.push((&of.part, 0.5 * (low + high)));
            }
        }
        let shown = self.shown();
        let with_unit = |value: f64| shown.with(plain(&digits(shown.number(value))));
        let first = values.first()?.1;
        let words = match values.iter().all(|(_, value)| (value - first).abs() <= least) {
            true => with_unit(first),
            false => {
                let each = values.iter().map(|(part, value)| format!("{part} {}", with_unit(*value)));
                each.collect::<Vec<_>>().join(", ")
            }
        };
        Some(format!("{}: constant, {}", self.title, words.trim_end()))
    }
}

/// The least and the greatest of values.
pub(crate) fn extremes<'v>(values: impl IntoIterator<Item = &'v f64>) -> (f64, f64) {
    values
        .into_iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value)))
}

/// The panels of runs: those of the named columns, or the usual ones where none is named.
///
/// # Errors
/// [`Failure::input`] for a name that no run has.
pub(crate) fn choose<'s>(runs: &[Run<'s>], names: &[String]) -> Result<Choice<'s>, Failure> {
    let all = || {
        let of = |(run, its): (usize, &Run<'s>)| (run, its.source);
        runs.iter()
            .enumerate()
            .map(of)
            .flat_map(|(run, source)| source.columns.iter().map(move |column| Line { run, source, column }))
    };
    let mut groups: Vec<Group<'s>> = Vec::new();
    let mut add = |line: Line<'s>, title: String| {
        let of = &line.column.of;
        match groups.iter_mut().find(|group| group.title == title && group.unit == of.unit) {
            Some(group) => group.lines.push(line),
            None => groups.push(Group { title, unit: of.unit.clone(), floor: of.floor, lines: vec![line] }),
        }
    };
    if !names.is_empty() {
        for name in names {
            let mut found = all().filter(|line| line.column.name == *name).peekable();
            if found.peek().is_none() {
                return Err(unknown(name, runs));
            }
            found.for_each(|line| add(line, line.column.of.quantity.clone()));
        }
        return Ok(Choice { groups, notes: Vec::new() });
    }
    let mut usual: Vec<(Line<'s>, String)> =
        all().filter_map(|line| Some((line, usual(line.source, line.column)?))).collect();
    usual.sort_by_key(|(line, title)| (title.starts_with("supply"), line.column.of.rank()));
    usual.into_iter().for_each(|(line, title)| add(line, title));
    let constant: Vec<Option<String>> = groups.iter().map(Group::constant).collect();
    if constant.iter().all(Option::is_some) {
        groups.truncate(1);
        return Ok(Choice { groups, notes: constant.into_iter().flatten().skip(1).collect() });
    }
    let (mut kept, mut notes) = (Vec::new(), Vec::new());
    for (group, constant) in groups.into_iter().zip(constant) {
        match constant {
            Some(words) => notes.push(words),
            None => kept.push(group),
        }
    }
    Ok(Choice { groups: kept, notes })
}

/// The panel in which a column stands when none is named.
fn usual(source: &Source, column: &Column) -> Option<String> {
    let of = &column.of;
    let has_goal =
        || source.columns.iter().any(|other| other.of.place == SET_POINT && other.of.quantity == of.quantity);
    // Between its mechanism and its tendon a muscle has a length that the mechanism does not say.
    let has_tendon =
        || source.columns.iter().any(|other| other.of.part == of.part && other.of.quantity == "load distance");
    let is_actuator = source.actuators.contains(&of.part);
    let is_usual = match (of.quantity.as_str(), of.place.as_str()) {
        (_, SET_POINT) => true,
        ("stiffness", MEASURED) => true,
        (_, MEASURED) => false,
        ("gauge pressure", "supply") => return changes(column).then(|| "supply, gauge".to_owned()),
        ("gauge pressure", "") if !is_actuator => return changes(column).then(|| "supply, gauge".to_owned()),
        // Of several actuators the regulators' outlets would hide the pressures.
        ("gauge pressure", "regulated") => source.actuators.len() == 1,
        ("angle" | "position" | "load distance" | "gauge pressure" | "tension", "") => true,
        ("length", "") => source.alone.contains(&of.part) || has_tendon() || has_goal(),
        (_, "") => has_goal(),
        _ => false,
    };
    is_usual.then(|| of.quantity.clone())
}

fn changes(column: &Column) -> bool {
    let (low, high) = extremes(&column.values);
    high - low > tolerance(column.of.floor, low.abs().max(high.abs()))
}

/// That no run has a column, with the names that are nearest.
fn unknown(name: &str, runs: &[Run<'_>]) -> Failure {
    let mut known: Vec<&str> = Vec::new();
    for column in runs.iter().flat_map(|run| &run.source.columns) {
        if !known.contains(&column.name.as_str()) {
            known.push(&column.name);
        }
    }
    let title = format!("--columns: the run has no column of numbers `{name}`");
    let mut near: Vec<(usize, &str)> = known.iter().map(|known| (distance(name, known), *known)).collect();
    near.sort();
    let near: Vec<&str> = near.into_iter().take(4).map(|(_, known)| known).collect();
    Failure::input(
        title,
        format!("the nearest names are {}; --output run.csv writes all {}", near.join(", "), known.len()),
    )
}

/// How many letters change from a word to another, where a word that holds the other is nearer than any other.
fn distance(word: &str, other: &str) -> usize {
    if other.contains(word) {
        return 0;
    }
    let other: Vec<char> = other.chars().collect();
    let mut row: Vec<usize> = (0..=other.len()).collect();
    for (i, letter) in word.chars().enumerate() {
        let mut before = row[0];
        row[0] = i + 1;
        for (j, its) in other.iter().enumerate() {
            let cost = before + usize::from(letter != *its);
            before = row[j + 1];
            row[j + 1] = cost.min(row[j] + 1).min(before + 1);
        }
    }
    row[other.len()]
}

#[cfg(test)]
mod tests {
    use super::distance;

    #[test]
    fn near_names_are_few_letters_away() {
        assert_eq!([distance("kitten", "sitting"), distance("tension", "tension_n"), distance("", "ab")], [3, 0, 0]);
        assert_eq!(distance("gauge_presure_pa", "gauge_pressure_pa"), 1);
    }
}
