//! The event-located engine against an independent reference: every scenario of `validation/reference`, every column
//! that `mckibben simulate` writes.
//!
//! The reference is `validation/reference.py`, written in Python from the model page and the book without sight of this
//! code. Its runs are computed beforehand into the folder that the environment variable `MCKIBBEN_REFERENCE` names.
//! Without them these tests fail: a validation that is skipped in silence is none.

use crate::common::{Folder, of_repository};
use std::path::{Path, PathBuf};

/// What an error may be, as a part of the column's range over the run.
const PART_OF_RANGE: f64 = 1e-6;
/// A column whose range is below this part of its magnitude is constant, and compared relative to its magnitude.
const CONSTANT: f64 = 1e-9;

/// A run: the names of its columns, and its rows.
struct Run {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Run {
    fn read(path: &Path) -> Self {
        let mut reader = csv::Reader::from_path(path).unwrap_or_else(|error| {
            panic!("{}: {error}; compute it with `python validation/reference.py FILE --output …`", path.display())
        });
        let header = reader.headers().expect("a header").iter().map(str::to_owned).collect();
        let row = |record: csv::StringRecord| record.iter().map(str::to_owned).collect();
        Self { header, rows: reader.records().map(|record| row(record.expect("a row"))).collect() }
    }

    fn column(&self, name: &str) -> impl Iterator<Item = &str> {
        let index = self.header.iter().position(|other| other == name).expect("a column of both runs");
        self.rows.iter().map(move |row| row[index].as_str())
    }
}

/// A scenario and its reference run.
struct Reference {
    name: String,
    scenario: PathBuf,
    run: Run,
}

fn references() -> Vec<Reference> {
    let folder = std::env::var_os("MCKIBBEN_REFERENCE").unwrap_or_else(|| {
        panic!(
            "MCKIBBEN_REFERENCE does not name the folder with the reference's runs. `cargo xtask test` computes them \
             and sets it; by hand: for each validation/reference/NAME.toml run `python validation/reference.py \
             validation/reference/NAME.toml --output FOLDER/NAME.csv`, then set MCKIBBEN_REFERENCE=FOLDER"
        )
    });
    let entries = std::fs::read_dir(of_repository("validation/reference")).expect("the scenarios of the reference");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("readable").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    paths.sort();
    assert!(paths.len() >= 59, "only {} scenarios", paths.len());
    let reference = |scenario: PathBuf| {
        let name = scenario.file_stem().expect("a name").to_string_lossy().into_owned();
        let run = Run::read(&Path::new(&folder).join(format!("{name}.csv")));
        Reference { name, scenario, run }
    };
    paths.into_iter().map(reference).collect()
}

impl Reference {
    /// Our run, as `mckibben simulate` writes it.
    fn ours(&self, folder: &Folder, relative_tolerance: f64) -> Run {
        let mut program = folder.mckibben();
        program.arg("simulate").arg(&self.scenario).args(["--quiet", "--output", "run.csv", "--set"]);
        let output = program.arg(format!("run.relative_tolerance={relative_tolerance:e}")).output().expect("it runs");
        assert!(output.status.success(), "{}: {}", self.name, String::from_utf8_lossy(&output.stderr));
        let run = Run::read(&folder.path("run.csv"));
        assert_eq!(run.rows.len(), self.run.rows.len(), "{}: rows", self.name);
        run
    }

    /// The columns that hold numbers, without the time.
    fn numbers(&self) -> impl Iterator<Item = &String> {
        self.run.header.iter().filter(|name| *name != "time_s" && !name.ends_with("valve"))
    }

    /// The range and the greatest error of each column of numbers.
    fn errors(&self, ours: &Run) -> Vec<Error> {
        self.numbers().map(|name| Error::of(name, &self.run, ours)).collect()
    }
}

struct Error {
    column: String,
    least: f64,
    greatest: f64,
    worst: f64,
    at: f64,
}

impl Error {
    fn of(column: &str, expected: &Run, ours: &Run) -> Self {
        let mut error =
            Self { column: column.to_owned(), least: f64::INFINITY, greatest: f64::NEG_INFINITY, worst: 0.0, at: 0.0 };
        let number = |text: &str| text.parse::<f64>().unwrap_or_else(|_| panic!("{column}: {text} is no number"));
        for ((time, expected), found) in expected.column("time_s").zip(expected.column(column)).zip(ours.column(column))
        {
            let (expected, found) = (number(expected), number(found));
            error.least = error.least.min(expected);
            error.greatest = error.greatest.max(expected);
            let gap = (found - expected).abs();
            // A NaN is the worst, and stays it.
            if gap > error.worst || gap.is_nan() {
                (error.worst, error.at) = (gap, number(time));
            }
        }
        error
    }

    fn range(&self) -> f64 {
        self.greatest - self.least
    }

    /// What small errors are measured by; of a gauge pressure, which may be zero, that of the absolute one.
    fn magnitude(&self) -> f64 {
        let gauge = if self.column.ends_with("gauge_pressure_pa") { 101_325.0 } else { 0.0 };
        gauge + self.least.abs().max(self.greatest.abs())
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
    let folder = Folder::new("validation");
    let mut faults = Vec::new();
    for reference in references() {
        let ours = reference.ours(&folder, 1e-10);
        let sorted = |run: &Run| {
            let mut names = run.header.clone();
            names.sort();
            names
        };
        assert_eq!(sorted(&reference.run), sorted(&ours), "{}: columns", reference.name);
        for (row, other) in reference.run.rows.iter().zip(&ours.rows) {
            let (time, other) = (row[0].parse::<f64>().expect("a time"), other[0].parse::<f64>().expect("a time"));
            assert!((time - other).abs() <= 1e-12, "{}: {time} and {other}", reference.name);
        }
        for name in reference.run.header.iter().filter(|name| name.ends_with("valve")) {
            for ((row, valve), found) in
                reference.run.rows.iter().zip(reference.run.column(name)).zip(ours.column(name))
            {
                if valve != found {
                    faults.push(format!("{} at {} s: {name} {found} is {valve}", reference.name, row[0]));
                }
            }
        }
        for error in reference.errors(&ours).iter().filter(|error| !error.is_fine()) {
            faults.push(format!(
                "{}: {} is off by {:.1e} at {} s, range {:.3e}, magnitude {:.3e}",
                reference.name,
                error.column,
                error.worst,
                error.at,
                error.range(),
                error.magnitude()
            ));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn errors_fall_with_the_tolerance() {
    let folder = Folder::new("validation-tolerance");
    let references = references();
    let root_mean_square = |tolerance: f64| {
        let worst = |reference: &Reference| {
            let errors = reference.errors(&reference.ours(&folder, tolerance));
            errors.iter().filter(|error| !error.is_constant()).map(|e| e.worst / e.range()).fold(0.0, f64::max)
        };
        let squares: f64 = references.iter().map(|reference| worst(reference).powi(2)).sum();
        (squares / references.len() as f64).sqrt()
    };
    let errors = [1e-6, 1e-8, 1e-10].map(root_mean_square);
    println!("root mean square of each scenario's worst error at 1e-6, 1e-8, 1e-10: {errors:?}");
    assert!(errors[1] < errors[0] / 5.0 && errors[2] < errors[1] / 5.0, "{errors:?}");
}
