//! Units that are mistaken: readings that the scenario cannot have are refused or doubted, and values of the start are named as the file
//! has them; and runs whose files have equal stems.

use super::identify;
use crate::common::{Folder, of_repository};

const SCENARIO: &str = "[actuator]\npreset = \"colbrunn-2001\"\n[supply]\ngauge_pressure = \"100 psi\"\n[valve]\npreset = \"matrix-eight-channel\"\n\
    [command]\nkind = \"pwm\"\nfrequency = \"10 Hz\"\nduty = 0.45\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n\
    [initial]\ngauge_pressure = \"40 psi\"\n[run]\nduration = \"0.2 s\"\nsample_interval = \"1 ms\"\n";

/// A study of the records of the scenario, whose columns have these units.
fn study([length, pressure]: [&str; 2], more: &str) -> String {
    format!(
        "[study]\nkind = \"trajectories\"\nscenario = \"muscle.toml\"\ninput = \"gauge-pressure\"\n{more}\
         [columns.time]\nname = \"time_s\"\nunit = \"s\"\n[columns.length]\nname = \"length_m\"\nunit = \"{length}\"\n\
         [columns.gauge_pressure]\nname = \"gauge_pressure_pa\"\nunit = \"{pressure}\"\n[[run]]\nfile = \"run.csv\"\n\
         [search]\nmost_steps = 2\nmore_starts = 0\n\
         [fit.\"actuator.friction.viscous\"]\nstart = \"5 N*s/m\"\nfrom = \"0.1 N*s/m\"\nto = \"50 N*s/m\"\n"
    )
}

/// All that the program prints, without its line breaks.
fn said(folder: &Folder, study: &str) -> String {
    ended(folder, study).1
}

/// How the program ends, and all that it prints, without its line breaks.
fn ended(folder: &Folder, study: &str) -> (Option<i32>, String) {
    let output = identify(folder, &folder.file("study.toml", study));
    let text = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
    (output.status.code(), text.split_whitespace().collect::<Vec<_>>().join(" "))
}

#[test]
fn readings_that_the_scenario_cannot_have_are_doubted() {
    let folder = Folder::new("identify-units");
    folder.file("muscle.toml", SCENARIO);
    let simulate = ["simulate", "muscle.toml", "--output", "run.csv"];
    let output = folder.mckibben().args(simulate).output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    const DOUBT: &str = "are the units right?";
    let length = "The column `length_m` with the length reads";
    let pressure = "The column `gauge_pressure_pa` with the gauge pressure reads";
    for (units, is_refused, column, others) in [
        (["mm", "Pa"], true, length, [" mm, but in the scenario the muscle is ", "`unit` in [columns.length]"]),
        (["km", "Pa"], true, length, [" km, but in the scenario the muscle is ", "`unit` in [columns.length]"]),
        (
            ["m", "mPa"],
            false,
            pressure,
            [" mPa, but in the scenario the highest supply has 6.895 bar gauge", "`unit` in [columns.gauge_pressure]"],
        ),
        (
            ["m", "kPa"],
            false,
            pressure,
            [" kPa, but in the scenario the highest supply", "`units_are_right = true` in [study]"],
        ),
    ] {
        let (code, text) = ended(&folder, &study(units, ""));
        assert_eq!(code == Some(2), is_refused, "{units:?}: {text}");
        // What is printed is without backquotes, and an error has them.
        let text = text.replace('`', "");
        assert_eq!(text.matches(DOUBT).count(), 1, "{units:?}: {text}");
        let words = [column, others[0], others[1]].map(|words| words.replace('`', ""));
        assert!(words.iter().all(|words| text.contains(words.as_str())), "{units:?}: {text}");
        let right = said(&folder, &study(units, "units_are_right = true\n"));
        assert!(!right.contains(DOUBT), "{units:?}: {right}");
    }
    let none = said(&folder, &study(["m", "Pa"], ""));
    assert!(!none.contains(DOUBT), "{none}");
}

/// A table with changed numbers: `change` gets the head and a row.
fn changed(table: &str, change: impl Fn(&[&str], &mut Vec<f64>)) -> String {
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let head = lines.next().expect("a head");
    let names: Vec<&str> = head.split(',').collect();
    let mut text = head.to_owned() + "\n";
    for line in lines {
        // Words, such as the state of the valve, are no readings.
        let mut row: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
        change(&names, &mut row);
        text += &(row.iter().map(f64::to_string).collect::<Vec<_>>().join(",") + "\n");
    }
    text
}

