//! Loops of tension over length at known pressure: friction and hysteresis from measured ends, without a simulation.
//!
//! ```text
//! r_k = (F(L_k, v_k, P_k, memory_k; θ) − F_k)/s        memory_{k+1}: that of the law, taken on from L_k to L_{k+1}
//! ```
//!
//! Length and pressure are taken as they were measured, so the tension follows at once: statics, effectiveness,
//! viscous and dry friction, and a hysteresis whose memory goes with the length from sample to sample, which is exact
//! while the length goes one way between two of them; viscoelastic branches relax exactly along the straight line between two
//! samples. Its derivatives with respect to the unknowns are exact. A
//! loop starts relaxed, which its first turn forgets: the readings before the first turn of the length do not count.
//!
//! The velocity is that of the straight line from the sample before; where it is zero, dry friction has no direction
//! and the reading does not count. Noise in length turns the direction about when the machine is slow: thin such a
//! recording until a step is many times the noise.
//!
//! With a Maxwell-slip law of given reaches its stiffness ratios are the weights of a play-operator sum (generalised
//! Prandtl–Ishlinskii), in which the tension is linear: bounds of zero keep them from pushing.
//!
//! Source: the Maxwell-slip model as in the core's `friction`; the fit is derived here.
//! Checked by `tests/loops.rs`: weights, Coulomb width and damping put in come back out, and a law
//! without hysteresis leaves the loop.

use crate::adjustable::{Adjustable, Seeded};
use crate::least_squares::{self, Evaluation, FitError, Found, Model, Search, Unknown};
use crate::series;
use mckibben::friction::{Memory, SlidingState, Viscoelastic};
use mckibben::{Actuator, Error};
use mckibben_scenario::Scenario;
use thiserror::Error as ThisError;

/// The part of the largest tension below which a residual is that of rounding.
const ROUNDING: f64 = 1e-5;

/// One sample of a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time in s.
    pub time: f64,
    /// Length in m.
    pub length: f64,
    /// Gauge pressure in Pa.
    pub gauge_pressure: f64,
    /// Tension in N.
    pub tension: f64,
}

/// A loop: samples of one run in the order of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Loop {
    /// What it is called.
    pub name: String,
    samples: Vec<Sample>,
    /// The first sample after the first turn of the length.
    first: usize,
}

/// Why there is no fit of loops.
#[derive(Clone, Debug, PartialEq, ThisError)]
pub enum LoopError {
    /// The length does not turn.
    #[error(
        "the length of the run `{name}` does not reverse: hysteresis appears only where it does; record it to and fro"
    )]
    NoTurn {
        /// The run.
        name: String,
    },
    /// Samples that are none.
    #[error("sample {sample} of the run `{name}` is not finite, or its time does not rise; mend the table")]
    BadSample {
        /// The run.
        name: String,
        /// Counted from 1.
        sample: usize,
    },
    /// The actuator cannot be built.
    #[error(transparent)]
    Model(#[from] Error),
    /// The search found no minimum.
    #[error(transparent)]
    Fit(#[from] FitError),
}

impl Loop {
    /// A loop of samples.
    ///
    /// # Errors
    /// [`LoopError::BadSample`], and [`LoopError::NoTurn`] when the length never turns.
    pub fn new(name: impl Into<String>, samples: Vec<Sample>) -> Result<Self, LoopError> {
        let name = name.into();
        let bad = |(place, sample): (usize, &Sample)| {
            let finite = [sample.time, sample.length, sample.gauge_pressure, sample.tension]
                .iter()
                .all(|number| number.is_finite());
            !finite || place > 0 && samples[place - 1].time >= sample.time
        };
        if let Some(place) = samples.iter().enumerate().position(bad) {
            return Err(LoopError::BadSample { name, sample: place + 1 });
        }
        let way = |place: usize| samples[place].length - samples[place - 1].length;
        let mut direction = 0.0;
        let reversal = (1..samples.len()).find(|place| {
            let is_reversal = way(*place) * direction < 0.0;
            if way(*place) != 0.0 {
                direction = way(*place).signum();
            }
            is_reversal
        });
        match reversal {
            Some(first) => Ok(Self { name, samples, first }),
            None => Err(LoopError::NoTurn { name }),
        }
    }

    /// All samples in the order of time.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// The samples that count: those after the first turn at which the length moves.
    fn counting(&self) -> impl Iterator<Item = usize> + '_ {
        let moves = |place: &usize| self.samples[*place].length != self.samples[place - 1].length;
        (self.first..self.samples.len()).filter(moves)
    }

    /// Visits the tension at each sample that counts, in order, over any scalar of the actuator.
    fn tensions<S: mckibben::Real>(&self, actuator: &Actuator<S>, mut visit: impl FnMut(usize, S)) {
        let Some(begin) = self.samples.first() else { return };
        let atmosphere = actuator.air().atmosphere().0;
        let mut memory = Memory::relaxed(actuator.limits().actuator_length(S::constant(begin.length)));
        let branches = actuator.friction().viscoelastic();
        let mut relaxed = vec![S::constant(begin.length); branches.map_or(0, Viscoelastic::count)];
        for place in 1..self.samples.len() {
            let (before, here) = (self.samples[place - 1], self.samples[place]);
            let velocity = S::constant((here.length - before.length) / (here.time - before.time));
            let length = S::constant(here.length);
            if let Some(law) = branches {
                relax(law, &mut relaxed, [before, here]);
            }
            if place >= self.first && here.length != before.length {
                let sliding =
                    SlidingState { width: actuator.width(&memory, length, velocity), ..velocity.sign().into() };
                let sliding = sliding.with_branches(branches, length, branches.map(|law| law.sums(&relaxed)));
                let pressure = S::constant(here.gauge_pressure) + atmosphere;
                visit(place, actuator.tension_sliding(length, velocity, pressure, sliding));
            }
            actuator.remember(&mut memory, length, velocity);
        }
    }
}

