//! Runs that do not go on: what the error says of where they are and what helps.
//!
//! A run halts where many steps do not bring the time on, where events follow each other at one instant without end, or where
//! no step is short enough for the tolerance. Each has its reason in a part of the plant, which the last event or the state
//! that changes fastest names. A looser tolerance mends none of them.

use super::crossing::PlantEventKind;
use super::evaluation::{Evaluation, System};
use crate::engine::Halt;
use crate::error::Error;
use crate::scalar::Real;
use crate::simulation::EventKind;

/// What goes on without end, and what ends it.
type Case = (&'static str, &'static str);

impl<R: Real> System<R> {
    /// The error of a run that does not go on.
    pub(crate) fn halts(&self, time: R, state: &[R], why: Halt, event: Option<PlantEventKind>) -> Error {
        let stopped = |(reason, remedy): Case, quantity, value, unit| Error::Stopped {
            time: time.value(),
            reason,
            quantity,
            value,
            unit,
            remedy,
        };
        match why {
            Halt::Crawls(advance) => {
                let case = event.and_then(|event| of_events(event.kind)).unwrap_or((
                    "100000 steps advance the time by less than 0.1 ms",
                    "give masses, volumes, flow areas and stiffnesses of usual size: some part is far faster than the rest",
                ));
                stopped(case, "advance in the last 100000 steps", advance, "s")
            }
            Halt::Events => {
                let case = event.and_then(|event| of_events(event.kind)).unwrap_or((
                    "events follow each other at one instant without end",
                    "give controllers and commands instants that are apart",
                ));
                stopped(case, "time", time.value(), "s")
            }
            Halt::Step(place) => {
                if let Some(length) = self.almost_straight(time, state) {
                    return Self::straight(time, length);
                }
                let (case, quantity, unit) = self.of_state(place);
                stopped(case, quantity, state.get(place).map_or(f64::NAN, |value| value.value()), unit)
            }
        }
    }

    /// The length in m of an actuator that has all but the length of its thread: what little volume it has left may press so
    /// hard that no step gets there.
    fn almost_straight(&self, time: R, state: &[R]) -> Option<R> {
        /// Part of the length of the thread.
        const NEAR: f64 = 1e-9;
        let mode = self.first_mode(state);
        let mut at = Evaluation::new(&self.plant);
        self.enter_distances(time, state, &mode, &mut at);
        let lengths = at.units.iter().map(|unit| unit.length);
        lengths.zip(&self.wires).find_map(|(length, wire)| {
            let end = wire.member.thread_length().value();
            ((end - length.value()).abs() < NEAR * end).then_some(length)
        })
    }

    /// The error of a fixed step that was so long that a state left the physics.
    pub(super) fn step_too_long(&self, time: R, state: &[R], place: usize) -> Error {
        let (_, quantity, unit) = self.of_state(place);
        Error::Stopped {
            time: time.value(),
            reason: "a step of the fixed-step engine left the physics",
            quantity,
            value: state[place].value(),
            unit,
            remedy: "shorten run.step, set run.engine = \"event-located\", or run.method = \"stable\" where it is \"rk4\"",
        }
    }

    /// The error of a braid whose thread a load has pulled straight, at a length in m.
    pub(super) fn straight(time: R, length: R) -> Error {
        Error::Stopped {
            time: time.value(),
            reason: "the load pulled a braid straight",
            quantity: "length",
            value: length.value(),
            unit: "m",
            remedy: "lighten the load, move the ends less, stiffen actuator.limit.stiffness or give a joint stops; shorten long \
                     fixed steps",
        }
    }

    /// The error of a reservoir that a regulator's outlet (`node`) draws empty: the outlet keeps its pressure for the lag
    /// after its inlet has lost its own, and what it gives is drawn from the inlet all the same.
    pub(super) fn empty(&self, node: usize, time: R, state: &[R]) -> Error {
        let pressure = self.plant.places.nodes[node].map_or(f64::NAN, |place| state[place].value());
        Error::Stopped {
            time: time.value(),
            reason: "a regulator draws its reservoir empty: its outlet still has a pressure that its reservoir has no more",
            quantity: "absolute pressure of the outlet",
            value: pressure,
            unit: "Pa",
            remedy: "raise supply.reservoir_volume or lower supply.lag: a reservoir that empties in four lags or more, through \
                     all that it feeds, never gets there",
        }
    }

    /// The error of a guard that no mode has.
    pub(super) fn unknown_guard(&self, time: R) -> Error {
        Error::Stopped {
            time: time.value(),
            reason: "a mode of an actuator ended that it was not in",
            quantity: "time",
            value: time.value(),
            unit: "s",
            remedy: "report the plant: no input should lead there",
        }
    }

    /// What is too fast in the part that a state belongs to, that state, and its unit.
    fn of_state(&self, place: usize) -> (Case, &'static str, &'static str) {
        let places = &self.plant.places;
        let is = |at: &Option<usize>| *at == Some(place);
        for here in &places.actuators {
            if is(&here.length) {
                let remedy = "give actuator.friction.viscous: the velocity of an end without a mass follows from it";
                return (("the end of an actuator on a tendon changes its length at once", remedy), "length", "m");
            }
            if is(&here.bristles) {
                let remedy = "lower the stiffness of the bristles, or their damping_time";
                return (("bristles of an actuator's friction turn at once", remedy), "deflection", "m");
            }
            if here.branches().contains(&place) {
                let remedy = "raise actuator.friction.viscoelastic.relaxation_time";
                return (("a viscoelastic branch of an actuator relaxes at once", remedy), "relaxed length", "m");
            }
            if here.pressure == place || here.mass() == place {
                let remedy = "raise actuator.external_volume or lower the flow area of its valve";
                let quantity = if here.pressure == place { ("absolute pressure", "Pa") } else { ("mass of air", "kg") };
                return (("the air of an actuator changes at once", remedy), quantity.0, quantity.1);
            }
        }
        if places.nodes.iter().any(is) {
            let remedy =
                "raise the volume of the hose or reservoir or the lag of the regulator, or lower the flow areas there";
            return (("the pressure in a node of the air network changes at once", remedy), "absolute pressure", "Pa");
        }
        if places.branches.iter().any(is) {
            let remedy = "give the distributed hose fewer cells or a greater length";
            return (("the flow in a distributed hose changes at once", remedy), "mass flow", "kg/s");
        }
        let remedy = "raise its mass or inertia, or lower the stiffness of what acts on it";
        (("a mechanism changes its motion at once", remedy), "coordinate or rate", "m, rad, m/s or rad/s")
    }
}

/// What follows an event of a kind without end, and what ends it.
fn of_events(kind: EventKind) -> Option<Case> {
    Some(match kind {
        EventKind::Stick | EventKind::BreakAway | EventKind::Reversal => {
            ("an actuator sticks and slides in turn without end", "raise actuator.friction.viscous or the moving mass")
        }
        EventKind::Flow | EventKind::Regime => (
            "a flow changes its regime without end",
            "check that volumes and flow areas fit each other, or lower valve.laminar_ratio",
        ),
        EventKind::Regulator => {
            ("a regulator opens and shuts without end", "give it a droop or a lag, or widen its dead band")
        }
        EventKind::TendonLoose | EventKind::TendonTight => {
            ("a tendon comes tight and loose without end", "give its actuator viscous friction, or a softer tendon")
        }
        EventKind::StopReached | EventKind::StopRebound | EventKind::StopLeft => {
            ("a stop is reached and left without end", "raise the damping of the stop or lower its stiffness")
        }
        _ => return None,
    })
}
