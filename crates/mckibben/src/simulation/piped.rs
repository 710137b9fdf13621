//! One step of the fixed-step engine with an air line: hose, reservoir, compressor and regulator.
//!
//! | states | of | unit |
//! |---|---|---|
//! | P₁ … P_n | the hose's volumes, the one at the valve first | Pa, absolute |
//! | w₁ … w_n | flows out of the cells of a distributed hose, towards the actuator | kg/s |
//! | P_r | the reservoir | Pa, absolute |
//! | P_s | the regulator's outlet | Pa, absolute |
//!
//! The rates are those of the event-located engine, with selects where that has modes: for the pieces of the flow laws and
//! for the dead band. The compressor is held, and its switch ends a part of a step.
//!
//! Pressures of a line settle against each other in times far below a step. The stable method takes all of them together,
//! by the linear system of [`chain`](super::chain), in which
//!
//! ```text
//! through the valve, and through a lumped hose     the steeper of the tangent ∂ṁ/∂P and the secant ṁ/ΔP
//! through a cell, over γh                          σ = γh A/Δx / (1 + γh A/Δx d)        d = ∂Δp/∂w
//! actuator                                         b = ∂(dP/dt)/∂ṁ, and the rate at which its own growth lowers P
//! ```
//!
//! stand in for the Jacobian of the air, so that no flow overshoots what it goes to. Of a cell d is the steeper of the
//! tangent at the flow that there is and of that at the one which the pressures could keep up: it comes to that within
//! the step. The method has order 2 for any matrix, and keeps every linear invariant that rates and matrix keep: no air is
//! lost between tank, hose and actuator.
//!
//! Checked by `tests/line_rig.rs` and `tests/line_step.rs` against the event-located engine.

use super::chain::{Cells, Chain, End, Outlet, Source, Valve};
use super::kernel::{Held, Matrix, Method, Slopes, reach, reaches, through_shares};
use super::rig::Rig;
use crate::air::{Chamber, Flow};
use crate::dual::Dual;
use crate::force::Statics;
use crate::line::{Hose, HoseKind, MAX_CELLS, SupplyLine, split};
use crate::load::Load;
use crate::scalar::{Over, Scalar, Work};
use crate::valve::Port;

/// How many states a rig has without hose and supply line, and how many there is room for with them.
pub(crate) const PLAIN: usize = 4;
pub(crate) const PIPED: usize = 6 + 2 * MAX_CELLS;
/// How many there are with a line that has no cells.
pub(crate) const SHORT: usize = 7;
/// Places of the reservoir's pressure and of the regulator's.
pub(crate) const RESERVOIR: usize = 5;
pub(crate) const OUTLET: usize = 6;

/// The states of the fixed-step engine: the rig's four, then those of its line at their places. What is not there is zero.
pub(crate) type Stepped<S, const N: usize = PIPED> = [S; N];

/// The rig's own four.
#[inline(always)]
pub(crate) fn of_rig<S: Copy, const N: usize>(state: &Stepped<S, N>) -> [S; 4] {
    [state[0], state[1], state[2], state[3]]
}

/// Place of the pressure of a volume of the hose, counted from the valve.
#[inline(always)]
pub(crate) fn volume(cell: usize) -> usize {
    if cell == 0 { PLAIN } else { 6 + 2 * cell }
}

/// Place of the flow out of a cell.
#[inline(always)]
pub(crate) fn flow(cell: usize) -> usize {
    7 + 2 * cell
}

/// A flow through the valve.
#[derive(Clone, Copy)]
struct AtValve<T> {
    /// Into what it opens into.
    into: Flow<T>,
    /// What of it comes from a supply that changes, in kg/s.
    drawn: T,
}

impl<S: Scalar, L: Statics<S>> Rig<S, L> {
    /// Whether there are states beyond the rig's four: a hose, or a supply that changes.
    #[inline(always)]
    pub(crate) fn is_piped(&self) -> bool {
        L::MAY_HAVE_LINE && (self.line().hose.is_some() || self.line().supply.is_some())
    }

