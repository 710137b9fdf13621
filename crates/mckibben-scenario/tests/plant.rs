//! Files of many actuators: what is said once holds of all, what is said of one of that one, and names lead where they say.

mod written;

use mckibben::network::{BranchKind, NodeKind};
use mckibben::plant::{Plant, simulate_plant};
use mckibben_scenario::keys::PLANT_KEYS;
use mckibben_scenario::{Document, PlantExperiment, schema};
use std::path::Path;

fn document(text: &str) -> Document {
    Document::parse(text, "plant.toml").expect("TOML")
}

fn plant(text: &str) -> PlantExperiment {
    match document(text).plant_experiment() {
        Ok(Some(plant)) => plant,
        Ok(None) => panic!("no plant"),
        Err(found) => panic!("{found}\n{text}"),
    }
}

fn mistakes(text: &str) -> String {
    document(text).plant_experiment().expect_err(text).to_string()
}

/// What every actuator has, in the tests below.
const ALL: &str = r#"
[actuator]
turns = 2.4
thread_length = "11 cm"
max_length = "97 mm"
[actuator.friction]
viscous = "4 N*s/m"
coulomb_width = "0.1 mm"
[supply]
gauge_pressure = "5 bar"
[valve]
kind = "three-way"
flow_area = "1.5 mm^2"
opening_delay = "4 ms"
[hose]
length = "60 cm"
diameter = "2.5 mm"
[command]
kind = "pwm"
frequency = "20 Hz"
duty = 0.4
[initial]
gauge_pressure = "1 bar"
[run]
duration = "0.2 s"
"#;

const CHAIN: &str = r#"
[mechanism]
kind = "chain"
[mechanism.joints.shoulder]
segment = "upper-arm"
length = "28 cm"
mass = "0.8 kg"
distance = "12 cm"
[mechanism.joints.elbow]
segment = "forearm"
mass = "0.5 kg"
distance = "10 cm"
angle = "20 deg"
[coupling]
rest_length = "88 mm"
"#;

#[test]
fn six_alike_are_the_same_short_as_long() {
    let arms = ["a", "b", "c", "d", "e", "f"].into_iter().zip(["shoulder", "elbow"].into_iter().cycle());
    let (mut short, mut long) = (format!("{ALL}{CHAIN}"), CHAIN.replace("[coupling]\nrest_length = \"88 mm\"\n", ""));
    // What belongs to the whole plant stays at the top of the long file.
    let own = ALL.split("[supply]").collect::<Vec<_>>();
    let whole = "[supply]\ngauge_pressure = \"5 bar\"\n[run]\nduration = \"0.2 s\"\n";
    long.push_str(whole);
    let sections = own[1].replace("\ngauge_pressure = \"5 bar\"\n", "").replace("[run]\nduration = \"0.2 s\"\n", "");
    for (index, (name, joint)) in arms.enumerate() {
        let arm = if index % 2 == 0 { "14 mm" } else { "-14 mm" };
        short.push_str(&format!("[actuators.{name}]\ncoupling.arms.{joint} = \"{arm}\"\n"));
        let of_actuator = own[0].replace("[actuator", &format!("[actuators.{name}"));
        let of_sections = sections.replace('[', &format!("[actuators.{name}."));
        long.push_str(&of_actuator);
        long.push_str(&of_sections);
        long.push_str(&format!("[actuators.{name}.coupling]\nrest_length = \"88 mm\"\narms.{joint} = \"{arm}\"\n"));
    }
    let (short, long) = (plant(&short), plant(&long));
    assert_eq!(short, long);
    let end = |of: &PlantExperiment| {
        let run = simulate_plant(&of.plant, &of.start, of.run.duration, 1e-8).expect("a run");
        run.at(of.run.duration).0.into_iter().map(f64::to_bits).collect::<Vec<_>>()
    };
    assert_eq!(end(&short), end(&long));
}

/// Every shipped file of one actuator, with a name for it and nothing else added, is bit-identical to the plant of its
/// rig.
#[test]
fn one_actuator_is_what_it_is_without_a_name() {
    let mut tried = 0;
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    for below in ["", "paper", "laws", "line", "valves", "friction"] {
        for entry in std::fs::read_dir(folder.join(below)).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.extension().is_none_or(|ending| ending != "toml") {
                continue;
            }
            let text = std::fs::read_to_string(&path).expect("a file");
            let Ok(old) = document(&text).experiment() else { continue };
            if text.contains("[sweep]") || text.contains("\nactuators = ") {
                continue;
            }
            let new = plant(&format!("{text}\n[actuators.muscle]\n"));
            assert_eq!(new.plant, Plant::of_rig(&old.rig), "{}", path.display());
            assert_eq!(new.start, Plant::start_of_rig(&old.rig, &old.start), "{}", path.display());
            assert_eq!(new.run, old.run);
            tried += 1;
        }
    }
    assert!(tried > 30, "{tried}");
}

#[test]
fn what_is_said_of_one_is_of_that_one() {
    let text = format!(
        "{ALL}[load]\nkind = \"hanging-mass\"\nmass = \"2 kg\"\n[actuators.first]\n[actuators.second]\nturns = 2.0\n\
         load.mass = \"3 kg\"\ncommand.duty = 0.6\n[actuators.third]\nvalve = {{ preset = \"matrix-eight-channel\", kind = \
         \"fill-hold-exhaust\" }}\n[actuators.third.command]\nkind = \"hold\"\n"
    );
    let of = plant(&text);
    assert_eq!(of.names.actuators, ["first", "second", "third"]);
    let turns: Vec<f64> = of.plant.actuators().iter().map(|its| its.actuator.law().law.braid.turns()).collect();
    assert_eq!(turns, [2.4, 2.0, 2.4]);
    let valves = &of.plant.network().valves;
    assert_eq!(valves.len(), 3);
    assert_eq!(valves[0].solenoid, valves[1].solenoid);
    assert_ne!(valves[0].command, valves[1].command);
    assert_ne!(valves[0].solenoid, valves[2].solenoid);
    // All three hang from the one supply.
    let sources = of.plant.network().nodes.iter().filter(|node| matches!(node.kind, NodeKind::Source)).count();
    assert_eq!((sources, of.names.nodes.len()), (1, 1));
}

/// Hoses in cells count from the valve; what a file does not name is called after what it leads to.
#[test]
fn nodes_are_called_after_what_they_lead_to() {
    let text = r#"
[supplies.compressor]
gauge_pressure = "7 bar"
[supplies.tank]
from = "compressor"
reservoir_volume = "1 L"
inlet = { flow_area = "10 mm^2", kind = "check-valve" }
hose = { length = "1 m", diameter = "6 mm", kind = "distributed", cells = 2 }
[load]
kind = "isometric"
[initial]
length = "90 mm"
[actuators.flexor]
supply = "tank"
hose = { length = "1 m", diameter = "2.5 mm", kind = "distributed", cells = 3 }
valve.preset = "matrix-eight-channel"
command = { kind = "fill" }
[actuators.extensor]
supply = "compressor"
hose = { length = "1 m", diameter = "2.5 mm" }
[actuators.extensor.valve]
kind = "pressure-regulator"
time_constant = "30 ms"
dead_time = "10 ms"
rate_limit = "15 bar/s"
sonic_conductance = "2 L/(min*bar) ANR"
critical_ratio = 0.3
[actuators.extensor.command]
kind = "set-points"
time = ["0.1 s"]
gauge_pressure = ["4 bar"]
[run]
duration = "1 s"
"#;
    let of = plant(text);
    let (network, indices) = (of.plant.network(), of.plant.indices());
    let with_state = |node: &usize| indices.nodes[*node].is_some();
    let nodes: Vec<String> =
        (0..network.nodes.len()).filter(with_state).map(|node| of.name_of_node(node, "pressure")).collect();
    assert_eq!(
        nodes,
        [
            "tank.pressure",
            "tank.hose_pressure_1",
            "tank.hose_pressure_2",
            "flexor.hose_pressure_1",
            "flexor.hose_pressure_2",
            "flexor.hose_pressure_3",
            "extensor.regulated_pressure",
            "extensor.hose_pressure",
        ]
    );
    let flows = (0..network.branches.len()).filter(|branch| indices.branches[*branch].is_some());
    let flows: Vec<String> = flows.map(|branch| of.name_of_flow(branch, "flow")).collect();
    assert_eq!(
        flows,
        ["tank.hose_flow_1", "tank.hose_flow_2", "flexor.hose_flow_1", "flexor.hose_flow_2", "flexor.hose_flow_3",]
    );
}

