//! The one grammar of quantities: a number and a unit expression, read to SI.
//!
//! ```text
//! quantity   = number [ unit ] [ "ANR" ]            "60 psi"  "60psi"  "0.02 lbf*s/in"  "100 L/min ANR"
//! number     = [sign] digits [ "." digits ] [ "e" [sign] digits ]
//! unit       = [ "/" ] factor { ( "*" | "·" | "/" | space ) factor }
//! factor     = ( symbol | "(" unit ")" ) [ power ]
//! power      = ( "^" | "**" ) [sign] digits  |  ⁻¹²³…
//! ```
//!
//! Products and quotients go from left to right, so `J/kg*K` is `(J/kg)*K`, and a space after a `/` is refused because
//! readers differ about it. `degC` and `degF` have an offset zero and stand alone. `ANR`, the reference atmosphere
//! of ISO 6358, is allowed after a volume flow or a conductance, where it says which air is counted.
//!
//! Values are computed in whole numbers and rounded to `f64` once. What overflows 128 bits (high powers of imperial
//! units) or contains π (deg, rev, rpm) is computed in `f64` and good to a few roundings. A result is always finite.
//!
//! Checked by `tests/quantity.rs`.

use crate::dimension::Dimension;
use crate::unit::{self, Scale};
use std::fmt;
use std::ops::Range;

/// A number read from text, in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    /// The value in SI base units.
    pub value: f64,
    /// What it measures.
    pub dimension: Dimension,
    /// Whether a unit was written. `"0.5"` has none; `"85 %"` has one although it is a pure number.
    pub has_unit: bool,
}

/// What is wrong with a quantity, and where in its text.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct QuantityError {
    /// Bytes of the text that are at fault; empty at the end when something is missing.
    pub span: Range<usize>,
    /// What is wrong.
    pub message: String,
    /// What to write instead.
    pub help: Option<String>,
}

impl fmt::Display for QuantityError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.message)?;
        self.help.as_ref().map_or(Ok(()), |help| write!(f, "; {help}"))
    }
}

impl std::error::Error for QuantityError {}

/// Units nested deeper than this are refused, so that hostile text cannot exhaust the stack.
const DEEPEST: usize = 16;

/// What to write in place of a power beyond any physical quantity.
const SMALL_POWER: &str = "write a power as in `ft^2` or `s^-1`; those of physical quantities are small";

/// Reads a quantity such as `"60 psi"` to SI.
///
/// # Errors
/// When the text is not a number with an optional unit, when a unit is unknown, or when the value does not fit `f64`.
pub fn parse(text: &str) -> Result<Quantity, QuantityError> {
    let mut parser = Parser { text, at: 0 };
    parser.spaces();
    let number = parser.number()?;
    parser.spaces();
    if parser.rest().is_empty() {
        let value = finite(text, number.scaled(&Scale::ONE, None), number.is_zero())?;
        return Ok(Quantity { value, dimension: Dimension::NONE, has_unit: false });
    }
    let product = parser.unit_to_the_end()?;
    let value = finite(text, number.scaled(&product.scale, product.zero), number.is_zero() || product.zero.is_some())?;
    Ok(Quantity { value, dimension: product.dimension, has_unit: true })
}

/// Reads a unit expression such as `"N*s/m"`: its dimension, and its size in SI. The empty text is a pure number.
///
/// # Errors
/// When the text is no unit, or is a temperature scale with an offset zero.
pub fn parse_unit(text: &str) -> Result<(Dimension, f64), QuantityError> {
    let mut parser = Parser { text, at: 0 };
    parser.spaces();
    if parser.rest().is_empty() {
        return Ok((Dimension::NONE, 1.0));
    }
    let product = parser.unit_to_the_end()?;
    if product.zero.is_some() {
        return Err(own_zero(text, 0..text.len()));
    }
    let one = Number { mantissa: Some(1), exponent: 0, negative: false, literal: "1" };
    Ok((product.dimension, finite(text, one.scaled(&product.scale, None), false)?))
}

