//! A measured force map: tensions on a grid of gauge pressures and lengths, and a smooth monotone surface through them.
//!
//! ```text
//! F(L, P) = Σᵢⱼ fᵢⱼ wᵢ(L) Wⱼ(P) + f′ᵢⱼ vᵢ(L) Wⱼ(P) + ḟᵢⱼ wᵢ(L) Vⱼ(P)
//! ```
//!
//! | symbol | what | unit |
//! |---|---|---|
//! | fᵢⱼ | tension that was measured at length i and pressure j | N |
//! | f′ᵢⱼ, ḟᵢⱼ | its slopes over length and over pressure | N/m, N/Pa |
//! | w, v; W, V | cubics of Hermite that carry a value or a slope, over length; over pressure | –, m; –, Pa |
//!
//! The surface is bicubic, goes through every measured value and has continuous slopes. Those at the nodes are
//! the monotone ones along each row and column, and smaller where a cell needs it: where the values rise (or fall) along
//! both edges of a cell, the surface does so all over the cell. The condition is the one that makes a cubic monotone,
//! slopes of at most three secants, checked by the Bernstein coefficients of both sides over the other variable.
//!
//! **Outside its hull** nothing was measured, and the map says so: it goes on as a plane with the slopes of its border,
//! each row of the grid is a border between pieces, so that the event log of a run records where it leaves the map, and
//! [`ForceMap::covers`] answers for any place. Zeros that mean a slack muscle are no measured tensions: leave such rows
//! out.
//!
//! A measured map is the gradient of no volume of the gas: the energy audit says what it takes, or gives.
//!
//! Source: monotone bicubic surfaces with conditions on their slopes are R. E. Carlson & F. N. Fritsch's, "Monotone
//! piecewise bicubic interpolation", SIAM J. Numer. Anal. 22, 386–400 (1985), and "Monotonicity preserving bicubic
//! interpolation: a progress report", Comput. Aided Geom. Des. 2, 117–121 (1985), doi:10.1016/0167-8396(85)90014-7. The
//! condition here is derived for surfaces without twists, and is sufficient, not necessary.
//! Checked by `tests/force_map.rs`: through its nodes, a plane, against the Hermite formula, monotone on random maps,
//! slopes continuous, derivatives, secant, both engines with its borders as events.

use super::monotone::Knots;
use super::{Piece, StaticForce};
use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::pressure::GaugePressure;
use crate::scalar::{Over, Scalar};
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;

/// The largest number of lengths, and of pressures, of a map.
pub const MAX_MAP: usize = 24;

/// What is known at a node of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node<S> {
    tension: S,
    per_length: S,
    per_pressure: S,
}

/// A measured force map.
#[derive(Clone, Debug, PartialEq)]
pub struct ForceMap<S = f64> {
    pressures: Arc<[S]>,
    lengths: Arc<[S]>,
    /// One for each length at the first pressure, then at the next.
    nodes: Arc<[Node<S>]>,
    /// How much of the row's and the column's slope each node has.
    shares: Arc<[f64]>,
}

impl ForceMap {
    /// A map over rising gauge pressures (Pa) and lengths (m) of tensions (N): one for each length at the first pressure,
    /// then at the next.
    ///
    /// # Errors
    /// [`Error::Table`] when a list has fewer than 2 or more than [`MAX_MAP`] entries, does not rise, or holds what is no
    /// finite number, or when the number of tensions is not the product of the other two.
    pub fn new(gauge_pressure: &[f64], length: &[f64], tension: &[f64]) -> Result<Self, Error> {
        rising(parameter::MAP_PRESSURE.key, gauge_pressure)?;
        rising(parameter::MAP_LENGTH.key, length)?;
        let fault = |name, problem, entry, remedy| Err(Error::Table { name, problem, entry, remedy });
        if length[0] <= 0.0 {
            return fault(parameter::MAP_LENGTH.key, "a length is not above zero", 1, "give lengths above zero");
        }
        let name = parameter::MAP_TENSION.key;
        let wanted = gauge_pressure.len() * length.len();
        if tension.len() != wanted {
            let entry = tension.len().min(wanted) + 1;
            let remedy = "give one tension for each length at the first pressure, then at the next";
            return fault(name, "it has not one entry for each pressure and length", entry, remedy);
        }
        if let Some(place) = tension.iter().position(|number| !number.is_finite()) {
            return fault(name, "an entry is not a finite number", place + 1, "give finite numbers");
        }
        let (pressures, lengths): (Arc<[f64]>, Arc<[f64]>) = (gauge_pressure.into(), length.into());
        let whole = Self::assemble(pressures.clone(), lengths.clone(), tension, vec![1.0; wanted].into());
        let shares = whole.monotone_shares();
        Ok(Self::assemble(pressures, lengths, tension, shares.into()))
    }

