//! Where friction with a memory starts: relaxed, on one of its branches, or holding a force.

use super::{Plant, PlantStart};
use crate::error::{Error, Requirement};
use crate::friction::{Hysteresis, Memory, ThreadContact};
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
        let of = |i: usize| -> Result<Option<Memory<R>>, Error> {
            let initial = start.friction.get(i).copied().unwrap_or_default();
            if matches!(initial, InitialFriction::Relaxed) {
                return Ok(None);
            }
            let actuator = &self.actuators[i].actuator;
            let Some(law) = actuator.friction().hysteresis() else {
                return Err(Error::Misuse {
                    what: "a start of friction is given, but dry friction without hysteresis remembers nothing: at rest the \
                           balance decides what it holds, in motion the velocity",
                    remedy: "leave it relaxed, or give actuator.friction.hysteresis",
                });
            };
            let length = actuator.limits().actuator_length(lengths[i]);
            match initial {
                InitialFriction::Held(force) => {
                    let pressure = state[self.places.actuators[i].pressure];
                    let stiffness =
                        actuator.normal_load(length, pressure, ThreadContact::ByPressure).secant_stiffness();
                    holding(law, length, stiffness, force).map(Some)
                }
                InitialFriction::Unloading => Ok(Some(law.slid(length, -1.0))),
                _ => Ok(Some(law.slid(length, 1.0))),
            }
        };
        (0..count).map(of).collect()
    }
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
