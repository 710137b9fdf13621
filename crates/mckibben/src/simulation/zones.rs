//! The pieces of the flow law, of a tabulated effectiveness and of a force map as components of the mode: which one holds,
//! and when the state leaves it.

use super::member::Member;
use super::mode::{Guard, Mode};
use super::system::GuardForm;
use crate::air::{Chamber, Flow};
use crate::dual::Dual;
use crate::force::Piece;
use crate::scalar::{Over, Real};
use crate::valve::{FlowZone, Port};

/// Rate of settling for which two pressures that would meet in a second count.
pub(super) const MEETING: f64 = 4.0;

impl<R: Real> Member<'_, R> {
    /// Flow through the passages that are open in a mode.
    #[inline(always)]
    pub(super) fn flow<T: Over<R>>(&self, chamber: &Chamber<T>, mode: &Mode) -> Flow<T> {
        let Some(valve) = self.actuator.valve() else { return Flow::none() };
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
    pub(super) fn enter_ports(&self, pressure: R, supply: Option<R>, mode: &mut Mode) {
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

    pub(super) fn move_zone(zone: &mut Option<FlowZone>, up: bool) {
        let place = zone.and_then(|zone| FlowZone::RISING.iter().position(|other| *other == zone));
        let next = place.and_then(|place| if up { place.checked_add(1) } else { place.checked_sub(1) });
        if let Some(next) = next.and_then(|next| FlowZone::RISING.get(next)) {
            *zone = Some(*next);
        }
    }

    /// The bound of a zone in Pa on one side, passed by the band.
    pub(super) fn zone_bound(&self, port: Port, zone: FlowZone, up: bool) -> Option<R> {
        self.zone_bound_from(port, self.actuator.valve()?.port_pressure(port), zone, up)
    }

    /// The same over the pressure beyond the supply's port.
    pub(super) fn zone_ratio(&self, zone: FlowZone, up: bool) -> Option<R> {
        self.zone_bound_from(Port::Supply, R::one(), zone, up)
    }

    fn zone_bound_from(&self, port: Port, beyond: R, zone: FlowZone, up: bool) -> Option<R> {
        let valve = self.actuator.valve()?;
        let (low, high) = valve.law_of(port).bounds(zone, beyond);
        // A subsonic piece ends before the pressures are equal, where its root would.
        let band = self.band.min(0.1 * (1.0 - valve.law.laminar_ratio().value()));
        let widened = |bound: R, factor: f64| bound * R::constant(factor);
        if up { high.map(|bound| widened(bound, 1.0 + band)) } else { low.map(|bound| widened(bound, 1.0 - band)) }
    }

    /// The guards of the zones; `index` is the place of the pressure that the valve opens into, and `constant` says whether
    /// the supply's pressure is.
    pub(super) fn zone_guards(
        &self,
        mode: &Mode,
        (index, constant): (usize, bool),
        add: &mut impl FnMut(Guard, GuardForm),
    ) {
        let sides = [
            (Port::Supply, mode.supply_zone, Guard::SupplyDown, Guard::SupplyUp),
            (Port::Exhaust, mode.exhaust_zone, Guard::ExhaustDown, Guard::ExhaustUp),
        ];
        for (port, zone, down, up) in sides {
            let Some(zone) = zone else { continue };
            if port == Port::Supply && !constant {
                for (guard, up) in [(down, false), (up, true)] {
                    if self.zone_ratio(zone, up).is_some() {
                        add(guard, GuardForm::Function);
                    }
                }
                continue;
            }
            if let Some(bound) = self.zone_bound(port, zone, false) {
                add(down, GuardForm::Above { index, bound: bound.value() });
            }
            if let Some(bound) = self.zone_bound(port, zone, true) {
                add(up, GuardForm::Below { index, bound: bound.value() });
            }
        }
    }

    /// Rate in 1/s at which the pressure settles to that of an open port; zero while the flow does not depend on it. `rate`
    /// is `dP/dt` at a pressure.
    pub(super) fn pressure_settling_rate(
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
    pub(super) fn effectiveness_piece(&self, pressure: R) -> usize {
        let actuator = self.actuator;
        let gauge = actuator.gauge(pressure).0.value();
        piece_of(gauge, |piece| actuator.law().effectiveness.piece_bounds(piece).1)
    }

    /// The piece of a force map at a length and an absolute pressure.
    pub(super) fn force_piece(&self, length: R, pressure: R) -> Piece {
        let (law, gauge) = (&self.actuator.law().law, self.actuator.gauge(pressure));
        Piece {
            length: piece_of(length.value(), |piece| law.length_bounds(piece).1),
            pressure: piece_of(gauge.0.value(), |piece| law.pressure_bounds(piece).1),
        }
    }

    /// The length in m at which a piece of a force map ends on one side, passed by the band.
    pub(super) fn map_length_bound(&self, mode: &Mode, up: bool) -> Option<R> {
        self.passed(self.actuator.law().law.length_bounds(mode.force_piece.length), up)
    }

    /// The absolute pressure in Pa at which a piece of a force map ends on one side, passed by the band.
    pub(super) fn map_pressure_bound(&self, mode: &Mode, up: bool) -> Option<R> {
        self.passed(self.absolute(self.actuator.law().law.pressure_bounds(mode.force_piece.pressure)), up)
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

    /// The absolute pressure in Pa at which a piece of the effectiveness ends on one side, passed by the band.
    pub(super) fn piece_bound(&self, mode: &Mode, up: bool) -> Option<R> {
        self.passed(self.absolute(self.actuator.law().effectiveness.piece_bounds(mode.effectiveness_piece)), up)
    }

    /// Whether the gas presses the threads together at an absolute pressure, as far as that matters.
    pub(super) fn pressed(&self, pressure: R) -> bool {
        !self.actuator.friction().has_direction() || pressure.value() >= self.actuator.air().atmosphere().0.value()
    }

    /// The absolute pressure in Pa at which the threads begin or cease to be pressed, passed by the band.
    pub(super) fn press_bound(&self, pressed: bool) -> R {
        let factor = if pressed { 1.0 - self.band } else { 1.0 + self.band };
        self.actuator.air().atmosphere().0 * R::constant(factor)
    }

    pub(super) fn press_guard(&self, mode: &Mode, pressure: usize, add: &mut impl FnMut(Guard, GuardForm)) {
        if self.actuator.friction().has_direction() {
            let bound = self.press_bound(mode.pressed).value();
            match mode.pressed {
                true => add(Guard::PressDown, GuardForm::Above { index: pressure, bound }),
                false => add(Guard::PressUp, GuardForm::Below { index: pressure, bound }),
            }
        }
    }

    pub(super) fn piece_guards(&self, mode: &Mode, index: usize, add: &mut impl FnMut(Guard, GuardForm)) {
        if let Some(bound) = self.piece_bound(mode, false) {
            add(Guard::PieceDown, GuardForm::Above { index, bound: bound.value() });
        }
        if let Some(bound) = self.piece_bound(mode, true) {
            add(Guard::PieceUp, GuardForm::Below { index, bound: bound.value() });
        }
        if let Some(bound) = self.map_pressure_bound(mode, false) {
            add(Guard::MapDown, GuardForm::Above { index, bound: bound.value() });
        }
        if let Some(bound) = self.map_pressure_bound(mode, true) {
            add(Guard::MapUp, GuardForm::Below { index, bound: bound.value() });
        }
        // Not everyone's length is a state.
        for (guard, up) in [(Guard::MapShorter, false), (Guard::MapLonger, true)] {
            if self.map_length_bound(mode, up).is_some() {
                add(guard, GuardForm::Function);
            }
        }
    }
}

/// The first piece that a number lies in, by the upper ends of the pieces.
fn piece_of<R: Real>(number: f64, end: impl Fn(usize) -> Option<R>) -> usize {
    (0..).find(|&piece| end(piece).is_none_or(|end| number <= end.value())).unwrap_or(0)
}
