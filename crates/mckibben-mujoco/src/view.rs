//! Fields of `mjModel` and `mjData`, read and written where [`Layout`] says that they are.

use crate::layout::{DataField as D, LaterField, Layout, ModelField as M};
use std::ffi::c_void;

/// The integrator RK4; this and what follows are equal in every version, as `tools/layout.py` checks.
const RK4: i32 = 1;
/// Kinds of transmissions.
const ON_JOINT: [i32; 2] = [0, 1];
const ON_SLIDER_CRANK: i32 = 2;
const ON_TENDON: i32 = 3;
/// Kinds of joints.
const SLIDE: i32 = 2;
const HINGE: i32 = 3;
/// A joint among what a tendon goes through.
const WRAP_JOINT: i32 = 1;

/// An `mjModel`.
#[derive(Clone, Copy)]
pub(crate) struct Model {
    at: *const u8,
    layout: &'static Layout,
}

/// An `mjData`.
#[derive(Clone, Copy)]
pub(crate) struct Data {
    at: *mut u8,
    layout: &'static Layout,
}

impl Model {
    /// # Safety
    /// `at` is an `mjModel` of the version of `layout`, and stays one as long as this is used.
    pub(crate) unsafe fn new(at: *const c_void, layout: &'static Layout) -> Self {
        Self { at: at.cast(), layout }
    }

    pub(crate) fn pointer(&self) -> *const c_void {
        self.at.cast()
    }

    /// A number of entries, of the type that the version has.
    fn count(&self, offset: usize) -> usize {
        // SAFETY: the layout says where the number is and how large; it is aligned as C has laid it out.
        let count = unsafe {
            match self.layout.count_size {
                4 => i64::from(self.at.add(offset).cast::<i32>().read()),
                _ => self.at.add(offset).cast::<i64>().read(),
            }
        };
        usize::try_from(count).unwrap_or(0)
    }

    pub(crate) fn actuators(&self) -> usize {
        self.count(self.layout.actuators)
    }

    pub(crate) fn sensors(&self) -> usize {
        self.count(self.layout.model(M::SensorCount))
    }

    pub(crate) fn timestep(&self) -> f64 {
        // SAFETY: as in `count`; the options are part of the model.
        unsafe { self.at.add(self.layout.model(M::Timestep)).cast::<f64>().read() }
    }

    /// The entry of an array whose pointer is at an offset.
    ///
    /// # Safety
    /// The array has that many entries of this type.
    unsafe fn entry<T: Copy>(&self, offset: usize, index: usize) -> T {
        // SAFETY: the layout says where the pointer is; the rest is the caller's promise.
        unsafe { self.at.add(offset).cast::<*const T>().read().add(index).read() }
    }

    /// An entry of an array of numbers that has one for each actuator, sensor, instance, joint or part of a tendon, as its
    /// name says.
    fn index(&self, field: M, index: usize) -> i32 {
        // SAFETY: callers name an actuator, a sensor, an instance, a joint or a part of a tendon of this model.
        unsafe { self.entry(self.layout.model(field), index) }
    }

    /// The instance of an actuator.
    pub(crate) fn actuator_instance(&self, actuator: usize) -> i32 {
        self.index(M::ActuatorPlugin, actuator)
    }

    /// The instance of a sensor.
    pub(crate) fn sensor_instance(&self, sensor: usize) -> i32 {
        self.index(M::SensorPlugin, sensor)
    }

    /// Address of a sensor in `sensordata`.
    pub(crate) fn sensor_address(&self, sensor: usize) -> usize {
        usize::try_from(self.index(M::SensorAddress, sensor)).unwrap_or(0)
    }

    /// Address of an instance in `plugin_state`.
    pub(crate) fn state_address(&self, instance: usize) -> usize {
        usize::try_from(self.index(M::StateAddress, instance)).unwrap_or(0)
    }

    /// How many numbers an instance has in `plugin_state`, as the model was compiled.
    pub(crate) fn state_count(&self, instance: usize) -> usize {
        usize::try_from(self.index(M::StateCount, instance)).unwrap_or(0)
    }

