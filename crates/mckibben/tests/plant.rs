//! Plants: those of one actuator are their rigs, those of a joint their joints.

mod common;

mod plant_of_joint;
mod plant_of_rig;
mod plant_pairs;
mod plant_sample;
