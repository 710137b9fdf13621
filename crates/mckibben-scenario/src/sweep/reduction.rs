//! The numbers that a run is reduced to: names, meanings, units and columns. The runner computes them.
//!
//! A reduction is a statistic of a quantity over the whole run, named `length.final`. Not every pair has a meaning: a
//! velocity that starts and ends at zero has no total change for an overshoot to be a share of.

use super::axis::column_of;
use crate::choice::{Choice, Word};
use mckibben::control;

/// What is reduced.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Quantity {
    /// Distance between the attachments in m.
    Length,
    /// Velocity of lengthening in m/s.
    Velocity,
    /// Absolute pressure in the actuator in Pa.
    AbsolutePressure,
    /// Gauge pressure in Pa.
    GaugePressure,
    /// Mass of the actuator's air in kg.
    AirMass,
    /// Temperature of the actuator's air in K.
    Temperature,
    /// Tension in N.
    Tension,
    /// Mass flow into the actuator in kg/s.
    MassFlow,
    /// Air of the supply in kg; of a joint, of both actuators.
    Air,
    /// Exergy of the air that was supplied, of both actuators of a joint.
    Exergy,
    /// Angle of a joint in rad.
    Angle,
    /// Angular velocity of a joint in rad/s.
    AngularVelocity,
    /// Torque of both actuators on a joint in N·m.
    Torque,
    /// Stiffness in N·m/rad that both actuators give a joint with their valves shut.
    Stiffness,
    /// Distance in m between the attachments of a joint's second actuator; those above are of the first.
    AntagonistLength,
    /// Absolute pressure in it in Pa.
    AntagonistAbsolutePressure,
    /// Gauge pressure in a joint's antagonist in Pa.
    AntagonistGaugePressure,
    /// Mass of its air in kg.
    AntagonistAirMass,
    /// Its tension in N.
    AntagonistTension,
    /// How far a controller misses what it is to reach, as its sensors show it at its sampling instants.
    Error(control::Quantity),
}

/// How it is reduced.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Statistic {
    /// Value at the end of the run.
    Final,
    /// Mean over time.
    Mean,
    /// Least value.
    Min,
    /// Greatest value.
    Max,
    /// Greatest less least value over the last whole period of the pulse-width modulation; over the last tenth of the run
    /// without one.
    Ripple,
    /// How much the least or the greatest value changed from the interval of the ripple before to the last: small against the ripple
    /// where the run has settled.
    Drift,
    /// First time in s after which the value stays within 2 % of its total change of its final value.
    SettlingTime,
    /// Share of the total change by which the value passes its final value.
    Overshoot,
    /// Greatest magnitude.
    Peak,
    /// Root mean square.
    Rms,
    /// Amount drawn from the supply.
    Used,
    /// Work on the load over what was supplied.
    Efficiency,
}

macro_rules! name {
    (Final) => {
        "final"
    };
    (Mean) => {
        "mean"
    };
    (Min) => {
        "min"
    };
    (Max) => {
        "max"
    };
    (Ripple) => {
        "ripple"
    };
    (Drift) => {
        "drift"
    };
    (SettlingTime) => {
        "settling_time"
    };
    (Overshoot) => {
        "overshoot"
    };
    (Peak) => {
        "peak"
    };
    (Rms) => {
        "rms"
    };
    (Used) => {
        "used"
    };
    (Efficiency) => {
        "efficiency"
    };
}

impl Statistic {
    /// The statistics that any series of numbers has.
    pub const OF_SERIES: [Self; 9] = [
        Self::Final,
        Self::Mean,
        Self::Min,
        Self::Max,
        Self::Ripple,
        Self::Drift,
        Self::SettlingTime,
        Self::Overshoot,
        Self::Peak,
    ];

    /// Whether it has a meaning on an orbit; if not, it says something of the way there, and is always of the run.
    pub const fn is_of_orbit(self) -> bool {
        match self {
            Self::Final | Self::Mean | Self::Min | Self::Max | Self::Ripple | Self::Drift | Self::Peak => true,
            Self::SettlingTime | Self::Overshoot | Self::Rms | Self::Used | Self::Efficiency => false,
        }
    }

