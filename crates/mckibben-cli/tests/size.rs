//! `mckibben size`: its muscles meet the request, by closed forms and by `mckibben simulate`.

use crate::common::Folder;
use std::f64::consts::PI;
use std::process::Output;

const OPTIONS: [&str; 7] = ["size", "--load", "5 kg", "--stroke", "30 mm", "--gauge-pressure", "4 bar"];
const GRAVITY: f64 = 9.80665;

fn text(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn size(folder: &Folder, more: &[&str]) -> Output {
    folder.mckibben().args(OPTIONS).args(more).output().expect("it runs")
}

/// A table of numbers with the names of its columns.
struct Numbers(Vec<String>, Vec<Vec<f64>>);

impl Numbers {
    fn read(folder: &Folder, name: &str) -> Self {
        let mut reader = csv::Reader::from_path(folder.path(name)).expect("a table");
        let head = reader.headers().expect("a head").iter().map(str::to_owned).collect();
        let row = |row: csv::StringRecord| row.iter().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
        Self(head, reader.records().map(|it| row(it.expect("a row"))).collect())
    }

    fn at(&self, row: usize, column: &str) -> f64 {
        self.1[row][self.0.iter().position(|name| name == column).expect("a column")]
    }
}

/// The paper's (3) of each braid that was made to measure gives the load at the end of the stroke, and the ranks are by air.
#[test]
fn braids_made_to_measure_hold_the_load_at_the_stroke() {
    let folder = Folder::new("size-braids");
    let printed =
        text(&size(&folder, &["--braid-angles", "20,25,30", "--effectiveness", "0.8", "--output", "sizes.csv"]));
    let table = Numbers::read(&folder, "sizes.csv");
    let mut made = 0;
    for row in 0..table.1.len() {
        let of = |column: &str| table.at(row, column);
        assert!(row == 0 || of("air_kg") >= table.at(row - 1, "air_kg"));
        assert!(of("contraction") * of("length_m") > 0.03 * (1.0 - 1e-5), "{printed}");
        let (thread, turns, length) = (of("thread_length_m"), of("turns"), of("length_m"));
        let angle = (length / thread).acos().to_degrees();
        if of("count") == 1.0 && [20.0, 25.0, 30.0].iter().any(|options| (angle - options).abs() < 1e-6) {
            made += 1;
            let end: f64 = length - 0.03;
            let force = 0.8 * 4e5 * thread * thread / (4.0 * PI * turns * turns) * (3.0 * (end / thread).powi(2) - 1.0);
            assert!((force / (5.0 * GRAVITY) - 1.0).abs() < 1e-5, "{force}");
            let diameter = thread * angle.to_radians().sin() / (PI * turns);
            assert!((of("diameter_m") / diameter - 1.0).abs() < 1e-6);
            // By the volume of the cylinder and the 3 cm³ outside that a file without `external_volume` has.
            let inside = |length: f64| length * (thread * thread - length * length) / (4.0 * PI * turns * turns);
            let volume = |length: f64| inside(length) + 3e-6;
            let air = (501_325.0 * volume(end) - 101_325.0 * volume(length)) / (286.99 * 293.15);
            assert!((of("air_kg") / air - 1.0).abs() < 1e-4, "{} {air}", of("air_kg"));
        }
    }
    assert_eq!(made, 3, "{printed}");
}

/// The valve that is named lifts the load over nine tenths of the stroke in the time, by the run of the scenario that is written.
#[test]
fn the_valve_is_quick_enough_and_not_wider_than_need_be() {
    let folder = Folder::new("size-valve");
    let options = ["--time", "0.3 s", "--braid-angles", "25", "--scenario", "muscle.toml", "--hose", "2 m"];
    let printed = text(&size(&folder, &options));
    assert!(printed.contains("Named valves") && printed.contains("hose, inner diameter mm"), "{printed}");
    let scenario = std::fs::read_to_string(folder.path("muscle.toml")).expect("a scenario");
    let written = |key: &str| -> f64 {
        let start = format!("{key} = \"");
        let text = scenario.lines().find_map(|line| line.strip_prefix(&start)).expect("a key");
        text.split(' ').next().and_then(|number| number.parse().ok()).expect("a number")
    };
    let reached = |set: &str| {
        let simulate = ["simulate", "muscle.toml", "--set", "run.duration=0.3 s", "--set", set, "--output", "run.csv"];
        text(&folder.mckibben().args(simulate).output().expect("it runs"));
        let run = Numbers::read(&folder, "run.csv");
        let lengths: Vec<f64> = (0..run.1.len()).map(|row| run.at(row, "length_m")).collect();
        1e-3 * written("length") - lengths.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let way = reached("run.sample_interval=1 ms");
    assert!((way / 0.027 - 1.0).abs() < 2e-3, "{way}");
    let least = written("sonic_conductance");
    assert!(reached(&format!("valve.sonic_conductance={} L/(min*bar)", 0.97 * least)) < 0.027);
}

/// On the orbit of the scenario that is written the length swings as much as was allowed, about the middle of the stroke, and at a
/// lower frequency more. Nothing damps the load.
#[test]
fn pulses_keep_the_muscle_as_still_as_requested() {
    let folder = Folder::new("size-ripple");
    let options = [
        "--time",
        "0.3 s",
        "--ripple",
        "0.2 mm",
        "--braid-angles",
        "25",
        "--scenario",
        "muscle.toml",
        "--output",
        "sizes.csv",
    ];
    let printed = text(&size(&folder, &options));
    let table = Numbers::read(&folder, "sizes.csv");
    let frequency = table.at(0, "pwm_frequency_hz");
    assert!(frequency > 1.0 && (0.1..0.9).contains(&table.at(0, "pwm_duty")), "{printed}");
    let settled = |set: &str| {
        let simulate = ["simulate", "muscle.toml", "--set", set, "--settle", "--format", "json"];
        let all: serde_json::Value =
            serde_json::from_str(&text(&folder.mckibben().args(simulate).output().expect("it runs"))).expect("JSON");
        assert_eq!(all["settled"]["settled"], true, "{all}");
        ["length_mean_m", "length_ripple_m"].map(|name| all["settled"]["numbers"][name].as_f64().expect("a number"))
    };
    let [mean, ripple] = settled("run.duration=0.5 s");
    assert!((ripple / 2e-4 - 1.0).abs() < 0.05, "{ripple} m, {printed}");
    assert!((mean - (table.at(0, "length_m") - 0.015)).abs() < 1e-3, "{mean} m");
    let [_, more] = settled(&format!("command.frequency={} Hz", 0.8 * frequency));
    assert!(more > 1.2 * ripple, "{more} m for {ripple} m");
}

#[test]
fn limits_are_kept_or_named() {
    let folder = Folder::new("size-limits");
    let printed = text(&size(&folder, &["--most-diameter", "5 mm", "--braid-angles", "25", "--output", "sizes.csv"]));
    let table = Numbers::read(&folder, "sizes.csv");
    assert!(table.1.len() == 1 && table.at(0, "count") == 2.0 && table.at(0, "diameter_m") <= 5e-3, "{printed}");
    assert!(printed.contains("festo-dmsp-10-250 is longer or wider than allowed"), "{printed}");
    // The row has the muscle's name as the printed table does, and the angle of its braid.
    let csv = std::fs::read_to_string(folder.path("sizes.csv")).expect("a table");
    assert!(csv.lines().nth(1).is_some_and(|row| row.split(',').nth(1) == Some("braid of 25°")), "{csv}");
    assert!((table.at(0, "braid_angle_rad") - 25_f64.to_radians()).abs() < 1e-7, "{csv}");
    let printed = text(&size(&folder, &["--most-length", "100 mm"]));
    assert!(printed.contains("a braid of 35° must be at least") && printed.contains("100.0"), "{printed}");
}

/// Without pressure a muscle hangs on its taut braid, whose spring the threads' length ends: two tonnes pull it straight. Then there
/// is no lift from rest, and so no valve.
#[test]
fn a_muscle_without_a_valve_is_named_with_the_reason() {
    let folder = Folder::new("size-without-valve");
    let heavy = ["size", "--load", "2000 kg", "--stroke", "30 mm", "--gauge-pressure", "4 bar"];
    let options = ["--time", "0.3 s", "--braid-angles", "25", "--output", "sizes.csv"];
    let size = |more: &[&str]| folder.mckibben().args(heavy).args(options).args(more).output().expect("it runs");
    let printed = text(&size(&[]));
    assert!(printed.contains("cannot hang unfilled"), "{printed}");
    let printed = text(&size(&["--pick", "1"]));
    let printed = printed.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        printed.contains("No named valve: there is no valve for place") && !printed.contains("valve time ms"),
        "{printed}"
    );
    let output = size(&["--pick", "1", "--scenario", "muscle.toml"]);
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && error.contains("does not hold the load without pressure"), "{error}");
    assert_eq!(folder.names(), ["sizes.csv"]);
}

