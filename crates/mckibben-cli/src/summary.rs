//! What a run came to, as text for people.

use crate::closed_loop::{Closed, Goal, Miss};
use crate::describe;
use crate::engine::Outcome;
use crate::events;
use crate::observation::{Observation, Range, Ripple};
use crate::quantities::{common_prefix, count, digits, given, percent, quantity};
use crate::terminal::{FAINT, HEADING, NOTABLE, styled, width, wrap};
use mckibben::air::Process;
use mckibben::simulation::{CircuitAudit, Counts, EnergyAudit};
use mckibben::valve::REFERENCE_DENSITY;
use mckibben_scenario::{Assumed, Experiment, Load, Run, Scenario};
use std::fmt::Write as _;
use std::time::Duration;

/// A change of the mean length below this part of it is not worth telling.
const SETTLED: f64 = 1e-7;

/// A space at which no line is broken.
const KEPT: &str = "\u{a0}";

/// Width of the column of names.
const NAMES: usize = 14;

/// Everything that the summary tells about.
#[derive(Clone, Copy, Debug)]
pub struct Summary<'a> {
    /// The name of the scenario file.
    pub name: &'a str,
    /// The scenario as it was understood.
    pub scenario: &'a Scenario,
    /// What was simulated.
    pub experiment: &'a Experiment,
    /// The run.
    pub outcome: &'a Outcome,
    /// The controller's part in it, if there is one.
    pub control: Option<&'a Closed>,
    /// Its figures.
    pub observation: &'a Observation,
    /// How long the computer took.
    pub elapsed: Duration,
    /// The assumed values in force.
    pub assumed: &'a [Assumed],
}

