//! The prescribed pressure, the tendon, the load, the initial state and the duration of a run.
//!
//! An isometric load takes its length from `initial.length`, which must then be a length; a prescribed motion says its
//! own length and velocity at the start, so neither may be given.

use super::{alternative, columns, gauge_pressure, joint};
use crate::choice::{Engine, FrictionStart, LoadKind, Method, PressurePlace};
use crate::diagnostic::{Class, Diagnostic, Place};
use crate::keys::{self, EQUILIBRIUM};
use crate::quantity;
use crate::reader::{Reader, out_of_range};
use crate::scenario::{Air, Initial, InitialLength, Load, Motion, PressureSensor, PressureSeries, Run, SeriesTendon};
use mckibben::parameter::{self as p, Parameter};
use mckibben::plant::{INITIAL_FRICTION_FORCE, InitialFriction};

/// The pressure over time, if the file gives it: then there is no valve, and the start follows.
pub(super) fn pressure(r: &mut Reader<'_>) -> Option<PressureSeries> {
    let section = r.key_place("pressure")?;
    for path in [p::SERIES_TIME.key, p::SERIES_GAUGE_PRESSURE.key] {
        if !r.has(path) {
            r.missing(path, "");
        }
    }
    let at = r.word(keys::PRESSURE_AT).unwrap_or(PressurePlace::Muscle);
    let in_muscle = at == PressurePlace::Muscle;
    for (path, help, is_out) in [
        ("valve", "remove `[valve]`, `[supply]` and `[command]`, or `[pressure]`", true),
        (
            "hose",
            "remove `[hose]`, or set `pressure.at = \"hose\"` if the pressure is that at the valve's end of the hose",
            in_muscle,
        ),
        (p::INITIAL_GAUGE_PRESSURE.key, "remove it: the run starts at the pressure of the first row", in_muscle),
    ] {
        if let Some(place) = r.key_place(path).filter(|_| is_out) {
            let title = match path {
                "hose" => "`hose` is not used where `[pressure]` gives the pressure in the muscle".to_owned(),
                _ => format!("`{path}` is not used where `[pressure]` gives the pressure over time"),
            };
            r.note(
                Diagnostic::at(Class::NotApplicable, place, title, "does not apply")
                    .related(Some(section.clone()), "given here")
                    .help(help),
            );
        }
    }
    if !in_muscle && !r.has("hose") {
        let place = r.value_place(keys::PRESSURE_AT).unwrap_or(section);
        r.note(
            Diagnostic::at(
                Class::Missing,
                place,
                "there is no hose at whose end the pressure could be",
                "needs [hose]",
            )
            .help("add a section `[hose]`, or set `pressure.at = \"muscle\"`"),
        );
    }
    let (time, gauges) = (r.list(&p::SERIES_TIME), r.list(&p::SERIES_GAUGE_PRESSURE));
    let (time, gauge_pressure) = columns(r, &p::SERIES_TIME, time, p::SERIES_GAUGE_PRESSURE.key, gauges);
    let [offset, scale, shift] = [&p::SERIES_OFFSET, &p::SERIES_SCALE, &p::SERIES_SHIFT].map(|row| r.value(row, None));
    Some(PressureSeries { at, time, gauge_pressure, sensor: PressureSensor { offset, scale, shift } })
}

/// The gauge pressure that the air in an actuator starts at: with a given pressure what the file says, which it does not have
/// to.
pub(super) fn first_pressure(r: &mut Reader<'_>, given: Option<&PressureSeries>, air: &Air) -> Option<f64> {
    let follows = given.is_some() && !r.has(p::INITIAL_GAUGE_PRESSURE.key);
    (!follows).then(|| gauge_pressure(r, &p::INITIAL_GAUGE_PRESSURE, air))
}

/// The tendon in series, if the file has one.
pub(super) fn tendon(r: &mut Reader<'_>) -> Option<SeriesTendon> {
    r.key_place("tendon")?;
    let [stiffness, rest_length] = [&p::TENDON_STIFFNESS, &p::TENDON_REST_LENGTH].map(|row| r.value(row, None));
    Some(SeriesTendon { stiffness, rest_length })
}

pub(super) fn load(r: &mut Reader<'_>, air: &Air) -> Option<Load> {
    let kind: Option<LoadKind> = r.word("load.kind");
    if !r.has("load.kind") {
        r.missing("load.kind", "");
    }
    Some(match kind? {
        LoadKind::HangingMass => {
            Load::HangingMass { mass: r.value(&p::MASS, None), gravity: r.value(&p::GRAVITY, None) }
        }
        LoadKind::ConstantForce => {
            Load::ConstantForce { force: r.value(&p::LOAD_FORCE, None), mass: r.value(&p::MASS, None) }
        }
        LoadKind::Isometric => Load::Isometric,
        LoadKind::PrescribedMotion => Load::PrescribedMotion(motion(r)),
        LoadKind::AntagonisticJoint => Load::AntagonisticJoint(joint::joint(r, air)?),
    })
}

