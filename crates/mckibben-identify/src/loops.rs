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
//! Direction and velocity are those of parabolas and cubics through several readings, in windows that follow from the noise of the length
//! (`motion`), and so is the way along which hysteresis and branches go, with its turns between two samples (`path`). A reading whose direction is not known, near a turn or a rest, does not
//! count: dry friction has no known sign there. The static force takes the length as it was read, and not the parabola's: so its noise
//! k σ, with the stiffness k, is another for each residual, as an interval takes it to be. A parabola would spread it over a window.
//!
//! ```text
//! s² = σ_F² + k² σ_L² + p² σ_P²     where the deviation σ_F of a tension is known; k² and p² are the means of squared derivatives of the
//!                                   static force with respect to length and pressure, at the start
//! ```
//!
//! With a Maxwell-slip law of given reaches its stiffness ratios are the weights of a play-operator sum (generalised
//! Prandtl–Ishlinskii), in which the tension is linear: bounds of zero keep them from pushing.
//!
//! Source: the Maxwell-slip model as in the core's `friction`; the fit is derived here.
//! Checked by `tests/loops.rs`: weights, Coulomb width and damping put in come back out, and a law
//! without hysteresis leaves the loop; how often intervals of Coulomb width and damping hold the truth under noise of the length.

use crate::adjustable::{Adjustable, Seeded};
use crate::least_squares::{self, Evaluation, FitError, Found, Model, Search, Unknown};
use crate::motion::Motion;
use crate::propagation::Slope;
use crate::series;
use mckibben::friction::{Memory, SlidingState, Viscoelastic};
use mckibben::{AbsolutePressure, Actuator, Dual, Error};
use mckibben_scenario::Scenario;
use thiserror::Error as ThisError;

/// The part of the largest tension below which a residual is that of rounding.
const ROUNDING: f64 = 1e-5;

/// Readings of a known direction that a run must have, at least: one in so many.
const KNOWN: usize = 10;

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
    motion: Motion,
    /// Standard deviation of a pressure in Pa.
    pressure_noise: f64,
    /// The first sample of a known direction after the first turn of the length.
    first: usize,
}

