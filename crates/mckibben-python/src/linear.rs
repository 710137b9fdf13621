//! `linearize`, and the class `LinearModel`.

use crate::exceptions::OrException;
use crate::python;
use crate::scenario::ScenarioArgument;
use crate::typed::{
    Axes, Complex, Figure, Items, Line, Matrix, Modes, Object, Parts, Point, Quantity, SHARE, Sections, Texts, Validity,
};
use mckibben::linearize::Signal;
use mckibben_run::linearize::{Measure, Request};
use mckibben_run::quantities;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::ffi::CString;

/// Linearize a scenario about an operating point, with exact derivatives.
///
/// Of `gauge_pressure`, `length` and `load` two give the third; what is not given is that of the scenario. A quantity is a
/// number in SI or text with its unit, such as "60 psi". The model is that of `mckibben linearize`.
///
/// Parameters
/// ----------
/// scenario : Scenario
///     One actuator, an antagonistic joint, or several actuators with names.
/// gauge_pressure : float or str, optional
///     Gauge pressure at the point in Pa. Not together with `duty`.
/// length : float or str, optional
///     Length of the actuator at the point in m.
/// load : float or str, optional
///     Load at the point: a force in N, or as text also a mass that hangs, such as "10 lb".
/// duty : float or str, optional
///     Commanded duty cycle at the point, 0 to 1, or as text "40 %"; the pressure follows from the mean flow of the valve under PWM.
/// pwm : bool, optional
///     Take the mean flow of the valve under PWM, at the duty cycle that holds the pressure; of a pressure regulator the set
///     point, of a proportional spool the position. False by default. Not together with `duty`.
/// temperature : float or str, optional
///     Temperature of the air at the point in K. By default that of the scenario's air, brought to the point by its process.
/// angle : float or str, optional
///     Angle of a joint at the point in rad; together with `stiffness`.
/// stiffness : float or str, optional
///     Stiffness in N*m/rad that both actuators give the joint at `angle`, from which the pressures follow.
/// amplitude : float or str, optional
///     Amplitude in m of an oscillation. Coulomb friction is replaced by the viscous damping that dissipates as much energy.
/// all_states : bool, optional
///     Keep the air mass as a state where it follows from the others; its pole is zero. False by default.
///
/// Returns
/// -------
/// LinearModel
///     Matrices, names and units of the signals, poles, and warnings.
///
/// Raises
/// ------
/// InputError
///     Arguments exclude each other, a quantity has the wrong unit, or there is no such operating point.
///
/// Warns
/// -----
/// UserWarning
///     Each of the model's `warnings`.
///
/// Notes
/// -----
/// Without `duty` and `pwm` a scenario whose command is a PWM is averaged at its own duty cycle, and the last set point of a
/// regulator or position of a spool is taken likewise, unless `gauge_pressure` or `length` is given. Otherwise the valve is
/// held shut, and the mass flow into the actuator is an input.
///
/// Examples
/// --------
///     >>> import mckibben
///     >>> scenario = mckibben.Scenario.from_dict({
///     ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
///     ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
///     ...     "run": {"duration": "0.1 s"},
///     ... })
///     >>> model = mckibben.linearize(scenario, gauge_pressure="60 psi")
///     >>> model.states, model.inputs
///     (['length', 'velocity', 'pressure'], ['mass_flow', 'force'])
#[pyfunction]
#[pyo3(signature = (scenario, *, gauge_pressure = None, length = None, load = None, duty = None, pwm = false, temperature = None,
    angle = None, stiffness = None, amplitude = None, all_states = false))]
