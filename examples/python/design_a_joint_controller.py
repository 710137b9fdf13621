# %% [markdown]
# # Design a joint's controller
#
# Two muscles turn a forearm against each other; a quick valve pulses air into each at 200 Hz. Pushed, the forearm
# swings four times before it rests, and where it rests friction decides. This page linearizes it, designs a controller
# with [python-control](https://python-control.readthedocs.io), reads the margins, and then closes the loop where it
# counts: around the nonlinear muscles, with every pulse of their valves.

# %%
import collections.abc
import math

import control
import matplotlib.pyplot as plt
import numpy as np
import pictures
import scipy.optimize

import mckibben

DUTY = 0.45  # of both valves without a command: how much the muscles co-contract
PERIOD = 5e-3  # s, of the pulses and of the controller
scenario = mckibben.Scenario.from_file(pictures.EXAMPLES / "linearize-joint.toml").with_values(
    {"command.duty": DUTY, "antagonist.command.duty": DUTY, "run.duration": "2 s", "run.sample_interval": "1 ms"}
)

# %% [markdown]
# ## The linear model
#
# `linearize` gives the joint about its balance under these duties, by exact derivatives, with the valves by their mean
# flow. Both poles of the swing are there, and one pole for the pressure of each muscle.

# %%
model = mckibben.linearize(scenario)
point = model.operating_point
print("states:", *model.states)
print("poles: ", *np.round(model.poles, 2))
swing = max(model.poles, key=lambda pole: pole.imag)
print(f"swing: {abs(swing) / (2 * math.pi):.2f} Hz, damping ratio {-swing.real / abs(swing):.2f}")

# %% [markdown]
# Push and pull go together: what one valve gets more the other gets less. Of the four states the difference of the
# pressures is then enough, in bar so that the numbers are of a size; their sum, which sets the stiffness, stays where
# it is.

# %%
BAR = 1e5
reduce = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1 / BAR, -1 / BAR]])
restore = np.linalg.pinv(reduce)
A = reduce @ model.A @ restore
B = reduce @ (model.B[:, 0] - model.B[:, 1])[:, None]
assert np.allclose(reduce @ model.A, A @ reduce), "the difference goes its way by itself"
plant = control.c2d(control.ss(A, B, np.eye(3), 0), PERIOD)
lift, push = plant.A, plant.B[:, 0]

# %% [markdown]
# ## A custom loop
#
# Before a controller is designed by a model, the thing that it will meet: two `Actuator`s, each with its air and its
# valve's poppets, and a limb. The muscles come from the package; the limb is two lines, in place of a robot's
# simulator. `decide` is called once a period, and a computer has a delay: its command takes effect one period later.

# %%
described = scenario.to_dict()
limb = {key: float(text.split()[0]) for key, text in described["load"].items() if key != "kind"}
RADIUS, REST = limb["pulley_radius"], limb["rest_length"]
GRAVITY_TORQUE = limb["mass"] * limb["gravity"] * limb["distance"]
INERTIA = limb["inertia"] + limb["mass"] * limb["distance"] ** 2

Decide = collections.abc.Callable[[float, float, float], float]


def muscle(gauge_pressure: float) -> mckibben.Actuator:
    """One of the two muscles with its valve, at rest on the pulley at a pressure in Pa."""
    of_one = {section: described[section] for section in ("actuator", "air", "supply", "valve", "command", "run")}
    start = {"gauge_pressure": f"{gauge_pressure} Pa", "length": f"{REST} m"}
    return mckibben.Actuator(mckibben.Scenario.from_dict(of_one | {"load": {"kind": "isometric"}, "initial": start}))


