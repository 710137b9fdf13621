"""Environments: pictures show where the plant is, by the scenario's own lengths, and change nothing of it."""

import pathlib
import re
import sys
import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import DependencyNotInstalled, ResetNeeded
from gymnasium.utils.env_checker import check_env
from PIL import Image

import mckibben
from mckibben import learning
from mckibben.learning._chain import Chain, axes
from mckibben.learning._drawing import ATMOSPHERE, PAPER, shade
from mckibben.learning._plant import Plant
from mckibben.learning._render import PANEL, SIZE, Renderer

ROOT = pathlib.Path(__file__).parents[2]
NAMES = ["HangingMass", "Joint", "Leg", "Arm"]
SHAPE = (SIZE[1], SIZE[0], 3)


def made(name: str, **options: Any) -> Any:
    return gymnasium.make(f"mckibben/{name}-v0", render_mode="rgb_array", **options)


def example(file: str) -> mckibben.Scenario:
    return mckibben.Scenario.from_file(ROOT / "examples" / f"{file}.toml").with_values({"run.step": "0.5 ms"})


def renderer(scenario: mckibben.Scenario, targets: Any = None) -> tuple[Renderer, learning.Task]:
    task = learning.reach(scenario, targets)
    columns = mckibben.VectorPlant.columns_of(scenario)
    return Renderer(scenario, columns, list(task.targets)), task


@pytest.mark.parametrize("name", NAMES)
def test_gymnasiums_own_check_passes_with_pictures(name: str) -> None:
    with warnings.catch_warnings():
        warnings.filterwarnings("error")
        warnings.filterwarnings("ignore", message=".*infinity. This is probably too")
        check_env(made(name, max_episode_steps=5).unwrapped)


@pytest.mark.parametrize("name", NAMES)
def test_frames_follow_the_plant_and_do_not_move_it(name: str) -> None:
    drawn, plain = made(name, noise={}), gymnasium.make(f"mckibben/{name}-v0")
    observed, same = drawn.reset(seed=1)[0], plain.reset(seed=1)[0]
    frames = [drawn.render()]
    for _ in range(4):
        np.testing.assert_array_equal(observed, same)
        action = plain.action_space.sample()
        observed, same = drawn.step(action)[0], plain.step(action)[0]
        frames.append(drawn.render())
        np.testing.assert_array_equal(drawn.render(), frames[-1])
    for frame in frames:
        assert frame.shape == SHAPE and frame.dtype == np.uint8
    plants = [frame[:, PANEL:].tobytes() for frame in frames]
    assert len(set(plants)) == len(frames), "each step moves what is drawn"
    before = frames[0].copy()
    frames[-1][:] = 0
    assert (frames[0] == before).all() and (drawn.render() != 0).any(), "a frame is the caller's own"


def test_the_vector_form_has_a_frame_of_each_plant() -> None:
    many = gymnasium.make_vec("mckibben/Joint-v0", num_envs=3, render_mode="rgb_array")
    many.reset(seed=4)
    one = made("Joint")
    one.reset(seed=5)
    action = np.array([0.7, 0.2], dtype=np.float32)
    many.step(np.tile(action, (3, 1)))
    one.step(action)
    frames = many.render()
    assert isinstance(frames, tuple) and len(frames) == 3
    assert len({frame.tobytes() for frame in frames}) == 3, "targets differ"
    np.testing.assert_array_equal(frames[1], one.render())
    assert many.metadata["render_modes"] == ["rgb_array"] and many.metadata["render_fps"] == 25


def test_frames_are_collected_as_gymnasium_collects_them() -> None:
    one = gymnasium.make("mckibben/HangingMass-v0", render_mode="rgb_array_list", max_episode_steps=3)
    one.reset(seed=1)
    for _ in range(3):
        one.step(one.action_space.sample())
    frames = one.render()
    assert len(frames) == 4 and all(frame.shape == SHAPE for frame in frames)