impl Summary<'_> {
    /// The summary, with colours.
    pub fn render(&self) -> String {
        let mut page = Page::default();
        self.what_ran(&mut page);
        self.events(&mut page);
        self.states(&mut page);
        if let Some(closed) = self.control {
            goals(&mut page, &closed.goals);
            let air = quantity(self.observation.air.from_supply, "kg");
            effort(&mut page, closed.samples(), &count(closed.requests() as u64), Some(&air));
        }
        self.air(&mut page);
        if let Outcome::Located(trajectory) = self.outcome {
            let of_circuit = trajectory.circuit();
            energy(&mut page, &of_circuit.map_or_else(|| trajectory.audit(), |audit| audit.work));
            if let Some(audit) = of_circuit {
                let sums = [audit.residual(), audit.turnover()];
                circuit(&mut page, &audit, trajectory.rig().actuator().air().process(), sums);
            }
        }
        page.text + &assumptions(self.assumed)
    }

    fn what_ran(&self, page: &mut Page) {
        let run = &self.experiment.run;
        page.heading(&format!("{}  {}", self.name, styled(FAINT, given(run.duration, "s"))));
        page.line("load", &describe::load(&self.scenario.load));
        if let Some(tendon) = &self.scenario.tendon {
            page.line("tendon", &format!("{} in series", given(tendon.stiffness, "N/m")));
        }
        page.line("drive", &describe::drive(self.scenario));
        page.line("air", &describe::air(&self.scenario.air.process));
        page.line("engine", &describe::engine(run));
        if let Outcome::Stepped { step, chosen, .. } = self.outcome {
            let error = chosen.map(|error| [error.compared, error.greatest()]);
            page.line("step", &step_of(*step, error, run));
        }
        let steps = match self.outcome {
            Outcome::Located(trajectory) => cost(trajectory.counts()),
            Outcome::Stepped { steps, .. } => format!("{} steps", count(*steps)),
        };
        page.line("cost", &format!("{steps}, {}", quantity(self.elapsed.as_secs_f64(), "s")));
    }

    fn states(&self, page: &mut Page) {
        let (last, extremes) = (&self.observation.last, &self.observation.extremes);
        let limits = self.experiment.rig.actuator().limits();
        let longest = limits.max_length();
        let contraction = |length: f64| (longest - length) / longest;
        let atmosphere = self.experiment.rig.actuator().air().atmosphere().0;
        let gauge = |range: Range| Range { least: range.least - atmosphere, greatest: range.greatest - atmosphere };
        let shortening =
            Range { least: contraction(extremes.length.greatest), greatest: contraction(extremes.length.least) };
        page.heading("State");
        page.head(["at the end", "least", "greatest"]);
        page.range("length", last.length, extremes.length, "m");
        let percents = [contraction(last.length), shortening.least, shortening.greatest].map(percent);
        page.columns("contraction", percents);
        page.range("velocity", last.velocity, extremes.velocity, "m/s");
        page.range("tension", last.tension, extremes.tension, "N");
        if let Some(tendon) = self.experiment.rig.tendon() {
            let stretch = quantity(last.tension / tendon.stiffness(), "m");
            let distance = quantity(last.load_distance, "m");
            page.line("tendon", &format!("stretched by {stretch} at the end, the load at {distance}"));
        }
        page.range("gauge pressure", last.pressure.0 - atmosphere, gauge(extremes.pressure), "Pa");
        let kelvin = |kelvin: f64| format!("{kelvin:.1} K");
        let temperature = &extremes.temperature;
        page.columns("temperature", [last.temperature, temperature.least, temperature.greatest].map(kelvin));
        page.line("air", &format!("{} in {} at the end", quantity(last.air_mass, "kg"), volume(last.volume)));
        match last.supply_pressure.filter(|_| self.experiment.rig.regulator().is_some()) {
            Some(regulated) => {
                page.line("regulator", &format!("at {} gauge at the end", quantity(regulated.0 - atmosphere, "Pa")));
            }
            None => page.line("valve", &format!("{} at the end", last.ports.name())),
        }
        // A length that is fixed has no ripple, whatever the pressure does.
        let moves = !matches!(self.scenario.load, Load::Isometric);
        if let Some(ripple) = self.observation.ripple.as_ref().filter(|_| moves) {
            page.line("under PWM", &under_pwm(ripple, contraction(ripple.mean)));
        }
    }

    fn air(&self, page: &mut Page) {
        let air = &self.observation.air;
        if self.scenario.valve.is_none() {
            return;
        }
        let told = |mass: f64| format!("{}, {} ANR", quantity(mass, "kg"), volume(mass / REFERENCE_DENSITY));
        page.heading("Air");
        if matches!(self.outcome, Outcome::Stepped { .. }) {
            page.line("in", &format!("{} (by the net change of each step)", told(air.from_supply)));
            page.line("out", &told(air.to_surroundings));
            return;
        }
        page.line("from supply", &told(air.from_supply));
        page.line("to exhaust", &told(air.to_surroundings));
        // Flow against the usual direction is worth a line only where there is any.
        for (name, mass) in [("to supply", air.to_supply), ("from exhaust", air.from_surroundings)] {
            if mass > 1e-12 * (air.from_supply + air.to_surroundings) {
                page.line(name, &told(mass));
            }
        }
    }

    fn events(&self, page: &mut Page) {
        page.heading("Events");
        match events::of(self.outcome) {
            None => page.line("", "the fixed-step engine keeps no log of events"),
            Some([]) => page.line("", "none"),
            Some(log) => {
                let counts = events::counts(log);
                let kinds: Vec<String> =
                    counts.iter().map(|(kind, number)| format!("{}{KEPT}{}", kind.name(), count(*number))).collect();
                page.line(&count(log.len() as u64), &kinds.join(", "));
            }
        }
    }
}

/// How far the goals of a controller were missed.
pub(crate) fn goals<'g>(page: &mut Page, goals: impl IntoIterator<Item = &'g Goal>) {
    page.heading("Control");
    // Wider than the other tables: a stiffness has a long unit.
    let row = |page: &mut Page, name: &str, [a, b, c]: [String; 3]| {
        page.put(format_args!("  {name:<NAMES$}{a:>16}{b:>16}{c:>12}\n"));
    };
    row(page, "", ["rms error", "largest error", "at"].map(str::to_owned));
    for goal in goals {
        let (Miss { rms, largest, at }, unit) = (goal.miss(), goal.quantity.rows().set_point.unit);
        let name = match goal.whose {
            Some(1) => "  antagonist",
            _ => describe::controlled(goal.quantity),
        };
        row(page, name, [quantity(rms, unit), quantity(largest, unit), quantity(at, "s")]);
    }
}