def run_loop(decide: Decide, duration: float, gauge_pressure: float, step: float = 5e-4) -> dict[str, np.ndarray]:
    """The joint from rest at zero; `decide(time, angle, difference of the pressures in bar)` says how far the duties
    leave their middle."""
    agonist, antagonist = muscle(gauge_pressure), muscle(gauge_pressure)
    first, second = agonist.start(), antagonist.start()
    angle = rate = pull = counter_pull = commanded = coming = 0.0
    rows = []
    for count in range(round(duration / step)):
        if count % round(PERIOD / step) == 0:
            decided = decide(count * step, angle, (first.absolute_pressure - second.absolute_pressure) / BAR)
            commanded, coming = coming if count else decided, decided
        torque = RADIUS * (pull - counter_pull) - GRAVITY_TORQUE * math.sin(angle) - limb["damping"] * rate
        rate += torque / INERTIA * step
        angle += rate * step
        duties = (min(max(DUTY + sign * commanded, 0.0), 1.0) for sign in (1, -1))
        first, pull, _ = agonist.step(first, REST - RADIUS * angle, -RADIUS * rate, next(duties), step)
        second, counter_pull, _ = antagonist.step(second, REST + RADIUS * angle, RADIUS * rate, next(duties), step)
        rows.append(((count + 1) * step, angle, first.absolute_pressure, second.absolute_pressure, commanded))
    return dict(zip(("time", "angle", "pressure", "counter_pressure", "command"), np.array(rows).T))


# The package's own joint, every event located, says whether the loop is right: driven by 0.5 and 0.4 from 30 psi.
checked = scenario.with_values({"command.duty": DUTY + 0.05, "antagonist.command.duty": DUTY - 0.05})
located = mckibben.simulate(checked)
ours = run_loop(lambda *_: 0.05, 2.0, gauge_pressure=206842.7187950509)
apart = np.abs(ours["angle"] - located.at_times(np.minimum(ours["time"], 2.0))["angle_rad"]).max()
print(f"custom loop and `simulate`: {math.degrees(apart):.3f}° apart at most")
assert math.degrees(apart) < 0.05

# %% [markdown]
# ## Does the linear model hold?
#
# A step of the difference of the duties, by the model and by the pulsed muscles. A duty is done a period after it is
# decided, so the model is one sample late. What it does not know is dry friction: the steps have to be large beside it.

# %%
BALANCE = point["agonist_gauge_pressure_pa"]
figure, axis = plt.subplots()
errors = []
at = np.arange(0, 1.0, PERIOD)
for size in (0.03, 0.1):
    pulsed = run_loop(lambda time, *_: size if time >= 0.1 - 1e-9 else 0.0, 1.0, BALANCE)
    commanded = np.where(at >= 0.1 + PERIOD - 1e-9, size, 0.0)
    foreseen = control.forced_response(plant, at, commanded).outputs[0]
    [line] = axis.plot(pulsed["time"], np.degrees(pulsed["angle"]), label=f"muscles, ±{size:g}")
    axis.plot(at, np.degrees(foreseen), "--", color=line.get_color(), linewidth=0.9, label="linear model")
    early = (at > 0.1) & (at < 0.22)
    errors.append(np.abs(np.interp(at, pulsed["time"], pulsed["angle"]) - foreseen)[early].max() / foreseen.max())
    print(f"±{size:g}: {100 * errors[-1]:.1f} % off in the first eighth of a second")
axis.set(xlabel="time (s)", ylabel="angle (°)", title="a step of the duties, open loop")
axis.legend()
pictures.save(figure, "joint-model")
assert errors[1] < errors[0] < 0.1, "friction counts less in the larger step"

# %% [markdown]
# ## The controller
#
# Linear-quadratic, on the angle, its rate, the difference of the pressures, the last command (the sample of delay),
# and the integral of the angle's error, without which friction and gravity would keep the joint off its aim. The
# encoder gives no rate: it is the difference of two readings, half a sample late, and the margins below count that.

# %%
# States: angle, rate, pressure difference, last command, integral of the angle.
dynamics = np.zeros((5, 5))
dynamics[:3, :3], dynamics[:3, 3] = lift, push
dynamics[4, 0], dynamics[4, 4] = PERIOD, 1.0
input_column = np.array([[0.0], [0.0], [0.0], [1.0], [0.0]])
weights = np.diag([5.0, 0.0, 0.0, 0.0, 400.0])
gains, _, _ = control.dlqr(dynamics, input_column, weights, [[1.0]])
[on_angle, on_rate, on_pressure, on_command, on_integral] = gains[0]
print("gains:", *np.round(gains[0], 3))


