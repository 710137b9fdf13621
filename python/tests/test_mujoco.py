"""Muscles in MuJoCo itself: the plugin's trajectory is the core's, its state is MuJoCo's, and mistakes name their remedy."""

import copy
import os
import pathlib
import subprocess
import sys
import time
import tomllib

import mujoco
import numpy
import pytest

import mckibben
import mckibben.mujoco

ROOT = pathlib.Path(__file__).resolve().parents[2]
MODELS = ROOT / "models"
GRAVITY = 9.80665
KEYS = {
    "supply.gauge_pressure": "100 psi",
    "valve.preset": "matrix-eight-channel",
    "initial.gauge_pressure": "40 psi",
    # Dry friction at rest is set-valued, and the owner of the load would have to hold it: without it the order is seen.
    "actuator.friction.coulomb_width": "0 in",
}
WORLD = """
<mujoco>
  <option timestep="{step}" gravity="0 0 -{gravity}"/>
  {muscle}
  <worldbody>
    <site name="anchor" pos="0 0 0.2"/>
    <body pos="0 0 0.11">
      <joint type="slide" axis="0 0 1"/>
      <geom type="sphere" size="0.02" mass="2"/>
      <site name="hook"/>
    </body>
  </worldbody>
</mujoco>"""


@pytest.fixture(autouse=True)
def loaded(monkeypatch):
    monkeypatch.chdir(ROOT)
    mckibben.mujoco.load()
    yield
    log()


def muscle(keys=KEYS, **options):
    options.setdefault("sensors", ("gauge_pressure", "tension", "contraction", "mass_flow"))
    return mckibben.mujoco.muscle_mjcf({"muscle": ["anchor", "hook"]}, keys=keys, **options)


def hanging(step=1e-3, keys=KEYS, **options):
    text = WORLD.format(step=step, gravity=GRAVITY, muscle=muscle(keys, **options))
    model = mujoco.MjModel.from_xml_string(text)
    return model, mujoco.MjData(model)


def scenario(**values):
    return mckibben.Scenario.from_dict(
        {
            "supply": {"gauge_pressure": "100 psi"},
            "valve": {"preset": "matrix-eight-channel"},
            "actuator": {"friction": {"coulomb_width": "0 in"}},
            "command": {"kind": "fill"},
            "load": {"kind": "hanging-mass", "mass": 2.0, "gravity": GRAVITY},
            "initial": {"length": 0.09, "gauge_pressure": "40 psi"},
            "run": {"duration": 0.05, "relative_tolerance": 1e-9},
        }
    ).with_values(values)


def run(model, data, duration, control):
    for _ in range(round(duration / model.opt.timestep)):
        data.ctrl[:] = control
        mujoco.mj_step(model, data)


def sensor(data, name):
    return float(data.sensor(name).data[0])


def test_a_hanging_mass_comes_to_where_the_event_located_engine_has_it():
    """To first order in the step, as MuJoCo's own integrator."""
    trajectory = mckibben.simulate(scenario())
    length, pressure = trajectory["length_m"][-1], trajectory["gauge_pressure_pa"][-1]
    errors = []
    for step in (5e-5, 2.5e-5, 1.25e-5):
        model, data = hanging(step, command_mode="request")
        run(model, data, 0.05, 1.0)
        mujoco.mj_forward(model, data)
        errors.append([0.2 - (0.11 + data.qpos[0]) - length, sensor(data, "muscle.gauge_pressure") - pressure])
    errors = numpy.abs(errors)
    orders = numpy.log2(errors[:-1, 0] / errors[1:, 0])
    assert errors[-1][0] < 2e-6 and errors[-1][1] < 1e-5 * pressure, errors
    assert numpy.abs(orders - 1.0).max() < 0.3, (orders, errors)


def test_the_arm_comes_to_where_the_core_has_it():
    """Six muscles on one network: MuJoCo's bodies and the plugin's air, against the core's chain."""
    # Dry friction holds the core's arm at rest, where MuJoCo's creeps; and before the elbow meets its stop, which is MuJoCo's own.
    frictionless = {"run.duration": 0.15, "actuator.friction.coulomb_width": 0.0}
    trajectory = mckibben.simulate(mckibben.Scenario.from_file("examples/plant/arm.toml").with_values(frictionless))
    text = (MODELS / "arm.xml").read_text()
    key = '<config key="actuator.friction.coulomb_width" value="0 in"/>'
    model = mujoco.MjModel.from_xml_string(text.replace('<config key="scenario"', key + '<config key="scenario"'))
    model.opt.timestep = 2e-4
    data = mujoco.MjData(model)
    data.qpos[1] = numpy.radians(20.0)
    names = [model.actuator(at).name for at in range(6)]
    fill, exhaust = names.index("deltoid"), names.index("latissimus")
    while data.time < 0.15 - 1e-9:
        data.ctrl[:] = 0.0
        data.ctrl[fill] = float(0.1 <= data.time + 1e-9 < 0.3)
        data.ctrl[exhaust] = -float(0.1 <= data.time + 1e-9 < 0.14)
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    angles = [trajectory[f"{joint}.angle_rad"][-1] for joint in ("shoulder", "elbow", "wrist")]
    assert angles[0] > 0.1 and angles[1] < 0.02, "it has moved"
    assert numpy.abs(data.qpos - angles).max() < 3e-4, (data.qpos, angles)
    assert sensor(data, "manifold.gauge_pressure") == pytest.approx(trajectory["manifold.gauge_pressure_pa"][-1], rel=1e-3)
    assert sensor(data, "tank.gauge_pressure") == pytest.approx(trajectory["tank.gauge_pressure_pa"][-1], rel=1e-3)


def test_the_force_is_the_tension_of_the_law_with_its_sign():
    model, data = hanging()
    mujoco.mj_forward(model, data)
    statics = mckibben.Statics(scenario())
    force = float(statics.force(length=0.09, gauge_pressure=40 * 6894.757293168361))
    assert data.actuator_force[0] == pytest.approx(-force, rel=1e-9)
    assert sensor(data, "muscle.tension") == pytest.approx(force, rel=1e-9)
    assert sensor(data, "muscle.contraction") == pytest.approx((3.85 * 0.0254 - 0.09) / (3.85 * 0.0254), rel=1e-9)