#[test]
fn air_comes_by_the_tree_that_is_named() {
    let supplies = r#"
[supplies.manifold]
from = "regulator"
reservoir_volume = "50 cm^3"
inlet = { flow_area = "10 mm^2", kind = "check-valve" }
hose = { length = "1 m", diameter = "6 mm" }
[supplies.tank]
gauge_pressure = "7 bar"
reservoir_volume = "2 L"
compressor_displacement = "40 L/min"
cut_in_gauge_pressure = "6 bar"
cut_out_gauge_pressure = "8 bar"
[supplies.regulator]
from = "tank"
gauge_pressure = "4 bar"
lag = "20 ms"
"#;
    let base = ALL
        .replace("[supply]\ngauge_pressure = \"5 bar\"\n", "")
        .replace("[hose]\nlength = \"60 cm\"\ndiameter = \"2.5 mm\"\n", "");
    let load = "[load]\nkind = \"isometric\"\n[actuators.one]\nsupply = \"manifold\"\ninitial.length = \"90 mm\"\n";
    let of = plant(&format!("{base}{supplies}{load}"));
    let network = of.plant.network();
    let node = |name: &str| of.names.nodes.iter().find(|(its, _)| its == name).expect(name).1;
    let [tank, regulator, manifold] = ["tank", "regulator", "manifold"].map(node);
    assert!(matches!(network.nodes[regulator].kind, NodeKind::Outlet { inlet: Some(inlet), .. } if inlet == tank));
    // The manifold starts at what feeds it, and its hose is behind the check valve.
    let check = network.branches.iter().find(|branch| matches!(branch.kind, BranchKind::Check { .. })).expect("one");
    assert_eq!(check.from, regulator);
    assert!(matches!(network.nodes[check.to].kind, NodeKind::Hose(_)));
    assert!(network.branches.iter().any(|branch| branch.from == check.to && branch.to == manifold));
    let fed = network.branches.iter().filter(|branch| branch.from == manifold);
    assert_eq!(fed.filter(|branch| matches!(branch.kind, BranchKind::Path { .. })).count(), 1);
    let start = of.plant.start(&of.start).expect("a start");
    let pressure = |node: usize| start[of.plant.indices().nodes[node].expect("a state")];
    assert_eq!([tank, regulator, manifold].map(pressure), [801_325.0, 501_325.0, 501_325.0]);
    assert_eq!(pressure(check.to), 501_325.0);
    let run = simulate_plant(&of.plant, &of.start, 0.2, 1e-8).expect("a run");
    let filling = run.sample(0.015);
    let [tank_now, manifold_now] = [tank, manifold].map(|node| filling.nodes[node].pressure.0);
    assert!(filling.actuators[0].pressure.0 > 210_000.0 && manifold_now < 501_325.0, "{manifold_now}");
    assert!(tank_now != 801_325.0);
}

#[test]
fn joints_stand_in_the_order_that_they_name() {
    let joint = |name: &str, after: &str| {
        let after = if after.is_empty() { String::new() } else { format!("after = \"{after}\"\n") };
        let numbers = format!("length = \"20 cm\"\nmass = \"{} kg\"\ndistance = \"5 cm\"\n", name.len());
        format!("[mechanism.joints.{name}]\n{after}{numbers}")
    };
    let with = |joints: &[String]| {
        let rest = "[coupling]\nrest_length = \"88 mm\"\n[actuators.one]\ncoupling.arms.wrist = \"1 cm\"\n";
        format!("{ALL}[mechanism]\nkind = \"chain\"\n{}{rest}", joints.concat())
    };
    let plain = plant(&with(&[joint("shoulder", ""), joint("elbow", ""), joint("wrist", "")]));
    assert_eq!(plain.names.mechanisms[0].joints, ["shoulder", "elbow", "wrist"]);
    for joints in [
        [joint("wrist", "elbow"), joint("elbow", "shoulder"), joint("shoulder", "")],
        [joint("elbow", "shoulder"), joint("wrist", ""), joint("shoulder", "")],
        [joint("shoulder", ""), joint("wrist", "elbow"), joint("elbow", "shoulder")],
    ] {
        assert_eq!(plant(&with(&joints)), plain);
    }
    let branch = with(&[joint("shoulder", ""), joint("elbow", ""), joint("wrist", "shoulder")]);
    assert!(mistakes(&branch).contains("the joint `wrist` is not in the chain"), "{}", mistakes(&branch));
    let circle = with(&[joint("shoulder", "wrist"), joint("elbow", "shoulder"), joint("wrist", "elbow")]);
    assert!(mistakes(&circle).contains("is not in the chain"));
    let nowhere = with(&[joint("shoulder", ""), joint("elbow", "sholder"), joint("wrist", "")]);
    assert!(mistakes(&nowhere).contains("did you mean \"shoulder\"?"));
}

#[test]
fn names_that_there_are_not_are_met_with_the_nearest() {
    let base = format!("{ALL}{CHAIN}[actuators.flexor]\ncoupling.arms.elbow = \"1 cm\"\n");
    plant(&base);
    for (text, expected) in [
        (base.replace("arms.elbow", "arms.elbwo"), ["there is no joint `elbwo`", "did you mean \"elbow\"?"]),
        (format!("{base}supply = \"suply\"\n"), ["there is no supply `suply`", "did you mean \"supply\"?"]),
        (
            format!("{base}coupling.mechanism = \"mechanisms\"\n"),
            ["there is no mechanism `mechanisms`", "did you mean \"mechanism\"?"],
        ),
        (
            base.replace(
                "coupling.arms.elbow = \"1 cm\"",
                "coupling.origin.along = \"1 cm\"\ncoupling.insertion = { along = \"1 cm\", segment = \"forarm\" }",
            )
            .replace("[coupling]\nrest_length = \"88 mm\"\n", ""),
            ["there is no segment `forarm`", "did you mean \"forearm\"?"],
        ),
        (
            format!("{base}[supplies.tank]\nfrom = \"suppl\"\nlag = \"1 s\"\n"),
            ["there is no supply `suppl`", "did you mean \"supply\"?"],
        ),
        (base.replace("[hose]", "[hoes]"), ["there is no section [hoes]", "did you mean `hose`?"]),
        (
            format!("{base}[actuators.flexor.valv]\nefficiency = 1.0\n"),
            ["there is no section [actuators.flexor.valv]", "did you mean `valve`?"],
        ),
        (
            format!("{base}[actuators.flexor.hose]\nlenght = \"1 m\"\n"),
            ["`lenght` is not a key of [actuators.flexor.hose]", "did you mean `length`?"],
        ),
        (
            base.replace("segment = \"forearm\"", "dampin = \"1 N*m*s/rad\""),
            ["`dampin` is not a key of [mechanism.joints.elbow]", "did you mean `damping`?"],
        ),
        (
            base.replace("[actuators.flexor]", "[actuators.\"2nd one\"]"),
            ["`2nd one` is no name", "begin with a letter"],
        ),
        (
            format!("{base}[actuators.elbow]\ncoupling.arms.elbow = \"1 cm\"\n"),
            ["two parts are called `elbow`", "first of that name"],
        ),
    ] {
        let error = mistakes(&text);
        for words in expected {
            assert!(error.contains(words), "{words}\n{error}");
        }
    }
}

