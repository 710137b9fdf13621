//! The states of the air line, behind the four of the rig.
//!
//! | states | of | unit |
//! |---|---|---|
//! | P₁ … P_n | the hose's volumes, the one at the valve first | Pa, absolute |
//! | w₁ … w_n | flows out of the cells of a distributed hose, towards the actuator | kg/s |
//! | P_r | the reservoir | Pa, absolute |
//! | P_s | the regulator's outlet | Pa, absolute |
//! | p | beyond the port of a proportional pressure regulator ([`regulated`](super::regulated)) | Pa, absolute |
//!
//! What is not there has no state. The flow law of the valve meets the hose's first volume instead of the actuator, and the
//! reservoir or the regulator instead of the constant supply. Components of the mode are the regime of the flow through a
//! lumped hose, the compressor's switch and the regulator's poppet; the cells of a distributed hose take their law, whose
//! slope is continuous, as a whole.

use super::member::Member;
use super::mode::{EventKind, Guard};
use super::regulated::{PortMode, RegulatedPort};
use super::rig::Rig;
use super::system::{GuardForm, Guards};
use super::zones::{MEETING, Places, Through};
use crate::air::{Chamber, Flow};
use crate::dual::Dual;
#[cfg(feature = "alloc")]
use crate::line::MAX_CELLS;
use crate::line::{FlowRegime, HoseKind, Line, Poppet, SupplyLine, split};
use crate::scalar::{Over, Real};
use crate::valve::{Beyond, FlowZone, Port, Valve};

/// Place of the first state of the line.
pub(super) const FIRST: usize = 4;
/// The most states that a rig with a line, bristles and a load on a tendon may have.
#[cfg(feature = "alloc")]
pub(super) const MOST: usize = FIRST + 2 * MAX_CELLS + 4;
/// Part of the flow at the speed of sound from the surroundings below which an error in a flow counts absolutely.
const SLOW: f64 = 0.1;
/// Part of a bound between two regimes by which it is passed at least: their slopes agree there.
const LEAST_BAND: f64 = 1e-6;

/// The line's part of the mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LineMode {
    /// Of the flow through a lumped hose.
    pub(super) regime: FlowRegime,
    pub(super) compressor_runs: bool,
    pub(super) poppet: Poppet,
    pub(super) port: PortMode,
}

impl LineMode {
    pub(super) const AT_REST: Self =
        Self { regime: FlowRegime::Laminar, compressor_runs: false, poppet: Poppet::Rests, port: PortMode::AT_REST };
}

/// A line and the places of its states.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plumbing<'a, R: Real> {
    line: &'a Line<R>,
    volumes: usize,
    flows: usize,
    reservoir: Option<usize>,
    regulator: Option<usize>,
    regulated: Option<RegulatedPort<'a, R>>,
    /// How many states there are, those of the rig included.
    pub(super) states: usize,
}

/// The air at the two ends of the valve: what it opens into, and beyond its port to the supply.
struct Ends<T> {
    chamber: Chamber<T>,
    supply: T,
}

impl<'a, R: Real> Plumbing<'a, R> {
    /// The places of the states of a rig's line, unless it has no part and no pressure is regulated.
    pub(super) fn new(rig: &'a Rig<R>) -> Option<Self> {
        let line = rig.line();
        if !rig.has_plumbing() {
            return None;
        }
        let (volumes, flows) = match line.hose.map(|hose| hose.kind()) {
            None => (0, 0),
            Some(HoseKind::Lumped) => (1, 0),
            Some(HoseKind::Distributed { cells }) => (cells, cells),
        };
        let mut states = FIRST + volumes + flows;
        let mut place = |there: bool| {
            states += usize::from(there);
            there.then(|| states - 1)
        };
        let reservoir = place(line.supply.is_some_and(|supply| supply.reservoir().is_some()));
        let regulator = place(line.supply.is_some_and(|supply| supply.regulator().is_some()));
        // No supply that changes feeds a regulated port: it stands in its place.
        let regulated = RegulatedPort::new(rig.actuation(), rig.actuator(), states);
        states += usize::from(regulated.is_some());
        Some(Self { line, volumes, flows, reservoir, regulator, regulated, states })
    }

    /// Places of the pressures that the air depends on.
    pub(super) fn places(&self) -> Places {
        let own = super::hybrid::PRESSURE;
        let valve = if self.volumes > 0 { FIRST } else { own };
        let regulated = self.regulated.map(|port| port.place);
        Places { own, valve, supply: regulated.or(self.regulator).or(self.reservoir) }
    }