    /// The largest shares of the slopes, cell by cell, with which the surface is monotone wherever the values are.
    fn monotone_shares(&self) -> Vec<f64> {
        const SHRINK: f64 = 0.9;
        const LEAST: f64 = 1e-3;
        let (columns, mut shares) = (self.lengths.len(), vec![1.0_f64; self.nodes.len()]);
        let mut changed = true;
        while core::mem::take(&mut changed) {
            for row in 0..self.pressures.len() - 1 {
                for column in 0..columns - 1 {
                    let corners = [0, 1, columns, columns + 1].map(|step| row * columns + column + step);
                    let node = |corner: usize| {
                        let (Node { tension, per_length, per_pressure }, share) =
                            (self.nodes[corners[corner]], shares[corners[corner]]);
                        [tension, share * per_length, share * per_pressure]
                    };
                    let [a, b, c, d] = [node(0), node(1), node(2), node(3)];
                    let (width, height) = (
                        self.lengths[column + 1] - self.lengths[column],
                        self.pressures[row + 1] - self.pressures[row],
                    );
                    let swapped = |[value, along, across]: [f64; 3]| [value, across, along];
                    let over_length = monotone([a, b, c, d], width, height);
                    let over_pressure = monotone([a, c, b, d].map(swapped), height, width);
                    if !(over_length && over_pressure) {
                        for corner in corners {
                            let smaller = SHRINK * shares[corner];
                            shares[corner] = if smaller < LEAST { 0.0 } else { smaller };
                        }
                        changed = true;
                    }
                }
            }
        }
        shares
    }

    /// Whether a place lies within the measured lengths and pressures.
    pub fn covers(&self, length: f64, gauge: GaugePressure) -> bool {
        let within = |knots: &[f64], at: f64| knots[0] <= at && at <= knots[knots.len() - 1];
        within(&self.lengths, length) && within(&self.pressures, gauge.0)
    }
}

fn rising(name: &'static str, list: &[f64]) -> Result<(), Error> {
    let fault = |problem, entry, remedy| Err(Error::Table { name, problem, entry, remedy });
    if list.len() < 2 {
        return fault("it has too few entries", list.len() + 1, "give at least two");
    }
    if list.len() > MAX_MAP {
        return fault("it has too many entries", MAX_MAP + 1, "keep to 24 lengths and 24 pressures");
    }
    if let Some(place) = list.iter().position(|number| !number.is_finite()) {
        return fault("an entry is not a finite number", place + 1, "give finite numbers");
    }
    match list.windows(2).position(|pair| pair[1] <= pair[0]) {
        Some(place) => fault("the entries do not rise", place + 2, "sort the grid and drop repeats"),
        None => Ok(()),
    }
}

/// Whether the surface over a cell is monotone along its first variable, if its edges are. Corners as value, slope along
/// and slope across: both ends of the first edge, then of the second.
fn monotone([a, b, c, d]: [[f64; 3]; 4], along: f64, across: f64) -> bool {
    let rise = [b[0] - a[0], d[0] - c[0]];
    let sign = if rise[0] + rise[1] < 0.0 { -1.0 } else { 1.0 };
    if rise.iter().any(|rise| sign * rise < 0.0) {
        return true;
    }
    let third = across / 3.0;
    let secants = [rise[0], rise[0] + third * (b[2] - a[2]), rise[1] - third * (d[2] - c[2]), rise[1]];
    let slopes = [[a[1], b[1]], [a[1], b[1]], [c[1], d[1]], [c[1], d[1]]];
    // A rounding beyond the bound is none.
    const ROUNDING: f64 = 1.0 + 1e-12;
    secants.iter().zip(slopes).all(|(secant, ends)| {
        let most = 3.0 * sign * secant / along * ROUNDING;
        most >= 0.0 && ends.iter().all(|slope| (0.0..=most).contains(&(sign * slope)))
    })
}

impl<S: Scalar> ForceMap<S> {
    fn assemble(pressures: Arc<[S]>, lengths: Arc<[S]>, tension: &[S], shares: Arc<[f64]>) -> Self {
        let columns = lengths.len();
        let node = |place: usize| {
            let (row, column) = (place / columns, place % columns);
            let share = S::constant(shares[place]);
            let over_length =
                Knots { count: columns, place: |n: usize| lengths[n], value: |n: usize| tension[row * columns + n] };
            let over_pressure = Knots {
                count: pressures.len(),
                place: |n: usize| pressures[n],
                value: |n: usize| tension[n * columns + column],
            };
            Node {
                tension: tension[place],
                per_length: share * over_length.slope(column),
                per_pressure: share * over_pressure.slope(row),
            }
        };
        let nodes = (0..tension.len()).map(node).collect();
        Self { pressures, lengths, nodes, shares }
    }

