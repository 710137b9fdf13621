//! Co-simulation: steps of any length by the plant's own engine.
//!
//! Where the host moves the ends, they go in a straight line to `distance + rate · step`. A host that gives the distances at
//! the end of the step sets the rates to zero, from those of the scenario at which they start; one that gives both as they are at its beginning is right to first order.

use super::{Instance, Kind, Phase, Refusal, SAME};
use mckibben_run::host::{GREATEST_MOTION, Motion};

/// By how much pulses are laid out beyond an edge, relative to a time of one second or more.
const AHEAD: f64 = 1e-12;
/// Edges of pulses that move nothing, as those of a duty cycle of zero, after which a step is taken whole.
const MOST_EDGES: u32 = 1_000;

/// Where a step has ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepEnd {
    /// The time in s that was reached.
    pub time: f64,
    /// Whether the step ended before its end, at a valve that switches.
    pub is_early: bool,
    /// Whether a valve has switched at the time that was reached, for a host that handles events.
    pub is_event: bool,
}

impl Instance {
    /// Goes on from `time` by `step`, both in s. With event mode and early return it ends at the first instant at which a valve
    /// moves, which has been passed then. That instant may be the end of the step.
    ///
    /// # Errors
    /// In another phase than Step; for a time at which the instance is not, a step that is negative or not finite, and one beyond
    /// the stop time; a discarded step where the plant cannot go on. The plant is then where it was.
    pub fn do_step(&mut self, time: f64, step: f64) -> Result<StepEnd, Refusal> {
        let Kind::CoSimulation { event_mode, early_return } = self.kind else {
            return Err(Refusal::error("the instance was made for model exchange"));
        };
        self.check_phase(&[Phase::Step])?;
        let here = self.time();
        // What is not a number is refused as well.
        let is_here = (time - here).abs() <= SAME * time.abs().max(1.0);
        if !is_here {
            return Err(Refusal::error(format!("a step begins at {time:?} s, but the instance is at {here:?} s")));
        }
        if !(step.is_finite() && step >= 0.0) {
            return Err(Refusal::error(format!("a step of {step:?} s is none; give one above zero")));
        }
        self.check_stop(time + step, 0.0)?;
        self.send_commands()?;
        let from = self.plant.steps().time();
        let until = time + step - self.offset;
        if until <= from {
            return Ok(StepEnd { time: here, is_early: false, is_event: false });
        }
        let (mut end, mut is_early, mut is_event) = (until, false, false);
        if event_mode && early_return {
            let rounding = SAME * step;
            let instant = self.next_instant(until + rounding)?;
            is_event = instant > from + rounding && instant <= until + rounding;
            is_early = is_event && instant < until - rounding;
            if is_event {
                // An instant that lies a rounding behind the end is passed with it.
                end = if is_early { instant } else { instant.max(until) };
            }
        }
        let mut targets = core::mem::take(&mut self.scratch[0]);
        targets.clear();
        if self.plant.motion() == Motion::Host {
            let part = (end - from) / (until - from);
            for (index, (distance, rate)) in self.inputs.distances.iter().zip(&self.inputs.rates).enumerate() {
                let (target, begin) = (distance + rate * step, self.plant.distance(index));
                targets.push(if is_early { begin + (target - begin) * part } else { target });
            }
        }
        let done = self.check_targets(&targets, step).and_then(|()| {
            // The call is right, so what keeps the plant from going there are the values: others, or a shorter step, may do.
            self.plant.advance(end, &targets).map_err(|failure| Refusal::discard(failure.sentence()))
        });
        self.scratch[0] = targets;
        self.are_outputs_known = false;
        done?;
        Ok(StepEnd { time: if is_early { self.offset + end } else { time + step }, is_early, is_event })
    }

    /// That the distances in m to which a step in s takes the ends are some.
    fn check_targets(&self, targets: &[f64], step: f64) -> Result<(), Refusal> {
        let is_none = |target: &f64| !(*target > 0.0 && *target <= GREATEST_MOTION);
        let Some(index) = targets.iter().position(is_none) else { return Ok(()) };
        let (name, target) = (&self.plant.actuators()[index], targets[index]);
        let (distance, rate) = (self.inputs.distances[index], self.inputs.rates[index]);
        Err(Refusal::discard(format!(
            "`{name}.distance` = {distance:?} m and `{name}.rate` = {rate:?} m/s lead to a distance of {target:?} m in a step of \
             {step:?} s, which is not above zero and up to {GREATEST_MOTION:e} m; take a shorter step, or set another rate"
        )))
    }

    /// The next instant in s up to `until` at which something moves; infinite where there is none. Pulses are laid out as far as that
    /// instant alone, so that a duty cycle that is set there is that of the next period.
    fn next_instant(&mut self, until: f64) -> Result<f64, Refusal> {
        let steps = self.plant.steps_mut();
        for _ in 0..MOST_EDGES {
            let (instant, edge) = (steps.next_instant(until), steps.pulse_edge());
            if instant <= edge || edge >= until {
                return Ok(instant);
            }
            let from = edge.max(steps.time());
            steps.lay_out((from + AHEAD * from.max(1.0)).min(until))?;
        }
        Ok(f64::INFINITY)
    }

    /// Enters the phase of events, of co-simulation with event mode or of model exchange.
    ///
    /// # Errors
    /// In another phase than Step or Continuous, and where the host has chosen to do without.
    pub fn enter_event_mode(&mut self) -> Result<(), Refusal> {
        if matches!(self.kind, Kind::CoSimulation { event_mode: false, .. }) {
            return Err(Refusal::error("the instance was made without event mode"));
        }
        self.check_phase(&[Phase::Step, Phase::Continuous])?;
        self.phase = Phase::Event;
        Ok(())
    }

    /// Goes on with steps after an event.
    ///
    /// # Errors
    /// In another phase than Event; in model exchange.
    pub fn enter_step_mode(&mut self) -> Result<(), Refusal> {
        self.check_phase(&[Phase::Event])?;
        if self.kind == Kind::ModelExchange {
            return Err(Refusal::error("the instance was made for model exchange"));
        }
        self.phase = Phase::Step;
        Ok(())
    }
}
