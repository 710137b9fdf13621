//! What a sensor makes of a quantity, between the rig and the table.
//!
//! ```text
//! T ẏ = x − y                     lag of first order, settled at the start of the run
//! r(t) = s (y(t_h − δ) + b) − b + o + d t          t_h = t, or the last instant at which the sensor took a sample
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | x, r | quantity of the simulated run, and what is read of it | of the quantity |
//! | o, d, s | `offset`, `drift`, `scale` | of the quantity, that per second, 1 |
//! | δ, T | `shift` (positive where readings come late), `lag` | s |
//! | b | `base`: what zero of the quantity is on the sensor, as for a gauge pressure read by an absolute sensor | of the quantity |
//!
//! Each is known or looked for with the parameters of the scenario. Shift and lag take the quantity before the reading: outside of
//! the run it has its value at the start.
//!
//! Checked by `tests/sensors.rs`.

use super::{Observed, Simulated, SimulatedReader};
use mckibben::Instantiate;

/// A number of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// It is known.
    Known(f64),
    /// It is looked for: the index of the unknown.
    Unknown(usize),
}

/// What a sensor makes of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Added to every reading.
    pub offset: Amount,
    /// What the offset grows by in a second.
    pub drift: Amount,
    /// Readings over the quantity.
    pub scale: Amount,
    /// By how much readings come late, in s.
    pub shift: Amount,
    /// Time constant in s of a lag of first order.
    pub lag: Amount,
    /// Interval in s at which the sensor takes samples, from the start of the run on, and holds them; none where it follows.
    pub hold: Option<f64>,
    /// What zero of the quantity is on the sensor.
    pub base: f64,
}

impl Default for Sensor {
    /// An exact sensor.
    fn default() -> Self {
        let zero = Amount::Known(0.0);
        Self { offset: zero, drift: zero, scale: Amount::Known(1.0), shift: zero, lag: zero, hold: None, base: 0.0 }
    }
}

/// Numbers of a sensor that can be looked for.
pub const AMOUNTS: [&str; 5] = ["offset", "drift", "scale", "shift", "lag"];

impl Sensor {
    /// The numbers, in the order of [`AMOUNTS`].
    pub fn amounts(&self) -> [Amount; 5] {
        [self.offset, self.drift, self.scale, self.shift, self.lag]
    }

    /// The numbers to be changed, in the order of [`AMOUNTS`].
    pub fn amounts_mut(&mut self) -> [&mut Amount; 5] {
        [&mut self.offset, &mut self.drift, &mut self.scale, &mut self.shift, &mut self.lag]
    }

    /// The unknowns that are looked for in it.
    pub(super) fn unknowns(&self) -> impl Iterator<Item = usize> + use<> {
        self.amounts().into_iter().filter_map(|amount| match amount {
            Amount::Unknown(unknown) => Some(unknown),
            Amount::Known(_) => None,
        })
    }

    /// With values of all unknowns.
    pub(super) fn at(&self, values: &[f64]) -> KnownSensor {
        let amounts = self.amounts();
        let [offset, drift, scale, shift, lag] = amounts.map(|amount| match amount {
            Amount::Known(number) => number,
            Amount::Unknown(unknown) => values[unknown],
        });
        let is_unknown = amounts.map(|amount| matches!(amount, Amount::Unknown(_)));
        KnownSensor { offset, drift, scale, shift, lag: lag.max(0.0), hold: self.hold, base: self.base, is_unknown }
    }
}

/// A sensor whose numbers have values.
#[derive(Clone, Copy, Debug)]
pub(super) struct KnownSensor {
    offset: f64,
    drift: f64,
    scale: f64,
    shift: f64,
    lag: f64,
    hold: Option<f64>,
    base: f64,
    is_unknown: [bool; 5],
}

/// A reading with its derivatives with respect to the parameters of the sensor, in the order of [`AMOUNTS`].
pub(super) struct Reading<R> {
    pub(super) value: R,
    pub(super) by_amounts: [f64; 5],
}