/// The refusal of a quantity in `degC` or `degF` where a difference is due, such as a standard deviation.
pub(crate) fn with_own_zero(text: &str) -> Option<QuantityError> {
    let mut parser = Parser { text, at: 0 };
    parser.spaces();
    parser.number().ok()?;
    parser.spaces();
    let unit = parser.at..text.trim_end().len();
    parser.unit_to_the_end().ok()?.zero?;
    let linear = if text.contains(['F', '℉']) { "degR" } else { "K" };
    Some(QuantityError {
        message: format!("`{}` has an offset zero, but a difference is due", &text[unit.clone()]),
        help: Some(format!("write `{linear}`, which is the same difference of temperature")),
        span: unit,
    })
}

/// Writes a value with its unit so that [`parse`] reads back the same bits, in the shortest digits that do.
///
/// `unit` must be coherent SI (`"Pa"`, `"N*s/m"`); with an empty unit the number stands alone.
pub fn format(value: f64, unit: &str) -> String {
    let size = value.abs();
    let plain = size == 0.0 || (1e-4..1e9).contains(&size);
    let number = if plain { format!("{value}") } else { format!("{value:e}") };
    if unit.is_empty() { number } else { format!("{number} {unit}") }
}

/// Passes on a number that `f64` can hold.
fn finite(text: &str, value: f64, may_be_zero: bool) -> Result<f64, QuantityError> {
    let (message, help) = match (value.is_finite(), value == 0.0 && !may_be_zero) {
        (true, false) => return Ok(value),
        (true, true) => (
            "the value is too small for a 64-bit number",
            "write zero, or correct the exponent: it is below 5e-324 in SI",
        ),
        (false, _) => (
            "the value is too large for a 64-bit number",
            "correct the exponent or the unit: it is above 1.8e308 in SI",
        ),
    };
    Err(QuantityError { span: 0..text.len(), message: message.to_owned(), help: Some(help.to_owned()) })
}

/// The refusal of `degC` and `degF` inside compounds.
fn own_zero(symbol: &str, span: Range<usize>) -> QuantityError {
    let linear = if symbol.contains(['F', '℉']) { "degR" } else { "K" };
    QuantityError {
        span,
        message: format!("`{symbol}` has an offset zero and cannot be part of a compound unit"),
        help: Some(format!("write `{linear}`, which is the same difference of temperature")),
    }
}

/// A decimal number as written: `±mantissa · 10^exponent`.
struct Number<'t> {
    /// The digits; `None` when they overflow.
    mantissa: Option<u128>,
    exponent: i32,
    negative: bool,
    /// The digits without sign, for those that overflow.
    literal: &'t str,
}

impl Number<'_> {
    fn is_zero(&self) -> bool {
        self.mantissa == Some(0)
    }

    /// The value in SI; not finite when it does not fit.
    fn scaled(&self, scale: &Scale, zero: Option<u32>) -> f64 {
        let exact = match zero {
            Some(hundredths) => self.shifted(scale, hundredths),
            None => self.mantissa.and_then(|mantissa| divided(mantissa, self.exponent, scale)),
        };
        let sign = if self.negative { -1.0 } else { 1.0 };
        let literal = || self.literal.parse::<f64>().unwrap_or(f64::NAN);
        match (exact, zero) {
            (Some(value), None) => sign * value,
            (Some(value), Some(_)) => value,
            (None, None) => sign * literal() * scale.to_f64(),
            (None, Some(hundredths)) => (sign * literal() + f64::from(hundredths) / 100.0) * scale.to_f64(),
        }
    }

    /// `(value + hundredths/100) · scale` in whole numbers, or `None` when they overflow.
    fn shifted(&self, scale: &Scale, hundredths: u32) -> Option<f64> {
        let exponent = self.exponent.min(-2);
        let grow = |whole: u128, by: i32| whole.checked_mul(10_u128.checked_pow(u32::try_from(by).ok()?)?);
        let own = i128::try_from(grow(self.mantissa?, self.exponent.checked_sub(exponent)?)?).ok()?;
        let shift = i128::try_from(grow(u128::from(hundredths), (-2_i32).checked_sub(exponent)?)?).ok()?;
        let sum = if self.negative { shift.checked_sub(own)? } else { shift.checked_add(own)? };
        let value = divided(sum.unsigned_abs(), exponent, scale)?;
        Some(if sum < 0 { -value } else { value })
    }
}

