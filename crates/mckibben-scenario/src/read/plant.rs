//! Actuators and supplies of a plant.
//!
//! Each is read from the document as it stands for it. What feeds what is a tree: a supply is fed by at most one, and none by
//! itself.

use super::{body, conditions, drive, flow_path, line, mechanism};
use crate::choice::{CommandKind, InletKind, PressurePlace, ValveOutput};
use crate::diagnostic::{Class, Diagnostic, Diagnostics, Place};
use crate::document::{Document, Entry, Value};
use crate::keys::{self, ACTUATORS, CONTROLLER, SUPPLIES};
use crate::plant::parts::SUPPLY;
use crate::plant::{Frame, Inlet, Member, Mount, PlantScenario, Store};
use crate::reader::{Reader, Unread};
use crate::scenario::{Air, Command, Initial, InitialLength, Load, PressureSeries, Scenario, Supply};
use mckibben::parameter as p;
use std::collections::HashMap;

/// The flow path of an inlet.
static INLET: flow_path::Rows = flow_path::Rows {
    flow_area: &keys::INLET_FLOW_AREA,
    sonic_conductance: &keys::INLET_SONIC_CONDUCTANCE,
    critical_ratio: &keys::INLET_CRITICAL_RATIO,
    kv: &keys::INLET_KV,
    cv: &keys::INLET_CV,
    pressure_drop_ratio: &keys::INLET_DROP,
};

/// What was noted of an actuator, and the actuator, where it could be read.
type Read = (Vec<Diagnostic>, Option<Member>);

/// The document as it stands for one actuator.
struct ActuatorPart<'n> {
    name: &'n str,
    place: &'n Place,
    document: Document,
    /// The supply that its valve draws from; empty where that is the actuator's own.
    supply: Option<String>,
    /// Whether it has its own load, and spans no mechanism.
    has_load: bool,
}

impl Document {
    /// Reads the plant that the document describes.
    pub(crate) fn read_plant(&self) -> Result<PlantScenario, Diagnostics> {
        let mut reader = Reader::new(self);
        let r = &mut reader;
        let limit = &mckibben::limit::PLANT_ANTAGONIST;
        refuse(r, "antagonist", &limit.title().to_string(), limit.remedy);
        let actuators = self.named(ACTUATORS);
        if actuators.is_empty() {
            let because = "a plant has one actuator or more";
            r.note(
                Diagnostic::whole(Class::Missing, self.source().name(), format!("no actuator is named: {because}"))
                    .help("add a section such as `[actuators.flexor]`"),
            );
        }
        self.distinct_names(r);
        let air = body::air(r);
        let run = if r.has("run") {
            Some(conditions::run(r))
        } else {
            r.missing_section("run", None);
            None
        };
        let stores = self.read_stores(r, &air);
        let frames = mechanism::frames(self, r);
        let (Some(stores), Some(frames)) = (stores, frames) else { return Err(of_mistakes(reader)) };
        self.check_pairs(r, &frames);
        let mut unread = Unread::of(self);
        let parts = actuators.iter().map(|named| self.part(r, *named, (&stores, &frames), &mut unread));
        let parts: Vec<Option<ActuatorPart<'_>>> = parts.collect();
        let members = self.read_members(r, parts, &frames);
        mechanism::check_unread(r, self, &frames, &mut unread);
        r.check_unread(unread);
        let members: Option<Vec<Member>> = members.into_iter().collect();
        match (members, run) {
            (Some(members), Some(run)) if !r.has_mistakes() => {
                let mut members = members;
                // A controller that names its kind is taken whole, and leaves nothing of that of all.
                let is_driven = |member: &Member| {
                    matches!(member.alone.command, Some(Command::Controller(_)))
                        && !self.contains(&format!("{ACTUATORS}.{}.{CONTROLLER}.kind", member.name))
                };
                if let Some(place) = r.key_place(CONTROLLER).filter(|_| !members.iter().any(is_driven)) {
                    let title = "there is a [controller], but the command of no actuator refers to it";
                    let found = Diagnostic::at(Class::NotApplicable, place, title, "drives no valve");
                    return Err(found.help("set `command.kind` to `controllers`, or remove the section").into());
                }
                if let Some(found) = self.idle_setting(&members, &stores) {
                    return Err(found.into());
                }
                members.iter_mut().for_each(|member| member.alone.run = run);
                // Supplies that are an actuator's own stand behind the named ones.
                let mut stores = stores;
                for member in &mut members {
                    if member.supply.as_deref() == Some("") {
                        let name = format!("{}.supply", member.name);
                        if let Some(supply) = member.alone.supply {
                            let (name, from, inlet) = (name.clone(), None, None);
                            stores.push(Store { name, supply, from, inlet, valve: None, hose: None });
                        }
                        member.supply = Some(name);
                    }
                }
                Ok(PlantScenario { members, stores, frames, air, run })
            }
            _ => Err(of_mistakes(reader)),
        }
    }

