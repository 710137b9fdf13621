//! Exergy of air: the work that it could do on its way to rest in the atmosphere at `P_0`, `T_0`.
//!
//! ```text
//! a stream, each kg      ψ = c_p (T − T_0) − T_0 [c_p ln(T/T_0) − R ln(P/P_0)]
//! contents               Ξ = m ψ − (P − P_0) V
//! throttled, each kg     R T_0 ln(P_up/P_down)
//! mixed, each kg         c_p T_0 [T_in/T − 1 − ln(T_in/T)]       where air of another temperature flows in
//! lost with heat         −(1 − T_0/T) Q
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | P, T, m, V | absolute pressure, temperature, mass and volume of air | Pa, K, kg, m³ |
//! | P_0, T_0 | absolute pressure and temperature of the network's atmosphere | Pa, K |
//! | c_p, R, γ | heat capacity, gas constant, ratio of heat capacities | J/(kg·K), J/(kg·K), – |
//! | Q, S | heat into the air; stiffness of a volume, Pa for each kilogram that flows in | J, Pa/kg |
//!
//! Hoses and reservoirs have one state, their pressure: `dP/dt = S ṁ` with air at a given temperature T. Their contents are
//! worth what they give as they are let out at that temperature:
//!
//! ```text
//! Ξ = [A P + R T_0 (P ln(P/P_0) − P + P_0)]/S + (1 − T_0/T)(V/(γ − 1) − c_p T/S)(P − P_0)        A = ψ(T, P_0)
//! ```
//!
//! which for an isothermal one, `S = R T/V`, is `m ψ − (P − P_0) V`. Their internal energy is `P V/(γ − 1)`.
//!
//! Source: M. J. Moran and H. N. Shapiro, Fundamentals of Engineering Thermodynamics, chapter 7; `docs/energy.md`.
//! Checked by `tests/plant_ledger.rs`.

use super::Plant;
use crate::network::NodeKind;
use crate::scalar::Scalar;

/// Temperature in K of an atmosphere of which the network says nothing.
const ROOM: f64 = 293.15;

/// The atmosphere and the gas.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DeadState {
    pub(crate) pressure: f64,
    pub(crate) temperature: f64,
    pub(crate) gas_constant: f64,
    /// γ − 1.
    pub(crate) excess: f64,
    /// c_p in J/(kg·K).
    pub(crate) heat_capacity: f64,
}

impl DeadState {
    /// The atmosphere of a plant, at the lowest temperature of its supplies: the air of a compressor cools in the line, and no
    /// order of the supplies counts. Without supplies at the lowest of its nodes of the atmosphere. None without actuators, as no
    /// other part says what gas it is.
    pub(crate) fn of(plant: &Plant) -> Option<Self> {
        let air = plant.actuators().first()?.actuator.air();
        let lowest = |wanted: fn(&NodeKind) -> bool| {
            let nodes = plant.network().nodes.iter().filter(|node| wanted(&node.kind));
            nodes.map(|node| node.temperature).reduce(f64::min)
        };
        let is_supply = |kind: &NodeKind| {
            use NodeKind::{Outlet, Port, Reservoir, Source};
            matches!(kind, Source | Reservoir(_) | Outlet { .. } | Port { .. })
        };
        let outside = || lowest(|kind| matches!(kind, NodeKind::Atmosphere));
        let temperature = lowest(is_supply).or_else(outside).unwrap_or(ROOM);
        let (gas_constant, ratio) = (air.gas_constant(), air.heat_capacity_ratio());
        let heat_capacity = ratio / (ratio - 1.0) * gas_constant;
        Some(Self { pressure: air.atmosphere().0, temperature, gas_constant, excess: ratio - 1.0, heat_capacity })
    }

    /// `R T_0 ln(a/b)` in J/kg: what throttling from one pressure to another destroys.
    pub(crate) fn throttle(&self, a: f64, b: f64) -> f64 {
        self.gas_constant * self.temperature * Scalar::ln(a / b)
    }

    /// `c_p T_0 [r − 1 − ln r]` in J/kg of air whose temperature is `r` times that of what it meets.
    fn apart(&self, ratio: f64) -> f64 {
        self.heat_capacity * self.temperature * (ratio - 1.0 - Scalar::ln(ratio))
    }

    /// ψ in J/kg at a temperature and an absolute pressure.
    pub(crate) fn stream(&self, temperature: f64, pressure: f64) -> f64 {
        self.apart(temperature / self.temperature) + self.throttle(pressure, self.pressure)
    }

    /// What a kilogram destroys that flows in at a temperature to where there is another.
    pub(crate) fn mixed(&self, inflow: f64, temperature: f64) -> f64 {
        self.apart(inflow / temperature)
    }

    /// What is lost with a heat in J into air at a temperature; gained where negative.
    pub(crate) fn lost_with(&self, heat: f64, temperature: f64) -> f64 {
        -(1.0 - self.temperature / temperature) * heat
    }

    /// Ξ in J of a mass of air at a pressure and a temperature in a volume.
    pub(crate) fn contents(&self, mass: f64, [pressure, temperature, volume]: [f64; 3]) -> f64 {
        mass * self.stream(temperature, pressure) - (pressure - self.pressure) * volume
    }

    /// Ξ in J of a volume at a pressure with air at a temperature, whose pressure changes by `stiffness` Pa/kg.
    pub(crate) fn line_contents(&self, [pressure, temperature, volume]: [f64; 3], stiffness: f64) -> f64 {
        let Self { pressure: outside, temperature: ambient, gas_constant, .. } = *self;
        let warm = self.apart(temperature / ambient);
        let by_pressure = pressure * Scalar::ln(pressure / outside) - pressure + outside;
        let own_heat = volume / self.excess - self.heat_capacity * temperature / stiffness;
        (warm * pressure + gas_constant * ambient * by_pressure) / stiffness
            + (1.0 - ambient / temperature) * own_heat * (pressure - outside)
    }
}
