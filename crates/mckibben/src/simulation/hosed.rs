//! One step of the fixed-step engine with a lumped hose between valve and actuator: the fifth state.
//!
//! The pressures of hose and actuator settle against each other, and the hose's against the port, in times far below a
//! step. The stable method takes both together: with the flow ṁ through the hose, that of the valve into it, and
//!
//! ```text
//! s = ṁ/(P₁ − P)        s_v = −∂ṁ_valve/∂P₁        χ = κRT/V        b = ∂(dP/dt)/∂ṁ
//!
//!         P      −b s      b s
//! A:      P₁      χ s     −χ (s + s_v)
//!         m       −s       s
//! ```
//!
//! stand in for the Jacobian of the air. s is the secant to equal pressures, steeper than the tangent in turbulent flow, and
//! s_v the steeper of tangent and secant to the port, so that neither flow overshoots; the method has order 2 for any
//! matrix.
//!
//! Checked by `tests/line_step.rs` against the event-located engine.

use super::kernel::{Held, Matrix, Method, Slopes, ahead, gathered, reaches, through_shares};
use super::rig::Rig;
use crate::air::{Chamber, Flow};
use crate::dual::Dual;
use crate::force::Statics;
use crate::line::{Hose, split};
use crate::load::Load;
use crate::scalar::{Over, Scalar};
use crate::valve::Port;

/// The states of the fixed-step engine: the rig's four, and the absolute pressure in Pa in its hose, which is without
/// meaning where there is none.
pub(crate) type Stepped<S> = [S; 5];

/// The rig's own four.
#[inline(always)]
pub(crate) fn of_rig<S: Copy>([length, velocity, pressure, mass, _]: &Stepped<S>) -> [S; 4] {
    [*length, *velocity, *pressure, *mass]
}

impl<S: Scalar, L: Statics<S>> Rig<S, L> {
    /// One part of a step, with a prescribed motion where it ends exactly.
    #[inline(always)]
    pub(crate) fn take(&self, method: Method, time: S, state: &Stepped<S>, step: S, held: &Held<S>) -> Stepped<S> {
        let midway = held.midway(method, time, step);
        let held = midway.as_ref().unwrap_or(held);
        let mut end = if L::MAY_HAVE_LINE
            && let Some(hose) = &self.line().hose
        {
            match method {
                Method::Rk4 => self.hosed_rk4(hose, time, state, step, held),
                Method::Stable => self.hosed_stable(hose, time, state, step, held),
            }
        } else {
            let four = of_rig(state);
            let [length, velocity, pressure, mass] = match method {
                Method::Rk4 => self.step_rk4(time, four, step, held),
                Method::Stable => self.step_stable(time, four, step, held),
            };
            [length, velocity, pressure, mass, state[4]]
        };
        if let Load::Prescribed(motion) = self.load() {
            [end[0], end[1], _] = motion.on_line(time + step, &held.line);
        }
        end
    }

    /// Flow of the leak into the actuator, if it has one.
    #[inline(always)]
    pub(super) fn leak<T: Over<S>>(&self, chamber: &Chamber<T>) -> Option<Flow<T>> {
        if !L::MAY_HAVE_LINE {
            return None;
        }
        let atmosphere = T::of(self.actuator().air().atmosphere().0);
        self.line().leakage.as_ref().map(|leakage| leakage.flow(chamber, atmosphere))
    }

    /// A flow, and that of the leak.
    #[inline(always)]
    pub(super) fn with_leak<T: Over<S>>(&self, chamber: &Chamber<T>, flow: Flow<T>) -> Flow<T> {
        match self.leak(chamber) {
            Some(leak) => flow.and(leak),
            None => flow,
        }
    }

    /// Flow into the actuator through a hose, and the leak's.
    #[inline(always)]
    pub(super) fn through_hose<T: Over<S>>(&self, hose: &Hose<S>, own: &Chamber<T>, pressure: T) -> Flow<T> {
        self.with_leak(own, split(hose.flow(pressure, own.pressure)))
    }

    /// Time derivatives of the five states.
    #[inline(always)]
    fn hosed_rates(&self, hose: &Hose<S>, time: S, state: &Stepped<S>, held: &Held<S>) -> Stepped<S> {
        let [length, velocity, pressure, mass, at_valve] = *state;
        let actuator = self.actuator();
        let [length, velocity, acceleration] = self.motion(time, [length, velocity, pressure], held);
        let own = actuator.chamber(length, velocity, pressure, mass, held.slack);
        let through = hose.flow(at_valve, pressure);
        let inflow = self.with_leak(&own, split(through));
        let valve = self.through_valve(time, &hose.chamber(at_valve), held);
        let hose_rate = hose.pressure_rate(valve.net() - through);
        [velocity, acceleration, actuator.pressure_rate(&own, &inflow), inflow.net(), hose_rate]
    }

    #[inline(always)]
    fn hosed_rk4(&self, hose: &Hose<S>, time: S, state: &Stepped<S>, step: S, held: &Held<S>) -> Stepped<S> {
        let mut slopes = [[S::zero(); 5]; 4];
        for (stage, reach) in reaches(step).into_iter().enumerate() {
            let at = ahead(state, reach, &slopes[stage.saturating_sub(1)]);
            slopes[stage] = self.hosed_rates(hose, time + reach, &at, held);
        }
        gathered(state, step, &slopes)
    }

