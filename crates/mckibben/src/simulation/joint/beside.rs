//! The states of a joint beside its six: what is not there has none.
//!
//! | states | of | unit |
//! |---|---|---|
//! | p | beyond the port of each proportional pressure regulator ([`regulated`](crate::simulation::regulated)) | Pa, absolute |
//! | z | the bristles of LuGre's law in each actuator | m |
//!
//! Their parts of the mode are the set point in force and the branch of each regulator's rate. How far seats that take their
//! time, or a spool, are open is known over time and no state.

use super::JointRig;
use super::system::{JointPhase, JointSystem, PRESSURE, VELOCITY};
use crate::scalar::{Over, Real};
use crate::simulation::member::{Member, Trace};
use crate::simulation::mode::{Extent, Guard};
use crate::simulation::regulated::{PortMode, RegulatedPort};
use crate::simulation::system::{self, GuardForm};
use crate::simulation::zones::{Places, Through};

/// States of a joint with seats that are whole or under way, and without bristles.
pub(super) const PLAIN: usize = 6;
/// The most states that a joint may have.
#[cfg(feature = "alloc")]
pub(super) const MOST: usize = PLAIN + 4;

type Room<const N: usize> = system::Room<N, PLAIN>;

/// Which states there are beside the six, and where.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beside<'a, R> {
    ports: [Option<RegulatedPort<'a, R>>; 2],
    bristles: [Option<usize>; 2],
    /// How many states there are, the six included.
    pub(super) states: usize,
}

impl<'a, R: Real> Beside<'a, R> {
    pub(super) fn new(rig: &'a JointRig<R>) -> Self {
        let mut states = PLAIN;
        let ports = rig.driven().each_ref().map(|driven| {
            let port = RegulatedPort::new(driven.actuation.as_ref(), &driven.actuator, states);
            states += usize::from(port.is_some());
            port
        });
        let bristles = rig.driven().each_ref().map(|driven| {
            driven.actuator.friction().lugre().map(|_| {
                states += 1;
                states - 1
            })
        });
        Self { ports, bristles, states }
    }
}

