//! Valves that are set during a run: the setting replaces their command from then on.
//!
//! Settings become a command, of which only the entries that have not taken effect are kept. So poppets move at the instants
//! of a command known beforehand, and memory is bounded however often a valve is set.

use super::commands::RuntimeCommands;
use super::mode::{BranchMode, NetworkMode, NodeMode, ValveMode};
use super::{Network, NodeKind};
use crate::error::Error;
use crate::line::Poppet;
use crate::numbered::Row;
use crate::plant::steps::{MOST_PARTS, TOO_MANY_PARTS};
use crate::scalar::Real;
use crate::simulation::Actuation;
use crate::valve::{Approach, Command, Regulator, RuntimeCommand};
use alloc::boxed::Box;
use alloc::vec::Vec;

/// What a valve has been set to during a run.
#[derive(Debug)]
pub(crate) struct Setting<R> {
    /// The valve, with the entries of its command that have not taken effect.
    actuation: Actuation<R>,
    commands: RuntimeCommands<R>,
    /// Of pulses that go on, in Hz.
    pulse_frequency: Option<R>,
}

impl<R: Clone> Clone for Setting<R> {
    fn clone(&self) -> Self {
        let Self { actuation, commands, pulse_frequency } = self;
        Self { actuation: actuation.clone(), commands: commands.clone(), pulse_frequency: pulse_frequency.clone() }
    }

    /// Takes on another setting in the memory that is there.
    fn clone_from(&mut self, source: &Self) {
        let Self { actuation: Actuation { solenoid, command }, commands, pulse_frequency } = self;
        solenoid.clone_from(&source.actuation.solenoid);
        commands.clone_from(&source.commands);
        pulse_frequency.clone_from(&source.pulse_frequency);
        match (command, &source.actuation.command) {
            (Command::Table { time, request }, Command::Table { time: of_source, request: requests }) => {
                time.clone_from(of_source);
                request.clone_from(requests);
            }
            (
                Command::SetPoints { time, gauge_pressure: number },
                Command::SetPoints { time: of_source, gauge_pressure: numbers },
            )
            | (
                Command::Positions { time, position: number },
                Command::Positions { time: of_source, position: numbers },
            ) => {
                time.clone_from(of_source);
                number.clone_from(numbers);
            }
            (command, of_source) => *command = of_source.clone(),
        }
    }
}

impl<R: Real> Setting<R> {
    /// Nothing has been set yet: the valve goes on with its own command.
    fn of(actuation: &Actuation<R>) -> Self {
        Self { actuation: actuation.clone(), commands: RuntimeCommands::nothing(), pulse_frequency: None }
    }

    pub(crate) fn actuation(&self) -> &Actuation<R> {
        &self.actuation
    }

    /// When in s its pulses must be laid out next; infinite when never.
    pub(crate) fn edge(&self) -> R {
        self.commands.next_edge()
    }
}

impl<R: Real> ValveMode<R> {
    /// The frequency in Hz of the pulses that the valve has been set to, if it has.
    pub fn pulse_frequency(&self) -> Option<R> {
        self.setting.as_ref().and_then(|setting| setting.pulse_frequency)
    }
}

/// What a valve that acts late has on its way of its command, at most, in a state that is saved as numbers.
const MOST_LATE: usize = 64;
/// What one that acts at once has.
const MOST_AT_ONCE: usize = 4;

impl<R: Real> Setting<R> {
    /// One of a valve that has nothing on its way.
    fn blank(valve: &Actuation<R>) -> Self {
        let (solenoid, command) = (valve.solenoid, Command::nothing_of(&valve.solenoid));
        Self { actuation: Actuation { solenoid, command }, commands: RuntimeCommands::nothing(), pulse_frequency: None }
    }

    /// As numbers in a row.
    fn each_number(&mut self, time: R, row: &mut impl Row<R>) {
        let Self { actuation: Actuation { solenoid, command }, commands, pulse_frequency } = self;
        commands.each_number(solenoid, time, row);
        row.instant(pulse_frequency);
        if pulse_frequency.is_some_and(|frequency| frequency.value() <= 0.0) {
            row.refuse();
        }
        let capacity = if solenoid.latency().value() > 0.0 { MOST_LATE } else { MOST_AT_ONCE };
        match command {
            Command::Table { time, request } => {
                let first = crate::valve::Request::Fill;
                each_change((time, request, first), capacity, row, |row, request| row.request(request));
            }
            Command::SetPoints { time, gauge_pressure: number } | Command::Positions { time, position: number } => {
                each_change((time, number, R::zero()), capacity, row, |row, number| row.number(number));
            }
            // What has been set is a list.
            Command::Constant(_) | Command::Pwm { .. } => row.refuse(),
        }
    }
}

