//! A sealed muscle under a load that changes slowly, at the edge of sticking.
//!
//! Between two lengths at rest the air keeps its mass, so the pressure follows the length:
//!
//! ```text
//! P(L) = P₀ (V₀/V(L))^κ          κ of the scenario's process
//! least(L) ≤ W ≤ most(L)         F_s + F_limit ∓ Q k_sec at P(L): what friction can hold
//! ```
//!
//! A load that grows slowly does not move the end until it passes `most`, and then moves it along `W = most(L)`; one
//! that falls waits until it is below `least`, and then follows `W = least(L)`. In the limit of slow loading that is
//! the exact solution of the core's law of sticking, free of what inertia and viscous friction would add to sudden
//! steps, and of how a hand lays a weight down; so it is what is drawn. The bounds are the core's own
//! (`Rig::holdable`).
//!
//! Constant temperature is taken for an energy balance that exchanges heat, however little: loading is slow.

use mckibben::air::Process;
use mckibben::simulation::{Rig, State};

/// A sealed muscle and where it stands.
#[derive(Clone, Debug)]
pub(super) struct SealedMuscle<'a> {
    rig: &'a Rig,
    /// `P V^κ`, which stays.
    constant: f64,
    index: f64,
    /// The length in m.
    length: f64,
}

impl<'a> SealedMuscle<'a> {
    /// At rest in a state.
    pub(super) fn new(rig: &'a Rig, start: &State) -> Self {
        let air = rig.actuator().air();
        let index = match air.process() {
            Process::EnergyBalance { heat_transfer, .. } if heat_transfer > 0.0 => 1.0,
            _ => air.index(),
        };
        let constant = start.pressure.0 * rig.actuator().volume(start.length).powf(index);
        Self { rig, constant, index, length: start.length }
    }

    /// The start with another exponent.
    pub(super) fn with_index(rig: &'a Rig, start: &State, index: f64) -> Self {
        let constant = start.pressure.0 * rig.actuator().volume(start.length).powf(index);
        Self { rig, constant, index, length: start.length }
    }

    /// The length in m.
    pub(super) fn length(&self) -> f64 {
        self.length
    }

    /// The absolute pressure in Pa at a length in m.
    pub(super) fn pressure(&self, length: f64) -> f64 {
        self.constant / self.rig.actuator().volume(length).powf(self.index)
    }

    /// Least and largest load in N that friction holds at a length in m.
    fn holdable(&self, length: f64) -> (f64, f64) {
        self.rig.holdable(length, self.pressure(length), 0.0)
    }

    /// Force in N without friction at a length in m.
    pub(super) fn frictionless(&self, length: f64) -> f64 {
        let actuator = self.rig.actuator();
        actuator.static_force(length, self.pressure(length)) + actuator.limits().force(length, 0.0)
    }

    /// Follows a load that changes monotonically and slowly to `load` in N; returns the length in m.
    pub(super) fn load_slowly(&mut self, load: f64) -> f64 {
        let (least, most) = self.holdable(self.length);
        let limits = self.rig.actuator().limits();
        if load > most {
            let longest = self.rig.actuator().law().law.braid.thread_length();
            self.length = bisected(self.length, longest, |length| self.holdable(length).1 > load);
        } else if load < least {
            self.length = bisected(limits.min_length(), self.length, |length| self.holdable(length).0 > load);
        }
        self.length
    }

    /// The length in m at which a load in N is balanced without friction.
    pub(super) fn balance(&self, load: f64) -> f64 {
        let limits = self.rig.actuator().limits();
        let longest = self.rig.actuator().law().law.braid.thread_length();
        bisected(limits.min_length(), longest, |length| self.frictionless(length) > load)
    }
}

/// The point between two at which `beyond` becomes true, which it is at the upper one, by bisection to neighbouring numbers.
fn bisected(mut low: f64, mut high: f64, beyond: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return low;
        }
        if beyond(middle) { high = middle } else { low = middle }
    }
}

#[cfg(test)]
mod tests {
    use super::super::files;
    use super::super::units::LBF;
    use super::*;
    use mckibben::simulation::{Sliding, State, simulate};

    #[test]
    fn the_muscle_moves_at_the_edge_of_sticking_and_the_core_holds_it_there() {
        let experiment = files::experiment("fig-04-60psi.toml").unwrap();
        let mut muscle = SealedMuscle::new(&experiment.rig, &experiment.start);
        for pounds in [3.0, 9.0, 15.0, 14.9, 7.0] {
            let load = pounds * LBF;
            let length = muscle.load_slowly(load);
            let (least, most) = muscle.holdable(length);
            assert!(least <= load * (1.0 + 1e-12) && load <= most * (1.0 + 1e-12), "{pounds} lb: {least} {most}");
            // The core, started there at rest, stays there.
            let mut document = files::document("fig-04-60psi.toml").unwrap();
            document.set_text("load.mass", &format!("\"{pounds} lb\"")).unwrap();
            let rig = document.experiment().unwrap().rig;
            let pressure = mckibben::AbsolutePressure(muscle.pressure(length));
            let state = State { length, velocity: 0.0, pressure, air_mass: experiment.start.air_mass };
            let end = simulate(&rig, state, 0.1, 1e-8).unwrap().at(0.1);
            assert!((end.length - length).abs() < 1e-9, "{pounds} lb moves to {}", end.length);
        }
    }

    #[test]
    fn a_slow_extension_in_the_core_traces_the_same_branches() {
        // The same actuator pulled out slowly at both ends: tension = F_s + Q k_sec + c v, with c v negligible.
        let mut document = files::document("fig-04-60psi.toml").unwrap();
        document.remove("load.mass");
        document.remove("initial.length");
        for (key, value) in [
            ("load.kind", "\"prescribed-motion\""),
            ("load.time", "[\"0 s\", \"1000 s\"]"),
            ("load.table_length", "[\"2.4952 in\", \"3.6 in\"]"),
            ("run.duration", "\"1000 s\""),
        ] {
            document.set_text(key, value).unwrap();
        }
        let stretch = document.experiment().unwrap();
        let run = simulate(&stretch.rig, stretch.start, 1000.0, 1e-10).unwrap();
        let experiment = files::experiment("fig-04-60psi.toml").unwrap();
        let mut muscle = SealedMuscle::new(&experiment.rig, &experiment.start);
        for time in [200.0, 600.0, 999.0] {
            let sample = run.at(time);
            let viscous = experiment.rig.actuator().friction().viscous_force(sample.velocity);
            let length = muscle.load_slowly(sample.tension - viscous);
            assert!((length - sample.length).abs() < 1e-8, "{length} is not {}", sample.length);
        }
        let sliding = run.events().iter().map(|event| event.after.sliding).find(|s| *s == Sliding::Shortening);
        assert_eq!(sliding, None);
    }
}
