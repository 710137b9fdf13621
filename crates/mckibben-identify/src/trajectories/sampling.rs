//! Quantities of a run at given times, with their exact derivatives with respect to parameters of its scenario.
//!
//! ```text
//! y_q(t_k; θ)        ∂y_q(t_k; θ)/∂θ_p        forward, through every stick, slip and switching of the valve
//! ```
//!
//! A derivative holds between events; where an event is on the point of coming or going there is none, and it is that of
//! the side on which the run lies.

use super::simulated::{Ready, Watch};
use super::{Observed, Simulated, SimulatedReader, Subject, SubjectError};
use mckibben::Error;
use mckibben::Instantiate;
use rayon::prelude::*;

/// What a run is sampled for: quantities, the times in s, and the relative tolerance of each step.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampling {
    /// The quantities; all that the scenario's kind of load, or the plant, has.
    pub observed: Vec<Observed>,
    /// The times in s, zero or above.
    pub times: Vec<f64>,
    /// The relative tolerance of each step.
    pub tolerance: f64,
}

impl Sampling {
    /// The quantities at each time in turn, with the numbers of a scenario at `values`, in the order of its places. `watch` is
    /// called now and then with the time that has been reached.
    ///
    /// # Errors
    /// When the scenario cannot be so, or its run cannot go on, and those of `watch`.
    pub fn values(&self, of: &Subject, values: &[f64], watch: &Watch<'_>) -> Result<Vec<f64>, SubjectError> {
        Ok(self.read(&self.run(&of.built(values)?.ready()?, watch)?).collect())
    }

    /// The quantities and their derivatives with respect to the parameters, `[time][quantity][number]` in one row.
    ///
    /// # Errors
    /// As [`Sampling::values`], and [`SwitchedOff`](crate::adjustable::SwitchedOff) in words for a value at which a part is not there,
    /// so that there is no derivative by it.
    pub fn value_and_jacobian(
        &self,
        of: &Subject,
        values: &[f64],
        watch: &Watch<'_>,
    ) -> Result<(Vec<f64>, Vec<f64>), SubjectError> {
        let width = of.width();
        if width == 0 {
            return Ok((self.values(of, values, watch)?, Vec::new()));
        }
        let built = of.built(values)?;
        of.check_derivatives(values).map_err(|off| SubjectError::File(off.to_string()))?;
        let passes: Vec<usize> = of.passes().collect();
        let pass = |first: &usize| Ok(self.read(&self.run(&built.seeded(of, *first)?, watch)?).collect::<Vec<_>>());
        let duals = passes.par_iter().map(pass).collect::<Result<Vec<_>, SubjectError>>()?;
        let read: Vec<f64> = duals[0].iter().map(|dual| dual.value).collect();
        let mut slopes = vec![0.0; read.len() * width];
        for (first, duals) in passes.iter().zip(&duals) {
            for (dual, row) in duals.iter().zip(slopes.chunks_exact_mut(width)) {
                of.spread(*first, &dual.slope, row);
            }
        }
        Ok((read, slopes))
    }

    fn run<R: Instantiate>(&self, plant: &Ready<R>, watch: &Watch<'_>) -> Result<Simulated<R>, Error> {
        let last = self.times.iter().copied().fold(1e-9, f64::max);
        plant.simulate(R::constant(last), self.tolerance, watch)
    }

    fn read<'r, R: Instantiate>(&'r self, run: &'r Simulated<R>) -> impl Iterator<Item = R> + 'r {
        let (mut reading, width) = (SimulatedReader::new(run), self.observed.len());
        (0..width * self.times.len())
            .map(move |place| reading.read(&self.observed[place % width], R::constant(self.times[place / width])))
    }
}
