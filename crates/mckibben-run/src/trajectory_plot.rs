//! The figure of a run: length, pressure and tension over time with the valve as bands behind them, or tension over length.

use crate::axis::TrajectoryAxis;
use crate::closed_loop::Goal;
use crate::engine::Kept;
use crate::events;
use mckibben::control::Quantity;
use mckibben::plant::{RigPlant, RigTrajectory};
use mckibben::simulation::EventKind;
use mckibben_plot::{Axis, Colour, Dash, Figure, Marks, Panel, Series, Span, Symbol};

/// The figure of a run, with the set points of a controller as broken lines.
pub(crate) fn figure(run: &Kept<RigPlant>, over: TrajectoryAxis, title: &str) -> Figure {
    match over {
        TrajectoryAxis::Time => courses(run, title),
        TrajectoryAxis::Length => loops(run, title),
    }
}

/// The fewest points over the duration that show a smooth curve, and the most that a curve needs.
pub(crate) const POINTS: (f64, f64) = (2000.0, 100_000.0);
/// Marks of one kind above which they are left out: they would hide what they point at.
const MARKS: u64 = 12;
/// The events that are marked, what says most first: there are five symbols.
const MARKED: [EventKind; 9] = [
    EventKind::Stick,
    EventKind::BreakAway,
    EventKind::Slack,
    EventKind::Tight,
    EventKind::Taut,
    EventKind::TautEnd,
    EventKind::Reversal,
    EventKind::Corner,
    EventKind::TensionZero,
];

/// What is drawn of the samples.
#[derive(Debug, Default)]
struct Curves {
    time: Vec<f64>,
    length: Vec<f64>,
    pressure: Vec<f64>,
    tension: Vec<f64>,
    air_mass: Vec<f64>,
    /// Distance of the load.
    load: Vec<f64>,
    /// Gauge pressure that a regulator makes, where there is one.
    regulated: Vec<f64>,
    supply: Bands,
}

/// Intervals in which the flow path to the supply is open.
#[derive(Debug, Default)]
pub(crate) struct Bands {
    pub(crate) intervals: Vec<(f64, f64)>,
    open_since: Option<f64>,
}

impl Bands {
    pub(crate) fn see(&mut self, time: f64, open: bool) {
        match (self.open_since, open) {
            (None, true) => self.open_since = Some(time),
            (Some(since), false) => {
                self.intervals.push((since, time));
                self.open_since = None;
            }
            _ => {}
        }
    }
}

fn courses(run: &Kept<RigPlant>, title: &str) -> Figure {
    let (goals, rig, duration) = (run.goals(), run.trajectory.rig(), run.plan.duration);
    let curves = curves(run);
    let limits = rig.actuator().limits();
    let peak = curves.pressure.iter().fold(0.0, |peak: f64, pressure| peak.max(pressure.abs()));
    let (per_pascal, unit) = if peak < 50e3 { (1e-3, "kPa") } else { (1e-5, "bar") };

    let mut length = Panel::new(Axis::new("length", "mm"));
    let (least, greatest) = range(&curves.length);
    // A limit is drawn where the curve comes near it; further away it would only flatten the curve.
    let near = 0.15 * (greatest - least).max(1e-3);
    for (value, name) in [(limits.max_length(), "max length"), (limits.min_length(), "min length")] {
        if (least - near..=greatest + near).contains(&value) {
            length = length.horizontal(value * 1e3, name);
        }
    }
    for marks in marks(&run.trajectory) {
        length = length.marks(marks);
    }
    let mut panels = vec![
        (length, curves.length, 1e3, Some(Quantity::Length)),
        (Panel::new(Axis::new("gauge pressure", unit)), curves.pressure, per_pascal, Some(Quantity::Pressure)),
        (Panel::new(Axis::new("tension", "N")), curves.tension, 1.0, Some(Quantity::Force)),
    ];
    if goals.iter().any(|goal| goal.quantity == Quantity::AirMass) {
        panels.push((Panel::new(Axis::new("mass of air", "mg")), curves.air_mass, 1e6, Some(Quantity::AirMass)));
    }
    if let Some(tendon) = rig.tendon() {
        let (panel, rest) = (Panel::new(Axis::new("load, less tendon", "mm")), tendon.rest_length());
        panels.push((panel, curves.load.iter().map(|distance| distance - rest).collect(), 1e3, None));
    }
    let mut figure = Figure::new(Axis::new("time", "s").starting_at(0.0).ending_at(duration)).title(title);
    for (index, (panel, values, factor, shown)) in panels.into_iter().enumerate() {
        let values = values.into_iter().map(|value| value * factor).collect();
        // One entry in a legend names the bands of all panels.
        let name = if index == 0 { "supply open" } else { "" };
        let beside = shown == Some(Quantity::Pressure) && !curves.regulated.is_empty();
        let own = if beside { "actuator" } else { "" };
        let mut panel = panel.series(Series::line(own, curves.time.clone(), values));
        if !curves.supply.intervals.is_empty() {
            panel = panel.span(Span::intervals(name, curves.supply.intervals.clone()));
        }
        if beside {
            let regulated = curves.regulated.iter().map(|value| value * factor).collect();
            let regulated = Series::line("regulated", curves.time.clone(), regulated);
            panel = panel.series(regulated.colour(Colour::Category(1)).dash(Dash::Solid)).series(asked(run, factor));
        }
        if let Some(goal) = goals.iter().find(|goal| Some(goal.quantity) == shown) {
            panel = panel.series(wanted(goal, factor));
        }
        figure = figure.panel(panel);
    }
    figure.size_mm(120.0, 32.0)
}

