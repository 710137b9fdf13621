//! A host that calls the functions of a unit as C does.

#![allow(dead_code, unreachable_pub)]

use mckibben_fmu::model::{Model, OPTIONS, SCENARIO};
use mckibben_fmu::options::UnitOptions;
use mckibben_scenario::Document;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::path::PathBuf;
use std::sync::Mutex;

/// A muscle of the paper with a valve of two poppets, 25 Hz pulses, at 90 mm and 40 psi.
pub const MUSCLE: &str = r#"
[supply]
gauge_pressure = "100 psi"
[valve]
preset = "matrix-eight-channel"
[command]
kind = "pwm"
frequency = "25 Hz"
duty = 0.5
[load]
kind = "hanging-mass"
mass = "5 lb"
[initial]
length = "90 mm"
gauge_pressure = "40 psi"
[run]
duration = "0.2 s"
step = "0.5 ms"
"#;

/// A muscle of the paper on a pressure regulator.
pub const REGULATED: &str = r#"
[supply]
gauge_pressure = "6 bar"
[valve]
kind = "pressure-regulator"
flow_area = "2 mm^2"
time_constant = "20 ms"
rate_limit = "50 bar/s"
[command]
kind = "set-points"
time = ["0 s"]
gauge_pressure = ["2 bar"]
[load]
kind = "isometric"
[initial]
length = "90 mm"
[run]
duration = "1 s"
"#;

/// A muscle that lifts a mass, on a valve whose poppets arrive 4 ms after their coils have switched.
pub const DELAYED: &str = r#"
[supply]
gauge_pressure = "5 bar"
[valve]
kind = "fill-hold-exhaust"
flow_area = "0.5 mm^2"
opening_delay = "4 ms"
closing_delay = "4 ms"
[command]
kind = "fill"
[load]
kind = "hanging-mass"
mass = "3 kg"
[initial]
gauge_pressure = "1.5 bar"
[run]
duration = "20 ms"
step = "0.1 ms"
"#;

/// A muscle with dry friction of 5 N and no other, whose ends the host moves.
pub const DRY: &str = r#"
[actuator]
preset = "colbrunn-2001"
friction = { viscous = "0 N*s/m", coulomb_width = "0 m", coulomb_force = "5 N" }
[supply]
gauge_pressure = "60 psi"
[valve]
kind = "fill-hold-exhaust"
flow_area = "0.5 mm^2"
[command]
kind = "hold"
[load]
kind = "isometric"
[initial]
length = "85 mm"
gauge_pressure = "30 psi"
[run]
duration = "1 s"
"#;

/// A muscle by a measured map of its force, behind a hose and a valve of seats: its laws have many pieces.
pub const MAPPED: &str = r#"
[actuator]
preset = "colbrunn-2001"
[actuator.force]
law = "map"
gauge_pressure = ["0 bar", "1 bar", "3 bar"]
length = ["70 mm", "76 mm", "80 mm", "87 mm"]
tension = ["0 N", "0 N", "0 N", "2 N", "0 N", "5 N", "10 N", "30 N", "0 N", "20 N", "40 N", "90 N"]
[supply]
gauge_pressure = "6 bar"
[valve]
kind = "fill-hold-exhaust"
flow_area = "2 mm^2"
[hose]
length = "0.3 m"
diameter = "3 mm"
[command]
kind = "hold"
[load]
kind = "isometric"
[initial]
length = "84 mm"
gauge_pressure = "1 bar"
[run]
duration = "1 s"
"#;

pub type Handle = *mut c_void;
pub const OK: c_int = 0;
pub const DISCARD: c_int = 2;
pub const ERROR: c_int = 3;
pub const NULL: Handle = std::ptr::null_mut();

pub type Log3 = unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char);
pub type Log2 = unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...);

#[repr(C)]
pub struct Callbacks {
    pub logger: Option<Log2>,
    pub allocate: usize,
    pub free: usize,
    pub step_finished: usize,
    pub environment: *mut c_void,
}

