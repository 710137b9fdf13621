//! Many modular actuators stepped together on arrays that the caller owns: the class `Actuators`.

use crate::actuator::Model;
use crate::pool;
use crate::raised::Raised;
use crate::scenario::Scenario;
use crate::typed::{Given, Numbers};
use mckibben::parameter;
use mckibben::simulation::{ModularActuator, Snapshot};
use mckibben::{Error, control::Drive};
use mckibben_cli::failure::Failure;
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray1};
use pyo3::prelude::*;

/// Rows below which they are stepped on the caller's own thread: to wake others takes longer than these.
const ALONE: usize = 128;
/// Rows up to which one thread takes them.
const TOGETHER: usize = 32;

/// Many actuators of one scenario, each with its own air, valve and memory, stepped together in loops of your own.
///
/// Arrays are yours: `step` reads and writes them in place, and allocates nothing. They are one-dimensional, of 64-bit
/// floating-point numbers, without gaps, with one entry for each actuator. Rows are stepped on all cores; each is an
/// `Actuator` by itself, to the bit.
///
/// `pulse_frequency` in Hz is how often a duty cycle's pulses come; that of the scenario's PWM unless given.
#[pyclass(module = "mckibben")]
pub(crate) struct Actuators {
    scenario: Py<Scenario>,
    pulse_frequency: Option<f64>,
    model: Model,
    rows: Vec<ModularActuator>,
}

/// Rows that lie together, with what a step reads and writes of them.
struct Span<'a> {
    rows: &'a mut [ModularActuator],
    length: &'a [f64],
    velocity: &'a [f64],
    duty: Option<&'a [f64]>,
    tension: &'a mut [f64],
    /// Derivatives of the tension by length and velocity, and the pressure.
    beside: [Option<&'a mut [f64]>; 3],
}

impl<'a> Span<'a> {
    /// Steps every row; the first that could not go on, by its number among these, and why.
    fn step(self, drive: &(impl Fn(f64) -> Drive + Sync), dt: f64) -> Option<(usize, Error)> {
        let count = self.rows.len();
        if count <= TOGETHER {
            return self.step_in_turn(drive, dt);
        }
        let middle = count / 2;
        let (left, right) = self.split(middle);
        let (left, right) = rayon::join(|| left.step(drive, dt), || right.step(drive, dt));
        left.or(right.map(|(row, error)| (middle + row, error)))
    }

    fn split(self, middle: usize) -> (Self, Self) {
        let (rows, rows_right) = self.rows.split_at_mut(middle);
        let (length, length_right) = self.length.split_at(middle);
        let (velocity, velocity_right) = self.velocity.split_at(middle);
        let duty = self.duty.map(|duty| duty.split_at(middle));
        let (tension, tension_right) = self.tension.split_at_mut(middle);
        let (mut beside, mut beside_right) = ([None, None, None], [None, None, None]);
        for (place, slice) in self.beside.into_iter().enumerate() {
            (beside[place], beside_right[place]) = slice.map(|slice| slice.split_at_mut(middle)).unzip();
        }
        let (duty, duty_right) = duty.unzip();
        (
            Self { rows, length, velocity, duty, tension, beside },
            Self {
                rows: rows_right,
                length: length_right,
                velocity: velocity_right,
                duty: duty_right,
                tension: tension_right,
                beside: beside_right,
            },
        )
    }

    fn step_in_turn(mut self, drive: &impl Fn(f64) -> Drive, dt: f64) -> Option<(usize, Error)> {
        let mut fault = None;
        for (row, actuator) in self.rows.iter_mut().enumerate() {
            let until = actuator.time() + dt;
            let asked = self.duty.map_or(Ok(()), |duty| actuator.drive(drive(duty[row])));
            if let Err(error) = asked.and_then(|()| actuator.move_to(until, self.length[row])) {
                fault.get_or_insert((row, error));
                continue;
            }
            let response = actuator.respond(self.velocity[row]);
            self.tension[row] = response.tension;
            let values = [response.per_length, response.per_velocity, actuator.state().pressure.0];
            for (slice, value) in self.beside.iter_mut().zip(values) {
                if let Some(slice) = slice {
                    slice[row] = value;
                }
            }
        }
        fault
    }
}

/// What an array of another length is told.
fn fitting(name: &str, slice: Option<&[f64]>, count: usize) -> Result<(), Failure> {
    let remedy = format!("give an array of {count} numbers (float64) without gaps, one for each actuator");
    match slice {
        Some(slice) if slice.len() == count => Ok(()),
        Some(slice) => Err(Failure::input(format!("{name} has {} entries for {count} actuators", slice.len()), remedy)),
        None => Err(Failure::input(format!("{name} has gaps between its entries"), remedy)),
    }
}

/// Refuses duty cycles that are none.
fn check(duty: Option<&[f64]>) -> Result<(), Failure> {
    let wrong = |(row, duty): (usize, &f64)| parameter::DUTY.check(*duty).err().map(|error| of_row(error.into(), row));
    duty.into_iter().flatten().enumerate().find_map(wrong).map_or(Ok(()), Err)
}

/// What went wrong in a row.
fn of_row(failure: Failure, row: usize) -> Failure {
    failure.of(&format!("actuator {row}"))
}

