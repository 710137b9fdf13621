//! The accuracy of the fixed-step engine on named scenarios: what is measured for `docs/accuracy.md`, and its text.

use crate::common::of_repository;
use mckibben::simulation::Method;
use mckibben::simulation::accuracy::{Reference, StepError};
use mckibben_cli::settings::Setting;
use mckibben_scenario::{Document, Experiment};
use std::fmt::Write as _;

/// The steps in s.
pub(crate) const STEPS: [f64; 8] = [2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5];
/// The accuracies for which a step is chosen.
pub(crate) const ACCURACIES: [f64; 5] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
/// The methods with their names on the page.
pub(crate) const METHODS: [(Method, &str); 2] = [(Method::Rk4, "RK4"), (Method::Stable, "stable")];
/// Relative tolerance of the event-located runs.
const TOLERANCE: f64 = 1e-12;
/// Errors below this are those of the reference as well.
pub(crate) const RESOLVED: f64 = 1e-9;

/// A scenario of the page: a file of the repository and what is set in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    pub(crate) title: &'static str,
    pub(crate) file: &'static str,
    pub(crate) set: &'static [&'static str],
    pub(crate) remark: &'static str,
}

/// The scenarios of the page.
pub(crate) const CASES: [Case; 5] = [
    Case {
        title: "5 lb under PWM of 25 Hz",
        file: "examples/paper/fig-12.toml",
        set: &["run.duration=1 s"],
        remark: "Valve edges, the mass thrown up from the taut braid, reversals with Coulomb friction.",
    },
    Case {
        title: "Ring-down with Coulomb friction",
        file: "examples/paper/fig-08.toml",
        set: &[],
        remark: "Sealed; friction catches the mass in the end, and an error of the last reversal stays.",
    },
    Case {
        title: "Isometric filling of a small chamber",
        file: "examples/isometric-charge.toml",
        set: &["initial.length=3.8 in", "actuator.external_volume=0.01 mL"],
        remark: "Near equal pressure the air settles in a tenth of a millisecond: stiff.",
    },
    Case {
        title: "Fill, hold, exhaust",
        file: "examples/fill-hold-exhaust.toml",
        set: &[],
        remark: "A step up, a sealed ring-down, a step down onto the taut braid.",
    },
    Case {
        title: "A light mass on the taut braid",
        file: "examples/paper/fig-11.toml",
        set: &["load.mass=100 g", "run.duration=0.5 s"],
        remark: "Thrown up, slack, and back onto the taut braid in every period.",
    },
];

/// The errors at one step, or where the steps left the physics.
pub(crate) type Measured = Result<StepError, mckibben::Error>;

/// What is measured of a case: for each method the errors at each step and the step for each accuracy.
pub(crate) struct Rows {
    pub(crate) errors: [Vec<Measured>; 2],
    pub(crate) steps: [Vec<Measured>; 2],
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
        let reference = Reference::new(&experiment.rig, experiment.start, experiment.run.duration, TOLERANCE)
            .expect("an event-located run");
        let errors = METHODS.map(|(method, _)| STEPS.iter().map(|step| reference.error(method, *step)).collect());
        let step_for = |method, accuracy| reference.step_for(method, accuracy, STEPS[0]);
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
pub(crate) fn told(error: f64) -> String {
    if error < RESOLVED { format!("< {RESOLVED:.0e}") } else { format!("{error:.1e}") }
}

/// A step in ms.
pub(crate) fn milliseconds(step: f64) -> String {
    format!("{} ms", mckibben_cli::quantities::digits(step * 1e3).trim_end_matches('0').trim_end_matches('.'))
}

/// The order between two rows, where both errors are resolved and small enough to be told apart from chance.
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
                Ok(error) => error.states().map(told).join(" | "),
                Err(mckibben::Error::Stopped { time, .. }) => format!("left the physics at {:.0} ms | | |", 1e3 * time),
                Err(error) => panic!("{error}"),
            };
            let _ = writeln!(text, "| {step} | {name} | {cells} | {} |", order(errors, index));
        }
    }
    text
}

/// The cell of a step chosen for an accuracy.
pub(crate) fn chosen(measured: &Measured) -> String {
    measured.as_ref().map_or_else(|_| "none".to_owned(), |error| milliseconds(error.step))
}
