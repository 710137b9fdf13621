//! What `mckibben-batch` takes a plant's steps in lanes with, `mckibben-identify` its searches, and `mckibben-run` the rounding of
//! instants. It may change with every version, and is no part of the interface.

pub use crate::convert::Convert;
pub use crate::root::lowest;
pub use crate::straight::StraightLine;
pub use crate::trigonometry::{cosine, sine};
pub use crate::valve::solenoid::{SIMULTANEOUS, is_due};
#[cfg(feature = "alloc")]
pub use of_plants::*;

#[cfg(feature = "alloc")]
mod of_plants {
    pub use crate::engine::GuardForm;
    pub use crate::friction::{Branch, SlidingState, ThreadContact};
    pub use crate::mechanism::chain::{MAX_JOINTS, Presses};
    pub use crate::network::flow::{NetworkState, OrificeEnds, SquaredDrive};
    pub use crate::network::formulas::FlowFormulas;
    pub use crate::network::guard::NetworkGuard;
    pub use crate::network::implicit::RegulatedResponse;
    pub use crate::network::mode::NetworkMode;
    pub use crate::network::piping::Orifice;
    pub use crate::plant::dense::dot;
    pub use crate::plant::evaluation::{Evaluation, System, Unit};
    pub use crate::plant::formulas::Formulas;
    pub use crate::plant::guard::FASTEST;
    pub use crate::plant::sliding::Facet;
    pub use crate::plant::steps::{
        MOST_AIR, NO_ACTUATOR, Stages, check_longest_part, check_move, host_mechanisms, part_end, parts_of,
    };
    pub use crate::plant::tendon::{is_damped as end_is_damped, tension as tendon_tension};
    pub use crate::plant::wire::Wire;
    pub use crate::simulation::member::Trace;
    pub use crate::valve::Approach;
}
