//! The mechanisms of a plant, and how actuators span them.

use super::conditions::{MotionRows, motion_of};
use super::{alternative, columns, controller};
use crate::choice::{LoadKind, MechanismKind};
use crate::diagnostic::{Class, Diagnostic, Place};
use crate::document::{Document, Entry, Value};
use crate::keys::{self, MECHANISM, MECHANISMS};
use crate::model::core_motion;
use crate::plant::{Frame, JointController, Mount};
use crate::quantity;
use crate::reader::{Reader, Unread, out_of_range};
use mckibben::mechanism::chain::MAX_JOINTS;
use mckibben::mechanism::{Belt, Chain, ChainSegment, JointStops, Mass, Mechanism, Pull, Revolute, Spring};
use mckibben::parameter::Parameter;

/// The section of moment arms, each under the name of its joint.
const ARMS: &str = "coupling.arms";

/// The keys of a motion.
static MOTION: MotionRows = MotionRows {
    length: &keys::MOTION_LENGTH,
    amplitude: &keys::MOTION_AMPLITUDE,
    frequency: &keys::MOTION_FREQUENCY,
    phase: &keys::MOTION_PHASE,
    time: &keys::MOTION_TIME,
    table_length: &keys::MOTION_TABLE_LENGTH,
};

/// Every mechanism that the file describes other than loads; `None` when there is a mistake, which has been noted.
pub(super) fn frames(document: &Document, r: &mut Reader<'_>) -> Option<Vec<Frame>> {
    let several = document.named(MECHANISMS);
    if let (Some(one), Some(others)) = (r.key_place(MECHANISM), r.key_place(MECHANISMS)) {
        let title = "there are both [mechanism] and [mechanisms]";
        r.note(
            Diagnostic::at(Class::Conflict, one, title, "one")
                .related(Some(others), "several")
                .help("give it a name: write `[mechanisms.arm]` in place of `[mechanism]`"),
        );
    }
    let one = document.place(MECHANISM).map(|place| (None, place));
    let names: Vec<(Option<&str>, &Place)> =
        one.into_iter().chain(several.into_iter().map(|(name, place)| (Some(name), place))).collect();
    if let (Some(load), Some((_, first))) = (r.key_place("load"), names.first()) {
        let title = "[load] and a mechanism both say what the actuators pull on";
        r.note(
            Diagnostic::at(Class::Conflict, load, title, "first way")
                .related(Some((*first).clone()), "second way")
                .help(
                    "keep one of the two; an actuator's own load stands in a section such as [actuators.flexor.load]",
                ),
        );
    }
    let read: Vec<Option<Frame>> = names.into_iter().map(|(name, place)| frame(document, r, name, place)).collect();
    read.into_iter().collect()
}

fn frame(document: &Document, r: &mut Reader<'_>, name: Option<&str>, place: &Place) -> Option<Frame> {
    let document = document.of_mechanism(name);
    let mut part = Reader::of_part(&document, r);
    let of = &mut part;
    let kind: Option<MechanismKind> = of.word("mechanism.kind");
    if !of.has("mechanism.kind") {
        of.missing("mechanism.kind", "");
    }
    for section in ["joints", "belt"] {
        let path = format!("mechanism.{section}");
        if let Some(place) = of.key_place(&path).filter(|_| kind.is_some_and(|kind| kind != MechanismKind::Chain)) {
            let title =
                format!("`{path}` is not used when `mechanism.kind` = \"{}\"", kind.map_or("", MechanismKind::name));
            of.note(
                Diagnostic::at(Class::NotApplicable, place, title, "does not apply")
                    .help("remove it, or set `mechanism.kind` to `chain`"),
            );
        }
    }
    let mut frame = Frame {
        name: name.unwrap_or(MECHANISM).to_owned(),
        mechanism: Mechanism::Fixed,
        motion: None,
        joints: Vec::new(),
        segments: Vec::new(),
        positions: vec![0.0],
        rates: vec![0.0],
        controllers: Vec::new(),
    };
    let mut built = Ok(());
    match kind {
        None => {}
        Some(MechanismKind::Mass) => {
            let mass = of.value(&keys::MASS, None);
            if let (Some(place), true) = (of.key_place(keys::PULL.key), of.has(keys::GRAVITY.key)) {
                let title = "a mass is pulled by gravity or by a constant force";
                of.note(
                    Diagnostic::at(Class::Conflict, place, title, "second way")
                        .related(of.key_place(keys::GRAVITY.key), "first way")
                        .help("keep one of the two"),
                );
            }
            let pull = match of.number(&keys::PULL) {
                Some(force) => Pull::Force(force),
                None => Pull::Gravity(of.value(&keys::GRAVITY, None)),
            };
            let pair = [keys::SPRING_STIFFNESS.key, keys::SPRING_REST_LENGTH.key];
            let spring = alternative(of, &[&pair]).map(|_| Spring {
                stiffness: of.noted(&keys::SPRING_STIFFNESS),
                rest_length: of.noted(&keys::SPRING_REST_LENGTH),
            });
            frame.positions = vec![of.value(&keys::POSITION, None)];
            frame.rates = vec![of.value(&keys::VELOCITY, None)];
            built = Mass::new(mass, pull, spring).map(|mass| frame.mechanism = Mechanism::Mass(mass));
        }
        Some(MechanismKind::Fixed) => frame.positions = vec![of.value(&keys::POSITION, None)],
        Some(MechanismKind::Prescribed) => {
            let motion = motion_of(of, &MOTION);
            if !of.has_mistakes() {
                built = core_motion(&motion, f64::MAX).map(|motion| frame.mechanism = Mechanism::Prescribed(motion));
            }
            frame.motion = Some(motion);
        }
        Some(MechanismKind::Chain) => built = chain(&document, of, &mut frame, place),
    }
    if let (Err(error), false) = (built, of.has_mistakes()) {
        let title = error.to_string();
        of.note(Diagnostic::at(Class::Inconsistent, place.clone(), title, "in this mechanism"));
    }
    let named = |path: &str| Some(format!("{MECHANISMS}.{}{}", name?, path.strip_prefix(MECHANISM)?));
    r.take(part, named).then_some(frame)
}

