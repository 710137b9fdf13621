# %% [markdown]
# # A sweep on Ray
#
# How often should a valve be pulsed? Slowly, and the load dances to the pulses; quickly, and the valve's delays eat
# them. The answer is a map over frequency and duty, 384 runs. On a laptop they take all cores; on a cluster the
# same line takes the cluster: `executor="ray"`.
#
# `pip install ray` is all that it needs. **Without Ray the page goes on with this machine's cores**, and says so: the
# runs and the files are the same, byte by byte.

# %%
import pathlib
import tempfile
import time

import matplotlib.pyplot as plt
import numpy as np
import pictures

import mckibben

try:
    import ray
except ImportError:
    ray = None

work = pathlib.Path(tempfile.mkdtemp())

# %% [markdown]
# ## What is swept
#
# The paper's muscle lifts 15 lb by its pulsed valve, which opens 4 ms late and closes 1 ms late. A section `[sweep]`
# says what varies and what is kept of each run: the mean length, the ripple over the last period, the air that the
# supply gave.

# %%
scenario = mckibben.Scenario.from_file(pictures.EXAMPLES / "paper" / "fig-13.toml").with_values(
    {
        "run.duration": "2 s",
        "run.engine": "fixed-step",
        "run.step": "0.2 ms",
        "sweep.design": "grid",
        "sweep.part_rows": 64,
        "sweep.reductions": ["length.final", "length.ripple", "air.used"],
        "sweep.vary": {
            "command.duty": {"from": 0.04, "to": 0.96, "count": 24},
            "command.frequency": {"from": "10 Hz", "to": "80 Hz", "count": 16, "spacing": "logarithmic"},
        },
    }
)
todo = mckibben.Sweep(scenario)
print(f"{todo.rows} runs in {todo.parts} parts, in steps of 0.2 ms")

# %% [markdown]
# ## On the cluster
#
# `ray.init()` starts a little cluster on this machine; `ray.init("auto")` or an address joins one that is there.
# Nothing else changes: each worker takes a part at a time, a part whose worker dies is computed again by another, and a
# sweep that was stopped goes on where it was. The folder holds Parquet parts, which need not be merged.

# %%
began = time.perf_counter()
if ray is None:
    print("Ray is not installed: on this machine's cores")
    done = mckibben.sweep(scenario, work / "runs")
else:
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, configure_logging=False)
    started = time.perf_counter()
    done = mckibben.sweep(
        scenario, work / "runs", executor="ray", progress=lambda parts, of: print(f"{parts}/{of}", end=" ")
    )
    ray.shutdown()
    print(f"\nthe cluster took {started - began:.1f} s to start, the runs {time.perf_counter() - started:.1f} s")
print(f"{done.rows} runs, {done.failed} of them failed")
assert done.rows == 384 and done.failed == 0

# %% [markdown]
# ## The result does not depend on the machine
#
# The cores of this process write the same bytes. The result of a cluster is identical to that of this machine.

# %%
alone = mckibben.sweep(scenario, work / "alone")
for one, other in zip(done.parts, alone.parts, strict=True):
    assert one.read_bytes() == other.read_bytes(), one.name

# %% [markdown]
# ## The map
#
# Below the lower line a pulse is over before the valve has opened, and the muscle stays empty; above the upper one the
# gap is over before it has shut. In between the muscle follows the duty, and the ripple falls with the frequency.

# %%
runs = done.to_pandas()
duty = np.unique(runs["command_duty"])
frequency = np.unique(runs["command_frequency_hz"])
table = runs.pivot(index="command_duty", columns="command_frequency_hz")
ripple = 1e3 * table["length_ripple_m"].to_numpy()
length = 1e3 * table["length_final_m"].to_numpy()
air = 1e6 * table["air_used_kg"].to_numpy() / 2  # mg/s, as a run is 2 s

figure, axes = plt.subplots(1, 3, figsize=(8.4, 3.2), sharey=True)
for axis, values, label, scale in (
    (axes[0], length, "length at the end (mm)", None),
    (axes[1], np.maximum(ripple, 1e-3), "ripple (mm)", "log"),
    (axes[2], air, "air (mg/s)", None),
):
    mesh = axis.pcolormesh(
        frequency, 100 * duty, values, shading="nearest", norm=scale, cmap="viridis", rasterized=True
    )
    figure.colorbar(mesh, ax=axis, label=label, location="top")
    axis.plot(frequency, 100 * 0.004 * frequency, color="#d55e00", linewidth=1)
    axis.plot(frequency, 100 * (1 - 0.001 * frequency), color="#d55e00", linewidth=1)
    axis.set(xscale="log", xlabel="frequency (Hz)", ylim=(2, 98))
    axis.set_xticks([10, 20, 40, 80], ["10", "20", "40", "80"])
    axis.minorticks_off()
    axis.grid(False)
axes[0].set_ylabel("commanded duty (%)")
pictures.save(figure, "sweep-map")

# A pulse shorter than the opening delay moves nothing and takes no air.
grid_duty, grid_frequency = np.meshgrid(duty, frequency, indexing="ij")
never_opens = grid_duty < 0.004 * grid_frequency - 1e-9
assert never_opens.any() and np.all(air[never_opens] == 0) and np.all(ripple[never_opens] < 1e-6)
# In the middle, faster pulses ripple less.
middle = ripple[np.argmin(np.abs(duty - 0.5))]
assert middle[-1] < 0.2 * middle[0]