    /// Whether the hose is a line of cells.
    #[inline(always)]
    pub(crate) fn has_cells(&self) -> bool {
        matches!(self.line().hose, Some(Hose { kind: HoseKind::Distributed { .. }, .. }))
    }

    /// How many places of the states are in use.
    #[inline(always)]
    pub(crate) fn states_in_use(&self) -> usize {
        match &self.line().hose {
            Some(Hose { kind: HoseKind::Distributed { cells }, .. }) => flow(*cells) - 1,
            _ if self.is_piped() => OUTLET + 1,
            _ => PLAIN,
        }
    }

    /// The states of the line: their places, what they are, and their units.
    pub(crate) fn states_of_line(&self) -> impl Iterator<Item = (usize, &'static str, &'static str)> {
        let line = self.line();
        let (volumes, flows) = match line.hose.as_ref().map(Hose::kind) {
            None => (0, 0),
            Some(HoseKind::Lumped) => (1, 0),
            Some(HoseKind::Distributed { cells }) => (cells, cells),
        };
        let supply = line.supply.as_ref();
        let (reservoir, regulator) =
            (supply.and_then(|supply| supply.reservoir()), supply.and_then(|supply| supply.regulator()));
        let volumes = (0..volumes).map(|cell| (volume(cell), "absolute pressure in the hose", "Pa"));
        let flows = (0..flows).map(|cell| (flow(cell), "flow in the hose", "kg/s"));
        let reservoir = reservoir.map(|_| (RESERVOIR, "absolute pressure of the reservoir", "Pa"));
        let regulator = regulator.map(|_| (OUTLET, "absolute pressure behind the regulator", "Pa"));
        volumes.chain(flows).chain(reservoir).chain(regulator)
    }

    /// One part of a step, with a prescribed motion where it ends exactly.
    #[inline(always)]
    pub(crate) fn take<const N: usize>(
        &self,
        method: Method,
        time: S,
        state: &Stepped<S, N>,
        step: S,
        held: &Held<S>,
    ) -> Stepped<S, N> {
        let midway = held.midway(method, time, step);
        let held = midway.as_ref().unwrap_or(held);
        // A batch puts rows with cells together, rows with another line, and rows without any.
        let mut end = if N > PLAIN && (!S::IS_ONE || self.is_piped()) {
            match N > SHORT && (!S::IS_ONE || self.has_cells()) {
                true => S::apart(Piped::<S, L, N, MAX_CELLS> { rig: self, method, time, state, step, held }),
                false => {
                    let state = &shortened(state);
                    lengthened(S::apart(Piped::<S, L, SHORT, 1> { rig: self, method, time, state, step, held }))
                }
            }
        } else {
            let mut end = *state;
            let four = of_rig(state);
            [end[0], end[1], end[2], end[3]] = match method {
                Method::Rk4 => self.step_rk4(time, four, step, held),
                Method::Stable => self.step_stable(time, four, step, held),
            };
            end
        };
        if let Load::Prescribed(motion) = self.load() {
            [end[0], end[1], _] = motion.on_line(time + step, &held.line);
        }
        end
    }

