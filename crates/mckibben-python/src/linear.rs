//! `linearize`, and the class `LinearModel`.

use crate::raised::Raised;
use crate::scenario::Scenario;
use crate::typed::{Complex, Items, Matrix, Parts, Point, Quantity};
use mckibben::linearize::Signal;
use mckibben_run::linearize::{Measure, Request};
use mckibben_run::quantities;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A scenario near an operating point, by exact derivatives: what `mckibben linearize` does.
///
/// Two of `pressure` (gauge), `length` and `load` give the third; what is not given is that of the scenario. `duty` gives the
/// pressure by the valve's mean flow under PWM, and with `pwm` the duty follows from the pressure; else the valve is held
/// shut, and the mass flow into the actuator is the input. Of a joint `angle` and `stiffness` give the pressures. With
/// `amplitude` Coulomb friction is replaced by the viscous damping that takes as much. Quantities are numbers in SI or text with
/// units, such as "60 psi"; `load` is a force, as text also a mass.
///
/// Raises `InputError` where there is no such point.
#[pyfunction]
#[pyo3(signature = (scenario, *, pressure = None, length = None, load = None, duty = None, pwm = false, temperature = None,
    angle = None, stiffness = None, amplitude = None, all_states = false))]
#[expect(clippy::too_many_arguments, reason = "each is given by its name")]
pub(crate) fn linearize(
    py: Python<'_>,
    scenario: &Bound<'_, Scenario>,
    pressure: Option<Quantity>,
    length: Option<Quantity>,
    load: Option<Quantity>,
    duty: Option<f64>,
    pwm: bool,
    temperature: Option<Quantity>,
    angle: Option<Quantity>,
    stiffness: Option<Quantity>,
    amplitude: Option<Quantity>,
    all_states: bool,
) -> PyResult<LinearModel> {
    let read = |name: &str, of: Option<Quantity>, [what, unit, example]: [&str; 3]| {
        of.map(|of| of.read(name, |text| quantities::read(text, what, unit, example), |number| number)).transpose()
    };
    let of_length = ["length", "m", "85 mm"];
    let request = Request {
        pressure: read("pressure", pressure, ["pressure", "Pa", "60 psi"]).raised()?,
        length: read("length", length, of_length).raised()?,
        load: load.map(|load| load.read("load", Measure::read, Measure::Force)).transpose().raised()?,
        duty,
        pwm,
        temperature: read("temperature", temperature, ["temperature", "K", "293 K"]).raised()?,
        angle: read("angle", angle, ["angle", "rad", "20 deg"]).raised()?,
        stiffness: read("stiffness", stiffness, ["stiffness of a joint", "N*m/rad", "2 N*m/rad"]).raised()?,
        amplitude: read("amplitude", amplitude, of_length).raised()?,
        all_states,
    };
    let (name, document) = (scenario.get().document.source().name(), &scenario.get().document);
    let found = py.detach(|| mckibben_run::linearize::LinearModel::of(name, document, &request)).raised()?;
    LinearModel::new(py, &found)
}

/// A linear model `dx/dt = A x + B u`, `y = C x + D u`, of differences from an operating point.
///
/// `control.ss(model.A, model.B, model.C, model.D)` is the same for python-control.
#[pyclass(frozen, module = "mckibben")]
pub(crate) struct LinearModel {
    matrices: [Py<PyArray2<f64>>; 4],
    signals: [Vec<(String, String)>; 3],
    poles: Vec<(f64, f64)>,
    point: Vec<(String, f64)>,
    json: String,
}