/// Takes the relaxed lengths in m of branches on from one sample to the next, along a straight line of the length: a stretch e goes
/// to `e d + v τ (1 − d)` with `d = e^{−t/τ}`.
fn relax<S: mckibben::Real>(law: &Viscoelastic<S>, relaxed: &mut [S], [before, here]: [Sample; 2]) {
    let span = here.time - before.time;
    for (branch, relaxed) in relaxed.iter_mut().enumerate() {
        let time = law.relaxation_time(branch);
        let decay = (-S::constant(span) / time).exp();
        let steady = S::constant((here.length - before.length) / span) * time;
        let stretch = S::constant(before.length) - *relaxed;
        *relaxed = S::constant(here.length) - (steady + decay * (stretch - steady));
    }
}

/// What is to be found, from what.
#[derive(Clone, Debug)]
pub struct LoopTask {
    /// The muscle and its numbers.
    pub adjustable: Adjustable,
    /// Bounds, priors and starts.
    pub unknowns: Vec<Unknown>,
    /// More starts.
    pub starts: Vec<Vec<f64>>,
    /// The loops.
    pub loops: Vec<Loop>,
    /// Standard deviation of a tension in N, where it is known.
    pub deviation: Option<f64>,
    /// How the minimum is looked for.
    pub search: Search,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct LoopFit {
    /// Values with their uncertainty.
    pub found: Found,
    /// The scenario with these values.
    pub scenario: Scenario,
    /// Root mean square of the residual tension, in N.
    pub left: f64,
}

impl LoopTask {
    /// Looks for the values.
    ///
    /// # Errors
    /// [`LoopError`], which says what to do.
    pub fn identify(&self) -> Result<LoopFit, LoopError> {
        // Sticking and sliding make kinks.
        let search = Search { known_scales: self.deviation.is_some(), any_end: true, ..self.search.clone() };
        let start: Vec<f64> = self.unknowns.iter().map(|unknown| unknown.start).collect();
        self.adjustable.at(&start)?.driven()?;
        let found = least_squares::fit_from(self, &self.unknowns, &self.starts, &search)?;
        let scenario = self.adjustable.at(&found.fit.values())?;
        let squares: f64 = found.fit.residuals.iter().map(|residual| (residual * self.scale()).powi(2)).sum();
        let left = (squares / found.fit.residuals.len().max(1) as f64).sqrt();
        Ok(LoopFit { found, scenario, left })
    }

    /// The noise of a tension in N, where the model leaves more than three times of it: the scenario lacks something, or readings are
    /// in other units.
    pub fn unexplained(&self, found: &LoopFit) -> Option<f64> {
        let series: Vec<[Vec<f64>; 2]> = self
            .loops
            .iter()
            .map(|of| {
                let all = |value: fn(&Sample) -> f64| of.samples.iter().map(value).collect();
                [all(|sample| sample.time), all(|sample| sample.tension)]
            })
            .collect();
        let noise = series::beyond_noise(found.left, series.iter().map(|[times, values]| (&times[..], &values[..])))?;
        // Of readings without noise rounding is left.
        (found.left > ROUNDING * self.largest()).then_some(noise)
    }

    /// The largest tension in N.
    fn largest(&self) -> f64 {
        self.loops.iter().flat_map(|of| &of.samples).fold(0.0_f64, |largest, sample| largest.max(sample.tension.abs()))
    }

    fn scale(&self) -> f64 {
        let largest = self.largest();
        self.deviation.unwrap_or(if largest > 0.0 { largest } else { 1.0 })
    }
}

impl Model for LoopTask {
    fn residuals(&self) -> usize {
        self.loops.iter().map(|of| of.counting().count()).sum()
    }

    fn evaluate(&self, values: &[f64]) -> Evaluation {
        let (count, scale) = (self.residuals(), self.scale());
        let (mut residuals, mut slopes) = (vec![f64::NAN; count], vec![0.0; count * values.len()]);
        let Ok(driven) = self.adjustable.at(values).and_then(|scenario| scenario.driven()) else {
            return Evaluation { residuals, slopes };
        };
        for first in self.adjustable.passes() {
            let mut seeds = self.adjustable.seeds(first);
            let actuator: Actuator<Seeded> = driven.actuator.map(|parameter, value| seeds.over(parameter, value));
            let mut row = 0;
            for of in &self.loops {
                of.tensions(&actuator, |place, tension| {
                    residuals[row] = (tension.value - of.samples[place].tension) / scale;
                    self.adjustable.spread(
                        first,
                        &tension.slope,
                        1.0 / scale,
                        &mut slopes[row * values.len()..][..values.len()],
                    );
                    row += 1;
                });
            }
        }
        Evaluation { residuals, slopes }
    }
}

/// Tensions in N of an actuator at the samples that count, with the place of each, for a figure.
pub fn tensions(of: &Loop, actuator: &Actuator) -> Vec<(Sample, f64)> {
    let mut found = Vec::new();
    of.tensions(actuator, |place, tension| found.push((of.samples[place], tension)));
    found
}