    /// A value that a user has set of a supply in addition to the file, as by `--set`, and that changes nothing: no actuator and no
    /// supply draws from that one, and it has neither a volume nor a regulator.
    fn idle_setting(&self, members: &[Member], stores: &[Store]) -> Option<Diagnostic> {
        let is_idle = |(index, store): &(usize, &Store)| {
            let is_drawn_from = members.iter().any(|member| member.supply.as_ref() == Some(&store.name))
                || stores.iter().any(|of| of.from == Some(*index));
            !is_drawn_from && store.supply.reservoir.is_none() && store.supply.regulator.is_none()
        };
        let (section, entry) = stores.iter().enumerate().filter(is_idle).find_map(|(_, store)| {
            let section = if store.name == SUPPLY { SUPPLY.to_owned() } else { format!("{SUPPLIES}.{}", store.name) };
            let Value::Table(table) = &self.entry(&section)?.node.value else { return None };
            let set = table.0.iter().find(|entry| entry.key.source().is_setting())?;
            Some((section, set))
        })?;
        let named: Vec<String> = self
            .named(SUPPLIES)
            .iter()
            .map(|(name, _)| format!("{SUPPLIES}.{name}"))
            .filter(|of| *of != section)
            .collect();
        let own = members.iter().filter(|member| member.supply.as_deref() == Some(""));
        let own: Vec<String> = own.map(|member| format!("{ACTUATORS}.{}.{SUPPLY}", member.name)).collect();
        let sections = [named, own].concat().iter().map(|of| format!("[{of}]")).collect::<Vec<_>>();
        let help = match sections.as_slice() {
            [] => "leave it out: no actuator has a valve".to_owned(),
            sections => {
                format!("give `{}` in the file, in the section of a supply: {}", entry.name, sections.join(", "))
            }
        };
        let title = format!("`{section}.{}` is set, and no valve draws from [{section}]", entry.name);
        Some(Diagnostic::at(Class::NotApplicable, entry.key.clone(), title, "reaches nothing").help(help))
    }

    /// The actuators that controllers of joints name are there, each named once.
    fn check_pairs(&self, r: &mut Reader<'_>, frames: &[Frame]) {
        let known: Vec<&str> = self.named(ACTUATORS).into_iter().map(|(name, _)| name).collect();
        let mut taken: Vec<(&str, &Place)> = Vec::new();
        for of in frames.iter().flat_map(|frame| &frame.controllers) {
            for (name, place) in of.actuators.iter().zip(&of.places) {
                if !known.contains(&name.as_str()) {
                    r.no_such(place.clone(), name, "actuator", &known);
                } else if let Some((_, first)) = taken.iter().find(|(other, _)| other == name) {
                    let title = format!("two controllers drive the valve of `{name}`");
                    r.note(
                        Diagnostic::at(Class::Conflict, place.clone(), title, "second time")
                            .related(Some((*first).clone()), "first time")
                            .help("let one controller drive each valve"),
                    );
                }
                taken.push((name, place));
            }
        }
    }

    /// The command of an actuator in the document as it stands for it: that of its controller, or of the controller of its joint.
    fn settle_command(&self, r: &mut Reader<'_>, document: &mut Self, (name, place): (&str, &Place), frames: &[Frame]) {
        let own = |section: &str| format!("{ACTUATORS}.{name}.{section}");
        let mut joints = frames.iter().flat_map(|frame| &frame.controllers);
        let of_joint = joints.find(|of| of.actuators.iter().any(|of| of == name));
        let own_controller = r.key_place(&own(CONTROLLER));
        if let Some(of_joint) = of_joint {
            for section in [CONTROLLER, "command"] {
                let Some(place) = r.key_place(&own(section)) else { continue };
                let title = format!("`{name}` has its own {section}, and the controller of a joint drives its valve");
                r.note(
                    Diagnostic::at(Class::Conflict, place, title, "second way")
                        .related(Some(of_joint.place.clone()), "first way")
                        .help("keep one of the two"),
                );
            }
            document.remove(CONTROLLER);
            document.remove("command");
            if document.contains("valve") {
                document.put_word("command.kind", place, CommandKind::Exhaust.name());
            }
        } else if let Some(place) = own_controller {
            // It stands in the place of a command that is said of all.
            if !r.has(&own("command")) {
                document.remove("command");
                document.put_word("command.kind", &place, CommandKind::Controllers.name());
            }
        } else if !document.is_word("command.kind", CommandKind::Controllers.name()) {
            // What is said of all is of those whose command refers to it.
            document.remove(CONTROLLER);
        }
    }

