//! One plant in a model: which MuJoCo actuator is which, where it begins, its forces, its step and its sensors.
//!
//! The state of an instance is numbers that MuJoCo owns (`plugin_state`), so that saving, resetting, copying and rollouts are
//! MuJoCo's own:
//!
//! ```text
//! [0]        phase: 0 not begun, 1 under way, 2 stopped
//! [1 .. n]   what `act` was given last, for each actuator: gauge pressure in Pa
//! [n+1 ..]   the state of the plant
//! ```
//!
//! It begins where MuJoCo has the ends at the first step. What is kept in addition to the numbers is only what they say, read already.
//!
//! A step is in MuJoCo's order: forces at t, MuJoCo's own step, then all ends go to where they are at t + h. MuJoCo knows that
//! length only at the next step, so it is taken as `L(t) + h J(t) v(t + h)`, right to second order in h; the next step begins
//! from there, so nothing adds up, and the force is always that at MuJoCo's own length. Nor do times add up roundings: from a
//! multiple of h the plant goes to the next, so that a duty cycle set where a pulse begins is that of this pulse.

use crate::config::Config;
use mckibben::{GaugePressure, Response};
use mckibben_run::failure::Failure;
use mckibben_run::host::{CommandMode, HostPlant};
use mckibben_scenario::{PlantQuantity, nearest_few};
use std::borrow::Borrow;

/// How many outputs a refusal names.
const NAMED: usize = 6;
const FRESH: f64 = 0.0;
const UNDER_WAY: f64 = 1.0;
const STOPPED: f64 = 2.0;

/// A MuJoCo actuator that is one of the plant's.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wire {
    /// Address of its force, length and velocity.
    pub(crate) output: usize,
    /// Address of its control.
    pub(crate) control: usize,
    /// Address of its pressure in `act`, where it has one.
    pub(crate) act: Option<usize>,
    /// Limits that the model sets on its control.
    pub(crate) range: Option<[f64; 2]>,
    /// Its group, which the model may disable.
    pub(crate) group: i32,
}

/// What MuJoCo has of each actuator of the plant, in the plant's order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ends {
    /// Length and velocity at the time of the state, in m and m/s, without the offset.
    pub(crate) lengths: Vec<f64>,
    pub(crate) velocities: Vec<f64>,
    /// Velocity at the end of the step, in m/s.
    pub(crate) next_velocities: Vec<f64>,
    pub(crate) controls: Vec<f64>,
    /// Whether MuJoCo lets it exert no force at present.
    pub(crate) disabled: Vec<bool>,
    /// Gauge pressures in `act`, where they are there.
    pub(crate) acts: Vec<f64>,
}

/// Where the plant was brought.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Brought {
    Nowhere,
    /// To a beginning: `here` has the distances and velocities of the ends.
    Begun,
    /// To a state under way, which `here` has.
    To,
}

/// The request of a control: the nearest whole number, and of a valve that has no such request the one that it has in its place.
/// Zero is what `ctrl` is by default, so a valve that cannot hold exhausts there, and one that cannot exhaust holds below it.
fn nearest_request(control: f64, has: &[f64]) -> f64 {
    let wanted = control.round();
    if has.contains(&wanted) {
        return wanted;
    }
    let [least, most] = [has.first(), has.last()].map(|end| end.copied().unwrap_or(wanted));
    if control > 0.0 { most } else { least }
}

/// One plant in a model, with its memory.
#[derive(Debug)]
pub(crate) struct Instance {
    host: HostPlant,
    offsets: Vec<f64>,
    /// Each actuator of the plant in the model.
    pub(crate) wires: Vec<Wire>,
    /// Addresses in `sensordata` and what they hold.
    pub(crate) sensors: Vec<(usize, PlantQuantity, usize)>,
    /// The requests that each command takes, in rising order; none of a command that is no request.
    requests: Vec<Vec<f64>>,
    /// What MuJoCo has, to be filled in.
    pub(crate) ends: Ends,
    /// The numbers that the plant was last brought to.
    here: Vec<f64>,
    /// The pressures that it was brought to besides.
    here_acts: Vec<f64>,
    brought: Brought,
    /// Whether there is no force where it was computed last.
    is_refused: bool,
    zeros: Vec<f64>,
    distances: Vec<f64>,
    responses: Vec<Response>,
    outputs: Vec<f64>,
}

