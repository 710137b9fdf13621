//! A scenario with its variables, as the library of a unit reads it from the unit's resources.
//!
//! Description and library number the variables in the order of one text, the canonical one of [`Document::to_toml`], which stands in
//! the resources. The order of a file of a user may differ from it: there a dotted key may stand before a plain one.

use crate::options::UnitOptions;
use crate::variables::Variables;
use mckibben::plant::PlantExchange;
use mckibben_run::failure::Failure;
use mckibben_run::host::{HostPlant, Motion};
use mckibben_run::plant::control;
use mckibben_scenario::{Command, Document, Scenario};
use std::path::Path;

/// The file of the scenario in the resources of a unit.
pub const SCENARIO: &str = "scenario.toml";
/// The file of the options.
pub const OPTIONS: &str = "options.txt";

/// The relative tolerance of a host that gives none.
pub const TOLERANCE: f64 = 1e-6;

/// A scenario with its variables.
#[derive(Clone, Debug)]
pub struct Model {
    document: Document,
    /// The document with set points of zero, since the host commands the valves: a supply may be lower than those of the scenario.
    uncommanded: Document,
    options: UnitOptions,
    variables: Variables,
    /// The plant with the parameters of the scenario.
    plant: HostPlant,
    token: String,
}

impl Model {
    /// Of a document. Where the scenario moves and says no step, the step that its accuracy needs is chosen and kept in it, unless
    /// the unit is for model exchange alone.
    ///
    /// # Errors
    /// Every mistake in the scenario, and an option that does not fit; where no step is accurate enough.
    pub fn new(mut document: Document, options: UnitOptions) -> Result<Self, Failure> {
        // Mistakes are reported at their places in the file of the user.
        let plant = HostPlant::read(&document, &options.of_host())?;
        let is_stepped = options.motion == Motion::Scenario && options.interfaces.has_co_simulation();
        if let (true, Some(step), false) = (is_stepped, plant.step(), document.contains("run.step")) {
            document.set_in_si("step of the unit", "run.step", &format!("{step:?}"))?;
        }
        Self::of_canonical(canonical(&document)?, options)
    }

    /// Of a document whose keys stand in the order of the resources.
    fn of_canonical(document: Document, options: UnitOptions) -> Result<Self, Failure> {
        let plant = HostPlant::read(&document, &options.of_host())?;
        let indicators = PlantExchange::new(plant.steps(), TOLERANCE)?.guard_count();
        let uncommanded = uncommanded(&document, &plant)?;
        let variables = Variables::new(&document, &plant, indicators);
        let token = token_of(&[&document.to_toml(), &options.to_text(), env!("CARGO_PKG_VERSION")]);
        Ok(Self { document, uncommanded, options, variables, plant, token })
    }

    /// From the folder of a unit's resources.
    ///
    /// # Errors
    /// When a file is missing or is not what was written.
    pub fn read(resources: &Path) -> Result<Self, Failure> {
        let path = resources.join(OPTIONS);
        let text = std::fs::read_to_string(&path).map_err(|error| {
            let title = format!("`{}` cannot be read: {error}", path.display());
            Failure::input(title, "give the folder of the unit's resources, unpacked")
        })?;
        let document = Document::load(resources.join(SCENARIO))?;
        Self::of_canonical(canonical(&document)?, UnitOptions::from_text(&text)?)
    }

    /// The scenario.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// What was chosen.
    pub fn options(&self) -> &UnitOptions {
        &self.options
    }

    /// The variables.
    pub fn variables(&self) -> &Variables {
        &self.variables
    }

    /// The plant with the parameters of the scenario, at its start.
    pub fn plant(&self) -> &HostPlant {
        &self.plant
    }

    /// The names of the parts whose controllers the unit leaves out; of a scenario of one actuator or of a joint that of the load.
    pub fn controllers(&self) -> Vec<String> {
        if let Ok(Some(plant)) = self.document.plant_experiment() {
            return plant.controls.iter().map(|its| control::name(&plant, its).to_owned()).collect();
        }
        let is_controlled = |scenario: &Scenario| matches!(scenario.command, Some(Command::Controller(_)));
        let found = self.document.scenario().is_ok_and(|scenario| is_controlled(&scenario));
        if found { vec!["load".to_owned()] } else { Vec::new() }
    }

    /// The identity of this unit: of scenario, options and version.
    pub fn token(&self) -> &str {
        &self.token
    }

    /// The values of the parameters in the scenario, in SI units.
    pub fn parameters(&self) -> Vec<f64> {
        self.variables.parameters.iter().map(|number| number.value).collect()
    }

    /// The plant by other values of the parameters, in SI units.
    ///
    /// # Errors
    /// For a value that the scenario cannot have.
    pub fn build(&self, parameters: &[f64]) -> Result<HostPlant, Failure> {
        let mut document = self.uncommanded.clone();
        let mut is_changed = false;
        for (number, value) in self.variables.parameters.iter().zip(parameters) {
            if number.value.to_bits() != value.to_bits() {
                number.parameter.check(*value)?;
                document.set_in_si("parameter of the unit", &number.path, &format!("{value:?}"))?;
                is_changed = true;
            }
        }
        if is_changed { HostPlant::read(&document, &self.options.of_host()) } else { Ok(self.plant.clone()) }
    }
}

/// A document in which the set points of actuators are zero. Supplies keep theirs, which are part of the plant.
fn uncommanded(document: &Document, plant: &HostPlant) -> Result<Document, Failure> {
    let mut document = document.clone();
    let own = plant.actuators().iter().map(|name| format!("actuators.{name}"));
    for owner in [String::new(), "antagonist".to_owned()].into_iter().chain(own) {
        let key = |key: &str| format!("{owner}.command.{key}").trim_start_matches('.').to_owned();
        if document.contains(&key("gauge_pressure")) {
            for name in ["time", "gauge_pressure"] {
                document.set_in_si("command of the unit", &key(name), "[0.0]")?;
            }
        }
    }
    Ok(document)
}

/// A document whose keys stand in the order of the text that is written to the resources.
fn canonical(document: &Document) -> Result<Document, Failure> {
    Ok(Document::parse(&document.to_toml(), document.source().name())?)
}

/// A token of 32 hexadecimal digits in the form of a GUID (FNV-1a over 128 bits).
fn token_of(parts: &[&str]) -> String {
    const BASIS: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
    let bytes = parts.iter().flat_map(|part| part.bytes().chain([0]));
    let hash = bytes.fold(BASIS, |hash, byte| (hash ^ u128::from(byte)).wrapping_mul(PRIME));
    let digits = format!("{hash:032x}");
    format!("{{{}-{}-{}-{}-{}}}", &digits[..8], &digits[8..12], &digits[12..16], &digits[16..20], &digits[20..])
}
