//! Plants of many actuators: parameters put in come back out of noisy records, derivatives are those of differences, a joint
//! gives the same result as a plant and as a rig, and what cannot be fitted is refused.

use crate::noise::Noise;
use mckibben::plant::simulate_plant;
use mckibben_identify::adjustable::Adjustable;
use mckibben_identify::least_squares::{Search, Unknown};
use mckibben_identify::study::Quantity;
use mckibben_identify::trajectories::{
    AdjustablePlant, Described, Horizon, Identified, Observed, Recorded, Sampling, Sensor, Subject, Task, TimeSeries,
};
use mckibben_scenario::{Document, Place, PlantPlace, Scenario};

/// An arm of two joints and three muscles, one of them over both joints, on one tank: with a hose, a tendon-free pulley and a
/// pull that is shared.
fn arm(shoulder: f64) -> Document {
    document(&format!(
        "[supplies.tank]\ngauge_pressure = \"5 bar\"\nreservoir_volume = \"250 cm^3\"\n\
         [valve]\npreset = \"matrix-eight-channel\"\nkind = \"fill-hold-exhaust\"\n\
         [command]\nkind = \"table\"\ntime = [\"0 s\", \"60 ms\", \"0.2 s\", \"0.24 s\"]\nstate = [\"fill\", \"hold\", \"exhaust\", \"hold\"]\n\
         [initial]\ngauge_pressure = \"1 bar\"\n[mechanism]\nkind = \"chain\"\n\
         [mechanism.joints.shoulder]\nlength = \"28 cm\"\nmass = \"0.8 kg\"\ndistance = \"12 cm\"\ninertia = \"5e-3 kg*m^2\"\n\
         damping = \"0.05 N*m*s/rad\"\nangle = \"{shoulder} deg\"\n\
         [mechanism.joints.elbow]\nmass = \"0.5 kg\"\ndistance = \"10 cm\"\ninertia = \"2.5e-3 kg*m^2\"\ndamping = \"0.04 N*m*s/rad\"\n\
         angle = \"20 deg\"\n[coupling]\nrest_length = \"3.4 in\"\n\
         [actuators.deltoid]\npreset = \"colbrunn-2001\"\nfriction.viscous = \"8 N*s/m\"\ncoupling.arms.shoulder = \"20 mm\"\n\
         [actuators.latissimus]\ncoupling.arms.shoulder = \"-20 mm\"\ncommand = {{ kind = \"hold\" }}\n\
         [actuators.biceps]\npreset = \"colbrunn-2001\"\nturns = 2.8\ncoupling.arms = {{ shoulder = \"12 mm\", elbow = \"15 mm\" }}\n\
         hose = {{ length = \"60 cm\", diameter = \"2.5 mm\" }}\n\
         [run]\nduration = \"0.4 s\"\n"
    ))
}

/// Two unlike muscles on one bottle, each of which lifts a weight.
fn bottle() -> Document {
    document(
        "[supply]\ngauge_pressure = \"4 bar\"\nreservoir_volume = \"200 cm^3\"\n[valve]\nkind = \"fill-hold-exhaust\"\nflow_area = \"0.15 mm^2\"\n\
         [command]\nkind = \"table\"\ntime = [\"0 s\", \"0.5 s\"]\nstate = [\"fill\", \"hold\"]\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n\
         [actuators.paper]\npreset = \"colbrunn-2001\"\n[actuators.thick]\npreset = \"colbrunn-2001\"\nturns = 1.8\nload.mass = \"25 lb\"\n\
         [actuators.long]\nthread_length = \"20 cm\"\nturns = 3.0\nmax_length = \"18 cm\"\nexternal_volume = \"5 cm^3\"\n\
         friction = { viscous = \"20 N*s/m\", coulomb_width = \"0.3 mm\" }\nload.mass = \"6 kg\"\n[run]\nduration = \"0.8 s\"\n",
    )
}

fn document(text: &str) -> Document {
    Document::parse(text, "plant.toml").unwrap_or_else(|error| panic!("{error}"))
}

fn find(document: &Document, path: &str) -> PlantPlace {
    document.find_in_plant(path).unwrap_or_else(|error| panic!("{error}"))
}

