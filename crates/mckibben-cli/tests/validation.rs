//! The event-located engine against an independent reference: every scenario of `validation/reference`, every column.
//!
//! The reference is `validation/reference.py`, written in Python from the model page without sight of this code. Its
//! runs are computed beforehand into the folder that the environment variable `MCKIBBEN_REFERENCE` names. Without them
//! these tests fail: a validation that is skipped in silence is none.

use mckibben::simulation::{Sample, simulate};
use mckibben_scenario::Document;
use std::path::{Path, PathBuf};

/// What an error may be, as a part of the column's range over the run.
const PART_OF_RANGE: f64 = 1e-6;
/// A column whose range is below this part of its magnitude is constant, and compared relative to its magnitude.
const CONSTANT: f64 = 1e-9;

const COLUMNS: [&str; 8] = [
    "length_m",
    "velocity_m_s",
    "pressure_pa",
    "air_mass_kg",
    "temperature_k",
    "volume_m3",
    "tension_n",
    "mass_flow_kg_s",
];

fn columns(s: &Sample) -> [f64; 8] {
    [s.length, s.velocity, s.pressure.0, s.air_mass, s.temperature, s.volume, s.tension, s.mass_flow]
}

/// The reference run of a scenario.
struct Reference {
    name: String,
    document: Document,
    rows: Vec<(f64, [f64; 8], String)>,
}

fn references() -> Vec<Reference> {
    let folder = std::env::var_os("MCKIBBEN_REFERENCE").unwrap_or_else(|| {
        panic!(
            "MCKIBBEN_REFERENCE does not name the folder with the reference's runs. `cargo xtask test` computes them \
             and sets it; by hand: for each validation/reference/NAME.toml run `python validation/reference.py \
             validation/reference/NAME.toml --output FOLDER/NAME.csv`, then set MCKIBBEN_REFERENCE=FOLDER"
        )
    });
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation/reference");
    let entries = std::fs::read_dir(scenarios).expect("the scenarios of the reference");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("readable").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    paths.sort();
    assert!(paths.len() >= 20, "only {} scenarios", paths.len());
    paths.iter().map(|path| reference(path, Path::new(&folder))).collect()
}

fn reference(path: &Path, folder: &Path) -> Reference {
    let document = Document::load(path).unwrap_or_else(|error| panic!("{error}"));
    let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
    let run = folder.join(format!("{name}.csv"));
    let mut reader = csv::Reader::from_path(&run).unwrap_or_else(|error| {
        panic!(
            "{}: {error}; compute it with `python validation/reference.py {} --output …`",
            run.display(),
            path.display()
        )
    });
    let header: Vec<String> = reader.headers().expect("a header").iter().map(str::to_owned).collect();
    assert_eq!(header[1..9], COLUMNS, "{name}");
    let row = |record: csv::StringRecord| {
        let number = |column: usize| record[column].parse::<f64>().expect("a number");
        (number(0), std::array::from_fn(|column| number(column + 1)), record[9].to_owned())
    };
    let rows = reader.records().map(|record| row(record.expect("a row"))).collect();
    Reference { name, document, rows }
}

impl Reference {
    /// Our run, sampled at the reference's times.
    fn samples(&self, relative_tolerance: f64) -> Vec<Sample> {
        let experiment = self.document.experiment().unwrap_or_else(|error| panic!("{error}"));
        let trajectory = simulate(&experiment.rig, experiment.start, experiment.run.duration, relative_tolerance)
            .unwrap_or_else(|error| panic!("{}: {error}", self.name));
        let samples: Vec<Sample> = trajectory.samples(experiment.run.sample_interval).collect();
        assert_eq!(samples.len(), self.rows.len(), "{}: rows", self.name);
        samples
    }

    /// The magnitude, the range and the greatest error of each column.
    fn errors(&self, samples: &[Sample]) -> [Error; 8] {
        let mut errors = [Error { least: f64::INFINITY, greatest: f64::NEG_INFINITY, worst: 0.0, at: 0.0 }; 8];
        for ((time, expected, _), sample) in self.rows.iter().zip(samples) {
            for ((error, expected), found) in errors.iter_mut().zip(expected).zip(columns(sample)) {
                error.least = error.least.min(*expected);
                error.greatest = error.greatest.max(*expected);
                let gap = (found - expected).abs();
                // A NaN is the worst, and stays it.
                if gap > error.worst || gap.is_nan() {
                    (error.worst, error.at) = (gap, *time);
                }
            }
        }
        errors
    }
}

#[derive(Clone, Copy)]
struct Error {
    least: f64,
    greatest: f64,
    worst: f64,
    at: f64,
}

impl Error {
    fn range(&self) -> f64 {
        self.greatest - self.least
    }

    fn magnitude(&self) -> f64 {
        self.least.abs().max(self.greatest.abs())
    }

    fn is_constant(&self) -> bool {
        self.range() <= CONSTANT * self.magnitude()
    }

    fn is_fine(&self) -> bool {
        let allowed = if self.is_constant() { CONSTANT * self.magnitude() } else { PART_OF_RANGE * self.range() };
        self.worst <= allowed
    }
}

#[test]
fn every_column_of_every_scenario_agrees_with_the_reference() {
    let mut faults = Vec::new();
    for reference in references() {
        let samples = reference.samples(1e-10);
        for ((time, _, valve), sample) in reference.rows.iter().zip(&samples) {
            assert!((time - sample.time).abs() <= 1e-12, "{}: {time} and {}", reference.name, sample.time);
            if sample.ports.name() != valve {
                faults.push(format!("{} at {time} s: valve {} is {valve}", reference.name, sample.ports.name()));
            }
        }
        for (column, error) in COLUMNS.iter().zip(reference.errors(&samples)) {
            if !error.is_fine() {
                faults.push(format!(
                    "{}: {column} is off by {:.1e} at {} s, range {:.3e}, magnitude {:.3e}",
                    reference.name,
                    error.worst,
                    error.at,
                    error.range(),
                    error.magnitude()
                ));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn errors_fall_with_the_tolerance() {
    let references = references();
    let root_mean_square = |tolerance: f64| {
        let worst = |reference: &Reference| {
            let errors = reference.errors(&reference.samples(tolerance));
            errors.iter().filter(|error| !error.is_constant()).map(|e| e.worst / e.range()).fold(0.0, f64::max)
        };
        let squares: f64 = references.iter().map(|reference| worst(reference).powi(2)).sum();
        (squares / references.len() as f64).sqrt()
    };
    let errors = [1e-6, 1e-8, 1e-10].map(root_mean_square);
    println!("root mean square of each scenario's worst error at 1e-6, 1e-8, 1e-10: {errors:?}");
    assert!(errors[1] < errors[0] / 5.0 && errors[2] < errors[1] / 5.0, "{errors:?}");
}
