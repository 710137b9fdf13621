//! The mechanisms of a plant, and its actuators on tendons, in balance.
//!
//! ```text
//! τ(q) − Σ Jᵀ F = 0, F(L, P) = T(x, L)        unknown: coordinates q, and lengths L on tendons
//! ```
//!
//! Newton steps are shortened, and the stiffness is shifted until it is positive, so that each goes downhill: to the balance
//! that a plant would creep into from the start. A start that is in balance stays where it is, stable or not.
//!
//! Source: J. Nocedal & S. J. Wright, Numerical Optimization (2006), chapters 3 and 6. Checked by `tests/plant_linear.rs` and
//! `tests/plant_linear_closed_forms.rs`.

use super::frame::{Frame, Instant, Number, Quantity};
use super::matrix;
use crate::error::Error;
use crate::force::Statics;
use crate::mechanism::Mechanism;
use crate::plant::{Plant, dense};
use crate::scalar::Scalar;
use alloc::vec;
use alloc::vec::Vec;

/// Steps, and halvings of one step, after which there is no balance.
const MOST_STEPS: usize = 400;
const MOST_HALVINGS: usize = 60;
/// The largest step of an angle in rad, and of a length as a part of an actuator's longest.
const LARGEST_STEP: (f64, f64) = (0.2, 0.05);
/// The part of the largest step below which one is rounding.
const ROUNDING: f64 = 1e-14;
/// Part of the usual force below which a residual is rounding.
const FORCE_ROUNDING: f64 = 1e-13;
/// Part of its size by which a stiffness is shifted first, and up to which it is no shift.
const SHIFTS: (f64, f64) = (1e-3, 1e-9);

const NO_BALANCE: Error = Error::NoSolution {
    what: "the mechanisms of the plant come to no balance near their start at these pressures",
    remedy: "give positions nearer to a balance, other pressures or another load; an actuator on its shortest length or a \
             stop that is just touched has no linear model",
};

/// Brings the mechanisms of a plant, and the actuators on tendons, into balance at the pressures that there are.
pub(super) fn balance(frame: &mut Frame) -> Result<(), Error> {
    let unknowns = Mechanical::of(frame);
    let count = unknowns.slots.len();
    if count == 0 {
        return Ok(());
    }
    let mut instant = frame.evaluate(&[]);
    let mut residuals = unknowns.residual(&instant);
    let mut shift = 0.0;
    for _ in 0..MOST_STEPS {
        let mut stiffness = vec![0.0; count * count];
        for (column, slot) in unknowns.slots.iter().enumerate() {
            let along = frame.evaluate(&[(Quantity::Slot(*slot), 1.0)]);
            for row in 0..count {
                stiffness[row * count + column] = -unknowns.slope(&along, row);
            }
        }
        let rests =
            residuals.iter().zip(&unknowns.usual).all(|(residuals, usual)| residuals.abs() <= FORCE_ROUNDING * usual);
        let (change, used) = unknowns.step(&stiffness, &residuals, shift);
        let part = change
            .iter()
            .zip(&unknowns.largest)
            .fold(1.0_f64, |part, (change, largest)| part.min(largest / change.abs().max(1e-300)));
        if rests {
            // One step more removes the residual of rounding, if the stiffness is positive definite without a shift.
            if used == 0.0 && part == 1.0 {
                unknowns.shift(frame, &change, 1.0);
            }
            return Ok(());
        }
        let power = |residuals: &[f64]| {
            residuals.iter().zip(&change).map(|(residuals, change)| residuals * change).sum::<f64>()
        };
        let downhill = power(&residuals);
        let before = frame.state.clone();
        let mut part = part;
        let mut accepted = false;
        for _ in 0..MOST_HALVINGS {
            frame.state.clone_from(&before);
            unknowns.shift(frame, &change, part);
            instant = frame.evaluate(&[]);
            let next = unknowns.residual(&instant);
            let is_inside = unknowns.is_inside(frame, &instant);
            if is_inside && next.iter().all(|value| value.is_finite()) && power(&next) >= -0.5 * downhill {
                residuals = next;
                accepted = true;
                break;
            }
            part *= 0.5;
        }
        if !accepted {
            return Err(NO_BALANCE);
        }
        let moved =
            change.iter().zip(&unknowns.largest).fold(0.0_f64, |most, (by, size)| most.max((part * by / size).abs()));
        if used == 0.0 && moved < ROUNDING {
            return Ok(());
        }
        shift = if used > SHIFTS.1 { 0.1 * used } else { 0.0 };
    }
    Err(NO_BALANCE)
}

