//! Many copies of one plant that are told what to do and begin anew one by one: the class `Plants`.
//!
//! | module | what it holds |
//! |---|---|
//! | `asked` | what is asked of valves, as numbers |
//! | `fleet` | what all plants have in common |
//! | `rigs` | actuators with their loads, in the lanes of a batch |
//! | `alone` | plants that go each by itself |
//! | `joints`, `legs` | the two of these |
//! | `numbers`, `leg_numbers` | numbers that differ from plant to plant, by their paths |

mod alone;
mod asked;
mod fleet;
mod joints;
mod leg_numbers;
mod legs;
mod numbers;
mod rigs;

use crate::arguments;
use crate::pool;
use crate::pulses::Pulses;
use crate::raised::{Raised, exception};
use crate::scenario::Scenario;
use crate::typed::{Count, Flags, Items, Numbers as Array, Rows, Sequence, Table};
use alone::Alone;
use asked::Asked;
use fleet::{Fleet, Span};
use joints::Joints;
use legs::Legs;
use mckibben::simulation::{Actuation, MOST_PARTS, Method};
use mckibben_cli::failure::Failure;
use numbers::Numbers;
use numpy::PyArray1;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use rigs::Rigs;
use std::collections::BTreeMap;

/// Many copies of a scenario's plant, stepped together on all cores: what is asked of their valves comes from you, and each
/// may begin anew, with numbers of its own, while the others go on. The environments of `mckibben.learning` are made of it.
///
/// `scenario` is an actuator with its load or an antagonistic joint; with `leg`, it is the actuator of each of a leg's six
/// strands, and `leg` says which numbers of the leg are others than those assumed (`{}` for none), as
/// `{"leg.thigh.mass": 0.5}`. Its command and its controller do not count.
///
/// `by` are paths of the numbers that differ from one to the next, such as "load.mass" or "initial.gauge_pressure"; of a leg
/// also "leg.shank.mass", and "strands[2].actuator.turns" of one actuator alone.
///
/// `asked` says what the numbers given to `step` are: "duty" (0 to 1), "request" (1 fill, 0 hold, -1 exhaust), "position" of
/// a proportional spool (-1 to 1), "set-point" of a pressure regulator (Pa, gauge). `pulse_frequency` in Hz is how often a
/// duty cycle's pulses come; that of the scenario's PWM unless given.
///
/// They go at fixed steps by the scenario's run.method, each no longer than its run.step, or than what its run.accuracy
/// needs.
///
/// A copy, or what comes out of a pickle, is made anew: of the same scenario and for the same purpose, at t = 0.
#[pyclass(module = "mckibben")]
pub(crate) struct Plants {
    scenario: Py<Scenario>,
    by: Vec<String>,
    asked: String,
    pulse_frequency: Option<f64>,
    leg: Option<Vec<(String, f64)>>,
    given: Vec<f64>,
    /// The longest step in s.
    longest: f64,
    duration: f64,
    requests: Vec<f64>,
    /// Frequency of the pulses in Hz, where duty cycles are asked for.
    pulses: Option<f64>,
    /// Longest time in s from a command to its effect at a valve.
    valve_delay: f64,
    count: usize,
    /// How many columns are shown of each.
    width: usize,
    fleet: Box<dyn Fleet>,
}

/// A step of a control period that is this much longer than the longest is as long.
const ROUNDING: f64 = 1e-9;
/// Steps and edges of pulses of all plants together that go on without a look at Ctrl-C.
const UNHEARD: f64 = 1e6;

