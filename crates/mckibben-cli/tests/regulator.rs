//! `mckibben simulate` on a pressure regulator: its columns, its summary, its figure, and mistakes.

use crate::common::{Folder, of_repository};

fn example() -> String {
    of_repository("examples/valves/pressure-regulator.toml").display().to_string()
}

#[test]
fn the_file_shows_set_point_and_regulated_pressure() {
    let folder = Folder::new("regulator");
    let file = example();
    let arguments = ["simulate", "--verbose", file.as_str(), "-o", "run.csv", "-p", "run.svg"];
    let output = folder.mckibben().args(arguments).output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    for words in ["pressure regulator, 4 set points", "set-point", "gauge at the end", "Exergy of the air"] {
        assert!(printed.contains(words), "{words}:\n{printed}");
    }

    let mut reader = csv::Reader::from_path(folder.path("run.csv")).expect("a CSV file");
    let header = reader.headers().expect("a header").iter().collect::<Vec<_>>().join(",");
    assert!(
        header.ends_with("valve,regulated_absolute_pressure_pa,regulated_gauge_pressure_pa,set_point_pa"),
        "{header}"
    );
    let (mut rows, mut last) = (0, [0.0; 3]);
    for record in reader.records() {
        let record = record.expect("a row");
        let number = |column: usize| record[column].parse::<f64>().expect("a number");
        let [time, pressure, regulated, set_point] = [0, 3, 11, 13].map(number);
        let expected = match time {
            t if t < 0.1 => 0.0,
            t if t < 0.7 => 4e5,
            t if t < 1.0 => 4.3e5,
            t if t < 1.5 => 1.5e5,
            _ => 5e5,
        };
        assert!((set_point - expected).abs() <= 1e-9 * 101_325.0, "{set_point} at {time}");
        // It answers after its dead time of 10 ms.
        if time <= 0.11 {
            assert!((regulated - 101_325.0).abs() < 1e-6, "{regulated} at {time}");
        }
        (rows, last) = (rows + 1, [pressure, regulated, set_point]);
    }
    assert_eq!(rows, 2101);
    // 600 ms after the step only e^-10 of it or so is left; about it the actuator's own pressure swings with the mass.
    let [pressure, regulated, set_point] = last;
    assert!((regulated - 101_325.0 - set_point).abs() < 1e2 && (pressure - regulated).abs() < 5e3, "{last:?}");

    let svg = std::fs::read_to_string(folder.path("run.svg")).expect("written");
    for word in ["regulated", "set point", "gauge pressure"] {
        assert!(svg.contains(word), "{word}");
    }
    assert!(!svg.contains("supply open"));
}

/// The columns of a run by number.
fn rows(folder: &Folder, name: &str) -> Vec<Vec<f64>> {
    let mut reader = csv::Reader::from_path(folder.path(name)).expect("a CSV file");
    let numbers = |record: csv::StringRecord| record.iter().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
    reader.records().map(|record| numbers(record.expect("a row"))).collect()
}

#[test]
fn fixed_steps_write_the_same_and_a_sweep_its_rows() {
    let folder = Folder::new("stepped-regulator");
    let file = example();
    let fixed = |step: &'static str| ["--set", "run.engine=fixed-step", "--set", step];
    let (stepped, coarse) = (fixed("run.step=0.1 ms"), fixed("run.step=0.2 ms"));
    for (name, more) in [("located.csv", &[][..]), ("stepped.csv", &stepped), ("coarse.csv", &coarse)] {
        let arguments = [&["simulate", file.as_str(), "-o", name], more].concat();
        let output = folder.mckibben().args(arguments).output().expect("the program runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let located = rows(&folder, "located.csv");
    let most_off = |name: &str, column: usize| {
        let rows = rows(&folder, name);
        assert_eq!(rows.len(), located.len());
        rows.iter().zip(&located).map(|(row, exact)| (row[column] - exact[column]).abs()).fold(0.0, f64::max)
    };
    // The set point is known; the regulated pressure and the actuator's are states, as near as the step.
    for (column, within) in [(11, 0.3), (13, 1e-9), (3, 50.0)] {
        let off = most_off("stepped.csv", column);
        assert!(off <= within, "column {column}: {off}");
    }
    let ratio = most_off("coarse.csv", 11) / most_off("stepped.csv", 11);
    assert!((ratio - 4.0).abs() < 0.2, "the method has order 2: {ratio}");

    let text = std::fs::read_to_string(&file).expect("the example");
    let sweep = "engine = \"fixed-step\"\nstep = \"0.2 ms\"\n[sweep]\nreductions = [\"absolute_pressure.final\"]\n[sweep.vary]\n\
                 \"valve.rate_limit\" = [\"10 bar/s\", \"15 bar/s\"]\n";
    let swept = folder.file("swept.toml", &(text + sweep)).display().to_string();
    let arguments = ["sweep", swept.as_str(), "-o", "swept.csv"];
    let output = folder.mckibben().args(arguments).output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let lines = std::fs::read_to_string(folder.path("swept.csv")).expect("written");
    for rate in ["10 bar/s", "15 bar/s"] {
        let limit = format!("valve.rate_limit={rate}");
        let arguments = [
            &["simulate", file.as_str(), "-o", "one.csv", "--set", limit.as_str()][..],
            &["--set", "run.engine=fixed-step", "--set", "run.step=0.2 ms"],
        ];
        let output = folder.mckibben().args(arguments.concat()).output().expect("the program runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let last = rows(&folder, "one.csv").pop().expect("rows")[3];
        assert!(lines.contains(&format!("{last:?}")), "{last:?} of {rate}:\n{lines}");
    }
}

#[test]
fn what_a_regulator_cannot_give_is_refused() {
    let folder = Folder::new("no-regulator");
    let arguments = ["simulate", &example(), "--set", "supply.gauge_pressure=3 bar"];
    let output = folder.mckibben().args(arguments).output().expect("the program runs");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && said.contains("cannot give more than feeds it"), "{said}");
}

/// The regulator brings its pressure to the set point with its own time constant: that is one pole of the linear model.
#[test]
fn its_linear_model_has_the_set_point_as_an_input() {
    let folder = Folder::new("linear-regulator");
    let arguments = ["linearize", &example(), "-o", "model.json"];
    let output = folder.mckibben().args(arguments).output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let model = std::fs::read_to_string(folder.path("model.json")).expect("written");
    let model: serde_json::Value = serde_json::from_str(&model).expect("JSON");
    assert_eq!(model["inputs"][0]["name"], "set_point");
    let states = model["states"].as_array().expect("states");
    let row = states.iter().position(|state| state["name"] == "regulated_pressure").expect("a state");
    let column: Vec<f64> = (0..states.len()).map(|n| model["A"][row][n].as_f64().expect("a number")).collect();
    // Its rate is (u − p)/τ, whatever is behind it.
    assert_eq!(model["B"][row][0].as_f64(), Some(-column[row]));
    assert!(column.iter().enumerate().all(|(n, entry)| n == row || *entry == 0.0), "{column:?}");
    assert!(
        model["poles"]
            .as_array()
            .expect("poles")
            .iter()
            .any(|pole| { pole["real_1_s"].as_f64().is_some_and(|real| (real / column[row] - 1.0).abs() < 1e-9) })
    );
}