/// The place of a column.
fn of(names: &[&str], name: &str) -> usize {
    names.iter().position(|of| *of == name).unwrap_or_else(|| panic!("{name} is not in {names:?}"))
}

/// A simulated record of a scenario file.
fn simulated(folder: &Folder, scenario: &str) -> String {
    let output = folder.mckibben().args(["simulate", scenario, "--output", "run.csv"]).output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    std::fs::read_to_string(folder.path("run.csv")).expect("a table")
}

#[test]
fn times_and_pressures_that_begin_elsewhere_are_doubted() {
    let folder = Folder::new("identify-begins");
    folder.file("muscle.toml", SCENARIO);
    let table = simulated(&folder, "muscle.toml");
    let driven = study(["m", "Pa"], "");
    let fed = driven.replace("input = \"gauge-pressure\"\n", "");
    let at = |name: &'static str, study: &str, change: fn(f64) -> f64| {
        folder.file("run.csv", &changed(&table, |names, row| row[of(names, name)] = change(row[of(names, name)])));
        said(&folder, study).replace('`', "")
    };
    let late = at("time_s", &driven, |time| time + 100.0);
    assert!(late.contains("run: times begin at 100.0 s, after the end of the scenario's run of 200.0 ms"), "{late}");
    assert!(late.contains("set offset = \"100.0 s\" in [columns.time]"), "{late}");
    // An error of another kind has the doubt too.
    let other = at("time_s", &driven.replace("friction.viscous", "friction.nothing"), |time| time + 100.0);
    assert!(other.contains("friction.nothing") && other.contains("times begin at 100.0 s"), "{other}");
    let milliseconds = at("time_s", &driven, |time| 1e3 * time);
    assert!(milliseconds.contains("reads 0 to 200 s, but in the scenario the run lasts 200.0 ms"), "{milliseconds}");
    let absolute = at("gauge_pressure_pa", &fed, |pressure| pressure + 101_325.0);
    assert!(absolute.contains("if the pressure is absolute, name it [columns.absolute_pressure]"), "{absolute}");
    // Advice after a bad fit comes after that about units.
    assert!(!absolute.contains("a sensor that drifts") && !absolute.contains("more_starts"), "{absolute}");
    let right = at("time_s", &fed, |time| time);
    assert!(!right.contains("times begin") && !right.contains("are the units right"), "{right}");
}

#[test]
fn lengths_of_a_ring_down_in_another_unit_are_refused() {
    let folder = Folder::new("identify-ring-units");
    folder.file("muscle.toml", SCENARIO);
    simulated(&folder, "muscle.toml");
    let study = "[study]\nkind = \"ring-down\"\nscenario = \"muscle.toml\"\n[columns.time]\nname = \"time_s\"\nunit = \"s\"\n\
                 [columns.length]\nname = \"length_m\"\nunit = \"mm\"\n[[run]]\nfile = \"run.csv\"\n";
    let (code, text) = ended(&folder, study);
    assert!(code == Some(2) && text.contains("mm, but in the scenario the muscle is"), "{code:?}: {text}");
}

const LOOPS: &str = "[actuator]\npreset = \"colbrunn-2001\"\n[actuator.friction]\nviscous = \"0 N*s/m\"\ncoulomb_width = \"0 m\"\n\
    [actuator.friction.hysteresis]\nlaw = \"maxwell-slip\"\nreach = [\"0.05 mm\", \"0.2 mm\"]\nstiffness_ratio = [0.8, 0.2]\n\
    [air]\nprocess = \"isothermal\"\n[load]\nkind = \"prescribed-motion\"\ntime = [\"0 s\", \"10 s\", \"20 s\", \"25 s\"]\n\
    table_length = [\"86 mm\", \"88 mm\", \"86 mm\", \"87 mm\"]\n[initial]\ngauge_pressure = \"60 psi\"\n\
    [run]\nduration = \"25 s\"\nsample_interval = \"50 ms\"\n";

fn of_loops([length, pressure, tension]: [&str; 3]) -> String {
    format!(
        "[study]\nkind = \"hysteresis\"\nscenario = \"muscle.toml\"\n[columns.time]\nname = \"time_s\"\nunit = \"s\"\n\
         [columns.length]\nname = \"length_m\"\nunit = \"{length}\"\n[columns.gauge_pressure]\nname = \"gauge_pressure_pa\"\n\
         unit = \"{pressure}\"\n[columns.tension]\nname = \"tension_n\"\nunit = \"{tension}\"\n[[run]]\nfile = \"run.csv\"\n\
         [fit.\"actuator.friction.hysteresis.stiffness_ratio[0]\"]\n"
    )
}

