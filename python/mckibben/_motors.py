"""Motors of a model of MuJoCo whose force is what is written into their control, and no other force."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy
from numpy.typing import NDArray

from mckibben.errors import InputError


def addresses(model: Any, field: str, actuators: Sequence[int]) -> NDArray[numpy.int64]:
    """Places of actuators in arrays of controls or forces."""
    known = getattr(model, field, None)
    return numpy.array(actuators if known is None else [known[at] for at in actuators], dtype=numpy.int64)


def check_actuation(mujoco: Any, model: Any) -> None:
    """Refuses a model in which motors exert no force."""
    if int(model.opt.disableflags) & int(mujoco.mjtDisableBit.mjDSBL_ACTUATION):
        raise InputError(
            'the model has <flag actuation="disable"/>, so that its motors exert no force: leave the flag out, or write '
            'actuation="enable"'
        )


def check_motor(mujoco: Any, model: Any, at: int) -> None:
    """Refuses an actuator whose force would not be the tension that is written into its control."""
    name, kind, joint_kind = model.actuator(at).name, mujoco.mjtTrn, mujoco.mjtJoint
    drives = int(model.actuator_trntype[at])
    target = int(model.actuator_trnid[at][0])
    gear, gain = model.actuator_gear[at][0], model.actuator_gainprm[at][0]

    def refuse(what: str, remedy: str) -> None:
        raise InputError(f"the motor `{name}` {what}: {remedy}")

    plain = f'write <motor name="{name}" tendon="…"/>'
    group = int(model.actuator_group[at])
    if 0 <= group < 31 and int(model.opt.disableactuator) >> group & 1:
        refuse(f"is of group {group}, which the model disables", f"leave {group} out of <option actuatorgroupdisable=…/>")
    if model.actuator_plugin[at] >= 0:
        refuse("belongs to a plugin, which computes its force", f"step this model with mujoco.mj_step, or {plain}")
    if model.actuator_dyntype[at] != int(mujoco.mjtDyn.mjDYN_NONE):
        refuse("has a dyntype, so its force lags behind the tension", plain)
    if model.actuator_biastype[at] != int(mujoco.mjtBias.mjBIAS_NONE):
        refuse("has a biastype, which adds to the tension", f"{plain}, not <position>, <velocity> or <muscle>")
    if model.actuator_gaintype[at] != int(mujoco.mjtGain.mjGAIN_FIXED) or gain != 1.0:
        refuse("has a gaintype or gainprm by which its force is not the tension", f'{plain}, or gainprm="1"')
    if drives not in map(int, (kind.mjTRN_JOINT, kind.mjTRN_JOINTINPARENT, kind.mjTRN_TENDON)):
        refuse("is on no tendon or joint", plain)
    on_joint = drives != int(kind.mjTRN_TENDON)
    if on_joint and int(model.jnt_type[target]) not in map(int, (joint_kind.mjJNT_HINGE, joint_kind.mjJNT_SLIDE)):
        refuse(f"is on the joint `{model.joint(target).name}`, which has no single coordinate", plain)
    if gear != 1.0:
        refuse(f'has gear="{gear:g}", which scales both length and tension', 'write gear="1", or leave it out')
    ranges = {
        "ctrlrange": (model.actuator_ctrllimited, model.actuator_ctrlrange, addresses(model, "actuator_ctrladr", [at])[0]),
        "forcerange": (model.actuator_forcelimited, model.actuator_forcerange, at),
    }
    for attribute, (limited, ends, place) in ranges.items():
        if limited[place]:
            low, high = ends[place]
            refuse(f'has {attribute}="{low:g} {high:g}", which would clip the tension', f"leave {attribute} out")
    delay = getattr(model, "actuator_delay", None)
    if delay is not None and delay[at] > 0.0:
        refuse(f'has delay="{delay[at]:g}", so its force lags behind the tension', "leave delay out")
    tendons = getattr(model, "tendon_actfrclimited", None)
    if not on_joint and tendons is not None and tendons[target]:
        low, high = model.tendon_actfrcrange[target]
        words = f'pulls the tendon `{model.tendon(target).name}`, whose actuatorfrcrange="{low:g} {high:g}" would clip the tension'
        refuse(words, "leave actuatorfrcrange of the tendon out")
    for joint in [target] if on_joint else _joints_of(mujoco, model, target):
        if model.jnt_actfrclimited[joint]:
            low, high = model.jnt_actfrcrange[joint]
            words = f'moves the joint `{model.joint(joint).name}`, whose actuatorfrcrange="{low:g} {high:g}" would clip its effect'
            refuse(words, "leave actuatorfrcrange of the joint out")


def _joints_of(mujoco: Any, model: Any, tendon: int) -> Iterator[int]:
    """Joints that change the length of a tendon: those that it names, or those between the bodies of its sites."""
    first = model.tendon_adr[tendon]
    above: list[set[int]] = []
    for wrap in range(first, first + model.tendon_num[tendon]):
        kind, at = int(model.wrap_type[wrap]), int(model.wrap_objid[wrap])
        if kind == int(mujoco.mjtWrap.mjWRAP_JOINT):
            yield at
            continue
        owner = {
            int(mujoco.mjtWrap.mjWRAP_SITE): model.site_bodyid,
            int(mujoco.mjtWrap.mjWRAP_SPHERE): model.geom_bodyid,
            int(mujoco.mjtWrap.mjWRAP_CYLINDER): model.geom_bodyid,
        }.get(kind)
        if owner is None:
            continue
        bodies: set[int] = set()
        body = int(owner[at])
        while body > 0:
            bodies.add(body)
            body = int(model.body_parentid[body])
        above.append(bodies)
    shared = above[0].intersection(*above) if above else set()
    for body in sorted(set().union(*above) - shared):
        first = model.body_jntadr[body]
        yield from range(first, first + model.body_jntnum[body])
