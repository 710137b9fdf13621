//! The log of events as a table for people.

use crate::terminal::{FAINT, styled};
use mckibben_run::events::{Log, OF_ACTUATOR};
use mckibben_run::text::{Alignment, Side};

/// The columns of a log that say to what an event happened.
const OF: [&str; 2] = ["actuator", "part"];

/// The log, with the state after each event of the part that it concerns.
pub(crate) fn table(log: &Log) -> String {
    let of = log.columns.iter().position(|column| OF.contains(&column.as_str()));
    // The column of the actuator is there where the log names it.
    let row = |time: String, event: &str, part: &str, then: String| -> Vec<String> {
        let part = of.map(|_| part.to_owned());
        [time, event.to_owned()].into_iter().chain(part).chain([then]).collect()
    };
    let mut rows = vec![row("time (s)".to_owned(), "event", "of", "then".to_owned())];
    for (time, words) in log.times.iter().zip(&log.rows) {
        let part = of.map_or("", |of| &words[of]);
        let its = |column: &str| match prefix(column) {
            "" => !log.columns.iter().any(|column| !part.is_empty() && prefix(column) == part),
            owner => owner == part,
        };
        let behind = log.columns.iter().zip(words).enumerate().skip(1);
        let then = behind.filter(|(place, (column, _))| Some(*place) != of && its(column));
        let then: Vec<&str> =
            then.map(|(_, (column, word))| printed_word(column, word)).filter(|word| !word.is_empty()).collect();
        rows.push(row(format!("{time:.9}"), &words[0], part, then.join(", ")));
    }
    let least = [(Side::Right, 16), (Side::Left, 12), (Side::Left, 0), (Side::Left, 0)];
    let columns = Alignment::new(least).fit(rows.iter().map(Vec::as_slice));
    let (head, rows) = rows.split_at(1);
    let head = head.iter().map(|row| styled(FAINT, columns.line(row)));
    head.chain(rows.iter().map(|row| columns.line(row))).map(|line| line + "\n").collect()
}

/// Whose a column is, of several actuators in one log: `agonist` of `agonist_valve`; empty where it names none.
fn prefix(column: &str) -> &str {
    let owner = |name: &&str| column.strip_suffix(name)?.strip_suffix('_');
    OF_ACTUATOR.iter().find_map(owner).unwrap_or("")
}

/// What a word of a column says.
fn printed_word<'w>(column: &str, word: &'w str) -> &'w str {
    match (column.ends_with("tension_clamped"), word) {
        (true, "true") => "tension kept at zero",
        (true, _) => "",
        _ => word,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_state_after_an_event_is_that_of_its_actuator() {
        let own = ["event", "actuator", "turning"].map(String::from);
        let both = ["agonist", "antagonist"].map(|name| OF_ACTUATOR.map(|column| format!("{name}_{column}")));
        let row = |own: [&'static str; 3]| {
            let agonist = ["closed", "", "", "free", "stuck", "true"];
            let antagonist = ["exhaust", "", "choked-out", "taut", "held", "false"];
            own.into_iter().chain(agonist).chain(antagonist).map(Into::into).collect()
        };
        let log = Log {
            columns: own.into_iter().chain(both.concat()).collect(),
            times: vec![0.25, 0.5, 0.75],
            rows: vec![
                row(["stick", "agonist", "stuck"]),
                row(["taut", "antagonist", "stuck"]),
                row(["stick", "", "stuck"]),
            ],
        };
        let text = anstream::adapter::strip_str(&table(&log)).to_string();
        let lines: Vec<Vec<&str>> = text
            .lines()
            .map(|line| line.split("  ").map(str::trim).filter(|part| !part.is_empty()).collect())
            .collect();
        assert_eq!(lines[1], ["0.250000000", "stick", "agonist", "closed, free, stuck, tension kept at zero"]);
        assert_eq!(lines[2], ["0.500000000", "taut", "antagonist", "exhaust, choked-out, taut, held"]);
        assert_eq!(lines[3], ["0.750000000", "stick", "stuck"]);
    }
}
