//! `mckibben identify` on valves: numbers that are known go in as data with noise and come out within their intervals, and what
//! cannot be is refused in words.

use crate::common::{Folder, of_repository};
use std::process::Output;

/// The rig that the studies begin from; its valve's numbers are other than those looked for.
const RIG: &str = "[supply]\ngauge_pressure = \"6 bar\"\n[valve]\nkind = \"three-way\"\nsonic_conductance = \"1 L/(s*bar)\"\ncritical_ratio = 0.5\n\
                   opening_delay = \"1 ms\"\nclosing_delay = \"1 ms\"\n[command]\nkind = \"exhaust\"\n[load]\nkind = \"isometric\"\n\
                   [initial]\ngauge_pressure = \"6 bar\"\nlength = \"90 mm\"\n[run]\nduration = \"1 s\"\n";

/// Numbers that look random, of mean 0 and standard deviation 1, equal in every run.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (((self.0 ^ (self.0 >> 31)).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

fn identify(folder: &Folder, study: &str) -> Output {
    let study = folder.file("study.toml", study);
    folder.mckibben().arg("identify").arg(study).args(["--output", "out"]).output().expect("the program runs")
}

/// What it says of a study that goes through.
fn found(folder: &Folder, study: &str) -> String {
    let output = identify(folder, study);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// What it says of one that it refuses; nothing is written.
fn refused(folder: &Folder, study: &str) -> String {
    let output = identify(folder, study);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{error}{}", String::from_utf8_lossy(&output.stdout));
    assert!(!folder.path("out").exists(), "something was written");
    error.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn read(folder: &Folder, name: &str) -> String {
    std::fs::read_to_string(folder.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The interval of a number in `values.csv`.
fn interval(folder: &Folder, number: &str) -> [f64; 2] {
    let csv = read(folder, "out/values.csv");
    let mut lines = csv::Reader::from_reader(csv.as_bytes());
    let row = lines.records().map(|line| line.expect("a line")).find(|line| line.iter().any(|cell| cell == number));
    let row = row.unwrap_or_else(|| panic!("{number} is not in\n{csv}"));
    let ends = row[row.len() - 1].split(" to ").map(|end| end.parse().unwrap_or_else(|_| panic!("{csv}")));
    ends.collect::<Vec<f64>>().try_into().unwrap_or_else(|_| panic!("{csv}"))
}

/// Holds that an interval has the truth in it and is no wider than a part of it.
fn holds(folder: &Folder, number: &str, truth: f64, part: f64) {
    let [low, high] = interval(folder, number);
    assert!(low <= truth && truth <= high, "{number}: {truth} is not in {low} to {high}");
    assert!(high - low < part * truth, "{number}: {low} to {high} is wide");
}

/// Holds that the scenario that was written runs, and says so of these keys.
fn runs(folder: &Folder, file: &str, keys: &[&str]) {
    let text = read(folder, &format!("out/{file}"));
    for key in keys {
        assert!(text.contains(key), "{key} is not in\n{text}");
    }
    let run = folder.mckibben().args(["simulate", &format!("out/{file}")]).output().expect("the program runs");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
}

fn there(folder: &Folder, files: &[&str]) {
    for file in files {
        assert!(folder.path("out").join(file).exists(), "{file}");
    }
    assert!(read(folder, "out/index.html").contains("<svg") || read(folder, "out/index.html").contains("<img"));
}

const CONDUCTANCE: f64 = 6e-9;
const RATIO: f64 = 0.32;

/// ISO 6358-1 written out: mass flow in kg/s of 1.185 kg/m³ at 293.15 K.
fn iso(upstream: f64, downstream: f64, temperature: f64) -> f64 {
    let r = downstream / upstream;
    let shape = if r <= RATIO { 1.0 } else { (1.0 - ((r - RATIO) / (1.0 - RATIO)).powi(2)).sqrt() };
    CONDUCTANCE * 1.185 * upstream * (293.15 / temperature).sqrt() * shape
}

/// A flow curve in bar and L/min ANR at 22 °C; `read` changes a reading.
fn flow_curve(upstream: f64, mut read: impl FnMut(f64) -> f64) -> String {
    let mut line = |place: u32| {
        let downstream = upstream * (0.15 + 0.0575 * f64::from(place));
        let flow = iso(upstream, downstream, 295.15) / 1.185 * 6e4;
        format!("{:.4},{:.4},22.0,{:.3}\n", upstream / 1e5, downstream / 1e5, read(flow))
    };
    (0..14).fold("P1_bar,P2_bar,T_C,Q\n".to_owned(), |text, place| text + &line(place))
}

/// A study of two tables of steady flow.
fn steady(kind: &str, more: &str) -> String {
    format!(
        "[study]\nkind = \"{kind}\"\nscenario = \"rig.toml\"\n[columns.upstream_absolute_pressure]\nname = \"P1_bar\"\nunit = \"bar\"\n\
         [columns.downstream_absolute_pressure]\nname = \"P2_bar\"\nunit = \"bar\"\n[columns.temperature]\nname = \"T_C\"\nunit = \"degC\"\n\
         [columns.volume_flow]\nname = \"Q\"\nunit = \"L/min ANR\"\n[[run]]\nfile = \"seven.csv\"\n[[run]]\nfile = \"five.csv\"\n{more}"
    )
}

/// Tables of two upstream pressures with a noise of 1 % of the largest flow.
fn steady_data(folder: &Folder) {
    folder.file("rig.toml", RIG);
    let mut noise = Noise(7);
    for (name, upstream) in [("seven.csv", 7e5), ("five.csv", 5e5)] {
        folder.file(name, &flow_curve(upstream, |flow| flow + 2.5 * noise.normal()));
    }
}

#[test]
fn a_flow_curve_gives_c_and_b() {
    let folder = Folder::new("valve-flow-curve");
    steady_data(&folder);
    let printed = found(&folder, &steady("flow-curve", ""));
    assert!(printed.contains("28 points of steady flow") && printed.contains("L/(s·bar)"), "{printed}");
    holds(&folder, "valve.sonic_conductance", CONDUCTANCE, 0.03);
    holds(&folder, "valve.critical_ratio", RATIO, 0.2);
    there(&folder, &["index.html", "flow-curve.svg", "flow-curve.png", "flow-curve.csv"]);
    runs(&folder, "scenario.toml", &["sonic_conductance", "critical_ratio"]);
    let page = read(&folder, "out/index.html");
    assert!(page.contains("One after the other, as the standard goes about it"), "no standard’s way");
}

#[test]
fn a_measured_exhaust_keeps_the_other_flow_path() {
    let folder = Folder::new("valve-exhaust");
    steady_data(&folder);
    folder.file("rig.toml", &RIG.replace("opening_delay", "efficiency = 0.8\nopening_delay"));
    let printed = found(&folder, &steady("flow-curve", "[flow]\nflow_path = \"exhaust\"\n"));
    holds(&folder, "valve.exhaust.sonic_conductance", CONDUCTANCE, 0.03);
    // 1 L/(s·bar) with an efficiency of 0.8 is 0.8 L/(s·bar) with one of 1.
    assert!(printed.contains("valve.efficiency was 0.8 and is 1 now"), "{printed}");
    runs(&folder, "scenario.toml", &["[valve.exhaust]", "sonic_conductance = \"8e-9 m^3/(s*Pa)\"", "efficiency = 1"]);
}

#[test]
fn steady_flow_gives_the_efficiency_and_the_flow_coefficient() {
    let folder = Folder::new("valve-efficiency");
    steady_data(&folder);
    // The law of the scenario with 1/0.6 of the conductance: the efficiency is 0.6.
    folder.file("rig.toml", &RIG.replace("critical_ratio = 0.5", "critical_ratio = 0.32"));
    found(&folder, &steady("steady-flow", "[flow]\nscatter = \"constant\"\n"));
    holds(&folder, "valve.efficiency", 0.6, 0.02);
    there(&folder, &["index.html", "ratios.svg", "ratios.csv"]);
    runs(&folder, "scenario.toml", &["efficiency = 0.6", "sonic_conductance"]);
    // An orifice with C_q = 0.7 of 3 mm²: (21)(23) written out, choked and subsonic.
    let orifice = |r: f64| {
        let shape = match r {
            r if r <= 0.528_281_787_717 => (1.4 / 286.99 * (2.0_f64 / 2.4).powi(6)).sqrt(),
            r => (2.0 * 1.4 / (286.99 * 0.4) * (r.powf(2.0 / 1.4) - r.powf(2.4 / 1.4))).sqrt(),
        };
        0.7 * 3e-6 * 7e5 * shape / 295.15_f64.sqrt()
    };
    let mut noise = Noise(3);
    let line = |r: f64, noise: f64| format!("7,{},22,{:.5}\n", 7.0 * r, 1e3 * orifice(r) * (1.0 + 0.01 * noise));
    let table = (1..20).fold("P1_bar,P2_bar,T_C,Q\n".to_owned(), |text, place| {
        text + &line(0.2 + 0.035 * f64::from(place), noise.normal())
    });
    folder.file("seven.csv", &table);
    let study = steady("steady-flow", "[flow]\nscatter = \"proportional\"\narea = \"3 mm^2\"\n");
    let study = study
        .replace("volume_flow", "mass_flow")
        .replace("L/min ANR", "g/s")
        .replace("[[run]]\nfile = \"five.csv\"\n", "");
    found(&folder, &study);
    holds(&folder, "flow_coefficient", 0.7, 0.02);
    holds(&folder, "valve.flow_area", 2.1e-6, 0.02);
    runs(&folder, "scenario.toml", &["flow_area = "]);
}

#[test]
fn steady_flow_that_cannot_be_is_refused() {
    let folder = Folder::new("valve-steady-mistakes");
    steady_data(&folder);
    let study = steady("flow-curve", "");
    for (text, words) in [
        (
            study.replace("L/min ANR", "L/min"),
            "line 15: `L/min` does not say at which pressure and temperature the air is counted",
        ),
        (study.replace("L/min ANR", "kg/s"), "`kg/s` is no unit of volume flow"),
        (study.replace("unit = \"degC\"", "unit = \"bar\""), "`bar` is no unit of temperature"),
        (
            study.replace("unit = \"degC\"", "unit = \"K\""),
            "the run `seven`: temperature of reading 1 is 22 K, no temperature of air",
        ),
        (study.replace("P1_bar", "Q2").replace("Q2", "P2_bar"), "not below the upstream pressure"),
        (study.replace("unit = \"bar\"", "unit = \"mbar\""), "hardly more than a vacuum"),
        (study.clone() + "[flow]\narea = \"3 mm^2\"\n", "`flow.area` belongs to a study of the kind \"steady-flow\""),
        (
            study.clone() + "[flow]\nscatter = \"large\"\n",
            "unknown variant `large`, expected `constant` or `proportional`",
        ),
        (
            study.clone() + "[tank]\nfind = \"valve\"\ntransfer = \"charge\"\nvolume = \"1 L\"\n",
            "line 20: `[tank]` belongs to a study of the kind \"tank\"",
        ),
        (
            study.replace("[columns.temperature]", "[columns.command]").replace("degC", ""),
            "the run `seven` has no temperature",
        ),
        (steady("steady-flow", "[flow]\narea = \"3 mm\"\n"), "`flow.area` is \"3 mm\": that is a length"),
        (steady("steady-flow", "[flow]\narea = \"0 mm^2\"\n"), "`flow.area` is \"0 mm^2\", which is not above zero"),
    ] {
        let printed = refused(&folder, &text);
        assert!(printed.contains(words), "`{words}` is not in\n{printed}");
    }
    // A meter that ends at 150 L/min: the same largest flow from 5 bar and from 7 bar, in one table.
    let rows =
        |upstream: f64| flow_curve(upstream, |flow| flow.min(150.0)).split_once('\n').expect("a head").1.to_owned();
    folder.file("seven.csv", &format!("P1_bar,P2_bar,T_C,Q\n{}{}", rows(7e5), rows(5e5)));
    let printed = refused(&folder, &study);
    assert!(printed.contains("the flow meter is at its end"), "{printed}");
    folder.file("rig.toml", "[load]\nkind = \"isometric\"\n[initial]\ngauge_pressure = \"6 bar\"\nlength = \"90 mm\"\n[run]\nduration = \"1 s\"\n");
    assert!(refused(&folder, &study).contains("the scenario has no valve"));
}

#[test]
fn gauge_pressures_under_the_name_of_absolute_ones_are_seen() {
    let folder = Folder::new("valve-gauge");
    folder.file("rig.toml", RIG);
    // From 3 bar absolute, down to back pressures above the atmosphere, written as gauge pressures.
    let mut noise = Noise(5);
    let mut line = |downstream: f64| {
        let flow = iso(3.01325e5, downstream + 101_325.0, 295.15) / 1.185 * 6e4;
        format!("2,{:.4},22,{:.3}\n", downstream / 1e5, flow * (1.0 + 1e-3 * noise.normal()))
    };
    let rows: String = (1..20).map(|place| line(9e3 * f64::from(place))).collect();
    folder.file("seven.csv", &format!("P1_bar,P2_bar,T_C,Q\n{rows}"));
    let study = steady("flow-curve", "").replace("[[run]]\nfile = \"five.csv\"\n", "");
    let printed = refused(&folder, &study);
    assert!(printed.contains("both pressures are absolute"), "{printed}");
    // Under their own name the curve lacks its choked part, and that is what is said.
    let printed = refused(&folder, &study.replace("absolute_pressure", "gauge_pressure"));
    assert!(printed.contains("no point is choked: the least pressure ratio is 0.36"), "{printed}");
}

/// The truth of the tanks: 0.5 L behind 0.6 L/(s·bar).
fn truth(state: &str, start: &str) -> String {
    RIG.replace("1 L/(s*bar)", "0.6 L/(s*bar)")
        .replace("critical_ratio = 0.5", "critical_ratio = 0.32")
        .replace("kind = \"exhaust\"", &format!("kind = \"{state}\""))
        .replace("[initial]\ngauge_pressure = \"6 bar\"", &format!("[initial]\ngauge_pressure = \"{start}\""))
        .replace("opening_delay = \"1 ms\"\nclosing_delay = \"1 ms\"\n", "")
        .replace("[supply]", "[actuator]\npreset = \"colbrunn-2001\"\nexternal_volume = \"0.5 L\"\n[air]\nprocess = \"isothermal\"\n[supply]")
        .replace("duration = \"1 s\"\n", "duration = \"1.2 s\"\nsample_interval = \"5 ms\"\n")
}

/// Simulates a truth and adds noise in Pa to its pressure: a table of `t_s,P_Pa`.
fn recorded(folder: &Folder, truth: &str, set: &[&str], deviation: f64) -> String {
    folder.file("truth.toml", truth);
    let mut command = folder.mckibben();
    command.args(["simulate", "truth.toml", "--output", "run.csv"]);
    for set in set {
        command.args(["--set", set]);
    }
    let output = command.output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let csv = read(folder, "run.csv");
    let mut lines = csv::Reader::from_reader(csv.as_bytes());
    let heads = lines.headers().expect("a head").clone();
    let place = |name: &str| heads.iter().position(|head| head == name).expect("a column");
    let (time, pressure) = (place("time_s"), place("absolute_pressure_pa"));
    // Other noise for another run.
    let mut noise = Noise(set.iter().flat_map(|set| set.bytes()).fold(11, |seed, byte| seed + 97 * u64::from(byte)));
    lines.records().map(|line| line.expect("a line")).fold("t_s,P_Pa\n".to_owned(), |text, line| {
        let value: f64 = line[pressure].parse().expect("a number");
        format!("{text}{},{:.1}\n", &line[time], value + deviation * noise.normal())
    })
}

fn tank_study(more: &str) -> String {
    format!(
        "[study]\nkind = \"tank\"\nscenario = \"rig.toml\"\n[columns.time]\nname = \"t_s\"\nunit = \"s\"\n\
         [columns.absolute_pressure]\nname = \"P_Pa\"\nunit = \"Pa\"\n[[run]]\nfile = \"run.csv\"\n[tank]\n{more}"
    )
}

/// The rig as a tank study begins from it: isothermal.
fn tank_rig() -> String {
    RIG.replace("[supply]", "[air]\nprocess = \"isothermal\"\n[supply]")
}

#[test]
fn a_tank_gives_its_valve_by_the_trajectory_and_by_windows() {
    let folder = Folder::new("valve-tank");
    folder.file("rig.toml", &tank_rig());
    // The braid at 90 mm is part of the volume, 0.5 L and some: the sum is what was measured beforehand.
    let long = ["run.duration=\"1.6 s\"", "run.sample_interval=\"2 ms\""];
    let table = recorded(&folder, &truth("exhaust", "7 bar"), &long, 50.0);
    folder.file("run.csv", &table);
    // b² = 4.3218² in², n = 2.5: V = L (b² − L²)/(4πn²).
    let (b, length) = (4.3218 * 0.0254_f64, 0.09);
    let braid = length * (b * b - length * length) / (4.0 * std::f64::consts::PI * 6.25);
    let volume = 5e-4 + braid;
    let known =
        format!("find = \"valve\"\ntransfer = \"discharge\"\nvolume = \"{volume} m^3\"\ntemperature = \"20 degC\"\n");
    found(&folder, &tank_study(&known));
    holds(&folder, "valve.sonic_conductance", CONDUCTANCE, 0.01);
    holds(&folder, "valve.critical_ratio", RATIO, 0.1);
    there(&folder, &["index.html", "tank-1.svg", "tank-1.csv"]);
    runs(&folder, "scenario.toml", &["sonic_conductance", "critical_ratio"]);
    found(&folder, &tank_study(&(known + "windows = 40\n")));
    holds(&folder, "valve.sonic_conductance", CONDUCTANCE, 0.05);
    holds(&folder, "valve.critical_ratio", RATIO, 0.5);
    there(&folder, &["flow-curve.svg"]);
}

#[test]
fn a_charge_gives_the_external_volume() {
    let folder = Folder::new("valve-volume");
    let rig = truth("fill", "0 bar").replace("0.5 L", "10 cm^3");
    folder.file("rig.toml", &rig);
    let table = recorded(&folder, &truth("fill", "0 bar"), &[], 300.0);
    folder.file("run.csv", &table);
    let study = "find = \"volume\"\ntransfer = \"charge\"\nvolume = \"0.3 L\"\nlength = \"90 mm\"\n";
    let printed = found(&folder, &tank_study(study));
    assert!(printed.contains("of which the actuator has"), "{printed}");
    holds(&folder, "actuator.external_volume", 5e-4, 0.01);
    runs(&folder, "scenario.toml", &["external_volume"]);
    // The same as a gauge pressure, in two runs of which one begins later.
    let gauge: String = table
        .lines()
        .skip(1)
        .map(|line| line.split_once(',').expect("two cells"))
        .map(|(time, pressure)| format!("{time},{:.1}\n", pressure.parse::<f64>().expect("a number") - 101_325.0))
        .collect();
    folder.file("gauge.csv", &format!("t_s,P_Pa\n{gauge}"));
    let study = tank_study(study).replace("absolute_pressure", "gauge_pressure").replace("run.csv", "gauge.csv");
    found(
        &folder,
        &(study.replace("[tank]", "[[run]]\nname = \"late\"\nfile = \"gauge.csv\"\n[tank]\nends = \"0.6 s\"")),
    );
    holds(&folder, "actuator.external_volume", 5e-4, 0.02);
    // The same scenario, once.
    runs(&folder, "scenario.toml", &["external_volume"]);
}

#[test]
fn two_discharges_give_one_valve() {
    let folder = Folder::new("valve-tanks");
    folder.file("rig.toml", &tank_rig().replace("[supply]", "[actuator]\npreset = \"colbrunn-2001\"\n[supply]"));
    let pressures = [("high", "7 bar", 50.0), ("low", "4 bar", 200.0)];
    for (name, start, deviation) in pressures {
        let table = recorded(&folder, &truth("exhaust", start), &["run.sample_interval=\"4 ms\""], deviation);
        folder.file(&format!("{name}.csv"), &table);
    }
    let of = |files: &[&str]| {
        let runs: String = files.iter().map(|name| format!("[[run]]\nfile = \"{name}.csv\"\n")).collect();
        let known = "find = \"valve\"\ntransfer = \"discharge\"\nvolume = \"504.526 cm^3\"\n";
        tank_study(known).replace("[[run]]\nfile = \"run.csv\"\n", &runs)
    };
    let width = || {
        let [low, high] = interval(&folder, "valve.critical_ratio");
        high - low
    };
    found(&folder, &of(&["low"]));
    let alone = width();
    let printed = found(&folder, &of(&["high", "low"]));
    assert!(printed.contains("of 2 runs together"), "{printed}");
    holds(&folder, "valve.sonic_conductance", CONDUCTANCE, 0.01);
    holds(&folder, "valve.critical_ratio", RATIO, 0.1);
    assert!(width() < alone, "{} is not below {alone}", width());
    // Each run has its own noise, and its own scatter about the common valve.
    let csv = read(&folder, "out/comparison.csv");
    let left = |run: &str| {
        let line = csv.lines().find(|line| line.starts_with(run)).unwrap_or_else(|| panic!("{csv}"));
        line.split(',').nth(2).and_then(|left| left.split(' ').next()?.parse::<f64>().ok()).expect("a number")
    };
    assert!((left("high") / 50.0 - 1.0).abs() < 0.2 && (left("low") / 200.0 - 1.0).abs() < 0.2, "{csv}");
    there(&folder, &["tank-1.svg", "tank-2.svg"]);
}

#[test]
fn heat_transfer_is_estimated_together_with_the_valve_in_a_study() {
    let folder = Folder::new("valve-heat");
    let balance = |text: String, heat: &str| {
        text.replace("process = \"isothermal\"", &format!("process = \"energy-balance\"\nheat_transfer = \"{heat}\""))
            .replace("[valve]\n", "[valve]\nexhaust_temperature = \"actuator\"\n")
    };
    folder.file("rig.toml", &balance(tank_rig(), "0.2 W/K"));
    let table = recorded(&folder, &balance(truth("exhaust", "7 bar"), "0.5 W/K"), &[], 50.0);
    folder.file("run.csv", &table);
    let study = &tank_study("find = \"valve\"\ntransfer = \"discharge\"\nvolume = \"504.526 cm^3\"\nheat = true\n");
    found(&folder, study);
    let [low, high] = interval(&folder, "air.heat_transfer");
    assert!(low < 0.5 && 0.5 < high && high - low < 0.2, "{low} to {high}");
    runs(&folder, "scenario.toml", &["heat_transfer"]);
    let rig =
        read(&folder, "rig.toml").replace("exhaust_temperature = \"actuator\"", "exhaust_temperature = \"ambient\"");
    folder.file("rig.toml", &rig);
    let printed = found(&folder, study);
    let words: Vec<&str> = printed.split_whitespace().collect();
    assert!(words.join(" ").contains("of the scenario is \"actuator\" now"), "{printed}");
    runs(&folder, "scenario.toml", &["exhaust_temperature = \"actuator\""]);
}

#[test]
fn the_examples_hold_what_was_put_into_them() {
    for (example, numbers) in [
        ("flow-curve", [("valve.sonic_conductance", 6e-9, 0.01), ("valve.critical_ratio", 0.32, 0.05)]),
        ("tank", [("valve.sonic_conductance", 6e-9, 0.01), ("valve.critical_ratio", 0.32, 0.05)]),
        ("pulse-train", [("valve.opening_delay", 4e-3, 0.025), ("valve.closing_delay", 1e-3, 0.1)]),
    ] {
        let folder = Folder::new(&format!("valve-example-{example}"));
        let study = of_repository(&format!("examples/identify/{example}.toml"));
        let output = folder.mckibben().arg("identify").arg(study).args(["--output", "out"]).output().expect("it runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        for (number, truth, part) in numbers {
            holds(&folder, number, truth, part);
        }
        runs(&folder, "scenario.toml", &[]);
    }
}

#[test]
fn tanks_that_cannot_be_are_refused() {
    let folder = Folder::new("valve-tank-mistakes");
    folder.file("rig.toml", &tank_rig());
    let table = recorded(&folder, &truth("exhaust", "6 bar"), &[], 100.0);
    folder.file("run.csv", &table);
    let good = tank_study("find = \"valve\"\ntransfer = \"discharge\"\nvolume = \"0.5 L\"\n");
    for (text, words) in [
        (good.split("[tank]").next().expect("a part").to_owned(), "line 1: the study does not say what tank it is"),
        (
            good.replace("0.5 L", "0.5 m"),
            "`tank.volume` is \"0.5 m\": that is a length; give a volume such as \"0.5 L\"",
        ),
        (good.replace("0.5 L", "-1 L"), "`tank.volume` is \"-1 L\", which is not above zero"),
        (good.replace("\"valve\"", "\"leak\""), "unknown variant `leak`, expected `valve` or `volume`"),
        (good.clone() + "windows = 3\n", "line 16: `tank.windows` is 3, which is below 5"),
        (good.clone() + "heat = true\nwindows = 20\n", "`tank.windows` finds a valve behind a known volume"),
        (good.clone() + "begins = \"2 s\"\nends = \"1 s\"\n", "`tank.ends` is \"1 s\", not after `tank.begins`"),
        (good.clone() + "begins = \"5 s\"\n", "there are 0 samples"),
        (good.clone() + "[search]\nrobust = 2.5\n", "a study of the kind \"tank\" does not read `robust` in [search]"),
        (good.clone() + "length = \"90 mm\"\n", "`tank.length` is of a volume that is found"),
        (good.clone() + "temperature = \"20 bar\"\n", "`tank.temperature` is \"20 bar\": that is a pressure"),
        (good.clone() + "heat = true\n", "heat transfer is to be estimated for air whose process has none"),
        (good.replace("discharge", "charge"), "the pressure does not rise, but the study says charge"),
    ] {
        let printed = refused(&folder, &text);
        let words = words.split("; give").next().expect("a part");
        assert!(printed.contains(words), "`{words}` is not in\n{printed}");
    }
    // The same pressures as gauge pressures under the name of absolute ones: below the atmosphere's.
    let shifted = |by: f64, end: f64| {
        let line = |(time, pressure): (&str, &str)| {
            format!("{time},{:.1}\n", (pressure.parse::<f64>().expect("a number") + by).min(end))
        };
        table
            .lines()
            .skip(1)
            .map(|text| line(text.split_once(',').expect("two cells")))
            .fold("t_s,P_Pa\n".to_owned(), |all, line| all + &line)
    };
    let long = shifted(-101_325.0, 1e9)
        .lines()
        .filter(|line| !line.contains(",-"))
        .map(|line| line.to_owned() + "\n")
        .collect::<String>();
    folder.file("run.csv", &long);
    let printed = refused(&folder, &good);
    assert!(printed.contains("but the atmosphere to which it is discharged has 1.013 bar"), "{printed}");
    assert!(printed.contains("name its column `gauge_pressure`"), "{printed}");
    // A sensor that ends at 5 bar.
    folder.file("run.csv", &shifted(0.0, 5e5));
    let printed = refused(&folder, &good);
    assert!(
        printed.contains("reads 500000 Pa, its largest value") && printed.contains("the sensor is at its end"),
        "{printed}"
    );
    assert!(printed.contains("`saturates = \"500000 Pa\"`"), "{printed}");
    found(&folder, &good.replace("unit = \"Pa\"", "unit = \"Pa\"\nsaturates = \"500000 Pa\""));
}

/// A muscle's hose and fittings, 60 mL, behind a valve that opens after 4 ms and closes after 1 ms.
fn pulsed() -> String {
    truth("fill", "2 bar")
        .replace("0.5 L", "60 cm^3")
        .replace("process = \"isothermal\"", "process = \"isentropic\"")
        .replace("critical_ratio = 0.32", "critical_ratio = 0.32\nopening_delay = \"4 ms\"\nclosing_delay = \"1 ms\"")
        .replace("kind = \"fill\"", "kind = \"pwm\"\nfrequency = \"20 Hz\"\nduty = 0.5")
        .replace("sample_interval = \"5 ms\"", "sample_interval = \"0.5 ms\"")
        .replace("1.2 s", "0.8 s")
}

#[test]
fn pulse_trains_give_the_delays_and_the_effective_duty() {
    let folder = Folder::new("valve-pulses");
    let truth = pulsed();
    folder.file(
        "rig.toml",
        &truth.replace("\"4 ms\"", "\"2 ms\"").replace("closing_delay = \"1 ms\"", "closing_delay = \"3 ms\""),
    );
    for (name, frequency) in [("ten.csv", "10 Hz"), ("twenty.csv", "20 Hz"), ("forty.csv", "40 Hz")] {
        let table = recorded(&folder, &truth, &[&format!("command.frequency=\"{frequency}\"")], 300.0);
        folder.file(name, &table);
    }
    let study = "[study]\nkind = \"pulse-train\"\nscenario = \"rig.toml\"\n[columns.time]\nname = \"t_s\"\nunit = \"s\"\n\
                 [columns.absolute_pressure]\nname = \"P_Pa\"\nunit = \"Pa\"\n\
                 [[run]]\nfile = \"ten.csv\"\nset = { \"command.frequency\" = \"10 Hz\" }\n[[run]]\nfile = \"twenty.csv\"\n\
                 [[run]]\nfile = \"forty.csv\"\nset = { \"command.frequency\" = \"40 Hz\" }\n";
    let printed = found(&folder, study);
    holds(&folder, "valve.opening_delay", 4e-3, 0.05);
    holds(&folder, "valve.closing_delay", 1e-3, 0.2);
    there(&folder, &["index.html", "pulses-1.svg", "pulses-3.png", "duty.svg", "duty.csv"]);
    runs(&folder, "scenario.toml", &["opening_delay", "closing_delay"]);
    // 0.5 − 3 ms · 40 Hz = 0.38; the paper's way gives the difference of the delays.
    let duty = read(&folder, "out/duty.csv");
    let forty = duty.lines().last().expect("a line").split(',').nth(2).and_then(|cell| cell.parse::<f64>().ok());
    assert!((forty.expect("a number") - 0.38).abs() < 3e-3, "{duty}");
    assert!(printed.contains("longer than the closing"), "{printed}");
}

#[test]
fn the_edges_may_come_from_a_column() {
    let folder = Folder::new("valve-command");
    folder.file("rig.toml", RIG);
    // A clock that began 0.2 s before, and a command in volts that was sampled with the pressure.
    let table = recorded(&folder, &pulsed(), &[], 100.0);
    let line = |line: &str| {
        let (time, pressure) = line.split_once(',').expect("two cells");
        let time: f64 = time.parse().expect("a number");
        // The edge is somewhere between the two samples that differ.
        let volts = if ((time + 0.25e-3) * 20.0).fract() < 0.5 { 24.0 } else { 0.1 };
        format!("{:.6},{pressure},{volts}\n", time + 0.2)
    };
    let rows: String = table.lines().skip(1).map(line).collect();
    folder.file("run.csv", &format!("t_s,P_Pa,U\n{rows}"));
    let study = "[study]\nkind = \"pulse-train\"\nscenario = \"rig.toml\"\n[columns.time]\nname = \"t_s\"\nunit = \"s\"\n\
                 [columns.absolute_pressure]\nname = \"P_Pa\"\nunit = \"Pa\"\n[columns.command]\nname = \"U\"\nunit = \"\"\n[[run]]\nfile = \"run.csv\"\n";
    let printed = found(&folder, study);
    assert!(printed.contains("half a step of 0.500 ms"), "{printed}");
    let [opening, closing] = ["valve.opening_delay", "valve.closing_delay"].map(|name| interval(&folder, name));
    assert!((0.5 * (opening[0] + opening[1]) - 4e-3).abs() < 3e-4, "{opening:?}");
    assert!((0.5 * (closing[0] + closing[1]) - 1e-3).abs() < 3e-4, "{closing:?}");
    // The scenario's PWM in the time of the record says the same.
    let rig = RIG.replace("kind = \"exhaust\"", "kind = \"pwm\"\nfrequency = \"20 Hz\"\nduty = 0.5");
    folder.file("rig.toml", &rig);
    let by_pwm =
        study.replace("[columns.command]\nname = \"U\"\nunit = \"\"\n", "") + "[pulses]\nbegins = \"200 ms\"\n";
    found(&folder, &by_pwm);
    holds(&folder, "valve.opening_delay", 4e-3, 0.05);
    std::fs::remove_dir_all(folder.path("out")).expect("it was there");
    for (text, words) in [
        (by_pwm.replace("200 ms", "200 mm"), "`pulses.begins` is \"200 mm\": that is a length"),
        (
            study.to_owned() + "[pulses]\nthreshold = 30.0\n",
            "the command lies between 0.1 and 24 and never crosses the threshold 30",
        ),
        (study.replace("unit = \"\"", "unit = \"bar\""), "`bar` is no unit of command"),
        (by_pwm.replace("[[run]]", "[[run]]\nset = { \"valve.kind\" = \"five-way\" }"), "do not pulse one coil"),
        (by_pwm.replace("200 ms", "3 s"), "after any of 0 times the coil was energised"),
    ] {
        let printed = refused(&folder, &text);
        assert!(printed.contains(words), "`{words}` is not in\n{printed}");
    }
    folder.file("rig.toml", RIG);
    let printed = refused(&folder, &by_pwm);
    assert!(printed.contains("nothing says when the coil was energised"), "{printed}");
    // A sensor that ends at 3 bar.
    let rows: String = table
        .lines()
        .skip(1)
        .map(|line| line.split_once(',').expect("two cells"))
        .map(|(time, pressure)| format!("{time},{}\n", pressure.parse::<f64>().expect("a number").min(3e5)))
        .collect();
    folder.file("rig.toml", &rig);
    folder.file("run.csv", &format!("t_s,P_Pa\n{rows}"));
    let printed = refused(&folder, &by_pwm.replace("200 ms", "0 s"));
    assert!(printed.contains("while the valve is pulsed: the sensor is at its end"), "{printed}");
}
