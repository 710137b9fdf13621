//! The actuator and its air.
//!
//! A file that describes no braid means the default preset. One that describes a braid without naming a preset must describe all
//! of it: see `muscle`. A preset's braid goes with the file's keys where both are of one kind; where the file describes the
//! muscle at rest and the preset does not, or where its own keys are enough, the preset's braid is not taken over. A preset's
//! `min_length` belongs to its thread length; `b/sqrt(3)` stands in where the file has its own. A preset's law of static force,
//! with its bladder, is taken over unless the file names another law.

use super::{alternative, columns, friction};
use crate::choice::{BladderForm, ForceLaw, LoadKind, ProcessKind};
use crate::diagnostic::{Class, Diagnostic, Place};
use crate::document::Document;
use crate::follow::least_length;
use crate::keys;
use crate::muscle::{self, AT_REST, BRAID, Fault, Muscle, REMEDY, Stated};
use crate::presets::{self, Preset};
use crate::quantity;
use crate::reader::{Reader, list_of};
use crate::scenario::{Actuator, Air, Bladder, Effectiveness, Force, Limit, Process, Taper, TonduLopezCoefficients};
use mckibben::parameter::{self as p, Parameter};

/// Whether some key describes a braid; none stands for the default preset.
pub(crate) fn describes_braid(has: impl Fn(&str) -> bool) -> bool {
    BRAID.iter().chain([&&p::MAX_LENGTH]).any(|row| has(row.key))
}

/// Whether keys describe a whole braid, so that no preset is meant in addition.
pub(crate) fn describes_whole_braid(has: impl Fn(&Parameter) -> bool) -> bool {
    AT_REST.iter().any(|row| has(row)) || [&p::THREAD_LENGTH, &p::TURNS, &p::MAX_LENGTH].into_iter().all(has)
}

pub(super) fn actuator(r: &mut Reader<'_>) -> Actuator {
    let preset = r.document().actuator_preset();
    if r.has("actuator.preset") {
        r.chosen("actuator.preset", presets::ACTUATOR_CHOICES);
    }
    // A preset that is misspelt is one mistake; the values it would have given are not three more.
    let stand_in = presets::ACTUATORS.first().copied().filter(|_| r.has("actuator.preset"));
    let preset = preset.or(stand_in);
    let [thread_length, turns, max_length, min_length] = braid(r, preset);
    let of_law = preset.filter(|preset| gives_law(r.document(), preset));
    Actuator {
        thread_length,
        turns,
        max_length,
        min_length,
        external_volume: r.value(&p::EXTERNAL_VOLUME, preset),
        leakage: r.number(&p::LEAKAGE),
        wall_thickness: r.value(&p::WALL_THICKNESS, preset),
        taper: r.has("actuator.taper").then(|| taper(r)),
        force: force(r, of_law),
        bladder: bladder(r, of_law),
        effectiveness: effectiveness(r, preset),
        friction: friction::friction(r, preset),
        limit: Limit { stiffness: r.value(&p::LIMIT_STIFFNESS, preset), damping: r.value(&p::LIMIT_DAMPING, preset) },
    }
}

/// Thread length, turns, greatest and least length; where a mistake has been noted, stand-ins for them.
fn braid(r: &mut Reader<'_>, preset: Option<&Preset>) -> [f64; 4] {
    let stated = stated(r, preset);
    if !stated.is_at_rest() && !AT_REST.iter().any(|row| r.has(row.key)) {
        // Only the model's own numbers are given, or some of them: then the default preset is no more meant without a word.
        let named = presets::ACTUATORS.first().filter(|_| preset.is_none()).map(|preset| {
            let name = preset.name;
            format!("or give `actuator.preset = \"{name}\"`, the muscle of a file that describes none, under your own numbers")
        });
        let [thread_length, turns, max_length] = [&p::THREAD_LENGTH, &p::TURNS, &p::MAX_LENGTH]
            .map(|row| r.value_or(row, stated.get(row), named.as_deref()));
        let min_length = stated.get(&p::MIN_LENGTH).unwrap_or_else(|| least_length(thread_length));
        return [thread_length, turns, max_length, min_length];
    }
    // A key that is mistaken itself says nothing about the others.
    let unread = |row: &&Parameter| (r.has(row.key) && stated.get(row).is_none()) || r.is_meant(row.key);
    if BRAID.iter().any(unread) {
        return [1.0; 4];
    }
    match stated.muscle() {
        Ok(Muscle { thread_length, turns, max_length, min_length, .. }) => {
            [thread_length, turns, max_length, min_length]
        }
        Err(fault) => {
            note(r, fault, stated);
            [1.0; 4]
        }
    }
}