/// The controller of a joint and the two actuators whose valves it drives.
fn joint_controller(
    document: &Document,
    r: &mut Reader<'_>,
    (name, joint): (&str, usize),
    place: Place,
) -> Option<JointController> {
    let above = "mechanism.joints.*.controller";
    let actuators = ["agonist", "antagonist"].map(|of| {
        let path = format!("{above}.{of}");
        if !r.has(&path) {
            r.missing(&path, "");
        }
        Some((r.name(&path)?.to_owned(), r.value_place(&path)?))
    });
    let mut document = document.clone();
    let Entry { key, node, .. } = document.entry(above)?.clone();
    document.put(keys::CONTROLLER, &key, &node);
    document.put_word("load.kind", &place, LoadKind::AntagonisticJoint.name());
    let mut part = Reader::of_part(&document, r);
    let read = controller::controller(&mut part);
    let named = |path: &str| {
        let key = path.strip_prefix(keys::CONTROLLER)?;
        Some(format!("mechanism.joints.{name}.controller{key}"))
    };
    let sound = r.take(part, named);
    let [Some((agonist, first)), Some((antagonist, second))] = actuators else { return None };
    let controller = read.filter(|_| sound)?;
    Some(JointController { joint, actuators: [agonist, antagonist], places: [first, second], place, controller })
}

