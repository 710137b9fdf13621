//! Oscillations that are faster than a figure can show: their envelope and mean, and where the last periods begin.

/// A swing counts from this part of the range of its panel.
const SWING: f64 = 0.05;
/// Periods that a curve of the usual width shows one by one.
pub(crate) const MOST_PERIODS: usize = 60;
/// Windows of an envelope at most, and their length in periods at least.
const WINDOWS: f64 = 128.0;
const PERIODS_PER_WINDOW: f64 = 1.2;
/// The mean is taken over this many turning points to each side, which are whole periods: a window that cuts a period would make a wave
/// of its own.
const MEAN_OVER: usize = 6;
/// The last turning points that a detail shows: six periods.
const LAST: usize = 12;

/// The least and the greatest values around instants, and the mean.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Envelope {
    /// The instants.
    pub(crate) time: Vec<f64>,
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
    pub(crate) mean: Vec<f64>,
}

/// Where values turn, by index, counting swings that are larger than `least`.
fn turns(values: &[f64], least: f64) -> Vec<usize> {
    let (mut low, mut high, mut rising) = (0, 0, None);
    let mut turns = Vec::new();
    for (index, value) in values.iter().enumerate() {
        if *value > values[high] {
            high = index;
        }
        if *value < values[low] {
            low = index;
        }
        if rising != Some(false) && values[high] - value > least {
            turns.push(high);
            (rising, low) = (Some(false), index);
        } else if rising != Some(true) && value - values[low] > least {
            turns.push(low);
            (rising, high) = (Some(true), index);
        }
        // After a turn the other extreme is looked for from here on.
        match rising {
            Some(true) if *value >= values[high] => high = index,
            Some(false) if *value <= values[low] => low = index,
            _ => {}
        }
    }
    turns
}

/// Where the detail of a curve begins, if it swings more often than a figure of the whole shows; `range` is that of its panel,
/// which is more than noise.
pub(crate) fn last_periods(time: &[f64], values: &[f64], range: f64) -> Option<f64> {
    let turns = turns(values, SWING * range);
    let begin = turns.len().checked_sub(LAST)?;
    (turns.len() > 2 * MOST_PERIODS).then(|| time[turns[begin]])
}

/// The envelope of a curve that swings more often than a figure of the whole shows; `range` is that of its panel.
pub(crate) fn of(time: &[f64], values: &[f64], range: f64) -> Option<Envelope> {
    let turns = turns(values, SWING * range);
    let periods = turns.len() / 2;
    (periods > MOST_PERIODS).then(|| {
        let windows = (periods as f64 / PERIODS_PER_WINDOW).min(WINDOWS) as usize;
        envelope(time, values, (windows.max(1), &turns))
    })
}

/// The samples from one turning point to another of its kind around a sample: whole periods, about as many to each side where there are.
fn whole_periods(turns: &[usize], around: usize) -> (usize, usize) {
    let next = turns.partition_point(|turn| *turn < around);
    let last = turns.len() - 1;
    let to = (next + MEAN_OVER).min(last);
    let from = to.saturating_sub(2 * MEAN_OVER);
    let to = (from + 2 * MEAN_OVER).min(last);
    // Turning points of one kind are an even number apart.
    (turns[from], turns[to - (to - from) % 2])
}

/// The mean over time, by trapezoids.
fn mean(time: &[f64], values: &[f64]) -> f64 {
    let pairs = time.windows(2).zip(values.windows(2));
    let area: f64 = pairs.map(|(time, value)| (time[1] - time[0]) * 0.5 * (value[0] + value[1])).sum();
    let span = time.last().zip(time.first()).map_or(0.0, |(last, first)| last - first);
    if span > 0.0 { area / span } else { values.first().copied().unwrap_or(f64::NAN) }
}

/// The envelope over windows of equally many samples. At the instant between two windows it holds the samples of both, so that the
/// straight lines between contain every sample.
fn envelope(time: &[f64], values: &[f64], (windows, turns): (usize, &[usize])) -> Envelope {
    let last = values.len().saturating_sub(1);
    let edge = |window: usize| last * window / windows;
    // Neighbours share the sample between them.
    let of = |from: usize, to: usize| &values[edge(from)..=edge(to)];
    let mut found = Envelope { time: Vec::new(), lower: Vec::new(), upper: Vec::new(), mean: Vec::new() };
    for node in 0..=windows {
        let around = of(node.saturating_sub(1), (node + 1).min(windows));
        found.time.push(time[edge(node)]);
        found.lower.push(around.iter().copied().fold(f64::INFINITY, f64::min));
        found.upper.push(around.iter().copied().fold(f64::NEG_INFINITY, f64::max));
        let (from, to) = whole_periods(turns, edge(node));
        found.mean.push(mean(&time[from..=to], &values[from..=to]));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn wave(periods: f64) -> (Vec<f64>, Vec<f64>) {
        (0..=20_000)
            .map(|n| f64::from(n) / 20_000.0)
            .map(|t| (t, (TAU * periods * t).sin() * (1.0 + t) + 3.0 * t))
            .unzip()
    }

    #[test]
    fn the_envelope_contains_every_sample() {
        let (time, values) = wave(150.3);
        let envelope = of(&time, &values, 6.0).expect("150 periods are too many");
        let mut node = 0;
        for (t, value) in time.iter().zip(&values) {
            while node + 2 < envelope.time.len() && envelope.time[node + 1] < *t {
                node += 1;
            }
            let part = (t - envelope.time[node]) / (envelope.time[node + 1] - envelope.time[node]);
            let at = |edge: &[f64]| edge[node] + part * (edge[node + 1] - edge[node]);
            assert!(at(&envelope.lower) <= value + 1e-12 && *value <= at(&envelope.upper) + 1e-12, "{t}");
        }
        assert!(envelope.mean.iter().zip(&envelope.time).all(|(mean, t)| (mean - 3.0 * t).abs() < 0.3), "{envelope:?}");
    }

    /// Teeth of a saw whose periods no window divides: their mean is one line, not a wave of the windows.
    #[test]
    fn the_mean_of_a_settled_oscillation_is_constant() {
        let (periods, samples) = (151.7, 6_000);
        let time: Vec<f64> = (0..=samples).map(|n| f64::from(n) / f64::from(samples)).collect();
        let values: Vec<f64> = time.iter().map(|t| (periods * t).fract()).collect();
        let envelope = of(&time, &values, 1.0).expect("too many to draw");
        // A period of 40 samples is cut to within one: an eightieth, spread over six periods.
        assert!(envelope.mean.iter().all(|mean| (mean - 0.5).abs() < 0.01), "{:?}", envelope.mean);
    }

    #[test]
    fn few_periods_are_drawn_and_the_last_six_of_many_are_found() {
        let (time, values) = wave(50.0);
        assert!(of(&time, &values, 6.0).is_none() && last_periods(&time, &values, 6.0).is_none());
        let (time, values) = wave(100.0);
        let begin = last_periods(&time, &values, 6.0).expect("too many");
        assert!((1.0 - begin - 0.06).abs() < 0.01, "{begin}");
        // Swings that are small in their panel are no oscillation of it.
        assert!(of(&time, &values, 100.0).is_none());
    }
}
