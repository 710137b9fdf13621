//! What MuJoCo calls, and the way from its memory to an instance.
//!
//! Nothing unwinds into MuJoCo, and nothing calls `mju_error`: a mistake in a model is a warning and a refusal to make its
//! data; a plant that cannot go on is one warning and no force from then on.

use crate::layout::DataField;
use crate::library::Library;
use crate::view::{Data, Model};
use crate::{PLUGIN, config, instance};
use instance::{Instance, Wire};
use mckibben_run::failure::Failure;
use std::ffi::{CString, c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;

type Advance = unsafe extern "C" fn(*const c_void, *mut c_void, c_int);

/// `mjpPlugin`, which is 152 bytes from 3.2.7 to 4.0.0.
#[repr(C)]
struct Plugin {
    name: *const c_char,
    attribute_count: c_int,
    attributes: *const *const c_char,
    capabilities: c_int,
    stage: c_int,
    nstate: unsafe extern "C" fn(*const c_void, c_int) -> c_int,
    nsensordata: unsafe extern "C" fn(*const c_void, c_int, c_int) -> c_int,
    init: unsafe extern "C" fn(*const c_void, *mut c_void, c_int) -> c_int,
    destroy: unsafe extern "C" fn(*mut c_void, c_int),
    copy: Option<unsafe extern "C" fn(*mut c_void, *const c_void, *const c_void, c_int)>,
    reset: unsafe extern "C" fn(*const c_void, *mut f64, *mut c_void, c_int),
    compute: unsafe extern "C" fn(*const c_void, *mut c_void, c_int, c_int),
    advance: Advance,
    visualize: Option<Advance>,
    act_dot: Option<Advance>,
    distance_fields: [usize; 5],
}

const ACTUATOR: c_int = 1;
const SENSOR: c_int = 2;

const _: () = assert!(size_of::<Plugin>() == 152);

/// Names of the attributes, which MuJoCo keeps pointers to.
struct Attributes {
    _names: Vec<CString>,
    pointers: Vec<*const c_char>,
}

// SAFETY: nothing changes the texts that the pointers are of.
unsafe impl Send for Attributes {}
// SAFETY: as above.
unsafe impl Sync for Attributes {}

fn attributes() -> &'static Attributes {
    static ALL: OnceLock<Attributes> = OnceLock::new();
    ALL.get_or_init(|| {
        let names: Vec<CString> = config::attributes().filter_map(|name| CString::new(name).ok()).collect();
        let pointers = names.iter().map(|name| name.as_ptr()).collect();
        Attributes { _names: names, pointers }
    })
}

/// Registers the plugin.
pub(crate) fn register() -> Result<(), String> {
    static DONE: OnceLock<Result<(), String>> = OnceLock::new();
    let library = Library::find()?;
    DONE.get_or_init(|| {
        let attributes = attributes();
        let name = CString::new(PLUGIN).unwrap_or_default();
        if library.has_plugin(&name) {
            return Ok(());
        }
        let plugin = Plugin {
            name: name.as_ptr(),
            attribute_count: c_int::try_from(attributes.pointers.len()).unwrap_or(0),
            attributes: attributes.pointers.as_ptr(),
            capabilities: ACTUATOR | SENSOR,
            stage: library.layout.stage,
            nstate,
            nsensordata,
            init,
            destroy,
            copy: None,
            reset,
            compute,
            advance,
            visualize: None,
            // MuJoCo integrates nothing: `advance` writes `act`.
            act_dot: None,
            distance_fields: [0; 5],
        };
        // SAFETY: the structure is MuJoCo's, which copies it with its texts.
        let slot = unsafe { (library.register_plugin)(std::ptr::from_ref(&plugin).cast()) };
        if slot < 0 { Err("MuJoCo did not take the plugin".to_owned()) } else { Ok(()) }
    })
    .clone()
}

/// Registers the plugin when the library is loaded; a warning says why it could not be.
#[cfg(feature = "register-on-load")]
extern "C" fn on_load() {
    let done = catch_unwind(register);
    if let (Ok(Err(why)), Some(library)) = (&done, Library::get()) {
        library.warn(why);
    } else if let Ok(Err(why)) = done {
        eprintln!("mckibben: {why}");
    }
}

#[cfg(feature = "register-on-load")]
// SAFETY: the loader calls each function of this section once, without arguments that are used.
#[unsafe(link_section = ".init_array")]
#[used]
static ON_LOAD: extern "C" fn() = on_load;

/// Gives MuJoCo a failure in one line.
fn warn(library: &Library, model: &Model, number: usize, failure: &Failure) {
    // SAFETY: the model is one, as the maker of the view promised.
    let name = unsafe { library.name_of(model.pointer(), library.layout.objects[2], number) };
    let of = if name.is_empty() { format!("number {number}") } else { format!("`{name}`") };
    library.warn(&format!("{PLUGIN}, instance {of}: {}", failure.sentence().replace('\n', " | ")));
}