def test_the_length_convention_is_tendon_plus_offset():
    """A muscle with 30 mm of fittings in a tendon of 120 mm is a muscle of 90 mm."""
    text = WORLD.replace("0 0 0.2", "0 0 0.23").format(
        step=1e-3, gravity=GRAVITY, muscle=muscle(length_offset="-30 mm")
    )
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    plain_model, plain = hanging()
    mujoco.mj_forward(plain_model, plain)
    assert data.actuator_length[0] == pytest.approx(0.12, rel=1e-12)
    assert data.actuator_force[0] == pytest.approx(plain.actuator_force[0], rel=1e-9)


def test_duty_cycles_are_pulsed_inside_with_true_delays():
    """The mean pressure of a muscle held at its length rises with the duty cycle; below the dead zone the valve never opens."""
    pressures = []
    for duty in (0.05, 0.3, 0.6, 0.9):
        model, data = hanging(pulse_frequency="25 Hz", max_step="0.5 ms")
        model.opt.gravity[:] = 0.0
        model.dof_damping[:] = 1e6
        run(model, data, 0.4, duty)
        pressures.append(sensor(data, "muscle.gauge_pressure"))
    assert abs(pressures[0]) < 2e3 and numpy.all(numpy.diff(pressures) > 2e4), pressures


def test_states_are_saved_restored_and_copied():
    model, data = hanging(pulse_frequency="25 Hz")
    run(model, data, 0.1, 0.6)
    spec = mujoco.mjtState.mjSTATE_INTEGRATION
    state = numpy.zeros(mujoco.mj_stateSize(model, spec))
    mujoco.mj_getState(model, data, state, spec)
    copied = copy.copy(data)
    other = mujoco.MjData(model)
    mujoco.mj_setState(model, other, state, spec)
    for of in (data, copied, other):
        run(model, of, 0.1, 0.3)
    assert numpy.array_equal(data.plugin_state, other.plugin_state)
    assert numpy.array_equal(data.plugin_state, copied.plugin_state)
    assert numpy.array_equal(data.qpos, other.qpos) and numpy.array_equal(data.qpos, copied.qpos)
    mujoco.mj_resetData(model, data)
    fresh = mujoco.MjData(model)
    for of in (data, fresh):
        run(model, of, 0.1, 0.6)
    assert numpy.array_equal(data.qpos, fresh.qpos)


def test_a_keyframe_sets_pressures():
    model = mujoco.MjModel.from_xml_path(str(MODELS / "arm.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("bent").id)
    data.act[:] = 2e5
    mujoco.mj_forward(model, data)
    assert sensor(data, "biceps.gauge_pressure") == pytest.approx(2e5, rel=1e-9)
    mujoco.mj_step(model, data)
    assert data.act == pytest.approx(numpy.full(6, 2e5), rel=0.05)
    # Under way too: what is set is the pressure from then on.
    data.act[2] = 3e5
    mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    assert data.act[2] == pytest.approx(3e5, rel=0.02)
    assert sensor(data, "biceps.gauge_pressure") == pytest.approx(data.act[2], rel=1e-9)


def test_what_finite_differences_of_mujoco_see():
    """Pressures in `act`, positions and velocities; not the edges of pulses, nor the modes of friction."""
    model, data = hanging(step=1e-4, pulse_frequency="25 Hz")
    run(model, data, 0.0205, 0.6)
    assert model.na == 1
    state = numpy.zeros((3, 3))
    control = numpy.zeros((3, 1))
    mujoco.mjd_transitionFD(model, data, 1e-6, True, state, control, None, None)
    # Velocity by pressure: a tension of per_pressure more each Pa pulls the mass upwards.
    plant = mckibben.HostedPlant(scenario(), command_mode="request")
    length = numpy.array([[0.2 - 0.11 - data.qpos[0]]])
    tensions = []
    for gauge in (data.act[0], data.act[0] + 100.0):
        statics = mckibben.Statics(scenario())
        tensions.append(float(statics.force(length=length[0, 0], gauge_pressure=gauge)))
    per_pressure = (tensions[1] - tensions[0]) / 100.0
    assert plant.count == 1
    assert state[1, 2] == pytest.approx(1e-4 * per_pressure / 2.0, rel=1e-2)
    assert 0.9 < state[2, 2] < 1.0, "a pressure lasts, but for what flows through the valve"
    # A duty cycle is taken up when the next period begins: within a step nothing depends on it.
    assert numpy.abs(control).max() == 0.0


@pytest.mark.parametrize(("step", "limit"), [(1e-3, None), (2e-3, None), (5e-3, None), (1e-2, 0.097)])
def test_it_is_stable_at_long_steps(step, limit):
    """Up to 5 ms whatever happens; at 10 ms where MuJoCo keeps the tendon from pulling the braid taut. The first jump is 3.9 cm high, and
    by these long steps up to 10.5 cm."""
    model, data = hanging(step, pulse_frequency="25 Hz", max_length=limit)
    heights = []
    for count in range(round(4.0 / step)):
        data.ctrl[:] = 0.5 if count * step < 2.0 else 0.1
        mujoco.mj_step(model, data)
        heights.append(float(data.qpos[0]))
    heights = numpy.array(heights)
    highest = 0.11 if step > 5e-3 else 0.04
    assert numpy.isfinite(heights).all() and -0.02 < heights.min() and heights.max() < highest, (heights.min(), heights.max())
    # With its air gone the mass hangs on the taut braid, or on MuJoCo's limit.
    assert heights[-1] == pytest.approx(0.09 - (limit or 0.0979), abs=2e-3)


def test_threaded_rollouts_are_those_of_one_thread():
    from mujoco import rollout

    model, data = hanging(pulse_frequency="25 Hz")
    spec = mujoco.mjtState.mjSTATE_FULLPHYSICS
    initial = numpy.zeros((8, mujoco.mj_stateSize(model, spec)))
    mujoco.mj_getState(model, data, initial[0], spec)
    initial[1:] = initial[0]
    controls = numpy.random.default_rng(1).uniform(0.0, 1.0, (8, 200, 1))
    single, _ = rollout.rollout(model, data, initial, controls)
    several, _ = rollout.rollout(model, [mujoco.MjData(model) for _ in range(4)], initial, controls)
    assert numpy.array_equal(single, several)
    assert len({float(last) for last in single[:, -1, 1]}) == 8, "each has its own controls"


def test_the_driver_is_the_plugin():
    """Both are first-order in the step, by the same tensions; they differ by how the end of a step is foreseen."""
    model, data = hanging(step=1e-4, command_mode="request")
    run(model, data, 0.05, 1.0)
    motor = """
    <tendon><spatial name="muscle"><site site="anchor"/><site site="hook"/></spatial></tendon>
    <actuator><motor name="muscle" tendon="muscle"/></actuator>"""
    model = mujoco.MjModel.from_xml_string(WORLD.format(step=1e-4, gravity=GRAVITY, muscle=motor))
    driver = mckibben.mujoco.Driver(model, scenario(), command_mode="request", worlds=3)
    worlds = driver.start()
    for _ in range(500):
        driver.step(worlds, [[1.0], [1.0], [-1.0]])
    assert worlds[0].qpos[0] == worlds[1].qpos[0] != worlds[2].qpos[0]
    assert worlds[0].qpos[0] == pytest.approx(data.qpos[0], abs=1e-7)
    with pytest.raises(mckibben.InputError, match="no motor"):
        mckibben.mujoco.Driver(model, mckibben.Scenario.from_file("examples/plant/arm.toml"))


@pytest.mark.parametrize("name", ["hanging-mass", "elbow", "arm", "leg"])
def test_models_run(name):
    model = mujoco.MjModel.from_xml_path(str(MODELS / f"{name}.xml"))
    data = mujoco.MjData(model)
    generator, pulls = numpy.random.default_rng(3), 0.0
    for count in range(500):
        if count % 50 == 0:
            data.ctrl[:] = numpy.round(generator.uniform(0.0, 1.0, model.nu), 1 if name in ("hanging-mass", "leg") else 0)
        mujoco.mj_step(model, data)
        pulls = max(pulls, float(numpy.abs(data.actuator_force).max()))
    assert numpy.isfinite(data.qpos).all() and data.time == pytest.approx(0.5)
    assert pulls > 1.0
    assert not any(warning.number for warning in data.warning)


def test_the_elbow_bends_when_the_biceps_is_filled():
    model = mujoco.MjModel.from_xml_path(str(MODELS / "elbow.xml"))
    data = mujoco.MjData(model)
    run(model, data, 0.5, [1.0, -1.0])
    bent = float(data.joint("elbow").qpos[0])
    run(model, data, 0.7, [-1.0, 1.0])
    assert bent > numpy.radians(40.0) > numpy.radians(15.0) > float(data.joint("elbow").qpos[0]), bent


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"keys": KEYS | {"actuator.preset": "colbrunn-2001", "actuator.turns": "-2"}}, "actuator.turns"),
        ({"keys": KEYS | {"actuator.preset": "colbrunn-2001", "actuator.thread_length": "4.3 kg"}}, "is a mass"),
        ({"command_mode": "position"}, "command_mode"),
        ({"length_offset": "3 kg"}, "unit of m"),
        ({"sensors": ["warmth"]}, "name it after one of"),
        ({"sensors": ["tensio"]}, "name it after one of muscle.tension"),
        ({"length_offset": "muscel = -1 mm"}, "name muscle"),
        ({"length_offset": "actuator = -1 mm, actuator = -9 mm"}, "names `actuator` twice"),
        ({"keys": KEYS | {"coupling.rest_length": "90 mm"}}, "in <tendon>"),
        ({"scenario": "nowhere.toml", "keys": {}}, "nowhere.toml"),
        ({"scenario": "examples/plant/arm.toml", "keys": {}}, "name it deltoid"),
    ],
)
def test_mistakes_name_what_to_do(options, words, capfd):
    with pytest.raises((ValueError, mujoco.FatalError)) as caught:
        hanging(**options)
    assert words in str(caught.value) + "".join(capfd.readouterr()) + log(), str(caught.value)


