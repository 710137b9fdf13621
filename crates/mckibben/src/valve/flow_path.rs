//! How the size of a flow path is stated, and what of the [flow law](super::FlowLaw) follows from each way: `G`, r_c
//! and g.
//!
//! The equations and their sources are on the page of `flow.rs`.

use crate::parameter::{self, Parameter};
use crate::scalar::Scalar;
use crate::valve::Port;

/// Density of the reference atmosphere in kg/m³ (ISO 8778).
pub const REFERENCE_DENSITY: f64 = 1.185;
/// Temperature of the reference atmosphere in K (ISO 8778).
pub const REFERENCE_TEMPERATURE: f64 = 293.15;

/// Density of the water that Kv and Cv are measured with, in kg/m³ (15 °C).
const WATER_DENSITY: f64 = 999.1;
/// Pressure drop in Pa at which Kv is measured.
const KV_PRESSURE_DROP: f64 = 1e5;
/// Kv in m³/s of a valve of Cv 1: a US gallon a minute at 1 psi, brought to 1 bar by the root of the drop.
const KV_PER_CV: f64 = 3.785_411_784e-3 / 60.0;
/// Pounds-force per square inch in 1 bar.
const PSI_PER_BAR: f64 = 1e5 * 6.4516e-4 / 4.448_221_615_260_5;

/// The usual ways to state the size of a flow path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FlowStandard<S = f64> {
    /// The paper's orifice (21)(23).
    Orifice {
        /// Effective area `A_p C_q` in m².
        flow_area: S,
    },
    /// ISO 6358-1.
    Iso6358 {
        /// Sonic conductance C in m³/(s·Pa) at the reference atmosphere.
        sonic_conductance: S,
        /// Critical back-pressure ratio b.
        critical_ratio: S,
    },
    /// IEC 60534-2-1, by the metric coefficient.
    Kv {
        /// Flow of water Kv in m³/s at a pressure drop of 1 bar.
        kv: S,
        /// Pressure drop ratio x_T at which air chokes.
        pressure_drop_ratio: S,
    },
    /// IEC 60534-2-1, by the coefficient in US units.
    Cv {
        /// Flow of water Cv in US gallons per minute at a pressure drop of 1 psi.
        cv: S,
        /// Pressure drop ratio x_T at which air chokes.
        pressure_drop_ratio: S,
    },
}

/// The rows of the parameter table that state a flow path.
pub(super) struct Rows {
    flow_area: &'static Parameter,
    sonic_conductance: &'static Parameter,
    critical_ratio: &'static Parameter,
    kv: &'static Parameter,
    cv: &'static Parameter,
    pressure_drop_ratio: &'static Parameter,
}

/// Of the flow path to the supply, and of both where the exhaust has no separate one.
static SUPPLY: Rows = Rows {
    flow_area: &parameter::FLOW_AREA,
    sonic_conductance: &parameter::SONIC_CONDUCTANCE,
    critical_ratio: &parameter::CRITICAL_RATIO,
    kv: &parameter::KV,
    cv: &parameter::CV,
    pressure_drop_ratio: &parameter::PRESSURE_DROP_RATIO,
};
/// Of the flow path to the atmosphere.
static EXHAUST: Rows = Rows {
    flow_area: &parameter::EXHAUST_FLOW_AREA,
    sonic_conductance: &parameter::EXHAUST_SONIC_CONDUCTANCE,
    critical_ratio: &parameter::EXHAUST_CRITICAL_RATIO,
    kv: &parameter::EXHAUST_KV,
    cv: &parameter::EXHAUST_CV,
    pressure_drop_ratio: &parameter::EXHAUST_PRESSURE_DROP_RATIO,
};

impl Rows {
    pub(super) fn of(port: Port) -> &'static Self {
        match port {
            Port::Supply => &SUPPLY,
            Port::Exhaust => &EXHAUST,
        }
    }
}

