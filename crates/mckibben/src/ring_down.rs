//! Damping from a ring-down: viscous and Coulomb friction separated by how the peaks shrink.
//!
//! A mass on a spring loses a share of its amplitude to viscous friction and a constant length to Coulomb friction.
//! With same-side amplitudes `X₁ > X₂ > …`, measured from the rest position, and the drop `Δx = X − X⁺` from one to
//! the next:
//!
//! ```text
//! paper's form   Δx = X(1 − β) + 4Q                                  (24)–(26)
//! exact form     Δx = X(1 − β) + Q(1 + √β)²                          linear spring, friction of constant size
//!
//! β    = 1 − (Δx₁ − Δx₂)/(X₁ − X₂)                                   (27)  both forms
//! Q    = (Δx₁ − X₁(1 − β))/4           or over (1 + √β)²             (28)
//! c    = (2M/T_d) ln(1/β)                                            (29)–(31)
//! ζ    from β = exp(−2πζ/√(1 − ζ²))                                  (30)
//! ζ_eq = ln(X/(X − Δx))/(2π)                                         (32)  both frictions as one
//! ```
//!
//! The exact form adds up two half cycles. In each, the mass swings about a centre that Coulomb friction has moved by
//! `Q` against the motion: `X′ = √β X − Q(1 + √β)`, and twice that is the second line. The paper's `4Q` is its limit
//! for `β → 1`: from one and the same ring-down the paper's Q is the exact one times `(1 + √β)²/4`, 10 % low at
//! ζ = 0.035, while β, c and ζ agree.
//!
//! Half of the way from each peak to the trough after it obeys the exact recursion too. On a spring that stiffens with
//! length it is the better amplitude: the curvature that shortens one side lengthens the other.
//!
//! With more than two drops, (27) and (28) become the least-squares line of Δx over X, which for two is the same.
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | X | `amplitude` | m |
//! | X − Δx | `next` | m, one period later on the same side |
//! | β | `decay` | –, the paper's `b`, which here is the thread length |
//! | Q = μN/k | `coulomb_width` | m |
//! | c | `viscous` | N·s/m |
//! | ζ | `damping_ratio` | –, of the viscous part alone |
//! | M | `mass` | kg |
//! | T_d | `period` | s |
//!
//! Valid for a linear spring, underdamped, with `X > 2Q` at the last peak (friction has not yet stopped it). On the
//! muscle the spring that the mass feels is the tangent stiffness `k_t` with the valve shut, while the friction of
//! (12) is `Q k_sec`: what a ring-down yields is `Q k_sec/k_t`, not the Q of (12). A β above 1 or a Q below 0 is what
//! noise or a wrong rest position gives; it is returned as it is.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), section 3.3; exact form: piecewise solution of the damped oscillator.
//! Checked by `tests/ring_down.rs`: both recursions in closed form, the exact one against the oscillator's own
//! solution.

use crate::error::Error;
use crate::parameter::{self, Parameter, Range};
use crate::scalar::{Real, Scalar};
use core::f64::consts::PI;

/// Which constant drop is charged to Coulomb friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// `4Q`, as the paper has it: the limit of small damping.
    Paper,
    /// `Q(1 + √β)²`, exact for a linear spring and friction of constant size.
    Exact,
}

/// One period of a ring-down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cycle<S = f64> {
    /// Amplitude X in m at its beginning.
    pub amplitude: S,
    /// Amplitude `X − Δx` in m on the same side one period later.
    pub next: S,
}

/// What a ring-down yields.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damping<S = f64> {
    /// The factor β by which viscous friction alone would shrink the amplitude in one period.
    pub decay: S,
    /// Coulomb friction Q as a length in m.
    pub coulomb_width: S,
    /// Viscous damping coefficient c in N·s/m.
    pub viscous: S,
    /// Damping ratio ζ of the viscous part.
    pub damping_ratio: S,
}

/// The period of a ring-down.
static PERIOD: Parameter = Parameter {
    key: "ring_down.period",
    symbol: "T_d",
    unit: "s",
    range: Range::POSITIVE,
    default: None,
    meaning: "Time from one peak to the next on the same side.",
    source: "measurement",
    remedy: "give the time between two peaks on the same side",
};

const NAME: &str = "ring_down.amplitude";

impl Form {
    /// The constant part of a drop over its Coulomb width: 4 or `(1 + √β)²`.
    fn weight<S: Scalar>(self, decay: S) -> S {
        match self {
            Self::Paper => S::constant(4.0),
            Self::Exact => {
                let half = S::one() + decay.sqrt();
                half * half
            }
        }
    }

    /// The drop Δx in m from an amplitude in m over one period, by the recursion that this form inverts.
    pub fn drop<S: Scalar>(self, amplitude: S, decay: S, coulomb_width: S) -> S {
        amplitude * (S::one() - decay) + coulomb_width * self.weight(decay)
    }
}

/// The amplitude `X′ = √β X − Q(1 + √β)` in m on the other side, half a period after the amplitude X in m.
pub fn half_cycle<S: Scalar>(amplitude: S, decay: S, coulomb_width: S) -> S {
    let shrink = decay.sqrt();
    shrink * amplitude - coulomb_width * (S::one() + shrink)
}

