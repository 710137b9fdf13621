//! The entry points of the engines, each instantiated once for `f64`, in this crate.
//!
//! The engines are generic over their scalar, because dual numbers go through them as well. A generic function is compiled
//! again in every crate that calls it, and an engine is much to compile. So each entry point that other crates call goes
//! through a method of [`Instantiate`], whose body for `f64` is an ordinary function: it is compiled with this crate, and its
//! callers only link to it. For dual numbers the same bodies are generic, since only the caller knows the width.
//!
//! What is called in an inner loop has no entry point, so that the compiler may inline it.

use crate::error::Error;
use crate::scalar::Real;
use crate::simulation::fixed_step::Walk;
use crate::simulation::piped::Stepped;
use crate::simulation::timetable::Timetable;
use crate::simulation::{Method, Rig, Sample};
#[cfg(feature = "alloc")]
use crate::{
    air::Flow,
    command::{Driver, PlantMeasurement},
    plant::{
        JointPlant, JointTrajectory, Plant, PlantMode, PlantReader, PlantRun, PlantSample, PlantStart, PlantTrajectory,
    },
    simulation::{
        AcceptedStep, CircuitAudit, Consumer, EnergyAudit, JointRig, JointSample, JointState, Ledger, Mode, RunEnd,
        State, Trajectory,
        joint::kernel::Held,
        run::Simulation,
        trajectory::{Kept, generic_simulate},
    },
    valve::Demand,
};
#[cfg(feature = "alloc")]
use alloc::vec::Vec;

/// Calls `watch` with a time in s now and then; its error ends a run.
#[cfg(feature = "alloc")]
type Watch<'w> = &'w mut dyn FnMut(f64) -> Result<(), Error>;

