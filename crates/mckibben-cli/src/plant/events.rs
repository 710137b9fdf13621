//! The log of a plant's events: as a table for people, and as CSV.
//!
//! The columns of the CSV are `time_s,event,part,valve,extent,sliding,tension_clamped`; `part` is the name of what it happened
//! to, and what stands behind it holds of that part from then on, as far as it is an actuator or its valve.

use super::{PlantOutcome, name_of};
use crate::events::{Log, words};
use crate::terminal::{FAINT, styled};
use mckibben::plant::{Part, PlantReader};
use std::borrow::Cow;
use std::fmt::Write as _;

/// What is known of an event.
struct Row<'r> {
    time: f64,
    kind: &'static str,
    part: &'r str,
    /// Open ports, extent, sliding, whether the tension is clamped.
    then: [&'static str; 4],
}

fn rows(run: &PlantOutcome) -> Vec<Row<'_>> {
    let mut reader = PlantReader::new(&run.trajectory);
    let names = &run.experiment.names;
    let row = |event: &mckibben::plant::PlantEvent| {
        let mut then = [""; 4];
        match event.kind.part {
            Part::Valve(valve) => then[0] = reader.read(event.time).valves[valve].ports.name(),
            Part::Actuator(index) => {
                let (_, mode) = run.trajectory.at(event.time);
                let [_, _, _, extent, sliding, clamped] = words(&mode.actuators[index].mode);
                then = ["", extent, sliding, clamped];
                if let Some(valve) = names.valves[index] {
                    then[0] = reader.read(event.time).valves[valve].ports.name();
                }
            }
            _ => {}
        }
        let part = name_of(&run.experiment, event.kind.part);
        Row { time: event.time, kind: event.kind.kind.name(), part, then }
    };
    run.trajectory.events().iter().map(row).collect()
}

/// The log as a table for people.
pub(crate) fn table(run: &PlantOutcome) -> String {
    let mut text = styled(FAINT, format!("{:>16}  {:<12}  {:<16}  {}", "time (s)", "event", "of", "then")) + "\n";
    for Row { time, kind, part, then: [ports, extent, sliding, clamped] } in rows(run) {
        let clamped = if clamped == "true" { "tension kept at zero" } else { "" };
        let then: Vec<&str> = [ports, extent, sliding, clamped].into_iter().filter(|word| !word.is_empty()).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{time:>16.9}  {kind:<12}  {part:<16}  {}", then.join(", "));
    }
    text
}

/// The log in words.
pub(crate) fn log(run: &PlantOutcome) -> Log {
    let columns = ["event", "part", "valve", "extent", "sliding", "tension_clamped"].map(str::to_owned).to_vec();
    let rows = rows(run);
    let times = rows.iter().map(|row| row.time).collect();
    let words = |row: Row<'_>| {
        let then = row.then.into_iter().map(Cow::Borrowed);
        [Cow::Borrowed(row.kind), Cow::Owned(row.part.to_owned())].into_iter().chain(then).collect()
    };
    Log { columns, times, rows: rows.into_iter().map(words).collect() }
}
