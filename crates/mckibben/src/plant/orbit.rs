//! The periodic orbit of a plant under periodic commands: where a run settles.
//!
//! ```text
//! x* = Π(x*)          Π: the states one period later
//! r_k = Π(x_k) − x_k
//! x_{k+1} = Π(x_k) − Σ γ_j (Δx_j + Δr_j)        γ = argmin |r_k − Σ γ_j Δr_j|
//! ```
//!
//! The period is the least that all pulses and sinusoids of the plant have in common, those of set points included; a plant without
//! such settles at an equilibrium. With controllers a few such periods are one, where that makes it hold whole samples and pulses of
//! theirs, and they must decide as a period before. Where they follow a set point that swings, the steps of their sensors and pulses
//! leave a jitter: the states then return within a thousandth. Each evaluation of Π is a run of one period by the run's own engine,
//! so nothing is averaged or linearised.
//!
//! Plain iteration follows the plant as it settles, and never ends for a swing that nothing damps. Anderson's method, above,
//! weighs the last few periods so that the residual is least; for a linear Π with n states it is exact after n
//! periods, whether Π contracts or not. What Π conserves must be kept: of (19) that is P (V/m)^n of the air in each actuator, from
//! which guessed pressures follow. A guess that makes the residual larger is taken back. At the end the plant goes through one
//! period without a guess, and the states must return.
//!
//! Only states can be guessed, and only where the way there does not matter. Where dry friction holds a load anywhere in a band, hysteresis
//! remembers turns, a compressor keeps a tank between two pressures, or a driver has a memory, every period is a plain one: such a
//! plant has many orbits, and comes to the one that its own way leads to.
//!
//! Source: D. G. Anderson, "Iterative procedures for nonlinear integral equations", J. ACM 12 (1965) 547–560; H. F. Walker &
//! P. Ni, SIAM J. Numer. Anal. 49 (2011) 1715–1735. Least squares are those of the crate `nalgebra`.
//!
//! Checked by `tests/orbit.rs`.

use super::{Plant, PlantRun, PlantSnapshot};
use crate::error::Error;
use crate::friction::Friction;
use crate::load::Motion;
use crate::mechanism::Mechanism;
use crate::network::{Node, NodeKind};
use crate::simulation::PressureSeries;
use crate::valve::Command;
use alloc::vec::Vec;
use nalgebra::{DMatrix, DVector};

/// Periods that are weighed.
const DEPTH: usize = 10;
/// Plain periods before the first guess, and after one that was taken back.
const PLAIN: usize = 3;
/// A guess that makes the residual so many times larger than any that is weighed is taken back.
const WORSE: f64 = 2.0;
/// A part of the residual below this part of the largest is rounding.
const RANK: f64 = 1e-9;
/// The residual of a state that has settled, over the size by which the engine measures errors, in relative tolerances.
const SETTLED: f64 = 30.0;
/// That residual where a controller follows a set point that swings, and in how many times as much its numbers return.
const JITTER: f64 = 1e-3;
const DECIDED: f64 = 10.0;
/// Pulses of the fastest that a common period may have.
const MOST_PULSES: f64 = 1000.0;
/// Periods at most that are taken for one, for whole samples of controllers.
const MOST_FOR_SAMPLES: f64 = 10.0;

/// How a run settled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// The period in s.
    pub period: f64,
    /// Periods that were simulated.
    pub periods: u64,
    /// How many of them began at a guess; none where the plant went there without one.
    pub guesses: u64,
    /// The largest change of a state over the last period, over the size by which the engine measures errors.
    pub residual: f64,
    /// Whether the states return within the engine's error; within a thousandth where a controller follows a set point that swings.
    pub settled: bool,
}

impl Plant {
    /// The least period in s that all pulses and given sinusoids have in common; none where there are neither.
    ///
    /// # Errors
    /// [`Error::NotImplemented`] where they have none of up to a thousand pulses of the fastest.
    pub fn period(&self) -> Result<Option<f64>, Error> {
        common_period(&self.frequencies())
    }

