//! Where an actuator is and what it answers: the classes `ActuatorState` and `Response`.

use crate::exceptions::OrException;
use crate::typed::{Line, Numbers, PortsWord};
use mckibben::valve::Ports;
use mckibben_run::failure::Failure;
use numpy::PyArray1;
use pyo3::prelude::*;

/// What a state of an actuator has before the numbers of the plant: mark, count, time, length, pressure, air mass, open ports.
pub(super) const HEAD: usize = 7;

/// State of an `Actuator`: its air, the poppets and pulses of its valve, and the memory of its hysteresis.
///
/// `Actuator.start` and `Actuator.step` return states. A state can be pickled. An actuator of the same scenario and pulse
/// frequency continues from it bit-identically; any other actuator refuses it.
///
/// Parameters
/// ----------
/// numbers : array_like
///     One-dimensional array that a pickle holds, made by the same version of the package.
///
/// Raises
/// ------
/// InputError
///     The numbers are not a state.
///
/// Examples
/// --------
///     >>> import mckibben
///     >>> muscle = mckibben.Actuator(mckibben.Scenario.from_dict({
///     ...     "load": {"kind": "isometric"},
///     ...     "initial": {"length": "85 mm", "gauge_pressure": "40 psi"},
///     ...     "run": {"duration": "1 s"},
///     ... }))
///     >>> state = muscle.start()
///     >>> state.time, state.length, state.valve
///     (0.0, 0.085, 'closed')
#[pyclass(frozen, module = "mckibben")]
pub(crate) struct ActuatorState {
    /// Those of [`HEAD`] and those of the plant.
    pub(super) numbers: Vec<f64>,
}

impl ActuatorState {
    /// The numbers that it is made of.
    pub(crate) fn numbers(&self) -> &[f64] {
        &self.numbers
    }

    /// What was kept as numbers; those of the plant are checked once its actuator goes there.
    pub(crate) fn of_numbers(numbers: &[f64]) -> Result<Self, Failure> {
        let is_number = |number: &f64| number.is_finite() || *number == f64::INFINITY;
        let is_state = match numbers {
            [mark, count, time, length, pressure, air_mass, ports, plant @ ..] => {
                let head = [mark, time, length, pressure, air_mass];
                *count == plant.len() as f64
                    && head.into_iter().all(|number| number.is_finite())
                    && *pressure > 0.0
                    && *air_mass > 0.0
                    && [0.0, 1.0, 2.0, 3.0].contains(ports)
                    && plant.iter().all(is_number)
            }
            _ => false,
        };
        if is_state {
            return Ok(Self { numbers: numbers.to_vec() });
        }
        Err(Failure::input(
            "these numbers are no state of an actuator",
            "give those that a state of this version was kept as, all of them in their order",
        ))
    }
}

/// Tension of an actuator with its partial derivatives, and the rates of its air.
///
/// `Actuator.step` and `Actuator.respond` return it; the constructor serves pickling.
///
/// Examples
/// --------
/// The tension rises with the length and with the pressure:
///
///     >>> import mckibben
///     >>> muscle = mckibben.Actuator(mckibben.Scenario.from_dict({
///     ...     "load": {"kind": "isometric"},
///     ...     "initial": {"length": "85 mm", "gauge_pressure": "40 psi"},
///     ...     "run": {"duration": "1 s"},
///     ... }))
///     >>> response = muscle.respond(muscle.start(), velocity=0.01)
///     >>> response.per_length > 0.0, response.per_pressure > 0.0
///     (True, True)
#[pyclass(frozen, get_all, module = "mckibben")]
#[derive(PartialEq)]
pub(crate) struct Response {
    /// Tension in N, zero or more.
    pub(super) tension: f64,
    /// Partial derivative of the tension with respect to the length at constant pressure, in N/m.
    pub(super) per_length: f64,
    /// Partial derivative of the tension with respect to the velocity, in N*s/m.
    pub(super) per_velocity: f64,
    /// Partial derivative of the tension with respect to the pressure, in m^2.
    pub(super) per_pressure: f64,
    /// Rate of change of the pressure in Pa/s.
    pub(super) pressure_rate: f64,
    /// Net mass flow into the actuator in kg/s.
    pub(super) mass_flow: f64,
    /// Temperature of the air in K.
    pub(super) temperature: f64,
    /// Volume of the air in m^3, in the braid and outside it.
    pub(super) volume: f64,
}

#[pymethods]
impl ActuatorState {
    #[new]
    fn new(numbers: Line<'_>) -> PyResult<Self> {
        Self::of_numbers(&numbers.read("numbers")?).or_exception()
    }

    /// Time in s since the start.
    #[getter]
    pub(crate) fn time(&self) -> f64 {
        self.numbers[2]
    }

    /// Distance between the ends in m.
    #[getter]
    fn length(&self) -> f64 {
        self.numbers[3]
    }

    /// Absolute pressure of the air in Pa.
    #[getter]
    fn absolute_pressure(&self) -> f64 {
        self.numbers[4]
    }

    /// Mass of the air in kg.
    #[getter]
    fn air_mass(&self) -> f64 {
        self.numbers[5]
    }

    /// Open ports of the valve: "supply", "exhaust", "supply+exhaust" or "closed".
    #[getter]
    fn valve(&self) -> PortsWord {
        let open = self.numbers[6] as usize;
        Ports { supply: open & 1 != 0, exhaust: open & 2 != 0 }.name().into()
    }

    /// Return whether both states are bit-identical.
    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        let bits = |state: &Self| state.numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
        other.cast::<Self>().is_ok_and(|other| bits(other.get()) == bits(self))
    }

    fn __repr__(&self) -> String {
        let [_, _, time, length, pressure, ..] = self.numbers[..] else { return String::new() };
        format!("<mckibben.ActuatorState at {time:?} s, {length:?} m, {pressure:?} Pa>")
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> (Numbers<'py>,) {
        (Numbers(PyArray1::from_slice(py, &self.numbers).into_any()),)
    }
}

/// What a response is made of, for pickling.
type Made = (f64, f64, f64, f64, f64, f64, f64, f64);

#[pymethods]
impl Response {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "they are its attributes, each by its name")]
    fn new(
        tension: f64,
        per_length: f64,
        per_velocity: f64,
        per_pressure: f64,
        pressure_rate: f64,
        mass_flow: f64,
        temperature: f64,
        volume: f64,
    ) -> Self {
        Self { tension, per_length, per_velocity, per_pressure, pressure_rate, mass_flow, temperature, volume }
    }

    /// Return whether both responses have equal numbers.
    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get() == self)
    }

    fn __repr__(&self) -> String {
        format!("<mckibben.Response, {:?} N>", self.tension)
    }

    pub(super) fn __getnewargs__(&self) -> Made {
        let Self { tension, per_length, per_velocity, per_pressure, .. } = *self;
        let Self { pressure_rate, mass_flow, temperature, volume, .. } = *self;
        (tension, per_length, per_velocity, per_pressure, pressure_rate, mass_flow, temperature, volume)
    }
}
