//! Where the quantities of an antagonistic joint stand in the plain scenario, and how its second actuator is set.

use super::Field;
use crate::scenario::{InitialAngle, Joint, Load, MomentArm, Scenario};
use mckibben::parameter as p;
use std::mem::swap;

/// The key of each and its place.
static FIELDS: &[(&str, Field)] = &[
    (p::PULLEY_RADIUS.key, |s| match &mut joint(s)?.tendon.arm {
        MomentArm::Pulley(radius) => Some(radius),
        MomentArm::Table { .. } => None,
    }),
    (p::REST_LENGTH.key, |s| Some(&mut joint(s)?.tendon.rest_length)),
    (p::LIMB_DISTANCE.key, |s| Some(&mut joint(s)?.distance)),
    (p::LIMB_INERTIA.key, |s| Some(&mut joint(s)?.inertia)),
    (p::HANGING_ANGLE.key, |s| Some(&mut joint(s)?.hanging_angle)),
    (p::JOINT_TORQUE.key, |s| Some(&mut joint(s)?.torque)),
    (p::JOINT_DAMPING.key, |s| Some(&mut joint(s)?.damping)),
    (p::MIN_ANGLE.key, |s| joint(s)?.min_angle.as_mut()),
    (p::MAX_ANGLE.key, |s| joint(s)?.max_angle.as_mut()),
    (p::STOP_STIFFNESS.key, |s| Some(&mut joint(s)?.stop_stiffness)),
    (p::STOP_DAMPING.key, |s| Some(&mut joint(s)?.stop_damping)),
    (p::INITIAL_ANGLE.key, |s| match &mut joint(s)?.angle {
        InitialAngle::At(angle) => Some(angle),
        InitialAngle::Equilibrium => None,
    }),
    (p::INITIAL_ANGULAR_VELOCITY.key, |s| Some(&mut joint(s)?.angular_velocity)),
];

/// The place of the quantity with a key.
pub(super) fn field_of(key: &str) -> Option<Field> {
    FIELDS.iter().find(|(of, _)| *of == key).map(|(_, field)| *field)
}

fn joint(s: &mut Scenario) -> Option<&mut Joint> {
    match &mut s.load {
        Load::AntagonisticJoint(joint) => Some(joint),
        _ => None,
    }
}

/// Lets the two actuators of a joint change places; done twice it changes nothing.
pub(crate) fn exchange(scenario: &mut Scenario) {
    let Scenario { actuator, supply, valve, hose, command, pressure, tendon, load, initial, .. } = scenario;
    let Load::AntagonisticJoint(joint) = load else { return };
    let second = &mut *joint.antagonist;
    swap(actuator, &mut second.actuator);
    swap(supply, &mut second.supply);
    swap(valve, &mut second.valve);
    swap(hose, &mut second.hose);
    swap(command, &mut second.command);
    swap(pressure, &mut second.pressure);
    swap(tendon, &mut second.series_tendon);
    swap(&mut joint.tendon, &mut second.tendon);
    swap(&mut initial.gauge_pressure, &mut second.gauge_pressure);
    swap(&mut initial.temperature, &mut second.temperature);
}