/// What the file and the preset state of the braid.
fn stated(r: &mut Reader<'_>, preset: Option<&Preset>) -> Stated {
    let own = Stated::new(|row| r.number(row));
    let at_rest = AT_REST.iter().any(|row| r.has(row.key));
    let of_preset = |row: &Parameter| preset.and_then(|preset| preset.get(row)).and_then(|value| value.value());
    let takes_over = gives_braid(r.document(), preset);
    let own_thread = r.has(p::THREAD_LENGTH.key);
    Stated::new(|row| {
        own.get(row).or_else(|| {
            let taken = match row.key {
                key if key == p::MAX_LENGTH.key => !at_rest,
                key if key == p::MIN_LENGTH.key => !(at_rest || own_thread),
                _ => takes_over,
            };
            (taken && !r.has(row.key)).then(|| of_preset(row)).flatten()
        })
    })
}

/// Whether a preset's braid goes with the keys of a document.
pub(crate) fn gives_braid(document: &Document, preset: Option<&Preset>) -> bool {
    let is_at_rest = preset.is_some_and(|preset| AT_REST.iter().any(|row| preset.get(row).is_some()));
    let at_rest = AT_REST.iter().any(|row| document.contains(row.key));
    let enough = muscle::determine(|row| document.contains(row.key));
    if is_at_rest { !enough } else { !at_rest }
}

/// Whether a preset's law of static force is that of a document.
pub(crate) fn gives_law(document: &Document, preset: &Preset) -> bool {
    match (document.said(LAW), preset.word(LAW)) {
        (Some(own), Some(given)) => own == given,
        (own, given) => own.is_none() && given.is_some(),
    }
}

/// Notes that what is stated gives no braid, where it stands.
fn note(r: &mut Reader<'_>, fault: Fault, stated: Stated) {
    let names = |rows: &[&'static Parameter]| list_of(rows.iter().map(|row| name(row)));
    match fault {
        Fault::Open { one_of, two_of } => {
            let given: Vec<&'static Parameter> = stated.keys().collect();
            let verb = if given.len() == 1 { "does" } else { "do" };
            let title = format!("{} alone {verb} not determine the braid", names(&given));
            let help = match one_of.is_empty() {
                false => format!("add one of {}", names(&one_of)),
                true => format!("add two of {}, or thread_length and turns", names(&two_of)),
            };
            let place = given.iter().find_map(|row| r.key_place(row.key));
            r.note(shown_at(r, Class::Missing, place, title, "more is needed").help(help));
        }
        Fault::Contradiction { of, value, requirement, others } => {
            let due = shown(requirement.value, requirement.unit);
            let title = format!("`{}` = {} contradicts the rest", of.key, shown(value, of.unit));
            let label = format!("{} {} {due}", requirement.relation, requirement.other);
            let place = r.value_place(of.key).or_else(|| r.value_place("actuator.preset"));
            let mut found = shown_at(r, Class::Inconsistent, place, title, label);
            for other in others {
                let (place, label) = match r.value_place(other.key) {
                    Some(place) => (Some(place), format!("with this {}", name(other))),
                    None => (r.value_place("actuator.preset"), format!("which gives {}", name(other))),
                };
                found = found.related(place, label);
            }
            r.note(found.help(REMEDY));
        }
    }
}

/// A mistake at a place, or in the section of the actuator.
fn shown_at(r: &Reader<'_>, class: Class, place: Option<Place>, title: String, label: impl Into<String>) -> Diagnostic {
    match place.or_else(|| r.key_place("actuator")) {
        Some(place) => Diagnostic::at(class, place, title, label),
        None => Diagnostic::whole(class, r.document().source().name(), title),
    }
}

/// A value in six digits, an angle in degrees.
fn shown(value: f64, unit: &str) -> String {
    let (value, unit) = if unit == "rad" { (value.to_degrees(), "deg") } else { (value, unit) };
    quantity::format(format!("{value:.5e}").parse().unwrap_or(value), unit)
}

/// The last name of a key.
fn name(row: &Parameter) -> &'static str {
    row.key.rsplit('.').next().unwrap_or(row.key)
}