/// Why there is no fit of loops.
#[derive(Clone, Debug, PartialEq, ThisError)]
pub enum LoopError {
    /// The length does not turn.
    #[error(
        "the length of the run `{name}` does not reverse beyond its noise: hysteresis appears only where it reverses; record it to and fro"
    )]
    NoTurn {
        /// The run.
        name: String,
    },
    /// The direction of the length is known almost nowhere.
    #[error(
        "the direction of the length of the run `{name}` is not known at {hidden} of {readings} readings: its noise, {:.3} µm, hides it, or it \
         reverses within a few readings; read the length with less noise or more often, move faster, or fit kind = \"trajectories\"",
        1e6 * noise
    )]
    Hidden {
        /// The run.
        name: String,
        /// Readings at which it moves and its direction is not known.
        hidden: usize,
        /// Readings at which it moves.
        readings: usize,
        /// Noise of the length in m.
        noise: f64,
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
    /// A loop of samples, whose lengths and pressures have standard deviations in m and in Pa that are known, or that are estimated from
    /// them.
    ///
    /// # Errors
    /// [`LoopError::BadSample`], [`LoopError::NoTurn`] when the length never turns, and [`LoopError::Hidden`] when its
    /// direction is known almost nowhere.
    pub fn new(
        name: impl Into<String>,
        samples: Vec<Sample>,
        [of_length, of_pressure]: [Option<f64>; 2],
    ) -> Result<Self, LoopError> {
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
        let all = |value: fn(&Sample) -> f64| samples.iter().map(value).collect::<Vec<f64>>();
        let (times, lengths) = (all(|sample| sample.time), all(|sample| sample.length));
        let pressure_noise =
            series::noise(&times, &all(|sample| sample.gauge_pressure)).max(of_pressure.unwrap_or(0.0));
        if first_turn(lengths.windows(2).map(|pair| pair[1] - pair[0])).is_none() {
            return Err(LoopError::NoTurn { name });
        }
        let motion = Motion::new(&times, &lengths, of_length);
        let first = first_turn(motion.moving.iter().map(|moving| moving.map_or(0.0, |moving| moving.velocity)));
        let found = Self { name, samples, motion, pressure_noise, first: first.unwrap_or(0) };
        let [known, readings] = [found.counted(), found.moving()];
        match first {
            _ if known * KNOWN < readings || known == 0 => {
                let (hidden, noise) = (readings - known, found.motion.noise);
                Err(LoopError::Hidden { name: found.name, hidden, readings, noise })
            }
            None => Err(LoopError::NoTurn { name: found.name }),
            Some(_) => Ok(found),
        }
    }

    /// All samples in the order of time.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// Standard deviation of a length in m, as it was stated or is estimated, whichever is larger.
    pub fn length_noise(&self) -> f64 {
        self.motion.noise
    }

    /// How many samples count.
    pub fn counted(&self) -> usize {
        self.counting().count()
    }

    /// Samples from the first turn on that do not count because the direction of the length is not known there. Those that rest between
    /// equal lengths are not among them.
    pub fn left_out(&self) -> usize {
        self.moving() - self.counted()
    }

    /// Samples that the direction is from, at the median of those that count.
    pub fn window(&self) -> usize {
        let mut halves: Vec<usize> =
            self.counting().filter_map(|place| Some(self.motion.moving[place]?.half)).collect();
        halves.sort_unstable();
        halves.get(halves.len() / 2).map_or(0, |half| 2 * half + 1)
    }

    /// The samples that count: those from the first turn on at which the direction of the length is known.
    fn counting(&self) -> impl Iterator<Item = usize> + '_ {
        (self.first..self.samples.len()).filter(|place| self.motion.moving[*place].is_some())
    }

    /// How many samples from the first turn on do not rest between equal lengths, or count nevertheless.
    fn moving(&self) -> usize {
        let length = |place: usize| self.samples.get(place).map(|sample| sample.length);
        let moves = |place: &usize| {
            let before = if *place > 0 { length(place - 1) } else { None };
            let others = [before, length(place + 1)];
            self.motion.moving[*place].is_some()
                || others.into_iter().flatten().any(|other| Some(other) != length(*place))
        };
        (self.first..self.samples.len()).filter(moves).count()
    }

    /// Visits the tension at each sample that counts, in order, over any scalar of the actuator.
    fn tensions<S: mckibben::Real>(&self, actuator: &Actuator<S>, mut visit: impl FnMut(usize, S)) {
        let path = &self.motion.path;
        if self.samples.is_empty() {
            return;
        }
        let begin = path.length(0);
        let atmosphere = actuator.air().atmosphere().0;
        let mut memory = Memory::relaxed(actuator.limits().actuator_length(S::constant(begin)));
        let branches = actuator.friction().viscoelastic();
        let mut relaxed = vec![S::constant(begin); branches.map_or(0, Viscoelastic::count)];
        let (mut time, mut length) = (self.samples[0].time, begin);
        for place in 1..self.samples.len() {
            let here = self.samples[place];
            let turn = path.turn(place).map(|turn| (turn.time, turn.length, None));
            // To the turn before the sample, if there is one, and from there to the sample.
            for (until, end, moving) in
                turn.into_iter().chain([(here.time, path.length(place), self.motion.moving[place])])
            {
                let span = until - time;
                let velocity = S::constant(moving.map_or((end - length) / span, |moving| moving.velocity));
                if let Some(law) = branches {
                    relax(law, &mut relaxed, [length, end], span);
                }
                (time, length) = (until, end);
                let end = S::constant(end);
                if place >= self.first && moving.is_some() {
                    let sliding =
                        SlidingState { width: actuator.width(&memory, end, velocity), ..velocity.sign().into() };
                    let sliding = sliding.with_branches(branches, end, branches.map(|law| law.sums(&relaxed)));
                    let pressure = S::constant(here.gauge_pressure) + atmosphere;
                    visit(place, actuator.tension_sliding(S::constant(here.length), velocity, pressure, sliding));
                }
                actuator.remember(&mut memory, end, velocity);
            }
        }
    }

    /// Sum of the squares of what the noise of length and pressure makes of the static force in N, over the samples that count.
    fn squares_of_noise(&self, actuator: &Actuator) -> f64 {
        let atmosphere = actuator.air().atmosphere().0;
        let of = |place: usize| {
            let Sample { length, gauge_pressure, .. } = self.samples[place];
            let pressure = gauge_pressure + atmosphere;
            let by_length = actuator.stiffness(length, AbsolutePressure(pressure)) * self.motion.noise;
            let force: Slope = actuator.static_force(Dual { value: length, slope: [0.0] }, Dual::variable(pressure, 0));
            by_length.powi(2) + (force.slope[0] * self.pressure_noise).powi(2)
        };
        self.counting().map(of).sum()
    }
}

/// The place of the first of some velocities that is against the first that is not zero.
fn first_turn(mut velocities: impl Iterator<Item = f64>) -> Option<usize> {
    let mut first = 0.0;
    velocities.position(|velocity| {
        first = if first == 0.0 { velocity } else { first };
        velocity * first < 0.0
    })
}

