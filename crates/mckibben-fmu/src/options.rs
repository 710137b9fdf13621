//! What is chosen when a unit is written; a small file of the unit's resources.
//!
//! ```text
//! motion = host
//! interfaces = model-exchange
//! command_mode = duty
//! pulse_frequency = 25
//! ```

use mckibben_run::failure::Failure;
use mckibben_run::host::{HostOptions, Motion};

/// The version of FMI of a unit.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Version {
    /// FMI 2.0.
    Two,
    /// FMI 3.0.
    Three,
}

/// What a unit offers.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Interfaces {
    /// Co-simulation: the unit has its own engine.
    CoSimulation,
    /// Model exchange: the host integrates.
    ModelExchange,
    /// Both.
    #[default]
    Both,
}

impl Interfaces {
    /// All of them.
    const ALL: [Self; 3] = [Self::CoSimulation, Self::ModelExchange, Self::Both];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::CoSimulation => "co-simulation",
            Self::ModelExchange => "model-exchange",
            Self::Both => "both",
        }
    }

    /// Whether a host may step the unit.
    pub fn has_co_simulation(self) -> bool {
        self != Self::ModelExchange
    }

    /// Whether a host may integrate the unit.
    pub fn has_model_exchange(self) -> bool {
        self != Self::CoSimulation
    }
}

/// How a scenario becomes a plant that a host steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnitOptions {
    /// What moves the ends of the actuators.
    pub motion: Motion,
    /// What the unit offers. No step is chosen for a unit of model exchange alone.
    pub interfaces: Interfaces,
    /// What the numbers are that valves are commanded by; each valve's own where none is chosen.
    pub command_mode: Option<String>,
    /// Frequency of the pulses of a duty cycle in Hz, in place of that of the scenario's PWM.
    pub pulse_frequency: Option<f64>,
    /// The longest part of a step in s; whole steps where none is given.
    pub max_step: Option<f64>,
}

impl UnitOptions {
    /// As the host's plant takes them.
    pub fn of_host(&self) -> HostOptions<'_> {
        HostOptions {
            motion: self.motion,
            command_mode: self.command_mode.as_deref(),
            pulse_frequency: self.pulse_frequency,
            max_step: self.max_step,
            host_integrates: !self.interfaces.has_co_simulation(),
        }
    }

    /// The motion of a name.
    ///
    /// # Errors
    /// For another name than `host` and `scenario`.
    pub fn motion_named(name: &str) -> Result<Motion, Failure> {
        match name {
            "host" => Ok(Motion::Host),
            "scenario" => Ok(Motion::Scenario),
            other => Err(Failure::input(
                format!("motion = \"{other}\" is no motion"),
                "say \"host\" where the host moves the ends, or \"scenario\" where loads and mechanisms of the file do",
            )),
        }
    }

    /// As text.
    pub fn to_text(&self) -> String {
        let motion = if self.motion == Motion::Host { "host" } else { "scenario" };
        let mut text = format!("motion = {motion}\ninterfaces = {}\n", self.interfaces.name());
        for (key, value) in [
            ("command_mode", self.command_mode.clone()),
            ("pulse_frequency", self.pulse_frequency.map(|number| format!("{number:?}"))),
            ("max_step", self.max_step.map(|number| format!("{number:?}"))),
        ] {
            if let Some(value) = value {
                text.push_str(&format!("{key} = {value}\n"));
            }
        }
        text
    }

    /// From text.
    ///
    /// # Errors
    /// For a line that is no option.
    pub fn from_text(text: &str) -> Result<Self, Failure> {
        let mut options = Self::default();
        for line in text.lines().map(str::trim).filter(|line| !line.is_empty()) {
            let refused = || Failure::input(format!("`{line}` is no option of a unit"), "export the unit again");
            let (key, value) = line.split_once('=').ok_or_else(refused)?;
            let (key, value) = (key.trim(), value.trim());
            let number = || value.parse::<f64>().map_err(|_| refused());
            match key {
                "motion" => options.motion = Self::motion_named(value)?,
                "interfaces" => {
                    let named = Interfaces::ALL.into_iter().find(|its| its.name() == value);
                    options.interfaces = named.ok_or_else(refused)?;
                }
                "command_mode" => options.command_mode = Some(value.to_owned()),
                "pulse_frequency" => options.pulse_frequency = Some(number()?),
                "max_step" => options.max_step = Some(number()?),
                _ => return Err(refused()),
            }
        }
        Ok(options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_says_all_options() {
        let options = UnitOptions {
            motion: Motion::Scenario,
            interfaces: Interfaces::ModelExchange,
            command_mode: Some("request".to_owned()),
            pulse_frequency: Some(12.5),
            max_step: Some(1e-4),
        };
        assert_eq!(UnitOptions::from_text(&options.to_text()), Ok(options));
        assert_eq!(UnitOptions::from_text("motion = host\n"), Ok(UnitOptions::default()));
        for wrong in ["motion", "motion = nothing", "interfaces = none", "speed = 3", "max_step = soon"] {
            assert!(UnitOptions::from_text(wrong).is_err(), "{wrong}");
        }
    }
}
