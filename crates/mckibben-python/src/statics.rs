//! Static force, stiffness and volume of an actuator, and their inverses, number by number: the class `_Statics`.

use crate::arguments;
use crate::exceptions::OrException;
use crate::scenario::ScenarioArgument;
use crate::typed::{FORCE, FREQUENCY, LENGTH, Numbers, PRESSURE, Quantity, Sequence, TIME, si_of_text};
use mckibben::{Actuator, GaugePressure};
use mckibben_run::failure::Failure;
use numpy::PyArray1;
use pyo3::prelude::*;

/// What `mckibben.Statics` computes with, on flat arrays of one length.
#[pyclass(frozen, module = "mckibben")]
pub(crate) struct _Statics {
    actuator: Actuator,
    /// The gauge pressure of the supply in Pa, if there is one.
    supply: Option<f64>,
}

impl _Statics {
    /// A value for each pair of numbers of two arrays; NaN where there is none, and where a number is NaN, as in what an inverse
    /// has returned out of reach.
    fn each<'py>(
        py: Python<'py>,
        (names, first, second): ([&str; 2], &[f64], &[f64]),
        value: impl Fn(f64, f64) -> Option<f64> + Sync,
    ) -> PyResult<Numbers<'py>> {
        [first, second].into_iter().zip(names).try_for_each(|(of, name)| not_infinite(name, of)).or_exception()?;
        let values = py.detach(|| {
            let pairs = first.iter().zip(second);
            let value = |(first, second): (&f64, &f64)| match first.is_nan() || second.is_nan() {
                true => f64::NAN,
                false => value(*first, *second).unwrap_or(f64::NAN),
            };
            pairs.map(value).collect()
        });
        Ok(Numbers(PyArray1::from_vec(py, values).into_any()))
    }

    /// Whether a length in m and a gauge pressure in Pa are within what the actuator reaches.
    fn reaches(&self, length: f64, gauge: f64) -> bool {
        let limits = self.actuator.limits();
        (limits.min_length()..=limits.max_length()).contains(&length) && gauge > -self.actuator.air().atmosphere().0
    }

    /// A value of the actuator at lengths in m and gauge pressures in Pa; NaN out of reach.
    fn at<'py>(
        &self,
        py: Python<'py>,
        (length, gauge): (&Sequence, &Sequence),
        value: impl Fn(&Actuator, f64, f64) -> f64 + Sync,
    ) -> PyResult<Numbers<'py>> {
        let atmosphere = self.actuator.air().atmosphere();
        Self::each(py, (["length", "gauge_pressure"], &length.0, &gauge.0), |length, gauge| {
            let pressure = GaugePressure(gauge).absolute(atmosphere).0;
            self.reaches(length, gauge).then(|| value(&self.actuator, length, pressure))
        })
    }
}

/// Refuses infinite numbers of an array of one dimension.
fn not_infinite(name: &str, numbers: &[f64]) -> Result<(), Failure> {
    match numbers.iter().position(|number| number.is_infinite()) {
        None => Ok(()),
        Some(at) => Err(Failure::input(
            format!("{name}[{at}] = {:?} is infinite", numbers[at]),
            format!("give finite numbers in `{name}`, or NaN where there is none"),
        )),
    }
}

/// The value in SI of text in an argument, whose name says what it measures: a length, a force, a time, a frequency or a pressure.
#[pyfunction]
pub(crate) fn _si(name: &str, text: &str) -> PyResult<f64> {
    let measured = match name {
        "length" => LENGTH,
        "force" => FORCE,
        "control_period" | "duration" | "sensor_delay" | "action_delay" => TIME,
        "pulse_frequency" => FREQUENCY,
        _ => PRESSURE,
    };
    si_of_text(name, text, measured).or_exception()
}

