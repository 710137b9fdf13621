//! The log of a plant's events.
//!
//! The columns of the CSV are `time_s,event,part,valve,length_regime,sliding,tension_clamped`; `part` is the name of what it happened
//! to, and what stands behind it holds of that part from then on, as far as it is an actuator or its valve.

use super::{PlantOutcome, name_of};
use crate::events::{Log, words};
use mckibben::plant::{Part, PlantEvent, PlantReader};
use std::borrow::Cow;

/// The log in words.
pub(crate) fn log(run: &PlantOutcome) -> Log {
    let columns = ["event", "part", "valve", "length_regime", "sliding", "tension_clamped"].map(str::to_owned).to_vec();
    let (mut reader, names) = (PlantReader::new(&run.trajectory), &run.experiment.names);
    let mut row = |event: &PlantEvent| {
        let mut then = [""; 4];
        match event.kind.part {
            Part::Valve(valve) => then[0] = reader.read(event.time).valves[valve].ports.name(),
            Part::Actuator(index) => {
                let (_, mode) = run.trajectory.at(event.time);
                let [_, _, _, length_regime, sliding, clamped] = words(&mode.actuators[index].mode);
                then = ["", length_regime, sliding, clamped];
                if let Some(valve) = names.valves[index] {
                    then[0] = reader.read(event.time).valves[valve].ports.name();
                }
            }
            _ => {}
        }
        let part = name_of(&run.experiment, event.kind.part).to_owned();
        let own = [Cow::Borrowed(event.kind.kind.name()), Cow::Owned(part)];
        own.into_iter().chain(then.map(Cow::Borrowed)).collect()
    };
    let events = run.trajectory.events();
    let times = events.iter().map(|event| event.time).collect();
    Log { columns, times, rows: events.iter().map(&mut row).collect() }
}
