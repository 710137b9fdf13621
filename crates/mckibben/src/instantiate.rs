//! The entry points of the engines, each instantiated once, in this crate: for `f64`, and for
//! [`Seeded`](crate::Seeded) dual numbers.
//!
//! The engines are generic over their scalar, because dual numbers go through them as well. A generic function is compiled
//! again in every crate that calls it, and an engine is much to compile. So each entry point that other crates call goes
//! through a method of [`Instantiate`], whose bodies are ordinary functions: they are compiled with this crate, and their
//! callers only link to them. More directions than those numbers have are several runs.
//!
//! What is called in an inner loop has no entry point, so that the compiler may inline it.

#[cfg(feature = "alloc")]
use crate::error::Error;
use crate::scalar::Real;
#[cfg(feature = "alloc")]
use crate::{
    actuator::Response,
    command::{Driver, PlantMeasurement},
    plant::{
        Plant, PlantMode, PlantReader, PlantRun, PlantSample, PlantStart, PlantSteps, PlantTrajectory, TimeStepping,
    },
    simulation::Method,
    valve::Demand,
};
#[cfg(feature = "alloc")]
use alloc::vec::Vec;

/// Calls `watch` with a time in s now and then; its error ends a run.
#[cfg(feature = "alloc")]
type Watch<'w> = &'w mut dyn FnMut(f64) -> Result<(), Error>;

/// Declares the entry points and their two implementations, those with an attribute under that condition.
macro_rules! entry_points {
    (
        $(
            $(#[$condition:meta])?
            fn $name:ident $(<$life:lifetime>)? ($($argument:ident: $type:ty),* $(,)?) $(-> $result:ty)? = $body:expr;
        )*
    ) => {
        /// Numbers that the engines step: `f64`, and [`Seeded`](crate::Seeded) with the feature `derivatives`. Only the engines call
        /// what it has.
        #[allow(private_interfaces, reason = "only the engines call them")]
        pub trait Instantiate: Real {
            $($(#[$condition])? #[doc(hidden)] fn $name $(<$life>)? ($($argument: $type),*) $(-> $result)?;)*
        }

        // Ordinary functions, compiled here.
        #[allow(private_interfaces, reason = "as in the trait")]
        impl Instantiate for f64 {
            $($(#[$condition])? #[inline(never)] fn $name $(<$life>)? ($($argument: $type),*) $(-> $result)? { $body })*
        }

        #[cfg(feature = "derivatives")]
        #[allow(private_interfaces, reason = "as in the trait")]
        impl Instantiate for crate::Seeded {
            $($(#[$condition])? #[inline(never)] fn $name $(<$life>)? ($($argument: $type),*) $(-> $result)? { $body })*
        }
    };
}

entry_points! {
    #[cfg(feature = "alloc")]
    fn start_plant(plant: &Plant<Self>, start: &PlantStart<Self>) -> Result<Vec<Self>, Error> =
        plant.start_with_memories(start).map(|(state, _)| state);
    #[cfg(feature = "alloc")]
    fn begin_plant_run(
        plant: &Plant<Self>, start: &PlantStart<Self>, stepping: TimeStepping, drivers: Vec<Driver<Self>>
    ) -> Result<PlantRun<Self>, Error> = PlantRun::generic_begin(plant, start, stepping, drivers);
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
    fn begin_plant_steps(run: &PlantRun<Self>, method: Method) -> PlantSteps<Self> =
        PlantSteps::generic_begin(run, method);
    #[cfg(feature = "alloc")]
    fn advance_plant_steps(steps: &mut PlantSteps<Self>, until: Self) -> Result<(), Error> =
        steps.generic_advance_to(until);
    #[cfg(feature = "alloc")]
    fn move_plant_steps(steps: &mut PlantSteps<Self>, until: Self, distances: &[Self]) -> Result<(), Error> =
        steps.generic_move_to(until, distances);
    #[cfg(feature = "alloc")]
    fn derive_plant_steps(steps: &mut PlantSteps<Self>, rates: &mut [Self]) -> Result<(), Error> =
        steps.generic_derivative(rates);
    #[cfg(feature = "alloc")]
    fn compute_plant_steps(steps: &mut PlantSteps<Self>, actuator: usize) -> Result<Response<Self>, Error> =
        steps.generic_compute(actuator);
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
}
