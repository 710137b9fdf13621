//! Laws of force in scenario files: each by its name, in its own units, and what is refused.

use mckibben::force::Law;
use mckibben_scenario::{BladderForm, Document, Force, Scenario};

const REST: &str = "[load]\nkind = \"hanging-mass\"\nmass = \"2 lb\"\n[initial]\ngauge_pressure = \"40 psi\"\n[run]\nduration = \"0.1 s\"\n";

const MAP: &str = "[actuator.force]\nlaw = \"map\"\ngauge_pressure = [\"20 psi\", \"60 psi\"]\nlength = [\"7 cm\", \"9 cm\"]\n\
                   tension = [\"4 N\", \"20 N\", \"12 N\", \"60 N\"]";

const MEMBRANE: &str = "[actuator.force]\nlaw = \"martens-boblan\"\nmembrane_thickness = \"0.3 mm\"\nmodulus = [4, -60, 300, 100]\nmodulus_unit = \"MPa\"\nlength_unit = \"m\"";
const EXTENSIBLE: &str = "[actuator.force]\nlaw = \"extensible-braid\"\nthread_stiffness = \"30 kN/m\"";
const BOLEN: &str = "[actuator.force]\nlaw = \"bolen\"\nmax_force = \"90 N\"\nmax_pressure = \"620 kPa\"\nmax_contraction = 0.3\nshape = [0.26, 6.4, 1.3]";

const POLYNOMIAL: &str = "[actuator.force]\nlaw = \"polynomial\"\npressure_coefficients = [120, -800, 900]\npassive_coefficients = [1, 40]\npressure_unit = \"MPa\"\nforce_unit = \"N\"";
const TAPER: &str = "[actuator.taper]\nend_radius = \"2.8 mm\"\nlength_ratio = 1.7";

fn document(lines: &str) -> Document {
    Document::parse(&format!("{lines}\n{REST}"), "muscle.toml").unwrap_or_else(|error| panic!("{error}"))
}

fn read(lines: &str) -> Scenario {
    document(lines).scenario().unwrap_or_else(|error| panic!("{error}"))
}

fn refused(lines: &str) -> String {
    document(lines).experiment().expect_err("a mistake").to_string()
}

#[test]
fn the_ideal_braid_is_the_default() {
    let named = read("[actuator.force]\nlaw = \"ideal-braid\"");
    assert_eq!(read(""), named);
    assert_eq!(named.actuator.force, Force::IdealBraid);
    assert_eq!((named.actuator.bladder, named.actuator.wall_thickness), (None, 0.0));
}

#[test]
fn each_law_is_read_written_and_built() {
    let files = [
        "[actuator.force]\nlaw = \"tondu-lopez\"",
        "[actuator.force]\nlaw = \"tondu-lopez\"\nend_factor = 1.1\nend_factor_rise = 0.3\nend_factor_pressure = \"2 bar\"",
        "[actuator.force]\nlaw = \"tondu-lopez\"\nradius = \"3.2 mm\"\na = 11.5\nb = 4.8",
        "[actuator.force]\nlaw = \"sarosi\"\ncoefficients = [0.01, 5, -0.2, -0.006, 0.2, -6]\npressure_unit = \"kPa\"\nforce_unit = \"N\"",
        MAP,
        MEMBRANE,
        BOLEN,
        EXTENSIBLE,
        "[actuator]\nwall_thickness = \"0.4 mm\"",
        POLYNOMIAL,
        TAPER,
        "[actuator.bladder]\nform = \"linear\"\nforce = \"6 N\"",
        "[actuator.bladder]\nform = \"saturating\"\nforce = \"6 N\"\nscale = 0.05",
        "[actuator.force]\nlaw = \"tondu-lopez\"\n[actuator.bladder]\nform = \"exponential\"\nforce = \"1 N\"\nscale = 0.1",
    ];
    for file in files {
        let scenario = read(file);
        let again = Scenario::from_str(&scenario.to_toml(), "written.toml").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(again, scenario);
        let experiment = scenario.experiment().unwrap_or_else(|error| panic!("{file}: {error}"));
        let law = &experiment.rig.actuator().law().law;
        assert_eq!(law.bladder().is_some(), file.contains("bladder"));
        assert_eq!(law.wall().is_some(), file.contains("wall"));
        assert_eq!(law.taper().is_some(), file.contains("taper"));
        assert_eq!(matches!(law.law(), Law::Polynomial(_)), file.contains("polynomial"));
        assert_eq!(matches!(law.law(), Law::TonduLopez(_)), file.contains("tondu"));
        assert_eq!(matches!(law.law(), Law::Sarosi(_)), file.contains("sarosi"));
        assert_eq!(matches!(law.law(), Law::MartensBoblan(_)), file.contains("martens"));
        assert_eq!(matches!(law.law(), Law::ExtensibleBraid(_)), file.contains("extensible"));
        assert_eq!(matches!(law.law(), Law::Bolen(_)), file.contains("bolen"));
    }
    let saturating = read(files[12]).actuator.bladder.expect("a bladder");
    assert_eq!((saturating.form, saturating.force, saturating.scale), (BladderForm::Saturating, 6.0, 0.05));
}