    /// Columns carry names, so no two parts may share one.
    fn distinct_names(&self, r: &mut Reader<'_>) {
        let mut known: HashMap<&str, &Place> = self.place(SUPPLY).map(|place| (SUPPLY, place)).into_iter().collect();
        let mut sections = vec![ACTUATORS.to_owned(), SUPPLIES.to_owned(), keys::MECHANISMS.to_owned()];
        sections.push("mechanism.joints".to_owned());
        sections.extend(self.named(keys::MECHANISMS).iter().map(|(name, _)| format!("mechanisms.{name}.joints")));
        for (name, place) in sections.iter().flat_map(|section| self.named(section)) {
            if let Some(first) = known.insert(name, place) {
                let title = format!("two parts are called `{name}`, and columns are named by them");
                r.note(
                    Diagnostic::at(Class::Conflict, place.clone(), title, "second of that name")
                        .related(Some(first.clone()), "first of that name")
                        .help("give each actuator, supply, mechanism and joint a different name"),
                );
            }
        }
    }

    /// The supplies, each behind what feeds it; `None` when there is a mistake, which has been noted.
    fn read_stores(&self, r: &mut Reader<'_>, air: &Air) -> Option<Vec<Store>> {
        let mut named = self.named(SUPPLIES);
        if let Some(place) = self.place(SUPPLY) {
            named.insert(0, (SUPPLY, place));
        }
        let names: Vec<&str> = named.iter().map(|(name, _)| *name).collect();
        let mut from: Vec<Option<usize>> = Vec::new();
        let mut sound = true;
        for name in &names {
            let path = format!("{SUPPLIES}.{name}.from");
            let feeder = r.name(&path);
            let index = feeder.and_then(|feeder| names.iter().position(|name| *name == feeder));
            if let (Some(feeder), None, Some(place)) = (feeder, index, r.value_place(&path)) {
                r.no_such(place, feeder, "supply", &names);
                sound = false;
            }
            from.push(index);
        }
        // In the order of the air; the rest feeds itself.
        let mut order: Vec<usize> = Vec::new();
        while let Some(next) =
            (0..names.len()).find(|i| !order.contains(i) && from[*i].is_none_or(|feeder| order.contains(&feeder)))
        {
            order.push(next);
        }
        if let Some(left) = (0..names.len()).find(|i| !order.contains(i)) {
            if let Some(place) = r.value_place(&format!("{SUPPLIES}.{}.from", names[left])) {
                let title = format!("the supply `{}` feeds itself", names[left]);
                r.note(
                    Diagnostic::at(Class::Inconsistent, place, title, "leads round in a circle")
                        .help("let the first of them be fed by none, or by another"),
                );
            }
            return None;
        }
        let mut stores: Vec<Store> = Vec::new();
        for index in order.iter().copied() {
            let (name, place) = named[index];
            let feeder = from[index].and_then(|index| order.iter().position(|i| *i == index));
            let feeder = feeder.and_then(|feeder| Some((feeder, stores.get(feeder)?.supply)));
            match self.read_store(r, (name, place), feeder, air) {
                Some(store) => stores.push(store),
                None => return None,
            }
        }
        sound.then_some(stores)
    }

