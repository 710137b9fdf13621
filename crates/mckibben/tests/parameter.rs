//! The parameter table: each row is complete, unique and says what to do when it is refused.

use mckibben::parameter::{self, Parameter, Range, TABLE};
use std::collections::BTreeSet;

/// Every row, of scenario files and of the other laws.
fn rows() -> impl Iterator<Item = &'static Parameter> {
    TABLE.iter().copied()
}

#[test]
fn keys_are_unique_and_are_paths_in_lower_case() {
    let mut keys = BTreeSet::new();
    for row in rows() {
        assert!(keys.insert(row.key), "{} stands twice", row.key);
        let parts: Vec<&str> = row.key.split('.').collect();
        assert!(parts.len() >= 2, "{} has no section", row.key);
        let plain = |part: &&str| {
            !part.is_empty() && part.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
        };
        assert!(parts.iter().all(plain), "{} is not a path of lower-case words", row.key);
    }
    assert!(TABLE.len() >= 30, "the table holds only {} rows", TABLE.len());
}

#[test]
fn every_default_lies_in_its_range() {
    for row in rows() {
        if let Some(default) = row.default {
            assert!(row.range.contains(default), "{}: {default} is outside {}", row.key, row.range);
            assert_eq!(row.check(default), Ok(default));
        }
    }
}

#[test]
fn every_meaning_is_a_sentence_and_every_row_has_a_source_and_a_remedy() {
    for row in rows() {
        assert!(row.meaning.ends_with('.'), "{}: {:?} has no full stop", row.key, row.meaning);
        let first = row.meaning.chars().next();
        assert!(first.is_some_and(char::is_uppercase), "{}: {:?} begins small", row.key, row.meaning);
        assert!(row.meaning.split_whitespace().count() >= 2, "{}: {:?} says nothing", row.key, row.meaning);
        assert!(!row.source.trim().is_empty(), "{} has no source", row.key);
        assert!(!row.symbol.trim().is_empty(), "{} has no symbol", row.key);
        // The remedy ends a message after a semicolon.
        assert!(row.remedy.starts_with(|c: char| c.is_lowercase()), "{}: remedy {:?}", row.key, row.remedy);
        assert!(!row.remedy.ends_with('.'), "{}: remedy {:?}", row.key, row.remedy);
    }
}

#[test]
fn units_are_si() {
    let si = [
        "",
        "m",
        "s",
        "K",
        "Pa",
        "N",
        "kg",
        "Hz",
        "rad",
        "m^-1",
        "m^2",
        "m^3",
        "m^3/s",
        "m/s",
        "m/s^2",
        "N/m",
        "N*s/m",
        "W/K",
        "Pa/s",
        "J/(kg*K)",
        "m^3/(s*Pa)",
        "m^3/s",
        "Pa*s",
        "Pa*s/kg",
        "rad/s",
        "kg*m^2",
        "N*m",
        "N*m/rad",
        "N*m*s/rad",
        "m/rad",
    ];
    for row in rows() {
        assert!(si.contains(&row.unit), "{}: {:?} is not an SI unit that is known here", row.key, row.unit);
    }
}

#[test]
fn the_ends_of_a_range_are_what_they_say() {
    let half = Range { low: 0.0, low_included: true, high: 1.0, high_included: false };
    assert!(half.contains(0.0) && half.contains(0.5) && !half.contains(1.0) && !half.contains(-f64::MIN_POSITIVE));
    assert!(Range::FRACTION.contains(1.0) && !Range::FRACTION.contains(1.0 + f64::EPSILON));
    assert!(!Range::POSITIVE.contains(0.0) && Range::NON_NEGATIVE.contains(0.0) && Range::FINITE.contains(-1e300));
    assert!(!Range::open(0.0, 1.0).contains(0.0) && !Range::open(0.0, 1.0).contains(1.0));
    for range in [Range::FINITE, Range::POSITIVE, Range::NON_NEGATIVE, Range::FRACTION] {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(!range.contains(value), "{value} in {range}");
        }
    }
}

#[test]
fn a_refusal_names_the_parameter_the_value_the_range_the_unit_and_the_remedy() {
    for row in rows() {
        let message = row.check(f64::NAN).expect_err("not a number is never admissible").to_string();
        for part in [row.key, "NaN", row.unit, &row.range.to_string(), row.remedy] {
            assert!(message.contains(part), "{message:?} lacks {part:?}");
        }
    }
    let message = parameter::DUTY.check(1.5).expect_err("above one").to_string();
    assert!(message.contains("command.duty = 1.5"), "{message}");
    assert!(message.contains("at least 0 and at most 1"), "{message}");
}