/// Declares the entry points and their three implementations, those with an attribute under that condition.
macro_rules! entry_points {
    (
        $(
            $(#[$condition:meta])?
            fn $name:ident $(<$life:lifetime>)? ($($argument:ident: $type:ty),* $(,)?) $(-> $result:ty)? = $body:expr;
        )*
    ) => {
        /// Entry points of the engines. Every [`Real`] has them; only the engines call them.
        #[allow(private_interfaces, reason = "only the engines call them")]
        pub trait Instantiate: Sized {
            $($(#[$condition])? fn $name $(<$life>)? ($($argument: $type),*) $(-> $result)? where Self: Real;)*
        }

        // Ordinary functions, compiled here.
        #[allow(private_interfaces, reason = "as in the trait")]
        impl Instantiate for f64 {
            $($(#[$condition])? #[inline(never)] fn $name $(<$life>)? ($($argument: $type),*) $(-> $result)? { $body })*
        }

        // Compiled where they are called, as few do.
        #[allow(private_interfaces, reason = "as in the trait")]
        impl Instantiate for f32 {
            $($(#[$condition])? #[inline] fn $name $(<$life>)? ($($argument: $type),*) $(-> $result)? { $body })*
        }

        #[allow(private_interfaces, reason = "as in the trait")]
        impl<S: Real, const K: usize> Instantiate for crate::Dual<S, K> {
            $($(#[$condition])? fn $name $(<$life>)? ($($argument: $type),*) $(-> $result)? { $body })*
        }
    };
}

entry_points! {
    #[cfg(feature = "alloc")]
    fn start_plant(plant: &Plant<Self>, start: &PlantStart<Self>) -> Result<Vec<Self>, Error> =
        plant.start_with_memories(start).map(|(state, _)| state);
    #[cfg(feature = "alloc")]
    fn begin_plant_run(
        plant: &Plant<Self>, start: &PlantStart<Self>, relative_tolerance: f64, drivers: Vec<Driver<Self>>
    ) -> Result<PlantRun<Self>, Error> = PlantRun::generic_begin(plant, start, relative_tolerance, drivers);
    #[cfg(feature = "alloc")]
    fn measure_plant_run(run: &PlantRun<Self>) -> PlantMeasurement<Self> = run.generic_measurement();
    #[cfg(feature = "alloc")]
    fn set_plant_valve(run: &mut PlantRun<Self>, valve: usize, demand: Demand<Self>) -> Result<(), Error> =
        run.generic_set(valve, demand);
    #[cfg(feature = "alloc")]
    fn set_plant_rates(run: &mut PlantRun<Self>, mechanism: usize, rates: &[Self]) -> Result<(), Error> =
        run.generic_set_rates(mechanism, rates);
    #[cfg(feature = "alloc")]
    fn advance_plant_run(run: &mut PlantRun<Self>, until: Self) -> Result<(), Error> =
        run.extend(until, &mut |_| Ok(()));
    #[cfg(feature = "alloc")]
    fn record_plant_run(
        run: &mut PlantRun<Self>, until: Self, watch: Watch<'_>
    ) -> Result<PlantTrajectory<Self>, Error> = PlantTrajectory::record(run, until, watch);
    #[cfg(feature = "alloc")]
    fn read_plant_state<'t>(trajectory: &'t PlantTrajectory<Self>, time: Self) -> (Vec<Self>, &'t PlantMode<Self>) =
        trajectory.generic_at(time);
    #[cfg(feature = "alloc")]
    fn new_plant_sample(plant: &Plant<Self>) -> PlantSample<Self> = PlantSample::generic_new(plant);
    #[cfg(feature = "alloc")]
    fn new_plant_reader<'t>(trajectory: &'t PlantTrajectory<Self>) -> PlantReader<'t, Self> =
        PlantReader::generic_new(trajectory);
    #[cfg(feature = "alloc")]
    fn read_plant_sample(reader: &mut PlantReader<'_, Self>, time: Self, sample: &mut PlantSample<Self>) =
        reader.generic_read_into(time, sample);

    #[cfg(feature = "alloc")]
    fn new_joint_plant(rig: &JointRig<Self>) -> Result<JointPlant<Self>, Error> = JointPlant::generic_new(rig);
    #[cfg(feature = "alloc")]
    fn record_joint(
        joint: &JointPlant<Self>, state: &JointState<Self>, span: (Self, f64), driver: Option<Driver<Self>>, watch: Watch<'_>
    ) -> Result<JointTrajectory<Self>, Error> = joint.generic_record(state, span, driver, watch);
    #[cfg(feature = "alloc")]
    fn read_joint_sample(joint: &JointPlant<Self>, of: &PlantSample<Self>) -> JointSample<Self> = joint.generic_sample(of);
    #[cfg(feature = "alloc")]
    fn step_joint(
        rig: &JointRig<Self>, method: Method, span: (Self, Self), state: &[Self; 6], held: &Held<Self>
    ) -> [Self; 6] = rig.generic_take_tenable(method, span, state, held);

    #[cfg(feature = "alloc")]
    fn simulate_rig(
        rig: &Rig<Self>, start: State<Self>, span: (Self, f64), watch: Watch<'_>
    ) -> Result<Trajectory<Self>, Error> = generic_simulate(rig, start, span, watch);
    #[cfg(feature = "alloc")]
    fn begin_simulation(rig: Rig<Self>, start: State<Self>, relative_tolerance: f64) -> Result<Simulation<Self>, Error> =
        Simulation::generic_begin(rig, start, relative_tolerance);
    #[cfg(feature = "alloc")]
    fn extend_simulation(
        simulation: &mut Simulation<Self>, until: Self, consumer: &mut Consumer<'_, Self>
    ) -> Result<(), Error> = simulation.generic_extend(until, consumer);
    #[cfg(feature = "alloc")]
    fn resume_simulation(simulation: &mut Simulation<Self>, state: State<Self>) = simulation.generic_resume(state);
    #[cfg(feature = "alloc")]
    fn sample_simulation(simulation: &Simulation<Self>) -> Sample<Self> = simulation.generic_reached();
    #[cfg(feature = "alloc")]
    fn keep_step(kept: &mut Kept<Self>, step: &AcceptedStep<'_, Self>, watch: Watch<'_>) -> Result<(), Error> =
        kept.generic_take(step, watch);
    #[cfg(feature = "alloc")]
    fn finish_kept(
        kept: Kept<Self>, simulation: Simulation<Self>, watch: Watch<'_>
    ) -> Result<Trajectory<Self>, Error> = kept.generic_finish(simulation, watch);
    #[cfg(feature = "alloc")]
    fn read_accepted_step(step: &AcceptedStep<'_, Self>, time: Self) -> Sample<Self> = step.generic_at(time);
    #[cfg(feature = "alloc")]
    fn quadrature_of_step(step: &AcceptedStep<'_, Self>, visit: &mut dyn FnMut(Self, &Sample<Self>, &Mode)) =
        step.generic_quadrature(visit);
    #[cfg(feature = "alloc")]
    fn valve_flows_of_step(step: &AcceptedStep<'_, Self>, visit: &mut dyn FnMut(Self, [Flow<Self>; 2])) =
        step.generic_valve_flows(visit);
    #[cfg(feature = "alloc")]
    fn read_trajectory(trajectory: &Trajectory<Self>, last: &mut Option<usize>, time: Self) -> Sample<Self> =
        trajectory.generic_read(last, time);
    #[cfg(feature = "alloc")]
    fn read_line(trajectory: &Trajectory<Self>, time: Self) -> Vec<Self> = trajectory.generic_line_at(time);
    #[cfg(feature = "alloc")]
    fn read_bristles(trajectory: &Trajectory<Self>, time: Self) -> Option<Self> = trajectory.generic_bristles_at(time);
    #[cfg(feature = "alloc")]
    fn ranges_of_trajectory(trajectory: &Trajectory<Self>) -> [(f64, f64); 4] = trajectory.generic_ranges();
    #[cfg(feature = "alloc")]
    fn replay_trajectory(
        trajectory: &Trajectory<Self>, consumer: &mut Consumer<'_, Self>
    ) -> Result<RunEnd<Self>, Error> = trajectory.generic_replay(consumer);
    #[cfg(feature = "alloc")]
    fn add_to_ledger(ledger: &mut Ledger<Self>, step: &AcceptedStep<'_, Self>) = ledger.generic_step(step);
    #[cfg(feature = "alloc")]
    fn finish_ledger(ledger: Ledger<Self>, end: &RunEnd<Self>) -> (EnergyAudit, Option<CircuitAudit>) =
        ledger.generic_finish(end);

    fn advance_walk(
        walk: &mut Walk<Self>, rig: &Rig<Self>, timetable: &Timetable<'_, <Self as Real>::Time>, method: Method,
        to: (<Self as Real>::Time, &mut Option<Stepped<Self>>)
    ) -> Result<(), Error> = walk.generic_advance_to(rig, timetable, method, to);
    fn pass_walk(walk: &mut Walk<Self>, rig: &Rig<Self>, timetable: &Timetable<'_, <Self as Real>::Time>) =
        walk.generic_pass(rig, timetable);
    fn sample_walk(walk: &Walk<Self>, rig: &Rig<Self>) -> Sample<Self> = walk.generic_sample(rig);
}
