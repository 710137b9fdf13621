//! Many copies of one plant that are commanded at run time and begin again one by one: the class `VectorPlant`.
//!
//! | module | what it holds |
//! |---|---|
//! | `action_mode` | actions of valves, as numbers |
//! | `file` | the plant of a scenario file, with other values of numbers by their paths |
//! | `columns` | what is observed of each |
//! | `fleet` | the plants, stepped together in a batch |

mod action;
mod columns;
mod file;
mod fleet;

use crate::arguments;
use crate::pool;
use crate::pulses::Pulses;
use crate::raised::{Raised, exception};
use crate::scenario::Scenario;
use crate::typed::{Count, Flags, Items, NewArguments, Numbers as Array, Rows, Sequence, Table};
use action::ActionMode;
use file::File;
use fleet::{Fleet, Span};
use mckibben::network::NodeKind;
use mckibben::simulation::MOST_PARTS;
use mckibben::valve::{Command, Solenoid};
use mckibben_run::failure::Failure;
use numpy::PyArray1;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

/// Many copies of a scenario's plant, stepped together on all cores. Your code commands their valves; each plant may be
/// reset, with parameters of its own, while the others go on. The environments of `mckibben.learning` are made of it.
///
/// `scenario` is of any plant: one actuator with its load, an antagonistic joint, or actuators with names on their mechanisms.
/// Its controllers do not count, nor the commands of the actuators' valves; supplies follow theirs.
///
/// `parameters` are paths of the numbers that differ from one to the next: "load.mass", "initial.gauge_pressure"; where actuators have
/// names also "actuators.biceps.friction.viscous" and "mechanism.joints.elbow.damping".
///
/// `action_mode` says what the actions given to `step` are: "duty" (0 to 1), "request" (1 fill, 0 hold, -1 exhaust), "position" of
/// a proportional spool (-1 to 1), "set-point" of a pressure regulator (Pa, gauge). `pulse_frequency` in Hz is how often a
/// duty cycle's pulses come; that of the scenario's PWM unless given.
///
/// They go at fixed steps by the scenario's run.method, each no longer than its run.step, or than what its run.accuracy
/// needs.
///
/// A copy, or what comes out of a pickle, is made anew: of the same scenario and for the same purpose, at t = 0.
#[pyclass(module = "mckibben")]
pub(crate) struct VectorPlant {
    scenario: Py<Scenario>,
    parameters: Vec<String>,
    action_mode: String,
    pulse_frequency: Option<f64>,
    given: Vec<f64>,
    /// The longest step in s.
    longest: f64,
    duration: f64,
    requests: Vec<f64>,
    /// Frequency of the pulses in Hz, where actions are duty cycles.
    pulses: Option<f64>,
    /// Longest time in s from a command to its effect at a valve.
    valve_delay: f64,
    count: usize,
    /// How many columns are observed of each.
    width: usize,
    fleet: Fleet,
}

/// A step of a control period that is this much longer than the longest is as long.
const ROUNDING: f64 = 1e-9;
/// Steps and edges of pulses of all plants together that go on without a look at Ctrl-C.
const UNHEARD: f64 = 1e6;

impl VectorPlant {
    fn of(
        py: Python<'_>,
        scenario: &Py<Scenario>,
        parameters: &[String],
        (mode, pulse_frequency): (&str, Option<f64>),
        count: usize,
    ) -> Result<Self, Failure> {
        let file = File::read(scenario.clone_ref(py), parameters)?;
        if file.valves.is_empty() {
            let remedy = "give the scenario [supply] and [valve]";
            return Err(Failure::input("the plant has no valve that could be commanded", remedy));
        }
        file.solenoids().try_for_each(|valve| ActionMode::check(mode, valve))?;
        let pulsed = file.commands.iter().find(|command| matches!(command, Command::Pwm { .. }));
        let pulses = || Pulses::of(pulsed.or(file.commands.first()), pulse_frequency);
        let action_mode = ActionMode::named(mode, pulses)?;
        let requests = ActionMode::requests_of(file.solenoids().collect::<Vec<_>>().into_iter());
        let of_valve = |valve: &Solenoid| valve.dead_time() + valve.delays().into_iter().fold(0.0, f64::max);
        let hoses = file.begin().plant.network().nodes.iter().filter_map(|node| match &node.kind {
            NodeKind::Hose(hose) => Some(hose.transport_delay()),
            _ => None,
        });
        let valve_delay = file.solenoids().map(of_valve).fold(0.0, f64::max) + hoses.fold(0.0, f64::max);
        let (longest, duration, given) = (file.step, file.run.duration, file.given().to_vec());
        let (width, pulses) = (file.columns.len(), action_mode.pulse_frequency());
        let fleet = Fleet::new(file, action_mode)?;
        fleet.check(&vec![action_mode.least(&requests); fleet.valves()]).map_err(|(_, failure)| failure)?;
        let (scenario, parameters, action_mode) = (scenario.clone_ref(py), parameters.to_vec(), mode.to_owned());
        Ok(Self {
            scenario,
            parameters,
            action_mode,
            pulse_frequency,
            given,
            longest,
            duration,
            requests,
            pulses,
            valve_delay,
            count,
            width,
            fleet,
        })
    }

