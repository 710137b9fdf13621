//! Series of quantities as they come, of a run and of the orbit behind it, and their statistics: as [`super::reduce`] defines them.
//!
//! Nothing but extremes and integrals is kept; of a quantity whose settling time is recorded every sample.

use mckibben_scenario::sweep::Statistic;

/// The band of the settling time, as a share of the total change.
const SETTLED: f64 = 0.02;
/// The end of a run without PWM over which the ripple is taken, as a share of its duration.
pub(super) const LAST_PART: f64 = 0.1;
/// Two instants closer than this, relative to the run, are one.
const SIMULTANEOUS: f64 = 1e-9;

/// What is kept of a quantity.
#[derive(Clone, Debug)]
struct Track<Q> {
    quantity: Q,
    first: f64,
    last: f64,
    least: f64,
    greatest: f64,
    /// `∫ x dt` so far.
    integral: f64,
    /// Least, greatest and number of the samples in the ripple's window and in the one before.
    windows: [(f64, f64, u64); 2],
    /// Every sample, where a settling time is recorded.
    series: Option<Vec<f64>>,
}

/// The interval over which ripples are taken, and the one before.
#[derive(Clone, Copy, Debug)]
pub(super) struct Windows {
    start: f64,
    length: f64,
    /// Times closer than this are one.
    rounding: f64,
}

impl Windows {
    /// The last `length` s of a run of `duration` s, and as long before.
    pub(super) fn last(length: f64, duration: f64) -> Self {
        Self { start: duration - length, length, rounding: SIMULTANEOUS * duration }
    }

    /// Whether the last so many begin in the run.
    fn are_whole(self, count: u8) -> bool {
        self.start - f64::from(count - 1) * self.length > -self.rounding
    }

    /// The window of a time in s: 0 for the last, 1 for the one before.
    pub(super) fn of(self, time: f64) -> Option<usize> {
        if time >= self.start - self.rounding {
            Some(0)
        } else {
            (time >= self.start - self.length - self.rounding).then_some(1)
        }
    }
}

/// What is kept of quantities over a stretch of time.
#[derive(Clone, Debug)]
struct Tracked<Q> {
    tracks: Vec<Track<Q>>,
    /// The times of the samples, where a settling time is recorded.
    times: Option<Vec<f64>>,
    windows: Windows,
    /// The times of the first and the last sample.
    span: Option<[f64; 2]>,
}

/// What is kept of quantities over a run, and over the orbit behind it where statistics are taken over that.
#[derive(Clone, Debug)]
pub(super) struct Series<Q> {
    run: Tracked<Q>,
    /// Nothing has been seen of an orbit that was not reached.
    orbit: Option<Tracked<Q>>,
}

impl<Q: Copy + PartialEq> Series<Q> {
    /// Of what statistics need of quantities, with the windows of ripples.
    pub(super) fn new(of: impl Iterator<Item = (Q, Statistic)>, windows: Windows) -> Self {
        let mut tracks: Vec<Track<Q>> = Vec::new();
        of.for_each(|(quantity, statistic)| Track::add(&mut tracks, quantity, statistic));
        let times = tracks.iter().any(|track| track.series.is_some()).then(Vec::new);
        Self { run: Tracked { tracks, times, windows, span: None }, orbit: None }
    }

    /// Sees the values of the quantities at the next time in s.
    pub(super) fn see(&mut self, time: f64, value: impl Fn(Q) -> f64) {
        let Tracked { tracks, times, windows, span } = &mut self.run;
        let step = span.map(|[_, last]| time - last);
        tracks.iter_mut().for_each(|track| track.see(value(track.quantity), step, windows.of(time)));
        if let Some(times) = times {
            times.push(time);
        }
        *span = Some([span.map_or(time, |[first, _]| first), time]);
    }

    /// Sees the values of the quantities on the orbit, at a time in s, in a window as of [`Windows::of`], with a weight in s.
    pub(super) fn see_orbit(&mut self, (time, window, weight): (f64, usize, f64), value: impl Fn(Q) -> f64) {
        let Some(Tracked { tracks, span, .. }) = &mut self.orbit else { return };
        for track in tracks {
            let value = value(track.quantity);
            track.integral += weight * value;
            track.note(value, Some(window));
        }
        *span = Some(span.map_or([time; 2], |[first, last]| [time.min(first), time.max(last)]));
    }