/// The joints and segments of a chain, in its order.
fn chain(document: &Document, r: &mut Reader<'_>, frame: &mut Frame, place: &Place) -> Result<(), mckibben::Error> {
    let named = document.named("mechanism.joints");
    if named.is_empty() {
        let title = "the chain has no joints";
        r.note(
            Diagnostic::at(Class::Missing, place.clone(), title, "joints are expected")
                .help("add a section such as `[mechanism.joints.elbow]` with `mass` and `distance`"),
        );
        return Ok(());
    }
    if let Some((_, first)) = named.get(MAX_JOINTS) {
        let title = format!("the chain `{}` has {} joints; a chain has at most eight joints", frame.name, named.len());
        r.note(
            Diagnostic::at(Class::BadList, (*first).clone(), title, "the ninth joint")
                .help("join segments that hardly bend, or divide the chain into several `[mechanisms.NAME]`"),
        );
        return Ok(());
    }
    let (mut segments, mut joints) = (Vec::new(), Vec::new());
    (frame.positions, frame.rates) = (Vec::new(), Vec::new());
    let order = order(r, &named);
    // Where the name of each segment is stated: its own, or that of its joint.
    let mut named_at: Vec<Place> = Vec::new();
    for (place, index) in order.iter().enumerate() {
        let (name, key) = named[*index];
        let path = format!("mechanism.joints.{name}.segment");
        let segment = r.name(&path).unwrap_or(name).to_owned();
        let at = r.value_place(&path).unwrap_or_else(|| key.clone());
        if let Some(first) = frame.segments.iter().position(|other| *other == segment) {
            let title = format!("two segments are called `{segment}`");
            let help = "give each a different name in `segment`; a segment without one has the name of its joint";
            r.note(
                Diagnostic::at(Class::Conflict, at.clone(), title, "second of that name")
                    .related(Some(named_at[first].clone()), "first of that name")
                    .help(help),
            );
        }
        named_at.push(at);
        let document = document.of_joint(name);
        let mut part = Reader::of_part(&document, r);
        let of = &mut part;
        let numbers = ChainSegment {
            length: of.value(&keys::SEGMENT_LENGTH, None),
            mass: of.value(&keys::SEGMENT_MASS, None),
            distance: of.value(&keys::SEGMENT_DISTANCE, None),
            inertia: of.value(&keys::SEGMENT_INERTIA, None),
        };
        if numbers.length == 0.0 && place + 1 < order.len() {
            let because = ": another joint is at the segment's end";
            match of.value_place(keys::SEGMENT_LENGTH.key) {
                Some(at) => of.note(out_of_range(at, &keys::SEGMENT_LENGTH, 0.0, "greater than 0 m")),
                None => of.missing(keys::SEGMENT_LENGTH.key, because),
            }
        }
        if place + 1 == order.len() && numbers.inertia + numbers.mass * numbers.distance * numbers.distance <= 0.0 {
            let title = format!("the last segment, `{segment}`, has no moment of inertia about its joint");
            of.note(
                Diagnostic::at(Class::Inconsistent, key.clone(), title, "nothing that could be slow")
                    .help("give it an inertia, or a distance from the joint"),
            );
        }
        let ends = [of.number(&keys::MIN_ANGLE), of.number(&keys::MAX_ANGLE)];
        if let ([Some(low), Some(high)], Some(at)) = (ends, of.value_place(keys::MIN_ANGLE.key))
            && low >= high
        {
            let other = of.value_place(keys::MAX_ANGLE.key);
            let written = other.as_ref().map(|place| place.text().trim_matches(['"', '\'']).to_owned());
            let bound = format!("less than `max_angle`, {}", written.unwrap_or_else(|| quantity::format(high, "rad")));
            of.note(out_of_range(at, &keys::MIN_ANGLE, low, &bound).related(other, "the greatest angle"));
        }
        joints.push(Revolute {
            torque: of.value(&keys::TORQUE, None),
            damping: of.value(&keys::DAMPING, None),
            stops: JointStops {
                ends,
                stiffness: of.value(&keys::STOP_STIFFNESS, None),
                damping: of.value(&keys::STOP_DAMPING, None),
            },
        });
        frame.positions.push(of.value(&keys::ANGLE, None));
        frame.rates.push(of.value(&keys::ANGULAR_VELOCITY, None));
        if let Some(place) = of.key_place("mechanism.joints.*.controller") {
            frame.controllers.extend(joint_controller(&document, of, (name, frame.joints.len()), place));
        }
        frame.joints.push(name.to_owned());
        frame.segments.push(segment);
        segments.push(numbers);
        r.take(part, |path| path.strip_prefix("mechanism.joints.*").map(|key| format!("mechanism.joints.{name}{key}")));
    }
    let belt = r.has("mechanism.belt").then(|| Belt {
        depth: r.value(&keys::BELT_DEPTH, None),
        velocity: r.value(&keys::BELT_VELOCITY, None),
        stiffness: r.value(&keys::BELT_STIFFNESS, None),
        damping: r.value(&keys::BELT_DAMPING, None),
        friction: r.value(&keys::BELT_FRICTION, None),
        slipping_speed: r.value(&keys::SLIPPING_SPEED, None),
    });
    let base = [r.value(&keys::GRAVITY, None), r.value(&keys::HANGING_ANGLE, None)];
    if r.has_mistakes() {
        return Ok(());
    }
    Chain::new(segments, joints, base, belt).map(|chain| frame.mechanism = Mechanism::Chain(chain))
}

