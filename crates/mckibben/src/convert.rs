//! From one scalar to another: the numbers of a rig, one by one.
//!
//! Every struct of parameters hands its numbers to a [`Convert`] in a fixed order and builds itself again from what comes
//! back. Numbers that follow from parameters (a reciprocal, the polynomial of the flow law) are computed again, so that
//! derivatives with respect to a parameter pass through them, or carried over as they are.

use crate::parameter::Parameter;
#[cfg(feature = "alloc")]
use crate::plant::Part;
use crate::scalar::Scalar;

/// Turns numbers of `S` into numbers of `T`.
pub trait Convert<S, T> {
    /// A parameter's number.
    fn parameter(&mut self, parameter: &'static Parameter, value: S) -> T;

    /// How numbers that follow from parameters are carried over; `None` when they are to be computed again.
    fn carry(&mut self) -> Option<impl FnMut(S) -> T>;

    /// What follows belongs to this part, or to none.
    #[cfg(feature = "alloc")]
    fn turn_to(&mut self, _part: Option<Part>) {}
}

/// A function of parameters; what follows from them is computed again.
pub(crate) struct ConvertEach<F>(pub(crate) F);

/// Applies a function to the parameters of a plant or a joint, each with the part that it belongs to.
#[cfg(feature = "alloc")]
pub(crate) struct ConvertEachOf<F> {
    pub(crate) function: F,
    pub(crate) part: Option<Part>,
}

#[cfg(feature = "alloc")]
impl<S, T: Scalar, F: FnMut(Option<Part>, &'static Parameter, S) -> T> Convert<S, T> for ConvertEachOf<F> {
    fn parameter(&mut self, parameter: &'static Parameter, value: S) -> T {
        (self.function)(self.part, parameter, value)
    }

    fn carry(&mut self) -> Option<impl FnMut(S) -> T> {
        None::<fn(S) -> T>
    }

    fn turn_to(&mut self, part: Option<Part>) {
        self.part = part;
    }
}

impl<S, T: Scalar, F: FnMut(&'static Parameter, S) -> T> Convert<S, T> for ConvertEach<F> {
    fn parameter(&mut self, parameter: &'static Parameter, value: S) -> T {
        (self.0)(parameter, value)
    }

    fn carry(&mut self) -> Option<impl FnMut(S) -> T> {
        None::<fn(S) -> T>
    }
}
