//! Model exchange: the host integrates the continuous states and locates events; the plant owns its mode.
//!
//! Where the host moves the ends, distances and rates are inputs, and states of the plant that are none of the unit.

use super::{Instance, Kind, Phase, Refusal, SAME};
use crate::variables::Slot;
use mckibben::plant::{EventUpdate, PlantExchange};
use mckibben_run::host::Motion;

/// How far an integrator may evaluate beyond the stop time, relative to the length of the run: those of several steps, such as
/// CVODE, go beyond the end and interpolate back.
const AHEAD: f64 = 0.1;

impl Instance {
    /// How many continuous states there are.
    pub fn state_count(&self) -> usize {
        self.model.variables().states.len()
    }

    /// How many event indicators there are.
    pub fn indicator_count(&self) -> usize {
        self.model.variables().indicators
    }

    /// That there are as many numbers as continuous states.
    fn check_states(&self, given: usize) -> Result<(), Refusal> {
        let count = self.state_count();
        if given == count {
            return Ok(());
        }
        Err(Refusal::error(format!("{given} numbers are given for {count} continuous states")))
    }

    /// The plant in its mode.
    fn exchange(&mut self) -> Result<(&mut PlantExchange, &mut mckibben_run::host::HostPlant), Refusal> {
        self.check_exchange()?;
        if self.exchange.is_none() {
            self.exchange = Some(PlantExchange::new(self.plant.steps(), self.tolerance)?);
        }
        match &mut self.exchange {
            Some(exchange) => Ok((exchange, &mut self.plant)),
            None => Err(Refusal::error("the instance has not been initialised")),
        }
    }

    /// Takes on a time in s of the host.
    ///
    /// # Errors
    /// In another phase than Continuous or Event; for a time that is not finite, one before the last event, and one beyond the stop
    /// time by more than a tenth of the run.
    pub fn set_time(&mut self, time: f64) -> Result<(), Refusal> {
        self.check_exchange()?;
        self.check_phase(&[Phase::Continuous, Phase::Event])?;
        if !time.is_finite() {
            return Err(Refusal::error(format!("the time {time:?} s is none")));
        }
        self.check_stop(time, AHEAD)?;
        let (own, offset) = (time - self.offset, self.offset);
        let (exchange, plant) = self.exchange()?;
        let last = exchange.updated();
        // An update takes a time that lies a rounding before an instant for that instant.
        if own < last - 2.0 * SAME * (1.0 + last.abs()) {
            let event = offset + last;
            return Err(Refusal::error(format!(
                "the time {time:?} s is before the last event, at {event:?} s; to go back beyond an event, restore a saved state"
            )));
        }
        exchange.place(plant.steps_mut(), own, |_| {});
        self.are_outputs_known = false;
        Ok(())
    }

    /// Takes on continuous states.
    ///
    /// # Errors
    /// In another phase than Continuous; for another count; discarded where a state is not finite, and where a pressure or a mass of
    /// air is not above zero. Then the states stay.
    pub fn set_states(&mut self, states: &[f64]) -> Result<(), Refusal> {
        self.check_exchange()?;
        self.check_phase(&[Phase::Continuous])?;
        self.check_states(states.len())?;
        if let Some(place) = states.iter().position(|state| !state.is_finite()) {
            return Err(Refusal::discard(format!("continuous state {place} is {:?}", states[place])));
        }
        if let Some(place) = self.first_without_air(states) {
            let name = self.model.variables().find(Slot::State(place).reference()).map_or("", |its| its.name.as_str());
            return Err(Refusal::discard(format!(
                "`{name}` = {:?} is not above zero; take a shorter step",
                states[place]
            )));
        }
        self.exchange()?;
        let (time, of_unit) = (self.plant.steps().time(), &self.model.variables().states);
        if let Some(exchange) = &self.exchange {
            exchange.place(self.plant.steps_mut(), time, |own| {
                for (place, state) in of_unit.iter().zip(states) {
                    own[*place] = *state;
                }
            });
        }
        self.are_outputs_known = false;
        Ok(())
    }

    /// The first of continuous states that is a pressure or a mass of air and not above zero.
    fn first_without_air(&self, states: &[f64]) -> Option<usize> {
        let indices = self.plant.steps().plant().indices();
        let is_air = |place: usize| {
            let of_actuator = indices.actuators.iter().any(|its| place == its.pressure || place == its.mass());
            of_actuator || indices.nodes.contains(&Some(place))
        };
        let mut of_unit = self.model.variables().states.iter().zip(states);
        of_unit.position(|(place, state)| *state <= 0.0 && is_air(*place))
    }

    /// Writes the continuous states.
    ///
    /// # Errors
    /// In co-simulation; before initialisation; for another count.
    pub fn states(&mut self, states: &mut [f64]) -> Result<(), Refusal> {
        self.check_exchange()?;
        self.check_begun()?;
        self.check_states(states.len())?;
        for (into, place) in states.iter_mut().zip(&self.model.variables().states) {
            *into = self.plant.steps().state()[*place];
        }
        Ok(())
    }

    /// The rates of the continuous states in the mode that holds, per second.
    ///
    /// # Errors
    /// In co-simulation; discarded where a rate is not finite.
    pub(super) fn rates(&mut self) -> Result<Vec<f64>, Refusal> {
        let mut all = core::mem::take(&mut self.scratch[1]);
        let computed = self.exchange().and_then(|(exchange, plant)| Ok(exchange.rates(plant.steps(), &mut all)?));
        let rates: Vec<f64> = self.model.variables().states.iter().map(|place| all[*place]).collect();
        self.scratch[1] = all;
        computed?;
        match rates.iter().position(|rate| !rate.is_finite()) {
            Some(place) => Err(Refusal::discard(format!("the rate of continuous state {place} is {:?}", rates[place]))),
            None => Ok(rates),
        }
    }