    /// Converts the map to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> ForceMap<T> {
        let pressures = self.pressures.iter().map(|&p| convert.parameter(&parameter::MAP_PRESSURE, p)).collect();
        let lengths = self.lengths.iter().map(|&length| convert.parameter(&parameter::MAP_LENGTH, length)).collect();
        let tensions: Vec<T> =
            self.nodes.iter().map(|node| convert.parameter(&parameter::MAP_TENSION, node.tension)).collect();
        let shares = self.shares.clone();
        match convert.carry() {
            Some(mut carry) => {
                let node = |(node, &tension): (&Node<S>, &T)| Node {
                    tension,
                    per_length: carry(node.per_length),
                    per_pressure: carry(node.per_pressure),
                };
                let nodes = self.nodes.iter().zip(&tensions).map(node).collect();
                ForceMap { pressures, lengths, nodes, shares }
            }
            None => ForceMap::assemble(pressures, lengths, &tensions, shares),
        }
    }

    /// The tension in N by the formula of one piece, smoothly continued beyond the piece's bounds.
    ///
    /// Along each axis of n knots the pieces are 0 (below the first), 1 to n − 1 (the cubics) and n (above the last).
    #[inline(always)]
    pub fn in_piece<T: Over<S>>(&self, piece: Piece, length: T, gauge: GaugePressure<T>) -> T {
        let over_length = Weights::in_piece(&self.lengths, piece.length, length);
        self.sum(&over_length, &Weights::in_piece(&self.pressures, piece.pressure, gauge.0))
    }

    /// Lengths in m between which a piece holds; `None` where it has no end.
    pub fn length_bounds(&self, piece: usize) -> (Option<S>, Option<S>) {
        bounds(&self.lengths, piece)
    }

    /// Gauge pressures in Pa between which a piece holds; `None` where it has no end.
    pub fn pressure_bounds(&self, piece: usize) -> (Option<S>, Option<S>) {
        bounds(&self.pressures, piece)
    }

    #[inline(always)]
    fn sum<T: Over<S>>(&self, over_length: &Weights<T>, over_pressure: &Weights<T>) -> T {
        let columns = self.lengths.len();
        let mut sum = T::zero();
        for row in 0..self.pressures.len() {
            let (mut value, mut slope) = (T::zero(), T::zero());
            for column in 0..columns {
                let node = &self.nodes[row * columns + column];
                let (w, v) = (over_length.value[column], over_length.slope[column]);
                value = value + T::of(node.tension) * w + T::of(node.per_length) * v;
                slope = slope + T::of(node.per_pressure) * w;
            }
            sum = sum + value * over_pressure.value[row] + slope * over_pressure.slope[row];
        }
        sum
    }
}

fn bounds<S: Scalar>(knots: &[S], piece: usize) -> (Option<S>, Option<S>) {
    (piece.checked_sub(1).and_then(|below| knots.get(below).copied()), knots.get(piece).copied())
}

impl<S: Scalar> StaticForce<S> for ForceMap<S> {
    #[inline(always)]
    fn force<T: Over<S>>(&self, length: T, gauge: GaugePressure<T>) -> T {
        self.sum(&Weights::at(&self.lengths, length), &Weights::at(&self.pressures, gauge.0))
    }

    #[inline(always)]
    fn secant_stiffness<T: Over<S>>(&self, length: T, from: T, gauge: GaugePressure<T>) -> T {
        self.sum(&Weights::secant(&self.lengths, length, from), &Weights::at(&self.pressures, gauge.0))
    }
}

/// What each knot's value and slope count at a place.
///
/// With the part u of each interval that lies before the place, from 0 to 1, a knot's value counts s(u) of the interval
/// before it less s(u) of the one after, and its slope what that makes of both intervals: no search, no branch.
struct Weights<T> {
    value: [T; MAX_MAP],
    slope: [T; MAX_MAP],
}

impl<T: Scalar> Weights<T> {
    #[inline(always)]
    fn nothing() -> Self {
        Self { value: [T::zero(); MAX_MAP], slope: [T::zero(); MAX_MAP] }
    }