/// A segment without a name is called as its joint, so that a name that is stated can meet one that is not, in either order.
#[test]
fn two_segments_of_one_name_are_refused_whichever_is_stated() {
    let chain = |first: &str, second: &str| {
        let numbers = "length = \"20 cm\"\nmass = \"1 kg\"\ndistance = \"5 cm\"\n";
        let joints = [("upper", first), ("lower", second)];
        let joints = joints.map(|(name, lines)| format!("[mechanism.joints.{name}]\n{numbers}{lines}"));
        let origin = "coupling.origin.along = \"17 cm\"\n";
        let insertion = "coupling.insertion = { segment = \"lower\", along = \"4 cm\", across = \"1 cm\" }\n";
        format!("{ALL}[mechanism]\nkind = \"chain\"\n{}[actuators.one]\n{origin}{insertion}", joints.concat())
    };
    plant(&chain("segment = \"arm\"\n", ""));
    plant(&chain("segment = \"arm\"\n", "segment = \"lower\"\n"));
    for (first, second) in [
        ("segment = \"lower\"\n", ""),
        ("", "segment = \"upper\"\n"),
        ("segment = \"lower\"\n", "segment = \"lower\"\n"),
        // `lower` stands second in the file and first in the chain.
        ("after = \"lower\"\nsegment = \"lower\"\n", ""),
    ] {
        let text = chain(first, second);
        let error = mistakes(&text);
        let name = if second.contains("upper") { "upper" } else { "lower" };
        assert!(error.contains(&format!("two segments are called `{name}`")), "{error}\n{text}");
        assert!(error.contains("first of that name") && error.contains("second of that name"), "{error}");
    }
}

#[test]
fn what_makes_no_sense_is_refused_with_its_reason() {
    let base = format!("{ALL}{CHAIN}[actuators.flexor]\ncoupling.arms.elbow = \"1 cm\"\n");
    for (text, expected) in [
        (base.replace("coupling.arms.elbow = \"1 cm\"", ""), "nothing says how `flexor` spans `mechanism`"),
        (base.replace("coupling.arms.elbow = \"1 cm\"", "coupling.arms.elbow = \"0 cm\""), "above zero, or below it"),
        (
            base.replace("angle = \"20 deg\"", "angle = \"20 deg\"\nmin_angle = \"60 deg\"\nmax_angle = \"40 deg\""),
            "must be less than `max_angle`, 40 deg",
        ),
        (format!("{base}initial.length = \"9 cm\"\n"), "the mechanism says how long the actuator is"),
        (format!("{base}air.gas_constant = \"300 J/(kg*K)\"\n"), "those of the whole plant"),
        (format!("{base}[load]\nkind = \"isometric\"\n"), "[load] and a mechanism both say"),
        (format!("{base}load.kind = \"isometric\"\n"), "has its own load and spans no mechanism"),
        (
            base.replace("[supply]\ngauge_pressure = \"5 bar\"\n", ""),
            "nothing says which supply feeds the valve of `flexor`",
        ),
        (
            format!("{base}[supplies.m]\nfrom = \"supply\"\nreservoir_volume = \"1 L\"\n"),
            "nothing leads air into the supply `m`",
        ),
        (format!("{base}[supplies.m]\nfrom = \"supply\"\n"), "neither reservoir nor regulator"),
        (format!("{base}[supplies.m]\nfrom = \"m\"\nlag = \"1 s\"\n"), "feeds itself"),
        (format!("{base}[supplies.m]\ngauge_pressure = \"1 bar\"\ninlet.flow_area = \"1 mm^2\"\n"), "nothing feeds it"),
        (
            base.replace("kind = \"chain\"", "kind = \"fixed\"\nposition = \"9 cm\""),
            "is not used when `mechanism.kind`",
        ),
        (base.replace("length = \"28 cm\"\n", ""), "`mechanism.joints.shoulder.length`"),
        (base.replace("[actuators.flexor]\ncoupling.arms.elbow = \"1 cm\"\n", ""), "no actuator is named"),
        (format!("{base}valve.output = \"b\"\n"), "for a five-way valve"),
        (
            format!("{base}[antagonist]\ninitial.gauge_pressure = \"1 bar\"\n"),
            "is not implemented in a file of several actuators",
        ),
        (
            base.replace(
                "flow_area = \"1.5 mm^2\"\nopening_delay = \"4 ms\"",
                "flow_area = \"1.5 mm^2\"\ntime_constant = \"30 ms\"\nrate_limit = \"9 bar/s\"",
            )
            .replace("three-way", "pressure-regulator")
            .replace(
                "kind = \"pwm\"\nfrequency = \"20 Hz\"\nduty = 0.4",
                "kind = \"set-points\"\ntime = [\"0 s\"]\ngauge_pressure = [\"1 bar\"]",
            )
            .replace("gauge_pressure = \"5 bar\"", "gauge_pressure = \"5 bar\"\nreservoir_volume = \"1 L\""),
            "is not implemented behind a reservoir or a regulator",
        ),
    ] {
        let error = mistakes(&text);
        assert!(error.contains(expected), "{expected}\n{error}\n{text}");
    }
    // One message refuses it, and none says that another load would do.
    let of_second = format!("{base}[antagonist]\ninitial.gauge_pressure = \"1 bar\"\n");
    assert_eq!(document(&of_second).plant_experiment().expect_err("refused").count(), 1);
}

/// A length that an isometric load lacks is missing at the actuator that lacks it, or once at all.
#[test]
fn an_isometric_load_of_a_plant_names_the_actuator_without_a_length() {
    let all = format!("{ALL}[load]\nkind = \"isometric\"\n[actuators.a]\n[actuators.b]\n");
    let found = document(&all).plant_experiment().expect_err("no length");
    assert_eq!(found.count(), 1, "{found}");
    assert!(found.to_string().contains("in [initial] for all actuators, or of each in its section"), "{found}");
    let one = format!("{all}initial.length = \"90 mm\"\n");
    let own = format!(
        "{ALL}[actuators.a]\nload.kind = \"isometric\"\n[actuators.b]\nload.kind = \"isometric\"\n\
                       initial.length = \"90 mm\"\n"
    );
    for text in [one, own] {
        let found = document(&text).plant_experiment().expect_err("no length");
        assert_eq!(found.count(), 1, "{found}");
        let shown = found.to_string();
        for words in [
            "`actuators.a.initial.length` (L(0)) is missing",
            "give `actuators.a.initial.length`, the distance between the attachments that the load holds",
            "`initial.length = \"3.5 in\"` in [actuators.a]",
        ] {
            assert!(shown.contains(words), "{words}\n{shown}");
        }
        assert!(!shown.contains("equilibrium"), "{shown}");
    }
}

