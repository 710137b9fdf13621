//! The grammar of quantities: exact constants, every way to write a unit, errors with their place, and that no text
//! makes it panic or return a number that is not finite.

use mckibben_scenario::Dimension;
use mckibben_scenario::quantity::{QuantityError, format, parse, parse_unit};
use proptest::prelude::*;

fn si(text: &str) -> f64 {
    parse(text).unwrap_or_else(|error| panic!("{text}: {error}")).value
}

fn refused(text: &str) -> QuantityError {
    parse(text).expect_err(text)
}

/// Values whose exact decimal expansion is known must come out as the nearest `f64`.
#[test]
fn exact_constants() {
    let exact = [
        ("3.85 in", 0.09779),
        ("60 psi", 413_685.437_590_101_7),
        ("100 psi", 689_475.729_316_836_1),
        ("0.02 lbf*s/in", 3.502_536_704_929_527_7),
        ("1.8e-5 ft^2", 1.672_254_72e-6),
        ("5 lb", 2.267_961_85),
        ("1 lbf", 4.448_221_615_260_5),
        ("1 slug", 14.593_902_937_206_364),
        ("1 ozf", 0.278_013_850_953_781_2),
        ("53.34 ft*lbf/(lbm*degR)", 286.986_293_123_04),
        ("1 atm", 101_325.0),
        ("760 Torr", 101_325.0),
        ("1 mmHg", 133.322_387_415),
        ("1 inHg", 3_386.388_640_341),
        ("1 inH2O", 249.088_91),
        ("4 ms", 0.004),
        ("3 cm^3", 3e-6),
        ("3 cc", 3e-6),
        ("20 degC", 293.15),
        ("-40 degF", 233.15),
        ("68 °F", 293.15),
        ("527.67 degR", 293.15),
        ("0.5 L/(s*bar)", 5e-9),
        ("60 L/min", 1e-3),
        ("85 %", 0.85),
        ("1 Btu", 1_055.055_852_62),
        ("1 scfm", 4.719_474_432e-4),
        ("2 h", 7_200.0),
    ];
    for (text, value) in exact {
        assert!(si(text) == value, "{text} is {:?}, not {value:?}", si(text));
    }
}

/// Closed relations between units, among them those that contain π.
#[test]
fn closed_relations() {
    let close = |a: f64, b: f64| assert!((a - b).abs() <= 4.0 * f64::EPSILON * b.abs(), "{a} {b}");
    close(si("1 psi"), si("1 lbf/in^2"));
    close(si("1 slug"), si("1 lbf*s^2/ft"));
    close(si("180 deg"), std::f64::consts::PI);
    close(si("1 rev"), 2.0 * std::f64::consts::PI);
    close(si("60 rpm"), 2.0 * std::f64::consts::PI);
    close(si("2 rev/min"), si("2 rpm"));
}

#[test]
fn ways_to_write_the_same() {
    for text in [
        "60psi",
        " 60 psi ",
        "60.0 psi",
        "6e1 psi",
        "6.E1psi",
        "+60 psi",
        "60 lbf/in²",
        "60 lbf in^-2",
        "60 lbf·in⁻²",
        "60 (lbf)/(in*in)",
        "60 lbf/in**2",
    ] {
        let error = (si(text) / si("60 psi") - 1.0).abs();
        assert!(error <= f64::EPSILON, "{text}: {error}");
    }
    assert_eq!(si("25 1/s"), 25.0);
    assert_eq!(si("25/s"), 25.0);
    assert_eq!(si("\u{2212}5 kPa"), -5_000.0);
    assert_eq!(si("5 \u{b5}s"), si("5 us"));
    assert_eq!(si("2 N m s"), 2.0);
    assert_eq!(parse("100 L/min ANR").map(|q| q.dimension), Ok(Dimension::VOLUME_FLOW));
    assert_eq!(parse("30 L/(min*bar) (ANR)").map(|q| q.dimension), Ok(Dimension::CONDUCTANCE));
    assert_eq!(parse("5 ").map(|q| q.has_unit), Ok(false));
    assert_eq!(parse("0.9 in/in").map(|q| (q.dimension, q.has_unit)), Ok((Dimension::NONE, true)));
}

