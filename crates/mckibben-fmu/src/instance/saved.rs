//! An instance as a value: saved, returned to, and as bytes for another process.
//!
//! ```text
//! "mckibfmu"  version  token (38)  phase  counts (4)   then numbers in 8 bytes each, all little-endian
//! ```

use super::{Inputs, Instance, Kind, Phase, Refusal};
use mckibben::plant::EventUpdate;
use mckibben_run::host::HostPlant;

/// How bytes of a state begin.
const MAGIC: &[u8; 8] = b"mckibfmu";
/// The version of their layout.
const VERSION: u32 = 3;
/// Bytes of a token.
const TOKEN: usize = 38;
/// Bytes before the numbers.
const HEAD: usize = 8 + 4 + TOKEN + 4 + 4 * 4;

const PHASES: [Phase; 6] =
    [Phase::Instantiated, Phase::Initialization, Phase::Event, Phase::Step, Phase::Continuous, Phase::Terminated];

/// A state of an instance.
#[derive(Clone, Debug, PartialEq)]
pub struct Saved {
    token: String,
    kind: Kind,
    phase: Phase,
    /// The state of the plant.
    plant: Vec<f64>,
    parameters: Vec<f64>,
    built: Vec<f64>,
    inputs: Inputs,
    /// Not a number where nothing has been sent.
    sent: Vec<f64>,
    entered: Vec<f64>,
    is_stale: bool,
    offset: f64,
    stop: f64,
    tolerance: f64,
}

impl Instance {
    /// Saves where the instance is.
    ///
    /// # Errors
    /// Where the state cannot be saved: more than 64 commands of one valve are on their way.
    pub fn save(&mut self) -> Result<Saved, Refusal> {
        let plant = self.plant_state()?;
        Ok(Saved {
            token: self.model.token().to_owned(),
            kind: self.kind,
            phase: self.phase,
            plant,
            parameters: self.parameters.clone(),
            built: self.built.clone(),
            inputs: self.inputs.clone(),
            sent: self.sent.iter().map(|number| number.unwrap_or(f64::NAN)).collect(),
            entered: self.entered.clone(),
            is_stale: self.is_stale,
            offset: self.offset,
            stop: self.stop,
            tolerance: self.tolerance,
        })
    }

    /// The state of the plant as numbers.
    pub(super) fn plant_state(&mut self) -> Result<Vec<f64>, Refusal> {
        let mut numbers = vec![0.0; self.plant.state_size()];
        match self.plant.steps_mut().save_to(&mut numbers) {
            Ok(()) => Ok(numbers),
            // Drivers there are none: the host commands the valves.
            Err(mckibben::Error::NotImplemented(_)) => Err(Refusal::error(
                "more than 64 commands of one valve are within its dead time, and the state cannot be saved; set the input less \
                 often, or save the state later",
            )),
            Err(other) => Err(other.into()),
        }
    }

    /// Returns to a state that an instance of the same unit has saved.
    ///
    /// # Errors
    /// For a state of another unit, and one that is none. The instance is then where it was.
    pub fn restore(&mut self, saved: &Saved) -> Result<(), Refusal> {
        if saved.token != self.model.token() {
            return Err(Refusal::error("the state is of another unit"));
        }
        if (saved.kind == Kind::ModelExchange) != (self.kind == Kind::ModelExchange) {
            return Err(Refusal::error("the state is of an instance that was made for the other interface"));
        }
        let same = |ours: &[f64], theirs: &[f64]| {
            ours.iter().map(|its| its.to_bits()).eq(theirs.iter().map(|its| its.to_bits()))
        };
        if same(&self.built, &saved.built) {
            let before = self.plant_state()?;
            self.plant.restore(&saved.plant)?;
            if let Err(refusal) = check_pulses(&self.plant) {
                self.plant.restore(&before)?;
                return Err(refusal);
            }
        } else {
            let mut plant = self.model.build(&saved.built)?;
            plant.state_size();
            plant.restore(&saved.plant)?;
            check_pulses(&plant)?;
            self.plant = plant;
        }
        self.exchange = None;
        // What has been passed before an update is not saved: the host then reads states and their usual sizes again.
        let moved = EventUpdate { events: 1, has_moved: true, next: f64::INFINITY };
        self.passed = Some(moved).filter(|_| saved.phase == Phase::Event);
        self.phase = saved.phase;
        self.parameters.clone_from(&saved.parameters);
        self.built.clone_from(&saved.built);
        self.inputs.clone_from(&saved.inputs);
        self.sent = saved.sent.iter().map(|number| Some(*number).filter(|number| !number.is_nan())).collect();
        self.entered.clone_from(&saved.entered);
        (self.is_stale, self.offset, self.stop) = (saved.is_stale, saved.offset, saved.stop);
        self.tolerance = saved.tolerance;
        self.are_outputs_known = false;
        Ok(())
    }

