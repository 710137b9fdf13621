//! The ledger of energy and exergy: where the work of the gas went, where the energy of the air, and what its exergy became.
//!
//! ```text
//! work     Σ ∫ P_g dV = Σ actuators [stored, lost] + Σ mechanisms [stored, lost, on given motions] − work of the belt
//! energy   Σ ∫ h dm in − out + Σ Q = Σ ΔU + Σ ∫ P dV
//! exergy   drawn + compressed = Σ ΔΞ + released + throttled + mixed + lost with heat + Σ ∫ P_g dV
//! air      Σ in − out = Σ Δm
//! ```
//!
//! Every part has its own entry. What is stored follows from the states at the two ends of the run, all else is
//! integrated over the dense output; that each sum closes is a test of the run, to its tolerance.
//!
//! All flows are those of the branches: what a source gives is what flows out of it, at its own pressure and temperature, and
//! what flows in from the atmosphere brings the atmosphere's enthalpy. A flow keeps its temperature as it is throttled, and
//! destroys exergy where it meets air of another temperature. `T_0` is the lowest temperature of the supplies.
//!
//! | process | heat |
//! |---|---|
//! | energy balance | `h A (T_wall − T)` |
//! | isothermal | what keeps the temperature |
//! | isentropic, polytropic | what the first law requires: each arriving parcel is given the temperature of the contents |
//!
//! Isothermal volumes of hoses and reservoirs exchange the heat that keeps their temperature; those of another index that of
//! this index.
//!
//! Each point of the quadrature is a sum of eight control points, which rounds pressures, lengths and masses by ε = 8 · 2.2e-16
//! of themselves, and so the energies that belong to them: `ε Σ (P V + |F| x + |E|)` over the points, of the air `ε Σ m c_p T` in addition, is the most that rounding leaves of a
//! sum. A flow ṁ follows from a difference ΔP of pressures, so that it errs by `ε ṁ P/ΔP`. A residual below that is none.
//!
//! The tolerance of the run leaves more open, whatever is turned over ([`Balance::resolution`]): each step errs by up to the
//! tolerance in each state, and so by that part of the energies that there are, and the errors of all steps add up at most. A
//! flow errs by the tolerance times `ṁ P/ΔP`, which counts in air that settles: it is a small difference of two pressures.
//!
//! Source: `docs/energy.md`. Checked by `tests/plant_ledger.rs`.

use super::bookkeeping::Bookkeeper;
use super::feed::Inlets;
use super::trajectory::PlantTrajectory;
use alloc::vec::Vec;

/// What air carried: its mass, enthalpy and exergy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Carried {
    /// Mass in kg.
    pub mass: f64,
    /// Enthalpy `c_p T` of it in J, from absolute zero.
    pub enthalpy: f64,
    /// Its exergy in J.
    pub exergy: f64,
}

impl Carried {
    /// Adds a mass in kg at `enthalpy` and `exergy` in J/kg.
    pub(super) fn add(&mut self, mass: f64, enthalpy: f64, exergy: f64) {
        self.mass += mass;
        self.enthalpy += mass * enthalpy;
        self.exergy += mass * exergy;
    }
}

