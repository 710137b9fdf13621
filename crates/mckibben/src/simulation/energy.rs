//! The energy audit: where the work of the gas went, and the air.
//!
//! ```text
//! ∫ P_g dV = ∫ (P_g dV + F_s dx) − ΔU              what the law of force takes (or gives): (1 − Eff) ∫ P_g dV, (9)
//!          + ΔU                                    the bladder
//!          + Δ(½ M v²) − W Δx                      the load (or −∫ F dx when its motion is given)
//!          + Δ(½ K_braid (x − L_max)²)             the taut braid
//!          + Δ(½ T²/k)                             a tendon in series
//!          + ∫ c v² dt + ∫ Q k_sec |v| dt          friction
//!          + ∫ k_sec Σ w r |v| dt, slipping         hysteresis: what its elements or bristles dissipate,
//!          + ∫ k_sec Σ w z v dt, not slipping       and what they store
//!          + ∫ (F_limit − K_braid (x − L_max)) v dt    the taut braid's damping and its rebound
//!          + ∫ (F − F_sum) v dt                    a correction of these where a tendon cannot push
//! ```
//!
//! The load and the taut braid are taken from the states, the rest by quadrature over the dense output: that the sum
//! closes is a test of the simulation, to its tolerance, in every run.
//!
//! Each point of the quadrature rounds length and pressure, and so the energies that belong to them, `P V` of the air and
//! `F x` of the ends, by ε of themselves: `ε Σ (P V + |F| x)` over the points is the most that rounding leaves of any term.
//! A turnover below that is itself rounding, and nothing can be judged against it.

use super::circuit::{CircuitAudit, Exergy};
use super::mode::{Extent, Mode};
use super::rig::Rig;
use super::run::{AcceptedStep, RunEnd};
use super::sample::Sample;
use super::trajectory::Trajectory;
use crate::actuator::Actuator;
use crate::air::Flow;
use crate::force::{StaticForce, Statics};
use crate::scalar::Real;

/// Where the work of the gas went, in J, and the air, in kg.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyAudit {
    /// `∫ P_g dV`, the work of the gas beyond that on the surroundings.
    pub gas_work: f64,
    /// Work that an effectiveness below 1 takes out of the model, without a place to go; and with a law of force that is
    /// not the gradient of `P_g V`, what that law takes, or gives when negative.
    pub effectiveness_loss: f64,
    /// Energy that the bladder gained.
    pub bladder_storage: f64,
    /// Energy that the load gained, kinetic and potential; the work on it when its motion is given.
    pub load: f64,
    /// Energy that the taut braid gained.
    pub braid_storage: f64,
    /// Energy that a tendon in series gained.
    pub tendon_storage: f64,
    /// Dissipated by viscous friction.
    pub viscous: f64,
    /// Dissipated by Coulomb friction.
    pub coulomb: f64,
    /// Dissipated by the elements of the hysteresis that slip.
    pub slip: f64,
    /// Work on the elements of the hysteresis that do not slip. It comes back as they are unloaded, but for what a change of
    /// the pressure in between has made of it.
    pub hysteresis_storage: f64,
    /// Dissipated by the taut braid, its rebound included.
    pub braid: f64,
    /// What the friction terms count too little, or too much when negative, while the tension is kept from becoming
    /// negative: a tendon that cannot push does not transmit them.
    pub slack: f64,
    /// Air that came in, in kg.
    pub air_in: f64,
    /// Air that went out, in kg.
    pub air_out: f64,
    /// Air that the actuator and its hose gained, in kg.
    pub air_gain: f64,
    /// The most that rounding may leave of a term, in J: `ε Σ (P V + |F| x)` over the points of the quadrature.
    pub rounding: f64,
}

impl EnergyAudit {
    /// What does not close, in J.
    pub fn residual(&self) -> f64 {
        self.gas_work - self.accounted()
    }

    /// Where the work of the gas is known to have gone, in J.
    pub(super) fn accounted(&self) -> f64 {
        let stored =
            self.load + self.bladder_storage + self.braid_storage + self.tendon_storage + self.hysteresis_storage;
        self.effectiveness_loss + stored + self.dissipated()
    }

