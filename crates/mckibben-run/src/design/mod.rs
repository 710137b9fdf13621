//! `mckibben design`: the values of keys of a scenario with which a number of its run is least or greatest, under constraints on
//! other numbers of the run.
//!
//! ```text
//! point of the unit box ──vary──> values of keys ──evaluate──> numbers with names ──constraint──> cost, excess ──search──> next point
//! ```
//!
//! | module | its idea |
//! |---|---|
//! | [`vary`] | a key and its range: `supply.gauge_pressure=3..7 bar` |
//! | [`constraint`] | a bound on a number: `length.final<=80 mm` |
//! | `evaluate` | a scenario with values of its keys set, run, as numbers with names |
//! | [`search`], `cobyla` | the least of a function under constraints, without derivatives |
//! | [`outcome`] | what was found: values, margins, bounds that were reached |
//! | `chart` | the search as a figure |
//! | `written` | the scenario file with the values set and its comments kept |
//!
//! Every kind of scenario that [`Ready`](crate::run::Ready) runs can be designed. The search is deterministic and its result that
//! of any number of threads. It finds a local optimum: nothing says that there is no better one.
//!
//! Checked by the tests of its modules and by the program's `tests/design.rs`.

mod chart;
mod cobyla;
pub mod constraint;
mod evaluate;
pub mod outcome;
pub mod search;
pub mod vary;
mod written;

use crate::failure::{Failure, Reason};
use crate::progress::Progress;
use crate::quantities::counted;
use crate::sweep::schedule::STACK;
use crate::units::is_difference;
use constraint::Constraint;
use evaluate::{Evaluator, Named};
use mckibben_identify::least_squares::Monitor;
use mckibben_scenario::keys::{Kind, key_for};
use mckibben_scenario::sweep::column_of;
use mckibben_scenario::{Dimension, Document, nearest_few, quantity};
use outcome::{Outcome, Reached};
use rayon::ThreadPoolBuilder;
use search::{Problem, Worth};
use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use vary::Vary;

/// Names that are listed in place of one that no number has.
const NEAREST: usize = 6;
/// Points that are tried for one whose run comes to its end: it gives the names of the numbers.
const TRIED: usize = 16;
/// Keys that may vary: beyond these no search of a few hundred runs finds anything.
pub const MOST_KEYS: usize = 12;

/// Whether a number is made least or greatest.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Goal {
    /// Least.
    Minimize,
    /// Greatest.
    Maximize,
}

/// What is looked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// Keys that are set before the search, with their values as people write them.
    pub settings: Vec<(String, String)>,
    /// The keys that vary, at least one and at most [`MOST_KEYS`].
    pub vary: Vec<Vary>,
    /// Whether the number is made least or greatest.
    pub goal: Goal,
    /// The name of the number, such as `air.used`, also as JSON has it, `air_used_kg`.
    pub objective: String,
    /// The constraints.
    pub constraints: Vec<Constraint>,
    /// Whether runs go on to their periodic orbit or equilibrium, so that there are `settled.` numbers.
    pub settle: bool,
    /// Runs at most, at least one.
    pub evaluations: usize,
}

impl Request {
    /// Replaces names as JSON has them, `energy_gas_work_j`, by those of the numbers: `energy.gas_work`.
    fn take_names_of(&mut self, numbers: &[Named]) {
        let names = [&mut self.objective].into_iter().chain(self.constraints.iter_mut().map(|of| &mut of.name));
        for name in names.filter(|name| !numbers.iter().any(|number| number.name == **name)) {
            let found = numbers.iter().find(|number| column_of(&number.name, &number.unit) == *name);
            if let Some(number) = found {
                name.clone_from(&number.name);
            }
        }
    }
}

/// A search that is ready to be done.
#[derive(Debug)]
pub struct Design {
    document: Document,
    request: Request,
    evaluator: Evaluator,
    /// The unit of the objective in SI.
    unit: String,
    /// The runs that were made to learn the names.
    known: HashMap<Vec<u64>, Result<Vec<f64>, String>>,
}