/// The coordinates and lengths that balance.
struct Mechanical {
    slots: Vec<usize>,
    kinds: Vec<MechanicalKind>,
    /// Usual force along each, and the largest step of each.
    usual: Vec<f64>,
    largest: Vec<f64>,
}

#[derive(Clone, Copy)]
enum MechanicalKind {
    /// A coordinate, by its place among the forces on all.
    Coordinate(usize),
    /// Length of an actuator on a tendon.
    Length(usize),
}

impl Mechanical {
    fn of(frame: &Frame) -> Self {
        let Plant { actuators, mechanisms, places, .. } = &frame.plant;
        let mut these = Self { slots: vec![], kinds: vec![], usual: vec![], largest: vec![] };
        let usual = frame.usual_forces();
        let mut first = 0;
        for (m, mechanism) in mechanisms.iter().enumerate() {
            let here = places.mechanisms[m];
            for k in (0..here.coordinates).filter(|_| mechanism.is_dynamic()) {
                these.slots.push(here.position(k));
                these.kinds.push(MechanicalKind::Coordinate(first + k));
                these.usual.push(usual[m]);
                let longest = places.members[m].iter().map(|i| actuators[*i].actuator.limits().max_length().value);
                let longest = longest.fold(0.0, f64::max);
                these.largest.push(match mechanism {
                    Mechanism::Chain(_) => LARGEST_STEP.0,
                    _ if longest > 0.0 => LARGEST_STEP.1 * longest,
                    _ => 1.0,
                });
            }
            first += here.coordinates;
        }
        for (i, mounted) in actuators.iter().enumerate() {
            if let (Some(slot), Some(_)) = (places.actuators[i].length, &mounted.tendon) {
                these.slots.push(slot);
                these.kinds.push(MechanicalKind::Length(i));
                these.usual.push(usual[mounted.mechanism].max(1.0));
                these.largest.push(LARGEST_STEP.1 * mounted.actuator.limits().max_length().value);
            }
        }
        these
    }

    fn number(&self, instant: &Instant, row: usize) -> Number {
        match self.kinds[row] {
            MechanicalKind::Coordinate(place) => instant.forces[place],
            MechanicalKind::Length(i) => -instant.excess[i].unwrap_or(Scalar::zero()),
        }
    }

    fn residual(&self, instant: &Instant) -> Vec<f64> {
        (0..self.slots.len()).map(|row| self.number(instant, row).value).collect()
    }

    fn slope(&self, instant: &Instant, row: usize) -> f64 {
        self.number(instant, row).slope[0]
    }

    fn shift(&self, frame: &mut Frame, change: &[f64], part: f64) {
        for (slot, change) in self.slots.iter().zip(change) {
            frame.state[*slot] += part * change;
        }
    }

    /// Whether no actuator is as long as its thread.
    fn is_inside(&self, frame: &Frame, instant: &Instant) -> bool {
        frame
            .plant
            .actuators
            .iter()
            .zip(&instant.at.units)
            .all(|(mounted, unit)| unit.length.value < mounted.actuator.law().law.end_length().value)
    }

    /// The step of a stiffness that is shifted, if it must be, until it is positive; and by how much it was.
    fn step(&self, stiffness: &[f64], residuals: &[f64], mut shift: f64) -> (Vec<f64>, f64) {
        let count = residuals.len();
        let size: Vec<f64> =
            (0..count).map(|k| stiffness[k * count + k].abs().max(1e-3 * self.usual[k] / self.largest[k])).collect();
        loop {
            let mut shifted = stiffness.to_vec();
            for k in 0..count {
                shifted[k * count + k] += shift * size[k];
            }
            let mut symmetric: Vec<f64> =
                (0..count * count).map(|n| 0.5 * (shifted[n] + shifted[(n % count) * count + n / count])).collect();
            dense::factor(&mut symmetric, count);
            let is_positive = dense::pivots_exceed(&symmetric, count, |k| 1e-12 * size[k]);
            if is_positive && let Some(change) = matrix::solve(shifted, residuals.to_vec()) {
                return (change, shift);
            }
            if shift > 1e12 {
                return (vec![0.0; count], shift);
            }
            shift = (10.0 * shift).max(SHIFTS.0);
        }
    }
}
