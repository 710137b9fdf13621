//! Lines, maps and scatter plots of the reductions.
use super::tally::Tally;
use crate::failure::Failure;
use crate::portrait::Format;
use crate::sweep::description::Sweep;
use std::path::Path;

/// Draws.
/// # Errors
/// None.
pub fn draw(_: &Sweep, _: &Tally, _: &str, _: (&Path, Format)) -> Result<Vec<u8>, Failure> {
    Ok(Vec::new())
}