impl Design {
    /// Checks a request, by a run in the middle of the ranges.
    ///
    /// # Errors
    /// [`Failure::input`] for a key that the scenario has no use for, that holds no number, or whose range leaves its admissible
    /// values or has another unit; for a name that no number of the run has, with the nearest ones; for a constraint in another
    /// unit than its number. [`Failure::stopped`] where no run comes to its end.
    pub fn of(document: &Document, mut request: Request) -> Result<Self, Failure> {
        if request.vary.is_empty() || request.vary.len() > MOST_KEYS {
            let title = format!("{} keys vary, but a search has from 1 to {MOST_KEYS}", request.vary.len());
            return Err(Failure::input(title, "give --vary for the keys that matter most"));
        }
        if request.evaluations == 0 {
            return Err(Failure::input(
                "--evaluations = 0, but a search has at least one run",
                "give for instance 200",
            ));
        }
        for (place, vary) in request.vary.iter().enumerate() {
            check(vary)?;
            if request.vary[..place].iter().any(|other| other.key == vary.key) {
                return Err(Failure::input(format!("`{}` varies twice", vary.key), "keep one --vary of it"));
            }
        }
        let mut document = document.clone();
        for (key, value) in &request.settings {
            document.set_plain_from("--set", key, value)?;
        }
        let mut evaluator = Evaluator::new(&document, &request.vary, request.settle)?;
        let mut known = HashMap::new();
        let mut reason = String::new();
        for place in 0..TRIED.min(request.evaluations) {
            let values = values_at(&request.vary, &search::point(request.vary.len(), place));
            match evaluator.numbers(&values) {
                Ok(numbers) => {
                    request.take_names_of(&numbers);
                    let unit = named(&request, &numbers)?;
                    evaluator.want(request.objective.clone(), &request.constraints);
                    let wanted = evaluator.wanted(&numbers);
                    known.insert(bits(&values), wanted);
                    return Ok(Self { document, request, evaluator, unit, known });
                }
                Err(failure) if place == 0 && failure.reason() == Reason::Input => return Err(failure),
                Err(failure) => reason = first_line(&failure),
            }
            known.insert(bits(&values), Err(reason.clone()));
        }
        let runs = counted(known.len() as u64, "run");
        Err(Failure::stopped(format!("none of the first {runs} within --vary came to its end; the last: {reason}")))
    }

    /// Searches, on all cores, until it is done or the monitor ends it: then the best of what was run is what is found.
    ///
    /// # Errors
    /// [`Failure::input`] where threads cannot be started. That nothing meets the constraints is no failure here:
    /// [`Outcome::verdict`].
    pub fn search(self, monitor: &Monitor) -> Result<Outcome, Failure> {
        let Self { document, request, evaluator, unit, known } = self;
        let sign = match request.goal {
            Goal::Minimize => 1.0,
            Goal::Maximize => -1.0,
        };
        let known = Mutex::new(known);
        let progress = Progress::counted("runs", request.evaluations as u64);
        let done = AtomicU64::new(0);
        let evaluate = |at: &[f64]| {
            let values = values_at(&request.vary, at);
            let key = bits(&values);
            // Two searches may evaluate one point at once: both find the same.
            let before = known.lock().unwrap_or_else(PoisonError::into_inner).get(&key).cloned();
            if !monitor.goes_on() && before.is_none() {
                return None;
            }
            let found = before.unwrap_or_else(|| {
                let found = evaluator.numbers(&values).map_err(|failure| first_line(&failure));
                let found = found.and_then(|numbers| evaluator.wanted(&numbers));
                known.lock().unwrap_or_else(PoisonError::into_inner).insert(key, found.clone());
                found
            });
            progress.at(done.fetch_add(1, Ordering::Relaxed) + 1);
            let numbers = found.ok()?;
            let excess = request.constraints.iter().zip(&numbers[1..]).map(|(of, value)| of.excess(*value)).collect();
            Some(Worth { cost: sign * numbers[0], excess })
        };
        let scales: Vec<f64> = request.constraints.iter().map(|of| of.bound_in_si().abs()).collect();
        let problem = Problem { coordinates: request.vary.len(), scales: &scales, evaluate: &evaluate };
        let pool = ThreadPoolBuilder::new().stack_size(STACK).build();
        let help = "set RAYON_NUM_THREADS to fewer";
        let pool = pool.map_err(|error| Failure::input(format!("threads cannot be started: {error}"), help))?;
        let searched = pool.install(|| search::search(&problem, request.evaluations));
        let known = known.into_inner().unwrap_or_else(PoisonError::into_inner);
        let search::Searched { trials, best, scales, is_converged } = searched;
        let interrupted = monitor.is_stopped();
        // What was not run any more is none of the points; the first, from which the names are known, was run.
        let (mut points, mut of_best) = (Vec::new(), 0);
        for (place, trial) in trials.iter().enumerate() {
            let values = values_at(&request.vary, &trial.at);
            let Some(numbers) = known.get(&bits(&values)).cloned() else { continue };
            if place == best {
                of_best = points.len();
            }
            points.push(Reached { at: trial.at.clone(), violation: trial.violation(&scales), values, numbers });
        }
        let is_converged = is_converged && !interrupted;
        let found = evaluator.document(&points[of_best].values)?;
        let warnings = evaluator.warnings(&found);
        Ok(Outcome {
            document,
            unit,
            points,
            best: of_best,
            scales,
            is_converged,
            interrupted,
            found,
            warnings,
            request,
        })
    }
}