def log():
    path = ROOT / "MUJOCO_LOG.TXT"
    text = path.read_text() if path.exists() else ""
    path.unlink(missing_ok=True)
    return text


def test_a_muscle_that_cannot_be_so_long_stops_with_one_warning():
    text = WORLD.replace("0 0 0.2", "0 0 0.5").format(step=1e-3, gravity=GRAVITY, muscle=muscle())
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    run(model, data, 0.01, 0.0)
    printed = log()
    assert data.actuator_force[0] == 0.0 and numpy.isfinite(data.qpos).all()
    assert printed.count("mckibben.muscle") == 1, printed


def test_sensors_of_a_muscle_that_has_stopped_show_no_tension():
    model, data = hanging(command_mode="request")
    run(model, data, 0.02, 1.0)
    mujoco.mj_forward(model, data)
    pressure = sensor(data, "muscle.gauge_pressure")
    assert sensor(data, "muscle.tension") > 1.0
    data.qpos[0] = -0.03
    run(model, data, 0.005, 1.0)
    mujoco.mj_forward(model, data)
    assert data.actuator_force[0] == 0.0 == sensor(data, "muscle.tension")
    assert sensor(data, "muscle.gauge_pressure") == pytest.approx(pressure, rel=0.1), "the last value"


def test_a_sensor_reads_the_part_that_it_names(capfd):
    keys = KEYS | {"supply.reservoir_volume": "50 mL"}
    text = WORLD.format(step=1e-3, gravity=GRAVITY, muscle=muscle(keys, command_mode="request"))
    model = mujoco.MjModel.from_xml_string(text.replace("muscle.mass_flow", "supply.gauge_pressure"))
    data = mujoco.MjData(model)
    run(model, data, 0.05, -1.0)
    mujoco.mj_forward(model, data)
    assert sensor(data, "supply.gauge_pressure") == pytest.approx(100 * 6894.757293168361, rel=1e-6)
    assert sensor(data, "muscle.gauge_pressure") < 3e5
    with pytest.raises((ValueError, mujoco.FatalError)) as caught:
        mujoco.MjData(mujoco.MjModel.from_xml_string(text.replace("muscle.mass_flow", "tank.gauge_pressure")))
    said = str(caught.value) + "".join(capfd.readouterr()) + log()
    assert "supply.gauge_pressure" in said, said


@pytest.mark.parametrize("dyntype", ["integrator", "filter"])
def test_an_activation_that_mujoco_changes_is_refused(dyntype, capfd):
    text = WORLD.format(step=1e-3, gravity=GRAVITY, muscle=muscle()).replace('actdim="1"', f'dyntype="{dyntype}"')
    with pytest.raises((ValueError, mujoco.FatalError)) as caught:
        mujoco.MjData(mujoco.MjModel.from_xml_string(text))
    said = str(caught.value) + "".join(capfd.readouterr()) + log()
    assert "leave dyntype out" in said, said


RK4 = int(mujoco.mjtIntegrator.mjINT_RK4)


def refused(text, capfd):
    """What a model is refused for."""
    with pytest.raises((ValueError, mujoco.FatalError)) as caught:
        mujoco.MjData(mujoco.MjModel.from_xml_string(text))
    return str(caught.value) + "".join(capfd.readouterr()) + log()


