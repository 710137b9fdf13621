//! What a plant's linear model does: what its inputs reach, and how far an output swings under pulses.
//!
//! Poles and frequency responses are those of every [`StateSpace`](crate::linearize::StateSpace).

use super::derivatives::derivatives;
use super::frame::Drive;
use super::{PlantInput, PlantLinearization, PlantOutput, PlantState, PlantStateSpace};
use crate::error::Error;
use crate::linearize::{Controllability, Phasor, UsualSize};
use crate::mechanism::Mechanism;
use crate::network::BranchKind;
use crate::valve::{Port, period, with_duty};
use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};

/// Harmonics of the pulses that a ripple is made of; the flow of a pulse has them in proportion to 1/k, a length to 1/k⁴.
const HARMONICS: usize = 24;
/// Instants of a period at which a ripple is looked at.
const POINTS: usize = 480;

impl PlantLinearization {
    /// What one input of a model of this linearisation reaches: [`PlantLinearization::system`] or
    /// [`PlantLinearization::minimal`]. The usual size of a pressure, a mass of air or a length is its value at the operating
    /// point, that of an angle a radian, that of a distance the length of an actuator there, and that of a flow what a wave
    /// of the pressure's own size drives through the hose.
    ///
    /// # Errors
    /// As [`PlantStateSpace::poles`](crate::linearize::StateSpace::poles).
    pub fn controllability(&self, system: &PlantStateSpace, input: usize) -> Result<Controllability, Error> {
        let sizes: Vec<UsualSize> = system.states.iter().map(|state| self.usual_size(state)).collect();
        system.controllability(input, &sizes)
    }

    /// How large a state usually is.
    pub(in crate::plant) fn usual_size(&self, of: &PlantState) -> UsualSize {
        let (plant, state, lengths) = (&self.point.plant, &self.point.state, &self.point.lengths);
        let places = plant.indices();
        let coordinate = |mechanism: usize| match (&plant.mechanisms()[mechanism], places.members[mechanism].first()) {
            (Mechanism::Chain(_), _) | (_, None) => 1.0,
            (_, Some(first)) => lengths[*first],
        };
        let node = |node: usize| places.nodes[node].map_or(1.0, |slot| state[slot]);
        let size = match *of {
            PlantState::Position { mechanism, .. } | PlantState::Velocity { mechanism, .. } => coordinate(mechanism),
            PlantState::Pressure { actuator } => state[places.actuators[actuator].pressure],
            PlantState::AirMass { actuator } => state[places.actuators[actuator].mass()],
            PlantState::Length { actuator }
            | PlantState::Bristles { actuator }
            | PlantState::Branch { actuator, .. } => lengths[actuator],
            PlantState::NodePressure { node: its } => node(its),
            PlantState::BranchFlow { branch } => {
                let branch = &plant.network().branches[branch];
                match &branch.kind {
                    BranchKind::Inertia(hose) => node(branch.from) * hose.tube().area() / hose.wave_speed(),
                    _ => 1.0,
                }
            }
            PlantState::SpoolPosition { .. } | PlantState::SpoolVelocity { .. } => 1.0,
        };
        UsualSize { size, is_rate: of.is_rate() }
    }

    /// How far one output swings, peak to peak, under the switching of a pulsed valve: by the first 24 harmonics of its
    /// openings through the model. `None` for a valve that is not averaged, or an output that the model has not.
    pub fn ripple(&self, valve: usize, output: PlantOutput) -> Option<f64> {
        let average = self.averages.iter().find(|average| average.valve == valve)?;
        let actuation = &self.point.plant.network().valves[valve];
        let intervals = period(&actuation.solenoid, &with_duty(&actuation.command, average.duty)?)?;
        let mut frame = self.frame.clone();
        frame.drives[valve] = Drive::Openings(average.shares);
        let system = derivatives(&frame);
        let output = system.outputs.iter().position(|its| *its == output)?;
        let inputs = [Port::Supply, Port::Exhaust].map(|port| {
            let input = system.inputs.iter().position(|its| *its == PlantInput::Opening { valve, port })?;
            Some((input, port))
        });
        let mut swings = Vec::with_capacity(HARMONICS);
        for harmonic in 1..=HARMONICS {
            let order = harmonic as f64;
            let mut swing = Phasor { real: 0.0, imaginary: 0.0 };
            for (input, port) in inputs.into_iter().flatten() {
                let (mut cosine, mut sine, mut from) = (0.0, 0.0, 0.0);
                for part in &intervals {
                    let (begin, end) = (order * TAU * from, order * TAU * (from + part.share));
                    let opening = part.openings[port as usize];
                    cosine += opening * (end.sin() - begin.sin()) / (order * PI);
                    sine += opening * (begin.cos() - end.cos()) / (order * PI);
                    from += part.share;
                }
                // cos and sin of a real signal are the parts of cosine − j sine.
                let Phasor { real, imaginary } = system.response(input, output, order * TAU * average.frequency)?;
                swing.real += real * cosine + imaginary * sine;
                swing.imaginary += imaginary * cosine - real * sine;
            }
            swings.push(swing);
        }
        let at = |point: usize| -> f64 {
            let angle = TAU * point as f64 / POINTS as f64;
            let of = |(harmonic, swing): (usize, &Phasor)| {
                let (sine, cosine) = ((harmonic + 1) as f64 * angle).sin_cos();
                swing.real * cosine - swing.imaginary * sine
            };
            swings.iter().enumerate().map(of).sum()
        };
        let ends = (0..POINTS).map(at).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        Some(ends.1 - ends.0)
    }
}
