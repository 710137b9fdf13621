//! Symptom: above a relative tolerance of 1e-3, which is admissible, the paper's own rig stops with "no step is short
//! enough" once the pressure comes near the port's, or takes steps of 4e-11 s for ever and fills the memory.
//!
//! Cause: the borders of the flow's pieces are widened by the tolerance. When that exceeds `1 − r_lam = 1e-3`, the subsonic
//! piece is kept beyond equal pressure, where it is the root of a negative number. The widening must stay well within the
//! straight line that it leads to.

use crate::common::{GRAVITY, Paper};
use mckibben::load::Load;
use mckibben::plant::RigPlant;
use mckibben::valve::{Command, Request};

#[test]
fn every_admissible_tolerance_comes_to_the_end() {
    for tolerance in [1e-6, 1e-5, 1e-4, 5e-4, 9.9e-4, 1.01e-3, 2e-3, 5e-3, 1e-2] {
        for request in [Request::Fill, Request::Exhaust] {
            for mass in [None, Some(1.0)] {
                let paper = Paper::driven(Command::Constant(request)).gauge(2e5);
                let paper = match mass {
                    None => paper.isometric(0.085),
                    Some(mass) => paper.with(|rig| rig.load = Load::HangingMass { mass, gravity: GRAVITY }),
                };
                let (rig, start) = (paper.rig(), paper.start());
                let mut steps = 0;
                // Counted here, not stored: a run that does not end would fill the memory.
                let end = RigPlant::new(&rig).stream(&start, (0.5, tolerance), None, &mut |step| {
                    steps += 1;
                    assert!(steps < 5000, "at {tolerance:e}, {request:?}, {mass:?}: still at {} s", step.end());
                    Ok(())
                });
                let end = end.unwrap_or_else(|error| panic!("at {tolerance:e}: {error}"));
                assert!(end.run.state().iter().all(|number| number.is_finite()));
            }
        }
    }
}