/// The changes of a command as numbers in a row, each with its instant in s.
fn each_change<R: Real, V: Copy, W: Row<R>>(
    (time, values, first): (&mut Vec<R>, &mut Vec<V>, V),
    capacity: usize,
    row: &mut W,
    value: impl Fn(&mut W, &mut V),
) {
    if let Some(length) = row.length(time.len(), capacity) {
        time.resize(length, R::zero());
        values.resize(length, first);
    }
    for place in 0..capacity {
        match time.get_mut(place).zip(values.get_mut(place)) {
            Some((time, change)) => {
                row.number(time);
                value(row, change);
            }
            None => {
                row.nothing();
                row.nothing();
            }
        }
    }
    if time.windows(2).any(|pair| pair[1].le(pair[0])) {
        row.refuse();
    }
}

impl<R: Real> Network<R> {
    /// Drops of what valves have been set to all that has been passed up to `time` in s.
    pub(crate) fn forget_passed(&self, time: R, mode: &mut NetworkMode<R>) {
        for valve in 0..mode.valves.len() {
            let ValveMode { progress, setting, .. } = &mut mode.valves[valve];
            if let Some(setting) = setting {
                progress.forget_passed(&mut setting.actuation, time);
                self.forget_set_points(valve, mode);
            }
        }
    }

    /// The mode at a time in s as numbers in a row, but for the pieces of laws, which the pressures say.
    pub(crate) fn each_number(&self, time: R, mode: &mut NetworkMode<R>, row: &mut impl Row<R>) {
        let NetworkMode { branches, nodes, valves } = mode;
        for BranchMode { zone: _, regime: _, runs, sonic } in branches {
            row.truth(runs);
            row.option(sonic, [false, true]);
        }
        for (index, its) in valves.iter_mut().enumerate() {
            let ValveMode { ports, progress, openings, setting } = its;
            row.truth(&mut ports.supply);
            row.truth(&mut ports.exhaust);
            progress.each_number(row);
            let (mut is_set, mut blank) = (setting.is_some(), None);
            row.truth(&mut is_set);
            match setting.as_deref_mut() {
                Some(setting) => setting.each_number(time, row),
                None => blank.insert(Setting::blank(&self.valves[index])).each_number(time, row),
            }
            if !row.puts_back() {
                continue;
            }
            if is_set && progress.has_passed() {
                row.refuse();
            }
            match blank {
                Some(blank) if is_set => *setting = Some(Box::new(blank)),
                None if !is_set => *setting = None,
                _ => {}
            }
            *openings = progress.openings(&self.valves[index]);
        }
        for (index, its) in nodes.iter_mut().enumerate() {
            let NodeMode { poppet, limited, approach, set_points, rows_passed } = its;
            row.choice(poppet, [Poppet::Rests, Poppet::Raises, Poppet::Lowers]);
            row.truth(limited);
            row.option(approach, [Approach::Settles, Approach::Rises, Approach::Falls]);
            row.count(set_points);
            let rows = match self.nodes[index].kind {
                NodeKind::Given { series, .. } => self.series[series].rows(),
                _ => 0,
            };
            row.index(rows_passed, rows + 1);
            let last = set_points.checked_sub(1);
            let is_there = |last: u64| match self.nodes[index].kind {
                NodeKind::Port { valve, .. } => {
                    let actuation = valves[valve].setting.as_ref().map_or(&self.valves[valve], |its| its.actuation());
                    actuation.command.set_point(last).is_some()
                }
                _ => false,
            };
            if last.is_some_and(|last| !is_there(last)) {
                row.refuse();
            }
        }
    }
}

