//! What friction remembers at the start of a run: the branch that it is on, or a force that it holds.
//!
//! Each law is brought there by a way in one direction from where it was relaxed, as a test bench would: after a long way all
//! of it slides, and after the right one it has any force below that.

use super::memory::{Hysteresis, Memory};
use crate::dual::Dual;
use crate::root;
use crate::scalar::{Over, Real, Scalar};

/// A way in m after which every law slides: hundreds of actuators long.
const FAR: f64 = 1e3;

impl<R: Real> Hysteresis<R> {
    /// The memory at an actuator length in m after a way in one direction in m, from where it was relaxed.
    fn after_way(&self, length: R, way: R) -> Memory<R> {
        let mut memory = Memory::relaxed(length - way);
        self.moved(&mut memory, length, R::zero());
        memory
    }

    /// The memory at an actuator length in m after a long way in a direction: +1 lengthening, −1 shortening.
    pub(crate) fn slid(&self, length: R, direction: f64) -> Memory<R> {
        self.after_way(length, R::constant(FAR * direction))
    }

    /// The largest force at rest over the secant stiffness in m.
    pub(crate) fn widest(&self, length: R) -> R {
        self.width(&self.slid(length, 1.0), length, R::zero())
    }

    /// The memory at an actuator length in m with a force over the secant stiffness in m, after the shortest way from where it
    /// was relaxed; `width` lies within [`Hysteresis::widest`].
    pub(crate) fn holding(&self, length: R, width: R) -> Memory<R> {
        let (sign, wanted) = (if width.value() < 0.0 { -1.0 } else { 1.0 }, width.value().abs());
        let direction = R::constant(sign);
        let zero = R::zero();
        let lacks = |way: f64| {
            let memory = self.after_way(length, R::constant(sign * way));
            sign * self.width(&memory, length, zero).value() - wanted
        };
        if wanted == 0.0 {
            return Memory::relaxed(length);
        }
        let mut most = wanted;
        while lacks(most) < 0.0 {
            most *= 2.0;
            if most > FAR {
                return self.slid(length, sign);
            }
        }
        let way = root::bracketed(0.0, most, 1e-16 * most, lacks);
        // One step of Newton's carries the derivatives.
        let along: Dual<R, 1> = Dual::variable(R::constant(way), 0);
        let relaxed = Memory::relaxed(zero);
        let near = self.width(&relaxed, <Dual<R, 1> as Over<R>>::of(direction) * along, Dual::constant(0.0));
        let step = (near.value - width) / near.slope[0];
        let way = R::constant(way);
        let way = if step.value().abs() < 1e-9 * way.value() { way - step } else { way };
        self.after_way(length, direction * way)
    }
}
