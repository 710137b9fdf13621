//! The friction of an actuator.

use super::columns;
use crate::choice::HysteresisLaw;
use crate::presets::Preset;
use crate::reader::Reader;
use crate::scenario::{Friction, Hysteresis};
use mckibben::parameter as p;

pub(super) fn friction(r: &mut Reader<'_>, preset: Option<&Preset>) -> Friction {
    Friction {
        viscous: r.value(&p::VISCOUS, preset),
        coulomb_width: r.value(&p::COULOMB_WIDTH, preset),
        coulomb_force: r.value(&p::COULOMB_FORCE, preset),
        coulomb_force_per_pressure: r.value(&p::COULOMB_FORCE_PER_PRESSURE, preset),
        static_ratio: r.value(&p::STATIC_RATIO, preset),
        stribeck_velocity: r.value(&p::STRIBECK_VELOCITY, preset),
        hysteresis: r.has("actuator.friction.hysteresis").then(|| hysteresis(r)),
    }
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
