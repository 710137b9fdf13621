//! How far from the axis a tendon pulls: a pulley of constant radius, or a moment arm that depends on the angle.
//!
//! ```text
//! torque = r(θ) F        dL/dθ = ∓r(θ)        e(θ) = ∫₀^θ r dθ        L = ℓ ∓ e(θ)
//! ```
//!
//! The excursion e is the exact integral of the arm, so that the tendon's work is the joint's whatever the angle. A table
//! is a monotone cubic between its rows: the arm has a continuous slope and never passes the rows on either side. Beyond
//! the table the arm stays that of its end; there, alone, its slope jumps.
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | r | `arm`, above zero | m |
//! | e | `excursion`, nil at angle zero | m |
//! | θ | `angle` | rad |
//!
//! Arms are above zero: a tendon that crosses the axis would turn the joint the other way, and its length would name two
//! angles.
//!
//! Source: virtual work; K. N. An, K. Takahashi, T. P. Harrigan and E. Y. Chao, "Determination of muscle orientations and
//! moment arms", J. Biomech. Eng. 106, 280–282 (1984). Checked by `tests/moment_arm.rs`.

#[cfg(feature = "alloc")]
use crate::convert::Convert;
use crate::error::Error;
use crate::force::Knots;
use crate::parameter;
use crate::root;
use crate::scalar::{Over, Real, Scalar};

/// The largest number of rows of a table.
pub const MAX_ARMS: usize = 16;

/// The moment arm of a tendon about a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MomentArm<S = f64> {
    /// A pulley of this radius in m.
    Pulley(S),
    /// A monotone cubic through measured points.
    Table(ArmTable<S>),
}

/// Measured moment arms with a monotone cubic through them. Made by [`MomentArm::table`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmTable<S = f64> {
    rows: usize,
    angle: [S; MAX_ARMS],
    arm: [S; MAX_ARMS],
    slope: [S; MAX_ARMS],
    /// `∫₀^θ r dθ` at each row.
    excursion: [S; MAX_ARMS],
}

impl MomentArm {
    /// A pulley of a radius in m, above zero.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] otherwise.
    pub fn pulley(radius: f64) -> Result<Self, Error> {
        Ok(Self::Pulley(parameter::PULLEY_RADIUS.check(radius)?))
    }

    /// Moment arms in m, above zero, at rising angles in rad.
    ///
    /// # Errors
    /// [`Error::Table`] when the lists differ in length, hold fewer than 2 or more than [`MAX_ARMS`] rows, or the angles do
    /// not rise; [`Error::OutOfRange`] for an arm that is not above zero, or an angle that is not finite.
    pub fn table(angle: &[f64], arm: &[f64]) -> Result<Self, Error> {
        let (of_angles, of_arms) = (parameter::MOMENT_ARM_ANGLE.key, parameter::MOMENT_ARM.key);
        let fault = |name, problem, entry, remedy| Err(Error::Table { name, problem, entry, remedy });
        let rows = angle.len();
        if rows < 2 {
            return fault(of_angles, "it has too few entries", rows + 1, "give 2 rows or more, or a pulley_radius");
        }
        if rows > MAX_ARMS {
            return fault(of_angles, "it has too many entries", MAX_ARMS + 1, "keep to 16 rows");
        }
        if arm.len() != rows {
            let entry = arm.len().min(rows) + 1;
            let problem = "it has not as many entries as the angles";
            return fault(of_arms, problem, entry, "give one moment arm for each angle");
        }
        for row in 0..rows {
            parameter::MOMENT_ARM_ANGLE.check(angle[row])?;
            parameter::MOMENT_ARM.check(arm[row])?;
        }
        if let Some(row) = angle.windows(2).position(|pair| pair[1] <= pair[0]) {
            return fault(of_angles, "the angles do not rise", row + 2, "sort the rows by angle and drop repeats");
        }
        // Rows that are not there repeat the last, and are never evaluated.
        let padded = |list: &[f64]| core::array::from_fn(|row| list[row.min(rows - 1)]);
        Ok(Self::Table(ArmTable::assemble(rows, padded(angle), padded(arm))))
    }

    /// That what was put together by hand is in range.
    pub(crate) fn check(&self) -> Result<(), Error> {
        match self {
            Self::Pulley(radius) => parameter::PULLEY_RADIUS.check(*radius).map(drop),
            Self::Table(_) => Ok(()),
        }
    }
}

impl<S: Scalar> MomentArm<S> {
    #[cfg(feature = "alloc")]
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> MomentArm<T> {
        match self {
            Self::Pulley(radius) => MomentArm::Pulley(convert.parameter(&parameter::PULLEY_RADIUS, *radius)),
            Self::Table(table) => {
                let angle = table.angle.map(|angle| convert.parameter(&parameter::MOMENT_ARM_ANGLE, angle));
                let arm = table.arm.map(|arm| convert.parameter(&parameter::MOMENT_ARM, arm));
                MomentArm::Table(match convert.carry() {
                    Some(mut carry) => ArmTable {
                        rows: table.rows,
                        angle,
                        arm,
                        slope: table.slope.map(&mut carry),
                        excursion: table.excursion.map(carry),
                    },
                    None => ArmTable::assemble(table.rows, angle, arm),
                })
            }
        }
    }

