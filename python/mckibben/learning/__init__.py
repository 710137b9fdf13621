"""Environments for Gymnasium: a muscle that lifts a mass, an antagonistic joint, a leg, an arm, and any scenario file.

>>> import gymnasium, mckibben.learning
>>> environment = gymnasium.make("mckibben/HangingMass-v0", noise={"length_m": 1e-4})
>>> many = gymnasium.make_vec("mckibben/HangingMass-v0", num_envs=4096, randomize={"load.mass": (1.5, 3.0)})

Needs Gymnasium: `pip install "mckibben[learning]"`. Environments are registered when this module is imported.

| id | controlled quantity | valves |
|---|---|---|
| `mckibben/HangingMass-v0` | the length of a muscle that lifts a mass | 1 |
| `mckibben/Joint-v0` | the angle of an antagonistic joint | 2 |
| `mckibben/Leg-v0` | hip and knee of a leg of six muscles, by default on a belt | 6 |
| `mckibben/Arm-v0` | shoulder, elbow and wrist of an arm of six muscles on a manifold | 6 |
| `mckibben/Scenario-v0` | the columns in `targets`, of any scenario file | those of the file |

>>> leg = gymnasium.make("mckibben/Scenario-v0", scenario="examples/plant/leg.toml", action_mode="set-point")

`reach` makes a task of any plant, for `VectorEnvironment(reach(scenario, targets), num_envs=256)`; `task` makes one by its name.

A target is drawn for each episode and is part of the observation. The reward of a step is minus the distance from the target,
as a share of the range of targets. By default an action lasts for one pulse, or, where actions are not duty cycles, longer than
the delays of the valve, so that each changes the state. Every other setting is that of the scenario.
"""

from mckibben.learning._single import Environment
from mckibben._gymnasium import register
from mckibben.learning._options import Options
from mckibben.learning._tasks import Seen, Task, reach, task
from mckibben.learning._vector import VectorEnvironment

__all__ = [
    "Environment",
    "Options",
    "Seen",
    "Task",
    "VectorEnvironment",
    "reach",
    "register",
    "task",
]

register()
