//! Where the motion turns: the peaks and troughs of a ring-down, finer than the samples and despite their noise.
//!
//! A turn is looked for in lengths that parabolas over a twelfth of a period have smoothed, as a rise that is followed by a fall
//! by six standard deviations of such a length or more, and the other way round. Its place is the vertex of the parabola through the samples
//! within a twelfth of a period of it on both sides, by least squares. The parabola's error is the same part of every
//! amplitude (2·10⁻⁴), which leaves β as it is. The scatter about all of the parabolas is the noise.
//!
//! A turn with hardly a fall on one side is none: the mass was held there, or stuck. The half period is the slope of
//! the turns' times over their number; as friction bends a turn to one side, the more the smaller it is, it is long by
//! some 10⁻⁴ of itself.

use super::RingDownError;
use super::record::Record;
use crate::series::{self, Polynomial};

/// Turns that make two cycles on one side and two on the other.
const LEAST_TURNS: usize = 5;
/// Part of the range by which a swing stands out at first.
const PROMINENT: f64 = 0.2;
/// Standard deviations of a smoothed length by which a swing stands out from noise.
const STANDING_OUT: f64 = 6.0;
/// Part of the range by which a swing without noise must stand out.
const RESOLVED: f64 = 1e-4;
/// Part of the range within which a mass at rest stays.
const AT_REST: f64 = 0.05;
/// Samples of a parabola, and on either side of its vertex.
const LEAST_SAMPLES: [usize; 2] = [5, 2];
/// How often the lesser fall goes into the greater next to a velocity reversal at most: friction alone makes it three,
/// `(X + Q)/(X − Q)` with X > 2Q, and the rest is for noise.
const MOST_UNEVEN: f64 = 5.0;
/// Standard deviations by which a fall stands out from noise.
const CLEAR: f64 = 3.0;
/// Reach of a parabola to either side over the period, and how far it may grow where samples are few.
const REACH: [f64; 2] = [1.0 / 12.0, 1.0 / 6.0];

/// A peak or a trough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// When, in s.
    pub time: f64,
    /// Standard error of the time in s.
    pub time_deviation: f64,
    /// Length in m.
    pub length: f64,
    /// Standard error of the length in m.
    pub deviation: f64,
    /// Whether the length is greatest there.
    pub is_peak: bool,
}

/// The turns of a ring-down in order of time, peaks and troughs by turns.
#[derive(Clone, Debug, PartialEq)]
pub struct Turns {
    /// Five or more.
    pub turns: Vec<Turn>,
    /// Time in s from one turn to the next on the same side.
    pub period: f64,
    /// Standard error of the period in s.
    pub period_deviation: f64,
    /// Standard deviation of a sample in m, from the scatter about the parabolas.
    pub noise: f64,
    /// How many samples more than unknowns the noise was estimated from.
    pub degrees_of_freedom: usize,
}

impl Turns {
    /// Finds the turns.
    ///
    /// # Errors
    /// [`RingDownError::Saturated`] for a sensor at the end of its range, [`RingDownError::TooFewTurns`] and
    /// [`RingDownError::Stuck`] for less than two cycles, [`RingDownError::TooCoarse`] for too few samples in a cycle.
    pub fn find(record: &Record) -> Result<Self, RingDownError> {
        let [least, largest] = record.range();
        let range = largest - least;
        let coarse = reversals(record.length(), PROMINENT * range);
        let places: Vec<f64> = coarse.iter().map(|place| record.time()[*place]).collect();
        // The first may be where the mass was held, and the last where it came to rest.
        let mut halves: Vec<f64> = places.windows(2).skip(1).map(|pair| pair[1] - pair[0]).collect();
        halves.sort_by(f64::total_cmp);
        let Some(half) = halves.get(halves.len() / 2) else {
            return Err(too_few(record, &places));
        };
        let period = 2.0 * half;
        record.check_saturation(period)?;
        let smooth = smoothed(record, period / 24.0);
        let swing = (STANDING_OUT * smooth.noise).max(RESOLVED * range);
        let found: Vec<usize> =
            reversals(&smooth.length, swing).into_iter().map(|place| place + smooth.first).collect();
        let fits: Vec<Result<Vertex, usize>> =
            found.iter().map(|place| Vertex::fit(record, record.time()[*place], period)).collect();
        // Where the mass was held or stuck, and at the ends of the record, there is no turn; between the others there is.
        let is_turn = |fit: &Result<Vertex, usize>| fit.as_ref().is_ok_and(|vertex| vertex.falls_on_both_sides);
        let first = fits.iter().position(is_turn).unwrap_or(fits.len());
        let end = fits.iter().rposition(is_turn).map_or(first, |last| last + 1);
        let seen = if first < end { &fits[first..end] } else { &fits[..] };
        if let Some(samples) = seen.iter().find_map(|fit| fit.as_ref().err()) {
            return Err(RingDownError::TooCoarse { samples: *samples, period });
        }
        let fits: Vec<Vertex> = fits.into_iter().skip(first).take(end - first).flatten().collect();
        let times: Vec<f64> = fits.iter().map(|vertex| vertex.time).collect();
        if fits.len() < LEAST_TURNS {
            return Err(too_few(record, &times));
        }
        Ok(Self::new(&fits))
    }