/// Takes the relaxed lengths in m of branches on from one sample to the next, along a straight line of the length: a stretch e goes
/// to `e d + v τ (1 − d)` with `d = e^{−t/τ}`.
fn relax<S: mckibben::Real>(law: &Viscoelastic<S>, relaxed: &mut [S], [before, here]: [f64; 2], span: f64) {
    for (branch, relaxed) in relaxed.iter_mut().enumerate() {
        let time = law.relaxation_time(branch);
        let decay = (-S::constant(span) / time).exp();
        let steady = S::constant((here - before) / span) * time;
        let stretch = S::constant(before) - *relaxed;
        *relaxed = S::constant(here) - (steady + decay * (stretch - steady));
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
    /// The size of a residual tension in N to which outliers do not count that the search spares: else as `left`.
    pub typical: f64,
    /// The scale of a residual in N.
    pub scale: f64,
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
        let actuator = self.adjustable.at(&start)?.driven()?.actuator;
        let scale = match self.deviation {
            Some(deviation) => deviation.hypot(self.noise_of_state(&actuator)),
            None => self.largest(),
        };
        let weighed = Weighed { task: self, scale: if scale > 0.0 { scale } else { 1.0 } };
        let mut found = least_squares::fit_from(&weighed, &self.unknowns, &self.starts, &search)?;
        found.fit = found.fit.on_bounds(&weighed);
        let scenario = self.adjustable.at(&found.fit.values())?;
        let squares: f64 = found.fit.residuals.iter().map(|residual| (residual * weighed.scale).powi(2)).sum();
        let left = (squares / found.fit.residuals.len().max(1) as f64).sqrt();
        let typical = found.fit.typical_residual(search.loss) * weighed.scale;
        Ok(LoopFit { found, scenario, left, typical, scale: weighed.scale })
    }

    /// The standard deviation in N that the residuals should have by what is stated of tension, length and pressure, where they are more than
    /// chance makes of it.
    pub fn understated(&self, found: &LoopFit) -> Option<f64> {
        let exceeds = least_squares::exceeds_scales(found.typical / found.scale, found.found.fit.degrees_of_freedom);
        (self.deviation.is_some() && exceeds).then_some(found.scale)
    }

    /// The noise of a tension in N, with what the noise of length and pressure makes of the static force, where the model leaves more than
    /// three times of it: the scenario lacks something, or readings are in other units. Outliers alone do not count to that.
    pub fn unexplained(&self, found: &LoopFit) -> Option<f64> {
        let series: Vec<[Vec<f64>; 2]> = self
            .loops
            .iter()
            .map(|of| {
                let all = |value: fn(&Sample) -> f64| of.samples.iter().map(value).collect();
                [all(|sample| sample.time), all(|sample| sample.tension)]
            })
            .collect();
        let of_tension = series::pooled_noise(series.iter().map(|[times, values]| (&times[..], &values[..])));
        let actuator = found.scenario.driven().ok()?.actuator;
        let noise = of_tension.hypot(self.noise_of_state(&actuator));
        let are_outliers = || {
            let residuals = found.found.fit.residuals.iter().map(|residual| residual * found.scale);
            series::are_outliers(&residuals.collect::<Vec<_>>(), noise)
        };
        // Of readings without noise rounding is left.
        let is_more = found.typical > series::BEYOND_NOISE * noise && found.typical > ROUNDING * self.largest();
        (is_more && !are_outliers()).then_some(noise)
    }

    /// Root mean square in N of what the noise of lengths and pressures makes of the static force.
    fn noise_of_state(&self, actuator: &Actuator) -> f64 {
        let squares: f64 = self.loops.iter().map(|of| of.squares_of_noise(actuator)).sum();
        (squares / self.count().max(1) as f64).sqrt()
    }

    /// How many samples count.
    fn count(&self) -> usize {
        self.loops.iter().map(Loop::counted).sum()
    }

    /// The largest tension in N.
    fn largest(&self) -> f64 {
        self.loops.iter().flat_map(|of| &of.samples).fold(0.0_f64, |largest, sample| largest.max(sample.tension.abs()))
    }
}

/// A task with the scale of its residuals in N.
struct Weighed<'t> {
    task: &'t LoopTask,
    scale: f64,
}

impl Model for Weighed<'_> {
    fn residuals(&self) -> usize {
        self.task.count()
    }

    fn evaluate(&self, values: &[f64]) -> Evaluation {
        let (count, scale) = (self.residuals(), self.scale);
        let LoopTask { adjustable, loops, .. } = self.task;
        let (mut residuals, mut slopes) = (vec![f64::NAN; count], vec![0.0; count * values.len()]);
        let Ok(driven) = adjustable.at(values).and_then(|scenario| scenario.driven()) else {
            return Evaluation { residuals, slopes };
        };
        for first in adjustable.passes() {
            let mut seeds = adjustable.seeds(first);
            let actuator: Actuator<Seeded> = driven.actuator.map(|parameter, value| seeds.over(parameter, value));
            let mut row = 0;
            for of in loops {
                of.tensions(&actuator, |place, tension| {
                    residuals[row] = (tension.value - of.samples[place].tension) / scale;
                    adjustable.spread(
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
