//! What makes physical sense and is not implemented: one table, from which messages and documentation are made.
//!
//! A combination that makes no sense, such as `hold` of a three-way valve, is [misuse](crate::Error::Misuse) and no limit; a
//! point that does not exist, such as the balance of a load that nothing holds, is [no
//! solution](crate::Error::NoSolution).

use core::fmt::{Display, Formatter, Result};

/// Two features that do not work together yet.
#[derive(Debug, PartialEq, Eq)]
pub struct Limit {
    /// What is not implemented.
    pub feature: &'static str,
    /// With what, beginning with a preposition.
    pub with: &'static str,
    /// What to do instead.
    pub remedy: &'static str,
}

/// A limit without what to do instead.
#[derive(Debug)]
pub struct Title<'l>(&'l Limit);

impl Limit {
    /// What is not implemented with what, without the remedy: for messages that show it apart.
    pub fn title(&self) -> Title<'_> {
        Title(self)
    }
}

impl Display for Title<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Limit { feature, with, .. } = self.0;
        write!(f, "{feature} is not implemented {with}")
    }
}

impl Display for Limit {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, "{}; {}", self.title(), self.remedy)
    }
}

/// A row of the table.
const fn limit(feature: &'static str, with: &'static str, remedy: &'static str) -> Limit {
    Limit { feature, with, remedy }
}

/// Declares the rows and the table of them all.
macro_rules! limits {
    ($($name:ident: $feature:literal, $with:literal, $remedy:literal;)*) => {
        $(#[doc = concat!("Not implemented: ", $feature, " ", $with, ".")]
        pub static $name: Limit = limit($feature, $with, $remedy);)*

        /// All of them, in the order of the documentation.
        pub static LIMITS: &[&Limit] = &[$(&$name),*];
    };
}

limits! {
    PLANT_ANTAGONIST: "`[antagonist]`", "in a file of several actuators",
        "write a chain of one joint with two actuators";
    PLANT_HERE: "a file in which actuators have names", "where one actuator or joint is due",
        "run it with `mckibben simulate`, `sweep`, `linearize` or an `identify` of trajectories, or write a file of one actuator or joint";
    PLANT_HOST: "a scenario in which actuators have names", "in `Actuator`, `Actuators`, `Statics` and derivatives",
        "use `simulate`, `sweep`, `linearize`, `HostedPlant`, `VectorPlant` or an environment, or write a scenario of one actuator or joint";
    PLANT_MODEL: "a controller by the model", "for a joint within a longer chain, with tendons, or with other than one moment arm each",
        "choose \"bang-bang\" or \"pid\", or control the pressures of the actuators";
    REGULATOR_SUPPLY: "a valve of kind \"pressure-regulator\"", "behind a reservoir or a regulator",
        "let it draw from a supply of constant pressure, or choose a valve with seats";
    JOINT_ALONE: "load.kind = \"antagonistic-joint\"", "where one actuator is due",
        "run it with `mckibben simulate`, or choose another load.kind";
    CONTROLLER_HERE: "command.kind = \"controllers\"", "where a command known beforehand is due",
        "run it by `mckibben simulate`, or choose another command.kind";
    CONTROLLER_VALVE: "a controller", "with a valve that is neither three-way nor fill-hold-exhaust",
        "set valve.kind to one of these";
    CONTROLLER_PAIR: "`feed-forward` or `air-mass` on a joint", "for another law of force than the ideal braid's",
        "leave out actuator.force, actuator.bladder, actuator.taper and actuator.wall_thickness";
    PRESSURE_LINEAR: "a linear model by `linearize`",
        "of an actuator on a tendon whose pressure is given and that has no viscous friction",
        "give actuator.friction.viscous, however small: without it the tendon's balance follows the pressure's rate, which is no input";
    SAVE_DRIVERS: "a state as numbers", "where drivers command valves",
        "let the host set the valves; in Rust `PlantSteps::save` keeps a state as it is";
    SAVE_COMMANDS: "a state as numbers", "where more than 64 commands of one valve are on their way",
        "set the valve less often, or shorten valve.dead_time; in Rust `PlantSteps::save` keeps a state as it is";
    COMMON_PERIOD: "settling", "where pulses and sinusoids have no common period of up to a thousand of the fastest pulses",
        "give valve commands, motions and set points frequencies in a ratio of small whole numbers";
    SEGMENTS_JOINT: "a run in segments", "for an antagonistic joint and where actuators have names", "give search.horizon in place of search.segments";
    SEGMENTS_MEMORY: "a run in segments", "for a rig that remembers more than its four states",
        "leave out the air line, the pressure regulator, the tendon or the hysteresis, or run it whole";
}
