//! The energy audit of a whole circuit: what the air from the supply could have done, and where that went.
//!
//! Exergy is the work that air could do on its way to rest in the surroundings at `T_0`, `P_0`:
//!
//! ```text
//! a stream, each kg    ψ = c_p (T − T_0) − T_0 [c_p ln(T/T_0) − R ln(P/P_0)]     at T = T_0:  R T_0 ln(P/P_0)
//! the contents         Ξ = m ψ − (P − P_0) V
//!
//! ∫ ψ_s dm_s = ΔΞ                                   left in the actuator
//!            + ∫ ψ dm_out                            thrown out with the exhaust
//!            + ∫ R T_0 ln(P_upstream/P) dm_in        destroyed in the open valve
//!            + ∫ T_0 c_p [T_in/T − 1 − ln(T_in/T)] dm_in    destroyed as inflow mixes
//!            − ∫ (1 − T_0/T) dQ                      lost through heat
//!            + ∫ P_g dV                              the work of the gas; energy.rs says where it went
//! ```
//!
//! The heat is what the first law asks for. In an energy balance it is `h A (T_wall − T)` and in an isothermal one what
//! keeps the temperature. The paper's (19) has none by name but implies `dQ = c_p (T − T_in) dm_in`: each arriving parcel
//! is given the temperature of the contents, from nowhere.
//!
//! A pressure regulator draws what flows in from the supply and lets what flows out go to the surroundings; the throttling in
//! its own seats counts with that of the passage. The air that it needs for itself is left out.
//!
//! `T_0` is the temperature of the supply: air that a compressor has made and that has cooled in the line.
//!
//! Source: M. J. Moran and H. N. Shapiro, Fundamentals of Engineering Thermodynamics, chapter 7 (exergy of a system and of
//! a stream, exergy balance of a control volume). Checked by `tests/circuit.rs`: filling in closed form, and the sum.

use super::energy::EnergyAudit;
use super::mode::Extent;
use super::sample::Sample;
use super::trajectory::Trajectory;
use super::zones::Through;
use crate::actuator::Actuator;
use crate::air::Flow;
use crate::scalar::{Real, Scalar};
use crate::valve::Valve;

/// Where the exergy of the air from the supply went, in J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CircuitAudit {
    /// Exergy drawn from the supply, less what went back into it.
    pub drawn: f64,
    /// Least work of a compressor for the mass that was drawn, `m R T_0 ln(P_s/P_0)`: the isothermal ideal.
    pub compressor: f64,
    /// Exergy that the air in the actuator gained.
    pub stored: f64,
    /// Exergy of the air as it leaves the actuator for the surroundings, less that of what came in from there.
    pub exhaust: f64,
    /// Destroyed in the valve on the way in, and on a way back into the supply.
    pub throttled: f64,
    /// Destroyed as inflow mixes with air of another temperature.
    pub mixed: f64,
    /// Lost through heat; gained where negative.
    pub heat: f64,
    /// Heat that came in by the first law, in J of energy: under the paper's (19) energy from nowhere.
    pub heat_gain: f64,
    /// The most that rounding may leave of a term, in J, but for those of the work: `ε Σ m c_p T` over the points of the
    /// quadrature.
    pub rounding: f64,
    /// Where the work of the gas went.
    pub work: EnergyAudit,
}

impl CircuitAudit {
    /// What does not close in J, the audit of the work included.
    pub fn residual(&self) -> f64 {
        let lost = self.exhaust + self.throttled + self.mixed + self.heat;
        self.drawn - self.stored - lost - self.work.accounted()
    }

    /// Sum of the magnitudes of all terms in J, to which the residual is to be compared.
    pub fn turnover(&self) -> f64 {
        let terms = [self.drawn, self.stored, self.exhaust, self.throttled, self.mixed, self.heat];
        terms.iter().map(|term| term.abs()).sum::<f64>() + self.work.turnover()
    }

    /// The most that rounding may leave of a term, in J, those of the work included.
    pub fn rounding(&self) -> f64 {
        self.rounding + self.work.rounding
    }

    /// Net work on the load over the exergy drawn; none where nothing was drawn. Of a cycle it is the efficiency; of a run
    /// that ends in another state than it began, what is stored belongs to the balance too.
    pub fn efficiency(&self) -> Option<f64> {
        (self.drawn > 0.0).then(|| self.work.load / self.drawn)
    }

    /// Net work on the load over the least work of a compressor; none where nothing was drawn.
    pub fn compressor_efficiency(&self) -> Option<f64> {
        (self.compressor > 0.0).then(|| self.work.load / self.compressor)
    }
}

/// The surroundings and the gas.
#[derive(Clone, Debug)]
pub(super) struct Exergy {
    temperature: f64,
    pressure: f64,
    gas_constant: f64,
    heat_capacity: f64,
}

