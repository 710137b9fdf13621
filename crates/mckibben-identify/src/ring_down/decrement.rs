//! Friction from the turns of a ring-down: two cycles as the paper has it, or all of them by least squares.
//!
//! ```text
//! Aᵢ = |eᵢ − eᵢ₊₁|/2                                     half of the way from a turn e to the next
//! two cycles     A₀ → A₂ and Aₙ₋₃ → Aₙ₋₁                  of n half swings, by (27)–(31) or the exact recursion
//! all turns      eᵢ = x₀ ± Xᵢ + a Xᵢ²,   Xᵢ₊₁ = √β Xᵢ − Q(1 + √β)
//! ```
//!
//! Half swings need no rest position, and on a spring that stiffens with length they are the better amplitude. Two neighbours
//! share a turn, so their errors are not independent; those of the turns are, and least squares on the turns with a rest
//! position x₀ that is free is the same as least squares on the half swings with their covariance. The term `a X²`, how far
//! both sides of a swing are moved by the spring's curvature, is fitted from eight turns on.
//!
//! Intervals: of two cycles, from the noise of the samples by way of the turns' standard errors, to first order by exact
//! derivatives, with as many degrees of freedom as the noise has; they hold no error of the model. Of all turns, from the scatter
//! of the turns about the recursion, by [`least_squares`](crate::least_squares); the period's standard error is added to that of c.

use super::RingDownError;
use super::turns::{Turn, Turns};
use crate::least_squares::{Estimate, Evaluation, Fit, Model, Search, Unknown, fit};
use crate::propagation::{Measured, Slope};
use mckibben::ring_down::{Cycle, Damping, Form, half_cycle};
use mckibben::{Dual, Over, Scalar};

/// From so many turns on the curvature of the spring is fitted.
const CURVED: usize = 8;
/// What the numbers are called.
const LABELS: [(&str, &str); 4] = [("decay", ""), ("coulomb_width", "m"), ("viscous", "N*s/m"), ("damping_ratio", "")];

/// Friction as the turns show it.
#[derive(Clone, Debug, PartialEq)]
pub struct Decrement {
    /// The factor β by which viscous friction alone would shrink the amplitude in one period.
    pub decay: Estimate,
    /// Q in m of an equal linear spring.
    pub coulomb_width: Estimate,
    /// c in N·s/m.
    pub viscous: Estimate,
    /// ζ of the viscous part.
    pub damping_ratio: Estimate,
    /// Rest position in m; of all turns only.
    pub rest: Option<Estimate>,
    /// The least squares behind it; of all turns only.
    pub fit: Option<Fit>,
}

/// The damping ratio (32) of one cycle, both frictions as one.
#[derive(Clone, Debug, PartialEq)]
pub struct Equivalent {
    /// Half of the way in m from a turn to the next at the beginning of the cycle.
    pub amplitude: f64,
    /// ζ_eq.
    pub ratio: Estimate,
}

impl Turns {
    /// From the first and the last cycle, of a `mass` in kg.
    ///
    /// # Errors
    /// [`RingDownError::Physics`] when no damping explains the amplitudes, or the mass is not above zero.
    pub fn two_cycles(&self, mass: f64, form: Form) -> Result<Decrement, RingDownError> {
        let (values, deviations) = self.measured();
        let measured =
            Measured { values: &values, standard_errors: &deviations, degrees_of_freedom: self.degrees_of_freedom };
        let [decay, coulomb_width, viscous, damping_ratio] = measured.propagate(LABELS, |numbers| {
            let (lengths, period) = (&numbers[..self.turns.len()], numbers[self.turns.len()]);
            let swings = half_swings(lengths);
            let last = swings.len() - 3;
            let cycles = [0, last].map(|place| Cycle { amplitude: swings[place], next: swings[place + 2] });
            let found = Damping::from_cycles(&cycles, period, Slope::constant(mass), form)?;
            Ok::<_, mckibben::Error>([found.decay, found.coulomb_width, found.viscous, found.damping_ratio])
        })?;
        Ok(Decrement { decay, coulomb_width, viscous, damping_ratio, rest: None, fit: None })
    }

    /// The damping ratio (32) of each cycle.
    ///
    /// # Errors
    /// [`RingDownError::Physics`] when an amplitude does not fall.
    pub fn equivalent_ratios(&self) -> Result<Vec<Equivalent>, RingDownError> {
        let swings = self.half_swings();
        let (values, deviations) = self.measured();
        let at = |place: usize| {
            let measured = Measured {
                values: &values[place..place + 4],
                standard_errors: &deviations[place..place + 4],
                degrees_of_freedom: self.degrees_of_freedom,
            };
            let [ratio] = measured.propagate([("equivalent_ratio", "")], |lengths| {
                let swings = half_swings(lengths);
                Cycle { amplitude: swings[0], next: swings[2] }.equivalent_ratio().map(|ratio| [ratio])
            })?;
            Ok(Equivalent { amplitude: swings[place], ratio })
        };
        (0..swings.len() - 2).map(at).collect()
    }