unsafe extern "C" {
    pub fn fmi3GetVersion() -> *const c_char;
    pub fn fmi3InstantiateCoSimulation(
        name: *const c_char,
        token: *const c_char,
        resources: *const c_char,
        visible: bool,
        logging: bool,
        event_mode: bool,
        early_return: bool,
        variables: *const u32,
        count: usize,
        environment: *mut c_void,
        log: Option<Log3>,
        update: *const c_void,
    ) -> Handle;
    pub fn fmi3InstantiateModelExchange(
        name: *const c_char,
        token: *const c_char,
        resources: *const c_char,
        visible: bool,
        logging: bool,
        environment: *mut c_void,
        log: Option<Log3>,
    ) -> Handle;
    pub fn fmi3FreeInstance(handle: Handle);
    pub fn fmi3EnterInitializationMode(h: Handle, t: bool, tolerance: f64, start: f64, s: bool, stop: f64) -> c_int;
    pub fn fmi3ExitInitializationMode(h: Handle) -> c_int;
    pub fn fmi3EnterEventMode(h: Handle) -> c_int;
    pub fn fmi3EnterStepMode(h: Handle) -> c_int;
    pub fn fmi3EnterContinuousTimeMode(h: Handle) -> c_int;
    pub fn fmi3Terminate(h: Handle) -> c_int;
    pub fn fmi3Reset(h: Handle) -> c_int;
    pub fn fmi3GetFloat64(h: Handle, of: *const u32, n: usize, values: *mut f64, m: usize) -> c_int;
    pub fn fmi3SetFloat64(h: Handle, of: *const u32, n: usize, values: *const f64, m: usize) -> c_int;
    pub fn fmi3GetInt32(h: Handle, of: *const u32, n: usize, values: *mut i32, m: usize) -> c_int;
    pub fn fmi3SetTime(h: Handle, time: f64) -> c_int;
    pub fn fmi3SetContinuousStates(h: Handle, states: *const f64, n: usize) -> c_int;
    pub fn fmi3GetContinuousStates(h: Handle, states: *mut f64, n: usize) -> c_int;
    pub fn fmi3GetContinuousStateDerivatives(h: Handle, rates: *mut f64, n: usize) -> c_int;
    pub fn fmi3GetNumberOfContinuousStates(h: Handle, n: *mut usize) -> c_int;
    pub fn fmi3GetNominalsOfContinuousStates(h: Handle, nominals: *mut f64, n: usize) -> c_int;
    pub fn fmi3GetNumberOfEventIndicators(h: Handle, n: *mut usize) -> c_int;
    pub fn fmi3GetEventIndicators(h: Handle, values: *mut f64, n: usize) -> c_int;
    pub fn fmi3CompletedIntegratorStep(h: Handle, no: bool, event: *mut bool, end: *mut bool) -> c_int;
    pub fn fmi3UpdateDiscreteStates(
        h: Handle,
        again: *mut bool,
        end: *mut bool,
        nominals: *mut bool,
        values: *mut bool,
        has_next: *mut bool,
        next: *mut f64,
    ) -> c_int;
    pub fn fmi3DoStep(
        h: Handle,
        time: f64,
        step: f64,
        no: bool,
        event: *mut bool,
        end: *mut bool,
        early: *mut bool,
        reached: *mut f64,
    ) -> c_int;
    pub fn fmi3GetFMUState(h: Handle, state: *mut Handle) -> c_int;
    pub fn fmi3SetFMUState(h: Handle, state: Handle) -> c_int;
    pub fn fmi3FreeFMUState(h: Handle, state: *mut Handle) -> c_int;
    pub fn fmi3SerializedFMUStateSize(h: Handle, state: Handle, size: *mut usize) -> c_int;
    pub fn fmi3SerializeFMUState(h: Handle, state: Handle, bytes: *mut u8, size: usize) -> c_int;
    pub fn fmi3DeserializeFMUState(h: Handle, bytes: *const u8, size: usize, state: *mut Handle) -> c_int;
    pub fn fmi3GetDirectionalDerivative(
        h: Handle,
        unknowns: *const u32,
        a: usize,
        knowns: *const u32,
        b: usize,
        seed: *const f64,
        c: usize,
        sensitivity: *mut f64,
        d: usize,
    ) -> c_int;
    pub fn fmi2Instantiate(
        name: *const c_char,
        kind: c_int,
        guid: *const c_char,
        resources: *const c_char,
        callbacks: *const Callbacks,
        visible: c_int,
        logging: c_int,
    ) -> Handle;
    pub fn fmi2FreeInstance(h: Handle);
    pub fn fmi2SetupExperiment(h: Handle, t: c_int, tolerance: f64, start: f64, s: c_int, stop: f64) -> c_int;
    pub fn fmi2EnterInitializationMode(h: Handle) -> c_int;
    pub fn fmi2ExitInitializationMode(h: Handle) -> c_int;
    pub fn fmi2GetReal(h: Handle, of: *const u32, n: usize, values: *mut f64) -> c_int;
    pub fn fmi2SetReal(h: Handle, of: *const u32, n: usize, values: *const f64) -> c_int;
    pub fn fmi2DoStep(h: Handle, time: f64, step: f64, no: c_int) -> c_int;
    pub fn fmi2Terminate(h: Handle) -> c_int;
}

/// Messages that a unit has logged.
#[derive(Default)]
pub struct Messages(pub Mutex<Vec<String>>);

impl Messages {
    pub fn pointer(&self) -> *mut c_void {
        std::ptr::from_ref(self).cast_mut().cast()
    }

    /// Takes what was logged.
    pub fn take(&self) -> String {
        std::mem::take(&mut *self.0.lock().expect("messages")).join("\n")
    }
}

