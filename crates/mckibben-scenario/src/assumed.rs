//! Assumed parameters of a scenario: those of presets that are marked as assumed, and defaults whose source
//! says so, where the file does not give its own.
//!
//! A program that prints results lists them with the results. Checked by the tests below.

use crate::choice::{LoadKind, ValveKind};
use crate::document::{Document, Value};
use crate::keys::{self, KEYS, Key};
use crate::muscle::BRAID;
use crate::presets::{self, Preset};
use crate::quantity;
use crate::read::flow_path::{EXHAUST, SUPPLY};
use crate::read::{SEATS, describes_braid, gives_braid, gives_law};
use mckibben::parameter::{self as p, Parameter};

/// A number that is in force and that no source states.
#[derive(Clone, Debug, PartialEq)]
pub struct Assumed {
    /// What it is the value of.
    pub parameter: &'static Parameter,
    /// The value with its unit.
    pub text: String,
    /// On what ground it was chosen.
    pub source: &'static str,
    /// Name of the preset that gives it, or `None` for a default.
    pub preset: Option<&'static str>,
}

impl Document {
    /// The assumed numbers that are in force, in the order of the table of keys. Of a document that has mistakes, as far
    /// as it can be read.
    pub fn assumed(&self) -> Vec<Assumed> {
        let documents: Vec<Self> = if self.is_plant() {
            self.named(keys::ACTUATORS).into_iter().map(|(name, _)| self.of_actuator(name)).collect()
        } else if self.is_word("load.kind", LoadKind::AntagonisticJoint.name()) {
            vec![self.clone(), self.antagonist()]
        } else {
            return self.assumed_of_one();
        };
        // What stands for one supply has the sections of nothing else.
        let supplies = if self.is_plant() { self.named(keys::SUPPLIES) } else { Vec::new() };
        let of_supplies = supplies.into_iter().flat_map(|(name, _)| self.of_supply(name).assumed_of_one());
        let of_supplies = of_supplies.filter(|assumed| assumed.parameter.key.starts_with("supply."));
        // Of several actuators and supplies those of any, each value once.
        let mut all: Vec<Assumed> = Vec::new();
        for assumed in documents.iter().flat_map(Self::assumed_of_one).chain(of_supplies) {
            let is_known = |known: &Assumed| known.parameter.key == assumed.parameter.key && known.text == assumed.text;
            if !all.iter().any(is_known) {
                all.push(assumed);
            }
        }
        all
    }

    fn assumed_of_one(&self) -> Vec<Assumed> {
        KEYS.iter().filter(|key| self.is_left_out(key)).filter_map(|key| self.stand_in(key.parameter()?)).collect()
    }