/// Half of the span in s over which a time series is differenced in time.
const HALF_SPAN: f64 = 1e-5;
/// Part of a lag by which it is differenced, and the least such difference in s: between two lags near zero nothing is left but rounding.
const LAG_PART: f64 = 1e-4;
const LEAST_LAG: f64 = 1e-7;
/// Lags after which a filter has forgotten where it was, and parts of a lag that are a step of it; but a step need not be shorter
/// than a time in s in which any motion is a parabola.
const FORGOTTEN: f64 = 30.0;
const STEP: f64 = 0.5;
const SHORTEST: f64 = 2.5e-4;

impl KnownSensor {
    /// How long a run must be in s for a reading at a time.
    pub(super) fn until(&self, time: f64) -> f64 {
        time - self.shift
    }

    /// When in s the quantity had the value that is read at a time.
    fn source(&self, time: f64) -> f64 {
        let taken = match self.hold {
            Some(interval) => interval * sample(interval, time),
            None => time,
        };
        taken - self.shift
    }

    /// Readings of a quantity at times that do not fall, each with its derivatives with respect to the parameters of
    /// the sensor.
    pub(super) fn read<R: Instantiate>(
        &self,
        simulated: &Simulated<R>,
        observed: &Observed,
        times: impl Iterator<Item = f64>,
        mut visit: impl FnMut(Reading<R>),
    ) {
        let mut simulated_series =
            SimulatedSeries { reader: SimulatedReader::new(simulated), observed, last: simulated.duration().value() };
        let [.., shift_is_unknown, lag_is_unknown] = self.is_unknown;
        let step = (LAG_PART * self.lag).max(LEAST_LAG);
        // No lag is below zero: from one that is shorter than the difference, this is one-sided.
        let less = if self.lag > step { self.lag - step } else { self.lag };
        let lags = [self.lag, self.lag + step, less];
        let lags = if lag_is_unknown { &lags[..] } else { &lags[..1] };
        let mut filter = (self.lag > 0.0).then(|| Filter::new(lags, &mut simulated_series));
        let (base, scale) = (R::constant(self.base), R::constant(self.scale));
        for time in times {
            let source = self.source(time);
            let (quantity, rate, by_lag) = match &mut filter {
                None => {
                    let rate = if shift_is_unknown || lag_is_unknown { simulated_series.rate(source) } else { 0.0 };
                    (simulated_series.at(source), rate, -rate)
                }
                Some(filter) => {
                    filter.advance(source, &mut simulated_series);
                    let value = filter.values[0];
                    let by_lag = match filter.values[..] {
                        [_, more, less] => (more.value() - less.value()) / (lags[1] - lags[2]),
                        _ => 0.0,
                    };
                    let rate = match shift_is_unknown {
                        true if self.lag > LEAST_LAG => {
                            (simulated_series.at(source).value() - value.value()) / self.lag
                        }
                        // What so short a lag leaves of the difference is rounding.
                        true => simulated_series.rate(source),
                        false => 0.0,
                    };
                    (value, rate, by_lag)
                }
            };
            let on_sensor = quantity + base;
            let value = scale * on_sensor - base + R::constant(self.offset + self.drift * time);
            let by_amounts = [1.0, time, on_sensor.value(), -self.scale * rate, self.scale * by_lag];
            visit(Reading { value, by_amounts });
        }
    }
}

/// Which sample a sensor that holds has at a time, counted from the start of the run; one that is due then is taken.
pub fn sample(interval: f64, time: f64) -> f64 {
    (time / interval * (1.0 + f64::EPSILON) + 1e-9).floor()
}

/// A quantity of a run over time, with its value at the start before that.
struct SimulatedSeries<'r, R: Instantiate> {
    reader: SimulatedReader<'r, R>,
    observed: &'r Observed,
    last: f64,
}

