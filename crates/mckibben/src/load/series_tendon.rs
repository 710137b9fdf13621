//! An elastic tendon between the actuator and what it pulls.
//!
//! ```text
//! T = k max(0, x − ℓ − L)
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | k | `stiffness` | N/m |
//! | ℓ | `rest_length`, of the tendon without tension | m |
//! | x | distance of what actuator and tendon pull together | m |
//! | L | length of the actuator | m |
//!
//! It has no mass and no loss, and it only pulls: let go, it hangs loose.
//!
//! Source: Hooke. Checked by `tests/plant_host.rs` and `tests/tendon_rig.rs`.

use crate::actuator::Actuator;
use crate::convert::Convert;
use crate::error::Error;
use crate::force::Statics;
use crate::parameter;
use crate::scalar::{Real, Scalar};

/// An elastic tendon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeriesTendon<S = f64> {
    stiffness: S,
    rest_length: S,
}

impl SeriesTendon {
    /// A tendon of a `stiffness` in N/m and a length without tension in m.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless the stiffness is above zero and the length zero or more.
    pub fn new(stiffness: f64, rest_length: f64) -> Result<Self, Error> {
        Ok(Self {
            stiffness: parameter::TENDON_STIFFNESS.check(stiffness)?,
            rest_length: parameter::TENDON_REST_LENGTH.check(rest_length)?,
        })
    }
}

impl<S: Scalar> SeriesTendon<S> {
    /// Stiffness k in N/m.
    pub fn stiffness(&self) -> S {
        self.stiffness
    }

    /// Length ℓ without tension in m.
    pub fn rest_length(&self) -> S {
        self.rest_length
    }

    /// Tension in N while its ends are at a distance in m; none when it hangs loose.
    pub fn tension(&self, distance: S) -> S {
        self.stiffness * (distance - self.rest_length).larger(S::zero())
    }

    /// Converts the tendon to another scalar type.
    pub(crate) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> SeriesTendon<T> {
        SeriesTendon {
            stiffness: convert.parameter(&parameter::TENDON_STIFFNESS, self.stiffness),
            rest_length: convert.parameter(&parameter::TENDON_REST_LENGTH, self.rest_length),
        }
    }
}

impl<R: Real> SeriesTendon<R> {
    /// The length in m at which the static force of an actuator at an absolute pressure (Pa) is the tension of this tendon,
    /// both over a distance (m) together; the shortest or the end length where there is none between.
    pub fn balance(&self, actuator: &Actuator<R>, distance: R, pressure: R) -> R {
        self.balance_with(actuator, distance, pressure, &|_| R::zero())
    }

    /// [`SeriesTendon::balance`] with a force in N that friction adds to the static one at a length in m.
    pub(crate) fn balance_with(
        &self,
        actuator: &Actuator<R>,
        distance: R,
        pressure: R,
        friction: &dyn Fn(R) -> R,
    ) -> R {
        let pushing = |length: R| {
            let law = actuator.static_force(length, pressure) + actuator.limits().force(length, R::zero());
            law + friction(length)
        };
        let excess = |length: R| pushing(length).larger(R::zero()) - self.tension(distance - length);
        let end = actuator.law().law.end_length().value();
        // Where the tendon hangs loose the force is not below its tension: a law may fall to zero again before its end.
        let loose = distance.value() - self.rest_length.value();
        let (least, most) = (actuator.limits().min_length().value(), loose.min(end));
        if excess(R::constant(least)).value() >= 0.0 {
            return actuator.limits().min_length();
        }
        let at_most = pushing(R::constant(most)).value();
        if most < end && at_most <= 0.0 {
            // A braid that pushes there goes on to where it neither pushes nor pulls; one without force has all the length that the
            // tendon leaves, whatever rounding makes of the tension there.
            let is_pushed = at_most < 0.0 && pushing(R::constant(end)).value() > 0.0;
            return if is_pushed { root_between([most, end], &pushing) } else { distance - self.rest_length };
        }
        let at_end = excess(R::constant(most)).value();
        if at_end.is_nan() || (at_end <= 0.0 && most == end) {
            return actuator.law().law.end_length();
        }
        root_between([least, most], &excess)
    }
}

/// Where a force that rises over the length is zero between two lengths in m, with its derivatives.
fn root_between<R: Real>([mut least, mut most]: [f64; 2], force: &dyn Fn(R) -> R) -> R {
    while most - least > 4.0 * f64::EPSILON * most {
        let middle = 0.5 * (least + most);
        if !(middle > least && middle < most) {
            break;
        }
        if force(R::constant(middle)).value() > 0.0 { most = middle } else { least = middle }
    }
    // The derivatives of the root, by a Newton step at its value.
    let (step, root) = (1e-6 * most, R::constant(most));
    let slope = (force(root + R::constant(step)) - force(root - R::constant(step))).value() / (2.0 * step);
    let left = force(root);
    root - (left - R::constant(left.value())) / R::constant(slope)
}
