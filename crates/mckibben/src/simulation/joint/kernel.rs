//! One step of a joint at fixed steps while nothing switches.
//!
//! The methods are those of a rig ([`Method`]), over six states. The matrix of the stable one holds the exact derivatives
//! of the angular acceleration by angle and angular velocity, and for each actuator's pressure the steeper of tangent and
//! secant to the open port's; what couples these blocks is left out, which the order 2 of Verwer's scheme allows.

use super::{ANGLE, JointRig, PRESSURE, VELOCITY};
use crate::actuator::Actuator;
use crate::air::{Chamber, Flow};
use crate::dual::Dual;
use crate::friction::{Memory, Rubbing};
use crate::load::SIGN;
use crate::scalar::{Over, Real};
use crate::simulation::kernel::{
    Matrix, Method, Slopes, ahead, gathered, leaves_enough, reach, reaches, secants_of_shares,
};
use crate::valve::{Openings, Port, Ports};

/// What stays the same during a part of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Held<R> {
    pub(super) ports: [Ports; 2],
    /// How far the passages of each valve are open, and to what.
    pub(super) openings: [Openings<R>; 2],
    /// How the joint turns: −1, 0 or +1.
    pub(super) turning: R,
    /// Whether friction, or an actuator at its shortest, holds it at rest.
    pub(super) stuck: bool,
    pub(super) slack: [bool; 2],
    /// Whether the taut braid pulls.
    pub(super) taut: [bool; 2],
    /// Whether each stop is pressed.
    pub(super) pressed: [bool; 2],
    /// What each hysteresis remembers.
    pub(super) memory: [Memory<R>; 2],
}

impl<R: Real> Held<R> {
    /// The same with other openings, where there are such.
    fn opened(&self, other: impl Fn(&Openings<R>) -> Option<Openings<R>>) -> Option<Self> {
        let others = self.openings.each_ref().map(other);
        let any = others.iter().any(Option::is_some);
        any.then(|| Self { openings: [0, 1].map(|i| others[i].unwrap_or(self.openings[i])), ..*self })
    }
}

impl<R: Real> JointRig<R> {
    /// How the threads of an actuator rub while its ends are at `length` (m) and move apart at `velocity` (m/s).
    #[inline(always)]
    pub(super) fn rubbing<T: Over<R>>(&self, i: usize, length: T, velocity: T, held: &Held<R>) -> Rubbing<T> {
        let direction = R::constant(SIGN[i]) * held.turning;
        Rubbing { width: self.driven[i].actuator.width(&held.memory[i], length, velocity), ..T::of(direction).into() }
    }

    /// Tension in N of an actuator whose ends move.
    #[inline(always)]
    pub(super) fn sliding_tension<T: Over<R>>(&self, i: usize, ends: [T; 3], held: &Held<R>) -> T {
        let actuator = &self.driven[i].actuator;
        let factors = actuator.factors(ends[0], ends[2]);
        let force = actuator.signed_force(ends, self.rubbing(i, ends[0], ends[1], held), held.taut[i], factors);
        T::select(held.slack[i], T::zero(), force.larger(T::zero()))
    }

    /// Angular velocity and acceleration.
    #[inline(always)]
    fn motion<T: Over<R>>(&self, pieces: [usize; 2], state: &[T; 6], held: &Held<R>) -> [T; 2] {
        if held.stuck {
            return [T::zero(); 2];
        }
        let (angle, velocity) = (state[ANGLE], state[VELOCITY]);
        let leverage = self.joint.leverage_in(pieces, angle);
        let slopes = leverage.slopes();
        let pull = |i: usize| {
            let ends = [leverage.lengths[i], slopes[i] * velocity, state[PRESSURE[i]]];
            self.sliding_tension(i, ends, held)
        };
        let mut torque = leverage.torque_of([pull(0), pull(1)]) + self.joint.other_torque(angle, velocity);
        for end in 0..2 {
            if held.pressed[end] {
                torque = torque - T::constant(SIGN[end]) * self.joint.stop_torque(end, angle, velocity);
            }
        }
        [velocity, torque / T::of(self.joint.inertia())]
    }