    /// One part of a step in which the stable method would take more air than there is: by one stage with γ = 1.
    pub(crate) fn take_firm<const N: usize>(
        &self,
        time: S,
        state: &Stepped<S, N>,
        step: S,
        held: &Held<S>,
    ) -> Stepped<S, N> {
        let method = Method::Stable;
        let midway = held.midway(method, time, step);
        let come_to = held.come_to(time + step);
        let held = midway.as_ref().or(come_to.as_ref()).unwrap_or(held);
        let mut end = if N > PLAIN && self.is_piped() {
            match self.has_cells() {
                true => S::apart(Firm(Piped::<S, L, N, MAX_CELLS> { rig: self, method, time, state, step, held })),
                false => {
                    let state = &shortened(state);
                    lengthened(S::apart(Firm(Piped::<S, L, SHORT, 1> { rig: self, method, time, state, step, held })))
                }
            }
        } else {
            let mut end = *state;
            [end[0], end[1], end[2], end[3]] = self.step_firm(time, of_rig(state), step, held);
            end
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

    /// The pressure in Pa behind the valve's port to the supply, where that changes.
    #[inline(always)]
    pub(crate) fn feed<T: Copy, const N: usize>(&self, state: &Stepped<T, N>) -> Option<T> {
        match &self.line().supply {
            Some(supply) if N > PLAIN && supply.regulator().is_some() => Some(state[OUTLET]),
            Some(supply) if N > PLAIN && supply.reservoir().is_some() => Some(state[RESERVOIR]),
            _ => None,
        }
    }

    /// Content of the hose in kg, if there is one.
    #[inline(always)]
    pub(crate) fn hose_content<const N: usize>(&self, state: &Stepped<S, N>) -> Option<S> {
        let Some(hose) = &self.line().hose else { return None };
        let mut content = S::zero();
        for cell in 0..hose.cells() {
            content = content + hose.content(state[volume(cell)]);
        }
        Some(content)
    }

    /// What the valve opens into, of which `own` is the actuator's air.
    #[inline(always)]
    pub(super) fn before<T: Over<S>, const N: usize>(&self, own: &Chamber<T>, state: &Stepped<T, N>) -> Chamber<T> {
        match &self.line().hose {
            Some(hose) => hose.chamber(state[volume(0)]),
            None => *own,
        }
    }

    #[inline(always)]
    fn at_valve<T: Over<S>>(&self, time: T, before: &Chamber<T>, feed: Option<T>, held: &Held<S>) -> AtValve<T> {
        let (Some(feed), Some(valve)) = (feed, self.actuator().valve()) else {
            return AtValve { into: self.through_valve(time, before, held), drawn: T::zero() };
        };
        let mut supply = valve.flow_at(feed, before).where_open(held.supply);
        let mut exhaust = valve.flow(Port::Exhaust, before).where_open(held.exhaust);
        if S::IS_ONE
            && let Some([share, other]) = held.openings.at(time)
        {
            (supply, exhaust) = (supply.through(share), exhaust.through(other));
        }
        AtValve { into: supply.and(exhaust), drawn: supply.net() }
    }

    /// Flow into the actuator, the leak's too, of a rig that is piped.
    #[inline(always)]
    pub(super) fn actuator_inflow<const N: usize>(
        &self,
        time: S,
        state: &Stepped<S, N>,
        own: &Chamber<S>,
        held: &Held<S>,
    ) -> Flow<S> {
        let flow = match &self.line().hose {
            Some(hose) => split(last_flow(hose, state)),
            None => self.at_valve(time, own, self.feed(state), held).into,
        };
        self.with_leak(own, flow)
    }
}

/// The states of a line without cells.
#[inline(always)]
fn shortened<S: Scalar, const N: usize>(state: &Stepped<S, N>) -> Stepped<S, SHORT> {
    let mut short = [S::zero(); SHORT];
    let count = SHORT.min(N);
    short[..count].copy_from_slice(&state[..count]);
    short
}

/// The same with room for cells.
#[inline(always)]
fn lengthened<S: Scalar, const N: usize>(short: Stepped<S, SHORT>) -> Stepped<S, N> {
    let mut state = [S::zero(); N];
    let count = SHORT.min(N);
    state[..count].copy_from_slice(&short[..count]);
    state
}

/// Flow in kg/s out of a hose into the actuator.
#[inline(always)]
fn last_flow<S: Scalar, const N: usize>(hose: &Hose<S>, state: &Stepped<S, N>) -> S {
    match hose.kind {
        HoseKind::Lumped => hose.flow(state[volume(0)], state[2]),
        HoseKind::Distributed { cells } => state[flow(cells - 1)],
    }
}

/// A part of a step of a rig with a line: too long to be compiled into all who take one.
struct Piped<'a, S: Scalar, L, const N: usize, const C: usize> {
    rig: &'a Rig<S, L>,
    method: Method,
    time: S,
    state: &'a Stepped<S, N>,
    step: S,
    held: &'a Held<S>,
}

impl<S: Scalar, L: Statics<S>, const N: usize, const C: usize> Work for Piped<'_, S, L, N, C> {
    type Output = Stepped<S, N>;

