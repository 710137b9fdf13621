"""Draw a picture of each model after a second of motion: models/NAME.png.

    MUJOCO_GL=osmesa python models/render.py        # from the root of the project; or egl, glfw

The controls are those that the model's own comment speaks of.
"""

from __future__ import annotations

import math
import pathlib

import mujoco
from PIL import Image

import mckibben.mujoco

MODELS = pathlib.Path(__file__).resolve().parent
SIZE = {"leg": (480, 360)}
SHORTER = (360, 480)


def stride(time: float) -> list[float]:
    """Duty cycles of the leg: hip forward and back, knee forward and back, both at rest."""
    swing = math.sin(2.0 * math.pi * time / 0.8)
    lift = math.sin(2.0 * math.pi * time / 0.8 + 1.6)
    return [0.45 + 0.2 * swing, 0.45 - 0.2 * swing, 0.4 - 0.2 * lift, 0.45 + 0.2 * lift, 0.3, 0.3]


CONTROLS = {
    "hanging-mass": lambda time: [0.6],
    "elbow": lambda time: [1.0, -1.0] if time < 0.25 else [0.0, 0.0],
    "arm": lambda time: [1.0, -1.0, 1.0, -1.0, 0.0, 0.0] if time < 0.12 else [0.0] * 6,
    "leg": stride,
}


def main() -> None:
    mckibben.mujoco.load()
    for name, control in CONTROLS.items():
        model = mujoco.MjModel.from_xml_path(str(MODELS / f"{name}.xml"))
        data = mujoco.MjData(model)
        while data.time < 1.0:
            data.ctrl[:] = control(data.time)
            mujoco.mj_step(model, data)
        mujoco.mj_forward(model, data)
        width, height = SIZE.get(name, SHORTER)
        camera = mujoco.MjvCamera()
        mujoco.mjv_defaultFreeCamera(model, camera)
        camera.azimuth, camera.elevation = 90, -8
        if name == "leg":
            camera.lookat[0] = data.qpos[0]
        with mujoco.Renderer(model, height, width) as renderer:
            renderer.update_scene(data, camera)
            Image.fromarray(renderer.render()).quantize(128).save(MODELS / f"{name}.png", optimize=True)
        print(f"{name}: coordinates {data.qpos.round(3)}")


if __name__ == "__main__":
    main()