impl<S: Scalar> FlowStandard<S> {
    /// Applies `number` to each number.
    pub(super) fn try_map<T, E>(
        self,
        rows: &Rows,
        mut number: impl FnMut(&'static Parameter, S) -> Result<T, E>,
    ) -> Result<FlowStandard<T>, E> {
        Ok(match self {
            Self::Orifice { flow_area } => FlowStandard::Orifice { flow_area: number(rows.flow_area, flow_area)? },
            Self::Iso6358 { sonic_conductance, critical_ratio } => FlowStandard::Iso6358 {
                sonic_conductance: number(rows.sonic_conductance, sonic_conductance)?,
                critical_ratio: number(rows.critical_ratio, critical_ratio)?,
            },
            Self::Kv { kv, pressure_drop_ratio } => FlowStandard::Kv {
                kv: number(rows.kv, kv)?,
                pressure_drop_ratio: number(rows.pressure_drop_ratio, pressure_drop_ratio)?,
            },
            Self::Cv { cv, pressure_drop_ratio } => FlowStandard::Cv {
                cv: number(rows.cv, cv)?,
                pressure_drop_ratio: number(rows.pressure_drop_ratio, pressure_drop_ratio)?,
            },
        })
    }

    /// `G` in kg·√K/(s·Pa) and r_c, without the efficiency.
    pub(super) fn size(self, gamma: S, gas_constant: S) -> (S, S) {
        let (one, two) = (S::one(), S::constant(2.0));
        // Kv in m³/s.
        let of_water = |kv: S, pressure_drop_ratio: S| {
            let choked_drop = choked_drop(gamma, pressure_drop_ratio);
            let water = S::constant(WATER_DENSITY / KV_PRESSURE_DROP).sqrt();
            let conductance = kv * water * S::constant(2.0 / 3.0) * (choked_drop / gas_constant).sqrt();
            (conductance, one - choked_drop)
        };
        match self {
            Self::Orifice { flow_area } => {
                let base = two / (gamma + one);
                let conductance = flow_area * (gamma / gas_constant * choked_power(gamma)).sqrt();
                (conductance, base.power(gamma / (gamma - one)))
            }
            Self::Iso6358 { sonic_conductance, critical_ratio } => {
                let density = S::constant(REFERENCE_DENSITY);
                (sonic_conductance * density * S::constant(REFERENCE_TEMPERATURE).sqrt(), critical_ratio)
            }
            Self::Kv { kv, pressure_drop_ratio } => of_water(kv, pressure_drop_ratio),
            Self::Cv { cv, pressure_drop_ratio } => {
                let kv = cv * S::constant(KV_PER_CV) * S::constant(PSI_PER_BAR).sqrt();
                of_water(kv, pressure_drop_ratio)
            }
        }
    }

    /// g = ψ/√(1 − r) at a pressure ratio, written so that nothing cancels as r → 1.
    pub(super) fn analytic_factor(self, gamma: S, r: S) -> S {
        let (one, two) = (S::one(), S::constant(2.0));
        match self {
            Self::Orifice { .. } => {
                let u = r.ln();
                let powers = (two * u / gamma).exp() * ((gamma - one) / gamma * u).exp_m1() / u.exp_m1();
                (two / (gamma - one) * powers / choked_power(gamma)).sqrt()
            }
            Self::Iso6358 { critical_ratio: b, .. } => (one + r - two * b).sqrt() / (one - b),
            Self::Kv { pressure_drop_ratio, .. } | Self::Cv { pressure_drop_ratio, .. } => {
                let choked_drop = choked_drop(gamma, pressure_drop_ratio);
                (S::constant(1.5) - (one - r) / (two * choked_drop)) / choked_drop.sqrt()
            }
        }
    }
}

/// `(2/(γ+1))^((γ+1)/(γ−1))`.
fn choked_power<S: Scalar>(gamma: S) -> S {
    let one = S::one();
    (S::constant(2.0) / (gamma + one)).power((gamma + one) / (gamma - one))
}

/// `x_c` of a gas from x_T, which is air's.
fn choked_drop<S: Scalar>(gamma: S, pressure_drop_ratio: S) -> S {
    gamma / S::constant(1.4) * pressure_drop_ratio
}
