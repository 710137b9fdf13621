//! A search as a figure, by how many keys vary.
//!
//! | what varies | the figure |
//! |---|---|
//! | one key | the objective and the number of each constraint over it; what breaks a constraint is shaded |
//! | two keys | the points, coloured by the objective; hollow where a constraint is broken, crossed where the run failed; the way of the best |
//! | more | the best value over the runs |

use super::Goal;
use super::outcome::{Outcome, Reached};
use super::vary::Vary;
use crate::units::units;
use mckibben_plot::{Axis, Colour, Dash, Figure, Legend, Marks, Panel, Series, Span, Style, Symbol};

/// Panels of constraints at most.
const PANELS: usize = 7;
/// Colours of the objective.
const COLOURS: usize = 5;

pub(super) fn figure(of: &Outcome) -> Figure {
    let figure = match of.request().vary.as_slice() {
        [key] => over_one(of, key),
        [first, second] => over_two(of, first, second),
        _ => over_runs(of),
    };
    let runs = of.points().len();
    let goal = match of.request().goal {
        Goal::Minimize => "least",
        Goal::Maximize => "greatest",
    };
    let title =
        format!("Search for the {goal} {}, {runs} {}", of.request().objective, if runs == 1 { "run" } else { "runs" });
    figure.title(title)
}

/// The objective, with the name and unit of its axis.
struct Objective {
    axis: Axis,
    values: Vec<f64>,
}

impl Objective {
    /// At every point; not a number where a run failed.
    fn of(of: &Outcome) -> Self {
        let values = || of.points().iter().map(|point| number(point, 0));
        let shown = units().for_name(&of.request().objective).common(&of.unit, values());
        let values = values().map(|value| shown.number(value)).collect();
        Self { axis: Axis::new(of.request().objective.clone(), shown.text), values }
    }
}

fn number(point: &Reached, place: usize) -> f64 {
    point.numbers.as_ref().map_or(f64::NAN, |numbers| numbers[place])
}

fn axis(vary: &Vary) -> Axis {
    let axis = if vary.is_logarithmic() { Axis::logarithmic } else { Axis::new };
    axis(vary.key.clone(), vary.unit.clone())
}

fn over_one(of: &Outcome, key: &Vary) -> Figure {
    let mut order: Vec<usize> = (0..of.points().len()).collect();
    let x_of = |place: &usize| of.points()[*place].values[0];
    order.sort_by(|one, other| x_of(one).total_cmp(&x_of(other)));
    let x: Vec<f64> = order.iter().map(x_of).collect();
    let best = of.best().values[0];
    let shaded = shaded(key.ends, &order.iter().map(|place| &of.points()[*place]).collect::<Vec<_>>());
    let panel = |axis: Axis, y: Vec<f64>| {
        let series = Series { style: Style::LineAndPoints, ..Series::line("", x.clone(), y) };
        let panel = Panel::new(axis).series(series).vertical(best, "best").legend(Legend::Hidden);
        if shaded.is_empty() { panel } else { panel.span(Span::intervals("", shaded.clone())) }
    };
    let objective = Objective::of(of);
    let values = order.iter().map(|place| objective.values[*place]).collect();
    let [low, high] = key.ends;
    let mut figure = Figure::new(axis(key).starting_at(low).ending_at(high)).size_mm(120.0, 40.0);
    if !shaded.is_empty() {
        figure = figure.caption("Shaded: a constraint is broken, or the run failed.");
    }
    figure = figure.panel(panel(objective.axis, values));
    for (place, constraint) in of.request().constraints.iter().enumerate().take(PANELS) {
        let value = |at: &usize| constraint.in_unit(number(&of.points()[*at], place + 1));
        let axis = Axis::new(constraint.name.clone(), constraint.unit.clone());
        let limit = format!("{} {}", constraint.relation.sign(), constraint.limit());
        figure = figure.panel(panel(axis, order.iter().map(value).collect()).horizontal(constraint.bound, limit));
    }
    figure
}

/// The intervals of the key in which points break a constraint or fail, to the middle between them and those that do not.
fn shaded(ends: [f64; 2], points: &[&Reached]) -> Vec<(f64, f64)> {
    let mut intervals: Vec<(f64, f64)> = Vec::new();
    for (place, point) in points.iter().enumerate().filter(|(_, point)| !point.is_feasible()) {
        let middle = |other: &&Reached| 0.5 * (point.values[0] + other.values[0]);
        let from = place.checked_sub(1).and_then(|before| points.get(before)).map_or(ends[0], middle);
        let to = points.get(place + 1).map_or(ends[1], middle);
        match intervals.last_mut() {
            Some(last) if last.1 >= from => last.1 = to,
            _ => intervals.push((from, to)),
        }
    }
    intervals
}

