//! A prescribed motion of the attachments.
//!
//! ```text
//! sinusoid   x(t) = L₀ + A sin(2π f₀ t + φ)
//! table      straight lines between (t, x), constant before the first row and after the last
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | x | distance of the attachments | m |
//! | L₀, A | `length`, `amplitude` | m |
//! | f₀, φ | `frequency`, `phase` | Hz, rad |
//!
//! The corners of a table are exact instants, at which the velocity jumps.
//!
//! Checked by `tests/simulation.rs`: a prescribed motion is followed exactly.

use crate::convert::Convert;
use crate::error::{Error, Requirement};
use crate::parameter;
use crate::scalar::{Over, Real, Scalar};
use crate::straight::StraightLine;
use core::f64::consts::TAU;

/// The distance between the attachments as a function of time.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion<S = f64> {
    /// `L₀ + A sin(2π f₀ t + φ)`.
    Sinusoid {
        /// Mean length L₀ in m.
        length: S,
        /// Amplitude A in m.
        amplitude: S,
        /// Frequency f₀ in Hz.
        frequency: S,
        /// Phase φ in rad.
        phase: S,
    },
    /// Straight lines between points.
    #[cfg(feature = "alloc")]
    Table {
        /// Times in s, strictly rising.
        time: alloc::vec::Vec<S>,
        /// Lengths in m.
        length: alloc::vec::Vec<S>,
    },
}

impl Motion {
    /// `length + amplitude · sin(2π · frequency · t + phase)` in m, Hz and rad, kept between 0 and `thread_length`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range; [`Error::Inconsistent`] when the motion would leave
    /// the open interval from 0 to `thread_length`.
    pub fn sinusoid(
        length: f64,
        amplitude: f64,
        frequency: f64,
        phase: f64,
        thread_length: f64,
    ) -> Result<Self, Error> {
        let motion = Self::Sinusoid {
            length: parameter::MOTION_LENGTH.check(length)?,
            amplitude: parameter::MOTION_AMPLITUDE.check(amplitude)?,
            frequency: parameter::MOTION_FREQUENCY.check(frequency)?,
            phase: parameter::MOTION_PHASE.check(phase)?,
        };
        let room = (thread_length - length).min(length);
        if amplitude >= room {
            return Err(Error::Inconsistent {
                parameter: &parameter::MOTION_AMPLITUDE,
                value: amplitude,
                requirement: Requirement {
                    relation: "must be less than",
                    other: "the distance of the mean length from 0 and from the thread length",
                    value: room,
                    unit: "m",
                },
                remedy: "make the motion smaller",
            });
        }
        Ok(motion)
    }

    /// Straight lines through `(time, length)` in s and m, each length between 0 and `thread_length`.
    ///
    /// # Errors
    /// [`Error::Table`] when the lists differ in length, are empty, the times do not rise, or a length is outside.
    #[cfg(feature = "alloc")]
    pub fn table(time: alloc::vec::Vec<f64>, length: alloc::vec::Vec<f64>, thread_length: f64) -> Result<Self, Error> {
        const LENGTH: &str = "load.table_length";
        let fault = |problem, entry, remedy| Err(Error::Table { name: LENGTH, problem, entry, remedy });
        if time.len() != length.len() || time.is_empty() {
            let entry = time.len().min(length.len()) + 1;
            return fault("there is not one length for each time", entry, "give as many lengths as times");
        }
        crate::valve::check_times("load.time", &time)?;
        if let Some(row) = length.iter().position(|x| !(*x > 0.0 && *x < thread_length)) {
            return fault("a length is not between 0 and the thread length", row + 1, "give shorter, positive lengths");
        }
        Ok(Self::Table { time, length })
    }
}

impl<S: Real> Motion<S> {
    /// How many corners of a table have been passed at a time in s.
    pub fn passed(&self, time: S) -> usize {
        let is_passed = |corner: &usize| self.corner(*corner).is_some_and(|corner| crate::valve::is_due(corner, time));
        (0..self.corners()).take_while(is_passed).count()
    }