    fn begin(&mut self, py: Python<'_>, values: Option<Table<'_>>) -> PyResult<()> {
        let (values, count) = (values.map(|values| values.read("values")).transpose()?, self.count);
        let (fleet, values) = self.valued(values.as_ref().map(|of| of.as_slice()).transpose()?, count).raised()?;
        py.detach(|| together(count, || fleet.begin(&values).map_err(of_plant))).raised()
    }

    /// The plants with the values of each; a failure where they are as many as there should not be, or not finite.
    fn valued<'a>(&'a mut self, values: Option<&'a [f64]>, count: usize) -> Result<Valued<'a>, Failure> {
        let Self { fleet, parameters, given, .. } = self;
        let width = parameters.len();
        arguments::finite_table("values", values.unwrap_or_default(), width)?;
        let values = match values {
            None => vec![given.as_slice(); count],
            Some(values) if values.len() == count * width && width > 0 => values.chunks(width).collect(),
            Some(_) if width == 0 => vec![[].as_slice(); count],
            Some(values) => {
                return Err(Failure::input(
                    format!("{} values were given for {count} plants", values.len()),
                    format!("give one row for each plant, with a value for each of {}, in SI", parameters.join(", ")),
                ));
            }
        };
        Ok((fleet, values))
    }
}

/// VectorPlant, and the values of each.
type Valued<'a> = (&'a mut Fleet, Vec<&'a [f64]>);

/// The plants, unless another thread works on them.
fn mine<'py>(this: &Bound<'py, VectorPlant>) -> PyResult<PyRefMut<'py, VectorPlant>> {
    this.try_borrow_mut().map_err(|_| {
        let remedy = "give each thread VectorPlant of its own, or wait for the other";
        exception(&Failure::input("these VectorPlant are being stepped by another thread", remedy))
    })
}

/// Does something with so many plants, on all cores; with one on the caller's own thread.
fn together(count: usize, does: impl FnOnce() -> Result<(), Failure> + Send) -> Result<(), Failure> {
    match count {
        1 => does(),
        _ => pool::shared(does)?,
    }
}

/// A failure of a plant by its number.
fn of_plant((row, failure): (usize, Failure)) -> Failure {
    failure.of(&format!("plant {row}"))
}

/// A table that the caller owns, of the shape that it must have.
fn shaped(name: &str, slice: Option<usize>, (rows, columns): (usize, usize)) -> Result<(), Failure> {
    if slice == Some(rows * columns) {
        return Ok(());
    }
    let remedy = format!("give an array of shape ({rows}, {columns}) of float64 without gaps");
    Err(Failure::input(format!("{name} is of another shape, or has gaps"), remedy))
}

#[pymethods]
impl VectorPlant {
    #[new]
    #[pyo3(signature = (scenario, count, *, parameters = Items(Vec::new()), action_mode = "duty", pulse_frequency = None))]
    fn new(
        py: Python<'_>,
        scenario: Py<Scenario>,
        count: Count,
        parameters: Items<String>,
        action_mode: &str,
        pulse_frequency: Option<f64>,
    ) -> PyResult<Self> {
        let mut plants = Self::of(py, &scenario, &parameters.0, (action_mode, pulse_frequency), count.0).raised()?;
        arguments::room(py, count.0, "plants", plants.fleet.bytes())?;
        plants.begin(py, None)?;
        Ok(plants)
    }

