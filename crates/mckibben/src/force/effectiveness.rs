//! Effectiveness: the ratio of measured to ideal force as a law over gauge pressure (9).
//!
//! ```text
//! F_s = Eff(P_g) · F_ideal        (9)
//! ```
//!
//! | form | law | outside its data |
//! |---|---|---|
//! | constant | `e` | the same |
//! | polynomial | `e₀ + e₁ P_g + e₂ P_g² + …` with `P_g` in Pa | goes on |
//! | table | monotone cubic through `(P_g, e)` (Fritsch & Carlson), never overshoots | constant |
//!
//! The slopes of the table at its knots are the weighted harmonic means of Fritsch & Butland (1984), with a
//! three-point rule at the ends; this is the interpolant that SciPy calls PCHIP.
//! A factor that depends on pressure at fixed geometry makes the law non-conservative: the energy audit shows by how
//! much.
//! Source: Colbrunn, Nelson & Quinn (2001), section 2.1; Fritsch & Carlson (1980).
//! Checked by `tests/force.rs`: against SciPy's interpolant, no overshoot, slopes against finite differences.

use super::StaticForce;
use super::monotone::Knots;
use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::pressure::GaugePressure;
use crate::scalar::{Over, Scalar, Work};

/// The largest number of polynomial coefficients.
pub const MAX_COEFFICIENTS: usize = 8;
/// The largest number of table rows.
pub const MAX_KNOTS: usize = 16;

/// Measured force over ideal force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effectiveness<S = f64> {
    /// Constant over pressure.
    Constant(S),
    /// Coefficients of rising powers of the gauge pressure in Pa; unused ones are zero.
    Polynomial([S; MAX_COEFFICIENTS]),
    /// A monotone cubic through measured points.
    Table(Table<S>),
}

/// Measured points with a monotone cubic through them. Made by [`Effectiveness::table`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Table<S = f64> {
    rows: usize,
    gauge_pressure: [S; MAX_KNOTS],
    value: [S; MAX_KNOTS],
    slope: [S; MAX_KNOTS],
}

impl Effectiveness {
    /// A ratio that is constant over pressure, zero or more.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when it is negative or not finite.
    pub fn constant(ratio: f64) -> Result<Self, Error> {
        Ok(Self::Constant(parameter::EFFECTIVENESS.check(ratio)?))
    }

    /// Coefficients of rising powers of the gauge pressure in Pa.
    ///
    /// # Errors
    /// [`Error::Table`] when there are none, more than [`MAX_COEFFICIENTS`], or one is not finite.
    pub fn polynomial(coefficients: &[f64]) -> Result<Self, Error> {
        const NAME: &str = "actuator.effectiveness.polynomial";
        check_list(NAME, coefficients, 1, MAX_COEFFICIENTS)?;
        let mut padded = [0.0; MAX_COEFFICIENTS];
        padded[..coefficients.len()].copy_from_slice(coefficients);
        Ok(Self::Polynomial(padded))
    }

    /// Measured ratios at rising gauge pressures in Pa.
    ///
    /// # Errors
    /// [`Error::Table`] when the lists differ in length, hold fewer than 2 or more than [`MAX_KNOTS`] rows, are not
    /// strictly rising in pressure, or hold a negative ratio.
    pub fn table(gauge_pressure: &[f64], value: &[f64]) -> Result<Self, Error> {
        const PRESSURE: &str = "actuator.effectiveness.gauge_pressure";
        const VALUE: &str = "actuator.effectiveness.value";
        check_list(PRESSURE, gauge_pressure, 2, MAX_KNOTS)?;
        check_list(VALUE, value, 2, MAX_KNOTS)?;
        let table = |name, problem, entry, remedy| Err(Error::Table { name, problem, entry, remedy });
        if value.len() != gauge_pressure.len() {
            let entry = value.len().min(gauge_pressure.len()) + 1;
            return table(
                VALUE,
                "it has not as many entries as the pressures",
                entry,
                "give one value for each pressure",
            );
        }
        if let Some(row) = gauge_pressure.windows(2).position(|pair| pair[1] <= pair[0]) {
            return table(PRESSURE, "the pressures do not rise", row + 2, "sort the rows by pressure and drop repeats");
        }
        if let Some(row) = value.iter().position(|&ratio| ratio < 0.0) {
            return table(VALUE, "a ratio is negative", row + 1, "give ratios of zero or more");
        }
        let mut pressures = [0.0; MAX_KNOTS];
        let mut values = [0.0; MAX_KNOTS];
        pressures[..value.len()].copy_from_slice(gauge_pressure);
        values[..value.len()].copy_from_slice(value);
        Ok(Self::Table(Table::assemble(value.len(), pressures, values)))
    }
}

fn check_list(name: &'static str, list: &[f64], least: usize, most: usize) -> Result<(), Error> {
    let fault = |problem, entry, remedy| Err(Error::Table { name, problem, entry, remedy });
    if list.len() < least {
        return fault("it has too few entries", list.len() + 1, "give more entries");
    }
    if list.len() > most {
        return fault("it has too many entries", most + 1, "keep to 8 coefficients or 16 rows");
    }
    match list.iter().position(|number| !number.is_finite()) {
        Some(place) => fault("an entry is not a finite number", place + 1, "give finite numbers"),
        None => Ok(()),
    }
}

