//! What a run came to, as text for people: of an actuator on its load, and what that of a joint and that of a plant have in common.

pub(crate) mod joint;
pub(crate) mod ledger;
pub(crate) mod plant;

use crate::describe;
use crate::terminal::{FAINT, HEADING, NOTABLE, entry, styled, wrap};
use mckibben::engine::Statistics;
use mckibben::plant::{Plant, RigPlant};
use mckibben::simulation::{EventKind, Rig};
use mckibben::valve::REFERENCE_DENSITY;
use mckibben_run::closed_loop::{Closed, Goal, Miss};
use mckibben_run::failure::Failure;
use mckibben_run::observation::{Ended, Observation, Range, Ripple, Steps};
use mckibben_run::quantities::{self, count, counted, given};
use mckibben_run::settle::{Settled, Settling};
use mckibben_run::text::{Alignment, Side};
use mckibben_run::units::{rounding, units};
use mckibben_scenario::{Assumed, Load, Muscle, Run, Scenario};
use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::time::Duration;

/// A space at which no line is broken.
const KEPT: &str = "\u{a0}";

/// Columns of an orbit that a short summary has.
const MAIN: [&str; 5] = ["length", "position", "angle", "tension", "gauge_pressure"];

/// Width of the column of names, and the most that names from a file make it.
const NAMES: usize = 14;
const MOST_NAMES: usize = 40;

/// The share of a step that is rounding of the parts into which it divides the sample interval.
const ROUNDING: f64 = 1e-9;

/// A column of values.
const VALUE: (Side, usize) = (Side::Right, 14);

/// What every summary prints, whatever ran.
#[derive(Clone, Copy, Debug)]
pub struct Common<'a> {
    /// The name of the scenario file.
    pub name: &'a str,
    /// How long the computer took.
    pub elapsed: Duration,
    /// The muscles with their names.
    pub muscles: &'a [(String, Muscle)],
    /// The assumed values in force.
    pub assumed: &'a [Assumed],
    /// What the run settles to, where that was requested.
    pub settled: Option<&'a Settled>,
    /// Whether everything is printed, not only the ten lines that matter most.
    pub verbose: bool,
}

/// What the summary of one actuator describes.
#[derive(Clone, Copy, Debug)]
pub struct Summary<'a> {
    /// What every summary prints.
    pub common: Common<'a>,
    /// The scenario as it was understood.
    pub scenario: &'a Scenario,
    /// What was simulated.
    pub rig: &'a Rig,
    /// The controller's part in it, if there is one.
    pub control: Option<&'a Closed>,
    /// Its figures.
    pub observation: &'a Observation,
}