    fn new(fits: &[Vertex]) -> Self {
        let degrees_of_freedom = fits.iter().map(|vertex| vertex.degrees_of_freedom).sum::<usize>();
        let squares: f64 = fits.iter().map(|vertex| vertex.squares).sum();
        let noise = (squares / degrees_of_freedom.max(1) as f64).sqrt();
        let turn = |vertex: &Vertex| Turn {
            time: vertex.time,
            time_deviation: noise * vertex.time_deviation,
            length: vertex.length,
            deviation: noise * vertex.deviation,
            is_peak: vertex.is_peak,
        };
        let turns: Vec<Turn> = fits.iter().map(turn).collect();
        let middle = 0.5 * (turns.len() - 1) as f64;
        let lever = |place: usize| place as f64 - middle;
        let levers: f64 = (0..turns.len()).map(|place| lever(place) * lever(place)).sum();
        let slope = |of: &dyn Fn(usize) -> f64| (0..turns.len()).map(of).sum::<f64>() / levers;
        let half = slope(&|place| lever(place) * (turns[place].time - turns[0].time));
        let variance = slope(&|place| (lever(place) * turns[place].time_deviation).powi(2)) / levers;
        Self { turns, period: 2.0 * half, period_deviation: 2.0 * variance.sqrt(), noise, degrees_of_freedom }
    }

    /// Half of the way in m from each turn to the next.
    pub fn half_swings(&self) -> Vec<f64> {
        self.turns.windows(2).map(|pair| 0.5 * (pair[0].length - pair[1].length).abs()).collect()
    }
}

/// Whether the motion came to rest within the record says what there is too little of.
fn too_few(record: &Record, times: &[f64]) -> RingDownError {
    let (length, [least, largest]) = (record.length(), record.range());
    let tail = &length[2 * length.len() / 3..];
    let spread = |samples: &[f64]| {
        let ends = samples.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(*x), b.max(*x)]);
        ends[1] - ends[0]
    };
    let turns = times.len();
    match spread(tail) < AT_REST * (largest - least) + 2.0 * STANDING_OUT * record.noise() {
        true => RingDownError::Stuck { turns, time: times.last().copied().unwrap_or(record.time()[0]) },
        false => RingDownError::TooFewTurns { turns, least: LEAST_TURNS },
    }
}

/// Places of the turns of values between swings of a size or more, the first value's side included.
fn reversals(values: &[f64], swing: f64) -> Vec<usize> {
    let (mut highest, mut lowest) = (0, 0);
    let mut places = Vec::new();
    let mut rising = None;
    for (place, value) in values.iter().enumerate() {
        if *value > values[highest] {
            highest = place;
        }
        if *value < values[lowest] {
            lowest = place;
        }
        if rising != Some(false) && *value < values[highest] - swing {
            places.push(highest);
            (rising, lowest) = (Some(false), place);
        } else if rising != Some(true) && *value > values[lowest] + swing {
            places.push(lowest);
            (rising, highest) = (Some(true), place);
        }
    }
    places
}

