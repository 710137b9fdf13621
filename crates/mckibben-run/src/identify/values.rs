//! Numbers with their intervals.

use super::outcome::WARNED;
use crate::quantities::{digits, quantity};
use crate::report::Table;
use crate::units::units;
use mckibben_identify::least_squares::{Direction, Ending, Estimate, Fit, Unknown};
use mckibben_scenario::keys::in_antagonist;

/// A value rounded to the digits that its standard error supports: two digits of the error, six where there is none.
pub(super) fn rounded(value: f64, standard_error: Option<f64>) -> String {
    match standard_error.filter(|standard_error| *standard_error > 0.0 && standard_error.is_finite()) {
        Some(standard_error) => with_last_digit(value, standard_error.log10().floor() as i32 - 1),
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
    let standard_error = estimate.standard_error.map(|standard_error| factor * standard_error);
    let value = rounded(factor * estimate.bound.unwrap_or(estimate.value), standard_error);
    match estimate.confidence_interval {
        Some([low, high]) => format!("{value} ± {}", rounded(0.5 * factor * (high - low), standard_error)),
        None => value,
    }
}

/// Why a number has no interval.
fn silence(estimate: &Estimate) -> &'static str {
    if estimate.on_bound { "on its bound" } else { "not identifiable" }
}

/// The values of a fit as a table.
pub(super) fn table(caption: String, fit: &Fit) -> Table {
    let mut table = of(caption, &fit.estimates);
    if fit.ending != Ending::Minimum {
        table.rows.iter_mut().filter_map(|row| row.last_mut()).for_each(|cell| "none: no minimum".clone_into(cell));
    }
    table
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
    let number = |value: f64| rounded(value, estimate.standard_error);
    let interval = estimate.confidence_interval.map(|ends| ends.map(number));
    let interval = interval.map_or_else(|| silence(estimate).to_owned(), |[low, high]| format!("{low} to {high}"));
    let value = estimate.bound.unwrap_or(estimate.value);
    vec![format!("`{}`", estimate.name), number(value), estimate.unit.to_owned(), interval]
}

/// A value with its interval and unit in words, such as `0.60 (0.59 to 0.61) L/(s·bar)`.
pub(super) fn with_interval(estimate: &Estimate) -> String {
    let value = estimate.bound.unwrap_or(estimate.value);
    let shown = units().shown(estimate.unit, value.abs());
    let error = estimate.standard_error.map(|error| shown.number(error) - shown.number(0.0));
    let number = |value: f64| rounded(shown.number(value), error);
    let interval = estimate.confidence_interval.map(|ends| ends.map(number));
    let interval = interval.map(|[low, high]| format!(" ({low} to {high})"));
    shown.with(&format!("{}{}", number(value), interval.unwrap_or_default()))
}

/// That so much is left of a quantity that it is no noise, and what to do: first about units where these are in doubt.
pub(super) fn beyond_noise(
    words: &str,
    unit: &str,
    [left, noise]: [f64; 2],
    has_intervals: bool,
    advice: &str,
) -> String {
    let doubt = if has_intervals { " The intervals are too short." } else { "" };
    format!(
        "{WARNED}what the model leaves of the {words}, {}, is more than its readings scatter from one to the next, {}: {advice}.{doubt}",
        quantity(left, unit),
        quantity(noise, unit)
    )
}

