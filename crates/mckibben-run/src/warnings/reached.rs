//! What a run reached, and what of that no muscle does.
//!
//! The observers of runs see every sample; [`Reached`] keeps of each actuator the extremes that the warnings need.

use super::{LOAD, NEGATIVE, OVERSTRETCHED, PRESSURE, Parts, STRENGTH, STRETCH, Warning, before, behind, fed};
use crate::observation::Range;
use crate::quantities::{given, percent, quantity};
use mckibben::force::{Effectiveness, Law, StaticForce as _};
use mckibben::load::Motion;
use mckibben::mechanism::{Coupling, Mechanism};
use mckibben::network::NodeKind;
use mckibben::parameter::{INITIAL_GAUGE_PRESSURE, INITIAL_LENGTH, SERIES_GAUGE_PRESSURE, SUPPLY_GAUGE_PRESSURE};
use mckibben::plant::{ActuatorSample, Mounted};
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
    let mounted = of.plant.actuators().iter().zip(&of.actuators).zip(reached).enumerate();
    mounted.flat_map(|(index, ((mounted, name), reached))| of_actuator(of, (index, mounted, name), reached)).collect()
}

fn of_actuator(of: &Parts<'_>, (index, mounted, name): (usize, &Mounted, &str), reached: &Reached) -> Vec<Warning> {
    let mut found = Vec::new();
    let (actuator, mechanism) = (&mounted.actuator, &of.plant.mechanisms()[mounted.mechanism]);
    let longest = actuator.limits().max_length();
    let gauge = reached.gauge_pressure.greatest;
    if gauge > PRESSURE {
        let what = format!("the gauge pressure reaches {},", quantity(gauge, "Pa"));
        found.push(beyond_pressure(name, &what, &keys_of_pressure(of, (index, mounted))));
    }
    let (tension, bound) = (reached.tension.greatest, strength(actuator));
    if tension > bound {
        let text = format!(
            "the tension reaches {}, above the {} that this braid makes at {}, where this program begins to doubt it; {}",
            quantity(tension, "N"),
            quantity(bound, "N"),
            given(STRENGTH, "Pa"),
            remedy_of_load(of, mounted),
        );
        found.push(Warning::new("tension", name, text));
    }
    if reached.length.greatest > longest * (1.0 + STRETCH) {
        let length = quantity(reached.length.greatest, "m");
        let cause = match mechanism {
            Mechanism::Mass(_) | Mechanism::Chain(_) => "the load exceeds what the braid holds; ",
            Mechanism::Prescribed(_) | Mechanism::Fixed | Mechanism::External { .. } => "",
        };
        let cause = format!("{cause}{}", remedy_of_load(of, mounted));
        found.push(overstretched(name, &format!("reaches {length}"), reached.length.greatest, longest, &cause));
    }
    if matches!(mechanism, Mechanism::Mass(_)) && reached.distance.least < 0.0 {
        let text = format!(
            "the load is thrown above the attachment, to a distance of {}, where the muscle itself is; lower {} or raise the load",
            quantity(reached.distance.least, "m"),
            key_of_pressure(of, (index, mounted)),
        );
        found.push(Warning::new("thrown", name, text));
    }
    found.extend(extrapolated(actuator, name, reached));
    found.extend(negative(actuator, name, reached));
    found
}

/// The key of what makes the pressure in an actuator: its supply, a given pressure, or of a sealed one that of its start.
fn key_of_pressure(of: &Parts<'_>, (index, mounted): (usize, &Mounted)) -> String {
    let network = of.plant.network();
    let mut valves = (0..network.valves.len()).filter(|valve| fed(network, *valve) == Some(index));
    let is_given = mounted.pressure.is_some()
        || (0..network.nodes.len()).any(|node| {
            matches!(network.nodes[node].kind, NodeKind::Given { .. }) && behind(network, node) == Some(index)
        });
    match valves.next() {
        Some(valve) => before::feed(of, valve).map_or_else(|| SUPPLY_GAUGE_PRESSURE.key.to_owned(), |(key, _)| key),
        None if is_given => SERIES_GAUGE_PRESSURE.key.to_owned(),
        None => INITIAL_GAUGE_PRESSURE.key.to_owned(),
    }
}

