//! A run as a function of parameters of its scenario, with exact derivatives: the class `Differentiable`.

use crate::arguments;
use crate::exceptions::OrException;
use crate::python;
use crate::scenario::{Scenario, ScenarioArgument};
use crate::signals::interruptible;
use crate::typed::{Function, Line, Names, Numbers, Texts};
use mckibben::parameter;
use mckibben_identify::adjustable::Adjustable;
use mckibben_identify::trajectories::{Observed, Sampling, Subject, SubjectError};
use mckibben_run::failure::Failure;
use mckibben_scenario::Place;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Quantities of a run at given times as a function of parameters of its scenario, with the exact Jacobian.
///
/// An instance is called with the values of the parameters, and returns the quantities. The run is that of the event-located
/// engine: every event is located, and the derivatives account for it.
///
/// Parameters
/// ----------
/// scenario : Scenario
///     One actuator or an antagonistic joint, without a controller.
/// parameters : sequence of str
///     Paths of numbers of the scenario, such as "load.mass", "command.duty" or "actuator.effectiveness.value[2]". The path of a
///     list stands for all its entries in their order: "command.gauge_pressure" for every set point of a regulator,
///     "command.position" for every position of a spool, "command.time" for the instants of a command, "pressure.gauge_pressure"
///     and "load.table_length" for the rows of a pressure and of a length over time.
/// quantities : sequence of str
///     "length" (m), "gauge_pressure" (Pa), "tension" (N), "temperature" (K), "mass_flow" (kg/s); of a joint also "angle" (rad),
///     "angular_velocity" (rad/s), "torque" (N*m), "antagonist_length", "antagonist_gauge_pressure" and "antagonist_tension".
/// times : array_like
///     Times in s, from 0 to `run.duration`.
///
/// Raises
/// ------
/// InputError
///     The scenario has a controller or several actuators with names, there is no such parameter or quantity, or a time is
///     outside the run.
///
/// Notes
/// -----
/// A call takes `values`, array_like of the parameters in SI, and returns an array of shape (len(times), len(quantities)). It
/// raises `InputError` for values that are not finite or out of range, and `SimulationError` where the run fails. Ctrl-C ends
/// it.
///
/// Examples
/// --------
///     >>> import mckibben
///     >>> scenario = mckibben.Scenario.from_dict({
///     ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
///     ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
///     ...     "run": {"duration": "0.1 s"},
///     ... })
///     >>> run = mckibben.Differentiable(scenario, ["load.mass"], ["length", "tension"], [0.05, 0.1])
///     >>> run(run.defaults).shape
///     (2, 2)
///     >>> values, jacobian = run.value_and_jacobian([2.5])
///     >>> jacobian.shape
///     (2, 2, 1)
#[pyclass(frozen, module = "mckibben")]
pub(crate) struct Differentiable {
    scenario: Py<Scenario>,
    parameters: Vec<String>,
    quantities: Vec<String>,
    subject: Subject,
    sampling: Sampling,
    start: Vec<f64>,
}

/// Paths of parameters, of whose run, what is read of it, and the values of the parameters in the scenario.
type Known = (Vec<String>, Subject, Sampling, Vec<f64>);

fn observed_of(name: &str, of_joint: bool) -> Result<Observed, Failure> {
    let names = || Observed::ALL.into_iter().filter(|of| of_joint || !of.is_of_joint());
    names().find(|of| of.quantity().name() == name).ok_or_else(|| {
        let known: Vec<&str> = names().map(|of| of.quantity().name()).collect();
        let remedy = format!("name one of {}", known.join(", "));
        Failure::input(format!("`{name}` is no quantity of this scenario that can be differentiated"), remedy)
    })
}