impl<R: Real> JointSystem<'_, R> {
    /// How many states there are.
    pub(super) fn states_of<const N: usize>(&self) -> usize {
        if Room::<N>::BESIDE { self.beside.states } else { N }
    }

    fn port<const N: usize>(&self, i: usize) -> Option<&RegulatedPort<'_, R>> {
        if Room::<N>::BESIDE { self.beside.ports[i].as_ref() } else { None }
    }

    /// The states beside the six at the start: the bristles straight, a regulator at rest.
    pub(super) fn start_beside<const N: usize>(&self, state: &mut [R; N]) {
        for i in 0..2 {
            if let (Some(port), Some(valve)) = (self.port::<N>(i), self.members[i].actuator.valve()) {
                state[port.place] = RegulatedPort::start(valve, state[PRESSURE[i]]);
            }
        }
    }

    /// Deflection in m of an actuator's bristles, if it has such.
    #[inline(always)]
    pub(super) fn bristles<T: Copy, const N: usize>(&self, i: usize, state: &[T; N]) -> Option<T> {
        if Room::<N>::BESIDE { self.beside.bristles[i].map(|place| state[place]) } else { None }
    }

    /// The pressure that feeds a valve, where a regulator makes it.
    #[inline(always)]
    pub(super) fn feed<T: Copy, const N: usize>(&self, i: usize, state: &[T; N]) -> Option<T> {
        self.port::<N>(i).map(|port| state[port.place])
    }

    /// Places of the pressures that an actuator's air depends on.
    pub(super) fn places<const N: usize>(&self, i: usize) -> Places {
        Places { supply: self.port::<N>(i).map(|port| port.place), ..Places::direct(PRESSURE[i]) }
    }

    /// What a valve lets through at a time in s.
    #[inline(always)]
    pub(super) fn through<'m, T: Over<R>, const N: usize>(
        &self,
        i: usize,
        time: T,
        state: &[T; N],
        phase: &'m JointPhase<R>,
    ) -> Through<'m, T> {
        let (mode, shares) = (&phase.mode.actuators[i], phase.openings[i].at(time));
        Through { mode, shares, feed: self.feed(i, state) }
    }

    /// What the hysteresis of an actuator remembers.
    #[inline(always)]
    pub(super) fn remembered<'t, T: Copy, const N: usize>(
        &self,
        i: usize,
        state: &[T; N],
        traces: &'t [Option<Trace<R>>; 2],
    ) -> (&'t Option<Trace<R>>, Option<T>) {
        (&traces[i], self.bristles(i, state))
    }

    /// The rates of the states beside the six, while the joint turns at an angular velocity in rad/s.
    pub(super) fn rates_beside<T: Over<R>, const N: usize>(
        &self,
        state: &[T; N],
        (velocity, slopes): (T, [T; 2]),
        phase: &JointPhase<R>,
        rates: &mut [T; N],
    ) {
        if !Room::<N>::BESIDE {
            return;
        }
        for i in 0..2 {
            if let Some(port) = self.port::<N>(i) {
                rates[port.place] = port.rate(state, &phase.port[i]);
            }
            let mode = &phase.mode.actuators[i];
            if let (Some(place), Some(law)) = (self.beside.bristles[i], self.members[i].lugre())
                && mode.extent != Extent::Slack
            {
                rates[place] = law.rate(state[place], slopes[i] * velocity, T::constant(mode.sliding.direction()));
            }
        }
    }

    /// The fastest rate in 1/s at which one of the states beside the six settles, and the joint against its bristles; `slope`
    /// gives that of a state's rate by the state itself.
    pub(super) fn settling_beside<const N: usize>(
        &self,
        state: &[R; N],
        phase: &JointPhase<R>,
        slope: impl Fn(usize) -> f64,
    ) -> f64 {
        let mut fastest = 0.0_f64;
        if Room::<N>::BESIDE {
            for i in 0..2 {
                let port = self.port::<N>(i).map_or(0.0, |port| port.settling_rate(state, &phase.port[i]));
                let bent = self.beside.bristles[i].map_or(0.0, |place| (-slope(place)).max(-slope(VELOCITY)));
                fastest = fastest.max(port).max(bent);
            }
        }
        fastest
    }

    pub(super) fn scales_beside<const N: usize>(&self, state: &[R; N], scales: &mut [f64; N]) {
        for (i, Member { atmosphere, .. }) in self.members.iter().enumerate() {
            if let Some(port) = self.port::<N>(i) {
                scales[port.place] = state[port.place].value().abs() + 0.1 * atmosphere;
            }
            if let (true, Some(place), Some(law)) =
                (Room::<N>::BESIDE, self.beside.bristles[i], self.members[i].lugre())
            {
                scales[place] = state[place].value().abs() + law.reach().value();
            }
        }
    }

    /// The next instant in s at which a set point takes effect, up to and with `until`.
    pub(super) fn next_set_point<const N: usize>(&self, phase: &JointPhase<R>, until: R) -> Option<R> {
        let next = [0, 1].map(|i| self.port::<N>(i)?.next(&phase.port[i], until));
        next.into_iter().flatten().min_by(|a, b| a.value().total_cmp(&b.value()))
    }

    /// Lets the set points of one regulator up to and with `time` take effect; which actuator's that was.
    pub(super) fn pass_set_points<const N: usize>(
        &self,
        time: R,
        state: &[R; N],
        ports: &mut [PortMode; 2],
    ) -> Option<usize> {
        (0..2).find(|&i| self.port::<N>(i).is_some_and(|port| port.pass(time, state, &mut ports[i])))
    }

    /// The guard of a regulator whose rate is at its limit.
    pub(super) fn rate_limit<const N: usize>(&self, i: usize, phase: &JointPhase<R>) -> Option<GuardForm> {
        self.port::<N>(i)?.guard_form(&phase.port[i])
    }

    /// Value of a guard of a regulated pressure; `None` for one that is not.
    pub(super) fn guard_beside<T: Over<R>, const N: usize>(
        &self,
        (i, guard): (usize, Guard),
        state: &[T; N],
        phase: &JointPhase<R>,
    ) -> Option<T> {
        let port = self.port::<N>(i)?;
        match guard {
            Guard::RateLimit => port.guard(state, &phase.port[i]),
            Guard::SupplyDown | Guard::SupplyUp => {
                self.members[i].supply_guard(guard, &phase.mode.actuators[i], [state[PRESSURE[i]], state[port.place]])
            }
            _ => None,
        }
    }

    /// The force of the hysteresis of an actuator over its secant stiffness in m, and the part of it that dissipates, in
    /// magnitude.
    #[cfg(feature = "alloc")]
    pub(super) fn widths<const N: usize>(&self, i: usize, state: &[R; N], phase: &JointPhase<R>) -> [R; 2] {
        let [length, velocity, _] = self.ends(i, state, phase.mode.arm_pieces);
        match (self.bristles(i, state), self.members[i].lugre()) {
            (Some(bent), Some(law)) => {
                let direction = R::constant(phase.mode.actuators[i].sliding.direction());
                [law.width_at(bent, velocity, direction), law.dissipating(bent, velocity, direction)]
            }
            _ => Trace::widths(&phase.traces[i], length),
        }
    }
}