    /// Flow into an actuator at a time in s.
    #[inline(always)]
    pub(super) fn inflow<T: Over<R>>(&self, i: usize, time: T, chamber: &Chamber<T>, held: &Held<R>) -> Flow<T> {
        let (actuator, Ports { supply, exhaust }) = (&self.driven[i].actuator, held.ports[i]);
        let known =
            actuator.valve().and_then(|valve| valve.flow_through(&held.openings[i], time, [supply, exhaust], chamber));
        known.unwrap_or_else(|| actuator.flow(chamber, supply, exhaust))
    }

    /// `dP/dt` in Pa/s and `dm/dt` in kg/s of an actuator.
    #[inline(always)]
    fn air_rates<T: Over<R>>(&self, i: usize, time: T, contents: [T; 4], held: &Held<R>) -> [T; 2] {
        let actuator = &self.driven[i].actuator;
        let [length, velocity, pressure, mass] = contents;
        let chamber = actuator.chamber(length, velocity, pressure, mass, held.slack[i]);
        let flow = self.inflow(i, time, &chamber, held);
        [actuator.pressure_rate(&chamber, &flow), flow.net()]
    }

    /// Length, velocity, pressure and air mass of both actuators.
    #[inline(always)]
    fn contents(&self, pieces: [usize; 2], state: &[R; 6], held: &Held<R>) -> [[R; 4]; 2] {
        let leverage = self.joint.leverage_in(pieces, state[ANGLE]);
        let (slopes, velocity) = (leverage.slopes(), if held.stuck { R::zero() } else { state[VELOCITY] });
        [0, 1].map(|i| {
            let at = PRESSURE[i];
            [leverage.lengths[i], slopes[i] * velocity, state[at], state[at + 1]]
        })
    }

    /// Time derivatives of the six states at a time in s.
    fn stepped_rates(&self, time: R, state: &[R; 6], held: &Held<R>) -> [R; 6] {
        let pieces = self.joint.pieces(state[ANGLE]);
        let [velocity, acceleration] = self.motion(pieces, state, held);
        let contents = self.contents(pieces, state, held);
        let [agonist, antagonist] = [0, 1].map(|i| self.air_rates(i, time, contents[i], held));
        [velocity, acceleration, agonist[0], agonist[1], antagonist[0], antagonist[1]]
    }

    /// One part of a step from a time in s.
    pub(super) fn take(&self, method: Method, time: R, state: &[R; 6], step: R, held: &Held<R>) -> [R; 6] {
        match method {
            Method::Rk4 => {
                let mut slopes = [[R::zero(); 6]; 4];
                for (stage, reach) in reaches(step).into_iter().enumerate() {
                    let at = ahead(state, reach, &slopes[stage.saturating_sub(1)]);
                    slopes[stage] = self.stepped_rates(time + reach, &at, held);
                }
                gathered(state, step, &slopes)
            }
            Method::Stable => {
                let midway = held.opened(|openings| openings.midway(time, step));
                let held = midway.as_ref().unwrap_or(held);
                let (first, matrices) = self.rates_with_matrices(time, state, reach(step), held);
                let k1 = solve(&matrices, first);
                let second = self.stepped_rates(time + step, &ahead(state, step, &k1), held);
                let second = ahead(&second, R::constant(-2.0), &k1);
                // Where passages are under way the second stage has the matrix of what they come to.
                let k2 = match held.opened(|openings| openings.come_to(time + step)) {
                    None => solve(&matrices, second),
                    Some(held) => solve(&self.rates_with_matrices(time, state, reach(step), &held).1, second),
                };
                ahead(state, step * R::constant(0.5), &ahead(&k2, R::constant(3.0), &k1))
            }
        }
    }

    /// The same, but where the stable method would leave too little air of an actuator by one stage with γ = 1, which leaves
    /// some whatever the step.
    pub(super) fn take_tenable(&self, method: Method, time: R, state: &[R; 6], step: R, held: &Held<R>) -> [R; 6] {
        R::step_joint(self, method, (time, step), state, held)
    }