/// The order of joints from the fixed axis on: each behind the one that it names, else behind the one above it in the file.
fn order(r: &mut Reader<'_>, named: &[(&str, &Place)]) -> Vec<usize> {
    let names: Vec<&str> = named.iter().map(|(name, _)| *name).collect();
    let mut said: Vec<Option<usize>> = Vec::new();
    for name in &names {
        let path = format!("mechanism.joints.{name}.after");
        said.push(index_of(r, &path, "joint", &names));
    }
    // A joint that says nothing is behind the one above it in the file, unless that is behind it.
    let mut before = said.clone();
    for index in 1..names.len() {
        let mut at = index - 1;
        let leads_back = said[index].is_some()
            || names.iter().any(|_| match before[at] {
                Some(next) => {
                    at = next;
                    at == index
                }
                None => false,
            });
        if !leads_back {
            before[index] = Some(index - 1);
        }
    }
    let mut order: Vec<usize> = before.iter().position(Option::is_none).into_iter().collect();
    while let Some(next) = order.last().and_then(|last| before.iter().position(|before| *before == Some(*last))) {
        if order.contains(&next) {
            break;
        }
        order.push(next);
    }
    if order.len() < names.len() && !r.has_mistakes() {
        let left = (0..names.len()).find(|index| !order.contains(index)).unwrap_or(0);
        let title =
            format!("the joint `{}` is not in the chain: two joints are behind the same, or in a circle", names[left]);
        r.note(Diagnostic::at(Class::Inconsistent, named[left].1.clone(), title, "a chain does not branch").help(
            "name in `after` the one joint before each; a joint without it is behind the one above it in the file",
        ));
    }
    order
}

/// How an actuator is mounted on a mechanism; `None` when there is a mistake, which has been noted.
pub(super) fn mount(
    r: &mut Reader<'_>,
    document: &Document,
    actuator: &str,
    place: &Place,
    frames: &[Frame],
) -> Option<Mount> {
    let names: Vec<&str> = frames.iter().map(|frame| frame.name.as_str()).collect();
    let path = "coupling.mechanism";
    let mechanism = match frames {
        _ if r.has(path) => index_of(r, path, "mechanism", &names)?,
        [_] => 0,
        _ => {
            let title = format!("nothing says which mechanism `{actuator}` pulls on");
            let help = format!("add `coupling.mechanism = \"{}\"`; known: {}", names[0], names.join(", "));
            r.note(Diagnostic::at(Class::Missing, place.clone(), title, "on which?").help(help));
            return None;
        }
    };
    let frame = &frames[mechanism];
    let ways = [ARMS, "coupling.origin", "coupling.insertion"];
    if !matches!(frame.mechanism, Mechanism::Chain(_)) {
        for path in ways.into_iter().chain([keys::REST_LENGTH.key]) {
            if let Some(place) = r.key_place(path) {
                let title =
                    format!("`{path}` is for a chain: `{}` has one distance, which is the actuator's", frame.name);
                r.note(Diagnostic::at(Class::NotApplicable, place, title, "does not apply").help("remove it"));
            }
        }
        return Some(Mount::Direct { mechanism });
    }
    match alternative(r, &[&ways[..1], &ways[1..]]) {
        None => {
            let title = format!("nothing says how `{actuator}` spans `{}`", frame.name);
            let help = format!(
                "add a section `[actuators.{actuator}.coupling]` with `rest_length` and for instance \
                                `arms.{} = \"15 mm\"`, or with `origin` and `insertion`",
                frame.joints[0]
            );
            r.note(Diagnostic::at(Class::Missing, place.clone(), title, "a coupling is expected").help(help));
            None
        }
        Some(0) => arms(r, document, mechanism, frame),
        Some(_) => points(r, mechanism, frame),
    }
}

fn arms(r: &mut Reader<'_>, document: &Document, mechanism: usize, frame: &Frame) -> Option<Mount> {
    let joints: Vec<&str> = frame.joints.iter().map(String::as_str).collect();
    let rest_length = match r.has(keys::REST_LENGTH.key) {
        true => r.noted(&keys::REST_LENGTH),
        false => {
            r.missing(keys::REST_LENGTH.key, ", which moment arms need");
            1.0
        }
    };
    let arms = document.named(ARMS).into_iter().filter_map(|named| arm(r, document, named, &joints)).collect();
    (!r.has_mistakes()).then_some(Mount::Arms { mechanism, rest_length, arms })
}

