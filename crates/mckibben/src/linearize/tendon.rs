//! A load on an elastic tendon near an operating point.
//!
//! ```text
//! M ẍ = W − T          T = k (x − ℓ − L)          F(L, L̇, P) = T
//!
//! with viscous friction    δL̇ = (δT − F_L δL − F_P δP)/F_v                          L is a state
//! without                  δL = (k δx − F_P δP)/(F_L + k)                            L is none
//!                          δL̇ = (k δẋ − F_P δṖ₀)/(F_L + k + F_P α),    Ṗ = Ṗ₀ + α L̇
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | x | distance of the load | m |
//! | L | the actuator's length | m |
//! | F_L, F_v, F_P | derivatives of the actuator's force | N/m, N·s/m, m² |
//! | Ṗ₀ | rate of the pressure at a length that is kept | Pa/s |
//!
//! Nothing has a mass between actuator and tendon. So with viscous friction, of the actuator or in place of Coulomb friction,
//! the balance of both tensions gives the rate of the actuator's length, and without it gives the length itself, which is then
//! eliminated. Both are exact, since length and pressure rest at the point.
//!
//! Checked by `tests/linearize_tendon.rs`: two springs in series with and without a damper, held ends, simulated trajectories;
//! a stiff tendon by `tests/linearize_analysis.rs`.

use super::rates::{AIR_MASS, DISTANCE, Inputs, LENGTH, Near, PRESSURE, STATES, Slopes, TENSION, VELOCITY};
use super::state_space::Signal;
use crate::dual::Dual;
use crate::friction::Rubbing;
use crate::load::SeriesTendon;
use crate::scalar::{Over, Scalar};
use crate::simulation::Rig;
use alloc::vec::Vec;

const LOAD_DISTANCE: Signal = Signal { name: "load_distance", symbol: "x", unit: "m" };
const LOAD_VELOCITY: Signal = Signal { name: "load_velocity", symbol: "ẋ", unit: "m/s" };

/// Force in N of the actuator with its ends at a length (m) and a velocity (m/s).
fn force<T: Over<f64>>(rig: &Rig, inputs: &Inputs<'_>, [length, velocity, pressure]: [T; 3]) -> T {
    let actuator = rig.actuator();
    let rubbing = Rubbing { width: actuator.width(&inputs.memory, length, velocity), ..T::zero().into() };
    actuator.tension_sliding(length, velocity, pressure, rubbing) + T::constant(inputs.viscous) * velocity
}

/// Derivatives of that force at rest at a length (m) and a pressure (Pa): F_L, F_v, F_P.
pub(super) fn force_slopes(rig: &Rig, inputs: &Inputs<'_>, [length, pressure]: [f64; 2]) -> [f64; 3] {
    force::<Dual<f64, 3>>(rig, inputs, [Dual::variable(length, 0), Dual::variable(0.0, 1), Dual::variable(pressure, 2)])
        .slope
}

/// `Σ weight · slope` of numbers that are zero at the point.
fn sum<const N: usize>(terms: [(f64, Slopes); N]) -> Slopes {
    let slope = core::array::from_fn(|n| terms.iter().map(|(weight, of)| weight * of.slope[n]).sum());
    Slopes { value: 0.0, slope }
}

/// The rates of a load on a tendon, with the actuator's four states, of which the velocity is the load's here.
pub(super) fn near_on_tendon(rig: &Rig, tendon: &SeriesTendon, state: [Slopes; 4], inputs: &Inputs<'_>) -> Near {
    let (actuator, stiffness) = (rig.actuator(), tendon.stiffness());
    let [length, velocity, pressure, air_mass] = state;
    let inertia = rig.load().inertia();
    let (distance, velocity) = match inertia {
        Some(_) => (Slopes::variable(0.0, DISTANCE), velocity),
        None => (Slopes::zero(), Slopes::zero()),
    };
    let rest = force(rig, inputs, [length.value, 0.0, pressure.value]);
    let [per_length, per_rate, per_pressure] = force_slopes(rig, inputs, [length.value, pressure.value]);
    let pressure_rate = |length: Slopes, rate: Slopes| {
        let chamber = actuator.chamber(length, rate, pressure, air_mass, false);
        let flow = inputs.flow(actuator, &chamber);
        (actuator.pressure_rate(&chamber, &flow), flow.net())
    };
    let is_damped = per_rate > 0.0;
    let (length, rate) = if is_damped {
        let pull = sum([(stiffness, distance), (-stiffness, length)]);
        (length, sum([(1.0 / per_rate, pull), (-per_length / per_rate, length), (-per_pressure / per_rate, pressure)]))
    } else {
        let both = per_length + stiffness;
        let follows = sum([(stiffness / both, distance), (-per_pressure / both, pressure)]);
        let length = Slopes { value: length.value, ..follows };
        let (still, _) = pressure_rate(length, Slopes::zero());
        let (moved, _) = pressure_rate(length, Slopes::constant(1.0));
        let both = both + per_pressure * (moved.value - still.value);
        (length, sum([(stiffness / both, velocity), (-per_pressure / both, still)]))
    };
    let tension = Slopes { value: rest, ..sum([(stiffness, distance), (-stiffness, length)]) };
    let (pressure_rate, flow) = pressure_rate(length, rate);
    let (mut states, mut outputs) = (Vec::new(), Vec::from([(STATES[LENGTH], length), (STATES[VELOCITY], rate)]));
    if let Some(inertia) = inertia {
        let acceleration = sum([(1.0 / inertia.mass, inputs.force), (-1.0 / inertia.mass, tension)]);
        states.extend([(LOAD_DISTANCE, DISTANCE, velocity), (LOAD_VELOCITY, VELOCITY, acceleration)]);
        outputs.extend([(LOAD_DISTANCE, distance), (LOAD_VELOCITY, velocity)]);
    }
    if is_damped {
        states.push((STATES[LENGTH], LENGTH, rate));
    }
    states.extend([(STATES[PRESSURE], PRESSURE, pressure_rate), (STATES[AIR_MASS], AIR_MASS, flow)]);
    outputs.extend([(STATES[PRESSURE], pressure), (TENSION, tension)]);
    Near { states, outputs }
}
