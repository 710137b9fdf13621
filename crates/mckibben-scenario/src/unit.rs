//! The one table of units, with exact constants.
//!
//! A unit's size is a ratio of whole numbers times a power of ten and a power of π, so no constant is rounded before
//! the value it multiplies is known (`60 psi` is 60 · 0.45359237 · 9.80665 / 0.0254² Pa, rounded once).
//!
//! | constant | value | source |
//! |---|---|---|
//! | in | 0.0254 m | international yard and pound agreement, 1959 |
//! | lb | 0.45359237 kg | the same |
//! | standard gravity | 9.80665 m/s² | 3rd CGPM, 1901; makes lbf, ozf, kgf, slug |
//! | atm, Torr | 101325 Pa, 101325/760 Pa | 10th CGPM, 1954 |
//! | mmHg, inHg | 13.5951 g/cm³ · standard gravity | conventional millimetre of mercury |
//! | mmH2O, inH2O | 1 g/cm³ · standard gravity | conventional millimetre of water |
//! | Btu | 1055.05585262 J | International Table |
//!
//! `scfm` is counted as `cfm` of standard air (68 °F), which is the reference atmosphere ANR of ISO 6358 within the
//! tolerance of either; `NL` (normal litre, 0 °C) is another thing and is refused.

use crate::dimension::Dimension;
use crate::dimension::Dimension as D;
use crate::nearest::nearest;

/// A unit's size in SI: `numerator/denominator · 10^exponent · π^pi · rest`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    pub(crate) numerator: u128,
    pub(crate) denominator: u128,
    pub(crate) exponent: i32,
    pub(crate) pi: i32,
    /// What outgrew whole numbers of 128 bits, such as the second slug of slug²; 1 for every unit of the table.
    pub(crate) rest: f64,
}

impl Scale {
    pub(crate) const ONE: Self = Self { numerator: 1, denominator: 1, exponent: 0, pi: 0, rest: 1.0 };

    /// `self` times `other` to the `power`.
    pub(crate) fn times(self, other: Self, power: i32) -> Self {
        let (up, down) = match power >= 0 {
            true => (other.numerator, other.denominator),
            false => (other.denominator, other.numerator),
        };
        let mut product = Self {
            exponent: other.exponent.saturating_mul(power).saturating_add(self.exponent),
            pi: other.pi.saturating_mul(power).saturating_add(self.pi),
            rest: self.rest * other.rest.powi(power),
            ..self
        };
        for _ in 0..power.unsigned_abs() {
            // Cancel crosswise first: psi·in² must come back to lbf without a detour through large numbers.
            let (a, b) = (gcd(up, product.denominator), gcd(down, product.numerator));
            let numerator = (product.numerator / b).checked_mul(up / a);
            let denominator = (product.denominator / a).checked_mul(down / b);
            match (numerator, denominator) {
                (Some(numerator), Some(denominator)) => {
                    (product.numerator, product.denominator) = (numerator, denominator);
                }
                _ => product.rest *= up as f64 / down as f64,
            }
        }
        product
    }

    /// Whether the size is a ratio times a power of ten and nothing else.
    pub(crate) fn is_exact(self) -> bool {
        self.pi == 0 && self.rest == 1.0
    }

    /// The nearest `f64`, within a few roundings.
    pub(crate) fn to_f64(self) -> f64 {
        let ratio = self.numerator as f64 / self.denominator as f64;
        let ten = format!("1e{}", self.exponent).parse::<f64>().unwrap_or(f64::NAN);
        ratio * std::f64::consts::PI.powi(self.pi) * ten * self.rest
    }
}

/// Greatest common divisor, at least 1.
pub(crate) fn gcd(mut a: u128, mut b: u128) -> u128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a.max(1)
}

/// A row of the table, or a row with a prefix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unit {
    pub(crate) symbol: &'static str,
    pub(crate) dimension: Dimension,
    pub(crate) scale: Scale,
    /// Kelvin is `(value + zero) · scale` for the two scales that have an offset zero; in hundredths.
    pub(crate) zero: Option<u32>,
    prefixes: bool,
}

/// A unit that takes no prefix.
const fn unit(symbol: &'static str, dimension: Dimension, numerator: u128, denominator: u128, exponent: i32) -> Unit {
    let scale = Scale { numerator, denominator, exponent, pi: 0, rest: 1.0 };
    Unit { symbol, dimension, scale, zero: None, prefixes: false }
}

/// An SI unit of size `10^exponent` that takes prefixes.
const fn si(symbol: &'static str, dimension: Dimension, exponent: i32) -> Unit {
    Unit { prefixes: true, ..unit(symbol, dimension, 1, 1, exponent) }
}