    pub(crate) fn generic_take_tenable(
        &self,
        method: Method,
        (time, step): (R, R),
        state: &[R; 6],
        held: &Held<R>,
    ) -> [R; 6] {
        let end = self.take(method, time, state, step, held);
        let leaves = |at: usize| leaves_enough([state[at], state[at + 1]], [end[at], end[at + 1]]);
        if method == Method::Rk4 || PRESSURE.iter().all(|at| leaves(*at)) {
            return end;
        }
        let midway = held.opened(|openings| openings.midway(time, step));
        let held = midway.as_ref().unwrap_or(held);
        let come_to = held.opened(|openings| openings.come_to(time + step));
        let held = come_to.as_ref().unwrap_or(held);
        let (first, matrices) = self.rates_with_matrices(time, state, step, held);
        let mut slopes = solve(&matrices, first);
        for i in 0..2 {
            slopes[PRESSURE[i] + 1] = matrices[i].with_the_pressure(first[PRESSURE[i] + 1]);
        }
        ahead(state, step, &slopes)
    }

    /// The rates, and the matrices of the stable method: of the motion with the agonist's air, and of the antagonist's.
    fn rates_with_matrices(&self, time: R, state: &[R; 6], reach: R, held: &Held<R>) -> ([R; 6], [Matrix<R>; 2]) {
        let pieces = self.joint.pieces(state[ANGLE]);
        let mut wide = state.map(Dual::<R, 2>::of);
        wide[ANGLE] = Dual::variable(state[ANGLE], 0);
        wide[VELOCITY] = Dual::variable(state[VELOCITY], 1);
        let [velocity, acceleration] = self.motion(pieces, &wide, held);
        let mut rates = [velocity.value, acceleration.value, R::zero(), R::zero(), R::zero(), R::zero()];
        let contents = self.contents(pieces, state, held);
        let matrices = [0, 1].map(|i| {
            let [length, velocity, pressure, mass] = contents[i];
            let air = [Dual::of(length), Dual::of(velocity), Dual::<R, 1>::variable(pressure, 0), Dual::of(mass)];
            let [of_pressure, of_mass] = self.air_rates(i, Dual::of(time), air, held);
            let of_air = [of_pressure.value, of_mass.value];
            rates[PRESSURE[i]..=PRESSURE[i] + 1].copy_from_slice(&of_air);
            let slopes = Slopes {
                acceleration: if i == 0 { acceleration.slope } else { [R::zero(); 2] },
                pressure_rate: of_pressure.slope[0],
                mass_rate: of_mass.slope[0],
            };
            let through = (held.ports[i], &held.openings[i]);
            let settling = settling(&self.driven[i].actuator, time, through, contents[i], held.slack[i], of_air);
            Matrix::of_reach(&slopes, settling, reach)
        });
        (rates, matrices)
    }
}

/// Both actuators on their own blocks of the matrix.
fn solve<R: Real>([first, second]: &[Matrix<R>; 2], right: [R; 6]) -> [R; 6] {
    let [angle, velocity, pressure, mass, other_pressure, other_mass] = right;
    let [angle, velocity, pressure, mass] = first.solve([angle, velocity, pressure, mass]);
    let [_, _, other_pressure, other_mass] = second.solve([R::zero(), R::zero(), other_pressure, other_mass]);
    [angle, velocity, pressure, mass, other_pressure, other_mass]
}

/// The secant from an actuator's pressure to that of its open port, by the flow alone: of the pressure's rate in 1/s, and of
/// the air mass's in kg/(s·Pa).
fn settling<R: Real>(
    actuator: &Actuator<R>,
    time: R,
    (ports, openings): (Ports, &Openings<R>),
    contents: [R; 4],
    slack: bool,
    rates: [R; 2],
) -> [R; 2] {
    let nothing = [R::zero(); 2];
    let Some(valve) = actuator.valve() else { return nothing };
    let [length, velocity, pressure, mass] = contents;
    let chamber = actuator.chamber(length, velocity, pressure, mass, slack);
    if let Some(shares) = openings.at(time) {
        return secants_of_shares(actuator, valve, &chamber, [ports.supply, ports.exhaust], shares);
    }
    if ports.supply == ports.exhaust {
        return nothing;
    }
    let own = valve.port_pressure(if ports.supply { Port::Supply } else { Port::Exhaust });
    let port = openings.pressure(time).unwrap_or(own);
    let by_flow = rates[0] - actuator.pressure_rate(&chamber, &Flow::none());
    let gap = port - pressure;
    let settling = by_flow / gap;
    // Where the pressures are equal there is no secant, and the tangent has the slope of the straight line.
    if gap.value() != 0.0 && settling.value() > 0.0 { [settling, rates[1] / gap] } else { nothing }
}
