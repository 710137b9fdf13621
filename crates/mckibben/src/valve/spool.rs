//! A proportional spool: its motion, and how far it uncovers each edge.
//!
//! ```text
//! ẍ = ω² (u − x) − 2ζω ẋ        −1 ≤ x ≤ 1, where a stop takes the speed        ω = 2π f_n
//!
//! λ_supply  = min(1, max(0, ( x − o_s)/(1 − o_s)))
//! λ_exhaust = min(1, max(0, (−x − o_e)/(1 − o_e)))           ṁ = λ · ṁ(open)
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | u, x | `command`, `position`, shares of the stroke | – |
//! | f_n, ζ | `natural_frequency`, `damping_ratio` | Hz, – |
//! | o_s, o_e | `supply_overlap`, `exhaust_overlap` | – |
//! | λ | effective area over that of the fully uncovered edge | – |
//!
//! An overlap above zero is a dead zone: nothing flows while `−o_e ≤ x ≤ o_s`. Below zero both edges are open around the
//! middle, and air passes from supply to exhaust. Under a command that stays the same the motion is known in closed form,
//! with `e = x − u`, `p = ωt`, `q = (1 − ζ²)p²`:
//!
//! ```text
//! c = exp(−ζp) cos √q        s = exp(−ζp) p sin(√q)/√q         (cosh, sinh for q < 0)
//! e = (c + ζs) e₀ + s ẋ₀/ω        ẋ/ω = −s e₀ + (c − ζs) ẋ₀/ω
//! ```
//!
//! c and s are analytic in ζ, through ζ = 1 too, and are computed so. Friction of the spool, the dependence of the area on
//! the flow's forces and rounded edges are left out.
//!
//! Source: the second-order spool with edges of overlap is that of textbooks, for instance H. E. Merritt, Hydraulic Control
//! Systems (1967), chapters 5 and 6. Checked by `tests/spool.rs`: the equation of motion by dual numbers, overshoot and peak
//! time, the stop, overlap and underlap; by `tests/spool_rig.rs` in the engines.

use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::root::bracketed;
use crate::scalar::{Over, Real, Scalar};
use core::f64::consts::{PI, TAU};

/// Terms of the series of cosine and sine over q, for |q| < 1: the next is below the rounding of `f64`.
const TERMS: usize = 10;
/// Time constants of the slowest decay after which a spool has come to rest.
const TIME_CONSTANTS: f64 = 40.0;

/// A proportional spool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spool<S = f64> {
    /// ω in rad/s.
    angular_frequency: S,
    damping_ratio: S,
    supply_overlap: S,
    exhaust_overlap: S,
}

/// A spool's motion from an instant on, under a command that stays the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpoolMotion<S = f64> {
    /// When it begins, in s.
    pub time: S,
    /// Position x then, from −1 to 1.
    pub position: S,
    /// Velocity then in 1/s.
    pub velocity: S,
    /// Commanded position u, from −1 to 1.
    pub command: S,
}

impl Spool {
    /// A spool with its natural frequency in Hz and its damping ratio, both above zero, and the overlap of each edge in
    /// shares of the stroke, between −1 and 1.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range.
    pub fn new(
        natural_frequency: f64,
        damping_ratio: f64,
        supply_overlap: f64,
        exhaust_overlap: f64,
    ) -> Result<Self, Error> {
        Ok(Self {
            angular_frequency: TAU * parameter::SPOOL_FREQUENCY.check(natural_frequency)?,
            damping_ratio: parameter::SPOOL_DAMPING_RATIO.check(damping_ratio)?,
            supply_overlap: parameter::SUPPLY_OVERLAP.check(supply_overlap)?,
            exhaust_overlap: parameter::EXHAUST_OVERLAP.check(exhaust_overlap)?,
        })
    }
}

impl<S: Scalar> Spool<S> {
    /// Converts the spool to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Spool<T> {
        let frequency = self.angular_frequency / S::constant(TAU);
        Spool {
            angular_frequency: T::constant(TAU) * convert.parameter(&parameter::SPOOL_FREQUENCY, frequency),
            damping_ratio: convert.parameter(&parameter::SPOOL_DAMPING_RATIO, self.damping_ratio),
            supply_overlap: convert.parameter(&parameter::SUPPLY_OVERLAP, self.supply_overlap),
            exhaust_overlap: convert.parameter(&parameter::EXHAUST_OVERLAP, self.exhaust_overlap),
        }
    }

    /// The positions at which the edges to the supply and to the exhaust are.
    pub(super) fn edges(&self) -> [S; 2] {
        [self.supply_overlap, -self.exhaust_overlap]
    }

    /// The opening λ of the edges to the supply and to the exhaust at a position.
    #[inline(always)]
    pub fn openings<T: Over<S>>(&self, position: T) -> [T; 2] {
        [edge(position, T::of(self.supply_overlap)), edge(-position, T::of(self.exhaust_overlap))]
    }

    /// Acceleration ẍ in 1/s² between the stops.
    #[inline(always)]
    pub fn acceleration<T: Over<S>>(&self, position: T, velocity: T, command: T) -> T {
        let (omega, zeta) = (T::of(self.angular_frequency), T::of(self.damping_ratio));
        omega * (omega * (command - position) - T::constant(2.0) * zeta * velocity)
    }

    /// Position and velocity (1/s) at a time in s, as long as no stop is met.
    #[inline(always)]
    pub fn at<T: Over<S>>(&self, motion: &SpoolMotion<S>, time: T) -> [T; 2] {
        let (omega, zeta) = (T::of(self.angular_frequency), T::of(self.damping_ratio));
        let [c, s] = responses(omega * (time - T::of(motion.time)), zeta);
        let (apart, speed) = (T::of(motion.position - motion.command), T::of(motion.velocity) / omega);
        [T::of(motion.command) + (c + zeta * s) * apart + s * speed, omega * ((c - zeta * s) * speed - s * apart)]
    }
}

