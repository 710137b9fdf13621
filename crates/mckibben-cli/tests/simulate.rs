//! `mckibben simulate`: what it writes and prints, against the library that it calls.

use crate::common::{Folder, PULSES as PWM, of_repository};
use mckibben::plant::JointPlant;
use mckibben::simulation::simulate;
use mckibben_scenario::Document;
use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::RowAccessor as _;
use std::path::Path;

const HEADER: &str = "time_s,length_m,velocity_m_s,absolute_pressure_pa,gauge_pressure_pa,air_mass_kg,temperature_k,volume_m3,tension_n,mass_flow_kg_s,valve";

fn run(folder: &Folder, arguments: &[&str]) -> String {
    let output = folder.mckibben().args(arguments).output().expect("the program runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// The numbers of a row, and its valve.
type Row = ([f64; 10], String);

/// The rows of a CSV file.
fn rows(path: &Path) -> Vec<Row> {
    let mut reader = csv::Reader::from_path(path).expect("a CSV file");
    assert_eq!(reader.headers().expect("a header").iter().collect::<Vec<_>>().join(","), HEADER);
    let row = |record: csv::StringRecord| {
        let numbers = std::array::from_fn(|column| record[column].parse().expect("a number"));
        (numbers, record[10].to_owned())
    };
    reader.records().map(|record| row(record.expect("a row"))).collect()
}

#[test]
fn the_file_is_bit_identical_to_the_library() {
    let folder = Folder::new("bits");
    folder.file("muscle.toml", PWM);
    run(&folder, &["simulate", "muscle.toml", "--output", "run.csv"]);
    let written = rows(&folder.path("run.csv"));
    let experiment = Document::parse(PWM, "muscle.toml").expect("TOML").experiment().expect("good");
    let trajectory = simulate(&experiment.rig, experiment.start, 0.3, 1e-8).expect("runs");
    let samples: Vec<_> = trajectory.samples(1e-3).collect();
    assert_eq!((written.len(), samples.len()), (301, 301));
    for ((numbers, valve), s) in written.iter().zip(samples) {
        let gauge = s.pressure.0 - 101_325.0;
        let expected = [
            s.time,
            s.length,
            s.velocity,
            s.pressure.0,
            gauge,
            s.air_mass,
            s.temperature,
            s.volume,
            s.tension,
            s.mass_flow,
        ];
        assert_eq!(numbers.map(f64::to_bits), expected.map(f64::to_bits));
        assert_eq!(valve, s.ports.name());
    }
    assert_eq!(written[300].0[0], 0.3);
}

#[test]
fn the_end_has_its_row_even_between_intervals() {
    let folder = Folder::new("end");
    folder.file("muscle.toml", PWM);
    for engine in ["event-located", "fixed-step"] {
        let engine = format!("run.engine={engine}");
        run(&folder, &["simulate", "muscle.toml", "-s", "run.duration=10.5 ms", "-s", &engine, "-o", "run.csv"]);
        let times: Vec<f64> = rows(&folder.path("run.csv")).iter().map(|row| row.0[0]).collect();
        assert_eq!((times.len(), times[0], times[10], times[11]), (12, 0.0, 0.01, 0.0105), "{engine}");
    }
}

#[test]
fn parquet_and_csv_agree() {
    let folder = Folder::new("parquet");
    folder.file("muscle.toml", PWM);
    let set = ["--set", "command.duty=0.4"];
    run(&folder, &["simulate", "muscle.toml", "-o", "run.csv", set[0], set[1]]);
    run(&folder, &["simulate", "muscle.toml", "-o", "run.parquet", set[0], set[1]]);
    let file = std::fs::File::open(folder.path("run.parquet")).expect("written");
    let reader = SerializedFileReader::new(file).expect("a Parquet file");
    let metadata = reader.metadata().file_metadata();
    let names: Vec<&str> = metadata.schema_descr().columns().iter().map(|column| column.name()).collect();
    assert_eq!(names.join(","), HEADER);
    let pairs = metadata.key_value_metadata().expect("metadata");
    let value =
        |key: &str| pairs.iter().find(|pair| pair.key == key).and_then(|pair| pair.value.clone()).expect("there");
    assert_eq!(value("mckibben.version"), env!("CARGO_PKG_VERSION"));
    assert_eq!(value("mckibben.scenario"), PWM);
    assert_eq!(value("mckibben.set"), r#"["command.duty=0.4"]"#);
    assert!(value("mckibben.units").contains(r#""absolute_pressure_pa":"Pa""#));
    assert!(value("mckibben.resolved").contains("duty = 0.4"));
    let written = rows(&folder.path("run.csv"));
    assert_eq!(metadata.num_rows(), written.len() as i64);
    for (row, (numbers, valve)) in reader.get_row_iter(None).expect("rows").zip(&written) {
        let row = row.expect("a row");
        for (column, number) in numbers.iter().enumerate() {
            assert_eq!(row.get_double(column).expect("a number").to_bits(), number.to_bits());
        }
        assert_eq!(row.get_string(10).expect("a word").as_bytes(), valve.as_bytes());
    }
}

#[test]
fn the_same_run_gives_the_same_bytes() {
    let folder = Folder::new("bytes");
    folder.file("muscle.toml", PWM);
    for ending in ["csv", "parquet", "svg", "png"] {
        let option = if matches!(ending, "csv" | "parquet") { "--output" } else { "--plot" };
        let [one, two] = ["one", "two"].map(|name| format!("{name}.{ending}"));
        for name in [&one, &two] {
            run(&folder, &["simulate", "muscle.toml", "--quiet", option, name]);
        }
        let bytes = |name: &str| std::fs::read(folder.path(name)).expect("written");
        assert_eq!(bytes(&one), bytes(&two), "{ending}");
    }
}

#[test]
fn set_changes_the_run() {
    let folder = Folder::new("set");
    folder.file("muscle.toml", PWM);
    run(&folder, &["simulate", "muscle.toml", "-o", "light.csv", "--set", "load.mass=1 lb"]);
    run(&folder, &["simulate", "muscle.toml", "-o", "heavy.csv", "--set", "load.mass=\"15 lb\""]);
    let tension = |name: &str| rows(&folder.path(name))[0].0[8];
    let pound = 0.453_592_37 * 9.806_65;
    assert!((tension("light.csv") - pound).abs() < 1e-9 && (tension("heavy.csv") - 15.0 * pound).abs() < 1e-9);
}

#[test]
fn the_fixed_step_engine_comes_close_to_the_reference_and_closer_with_shorter_steps() {
    let folder = Folder::new("fixed");
    folder.file("muscle.toml", PWM);
    run(&folder, &["simulate", "muscle.toml", "-o", "reference.csv"]);
    let reference = rows(&folder.path("reference.csv"));
    let error = |step: &str, method: &str| {
        let (step, method) = (format!("run.step={step}"), format!("run.method={method}"));
        let set = ["run.engine=fixed-step", &step, &method].map(|setting| ["--set", setting]).concat();
        run(&folder, &[&["simulate", "muscle.toml", "-o", "fixed.csv"][..], &set].concat());
        let fixed = rows(&folder.path("fixed.csv"));
        assert_eq!(fixed.len(), reference.len());
        let gap = |(a, b): (&Row, &Row)| {
            assert_eq!((a.0[0], &a.1), (b.0[0], &b.1), "time and valve");
            (a.0[1] - b.0[1]).abs()
        };
        fixed.iter().zip(&reference).map(gap).fold(0.0, f64::max)
    };
    let [coarse, fine] = [error("0.2 ms", "stable"), error("0.05 ms", "stable")];
    assert!(coarse < 1e-3 && fine < coarse / 4.0, "{coarse:e} m, {fine:e} m");
    let classical = error("0.05 ms", "rk4");
    assert!(classical < 1e-4, "{classical:e} m");
}

#[test]
fn without_a_step_the_accuracy_chooses_it_and_the_summary_says_so() {
    let folder = Folder::new("accuracy");
    folder.file("muscle.toml", PWM);
    run(&folder, &["simulate", "muscle.toml", "-o", "reference.csv", "--set", "run.relative_tolerance=1e-11"]);
    let reference = rows(&folder.path("reference.csv"));
    let range = |column: usize| {
        let values = reference.iter().map(|row| row.0[column]);
        values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
    };
    let fixed = ["simulate", "muscle.toml", "-o", "fixed.csv", "--set", "run.engine=fixed-step"];
    for (accuracy, step) in [("1e-2", "200 µs"), ("1e-3", "50 µs")] {
        let setting = format!("run.accuracy={accuracy}");
        let text = run(&folder, &[&fixed[..], &["--set", &setting]].concat());
        assert!(text.contains(&format!("at most {step}, chosen for an accuracy of {accuracy}")), "{text}");
        // Length, velocity, pressure and air mass of the file have the requested accuracy.
        let written = rows(&folder.path("fixed.csv"));
        for column in 1..=4 {
            let gaps = written.iter().zip(&reference).map(|(a, b)| (a.0[column] - b.0[column]).abs());
            let error = gaps.fold(0.0, f64::max) / range(column);
            assert!(
                error <= 1.05 * accuracy.parse::<f64>().expect("a number"),
                "{accuracy}, column {column}: {error:e}"
            );
        }
    }
    let given = run(&folder, &[&fixed[..], &["--set", "run.step=0.5 ms", "--set", "run.accuracy=1e-6"]].concat());
    assert!(given.contains("at most 500 µs, as given"), "{given}");
    // Steps divide the sample interval into equal parts.
    for (step, longest) in [("0.5 s", "1 ms"), ("0.3 ms", "250 µs")] {
        let setting = format!("run.step={step}");
        let text = run(&folder, &["simulate", "muscle.toml", "--set", "run.engine=fixed-step", "--set", &setting]);
        let on_one_line = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(
            on_one_line.contains(&format!("at most {longest}: the longest that divides run.sample_interval = 1 ms")),
            "{text}"
        );
        assert!(!on_one_line.contains("as given"), "{text}");
    }
}

#[test]
fn an_accuracy_that_no_step_reaches_is_refused_with_the_one_that_can_be() {
    let folder = Folder::new("unreachable");
    folder.file("muscle.toml", &PWM.replace("0.3 s", "0.05 s"));
    let set = ["--set", "run.engine=fixed-step", "--set", "run.accuracy=1e-9"];
    let output = folder.mckibben().args(["simulate", "muscle.toml", "-o", "run.csv"]).args(set).output().expect("runs");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("run.accuracy") && message.contains("loosen run.accuracy"), "{message}");
    assert_eq!(folder.names(), ["muscle.toml"]);
}

#[test]
fn a_step_too_long_for_runge_kutta_is_reported() {
    let folder = Folder::new("blow-up");
    folder.file("muscle.toml", PWM);
    let set = ["--set", "run.engine=fixed-step", "--set", "run.method=rk4", "--set", "run.step=20 ms"];
    let set = [&set[..], &["--set", "run.sample_interval=20 ms", "--set", "actuator.external_volume=0.1 mL"]].concat();
    let output = folder.mckibben().args(["simulate", "muscle.toml", "-o", "run.csv"]).args(set).output().expect("runs");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{message}");
    assert!(message.contains("t = ") && message.contains("shorten run.step"), "{message}");
    assert_eq!(folder.names(), ["muscle.toml"]);
}

#[test]
fn the_plot_is_a_figure() {
    let folder = Folder::new("plot");
    folder.file("muscle.toml", PWM);
    run(&folder, &["simulate", "muscle.toml", "--plot", "run.svg"]);
    let svg = std::fs::read_to_string(folder.path("run.svg")).expect("written");
    assert!(svg.contains("<svg") && svg.trim_end().ends_with("</svg>"));
    for word in ["length", "gauge pressure", "tension", "supply open", "time"] {
        assert!(svg.contains(word), "{word}");
    }
    run(&folder, &["simulate", "muscle.toml", "--plot", "run.PNG"]);
    let decoder =
        png::Decoder::new(std::io::BufReader::new(std::fs::File::open(folder.path("run.PNG")).expect("written")));
    let info = decoder.read_info().expect("a PNG");
    assert!(info.info().width > 1000 && info.info().height > 1000);
}

#[test]
fn the_summary_has_the_figures() {
    let folder = Folder::new("summary");
    folder.file("muscle.toml", PWM);
    let short = run(&folder, &["simulate", "muscle.toml"]);
    // Without the assumed values, which are always printed, the summary takes few lines.
    let lines = short.lines().take_while(|line| !line.starts_with("Assumed")).filter(|line| !line.is_empty()).count();
    assert!(lines <= 15 && !short.contains("gas work") && short.contains("gauge pressure"), "{short}");
    let text = run(&folder, &["simulate", "muscle.toml", "--verbose"]);
    assert!(!text.contains('\x1b'));
    for word in [
        "muscle.toml",
        "hanging mass of 2.268 kg",
        "PWM of 25 Hz at 50 % duty",
        "event-located, relative tolerance 1e-8",
        "steps",
        "evaluations",
        "valve 15",
        "length",
        "contraction",
        "velocity",
        "tension",
        "gauge pressure",
        "temperature",
        "under PWM",
        "from supply",
        "ANR",
        "gas work",
        "to the load",
        "viscous",
        "Coulomb",
        "residual",
        "of the turnover",
        "Assumed",
        "actuator.thread_length = 4.3218 in",
        "valve.laminar_ratio = 0.999",
    ] {
        assert!(text.contains(word), "`{word}` is not in\n{text}");
    }
    // A file that gives every value assumes nothing.
    let path = of_repository("validation/reference/sealed-ring-down.toml");
    let explicit = run(&folder, &["simulate", &path.to_string_lossy()]);
    assert!(!explicit.contains("Assumed") && explicit.contains("sealed, no valve"), "{explicit}");
}

/// Whatever a file states of a muscle, its braid is printed whole, and what is assumed of its lengths is said.
#[test]
fn the_braid_of_a_muscle_is_printed() {
    let folder = Folder::new("braid");
    let path = of_repository("examples/own-muscle.toml");
    let file = path.to_string_lossy();
    let braid = "thread of 220.7 mm, 2.969 turns; at rest 200 mm long, 10 mm wide, braid angle 25°";
    let checked = run(&folder, &["check", &file]);
    assert!(checked.contains(&format!("   muscle: {braid} (from length, diameter, braid_angle)")), "{checked}");
    let text = run(&folder, &["simulate", "--verbose", &file]);
    let on_one_line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(on_one_line.contains(&format!("muscle {braid}")), "{text}");
    assert!(text.contains("actuator.max_length = 0.2 m, actuator.min_length = 0.127407 m"), "{text}");
    // Actuators with equal braids share a line.
    let leg = of_repository("examples/plant/leg.toml");
    let plant = run(&folder, &["check", &leg.to_string_lossy()]);
    assert!(plant.contains("hip-back, knee-forward, knee-back: thread of 109.8 mm"), "{plant}");
}

#[test]
fn events_are_printed_and_written() {
    let folder = Folder::new("events");
    folder.file("muscle.toml", PWM);
    let text = run(&folder, &["simulate", "muscle.toml", "--quiet", "--events", "--events-output", "events.csv"]);
    let written = std::fs::read_to_string(folder.path("events.csv")).expect("written");
    assert!(written.starts_with("time_s,event,valve,supply_flow,exhaust_flow,length_regime,sliding,tension_clamped\n"));
    assert!(written.contains("\n0.004,valve,supply,choked-in,,"), "{written}");
    assert_eq!(text.lines().count(), written.lines().count());
}

#[test]
fn an_output_that_cannot_be_written_is_refused_before_anything_is_simulated() {
    let folder = Folder::new("unwritable");
    folder.file("muscle.toml", PWM);
    std::fs::create_dir(folder.path("folder.csv")).expect("made");
    for (option, path) in
        [("-o", "absent/run.csv"), ("-p", "absent/run.svg"), ("-o", "folder.csv"), ("-o", "muscle.toml/run.csv")]
    {
        // A run of a century would not come back.
        let long = ["--set", "run.duration=3e7 s", "--set", "run.sample_interval=1 s"];
        let arguments = [&["simulate", "muscle.toml"], &long[..], &[option, path]].concat();
        let output = folder.mckibben().args(arguments).output().expect("the program runs");
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(4), "{message}");
        assert!(message.contains("could not be written") && message.contains(path), "{message}");
        assert_eq!(folder.names(), ["folder.csv", "muscle.toml"]);
    }
}

#[test]
fn every_command_helps_with_an_example() {
    let folder = Folder::new("help");
    for command in ["simulate", "sweep", "check", "init", "presets", "schema", "completions"] {
        let text = run(&folder, &[command, "--help"]);
        assert!(text.contains("Examples:") && text.contains(&format!("mckibben {command}")), "{text}");
    }
    let text = run(&folder, &["--help"]);
    assert!(["Exit codes:", "  0  ", "  2  ", "  3  ", "  4  "].iter().all(|word| text.contains(word)), "{text}");
    assert!(run(&folder, &["presets"]).contains("assumed"));
    assert!(run(&folder, &["completions", "bash"]).contains("_mckibben"));
    let schema: serde_json::Value = serde_json::from_str(&run(&folder, &["schema"])).expect("JSON");
    assert_eq!(schema["title"], "mckibben scenario");
}

/// The agonist's columns are the usual ones; those of the joint and of the antagonist follow, by the same trajectory.
#[test]
fn a_joint_adds_its_columns_after_the_usual_ones() {
    let folder = Folder::new("joint");
    let file = of_repository("examples/antagonistic-joint.toml");
    let name = file.to_str().expect("UTF-8");
    let printed = run(
        &folder,
        &[
            "simulate",
            name,
            "-o",
            "run.csv",
            "--plot",
            "run.svg",
            "--events-output",
            "events.csv",
            "--set",
            "run.duration=0.2 s",
        ],
    );
    assert!(printed.contains("antagonistic joint") && printed.contains("201 rows"), "{printed}");
    let mut reader = csv::Reader::from_path(folder.path("run.csv")).expect("a CSV file");
    let header = reader.headers().expect("a header").iter().collect::<Vec<_>>().join(",");
    let second = HEADER.split(',').skip(1).map(|column| format!(",antagonist_{column}")).collect::<String>();
    assert_eq!(header, format!("{HEADER},angle_rad,angular_velocity_rad_s,torque_n_m{second}"));
    let mut document = Document::load(&file).expect("TOML");
    document.set_text("run.duration", "\"0.2 s\"").expect("a path");
    let experiment = document.joint_experiment().expect("good").expect("a joint");
    let trajectory =
        JointPlant::new(&experiment.rig).and_then(|joint| joint.simulate(&experiment.start, 0.2, 1e-8)).expect("runs");
    let records: Vec<_> = reader.records().map(|record| record.expect("a row")).collect();
    for (record, sample) in records.iter().zip(trajectory.samples(1e-3)) {
        let number = |column: usize| record[column].parse::<f64>().expect("a number");
        let numbers = [number(0), number(1), number(11), number(13), number(14), number(21)];
        let [agonist, antagonist] = sample.actuators;
        let expected =
            [sample.time, agonist.length, sample.angle, sample.torque, antagonist.length, antagonist.tension];
        assert_eq!((numbers, &record[10], &record[23]), (expected, agonist.ports.name(), antagonist.ports.name()));
    }
    assert_eq!(records.len(), 201);
    let events = std::fs::read_to_string(folder.path("events.csv")).expect("the events");
    assert_eq!(events.lines().count(), 1 + trajectory.events().len());
    let figure = std::fs::read_to_string(folder.path("run.svg")).expect("the figure");
    assert!(figure.contains("antagonist"));
}

/// The fixed-step engine writes the same columns, near the event-located engine's within the accuracy, and the same events.
#[test]
fn a_joint_runs_at_fixed_steps_to_the_requested_accuracy() {
    let folder = Folder::new("joint-steps");
    let file = of_repository("examples/moment-arm.toml");
    let common = ["simulate", file.to_str().expect("UTF-8"), "--set", "run.duration=0.3 s"];
    let with = |more: &[&str]| run(&folder, &[&common[..], more].concat());
    with(&["-o", "located.csv", "--events-output", "located-events.csv"]);
    let log = ["--events-output", "stepped-events.csv"];
    let printed = with(
        &[&["--verbose", "-o", "stepped.csv", "--plot", "run.svg", "--set", "run.engine=fixed-step"], &log[..]]
            .concat(),
    );
    assert!(printed.contains("chosen for an accuracy of 1e-3") && printed.contains("of the turnover"), "{printed}");
    let rows = |name: &str| -> Vec<Vec<String>> {
        let mut reader = csv::Reader::from_path(folder.path(name)).expect("a CSV file");
        let header = reader.headers().expect("a header").iter().map(str::to_owned).collect();
        let rows = reader.records().map(|row| row.expect("a row").iter().map(str::to_owned).collect());
        std::iter::once(header).chain(rows).collect()
    };
    let (located, stepped) = (rows("located.csv"), rows("stepped.csv"));
    assert_eq!((located[0].clone(), located.len()), (stepped[0].clone(), stepped.len()));
    let column = located[0].iter().position(|name| name == "angle_rad").expect("a column");
    let angle = |row: &[String]| row[column].parse::<f64>().expect("a number");
    let angles: Vec<f64> = located[1..].iter().map(|row| angle(row)).collect();
    let range = angles.iter().copied().fold(f64::MIN, f64::max) - angles.iter().copied().fold(f64::MAX, f64::min);
    for (exact, row) in angles.iter().zip(&stepped[1..]) {
        assert!((exact - angle(row)).abs() <= 1.1e-3 * range, "{exact} {}", angle(row));
    }
    // Both log the events that no piece of a law or a table begins by, in the same order and about when they are.
    let events = |name: &str| {
        let of_mode =
            |row: &&Vec<String>| !["flow", "effectiveness", "press", "moment-arm", "event"].contains(&row[1].as_str());
        let event = |row: Vec<String>| (row[0].parse::<f64>().expect("a time"), row[1].clone(), row[2].clone());
        rows(name).iter().filter(of_mode).cloned().map(event).collect::<Vec<_>>()
    };
    let (located, stepped) = (events("located-events.csv"), events("stepped-events.csv"));
    assert!(located.len() == stepped.len() && located.len() == 4, "{located:?} {stepped:?}");
    for ((exact, kind, whose), (time, of, owner)) in located.iter().zip(&stepped) {
        assert!((kind, whose) == (of, owner) && (exact - time).abs() < 1e-3, "{kind} at {exact}, {of} at {time}");
    }
}

/// Under a controller a step follows from the accuracy too, and is as accurate as it says.
#[test]
fn a_step_is_chosen_for_an_accuracy_under_a_controller() {
    let folder = Folder::new("controlled-steps");
    let file = of_repository("examples/control/joint-air-mass.toml");
    let common =
        ["simulate", file.to_str().expect("UTF-8"), "--set", "run.duration=0.3 s", "--set", "run.accuracy=1e-2"];
    let with = |more: &[&str]| run(&folder, &[&common[..], more].concat());
    with(&["-o", "located.csv"]);
    let printed = with(&["-o", "stepped.csv", "--set", "run.engine=fixed-step"]);
    assert!(printed.contains("chosen for an accuracy of 1e-2"), "{printed}");
    let angles = |name: &str| -> Vec<f64> {
        let mut reader = csv::Reader::from_path(folder.path(name)).expect("a CSV file");
        let column = reader.headers().expect("a header").iter().position(|name| name == "angle_rad").expect("a column");
        reader.records().map(|row| row.expect("a row")[column].parse().expect("a number")).collect()
    };
    let (exact, stepped) = (angles("located.csv"), angles("stepped.csv"));
    let range = exact.iter().copied().fold(f64::MIN, f64::max) - exact.iter().copied().fold(f64::MAX, f64::min);
    assert!(exact.iter().zip(&stepped).all(|(exact, angle)| (exact - angle).abs() <= 1.1e-2 * range), "{range}");
}

#[test]
fn a_joint_is_refused_by_what_takes_one_actuator() {
    let folder = Folder::new("joint-refused");
    let file = of_repository("examples/antagonistic-joint.toml");
    let name = file.to_str().expect("UTF-8");
    let output = folder.mckibben().args(["curves", name]).output().expect("the program runs");
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    let word = "load.kind = \"antagonistic-joint\" is not implemented where one actuator is due";
    assert!(output.status.code() == Some(2) && error.contains(word), "{error}");
}

#[test]
fn the_exergy_of_the_supply_is_reported_where_there_is_a_valve() {
    let folder = Folder::new("exergy");
    let printed = |file: &str| {
        let output = folder.mckibben().args(["simulate", "--verbose"]).arg(of_repository(file)).output().unwrap();
        assert!(output.status.success());
        String::from_utf8(output.stdout).unwrap()
    };
    let with = printed("examples/fill-hold-exhaust.toml");
    let (_, exergy) = with.split_once("Exergy of the air").expect("its heading");
    for name in ["drawn", "gas work", "exhaust", "throttled", "heat", "residual", "efficiency", "of compressor"] {
        assert!(exergy.contains(&format!("\n  {name}")), "{name}: {exergy}");
    }
    assert!(!printed("examples/paper/fig-08.toml").contains("Exergy"), "a sealed muscle draws nothing");
    let (_, of_joint) = printed("examples/antagonistic-joint.toml")
        .split_once("Exergy of the air")
        .map_or_else(|| panic!("a joint has its circuit"), |(before, after)| (before.to_owned(), after.to_owned()));
    for name in ["drawn", "gas work", "exhaust", "throttled", "heat", "residual", "efficiency", "of compressor"] {
        assert!(of_joint.contains(&format!("\n  {name}")), "{name}: {of_joint}");
    }
}

/// The rows of a table of the summary in kg or J, up to its residual, without those that are parts of the row above.
fn table<'t>(text: &'t str, heading: &str) -> Vec<(&'t str, f64)> {
    let lines = text.lines().skip_while(|line| *line != heading).skip(1);
    let lines = lines.take_while(|line| !line.starts_with("  residual")).filter(|line| !line.starts_with("   "));
    let row = |line: &'t str| {
        let (name, rest) = line.split_at(16);
        let (number, unit) = rest.trim().split("  ").next().and_then(|value| value.split_once(' ')).expect("a value");
        let scale = match unit {
            "J" => 1.0,
            "g" | "mJ" => 1e-3,
            "mg" | "µJ" => 1e-6,
            "µg" | "nJ" => 1e-9,
            _ => panic!("{unit}: {line}"),
        };
        (name.trim(), scale * number.parse::<f64>().expect("a number"))
    };
    lines.map(row).collect()
}

/// What goes in is the sum of what comes out, to the digits that are printed.
fn adds_up(text: &str, heading: &str, gives: &[&str]) {
    let rows = table(text, heading);
    assert!(gives.iter().all(|name| rows.iter().any(|(its, _)| its == name)), "{gives:?}:\n{text}");
    let sign = |name: &str| if gives.contains(&name) { 1.0 } else { -1.0 };
    let left: f64 = rows.iter().map(|(name, value)| sign(name) * value).sum();
    let largest = rows.iter().fold(0.0, |largest: f64, (_, value)| largest.max(value.abs()));
    assert!(left.abs() < 1e-3 * largest, "{left} of {heading}:\n{text}");
}

/// Of one actuator that leaks, on a tank that a compressor fills for four, of a joint whose effectiveness takes work, and of a plant with hoses.
#[test]
fn the_rows_of_each_table_add_up() {
    let folder = Folder::new("tables");
    let printed = |file: &str, set: &[&str]| {
        let file = of_repository(file).display().to_string();
        run(&folder, &[&["simulate", "--verbose", &file], set].concat())
    };
    let tank = printed("examples/line/tank.toml", &[]);
    adds_up(&tank, "Energy", &["gas work"]);
    adds_up(&tank, "Exergy of the air", &["drawn", "compressed"]);
    for name in ["leaked", "others"] {
        assert!(table(&tank, "Exergy of the air").iter().any(|(its, _)| *its == name), "{name}: {tank}");
    }
    assert!(tank.contains("\n  efficiency"), "{tank}");
    let joint = printed("examples/antagonistic-joint.toml", &["--set", "actuator.effectiveness.constant=0.9"]);
    assert!(table(&joint, "Energy").iter().any(|(name, _)| *name == "effectiveness"), "{joint}");
    assert!(joint.contains("by the gauge pressures: agonist "), "{joint}");
    adds_up(&joint, "Energy", &["gas work"]);
    adds_up(&joint, "Exergy of the air", &["drawn"]);
    let plant = printed("examples/plant/hose-joint.toml", &[]);
    assert!(table(&plant, "Air").iter().any(|(name, mass)| *name == "in hoses" && *mass > 1e-6), "{plant}");
    adds_up(&plant, "Air", &["supply"]);
    adds_up(&plant, "Energy", &["gas work"]);
    adds_up(&plant, "Exergy of the air", &["drawn"]);
}

/// Parts of the actuators of a joint other than the valves add columns behind each one's valve; what happens to the bottle of
/// both is the supply's, and a sweep varies each of it.
#[test]
fn a_joint_on_a_bottle_with_hoses_and_tendons_has_columns_events_and_sweeps() {
    let folder = Folder::new("joint-line");
    let example = std::fs::read_to_string(of_repository("examples/line/joint.toml")).expect("an example");
    let compressor = "compressor_displacement = \"50 L/min\"\ncut_in_gauge_pressure = \"58 psi\"\n\
                      cut_out_gauge_pressure = \"61 psi\"\n\n[valve]";
    let tendons = "rest_length = \"113.82 mm\"\n";
    let text = example.replacen("\n[valve]", compressor, 1).replace("rest_length = \"3.3 in\"\n", tendons)
        + "[tendon]\nstiffness = \"20 kN/m\"\nrest_length = \"30 mm\"\n";
    folder.file("joint.toml", &text);
    let printed = run(&folder, &["simulate", "joint.toml", "-o", "run.csv", "--events-output", "events.csv"]);
    assert!(printed.contains("1501 rows") && !printed.contains("NaN"), "{printed}");
    let columns = |name: &str| {
        let mut reader = csv::Reader::from_path(folder.path(name)).expect("a CSV file");
        reader.headers().expect("a header").iter().map(str::to_owned).collect::<Vec<_>>()
    };
    let own = [
        "hose_absolute_pressure_pa",
        "hose_gauge_pressure_pa",
        "supply_absolute_pressure_pa",
        "supply_gauge_pressure_pa",
        "load_distance_m",
        "load_velocity_m_s",
    ]
    .map(str::to_owned);
    let usual: Vec<String> = HEADER.split(',').map(str::to_owned).collect();
    let others = own.iter().filter(|name| !name.starts_with("supply_"));
    let second = usual.iter().skip(1).chain(others).map(|name| format!("antagonist_{name}"));
    let of_joint = ["angle_rad", "angular_velocity_rad_s", "torque_n_m"].map(str::to_owned);
    let due: Vec<String> = usual.iter().chain(&own).chain(&of_joint).cloned().chain(second).collect();
    assert_eq!(columns("run.csv"), due);
    let events = std::fs::read_to_string(folder.path("events.csv")).expect("the events");
    let whose = |kind: &str, whose: &str| events.lines().any(|line| line.contains(&format!(",{kind},{whose},")));
    assert!(whose("compressor", "supply") && whose("regime", "antagonist") && !whose("compressor", ""), "{events}");
    let vary = "\n[sweep]\nreductions = [\"angle.max\", \"stiffness.final\"]\n[sweep.vary]\n";
    for varies in [
        "\"hose.length\" = [\"0.5 m\", \"1 m\"]",
        "\"antagonist.hose.diameter\" = [\"1.5 mm\", \"2.5 mm\"]",
        "\"supply.reservoir_volume\" = [\"0.1 L\", \"0.5 L\"]",
        "\"tendon.stiffness\" = [\"10 kN/m\", \"20 kN/m\"]",
        "\"antagonist.tendon.stiffness\" = [\"10 kN/m\", \"20 kN/m\"]",
    ] {
        folder.file(
            "sweep.toml",
            &format!("{}{vary}{varies}\n", text.replace("[run]", "[run]\nengine = \"event-located\"")),
        );
        run(&folder, &["sweep", "sweep.toml", "-o", "sweep.csv"]);
        let table = std::fs::read_to_string(folder.path("sweep.csv")).expect("the table");
        let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|line| line.split(',').skip(2).collect()).collect();
        assert!(rows.len() == 2 && rows[0] != rows[1] && !rows[0][0].is_empty(), "{varies}: {table}");
    }
    run(&folder, &["linearize", "joint.toml", "-o", "model.json"]);
    let model = std::fs::read_to_string(folder.path("model.json")).expect("the model");
    for name in ["\"agonist_hose_pressure\"", "\"antagonist_hose_pressure\"", "\"supply_pressure\""] {
        assert!(model.contains(name), "{name}: {model}");
    }
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = Folder::new("man");
    let help = run(&folder, &["--help"]);
    let listed = help.lines().skip_while(|line| !line.starts_with("Commands:")).skip(1);
    let commands = listed.take_while(|line| !line.is_empty()).filter_map(|line| line.split_whitespace().next());
    for command in commands.filter(|command| *command != "help") {
        let page = run(&folder, &["man", command]);
        assert!(page.contains(&format!(".TH mckibben-{command} 1")), "{page}");
        assert!(page.contains(concat!("mckibben ", env!("CARGO_PKG_VERSION"))), "{page}");
    }
    assert!(run(&folder, &["man"]).contains(".SH SUBCOMMANDS"));
}