/// 25° are 0.4363 rad; a number without a unit has that of the next, and behind the last one degrees.
#[test]
fn angles_and_shares_are_read_with_their_units() {
    let folder = Folder::new("size-units");
    let of = |angles, share| text(&size(&folder, &["--braid-angles", angles, "--effectiveness", share]));
    let plain = of("25,30", "0.8");
    assert_eq!(of("25deg,30 deg", "80%"), plain);
    assert_eq!(of("25, 30deg", "80 %"), plain);
    let radians = of("0.4363323129985824,0.5235987755982988rad", "0.8");
    assert!(radians.contains("braid of 25°") && radians.contains("braid of 30°"), "{radians}");
}

#[test]
fn what_cannot_be_is_refused_in_words() {
    let folder = Folder::new("size-refused");
    for (more, words) in [
        (&["--braid-angles", "60"][..], "54.7 deg"),
        (&["--effectiveness", "0"], "`--effectiveness` is 0"),
        (&["--effectiveness", "80"], "80 % is 0.8"),
        (&["--effectiveness", "80 mm"], "write a number such as 0.8, or one in percent"),
        (&["--braid-angles", "25 mm"], "is no angle; write a unit such as deg or rad"),
        (&["--most-length", "31 mm", "--braid-angles", "25"], "no muscle does it"),
        (&["--output", "sizes.txt"], "end the name of --output with .csv"),
        (&["--pick", "99"], "and none of them is place 99"),
        (&["--pick", "0"], "give a place from 1 to"),
        (&["--time", "3 mm"], "is no time"),
        (&["--hose", "2 m"], "--time"),
        (&["--ripple", "0.1 mm"], "--time"),
        (&["--time", "0.3 s", "--ripple", "0 mm"], "`--ripple` is 0 m"),
    ] {
        let output = size(&folder, more);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && error.contains(words), "{more:?}: {error}");
    }
}
