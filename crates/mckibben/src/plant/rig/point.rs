//! Where the rig is linearised: the load in balance, the air at rest or flowing through on average.
//!
//! ```text
//! F_s(L, P_g) + F_limit(L) = W      two of gauge pressure, length and load give the third
//! x = L + ℓ + F/k                   where the load is on a tendon in series
//! m = m₀ (V/V₀) (P/P₀)^(1/κ)        the air mass that keeps P (V/m)^κ of a given state
//! ```

use crate::actuator::Actuator;
use crate::air::{Chamber, Process};
use crate::error::{Error, Requirement};
use crate::force::Statics;
use crate::load::Load;
use crate::parameter;
use crate::pressure::{AbsolutePressure, GaugePressure};
use crate::scalar::Scalar;
use crate::simulation::{Rig, State};

/// What holds the load in balance: two of gauge pressure, length of the actuator and load, the third follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Balance {
    /// The rig's load at a gauge pressure; the length follows.
    AtPressure(GaugePressure),
    /// The rig's load at a length in m; the pressure follows.
    AtLength(f64),
    /// A gauge pressure and a length in m; the load follows: the mass that hangs, or the constant force. Where both ends
    /// are held, nothing does.
    AtBoth(GaugePressure, f64),
}

/// How much air there is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Content {
    /// As much as has this temperature in K at the operating point.
    Temperature(f64),
    /// As much as a process that keeps `P (V/m)^κ` would have coming from this state; under the energy balance, as much
    /// as has that state's temperature.
    Of(State),
}

/// A rig at rest, or under PWM at rest on average.
#[derive(Clone, Debug)]
pub struct OperatingPoint {
    /// The rig, with the load that is in balance.
    pub rig: Rig,
    /// The four states; the velocity is zero.
    pub state: State,
}

impl OperatingPoint {
    /// The point with the valve held shut.
    ///
    /// With heat transfer the air at rest has the wall's temperature, whatever temperature `content` has.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] or [`Error::Inconsistent`] for a number outside the physics; [`Error::NoSolution`] when
    /// there is no balance, when it lies on the shortest length, or when the temperature is not the wall's.
    pub fn held(rig: &Rig, balance: Balance, content: Content) -> Result<Self, Error> {
        let (rig, pressure, length) = balanced(rig, balance)?;
        let mut temperature = None;
        if let Process::EnergyBalance { heat_transfer, wall_temperature } = rig.actuator().air().process()
            && heat_transfer > 0.0
        {
            if matches!(content, Content::Temperature(given) if given != wall_temperature) {
                return Err(Error::Misuse {
                    what: "air that exchanges heat rests at the wall's temperature only",
                    remedy: "leave the temperature out, or give that of air.wall_temperature",
                });
            }
            temperature = Some(Content::Temperature(wall_temperature));
        }
        Self::filled(rig, pressure, length, temperature.unwrap_or(content))
    }

    /// The point at a pressure and a length that are in balance.
    pub(super) fn filled(rig: Rig, pressure: AbsolutePressure, length: f64, content: Content) -> Result<Self, Error> {
        let (air_mass, velocity) = (air_mass(&rig, pressure, length, content)?, 0.0);
        Ok(Self { rig, state: State { length, velocity, pressure, air_mass } })
    }

    /// Whether the process of the air keeps `P (V/m)^κ`.
    pub(super) fn keeps_content(rig: &Rig) -> bool {
        !matches!(rig.actuator().air().process(), Process::EnergyBalance { .. })
    }

    /// Temperature of the air in K.
    pub fn temperature(&self) -> f64 {
        self.rig.actuator().air().temperature(&self.chamber())
    }

    /// The air.
    fn chamber(&self) -> Chamber {
        let State { length, velocity, pressure, air_mass } = self.state;
        self.rig.actuator().chamber(length, velocity, pressure.0, air_mass, false)
    }

    /// Tension in N, without friction.
    pub fn tension(&self) -> f64 {
        self.rig.actuator().tension_sliding(self.state.length, 0.0, self.state.pressure.0, 0.0)
    }

    /// Where the load is, a distance in m, if it hangs on a tendon in series.
    pub fn load_distance(&self) -> Option<f64> {
        let tendon = self.rig.tendon()?;
        Some(self.state.length + tendon.rest_length() + self.tension() / tendon.stiffness())
    }

    /// Gauge pressure.
    pub fn gauge_pressure(&self) -> GaugePressure {
        self.state.pressure.gauge(self.rig.actuator().air().atmosphere())
    }

    /// Coulomb friction `F_c` in N in motion, `Q k_sec` in the paper's law.
    pub fn coulomb_bound(&self) -> f64 {
        self.rig.actuator().coulomb_bound(self.state.length, self.state.pressure.0)
    }

    /// Whether the taut braid carries a part of the load.
    pub fn is_taut(&self) -> bool {
        self.state.length > self.rig.actuator().limits().max_length()
    }
}

/// The air mass in kg at a length (m) and a pressure (Pa) that has the `P (V/m)^κ` of a state.
fn mass_of_content(actuator: &Actuator, state: &State, length: f64, pressure: f64) -> f64 {
    let expansion = actuator.volume(length) / actuator.volume(state.length);
    let compression = Scalar::power(pressure / state.pressure.0, 1.0 / actuator.air().index());
    state.air_mass * expansion * compression
}

/// The air mass in kg.
fn air_mass(rig: &Rig, pressure: AbsolutePressure, length: f64, content: Content) -> Result<f64, Error> {
    let actuator = rig.actuator();
    let at = |temperature| actuator.air().mass(pressure, actuator.volume(length), temperature);
    Ok(match content {
        Content::Temperature(temperature) => at(parameter::INITIAL_TEMPERATURE.check(temperature)?),
        Content::Of(state) if OperatingPoint::keeps_content(rig) => {
            mass_of_content(actuator, &state, length, pressure.0)
        }
        Content::Of(state) => at(OperatingPoint { rig: rig.clone(), state }.temperature()),
    })
}