/// Each mistake: the bytes at fault, a word of the message, a word of the help.
#[test]
fn mistakes_are_placed_and_explained() {
    let cases = [
        ("60 PSI", 3..6, "not a unit", "\"psi\""),
        ("60 psgi", 3..7, "not a unit", "\"psi\""),
        ("60 kpa", 3..6, "not a unit", "\"kPa\""),
        ("60 psig", 3..7, "gauge or absolute", "write `psi`"),
        ("4 bara", 2..6, "gauge or absolute", "write `bar`"),
        ("3 inches", 2..8, "not a unit", "\"in\""),
        ("20 C", 3..4, "not a unit", "\"degC\""),
        ("2 ft2", 2..5, "not a unit", "`ft^2`"),
        ("2 J/degC", 4..8, "an offset zero", "`K`"),
        ("2 degF*s", 2..6, "an offset zero", "`degR`"),
        ("2 degC^2", 2..6, "an offset zero", "`K`"),
        ("287 J/kg K", 8..9, "above or below", "J/(kg*K)"),
        ("5 psi ANR", 6..9, "a pressure", "leave `ANR` out"),
        ("1/4 in", 2..3, "not a number", "0.25 in"),
        ("3,85 in", 1..2, "`,`", "point"),
        ("1_000 N", 1..2, "`_`", "without separators"),
        ("psi", 0..3, "starts with a number", "60 psi"),
        ("", 0..0, "starts with a number", "60 psi"),
        ("nan m", 0..3, "starts with a number", ""),
        ("5 N*", 4..4, "missing at the end", ""),
        ("5 (N", 4..4, "`)` is missing", ""),
        ("5 N)", 3..4, "cannot stand here", ""),
        ("5 ft^", 4..5, "whole number", "ft^2"),
        ("5 ft^99", 4..7, "beyond any", "ft^2"),
        ("5 $", 2..3, "cannot stand here", ""),
        ("5 NL/min", 2..4, "reference temperature", "ANR"),
        ("1e400 m", 0..7, "too large", "exponent"),
        ("1e-400 m", 0..8, "too small", "zero"),
        ("5 m psi psi kg)", 14..15, "cannot stand here", ""),
    ];
    for (text, span, message, help) in cases {
        let error = refused(text);
        assert_eq!(error.span, span, "{text}: {error}");
        assert!(error.message.contains(message), "{text}: {error}");
        assert!(error.help.clone().unwrap_or_default().contains(help), "{text}: {error}");
    }
}

#[test]
fn units_alone() {
    assert_eq!(parse_unit(""), Ok((Dimension::NONE, 1.0)));
    assert_eq!(parse_unit("N*s/m"), Ok((Dimension::DAMPING, 1.0)));
    assert_eq!(parse_unit("m^3/(s*Pa)"), Ok((Dimension::CONDUCTANCE, 1.0)));
    assert_eq!(parse_unit("J/(kg*K)"), Ok((Dimension::SPECIFIC_GAS_CONSTANT, 1.0)));
    assert!(parse_unit("degC").is_err());
    assert!(parse_unit("5 psi").is_err());
}

#[test]
fn nesting_and_powers_are_bounded() {
    let deep = format!("1 {}m{}", "(".repeat(10_000), ")".repeat(10_000));
    assert!(refused(&deep).message.contains("nested"));
    assert!(parse(&format!("1 {}", "psi*".repeat(1_000))).is_err());
    assert!(parse(&format!("1{} m", "0".repeat(1_000))).is_err());
    assert!(parse(&format!("0.{}1 m", "0".repeat(200))).is_ok());
}

fn word() -> impl Strategy<Value = String> {
    const PIECES: &[&str] = &[
        "60", "1e5", "-", "+", ".", "e", "psi", "in", "kg", "degC", "ANR", "*", "/", "^", "2", "²", "⁻¹", "(", ")",
        " ", "µ", "°", "%", "1e999", "N", "L/min", "**", "·",
    ];
    prop::collection::vec(prop::sample::select(PIECES), 0..12).prop_map(|pieces| pieces.concat())
}

proptest! {
    #[test]
    fn any_text_is_read_or_refused(text in prop_oneof![any::<String>(), word()]) {
        match parse(&text) {
            Ok(quantity) => prop_assert!(quantity.value.is_finite()),
            Err(error) => {
                prop_assert!(text.get(error.span.clone()).is_some(), "{:?} in {text:?}", error.span);
                prop_assert!(!error.message.is_empty());
            }
        }
        let _ = parse_unit(&text);
    }

    #[test]
    fn what_is_written_reads_back(
        value in any::<f64>().prop_filter("finite", |value| value.is_finite()),
        unit in prop::sample::select(&["", "m", "kg", "Pa", "N*s/m", "m^3/(s*Pa)", "J/(kg*K)", "K", "rad", "W/K"][..]),
    ) {
        let text = format(value, unit);
        let read = parse(&text).map_err(|error| TestCaseError::fail(format!("{text}: {error}")))?;
        prop_assert_eq!(read.value.to_bits(), value.to_bits(), "{}", text);
    }

    /// The value of a product of units is that of `f64` arithmetic, within its roundings.
    #[test]
    fn units_agree_with_floating_point(
        value in -1e6_f64..1e6,
        a in prop::sample::select(&["psi", "in", "lbf", "oz", "degR", "min"][..]),
        b in prop::sample::select(&["ft", "slug", "mmHg", "h", "cfm", "deg"][..]),
        power in -3_i32..4,
    ) {
        let text = format!("{value} {a}*{b}^{power}");
        let expected = value * si(&format!("1 {a}")) * si(&format!("1 {b}")).powi(power);
        prop_assert!((si(&text) - expected).abs() <= 16.0 * f64::EPSILON * expected.abs(), "{}", text);
    }
}