impl Differentiable {
    fn of(
        scenario: &Scenario,
        parameters: &[String],
        quantities: &[String],
        times: Vec<f64>,
    ) -> Result<Known, Failure> {
        let mut base = scenario.of_one()?.clone();
        if base.has_controller() {
            let remedy = "leave `[controller]` out, and give the command in place of it";
            return Err(Failure::input("the commands of a controller have no derivatives here", remedy));
        }
        let lists = [("parameters", parameters.len()), ("quantities", quantities.len()), ("times", times.len())];
        if let Some((name, _)) = lists.iter().find(|(_, length)| *length == 0) {
            return Err(Failure::input(format!("`{name}` is empty"), "give one at least"));
        }
        let of_run = "the quantities at `times` but the accuracy";
        arguments::taking_part("parameters", parameters, &[("run", of_run)])?;
        let observed = quantities.iter().map(|name| observed_of(name, base.has_joint())).collect::<Result<_, _>>()?;
        let end = base.run.duration;
        if let Some(place) = times.iter().position(|time| !(0.0..=end).contains(time)) {
            let remedy = format!("give times from 0 s to run.duration = {end} s");
            return Err(Failure::input(format!("times[{place}] = {} s is no time of the run", times[place]), remedy));
        }
        // A list stands for its entries.
        let each = |path: &String| Place::entries(path, &mut base).unwrap_or_else(|| vec![path.clone()]);
        let parameters: Vec<String> = parameters.iter().flat_map(each).collect();
        arguments::each_once("parameters", &parameters)?;
        let (mut places, mut start) = (Vec::new(), Vec::new());
        for path in &parameters {
            let place = scenario.document.find(path, parameters.iter().map(String::as_str), &mut base);
            let place = place.map_err(|error| Failure::input(error.to_string(), "mend `parameters`"))?;
            start.push(place.value(&mut base).unwrap_or(f64::NAN));
            places.push(place);
        }
        let given = scenario.document.says_of_each(parameter::MIN_LENGTH.key);
        let sampling = Sampling { observed, times, tolerance: base.run.relative_tolerance };
        Ok((parameters, Adjustable::new(base, places, given).into(), sampling, start))
    }

    fn checked(&self, values: &[f64]) -> Result<(), Failure> {
        match values.len() == self.parameters.len() {
            true => arguments::finite_by("values", values, |at| format!("[{at}] ({})", self.parameters[at])),
            false => Err(Failure::input(
                format!("{} values were given for {} parameters", values.len(), self.parameters.len()),
                format!("give one for each of {}, in SI", self.parameters.join(", ")),
            )),
        }
    }

    /// An error of the core; a value that came as an argument stands in no line of the scenario.
    fn failed(&self, error: &SubjectError, py: Python<'_>) -> Failure {
        match error {
            SubjectError::Core(error) if self.parameters.is_empty() => {
                Failure::of_core(error, &self.scenario.bind(py).get().document)
            }
            SubjectError::Core(error) => error.clone().into(),
            SubjectError::File(words) => Failure::input(words.clone(), "give other values"),
        }
    }

    fn shaped<'py>(py: Python<'py>, numbers: Vec<f64>, shape: &[usize]) -> PyResult<Numbers<'py>> {
        Ok(Numbers(PyArray1::from_vec(py, numbers).reshape(shape)?.into_any()))
    }
}

#[pymethods]
impl Differentiable {
    #[new]
    fn new(
        scenario: ScenarioArgument<'_>,
        parameters: Texts<'_>,
        quantities: Texts<'_>,
        times: Line<'_>,
    ) -> PyResult<Self> {
        let scenario = scenario.0.unbind();
        let (parameters, quantities) = (parameters.read("parameters")?, quantities.read("quantities")?);
        let times = times.read("times")?;
        let (parameters, subject, sampling, start) =
            Self::of(scenario.get(), &parameters, &quantities, times).or_exception()?;
        Ok(Self { scenario, parameters, quantities, subject, sampling, start })
    }

    /// Scenario that is run.
    #[getter]
    fn scenario(&self, py: Python<'_>) -> Py<Scenario> {
        self.scenario.clone_ref(py)
    }

    /// Paths of the parameters, those of a list one by one.
    #[getter]
    fn parameters(&self) -> Vec<String> {
        self.parameters.clone()
    }

    /// Names of the quantities.
    #[getter]
    fn quantities(&self) -> Vec<String> {
        self.quantities.clone()
    }

