"""Environments of any scenario file: every plant is bit-identical to a scalar instance, in any batch and on any number of threads."""

import hashlib
import os
import pathlib
import subprocess
import sys
import tomllib
from typing import Any

import gymnasium
import numpy as np
import pytest

import mckibben
from mckibben import learning
from mckibben._mckibben import VectorPlant

PLANTS = pathlib.Path(__file__).parents[2] / "examples" / "plant"
TASKS = {"rig": "HangingMass", "joint": "Joint", "leg": "Leg", "arm": "Arm"}
COUNT, STEPS, PERIOD = 5, 14, 0.012


def drawn(name: str) -> tuple[list[str], np.ndarray]:
    """Paths of parameters, and values of each of `COUNT` plants."""
    paths = {
        "rig": ["load.mass", "actuator.friction.viscous"],
        "joint": ["load.mass", "load.damping"],
        "leg": ["mechanism.joints.hip.mass", "actuator.friction.viscous"],
        "arm": ["mechanism.joints.elbow.mass", "actuators.biceps.friction.viscous"],
    }[name]
    low, high = ([0.3, 0.02], [0.6, 0.05]) if name == "joint" else ([0.3, 2.0], [0.6, 5.0])
    return paths, np.random.default_rng(5).uniform(low, high, (COUNT, 2))


def scenario(name: str) -> mckibben.Scenario:
    of_task = learning.task(TASKS[name]).scenario
    return of_task.with_values({"actuators.biceps.friction.viscous": "3 N*s/m"}) if name == "arm" else of_task


def history(name: str, rows: list[int], *, varies: bool = True) -> np.ndarray:
    """What these plants of `COUNT` show after each step, some of which begin again on the way: (STEPS, rows, columns)."""
    paths, values = drawn(name)
    plants = VectorPlant(scenario(name), len(rows), parameters=paths if varies else [])
    commands = np.random.default_rng(6).uniform(0.0, 1.0, (STEPS, COUNT, plants.valves))
    again = np.random.default_rng(7).random((STEPS, COUNT)) < 0.15
    assert again[1:-1].any(axis=0).sum() >= 3
    if varies:
        plants.start(values[rows])
    shown, stopped, seen = np.zeros((len(rows), len(plants.columns))), np.zeros(len(rows), dtype=bool), []
    for step in range(STEPS):
        begin = np.flatnonzero(again[step, rows])
        if len(begin):
            plants.restart(begin, values[rows][begin] if varies else None)
        plants.step(commands[step, rows], PERIOD, shown, stopped)
        assert not stopped.any()
        seen.append(shown.copy())
    return np.array(seen)


@pytest.mark.parametrize("varies", [True, False])
@pytest.mark.parametrize("name", TASKS)
def test_every_plant_is_bit_identical_to_a_scalar_instance(name: str, varies: bool) -> None:
    together = history(name, list(range(COUNT)), varies=varies)
    assert len({together[:, row].tobytes() for row in range(COUNT)}) == COUNT
    for row in range(COUNT):
        np.testing.assert_array_equal(history(name, [row], varies=varies)[:, 0], together[:, row])
    turned = history(name, [3, 0, 2], varies=varies)
    np.testing.assert_array_equal(turned, together[:, [3, 0, 2]])


def digest() -> str:
    bits = b"".join(history(name, [0, 1, 2, 3, 4] * 4).tobytes() for name in TASKS)
    return hashlib.sha256(bits).hexdigest()


def test_the_number_of_threads_changes_no_bit() -> None:
    found = set()
    for threads in ("1", "3"):
        code = "import test_learning_plants; print(test_learning_plants.digest())"
        path = os.pathsep.join([str(pathlib.Path(__file__).parent), *sys.path])
        environment = {**os.environ, "RAYON_NUM_THREADS": threads, "PYTHONPATH": path}
        done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
        found.add(done.stdout)
    assert len(found) == 1


