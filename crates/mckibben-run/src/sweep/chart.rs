//! The reductions of a sweep as a figure, by how many keys vary.
//!
//! | what varies | the figure |
//! |---|---|
//! | one key | a line of each reduction over it |
//! | two keys in a grid | a map of each reduction over both |
//! | else | a matrix of scatter plots, reductions over keys, with Spearman's rank correlation ρ |
//!
//! A key whose values are spaced evenly in their logarithm has a logarithmic axis. Runs that failed are gaps, crossed cells, or
//! absent.

use super::counts::SweepCounts;
use crate::failure::Failure;
use crate::quantities::count;
use crate::units::units;
use mckibben::control;
use mckibben_plot::{Axis, Field, Figure, Format, Legend, Panel, PlotError, Scale, Series, SideBySide, Style, Theme};
use mckibben_scenario::sweep::{Quantity, Statistic};
use mckibben_scenario::{AxisKind, AxisValue, PlantReduction, Record, Reduction, Sweep};
use std::path::Path;

/// Panels that a figure has at most, one above the other.
const PANELS: usize = 8;
/// Columns of a matrix at most.
const COLUMNS: usize = 8;
/// Part of the size of values within which they are the same: less is what the tolerances of runs leave.
const SAME: f64 = 1e-6;
/// Points on a line at most that are shown one by one.
const DOTS: usize = 60;

/// Draws the sweep; the bytes of the file.
///
/// # Errors
/// [`Failure::output`], which names `path`, when the figure cannot be drawn.
pub fn draw(
    sweep: &Sweep,
    totals: &SweepCounts,
    title: &str,
    (path, format): (&Path, Format),
) -> Result<Vec<u8>, Failure> {
    let picture = picture(sweep, totals, title);
    picture.bytes(format).map_err(|error| Failure::output(path, error))
}

/// The sweep as SVG.
///
/// # Errors
/// When the figure contradicts itself.
pub fn svg(sweep: &Sweep, totals: &SweepCounts, theme: Theme) -> Result<String, PlotError> {
    match picture(sweep, totals, "") {
        Picture::One(figure) => figure.to_svg(theme),
        Picture::SideBySide(beside) => beside.to_svg(theme),
    }
}

/// A figure, or several side by side.
enum Picture {
    One(Figure),
    SideBySide(SideBySide),
}

impl Picture {
    fn bytes(&self, format: Format) -> Result<Vec<u8>, PlotError> {
        match self {
            Self::One(figure) => figure.bytes(format),
            Self::SideBySide(beside) => beside.bytes(format),
        }
    }
}

/// The values of a varied key or of a reduction in all runs that are drawn, and their axis.
#[derive(Clone, Debug)]
struct Values {
    axis: Axis,
    at: Vec<f64>,
}

impl Values {
    /// The least and the greatest of the values that are numbers.
    fn ends(&self) -> (f64, f64) {
        let finite = self.at.iter().copied().filter(|value| value.is_finite());
        finite.fold((f64::MAX, f64::MIN), |(l, g), value| (l.min(value), g.max(value)))
    }

    /// Whether two of the values differ by more than what is the same.
    fn changes(&self) -> bool {
        let (least, greatest) = self.ends();
        greatest - least > SAME * least.abs().max(greatest.abs())
    }

    /// With an axis around values that are the same, so that it says how large they are and not how they round.
    fn levelled(mut self) -> Self {
        let (least, greatest) = self.ends();
        let around = 0.05 * least.abs().max(greatest.abs());
        if least <= greatest && around > 0.0 && !self.changes() {
            self.axis = self.axis.starting_at(least - around).ending_at(greatest + around);
        }
        self
    }

    fn distinct(&self) -> Vec<f64> {
        let mut distinct = self.at.clone();
        distinct.sort_by(f64::total_cmp);
        distinct.dedup();
        distinct
    }
}