    #[inline(always)]
    fn done(self) -> Stepped<S, N> {
        match self.method {
            Method::Rk4 => self.rk4(),
            Method::Stable => self.stable(),
        }
    }
}

/// The same by one stage with γ = 1.
struct Firm<'a, S: Scalar, L, const N: usize, const C: usize>(Piped<'a, S, L, N, C>);

impl<S: Scalar, L: Statics<S>, const N: usize, const C: usize> Work for Firm<'_, S, L, N, C> {
    type Output = Stepped<S, N>;

    #[inline(always)]
    fn done(self) -> Stepped<S, N> {
        let Self(of) = self;
        let (first, chain) = of.rates_and_chain(of.held, of.step);
        along(of.state, of.step, &chain.solve(&first), of.rig.states_in_use())
    }
}

impl<S: Scalar, L: Statics<S>, const N: usize, const C: usize> Piped<'_, S, L, N, C> {
    /// Time derivatives of all states.
    #[inline(always)]
    fn rates(&self, time: S, state: &Stepped<S, N>, held: &Held<S>) -> Stepped<S, N> {
        let [length, velocity, pressure, mass] = of_rig(state);
        let motion = self.rig.motion(time, [length, velocity, pressure], held);
        let own = self.rig.actuator().chamber(motion[0], motion[1], pressure, mass, held.slack);
        let at_valve = self.rig.at_valve(time, &self.rig.before(&own, state), self.rig.feed(state), held);
        let last = match &self.rig.line().hose {
            Some(hose) => last_flow(hose, state),
            None => at_valve.into.net(),
        };
        self.balances(state, motion, &own, (at_valve, last), held)
    }

    /// The rates, from what goes through the valve and what goes from a hose into the actuator.
    #[inline(always)]
    fn balances(
        &self,
        state: &Stepped<S, N>,
        motion: [S; 3],
        own: &Chamber<S>,
        (AtValve { into, drawn }, last): (AtValve<S>, S),
        held: &Held<S>,
    ) -> Stepped<S, N> {
        let (actuator, line) = (self.rig.actuator(), self.rig.line());
        let mut rates = [S::zero(); N];
        let mut inflow = into;
        if let Some(hose) = &line.hose {
            inflow = split(last);
            let mut before = into.net();
            for cell in 0..hose.cells() {
                let mut through = last;
                if let HoseKind::Distributed { cells } = hose.kind {
                    through = state[flow(cell)];
                    let next = if cell + 1 == cells { state[2] } else { state[volume(cell + 1)] };
                    rates[flow(cell)] = hose.flow_rate(through, state[volume(cell)], next);
                }
                rates[volume(cell)] = hose.pressure_rate(before - through);
                before = through;
            }
        }
        if let Some(supply) = &line.supply {
            self.supply_rates(supply, state, drawn * supply.actuators(), held, &mut rates);
        }
        let inflow = self.rig.with_leak(own, inflow);
        [rates[0], rates[1]] = [motion[1], motion[2]];
        [rates[2], rates[3]] = [actuator.pressure_rate(own, &inflow), inflow.net()];
        rates
    }

    #[inline(always)]
    fn supply_rates(
        &self,
        supply: &SupplyLine<S>,
        state: &Stepped<S, N>,
        drawn: S,
        held: &Held<S>,
        rates: &mut Stepped<S, N>,
    ) {
        if let Some(reservoir) = supply.reservoir() {
            let delivered = match reservoir.compressor() {
                Some(_) => S::select(held.compressor, reservoir.delivery(state[RESERVOIR]), S::zero()),
                None => S::zero(),
            };
            rates[RESERVOIR] = reservoir.pressure_rate(delivered - drawn);
        }
        if let Some(regulator) = supply.regulator() {
            let inlet = if supply.reservoir().is_some() { Some(state[RESERVOIR]) } else { None };
            rates[OUTLET] = regulator.rate(regulator.error(state[OUTLET], self.set(), inlet, drawn));
        }
    }

    /// What the regulator is set to, in Pa.
    #[inline(always)]
    fn set(&self) -> S {
        match self.rig.actuator().valve() {
            Some(valve) => valve.port_pressure(Port::Supply),
            None => S::zero(),
        }
    }

    #[inline(always)]
    fn rk4(&self) -> Stepped<S, N> {
        let (state, used) = (self.state, self.rig.states_in_use());
        let mut slopes = [[S::zero(); N]; 4];
        for (stage, reach) in reaches(self.step).into_iter().enumerate() {
            let at = along(state, reach, &slopes[stage.saturating_sub(1)], used);
            slopes[stage] = self.rates(self.time + reach, &at, self.held);
        }
        let [k1, k2, k3, k4] = &slopes;
        let (outer, inner) = (along(k1, S::one(), k4, used), along(k2, S::one(), k3, used));
        along(state, self.step * S::constant(1.0 / 6.0), &along(&outer, S::constant(2.0), &inner, used), used)
    }

    #[inline(always)]
    fn stable(&self) -> Stepped<S, N> {
        let (state, used) = (self.state, self.rig.states_in_use());
        let (first, chain) = self.rates_and_chain(self.held, reach(self.step));
        let k1 = chain.solve(&first);
        let second = self.rates(self.time + self.step, &along(state, self.step, &k1, used), self.held);
        let second = along(&second, S::constant(-2.0), &k1, used);
        let k2 = match self.held.come_to(self.time + self.step) {
            None => chain.solve(&second),
            Some(held) => self.rates_and_chain(&held, reach(self.step)).1.solve(&second),
        };
        along(state, self.step * S::constant(0.5), &along(&k2, S::constant(3.0), &k1, used), used)
    }

    /// The rates where the part begins, and the system of a reach in s.
    #[inline(always)]
    fn rates_and_chain(&self, held: &Held<S>, reach: S) -> (Stepped<S, N>, Chain<S, C>) {
        let (rig, state) = (self.rig, self.state);
        let (actuator, [length, velocity, pressure, mass]) = (rig.actuator(), of_rig(state));
        let ends: [Dual<S, 2>; 3] = [Dual::variable(length, 0), Dual::variable(velocity, 1), Dual::of(pressure)];
        let [length, velocity, acceleration] = rig.motion(Dual::of(self.time), ends, held);
        let motion = [length.value, velocity.value, acceleration.value];
        let own = actuator.chamber(motion[0], motion[1], pressure, mass, held.slack);
        let slopes = Slopes { acceleration: acceleration.slope, pressure_rate: S::zero(), mass_rate: S::zero() };

        let (at_valve, valve) = self.valve(motion, held);
        let (cells, into) = match &rig.line().hose {
            Some(hose) => {
                let (cells, last) = self.cells(hose, reach);
                (Some(cells), last)
            }
            None => (None, at_valve.into.net()),
        };
        let first = self.balances(state, motion, &own, (at_valve, into), held);
        let source = match &rig.line().supply {
            Some(supply) => Some(self.source(supply, at_valve.drawn, held, reach)),
            None => None,
        };
        let falls = (-actuator.pressure_rate(&own, &Flow::none()) * own.per_pressure).larger(S::zero());
        let end = End { reach, per_flow: self.per_flow(&own, into), leak: self.leak_slope(motion, held), falls };
        (first, Chain::new(Matrix::of_reach(&slopes, [S::zero(); 2], reach), end, cells, valve, source))
    }

    /// `∂(dP/dt)/∂ṁ` in Pa/kg for a flow of this direction; the rate is linear in the flow.
    #[inline(always)]
    fn per_flow(&self, own: &Chamber<S>, into: S) -> S {
        let outwards = into.lt(S::zero());
        let one_way = Flow {
            inward: S::select(outwards, S::zero(), S::one()),
            outward: S::select(outwards, S::one(), S::zero()),
        };
        let still = Chamber { volume_rate: S::zero(), ..*own };
        let actuator = self.rig.actuator();
        (actuator.pressure_rate(&still, &one_way) - actuator.pressure_rate(&still, &Flow::none())).magnitude()
    }

    #[inline(always)]
    fn leak_slope(&self, [length, velocity, _]: [S; 3], held: &Held<S>) -> S {
        if self.rig.line().leakage.is_none() {
            return S::zero();
        }
        let pressure: Dual<S, 1> = Dual::variable(self.state[2], 0);
        let (ends, mass) = ([Dual::of(length), Dual::of(velocity)], Dual::of(self.state[3]));
        let own = self.rig.actuator().chamber(ends[0], ends[1], pressure, mass, held.slack);
        match self.rig.leak(&own) {
            Some(leak) => (-leak.net().slope[0]).larger(S::zero()),
            None => S::zero(),
        }
    }

    /// What the valve opens into, with derivatives by its pressure as the first variable.
    #[inline(always)]
    fn opens_into<const K: usize>(&self, [length, velocity, _]: [S; 3], held: &Held<S>) -> Chamber<Dual<S, K>> {
        let (rig, state) = (self.rig, self.state);
        match &rig.line().hose {
            Some(hose) => hose.chamber(Dual::variable(state[volume(0)], 0)),
            None => {
                let (ends, mass) = ([Dual::of(length), Dual::of(velocity)], Dual::of(state[3]));
                rig.actuator().chamber(ends[0], ends[1], Dual::variable(state[2], 0), mass, held.slack)
            }
        }
    }

    /// What goes through the valve, and how it answers to the pressures at both its ends.
    #[inline(always)]
    fn valve(&self, motion: [S; 3], held: &Held<S>) -> (AtValve<S>, Valve<S>) {
        let (rig, zero) = (self.rig, S::zero());
        let Some(feed) = rig.feed(self.state) else {
            let before: Chamber<Dual<S, 1>> = self.opens_into(motion, held);
            let into = rig.at_valve(Dual::of(self.time), &before, None, held).into;
            let outwards = self.outwards(into.net(), before.pressure.value, held);
            let into = Flow { inward: into.inward.value, outward: into.outward.value };
            return (AtValve { into, drawn: zero }, Valve { outwards, inwards: zero, feed: zero });
        };
        let before: Chamber<Dual<S, 2>> = self.opens_into(motion, held);
        let pressure = before.pressure.value;
        let AtValve { into, drawn } = rig.at_valve(Dual::of(self.time), &before, Some(Dual::variable(feed, 1)), held);
        let exhaust = into.net() - drawn;
        let [inwards, of_feed] = [(-drawn.slope[0]).larger(zero), drawn.slope[1].larger(zero)];
        let straight = secant(feed - pressure, drawn.value, zero);
        let outwards = (-exhaust.slope[0]).larger(zero);
        let to_exhaust = secant(self.exhaust() - pressure, exhaust.value, zero);
        let valve = Valve {
            outwards: outwards.larger(to_exhaust),
            inwards: inwards.larger(straight),
            feed: of_feed.larger(straight),
        };
        let into = Flow { inward: into.inward.value, outward: into.outward.value };
        (AtValve { into, drawn: drawn.value }, valve)
    }

    #[inline(always)]
    fn exhaust(&self) -> S {
        match self.rig.actuator().valve() {
            Some(valve) => valve.port_pressure(Port::Exhaust),
            None => S::zero(),
        }
    }

    /// `−∂ṁ/∂P` through a valve on a constant supply, or the secant to the open port where that is steeper.
    #[inline(always)]
    fn outwards(&self, flow: Dual<S, 1>, pressure: S, held: &Held<S>) -> S {
        let Some(valve) = self.rig.actuator().valve() else { return S::zero() };
        let tangent = (-flow.slope[0]).larger(S::zero());
        if S::IS_ONE
            && let (Some(shares), Some(hose)) = (held.openings.at(self.time), &self.rig.line().hose)
        {
            let flows = through_shares(valve, &hose.chamber(pressure), [held.supply, held.exhaust], shares);
            let each = flows.map(|(gap, flow)| secant(gap, flow.net(), S::zero()));
            return tangent.larger(each[0] + each[1]);
        }
        let one_open = (held.supply | held.exhaust) & !(held.supply & held.exhaust);
        let port = S::select(held.supply, held.supply_pressure(valve, self.time), self.exhaust());
        let secant = secant(port - pressure, flow.value, tangent);
        S::select(one_open, tangent.larger(secant), tangent)
    }

    /// The part of a hose, and the flow in kg/s out of it.
    #[inline(always)]
    fn cells(&self, hose: &Hose<S>, reach: S) -> (Cells<S, C>, S) {
        let (state, zero, one) = (self.state, S::zero(), S::one());
        let (mut lead, mut share) = ([zero; C], [zero; C]);
        let stiffness = reach * hose.stiffness();
        let HoseKind::Distributed { cells } = hose.kind else {
            let through = hose.flow(Dual::<S, 1>::variable(state[volume(0)], 0), Dual::of(state[2]));
            lead[0] = secant(state[volume(0)] - state[2], through.value, through.slope[0]);
            return (Cells { count: 1, stiffness, lead, share, inertia: false }, through.value);
        };
        for cell in 0..cells {
            let next = if cell + 1 == cells { state[2] } else { state[volume(cell + 1)] };
            let (pressure, now) = (state[volume(cell)], state[flow(cell)]);
            let drive = hose.per_inertance() * reach;
            share[cell] = one / drive.multiply_add(hose.steepest_loss(now, pressure, next), one);
            lead[cell] = drive * share[cell];
        }
        (Cells { count: cells, stiffness, lead, share, inertia: true }, state[flow(cells - 1)])
    }

    #[inline(always)]
    fn source(&self, supply: &SupplyLine<S>, drawn: S, held: &Held<S>, reach: S) -> Source<S> {
        let (state, zero, one) = (self.state, S::zero(), S::one());
        let mut reservoir = [zero; 2];
        if let Some(tank) = supply.reservoir() {
            let stiffness = reach * tank.pressure_rate(one);
            let mut falls = zero;
            if tank.compressor().is_some() {
                let delivery = tank.delivery(Dual::<S, 1>::variable(state[RESERVOIR], 0));
                falls = S::select(held.compressor, (-delivery.slope[0]).larger(zero), zero);
            }
            reservoir = [stiffness * supply.actuators(), one / stiffness.multiply_add(falls, one)];
        }
        let mut outlet = None;
        if let Some(regulator) = supply.regulator() {
            let (pressure, drawn) = (state[OUTLET], drawn * supply.actuators());
            let by_droop = regulator.error(pressure, self.set(), None, drawn);
            let mut limited = S::zero().lt(zero);
            let mut error = by_droop;
            if supply.reservoir().is_some() {
                error = regulator.error(pressure, self.set(), Some(state[RESERVOIR]), drawn);
                limited = error.lt(by_droop);
            }
            let rests = error.magnitude().le(regulator.dead_band()) & zero.lt(regulator.dead_band());
            outlet = Some(Outlet {
                rate: S::select(rests, zero, reach / regulator.lag()),
                droop: S::select(limited, zero, regulator.droop() * supply.actuators()),
                limited: S::select(limited, one, zero),
            });
        }
        Source { reservoir, regulator: outlet }
    }
}

/// `y + h k`, as far as the states are in use.
#[inline(always)]
fn along<S: Scalar, const N: usize>(
    state: &Stepped<S, N>,
    step: S,
    slope: &Stepped<S, N>,
    used: usize,
) -> Stepped<S, N> {
    let mut end = *state;
    for n in 0..used.min(N) {
        end[n] = slope[n].multiply_add(step, state[n]);
    }
    end
}

/// `flow/gap`, or the tangent where there is no gap; zero or more.
#[inline(always)]
fn secant<S: Scalar>(gap: S, flow: S, tangent: S) -> S {
    S::select(S::zero().lt(gap.magnitude()), flow / gap, tangent).larger(S::zero())
}