    /// Everything dissipated in J.
    pub fn dissipated(&self) -> f64 {
        self.viscous + self.coulomb + self.slip + self.braid + self.slack
    }

    /// Sum of the magnitudes of all terms in J, to which the residual is to be compared.
    pub fn turnover(&self) -> f64 {
        let stored =
            [self.load, self.bladder_storage, self.braid_storage, self.tendon_storage, self.hysteresis_storage];
        let others = [self.gas_work, self.effectiveness_loss, self.dissipated()];
        stored.iter().chain(&others).map(|term| term.abs()).sum()
    }

    /// What does not close in the air, in kg.
    pub fn air_residual(&self) -> f64 {
        self.air_in - self.air_out - self.air_gain
    }
}

impl EnergyAudit {
    /// Adds what happens in an instant of `weight` s: the flows and what is dissipated. Returns the work on the ends in J.
    /// `flow` is that from and to outside of all volumes that are counted; the widths are of the hysteresis, in m over the
    /// secant stiffness, and of what dissipates of it.
    pub(super) fn add<R: Real>(
        &mut self,
        actuator: &Actuator<R>,
        weight: f64,
        sample: &Sample<R>,
        mode: &Mode,
        (flow, widths): (&Flow<R>, [R; 2]),
    ) -> f64 {
        let (limits, friction, law) = (actuator.limits(), actuator.friction(), actuator.law());
        let velocity = sample.velocity;
        let slack = mode.extent == Extent::Slack;
        self.air_in += weight * flow.inward.value();
        self.air_out += weight * flow.outward.value();
        let work_on_ends = -weight * (sample.tension * velocity).value();
        let energies = sample.pressure.0 * sample.volume + sample.tension * sample.length;
        self.rounding += f64::EPSILON * energies.value();
        if slack {
            return work_on_ends;
        }
        let gauge = actuator.gauge(sample.pressure.0);
        let gas_power = (gauge.0 * law.law.volume_slope(sample.length) * velocity).value();
        let static_force = law.force(sample.length, gauge);
        self.gas_work += weight * gas_power;
        self.effectiveness_loss += weight * (gas_power + (static_force * velocity).value());
        let viscous = friction.viscous_force(velocity);
        let direction = R::constant(mode.sliding.direction());
        let pressing = actuator.pressing(sample.length, sample.pressure.0, mode.touch());
        let coulomb = friction.coulomb().sliding(direction, velocity, friction.coulomb().kinetic(pressing));
        let secant = pressing.secant_stiffness();
        let (hysteresis, slipping) = (secant * widths[0], direction * secant * widths[1]);
        let limit = if mode.extent == Extent::Taut { limits.taut_force(sample.length, velocity) } else { R::zero() };
        let stretch = (sample.length - limits.max_length()).larger(R::zero());
        self.viscous += weight * (viscous * velocity).value();
        self.coulomb += weight * (coulomb * velocity).value();
        self.slip += weight * (slipping * velocity).value();
        self.hysteresis_storage += weight * ((hysteresis - slipping) * velocity).value();
        self.braid += weight * ((limit - limits.stiffness() * stretch) * velocity).value();
        let sum = static_force + viscous + coulomb + hysteresis + limit;
        self.slack += weight * ((sample.tension - sum) * velocity).value();
        work_on_ends
    }

    /// Adds what the bladder, the taut braid and the air gained between two samples.
    pub(super) fn add_gains<R: Real>(&mut self, actuator: &Actuator<R>, start: &Sample<R>, end: &Sample<R>) {
        let limits = actuator.limits();
        self.braid_storage += (limits.stored_energy(end.length) - limits.stored_energy(start.length)).value();
        let bladder =
            |sample: &Sample<R>| actuator.law().law.stored_energy(limits.actuator_length(sample.length)).value();
        let bladder_gain = bladder(end) - bladder(start);
        self.bladder_storage += bladder_gain;
        self.effectiveness_loss -= bladder_gain;
        self.air_gain += (end.air_mass - start.air_mass).value();
    }
}