impl Plants {
    fn of(
        py: Python<'_>,
        scenario: &Py<Scenario>,
        by: &[String],
        (asked_by, pulse_frequency): (&str, Option<f64>),
        leg: Option<Vec<(String, f64)>>,
        count: usize,
    ) -> Result<Self, Failure> {
        let Scenario { document, .. } = scenario.get();
        let base = scenario.get().of_one()?.open_loop();
        let failed = |error: mckibben::Error| Failure::of_core(&error, document);
        let actuation = base.driven().map_err(failed)?.actuation;
        let valve = actuation.as_ref().map(|actuation| &actuation.solenoid);
        Asked::check(asked_by, valve)?;
        let pulses = || Pulses::of(actuation.as_ref().map(|actuation| &actuation.command), pulse_frequency);
        let asked = Asked::named(asked_by, pulses)?;
        let requests = valve.map_or(Vec::new(), Asked::requests_of);
        let second = base.of_antagonist().map(|other| other.driven()).transpose().map_err(failed)?;
        let valves = [actuation.as_ref(), second.as_ref().and_then(|second| second.actuation.as_ref())];
        let of_valve = |actuation: &Actuation| {
            let Actuation { solenoid, .. } = actuation;
            solenoid.dead_time() + solenoid.delays().into_iter().fold(0.0, f64::max)
        };
        // What cannot be built is refused below.
        let hose = base.rig().ok().and_then(|rig| rig.line().hose.map(|hose| hose.transport_delay()));
        let valve_delay = valves.into_iter().flatten().map(of_valve).fold(0.0, f64::max) + hose.unwrap_or_default();
        let pulses = matches!(asked, Asked::Duty(_)).then(|| asked.pulse_frequency());
        let mut given = vec![f64::NAN; by.len()];
        let mut fill = |numbers: &mut dyn Iterator<Item = (usize, f64)>| {
            numbers.for_each(|(which, value)| given[which] = value);
        };
        let numbers = || {
            let by: Vec<(usize, &str)> = by.iter().map(String::as_str).enumerate().collect();
            Numbers::find(scenario.clone_ref(py), &by)
        };
        let (fleet, longest): (Box<dyn Fleet>, f64) = if let Some(set) = &leg {
            let legs = Legs::new(py, scenario, by, set, asked.pulse_frequency())?;
            fill(&mut legs.given().into_iter());
            (Box::new(Alone::new(legs, asked)), Self::step_of_leg(base.run.step)?)
        } else if let Some(experiment) = base.joint_experiment().map_err(failed)? {
            let (numbers, method) = (numbers()?, experiment.method());
            fill(&mut numbers.given());
            let joints = Joints { numbers, method, pulse_frequency: asked.pulse_frequency() };
            (Box::new(Alone::new(joints, asked)), experiment.step().map_err(failed)?.0)
        } else {
            let experiment = base.experiment().map_err(failed)?;
            let (numbers, method): (Numbers, Method) = (numbers()?, experiment.method());
            let valve = actuation.map(|actuation| actuation.solenoid);
            fill(&mut numbers.given());
            (Box::new(Rigs::new(numbers, method, asked, valve)), experiment.step().map_err(failed)?.0)
        };
        fleet.check(&vec![asked.least(&requests); fleet.valves()]).map_err(|(_, failure)| failure)?;
        let (scenario, by, duration) = (scenario.clone_ref(py), by.to_vec(), base.run.duration);
        let (asked, width) = (asked_by.to_owned(), fleet.columns().len());
        Ok(Self {
            scenario,
            by,
            asked,
            pulse_frequency,
            leg,
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

    fn step_of_leg(step: Option<f64>) -> Result<f64, Failure> {
        step.ok_or_else(|| Failure::input("a leg does not choose its step by itself", "give run.step, as \"0.1 ms\""))
    }

    fn begin(&mut self, py: Python<'_>, values: Option<Table<'_>>) -> PyResult<()> {
        let (values, count) = (values.map(|values| values.read("values")).transpose()?, self.count);
        let (fleet, values) = self.valued(values.as_ref().map(|of| of.as_slice()).transpose()?, count).raised()?;
        py.detach(|| together(count, || fleet.begin(&values).map_err(of_plant))).raised()
    }

    /// The plants with the values of each; a failure where they are as many as there should not be, or not finite.
    fn valued<'a>(&'a mut self, values: Option<&'a [f64]>, count: usize) -> Result<Valued<'a>, Failure> {
        let Self { fleet, by, given, .. } = self;
        let width = by.len();
        arguments::finite_table("values", values.unwrap_or_default(), width)?;
        let values = match values {
            None => vec![given.as_slice(); count],
            Some(values) if values.len() == count * width && width > 0 => values.chunks(width).collect(),
            Some(_) if width == 0 => vec![[].as_slice(); count],
            Some(values) => {
                return Err(Failure::input(
                    format!("{} values were given for {count} plants", values.len()),
                    format!("give one row for each plant, with a value for each of {}, in SI", by.join(", ")),
                ));
            }
        };
        Ok((fleet.as_mut(), values))
    }
}

/// Plants, and the values of each.
type Valued<'a> = (&'a mut dyn Fleet, Vec<&'a [f64]>);

/// The plants, unless another thread works on them.
fn mine<'py>(this: &Bound<'py, Plants>) -> PyResult<PyRefMut<'py, Plants>> {
    this.try_borrow_mut().map_err(|_| {
        let remedy = "give each thread Plants of its own, or wait for the other";
        exception(&Failure::input("these Plants are being stepped by another thread", remedy))
    })
}

/// What plants are made of, for pickling: by place and by name.
type Made<'py> = ((Py<Scenario>, usize), BTreeMap<&'static str, Bound<'py, PyAny>>);

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
impl Plants {
    #[new]
    #[pyo3(signature = (scenario, count, *, by = Items(Vec::new()), asked = "duty", pulse_frequency = None, leg = None))]
    fn new(
        py: Python<'_>,
        scenario: Py<Scenario>,
        count: Count,
        by: Items<String>,
        asked: &str,
        pulse_frequency: Option<f64>,
        leg: Option<BTreeMap<String, f64>>,
    ) -> PyResult<Self> {
        let leg: Option<Vec<(String, f64)>> = leg.map(|leg| leg.into_iter().collect());
        for (path, value) in leg.iter().flatten() {
            arguments::number(&format!("leg[{path:?}]"), *value, "", "a finite number in SI", true).raised()?;
        }
        let mut plants = Self::of(py, &scenario, &by.0, (asked, pulse_frequency), leg, count.0).raised()?;
        arguments::room(py, count.0, "plants", plants.fleet.bytes())?;
        plants.begin(py, None)?;
        Ok(plants)
    }