impl Summary<'_> {
    /// The summary, with colours.
    ///
    /// # Errors
    /// [`Failure::stopped`] for a number that is not finite.
    pub fn render(&self) -> Result<String, Failure> {
        let page = &Page::of(self.common.verbose);
        self.what_ran(page);
        self.states(page);
        self.air(page);
        page.events(&self.observation.events);
        if let Some(closed) = self.control {
            goals(page, &closed.goals);
            effort(page, closed, self.observation.ended.ledger.air_used());
        }
        let periodic = self.control.is_some() || is_periodic(RigPlant::new(self.rig).plant());
        page.settled(self.common.settled, periodic);
        if page.verbose {
            let ended = &self.observation.ended;
            ledger::energy(page, &ended.ledger, &["muscle"]);
            if ended.draws {
                ledger::exergy(page, &ended.ledger);
            }
        }
        page.finish(&self.common.assumptions())
    }

    fn what_ran(&self, page: &Page) {
        let run = &self.scenario.run;
        self.common.title(page, run);
        if page.verbose {
            braids(page, self.common.muscles);
        }
        page.line("load", &describe::load(&self.scenario.load));
        if let Some(tendon) = &self.scenario.tendon {
            page.line("tendon", &format!("{} in series", given(tendon.stiffness, "N/m")));
        }
        page.line("drive", &describe::drive(self.scenario));
        if page.verbose {
            page.line("air", &describe::air(&self.scenario.air.process));
        }
        self.common.cost(page, &self.observation.ended, run);
    }

    fn states(&self, page: &Page) {
        let (last, extremes) = (&self.observation.last, &self.observation.extremes);
        let limits = self.rig.actuator().limits();
        let longest = limits.max_length();
        let contraction = |length: f64| (longest - length) / longest;
        let atmosphere = self.rig.actuator().air().atmosphere().0;
        let gauge = |range: Range| Range { least: range.least - atmosphere, greatest: range.greatest - atmosphere };
        let shortening =
            Range { least: contraction(extremes.length.greatest), greatest: contraction(extremes.length.least) };
        page.heading("State");
        page.head(["at the end", "least", "greatest"]);
        page.range("length", last.length, extremes.length, "m");
        let percents =
            [contraction(last.length), shortening.least, shortening.greatest].map(|share| page.percent(share));
        page.columns("contraction", percents);
        if page.verbose {
            page.range("velocity", last.velocity, extremes.velocity, "m/s");
        }
        page.range("tension", last.tension, extremes.tension, "N");
        page.range("gauge pressure", last.pressure.0 - atmosphere, gauge(extremes.pressure), "Pa");
        if let Some(tendon) = self.rig.tendon() {
            let stretch = page.quantity(last.tension / tendon.stiffness(), "m");
            let distance = page.quantity(last.load_distance, "m");
            page.line("tendon", &format!("stretched by {stretch} at the end, the load at {distance}"));
        }
        if page.verbose {
            page.range("temperature", last.temperature, extremes.temperature, "K");
            let inside = format!("{} in {} at the end", page.quantity(last.air_mass, "kg"), page.volume(last.volume));
            page.line("air", &inside);
        }
        match last.supply_pressure.filter(|_| self.rig.regulator().is_some()) {
            Some(regulated) => {
                page.line(
                    "regulator",
                    &format!("at {} gauge at the end", page.quantity(regulated.0 - atmosphere, "Pa")),
                );
            }
            None if page.verbose => page.line("valve", &format!("{} at the end", last.ports.name())),
            None => {}
        }
        // A length that is fixed has no ripple, whatever the pressure does.
        let moves = !matches!(self.scenario.load, Load::Isometric);
        if let Some(ripple) = self.observation.ripple.as_ref().filter(|_| moves) {
            page.line("under PWM", &under_pwm(page, ripple, contraction(ripple.mean)));
        }
    }

    fn air(&self, page: &Page) {
        let air = &self.observation.air;
        if self.scenario.valve.is_none() {
            return;
        }
        let said = |mass: f64| format!("{}, {} ANR", page.quantity(mass, "kg"), page.volume(mass / REFERENCE_DENSITY));
        if page.verbose {
            page.heading("Air");
            page.line("from supply", &said(air.from_supply));
            page.line("to exhaust", &said(air.to_atmosphere));
        } else {
            page.line("air", &format!("{} from the supply", said(air.from_supply)));
        }
        // Flow against the usual direction is worth a line only where there is any.
        for (name, mass) in [("to supply", air.to_supply), ("from exhaust", air.from_atmosphere)] {
            if page.sound(mass) > 1e-12 * (air.from_supply + air.to_atmosphere) {
                page.line(name, &said(mass));
            }
        }
    }
}

impl Common<'_> {
    /// The heading: which file ran for how long.
    pub(crate) fn title(&self, page: &Page, run: &Run) {
        page.heading(&format!("{}  {}", self.name, styled(FAINT, given(run.duration, "s"))));
    }

    /// The engine and what the run cost; at fixed steps always their length and what that was chosen for.
    pub(crate) fn cost(&self, page: &Page, ended: &Ended, run: &Run) {
        if page.verbose {
            page.line("engine", &describe::engine(run));
        }
        if let Some(Steps { step, chosen, .. }) = ended.steps {
            page.line("step", &step_of(page, step, chosen, run));
        }
        if page.verbose {
            page.line("cost", &format!("{}, {}", work(ended.counts), page.quantity(self.elapsed.as_secs_f64(), "s")));
        }
    }

    /// The closing note about assumed parameters.
    pub(crate) fn assumptions(&self) -> String {
        assumptions(self.assumed)
    }
}

/// The braids of the muscles, each with its names.
pub(crate) fn braids(page: &Page, muscles: &[(String, Muscle)]) {
    describe::muscles(muscles).iter().for_each(|(names, text)| page.line(names, text));
}

/// How far the goals of a controller were missed.
pub(crate) fn goals<'g>(page: &Page, goals: impl IntoIterator<Item = &'g Goal>) {
    let name = |goal: &Goal| match goal.whose {
        Some(1) => "  antagonist",
        _ => describe::controlled(goal.quantity),
    };
    goals_by_name(page, goals.into_iter().map(|goal| (name(goal).to_owned(), goal)));
}

