//! The most that one core can multiply and add, measured.

use crate::program;
use std::path::Path;
use std::process::Command;

/// Billions of floating-point operations in a second, a multiply-add being two.
pub struct Peak {
    /// Doubles, at the better width.
    pub double: f64,
    /// Name of each kernel and its rate.
    pub kernels: Vec<(String, f64)>,
}

impl Peak {
    /// Builds and runs the kernels of `peers/peak.cpp`.
    ///
    /// # Errors
    /// When they cannot be built or run.
    pub fn measure(sources: &Path) -> Result<Self, String> {
        let program = program::build(&sources.join("peak.cpp"))?;
        let answer = program::answer(&mut Command::new(program), "")?;
        let table = answer.as_object().ok_or("the peak is not a table")?;
        let kernels: Vec<_> =
            table.iter().map(|(name, rate)| (name.clone(), rate.as_f64().unwrap_or(f64::NAN))).collect();
        let doubles = kernels.iter().filter(|(name, _)| name.starts_with("f64"));
        let double = doubles.map(|(_, rate)| *rate).fold(0.0, f64::max);
        Ok(Self { double, kernels })
    }

    /// Prints the table.
    pub fn print(&self) {
        println!("multiply-add peak of one core, Gflop/s");
        for (name, rate) in &self.kernels {
            println!("{name:<18} {rate:>8.1}");
        }
    }
}
