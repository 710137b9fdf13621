//! Multiple shooting: each run in segments, each from its own initial state, which must join.
//!
//! ```text
//! r = (y(t; θ, s) − y)/σ                   readings, each within its segment
//! r = (x_k(t_k; θ, s_{k−1}) − s_k)/(w S)   at each joint: length, velocity, pressure, mass of the air
//! ```
//!
//! Over a whole run of a load that bounces or goes slack, a change of a number by a millionth may change the end
//! entirely: the sum of squares is a mountain range, and a search ends in its first valley. Over a short segment it is
//! smooth. So the states s at the joints are found together with the numbers θ, and the weight w of what the joints
//! lack falls from stage to stage, S being the span of each state, until the segments are one run to within
//! the last of [`STAGES`].
//!
//! The derivatives are exact: those with respect to θ as in a whole run, those with respect to the states at all joints
//! in one more pass, since a segment depends on one joint only: four seeds and four others in turn.
//!
//! Source: Bock (1983), Recent advances in parameter identification techniques for ODE.

use super::{Observed, Recorded, Runs, Simulated, SubjectError, TrajectoryError};
use crate::adjustable::Seeded;
use crate::least_squares::{self, Ending, Evaluation, Fit, Model, Search, Unknown};
use crate::series::Polynomial;
use mckibben::Instantiate;
use mckibben::simulation::{Rig, State, simulate_in_segments};
use mckibben::{AbsolutePressure, Error, Scalar};
use nalgebra::DMatrix;
use rayon::prelude::*;

/// What the segments may lack at a joint, in spans of each state, stage by stage, and the steps that a stage may take.
const STAGES: [(f64, u64); 4] = [(1e-1, 30), (1e-2, 30), (1e-3, 30), (1e-4, 60)];
/// The relative change of the sum of squares at which a stage ends: the rest is left to the next one, or to the whole
/// run.
const SETTLED: f64 = 1e-4;
/// States at a joint.
const STATES: usize = 4;

/// Runs in segments.
pub(super) struct Segments<'a> {
    runs: &'a Runs<'a>,
    /// How many of the unknowns are numbers that are looked for.
    numbers: usize,
    /// Of each run.
    chains: Vec<Chain>,
    /// What a joint may lack, in spans.
    slack: f64,
}

/// The joints of one run.
struct Chain {
    /// Times in s.
    joints: Vec<f64>,
    /// The states at the joints from which the search begins.
    begun: Vec<[f64; STATES]>,
    /// Span of each state.
    spans: [f64; STATES],
    /// Place of the first of its unknowns.
    first: usize,
}

/// The first of the seeds of a joint: its four are not those of its neighbours.
fn slot(joint: usize) -> usize {
    STATES * (joint % 2)
}

impl Chain {
    /// Joints every so many seconds; the states there are those that were measured, where they were, and else those of the
    /// simulation from the joint before.
    fn begin(run: &Recorded, values: &[f64], every: f64, tolerance: f64, first: usize) -> Result<Self, SubjectError> {
        let ready = run.built(values)?.ready()?;
        let (rig, start) = ready.rig()?;
        let duration = run.duration(f64::INFINITY, values);
        let joints: Vec<f64> = (1..).map(|place| every * f64::from(place)).take_while(|t| *t < duration).collect();
        let mut begun = Vec::new();
        let trajectory = simulate_in_segments(rig, start, (duration, tolerance), &joints, |place, reached| {
            let here = measured(run, rig, reached, joints[place], every);
            begun.push(here.to_array());
            here
        })?;
        let spans = trajectory.ranges().map(|(low, high)| if high > low { high - low } else { low.abs().max(1e-9) });
        Ok(Self { joints, begun, spans, first })
    }

    /// Unknowns of its joints: how far each state is from where it began, in spans.
    fn unknowns(&self) -> impl Iterator<Item = Unknown> + '_ {
        (0..STATES * self.joints.len()).map(|place| Unknown::new(format!("joint {place}"), "", 0.0))
    }

    /// Begins where a fit has ended.
    fn move_to(&mut self, values: &[f64]) {
        self.begun = (0..self.joints.len()).map(|joint| self.at(joint, values)).collect();
    }

    /// The state at a joint by values of all unknowns.
    fn at(&self, joint: usize, values: &[f64]) -> [f64; STATES] {
        std::array::from_fn(|n| self.begun[joint][n] + self.spans[n] * values[self.first + STATES * joint + n])
    }
}

/// A state with length, velocity and pressure as they were measured near a joint, as far as they were. The air keeps its
/// temperature.
fn measured(run: &Recorded, rig: &Rig, reached: State, joint: f64, every: f64) -> State {
    let near = |observed: Observed| {
        let recorded = run.time_series.iter().find(|recorded| recorded.observed == observed)?;
        let range = crate::series::between(&recorded.times, joint - 0.2 * every, joint + 0.2 * every);
        Polynomial::fit(&recorded.times[range.clone()], &recorded.values[range], joint, 2)
    };
    let atmosphere = rig.actuator().air().atmosphere().0;
    let mut here = reached;
    if let Some(length) = near(Observed::Length) {
        (here.length, here.velocity) = (length.coefficients[0], length.coefficients[1]);
    }
    if let Some(gauge) = near(Observed::GaugePressure) {
        here.pressure = AbsolutePressure(gauge.coefficients[0] + atmosphere);
    }
    let content = |state: &State| state.pressure.0 * rig.actuator().volume(state.length);
    here.air_mass *= content(&here) / content(&reached);
    here
}