impl Document {
    /// What is stated of the braid, by the file or its preset. Of a document that has mistakes, as far as it can be read.
    pub(crate) fn stated_braid(&self) -> Stated {
        let preset = self.actuator_preset();
        stated(&mut Reader::of_section(self, "actuator"), preset)
    }

    /// The muscle that a file of one actuator describes: its braid at rest, computed from what is stated. `None` where that is
    /// not enough or contradicts itself.
    pub fn muscle(&self) -> Option<Muscle> {
        self.stated_braid().muscle().ok()
    }

    /// Every muscle that the file describes, with its name: of a plant that of the actuator, of a joint `agonist` and `antagonist`,
    /// else `muscle`.
    pub fn muscles(&self) -> Vec<(String, Muscle)> {
        let named = |name: &str, document: &Self| document.muscle().map(|muscle| (name.to_owned(), muscle));
        let found = if self.is_plant() {
            self.named(keys::ACTUATORS).into_iter().map(|(name, _)| named(name, &self.of_actuator(name))).collect()
        } else if self.is_word("load.kind", LoadKind::AntagonisticJoint.name()) {
            vec![named("agonist", self), named("antagonist", &self.antagonist())]
        } else {
            vec![named("muscle", self)]
        };
        found.into_iter().flatten().collect()
    }
}

const LAW: &str = "actuator.force.law";

fn force(r: &mut Reader<'_>, preset: Option<&Preset>) -> Force {
    match r.word_or(LAW, preset).unwrap_or(ForceLaw::IdealBraid) {
        ForceLaw::IdealBraid => Force::IdealBraid,
        ForceLaw::TonduLopez => {
            let rows = [&p::INITIAL_RADIUS, &p::TONDU_LOPEZ_A, &p::TONDU_LOPEZ_B];
            let of_preset = preset.filter(|preset| rows.iter().all(|row| preset.get(row).is_some()));
            let given = match of_preset {
                Some(_) => true,
                None => alternative(r, &[&rows.map(|row| row.key)]).is_some(),
            };
            let coefficients = given.then(|| {
                let [radius, a, b] = rows.map(|row| r.value(row, of_preset));
                TonduLopezCoefficients { radius, a, b }
            });
            Force::TonduLopez {
                end_factor: r.value(&p::END_FACTOR, preset),
                end_factor_rise: r.value(&p::END_FACTOR_RISE, preset),
                end_factor_pressure: r.value(&p::END_FACTOR_PRESSURE, preset),
                coefficients,
            }
        }
        ForceLaw::Sarosi => Force::Sarosi(sarosi(r)),
        ForceLaw::MartensBoblan => Force::MartensBoblan {
            membrane_thickness: r.value(&p::MEMBRANE_THICKNESS, preset),
            modulus: modulus(r, preset),
        },
        ForceLaw::ExtensibleBraid => Force::ExtensibleBraid { thread_stiffness: r.value(&p::THREAD_STIFFNESS, None) },
        ForceLaw::Bolen => Force::Bolen {
            max_force: r.value(&p::MAX_FORCE, None),
            max_pressure: r.value(&p::MAX_PRESSURE, None),
            max_contraction: r.value(&p::MAX_CONTRACTION, None),
            shape: coefficients(
                r,
                &p::BOLEN_SHAPE,
                "three",
                "give s0, s1 and s2 of s0 (e^(-s1 x) - 1) + p e^(-s2 x^2)",
            ),
        },
        ForceLaw::Polynomial => polynomial(r),
        ForceLaw::Map => {
            let [gauge_pressure, length, tension] = [&p::MAP_PRESSURE, &p::MAP_LENGTH, &p::MAP_TENSION].map(|row| {
                if !r.has(row.key) {
                    r.missing(row.key, "");
                }
                r.list(row).unwrap_or_default()
            });
            Force::Map { gauge_pressure, length, tension }
        }
    }
}

