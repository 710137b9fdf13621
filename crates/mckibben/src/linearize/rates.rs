//! The rates of the rig under the valve's mean flow and the inputs, and their derivatives.

use super::point::OperatingPoint;
use super::seats::Interval;
use super::state_space::{Signal, StateSpace};
use crate::actuator::Actuator;
use crate::air::{Chamber, Flow};
use crate::dual::Dual;
use crate::friction::{Memory, Rubbing};
use crate::load::Load;
use crate::scalar::Over;
use crate::simulation::{Held, Rig};
use alloc::vec::Vec;

/// The directions of differentiation: four states, then three inputs.
pub(super) type Slopes = Dual<f64, 7>;
/// The direction of the duty.
pub(super) const DUTY: usize = 4;
const MASS_FLOW: usize = 5;
const FORCE: usize = 6;

const STATES: [Signal; 4] = [
    Signal { name: "length", symbol: "L", unit: "m" },
    Signal { name: "velocity", symbol: "v", unit: "m/s" },
    Signal { name: "pressure", symbol: "P", unit: "Pa" },
    Signal { name: "air_mass", symbol: "m", unit: "kg" },
];
const TENSION: Signal = Signal { name: "tension", symbol: "F", unit: "N" };
const INPUTS: [Signal; 3] = [
    Signal { name: "duty", symbol: "d", unit: "" },
    Signal { name: "mass_flow", symbol: "ṁ", unit: "kg/s" },
    Signal { name: "force", symbol: "W", unit: "N" },
];

/// Flow through the valve, averaged over the intervals of a period by the part of it that each lasts.
pub(super) fn mean_flow<T: Over<f64>>(actuator: &Actuator, chamber: &Chamber<T>, seats: &[Interval<T>]) -> Flow<T> {
    seats.iter().fold(Flow::none(), |sum, Interval { ports, share }| {
        let flow = actuator.flow(chamber, ports.supply, ports.exhaust);
        sum.and(Flow { inward: flow.inward * *share, outward: flow.outward * *share })
    })
}

/// What acts on the rig beside its valve and its load.
struct Inputs<T> {
    mass_flow: T,
    force: T,
    /// Damping in N·s/m beside the actuator's own.
    viscous: f64,
    /// The hysteresis, relaxed at the operating point: small motion does not make it slip.
    memory: Memory,
}

/// The four rates without Coulomb friction, and the tension.
fn rates<T: Over<f64>>(rig: &Rig, state: [T; 4], seats: &[Interval<T>], inputs: &Inputs<T>) -> ([T; 4], T) {
    let actuator = rig.actuator();
    let taut = T::of(actuator.limits().max_length()).lt(state[0]);
    let held = Held { taut, memory: inputs.memory, ..Held::nothing() };
    let [length, velocity, acceleration] = rig.motion(T::zero(), [state[0], state[1], state[2]], &held);
    let per_mass = rig.load().inertia().map_or(0.0, |inertia| 1.0 / inertia.mass);
    let beside = T::constant(inputs.viscous) * velocity;
    let acceleration = acceleration + (inputs.force - beside) * T::constant(per_mass);
    let chamber = actuator.chamber(length, velocity, state[2], state[3], false);
    // The flow enters the pressure's rate linearly, so the rate of the mean flow is the mean of the rates.
    let flow = mean_flow(actuator, &chamber, seats).and(Flow { inward: inputs.mass_flow, outward: T::zero() });
    let rubbing = Rubbing { width: actuator.width(&inputs.memory, length, velocity), ..T::zero().into() };
    let tension = actuator.tension_sliding(length, velocity, state[2], rubbing) + beside;
    ([velocity, acceleration, actuator.pressure_rate(&chamber, &flow), flow.net()], tension)
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
    let inputs = Inputs { mass_flow, force, viscous, memory };
    let (rates, tension) = rates(&point.rig, at, seats, &inputs);
    let moves = !matches!(point.rig.load(), Load::Isometric);
    let states: Vec<usize> = if moves { (0..4).collect() } else { Vec::from([2, 3]) };
    let mut columns = Vec::new();
    if with_duty {
        columns.push(DUTY);
    }
    columns.push(MASS_FLOW);
    if moves {
        columns.push(FORCE);
    }
    let mut outputs: Vec<(Signal, Slopes)> =
        if moves { (0..3).map(|n| (STATES[n], at[n])).collect() } else { Vec::from([(STATES[2], at[2])]) };
    outputs.push((TENSION, tension));
    let pick = |value: &Slopes, columns: &[usize]| columns.iter().map(|n| value.slope[*n]).collect::<Vec<f64>>();
    StateSpace {
        a: states.iter().map(|n| pick(&rates[*n], &states)).collect(),
        b: states.iter().map(|n| pick(&rates[*n], &columns)).collect(),
        c: outputs.iter().map(|(_, value)| pick(value, &states)).collect(),
        d: outputs.iter().map(|(_, value)| pick(value, &columns)).collect(),
        states: states.iter().map(|n| STATES[*n]).collect(),
        inputs: columns.iter().map(|n| INPUTS[*n - DUTY]).collect(),
        outputs: outputs.iter().map(|(signal, _)| *signal).collect(),
    }
}
