"""What muscles cost in a step of MuJoCo: a body of a humanoid's size with 20 of them.

    python mujoco_step.py

The peer is MuJoCo's own `<muscle>` on equal tendons, beside the body with motors that do nothing. All take turns; the median of
rounds is given, with what each adds to a step in percent and in ns for each muscle. Controls are equal random numbers. That our
muscles pull is asserted by their pressures and forces.
"""

from __future__ import annotations

import os
import statistics
import time

import mujoco
import numpy

import mckibben.mujoco

MUSCLES = 20
ROUNDS = 15
STEPS = 500


def limb(name: str, at: str) -> str:
    """A limb of five joints and two links."""
    axes = ["1 0 0", "0 1 0", "0 0 1", "0 1 0", "0 1 0"]
    body = ""
    for number, axis in reversed(list(enumerate(axes))):
        heavy = number in (2, 4)
        link = '<geom type="capsule" fromto="0 0 0 0 0 -0.3" size="0.04" mass="2"/>' if heavy else ""
        inertia = "" if heavy else '<inertial pos="0 0 0" mass="0.05" diaginertia="1e-3 1e-3 1e-3"/>'
        place = at if number == 0 else ("0 0 -0.3" if number == 3 else "0 0 0")
        joint = f'<joint name="{name}{number}" axis="{axis}" damping="2" armature="0.02" stiffness="20"/>'
        body = f'<body pos="{place}">{joint}{inertia}{link}{body}</body>'
    return body


def model(actuator: str, extra: str = "") -> mujoco.MjModel:
    limbs = {"left-arm": "0 0.2 0.3", "right-arm": "0 -0.2 0.3", "left-leg": "0 0.1 -0.2", "right-leg": "0 -0.1 -0.2"}
    bodies = "".join(limb(name, at) for name, at in limbs.items())
    tendons, actuators = "", ""
    for limb_number, name in enumerate(limbs):
        for number in range(5):
            at = 5 * limb_number + number
            tendons += f'<fixed name="m{at}"><joint joint="{name}{number}" coef="-0.01"/></fixed>'
            actuators += actuator.format(name=f"m{at}")
    return mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <option timestep="0.002"/>
      {extra}
      <worldbody>
        <geom type="plane" size="5 5 0.1"/>
        <body pos="0 0 1.2"><freejoint/><geom type="box" size="0.12 0.2 0.25" mass="25"/>{bodies}</body>
      </worldbody>
      <tendon>{tendons}</tendon>
      <actuator>{actuators}</actuator>
    </mujoco>""")


def scenario() -> str:
    names = "\n".join(f"[actuators.m{at}]" for at in range(MUSCLES))
    return f"""
[supplies.tank]
gauge_pressure = "6 bar"
reservoir_volume = "5 L"
[valve]
preset = "matrix-eight-channel"
[command]
kind = "exhaust"
[load]
kind = "isometric"
[initial]
gauge_pressure = "1 bar"
length = "85 mm"
{names}
[run]
duration = "1 s"
"""


def plugin(config: dict[str, str]) -> str:
    pairs = "".join(f'<config key="{key}" value=\'{value}\'/>' for key, value in config.items())
    return f'<extension><plugin plugin="mckibben.muscle"><instance name="all">{pairs}</instance></plugin></extension>'


def main() -> None:
    mckibben.mujoco.load()
    one = {"length_offset": "85 mm", "pulse_frequency": "25 Hz"}
    alone = one | {
        "supply.gauge_pressure": "6 bar",
        "valve.preset": "matrix-eight-channel",
        "initial.gauge_pressure": "1 bar",
    }
    pairs = "".join(f'<config key="{key}" value="{value}"/>' for key, value in alone.items())
    models = {
        "motors that do nothing": model('<motor name="{name}" tendon="{name}" gear="0"/>'),
        "MuJoCo's own muscles": model(
            '<muscle name="{name}" tendon="{name}" lengthrange="-0.02 0.02" force="20"/>'
        ),
        "ours, each with its supply": model(
            '<plugin name="{name}" tendon="{name}" plugin="mckibben.muscle">' + pairs + "</plugin>",
            '<extension><plugin plugin="mckibben.muscle"/></extension>',
        ),
        "ours, all on one tank": model(
            '<plugin name="{name}" tendon="{name}" plugin="mckibben.muscle" instance="all"/>',
            plugin(one | {"scenario_text": scenario()}),
        ),
    }
    controls = numpy.random.default_rng(1).uniform(0.2, 0.8, (STEPS, MUSCLES))
    times: dict[str, list[float]] = {name: [] for name in models}
    for _ in range(ROUNDS):
        for name, of in models.items():
            data = mujoco.MjData(of)
            began = time.perf_counter()
            for control in controls:
                data.ctrl[:] = control
                mujoco.mj_step(of, data)
            times[name].append((time.perf_counter() - began) / STEPS)
            assert numpy.isfinite(data.qpos).all()
            if name.startswith("ours"):
                assert (data.actuator_force < 0.0).sum() > MUSCLES // 2 and not any(w.number for w in data.warning)
    freedom = models["motors that do nothing"].nv
    print(f"MuJoCo {mujoco.__version__}, {freedom} degrees of freedom, {MUSCLES} muscles; load {os.getloadavg()[0]:.1f}")
    medians = {name: statistics.median(each) for name, each in times.items()}
    base = medians["motors that do nothing"]
    for name, median in medians.items():
        added = median - base
        print(f"{name:30s} {1e6 * median:8.1f} us a step {100 * added / base:+7.1f} % {1e9 * added / MUSCLES:8.0f} ns a muscle")


if __name__ == "__main__":
    main()