/// An angle or angular speed: a ratio times π.
const fn angular(symbol: &'static str, dimension: Dimension, numerator: u128, denominator: u128) -> Unit {
    let scale = Scale { numerator, denominator, exponent: 0, pi: 1, rest: 1.0 };
    Unit { scale, ..unit(symbol, dimension, 1, 1, 0) }
}

/// A temperature scale with an offset zero, given in hundredths of a degree above absolute zero.
const fn affine(symbol: &'static str, numerator: u128, denominator: u128, zero: u32) -> Unit {
    Unit { zero: Some(zero), ..unit(symbol, Dimension::TEMPERATURE, numerator, denominator, 0) }
}

/// 0.45359237 · 9.80665 N, in units of 10⁻¹³ N.
const LBF: u128 = 44_482_216_152_605;

/// Every unit. Where several spellings name one unit, the first is the one that suggestions use.
static UNITS: &[Unit] = &[
    si("m", D::LENGTH, 0),
    si("g", D::MASS, -3),
    si("s", D::TIME, 0),
    si("K", D::TEMPERATURE, 0),
    si("N", D::FORCE, 0),
    si("Pa", D::PRESSURE, 0),
    si("J", D::ENERGY, 0),
    si("W", D::POWER, 0),
    si("Hz", D::FREQUENCY, 0),
    si("L", D::VOLUME, -3),
    si("l", D::VOLUME, -3),
    si("bar", D::PRESSURE, 5),
    si("rad", D::ANGLE, 0),
    unit("min", D::TIME, 60, 1, 0),
    unit("h", D::TIME, 3600, 1, 0),
    unit("t", D::MASS, 1, 1, 3),
    unit("%", D::NONE, 1, 1, -2),
    unit("kgf", D::FORCE, 980_665, 1, -5),
    unit("cc", D::VOLUME, 1, 1, -6),
    unit("in", D::LENGTH, 254, 1, -4),
    unit("ft", D::LENGTH, 3048, 1, -4),
    unit("yd", D::LENGTH, 9144, 1, -4),
    unit("mil", D::LENGTH, 254, 1, -7),
    unit("lb", D::MASS, 45_359_237, 1, -8),
    unit("lbm", D::MASS, 45_359_237, 1, -8),
    unit("oz", D::MASS, 28_349_523_125, 1, -12),
    unit("slug", D::MASS, LBF, 3048, -9),
    unit("lbf", D::FORCE, LBF, 1, -13),
    unit("ozf", D::FORCE, LBF, 16, -13),
    unit("psi", D::PRESSURE, LBF, 64_516, -5),
    unit("ksi", D::PRESSURE, LBF, 64_516, -2),
    unit("psf", D::PRESSURE, LBF, 9_290_304, -5),
    unit("atm", D::PRESSURE, 101_325, 1, 0),
    unit("Torr", D::PRESSURE, 101_325, 760, 0),
    unit("mmHg", D::PRESSURE, 133_322_387_415, 1, -9),
    unit("inHg", D::PRESSURE, 33_863_886_403_410, 1, -10),
    unit("mmH2O", D::PRESSURE, 980_665, 1, -5),
    unit("cmH2O", D::PRESSURE, 980_665, 1, -4),
    unit("inH2O", D::PRESSURE, 24_908_891, 1, -5),
    unit("cfm", D::VOLUME_FLOW, 28_316_846_592, 60, -12),
    unit("scfm", D::VOLUME_FLOW, 28_316_846_592, 60, -12),
    unit("lpm", D::VOLUME_FLOW, 1, 60, -3),
    unit("Btu", D::ENERGY, 105_505_585_262, 1, -8),
    angular("deg", D::ANGLE, 1, 180),
    angular("°", D::ANGLE, 1, 180),
    angular("rev", D::ANGLE, 2, 1),
    angular("rpm", D::ANGULAR_SPEED, 1, 30),
    affine("degC", 1, 1, 27_315),
    affine("°C", 1, 1, 27_315),
    affine("℃", 1, 1, 27_315),
    affine("degF", 5, 9, 45_967),
    affine("°F", 5, 9, 45_967),
    affine("℉", 5, 9, 45_967),
    unit("degR", D::TEMPERATURE, 5, 9, 0),
    unit("°R", D::TEMPERATURE, 5, 9, 0),
];

