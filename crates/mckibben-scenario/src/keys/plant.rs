//! The sections and keys that only a plant of several actuators has, and which key a path with names in it stands for.
//!
//! A path of a plant has names that the file chooses: `actuators.flexor.valve.efficiency`. What it stands for has a `*` in the
//! place of a name, and is without the part that only says whose it is: `valve.efficiency`.

use super::{CONTROLLER, Key, Section, choice, key, list, quantity, section};
use crate::choice::{FrictionStart, InletKind, MechanismKind, ValveOutput};
use crate::keys::Kind;
use mckibben::mechanism::parameter as mechanism;
use mckibben::parameter::{self as p, Parameter, Range};
use mckibben::plant::INITIAL_FRICTION_FORCE;

/// The section of the actuators.
pub(crate) const ACTUATORS: &str = "actuators";
/// The section of what feeds them.
pub(crate) const SUPPLIES: &str = "supplies";
/// The section of the one mechanism.
pub(crate) const MECHANISM: &str = "mechanism";
/// The section of several mechanisms.
pub(crate) const MECHANISMS: &str = "mechanisms";

/// Where friction with a memory starts, by a word.
pub(crate) const FRICTION_START: &str = "initial.friction";

/// Sections that an actuator may have under its name.
pub(crate) const OF_ACTUATOR: &[&str] =
    &["air", "supply", "valve", "hose", "command", "controller", "pressure", "tendon", "load", "initial", "coupling"];
/// Sections that a supply may have under its name.
pub(crate) const OF_SUPPLY: &[&str] = &["valve", "hose", "command"];

/// The row of another key at a path of a plant.
const fn at(key: &'static str, row: &Parameter) -> Parameter {
    Parameter { key, ..*row }
}

/// A row with another sentence.
const fn meaning(row: Parameter, meaning: &'static str) -> Parameter {
    Parameter { meaning, ..row }
}

/// The rows of the quantities.
pub(crate) static GRAVITY: Parameter = meaning(
    at("mechanism.gravity", &p::GRAVITY),
    "Acceleration of gravity: of a mass the way that stretches the actuators, of a chain towards its hanging angle.",
);
pub(crate) static MASS: Parameter = meaning(at("mechanism.mass", &p::MASS), "Mass that the actuators pull on.");
pub(crate) static PULL: Parameter =
    meaning(at("mechanism.force", &p::LOAD_FORCE), "Constant force on the mass, in place of gravity.");
pub(crate) static SPRING_STIFFNESS: Parameter = at("mechanism.spring_stiffness", &mechanism::SPRING_STIFFNESS);
pub(crate) static SPRING_REST_LENGTH: Parameter = at("mechanism.spring_rest_length", &mechanism::SPRING_REST_LENGTH);
pub(crate) static POSITION: Parameter =
    meaning(at("mechanism.position", &p::INITIAL_LENGTH), "Distance between the attachments at the start.");
pub(crate) static VELOCITY: Parameter =
    meaning(at("mechanism.velocity", &p::INITIAL_VELOCITY), "Rate of that distance at the start.");