    fn read_store(
        &self,
        r: &mut Reader<'_>,
        (name, place): (&str, &Place),
        feeder: Option<(usize, Supply)>,
        air: &Air,
    ) -> Option<Store> {
        let mut document = self.of_supply(name);
        if let Some((_, feeder)) = feeder {
            // What is not said of it is as of what feeds it.
            for (row, value) in
                [(&p::SUPPLY_GAUGE_PRESSURE, feeder.gauge_pressure), (&p::SUPPLY_TEMPERATURE, feeder.temperature)]
            {
                if !document.contains(row.key) {
                    document.put_value(row.key, place, value, row.unit);
                }
            }
        }
        if let (Some(at), true) =
            (document.place("command.kind"), document.is_word("command.kind", CommandKind::Controllers.name()))
        {
            let title = format!("the valve of the supply `{name}` has a schedule, and no controller");
            r.note(
                Diagnostic::at(Class::NotApplicable, at.clone(), title, "does not apply")
                    .help("let a controller drive valves of actuators, or give the supply's valve a table"),
            );
            return None;
        }
        let mut part = Reader::of_part(&document, r);
        let of = &mut part;
        let (supply, valve, command) = drive::drive(of, air);
        refuse(of, p::ACTUATORS.key, "the actuators of a plant are those that the file names", "remove it");
        let hose = line::hose_of_any(of);
        let inlet = inlet(of);
        let passes = [("supplies.*.inlet", "an inlet"), ("valve", "a valve"), ("hose", "a hose")];
        let stored = supply.is_some_and(|supply| supply.reservoir.is_some());
        let regulated = supply.is_some_and(|supply| supply.regulator.is_some());
        for (path, what) in passes {
            if let Some(place) = of.key_place(path).filter(|_| feeder.is_none() || !stored) {
                let (title, help) = match feeder {
                    None => {
                        (format!("the supply `{name}` has {what} but nothing feeds it"), "name its feeder in `from`")
                    }
                    Some(_) => (
                        format!("the supply `{name}` has {what} and no volume that it leads to"),
                        "give `reservoir_volume`; a regulator alone is fed directly",
                    ),
                };
                of.note(Diagnostic::at(Class::NotApplicable, place, title, "leads nowhere").help(help));
            }
        }
        if let (Some(place), Some(second)) = (of.key_place("supplies.*.inlet"), of.key_place("valve")) {
            let title = format!("the supply `{name}` is fed through an inlet and through a valve");
            of.note(
                Diagnostic::at(Class::Conflict, second, title, "second way")
                    .related(Some(place), "first way")
                    .help("keep one of the two"),
            );
        }
        if feeder.is_some() {
            let has_way = inlet.is_some() || of.has("supplies.*.inlet") || of.has("valve");
            if !stored && !regulated {
                let title = format!("the supply `{name}` is neither reservoir nor regulator");
                of.note(Diagnostic::at(Class::Missing, place.clone(), title, "nothing that air could be in").help(
                    "add `reservoir_volume = \"50 cm^3\"` for a manifold or `lag = \"20 ms\"` for a regulator, or let \
                         the actuators draw from what feeds it",
                ));
            } else if stored && !has_way {
                let title = format!("nothing leads air into the supply `{name}`");
                of.note(
                    Diagnostic::at(Class::Missing, place.clone(), title, "an inlet is expected")
                        .help(format!("add for instance `inlet.flow_area = \"10 mm^2\"` to [supplies.{name}]")),
                );
            }
        }
        let valve = valve.zip(command);
        let named = |path: &str| {
            let own = path.strip_prefix("supplies.*.").or_else(|| path.strip_prefix("supply."));
            let own = own.or_else(|| Some(path).filter(|path| keys::OF_SUPPLY.iter().any(|of| path.starts_with(of))));
            own.filter(|_| name != SUPPLY).map(|own| format!("{SUPPLIES}.{name}.{own}"))
        };
        if !r.take(part, named) {
            return None;
        }
        let name = name.to_owned();
        Some(Store { name, supply: supply?, from: feeder.map(|(index, _)| index), inlet, valve, hose })
    }

