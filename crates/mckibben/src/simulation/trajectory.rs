//! A stored trajectory: samples at any time, the log of events, and what it cost.

use super::hybrid::{Phase, RigSystem};
use super::integrator::{Counts, Piece};
use super::mode::{EventKind, Mode};
use super::plumbing::MOST;
use super::rig::{Rig, State};
use super::sample::{Sample, SampleTimes};
use super::stored::Stored;
use super::zones::Places;
use crate::air::Flow;
use crate::error::Error;
use crate::parameter;
use crate::pressure::GaugePressure;
use crate::scalar::Real;
use alloc::boxed::Box;
use alloc::vec::Vec;

/// A change of mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event<R = f64> {
    /// When, in s.
    pub time: R,
    /// What happened.
    pub kind: EventKind,
    /// The mode before.
    pub before: Mode,
    /// The mode after.
    pub after: Mode,
}

/// A simulated stretch of time.
#[derive(Clone, Debug)]
pub struct Trajectory<R: Real = f64> {
    rig: Rig<R>,
    relative_tolerance: f64,
    run: Run<R>,
    events: Vec<Event<R>>,
}

/// The run of a rig with `N` states.
type Of<R, const N: usize> = Stored<R, Phase<R>, EventKind, N>;

/// A run of a rig alone, or with an air line, bristles or a tendon in series.
#[derive(Clone, Debug)]
enum Run<R: Real> {
    Rig(Of<R, 4>),
    Line(Box<Of<R, MOST>>),
}

/// Does the same with a run of either kind.
macro_rules! with_run {
    ($run:expr, $stored:ident => $do:expr) => {
        match $run {
            Run::Rig($stored) => $do,
            Run::Line($stored) => $do,
        }
    };
}

/// Simulates a rig from a state at t = 0 for `duration` s, every event located, with `relative_tolerance` for each step.
///
/// # Errors
/// [`Error::OutOfRange`] for a duration or tolerance outside its range; [`Error::Stopped`] when the simulation cannot
/// reach its end: it says when, where and what to change.
pub fn simulate<R: Real>(
    rig: &Rig<R>,
    start: State<R>,
    duration: R,
    relative_tolerance: f64,
) -> Result<Trajectory<R>, Error> {
    simulate_watched(rig, start, duration, relative_tolerance, |_| Ok(()))
}

/// The same as [`simulate`], calling `watch` with the time in s that has been reached, now and then: it may show it, or end the run by
/// an error such as [`Error::Interrupted`].
///
/// # Errors
/// As [`simulate`], and those of `watch`.
pub fn simulate_watched<R: Real>(
    rig: &Rig<R>,
    start: State<R>,
    duration: R,
    relative_tolerance: f64,
    mut watch: impl FnMut(f64) -> Result<(), Error>,
) -> Result<Trajectory<R>, Error> {
    parameter::DURATION.check(duration.value())?;
    let mut trajectory = Trajectory::begin(rig.clone(), start, relative_tolerance)?;
    trajectory.extend(duration, &mut watch)?;
    Ok(trajectory)
}

/// Writes what ended a piece into a log.
fn log<R: Real, const N: usize>(events: &mut Vec<Event<R>>, piece: &Piece<R, Phase<R>, EventKind, N>) {
    if let Some((kind, after)) = piece.event {
        events.push(Event { time: piece.end, kind, before: piece.mode.mode, after: after.mode });
    }
}

/// In the making: in parts, between which the rig's command may be continued.
impl<R: Real> Trajectory<R> {
    /// Nothing yet, at t = 0 in a state.
    pub(super) fn begin(rig: Rig<R>, start: State<R>, relative_tolerance: f64) -> Result<Self, Error> {
        parameter::RELATIVE_TOLERANCE.check(relative_tolerance)?;
        rig.check_located(&start)?;
        let system = RigSystem::new(&rig, relative_tolerance);
        let beside = rig.actuator().friction().lugre().is_some() || rig.tendon().is_some();
        let run = match rig.has_plumbing() || beside {
            false => Run::Rig(begin(&system, start)),
            true => Run::Line(Box::new(begin(&system, start))),
        };
        Ok(Self { rig, relative_tolerance, run, events: Vec::new() })
    }