pub(crate) static MOTION_LENGTH: Parameter = at("mechanism.length", &p::MOTION_LENGTH);
pub(crate) static MOTION_AMPLITUDE: Parameter = at("mechanism.amplitude", &p::MOTION_AMPLITUDE);
pub(crate) static MOTION_FREQUENCY: Parameter = at("mechanism.frequency", &p::MOTION_FREQUENCY);
pub(crate) static MOTION_PHASE: Parameter = at("mechanism.phase", &p::MOTION_PHASE);
pub(crate) static MOTION_TIME: Parameter = at("mechanism.time", &p::MOTION_TIME);
pub(crate) static MOTION_TABLE_LENGTH: Parameter = at("mechanism.table_length", &p::MOTION_TABLE_LENGTH);
pub(crate) static HANGING_ANGLE: Parameter = meaning(
    at("mechanism.hanging_angle", &p::HANGING_ANGLE),
    "Angle of the first joint at which the first segment points where gravity pulls.",
);
pub(crate) static SEGMENT_LENGTH: Parameter = meaning(
    Parameter {
        default: Some(0.0),
        range: Range::NON_NEGATIVE,
        ..at("mechanism.joints.*.length", &mechanism::SEGMENT_LENGTH)
    },
    "Length of the segment that the joint moves, to the next joint or to the foot; only the last may have none.",
);
pub(crate) static SEGMENT_MASS: Parameter = meaning(at("mechanism.joints.*.mass", &p::MASS), "Mass of that segment.");
pub(crate) static SEGMENT_DISTANCE: Parameter = meaning(
    at("mechanism.joints.*.distance", &p::LIMB_DISTANCE),
    "Distance of the segment's centre of mass from the joint.",
);
pub(crate) static SEGMENT_INERTIA: Parameter = meaning(
    at("mechanism.joints.*.inertia", &p::LIMB_INERTIA),
    "Moment of inertia of the segment about its centre of mass.",
);
pub(crate) static TORQUE: Parameter = meaning(
    at("mechanism.joints.*.torque", &p::JOINT_TORQUE),
    "Constant torque about the joint towards greater angles.",
);
pub(crate) static DAMPING: Parameter = at("mechanism.joints.*.damping", &p::JOINT_DAMPING);
pub(crate) static MIN_ANGLE: Parameter = at("mechanism.joints.*.min_angle", &p::MIN_ANGLE);
pub(crate) static MAX_ANGLE: Parameter = at("mechanism.joints.*.max_angle", &p::MAX_ANGLE);
pub(crate) static STOP_STIFFNESS: Parameter = at("mechanism.joints.*.stop_stiffness", &p::STOP_STIFFNESS);
pub(crate) static STOP_DAMPING: Parameter = at("mechanism.joints.*.stop_damping", &p::STOP_DAMPING);
pub(crate) static ANGLE: Parameter = meaning(
    Parameter { default: Some(0.0), ..at("mechanism.joints.*.angle", &p::INITIAL_ANGLE) },
    "Angle of the joint at the start.",
);
pub(crate) static ANGULAR_VELOCITY: Parameter = at("mechanism.joints.*.angular_velocity", &p::INITIAL_ANGULAR_VELOCITY);
pub(crate) static BELT_DEPTH: Parameter =
    meaning(at("mechanism.belt.depth", &mechanism::BELT_DEPTH), "How far the belt is under the first joint.");
pub(crate) static BELT_VELOCITY: Parameter = meaning(
    at("mechanism.belt.velocity", &mechanism::BELT_VELOCITY),
    "Velocity of the belt, positive the way in which positive angles swing.",
);
pub(crate) static BELT_STIFFNESS: Parameter = at("mechanism.belt.stiffness", &mechanism::BELT_STIFFNESS);
pub(crate) static BELT_DAMPING: Parameter = at("mechanism.belt.damping", &mechanism::BELT_DAMPING);
pub(crate) static BELT_FRICTION: Parameter = at("mechanism.belt.friction", &mechanism::BELT_FRICTION);
pub(crate) static SLIPPING_SPEED: Parameter = at("mechanism.belt.slipping_speed", &mechanism::SLIPPING_SPEED);
pub(crate) static REST_LENGTH: Parameter = meaning(
    at("coupling.rest_length", &p::REST_LENGTH),
    "Distance between the actuator's attachments where all angles are zero.",
);
pub(crate) static ARM: Parameter = meaning(
    Parameter {
        range: Range::FINITE,
        remedy: "give a length other than zero, with a minus where the actuator turns the joint back",
        ..at("coupling.arms.*", &p::PULLEY_RADIUS)
    },
    "Moment arm about the joint of that name, positive where tension turns it towards greater angles; or a table.",
);
pub(crate) static ARM_ANGLE: Parameter = at("coupling.arms.*.angle", &p::MOMENT_ARM_ANGLE);
pub(crate) static ARM_TABLE: Parameter = meaning(
    Parameter { range: Range::FINITE, ..at("coupling.arms.*.arm", &p::MOMENT_ARM) },
    "Moment arm at each of these angles, all with the same sign.",
);
/// The places of an attachment along and across its segment, of both ends.
pub(crate) static PLACES: [[Parameter; 2]; 2] = [
    [
        meaning(
            at("coupling.origin.along", &mechanism::ATTACHMENT),
            "Place along the segment from the joint above it; on the ground, the way gravity pulls from the first joint.",
        ),
        meaning(
            Parameter { default: Some(0.0), ..at("coupling.origin.across", &mechanism::ATTACHMENT) },
            "Place across it, positive the way in which positive angles swing.",
        ),
    ],
    [
        meaning(
            at("coupling.insertion.along", &mechanism::ATTACHMENT),
            "Place along the segment from the joint above it; on the ground, the way gravity pulls from the first joint.",
        ),
        meaning(
            Parameter { default: Some(0.0), ..at("coupling.insertion.across", &mechanism::ATTACHMENT) },
            "Place across it, positive the way in which positive angles swing.",
        ),
    ],
];
pub(crate) static INLET_FLOW_AREA: Parameter = at("supplies.*.inlet.flow_area", &p::FLOW_AREA);
pub(crate) static INLET_SONIC_CONDUCTANCE: Parameter = at("supplies.*.inlet.sonic_conductance", &p::SONIC_CONDUCTANCE);
pub(crate) static INLET_CRITICAL_RATIO: Parameter = at("supplies.*.inlet.critical_ratio", &p::CRITICAL_RATIO);
pub(crate) static INLET_KV: Parameter = at("supplies.*.inlet.kv", &p::KV);
pub(crate) static INLET_CV: Parameter = at("supplies.*.inlet.cv", &p::CV);
pub(crate) static INLET_DROP: Parameter = at("supplies.*.inlet.pressure_drop_ratio", &p::PRESSURE_DROP_RATIO);
pub(crate) static INLET_EFFICIENCY: Parameter = at("supplies.*.inlet.efficiency", &p::EFFICIENCY);
pub(crate) static INLET_LAMINAR_RATIO: Parameter = at("supplies.*.inlet.laminar_ratio", &p::LAMINAR_RATIO);

