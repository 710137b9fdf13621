//! The pressure in the actuator, or at the inlet of its hose, as a given function of time in place of a valve.
//!
//! ```text
//! P_g(t) = (r(t + δ) − o)/s   r: straight lines between the rows (t, r), constant before the first and after the last
//! ṁ        what the process of the air then takes: κ P (ṁ/m − V̇/V) = dP/dt, or by the energy balance
//! ```
//!
//! So what a rig does, and the numbers of its load, force law and friction, follow from a pressure that was measured, whatever
//! made it: nothing of valve, supply or hose need be known. What comes in is as warm as the air inside; the motion does not
//! depend on it. The rows are exact instants, at which the rate jumps.
//!
//! | symbol | name in code | meaning | unit |
//! |---|---|---|---|
//! | o | `offset` | what the sensor shows at zero gauge pressure | Pa |
//! | s | `scale` | its reading over the gauge pressure | – |
//! | δ | `shift` | by how much its readings come late | s |
//!
//! Behind a hose it is the pressure at the end that a valve would open into: what a sensor at the valve measures. The hose's
//! first volume has that pressure, the air in the actuator follows by flows. A lumped hose passes it on its delay later.
//!
//! Checked by `tests/pressure_series.rs`: the static force of an isometric rig, a
//! rig that is fed back the pressure of a simulated valve, the air by each process, and derivatives against differences.

use super::rig::Rig;
#[cfg(feature = "alloc")]
use crate::actuator::Actuator;
use crate::convert::Convert;
#[cfg(feature = "alloc")]
use crate::error::Error;
#[cfg(feature = "alloc")]
use crate::line::Line;
use crate::parameter;
#[cfg(feature = "alloc")]
use crate::pressure::GaugePressure;
use crate::scalar::{Over, Real, Scalar};
use crate::straight::StraightLine;

/// Two things that make the pressure.
#[cfg(feature = "alloc")]
const VALVE_TOO: Error = Error::Misuse {
    what: "the pressure is given over time, and a valve or a leak would change it too",
    remedy: "leave out [valve] and [supply], and actuator.leakage where there is no [hose], or leave out [pressure]",
};

#[cfg(feature = "alloc")]
type Rows<S> = alloc::vec::Vec<[S; 2]>;
/// Without a place for rows there are none.
#[cfg(not(feature = "alloc"))]
type Rows<S> = [[S; 2]; 0];

/// Gauge pressures over time, with straight lines between them.
#[derive(Clone, Debug, PartialEq)]
pub struct PressureSeries<S = f64> {
    /// Time in s and gauge pressure in Pa, as they were recorded.
    rows: Rows<S>,
    /// Offset in Pa and scale of the sensor, and by how many seconds its readings come late.
    sensor: [S; 3],
}

#[cfg(feature = "alloc")]
impl PressureSeries {
    /// Straight lines through `(time, gauge_pressure)` in s and Pa.
    ///
    /// # Errors
    /// [`Error::Table`] when the lists differ in length, are empty, or the times are negative or do not rise;
    /// [`Error::OutOfRange`] for a pressure that is not finite.
    pub fn new(time: &[f64], gauge_pressure: &[f64]) -> Result<Self, Error> {
        if time.len() != gauge_pressure.len() || time.is_empty() {
            return Err(Error::Table {
                name: parameter::SERIES_GAUGE_PRESSURE.key,
                problem: "there is not one pressure for each time",
                entry: time.len().min(gauge_pressure.len()) + 1,
                remedy: "give as many pressures as times",
            });
        }
        crate::valve::check_times(parameter::SERIES_TIME.key, time)?;
        let row = |(time, gauge): (&f64, &f64)| Ok([*time, parameter::SERIES_GAUGE_PRESSURE.check(*gauge)?]);
        let rows = time.iter().zip(gauge_pressure).map(row).collect::<Result<_, Error>>()?;
        Ok(Self { rows, sensor: [0.0, 1.0, 0.0] })
    }

    /// What was recorded by a sensor that shows `offset` in Pa at zero gauge pressure, is `scale` times as steep, and comes `shift` in
    /// s late: P(t) = (r(t + δ) − o)/s. Rows that lie before t = 0 then have passed at the start.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number that is not finite, and a scale that is not above zero.
    pub fn with_sensor(self, offset: f64, scale: f64, shift: f64) -> Result<Self, Error> {
        let offset = parameter::SERIES_OFFSET.check(offset)?;
        let scale = parameter::SERIES_SCALE.check(scale)?;
        Ok(Self { sensor: [offset, scale, parameter::SERIES_SHIFT.check(shift)?], ..self })
    }

    /// The least of its gauge pressures.
    pub fn least(&self) -> GaugePressure {
        GaugePressure(self.values().fold(f64::INFINITY, f64::min))
    }