    fn supply(&self) -> Option<&SupplyLine<R>> {
        self.line.supply.as_ref()
    }

    /// The states of the line at the start: the hose at the actuator's pressure and at rest, the regulator at what it is set
    /// to or what the reservoir gives.
    pub(super) fn start<const N: usize>(&self, member: &Member<'_, R>, state: &mut [R; N]) {
        let pressure = state[super::hybrid::PRESSURE];
        for place in FIRST..FIRST + self.volumes {
            state[place] = pressure;
        }
        let set = member.actuator.valve().map_or(pressure, |valve| valve.port_pressure(Port::Supply));
        let reservoir = self.supply().and_then(|supply| supply.reservoir()).map(|reservoir| reservoir.start().0);
        if let (Some(place), Some(pressure)) = (self.reservoir, reservoir) {
            state[place] = pressure;
        }
        if let Some(place) = self.regulator {
            state[place] = reservoir.map_or(set, |pressure| set.smaller(pressure));
        }
        if let (Some(port), Some(valve)) = (&self.regulated, member.actuator.valve()) {
            state[port.place] = RegulatedPort::start(valve, pressure);
        }
    }

    /// The next instant in s at which a set point takes effect, up to and with `until`.
    pub(super) fn next_set_point(&self, line: &LineMode, until: R) -> Option<R> {
        self.regulated?.next(&line.port, until)
    }

    /// Lets the set points up to and with `time` take effect; whether there was one.
    pub(super) fn pass_set_points<const N: usize>(&self, time: R, state: &[R; N], line: &mut LineMode) -> bool {
        self.regulated.is_some_and(|port| port.pass(time, state, &mut line.port))
    }

    /// Decides the poppet anew where the flow has jumped.
    pub(super) fn pass_seats<const N: usize>(
        &self,
        member: &Member<'_, R>,
        state: &[R; N],
        through: Through<'_, R>,
        line: &mut LineMode,
    ) {
        line.poppet = self.enter(member, state, through).poppet;
    }

    /// The regime of the flow through a lumped hose.
    fn regime<const N: usize>(&self, state: &[R; N]) -> Option<FlowRegime> {
        let drive = self.drive(state)?.value();
        FlowRegime::RISING.into_iter().find(|regime| regime.bounds()[1].is_none_or(|end| drive <= end))
    }

    /// The drive of the flow through a lumped hose.
    fn drive<T: Over<R>, const N: usize>(&self, state: &[T; N]) -> Option<T> {
        let hose = self.line.hose.as_ref().filter(|_| self.flows == 0)?;
        Some(hose.tube().drive(state[FIRST], state[super::hybrid::PRESSURE]))
    }

    /// The line's part of the mode in a state: a compressor runs from the start below its upper pressure.
    pub(super) fn enter<const N: usize>(
        &self,
        member: &Member<'_, R>,
        state: &[R; N],
        through: Through<'_, R>,
    ) -> LineMode {
        let reservoir = self.supply().and_then(|supply| supply.reservoir());
        let stops = reservoir.and_then(|reservoir| reservoir.switch_pressures()).map(|[_, stops]| stops.value());
        let at = self.reservoir.map(|place| state[place].value());
        let error = self.regulator_error(member, state, through);
        let regulator = self.supply().and_then(|supply| supply.regulator());
        LineMode {
            regime: self.regime(state).unwrap_or(FlowRegime::Laminar),
            compressor_runs: stops.zip(at).is_some_and(|(stops, at)| at < stops),
            poppet: regulator.zip(error).map_or(Poppet::Rests, |(regulator, error)| regulator.poppet(error)),
            port: PortMode::AT_REST,
        }
    }

    /// The pressure that feeds the valve.
    fn feed<T: Over<R>, const N: usize>(&self, valve: &Valve<R>, state: &[T; N]) -> T {
        self.places().supply.map_or_else(|| T::of(valve.port_pressure(Port::Supply)), |place| state[place])
    }

    fn ends<T: Over<R>, const N: usize>(&self, valve: &Valve<R>, own: &Chamber<T>, state: &[T; N]) -> Ends<T> {
        let chamber = self.line.hose.as_ref().map_or(*own, |hose| hose.chamber(state[FIRST]));
        Ends { chamber, supply: self.feed(valve, state) }
    }

