//! Files of many actuators as they are written back, and with other values of some parameters.

use super::{document, plant};
use mckibben_scenario::Document;
use std::path::Path;

/// Sections in the order of the file, the keys of each before its sections, names in quotes where TOML wants them; an empty
/// section says something, too.
#[test]
fn a_file_is_written_in_sections() {
    let said = document(
        "run.duration = \"1 s\"\nload = { kind = \"hanging-mass\", mass = \"5 lb\" }\n[actuators.muscle]\n\
         [actuators.other]\nhose.length = \"1 m\"\nturns = 2.5\n[actuators.other.command]\ntime = [\"0 s\", 0.5]\n\
         [actuators.\"an odd\".load]\nmass = 3\n",
    );
    let written = "[run]\nduration = \"1 s\"\n\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n\n[actuators.muscle]\n\n\
                   [actuators.other]\nturns = 2.5\n\n[actuators.other.hose]\nlength = \"1 m\"\n\n[actuators.other.command]\n\
                   time = [\"0 s\", 0.5]\n\n[actuators.\"an odd\".load]\nmass = 3.0\n";
    assert_eq!(said.to_toml(), written);
    assert_eq!(document(written).to_toml(), written);
}

#[test]
fn what_is_written_is_the_same_plant() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/plant");
    for entry in std::fs::read_dir(folder).expect("examples") {
        let file = Document::load(entry.expect("an entry").path()).expect("TOML");
        assert_eq!(plant(&file.to_toml()), plant(file.source().text()), "{}", file.source().name());
    }
}

/// A file that says nothing of its braids means a preset: with one number of the braid put in, the others stay the preset's.
#[test]
fn a_number_of_all_braids_leaves_the_others_of_the_preset() {
    let file = document(
        "[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n[initial]\ngauge_pressure = \"1 bar\"\n[run]\nduration = \"1 s\"\n\
         [actuators.one]\n[actuators.two]\nturns = 2.2\n[actuators.three]\nmax_length = \"97 mm\"\nfriction.viscous = \"4 N*s/m\"\n",
    );
    let place = file.find_in_plant("actuator.turns").expect("a parameter");
    let turned = file.with_plant_values(&[place], &[2.7]).expect("in range");
    let braids = |of: &Document| {
        let of = plant(&of.to_toml()).plant;
        let braids = of.actuators().iter().map(|its| its.actuator.law().law.braid);
        braids.map(|braid| (braid.turns(), braid.thread_length())).collect::<Vec<_>>()
    };
    let thread = braids(&file)[0].1;
    assert_eq!(braids(&turned), [(2.7, thread), (2.2, thread), (2.7, thread)]);
}
