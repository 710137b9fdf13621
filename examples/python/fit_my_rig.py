# %% [markdown]
# # Fit my rig
#
# A joint stands on the bench: two muscles on a pulley, a limb, an encoder and two pressure sensors. The drawing says
# how it was meant; how it turned out is in a CSV file. This page finds the numbers that the drawing does not know, says
# how sure they are, and checks them on motion that the fit has not seen.
#
# No rig was at hand for this page: the data in `examples/identify` are computed with other numbers than the drawing's,
# with noise and the steps of a sensor (`data.sh` there says how). So here, other than on your bench, we can look behind
# the curtain at the end.

# %%
import pathlib
import tempfile

import matplotlib.pyplot as plt
import numpy as np
import pictures

import mckibben

DRAWING = pictures.EXAMPLES / "antagonistic-joint.toml"
MEASURED = pictures.EXAMPLES / "identify" / "joint.csv"
work = pathlib.Path(tempfile.mkdtemp())

time, angle, agonist, antagonist = np.genfromtxt(MEASURED, delimiter=",", skip_header=1, unpack=True)
drawing = mckibben.Scenario.from_file(DRAWING)


def measured_at(scenario: mckibben.Scenario) -> np.ndarray:
    """What the sensors would show: the angle in degrees and both pressures in kPa at the times of the readings."""
    values = mckibben.simulate(scenario).at_times(time)
    columns = values["angle_rad"], values["absolute_pressure_pa"], values["antagonist_absolute_pressure_pa"]
    return np.array([np.degrees(columns[0]), 1e-3 * columns[1], 1e-3 * columns[2]])


# %% [markdown]
# ## Data, and what the drawing makes of them
#
# The drawing's joint swings in another rhythm and settles elsewhere. Which of its numbers is to blame cannot be seen.

# %%
readings = np.array([angle, agonist, antagonist])
drawn = measured_at(drawing)
figure, axes = plt.subplots(2, sharex=True, figsize=(6.2, 4.2))
axes[0].plot(time, angle, ".", markersize=3, label="measured")
axes[0].plot(time, drawn[0], label="drawing")
axes[0].set_ylabel("angle (°)")
axes[0].legend()
for row, name in ((1, "agonist"), (2, "antagonist")):
    [line] = axes[1].plot(time, readings[row], ".", markersize=3, label=name)
    axes[1].plot(time, drawn[row], color=line.get_color(), linewidth=0.9)
axes[1].set(xlabel="time (s)", ylabel="absolute pressure (kPa)")
axes[1].legend()
pictures.save(figure, "fit-data")

# %% [markdown]
# ## A study
#
# What is looked for stands in a study file: the scenario that says what is known, which column is what, and the keys
# that are to be found. The last half second, in which the muscles change places, is **held out**: the fit never sees
# it.

# %%
HELD_OUT = 1.0  # s
lines = MEASURED.read_text().splitlines()
known = [line for line in lines[1:] if float(line.split(",")[0]) <= HELD_OUT]
(work / "joint.csv").write_text("\n".join([lines[0], *known]) + "\n")

STUDY = f"""\
[study]
kind = "trajectories"
scenario = '{DRAWING}'

[columns.time]
name = "t"
unit = "s"

[columns.angle]
name = "angle"
unit = "deg"

[columns.absolute_pressure]                 # in the agonist
name = "P1"
unit = "kPa"

[columns.antagonist_absolute_pressure]
name = "P2"
unit = "kPa"

[[run]]
file = "joint.csv"

[fit."load.inertia"]

[fit."load.damping"]

[fit."actuator.turns"]                      # of the agonist, since the antagonist's are estimated separately

[fit."antagonist.actuator.turns"]
"""
(work / "study.toml").write_text(STUDY)
found = mckibben.identify(work / "study.toml")
for note in [*found.notes, *found.warnings]:
    print(note)

# %% [markdown]
# ## How sure
#
# Every number comes with its 95 % interval, from the curvature of the misfit and the residual scatter. The table also
# has the drawing's number and the one that the data were made with, which is unknown on a real rig.

# %%
MADE_WITH = {
    "load.inertia": 1.3e-3,
    "load.damping": 0.03,
    "actuator.turns": 2.8,
    "antagonist.actuator.turns": 3.0,
}
DRAWN = {"load.inertia": 1e-3, "load.damping": 0.02, "actuator.turns": 2.5, "antagonist.actuator.turns": 2.5}
print(f"{'':28s}{'drawing':>10s}{'found':>12s}{'95 % interval':>26s}{'made with':>12s}")
for estimate in found.estimates:
    low, high = estimate.confidence_interval
    name = estimate.name
    interval = f"{low:.5g} to {high:.5g}"
    print(f"{name:28s}{DRAWN[name]:10.5g}{estimate.value:12.5g}{interval:>26s}{MADE_WITH[name]:12.5g}  {estimate.unit}")