    /// Flows through the valve's two passages, into what it opens into, in a mode.
    #[inline(always)]
    pub(super) fn passages<T: Over<R>, const N: usize>(
        &self,
        member: &Member<'_, R>,
        own: &Chamber<T>,
        state: &[T; N],
        Through { mode, shares, .. }: Through<'_, T>,
    ) -> [Flow<T>; 2] {
        let Some(valve) = member.actuator.valve() else { return [Flow::none(); 2] };
        let Ends { chamber, supply } = self.ends(valve, own, state);
        let through = |port: Port, zone: Option<FlowZone>, pressure: T| {
            zone.map_or(Flow::none(), |zone| {
                valve.flow_in_zone_from(port, &Beyond::at(pressure, T::one()), zone, &chamber)
            })
        };
        let exhaust = T::of(valve.port_pressure(Port::Exhaust));
        let flows =
            [through(Port::Supply, mode.supply_zone, supply), through(Port::Exhaust, mode.exhaust_zone, exhaust)];
        match shares {
            None => flows,
            Some([supply, exhaust]) => [flows[0].through(supply), flows[1].through(exhaust)],
        }
    }

    fn leak<T: Over<R>>(&self, member: &Member<'_, R>, own: &Chamber<T>) -> Flow<T> {
        let atmosphere = T::of(member.actuator.air().atmosphere().0);
        self.line.leakage.as_ref().map_or(Flow::none(), |leakage| leakage.flow(own, atmosphere))
    }

    /// Flow between the line and the surroundings or the supply: through the valve and through the leak.
    #[cfg(feature = "alloc")]
    pub(super) fn exchange<const N: usize>(
        &self,
        member: &Member<'_, R>,
        own: &Chamber<R>,
        state: &[R; N],
        through: Through<'_, R>,
    ) -> Flow<R> {
        let [supply, exhaust] = self.passages(member, own, state, through);
        supply.and(exhaust).and(self.leak(member, own))
    }

    /// Content of the hose in kg.
    #[cfg(feature = "alloc")]
    pub(super) fn content<const N: usize>(&self, state: &[R; N]) -> R {
        let Some(hose) = &self.line.hose else { return R::zero() };
        (FIRST..FIRST + self.volumes).fold(R::zero(), |sum, place| sum + hose.content(state[place]))
    }

    /// Flow out of the hose into the actuator, if there is a hose.
    #[inline(always)]
    fn out_of_hose<T: Over<R>, const N: usize>(&self, own: &Chamber<T>, state: &[T; N], line: &LineMode) -> Option<T> {
        let hose = self.line.hose.as_ref()?;
        Some(match self.flows {
            0 => hose.tube().flow_in(line.regime, state[FIRST], own.pressure),
            flows => state[FIRST + self.volumes + flows - 1],
        })
    }