fn picture(sweep: &Sweep, totals: &SweepCounts, title: &str) -> Picture {
    let (kept, stride) = totals.kept();
    let rows: Vec<u64> = kept.keys().copied().collect();
    let mut keys: Vec<Values> = (0..sweep.axes().len()).map(|axis| key(sweep, axis, &rows)).collect();
    // A key with one value says nothing; one of them must stay to have an axis.
    let first = keys.first().cloned();
    keys.retain(|key| key.distinct().len() > 1);
    if keys.is_empty() {
        keys.extend(first);
    }
    let at = |index: usize| -> Vec<f64> { kept.values().map(|values| values[index]).collect() };
    let results: Vec<Values> = match sweep.record() {
        Record::Reductions(list) => list.iter().enumerate().map(|(index, of)| result(*of, at(index))).collect(),
        Record::PlantReductions(list) => {
            let label = |of: &PlantReduction| of.name.replace(['.', '_'], " ");
            list.iter().enumerate().map(|(index, of)| scaled(label(of), of.unit, at(index))).collect()
        }
        Record::Samples(_) | Record::Trajectories => Vec::new(),
    };
    let count_of_all = results.len();
    let results: Vec<Values> =
        results.into_iter().filter(|result| result.at.iter().any(|value| value.is_finite())).collect();
    let mut notes = Vec::new();
    // What is the same in all runs needs no picture, unless there is nothing else.
    let changing: Vec<Values> = results.iter().filter(|result| result.changes()).cloned().collect();
    let results = if changing.is_empty() { results.into_iter().map(Values::levelled).collect() } else { changing };
    let without = count_of_all - results.len();
    if without > 0 {
        notes.push(format!("{without} of {count_of_all} reductions do not change and are left out."));
    }
    if results.len() > PANELS {
        notes.push(format!("The first {PANELS} of {} reductions that change.", results.len()));
    }
    if stride > 1 {
        notes.push(format!("One of {} runs is drawn.", count(stride)));
    }
    let results = &results[..results.len().min(PANELS)];
    match keys.as_slice() {
        [key] => Picture::One(lines(key, results).title(title).caption(notes.join(" "))),
        [x, y] if stride == 1 && is_grid(x, y, sweep.rows()) => {
            if results.iter().any(has_gap) {
                notes.push("Crossed cells: no value.".to_owned());
            }
            Picture::One(maps(x, y, results).title(title).caption(notes.join(" ")))
        }
        keys => {
            if keys.len() > COLUMNS {
                notes.push(format!("The first {COLUMNS} of {} keys.", keys.len()));
            }
            // Words have no order that ranks could be of.
            if keys.iter().any(|key| key.axis.words.is_empty()) {
                notes.push("ρ: rank correlation after Spearman.".to_owned());
            }
            let figures = scatter(&keys[..keys.len().min(COLUMNS)], results);
            Picture::SideBySide(SideBySide {
                title: title.to_owned(),
                caption: notes.join(" "),
                figures,
                ..SideBySide::default()
            })
        }
    }
}

fn has_gap(values: &Values) -> bool {
    values.at.iter().any(|value| !value.is_finite())
}

/// Whether the runs are the cells of a grid of two keys.
fn is_grid(x: &Values, y: &Values, runs: u64) -> bool {
    (x.distinct().len() * y.distinct().len()) as u64 == runs
}

/// A varied key in the rows that are drawn. Words stand at 0, 1, 2, … in the order in which they come.
fn key(sweep: &Sweep, axis: usize, rows: &[u64]) -> Values {
    let of = &sweep.axes()[axis];
    let mut words: Vec<String> = Vec::new();
    let at: Vec<f64> = rows
        .iter()
        .map(|row| match sweep.value(axis, *row) {
            AxisValue::Number(number) => number,
            AxisValue::Word(word) => {
                let known = words.iter().position(|known| known == word);
                known.unwrap_or_else(|| {
                    words.push(word.to_owned());
                    words.len() - 1
                }) as f64
            }
        })
        .collect();
    let label = of.path.replace(['.', '_'], " ");
    match &of.kind {
        AxisKind::Quantity { unit, .. } => {
            let mut values = scaled(label, unit, at);
            if of.is_logarithmic() {
                values.axis.scale = Scale::Logarithmic;
            }
            values
        }
        AxisKind::Word => {
            let words = words.into_iter().enumerate().map(|(index, word)| (index as f64, word));
            Values { axis: Axis::new(label, "").words(words), at }
        }
    }
}