    /// Address of an actuator's first control, and of its force.
    pub(crate) fn addresses(&self, actuator: usize) -> [usize; 2] {
        let Some(offsets) = self.layout.addresses else { return [actuator; 2] };
        // SAFETY: both arrays have an entry for each actuator.
        offsets.map(|offset| usize::try_from(unsafe { self.entry::<i32>(offset, actuator) }).unwrap_or(0))
    }

    /// Address of an actuator's first entry in `act`, and how many it has.
    pub(crate) fn activation(&self, actuator: usize) -> (Option<usize>, i32) {
        (usize::try_from(self.index(M::ActAddress, actuator)).ok(), self.index(M::ActCount, actuator))
    }

    /// Whether MuJoCo computes the activation of an actuator: by any `dyntype` but none, which is 0 in every version.
    pub(crate) fn has_dynamics(&self, actuator: usize) -> bool {
        self.index(M::Dynamics, actuator) != 0
    }

    /// A number among the options of the model.
    fn option(&self, field: M) -> i32 {
        // SAFETY: as in `count`; the options are part of the model.
        unsafe { self.at.add(self.layout.model(field)).cast::<i32>().read() }
    }

    /// Whether MuJoCo's integrator is RK4, which takes the forces at four times in a step.
    pub(crate) fn is_rk4(&self) -> bool {
        self.option(M::Integrator) == RK4
    }

    /// The group of an actuator.
    pub(crate) fn group(&self, actuator: usize) -> i32 {
        self.index(M::Group, actuator)
    }

    /// Whether the options let actuators of a group exert no force at present.
    pub(crate) fn disables(&self, group: i32) -> bool {
        let is_in_disabled = (0..=30).contains(&group) && (self.option(M::DisabledGroups) >> group) & 1 != 0;
        is_in_disabled || self.option(M::DisableFlags) & self.layout.no_actuation != 0
    }

    /// What an actuator acts on where MuJoCo has no length of one coordinate for it: that of a site is zero or the component of a pose, that
    /// of a ball joint a rotation.
    pub(crate) fn target_without_length(&self, actuator: usize) -> Option<&'static str> {
        match self.index(M::Transmission, actuator) {
            ON_TENDON | ON_SLIDER_CRANK => None,
            kind if ON_JOINT.contains(&kind) => {
                let joint = usize::try_from(self.index(M::Target, 2 * actuator)).ok();
                match joint.map(|joint| self.index(M::JointKind, joint)) {
                    Some(SLIDE | HINGE) => None,
                    _ => Some("joint that is free or a ball"),
                }
            }
            _ => Some("site or body"),
        }
    }

    /// What scales the length and the force of an actuator that has a length of one coordinate.
    pub(crate) fn gear(&self, output: usize) -> f64 {
        // SAFETY: there are six numbers for each force output.
        unsafe { self.entry(self.layout.model(M::Gear), 6 * output) }
    }

    /// By how much in s the control of an actuator acts late; zero in versions without delays.
    pub(crate) fn delay(&self, actuator: usize) -> f64 {
        // SAFETY: there is a number for each actuator.
        self.layout.later(LaterField::Delay).map_or(0.0, |offset| unsafe { self.entry(offset, actuator) })
    }

    /// What has a range of forces of actuators: the tendon of an actuator, its joint, or a joint of its fixed tendon.
    pub(crate) fn limited_target(&self, actuator: usize) -> Option<&'static str> {
        // SAFETY: callers name a joint or a tendon of this model; a flag is one byte in every version.
        let is_limited = |offset: usize, at: usize| unsafe { self.entry::<u8>(offset, at) != 0 };
        let joint = |at: i32| {
            let is_one = usize::try_from(at).is_ok_and(|at| is_limited(self.layout.model(M::JointForceLimited), at));
            is_one.then_some("joint")
        };
        let (kind, target) = (self.index(M::Transmission, actuator), self.index(M::Target, 2 * actuator));
        if ON_JOINT.contains(&kind) {
            return joint(target);
        }
        let tendon = usize::try_from(target).ok().filter(|_| kind == ON_TENDON)?;
        if self.layout.later(LaterField::TendonForceLimited).is_some_and(|offset| is_limited(offset, tendon)) {
            return Some("tendon");
        }
        let [first, count] = [M::TendonAddress, M::TendonCount].map(|of| self.index(of, tendon));
        let parts = (first..first + count).filter_map(|at| usize::try_from(at).ok());
        parts
            .filter(|at| self.index(M::WrapKind, *at) == WRAP_JOINT)
            .find_map(|at| joint(self.index(M::WrapObject, at)))
    }

    /// The range that the model sets on a control.
    pub(crate) fn control_range(&self, control: usize) -> Option<[f64; 2]> {
        // SAFETY: both arrays have entries for each control; a flag is one byte in every version.
        unsafe {
            let is_limited = self.entry::<u8>(self.layout.model(M::ControlLimited), control) != 0;
            let range = |of: usize| self.entry::<f64>(self.layout.model(M::ControlRange), 2 * control + of);
            is_limited.then(|| [range(0), range(1)])
        }
    }
}