/// The set points of a pressure regulator, in a unit of which a pascal is so many.
fn asked(run: &Kept<RigPlant>, factor: f64) -> Series {
    let duration = run.plan.duration;
    let command = run.trajectory.rig().actuation().map(|actuation| &actuation.command);
    let given = (0..).map_while(|index| command?.set_point(index));
    let (mut time, mut gauge): (Vec<f64>, Vec<f64>) =
        given.take_while(|(time, _)| *time <= duration).map(|(time, gauge)| (time, gauge * factor)).unzip();
    if let Some(last) = gauge.last().copied() {
        time.push(duration);
        gauge.push(last);
    }
    Series::steps("set point", time, gauge).colour(Colour::Category(1)).dash(Dash::Dashed)
}

/// The set point of a goal, in a unit that its own is so many of.
pub(crate) fn wanted(goal: &Goal, factor: f64) -> Series {
    let target: Vec<f64> = goal.target.iter().map(|target| target * factor).collect();
    let rests = target.windows(2).filter(|pair| pair[0] == pair[1]).count();
    // What changes at most sampling instants is drawn as a curve.
    let draw = if 2 * rests < target.len() { Series::line } else { Series::steps };
    draw("set point", goal.time.clone(), target).dash(Dash::Dashed)
}

fn loops(run: &Kept<RigPlant>, title: &str) -> Figure {
    let Curves { length, tension, .. } = curves(run);
    let length = length.into_iter().map(|length| length * 1e3).collect();
    let panel = Panel::new(Axis::new("tension", "N")).series(Series::line("", length, tension));
    Figure::new(Axis::new("length", "mm")).title(title).panel(panel).size_mm(120.0, 80.0)
}

fn curves(run: &Kept<RigPlant>) -> Curves {
    let Kept { plan, trajectory, .. } = run;
    let (rig, duration) = (trajectory.rig(), plan.duration);
    let mut curves = Curves::default();
    let atmosphere = rig.actuator().air().atmosphere().0;
    let regulates = rig.regulator().is_some();
    let interval = plan.sample_interval.min(duration / POINTS.0).max(duration / POINTS.1);
    for sample in trajectory.samples(interval) {
        curves.time.push(sample.time);
        curves.length.push(sample.length);
        curves.pressure.push(sample.pressure.0 - atmosphere);
        curves.tension.push(sample.tension);
        curves.air_mass.push(sample.air_mass);
        curves.load.push(sample.load_distance);
        if let Some(regulated) = sample.supply_pressure.filter(|_| regulates) {
            curves.regulated.push(regulated.0 - atmosphere);
        }
    }
    // The flow path of a regulator is open all the time.
    curves.supply.see(0.0, !regulates && trajectory.at(0.0).ports.supply);
    for event in trajectory.events().iter().filter(|event| event.kind == EventKind::Valve) {
        curves.supply.see(event.time, event.after.ports.supply);
    }
    curves.supply.see(duration, false);
    curves
}

/// Symbols at the events of the motion, each kind that is rare enough to be looked at one by one.
fn marks(trajectory: &RigTrajectory) -> Vec<Marks> {
    let symbols = [Symbol::Circle, Symbol::Triangle, Symbol::Square, Symbol::Diamond, Symbol::TriangleDown];
    let log = trajectory.events();
    let counts = events::counts(log);
    let few = |kind: &EventKind| counts.get(kind).is_some_and(|number| *number <= MARKS);
    MARKED
        .into_iter()
        .filter(few)
        .zip(symbols)
        .map(|(kind, symbol)| {
            let times: Vec<f64> = log.iter().filter(|event| event.kind == kind).map(|event| event.time).collect();
            let lengths = times.iter().map(|time| trajectory.at(*time).length * 1e3).collect();
            Marks::at(kind.name(), symbol, times, lengths)
        })
        .collect()
}

fn range(values: &[f64]) -> (f64, f64) {
    values
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, greatest), value| (least.min(*value), greatest.max(*value)))
}