    /// All begin at t = 0, with no command to their valves, each with its values of the numbers `parameters` in SI, of shape
    /// (count, len(parameters)); those of the scenario unless given.
    ///
    /// Raises `InputError` for values that cannot be. Then nothing has changed.
    #[pyo3(signature = (values = None))]
    fn start(this: &Bound<'_, Self>, py: Python<'_>, values: Option<Table<'_>>) -> PyResult<()> {
        mine(this)?.begin(py, values)
    }

    /// The plants of these numbers are reset, with these values, of shape (len(rows), len(parameters)), and no command to their
    /// valves; those of the scenario unless given. The others go on.
    #[pyo3(signature = (rows, values = None))]
    fn restart(this: &Bound<'_, Self>, py: Python<'_>, rows: Rows<'_>, values: Option<Table<'_>>) -> PyResult<()> {
        let mut plants = mine(this)?;
        let (rows, count) = (rows.read("rows")?, plants.count);
        let number = |row: &i64| usize::try_from(*row).ok().filter(|row| *row < count);
        let unknown = |row: &i64| {
            let remedy = format!("count the plants from 0 to {}", count.saturating_sub(1));
            Failure::input(format!("rows: number {row} of a plant is meant that there is not"), remedy)
        };
        let rows = rows.as_slice()?.iter().map(|row| number(row).ok_or_else(|| unknown(row)));
        let rows = rows.collect::<Result<Vec<_>, _>>().raised()?;
        let values = values.map(|values| values.read("values")).transpose()?;
        let (fleet, values) =
            plants.valued(values.as_ref().map(|of| of.as_slice()).transpose()?, rows.len()).raised()?;
        let rows: Vec<(usize, &[f64])> = rows.into_iter().zip(values).collect();
        py.detach(|| together(count, || fleet.restart(&rows).map_err(of_plant))).raised()
    }

    /// Asks `action_mode`, of shape (count, valves), of the valves, goes on by `dt` in s, and writes what the plants show into
    /// `observations`, of shape (count, len(columns)), and into `stopped` which of them have produced a non-physical state: their entries stay
    /// as they are, and only `restart` brings them back.
    ///
    /// Raises `InputError` for actions that cannot be, and for more than 10 000 000 steps or edges of pulses, before anything
    /// has changed. Ctrl-C ends a step of many parts between two of them.
    fn step(
        this: &Bound<'_, Self>,
        py: Python<'_>,
        actions: Table<'_>,
        dt: f64,
        observations: Table<'_>,
        stopped: Flags<'_>,
    ) -> PyResult<()> {
        let mut plants = mine(this)?;
        let Self { fleet, count, width, longest, pulses, .. } = &mut *plants;
        let (valves, count, width) = (fleet.valves(), *count, *width);
        let (actions, mut observations, mut stopped) =
            (actions.read("actions")?, observations.write("observations")?, stopped.write("stopped")?);
        let actions = actions.as_slice().ok();
        shaped("actions", actions.map(<[f64]>::len), (count, valves)).raised()?;
        let actions = actions.unwrap_or_default();
        arguments::finite_table("actions", actions, valves).raised()?;
        crate::actuator::check_dt(dt).raised()?;
        let steps = (dt / *longest - ROUNDING).ceil().max(1.0);
        let parts = steps + 2.0 * dt * pulses.unwrap_or(0.0);
        if parts > MOST_PARTS {
            let title = format!("dt = {dt:?} s takes {parts:.3e} steps and edges of pulses, more than {MOST_PARTS:e}");
            return Err(Failure::input(title, "give a shorter dt, a longer run.step or a lower pulse_frequency"))
                .raised();
        }
        fleet.check(actions).map_err(of_plant).raised()?;
        let (observations, stopped) = (observations.as_slice_mut()?, stopped.as_slice_mut()?);
        shaped("observations", Some(observations.len()), (count, width)).raised()?;
        shaped("stopped", Some(stopped.len()), (count, 1)).raised()?;
        // Between spans Ctrl-C is heard; commands that are repeated meanwhile change nothing.
        let spans = (parts * count as f64 / UNHEARD).ceil().max(1.0);
        let span = Span { duration: dt / spans, steps: (steps / spans).ceil() as u64 };
        for number in 0..spans as u64 {
            if number > 0 {
                py.check_signals()?;
            }
            py.detach(|| {
                together(count, || {
                    fleet.step(span, actions, observations, stopped);
                    Ok(())
                })
            })
            .raised()?;
        }
        Ok(())
    }

