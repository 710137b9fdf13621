//! Delays of a valve's poppet from the pressure under a pulse train.
//!
//! ```text
//! about an edge  P = a + s₁ u + q₁ u² + r₁ u³  before,  a + s₂ u + q₂ u² + r₂ u³  after the onset     u = t − t_onset
//! delay          = onset − edge                                        opening after energised, closing after released
//! effective duty = (closing onset − opening onset)/period
//! paper's way    effective duty = d − (t_open − t_close) f              several frequencies or duties
//! ```
//!
//! Each onset is found by least squares to a fraction of the sample interval, from the samples between the middle of the
//! pause before the edge and the next edge, then from fewer and fewer about the onset, down to eight on a side. A delay
//! longer than half of the pause is not seen. An edge where the pressure does not change by four standard deviations counts as
//! missed: a pulse shorter than `t_open` does not open the valve.
//!
//! Cubics are not enough for every window: the flow bends where it ceases to be choked and where the pressures become equal.
//! The window is the widest whose mean delay agrees with those of all narrower ones to two standard errors of the difference
//! (Lepskii's rule), one for the openings and one for the closings. What cubics lack grows at least with the square of the width,
//! so the difference from a window half as wide, or its standard error where that is larger, is the error of the model,
//! [`Windows::model_error`]. With it intervals hold the truth in more than 95 of 100 trials where the cubics are right.
//!
//! Intervals are those of the mean over the pulses, from their scatter and the error of the model; of a single pulse, its fit
//! takes the place of the scatter. The paper's way gives only the difference of the delays. A poppet with a travel time
//! makes an onset where the two curves cross.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 3.3 and Fig. 10; the solenoid is [`mckibben::valve::Solenoid`]. Checked by
//! `tests/valve.rs`.

use super::ValveError;
use crate::least_squares::{Estimate, Evaluation, Model, Search, Unknown, fit};
use crate::median::median;
use crate::propagation;
use crate::series;
use mckibben::internals::lowest;
use nalgebra::{DMatrix, DVector};

/// The onset, the pressure there, and two cubics.
const UNKNOWNS: usize = 8;
/// Which of the seven other than the onset is the change of slope.
const CHANGE: usize = 2;
/// Samples from an edge's pause to the next edge: the unknowns, and some for the scatter.
const LEAST_SAMPLES: usize = 16;
/// Of a window on either side of the onset.
const ON_A_SIDE: usize = 5;
/// Samples on a side of the narrowest window, and how much wider the next one is.
const NARROWEST: (f64, f64) = (8.0, std::f64::consts::SQRT_2);
/// Steps to half of the width.
const HALF: usize = 2;
/// Standard errors of their difference up to which two windows agree, and beyond which the narrowest and the next contradict each other.
const AGREES: f64 = 2.0;
const CONTRADICTS: f64 = 3.0;
/// Standard errors by which the slope must change at an onset.
const CLEAR: f64 = 4.0;
/// Golden sections of three sample intervals: to a millionth of one.
const SECTIONS: u32 = 30;

/// When the coil is energised and released.
#[derive(Clone, Debug, PartialEq)]
pub struct PulseTrain {
    /// Times in s and whether the coil is energised from then on, by turns.
    edges: Vec<(f64, bool)>,
}

impl PulseTrain {
    /// Times in s at which the coil is energised, and at which it is released.
    ///
    /// # Errors
    /// [`ValveError::Misuse`] unless the times are finite and come by turns.
    pub fn new(energised: &[f64], released: &[f64]) -> Result<Self, ValveError> {
        let all = energised.iter().map(|time| (*time, true)).chain(released.iter().map(|time| (*time, false)));
        let mut edges: Vec<(f64, bool)> = all.collect();
        edges.sort_by(|a, b| a.0.total_cmp(&b.0));
        let in_turn = edges.windows(2).all(|pair| pair[0].1 != pair[1].1 && pair[0].0 < pair[1].0);
        match in_turn && edges.iter().all(|edge| edge.0.is_finite()) {
            true => Ok(Self { edges }),
            false => Err(ValveError::Misuse {
                what: "the coil is not energised and released by turns",
                remedy: "give each time at which it is energised once, and the time of its release",
            }),
        }
    }