const MECHANISM_KIND: &str = "mechanism.kind";
const OF_MASS: &[&str] = &[MechanismKind::Mass.name()];
const OF_MOTION: &[&str] = &[MechanismKind::Prescribed.name()];
const OF_CHAIN: &[&str] = &[MechanismKind::Chain.name()];
const PULLED: &[&str] = &[MechanismKind::Mass.name(), MechanismKind::Chain.name()];
const PLACED: &[&str] = &[MechanismKind::Mass.name(), MechanismKind::Fixed.name()];

/// The sections of a plant.
pub static PLANT_SECTIONS: &[Section] = &[
    section(ACTUATORS, "The actuators of a plant, by their names.", false),
    section(
        "actuators.*",
        "One actuator: keys of [actuator], and below it other sections, where it differs from those of the file.",
        false,
    ),
    section("coupling", "How an actuator spans the mechanism.", false),
    section("coupling.arms", "Moment arms, by the names of the joints that the actuator spans.", false),
    section("coupling.arms.*", "A moment arm that changes with the angle.", false),
    section("coupling.origin", "Where the actuator begins, in place of moment arms.", false),
    section("coupling.insertion", "Where it ends.", false),
    section(SUPPLIES, "What feeds the actuators, by names; [supply] is one of that name.", false),
    section("supplies.*", "One supply: the keys of [supply], and what feeds it.", false),
    section("supplies.*.inlet", "The flow path through which a reservoir or manifold is fed.", false),
    section(MECHANISM, "What the actuators move together.", false),
    section("mechanism.joints", "The joints of a chain, by their names, from the fixed axis on; at most eight.", false),
    section("mechanism.joints.*", "A joint, and the segment that it moves.", false),
    section(
        "mechanism.joints.*.controller",
        "A controller of the joint: the keys of [controller], and the two actuators whose valves it drives.",
        false,
    ),
    section("mechanism.belt", "A belt under the end of the last segment; none when absent.", false),
    section(MECHANISMS, "Several mechanisms, by names; each as [mechanism].", false),
];