/// An actuator's part of the ledger, in J unless another unit is named.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ActuatorLedger {
    /// `∫ P_g dV`, the work of the gas beyond that on the atmosphere.
    pub gas_work: f64,
    /// Work that an effectiveness below 1 takes out of the model, and that of a law of force which is not the gradient of
    /// `P_g V`; given where negative.
    pub effectiveness_loss: f64,
    /// Energy that the bladder gained.
    pub bladder_storage: f64,
    /// Energy that the taut braid gained.
    pub braid_storage: f64,
    /// Energy that the tendon in series gained.
    pub tendon_storage: f64,
    /// Dissipated by viscous friction.
    pub viscous: f64,
    /// Dissipated by Coulomb friction.
    pub coulomb: f64,
    /// Dissipated by elements or bristles of the hysteresis that slip.
    pub slip: f64,
    /// Work on those that do not slip; it comes back but for what a change of the pressure has made of it.
    pub hysteresis_storage: f64,
    /// Dissipated by viscoelastic branches.
    pub branches: f64,
    /// Energy that viscoelastic branches gained.
    pub branch_storage: f64,
    /// What changes of the pressure took from it, which the gas does not feel; negative where they added to it.
    pub branch_exchange: f64,
    /// Dissipated by the taut braid, its rebound included.
    pub braid: f64,
    /// What the friction terms count too little, or too much when negative, while the tension is kept from pushing.
    pub slack: f64,
    /// Work on the mechanism, `−∫ F dx`.
    pub work: f64,
    /// Air that it gained, in kg.
    pub air_gain: f64,
    /// Internal energy that its air gained.
    pub internal_energy: f64,
    /// Work on the atmosphere, `P_0 ΔV`.
    pub atmosphere_work: f64,
    /// Heat into its air, by its process.
    pub heat: f64,
    /// Air that a given pressure brought, as warm as the contents, less what went out.
    pub given: Carried,
    /// Mass in kg of what went out where the pressure is given.
    pub vented: f64,
    /// Exergy that its air gained.
    pub exergy_gain: f64,
    /// Exergy destroyed as inflow met air of another temperature.
    pub mixed: f64,
    /// Exergy lost with heat; gained where negative.
    pub heat_loss: f64,
}

impl ActuatorLedger {
    /// Energy in J stored in bladder, braid, tendon, hysteresis and viscoelastic branches.
    pub fn stored(&self) -> f64 {
        self.bladder_storage + self.braid_storage + self.tendon_storage + self.hysteresis_storage + self.branch_storage
    }

    /// Energy in J dissipated by friction and taut braid.
    pub fn dissipated(&self) -> f64 {
        self.viscous + self.coulomb + self.slip + self.branches + self.braid + self.slack
    }

    /// What of the work of its gas is not accounted for, in J.
    pub fn work_residual(&self) -> f64 {
        self.gas_work - self.effectiveness_loss - self.stored() - self.branch_exchange - self.dissipated() - self.work
    }

    /// What it takes of the work of its gas before the mechanism has its part.
    fn taken(&self) -> [f64; 8] {
        let stored = [self.bladder_storage, self.braid_storage, self.tendon_storage, self.hysteresis_storage];
        let [bladder, braid, tendon, hysteresis] = stored;
        let branches = [self.branch_storage, self.branch_exchange];
        [self.effectiveness_loss, bladder, braid, tendon, hysteresis, branches[0], branches[1], self.dissipated()]
    }
}

/// A mechanism's part of the ledger, in J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MechanismLedger {
    /// Kinetic energy gained.
    pub kinetic: f64,
    /// Potential energy gained: gravity, constant forces, springs, and those of stops and belt.
    pub potential: f64,
    /// Dissipated by the damping of joints.
    pub damping: f64,
    /// Dissipated by stops, their rebound included.
    pub stops: f64,
    /// Dissipated between belt and foot.
    pub belt: f64,
    /// Work of the belt's drive.
    pub belt_work: f64,
    /// Work of the actuators on a motion that is given.
    pub driven: f64,
}

impl MechanismLedger {
    /// What it takes of the work of its actuators in J.
    fn taken(&self) -> f64 {
        self.kinetic + self.potential + self.damping + self.stops + self.belt + self.driven - self.belt_work
    }

    fn terms(&self) -> [f64; 7] {
        [self.kinetic, self.potential, self.damping, self.stops, self.belt, self.belt_work, self.driven]
    }
}

/// A node's part of the ledger, in J unless another unit is named. The air of a chamber is in the ledger of its actuator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NodeLedger {
    /// What a source or the atmosphere gave, less what it took; of a regulator without an inlet what its mains gave. The exergy
    /// of what went to the atmosphere stands in the branches that released it.
    pub supplied: Carried,
    /// The least work of a compressor for the mass that a source gave, `m R T_0 ln(P/P_0)`: the isothermal ideal.
    pub least_work: f64,
    /// Air that it gained, in kg, by its states.
    pub air_gain: f64,
    /// Of a hose or a reservoir: what flowed in less what flowed out, in kg, integrated over the dense output. Long fixed steps
    /// leave it apart from `air_gain`.
    pub air_in: f64,
    /// Internal energy that its air gained.
    pub internal_energy: f64,
    /// Heat into its air.
    pub heat: f64,
    /// Exergy that its air gained.
    pub exergy_gain: f64,
    /// Exergy destroyed as inflow met air of another temperature.
    pub mixed: f64,
    /// Exergy destroyed by throttling in a regulator.
    pub throttled: f64,
    /// Exergy of what a regulator let go to the atmosphere.
    pub released: f64,
    /// Mass in kg of that, or of what flowed back where a pressure is given.
    pub vented: f64,
    /// Exergy lost with heat; gained where negative.
    pub heat_loss: f64,
}

