//! Reads `[sweep]`: how the rows are chosen, what is recorded, and the scenarios that the rows start from.
//!
//! The scenario is read with the first value of every key in place, once for each combination of words and whole numbers, so
//! that a key which only the sweep gives is not missing and a contradiction is reported where the value stands. Its
//! other values are numbers within the range that the key has, and need no text.

use super::axis::Axis;
use super::design::{MOST_ROWS, Sampler};
use super::left_out::{self, LeftOut};
use super::plant::{self, Swept};
use super::random::Stream;
use super::reduction::{DEFAULT, DEFAULT_OF_JOINT, Quantity, Reduction};
use super::vary::{self, Varied};
use super::{Base, Record, Sweep, sobol};
use crate::choice::{DesignKind, RecordKind, StatisticsOver, Word as _};
use crate::diagnostic::{Class, Diagnostic, Diagnostics, Place};
use crate::document::{Document, Value};
use crate::keys::{self, SWEEP, VARY};
use crate::muscle::BRAID;
use crate::nearest::{nearest, nearest_few};
use crate::quantity;
use crate::reader::{Reader, list_of};
use crate::scenario::Scenario;
use mckibben::parameter as p;

/// Most combinations of words, each of which is a scenario in memory.
const MOST_BASES: u64 = 4096;

/// Numbers in a part of the result when the file does not say how long one is: about 8 MB.
const NUMBERS_IN_PART: f64 = 1_048_576.0;

/// Columns of a recorded sample of one actuator, and of a joint.
const COLUMNS: [f64; 2] = [10.0, 22.0];

/// Rows in a part at most, so that little is lost when a long sweep is stopped.
const ROWS_IN_PART: f64 = 4096.0;

impl Document {
    /// Reads the section `[sweep]`, and the scenarios that it needs; `None` when there is none.
    ///
    /// # Errors
    /// Every mistake in the section; then, if there is none, every mistake in the scenario with the first value of each
    /// key that varies.
    pub fn sweep(&self) -> Result<Option<Sweep>, Diagnostics> {
        if !self.contains(SWEEP) {
            return Ok(None);
        }
        let mut reader = Reader::of_section(self, SWEEP);
        let r = &mut reader;
        let design = r.word("sweep.design").unwrap_or(DesignKind::Grid);
        let seed = r.whole(&keys::SWEEP_SEED).unwrap_or(0);
        let part_rows = r.whole(&keys::PART_ROWS);
        let is_plant = self.is_plant();
        let record = record(r, is_plant);
        let over = r.word("sweep.over").unwrap_or(StatisticsOver::Run);
        let varied = vary::read(r, design);
        let rows = if design == DesignKind::Grid { combinations(r, &varied) } else { rows(r) };
        let words = varied.iter().filter_map(Varied::read_each_row).fold(1, u64::saturating_mul);
        if words > MOST_BASES && !is_plant {
            let place = r.key_place(VARY);
            note_beyond(
                r,
                place,
                &format!("words and whole numbers combine to {words} scenarios, more than {MOST_BASES}"),
            );
        }
        if design == DesignKind::Sobol && varied.len() > sobol::DIMENSIONS {
            let place = r.key_place(VARY);
            let most = sobol::DIMENSIONS;
            note_beyond(r, place, &format!("{} keys vary by a Sobol' sequence of {most} dimensions", varied.len()));
        }
        reader.finish()?;
        let left_out = left_out::of(self, &varied);
        if is_plant {
            let (swept, first) = Swept::read(self, &varied, &left_out)?;
            let record = plant::record(self, record, &first)?;
            plant::check_times(self, &record, first.run.duration, &varied)?;
            let columns = 1.0 + swept.columns.len() as f64;
            let part_rows = part_rows
                .unwrap_or_else(|| part_of(&record, [swept.run.duration, swept.run.sample_interval], columns))
                .min(rows);
            let (axes, plant) = (axes(varied, design, rows, seed), Some(Box::new(swept)));
            return Ok(Some(Sweep {
                axes,
                design,
                rows,
                seed,
                record,
                over,
                part_rows,
                bases: Vec::new(),
                plant,
                left_out,
            }));
        }
        let bases = bases(self, &varied, &left_out, words)?;
        let Some((record, Base { scenario: first, .. })) = record.zip(bases.first()) else { return Ok(None) };
        check_joints(self, &bases)?;
        check_presets(&varied, &bases)?;
        let record = match record {
            Record::Reductions(_) if first.has_joint() && !self.contains("sweep.reductions") => {
                Record::Reductions(DEFAULT_OF_JOINT.to_vec())
            }
            record => record,
        };
        let varies = varied.iter().any(|varied| varied.path == p::DURATION.key);
        check_times_of(self, &record, first.run.duration, varies)?;
        check_reductions(self, &record, &bases)?;
        let (span, columns) =
            ([first.run.duration, first.run.sample_interval], COLUMNS[usize::from(first.has_joint())]);
        let part_rows = part_rows.unwrap_or_else(|| part_of(&record, span, columns)).min(rows);
        let axes = axes(varied, design, rows, seed);
        Ok(Some(Sweep { axes, design, rows, seed, record, over, part_rows, bases, plant: None, left_out }))
    }
}