/// A moment arm, with the index of its joint; `None` when there is a mistake, which has been noted.
fn arm(
    r: &mut Reader<'_>,
    document: &Document,
    (name, key): (&str, &Place),
    joints: &[&str],
) -> Option<(usize, Vec<f64>, Vec<f64>)> {
    let Some(joint) = joints.iter().position(|joint| *joint == name) else {
        r.no_such(key.clone(), name, "joint", joints);
        return None;
    };
    let document = document.of_arm(name);
    let mut part = Reader::of_part(&document, r);
    let of = &mut part;
    let is_table = matches!(of.entry("coupling.arms.*").map(|entry| &entry.node.value), Some(Value::Table(_)));
    let (angle, arm) = if is_table { table(of) } else { (Vec::new(), of.number(&keys::ARM).into_iter().collect()) };
    let signs = arm.iter().filter(|arm| **arm > 0.0).count();
    if (signs != 0 && signs != arm.len()) || arm.contains(&0.0) {
        let row: &Parameter = if is_table { &keys::ARM_TABLE } else { &keys::ARM };
        if let Some(place) = of.value_place(row.key) {
            let title = "a moment arm is above zero, or below it, at all angles".to_owned();
            let help = "leave out a joint that the actuator does not span; the sign says which way it turns the joint";
            let label = "must not be zero nor change its sign";
            of.note(Diagnostic::at(Class::OutOfRange, place, title, label).help(help));
        }
    }
    let sound = r.take(part, |path| path.strip_prefix("coupling.arms.*").map(|key| format!("{ARMS}.{name}{key}")));
    sound.then_some((joint, angle, arm))
}

/// Notes what is wrong with moment arms and names that are stated for all actuators and that each replaces: a name may be that of
/// any mechanism, joint or segment of the file.
pub(super) fn check_unread(r: &mut Reader<'_>, document: &Document, frames: &[Frame], unread: &mut Unread<'_>) {
    // Without a mechanism there is nothing that a name could lead to; values alone are checked.
    if frames.is_empty() {
        return;
    }
    let joints: Vec<&str> = frames.iter().flat_map(|frame| &frame.joints).map(String::as_str).collect();
    for named in document.named(ARMS) {
        if unread.take_out(&format!("{ARMS}.{}", named.0)) {
            arm(r, document, named, &joints);
        }
    }
    let mechanisms: Vec<&str> = frames.iter().map(|frame| frame.name.as_str()).collect();
    let segments: Vec<&str> = frames.iter().flat_map(|frame| &frame.segments).map(String::as_str).collect();
    let ends = ["coupling.origin.segment", "coupling.insertion.segment"].map(|path| (path, "segment", &segments));
    for (path, what, known) in [("coupling.mechanism", "mechanism", &mechanisms)].into_iter().chain(ends) {
        if unread.take_out(path) {
            index_of(r, path, what, known);
        }
    }
}

/// Which part a key names, of those that the file has; `None` when it is absent or there is a mistake, which has been noted.
fn index_of(r: &mut Reader<'_>, path: &str, what: &str, known: &[&str]) -> Option<usize> {
    let said = r.name(path)?;
    let found = known.iter().position(|name| *name == said);
    if let (None, Some(place)) = (found, r.value_place(path)) {
        r.no_such(place, said, what, known);
    }
    found
}

fn table(r: &mut Reader<'_>) -> (Vec<f64>, Vec<f64>) {
    for row in [&keys::ARM_ANGLE, &keys::ARM_TABLE] {
        if !r.has(row.key) {
            r.missing(row.key, "");
        }
    }
    let (angle, arm) = (r.list(&keys::ARM_ANGLE), r.list(&keys::ARM_TABLE));
    columns(r, &keys::ARM_ANGLE, angle, keys::ARM_TABLE.key, arm)
}

fn points(r: &mut Reader<'_>, mechanism: usize, frame: &Frame) -> Option<Mount> {
    if let Some(place) = r.key_place(keys::REST_LENGTH.key) {
        let title = "`coupling.rest_length` is not used between two points, which say how far apart they are";
        r.note(Diagnostic::at(Class::NotApplicable, place, title, "does not apply").help("remove it"));
    }
    let segments: Vec<&str> = frame.segments.iter().map(String::as_str).collect();
    let mut ends = [(None, [0.0; 2]); 2];
    for ((section, rows), end) in ["origin", "insertion"].into_iter().zip(&keys::PLACES).zip(&mut ends) {
        let path = format!("coupling.{section}.segment");
        end.0 = index_of(r, &path, "segment", &segments);
        end.1 = [r.value(&rows[0], None), r.value(&rows[1], None)];
    }
    if ends[0].0 == ends[1].0
        && !r.has_mistakes()
        && let Some(place) = r.key_place("coupling.insertion")
    {
        let title = "the actuator begins and ends on the same segment, so nothing that moves changes its length";
        r.note(
            Diagnostic::at(Class::Inconsistent, place, title, "on the same segment")
                .related(r.key_place("coupling.origin"), "begins here")
                .help("name two segments, or one and leave `segment` out for the ground"),
        );
    }
    Some(Mount::Points { mechanism, ends })
}