/// That more is left of a quantity than the standard deviation that the study states, and what to do.
pub(super) fn understated(words: &str, unit: &str, [left, deviation]: [f64; 2], has_intervals: bool) -> String {
    let doubt = if has_intervals { " The intervals are too short." } else { "" };
    format!(
        "{WARNED}what the model leaves of the {words}, {}, is {} times the deviation that is stated for it, {}: state the standard \
         deviation of one reading as `deviation`, or leave it out, so that it is estimated from what is left; or the scenario lacks \
         something.{doubt}",
        quantity(left, unit),
        digits(left / deviation),
        quantity(deviation, unit)
    )
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

/// The correlations of a fit, row by row; empty where it is not at a minimum.
pub(super) fn matrix(fit: &Fit) -> Vec<Vec<f64>> {
    if fit.ending == Ending::Minimum { fit.correlations.clone() } else { Vec::new() }
}

/// The correlations of a fit as a table; empty for a single number.
pub(super) fn correlations(fit: &Fit) -> Table {
    if fit.estimates.len() < 2 || fit.ending != Ending::Minimum {
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
        caption: "Correlations: near 1 or −1 two parameters are hardly identifiable separately.".to_owned(),
        head: std::iter::once(String::new()).chain(names.iter().cloned()).collect(),
        rows: names.iter().zip(&fit.correlations).map(row).collect(),
    }
}

/// That a search has ended from outside before it was done.
pub(super) fn early(ending: Ending) -> String {
    let why = match ending {
        Ending::Time => "the time of the search was over (`time_limit` in [search])",
        _ => "the search was interrupted",
    };
    format!("{why}: these are the best values so far, not all that was to be searched.")
}

/// Why a fit has no intervals, where it is not at a minimum.
fn ended(fit: &Fit) -> Option<String> {
    const BEST: &str = "These are the best values that were found; they have no intervals.";
    Some(match fit.ending {
        Ending::Minimum => return None,
        Ending::Kink | Ending::Numbers if !fit.unidentifiable.is_empty() => format!(
            "the search came to rest where parameters are not identifiable, as the next lines say: a change of these leaves every reading \
             as it is, and there is no single minimum. {BEST}"
        ),
        Ending::Kink => format!(
            "the search ended at a kink: the sum of squares is not level there, as where a load meets a stop, sticks or goes slack, and no \
             step, with or without derivatives, lowers it. {BEST}"
        ),
        Ending::Numbers => format!(
            "the search ended where derivatives are too large, too small or not finite for a step, and steps without them lead no \
             further. {BEST}"
        ),
        Ending::Steps { most } => {
            format!(
                "the search took all its {most} steps (`most_steps` in [search]) before it was at a minimum. {BEST}"
            )
        }
        Ending::Time | Ending::Interrupted => format!("{} They have no intervals.", early(fit.ending)),
    })
}

/// The last name of a path, without the run behind it.
fn last_name(name: &str) -> &str {
    let path = name.split_once(" [").map_or(name, |(path, _)| path);
    path.rsplit_once('.').map_or(path, |(_, last)| last)
}

/// Whether a parameter is a mass or an inertia, which a body has above zero.
fn is_of_a_body(name: &str) -> bool {
    ["mass", "inertia"].contains(&last_name(name))
}

/// That an estimate rests on a bound, and what this is the signature of.
fn resting(estimate: &Estimate, unknown: Option<&Unknown>) -> String {
    let Estimate { name, value, unit, .. } = estimate;
    let last = last_name(name);
    let (bound, at, why) = match unknown.map(|of| of.bounds) {
        None => {
            ("its bound", *value, "the data would take it further: widen its bounds if it may go there, or hold it")
        }
        Some([least, largest]) if (value - least).abs() <= (largest - value).abs() => {
            let why = match last {
                "critical_ratio" if least <= 0.0 => {
                    "a flow that falls with every rise of the downstream pressure is that of a line, not of a valve. Describe the line \
                     from the valve to the actuator by [hose] with its length and diameter, and fit the valve again"
                }
                _ if least <= 0.0 && is_of_a_body(name) => {
                    "no body has so little. Look for a unit that was mistaken, a force or a length with a wrong offset, or a part of the \
                     load that the scenario lacks; weigh it, and hold it at that"
                }
                "lag" if least <= 0.0 => "the readings follow at once: leave the lag out of [fit]",
                _ if least <= 0.0 && (last.ends_with("_delay") || last == "dead_time") => {
                    "the readings respond at once, or before the command: look at the clocks of both, or hold the delay"
                }
                _ => "the data would take it lower: lower `from` in [fit] if it may go there, or hold it",
            };
            ("its least value", least, why)
        }
        Some([_, largest]) => {
            let why = "the data would take it higher: raise `to` in [fit] if it may go there, or hold it";
            ("its largest value", largest, why)
        }
    };
    let at = format!("{} {unit}", digits(at));
    let interval = match estimate.confidence_interval {
        None => "It has no interval, and those of the others hold with it there.",
        Some(_) => "Its interval begins there, and those of the others hold with it there.",
    };
    format!("`{name}` rests on {bound}, {}: {why}. {interval}", at.trim_end())
}

/// That the data do not identify a combination of parameters.
fn not_identifiable(direction: &Direction) -> String {
    let share = |(name, share): &(String, f64)| format!("`{name}` ({share:+.2})");
    match direction.shares.as_slice() {
        [(name, _)] if name.contains("_delay") || name.contains("dead_time") => format!(
            "`{name}` changes no reading there: a valve whose delay is longer than its pulses never moves. Start below the shortest pulse, \
             or give runs with longer pulses."
        ),
        [(name, _)] if last_name(name) == "critical_ratio" => format!(
            "`{name}` changes no reading there: the flow is choked at all of them, and every value above the largest pressure ratio is as \
             good. Record until the pressures at both ends of the valve are nearly equal."
        ),
        [(name, _)] => format!("`{name}` changes no reading there. Hold it at a value that you know."),
        shares => format!(
            "{} are not identifiable: this combination of them, each over its size, changes no reading. Hold one of them at a value that \
             you know.",
            shares.iter().map(share).collect::<Vec<_>>().join(" and ")
        ),
    }
}

/// What a reader must know of a fit before believing its numbers. `unknowns` are those of the fit, where they are the study's.
pub(super) fn warnings(fit: &Fit, unknowns: &[Unknown]) -> Vec<String> {
    let mut warnings: Vec<String> = ended(fit).into_iter().collect();
    warnings.extend(fit.unidentifiable.iter().map(not_identifiable));
    for (place, estimate) in fit.estimates.iter().enumerate().filter(|(_, estimate)| estimate.on_bound) {
        warnings.push(resting(estimate, unknowns.get(place)));
    }
    // Of what may have either sign, such as an offset or a coefficient, zero is a value like any other.
    let signed = |estimate: &Estimate| unknowns.iter().any(|of| of.name == estimate.name && of.bounds[0] < 0.0);
    let contains_zero = |[low, high]: [f64; 2]| low < 0.0 && high > 0.0;
    let wide = |estimate: &&Estimate| estimate.confidence_interval.is_some_and(contains_zero) && !signed(estimate);
    for estimate in fit.estimates.iter().filter(wide) {
        warnings.push(match is_of_a_body(&estimate.name) {
            true => format!(
                "the interval of `{}` contains zero, which no body has: it is hardly identifiable from the data. Weigh it, and hold it at that.",
                estimate.name
            ),
            false => format!("the interval of `{}` contains zero: it is hardly identifiable from the data.", estimate.name),
        });
    }
    if fit.ending == Ending::Minimum && fit.condition > 1e6 && fit.unidentifiable.is_empty() {
        warnings.push(format!(
            "the condition number is {:.1e}: the parameters are identifiable, but only together.",
            fit.condition
        ));
    }
    warnings.into_iter().map(|warning| format!("{WARNED}{warning}")).collect()
}

#[cfg(test)]
mod tests {
    use super::{
        Direction, Ending, Estimate, Fit, Unknown, give_or_take, not_identifiable, part_of, resting, rounded, row,
        warnings, with_interval,
    };

    /// What is said of an estimate on one of the bounds of its unknown.
    fn said(name: &str, bounds: [f64; 2], value: f64) -> String {
        let estimate = Estimate {
            name: name.to_owned(),
            unit: "",
            value,
            standard_error: None,
            confidence_interval: None,
            on_bound: true,
            bound: None,
        };
        resting(&estimate, Some(&Unknown { bounds, ..Unknown::new(name, "", value) }))
    }

    #[test]
    fn a_bound_says_what_it_is_the_signature_of() {
        let infinite = f64::INFINITY;
        for (name, bounds, value, words) in [
            ("valve.critical_ratio", [0.0, 1.0], 1e-20, "least value, 0: a flow that falls"),
            ("valve.critical_ratio", [0.0, 1.0], 1e-20, "by [hose] with its length and diameter"),
            ("valve.critical_ratio", [0.2, 1.0], 0.2, "lower `from` in [fit]"),
            ("load.mass [run 2]", [0.0, infinite], 1e-9, "no body has so little"),
            ("mechanism.joints.knee.inertia", [0.0, infinite], 0.0, "weigh it, and hold it at that"),
            ("load.mass", [3.0, infinite], 3.0, "least value, 3.000: the data would take it lower"),
            ("load.mass", [1.0, 3.0], 3.0, "largest value, 3.000: the data would take it higher: raise `to`"),
            ("valve.opening_delay", [0.0, infinite], 0.0, "look at the clocks of both"),
            ("columns.length.lag", [0.0, 0.15], 0.0, "the readings follow at once"),
            ("actuator.friction.viscous", [0.0, 50.0], 0.0, "lower `from` in [fit]"),
        ] {
            let said = said(name, bounds, value);
            assert!(said.contains(words), "`{words}` is not in {said}");
        }
    }

    #[test]
    fn an_offset_may_be_zero_and_a_damping_is_hardly_identifiable_there() {
        let estimate = |name: &str| Estimate {
            name: name.to_owned(),
            unit: "",
            value: 0.1,
            standard_error: Some(1.0),
            confidence_interval: Some([-1.9, 2.1]),
            on_bound: false,
            bound: None,
        };
        let names =
            ["columns.length.offset", "actuator.friction.viscous", "actuator.friction.viscoelastic.relaxation_time[0]"];
        let unknowns = [
            Unknown::new(names[0], "", 0.0).between(-20.0, 20.0),
            Unknown::new(names[1], "", 1.0).between(0.0, f64::INFINITY),
            Unknown::new(names[2], "", 1.0).between(0.0, f64::INFINITY),
        ];
        let fit = Fit {
            estimates: names.map(estimate).to_vec(),
            residuals: vec![1.0; 9],
            cost: 4.5,
            degrees_of_freedom: 7,
            scatter: 1.0,
            correlations: vec![vec![0.0; 3]; 3],
            condition: 1.0,
            unidentifiable: Vec::new(),
            ending: Ending::Minimum,
        };
        let said = warnings(&fit, &unknowns);
        assert!(said.len() == 2 && said[0].contains("`actuator.friction.viscous` contains zero"), "{said:?}");
        // An entry of a list is no other number.
        assert!(said[1].contains("relaxation_time[0]` contains zero"), "{said:?}");
    }

    #[test]
    fn parameters_that_are_not_identifiable_are_no_kink() {
        let shares = vec![("load.damping".to_owned(), -0.71), ("actuator.friction.viscous".to_owned(), 0.71)];
        let fit = |unidentifiable| Fit {
            estimates: Vec::new(),
            residuals: vec![1.0; 9],
            cost: 4.5,
            degrees_of_freedom: 7,
            scatter: 1.0,
            correlations: Vec::new(),
            condition: f64::INFINITY,
            unidentifiable,
            ending: Ending::Kink,
        };
        let said = warnings(&fit(vec![Direction { strength: 0.0, shares }]), &[]);
        assert!(said[0].contains("not identifiable, as the next lines say") && !said[0].contains("kink"), "{said:?}");
        assert!(said[1].contains("`load.damping` (-0.71) and `actuator.friction.viscous` (+0.71)"), "{said:?}");
        assert!(warnings(&fit(Vec::new()), &[])[0].contains("kink"));
    }

    #[test]
    fn a_delay_longer_than_all_pulses_is_named() {
        let direction = |names: &[&str]| Direction {
            strength: 0.0,
            shares: names.iter().map(|name| ((*name).to_owned(), 0.7)).collect(),
        };
        let alone = not_identifiable(&direction(&["valve.opening_delay"]));
        assert!(alone.contains("longer than its pulses never moves") && alone.contains("shortest pulse"), "{alone}");
        let other = not_identifiable(&direction(&["hose.length"]));
        assert!(other.contains("`hose.length` changes no reading there"), "{other}");
        let both = not_identifiable(&direction(&["load.mass", "actuator.turns"]));
        assert!(both.contains("`load.mass` (+0.70) and `actuator.turns` (+0.70)"), "{both}");
    }

    #[test]
    fn an_estimate_on_its_bound_is_shown_as_the_bound() {
        let estimate = Estimate {
            name: "actuator.friction.viscous".to_owned(),
            unit: "N*s/m",
            value: 6.4e-16,
            standard_error: None,
            confidence_interval: None,
            on_bound: true,
            bound: Some(0.0),
        };
        assert_eq!(row(&estimate)[1..], ["0", "N*s/m", "on its bound"]);
        assert!(with_interval(&estimate).starts_with("0 "), "{}", with_interval(&estimate));
        assert_eq!(give_or_take(&estimate, 1e3), "0");
    }

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
    fn a_standard_error_limits_the_digits() {
        assert_eq!(rounded(12.345_678, Some(0.034)), "12.346");
        assert_eq!(rounded(12.345_678, None), "12.3457");
        assert_eq!(rounded(123_456.0, Some(2300.0)), "123456");
        assert_eq!(rounded(1.234_567e-7, Some(2.3e-10)), "1.2346e-7");
        assert_eq!(rounded(0.0, None), "0");
    }
}
