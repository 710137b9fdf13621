//! From measured data to a scenario file that runs, with how sure its numbers are.
//!
//! | file | its idea |
//! |---|---|
//! | `force_map` | laws of static force from tensions at held pressures and lengths |
//! | `trajectories` | any parameters of a scenario from time series |
//! | `plant` | the runs of trajectories of a plant, whose parts have names |
//! | `loops` | friction and hysteresis from tension over length to and fro |
//! | `rings` | friction from ring-downs, by every estimator |
//! | `valve` | a valve from steady flow, a tank, or the pressure under a pulse train |
//! | `units` | readings that the scenario cannot have, refused, and those that are far from what it has |
//! | `saturation` | readings at an end of a sensor's range that no column states |
//! | `unknowns` | the unknowns of a study |
//! | `values` | numbers with their intervals, as tables |
//! | `responses` | overshoot, first peak, frequency and settling of step-like runs |
//! | `minima` | the other minima that searches from several starts led to |
//! | `prediction` | measurements compared with what the fitted model predicts |
//! | `outcome` | what every kind of study comes to, and the files that are written of it |
//!
//! Everything is computed by the crate `mckibben-identify`. Checked by the tests of the program, `tests/identify.rs` and
//! `tests/identify_valve.rs`.

mod force_map;
mod loops;
mod minima;
mod outcome;
mod plant;
mod prediction;
mod responses;
mod rings;
mod saturation;
mod sensors;
mod trajectories;
mod units;
mod unknowns;
mod values;
mod valve;

use crate::failure::{Failure, Reason};
pub use mckibben_identify::least_squares::Monitor;
use mckibben_identify::least_squares::{Loss, Search};
use mckibben_identify::study::{Column, ColumnEntry, Kind, Quantity, Recording, Severity, Study, StudyError, Table};
use mckibben_scenario::Document;
pub use minima::OtherMinimum;
pub use outcome::{Outcome, WARNED};
pub use prediction::Prediction;
pub use responses::StepResponse;
use std::path::Path;
use std::time::Duration;

/// What a study is made of, read.
struct Material {
    study: Study,
    /// The scenario file.
    document: Document,
    recordings: Vec<Recording>,
    monitor: Monitor,
}

/// A study with its scenario, to be fitted.
#[derive(Debug)]
pub struct Request {
    study: Study,
    document: Document,
    monitor: Monitor,
}

impl Request {
    /// Reads a study file and its scenario file.
    ///
    /// # Errors
    /// [`Failure::input`] where a file cannot be read, or says what cannot be.
    pub fn load(study: &Path) -> Result<Self, Failure> {
        let study = Study::load(study).map_err(mistake)?;
        let document = Document::load(&study.scenario)?;
        Ok(Self { study, document, monitor: Monitor::default() })
    }

    /// A study whose tables are in memory: TOML as [`Study::in_memory`] takes it, with the scenario. The key `study.scenario`
    /// names it in results.
    ///
    /// # Errors
    /// [`Failure::input`] where the text is no study.
    pub fn in_memory(text: &str, tables: Vec<Table>, document: Document) -> Result<Self, Failure> {
        // The lines of the text are not those of anything that the caller wrote.
        let of_memory = |error| mistake(StudyError { line: None, ..error });
        let study = Study::in_memory(text, "the study", tables).map_err(of_memory)?;
        Ok(Self { study, document, monitor: Monitor::default() })
    }

    /// Whether its search has a result whenever its monitor ends it.
    pub fn ends_at_any_time(&self) -> bool {
        self.study.kind.has_search()
    }

    /// Ends the search from another thread.
    pub fn followed_by(self, monitor: Monitor) -> Self {
        Self { monitor, ..self }
    }
}

