//! LuGre's friction: bristles that bend, slide over each other and are damped, and that hold less the faster they slide.
//!
//! ```text
//! F_h = k_sec⁺ (W/r) (z + τ(v) ż)          ż = v − |v| z/r(v)
//! r(v) = r (1 + (ρ − 1) e(v))              τ(v) = τ e(v)              e(v) = exp(−(v/v_s)²)
//!
//! over a displacement d with r(v) held:    z = z₀ + (d − |d| z₀/r(v)) (1 − e^{−x})/x,     x = |d|/r(v)
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | W | `width`: the force in fast sliding over the secant stiffness, as the Q of Coulomb's law (12) | m |
//! | r | `reach`: the deflection of the bristles in fast sliding | m |
//! | ρ | `static_ratio`: the force in the slowest sliding over that in fast sliding | 1 |
//! | v_s | `stribeck_velocity`, over which the force falls from the one to the other | m/s |
//! | τ | `damping_time`: damping of the bristles over their stiffness | s |
//! | z | the deflection of the bristles: the memory | m |
//! | k_sec | secant stiffness (13) | N/m |
//!
//! In its authors' symbols σ₀ = k_sec W/r, σ₁ = τ(v) σ₀, F_C = k_sec W, F_S = ρ F_C and σ₂ is the viscous c. Steady sliding at v
//! needs `k_sec W (1 + (ρ − 1) e(v)) sgn v`, Stribeck's curve. At ρ = 1 and τ = 0 it is Dahl's law with β = 1/r.
//!
//! **Dissipation.** Of the power `F_h v` the rate of `½ k_sec (W/r) z²` is stored, and the rest is
//! `k_sec (W/r) (|v| z²/r(v) + τ(v) v² − τ(v) |v| v z/r(v))`, a quadratic form in z that is never negative where
//! `τ(v) |v| ≤ 4 r(v)`. With a τ that does not fall, the bound fails in fast sliding: the bristles that give way while it
//! speeds up push forwards, and only a viscous `c ≥ (ρ − 1) σ₁` makes up for it. With the falling one it holds at any velocity
//! when `τ ≤ 4 √(2e) r/v_s`, which the parameters must satisfy.
//!
//! **Steps.** Between two velocities the fixed-step engine takes the mean of their 1/r(v) for the whole way, which errs by the
//! cube of a step; z decays by the way and not by the time, so that no step is too long, however stiff the bristles. The
//! event-located engine has z as a state.
//!
//! Sources: Canudas de Wit, Olsson, Åström & Lischinsky, IEEE Trans. Automatic Control 40 (1995), with the falling σ₁; when a
//! constant one is passive: Barahanov & Ortega, IEEE Trans. Automatic Control 45 (2000); integration over the way: Hayward,
//! Armstrong, Altpeter & Dupont, IEEE Trans. Control Systems Technology 17 (2009). The scale by (13) is this project's.
//! Checked by `tests/lugre.rs`.

use super::memory::{Branch, Memory};
use crate::convert::Convert;
use crate::error::{Error, Requirement};
use crate::force::relative_exponential;
use crate::parameter;
use crate::scalar::{Over, Real, Scalar};

/// Place in the memory of the deflection in m.
const DEFLECTION: usize = 0;
/// Place in the memory of `1 − e(v)`: zero at rest.
const FALLEN: usize = 1;
/// `4 √(2e)`: the largest damping time in units of `r/v_s`.
const MOST_DAMPED: f64 = 9.326_575_926_388_49;

/// LuGre's friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LuGre<S = f64> {
    width: S,
    reach: S,
    /// `ρ − 1`.
    excess: S,
    stribeck_velocity: S,
    damping_time: S,
}