/// The keys of a plant.
pub static PLANT_KEYS: &[Key] = &[
    key("actuators.*.supply", Kind::Name, "Name of the supply that feeds the actuator's valve.", "\"supply\""),
    choice(
        "valve.output",
        ValveOutput::CHOICES,
        "Which output of a five-way valve drives the actuator, in a plant.",
        "\"a\"",
    )
    .or("a"),
    choice(FRICTION_START, FrictionStart::CHOICES, "Where friction with a memory starts.", "\"loading\"").or("relaxed"),
    quantity(&INITIAL_FRICTION_FORCE, "\"5 N\""),
    key("coupling.mechanism", Kind::Name, "Name of the mechanism, where there are several.", "\"mechanism\""),
    quantity(&REST_LENGTH, "\"3.3 in\""),
    quantity(&ARM, "\"15 mm\""),
    list(&ARM_ANGLE, "[\"-40 deg\", \"40 deg\"]").required(),
    list(&ARM_TABLE, "[\"14 mm\", \"18 mm\"]").required(),
    key(
        "coupling.origin.segment",
        Kind::Name,
        "Name of the segment that the actuator begins on; the ground when absent.",
        "\"knee\"",
    ),
    quantity(&PLACES[0][0], "\"2 cm\"").required(),
    quantity(&PLACES[0][1], "\"2 cm\""),
    key(
        "coupling.insertion.segment",
        Kind::Name,
        "Name of the segment that the actuator ends on; the ground when absent.",
        "\"knee\"",
    ),
    quantity(&PLACES[1][0], "\"2 cm\"").required(),
    quantity(&PLACES[1][1], "\"2 cm\""),
    key("supplies.*.from", Kind::Name, "Name of the supply that feeds this one.", "\"supply\""),
    choice("supplies.*.inlet.kind", InletKind::CHOICES, "What the flow path is.", "\"open\"").or("open"),
    quantity(&INLET_FLOW_AREA, "\"10 mm^2\""),
    quantity(&INLET_SONIC_CONDUCTANCE, "\"20 L/(min*bar) ANR\""),
    quantity(&INLET_CRITICAL_RATIO, "0.3"),
    quantity(&INLET_KV, "\"0.05 m^3/h\""),
    quantity(&INLET_CV, "0.06"),
    quantity(&INLET_DROP, "0.7"),
    quantity(&INLET_EFFICIENCY, "0.85"),
    quantity(&INLET_LAMINAR_RATIO, "0.999"),
    choice(MECHANISM_KIND, MechanismKind::CHOICES, "What the actuators move.", "\"chain\"").required(),
    quantity(&MASS, "\"5 lb\"").required().when(MECHANISM_KIND, OF_MASS),
    quantity(&GRAVITY, "\"9.80665 m/s^2\"").when(MECHANISM_KIND, PULLED),
    quantity(&PULL, "\"5 lbf\"").when(MECHANISM_KIND, OF_MASS),
    quantity(&SPRING_STIFFNESS, "\"1 N/mm\"").when(MECHANISM_KIND, OF_MASS),
    quantity(&SPRING_REST_LENGTH, "\"10 cm\"").when(MECHANISM_KIND, OF_MASS),
    quantity(&POSITION, "\"3.5 in\"").required().when(MECHANISM_KIND, PLACED),
    quantity(&VELOCITY, "\"0 m/s\"").when(MECHANISM_KIND, OF_MASS),
    quantity(&MOTION_LENGTH, "\"3.5 in\"").when(MECHANISM_KIND, OF_MOTION),
    quantity(&MOTION_AMPLITUDE, "\"0.2 in\"").when(MECHANISM_KIND, OF_MOTION),
    quantity(&MOTION_FREQUENCY, "\"2 Hz\"").when(MECHANISM_KIND, OF_MOTION),
    quantity(&MOTION_PHASE, "\"0 deg\"").when(MECHANISM_KIND, OF_MOTION),
    list(&MOTION_TIME, "[\"0 s\", \"1 s\"]").when(MECHANISM_KIND, OF_MOTION),
    list(&MOTION_TABLE_LENGTH, "[\"3.8 in\", \"3.5 in\"]").when(MECHANISM_KIND, OF_MOTION),
    quantity(&HANGING_ANGLE, "\"0 deg\"").when(MECHANISM_KIND, OF_CHAIN),
    key(
        "mechanism.joints.*.segment",
        Kind::Name,
        "Name of the segment that the joint moves; the joint's when absent.",
        "\"shank\"",
    ),
    key(
        "mechanism.joints.*.after",
        Kind::Name,
        "Name of the joint before it; the one above it in the file when absent.",
        "\"hip\"",
    ),
    quantity(&SEGMENT_LENGTH, "\"30 cm\""),
    quantity(&SEGMENT_MASS, "\"1 kg\"").required(),
    quantity(&SEGMENT_DISTANCE, "\"15 cm\"").required(),
    quantity(&SEGMENT_INERTIA, "\"1e-3 kg*m^2\""),
    quantity(&TORQUE, "\"0 N*m\""),
    quantity(&DAMPING, "\"0.01 N*m*s/rad\""),
    quantity(&MIN_ANGLE, "\"-45 deg\""),
    quantity(&MAX_ANGLE, "\"45 deg\""),
    quantity(&STOP_STIFFNESS, "\"500 N*m/rad\""),
    quantity(&STOP_DAMPING, "\"1 N*m*s/rad\""),
    quantity(&ANGLE, "\"0 deg\""),
    quantity(&ANGULAR_VELOCITY, "\"0 rad/s\""),
    key(
        "mechanism.joints.*.controller.agonist",
        Kind::Name,
        "Name of the actuator that turns the joint towards greater angles.",
        "\"biceps\"",
    )
    .required(),
    key(
        "mechanism.joints.*.controller.antagonist",
        Kind::Name,
        "Name of the actuator that turns it back.",
        "\"triceps\"",
    )
    .required(),
    quantity(&BELT_DEPTH, "\"75 cm\"").required(),
    quantity(&BELT_VELOCITY, "\"0 m/s\"").required(),
    quantity(&BELT_STIFFNESS, "\"20 kN/m\"").required(),
    quantity(&BELT_DAMPING, "\"100 N*s/m\"").required(),
    quantity(&BELT_FRICTION, "0.8").required(),
    quantity(&SLIPPING_SPEED, "\"1 cm/s\"").required(),
];

