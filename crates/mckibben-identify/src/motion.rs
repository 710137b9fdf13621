//! Direction and velocity of a length that was read with noise.
//!
//! ```text
//! L(t_k + u) ≈ ℓ_k + v_k u + ½ a_k u²        least squares over the readings k − m … k + m
//! σ_v(m) = σ √C₂₂                            C: the inverse of the normal matrix;  √(3/(m (m + 1)(2m + 1))) σ/h for readings every h
//!        … + ⅙ j_k u³                        the velocity, over as many readings as a cubic fits (`polynomial`)
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | σ, noise of a reading | `noise` | m |
//! | m, readings to either side | `half` | – |
//! | ℓ, v | `path`, `velocity` | m, m/s |
//!
//! A velocity is clear where it is many times σ_v. The window of a direction is the two neighbours of the reading where they make it clear
//! by far ([`CLEAR_ALONE`]), so that readings without noise lose nothing. Otherwise it is twice as long as the shortest of m = 1, 2, 4 … in
//! which the velocity is clear ([`CLEAR`]): were it that one itself, noise would choose the window in which it makes the velocity larger.
//! Its velocity is then about 22 times σ_v or more.
//!
//! That is enough for a direction, and not for a velocity. Next to dry friction only changes of the speed identify damping, and of these
//! σ_v is a larger part. And a window that is longer where the length is slower takes more off small velocities than off large ones, since
//! the parabola of a sine has a slope that is too small by (ω m h)²/10. At 2 mm and 3 Hz with noise of 20 µm both made the damping 2 % too
//! small and the dry friction 1.6 % too large, however long the record. So the velocity is that of the cubic with the smallest standard
//! error among those that fit their readings as well as the noise lets them, and whose halves both go its way. Its windows are twice as long
//! as the ones before, until two have no such cubic, or one is certain enough ([`CLEAR_ENOUGH`]): the ones about the reading, whose cubic
//! misses the slope of a sine by (ω m h)⁴/504 alone, and where these reach over a corner, the ones that lie to one side by half of their own
//! half. How well a cubic fits says nothing of the noise of its slope, so that this choice biases none. Were the first misfit the last word,
//! one velocity in a hundred would be that of five readings, by chance: at a constant speed with steps of 10 µm and noise of 1 µm such
//! outliers made the Stribeck velocity a tenth too small.
//!
//! A reading has no direction where one half of its window does not go its way with at least half of its velocity (a reversal, a rest or
//! a change of speed is near), where no window is long enough, and where its window passes the end of the record. It does not count, either,
//! where the standard error of its velocity is more than a thirtieth of that velocity and of the median speed.
//!
//! σ is the largest of the stated one, the scatter of the readings about parabolas through their neighbours, and that of a sensor's steps
//! ([`series::noise`]). Lengths that go on by equal steps are those of a constant speed, not of a sensor.
//! Checked by `tests/loops.rs`.

use crate::median::median;
use crate::path::Path;
use crate::polynomial::Polynomial;
use crate::series;

/// Standard errors from which on a velocity is clear.
const CLEAR: f64 = 10.0;
/// Standard errors from which on the two neighbours of a reading alone give its velocity.
const CLEAR_ALONE: f64 = 30.0;
/// Standard errors from which on a velocity gains nothing from more readings.
const CLEAR_ENOUGH: f64 = 300.0;
/// Windows without a cubic that fits after which a longer one has none either.
const MISSES: u32 = 2;
/// Part of the velocity that each half of a window must show.
const OF_EACH_HALF: f64 = 0.5;
/// Readings to either side that the longest window for a choice has.
const LONGEST: usize = 256;
/// Part of a step by which equal steps may differ.
const EQUAL: f64 = 0.1;
/// Noise of a length in units of its rounding, at least.
const ROUNDING: f64 = 8.0;

/// What is known of the motion at one reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moving {
    /// Velocity in m/s.
    pub(crate) velocity: f64,
    /// Standard error of the velocity in m/s.
    pub(crate) error: f64,
    /// Readings to either side that its direction is from.
    pub(crate) half: usize,
}

/// A motion by its readings.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Motion {
    /// Standard deviation of a reading in m.
    pub(crate) noise: f64,
    /// The way of the length.
    pub(crate) path: Path,
    /// The motion at each reading, where its direction is known.
    pub(crate) moving: Vec<Option<Moving>>,
}