    /// Frequencies in Hz of all pulses and given sinusoids.
    fn frequencies(&self) -> Vec<f64> {
        let pulses = self.network.valves.iter().filter_map(|valve| match valve.command {
            Command::Pwm { frequency, .. } => Some(frequency),
            _ => None,
        });
        let motions = self.mechanisms.iter().filter_map(|mechanism| match mechanism {
            Mechanism::Prescribed(Motion::Sinusoid { frequency, .. }) => Some(*frequency),
            _ => None,
        });
        pulses.chain(motions).filter(|frequency| *frequency > 0.0).collect()
    }

    /// The time in s from which on nothing changes but by pulses and sinusoids.
    pub fn last_change(&self) -> f64 {
        let last = |times: &[f64]| times.last().copied().unwrap_or(0.0);
        let commands = self.network.valves.iter().map(|valve| match &valve.command {
            Command::Constant(_) | Command::Pwm { .. } => 0.0,
            Command::Table { time, .. } | Command::SetPoints { time, .. } | Command::Positions { time, .. } => {
                last(time)
            }
        });
        let motions = self.mechanisms.iter().map(|mechanism| match mechanism {
            Mechanism::Prescribed(Motion::Table { time, .. }) => last(time),
            _ => 0.0,
        });
        let given = self.actuators.iter().filter_map(|mounted| mounted.pressure.as_ref());
        let given = given.chain(&self.network.series).map(PressureSeries::end);
        commands.chain(motions).chain(given).fold(0.0, f64::max)
    }

    /// The length in m of an actuator in given states.
    fn length_in(&self, states: &[f64], index: usize) -> f64 {
        let mounted = &self.actuators[index];
        if let Some(place) = self.places.actuators[index].length {
            return states[place];
        }
        let here = &self.places.mechanisms[mounted.mechanism];
        let chain = match &self.mechanisms[mounted.mechanism] {
            Mechanism::Chain(chain) => Some(chain),
            _ => None,
        };
        mounted.coupling.distance_at(chain, here.of(states).0, &mut alloc::vec![0.0; here.coordinates])
    }

    /// Whether the states are all that the plant remembers, and where it settles does not depend on the way there.
    fn may_be_guessed(&self) -> bool {
        let remembers = |friction: &Friction| friction.has_coulomb() || friction.hysteresis().is_some();
        let is_tank = |node: &Node| matches!(node.kind, NodeKind::Reservoir(_));
        !self.actuators.iter().any(|mounted| remembers(mounted.actuator.friction()))
            && !self.network.nodes.iter().any(is_tank)
    }
}

/// The least period in s that frequencies in Hz have in common; none where there are none.
fn common_period(frequencies: &[f64]) -> Result<Option<f64>, Error> {
    let Some(fastest) = frequencies.iter().copied().reduce(f64::max) else { return Ok(None) };
    match multiple(1.0 / fastest, frequencies, MOST_PULSES) {
        Some(count) => Ok(Some(count / fastest)),
        None => Err(Error::NotImplemented(&crate::limit::COMMON_PERIOD)),
    }
}

/// The least number of periods in s that holds whole cycles of all frequencies in Hz.
fn multiple(period: f64, frequencies: &[f64], most: f64) -> Option<f64> {
    let mut count = 1.0;
    while count <= most {
        let whole = |frequency: &f64| {
            let cycles = count * frequency * period;
            (cycles - cycles.round()).abs() <= 1e-9 * cycles && cycles.round() >= 1.0
        };
        if frequencies.iter().all(whole) {
            return Some(count);
        }
        count += 1.0;
    }
    None
}

/// The periods that are weighed.
struct Past {
    /// States at the start of a period, and by how much they had changed at its end.
    periods: Vec<[DVector<f64>; 2]>,
    /// The largest size that each state had.
    sizes: DVector<f64>,
}

impl Past {
    fn new(states: usize) -> Self {
        Self { periods: Vec::new(), sizes: DVector::from_element(states, f64::MIN_POSITIVE) }
    }