/// The configuration of an instance.
///
/// # Safety
/// `model` is an `mjModel` with that instance.
unsafe fn config_of(library: &Library, model: &Model, number: c_int) -> Result<config::Config, Failure> {
    config::read(|name| {
        let name = CString::new(name).ok()?;
        // SAFETY: the caller's promise.
        unsafe { library.attribute(model.pointer(), number, &name) }
    })
}

/// Calls a function where the library has been found and the number is one; nothing unwinds out of it.
fn guarded<T>(otherwise: T, number: c_int, function: impl FnOnce(&'static Library, usize) -> T) -> T {
    let (Some(library), Ok(number)) = (Library::get(), usize::try_from(number)) else { return otherwise };
    match catch_unwind(AssertUnwindSafe(|| function(library, number))) {
        Ok(done) => done,
        Err(_) => {
            library.warn(&format!("{PLUGIN}: an unexpected failure; please report it with the model"));
            otherwise
        }
    }
}

unsafe extern "C" fn nstate(model: *const c_void, number: c_int) -> c_int {
    guarded(0, number, |library, _| {
        // SAFETY: MuJoCo calls this with its model and an instance of it.
        let read = unsafe { config_of(library, &Model::new(model, library.layout), number) };
        // What is wrong is reported when the data are made.
        read.map_or(0, |mut config| c_int::try_from(instance::state_size(&mut config)).unwrap_or(0))
    })
}

unsafe extern "C" fn nsensordata(_model: *const c_void, _number: c_int, _sensor: c_int) -> c_int {
    1
}

unsafe extern "C" fn init(model: *const c_void, data: *mut c_void, number: c_int) -> c_int {
    guarded(-1, number, |library, at| {
        // SAFETY: MuJoCo calls this with its model, data of that model, and an instance of it.
        let (model, mut data) = unsafe { (Model::new(model, library.layout), Data::new(data, library.layout)) };
        // SAFETY: as above.
        let made = unsafe { config_of(library, &model, number) }.and_then(|config| wired(library, &model, at, config));
        match made {
            Ok(made) => {
                data.keep(at, Box::into_raw(Box::new(made)).cast());
                0
            }
            Err(failure) => {
                data.keep(at, std::ptr::null_mut());
                warn(library, &model, at, &failure);
                -1
            }
        }
    })
}

/// An instance with the actuators and sensors of the model that refer to it.
fn wired(library: &Library, model: &Model, number: usize, mut config: config::Config) -> Result<Instance, Failure> {
    if model.is_rk4() {
        return Err(of_rk4());
    }
    check_size(instance::state_size(&mut config), model.state_count(number))?;
    let is_its = |instance: i32| usize::try_from(instance) == Ok(number);
    let [actuator, sensor, _] = library.layout.objects;
    // SAFETY: the model is one, as the maker of the view promised.
    let name_of = |kind: i32, id: usize| unsafe { library.name_of(model.pointer(), kind, id) };
    let mut actuators = Vec::new();
    for id in (0..model.actuators()).filter(|id| is_its(model.actuator_instance(*id))) {
        let name = name_of(actuator, id);
        let ([control, output], (act, count)) = (model.addresses(id), model.activation(id));
        // MuJoCo would add its own rate to the pressures that `advance` writes.
        if model.has_dynamics(id) {
            return Err(Failure::input(
                format!("the actuator `{name}` has a dyntype, so MuJoCo would change the pressure in act too"),
                "leave dyntype out: actdim=\"1\" is enough for its gauge pressure in act",
            ));
        }
        if count > 1 {
            return Err(Failure::input(
                format!("the actuator `{name}` has {count} activations"),
                "give actdim=\"1\" for its gauge pressure in act, or leave it out, and no dyntype",
            ));
        }
        check_transmission(model, (id, output), &name)?;
        let act = act.filter(|_| count == 1);
        let (range, group) = (model.control_range(control), model.group(id));
        actuators.push((name, Wire { output, control, act, range, group }));
    }
    let sensors = (0..model.sensors()).filter(|id| is_its(model.sensor_instance(*id)));
    let sensors: Vec<(String, usize)> = sensors.map(|id| (name_of(sensor, id), model.sensor_address(id))).collect();
    Instance::new(config, &actuators, &sensors)
}

/// Refuses a plant of more or fewer numbers than the model was compiled for: a scenario file is read for each data of the model.
fn check_size(size: usize, compiled: usize) -> Result<(), Failure> {
    if size == compiled {
        return Ok(());
    }
    Err(Failure::input(
        format!(
            "the state of the plant is {size} numbers, and the model was compiled for {compiled}: the file of `scenario` has other \
             parts now, or another version of mckibben compiled the model"
        ),
        "compile the model again; with scenario_text in place of scenario it keeps the text that it was compiled with",
    ))
}

/// Why the integrator RK4 is refused.
fn of_rk4() -> Failure {
    Failure::input(
        "the integrator RK4 takes the forces at four times in a step, and the muscles have the air of one of them",
        "write integrator=\"Euler\", \"implicit\" or \"implicitfast\" in <option>",
    )
}

/// Refuses what would be between the length, the tension or the control of a muscle, by its actuator and force output, and
/// those of MuJoCo.
fn check_transmission(model: &Model, (actuator, output): (usize, usize), name: &str) -> Result<(), Failure> {
    if let Some(target) = model.target_without_length(actuator) {
        return Err(Failure::input(
            format!("the actuator `{name}` acts on a {target}, for which MuJoCo has no distance"),
            "give tendon=\"…\", such as a <spatial> tendon between the sites of both ends, or a joint of type hinge or slide",
        ));
    }
    let (gear, delay) = (model.gear(output), model.delay(actuator));
    let (what, remedy) = if gear != 1.0 {
        let remedy = "leave gear out; for a pulley take a <fixed> tendon whose coefficient is its radius";
        (format!("has gear=\"{gear}\", which scales both length and tension"), remedy)
    } else if delay > 0.0 {
        let remedy = "leave delay out, and give valve.dead_time, by which the valve takes its control later";
        (format!("has delay=\"{delay}\", which the plugin would leave out"), remedy)
    } else if let Some(target) = model.limited_target(actuator) {
        let remedy = "leave actuatorfrcrange out";
        (format!("pulls on a {target} with an actuatorfrcrange, which is no property of the muscle"), remedy)
    } else {
        return Ok(());
    };
    Err(Failure::input(format!("the actuator `{name}` {what}"), remedy))
}

unsafe extern "C" fn destroy(data: *mut c_void, number: c_int) {
    guarded((), number, |library, at| {
        // SAFETY: MuJoCo calls this once, with data and an instance whose `init` it has called.
        unsafe {
            let mut data = Data::new(data, library.layout);
            let kept = data.kept(at).cast::<Instance>();
            if !kept.is_null() {
                data.keep(at, std::ptr::null_mut());
                drop(Box::from_raw(kept));
            }
        }
    });
}

unsafe extern "C" fn reset(_model: *const c_void, state: *mut f64, kept: *mut c_void, number: c_int) {
    guarded((), number, |_, _| {
        // SAFETY: MuJoCo gives the numbers of the instance and what `init` kept.
        unsafe {
            if let Some(instance) = kept.cast::<Instance>().as_mut() {
                instance::reset(std::slice::from_raw_parts_mut(state, instance.size()));
            }
        }
    });
}

/// Calls a function with an instance, its state and the data, after the ends have been read from MuJoCo.
///
/// # Safety
/// As MuJoCo calls plugins: model and data belong together, and `init` has been called for the instance.
unsafe fn with_instance(
    (model, data, number): (*const c_void, *mut c_void, c_int),
    function: impl FnOnce(&mut Instance, &mut [f64], (&Model, &mut Data)) -> Result<(), Failure>,
) {
    guarded((), number, |library, at| {
        // SAFETY: the caller's promise. The state is the instance's own, of the size that `nstate` said.
        let (model, mut data, instance) = unsafe {
            let data = Data::new(data, library.layout);
            (Model::new(model, library.layout), data, data.kept(at).cast::<Instance>().as_mut())
        };
        let Some(instance) = instance else { return };
        // SAFETY: as above.
        let state = unsafe { data.state(model.state_address(at), instance.size()) };
        for (k, wire) in instance.wires.iter().enumerate() {
            instance.ends.lengths[k] = data.number(DataField::Length, wire.output);
            instance.ends.velocities[k] = data.number(DataField::Rate, wire.output);
            instance.ends.disabled[k] = model.disables(wire.group);
            if let Some(act) = wire.act {
                instance.ends.acts[k] = data.number(DataField::Act, act);
            }
        }
        if let Err(failure) = function(instance, state, (&model, &mut data)) {
            warn(library, &model, at, &failure);
        }
    });
}

unsafe extern "C" fn compute(model: *const c_void, data: *mut c_void, number: c_int, capability: c_int) {
    let forces = |instance: &mut Instance, state: &mut [f64], (_, data): (&Model, &mut Data)| {
        if capability == SENSOR {
            return instance.sense(state, |address, value| data.set_number(DataField::Sensor, address, value));
        }
        let computed = instance.compute(state);
        for (wire, tension) in instance.wires.iter().zip(instance.tensions(state)) {
            data.set_number(DataField::Force, wire.output, -tension);
        }
        computed
    };
    // SAFETY: MuJoCo calls this as plugins are called.
    unsafe { with_instance((model, data, number), forces) }
}

unsafe extern "C" fn advance(model: *const c_void, data: *mut c_void, number: c_int) {
    let go_on = |instance: &mut Instance, state: &mut [f64], (model, data): (&Model, &mut Data)| {
        for (k, wire) in instance.wires.iter().enumerate() {
            instance.ends.next_velocities[k] = data.velocity_now(wire.output);
            instance.ends.controls[k] = data.number(DataField::Control, wire.control);
        }
        let done = match model.is_rk4() {
            true => instance.stop(state, of_rk4()),
            false => instance.advance(state, model.timestep()),
        };
        for (k, wire) in instance.wires.iter().enumerate() {
            if let (Some(act), Ok(())) = (wire.act, &done) {
                data.set_number(DataField::Act, act, instance::pressure(state, k));
            }
        }
        done
    };
    // SAFETY: MuJoCo calls this as plugins are called.
    unsafe { with_instance((model, data, number), go_on) }
}
