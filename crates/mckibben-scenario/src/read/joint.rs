//! An antagonistic joint: the load of two actuators, and the second of them.
//!
//! The second actuator is read from the same document with the keys of `[antagonist]` laid over its own, so whatever is not
//! said of it is as of the first; of the supply, both draw from one unless `[antagonist.supply]` describes another. What is said in several keys is taken whole: an effectiveness; a valve or command that
//! names its `kind` or `preset`; how much a valve's flow path lets through; an actuator that names its `preset`; a
//! force that names its `law`, a bladder its `form`; a braid that is described at rest in place of one described
//! otherwise; a moment arm, by radius or by table. A table holds as it stands: it is not mirrored.

use super::{alternative, body, columns, conditions, drive, flow_path, line};
use crate::choice::PressurePlace;
use crate::diagnostic::Place;
use crate::document::{Document, Entry, Node, Table, Value};
use crate::keys::{self, ANTAGONIST, BALANCED, FRICTION_START};
use crate::muscle::{self, AT_REST, BRAID};
use crate::presets;
use crate::reader::Reader;
use crate::scenario::{Air, Antagonist, InitialAngle, Joint, MomentArm, Tendon};
use mckibben::parameter::{self as p, Parameter};
use mckibben::plant::INITIAL_FRICTION_FORCE;

pub(super) fn joint(r: &mut Reader<'_>, air: &Air) -> Option<Joint> {
    let angle_path = p::INITIAL_ANGLE.key;
    let balanced = !r.has(angle_path) || r.says(angle_path, BALANCED.name);
    let angle = if balanced { None } else { r.number_or(&p::INITIAL_ANGLE, BALANCED.name) };
    let joint = Joint {
        mass: r.value(&p::MASS, None),
        gravity: r.value(&p::GRAVITY, None),
        distance: r.value(&p::LIMB_DISTANCE, None),
        inertia: r.value(&p::LIMB_INERTIA, None),
        hanging_angle: r.value(&p::HANGING_ANGLE, None),
        torque: r.value(&p::JOINT_TORQUE, None),
        damping: r.value(&p::JOINT_DAMPING, None),
        min_angle: r.number(&p::MIN_ANGLE),
        max_angle: r.number(&p::MAX_ANGLE),
        stop_stiffness: r.value(&p::STOP_STIFFNESS, None),
        stop_damping: r.value(&p::STOP_DAMPING, None),
        tendon: tendon(r),
        angle: angle.map_or(InitialAngle::Equilibrium, InitialAngle::At),
        angular_velocity: r.value(&p::INITIAL_ANGULAR_VELOCITY, None),
        antagonist: Box::new(antagonist(r, air)?),
    };
    Some(joint)
}

/// The keys of a moment arm: a radius, or a table.
const ARM: [&str; 3] = [p::PULLEY_RADIUS.key, p::MOMENT_ARM_ANGLE.key, p::MOMENT_ARM.key];

fn tendon(r: &mut Reader<'_>) -> Tendon {
    Tendon { arm: arm(r), rest_length: r.value(&p::REST_LENGTH, None) }
}

fn arm(r: &mut Reader<'_>) -> MomentArm {
    if alternative(r, &[&ARM[..1], &ARM[1..]]) == Some(1) {
        let angle = r.list(&p::MOMENT_ARM_ANGLE);
        let arm = r.list(&p::MOMENT_ARM);
        let (angle, arm) = columns(r, &p::MOMENT_ARM_ANGLE, angle, p::MOMENT_ARM.key, arm);
        return MomentArm::Table { angle, arm };
    }
    if !r.has(ARM[0]) {
        r.missing(ARM[0], "; `moment_arm_angle` and `moment_arm` would do as well");
    }
    MomentArm::Pulley(r.noted(&p::PULLEY_RADIUS))
}

/// The second actuator; `None` when there is a mistake in what is said of it, which has been noted.
fn antagonist(r: &mut Reader<'_>, air: &Air) -> Option<Antagonist> {
    let document = r.document().antagonist();
    let mut reader = Reader::new(&document);
    let of = &mut reader;
    let actuator = body::actuator(of);
    let (supply, valve, command) = drive::drive(of, air);
    let has_own_supply = r.document().place(&format!("{ANTAGONIST}.supply")).is_some();
    let (hose, pressure, series_tendon) = (line::hose(of), conditions::pressure(of), conditions::tendon(of));
    let tendon = tendon(of);
    let gauge_pressure = conditions::first_pressure(of, pressure.as_ref(), air);
    let temperature = of.value(&p::INITIAL_TEMPERATURE, None);
    match reader.finish() {
        Ok(()) => Some(Antagonist {
            actuator,
            supply,
            valve,
            has_own_supply,
            hose,
            command,
            pressure,
            tendon,
            series_tendon,
            gauge_pressure,
            temperature,
        }),
        Err(found) => {
            found.iter().for_each(|diagnostic| r.note(diagnostic.clone()));
            None
        }
    }
}

