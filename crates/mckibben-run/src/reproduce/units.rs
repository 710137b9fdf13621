//! The paper's units, in which its figures are drawn, and the words on what is assumed.

use crate::report::typeset;
use mckibben_scenario::presets;

/// One inch in m.
pub(super) const INCH: f64 = 0.0254;
/// One pound in kg.
pub(super) const LB: f64 = 0.453_592_37;
/// One pound-force in N.
pub(super) const LBF: f64 = LB * 9.806_65;
/// One pound-force per square inch in Pa.
pub(super) const PSI: f64 = LBF / (INCH * INCH);
/// One pound-force per inch in N/m.
pub(super) const LBF_PER_INCH: f64 = LBF / INCH;

/// Values in another unit.
pub(super) fn in_unit(values: impl IntoIterator<Item = f64>, unit: f64) -> Vec<f64> {
    values.into_iter().map(|value| value / unit).collect()
}

/// The assumed values of the paper's actuator as one line, for the foot of a figure: those of these symbols.
pub(super) fn assumed(symbols: &[&str]) -> String {
    let preset = &presets::COLBRUNN_2001;
    let given = symbols.iter().filter_map(|symbol| {
        let value = preset.values.iter().find(|value| value.assumed && value.parameter.symbol == *symbol)?;
        Some(format!("{} = {}", typeset(symbol), typeset(value.text)))
    });
    format!("Assumed, as the paper does not say: {}.", given.collect::<Vec<_>>().join(", "))
}

/// The symbols of a sealed or driven actuator that swings, in the order of [`assumed`].
pub(super) const ALL: &[&str] = &["b", "n", "Eff", "V_ext", "K_braid", "C_braid"];
/// The symbols that matter while the braid never becomes taut.
pub(super) const INSIDE: &[&str] = &["b", "n", "Eff", "V_ext"];

#[cfg(test)]
mod tests {
    #[test]
    fn the_constants_are_those_of_the_scenario_files() {
        let size = |unit: &str| mckibben_scenario::quantity::parse_unit(unit).unwrap().1;
        let close = |value: f64, unit: &str| assert!((value / size(unit) - 1.0).abs() < 1e-15, "{unit}");
        for (value, unit) in [
            (super::INCH, "in"),
            (super::LB, "lb"),
            (super::LBF, "lbf"),
            (super::PSI, "psi"),
            (super::LBF_PER_INCH, "lbf/in"),
        ] {
            close(value, unit);
        }
        assert!(super::assumed(super::ALL).matches(" = ").count() == 6, "{}", super::assumed(super::ALL));
    }
}