#[test]
fn the_coefficients_of_sarosi_take_their_units_along() {
    let file = |pressure: &str, force: &str, list: &str| {
        read(&format!(
            "[actuator.force]\nlaw = \"sarosi\"\ncoefficients = {list}\npressure_unit = \"{pressure}\"\nforce_unit = \"{force}\""
        ))
    };
    let Force::Sarosi(a) = file("kPa", "kN", "[1, 2, 3, 4, 5, 6]").actuator.force else { panic!("another law") };
    assert_eq!(a, [1.0, 2e3, 3.0, 4.0, 5.0, 6e3]);
}

#[test]
fn the_coefficients_of_a_polynomial_take_their_units_along() {
    let expected = Force::Polynomial { pressure: vec![120e-6, -800e-6, 900e-6], passive: vec![1.0, 40.0] };
    let kilo = POLYNOMIAL.replace("[120, -800, 900]", "[0.12e-3, -0.8e-3, 0.9e-3]").replace("[1, 40]", "[1e-3, 0.04]");
    let Force::Polynomial { pressure, passive } = expected else { panic!("another law") };
    for file in [POLYNOMIAL.to_owned(), kilo.replace("MPa", "kPa").replace("\"N\"", "\"kN\"")] {
        let Force::Polynomial { pressure: a, passive: b } = read(&file).actuator.force else { panic!("another law") };
        for (found, expected) in a.iter().chain(&b).zip(pressure.iter().chain(&passive)) {
            assert!((found / expected - 1.0).abs() < 1e-14, "{found} is not {expected}");
        }
    }
    let bare = POLYNOMIAL.replace("passive_coefficients = [1, 40]\n", "");
    let Force::Polynomial { passive, .. } = read(&bare).actuator.force else { panic!("another law") };
    assert!(passive.is_empty());
}

#[test]
fn the_modulus_takes_its_units_along() {
    let file = MEMBRANE.replace("\"m\"", "\"mm\"").replace("[4, -60, 300, 100]", "[4, -0.06, 3e-4, 1e-7]");
    let Force::MartensBoblan { modulus, .. } = read(&file).actuator.force else { panic!("another law") };
    for (found, expected) in modulus.into_iter().zip([4e6, -6e7, 3e8, 1e8]) {
        assert!((found / expected - 1.0_f64).abs() < 1e-14, "{found}");
    }
}