/// What is stated for all holds for those that can use it, as if each of them stated it; what none of them can use is refused.
#[test]
fn a_value_of_all_holds_for_the_actuators_that_can_use_it() {
    let motion = "{ kind = \"prescribed-motion\", length = \"88 mm\", amplitude = \"2 mm\", frequency = \"1 Hz\" }";
    let load = "[load]\nkind = \"isometric\"\n";
    let lengths = |all: &str, own: &str| {
        let all = ALL.replace("[initial]\n", &format!("[initial]\n{all}"));
        format!("{all}{load}[actuators.a]\n{own}[actuators.b]\nload = {motion}\n")
    };
    let length = "length = \"90 mm\"\n";
    assert_eq!(plant(&lengths(length, "")), plant(&lengths("", "initial.length = \"90 mm\"\n")));
    let transfer = "heat_transfer = \"0.05 W/K\"\n";
    let air = |all: &str, own: &str| {
        let start = ALL.replace("[initial]\n", &format!("[initial]\n{length}"));
        format!(
            "{start}{load}[air]\nprocess = \"energy-balance\"\n{all}[actuators.a]\n{own}[actuators.b]\n\
             air.process = \"isentropic\"\n"
        )
    };
    let of_all = plant(&air(transfer, ""));
    assert_eq!(of_all.plant.actuators(), plant(&air("", &format!("air.{transfer}"))).plant.actuators());
    // Without an actuator that can use it the value is refused.
    let none = lengths(length, &format!("load = {motion}\n"));
    let found = document(&none).plant_experiment().expect_err("no actuator uses it");
    assert!(found.to_string().contains("`initial.length` is not used"), "{found}");
    // What an actuator needs and cannot use stays at fault, and is not reported as missing.
    let pair = format!(
        "{}{load}[actuators.a]\nvalve.kind = \"fill-hold-exhaust\"\nvalve.flow_area = \"1 mm^2\"\n[actuators.b]\n",
        ALL.replace("kind = \"pwm\"\nfrequency = \"20 Hz\"\nduty = 0.4", "kind = \"hold\"")
            .replace("[initial]\n", &format!("[initial]\n{length}"))
    );
    let found = mistakes(&pair);
    assert!(found.contains("cannot hold") && !found.contains("missing"), "{found}");
    // What an actuator states itself it must be able to use.
    let own = lengths(length, "").replace(&format!("load = {motion}\n"), &format!("load = {motion}\ninitial.{length}"));
    assert!(mistakes(&own).contains("`actuators.b.initial.length` is not used with a prescribed motion"));
}

/// A mistake in what all actuators share is reported once, where it stands.
#[test]
fn a_mistake_of_all_is_one_mistake() {
    let text = format!(
        "{ALL}{CHAIN}[actuators.a]\ncoupling.arms.elbow = \"1 cm\"\n[actuators.b]\ncoupling.arms.elbow = \"-1 cm\"\n"
    );
    let text = text.replace("opening_delay = \"4 ms\"", "opening_delay = \"4 mm\"");
    let found = document(&text).plant_experiment().expect_err("a mistake");
    assert_eq!(found.count(), 1, "{found}");
    let line = text.lines().position(|line| line.contains("4 mm")).expect("a line") + 1;
    assert_eq!(found.iter().next().and_then(|one| one.line()), Some(line));
}

/// What is said of all and is replaced by each has its word, unit and range all the same; each mistake is at its line, once.
#[test]
fn a_mistake_of_all_that_each_actuator_replaces_is_found() {
    let load = "[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n";
    let whole = format!("[actuator]\n[hose]\n[valve]\n[valve.exhaust]\n[command]\n[coupling]\n[initial]\n{load}");
    let own = "preset = \"colbrunn-2001\"\neffectiveness.constant = 0.9\nforce.law = \"ideal-braid\"\n\
               valve = { kind = \"three-way\", flow_area = \"1 mm^2\", exhaust.flow_area = \"1 mm^2\" }\n\
               command.kind = \"fill\"\nhose = { length = \"1 m\", diameter = \"2 mm\" }\ninitial.friction = \"relaxed\"\n";
    let of = |section: &str, line: &str| {
        let said = whole.replacen(&format!("[{section}]\n"), &format!("[{section}]\n{line}\n"), 1);
        format!("[supply]\ngauge_pressure = \"4 bar\"\n{said}[actuators.a]\n{own}[run]\nduration = \"0.1 s\"\n")
    };
    document(&of("valve", "kind = \"two-way\"")).plant_experiment().expect("valid values");
    for (section, line, words) in [
        ("actuator", "turns = -3", "`actuator.turns` = -3 is out of range"),
        ("actuator", "friction.viscous = \"banana\"", "banana"),
        ("actuator", "effectiveness.constant = -4", "`actuator.effectiveness.constant` = -4 is out of range"),
        (
            "actuator",
            "force = { law = \"tondu-lopez\", end_factor = -4 }",
            "`actuator.force.end_factor` = -4 is out of range",
        ),
        (
            "actuator",
            "force = { law = \"sarosi\", pressure_unit = \"m\" }",
            "`actuator.force.pressure_unit` is one of a pressure",
        ),
        ("valve", "flow_area = \"5 psi\"", "`valve.flow_area` is an area"),
        ("valve", "kind = \"banana\"", "\"banana\" is not a valid value of `valve.kind`"),
        ("valve.exhaust", "kv = 3", "`valve.exhaust.kv`"),
        ("command", "duty = 7", "`command.duty` = 7 is out of range"),
        ("command", "state = [\"fill\", \"banana\"]", "\"banana\" is not a valid value of `command.state`"),
        ("command", "time = [\"1 s\", \"2 m\"]", "`command.time` is a time"),
        ("hose", "length = \"5 psi\"", "`hose.length` is a length"),
        ("coupling", "insertion.along = \"banana\"", "banana"),
        ("coupling", "arms.elbow = \"5 psi\"", "`coupling.arms.elbow`"),
        ("coupling", "arms.elbow.angle = [\"5 psi\"]", "`coupling.arms.elbow.angle`"),
        ("coupling", "mechanism = 3", "`coupling.mechanism` is a name"),
        ("initial", "friction_force = \"5 m\"", "`initial.friction_force` is a force"),
    ] {
        let text = of(section, line);
        let found = document(&text).plant_experiment().expect_err(&text);
        assert!(found.count() == 1 && found.to_string().contains(words), "{section}.{line}\n{found}");
        let at = text.lines().position(|of| of == line).expect("a line") + 1;
        assert_eq!(found.iter().next().and_then(|one| one.line()), Some(at), "{line}");
    }
}

/// What a user sets in addition to a file is meant to change something. In the file itself the value may stand for parts to come.
#[test]
fn a_setting_that_reaches_no_part_is_refused() {
    let base = format!("{ALL}[load]\nkind = \"isometric\"\n[supplies.tank]\ngauge_pressure = \"6 bar\"\n");
    let base = base.replace("[supply]\ngauge_pressure = \"5 bar\"\n", "");
    let one = |own: &str| format!("{base}[actuators.one]\ninitial.length = \"90 mm\"\n{own}\n");
    let (drawn, own_delay) = (one("supply = \"tank\""), one("valve.opening_delay = \"3 ms\""));
    let own_supply =
        one("supply.gauge_pressure = \"4 bar\"").replace("[supplies.tank]\ngauge_pressure = \"6 bar\"\n", "");
    let set = |text: &str, path: &str, value: &str| {
        let mut document = document(text);
        document.set_plain_from("--set", path, value).expect("a path");
        document.plant_experiment()
    };
    for (text, path, value, words) in [
        (
            &drawn,
            "supply.gauge_pressure",
            "3 bar",
            "no valve draws from [supply]|give `gauge_pressure`|[supplies.tank]",
        ),
        (&own_supply, "supply.gauge_pressure", "3 bar", "no valve draws from [supply]|[actuators.one.supply]"),
        (&own_delay, "valve.opening_delay", "4 ms", "none of them takes it|[actuators.one.valve]"),
        (&drawn, "coupling.rest_length", "90 mm", "`coupling.rest_length` is set for all|[actuators.one.coupling]"),
    ] {
        let found = set(text, path, value).expect_err(path).to_string();
        assert!(words.split('|').all(|words| found.contains(words)), "{path}: {found}");
    }
    for (text, path, value) in [
        // A supply with a volume is simulated, whether or not anything draws from it.
        (
            &drawn.replace("[supplies.tank]", "[supply]\nreservoir_volume = \"1 L\"\n[supplies.tank]"),
            "supply.gauge_pressure",
            "3 bar",
        ),
        (&drawn, "supplies.tank.gauge_pressure", "3 bar"),
        (&drawn, "valve.opening_delay", "3 ms"),
        (&own_delay, "actuators.one.valve.opening_delay", "4 ms"),
    ] {
        set(text, path, value).unwrap_or_else(|found| panic!("{path}: {found}"));
    }
    // The first actuator draws from `[supply]`, which is there as soon as it is set.
    let undecided = one("");
    set(&undecided, "supply.gauge_pressure", "3 bar").expect("a supply that is drawn from");
    plant(&drawn.replace("[supplies.tank]", "[supply]\ngauge_pressure = \"3 bar\"\n[supplies.tank]"));
}