impl Exergy {
    pub(super) fn new<R: Real>(actuator: &Actuator<R>, valve: &Valve<R>) -> Self {
        let air = actuator.air();
        let (gas_constant, ratio) = (air.gas_constant().value(), air.heat_capacity_ratio().value());
        Self {
            temperature: valve.supply.temperature().value(),
            pressure: air.atmosphere().0.value(),
            gas_constant,
            heat_capacity: ratio / (ratio - 1.0) * gas_constant,
        }
    }

    /// `R T_0 ln(a/b)` in J/kg: what a throttle from one pressure to another destroys.
    fn throttle(&self, a: f64, b: f64) -> f64 {
        self.gas_constant * self.temperature * Scalar::ln(a / b)
    }

    /// Exergy of a stream in J/kg at a temperature and an absolute pressure.
    fn stream(&self, temperature: f64, pressure: f64) -> f64 {
        let relative = temperature / self.temperature;
        self.heat_capacity * self.temperature * (relative - 1.0 - Scalar::ln(relative))
            + self.throttle(pressure, self.pressure)
    }

    /// Exergy of the contents in J.
    pub(super) fn contents<R: Real>(&self, sample: &Sample<R>) -> f64 {
        let pressure = sample.pressure.0.value();
        let of_mass = sample.air_mass.value() * self.stream(sample.temperature.value(), pressure);
        of_mass - (pressure - self.pressure) * sample.volume.value()
    }
}

impl CircuitAudit {
    /// Adds the air of an instant of `weight` s.
    pub(super) fn add<R: Real>(
        &mut self,
        exergy: &Exergy,
        (actuator, valve): (&Actuator<R>, &Valve<R>),
        weight: f64,
        sample: &Sample<R>,
        (through, regulated): (Through<'_, R>, Option<&Flow<R>>),
    ) {
        let mode = through.mode;
        let slack = mode.extent == Extent::Slack;
        let chamber = actuator.chamber(sample.length, sample.velocity, sample.pressure.0, sample.air_mass, slack);
        let [supply, surroundings] = match regulated {
            Some(&Flow { inward, outward }) => {
                [Flow { inward, outward: R::zero() }, Flow { inward: R::zero(), outward }]
            }
            None => {
                let flows = [
                    actuator.flow(&chamber, mode.ports.supply, false),
                    actuator.flow(&chamber, false, mode.ports.exhaust),
                ];
                match through.shares {
                    None => flows,
                    Some([supply, exhaust]) => [flows[0].through(supply), flows[1].through(exhaust)],
                }
            }
        };
        let [from_supply, to_supply] = [supply.inward, supply.outward].map(|flow| weight * flow.value());
        let [from_outside, to_outside] = [surroundings.inward, surroundings.outward].map(|flow| weight * flow.value());
        let (pressure, temperature) = (sample.pressure.0.value(), sample.temperature.value());
        let (source, inflow) = (valve.supply.pressure().0.value(), valve.supply.temperature().value());

        self.rounding += f64::EPSILON * exergy.heat_capacity * temperature * sample.air_mass.value();
        self.drawn += from_supply * exergy.stream(inflow, source) - to_supply * exergy.stream(temperature, source);
        self.compressor += (from_supply - to_supply) * exergy.throttle(source, exergy.pressure);
        self.exhaust +=
            to_outside * exergy.stream(temperature, pressure) - from_outside * exergy.stream(inflow, exergy.pressure);
        self.throttled += (from_supply - to_supply) * exergy.throttle(source, pressure)
            + from_outside * exergy.throttle(exergy.pressure, pressure);
        let relative = inflow / temperature;
        let inward = from_supply + from_outside;
        self.mixed += inward * exergy.heat_capacity * exergy.temperature * (relative - 1.0 - Scalar::ln(relative));

        // The heat is what the first law asks for: dU = dQ − P dV + h_in dm_in − h dm_out, with U = P V c_v/R.
        let flow = supply.and(surroundings);
        let pressure_rate = actuator.pressure_rate(&chamber, &flow).value();
        let (volume, volume_rate) = (chamber.volume.value(), chamber.volume_rate.value());
        let capacity = exergy.heat_capacity / exergy.gas_constant;
        let energy_and_work = (capacity - 1.0) * pressure_rate * volume + capacity * pressure * volume_rate;
        let enthalpy = inflow * inward - temperature * (to_supply + to_outside);
        let heat = weight * energy_and_work - exergy.heat_capacity * enthalpy;
        self.heat_gain += heat;
        self.heat -= (1.0 - exergy.temperature / temperature) * heat;
    }
}

impl<R: Real> Trajectory<R> {
    /// The exergy of the whole circuit; none for an actuator without a valve, which draws nothing, and none for a pressure
    /// regulator with a hose or a leak, which the account does not know.
    pub fn circuit(&self) -> Option<CircuitAudit> {
        self.accounts().1
    }
}
