//! What a study comes to: words for the terminal, a page, a scenario file, and the numbers.

use super::minima::OtherMinimum;
use super::prediction::Prediction;
use super::responses::StepResponse;
use super::{Material, force_map, loops, rings, trajectories, valve};
use crate::failure::Failure;
use crate::output;
use crate::report::{Data, PAGE, Plate, Report, Section, Table};
use mckibben_identify::least_squares::Estimate;
use mckibben_identify::study::{Kind, Quantity, Recording, Sheet, Study, as_file_name};
use mckibben_plot::{Axis, Figure, Legend, Panel, Series};
use mckibben_scenario::{Document, Scenario};
use std::path::{Path, PathBuf};

/// Names of the figures of six runs; a page has no more.
pub(super) type Stems = [&'static str; 6];

/// The measurements of a study in which nothing was found.
const MEASURED: Stems = ["measured-1", "measured-2", "measured-3", "measured-4", "measured-5", "measured-6"];
const SCENARIO: &str = "scenario.toml";
const TABLES: [&str; 4] = ["comparison.csv", "values.csv", "minima.csv", "responses.csv"];

/// The name of a run's scenario, where runs have their own.
pub(super) fn scenario_of(run: &str) -> String {
    format!("scenario-{}.toml", as_file_name(run))
}

/// The names of all files that a study may write.
fn names(study: &Study) -> impl Iterator<Item = String> {
    let stems: Vec<&str> = match study.kind {
        Kind::ForceMap => force_map::STEMS.to_vec(),
        Kind::Trajectories => trajectories::STEMS.to_vec(),
        Kind::Hysteresis => loops::STEMS.to_vec(),
        Kind::RingDown => rings::STEMS.to_vec(),
        Kind::FlowCurve | Kind::SteadyFlow | Kind::Tank | Kind::PulseTrain => valve::STEMS.concat(),
    };
    let of_plate = |stem: &str| ["svg", "png", "csv"].map(|ending| format!("{stem}.{ending}"));
    let plates: Vec<String> = stems.into_iter().chain(MEASURED).flat_map(of_plate).collect();
    let runs: Vec<String> = study.runs.iter().map(|run| scenario_of(&run.name)).collect();
    plates.into_iter().chain(runs).chain([PAGE, SCENARIO].into_iter().chain(TABLES).map(str::to_owned))
}

/// Refuses a folder in which a study would write over what it reads.
pub(super) fn check_folder(study: &Study, folder: &Path) -> Result<(), Failure> {
    let data = study.runs.iter().flat_map(|run| &run.files);
    let read: Vec<&Path> = [&study.path, &study.scenario].into_iter().chain(data).map(PathBuf::as_path).collect();
    for path in names(study).map(|name| folder.join(name)) {
        let help = "give another folder: files of this name are written there";
        output::distinct(read.iter().copied(), [path.as_path()], help)?;
    }
    Ok(())
}

/// How a sentence begins that is a warning, among those that are good to know.
pub const WARNED: &str = "! ";

/// A scenario file of what was found.
pub(super) fn file(scenario: &Scenario) -> String {
    headed(&scenario.to_toml())
}

/// A scenario's text with a line that says where it comes from.
fn headed(text: &str) -> String {
    format!("# By `mckibben identify`.\n\n{text}")
}

/// A scenario file for each run whose scenario, given as TOML, differs, or one for all.
pub(super) fn files<'a>(named: impl Iterator<Item = (&'a str, String)>) -> Vec<(String, String)> {
    let texts: Vec<(&str, String)> = named.map(|(run, text)| (run, headed(&text))).collect();
    match texts.windows(2).all(|pair| pair[0].1 == pair[1].1) {
        true => texts.into_iter().take(1).map(|(_, text)| (SCENARIO.to_owned(), text)).collect(),
        false => texts.into_iter().map(|(run, text)| (scenario_of(run), text)).collect(),
    }
}

/// The part of a page with the numbers that were found, and the scenario files that have them.
pub(super) fn numbers(tables: Vec<Table>, scenarios: &[(String, String)]) -> Section {
    Section {
        id: "numbers",
        label: "Numbers",
        title: "What was found",
        tables,
        files: scenarios.iter().map(|(name, text)| (name.clone().into(), text.clone().into())).collect(),
        ..Section::default()
    }
}

/// The panel below a figure with how far what was found is off.
pub(super) fn off(words: impl Into<String>, unit: &str, series: Series) -> Panel {
    Panel::new(Axis::new(words, unit)).horizontal(0.0, "").legend(Legend::Hidden).height_mm(20.0).series(series)
}

