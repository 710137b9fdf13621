//! Named valves, each number with the data sheet, catalogue or publication that states it.
//!
//! Data sheets seldom give all that a simulation needs. What they leave out is marked as assumed, with the ground; a program
//! lists it with its results, and a file's own key takes its place. A flow "from 6 to 5 bar" is a maker's nominal flow,
//! turned into a sonic conductance by ISO 6358 with the critical ratio that is stated with it. A five-way valve appears
//! here by one of its outputs.
//!
//! Checked by `tests/tables.rs` with the other presets.

use super::{Preset, PresetValue, assumed, stated, word};
use crate::choice::Choice;
use mckibben::parameter::{self as p};

const THREE_WAY: &[(&str, &str)] = &[("valve.kind", "three-way")];

/// A critical ratio that no source gives.
const fn usual_critical_ratio() -> PresetValue {
    assumed(&p::CRITICAL_RATIO, "0.3", "assumed: the source gives none; small valves have 0.2 to 0.4")
}

/// The paper's valve.
static MATRIX_EIGHT_CHANNEL: Preset = Preset {
    name: "matrix-eight-channel",
    meaning: "One channel of the Matrix eight-channel solenoid valve that the paper measured.",
    words: THREE_WAY,
    values: &[
        stated(&p::FLOW_AREA, "1.8e-5 ft^2", "paper, section 3.2"),
        stated(&p::EFFICIENCY, "0.85", "paper, section 3.3"),
        stated(&p::OPENING_DELAY, "4 ms", "paper, section 3.3"),
        stated(&p::CLOSING_DELAY, "1 ms", "paper, section 3.3"),
    ],
};

const LUCY: &str = "Vrije Universiteit Brussel, walking robot Lucy, page on its valves: 1 ms";

static MATRIX_821: Preset = Preset {
    name: "matrix-821",
    meaning: "Matrix 821, two-way, normally closed, as on the pleated muscles of the robot Lucy; 180 NL/min.",
    words: &[("valve.kind", "two-way")],
    values: &[
        assumed(
            &p::SONIC_CONDUCTANCE,
            "0.465 L/(s*bar)",
            "assumed: the 180 NL/min of the Lucy page, taken as choked flow from 6 bar gauge",
        ),
        usual_critical_ratio(),
        stated(&p::OPENING_DELAY, "1 ms", LUCY),
        assumed(&p::CLOSING_DELAY, "1 ms", "assumed: as the opening"),
    ],
};

static FESTO_MH1: Preset = Preset {
    name: "festo-mh1",
    meaning: "Festo MH1 miniature valve, 3/2-way; 10 L/min.",
    words: THREE_WAY,
    values: &[
        assumed(
            &p::SONIC_CONDUCTANCE,
            "0.0393 L/(s*bar)",
            "assumed: the 10 L/min of the MH1 catalogue (Festo, 2010/01), taken from 6 to 5 bar gauge",
        ),
        usual_critical_ratio(),
        stated(&p::OPENING_DELAY, "4 ms", "Festo, MH1 catalogue, 2010/01: response time 4 ms"),
        assumed(&p::CLOSING_DELAY, "4 ms", "assumed: as the opening"),
    ],
};

static FESTO_MHA2: Preset = Preset {
    name: "festo-mha2",
    meaning: "Festo MHA2-MS1H-3/2G-2 (196119), 3/2-way, pressure-relieved poppet; nominal flow 100 L/min.",
    words: THREE_WAY,
    values: &[
        assumed(
            &p::SONIC_CONDUCTANCE,
            "0.393 L/(s*bar)",
            "assumed: the 100 L/min of its data sheet, taken from 6 to 5 bar gauge",
        ),
        usual_critical_ratio(),
        assumed(&p::OPENING_DELAY, "2 ms", "assumed: no source at hand; fast poppets take about this"),
        assumed(&p::CLOSING_DELAY, "2 ms", "assumed: as the opening"),
    ],
};

const SY: &str = "SMC, catalogue EUS11-83B-UK, series SY";

/// One output of a valve of SMC's series SY.
macro_rules! sy {
    ($id:ident, $name:literal, $meaning:literal, $c:literal, $b:literal, $time:literal, $like:literal) => {
        static $id: Preset = Preset {
            name: $name,
            meaning: $meaning,
            words: THREE_WAY,
            values: &[
                stated(&p::SONIC_CONDUCTANCE, $c, SY),
                stated(&p::CRITICAL_RATIO, $b, SY),
                assumed(&p::OPENING_DELAY, $time, $like),
                assumed(&p::CLOSING_DELAY, $time, $like),
            ],
        };
    };
}