/// The rig with its load, and the pressure and the length in m at which they balance.
pub(super) fn balanced(rig: &Rig, balance: Balance) -> Result<(Rig, AbsolutePressure, f64), Error> {
    let air = rig.actuator().air();
    if matches!(rig.load(), Load::Prescribed(_)) {
        return Err(Error::NoSolution {
            what: "a prescribed motion has no equilibrium: its length is a function of time",
            remedy: "set load.kind = \"isometric\" to hold the ends, or \"hanging-mass\" to let them move",
        });
    }
    let absolute = |gauge: GaugePressure| {
        parameter::INITIAL_GAUGE_PRESSURE.check(gauge.0)?;
        let pressure = gauge.absolute(air.atmosphere());
        if pressure.0 > 0.0 {
            return Ok(pressure);
        }
        Err(crate::valve::below_vacuum(&parameter::INITIAL_GAUGE_PRESSURE, gauge, air))
    };
    let (rig, pressure, length) = match balance {
        Balance::AtPressure(gauge) => {
            let pressure = absolute(gauge)?;
            (rig.clone(), pressure, rig.equilibrium(pressure)?)
        }
        Balance::AtLength(length) => (rig.clone(), pressure_at(rig, inside(rig, length)?)?, length),
        Balance::AtBoth(gauge, length) => {
            let pressure = absolute(gauge)?;
            (loaded(rig, inside(rig, length)?, pressure)?, pressure, length)
        }
    };
    free(&rig, pressure, length)?;
    Ok((rig, pressure, length))
}

/// Checks that a balance does not lie where the model has a corner.
fn free(rig: &Rig, pressure: AbsolutePressure, length: f64) -> Result<(), Error> {
    let moves = rig.load().inertia().is_some() || rig.tendon().is_some();
    if length <= rig.actuator().limits().min_length() && moves {
        return Err(Error::NoSolution {
            what: "the actuator pulls the load to its shortest length, where it rests on the stop: nothing is linear there",
            remedy: "lower the pressure, or give a heavier load or a longer length",
        });
    }
    if moves && rig.actuator().tension_sliding(length, 0.0, pressure.0, 0.0) <= 0.0 {
        return Err(Error::NoSolution {
            what: "the tendon carries nothing at this point: it goes slack on one side of it",
            remedy: "give a load above zero",
        });
    }
    if let Some(tendon) = rig.tendon()
        && rig.actuator().stiffness(length, pressure) + tendon.stiffness() <= 0.0
    {
        return Err(Error::NoSolution {
            what: "the actuator pulls harder the shorter it gets, and its tendon is too soft to hold it there",
            remedy: "stiffen the tendon, or give a longer length",
        });
    }
    Ok(())
}

/// A length in m between the shortest and the thread's.
fn inside(rig: &Rig, length: f64) -> Result<f64, Error> {
    let (limits, law) = (rig.actuator().limits(), &rig.actuator().law().law);
    parameter::INITIAL_LENGTH.check(length)?;
    let refused = |relation, other, value| {
        let requirement = Requirement { relation, other, value, unit: "m" };
        let remedy = "give a length between the shortest and that of the thread";
        Err(Error::Inconsistent { parameter: &parameter::INITIAL_LENGTH, value: length, requirement, remedy })
    };
    if length < limits.min_length() {
        return refused("must not be less than", parameter::MIN_LENGTH.key, limits.min_length());
    }
    if length >= law.end_length() {
        return refused("must be less than", law.end_name(), law.end_length());
    }
    Ok(length)
}

/// The pressure at which the rig's load is in balance at a length in m.
fn pressure_at(rig: &Rig, length: f64) -> Result<AbsolutePressure, Error> {
    let Some(inertia) = rig.load().inertia() else {
        return Err(Error::NoSolution {
            what: "ends that are held fix no pressure: any pressure is in balance",
            remedy: "give the pressure too",
        });
    };
    let actuator = rig.actuator();
    if actuator.limits().force(length, 0.0) > inertia.pull {
        return Err(Error::NoSolution {
            what: "at this length the taut braid alone pulls harder than the load: no pressure balances it",
            remedy: "give a shorter length or a heavier load",
        });
    }
    match actuator.holding_pressure(inertia.pull, length) {
        Ok(gauge) => Ok(gauge.absolute(actuator.air().atmosphere())),
        Err(_) => Err(Error::NoSolution {
            what: "at this length no pressure lets the actuator hold the load: the braid hardly pulls there",
            remedy: "give a longer length or a lighter load; an ideal braid pulls above thread_length/sqrt(3)",
        }),
    }
}

/// The rig with the load that is in balance at a length in m and a pressure.
fn loaded(rig: &Rig, length: f64, pressure: AbsolutePressure) -> Result<Rig, Error> {
    let actuator = rig.actuator();
    let pull = actuator.static_force(length, pressure.0) + actuator.limits().force(length, 0.0);
    let load = match rig.load() {
        Load::HangingMass { gravity, .. } if *gravity > 0.0 && pull > 0.0 => {
            Load::hanging_mass(pull / gravity, *gravity)?
        }
        Load::HangingMass { .. } => {
            return Err(Error::NoSolution {
                what: "no hanging mass is in balance here: the actuator does not pull, or gravity does not",
                remedy: "give a higher pressure or a longer length, and a load.gravity above zero",
            });
        }
        Load::ConstantForce { mass, .. } => Load::constant_force(*mass, pull)?,
        held => held.clone(),
    };
    Ok(rig.clone().with_load(load))
}