fn motion(r: &mut Reader<'_>) -> Motion {
    motion_of(r, &OF_LOAD)
}

/// The rows that state a motion.
pub(super) struct MotionRows {
    pub(super) length: &'static Parameter,
    pub(super) amplitude: &'static Parameter,
    pub(super) frequency: &'static Parameter,
    pub(super) phase: &'static Parameter,
    pub(super) time: &'static Parameter,
    pub(super) table_length: &'static Parameter,
}

/// Of a load.
static OF_LOAD: MotionRows = MotionRows {
    length: &p::MOTION_LENGTH,
    amplitude: &p::MOTION_AMPLITUDE,
    frequency: &p::MOTION_FREQUENCY,
    phase: &p::MOTION_PHASE,
    time: &p::MOTION_TIME,
    table_length: &p::MOTION_TABLE_LENGTH,
};

/// A motion, of a load or of a mechanism.
pub(super) fn motion_of(r: &mut Reader<'_>, rows: &MotionRows) -> Motion {
    let wave = [rows.length, rows.amplitude, rows.frequency, rows.phase].map(|row| row.key);
    let table = [rows.time.key, rows.table_length.key];
    // The phase has a default, so the alternative is recognised by the other three and completed by `value`.
    let wave_keys = if wave[..3].iter().any(|path| r.has(path)) { &wave[..3] } else { &wave[..] };
    if alternative(r, &[wave_keys, &table]) == Some(1) {
        let time = r.list(rows.time);
        let length = r.list(rows.table_length);
        let (time, length) = columns(r, rows.time, time, rows.table_length.key, length);
        return Motion::Table { time, length };
    }
    let missing = wave[..3].iter().all(|path| !r.has(path)) && !r.has(wave[3]);
    if missing {
        r.missing(wave[0], ", with `amplitude` and `frequency`; `time` and `table_length` would do as well");
        return Motion::Table { time: Vec::new(), length: Vec::new() };
    }
    let [length, amplitude, frequency] = [rows.length, rows.amplitude, rows.frequency].map(|row| r.noted(row));
    let phase = r.value(rows.phase, None);
    let both = r.has(wave[0]) && r.has(wave[1]);
    if let Some(place) = r.value_place(wave[1]).filter(|_| both && amplitude >= length) {
        let mean = r.value_place(wave[0]);
        let bound = format!("less than {}, the mean length", quantity::format(length, "m"));
        r.note(out_of_range(place, rows.amplitude, amplitude, &bound).related(mean, "mean length"));
    }
    Motion::Sinusoid { length, amplitude, frequency, phase }
}

/// Whose start is read, for messages about what is missing.
#[derive(Clone, Copy)]
pub(super) enum Owner<'p> {
    /// The actuator of a file that names none.
    Single,
    /// Each actuator of a plant.
    All,
    /// The actuator of this name of a plant, and the place of its section.
    Named(&'p str, &'p Place),
}

/// Notes that an isometric load has no length to hold.
fn no_length(r: &mut Reader<'_>, owner: Owner<'_>) {
    let path = p::INITIAL_LENGTH.key;
    if r.is_meant(path) {
        return;
    }
    let chosen = r.value_place("load.kind");
    let section = match owner {
        Owner::Single | Owner::All => r.key_place("initial"),
        Owner::Named(_, place) => Some(place.clone()),
    };
    let (place, related) = match (section, chosen) {
        (Some(section), chosen) => (section, chosen),
        (None, Some(chosen)) => (chosen, None),
        (None, None) => return r.missing(path, ""),
    };
    let is_section = related.is_some();
    let (path, remedy) = match owner {
        Owner::Single => (path.to_owned(), "as in `length = \"3.5 in\"` in [initial]".to_owned()),
        Owner::All => {
            let remedy = "as in `length = \"3.5 in\"` in [initial] for all actuators, or of each in its section, such as \
                          `initial.length = \"3.5 in\"`";
            (path.to_owned(), remedy.to_owned())
        }
        Owner::Named(name, _) => {
            let section = format!("{}.{name}", keys::ACTUATORS);
            (format!("{section}.{path}"), format!("as in `{path} = \"3.5 in\"` in [{section}]"))
        }
    };
    let title = format!("`{path}` (L(0)) is missing, at which an isometric load holds the actuator");
    let label =
        if is_section { format!("`{path}` is expected") } else { "holds a length that nothing gives".to_owned() };
    r.note(
        Diagnostic::at(Class::Missing, place, title, label)
            .related(related, "chosen here")
            .help(format!("give `{path}`, the distance between the attachments that the load holds, {remedy}")),
    );
}