/// How far goals with names were missed.
pub(crate) fn goals_by_name<'g>(page: &Page, goals: impl IntoIterator<Item = (String, &'g Goal)>) {
    page.heading("Control");
    // Wider than the other tables: a stiffness has a long unit.
    let row = |name: &str, cells: [String; 3]| page.row(name, cells, [16, 16, 12]);
    row("", ["rms error", "largest error", "at"].map(str::to_owned));
    for (name, goal) in goals {
        let (Miss { rms, largest, at }, unit) = (goal.miss(), goal.quantity.rows().set_point.unit);
        row(&name, [page.quantity(rms, unit), page.quantity(largest, unit), page.quantity(at, "s")]);
    }
}

/// What a controller did and what it took of air in kg.
pub(crate) fn effort(page: &Page, closed: &Closed, air: f64) {
    page.line("samples", &format!("{}; errors are as measured then", count(closed.samples as u64)));
    let requests: Vec<String> = closed.requests.iter().map(|requests| count(*requests as u64)).collect();
    let changes = if closed.requests == [1] { "change" } else { "changes" };
    page.line("requests", &format!("{} {changes} of the valve's command", requests.join(" and ")));
    page.line("air used", &format!("{} from the supply", page.quantity(air, "kg")));
}

/// How many steps and evaluations a run took.
fn work(counts: Statistics) -> String {
    let steps = counted(counts.explicit_steps + counts.implicit_steps, "step");
    let implicit = match counts.implicit_steps {
        0 => String::new(),
        implicit => format!(" ({} of them implicit)", count(implicit)),
    };
    let (rejected, evaluations) = (count(counts.rejected_steps), counted(counts.evaluations, "evaluation"));
    format!("{steps}{implicit}, {rejected} repeated, {evaluations}")
}

/// The longest step, and on what ground it was taken: the time in s that was compared, and the greatest error.
fn step_of(page: &Page, step: f64, chosen: Option<[f64; 2]>, run: &Run) -> String {
    let Some([compared, greatest]) = chosen else {
        let longest = given(step, "s");
        return match run.step.filter(|most| step < most * (1.0 - ROUNDING)) {
            None => format!("at most {longest}, as given"),
            Some(most) => format!(
                "at most {longest}: the longest that divides run.sample_interval = {} and is not above run.step = {}",
                given(run.sample_interval, "s"),
                given(most, "s")
            ),
        };
    };
    let over =
        if compared < run.duration { format!(" over the first {}", given(compared, "s")) } else { String::new() };
    format!(
        "at most {}, chosen for an accuracy of {:e}: measured error {:.1e} of the range{over}",
        given(step, "s"),
        run.accuracy,
        page.sound(greatest)
    )
}

/// The length under PWM in words; of a run that has not settled no ripple is printed, since it would be that of the
/// swing.
fn under_pwm(page: &Page, ripple: &Ripple, contraction: f64) -> String {
    let drift = ripple.drift.map(|drift| format!(", and its mean moves by {} a period", page.quantity(drift, "m")));
    if !ripple.settled {
        return format!(
            "not settled: the length travels {} in the last {}{}; --settle finds its orbit",
            page.quantity(ripple.travel, "m"),
            counted(ripple.periods, "period"),
            drift.unwrap_or_default(),
        );
    }
    let motion = match ripple.is_seen() {
        true => format!("ripple {} peak to peak", page.quantity(ripple.peak_to_peak, "m")),
        false => "no ripple".to_owned(),
    };
    let mean = page.quantity(ripple.mean, "m");
    format!("settled: mean length {mean} (contraction {}), {motion}", page.percent(contraction))
}

/// Whether a plant without controllers has pulses or given sinusoids. What has no common period does not settle at all.
pub(crate) fn is_periodic(plant: &Plant) -> bool {
    !matches!(plant.period(), Ok(None))
}

/// The closing note about assumed parameters.
pub(crate) fn assumptions(assumed: &[Assumed]) -> String {
    if assumed.is_empty() {
        return String::new();
    }
    let named: Vec<String> =
        assumed.iter().map(|value| format!("{} = {}", value.parameter.key, value.text).replace(' ', KEPT)).collect();
    let mut presets: Vec<&str> = assumed.iter().filter_map(|value| value.preset).collect();
    presets.dedup();
    let commands: Vec<String> = presets.iter().map(|preset| format!("`mckibben{KEPT}presets{KEPT}{preset}`")).collect();
    let from = if commands.is_empty() { String::new() } else { format!("; see {}", commands.join(" and ")) };
    let note = wrap(&format!("{}{from}.", named.join(", ")), "  ").replace(KEPT, " ");
    format!("\n{}\n{note}\n", styled(NOTABLE, "Assumed, stated by no source and not set in the file"))
}

