//! The way of a length that was read with noise, along which a memory goes.
//!
//! Where the direction is known, the way is that of the parabolas through the readings (`motion`). In a gap between readings of a known
//! direction successive readings go to and fro by their noise, and a memory must not follow: 2 µm made a Bouc-Wen law of 0.2 mm a fifth too
//! stiff. So the way through a gap is one of these, over as many readings to both sides as it fits as well as their noise lets it, and of
//! those that turn the one with the least scatter, or else a rest:
//!
//! | the way | |
//! |---|---|
//! | a quartic | a smooth turn, or a slow part |
//! | two straight lines or parabolas, each of the readings on its side of where they meet | a corner |
//! | a level between two straight lines | a rest |
//! | the closest way that rises and falls once | where none of these fits |
//!
//! The last one is found by pooling readings that go against it (Ayer et al. 1955; for one turn Stout 2008). Where not even that fits, the
//! length turns more than once, and the readings themselves are the way. Directions to either side that differ make a turn, which lies
//! between two readings: the memory goes there, and back from there.
//!
//! Checked by `tests/loops.rs`.

use crate::motion::Moving;
use crate::polynomial::{Polynomial, are_noise};
use std::ops::Range;

/// Readings to either side of a gap that the widest window has.
const WIDEST: usize = 128;
/// Readings to either side of a gap whose own windows may reach into it, at most.
const REACH: usize = 1024;
/// Readings of a known direction to either side that remain, at least.
const ENDS: usize = 2;
/// How often readings are assigned to the sides of a corner again.
const ASSIGNMENTS: u32 = 4;
/// Halvings of an interval of time, down to its rounding.
const HALVINGS: u32 = 60;

/// Where the length turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Turn {
    /// Time in s.
    pub(crate) time: f64,
    /// Length in m.
    pub(crate) length: f64,
}

/// The way of the length.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Path {
    /// Length in m at each reading.
    lengths: Vec<f64>,
    /// The turn between each reading and the one before it.
    turns: Vec<Option<Turn>>,
}

/// Polynomials one after the other.
struct Pieces {
    /// Each with the time in s up to which it counts.
    pieces: Vec<(f64, Polynomial)>,
    /// The last one.
    last: Polynomial,
    /// Where it turns.
    turn: Option<f64>,
    squares: f64,
    freedom: usize,
}

/// The way through a gap.
struct Way {
    /// In m at each reading.
    lengths: Vec<f64>,
    /// In m/s at each reading, each with its standard error, where they are known.
    velocities: Vec<[f64; 2]>,
    turn: Option<Turn>,
}

/// Readings in which the direction rises before a gap, and falls behind it or rises.
struct Gap<'r> {
    series: [&'r [f64]; 2],
    noise: f64,
    /// The readings whose direction is not known.
    gap: Range<usize>,
    /// The readings of known directions to either side, and the gap.
    around: Range<usize>,
    turns: bool,
}

