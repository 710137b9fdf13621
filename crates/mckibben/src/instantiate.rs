//! The entry points of the engines, each instantiated once, in this crate: for `f64`, and for
//! [`Seeded`](crate::Seeded) dual numbers.
//!
//! The engines are generic over their scalar, because dual numbers go through them as well. A generic function is compiled
//! again in every crate that calls it, and an engine is much to compile. So each entry point that other crates call goes
//! through a method of [`Instantiate`], whose bodies are ordinary functions: they are compiled with this crate, and their
//! callers only link to them. More directions than those numbers have are several runs.
//!
//! What is called in an inner loop has no entry point, so that the compiler may inline it.

use crate::error::Error;
use crate::scalar::{Real, Scalar};
use crate::{
    actuator::Response,
    command::{Driver, PlantMeasurement},
    plant::{
        Plant, PlantMode, PlantReader, PlantRow, PlantRun, PlantSample, PlantStart, PlantSteps, PlantTrajectory,
        TimeStepping,
    },
    simulation::Method,
    valve::RuntimeCommand,
};
use alloc::vec::Vec;

/// Calls `watch` with a time in s now and then; its error ends a run.
type Watch<'w> = &'w mut dyn FnMut(f64) -> Result<(), Error>;

/// Declares the entry points and their two implementations.
macro_rules! entry_points {
    (
        $(
            fn $name:ident $(<$life:lifetime>)? ($($argument:ident: $type:ty),* $(,)?) $(-> $result:ty)? = $body:expr;
        )*
    ) => {
        /// Numbers that the engines step: `f64`, and [`Seeded`](crate::Seeded) with the feature `derivatives`. Only the engines call
        /// what it has.
        #[allow(private_interfaces, reason = "only the engines call them")]
        pub trait Instantiate: Real {
            $(#[doc(hidden)] fn $name $(<$life>)? ($($argument: $type),*) $(-> $result)?;)*
        }

        // Ordinary functions, compiled here.
        #[allow(private_interfaces, reason = "as in the trait")]
        impl Instantiate for f64 {
            $(#[inline(never)] fn $name $(<$life>)? ($($argument: $type),*) $(-> $result)? { $body })*
        }

        #[cfg(feature = "derivatives")]
        #[allow(private_interfaces, reason = "as in the trait")]
        impl Instantiate for crate::Seeded {
            $(#[inline(never)] fn $name $(<$life>)? ($($argument: $type),*) $(-> $result)? { $body })*
        }
    };
}

entry_points! {
    fn start_plant(plant: &Plant<Self>, start: &PlantStart<Self>) -> Result<Vec<Self>, Error> =
        plant.start_with_memories(start, <Self as Scalar>::zero()).map(|(state, _)| state);
    fn begin_plant_run(
        plant: &Plant<Self>, start: &PlantStart<Self>, stepping: TimeStepping, drivers: Vec<Driver<Self>>
    ) -> Result<PlantRun<Self>, Error> = PlantRun::generic_begin(plant, start, stepping, drivers);
    fn measure_plant_run(run: &PlantRun<Self>) -> PlantMeasurement<Self> = run.generic_measurement();
    fn set_plant_valve(run: &mut PlantRun<Self>, valve: usize, commanded: RuntimeCommand<Self>) -> Result<(), Error> =
        run.generic_set(valve, commanded);
    fn set_plant_rates(run: &mut PlantRun<Self>, mechanism: usize, rates: &[Self]) -> Result<(), Error> =
        run.generic_set_rates(mechanism, rates);
    fn advance_plant_run(run: &mut PlantRun<Self>, until: Self) -> Result<(), Error> =
        run.extend(until, &mut |_| Ok(()));
    fn begin_plant_row(run: &PlantRun<Self>, method: Method) -> PlantRow<Self> =
        PlantRow::generic_begin(run, method);
    fn take_on_plant_row(row: PlantRow<Self>) -> PlantSteps<Self> = PlantSteps::generic_of_row(row);
    fn adapt_plant_steps(steps: &mut PlantSteps<Self>) = steps.generic_adapt();
    fn advance_plant_steps(steps: &mut PlantSteps<Self>, until: Self) -> Result<(), Error> =
        steps.generic_advance_to(until);
    fn move_plant_steps(steps: &mut PlantSteps<Self>, until: Self, distances: &[Self]) -> Result<(), Error> =
        steps.generic_move_to(until, distances);
    fn size_plant_steps(steps: &mut PlantSteps<Self>) -> usize = steps.generic_state_size();
    fn save_plant_steps(steps: &mut PlantSteps<Self>, numbers: &mut [Self]) -> Result<(), Error> =
        steps.generic_save_to(numbers);
    fn restore_plant_steps(steps: &mut PlantSteps<Self>, numbers: &[Self]) -> Result<(), Error> =
        steps.generic_restore_from(numbers);
    fn derive_plant_steps(steps: &mut PlantSteps<Self>, rates: &mut [Self]) -> Result<(), Error> =
        steps.generic_derivative(rates);
    fn compute_plant_steps(steps: &mut PlantSteps<Self>, actuator: usize) -> Result<Response<Self>, Error> =
        steps.generic_compute(actuator);
    fn compute_plant_steps_at(
        steps: &mut PlantSteps<Self>, distances: &[Self], rates: &[Self], responses: &mut [Response<Self>]
    ) -> Result<(), Error> = steps.generic_compute_at(distances, rates, responses);
    fn keep_plant_run(
        trajectory: &mut PlantTrajectory<Self>, run: &mut PlantRun<Self>, until: Self, watch: Watch<'_>
    ) -> Result<(), Error> = trajectory.generic_keep(run, until, watch);
    fn go_on_with_plant_run(run: &mut PlantRun<Self>, state: &[Self]) = run.generic_go_on_from(state);
    fn read_plant_state<'t>(trajectory: &'t PlantTrajectory<Self>, time: Self) -> (Vec<Self>, &'t PlantMode<Self>) =
        trajectory.generic_at(time);
    fn new_plant_sample(plant: &Plant<Self>) -> PlantSample<Self> = PlantSample::generic_new(plant);
    fn new_plant_reader<'t>(trajectory: &'t PlantTrajectory<Self>) -> PlantReader<'t, Self> =
        PlantReader::generic_new(trajectory);
    fn read_plant_sample(reader: &mut PlantReader<'_, Self>, time: Self, sample: &mut PlantSample<Self>) =
        reader.generic_read_into(time, sample);
    fn read_states_at(reader: &mut PlantReader<'_, Self>, time: Self) = reader.generic_read_state(time);
}
