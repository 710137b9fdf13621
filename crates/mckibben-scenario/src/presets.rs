//! Named actuators and valves: for every number its text, its source, and whether it is assumed.
//!
//! The valves are in [`VALVES`], measured muscles in `muscles`. Only hardware whose numbers are published is here. The paper (Colbrunn, Nelson & Quinn, 2001, "Modeling of Braided
//! Pneumatic Actuators for Robotic Control") states its actuator's stretched length, diameter, friction and valve, but
//! not thread length, turns, effectiveness, hose volume or the stiffness of the taut braid: those are marked as
//! assumed, and no agreement with a figure of the paper may be claimed on their strength. Taking the stated 1/4 in as
//! the braid's diameter at full stretch gives `b² = L_max² + (0.25 in · π n)²`.
//!
//! Checked by `tests/tables.rs`: every text parses, in its parameter's range, and the relation above holds.

mod muscles;
mod valves;

use crate::choice::Choice;
use crate::quantity;
use mckibben::parameter::{self as p, Parameter};

pub use muscles::{DMSP_10_250, DMSP_20_300};
pub use valves::{VALVE_CHOICES, VALVES};

/// One number of a preset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PresetValue {
    /// What it is the value of.
    pub parameter: &'static Parameter,
    /// The value with its unit, as the source writes it.
    pub text: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// Whether no source states it and it was chosen.
    pub assumed: bool,
}

impl PresetValue {
    /// The value in the parameter's SI unit, or `None` of a list and when the text is faulty, which a test rules out.
    pub fn value(&self) -> Option<f64> {
        self.read(self.text)
    }

    /// The values of a list, written `[1, 2, 3]`; `None` of a single value.
    pub fn list(&self) -> Option<Vec<f64>> {
        let items = self.text.strip_prefix('[')?.strip_suffix(']')?;
        items.split(',').map(|item| self.read(item.trim())).collect()
    }

    fn read(&self, text: &str) -> Option<f64> {
        let read = quantity::parse(text).ok()?;
        self.parameter.check(read.value).ok()
    }
}

/// A named set of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// As it is written in a scenario file.
    pub name: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// The words it sets, as pairs of path and word.
    pub words: &'static [(&'static str, &'static str)],
    /// The numbers it sets.
    pub values: &'static [PresetValue],
}

impl Preset {
    /// The preset's value of a parameter.
    pub fn get(&self, parameter: &Parameter) -> Option<&'static PresetValue> {
        self.values.iter().find(|value| value.parameter.key == parameter.key)
    }

    /// The preset's word for a path.
    pub fn word(&self, path: &str) -> Option<&'static str> {
        self.words.iter().find_map(|(of, word)| (*of == path).then_some(*word))
    }

    /// The coefficients of the modulus of its wall over the length in m, in Pa, Pa/m, Pa/m² and Pa/m³, where it has such a wall.
    pub fn modulus(&self) -> Option<[f64; 4]> {
        let coefficients = <[f64; 4]>::try_from(self.get(&p::MEMBRANE_MODULUS)?.list()?).ok()?;
        let units = ["actuator.force.modulus_unit", "actuator.force.length_unit"].map(|path| self.unit(path));
        Some(modulus_in_si(coefficients, units))
    }

    /// The size in SI of the unit that the preset names at a path.
    pub(crate) fn unit(&self, path: &str) -> f64 {
        // A test reads every unit of a preset.
        self.word(path).and_then(|unit| quantity::parse_unit(unit).ok()).map_or(1.0, |(_, size)| size)
    }
}

/// The coefficients of a wall's modulus in SI from those in units of modulus and length.
pub(crate) fn modulus_in_si([c0, c1, c2, c3]: [f64; 4], [modulus, length]: [f64; 2]) -> [f64; 4] {
    let per_length = modulus / length;
    [c0 * modulus, c1 * per_length, c2 * per_length / length, c3 * per_length / (length * length)]
}

/// A number that the source states.
const fn stated(parameter: &'static Parameter, text: &'static str, source: &'static str) -> PresetValue {
    PresetValue { parameter, text, source, assumed: false }
}

/// A number that was chosen.
const fn assumed(parameter: &'static Parameter, text: &'static str, source: &'static str) -> PresetValue {
    PresetValue { parameter, text, source, assumed: true }
}

/// The paper's actuator.
pub static COLBRUNN_2001: Preset = Preset {
    name: "colbrunn-2001",
    meaning: "The actuator of Colbrunn, Nelson & Quinn (2001), with assumed values where the paper is silent.",
    words: &[],
    values: &[
        assumed(&p::THREAD_LENGTH, "4.3218 in", "assumed: follows from n and the paper's 1/4 in diameter at 3.85 in"),
        assumed(&p::TURNS, "2.5", "assumed: 2.0 to 2.8 lets it hold the paper's 15 lb at 60 psi"),
        stated(&p::MAX_LENGTH, "3.85 in", "paper, its stretched length"),
        assumed(&p::MIN_LENGTH, "2.4952 in", "assumed: b/sqrt(3)"),
        assumed(&p::EXTERNAL_VOLUME, "3 cm^3", "assumed: the paper gives no hose volume"),
        assumed(&p::EFFECTIVENESS, "1", "assumed: the paper's figure is not at hand"),
        stated(&p::VISCOUS, "0.02 lbf*s/in", "paper, average of its ring-down tests"),
        stated(&p::COULOMB_WIDTH, "0.0044 in", "paper, average of its ring-down tests"),
        assumed(&p::LIMIT_STIFFNESS, "1.75e5 N/m", "assumed: the paper gives no value"),
        assumed(&p::LIMIT_DAMPING, "100 N*s/m", "assumed: the paper gives no value"),
    ],
};

/// Every named actuator; the first is taken when a file describes none.
pub static ACTUATORS: &[&Preset] = &[&COLBRUNN_2001, &DMSP_10_250, &DMSP_20_300];

/// The words of `actuator.preset`.
pub static ACTUATOR_CHOICES: &[Choice] = &[word(&COLBRUNN_2001), word(&DMSP_10_250), word(&DMSP_20_300)];

const fn word(preset: &'static Preset) -> Choice {
    Choice { name: preset.name, meaning: preset.meaning }
}

/// The actuator of this name.
pub fn actuator(name: &str) -> Option<&'static Preset> {
    ACTUATORS.iter().copied().find(|preset| preset.name == name)
}

/// The valve of this name.
pub fn valve(name: &str) -> Option<&'static Preset> {
    VALVES.iter().copied().find(|preset| preset.name == name)
}