impl Path {
    /// Of readings at times in s with a noise in m, and of the lengths in m without most of it where the direction is known. A velocity
    /// that the way through a gap knows better is the way's.
    pub(crate) fn new(
        [time, length]: [&[f64]; 2],
        noise: f64,
        moving: &mut [Option<Moving>],
        smooth: Vec<f64>,
    ) -> Self {
        let mut path = Self { lengths: smooth, turns: vec![None; time.len()] };
        let known = moving.to_vec();
        let rises = |place: usize| known.get(place).copied().flatten().map(|moving| moving.velocity > 0.0);
        let downward: Vec<f64> = length.iter().map(|length| -length).collect();
        let mut next = 0;
        while let Some(start) = (next..time.len()).find(|place| rises(*place).is_none()) {
            let end = (start..time.len()).find(|place| rises(*place).is_some()).unwrap_or(time.len());
            next = end;
            let Some(behind) = rises(end) else { break };
            let before = start.checked_sub(1).and_then(rises);
            let sign = if before.unwrap_or(behind) { 1.0 } else { -1.0 };
            // Other gaps may lie on the way to where it turns before and behind.
            let goes = |way: Option<bool>| move |place: &usize| rises(*place).is_none_or(|rises| Some(rises) == way);
            let begin = (0..start).rev().take(REACH).take_while(goes(before)).last().unwrap_or(start);
            let last = (end..time.len()).take(REACH).take_while(goes(Some(behind))).last().unwrap_or(end);
            let turns = before.is_some_and(|before| before != behind);
            // Parabolas that reach into the gap are not the way there.
            let half = |place: &usize| known[*place].map_or(0, |moving| moving.half);
            let into = (begin + ENDS..start).find(|place| place + half(place) >= start).unwrap_or(start);
            let out = (end..(last + 1).saturating_sub(ENDS)).rev().find(|place| *place < end + half(place));
            let gap = into..out.map_or(end, |place| place + 1);
            next = next.max(gap.end);
            let series = [time, if sign > 0.0 { length } else { &downward }];
            let gap = Gap { series, noise, gap, around: begin..last + 1, turns };
            let Some(way) = gap.way() else { continue };
            path.bridge(&gap, &way, sign);
            for (place, [velocity, error]) in gap.gap.clone().zip(way.velocities) {
                let goes = |known: &Moving| velocity * sign * known.velocity > 0.0;
                if let Some(known) = moving[place].as_mut().filter(|known| goes(known) && error < known.error) {
                    (known.velocity, known.error) = (sign * velocity, error);
                }
            }
        }
        path
    }

    /// The length in m at a reading.
    pub(crate) fn length(&self, place: usize) -> f64 {
        self.lengths[place]
    }

    /// The turn between a reading and the one before it.
    pub(crate) fn turn(&self, place: usize) -> Option<Turn> {
        self.turns[place]
    }

    /// Leads it through a gap, whose lengths have been multiplied by a sign.
    fn bridge(&mut self, of: &Gap<'_>, Way { lengths, turn, .. }: &Way, sign: f64) {
        let before = of.gap.start.checked_sub(1).map(|place| sign * self.lengths[place]);
        let behind = sign * self.lengths[of.gap.end];
        // It goes on from where it is, and to where it goes.
        let top = match turn {
            Some(turn) => turn.length.max(behind).max(before.unwrap_or(behind)),
            None => lengths.iter().copied().fold(f64::NEG_INFINITY, f64::max).max(behind),
        };
        for (place, length) in of.gap.clone().zip(lengths) {
            let is_behind = turn.is_some_and(|turn| of.series[0][place] > turn.time);
            let least = if is_behind { behind } else { before.unwrap_or(f64::NEG_INFINITY) };
            let most = if of.turns { top } else { behind };
            self.lengths[place] = sign * length.min(most).max(least);
        }
        if let Some(turn) = turn {
            let behind = (of.gap.start..=of.gap.end).find(|place| of.series[0][*place] >= turn.time);
            // A reading at the turn is it.
            if let Some(behind) = behind.filter(|place| of.series[0][*place] > turn.time) {
                self.turns[behind] = Some(Turn { time: turn.time, length: sign * top });
            }
        }
    }
}