    /// The document as it stands for an actuator; `None` when there is a mistake, which has been noted.
    fn part<'n>(
        &self,
        r: &mut Reader<'_>,
        (name, place): (&'n str, &'n Place),
        (stores, frames): (&[Store], &[Frame]),
        unread: &mut Unread<'_>,
    ) -> Option<ActuatorPart<'n>> {
        let own = |section: &str| format!("{ACTUATORS}.{name}.{section}");
        let mut document = self.of_actuator(name);
        let mut supply = None;
        let has_own =
            matches!(r.entry(&own(SUPPLY)).map(|entry| &entry.node.value), Some(value) if value.noun() == "a section");
        if has_own {
            // It has no name yet, which says that it is the actuator's own.
            supply = Some(String::new());
        } else if document.contains("valve") {
            let store = feeder(r, &own(SUPPLY), (name, place), stores)?;
            document.remove(SUPPLY);
            let at = r.value_place(&own(SUPPLY)).unwrap_or_else(|| place.clone());
            document.put_value(p::SUPPLY_GAUGE_PRESSURE.key, &at, store.supply.gauge_pressure, "Pa");
            document.put_value(p::SUPPLY_TEMPERATURE.key, &at, store.supply.temperature, "K");
            supply = Some(store.name.clone());
        } else {
            document.remove(SUPPLY);
            // What no valve obeys is said of the others. A pressure may be given at the end of a hose without a valve.
            let at_hose = document.is_word(keys::PRESSURE_AT, PressurePlace::Hose.name());
            let of_valve: &[&str] = if at_hose { &["command"] } else { &["command", "hose"] };
            for section in of_valve.iter().filter(|section| !r.has(&own(section))) {
                document.remove(section);
            }
        }
        self.settle_command(r, &mut document, (name, place), frames);
        // The whole plant has one atmosphere and one gas; each actuator its own process.
        for row in [&p::ATMOSPHERIC_PRESSURE, &p::GAS_CONSTANT, &p::HEAT_CAPACITY_RATIO] {
            let path = format!("{ACTUATORS}.{name}.{}", row.key);
            refuse(r, &path, "the gas and the atmosphere are those of the whole plant", "give it in [air]");
        }
        let has_load = r.has(&own("load")) || frames.is_empty();
        if has_load && !document.contains("load") {
            r.missing_section("load", None);
            return None;
        }
        if let (true, Some(place)) = (has_load, r.key_place(&own("coupling"))) {
            let title = format!("the actuator `{name}` has its own load and spans no mechanism");
            r.note(
                Diagnostic::at(Class::NotApplicable, place, title, "does not apply")
                    .help("remove it, or the load and name a mechanism in [mechanism]"),
            );
        }
        if has_load {
            document.remove("coupling");
        } else {
            document.remove("load");
        }
        unread.read_in(&document);
        Some(ActuatorPart { name, place, document, supply, has_load })
    }

    /// Reads the actuators. A value that the file states for all of them holds for those that can use it; it is a mistake if none
    /// of them can.
    fn read_members(
        &self,
        r: &mut Reader<'_>,
        mut parts: Vec<Option<ActuatorPart<'_>>>,
        frames: &[Frame],
    ) -> Vec<Option<Member>> {
        let read = |r: &Reader<'_>, part: &ActuatorPart<'_>| self.read_member(r, part, frames);
        let mut read_of: Vec<Option<Read>> = parts.iter().map(|part| part.as_ref().map(|part| read(r, part))).collect();
        let common = self.stated_for_all();
        let is_unused = |of: &Option<Read>, entry: &Entry| {
            let is_it = |found: &Diagnostic| {
                found.class() == Class::NotApplicable
                    && found.place().is_some_and(|place| entry.key.is(place) || entry.node.place.is(place))
            };
            of.as_ref().is_some_and(|(found, _)| found.iter().any(is_it))
        };
        for (path, entry) in common {
            let has_it = |part: &ActuatorPart<'_>| {
                part.document.entry(path.as_str()).is_some_and(|its| its.node.place.is(&entry.node.place))
            };
            let uses_it = |(part, of): (&Option<ActuatorPart<'_>>, &Option<Read>)| {
                part.as_ref().is_some_and(has_it) && !is_unused(of, entry)
            };
            if !parts.iter().zip(&read_of).any(uses_it) {
                continue;
            }
            for (part, of) in parts.iter_mut().zip(&mut read_of).filter(|(_, of)| is_unused(of, entry)) {
                let (Some(part), Some(of)) = (part.as_mut().filter(|part| has_it(part)), of) else { continue };
                let mut without = part.document.clone();
                without.remove(path.as_str());
                let whole = std::mem::replace(&mut part.document, without);
                let (found, member) = read(r, part);
                // What an actuator must have and cannot use is not missing there: it stays at fault.
                if found.iter().all(|found| of.0.contains(found)) {
                    *of = (found, member);
                } else {
                    part.document = whole;
                }
            }
        }
        let taken = parts.iter().zip(read_of).map(|(part, of)| {
            let (found, member) = of?;
            let name = part.as_ref()?.name;
            // What is the actuator's own has its name, and so has a choice by default in its own section; what is of all has not.
            let named = |path: &str| {
                let own = format!("{ACTUATORS}.{name}.{}", path.strip_prefix("actuator.").unwrap_or(path));
                let is_choice = keys::key_at(path).is_some_and(|key| matches!(key.kind, keys::Kind::Choice(_)));
                let in_own = || own.rsplit_once('.').is_some_and(|(section, _)| self.contains(section));
                let is_unsaid = || is_choice && !self.contains(path) && !path.starts_with("actuator.") && in_own();
                (self.contains(&own) || is_unsaid()).then_some(own)
            };
            if r.take_all(found, named) { member } else { None }
        });
        taken.collect()
    }

    /// The values that the file states for all actuators, each with its path.
    fn stated_for_all(&self) -> Vec<(String, &Entry)> {
        let mut unread = Unread::of(self).into_entries();
        let air = self.entry("air").map(|entry| &entry.node.value);
        if let Some(Value::Table(table)) = air {
            unread.extend(table.0.iter().map(|entry| (format!("air.{}", entry.name), entry)));
        }
        unread
    }

    /// Reads one actuator: what was noted, and the actuator, where it could be read.
    fn read_member(
        &self,
        r: &Reader<'_>,
        ActuatorPart { name, place, document, supply, has_load }: &ActuatorPart<'_>,
        frames: &[Frame],
    ) -> Read {
        let mut part = Reader::of_part(document, r);
        let of = &mut part;
        let member = self.member(of, (name, place), (document, supply.as_ref(), *has_load), frames);
        (part.into_mistakes(), member)
    }

    fn member(
        &self,
        of: &mut Reader<'_>,
        (name, place): (&str, &Place),
        (document, supply, has_load): (&Self, Option<&String>, bool),
        frames: &[Frame],
    ) -> Option<Member> {
        let own = |section: &str| format!("{ACTUATORS}.{name}.{section}");
        let actuator = body::actuator(of);
        let air = body::air(of);
        let (supplied, valve, command) = drive::drive(of, &air);
        let hose = line::hose(of);
        let pressure = conditions::pressure(of);
        let tendon = conditions::tendon(of);
        let output = match of.word("valve.output") {
            Some(ValveOutput::B) => 1,
            _ => 0,
        };
        if let Some(place) =
            of.key_place("valve.output").filter(|_| valve.is_some_and(|valve| !valve.kind.has_two_outputs()))
        {
            let title = "`valve.output` is for a five-way valve";
            of.note(Diagnostic::at(Class::NotApplicable, place, title, "does not apply").help("remove it"));
        }
        let (load, initial, mount);
        if has_load {
            load = conditions::load(of, &air);
            // What no actuator says is missing once, for all that share the load.
            let says_length = |of: &str| self.contains(&format!("{ACTUATORS}.{of}.{}", p::INITIAL_LENGTH.key));
            let shared = !self.contains(&own("load")) && !self.named(ACTUATORS).iter().any(|(of, _)| says_length(of));
            let owner = if shared { conditions::Owner::All } else { conditions::Owner::Named(name, place) };
            initial = conditions::initial(of, load.as_ref(), pressure.as_ref(), &air, owner);
            mount = Some(Mount::Own);
            if matches!(load, Some(Load::AntagonisticJoint(_)))
                && let Some(place) = of.value_place("load.kind")
            {
                let title = "an antagonistic joint is the load of two actuators";
                of.note(
                    Diagnostic::at(Class::NotApplicable, place, title, "not of one")
                        .help("write it as [mechanism] with kind = \"chain\" and one joint"),
                );
            }
        } else {
            // It stands in for the mechanism, which is not used here.
            load = Some(Load::Isometric);
            initial = on_mechanism(of, tendon.is_some(), pressure.as_ref(), &air);
            mount = mechanism::mount(of, document, name, place, frames);
        }
        let run = crate::scenario::Run {
            duration: 1.0,
            sample_interval: 1.0,
            engine: crate::choice::Engine::EventLocated,
            relative_tolerance: 1e-8,
            method: crate::choice::Method::Stable,
            step: None,
            accuracy: 1e-3,
        };
        let alone = Scenario {
            actuator,
            air,
            supply: supplied,
            valve,
            hose,
            command,
            pressure,
            tendon,
            load: load?,
            initial,
            run,
        };
        Some(Member { name: name.to_owned(), alone, supply: supply.cloned(), output, mount: mount? })
    }
}

