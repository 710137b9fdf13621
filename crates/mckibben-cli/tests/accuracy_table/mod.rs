//! The accuracy of the fixed-step engine on named scenarios: what is measured for `docs/accuracy.md`, and its text.

use crate::common::of_repository;
use mckibben::plant::{PlantReference, RigPlant};
use mckibben::simulation::Method;
use mckibben_cli::settings::Setting;
use mckibben_plot::{Axis, Colour, Figure, Panel, Series, Style};
use mckibben_scenario::{Document, Experiment};
use std::fmt::Write as _;

/// The steps in s.
pub(crate) const STEPS: [f64; 10] = [1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5];
/// The accuracies for which a step is chosen.
pub(crate) const ACCURACIES: [f64; 5] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
/// The methods with their names on the page.
pub(crate) const METHODS: [(Method, &str); 2] = [(Method::Rk4, "RK4"), (Method::Stable, "stable")];
/// The recording interval in s whose parts are tried.
const INTERVAL: f64 = 1e-3;
/// Relative tolerance of the event-located runs.
const TOLERANCE: f64 = 1e-12;
/// Errors below this are not distinguished from those of the reference.
pub(crate) const RESOLVED: f64 = 1e-8;

/// A scenario of the page: a file of the repository and what is set in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    pub(crate) title: &'static str,
    /// The title in a word or two, for the figure.
    pub(crate) short: &'static str,
    pub(crate) file: &'static str,
    pub(crate) set: &'static [&'static str],
    pub(crate) remark: &'static str,
}

/// The scenarios of the page.
pub(crate) const CASES: [Case; 5] = [
    Case {
        title: "5 lb under PWM of 25 Hz",
        short: "PWM",
        file: "examples/paper/fig-12.toml",
        set: &["run.duration=1 s"],
        remark: "Valve edges, the mass thrown up from the taut braid, reversals with Coulomb friction.",
    },
    Case {
        title: "Ring-down with Coulomb friction",
        short: "ring-down",
        file: "examples/paper/fig-08.toml",
        set: &[],
        remark: "Sealed; friction catches the mass in the end, and an error of the last reversal stays.",
    },
    Case {
        title: "Isometric filling of a small chamber",
        short: "filling",
        file: "examples/isometric-charge.toml",
        set: &["initial.length=3.8 in", "actuator.external_volume=0.01 mL"],
        remark: "Near equal pressure the air settles in a tenth of a millisecond: stiff.",
    },
    Case {
        title: "Fill, hold, exhaust",
        short: "pulse",
        file: "examples/fill-hold-exhaust.toml",
        set: &[],
        remark: "A step up, a sealed ring-down, a step down onto the taut braid.",
    },
    Case {
        title: "Bounces on the taut braid",
        short: "bounces",
        file: "examples/paper/fig-12.toml",
        set: &["command.duty=0.15", "run.duration=0.5 s"],
        remark: "A fall onto the taut braid in every period, and turns of the velocity with Coulomb friction.",
    },
];

/// A step in s and its errors of length, velocity, pressure and air mass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepErrors {
    step: f64,
    states: [f64; 4],
}

impl StepErrors {
    /// The largest of the four.
    pub(crate) fn greatest(&self) -> f64 {
        self.states.into_iter().fold(0.0, f64::max)
    }
}

/// The errors at one step, or where the steps left the physics.
pub(crate) type Measured = Result<StepErrors, mckibben::Error>;

/// The longest step in s for an accuracy; none where no step that is tried is accurate enough.
pub(crate) type Chosen = Option<f64>;

/// What is measured of a case: for each method the errors at each step and the step for each accuracy.
pub(crate) struct Rows {
    pub(crate) errors: [Vec<Measured>; 2],
    pub(crate) steps: [Vec<Chosen>; 2],
}

impl Case {
    /// The scenario as it is simulated.
    pub(crate) fn experiment(&self) -> Experiment {
        let mut document = Document::load(of_repository(self.file)).expect("a scenario");
        for setting in self.set {
            setting.parse::<Setting>().expect("a setting").apply(&mut document).expect("a key");
        }
        document.experiment().expect("an experiment")
    }