    /// The named actuator that gives what the file leaves out: the one it names, or the default where the file does
    /// not describe a braid.
    pub fn actuator_preset(&self) -> Option<&'static Preset> {
        match self.said("actuator.preset") {
            Some(name) => presets::actuator(name),
            None if describes_braid(|path| self.contains(path)) => None,
            None => presets::ACTUATORS.first().copied(),
        }
    }

    /// The named valve that gives what the file leaves out.
    pub fn valve_preset(&self) -> Option<&'static Preset> {
        self.said("valve.preset").and_then(presets::valve)
    }

    /// The word of the presets that the file names for a path, where they are in force.
    pub(crate) fn preset_word(&self, path: &str) -> Option<&'static str> {
        match path.split('.').next() {
            Some("actuator") => self.actuator_preset().filter(|preset| gives_law(self, preset))?.word(path),
            _ => None,
        }
    }

    /// The word that stands at a path.
    pub(crate) fn said(&self, path: &str) -> Option<&str> {
        match &self.entry(path)?.node.value {
            Value::String(word) => Some(word),
            _ => None,
        }
    }

    /// Whether a key applies and is not given, and nothing that the file gives says the same in another way.
    fn is_left_out(&self, key: &Key) -> bool {
        let optional = ["supply", "valve", "hose", "command", "tendon"];
        let section = key.section().split('.').next().unwrap_or_default();
        if self.contains(key.path) || (optional.contains(&section) && !self.contains(section)) {
            return false;
        }
        if let Some(when) = key.when {
            let default = || keys::key_at(when.key).and_then(|selector| selector.default);
            if !self
                .said(when.key)
                .or_else(|| self.preset_word(when.key))
                .or_else(default)
                .is_some_and(|word| when.words.contains(&word))
            {
                return false;
            }
        }
        match key.path {
            // A polynomial or a table stands in place of the constant.
            path if path == p::EFFECTIVENESS.key => {
                ![&p::EFFECTIVENESS_POLYNOMIAL, &p::EFFECTIVENESS_PRESSURE].iter().any(|row| self.contains(row.key))
            }
            // Silence about friction is no zero, unless friction is described in another way.
            path if path == p::VISCOUS.key => !self.contains(p::STRUCTURAL_DAMPING.key),
            path if path == p::COULOMB_WIDTH.key => {
                let others = [p::COULOMB_FORCE.key, p::COULOMB_FORCE_PER_PRESSURE.key, "actuator.friction.hysteresis"];
                !others.iter().any(|key| self.contains(key))
            }
            // Without a fall there is no velocity over which friction falls.
            path if path == p::STRIBECK_VELOCITY.key => self.contains(p::STATIC_RATIO.key),
            // Neither a pressure regulator nor a proportional spool has seats.
            path if SEATS.contains(&path) => {
                let without = [ValveKind::PressureRegulator, ValveKind::ProportionalSpool].map(ValveKind::name);
                !self.said("valve.kind").is_some_and(|kind| without.contains(&kind))
            }
            // A supply has the temperature of what feeds it.
            path if path == p::SUPPLY_TEMPERATURE.key => !self.contains("supplies.*.from"),
            // What describes a reservoir or a compressor more closely.
            path if path == p::RESERVOIR_INDEX.key => self.contains(p::RESERVOIR_VOLUME.key),
            path if path == p::CLEARANCE.key => self.contains(p::DISPLACEMENT.key),
            // Without a derivative there is nothing to filter.
            path if path == p::DERIVATIVE_FILTER.key => self.contains(p::DERIVATIVE_TIME.key),
            path if path.starts_with("valve.") => self.is_in_force(path),
            _ => true,
        }
    }

    /// Whether a key of the valve that is not given belongs to the way in which its flow paths are stated: by the file,
    /// or as a whole by the preset.
    fn is_in_force(&self, path: &str) -> bool {
        let given = |row: &Parameter| self.contains(row.key);
        let preset = |row: &Parameter| self.valve_preset().is_some_and(|preset| preset.get(row).is_some());
        let (by_file, exhaust_by_file) = (SUPPLY.begun(given), EXHAUST.begun(given));
        for (rows, replaced) in [(&SUPPLY, by_file), (&EXHAUST, by_file || exhaust_by_file)] {
            if rows.pressure_drop_ratio.key == path {
                let by_water = |gives: &dyn Fn(&Parameter) -> bool| gives(rows.kv) || gives(rows.cv);
                return by_water(&given) || (!replaced && by_water(&preset));
            }
            if let Some(way) = rows.ways().into_iter().find(|way| way.iter().any(|row| row.key == path)) {
                // Of what the preset gives whole, the file may give a part.
                return !replaced || (way.iter().any(|row| given(row)) && way.iter().all(|row| preset(row)));
            }
        }
        true
    }

    /// The greatest or least length where nothing states it.
    fn range(&self, row: &'static Parameter, at: usize, source: &'static str) -> Option<Assumed> {
        let value = self.muscle()?.assumed()[at]?;
        // Six digits suffice for a length; it is computed from the file's.
        let short = format!("{value:.5e}").parse().unwrap_or(value);
        Some(Assumed { parameter: row, text: quantity::format(short, row.unit), source, preset: None })
    }

    /// The preset's or the table's value of a parameter, when it is assumed.
    fn stand_in(&self, row: &'static Parameter) -> Option<Assumed> {
        let range = match row.key {
            key if key == p::MAX_LENGTH.key => self.range(row, 0, "assumed: the length at rest"),
            key if key == p::MIN_LENGTH.key => self.range(row, 1, "assumed: b/sqrt(3), the neutral angle"),
            // A preset's braid is taken over with the file's keys or not at all.
            key if BRAID.iter().any(|of| of.key == key) && !gives_braid(self, self.actuator_preset()) => return None,
            _ => None,
        };
        if range.is_some() {
            return range;
        }
        let preset = match row.key.split('.').next() {
            // A preset's law of force goes whole, with its bladder.
            Some("actuator") if ["actuator.force.", "actuator.bladder."].iter().any(|of| row.key.starts_with(of)) => {
                self.actuator_preset().filter(|preset| gives_law(self, preset))
            }
            Some("actuator") => self.actuator_preset(),
            Some("valve") => self.valve_preset(),
            _ => None,
        };
        if let Some((preset, value)) = preset.and_then(|preset| Some((preset, preset.get(row)?))) {
            let text = value.text.to_owned();
            return value.assumed.then_some(Assumed {
                parameter: row,
                text,
                source: value.source,
                preset: Some(preset.name),
            });
        }
        let default = row.default.filter(|_| row.source.contains("assumed"))?;
        let text = quantity::format(default, row.unit);
        Some(Assumed { parameter: row, text, source: row.source, preset: None })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys_of(text: &str) -> Vec<&'static str> {
        let document = Document::parse(text, "muscle.toml").expect("TOML");
        document.assumed().iter().map(|assumed| assumed.parameter.key).collect()
    }

    #[test]
    fn the_default_preset_brings_its_assumptions() {
        let found = keys_of("[load]\nkind = \"isometric\"");
        let expected = [
            "actuator.thread_length",
            "actuator.turns",
            "actuator.min_length",
            "actuator.external_volume",
            "actuator.effectiveness.constant",
            "actuator.limit.stiffness",
            "actuator.limit.damping",
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn silence_about_friction_and_delays_is_an_assumption() {
        let friction = |keys: &str| {
            let own = "thread_length = \"11 cm\"\nturns = 2.5\nmax_length = \"9 cm\"";
            let found = keys_of(&format!("[actuator]\n{own}\n[actuator.friction]\n{keys}"));
            ["viscous", "coulomb_width"].map(|key| found.contains(&format!("actuator.friction.{key}").as_str()))
        };
        assert_eq!(friction(""), [true, true]);
        assert_eq!(friction("viscous = \"0 N*s/m\""), [false, true]);
        assert_eq!(friction("structural_damping = \"2 ms\"\ncoulomb_force = \"3 N\""), [false, false]);
        let valve = keys_of(
            "[valve]\nsonic_conductance = \"1 L/(s*bar)\"\ncritical_pressure_ratio = 0.4\nopening_delay = \"4 ms\"",
        );
        assert!(valve.contains(&"valve.closing_delay") && !valve.contains(&"valve.opening_delay"), "{valve:?}");
        assert!(!keys_of("[valve]\npreset = \"matrix-eight-channel\"").contains(&"valve.opening_delay"));
    }

    #[test]
    fn what_the_file_gives_is_not_assumed() {
        let own = "[actuator]\nthread_length = \"11 cm\"\nturns = 2.5\nmax_length = \"9 cm\"\nexternal_volume = \"1 mL\"\n\
                   [actuator.effectiveness]\npolynomial = [1.0]\n[actuator.limit]\nstiffness = \"1e5 N/m\"";
        assert_eq!(
            keys_of(own),
            [
                "actuator.min_length",
                "actuator.friction.viscous",
                "actuator.friction.coulomb_width",
                "actuator.limit.damping",
            ]
        );
    }

    #[test]
    fn lengths_that_a_muscle_at_rest_leaves_open_are_assumed() {
        let rest = "[actuator]\nlength = \"200 mm\"\ndiameter = \"10 mm\"\nbraid_angle = \"60 deg\"\n\
                    external_volume = \"1 mL\"\neffectiveness.constant = 1\nlimit.stiffness = \"1e5 N/m\"\n\
                    limit.damping = \"1 N*s/m\"\nfriction.viscous = \"0 N*s/m\"\nfriction.coulomb_width = \"0 m\"";
        let document = Document::parse(rest, "muscle.toml").expect("TOML");
        let found: Vec<_> = document.assumed().into_iter().map(|of| (of.parameter.key, of.text, of.source)).collect();
        let expected = [
            ("actuator.max_length", "0.2 m".to_owned(), "assumed: the length at rest"),
            ("actuator.min_length", "0.23094 m".to_owned(), "assumed: b/sqrt(3), the neutral angle"),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn each_muscle_of_several_has_its_own() {
        let text = "[load]\nkind = \"antagonistic-joint\"\n[antagonist.actuator]\nlength = \"150 mm\"\ndiameter = \"8 mm\"\n\
                    braid_angle = \"25 deg\"";
        let document = Document::parse(text, "joint.toml").expect("TOML");
        let longest = |of: &Assumed| (of.parameter.key == p::MAX_LENGTH.key).then(|| of.text.clone());
        let found: Vec<String> = document.assumed().iter().filter_map(longest).collect();
        // The paper states that of the first.
        assert_eq!(found, ["0.15 m"]);
    }

    #[test]
    fn named_supplies_have_those_of_a_supply() {
        let text = "[supplies.tank]\ngauge_pressure = \"6 bar\"\nreservoir_volume = \"1 L\"\n\
                    compressor_displacement = \"10 L/min\"\ncut_in_gauge_pressure = \"5 bar\"\n\
                    cut_out_gauge_pressure = \"7 bar\"\n[load]\nkind = \"isometric\"\n[actuators.one]\n";
        let found = keys_of(text);
        for key in [p::SUPPLY_TEMPERATURE.key, p::RESERVOIR_INDEX.key, p::CLEARANCE.key] {
            assert_eq!(found.iter().filter(|its| **its == key).count(), 1, "{key} in {found:?}");
        }
    }

    #[test]
    fn a_supply_that_another_feeds_assumes_no_temperature() {
        let text = "[supplies.tank]\ngauge_pressure = \"6 bar\"\ntemperature = \"310 K\"\nreservoir_volume = \"1 L\"\n\
                    [supplies.manifold]\nfrom = \"tank\"\nreservoir_volume = \"20 mL\"\ninlet.flow_area = \"1 mm^2\"\n\
                    [load]\nkind = \"isometric\"\n[actuators.one]\nsupply = \"manifold\"\n";
        assert!(!keys_of(text).contains(&p::SUPPLY_TEMPERATURE.key), "{:?}", keys_of(text));
    }

    #[test]
    fn a_valve_brings_the_defaults_of_valve_and_supply() {
        let found = keys_of("[supply]\ngauge_pressure = \"1 bar\"\n[valve]\npreset = \"matrix-eight-channel\"");
        assert!(found.contains(&"supply.temperature") && found.contains(&"valve.laminar_ratio"), "{found:?}");
        assert!(!found.contains(&"valve.efficiency"));
    }
}
