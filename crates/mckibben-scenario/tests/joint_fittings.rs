//! A joint's file with hoses, a leak, one supply of both, tendons or given pressures is the plant file that says the same with
//! a chain of one joint: the same motion to the tolerance of the integrator, and the same columns of a sweep.

use mckibben::plant::{JointPlant, PlantSample, simulate_plant};
use mckibben::simulation::JointSample;
use mckibben_scenario::{Document, JointExperiment, PlantExperiment, Scenario};

const BODY: &str = "[actuator]\npreset = \"colbrunn-2001\"\n";
const VALVE: &str =
    "[supply]\ngauge_pressure = \"60 psi\"\n[valve]\npreset = \"matrix-eight-channel\"\nkind = \"fill-hold-exhaust\"\n";
const AGONIST: &str =
    "kind = \"table\"\ntime = [\"0 s\", \"60 ms\", \"0.3 s\"]\nstate = [\"fill\", \"hold\", \"exhaust\"]\n";
const ANTAGONIST: &str =
    "kind = \"table\"\ntime = [\"0 s\", \"0.3 s\", \"0.35 s\"]\nstate = [\"hold\", \"fill\", \"hold\"]\n";
const LIMB: &str = "mass = \"0.5 kg\"\ndistance = \"100 mm\"\ninertia = \"1e-3 kg*m^2\"\ndamping = \"0.02 N*m*s/rad\"\n\
                    min_angle = \"-40 deg\"\nmax_angle = \"40 deg\"\n";
const RUN: &str = "[run]\nduration = \"0.6 s\"\nrelative_tolerance = 1e-10\n";
const HOSE: &str = "length = \"1 m\"\ndiameter = \"2.5 mm\"\n";
const TANK: &str = "reservoir_volume = \"0.5 L\"\nreservoir_gauge_pressure = \"70 psi\"\n";

