//! What a figure reads of a run: its columns, its events, the intervals in which valves are open, and limits. It is the same for an
//! actuator alone, a joint and a plant.

use super::quantity::Of;
use crate::failure::Failure;
use crate::joint::NAMES;
use crate::plant::name_of;
use crate::record::Values;
use crate::run::Finished;
use crate::{table, units};
use mckibben::mechanism::Mechanism;
use mckibben::plant::{Part, PlantReader};
use mckibben::simulation::{EventKind, SampleTimes};
use std::sync::Arc;

/// The fewest points over the duration that show a smooth curve, and the most that a curve needs.
const POINTS: (f64, f64) = (2000.0, 100_000.0);
/// Events up to this number have two points each: the values just before them, which may be the peak, and those after.
const CORNERS: usize = 20_000;
/// The part of itself by which a time lies just before an instant: more than the rounding by which two instants are one, and no
/// distance in a figure.
const BEFORE: f64 = 64.0 * f64::EPSILON;
/// Points in the period of a pulsed valve.
const PER_PULSE: f64 = 48.0;

/// A column of a run.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    /// Its name in files, with the unit that it has there.
    pub(crate) name: String,
    pub(crate) of: Of,
    /// Its values in SI.
    pub(crate) values: Vec<f64>,
}

/// An event.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Happened {
    pub(crate) time: f64,
    pub(crate) kind: EventKind,
    /// The part that it happened to; empty for the only actuator and for the joint of two. A muscle that breaks away moves all joints
    /// of its chain: then the last of them.
    pub(crate) part: String,
}

/// When the flow path from the supply is open.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Supply {
    /// The actuator.
    pub(crate) part: String,
    /// The intervals.
    pub(crate) open: Vec<(f64, f64)>,
}

/// A limit of a quantity.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Limit {
    pub(crate) part: String,
    pub(crate) quantity: &'static str,
    pub(crate) value: f64,
    pub(crate) words: &'static str,
}

/// A run as figures read it.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    /// Its duration in s.
    pub(crate) duration: f64,
    /// The actuators, in order; one without a name where it is alone.
    pub(crate) actuators: Vec<String>,
    /// Those whose length says how the load moves.
    pub(crate) alone: Vec<String>,
    /// The instants of the values in s.
    pub(crate) time: Arc<[f64]>,
    /// The columns of numbers but the time.
    pub(crate) columns: Vec<Column>,
    pub(crate) events: Vec<Happened>,
    pub(crate) supplies: Vec<Supply>,
    pub(crate) limits: Vec<Limit>,
}

/// Whether a valve is open, from its changes.
struct Watch {
    part: String,
    at_start: bool,
    changes: Vec<(f64, bool)>,
}

impl Watch {
    fn new(part: &str, at_start: bool) -> Self {
        Self { part: part.to_owned(), at_start, changes: Vec::new() }
    }

    fn intervals(self, duration: f64) -> Supply {
        let (mut open, mut since) = (Vec::new(), self.at_start.then_some(0.0));
        for (time, opens) in self.changes.into_iter().chain([(duration, false)]) {
            match (since, opens) {
                (None, true) => since = Some(time),
                (Some(begun), false) => {
                    open.push((begun, time));
                    since = None;
                }
                _ => {}
            }
        }
        Supply { part: self.part, open }
    }
}

impl Source {
    /// Reads a run.
    ///
    /// # Errors
    /// [`Failure::stopped`] for a number that is not finite.
    pub(crate) fn of(run: &Finished) -> Result<Self, Failure> {
        let plan = run.plan();
        let duration = plan.duration;
        let (actuators, alone, events, watches, limits) = match run {
            Finished::Actuator(of) => actuator(of),
            Finished::Joint(of) => joint(of),
            Finished::Plant(of) => plant(of),
        };
        let pulses = watches.iter().map(|watch| watch.changes.len()).max().unwrap_or(0) as f64 / 2.0;
        let least = POINTS.0.max(pulses * PER_PULSE);
        let interval = plan.sample_interval.min(duration / least).max(duration / POINTS.1);
        // Curves have their peaks where a valve moves, a stop is reached, the braid is taut, or a motion turns back.
        let corners = events.iter().filter(|_| events.len() < CORNERS);
        let corners = corners.flat_map(|event| [event.time * (1.0 - BEFORE), event.time]);
        let times = SampleTimes::new(duration, interval).times().chain(corners);
        let mut time: Vec<f64> = times.map(|time| time.clamp(0.0, duration)).collect();
        time.sort_by(f64::total_cmp);
        time.dedup();
        let time: Arc<[f64]> = time.into();
        let first = actuators.first().cloned().unwrap_or_default();
        let columns = run.columns_at(&time)?.into_iter().filter_map(|column| {
            let of = Of::column(&column, &first);
            match column.values {
                Values::Numbers(values) if column.name != "time_s" => {
                    Some(Column { name: in_files(column.name, column.unit), of, values })
                }
                _ => None,
            }
        });
        let columns = columns.collect();
        let supplies = watches.into_iter().map(|watch| watch.intervals(duration)).collect();
        Ok(Self { duration, actuators, alone, time, columns, events, supplies, limits })
    }

    /// The supplies that open and close: what is open all the time, or never, is no band.
    pub(crate) fn switched(&self) -> impl Iterator<Item = &Supply> {
        self.supplies.iter().filter(|supply| match supply.open.as_slice() {
            [] => false,
            [(from, to)] => *from > 0.0 || *to < self.duration,
            _ => true,
        })
    }
}