def test_an_integrator_of_several_forces_in_a_step_is_refused(capfd):
    text = WORLD.format(step=1e-3, gravity=GRAVITY, muscle=muscle())
    said = refused(text.replace("<option", '<option integrator="RK4"'), capfd)
    assert "RK4" in said and "implicitfast" in said, said
    model, data = hanging(command_mode="request")
    run(model, data, 0.01, 1.0)
    model.opt.integrator = RK4
    run(model, data, 0.003, 1.0)
    printed = log()
    assert data.actuator_force[0] == 0.0 and printed.count("RK4") == 1, printed
    model = with_motor()
    driver = mckibben.mujoco.Driver(model, scenario(), command_mode="request")
    data = driver.start()
    driver.step(data, 1.0)
    model.opt.integrator = RK4
    for use in (
        lambda: driver.step(data, 1.0),
        lambda: mckibben.mujoco.Driver(model, scenario(), command_mode="request"),
    ):
        with pytest.raises(mckibben.InputError, match="RK4.*implicitfast"):
            use()
    assert data.time == driver.plant.time == 1e-3, "nothing has moved"


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('actdim="1"', 'actdim="1" gear="2"', 'gear="2"'),
        ('actdim="1"', 'actdim="1" delay="0.02" nsample="20"', "valve.dead_time"),
        ("<spatial", '<spatial actuatorfrcrange="-10 10"', "tendon with an actuatorfrcrange"),
        ('tendon="muscle"', 'joint="slide"', "joint with an actuatorfrcrange"),
        ('tendon="muscle"', 'tendon="fixed"', "joint with an actuatorfrcrange"),
    ],
)
def test_what_would_stand_between_a_muscle_and_mujoco_is_refused(old, new, words, capfd):
    if "delay" in new and not hasattr(mujoco.MjModel, "actuator_delay"):
        pytest.skip("this version has no delays")
    if "spatial" in new and not hasattr(mujoco.MjModel, "tendon_actfrclimited"):
        pytest.skip("this version has no ranges of forces of tendons")
    text = WORLD.format(step=1e-3, gravity=GRAVITY, muscle=muscle(sensors=[]))
    if "joint" in words:
        text = text.replace('<joint type="slide"', '<joint name="slide" type="slide" actuatorfrcrange="-5 5"')
        fixed = '<fixed name="fixed"><joint joint="slide" coef="-1"/></fixed></tendon>'
        text = text.replace("</tendon>", fixed)
    assert text.count(old) == 1, text
    said = refused(text.replace(old, new), capfd)
    assert words in said and "leave" in said, said


#: A free joint and a ball joint beside the muscle's body.
OTHERS = """<body pos="1 0 0"><freejoint name="free"/><geom type="sphere" size="0.02"/></body>
<body pos="2 0 0"><joint name="ball" type="ball"/><geom type="sphere" size="0.02"/></body></worldbody>"""


def acting_on(target, **options):
    """A model whose muscle acts on something else than its tendon."""
    text = WORLD.format(step=1e-3, gravity=GRAVITY, muscle=muscle(sensors=[], length_offset="90 mm", **options))
    text = text.replace('<joint type="slide"', '<joint name="slide" type="slide"').replace("</worldbody>", OTHERS)
    assert text.count('tendon="muscle"') == 1, text
    return text.replace('tendon="muscle"', target)


@pytest.mark.parametrize(
    ("target", "words"),
    [
        ('site="hook"', "site or body"),
        ('site="hook" gear="0 0 1 0 0 0"', "site or body"),
        ('joint="free"', "free or a ball"),
        ('joint="ball"', "free or a ball"),
        ('jointinparent="ball" gear="0 0 1 0 0 0"', "free or a ball"),
    ],
)
def test_what_has_no_distance_is_refused(target, words, capfd):
    """MuJoCo's length is zero there, or a rotation: the muscle pulled without becoming shorter."""
    said = refused(acting_on(target), capfd)
    assert words in said and "<spatial> tendon" in said, said


@pytest.mark.parametrize("target", ['joint="slide"', 'jointinparent="slide"'])
def test_the_position_of_a_slide_is_a_length(target):
    model = mujoco.MjModel.from_xml_string(acting_on(target, command_mode="request"))
    data = mujoco.MjData(model)
    run(model, data, 0.02, 1.0)
    assert data.actuator_length[0] == pytest.approx(data.qpos[0], abs=1e-3) and data.qpos[0] < -1e-3


def of_file(path):
    return WORLD.format(step=1e-3, gravity=GRAVITY, muscle=muscle({}, scenario=path, command_mode="request"))


def test_a_file_that_has_other_parts_by_now_is_refused(tmp_path, capfd):
    """The file is read for each data; a state of more numbers than the model has for it would lie on what is beside it."""
    path = tmp_path / "muscle.toml"
    path.write_text(scenario().to_toml())
    model = mujoco.MjModel.from_xml_string(of_file(path))
    data = mujoco.MjData(model)
    for other in ({"valve.dead_time": "5 ms"}, {"supply.reservoir_volume": "1 L"}):
        path.write_text(scenario(**other).to_toml())
        with pytest.raises((ValueError, mujoco.FatalError)):
            mujoco.MjData(model)
        said = "".join(capfd.readouterr()) + log()
        assert "compile the model again" in said and "scenario_text" in said, said
        mujoco.MjData(mujoco.MjModel.from_xml_string(of_file(path)))
    # A number is that of the file as it is now, and data that there are keep theirs.
    path.write_text(scenario(**{"supply.gauge_pressure": "50 psi"}).to_toml())
    later = mujoco.MjData(model)
    for its in (data, later):
        run(model, its, 0.2, 1.0)
    assert data.act[0] > 600e3 > 350e3 > later.act[0]


def test_keys_act_on_a_scenario_as_on_its_file(tmp_path):
    """A preset among the keys did not outweigh the values of the preset of the file, which were written into the model."""
    text = """
[actuator]
preset = "colbrunn-2001"
[supply]
gauge_pressure = "100 psi"
[valve]
preset = "matrix-eight-channel"
[command]
kind = "fill"
[load]
kind = "isometric"
[initial]
length = "90 mm"
[run]
duration = "1 s"
"""
    path = tmp_path / "muscle.toml"
    path.write_text(text)
    of_dictionary = mckibben.Scenario.from_dict(tomllib.loads(text))
    ends = []
    for keys in ({}, {"valve.preset": "matrix-821"}, {"actuator.preset": "festo-dmsp-10-250"}, {"valve.opening_delay": 0.009}):
        each = []
        for its in (path, mckibben.Scenario.from_file(path), of_dictionary):
            model, data = hanging(keys=keys, scenario=its, command_mode="request")
            run(model, data, 0.02, 1.0)
            each.append((*data.qpos, *data.act))
        assert each[0] == each[1] == each[2], keys
        ends.append(each[0])
    assert len(set(ends)) == len(ends), ends


