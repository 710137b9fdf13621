//! Hysteresis that remembers the length's turning points: elastic elements that slip.
//!
//! ```text
//! F_h = k_sec⁺ Σ wᵢ zᵢ          dzᵢ/dL = 1 while |zᵢ| < rᵢ, and zᵢ stays at ± rᵢ while it slips
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | rᵢ | `reach`, the deflection at which an element slips | m |
//! | wᵢ | `stiffness_ratio`, its stiffness over the actuator's secant stiffness (13) | 1 |
//! | zᵢ | its deflection: the memory | m |
//! | k_sec | secant stiffness (13), which grows with the pressure | N/m |
//!
//! A sum of such elements (Maxwell-slip, Iwan, the stop operators of Prandtl and Ishlinskii; the play operator of the same
//! threshold is `x − zᵢ`) makes any loop whose outward branch is concave: after a turn the force over the secant stiffness
//! follows twice the virgin curve `w(x) = Σ wᵢ min(x, rᵢ)` at half the way (Masing), inner loops close, and a closed one is
//! forgotten. One element of `w r = Q` whose reach goes to zero is the paper's Coulomb friction: the same scale, so the
//! loops grow with the pressure as in its Fig. 4.
//!
//! The elements depend on the path of the length and not on its speed. Slip dissipates `k_sec wᵢ rᵢ |dL| ≥ 0`. An element
//! that is deflected while the pressure changes is loaded or unloaded by that, which the gas does not feel: the energy audit
//! shows how much.
//!
//! Sources: Iwan, J. Appl. Mech. 33 (1966); Vo-Minh, Tjahjowidodo, Ramon & Van Brussel, IEEE/ASME Trans. Mechatronics 16
//! (2011), for pneumatic muscles. The scale by (13) is this project's. Checked by `tests/hysteresis.rs`.

use super::memory::{Branch, MAX_ELEMENTS, Memory};
use crate::convert::Convert;
use crate::error::Error;
use crate::parameter;
use crate::scalar::{Over, Real, Scalar};

/// Elastic elements that slip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaxwellSlip<S = f64> {
    count: usize,
    reach: [S; MAX_ELEMENTS],
    stiffness_ratio: [S; MAX_ELEMENTS],
}

impl MaxwellSlip {
    /// Elements by `reach` (m) and `stiffness_ratio`, all above zero.
    ///
    /// # Errors
    /// [`Error::Table`] when the lists differ in length, are empty, hold more than [`MAX_ELEMENTS`] or a number that is not
    /// above zero.
    pub fn new(reach: &[f64], stiffness_ratio: &[f64]) -> Result<Self, Error> {
        let (reach_row, ratio_row) = (&parameter::HYSTERESIS_REACH, &parameter::HYSTERESIS_STIFFNESS_RATIO);
        let fault = |name, problem, entry| {
            Err(Error::Table {
                name,
                problem,
                entry,
                remedy: "give 1 to 12 elements, each with its reach and stiffness ratio",
            })
        };
        if reach.is_empty() {
            return fault(reach_row.key, "it has no entry", 1);
        }
        if reach.len() > MAX_ELEMENTS {
            return fault(reach_row.key, "it has too many entries", MAX_ELEMENTS + 1);
        }
        if reach.len() != stiffness_ratio.len() {
            let shorter = reach.len().min(stiffness_ratio.len());
            return fault(ratio_row.key, "its length is not that of `reach`", shorter + 1);
        }
        let (mut reaches, mut ratios) = ([0.0; MAX_ELEMENTS], [0.0; MAX_ELEMENTS]);
        for (i, (reach, ratio)) in reach.iter().zip(stiffness_ratio).enumerate() {
            (reaches[i], ratios[i]) = (reach_row.check(*reach)?, ratio_row.check(*ratio)?);
        }
        Ok(Self { count: reach.len(), reach: reaches, stiffness_ratio: ratios })
    }
}

