//! The Python package `mckibben`: scenarios, runs and the modular actuator, with NumPy arrays in and out.
//!
//! | module | what it holds |
//! |---|---|
//! | `scenario` | the class `Scenario` |
//! | `trajectory` | `simulate`, the classes `Trajectory` and `Event` |
//! | `actuator` | the modular actuator, step by step: `Actuator`, `ActuatorState`, `Response` |
//! | `hosted_plant` | plants whose ends a simulator moves: `HostedPlant`; the plugin for MuJoCo |
//! | `actuators` | many of them on arrays: `Actuators` |
//! | `vector_plant` | many plants that are commanded together and reset one by one: `VectorPlant` |
//! | `alone` | objects that one thread at a time works on |
//! | `mark` | of which plants the numbers of a state are |
//! | `pace` | the clock of plants that go on by equal spans |
//! | `curves` | `curves`, `presets` |
//! | `choosing` | what `size` and `design` of the package call |
//! | `parameters` | the quantities of a scenario file |
//! | `linear` | `linearize`, the class `LinearModel` |
//! | `statics` | force, stiffness and volume on arrays: what `Statics` of the package computes with |
//! | `identification` | what `identify` of the package calls |
//! | `differentiable` | runs as functions with exact derivatives: `Differentiable` |
//! | `differentiable_step` | a step of the modular actuator with its exact Jacobian: `DifferentiableStep` |
//! | `sweep` | a sweep by its parts: `Sweep` |
//! | `pool` | the threads of this process, and of one that was forked |
//! | `python` | functions of the package that are written in Python |
//! | `columns` | columns of numbers and words as NumPy arrays |
//! | `typed` | objects with the types that the stubs give them |
//! | `values` | dictionaries of Python to TOML and back |
//! | `arguments` | numbers, arrays and counts that are refused by their argument's name |
//! | `signals` | Ctrl-C while the core works |
//! | `exceptions` | failures as the exceptions of `mckibben.errors` |
//!
//! There is no physics here: everything is done by the core and by `mckibben-run`, so that what Python gives
//! is bit-identical to what `mckibben simulate` writes. Whatever takes longer than a microsecond runs with the interpreter
//! released. What is thin and Python's own (plots, data frames) is in `python/mckibben`. Checked by `python/tests`.

mod actuator;
mod actuators;
mod alone;
mod arguments;
mod choosing;
mod columns;
mod curves;
mod differentiable;
mod differentiable_step;
mod exceptions;
mod hosted_plant;
mod identification;
mod linear;
mod pace;
mod parameters;
mod pool;
mod python;
mod scenario;
mod signals;
mod statics;
mod sweep;
mod trajectory;
mod typed;
mod values;
mod vector_plant;

/// Compiled part of the package `mckibben`.
#[pyo3::pymodule]
mod _mckibben {
    use numpy::{PyArray1, PyArrayMethods};
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::actuator::{Actuator, ActuatorState, Response};
    #[pymodule_export]
    use crate::actuators::Actuators;
    #[pymodule_export]
    use crate::choosing::{_Sizes, _design};
    #[pymodule_export]
    use crate::curves::{_curves, _presets};
    #[pymodule_export]
    use crate::differentiable::Differentiable;
    #[pymodule_export]
    use crate::differentiable_step::DifferentiableStep;
    #[pymodule_export]
    use crate::hosted_plant::{_register_mujoco, HostedPlant};
    #[pymodule_export]
    use crate::identification::{_identify, _identify_file};
    #[pymodule_export]
    use crate::linear::{LinearModel, linearize};
    #[pymodule_export]
    use crate::parameters::_parameters;
    #[pymodule_export]
    use crate::scenario::{_quantity, Scenario};
    #[pymodule_export]
    use crate::statics::{_Statics, _si};
    #[pymodule_export]
    use crate::sweep::Sweep;
    #[pymodule_export]
    use crate::trajectory::{Event, Trajectory, simulate};
    #[pymodule_export]
    use crate::vector_plant::VectorPlant;

    /// Gets what NumPy has for compiled code, once: where that is done within a run, Ctrl-C may end it, which rust-numpy takes for a
    /// missing NumPy and panics.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let py = module.py();
        // A NumPy that is missing is an exception of the import.
        py.import("numpy")?;
        numpy::npyffi::is_numpy_2(py);
        // The first borrow gets the table of borrows.
        drop(PyArray1::<f64>::zeros(py, 1, false).try_readwrite());
        Ok(())
    }

    /// The version of the package.
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "it is Python's name")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
