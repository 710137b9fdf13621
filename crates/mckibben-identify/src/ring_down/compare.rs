//! A comparison of the estimators of a ring-down.

use super::record::Record;
use super::turns::Turns;
use super::waveform::{Free, Restoring, Waveform};
use super::{Decrement, Equivalent, RingDownError};
use crate::least_squares::Estimate;
use mckibben::ring_down::Form;
use mckibben::simulation::{Initial, InitialLength, Rig};

/// Part of a period before the first turn from which on the mass must have been held.
const MOST_BEFORE: f64 = 0.6;

/// How friction was estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Estimator {
    /// The first and the last cycle by the paper's (25)–(31).
    PaperTwoCycles,
    /// The first and the last cycle by the exact recursion.
    ExactTwoCycles,
    /// All turns by least squares.
    AllTurns,
    /// Both frictions as one, cycle by cycle, (32): it gives no Q and c, and so has no row.
    Equivalent,
    /// All samples by least squares.
    Waveform,
}

/// What one estimator says.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Which it is.
    pub estimator: Estimator,
    /// Q in m of an equal linear spring.
    pub coulomb_width: Estimate,
    /// Q of (12) in m, where the actuator is known.
    pub law_width: Option<Estimate>,
    /// c in N·s/m.
    pub viscous: Estimate,
    /// ζ of the viscous part.
    pub damping_ratio: Estimate,
    /// Standard deviation in m about what the estimator says: of the turns about the exact recursion, or of the samples about the
    /// trajectory for the waveform. `None` when there is no such recursion.
    pub scatter: Option<f64>,
}

/// All estimators of one ring-down.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The turns that were found.
    pub turns: Turns,
    /// (32) for each cycle.
    pub equivalent: Vec<Equivalent>,
    /// One for each estimator that found Q and c.
    pub rows: Vec<Row>,
    /// Those that gave none, and why.
    pub refused: Vec<(Estimator, RingDownError)>,
    /// The fit of the waveform, where the actuator is known.
    pub waveform: Option<Waveform>,
}

/// Applies every estimator to a record of a `mass` in kg: the waveform's where the sealed rig is known, with its state at the first
/// sample and what is unknown of that.
///
/// # Errors
/// Those of [`Turns::find`]; [`RingDownError::Mass`] for a rig with another mass, [`RingDownError::Physics`] for a start outside the
/// physics. A single estimator that fails is among the refused.
pub fn compare(record: &Record, mass: f64, rig: Option<(&Rig, &Initial, Free)>) -> Result<Comparison, RingDownError> {
    let turns = Turns::find(record)?;
    let restoring = match rig {
        Some((rig, start, _)) => {
            if let Some(hung) = rig.load().inertia().map(|inertia| inertia.mass)
                && hung != mass
            {
                return Err(RingDownError::Mass { given: mass, hung });
            }
            let start = Initial { length: InitialLength::At(record.length()[0]), ..*start };
            Some(Restoring::at_rest(rig, &start)?)
        }
        None => None,
    };
    let mut comparison =
        Comparison { turns, equivalent: Vec::new(), rows: Vec::new(), refused: Vec::new(), waveform: None };
    match comparison.turns.equivalent_ratios() {
        Ok(ratios) => comparison.equivalent = ratios,
        Err(error) => comparison.refused.push((Estimator::Equivalent, error)),
    }
    let turns = &comparison.turns;
    let all = turns.all_turns(mass);
    for (estimator, found) in [
        (Estimator::PaperTwoCycles, turns.two_cycles(mass, Form::Paper)),
        (Estimator::ExactTwoCycles, turns.two_cycles(mass, Form::Exact)),
        (Estimator::AllTurns, all.clone()),
    ] {
        match found {
            Ok(found) => {
                let scatter = turns.scatter(found.decay.value, found.coulomb_width.value).ok();
                comparison.rows.push(row(estimator, found, restoring, scatter));
            }
            Err(error) => comparison.refused.push((estimator, error)),
        }
    }
    let Some((rig, start, free)) = rig else { return Ok(comparison) };
    // Between the release and the first turn there is half a period at most.
    let (time, swing) = (record.time()[0], MOST_BEFORE * turns.period);
    let waveform = match turns.turns[0].time - time > swing {
        true => Err(RingDownError::Held { time }),
        false => Waveform::fit(record, rig, start, free, all.as_ref().ok()),
    };
    match waveform {
        Ok(waveform) => {
            comparison.rows.push(Row {
                estimator: Estimator::Waveform,
                coulomb_width: waveform.shown_width.clone(),
                law_width: Some(waveform.coulomb_width.clone()),
                viscous: waveform.viscous.clone(),
                damping_ratio: waveform.damping_ratio.clone(),
                scatter: Some(waveform.scatter),
            });
            comparison.waveform = Some(waveform);
        }
        Err(error) => comparison.refused.push((Estimator::Waveform, error)),
    }
    Ok(comparison)
}

fn row(estimator: Estimator, found: Decrement, restoring: Option<Restoring>, scatter: Option<f64>) -> Row {
    Row {
        law_width: restoring.map(|springs| springs.law_width(&found.coulomb_width)),
        coulomb_width: found.coulomb_width,
        viscous: found.viscous,
        damping_ratio: found.damping_ratio,
        estimator,
        scatter,
    }
}