    /// Writes the observations of the plants of these numbers into rows of `observations`, of shape (count, len(columns)).
    fn observe(&mut self, rows: Rows<'_>, observations: Table<'_>) -> PyResult<()> {
        let (width, rows, mut observations) = (self.width, rows.read("rows")?, observations.write("observations")?);
        let observations = observations.as_slice_mut()?;
        shaped("observations", Some(observations.len()), (self.count, width)).raised()?;
        for row in rows.as_slice()?.iter().filter_map(|row| usize::try_from(*row).ok()) {
            if let Some(into) = observations.get_mut(row * width..(row + 1) * width) {
                self.fleet.observe(row, into);
            }
        }
        Ok(())
    }

    /// Whether plants with these two sets of values of the numbers `parameters`, in SI, would differ. Commands of valves do not count.
    ///
    /// Raises `InputError` for values that cannot be.
    fn differ(&self, one: Sequence, other: Sequence) -> PyResult<bool> {
        let values = [one.0.as_slice(), other.0.as_slice()];
        if values.iter().any(|values| values.len() != self.parameters.len()) {
            let remedy = format!("give a value for each of {}, in SI", self.parameters.join(", "));
            return Err(Failure::input("values are missing, or there are too many", remedy)).raised();
        }
        self.fleet.differ(values).raised()
    }

    /// The time in s of each plant on the clock that its pulses follow: period p begins at p / `pulses`. All share one clock,
    /// which begins with `start`.
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Array<'py> {
        let time = vec![self.fleet.time(); self.count];
        Array(PyArray1::from_vec(py, time).into_any())
    }

    /// How often pulses come, in Hz, where `action_mode` is "duty".
    #[getter]
    fn pulses(&self) -> Option<f64> {
        self.pulses
    }

    /// The longest time in s for which a command shows no effect at the scenario's valves: the delays of their coils, or the
    /// dead time of a pressure regulator, and what a hose adds.
    #[getter]
    fn valve_delay(&self) -> f64 {
        self.valve_delay
    }

    /// What is observed of each, by the names of the columns of a run.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.fleet.file().columns.iter().map(|column| column.name.clone()).collect()
    }

    /// How many valves each has.
    #[getter]
    fn valves(&self) -> usize {
        self.fleet.valves()
    }

    /// What `columns` of plants of a scenario are, whatever the commands of its valves.
    #[staticmethod]
    fn columns_of(scenario: &Scenario) -> PyResult<Vec<String>> {
        let columns = file::columns_of(scenario).raised()?;
        Ok(columns.into_iter().map(|column| column.name).collect())
    }

    /// The requests that the valves can do: of 1 (fill), 0 (hold) and -1 (exhaust).
    #[getter]
    fn requests(&self) -> Vec<f64> {
        self.requests.clone()
    }

    /// How long the scenario runs, in s.
    #[getter]
    fn duration(&self) -> f64 {
        self.duration
    }

    /// Paths of the numbers that differ from one to the next.
    #[getter]
    fn parameters(&self) -> Vec<String> {
        self.parameters.clone()
    }

    /// The scenario's own values of `parameters`, in SI.
    #[getter]
    fn defaults<'py>(&self, py: Python<'py>) -> Array<'py> {
        Array(PyArray1::from_slice(py, &self.given).into_any())
    }

    /// What it was made of.
    #[getter]
    fn scenario(&self, py: Python<'_>) -> Py<Scenario> {
        self.scenario.clone_ref(py)
    }

    fn __len__(&self) -> usize {
        self.count
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<NewArguments<'py, (Py<Scenario>, usize)>> {
        let named = [
            ("parameters", (&self.parameters).into_bound_py_any(py)?),
            ("action_mode", (&self.action_mode).into_bound_py_any(py)?),
            ("pulse_frequency", self.pulse_frequency.into_bound_py_any(py)?),
        ];
        Ok(((self.scenario.clone_ref(py), self.count), named.into()))
    }

    fn __repr__(&self) -> String {
        format!("<mckibben.VectorPlant, {} of {:?}>", self.count, self.scenario.get().title())
    }
}