/// The readings to either side of one, as many as `half`: how far in s they reach, and of each the time, from −1 to 1, and the length in
/// m less that of the one; `None` where there are not so many.
fn window<'r>(
    time: &'r [f64],
    length: &'r [f64],
    (at, half): (usize, usize),
) -> Option<(f64, impl Iterator<Item = (f64, f64)> + Clone + 'r)> {
    let window = at.checked_sub(half)?..=at + half;
    let reach = (time.get(at + half)? - time[at]).max(time[at] - time[at - half]);
    Some((reach, window.map(move |place| ((time[place] - time[at]) / reach, length[place] - length[at]))))
}

/// The middle of a parabola through readings.
#[derive(Clone, Copy)]
struct Middle {
    /// Its value in m, less that of the reading.
    offset: f64,
    /// In m/s.
    velocity: f64,
    /// Standard error of the velocity in m/s.
    standard_error: f64,
}

impl Middle {
    /// Of the readings in a [`window`]; `None` where there are not so many, or they determine no parabola.
    fn new(time: &[f64], length: &[f64], noise: f64, within: (usize, usize)) -> Option<Self> {
        let (reach, window) = window(time, length, within)?;
        // Sums of powers of the time from −1 to 1, and of these times the length.
        let (mut s, mut y) = ([0.0; 5], [0.0; 3]);
        for (u, off) in window {
            let square = u * u;
            for (sum, power) in s.iter_mut().zip([1.0, u, square, square * u, square * square]) {
                *sum += power;
            }
            for (sum, power) in y.iter_mut().zip([1.0, u, square]) {
                *sum += power * off;
            }
        }
        // The first two rows of the adjoint of the normal matrix.
        let first = [s[2] * s[4] - s[3] * s[3], s[2] * s[3] - s[1] * s[4], s[1] * s[3] - s[2] * s[2]];
        let second = [first[1], s[0] * s[4] - s[2] * s[2], s[1] * s[2] - s[0] * s[3]];
        let along = |row: [f64; 3], with: [f64; 3]| row.iter().zip(with).map(|(a, b)| a * b).sum::<f64>();
        let determinant = along(first, [s[0], s[1], s[2]]);
        let middle = Self {
            offset: along(first, y) / determinant,
            velocity: along(second, y) / determinant / reach,
            standard_error: noise * (second[1] / determinant).sqrt() / reach,
        };
        (middle.velocity.is_finite() && middle.standard_error.is_finite()).then_some(middle)
    }

    fn is_clear(&self, times: f64) -> bool {
        self.velocity.abs() > times * self.standard_error
    }
}

/// The motion at a reading whose direction is known, with a velocity from as many readings as a cubic fits, and the length in m there.
fn refined(time: &[f64], length: &[f64], noise: f64, (at, known): (usize, Moving)) -> Option<(Moving, f64)> {
    let middle = |at: usize, half: usize| Middle::new(time, length, noise, (at, half));
    let narrow = middle(at, known.half)?;
    let (mut found, mut smooth) = (Moving { error: narrow.standard_error, ..known }, length[at] + narrow.offset);
    // By so many readings to either side of one: whether it fits, and whether it also goes its way.
    let cubic = |centre: usize, half: usize| {
        let cubic = Polynomial::through([time, length], centre.checked_sub(half)?..centre + half + 1, 3)?;
        let (before, after) = (middle(centre - half / 2, half / 2)?, middle(centre + half / 2, half / 2)?);
        let velocity = cubic.velocity(time[at]);
        let goes_its_way = velocity * known.velocity > 0.0 && agree(velocity, [before.velocity, after.velocity]);
        cubic.fits(noise).then_some((cubic, goes_its_way))
    };
    let (mut half, mut is_cubic, mut misses) = (known.half.max(2), false, 0);
    while half <= 2 * LONGEST && misses < MISSES && found.velocity.abs() <= CLEAR_ENOUGH * found.error {
        let aside = || [at.checked_sub(half / 2), Some(at + half / 2)].into_iter().flatten();
        let best = cubic(at, half).or_else(|| {
            let cubics = aside().filter_map(|centre| cubic(centre, half)).filter(|(_, goes_its_way)| *goes_its_way);
            cubics.min_by(|one, other| one.0.squares.total_cmp(&other.0.squares))
        });
        let best = best.filter(|(_, goes_its_way)| *goes_its_way);
        misses = if best.is_some() { 0 } else { misses + 1 };
        if let Some((cubic, _)) = best {
            let error = cubic.error_of_velocity(time[at], noise);
            if !is_cubic || error < found.error {
                (found.velocity, found.error, smooth) = (cubic.velocity(time[at]), error, cubic.length(time[at]));
                is_cubic = true;
            }
        }
        half *= 2;
    }
    Some((found, smooth))
}