    /// The speed in m/s to which a velocity at rest is compared: the greatest of a sinusoid, the least of a table's lines that do not
    /// rest. Infinite where all rests.
    pub fn usual_speed(&self) -> f64 {
        let or_none = |speed: f64| if speed > 0.0 { speed } else { f64::INFINITY };
        match self {
            Self::Sinusoid { amplitude, frequency, .. } => or_none((TAU * amplitude.value() * frequency.value()).abs()),
            #[cfg(feature = "alloc")]
            Self::Table { .. } => {
                let speeds = (0..self.corners()).filter_map(|passed| Some(self.line(passed)?.slope.value().abs()));
                speeds.map(or_none).fold(f64::INFINITY, f64::min)
            }
        }
    }

    /// That it has no more than [`MAX_COUNT`](parameter::MAX_COUNT) periods in a run of `duration` s.
    ///
    /// # Errors
    /// [`Error::TooMany`] otherwise.
    pub fn check_counts(&self, duration: f64) -> Result<(), Error> {
        match self {
            Self::Sinusoid { frequency, .. } => {
                let frequency = frequency.value();
                parameter::MOTION_FREQUENCY.check_count(frequency, frequency * duration, "periods of the motion")?;
            }
            #[cfg(feature = "alloc")]
            Self::Table { .. } => {}
        }
        Ok(())
    }
}

impl<S: Scalar> Motion<S> {
    /// Converts the motion to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Motion<T> {
        match self {
            Self::Sinusoid { length, amplitude, frequency, phase } => Motion::Sinusoid {
                length: convert.parameter(&parameter::MOTION_LENGTH, *length),
                amplitude: convert.parameter(&parameter::MOTION_AMPLITUDE, *amplitude),
                frequency: convert.parameter(&parameter::MOTION_FREQUENCY, *frequency),
                phase: convert.parameter(&parameter::MOTION_PHASE, *phase),
            },
            #[cfg(feature = "alloc")]
            Self::Table { time, length } => Motion::Table {
                time: time.iter().map(|&t| convert.parameter(&parameter::MOTION_TIME, t)).collect(),
                length: length.iter().map(|&x| convert.parameter(&parameter::MOTION_TABLE_LENGTH, x)).collect(),
            },
        }
    }

    /// Number of corners in a table.
    pub fn corners(&self) -> usize {
        match self {
            Self::Sinusoid { .. } => 0,
            #[cfg(feature = "alloc")]
            Self::Table { time, .. } => time.len(),
        }
    }

    /// Instant in s of the corner of index `corner`.
    pub fn corner(&self, corner: usize) -> Option<S> {
        #[cfg(not(feature = "alloc"))]
        let _ = corner;
        match self {
            Self::Sinusoid { .. } => None,
            #[cfg(feature = "alloc")]
            Self::Table { time, .. } => time.get(corner).copied(),
        }
    }

    /// The straight line of a table after so many corners; before the first and after the last it rests. None of a sinusoid.
    pub fn line(&self, passed: usize) -> Option<StraightLine<S>> {
        #[cfg(not(feature = "alloc"))]
        let _ = passed;
        match self {
            Self::Sinusoid { .. } => None,
            #[cfg(feature = "alloc")]
            Self::Table { time, length } => {
                let next = passed.min(length.len());
                if next == 0 || next == length.len() {
                    return Some(StraightLine::constant(length[next.max(1) - 1]));
                }
                let row = |row: usize| [time[row], length[row]];
                Some(StraightLine::between(row(next - 1), row(next)))
            }
        }
    }

    /// Length (m), velocity (m/s) and acceleration (m/s²) at `time`. Of a table, on the straight line after `passed` corners.
    pub fn at<T: Over<S>>(&self, time: T, passed: usize) -> [T; 3] {
        self.on(time, self.line(passed))
    }

    /// These at `time`, where the straight line of a table is known.
    #[inline(always)]
    pub fn on<T: Over<S>>(&self, time: T, line: Option<StraightLine<S>>) -> [T; 3] {
        #[cfg(not(feature = "alloc"))]
        let _ = line;
        match self {
            Self::Sinusoid { length, amplitude, frequency, phase } => {
                let rate = T::constant(TAU) * T::of(*frequency);
                let angle = rate * time + T::of(*phase);
                let swing = T::of(*amplitude) * angle.sin();
                [T::of(*length) + swing, T::of(*amplitude) * rate * angle.cos(), -rate * rate * swing]
            }
            #[cfg(feature = "alloc")]
            Self::Table { .. } => {
                let [length, velocity] = match line {
                    Some(line) => line.at(time),
                    None => [T::zero(); 2],
                };
                [length, velocity, T::zero()]
            }
        }
    }
}
