//! The rates of the rig under the valve's mean flow and the inputs, and their derivatives.

use super::point::OperatingPoint;

use super::state_space::{Signal, StateSpace};
use super::tendon::near_on_tendon;
use crate::actuator::Actuator;
use crate::air::{Chamber, Flow};
use crate::dual::Dual;
use crate::friction::{Memory, Rubbing};
use crate::load::Load;
use crate::scalar::{Over, Scalar};
use crate::simulation::{Held, Rig};
use crate::valve::Interval;
use alloc::vec::Vec;

/// The directions of differentiation: four states, a load's distance, then three inputs.
pub(super) type Slopes = Dual<f64, 8>;
pub(super) const LENGTH: usize = 0;
pub(super) const VELOCITY: usize = 1;
pub(super) const PRESSURE: usize = 2;
pub(super) const AIR_MASS: usize = 3;
/// Of a load on a tendon.
pub(super) const DISTANCE: usize = 4;
/// The direction of the duty.
pub(super) const DUTY: usize = 5;
const MASS_FLOW: usize = 6;
const FORCE: usize = 7;

/// The four states, in the order of their directions.
pub(super) const STATES: [Signal; 4] = [
    Signal { name: "length", symbol: "L", unit: "m" },
    Signal { name: "velocity", symbol: "v", unit: "m/s" },
    Signal { name: "pressure", symbol: "P", unit: "Pa" },
    Signal { name: "air_mass", symbol: "m", unit: "kg" },
];
pub(super) const TENSION: Signal = Signal { name: "tension", symbol: "F", unit: "N" };
const INPUTS: [Signal; 3] = [
    Signal { name: "duty", symbol: "d", unit: "" },
    Signal { name: "mass_flow", symbol: "ṁ", unit: "kg/s" },
    Signal { name: "force", symbol: "W", unit: "N" },
];

/// Flow through the valve, averaged over the intervals of a period by the part of it that each lasts.
pub(super) fn mean_flow<T: Over<f64>>(actuator: &Actuator, chamber: &Chamber<T>, seats: &[Interval<T>]) -> Flow<T> {
    seats.iter().fold(Flow::none(), |sum, Interval { ports, share, .. }| {
        let flow = actuator.flow(chamber, ports.supply, ports.exhaust);
        sum.and(Flow { inward: flow.inward * *share, outward: flow.outward * *share })
    })
}

/// What acts on the rig beside its load.
pub(super) struct Inputs<'a> {
    /// A period of the valve's seats, if it is under PWM.
    pub(super) seats: &'a [Interval<Slopes>],
    mass_flow: Slopes,
    pub(super) force: Slopes,
    /// Damping in N·s/m beside the actuator's own.
    pub(super) viscous: f64,
    /// The hysteresis, relaxed at the operating point: small motion does not make it slip.
    pub(super) memory: Memory,
}

impl Inputs<'_> {
    /// Flow into an actuator's air.
    pub(super) fn flow(&self, actuator: &Actuator, chamber: &Chamber<Slopes>) -> Flow<Slopes> {
        mean_flow(actuator, chamber, self.seats).and(Flow { inward: self.mass_flow, outward: Slopes::zero() })
    }
}

/// What is differentiated: each state with its direction and its rate, and the outputs.
pub(super) struct Near {
    pub(super) states: Vec<(Signal, usize, Slopes)>,
    pub(super) outputs: Vec<(Signal, Slopes)>,
}

/// The four rates without Coulomb friction, and the tension.
fn near(rig: &Rig, state: [Slopes; 4], inputs: &Inputs<'_>) -> Near {
    let actuator = rig.actuator();
    let taut = Slopes::of(actuator.limits().max_length()).lt(state[LENGTH]);
    let held = Held { taut, memory: inputs.memory, ..Held::nothing() };
    let ends = [state[LENGTH], state[VELOCITY], state[PRESSURE]];
    let [length, velocity, acceleration] = rig.motion(Slopes::zero(), ends, &held);
    let per_mass = rig.load().inertia().map_or(0.0, |inertia| 1.0 / inertia.mass);
    let beside = Slopes::constant(inputs.viscous) * velocity;
    let acceleration = acceleration + (inputs.force - beside) * Slopes::constant(per_mass);
    let chamber = actuator.chamber(length, velocity, state[PRESSURE], state[AIR_MASS], false);
    // The flow enters the pressure's rate linearly, so the rate of the mean flow is the mean of the rates.
    let flow = inputs.flow(actuator, &chamber);
    let rubbing = Rubbing { width: actuator.width(&inputs.memory, length, velocity), ..Slopes::zero().into() };
    let tension = actuator.tension_sliding(length, velocity, state[PRESSURE], rubbing) + beside;
    let rates = [velocity, acceleration, actuator.pressure_rate(&chamber, &flow), flow.net()];
    let moves = !matches!(rig.load(), Load::Isometric);
    let of = if moves { LENGTH..=AIR_MASS } else { PRESSURE..=AIR_MASS };
    let shown = if moves { LENGTH..=PRESSURE } else { PRESSURE..=PRESSURE };
    let mut outputs: Vec<_> = shown.map(|n| (STATES[n], state[n])).collect();
    outputs.push((TENSION, tension));
    Near { states: of.map(|n| (STATES[n], n, rates[n])).collect(), outputs }
}

/// The matrices at an operating point; the duty is an input when the valve's mean flow is part of the model.
pub(super) fn derivatives(
    point: &OperatingPoint,
    seats: &[Interval<Slopes>],
    viscous: f64,
    with_duty: bool,
) -> StateSpace {
    let state = point.state.to_array();
    let at: [Slopes; 4] = core::array::from_fn(|n| Dual::variable(state[n], n));
    let memory = Memory::relaxed(point.state.length);
    let (mass_flow, force) = (Dual::variable(0.0, MASS_FLOW), Dual::variable(0.0, FORCE));
    let inputs = Inputs { seats, mass_flow, force, viscous, memory };
    let Near { states, outputs } = match point.rig.tendon() {
        Some(tendon) => near_on_tendon(&point.rig, tendon, at, &inputs),
        None => near(&point.rig, at, &inputs),
    };
    let mut columns = Vec::new();
    if with_duty {
        columns.push(DUTY);
    }
    columns.push(MASS_FLOW);
    if !matches!(point.rig.load(), Load::Isometric) {
        columns.push(FORCE);
    }
    let directions: Vec<usize> = states.iter().map(|(_, direction, _)| *direction).collect();
    let pick = |value: &Slopes, columns: &[usize]| columns.iter().map(|n| value.slope[*n]).collect::<Vec<f64>>();
    StateSpace {
        a: states.iter().map(|(.., rate)| pick(rate, &directions)).collect(),
        b: states.iter().map(|(.., rate)| pick(rate, &columns)).collect(),
        c: outputs.iter().map(|(_, value)| pick(value, &directions)).collect(),
        d: outputs.iter().map(|(_, value)| pick(value, &columns)).collect(),
        states: states.iter().map(|(signal, ..)| *signal).collect(),
        inputs: columns.iter().map(|n| INPUTS[*n - DUTY]).collect(),
        outputs: outputs.iter().map(|(signal, _)| *signal).collect(),
    }
}
