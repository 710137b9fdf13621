"""Simulator of braided pneumatic actuators (BPA, McKibben muscles): valve state in, force out.

>>> import mckibben
>>> scenario = mckibben.Scenario('''
... [load]
... kind = "hanging-mass"
... mass = "5 lb"
... [initial]
... gauge_pressure = "60 psi"
... [run]
... duration = "0.1 s"
... ''')
>>> trajectory = mckibben.simulate(scenario)
>>> trajectory.units["length_m"]
'm'

Numbers are in SI; a quantity of a scenario may be text with its unit. A run is bit-identical to that of the command
`mckibben simulate`.
"""

from mckibben._mckibben import (
    Actuator,
    Actuators,
    ActuatorState,
    Differentiable,
    DifferentiableStep,
    Event,
    HostedPlant,
    LinearModel,
    Response,
    Scenario,
    Sweep,
    Trajectory,
    VectorPlant,
    __version__,
    linearize,
    simulate,
)
from mckibben._choosing import Constrained, DesignResult, SizedMuscle, Sizes, design, size
from mckibben._identify import (
    Estimate,
    Identification,
    OtherMinimum,
    Prediction,
    Run,
    StepInfo,
    StepResponse,
    Study,
    identify,
)
from mckibben._statics import Curves, Statics, curves
from mckibben._sweep import SweepResult, SweepWarning, sweep
from mckibben._tables import Parameter, Preset, PresetValue, parameters, presets
from mckibben.errors import Error, InputError, OutputError, SimulationError

__all__ = [
    "Actuator",
    "ActuatorState",
    "Actuators",
    "Constrained",
    "Curves",
    "DesignResult",
    "Differentiable",
    "DifferentiableStep",
    "Error",
    "Estimate",
    "Event",
    "HostedPlant",
    "Identification",
    "InputError",
    "LinearModel",
    "OtherMinimum",
    "OutputError",
    "Parameter",
    "Prediction",
    "Preset",
    "PresetValue",
    "Response",
    "Run",
    "Scenario",
    "SimulationError",
    "SizedMuscle",
    "Sizes",
    "Statics",
    "StepInfo",
    "StepResponse",
    "Study",
    "Sweep",
    "SweepResult",
    "SweepWarning",
    "Trajectory",
    "VectorPlant",
    "__version__",
    "curves",
    "design",
    "identify",
    "linearize",
    "parameters",
    "presets",
    "simulate",
    "size",
    "sweep",
]