impl<R: Instantiate> SimulatedSeries<'_, R> {
    fn at(&mut self, time: f64) -> R {
        self.reader.read(self.observed, R::constant(time.clamp(0.0, self.last)))
    }

    /// Its rate in its unit per second.
    fn rate(&mut self, time: f64) -> f64 {
        let [before, after] = [time - HALF_SPAN, time + HALF_SPAN].map(|time| time.clamp(0.0, self.last));
        if after <= before {
            return 0.0;
        }
        (self.at(after).value() - self.at(before).value()) / (after - before)
    }
}

/// A lag of first order, and others near it, taken on from reading to reading by common nodes: between them the
/// quantity is a parabola, of which a lag is exact.
struct Filter<'l, R> {
    /// In s, the first of them above zero.
    lags: &'l [f64],
    time: f64,
    /// What each lag leaves of the quantity.
    values: Vec<R>,
}

impl<'l, R: Instantiate> Filter<'l, R> {
    fn new(lags: &'l [f64], simulated_series: &mut SimulatedSeries<'_, R>) -> Self {
        Self { lags, time: 0.0, values: vec![simulated_series.at(0.0); lags.len()] }
    }

    fn advance(&mut self, until: f64, simulated_series: &mut SimulatedSeries<'_, R>) {
        if until <= self.time {
            return;
        }
        // The longest of them has forgotten last.
        let forgotten = until - FORGOTTEN * self.lags.iter().copied().fold(0.0, f64::max);
        if forgotten > self.time {
            self.time = forgotten;
            self.values.fill(simulated_series.at(forgotten));
        }
        let steps = ((until - self.time) / (STEP * self.lags[0]).max(SHORTEST)).ceil().max(1.0);
        let (from, step) = (self.time, (until - self.time) / steps);
        let moments: Vec<[R; 3]> = self.lags.iter().map(|lag| moments(step / lag).map(R::constant)).collect();
        let [four, three, two] = [4.0, 3.0, 2.0].map(R::constant);
        let mut begin = simulated_series.at(from);
        for count in 1..=steps as u64 {
            let at = from + step * (count as f64 - 0.5);
            let (middle, end) = (simulated_series.at(at), simulated_series.at(from + step * count as f64));
            let slope = four * middle - three * begin - end;
            let bend = two * (begin + end) - four * middle;
            for (value, [decay, first, second]) in self.values.iter_mut().zip(&moments) {
                *value = *value + *decay * (begin - *value) + *first * slope + *second * bend;
            }
            begin = end;
        }
        self.time = until;
    }
}

/// `z ∫ e^{−z(1−u)} uⁿ du` over u from 0 to 1, of n = 0, 1 and 2.
fn moments(z: f64) -> [f64; 3] {
    if z > 0.5 {
        let zeroth = -(-z).exp_m1();
        let first = 1.0 - zeroth / z;
        return [zeroth, first, 1.0 - 2.0 * first / z];
    }
    // Σ (−1)^k z^{k+1} n!/(n + k + 1)!
    [0.0, 1.0, 2.0].map(|n| {
        let mut term = z / (n + 1.0);
        let mut sum = term;
        for k in 1..=14 {
            term *= -z / (n + f64::from(k) + 1.0);
            sum += term;
        }
        sum
    })
}

#[cfg(test)]
mod tests {
    use super::moments;

    #[test]
    fn moments_are_those_of_a_quadrature() {
        for z in [1e-9, 1e-3, 0.3, 0.499_999, 0.500_001, 2.0, 30.0_f64] {
            let count = 200_000;
            for (n, moment) in moments(z).into_iter().enumerate() {
                let point = |k: i32| (f64::from(k) + 0.5) / f64::from(count);
                let sum: f64 = (0..count).map(|k| z * (-z * (1.0 - point(k))).exp() * point(k).powi(n as i32)).sum();
                let expected = sum / f64::from(count);
                assert!((moment - expected).abs() < 1e-8 * expected, "{z} {n}: {moment} {expected}");
            }
        }
    }
}
