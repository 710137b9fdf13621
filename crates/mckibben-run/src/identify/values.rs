//! Numbers with their intervals.

use super::outcome::WARNED;
use crate::quantities::digits;
use crate::report::Table;
use mckibben_identify::least_squares::{Estimate, Fit};
use mckibben_scenario::keys::in_antagonist;

/// A value rounded to what its deviation lets it tell: two digits of the deviation, six where there is none.
pub(super) fn rounded(value: f64, deviation: Option<f64>) -> String {
    match deviation.filter(|deviation| *deviation > 0.0 && deviation.is_finite()) {
        Some(deviation) => with_last_digit(value, deviation.log10().floor() as i32 - 1),
        None if value == 0.0 => "0".to_owned(),
        None => with_last_digit(value, value.abs().log10().floor() as i32 - 5),
    }
}

/// A number whose last digit stands for this power of ten.
fn with_last_digit(value: f64, last: i32) -> String {
    let first = if value == 0.0 { last } else { value.abs().log10().floor() as i32 };
    if (-4..6).contains(&first) && last > -12 {
        format!("{value:.*}", (-last).max(0) as usize)
    } else {
        format!("{value:.*e}", (first - last).max(0) as usize)
    }
}

/// A value and half of its interval, in a unit that is so many times smaller.
pub(super) fn give_or_take(estimate: &Estimate, factor: f64) -> String {
    let deviation = estimate.standard_error.map(|deviation| factor * deviation);
    let value = rounded(factor * estimate.value, deviation);
    match estimate.confidence_interval {
        Some([low, high]) => format!("{value} ± {}", rounded(0.5 * factor * (high - low), deviation)),
        None => value,
    }
}

/// Why a number has no interval.
fn silence(estimate: &Estimate) -> &'static str {
    if estimate.on_bound { "on its bound" } else { "not told by the data" }
}

/// The values of a fit as a table.
pub(super) fn table(caption: String, fit: &Fit) -> Table {
    of(caption, &fit.estimates)
}

/// Values as a table.
pub(super) fn of(caption: String, estimates: &[Estimate]) -> Table {
    Table {
        caption,
        head: ["number", "value", "unit", "95 % interval"].map(String::from).to_vec(),
        rows: estimates.iter().map(row).collect(),
    }
}

/// A value with its name, unit and interval.
pub(super) fn row(estimate: &Estimate) -> Vec<String> {
    let value = rounded(estimate.value, estimate.standard_error);
    let interval = match estimate.confidence_interval {
        Some([low, high]) => {
            format!("{} to {}", rounded(low, estimate.standard_error), rounded(high, estimate.standard_error))
        }
        None => silence(estimate).to_owned(),
    };
    vec![format!("`{}`", estimate.name), value, estimate.unit.to_owned(), interval]
}

/// The name of the part of a plant that a path leads into.
fn part_of(path: &str) -> Option<&str> {
    let mut names = path.split('.');
    match names.next()? {
        "actuators" | "supplies" => names.next(),
        "mechanism" => names.find(|name| *name == "joints").and_then(|_| names.next()),
        "mechanisms" => {
            let mechanism = names.next();
            names.find(|name| *name == "joints").map_or(mechanism, |_| names.next())
        }
        _ => None,
    }
}

/// The correlations of a fit as a table; empty for a single number.
pub(super) fn correlations(fit: &Fit) -> Table {
    if fit.estimates.len() < 2 {
        return Table::default();
    }
    let short = |name: &str| {
        let (path, run) = name.split_once(" [").unwrap_or((name, ""));
        let last = path.rsplit_once('.').map_or(path, |(_, last)| last);
        let name = match part_of(path) {
            Some(part) => format!("{last} of {part}"),
            None if in_antagonist(path).is_some() => format!("antagonist's {last}"),
            None => last.to_owned(),
        };
        if run.is_empty() { name } else { format!("{name} [{run}") }
    };
    let mut names: Vec<String> = fit.estimates.iter().map(|estimate| short(&estimate.name)).collect();
    let last = names.clone();
    for (name, estimate) in names.iter_mut().zip(&fit.estimates) {
        // Two parts may have a number of one name.
        if last.iter().filter(|other| *other == name).count() > 1 {
            name.clone_from(&estimate.name);
        }
    }
    let row = |(name, row): (&String, &Vec<f64>)| {
        let cells = row.iter().map(|value| format!("{value:.3}").replace('-', "−"));
        std::iter::once(name.clone()).chain(cells).collect()
    };
    Table {
        caption: "Correlations: near 1 or −1 two numbers can hardly be told apart.".to_owned(),
        head: std::iter::once(String::new()).chain(names.iter().cloned()).collect(),
        rows: names.iter().zip(&fit.correlations).map(row).collect(),
    }
}

/// What a reader must know of a fit before believing its numbers.
pub(super) fn warnings(fit: &Fit) -> Vec<String> {
    let mut warnings: Vec<String> = Vec::new();
    for direction in &fit.untold {
        let share = |(name, share): &(String, f64)| format!("`{name}` ({share:+.2})");
        let shares: Vec<String> = direction.shares.iter().map(share).collect();
        warnings.push(format!(
            "the data do not tell {}: all but this combination of them, each over its size, is told. Hold one of them at a value that \
             you know.",
            shares.join(" and ")
        ));
    }
    for estimate in fit.estimates.iter().filter(|estimate| estimate.on_bound) {
        warnings.push(format!(
            "`{}` rests on its bound, {}; it has no interval, and those of the others hold with it there.",
            estimate.name,
            digits(estimate.value)
        ));
    }
    let wide = |estimate: &&Estimate| estimate.confidence_interval.is_some_and(|[low, high]| low < 0.0 && high > 0.0);
    // An entry of a list, such as a coefficient, may well be zero.
    let entry = |estimate: &&Estimate| estimate.name.contains('[') && !estimate.name.contains(" [");
    for estimate in fit.estimates.iter().filter(wide).filter(|estimate| !entry(estimate)) {
        warnings.push(format!("the interval of `{}` contains zero: the data hardly tell it.", estimate.name));
    }
    if fit.condition > 1e6 && fit.untold.is_empty() {
        warnings
            .push(format!("the condition number is {:.1e}: the numbers are told, but only together.", fit.condition));
    }
    warnings.into_iter().map(|warning| format!("{WARNED}{warning}")).collect()
}

#[cfg(test)]
mod tests {
    use super::{part_of, rounded};

    #[test]
    fn a_path_leads_into_a_part() {
        for (path, part) in [
            ("actuators.biceps.friction.viscous", Some("biceps")),
            ("supplies.tank.reservoir_volume", Some("tank")),
            ("mechanism.joints.elbow.damping", Some("elbow")),
            ("mechanism.gravity", None),
            ("mechanisms.arm.joints.elbow.damping", Some("elbow")),
            ("mechanisms.trolley.mass", Some("trolley")),
            ("actuator.turns", None),
        ] {
            assert_eq!(part_of(path), part, "{path}");
        }
    }

    #[test]
    fn a_deviation_says_how_many_digits() {
        assert_eq!(rounded(12.345_678, Some(0.034)), "12.346");
        assert_eq!(rounded(12.345_678, None), "12.3457");
        assert_eq!(rounded(123_456.0, Some(2300.0)), "123456");
        assert_eq!(rounded(1.234_567e-7, Some(2.3e-10)), "1.2346e-7");
        assert_eq!(rounded(0.0, None), "0");
    }
}