/// Keys of the section [actuator] stand in the section of an actuator without that name.
#[test]
fn a_section_actuator_of_one_actuator_has_its_remedy() {
    let text = format!(
        "{ALL}[load]\nkind = \"isometric\"\n[actuators.one]\ninitial.length = \"90 mm\"\nactuator.friction.viscous = \"5 N*s/m\"\n"
    );
    let found = mistakes(&text);
    assert!(found.contains("write `friction` for `actuator.friction`") && !found.contains("of [supply]"), "{found}");
    plant(&text.replace("actuator.friction.viscous = \"5", "friction.viscous = \"5"));
}

/// Moment arms are replaced as a whole. Those of all that each actuator replaces have joints that there are and arms that turn
/// them, and so have names of mechanisms and segments, as those of an actuator.
#[test]
fn arms_and_names_of_all_are_replaced_whole_and_checked() {
    let with = |all: &str| {
        let chain = CHAIN.replace("rest_length = \"88 mm\"\n", &format!("rest_length = \"88 mm\"\n{all}\n"));
        let own = "coupling.mechanism = \"mechanism\"\ncoupling.arms.elbow = \"-1 cm\"\n";
        format!("{ALL}{chain}[actuators.one]\n{own}[actuators.two]\n{own}")
    };
    let none = plant(&with(""));
    for all in [
        "arms = { shoulder = \"1 cm\", elbow = \"5 mm\" }",
        "arms.shoulder = { angle = [\"0 deg\", \"9 deg\"], arm = [\"1 cm\", \"2 cm\"] }",
        "mechanism = \"mechanism\"",
        "insertion.segment = \"forearm\"",
    ] {
        assert_eq!(plant(&with(all)), none, "{all}");
    }
    for (all, words) in [
        ("arms.elbwo = \"5 mm\"", "there is no joint `elbwo`"),
        ("arms.elbow = \"0 m\"", "a moment arm is above zero, or below it, at all angles"),
        ("arms.elbow = \"5 psi\"", "`coupling.arms.elbow` is a length"),
        (
            "arms.shoulder = { angle = [\"0 deg\", \"9 deg\"], arm = [\"1 cm\", \"-2 cm\"] }",
            "a moment arm is above zero, or below it, at all angles",
        ),
        ("arms.shoulder = { angle = [\"0 deg\"], arm = [\"1 cm\", \"2 cm\"] }", "`coupling.arms.shoulder.a"),
        ("mechanism = \"mechanisms\"", "there is no mechanism `mechanisms`"),
        ("origin.segment = \"forarm\"", "there is no segment `forarm`"),
        ("insertion.segment = 3", "`coupling.insertion.segment` is a name"),
    ] {
        let text = with(all);
        let found = document(&text).plant_experiment().expect_err(&text);
        assert!(found.count() == 1 && found.to_string().contains(words), "{all}\n{found}");
        let line = text.lines().position(|of| of == all).expect("a line") + 1;
        assert_eq!(found.iter().next().and_then(|one| one.line()), Some(line), "{all}");
    }
}

/// The hose and the pressure at its end are each said of all or of the actuator.
#[test]
fn a_pressure_at_the_end_of_a_hose_has_the_hose_of_all_or_of_its_actuator() {
    let hose = "hose]\nlength = \"1.5 m\"\ndiameter = \"2 mm\"\n";
    let pressure = "pressure]\nat = \"hose\"\ntime = [\"0 s\", \"1 s\"]\ngauge_pressure = [\"1 bar\", \"2 bar\"]\n";
    let rest = "[load]\nkind = \"isometric\"\n[initial]\nlength = \"9 cm\"\ngauge_pressure = \"1 bar\"\n\
                [run]\nduration = \"0.1 s\"\n";
    let names = |hose_of: &str, pressure_of: &str| {
        let text = format!("{rest}[actuators.m]\n[{hose_of}{hose}[{pressure_of}{pressure}");
        plant(&text).plant.network().nodes.len()
    };
    let nodes = names("actuators.m.", "actuators.m.");
    assert!(nodes >= 2, "a hose and a chamber");
    for (hose_of, pressure_of) in [("", ""), ("", "actuators.m."), ("actuators.m.", "")] {
        assert_eq!(names(hose_of, pressure_of), nodes, "{hose_of} {pressure_of}");
    }
    let without = format!("{rest}[actuators.m]\n[{pressure}");
    assert!(mistakes(&without).contains("there is no hose at whose end the pressure could be"));
}

#[test]
fn a_plant_is_no_scenario_of_one_actuator() {
    let text = format!("{ALL}{CHAIN}[actuators.a]\ncoupling.arms.elbow = \"1 cm\"\n");
    let error = document(&text).scenario().expect_err("a plant").to_string();
    assert!(error.contains("in which actuators have names") && error.contains("mckibben simulate"), "{error}");
    let single = "[load]\nkind = \"isometric\"\n[initial]\nlength = \"9 cm\"\n[run]\nduration = \"1 s\"\n";
    assert!(document(single).plant_experiment().expect("a file").is_none());
    // What only plants have is no key of a file of one.
    assert!(document(&format!("{single}[coupling]\nrest_length = \"1 cm\"\n")).scenario().is_err());
}

/// A controller of a joint, without the actuators that it drives.
const PAIR: &str = "[mechanism.joints.elbow.controller]\nkind = \"bang-bang\"\nangle = \"10 deg\"\nrate = \"100 Hz\"\ndead_band = \"1 deg\"\n";

