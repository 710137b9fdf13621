//! From one scalar to another: the numbers of a rig, one by one.
//!
//! Every struct of parameters hands its numbers to a [`Convert`] in a fixed order and builds itself again from what comes
//! back. Numbers that follow from parameters (a reciprocal, the polynomial of the flow law) are computed anew, so that
//! derivatives with respect to a parameter pass through them, or carried over as they are.

use crate::parameter::Parameter;
use crate::scalar::Scalar;

/// Turns numbers of `S` into numbers of `T`.
pub(crate) trait Convert<S, T> {
    /// A parameter's number.
    fn parameter(&mut self, parameter: &'static Parameter, value: S) -> T;

    /// How numbers that follow from parameters are carried over; `None` when they are to be computed anew.
    fn carry(&mut self) -> Option<impl FnMut(S) -> T>;
}

/// A function of parameters; what follows from them is computed anew.
pub(crate) struct Anew<F>(pub(crate) F);

impl<S, T: Scalar, F: FnMut(&'static Parameter, S) -> T> Convert<S, T> for Anew<F> {
    fn parameter(&mut self, parameter: &'static Parameter, value: S) -> T {
        (self.0)(parameter, value)
    }

    fn carry(&mut self) -> Option<impl FnMut(S) -> T> {
        None::<fn(S) -> T>
    }
}