/// The coefficients of Sárosi's law for pressures in Pa and forces in N.
fn sarosi(r: &mut Reader<'_>) -> [f64; 6] {
    let help = "give a1 to a6 of (a1 p + a2) e^(a3 c) + a4 c p + a5 p + a6";
    let [a1, a2, a3, a4, a5, a6] = coefficients(r, &p::SAROSI_COEFFICIENTS, "six", help);
    let [pressure, force] = units(r, [("actuator.force.pressure_unit", "Pa"), ("actuator.force.force_unit", "N")]);
    let per_pressure = force / pressure;
    [a1 * per_pressure, a2 * force, a3, a4 * per_pressure, a5 * per_pressure, a6 * force]
}

/// A polynomial law for pressures in Pa and forces in N.
fn polynomial(r: &mut Reader<'_>) -> Force {
    if !r.has(p::PRESSURE_COEFFICIENTS.key) {
        r.missing(p::PRESSURE_COEFFICIENTS.key, "");
    }
    let [mut pressure, mut passive] =
        [&p::PRESSURE_COEFFICIENTS, &p::PASSIVE_COEFFICIENTS].map(|row| r.list(row).unwrap_or_default());
    let [pressure_unit, force] = units(r, [("actuator.force.pressure_unit", "Pa"), ("actuator.force.force_unit", "N")]);
    pressure.iter_mut().for_each(|a| *a *= force / pressure_unit);
    passive.iter_mut().for_each(|b| *b *= force);
    Force::Polynomial { pressure, passive }
}

/// The coefficients of the membrane's modulus for lengths in m.
fn modulus(r: &mut Reader<'_>, preset: Option<&Preset>) -> [f64; 4] {
    let help = "give c0 to c3 of c0 + c1 L + c2 L^2 + c3 L^3";
    // Coefficients of the file's own need units of the file's own.
    let of_preset = preset.filter(|_| !r.has(p::MEMBRANE_MODULUS.key)).and_then(Preset::modulus);
    of_preset.unwrap_or_else(|| {
        let coefficients = coefficients(r, &p::MEMBRANE_MODULUS, "four", help);
        let units = units(r, [("actuator.force.modulus_unit", "Pa"), ("actuator.force.length_unit", "m")]);
        presets::modulus_in_si(coefficients, units)
    })
}

/// A list that must be there with its `count` entries; zeros, with the mistake noted, where it has not.
fn coefficients<const N: usize>(r: &mut Reader<'_>, row: &'static Parameter, count: &str, help: &str) -> [f64; N] {
    if !r.has(row.key) {
        r.missing(row.key, "");
    }
    let Some(list) = r.list(row) else { return [0.0; N] };
    <[f64; N]>::try_from(list.as_slice()).unwrap_or_else(|_| {
        if let Some(place) = r.value_place(row.key) {
            let title = format!("`{}` has {} entries instead of {count}", row.key, list.len());
            r.note(Diagnostic::at(Class::BadList, place, title, format!("{count} entries are expected")).help(help));
        }
        [0.0; N]
    })
}

/// Units that must be named, as their size in SI.
fn units(r: &mut Reader<'_>, units: [(&str, &str); 2]) -> [f64; 2] {
    units.map(|(path, like)| {
        if !r.has(path) {
            r.missing(path, "");
        }
        r.unit(path, like).unwrap_or(1.0)
    })
}