    /// At a place, wherever it is.
    #[inline(always)]
    fn at<S: Scalar>(knots: &[S], place: T) -> Self
    where
        T: Over<S>,
    {
        let last = knots.len() - 1;
        let mut weights = Self::nothing();
        weights.value[0] = T::one();
        for interval in 0..last {
            let (start, width) = Self::interval(knots, interval);
            weights.pass(interval, width, part_before(place, start, width));
        }
        let (first, end) = (T::of(knots[0]), T::of(knots[last]));
        let [below, above] = [place - first, place - end];
        weights.slope[0] = weights.slope[0] + T::select(place.le(first), below, T::zero());
        weights.slope[last] = weights.slope[last] + T::select(end.lt(place), above, T::zero());
        weights
    }

    /// By the formula of one piece.
    #[inline(always)]
    fn in_piece<S: Scalar>(knots: &[S], piece: usize, place: T) -> Self
    where
        T: Over<S>,
    {
        let last = knots.len() - 1;
        let mut weights = Self::nothing();
        weights.value[0] = T::one();
        for interval in 0..last.min(piece) {
            let (start, width) = Self::interval(knots, interval);
            let part = if interval + 1 == piece { (place - start) / width } else { T::one() };
            weights.pass(interval, width, part);
        }
        if piece == 0 {
            weights.slope[0] = place - T::of(knots[0]);
        } else if piece > last {
            weights.slope[last] = weights.slope[last] + (place - T::of(knots[last]));
        }
        weights
    }

    /// The differences between two places, each over the distance of the places; the derivatives where there is none.
    #[inline(always)]
    fn secant<S: Scalar>(knots: &[S], place: T, from: T) -> Self
    where
        T: Over<S>,
    {
        let last = knots.len() - 1;
        let mut weights = Self::nothing();
        let (low, high) = (place.smaller(from), place.larger(from));
        for interval in 0..last {
            let (start, width) = Self::interval(knots, interval);
            let end = T::of(knots[interval + 1]);
            let (a, b) = (part_before(high, start, width), part_before(low, start, width));
            let inside = start.le(low) & high.lt(end);
            let rate = share(low.larger(start), high.smaller(end), low, high, inside) / width;
            let (sum, squares) = (a + b, a * a + a * b + b * b);
            let two = T::constant(2.0);
            let rise = rate * (T::constant(3.0) * sum - two * squares);
            weights.value[interval] = weights.value[interval] - rise;
            weights.value[interval + 1] = weights.value[interval + 1] + rise;
            weights.slope[interval] = weights.slope[interval] + width * rate * (T::one() - two * sum + squares);
            weights.slope[interval + 1] = weights.slope[interval + 1] + width * rate * (squares - sum);
        }
        let (first, end) = (T::of(knots[0]), T::of(knots[last]));
        let below = share(low, high.smaller(first), low, high, high.lt(first));
        let above = share(low.larger(end), high, low, high, end.le(low));
        weights.slope[0] = weights.slope[0] + below;
        weights.slope[last] = weights.slope[last] + above;
        weights
    }

    #[inline(always)]
    fn interval<S: Scalar>(knots: &[S], interval: usize) -> (T, T)
    where
        T: Over<S>,
    {
        (T::of(knots[interval]), T::of(knots[interval + 1] - knots[interval]))
    }

    /// Goes through a part of an interval.
    #[inline(always)]
    fn pass(&mut self, interval: usize, width: T, part: T) {
        let rest = T::one() - part;
        let rise = part * part * (T::constant(3.0) - part - part);
        self.value[interval] = self.value[interval] - rise;
        self.value[interval + 1] = self.value[interval + 1] + rise;
        self.slope[interval] = self.slope[interval] + width * part * rest * rest;
        self.slope[interval + 1] = self.slope[interval + 1] - width * part * part * rest;
    }
}

/// The part of an interval that lies before a place, from 0 to 1. A knot belongs to the interval before it, as of pieces, so that
/// derivatives there are those of one piece.
#[inline(always)]
fn part_before<T: Scalar>(place: T, start: T, width: T) -> T {
    let (part, zero, one) = ((place - start) / width, T::zero(), T::one());
    let begun = T::select(zero.lt(part), part, zero);
    T::select(begun.le(one), begun, one)
}

/// The share of a stretch from `low` to `high` that lies between two places; all of it where it is known to lie `inside`.
#[inline(always)]
fn share<T: Scalar>(start: T, end: T, low: T, high: T, inside: T::Mask) -> T {
    let quotient = T::select(start.lt(end), (end - start) / (high - low), T::zero());
    T::select(inside, T::one(), quotient)
}
