//! The parameters that a leg has beside those of the scenario file.

use crate::parameter::{Parameter, Range, parameters};

parameters! {
    /// Every row.
    TABLE:
    SEGMENT_LENGTH = "leg.segment_length", "l", "m", Range::POSITIVE, None,
        "Length of thigh or shank, from joint to joint or to the foot.", "elementary mechanics", "give a length above zero";
    SEGMENT_MASS = "leg.segment_mass", "M", "kg", Range::POSITIVE, None,
        "Mass of thigh or shank.", "elementary mechanics", "give a mass above zero";
    MOMENT_ARM = "leg.moment_arm", "R", "m", Range::FINITE, None,
        "Moment arm of an actuator about hip or knee, positive where it turns the joint forward.",
        "elementary mechanics", "give a finite length, zero where the actuator does not span the joint";
    BELT_DEPTH = "leg.belt_depth", "h", "m", Range::POSITIVE, None,
        "How far the belt is under the hip.", "elementary mechanics", "give a depth above zero";
    BELT_VELOCITY = "leg.belt_velocity", "u", "m/s", Range::FINITE, None,
        "Velocity of the belt, forward.", "elementary mechanics", "give a finite velocity";
    BELT_STIFFNESS = "leg.belt_stiffness", "k_b", "N/m", Range::POSITIVE, None,
        "Stiffness of belt and foot together.", "elementary mechanics", "give a stiffness above zero";
    BELT_DAMPING = "leg.belt_damping", "c_b", "N*s/m", Range::NON_NEGATIVE, None,
        "Damping of belt and foot together.", "elementary mechanics", "give zero or more";
    BELT_FRICTION = "leg.belt_friction", "mu", "", Range::NON_NEGATIVE, None,
        "Coefficient of dry friction of the foot on the belt.", "Coulomb", "give zero or more";
    SLIPPING_SPEED = "leg.slipping_speed", "v_s", "m/s", Range::POSITIVE, None,
        "Speed at which the foot slips on the belt.", "stand-in for sticking", "give a small speed above zero";
}