/// The name that a column of numbers has in a file, which ends with the unit that was chosen.
fn in_files(name: String, unit: String) -> String {
    let column = table::Column::number(name.clone(), unit);
    units::columns(vec![column]).0.pop().map_or(name, |column| column.name)
}

type Parts = (Vec<String>, Vec<String>, Vec<Happened>, Vec<Watch>, Vec<Limit>);

fn actuator(of: &crate::engine::Kept<mckibben::plant::RigPlant>) -> Parts {
    let (trajectory, rig) = (&of.trajectory, of.trajectory.rig());
    let part = String::new;
    let limits = rig.actuator().limits();
    let limits = [("max length", limits.max_length()), ("min length", limits.min_length())];
    let limits = limits.map(|(words, value)| Limit { part: part(), quantity: "length", value, words });
    // The flow path of a regulator is open all the time.
    let mut watch = Watch::new("", rig.regulator().is_none() && trajectory.at(0.0).ports.supply);
    for event in trajectory.events().iter().filter(|event| event.kind == EventKind::Valve) {
        watch.changes.push((event.time, event.after.ports.supply));
    }
    let events = trajectory.events().iter();
    let events = events.map(|event| Happened { time: event.time, kind: event.kind, part: part() }).collect();
    (vec![part()], vec![part()], events, vec![watch], limits.into())
}

fn joint(of: &crate::engine::Kept<mckibben::plant::JointPlant>) -> Parts {
    let (trajectory, rig) = (&of.trajectory, of.trajectory.rig());
    let start = trajectory.at(0.0);
    let mut watches = [0, 1].map(|index| Watch::new(NAMES[index], start.actuators[index].ports.supply));
    for event in trajectory.events().iter().filter(|event| event.kind.kind == EventKind::Valve) {
        if let Some(index) = event.kind.actuator {
            watches[index].changes.push((event.time, event.after.actuators[index].ports.supply));
        }
    }
    let happened = trajectory.events().iter().map(|event| Happened {
        time: event.time,
        kind: event.kind.kind,
        part: event.kind.actuator.map_or("", |index| NAMES[index]).to_owned(),
    });
    let limits = stops("", rig.joint().stops().ends);
    (NAMES.map(str::to_owned).into(), Vec::new(), happened.collect(), watches.into(), limits)
}

fn plant(of: &crate::plant::PlantOutcome) -> Parts {
    let (experiment, trajectory) = (&of.experiment, &of.trajectory);
    let (plant, names) = (&experiment.plant, &experiment.names);
    let actuators = names.actuators.clone();
    let is_alone = |index: &usize| names.mechanisms[plant.actuators()[*index].mechanism].name.is_none();
    let alone: Vec<usize> = (0..actuators.len()).filter(is_alone).collect();
    let mut limits = Vec::new();
    for (index, mounted) in plant.actuators().iter().enumerate() {
        // The length of a muscle on a tendon moves apart from its mechanism.
        if mounted.tendon.is_none() && !alone.contains(&index) {
            continue;
        }
        let of = mounted.actuator.limits();
        for (words, value) in [("max length", of.max_length()), ("min length", of.min_length())] {
            limits.push(Limit { part: actuators[index].clone(), quantity: "length", value, words });
        }
    }
    for (its, mechanism) in names.mechanisms.iter().zip(plant.mechanisms()) {
        if let Mechanism::Chain(chain) = mechanism {
            limits
                .extend(its.joints.iter().zip(chain.joints()).flat_map(|(name, joint)| stops(name, joint.stops.ends)));
        }
    }
    let mut reader = PlantReader::new(trajectory);
    let start = reader.read(0.0);
    let mut watches: Vec<(usize, Watch)> = Vec::new();
    for (name, valve) in actuators.iter().zip(&names.valves) {
        if let Some(valve) = *valve {
            watches.push((valve, Watch::new(name, start.valves[valve].ports.supply)));
        }
    }
    for event in trajectory.events().iter().filter(|event| event.kind.kind == EventKind::Valve) {
        if let Part::Valve(valve) = event.kind.part {
            let open = reader.read(event.time).valves[valve].ports.supply;
            watches
                .iter_mut()
                .filter(|(of, _)| *of == valve)
                .for_each(|(_, watch)| watch.changes.push((event.time, open)));
        }
    }
    let part = |kind: EventKind, part: Part| match part {
        Part::Mechanism(index) if kind == EventKind::BreakAway => names.mechanisms[index].joints.last(),
        _ => None,
    };
    let happened = trajectory.events().iter().map(|event| {
        let (kind, its) = (event.kind.kind, event.kind.part);
        let part = part(kind, its).map_or_else(|| name_of(experiment, its), String::as_str);
        Happened { time: event.time, kind, part: part.to_owned() }
    });
    let alone = alone.into_iter().map(|index| actuators[index].clone()).collect();
    (actuators, alone, happened.collect(), watches.into_iter().map(|(_, watch)| watch).collect(), limits)
}

fn stops(part: &str, ends: [Option<f64>; 2]) -> Vec<Limit> {
    let limit = |(end, words): (Option<f64>, &'static str)| {
        Some(Limit { part: part.to_owned(), quantity: "angle", value: end?, words })
    };
    ends.into_iter().zip(["lower stop", "upper stop"]).filter_map(limit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_supply_is_open_between_its_changes() {
        let mut watch = Watch::new("flexor", true);
        watch.changes = vec![(1.0, false), (2.0, true), (2.5, true), (3.0, false), (4.0, true)];
        assert_eq!(watch.intervals(5.0).open, [(0.0, 1.0), (2.0, 3.0), (4.0, 5.0)]);
        assert_eq!(Watch::new("", false).intervals(5.0).open, []);
    }
}
