//! A custom controller: pulses in proportion to the error of the length, that fill where the load hangs too low and
//! let air out where it hangs too high.

use mckibben::air::{Air, Process};
use mckibben::control::{Controller, Drive, Measurement, Sampling, Sensors};
use mckibben::force::{Characteristic, Effective, Effectiveness, IdealBraid, LengthLimits};
use mckibben::friction::Friction;
use mckibben::load::Load;
use mckibben::plant::RigPlant;
use mckibben::simulation::{Actuation, Initial, InitialLength, Rig};
use mckibben::valve::{
    Command, ExhaustTemperature, FlowLaw, FlowStandard, Request, Solenoid, Supply, Valve, ValveKind,
};
use mckibben::{AbsolutePressure, Actuator, Braid, Error, GaugePressure};

#[derive(Debug)]
struct Lift {
    /// Wanted distance between the attachments in m.
    length: f64,
    /// Error in m at which a pulse fills its whole period.
    band: f64,
}

impl Controller for Lift {
    type Memory = ();

    fn begin(&self) {}

    fn decide(&self, seen: &Measurement, (): &mut ()) -> Drive {
        let share = (seen.length - self.length) / self.band;
        let pulse = if share > 0.0 { Request::Fill } else { Request::Exhaust };
        Drive::Pulses { duty: share.abs().min(1.0), pulse, rest: Request::Hold }
    }
}

fn main() -> Result<(), Error> {
    let (rig, start) = hanging_mass()?;
    let controller = Lift { length: 0.085, band: 0.03 };
    let sampling = Sampling::new(50.0, 1)?;
    let plant = RigPlant::new(&rig);
    let driver = plant.driver(controller, (sampling, Sensors::perfect()))?;
    let run = plant.record(&rig.start(&start)?, (2.0, 1e-8), Some(driver), &mut |_| Ok(()))?;
    for sample in run.samples(0.2) {
        println!("{:4.1} s  {:6.2} mm  {:8.0} Pa", sample.time, 1e3 * sample.length, sample.pressure.0);
    }
    Ok(())
}

/// The actuator of Colbrunn, Nelson & Quinn (2001) with 2 kg on it and a pair of two-way valves.
fn hanging_mass() -> Result<(Rig, Initial), Error> {
    let air = Air::new(286.99, 1.4, AbsolutePressure(101_325.0), Process::Isentropic)?;
    let braid = Braid::new(0.109_774, 2.5)?;
    let law =
        Effective { law: Characteristic::from(IdealBraid { braid }), effectiveness: Effectiveness::constant(1.0)? };
    let limits = LengthLimits::new(&braid, None, 0.097_79, 1.75e5, 100.0)?;
    let flow = FlowLaw::new(FlowStandard::Orifice { flow_area: 2e-7 }, 0.85, 0.999, &air)?;
    let supply = Supply::new(GaugePressure(6e5), 293.15, &air)?;
    let valve = Valve::new(flow, supply, ExhaustTemperature::Actuator, &air);
    let actuator = Actuator::new(law, limits, Friction::new(3.5, 0.0)?, 3e-6, air)?.with_valve(valve);
    let solenoid = Solenoid::new(ValveKind::FillHoldExhaust, 2e-3, 1e-3)?;
    let actuation = Actuation { solenoid, command: Command::Constant(Request::Hold) };
    let start = Initial {
        gauge_pressure: GaugePressure(0.5e5),
        temperature: 293.15,
        length: InitialLength::Equilibrium,
        velocity: 0.0,
    };
    Ok((Rig::new(actuator, Some(actuation), Load::hanging_mass(2.0, 9.80665)?)?, start))
}