/// The text with each number tied to the word behind it, which is its unit or its next group of digits.
fn keep_numbers(text: &str) -> String {
    let mut kept = String::new();
    for word in text.split(' ') {
        if !kept.is_empty() {
            let before = kept.rsplit([' ', ',', '(']).next().unwrap_or_default();
            let is_number = before.ends_with(|last: char| last.is_ascii_digit());
            kept.push_str(if is_number { KEPT } else { " " });
        }
        kept.push_str(word);
    }
    kept
}

/// Text with a column of names. A number that is not finite is remembered with the name of its line.
#[derive(Debug, Default)]
pub(crate) struct Page {
    /// Whether everything is printed.
    pub(crate) verbose: bool,
    /// How much wider than usual the column of names is, for names from a file.
    wider: Cell<usize>,
    text: RefCell<String>,
    /// A number of the line under way that is not finite.
    unsound: Cell<Option<f64>>,
    /// The first line with such a number.
    fault: RefCell<Option<String>>,
}

impl Page {
    /// An empty page.
    pub(crate) fn of(verbose: bool) -> Self {
        Self { verbose, ..Self::default() }
    }

    /// The text with what follows it.
    ///
    /// # Errors
    /// [`Failure::stopped`] when a number was not finite.
    pub(crate) fn finish(&self, end: &str) -> Result<String, Failure> {
        match self.fault.take() {
            None => Ok(self.text.take() + end),
            Some(fault) => Err(Failure::not_finite(&fault)),
        }
    }

    /// A number as it is, noted where it is not finite.
    pub(crate) fn sound(&self, value: f64) -> f64 {
        if !value.is_finite() {
            self.unsound.set(Some(value));
        }
        value
    }

    /// A value with its unit.
    pub(crate) fn quantity(&self, value: f64, unit: &str) -> String {
        quantities::quantity(self.sound(value), unit)
    }

    /// Four digits.
    pub(crate) fn digits(&self, value: f64) -> String {
        quantities::digits(self.sound(value))
    }

    /// A ratio in percent.
    pub(crate) fn percent(&self, value: f64) -> String {
        quantities::percent(self.sound(value))
    }

    /// A volume.
    pub(crate) fn volume(&self, cubic_metres: f64) -> String {
        self.quantity(cubic_metres, "m^3")
    }

    /// Ends a line of this name: a number in it that was not finite is its fault.
    fn ends(&self, name: &str) {
        if let Some(value) = self.unsound.take() {
            self.fault.borrow_mut().get_or_insert_with(|| format!("the summary's {} = {value}", name.trim()));
        }
    }