def test_a_muscle_that_mujoco_disables_exerts_no_force():
    """By its group at run time or by the flag, while its air goes on; MuJoCo's own actuators do so too."""
    model, data = hanging(command_mode="request")
    run(model, data, 0.02, 1.0)
    mujoco.mj_forward(model, data)
    pressure, pull = sensor(data, "muscle.gauge_pressure"), sensor(data, "muscle.tension")
    assert pull > 1.0
    for field, value in (("disableactuator", 1), ("disableflags", int(mujoco.mjtDisableBit.mjDSBL_ACTUATION))):
        setattr(model.opt, field, value)
        mujoco.mj_forward(model, data)
        assert not data.qfrc_actuator.any() and sensor(data, "muscle.tension") == 0.0, field
        setattr(model.opt, field, 0)
    mujoco.mj_forward(model, data)
    assert sensor(data, "muscle.tension") == pull
    model.opt.disableactuator = 1
    run(model, data, 0.005, 1.0)
    assert data.act[0] > pressure


def test_a_released_five_way_valve_does_what_it_holds():
    """The default control: the outputs of the one kind are supplied at rest, those of the other exhausted."""
    gauge = 3e5
    for kind, sign in (("five-way-pressurised", 1.0), ("five-way-exhausted", -1.0), ("five-way-closed", 0.0)):
        keys = {"supply.gauge_pressure": "6 bar", "valve.kind": kind, "valve.flow_area": "0.3 mm^2",
                "initial.gauge_pressure": "3 bar"}
        model, data = hanging(keys=keys)
        model.dof_damping[:] = 1e6
        run(model, data, 0.02, 0.0)
        assert numpy.sign(numpy.round((data.act[0] - gauge) / 1e3)) == sign, (kind, data.act)


def test_the_default_control_stops_no_muscle():
    """A three-way valve has no hold and a two-way valve no exhaust: the nearest request that they have is taken."""
    model, data = hanging()
    run(model, data, 0.01, 0.0)
    run(model, data, 0.2, 1.0)
    mujoco.mj_forward(model, data)
    assert sensor(data, "muscle.gauge_pressure") > 4e5 and not log(), "filled"
    two_way = KEYS | {"valve.kind": "two-way", "valve.flow_area": "2 mm^2"}
    two_way.pop("valve.preset")
    model, data = hanging(keys=two_way)
    run(model, data, 0.01, -1.0)
    mujoco.mj_forward(model, data)
    assert sensor(data, "muscle.gauge_pressure") > 2e5, "held"
    run(model, data, 0.2, 1.0)
    mujoco.mj_forward(model, data)
    assert sensor(data, "muscle.gauge_pressure") > 4e5 and not log(), "filled"


def test_a_set_point_ends_at_the_supply():
    keys = KEYS | {
        "valve.kind": "pressure-regulator",
        "valve.flow_area": "2 mm^2",
        "valve.time_constant": "20 ms",
        "valve.rate_limit": "50 bar/s",
    }
    keys.pop("valve.preset")
    pressures = []
    for control in (30e5, 100 * 6894.757293168361):
        model, data = hanging(keys=keys)
        run(model, data, 0.5, control)
        mujoco.mj_forward(model, data)
        pressures.append(sensor(data, "muscle.gauge_pressure"))
    assert pressures[0] == pytest.approx(pressures[1], rel=1e-9)
    assert pressures[0] < 1.2 * 100 * 6894.757293168361


def test_an_unknown_attribute_is_refused_by_mujoco():
    with pytest.raises(ValueError, match="actuator.thred_length"):
        hanging(keys=KEYS | {"actuator.thred_length": "4 in"})


def test_mujoco_itself_loads_the_plugin():
    """By the entry point, since 4.0.0; an older version takes a call."""
    load = "" if mujoco.mj_version() >= 4_000_000 else "import mckibben.mujoco; mckibben.mujoco.load()\n"
    code = f"import mujoco\n{load}print(mujoco.MjModel.from_xml_path('models/elbow.xml').nplugin)"
    done = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert done.stdout.strip() == "1", done.stderr