/// What a controller did and what it took.
pub(crate) fn effort(page: &mut Page, samples: usize, requests: &str, air: Option<&str>) {
    page.line("samples", &format!("{}; errors are as measured then", count(samples as u64)));
    page.line("requests", &format!("{requests} changes of what the valve is asked"));
    if let Some(air) = air {
        page.line("air used", &format!("{air} from the supply"));
    }
}

/// What a run of the event-located engine cost.
pub(crate) fn cost(counts: Counts) -> String {
    let steps = count(counts.explicit_steps + counts.implicit_steps);
    let implicit = match counts.implicit_steps {
        0 => String::new(),
        implicit => format!(" ({} of them implicit)", count(implicit)),
    };
    let (rejected, evaluations) = (count(counts.rejected_steps), count(counts.evaluations));
    format!("{steps} steps{implicit}, {rejected} repeated, {evaluations} evaluations")
}

/// What does not close of an energy audit, and what share of its turnover that is.
pub(crate) fn residual(page: &mut Page, residual: f64, turnover: f64) {
    let relative = if turnover > 0.0 { residual / turnover } else { 0.0 };
    let share =
        if relative == 0.0 { "closed to the last bit".to_owned() } else { format!("{relative:.1e} of the turnover") };
    page.value("residual", &quantity(residual, "J"), &share);
}

/// The longest step, and on what ground it was taken: the time in s that was compared, and the greatest error.
pub(crate) fn step_of(step: f64, chosen: Option<[f64; 2]>, run: &Run) -> String {
    let Some([compared, greatest]) = chosen else { return format!("at most {}, as given", given(step, "s")) };
    let over =
        if compared < run.duration { format!(" over the first {}", given(compared, "s")) } else { String::new() };
    format!(
        "at most {}, chosen for an accuracy of {:e}: measured error {:.1e} of the range{over}",
        given(step, "s"),
        run.accuracy,
        greatest
    )
}

/// The length under PWM in words.
fn under_pwm(ripple: &Ripple, contraction: f64) -> String {
    let periods = match ripple.periods {
        1 => "the last period".to_owned(),
        many => format!("the last {many} periods"),
    };
    let settled = |drift: f64| drift.abs() <= SETTLED * ripple.mean.abs();
    let drift = match ripple.drift {
        Some(drift) if settled(drift) => "; the mean has settled".to_owned(),
        Some(drift) => format!("; the mean drifts by {} per period", quantity(drift, "m")),
        None => String::new(),
    };
    format!(
        "mean length {} (contraction {}), ripple {} peak to peak over {periods}{drift}",
        quantity(ripple.mean, "m"),
        percent(contraction),
        quantity(ripple.peak_to_peak, "m"),
    )
}

fn energy(page: &mut Page, audit: &EnergyAudit) {
    page.heading("Energy");
    let named = [
        ("gas work", audit.gas_work, "by the gauge pressure"),
        ("to the load", audit.load, "kinetic and potential, or the work on a prescribed motion"),
        ("stored", audit.braid_storage, "in the taut braid"),
        ("stored", audit.tendon_storage, "in the tendon in series"),
        ("in elements", audit.hysteresis_storage, "stored by the elements of the hysteresis"),
        ("bladder", audit.bladder_storage, "stored in the bladder"),
        ("viscous", audit.viscous, "dissipated by viscous friction"),
        ("Coulomb", audit.coulomb, "dissipated by Coulomb friction"),
        ("slip", audit.slip, "dissipated by the elements of the hysteresis that slip"),
        ("braid damping", audit.braid, "dissipated by the taut braid"),
        ("slack", audit.slack, "correction of friction while a tendon cannot push"),
        (
            "effectiveness",
            audit.effectiveness_loss,
            "taken by an effectiveness other than 1, or a law beside virtual work",
        ),
    ];
    let turnover = audit.turnover();
    let (factor, prefix) = common_prefix(&named.map(|(_, value, _)| value));
    for (index, (name, value, where_to)) in named.into_iter().enumerate() {
        if index < 2 || value.abs() > 1e-12 * turnover {
            page.value(name, &format!("{} {prefix}J", digits(value * factor)), where_to);
        }
    }
    residual(page, audit.residual(), turnover);
}

