//! What a proportional pressure regulator makes while its set point stays the same, in closed form: a straight line at the limit
//! of its rate, and then an exponential.

/// Time constant in s, dead time in s, largest rate in Pa/s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Regulated {
    pub(crate) time_constant: f64,
    pub(crate) dead_time: f64,
    pub(crate) rate_limit: f64,
}

/// The absolute pressure in Pa from an instant in s on, and what it goes to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TimeSeries {
    pub(crate) time: f64,
    pub(crate) pressure: f64,
    pub(crate) set_point: f64,
}

impl Regulated {
    /// The pressure at a time, not before the series begins.
    pub(crate) fn pressure(&self, series: &TimeSeries, time: f64) -> f64 {
        let apart = series.pressure - series.set_point;
        let straight = (apart.abs() / self.rate_limit - self.time_constant).max(0.0);
        let elapsed = time - series.time;
        let line = elapsed.min(straight);
        let left = (apart.abs() - self.rate_limit * line) * (-(elapsed - line) / self.time_constant).exp();
        series.set_point + apart.signum() * left
    }

    /// What follows a set point (Pa, absolute) that is given at a time, when `before` held.
    pub(crate) fn then(&self, before: &TimeSeries, time: f64, set_point: f64) -> TimeSeries {
        let time = time + self.dead_time;
        TimeSeries { time, pressure: self.pressure(before, time), set_point }
    }

    /// What follows set points (Pa, absolute) that are given at times, from rest at a pressure.
    pub(crate) fn segments(&self, at_rest: f64, times: &[f64], set_points: &[f64]) -> Vec<TimeSeries> {
        let mut series = TimeSeries { time: 0.0, pressure: at_rest, set_point: at_rest };
        let mut follows = |(time, set_point): (&f64, &f64)| {
            series = self.then(&series, *time, *set_point);
            series
        };
        times.iter().zip(set_points).map(&mut follows).collect()
    }
}
