//! A scenario as plants that a host steps: one, and many together.

mod batch;
mod plant;