    /// As it stands in the name of a reduction.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Final => name!(Final),
            Self::Mean => name!(Mean),
            Self::Min => name!(Min),
            Self::Max => name!(Max),
            Self::Ripple => name!(Ripple),
            Self::Drift => name!(Drift),
            Self::SettlingTime => name!(SettlingTime),
            Self::Overshoot => name!(Overshoot),
            Self::Peak => name!(Peak),
            Self::Rms => name!(Rms),
            Self::Used => name!(Used),
            Self::Efficiency => name!(Efficiency),
        }
    }
}

/// A statistic of a quantity.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub struct Reduction {
    /// What is reduced.
    pub quantity: Quantity,
    /// How.
    pub statistic: Statistic,
}

macro_rules! meaning {
    (Final, $of:literal) => {
        concat!("Final ", $of, ".")
    };
    (Mean, $of:literal) => {
        concat!("Mean over time of the ", $of, ".")
    };
    (Min, $of:literal) => {
        concat!("Least ", $of, ".")
    };
    (Max, $of:literal) => {
        concat!("Greatest ", $of, ".")
    };
    (Ripple, $of:literal) => {
        concat!(
            "Greatest less least ",
            $of,
            " over the last whole PWM period, or the last tenth of the run without PWM."
        )
    };
    (Drift, $of:literal) => {
        concat!("Change of the ends of the ", $of, " from the interval of the ripple before to the last.")
    };
    (SettlingTime, $of:literal) => {
        concat!(
            "First time after which the ",
            $of,
            " stays within 2 % of its total change of its final value; the duration where it still changes at the end."
        )
    };
    (Overshoot, $of:literal) => {
        concat!("Share of its total change by which the ", $of, " passes its final value.")
    };
    (Peak, $of:literal) => {
        concat!("Greatest magnitude of the ", $of, ".")
    };
    (Rms, $of:literal) => {
        concat!("Root mean square of the ", $of, ".")
    };
    (Efficiency, $of:literal) => {
        concat!("Work on the load over the ", $of, " that was supplied; none where none was.")
    };
    (Used, $of:literal) => {
        concat!("Mass of the ", $of, " drawn from the supply.")
    };
}

macro_rules! quantity {
    ($quantity:ident) => {
        Quantity::$quantity
    };
    ((Error $regulated:ident)) => {
        Quantity::Error(control::Quantity::$regulated)
    };
}

macro_rules! reductions {
    ($($quantity:tt $name:literal, $of:literal: $($statistic:ident)+;)+) => {
        impl Reduction {
            /// Every reduction that has a meaning.
            pub const ALL: &'static [Self] =
                &[$($(Self { quantity: quantity!($quantity), statistic: Statistic::$statistic }),+),+];

            /// As it is written in a scenario file, such as `length.final`.
            pub const fn name(self) -> &'static str {
                match (self.quantity, self.statistic) {
                    $($((quantity!($quantity), Statistic::$statistic) => {
                        concat!($name, ".", name!($statistic))
                    })+)+
                    _ => "",
                }
            }
        }

        impl Word for Reduction {
            const CHOICES: &'static [Choice] = &[$($(Choice {
                name: concat!($name, ".", name!($statistic)),
                meaning: meaning!($statistic, $of),
            }),+),+];

            fn from_name(name: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|reduction| reduction.name() == name)
            }
        }
    };
}