/// A reduction in the rows that are drawn.
fn result(reduction: Reduction, at: Vec<f64>) -> Values {
    let quantity = match reduction.quantity {
        Quantity::Length => "length",
        Quantity::Velocity => "velocity",
        Quantity::AbsolutePressure => "absolute pressure",
        Quantity::GaugePressure => "gauge pressure",
        Quantity::AirMass => "air mass",
        Quantity::Temperature => "temperature",
        Quantity::Tension => "tension",
        Quantity::MassFlow => "mass flow",
        Quantity::Air => "air",
        Quantity::Exergy => "exergy",
        Quantity::Angle => "angle",
        Quantity::AngularVelocity => "angular velocity",
        Quantity::Torque => "torque",
        Quantity::Stiffness => "stiffness",
        Quantity::AntagonistLength => "antagonist's length",
        Quantity::AntagonistAbsolutePressure => "antagonist's absolute pressure",
        Quantity::AntagonistGaugePressure => "antagonist's gauge pressure",
        Quantity::AntagonistAirMass => "antagonist's air mass",
        Quantity::AntagonistTension => "antagonist's tension",
        Quantity::Error(of) => match of {
            control::Quantity::Pressure => "gauge pressure error",
            control::Quantity::Length => "length error",
            control::Quantity::AirMass => "air mass error",
            control::Quantity::Force => "tension error",
            control::Quantity::Angle => "angle error",
            control::Quantity::Torque => "torque error",
            control::Quantity::Stiffness => "stiffness error",
        },
    };
    let label = match reduction.statistic {
        Statistic::Final => format!("final {quantity}"),
        Statistic::Mean => format!("mean {quantity}"),
        Statistic::Min => format!("least {quantity}"),
        Statistic::Max => format!("greatest {quantity}"),
        Statistic::Peak => format!("peak {quantity}"),
        Statistic::Rms => format!("rms {quantity}"),
        Statistic::Ripple => format!("{quantity} ripple"),
        Statistic::Drift => format!("{quantity} drift"),
        Statistic::SettlingTime => format!("{quantity} settling time"),
        Statistic::Overshoot => format!("{quantity} overshoot"),
        Statistic::Used => format!("{quantity} used"),
        Statistic::Efficiency => format!("{quantity} efficiency"),
    };
    scaled(label, reduction.unit(), at)
}

/// Values in the unit that is chosen for them, with the prefix of their size.
fn scaled(label: String, unit: &str, at: Vec<f64>) -> Values {
    let shown = units().for_name(&label).common(unit, at.iter().copied());
    Values { axis: Axis::new(label, shown.text.clone()), at: at.into_iter().map(|value| shown.number(value)).collect() }
}

/// The width in mm of a figure whose words along the horizontal axis do not touch; zero where numbers stand there.
fn width_of_words(key: &Values) -> f64 {
    /// Widths of a wide letter of a tick, of a gap between two words, and of what stands beside the axes, in mm.
    const LETTER: f64 = 1.6;
    const GAP: f64 = 2.0;
    const BESIDE: f64 = 18.0;
    let words = &key.axis.words;
    let longest = words.iter().map(|(_, word)| word.chars().count()).max();
    longest.map_or(0.0, |longest| BESIDE + words.len() as f64 * (LETTER * longest as f64 + GAP))
}

/// A panel for each reduction over one key.
fn lines(key: &Values, results: &[Values]) -> Figure {
    let mut order: Vec<usize> = (0..key.at.len()).collect();
    order.sort_by(|a, b| key.at[*a].total_cmp(&key.at[*b]));
    let sorted = |values: &Values| -> Vec<f64> { order.iter().map(|index| values.at[*index]).collect() };
    let style = match (key.axis.words.is_empty(), order.len()) {
        (false, _) => Style::Points,
        (true, ..=DOTS) => Style::LineAndPoints,
        (true, _) => Style::Line,
    };
    let panels = results.iter().map(|result| {
        let series = Series { style, ..Series::line("", sorted(key), sorted(result)) };
        Panel::new(result.axis.clone()).series(series)
    });
    panels.fold(Figure::new(key.axis.clone()), Figure::panel).size_mm(width_of_words(key).max(100.0), 28.0)
}

