//! Where friction with a memory starts: relaxed, on one of its branches, or holding a force.

use super::{Plant, PlantStart};
use crate::actuator::Actuator;
use crate::error::{Error, Requirement};
use crate::friction::{Hysteresis, MAX_BRANCHES, Memory, SlidingState, ThreadContact};
use crate::parameter::{Parameter, Range};
use crate::scalar::Real;
use alloc::vec::Vec;

/// The friction of an actuator at the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum InitialFriction<S = f64> {
    /// The hysteresis is relaxed: it adds nothing.
    #[default]
    Relaxed,
    /// As after a long way of lengthening, as a growing load does it: all of it adds to the tension.
    Loading,
    /// As after a long way of shortening: all of it takes from the tension.
    Unloading,
    /// The hysteresis holds a force in N, positive where it adds to the tension, after one way from where it was relaxed.
    Held(S),
}

impl<S> InitialFriction<S> {
    /// The direction in which the actuator has come a long way, where it has: 1 for longer, −1 for shorter.
    fn direction(&self) -> Option<f64> {
        match self {
            Self::Loading => Some(1.0),
            Self::Unloading => Some(-1.0),
            Self::Relaxed | Self::Held(_) => None,
        }
    }
}

/// The force of [`InitialFriction::Held`].
pub static INITIAL_FRICTION_FORCE: Parameter = Parameter {
    key: "initial.friction_force",
    symbol: "F_h(0)",
    unit: "N",
    range: Range::FINITE,
    default: None,
    meaning: "Force that the hysteresis of the actuator holds at the start, positive where it adds to the tension.",
    source: "choice of the experiment",
    remedy: "give a finite force",
};

impl<R: Real> Plant<R> {
    /// What the hysteresis of each actuator remembers at the start in a state; none for one that starts relaxed.
    ///
    /// # Errors
    /// [`Error::Table`] unless there is an entry for each actuator, or none at all; [`Error::Misuse`] where there is no
    /// hysteresis; [`Error::Inconsistent`] for a force that it cannot hold.
    pub(crate) fn start_memories(
        &self,
        start: &PlantStart<R>,
        state: &[R],
        lengths: &[R],
    ) -> Result<Vec<Option<Memory<R>>>, Error> {
        let count = self.actuators.len();
        if !start.friction.is_empty() && start.friction.len() != count {
            return Err(Error::Table {
                name: "initial.friction",
                problem: "there is not one entry for each actuator",
                entry: start.friction.len().min(count) + 1,
                remedy: "give as many entries as there are actuators, or none",
            });
        }
        let of = |i: usize| {
            let initial = start.friction.get(i).copied().unwrap_or_default();
            memory_of(&self.actuators[i].actuator, initial, lengths[i], state[self.places.actuators[i].pressure])
        };
        (0..count).map(of).collect()
    }
}

/// What the hysteresis of an actuator remembers that starts at a length (m) and an absolute pressure (Pa).
fn memory_of<R: Real>(
    actuator: &Actuator<R>,
    initial: InitialFriction<R>,
    length: R,
    pressure: R,
) -> Result<Option<Memory<R>>, Error> {
    if matches!(initial, InitialFriction::Relaxed) {
        return Ok(None);
    }
    let Some(law) = actuator.friction().hysteresis() else {
        return Err(Error::Misuse {
            what: "a start of friction is given, but dry friction without hysteresis remembers nothing: at rest the \
                   balance decides what it holds, in motion the velocity",
            remedy: "leave it relaxed, or give actuator.friction.hysteresis",
        });
    };
    let length = actuator.limits().actuator_length(length);
    if let InitialFriction::Held(force) = initial {
        let stiffness = actuator.normal_load(length, pressure, ThreadContact::ByPressure).secant_stiffness();
        return holding(law, length, stiffness, force).map(Some);
    }
    Ok(initial.direction().map(|direction| law.slid(length, direction)))
}

/// Force in N that hysteresis and viscoelastic branches add to the tension of an actuator that starts at a length (m) and an
/// absolute pressure (Pa).
pub(super) fn force_at_start<R: Real>(
    actuator: &Actuator<R>,
    initial: InitialFriction<R>,
    length: R,
    pressure: R,
) -> R {
    let length = actuator.limits().actuator_length(length);
    let slid = actuator.friction().hysteresis().zip(initial.direction());
    let width = slid.map(|(law, direction)| law.width(&law.slid(length, direction), length, R::zero()));
    let given = if let InitialFriction::Held(force) = initial { force } else { R::zero() };
    let branches = actuator.friction().viscoelastic();
    let sums = branches.map(|law| {
        let relaxed: [R; MAX_BRANCHES] = core::array::from_fn(|branch| length - law.initial_stretch(branch));
        law.sums(&relaxed[..law.count()])
    });
    let at_rest = SlidingState { direction: R::zero(), width, force: None, touch: ThreadContact::ByPressure };
    let pressing = actuator.normal_load(length, pressure, ThreadContact::ByPressure);
    given + at_rest.with_branches(branches, length, sums).held_force(pressing).unwrap_or_else(R::zero)
}

/// The memory of a law that holds a force in N at a secant stiffness in N/m.
fn holding<R: Real>(law: &Hysteresis<R>, length: R, stiffness: R, force: R) -> Result<Memory<R>, Error> {
    INITIAL_FRICTION_FORCE.check(force.value())?;
    let most = stiffness * law.widest(length);
    if force.value().abs() > most.value() {
        return Err(Error::Inconsistent {
            parameter: &INITIAL_FRICTION_FORCE,
            value: force.value(),
            requirement: Requirement {
                relation: "must be, without its sign, at most",
                other: "what the hysteresis holds at the initial length and pressure,",
                value: most.value(),
                unit: "N",
            },
            remedy: "give a smaller force, or start on the loading or the unloading branch",
        });
    }
    if force.value() == 0.0 {
        return Ok(Memory::relaxed(length));
    }
    Ok(law.holding(length, force / stiffness))
}