figure, axis = plt.subplots(figsize=(6.2, 2.4))
for row, estimate in enumerate(found.estimates):
    truth = MADE_WITH[estimate.name]
    low, high = (100 * (bound / truth - 1) for bound in estimate.confidence_interval)
    axis.plot([low, high], [row, row], linewidth=3)
    axis.plot(100 * (estimate.value / truth - 1), row, "o", color="#1c1c1e", markersize=4)
axis.axvline(0, color="#5c6166", linestyle=":")
axis.set_yticks(range(len(found.estimates)), [estimate.name for estimate in found.estimates])
axis.invert_yaxis()
axis.set(xlabel="off the number that the data were made with (%)", title="estimates with their 95 % intervals")
pictures.save(figure, "fit-intervals")

for estimate in found.estimates:
    truth = MADE_WITH[estimate.name]
    # Four intervals of 95 %: one of them may miss by a little, none by much.
    assert abs(estimate.value - truth) < 3 * estimate.standard_error, estimate
    assert abs(estimate.value / truth - 1) < 0.02 < abs(DRAWN[estimate.name] / truth - 1)

# %% [markdown]
# ## Held out
#
# A fit that follows its own data proves little. In the half second that was held out the muscles change places and the
# joint is thrown to the other side; the fitted model has to predict it within the noise of the sensors.

# %%
fitted = measured_at(found.scenarios["scenario.toml"])
held_out = time > HELD_OUT
NOISE = np.array([0.1, 0.3, 0.3])  # deg, kPa, kPa: what data.sh adds
rms = {
    name: np.sqrt(np.mean((values - readings)[:, held_out] ** 2, axis=1))
    for name, values in (("drawing", drawn), ("fitted", fitted))
}
for name, values in rms.items():
    print(f"{name:8s} {values[0]:8.3f}° {values[1]:8.2f} kPa {values[2]:8.2f} kPa   (rms where nothing was fitted)")

figure, axes = plt.subplots(2, sharex=True, figsize=(6.2, 4.2), height_ratios=[2, 1])
axes[0].plot(time, angle, ".", markersize=3, label="measured")
axes[0].plot(time, drawn[0], linewidth=0.8, label="drawing")
axes[0].plot(time, fitted[0], label="fitted")
axes[0].set_ylabel("angle (°)")
axes[0].legend(ncols=3)
axes[1].plot(time, (angle - fitted[0]), ".", markersize=3)
axes[1].axhspan(-0.2, 0.2, color="#e2e4e6", zorder=0)
axes[1].set(xlabel="time (s)", ylabel="left over (°)")
for axis in axes:
    axis.axvline(HELD_OUT, color="#5c6166", linestyle=":")
axes[0].text(HELD_OUT + 0.01, axes[0].get_ylim()[0], "held out →", va="bottom", color="#5c6166")
pictures.save(figure, "fit-held-out")

# What is left is the sensors' noise and nothing else: not more than it, and not less either.
assert np.all(rms["fitted"] < 1.3 * NOISE) and np.all(rms["fitted"] > 0.7 * NOISE)
assert np.all(rms["drawing"] > 10 * rms["fitted"])

# %% [markdown]
# ## What is not identifiable from these data
#
# Would the limb's mass and the place of its centre not be good to know too? They act through the moment of gravity $M g
# d$ and the inertia about the joint $J + M d^2$ alone, three numbers in two: a fit of all of them is as
# good as before, and has three numbers without an interval, with the reason.

# %%
(work / "greedy.toml").write_text(STUDY + '\n[fit."load.mass"]\n\n[fit."load.distance"]\n')
greedy = mckibben.identify(work / "greedy.toml")
for estimate in greedy.estimates:
    unidentified = "not identifiable from these data" if estimate.confidence_interval is None else ""
    print(f"{estimate.name:28s}{estimate.value:12.5g}  {unidentified}")
print(greedy.warnings[-1])
unidentified = {estimate.name for estimate in greedy.estimates if estimate.confidence_interval is None}
assert unidentified == {"load.mass", "load.distance", "load.inertia"}
product = greedy["load.mass"].value * greedy["load.distance"].value
assert abs(product / (0.5 * 0.1) - 1) < 0.01, "their product is identifiable"

# %% [markdown]
# Weigh the limb, and the study of before is right. `found.scenarios["scenario.toml"].to_toml()` is the rig from here
# on: the other pages of this folder take it.