/// The start of an actuator whose mechanism says how long it is.
fn on_mechanism(r: &mut Reader<'_>, has_tendon: bool, series: Option<&PressureSeries>, air: &Air) -> Initial {
    let path = p::INITIAL_LENGTH.key;
    for row in [&p::INITIAL_VELOCITY, &p::INITIAL_ANGLE, &p::INITIAL_ANGULAR_VELOCITY] {
        let help = "give it of the mechanism or its joints";
        refuse(r, row.key, "the start of the mechanism is said there", help);
    }
    let mut length = InitialLength::Equilibrium;
    if has_tendon && r.has(path) && !r.says(path, keys::EQUILIBRIUM.name) {
        let given = r.number_or(&p::INITIAL_LENGTH, keys::EQUILIBRIUM.name);
        length = given.map_or(InitialLength::Equilibrium, InitialLength::At);
    } else if !has_tendon {
        refuse(r, path, "without an elastic tendon the mechanism says how long the actuator is", "remove it");
    }
    let gauge_pressure = conditions::first_pressure(r, series, air);
    let (temperature, friction) = (r.value(&p::INITIAL_TEMPERATURE, None), conditions::friction_start(r));
    Initial { gauge_pressure, temperature, length, velocity: 0.0, friction }
}

/// The supply that an actuator's valve draws from.
fn feeder<'s>(r: &mut Reader<'_>, path: &str, (name, place): (&str, &Place), stores: &'s [Store]) -> Option<&'s Store> {
    let known: Vec<&str> = stores.iter().map(|store| store.name.as_str()).collect();
    let find = |name: &str| stores.iter().find(|store| store.name == name);
    if r.has(path) {
        let said = r.name(path)?;
        let found = find(said);
        if let (None, Some(place)) = (found, r.value_place(path)) {
            r.no_such(place, said, "supply", &known);
        }
        return found;
    }
    // The end of the line, where there is one line.
    let feeds = |index: usize| stores.iter().any(|store| store.from == Some(index));
    let mut ends = stores.iter().enumerate().filter(|(index, _)| !feeds(*index)).map(|(_, store)| store);
    let one = find(SUPPLY).or_else(|| ends.next().filter(|_| ends.next().is_none()));
    if one.is_none() {
        let title = format!("nothing says which supply feeds the valve of `{name}`");
        let help = match known.as_slice() {
            [] => "add a section [supply]".to_owned(),
            known => format!(
                "add `supply = \"{}\"` to [actuators.{name}]; known: {}",
                known[known.len() - 1],
                known.join(", ")
            ),
        };
        r.note(Diagnostic::at(Class::Missing, place.clone(), title, "draws from none").help(help));
    }
    one
}