    /// A number of `pulses` at a `frequency` in Hz with a commanded `duty`, the first at t = 0.
    ///
    /// # Errors
    /// [`ValveError::Misuse`] for a frequency that is not above zero or a duty that is not between 0 and 1.
    pub fn pwm(frequency: f64, duty: f64, pulses: usize) -> Result<Self, ValveError> {
        if !(frequency > 0.0 && frequency.is_finite() && duty > 0.0 && duty < 1.0) {
            return Err(ValveError::Misuse {
                what: "the frequency is not above zero or the duty not between 0 and 1",
                remedy: "give hertz, and the duty as a fraction: 50 % is 0.5",
            });
        }
        let time = |pulse: usize, part: f64| (pulse as f64 + part) / frequency;
        let [energised, released] =
            [0.0, duty].map(|part| (0..pulses).map(|pulse| time(pulse, part)).collect::<Vec<_>>());
        Self::new(&energised, &released)
    }

    /// Of a `command` at each `time` in s: energised while above a `threshold`, each edge on the straight line between the two
    /// samples about it.
    ///
    /// # Errors
    /// [`ValveError::Series`] for samples that are no series, [`ValveError::Misuse`] when the threshold is never crossed.
    pub fn of_command(time: &[f64], command: &[f64], threshold: f64) -> Result<Self, ValveError> {
        series::check(time, command, "the command", 2)?;
        let above = |place: usize| command[place] > threshold;
        let crossing = |place: usize| {
            let part = (threshold - command[place - 1]) / (command[place] - command[place - 1]);
            (time[place - 1] + part * (time[place] - time[place - 1]), above(place))
        };
        let edges: Vec<_> = (1..time.len()).filter(|place| above(*place) != above(place - 1)).map(crossing).collect();
        match edges.is_empty() {
            false => Ok(Self { edges }),
            true => Err(ValveError::Misuse {
                what: "the command never crosses the threshold",
                remedy: "give a threshold between its two values, and a record with pulses",
            }),
        }
    }

    /// Shifts the pulses by `later` s, and keeps those within a span of time in s.
    #[must_use]
    pub fn within(mut self, later: f64, [from, to]: [f64; 2]) -> Self {
        self.edges.iter_mut().for_each(|edge| edge.0 += later);
        self.edges.retain(|edge| (from..=to).contains(&edge.0));
        self
    }

    /// Exchanges energised and released, as for the coil of a normally open valve.
    #[must_use]
    pub fn turned(mut self) -> Self {
        self.edges.iter_mut().for_each(|edge| edge.1 = !edge.1);
        self
    }

    /// Times in s and whether the coil is energised from then on, in order.
    pub fn edges(&self) -> &[(f64, bool)] {
        &self.edges
    }

    /// Mean frequency in Hz and mean duty of whole periods; `None` without any.
    pub fn frequency_and_duty(&self) -> Option<[f64; 2]> {
        let first = self.edges.iter().position(|edge| edge.1)?;
        let whole = (self.edges.len() - first - 1) / 2;
        let edges = &self.edges[first..=first + 2 * whole];
        let span = edges.last()?.0 - edges.first()?.0;
        let open: f64 = edges.windows(2).filter(|pair| pair[0].1).map(|pair| pair[1].0 - pair[0].0).sum();
        (whole > 0).then(|| [whole as f64 / span, open / span])
    }
}

/// When the pressure began to change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Onset {
    /// When the coil was energised or released, in s.
    pub edge: f64,
    /// Whether it was energised.
    pub energised: bool,
    /// When the pressure changed, in s.
    pub time: f64,
    /// Standard deviation of that in s.
    pub deviation: f64,
}

/// How many samples about an onset are fitted, and how much the delay depends on that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Windows {
    /// Samples on a side at most.
    pub samples: usize,
    /// How far the mean delay differs from that of a window half as wide in s, or the standard error of that; of the narrowest, from
    /// that of the next wider.
    pub model_error: f64,
    /// Whether no other window confirms it: too few samples lie between the bends of the pressure.
    pub unconfirmed: bool,
}

