//! The actuator and its air.
//!
//! A file that gives none of thread length, turns and greatest length means the default preset. One that gives some of
//! them without naming a preset must give all three. A preset's `min_length` belongs to its thread length and is
//! not taken over when the file overrides that one; `b/sqrt(3)` then stands in.

use super::{alternative, columns, friction};
use crate::choice::{BladderForm, ForceLaw, ProcessKind};
use crate::diagnostic::{Class, Diagnostic};
use crate::presets::{self, Preset};
use crate::reader::Reader;
use crate::scenario::{Actuator, Air, Bladder, Effectiveness, Force, Limit, Process, Taper, TonduLopezCoefficients};
use mckibben::parameter::{self as p, Parameter};

/// The keys that together say how long the braid is; giving none of them asks for the default preset.
pub(crate) static GEOMETRY: [&Parameter; 3] = [&p::THREAD_LENGTH, &p::TURNS, &p::MAX_LENGTH];

pub(super) fn actuator(r: &mut Reader<'_>) -> Actuator {
    let preset = if r.has("actuator.preset") {
        r.chosen("actuator.preset", presets::ACTUATOR_CHOICES).and_then(presets::actuator)
    } else if GEOMETRY.iter().any(|row| r.has(row.key)) {
        None
    } else {
        presets::ACTUATORS.first().copied()
    };
    // A preset that is misspelt is one mistake; the values it would have given are not three more.
    let stand_in = presets::ACTUATORS.first().copied().filter(|_| r.has("actuator.preset"));
    let preset = preset.or(stand_in);
    let [thread_length, turns, max_length] = GEOMETRY.map(|row| r.value(row, preset));
    let own_thread = r.has(p::THREAD_LENGTH.key);
    let of_preset = preset.filter(|_| !own_thread).and_then(|preset| preset.get(&p::MIN_LENGTH));
    let min_length = r.number(&p::MIN_LENGTH).or_else(|| of_preset.and_then(|value| value.value()));
    Actuator {
        thread_length,
        turns,
        max_length,
        min_length: min_length.unwrap_or(thread_length / 3_f64.sqrt()),
        external_volume: r.value(&p::EXTERNAL_VOLUME, preset),
        leakage: r.number(&p::LEAKAGE),
        wall_thickness: r.value(&p::WALL_THICKNESS, preset),
        taper: r.has("actuator.taper").then(|| taper(r)),
        force: force(r),
        bladder: r.has("actuator.bladder").then(|| bladder(r)).flatten(),
        effectiveness: effectiveness(r, preset),
        friction: friction::friction(r, preset),
        limit: Limit { stiffness: r.value(&p::LIMIT_STIFFNESS, preset), damping: r.value(&p::LIMIT_DAMPING, preset) },
    }
}

fn force(r: &mut Reader<'_>) -> Force {
    match r.word("actuator.force.law").unwrap_or(ForceLaw::IdealBraid) {
        ForceLaw::IdealBraid => Force::IdealBraid,
        ForceLaw::TonduLopez => {
            let rows = [&p::INITIAL_RADIUS, &p::TONDU_LOPEZ_A, &p::TONDU_LOPEZ_B];
            let given = alternative(r, &[&rows.map(|row| row.key)]);
            let coefficients = given.map(|_| {
                let [radius, a, b] = rows.map(|row| r.noted(row));
                TonduLopezCoefficients { radius, a, b }
            });
            Force::TonduLopez {
                end_factor: r.value(&p::END_FACTOR, None),
                end_factor_rise: r.value(&p::END_FACTOR_RISE, None),
                end_factor_pressure: r.value(&p::END_FACTOR_PRESSURE, None),
                coefficients,
            }
        }
        ForceLaw::Sarosi => Force::Sarosi(sarosi(r)),
        ForceLaw::MartensBoblan => {
            Force::MartensBoblan { membrane_thickness: r.value(&p::MEMBRANE_THICKNESS, None), modulus: modulus(r) }
        }
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
fn modulus(r: &mut Reader<'_>) -> [f64; 4] {
    let help = "give c0 to c3 of c0 + c1 L + c2 L^2 + c3 L^3";
    let [c0, c1, c2, c3] = coefficients(r, &p::MEMBRANE_MODULUS, "four", help);
    let [modulus, length] = units(r, [("actuator.force.modulus_unit", "Pa"), ("actuator.force.length_unit", "m")]);
    let per_length = modulus / length;
    [c0 * modulus, c1 * per_length, c2 * per_length / length, c3 * per_length / (length * length)]
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

/// Units that must be named, each like the one beside it, as their size in SI.
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

fn bladder(r: &mut Reader<'_>) -> Option<Bladder> {
    let path = "actuator.bladder.form";
    let form: Option<BladderForm> = r.word(path);
    if !r.has(path) {
        r.missing(path, "");
    }
    let force = r.value(&p::BLADDER_FORCE, None);
    let form = form?;
    let scale = if form == BladderForm::Linear { 1.0 } else { r.value(&p::BLADDER_SCALE, None) };
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