/// Tension of the agonist turns the joint towards greater angles, that of the antagonist back: an actuator that cannot is refused.
#[test]
fn agonist_and_antagonist_turn_the_joint_their_ways() {
    let arms = |first: &str, second: &str, roles: [&str; 2]| {
        format!(
            "{ALL}{CHAIN}[actuators.flexor]\ncoupling.arms = {first}\n[actuators.extensor]\ncoupling.arms = {second}\n\
             [actuators.lifter]\ncoupling.arms.shoulder = \"1 cm\"\n{PAIR}agonist = \"{}\"\nantagonist = \"{}\"\n",
            roles[0], roles[1]
        )
    };
    let (ahead, back) = ("{ elbow = \"1 cm\" }", "{ shoulder = \"1 cm\", elbow = \"-1 cm\" }");
    let table = "{ elbow = { angle = [\"-1 rad\", \"2 rad\"], arm = [\"-1 cm\", \"-2 cm\"] } }";
    plant(&arms(ahead, back, ["flexor", "extensor"]));
    plant(&arms(ahead, table, ["flexor", "extensor"]));
    let key = "mechanism.joints.elbow.controller";
    for (text, count, words) in [
        (
            arms(ahead, back, ["extensor", "flexor"]),
            2,
            [format!("`{key}.agonist` = \"extensor\""), "swap agonist and antagonist".to_owned()],
        ),
        (
            arms(table, back, ["flexor", "extensor"]),
            1,
            [
                format!("`{key}.agonist` = \"flexor\""),
                "name an actuator whose arm about `elbow` is positive".to_owned(),
            ],
        ),
        (
            arms(ahead, ahead, ["flexor", "extensor"]),
            1,
            [format!("`{key}.antagonist` = \"extensor\""), "must turn `elbow` towards smaller angles".to_owned()],
        ),
        (
            arms(ahead, back, ["lifter", "extensor"]),
            1,
            [
                "`lifter` does not span the joint `elbow`".to_owned(),
                "give `lifter` a positive arm `actuators.lifter.coupling.arms.elbow`".to_owned(),
            ],
        ),
    ] {
        let found = document(&text).plant_experiment().expect_err(&text);
        assert_eq!(found.count(), count, "{found}");
        for word in words {
            assert!(found.to_string().contains(&word), "{word}\n{found}");
        }
    }
}

/// Between two points the way that an actuator turns a joint follows from its length: it pulls towards where it is shorter.
#[test]
fn roles_between_points_follow_the_length() {
    let of = |name: &str, across: &str| {
        format!(
            "[actuators.{name}.coupling]\norigin = {{ segment = \"upper-arm\", along = \"23 cm\", across = \"{across}\" }}\n\
             insertion = {{ segment = \"forearm\", along = \"3 cm\", across = \"{across}\" }}\n"
        )
    };
    let both = format!("{ALL}{CHAIN}{}{}", of("one", "3 cm"), of("other", "-3 cm"))
        .replace("[coupling]\nrest_length = \"88 mm\"\n", "");
    let built = plant(&both);
    let length = |angle: f64| {
        let mounted = &built.plant.actuators()[0];
        mounted.coupling.span(&built.plant.mechanisms()[0], &[0.0, angle])
    };
    let one_flexes = length(0.4) < length(0.3);
    let (agonist, antagonist) = if one_flexes { ("one", "other") } else { ("other", "one") };
    let controlled = |agonist: &str, antagonist: &str| {
        format!("{both}{PAIR}agonist = \"{agonist}\"\nantagonist = \"{antagonist}\"\n")
    };
    plant(&controlled(agonist, antagonist));
    assert!(mistakes(&controlled(antagonist, agonist)).contains("swap agonist and antagonist"));
}

#[test]
fn a_chain_has_at_most_eight_joints() {
    let chain = |count: usize| {
        let joints = (0..count).map(|index| {
            format!("[mechanism.joints.q{index}]\nlength = \"3 cm\"\nmass = \"50 g\"\ndistance = \"15 mm\"\n")
        });
        let joints: String = joints.collect();
        format!(
            "{ALL}[mechanism]\nkind = \"chain\"\n{joints}[actuators.a.coupling]\nrest_length = \"88 mm\"\n\
             arms.q0 = \"1 cm\"\n"
        )
    };
    plant(&chain(8));
    let found = mistakes(&chain(20));
    assert!(found.contains("has 20 joints; a chain has at most eight joints"), "{found}");
    assert!(found.contains("[mechanism.joints.q8]") && !found.contains("for each segment"), "{found}");
}

/// What two values contradict is shown of each actuator and each supply, and once where several share it.
#[test]
fn contradictions_of_all_parts_are_shown_at_once() {
    let tank = "[supplies.tank]\ngauge_pressure = \"7 bar\"\nreservoir_volume = \"2 L\"\ncut_in_gauge_pressure = \"8 bar\"\n\
                compressor_displacement = \"40 L/min\"\ncut_out_gauge_pressure = \"7 bar\"\n";
    let all = "[load]\nkind = \"hanging-mass\"\nmass = \"2 kg\"\n[initial]\ngauge_pressure = \"2 bar\"\n\
               [run]\nduration = \"50 ms\"\n";
    let muscle = "preset = \"colbrunn-2001\"\n";
    let text = format!(
        "{tank}{all}[actuators.a]\n{muscle}taper = {{ end_radius = \"4 mm\", length_ratio = 1.0 }}\n\
         [actuators.b]\n{muscle}max_length = \"200 mm\"\n[actuators.c]\n{muscle}initial.length = \"150 mm\"\n\
         [actuators.sound]\n{muscle}"
    );
    let found = document(&text).plant_experiment().expect_err("four mistakes");
    assert_eq!(found.count(), 4, "{found}");
    let shown = found.to_string();
    for part in ["the supply `tank`", "the actuator `a`", "the actuator `b`", "the actuator `c`"] {
        assert!(shown.contains(&format!("this is of {part}")), "{part}\n{shown}");
    }
    let shared =
        format!("{all}[actuator]\n{muscle}max_length = \"200 mm\"\n[actuators.a]\n[actuators.b]\n[actuators.c]\n");
    let found = document(&shared).plant_experiment().expect_err("one mistake");
    assert_eq!(found.count(), 1, "{found}");
    assert!(found.to_string().contains("this is of the actuator `a`, and of 2 more"), "{found}");
}

/// A start that one of several actuators cannot have names that one.
#[test]
fn a_start_that_is_refused_names_its_actuator() {
    let text = format!(
        "{ALL}{CHAIN}[actuators.sound]\ncoupling.arms.elbow = \"1 cm\"\n[actuators.long]\ncoupling.arms.elbow = \"-1 cm\"\n\
         coupling.rest_length = \"120 mm\"\n"
    );
    // Its 120 mm and the 1 cm · 20° that the arm adds are beyond the thread's 110 mm.
    let error = mistakes(&text);
    let words = "an actuator starts 123.491 mm long, and this must be less than actuator.thread_length";
    assert!(error.contains(words) && error.contains("this is of the actuator `long`"), "{error}");
}