impl Data {
    /// # Safety
    /// `at` is an `mjData` of the version of `layout` for the model that its users name, and no other code uses it
    /// meanwhile.
    pub(crate) unsafe fn new(at: *mut c_void, layout: &'static Layout) -> Self {
        Self { at: at.cast(), layout }
    }

    fn array<T>(&self, field: D) -> *mut T {
        // SAFETY: the layout says where the pointer is.
        unsafe { self.at.add(self.layout.data(field)).cast::<*mut T>().read() }
    }

    /// An entry of an array of numbers; the caller has its address from the model.
    pub(crate) fn number(&self, field: D, address: usize) -> f64 {
        // SAFETY: the model says that the entry is there.
        unsafe { self.array::<f64>(field).add(address).read() }
    }

    pub(crate) fn set_number(&mut self, field: D, address: usize, value: f64) {
        // SAFETY: as in `number`.
        unsafe { self.array::<f64>(field).add(address).write(value) }
    }

    /// The velocity of a force output: its row of the moment, which MuJoCo keeps sparse, times the velocities of the joints
    /// that there are now.
    pub(crate) fn velocity_now(&self, output: usize) -> f64 {
        let start = |field: D| -> usize {
            // SAFETY: there is an entry for each output.
            usize::try_from(unsafe { self.array::<i32>(field).add(output).read() }).unwrap_or(0)
        };
        let (first, count) = (start(D::MomentStart), start(D::MomentCount));
        let (columns, moments, rates) =
            (self.array::<i32>(D::MomentColumns), self.array::<f64>(D::Moment), self.array::<f64>(D::Velocity));
        // SAFETY: MuJoCo fills the row with as many entries, whose columns are degrees of freedom.
        (first..first + count)
            .map(|at| unsafe {
                moments.add(at).read() * rates.add(columns.add(at).read().unsigned_abs() as usize).read()
            })
            .sum()
    }

    /// The state of an instance.
    ///
    /// # Safety
    /// The instance has that many numbers, and no other slice of them is in use.
    pub(crate) unsafe fn state<'d>(&mut self, address: usize, count: usize) -> &'d mut [f64] {
        // SAFETY: the caller's promise; MuJoCo's numbers are aligned.
        unsafe { std::slice::from_raw_parts_mut(self.array::<f64>(D::State).add(address), count) }
    }

    /// What the plugin keeps for an instance.
    pub(crate) fn kept(&self, instance: usize) -> *mut c_void {
        // SAFETY: there is an entry for each instance.
        unsafe { self.array::<usize>(D::Kept).add(instance).read() as *mut c_void }
    }

    pub(crate) fn keep(&mut self, instance: usize, what: *mut c_void) {
        // SAFETY: as in `kept`.
        unsafe { self.array::<usize>(D::Kept).add(instance).write(what as usize) }
    }
}