/// Fits the unknowns of a study. Where that fails, the outcome has what there is, and [`Outcome::verdict`] says so;
/// `folder` is where it is to be written, if it is. Where the monitor of the request ends the search, the outcome has
/// the best values so far.
///
/// # Errors
/// The input is wrong; also where the folder is one in which a file that is read would be written over.
pub fn identified(request: Request, folder: Option<&Path>) -> Result<Outcome, Failure> {
    let Request { study, document, monitor } = request;
    folder.map_or(Ok(()), |folder| outcome::check_folder(&study, folder))?;
    match study.kind {
        Kind::Trajectories if document.is_plant() => document.plant_experiment().map(|_| ())?,
        _ => document.scenario().map(|_| ())?,
    }
    let recordings = study.recordings().map_err(mistake)?;
    if let Some(limit) = study.search.time_limit.and_then(|limit| Duration::try_from_secs_f64(limit).ok()) {
        monitor.stop_after(limit);
    }
    let material = Material { study, document, recordings, monitor };
    saturation::check(&material)?;
    units::check(&material)?;
    let found = match material.study.kind {
        Kind::ForceMap => force_map::outcome(&material),
        Kind::Trajectories => trajectories::outcome(&material),
        Kind::Hysteresis => loops::outcome(&material).and_then(|found| {
            let warnings = found.warnings.iter().cloned().chain(unknowns::moved_starts(&material)?).collect();
            Ok(Outcome { warnings, ..found })
        }),
        Kind::RingDown => rings::outcome(&material),
        Kind::FlowCurve => valve::flow_curve(&material),
        Kind::SteadyFlow => valve::steady_flow(&material),
        Kind::Tank => valve::tank(&material),
        Kind::PulseTrain => valve::pulse_train(&material),
    };
    match found {
        Err(failure) if failure.reason() == Reason::Stopped => Ok(Outcome::nothing(&material, failure)),
        Ok(found) => {
            let interrupted = material.study.kind.has_search() && material.monitor.is_stopped();
            Ok(Outcome { interrupted, ..found }.without_refused())
        }
        Err(failure) => Err(units::doubts(&material).iter().fold(failure, |failure, doubt| {
            failure.advised(doubt.trim_start_matches(outcome::WARNED).trim_end_matches('.'))
        })),
    }
}

fn mistake(error: StudyError) -> Failure {
    let place = error.line.map_or(String::new(), |line| format!(", line {line}"));
    Failure::input(format!("{}{place}: {}", error.file.display(), error.what), error.remedy)
}

impl Material {
    /// The name of the scenario file, without its folder.
    fn name(&self) -> &str {
        let path = self.document.source().name();
        Path::new(path).file_name().and_then(|name| name.to_str()).unwrap_or(path)
    }

    /// The scenario of a run: the file's, with what the run changes.
    fn document_of(&self, recording: &Recording) -> Result<Document, Failure> {
        let mut document = self.document.clone();
        for (key, value) in &recording.set {
            let name = format!("run `{}`", recording.name);
            match self.study.numbers_are_si {
                true => document.set_in_si(&name, key, value)?,
                false => document.set_text_from(&name, key, value)?,
            }
        }
        Ok(document)
    }

    /// How the minimum is looked for, where residuals are in units of the scatter that is expected.
    fn search(&self) -> Search {
        Search {
            loss: self.study.search.robust.map_or(Loss::Squares, Loss::Huber),
            most_steps: self.study.search.most_steps.unwrap_or(Search::default().most_steps),
            monitor: self.monitor.clone(),
            ..Search::default()
        }
    }

    /// That an interruption or the limit of time has ended the search before it was done, if so.
    fn stopped(&self) -> Option<String> {
        Some(format!("{}{}", outcome::WARNED, values::early(self.monitor.ending()?)))
    }

    /// What was found in the data, the graver first: before all else readings that are far from what the scenario can have.
    fn notes(&self) -> Vec<String> {
        let mut notes: Vec<_> = self.recordings.iter().flat_map(|recording| &recording.notes).collect();
        notes.sort_by_key(|note| std::cmp::Reverse(note.severity));
        let mark = |severity| if severity == Severity::Warned { outcome::WARNED } else { "" };
        let notes = notes.into_iter().map(|note| format!("{}{note}", mark(note.severity)));
        units::doubts(self).into_iter().chain(saturation::warnings(self)).chain(self.not_read()).chain(notes).collect()
    }