#[expect(clippy::too_many_arguments, reason = "each is given by its name")]
pub(crate) fn linearize(
    py: Python<'_>,
    scenario: ScenarioArgument<'_>,
    gauge_pressure: Option<Quantity<'_>>,
    length: Option<Quantity<'_>>,
    load: Option<Quantity<'_>>,
    duty: Option<Quantity<'_>>,
    pwm: bool,
    temperature: Option<Quantity<'_>>,
    angle: Option<Quantity<'_>>,
    stiffness: Option<Quantity<'_>>,
    amplitude: Option<Quantity<'_>>,
    all_states: bool,
) -> PyResult<LinearModel> {
    let read = |name: &str, of: Option<Quantity<'_>>, [what, unit, example]: [&str; 3]| {
        of.map(|of| of.read(name, |text| quantities::read(text, what, unit, example), |number| number)).transpose()
    };
    let of_length = ["length", "m", "85 mm"];
    let request = Request {
        gauge_pressure: read("gauge_pressure", gauge_pressure, ["pressure", "Pa", "60 psi"])?,
        length: read("length", length, of_length)?,
        load: load.map(|load| load.read("load", Measure::read, Measure::Force)).transpose()?,
        duty: duty.map(|duty| duty.si("duty", SHARE)).transpose()?,
        pwm,
        temperature: read("temperature", temperature, ["temperature", "K", "293 K"])?,
        angle: read("angle", angle, ["angle", "rad", "20 deg"])?,
        stiffness: read("stiffness", stiffness, ["stiffness of a joint", "N*m/rad", "2 N*m/rad"])?,
        amplitude: read("amplitude", amplitude, of_length)?,
        all_states,
    };
    let document = &scenario.0.get().document;
    let name = document.source().name();
    let found = py.detach(|| mckibben_run::linearize::LinearModel::of(name, document, &request)).or_exception()?;
    let model = LinearModel::new(py, &found)?;
    for warning in &model.warnings {
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &CString::new(warning.as_str())?, 1)?;
    }
    Ok(model)
}

