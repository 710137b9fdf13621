"""Environments with names: a scenario of each, and the ranges in SI of its targets.

The muscles are the paper's. The numbers of leg and arm, the masses and the ranges of the targets are assumed.
"""

from math import radians

MUSCLE = """
[actuator]
preset = "colbrunn-2001"
[supply]
gauge_pressure = "100 psi"
[valve]
preset = "matrix-eight-channel"
[command]
kind = "pwm"
frequency = "25 Hz"
duty = 0.5
[run]
duration = "2 s"
engine = "fixed-step"
method = "rk4"
"""
HANGING_MASS = (
    MUSCLE
    + """
step = "0.5 ms"
[load]
kind = "hanging-mass"
mass = "5 lb"
[initial]
gauge_pressure = "40 psi"
length = "equilibrium"
"""
)
JOINT = (
    MUSCLE
    + """
step = "0.2 ms"
[load]
kind = "antagonistic-joint"
pulley_radius = "15 mm"
rest_length = "3.3 in"
mass = "0.5 kg"
distance = "100 mm"
inertia = "1e-3 kg*m^2"
damping = "0.02 N*m*s/rad"
min_angle = "-40 deg"
max_angle = "40 deg"
[initial]
gauge_pressure = "20 psi"
"""
)
LEG = (
    MUSCLE
    + """
step = "0.2 ms"
[initial]
gauge_pressure = "15 psi"
[mechanism]
kind = "chain"
[mechanism.joints.hip]
segment = "thigh"
length = "22 cm"
mass = "0.40 kg"
distance = "9 cm"
inertia = "1.6e-3 kg*m^2"
damping = "0.02 N*m*s/rad"
min_angle = "-60 deg"
max_angle = "60 deg"
stop_stiffness = "50 N*m/rad"
stop_damping = "0.3 N*m*s/rad"
angle = "0.1 rad"
[mechanism.joints.knee]
segment = "shank"
length = "22 cm"
mass = "0.22 kg"
distance = "10 cm"
inertia = "0.9e-3 kg*m^2"
damping = "0.02 N*m*s/rad"
min_angle = "-100 deg"
max_angle = "-5 deg"
stop_stiffness = "50 N*m/rad"
stop_damping = "0.3 N*m*s/rad"
angle = "-0.5 rad"
[mechanism.belt]
depth = "43.2 cm"
velocity = "-0.35 m/s"
stiffness = "20 kN/m"
damping = "80 N*s/m"
friction = 0.6
slipping_speed = "2 cm/s"
[coupling]
rest_length = "80 mm"
[actuators.both-forward]
coupling.arms = { hip = "8 mm", knee = "8 mm" }
[actuators.both-back]
coupling.arms = { hip = "-8 mm", knee = "-8 mm" }
[actuators.hip-forward]
coupling.arms.hip = "18 mm"
[actuators.hip-back]
coupling.arms.hip = "-18 mm"
[actuators.knee-forward]
coupling.arms.knee = "15 mm"
coupling.rest_length = "78 mm"
[actuators.knee-back]
coupling.arms.knee = "-15 mm"
coupling.rest_length = "78 mm"
"""
)
ARM = """
[supplies.tank]
gauge_pressure = "6.6 bar"
reservoir_volume = "300 cm^3"
compressor_displacement = "40 L/min"
cut_in_gauge_pressure = "6.5 bar"
cut_out_gauge_pressure = "8 bar"
[supplies.regulator]
from = "tank"
gauge_pressure = "4 bar"
lag = "20 ms"
droop = "2e7 Pa*s/kg"
[supplies.manifold]
from = "regulator"
reservoir_volume = "50 cm^3"
inlet.flow_area = "10 mm^2"
[valve]
preset = "matrix-eight-channel"
kind = "fill-hold-exhaust"
[command]
kind = "pwm"
frequency = "25 Hz"
duty = 0.5
[initial]
gauge_pressure = "1 bar"
[mechanism]
kind = "chain"
[mechanism.joints.shoulder]
segment = "upper-arm"
length = "28 cm"
mass = "0.8 kg"
distance = "12 cm"
inertia = "5e-3 kg*m^2"
damping = "0.05 N*m*s/rad"
min_angle = "-60 deg"
max_angle = "60 deg"
[mechanism.joints.elbow]
segment = "forearm"
length = "24 cm"
mass = "0.5 kg"
distance = "10 cm"
inertia = "2.5e-3 kg*m^2"
damping = "0.04 N*m*s/rad"
min_angle = "-10 deg"
max_angle = "100 deg"
angle = "20 deg"
[mechanism.joints.wrist]
segment = "hand"
mass = "0.2 kg"
distance = "6 cm"
inertia = "3e-4 kg*m^2"
damping = "0.02 N*m*s/rad"
min_angle = "-50 deg"
max_angle = "50 deg"
[coupling]
rest_length = "3.4 in"
[actuators.deltoid]
coupling.arms.shoulder = "20 mm"
[actuators.latissimus]
coupling.arms.shoulder = "-20 mm"
[actuators.biceps]
coupling.arms = { shoulder = "12 mm", elbow = "15 mm" }
[actuators.triceps]
coupling.arms.elbow = "-12 mm"
[actuators.flexor]
coupling.arms.wrist = "10 mm"
[actuators.extensor]
coupling.arms.wrist = "-10 mm"
[run]
duration = "2 s"
engine = "fixed-step"
step = "0.5 ms"
"""

# Scenarios and ranges of targets of the tasks, by their names.
NAMED = {
    "HangingMass": (HANGING_MASS, {"length_m": (0.070, 0.090)}),
    "Joint": (JOINT, {"angle_rad": (radians(-30.0), radians(30.0))}),
    "Leg": (
        LEG,
        {
            "hip.angle_rad": (radians(-25.0), radians(25.0)),
            "knee.angle_rad": (radians(-70.0), radians(-20.0)),
        },
    ),
    "Arm": (
        ARM,
        {
            "shoulder.angle_rad": (radians(-10.0), radians(30.0)),
            "elbow.angle_rad": (radians(5.0), radians(60.0)),
            "wrist.angle_rad": (radians(-20.0), radians(20.0)),
        },
    ),
}