/// What a path stands for: `*` in the place of names, and without the part that says whose it is.
pub(crate) fn stands_for(path: &str) -> String {
    let names: Vec<&str> = path.split('.').collect();
    let joined = |names: &[&str]| stands_for(&names.join("."));
    match names.as_slice() {
        [ACTUATORS, _] => "actuators.*".to_owned(),
        [ACTUATORS, _, "supply"] => "actuators.*.supply".to_owned(),
        [ACTUATORS, _, rest @ ..] if rest.first().is_some_and(|first| OF_ACTUATOR.contains(first)) => joined(rest),
        [ACTUATORS, _, rest @ ..] if !rest.is_empty() => format!("actuator.{}", rest.join(".")),
        [SUPPLIES, _] => "supplies.*".to_owned(),
        [SUPPLIES, _, "from"] => "supplies.*.from".to_owned(),
        [SUPPLIES, _, rest @ ..] if rest.first() == Some(&"inlet") => format!("supplies.*.{}", rest.join(".")),
        [SUPPLIES, _, rest @ ..] if rest.first().is_some_and(|first| OF_SUPPLY.contains(first)) => joined(rest),
        [SUPPLIES, _, rest @ ..] if !rest.is_empty() => format!("supply.{}", rest.join(".")),
        [MECHANISMS, _] => MECHANISM.to_owned(),
        [MECHANISMS, _, rest @ ..] if !rest.is_empty() => stands_for(&format!("{MECHANISM}.{}", rest.join("."))),
        [MECHANISM, "joints", _, CONTROLLER, key, rest @ ..] if !["agonist", "antagonist"].contains(key) => {
            [CONTROLLER, key].iter().chain(rest).copied().collect::<Vec<_>>().join(".")
        }
        [MECHANISM, "joints", _, rest @ ..] => {
            ["mechanism.joints.*"].into_iter().chain(rest.iter().copied()).collect::<Vec<_>>().join(".")
        }
        ["coupling", "arms", _, rest @ ..] => {
            ["coupling.arms.*"].into_iter().chain(rest.iter().copied()).collect::<Vec<_>>().join(".")
        }
        _ => path.to_owned(),
    }
}

/// What the path of a section stands for: an actuator's `supply` may be a name, or a section.
pub(crate) fn section_for(path: &str) -> String {
    match stands_for(path) {
        supply if supply == "actuators.*.supply" => "supply".to_owned(),
        other => other,
    }
}

/// Whether the entries of a section are named by the file.
pub(crate) fn names_its_entries(section: &str) -> bool {
    [ACTUATORS, SUPPLIES, MECHANISMS, "mechanism.joints", "coupling.arms"].contains(&section)
}

/// The keys and subsections that may stand in a section of a plant's file, by name.
pub(crate) fn names_in_plant(section: &str) -> Vec<&'static str> {
    let section = stands_for(section);
    let paths = PLANT_KEYS.iter().map(|key| key.path).chain(PLANT_SECTIONS.iter().map(|section| section.path));
    let mut names: Vec<&str> = super::names_in(&section).chain(super::names_among(paths, &section)).collect();
    match section.as_str() {
        "actuators.*" => {
            names.retain(|name| *name != "supply");
            names.extend(super::names_in("actuator"));
            names.extend(OF_ACTUATOR);
        }
        "mechanism.joints.*.controller" => names.extend(super::names_in(CONTROLLER)),
        "supplies.*" => {
            names.extend(super::names_in("supply"));
            names.extend(OF_SUPPLY);
        }
        _ => {}
    }
    names
}

/// Whether a key or section is of plants alone.
pub(crate) fn is_of_plant(path: &str) -> bool {
    PLANT_KEYS.iter().any(|key| key.path == path) || PLANT_SECTIONS.iter().any(|section| section.path == path)
}