/// What a joint has: for all, and for agonist and antagonist alone, as the body of a section for each.
struct Case {
    name: &'static str,
    /// Sections of both files.
    both: String,
    /// Sections of agonist and antagonist: name and body. Of a joint's file the agonist's stand at the top.
    own: [Vec<(&'static str, String)>; 2],
    rest_length: &'static str,
    /// Whether the pressures at the start are given at the top.
    starts: bool,
}

fn driven(name: &'static str, change: impl FnOnce(&mut Case)) -> Case {
    let mut case = Case {
        name,
        both: format!("{BODY}{VALVE}"),
        own: [vec![("command", AGONIST.to_owned())], vec![("command", ANTAGONIST.to_owned())]],
        rest_length: "3.3 in",
        starts: true,
    };
    change(&mut case);
    case
}

fn cases() -> Vec<Case> {
    let series = |gauges: &str| format!("time = [\"0 s\", \"0.1 s\", \"0.3 s\"]\ngauge_pressure = {gauges}\n");
    vec![
        driven("valves alone", |_| {}),
        driven("a hose of both", |case| case.both += &format!("[hose]\n{HOSE}")),
        driven("two hoses", |case| {
            case.own[0].push(("hose", HOSE.to_owned()));
            case.own[1].push(("hose", HOSE.replace("1 m", "2 m")));
        }),
        driven("waves in hoses", |case| {
            case.both += &format!("[hose]\nkind = \"distributed\"\ncells = 3\n{HOSE}");
        }),
        driven("a leak", |case| case.both = case.both.replace("[supply]", "leakage = \"2e-11 m^3/(s*Pa)\"\n[supply]")),
        driven("a tank", |case| case.both = case.both.replace("[valve]", &format!("{TANK}[valve]"))),
        driven("a regulator", |case| {
            case.both = case
                .both
                .replace("[valve]", "lag = \"20 ms\"\ndroop = \"2e7 Pa*s/kg\"\ndead_band = \"2 kPa\"\n[valve]");
        }),
        driven("tank, compressor, regulator and hoses", |case| {
            let all = format!(
                "{TANK}compressor_displacement = \"100 L/min\"\ncut_in_gauge_pressure = \"65 psi\"\n\
                 cut_out_gauge_pressure = \"75 psi\"\nlag = \"20 ms\"\ndroop = \"2e7 Pa*s/kg\"\n[valve]"
            );
            case.both = format!("{}[hose]\n{HOSE}", case.both.replace("[valve]", &all));
        }),
        driven("tendons", |case| {
            case.both += "[tendon]\nstiffness = \"20 kN/m\"\nrest_length = \"30 mm\"\n";
            case.rest_length = "113.82 mm";
        }),
        driven("unlike tendons and hoses", |case| {
            case.both += &format!("[hose]\n{HOSE}");
            case.own[0].push(("tendon", "stiffness = \"20 kN/m\"\nrest_length = \"30 mm\"\n".to_owned()));
            case.own[1].push(("tendon", "stiffness = \"8 kN/m\"\nrest_length = \"30 mm\"\n".to_owned()));
            case.rest_length = "113.82 mm";
        }),
        driven("given pressures", |case| {
            case.both = BODY.to_owned();
            case.own = ["[\"1 bar\", \"3 bar\", \"2 bar\"]", "[\"1.5 bar\", \"1.5 bar\", \"3 bar\"]"]
                .map(|gauges| vec![("pressure", series(gauges))]);
            case.starts = false;
        }),
        driven("a given pressure against a valve", |case| {
            case.own[1] = vec![("pressure", series("[\"1.5 bar\", \"1.5 bar\", \"3 bar\"]"))];
        }),
    ]
}

fn sections(prefix: &str, own: &[(&str, String)]) -> String {
    own.iter().map(|(name, body)| format!("[{prefix}{name}]\n{body}")).collect()
}

impl Case {
    fn joint_file(&self) -> String {
        let Self { both, own: [its, others], rest_length, starts, .. } = self;
        let gauge = if *starts { "gauge_pressure = \"20 psi\"\n" } else { "" };
        let (its, others) = (sections("", its), sections("antagonist.", others));
        format!(
            "{both}{its}[load]\nkind = \"antagonistic-joint\"\npulley_radius = \"15 mm\"\nrest_length = \"{rest_length}\"\n\
             {LIMB}[initial]\n{gauge}angle = \"5 deg\"\n{others}{RUN}"
        )
    }

    fn plant_file(&self) -> String {
        let Self { both, own: [its, others], rest_length, starts, .. } = self;
        let gauge = if *starts { "[initial]\ngauge_pressure = \"20 psi\"\n" } else { "" };
        let (its, others) = (sections("actuators.agonist.", its), sections("actuators.antagonist.", others));
        format!(
            "{both}{gauge}[mechanism]\nkind = \"chain\"\n[mechanism.joints.elbow]\nangle = \"5 deg\"\n{LIMB}[coupling]\n\
             rest_length = \"{rest_length}\"\n[actuators.agonist]\ncoupling.arms.elbow = \"15 mm\"\n{its}\
             [actuators.antagonist]\ncoupling.arms.elbow = \"-15 mm\"\n{others}{RUN}"
        )
    }
}

fn parse(text: &str) -> Document {
    Document::parse(text, "file.toml").unwrap_or_else(|error| panic!("{text}\n{error}"))
}

/// Angle, and length, pressure, mass of air, tension and pressure at the valve's end of the hose of both.
fn of_joint(sample: &JointSample) -> [f64; 11] {
    let of = |i: usize| {
        let of = &sample.actuators[i];
        [of.length, of.pressure.0, of.air_mass, of.tension, of.hose_pressure.0]
    };
    let ([a, b, c, d, e], [f, g, h, i, j]) = (of(0), of(1));
    [sample.angle, a, b, c, d, e, f, g, h, i, j]
}

fn of_plant(of: &PlantExperiment, sample: &PlantSample) -> [f64; 11] {
    let one = |i: usize| {
        let its = &sample.actuators[i];
        let tendon = of.plant.actuators()[i].tendon.is_some();
        let hose = of.names.hoses[i].map_or(its.pressure.0, |node| sample.nodes[node].pressure.0);
        [if tendon { its.length } else { its.distance }, its.pressure.0, its.air_mass, its.tension, hose]
    };
    let ([a, b, c, d, e], [f, g, h, i, j]) = (one(0), one(1));
    [sample.mechanisms[0].position[0], a, b, c, d, e, f, g, h, i, j]
}

#[test]
fn a_joint_is_the_plant_file_that_says_the_same() {
    for case in cases() {
        let name = case.name;
        let joint = parse(&case.joint_file()).joint_experiment().unwrap_or_else(|error| panic!("{name}\n{error}"));
        let joint = joint.expect("a joint");
        let plant = parse(&case.plant_file()).plant_experiment().unwrap_or_else(|error| panic!("{name}\n{error}"));
        let plant = plant.expect("a plant");
        let run = &joint.run;
        let own = JointPlant::new(&joint.rig).and_then(|of| of.simulate(&joint.start, run.duration, 1e-10));
        let own = own.unwrap_or_else(|error| panic!("{name}: {error}"));
        let other = simulate_plant(&plant.plant, &plant.start, run.duration, 1e-10).expect(name);
        let times: Vec<f64> = (0..=300).map(|step| f64::from(step) * run.duration / 300.0).collect();
        let [ours, theirs] = [
            times.iter().map(|time| of_joint(&own.at(*time))).collect::<Vec<_>>(),
            times.iter().map(|time| of_plant(&plant, &other.sample(*time))).collect(),
        ];
        for quantity in 0..11 {
            let range = theirs.iter().fold(0.0_f64, |most, row| most.max(row[quantity].abs()));
            let worst = ours
                .iter()
                .zip(&theirs)
                .fold(0.0_f64, |worst, (a, b)| worst.max((a[quantity] - b[quantity]).abs() / range));
            assert!(worst < 1e-6, "{name}: quantity {quantity} differs by {worst:e} of {range:e}");
        }
        let moved = ours.iter().fold(0.0_f64, |most, row| most.max((row[0] - ours[0][0]).abs()));
        assert!(moved > 0.01, "{name}: the joint turns by {moved} rad only");
    }
}

#[test]
fn what_is_written_reads_back_to_the_same_joint() {
    for case in cases() {
        let scenario = parse(&case.joint_file()).scenario().unwrap_or_else(|error| panic!("{}\n{error}", case.name));
        let text = scenario.to_toml();
        let again = parse(&text).scenario().unwrap_or_else(|error| panic!("{}\n{text}\n{error}", case.name));
        assert_eq!(again, scenario, "{}", case.name);
    }
}

/// The joint on a tank, with more of the antagonist.
fn on_tank(more: &str) -> Scenario {
    let case = driven("", |case| case.both = case.both.replace("[valve]", &format!("{TANK}[valve]")));
    let text = case.joint_file();
    parse(&format!("{text}{more}")).scenario().unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn both_draw_from_one_tank_unless_the_antagonist_has_a_separate_one() {
    let rig = |scenario: &Scenario| scenario.joint_experiment().expect("it runs").expect("a joint").rig;
    let [one, two] = [on_tank(""), on_tank("[antagonist.supply]\nreservoir_volume = \"0.5 L\"\n")];
    assert!(rig(&one).shared_supply().is_some() && rig(&two).shared_supply().is_none());
    // Two tanks alike are two, also when they are written and read.
    let again = parse(&two.to_toml()).scenario().expect("it reads");
    assert_eq!(again, two);
    assert!(rig(&again).fittings().iter().all(|of| of.line.supply.is_some()));
    let tanks = |scenario: &Scenario| {
        let network = JointPlant::new(&rig(scenario)).expect("a plant").plant().network().clone();
        let is_tank = |kind: &mckibben::network::NodeKind| matches!(kind, mckibben::network::NodeKind::Reservoir(_));
        network.nodes.iter().filter(|node| is_tank(&node.kind)).count()
    };
    assert_eq!((tanks(&one), tanks(&two)), (1, 2));
}

/// Whatever an actuator of a joint has in addition to its valve goes through time at fixed steps too, near the other
/// engine.
#[test]
fn all_of_them_run_at_fixed_steps() {
    for case in cases().iter().skip(1) {
        let of = |run: &str| {
            let text = case.joint_file().replace("[run]\n", &format!("[run]\n{run}"));
            parse(&text).joint_experiment().expect("a joint").expect("an experiment")
        };
        let (located, stepped) = (of(""), of("engine = \"fixed-step\"\nstep = \"50 us\"\n"));
        let end = |of: &JointExperiment| {
            let (how, _) = of.stepping().expect("a way");
            let run = JointPlant::new(&of.rig).expect("a plant").simulate(&of.start, 0.1, how).expect("a run");
            run.at(0.1)
        };
        let (exact, found) = (end(&located), end(&stepped));
        let off = [found.angle - exact.angle, found.actuators[0].tension / exact.actuators[0].tension - 1.0];
        assert!(off.iter().all(|off| off.abs() < 2e-3), "{off:?}");
    }
}

#[test]
fn models_are_refused() {
    let error_of = |text: &str| parse(text).joint_experiment().expect_err("a mistake").to_string();
    // The laws by the model have no tendon; one that tracks the angle needs none.
    let tendons = cases().into_iter().find(|case| case.name == "tendons").expect("a case");
    let controlled = |law: &str| {
        let file =
            tendons.joint_file().replace(&format!("[command]\n{AGONIST}"), "[command]\nkind = \"controllers\"\n");
        let file = file.replace(&format!("[antagonist.command]\n{ANTAGONIST}"), "[antagonist]\n");
        let controller = format!("[controller]\n{law}angle = \"5 deg\"\nrate = \"200 Hz\"\n");
        parse(&format!("{file}{controller}")).controlled_joint_experiment()
    };
    let model = "kind = \"feed-forward\"\nstiffness = \"1 N*m/rad\"\nhighest_gauge_pressure = \"4 bar\"\ndead_band = \"0.1 bar\"\n";
    let message = controlled(model).expect_err("a mistake").to_string();
    assert!(message.contains("a controller by the model is not implemented"), "{message}");
    let tracks = controlled("kind = \"bang-bang\"\ndead_band = \"1 deg\"\n");
    assert!(tracks.unwrap_or_else(|error| panic!("{error}")).is_some());
    // A valve that makes a pressure itself wants a pressure that stays.
    let regulated = "[supply]\ngauge_pressure = \"60 psi\"\nreservoir_volume = \"1 L\"\n[valve]\nkind = \"pressure-regulator\"\n\
                     time_constant = \"30 ms\"\nrate_limit = \"20 bar/s\"\nflow_area = \"1e-6 m^2\"\n[command]\nkind = \"set-points\"\n\
                     time = [\"0 s\"]\ngauge_pressure = [\"2 bar\"]\n";
    let load =
        format!("[load]\nkind = \"antagonistic-joint\"\npulley_radius = \"15 mm\"\nrest_length = \"3.3 in\"\n{LIMB}");
    let message = error_of(&format!("{BODY}{regulated}{load}{RUN}"));
    assert!(message.contains("behind a reservoir or a regulator"), "{message}");
}