/// How many numbers of the state come before the plant's.
fn head(actuators: usize) -> usize {
    1 + actuators
}

/// How many numbers the state of an instance is.
pub(crate) fn state_size(config: &mut Config) -> usize {
    head(config.host.actuators().len()) + config.host.state_size()
}

/// The gauge pressure in Pa that an actuator came to in the last step.
pub(crate) fn pressure(state: &[f64], actuator: usize) -> f64 {
    state[1 + actuator]
}

/// A failure with what becomes of the plant behind it.
fn ending(why: &Failure, of_plant: &str) -> Failure {
    Failure::stopped(format!("{}; {of_plant}", why.sentence()))
}

/// Makes the numbers of a state those of an instance that has not begun.
pub(crate) fn reset(state: &mut [f64]) {
    state.fill(0.0);
}

/// A MuJoCo name without what attached models put before it with `/`.
pub(crate) fn plain_name(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}

/// The index of what a MuJoCo name stands for among names: the name itself, or what follows its last `/`, as attached models
/// have it.
pub(crate) fn index_of(name: &str, names: &[String]) -> Option<usize> {
    let of = |name: &str| names.iter().position(|known| known == name);
    of(name).or_else(|| of(plain_name(name)))
}

/// What the name of a sensor says of a muscle alone: the quantity, behind one of the muscle's names or behind none. What attached
/// models put before a name with `/` does not count.
fn short_of<'n>(name: &'n str, muscles: [&str; 2]) -> Option<&'n str> {
    let name = plain_name(name);
    let mut behind = muscles.into_iter().filter_map(|muscle| name.strip_prefix(plain_name(muscle))?.strip_prefix('.'));
    // Any other prefix is another part, which must not read the muscle in silence.
    behind.next().or_else(|| (!name.contains('.')).then_some(name))
}

impl Instance {
    /// An instance; `actuators` are the MuJoCo actuators that refer to it, `sensors` its sensors with their addresses.
    pub(crate) fn new(
        config: Config,
        actuators: &[(String, Wire)],
        sensors: &[(String, usize)],
    ) -> Result<Self, Failure> {
        let Config { mut host, offsets } = config;
        let names = host.actuators().to_vec();
        // The name in the model of a muscle alone, where it has one.
        let muscle = match (names.as_slice(), actuators) {
            ([_], [(title, _)]) => Some(plain_name(title)).filter(|title| !title.is_empty()),
            _ => None,
        };
        let offsets = offsets.of_each(&names, muscle)?;
        let mut wires: Vec<Option<Wire>> = vec![None; names.len()];
        for (name, wire) in actuators {
            // A muscle alone may have any name.
            let at = if names.len() == 1 && actuators.len() == 1 { Some(0) } else { index_of(name, &names) };
            let Some(at) = at else {
                return Err(Failure::input(
                    format!("the actuator `{name}` of the model is none of the scenario"),
                    format!("name it {}", names.join(", ")),
                ));
            };
            if wires[at].replace(*wire).is_some() {
                return Err(Failure::input(
                    format!("two actuators of the model are `{}` of the scenario", names[at]),
                    "give each its own name",
                ));
            }
        }
        let missing = |at: usize| {
            Failure::input(
                format!("`{}` of the scenario is no actuator of the model", names[at]),
                format!("add <plugin name=\"{}\" tendon=\"…\" instance=\"…\"/> to <actuator>", names[at]),
            )
        };
        let wires: Vec<Wire> =
            wires.iter().enumerate().map(|(at, wire)| wire.ok_or_else(|| missing(at))).collect::<Result<_, _>>()?;
        let columns: Vec<String> = host.outputs().iter().map(|column| column.name.clone()).collect();
        let sensors = sensors.iter().map(|(name, address)| {
            let of_muscle = || match (names.as_slice(), actuators) {
                ([own], [(title, _)]) => {
                    index_of(&format!("{own}.{}", short_of(name, [title.as_str(), own.as_str()])?), &columns)
                }
                _ => None,
            };
            let at = index_of(name, &columns).or_else(of_muscle);
            let at = at.ok_or_else(|| {
                // MuJoCo cuts a long message, so what may be meant comes first; a muscle alone is called as in the model.
                let of_muscle = |column: &String| match (muscle, column.strip_prefix(&format!("{}.", names[0]))) {
                    (Some(muscle), Some(output)) => format!("{muscle}.{output}"),
                    _ => column.clone(),
                };
                let shown: Vec<String> = columns.iter().map(of_muscle).collect();
                let nearest = nearest_few(plain_name(name), shown.iter().map(String::as_str), NAMED);
                let rest = columns.len().saturating_sub(NAMED);
                let more =
                    if rest > 0 { format!(", or another of its {} outputs", columns.len()) } else { String::new() };
                Failure::input(
                    format!("the sensor `{name}` of the model is no output of the plant"),
                    format!("name it after one of {}{more}", nearest.join(", ")),
                )
            })?;
            let quantity = host.outputs()[at].quantity();
            quantity
                .map(|quantity| (*address, quantity, at))
                .ok_or_else(|| Failure::input("an output is no number", "name another"))
        });
        let sensors = sensors.collect::<Result<Vec<_>, _>>()?;
        let count = names.len();
        let zeros = vec![0.0; count];
        let responses = (0..count).map(|at| host.steps_mut().compute(at)).collect::<Result<_, _>>()?;
        let ends = Ends {
            lengths: zeros.clone(),
            velocities: zeros.clone(),
            next_velocities: zeros.clone(),
            controls: zeros.clone(),
            disabled: vec![false; count],
            acts: zeros.clone(),
        };
        Ok(Self {
            here: vec![f64::NAN; (head(count) + host.state_size()).max(2 * count)],
            here_acts: zeros.clone(),
            brought: Brought::Nowhere,
            is_refused: false,
            zeros: zeros.clone(),
            distances: zeros,
            outputs: vec![0.0; columns.len()],
            requests: (0..host.commands().len()).map(|input| host.requests(input)).collect(),
            host,
            offsets,
            wires,
            sensors,
            ends,
            responses,
        })
    }

