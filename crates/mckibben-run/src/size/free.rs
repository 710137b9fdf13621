//! The smallest braid of a braid angle that moves a load over a stroke.
//!
//! ```text
//! F = Eff P π D₀²/4 (3 u² cos²θ₀ − 1)/sin²θ₀           (3) at L = u L₀,  u = 1 − ε
//! stroke = ε L₀
//! cylinder ∝ D₀² L₀ ∝ 1/(ε (3 u² cos²θ₀ − 1))          least at  u = (1 + √(1 + 1/cos²θ₀))/3
//! ```
//!
//! | symbol | what it is |
//! |---|---|
//! | D₀, L₀, θ₀ | diameter, length and braid angle at rest |
//! | ε | contraction at the end of the stroke, over L₀ |
//! | P | gauge pressure |
//!
//! The least is that of the cylinder of the braid at rest. A longer muscle contracts by a smaller part of itself, is thinner, and
//! takes less air up to a point, since the air is (P + P_a) times the volume at the end of the stroke less P_a times that at rest:
//! from 1 bar on at most 16 % less between 15° and 35°, at up to 2.3 times the length. Where one muscle is too wide, several stand side
//! by side.
//!
//! Source: Colbrunn, Nelson & Quinn (2001), (2), (3) and (9); the least is this project's. Checked by the tests below.

use super::{MOST_SIDE_BY_SIDE, Requirement, digits_of};
use crate::quantities;
use std::f64::consts::PI;

/// Of the way to the shortest length that a braid of limited length may go: near it the force falls to nothing.
const FURTHEST: f64 = 0.97;

/// The braid angle in rad at which a braid no longer contracts: `cos θ = 1/√3`.
pub(super) fn neutral_angle() -> f64 {
    (1.0 / 3.0_f64.sqrt()).acos()
}

/// `3 u² cos²θ₀ − 1` over `sin²θ₀`: force over `P π D₀²/4` at a part u of the length at rest.
fn shape(angle: f64, part: f64) -> f64 {
    (3.0 * (part * angle.cos()).powi(2) - 1.0) / angle.sin().powi(2)
}

/// The part of the length at rest at which the stroke of the smallest braid ends.
fn of_smallest(angle: f64) -> f64 {
    (1.0 + (1.0 + angle.cos().powi(-2)).sqrt()) / 3.0
}

/// How many muscles of a braid angle in rad, and the keys of one of them; or why there is none.
pub(super) fn braid(requirement: &Requirement, angle: f64) -> Result<(usize, String), String> {
    let shortest = 1.0 / (3.0_f64.sqrt() * angle.cos());
    let mut part = of_smallest(angle);
    if let Some(most) = requirement.most_length {
        part = part.min(1.0 - requirement.stroke / most);
        if part < 1.0 - FURTHEST * (1.0 - shortest) {
            let least = quantities::given(requirement.stroke / (FURTHEST * (1.0 - shortest)), "m");
            return Err(format!("a braid of {}° must be at least {least} long", digits_of(angle.to_degrees())));
        }
    }
    let length = requirement.stroke / (1.0 - part);
    let of = |count: usize| {
        let area = requirement.load / (count as f64 * requirement.effectiveness * requirement.gauge_pressure);
        (4.0 * area / (PI * shape(angle, part))).sqrt()
    };
    let fits = |count: &usize| requirement.most_diameter.is_none_or(|most| of(*count) <= most);
    let Some(count) = (1..=MOST_SIDE_BY_SIDE).find(fits) else {
        let needed = quantities::given(of(MOST_SIDE_BY_SIDE), "m");
        return Err(format!(
            "braids of {}° must be {needed} wide, {MOST_SIDE_BY_SIDE} side by side",
            digits_of(angle.to_degrees())
        ));
    };
    let keys = format!(
        "[actuator]\nlength = \"{:.6} mm\"\ndiameter = \"{:.6} mm\"\nbraid_angle = \"{} deg\"\neffectiveness.constant = {}\n",
        1e3 * length,
        1e3 * of(count),
        angle.to_degrees(),
        requirement.effectiveness
    );
    Ok((count, keys))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the definition: the derivative of ε (3 u² c² − 1) is zero there, and a little off it there is less.
    #[test]
    fn the_smallest_braid_is_where_the_work_of_a_volume_is_greatest() {
        for degrees in [10.0_f64, 20.0, 25.0, 30.0, 45.0] {
            let angle = degrees.to_radians();
            let work = |part: f64| (1.0 - part) * shape(angle, part);
            let best = of_smallest(angle);
            assert!((work(best + 1e-5) - work(best - 1e-5)).abs() < 1e-9 * work(best).abs(), "{degrees}");
            assert!(work(best) > work(best + 0.01) && work(best) > work(best - 0.01));
            assert!(best > 1.0 / (3.0_f64.sqrt() * angle.cos()) && best < 1.0);
        }
    }

    /// What `docs/size.md` says of the least air, by trial of all lengths: with the gas law, the volume by the thread length, and
    /// 3 cm³ outside the muscle.
    #[test]
    fn the_air_of_the_smallest_braid_is_near_the_least() {
        let (load, stroke, atmosphere) = (49.03325, 0.03, 101_325.0);
        let air = |gauge: f64, angle: f64, part: f64| {
            let length: f64 = stroke / (1.0 - part);
            let (thread, end) = (length / angle.cos(), part * length);
            // 1/(4 π n²) by (3).
            let turns = load / (gauge * (3.0 * end * end - thread * thread));
            let volume = |length: f64| length * (thread * thread - length * length) * turns + 3e-6;
            (gauge + atmosphere) * volume(end) - atmosphere * volume(length)
        };
        for (gauge, degrees, excess, longer) in [
            (4e5, 15.0_f64, 0.1083, 1.914),
            (4e5, 25.0, 0.0405, 1.350),
            (4e5, 35.0, 0.0095, 1.127),
            (1e5, 15.0, 0.1855, 2.255),
        ] {
            let angle = degrees.to_radians();
            let smallest = of_smallest(angle);
            let parts = (1..20_000).map(|place| smallest + (1.0 - smallest) * f64::from(place) / 20_000.0);
            let of = |part: f64| air(gauge, angle, part);
            let least = parts.min_by(|one, other| of(*one).total_cmp(&of(*other))).expect("parts");
            assert!(
                (of(smallest) / of(least) - 1.0 - excess).abs() < 1e-3,
                "{gauge} {degrees}: {}",
                of(smallest) / of(least)
            );
            assert!(((1.0 - smallest) / (1.0 - least) / longer - 1.0).abs() < 0.01, "{degrees}: {least}");
        }
    }

    /// The paper's (3) by the thread: `P b²/(4π n²) (3 L²/b² − 1)`.
    #[test]
    fn the_force_is_that_of_the_paper() {
        let (pressure, length, diameter, angle) = (3e5, 0.2, 0.012, 23f64.to_radians());
        let thread = length / angle.cos();
        let turns = thread * angle.sin() / (PI * diameter);
        for part in [1.0, 0.9, 0.8] {
            let by_thread =
                pressure * thread.powi(2) / (4.0 * PI * turns.powi(2)) * (3.0 * (part * length / thread).powi(2) - 1.0);
            let by_shape = pressure * PI * diameter.powi(2) / 4.0 * shape(angle, part);
            assert!((by_thread / by_shape - 1.0).abs() < 1e-12);
        }
    }
}