impl Segments<'_> {
    /// Runs one chain over any scalar, the state at each joint seeded as `seed` does, and visits the residuals: those of
    /// the readings, then those of the joints in order.
    fn recorded<R: Instantiate>(
        &self,
        (run, chain): (&Recorded, &Chain),
        (rig, start): (&Rig<R>, State<R>),
        values: &[f64],
        seed: impl Fn(usize, [f64; STATES]) -> [R; STATES],
        mut visit: impl FnMut(R),
    ) -> Result<Simulated<R>, Error> {
        let duration = R::constant(run.duration(f64::INFINITY, values));
        let mut lacking = Vec::new();
        let trajectory =
            simulate_in_segments(rig, start, (duration, self.runs.tolerance), &chain.joints, |joint, reached| {
                let here = seed(joint, chain.at(joint, values));
                for ((reached, here), span) in reached.to_array().into_iter().zip(here).zip(chain.spans) {
                    lacking.push((reached - here) / R::constant(self.slack * span));
                }
                State::from_array(here)
            })?;
        let simulated = Simulated { trajectory: trajectory.into_plant() };
        self.runs.compare(run, &simulated, values, |_, residual, _| visit(residual));
        lacking.into_iter().for_each(visit);
        Ok(simulated)
    }

    /// Residuals of one run alone.
    fn tried(&self, run: &Recorded, chain: &Chain, values: &[f64]) -> Vec<f64> {
        let mut residuals = Vec::new();
        match self.simulated(run, chain, values, |residual| residuals.push(residual)) {
            Ok(_) => residuals,
            Err(_) => vec![f64::NAN; self.count(run, chain)],
        }
    }

    /// The parameters with their standard errors, the states at the joints being estimated with them: the derivatives
    /// with respect to the parameters are taken less what a change of those states makes of them. A loss that spares
    /// outliers is taken as squares there.
    fn found(
        &self,
        unknowns: &[Unknown],
        values: Vec<f64>,
        search: &Search,
    ) -> Result<(Fit, Vec<Simulated>), TrajectoryError> {
        let at: Vec<f64> = values.iter().copied().chain(vec![0.0; self.joint_unknowns()]).collect();
        let mut reduced = Evaluation { residuals: Vec::new(), slopes: Vec::new() };
        let (mut simulated, mut of_readings) = (Vec::new(), Vec::new());
        for (run, chain) in self.pairs() {
            let (residuals, slopes) = self.of_run(run, chain, &at);
            let slopes = DMatrix::from_row_slice(residuals.len(), at.len(), &slopes);
            let (by_numbers, by_states) =
                (slopes.columns(0, self.numbers), slopes.columns(chain.first, STATES * chain.joints.len()));
            let basis = by_states.into_owned().qr().q();
            let own = by_numbers - &basis * (basis.transpose() * by_numbers);
            of_readings.extend_from_slice(&residuals[..self.runs.readings(run).count()]);
            reduced.residuals.extend(residuals);
            reduced.slopes.extend(own.row_iter().flat_map(|row| row.iter().copied().collect::<Vec<_>>()));
            simulated.push(self.simulated(run, chain, &at, |_| ()).map_err(|error| run.failed(error))?);
        }
        let fit = Fit::of_eliminated(self, unknowns, search, (values, reduced), self.joint_unknowns());
        Ok((Fit { residuals: of_readings, ..fit }, simulated))
    }

    /// One run in its segments; visits the residuals.
    fn simulated(
        &self,
        run: &Recorded,
        chain: &Chain,
        values: &[f64],
        visit: impl FnMut(f64),
    ) -> Result<Simulated, SubjectError> {
        Ok(self.recorded((run, chain), run.built(values)?.ready()?.rig()?, values, |_, at| at, visit)?)
    }

    fn joint_unknowns(&self) -> usize {
        self.chains.iter().map(|chain| STATES * chain.joints.len()).sum()
    }

    fn pairs(&self) -> impl Iterator<Item = (&Recorded, &Chain)> {
        self.runs.runs.iter().zip(&self.chains)
    }

    fn count(&self, run: &Recorded, chain: &Chain) -> usize {
        self.runs.readings(run).count() + STATES * chain.joints.len()
    }

    /// Residuals of one run, and their derivatives with respect to all unknowns.
    fn of_run(&self, run: &Recorded, chain: &Chain, values: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (count, width) = (self.count(run, chain), values.len());
        let nothing = || (vec![f64::NAN; count], vec![0.0; count * width]);
        let (mut residuals, mut slopes) = nothing();
        let Ok(built) = run.built(values) else { return nothing() };
        for first in run.subject.passes() {
            let Ok(seeded) = built.seeded(&run.subject, first) else { return nothing() };
            let Ok(rig) = seeded.rig() else { return nothing() };
            let mut row = 0;
            let constant = |_: usize, at: [f64; STATES]| at.map(Seeded::constant);
            let full = self.recorded((run, chain), rig, values, constant, |residual| {
                let mut by_own = vec![0.0; run.unknowns.len()];
                run.subject.spread(first, &residual.slope, &mut by_own);
                for (unknown, slope) in run.unknowns.iter().zip(by_own) {
                    slopes[row * width + unknown] += slope;
                }
                residuals[row] = residual.value;
                row += 1;
            });
            if full.is_err() {
                return nothing();
            }
        }
        let Ok(constant) = built.over(|_, _, value| Seeded::constant(value)) else { return nothing() };
        let Ok(rig) = constant.rig() else { return nothing() };
        let seed = |joint: usize, at: [f64; STATES]| std::array::from_fn(|n| Seeded::variable(at[n], slot(joint) + n));
        let readings: Vec<f64> = self.runs.readings(run).map(|(time, _)| time).collect();
        let mut row = 0;
        let full = self.recorded((run, chain), rig, values, seed, |residual| {
            // A reading knows the joint behind which it lies, what a joint lacks its own state and that of the joint before.
            let joints = match readings.get(row) {
                Some(time) => [chain.joints.partition_point(|joint| *joint <= *time).checked_sub(1), None],
                None => {
                    let joint = (row - readings.len()) / STATES;
                    [Some(joint), joint.checked_sub(1)]
                }
            };
            for joint in joints.into_iter().flatten() {
                let into = &mut slopes[row * width + chain.first + STATES * joint..][..STATES];
                for (n, into) in into.iter_mut().enumerate() {
                    *into = residual.slope[slot(joint) + n] * chain.spans[n];
                }
            }
            row += 1;
        });
        if full.is_err() {
            return nothing();
        }
        (residuals, slopes)
    }
}