impl<S: Real> Cycle<S> {
    /// The drop Δx in m.
    pub fn drop(&self) -> S {
        self.amplitude - self.next
    }

    /// The damping ratio that would explain this cycle by viscous friction alone, (32).
    ///
    /// # Errors
    /// [`Error::Table`] unless both amplitudes are finite and above zero, the second smaller than the first.
    pub fn equivalent_ratio(&self) -> Result<S, Error> {
        check([*self].into_iter(), 0)?;
        Ok((self.amplitude / self.next).ln() / S::constant(2.0 * PI))
    }
}

impl<S: Real> Damping<S> {
    /// What a decay β, above zero, and a Coulomb width Q in m mean for a `mass` in kg that swings with a `period` in s.
    pub fn new(decay: S, coulomb_width: S, period: S, mass: S) -> Self {
        let decrement = -decay.ln();
        let turn = S::constant(4.0 * PI * PI);
        Self {
            decay,
            coulomb_width,
            viscous: S::constant(2.0) * mass / period * decrement,
            damping_ratio: decrement / (turn + decrement * decrement).sqrt(),
        }
    }

    /// From successive same-side amplitudes in m, the `period` in s and the `mass` in kg.
    ///
    /// Three amplitudes give (27) and (28) themselves; more are fitted by least squares.
    ///
    /// # Errors
    /// [`Error::Table`] for fewer than three amplitudes, one that is not finite or not above zero, or amplitudes that
    /// do not fall, or fall so that no damping explains it; [`Error::OutOfRange`] for a period or mass that is not
    /// above zero.
    pub fn from_peaks(amplitudes: &[S], period: S, mass: S, form: Form) -> Result<Self, Error> {
        if amplitudes.len() < 3 {
            return Err(fault("it has too few peaks", amplitudes.len() + 1, "give three or more successive peaks"));
        }
        let cycles = amplitudes.windows(2).map(|pair| Cycle { amplitude: pair[0], next: pair[1] });
        Self::identify(cycles, 1, period, mass, form)
    }

    /// From cycles anywhere in the ring-down: one at its beginning and one later, as the paper measured.
    ///
    /// # Errors
    /// As [`Damping::from_peaks`], and for fewer than two cycles or cycles of one amplitude.
    pub fn from_cycles(cycles: &[Cycle<S>], period: S, mass: S, form: Form) -> Result<Self, Error> {
        if cycles.len() < 2 {
            return Err(fault("it has too few cycles", cycles.len() + 1, "give two or more cycles"));
        }
        Self::identify(cycles.iter().copied(), 0, period, mass, form)
    }

    fn identify(
        cycles: impl Iterator<Item = Cycle<S>> + Clone,
        overlap: usize,
        period: S,
        mass: S,
        form: Form,
    ) -> Result<Self, Error> {
        PERIOD.check(period.value())?;
        parameter::MASS.check(mass.value())?;
        check(cycles.clone(), overlap)?;
        let count = S::constant(cycles.clone().count() as f64);
        let sum = |of: fn(&Cycle<S>) -> S| cycles.clone().fold(S::zero(), |sum, cycle| sum + of(&cycle));
        let (amplitude, drop) = (sum(|cycle| cycle.amplitude) / count, sum(Cycle::drop) / count);
        // About the means, so that nothing cancels but what must.
        let (mut above, mut below) = (S::zero(), S::zero());
        for cycle in cycles {
            let from_mean = cycle.amplitude - amplitude;
            above = above + from_mean * (cycle.drop() - drop);
            below = below + from_mean * from_mean;
        }
        if below.value() <= 0.0 {
            return Err(fault("all cycles have one amplitude", 2, "give cycles of different amplitude"));
        }
        let decay = S::one() - above / below;
        if decay.value() <= 0.0 {
            return Err(fault("the drops grow faster than any damping explains", 1, "check the rest position"));
        }
        let coulomb_width = (drop - amplitude * (S::one() - decay)) / form.weight(decay);
        Ok(Self::new(decay, coulomb_width, period, mass))
    }
}

/// Checks that amplitudes are finite, above zero and falling. `overlap` is 1 where each cycle begins with the peak that
/// ended the one before, so that entries are counted as the caller gave them.
fn check<S: Real>(cycles: impl Iterator<Item = Cycle<S>>, overlap: usize) -> Result<(), Error> {
    for (place, cycle) in cycles.enumerate() {
        let (amplitude, next) = (cycle.amplitude.value(), cycle.next.value());
        let at_next = if overlap == 1 { place + 2 } else { place + 1 };
        for (value, entry) in [(amplitude, place + 1), (next, at_next)] {
            if !value.is_finite() {
                return Err(fault("an amplitude is not a finite number", entry, "give finite amplitudes"));
            }
            if value <= 0.0 {
                return Err(fault(
                    "an amplitude is not above zero",
                    entry,
                    "measure from the rest position, peaks on one side",
                ));
            }
        }
        if next >= amplitude {
            return Err(fault("the amplitudes do not fall", at_next, "leave out peaks after the motion has stopped"));
        }
    }
    Ok(())
}

fn fault(problem: &'static str, entry: usize, remedy: &'static str) -> Error {
    Error::Table { name: NAME, problem, entry, remedy }
}