    /// How many numbers the state is.
    pub(crate) fn size(&mut self) -> usize {
        head(self.wires.len()) + self.host.state_size()
    }

    /// Computes tensions where MuJoCo has the ends. The state stays as it is: those who plan look at many places, and step from
    /// none of them.
    ///
    /// # Errors
    /// Why they cannot be had, once for places that follow one another. A step from there stops the instance.
    pub(crate) fn compute(&mut self, state: &[f64]) -> Result<(), Failure> {
        if state[0] == STOPPED {
            return Ok(());
        }
        let was_refused = std::mem::replace(&mut self.is_refused, false);
        self.respond(state).or_else(|why| {
            (self.is_refused, self.brought) = (true, Brought::Nowhere);
            match was_refused && state[0] != FRESH {
                true => Ok(()),
                false => Err(ending(
                    &why,
                    "there is no force there, and a step from there stops the plant until the data are reset",
                )),
            }
        })
    }

    /// The tensions in N that act on MuJoCo's bodies, as computed, for each actuator; none where they cannot be had, none where
    /// the instance has stopped, and none of an actuator that MuJoCo has disabled.
    pub(crate) fn tensions(&self, state: &[f64]) -> impl Iterator<Item = f64> + '_ {
        let is_stopped = self.is_refused || state[0] == STOPPED;
        let each = self.responses.iter().zip(&self.ends.disabled);
        each.map(move |(response, disabled)| if is_stopped || *disabled { 0.0 } else { response.tension })
    }

    /// Stops for a reason, which is returned unless it has stopped already.
    pub(crate) fn stop(&mut self, state: &mut [f64], why: Failure) -> Result<(), Failure> {
        if state[0] == STOPPED {
            return Ok(());
        }
        state[0] = STOPPED;
        Err(why)
    }

    /// Goes on by a step of `h` in s, and writes the state that it comes to.
    ///
    /// # Errors
    /// Why it cannot, unless [`compute`](Self::compute) has said so; the state is then that of an instance that has stopped.
    pub(crate) fn advance(&mut self, state: &mut [f64], h: f64) -> Result<(), Failure> {
        if state[0] == STOPPED {
            return Ok(());
        }
        if self.is_refused {
            state[0] = STOPPED;
            return Ok(());
        }
        self.step(state, h).map_err(|why| {
            state[0] = STOPPED;
            ending(&why, "the plant has stopped until the data are reset")
        })
    }

    fn step(&mut self, state: &mut [f64], h: f64) -> Result<(), Failure> {
        self.bring(state)?;
        self.brought = Brought::Nowhere;
        for input in 0..self.host.commands().len() {
            let command = &self.host.commands()[input];
            let actuator = command.actuators[0];
            let (low, high, _) = command.mode.range();
            let [least, most] = self.wires[actuator].range.unwrap_or([low, high]);
            let control = self.ends.controls[actuator];
            if control.is_nan() {
                return Err(Failure::stopped(format!("the control of `{}` is not a number", command.name)));
            }
            // As MuJoCo's own actuators: what is out of range is the end of the range.
            let control = control.max(least).min(most).clamp(low, high);
            let control = if command.mode == CommandMode::Request {
                nearest_request(control, &self.requests[input])
            } else {
                control
            };
            self.host.command(input, control)?;
        }
        self.place_ends(h)?;
        let until = mckibben_run::host::end_of_step(self.host.steps().time(), h);
        self.host.advance(until, &self.distances)?;
        let count = self.wires.len();
        state[0] = UNDER_WAY;
        for at in 0..count {
            state[1 + at] = self.gauge_pressure(at);
        }
        self.host.save(&mut state[head(count)..])?;
        self.here[..state.len()].copy_from_slice(state);
        self.here_acts.copy_from_slice(&state[1..head(count)]);
        self.brought = Brought::To;
        Ok(())
    }

    /// Writes the sensors. Of an instance that has stopped, or has no force here, the tensions are zero, as its forces are; the other sensors keep their
    /// last values. So is the tension of an actuator that MuJoCo has disabled.
    ///
    /// # Errors
    /// Why they cannot be had.
    pub(crate) fn sense(&mut self, state: &[f64], mut write: impl FnMut(usize, f64)) -> Result<(), Failure> {
        if self.is_refused || state[0] == STOPPED {
            let tensions = self.sensors.iter().filter(|(_, quantity, _)| matches!(quantity, PlantQuantity::Tension(_)));
            tensions.for_each(|(address, ..)| write(*address, 0.0));
            return Ok(());
        }
        if self.sensors.is_empty() {
            return Ok(());
        }
        self.respond(state)?;
        self.host.read_outputs(&mut self.outputs)?;
        for (address, quantity, output) in &self.sensors {
            // What depends on where the ends are is that of MuJoCo's own lengths, as the force is.
            let value = match *quantity {
                PlantQuantity::Tension(at) if self.ends.disabled[at] => 0.0,
                PlantQuantity::Tension(at) => self.responses[at].tension,
                PlantQuantity::MassFlow(at) => self.responses[at].mass_flow,
                PlantQuantity::LoadDistance(at) => self.distances[at],
                PlantQuantity::LoadVelocity(at) => self.ends.velocities[at],
                _ => self.outputs[*output],
            };
            write(*address, value);
        }
        Ok(())
    }

    /// Gauge pressure in Pa of an actuator where the plant is.
    pub(crate) fn gauge_pressure(&self, actuator: usize) -> f64 {
        let steps = self.host.steps();
        let plant = steps.plant();
        steps.state()[plant.indices().actuators[actuator].pressure] - plant.network().atmosphere
    }

    /// Takes the distances between the ends where MuJoCo has them, or after so many s at the velocities of the end of the step.
    ///
    /// # Errors
    /// For a distance that is not above zero, with what it is made of. What is no number is left to the plant.
    fn place_ends(&mut self, h: f64) -> Result<(), Failure> {
        for at in 0..self.distances.len() {
            let (length, offset) = (self.ends.lengths[at], self.offsets[at]);
            self.distances[at] =
                if h > 0.0 { length + offset + h * self.ends.next_velocities[at] } else { length + offset };
            if self.distances[at] <= 0.0 {
                // Without the rounding of the sum, for people.
                let (name, distance) = (&self.host.actuators()[at], (1e9 * self.distances[at]).round() / 1e9);
                let title = format!(
                    "`{name}`: a length of {length} m in MuJoCo and a length_offset of {offset} m give a distance of \
                     {distance:?} m between the ends"
                );
                return Err(Failure::input(title, "give a length_offset that leaves a distance above zero"));
            }
        }
        Ok(())
    }

    /// Why a plant cannot begin with its ends where MuJoCo has them, with what the distances are made of.
    fn with_offsets(&self, failure: &Failure) -> Failure {
        let ends = self.host.actuators().iter().zip(&self.ends.lengths).zip(&self.offsets);
        let made = ends.map(|((name, length), offset)| format!("`{name}` {length} m + {offset} m")).collect::<Vec<_>>();
        let help = format!(
            "give a length_offset, negative where a tendon has cables or fittings; distances are MuJoCo's lengths plus it: {}",
            made.join(", ")
        );
        Failure::input(failure.sentence(), help)
    }

    /// Responses where MuJoCo has the ends.
    fn respond(&mut self, state: &[f64]) -> Result<(), Failure> {
        self.bring(state)?;
        self.place_ends(0.0)?;
        self.host.compute_at(&self.distances, &self.ends.velocities, &mut self.responses)
    }

    /// Brings the plant to where the numbers say, with the pressures of `act` where those are others.
    fn bring(&mut self, state: &[f64]) -> Result<(), Failure> {
        if state[0] == FRESH {
            return self.begin();
        }
        let count = self.wires.len();
        let is_here =
            self.brought == Brought::To && same(state, &self.here) && same(self.acts_or(&state[1..]), &self.here_acts);
        if is_here {
            return Ok(());
        }
        self.brought = Brought::Nowhere;
        self.host.restore(&state[head(count)..])?;
        self.take_acts(&state[1..head(count)])?;
        self.here[..state.len()].copy_from_slice(state);
        self.brought = Brought::To;
        Ok(())
    }

    /// Begins where MuJoCo has the ends, unless it has begun there already.
    fn begin(&mut self) -> Result<(), Failure> {
        let count = self.wires.len();
        self.place_ends(0.0)?;
        let begun = &self.here[..2 * count];
        let is_here = self.brought == Brought::Begun
            && same(&self.distances, &begun[..count])
            && same(&self.ends.velocities, &begun[count..])
            && same(self.acts_or(&self.zeros), &self.here_acts);
        if is_here {
            return Ok(());
        }
        self.brought = Brought::Nowhere;
        self.host.begin_at(&self.distances, &self.ends.velocities).map_err(|failure| self.with_offsets(&failure))?;
        let zeros = core::mem::take(&mut self.zeros);
        let taken = self.take_acts(&zeros);
        self.zeros = zeros;
        if taken? {
            // Once more with those pressures, so that hoses begin at them too, and tendons in balance.
            let gauges: Vec<Option<f64>> =
                self.here_acts.iter().map(|gauge| Some(*gauge).filter(|gauge| *gauge != 0.0)).collect();
            let begun = self.host.begin_with_pressures(&self.distances, &self.ends.velocities, &gauges);
            begun.map_err(|failure| failure.of("act"))?;
        }
        self.here[..count].copy_from_slice(&self.distances);
        self.here[count..2 * count].copy_from_slice(&self.ends.velocities);
        self.brought = Brought::Begun;
        Ok(())
    }

    /// The pressures that are to be had: those of `act`, and those given last where there is none.
    fn acts_or<'a>(&'a self, last: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.wires.iter().zip(&self.ends.acts).zip(last).map(|((wire, act), last)| match wire.act {
            Some(_) => *act,
            None => *last,
        })
    }

    /// Sets the pressures of `act` that are not those given last: they were set from outside, as by a keyframe. Returns whether
    /// there are any.
    fn take_acts(&mut self, last: &[f64]) -> Result<bool, Failure> {
        let mut is_any = false;
        for at in 0..self.wires.len() {
            self.here_acts[at] = last[at];
            if self.wires[at].act.is_some() && self.ends.acts[at] != last[at] {
                let set = self.host.steps_mut().set_pressure(at, GaugePressure(self.ends.acts[at]));
                set.map_err(|error| Failure::from(error).of("act"))?;
                self.here_acts[at] = self.ends.acts[at];
                is_any = true;
            }
        }
        Ok(is_any)
    }
}