/// What to lower where a gauge pressure rises too high; what moves a sealed actuator compresses its air.
fn keys_of_pressure(of: &Parts<'_>, (index, mounted): (usize, &Mounted)) -> String {
    let key = key_of_pressure(of, (index, mounted));
    let start = INITIAL_GAUGE_PRESSURE.key;
    let section = of.section_of(mounted.mechanism);
    match &of.plant.mechanisms()[mounted.mechanism] {
        _ if key == SERIES_GAUGE_PRESSURE.key => key,
        _ if key != start => format!("{key} or {start}"),
        Mechanism::Fixed => key,
        Mechanism::Prescribed(Motion::Sinusoid { .. }) => {
            format!("{key}, or change {section}.length or {section}.amplitude, by which the motion compresses the air")
        }
        Mechanism::Prescribed(Motion::Table { .. }) => {
            format!("{key}, or change {section}.table_length, by which the motion compresses the air")
        }
        Mechanism::Mass(_) | Mechanism::Chain(_) | Mechanism::External { .. } => {
            format!("{key}, or let the load compress the air less")
        }
    }
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
    of: &Parts<'_>,
    (mounted, name): (&Mounted, &str),
    [length, longest]: [f64; 2],
) -> Warning {
    let by_load = match of.plant.mechanisms()[mounted.mechanism] {
        Mechanism::Mass(_) => {
            format!(
                "; where the scenario does not give it, the load exceeds what the braid holds: {}",
                remedy_of_load(of, mounted)
            )
        }
        _ => String::new(),
    };
    let cause = format!("lower {}{by_load}", key_of_length(of, mounted));
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

/// What to change where a load pulls too hard, or a motion goes too far.
fn remedy_of_load(of: &Parts<'_>, mounted: &Mounted) -> String {
    match &of.plant.mechanisms()[mounted.mechanism] {
        Mechanism::Mass(_) => {
            let section = of.section_of(mounted.mechanism);
            format!("lower {section}.mass or {section}.force, or raise the pressure")
        }
        Mechanism::Chain(_) => {
            "lower the load of the joint, change the rest length over it, or give it stops".to_owned()
        }
        Mechanism::External { .. } => "give shorter distances".to_owned(),
        Mechanism::Prescribed(_) | Mechanism::Fixed => format!("lower {}", key_of_length(of, mounted)),
    }
}

/// The key that says how long an actuator starts, and where its length is given how long it is.
pub(super) fn key_of_length(of: &Parts<'_>, mounted: &Mounted) -> String {
    let section = of.section_of(mounted.mechanism);
    match &of.plant.mechanisms()[mounted.mechanism] {
        Mechanism::Mass(_) | Mechanism::Fixed if section == LOAD => INITIAL_LENGTH.key.to_owned(),
        Mechanism::Mass(_) | Mechanism::Fixed => format!("{section}.position"),
        Mechanism::Chain(_) if matches!(mounted.coupling, Coupling::Points(_)) => {
            "the distance between coupling.origin and coupling.insertion, or start at another angle".to_owned()
        }
        Mechanism::Chain(_) => "the rest length over the joint, or start at another angle".to_owned(),
        Mechanism::Prescribed(Motion::Sinusoid { .. }) => format!("{section}.length or {section}.amplitude"),
        Mechanism::Prescribed(Motion::Table { .. }) => format!("{section}.table_length"),
        Mechanism::External { .. } => "the distance that the host gives".to_owned(),
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

/// A part of a length, and a gauge pressure in Pa, by which a change shows whether it raises a force.
const PROBE: [f64; 2] = [1e-3, 100.0];

/// That the law gives a force that pushes, which no load takes from a muscle: a law that is wrong there, a muscle that is pressed
/// together, as a measured one with a stiff wall below its length at rest, or a braid below the pressure of the atmosphere.
fn negative(actuator: &Actuator, name: &str, reached: &Reached) -> Option<Warning> {
    let [force, length, gauge] = reached.least_force;
    let is_more_than_rounding = force < -ROUNDING && force < -NEGATIVE * reached.tension.greatest;
    if !is_more_than_rounding {
        return None;
    }
    // Less than a pascal is rounding of the atmosphere.
    let gauge = if gauge.abs() < 1.0 { 0.0 } else { gauge };
    // What helps depends on the law: below the pressure of the atmosphere a braid pushes the more, the longer it is.
    let rises = |length: f64, gauge: f64| actuator.law().force(length, GaugePressure(gauge)) > force;
    let keep = match (rises(length * (1.0 + PROBE[0]), gauge), rises(length, gauge + PROBE[1])) {
        (true, true) => "keep the muscle longer or its pressure higher there",
        (true, false) => "keep the muscle longer there",
        (false, true) => "keep its pressure higher there",
        (false, false) => "keep the muscle from there",
    };
    let or = match gauge < 0.0 {
        true => "; a braid alone does not pull below the pressure of the atmosphere",
        false => "; where the law does not hold there, raise actuator.min_length or correct actuator.force",
    };
    let text = format!(
        "the law of force gives {} at a length of {} and a gauge pressure of {}: there it pushes, and the tension is kept at zero; \
         {keep}{or}",
        quantity(force, "N"),
        quantity(length, "m"),
        quantity(gauge, "Pa"),
    );
    Some(Warning::new("law-negative", name, text))
}