/// `mantissa · 10^exponent · scale`, rounded once; `None` when whole numbers of 128 bits do not reach.
fn divided(mantissa: u128, exponent: i32, scale: &Scale) -> Option<f64> {
    if !scale.is_exact() {
        return None;
    }
    let common = unit::gcd(mantissa, scale.denominator);
    let (mantissa, denominator) = (mantissa / common, scale.denominator / common);
    let mut numerator = mantissa.checked_mul(scale.numerator)?;
    let mut exponent = exponent.checked_add(scale.exponent)?;
    if denominator == 1 {
        return format!("{numerator}e{exponent}").parse().ok();
    }
    // Shift decimal digits in until 128 bits are full; the quotient then has more digits than any f64 can represent,
    // and a last digit 1 in place of a remainder keeps ties from being rounded as such.
    while let Some(shifted) = numerator.checked_mul(10).filter(|_| numerator != 0) {
        numerator = shifted;
        exponent = exponent.checked_sub(1)?;
    }
    let (quotient, remainder) = (numerator / denominator, numerator % denominator);
    // Twenty digits are more than twice seventeen apart from a tie in all but contrived cases, which f64 then serves.
    if quotient < 10_u128.pow(20) && remainder != 0 {
        return None;
    }
    format!("{quotient}{}e{}", u8::from(remainder != 0), exponent.checked_sub(1)?).parse().ok()
}

/// A unit expression on its way to SI.
#[derive(Clone, Copy)]
struct Product {
    dimension: Dimension,
    scale: Scale,
    /// Zero point in hundredths of a degree, while the expression is nothing but `degC` or `degF`.
    zero: Option<u32>,
}

struct Parser<'t> {
    text: &'t str,
    at: usize,
}