fn taper(r: &mut Reader<'_>) -> Taper {
    Taper { end_radius: r.value(&p::TAPER_END_RADIUS, None), length_ratio: r.value(&p::TAPER_LENGTH_RATIO, None) }
}

fn bladder(r: &mut Reader<'_>, preset: Option<&Preset>) -> Option<Bladder> {
    let path = "actuator.bladder.form";
    let preset = preset.filter(|preset| preset.word(path).is_some());
    if !r.has("actuator.bladder") && preset.is_none() {
        return None;
    }
    // A bladder of another form is the file's own.
    let preset = preset.filter(|preset| r.document().said(path).is_none_or(|own| preset.word(path) == Some(own)));
    let form: Option<BladderForm> = r.word_or(path, preset);
    if !r.has(path) && preset.is_none() {
        r.missing(path, "");
    }
    let force = r.value(&p::BLADDER_FORCE, preset);
    let form = form?;
    let scale = if form == BladderForm::Linear { 1.0 } else { r.value(&p::BLADDER_SCALE, preset) };
    Some(Bladder { form, force, scale })
}

const PRESSURE_UNIT: &str = "actuator.effectiveness.pressure_unit";

fn effectiveness(r: &mut Reader<'_>, preset: Option<&Preset>) -> Effectiveness {
    let constant = [p::EFFECTIVENESS.key];
    let polynomial = [p::EFFECTIVENESS_POLYNOMIAL.key, PRESSURE_UNIT];
    let table = [p::EFFECTIVENESS_PRESSURE.key, p::EFFECTIVENESS_VALUE.key];
    match alternative(r, &[&constant, &polynomial, &table]) {
        Some(1) => {
            let unit = r.unit(PRESSURE_UNIT, "Pa").unwrap_or(1.0);
            let coefficients = r.list(&p::EFFECTIVENESS_POLYNOMIAL).unwrap_or_default();
            let scaled = coefficients.iter().zip(0_i32..).map(|(coefficient, k)| coefficient / unit.powi(k));
            let scaled: Vec<f64> = scaled.collect();
            // Only a unit of absurd size can do this to a finite coefficient.
            if let Some(place) = r.value_place(PRESSURE_UNIT).filter(|_| scaled.iter().any(|e| !e.is_finite())) {
                let title = "the coefficients per pascal do not fit 64-bit numbers";
                r.note(
                    Diagnostic::at(Class::OutOfRange, place, title, "this unit is too small").help("use psi or kPa"),
                );
            }
            Effectiveness::Polynomial(scaled)
        }
        Some(2) => {
            let gauge_pressure = r.list(&p::EFFECTIVENESS_PRESSURE);
            let value = r.list(&p::EFFECTIVENESS_VALUE);
            let (gauge_pressure, value) =
                columns(r, &p::EFFECTIVENESS_PRESSURE, gauge_pressure, p::EFFECTIVENESS_VALUE.key, value);
            Effectiveness::Table { gauge_pressure, value }
        }
        _ => Effectiveness::Constant(r.value(&p::EFFECTIVENESS, preset)),
    }
}

pub(super) fn air(r: &mut Reader<'_>) -> Air {
    let kind = r.word("air.process").unwrap_or(ProcessKind::Isentropic);
    let process = match kind {
        ProcessKind::Isentropic => Process::Isentropic,
        ProcessKind::Isothermal => Process::Isothermal,
        ProcessKind::Polytropic => Process::Polytropic { index: r.value(&p::POLYTROPIC_INDEX, None) },
        ProcessKind::EnergyBalance => Process::EnergyBalance {
            heat_transfer: r.value(&p::HEAT_TRANSFER, None),
            wall_temperature: r.value(&p::WALL_TEMPERATURE, None),
        },
    };
    Air {
        process,
        atmospheric_pressure: r.value(&p::ATMOSPHERIC_PRESSURE, None),
        gas_constant: r.value(&p::GAS_CONSTANT, None),
        heat_capacity_ratio: r.value(&p::HEAT_CAPACITY_RATIO, None),
    }
}
