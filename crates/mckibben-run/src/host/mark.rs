//! Marks of states that hosts hand out as numbers: of which plants they are.
//!
//! A state of other plants may have as many numbers, and be taken for one. So a host puts the mark of its plant before them.
//!
//! Checked below, and by `crates/mckibben-c/tests/interface/boundary.rs`.

use super::model::Motion;
use mckibben_scenario::Document;

/// Sections of a scenario that take no part in what a state is of: commands and runs are the host's, and a start is over.
const ELSEWHERE: [&str; 5] = ["command", "controller", "initial", "run", "sweep"];
/// Sections that take no part either where the host moves the ends.
const MOVED: [&str; 2] = ["load", "mechanism"];

/// A number, exact as a float, that identifies the plants of a scenario with these actuators, and how they are commanded and moved.
pub fn mark(mut scenario: Document, actuators: &[String], commands: &str, motion: Motion) -> f64 {
    let moved = if motion == Motion::Host { &MOVED[..] } else { &[] };
    let owners = actuators.iter().map(|name| format!("actuators.{name}."));
    for owner in [String::new(), "antagonist.".to_owned()].into_iter().chain(owners) {
        for section in ELSEWHERE.iter().chain(moved) {
            scenario.remove(&format!("{owner}{section}"));
        }
    }
    // FNV-1a.
    let hash = format!("{}{commands}{motion:?}", scenario.to_toml())
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    (hash >> 11) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mark_is_of_what_takes_part() {
        let of = |[turns, mass, gauge]: [f64; 3], commands: &str, motion| {
            let text = format!(
                "[actuators.flexor]\nturns = {turns}\ninitial.gauge_pressure = {gauge}\n[mechanism]\nmass = {mass}\n"
            );
            let document = Document::parse(&text, "plant.toml").expect("TOML");
            mark(document, &["flexor".to_owned()], commands, motion)
        };
        let first = of([2.0, 1.0, 5.0], "duty", Motion::Host);
        assert_eq!(first.to_bits(), of([2.0, 3.0, 7.0], "duty", Motion::Host).to_bits());
        assert!(first != of([2.5, 1.0, 5.0], "duty", Motion::Host));
        assert!(first != of([2.0, 1.0, 5.0], "request", Motion::Host));
        assert!(first.fract() == 0.0 && first < 2f64.powi(53), "exact as a float");
        // What the scenario itself moves is of the plant.
        let moving = of([2.0, 1.0, 5.0], "duty", Motion::Scenario);
        assert_eq!(moving.to_bits(), of([2.0, 1.0, 7.0], "duty", Motion::Scenario).to_bits());
        assert!(moving != first && moving != of([2.0, 3.0, 5.0], "duty", Motion::Scenario));
    }
}
