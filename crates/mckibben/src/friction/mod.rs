//! Friction: what the actuator loses in motion (12).
//!
//! ```text
//! F_friction = c v + Q k_sec sgn(v)       (12)
//! k_sec      = secant stiffness           (13)
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | c | `viscous`, or `c + τ_c k_sec⁺` with a structural damping | N·s/m |
//! | Q = μN/k | width of [`Coulomb`] | m |
//! | k_sec | `secant_stiffness` | N/m |
//!
//! That is the paper's law, and the default. The alternatives are what other authors put in place of its last term: a
//! force that falls with velocity or has another scale ([`Coulomb`]), and hysteresis that remembers ([`Hysteresis`]).
//! Two losses are added that measured muscles show: a damping in proportion to the stiffness
//! ([`Friction::with_structural_damping`]) and viscoelastic branches ([`Viscoelastic`]).
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 3; Q and c are averages of its ring-down tests.
//! Checked by `tests/friction.rs`: decrement 4Q per cycle, exponential decay, never negative dissipation; and
//! `tests/hysteresis.rs`, `tests/bouc_wen.rs`, `tests/lugre.rs` and `tests/viscoelastic.rs`.

mod bouc_wen;
mod coulomb;
#[cfg(feature = "alloc")]
mod initial;
mod lugre;
mod maxwell_slip;
mod memory;
mod viscoelastic;

pub use bouc_wen::BoucWen;
pub use coulomb::Coulomb;
pub use lugre::LuGre;
pub use maxwell_slip::MaxwellSlip;
pub use memory::{Branch, Hysteresis, MAX_ELEMENTS, Memory};
pub use viscoelastic::{BranchSums, MAX_BRANCHES, Viscoelastic};

use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::scalar::{Differentiable, Over, Scalar};

/// Friction of bladder and braid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction<S = f64> {
    viscous: S,
    structural: Option<S>,
    coulomb: Coulomb<S>,
    hysteresis: Option<Hysteresis<S>>,
    viscoelastic: Option<Viscoelastic<S>>,
}

/// What the states of an actuator say of its friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deflections<T> {
    /// Deflection of the bristles of LuGre's law in m, where there are such.
    pub bristles: Option<T>,
    /// Sums over the viscoelastic branches, where there are such.
    pub branches: Option<BranchSums<T>>,
}

impl<T: Scalar> Deflections<T> {
    /// These as numbers without a derivative of a wider scalar.
    #[allow(clippy::manual_map, reason = "a closure would be compiled separately, without the instructions of a batch")]
    #[inline(always)]
    pub fn constant<U: Over<T>>(&self) -> Deflections<U> {
        Deflections {
            bristles: match self.bristles {
                Some(bristles) => Some(U::of(bristles)),
                None => None,
            },
            branches: match self.branches {
                Some(BranchSums { relaxed: [k, w], relaxing: [k_rate, w_rate] }) => {
                    Some(BranchSums { relaxed: [U::of(k), U::of(w)], relaxing: [U::of(k_rate), U::of(w_rate)] })
                }
                None => None,
            },
        }
    }

    /// These as they change while the bristles bend at a rate in m/s and the first two sums of the branches change at theirs.
    #[allow(clippy::manual_map, reason = "a closure would be compiled separately, without the instructions of a batch")]
    #[inline(always)]
    pub fn along<S: Scalar>(&self, bristle_rate: T, sum_rates: [T; 2]) -> Deflections<T::Dual>
    where
        T: Differentiable<S>,
    {
        let zero = T::zero();
        Deflections {
            bristles: match self.bristles {
                Some(bristles) => Some(bristles.along(bristle_rate)),
                None => None,
            },
            branches: match self.branches {
                Some(BranchSums { relaxed: [k, w], relaxing: [k_rate, w_rate] }) => Some(BranchSums {
                    relaxed: [k.along(sum_rates[0]), w.along(sum_rates[1])],
                    relaxing: [k_rate.along(zero), w_rate.along(zero)],
                }),
                None => None,
            },
        }
    }
}