/// How many rows a design other than a grid has.
fn rows(r: &mut Reader<'_>) -> u64 {
    if !r.has(keys::SWEEP_ROWS.key) {
        r.missing(keys::SWEEP_ROWS.key, ", which every design but a grid needs");
    }
    r.whole(&keys::SWEEP_ROWS).unwrap_or(1)
}

/// How many rows a grid has.
fn combinations(r: &mut Reader<'_>, varied: &[Varied<'_>]) -> u64 {
    let product = varied.iter().filter_map(|varied| varied.values.count()).try_fold(1, u64::checked_mul);
    product.filter(|rows| *rows <= MOST_ROWS).unwrap_or_else(|| {
        let place = r.key_place(VARY);
        note_beyond(r, place, &format!("the grid has more than {MOST_ROWS} rows"));
        1
    })
}

fn note_beyond(r: &mut Reader<'_>, place: Option<Place>, what: &str) {
    if let Some(place) = place {
        r.note(
            Diagnostic::at(Class::OutOfRange, place, what, "too many")
                .help("vary fewer keys, or give fewer values of each, or choose another design"),
        );
    }
}

/// What is recorded; `None` when its mistake has been noted.
fn record(r: &mut Reader<'_>, is_plant: bool) -> Option<Record> {
    Some(match r.word("sweep.record") {
        None | Some(RecordKind::Reductions) => {
            let path = "sweep.reductions";
            // Those of a plant have names of the file in them.
            Record::Reductions(if r.has(path) && !is_plant { reductions(r, path)? } else { DEFAULT.to_vec() })
        }
        Some(RecordKind::Trajectories) => Record::Trajectories,
        Some(RecordKind::Samples) => {
            if !r.has(keys::SAMPLE_TIMES.key) {
                r.missing(keys::SAMPLE_TIMES.key, ", which `record = \"samples\"` needs");
            }
            let times = r.list(&keys::SAMPLE_TIMES)?;
            let falls = times.windows(2).position(|pair| pair[1] <= pair[0]);
            if let Some(place) = falls.and_then(|at| r.item_place(keys::SAMPLE_TIMES.key, at + 1)) {
                let title = format!("`{}` must increase from entry to entry", keys::SAMPLE_TIMES.key);
                let label = "not above the entry before";
                r.note(Diagnostic::at(Class::BadList, place, title, label).help("sort the times, each once"));
            }
            Record::Samples(times)
        }
    })
}

/// Names that are printed in place of one that is unknown.
const NEAREST: usize = 6;

/// The reductions that the file names; `None` when a mistake has been noted.
fn reductions(r: &mut Reader<'_>, path: &str) -> Option<Vec<Reduction>> {
    let items = r.items_of(&r.entry(path)?.node, path)?;
    let before = r.mistakes();
    let mut found: Vec<(Reduction, Place)> = Vec::new();
    for item in items {
        let Value::String(name) = &item.value else {
            let title = "a reduction is a name in quotes";
            r.note(Diagnostic::at(Class::WrongType, item.place.clone(), title, "not a name"));
            continue;
        };
        match Reduction::from_name(name) {
            Some(reduction) => found.push((reduction, item.place.clone())),
            None => {
                let (title, help) = (format!("\"{name}\" is not a valid value of `{path}`"), meant(r.document(), name));
                r.note(Diagnostic::at(Class::InvalidChoice, item.place.clone(), title, "unknown word").help(help));
            }
        }
    }
    let named: Vec<(&str, Place)> = found.iter().map(|(of, place)| (of.name(), place.clone())).collect();
    check_each_once(r, &named);
    (r.mistakes() == before).then(|| found.into_iter().map(|(of, _)| of).collect())
}