fn subject(document: &Document, paths: &[&str]) -> Subject {
    let places = paths.iter().map(|path| find(document, path)).collect();
    Subject::Plant(AdjustablePlant { document: document.clone(), places })
}

fn column(document: &Document, name: &str) -> Observed {
    let of = document.plant_experiment().unwrap_or_else(|error| panic!("{error}")).expect("a plant");
    let (part, word) = name.rsplit_once('.').expect("a part");
    Observed::of_part(&of, part, Quantity::of_part(word).expect("a quantity")).expect("a column")
}

/// A run as a rig would record it, each column with the standard deviation of a reading.
fn recorded(document: &Document, paths: &[&str], columns: &[(&str, f64)], seed: u64) -> Recorded {
    let of = document.plant_experiment().unwrap_or_else(|error| panic!("{error}")).expect("a plant");
    let run = simulate_plant(&of.plant, &of.start, of.run.duration, 1e-10).expect("a run");
    let times: Vec<f64> = (1..=150).map(|step| of.run.duration * f64::from(step) / 150.0).collect();
    let mut noise = Noise::new(seed);
    let series = |(name, deviation): &(&str, f64)| {
        let quantity = of.columns().into_iter().find(|of| of.name == *name).and_then(|of| of.quantity()).expect("one");
        let values: Vec<f64> = times.iter().map(|time| quantity.of(&of.plant, &run.sample(*time))).collect();
        let values = noise.added_to(&values, *deviation);
        TimeSeries {
            observed: column(document, name),
            times: times.clone(),
            values,
            deviation: None,
            sensor: Sensor::default(),
        }
    };
    Recorded {
        name: format!("seed {seed}"),
        time_series: columns.iter().map(series).collect(),
        subject: subject(document, paths),
        unknowns: (0..paths.len()).collect(),
    }
}

/// Looks for parameters from some times their true values.
fn task(runs: Vec<Recorded>, document: &Document, paths: &[&str], factor: f64) -> Task {
    let unknown = |path: &&str| {
        let value = find(document, path).value();
        Unknown::new(*path, "", factor * value).between(0.05 * value, 20.0 * value)
    };
    let unknowns = paths.iter().map(unknown).collect();
    Task { runs, unknowns, starts: Vec::new(), horizon: Horizon::Whole, search: Search::default(), tolerance: 1e-9 }
}

fn identified(task: &Task) -> Identified {
    task.identify().unwrap_or_else(|error| panic!("{error}"))
}

/// Every estimate is within four standard errors of the truth, and known to a part of it.
fn check(found: &Identified, truths: &[f64], part: f64) {
    for (estimate, truth) in found.found.fit.estimates.iter().zip(truths) {
        let deviation = estimate.standard_error.expect("a deviation");
        assert!((estimate.value - truth).abs() < 4.0 * deviation && deviation < part * truth, "{estimate:?}: {truth}");
    }
    assert!(found.found.fit.unidentifiable.is_empty());
}

/// Parameters of every section, those of one part and those of all, of a list, and of the start.
const OF_ALL_SECTIONS: [&str; 21] = [
    "actuator.turns",
    "actuators.deltoid.friction.viscous",
    "actuators.biceps.turns",
    "actuators.deltoid.thread_length",
    "actuators.biceps.coupling.arms.elbow",
    "actuators.biceps.hose.length",
    "actuators.latissimus.initial.gauge_pressure",
    "actuators.latissimus.external_volume",
    "coupling.rest_length",
    "valve.opening_delay",
    "command.time[1]",
    "initial.gauge_pressure",
    "air.atmospheric_pressure",
    "supplies.tank.gauge_pressure",
    "supplies.tank.reservoir_volume",
    "mechanism.gravity",
    "mechanism.joints.shoulder.mass",
    "mechanism.joints.shoulder.inertia",
    "mechanism.joints.shoulder.angle",
    "mechanism.joints.elbow.damping",
    "mechanism.joints.elbow.angle",
];

