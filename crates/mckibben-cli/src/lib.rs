//! The program `mckibben`, as a library so that its parts are tested.

#![forbid(unsafe_code)]

pub mod plot;
