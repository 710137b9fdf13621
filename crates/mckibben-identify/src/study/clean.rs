//! The rules for dirty data. Whatever is done is reported in a [`Note`]; what cannot be put right by rule is refused.
//!
//! | found | done |
//! |---|---|
//! | no reading in a cell | the cell is left out; more than half of a column is refused |
//! | no reading in any cell of a row | the row is left out |
//! | one time twice | readings are averaged, each column separately |
//! | a time that goes back | refused: sort the table, or make it two runs |
//! | an offset that was given | taken off |
//! | one span of `zero` | the mean over it, less its value, is taken off as an offset |
//! | two spans of `zero` | the straight line through both is taken off: offset and drift |
//! | readings at or beyond `saturates` | left out |
//! | the same extreme value many times on end, nothing said about it | refused: say `saturates`, or that it does not with a larger one |
//! | a reading 8 robust deviations from the median of its 8 neighbours, and farther from it than half a reading of the column is expected to be by its noise, and not on an edge | reported; left out with `drop_outliers` |
//! | few readings a hundred times as large as all others; of lengths and temperatures ten times as large or as small; one reading over time a thousand times | refused; left out with `drop_outliers` |
//! | a length or a temperature that is not above zero | refused; left out with `drop_outliers` |
//! | a step in time a thousand times as long as all others together | refused |
//! | uneven steps, gaps | reported: nothing is resampled, every reading is compared at its own time |
//! | a tension at or below `slack`, or three times its noise: its `deviation`, or the scatter of those below zero | marked as slack |
//! | a gauge pressure below the atmosphere, of a muscle that is not evacuated | reported as a likely offset |

use super::file::ColumnEntry;
use super::table::Table;
use super::{Column, Quantity, Sheet, StudyError};
use crate::median::{deviation, median};
use statrs::distribution::{ContinuousCDF, Normal};
use std::fmt;

/// Robust deviations from which on a reading is an outlier.
const FAR: f64 = 8.0;
/// Readings of whose median it is judged.
const WINDOW: usize = 9;
/// How many times as large as all others a reading is that cannot be: in a table without times, over time, and for quantities
/// that never come near zero.
const APART: [f64; 3] = [1e2, 1e3, 1e1];
/// At most one in so many readings is taken to be one that cannot be: what many say is no slip.
const SLIPS: usize = 20;
/// Fewer other readings than this do not say what can be.
const OTHERS: usize = 4;
/// Part by which the mean rate of readings and that of their median step differ where both are reported.
const UNEVEN: f64 = 0.01;
/// How many times as long as all other steps together a step in time is that cannot be.
const JUMP: f64 = 1e3;
/// Standard deviations of the noise at or below which a tension is none; and the part of the largest tension that they are at most, where
/// the noise is taken from the readings.
const WITHIN_NOISE: f64 = 3.0;
const MOST_NOISE: f64 = 0.05;
/// Equal largest readings on end from which on a sensor may be taken to be at its end.
pub const STUCK: usize = 8;

/// The longest row of equal readings that are the largest of all, and that reading; what is no number does not count.
pub fn longest_at_the_end(values: &[f64]) -> (usize, f64) {
    let largest = values.iter().copied().filter(|value| value.is_finite()).fold(f64::NEG_INFINITY, f64::max);
    (values.split(|value| *value != largest).map(<[f64]>::len).max().unwrap_or(0), largest)
}

/// The rules of one column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rules {
    /// At or below this no tension was held; unless it is given, three times the noise.
    pub slack: Option<f64>,
    /// At or above this the sensor is at its end.
    pub saturates: Option<f64>,
    /// Standard deviation of a reading.
    pub deviation: Option<f64>,
    /// Taken off every reading.
    pub offset: f64,
    /// Spans of time in s in which the quantity is known, with its value.
    pub zeros: Vec<([f64; 2], f64)>,
    /// Whether outliers are left out.
    pub drop_outliers: bool,
}

/// How much a finding matters.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum Severity {
    /// Good to know.
    Noted,
    /// Something was done, or should be looked at.
    Warned,
}

/// Something found in the data, and what was done about it.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Note {
    /// How much it matters.
    pub severity: Severity,
    /// The sentence.
    pub text: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.text)
    }
}

