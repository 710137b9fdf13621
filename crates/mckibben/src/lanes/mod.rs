//! Lanes: several systems of equal structure side by side in vector registers.

pub(crate) mod deal;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
pub(crate) mod twice;
#[cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]
pub(crate) mod wide;
mod width;

pub use width::Width;