/// Lengths by parabolas through their neighbouring samples, where these are complete.
struct Smoothed {
    /// Place of the first in the record.
    first: usize,
    length: Vec<f64>,
    /// Standard deviation of one of them in m.
    noise: f64,
}

fn smoothed(record: &Record, reach: f64) -> Smoothed {
    let (time, length) = (record.time(), record.length());
    let at = |place: usize| {
        let around = series::between(time, time[place] - reach, time[place] + reach);
        match Polynomial::fit(&time[around.clone()], &length[around], time[place], 2) {
            Some(parabola) => (parabola.coefficients[0], parabola.standard_error(&[1.0, 0.0, 0.0])),
            None => (length[place], 1.0),
        }
    };
    let whole = series::between(time, time[0] + reach, time[time.len() - 1] - reach);
    let first = whole.start;
    let (length, deviations): (Vec<f64>, Vec<f64>) = whole.map(at).unzip();
    let noise = record.noise() * deviations.into_iter().fold(0.0, f64::max);
    Smoothed { first, length, noise }
}

/// The vertex of a parabola; standard errors relative to the standard deviation of a sample.
struct Vertex {
    time: f64,
    time_deviation: f64,
    length: f64,
    deviation: f64,
    is_peak: bool,
    falls_on_both_sides: bool,
    squares: f64,
    degrees_of_freedom: usize,
}

impl Vertex {
    /// Of the samples about a time; how many there are where they are too few.
    fn fit(record: &Record, about: f64, period: f64) -> Result<Self, usize> {
        let [time, length] = [record.time(), record.length()];
        let mut centre = about;
        let mut vertex = None;
        // Once more about the vertex, so that both sides reach as far.
        for _ in 0..2 {
            let enough = |reach: f64| {
                let range = series::between(time, centre - reach, centre + reach);
                let before = time[range.clone()].partition_point(|t| *t < centre);
                let sides = before.min(range.len() - before);
                (range.len() >= LEAST_SAMPLES[0] && sides >= LEAST_SAMPLES[1]).then_some((range, reach))
            };
            let widths = (0..=4).map(|step| period * (REACH[0] + (REACH[1] - REACH[0]) * f64::from(step) / 4.0));
            let (range, reach) = widths
                .clone()
                .find_map(enough)
                .ok_or_else(|| series::between(time, centre - 0.5 * period, centre + 0.5 * period).len())?;
            let parabola =
                Polynomial::fit(&time[range.clone()], &length[range.clone()], centre, 2).ok_or(range.len())?;
            let [a, b, c] = [0, 1, 2].map(|term| parabola.coefficients[term]);
            let offset = -b / (2.0 * c);
            let found = Self {
                time: centre + offset,
                time_deviation: parabola.standard_error(&[0.0, -0.5 / c, 0.5 * b / (c * c)]),
                length: a + 0.5 * b * offset,
                deviation: parabola.standard_error(&[1.0, offset, offset * offset]),
                is_peak: c < 0.0,
                falls_on_both_sides: true,
                squares: parabola.squares,
                degrees_of_freedom: parabola.degrees_of_freedom,
            };
            if offset.abs() > reach || !offset.is_finite() {
                return Ok(Self { falls_on_both_sides: false, ..found });
            }
            centre = found.time;
            vertex = Some((found, reach));
        }
        let (mut vertex, reach) = vertex.ok_or(0_usize)?;
        let mean = |from: f64, to: f64| {
            let samples = &length[series::between(time, centre + from * reach, centre + to * reach)];
            let count = samples.len().max(1) as f64;
            (samples.iter().sum::<f64>() / count, 1.0 / count)
        };
        let (top, spread) = mean(-1.0 / 3.0, 1.0 / 3.0);
        let sign = if vertex.is_peak { 1.0 } else { -1.0 };
        let fall = |(side, other): (f64, f64)| (sign * (top - side), CLEAR * record.noise() * (spread + other).sqrt());
        let falls = [mean(-1.0, -0.5), mean(0.5, 1.0)].map(fall);
        let even = MOST_UNEVEN * falls[0].0.min(falls[1].0) >= falls[0].0.max(falls[1].0);
        vertex.falls_on_both_sides = even && falls.iter().all(|(fall, noise)| fall > noise);
        Ok(vertex)
    }
}