    /// A state from its bytes.
    ///
    /// # Errors
    /// For bytes that are no state of this unit.
    pub fn saved_from(&self, bytes: &[u8]) -> Result<Saved, Refusal> {
        self.read_saved(bytes).ok_or_else(|| Refusal::error("the bytes are no state of this unit"))
    }

    fn read_saved(&self, bytes: &[u8]) -> Option<Saved> {
        let (head, body) = bytes.split_at_checked(HEAD)?;
        let mut head = head;
        let mut take = |count: usize| {
            let (taken, behind) = head.split_at_checked(count)?;
            head = behind;
            Some(taken)
        };
        let number = |bytes: &[u8]| bytes.try_into().map(u32::from_le_bytes).ok();
        if take(8)? != MAGIC || number(take(4)?)? != VERSION || take(TOKEN)? != self.model.token().as_bytes() {
            return None;
        }
        let number_of_phase = usize::try_from(number(take(4)?)?).ok()?;
        let phase = *PHASES.get(number_of_phase.checked_sub(self.first_phase())?)?;
        let counts = [self.scratch_size(), self.parameters.len(), self.sent.len(), self.entered.len()];
        for count in counts {
            if usize::try_from(number(take(4)?)?).ok()? != count {
                return None;
            }
        }
        let numbers: Vec<f64> = body.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        let [plant, parameters, commands, motions] = counts;
        if body.len() != 8 * (plant + 2 * parameters + 2 * commands + 5 * motions + 4) {
            return None;
        }
        let mut rest = numbers.as_slice();
        let mut list = |count: usize| {
            let (taken, behind) = rest.split_at(count);
            rest = behind;
            taken.to_vec()
        };
        let flags = |numbers: Vec<f64>| numbers.iter().map(|number| *number != 0.0).collect();
        let saved = Saved {
            token: self.model.token().to_owned(),
            kind: self.kind,
            phase,
            plant: list(plant),
            parameters: list(parameters),
            built: list(parameters),
            inputs: Inputs {
                commands: list(commands),
                distances: list(motions),
                rates: list(motions),
                are_distances_set: flags(list(motions)),
                are_rates_set: flags(list(motions)),
            },
            sent: list(commands),
            entered: list(motions),
            is_stale: list(1)[0] != 0.0,
            offset: list(1)[0],
            stop: list(1)[0],
            tolerance: list(1)[0],
        };
        let is_run = saved.offset.is_finite() && saved.stop >= saved.offset;
        let is_finite = is_run && (1e-12..=1.0).contains(&saved.tolerance);
        let is_input = |numbers: &[f64]| numbers.iter().all(|number| number.is_finite());
        let Inputs { commands, distances, rates, .. } = &saved.inputs;
        let is_taken = commands.iter().enumerate().all(|(index, number)| self.may_take(index, *number));
        (is_finite && is_taken && is_input(distances) && is_input(rates) && is_input(&saved.entered)).then_some(saved)
    }

    /// The number of the first phase in bytes: those of model exchange stand behind those of co-simulation.
    fn first_phase(&self) -> usize {
        if self.kind == Kind::ModelExchange { PHASES.len() } else { 0 }
    }

    /// How many numbers the state of the plant is.
    fn scratch_size(&self) -> usize {
        self.plant.clone().state_size()
    }
}

/// That no pulse of a state is long overdue: bytes that were changed may say so, and laying them out would never end.
fn check_pulses(plant: &HostPlant) -> Result<(), Refusal> {
    let (edge, time) = (plant.steps().pulse_edge(), plant.steps().time());
    if edge.is_finite() && edge < time - 1.0 {
        return Err(Refusal::error("the bytes are no state of this unit"));
    }
    Ok(())
}

impl Saved {
    /// How many bytes it is.
    pub fn size(&self) -> usize {
        HEAD + 8 * self.numbers().count()
    }

    fn numbers(&self) -> impl Iterator<Item = f64> + '_ {
        let Inputs { commands, distances, rates, are_distances_set, are_rates_set } = &self.inputs;
        let number = |flag: bool| f64::from(u8::from(flag));
        let flags = [are_distances_set, are_rates_set].into_iter().flatten().map(move |flag| number(*flag));
        let first =
            [&self.plant, &self.parameters, &self.built, commands, distances, rates].into_iter().flatten().copied();
        let behind = [&self.sent, &self.entered].into_iter().flatten().copied();
        first.chain(flags).chain(behind).chain([number(self.is_stale), self.offset, self.stop, self.tolerance])
    }

    /// Its bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(self.token.as_bytes());
        let phase = PHASES.iter().position(|phase| *phase == self.phase).unwrap_or(0);
        let phase = phase + if self.kind == Kind::ModelExchange { PHASES.len() } else { 0 };
        for number in [phase, self.plant.len(), self.parameters.len(), self.sent.len(), self.entered.len()] {
            bytes.extend((number as u32).to_le_bytes());
        }
        self.numbers().for_each(|number| bytes.extend(number.to_le_bytes()));
        bytes
    }
}