/// SI prefixes and their powers of ten; both code points that print as µ are known.
const PREFIXES: &[(&str, i32)] = &[
    ("da", 1),
    ("T", 12),
    ("G", 9),
    ("M", 6),
    ("k", 3),
    ("h", 2),
    ("d", -1),
    ("c", -2),
    ("m", -3),
    ("u", -6),
    ("\u{b5}", -6),
    ("\u{3bc}", -6),
    ("n", -9),
    ("p", -12),
];

/// What people write for a unit that has another symbol here.
const WORDS: &[(&str, &str)] = &[
    ("inch", "in"),
    ("inches", "in"),
    ("foot", "ft"),
    ("feet", "ft"),
    ("pound", "lb\", \"lbf"),
    ("pounds", "lb\", \"lbf"),
    ("lbs", "lb"),
    ("ounce", "oz"),
    ("meter", "m"),
    ("metre", "m"),
    ("meters", "m"),
    ("gram", "g"),
    ("sec", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("minute", "min"),
    ("hour", "h"),
    ("hr", "h"),
    ("newton", "N"),
    ("pascal", "Pa"),
    ("litre", "L"),
    ("liter", "L"),
    ("C", "degC"),
    ("celsius", "degC"),
    ("F", "degF"),
    ("fahrenheit", "degF"),
    ("R", "degR"),
    ("rankine", "degR"),
    ("kelvin", "K"),
    ("degK", "K"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("percent", "%"),
    ("hertz", "Hz"),
    ("cps", "Hz"),
    ("torr", "Torr"),
];

/// Products that are written without a sign between their factors.
const PRODUCTS: &[(&str, &str)] = &[
    ("Ns", "N*s"),
    ("Nm", "N*m"),
    ("Nms", "N*m*s"),
    ("Nmm", "N*mm"),
    ("Ncm", "N*cm"),
    ("Pas", "Pa*s"),
    ("kgm", "kg*m"),
    ("lbfs", "lbf*s"),
    ("lbfin", "lbf*in"),
    ("lbfft", "lbf*ft"),
];

/// Prefixed units that suggestions may name.
const COMMON: &[&str] = &[
    "mm", "cm", "km", "um", "kg", "mg", "ms", "us", "kN", "mN", "kPa", "MPa", "hPa", "mbar", "kJ", "mW", "kW", "kHz",
    "mL", "mrad", "mK",
];

/// Why a symbol is no unit, and what to write instead.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Unknown {
    pub(crate) message: String,
    pub(crate) help: Option<String>,
}

/// The unit that `symbol` names: a row of the table, or an SI row with a prefix.
pub(crate) fn find(symbol: &str) -> Result<Unit, Unknown> {
    // Whole symbols come first, so that `min` is a minute and `ft` a foot, not a milli-inch and a femto-tonne.
    if let Some(unit) = UNITS.iter().find(|unit| unit.symbol == symbol) {
        return Ok(*unit);
    }
    for (prefix, power) in PREFIXES {
        let rest = symbol.strip_prefix(prefix).unwrap_or_default();
        if let Some(unit) = UNITS.iter().find(|unit| unit.prefixes && unit.symbol == rest) {
            return Ok(Unit { scale: Scale { exponent: unit.scale.exponent + power, ..unit.scale }, ..*unit });
        }
    }
    Err(explain(symbol))
}

/// Says what is wrong with a symbol that [`find`] does not know.
fn explain(symbol: &str) -> Unknown {
    let message = format!("`{symbol}` is not a unit");
    if let Some(pressure) = gauge_or_absolute(symbol) {
        return Unknown {
            message: format!("`{symbol}` says gauge or absolute, which is the key's business"),
            help: Some(format!(
                "write `{pressure}`: keys named `gauge_pressure` are gauge, `atmospheric_pressure` is absolute"
            )),
        };
    }
    if matches!(symbol, "NL" | "Nl" | "slpm" | "sccm") {
        let help =
            "convert to the reference atmosphere of ISO 6358 (20 degC, 100 kPa) and write `L/min ANR`".to_owned();
        return Unknown {
            message: format!("`{symbol}` has a reference temperature that differs by country"),
            help: Some(help),
        };
    }
    if ["gal", "gallon", "qt", "quart", "pt", "pint"].iter().any(|word| {
        let plain = symbol.strip_suffix('s').unwrap_or(symbol);
        plain.eq_ignore_ascii_case(word)
    }) {
        return Unknown {
            message: format!("`{symbol}` is a volume that differs by country, and is not a unit here"),
            help: Some("convert it and write `L`, `in^3` or `ft^3`".to_owned()),
        };
    }
    let letters = symbol.trim_end_matches(|c: char| c.is_ascii_digit());
    if letters.len() < symbol.len() && find(letters).is_ok() {
        return Unknown { message, help: Some(format!("write the power as `{letters}^{}`", &symbol[letters.len()..])) };
    }
    if let Some((_, product)) = PRODUCTS.iter().find(|(word, _)| *word == symbol) {
        return Unknown { message, help: Some(format!("write the product with its sign: `{product}`")) };
    }
    let word = WORDS.iter().find(|(word, _)| *word == symbol || word.len() > 1 && word.eq_ignore_ascii_case(symbol));
    let meant = word
        .map(|(_, unit)| *unit)
        .or_else(|| nearest(symbol, UNITS.iter().map(|u| u.symbol).chain(COMMON.iter().copied())));
    let help = meant.map(|unit| format!("did you mean \"{unit}\"?"));
    Unknown {
        message,
        help: help.or_else(|| Some("units are written as in \"N*s/m\", \"psi\" or \"L/(s*bar)\"".to_owned())),
    }
}

/// The pressure unit inside `psig`, `bara` and the like.
fn gauge_or_absolute(symbol: &str) -> Option<&str> {
    let bare = symbol.strip_suffix(['g', 'a', 'G', 'A', 'd'])?;
    find_quietly(bare)
        .or_else(|| find_quietly(&bare.to_ascii_lowercase()))
        .filter(|unit| unit.dimension == D::PRESSURE)?;
    Some(bare)
}

/// [`find`] without the explanation, which would call this again.
fn find_quietly(symbol: &str) -> Option<Unit> {
    let plain = UNITS.iter().find(|unit| unit.symbol == symbol).copied();
    plain.or_else(|| {
        PREFIXES.iter().find_map(|(prefix, _)| {
            let rest = symbol.strip_prefix(prefix)?;
            UNITS.iter().find(|unit| unit.prefixes && unit.symbol == rest).copied()
        })
    })
}

#[cfg(test)]
mod tests {
    use super::{COMMON, PRODUCTS, UNITS, WORDS, find};
    use crate::dimension::Dimension;

    #[test]
    fn symbols_are_unique_and_suggestions_exist() {
        for (i, unit) in UNITS.iter().enumerate() {
            assert!(UNITS[i + 1..].iter().all(|other| other.symbol != unit.symbol), "{}", unit.symbol);
        }
        for symbol in COMMON.iter().copied().chain(WORDS.iter().flat_map(|(_, to)| to.split("\", \""))) {
            assert!(find(symbol).is_ok(), "{symbol}");
        }
    }

    /// Each is no unit, and its factors joined are what is suggested.
    #[test]
    fn products_without_a_sign_have_one_suggested() {
        for (word, product) in PRODUCTS {
            assert_eq!(product.replace('*', ""), *word);
            assert!(product.split('*').all(|factor| find(factor).is_ok()), "{product}");
            let unknown = find(word).expect_err(word);
            assert!(unknown.help.is_some_and(|help| help.contains(&format!("`{product}`"))), "{word}");
        }
    }

    /// A US gallon and an imperial one differ by a fifth.
    #[test]
    fn volumes_that_differ_by_country_are_refused_with_units_that_do_not() {
        for symbol in ["gal", "gallons", "qt", "pint"] {
            let unknown = find(symbol).expect_err(symbol);
            assert!(unknown.help.is_some_and(|help| help.contains("`in^3`")), "{symbol}");
        }
    }

    /// Each spelling stands between backticks.
    #[test]
    fn the_page_of_the_scenario_file_lists_every_unit() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/scenario.md");
        let page = std::fs::read_to_string(path).expect("the page");
        for unit in UNITS {
            assert!(page.contains(&format!("`{}`", unit.symbol)), "{}", unit.symbol);
        }
    }

    #[test]
    fn whole_symbols_win_over_prefixes() {
        assert_eq!(find("min").map(|u| u.dimension), Ok(Dimension::TIME));
        assert_eq!(find("ft").map(|u| u.dimension), Ok(Dimension::LENGTH));
        assert_eq!(find("dam").map(|u| u.scale.exponent), Ok(1));
        assert_eq!(find("\u{b5}s").map(|u| u.scale.exponent), Ok(-6));
    }

    #[test]
    fn gauge_and_absolute_suffixes_are_refused_with_a_remedy() {
        for symbol in ["psig", "psia", "barg", "bara", "kPag", "PSIG", "psid"] {
            let unknown = find(symbol).expect_err(symbol);
            assert!(unknown.message.contains("gauge or absolute"), "{symbol}: {}", unknown.message);
            assert!(unknown.help.is_some_and(|help| help.contains("write `")), "{symbol}");
        }
    }
}