def test_what_cannot_be_drawn_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    for form in (learning.Environment, learning.VectorEnvironment):
        with pytest.raises(mckibben.InputError, match='render_mode = "ansi"|render_mode = .ansi.: give "rgb_array" or None'):
            form(render_mode="ansi")
        with pytest.raises(ResetNeeded, match="before render"):
            form(render_mode="rgb_array").render()
        with pytest.warns(UserWarning, match='render_mode="rgb_array"'):
            assert form().render() is None
    monkeypatch.setitem(sys.modules, "mckibben.learning._render", None)
    with pytest.raises(DependencyNotInstalled, match="pip install"):
        learning.Environment(render_mode="rgb_array")


@pytest.mark.parametrize("name", ["Leg", "Arm"])
def test_segments_have_the_lengths_and_angles_of_the_scenario(name: str) -> None:
    scenario = learning.task(name).scenario
    longer = scenario.with_values({"mechanism.joints.shoulder.length" if name == "Arm" else "mechanism.joints.hip.length": 0.5})
    for plant, first in ((scenario, 0.28 if name == "Arm" else 0.22), (longer, 0.5)):
        chain = Chain(Plant(plant), "mechanism", mckibben.VectorPlant.columns_of(plant))
        lengths = [first, 0.24, 0.06] if name == "Arm" else [first, 0.22]
        angles = [0.3, -0.7, 0.2][: len(lengths)]
        _, bases, tips = chain.posture(dict(zip(chain.columns, angles, strict=True)))
        place = np.zeros(2)
        for base, tip, length, lean in zip(bases, tips, lengths, np.cumsum(angles), strict=True):
            np.testing.assert_allclose(base, place, atol=1e-15)
            place = place + length * np.array([np.sin(lean), np.cos(lean)])
            np.testing.assert_allclose(tip, place, rtol=1e-12)