reductions! {
    Length "length", "length": Final Mean Min Max Ripple Drift SettlingTime Overshoot;
    Velocity "velocity", "velocity": Final Mean Min Max Ripple Drift Peak;
    AbsolutePressure "absolute_pressure", "absolute pressure": Final Mean Min Max Ripple Drift SettlingTime Overshoot;
    GaugePressure "gauge_pressure", "gauge pressure": Final Mean Min Max Ripple Drift SettlingTime Overshoot;
    AirMass "air_mass", "mass of the actuator's air": Final Mean Min Max Ripple Drift SettlingTime Overshoot;
    Temperature "temperature", "temperature of the actuator's air": Final Mean Min Max Ripple Drift SettlingTime Overshoot;
    Tension "tension", "tension": Final Mean Min Max Ripple Drift SettlingTime Overshoot Peak;
    MassFlow "mass_flow", "mass flow into the actuator": Final Mean Min Max Ripple Drift Peak;
    Air "air", "air": Used;
    Exergy "exergy", "exergy of the air": Efficiency;
    Angle "angle", "angle of the joint": Final Mean Min Max Ripple Drift SettlingTime Overshoot Peak;
    AngularVelocity "angular_velocity", "angular velocity of the joint": Final Mean Min Max Ripple Drift Peak;
    Torque "torque", "torque of both actuators": Final Mean Min Max Ripple Drift SettlingTime Overshoot Peak;
    Stiffness "stiffness", "stiffness that both actuators give the joint with their valves shut":
        Final Mean Min Max Ripple Drift SettlingTime Overshoot;
    AntagonistLength "antagonist_length", "length of the antagonist": Final Mean Min Max Ripple Drift SettlingTime Overshoot;
    AntagonistAbsolutePressure "antagonist_absolute_pressure", "absolute pressure in the antagonist":
        Final Mean Min Max Ripple Drift SettlingTime Overshoot;
    AntagonistGaugePressure "antagonist_gauge_pressure", "gauge pressure in the antagonist":
        Final Mean Min Max Ripple Drift SettlingTime Overshoot;
    AntagonistAirMass "antagonist_air_mass", "mass of the antagonist's air":
        Final Mean Min Max Ripple Drift SettlingTime Overshoot;
    AntagonistTension "antagonist_tension", "tension of the antagonist":
        Final Mean Min Max Ripple Drift SettlingTime Overshoot Peak;
    (Error Pressure) "gauge_pressure_error", "error of the gauge pressure at the controller's samples": Rms Peak;
    (Error Length) "length_error", "error of the length at the controller's samples": Rms Peak;
    (Error AirMass) "air_mass_error", "error of the mass of air at the controller's samples": Rms Peak;
    (Error Force) "force_error", "error of the tension at the controller's samples": Rms Peak;
    (Error Angle) "angle_error", "error of the angle at the controller's samples": Rms Peak;
    (Error Stiffness) "stiffness_error", "error of the stiffness at the controller's samples": Rms Peak;
}

impl Quantity {
    /// Whether a joint alone has it.
    pub const fn is_of_joint(self) -> bool {
        use Quantity::{
            Angle, AngularVelocity, AntagonistAbsolutePressure, AntagonistAirMass, AntagonistGaugePressure,
            AntagonistLength, AntagonistTension,
        };
        matches!(
            self,
            Angle
                | AngularVelocity
                | Self::Torque
                | Self::Stiffness
                | AntagonistLength
                | AntagonistAbsolutePressure
                | AntagonistGaugePressure
                | AntagonistAirMass
                | AntagonistTension
                | Self::Error(control::Quantity::Angle | control::Quantity::Stiffness | control::Quantity::Torque)
        )
    }
}

impl Reduction {
    /// The words that a scenario file may name.
    pub const CHOICES: &'static [Choice] = <Self as Word>::CHOICES;

    /// SI unit; empty for a pure number.
    pub const fn unit(self) -> &'static str {
        match (self.quantity, self.statistic) {
            (_, Statistic::SettlingTime) => "s",
            (_, Statistic::Overshoot) | (Quantity::Exergy, _) => "",
            (Quantity::Length | Quantity::AntagonistLength, _) => "m",
            (Quantity::Velocity, _) => "m/s",
            (
                Quantity::AbsolutePressure
                | Quantity::GaugePressure
                | Quantity::AntagonistAbsolutePressure
                | Quantity::AntagonistGaugePressure,
                _,
            ) => "Pa",
            (Quantity::AirMass | Quantity::Air | Quantity::AntagonistAirMass, _) => "kg",
            (Quantity::Temperature, _) => "K",
            (Quantity::Tension | Quantity::AntagonistTension, _) => "N",
            (Quantity::Angle, _) => "rad",
            (Quantity::AngularVelocity, _) => "rad/s",
            (Quantity::Torque, _) => "N*m",
            (Quantity::Stiffness, _) => "N*m/rad",
            (Quantity::MassFlow, _) => "kg/s",
            (Quantity::Error(of), _) => match of {
                control::Quantity::Pressure => "Pa",
                control::Quantity::Length => "m",
                control::Quantity::AirMass => "kg",
                control::Quantity::Force => "N",
                control::Quantity::Angle => "rad",
                control::Quantity::Torque => "N*m",
                control::Quantity::Stiffness => "N*m/rad",
            },
        }
    }

    /// Name of the column in a table, such as `length_final_m`.
    pub fn column(self) -> String {
        column_of(self.name(), self.unit())
    }
}