/// What friction depends on in addition to the state of the actuator: how it slides, and what it remembers.
#[derive(Clone, Copy, Debug)]
pub struct SlidingState<T> {
    /// Direction of sliding: −1 shortening, 0 at rest, +1 lengthening.
    pub direction: T,
    /// Force of hysteresis and viscoelastic branches over the secant stiffness in m, where there are such.
    pub width: Option<T>,
    /// Force in N of the viscoelastic branches that does not follow the secant stiffness, where there are such.
    pub force: Option<T>,
    /// Whether the gas presses the threads together.
    pub touch: ThreadContact,
}

/// Whether the gas presses the threads together: with the bladder sucked off the braid there is no friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThreadContact {
    /// Where the gauge pressure is above zero.
    ByPressure,
    /// They are pressed, by a formula that goes on smoothly below zero gauge pressure.
    Pressed,
    /// They are not.
    Apart,
}

/// What presses the threads together.
#[derive(Clone, Copy, Debug)]
pub struct NormalLoad<T> {
    secant_stiffness: T,
    gauge: T,
    touch: ThreadContact,
}

impl<T: Scalar> NormalLoad<T> {
    /// By a secant stiffness (N/m) and a gauge pressure (Pa).
    #[inline(always)]
    pub fn new(secant_stiffness: T, gauge: T, touch: ThreadContact) -> Self {
        Self { secant_stiffness, gauge, touch }
    }

    /// Secant stiffness `k_sec⁺` in N/m.
    #[inline(always)]
    pub fn secant_stiffness(&self) -> T {
        self.part(self.secant_stiffness)
    }

    /// Gauge pressure `P_g⁺` in Pa.
    #[inline(always)]
    pub fn gauge(&self) -> T {
        self.part(self.gauge)
    }

    #[inline(always)]
    fn part(&self, number: T) -> T {
        match self.touch {
            ThreadContact::ByPressure => number.larger(T::zero()),
            ThreadContact::Pressed => number,
            ThreadContact::Apart => T::zero(),
        }
    }
}

impl<T: Scalar> SlidingState<T> {
    /// Force in N of hysteresis and viscoelastic branches, where there are such: it does not depend on the direction of sliding.
    #[inline(always)]
    pub fn held_force(&self, pressing: NormalLoad<T>) -> Option<T> {
        // No closures: they would be compiled separately, without the instructions of a batch.
        let scaled = match self.width {
            Some(width) => pressing.secant_stiffness() * width,
            None => return self.force,
        };
        match self.force {
            Some(force) => Some(scaled + force),
            None => Some(scaled),
        }
    }

    /// This with the force of viscoelastic branches at an actuator length in m, by their sums.
    #[inline(always)]
    pub fn with_branches<S: Scalar>(self, law: Option<&Viscoelastic<S>>, length: T, sums: Option<BranchSums<T>>) -> Self
    where
        T: Over<S>,
    {
        let (Some(law), Some(sums)) = (law, sums) else { return self };
        let [force, width] = law.forces(length, &sums);
        let width = match self.width {
            Some(of_hysteresis) => of_hysteresis + width,
            None => width,
        };
        Self { width: Some(width), force: Some(force), ..self }
    }
}

impl<T: Scalar> From<T> for SlidingState<T> {
    /// A direction of sliding without hysteresis.
    #[inline(always)]
    fn from(direction: T) -> Self {
        Self { direction, width: None, force: None, touch: ThreadContact::ByPressure }
    }
}

impl Friction {
    /// The paper's: `viscous` damping `c` in N·s/m and `coulomb_width` `Q` in m, both zero or more.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when one is negative or not finite.
    pub fn new(viscous: f64, coulomb_width: f64) -> Result<Self, Error> {
        Self::with_coulomb(viscous, Coulomb::new(coulomb_width)?)
    }

    /// `viscous` damping in N·s/m, zero or more, and a law of dry friction.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when the damping is negative or not finite.
    pub fn with_coulomb(viscous: f64, coulomb: Coulomb) -> Result<Self, Error> {
        Ok(Self { viscous: parameter::VISCOUS.check(viscous)?, coulomb, ..Self::NONE })
    }

    /// Adds a law of hysteresis.
    pub fn with_hysteresis(self, hysteresis: Hysteresis) -> Self {
        Self { hysteresis: Some(hysteresis), ..self }
    }