    /// Measures everything that the page says about the case.
    pub(crate) fn measure(&self) -> Rows {
        let experiment = self.experiment();
        let of = RigPlant::new(&experiment.rig);
        let (start, none) = (of.start(&experiment.start), &Vec::new);
        let reference = PlantReference::new((of.plant(), &start), none, experiment.run.duration, TOLERANCE)
            .expect("an event-located run");
        let places = of.plant().indices();
        let (mechanism, actuator) = (&places.mechanisms[0], &places.actuators[0]);
        let [pressure, mass] = [actuator.pressure, actuator.mass()];
        let measure = |method, step| {
            let errors = reference.errors(method, step)?;
            // A length that is fixed has no state, and no error.
            let [length, velocity] = match mechanism.coordinates {
                0 => [0.0; 2],
                _ => [errors[mechanism.position(0)], errors[mechanism.rate(0)]],
            };
            Ok(StepErrors { step, states: [length, velocity, errors[pressure], errors[mass]] })
        };
        let errors = METHODS.map(|(method, _)| STEPS.iter().map(|step| measure(method, *step)).collect());
        let step_for = |method, accuracy| reference.step_for(method, accuracy, INTERVAL).ok().map(|error| error.step);
        let steps = METHODS.map(|(method, _)| ACCURACIES.iter().map(|accuracy| step_for(method, *accuracy)).collect());
        Rows { errors, steps }
    }

    /// The command that runs the case.
    pub(crate) fn command(&self) -> String {
        let set: String = self.set.iter().map(|setting| format!(" --set '{setting}'")).collect();
        format!("mckibben simulate {}{set}", self.file)
    }
}

/// An error to two digits; what the reference does not resolve is said to be small.
pub(crate) fn printed(error: f64) -> String {
    if error < RESOLVED { format!("< {RESOLVED:.0e}") } else { format!("{error:.1e}") }
}

/// A step in ms.
pub(crate) fn milliseconds(step: f64) -> String {
    format!("{} ms", mckibben_run::quantities::digits(step * 1e3).trim_end_matches('0').trim_end_matches('.'))
}

/// The order between two rows, where both errors are resolved and small enough to be distinguished from chance.
fn order(rows: &[Measured], index: usize) -> String {
    let (Some(Ok(before)), Ok(here)) = (index.checked_sub(1).and_then(|before| rows.get(before)), &rows[index]) else {
        return String::new();
    };
    let (coarse, fine) = (before.greatest(), here.greatest());
    if fine < RESOLVED || coarse > 0.1 {
        return String::new();
    }
    format!("{:.1}", (coarse / fine).ln() / (before.step / here.step).ln())
}

/// The table of a case, as Markdown.
pub(crate) fn table(rows: &Rows) -> String {
    let mut text = String::from(
        "| step | method | length | velocity | pressure | air mass | order |\n|---:|---|---:|---:|---:|---:|---:|\n",
    );
    for (errors, (_, name)) in rows.errors.iter().zip(METHODS) {
        for (index, measured) in errors.iter().enumerate() {
            let step = milliseconds(STEPS[index]);
            let cells = match measured {
                Ok(error) => error.states.map(printed).join(" | "),
                Err(mckibben::Error::Stopped { time, .. }) => format!("left the physics at {:.0} ms | | |", 1e3 * time),
                Err(error) => panic!("{error}"),
            };
            let _ = writeln!(text, "| {step} | {name} | {cells} | {} |", order(errors, index));
        }
    }
    text
}

/// The cell of a step chosen for an accuracy.
pub(crate) fn chosen(step: &Chosen) -> String {
    step.map_or_else(|| "none".to_owned(), milliseconds)
}

const HEAD: &str = "\
# Accuracy of the fixed-step engine

Made by `cargo xtask accuracy`; a test measures every figure of its tables again. They are differences between the two
engines of this program, not between the model and a muscle.

Each case is run by the event-located engine at a relative tolerance of 1e-12, and by the fixed-step engine at steps from
10 ms to 0.01 ms. The error of a state is the largest difference at the end of any step, as a share of the range that the
state covers in the run (`mckibben::plant::PlantReference` measures it). The order is that of the largest of the
four between two rows.

![Error over step, one panel for each case](accuracy.svg)