    /// All begin at t = 0, with nothing asked of their valves, each with its values of the numbers `by` in SI, of shape
    /// (count, len(by)); those of the scenario unless given.
    ///
    /// Raises `InputError` for values that cannot be. Then nothing has changed.
    #[pyo3(signature = (values = None))]
    fn start(this: &Bound<'_, Self>, py: Python<'_>, values: Option<Table<'_>>) -> PyResult<()> {
        mine(this)?.begin(py, values)
    }

    /// The plants of these numbers begin anew with these values, of shape (len(rows), len(by)), and nothing asked of their
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

    /// Asks `asked`, of shape (count, valves), of the valves, goes on by `dt` in s, and writes what the plants show into
    /// `shown`, of shape (count, len(columns)), and into `stopped` which of them have left the physics: their entries stay
    /// as they are, and only `restart` brings them back.
    ///
    /// Raises `InputError` for what cannot be asked, and for more than 10 000 000 steps or edges of pulses, before anything
    /// has changed. Ctrl-C ends a step of many parts between two of them.
    fn step(
        this: &Bound<'_, Self>,
        py: Python<'_>,
        dt: f64,
        asked: Table<'_>,
        shown: Table<'_>,
        stopped: Flags<'_>,
    ) -> PyResult<()> {
        let mut plants = mine(this)?;
        let Self { fleet, count, width, longest, pulses, .. } = &mut *plants;
        let (valves, count, width) = (fleet.valves(), *count, *width);
        let (asked, mut shown, mut stopped) = (asked.read("asked")?, shown.write("shown")?, stopped.write("stopped")?);
        let asked = asked.as_slice().ok();
        shaped("asked", asked.map(<[f64]>::len), (count, valves)).raised()?;
        let asked = asked.unwrap_or_default();
        arguments::finite_table("asked", asked, valves).raised()?;
        crate::actuator::check_dt(dt).raised()?;
        let steps = (dt / *longest - ROUNDING).ceil().max(1.0);
        let parts = steps + 2.0 * dt * pulses.unwrap_or(0.0);
        if parts > MOST_PARTS {
            let title = format!("dt = {dt:?} s takes {parts:.3e} steps and edges of pulses, more than {MOST_PARTS:e}");
            return Err(Failure::input(title, "give a shorter dt, a longer run.step or a lower pulse_frequency"))
                .raised();
        }
        fleet.check(asked).map_err(of_plant).raised()?;
        let (shown, stopped) = (shown.as_slice_mut()?, stopped.as_slice_mut()?);
        shaped("shown", Some(shown.len()), (count, width)).raised()?;
        shaped("stopped", Some(stopped.len()), (count, 1)).raised()?;
        // Between spans Ctrl-C is heard; what is asked again meanwhile changes nothing.
        let spans = (parts * count as f64 / UNHEARD).ceil().max(1.0);
        let span = Span { duration: dt / spans, steps: (steps / spans).ceil() as u64 };
        for number in 0..spans as u64 {
            if number > 0 {
                py.check_signals()?;
            }
            py.detach(|| {
                together(count, || {
                    fleet.step(span, asked, shown, stopped);
                    Ok(())
                })
            })
            .raised()?;
        }
        Ok(())
    }