impl Gap<'_> {
    /// The way, unless the readings are it.
    fn way(&self) -> Option<Way> {
        let [time, _] = self.series;
        if self.around.start == self.gap.start || self.around.end == self.gap.end {
            return self.pooled();
        }
        let mut width = WIDEST;
        while width > 0 {
            let within = self.gap.start.saturating_sub(width).max(self.around.start)
                ..(self.gap.end + width).min(self.around.end);
            let fits = |pieces: &Pieces| are_noise(pieces.squares, pieces.freedom, self.noise);
            let scatter = |pieces: &Pieces| pieces.squares / pieces.freedom as f64;
            let turns = [self.quartic(within.clone()), self.corner(within.clone(), 1), self.corner(within.clone(), 2)];
            let turns = turns.into_iter().flatten().filter(fits);
            let best = turns.min_by(|one, other| scatter(one).total_cmp(&scatter(other)));
            if let Some(best) = best.or_else(|| self.rest(within).filter(fits)) {
                let turn = best.turn.map(|turn| Turn { time: turn, length: best.at(turn).length(turn) });
                let inner = || time[self.gap.clone()].iter().map(|time| (best.at(*time), *time));
                let velocity = |(piece, time): (&Polynomial, f64)| {
                    [piece.velocity(time), piece.error_of_velocity(time, self.noise)]
                };
                let lengths = inner().map(|(piece, time)| piece.length(time)).collect();
                return Some(Way { lengths, velocities: inner().map(velocity).collect(), turn });
            }
            width /= 2;
        }
        self.pooled()
    }

    /// Time in s of the last reading before the gap and of the first one behind it.
    fn ends(&self) -> [f64; 2] {
        let [time, _] = self.series;
        [time[self.gap.start - 1], time[self.gap.end]]
    }

    /// A quartic, which rises before the gap, and turns once in it or not at all.
    fn quartic(&self, within: Range<usize>) -> Option<Pieces> {
        let quartic = Polynomial::through(self.series, within, 4)?;
        let [begin, end] = self.ends();
        let falls = |time: f64| quartic.velocity(time) < 0.0;
        let turn = self.turns.then(|| crossing(begin, end, |time| -quartic.velocity(time))).flatten();
        let inner = self.gap.clone().map(|place| self.series[0][place]);
        let goes_well = inner.chain([begin, end]).all(|time| falls(time) == turn.is_some_and(|turn| time > turn));
        let (squares, freedom) = (quartic.squares, quartic.freedom);
        (goes_well && freedom > 0 && turn.is_some() == self.turns).then(|| Pieces {
            pieces: Vec::new(),
            last: quartic,
            turn,
            squares,
            freedom,
        })
    }

    /// Two polynomials that meet in the gap.
    fn corner(&self, within: Range<usize>, degree: usize) -> Option<Pieces> {
        let ([time, _], [begin, end]) = (self.series, self.ends());
        let through = |within: Range<usize>| Polynomial::through(self.series, within, degree);
        let (mut split, mut found) = ([self.gap.start, self.gap.end], None);
        for _ in 0..ASSIGNMENTS {
            let (before, behind) = (through(within.start..split[0])?, through(split[1]..within.end)?);
            let meet = crossing(begin, end, |time| before.length(time) - behind.length(time))?;
            let is_turn = before.velocity(meet) > 0.0 && (behind.velocity(meet) < 0.0) == self.turns;
            if !is_turn {
                return None;
            }
            let (squares, freedom) = (before.squares + behind.squares, before.freedom + behind.freedom);
            let turn = self.turns.then_some(meet);
            let all = split[0] == split[1] && freedom > 0;
            found = all.then(|| Pieces { pieces: vec![(meet, before)], last: behind, turn, squares, freedom });
            let next = [self.gap.start + self.gap.clone().take_while(|place| time[*place] <= meet).count(); 2];
            if next == split {
                break;
            }
            split = next;
        }
        found
    }

    /// A level between two straight lines.
    fn rest(&self, within: Range<usize>) -> Option<Pieces> {
        let ([time, _], [begin, end]) = (self.series, self.ends());
        let (mut rest, mut found) = (self.gap.clone(), None);
        for _ in 0..ASSIGNMENTS {
            let before = Polynomial::through(self.series, within.start..rest.start, 1)?;
            let level = Polynomial::through(self.series, rest.clone(), 0)?;
            let behind = Polynomial::through(self.series, rest.end..within.end, 1)?;
            let goes_well = before.velocity(begin) > 0.0 && (behind.velocity(end) < 0.0) == self.turns;
            let halts = crossing(begin, end, |time| before.length(time) - level.length(time))?;
            let starts = crossing(begin, end, |time| behind.length(time) - level.length(time))?;
            if !goes_well || halts > starts {
                return None;
            }
            let squares = before.squares + level.squares + behind.squares;
            let freedom = before.freedom + level.freedom + behind.freedom;
            let pieces = vec![(halts, before), (starts, level)];
            found = (freedom > 0).then_some(Pieces { pieces, last: behind, turn: None, squares, freedom });
            let until =
                |limit: f64| self.gap.start + self.gap.clone().take_while(|place| time[*place] <= limit).count();
            let next = until(halts)..until(starts);
            if next == rest {
                break;
            }
            rest = next;
        }
        found
    }

    /// The closest way that rises, and falls behind its turn if it has one.
    fn pooled(&self) -> Option<Way> {
        let length = &self.series[1][self.gap.clone()];
        let (rising, way) = (Pooled::rising(length.iter().copied()), |count: usize| {
            let mut way = Pooled::rising(length[..count].iter().copied()).lengths();
            let falling = Pooled::rising(length[count..].iter().rev().copied()).lengths();
            way.extend(falling.into_iter().rev());
            way
        });
        let falling = Pooled::rising(length.iter().rev().copied());
        let count = length.len();
        let squares = |rise: usize| rising.squares[rise] + falling.squares[count - rise];
        let rise = match self.turns {
            true => (0..=count).min_by(|one, other| squares(*one).total_cmp(&squares(*other)))?,
            false => count,
        };
        if !are_noise(squares(rise), count, self.noise) {
            return None;
        }
        let lengths = way(rise);
        let turn = if self.turns { self.vertex(&lengths) } else { None };
        Some(Way { lengths, velocities: Vec::new(), turn })
    }

    /// The vertex of the parabola through the longest length and the two beside it.
    fn vertex(&self, way: &[f64]) -> Option<Turn> {
        let top = (0..way.len()).max_by(|one, other| way[*one].total_cmp(&way[*other]))?;
        let here = self.gap.start + top;
        let [time, length] = self.series;
        let at = |place: usize| match self.gap.contains(&place) {
            true => way[place - self.gap.start],
            false => length[place],
        };
        let [before, behind] = [here.checked_sub(1)?, here + 1];
        let [left, right] = [before, behind].map(|place| (time[place] - time[here], at(place) - at(here)));
        let curvature = (right.1 / right.0 - left.1 / left.0) / (right.0 - left.0);
        let slope = right.1 / right.0 - curvature * right.0;
        let ahead = -0.5 * slope / curvature;
        (curvature < 0.0 && (left.0..right.0).contains(&ahead))
            .then(|| Turn { time: time[here] + ahead, length: at(here) + 0.5 * slope * ahead })
    }
}

