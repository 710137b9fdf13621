//! Events as marks on the curves that they belong to. A kind of which there are too many is counted in the note instead.

use super::choice::{Choice, Group, Line, Run};
use super::panels::Looks;
use super::source::Happened;
use super::symbols::{self, SYMBOLS, Side};
use crate::quantities::count;
use mckibben::simulation::EventKind;
use mckibben_plot::{Figure, Marks};

/// Marks of one kind in a run above which they are counted: they would hide what they point at.
const MOST: usize = 12;
/// Marks of all kinds in a run above which those of formulas are counted.
const MOST_OF_ALL: usize = 20;
/// Marks about one instant that are distinct, and the part of the time axis that is one instant: about the width of two marks.
const MOST_AT_ONCE: usize = 8;
const AT_ONCE: f64 = 0.02;
/// Kinds that say which formula of the air or of the force holds, and nothing that one observes on a rig.
const FORMULAS: [EventKind; 4] = [EventKind::Flow, EventKind::Regime, EventKind::Effectiveness, EventKind::ForceMap];

/// The kinds that are marked, and how many there are of those that are not.
fn kinds<'e>(runs: &[Run<'e>]) -> (Vec<EventKind>, Vec<(EventKind, usize)>) {
    let (mut marked, mut counted) = (Vec::new(), Vec::new());
    let mut numbers_of_marked = Vec::new();
    for (kind, ..) in SYMBOLS {
        let numbers =
            runs.iter().map(|run| run.source.events.iter().filter(|event| is_marked(run, event, kind)).count());
        let (most, all) = numbers.fold((0, 0), |(most, all), number: usize| (most.max(number), all + number));
        match most {
            0 => {}
            1..=MOST => {
                marked.push(kind);
                numbers_of_marked.push((most, all));
            }
            _ => counted.push((kind, all)),
        }
    }
    for kind in FORMULAS {
        let total: usize = numbers_of_marked.iter().map(|(most, _)| most).sum();
        let Some(place) = marked.iter().position(|its| *its == kind).filter(|_| total > MOST_OF_ALL) else { continue };
        counted.push((marked.remove(place), numbers_of_marked.remove(place).1));
    }
    while let Some(place) = crowding(runs, &marked, &numbers_of_marked) {
        counted.push((marked.remove(place), numbers_of_marked.remove(place).1));
    }
    (marked, counted)
}