/// Cleans a table: the columns that a study names, and those that were held.
pub(super) fn sheet(
    table: &Table,
    entries: &[&ColumnEntry],
    held: &[(Quantity, f64)],
    notes: &mut Vec<Note>,
) -> Result<Sheet, StudyError> {
    let name = table.file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let mut work = Work { table, name, notes, lines: table.lines.clone() };
    let mut columns: Vec<Column> = entries.iter().map(|entry| work.raw(entry)).collect();
    work.leave_out_empty_rows(&mut columns);
    if work.lines.is_empty() {
        return Err(StudyError::new(&table.file, None, "it has no readings", "give a table with rows"));
    }
    work.missing(&columns)?;
    if let Some(time) = columns.iter().position(|column| column.quantity == Quantity::Time) {
        work.in_order(&mut columns, time)?;
        work.jump(&columns[time].values)?;
        work.rate(&columns[time].values);
        for (place, entry) in entries.iter().enumerate() {
            let times = columns[time].values.clone();
            if place != time {
                work.zero(&mut columns[place], &entry.rules, &times)?;
                work.outliers(&mut columns[place], &entry.rules);
            }
        }
    }
    let timed = columns.iter().any(|column| column.quantity == Quantity::Time);
    let times = columns.iter().find(|column| column.quantity == Quantity::Time).map(|time| time.values.clone());
    let steps: Vec<f64> = times.unwrap_or_default().windows(2).map(|pair| pair[1] - pair[0]).collect();
    let step = median(&steps);
    for (column, entry) in columns.iter_mut().zip(entries) {
        // Readings of one sample that a sensor holds.
        let repeated = entry.sensor.hold.zip(step).map_or(1.0, |(hold, step)| (hold / step).max(1.0));
        work.ends(column, &entry.rules, repeated)?;
        work.impossible(column, entry, timed)?;
        work.slack(column, &entry.rules);
        work.vacuum(column);
    }
    let rows = work.lines.len();
    let constant = |(quantity, value): &(Quantity, f64)| Column {
        quantity: *quantity,
        part: None,
        values: vec![*value; rows],
        slack: vec![false; rows],
        deviation: None,
    };
    columns.extend(held.iter().map(constant));
    Ok(Sheet { columns, rows, lines: work.lines })
}

/// The first few of ordered sizes, with their ratio to the first of the others, where they stand so far apart; over time they stand
/// alone in their rows too.
fn apart(sizes: &[(usize, f64)], factor: f64, timed: bool) -> Vec<(usize, f64)> {
    let most = (sizes.len() / SLIPS).max(1).min(sizes.len().saturating_sub(OTHERS));
    let ratio = |few: usize| (sizes[few - 1].1 / sizes[few].1).max(sizes[few].1 / sizes[few - 1].1);
    // Among zeros alone no size means anything.
    let stands = |few: &usize| sizes[*few].1 > 0.0 && sizes[few - 1].1 > 0.0 && ratio(*few) >= factor;
    let Some(few) = (1..=most).rev().find(stands) else { return Vec::new() };
    let rows: Vec<usize> = sizes[..few].iter().map(|(row, _)| *row).collect();
    let alone = |row: &usize| !rows.iter().any(|other| other.abs_diff(*row) == 1);
    if timed && !rows.iter().all(alone) {
        return Vec::new();
    }
    let other = sizes[few].1;
    sizes[..few].iter().map(|(row, size)| (*row, size / other)).collect()
}

/// Standard deviations beyond which of so many normal readings half a reading is expected (Chauvenet's criterion).
fn chauvenet(readings: usize) -> f64 {
    Normal::standard().inverse_cdf(1.0 - 0.25 / readings.max(1) as f64)
}

struct Work<'a> {
    table: &'a Table,
    name: String,
    notes: &'a mut Vec<Note>,
    lines: Vec<usize>,
}