    /// That a study of this kind does not read some of its columns. Trajectories refuse them.
    fn not_read(&self) -> Option<String> {
        let kind = self.study.kind;
        let is_unread = |entry: &&ColumnEntry| kind != Kind::Trajectories && !reads(kind, entry.quantity);
        let unread: Vec<String> = self.study.columns.iter().filter(is_unread).map(ColumnEntry::words).collect();
        let [are, them] = if unread.len() == 1 { ["is", "it"] } else { ["are", "them"] };
        let words = || {
            let (names, kind) = (unread.join(", the "), kind.name());
            format!("the {names} {are} not used: a study of the kind \"{kind}\" does not read {them}.")
        };
        (!unread.is_empty()).then(words)
    }
}

/// Whether a study of a kind but trajectories reads a quantity. Times may stand in any table.
fn reads(kind: Kind, of: Quantity) -> bool {
    use Quantity as Q;
    let in_muscle = matches!(of, Q::GaugePressure | Q::AbsolutePressure);
    let is_steady = matches!(
        of,
        Q::UpstreamGaugePressure
            | Q::UpstreamAbsolutePressure
            | Q::DownstreamGaugePressure
            | Q::DownstreamAbsolutePressure
            | Q::Temperature
            | Q::MassFlow
            | Q::VolumeFlow
    );
    of == Q::Time
        || match kind {
            Kind::ForceMap | Kind::Hysteresis => in_muscle || matches!(of, Q::Length | Q::Tension),
            Kind::RingDown => in_muscle || of == Q::Length,
            Kind::FlowCurve | Kind::SteadyFlow => is_steady,
            Kind::Tank => in_muscle,
            Kind::PulseTrain => in_muscle || of == Q::Command,
            Kind::Trajectories => true,
        }
}

/// A failure by a sentence that ends with what to do, behind its last semicolon or as its last sentence; `otherwise` is what to do where
/// it does not say so.
fn remedied(sentence: &str, otherwise: &str) -> Failure {
    let parts = [sentence.rsplit_once("; "), sentence.rsplit_once(". ")];
    match parts.into_iter().flatten().min_by_key(|(_, remedy)| remedy.len()) {
        Some((what, remedy)) => {
            let mut letters = remedy.chars();
            let first = letters.next().map(char::to_lowercase);
            Failure::input(what, first.into_iter().flatten().chain(letters).collect::<String>())
        }
        None => Failure::input(sentence, otherwise),
    }
}

/// A column that a study of this kind cannot do without.
fn column(recording: &Recording, quantity: Quantity) -> Result<&Column, Failure> {
    recording.column(quantity).ok_or_else(|| {
        let title = format!("the run `{}` has no {}", recording.name, quantity.words());
        Failure::input(title, format!("add `[columns.{}]`, or say what was held: `held = {{ … }}`", quantity.name()))
    })
}

/// The pressure that a recording has over time, gauge or absolute, with its times in s and values in Pa.
fn pressure_over_time(recording: &Recording) -> Result<(Quantity, Vec<f64>, Vec<f64>), Failure> {
    pressure_of(recording, [Quantity::GaugePressure, Quantity::AbsolutePressure])
}

/// The gauge or the absolute pressure of one actuator or port over time, with its times in s and values in Pa.
fn pressure_of(
    recording: &Recording,
    [gauge, absolute]: [Quantity; 2],
) -> Result<(Quantity, Vec<f64>, Vec<f64>), Failure> {
    // Says what is missing.
    let measured = match recording.column(absolute) {
        Some(_) if recording.column(gauge).is_none() => absolute,
        _ => column(recording, gauge)?.quantity,
    };
    match recording.channel(measured) {
        Some((times, values)) => Ok((measured, times, values)),
        None => Err(without_times(recording, measured.words())),
    }
}

/// That a recording has a quantity, in words, whose table has no times.
fn without_times(recording: &Recording, quantity: &str) -> Failure {
    let title = format!("the run `{}` has no {quantity} over time", recording.name);
    Failure::input(title, "add `[columns.time]`, in the same table")
}

/// The gauge pressures of a recording in Pa, from whichever pressure was measured.
fn gauge_pressures(recording: &Recording, atmosphere: f64) -> Result<Vec<f64>, Failure> {
    match recording.column(Quantity::AbsolutePressure) {
        Some(absolute) => Ok(absolute.values.iter().map(|pressure| pressure - atmosphere).collect()),
        None => column(recording, Quantity::GaugePressure).map(|gauge| gauge.values.clone()),
    }
}
