//! The pieces of the flow law, of a tabulated effectiveness and of a force map as components of the mode: which one holds,
//! and when the state leaves it.

use super::member::Member;
use super::mode::{Guard, Mode};
use super::system::GuardForm;
use crate::air::{Chamber, Flow};
use crate::dual::Dual;
use crate::force::Piece;
use crate::scalar::{Over, Real};
use crate::valve::{Beyond, FlowZone, Port};

/// Rate of settling for which two pressures that would meet in a second count.
pub(crate) const MEETING: f64 = 4.0;
/// The guards of the air and of the pieces, in the order in which they are crossed.
const GUARDS: [Guard; 12] = [
    Guard::SupplyDown,
    Guard::SupplyUp,
    Guard::ExhaustDown,
    Guard::ExhaustUp,
    Guard::PieceDown,
    Guard::PieceUp,
    Guard::MapDown,
    Guard::MapUp,
    Guard::MapShorter,
    Guard::MapLonger,
    Guard::PressDown,
    Guard::PressUp,
];

/// What the valve lets through: the mode, and how far its passages are open where they are not whole.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Through<'a, T> {
    pub(crate) mode: &'a Mode,
    pub(crate) shares: Option<[T; 2]>,
    /// Absolute pressure in Pa beyond the port to the supply, where a regulator makes it.
    pub(crate) feed: Option<T>,
}

/// Places among the states of the pressures that an actuator's air depends on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Places {
    /// Of the actuator's own.
    pub(crate) own: usize,
    /// Of what its valve opens into.
    pub(crate) valve: usize,
    /// Of what feeds its valve, unless that is constant.
    pub(crate) supply: Option<usize>,
}

impl Places {
    /// The valve opens into the actuator and is fed by a constant pressure.
    pub(crate) fn direct(own: usize) -> Self {
        Self { own, valve: own, supply: None }
    }
}

