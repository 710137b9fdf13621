//! The pieces of the flow law, of a tabulated effectiveness and of a force map as components of the mode: which one holds,
//! and when the state leaves it.

use super::hybrid::{LENGTH, PRESSURE, Phase, RigSystem};
use super::mode::{Guard, Mode};
use super::system::{GuardForm, Guards, HybridSystem};
use crate::air::{Chamber, Flow};
use crate::dual::Dual;
use crate::force::Piece;
use crate::scalar::{Over, Real};
use crate::valve::{FlowZone, Port};

/// Rate of settling for which two pressures that would meet in a second count.
const MEETING: f64 = 4.0;

impl<R: Real> RigSystem<'_, R> {
    /// Flow through the passages that are open in a mode.
    #[inline(always)]
    pub fn flow<T: Over<R>>(&self, chamber: &Chamber<T>, mode: &Mode) -> Flow<T> {
        let Some(valve) = self.rig().actuator().valve() else { return Flow::none() };
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

    pub(super) fn enter_ports(&self, state: &[R; 4], mode: &mut Mode) {
        let zone = |port| {
            let valve = self.rig().actuator().valve()?;
            let beyond = valve.port_pressure(port);
            let below_end = |zone: &FlowZone| match valve.law.bounds(*zone, beyond).1 {
                Some(end) => state[PRESSURE].value() <= end.value(),
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
        let valve = self.rig().actuator().valve()?;
        let (low, high) = valve.law.bounds(zone, valve.port_pressure(port));
        // A subsonic piece ends before the pressures are equal, where its root would.
        let band = self.band().min(0.1 * (1.0 - valve.law.laminar_ratio().value()));
        let widened = |bound: R, factor: f64| bound * R::constant(factor);
        if up { high.map(|bound| widened(bound, 1.0 + band)) } else { low.map(|bound| widened(bound, 1.0 - band)) }
    }

    pub(super) fn zone_guards(&self, mode: &Mode, guards: &mut Guards<Guard>) {
        let sides = [
            (Port::Supply, mode.supply_zone, Guard::SupplyDown, Guard::SupplyUp),
            (Port::Exhaust, mode.exhaust_zone, Guard::ExhaustDown, Guard::ExhaustUp),
        ];
        for (port, zone, down, up) in sides {
            let Some(zone) = zone else { continue };
            if let Some(bound) = self.zone_bound(port, zone, false) {
                guards.add(down, GuardForm::Above { index: PRESSURE, bound: bound.value() });
            }
            if let Some(bound) = self.zone_bound(port, zone, true) {
                guards.add(up, GuardForm::Below { index: PRESSURE, bound: bound.value() });
            }
        }
    }

    /// Rate in 1/s at which the pressure settles to that of an open port; zero while the flow does not depend on it.
    pub(super) fn pressure_settling_rate(&self, time: R, state: &[R; 4], phase: &Phase<R>) -> f64 {
        let choked = |zone| matches!(zone, FlowZone::ChokedIn | FlowZone::ChokedOut);
        let Some(valve) = self.rig().actuator().valve() else { return 0.0 };
        let zones = [(Port::Supply, phase.mode.supply_zone), (Port::Exhaust, phase.mode.exhaust_zone)];
        let follows = |(port, zone): (Port, Option<FlowZone>)| Some((port, zone.filter(|&zone| !choked(zone))?));
        let Some((port, zone)) = zones.into_iter().find_map(follows) else { return 0.0 };
        let mut seeded = state.map(Dual::<R, 1>::of);
        seeded[PRESSURE] = Dual::variable(state[PRESSURE], 0);
        let rate = self.rates(Dual::of(time), &seeded, phase)[PRESSURE];
        let settling = (-rate.slope[0].value()).max(0.0);
        if matches!(zone, FlowZone::LaminarIn | FlowZone::LaminarOut) {
            return settling;
        }
        // Below the speed of sound the slope grows without bound as the pressures meet: the time until they would counts.
        let gap = (valve.port_pressure(port) - state[PRESSURE]).value();
        settling.max(MEETING * rate.value() / gap)
    }

    /// The piece of the effectiveness at an absolute pressure.
    pub(super) fn effectiveness_piece(&self, pressure: R) -> usize {
        let actuator = self.rig().actuator();
        let gauge = actuator.gauge(pressure).0.value();
        piece_of(gauge, |piece| actuator.law().effectiveness.piece_bounds(piece).1)
    }

    /// The piece of a force map at a length and an absolute pressure.
    pub(super) fn force_piece(&self, length: R, pressure: R) -> Piece {
        let (law, gauge) = (&self.rig().actuator().law().law, self.rig().actuator().gauge(pressure));
        Piece {
            length: piece_of(length.value(), |piece| law.length_bounds(piece).1),
            pressure: piece_of(gauge.0.value(), |piece| law.pressure_bounds(piece).1),
        }
    }

    /// The length in m at which a piece of a force map ends on one side, passed by the band.
    pub(super) fn map_length_bound(&self, mode: &Mode, up: bool) -> Option<R> {
        let (low, high) = self.rig().actuator().law().law.length_bounds(mode.force_piece.length);
        self.passed(low, high, up)
    }

    /// The absolute pressure in Pa at which a piece of a force map ends on one side, passed by the band.
    pub(super) fn map_pressure_bound(&self, mode: &Mode, up: bool) -> Option<R> {
        let actuator = self.rig().actuator();
        let absolute = |gauge: R| gauge + actuator.air().atmosphere().0;
        let (low, high) = actuator.law().law.pressure_bounds(mode.force_piece.pressure);
        self.passed(low.map(absolute), high.map(absolute), up)
    }

    /// One of two bounds, passed by the band.
    fn passed(&self, low: Option<R>, high: Option<R>, up: bool) -> Option<R> {
        let factor = if up { 1.0 + self.band() } else { 1.0 - self.band() };
        let bound = if up { high } else { low };
        bound.map(|bound| bound * R::constant(factor))
    }

    /// The absolute pressure in Pa at which a piece of the effectiveness ends on one side, passed by the band.
    pub(super) fn piece_bound(&self, mode: &Mode, up: bool) -> Option<R> {
        let actuator = self.rig().actuator();
        let (low, high) = actuator.law().effectiveness.piece_bounds(mode.effectiveness_piece);
        let absolute = |gauge: R| gauge + actuator.air().atmosphere().0;
        self.passed(low.map(absolute), high.map(absolute), up)
    }

    pub(super) fn piece_guards(&self, mode: &Mode, guards: &mut Guards<Guard>) {
        for (guard, index, bound, above) in [
            (Guard::MapShorter, LENGTH, self.map_length_bound(mode, false), true),
            (Guard::MapLonger, LENGTH, self.map_length_bound(mode, true), false),
            (Guard::MapDown, PRESSURE, self.map_pressure_bound(mode, false), true),
            (Guard::MapUp, PRESSURE, self.map_pressure_bound(mode, true), false),
        ] {
            let Some(bound) = bound.map(Real::value) else { continue };
            let form = if above { GuardForm::Above { index, bound } } else { GuardForm::Below { index, bound } };
            guards.add(guard, form);
        }
        if let Some(bound) = self.piece_bound(mode, false) {
            guards.add(Guard::PieceDown, GuardForm::Above { index: PRESSURE, bound: bound.value() });
        }
        if let Some(bound) = self.piece_bound(mode, true) {
            guards.add(Guard::PieceUp, GuardForm::Below { index: PRESSURE, bound: bound.value() });
        }
    }
}

/// The first piece that a number lies in, by the upper ends of the pieces.
fn piece_of<R: Real>(number: f64, end: impl Fn(usize) -> Option<R>) -> usize {
    (0..).find(|&piece| end(piece).is_none_or(|end| number <= end.value())).unwrap_or(0)
}