/// Delays of a poppet.
#[derive(Clone, Debug, PartialEq)]
pub struct Delays {
    /// From energised to the opening, t_open in s.
    pub opening: Estimate,
    /// From released to the closing, t_close in s.
    pub closing: Estimate,
    /// Share of a period in which the valve is open; `None` without two pulses that can be seen.
    pub effective_duty: Option<Estimate>,
    /// The windows of the openings and of the closings.
    pub windows: [Windows; 2],
    /// The onsets in order of time.
    pub onsets: Vec<Onset>,
    /// Edges without an onset.
    pub missed: usize,
}

impl Delays {
    /// Of a pulse train and the `pressure` in Pa, gauge or absolute, at each `time` in s.
    ///
    /// # Errors
    /// [`ValveError::Series`] for samples that are no series, [`ValveError::NoOnset`] when the pressure answers to no edge, and
    /// [`ValveError::Coarse`] when there are too few samples to see it.
    pub fn find(time: &[f64], pressure: &[f64], train: &PulseTrain) -> Result<Self, ValveError> {
        series::check(time, pressure, "the pressure", LEAST_SAMPLES)?;
        let last = time[time.len() - 1];
        let edges = &train.edges;
        let mut fits = Vec::new();
        // Of edges with too few samples: whether the coil is energised, the samples, and the time in s that they take.
        let mut coarse: Vec<(bool, usize, f64)> = Vec::new();
        for (place, (edge, energised)) in edges.iter().enumerate() {
            let from = match place.checked_sub(1) {
                Some(before) => 0.5 * (edges[before].0 + edge),
                None => time[0],
            };
            let to = edges.get(place + 1).map_or(last, |next| next.0);
            let samples = series::between(time, from, to).len();
            // Edges beyond the record have none, and more often would not help.
            if samples < LEAST_SAMPLES && from >= time[0] && from < to && to <= last {
                coarse.push((*energised, samples, to - from));
            }
            fits.extend(Fits::of(time, pressure, [from, *edge, to]).map(|fits| (*edge, *energised, fits)));
        }
        let missed = edges.len() - fits.len();
        let [(opening_width, opening_windows), (closing_width, closing_windows)] = [true, false]
            .map(|energised| width(&fits.iter().filter(|of| of.1 == energised).map(|of| &of.2).collect::<Vec<_>>()));
        let windows = [opening_windows, closing_windows];
        let onset = |(edge, energised, fits): &(f64, bool, Fits)| {
            let [time, deviation] = fits.at(if *energised { opening_width } else { closing_width });
            Onset { edge: *edge, energised: *energised, time, deviation }
        };
        let onsets: Vec<Onset> = fits.iter().map(onset).collect();
        let delay = |energised: bool| {
            mean_delay(&onsets, energised, windows[usize::from(!energised)].model_error).ok_or_else(|| {
                let coil = if energised { "energised" } else { "released" };
                let edges = edges.iter().filter(|edge| edge.1 == energised).count();
                let few = coarse.iter().filter(|few| few.0 == energised);
                match few.clone().count() {
                    // The edges at the ends of a record may have few samples, or many.
                    count if count > 0 && count + 2 >= edges => ValveError::Coarse {
                        coil,
                        edges,
                        coarse: count,
                        samples: few.clone().map(|few| few.1).max().unwrap_or(0),
                        least: LEAST_SAMPLES,
                        rate: LEAST_SAMPLES as f64 / median(&few.map(|few| few.2).collect::<Vec<_>>()).unwrap_or(0.0),
                    },
                    _ => ValveError::NoOnset { coil, edges },
                }
            })
        };
        let (opening, closing) = (delay(true)?, delay(false)?);
        // Opening, closing, and the next opening: one whole period.
        let duty = |three: &[Onset]| {
            let whole = three[0].energised && !three[1].energised && three[2].energised;
            whole.then(|| (three[1].time - three[0].time) / (three[2].time - three[0].time))
        };
        let duties: Vec<f64> = onsets.windows(3).filter_map(duty).collect();
        let period = train.frequency_and_duty().map_or(f64::INFINITY, |[frequency, _]| 1.0 / frequency);
        let model_error = windows[0].model_error.hypot(windows[1].model_error) / period;
        let effective_duty = (!duties.is_empty())
            .then(|| widened(propagation::mean(("effective_duty", ""), &duties), model_error, duties.len() - 1));
        Ok(Self { opening, closing, effective_duty, windows, onsets, missed })
    }