fn over_two(of: &Outcome, first: &Vary, second: &Vary) -> Figure {
    let objective = Objective::of(of);
    let xy = |points: &[&Reached]| -> (Vec<f64>, Vec<f64>) {
        points.iter().map(|point| (point.values[0], point.values[1])).unzip()
    };
    let mut panel =
        Panel::new(axis(second).starting_at(second.ends[0]).ending_at(second.ends[1])).legend(Legend::Above);
    let (x, y) = xy(&of.improvements().iter().map(|place| &of.points()[*place]).collect::<Vec<_>>());
    panel = panel.series(Series::line("way of the best", x, y).colour(Colour::Neutral).dash(Dash::Dotted));
    let feasible: Vec<usize> = (0..of.points().len()).filter(|place| of.points()[*place].is_feasible()).collect();
    let values = || feasible.iter().map(|place| objective.values[*place]);
    let [least, greatest] =
        values().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], value| [least.min(value), most.max(value)]);
    let width = (greatest - least) / COLOURS as f64;
    for colour in 0..COLOURS {
        let within = |place: &&usize| {
            let step = ((objective.values[**place] - least) / width).floor();
            let step = if step.is_finite() { (step as usize).min(COLOURS - 1) } else { 0 };
            step == colour
        };
        let points: Vec<&Reached> = feasible.iter().filter(within).map(|place| &of.points()[*place]).collect();
        if points.is_empty() {
            continue;
        }
        let (x, y) = xy(&points);
        let ends = [colour, colour + 1].map(|step| crate::quantities::digits(least + width * step as f64));
        let label = format!("{} to {} {}", ends[0], ends[1], objective.axis.unit);
        panel = panel.series(Series::points(label, x, y).colour(Colour::Ramp(colour as f64 / (COLOURS - 1) as f64)));
    }
    let (failed, broken): (Vec<&Reached>, Vec<&Reached>) =
        of.points().iter().filter(|point| !point.is_feasible()).partition(|point| point.numbers.is_err());
    for (label, symbol, points) in [("breaks a constraint", Symbol::Circle, broken), ("failed", Symbol::Cross, failed)]
    {
        let (x, y) = xy(&points);
        if !points.is_empty() {
            panel = panel.marks(Marks::at(label, symbol, x, y).staying());
        }
    }
    let (x, y) = xy(&[of.best()]);
    panel = panel.marks(Marks::at("best", Symbol::Diamond, x, y).staying().colour(Colour::Category(1)));
    let [low, high] = first.ends;
    Figure::new(axis(first).starting_at(low).ending_at(high))
        .size_mm(130.0, 90.0)
        .caption(format!("Discs that are filled meet every constraint; their colour is {}.", objective.axis.label))
        .panel(panel)
}

fn over_runs(of: &Outcome) -> Figure {
    let objective = Objective::of(of);
    let (mut runs, mut values) = (Vec::new(), Vec::new());
    let feasible = of.improvements().into_iter().filter(|place| of.points()[*place].is_feasible());
    for place in feasible {
        runs.push(place as f64 + 1.0);
        values.push(objective.values[place]);
    }
    if let Some(last) = values.last().copied() {
        runs.push(of.points().len() as f64);
        values.push(last);
    }
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for (place, _) in of.points().iter().enumerate().filter(|(_, point)| point.is_feasible()) {
        x.push(place as f64 + 1.0);
        y.push(objective.values[place]);
    }
    let panel = Panel::new(objective.axis)
        .series(Series::steps("best so far", runs, values))
        .series(Series::dots("meets every constraint", x, y).colour(Colour::Category(1)))
        .legend(Legend::Above);
    let last = of.points().len().max(2) as f64;
    Figure::new(Axis::new("run", "").starting_at(1.0).ending_at(last)).size_mm(120.0, 60.0).panel(panel)
}

impl Outcome {
    /// The places of the points that were the best when they were run.
    fn improvements(&self) -> Vec<usize> {
        let sign = match self.request().goal {
            Goal::Minimize => 1.0,
            Goal::Maximize => -1.0,
        };
        let rank =
            |point: &Reached| if point.is_feasible() { (0.0, sign * number(point, 0)) } else { (point.violation, 0.0) };
        let mut least = (f64::INFINITY, f64::INFINITY);
        let mut places = Vec::new();
        for (place, point) in self.points().iter().enumerate() {
            if rank(point) < least {
                least = rank(point);
                places.push(place);
            }
        }
        places
    }
}