## Which step for which accuracy

The longest step, of 1 ms in 1, 2, 5, 10, 20, … parts and not below 1 µs, whose largest error is at most the accuracy.
With `run.engine = \"fixed-step\"` and no `run.step` this is the step that `run.accuracy` (1e-3 unless given) chooses; a
given `run.step` is taken as it is, whatever the accuracy.

";

const READING: &str = "
How to read it:

- RK4 has order 4 where nothing has a kink (the ring-down). The flow law is only continuous where it meets its straight
  line near equal pressures, and the tension where it comes to zero: there the order falls towards 2, at small errors.
- The stable method has order 2. Its price for long steps near equal pressure is an error hundreds of times that of RK4 at
  0.1 ms: take it where the step is given from outside and long for the chamber, RK4 where accuracy is asked for.
- A small chamber shows where RK4 ends: at 10 ms it leaves the physics, and at 5, 2 and 1 ms it still hangs 35, 12 and 3 kPa
  below the supply's pressure after a second. Its steps must lie below the time in which the air settles. The stable
  method comes to the supply's pressure at each of these steps.
- Air that is shut in does not come back exactly when the muscle comes back to its length, since the stable method does not keep P V^n. With
  the paper's muscle at 2 bar, moved by 87 ± 7 mm at 4 Hz, the absolute pressure is off by 0.005 % after a minute in steps of 1 ms, 0.04 % of
  2 ms and 0.6 % of 5 ms; with RK4 by 1e-6 of itself in steps of 5 ms. In hosts such as MuJoCo take `max_step` shorter where a valve stays
  shut for long.
- Where a step is so long that a stage or an end leaves the physics, the engine stops and says so.
- Valve edges, turns of the velocity with Coulomb friction, slack and taut end a part of a step where they happen: no
  jump of a force or a flow lies inside one.
";

/// The whole page.
pub(crate) fn page(cases: &[Rows]) -> String {
    let mut text = String::from(HEAD);
    let accuracies: Vec<String> = ACCURACIES.iter().map(|accuracy| format!("{accuracy:.0e}")).collect();
    let _ = writeln!(text, "| case | method | {} |", accuracies.join(" | "));
    let _ = writeln!(text, "|---|---|{}", "---:|".repeat(ACCURACIES.len()));
    for (case, rows) in CASES.iter().zip(cases) {
        for (steps, (_, name)) in rows.steps.iter().zip(METHODS) {
            let cells: Vec<String> = steps.iter().map(chosen).collect();
            let _ = writeln!(text, "| {} | {name} | {} |", case.title, cells.join(" | "));
        }
    }
    text.push_str(READING);
    for (case, rows) in CASES.iter().zip(cases) {
        let _ = write!(text, "\n## {}\n\n{}\n\n    {}\n\n{}", case.title, case.remark, case.command(), table(rows));
    }
    text
}

/// The largest error over the step, both logarithmic, a panel for each case.
pub(crate) fn figure(cases: &[Rows]) -> Figure {
    let ends = (0.8e3 * STEPS[STEPS.len() - 1], 1.25e3 * STEPS[0]);
    let mut figure = Figure::new(Axis::logarithmic("step", "ms").starting_at(ends.0).ending_at(ends.1));
    for (case, rows) in CASES.iter().zip(cases) {
        let axis = Axis::logarithmic(format!("error, {}", case.short), "");
        let all = rows.errors.iter().flatten().flatten().map(|error| error.greatest());
        // No error is beyond the upper end.
        let mut panel = Panel::new(axis.starting_at(RESOLVED).ending_at(1.5 * all.fold(2.0, f64::max)));
        for (index, (errors, (_, name))) in rows.errors.iter().zip(METHODS).enumerate() {
            let resolved = errors.iter().flatten().filter(|error| error.greatest() >= RESOLVED);
            let (x, y) = resolved.map(|error| (1e3 * error.step, error.greatest())).unzip();
            let mut series = Series::line(name, x, y).colour(Colour::Category(index));
            series.style = Style::LineAndPoints;
            panel = panel.series(series);
        }
        figure = figure.panel(panel);
    }
    figure.size_mm(110.0, 32.0)
}