impl<S: Scalar> Effectiveness<S> {
    /// The ratio at a gauge pressure.
    #[inline(always)]
    pub fn at<T: Over<S>>(&self, gauge: GaugePressure<T>) -> T {
        match self {
            Self::Constant(ratio) => T::of(*ratio),
            Self::Polynomial(coefficients) => {
                // No closure: it would be compiled separately, without the instructions of a batch.
                let mut ratio = T::zero();
                for coefficient in coefficients.iter().rev() {
                    ratio = ratio.multiply_add(gauge.0, T::of(*coefficient));
                }
                ratio
            }
            Self::Table(table) => T::apart(Between { table, pressure: gauge.0 }),
        }
    }

    /// The ratio by the formula of one piece, smoothly continued beyond the piece's bounds.
    ///
    /// A table of n rows has the pieces 0 (constant below the first row), 1 to n − 1 (the cubics) and n (constant above
    /// the last row); the other forms have the piece 0 alone.
    #[inline(always)]
    pub fn in_piece<T: Over<S>>(&self, piece: usize, gauge: GaugePressure<T>) -> T {
        match self {
            Self::Table(table) => table.in_piece(piece, gauge.0),
            _ => self.at(gauge),
        }
    }

    /// Gauge pressures in Pa between which a piece holds; `None` where it has no end.
    pub fn piece_bounds(&self, piece: usize) -> (Option<S>, Option<S>) {
        let Self::Table(table) = self else { return (None, None) };
        let knot = |row: usize| (row < table.rows).then(|| table.gauge_pressure[row]);
        (piece.checked_sub(1).and_then(knot), knot(piece))
    }

    /// Converts the law to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Effectiveness<T> {
        match self {
            Self::Constant(ratio) => Effectiveness::Constant(convert.parameter(&parameter::EFFECTIVENESS, *ratio)),
            Self::Polynomial(coefficients) => {
                let row = &parameter::EFFECTIVENESS_POLYNOMIAL;
                Effectiveness::Polynomial(coefficients.map(|coefficient| convert.parameter(row, coefficient)))
            }
            Self::Table(table) => {
                let mut list = |row, list: [S; MAX_KNOTS]| list.map(|number| convert.parameter(row, number));
                let pressures = list(&parameter::EFFECTIVENESS_PRESSURE, table.gauge_pressure);
                let values = list(&parameter::EFFECTIVENESS_VALUE, table.value);
                Effectiveness::Table(match convert.carry() {
                    Some(carry) => Table {
                        rows: table.rows,
                        gauge_pressure: pressures,
                        value: values,
                        slope: table.slope.map(carry),
                    },
                    None => Table::assemble(table.rows, pressures, values),
                })
            }
        }
    }
}

impl<S: Scalar> Table<S> {
    fn assemble(rows: usize, gauge_pressure: [S; MAX_KNOTS], value: [S; MAX_KNOTS]) -> Self {
        let mut table = Self { rows, gauge_pressure, value, slope: [S::zero(); MAX_KNOTS] };
        let knots = Knots { count: rows, place: |row: usize| gauge_pressure[row], value: |row: usize| value[row] };
        for row in 0..rows {
            table.slope[row] = knots.slope(row);
        }
        table
    }

    #[inline(always)]
    fn width(&self, interval: usize) -> S {
        self.gauge_pressure[interval + 1] - self.gauge_pressure[interval]
    }

    #[inline(always)]
    fn in_piece<T: Over<S>>(&self, piece: usize, pressure: T) -> T {
        if piece == 0 {
            T::of(self.value[0])
        } else if piece < self.rows {
            self.cubic(piece - 1, pressure)
        } else {
            T::of(self.value[self.rows - 1])
        }
    }

    /// The cubic from row `row` to the next.
    #[inline(always)]
    fn cubic<T: Over<S>>(&self, row: usize, pressure: T) -> T {
        let width = T::of(self.width(row));
        let u = (pressure - T::of(self.gauge_pressure[row])) / width;
        let (start, end) = (T::of(self.value[row]), T::of(self.value[row + 1]));
        let (m0, m1) = (T::of(self.slope[row]) * width, T::of(self.slope[row + 1]) * width);
        let (rise, two) = (end - start, T::constant(2.0));
        let square = T::constant(3.0) * rise - two * m0 - m1;
        start + u * (m0 + u * (square + u * (m0 + m1 - two * rise)))
    }
}

/// The ratio of a table at a pressure, whatever the piece.
struct Between<'a, S, T> {
    table: &'a Table<S>,
    pressure: T,
}

impl<S: Scalar, T: Over<S>> Work for Between<'_, S, T> {
    type Output = T;
    #[inline(always)]
    fn done(self) -> T {
        let Self { table, pressure } = self;
        let mut value = T::of(table.value[0]);
        for row in 0..table.rows - 1 {
            let started = T::of(table.gauge_pressure[row]).lt(pressure);
            value = T::select(started, table.cubic(row, pressure), value);
        }
        let last = T::of(table.gauge_pressure[table.rows - 1]);
        T::select(last.lt(pressure), T::of(table.value[table.rows - 1]), value)
    }
}

/// A static law multiplied by an effectiveness, (9).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effective<Law, S = f64> {
    /// The law that is corrected.
    pub law: Law,
    /// The ratio of measured to ideal force.
    pub effectiveness: Effectiveness<S>,
}

impl<S: Scalar, Law: StaticForce<S>> StaticForce<S> for Effective<Law, S> {
    #[inline(always)]
    fn force<T: Over<S>>(&self, length: T, gauge: GaugePressure<T>) -> T {
        self.effectiveness.at(gauge) * self.law.force(length, gauge)
    }

    #[inline(always)]
    fn secant_stiffness<T: Over<S>>(&self, length: T, from: T, gauge: GaugePressure<T>) -> T {
        self.effectiveness.at(gauge) * self.law.secant_stiffness(length, from, gauge)
    }
}