/// What was found.
#[derive(Debug, Default)]
pub struct Outcome {
    /// The heading of the page.
    pub(super) title: String,
    /// What was done, in a few sentences.
    pub introduction: Vec<String>,
    /// The parts of the page behind the one that says what was found in the data.
    pub(super) sections: Vec<Section>,
    /// How near what was found comes to the measurements.
    pub table: Table,
    /// The values that were found.
    pub values: Table,
    /// The values with their standard errors, as numbers.
    pub estimates: Vec<Estimate>,
    /// Whether the search was interrupted, or its time was over, before it was done.
    pub interrupted: bool,
    /// The ends of searches from several starts, where there are more than one: first that of the values.
    pub(super) minima: Table,
    /// The other ends as numbers, the nearest to the measurements first.
    pub other_minima: Vec<OtherMinimum>,
    /// Overshoot, first peak, frequency and settling of step-like runs, measured and predicted.
    pub responses: Table,
    /// Likewise as numbers.
    pub step_responses: Vec<StepResponse>,
    /// Correlations of the estimates, row by row; empty where they do not come from one fit.
    pub correlations: Vec<Vec<f64>>,
    /// The readings with the predictions of the fitted model; empty where nothing was found, and of a
    /// tank that is fitted window by window.
    pub predictions: Vec<Prediction>,
    /// What a reader should know before believing them; warnings begin with [`WARNED`].
    pub warnings: Vec<String>,
    /// The scenarios with the values found, each with the name of its file.
    pub scenarios: Vec<(String, String)>,
    /// What failed, where that is not everything; the warnings say it too.
    pub(super) failed: Vec<Failure>,
}

/// Results of runs individually, where there are any.
pub(super) fn of_each<'a, T>(
    runs: impl Iterator<Item = &'a Recording>,
    warnings: &mut Vec<String>,
    mut found: impl FnMut(&'a Recording, &mut Vec<String>) -> Result<T, Failure>,
) -> Result<(Vec<T>, Vec<Failure>), Failure> {
    let (mut all, mut failed) = (Vec::new(), Vec::new());
    for run in runs {
        match found(run, warnings) {
            Ok(found) => all.push(found),
            Err(failure) => failed.push(failure),
        }
    }
    if all.is_empty() && !failed.is_empty() {
        return Err(failed.swap_remove(0));
    }
    warnings.extend(failed.iter().map(|failure| format!("{WARNED}failed: {}", failure.sentence())));
    Ok((all, failed))
}

impl Outcome {
    /// Without the scenario files that are refused where they are read: what is refused has failed, and is not written.
    pub(super) fn without_refused(mut self) -> Self {
        let refused = |(name, text): &(String, String)| {
            let read = Document::parse(text, name).and_then(|document| match document.is_plant() {
                true => document.plant_experiment().map(|_| ()),
                false => document.scenario().map(|_| ()),
            });
            read.err().map(|error| (name.clone(), Failure::from(error)))
        };
        for (name, failure) in self.scenarios.iter().filter_map(refused).collect::<Vec<_>>() {
            self.scenarios.retain(|(of, _)| *of != name);
            self.sections.iter_mut().for_each(|section| section.files.retain(|(of, _)| *of != *name));
            let why = format!("the values that were found make no scenario `{name}`: {}", failure.sentence());
            self.warnings.push(format!("{WARNED}failed: {why}"));
            self.failed.push(Failure::stopped(why));
        }
        self
    }

    /// What was measured, and why nothing was found in it.
    pub(super) fn nothing(material: &Material, failure: Failure) -> Self {
        let plates = material.recordings.iter().zip(MEASURED).filter_map(|(run, stem)| measured(run, stem));
        let section = Section {
            id: "measured",
            label: "Measured",
            title: "The measurements as they were read",
            paragraphs: vec![format!("Nothing was found: {}", failure.sentence())],
            plates: plates.collect(),
            ..Section::default()
        };
        Self {
            title: format!("{}: nothing was found", material.name()),
            // The reason is on the page, and is the error of the verdict.
            introduction: vec!["Nothing was found.".to_owned()],
            sections: vec![section],
            warnings: material.notes(),
            failed: vec![failure],
            ..Self::default()
        }
    }

    /// The figures of the page, with the numbers that they show.
    pub fn plates(&self) -> impl Iterator<Item = &Plate> {
        self.sections.iter().flat_map(|section| &section.plates)
    }

    /// That all was found.
    ///
    /// # Errors
    /// [`Failure::stopped`], which says what was not; the rest is on `page`. [`Failure::not_finite`] for an estimate.
    pub fn verdict(&self, page: Option<&Path>) -> Result<(), Failure> {
        self.check_finite()?;
        let Some(first) = self.failed.first() else { return Ok(()) };
        let others = match self.failed.len() {
            1 => String::new(),
            many => format!(" (and {} more)", many - 1),
        };
        let shows = page.map(|page| format!("; the results so far are in {}", page.display())).unwrap_or_default();
        Err(Failure::stopped(format!("{}{others}{shows}", first.sentence())))
    }

    /// That every estimate, and what is known of how sure it is, is a finite number.
    ///
    /// # Errors
    /// [`Failure::not_finite`] with the estimate.
    pub fn check_finite(&self) -> Result<(), Failure> {
        for Estimate { name, value, standard_error, confidence_interval, .. } in &self.estimates {
            let mut numbers =
                [*value].into_iter().chain(*standard_error).chain(confidence_interval.iter().flatten().copied());
            if let Some(number) = numbers.find(|number| !number.is_finite()) {
                return Err(Failure::not_finite(&format!("the estimate of {name}: {number}")));
            }
        }
        Ok(())
    }