    /// Opening and closing delay in s over all pulses of several records of one valve; `None` for no records.
    pub fn over_all(records: &[Self]) -> Option<[Estimate; 2]> {
        let onsets: Vec<Onset> = records.iter().flat_map(|record| record.onsets.iter().copied()).collect();
        // Each pulse has its record's: such errors do not average out.
        let model_error = |energised: bool| {
            let count =
                |record: &Self| record.onsets.iter().filter(|onset| onset.energised == energised).count() as f64;
            let of = |record: &Self| count(record) * record.windows[usize::from(!energised)].model_error;
            records.iter().map(of).sum::<f64>() / records.iter().map(count).sum::<f64>().max(1.0)
        };
        let delay = |energised: bool| mean_delay(&onsets, energised, model_error(energised));
        Some([delay(true)?, delay(false)?])
    }
}

/// An estimate whose standard error also holds the error of a model.
fn widened(estimate: Estimate, model_error: f64, degrees_of_freedom: usize) -> Estimate {
    let Some(standard_error) = estimate.standard_error.map(|error| error.hypot(model_error)) else { return estimate };
    let wide = propagation::estimate(("", ""), estimate.value, standard_error, degrees_of_freedom);
    Estimate { name: estimate.name, unit: estimate.unit, ..wide }
}

/// Mean delay of the openings or of the closings; of a single one, with its standard error.
fn mean_delay(onsets: &[Onset], energised: bool, model_error: f64) -> Option<Estimate> {
    let label = (if energised { "opening_delay" } else { "closing_delay" }, "s");
    let seen: Vec<&Onset> = onsets.iter().filter(|onset| onset.energised == energised).collect();
    match seen[..] {
        [] => None,
        [only] => {
            let freedom = 2 * samples_on_a_side(0) - UNKNOWNS;
            let deviation = only.deviation.hypot(model_error);
            Some(propagation::estimate(label, only.time - only.edge, deviation, freedom))
        }
        _ => {
            let delays: Vec<f64> = seen.iter().map(|onset| onset.time - onset.edge).collect();
            Some(widened(propagation::mean(label, &delays), model_error, delays.len() - 1))
        }
    }
}

/// Samples on a side of the window of a width; 0 is the narrowest.
fn samples_on_a_side(width: usize) -> usize {
    (NARROWEST.0 * NARROWEST.1.powi(width as i32)).round() as usize
}

/// The onset after one edge by windows of several widths: time in s and standard error.
struct Fits {
    /// The width of the first.
    narrowest: usize,
    /// In rising order of width.
    of_widths: Vec<[f64; 2]>,
}

impl Fits {
    /// Between the beginning of a window and its end, after an edge; `None` where there is no onset.
    fn of(time: &[f64], pressure: &[f64], [from, edge, to]: [f64; 3]) -> Option<Self> {
        let all = series::between(time, from, to);
        let fit =
            |range: std::ops::Range<usize>| Bend { time: &time[range.clone()], pressure: &pressure[range] }.fit(edge);
        let first = (all.len() >= LEAST_SAMPLES).then(|| fit(all.clone())).flatten()?;
        let place = |instant: f64| time.partition_point(|at| *at < instant).clamp(all.start, all.end);
        let longest = (all.end - place(first[0])).max(place(first[0]) - all.start);
        let mut width = (0..).take_while(|width| samples_on_a_side(*width) < longest).count();
        let mut of_widths = vec![first];
        // Each about the onset by the wider one; where noise hides the bend of a narrow one, those before it stay.
        while let Some(narrower) = width.checked_sub(1) {
            let (samples, middle) = (samples_on_a_side(narrower), place(of_widths[of_widths.len() - 1][0]));
            let range = middle.saturating_sub(samples).max(all.start)..(middle + samples).min(all.end);
            let Some(found) = fit(range) else { break };
            of_widths.push(found);
            width = narrower;
        }
        of_widths.reverse();
        Some(Self { narrowest: width, of_widths })
    }