/// A map for each reduction over two keys.
fn maps(x: &Values, y: &Values, results: &[Values]) -> Figure {
    let (columns, rows) = (x.distinct(), y.distinct());
    let place = |of: &[f64], value: f64| of.binary_search_by(|known| known.total_cmp(&value)).unwrap_or(0);
    let panels = results.iter().map(|result| {
        let mut values = vec![f64::NAN; columns.len() * rows.len()];
        for ((x, y), value) in x.at.iter().zip(&y.at).zip(&result.at) {
            values[place(&rows, *y) * columns.len() + place(&columns, *x)] = *value;
        }
        let (label, unit) = (result.axis.label.clone(), result.axis.unit.clone());
        let field = Field { label, unit, x: columns.clone(), y: rows.clone(), values };
        Panel::new(beyond_zero(&y.axis, &rows)).field(field)
    });
    panels.fold(Figure::new(beyond_zero(&x.axis, &columns)), Figure::panel).size_mm(width_of_words(x).max(110.0), 36.0)
}

/// The axis of a map over rising values: cells reach half way beyond the outer ones, but not below zero where no value is.
fn beyond_zero(axis: &Axis, values: &[f64]) -> Axis {
    let axis = axis.clone();
    match values {
        [first, second, ..]
            if axis.scale == Scale::Linear && axis.words.is_empty() && *first > 0.0 && *second > 3.0 * first =>
        {
            axis.starting_at(0.0)
        }
        _ => axis,
    }
}

/// A figure for each key, with a panel for each reduction.
fn scatter(keys: &[Values], results: &[Values]) -> Vec<Figure> {
    let columns = keys.iter().enumerate().map(|(column, key)| {
        let panels = results.iter().map(|result| {
            let mut axis = result.axis.clone();
            if column > 0 {
                // The first column has named it.
                (axis.label, axis.unit) = (String::new(), String::new());
            }
            let correlation = match rank_correlation(&key.at, &result.at) {
                // A line over each panel, so that those of a row stand at one height.
                _ if !key.axis.words.is_empty() => "words: no ρ".to_owned(),
                // Adding zero turns a rounded −0 into 0.
                Some(correlation) => {
                    format!("ρ = {:.2}", (100.0 * correlation).round() / 100.0 + 0.0).replace('-', "−")
                }
                None => "ρ: none".to_owned(),
            };
            let points = Series::dots(correlation, key.at.clone(), result.at.clone());
            Panel::new(axis).series(points).legend(Legend::Above)
        });
        let width = if column == 0 { 58.0_f64 } else { 50.0 };
        let width = width.max(width_of_words(key));
        panels.fold(Figure::new(key.axis.clone()), Figure::panel).size_mm(width, 26.0)
    });
    columns.collect()
}

/// Spearman's rank correlation of the pairs that are numbers; none where one of them does not change.
fn rank_correlation(x: &[f64], y: &[f64]) -> Option<f64> {
    let pairs: Vec<(f64, f64)> =
        x.iter().copied().zip(y.iter().copied()).filter(|(x, y)| x.is_finite() && y.is_finite()).collect();
    let (x, y) = (ranks(pairs.iter().map(|pair| pair.0)), ranks(pairs.iter().map(|pair| pair.1)));
    let mean = 0.5 * (pairs.len() as f64 - 1.0);
    let product = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| (a - mean) * (b - mean)).sum() };
    let correlation = product(&x, &y) / (product(&x, &x) * product(&y, &y)).sqrt();
    correlation.is_finite().then_some(correlation)
}