/// Loops took any unit: kilopascals for bar left kilonewtons of a muscle of 60 N, and no warning.
#[test]
fn loops_in_other_units_are_refused() {
    let folder = Folder::new("identify-loop-units");
    folder.file("muscle.toml", LOOPS);
    let table = simulated(&folder, "muscle.toml");
    let si = ["m", "Pa", "N"];
    let (code, text) = ended(&folder, &of_loops(si));
    assert_eq!(code, Some(0), "{text}");
    assert!(!text.contains("is more than its readings scatter"), "{text}");
    assert!(!text.contains("not used"), "{text}");
    let warm = "[columns.temperature]\nname = \"temperature_k\"\nunit = \"K\"\n";
    let (code, text) = ended(&folder, &format!("{}{warm}", of_loops(si)));
    let unused = "the temperature is not used: a study of the kind \"hysteresis\" does not read it";
    assert!(code == Some(0) && text.contains(unused), "{code:?} {text}");
    for (units, words) in [
        (["m", "mbar", "N"], "the gauge pressure is in Pa, where mbar was said"),
        (["m", "Pa", "lbf"], "the tension is in N, where lbf was said"),
        (["mm", "Pa", "N"], "mm, but in the scenario the muscle is"),
    ] {
        let (code, text) = ended(&folder, &of_loops(units));
        assert!(code == Some(2) && text.contains(words), "{units:?}: {code:?} {text}");
    }
    let reversed = changed(&table, |names, row| row[of(names, "tension_n")] *= -1.0);
    let swapped = changed(&table, |names, row| {
        let [length, tension] = ["length_m", "tension_n"].map(|name| of(names, name));
        (row[length], row[tension]) = (1e-3 * row[tension], 1e3 * row[length]);
    });
    // A tenth more is no unit, but is more than noise.
    let scaled = changed(&table, |names, row| row[of(names, "tension_n")] *= 1.1);
    for (table, expected, words) in [
        (reversed, 2, "is their sign reversed?"),
        (swapped, 2, "are the columns of length and tension swapped?"),
        (scaled, 0, "is more than its readings scatter from one to the next"),
    ] {
        folder.file("run.csv", &table);
        let (code, text) = ended(&folder, &of_loops(si));
        assert!(code == Some(expected) && text.contains(words), "{words}: {code:?} {text}");
    }
}

/// A force map of a braid of 0.87 of the ideal, with the pressure in other units; and lengths.
fn map(pressure: fn(f64) -> f64) -> String {
    let mut text = "P,L,F\n".to_owned();
    for row in 0..20 {
        let (pascal, length) = (1e5 * (1 + row / 5) as f64, 0.3 - 0.012 * (row % 5) as f64);
        let (thread, turns) = (0.342_f64, 2.6_f64);
        let ideal = pascal * (3.0 * length * length - thread * thread) / (4.0 * std::f64::consts::PI * turns * turns);
        let noise = 0.2 * (12.9898 * f64::from(row)).sin();
        text += &format!("{},{length},{}\n", pressure(pascal), 0.87 * ideal + noise);
    }
    text
}

const MAP: &str = "[study]\nkind = \"force-map\"\nscenario = \"muscle.toml\"\n[columns.gauge_pressure]\nname = \"P\"\nunit = \"Pa\"\n\
    [columns.length]\nname = \"L\"\nunit = \"m\"\n[columns.tension]\nname = \"F\"\nunit = \"N\"\n[[run]]\nfile = \"map.csv\"\n";
const BRAID: &str = "[actuator]\nthread_length = \"0.342 m\"\nturns = 2.6\nmax_length = \"301 mm\"\n\
    [load]\nkind = \"hanging-mass\"\nmass = \"5 kg\"\n[initial]\ngauge_pressure = \"3 bar\"\n[run]\nduration = \"1 s\"\n";

#[test]
fn a_force_map_in_other_units_is_refused_or_doubted() {
    let folder = Folder::new("identify-map-units");
    folder.file("muscle.toml", BRAID);
    let with = |pressure: fn(f64) -> f64| {
        folder.file("map.csv", &map(pressure));
        ended(&folder, MAP)
    };
    const ABSOLUTE: &str = "which is about that of the atmosphere";
    let (code, text) = with(|pascal| pascal);
    assert!(code == Some(0) && !text.contains(ABSOLUTE) && !text.contains("ideal braid's"), "{code:?}: {text}");
    let (code, text) = with(|pascal| pascal / 6_894.757);
    assert!(code == Some(2) && text.contains("the gauge pressure is in psi, where Pa was said"), "{code:?}: {text}");
    // Of no unit, but of no muscle either.
    let (code, text) = with(|pascal| pascal / 37.0);
    assert!(code == Some(2) && text.contains("of the ideal braid's, which no muscle is"), "{code:?}: {text}");
    let (code, text) = with(|pascal| pascal + 101_325.0);
    assert!(code == Some(0) && text.contains(ABSOLUTE), "{code:?}: {text}");
    assert!(text.contains("name it [columns.absolute_pressure]"), "{text}");
}