/// Whether a section says of a given pressure that it stands at the end of the hose.
fn stands_at_hose(section: &Entry) -> bool {
    let Value::Table(table) = &section.node.value else { return false };
    let at = table.get("at").map(|entry| &entry.node.value);
    matches!(at, Some(Value::String(word)) if word == PressurePlace::Hose.name())
}

impl Document {
    /// The document as it stands for the second actuator of a joint: the keys of `[antagonist]` in place of its own.
    pub(crate) fn antagonist(&self) -> Self {
        let mut document = self.clone();
        document.remove(ANTAGONIST);
        if let Some(Entry { key, node, .. }) = self.entry(ANTAGONIST)
            && let Value::Table(table) = &node.value
        {
            document.make_way(table);
            document.lay_over(table, "");
            document.name_default_preset(self, key);
        }
        document
    }

    /// Before the keys of an actuator are laid over those of all: what gives the pressure stands in the place of a valve, and
    /// the other way round.
    pub(crate) fn make_way(&mut self, table: &Table) {
        let instead: &[&str] = match (table.get("pressure"), table.get("valve")) {
            (Some(given), None) if stands_at_hose(given) => &["valve", "command", "supply"],
            (Some(_), None) => &["valve", "command", "hose", "supply", p::INITIAL_GAUGE_PRESSURE.key],
            (None, Some(_)) => &["pressure"],
            _ => &[],
        };
        for path in instead {
            self.remove(path);
        }
    }

    /// Where the actuator of the whole file is the default preset for want of a word, one with its own keys is that
    /// preset with its own keys. `place` is where those are.
    pub(crate) fn name_default_preset(&mut self, whole: &Self, place: &Place) {
        let unnamed = !whole.contains("actuator.preset") && !body::describes_braid(|path| whole.contains(path));
        if let Some(preset) = presets::ACTUATORS.first().filter(|_| unnamed && !self.contains("actuator.preset")) {
            let value = Value::String(preset.name.to_owned());
            self.put("actuator.preset", place, &Node { place: place.clone(), value });
        }
    }

    /// Lays the keys of a table over those of a section (`""` for the file itself).
    pub(crate) fn lay_over(&mut self, table: &Table, section: &str) {
        let whole = match section {
            "actuator.effectiveness" | "valve.exhaust" => true,
            "controller" => table.get("kind").is_some(),
            "valve" | "command" => table.get("kind").is_some() || table.get("preset").is_some(),
            "actuator" => table.get("preset").is_some(),
            "actuator.force" => table.get("law").is_some(),
            "actuator.bladder" => table.get("form").is_some(),
            "coupling.arms" => true,
            "load" => table.get("kind").is_some(),
            _ => false,
        };
        let names_arm = ARM.iter().filter_map(|path| path.strip_prefix("load.")).any(|name| table.get(name).is_some());
        if whole {
            self.remove(section);
        } else if section == "actuator" && self.gives_way_to(table) {
            for row in BRAID.into_iter().chain([&p::MAX_LENGTH, &p::MIN_LENGTH]) {
                self.remove(row.key);
            }
        } else if section == "load" && names_arm {
            for path in ARM {
                self.remove(path);
            }
        } else if section == "initial" && (table.get("friction").is_some() || table.get("friction_force").is_some()) {
            for path in [FRICTION_START, INITIAL_FRICTION_FORCE.key] {
                self.remove(path);
            }
        } else if section == "coupling" && table.get("arms").is_some() {
            for path in ["coupling.origin", "coupling.insertion"] {
                self.remove(path);
            }
        } else if section == "coupling" && (table.get("origin").is_some() || table.get("insertion").is_some()) {
            for path in ["coupling.arms", "coupling.rest_length"] {
                self.remove(path);
            }
        } else if section == "valve" && states_flow_path(table) {
            self.remove("valve.exhaust");
            for row in flow_path::SUPPLY.ways().iter().flatten() {
                self.remove(row.key);
            }
        }
        for Entry { name, key, node } in &table.0 {
            let path = if section.is_empty() { name.clone() } else { format!("{section}.{name}") };
            match &node.value {
                Value::Table(inner) if keys::section_at(&path).is_some() => self.lay_over(inner, &path),
                _ => self.put(&path, key, node),
            }
        }
    }
}

impl Document {
    /// Whether the braid of the document makes way for that of a table: of the two one at least is described at rest, and the
    /// table's is whole. Otherwise it is laid over key by key.
    fn gives_way_to(&self, actuator: &Table) -> bool {
        let own = |row: &Parameter| row.key.rsplit('.').next().is_some_and(|name| actuator.get(name).is_some());
        let at_rest = AT_REST.iter().any(|row| own(row) || self.contains(row.key));
        at_rest && muscle::determine(own)
    }
}

/// Whether a section `[valve]` says how much the valve lets through.
fn states_flow_path(valve: &Table) -> bool {
    flow_path::SUPPLY.begun(|row| row.key.rsplit('.').next().is_some_and(|name| valve.get(name).is_some()))
}
