//! Which numbers the lanes of a batch hold.

use mckibben::Error;

/// The numbers of a batch's lanes.
///
/// What switches, and when, is found in double precision whatever the lanes hold: a row whose mode changes takes that step as a scalar
/// instance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// `f64`: every row is its scalar instance, bit for bit.
    #[default]
    Double,
    /// `f32`, in a program that is built with the feature `f32`: twice as many rows at once.
    ///
    /// A state keeps seven digits, and what a step adds to it below the last of them is lost: 10 nm of a length, 0.05 Pa of a pressure.
    /// So rates below 10 nm a step stand still, and so does a length that a host moves more slowly.
    Single,
}

impl Precision {
    /// How many numbers stand where one of `f64` would.
    pub(crate) fn per_double(self) -> usize {
        match self {
            Self::Double => 1,
            Self::Single => 2,
        }
    }

    /// Refuses what this program is built without.
    pub(crate) fn check(self) -> Result<(), Error> {
        match self {
            Self::Single if cfg!(not(feature = "f32")) => Err(Error::Misuse {
                what: "this program is built without batches of single precision",
                remedy: "build it with the feature `f32`, or step the batch in double precision",
            }),
            _ => Ok(()),
        }
    }
}