/// What failed in one way is said once, on standard error.
#[test]
fn a_force_map_that_fails_says_why_once() {
    let folder = Folder::new("identify-map-once");
    folder.file("muscle.toml", BRAID);
    let table = map(|pascal| pascal);
    let first: Vec<&str> = table.lines().take(2).collect();
    folder.file("map.csv", &(first.join("\n") + "\n"));
    let output = identify(&folder, &folder.file("study.toml", MAP));
    assert_eq!(output.status.code(), Some(3));
    let [printed, error] = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert!(printed.contains("Nothing was found") && !printed.contains("cannot determine"), "{printed}");
    let words = error.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("not fitted: 1 measurements cannot determine"), "{words}");
    let page = std::fs::read_to_string(folder.path("out/index.html")).expect("a page");
    for unknowns in 1..12 {
        let why = format!("cannot determine {unknowns} unknowns");
        assert!(words.matches(&why).count() <= 1 && page.matches(&why).count() <= 1, "{why}: {words}");
    }
}

#[test]
fn a_tank_is_refused_in_the_unit_of_its_column() {
    let folder = Folder::new("identify-tank-units");
    for name in ["tank.toml", "rig.toml", "discharge.csv"] {
        let text = std::fs::read_to_string(of_repository(&format!("examples/identify/{name}"))).expect("a file");
        // The last reading as a gauge pressure has it.
        folder.file(name, &text.replace("1.5,139.2", "1.5,0.4"));
    }
    let (code, text) = ended(&folder, &std::fs::read_to_string(folder.path("tank.toml")).expect("a study"));
    assert!(code == Some(2) && text.contains("`P` with the absolute pressure reads 0.4 kPa"), "{code:?}: {text}");
    assert!(text.contains("name it `[columns.gauge_pressure]`") && !text.contains("100000 Pa"), "{text}");
}

/// Files of equal stems in two folders are two runs, each with a value and a scenario.
#[test]
fn files_of_equal_stems_are_two_runs() {
    let folder = Folder::new("identify-days");
    folder.file("muscle.toml", SCENARIO);
    let table = simulated(&folder, "muscle.toml");
    for day in ["day1", "day2"] {
        std::fs::create_dir(folder.path(day)).expect("a folder");
        std::fs::write(folder.path(day).join("rig.csv"), &table).expect("a table");
    }
    let study = study(["m", "Pa"], "")
        .replace("file = \"run.csv\"", "file = \"day1/rig.csv\"\n[[run]]\nfile = \"day2/rig.csv\"")
        + "per_run = true\n";
    let (code, text) = ended(&folder, &study);
    assert_eq!(code, Some(0), "{text}");
    let values = std::fs::read_to_string(folder.path("out/values.csv")).expect("values");
    for run in ["day1/rig", "day2/rig"] {
        assert_eq!(values.matches(&format!("[{run}]")).count(), 1, "{values}");
    }
}

#[test]
fn a_start_outside_its_range_is_named_as_the_file_has_it() {
    let folder = Folder::new("identify-joint-name");
    let [scenario, data] = ["examples/plant/arm.toml", "examples/identify/arm.csv"].map(of_repository);
    let study = format!(
        "[study]\nkind = \"trajectories\"\nscenario = {scenario:?}\n[columns.time]\nname = \"t\"\nunit = \"s\"\n\
         [columns.\"shoulder.angle\"]\nname = \"shoulder\"\nunit = \"deg\"\n[[run]]\nfile = {data:?}\n\
         [fit.\"mechanism.joints.elbow.damping\"]\nstart = \"-1 N*m*s/rad\"\n"
    );
    let text = said(&folder, &study);
    assert!(text.contains("mechanism.joints.elbow.damping = -1 N*m*s/rad is outside its range"), "{text}");
}