/// The opening of an edge beyond its overlap. No closure: it would be compiled separately, without the instructions of a batch.
#[inline(always)]
fn edge<T: Scalar>(way: T, overlap: T) -> T {
    // Where both are equal the second counts, which has a derivative.
    T::one().smaller(((way - overlap) / (T::one() - overlap)).larger(T::zero()))
}

/// c and s after the phase `p = ωt`.
#[inline(always)]
fn responses<T: Scalar>(phase: T, zeta: T) -> [T; 2] {
    let one = T::one();
    let stiffness = one - zeta * zeta;
    let q = stiffness * phase * phase;
    let decay = (-(zeta * phase)).exp();
    // Near the critical damping or soon after the start: cos √q and sin √q/√q in powers of q.
    let (mut cosine, mut sine) = (one, one);
    for term in (1..=TERMS).rev() {
        let n = 2.0 * term as f64;
        cosine = one - q * T::constant(1.0 / ((n - 1.0) * n)) * cosine;
        sine = one - q * T::constant(1.0 / (n * (n + 1.0))) * sine;
    }
    let near = [decay * cosine, decay * phase * sine];
    let angle = q.sqrt();
    let swinging = [decay * angle.cos(), decay * phase * angle.sin() / angle];
    // Two decays; the exponent of the slow one, p(ζ − √(ζ²−1)), is written so that nothing cancels.
    let root = (-stiffness).sqrt();
    let (slow, fast) = ((-(phase / (zeta + root))).exp(), (-(phase * (zeta + root))).exp());
    let half = T::constant(0.5);
    let creeping = [half * (slow + fast), half * (slow - fast) / root];
    let (is_near, swings) = (q.magnitude().lt(one), T::zero().lt(q));
    let mut beyond = swinging;
    for n in 0..2 {
        beyond[n] = T::select(is_near, near[n], T::select(swings, swinging[n], creeping[n]));
    }
    beyond
}

impl<S: Real> Spool<S> {
    /// The instant in s at which the motion meets a stop, if it does; the spool then rests there until the command draws it
    /// back.
    pub fn meets_stop(&self, motion: &SpoolMotion<S>) -> Option<f64> {
        let at = |time: f64| self.at(motion, S::constant(time))[0].value();
        let mut from = motion.time.value();
        for turn in self.turns(motion) {
            let side = if at(turn) < 0.0 { -1.0 } else { 1.0 };
            let beyond = |time: f64| side * at(time) - 1.0;
            if beyond(turn) > 0.0 {
                return Some(bracketed(from, turn, 1e-15 * turn, beyond));
            }
            from = turn;
        }
        None
    }

    /// The instant in s after which nothing is left of a motion but rounding.
    pub(super) fn rest(&self, motion: &SpoolMotion<S>) -> f64 {
        let (omega, zeta) = (self.angular_frequency.value(), self.damping_ratio.value());
        let slow = if zeta < 1.0 { zeta } else { 1.0 / (zeta + square_root(zeta * zeta - 1.0)) };
        let still = motion.velocity.value() == 0.0 && motion.position.value() == motion.command.value();
        motion.time.value() + if still { 0.0 } else { TIME_CONSTANTS / (slow * omega) }
    }

    /// The instants in s at which the spool reverses, in order, and last that after which it rests: in between it goes
    /// one way.
    pub(super) fn turns(&self, motion: &SpoolMotion<S>) -> impl Iterator<Item = f64> + use<S> {
        let (omega, zeta) = (self.angular_frequency.value(), self.damping_ratio.value());
        let speed = |time: f64| self.at(motion, S::constant(time))[1].value();
        let (from, rest) = (motion.time.value(), self.rest(motion));
        let swings = zeta < 1.0;
        let half_period = if swings { PI / (omega * square_root(1.0 - zeta * zeta)) } else { rest - from };
        let begins = motion.velocity.value();
        let within = (from + half_period).min(rest);
        let first = if begins == 0.0 {
            within
        } else if begins * speed(within) < 0.0 {
            bracketed(from, within, 1e-15 * within, speed)
        } else {
            rest
        };
        let most = if swings { ((rest - first) / half_period) as u32 } else { 0 };
        let turns = (0..=most).map(move |count| first + f64::from(count) * half_period);
        turns.filter(move |turn| *turn < rest).chain([rest])
    }
}

fn square_root(number: f64) -> f64 {
    Scalar::sqrt(number)
}