#[test]
fn derivatives_are_those_of_differences() {
    let document = arm(10.0);
    let subject = subject(&document, &OF_ALL_SECTIONS);
    let names = [
        "shoulder.angle",
        "elbow.angular_velocity",
        "biceps.gauge_pressure",
        "deltoid.tension",
        "tank.absolute_pressure",
    ];
    let sampling = Sampling {
        observed: names.iter().map(|name| column(&document, name)).collect(),
        times: vec![0.05, 0.13, 0.19, 0.3, 0.4],
        tolerance: 1e-10,
    };
    let values: Vec<f64> = OF_ALL_SECTIONS.iter().map(|path| find(&document, path).value()).collect();
    let (_, slopes) =
        sampling.value_and_jacobian(&subject, &values, &|_| Ok(())).unwrap_or_else(|error| panic!("{error}"));
    let count = names.len();
    for (place, path) in OF_ALL_SECTIONS.iter().enumerate() {
        let step = 1e-3 * values[place];
        let at = |change: f64| {
            let mut values = values.clone();
            values[place] += change;
            sampling.values(&subject, &values, &|_| Ok(())).unwrap_or_else(|error| panic!("{error}"))
        };
        let (below, above) = (at(-step), at(step));
        let difference: Vec<f64> = below.iter().zip(&above).map(|(low, high)| (high - low) / (2.0 * step)).collect();
        for (quantity, name) in names.iter().enumerate() {
            let of_quantity = || (0..sampling.times.len()).map(|time| time * count + quantity);
            let size = of_quantity().fold(0.0_f64, |size, row| size.max(difference[row].abs()));
            for row in of_quantity() {
                let off = (slopes[row * values.len() + place] - difference[row]).abs();
                assert!(
                    off <= 2e-3 * size,
                    "{name} by {path}: {} for {}",
                    slopes[row * values.len() + place],
                    difference[row]
                );
            }
        }
        assert!(difference.iter().any(|slope| *slope != 0.0), "{path}");
    }
}

#[test]
fn an_arm_gives_back_its_parts() {
    let paths = [
        "actuators.deltoid.friction.viscous",
        "actuators.biceps.turns",
        "actuators.biceps.coupling.arms.elbow",
        "mechanism.joints.shoulder.inertia",
        "mechanism.joints.elbow.damping",
        "supplies.tank.reservoir_volume",
    ];
    let columns = [
        ("shoulder.angle", 5e-4),
        ("elbow.angle", 5e-4),
        ("deltoid.gauge_pressure", 5e2),
        ("biceps.absolute_pressure", 5e2),
        ("tank.gauge_pressure", 5e2),
    ];
    let documents = [10.0, -15.0].map(arm);
    let runs = [0, 1].map(|run| recorded(&documents[run], &paths, &columns, 3 + run as u64));
    let task = task(runs.to_vec(), &documents[0], &paths, 1.25);
    let truths: Vec<f64> = paths.iter().map(|path| find(&documents[0], path).value()).collect();
    let found = identified(&task);
    check(&found, &truths, 0.05);
    assert!(task.drifts(&found).is_empty() && task.unexplained(&found).is_empty());
    for ((observed, left), (name, deviation)) in found.left.iter().zip(columns) {
        assert!(*observed == column(&documents[0], name), "{observed:?}");
        assert!((left / deviation - 1.0).abs() < 0.12, "{name}: {left}, not {deviation}");
    }
    // What is written runs with these values, and each run is predicted from the other.
    for (described, simulated) in found.scenarios.iter().zip(&found.simulated) {
        let again = document(&described.to_toml()).plant_experiment().expect("a file that runs").expect("a plant");
        let run = simulate_plant(&again.plant, &again.start, 0.4, 1e-9).expect("a run").sample(0.3);
        let read = simulated.read(&column(&documents[0], "elbow.angle"), 0.3);
        assert!((read - run.mechanisms[0].position[1]).abs() < 1e-7);
    }
    let held_out = task.held_out(&found);
    assert_eq!(held_out.len(), 2);
    for (run, left_out) in held_out.iter().enumerate() {
        // Predictions are off by the noise, and by at most what twice the standard errors of the parameters come to.
        let other = identified(&Task { runs: vec![task.runs[1 - run].clone()], ..task.clone() }).found.fit;
        let time_series = &task.runs[run].time_series;
        let sampling = Sampling {
            observed: time_series.iter().map(|series| series.observed.clone()).collect(),
            times: time_series[0].times.clone(),
            tolerance: 1e-9,
        };
        let values: Vec<f64> = other.estimates.iter().map(|estimate| estimate.value).collect();
        let (_, slopes) = sampling.value_and_jacobian(&task.runs[run].subject, &values, &|_| Ok(())).expect("a run");
        let covariance = |i: usize, j: usize| {
            let deviation = |of: usize| other.estimates[of].standard_error.expect("a deviation");
            other.correlations[i][j] * deviation(i) * deviation(j)
        };
        for (place, (observed, [_, outside])) in left_out.errors.iter().enumerate() {
            let of_time = |row: &[f64]| -> f64 {
                (0..6).flat_map(|i| (0..6).map(move |j| (i, j))).map(|(i, j)| row[i] * covariance(i, j) * row[j]).sum()
            };
            let rows = slopes.chunks(6).skip(place).step_by(columns.len());
            let spread = rows.map(of_time).sum::<f64>() / sampling.times.len() as f64;
            let noise = columns[place].1;
            let most = (noise.powi(2) + 4.0 * spread).sqrt();
            assert!(*observed == sampling.observed[place]);
            assert!(*outside > 0.85 * noise && *outside < 1.1 * most, "{observed:?}: {outside} of at most {most}");
        }
    }
}