/// Whether numbers are equal bit for bit.
fn same<'a>(one: impl IntoIterator<Item = impl Borrow<f64>>, other: impl IntoIterator<Item = &'a f64>) -> bool {
    one.into_iter().zip(other).all(|(one, other)| one.borrow().to_bits() == other.to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config;

    const TANK: [(&str, &str); 4] = [
        ("initial.gauge_pressure", "40 psi"),
        ("supply.gauge_pressure", "100 psi"),
        ("supply.reservoir_volume", "50 mL"),
        ("valve.preset", "matrix-eight-channel"),
    ];
    const WIRE: Wire = Wire { output: 0, control: 0, act: None, range: None, group: 0 };

    /// An instance of one muscle with sensors, whose addresses are their places.
    fn instance(keys: &[(&str, &str)], muscle: &str, sensors: &[&str]) -> Result<Instance, Failure> {
        let value = |name: &str| keys.iter().find(|(key, _)| *key == name).map(|(_, value)| *value);
        let config = config::read(value)?;
        let sensors: Vec<(String, usize)> =
            sensors.iter().enumerate().map(|(at, name)| ((*name).to_owned(), at)).collect();
        Instance::new(config, &[(muscle.to_owned(), WIRE)], &sensors)
    }

    /// A step of a muscle of 90 mm under a control; its state.
    fn stepped(instance: &mut Instance, control: f64) -> Result<Vec<f64>, Failure> {
        let mut state = vec![0.0; instance.size()];
        instance.ends.lengths[0] = 0.09;
        instance.ends.controls[0] = control;
        instance.compute(&state)?;
        instance.advance(&mut state, 1e-3)?;
        Ok(state)
    }

    #[test]
    fn a_sensor_reads_the_part_that_it_names() {
        let reads = |muscle: &str, sensor: &str| {
            let made = instance(&TANK, muscle, &[sensor])?;
            Ok::<_, Failure>(made.host.outputs()[made.sensors[0].2].name.clone())
        };
        for (muscle, sensor, output) in [
            ("muscle", "muscle.tension", "actuator.tension"),
            ("muscle", "actuator.tension", "actuator.tension"),
            ("muscle", "tension", "actuator.tension"),
            ("arm/muscle", "arm/muscle.tension", "actuator.tension"),
            ("arm/muscle", "arm/tension", "actuator.tension"),
            ("left.biceps", "left.biceps.gauge_pressure", "actuator.gauge_pressure"),
            ("muscle", "supply.gauge_pressure", "supply.gauge_pressure"),
            ("arm/muscle", "arm/supply.gauge_pressure", "supply.gauge_pressure"),
        ] {
            assert_eq!(reads(muscle, sensor).expect(sensor), output, "{sensor} of {muscle}");
        }
        for sensor in
            ["tank.gauge_pressure", "hose.absolute_pressure", "manifold.temperature", "supply.tension", "warmth", ""]
        {
            let refused = reads("muscle", sensor).expect_err("no output of that name").to_string();
            assert!(refused.contains(&format!("`{sensor}`")) && refused.contains("outputs"), "{refused}");
        }
        // MuJoCo cuts long messages.
        let refused = reads("muscle", "supply.guage_pressure").expect_err("misspelt").to_string();
        assert!(refused.contains("name it after one of supply.gauge_pressure"), "{refused}");
        let refused = reads("arm/muscle", "arm/muscle.tensio").expect_err("misspelt").to_string();
        assert!(refused.contains("name it after one of muscle.tension") && !refused.contains("actuator."), "{refused}");
    }

    #[test]
    fn a_request_that_a_valve_does_not_have_is_the_nearest_that_it_has() {
        let of = |has: &[f64]| [-1.0, -0.6, -0.2, 0.0, 0.2, 0.6, 1.0].map(|control| nearest_request(control, has));
        assert_eq!(of(&[-1.0, 0.0, 1.0]), [-1.0, -1.0, 0.0, 0.0, 0.0, 1.0, 1.0]);
        assert_eq!(of(&[-1.0, 1.0]), [-1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0]);
        assert_eq!(of(&[0.0, 1.0]), [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0]);
        // The control is zero until it is set.
        let mut three_way = instance(&TANK, "muscle", &[]).expect("a muscle");
        assert!(stepped(&mut three_way, 0.0).is_ok_and(|state| state[0] == UNDER_WAY));
    }

    #[test]
    fn a_set_point_above_the_supply_is_the_supply() {
        let keys = [
            ("supply.gauge_pressure", "6 bar"),
            ("valve.kind", "pressure-regulator"),
            ("valve.flow_area", "2 mm^2"),
            ("valve.time_constant", "20 ms"),
            ("valve.rate_limit", "50 bar/s"),
        ];
        let after = |control: f64| {
            let mut instance = instance(&keys, "muscle", &[]).expect("a muscle");
            let mut state = stepped(&mut instance, control).expect("a step");
            (0..500).for_each(|_| instance.advance(&mut state, 1e-3).expect("a step"));
            pressure(&state, 0)
        };
        let (beyond, of_supply) = (after(30e5), after(6e5));
        assert_eq!(beyond.to_bits(), of_supply.to_bits());
        assert!((5e5..6.01e5).contains(&beyond), "{beyond} Pa");
    }

    /// Each pulse of duty one raises the pressure, and each of duty zero lowers it. Sums of 1 ms come after the begin of a
    /// pulse of 25 Hz from 126 pulses on.
    #[test]
    fn a_duty_set_where_a_pulse_begins_is_that_of_the_pulse() {
        let keys = [
            ("initial.gauge_pressure", "40 psi"),
            ("supply.gauge_pressure", "100 psi"),
            ("valve.preset", "matrix-eight-channel"),
            ("pulse_frequency", "25 Hz"),
        ];
        let mut instance = instance(&keys, "muscle", &[]).expect("a muscle");
        let mut state = vec![0.0; instance.size()];
        instance.ends.lengths[0] = 0.09;
        instance.compute(&state).expect("forces");
        let mut before = pressure(&state, 0);
        // MuJoCo may change the step.
        let steps = [(1e-3, 40); 160].into_iter().chain([(2e-3, 20); 160]);
        for (pulse, (h, count)) in steps.enumerate() {
            let duty = f64::from(u8::from(pulse % 2 == 0));
            instance.ends.controls[0] = duty;
            (0..count).for_each(|_| instance.advance(&mut state, h).expect("a step"));
            let after = pressure(&state, 0);
            assert_eq!(after > before, duty == 1.0, "pulse {pulse}: {before} Pa to {after} Pa");
            before = after;
        }
    }

    #[test]
    fn a_distance_that_cannot_be_names_the_offset() {
        for (offset, words) in [
            ("-500 mm", ["length_offset of -0.5 m", "a distance of -0.41 m"]),
            ("500 mm", ["0.09 m + 0.5 m", "give a length_offset"]),
        ] {
            let keys = [&TANK[..], &[("length_offset", offset)]].concat();
            let mut instance = instance(&keys, "muscle", &[]).expect("a muscle");
            let said = stepped(&mut instance, 0.0).expect_err("no such distance").to_string();
            assert!(words.iter().all(|words| said.contains(words)) && !said.contains("initial.length"), "{said}");
        }
    }

    #[test]
    fn the_tension_of_a_muscle_that_has_stopped_is_zero() {
        let mut instance = instance(&TANK, "muscle", &["muscle.gauge_pressure", "muscle.tension"]).expect("a muscle");
        let mut state = stepped(&mut instance, 1.0).expect("a step");
        let mut data = [f64::NAN; 2];
        instance.sense(&state, |address, value| data[address] = value).expect("sensors");
        let [gauge, tension] = data;
        assert!(gauge > 0.0 && tension > 0.0, "{data:?}");
        instance.ends.lengths[0] = 0.5;
        assert!(instance.advance(&mut state, 1e-3).is_err(), "longer than the thread");
        instance.sense(&state, |address, value| data[address] = value).expect("sensors");
        assert_eq!(data, [gauge, 0.0]);
    }

    #[test]
    fn a_look_where_there_is_no_force_changes_nothing() {
        let mut instance = instance(&TANK, "muscle", &["muscle.tension"]).expect("a muscle");
        let mut state = stepped(&mut instance, 1.0).expect("a step");
        let (here, before) = (instance.ends.lengths[0], state.clone());
        instance.compute(&state).expect("a force");
        let tension = instance.tensions(&state).next();
        assert!(tension > Some(0.0));
        instance.ends.lengths[0] = 0.5;
        let said = instance.compute(&state).expect_err("longer than the thread").to_string();
        assert!(said.contains("until the data are reset"), "{said}");
        assert!(instance.compute(&state).is_ok(), "once");
        assert_eq!(instance.tensions(&state).next(), Some(0.0));
        instance.ends.lengths[0] = here;
        instance.compute(&state).expect("a force");
        assert_eq!((instance.tensions(&state).next(), &state), (tension, &before));
        // A step from there is one that cannot be taken.
        instance.ends.lengths[0] = 0.5;
        instance.compute(&state).expect_err("longer than the thread");
        instance.advance(&mut state, 1e-3).expect("said already");
        instance.ends.lengths[0] = here;
        instance.compute(&state).expect("nothing to compute");
        assert_eq!(instance.tensions(&state).next(), Some(0.0));
    }
}
