"""Write scenario files that differ in one part from the paper's pulsed muscle, and a leg, for the benchmark `rows`.

    python benches/python/cases.py target/cases
    cd benches
    cargo run --release --bin rows -- ../target/cases/paper.toml ../target/cases/*.toml

Every file but one is `examples/paper/fig-12.toml`: 5 lb under PWM of 25 Hz from 100 psi. `leg-points.toml` is `examples/plant/leg.toml` with
the muscles of one joint between points, where the others have moment arms. Numbers of the added parts are assumed.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).parents[2]
NO_COULOMB = '[actuator.friction]\ncoulomb_width = "0 m"\n'
HYSTERESIS = "[actuator.friction.hysteresis]\n"
TANK = 'reservoir_volume = "2 L"\n'
COMPRESSOR = 'compressor_displacement = "20 L/min"\ncut_in_gauge_pressure = "95 psi"\ncut_out_gauge_pressure = "105 psi"\n'
REGULATOR = 'reservoir_gauge_pressure = "8 bar"\nlag = "20 ms"\n'
HOSE = '[hose]\nlength = "1 m"\ndiameter = "2.5 mm"\n'
LUMPED = f'{HOSE}kind = "lumped"\n'


def elements(count: int) -> str:
    """Return Maxwell-slip elements, each with a longer reach and less stiffness than the one before."""
    reach = ", ".join(f'"{0.02 * 1.6**k:.4f} mm"' for k in range(count))
    ratio = ", ".join(f"{1 / (k + 1):.3f}" for k in range(count))
    return f'{HYSTERESIS}law = "maxwell-slip"\nreach = [{reach}]\nstiffness_ratio = [{ratio}]\n'


#: What is added at the end of the file.
ADDED = {
    "paper": "",
    "friction-viscous": NO_COULOMB,
    "friction-stribeck": '[actuator.friction]\nstatic_ratio = 1.5\nstribeck_velocity = "5 mm/s"\n',
    "friction-1-element": NO_COULOMB + elements(1),
    "friction-5-elements": NO_COULOMB + elements(5),
    "friction-10-elements": NO_COULOMB + elements(10),
    "friction-10-elements-coulomb": elements(10),
    "friction-bouc-wen": f'{NO_COULOMB}{HYSTERESIS}law = "bouc-wen"\nwidth = "0.0044 in"\nbeta = "5 mm^-1"\ngamma = "-1 mm^-1"\n',
    "friction-lugre": f'{NO_COULOMB}{HYSTERESIS}law = "lugre"\nwidth = "0.0044 in"\nbristle_reach = "0.02 mm"\ndamping_time = "1 ms"\n',
    "friction-branches": '[actuator.friction.viscoelastic]\nrelaxation_time = ["0.1 s", "1 s"]\nstiffness_ratio = [0.15, 0.25]\n',
    "friction-structural": '[actuator.friction]\nstructural_damping = "4 ms"\n',
    "line-hose": LUMPED,
    **{f"line-{count}-cells": f'{HOSE}kind = "distributed"\ncells = {count}\n' for count in (1, 4, 8)},
}

#: What is added to `[supply]`, and at the end.
SUPPLIED = {
    "line-bottle": (TANK, ""),
    "line-compressor": (TANK + COMPRESSOR, ""),
    "line-regulator": (TANK + REGULATOR, ""),
    "line-regulator-hose": (TANK + REGULATOR, LUMPED),
}


def points(origin: str, insertion: str) -> str:
    """Return the keys of a muscle between two points."""
    return f"coupling.origin = {{ {origin} }}\ncoupling.insertion = {{ {insertion} }}\n"


#: What of the leg's muscles is replaced.
BETWEEN_POINTS = {
    '[coupling]\nrest_length = "80 mm"\n': "",
    'coupling.arms = { hip = "8 mm", knee = "8 mm" }\n': 'coupling.arms = { hip = "8 mm", knee = "8 mm" }\ncoupling.rest_length = "80 mm"\n',
    'coupling.arms = { hip = "-8 mm", knee = "-8 mm" }\n': 'coupling.arms = { hip = "-8 mm", knee = "-8 mm" }\ncoupling.rest_length = "80 mm"\n',
    'coupling.arms.hip = "18 mm"\n': points('along = "0 mm", across = "20 mm"', 'segment = "thigh", along = "78 mm"'),
    'coupling.arms.hip = "-18 mm"\n': points('along = "0 mm", across = "-20 mm"', 'segment = "thigh", along = "78 mm"'),
    'coupling.arms.knee = "15 mm"\ncoupling.rest_length = "78 mm"\n': points(
        'segment = "thigh", along = "165 mm", across = "15 mm"', 'segment = "shank", along = "20 mm"'
    ),
    'coupling.arms.knee = "-15 mm"\ncoupling.rest_length = "78 mm"\n': points(
        'segment = "thigh", along = "165 mm", across = "-15 mm"', 'segment = "shank", along = "20 mm"'
    ),
}


def main(folder: pathlib.Path) -> None:
    """Write the files."""
    folder.mkdir(parents=True, exist_ok=True)
    paper = (ROOT / "examples/paper/fig-12.toml").read_text()
    leg = (ROOT / "examples/plant/leg.toml").read_text()
    for arms, ends in BETWEEN_POINTS.items():
        assert arms in leg, arms
        leg = leg.replace(arms, ends)
    (folder / "leg-points.toml").write_text(leg)
    leaking = paper.replace('preset = "colbrunn-2001"', 'preset = "colbrunn-2001"\nleakage = "1e-11 m^3/(s*Pa)"')
    files = {name: f"{paper}\n{added}" for name, added in ADDED.items()}
    files["line-leak"] = leaking
    for name, (supply, added) in SUPPLIED.items():
        files[name] = paper.replace("[supply]\n", f"[supply]\n{supply}") + f"\n{added}"
    for name, text in files.items():
        (folder / f"{name}.toml").write_text(text)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