/// A branch's part of the ledger.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BranchLedger {
    /// What air carried out of its upstream node, from the branch's `from` to its `to` less the other way.
    pub carried: Carried,
    /// Exergy in J destroyed by throttling, but for that of air on its way into the atmosphere. Of a cell of a distributed hose
    /// with what sets its air in motion.
    pub throttled: f64,
    /// Exergy in J of the air as it left for the atmosphere, less that of what came from there.
    pub released: f64,
    /// Least work in J of a compressor for what it delivered, at `T_0`.
    pub compressed: f64,
    /// What branches alike drew that are not a part of the plant.
    pub others: Carried,
}

/// A sum that should be zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Balance {
    /// What does not close, in J, or kg of air.
    pub residual: f64,
    /// Sum of the magnitudes of all terms.
    pub turnover: f64,
    /// The most that rounding may leave of the sum.
    pub rounding: f64,
    /// The most that the tolerance of the run may leave whatever is turned over: in each step its part of the energies, or the
    /// air, that there are, and of flows between nearly equal pressures.
    pub resolution: f64,
}

impl Balance {
    /// Whether the residual is at most a `relative` part of the turnover, beyond rounding and resolution.
    pub fn closes(&self, relative: f64) -> bool {
        self.residual.abs() <= self.rounding + self.resolution + relative * self.turnover
    }

    /// The residual beyond rounding as a part of the turnover: zero where there is none.
    pub fn imbalance(&self) -> f64 {
        let beyond = self.residual.abs() - self.rounding;
        if beyond > 0.0 { beyond / self.turnover } else { 0.0 }
    }

    fn of(
        gives: impl Iterator<Item = f64>,
        takes: impl Iterator<Item = f64>,
        [rounding, resolution]: [f64; 2],
    ) -> Self {
        let mut balance = Self { residual: 0.0, turnover: 0.0, rounding, resolution };
        for (sign, term) in gives.map(|term| (1.0, term)).chain(takes.map(|term| (-1.0, term))) {
            balance.residual += sign * term;
            balance.turnover += term.abs();
        }
        balance
    }

    /// With another that what it gives goes on to.
    fn with(self, other: &Self) -> Self {
        Self {
            residual: self.residual + other.residual,
            turnover: self.turnover + other.turnover,
            rounding: self.rounding + other.rounding,
            resolution: self.resolution + other.resolution,
        }
    }
}

/// Where energy and exergy of a run went, part by part, in the order of the plant's parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlantLedger {
    /// The actuators.
    pub actuators: Vec<ActuatorLedger>,
    /// The mechanisms.
    pub mechanisms: Vec<MechanismLedger>,
    /// The nodes of the air network.
    pub nodes: Vec<NodeLedger>,
    /// Its branches.
    pub branches: Vec<BranchLedger>,
    /// Where air comes into the actuators.
    pub(super) inlets: Inlets,
    /// `T_0` in K from which exergy counts; none of a plant without actuators.
    pub(super) reference_temperature: Option<f64>,
    /// Rounding and resolution of the work, and those of the air in addition, in J; of the air's mass in kg.
    pub(super) errors: [[f64; 2]; 3],
}