def test_muscles_have_the_lengths_that_a_run_has() -> None:
    """By moment arms, by a table of them, over two joints, and between two points."""
    sections = example("plant/arm").to_dict()
    for muscle in sections["actuators"].values():
        muscle["coupling"]["rest_length"] = "86 mm"
    del sections["coupling"]
    points = {"origin": {"segment": "upper-arm", "along": "22 cm", "across": "2 cm"},
              "insertion": {"segment": "forearm", "along": "4 cm", "across": "1 cm"}}
    sections["actuators"]["triceps"]["coupling"] = points
    table = {"angle": ["-60 deg", "60 deg"], "arm": ["6 mm", "10 mm"]}
    sections["actuators"]["flexor"]["coupling"]["arms"] = {"wrist": table}
    sections["mechanism"]["joints"]["elbow"]["angle"] = "60 deg"
    scenario = mckibben.Scenario.from_dict(sections).with_values({"run.duration": "0.2 s"})
    run = mckibben.simulate(scenario)
    chain = Chain(Plant(scenario), "mechanism", mckibben.VectorPlant.columns_of(scenario))
    names = list(sections["actuators"])
    assert len(chain.cords) == len(names) == 6
    for row in (0, len(run["time_s"]) // 2, -1):
        values = {column: float(run[column][row]) for column in chain.columns}
        posture = chain.posture(values)
        for name, cord in zip(names, chain.cords, strict=True):
            assert cord.length(values, posture, chain.columns) == pytest.approx(run[f"{name}.length_m"][row], rel=1e-9), name


def test_a_muscle_is_as_long_and_as_red_as_it_is() -> None:
    """Counted in pixels of the frame: where the load begins, and the colour of the sleeve."""
    frames, (draw, _) = {}, renderer(learning.task("HangingMass").scenario)
    for length, pressure in ((0.07, 0.0), (0.09, 0.0), (0.09, 3e5)):
        observed = np.array([length, 0.0, ATMOSPHERE + pressure, 1e-6])
        frames[length, pressure] = draw.frame(observed, {"length_m": 0.08}, 0.0)
    scale = draw.canvases[0].scale / 2.0

    def top(frame: Any) -> int:
        """The row where the load begins, seen beside the muscle."""
        column = frame[:, (SIZE[0] + PANEL) // 2 + 45].astype(int)
        return int(np.flatnonzero((np.abs(column - [0xC3, 0xC9, 0xCF]).max(axis=1) < 3))[0])

    moved = top(frames[0.09, 0.0]) - top(frames[0.07, 0.0])
    assert moved == pytest.approx(0.02 * scale, abs=1.5) and moved > 50
    for pressure in (0.0, 3e5):
        sleeve = frames[0.09, pressure][40:160, (SIZE[0] + PANEL) // 2 - 20 : (SIZE[0] + PANEL) // 2 + 20].reshape(-1, 3)
        colours, counts = np.unique(sleeve, axis=0, return_counts=True)
        assert tuple(colours[counts.argmax()]) == shade(pressure / 689475.73)


def test_a_higher_pressure_is_darker() -> None:
    light = [np.dot(shade(share), [0.2126, 0.7152, 0.0722]) for share in np.linspace(0.0, 1.0, 21)]
    assert (np.diff(light) < 0.0).all()
    assert shade(-0.1) == shade(0.0) and shade(1.2) == shade(1.0)


@pytest.mark.parametrize(
    "file", ["plant/leg", "plant/arm", "antagonistic-joint", "plant/bottle", "plant/hose-joint", "moment-arm"]
)
def test_nothing_is_cut_off_at_the_stops(file: str) -> None:
    draw, task = renderer(example(file))
    columns = draw.columns
    values = {column: ATMOSPHERE + 1e5 if column.endswith("pressure_pa") else 0.0 for column in columns}
    ends = {
        column: (low - 0.125 * (high - low), high + 0.125 * (high - low)) for column, (low, high) in task.targets.items()
    }
    for corner in range(2 ** len(ends)):
        here = {column: pair[corner >> place & 1] for place, (column, pair) in enumerate(ends.items())}
        there = {column: pair[1 - (corner >> place & 1)] for place, (column, pair) in enumerate(ends.items())}
        frame = draw.frame(np.array([{**values, **here}[column] for column in columns]), there, 0.5)
        paper = np.array([int(PAPER[at : at + 2], 16) for at in (1, 3, 5)])
        for edge in (frame[:4], frame[-4:], frame[:, -4:], frame[:, :4], frame[:380, PANEL - 3 : PANEL + 3]):
            assert (edge == paper).all()
        # Nor at the edge of what is drawn large.
        fine = np.asarray(draw.fine)
        for edge in (fine[:3], fine[-3:], fine[:, :3], fine[:, -3:]):
            assert (edge == paper).all()


def test_directions_are_those_in_which_angles_grow() -> None:
    along, across = axes(0.0)
    np.testing.assert_array_equal(along, [0.0, 1.0])
    np.testing.assert_array_equal(across, [1.0, 0.0])
    ahead = (axes(0.4 + 1e-6)[0] - axes(0.4)[0]) / 1e-6
    np.testing.assert_allclose(ahead, axes(0.4)[1], atol=1e-6)


def test_the_documentation_shows_what_its_lines_draw(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (ROOT / "docs" / "python-learning.md").read_text()
    (lines,) = (block for block in re.findall(r"```python\n(.*?)```", text, re.DOTALL) if "python-learning.png" in block)
    monkeypatch.chdir(tmp_path)
    exec(compile(lines, "python-learning.md", "exec"), {})
    shown = ROOT / "docs" / "python-learning.png"
    assert shown.stat().st_size < 60_000
    drawn, kept = (np.asarray(Image.open(path).convert("RGB"), dtype=float) for path in (tmp_path / shown.name, shown))
    # Other versions of Pillow smooth otherwise.
    assert drawn.shape == kept.shape and np.abs(drawn - kept).mean() < 1.0
