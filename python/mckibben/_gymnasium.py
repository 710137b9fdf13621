"""The names of the environments in Gymnasium's registry."""

from gymnasium.envs.registration import register as to_register
from gymnasium.envs.registration import registry

IDS = {f"mckibben/{task}-v0": task for task in ("HangingMass", "Joint", "Leg", "Arm", "Scenario")}


def register() -> None:
    """Registers the environments, once.

    The number of steps of an episode depends on the options: each environment puts it into its own `spec`. Here, it would
    become a wrapper that cuts longer episodes off.
    """
    for name, task in IDS.items():
        if name not in registry:
            to_register(
                name,
                entry_point="mckibben.learning:Environment",
                vector_entry_point="mckibben.learning:VectorEnvironment",
                kwargs={"task": task},
            )