/// Linear model `dx/dt = A x + B u`, `y = C x + D u` of deviations from an operating point, in SI.
///
/// `linearize` returns it; the constructor serves pickling.
///
/// Examples
/// --------
///     >>> import mckibben
///     >>> model = mckibben.linearize(mckibben.Scenario.from_dict({
///     ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
///     ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
///     ...     "run": {"duration": "0.1 s"},
///     ... }))
///     >>> model.A.shape, model.units["pressure"]
///     ((3, 3), 'Pa')
///     >>> model.response([1.0, 10.0]).shape == (2, len(model.outputs), len(model.inputs))
///     True
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
            // NumPy does not know the width of a matrix without rows.
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

    /// System matrix, of shape (states, states).
    #[getter(A)]
    fn a<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        self.matrix(py, 0)
    }

    /// Input matrix, of shape (states, inputs).
    #[getter(B)]
    fn b<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        self.matrix(py, 1)
    }

    /// Output matrix, of shape (outputs, states).
    #[getter(C)]
    fn c<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        self.matrix(py, 2)
    }

    /// Feedthrough matrix, of shape (outputs, inputs).
    #[getter(D)]
    fn d<'py>(&self, py: Python<'py>) -> Matrix<'py> {
        self.matrix(py, 3)
    }

    /// Names of the states.
    #[getter]
    fn states(&self) -> Vec<&str> {
        self.names(0)
    }

    /// Names of the inputs.
    #[getter]
    fn inputs(&self) -> Vec<&str> {
        self.names(1)
    }

    /// Names of the outputs.
    #[getter]
    fn outputs(&self) -> Vec<&str> {
        self.names(2)
    }

    /// Units of states, inputs and outputs by their names, in SI; empty for a pure number.
    #[getter]
    fn units(&self) -> std::collections::BTreeMap<&str, &str> {
        self.signals.iter().flatten().map(|(name, unit)| (name.as_str(), unit.as_str())).collect()
    }

    /// Delay in s from each input to the beginning of its effect, by the input's name.
    ///
    /// It is the dead time of a valve and the delay of a lumped hose. The matrices and `response` leave it out: it multiplies the
    /// response to that input by `exp(-1j * omega * delay)`.
    #[getter]
    fn delay<'py>(model: &Bound<'py, Self>) -> PyResult<Point<'py>> {
        python::call(model.py(), ("_linear", "delay"), (model,)).map(Point)
    }

    /// Poles in 1/s.
    #[getter]
    fn poles<'py>(&self, py: Python<'py>) -> PyResult<Complex<'py>> {
        let parts: Vec<f64> = self.poles.iter().flat_map(|(real, imaginary)| [*real, *imaginary]).collect();
        Ok(Complex(PyArray1::from_vec(py, parts).call_method1("view", ("complex128",))?))
    }

    /// Values at the operating point in SI, by names that end with the unit, such as `gauge_pressure_pa`.
    #[getter]
    fn operating_point<'py>(&self, py: Python<'py>) -> PyResult<Point<'py>> {
        let point = PyDict::new(py);
        self.point.iter().try_for_each(|(name, value)| point.set_item(name, value))?;
        Ok(Point(point.into_any()))
    }

    /// Reasons to doubt the model.
    ///
    /// Examples are a duty cycle to which the valve does not respond, a pressure ripple that is too large, and pulses that are
    /// too slow. `linearize` raises each as a `UserWarning` too.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// Validity of the model as a `Validity`.
    ///
    /// It has controllability, whether the braid is taut, dead zone and ripple of each valve under PWM, and the warnings.
    #[getter]
    fn validity<'py>(model: &Bound<'py, Self>) -> PyResult<Validity<'py>> {
        python::call(model.py(), ("_results", "validity"), (model,)).map(Validity)
    }

    /// Content of `to_json` as a dictionary.
    ///
    /// It has `controllability`, the validity of the mean flow under PWM (`pwm`), whether the braid is taut, and assumed
    /// values.
    #[getter]
    fn details<'py>(&self, py: Python<'py>) -> PyResult<Sections<'py>> {
        Ok(Sections(py.import("json")?.call_method1("loads", (&self.json,))?))
    }

    /// Return the model as a system of python-control, with the names of its signals.
    ///
    /// Returns
    /// -------
    /// control.StateSpace
    ///     In its names an underscore stands for each point, which python-control refuses: `biceps_duty` for `biceps.duty`. Delays
    ///     are left out.
    fn to_control<'py>(model: &Bound<'py, Self>) -> PyResult<Object<'py>> {
        python::call(model.py(), ("_linear", "to_control"), (model,)).map(Object)
    }

    /// Return the complex frequency response of each output to each input, without the delays of the inputs.
    ///
    /// Parameters
    /// ----------
    /// omega : array_like
    ///     Angular frequencies in rad/s, finite.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     Response of shape (len(omega), outputs, inputs), in the unit of the output over that of the input.
    ///
    /// Raises
    /// ------
    /// InputError
    ///     A frequency is not finite, or a pole lies at it, as that of an integrator at zero: the response there is without bound.
    fn response<'py>(model: &Bound<'py, Self>, omega: Line<'py>) -> PyResult<Complex<'py>> {
        python::call(model.py(), ("_linear", "response"), (model, omega.read("omega")?)).map(Complex)
    }

    /// Draw magnitude and phase of outputs over one input with Matplotlib, without the delays of the inputs.
    ///
    /// Parameters
    /// ----------
    /// input : str, optional
    ///     Name of the input; by default the first, which is that of the valve where there is one.
    /// outputs : sequence of str, optional
    ///     Names of the outputs; by default the first two.
    /// ax : sequence of matplotlib.axes.Axes, optional
    ///     Two axes to draw into, for magnitude and phase. By default a new figure has them.
    ///
    /// Returns
    /// -------
    /// matplotlib.figure.Figure
    ///
    /// Raises
    /// ------
    /// InputError
    ///     The model has no signal of that name, or `ax` has not two axes.
    #[pyo3(signature = (input = None, outputs = None, ax = None))]
    fn bode<'py>(
        model: &Bound<'py, Self>,
        input: Option<String>,
        outputs: Option<Texts<'py>>,
        ax: Option<Axes<'py>>,
    ) -> PyResult<Figure<'py>> {
        let outputs = outputs.map(|of| of.read("outputs")).transpose()?;
        python::call(model.py(), ("_linear", "bode"), (model, input, outputs, ax.map(|ax| ax.0))).map(Figure)
    }

    /// Return the poles as modes with natural frequency, damping ratio and time constant, the slowest first.
    ///
    /// Returns
    /// -------
    /// Modes
    ///     A list of `Mode`; `print` writes it as a table. A pair of conjugate poles is one mode.
    fn damp<'py>(model: &Bound<'py, Self>) -> PyResult<Modes<'py>> {
        python::call(model.py(), ("_results", "modes"), (model,)).map(Modes)
    }

    /// Return the model as JSON, as `mckibben linearize --output model.json` writes it.
    ///
    /// Returns
    /// -------
    /// str
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