impl<R: Real> Member<'_, R> {
    /// Flow through the passages that are open in a mode, each to its share where they are not whole.
    #[inline(always)]
    pub(crate) fn flow<T: Over<R>>(&self, chamber: &Chamber<T>, through: Through<'_, T>) -> Flow<T> {
        let Some(valve) = self.actuator.valve() else { return Flow::none() };
        let Through { mode, shares, feed } = through;
        if let (Some(feed), Some(zone)) = (feed, mode.supply_zone) {
            return valve.flow_in_zone_from(Port::Supply, &Beyond::at(feed, T::one()), zone, chamber);
        }
        if let Some([supply, exhaust]) = shares {
            let through = |port, zone: Option<FlowZone>, share| {
                zone.map_or(Flow::none(), |zone| valve.flow_in_zone(port, zone, chamber).through(share))
            };
            let inlet = through(Port::Supply, mode.supply_zone, supply);
            return inlet.and(through(Port::Exhaust, mode.exhaust_zone, exhaust));
        }
        match (mode.supply_zone, mode.exhaust_zone) {
            (Some(zone), None) => valve.flow_in_zone(Port::Supply, zone, chamber),
            (None, Some(zone)) => valve.flow_in_zone(Port::Exhaust, zone, chamber),
            (Some(supply), Some(exhaust)) => valve.flow_in_zone(Port::Supply, supply, chamber).and(valve.flow_in_zone(
                Port::Exhaust,
                exhaust,
                chamber,
            )),
            (None, None) => Flow::none(),
        }
    }

    /// Enters the zones of the open passages at a pressure, with the pressure of the supply if that is not constant.
    pub(crate) fn enter_ports(&self, pressure: R, supply: Option<R>, mode: &mut Mode) {
        let zone = |port| {
            let valve = self.actuator.valve()?;
            let beyond = supply.filter(|_| port == Port::Supply).unwrap_or(valve.port_pressure(port));
            let below_end = |zone: &FlowZone| match valve.law_of(port).bounds(*zone, beyond).1 {
                Some(end) => pressure.value() <= end.value(),
                None => true,
            };
            FlowZone::RISING.into_iter().find(below_end)
        };
        mode.supply_zone = mode.ports.supply.then(|| zone(Port::Supply)).flatten();
        mode.exhaust_zone = mode.ports.exhaust.then(|| zone(Port::Exhaust)).flatten();
    }

    pub(crate) fn move_zone(zone: &mut Option<FlowZone>, up: bool) {
        let place = zone.and_then(|zone| FlowZone::RISING.iter().position(|other| *other == zone));
        let next = place.and_then(|place| if up { place.checked_add(1) } else { place.checked_sub(1) });
        if let Some(next) = next.and_then(|next| FlowZone::RISING.get(next)) {
            *zone = Some(*next);
        }
    }

    /// The bound of a zone in Pa on one side, passed by the band.
    fn zone_bound(&self, port: Port, zone: FlowZone, up: bool) -> Option<R> {
        self.zone_bound_from(port, self.actuator.valve()?.port_pressure(port), zone, up)
    }

    /// The same over the pressure beyond the supply's port.
    fn zone_ratio(&self, zone: FlowZone, up: bool) -> Option<R> {
        self.zone_bound_from(Port::Supply, R::one(), zone, up)
    }

    /// Value of a guard of the supply's flow law at a pressure, with the one that feeds the valve.
    pub(crate) fn supply_guard<T: Over<R>>(&self, guard: Guard, mode: &Mode, [pressure, feed]: [T; 2]) -> Option<T> {
        let up = guard == Guard::SupplyUp;
        let bound = T::of(self.zone_ratio(mode.supply_zone?, up)?) * feed;
        Some(if up { bound - pressure } else { pressure - bound })
    }

    fn zone_bound_from(&self, port: Port, beyond: R, zone: FlowZone, up: bool) -> Option<R> {
        let valve = self.actuator.valve()?;
        let law = valve.law_of(port);
        let (low, high) = law.bounds(zone, beyond);
        // A subsonic piece ends before the pressures are equal, where its root would.
        let band = self.band.min(0.1 * (1.0 - law.laminar_ratio().value()));
        let widened = |bound: R, factor: f64| bound * R::constant(factor);
        if up { high.map(|bound| widened(bound, 1.0 + band)) } else { low.map(|bound| widened(bound, 1.0 - band)) }
    }

    /// Rate in 1/s at which the pressure settles to that of an open port; zero while the flow does not depend on it. `rate`
    /// is `dP/dt` at a pressure.
    pub(crate) fn pressure_settling_rate(
        &self,
        pressure: R,
        supply: Option<R>,
        mode: &Mode,
        rate: impl FnOnce(Dual<R, 1>) -> Dual<R, 1>,
    ) -> f64 {
        let choked = |zone| matches!(zone, FlowZone::ChokedIn | FlowZone::ChokedOut);
        let Some(valve) = self.actuator.valve() else { return 0.0 };
        let zones = [(Port::Supply, mode.supply_zone), (Port::Exhaust, mode.exhaust_zone)];
        let follows = |(port, zone): (Port, Option<FlowZone>)| Some((port, zone.filter(|&zone| !choked(zone))?));
        let Some((port, zone)) = zones.into_iter().find_map(follows) else { return 0.0 };
        let rate = rate(Dual::variable(pressure, 0));
        let settling = (-rate.slope[0].value()).max(0.0);
        if matches!(zone, FlowZone::LaminarIn | FlowZone::LaminarOut) {
            return settling;
        }
        // Below the speed of sound the slope grows without bound as the pressures meet: the time until they would counts.
        let beyond = supply.filter(|_| port == Port::Supply).unwrap_or(valve.port_pressure(port));
        let gap = (beyond - pressure).value();
        settling.max(MEETING * rate.value.value() / gap)
    }

    /// The piece of the effectiveness at an absolute pressure.
    pub(crate) fn effectiveness_piece(&self, pressure: R) -> usize {
        let actuator = self.actuator;
        let gauge = actuator.gauge(pressure).0.value();
        piece_of(gauge, |piece| actuator.law().effectiveness.piece_bounds(piece).1)
    }

    /// The piece of a force map at a length and an absolute pressure.
    pub(crate) fn force_piece(&self, length: R, pressure: R) -> Piece {
        let (law, gauge) = (&self.actuator.law().law, self.actuator.gauge(pressure));
        Piece {
            length: piece_of(length.value(), |piece| law.length_bounds(piece).1),
            pressure: piece_of(gauge.0.value(), |piece| law.pressure_bounds(piece).1),
        }
    }

    /// The absolute pressure in Pa that ends a mode by a guard, passed by the band, and whether the mode lasts above it;
    /// `None` where there is no such end.
    pub(crate) fn pressure_limit(&self, guard: Guard, mode: &Mode) -> Option<(R, bool)> {
        let law = self.actuator.law();
        let zone = |port, zone: Option<FlowZone>, up| zone.and_then(|zone| self.zone_bound(port, zone, up));
        let piece = |up| self.passed(self.absolute(law.effectiveness.piece_bounds(mode.effectiveness_piece)), up);
        let of_map = |up| self.passed(self.absolute(law.law.pressure_bounds(mode.force_piece.pressure)), up);
        let press = |up| {
            let atmosphere = Some(self.actuator.air().atmosphere().0);
            let ends = self.actuator.friction().has_direction() && mode.pressed != up;
            ends.then(|| self.passed((atmosphere, atmosphere), up)).flatten()
        };
        let (bound, lasts_above) = match guard {
            Guard::SupplyDown => (zone(Port::Supply, mode.supply_zone, false), true),
            Guard::SupplyUp => (zone(Port::Supply, mode.supply_zone, true), false),
            Guard::ExhaustDown => (zone(Port::Exhaust, mode.exhaust_zone, false), true),
            Guard::ExhaustUp => (zone(Port::Exhaust, mode.exhaust_zone, true), false),
            Guard::PieceDown => (piece(false), true),
            Guard::PieceUp => (piece(true), false),
            Guard::MapDown => (of_map(false), true),
            Guard::MapUp => (of_map(true), false),
            Guard::PressDown => (press(false), true),
            Guard::PressUp => (press(true), false),
            _ => return None,
        };
        bound.map(|bound| (bound, lasts_above))
    }

    /// The length in m that ends a piece of a force map by a guard, passed by the band, and whether the piece lasts above it;
    /// `None` where there is no such end.
    pub(crate) fn map_length_limit(&self, guard: Guard, mode: &Mode) -> Option<(R, bool)> {
        let up = match guard {
            Guard::MapShorter => false,
            Guard::MapLonger => true,
            _ => return None,
        };
        let bounds = self.actuator.law().law.length_bounds(mode.force_piece.length);
        self.passed(bounds, up).map(|bound| (bound, !up))
    }

    /// One of two bounds, passed by the band.
    fn passed(&self, (low, high): (Option<R>, Option<R>), up: bool) -> Option<R> {
        let factor = if up { 1.0 + self.band } else { 1.0 - self.band };
        let bound = if up { high } else { low };
        bound.map(|bound| bound * R::constant(factor))
    }

    /// Absolute pressures in Pa from gauge pressures.
    fn absolute(&self, (low, high): (Option<R>, Option<R>)) -> (Option<R>, Option<R>) {
        let absolute = |gauge: R| gauge + self.actuator.air().atmosphere().0;
        (low.map(absolute), high.map(absolute))
    }

    /// Whether the gas presses the threads together at an absolute pressure, as far as that matters.
    pub(crate) fn pressed(&self, pressure: R) -> bool {
        !self.actuator.friction().has_direction() || pressure.value() >= self.actuator.air().atmosphere().0.value()
    }

    /// The guards of the air and of the pieces.
    pub(crate) fn piece_guards(&self, mode: &Mode, places: Places, add: &mut impl FnMut(Guard, GuardForm)) {
        for guard in GUARDS {
            let of_supply = matches!(guard, Guard::SupplyDown | Guard::SupplyUp);
            if let Some((bound, lasts_above)) = self.pressure_limit(guard, mode) {
                let of_valve = of_supply || matches!(guard, Guard::ExhaustDown | Guard::ExhaustUp);
                let (index, bound) = (if of_valve { places.valve } else { places.own }, bound.value());
                let form = match lasts_above {
                    _ if of_supply && places.supply.is_some() => GuardForm::Function,
                    true => GuardForm::Above { index, bound },
                    false => GuardForm::Below { index, bound },
                };
                add(guard, form);
            } else if self.map_length_limit(guard, mode).is_some() {
                // Not everyone's length is a state.
                add(guard, GuardForm::Function);
            }
        }
    }
}

/// The first piece that a number lies in, by the upper ends of the pieces.
fn piece_of<R: Real>(number: f64, end: impl Fn(usize) -> Option<R>) -> usize {
    (0..).find(|&piece| end(piece).is_none_or(|end| number <= end.value())).unwrap_or(0)
}