    /// Arm in m and excursion in m at an angle in rad.
    #[inline(always)]
    pub fn at<T: Over<S>>(&self, angle: T) -> [T; 2] {
        match self {
            Self::Pulley(radius) => on_pulley(T::of(*radius), angle),
            Self::Table(table) => {
                let mut found = table.in_piece(0, angle);
                for row in 0..table.rows {
                    let passed = T::of(table.angle[row]).lt(angle);
                    let next = table.in_piece(row + 1, angle);
                    found = [T::select(passed, next[0], found[0]), T::select(passed, next[1], found[1])];
                }
                found
            }
        }
    }

    /// Moment arm and its derivative by the formula of one piece, smoothly continued beyond its ends. A table of n rows
    /// has the pieces 0 (before the first row), 1 to n − 1 (the cubics) and n (behind the last); a pulley has the piece
    /// 0 alone.
    #[inline(always)]
    pub fn in_piece<T: Over<S>>(&self, piece: usize, angle: T) -> [T; 2] {
        match self {
            Self::Pulley(radius) => on_pulley(T::of(*radius), angle),
            Self::Table(table) => table.in_piece(piece, angle),
        }
    }

    /// Angles in rad between which a piece holds; `None` where it has no end.
    pub fn piece_bounds(&self, piece: usize) -> (Option<S>, Option<S>) {
        let Self::Table(table) = self else { return (None, None) };
        let row = |row: usize| (row < table.rows).then(|| table.angle[row]);
        (piece.checked_sub(1).and_then(row), row(piece))
    }
}

impl<S: Real> MomentArm<S> {
    /// The piece that holds at an angle in rad; on a row the one before it.
    pub fn piece(&self, angle: S) -> usize {
        let Self::Table(table) = self else { return 0 };
        table.angle[..table.rows].iter().take_while(|row| row.value() < angle.value()).count()
    }

    /// The angle in rad of an excursion in m.
    pub fn angle_of(&self, excursion: S) -> S {
        let table = match self {
            Self::Pulley(radius) => return excursion / *radius,
            Self::Table(table) => table,
        };
        let piece = table.excursion[..table.rows].iter().take_while(|row| row.value() < excursion.value()).count();
        let near = match piece {
            0 => table.angle[0].value(),
            piece if piece < table.rows => {
                let (low, high) = (table.angle[piece - 1].value(), table.angle[piece].value());
                let surplus = |angle: f64| (table.in_piece(piece, S::constant(angle))[1] - excursion).value();
                root::bracketed(low, high, 0.0, surplus)
            }
            piece => table.angle[piece - 1].value(),
        };
        // One Newton step over the scalar: it is all there is to do on a straight line, and carries the derivatives.
        let [arm, reached] = table.in_piece(piece, S::constant(near));
        S::constant(near) - (reached - excursion) / arm
    }
}

impl<S: Scalar> ArmTable<S> {
    fn assemble(rows: usize, angle: [S; MAX_ARMS], arm: [S; MAX_ARMS]) -> Self {
        let nothing = [S::zero(); MAX_ARMS];
        let mut table = Self { rows, angle, arm, slope: nothing, excursion: nothing };
        let knots = Knots { count: rows, place: |row: usize| angle[row], value: |row: usize| arm[row] };
        for row in 0..rows {
            table.slope[row] = knots.slope(row);
        }
        for row in 1..rows {
            table.excursion[row] = table.in_piece(row, angle[row])[1];
        }
        // So far from the first row; from angle zero on it is less what lies between.
        let [_, at_zero] = MomentArm::Table(table).at(S::zero());
        table.excursion = table.excursion.map(|excursion| excursion - at_zero);
        table
    }

    #[inline(always)]
    fn in_piece<T: Over<S>>(&self, piece: usize, angle: T) -> [T; 2] {
        let row = piece.saturating_sub(1);
        let (start, before) = (T::of(self.arm[row]), T::of(self.excursion[row]));
        let gone = angle - T::of(self.angle[row]);
        if piece == 0 || piece >= self.rows {
            return [start, before + start * gone];
        }
        let width = T::of(self.angle[row + 1] - self.angle[row]);
        let (m0, m1) = (T::of(self.slope[row]) * width, T::of(self.slope[row + 1]) * width);
        let rise = T::of(self.arm[row + 1] - self.arm[row]);
        let (u, two) = (gone / width, T::constant(2.0));
        let (square, cube) = (T::constant(3.0) * rise - two * m0 - m1, m0 + m1 - two * rise);
        let arm = start + u * (m0 + u * (square + u * cube));
        let (half, third, quarter) = (T::constant(0.5), T::constant(1.0 / 3.0), T::constant(0.25));
        let mean = start + u * (half * m0 + u * (third * square + u * (quarter * cube)));
        [arm, before + gone * mean]
    }
}

/// A pulley turned by an angle.
#[inline(always)]
fn on_pulley<T: Scalar>(radius: T, angle: T) -> [T; 2] {
    [radius, radius * angle]
}