    /// Adds a period; sizes are those by which the engine measures errors.
    fn add(&mut self, start: DVector<f64>, residual: DVector<f64>) {
        if self.periods.len() > DEPTH {
            self.periods.remove(0);
        }
        self.periods.push([start, residual]);
    }

    fn see(&mut self, sizes: &[f64]) {
        self.sizes.iter_mut().zip(sizes).for_each(|(largest, size)| *largest = largest.max(*size));
    }

    /// A residual over the sizes.
    fn size(&self, residual: &DVector<f64>) -> f64 {
        residual.component_div(&self.sizes).amax()
    }

    /// The largest residual among the periods.
    fn largest(&self) -> f64 {
        self.periods.iter().map(|[_, residual]| self.size(residual)).fold(0.0, f64::max)
    }

    /// The states that leave the least residual by the periods so far; none before two.
    fn guess(&self) -> Option<Vec<f64>> {
        let [start, residual] = self.periods.last()?;
        let count = self.periods.len() - 1;
        if count == 0 {
            return None;
        }
        let change = |column: usize, of: usize| &self.periods[column + 1][of] - &self.periods[column][of];
        let scaled = |column: usize| change(column, 1).component_div(&self.sizes);
        // Periods long ago changed much more than the last: each counts by its own size.
        let norms: Vec<f64> = (0..count).map(|column| scaled(column).norm().max(f64::MIN_POSITIVE)).collect();
        let columns: Vec<DVector<f64>> = (0..count).map(|column| scaled(column) / norms[column]).collect();
        let left = residual.component_div(&self.sizes);
        let weights = DMatrix::from_columns(&columns).svd(true, true).solve(&left, RANK).ok()?;
        let mut guess = start + residual;
        for (column, norm) in norms.iter().enumerate() {
            guess -= (change(column, 0) + change(column, 1)) * (weights[column] / norm);
        }
        guess.iter().all(|value| value.is_finite()).then(|| guess.as_slice().to_vec())
    }
}

impl PlantRun {
    /// The period in s after which the states may return: that of pulses, given sinusoids and set points, and with controllers one
    /// that holds whole samples and pulses of theirs, where there is one. Of a plant without such at least `usual` s.
    fn period_of_all(&self, usual: f64) -> Result<f64, Error> {
        let drivers = &self.mode().drivers;
        let mut given = self.plant().frequencies();
        given.extend(drivers.iter().flat_map(|driver| driver.frequencies()));
        let sampling = drivers.iter().map(|driver| driver.sampling());
        let own: Vec<f64> = sampling.flat_map(|its| [its.rate(), its.pulse_frequency()]).collect();
        let period = match (common_period(&given)?, own.iter().copied().reduce(f64::min)) {
            (Some(period), _) => period,
            (None, Some(slowest)) => (usual * slowest).ceil() / slowest,
            (None, None) => usual,
        };
        // Where whole samples of all make no short period, the slowest measures once at least.
        let once = own.iter().map(|rate| (1.0 / (rate * period)).ceil()).fold(1.0, f64::max);
        Ok(multiple(period, &own, MOST_FOR_SAMPLES).unwrap_or(once) * period)
    }