#[pymethods]
impl Actuators {
    #[new]
    #[pyo3(signature = (scenario, count, pulse_frequency = None))]
    fn new(scenario: Py<Scenario>, count: usize, pulse_frequency: Option<f64>) -> PyResult<Self> {
        let model = Model::of(scenario.get(), pulse_frequency).raised()?;
        let rows = vec![model.actuator.clone(); count];
        Ok(Self { scenario, pulse_frequency, model, rows })
    }

    /// Goes on by `dt` in s while the ends of each actuator go in a straight line to a distance of `length` in m, under
    /// pulses of `duty` from 0 to 1; with `None` what was asked before goes on.
    ///
    /// `tension` in N is written, and where they are given `per_length` (its derivative at constant pressure, N/m),
    /// `per_velocity` (N*s/m) and `pressure` (Pa, absolute). `velocity` in m/s is that of the ends at the end of the step.
    ///
    /// Raises `InputError` for arrays and duties that cannot be, before anything has changed, and `StoppedError` where an
    /// actuator leaves the physics: that one is then where it was and its entries are as they were, and the others have
    /// gone on.
    #[pyo3(signature = (dt, length, velocity, duty, tension, *, per_length = None, per_velocity = None, pressure = None))]
    #[expect(clippy::too_many_arguments, reason = "each is an array of its own")]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        dt: f64,
        length: Given<PyReadonlyArray1<'py, f64>>,
        velocity: Given<PyReadonlyArray1<'py, f64>>,
        duty: Option<Given<PyReadonlyArray1<'py, f64>>>,
        mut tension: Given<PyReadwriteArray1<'py, f64>>,
        mut per_length: Option<Given<PyReadwriteArray1<'py, f64>>>,
        mut per_velocity: Option<Given<PyReadwriteArray1<'py, f64>>>,
        mut pressure: Option<Given<PyReadwriteArray1<'py, f64>>>,
    ) -> PyResult<()> {
        let Self { model, rows, .. } = self;
        let count = rows.len();
        let read = |name: &str, array: &'_ Given<PyReadonlyArray1<'py, f64>>| {
            fitting(name, array.0.as_slice().ok(), count).raised()
        };
        read("length", &length)?;
        read("velocity", &velocity)?;
        duty.as_ref().map_or(Ok(()), |duty| read("duty", duty))?;
        let duty = duty.as_ref().and_then(|duty| duty.0.as_slice().ok());
        check(duty).raised()?;
        fitting("tension", tension.0.as_slice().ok(), count).raised()?;
        let mut beside = [None, None, None];
        let given = [("per_length", &mut per_length), ("per_velocity", &mut per_velocity), ("pressure", &mut pressure)];
        for (place, (name, array)) in beside.iter_mut().zip(given) {
            if let Some(array) = array {
                fitting(name, array.0.as_slice().ok(), count).raised()?;
                *place = array.0.as_slice_mut().ok();
            }
        }
        let (Ok(length), Ok(velocity), Ok(tension)) =
            (length.0.as_slice(), velocity.0.as_slice(), tension.0.as_slice_mut())
        else {
            return Ok(());
        };
        let span = Span { rows, length, velocity, duty, tension, beside };
        let drive = |duty: f64| model.pulses.of_duty(duty);
        let stepped = py.detach(|| match count < ALONE {
            true => Ok(span.step_in_turn(&drive, dt)),
            false => pool::shared(|| span.step(&drive, dt)),
        });
        match stepped.raised()? {
            None => Ok(()),
            Some((row, error)) => Err(of_row(error.into(), row)).raised(),
        }
    }

    /// All of them go back to t = 0 and the scenario's state, with the coils released.
    fn reset(&mut self) {
        let start = self.model.actuator.snapshot();
        self.rows.iter_mut().for_each(|actuator| actuator.restore(&start));
    }

    /// How many there are.
    fn __len__(&self) -> usize {
        self.rows.len()
    }

    fn __repr__(&self) -> String {
        format!("<mckibben.Actuators, {} of {:?}>", self.rows.len(), self.scenario.get().title())
    }

    fn __getnewargs__(&self, py: Python<'_>) -> (Py<Scenario>, usize, Option<f64>) {
        (self.scenario.clone_ref(py), self.rows.len(), self.pulse_frequency)
    }

    /// Where each of them is, a row for each as an `ActuatorState` is pickled.
    fn __getstate__<'py>(&self, py: Python<'py>) -> PyResult<Numbers<'py>> {
        let width = self.model.actuator.snapshot().numbers().len();
        let numbers = self.rows.iter().flat_map(|actuator| actuator.snapshot().numbers()).collect();
        Ok(Numbers(PyArray1::from_vec(py, numbers).reshape([self.rows.len(), width])?.into_any()))
    }

    fn __setstate__(&mut self, numbers: Given<PyReadonlyArray2<'_, f64>>) -> PyResult<()> {
        let numbers = numbers.0.as_array();
        let states: Vec<Snapshot> = numbers
            .rows()
            .into_iter()
            .map(|row| Snapshot::of_numbers(&row.to_vec()))
            .collect::<Result<_, _>>()
            .raised()?;
        if states.len() != self.rows.len() {
            let title = format!("{} states are given for {} actuators", states.len(), self.rows.len());
            return Err(Failure::input(title, "give one for each")).raised();
        }
        self.rows.iter_mut().zip(&states).for_each(|(actuator, state)| actuator.restore(state));
        Ok(())
    }
}