/// Ranks from 0; equal values share the mean of theirs.
fn ranks(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sorted: Vec<(usize, f64)> = values.enumerate().collect();
    sorted.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut ranks = vec![0.0; sorted.len()];
    let mut first = 0;
    for tie in sorted.chunk_by(|a, b| a.1 == b.1) {
        let rank = first as f64 + 0.5 * (tie.len() as f64 - 1.0);
        tie.iter().for_each(|(index, _)| ranks[*index] = rank);
        first += tie.len();
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_that_are_spaced_by_their_logarithm_have_logarithmic_axes() {
        let text = r#"
            [load]
            kind = "hanging-mass"
            [initial]
            gauge_pressure = "60 psi"
            [run]
            duration = "20 ms"
            [sweep]
            reductions = ["length.final"]
            [sweep.vary]
            "load.mass" = { from = "1 kg", to = "4 kg", count = 3, spacing = "logarithmic" }
            "initial.temperature" = { from = "290 K", to = "300 K", count = 2 }
        "#;
        let sweep = mckibben_scenario::Document::parse(text, "sweep.toml").unwrap().sweep().unwrap().unwrap();
        let masses = key(&sweep, 0, &[0, 2, 4]);
        assert_eq!((masses.axis.scale, masses.at.len()), (Scale::Logarithmic, 3));
        assert!((masses.at[1] - 2.0).abs() < 1e-12, "the middle of 1 kg and 4 kg by the logarithm");
        assert_eq!(key(&sweep, 1, &[0, 1]).axis.scale, Scale::Linear);
    }

    /// From 0.1 L to 1.1 L are two halves of 0.5 L: the cell about 0.1 L would begin at −0.4 L, where there is no volume.
    #[test]
    fn a_map_of_values_above_zero_begins_at_zero_at_the_lowest() {
        let values = |at: &[f64]| Values { axis: Axis::new("volume", "L"), at: at.to_vec() };
        let of = |low: &[f64]| {
            let x: Vec<f64> = low.iter().flat_map(|low| [*low; 2]).collect();
            let y: Vec<f64> = low.iter().flat_map(|_| [1.0, 2.0]).collect();
            let result = values(&vec![1.0; x.len()]);
            let figure = maps(&values(&x), &values(&y), &[result]);
            (figure.x.min, figure.panels[0].y.min)
        };
        assert_eq!(of(&[0.1, 1.1, 2.1]), (Some(0.0), None));
        assert_eq!(of(&[0.6, 1.6]), (None, None));
        assert_eq!(of(&[-1.0, 1.0]), (None, None));
    }

    /// Words have no order, and so no rank correlation; four long ones have room beside each other. Letters of a tick are 1.6 mm
    /// wide at most.
    #[test]
    fn words_have_room_and_no_rank_correlation() {
        let named = ["isentropic", "isothermal", "polytropic", "energy-balance"];
        let words = named.iter().zip(0..).map(|(word, at)| (f64::from(at), (*word).to_owned()));
        let words = Values { axis: Axis::new("air process", "").words(words), at: vec![0.0, 1.0, 2.0, 3.0] };
        let number = Values { axis: Axis::new("load mass", "kg"), at: vec![1.0, 2.0, 3.0, 4.0] };
        let result = Values { axis: Axis::new("final length", "m"), at: vec![0.1, 0.2, 0.3, 0.4] };
        let [of_words, of_number] = &scatter(&[words, number], &[result])[..] else { panic!("two figures") };
        let labels = |figure: &Figure| figure.panels[0].series[0].label.clone();
        assert_eq!([labels(of_words), labels(of_number)], ["words: no ρ", "ρ = 1.00"]);
        assert!(of_words.width_mm > 4.0 * 1.6 * 14.0 && of_number.width_mm < 60.0, "{}", of_words.width_mm);
    }

    /// Lengths that differ by their rounding are one length, on an axis around it; those that differ by more span theirs.
    #[test]
    fn what_does_not_change_is_drawn_around_its_value() {
        let of = |step: f64| scaled("length".to_owned(), "m", vec![0.2, 0.2 + step, f64::NAN]).levelled();
        let level = of(1e-8);
        assert!(!level.changes());
        let (low, high) = (level.axis.min.unwrap(), level.axis.max.unwrap());
        assert!(high - low > 0.09 * level.at[0] && low < level.at[0] && level.at[0] < high, "{:?}", level.axis);
        let changing = of(1e-6);
        assert!(changing.changes() && changing.axis.min.is_none() && changing.axis.max.is_none());
        assert_eq!(scaled("length".to_owned(), "m", vec![f64::NAN]).levelled().axis.min, None);
    }

    #[test]
    fn ranks_correlate_whatever_the_scale() {
        let x: Vec<f64> = (0..50).map(f64::from).collect();
        let cubes: Vec<f64> = x.iter().map(|x| (x - 20.0).powi(3)).collect();
        let falling: Vec<f64> = x.iter().map(|x| (-x).exp()).collect();
        assert!((rank_correlation(&x, &cubes).unwrap() - 1.0).abs() < 1e-12);
        assert!((rank_correlation(&x, &falling).unwrap() + 1.0).abs() < 1e-12);
        assert_eq!(rank_correlation(&x, &[1.0; 50]), None);
        // With ties: the textbook's (1, 2, 2, 3) against (1, 3, 2, 4) is 0.9487.
        let tied = rank_correlation(&[1.0, 2.0, 2.0, 3.0], &[1.0, 3.0, 2.0, 4.0]).unwrap();
        assert!((tied - 0.9f64.sqrt()).abs() < 1e-12, "{tied}");
    }
}