/// A parameter at the top of the file is one of all muscles that have no other; each run may have a separate one.
#[test]
fn what_is_shared_is_one_parameter() {
    let paths =
        ["valve.flow_area", "supply.reservoir_volume", "actuators.long.friction.viscous", "actuators.thick.load.mass"];
    let columns =
        [("paper.length", 2e-5), ("thick.length", 2e-5), ("long.length", 2e-5), ("supply.absolute_pressure", 5e2)];
    let truth = bottle();
    let masses = [1.0, 1.15];
    let own = find(&truth, paths[3]);
    let runs = masses.map(|factor| {
        let its = truth.with_plant_values(std::slice::from_ref(&own), &[factor * own.value()]).expect("a mass");
        recorded(&its, &paths, &columns, 20 + (10.0 * factor) as u64)
    });
    let mut task = task(runs.to_vec(), &truth, &paths, 1.2);
    let mass = task.unknowns.pop().expect("a mass");
    for (place, run) in (3..).zip(&mut task.runs) {
        task.unknowns.push(Unknown { name: format!("{} [{place}]", mass.name), ..mass.clone() });
        run.unknowns = vec![0, 1, 2, place];
    }
    let mut truths: Vec<f64> = paths[..3].iter().map(|path| find(&truth, path).value()).collect();
    truths.extend(masses.map(|factor| factor * own.value()));
    check(&identified(&task), &truths, 0.05);
}