fn inlet(r: &mut Reader<'_>) -> Option<Inlet> {
    let place = r.key_place("supplies.*.inlet")?;
    let kind: InletKind = r.word("supplies.*.inlet.kind").unwrap_or(InletKind::Open);
    let flow_path = flow_path::flow_path(r, &INLET, None);
    if flow_path.is_none() {
        let title = "the inlet does not say how much it lets through";
        r.note(Diagnostic::at(Class::Missing, place, title, "`flow_area` is expected here").help(
            "add for instance `flow_area = \"10 mm^2\"`; the other ways to state a valve's flow path would do as well",
        ));
    }
    let efficiency = r.value(&keys::INLET_EFFICIENCY, None);
    let laminar_ratio = r.value(&keys::INLET_LAMINAR_RATIO, None);
    Some(Inlet { one_way: kind == InletKind::Check, flow_path: flow_path?, efficiency, laminar_ratio })
}

/// Notes a key or section that has no place here.
fn refuse(r: &mut Reader<'_>, path: &str, title: &str, help: &str) {
    if let Some(place) = r.key_place(path) {
        r.note(Diagnostic::at(Class::NotApplicable, place, title, "does not apply").help(help));
    }
}

/// What was noted; at least one mistake.
fn of_mistakes(reader: Reader<'_>) -> Diagnostics {
    let name = reader.document().source().name().to_owned();
    match reader.finish() {
        Err(found) => found,
        // Not reached: a part that could not be read has been noted. Said rather than assumed.
        Ok(()) => Diagnostic::whole(Class::Missing, name, "the plant is incomplete").into(),
    }
}
