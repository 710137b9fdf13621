//! From the standard errors of measured numbers to the interval of what follows from them, to first order, by exact derivatives.

use crate::least_squares::Estimate;
use mckibben::Dual;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// A number that carries its derivative with respect to one measured number.
pub(crate) type Slope = Dual<f64, 1>;

/// Numbers that are independent of each other, each with its standard deviation.
pub(crate) struct Measured<'a> {
    pub(crate) values: &'a [f64],
    pub(crate) standard_errors: &'a [f64],
    /// Degrees of freedom of the standard errors: samples less unknowns.
    pub(crate) degrees_of_freedom: usize,
}

/// What an estimate is of, and its unit.
pub(crate) type Label = (&'static str, &'static str);

impl Measured<'_> {
    /// Values of functions of the measured numbers, with intervals.
    pub(crate) fn propagate<const M: usize, E>(
        &self,
        labels: [Label; M],
        functions: impl Fn(&[Slope]) -> Result<[Slope; M], E>,
    ) -> Result<[Estimate; M], E> {
        let constants: Vec<Slope> = self.values.iter().map(|value| Dual { value: *value, slope: [0.0] }).collect();
        let values = functions(&constants)?.map(|function| function.value);
        let mut variances = [0.0; M];
        for (place, standard_error) in self.standard_errors.iter().enumerate() {
            let mut seeded = constants.clone();
            seeded[place] = Dual::variable(self.values[place], 0);
            for (variance, function) in variances.iter_mut().zip(functions(&seeded)?) {
                *variance += (function.slope[0] * standard_error) * (function.slope[0] * standard_error);
            }
        }
        Ok(std::array::from_fn(|place| {
            estimate(labels[place], values[place], variances[place].sqrt(), self.degrees_of_freedom)
        }))
    }
}

/// An estimate with the 95 % interval of Student's distribution.
pub(crate) fn estimate((name, unit): Label, value: f64, standard_error: f64, degrees_of_freedom: usize) -> Estimate {
    let half = quantile(degrees_of_freedom) * standard_error;
    let is_determined = half.is_finite();
    Estimate {
        name: name.to_owned(),
        unit,
        value,
        standard_error: is_determined.then_some(standard_error),
        confidence_interval: is_determined.then_some([value - half, value + half]),
        on_bound: false,
        bound: None,
    }
}

/// Mean of numbers with the interval that their scatter gives; none for fewer than two.
pub(crate) fn mean(label: Label, numbers: &[f64]) -> Estimate {
    let count = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / count;
    let squares: f64 = numbers.iter().map(|number| (number - mean) * (number - mean)).sum();
    let standard_error = (squares / (count - 1.0) / count).sqrt();
    estimate(label, mean, standard_error, numbers.len().saturating_sub(1))
}

/// How many standard deviations reach to the end of a two-sided 95 % interval; infinite for no degrees of freedom.
pub(crate) fn quantile(degrees_of_freedom: usize) -> f64 {
    StudentsT::new(0.0, 1.0, degrees_of_freedom as f64).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975))
}
