//! What a run reached, and what of that no muscle does.
//!
//! The observers of runs see every sample; [`Reached`] keeps of each actuator the extremes that the warnings need.

use super::{NEGATIVE, OVERSTRETCHED, PRESSURE, Parts, STRENGTH, STRETCH, Warning};
use crate::observation::Range;
use crate::quantities::{given, percent, quantity};
use mckibben::force::{Effectiveness, Law, StaticForce as _};
use mckibben::mechanism::{Coupling, Mechanism};
use mckibben::plant::ActuatorSample;
use mckibben::simulation::Sample;
use mckibben::{AbsolutePressure, Actuator, GaugePressure};

/// The extremes of an actuator in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reached {
    /// Of the distance that actuator and tendon span, in m.
    pub distance: Range,
    /// Of the actuator's length in m.
    pub length: Range,
    /// Of the tension in N.
    pub tension: Range,
    /// Of the gauge pressure in Pa.
    pub gauge_pressure: Range,
    /// Of length in m and gauge pressure in Pa where the law of static force was used: while the actuator was not slack.
    pub law: [Range; 2],
    /// The least static force in N, with the length in m and the gauge pressure in Pa at which it stood.
    pub least_force: [f64; 3],
}

impl Reached {
    pub(crate) const NONE: Self = Self {
        distance: Range::NONE,
        length: Range::NONE,
        tension: Range::NONE,
        gauge_pressure: Range::NONE,
        law: [Range::NONE; 2],
        least_force: [f64::INFINITY, 0.0, 0.0],
    };

    /// Takes a sample of an actuator that is seen individually or in a joint.
    pub(crate) fn see(&mut self, actuator: &Actuator, sample: &Sample) {
        self.take(actuator, [sample.load_distance, sample.length, sample.tension], sample.pressure);
    }

    /// Takes a sample of an actuator of a plant.
    pub(crate) fn see_in_plant(&mut self, actuator: &Actuator, sample: &ActuatorSample) {
        self.take(actuator, [sample.distance, sample.length, sample.tension], sample.pressure);
    }

    /// As [`Reached::see_in_plant`], for the many runs of a sweep: the law of force is evaluated only where the tension is low, since
    /// where a law pushes the tension is zero but for friction.
    pub(crate) fn see_briefly(&mut self, actuator: &Actuator, sample: &ActuatorSample) {
        let is_low = sample.tension <= 0.5 * self.tension.greatest;
        self.see_extremes(actuator, [sample.distance, sample.length, sample.tension], sample.pressure);
        if is_low {
            self.see_force(actuator, sample.length, sample.pressure);
        }
    }

    fn take(&mut self, actuator: &Actuator, [distance, length, tension]: [f64; 3], pressure: AbsolutePressure) {
        self.see_extremes(actuator, [distance, length, tension], pressure);
        self.see_force(actuator, length, pressure);
    }

    fn see_extremes(&mut self, actuator: &Actuator, [distance, length, tension]: [f64; 3], pressure: AbsolutePressure) {
        let gauge = actuator.gauge(pressure.0).0;
        self.distance.see(distance);
        self.length.see(length);
        self.tension.see(tension);
        self.gauge_pressure.see(gauge);
        if length > actuator.limits().min_length() {
            self.law[0].see(length);
            self.law[1].see(gauge);
        }
    }

    fn see_force(&mut self, actuator: &Actuator, length: f64, pressure: AbsolutePressure) {
        if length > actuator.limits().min_length() {
            let gauge = actuator.gauge(pressure.0).0;
            let force = actuator.law().force(length, GaugePressure(gauge));
            if force < self.least_force[0] {
                self.least_force = [force, length, gauge];
            }
        }
    }
}

/// The warnings of what each actuator reached.
pub(super) fn warnings(of: &Parts<'_>, reached: &[Reached]) -> Vec<Warning> {
    let mounted = of.plant.actuators().iter().zip(&of.actuators).zip(reached);
    mounted
        .flat_map(|((mounted, name), reached)| {
            let mechanism = &of.plant.mechanisms()[mounted.mechanism];
            of_actuator(&mounted.actuator, mechanism, name, reached)
        })
        .collect()
}