    /// Flow into the actuator from hose or valve and through the leak.
    pub(super) fn inflow<T: Over<R>, const N: usize>(
        &self,
        member: &Member<'_, R>,
        own: &Chamber<T>,
        state: &[T; N],
        (through, line): (Through<'_, T>, &LineMode),
    ) -> Flow<T> {
        let inflow = self.out_of_hose(own, state, line).map(split).unwrap_or_else(|| {
            let [supply, exhaust] = self.passages(member, own, state, through);
            supply.and(exhaust)
        });
        inflow.and(self.leak(member, own))
    }

    /// The rates of the line's states, and the flow into the actuator, of which `own` is the air.
    #[inline(always)]
    pub(super) fn rates<T: Over<R>, const N: usize>(
        &self,
        member: &Member<'_, R>,
        own: &Chamber<T>,
        state: &[T; N],
        (through, line): (Through<'_, T>, &LineMode),
        rates: &mut [T; N],
    ) -> Flow<T> {
        let [supply, exhaust] = self.passages(member, own, state, through);
        let out_of_hose = self.out_of_hose(own, state, line);
        let mut into_actuator = supply.and(exhaust);
        if let (Some(hose), Some(last)) = (&self.line.hose, out_of_hose) {
            let mut inflow = into_actuator.net();
            into_actuator = split(last);
            let flows = FIRST + self.volumes;
            for cell in 0..self.volumes {
                let (pressure, next) = (state[FIRST + cell], FIRST + cell + 1);
                let next = if next == flows { own.pressure } else { state[next] };
                let outflow = if self.flows == 0 { last } else { state[flows + cell] };
                rates[FIRST + cell] = hose.pressure_rate(inflow - outflow);
                if self.flows > 0 {
                    rates[flows + cell] = hose.flow_rate(outflow, pressure, next);
                }
                inflow = outflow;
            }
        }
        if let Some(of_supply) = self.supply() {
            self.supply_rates(member, of_supply, state, (supply.net(), line), rates);
        }
        if let Some(port) = &self.regulated {
            rates[port.place] = port.rate(state, &line.port);
        }
        into_actuator.and(self.leak(member, own))
    }

    fn supply_rates<T: Over<R>, const N: usize>(
        &self,
        member: &Member<'_, R>,
        of_supply: &SupplyLine<R>,
        state: &[T; N],
        (supply, line): (T, &LineMode),
        rates: &mut [T; N],
    ) {
        let drawn = supply * T::of(of_supply.actuators());
        if let (Some(place), Some(reservoir)) = (self.reservoir, of_supply.reservoir()) {
            let delivered = if line.compressor_runs { reservoir.delivery(state[place]) } else { T::zero() };
            rates[place] = reservoir.pressure_rate(delivered - drawn);
        }
        if let (Some(place), Some(regulator)) = (self.regulator, of_supply.regulator())
            && let Some(valve) = member.actuator.valve()
        {
            let set = T::of(valve.port_pressure(Port::Supply));
            let error = regulator.error(state[place], set, self.reservoir.map(|place| state[place]), drawn);
            rates[place] = regulator.pressure_rate(error, line.poppet);
        }
    }

    /// The regulator's error in Pa.
    fn regulator_error<T: Over<R>, const N: usize>(
        &self,
        member: &Member<'_, R>,
        state: &[T; N],
        through: Through<'_, T>,
    ) -> Option<T> {
        let (place, supply, valve) = (self.regulator?, self.supply()?, member.actuator.valve()?);
        // The flow does not ask how fast the actuator's volume changes.
        let [length, _, pressure, mass] = [state[0], state[1], state[2], state[3]];
        let slack = through.mode.extent == super::mode::Extent::Slack;
        let own = member.actuator.chamber(length, T::zero(), pressure, mass, slack);
        let drawn = self.passages(member, &own, state, through)[0].net() * T::of(supply.actuators());
        let set = T::of(valve.port_pressure(Port::Supply));
        Some(supply.regulator()?.error(state[place], set, self.reservoir.map(|place| state[place]), drawn))
    }

    /// The fastest rate in 1/s at which pressures of the line and the actuator's settle, by the slopes of their rates, of
    /// which `seeded` gives all by one pressure.
    pub(super) fn settling_rate<const N: usize>(
        &self,
        state: &[R; N],
        line: &LineMode,
        seeded: impl Fn(usize) -> [Dual<R, 1>; N],
    ) -> f64 {
        let settles = |place: usize| -seeded(place)[place].slope[0].value();
        let regulated = self.regulated.map(|port| port.place);
        let supply = [self.reservoir, self.regulator, regulated].into_iter().flatten();
        let fastest = supply.fold(0.0, |fastest: f64, place| fastest.max(settles(place)));
        if self.flows > 0 || self.volumes == 0 {
            return fastest;
        }
        // Two volumes that settle against each other do so with the sum of their rates.
        let (own, at_valve) = (super::hybrid::PRESSURE, FIRST);
        let rates = seeded(at_valve);
        let together = settles(own).max(0.0) - rates[at_valve].slope[0].value();
        // The slope grows as a turbulent flow dies down: the time until the pressures would meet counts, or since they did.
        let [near, far] = [at_valve, own].map(|place| state[place].value());
        let gap = near * near - far * far;
        let closing = 2.0 * (near * rates[at_valve].value.value() - far * rates[own].value.value());
        let meeting = if line.regime == FlowRegime::Laminar { 0.0 } else { (MEETING * closing / gap).abs() };
        fastest.max(together).max(meeting)
    }

    /// Scales of the line's states.
    pub(super) fn scales<const N: usize>(&self, member: &Member<'_, R>, state: &[R; N], scales: &mut [f64; N]) {
        for place in FIRST..self.states {
            scales[place] = state[place].value().abs() + 0.1 * member.atmosphere;
        }
        if let Some(hose) = &self.line.hose {
            let flow = 0.685 * member.atmosphere * hose.tube().area().value() / hose.wave_speed().value();
            for place in FIRST + self.volumes..FIRST + self.volumes + self.flows {
                scales[place] = state[place].value().abs() + SLOW * flow;
            }
        }
    }

    /// The guards of the line.
    pub(super) fn guards(&self, line: &LineMode, guards: &mut Guards<Guard>) {
        if self.volumes > 0 && self.flows == 0 {
            for (guard, bound) in [Guard::RegimeDown, Guard::RegimeUp].into_iter().zip(line.regime.bounds()) {
                if bound.is_some() {
                    guards.add(guard, GuardForm::Function);
                }
            }
        }
        let switch = self.supply().and_then(|supply| supply.reservoir()?.switch_pressures());
        if let (Some(index), Some([starts, stops])) = (self.reservoir, switch) {
            if line.compressor_runs {
                guards.add(Guard::CutOut, GuardForm::Below { index, bound: stops.value() });
            } else {
                guards.add(Guard::CutIn, GuardForm::Above { index, bound: starts.value() });
            }
        }
        let rests = self.supply().and_then(|supply| supply.regulator()).is_some_and(|it| it.dead_band().value() > 0.0);
        if rests {
            if line.poppet != Poppet::Raises {
                guards.add(Guard::RegulatorUp, GuardForm::Function);
            }
            if line.poppet != Poppet::Lowers {
                guards.add(Guard::RegulatorDown, GuardForm::Function);
            }
        }
        if let Some(form) = self.regulated.and_then(|port| port.guard_form(&line.port)) {
            guards.add(Guard::RateLimit, form);
        }
    }

    /// Value of a guard of the line, or of a zone of the flow through the valve.
    pub(super) fn guard<T: Over<R>, const N: usize>(
        &self,
        guard: Guard,
        member: &Member<'_, R>,
        state: &[T; N],
        (through, line): (Through<'_, T>, &LineMode),
    ) -> Option<T> {
        let switch = || self.supply()?.reservoir()?.switch_pressures();
        let regulate = |bound: f64, sign: f64| {
            let regulator = self.supply()?.regulator()?;
            let band = T::constant(member.band * member.atmosphere);
            let error = self.regulator_error(member, state, through)?;
            Some((T::of(regulator.dead_band()) * T::constant(bound) - error) * T::constant(sign) + band)
        };
        match guard {
            Guard::RegimeDown | Guard::RegimeUp => {
                let sign = if guard == Guard::RegimeUp { 1.0 } else { -1.0 };
                let bound = line.regime.bounds()[usize::from(guard == Guard::RegimeUp)]?;
                let passed = bound + sign * member.band.max(LEAST_BAND) * bound.abs();
                Some((T::constant(passed) - self.drive(state)?) * T::constant(sign))
            }
            Guard::CutOut => Some(T::of(switch()?[1]) - state[self.reservoir?]),
            Guard::CutIn => Some(state[self.reservoir?] - T::of(switch()?[0])),
            // From feeding to rest at the upper end of the dead band, from rest to relieving at the lower, and back.
            Guard::RegulatorUp => regulate(if line.poppet == Poppet::Rests { 1.0 } else { -1.0 }, 1.0),
            Guard::RegulatorDown => regulate(if line.poppet == Poppet::Rests { -1.0 } else { 1.0 }, -1.0),
            Guard::RateLimit => self.regulated?.guard(state, &line.port),
            Guard::SupplyDown | Guard::SupplyUp => {
                let feed = self.feed(member.actuator.valve()?, state);
                member.supply_guard(guard, through.mode, [state[self.places().valve], feed])
            }
            _ => None,
        }
    }

    /// Crosses a guard of the line; `None` for one that is not.
    pub(super) fn cross(guard: Guard, line: &mut LineMode) -> Option<EventKind> {
        match guard {
            Guard::RegimeDown | Guard::RegimeUp => {
                let place = FlowRegime::RISING.iter().position(|regime| *regime == line.regime)?;
                let next = if guard == Guard::RegimeUp { place + 1 } else { place.checked_sub(1)? };
                line.regime = *FlowRegime::RISING.get(next)?;
                Some(EventKind::Regime)
            }
            Guard::CutOut | Guard::CutIn => {
                line.compressor_runs = guard == Guard::CutIn;
                Some(EventKind::Compressor)
            }
            Guard::RegulatorUp | Guard::RegulatorDown => {
                let towards = if guard == Guard::RegulatorUp { Poppet::Raises } else { Poppet::Lowers };
                line.poppet = if line.poppet == Poppet::Rests { towards } else { Poppet::Rests };
                Some(EventKind::Regulator)
            }
            Guard::RateLimit => {
                line.port.settle();
                Some(EventKind::Regulator)
            }
            _ => None,
        }
    }
}