    /// Writes the rates of the continuous states.
    ///
    /// # Errors
    /// In co-simulation; before initialisation; for another count; discarded where a rate is not finite.
    pub fn write_rates(&mut self, into: &mut [f64]) -> Result<(), Refusal> {
        self.check_exchange()?;
        self.check_begun()?;
        let rates = self.rates()?;
        if into.len() != rates.len() {
            return Err(Refusal::error(format!("there are {} continuous states, not {}", rates.len(), into.len())));
        }
        into.copy_from_slice(&rates);
        Ok(())
    }

    /// Writes the event indicators: guards of the mode that holds, positive while it lasts.
    ///
    /// # Errors
    /// In co-simulation; before initialisation; for another count; discarded where one is not a number.
    pub fn indicators(&mut self, values: &mut [f64]) -> Result<(), Refusal> {
        self.check_exchange()?;
        self.check_begun()?;
        self.read_indicators(values)
    }

    /// Writes the event indicators in any phase, as those of the description's starts.
    ///
    /// # Errors
    /// In co-simulation; for another count; discarded where one is not a number.
    pub(super) fn read_indicators(&mut self, values: &mut [f64]) -> Result<(), Refusal> {
        let count = self.indicator_count();
        if values.len() != count {
            return Err(Refusal::error(format!("{} numbers are given for {count} event indicators", values.len())));
        }
        let (exchange, plant) = self.exchange()?;
        exchange.guards(plant.steps(), values);
        match values.iter().position(|value| value.is_nan()) {
            Some(place) => Err(Refusal::discard(format!("event indicator {place} is not a number"))),
            None => Ok(()),
        }
    }

    /// Writes the usual sizes of the continuous states.
    ///
    /// # Errors
    /// In co-simulation; for another count.
    pub fn nominals(&mut self, nominals: &mut [f64]) -> Result<(), Refusal> {
        self.check_states(nominals.len())?;
        let mut all = core::mem::take(&mut self.scratch[1]);
        let computed = self.exchange().and_then(|(exchange, plant)| Ok(exchange.scales(plant.steps(), &mut all)?));
        for (into, place) in nominals.iter_mut().zip(&self.model.variables().states) {
            *into = all[*place];
        }
        self.scratch[1] = all;
        computed
    }

    /// Crosses what has fired and passes what is due, then takes parameters and commands with what they cause at once: a movement
    /// that ends at this instant is complete before another command. In co-simulation only commands and the start of a run are left
    /// to do. The next instant is in the host's time.
    ///
    /// # Errors
    /// In another phase than Event; beyond the stop time; discarded where the plant cannot go on.
    pub fn update(&mut self) -> Result<EventUpdate, Refusal> {
        self.check_phase(&[Phase::Event])?;
        self.check_stop(self.time(), 0.0)?;
        if self.kind == Kind::ModelExchange {
            if self.plant.motion() == Motion::Host {
                self.place_motion()?;
            }
            self.pass_due()?;
        }
        self.retune()?;
        self.send_commands()?;
        self.are_outputs_known = false;
        if let Kind::CoSimulation { .. } = self.kind {
            self.plant.steps_mut().pass_due()?;
            return Ok(EventUpdate { events: 0, has_moved: false, next: f64::INFINITY });
        }
        let (offset, passed) = (self.offset, self.passed);
        let is_jump = self.plant.motion() == Motion::Host && self.entered != self.inputs.rates;
        let (exchange, plant) = self.exchange()?;
        let mut update = exchange.update(plant.steps_mut())?;
        if is_jump {
            exchange.enter_motion(plant.steps_mut());
            update = update.and(exchange.update(plant.steps_mut())?);
        }
        update = passed.map_or(update, |passed| passed.and(update));
        self.passed = None;
        self.entered.clone_from(&self.inputs.rates);
        Ok(EventUpdate { next: offset + update.next, ..update })
    }

    /// Crosses what has fired and passes what is due by the commands and parameters that there have been up to now.
    pub(super) fn pass_due(&mut self) -> Result<(), Refusal> {
        let before = self.passed;
        let (exchange, plant) = self.exchange()?;
        let passed = exchange.pass_due(plant.steps_mut())?;
        self.passed = Some(before.map_or(passed, |before| before.and(passed)));
        self.are_outputs_known = false;
        Ok(())
    }

    /// Goes on with integration after an event.
    ///
    /// # Errors
    /// In another phase than Event; in co-simulation.
    pub fn enter_continuous(&mut self) -> Result<(), Refusal> {
        self.check_exchange()?;
        self.check_phase(&[Phase::Event])?;
        self.phase = Phase::Continuous;
        Ok(())
    }

    /// A step of the host's integrator is complete. Nothing has to be done; no event follows.
    ///
    /// # Errors
    /// In another phase than Continuous.
    pub fn completed_step(&mut self) -> Result<(), Refusal> {
        self.check_exchange()?;
        self.check_phase(&[Phase::Continuous])
    }

    /// Takes on the distances and rates that the host has set, in the mode that holds.
    pub(super) fn place_motion(&mut self) -> Result<(), Refusal> {
        self.exchange()?;
        let (time, here) = (self.plant.steps().time(), self.plant.steps().plant().indices().mechanisms[0]);
        let (inputs, Some(exchange)) = (&self.inputs, &self.exchange) else { return Ok(()) };
        exchange.place(self.plant.steps_mut(), time, |own| {
            for (k, (distance, rate)) in inputs.distances.iter().zip(&inputs.rates).enumerate() {
                (own[here.position(k)], own[here.rate(k)]) = (*distance, *rate);
            }
        });
        self.are_outputs_known = false;
        Ok(())
    }
}