/// Refuses a key that holds no number, another unit, and a range that leaves the admissible values.
fn check(vary: &Vary) -> Result<(), Failure> {
    let path = vary.entry().map_or(vary.key.as_str(), |(list, _)| list);
    // What is no key is refused by the reading of the scenario, which knows what was meant.
    let Some(key) = key_for(path) else { return Ok(()) };
    let whole = matches!(key.kind, Kind::Whole(_));
    if whole || matches!(key.kind, Kind::Choice(_) | Kind::Choices(_) | Kind::Unit(_) | Kind::Name) {
        let what = if whole { "a whole number" } else { "a word" };
        let title = format!("--vary: `{}` takes {what}, which cannot vary continuously", vary.key);
        return Err(Failure::input(title, "compare its values by a sweep, or by one design for each with --set"));
    }
    let is_list = matches!(key.kind, Kind::Quantities(_));
    if is_list != vary.entry().is_some() && (is_list || !matches!(key.kind, Kind::TimeSeries(_))) {
        let (title, help) = if is_list {
            (format!("--vary: `{}` is a list", vary.key), format!("vary one entry of it, as in {}[0]", vary.key))
        } else {
            (format!("--vary: `{path}` is no list"), format!("leave the [..] out: {path}"))
        };
        return Err(Failure::input(title, help));
    }
    let Some(row) = key.parameter() else { return Ok(()) };
    let expected = dimension(row.unit);
    if vary.dimension != expected {
        let title = format!(
            "--vary {vary}: a range of {} is no range of {}, which is {}",
            vary.dimension.noun(),
            vary.key,
            expected.noun()
        );
        let example = if row.unit.is_empty() { "0.2..0.8".to_owned() } else { format!("1..2 {}", row.unit) };
        return Err(Failure::input(title, format!("write it as in {}={example}", vary.key)));
    }
    for (end, value) in vary.ends.into_iter().zip(vary.ends_in_si()) {
        if let Err(error) = row.check(value) {
            // The row of a part of a plant has no name for it.
            let error = error.to_string().replace(row.key, &vary.key);
            let title = format!("--vary {vary}: its end {} cannot be: {error}", vary.text(end));
            return Err(Failure::input(title, format!("let the range of {} stay within what is admissible", vary.key)));
        }
    }
    Ok(())
}

/// Checks the names and the units of the request; the unit of the objective.
fn named(request: &Request, numbers: &[Named]) -> Result<String, Failure> {
    let find = |option: &str, name: &str| {
        let found = numbers.iter().find(|number| number.name == name);
        found.ok_or_else(|| {
            let near = nearest_few(name, numbers.iter().map(|number| number.name.as_str()), NEAREST).join(", ");
            let settled = name.starts_with(evaluate::SETTLED) || name.starts_with("settled_");
            let help = match (settled, request.settle) {
                (true, false) => "give --settle, so that runs go on to their orbit".to_owned(),
                _ => format!(
                    "the nearest: {near}; the names that `mckibben simulate --format json` prints are taken too"
                ),
            };
            Failure::input(format!("{option}: a run of this scenario has no number `{name}`"), help)
        })
    };
    for constraint in &request.constraints {
        let number = find("--subject-to", &constraint.name)?;
        let expected = dimension(&number.unit);
        if constraint.dimension != expected {
            let (found, due) = (constraint.dimension.noun(), expected.noun());
            let title =
                format!("--subject-to {constraint}: `{}` is {due}, but {} is {found}", number.name, constraint.limit());
            let example = if number.unit.is_empty() {
                "a pure number".into()
            } else {
                format!("a bound in {}, or a unit of its kind", number.unit)
            };
            return Err(Failure::input(title, format!("give {example}")));
        }
        let linear = constraint.unit_of_margin();
        if is_difference(&number.name) && linear != constraint.unit {
            let title =
                format!("--subject-to {constraint}: `{}` has an offset zero, but a difference is due", constraint.unit);
            return Err(Failure::input(title, format!("write `{linear}`, whose degrees are as large")));
        }
    }
    let option = match request.goal {
        Goal::Minimize => "--minimize",
        Goal::Maximize => "--maximize",
    };
    find(option, &request.objective).map(|number| number.unit.clone())
}

fn dimension(unit: &str) -> Dimension {
    // The units of the tables are units.
    quantity::parse_unit(unit).map_or(Dimension::NONE, |(dimension, _)| dimension)
}

/// The numbers in the units of their keys at a point of the box.
fn values_at(vary: &[Vary], at: &[f64]) -> Vec<f64> {
    vary.iter().zip(at).map(|(vary, x)| vary.number(*x)).collect()
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// What a failure says, without the place in the file.
fn first_line(failure: &Failure) -> String {
    let sentence = failure.sentence();
    let line = sentence.lines().next().unwrap_or_default();
    line.strip_prefix("error: ").unwrap_or(line).to_owned()
}