/// The reductions of this kind of scenario whose names are nearest to one that is unknown.
fn meant(document: &Document, name: &str) -> String {
    let is_word = |key: &str, words: &[&str]| words.iter().any(|word| document.is_word(key, word));
    let varies = |section: &str| match document.entry(VARY).map(|entry| &entry.node.value) {
        Some(Value::Table(table)) => table.0.iter().any(|entry| entry.name.split('.').next() == Some(section)),
        _ => false,
    };
    // What rows choose may be either.
    let has_joint = is_word("load.kind", &["antagonistic-joint"]) || varies("load") || document.contains("antagonist");
    let has_controller = document.contains("controller") || document.contains("controllers") || varies("command");
    let is_of_scenario = |of: &&Reduction| {
        (has_joint || !of.quantity.is_of_joint()) && (has_controller || !matches!(of.quantity, Quantity::Error(_)))
    };
    let known = || Reduction::ALL.iter().filter(is_of_scenario).map(|of| of.name());
    let all = "`mckibben keys sweep.reductions` lists all of them";
    match nearest(name, known()) {
        Some(meant) => format!("did you mean \"{meant}\"? {all}"),
        None => format!("the nearest: {}; {all}", list_of(nearest_few(name, known(), NEAREST).into_iter())),
    }
}

/// Refuses a reduction that is named twice: two columns would have one name.
pub(super) fn check_each_once(r: &mut Reader<'_>, named: &[(&str, Place)]) {
    for (index, (name, place)) in named.iter().enumerate() {
        if let Some((_, first)) = named[..index].iter().find(|(other, _)| other == name) {
            let title = format!("the reduction `{name}` is named twice");
            r.note(
                Diagnostic::at(Class::Conflict, place.clone(), title, "second time")
                    .related(Some(first.clone()), "first time")
                    .help("keep one of them"),
            );
        }
    }
}

/// Refuses times beyond the end of the run, unless the run's duration varies.
pub(super) fn check_times_of(
    document: &Document,
    record: &Record,
    duration: f64,
    varies: bool,
) -> Result<(), Diagnostics> {
    let Record::Samples(times) = record else { return Ok(()) };
    if varies {
        return Ok(());
    }
    let beyond = times.iter().position(|time| *time > duration);
    let reader = Reader::of_section(document, SWEEP);
    match beyond.and_then(|at| reader.item_place(keys::SAMPLE_TIMES.key, at)) {
        None => Ok(()),
        Some(place) => {
            let title = "this time is beyond the end of the run";
            let label = format!("the run lasts {}", quantity::format(duration, p::DURATION.unit));
            Err(Diagnostic::at(Class::Inconsistent, place, title, label)
                .related(reader.value_place(p::DURATION.key), "the run's duration")
                .help("leave it out, or make the run longer")
                .into())
        }
    }
}

/// Refuses reductions that no row has.
fn check_reductions(document: &Document, record: &Record, bases: &[Base]) -> Result<(), Diagnostics> {
    let Record::Reductions(reductions) = record else { return Ok(()) };
    let controlled = bases.iter().any(|base| base.scenario.has_controller());
    let has_joint = bases.iter().any(|base| base.scenario.has_joint());
    let foreign = |of: &Reduction| {
        (matches!(of.quantity, Quantity::Error(_)) && !controlled) || (of.quantity.is_of_joint() && !has_joint)
    };
    let Some(at) = reductions.iter().position(foreign) else { return Ok(()) };
    let [of, remedy] = match reductions[at].quantity.is_of_joint() && !has_joint {
        true => ["a joint", "leave it out, or set load.kind = \"antagonistic-joint\""],
        false => ["a controller", "leave it out, or set command.kind = \"controllers\""],
    };
    let title = format!("`{}` is of {of}, and there is none", reductions[at].name());
    let diagnostic = match Reader::of_section(document, SWEEP).item_place("sweep.reductions", at) {
        Some(place) => Diagnostic::at(Class::NotApplicable, place, title, "no row has it"),
        None => Diagnostic::whole(Class::NotApplicable, document.source().name(), title),
    };
    Err(diagnostic.help(remedy).into())
}