fn of_actuator(actuator: &Actuator, mechanism: &Mechanism, name: &str, reached: &Reached) -> Vec<Warning> {
    let mut found = Vec::new();
    let longest = actuator.limits().max_length();
    let gauge = reached.gauge_pressure.greatest;
    if gauge > PRESSURE {
        let what = format!("the gauge pressure reaches {},", quantity(gauge, "Pa"));
        found.push(beyond_pressure(name, &what, "supply.gauge_pressure or initial.gauge_pressure"));
    }
    let (tension, bound) = (reached.tension.greatest, strength(actuator));
    if tension > bound {
        let text = format!(
            "the tension reaches {}, above the {} that this braid makes at {}, where this program begins to doubt it; {}",
            quantity(tension, "N"),
            quantity(bound, "N"),
            given(STRENGTH, "Pa"),
            remedy_of_load(mechanism),
        );
        found.push(Warning::new("tension", name, text));
    }
    if reached.length.greatest > longest * (1.0 + STRETCH) {
        let length = quantity(reached.length.greatest, "m");
        let cause = format!("the load exceeds what the braid holds; {}", remedy_of_load(mechanism));
        found.push(overstretched(name, &format!("reaches {length}"), reached.length.greatest, longest, &cause));
    }
    if matches!(mechanism, Mechanism::Mass(_)) && reached.distance.least < 0.0 {
        let text = format!(
            "the load is thrown above the attachment, to a distance of {}, where the muscle itself is; lower \
             supply.gauge_pressure or raise the load",
            quantity(reached.distance.least, "m"),
        );
        found.push(Warning::new("thrown", name, text));
    }
    found.extend(extrapolated(actuator, name, reached));
    found.extend(negative(name, reached));
    found
}

/// The tension in N that the ideal braid makes at [`STRENGTH`] and its taut length: what the braid is taken to hold.
fn strength(actuator: &Actuator) -> f64 {
    let braid = &actuator.law().law.braid;
    -STRENGTH * braid.volume_slope(actuator.limits().max_length())
}

/// That a gauge pressure, which `what` says with its verb, is above what braids hold.
pub(super) fn beyond_pressure(name: &str, what: &str, key: &str) -> Warning {
    let text = format!(
        "{what} above {}, where this program begins to doubt that a braid holds; lower {key}",
        given(PRESSURE, "Pa")
    );
    Warning::new("pressure", name, text)
}

/// That an actuator starts longer than it can be: by what its start says, or where that is found from the load, by the load.
pub(super) fn starts_overstretched(
    name: &str,
    [length, longest]: [f64; 2],
    mechanism: &Mechanism,
    coupling: &Coupling,
) -> Warning {
    let by_load = match mechanism {
        Mechanism::Mass(_) => {
            format!(
                "; where the scenario does not give it, the load exceeds what the braid holds: {}",
                remedy_of_load(mechanism)
            )
        }
        _ => String::new(),
    };
    let cause = format!("lower {}{by_load}", key_of_length(mechanism, coupling));
    overstretched(name, &format!("starts at {}", quantity(length, "m")), length, longest, &cause)
}

/// That an actuator is longer than it can be: `reaches` says how long, `cause` why and what to change.
fn overstretched(name: &str, reaches: &str, length: f64, longest: f64, cause: &str) -> Warning {
    let text = format!(
        "the length {reaches}, {} above actuator.max_length = {}: {cause}",
        percent((length - longest) / longest),
        quantity(longest, "m"),
    );
    Warning::new(OVERSTRETCHED, name, text)
}