    /// Writes what the plants of these numbers show into rows of `shown`, of shape (count, len(columns)).
    fn show(&self, rows: Rows<'_>, shown: Table<'_>) -> PyResult<()> {
        let (width, rows, mut shown) = (self.width, rows.read("rows")?, shown.write("shown")?);
        let shown = shown.as_slice_mut()?;
        shaped("shown", Some(shown.len()), (self.count, width)).raised()?;
        for row in rows.as_slice()?.iter().filter_map(|row| usize::try_from(*row).ok()) {
            if let Some(into) = shown.get_mut(row * width..(row + 1) * width) {
                self.fleet.show(row, into);
            }
        }
        Ok(())
    }

    /// Whether plants with these two sets of values of the numbers `by`, in SI, would differ. Commands of valves do not count.
    ///
    /// Raises `InputError` for values that cannot be.
    fn differ(&self, one: Sequence, other: Sequence) -> PyResult<bool> {
        let values = [one.0.as_slice(), other.0.as_slice()];
        if values.iter().any(|values| values.len() != self.by.len()) {
            let remedy = format!("give a value for each of {}, in SI", self.by.join(", "));
            return Err(Failure::input("values are missing, or there are too many", remedy)).raised();
        }
        self.fleet.differ(values).raised()
    }

    /// The time in s of each plant on the clock that its pulses follow: period p begins at p / `pulses`. It begins with the
    /// plant's episode; that of actuators with their loads, which share one clock, with `start`.
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Array<'py> {
        let time: Vec<f64> = (0..self.count).map(|row| self.fleet.time(row)).collect();
        Array(PyArray1::from_vec(py, time).into_any())
    }

    /// How often pulses come, in Hz, where `asked` is "duty".
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

    /// What is shown of each, by the names of the columns of a run.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.fleet.columns()
    }

    /// How many valves each has.
    #[getter]
    fn valves(&self) -> usize {
        self.fleet.valves()
    }

    /// The requests that the valves can be asked: of 1 (fill), 0 (hold) and -1 (exhaust).
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
    fn by(&self) -> Vec<String> {
        self.by.clone()
    }

    /// What the scenario has for these numbers, in SI.
    #[getter]
    fn given<'py>(&self, py: Python<'py>) -> Array<'py> {
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

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<Made<'py>> {
        let leg: Option<BTreeMap<_, _>> = self.leg.as_ref().map(|leg| leg.iter().cloned().collect());
        let named = [
            ("by", (&self.by).into_bound_py_any(py)?),
            ("asked", (&self.asked).into_bound_py_any(py)?),
            ("pulse_frequency", self.pulse_frequency.into_bound_py_any(py)?),
            ("leg", leg.into_bound_py_any(py)?),
        ];
        Ok(((self.scenario.clone_ref(py), self.count), named.into()))
    }

    fn __repr__(&self) -> String {
        format!("<mckibben.Plants, {} of {:?}>", self.count, self.scenario.get().title())
    }
}