/// The scenario for each combination of words and whole numbers, with the first value of every other key; without the keys that
/// have no meaning under a word that varies.
fn bases(
    document: &Document,
    varied: &[Varied<'_>],
    left_out: &[LeftOut],
    combinations: u64,
) -> Result<Vec<Base>, Diagnostics> {
    let whole = vary::first(document, varied);
    let mut bases = Vec::new();
    for combination in 0..combinations {
        let mut document = whole.clone();
        let mut rest = combination;
        let mut chosen = Vec::new();
        for varied in varied.iter().rev() {
            if let Some(count) = varied.read_each_row() {
                let value = varied.value(rest % count);
                document.put_at(&varied.path, &varied.key, value);
                chosen.push(format!("`{} = {}`", varied.path, value.place.text()));
                rest /= count;
            }
        }
        left_out.iter().for_each(|of| of.leave_out(&mut document));
        let scenario = document.scenario().map_err(|found| match chosen.is_empty() {
            true => found,
            false => {
                chosen.reverse();
                found.help(&format!("so it is in the rows with {} of [sweep.vary]", chosen.join(" and ")))
            }
        })?;
        bases.push(Base::new(&document, scenario, varied));
    }
    Ok(bases)
}

impl Base {
    /// What rows start from, as a document with a value of every key that varies says it.
    fn new(document: &Document, scenario: Scenario, varied: &[Varied<'_>]) -> Self {
        let second = document.antagonist();
        let taken_over = |of: &Varied<'_>| {
            second.node_at(&of.path).is_some_and(|own| of.nodes().any(|node| node.place.is(&own.place)))
        };
        let sets_second = |of: &Varied<'_>| scenario.has_joint() && (of.is_of_antagonist() || taken_over(of));
        let sets_second: Vec<bool> = varied.iter().map(sets_second).collect();
        let is_of_braid =
            |of: &Varied<'_>| BRAID.iter().chain([&&p::MAX_LENGTH, &&p::MIN_LENGTH]).any(|row| of.is(row));
        let first = varied.iter().any(|of| !of.is_of_antagonist() && is_of_braid(of));
        let of_second = varied.iter().zip(&sets_second).any(|(of, sets)| *sets && is_of_braid(of));
        let braids = [first.then(|| document.stated_braid()), of_second.then(|| second.stated_braid())];
        Self { scenario, sets_second, braids }
    }
}

/// Refuses presets that change nothing, since the file states every value in which they differ.
fn check_presets(varied: &[Varied<'_>], bases: &[Base]) -> Result<(), Diagnostics> {
    // The last of the keys for each of whose values there is a base changes first.
    let mut stride = 1;
    for of in varied.iter().rev() {
        let Some(count) = of.read_each_row().and_then(|count| usize::try_from(count).ok()) else { continue };
        let is_equal = |(index, base): (usize, &Base)| {
            let first = &bases[index - (index / stride % count) * stride];
            base.scenario == first.scenario && base.braids == first.braids
        };
        if count > 1 && of.path.ends_with(".preset") && bases.iter().enumerate().all(is_equal) {
            let title = format!("`{}` varies, and the file states every value in which its presets differ", of.path);
            let found = Diagnostic::at(Class::NotApplicable, of.key.clone(), title, "changes no row");
            return Err(found.help("remove it, or the values in the file that the presets are to give").into());
        }
        stride *= count;
    }
    Ok(())
}

/// Refuses a joint in some rows and one actuator in others: what is recorded of the two differs.
fn check_joints(document: &Document, bases: &[Base]) -> Result<(), Diagnostics> {
    if bases.iter().all(|base| base.scenario.has_joint() == bases[0].scenario.has_joint()) {
        return Ok(());
    }
    let title = "some rows have an antagonistic joint, and others one actuator";
    let found = match document.place(VARY) {
        Some(place) => Diagnostic::at(Class::Inconsistent, place.clone(), title, "mixes what is recorded"),
        None => Diagnostic::whole(Class::Inconsistent, document.source().name(), title),
    };
    Err(found.help("run one sweep for each").into())
}

/// Rows in a part of the result: as many as hold a manageable amount.
fn part_of(record: &Record, [duration, sample_interval]: [f64; 2], columns: f64) -> u64 {
    let numbers = match record {
        Record::Reductions(list) => list.len() as f64,
        Record::PlantReductions(list) => list.len() as f64,
        Record::Samples(times) => times.len() as f64 * columns,
        Record::Trajectories => (duration / sample_interval + 1.0) * columns,
    };
    (NUMBERS_IN_PART / numbers).clamp(1.0, ROWS_IN_PART) as u64
}

fn axes(varied: Vec<Varied<'_>>, design: DesignKind, rows: u64, seed: u64) -> Vec<Axis> {
    let mut stride = rows;
    let sampled = varied.into_iter().enumerate().map(|(index, varied)| {
        let stream = Stream::new(seed, &varied.path);
        let sampler = match design {
            DesignKind::Grid => {
                stride /= varied.values.count().unwrap_or(1);
                Sampler::Grid { stride }
            }
            DesignKind::LatinHypercube => Sampler::latin_hypercube(rows, stream),
            DesignKind::Sobol => {
                // More keys than dimensions have been refused.
                let dimension = sobol::Dimension::new(index, stream);
                dimension.map_or(Sampler::Random(stream), |dimension| Sampler::Sobol(Box::new(dimension)))
            }
            DesignKind::Random => Sampler::Random(stream),
        };
        let (kind, target, read_each_row) = (varied.kind(), varied.target(), varied.read_each_row().is_some());
        Axis { path: varied.path, kind, values: varied.values, sampler, read_each_row, target }
    });
    sampled.collect()
}
