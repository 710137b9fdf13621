//! What drivers measure of a plant, and what they set.
//!
//! Tensions of sticking actuators are not known one by one where several hold one coordinate: each has the same share of
//! what it can hold, as [`holding`](super::holding) leaves it open.

use super::dense::{dot, factor, solve};
use super::evaluation::{Evaluation, System};
use super::mode::PlantMode;
use crate::command::PlantMeasurement;
use crate::control::Measurement;
use crate::error::Error;
use crate::pressure::{AbsolutePressure, GaugePressure};
use crate::scalar::Real;
use crate::simulation::{Extent, Sliding};
use crate::valve::is_due;
use alloc::vec;
use alloc::vec::Vec;

impl<R: Real> System<'_, R> {
    /// What there is to measure at a time in s.
    pub(crate) fn measure(
        &self,
        time: R,
        state: &[R],
        mode: &PlantMode<R>,
        at: &mut Evaluation<R>,
    ) -> PlantMeasurement<R> {
        let plant = self.plant;
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

    /// Gives the sticking actuators of a mechanism tensions that hold it.
    fn share_tensions(&self, m: usize, state: &[R], mode: &PlantMode<R>, at: &mut Evaluation<R>) {
        let plant = self.plant;
        let here = plant.places.mechanisms[m];
        let (count, first) = (here.coordinates, self.first_coordinate[m]);
        let is_stuck = |i: &usize| {
            let its = &mode.actuators[*i].mode;
            its.sliding == Sliding::Stuck && its.extent != Extent::Slack && plant.places.actuators[*i].length.is_none()
        };
        let stuck: Vec<usize> = plant.places.members[m].iter().copied().filter(is_stuck).collect();
        if stuck.is_empty() || !plant.mechanisms[m].is_dynamic() {
            return;
        }
        let bounds: Vec<(R, R)> = stuck.iter().map(|&i| self.holdable(i, state, mode, at.units[i].length)).collect();
        for (&i, (least, most)) in stuck.iter().zip(&bounds) {
            at.units[i].tension = R::constant(0.5) * (*least + *most);
        }
        // What the middles do not hold: τ − h − Σ Jᵀ F − M q̈.
        self.enter_force(m, state, mode, at);
        let mut left: Vec<R> = at.force[..count].to_vec();
        if !mode.mechanisms[m].frozen {
            let mut matrix = vec![R::zero(); count * count];
            self.mass_matrix(m, state, &mut matrix);
            for (k, left) in left.iter_mut().enumerate() {
                *left = *left - dot(&matrix[k * count..(k + 1) * count], &at.acceleration[first..first + count]);
            }
        }
        let half = |(least, most): &(R, R)| R::constant(0.5) * (*most - *least);
        if count == 1 {
            // The same share of what each can hold.
            let lever = |i: usize| self.gradient(i, &at.gradient)[0];
            let whole =
                stuck.iter().zip(&bounds).fold(R::zero(), |sum, (&i, its)| sum + lever(i).magnitude() * half(its));
            let share = if whole.value() > 0.0 { left[0] / whole } else { R::zero() };
            let tensions: Vec<R> = stuck
                .iter()
                .zip(&bounds)
                .map(|(&i, its)| {
                    let sign = if lever(i).value() < 0.0 { -share } else { share };
                    at.units[i].tension + sign * half(its)
                })
                .collect();
            for (&i, tension) in stuck.iter().zip(tensions) {
                at.units[i].tension = tension;
            }
            return;
        }
        // The least sum of squared shares: (J H² Jᵀ) y = left over the coordinates that they hold.
        let mut weights = vec![R::zero(); count * count];
        for (&i, its) in stuck.iter().zip(&bounds) {
            let (gradient, square) = (self.gradient(i, &at.gradient), half(its) * half(its));
            for a in 0..count {
                for b in 0..count {
                    weights[a * count + b] = weights[a * count + b] + gradient[a] * gradient[b] * square;
                }
            }
        }
        // A coordinate that none of them spans is not theirs to hold.
        let largest = (0..count).fold(0.0_f64, |most, k| most.max(weights[k * count + k].value()));
        for k in 0..count {
            let own = &mut weights[k * count + k];
            *own = *own + R::constant(1e-13 * largest.max(f64::MIN_POSITIVE));
        }
        factor(&mut weights, count);
        solve(&weights, count, &mut left);
        for (&i, its) in stuck.iter().zip(&bounds) {
            let by = half(its) * half(its) * dot(self.gradient(i, &at.gradient), &left);
            at.units[i].tension = at.units[i].tension + by;
        }
    }

    /// Enters the modes of a mechanism whose given motion has changed its rates.
    pub(crate) fn enter_given_motion(
        &self,
        m: usize,
        time: R,
        state: &mut [R],
        mode: &mut PlantMode<R>,
        at: &mut Evaluation<R>,
    ) {
        self.enter_extents(m, time, state, mode, at);
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
        let demands = driver.take(truth);
        let until = driver.next();
        for (place, &valve) in driver.valves().iter().enumerate() {
            if let Some(demand) = demands.as_ref().and_then(|demands| demands[place]) {
                self.plant.network.set_valve(valve, time, demand, network)?;
            }
            self.plant.network.pulse_valve(valve, [time, until], network)?;
        }
        Ok(Some(index))
    }
}