def opened(late: int = 0) -> control.StateSpace:
    """The loop cut open where the controller's word goes to the valves, with measurements `late` samples old."""
    # States: angle, rate, pressure, word under way; integral, last angle, last word; then the words still on their way.
    size = 7 + late
    step, word, said = np.zeros((size, size)), np.zeros((size, 1)), np.zeros((1, size))
    step[:3, :3], step[:3, 3] = lift, push
    step[4, 0], step[4, 4], step[5, 0] = PERIOD, 1.0, 1.0
    said[0, :7] = [on_angle + on_rate / PERIOD, 0, on_pressure, 0, on_integral, -on_rate / PERIOD, on_command]
    step[6] = -said[0]
    for place in range(late):
        step[3 if place == 0 else 6 + place, 7 + place] = 1.0
    word[3 if late == 0 else 6 + late] = 1.0
    return control.ss(step, word, said, 0, PERIOD)


def slowest(loop: control.StateSpace) -> float:
    """The largest of the closed loop's poles: below 1 it comes to rest, above it does not."""
    return float(np.abs(control.feedback(loop, 1).poles()).max())


# %% [markdown]
# ## Margins
#
# How much stronger might the valves be than we think, and how much later may the controller act, before the loop
# oscillates? The margins are read from the frequency response on a fine grid. The polynomials of the transfer function
# would give them too, but their coefficients span so many orders that rounding decides which roots are found.

# %%
loop = opened()
frequencies = np.geomspace(0.1, 99, 2000)
response = loop(np.exp(2j * math.pi * frequencies * PERIOD)).ravel()
measured = control.frd(response, 2 * math.pi * frequencies, smooth=True)
gain_margins, phase_margins, distances, _, crossings, _ = control.stability_margins(measured, returnall=True)
phase_margin, crossing = min(zip(phase_margins, crossings))
gain_margin = scipy.optimize.brentq(lambda gain: slowest(gain * loop) - 1, 1, 100)
most_late = max(late for late in range(40) if slowest(opened(late)) < 1)
print(f"gain margin {gain_margin:.1f}, phase margin {phase_margin:.0f}° at {crossing / (2 * math.pi):.1f} Hz,")
print(f"distance from -1 {min(distances):.2f}, up to {most_late} samples ({1e3 * most_late * PERIOD:.0f} ms) later")
# What the open loop's curve says and what the closed loop's poles say is one thing.
assert np.isclose(gain_margins, gain_margin, rtol=1e-3).any()
assert math.floor(math.radians(phase_margin) / crossing / PERIOD) == most_late
assert np.isclose(min(distances), np.abs(1 + response).min(), rtol=1e-4)

figure, (nyquist, bode) = plt.subplots(1, 2, figsize=(6.8, 3.4))
nyquist.plot(response.real, response.imag)
nyquist.plot(-1, 0, "x", color="#d55e00")
turn = np.linspace(0, 2 * math.pi, 200)
nyquist.plot(np.cos(turn), np.sin(turn), ":", color="#5c6166")
nyquist.set(xlim=(-2.2, 2.2), ylim=(-2.2, 2.2), aspect="equal", title="Nyquist: −1 is kept at a distance")
bode.loglog(frequencies, np.abs(response))
bode.axhline(1, color="#5c6166", linestyle=":")
bode.axvline(crossing / (2 * math.pi), color="#5c6166", linestyle=":")
bode.set(xlabel="frequency (Hz)", title=f"gain of the loop; margin {gain_margin:.0f}, {phase_margin:.0f}°")
pictures.save(figure, "joint-margins")


# %% [markdown]
# ## In the loop with the muscles
#
# Nothing is linear from here on: pulses, choked flow, friction, the braid's own curve, duties that end at 0 and 1.