def test_a_plant_that_begins_again_does_what_it_did_at_first() -> None:
    """Its clock goes on, so that the same but for the rounding of times."""
    for name in TASKS:
        plants = VectorPlant(scenario(name), 1, pulse_frequency=1.0 / PERIOD)
        commands = np.random.default_rng(8).uniform(0.4, 1.0, (8, 1, plants.valves))
        shown, stopped, seen = np.zeros((1, len(plants.columns))), np.zeros(1, dtype=bool), []
        for _ in range(2):
            for command in commands:
                plants.step(command, PERIOD, shown, stopped)
                seen.append(shown.copy())
            plants.restart(np.array([0]))
        first, second = np.split(np.array(seen), 2)
        np.testing.assert_allclose(second, first, rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("name, mode", [("arm", "request"), ("leg", "set-point")])
def test_the_examples_are_environments(name: str, mode: str) -> None:
    example = mckibben.Scenario.from_file(PLANTS / f"{name}.toml").with_values({"run.step": "0.5 ms"})
    many = gymnasium.make_vec(f"mckibben/{name.capitalize()}-v0", num_envs=3, scenario=example, action_mode=mode, duration=0.05)
    observed, info = many.reset(seed=1)
    many.action_space.seed(1)
    joints = {"arm": ["shoulder", "elbow", "wrist"], "leg": ["hip", "knee"]}[name]
    assert {f"{joint}.angle_rad" for joint in joints} <= set(info)
    for _ in range(7):
        assert observed in many.observation_space and np.isfinite(observed).all()
        observed, *_ = many.step(many.action_space.sample())
    assert len({row.tobytes() for row in many.unwrapped.observations}) == 3


@pytest.mark.parametrize("name", ["arm", "leg"])
def test_the_tasks_have_the_mechanisms_of_the_examples(name: str) -> None:
    example = tomllib.loads((PLANTS / f"{name}.toml").read_text())
    ours = learning.task(TASKS[name]).scenario.to_dict()
    assert ours["mechanism"] == example["mechanism"] and ours["coupling"] == example["coupling"]
    assert ours.get("supplies") == example.get("supplies")
    couplings = {muscle: its["coupling"] for muscle, its in example["actuators"].items()}
    assert {muscle: its["coupling"] for muscle, its in ours["actuators"].items()} == couplings


def test_any_scenario_is_an_environment() -> None:
    """Two bottles of unlike muscles, a joint behind hoses: what is to reach a target is named by its column."""
    for file, targets in [("bottle", {"thick.length_m": (0.06, 0.07)}), ("hose-joint", {"elbow.angle_rad": (-0.2, 0.2)})]:
        plant = mckibben.Scenario.from_file(PLANTS / f"{file}.toml").with_values({"run.step": "0.5 ms"})
        options: dict[str, Any] = {"action_mode": "request", "control_period": 5e-3, "max_episode_steps": 4}
        many = learning.VectorEnvironment(learning.reach(plant, targets), 2, **options)
        observed, _ = many.reset(seed=1)
        for _ in range(4):
            observed, *_, truncated, info = many.step(many.action_space.sample())
        assert truncated.all() and np.isfinite(observed).all() and set(targets) < set(info)
    with pytest.raises(mckibben.InputError, match="is no column of this plant; name one of"):
        learning.reach(plant, {"wrist.angle_rad": (0.0, 1.0)})


SCENARIO = "mckibben/Scenario-v0"
EXAMPLES = PLANTS.parent


def step_given(file: str) -> mckibben.Scenario:
    return mckibben.Scenario.from_file(EXAMPLES / file).with_values({"run.step": "0.5 ms"})


@pytest.mark.parametrize(
    "file, options, targets",
    [
        ("fill-hold-exhaust.toml", {"action_mode": "request"}, ["length_m"]),
        ("tendon.toml", {"pulse_frequency": 25.0}, ["length_m"]),
        ("valves/pressure-regulator.toml", {"action_mode": "set-point"}, ["length_m"]),
        ("valves/proportional-spool.toml", {"action_mode": "position"}, ["length_m"]),
        ("antagonistic-joint.toml", {"action_mode": "request"}, ["angle_rad"]),
        ("moment-arm.toml", {"action_mode": "request"}, ["angle_rad"]),
        ("plant/bottle.toml", {"action_mode": "request"}, ["paper.length_m", "thick.length_m", "long.length_m"]),
        ("plant/hose-joint.toml", {"action_mode": "request"}, ["elbow.angle_rad"]),
        ("plant/leg.toml", {"action_mode": "set-point"}, ["hip.angle_rad", "knee.angle_rad"]),
        ("plant/arm.toml", {"action_mode": "request"}, [f"{joint}.angle_rad" for joint in ("shoulder", "elbow", "wrist")]),
    ],
)
def test_a_scenario_file_of_any_plant_is_an_environment(file: str, options: dict[str, Any], targets: list[str]) -> None:
    """With targets that are chosen for it; the path of a file and what was read from it mean the same."""
    one = gymnasium.make(SCENARIO, scenario=step_given(file), max_episode_steps=3, **options)
    many = gymnasium.make_vec(SCENARIO, num_envs=2, scenario=step_given(file), max_episode_steps=3, **options)
    assert list(one.unwrapped._episodes.task.targets) == list(many.unwrapped._episodes.task.targets) == targets
    (observed, _), (both, _) = one.reset(seed=3), many.reset(seed=3)
    for _ in range(3):
        np.testing.assert_array_equal(both[0], observed)
        assert observed in one.observation_space
        action = many.action_space.sample()
        (observed, reward, *_), (both, rewards, *_) = one.step(action[0]), many.step(action)
        assert rewards[0] == reward
    if file == "fill-hold-exhaust.toml":
        for path in (EXAMPLES / file, str(EXAMPLES / file)):
            loaded = gymnasium.make(SCENARIO, scenario=path, **options).unwrapped
            assert loaded._episodes.task.targets == one.unwrapped._episodes.task.targets


def test_targets_that_are_chosen_are_within_reach() -> None:
    """Lengths from where the supply's pressure lifts the load to where it hangs without pressure; angles between the stops."""
    # Without dry friction, which stops the muscle up to a millimetre away, and with enough damping to come to rest in 2 s.
    friction = {"actuator.friction.coulomb_width": 0.0, "actuator.friction.viscous": 60.0}
    free = step_given("fill-hold-exhaust.toml").with_values(friction)
    targets = learning.reach(free).targets
    many = gymnasium.make_vec(SCENARIO, num_envs=2, scenario=free, action_mode="request", max_episode_steps=400)
    many.reset(seed=1)
    for _ in range(400):
        many.step(np.array([many.single_action_space.n - 1, 0]))
    short, long = many.unwrapped.observations[:, 0]
    low, high = targets["length_m"]
    assert low == pytest.approx(short + 0.1 * (long - short), abs=1e-4)
    # The braid, taut without pressure, stretches by a quarter of a millimetre.
    assert high == pytest.approx(long - 0.1 * (long - short), abs=3e-4)
    stops = np.radians([-40.0, 40.0])
    assert learning.reach(step_given("antagonistic-joint.toml")).targets["angle_rad"] == pytest.approx(0.8 * stops)
    # Each of three unlike muscles has its own load.
    ranges = learning.reach(step_given("plant/bottle.toml")).targets
    assert ranges["thick.length_m"][0] > ranges["paper.length_m"][0] and ranges["long.length_m"][0] > 0.13


def test_a_mass_that_several_actuators_move_has_the_lengths_that_all_can_have() -> None:
    sections = step_given("plant/bottle.toml").to_dict()
    sections["mechanism"] = {"kind": "mass", "mass": "5 kg", "position": "90 mm"}
    del sections["load"]
    actuators = {"one": {"preset": "colbrunn-2001"}, "other": {"preset": "colbrunn-2001", "max_length": "90 mm"}}
    targets = learning.reach(mckibben.Scenario.from_dict({**sections, "actuators": actuators})).targets
    assert list(targets) == ["mechanism.position_m"]
    short, long = 0.10977372 / np.sqrt(3.0), 0.09
    assert targets["mechanism.position_m"] == pytest.approx((0.9 * short + 0.1 * long, 0.1 * short + 0.9 * long), rel=1e-5)


@pytest.mark.parametrize(
    "options, words",
    [
        ({}, "scenario is missing: give a mckibben.Scenario or the path"),
        ({"scenario": step_given("sweep-co-contraction.toml")}, "no valve that could be commanded"),
        ({"scenario": 3}, "scenario = 3: give a mckibben.Scenario or the path"),
        ({"scenario": step_given("isometric-charge.toml")}, r"nothing in this plant moves freely.*targets=\{"),
        ({"scenario": step_given("plant/controlled.toml")}, r"`elbow.angle_rad`, whose joint lacks a stop; give .*min_angle"),
        ({"scenario": step_given("fill-hold-exhaust.toml").with_values({"load.mass": "90 lb"})}, "cannot lift its load"),
        ({"scenario": step_given("antagonistic-joint.toml"), "targets": {"length_m": (0.1, 0.2)}}, "name one of angle_rad"),
        ({"scenario": step_given("antagonistic-joint.toml"), "targets": {"angle_rad": (0.2, 0.1)}}, "the lower first"),
        ({"scenario": step_given("antagonistic-joint.toml"), "targets": {"angle_rad": 0.2}}, "give two finite numbers in SI"),
        ({"scenario": step_given("antagonistic-joint.toml"), "targets": {}}, "one at least, of angle_rad"),
    ],
)
def test_where_no_task_can_be_made_the_message_says_what_to_give(options: dict[str, Any], words: str) -> None:
    with pytest.raises(mckibben.InputError, match=words):
        gymnasium.make(SCENARIO, **options)


def test_every_number_of_a_file_can_be_drawn() -> None:
    ranges = {"mechanism.joints.hip.mass": (0.3, 0.5), "mechanism.joints.knee.damping": (0.01, 0.03),
              "mechanism.belt.velocity": (-0.5, 0.0), "actuators.knee-back.coupling.rest_length": (0.077, 0.079),
              "actuator.turns": (2.4, 2.6), "actuator.friction.viscous": (2.0, 5.0),
              "mechanism.joints.hip.angle": (-0.2, 0.2), "supply.gauge_pressure": (5e5, 7e5)}
    many = gymnasium.make_vec("mckibben/Leg-v0", num_envs=6, randomize=ranges)
    many.reset(seed=1)
    hips = many.unwrapped.observations[:, many.unwrapped.columns.index("hip.angle_rad")]
    assert len(set(hips)) == 6 and (np.abs(hips) <= 0.2).all()
    many.step(many.action_space.sample())
    with pytest.raises(mckibben.InputError, match="colour"):
        gymnasium.make_vec("mckibben/Leg-v0", num_envs=1, randomize={"mechanism.joints.hip.colour": (0.0, 1.0)})


def test_a_joint_takes_positions_and_set_points() -> None:
    """A joint whose muscles have spools, and one whose muscles have regulators."""
    from test_learning_actions import REGULATOR, SPOOL

    for mode, valve in [("position", SPOOL), ("set-point", REGULATOR)]:
        sections = learning.task("Joint").scenario.to_dict()
        for of in (sections, sections["antagonist"]) if "antagonist" in sections else (sections,):
            for section in ("valve", "command"):
                of.pop(section, None)
            of["valve"] = {"flow_area": "1.8e-5 ft^2", "efficiency": 0.85}
            for path, value in valve.items():
                section, _, key = path.partition(".")
                of[section] = of.get(section, {}) | {key: value} if key else value
        joint = mckibben.Scenario.from_dict(sections)
        many = gymnasium.make_vec("mckibben/Joint-v0", num_envs=3, scenario=joint, action_mode=mode)
        many.reset(seed=1)
        for _ in range(10):
            many.step(np.array([[0.6, 0.1], [0.1, 0.6], [0.3, 0.3]], dtype=np.float32))
        first, second, middle = many.unwrapped.observations[:, 0]
        assert first > middle > second


#: Muscles by the kind of their valve and by what is requested in a pulse and between pulses.
PULSED = {
    "holds": ("fill-hold-exhaust", {"pulse": "fill", "rest": "hold"}),
    "exhausts": ("fill-hold-exhaust", {"pulse": "fill", "rest": "exhaust"}),
    "vents": ("fill-hold-exhaust", {"pulse": "exhaust", "rest": "hold"}),
    "two-way": ("two-way", {}),
    "three-way": ("three-way", {}),
}


def pulsed(*names: str) -> mckibben.Scenario:
    """Muscles of constant length on one tank, whose pressure is constant."""
    kinds = {name: PULSED[name] for name in names}
    return mckibben.Scenario.from_dict(
        {
            "supplies": {"tank": {"gauge_pressure": "6 bar"}},
            "initial": {"gauge_pressure": "2 bar", "length": "88 mm"},
            "load": {"kind": "isometric"},
            "actuators": {
                name: {
                    "valve": {"kind": kind, "flow_area": "1.5 mm^2", "opening_delay": "3 ms", "closing_delay": "1 ms"},
                    "command": {"kind": "pwm", "frequency": "20 Hz", "duty": 0.4, **requests},
                }
                for name, (kind, requests) in kinds.items()
            },
            "run": {"duration": "0.3 s", "engine": "fixed-step", "method": "rk4", "step": "0.1 ms"},
        }
    )


@pytest.mark.parametrize("names", [list(PULSED), list(PULSED)[::-1]])
def test_each_valve_has_the_requests_of_its_pwm(names: list[str]) -> None:
    """As alone in a file; all were pulsed by those of the first PWM, and a two-way valve beside a three-way valve was refused."""

    def pressures(of: mckibben.Scenario) -> dict[str, float]:
        plants = VectorPlant(of, 1)
        shown, stopped = np.zeros((1, len(plants.columns))), np.zeros(1, dtype=bool)
        for _ in range(6):
            plants.step(np.full((1, plants.valves), 0.4), 0.05, shown, stopped)
        assert not stopped.any() and plants.pulses == 20.0
        return {name: value for name, value in zip(plants.columns, shown[0]) if name.endswith("absolute_pressure_pa")}

    together = pressures(pulsed(*names))
    alone = {key: value for name in names for key, value in pressures(pulsed(name)).items()}
    assert together == pytest.approx(alone, rel=1e-9)
    assert alone["holds.absolute_pressure_pa"] > 3.0 * alone["exhausts.absolute_pressure_pa"] > 1e5, alone
    # So does an environment, whose valves are those of its plant.
    one = gymnasium.make(SCENARIO, scenario=pulsed(*names), targets={"holds.length_m": (0.083, 0.087)}, duration=0.3)
    one.reset(seed=0)
    for _ in range(6):
        info = one.step(np.full(len(names), 0.4, dtype=np.float32))[4]
    assert {key: info[key] for key in alone} == pytest.approx(alone, rel=1e-6)
