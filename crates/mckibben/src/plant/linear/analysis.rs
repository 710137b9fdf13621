//! What a plant's linear model does: what its inputs reach, in which mode each actuator swings, and how far an output swings under
//! pulses.
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
/// The part in a mode below which an actuator does not take part in it.
const LEAST_PART: f64 = 0.01;

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

    /// The damped angular frequency in rad/s of the oscillating mode in which an actuator takes part most; `None` where it takes
    /// less than a hundredth part in each, as between fixed ends or on an overdamped load.
    ///
    /// Its part is that of the mode in how fast its ends move apart just after a push of the actuator: on a mechanism of one
    /// coordinate the participation factor of the velocity.
    ///
    /// # Errors
    /// As [`PlantStateSpace::poles`](crate::linearize::StateSpace::poles).
    pub fn oscillation(&self, actuator: usize) -> Result<Option<f64>, Error> {
        let (system, plant) = (self.minimal(), &self.frame.plant);
        let m = plant.actuators[actuator].mechanism;
        let (here, from) = (plant.places.mechanisms[m], plant.places.actuators[actuator].gradient);
        let gradient = self.frame.evaluate(&[]).at.gradient;
        let along = |coordinate: usize| gradient[from + coordinate].value;
        let rate = |state: &PlantState| match *state {
            PlantState::Velocity { mechanism, coordinate } if mechanism == m => along(coordinate),
            _ => 0.0,
        };
        let rates: Vec<f64> = system.states.iter().map(rate).collect();
        let mut push = alloc::vec![0.0; rates.len()];
        for coordinate in 0..here.coordinates {
            let force = PlantInput::Force { mechanism: m, coordinate };
            let Some(column) = system.inputs.iter().position(|its| *its == force) else { continue };
            push.iter_mut().zip(&system.b).for_each(|(push, row)| *push += along(coordinate) * row[column]);
        }
        let parts = system.oscillating_parts(&push, &rates)?;
        let most = parts.into_iter().max_by(|(_, a), (_, b)| a.total_cmp(b));
        Ok(most.filter(|(_, part)| *part >= LEAST_PART).map(|(pole, _)| pole.imaginary))
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
                    let [first, last] = part.ends.map(|openings| openings[port as usize]);
                    // The integrals of a straight line times cosine and sine, by parts.
                    let slope = if begin < end { (last - first) / (end - begin) } else { 0.0 };
                    let of_cosine = last * end.sin() - first * begin.sin() + slope * (end.cos() - begin.cos());
                    let of_sine = first * begin.cos() - last * end.cos() + slope * (end.sin() - begin.sin());
                    cosine += of_cosine / (order * PI);
                    sine += of_sine / (order * PI);
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