impl Pieces {
    /// The one that counts at a time in s.
    fn at(&self, time: f64) -> &Polynomial {
        self.pieces.iter().find(|(until, _)| time <= *until).map_or(&self.last, |(_, piece)| piece)
    }
}

/// Where a function of time goes through zero between two times in s, if it changes its sign.
fn crossing(mut begin: f64, mut end: f64, of: impl Fn(f64) -> f64) -> Option<f64> {
    let sign = of(begin);
    if sign * of(end) > 0.0 {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (begin + end);
        if of(middle) * sign > 0.0 { begin = middle } else { end = middle }
    }
    Some(0.5 * (begin + end))
}

/// The closest lengths that do not fall.
struct Pooled {
    /// Mean and number of the lengths that are pooled.
    pools: Vec<(f64, usize)>,
    /// The sum of squared residuals in m² of the first so many lengths, fitted alone.
    squares: Vec<f64>,
}

impl Pooled {
    fn rising(lengths: impl Iterator<Item = f64>) -> Self {
        let (mut pools, mut squares): (Vec<(f64, usize)>, _) = (Vec::new(), vec![0.0]);
        let mut sum = 0.0;
        for length in lengths {
            let mut pool = (length, 1);
            while let Some((mean, count)) = pools.pop_if(|(mean, _)| *mean > pool.0) {
                let [one, other] = [count, pool.1].map(|count| count as f64);
                sum += one * other / (one + other) * (mean - pool.0).powi(2);
                pool = ((one * mean + other * pool.0) / (one + other), count + pool.1);
            }
            pools.push(pool);
            squares.push(sum);
        }
        Self { pools, squares }
    }

    fn lengths(&self) -> Vec<f64> {
        self.pools.iter().flat_map(|(mean, count)| std::iter::repeat_n(*mean, *count)).collect()
    }
}