impl LuGre {
    /// Bristles that slide fast at `width` (m) with a deflection of `reach` (m), both above zero; neither falls with velocity
    /// nor is damped.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number that is not above zero.
    pub fn new(width: f64, reach: f64) -> Result<Self, Error> {
        parameter::HYSTERESIS_WIDTH.check(width)?;
        parameter::BRISTLE_REACH.check(reach)?;
        Ok(Self { width, reach, excess: 0.0, stribeck_velocity: 1.0, damping_time: 0.0 })
    }

    /// Adds a force in the slowest sliding that is `static_ratio` (1 or more) times that in fast sliding, and falls
    /// to it over `stribeck_velocity` (m/s, above zero); and a `damping_time` (s, zero or more), which falls to zero over the
    /// same velocity.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range; [`Error::Inconsistent`] when the bristles are damped so much that
    /// they would yield work.
    pub fn with_velocity(self, static_ratio: f64, stribeck_velocity: f64, damping_time: f64) -> Result<Self, Error> {
        let excess = parameter::BRISTLE_STATIC_RATIO.check(static_ratio)? - 1.0;
        parameter::BRISTLE_STRIBECK_VELOCITY.check(stribeck_velocity)?;
        parameter::BRISTLE_DAMPING_TIME.check(damping_time)?;
        let most = MOST_DAMPED * self.reach / stribeck_velocity;
        if damping_time > most {
            return Err(Error::Inconsistent {
                parameter: &parameter::BRISTLE_DAMPING_TIME,
                value: damping_time,
                requirement: Requirement {
                    relation: "must be at most",
                    other: "4 sqrt(2 e) bristle_reach / stribeck_velocity",
                    value: most,
                    unit: "s",
                },
                remedy: "shorten damping_time, lengthen bristle_reach or lower stribeck_velocity: otherwise sliding would \
                         yield work",
            });
        }
        Ok(Self { excess, stribeck_velocity, damping_time, ..self })
    }
}

impl<S: Scalar> LuGre<S> {
    pub(super) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> LuGre<T> {
        LuGre {
            width: convert.parameter(&parameter::HYSTERESIS_WIDTH, self.width),
            reach: convert.parameter(&parameter::BRISTLE_REACH, self.reach),
            excess: convert.parameter(&parameter::BRISTLE_STATIC_RATIO, self.excess + S::one()) - T::one(),
            stribeck_velocity: convert.parameter(&parameter::BRISTLE_STRIBECK_VELOCITY, self.stribeck_velocity),
            damping_time: convert.parameter(&parameter::BRISTLE_DAMPING_TIME, self.damping_time),
        }
    }

    /// The deflection r in m of the bristles in fast sliding.
    pub fn reach(&self) -> S {
        self.reach
    }

    /// Force over the secant stiffness for the deflection.
    #[inline(always)]
    fn ratio(&self) -> S {
        self.width / self.reach
    }

    /// `1 − e(v)`.
    #[inline(always)]
    fn fallen<T: Over<S>>(&self, velocity: T) -> T {
        let ratio = velocity / T::of(self.stribeck_velocity);
        -(-(ratio * ratio)).exp_m1()
    }

    /// `1/r(v)` in 1/m.
    #[inline(always)]
    fn decay<T: Over<S>>(&self, fallen: T) -> T {
        T::one() / (T::of(self.reach) * (T::one() + T::of(self.excess) * (T::one() - fallen)))
    }

    /// The rate ż of the deflection in m/s, at a velocity (m/s) whose sign is `direction`.
    #[doc(hidden)]
    #[cfg(feature = "alloc")]
    #[inline(always)]
    pub fn rate<T: Over<S>>(&self, deflection: T, velocity: T, direction: T) -> T {
        let decay = self.decay(self.fallen(velocity));
        velocity - direction * velocity * decay * deflection
    }

    /// The force over the secant stiffness in m.
    #[doc(hidden)]
    #[cfg(feature = "alloc")]
    #[inline(always)]
    pub fn width_at<T: Over<S>>(&self, deflection: T, velocity: T, direction: T) -> T {
        let fallen = self.fallen(velocity);
        let rate = velocity - direction * velocity * self.decay(fallen) * deflection;
        let damping = T::of(self.damping_time) * (T::one() - fallen);
        T::of(self.ratio()) * (deflection + damping * rate)
    }