impl<S: Scalar> MaxwellSlip<S> {
    pub(super) fn convert<T: Scalar>(&self, convert: &mut impl Convert<S, T>) -> MaxwellSlip<T> {
        let mut same = MaxwellSlip {
            count: self.count,
            reach: [T::zero(); MAX_ELEMENTS],
            stiffness_ratio: [T::zero(); MAX_ELEMENTS],
        };
        for i in 0..self.count {
            same.reach[i] = convert.parameter(&parameter::HYSTERESIS_REACH, self.reach[i]);
            same.stiffness_ratio[i] =
                convert.parameter(&parameter::HYSTERESIS_STIFFNESS_RATIO, self.stiffness_ratio[i]);
        }
        same
    }

    /// How many elements there are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The deflection in m at which an element slips.
    pub fn reach(&self, element: usize) -> S {
        self.reach[element]
    }

    /// An element's stiffness over the secant stiffness.
    pub fn stiffness_ratio(&self, element: usize) -> S {
        self.stiffness_ratio[element]
    }

    /// The deflection in m of an element when the length has moved on by `displacement` m in one direction.
    #[inline(always)]
    fn after<T: Over<S>>(&self, element: usize, memory: &Memory<S>, displacement: T) -> T {
        let reach = T::of(self.reach[element]);
        (T::of(memory.elements[element]) + displacement).smaller(reach).larger(-reach)
    }

    /// `Σ wᵢ zᵢ` in m at an actuator length in m.
    #[inline(always)]
    pub(super) fn width<T: Over<S>>(&self, memory: &Memory<S>, length: T) -> T {
        let displacement = length - T::of(memory.at);
        let mut sum = T::zero();
        for element in 0..self.count {
            sum = self.after(element, memory, displacement).multiply_add(T::of(self.stiffness_ratio[element]), sum);
        }
        sum
    }

    #[inline(always)]
    pub(super) fn moved(&self, memory: &mut Memory<S>, length: S) {
        let displacement = length - memory.at;
        for element in 0..self.count {
            memory.elements[element] = self.after(element, memory, displacement);
        }
        memory.at = length;
    }
}

impl<R: Real> MaxwellSlip<R> {
    /// How far in m an element is from slipping in a direction.
    fn left(&self, element: usize, memory: &Memory<R>, direction: f64) -> R {
        self.reach[element] - R::constant(direction) * memory.elements[element]
    }

    fn nearest(&self, memory: &Memory<R>, direction: f64) -> Option<R> {
        (0..self.count)
            .map(|element| self.left(element, memory, direction))
            .filter(|left| left.value() > 0.0)
            .reduce(|least, left| if left.value() < least.value() { left } else { least })
    }

    pub(super) fn branch(&self, memory: &Memory<R>, direction: f64) -> Branch<R> {
        let sign = R::constant(direction);
        let mut branch = Branch {
            from: memory.at,
            width: R::zero(),
            slope: R::zero(),
            decay: R::zero(),
            slipping: R::zero(),
            wear: R::zero(),
            end: None,
        };
        for element in 0..self.count {
            let ratio = self.stiffness_ratio[element];
            branch.width = branch.width + ratio * memory.elements[element];
            if self.left(element, memory, direction).value() > 0.0 {
                branch.slope = branch.slope + ratio;
            } else {
                branch.slipping = branch.slipping + ratio * self.reach[element];
            }
        }
        if direction != 0.0 {
            branch.end = self.nearest(memory, direction).map(|left| memory.at + sign * left);
        }
        branch
    }

    pub(super) fn slip(&self, memory: &mut Memory<R>, direction: f64, length: R) {
        let Some(nearest) = self.nearest(memory, direction) else { return };
        // Two elements whose lengths differ only by rounding slip together.
        let together = nearest.value() + 4.0 * f64::EPSILON * memory.at.value().abs();
        let slips: [bool; MAX_ELEMENTS] = core::array::from_fn(|element| {
            element < self.count && self.left(element, memory, direction).value() <= together
        });
        self.moved(memory, length);
        for element in 0..self.count {
            if slips[element] {
                memory.elements[element] = R::constant(direction) * self.reach[element];
            }
        }
    }
}