/// The ledger summed up, in J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LedgerTotal {
    /// Exergy drawn from sources, mains and given pressures, less what went back.
    pub drawn: f64,
    /// Least work of the compressors in the plant.
    pub compressed: f64,
    /// Least work of a compressor for what sources gave.
    pub least_work: f64,
    /// Exergy that the air gained in actuators, hoses and reservoirs.
    pub stored: f64,
    /// Exergy of the air as it left through valves and regulators for the atmosphere.
    pub exhaust: f64,
    /// Exergy of the air that leaked.
    pub leaked: f64,
    /// Exergy destroyed in valves, hoses and regulators.
    pub throttled: f64,
    /// Exergy destroyed as inflow met air of another temperature.
    pub mixed: f64,
    /// Exergy lost with heat; gained where negative.
    pub heat_loss: f64,
    /// Exergy of the air that actuators alike took which are not a part of the plant.
    pub others: f64,
    /// Heat into the air.
    pub heat: f64,
    /// Work of the gas beyond that on the atmosphere.
    pub gas_work: f64,
    /// Work that effectivenesses took.
    pub effectiveness_loss: f64,
    /// Energy that bladders, braids, tendons and hysteresis gained.
    pub elastic: f64,
    /// Dissipated by friction and taut braids.
    pub dissipated: f64,
    /// Work on the mechanisms.
    pub work: f64,
    /// Work of actuators alike that are not a part of the plant: each does what the one does that stands for it.
    pub work_of_others: f64,
}

impl LedgerTotal {
    /// Work on the mechanisms, that of others alike included, over the exergy that was supplied, drawn and compressed, which feeds
    /// them all; none where none was. Of a cycle it is the efficiency; of a run that ends in another state than it began, what is
    /// stored belongs to it too.
    pub fn efficiency(&self) -> Option<f64> {
        let supplied = self.drawn + self.compressed;
        (supplied > 0.0).then(|| (self.work + self.work_of_others) / supplied)
    }
}

impl PlantLedger {
    /// The work: from the gas to the mechanisms.
    pub fn work(&self) -> Balance {
        let gas = self.actuators.iter().map(|of| of.gas_work);
        let belts = self.mechanisms.iter().map(|of| of.belt_work);
        let within = self.actuators.iter().flat_map(|of| of.taken());
        let taken = self.mechanisms.iter().flat_map(|of| {
            let [kinetic, potential, damping, stops, belt, _, driven] = of.terms();
            [kinetic, potential, damping, stops, belt, driven]
        });
        Balance::of(gas.chain(belts), within.chain(taken), self.errors[0])
    }

    /// What of the actuators' work on a mechanism is not accounted for there, in J: `members` are the mechanism's actuators.
    pub fn mechanism_residual(&self, mechanism: usize, members: &[usize]) -> f64 {
        members.iter().map(|&i| self.actuators[i].work).sum::<f64>() - self.mechanisms[mechanism].taken()
    }

    /// The energy: enthalpy, heat and internal energy of all air by the first law, and the work.
    pub fn energy(&self) -> Balance {
        let given = self.actuators.iter().flat_map(|of| [of.given.enthalpy, of.heat]);
        let nodes = self.nodes.iter().flat_map(|of| [of.supplied.enthalpy, of.heat]);
        let others = self.branches.iter().map(|of| of.others.enthalpy);
        let inside = self.actuators.iter().flat_map(|of| [of.internal_energy, of.atmosphere_work, of.gas_work]);
        let takes = inside.chain(self.nodes.iter().map(|of| of.internal_energy)).chain(others);
        Balance::of(given.chain(nodes), takes, self.errors[1]).with(&self.work())
    }

    /// The exergy: from what was supplied to where it was used or destroyed, the work included.
    pub fn exergy(&self) -> Balance {
        let given = self.actuators.iter().map(|of| of.given.exergy);
        let gives = given.chain(self.nodes.iter().map(|of| of.supplied.exergy));
        let gives = gives.chain(self.branches.iter().map(|of| of.compressed));
        let branches = self.branches.iter().flat_map(|of| [of.released, of.throttled, of.others.exergy]);
        let nodes =
            self.nodes.iter().flat_map(|of| [of.exergy_gain, of.mixed, of.throttled, of.released, of.heat_loss]);
        let within = self.actuators.iter().flat_map(|of| [of.exergy_gain, of.mixed, of.heat_loss, of.gas_work]);
        Balance::of(gives, branches.chain(nodes).chain(within), self.errors[1]).with(&self.work())
    }