/// What to change where a load pulls too hard.
fn remedy_of_load(mechanism: &Mechanism) -> &'static str {
    match mechanism {
        Mechanism::Mass(_) => "lower load.mass or load.force, or raise the pressure",
        Mechanism::Chain(_) => "lower the load of the joint, change the rest length over it, or give it stops",
        Mechanism::Prescribed(_) => "shorten load.motion",
        Mechanism::Fixed => "lower initial.length",
        Mechanism::External { .. } => "give shorter distances",
    }
}

/// The key that says how long an actuator starts.
pub(super) fn key_of_length(mechanism: &Mechanism, coupling: &Coupling) -> &'static str {
    match mechanism {
        Mechanism::Mass(_) | Mechanism::Fixed => "initial.length",
        Mechanism::Chain(_) if matches!(coupling, Coupling::Points(_)) => {
            "the distance between coupling.origin and coupling.insertion, or start at another angle"
        }
        Mechanism::Chain(_) => "the rest length over the joint, or start at another angle",
        Mechanism::Prescribed(_) => "the length of load.motion",
        Mechanism::External { .. } => "the distance that the host gives",
    }
}

/// That a measured law was used beyond the table it was measured in.
fn extrapolated(actuator: &Actuator, name: &str, reached: &Reached) -> Option<Warning> {
    let [length, gauge] = reached.law;
    let law = actuator.law();
    let of_map = match law.law.law() {
        Law::Map(map) => [
            ("length", "actuator.force.length", "m", length, ends(|piece| map.length_bounds(piece))),
            ("gauge pressure", "actuator.force.gauge_pressure", "Pa", gauge, ends(|piece| map.pressure_bounds(piece))),
        ]
        .to_vec(),
        _ => Vec::new(),
    };
    let of_effectiveness = match &law.effectiveness {
        table @ Effectiveness::Table(_) => {
            let key = "actuator.effectiveness.gauge_pressure";
            Some(("gauge pressure", key, "Pa", gauge, ends(|piece| table.piece_bounds(piece))))
        }
        _ => None,
    };
    of_map.into_iter().chain(of_effectiveness).find_map(|(what, key, unit, range, ends)| {
        let [first, last] = ends?;
        let beyond = if range.greatest > last {
            range.greatest
        } else if range.least < first && what == "length" {
            range.least
        } else {
            return None;
        };
        let text = format!(
            "the law of force is used at a {what} of {}, outside the {} to {} of {key}; give it values there, or keep the run \
             within them",
            quantity(beyond, unit),
            quantity(first, unit),
            quantity(last, unit),
        );
        Some(Warning::new("law-extrapolated", name, text))
    })
}

/// The first and the last knot of a law in pieces.
fn ends(bounds: impl Fn(usize) -> (Option<f64>, Option<f64>)) -> Option<[f64; 2]> {
    let first = bounds(0).1?;
    // Piece k lies above knot k − 1; the last has no upper end.
    let last = (1..).map(&bounds).find(|(_, upper)| upper.is_none())?.0?;
    Some([first, last])
}

/// A push in N that the rounding of pressures makes: of a millipascal on ten square centimetres.
const ROUNDING: f64 = 1e-6;

/// That the law gives a force that pushes, which no load takes from a muscle: a law that is wrong there, or a muscle that is pressed
/// together, as a measured one with a stiff wall below its length at rest.
fn negative(name: &str, reached: &Reached) -> Option<Warning> {
    let [force, length, gauge] = reached.least_force;
    let is_more_than_rounding = force < -ROUNDING && force < -NEGATIVE * reached.tension.greatest;
    if !is_more_than_rounding {
        return None;
    }
    // Less than a pascal is rounding of the atmosphere.
    let gauge = if gauge.abs() < 1.0 { 0.0 } else { gauge };
    let text = format!(
        "the law of force gives {} at a length of {} and a gauge pressure of {}: there it pushes, and the tension is kept at zero; \
         keep the muscle longer or its pressure higher there; where the law does not hold there, raise actuator.min_length or \
         correct actuator.force",
        quantity(force, "N"),
        quantity(length, "m"),
        quantity(gauge, "Pa"),
    );
    Some(Warning::new("law-negative", name, text))
}