    /// Goes on, period by period, until the states return and controllers decide as a period before; `watch` is called with the time
    /// in s behind each period, and may end it by an error. A plant that has no period is evaluated in steps of `usual` s.
    ///
    /// Take a run of fixed steps on by the event-located engine ([`PlantRun::set_stepping`]): where an event passes the end of a step
    /// the number of steps of a period changes, so its states return no closer than the error of a step.
    ///
    /// After `most` periods it stops where it is, and says that it has not settled.
    ///
    /// # Errors
    /// As [`Plant::period`] and [`PlantRun::advance_to`], and those of `watch`.
    pub fn settle(
        &mut self,
        usual: f64,
        most: u64,
        watch: &mut dyn FnMut(f64) -> Result<(), Error>,
    ) -> Result<Orbit, Error> {
        let period = self.period_of_all(usual)?;
        let drivers = self.mode().drivers.iter().map(|driver| driver.last_change());
        let last_change = drivers.fold(self.plant().last_change(), f64::max);
        // From a whole period on, so that it begins where the pulses do.
        let begun = (self.time().max(last_change) / period).ceil();
        self.advance_to(begun * period)?;
        let guesses_allowed = self.plant().may_be_guessed() && self.mode().drivers.is_empty();
        let follows = self.mode().drivers.iter().any(|driver| !driver.frequencies().is_empty());
        let tolerance = (SETTLED * self.relative_tolerance()).max(if follows { JITTER } else { 0.0 });
        let mut orbit = Orbit { period, periods: 0, guesses: 0, residual: f64::INFINITY, settled: false };
        let mut past = Past::new(self.state().len());
        // Plain periods until the next guess, and how many there are after one that is taken back.
        let (mut plain, mut pause) = (PLAIN, PLAIN);
        let mut best: Option<(f64, PlantSnapshot)> = None;
        let mut guessed = false;
        while orbit.periods < most {
            past.see(&self.scales());
            let start = DVector::from_column_slice(self.state());
            let decided: Vec<_> = self.mode().drivers.iter().map(|driver| driver.last().cloned()).collect();
            let advanced = self.advance_to(((self.time() / period).round() + 1.0) * period);
            orbit.periods += 1;
            let residual = DVector::from_column_slice(self.state()) - &start;
            let size = past.size(&residual);
            let is_bad = guessed && (advanced.is_err() || size > WORSE * past.largest());
            if let Some((_, snapshot)) = best.as_ref().filter(|_| is_bad) {
                self.restore(snapshot)?;
                past.periods.clear();
                pause *= 2;
                (plain, guessed) = (pause, false);
                continue;
            }
            advanced?;
            watch(self.time())?;
            orbit.residual = size;
            let mut drivers = self.mode().drivers.iter().zip(&decided);
            if size <= tolerance && drivers.all(|(its, then)| its.decided_as(then.as_ref(), DECIDED * tolerance)) {
                // What began at a guess must return without one.
                if !core::mem::take(&mut guessed) {
                    orbit.settled = true;
                    return Ok(orbit);
                }
                continue;
            }
            if best.as_ref().is_none_or(|(least, _)| size < *least) {
                best = Some((size, self.save()));
            }
            past.add(start, residual);
            plain = plain.saturating_sub(1);
            guessed = false;
            let guess = if guesses_allowed && plain == 0 { past.guess() } else { None };
            if let Some(mut states) = guess.filter(|states| self.could_be(states)) {
                self.keep_entropy(&mut states);
                self.go_on_from(&states);
                orbit.guesses += 1;
                guessed = true;
            }
        }
        Ok(orbit)
    }

    /// Whether a plant could be in such states: pressures and masses of air above a tenth of what they are.
    fn could_be(&self, states: &[f64]) -> bool {
        let indices = self.plant().indices();
        let air = indices.actuators.iter().flat_map(|own| [own.pressure, own.mass()]);
        let positive = air.chain(indices.nodes.iter().copied().flatten());
        states.iter().all(|value| value.is_finite())
            && positive.into_iter().all(|place| states[place] > 0.1 * self.state()[place])
    }

    /// Changes the pressures of guessed states so that the air of each actuator keeps its P (V/m)^n: its process keeps it in every
    /// run, whatever flows in and out, and a guess must not change it. Air with an energy balance has no such number.
    fn keep_entropy(&self, states: &mut [f64]) {
        let plant = self.plant();
        for (index, (mounted, own)) in plant.actuators().iter().zip(&plant.indices().actuators).enumerate() {
            if plant.indices().keeps_heat[index] || mounted.pressure.is_some() {
                continue;
            }
            let exponent = mounted.actuator.air().index();
            let density = |of: &[f64]| of[own.mass()] / mounted.actuator.volume(plant.length_in(of, index));
            let ratio = density(states) / density(self.state());
            if ratio.is_finite() && ratio > 0.0 {
                states[own.pressure] = self.state()[own.pressure] * ratio.powf(exponent);
            }
        }
    }
}