    /// The mass of the air.
    pub fn air(&self) -> Balance {
        let gives = self.actuators.iter().map(|of| of.given.mass).chain(self.nodes.iter().map(|of| of.supplied.mass));
        let gains = self.actuators.iter().map(|of| of.air_gain).chain(self.nodes.iter().map(|of| of.air_gain));
        Balance::of(gives, gains.chain(self.branches.iter().map(|of| of.others.mass)), self.errors[2])
    }

    /// Temperature `T_0` in K of the atmosphere from which exergy counts; none of a plant without actuators.
    pub fn reference_temperature(&self) -> Option<f64> {
        self.reference_temperature
    }

    /// Whether a pressure is given, of an actuator or at the end of its hose: air comes in there without a valve.
    pub fn has_given_pressure(&self) -> bool {
        self.inlets.has_given
    }

    /// The air in kg that came into the actuators: what valves let in from their supplies, less what went back, and what came in
    /// where a pressure is given. What a pressure regulator lets out goes to the atmosphere, and so does what leaves at a given
    /// pressure: neither is given back. What fills a manifold is counted once, where it leaves it.
    ///
    /// What came from tanks alone is what these lost, by their states. All other air is the integral of the flows.
    pub fn air_used(&self) -> f64 {
        let Inlets { branches, nodes, stores, .. } = &self.inlets;
        let through = |of: fn(&BranchLedger) -> f64| -> f64 {
            self.branches.iter().zip(branches).filter(|(_, is_inlet)| **is_inlet).map(|(its, _)| of(its)).sum()
        };
        let [let_in, others] = [through(|of| of.carried.mass), through(|of| of.others.mass)];
        let of_nodes = self.nodes.iter().zip(nodes).filter(|(_, feeds)| **feeds);
        let at_nodes: f64 = of_nodes.map(|(of, _)| of.supplied.mass + of.vented).sum();
        let given: f64 = self.actuators.iter().map(|of| of.given.mass + of.vented).sum();
        let of_stores = self.nodes.iter().zip(stores).filter(|(_, stores)| **stores);
        let missing: f64 = of_stores.map(|(of, _)| of.air_in - of.air_gain).sum();
        // Others alike took their part of what the tanks lost.
        let all = let_in + others;
        let part = if all == 0.0 { 1.0 } else { let_in / all };
        // The sum of nothing is −0, which is not printed as a mass.
        let_in + missing * part + at_nodes + given + 0.0
    }

    /// The sums over all parts.
    pub fn total(&self) -> LedgerTotal {
        let mut total = LedgerTotal::default();
        for (of, copies) in self.actuators.iter().zip(&self.inlets.copies) {
            total.work_of_others += (copies - 1.0) * of.work;
        }
        for of in &self.actuators {
            total.drawn += of.given.exergy;
            total.stored += of.exergy_gain;
            total.mixed += of.mixed;
            total.heat_loss += of.heat_loss;
            total.heat += of.heat;
            total.gas_work += of.gas_work;
            total.effectiveness_loss += of.effectiveness_loss;
            total.elastic += of.stored();
            total.dissipated += of.dissipated();
            total.work += of.work;
        }
        for of in &self.nodes {
            total.drawn += of.supplied.exergy;
            total.least_work += of.least_work;
            total.stored += of.exergy_gain;
            total.exhaust += of.released;
            total.throttled += of.throttled;
            total.mixed += of.mixed;
            total.heat_loss += of.heat_loss;
            total.heat += of.heat;
        }
        for (of, leaks) in self.branches.iter().zip(&self.inlets.leaks) {
            *(if *leaks { &mut total.leaked } else { &mut total.exhaust }) += of.released;
            total.throttled += of.throttled;
            total.compressed += of.compressed;
            total.others += of.others.exergy;
        }
        total
    }
}

impl PlantTrajectory {
    /// The ledger of energy and exergy of the whole run.
    pub fn ledger(&self) -> PlantLedger {
        let mut keeper = Bookkeeper::new(self.plant(), self.stepping());
        self.each_piece(|piece| keeper.add(piece));
        let (state, mode) = self.at(self.duration());
        keeper.finish(self.duration(), &state, mode)
    }
}