    /// What comes is of the orbit, with its windows; without them there is none.
    pub(super) fn turn_to_orbit(&mut self, windows: Option<Windows>) {
        let tracks = self.run.tracks.iter().map(|track| Track::new(track.quantity, false)).collect();
        let windows = windows.unwrap_or(self.run.windows);
        self.orbit = Some(Tracked { tracks, times: None, windows, span: None });
    }

    /// The value of a statistic, where it has one.
    pub(super) fn reduced(&self, quantity: Q, statistic: Statistic) -> Option<f64> {
        let of = self.orbit.as_ref().filter(|_| statistic.is_of_orbit()).unwrap_or(&self.run);
        let track = of.tracks.iter().find(|track| track.quantity == quantity)?;
        let [first, last] = of.span?;
        match statistic {
            Statistic::Ripple if !of.windows.are_whole(1) => None,
            Statistic::Drift if !of.windows.are_whole(2) => None,
            Statistic::SettlingTime => track.settling_time(of.times.as_deref()?),
            statistic => track.value(statistic, last - first),
        }
    }
}

impl<Q: Copy + PartialEq> Track<Q> {
    /// Adds what a statistic of a quantity needs to tracks.
    fn add(tracks: &mut Vec<Self>, quantity: Q, statistic: Statistic) {
        let settles = statistic == Statistic::SettlingTime;
        match tracks.iter_mut().find(|track| track.quantity == quantity) {
            Some(track) if settles => track.series = Some(Vec::new()),
            Some(_) => {}
            None => tracks.push(Self::new(quantity, settles)),
        }
    }

    fn new(quantity: Q, settles: bool) -> Self {
        let nothing = (f64::INFINITY, f64::NEG_INFINITY);
        Self {
            quantity,
            first: 0.0,
            last: 0.0,
            least: nothing.0,
            greatest: nothing.1,
            integral: 0.0,
            windows: [(nothing.0, nothing.1, 0); 2],
            series: settles.then(Vec::new),
        }
    }

    /// Sees a value that comes a `step` in s after the one before.
    fn see(&mut self, value: f64, step: Option<f64>, window: Option<usize>) {
        match step {
            None => self.first = value,
            Some(step) => self.integral += 0.5 * (self.last + value) * step,
        }
        self.note(value, window);
        if let Some(series) = &mut self.series {
            series.push(value);
        }
    }

    /// Takes a value, which is the last so far.
    fn note(&mut self, value: f64, window: Option<usize>) {
        self.last = value;
        self.least = self.least.min(value);
        self.greatest = self.greatest.max(value);
        if let Some(window) = window {
            let (least, greatest, count) = self.windows[window];
            self.windows[window] = (least.min(value), greatest.max(value), count + 1);
        }
    }

    fn value(&self, statistic: Statistic, duration: f64) -> Option<f64> {
        let change = self.last - self.first;
        match statistic {
            Statistic::Final => Some(self.last),
            Statistic::Mean => Some(self.integral / duration),
            Statistic::Min => Some(self.least),
            Statistic::Max => Some(self.greatest),
            Statistic::Peak => Some(self.greatest.abs().max(self.least.abs())),
            Statistic::Ripple => {
                let [(least, greatest, count), _] = self.windows;
                (count >= 2).then_some(greatest - least)
            }
            Statistic::Drift => {
                let [last, before] = self.windows;
                (last.2.min(before.2) >= 2).then(|| (last.0 - before.0).abs().max((last.1 - before.1).abs()))
            }
            Statistic::Overshoot if change > 0.0 => Some((self.greatest - self.last) / change),
            Statistic::Overshoot if change < 0.0 => Some((self.least - self.last) / change),
            Statistic::Overshoot
            | Statistic::SettlingTime
            | Statistic::Used
            | Statistic::Rms
            | Statistic::Efficiency => None,
        }
    }

    fn settling_time(&self, times: &[f64]) -> Option<f64> {
        let series = self.series.as_ref()?;
        let band = SETTLED * (self.last - self.first).abs();
        let outside = series.iter().rposition(|value| (value - self.last).abs() > band);
        times.get(outside.map_or(0, |index| index + 1)).copied()
    }
}