@pytest.mark.parametrize("with_package", [False, True])
def test_the_library_registers_itself_where_mujoco_loads_it(with_package):
    """Without the package, as in C; and with it, where the plugin is there already."""
    library = os.environ.get("MCKIBBEN_MUJOCO", str(ROOT / "target/debug/libmckibben_mujoco.so"))
    paths = [str(pathlib.Path(mujoco.__file__).parents[1]), str(pathlib.Path(numpy.__file__).parents[1])]
    code = f"""
import importlib.metadata, sys
sys.path[:0] = {paths!r}
if not {with_package}:
    importlib.metadata.entry_points = lambda **_: []
import mujoco
assert ("mckibben" in sys.modules) == ({with_package} and mujoco.mj_version() >= 4_000_000)
mujoco.mj_loadPluginLibrary({library!r})
model = mujoco.MjModel.from_xml_path("models/elbow.xml")
data = mujoco.MjData(model)
data.ctrl[0] = 1.0
mujoco.mj_step(model, data, 300)
print(data.qpos[0] > 0.2)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    assert done.stdout.strip() == "True", done.stderr


def test_the_version_is_one_of_those_that_are_known():
    assert mujoco.mj_versionString() in {"3.2.7", "4.0.0"}, "what is tested is what the documentation says"


def test_backends_without_plugins_refuse():
    class Backend:
        @staticmethod
        def put_model(model):
            return model

    mckibben.mujoco._refuse_muscles(Backend, "mujoco.mjx")
    model, _ = hanging()
    with pytest.raises(mckibben.InputError, match="takes no plugins"):
        Backend.put_model(model)
    plain = mujoco.MjModel.from_xml_string("<mujoco/>")
    assert Backend.put_model(plain) is plain


def test_what_the_plugin_does_not_take_says_so():
    with pytest.raises(mckibben.InputError, match="two sites"):
        mckibben.mujoco.muscle_mjcf({"muscle": ["anchor"]})
    with pytest.raises(mckibben.InputError, match="two sites"):
        mckibben.mujoco.muscle_mjcf({"muscle": "anchor"})


def test_nothing_that_is_written_into_the_data_breaks_it():
    """Random numbers in controls, activations, states, positions and the time step: no crash, no force that is not a number.

    For longer: MCKIBBEN_FUZZ_SECONDS=600 pytest python/tests/test_mujoco.py -k breaks
    """
    generator = numpy.random.default_rng(11)
    odd = [0.0, -0.0, 1.0, -1.0, numpy.nan, numpy.inf, -numpy.inf, 1e300, -1e300, 5e-324, 2e5, 64.0]
    ends = time.monotonic() + float(os.environ.get("MCKIBBEN_FUZZ_SECONDS", "2"))
    models = [mujoco.MjModel.from_xml_path(str(MODELS / f"{name}.xml")) for name in ("hanging-mass", "elbow", "arm")]
    rounds = 0
    while time.monotonic() < ends:
        model = models[rounds % len(models)]
        data = mujoco.MjData(model)
        model.opt.timestep = float(generator.choice([1e-3, 1e-2, 1e-6, 0.1]))
        for _ in range(20):
            target = [data.ctrl, data.act, data.plugin_state, data.qpos, data.qvel][generator.integers(5)]
            if target.size and generator.random() < 0.5:
                target[generator.integers(target.size)] = generator.choice(odd)
            try:
                mujoco.mj_step(model, data)
            except mujoco.FatalError:
                break
            assert numpy.isfinite(data.actuator_force).all()
        rounds += 1
    for model in models:
        model.opt.timestep = 1e-3
    assert rounds > 3


def test_nothing_that_is_written_into_attributes_breaks_it():
    generator = numpy.random.default_rng(12)
    values = ["", " ", "nan", "inf psi", "-1e308 m", "[[[", '"', "100 psi", "\u03c8", "1e400", "true", "0", "x" * 5000]
    names = ["supply.gauge_pressure", "valve.preset", "length_offset", "max_step", "pulse_frequency", "command_mode"]
    names += ["scenario_text", "scenario", "actuator.preset", "valve.opening_delay", "initial.length", "air.process"]
    for _ in range(150):
        keys = {str(generator.choice(names)): str(generator.choice(values)) for _ in range(3)}
        try:
            hanging(keys=keys, sensors=[])
        except (ValueError, mujoco.FatalError) as refused:
            assert str(refused)


MOTOR = '<motor name="muscle" tendon="muscle"/>'
REGULATOR = {
    "supply.gauge_pressure": "6 bar",
    "valve.kind": "pressure-regulator",
    "valve.flow_area": "1 mm^2",
    "valve.time_constant": "20 ms",
    "valve.rate_limit": "20 bar/s",
}


def with_motor(motor=MOTOR, joint="", tendon="", step=1e-3):
    """The hanging mass with a motor; another joint has a range of forces that does not matter."""
    sections = f"""
    <tendon><spatial name="muscle" {tendon}><site site="anchor"/><site site="hook"/></spatial></tendon>
    <actuator>{motor}</actuator>"""
    text = WORLD.format(step=step, gravity=GRAVITY, muscle=sections)
    text = text.replace('<joint type="slide"', f'<joint name="slide" type="slide" {joint}')
    other = '<body pos="1 0 0"><joint name="hinge" actuatorfrcrange="-1 1"/><geom size="0.1"/></body></worldbody>'
    return mujoco.MjModel.from_xml_string(text.replace("</worldbody>", other))


@pytest.mark.parametrize(
    ("model", "words"),
    [
        ({"motor": MOTOR.replace("/>", ' gear="2"/>')}, 'gear="2".*write gear="1"'),
        ({"motor": MOTOR.replace("/>", ' ctrlrange="-1 1"/>')}, 'ctrlrange="-1 1".*leave ctrlrange out'),
        ({"motor": MOTOR.replace("/>", ' forcerange="-5 5"/>')}, 'forcerange="-5 5".*leave forcerange out'),
        ({"motor": MOTOR.replace("motor", "position")}, "biastype.*write <motor"),
        ({"motor": MOTOR.replace("motor", "velocity")}, "biastype.*write <motor"),
        ({"motor": MOTOR.replace("motor", "general").replace("/>", ' gainprm="2"/>')}, "gainprm"),
        ({"motor": MOTOR.replace("motor", "general").replace("/>", ' dyntype="filter" dynprm="0.1"/>')}, "dyntype"),
        ({"motor": '<motor name="muscle" site="hook"/>'}, "on no tendon or joint"),
        ({"motor": '<motor name="muscle" joint="hinge"/>'}, "joint `hinge`.*actuatorfrcrange"),
        ({"joint": 'actuatorfrcrange="-5 5"'}, 'joint `slide`.*actuatorfrcrange="-5 5"'),
    ],
)
def test_a_driver_refuses_what_would_change_the_tension(model, words):
    with pytest.raises(mckibben.InputError, match="motor `muscle`.*" + words):
        mckibben.mujoco.Driver(with_motor(**model), scenario(), command_mode="request")


@pytest.mark.skipif(not hasattr(mujoco.MjModel, "tendon_actfrclimited"), reason="tendons have no ranges of forces in 3.2.7")
def test_a_driver_refuses_a_tendon_that_clips_the_tension():
    with pytest.raises(mckibben.InputError, match='tendon `muscle`.*actuatorfrcrange="-5 5"'):
        mckibben.mujoco.Driver(with_motor(tendon='actuatorfrcrange="-5 5"'), scenario(), command_mode="request")


def test_a_driver_refuses_the_muscles_of_the_plugin():
    model, _ = hanging()
    with pytest.raises(mckibben.InputError, match="motor `muscle` belongs to a plugin"):
        mckibben.mujoco.Driver(model, scenario(), command_mode="request")


def test_motors_that_the_model_disables_are_refused():
    model = with_motor()
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_ACTUATION)
    with pytest.raises(mckibben.InputError, match='flag actuation="disable"'):
        mckibben.mujoco.Driver(model, scenario(), command_mode="request")
    model = with_motor()
    model.opt.disableactuator = 1
    with pytest.raises(mckibben.InputError, match="is of group 0, which the model disables"):
        mckibben.mujoco.Driver(model, scenario(), command_mode="request")


def test_a_motor_on_a_joint_is_one_on_a_tendon():
    """The tendon is as long as the joint is low; the joint of another body may have a range of forces."""
    ends = []
    for motor, offset in ((MOTOR, 0.0), ('<motor name="muscle" joint="slide"/>', 0.09)):
        model = with_motor(motor)
        if motor is not MOTOR:
            # Downwards, as the tendon lengthens.
            model.jnt_axis[0] = [0.0, 0.0, -1.0]
        driver = mckibben.mujoco.Driver(model, scenario(), command_mode="request", length_offset=offset)
        data = driver.start()
        for _ in range(100):
            driver.step(data, 1.0)
        ends.append(abs(float(data.qpos[0])))
    assert ends[0] > 1e-3 and ends[1] == pytest.approx(ends[0], rel=1e-9)


def test_one_world_begins_again_while_the_others_continue():
    model = with_motor()
    driver, plain, fresh = (mckibben.mujoco.Driver(model, scenario(), worlds=count, command_mode="request") for count in (3, 3, 1))
    worlds, others, late = driver.start(), plain.start(), fresh.start()
    for _ in range(50):
        driver.step(worlds, [[1.0], [-1.0], [1.0]])
        plain.step(others, [[1.0], [-1.0], [1.0]])
    mujoco.mj_resetData(model, worlds[1])
    driver.restart(worlds, [1])
    for _ in range(50):
        driver.step(worlds, 1.0)
        plain.step(others, 1.0)
        fresh.step(late, 1.0)
    assert [float(worlds[at].qpos[0]) for at in (0, 2)] == [float(others[at].qpos[0]) for at in (0, 2)]
    assert worlds[1].time == pytest.approx(0.05) and driver.plant.time == pytest.approx(0.1)
    assert late.qpos[0] > 1e-3 and worlds[1].qpos[0] == pytest.approx(late.qpos[0], rel=1e-6)
    # All together.
    mujoco.mj_resetData(model, late)
    fresh.restart(late)
    assert fresh.plant.time == 0.0 and fresh.plant.distances[0, 0] == pytest.approx(0.09)


@pytest.mark.parametrize(
    ("rows", "words"),
    [([2], r"rows\[0\] = 2 .*from 0 to 1"), ([0, 0], r"rows\[1\] = 0"), ([True], r"rows\[0\] = True"), ([0.5], r"rows\[0\] = 0.5")],
)
def test_worlds_that_are_not_there_cannot_begin_again(rows, words):
    driver = mckibben.mujoco.Driver(with_motor(), scenario(), worlds=2, command_mode="request")
    worlds = driver.start()
    with pytest.raises(mckibben.InputError, match=words):
        driver.restart(worlds, rows)


def test_arguments_of_a_driver_are_named():
    model = with_motor()

    def made(**options):
        return mckibben.mujoco.Driver(model, scenario(), command_mode="request", **options)

    for options, words in (
        ({"length_offset": [0.0, 0.0]}, r"length_offset = \[0.0, 0.0\] is of shape \(2,\)"),
        ({"length_offset": "-5 mm"}, "length_offset = '-5 mm' is no number"),
        ({"length_offset": numpy.nan}, "length_offset = nan is not finite"),
        ({"worlds": 0}, "worlds = 0 .*from 1 on"),
        ({"worlds": True}, "worlds = True .*from 1 on"),
        ({"length_offset": True}, "length_offset = True is no number"),
        ({"length_offset": [False]}, r"length_offset = \[False\] is no number"),
        ({"length_offset": ["0.1"]}, "length_offset = .* is no number"),
        ({"length_offset": numpy.ma.array([0.1], mask=[True])}, "(?s)length_offset = .* is no number"),
    ):
        with pytest.raises(mckibben.InputError, match=words):
            made(**options)
    with pytest.raises(mckibben.InputError, match="model is of type str"):
        mckibben.mujoco.Driver("model.xml", scenario())
    with pytest.raises(mckibben.InputError, match="length of 0.09 m and length_offset = -0.5 m"):
        made(length_offset=-0.5).start()
    with pytest.raises(mckibben.InputError, match="(?s)thread.*length_offset"):
        made(length_offset=0.5).start()
    driver = made(worlds=2)
    worlds = driver.start()
    for data, commands, words in (
        (worlds, [1.0, 1.0], r"commands are of shape \(2,\).*\(2, 1\).*actuator.request"),
        (worlds, "fill", "commands are no numbers"),
        (worlds, "1", "commands are no numbers"),
        (worlds, [["1"], ["-1"]], "commands are no numbers"),
        (worlds, True, "commands are no numbers"),
        (worlds, numpy.ma.array([[1.0], [-1.0]], mask=[[True], [False]]), "commands are no numbers.*mask hides"),
        (worlds, [[1.0], [7.0]], "plant 1: .*actuator.request"),
        (worlds[0], 1.0, "data is one MjData for 2 worlds"),
        (worlds[:1] * 2, 1.0, r"data\[1\] is given twice"),
        ([worlds[0], None], 1.0, r"data\[1\] is of type NoneType"),
    ):
        with pytest.raises(mckibben.InputError, match=words):
            driver.step(data, commands)
    assert worlds[0].time == worlds[1].time == driver.plant.time == 0.0, "nothing has moved"


def test_a_step_that_ends_at_no_distance_stops_the_simulation():
    """MuJoCo has moved by then, so the argument is not to blame."""
    driver = mckibben.mujoco.Driver(
        with_motor('<motor name="muscle" joint="slide"/>'), scenario(), command_mode="request", length_offset=0.09
    )
    data = driver.start()
    data.qvel[0] = -1000.0
    with pytest.raises(mckibben.SimulationError, match="distance of -0.9.* m between the ends"):
        driver.step(data, 1.0)
    mujoco.mj_resetData(driver.model, data)
    driver.restart(data)
    assert driver.step(data, 1.0)[0, 0] > 1.0


def test_worlds_whose_ends_meet_hold_up_no_other():
    """MuJoCo has moved all worlds by then: the plants of the others take the step too."""
    model = with_motor('<motor name="muscle" joint="slide"/>')

    def made():
        driver = mckibben.mujoco.Driver(model, scenario(), worlds=3, command_mode="request", length_offset=0.09)
        return driver, driver.start()

    (driver, worlds), (plain, others) = made(), made()
    for step in range(20):
        plain.step(others, 1.0)
        if step != 10:
            driver.step(worlds, 1.0)
            continue
        worlds[1].qvel[0] = -1000.0
        for _ in range(2):
            with pytest.raises(mckibben.SimulationError, match="world 1, actuator.*distance of -0.9.*restart"):
                driver.step(worlds, 1.0)
        assert worlds[0].time == pytest.approx(driver.plant.time), "the second call has moved nothing"
        mujoco.mj_resetData(model, worlds[1])
        driver.restart(worlds, [1])
    numpy.testing.assert_array_equal(driver.plant.observe()[[0, 2]], plain.plant.observe()[[0, 2]])
    assert [float(of.qpos[0]) for of in worlds[::2]] == [float(of.qpos[0]) for of in others[::2]]


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("timestep", -1e-3, "timestep = -0.001 s"),
        ("timestep", numpy.nan, "timestep = nan s"),
        ("timestep", 1e3, "max_step = 1e-05 s divides a time step of 1000.0 s"),
        ("disableactuator", 1, "group 0, which the model disables"),
        ("disableflags", int(mujoco.mjtDisableBit.mjDSBL_ACTUATION), 'flag actuation="disable"'),
    ],
)
def test_options_that_no_step_can_have_are_refused_before_it(field, value, words):
    driver = mckibben.mujoco.Driver(with_motor(), scenario(), command_mode="request", max_step="10 us")
    data = driver.start()
    driver.step(data, 1.0)
    before = getattr(driver.model.opt, field)
    setattr(driver.model.opt, field, value)
    with pytest.raises(mckibben.InputError, match=words):
        driver.step(data, 1.0)
    assert data.time == driver.plant.time == 1e-3, "nothing has moved"
    setattr(driver.model.opt, field, before)
    driver.step(data, 1.0)


def test_the_pressure_of_a_keyframe_is_that_of_the_hose():
    """As the hose of a scenario begins: at the pressure of the actuator that it leads to."""
    keys = KEYS | {"hose.length": "1 m", "hose.diameter": "2.5 mm", "valve.kind": "fill-hold-exhaust",
                   "valve.flow_area": "0.3 mm^2"}
    keys.pop("valve.preset")
    text = WORLD.format(step=1e-3, gravity=GRAVITY, muscle=muscle(keys, sensors=["gauge_pressure", "hose_gauge_pressure"]))
    text = text.replace("</mujoco>", '<keyframe><key act="400000"/></keyframe></mujoco>')
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    assert sensor(data, "muscle.gauge_pressure") == pytest.approx(4e5, rel=1e-9)
    assert sensor(data, "muscle.hose_gauge_pressure") == pytest.approx(4e5, rel=1e-9)


def test_numbers_of_attributes_are_in_si():
    text = {"keys": KEYS | {"supply.gauge_pressure": "7 bar", "valve.opening_delay": "2 ms"}, "pulse_frequency": "25 Hz",
            "max_step": "0.5 ms", "length_offset": "-5 mm"}
    numbers = {"keys": KEYS | {"supply.gauge_pressure": 7e5, "valve.opening_delay": numpy.float64(0.002)}, "pulse_frequency": 25,
               "max_step": 5e-4, "length_offset": -0.005}
    ends = []
    for options in (text, numbers):
        model, data = hanging(**options)
        run(model, data, 0.1, 0.6)
        ends.append(data.qpos.copy())
    assert numpy.array_equal(*ends) and abs(ends[0][0]) > 1e-3


def test_a_path_and_a_single_sensor_are_taken():
    path = pathlib.Path("examples/fill-hold-exhaust.toml")
    model, _ = hanging(keys={}, scenario=path, sensors="tension")
    assert [model.sensor(at).name for at in range(model.nsensor)] == ["muscle.tension"]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"max_length": 0}, "max_length = 0 .*above zero"),
        ({"max_length": "90 mm"}, "max_length = '90 mm' .*number in m"),
        ({"max_length": float("nan")}, "max_length = nan"),
        ({"width": float("nan")}, "width = nan"),
        ({"width": -0.01}, "width = -0.01"),
        ({"max_step": float("inf")}, "max_step = inf .*in s"),
        ({"keys": {"supply.gauge_pressure": None}}, "supply.gauge_pressure.*in Pa"),
        ({"instance": ""}, "instance"),
    ],
)
def test_values_that_no_model_can_have_are_refused(options, words):
    with pytest.raises(mckibben.InputError, match=words):
        mckibben.mujoco.muscle_mjcf({"muscle": ["anchor", "hook"]}, **options)


@pytest.mark.parametrize("muscles", [{}, [("muscle", ["anchor", "hook"])]])
def test_a_model_without_muscles_is_refused(muscles):
    with pytest.raises(mckibben.InputError, match="has no muscle"):
        mckibben.mujoco.muscle_mjcf(muscles, keys=KEYS)


def test_a_mode_that_a_valve_does_not_take_names_those_that_it_takes(capfd):
    """No message is about a command that the user has not written."""
    with pytest.raises((ValueError, mujoco.FatalError)) as caught:
        hanging(keys=REGULATOR, command_mode="duty")
    said = str(caught.value) + "".join(capfd.readouterr()) + log()
    assert 'command_mode="set-point"' in said and "exhaust" not in said, said


@pytest.mark.parametrize("offset", ["-500 mm", "500 mm"])
def test_a_length_offset_that_cannot_be_is_named(offset):
    model, data = hanging(length_offset=offset)
    run(model, data, 0.002, 0.0)
    said = log()
    assert "length_offset" in said and "initial.length" not in said, said


def test_an_offset_goes_by_the_name_of_the_muscle():
    """The only muscle may be named as in the model; its distance is then that of an offset without a name."""
    tensions = []
    for offset in ["-5 mm", "muscle = -5 mm"]:
        model, data = hanging(length_offset=offset)
        mujoco.mj_forward(model, data)
        tensions.append(float(data.actuator_force[0]))
    assert tensions[0] == tensions[1] < 0.0, tensions


@pytest.mark.parametrize(("act", "gauge"), [("1e-3", 1e-3), ("150000", 150000.0), ("0", None)])
def test_a_keyframe_sets_the_pressure_except_by_zero(act, gauge):
    """Zero is what a reset writes, so it stands for the pressure of the scenario."""
    text = (MODELS / "hanging-mass.xml").read_text()
    key = f'<keyframe><key qpos="0" act="{act}"/></keyframe></mujoco>'
    model, plain = (mujoco.MjModel.from_xml_string(text.replace("</mujoco>", end)) for end in (key, "</mujoco>"))
    data, begun = mujoco.MjData(model), mujoco.MjData(plain)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    mujoco.mj_forward(plain, begun)
    pressures = [of.sensor("muscle.gauge_pressure").data[0] for of in (data, begun)]
    assert pressures[0] == pytest.approx(pressures[1] if gauge is None else gauge, abs=1e-4)
    assert pressures[1] > 1e3