    /// By the window of a width, or the nearest width that there is.
    fn at(&self, width: usize) -> [f64; 2] {
        self.of_widths[width.saturating_sub(self.narrowest).min(self.of_widths.len() - 1)]
    }

    fn widest(&self) -> usize {
        self.narrowest + self.of_widths.len() - 1
    }
}

/// The widest window whose mean onset agrees with that of all narrower ones.
fn width(fits: &[&Fits]) -> (usize, Windows) {
    let count = fits.len().max(1) as f64;
    let narrowest = fits.iter().map(|of| of.narrowest).min().unwrap_or(0);
    let widest = fits.iter().map(|of| of.widest()).max().unwrap_or(0);
    // The mean of the differences by two windows, narrow and wide, and its standard error: from their scatter over three pulses or more.
    let compared = |narrow: usize, wide: usize| {
        let differences: Vec<f64> = fits.iter().map(|of| of.at(wide)[0] - of.at(narrow)[0]).collect();
        let mean = differences.iter().sum::<f64>() / count;
        let squares: f64 = match fits.len() {
            0..=2 => fits.iter().map(|of| of.at(narrow)[1].powi(2)).sum(),
            _ => differences.iter().map(|of| (of - mean).powi(2)).sum::<f64>() * count / (count - 1.0),
        };
        [mean.abs(), squares.sqrt() / count]
    };
    let agree = |[difference, error]: [f64; 2], times: f64| difference <= times * error;
    let agrees = |wide: &usize| (narrowest..*wide).all(|narrow| agree(compared(narrow, *wide), AGREES));
    let width = (narrowest + 1..=widest).take_while(agrees).last().unwrap_or(narrowest);
    let [narrow, wide] = if width == narrowest {
        [narrowest, narrowest + 1]
    } else {
        [width.saturating_sub(HALF).max(narrowest), width]
    };
    let model_error = compared(narrow, wide).into_iter().fold(0.0, f64::max);
    let contradicted = || !agree(compared(narrowest, narrowest + 1), CONTRADICTS);
    let unconfirmed = width == narrowest && (widest == narrowest || contradicted());
    (width, Windows { samples: samples_on_a_side(width), model_error, unconfirmed })
}

/// Samples whose slope changes once.
struct Bend<'a> {
    time: &'a [f64],
    pressure: &'a [f64],
}

impl Bend<'_> {
    /// When it does, after an edge, with the standard error; `None` when it does not.
    fn fit(&self, edge: f64) -> Option<[f64; 2]> {
        let count = self.time.len();
        if count < UNKNOWNS.max(2 * ON_A_SIDE) + 1 {
            return None;
        }
        let squares = |onset: f64| self.two_polynomials(onset).map_or(f64::INFINITY, |fitted| fitted.squares);
        let middle = |place: usize| 0.5 * (self.time[place - 1] + self.time[place]);
        let places = (ON_A_SIDE..=count - ON_A_SIDE).filter(|place| middle(*place) >= edge);
        let best = places.min_by(|a, b| squares(middle(*a)).total_cmp(&squares(middle(*b))))?;
        let onset = lowest([self.time[best - 2], self.time[best + 1]], SECTIONS, squares);
        let found = self.two_polynomials(onset)?;
        let variance = found.squares / (count - UNKNOWNS) as f64;
        // The derivative with respect to the onset in addition to those with respect to the five numbers.
        let slopes = DMatrix::from_fn(count, UNKNOWNS, |row, column| {
            let u = (self.time[row] - onset) / found.span;
            match column.checked_sub(1) {
                Some(column) => terms(u)[column],
                None => rates(u).iter().zip(&found.numbers).map(|(rate, number)| -rate * number).sum(),
            }
        });
        let covariance = (slopes.transpose() * slopes).cholesky()?.inverse() * variance;
        let clear = found.numbers[CHANGE].abs() > CLEAR * covariance[(1 + CHANGE, 1 + CHANGE)].sqrt();
        let deviation = found.span * covariance[(0, 0)].sqrt();
        (clear && deviation.is_finite()).then_some([onset, deviation])
    }

    /// The two cubics that fit best about an onset; without it they are linear in what is unknown.
    fn two_polynomials(&self, onset: f64) -> Option<TwoPolynomials> {
        let count = self.time.len();
        let span = self.time[count - 1] - self.time[0];
        // About the mean, so that the roundings of a large pressure do not count.
        let mean = self.pressure.iter().sum::<f64>() / count as f64;
        let design =
            DMatrix::from_fn(count, UNKNOWNS - 1, |row, column| terms((self.time[row] - onset) / span)[column]);
        let pressures = DVector::from_fn(count, |row, _| self.pressure[row] - mean);
        let numbers = (design.transpose() * &design).cholesky()?.solve(&(design.transpose() * &pressures));
        let squares = (pressures - design * &numbers).norm_squared();
        Some(TwoPolynomials { numbers: numbers.iter().copied().collect(), squares, span })
    }
}

