//! Delays of a valve's seat from the pressure under a pulse train.
//!
//! ```text
//! about each edge of the command   P = a + s₁ u + q₁ u²  before,  a + s₂ u + q₂ u²  after the onset,   u = t − t_onset
//! delay          = onset − edge                                        opening after energised, closing after released
//! effective duty = (closing onset − opening onset)/period
//! paper's way    effective duty = d − (t_open − t_close) f              several frequencies or duties
//! ```
//!
//! Each onset is found by least squares to a fraction of the sample interval, from the samples between the middle of the pause
//! before the edge and the next edge, then once more from the nearer half of them, so that parabolas are enough. A delay longer
//! than half of the pause is not seen. An edge where the course does not change by four deviations counts as missed: a pulse shorter
//! than `t_open` does not open the valve.
//!
//! Intervals are those of the mean over the pulses, from their scatter; of a single pulse, those of its fit. The paper's
//! way tells only the difference of the delays. A seat that takes its time makes an onset where the two courses cross.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 3.3 and Fig. 10; the solenoid is [`mckibben::valve::Solenoid`]. Checked by
//! `tests/valve.rs`.

use super::ValveError;
use crate::least_squares::{Estimate, Evaluation, Model, Search, Unknown, fit};
use crate::propagation;
use crate::series;

/// Samples about an edge: six unknowns, and some to tell the scatter.
const LEAST_SAMPLES: usize = 12;
/// Of these on either side of the onset.
const ON_A_SIDE: usize = 4;
/// Deviations by which the slope must change at an onset.
const CLEAR: f64 = 4.0;

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
    /// [`ValveError::Unsupported`] unless the times are finite and come by turns.
    pub fn new(energised: &[f64], released: &[f64]) -> Result<Self, ValveError> {
        let all = energised.iter().map(|time| (*time, true)).chain(released.iter().map(|time| (*time, false)));
        let mut edges: Vec<(f64, bool)> = all.collect();
        edges.sort_by(|a, b| a.0.total_cmp(&b.0));
        let in_turn = edges.windows(2).all(|pair| pair[0].1 != pair[1].1 && pair[0].0 < pair[1].0);
        match in_turn && edges.iter().all(|edge| edge.0.is_finite()) {
            true => Ok(Self { edges }),
            false => Err(ValveError::Unsupported {
                what: "the coil is not energised and released by turns",
                remedy: "give each time at which it is energised once, and the time of its release",
            }),
        }
    }

    /// A number of `pulses` at a `frequency` in Hz with a commanded `duty`, the first at t = 0.
    ///
    /// # Errors
    /// [`ValveError::Unsupported`] for a frequency that is not above zero or a duty that is not between 0 and 1.
    pub fn pwm(frequency: f64, duty: f64, pulses: usize) -> Result<Self, ValveError> {
        if !(frequency > 0.0 && frequency.is_finite() && duty > 0.0 && duty < 1.0) {
            return Err(ValveError::Unsupported {
                what: "the frequency is not above zero or the duty not between 0 and 1",
                remedy: "give hertz, and the duty as a fraction: 50 % is 0.5",
            });
        }
        let time = |pulse: usize, part: f64| (pulse as f64 + part) / frequency;
        let [energised, released] =
            [0.0, duty].map(|part| (0..pulses).map(|pulse| time(pulse, part)).collect::<Vec<_>>());
        Self::new(&energised, &released)
    }
}

/// When the pressure began to change its course.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Onset {
    /// When the coil was energised or released, in s.
    pub edge: f64,
    /// Whether it was energised.
    pub energised: bool,
    /// When the course changed, in s.
    pub time: f64,
    /// Standard deviation of that in s.
    pub deviation: f64,
}

/// Delays of a seat.
#[derive(Clone, Debug, PartialEq)]
pub struct Delays {
    /// From energised to the opening, t_open in s.
    pub opening: Estimate,
    /// From released to the closing, t_close in s.
    pub closing: Estimate,
    /// Share of a period in which the valve is open; `None` without two pulses that can be seen.
    pub effective_duty: Option<Estimate>,
    /// The onsets in order of time.
    pub onsets: Vec<Onset>,
    /// Edges without an onset.
    pub missed: usize,
}

impl Delays {
    /// Of a pulse train and the `pressure` in Pa, gauge or absolute, at each `time` in s.
    ///
    /// # Errors
    /// [`ValveError::Series`] for samples that are no series, [`ValveError::NoOnset`] when the pressure answers to no edge.
    pub fn find(time: &[f64], pressure: &[f64], train: &PulseTrain) -> Result<Self, ValveError> {
        series::check(time, pressure, "the pressure", LEAST_SAMPLES)?;
        let last = time[time.len() - 1];
        let edges = &train.edges;
        let mut onsets = Vec::new();
        let mut missed = 0;
        for (place, (edge, energised)) in edges.iter().enumerate() {
            let from = match place.checked_sub(1) {
                Some(before) => 0.5 * (edges[before].0 + edge),
                None => time[0],
            };
            let to = edges.get(place + 1).map_or(last, |next| next.0);
            let found = onset(time, pressure, [from, *edge, to]);
            match found {
                Some([time, deviation]) => onsets.push(Onset { edge: *edge, energised: *energised, time, deviation }),
                None => missed += 1,
            }
        }
        let delay = |energised: bool, name: &'static str| {
            let seen: Vec<&Onset> = onsets.iter().filter(|onset| onset.energised == energised).collect();
            match seen[..] {
                [] => Err(ValveError::NoOnset {
                    coil: if energised { "energised" } else { "released" },
                    edges: edges.iter().filter(|edge| edge.1 == energised).count(),
                }),
                [only] => Ok(propagation::estimate((name, "s"), only.time - only.edge, only.deviation, LEAST_SAMPLES)),
                _ => {
                    let delays: Vec<f64> = seen.iter().map(|onset| onset.time - onset.edge).collect();
                    Ok(propagation::mean((name, "s"), &delays))
                }
            }
        };
        let (opening, closing) = (delay(true, "opening_delay")?, delay(false, "closing_delay")?);
        // Opening, closing, and the next opening: one whole period.
        let duty = |three: &[Onset]| {
            let whole = three[0].energised && !three[1].energised && three[2].energised;
            whole.then(|| (three[1].time - three[0].time) / (three[2].time - three[0].time))
        };
        let duties: Vec<f64> = onsets.windows(3).filter_map(duty).collect();
        let effective_duty = (!duties.is_empty()).then(|| propagation::mean(("effective_duty", ""), &duties));
        Ok(Self { opening, closing, effective_duty, onsets, missed })
    }
}