    /// Writes everything into a folder; the page comes last, so that where it stands everything that it refers to stands too.
    ///
    /// # Errors
    /// [`Failure::output`] when a file cannot be written; [`Failure::not_finite`] for an estimate, and nothing is written.
    pub fn write(&self, folder: &Path) -> Result<PathBuf, Failure> {
        self.check_finite()?;
        std::fs::create_dir_all(folder).map_err(|error| Failure::output(folder, error))?;
        for (name, text) in &self.scenarios {
            output::write(&folder.join(name), text.as_bytes())?;
        }
        for (table, name) in [&self.table, &self.values, &self.minima, &self.responses].into_iter().zip(TABLES) {
            if !table.head.is_empty() {
                let path = folder.join(name);
                output::write(&path, &table.to_csv(&path)?)?;
            }
        }
        let report = Report {
            title: self.title.clone(),
            introduction: self.introduction.clone(),
            sections: std::iter::once(self.data()).chain(self.sections.iter().cloned()).collect(),
            colophon: format!("Made by mckibben {}.", env!("CARGO_PKG_VERSION")),
            ..Report::default()
        };
        report.write(folder)
    }

    /// What was found in the data.
    fn data(&self) -> Section {
        let paragraphs = match self.warnings.is_empty() {
            true => vec!["Nothing odd was found in the data.".to_owned()],
            false => self.warnings.clone(),
        };
        Section { id: "data", label: "Data", title: "What was measured", paragraphs, ..Section::default() }
    }
}

/// The readings of a run over time, or over their number where they have no times.
fn measured(run: &Recording, stem: &'static str) -> Option<Plate> {
    let mut data = Data::new(&["quantity", "at", "value"]);
    let mut panels = Vec::new();
    let timed = run.column(Quantity::Time).is_some();
    let over = |sheet: &Sheet| match sheet.column(Quantity::Time) {
        Some(time) => time.values.clone(),
        None => (1..=sheet.rows).map(|reading| reading as f64).collect(),
    };
    for sheet in &run.sheets {
        let at = over(sheet);
        for column in sheet.columns.iter().filter(|column| column.quantity != Quantity::Time) {
            let kind = Quantity::ALL.iter().position(|of| *of == column.quantity).unwrap_or_default();
            let pairs = || at.iter().zip(&column.values).filter(|(at, value)| at.is_finite() && value.is_finite());
            data.rows.extend(pairs().map(|(at, value)| vec![kind as f64, *at, *value]));
            let (x, y) = pairs().map(|(at, value)| (*at, *value)).unzip();
            let axis = Axis::new(column.quantity.words(), column.quantity.unit());
            panels.push(Panel::new(axis).legend(Legend::Hidden).series(Series::dots("", x, y)));
        }
    }
    let x = if timed { Axis::new("time", "s") } else { Axis::new("reading", "") };
    let caption = format!("`{}` as it was read.", run.name);
    let figure = Figure { width_mm: 150.0, x, panels, ..Figure::default() };
    // A table of nothing but times has nothing to show.
    (!data.rows.is_empty()).then_some(Plate { stem, caption, figure, data })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scenario_that_is_refused_is_not_written() {
        let text = |times: &str| {
            format!(
                "[actuator]\npreset = \"colbrunn-2001\"\n[actuator.friction.viscoelastic]\nrelaxation_time = [{times}]\n\
                 stiffness_ratio = [0.3, 0.1]\n[load]\nkind = \"hanging-mass\"\nmass = \"3 kg\"\n[initial]\nlength = \"85 mm\"\n\
                 gauge_pressure = \"4 bar\"\n[run]\nduration = \"1 s\"\n"
            )
        };
        let of = |times: &str| Outcome { scenarios: vec![(SCENARIO.to_owned(), text(times))], ..Outcome::default() };
        let right = of("\"0.1 s\", \"0.3 s\"").without_refused();
        assert!(right.scenarios.len() == 1 && right.verdict(None).is_ok(), "{:?}", right.warnings);
        let refused = of("\"0.3 s\", \"0.1 s\"").without_refused();
        assert!(refused.scenarios.is_empty());
        let said = refused.verdict(None).expect_err("a scenario that is refused").sentence();
        assert!(said.contains("make no scenario") && said.contains("relaxation_time"), "{said}");
    }

    #[test]
    fn an_estimate_that_is_not_finite_is_a_failure() {
        let estimate = |value, standard_error| Estimate {
            name: "load.mass".to_owned(),
            unit: "kg",
            value,
            standard_error,
            confidence_interval: None,
            on_bound: false,
            bound: None,
        };
        let of = |estimate| Outcome { estimates: vec![estimate], ..Outcome::default() };
        assert!(of(estimate(1.0, Some(0.1))).verdict(None).is_ok());
        assert!(of(estimate(1.0, None)).verdict(None).is_ok());
        for wrong in [estimate(f64::NAN, None), estimate(1.0, Some(f64::INFINITY))] {
            let said = of(wrong).verdict(None).expect_err("not finite").sentence();
            assert!(said.contains("load.mass"), "{said}");
        }
    }
}