impl Model for Segments<'_> {
    fn residuals(&self) -> usize {
        self.pairs().map(|(run, chain)| self.count(run, chain)).sum()
    }

    fn evaluate(&self, values: &[f64]) -> Evaluation {
        let pairs: Vec<_> = self.pairs().collect();
        let parts: Vec<_> = pairs.par_iter().map(|(run, chain)| self.of_run(run, chain, values)).collect();
        let (residuals, slopes): (Vec<_>, Vec<_>) = parts.into_iter().unzip();
        Evaluation { residuals: residuals.concat(), slopes: slopes.concat() }
    }

    fn residuals_at(&self, values: &[f64]) -> Vec<f64> {
        let pairs: Vec<_> = self.pairs().collect();
        pairs.par_iter().map(|(run, chain)| self.tried(run, chain, values)).collect::<Vec<_>>().concat()
    }

    fn rounding(&self) -> f64 {
        SETTLED
    }

    fn precision(&self) -> f64 {
        self.runs.precision()
    }
}

/// What came of segments.
pub(super) enum Shot {
    /// The parameters, each run in its segments, and how many initial states of segments were estimated with them.
    Joined(Fit, Vec<Simulated>, usize),
    /// The values that had been reached when the search was ended from outside.
    Stopped(Vec<f64>, Ending),
}

/// The parameters from segments of so many seconds.
pub(super) fn fit(runs: &Runs<'_>, unknowns: &[Unknown], every: f64, search: &Search) -> Result<Shot, TrajectoryError> {
    let mut values: Vec<f64> = unknowns.iter().map(|unknown| unknown.start).collect();
    let mut chains = Vec::new();
    let mut first = unknowns.len();
    for run in runs.runs {
        let chain = Chain::begin(run, &values, every, runs.tolerance, first).map_err(|error| run.failed(error))?;
        first += STATES * chain.joints.len();
        chains.push(chain);
    }
    let mut segments = Segments { runs, numbers: unknowns.len(), chains, slack: f64::INFINITY };
    for (slack, steps) in STAGES {
        segments.slack = slack;
        let from = least_squares::starting_at(unknowns, &values).into_iter();
        let all: Vec<Unknown> = from.chain(segments.chains.iter().flat_map(Chain::unknowns)).collect();
        let most_steps = search.most_steps.min(steps);
        let found = least_squares::descended(&segments, &all, &Search { most_steps, ..search.clone() });
        if let Some(ending) = search.monitor.ending() {
            let reached = found.map(|found| found[..segments.numbers].to_vec()).unwrap_or(values);
            return Ok(Shot::Stopped(reached, ending));
        }
        let found = found?;
        segments.chains.iter_mut().for_each(|chain| chain.move_to(&found));
        values = found[..segments.numbers].to_vec();
    }
    let (fit, simulated) = segments.found(unknowns, values, search)?;
    Ok(Shot::Joined(fit, simulated, segments.joint_unknowns()))
}