/// Where the exergy of the air from the supply went; with what does not close and the turnover, in J.
pub(crate) fn circuit(page: &mut Page, audit: &CircuitAudit, process: Process, [open, turnover]: [f64; 2]) {
    page.heading("Exergy of the supply's air");
    let heat = match process {
        Process::Isentropic | Process::Polytropic { .. } => {
            "lost through heat that the process implies; negative: gained"
        }
        Process::Isothermal | Process::EnergyBalance { .. } => "lost through heat",
    };
    let work = audit.work.gas_work;
    let named = [
        ("drawn", audit.drawn, "work potential at the supply's temperature and outside pressure"),
        ("gas work", work, "by the gauge pressure, see Energy"),
        ("left inside", audit.stored, "gained by the air in the actuator"),
        ("exhaust", audit.exhaust, "thrown out with the air"),
        ("valve", audit.throttled, "destroyed in the valve on the way in"),
        ("mixing", audit.mixed, "destroyed as air of two temperatures mixes"),
        ("heat", audit.heat, heat),
    ];
    let (factor, prefix) = common_prefix(&named.map(|(_, value, _)| value));
    for (index, (name, value, where_to)) in named.into_iter().enumerate() {
        if index < 2 || value.abs() > 1e-12 * turnover {
            page.value(name, &format!("{} {prefix}J", digits(value * factor)), where_to);
        }
    }
    residual(page, open, turnover);
    if let (Some(whole), Some(compressor)) = (audit.efficiency(), audit.compressor_efficiency()) {
        let compressor_work = quantity(audit.compressor, "J");
        page.value("efficiency", &percent(whole), "work on the load over what was drawn");
        page.value("of compressor", &percent(compressor), &format!("over its isothermal work, {compressor_work}"));
    }
}

/// The closing note about numbers that nobody states.
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
    let note = wrap(&format!("{}{from}.", named.join(", ")), "  ", width()).replace(KEPT, " ");
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

/// A volume in litres.
fn volume(cubic_metres: f64) -> String {
    quantity(cubic_metres * 1e3, "L")
}

/// Text with a column of names.
#[derive(Debug, Default)]
pub(crate) struct Page {
    pub(crate) text: String,
}

impl Page {
    pub(crate) fn heading(&mut self, heading: &str) {
        let gap = if self.text.is_empty() { "" } else { "\n" };
        self.put(format_args!("{gap}{}\n", styled(HEADING, heading)));
    }

    /// A name and some text, broken where the terminal ends.
    pub(crate) fn line(&mut self, name: &str, text: &str) {
        let indent = " ".repeat(NAMES + 4);
        let text = wrap(&keep_numbers(text), &indent, width()).replace(KEPT, " ");
        self.put(format_args!("  {name:<NAMES$}  {}\n", text.trim_start()));
    }

    /// A name, a value at the right of its column, and what it is.
    pub(crate) fn value(&mut self, name: &str, value: &str, what: &str) {
        self.put(format_args!("  {name:<NAMES$}{value:>14}  {}\n", styled(FAINT, what)));
    }

    pub(crate) fn head(&mut self, names: [&str; 3]) {
        let [a, b, c] = names;
        let line = format!("  {:<NAMES$}{a:>14}{b:>14}{c:>14}", "");
        self.put(format_args!("{}\n", styled(FAINT, line)));
    }

    pub(crate) fn columns(&mut self, name: &str, [a, b, c]: [String; 3]) {
        self.put(format_args!("  {name:<NAMES$}{a:>14}{b:>14}{c:>14}\n"));
    }

    /// Three values under one prefix.
    pub(crate) fn range(&mut self, name: &str, end: f64, Range { least, greatest }: Range, unit: &str) {
        let values = [end, least, greatest];
        let (factor, prefix) = common_prefix(&values);
        // A remainder of rounding is no value; the largest of the three gives the measure.
        let fine = 1e-9 * values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let told = |value: f64| {
            let value = if value.abs() < fine { 0.0 } else { value };
            format!("{} {prefix}{unit}", digits(value * factor))
        };
        self.columns(name, values.map(told));
    }

    fn put(&mut self, text: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = self.text.write_fmt(text);
    }
}