impl<'t> Parser<'t> {
    fn rest(&self) -> &'t str {
        self.text.get(self.at..).unwrap_or_default()
    }

    fn next(&self) -> Option<char> {
        self.rest().chars().next()
    }

    /// Takes `token` if it comes next.
    fn take(&mut self, token: &str) -> bool {
        let found = self.rest().starts_with(token);
        self.at += if found { token.len() } else { 0 };
        found
    }

    /// Takes characters while they fit.
    fn take_while(&mut self, fits: impl Fn(char) -> bool) -> &'t str {
        let rest = self.rest();
        let taken = &rest[..rest.find(|c| !fits(c)).unwrap_or(rest.len())];
        self.at += taken.len();
        taken
    }

    fn spaces(&mut self) -> bool {
        !self.take_while(char::is_whitespace).is_empty()
    }

    fn error<T>(&self, span: Range<usize>, message: impl Into<String>, help: &str) -> Result<T, QuantityError> {
        let help = (!help.is_empty()).then(|| help.to_owned());
        Err(QuantityError { span, message: message.into(), help })
    }

    /// The span of the next character, for errors.
    fn here(&self) -> Range<usize> {
        self.at..self.at + self.next().map_or(0, char::len_utf8)
    }

    fn sign(&mut self) -> bool {
        let negative = self.take("-") || self.take("\u{2212}");
        if !negative {
            self.take("+");
        }
        negative
    }

    fn number(&mut self) -> Result<Number<'t>, QuantityError> {
        let start = self.at;
        let negative = self.sign();
        let begin = self.at;
        let whole = self.take_while(|c| c.is_ascii_digit());
        let fraction = if self.take(".") { self.take_while(|c| c.is_ascii_digit()) } else { "" };
        if whole.is_empty() && fraction.is_empty() {
            self.take_while(|c| !c.is_whitespace());
            let span = start..self.at;
            return self.error(
                span,
                "a quantity starts with a number",
                "write a number and a unit, such as \"60 psi\"",
            );
        }
        let mut exponent: i32 = 0;
        // An `e` is an exponent only when digits follow, so that units may begin with it.
        let tail = self.rest();
        let power = tail.strip_prefix(['e', 'E']).unwrap_or_default();
        let unsigned = power.strip_prefix(['+', '-']).unwrap_or(power);
        if unsigned.starts_with(|c: char| c.is_ascii_digit()) {
            let digits = unsigned.find(|c: char| !c.is_ascii_digit()).unwrap_or(unsigned.len());
            let size = unsigned[..digits].parse::<i32>().unwrap_or(i32::MAX).min(100_000);
            exponent = if power.starts_with('-') { -size } else { size };
            self.at += tail.len() - unsigned.len() + digits;
        }
        let literal = &self.text[begin..self.at];
        if self.rest().starts_with(',') {
            return self.error(self.here(), "`,` is not part of a number", "use a point as the decimal mark");
        }
        if self.rest().starts_with('_') {
            return self.error(self.here(), "`_` is not part of a number", "write the digits without separators");
        }
        let places = i32::try_from(fraction.len()).unwrap_or(i32::MAX);
        let mantissa = format!("{whole}{fraction}").parse().ok();
        Ok(Number { mantissa, exponent: exponent.saturating_sub(places), negative, literal })
    }

    /// A unit, the annotation ANR, and nothing after them.
    fn unit_to_the_end(&mut self) -> Result<Product, QuantityError> {
        let product = self.expression(0)?;
        self.spaces();
        let start = self.at;
        if self.take("ANR") || self.take("(ANR)") {
            if ![Dimension::VOLUME_FLOW, Dimension::CONDUCTANCE].contains(&product.dimension) {
                let message =
                    format!("`ANR` says which air a volume flow counts, but this is {}", product.dimension.noun());
                return self.error(start..self.at, message, "leave `ANR` out");
            }
            self.spaces();
        }
        if !self.rest().is_empty() {
            let message = format!("`{}` cannot stand here", self.rest().trim_end());
            return self.error(self.at..self.text.trim_end().len(), message, "write one number and one unit");
        }
        Ok(product)
    }

    /// Factors with `*`, `/` or space between them.
    fn expression(&mut self, depth: usize) -> Result<Product, QuantityError> {
        let mut product = Product { dimension: Dimension::NONE, scale: Scale::ONE, zero: None };
        let mut divided = false;
        let mut first = true;
        // `25 1/s` is how some write a rate.
        if self.rest().starts_with("1/") {
            self.at += 1;
        }
        loop {
            let before = self.at;
            let spaced = self.spaces();
            let sign = if self.take("/") {
                divided = true;
                -1
            } else if !first && (self.take("**") || self.take("^")) {
                return self.error(before..self.at, "a power follows its unit directly", "write it as in `ft^2`");
            } else if first || self.take("*") || self.take("\u{b7}") || self.take("\u{22c5}") {
                1
            } else {
                let more = self.next().is_some_and(|c| c == '(' || starts_symbol(c));
                if !spaced || !more || self.rest().starts_with("ANR") || self.rest().starts_with("(ANR)") {
                    self.at = before;
                    return Ok(product);
                }
                if divided {
                    let help = "write `*` and parentheses, such as `J/(kg*K)`";
                    return self.error(
                        before..self.at,
                        "a product after `/` could be meant above or below the line",
                        help,
                    );
                }
                1
            };
            self.spaces();
            let start = self.at;
            let factor = self.factor(depth)?;
            let span = start..self.at;
            if first && sign == 1 {
                product = factor;
            } else {
                if product.zero.is_some() || factor.zero.is_some() {
                    let all = if factor.zero.is_some() { span } else { 0..before };
                    return Err(own_zero(self.symbol_in(&all), self.trimmed(all)));
                }
                product = self.combine(product, factor, sign, span)?;
            }
            first = false;
        }
    }

    /// The unit symbol at the end of a span, for messages.
    fn symbol_in(&self, span: &Range<usize>) -> &'t str {
        let text = self.text.get(span.clone()).unwrap_or_default().trim_end_matches([')', ' ']);
        let start = text.char_indices().rev().find(|(_, c)| !continues_symbol(*c)).map_or(0, |(i, c)| i + c.len_utf8());
        text[start..].trim_start_matches(|c: char| c.is_ascii_digit())
    }

    /// The span of [`Self::symbol_in`].
    fn trimmed(&self, span: Range<usize>) -> Range<usize> {
        let symbol = self.symbol_in(&span);
        self.text[span.clone()].rfind(symbol).map_or(span.clone(), |at| span.start + at..span.start + at + symbol.len())
    }

    fn combine(&self, left: Product, right: Product, power: i32, span: Range<usize>) -> Result<Product, QuantityError> {
        match left.dimension.times(right.dimension, power) {
            Some(dimension) => Ok(Product { dimension, scale: left.scale.times(right.scale, power), zero: None }),
            None => self.error(span, "the power of this unit is beyond any physical quantity", SMALL_POWER),
        }
    }

    /// A symbol or a parenthesis, with its power.
    fn factor(&mut self, depth: usize) -> Result<Product, QuantityError> {
        let start = self.at;
        let mut base = self.base(depth)?;
        let span = start..self.at;
        if let Some(power) = self.power()? {
            if base.zero.is_some() {
                return Err(own_zero(self.symbol_in(&span), self.trimmed(span)));
            }
            let one = Product { dimension: Dimension::NONE, scale: Scale::ONE, zero: None };
            base = self.combine(one, base, power, start..self.at)?;
        }
        Ok(base)
    }

    fn base(&mut self, depth: usize) -> Result<Product, QuantityError> {
        let start = self.at;
        if self.take("(") {
            if depth == DEEPEST {
                let help = "write the unit with fewer parentheses, such as `N*s/m`";
                return self.error(start..self.at, "parentheses are nested too deep", help);
            }
            let inside = self.expression(depth + 1)?;
            self.spaces();
            if !self.take(")") {
                return self.error(self.here(), "`)` is missing", "close the parenthesis");
            }
            return Ok(inside);
        }
        match self.next() {
            Some(c) if starts_symbol(c) => {}
            Some(c) if c.is_ascii_digit() => {
                let help = "write fractions as decimals, such as \"0.25 in\", and powers as `ft^2`";
                return self.error(self.here(), "a unit is expected here, not a number", help);
            }
            Some(c) => {
                return self.error(self.here(), format!("`{c}` cannot stand here"), "write a unit, such as `psi`");
            }
            None => return self.error(self.here(), "a unit is missing at the end", "write a unit, such as `psi`"),
        }
        let symbol = self.take_while(continues_symbol);
        match unit::find(symbol) {
            Ok(unit) => Ok(Product { dimension: unit.dimension, scale: unit.scale, zero: unit.zero }),
            Err(unknown) => Err(QuantityError { span: start..self.at, message: unknown.message, help: unknown.help }),
        }
    }

    /// `^2`, `**-1`, `²`, `⁻¹`, or nothing.
    fn power(&mut self) -> Result<Option<i32>, QuantityError> {
        let start = self.at;
        if self.take("**") || self.take("^") {
            let negative = self.sign();
            let digits = self.take_while(|c| c.is_ascii_digit());
            return match digits.parse::<i32>() {
                Ok(size) if size <= 30 => Ok(Some(if negative { -size } else { size })),
                Ok(_) => {
                    self.error(start..self.at, "the power of this unit is beyond any physical quantity", SMALL_POWER)
                }
                Err(_) => self.error(start..self.at, "a power is a whole number", "write it as in `ft^2` or `s^-1`"),
            };
        }
        let negative = self.take("\u{207b}");
        let digits = self.take_while(|c| superscript(c).is_some());
        let size = digits
            .chars()
            .filter_map(superscript)
            .try_fold(0_i32, |sum, digit| sum.checked_mul(10)?.checked_add(digit).filter(|sum| *sum <= 30));
        match size {
            _ if digits.is_empty() && negative => {
                self.error(start..self.at, "a power is a whole number", "write `s⁻¹`")
            }
            _ if digits.is_empty() => Ok(None),
            Some(size) => Ok(Some(if negative { -size } else { size })),
            None => self.error(start..self.at, "the power of this unit is beyond any physical quantity", SMALL_POWER),
        }
    }
}

fn starts_symbol(c: char) -> bool {
    (c.is_alphabetic() && superscript(c).is_none()) || matches!(c, '°' | '%' | '℃' | '℉')
}

fn continues_symbol(c: char) -> bool {
    starts_symbol(c) || c.is_ascii_digit()
}

fn superscript(c: char) -> Option<i32> {
    "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().zip(0..).find_map(|(sign, digit)| (sign == c).then_some(digit))
}
