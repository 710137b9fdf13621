//! The log of events as a table for people.

use crate::terminal::{FAINT, styled};
use mckibben_run::events::{Log, OF_ACTUATOR};
use std::fmt::Write as _;

/// The columns of a log that say to what an event happened.
const OF: [&str; 2] = ["actuator", "part"];

/// The log, with what holds after each event for whom it happened to.
pub(crate) fn table(log: &Log) -> String {
    let of = log.columns.iter().position(|column| OF.contains(&column.as_str()));
    let wide = of.map_or(0, |of| log.rows.iter().map(|row| row[of].chars().count()).max().unwrap_or(0).max(2));
    let whose = |words: &str| if of.is_some() { format!("  {words:<wide$}") } else { String::new() };
    let head = format!("{:>16}  {:<12}{}  {}", "time (s)", "event", whose("of"), "then");
    let mut text = styled(FAINT, head) + "\n";
    for (time, words) in log.times.iter().zip(&log.rows) {
        let part = of.map_or("", |of| &words[of]);
        let its = |column: &str| match prefix(column) {
            "" => !log.columns.iter().any(|column| !part.is_empty() && prefix(column) == part),
            owner => owner == part,
        };
        let behind = log.columns.iter().zip(words).enumerate().skip(1);
        let then = behind.filter(|(place, (column, _))| Some(*place) != of && its(column));
        let then: Vec<&str> =
            then.map(|(_, (column, word))| told(column, word)).filter(|word| !word.is_empty()).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{time:>16.9}  {:<12}{}  {}", words[0], whose(part), then.join(", "));
    }
    text
}

/// Whose a column is, of several actuators in one log: `agonist` of `agonist_valve`; empty where it says nobody.
fn prefix(column: &str) -> &str {
    let owner = |name: &&str| column.strip_suffix(name)?.strip_suffix('_');
    OF_ACTUATOR.iter().find_map(owner).unwrap_or("")
}

/// What a word of a column says.
fn told<'w>(column: &str, word: &'w str) -> &'w str {
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
    fn after_an_event_stands_what_holds_of_whom_it_happened_to() {
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