    /// Adds a viscous damping of `time` (s, zero or more) times the secant stiffness: `c = c₀ + τ_c k_sec⁺`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when the time is negative or not finite.
    pub fn with_structural_damping(self, time: f64) -> Result<Self, Error> {
        let time = parameter::STRUCTURAL_DAMPING.check(time)?;
        Ok(Self { structural: (time > 0.0).then_some(time), ..self })
    }

    /// Adds viscoelastic branches.
    pub fn with_viscoelastic(self, branches: Viscoelastic) -> Self {
        Self { viscoelastic: Some(branches), ..self }
    }

    /// No friction.
    pub const NONE: Self =
        Self { viscous: 0.0, structural: None, coulomb: Coulomb::NONE, hysteresis: None, viscoelastic: None };
}

impl<S: Scalar> Friction<S> {
    /// Converts the friction to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> Friction<T> {
        Friction {
            viscous: convert.parameter(&parameter::VISCOUS, self.viscous),
            structural: self.structural.map(|time| convert.parameter(&parameter::STRUCTURAL_DAMPING, time)),
            coulomb: self.coulomb.convert(convert),
            hysteresis: self.hysteresis.as_ref().map(|hysteresis| hysteresis.convert(convert)),
            viscoelastic: self.viscoelastic.as_ref().map(|branches| branches.convert(convert)),
        }
    }

    /// Whether there is dry friction, and so sticking.
    #[inline(always)]
    pub fn has_coulomb(&self) -> bool {
        self.coulomb.acts()
    }

    /// Whether the force depends on the direction of motion.
    #[inline(always)]
    pub fn has_direction(&self) -> bool {
        self.has_coulomb() || self.hysteresis.is_some()
    }

    /// Whether a part of the force follows the secant stiffness or the gauge pressure, which press the threads together.
    #[inline(always)]
    pub fn follows_normal_load(&self) -> bool {
        self.has_direction() || self.structural.is_some() || self.viscoelastic.is_some()
    }

    /// Viscous damping `c₀` in N·s/m, without that in proportion to the stiffness.
    #[inline(always)]
    pub fn viscous(&self) -> S {
        self.viscous
    }

    /// Structural damping `τ_c` in s, where there is any.
    #[inline(always)]
    pub fn structural_damping(&self) -> Option<S> {
        self.structural
    }

    /// Viscous damping `c₀ + τ_c k_sec⁺` in N·s/m at a secant stiffness in N/m.
    #[inline(always)]
    pub fn viscous_at<T: Over<S>>(&self, secant_stiffness: T) -> T {
        match self.structural {
            Some(time) => T::of(self.viscous) + T::of(time) * secant_stiffness,
            None => T::of(self.viscous),
        }
    }

    /// The viscoelastic branches, if there are any.
    #[inline(always)]
    pub fn viscoelastic(&self) -> Option<&Viscoelastic<S>> {
        self.viscoelastic.as_ref()
    }

    /// The dry friction.
    #[inline(always)]
    pub fn coulomb(&self) -> &Coulomb<S> {
        &self.coulomb
    }

    /// The hysteresis, if there is any.
    #[inline(always)]
    pub fn hysteresis(&self) -> Option<&Hysteresis<S>> {
        self.hysteresis.as_ref()
    }

    /// LuGre's law, if that is the hysteresis.
    #[inline(always)]
    pub fn lugre(&self) -> Option<&LuGre<S>> {
        match &self.hysteresis {
            Some(Hysteresis::LuGre(law)) => Some(law),
            _ => None,
        }
    }

    /// The part `c₀ v` in N, at a velocity (m/s).
    #[inline(always)]
    pub fn viscous_force<T: Over<S>>(&self, velocity: T) -> T {
        T::of(self.viscous) * velocity
    }

    /// Everything but that part in N, at a velocity (m/s).
    #[inline(always)]
    pub fn pressed_force<T: Over<S>>(&self, state: SlidingState<T>, velocity: T, pressing: NormalLoad<T>) -> T {
        let mut force = T::zero();
        if self.has_coulomb() {
            force = self.coulomb.sliding(state.direction, velocity, self.coulomb.kinetic(pressing));
        }
        if let Some(time) = self.structural {
            force = force + T::of(time) * pressing.secant_stiffness() * velocity;
        }
        match state.held_force(pressing) {
            Some(held) => force + held,
            None => force,
        }
    }
}
