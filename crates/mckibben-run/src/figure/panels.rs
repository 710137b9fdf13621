//! Panels of curves over time: their colours, names, limits, strips and marks.
//!
//! | runs | the colour is of | the pattern is of |
//! |---|---|---|
//! | one, of one actuator | the place: actuator, regulator, hose | the place |
//! | one, of several | the part | the part |
//! | several | the run | the part |
//!
//! Set points are dotted in the colour of what they are of.

use super::choice::{Choice, Group, Line, Run};
use super::quantity::SET_POINT;
use super::{envelope, marks};
use mckibben_plot::{Axis, Colour, Dash, Figure, Panel, Series, Span, Strip, Style};

/// Patterns in the order of use; dots are those of set points.
const DASHES: [Dash; 5] = [Dash::Solid, Dash::Dashed, Dash::DashDot, Dash::LongDash, Dash::DashDotDot];
/// Colours before they repeat.
const COLOURS: usize = 7;
/// Strips up to this number stand above every panel, more of them above the first alone.
const STRIPS: usize = 2;

/// How the curves of a figure are distinguished.
#[derive(Clone, Debug)]
pub(crate) struct Looks<'s> {
    runs: Vec<Run<'s>>,
    /// The actuators of all runs.
    actuators: Vec<&'s str>,
}