/// What is recorded of each run when the file does not say.
pub(super) const DEFAULT: &[Reduction] = {
    use Quantity::{Air, GaugePressure, Length, Tension, Velocity};
    use Statistic::{Final, Max, Mean, Min, Overshoot, Peak, Ripple, SettlingTime, Used};
    const fn of(quantity: Quantity, statistic: Statistic) -> Reduction {
        Reduction { quantity, statistic }
    }
    &[
        of(Length, Final),
        of(Length, Mean),
        of(Length, Min),
        of(Length, Max),
        of(Length, Ripple),
        of(Length, SettlingTime),
        of(Length, Overshoot),
        of(Velocity, Peak),
        of(GaugePressure, Final),
        of(GaugePressure, Max),
        of(Tension, Final),
        of(Tension, Peak),
        of(Air, Used),
    ]
};

/// The reductions of a joint by default.
pub(super) const DEFAULT_OF_JOINT: &[Reduction] = {
    use Quantity::{Air, Angle, AngularVelocity, AntagonistGaugePressure, GaugePressure, Stiffness, Torque};
    use Statistic::{Final, Max, Mean, Min, Overshoot, Peak, Ripple, SettlingTime, Used};
    const fn of(quantity: Quantity, statistic: Statistic) -> Reduction {
        Reduction { quantity, statistic }
    }
    &[
        of(Angle, Final),
        of(Angle, Mean),
        of(Angle, Min),
        of(Angle, Max),
        of(Angle, Ripple),
        of(Angle, SettlingTime),
        of(Angle, Overshoot),
        of(AngularVelocity, Peak),
        of(Torque, Peak),
        of(Stiffness, Final),
        of(GaugePressure, Final),
        of(AntagonistGaugePressure, Final),
        of(Air, Used),
    ]
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_columns() {
        let column = |name: &str| Reduction::from_name(name).map(Reduction::column);
        for (name, expected) in [
            ("length.final", "length_final_m"),
            ("length.settling_time", "length_settling_time_s"),
            ("length.overshoot", "length_overshoot"),
            ("tension.peak", "tension_peak_n"),
            ("velocity.peak", "velocity_peak_m_s"),
            ("mass_flow.max", "mass_flow_max_kg_s"),
            ("gauge_pressure.ripple", "gauge_pressure_ripple_pa"),
            ("temperature.min", "temperature_min_k"),
            ("air.used", "air_used_kg"),
            ("exergy.efficiency", "exergy_efficiency"),
            ("length_error.rms", "length_error_rms_m"),
            ("gauge_pressure_error.peak", "gauge_pressure_error_peak_pa"),
        ] {
            assert_eq!(column(name).as_deref(), Some(expected));
        }
        assert_eq!(column("velocity.overshoot"), None);
    }

    #[test]
    fn every_default_is_a_reduction_and_names_are_unique() {
        let defaults = [DEFAULT, DEFAULT_OF_JOINT].concat();
        assert!(defaults.iter().all(|reduction| Reduction::ALL.contains(reduction)));
        assert!(DEFAULT.iter().all(|reduction| !reduction.quantity.is_of_joint()));
        for (index, reduction) in Reduction::ALL.iter().enumerate() {
            assert!(Reduction::ALL[..index].iter().all(|other| other.name() != reduction.name()));
            assert_eq!(Reduction::CHOICES[index].name, reduction.name());
        }
    }
}
