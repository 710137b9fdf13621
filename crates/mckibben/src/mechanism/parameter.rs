//! The parameters that only mechanisms have.

use crate::parameter::{Parameter, Range, parameters};

parameters! {
    /// Every row.
    TABLE:
    SPRING_STIFFNESS = "load.spring_stiffness", "k", "N/m", Range::NON_NEGATIVE, None,
        "Stiffness of a spring that pulls the mass towards a distance.",
        "Hooke", "give zero or more";
    SPRING_REST_LENGTH = "load.spring_rest_length", "q_0", "m", Range::FINITE, None,
        "Distance between the actuator's attachments at which that spring is relaxed.",
        "Hooke", "give a finite length";
    ATTACHMENT = "mechanism.attachment", "p", "m", Range::FINITE, None,
        "Place of an attachment along and across its segment.",
        "elementary mechanics", "give finite lengths";
    SEGMENT_LENGTH = "mechanism.segment_length", "l", "m", Range::POSITIVE, None,
        "Length of a segment of a chain, from joint to joint or to the foot.", "elementary mechanics", "give a length above zero";
    BELT_DEPTH = "mechanism.belt_depth", "h", "m", Range::POSITIVE, None,
        "How far the belt is under the first joint.", "elementary mechanics", "give a depth above zero";
    BELT_VELOCITY = "mechanism.belt_velocity", "u", "m/s", Range::FINITE, None,
        "Velocity of the belt, forward.", "elementary mechanics", "give a finite velocity";
    BELT_STIFFNESS = "mechanism.belt_stiffness", "k_b", "N/m", Range::POSITIVE, None,
        "Stiffness of belt and foot together.", "elementary mechanics", "give a stiffness above zero";
    BELT_DAMPING = "mechanism.belt_damping", "c_b", "N*s/m", Range::NON_NEGATIVE, None,
        "Damping of belt and foot together.", "elementary mechanics", "give zero or more";
    BELT_FRICTION = "mechanism.belt_friction", "mu", "", Range::NON_NEGATIVE, None,
        "Coefficient of dry friction of the foot on the belt.", "Coulomb", "give zero or more";
    SLIPPING_SPEED = "mechanism.slipping_speed", "v_s", "m/s", Range::POSITIVE, None,
        "Speed at which the foot slips on the belt.", "stand-in for sticking", "give a small speed above zero";
}
