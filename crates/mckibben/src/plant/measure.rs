//! What drivers measure of a plant, and what they set.
//!
//! Tensions of sticking actuators are those by which [`shares`](super::shares) lets them hold together.

use super::evaluation::{Evaluation, System};
use super::mode::PlantMode;
use crate::command::PlantMeasurement;
use crate::control::Measurement;
use crate::error::Error;
use crate::pressure::{AbsolutePressure, GaugePressure};
use crate::scalar::Real;
use crate::valve::is_due;
use alloc::vec::Vec;

impl<R: Real> System<R> {
    /// What there is to measure at a time in s.
    pub(crate) fn measure(
        &self,
        time: R,
        state: &[R],
        mode: &PlantMode<R>,
        at: &mut Evaluation<R>,
    ) -> PlantMeasurement<R> {
        let plant = &*self.plant;
        self.evaluate(time, state, mode, at);
        for m in 0..plant.mechanisms.len() {
            self.share_tensions(m, state, mode, at);
        }
        let actuators = plant.actuators.iter().enumerate().map(|(i, mounted)| {
            let (unit, here) = (&at.units[i], &plant.places.actuators[i]);
            // What is slack keeps its shortest length; what is measured is the distance, without the tendon.
            let (length, velocity) =
                if here.length.is_some() { (unit.length, unit.velocity) } else { (unit.distance, unit.velocity) };
            let atmosphere = mounted.actuator.air().atmosphere();
            Measurement {
                time,
                length,
                velocity,
                pressure: AbsolutePressure(state[here.pressure]).gauge(atmosphere),
                air_mass: state[here.mass()],
                tension: unit.tension,
            }
        });
        let of_each = |rates: bool| -> Vec<Vec<R>> {
            let coordinates = plant.places.mechanisms.iter().map(|here| {
                let (positions, velocities) = here.of(state);
                if rates { velocities.to_vec() } else { positions.to_vec() }
            });
            coordinates.collect()
        };
        let nodes = at.network.nodes.iter().map(|node| GaugePressure(node.pressure - plant.network.atmosphere));
        PlantMeasurement {
            time,
            actuators: actuators.collect(),
            positions: of_each(false),
            rates: of_each(true),
            nodes: nodes.collect(),
        }
    }

    /// Enters the modes of a mechanism whose ends or pressures have jumped, perhaps over pieces of a law, from which forces
    /// follow.
    pub(crate) fn enter_jumped_ends(
        &self,
        m: usize,
        time: R,
        state: &mut [R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
    ) {
        self.enter_actuator_pieces(time, state, mode, at);
        self.enter_given_rates(m, time, state, mode, at);
    }

    /// Enters the modes of a mechanism whose given motion has changed its rates alone.
    pub(crate) fn enter_given_rates(
        &self,
        m: usize,
        time: R,
        state: &mut [R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
    ) {
        self.enter_length_regimes(m, time, state, mode, at);
        self.settle(m, time, state, mode, at);
        self.follow_all(time, state, mode, at, None);
        self.settle_ends(time, state, mode, at);
    }

    /// Takes the sample of the first driver for which one is due at a time in s, and sets its valves; which driver that was.
    pub(crate) fn sample_due(
        &self,
        time: R,
        state: &[R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
    ) -> Result<Option<usize>, Error> {
        let Some(index) = mode.drivers.iter().position(|driver| is_due(driver.next(), time)) else {
            return Ok(None);
        };
        let truth = self.measure(mode.drivers[index].next(), state, mode, at);
        let PlantMode { drivers, network, .. } = mode;
        let driver = &mut drivers[index];
        let commands = driver.take(truth);
        let until = driver.next();
        for (place, &valve) in driver.valves().iter().enumerate() {
            if let Some(commanded) = commands.as_ref().and_then(|commands| commands[place]) {
                self.plant.network.set_valve(valve, time, commanded, network)?;
            }
            self.plant.network.pulse_valve(valve, [time, until], network)?;
        }
        Ok(Some(index))
    }
}