    /// Goes on to `until` s.
    pub(super) fn extend(&mut self, until: R, watch: &mut dyn FnMut(f64) -> Result<(), Error>) -> Result<(), Error> {
        let system = RigSystem::new(&self.rig, self.relative_tolerance);
        let events = &mut self.events;
        with_run!(&mut self.run, stored => {
            stored.extend(&system, until, self.relative_tolerance, &mut |piece| log(events, piece), watch)
        })
    }

    /// The four states at the time that has been reached.
    pub(super) fn state_reached(&self) -> State<R> {
        with_run!(&self.run, stored => State::from_array(four(stored.reached().1)))
    }

    /// Goes on from other states; valve, command and a pressure that is given go on as they were. For a rig without an air line
    /// or a memory.
    pub(super) fn resume(&mut self, mut state: State<R>) {
        let system = RigSystem::new(&self.rig, self.relative_tolerance);
        with_run!(&mut self.run, stored => {
            let (time, _, phase) = *stored.reached();
            if let Some([gauge, _]) = system.given(time, &phase) {
                state.pressure = GaugePressure(gauge).absolute(self.rig.actuator().air().atmosphere());
            }
            let state = system.start(state);
            stored.resume(state, system.resume(time, &state, &phase));
        });
    }

    /// The sample at the time that has been reached.
    pub(super) fn reached(&self) -> Sample<R> {
        let system = RigSystem::new(&self.rig, self.relative_tolerance);
        with_run!(&self.run, stored => {
            let (time, state, phase) = stored.reached();
            sample(&system, *time, state, phase)
        })
    }

    /// The rig, to be told more.
    pub(super) fn rig_mut(&mut self) -> &mut Rig<R> {
        &mut self.rig
    }
}

/// The run of a system with `N` states at its start.
fn begin<R: Real, const N: usize>(system: &RigSystem<'_, R>, start: State<R>) -> Of<R, N> {
    let state = system.start(start);
    Stored::begin(state, system.begin(&state))
}

impl<R: Real> Trajectory<R> {
    /// The rig that was simulated.
    pub fn rig(&self) -> &Rig<R> {
        &self.rig
    }

    /// The events in order of time.
    pub fn events(&self) -> &[Event<R>] {
        &self.events
    }

    /// Steps, evaluations and events.
    pub fn counts(&self) -> Counts {
        with_run!(&self.run, stored => stored.counts())
    }

    /// End of the trajectory in s.
    pub fn duration(&self) -> R {
        with_run!(&self.run, stored => stored.duration())
    }

