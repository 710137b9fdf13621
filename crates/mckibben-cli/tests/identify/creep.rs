//! A record that starts before the muscle has come to rest: what the history has left in its branches is found.

use super::{cell, identify, printed, read};
use crate::common::Folder;

const SCENARIO: &str = "[actuator]\npreset = \"colbrunn-2001\"\n[actuator.friction.viscoelastic]\nrelaxation_time = [\"0.5 s\"]\n\
    stiffness_ratio = [0.2]\ninitial_stretch = [\"1 mm\"]\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n\
    [pressure]\ntime = [\"0 s\", \"0.2 s\", \"1 s\"]\ngauge_pressure = [\"40 psi\", \"60 psi\", \"50 psi\"]\n\
    [run]\nduration = \"1.5 s\"\nsample_interval = \"10 ms\"\n";

const STUDY: &str = "[study]\nkind = \"trajectories\"\nscenario = \"muscle.toml\"\ninput = \"gauge-pressure\"\n[search]\nmore_starts = 0\n\
    [columns.time]\nname = \"time_s\"\nunit = \"s\"\n[columns.length]\nname = \"length_m\"\nunit = \"m\"\n\
    [columns.gauge_pressure]\nname = \"gauge_pressure_pa\"\nunit = \"Pa\"\n[[run]]\nfile = \"run.csv\"\n\
    [fit.\"actuator.friction.viscoelastic.stiffness_ratio[0]\"]\nfrom = 0\nto = 1\n\
    [fit.\"actuator.friction.viscoelastic.initial_stretch[0]\"]\nfrom = \"-5 mm\"\nto = \"5 mm\"\n";

#[test]
fn the_initial_stretch_of_the_branches_is_estimated() {
    let folder = Folder::new("identify-creep");
    folder.file("muscle.toml", SCENARIO);
    let output = folder.mckibben().args(["simulate", "muscle.toml", "--output", "run.csv"]).output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder.file("muscle.toml", &SCENARIO.replace("\"1 mm\"", "\"0 mm\"").replace("[0.2]", "[0.1]"));
    let output = identify(&folder, &folder.file("study.toml", STUDY));
    let report = printed(&output);
    let values = read(&folder, "out/values.csv");
    let of = "actuator.friction.viscoelastic";
    for (name, expected) in [("initial_stretch[0]", 1e-3), ("stiffness_ratio[0]", 0.2)] {
        let value = cell(&values, &format!("{of}.{name}"), "value");
        assert!((value / expected - 1.0).abs() < 1e-4, "{name}: {value} is not {expected}\n{report}");
    }
    assert!(values.lines().any(|line| line.contains("initial_stretch[0]") && line.contains(",m,")), "{values}");
}