/// The accounts of a run that are added up as it is made: of its energy, and of the exergy of the supply's air.
#[derive(Clone, Debug)]
pub struct Ledger<R: Real = f64> {
    work: EnergyAudit,
    work_on_ends: f64,
    circuit: Option<(Exergy, CircuitAudit)>,
    start: Option<Sample<R>>,
}

impl<R: Real> Ledger<R> {
    /// Nothing yet of a run of `rig`. There is no account of the exergy of an actuator without a valve, which draws nothing,
    /// and of a pressure regulator with a hose or a leak.
    pub fn new(rig: &Rig<R>) -> Self {
        let known = rig.regulator().is_none() || rig.line().is_none();
        let valve = rig.actuator().valve().filter(|_| known);
        let circuit = valve.map(|valve| (Exergy::new(rig.actuator(), valve), CircuitAudit::default()));
        Self { work: EnergyAudit::default(), work_on_ends: 0.0, circuit, start: None }
    }

    /// Adds an accepted step.
    pub fn step(&mut self, step: &AcceptedStep<'_, R>) {
        R::add_to_ledger(self, step);
    }

    pub(crate) fn generic_step(&mut self, step: &AcceptedStep<'_, R>) {
        let (rig, Self { work, work_on_ends, circuit, start }) = (step.rig(), self);
        if start.is_none() && step.holds_start() {
            *start = Some(step.at(R::zero()));
        }
        let (actuator, regulated) = (rig.actuator(), rig.regulator().is_some());
        let valve = actuator.valve();
        step.visit(|weight, sample, phase, flow, widths| {
            let weight = weight.value();
            *work_on_ends += work.add(actuator, weight, sample, &phase.mode, (flow, widths));
            if let (Some((exergy, audit)), Some(valve)) = (circuit.as_mut(), valve) {
                let flows = (phase.through(sample.time), regulated.then_some(flow));
                audit.add(exergy, (actuator, valve), weight, sample, flows);
            }
        });
    }

    /// The energy and air balance of a run that has come to its end, and the account of the exergy if there is one.
    pub fn finish(self, end: &RunEnd<R>) -> (EnergyAudit, Option<CircuitAudit>) {
        R::finish_ledger(self, end)
    }

    pub(crate) fn generic_finish(self, end: &RunEnd<R>) -> (EnergyAudit, Option<CircuitAudit>) {
        let Self { work: mut audit, work_on_ends, circuit, start } = self;
        let (rig, end) = (&end.rig, &end.sample);
        let start = start.unwrap_or(*end);
        audit.add_gains(rig.actuator(), &start, end);
        audit.air_gain += (end.hose_air_mass - start.hose_air_mass).value();
        audit.load = rig.load().inertia().map_or(work_on_ends, |inertia| {
            let kinetic = |velocity: R| (R::constant(0.5) * inertia.mass * velocity * velocity).value();
            let fallen = (inertia.pull * (end.load_distance - start.load_distance)).value();
            kinetic(end.load_velocity) - kinetic(start.load_velocity) - fallen
        });
        if let Some(tendon) = rig.tendon() {
            let stored = |tension: R| (R::constant(0.5) * tension * tension / tendon.stiffness()).value();
            audit.tendon_storage = stored(end.tension) - stored(start.tension);
            audit.load = rig.load().inertia().map_or(0.0, |_| audit.load);
        }
        let circuit = circuit.map(|(exergy, circuit)| CircuitAudit {
            stored: exergy.contents(end) - exergy.contents(&start),
            work: audit,
            ..circuit
        });
        (audit, circuit)
    }
}

impl<R: Real> Trajectory<R> {
    /// The energy and air balance of the whole trajectory.
    pub fn audit(&self) -> EnergyAudit {
        self.accounts().0
    }

    /// The balance of energy and air, and the account of the exergy if there is one, as [`Ledger`] adds them up.
    pub fn accounts(&self) -> (EnergyAudit, Option<CircuitAudit>) {
        let mut ledger = Ledger::new(self.rig());
        self.each_step(|step| ledger.step(step));
        ledger.finish(&self.end())
    }
}
