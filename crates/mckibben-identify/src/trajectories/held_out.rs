//! How far off the model is in a run that it has not seen: each run in turn is left out of the fit.

use super::{Identified, Observed, Recorded, Runs, Task};
use crate::least_squares::{self, Search};

/// The errors of one run, in it and out of it.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldOutRun {
    /// The run that was left out.
    pub name: String,
    /// Root mean square of what is left of each quantity, in its SI unit: with the run in the fit, and without.
    pub errors: Vec<(Observed, [f64; 2])>,
}

impl Task {
    /// The errors of each run when the others alone tell the numbers, from the values that all of them told. Empty for a
    /// single run, and for runs in segments, which cannot be foretold; a run without which the numbers are not found is left
    /// out.
    pub fn held_out(&self, found: &Identified) -> Vec<HeldOutRun> {
        if self.runs.len() < 2 || found.segments.is_some() {
            return Vec::new();
        }
        let mut scales = [1.0; 3];
        for (observed, scale) in &found.scales {
            scales[*observed as usize] = *scale;
        }
        let values = found.found.fit.values();
        let from = least_squares::starting_at(&self.unknowns, &values);
        let few = Search { most_steps: 50, ..self.search };
        let without = |place: usize| {
            let of = |runs| Runs::whole(runs, scales, self.tolerance);
            let others: Vec<Recorded> =
                self.runs.iter().enumerate().filter(|(other, _)| *other != place).map(|(_, run)| run.clone()).collect();
            let fit = least_squares::fit(&of(&others), &from, &few).ok()?;
            // What the others do not tell cannot be foretold.
            if !fit.untold.is_empty() {
                return None;
            }
            let alone = of(std::slice::from_ref(&self.runs[place]));
            let error = |values: &[f64]| alone.scatter(&alone.tried(&self.runs[place], values));
            let (inside, outside) = (error(&values), error(&fit.values()));
            let errors = Observed::ALL.into_iter().filter_map(|of| {
                let scale = scales[of as usize];
                Some((of, [inside[of as usize]? * scale, outside[of as usize]? * scale]))
            });
            Some(HeldOutRun { name: self.runs[place].name.clone(), errors: errors.collect() })
        };
        (0..self.runs.len()).filter_map(without).collect()
    }
}
