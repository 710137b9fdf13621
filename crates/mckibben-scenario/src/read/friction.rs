//! The friction of an actuator.

use super::columns;
use crate::choice::HysteresisLaw;
use crate::presets::Preset;
use crate::reader::Reader;
use crate::scenario::{Friction, Hysteresis, Viscoelastic};
use mckibben::parameter::{self as p, Parameter};

pub(super) fn friction(r: &mut Reader<'_>, preset: Option<&Preset>) -> Friction {
    Friction {
        viscous: r.value(&p::VISCOUS, preset),
        structural_damping: r.value(&p::STRUCTURAL_DAMPING, preset),
        coulomb_width: r.value(&p::COULOMB_WIDTH, preset),
        coulomb_force: r.value(&p::COULOMB_FORCE, preset),
        coulomb_force_per_pressure: r.value(&p::COULOMB_FORCE_PER_PRESSURE, preset),
        static_ratio: r.value(&p::STATIC_RATIO, preset),
        stribeck_velocity: r.value(&p::STRIBECK_VELOCITY, preset),
        hysteresis: r.has("actuator.friction.hysteresis").then(|| hysteresis(r)),
        viscoelastic: r.has("actuator.friction.viscoelastic").then(|| viscoelastic(r)),
    }
}

fn viscoelastic(r: &mut Reader<'_>) -> Viscoelastic {
    let (time, ratio) = (&p::BRANCH_RELAXATION_TIME, &p::BRANCH_STIFFNESS_RATIO);
    let given = [&p::BRANCH_STIFFNESS, ratio].map(|row| r.has(row.key));
    for (row, is_missing) in [(time, !r.has(time.key)), (ratio, given == [false; 2])] {
        if is_missing {
            r.missing(row.key, "");
        }
    }
    let relaxation_time = r.list(time);
    let rises = relaxation_time.as_ref().is_none_or(|times| times.is_sorted_by(|one, other| one < other));
    let mut of = |row: &'static Parameter, is_first: bool| {
        let list = r.list(row);
        // Times that do not increase are reported once.
        if list.is_some() && (is_first || rises) {
            return columns(r, time, relaxation_time.clone(), row.key, list).1;
        }
        list.unwrap_or_default()
    };
    let (stiffness, stiffness_ratio) = (of(&p::BRANCH_STIFFNESS, true), of(ratio, !given[0]));
    let initial_stretch = of(&p::BRANCH_INITIAL_STRETCH, false);
    Viscoelastic { relaxation_time: relaxation_time.unwrap_or_default(), stiffness, stiffness_ratio, initial_stretch }
}

fn hysteresis(r: &mut Reader<'_>) -> Hysteresis {
    let rows = [&p::HYSTERESIS_REACH, &p::HYSTERESIS_STIFFNESS_RATIO];
    match r.word("actuator.friction.hysteresis.law").unwrap_or(HysteresisLaw::MaxwellSlip) {
        HysteresisLaw::MaxwellSlip => {
            let [reach, stiffness_ratio] = rows.map(|row| {
                if !r.has(row.key) {
                    r.missing(row.key, "");
                }
                r.list(row)
            });
            let (reach, stiffness_ratio) = columns(r, rows[0], reach, rows[1].key, stiffness_ratio);
            Hysteresis::MaxwellSlip { reach, stiffness_ratio }
        }
        HysteresisLaw::BoucWen => Hysteresis::BoucWen {
            width: r.value(&p::HYSTERESIS_WIDTH, None),
            beta: r.value(&p::HYSTERESIS_BETA, None),
            gamma: r.value(&p::HYSTERESIS_GAMMA, None),
        },
        HysteresisLaw::LuGre => Hysteresis::LuGre {
            width: r.value(&p::HYSTERESIS_WIDTH, None),
            reach: r.value(&p::BRISTLE_REACH, None),
            static_ratio: r.value(&p::BRISTLE_STATIC_RATIO, None),
            stribeck_velocity: r.value(&p::BRISTLE_STRIBECK_VELOCITY, None),
            damping_time: r.value(&p::BRISTLE_DAMPING_TIME, None),
        },
    }
}