# %%
def controller(aim: collections.abc.Callable[[float], float], late: int = 0) -> Decide:
    """The designed law as a digital controller has it, its readings `late` samples old."""
    readings: list[tuple[float, float]] = []
    last, total, said = 0.0, 0.0, 0.0

    def decide(time: float, angle: float, difference: float) -> float:
        nonlocal last, total, said
        readings.append((angle, difference))
        angle, difference = readings[max(len(readings) - 1 - late, 0)]
        rate = (angle - last) / PERIOD
        terms = on_angle * angle, on_rate * rate, on_pressure * difference, on_command * said, on_integral * total
        wanted = -sum(terms)
        said = min(max(wanted, -DUTY), DUTY)
        if said == wanted:
            total += (angle - aim(time)) * PERIOD  # no winding up where the valve gives no more
        last = angle
        return said

    return decide


def aim(time: float) -> float:
    return math.radians(0.0 if time < 0.2 else 10.0 if time < 1.5 else -10.0)


per_duty = float(control.dcgain(plant)[0].squeeze())  # rad: the angle in the end for all of a duty
held = run_loop(lambda time, *_: aim(time) / per_duty, 3.0, BALANCE)
moved = run_loop(controller(aim), 3.0, BALANCE)
figure, axes = plt.subplots(2, sharex=True, figsize=(6.2, 4.4), height_ratios=[2, 1])
axes[0].plot(held["time"], np.degrees(held["angle"]), linewidth=0.9, label="duties of the model, no feedback")
axes[0].plot(moved["time"], np.degrees(moved["angle"]), label="controlled")
axes[0].plot(moved["time"], [math.degrees(aim(time)) for time in moved["time"]], ":", color="#5c6166", label="aim")
axes[0].set_ylabel("angle (°)")
axes[0].legend()
axes[1].plot(moved["time"], DUTY + moved["command"], label="agonist")
axes[1].plot(moved["time"], DUTY - moved["command"], label="antagonist")
axes[1].set(xlabel="time (s)", ylabel="duty", ylim=(0, 1))
axes[1].legend(ncols=2)
pictures.save(figure, "joint-step")


def settling(run: dict[str, np.ndarray], begin: float, end: float, band: float = 0.5) -> float:
    """How long after `begin` the angle is off its aim by more than a band in degrees for the last time."""
    inside = (run["time"] > begin) & (run["time"] < end)
    error = np.abs(np.degrees(run["angle"][inside]) - math.degrees(aim(end - 1e-6)))
    outside = np.flatnonzero(error > band)
    return float(run["time"][inside][outside[-1]] - begin) if len(outside) else 0.0


for name, run in (("no feedback", held), ("controlled", moved)):
    times = settling(run, 0.2, 1.5), settling(run, 1.5, 3.0)
    print(f"{name:12s} within 0.5° after {times[0]:.2f} s and {times[1]:.2f} s")
assert max(settling(moved, 0.2, 1.5), settling(moved, 1.5, 3.0)) < 0.6
assert settling(held, 0.2, 1.5) > 2 * settling(moved, 0.2, 1.5)

# %% [markdown]
# ## Do the margins hold there?
#
# The same law, its readings later and later. Two samples short of what the linear loop bears the joint still comes to
# rest; two beyond, it swings and does not stop.

# %%
figure, axis = plt.subplots()
swings = {}
for late in (0, most_late - 2, most_late + 2):
    run = run_loop(controller(aim, late), 1.5, BALANCE)
    swings[late] = np.ptp(np.degrees(run["angle"][run["time"] > 1.2]))
    axis.plot(run["time"], np.degrees(run["angle"]), label=f"{1e3 * late * PERIOD:.0f} ms late")
axis.set(xlabel="time (s)", ylabel="angle (°)", title=f"the linear loop bears {1e3 * most_late * PERIOD:.0f} ms")
axis.legend()
pictures.save(figure, "joint-late")
print({late: f"{swing:.2f}°" for late, swing in swings.items()})
assert swings[most_late - 2] < 1.5 < 5 < swings[most_late + 2]
