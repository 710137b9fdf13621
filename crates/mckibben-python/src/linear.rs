//! `linearize`, and the class `LinearModel`.

use crate::python;
use crate::raised::Raised;
use crate::scenario::Scenario;
use crate::typed::{Axes, Complex, Figure, Items, Matrix, Modes, Object, Parts, Point, Quantity, Sections, Sequence};
use mckibben::linearize::Signal;
use mckibben_run::linearize::{Measure, Request};
use mckibben_run::quantities;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::ffi::CString;

/// A scenario near an operating point, by exact derivatives: what `mckibben linearize` does.
///
/// Two of `gauge_pressure`, `length` and `load` give the third; what is not given is that of the scenario. `duty` gives the
/// pressure by the valve's mean flow under PWM, and with `pwm` the duty follows from the pressure; else the valve is held
/// shut, and the mass flow into the actuator is the input. Of a joint `angle` and `stiffness` give the pressures. With
/// `amplitude` Coulomb friction is replaced by the viscous damping that takes as much. Quantities are numbers in SI or text with
/// units, such as "60 psi"; `load` is a force, as text also a mass.
///
/// Raises `InputError` where there is no such point.
#[pyfunction]
#[pyo3(signature = (scenario, *, gauge_pressure = None, length = None, load = None, duty = None, pwm = false, temperature = None,
    angle = None, stiffness = None, amplitude = None, all_states = false))]
#[expect(clippy::too_many_arguments, reason = "each is given by its name")]
pub(crate) fn linearize(
    py: Python<'_>,
    scenario: &Bound<'_, Scenario>,
    gauge_pressure: Option<Quantity>,
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
        gauge_pressure: read("gauge_pressure", gauge_pressure, ["pressure", "Pa", "60 psi"]).raised()?,
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
    let model = LinearModel::new(py, &found)?;
    for warning in &model.warnings {
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &CString::new(warning.as_str())?, 1)?;
    }
    Ok(model)
}

/// A linear model `dx/dt = A x + B u`, `y = C x + D u`, of differences from an operating point.
///
/// `to_control` gives it to python-control.
#[pyclass(frozen, module = "mckibben")]
pub(crate) struct LinearModel {
    matrices: [Py<PyArray2<f64>>; 4],
    signals: [Vec<(String, String)>; 3],
    poles: Vec<(f64, f64)>,
    point: Vec<(String, f64)>,
    warnings: Vec<String>,
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
            warnings: found.account().warnings(),
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
        warnings: Items<String>,
        json: String,
    ) -> Self {
        let signals = signals.map(|of| of.0);
        Self { matrices, signals, poles: poles.0, point: point.0, warnings: warnings.0, json }
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

    /// What casts doubt on the model: a valve that does not answer to its duty there, a ripple that is too large, pulses that are
    /// too slow. `linearize` raises each as a `UserWarning` too.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// What is known of the model beside its matrices, as `to_json` says it: `controllability`, how far pulses on average hold
    /// (`pwm`), whether the braid is taut, what is assumed.
    #[getter]
    fn details<'py>(&self, py: Python<'py>) -> PyResult<Sections<'py>> {
        Ok(Sections(py.import("json")?.call_method1("loads", (&self.json,))?))
    }

    /// The model as a system of python-control, its signals with their names.
    fn to_control<'py>(model: &Bound<'py, Self>) -> PyResult<Object<'py>> {
        python::call(model.py(), ("_linear", "to_control"), (model,)).map(Object)
    }

    /// The complex response of each output to each input at angular frequencies in rad/s: `[frequency, output, input]`.
    fn response<'py>(model: &Bound<'py, Self>, omega: Sequence) -> PyResult<Complex<'py>> {
        python::call(model.py(), ("_linear", "response"), (model, omega.0)).map(Complex)
    }

    /// Magnitude and phase of outputs over one input, as a figure of Matplotlib, or into two axes.
    ///
    /// Without names: the first two outputs over the first input, which is the valve's where there is one.
    #[pyo3(signature = (input = None, outputs = None, ax = None))]
    fn bode<'py>(
        model: &Bound<'py, Self>,
        input: Option<String>,
        outputs: Option<Items<String>>,
        ax: Option<Axes<'py>>,
    ) -> PyResult<Figure<'py>> {
        python::call(model.py(), ("_linear", "bode"), (model, input, outputs.map(|of| of.0), ax.map(|ax| ax.0)))
            .map(Figure)
    }

    /// The poles as modes with natural frequency, damping ratio and time constant, the slowest first; `print` shows a table.
    fn damp<'py>(model: &Bound<'py, Self>) -> PyResult<Modes<'py>> {
        python::call(model.py(), ("_results", "modes"), (model,)).map(Modes)
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
        let parts = (
            matrices,
            self.signals.clone(),
            self.poles.clone(),
            self.point.clone(),
            self.warnings.clone(),
            self.json.clone(),
        );
        Ok(Parts(parts.into_pyobject(py)?.into_any()))
    }
}