    /// From all turns by least squares, of a `mass` in kg.
    ///
    /// # Errors
    /// [`RingDownError::Fit`] when nothing fits, [`RingDownError::Physics`] for a mass that is not above zero.
    pub fn all_turns(&self, mass: f64) -> Result<Decrement, RingDownError> {
        let swings = self.half_swings();
        let cycles: Vec<Cycle> = swings.windows(3).map(|three| Cycle { amplitude: three[0], next: three[2] }).collect();
        let [decay, width] = match Damping::from_cycles(&cycles, self.period, mass, Form::Exact) {
            Ok(damping) => [damping.decay, damping.coulomb_width],
            Err(error @ mckibben::Error::OutOfRange { .. }) => return Err(error.into()),
            // Noise: as if all were viscous.
            Err(_) => [(swings[swings.len() - 1] / swings[0]).powf(2.0 / (swings.len() - 1) as f64), 0.0],
        };
        let sides = [self.turns[0].length, self.turns[1].length];
        let mut unknowns = vec![
            Unknown::new("decay", "", decay).between(1e-6, f64::INFINITY),
            Unknown::new("coulomb_width", "m", width.clamp(-0.5 * swings[0], 0.5 * swings[0]))
                .between(-swings[0], swings[0]),
            Unknown::new("amplitude", "m", swings[0]),
            Unknown::new("rest", "m", 0.5 * (sides[0] + sides[1])),
        ];
        unknowns.extend(self.curvature());
        let free = &[DECAY, WIDTH, AMPLITUDE, REST, CURVATURE][..unknowns.len()];
        let fit = fit(&Recursion { turns: &self.turns, numbers: [0.0; 5], free }, &unknowns, &Search::default())?;
        let [decay, width] = [0, 1].map(|place| fit.estimates[place].clone());
        let measured = Measured {
            values: &[decay.value, width.value, self.period],
            standard_errors: &[decay.standard_error.unwrap_or(f64::INFINITY), 0.0, self.period_deviation],
            degrees_of_freedom: fit.degrees_of_freedom,
        };
        let [viscous, damping_ratio] = measured.propagate([LABELS[2], LABELS[3]], |numbers| {
            let found = Damping::new(numbers[0], numbers[1], numbers[2], Slope::constant(mass));
            Ok::<_, RingDownError>([found.viscous, found.damping_ratio])
        })?;
        let rest = Some(fit.estimates[3].clone());
        Ok(Decrement { decay, coulomb_width: width, viscous, damping_ratio, rest, fit: Some(fit) })
    }

    /// How far both sides of a swing are moved, over its square, where there are enough reversals.
    fn curvature(&self) -> Option<Unknown> {
        let most = 1.0 / self.half_swings()[0];
        (self.turns.len() >= CURVED).then(|| Unknown::new("curvature", "1/m", 0.0).between(-most, most))
    }

    /// Lengths of the turns and the period, with their standard errors.
    fn measured(&self) -> (Vec<f64>, Vec<f64>) {
        let lengths = self.turns.iter().map(|turn| (turn.length, turn.deviation));
        lengths.chain([(self.period, self.period_deviation)]).unzip()
    }

    /// Standard deviation in m of the turns about the recursion with a β and a Q, what else the
    /// recursion has as it fits best.
    ///
    /// # Errors
    /// [`RingDownError::Fit`] when nothing fits.
    pub fn scatter(&self, decay: f64, coulomb_width: f64) -> Result<f64, RingDownError> {
        let (swings, sides) = (self.half_swings(), [self.turns[0].length, self.turns[1].length]);
        let mut unknowns =
            vec![Unknown::new("amplitude", "m", swings[0]), Unknown::new("rest", "m", 0.5 * (sides[0] + sides[1]))];
        unknowns.extend(self.curvature());
        let free = &[AMPLITUDE, REST, CURVATURE][..unknowns.len()];
        let numbers = [decay, coulomb_width, 0.0, 0.0, 0.0];
        let recursion = Recursion { turns: &self.turns, numbers, free };
        let fit = fit(&recursion, &unknowns, &Search::default())?;
        let squares: f64 =
            fit.residuals.iter().zip(&self.turns).map(|(residual, turn)| (residual * scale(turn)).powi(2)).sum();
        Ok((squares / fit.degrees_of_freedom as f64).sqrt())
    }
}

/// Half of the way from each turn to the next.
fn half_swings(lengths: &[Slope]) -> Vec<Slope> {
    let half = |pair: &[Slope]| (pair[0] - pair[1]).magnitude() * Slope::constant(0.5);
    lengths.windows(2).map(half).collect()
}

/// What a residual of a turn is divided by: only how the turns compare matters.
fn scale(turn: &Turn) -> f64 {
    turn.deviation.max(f64::EPSILON * turn.length.abs())
}

const DECAY: usize = 0;
const WIDTH: usize = 1;
const AMPLITUDE: usize = 2;
const REST: usize = 3;
const CURVATURE: usize = 4;

/// The turns by the exact recursion from one half cycle to the next.
struct Recursion<'a> {
    turns: &'a [Turn],
    /// The five numbers; of those that are free anything.
    numbers: [f64; 5],
    /// Which are free, in the order of the unknowns.
    free: &'a [usize],
}

impl Model for Recursion<'_> {
    fn residuals(&self) -> usize {
        self.turns.len()
    }

    fn evaluate(&self, values: &[f64]) -> Evaluation {
        type D = Dual<f64, 5>;
        let mut numbers = self.numbers.map(<D as Over<f64>>::of);
        for (value, place) in values.iter().zip(self.free) {
            numbers[*place] = D::variable(*value, *place);
        }
        let mut amplitude = numbers[AMPLITUDE];
        let mut evaluation = Evaluation { residuals: Vec::new(), slopes: Vec::new() };
        for turn in self.turns {
            let side = D::constant(if turn.is_peak { 1.0 } else { -1.0 });
            let length = numbers[REST] + side * amplitude + numbers[CURVATURE] * amplitude * amplitude;
            evaluation.residuals.push((length.value - turn.length) / scale(turn));
            evaluation.slopes.extend(self.free.iter().map(|place| length.slope[*place] / scale(turn)));
            amplitude = half_cycle(amplitude, numbers[DECAY], numbers[WIDTH]);
        }
        evaluation
    }
}
