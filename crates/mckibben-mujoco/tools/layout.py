"""Write the table of `src/layout.rs`: where MuJoCo's structures have the fields that the plugin reads, by version.

    python crates/mckibben-mujoco/tools/layout.py 3.3.7 3.8.1 4.0.0

Each version's headers come from its wheel on PyPI; the C compiler says the offsets.
"""

import pathlib
import subprocess
import sys
import tempfile
import zipfile

MODEL = [
    "nsensor", "opt.timestep", "actuator_plugin", "actuator_actadr", "actuator_actnum", "actuator_ctrllimited",
    "actuator_ctrlrange", "sensor_plugin", "sensor_adr", "plugin_stateadr", "actuator_dyntype", "opt.integrator",
    "opt.disableflags", "opt.disableactuator", "actuator_group", "actuator_gear", "actuator_trntype", "actuator_trnid",
    "jnt_actfrclimited", "tendon_adr", "tendon_num", "wrap_type", "wrap_objid", "plugin_statenum", "jnt_type",
]
# What older versions do not have.
MODEL_LATER = ["tendon_actfrclimited", "actuator_delay"]
# Numbers that `src/view.rs` takes as equal in every version.
FIXED = {
    "mjINT_RK4": 1, "mjTRN_JOINT": 0, "mjTRN_JOINTINPARENT": 1, "mjTRN_SLIDERCRANK": 2, "mjTRN_TENDON": 3, "mjJNT_SLIDE": 2,
    "mjJNT_HINGE": 3, "mjWRAP_JOINT": 1, "mjDYN_NONE": 0,
}
# Since 3.11 an actuator may have several controls and forces, and the model says where they begin.
MODEL_NEW = ["nactuator", "actuator_ctrladr", "actuator_outadr"]
DATA = [
    "qvel", "act", "ctrl", "plugin_state", "plugin_data", "sensordata", "actuator_length", "actuator_velocity",
    "actuator_force", "actuator_moment", "moment_rownnz", "moment_rowadr", "moment_colind",
]
PROBE = """
#include <stddef.h>
#include <stdio.h>
#include <mujoco/mujoco.h>
int main(void) {{
  {lines}
  return 0;
}}
"""


def probe(include: pathlib.Path, folder: pathlib.Path, lines: str) -> list[str] | None:
    """What a program with these lines prints, or nothing where the headers lack a field."""
    source, program = folder / "probe.c", folder / "probe"
    source.write_text(PROBE.format(lines=lines))
    compiled = subprocess.run(["cc", f"-I{include}", str(source), "-o", str(program)], capture_output=True)
    if compiled.returncode:
        return None
    return subprocess.run([str(program)], capture_output=True, text=True, check=True).stdout.split()


def row(version: str) -> str:
    """The row of one version."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--dest", name, f"mujoco=={version}"]
        subprocess.run(command, check=True)
        wheels = list(folder.glob("*.whl"))
        if not zipfile.ZipFile(wheels[0]).namelist().count("mujoco/include/mujoco/mjmodel.h"):
            command[-1] = f"mujoco-core=={version}"
            subprocess.run(command, check=True)
            wheels = list(folder.glob("mujoco_core*.whl"))
        zipfile.ZipFile(wheels[0]).extractall(folder)
        include = folder / "mujoco" / "include"
        offset = 'printf("%zu\\n", offsetof({of}, {field}));'.format
        lines = [offset(of="mjModel", field=field) for field in MODEL]
        lines += [offset(of="mjData", field=field) for field in DATA]
        lines += [f'printf("%zu\\n", {it});' for it in ("sizeof(((mjModel*)0)->nsensor)", "sizeof(mjtNum)", "sizeof(mjpPlugin)")]
        lines += [f'printf("%d\\n", {it});' for it in ("mjOBJ_ACTUATOR", "mjOBJ_SENSOR", "mjOBJ_PLUGIN", "mjSTAGE_ACC", "mjDSBL_ACTUATION", "mjVERSION_HEADER")]
        lines += [f'printf("%d\\n", {it});' for it in FIXED]
        known = probe(include, folder, "\n  ".join(lines))
        if known is None:
            raise SystemExit(f"the headers of {version} lack a field that the plugin needs")
        numbers = [int(number) for number in known]
        new = probe(include, folder, "\n  ".join(offset(of="mjModel", field=field) for field in MODEL_NEW))
        count = probe(include, folder, offset(of="mjModel", field="nu"))
        news = [int(number) for number in new] if new else None
        later = [probe(include, folder, offset(of="mjModel", field=field)) for field in MODEL_LATER]
        later = ", ".join(f"Some({it[0]})" if it else "None" for it in later)
        model, data = numbers[:len(MODEL)], numbers[len(MODEL):len(MODEL) + len(DATA)]
        size, real, plugin, actuator, sensor, instance, stage, flag, header, *fixed = numbers[len(MODEL) + len(DATA):]
        assert real == 8 and plugin == 152, (version, real, plugin)
        assert fixed == [*FIXED.values()], (version, fixed)
        actuators = news[0] if news else int(count[0])
        addresses = f"Some({news[1:]})" if news else "None"
        return (f"    row({header}, {size}, {actuators}, {addresses}, {model}, [{later}], {data}, [{actuator}, {sensor}, {instance}], "
                f"{stage}, {flag}), // {version}")


if __name__ == "__main__":
    for version in sys.argv[1:]:
        print(row(version), flush=True)
