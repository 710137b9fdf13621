//! The columns of a file as functions of a sample, for an actuator and for a joint.

use super::{COLUMNS, VALVE};
use mckibben::control::Quantity;
use mckibben::simulation::{Decision, JointSample, Sample};
use std::rc::Rc;

/// A column of a file over samples `S`.
pub(super) struct Field<S> {
    pub(super) name: String,
    /// Its unit; empty for words.
    pub(super) unit: &'static str,
    pub(super) value: Value<S>,
}

/// What a column holds of a sample.
pub(super) enum Value<S> {
    Number(Box<dyn Fn(&S) -> f64>),
    Word(Box<dyn Fn(&S) -> &'static str>),
}

/// The columns of one actuator in their order.
pub(super) fn of_actuator() -> Vec<Field<Sample>> {
    let numbers = COLUMNS.iter().map(|column| number(column.name, column.unit, column.value));
    numbers.chain([word(VALVE, |sample: &Sample| sample.ports.name())]).collect()
}

/// The columns of one actuator under a controller: what it regulates follows, as of the last sampling instant.
pub(super) fn of_controlled(regulated: Quantity, decisions: &[Decision]) -> Vec<Field<Sample>> {
    let unit = regulated.rows().set_point.unit;
    let decisions: Rc<[Decision]> = decisions.into();
    let column = |name: &str, value: fn(&Decision, Quantity) -> Option<f64>| {
        let decisions = Rc::clone(&decisions);
        number(&format!("{name}_{}", unit.to_lowercase()), unit, move |sample: &Sample| {
            // A sampling instant and the sample's time that differ by rounding are one.
            let begun = decisions.partition_point(|decision| decision.seen.time <= sample.time * (1.0 + 1e-14));
            let last = begun.checked_sub(1).and_then(|index| decisions.get(index));
            last.and_then(|decision| value(decision, regulated)).unwrap_or(f64::NAN)
        })
    };
    let mut fields = of_actuator();
    fields.push(column("set_point", |decision, _| decision.aim.map(|(_, target)| target)));
    fields.push(column("measured", |decision, regulated| regulated.of(&decision.seen)));
    fields
}

/// The columns of a joint in their order.
pub(super) fn of_joint() -> Vec<Field<JointSample>> {
    let mut fields = member(0, "");
    fields.extend([
        number("angle_rad", "rad", |sample: &JointSample| sample.angle),
        number("angular_velocity_rad_s", "rad/s", |sample: &JointSample| sample.angular_velocity),
        number("torque_n_m", "N*m", |sample: &JointSample| sample.torque),
    ]);
    // The time stands in front already.
    fields.extend(member(1, "antagonist_").into_iter().skip(1));
    fields
}

/// The columns of one actuator of a joint, their names with a prefix.
fn member(index: usize, prefix: &str) -> Vec<Field<JointSample>> {
    let of = move |field: Field<Sample>| Field {
        name: format!("{prefix}{}", field.name),
        unit: field.unit,
        value: match field.value {
            Value::Number(value) => {
                Value::Number(Box::new(move |sample: &JointSample| value(&sample.actuators[index])))
            }
            Value::Word(value) => Value::Word(Box::new(move |sample: &JointSample| value(&sample.actuators[index]))),
        },
    };
    of_actuator().into_iter().map(of).collect()
}

fn number<S>(name: &str, unit: &'static str, value: impl Fn(&S) -> f64 + 'static) -> Field<S> {
    Field { name: name.to_owned(), unit, value: Value::Number(Box::new(value)) }
}

fn word<S>(name: &str, value: impl Fn(&S) -> &'static str + 'static) -> Field<S> {
    Field { name: name.to_owned(), unit: "", value: Value::Word(Box::new(value)) }
}
