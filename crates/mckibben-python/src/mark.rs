//! Marks in numbers of states: of which plants they are.
//!
//! A state of other plants may have as many numbers, and be taken for one. So every saved state has the mark of its scenario.

/// Sections of a scenario that take no part in a plant whose ends and valves a caller moves and commands.
const ELSEWHERE: &[&str] = &["command", "controller", "initial", "load", "mechanism", "run", "sweep"];

/// A number, exact as a float, that identifies the plants of a scenario by its text, and how they are commanded.
pub(crate) fn mark(scenario: &str, commands: &str) -> f64 {
    let mut table: toml::Table = scenario.parse().unwrap_or_default();
    leave_out(&mut table);
    if let Some(toml::Value::Table(antagonist)) = table.get_mut("antagonist") {
        leave_out(antagonist);
    }
    if let Some(toml::Value::Table(actuators)) = table.get_mut("actuators") {
        actuators.iter_mut().filter_map(|(_, its)| its.as_table_mut()).for_each(leave_out);
    }
    // FNV-1a.
    let hash = format!("{table}{commands}")
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    (hash >> 11) as f64
}

/// Leaves the sections out that take no part.
fn leave_out(table: &mut toml::Table) {
    table.retain(|section, _| ELSEWHERE.iter().all(|elsewhere| section != *elsewhere));
}

#[cfg(test)]
mod tests {
    use super::mark;

    #[test]
    fn a_mark_is_of_what_takes_part() {
        let text = |turns: f64, mass: f64, gauge: f64| {
            format!(
                "[actuators.flexor]\nturns = {turns}\ninitial.gauge_pressure = {gauge}\n[mechanism]\nmass = {mass}\n"
            )
        };
        let of = mark(&text(2.0, 1.0, 5.0), "duty");
        assert_eq!(of.to_bits(), mark(&text(2.0, 3.0, 7.0), "duty").to_bits());
        assert!(of != mark(&text(2.5, 1.0, 5.0), "duty") && of != mark(&text(2.0, 1.0, 5.0), "request"));
        assert!(of.fract() == 0.0 && of < 2f64.powi(53), "exact as a float");
    }
}
