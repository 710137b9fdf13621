//! The linear line with laminar friction in closed form: what a distributed hose approaches for small signals.
//!
//! ```text
//! series impedance   Z = R' + iωI'        R' = 128 μ/(π d⁴ ρ)        I' = 1/A         per m, for mass flow
//! shunt admittance   Y = iωC'             C' = A/(κRT)
//!
//! Γ = √(ZY) = α + iβ        Z_c = √(Z/Y)        phase speed ω/β → c = √(κRT) for R' ≪ ωI'
//!
//! [P₀]   [cosh ΓL       Z_c sinh ΓL] [P_L]
//! [w₀] = [sinh ΓL/Z_c   cosh ΓL    ] [w_L]
//! ```
//!
//! | symbol | name in code | unit |
//! |---|---|---|
//! | α | `attenuation` | 1/m |
//! | β | `phase_constant` | rad/m |
//! | P_L/P₀ | `response` with a volume at the outlet | – |
//!
//! Source: theory of transmission lines, for pneumatic lines in Rohmann & Grogan, "On the dynamics of pneumatic
//! transmission lines", Trans. ASME 79 (1957). The steady laminar resistance is taken at every frequency.
//! Checked against the cells of a distributed hose by `tests/line_hose.rs`.

use super::hose::Hose;
use crate::scalar::Scalar;
use core::f64::consts::PI;

/// A complex number as its real and imaginary part.
pub type Complex = [f64; 2];

/// What a hose is to small signals about an absolute pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearLine {
    /// R' in Pa·s/(kg·m).
    pub resistance: f64,
    /// I' in 1/m².
    pub inertance: f64,
    /// C' in kg/(m·Pa).
    pub capacitance: f64,
    /// Length in m.
    pub length: f64,
}

impl LinearLine {
    /// A hose at rest near an absolute `pressure` in Pa.
    pub fn new(hose: &Hose, pressure: f64) -> Self {
        let (tube, area) = (hose.tube(), hose.tube().area());
        let density = pressure / tube.pressure_per_density();
        let speed = hose.wave_speed();
        // 128 μ/(π d⁴) is 8 π μ/A².
        let resistance = 8.0 * PI * tube.viscosity() / (area * area * density);
        Self { resistance, inertance: 1.0 / area, capacitance: area / (speed * speed), length: hose.length() }
    }

    /// `[α, β]`: attenuation in 1/m and phase constant in rad/m at an angular frequency in rad/s.
    pub fn propagation(&self, frequency: f64) -> Complex {
        let shunt = [0.0, frequency * self.capacitance];
        root(times([self.resistance, frequency * self.inertance], shunt))
    }

    /// `P_L/P₀` at an angular frequency in rad/s above zero with a volume of `end_capacitance` kg/Pa at the outlet.
    pub fn response(&self, frequency: f64, end_capacitance: f64) -> Complex {
        let series = [self.resistance, frequency * self.inertance];
        let gamma = self.propagation(frequency);
        let characteristic = over(series, gamma);
        let (sinh, cosh) = hyperbolic(times(gamma, [self.length, 0.0]));
        let end = times(times(characteristic, sinh), [0.0, frequency * end_capacitance]);
        over([1.0, 0.0], [cosh[0] + end[0], cosh[1] + end[1]])
    }
}

fn times(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

fn over(a: Complex, b: Complex) -> Complex {
    let size = b[0] * b[0] + b[1] * b[1];
    let [re, im] = times(a, [b[0], -b[1]]);
    [re / size, im / size]
}

/// The root with a real part of zero or more.
fn root(z: Complex) -> Complex {
    let size = Scalar::sqrt(z[0] * z[0] + z[1] * z[1]);
    let real = Scalar::sqrt((0.5 * (size + z[0])).max(0.0));
    let imaginary = Scalar::sqrt((0.5 * (size - z[0])).max(0.0));
    [real, if z[1] < 0.0 { -imaginary } else { imaginary }]
}

fn hyperbolic([re, im]: Complex) -> (Complex, Complex) {
    let (up, down) = (0.5 * Scalar::exp(re), 0.5 * Scalar::exp(-re));
    let (cos, sin) = (Scalar::cos(im), Scalar::sin(im));
    ([(up - down) * cos, (up + down) * sin], [(up + down) * cos, (up - down) * sin])
}
