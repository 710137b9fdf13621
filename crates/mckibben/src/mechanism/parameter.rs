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
}