/// Logs as a host of FMI 3.0 does.
///
/// # Safety
/// The environment is [`Messages`].
pub unsafe extern "C" fn log(environment: *mut c_void, status: c_int, category: *const c_char, message: *const c_char) {
    // SAFETY: what `pointer` gave, and texts of the unit.
    let (messages, category, message) =
        unsafe { (&*environment.cast::<Messages>(), CStr::from_ptr(category), CStr::from_ptr(message)) };
    let line = format!("{status} {} {}", category.to_string_lossy(), message.to_string_lossy());
    messages.0.lock().expect("messages").push(line);
}

/// An unpacked unit.
pub struct Unit {
    pub model: Model,
    pub folder: PathBuf,
    pub token: CString,
    pub resources: CString,
}

impl Unit {
    pub fn new(text: &str, options: &UnitOptions) -> Self {
        Self::of_document(Document::parse(text, "muscle.toml").expect("TOML"), options)
    }

    pub fn of_document(document: Document, options: &UnitOptions) -> Self {
        let model = Model::new(document, options.clone()).expect("a scenario");
        static COUNT: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);
        let count = COUNT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("mckibben-fmu-{}-{count}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        std::fs::write(folder.join(SCENARIO), model.document().to_toml()).expect("a file");
        std::fs::write(folder.join(OPTIONS), model.options().to_text()).expect("a file");
        let text = |text: &str| CString::new(text).expect("a text");
        Self { token: text(model.token()), resources: text(&folder.to_string_lossy()), folder, model }
    }

    /// The reference of a variable.
    pub fn reference(&self, name: &str) -> u32 {
        let found = self.model.variables().all.iter().find(|its| its.name == name);
        found.unwrap_or_else(|| panic!("no variable {name}")).reference
    }

    pub fn co_simulation(&self, messages: &Messages, event_mode: bool) -> Handle {
        // SAFETY: texts and a function that live.
        let handle = unsafe {
            fmi3InstantiateCoSimulation(
                c"muscle".as_ptr(),
                self.token.as_ptr(),
                self.resources.as_ptr(),
                false,
                true,
                event_mode,
                event_mode,
                std::ptr::null(),
                0,
                messages.pointer(),
                Some(log),
                std::ptr::null(),
            )
        };
        assert!(!handle.is_null(), "{}", messages.take());
        handle
    }

    pub fn model_exchange(&self, messages: &Messages) -> Handle {
        let (token, resources) = (self.token.as_ptr(), self.resources.as_ptr());
        // SAFETY: texts and a function that live.
        let handle = unsafe {
            let name = c"muscle".as_ptr();
            fmi3InstantiateModelExchange(name, token, resources, false, true, messages.pointer(), Some(log))
        };
        assert!(!handle.is_null(), "{}", messages.take());
        handle
    }
}

impl Drop for Unit {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// Initialises an instance.
pub fn initialise(handle: Handle) {
    // SAFETY: an instance, or a number that is none.
    unsafe {
        assert_eq!(fmi3EnterInitializationMode(handle, false, 0.0, 0.0, false, 0.0), OK);
        assert_eq!(fmi3ExitInitializationMode(handle), OK);
    }
}

pub fn get(handle: Handle, reference: u32) -> f64 {
    let mut value = 0.0;
    // SAFETY: one reference and room for one value.
    assert_eq!(unsafe { fmi3GetFloat64(handle, &reference, 1, &mut value, 1) }, OK);
    value
}

pub fn set(handle: Handle, reference: u32, value: f64) -> c_int {
    // SAFETY: one reference and one value.
    unsafe { fmi3SetFloat64(handle, &reference, 1, &value, 1) }
}

/// Steps; the status, the time that was reached, and whether that is early.
pub fn step(handle: Handle, time: f64, step: f64) -> (c_int, f64, bool) {
    let (status, reached, early, event) = step_to_event(handle, time, step);
    assert!(event || !early);
    (status, reached, early)
}

/// Steps; as [`step`], and whether an event is to be handled.
pub fn step_to_event(handle: Handle, time: f64, step: f64) -> (c_int, f64, bool, bool) {
    let (mut event, mut end, mut early, mut reached) = (false, false, false, f64::NAN);
    // SAFETY: room for each.
    let status = unsafe { fmi3DoStep(handle, time, step, true, &mut event, &mut end, &mut early, &mut reached) };
    (status, reached, early, event)
}

/// Updates an instance at an event; the next instant.
pub fn update(handle: Handle) -> f64 {
    let (mut again, mut end, mut nominals, mut values, mut has_next) = (true, true, true, true, false);
    let mut next = 0.0;
    // SAFETY: room for each.
    let status = unsafe {
        fmi3UpdateDiscreteStates(handle, &mut again, &mut end, &mut nominals, &mut values, &mut has_next, &mut next)
    };
    assert_eq!((status, again, end), (OK, false, false));
    if has_next { next } else { f64::INFINITY }
}
