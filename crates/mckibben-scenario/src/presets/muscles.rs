//! Measured muscles: two fluidic muscles of Festo, with the law of static force that errs least where it was not fitted.
//!
//! M. Martens & I. Boblan, "Modeling the Static Force of a Festo Pneumatic Muscle Actuator", Actuators 6(4), 33 (2017), measured
//! their tensions at held lengths and pressures up to 6.75 bar. `mckibben identify` fits every law to them and leaves each length
//! out in turn; the law with the least root mean square error at the lengths left out is taken, with its numbers from all lengths:
//!
//! | muscle | law | error in sample | error at lengths left out |
//! |---|---|---|---|
//! | DMSP-10-250 | `tondu-lopez` with a saturating bladder | 1.9 % of 542.5 N | 6.7 % |
//! | DMSP-20-300 | `martens-boblan`, with b and n | 0.2 % of 1653.5 N | 0.3 % |
//!
//! The shortest length is the shortest one measured: the law is a guess below it. Friction was not measured, and neither were the
//! taut braid and the volume of the fittings: the defaults of the parameter table hold. The data are transcribed at second hand,
//! see `validation/martens-boblan-2017/SOURCE.md`. A catalogue states diameters, forces and contractions but no braid angle, so
//! that no muscle follows from it alone.
//!
//! Checked by `tests/muscle.rs`: their forces on the measured tensions, to the errors above.

use super::{Preset, assumed, stated};
use mckibben::parameter as p;

const SIZE_10: &str = "nominal length of the DMSP-10-250 (Festo)";
const PAPER: &str = "Martens & Boblan (2017)";
const FIT_10: &str =
    "fitted to Martens & Boblan (2017), Table A2: rms error 1.9 % of 542.5 N, 6.7 % at lengths left out";
const FIT_20: &str =
    "fitted to Martens & Boblan (2017), Table A1: rms error 0.2 % of 1653.5 N, 0.3 % at lengths left out";
const SHORTEST: &str = "Martens & Boblan (2017), the shortest length with a tension";
const TAUT: &str = "assumed: the nominal length";

/// The thinner fluidic muscle of Martens & Boblan.
pub static DMSP_10_250: Preset = Preset {
    name: "festo-dmsp-10-250",
    meaning: "Festo DMSP-10-250 as Martens & Boblan (2017) measured it: rms error of the force 6.7 % at lengths left out.",
    words: &[("actuator.force.law", "tondu-lopez"), ("actuator.bladder.form", "saturating")],
    values: &[
        stated(&p::LENGTH, "250 mm", SIZE_10),
        assumed(&p::DIAMETER, "10 mm", "assumed: the nominal inner diameter (Festo), taken for that of the braid"),
        stated(&p::BRAID_ANGLE, "28.6 deg", PAPER),
        assumed(&p::MAX_LENGTH, "250 mm", TAUT),
        stated(&p::MIN_LENGTH, "204 mm", SHORTEST),
        stated(&p::END_FACTOR, "0.2", "fitted as the rest of the law, on the least value that the fit admits"),
        assumed(&p::INITIAL_RADIUS, "5 mm", "assumed: half the nominal diameter; it stands before `a` and `b`"),
        stated(&p::TONDU_LOPEZ_A, "80.3442", FIT_10),
        stated(&p::TONDU_LOPEZ_B, "69.9356", FIT_10),
        stated(&p::BLADDER_FORCE, "186.718 N", FIT_10),
        stated(&p::BLADDER_SCALE, "0.0343377", FIT_10),
    ],
};

/// The thicker fluidic muscle of Martens & Boblan.
pub static DMSP_20_300: Preset = Preset {
    name: "festo-dmsp-20-300",
    meaning: "Festo DMSP-20-300 as Martens & Boblan (2017) measured it: rms error of the force 0.3 % at lengths left out.",
    words: &[
        ("actuator.force.law", "martens-boblan"),
        ("actuator.force.modulus_unit", "MPa"),
        ("actuator.force.length_unit", "m"),
    ],
    values: &[
        stated(&p::THREAD_LENGTH, "346.4347 mm", FIT_20),
        stated(&p::TURNS, "2.085415", FIT_20),
        assumed(&p::MAX_LENGTH, "300 mm", TAUT),
        stated(&p::MIN_LENGTH, "237 mm", SHORTEST),
        stated(&p::MEMBRANE_THICKNESS, "1.8 mm", PAPER),
        stated(&p::MEMBRANE_MODULUS, "[1279.29936, -13723.54396, 49023.3266, -58017.7093]", FIT_20),
    ],
};