/// Whether the velocities of both halves of a window go with the velocity of all of it.
fn agree(velocity: f64, halves: [f64; 2]) -> bool {
    halves.iter().all(|half| half * velocity.signum() >= OF_EACH_HALF * velocity.abs())
}

/// Standard deviation in m of lengths that are read in steps, unless most lengths are one step from the one before.
fn noise_of_steps(length: &[f64]) -> f64 {
    let (step, ways) = (series::resolution(length), length.windows(2).map(|pair| (pair[1] - pair[0]).abs()));
    let usual = median(&ways.collect::<Vec<_>>()).unwrap_or(0.0);
    if (usual - step).abs() <= EQUAL * step { 0.0 } else { step / 12.0_f64.sqrt() }
}

impl Motion {
    /// By times in s, which rise, and lengths in m, whose noise is at least the stated deviation in m.
    pub(crate) fn new(time: &[f64], length: &[f64], deviation: Option<f64>) -> Self {
        let largest = length.iter().fold(0.0_f64, |largest, length| largest.max(length.abs()));
        let stated = deviation.unwrap_or(0.0).max(ROUNDING * f64::EPSILON * largest);
        let noise = stated.max(series::visible_noise(time, length)).max(noise_of_steps(length));
        let middles = |half: usize| -> Vec<Option<Middle>> {
            (0..time.len()).map(|at| Middle::new(time, length, noise, (at, half))).collect()
        };
        let (mut smooth, mut moving) = (length.to_vec(), vec![None; time.len()]);
        let mut narrow = middles(1);
        let mut open = Vec::new();
        for (at, middle) in narrow.iter().enumerate() {
            let Some(Middle { velocity, standard_error: error, .. }) = *middle else { continue };
            let step = |to: usize| (length[to] - length[to - 1]) / (time[to] - time[to - 1]);
            match middle.is_some_and(|middle| middle.is_clear(CLEAR_ALONE)) {
                true => {
                    moving[at] =
                        agree(velocity, [step(at), step(at + 1)]).then_some(Moving { velocity, error, half: 1 });
                }
                false => open.push(at),
            }
        }
        let mut half = 1;
        while half <= LONGEST && !open.is_empty() {
            let wide = middles(2 * half);
            open.retain(|at| {
                let (Some(all), Some(middle)) = (wide[*at], narrow[*at]) else { return false };
                let (Some(before), Some(after)) = (narrow[at - half], narrow[at + half]) else { return false };
                if middle.is_clear(CLEAR) {
                    if agree(all.velocity, [before.velocity, after.velocity]) {
                        let (velocity, error) = (all.velocity, all.standard_error);
                        moving[*at] = Some(Moving { velocity, error, half: 2 * half });
                    }
                    return false;
                }
                // A longer window would only hide this reversal.
                let reverses =
                    before.is_clear(CLEAR) && after.is_clear(CLEAR) && before.velocity * after.velocity < 0.0;
                !reverses
            });
            (narrow, half) = (wide, 2 * half);
        }
        for at in 0..time.len() {
            if let Some((known, length)) = moving[at].and_then(|known| refined(time, length, noise, (at, known))) {
                (moving[at], smooth[at]) = (Some(known), length);
            }
        }
        let path = Path::new([time, length], noise, &mut moving, smooth);
        let speeds: Vec<f64> = moving.iter().flatten().map(|known| known.velocity.abs()).collect();
        let most = median(&speeds).unwrap_or(0.0) / CLEAR_ALONE;
        for moving in &mut moving {
            *moving = moving.filter(|known| known.error <= most.max(known.velocity.abs() / CLEAR_ALONE));
        }
        Self { noise, path, moving }
    }
}