pub(super) fn initial(
    r: &mut Reader<'_>,
    load: Option<&Load>,
    series: Option<&PressureSeries>,
    air: &Air,
    owner: Owner<'_>,
) -> Initial {
    let path = p::INITIAL_LENGTH.key;
    let balanced = !r.has(path) || r.says(path, EQUILIBRIUM.name);
    let given = if balanced { InitialLength::Equilibrium } else { at(r) };
    let velocity = r.value(&p::INITIAL_VELOCITY, None);
    let moving = r.value_place(p::INITIAL_VELOCITY.key).filter(|_| velocity != 0.0);
    let length = match load {
        Some(Load::Isometric) => {
            if balanced {
                match r.value_place(path) {
                    Some(place) => {
                        let title = format!("`{path}` must be a length with an isometric load");
                        let label = "a fixed length has no equilibrium to find";
                        r.note(
                            Diagnostic::at(Class::NotApplicable, place, title, label)
                                .related(r.value_place("load.kind"), "chosen here")
                                .help("write the distance between the attachments that the load holds, as in `\"3.5 in\"`"),
                        );
                    }
                    None => no_length(r, owner),
                }
            }
            if let Some(place) = moving {
                let title = "an isometric load does not move";
                r.note(Diagnostic::at(Class::NotApplicable, place, title, "must be zero").help("remove the key"));
            }
            given
        }
        Some(load @ (Load::PrescribedMotion(_) | Load::AntagonisticJoint(_))) => {
            let of_joint = matches!(load, Load::AntagonisticJoint(_));
            let (what, instead) = if of_joint {
                ("an antagonistic joint, whose angle says it", "remove it, or give `initial.angle`")
            } else {
                ("a prescribed motion, which says it itself", "remove it")
            };
            for path in [path, p::INITIAL_VELOCITY.key] {
                if let Some(place) = r.key_place(path) {
                    let title = format!("`{path}` is not used with {what}");
                    r.note(
                        Diagnostic::at(Class::NotApplicable, place, title, "does not apply")
                            .related(r.value_place("load.kind"), "chosen here")
                            .help(instead),
                    );
                }
            }
            if of_joint { InitialLength::OfJoint } else { InitialLength::OfMotion }
        }
        _ => given,
    };
    let gauge_pressure = first_pressure(r, series, air);
    let (temperature, friction) = (r.value(&p::INITIAL_TEMPERATURE, None), friction_start(r));
    Initial { gauge_pressure, temperature, length, velocity, friction }
}

/// Where friction with a memory starts: on a branch, or holding a force.
pub(super) fn friction_start(r: &mut Reader<'_>) -> InitialFriction {
    let (word, force) = (keys::FRICTION_START, &INITIAL_FRICTION_FORCE);
    if let (Some(place), true) = (r.key_place(force.key), r.has(word)) {
        let title = "the start of friction is said in two ways";
        r.note(
            Diagnostic::at(Class::Conflict, place, title, "second way")
                .related(r.key_place(word), "first way")
                .help("keep one of the two"),
        );
    }
    match (r.number(force), r.word(word)) {
        (Some(force), _) => InitialFriction::Held(force),
        (None, Some(FrictionStart::Loading)) => InitialFriction::Loading,
        (None, Some(FrictionStart::Unloading)) => InitialFriction::Unloading,
        (None, Some(FrictionStart::Relaxed) | None) => InitialFriction::Relaxed,
    }
}

/// An initial length that is not the word `equilibrium`.
fn at(r: &mut Reader<'_>) -> InitialLength {
    r.number_or(&p::INITIAL_LENGTH, EQUILIBRIUM.name).map_or(InitialLength::Equilibrium, InitialLength::At)
}

pub(super) fn run(r: &mut Reader<'_>) -> Run {
    let duration = r.value(&p::DURATION, None);
    let sample_interval = r.value(&p::SAMPLE_INTERVAL, None);
    // An interval by default is at fault through the duration, which is all that the file says.
    let place = r.value_place(p::SAMPLE_INTERVAL.key).or_else(|| r.value_place(p::DURATION.key));
    if let Some(place) = place.filter(|_| r.has(p::DURATION.key) && sample_interval > duration) {
        let interval = quantity::format(sample_interval, p::SAMPLE_INTERVAL.unit);
        let title = format!("`{}` = {interval} is longer than the run", p::SAMPLE_INTERVAL.key);
        let label = format!("the run lasts {}", quantity::format(duration, p::DURATION.unit));
        let length = r.value_place(p::DURATION.key).filter(|_| r.has(p::SAMPLE_INTERVAL.key));
        r.note(
            Diagnostic::at(Class::Inconsistent, place, title, label)
                .related(length, "the run's duration")
                .help(p::SAMPLE_INTERVAL.remedy),
        );
    }
    Run {
        duration,
        sample_interval,
        engine: r.word("run.engine").unwrap_or(Engine::EventLocated),
        relative_tolerance: r.value(&p::RELATIVE_TOLERANCE, None),
        method: r.word("run.method").unwrap_or(Method::Stable),
        step: r.number(&p::STEP),
        accuracy: r.value(&p::ACCURACY, None),
    }
}
