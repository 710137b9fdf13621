//! A muscle on an elastic tendon, and the same written out.

use super::{ATMOSPHERE, GRAVITY, LB, Paper, bisect, runge_kutta};
use mckibben::simulation::{Rig, SeriesTendon};
use std::f64::consts::PI;

pub(crate) const STIFFNESS: f64 = 8e3;
pub(crate) const REST: f64 = 0.05;
pub(crate) const MASS: f64 = 5.0 * LB;

pub(crate) fn on_tendon(paper: &Paper, stiffness: f64) -> Rig {
    paper.rig().with_tendon(SeriesTendon::new(stiffness, REST).expect("a tendon"))
}

/// Sealed at 3 bar, without friction.
pub(crate) fn smooth() -> Paper {
    Paper::sealed().friction(0.0, 0.0).gauge(3e5)
}

/// The paper's braid and its sealed air, written out: (3), and `P V^γ`.
pub(crate) struct Muscle {
    thread: f64,
    content: f64,
}

impl Muscle {
    pub(crate) fn of(paper: &Paper) -> Self {
        let mut muscle = Self { thread: paper.thread_length, content: 0.0 };
        let start = paper.start();
        muscle.content = start.pressure.0 * muscle.volume(start.length).powf(1.4);
        muscle
    }

    const SHARE: f64 = 4.0 * PI * 2.5 * 2.5;

    pub(crate) fn volume(&self, length: f64) -> f64 {
        length * (self.thread * self.thread - length * length) / Self::SHARE + 3e-6
    }

    pub(crate) fn pressure(&self, length: f64) -> f64 {
        self.content / self.volume(length).powf(1.4)
    }

    pub(crate) fn force(&self, length: f64) -> f64 {
        (self.pressure(length) - ATMOSPHERE) * (3.0 * length * length - self.thread * self.thread) / Self::SHARE
    }

    /// Energy in J that the gas has given off to the braid and the atmosphere, but for a constant.
    pub(crate) fn stored(&self, length: f64) -> f64 {
        let volume = self.volume(length);
        self.pressure(length) * volume / 0.4 + ATMOSPHERE * volume
    }
}

/// By the classical Runge–Kutta method: with viscous friction the actuator's length is a third state, and without it is where
/// both tensions are equal.
pub(crate) fn independent(paper: &Paper, viscous: f64, until: f64) -> [f64; 2] {
    let muscle = Muscle::of(paper);
    let start = paper.start();
    let pull = |x: f64, length: f64| STIFFNESS * (x - REST - length).max(0.0);
    let settled = |x: f64| bisect(0.07, 0.1, |length| muscle.force(length) - pull(x, length));
    let steps = 4000;
    let step = until / f64::from(steps);
    let length = |x: f64, length: f64| if viscous > 0.0 { length } else { settled(x) };
    let rates = |[x, v, l]: [f64; 3]| {
        let l = length(x, l);
        let sliding = if viscous > 0.0 { (pull(x, l) - muscle.force(l)) / viscous } else { 0.0 };
        [v, GRAVITY - pull(x, l) / MASS, sliding]
    };
    let mut state = [start.length + REST + muscle.force(start.length) / STIFFNESS, paper.velocity, start.length];
    for _ in 0..steps {
        state = runge_kutta(state, step, |_, state| rates(state));
    }
    [state[0], length(state[0], state[2])]
}