/// Times of a clock made a run of half a century.
#[test]
fn times_of_a_clock_are_refused_at_once() {
    let folder = Folder::new("identify-clock");
    folder.file("muscle.toml", SCENARIO);
    let table = simulated(&folder, "muscle.toml");
    let late = changed(&table, |names, row| row[of(names, "time_s")] += 1.7e9);
    folder.file("run.csv", &late);
    let (code, text) = ended(&folder, &study(["m", "Pa"], ""));
    assert!(code == Some(2) && text.contains("times begin at"), "{code:?}: {text}");
    assert!(text.contains("set `offset = \"1700000000.0 s\"` in [columns.time]"), "{text}");
}

/// A sealed muscle of 40 psi gauge needs no supply.
#[test]
fn a_pressure_is_compared_with_that_of_a_sealed_muscle() {
    const SEALED: &str = "[actuator]\npreset = \"colbrunn-2001\"\n[load]\nkind = \"hanging-mass\"\nmass = \"5 lb\"\n\
        [initial]\nlength = \"86 mm\"\ngauge_pressure = \"40 psi\"\n[run]\nduration = \"0.2 s\"\nsample_interval = \"1 ms\"\n";
    let folder = Folder::new("identify-sealed-units");
    folder.file("muscle.toml", SEALED);
    simulated(&folder, "muscle.toml");
    let fed = |pressure: &str| study(["m", pressure], "").replace("input = \"gauge-pressure\"\n", "");
    let text = said(&folder, &fed("kPa"));
    assert!(text.contains("in the scenario the sealed muscle begins at 2.758 bar gauge"), "{text}");
    let text = said(&folder, &fed("Pa"));
    assert!(!text.contains("are the units right"), "{text}");
    // A pressure that drives the run is not the scenario's.
    let text = said(&folder, &study(["m", "kPa"], ""));
    assert!(!text.contains("sealed muscle"), "{text}");
}

#[test]
fn gauge_pressures_that_are_called_absolute_are_doubted() {
    let folder = Folder::new("identify-map-gauge");
    folder.file("muscle.toml", BRAID);
    let study = MAP.replace("gauge_pressure", "absolute_pressure");
    folder.file("map.csv", &map(|pascal| pascal));
    let text = said(&folder, &study);
    assert!(text.contains("which is about a vacuum"), "{text}");
    assert!(text.contains("name it [columns.gauge_pressure]"), "{text}");
    folder.file("map.csv", &map(|pascal| pascal + 101_325.0));
    let (code, text) = ended(&folder, &study);
    assert!(code == Some(0) && !text.contains("about a vacuum"), "{code:?}: {text}");
}

/// A load cell that ends at 300 N: the braid pulls up to 627 N.
#[test]
fn a_force_map_of_a_saturated_load_cell_is_refused() {
    let folder = Folder::new("identify-map-end");
    folder.file("muscle.toml", BRAID);
    let clipped = changed(&map(|pascal| pascal), |names, row| {
        let tension = of(names, "F");
        row[tension] = row[tension].min(300.0);
    });
    folder.file("map.csv", &clipped);
    let (code, text) = ended(&folder, MAP);
    assert!(code == Some(2) && text.contains("tensions are exactly 300 N, the largest"), "{code:?}: {text}");
    assert!(text.contains("set `saturates = \"300 N\"` in [columns.tension]"), "{text}");
    let stated = MAP.replace("unit = \"N\"\n", "unit = \"N\"\nsaturates = \"300 N\"\n");
    let (code, text) = ended(&folder, &stated);
    assert!(code == Some(0) && text.contains("at the end of the sensor were left out"), "{code:?}: {text}");
}

#[test]
fn a_saturation_that_leaves_nothing_is_refused() {
    let folder = Folder::new("identify-lower-end");
    folder.file("muscle.toml", SCENARIO);
    simulated(&folder, "muscle.toml");
    let study = study(["m", "Pa"], "").replace("unit = \"m\"\n", "unit = \"m\"\nsaturates = \"50 mm\"\n");
    let (code, text) = ended(&folder, &study);
    assert!(code == Some(2) && text.contains("`saturates` in [columns.length] leaves none"), "{code:?}: {text}");
    assert!(text.contains("empty these cells"), "{text}");
}

#[test]
fn a_start_outside_its_bounds_is_refused() {
    let folder = Folder::new("identify-start");
    folder.file("muscle.toml", SCENARIO);
    simulated(&folder, "muscle.toml");
    let study = study(["m", "Pa"], "").replace("start = \"5 N*s/m\"", "start = \"100 N*s/m\"");
    let (code, text) = ended(&folder, &study);
    let words = "`start` of `actuator.friction.viscous` in [fit] is 100";
    assert!(code == Some(2) && text.contains(words), "{code:?}: {text}");
    assert!(text.contains("above its largest value of 50"), "{text}");
}