#[pymethods]
impl _Statics {
    #[new]
    fn new(scenario: ScenarioArgument<'_>) -> PyResult<Self> {
        let scenario = scenario.0.get();
        let of = scenario.of_one().or_exception()?;
        let actuator =
            of.driven().map_err(|error| Failure::of_core(&error, &scenario.document)).or_exception()?.actuator;
        Ok(Self { actuator, supply: of.supply.as_ref().map(|supply| supply.gauge_pressure) })
    }

    /// Shortest and longest length in m.
    #[getter]
    fn reach(&self) -> (f64, f64) {
        (self.actuator.limits().min_length(), self.actuator.limits().max_length())
    }

    /// Gauge pressure of the supply in Pa.
    #[getter]
    fn supply(&self) -> Option<f64> {
        self.supply
    }

    /// Static force in N, zero where the braid would push.
    fn force<'py>(&self, py: Python<'py>, length: Sequence, gauge: Sequence) -> PyResult<Numbers<'py>> {
        self.at(py, (&length, &gauge), |actuator, length, pressure| actuator.static_force(length, pressure).max(0.0))
    }

    /// Stiffness in N/m at constant pressure (7); zero where the muscle is slack.
    fn stiffness<'py>(&self, py: Python<'py>, length: Sequence, gauge: Sequence) -> PyResult<Numbers<'py>> {
        self.at(py, (&length, &gauge), |actuator, length, pressure| {
            let is_slack = actuator.static_force(length, pressure) < 0.0;
            if is_slack { 0.0 } else { actuator.stiffness(length, mckibben::AbsolutePressure(pressure)) }
        })
    }

    /// Stiffness in N/m with the valve shut (5); zero where the muscle is slack.
    fn sealed_stiffness<'py>(&self, py: Python<'py>, length: Sequence, gauge: Sequence) -> PyResult<Numbers<'py>> {
        self.at(py, (&length, &gauge), |actuator, length, pressure| {
            let is_slack = actuator.static_force(length, pressure) < 0.0;
            if is_slack { 0.0 } else { actuator.sealed_stiffness(length, mckibben::AbsolutePressure(pressure)) }
        })
    }

    /// Volume of the air in m^3 at a length, braid and what is outside it.
    fn volume<'py>(&self, py: Python<'py>, length: Sequence) -> PyResult<Numbers<'py>> {
        let gauge = Sequence(vec![0.0; length.0.len()]);
        self.at(py, (&length, &gauge), |actuator, length, _| actuator.volume(length))
    }

    /// The least gauge pressure in Pa, up to `most`, that bears a force at a length.
    fn gauge_pressure_for<'py>(
        &self,
        py: Python<'py>,
        length: Sequence,
        force: Sequence,
        most: Quantity<'py>,
    ) -> PyResult<Numbers<'py>> {
        let most = most.si("max_gauge_pressure", PRESSURE)?;
        arguments::number("max_gauge_pressure", most, "Pa", "a gauge pressure in Pa above zero", most > 0.0)
            .or_exception()?;
        Self::each(py, (["length", "force"], &length.0, &force.0), |length, force| {
            self.actuator.pressure_under(length, force, GaugePressure(most)).map(|gauge| gauge.0)
        })
    }

    /// The length in m at which the actuator bears a force at a gauge pressure.
    fn length_for<'py>(&self, py: Python<'py>, gauge: Sequence, force: Sequence) -> PyResult<Numbers<'py>> {
        let (atmosphere, limits) = (self.actuator.air().atmosphere(), self.actuator.limits());
        Self::each(py, (["gauge_pressure", "force"], &gauge.0, &force.0), |gauge, force| {
            let pressure = GaugePressure(gauge).absolute(atmosphere);
            let found =
                (pressure.0 > 0.0 && force >= 0.0).then(|| self.actuator.length_under(force, pressure))?.ok()?;
            // At the shortest length it pulls harder than the load, and beyond the longest the taut braid bears it.
            let pull = self.actuator.static_force(found, pressure.0);
            (found <= limits.max_length() && pull <= force + 1e-9 * force.max(1.0)).then_some(found)
        })
    }
}