/// Time in s and its deviation of the onset between the beginning of a window and its end, after an edge.
fn onset(time: &[f64], pressure: &[f64], [from, edge, to]: [f64; 3]) -> Option<[f64; 2]> {
    let mut window = [from, to];
    let mut found = None;
    for _ in 0..2 {
        let range = series::between(time, window[0], window[1]);
        let bend = Bend { time: &time[range.clone()], pressure: &pressure[range] };
        let [instant, deviation] = bend.fit(edge)?;
        found = Some([instant, deviation]);
        let reach = 0.5 * (instant - window[0]).min(window[1] - instant);
        window = [instant - reach, instant + reach];
        let narrow = series::between(time, window[0], window[1]);
        if narrow.len() < 2 * LEAST_SAMPLES {
            break;
        }
    }
    found
}

/// Samples whose course changes once.
struct Bend<'a> {
    time: &'a [f64],
    pressure: &'a [f64],
}

impl Bend<'_> {
    /// When it does, after an edge, and the deviation of that; `None` when it does not.
    fn fit(&self, edge: f64) -> Option<[f64; 2]> {
        let count = self.time.len();
        if count < LEAST_SAMPLES {
            return None;
        }
        // The best of the sample intervals, the parabolas fitted on each side of it.
        let places = (ON_A_SIDE..count - ON_A_SIDE).filter(|place| self.time[*place] >= edge);
        let side = |range: std::ops::Range<usize>, about: f64| {
            series::Polynomial::fit(&self.time[range.clone()], &self.pressure[range], about, 2)
        };
        let split = |place: usize| {
            let about = 0.5 * (self.time[place - 1] + self.time[place]);
            let (before, after) = (side(0..place, about)?, side(place..count, about)?);
            Some((before.squares + after.squares, about, before.coefficients, after.coefficients))
        };
        let (_, about, before, after) = places.filter_map(split).min_by(|a, b| a.0.total_cmp(&b.0))?;
        let span = self.time[count - 1] - self.time[0];
        let largest = self.pressure.iter().fold(0.0_f64, |largest, p| largest.max(p.abs())).max(f64::MIN_POSITIVE);
        let unknown =
            |name: &str, unit, start: f64, size: f64| Unknown::new(name, unit, start).between(-1e3 * size, 1e3 * size);
        let unknowns = [
            Unknown::new("onset", "s", about - self.time[0]).between(0.0, span),
            Unknown::new("pressure", "Pa", 0.5 * (before[0] + after[0])),
            unknown("slope before", "Pa/s", before[1], largest / span),
            unknown("slope change", "Pa/s", after[1] - before[1], largest / span),
            unknown("curvature before", "Pa/s^2", before[2], largest / (span * span)),
            unknown("curvature after", "Pa/s^2", after[2], largest / (span * span)),
        ];
        let found = fit(self, &unknowns, &Search::default()).ok()?;
        let [onset, change] = [0, 3].map(|place| &found.estimates[place]);
        let clear = change.value.abs() > CLEAR * change.deviation?;
        clear.then_some([self.time[0] + onset.value, onset.deviation?])
    }
}

impl Model for Bend<'_> {
    fn residuals(&self) -> usize {
        self.time.len()
    }

    fn evaluate(&self, values: &[f64]) -> Evaluation {
        let [onset, level, slope, change, curved, curving] = [0, 1, 2, 3, 4, 5].map(|place| values[place]);
        let mut evaluation = Evaluation { residuals: Vec::new(), slopes: Vec::new() };
        for (time, pressure) in self.time.iter().zip(self.pressure) {
            let u = time - self.time[0] - onset;
            let after = f64::from(u8::from(u >= 0.0));
            let (rate, curvature) = (slope + after * change, curved + after * (curving - curved));
            evaluation.residuals.push(level + u * (rate + u * curvature) - pressure);
            evaluation.slopes.extend([
                -rate - 2.0 * u * curvature,
                1.0,
                u,
                after * u,
                (1.0 - after) * u * u,
                after * u * u,
            ]);
        }
        evaluation
    }
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
/// [`ValveError::TooFewPoints`] for less than two, [`ValveError::Implausible`] for a duty outside 0 to 1 or a frequency that is not
/// above zero.
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