impl Work<'_> {
    fn note(&mut self, severity: Severity, text: String) {
        self.notes.push(Note { severity, text: format!("{}: {text}", self.name) });
    }

    fn refuse(&self, line: Option<usize>, what: String, remedy: &str) -> StudyError {
        StudyError::new(&self.table.file, line, what, remedy)
    }

    /// A column as it stands, in SI, less its offset.
    fn raw(&mut self, entry: &ColumnEntry) -> Column {
        let found = self.table.columns.iter().find(|(name, _)| *name == entry.name);
        let values = found.map(|(_, values)| {
            values.iter().map(|value| value * entry.scale + entry.zero - entry.rules.offset).collect()
        });
        if entry.rules.offset != 0.0 {
            let (of, unit) = (entry.words(), entry.quantity.unit());
            self.note(
                Severity::Noted,
                format!("an offset of {:.4e} {unit} was taken off the {of}", entry.rules.offset),
            );
        }
        let values: Vec<f64> = values.unwrap_or_default();
        Column {
            quantity: entry.quantity,
            part: entry.part.clone(),
            slack: vec![false; values.len()],
            values,
            deviation: entry.rules.deviation,
        }
    }

    fn leave_out_empty_rows(&mut self, columns: &mut [Column]) {
        let measured = |row: usize| {
            columns.iter().any(|column| column.quantity != Quantity::Time && column.values[row].is_finite())
                && columns.iter().all(|column| column.quantity != Quantity::Time || column.values[row].is_finite())
        };
        let keep: Vec<bool> = (0..self.lines.len()).map(measured).collect();
        let gone = keep.iter().filter(|keep| !**keep).count();
        if gone > 0 {
            self.note(Severity::Noted, format!("{gone} rows without a reading or without a time were left out"));
            self.retain(columns, &keep);
        }
    }

    fn retain(&mut self, columns: &mut [Column], keep: &[bool]) {
        fn kept<T: Copy>(of: &[T], keep: &[bool]) -> Vec<T> {
            of.iter().zip(keep).filter(|(_, keep)| **keep).map(|(value, _)| *value).collect()
        }
        for column in columns {
            column.values = kept(&column.values, keep);
            column.slack = kept(&column.slack, keep);
        }
        self.lines = kept(&self.lines, keep);
    }

    fn missing(&mut self, columns: &[Column]) -> Result<(), StudyError> {
        for column in columns {
            let (missing, rows) = (column.values.iter().filter(|value| value.is_nan()).count(), column.values.len());
            let of = column.words();
            if 2 * missing > rows {
                let what = format!("{missing} of {rows} readings of the {of} are missing");
                return Err(self.refuse(None, what, "give a table with more than half of them"));
            }
            if missing > 0 {
                self.note(
                    Severity::Warned,
                    format!("{missing} of {rows} readings of the {of} are missing and were left out"),
                );
            }
        }
        Ok(())
    }

    /// Times that rise; readings at one time are averaged.
    fn in_order(&mut self, columns: &mut [Column], time: usize) -> Result<(), StudyError> {
        let times = columns[time].values.clone();
        if let Some(at) = (1..times.len()).find(|at| times[*at] < times[at - 1]) {
            let what = format!("the time goes back, from {} s to {} s", times[at - 1], times[at]);
            return Err(self.refuse(Some(self.lines[at]), what, "sort the table by time, or make it two runs"));
        }
        let keep: Vec<bool> = (0..times.len()).map(|row| row == 0 || times[row] != times[row - 1]).collect();
        let doubles = keep.iter().filter(|keep| !**keep).count();
        if doubles == 0 {
            return Ok(());
        }
        for column in columns.iter_mut() {
            let mut row = 0;
            while row < times.len() {
                let end = (row + 1..times.len()).find(|next| keep[*next]).unwrap_or(times.len());
                let read = column.values[row..end].iter().filter(|value| value.is_finite());
                let count = read.clone().count();
                if count > 0 {
                    column.values[row] = read.sum::<f64>() / count as f64;
                }
                row = end;
            }
        }
        self.note(
            Severity::Warned,
            match doubles {
                1 => "1 row has the time of the row before; their readings were averaged".to_owned(),
                _ => format!("{doubles} rows have the time of the row before; their readings were averaged"),
            },
        );
        self.retain(columns, &keep);
        Ok(())
    }

    /// Refuses a step in time that no recording makes.
    fn jump(&self, times: &[f64]) -> Result<(), StudyError> {
        let step = |place: usize| times[place] - times[place - 1];
        let Some(longest) = (1..times.len()).max_by(|a, b| step(*a).total_cmp(&step(*b))) else { return Ok(()) };
        let others = times[times.len() - 1] - times[0] - step(longest);
        if times.len() < OTHERS || step(longest) <= JUMP * others {
            return Ok(());
        }
        // The time that stands alone is the first or behind the step.
        let at = if longest == 1 { 0 } else { longest };
        let what = format!("the time jumps from {:?} s to {:?} s", times[longest - 1], times[longest]);
        Err(self.refuse(Some(self.lines[at]), what, "mend that time, or make it two runs"))
    }

    /// Readings that cannot be, whatever was measured.
    fn impossible(&mut self, column: &mut Column, entry: &ColumnEntry, timed: bool) -> Result<(), StudyError> {
        let never_zero = match column.quantity {
            Quantity::Time | Quantity::Command => return Ok(()),
            Quantity::Length | Quantity::AntagonistLength | Quantity::Temperature => true,
            _ => false,
        };
        let (words, unit) = (column.words(), column.quantity.unit());
        let mut found: Vec<(usize, String)> = Vec::new();
        if never_zero {
            let why = |place: usize| (place, format!("where a {words} is above zero"));
            found.extend((0..column.values.len()).filter(|place| column.values[*place] <= 0.0).map(why));
        }
        let factor = match (never_zero, timed) {
            (true, _) => APART[2],
            (false, true) => APART[1],
            (false, false) => APART[0],
        };
        let mut sizes: Vec<(usize, f64)> = column.values.iter().map(|value| value.abs()).enumerate().collect();
        sizes.retain(|(place, size)| size.is_finite() && !found.iter().any(|(of, _)| of == place));
        sizes.sort_by(|(_, a), (_, b)| b.total_cmp(a));
        let largest = apart(&sizes, factor, timed);
        found.extend(largest.iter().map(|(place, times)| (*place, format!("{times:.3e} times the largest other"))));
        if never_zero {
            sizes.reverse();
            let smallest = apart(&sizes, factor, timed);
            found.extend(
                smallest.iter().map(|(place, times)| (*place, format!("{times:.3e} times the smallest other"))),
            );
        }
        let Some((place, why)) = found.first() else { return Ok(()) };
        if !entry.rules.drop_outliers {
            let what =
                format!("the {words} in the column `{}` is {:?} {unit}, {why}", entry.name, column.values[*place]);
            let remedy =
                "mend the cell or empty it, or say drop_outliers = true for this column to leave such cells out";
            return Err(self.refuse(Some(self.lines[*place]), what, remedy));
        }
        let lines: Vec<String> = found.iter().take(5).map(|(place, _)| self.lines[*place].to_string()).collect();
        let text = format!(
            "{} of the {words} cannot be and {} left out (line {}{})",
            readings(found.len()),
            if found.len() == 1 { "was" } else { "were" },
            lines.join(", "),
            if found.len() > lines.len() { ", …" } else { "" }
        );
        self.note(Severity::Warned, text);
        found.iter().for_each(|(place, _)| column.values[*place] = f64::NAN);
        Ok(())
    }

    fn rate(&mut self, times: &[f64]) {
        let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let (Some(usual), Some(largest)) = (median(&steps), steps.iter().copied().reduce(f64::max)) else { return };
        let duration = times[times.len() - 1] - times[0];
        let [mean, usually] = [steps.len() as f64 / duration, 1.0 / usual].map(|rate| rounded(rate, 6));
        let rates = match (mean / usually - 1.0).abs() < UNEVEN {
            true => format!("{mean} a second"),
            false => format!("{mean} a second on average, {usually} by the median step"),
        };
        self.note(Severity::Noted, format!("{}, {rates}", readings(times.len())));
        if largest > 5.0 * usual {
            let at = steps.iter().position(|step| *step == largest).unwrap_or(0);
            self.note(Severity::Warned, format!("a gap of {largest:.4} s after {:.4} s", times[at]));
        }
        let uneven = steps.iter().filter(|step| (*step / usual - 1.0).abs() > 0.1).count();
        if uneven * 20 > steps.len() {
            let text = format!("{uneven} of {} steps in time differ from the usual by more than a tenth", steps.len());
            self.note(Severity::Noted, text);
        }
    }

    /// Takes off what a quantity reads where it is known.
    fn zero(&mut self, column: &mut Column, rules: &Rules, times: &[f64]) -> Result<(), StudyError> {
        let mut known = Vec::new();
        for (span, value) in &rules.zeros {
            let within = times
                .iter()
                .zip(&column.values)
                .filter(|(time, reading)| (span[0]..=span[1]).contains(*time) && reading.is_finite());
            let (sum, at, count) = within
                .fold((0.0, 0.0, 0.0), |(sum, at, count), (time, reading)| (sum + reading, at + time, count + 1.0));
            if count == 0.0 {
                let (of, [from, to]) = (column.words(), span);
                let what = format!("there is no reading of the {of} from {from} s to {to} s, where `zero` needs it");
                return Err(self.refuse(None, what, "choose a span within the recording"));
            }
            known.push((at / count, sum / count - value));
        }
        let (of, unit) = (column.words(), column.quantity.unit());
        let (first, slope) = match known[..] {
            [] => return Ok(()),
            [(_, offset)] => {
                self.note(Severity::Warned, format!("an offset of {offset:.4e} {unit} was taken off the {of}"));
                ((0.0, offset), 0.0)
            }
            [first, .., last] => {
                let slope = (last.1 - first.1) / (last.0 - first.0);
                let text = format!(
                    "an offset of {:.4e} {unit} and a drift of {slope:.4e} {unit}/s were taken off the {of}",
                    first.1
                );
                self.note(Severity::Warned, text);
                (first, slope)
            }
        };
        for (value, time) in column.values.iter_mut().zip(times) {
            *value -= first.1 + slope * (time - first.0);
        }
        Ok(())
    }

    fn outliers(&mut self, column: &mut Column, rules: &Rules) {
        let values = column.values.clone();
        let half = WINDOW / 2;
        // How far each reading lies from the median of its neighbours, and the deviation of these.
        let off = |at: usize| {
            let around: Vec<f64> = (at - half..=at + half)
                .filter(|near| *near != at)
                .map(|near| values[near])
                .filter(|value| value.is_finite())
                .collect();
            let middle = median(&around).filter(|_| values[at].is_finite())?;
            Some((at, values[at] - middle, deviation(around.iter().map(|value| value - middle))))
        };
        let off: Vec<(usize, f64, f64)> = (half..values.len().saturating_sub(half)).filter_map(off).collect();
        let usual = chauvenet(off.len()) * deviation(off.iter().map(|(_, off, _)| *off));
        let is_far = |off: f64, spread: f64| spread > 0.0 && off.abs() > FAR * spread && off.abs() > usual;
        let mut far: Vec<usize> =
            off.iter().filter(|(_, off, spread)| is_far(*off, *spread)).map(|(at, ..)| *at).collect();
        // On a steep edge a reading is far from the median of its neighbours, and yet between those before and behind it, which are not far.
        let all = far.clone();
        let near = |mut places: std::ops::Range<usize>, back: bool| {
            let is_read = |place: &usize| values[*place].is_finite();
            let place = if back { places.rfind(is_read) } else { places.find(is_read) };
            place.filter(|place| !all.contains(place)).map(|place| values[place])
        };
        far.retain(|at| match (near(0..*at, true), near(at + 1..values.len(), false)) {
            (Some(before), Some(behind)) => (values[*at] - before) * (behind - values[*at]) <= 0.0,
            _ => true,
        });
        if rules.drop_outliers {
            far.iter().for_each(|at| column.values[*at] = f64::NAN);
        }
        let found = far.len();
        if found > 0 {
            let [look, were, stay] = match found {
                1 => ["looks like an outlier; it", "was", "stays"],
                _ => ["look like outliers; they", "were", "stay"],
            };
            let done = if rules.drop_outliers {
                format!("{were} left out")
            } else {
                format!("{stay}: say drop_outliers = true, or a robust search")
            };
            let count = readings(found);
            self.note(Severity::Warned, format!("{count} of the {} {look} {done}", column.words()));
        }
    }

    /// Readings at the end of a sensor's range, where each is repeated so often by a sensor that holds it.
    fn ends(&mut self, column: &mut Column, rules: &Rules, repeated: f64) -> Result<(), StudyError> {
        let of = column.words();
        if let Some(end) = rules.saturates {
            let mut gone = 0;
            for value in column.values.iter_mut().filter(|value| **value >= end) {
                *value = f64::NAN;
                gone += 1;
            }
            if gone > 0 {
                self.note(
                    Severity::Warned,
                    match gone {
                        1 => format!("1 reading of the {of} at the end of the sensor was left out"),
                        _ => format!("{gone} readings of the {of} at the end of the sensor were left out"),
                    },
                );
            }
            return Ok(());
        }
        let timed = self.table.columns.len() > 1 && column.quantity != Quantity::Time;
        let (longest, largest) = longest_at_the_end(&column.values);
        let least = column.values.iter().copied().filter(|value| value.is_finite()).fold(f64::INFINITY, f64::min);
        let is_length = matches!(column.quantity, Quantity::Length | Quantity::AntagonistLength);
        let pressed = is_length || column.quantity.is_tension();
        let is_stuck = longest as f64 >= STUCK as f64 * repeated;
        if timed && pressed && largest > least && is_stuck && 50 * longest >= column.values.len() {
            let unit = column.quantity.unit();
            let what = format!(
                "the {of} reads {largest} {unit}, its largest value, {longest} times on end: the sensor is at its end"
            );
            let remedy = format!(
                "say `saturates = \"{largest} {unit}\"` to leave these readings out, or a larger value to keep them"
            );
            return Err(self.refuse(None, what, &remedy));
        }
        Ok(())
    }

    fn slack(&mut self, column: &mut Column, rules: &Rules) {
        if !column.quantity.is_tension() {
            return;
        }
        let noise = rules.deviation.or_else(|| noise_about_zero(&column.values)).filter(|_| rules.slack.is_none());
        let end = rules.slack.unwrap_or(noise.map_or(0.0, |noise| WITHIN_NOISE * noise));
        let mut count = 0;
        for (slack, value) in column.slack.iter_mut().zip(&column.values) {
            *slack = *value <= end;
            count += usize::from(*slack);
        }
        if count > 0 {
            let end = match noise {
                Some(noise) => {
                    let [end, noise] = [end, noise].map(|tension| rounded(tension, 3));
                    format!("{end} N, three times the noise of {noise} N")
                }
                None => format!("{end} N"),
            };
            let text = format!(
                "{} of the {} {} at or below {end}: slack, which says only that the muscle does not pull",
                readings(count),
                column.words(),
                if count == 1 { "is" } else { "are" }
            );
            self.note(Severity::Noted, text);
        }
    }

    fn vacuum(&mut self, column: &Column) {
        let below = column.values.iter().filter(|value| **value < -2e3).count();
        if matches!(column.quantity, Quantity::GaugePressure | Quantity::AntagonistGaugePressure) && below > 0 {
            let text = format!(
                "{below} gauge pressures are more than 2 kPa below zero: an offset, or a muscle that is evacuated"
            );
            self.note(Severity::Warned, text);
        }
    }
}

/// The noise in N of tensions, by those below zero, of few by the farthest: a slack muscle reads as far below zero as above. `None`
/// where there are none, and where they are so far below that they are no noise, as those of a rig that pushes.
fn noise_about_zero(tensions: &[f64]) -> Option<f64> {
    let below: Vec<f64> = tensions.iter().filter(|tension| **tension < 0.0).map(|tension| -tension).collect();
    let largest = tensions.iter().copied().filter(|tension| tension.is_finite()).fold(0.0, f64::max);
    let noise = match below.len() {
        0..OTHERS => below.iter().copied().fold(0.0, f64::max),
        _ => deviation(below),
    };
    (noise > 0.0 && WITHIN_NOISE * noise <= MOST_NOISE * largest).then_some(noise)
}

/// A number with so many digits.
fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value)
}

/// A number of readings in words.
fn readings(count: usize) -> String {
    if count == 1 { "1 reading".to_owned() } else { format!("{count} readings") }
}
