//! Friction in a scenario file.

use mckibben::friction::{BoucWen, Coulomb, Friction, Hysteresis, LuGre, MaxwellSlip, Viscoelastic};
use mckibben_scenario::Document;

const LOAD: &str = "[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[run]\nduration = \"1 s\"\n";

fn document(friction: &str) -> Document {
    Document::parse(&format!("[actuator]\npreset = \"colbrunn-2001\"\n{friction}\n{LOAD}"), "muscle.toml")
        .expect("TOML")
}

fn problem(friction: &str) -> String {
    document(friction).experiment().expect_err("a mistake").to_string()
}

const ELEMENTS: &str = "[actuator.friction]\nviscous = \"2 N*s/m\"\ncoulomb_width = \"0.1 mm\"\ncoulomb_force = \"0.5 N\"\n\
    coulomb_force_per_pressure = \"2 mm^2\"\nstatic_ratio = 1.4\nstribeck_velocity = \"5 mm/s\"\n\
    [actuator.friction.hysteresis]\nlaw = \"maxwell-slip\"\nreach = [\"0.1 mm\", \"1 mm\"]\nstiffness_ratio = [0.8, 0.1]\n";

#[test]
fn every_number_reaches_the_core() {
    let experiment = document(ELEMENTS).experiment().expect("a scenario");
    let coulomb =
        Coulomb::new(1e-4).and_then(|law| law.with_force(0.5, 2e-6)).and_then(|law| law.with_stribeck(1.4, 5e-3));
    let elements = MaxwellSlip::new(&[1e-4, 1e-3], &[0.8, 0.1]).expect("elements");
    let friction = Friction::with_coulomb(2.0, coulomb.expect("a law")).expect("friction");
    let expected = friction.with_hysteresis(Hysteresis::MaxwellSlip(elements));
    assert_eq!(*experiment.rig.actuator().friction(), expected);
}

const ROUNDED: &str = "[actuator.friction]\ncoulomb_width = \"0 m\"\n[actuator.friction.hysteresis]\nlaw = \"bouc-wen\"\n\
    width = \"0.1 mm\"\nbeta = \"4 mm^-1\"\ngamma = \"-1500 m^-1\"\n";

#[test]
fn a_rounded_loop_reaches_the_core_and_has_separate_keys() {
    let experiment = document(ROUNDED).experiment().expect("a scenario");
    let law = BoucWen::new(1e-4, 4e3, -1.5e3).expect("a law");
    assert_eq!(experiment.rig.actuator().friction().hysteresis(), Some(&Hysteresis::BoucWen(law)));
    let section = "[actuator.friction.hysteresis]\nlaw = \"bouc-wen\"\nwidth = \"0.1 mm\"\n";
    assert!(problem(section).contains("beta"));
    assert!(problem(&format!("{section}beta = \"4000 m^-1\"\ngamma = \"5000 m^-1\"")).contains("yield work"));
    let foreign = problem(&format!("{section}beta = \"4000 m^-1\"\nreach = [\"1 mm\"]"));
    assert!(foreign.contains("reach"), "{foreign}");
}

const BRISTLES: &str = "[actuator.friction.hysteresis]\nlaw = \"lugre\"\nwidth = \"0.1 mm\"\nbristle_reach = \"0.05 mm\"\n\
    static_ratio = 1.4\nstribeck_velocity = \"8 mm/s\"\ndamping_time = \"5 ms\"\n";

#[test]
fn bristles_reach_the_core_and_have_separate_keys() {
    let experiment = document(BRISTLES).experiment().expect("a scenario");
    let law = LuGre::new(1e-4, 5e-5).and_then(|law| law.with_velocity(1.4, 8e-3, 5e-3)).expect("a law");
    assert_eq!(experiment.rig.actuator().friction().hysteresis(), Some(&Hysteresis::LuGre(law)));
    let section = "[actuator.friction.hysteresis]\nlaw = \"lugre\"\nwidth = \"0.1 mm\"\n";
    assert!(problem(section).contains("bristle_reach"));
    let damped = problem(&format!("{section}bristle_reach = \"0.01 mm\"\ndamping_time = \"1 s\""));
    assert!(damped.contains("damping_time") && damped.contains("yield work"), "{damped}");
    assert!(problem(&format!("{section}bristle_reach = \"0.01 mm\"\nbeta = \"1 mm^-1\"")).contains("beta"));
}

const BRANCHES: &str = "[actuator.friction]\nstructural_damping = \"2 ms\"\n[actuator.friction.viscoelastic]\n\
    relaxation_time = [\"0.1 s\", \"1 s\"]\nstiffness_ratio = [0.1, 0.2]\n";

#[test]
fn branches_reach_the_core() {
    let experiment = document(BRANCHES).experiment().expect("a scenario");
    let friction = experiment.rig.actuator().friction();
    assert_eq!(friction.structural_damping(), Some(2e-3));
    let law = Viscoelastic::new(&[], &[0.1, 0.2], &[0.1, 1.0]).expect("branches");
    assert_eq!(friction.viscoelastic(), Some(&law));
    let section = "[actuator.friction.viscoelastic]\n";
    assert!(problem(&format!("{section}relaxation_time = [\"1 s\"]")).contains("stiffness_ratio"));
    assert!(problem(&format!("{section}stiffness_ratio = [0.1]")).contains("relaxation_time"));
    let uneven = problem(&format!("{section}relaxation_time = [\"1 s\"]\nstiffness = [\"1 N/m\", \"2 N/m\"]"));
    assert!(uneven.contains("equally long"), "{uneven}");
    let falling =
        "relaxation_time = [\"1 s\", \"0.1 s\"]\nstiffness = [\"1 N/m\", \"2 N/m\"]\nstiffness_ratio = [0, 0]";
    let falling = problem(&format!("{section}{falling}"));
    assert_eq!(falling.matches("must increase").count(), 1, "{falling}");
    assert!(
        problem(&format!("{section}relaxation_time = [\"0 s\"]\nstiffness_ratio = [0.1]")).contains("relaxation_time")
    );
}

#[test]
fn what_is_written_reads_back_the_same() {
    for text in [ELEMENTS, ROUNDED, BRISTLES, BRANCHES] {
        let scenario = document(text).scenario().expect("a scenario");
        let again = Document::parse(&scenario.to_toml(), "again.toml").expect("TOML").scenario().expect("a scenario");
        assert_eq!(again, scenario);
    }
}

#[test]
fn mistakes_are_shown_where_they_are() {
    let section = "[actuator.friction.hysteresis]\n";
    assert!(problem(&format!("{section}reach = [\"1 mm\"]")).contains("stiffness_ratio` (w_i) is missing"));
    let uneven = problem(&format!("{section}reach = [\"1 mm\", \"2 mm\"]\nstiffness_ratio = [0.1]"));
    assert!(uneven.contains("stiffness_ratio"), "{uneven}");
    let negative = problem(&format!("{section}reach = [\"-1 mm\"]\nstiffness_ratio = [0.1]"));
    assert!(negative.contains("reach"), "{negative}");
    assert!(problem("[actuator.friction]\nstatic_ratio = 0.5").contains("static_ratio"));
    assert!(problem(&format!("{section}law = \"maxwel-slip\"")).contains("maxwell-slip"));
}