/// Of the kinds that stand about the instant with the most marks on curves of one side the place of that with the most marks in all,
/// where there are too many.
fn crowding(runs: &[Run<'_>], marked: &[EventKind], numbers: &[(usize, usize)]) -> Option<usize> {
    let width = AT_ONCE * runs.iter().map(|run| run.source.duration).fold(0.0, f64::max);
    let mut most: Option<(usize, usize)> = None;
    for (run, side) in runs.iter().flat_map(|run| [Side::Motion, Side::Air].map(|side| (run, side))) {
        let events = run.source.events.iter().filter_map(|event| {
            let place = marked.iter().position(|kind| is_marked(run, event, *kind))?;
            (symbols::side(event.kind) == side).then_some((event.time, place))
        });
        let mut events: Vec<(f64, usize)> = events.collect();
        events.sort_by(|one, other| one.0.total_cmp(&other.0));
        for (first, (time, _)) in events.iter().enumerate() {
            let about = &events[first..first + events[first..].partition_point(|(its, _)| *its <= time + width)];
            if about.len() > most.map_or(MOST_AT_ONCE, |(number, _)| number) {
                // Of equals the last: a rebound follows from what is taut.
                let crowding = about.iter().map(|(_, place)| *place).max_by_key(|place| (numbers[*place].1, *place));
                most = crowding.map(|place| (about.len(), place));
            }
        }
    }
    most.map(|(_, place)| place)
}

/// Whether an event is of a kind and not shown by a strip.
fn is_marked(run: &Run<'_>, event: &Happened, kind: EventKind) -> bool {
    let in_strip = || run.source.switched().any(|supply| supply.part == event.part);
    event.kind == kind && (kind != EventKind::Valve || !in_strip())
}

/// What is said of the kinds that are not marked; empty where all are.
pub(crate) fn note(runs: &[Run<'_>]) -> String {
    let counted = kinds(runs).1;
    if counted.is_empty() {
        return String::new();
    }
    let each = counted.iter().map(|(kind, number)| format!("{}\u{a0}×\u{a0}{}", count(*number as u64), kind.name()));
    format!("not marked: {}", each.collect::<Vec<_>>().join(", "))
}

/// Places the marks of all runs on the panels of a figure.
pub(crate) fn place(figure: &mut Figure, choice: &Choice<'_>, looks: &Looks<'_>) {
    let runs = looks.runs();
    for kind in kinds(runs).0 {
        let mut first = None;
        for (index, run) in runs.iter().enumerate() {
            for event in run.source.events.iter().filter(|event| is_marked(run, event, kind)) {
                let (panel, y) = stand(event, index, choice).map_or((0, None), |(panel, y)| (panel, Some(y)));
                let Some(its) = figure.panels.get_mut(panel) else { continue };
                let colour = looks.colour_of(index, if looks.is_one() { "-" } else { &event.part });
                let fresh = symbols::marks(kind, "", Vec::new(), Vec::new()).colour(colour);
                // Those on a curve and those on the edge are two lists.
                let like = |marks: &&mut Marks| {
                    (marks.symbol, marks.filled, marks.colour) == (fresh.symbol, fresh.filled, fresh.colour)
                        && !marks.x.is_empty()
                        && marks.y.is_empty() == y.is_none()
                };
                match its.marks.iter_mut().find(like) {
                    Some(marks) => {
                        marks.x.push(event.time);
                        marks.y.extend(y);
                    }
                    None => its.marks.push(Marks { x: vec![event.time], y: y.into_iter().collect(), ..fresh }),
                }
                first = Some(first.map_or(panel, |known: usize| known.min(panel)));
            }
        }
        if let Some(panel) = first.and_then(|panel| figure.panels.get_mut(panel)) {
            // The entry of the legend is in no actuator's colour.
            panel.marks.push(symbols::marks(kind, kind.name(), Vec::new(), Vec::new()));
        }
    }
}

/// The panel and the value in its unit where the mark of an event stands: on a curve of its part if there is one, first of what it
/// is of.
fn stand(event: &Happened, run: usize, choice: &Choice<'_>) -> Option<(usize, f64)> {
    let side = symbols::side(event.kind);
    // What supplies and hoses do stands on their own curves, where these are shown.
    let of_place: &[&str] = match event.kind {
        EventKind::Compressor => &["supply"],
        EventKind::Regulator => &["supply", "regulated"],
        EventKind::Regime => &["hose"],
        _ => &[],
    };
    let worth = |group: &Group<'_>, line: &Line<'_>| {
        let (part, place) = (&line.column.of.part, line.column.of.place.as_str());
        let elsewhere = match (place.is_empty(), of_place.contains(&place)) {
            (true, _) => usize::from(!of_place.is_empty()),
            (false, true) => 0,
            (false, false) => return None,
        };
        let of = group.lines.first().map_or("", |line| line.column.of.quantity.as_str());
        let is_air = ["gauge pressure", "absolute pressure", "air mass", "mass flow"].contains(&of);
        let other_side = usize::from(is_air != (side == Side::Air));
        let other_part = match (*part == event.part, event.part.is_empty() || part.is_empty()) {
            (true, _) => 0,
            (false, true) => 4,
            (false, false) => return None,
        };
        Some(2 * other_part + 2 * other_side + elsewhere)
    };
    let candidates = choice.groups.iter().enumerate().flat_map(|(index, group)| {
        let lines = group.lines.iter().filter(|line| line.run == run);
        lines.filter_map(move |line| Some((worth(group, line)?, index, line)))
    });
    let (_, index, line) = candidates.min_by_key(|(worth, index, _)| (*worth, *index))?;
    let (time, values) = (&line.source.time, &line.column.values);
    let after = time.partition_point(|time| *time <= event.time).clamp(1, time.len() - 1);
    let (from, to) = (time[after - 1], time[after]);
    let part = if to > from { ((event.time - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
    let value = values[after - 1] + part * (values[after] - values[after - 1]);
    Some((index, choice.groups[index].shown().number(value)))
}