impl<R: Real> Network<R> {
    /// Checks that a valve can do what is demanded, with what feeds it.
    ///
    /// # Errors
    /// As [`Solenoid::check_command`](crate::valve::Solenoid::check_command); [`Error::Inconsistent`] for a set point above the
    /// gauge pressure of what feeds the regulator.
    pub fn check_command(&self, valve: usize, commanded: &RuntimeCommand<R>) -> Result<(), Error> {
        self.valves[valve].solenoid.check_command(commanded)?;
        match (commanded, self.feed_of(valve)) {
            (RuntimeCommand::SetPoint(gauge), Some(feed)) => Regulator::check_set_point(gauge.0.value(), feed.value()),
            _ => Ok(()),
        }
    }

    /// The gauge pressure in Pa of what feeds a pressure regulator in a valve's place, if it is one.
    pub fn feed_of(&self, valve: usize) -> Option<R> {
        self.valves[valve].solenoid.regulator()?;
        self.nodes.iter().find_map(|node| match node.kind {
            NodeKind::Port { valve: its, feed, .. } if its == valve => Some(feed),
            _ => None,
        })
    }

    /// Sets what a valve does from `time` in s on, in place of all that was to come.
    ///
    /// # Errors
    /// As [`Network::check_command`].
    pub(crate) fn set_valve(
        &self,
        valve: usize,
        time: R,
        commanded: RuntimeCommand<R>,
        mode: &mut NetworkMode<R>,
    ) -> Result<(), Error> {
        self.check_command(valve, &commanded)?;
        let of_valve = &mut mode.valves[valve];
        let setting = of_valve.setting.get_or_insert_with(|| Box::new(Setting::of(&self.valves[valve])));
        let Setting { actuation, commands, pulse_frequency } = &mut **setting;
        *pulse_frequency =
            if let RuntimeCommand::Pulses { frequency, .. } = commanded { Some(frequency) } else { None };
        commands.apply(actuation, &mut of_valve.progress, time, commanded);
        self.forget_set_points(valve, mode);
        Ok(())
    }

    /// Applies a command that does not depend on the state of a valve that has been set before: the one that holds, or another
    /// duty cycle of the current pulses. Returns whether the command is one of these; otherwise nothing changes.
    ///
    /// # Errors
    /// As [`Network::set_valve`].
    pub(crate) fn set_valve_on(
        &self,
        valve: usize,
        commanded: &RuntimeCommand<R>,
        mode: &mut NetworkMode<R>,
    ) -> Result<bool, Error> {
        self.check_command(valve, commanded)?;
        let setting = &mut mode.valves[valve].setting;
        Ok(setting.as_mut().is_some_and(|setting| setting.commands.follow(commanded)))
    }

    /// Drops the set points of a valve that have taken effect, except the last, which is still in force.
    fn forget_set_points(&self, valve: usize, mode: &mut NetworkMode<R>) {
        let Some(setting) = &mut mode.valves[valve].setting else { return };
        let of_valve = |node: &NodeKind<R>| matches!(node, NodeKind::Port { valve: its, .. } if *its == valve);
        let ports = || (0..self.nodes.len()).filter(|node| of_valve(&self.nodes[*node].kind));
        if let Some(passed) = ports().map(|node| mode.nodes[node].set_points).min()
            && passed > 1
        {
            setting.actuation.command.keep(passed - 1, R::constant(f64::INFINITY));
            for node in ports() {
                mode.nodes[node].set_points -= passed - 1;
            }
        }
    }

    /// Appends the edges of a valve's pulses from `time` to `until`, both in s.
    ///
    /// # Errors
    /// [`Error::Misuse`] for more edges than a step may have: they are kept until they have passed.
    pub(crate) fn pulse_valve(
        &self,
        valve: usize,
        [time, until]: [R; 2],
        mode: &mut NetworkMode<R>,
    ) -> Result<(), Error> {
        let of_valve = &mut mode.valves[valve];
        let Some(setting) = &mut of_valve.setting else { return Ok(()) };
        let Setting { actuation, commands, .. } = &mut **setting;
        if commands.edges_until(until) > MOST_PARTS {
            return Err(TOO_MANY_PARTS);
        }
        commands.advance(actuation, &mut of_valve.progress, [time, until]);
        Ok(())
    }

    /// Records the settings from a time in s on in the commands of the valves.
    pub(crate) fn record_settings(&mut self, valves: &[usize], from: R, mode: &NetworkMode<R>) {
        for &valve in valves {
            if let Some(setting) = &mode.valves[valve].setting {
                self.valves[valve].command.take_over(&setting.actuation.command, from);
            }
        }
    }
}