/// A joint as a plant's file and as a joint's, from the same records.
#[test]
fn a_plant_of_one_joint_is_that_joint() {
    let command =
        |state: &str| format!("kind = \"table\"\ntime = [\"0 s\", \"60 ms\", \"0.25 s\"]\nstate = [{state}]\n");
    let [agonist, antagonist] = ["\"fill\", \"hold\", \"hold\"", "\"hold\", \"hold\", \"exhaust\""].map(command);
    let common = "[supply]\ngauge_pressure = \"60 psi\"\n[valve]\npreset = \"matrix-eight-channel\"\nkind = \"fill-hold-exhaust\"\n\
                  [initial]\ngauge_pressure = \"20 psi\"\n[run]\nduration = \"0.4 s\"\n";
    let limb = "mass = \"0.5 kg\"\ndistance = \"100 mm\"\ninertia = \"2e-3 kg*m^2\"\ndamping = \"0.02 N*m*s/rad\"\n";
    let plant = document(&format!(
        "{common}[mechanism]\nkind = \"chain\"\n[mechanism.joints.elbow]\n{limb}[coupling]\nrest_length = \"3.3 in\"\n\
         [actuators.agonist]\npreset = \"colbrunn-2001\"\ncoupling.arms.elbow = \"15 mm\"\n[actuators.agonist.command]\n{agonist}\
         [actuators.antagonist]\npreset = \"colbrunn-2001\"\ncoupling.arms.elbow = \"-15 mm\"\n[actuators.antagonist.command]\n{antagonist}"
    ));
    let joint = format!(
        "[actuator]\npreset = \"colbrunn-2001\"\n{common}[command]\n{agonist}[load]\nkind = \"antagonistic-joint\"\npulley_radius = \"15 mm\"\n\
         rest_length = \"3.3 in\"\n{limb}[antagonist]\nactuator.preset = \"colbrunn-2001\"\n[antagonist.command]\n{antagonist}"
    )
    .replace("[initial]", "[initial]\nangle = \"0 deg\"");
    let mut joint = Scenario::from_str(&joint, "joint.toml").unwrap_or_else(|error| panic!("{error}"));
    let paths = ["mechanism.joints.elbow.damping", "actuators.antagonist.turns"];
    let columns = [("elbow.angle", 1e-3), ("antagonist.gauge_pressure", 1e3)];
    let run = recorded(&plant, &paths, &columns, 8);
    let places =
        ["load.damping", "antagonist.actuator.turns"].map(|path| Place::find(path, &mut joint).expect("a number"));
    let mut by_itself = run.clone();
    by_itself.subject = Adjustable::new(joint, places.to_vec(), [false; 2]).into();
    for (series, observed) in by_itself.time_series.iter_mut().zip([Observed::Angle, Observed::AntagonistGaugePressure])
    {
        series.observed = observed;
    }
    let found = [run, by_itself].map(|run| identified(&task(vec![run], &plant, &paths, 1.2)).found.fit);
    for (one, other) in found[0].estimates.iter().zip(&found[1].estimates) {
        let (of_one, of_other) = (one.standard_error.expect("one"), other.standard_error.expect("one"));
        assert!((one.value - other.value).abs() < 1e-3 * of_one, "{one:?}, {other:?}");
        assert!((of_one / of_other - 1.0).abs() < 1e-3, "{one:?}, {other:?}");
    }
}

#[test]
fn what_a_plant_cannot_do_says_why() {
    let truth = bottle();
    let wrong = |path: &str| truth.find_in_plant(path).expect_err("no parameter").to_string();
    let said = wrong("actuators.tick.turns");
    assert!(said.contains("`actuators.tick.turns`") && said.contains("`thick`"), "{said}");
    let said = wrong("thick.turns");
    assert!(said.contains("did you mean `actuators.thick.turns`?"), "{said}");
    assert!(wrong("actuators.thick.tuns").contains("no key of a plant"));
    assert!(wrong("command.time").contains("`command.time[0]`"));
    assert!(wrong("command.kind").contains("is no quantity"));
    let paths = ["actuators.thick.turns"];
    let run = recorded(&truth, &paths, &[("thick.length", 0.0)], 1);
    let with = |change: &dyn Fn(&mut Task)| {
        let mut task = task(vec![run.clone()], &truth, &paths, 1.0);
        change(&mut task);
        task.identify().expect_err("bad").to_string()
    };
    let said = with(&|task| task.horizon = Horizon::Segments(0.1));
    assert!(
        said.contains("where actuators have names is not implemented") || said.contains("search.horizon"),
        "{said}"
    );
    let said = with(&|task| task.unknowns[0].start = -1.0);
    assert!(said.contains("actuator.turns"), "{said}");
    let said = with(&|task| task.runs[0].time_series[0].observed = Observed::Angle);
    assert!(said.contains("readings of the angle"), "{said}");
    // A value that contradicts the rest of the file is refused as the file would be.
    let said = with(&|task| {
        task.runs[0].subject = subject(&truth, &["actuators.long.max_length"]);
        task.unknowns[0].start = 0.3;
    });
    assert!(said.contains("max_length"), "{said}");
    assert!(matches!(identified(&task(vec![run], &truth, &paths, 1.1)).scenarios[0], Described::Plant(_)));
}