/// Two cubics that meet at an onset.
struct TwoPolynomials {
    /// The pressure there less the mean, the slope before, the change of slope, both curvatures, both third terms; over the
    /// span.
    numbers: Vec<f64>,
    /// Sum of squares of the residuals.
    squares: f64,
    /// Time in s from the first sample to the last, which times are over.
    span: f64,
}

/// What each of the seven numbers is multiplied by, at a time from the onset.
fn terms(u: f64) -> [f64; UNKNOWNS - 1] {
    let (before, after) = (u.min(0.0), u.max(0.0));
    [1.0, u, after, before.powi(2), after.powi(2), before.powi(3), after.powi(3)]
}

/// The derivatives of these with respect to time.
fn rates(u: f64) -> [f64; UNKNOWNS - 1] {
    let (before, after) = (u.min(0.0), u.max(0.0));
    let bent = f64::from(u8::from(u >= 0.0));
    [0.0, 1.0, bent, 2.0 * before, 2.0 * after, 3.0 * before.powi(2), 3.0 * after.powi(2)]
}

/// A duty cycle that was commanded, and the one that came of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DutyPoint {
    /// Frequency in Hz.
    pub frequency: f64,
    /// Commanded duty, 0 to 1.
    pub commanded: f64,
    /// Effective duty, 0 to 1.
    pub effective: f64,
}

/// `t_open − t_close` in s of duties at several frequencies or duties, by least squares: what they lack over the frequency.
///
/// # Errors
/// [`ValveError::TooFewPoints`] for less than two, [`ValveError::Implausible`] for a duty outside 0 to 1 or a frequency that
/// is not above zero.
pub fn delay_difference(points: &[DutyPoint]) -> Result<Estimate, ValveError> {
    if points.len() < 2 {
        return Err(ValveError::TooFewPoints { points: points.len(), least: 2 });
    }
    for (place, point) in points.iter().enumerate() {
        let wrong = |what, value, unit, problem, remedy| {
            Err(ValveError::Implausible { what, point: place + 1, value, unit, problem, remedy })
        };
        for (what, duty) in [("commanded duty", point.commanded), ("effective duty", point.effective)] {
            if !(0.0..=1.0).contains(&duty) {
                return wrong(what, duty, "", "outside 0 to 1", "give it as a fraction: 50 % is 0.5");
            }
        }
        if !(point.frequency > 0.0 && point.frequency.is_finite()) {
            return wrong("frequency", point.frequency, "Hz", "not above zero", "give it in hertz");
        }
    }
    let start = points.iter().map(|point| (point.commanded - point.effective) / point.frequency).sum::<f64>();
    let unknown = Unknown::new("delay_difference", "s", start / points.len() as f64);
    Ok(fit(&Deficit(points), &[unknown], &Search::default())?.estimates[0].clone())
}

/// Effective duties by the difference of the delays.
struct Deficit<'a>(&'a [DutyPoint]);

impl Model for Deficit<'_> {
    fn residuals(&self) -> usize {
        self.0.len()
    }

    fn evaluate(&self, values: &[f64]) -> Evaluation {
        let residual = |point: &DutyPoint| point.commanded - values[0] * point.frequency - point.effective;
        Evaluation {
            residuals: self.0.iter().map(residual).collect(),
            slopes: self.0.iter().map(|point| -point.frequency).collect(),
        }
    }
}