    /// The greatest of its gauge pressures.
    pub fn greatest(&self) -> GaugePressure {
        GaugePressure(self.values().fold(f64::NEG_INFINITY, f64::max))
    }

    fn values(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.rows.len()).filter_map(|row| Some(self.point(row)?[1]))
    }

    /// The time in s of its last row, from which on it is constant.
    pub fn end(&self) -> f64 {
        self.rows.len().checked_sub(1).and_then(|last| self.row(last)).unwrap_or(0.0)
    }

    /// Checks that nothing else makes the pressure in an actuator with an air line, or at the inlet of its hose, and
    /// that it is physical.
    pub(super) fn check(&self, actuator: &Actuator, line: &Line) -> Result<(), Error> {
        let leaks = line.leakage.is_some() && line.hose.is_none();
        if actuator.valve().is_some() || line.supply.is_some() || leaks {
            return Err(VALVE_TOO);
        }
        let (air, least) = (actuator.air(), self.least());
        if least.absolute(air.atmosphere()).0 <= 0.0 {
            return Err(crate::valve::below_vacuum(&parameter::SERIES_GAUGE_PRESSURE, least, air));
        }
        Ok(())
    }
}

impl<S: Scalar> PressureSeries<S> {
    /// Converts the pressure series to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> PressureSeries<T> {
        #[cfg(not(feature = "alloc"))]
        let rows = [];
        #[cfg(feature = "alloc")]
        let rows = {
            let row = |[time, gauge]: &[S; 2]| {
                let time = convert.parameter(&parameter::SERIES_TIME, *time);
                [time, convert.parameter(&parameter::SERIES_GAUGE_PRESSURE, *gauge)]
            };
            self.rows.iter().map(row).collect()
        };
        let [offset, scale, shift] = self.sensor;
        let sensor = [
            convert.parameter(&parameter::SERIES_OFFSET, offset),
            convert.parameter(&parameter::SERIES_SCALE, scale),
            convert.parameter(&parameter::SERIES_SHIFT, shift),
        ];
        PressureSeries { rows, sensor }
    }

    /// When the pressure of a row holds in s, and that gauge pressure in Pa.
    fn point(&self, row: usize) -> Option<[S; 2]> {
        let [offset, scale, shift] = self.sensor;
        let [time, shown] = *self.rows.get(row)?;
        Some([time - shift, (shown - offset) / scale])
    }

    /// How many rows there are.
    #[cfg(feature = "alloc")]
    pub(crate) fn rows(&self) -> usize {
        self.rows.len()
    }

    /// Instant in s of the row of index `row`.
    pub fn row(&self, row: usize) -> Option<S> {
        self.point(row).map(|[time, _]| time)
    }

    /// The straight line of gauge pressures in Pa after so many rows; before the first and after the last it stays.
    pub fn line(&self, passed: usize) -> StraightLine<S> {
        let last = passed.checked_sub(1).and_then(|last| self.point(last));
        match (last, self.point(passed)) {
            (Some(last), Some(next)) => StraightLine::between(last, next),
            (Some(only), None) | (None, Some(only)) => StraightLine::constant(only[1]),
            // More rows than there are have passed, or there is none: neither can be.
            (None, None) => {
                let end = self.rows.len().checked_sub(1).and_then(|last| self.point(last));
                StraightLine::constant(end.map_or(S::zero(), |row| row[1]))
            }
        }
    }

    /// Gauge pressure in Pa and its rate in Pa/s at a time in s, after so many rows have passed.
    pub fn at<T: Over<S>>(&self, time: T, passed: usize) -> [T; 2] {
        self.line(passed).at(time)
    }
}

impl<S: Real> PressureSeries<S> {
    /// How many rows have passed at a time in s.
    pub(crate) fn passed(&self, time: S) -> usize {
        let has_passed = |row: &usize| self.row(*row).is_some_and(|row| crate::valve::is_due(row, time));
        (0..self.rows.len()).take_while(has_passed).count()
    }

    /// Gauge pressure in Pa at a time in s.
    pub(crate) fn gauge_at(&self, time: S) -> S {
        self.at(time, self.passed(time))[0]
    }
}

impl Rig {
    /// Gives the gauge pressure in the actuator over time. It starts at that of t = 0, whatever [`Initial`](super::Initial)
    /// says. A hose that [`Rig::with_line`] adds then lies between that pressure and the actuator, which starts at its own.
    ///
    /// # Errors
    /// [`Error::Misuse`] for a rig with a valve, a supply, or a leak without a hose; [`Error::Inconsistent`] for a pressure below vacuum.
    #[cfg(feature = "alloc")]
    pub fn with_pressure(self, series: PressureSeries) -> Result<Self, Error> {
        series.check(self.actuator(), self.line())?;
        Ok(self.driven_at(series))
    }
}