/// Files in which the keys of plants apply.
fn files() -> [(&'static str, String); 7] {
    let arms = format!("{ALL}{CHAIN}[actuators.flexor]\ncoupling.arms.elbow = \"1 cm\"\n");
    let table = arms.replace(
        "arms.elbow = \"1 cm\"",
        "arms.elbow = { angle = [\"-1 rad\", \"2 rad\"], arm = [\"1 cm\", \"2 cm\"] }",
    );
    let points = format!("{ALL}{CHAIN}[actuators.flexor.coupling]\norigin.along = \"-3 cm\"\ninsertion.along = \"5 cm\"\ninsertion.segment = \"upper-arm\"\n")
        .replace("[coupling]\nrest_length = \"88 mm\"\n", "");
    let belt = format!(
        "{arms}[mechanism.belt]\ndepth = \"50 cm\"\nvelocity = \"1 m/s\"\nstiffness = \"1 N/mm\"\ndamping = \"1 N*s/m\"\nfriction = 0.5\nslipping_speed = \"1 cm/s\"\n"
    );
    let mass = format!(
        "{ALL}[mechanism]\nkind = \"mass\"\nmass = \"2 kg\"\nposition = \"9 cm\"\nspring_stiffness = \"1 N/mm\"\nspring_rest_length = \"1 cm\"\n[actuators.flexor]\n[actuators.twin]\n"
    );
    let motion = format!(
        "{ALL}[mechanism]\nkind = \"prescribed\"\nlength = \"9 cm\"\namplitude = \"5 mm\"\nfrequency = \"1 Hz\"\n[actuators.flexor]\n"
    );
    let pair = format!(
        "{arms}[actuators.twin]\ncoupling.arms.elbow = \"-1 cm\"\n{PAIR}agonist = \"flexor\"\nantagonist = \"twin\"\n\
         [sweep]\nreductions = [\"elbow.angle.max\", \"elbow.angle_error.rms\"]\n\
         [sweep.vary]\n\"actuators.twin.turns\" = [2.3, 2.4]\n"
    );
    [
        ("pair", pair),
        ("arms", arms),
        ("table", table),
        ("points", points),
        ("belt", belt),
        ("mass", mass),
        ("motion", motion),
    ]
}

/// Each key has an effect on the plant or its start, in a file in which it applies.
#[test]
fn every_key_of_a_plant_has_an_effect() {
    let files = files();
    let file = |name: &str| &files.iter().find(|(its, _)| *its == name).expect(name).1;
    let tree =
        |more: &str| format!("{}[supplies.m]\nfrom = \"supply\"\nreservoir_volume = \"1 L\"\n{more}", file("arms"));
    let area = "inlet.flow_area = \"9 mm^2\"\n";
    let iso = "inlet.sonic_conductance = \"30 L/(min*bar) ANR\"\ninlet.critical_ratio = 0.4\n";
    let five_way = |output: &str| {
        file("arms")
            .replace("three-way", "five-way")
            .replace("[actuators.flexor]", &format!("[actuators.flexor]\nvalve.output = \"{output}\""))
    };
    let two = |name: &str| {
        file("arms").replace("[mechanism]", "[mechanisms.left]").replace("[mechanism.", "[mechanisms.left.").replace(
            "[actuators.flexor]",
            &format!("[mechanisms.right]\nkind = \"fixed\"\nposition = \"{name}\"\n[actuators.flexor]\ncoupling.mechanism = \"left\""),
        )
    };
    let ordered = |elbow: &str, wrist: &str| {
        let elbow = format!("segment = \"forearm\"\nlength = \"20 cm\"\n{elbow}");
        let wrist =
            format!("[mechanism.joints.wrist]\nlength = \"3 cm\"\nmass = \"1 kg\"\ndistance = \"1 cm\"\n{wrist}");
        document(&format!("{}{wrist}", file("arms").replace("segment = \"forearm\"\n", &elbow)))
    };
    let set = |file: &str, path: &str, value: &str| {
        let mut document = document(file);
        document.set_text(path, value).expect("a path");
        document
    };
    let mut tried = Vec::new();
    let mut differs = |key: &'static str, first: Document, second: Document| {
        let [first, second] = [first, second].map(|document| match document.plant_experiment() {
            Ok(Some(plant)) => plant,
            other => panic!("{key}: {other:?}"),
        });
        assert!(first != second, "{key} has no effect");
        tried.push(key);
    };
    let of_actuator = |path: &str| format!("actuators.flexor.{path}");
    let joint = |path: &str| format!("mechanism.joints.elbow.{path}");
    differs(
        "actuators.*.supply",
        document(
            &format!(
                "{}supply = \"m\"\n",
                tree(area).replace("[supplies.m]", "[supplies.n]\ngauge_pressure = \"1 bar\"\n[supplies.m]").replace(
                    "[actuators.flexor]",
                    "[actuators.other]\ncoupling.arms.elbow = \"1 cm\"\n[actuators.flexor]\nsupply = \"n\""
                )
            )
            .replace("supply = \"m\"\n", ""),
        ),
        document(
            &tree(area).replace("[supplies.m]", "[supplies.n]\ngauge_pressure = \"1 bar\"\n[supplies.m]").replace(
                "[actuators.flexor]",
                "[actuators.other]\ncoupling.arms.elbow = \"1 cm\"\n[actuators.flexor]\nsupply = \"m\"",
            ),
        ),
    );
    differs("valve.output", document(&five_way("a")), document(&five_way("b")));
    differs(
        "coupling.mechanism",
        document(&two("9 cm")),
        document(
            &two("9 cm")
                .replace(
                    "coupling.mechanism = \"left\"\ncoupling.arms.elbow = \"1 cm\"",
                    "coupling.mechanism = \"right\"",
                )
                .replace("[coupling]\nrest_length = \"88 mm\"\n", ""),
        ),
    );
    differs(
        "coupling.rest_length",
        document(file("arms")),
        set(file("arms"), &of_actuator("coupling.rest_length"), "\"80 mm\""),
    );
    differs(
        "coupling.arms.*",
        document(file("arms")),
        set(file("arms"), &of_actuator("coupling.arms.elbow"), "\"-1 cm\""),
    );
    differs(
        "coupling.arms.*.angle",
        document(file("table")),
        set(file("table"), &of_actuator("coupling.arms.elbow.angle"), "[\"-1 rad\", \"1 rad\"]"),
    );
    differs(
        "coupling.arms.*.arm",
        document(file("table")),
        set(file("table"), &of_actuator("coupling.arms.elbow.arm"), "[\"-1 cm\", \"-2 cm\"]"),
    );
    for (key, value) in [
        ("coupling.origin.segment", "\"forearm\""),
        ("coupling.origin.along", "\"-2 cm\""),
        ("coupling.origin.across", "\"1 cm\""),
        ("coupling.insertion.segment", "\"forearm\""),
        ("coupling.insertion.along", "\"4 cm\""),
        ("coupling.insertion.across", "\"1 cm\""),
    ] {
        let mut points = file("points").clone();
        // The muscle is no longer than it may be on either segment.
        if key.ends_with("segment") {
            points = points.replace("28 cm", "10 cm");
        }
        if key == "coupling.insertion.segment" {
            points = points.replace("insertion.along = \"5 cm\"", "insertion.along = \"-12 cm\"");
        }
        differs(key, document(&points), set(&points, &of_actuator(key), value));
    }
    differs(
        "supplies.*.from",
        document(&tree(area).replace("[supplies.m]", "[supplies.n]\ngauge_pressure = \"5 bar\"\n[supplies.m]")),
        document(&tree(area).replace(
            "[supplies.m]\nfrom = \"supply\"",
            "[supplies.n]\ngauge_pressure = \"5 bar\"\n[supplies.m]\nfrom = \"n\"",
        )),
    );
    for (key, base, value) in [
        ("supplies.*.inlet.kind", area, "\"check-valve\""),
        ("supplies.*.inlet.flow_area", area, "\"8 mm^2\""),
        ("supplies.*.inlet.sonic_conductance", iso, "\"20 L/(min*bar) ANR\""),
        ("supplies.*.inlet.critical_ratio", iso, "0.3"),
        ("supplies.*.inlet.kv", "inlet.kv = \"0.05 m^3/h\"\n", "\"0.06 m^3/h\""),
        ("supplies.*.inlet.cv", "inlet.cv = 0.06\n", "0.07"),
        ("supplies.*.inlet.pressure_drop_ratio", "inlet.cv = 0.06\n", "0.6"),
        ("supplies.*.inlet.efficiency", area, "0.8"),
        ("supplies.*.inlet.laminar_ratio", area, "0.99"),
    ] {
        differs(key, document(&tree(base)), set(&tree(base), &key.replace('*', "m"), value));
    }
    differs(
        "mechanism.kind",
        document(file("mass")),
        document(
            &file("mass")
                .replace("kind = \"mass\"\nmass = \"2 kg\"", "kind = \"fixed\"")
                .replace("spring_stiffness = \"1 N/mm\"\nspring_rest_length = \"1 cm\"\n", ""),
        ),
    );
    for (key, base, value) in [
        ("mechanism.mass", "mass", "\"3 kg\""),
        ("mechanism.gravity", "arms", "\"1 m/s^2\""),
        ("mechanism.force", "mass", "\"3 N\""),
        ("mechanism.spring_stiffness", "mass", "\"2 N/mm\""),
        ("mechanism.spring_rest_length", "mass", "\"2 cm\""),
        ("mechanism.position", "mass", "\"8 cm\""),
        ("mechanism.velocity", "mass", "\"1 cm/s\""),
        ("mechanism.length", "motion", "\"8 cm\""),
        ("mechanism.amplitude", "motion", "\"4 mm\""),
        ("mechanism.frequency", "motion", "\"2 Hz\""),
        ("mechanism.phase", "motion", "\"20 deg\""),
        ("mechanism.hanging_angle", "arms", "\"90 deg\""),
    ] {
        differs(key, document(file(base)), set(file(base), key, value));
    }
    let points = |time: &str, length: &str| {
        let wave = "length = \"9 cm\"\namplitude = \"5 mm\"\nfrequency = \"1 Hz\"";
        document(
            &file("motion")
                .replace(wave, &format!("time = [\"0 s\", \"{time}\"]\ntable_length = [\"9 cm\", \"{length}\"]")),
        )
    };
    differs("mechanism.time", points("1 s", "8 cm"), points("2 s", "8 cm"));
    differs("mechanism.table_length", points("1 s", "8 cm"), points("1 s", "7 cm"));
    let swapped = ordered("after = \"wrist\"\n", "after = \"shoulder\"\n");
    differs("mechanism.joints.*.after", ordered("", ""), swapped);
    for (path, value) in [
        ("length", "\"20 cm\""),
        ("mass", "\"1 kg\""),
        ("distance", "\"11 cm\""),
        ("inertia", "\"1e-3 kg*m^2\""),
        ("torque", "\"1 N*m\""),
        ("damping", "\"1 N*m*s/rad\""),
        ("min_angle", "\"-1 rad\""),
        ("max_angle", "\"1 rad\""),
        ("stop_stiffness", "\"50 N*m/rad\""),
        ("stop_damping", "\"2 N*m*s/rad\""),
        ("angle", "\"10 deg\""),
        ("angular_velocity", "\"1 rad/s\""),
    ] {
        let key = PLANT_KEYS.iter().find(|key| key.path == format!("mechanism.joints.*.{path}")).expect(path).path;
        differs(key, document(file("arms")), set(file("arms"), &joint(path), value));
    }
    for (path, value) in [
        ("depth", "\"40 cm\""),
        ("velocity", "\"2 m/s\""),
        ("stiffness", "\"2 N/mm\""),
        ("damping", "\"2 N*s/m\""),
        ("friction", "0.6"),
        ("slipping_speed", "\"2 cm/s\""),
    ] {
        let key = PLANT_KEYS.iter().find(|key| key.path == format!("mechanism.belt.{path}")).expect(path).path;
        differs(key, document(file("belt")), set(file("belt"), key, value));
    }
    // What remembers starts somewhere.
    let remembers = file("arms").replace(
        "coulomb_width = \"0.1 mm\"",
        "coulomb_width = \"0 m\"\nhysteresis = { law = \"maxwell-slip\", reach = [\"0.2 mm\"], stiffness_ratio = [1.0] }",
    );
    for (key, [first, second]) in [
        ("initial.friction", ["\"loading\"", "\"unloading\""]),
        ("initial.friction_force", ["\"0.05 N\"", "\"0.1 N\""]),
    ] {
        differs(key, set(&remembers, key, first), set(&remembers, key, second));
    }
    let controlled = |agonist: &str, antagonist: &str| {
        document(&format!(
            "{}{}{PAIR}agonist = \"{agonist}\"\nantagonist = \"{antagonist}\"\n",
            file("arms"),
            "[actuators.twin]\ncoupling.arms.elbow = \"-1 cm\"\n[actuators.third]\ncoupling.arms.elbow = \"-1 cm\"\n\
             [actuators.fourth]\ncoupling.arms.elbow = \"1 cm\"\n",
        ))
    };
    differs("mechanism.joints.*.controller.agonist", controlled("flexor", "third"), controlled("fourth", "third"));
    differs("mechanism.joints.*.controller.antagonist", controlled("flexor", "third"), controlled("flexor", "twin"));
    // The name of a segment is what attachments go by.
    let renamed = file("points").replace("insertion.segment = \"upper-arm\"", "insertion.segment = \"other\"");
    assert!(mistakes(&renamed).contains("there is no segment `other`"));
    plant(&renamed.replace("segment = \"upper-arm\"", "segment = \"other\""));
    tried.push("mechanism.joints.*.segment");
    for key in PLANT_KEYS {
        assert!(tried.contains(&key.path), "{} is not tried", key.path);
    }
}