    fn system(&self) -> RigSystem<'_, R> {
        RigSystem::new(&self.rig, self.relative_tolerance)
    }

    /// The sample at `time` in s, by dense output; at the instant of an event, after it. Times before the start and
    /// after the end give the first and the last sample.
    pub fn at(&self, time: R) -> Sample<R> {
        let system = self.system();
        with_run!(&self.run, stored => {
            let (time, state, phase) = stored.at(&system, stored.begun(time.value()), time);
            sample(&system, time, &state, &phase)
        })
    }

    /// Samples at `0, interval, 2 interval, …` and at the end, interval in s above zero.
    pub fn samples(&self, interval: f64) -> impl Iterator<Item = Sample<R>> + '_ {
        let system = self.system();
        let times = SampleTimes::new(self.duration().value(), interval);
        let mut place = 0;
        (0..=times.last()).map(move |index| {
            let time = times.time(index);
            with_run!(&self.run, stored => {
                place = stored.begun_after(place, time);
                let (time, state, phase) = stored.at(&system, place, R::constant(time));
                sample(&system, time, &state, &phase)
            })
        })
    }

    /// Reads the rig's four states at times in s that do not fall from one call to the next.
    pub(super) fn states(&self) -> impl FnMut(f64) -> [R; 4] + '_ {
        let system = self.system();
        let mut place = 0;
        move |time| {
            with_run!(&self.run, stored => {
                place = stored.begun_after(place, time);
                four(stored.at(&system, place, R::constant(time)).1)
            })
        }
    }

    /// The states of the air line at `time` in s, in the order of its parts: the pressures (Pa, absolute) of the hose's
    /// volumes from the valve on, the flows (kg/s) out of the cells of a distributed hose, the pressures of reservoir and
    /// regulator, or of a regulated port. As far as there are such parts.
    pub fn line_at(&self, time: R) -> Vec<R> {
        let system = self.system();
        with_run!(&self.run, stored => {
            let (_, state, _) = stored.at(&system, stored.begun(time.value()), time);
            state[4..system.line_states()].to_vec()
        })
    }

    /// The deflection in m of the bristles of LuGre's law at `time` in s, if that is the rig's friction.
    pub fn bristles_at(&self, time: R) -> Option<R> {
        let system = self.system();
        with_run!(&self.run, stored => {
            let (_, state, _) = stored.at(&system, stored.begun(time.value()), time);
            system.bristles(&state)
        })
    }

    /// The least and the greatest value of each of the rig's four states, at five points of each step: length in m, velocity
    /// in m/s, absolute pressure in Pa, mass of the air in kg.
    pub fn ranges(&self) -> [(f64, f64); 4] {
        with_run!(&self.run, stored => four(stored.ranges()))
    }

    /// Calls `visit` with the weight in s, the sample and the mode at the Gauss points of each step: `Σ weight · f` is the
    /// integral of f over the trajectory, to the order of the dense output.
    pub fn quadrature(&self, mut visit: impl FnMut(R, &Sample<R>, &Mode)) {
        self.visit(|weight, sample, phase, _, _| visit(weight, sample, &phase.mode));
    }

    /// Calls `visit` with the weight in s and the flows through the valve's passages to the supply and to the surroundings,
    /// into hose or actuator, at the Gauss points of each step. What flows out to a pressure regulator it lets go to the
    /// surroundings.
    pub fn valve_flows(&self, mut visit: impl FnMut(R, [Flow<R>; 2])) {
        let system = self.system();
        with_run!(&self.run, stored => stored.quadrature(&system, |weight, time, state, phase| {
            visit(weight, system.valve_flows(time, state, phase));
        }));
    }

    /// As [`Trajectory::quadrature`], with the phase, the flow between the rig, its hose included, and the supply or the
    /// surroundings, and the widths of the hysteresis.
    pub(super) fn visit(&self, mut visit: impl FnMut(R, &Sample<R>, &Phase<R>, &Flow<R>, [R; 2])) {
        let system = self.system();
        with_run!(&self.run, stored => stored.quadrature(&system, |weight, time, state, phase| {
            let flow = system.exchange(time, state, phase);
            visit(weight, &sample(&system, time, state, phase), phase, &flow, system.widths(time, state, phase));
        }));
    }

    /// Air in kg that the hose gained.
    pub(super) fn hose_gain(&self) -> R {
        let system = self.system();
        with_run!(&self.run, stored => {
            let content = |time: R| {
                let (_, state, _) = stored.at(&system, stored.begun(time.value()), time);
                system.hose_content(&state)
            };
            content(self.duration()) - content(R::zero())
        })
    }
}

/// The first four of the states.
fn four<T: Copy, const N: usize>(states: [T; N]) -> [T; 4] {
    [states[0], states[1], states[2], states[3]]
}

fn sample<R: Real, const N: usize>(system: &RigSystem<'_, R>, time: R, state: &[R; N], phase: &Phase<R>) -> Sample<R> {
    let (mode, Places { valve, supply, .. }) = (&phase.mode, system.places());
    let (tension, flow) = (system.tension(state, phase), system.inflow(time, state, phase));
    let mut own = four(*state);
    own[1] = system.velocity(time, state, phase);
    let sample = system.member().sample(time, &own, tension, mode, flow);
    let sample = sample.with_line([state[valve], system.hose_content(state)], supply.map(|place| state[place]));
    match system.far_end(state) {
        Some([load_distance, load_velocity]) => Sample { load_distance, load_velocity, ..sample },
        None => sample,
    }
}