#[test]
fn what_is_missing_or_out_of_place_is_said() {
    let short = MAP.replace(", \"60 N\"]", "]");
    let three = MEMBRANE.replace(", 100]", "]");
    let square = MEMBRANE.replace("\"m\"", "\"m^2\"");
    let soft = EXTENSIBLE.replace("30", "0");
    let far = BOLEN.replace("0.3\n", "1.5\n");
    let falling = MAP.replace("60 psi", "10 psi");
    let seven = POLYNOMIAL.replace("[1, 40]", "[1, 2, 3, 4, 5, 6, 7]");
    let unitless = POLYNOMIAL.replace("force_unit = \"N\"", "");
    let wide = TAPER.replace("2.8 mm", "4 mm");
    let long = TAPER.replace("1.7", "17");
    let cases = [
        ("[actuator.force]\nlaw = \"tondu-lopes\"", "did you mean \"tondu-lopez\"?"),
        (
            "[actuator.force]\nend_factor = 1.1",
            "`actuator.force.end_factor` is not used when `actuator.force.law` = \"ideal-braid\"",
        ),
        ("[actuator.force]\nlaw = \"tondu-lopez\"\na = 12", "which `a` needs in addition"),
        ("[actuator.force]\nlaw = \"tondu-lopez\"\nend_factor = 0", "end_factor"),
        ("[actuator.force]\nlaw = \"sarosi\"", "`actuator.force.coefficients` (a_i) is missing"),
        (
            "[actuator.force]\nlaw = \"sarosi\"\ncoefficients = [1, 2, 3]\npressure_unit = \"kPa\"\nforce_unit = \"N\"",
            "has 3 entries instead of six",
        ),
        (
            "[actuator.force]\nlaw = \"sarosi\"\ncoefficients = [1, 2, 3, 4, 5, 6]\npressure_unit = \"mm\"\nforce_unit = \"N\"",
            "is a unit of a length",
        ),
        ("[actuator.force]\nlaw = \"martens-boblan\"", "`actuator.force.modulus` (c_i) is missing"),
        (three.as_str(), "has 3 entries instead of four"),
        (square.as_str(), "is a unit of an area"),
        ("[actuator.force]\nlaw = \"extensible-braid\"", "`actuator.force.thread_stiffness` (K) is missing"),
        (soft.as_str(), "give a stiffness above zero"),
        (far.as_str(), "`actuator.force.max_contraction` = 1.5 is out of range"),
        ("[actuator.force]\nmax_force = \"9 N\"", "is not used when `actuator.force.law` = \"ideal-braid\""),
        (short.as_str(), "`actuator.force.tension` has 3 entries, and 4 are due"),
        (falling.as_str(), "the entries do not rise"),
        ("[actuator.force]\nlaw = \"map\"", "`actuator.force.tension` (F) is missing"),
        ("[actuator.force]\nlaw = \"polynomial\"", "`actuator.force.pressure_coefficients` (a_i) is missing"),
        (seven.as_str(), "keep to 6 coefficients"),
        (unitless.as_str(), "`actuator.force.force_unit` is missing"),
        ("[actuator.taper]\nlength_ratio = 1", "`actuator.taper.end_radius` (r_e) is missing"),
        (wide.as_str(), "must be at most the braid's radius at actuator.max_length"),
        (long.as_str(), "must be less than actuator.min_length over the braid's diameter there"),
        ("[actuator.bladder]\nforce = \"1 N\"", "`actuator.bladder.form` is missing"),
        ("[actuator.bladder]\nform = \"linear\"\nforce = \"1 N\"\nscale = 0.1", "is not used when"),
        ("[actuator.bladder]\nform = \"saturating\"\nforce = \"1 N\"", "`actuator.bladder.scale` (s) is missing"),
        ("[actuator]\nwall_thickness = \"4 mm\"", "must be less than the braid's radius"),
        (
            "[actuator]\nthread_length = \"20 cm\"\nturns = 2.5\nmax_length = \"10 cm\"\nmin_length = \"5 cm\"",
            "a tendon cannot",
        ),
    ];
    for (lines, words) in cases {
        let text = refused(lines);
        assert!(text.contains(words), "{lines}\n{text}\ndoes not say {words}");
    }
}