sy!(
    SMC_SY3000,
    "smc-sy3000",
    "One output of an SMC SY3000, pilot-operated spool.",
    "1.1 L/(s*bar)",
    "0.28",
    "12 ms",
    "assumed: no source at hand; as CKD states of its 4GA1, of the same flow"
);
sy!(
    SMC_SY5000,
    "smc-sy5000",
    "One output of an SMC SY5000, pilot-operated spool.",
    "2.8 L/(s*bar)",
    "0.37",
    "19 ms",
    "assumed: no source at hand; as CKD states of its 4GA2, of about the same flow"
);

static SMC_VT307: Preset = Preset {
    name: "smc-vt307",
    meaning: "SMC VT307, direct-operated poppet, Rc 1/4.",
    words: THREE_WAY,
    values: &[
        stated(&p::CV, "0.19", "SMC, catalogue ES11-107A, flow path P to A"),
        assumed(&p::PRESSURE_DROP_RATIO, "0.7", "assumed: the usual 0.6 to 0.8"),
        stated(&p::EXHAUST_SONIC_CONDUCTANCE, "0.71 L/(s*bar)", "SMC, catalogue page of the VT307, flow path 2 to 3"),
        assumed(&p::EXHAUST_CRITICAL_RATIO, "0.3", "assumed: the source gives none; small valves have 0.2 to 0.4"),
        assumed(&p::OPENING_DELAY, "20 ms", "assumed: no source at hand"),
        assumed(&p::CLOSING_DELAY, "20 ms", "assumed: no source at hand"),
    ],
};

const CKD: &str = "CKD, manual SM-P00077-A/3 (2020), page 22, 2-position";

/// One output of a manifold valve of CKD's series M4GA-R.
macro_rules! ckd {
    ($id:ident, $name:literal, $meaning:literal, [$c:literal, $b:literal], [$exhaust_c:literal, $exhaust_b:literal],
        [$on:literal, $off:literal], $like:literal) => {
        static $id: Preset = Preset {
            name: $name,
            meaning: $meaning,
            words: THREE_WAY,
            values: &[
                stated(&p::SONIC_CONDUCTANCE, $c, CKD),
                stated(&p::CRITICAL_RATIO, $b, CKD),
                stated(&p::EXHAUST_SONIC_CONDUCTANCE, $exhaust_c, CKD),
                stated(&p::EXHAUST_CRITICAL_RATIO, $exhaust_b, CKD),
                assumed(&p::OPENING_DELAY, $on, $like),
                assumed(&p::CLOSING_DELAY, $off, $like),
            ],
        };
    };
}

ckd!(
    CKD_M4GA1R,
    "ckd-m4ga1r",
    "One output of a CKD M4GA1-R, pilot-operated soft spool.",
    ["0.99 L/(s*bar)", "0.20"],
    ["1.2 L/(s*bar)", "0.20"],
    ["12 ms", "12 ms"],
    "assumed: as CKD's catalogue states of the 4GA1 at 0.5 MPa, 2-position single"
);
ckd!(
    CKD_M4GA2R,
    "ckd-m4ga2r",
    "One output of a CKD M4GA2-R, pilot-operated soft spool.",
    ["2.3 L/(s*bar)", "0.36"],
    ["2.9 L/(s*bar)", "0.24"],
    ["19 ms", "19 ms"],
    "assumed: as CKD's catalogue states of the 4GA2 at 0.5 MPa, 2-position single"
);
ckd!(
    CKD_M4GA3R,
    "ckd-m4ga3r",
    "One output of a CKD M4GA3-R, pilot-operated soft spool.",
    ["3.2 L/(s*bar)", "0.37"],
    ["3.8 L/(s*bar)", "0.13"],
    ["25 ms", "28 ms"],
    "assumed: as CKD's catalogue states of the 4GA3 at 0.5 MPa, 2-position single"
);

/// Every named valve.
pub static VALVES: &[&Preset] = &[
    &MATRIX_EIGHT_CHANNEL,
    &MATRIX_821,
    &FESTO_MH1,
    &FESTO_MHA2,
    &SMC_SY3000,
    &SMC_SY5000,
    &SMC_VT307,
    &CKD_M4GA1R,
    &CKD_M4GA2R,
    &CKD_M4GA3R,
];

/// The words of `valve.preset`.
pub static VALVE_CHOICES: &[Choice] = &[
    word(&MATRIX_EIGHT_CHANNEL),
    word(&MATRIX_821),
    word(&FESTO_MH1),
    word(&FESTO_MHA2),
    word(&SMC_SY3000),
    word(&SMC_SY5000),
    word(&SMC_VT307),
    word(&CKD_M4GA1R),
    word(&CKD_M4GA2R),
    word(&CKD_M4GA3R),
];