    /// Makes room for names of a table, up to the next heading.
    pub(crate) fn fit<'n>(&self, names: impl IntoIterator<Item = &'n str>) {
        let longest = names.into_iter().map(|name| name.chars().count()).max().unwrap_or(0);
        self.wider.set((longest + 1).clamp(NAMES, MOST_NAMES) - NAMES);
    }

    pub(crate) fn heading(&self, heading: &str) {
        self.wider.set(0);
        let gap = if self.text.borrow().is_empty() { "" } else { "\n" };
        self.put(format_args!("{gap}{}\n", styled(HEADING, heading)));
    }

    /// A name and some text, broken where the terminal ends.
    pub(crate) fn line(&self, name: &str, text: &str) {
        self.ends(name);
        self.put(format_args!("{}", entry(name, NAMES, &keep_numbers(text)).replace(KEPT, " ")));
    }

    /// A name, a value at the right of its column, and what it is.
    pub(crate) fn value(&self, name: &str, value: &str, what: &str) {
        self.ends(name);
        let columns = Alignment::new([(Side::Left, NAMES), VALUE]).without_gaps();
        self.put(format_args!("  {}  {}\n", columns.line(&[name, value]), styled(FAINT, what)));
    }

    pub(crate) fn head(&self, names: [&str; 3]) {
        let [a, b, c] = names;
        let columns = Alignment::new([(Side::Left, self.wider.get() + NAMES + 2), VALUE, VALUE, VALUE]).without_gaps();
        self.put(format_args!("{}\n", styled(FAINT, columns.line(&["", a, b, c]))));
    }

    pub(crate) fn columns(&self, name: &str, values: [String; 3]) {
        self.row(name, values, [VALUE.1; 3]);
    }

    /// A name and values at the right of columns of these widths.
    fn row(&self, name: &str, [a, b, c]: [String; 3], widths: [usize; 3]) {
        self.ends(name);
        let values = widths.map(|width| (Side::Right, width));
        let columns = Alignment::new([(Side::Left, self.wider.get() + NAMES)].into_iter().chain(values)).without_gaps();
        self.put(format_args!("  {}\n", columns.line(&[name, &a, &b, &c])));
    }

    /// Three values in one unit.
    pub(crate) fn range(&self, name: &str, end: f64, Range { least, greatest }: Range, unit: &str) {
        self.values(name, [end, least, greatest], unit);
    }

    /// Values in one unit. A remainder of rounding is no value; the largest of them gives the measure.
    fn values(&self, name: &str, values: [f64; 3], unit: &str) {
        self.values_with(name, values, unit, [false; 3]);
    }

    /// Values in one unit, some of which may be differences: their unit has no offset.
    fn values_with(&self, name: &str, values: [f64; 3], unit: &str, is_difference: [bool; 3]) {
        let fine = 1e-9 * values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let fine = fine.max(rounding(unit));
        let values = values.map(|value| if value.abs() < fine { 0.0 } else { value });
        let own = [false, true].map(|is_difference| {
            if is_difference { units().of_differences().common(unit, values) } else { units().common(unit, values) }
        });
        let said = |place: usize| {
            let shown = &own[usize::from(is_difference[place])];
            let number = shown.number(self.sound(values[place]));
            shown.with(&if unit == "K" { format!("{number:.1}") } else { quantities::digits(number) })
        };
        self.columns(name, [0, 1, 2].map(said));
    }

    /// Energies in one unit, each with what it is; the first two always, the others where they are more than rounding.
    pub(crate) fn energies(&self, named: &[(&str, f64, &str)], turnover: f64) {
        let shown = units().common("J", named.iter().map(|(_, value, _)| *value));
        for (index, (name, value, what)) in named.iter().enumerate() {
            if index < 2 || value.abs() > 1e-12 * turnover {
                self.value(name, &shown.with(&self.digits(shown.number(*value))), what);
            }
        }
    }

    /// How many events there were of each kind.
    pub(crate) fn events(&self, counts: &BTreeMap<EventKind, u64>) {
        let kinds = counts.iter().map(|(kind, number)| format!("{}{KEPT}{}", kind.name(), count(*number)));
        let kinds = kinds.collect::<Vec<_>>().join(", ");
        let total: u64 = counts.values().sum();
        let kinds = if total == 0 { "none".to_owned() } else { kinds };
        if self.verbose {
            self.heading("Events");
            self.line(&count(total), &kinds);
        } else {
            self.line("events", &kinds);
        }
    }

    /// What repeats on the orbit that the run settles to; what has no period settles at an equilibrium.
    pub(crate) fn settled(&self, settled: Option<&Settled>, periodic: bool) {
        let Some(Settled { orbit, rows }) = settled else { return };
        self.heading("Settled");
        let (periods, period) = (counted(orbit.periods, "period"), given(orbit.period, "s"));
        if !orbit.settled {
            let left = self.sound(orbit.residual);
            let text = format!(
                "not within {periods} of {period} behind the end: the states still change by {left:.1e} of their size \
                 a period"
            );
            return self.line("", &text);
        }
        let (name, after) = if periodic {
            ("orbit", format!("{periods} of {period}"))
        } else {
            ("equilibrium", given(orbit.periods as f64 * orbit.period, "s"))
        };
        let found = match orbit.guesses {
            0 => format!("reached {after} after the end of the run"),
            1 => format!("found by 1 guess in {after} after the end of the run"),
            guesses => format!("found by {} guesses in {after} after the end of the run", count(guesses)),
        };
        self.line(name, &found);
        let is_main = |row: &&Settling| {
            let name = row.name.rsplit('.').next().unwrap_or_default();
            self.verbose || MAIN.contains(&name.trim_start_matches("antagonist_"))
        };
        let rows: Vec<(String, &Settling)> =
            rows.iter().filter(is_main).map(|row| (row.name.replace(['_', '.'], " "), row)).collect();
        self.fit(rows.iter().map(|(name, _)| name.as_str()));
        self.head(["mean", "ripple", "greatest"]);
        for (name, row) in rows {
            let values = [row.mean, row.ripple(), row.greatest];
            self.values_with(&name, values, &row.unit, [false, true, false]);
        }
    }

    fn put(&self, text: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = self.text.borrow_mut().write_fmt(text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_finite_is_an_error_that_names_its_line() {
        let page = Page::default();
        page.range("length", 1.0, Range { least: f64::NAN, greatest: 2.0 }, "m");
        page.line("fine", &page.quantity(1.0, "m"));
        assert!(page.finish("").expect_err("a length").to_string().contains("length = NaN"));
    }
}