impl<'s> Looks<'s> {
    pub(crate) fn new(runs: &[Run<'s>]) -> Self {
        let mut actuators: Vec<&str> = Vec::new();
        for name in runs.iter().flat_map(|run| &run.source.actuators) {
            if !actuators.contains(&name.as_str()) {
                actuators.push(name);
            }
        }
        Self { runs: runs.to_vec(), actuators }
    }

    pub(crate) fn runs(&self) -> &[Run<'s>] {
        &self.runs
    }

    /// Whether all is of one run of one actuator: then marks are in the colour of text.
    pub(crate) fn is_one(&self) -> bool {
        self.runs.len() == 1 && self.actuators.len() == 1
    }

    /// The number of a part among the actuators, or among the others of its panel.
    fn part(&self, group: &Group<'_>, part: &str) -> usize {
        let among = self.actuators.iter().position(|name| *name == part);
        among.unwrap_or_else(|| {
            let mut others: Vec<&str> = Vec::new();
            for line in &group.lines {
                let its = line.column.of.part.as_str();
                if !others.contains(&its) && !self.actuators.contains(&its) {
                    others.push(its);
                }
            }
            others.iter().position(|its| *its == part).unwrap_or(0)
        })
    }

    fn place(&self, group: &Group<'_>, place: &str) -> usize {
        let mut places = vec!["", SET_POINT];
        for line in &group.lines {
            let its = line.column.of.place.as_str();
            if !places.contains(&its) {
                places.push(its);
            }
        }
        places.iter().position(|its| *its == place).unwrap_or(0).saturating_sub(1)
    }

    /// Whether a panel is of one place that is not the actuator itself, such as a supply.
    fn is_elsewhere(group: &Group<'_>) -> bool {
        let place = &group.lines[0].column.of.place;
        !place.is_empty() && group.lines.iter().all(|line| line.column.of.place == *place)
    }

    /// The colour of a part's marks and strips.
    pub(crate) fn colour_of(&self, run: usize, part: &str) -> Colour {
        match (self.runs.len(), self.actuators.iter().position(|name| *name == part)) {
            (2.., _) => Colour::Category(run),
            (_, Some(index)) => Colour::Category(index),
            (_, None) => Colour::Neutral,
        }
    }

    /// The colour of a part that is no actuator, so that it is not taken for one as long as there are colours left.
    fn other(&self, group: &Group<'_>, number: usize) -> Colour {
        let parts = group.lines.iter().map(|line| line.column.of.part.as_str());
        let others = parts.filter(|part| !self.actuators.contains(part));
        let others = others.map(|part| self.part(group, part)).max().unwrap_or(0) + 1;
        match (self.actuators.len(), others) {
            (_, 1) => Colour::Neutral,
            (many, few) if many + few <= COLOURS => Colour::Category(many + number),
            _ => Colour::Category(number),
        }
    }

    /// The colour and the pattern of a curve.
    pub(crate) fn of(&self, group: &Group<'_>, line: &Line<'_>) -> (Colour, Dash) {
        let of = &line.column.of;
        let (part, place) = (self.part(group, &of.part), self.place(group, &of.place));
        let colour = match (self.runs.len(), self.actuators.len()) {
            (2.., _) => Colour::Category(line.run),
            (_, ..=1) if Self::is_elsewhere(group) => Colour::Neutral,
            (_, 2..) if !self.actuators.contains(&of.part.as_str()) => self.other(group, part),
            // The set point of what one regulator makes is in the colour of that.
            (_, ..=1) if of.place == SET_POINT && self.has_regulated(group) => Colour::Category(1),
            (_, ..=1) if self.is_alone(group) => Colour::Category(place),
            _ => Colour::Category(part),
        };
        let place = if Self::is_elsewhere(group) { 0 } else { place };
        let dash = if of.place == SET_POINT { Dash::Dotted } else { DASHES[(part + place) % DASHES.len()] };
        (colour, dash)
    }

    fn has_regulated(&self, group: &Group<'_>) -> bool {
        group.lines.iter().any(|line| line.column.of.place == "regulated")
    }

    /// Whether a panel is of one part alone.
    fn is_alone(&self, group: &Group<'_>) -> bool {
        group.lines.iter().all(|line| line.column.of.part == group.lines[0].column.of.part)
    }

    /// The name of a curve in the legend.
    fn name(&self, group: &Group<'_>, line: &Line<'_>) -> String {
        let of = &line.column.of;
        let places = group.lines.iter().any(|line| !["", SET_POINT].contains(&line.column.of.place.as_str()));
        let part = if self.is_alone(group) && (self.actuators.len() < 2 || !self.actuators.contains(&of.part.as_str()))
        {
            ""
        } else {
            of.part.as_str()
        };
        match (part, of.place.as_str()) {
            (_, SET_POINT) => SET_POINT.to_owned(),
            ("", "") if places => "actuator".to_owned(),
            (part, "") => part.to_owned(),
            ("", place) => place.to_owned(),
            (part, place) => format!("{part}, {place}"),
        }
    }

    /// Whose a curve is: the part, and of several runs the run.
    fn owner(&self, line: &Line<'_>) -> String {
        let run = if self.runs.len() > 1 { self.runs[line.run].label } else { "" };
        let names = [line.column.of.part.as_str(), run].into_iter().filter(|name| !name.is_empty());
        names.collect::<Vec<_>>().join(", ")
    }

    /// The entries of the legend of a panel as series without points.
    fn legend(&self, group: &Group<'_>) -> Vec<Series> {
        let empty = |label: String, colour, dash| Series::line(label, Vec::new(), Vec::new()).colour(colour).dash(dash);
        let mut entries: Vec<Series> = Vec::new();
        if self.runs.len() > 1 {
            let runs = self.runs.iter().enumerate();
            entries.extend(runs.map(|(run, of)| empty(of.label.to_owned(), Colour::Category(run), Dash::Solid)));
        }
        for line in &group.lines {
            let (label, (colour, dash)) = (self.name(group, line), self.of(group, line));
            let is_shared = self.runs.len() > 1 || (label == SET_POINT && self.actuators.len() > 1);
            let entry = empty(label, if is_shared { Colour::Neutral } else { colour }, dash);
            if !entry.label.is_empty() && !entries.iter().any(|known| known.label == entry.label) {
                entries.push(entry);
            }
        }
        entries.sort_by_key(|entry| entry.label == SET_POINT);
        entries
    }
}

/// The panels over the times from `begin` on, and whether envelopes take the place of curves in them.
pub(crate) fn figure(choice: &Choice<'_>, looks: &Looks<'_>, (begin, end, whole): (f64, f64, bool)) -> (Figure, bool) {
    let mut figure = Figure::new(Axis::new("time", "s").starting_at(begin).ending_at(end));
    let mut has_envelope = false;
    for (index, group) in choice.groups.iter().enumerate() {
        let (panel, envelope) = panel(group, looks, (begin, whole));
        has_envelope |= envelope;
        figure = figure.panel(strips(panel, looks, index == 0));
    }
    marks::place(&mut figure, choice, looks);
    (figure, has_envelope)
}

fn panel(group: &Group<'_>, looks: &Looks<'_>, (begin, whole): (f64, bool)) -> (Panel, bool) {
    let shown = group.shown();
    let (low, high, largest) = group.extent();
    let least = group.tolerance();
    let mut axis = Axis::new(group.title.clone(), shown.text.clone());
    if high - low <= least {
        // Noise is a level line: the axis says how large the value is, not how it rounds.
        let around = (0.05 * largest).max(10.0 * least);
        axis = axis.starting_at(shown.number(low - around)).ending_at(shown.number(high + around));
    }
    let mut panel = Panel::new(axis);
    for entry in looks.legend(group) {
        panel = panel.series(entry);
    }
    let (mut bands, mut curves) = (Vec::new(), Vec::new());
    for line in &group.lines {
        let (colour, dash) = looks.of(group, line);
        let (time, values) = (&line.source.time, &line.column.values);
        let scaled = |values: &[f64]| values.iter().map(|value| shown.number(*value)).collect::<Vec<f64>>();
        let envelope = if whole && high - low > least { envelope::of(time, values, high - low) } else { None };
        if let Some(found) = envelope {
            let band = Span::between("", found.time.clone(), scaled(&found.lower), scaled(&found.upper));
            bands.push(band.colour(colour));
            curves.push(Series::line("", found.time, scaled(&found.mean)).colour(colour).dash(dash));
            continue;
        }
        let from = time.partition_point(|time| *time < begin).saturating_sub(1);
        let is_goal = line.column.of.place == SET_POINT;
        let style = if is_goal { Style::Steps } else { Style::Line };
        let series = Series::line("", time[from..].to_vec(), scaled(&values[from..]));
        curves.push(Series { style, ..series.colour(colour).dash(dash) });
    }
    let has_envelope = !bands.is_empty();
    panel = bands.into_iter().fold(panel, Panel::span);
    panel = curves.into_iter().fold(panel, Panel::series);
    (if whole { limits(panel, group, looks) } else { panel }, has_envelope)
}

/// The name and the colour of a curve.
type Owner = (String, Colour);

/// The panel with the limits that its curves come near: further away they would only flatten the curves. Where there are several of a
/// kind, each has the colour and the name of its curve.
fn limits(mut panel: Panel, group: &Group<'_>, looks: &Looks<'_>) -> Panel {
    let shown = group.shown();
    let (low, high, _) = group.extent();
    let near = 0.15 * (high - low).max(1e3 * group.floor);
    let mut drawn: Vec<(f64, &str, Vec<Owner>)> = Vec::new();
    for line in &group.lines {
        let of = &line.column.of;
        let owner = (looks.owner(line), looks.of(group, line).0);
        let its = line.source.limits.iter().filter(|limit| limit.part == of.part && limit.quantity == of.quantity);
        for limit in its.filter(|limit| (low - near..=high + near).contains(&limit.value)) {
            match drawn.iter_mut().find(|(value, words, _)| (*value, *words) == (limit.value, limit.words)) {
                Some((.., owners)) if owners.contains(&owner) => {}
                Some((.., owners)) => owners.push(owner.clone()),
                None => drawn.push((limit.value, limit.words, vec![owner.clone()])),
            }
        }
    }
    let is_alone = |words: &str| drawn.iter().filter(|(_, its, _)| *its == words).count() == 1;
    for (value, words, owners) in &drawn {
        let value = shown.number(*value);
        panel = if is_alone(words) {
            panel.horizontal(value, *words)
        } else {
            let names: Vec<&str> = owners.iter().map(|(name, _)| name.as_str()).collect();
            // What several share has the colour of none.
            let colour = if let [(_, colour)] = owners[..] { colour } else { Colour::Neutral };
            panel.horizontal_of(value, format!("{words}, {}", names.join(" and ")), colour)
        };
    }
    panel
}

/// The panel with a strip for each supply that opens and closes.
fn strips(mut panel: Panel, looks: &Looks<'_>, is_first: bool) -> Panel {
    let supplies: Vec<_> =
        looks.runs.iter().enumerate().flat_map(|(run, of)| of.source.switched().map(move |its| (run, its))).collect();
    if supplies.is_empty() || (supplies.len() > STRIPS && !is_first) {
        return panel;
    }
    let is_shared = looks.runs.len() > 1 || looks.actuators.len() > 1;
    if is_shared {
        let of = if looks.runs.len() > 1 { "run" } else { "actuator" };
        let label = format!("supply open, in the colour of each {of}");
        panel = panel.span(Span::intervals(label, Vec::new()));
    }
    for (run, supply) in supplies {
        let label = if is_shared { String::new() } else { "supply open".to_owned() };
        let colour = looks.colour_of(run, &supply.part);
        panel = panel.strip(Strip { label, intervals: supply.open.clone(), colour });
    }
    panel
}
