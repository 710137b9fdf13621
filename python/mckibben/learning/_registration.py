"""The names of the environments in Gymnasium's registry."""

import gymnasium

IDS = {"mckibben/HangingMass-v0": "HangingMass", "mckibben/Joint-v0": "Joint", "mckibben/Leg-v0": "Leg"}


def register() -> None:
    """Registers the environments, once; Gymnasium calls it when it is imported."""
    for name, task in IDS.items():
        if name not in gymnasium.registry:
            gymnasium.register(
                name,
                entry_point="mckibben.learning:Environment",
                vector_entry_point="mckibben.learning:VectorEnvironment",
                kwargs={"task": task},
                # Episodes end by themselves, in the vector form too.
                order_enforce=True,
            )