impl LinearModel {
    fn new(py: Python<'_>, found: &mckibben_run::linearize::LinearModel) -> PyResult<Self> {
        let system = found.system();
        let [states, inputs, outputs] = [&system.states, &system.inputs, &system.outputs];
        let matrix = |rows: &[Vec<f64>], height: usize, width: usize| {
            // NumPy cannot tell the width of a matrix without rows.
            let values = PyArray1::from_vec(py, rows.concat()).reshape([height, width])?;
            Ok::<_, PyErr>(values.readwrite().make_nonwriteable().as_any().cast::<PyArray2<f64>>()?.clone().unbind())
        };
        let named = |signals: &[Signal]| {
            signals.iter().map(|signal| (signal.name.clone(), signal.unit.to_owned())).collect::<Vec<_>>()
        };
        Ok(Self {
            matrices: [
                matrix(&system.a, states.len(), states.len())?,
                matrix(&system.b, states.len(), inputs.len())?,
                matrix(&system.c, outputs.len(), states.len())?,
                matrix(&system.d, outputs.len(), inputs.len())?,
            ],
            signals: [named(states), named(inputs), named(outputs)],
            poles: found.poles().iter().map(|pole| (pole.real, pole.imaginary)).collect(),
            point: found.point(),
            json: found.json(),
        })
    }

    fn matrix<'py>(&self, py: Python<'py>, place: usize) -> Matrix<'py> {
        Matrix(self.matrices[place].bind(py).clone().into_any())
    }

    fn names(&self, place: usize) -> Vec<&str> {
        self.signals[place].iter().map(|(name, _)| name.as_str()).collect()
    }
}

type Signals = Items<(String, String)>;

#[pymethods]
impl LinearModel {
    #[new]
    fn restored(
        matrices: [Py<PyArray2<f64>>; 4],
        signals: [Signals; 3],
        poles: Items<(f64, f64)>,
        point: Items<(String, f64)>,
        json: String,
    ) -> Self {
        Self { matrices, signals: signals.map(|of| of.0), poles: poles.0, point: point.0, json }
    }

    /// One row and one column for each state.
    #[getter(A)]
    fn a<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        self.matrix(py, 0)
    }

    /// One row for each state, one column for each input.
    #[getter(B)]
    fn b<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        self.matrix(py, 1)
    }

    /// One row for each output, one column for each state.
    #[getter(C)]
    fn c<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        self.matrix(py, 2)
    }

    /// One row for each output, one column for each input.
    #[getter(D)]
    fn d<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        self.matrix(py, 3)
    }

    /// The names of the states.
    #[getter]
    fn states(&self) -> Vec<&str> {
        self.names(0)
    }

    /// The names of the inputs.
    #[getter]
    fn inputs(&self) -> Vec<&str> {
        self.names(1)
    }

    /// The names of the outputs.
    #[getter]
    fn outputs(&self) -> Vec<&str> {
        self.names(2)
    }

    /// The units of states, inputs and outputs by their names, in SI; empty for a pure number.
    #[getter]
    fn units(&self) -> std::collections::BTreeMap<&str, &str> {
        self.signals.iter().flatten().map(|(name, unit)| (name.as_str(), unit.as_str())).collect()
    }

    /// The poles in 1/s.
    #[getter]
    fn poles<'py>(&self, py: Python<'py>) -> PyResult<Complex<'py>> {
        let parts: Vec<f64> = self.poles.iter().flat_map(|(real, imaginary)| [*real, *imaginary]).collect();
        Ok(Complex(PyArray1::from_vec(py, parts).call_method1("view", ("complex128",))?))
    }

    /// The values at the operating point, by names that have the unit at the end.
    #[getter]
    fn operating_point<'py>(&self, py: Python<'py>) -> PyResult<Point<'py>> {
        let point = PyDict::new(py);
        self.point.iter().try_for_each(|(name, value)| point.set_item(name, value))?;
        Ok(Point(point.into_any()))
    }

    /// The model as `mckibben linearize --output model.json` writes it, with controllability and how far it holds.
    fn to_json(&self) -> &str {
        &self.json
    }

    fn __repr__(&self) -> String {
        let [states, inputs, outputs] = [0, 1, 2].map(|place| self.names(place).join(", "));
        format!("<mckibben.LinearModel, states {states}; inputs {inputs}; outputs {outputs}>")
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> PyResult<Parts<'py>> {
        let matrices = self.matrices.each_ref().map(|matrix| matrix.clone_ref(py));
        let parts = (matrices, self.signals.clone(), self.poles.clone(), self.point.clone(), self.json.clone());
        Ok(Parts(parts.into_pyobject(py)?.into_any()))
    }
}
