//! How far off the model is in a run that it has not seen: each run in turn is left out of the fit. A number that only this run
//! has cannot come from the others: it is found from the run itself, with all others held.

use super::{Identified, Observed, Recorded, Runs, Simulated, Task};
use crate::least_squares::{self, Loss, Search, Unknown};

/// The errors of one run, in it and out of it.
#[derive(Clone, Debug)]
pub struct HeldOutRun {
    /// The run that was left out.
    pub name: String,
    /// The run as the others predict it.
    pub simulated: Simulated,
    /// Values of all unknowns by which they predict it.
    pub values: Vec<f64>,
    /// Root mean square residual of each quantity, in its SI unit: with the run in the fit, and without.
    pub errors: Vec<(Observed, [f64; 2])>,
}

impl Task {
    /// The errors of each run when the parameters are estimated from the others alone, from the values estimated from
    /// all. Empty for a single run, for runs in segments, which cannot be predicted, and once the monitor has ended the
    /// search; a run without which the numbers are not found is left out.
    pub fn held_out(&self, found: &Identified) -> Vec<HeldOutRun> {
        if self.runs.len() < 2 || found.segments.is_some() || self.search.monitor.is_stopped() {
            return Vec::new();
        }
        let scales = || found.scales.clone();
        let values = found.found.fit.values();
        let from = least_squares::starting_at(&self.unknowns, &values);
        let few = Search { most_steps: self.search.most_steps.min(50), any_end: true, ..self.search.clone() };
        // The unknowns that count, estimated from these runs from these values on.
        let fit_runs = |runs: &[Recorded], of: &[usize], values: &mut [f64]| {
            let runs: Vec<Recorded> = runs.iter().map(|run| run.only(of, values)).collect::<Result<_, _>>().ok()?;
            let from: Vec<Unknown> = of.iter().map(|unknown| from[*unknown].clone()).collect();
            let fit =
                least_squares::fit(&Runs::whole(&runs, scales(), self.tolerance, &self.search.monitor), &from, &few)
                    .ok()?;
            for (unknown, value) in of.iter().zip(fit.values()) {
                values[*unknown] = value;
            }
            // What they do not identify cannot be predicted, nor can what was not searched to the end.
            (fit.unidentifiable.is_empty() && !fit.ending.is_early()).then_some(())
        };
        let without = |place: usize| {
            let others = [&self.runs[..place], &self.runs[place + 1..]].concat();
            let of_others = |unknown: &usize| others.iter().any(|run| run.all_unknowns().contains(unknown));
            let (common, own): (Vec<usize>, Vec<usize>) = (0..values.len()).partition(of_others);
            let mut predicted = values.clone();
            fit_runs(&others, &common, &mut predicted)?;
            let this = std::slice::from_ref(&self.runs[place]);
            if !own.is_empty() {
                fit_runs(this, &own, &mut predicted)?;
            }
            let alone = Runs::whole(this, scales(), self.tolerance, &self.search.monitor);
            let error = |values: &[f64]| alone.scatter(&alone.tried(&self.runs[place], values), Loss::Squares);
            let (inside, outside) = (error(&values), error(&predicted));
            let errors = inside.into_iter().zip(outside).map(|((of, inside), (_, outside))| {
                let scale = alone.scale(&of);
                (of, [inside * scale, outside * scale])
            });
            let simulated = self.runs[place].simulated(&predicted, self.tolerance).ok()?;
            Some(HeldOutRun {
                name: self.runs[place].name.clone(),
                errors: errors.collect(),
                simulated,
                values: predicted,
            })
        };
        (0..self.runs.len()).filter_map(without).collect()
    }
}