/// Each example is accepted in a file where it applies, by the reading and by the schema.
#[test]
fn the_schema_accepts_what_the_reading_accepts() {
    let mut schemas = boon::Schemas::new();
    let mut compiler = boon::Compiler::new();
    compiler.add_resource("http://localhost/scenario.json", schema()).expect("a JSON document");
    let index = compiler.compile("http://localhost/scenario.json", &mut schemas).expect("a schema");
    let accepts = |text: &str| {
        let file: toml::Table = text.parse().expect("TOML");
        let file = serde_json::to_value(file).expect("JSON");
        schemas.validate(&file, index).map_err(|error| format!("{error:#}"))
    };
    for (name, text) in files() {
        plant(&text);
        assert_eq!(accepts(&text), Ok(()), "{name}");
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/plant");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let text = std::fs::read_to_string(entry.expect("an entry").path()).expect("a file");
        plant(&text);
        assert_eq!(accepts(&text), Ok(()));
        seen += 1;
    }
    assert!(seen >= 4);
    let text = &files()[1].1;
    assert!(accepts(&text.replace("elbow]", "elbow]\nanlge = \"1 deg\"")).is_err());
    assert!(accepts(&text.replace("[actuators.flexor]", "[actuators.\"a b\"]")).is_err());
    assert!(accepts(&text.replace("[actuators.flexor]", "[actuator.flexor]")).is_err());
}

/// A remedy names the key of the part whose mistake it is, as a file would state it.
#[test]
fn remedies_name_the_keys_of_their_part() {
    let rest = "[load]\nkind = \"isometric\"\n[initial]\nlength = \"9 cm\"\n[run]\nduration = \"0.1 s\"\n";
    let valve = "[valve]\nkind = \"two-way\"\nflow_area = \"1 mm^2\"\n[command]\nkind = \"fill\"\n";
    let supply = "[supplies.tank]\ngauge_pressure = \"5 bar\"\nreservoir_volume = \"1 L\"\n";
    let hose = "[actuators.a.hose]\nlength = \"1 m\"\ndiameter = \"2 mm\"\ncells = 3\n";
    let found = mistakes(&format!("{rest}{valve}{supply}{hose}"));
    assert!(found.contains("set `actuators.a.hose.kind` to `distributed`"), "{found}");
    let compressor = "compressor_displacement = \"30 L/min\"\ncut_in_gauge_pressure = \"7 bar\"\n\
                      cut_out_gauge_pressure = \"6 bar\"\n";
    let found = mistakes(&format!("{rest}{valve}{supply}{compressor}[actuators.a]\n"));
    let rule = "`supplies.tank.cut_in_gauge_pressure` = 7 bar contradicts the rule that it must be less than \
                supplies.tank.cut_out_gauge_pressure = 6 bar";
    assert!(found.contains(rule) && !found.contains("supply.cut"), "{found}");
}