    #[inline(always)]
    fn hosed_stable(&self, hose: &Hose<S>, time: S, state: &Stepped<S>, step: S, held: &Held<S>) -> Stepped<S> {
        let [length, velocity, pressure, mass, at_valve] = *state;
        let actuator = self.actuator();
        let ends: [Dual<S, 2>; 3] = [Dual::variable(length, 0), Dual::variable(velocity, 1), Dual::of(pressure)];
        let [length, velocity, acceleration] = self.motion(Dual::of(time), ends, held);
        let own = actuator.chamber(length.value, velocity.value, pressure, mass, held.slack);

        let seeded: Dual<S, 1> = Dual::variable(at_valve, 0);
        let through = hose.flow(seeded, Dual::of(pressure));
        let valve = self.through_valve(Dual::of(time), &hose.chamber(seeded), held).net();
        // The rate is linear in the flow; the leak and the volume do not settle here.
        let inflow = self.with_leak(&own, split(through.value));
        let outwards = through.value.lt(S::zero());
        let one_way = Flow {
            inward: S::select(outwards, S::zero(), S::one()),
            outward: S::select(outwards, S::one(), S::zero()),
        };
        let still = Chamber { volume_rate: S::zero(), ..own };
        let per_flow =
            (actuator.pressure_rate(&still, &one_way) - actuator.pressure_rate(&still, &Flow::none())).magnitude();
        let first = [
            velocity.value,
            acceleration.value,
            actuator.pressure_rate(&own, &inflow),
            inflow.net(),
            hose.pressure_rate(valve.value - through.value),
        ];

        let secant = secant(at_valve - pressure, through.value, through.slope[0]);
        let slopes = Slopes { acceleration: acceleration.slope, pressure_rate: S::zero(), mass_rate: S::zero() };
        let matrix = HosedMatrix {
            rig: Matrix::new(&slopes, [S::zero(); 2], step),
            air: Air::new(secant, self.valve_slope(time, at_valve, valve, held), hose.stiffness(), per_flow, step),
        };
        let k1 = matrix.solve(first);
        let second = self.hosed_rates(hose, time + step, &ahead(state, step, &k1), held);
        let second = ahead(&second, S::constant(-2.0), &k1);
        let k2 = match held.come_to(time + step) {
            None => matrix.solve(second),
            Some(held) => {
                let valve = self.through_valve(Dual::of(time), &hose.chamber(seeded), &held).net();
                let valve_slope = self.valve_slope(time, at_valve, valve, &held);
                let air = Air::new(secant, valve_slope, hose.stiffness(), per_flow, step);
                HosedMatrix { air, ..matrix }.solve(second)
            }
        };
        ahead(state, step * S::constant(0.5), &ahead(&k2, S::constant(3.0), &k1))
    }

    /// `−∂ṁ_valve/∂P₁`, or the secant to the open port where that is steeper; zero or more.
    #[inline(always)]
    fn valve_slope(&self, time: S, pressure: S, flow: Dual<S, 1>, held: &Held<S>) -> S {
        let Some(valve) = self.actuator().valve() else { return S::zero() };
        let tangent = (-flow.slope[0]).larger(S::zero());
        if S::IS_ONE
            && let (Some(shares), Some(hose)) = (held.openings.at(time), &self.line().hose)
        {
            let flows = through_shares(valve, &hose.chamber(pressure), [held.supply, held.exhaust], shares);
            let each = flows.map(|(gap, flow)| secant(gap, flow.net(), S::zero()));
            return tangent.larger(each[0] + each[1]);
        }
        let one_open = (held.supply | held.exhaust) & !(held.supply & held.exhaust);
        let port = S::select(held.supply, held.supply_pressure(valve, time), valve.port_pressure(Port::Exhaust));
        let secant = secant(port - pressure, flow.value, tangent);
        S::select(one_open, tangent.larger(secant), tangent)
    }
}

/// `flow/gap`, or the tangent where there is no gap.
#[inline(always)]
fn secant<S: Scalar>(gap: S, flow: S, tangent: S) -> S {
    S::select(S::zero().lt(gap.magnitude()), flow / gap, tangent)
}

/// `I − γhA` in the blocks that it has: length and velocity, then the air.
struct HosedMatrix<S> {
    rig: Matrix<S>,
    air: Air<S>,
}

/// The block of both pressures and the actuator's air.
struct Air<S> {
    /// γh s.
    flow: S,
    /// γh b s.
    actuator: S,
    /// γh χ s.
    hose: S,
    /// γh χ s_v.
    valve: S,
    per_determinant: S,
}

impl<S: Scalar> Air<S> {
    #[inline(always)]
    fn new(secant: S, valve: S, stiffness: S, per_flow: S, step: S) -> Self {
        let reach = step * S::constant(1.0 + core::f64::consts::FRAC_1_SQRT_2);
        let flow = reach * secant;
        let (actuator, hose, valve) = (flow * per_flow, flow * stiffness, reach * valve * stiffness);
        let determinant = (S::one() + actuator) * (S::one() + valve) + hose;
        Self { flow, actuator, hose, valve, per_determinant: S::one() / determinant }
    }
}

impl<S: Scalar> HosedMatrix<S> {
    #[inline(always)]
    fn solve(&self, right: Stepped<S>) -> Stepped<S> {
        let [length, velocity, ..] = self.rig.solve(of_rig(&right));
        let Air { flow, actuator, hose, valve, per_determinant } = self.air;
        let (own, at_valve) = (right[2], right[4]);
        let pressure = ((S::one() + hose + valve) * own + actuator * at_valve) * per_determinant;
        let hose_pressure = ((S::one() + actuator) * at_valve + hose * own) * per_determinant;
        let mass = right[3] + flow * (hose_pressure - pressure);
        [length, velocity, pressure, mass, hose_pressure]
    }
}