    /// The part of that in m that dissipates, in magnitude.
    #[cfg(feature = "alloc")]
    pub(crate) fn dissipating(&self, deflection: S, velocity: S, direction: S) -> S {
        let fallen = self.fallen(velocity);
        let decay = self.decay(fallen);
        let (bent, speed) = (decay * deflection, direction * velocity);
        let damping = self.damping_time * (S::one() - fallen);
        self.ratio() * (bent * deflection + damping * speed * (S::one() - direction * bent))
    }

    /// Deflection in m and `1 − e(v)` when the length has moved on by `displacement` m in one direction, to a velocity in m/s.
    #[inline(always)]
    fn after<T: Over<S>>(&self, memory: &Memory<S>, displacement: T, velocity: T) -> [T; 2] {
        let start = T::of(memory.elements[DEFLECTION]);
        let [before, now] = [T::of(memory.elements[FALLEN]), self.fallen(velocity)];
        let decay = T::constant(0.5) * (self.decay(before) + self.decay(now));
        let way = displacement.magnitude();
        let part = relative_exponential(-(decay * way));
        [start + (displacement - way * decay * start) * part, now]
    }

    /// The force over the secant stiffness in m at an actuator length in m and a velocity in m/s.
    #[inline(always)]
    pub(super) fn width<T: Over<S>>(&self, memory: &Memory<S>, length: T, velocity: T) -> T {
        let [deflection, fallen] = self.after(memory, length - T::of(memory.at), velocity);
        let rate = velocity - velocity.magnitude() * self.decay(fallen) * deflection;
        let damping = T::of(self.damping_time) * (T::one() - fallen);
        T::of(self.ratio()) * (deflection + damping * rate)
    }

    #[inline(always)]
    pub(super) fn moved(&self, memory: &mut Memory<S>, length: S, velocity: S) {
        let [deflection, fallen] = self.after(memory, length - memory.at, velocity);
        (memory.elements[DEFLECTION], memory.elements[FALLEN]) = (deflection, fallen);
        memory.at = length;
    }
}

impl<R: Real> LuGre<R> {
    /// Whether the bristles are damped.
    #[cfg(feature = "alloc")]
    pub(crate) fn is_damped(&self) -> bool {
        self.damping_time.value() > 0.0
    }

    /// Whether the force depends on the velocity otherwise than by its sign.
    #[cfg(feature = "alloc")]
    #[doc(hidden)]
    pub fn falls(&self) -> bool {
        self.is_damped() || self.excess.value() > 0.0
    }

    /// The steepest fall in N·s/m of the force with velocity at a deflection that stays, at a secant stiffness in N/m: that of
    /// `σ₁ e(v) v (1 − z/r(v))` with bristles fully bent the other way.
    #[cfg(feature = "alloc")]
    pub(crate) fn steepest_fall(&self, secant_stiffness: f64) -> f64 {
        /// `2 e^(−3/2)`: the steepest fall of `x exp(−x²)`.
        const STEEPEST: f64 = 0.446_260_320_296_859_6;
        let damping = self.ratio().value() * secant_stiffness * self.damping_time.value();
        STEEPEST * damping * (2.0 + self.excess.value())
    }

    /// The branch at the velocity of the memory, without the damping of the bristles.
    pub(super) fn branch(&self, memory: &Memory<R>, direction: f64) -> Branch<R> {
        let (ratio, sign) = (self.ratio(), R::constant(direction));
        let (deflection, decay) = (memory.elements[DEFLECTION], self.decay(memory.elements[FALLEN]));
        Branch {
            from: memory.at,
            width: ratio * deflection,
            slope: ratio * (R::one() - sign * decay * deflection),
            decay: sign * decay,
            slipping: R::zero(),
            wear: decay / ratio,
            end: None,
        }
    }
}