    /// Times in s.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Numbers<'py> {
        Numbers(PyArray1::from_slice(py, &self.sampling.times).into_any())
    }

    /// Values of the parameters in the scenario, in SI.
    #[getter]
    fn defaults<'py>(&self, py: Python<'py>) -> Numbers<'py> {
        Numbers(PyArray1::from_slice(py, &self.start).into_any())
    }

    /// Units of the quantities by their names, in SI.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Names<'py>> {
        let units = PyDict::new(py);
        let pairs = self.quantities.iter().zip(&self.sampling.observed);
        pairs.into_iter().try_for_each(|(name, of)| units.set_item(name, of.unit()))?;
        Ok(Names(units.into_any()))
    }

    /// Return the quantities at the times.
    ///
    /// Parameters
    /// ----------
    /// values : array_like
    ///     Values of the parameters in SI.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Quantities of shape (len(times), len(quantities)).
    fn __call__<'py>(&self, py: Python<'py>, values: Line<'py>) -> PyResult<Numbers<'py>> {
        let values = values.read("values")?;
        self.checked(&values).or_exception()?;
        let read = interruptible(py, |watch| self.sampling.values(&self.subject, &values, watch))?;
        let read = read.map_err(|error| self.failed(&error, py)).or_exception()?;
        Self::shaped(py, read, &[self.sampling.times.len(), self.quantities.len()])
    }

    /// Return the quantities at the times and their Jacobian with respect to the parameters.
    ///
    /// Parameters
    /// ----------
    /// values : array_like
    ///     Values of the parameters in SI.
    ///
    /// Returns
    /// -------
    /// value : numpy.ndarray
    ///     Quantities in SI, of shape (len(times), len(quantities)).
    /// jacobian : numpy.ndarray
    ///     Derivatives in SI, of shape (len(times), len(quantities), len(parameters)).
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The values are of another number, not finite or out of range.
    /// SimulationError
    ///     The run fails with these values.
    fn value_and_jacobian<'py>(&self, py: Python<'py>, values: Line<'py>) -> PyResult<(Numbers<'py>, Numbers<'py>)> {
        let values = values.read("values")?;
        self.checked(&values).or_exception()?;
        let both = interruptible(py, |watch| self.sampling.value_and_jacobian(&self.subject, &values, watch))?;
        let (read, slopes) = both.map_err(|error| self.failed(&error, py)).or_exception()?;
        let (times, quantities) = (self.sampling.times.len(), self.quantities.len());
        let read = Self::shaped(py, read, &[times, quantities])?;
        Ok((read, Self::shaped(py, slopes, &[times, quantities, self.parameters.len()])?))
    }

    /// Return this function for JAX, which differentiates it in forward and in reverse mode.
    ///
    /// Returns
    /// -------
    /// callable
    ///     A `jax.custom_jvp` of the values of the parameters in SI. The runs of a `vmap` use all cores.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     JAX computes in 32 bits; call `jax.config.update("jax_enable_x64", True)` first.
    fn for_jax<'py>(this: &Bound<'py, Self>) -> PyResult<Function<'py>> {
        let of = this.get();
        let (shape, width) = ((of.sampling.times.len(), of.quantities.len()), of.parameters.len());
        python::call(this.py(), ("_beside", "for_jax"), (this, shape, width)).map(Function)
    }

    /// Return this function for PyTorch, which differentiates it in forward and in reverse mode.
    ///
    /// Returns
    /// -------
    /// callable
    ///     A function of a float64 tensor of the values of the parameters in SI, with any leading dimensions. The runs of a
    ///     `vmap`, or of leading dimensions, use all cores. They take place on the CPU; the result is on the device of the
    ///     tensor.
    ///
    /// Notes
    /// -----
    /// The function raises `InputError` for a tensor of another type, and where a second derivative is taken.
    fn for_torch<'py>(this: &Bound<'py, Self>) -> PyResult<Function<'py>> {
        let of = this.get();
        let (shape, width) = ((of.sampling.times.len(), of.quantities.len()), of.parameters.len());
        python::call(this.py(), ("_beside", "for_torch"), (this, shape, width)).map(Function)
    }

    fn __repr__(&self) -> String {
        format!(
            "<mckibben.Differentiable, {} at {} times with respect to {}>",
            self.quantities.join(", "),
            self.sampling.times.len(),
            self.parameters.join(", ")
        )
    }

    fn __getnewargs__<'py>(
        &self,
        py: Python<'py>,
    ) -> (Py<Scenario>, Vec<String>, Vec<String>, Bound<'py, PyArray1<f64>>) {
        (
            self.scenario.clone_ref(py),
            self.parameters.clone(),
            self.quantities.clone(),
            PyArray1::from_slice(py, &self.sampling.times),
        )
    }
}
