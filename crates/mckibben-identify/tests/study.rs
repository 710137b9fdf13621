//! Studies: every rule for dirty data by data that break it, both formats, and every mistake with its place.

use crate::noise::Noise;
use mckibben_identify::study::{Direction, Kind, Quantity, Recording, Severity, Study, StudyError, TankTarget};
use std::path::PathBuf;

/// A folder that is gone afterwards.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("mckibben-study-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        Self(path)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.join(name), text).expect("a file");
    }

    fn study(&self, text: &str) -> Result<Study, StudyError> {
        Study::parse(text, &self.0.join("study.toml"))
    }

    /// One run of a table in s, mm and N, with more lines for the columns.
    fn recording(&self, table: &str, length: &str, tension: &str) -> Result<Recording, StudyError> {
        self.write("data.csv", table);
        let text = format!(
            "[study]\nkind = \"trajectories\"\nscenario = \"m.toml\"\n[columns.time]\nname = \"t\"\nunit = \"s\"\n\
             [columns.length]\nname = \"L\"\nunit = \"mm\"\n{length}\n[columns.tension]\nname = \"F\"\nunit = \"N\"\n{tension}\n[[run]]\nfile = \"data.csv\"\n"
        );
        self.study(&text)?.recordings().map(|mut all| all.remove(0))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn notes(recording: &Recording) -> String {
    recording.notes.iter().map(|note| format!("{:?} {note}\n", note.severity)).collect()
}

/// A table whose readings are given by their row.
fn table(rows: usize, line: impl Fn(usize) -> String) -> String {
    (0..rows).fold("t,L,F\n".to_owned(), |text, row| text + &line(row) + "\n")
}

fn even(row: usize) -> String {
    format!("{},{},{}", 0.01 * row as f64, 90.0 + (0.7 * row as f64).sin(), 20.0 + (0.9 * row as f64).cos())
}

#[test]
fn a_clean_table_is_read_to_si() {
    let folder = Folder::new("clean");
    let recording =
        folder.recording(&table(40, even), "", "deviation = \"0.5 N\"").unwrap_or_else(|error| panic!("{error}"));
    let (times, lengths) = recording.channel(Quantity::Length).expect("a time series");
    assert_eq!((times.len(), times[1], lengths[0]), (40, 0.01, 0.09));
    assert_eq!(recording.column(Quantity::Tension).expect("one").deviation, Some(0.5));
    assert!(recording.notes.iter().all(|note| note.severity == Severity::Noted), "{}", notes(&recording));
    assert!(notes(&recording).contains("40 readings, 100"), "{}", notes(&recording));
}

#[test]
fn words_among_the_numbers_are_no_readings() {
    let folder = Folder::new("words");
    let text = table(20, even).replace("t,L,F", "t,L,F,valve").replace('\n', ",hold\n").replace("valve,hold", "valve");
    let recording = folder.recording(&text, "", "").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(recording.channel(Quantity::Tension).expect("a time series").0.len(), 20);
}

#[test]
fn semicolons_and_decimal_commas() {
    let folder = Folder::new("comma");
    let text = table(20, even).replace(',', ";").replace('.', ",");
    let recording = folder.recording(&text, "", "").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(recording.channel(Quantity::Length).expect("a time series").1[0], 0.09);
}

/// Comments above the head are skipped, with any separator in them; a head behind `#` stays one.
#[test]
fn comments_stand_above_the_head() {
    let folder = Folder::new("comments");
    let plain = folder.recording(&table(20, even), "", "").unwrap_or_else(|error| panic!("{error}"));
    for above in ["# by rig 3; second try\n", "# one\n\n# two, three\n", "\u{feff}#\n"] {
        let text = format!("{above}{}", table(20, even));
        let recording = folder.recording(&text, "", "").unwrap_or_else(|error| panic!("{above:?}: {error}"));
        assert_eq!(recording.sheets[0].columns, plain.sheets[0].columns, "{above:?}");
        let skipped = above.matches('\n').count();
        assert_eq!(recording.sheets[0].lines[0], 2 + skipped, "{above:?}");
    }
    let text = table(20, even).replace("t,L,F", "# of the rig\n#t,L,F");
    let error = folder.recording(&text, "", "").expect_err("the head has `#t`").to_string();
    assert!(error.contains("the tables have: #t, L, F"), "{error}");
}

#[test]
fn missing_readings_are_left_out_and_reported() {
    let folder = Folder::new("missing");
    let text = table(40, |row| match row {
        3 => "0.03,,20".to_owned(),
        5 => "0.05,NaN,n/a".to_owned(),
        7 => ",90,20".to_owned(),
        _ => even(row),
    });
    let recording = folder.recording(&text, "", "").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(recording.channel(Quantity::Length).expect("a time series").0.len(), 37);
    assert_eq!(recording.channel(Quantity::Tension).expect("a time series").0.len(), 38);
    assert!(notes(&recording).contains("2 rows without a reading or without a time"), "{}", notes(&recording));
    assert!(notes(&recording).contains("1 of 38 readings of the length"), "{}", notes(&recording));
    let most = table(40, |row| if row < 30 { format!("{},,20", 0.01 * row as f64) } else { even(row) });
    let error = folder.recording(&most, "", "").expect_err("too few").to_string();
    assert!(error.contains("30 of 40 readings of the length are missing"), "{error}");
}

#[test]
fn one_time_twice_is_averaged_and_a_time_that_goes_back_is_refused() {
    let folder = Folder::new("times");
    let text = table(20, |row| if row == 4 { "0.03,95,31".to_owned() } else { even(row) });
    let recording = folder.recording(&text, "", "").unwrap_or_else(|error| panic!("{error}"));
    let (times, lengths) = recording.channel(Quantity::Length).expect("a time series");
    assert_eq!(times.len(), 19);
    let expected = 0.5e-3 * (95.0 + 90.0 + 2.1_f64.sin());
    assert!((lengths[3] - expected).abs() < 1e-12, "{} is not {expected}", lengths[3]);
    assert!(notes(&recording).contains("averaged"), "{}", notes(&recording));
    let back = table(20, |row| if row == 6 { "0.01,90,20".to_owned() } else { even(row) });
    let error = folder.recording(&back, "", "").expect_err("back");
    assert_eq!(error.line, Some(8));
    assert!(error.to_string().contains("the time goes back"), "{error}");
}

#[test]
fn offsets_and_drift_are_taken_off_where_the_quantity_is_known() {
    let folder = Folder::new("zero");
    // 2 N too much at the start and 3 N too much at the end.
    let text = table(101, |row| {
        let time = 0.01 * row as f64;
        let pull = if (0.2..0.8).contains(&time) { 40.0 + (time - 0.5) } else { 0.0 };
        format!("{time},{},{}", 90.0 + time, pull + 2.0 + time)
    });
    let zeros = "zero = [{ from = \"0 s\", to = \"0.1 s\" }, { from = \"0.9 s\", to = \"1 s\" }]";
    let recording = folder.recording(&text, "offset = \"1 mm\"", zeros).unwrap_or_else(|error| panic!("{error}"));
    let (_, tensions) = recording.channel(Quantity::Tension).expect("a time series");
    assert!(
        tensions[0].abs() < 1e-9 && (tensions[50] - 40.0).abs() < 1e-9 && tensions[100].abs() < 1e-9,
        "{tensions:?}"
    );
    assert_eq!(recording.channel(Quantity::Length).expect("a time series").1[0], 0.089);
    assert!(
        notes(&recording).contains("an offset of 2.05") && notes(&recording).contains("a drift of 1.0"),
        "{}",
        notes(&recording)
    );
    let one = folder
        .recording(&text, "", "zero = [{ from = \"0 s\", to = \"0.1 s\", value = \"1 N\" }]")
        .unwrap_or_else(|error| panic!("{error}"));
    let (_, tensions) = one.channel(Quantity::Tension).expect("a time series");
    assert!((tensions[5] - 1.0).abs() < 1e-9, "{}", tensions[5]);
    let error =
        folder.recording(&text, "", "zero = [{ from = \"5 s\", to = \"6 s\" }]").expect_err("no reading").to_string();
    assert!(error.contains("from 5 s to 6 s"), "{error}");
}

#[test]
fn outliers_are_reported_or_left_out() {
    let folder = Folder::new("outliers");
    let text = table(60, |row| if row == 30 { "0.3,190,20".to_owned() } else { even(row) });
    let marked = folder.recording(&text, "", "").unwrap_or_else(|error| panic!("{error}"));
    assert!(notes(&marked).contains("1 reading of the length looks like an outlier; it stays"), "{}", notes(&marked));
    assert_eq!(marked.channel(Quantity::Length).expect("a time series").0.len(), 60);
    let dropped = folder.recording(&text, "drop_outliers = true", "").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(dropped.channel(Quantity::Length).expect("a time series").0.len(), 59);
}

/// Two readings on a steep edge with an empty cell between them: most readings about the first are those before the edge, and it was
/// taken for an outlier.
#[test]
fn a_reading_on_an_edge_is_no_outlier() {
    let folder = Folder::new("edge");
    let text = table(60, |row| {
        let jitter = 0.01 * ((7 * row) % 5) as f64;
        let length = match row {
            0..=29 => format!("{}", 90.0 + jitter),
            30 => "93".to_owned(),
            31 => String::new(),
            32 => "97".to_owned(),
            33 => "99".to_owned(),
            _ => format!("{}", 100.0 + jitter),
        };
        format!("{},{length},20", 0.01 * row as f64)
    });
    let recording = folder.recording(&text, "drop_outliers = true", "").unwrap_or_else(|error| panic!("{error}"));
    assert!(!notes(&recording).contains("outlier"), "{}", notes(&recording));
    assert_eq!(recording.channel(Quantity::Length).expect("a time series").0.len(), 59);
}

/// Normal noise alone, of which a threshold in units of eight neighbours flagged about one reading in two hundred; a reading far off
/// is still found.
#[test]
fn normal_noise_has_no_outliers() {
    let folder = Folder::new("normal-noise");
    let mut flagged = 0;
    for seed in 1..=5 {
        let noise = Noise::new(seed).added_to(&[0.0; 2401], 0.05);
        let text = table(2401, |row| {
            let time = 0.005 * row as f64;
            format!("{time},{},20", 90.0 + 3.0 * time.sin() + noise[row])
        });
        let recording = folder.recording(&text, "", "").unwrap_or_else(|error| panic!("{error}"));
        flagged += usize::from(notes(&recording).contains("outlier"));
    }
    assert!(flagged <= 1, "{flagged} of 5 clean records have outliers");
    let noise = Noise::new(1).added_to(&[0.0; 2401], 0.05);
    let text = table(2401, |row| {
        let slip = if row == 1200 { 2.0 } else { 0.0 };
        format!("{},{},20", 0.005 * row as f64, 90.0 + slip + noise[row])
    });
    let recording = folder.recording(&text, "", "").unwrap_or_else(|error| panic!("{error}"));
    assert!(notes(&recording).contains("1 reading of the length looks like an outlier"), "{}", notes(&recording));
}

/// Files of equal stems gave runs of one name, whose parameters of `per_run` were one.
#[test]
fn runs_have_different_names() {
    let folder = Folder::new("names");
    let head = "[study]\nkind = \"trajectories\"\nscenario = \"m.toml\"\n";
    let names = |runs: &str| {
        let study = folder.study(&format!("{head}{runs}"));
        study.map(|study| study.runs.into_iter().map(|run| run.name).collect::<Vec<_>>())
    };
    let run = |file: &str| format!("[[run]]\nfile = \"{file}\"\n");
    let named = |file: &str, name: &str| format!("[[run]]\nfile = \"{file}\"\nname = \"{name}\"\n");
    for (runs, expected) in [
        (run("a.csv") + &run("b.csv"), ["a", "b"]),
        (run("day1/rig.csv") + &run("day2/rig.csv"), ["day1/rig", "day2/rig"]),
        (run("rig.csv") + &run("rig.csv"), ["rig", "rig-2"]),
        (run("rig.csv") + &run("rig.parquet"), ["rig", "rig-2"]),
        (run("day1/rig.csv") + &named("day2/rig.csv", "rig"), ["day1/rig", "rig"]),
        (named("day1/rig.csv", "one") + &named("day2/rig.csv", "two"), ["one", "two"]),
    ] {
        assert_eq!(names(&runs).unwrap_or_else(|error| panic!("{error}")), expected, "{runs}");
    }
    let error = names(&(named("a.csv", "one") + &named("b.csv", "one"))).expect_err("one name for both");
    assert_eq!(error.line, Some(9), "{error}");
    assert!(error.to_string().contains("`one` is the name of two runs, in line 6 too"), "{error}");
}

#[test]
fn a_deviation_is_above_zero() {
    let folder = Folder::new("deviation");
    for wrong in ["-0.05 mm", "0 mm"] {
        let error = folder
            .recording(&table(20, even), &format!("deviation = \"{wrong}\""), "")
            .expect_err("a deviation that is none");
        assert_eq!(error.line, Some(10), "{error}");
        assert!(
            error.to_string().contains(&format!("the deviation of `length` is {wrong}, which is not above zero")),
            "{error}"
        );
    }
    folder.recording(&table(20, even), "deviation = \"0.05 mm\"", "").unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn a_sensor_at_its_end_is_refused_unless_it_is_said() {
    let folder = Folder::new("end");
    let text = table(60, |row| format!("{},{},{}", 0.01 * row as f64, 90.0, (20.0 + row as f64).min(50.0)));
    let error = folder.recording(&text, "", "").expect_err("saturated").to_string();
    assert!(error.contains("30 times on end") && error.contains("saturates = \"50 N\""), "{error}");
    let said = folder.recording(&text, "", "saturates = \"50 N\"").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(said.channel(Quantity::Tension).expect("a time series").0.len(), 30);
    let kept = folder.recording(&text, "", "saturates = \"60 N\"").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(kept.channel(Quantity::Tension).expect("a time series").0.len(), 60);
}

/// A column of a part stands in quotes in [columns], and may in [fit].
#[test]
fn a_parameter_of_a_sensor_is_named_with_or_without_quotes() {
    let study = |fit: &str| {
        let text = format!(
            "[study]\nkind = \"trajectories\"\nscenario = \"rig.toml\"\n[columns.\"flexor.length\"]\nname = \"L\"\n[[run]]\nfile = \"a\"\n{fit}"
        );
        Study::in_memory(&text, "the study", Vec::new())
    };
    let [bare, quoted] = [r#"[fit."columns.flexor.length.offset"]"#, r#"[fit."columns.\"flexor.length\".offset"]"#];
    for fit in [bare, quoted] {
        let entries = study(fit).unwrap_or_else(|error| panic!("{error}")).fit_entries;
        assert_eq!(entries[0].path, "columns.flexor.length.offset");
    }
    let error = study(&format!("{bare}\n{quoted}\n")).expect_err("one parameter twice").to_string();
    assert!(error.contains("is in [fit] twice"), "{error}");
}

#[test]
fn gaps_and_slack_are_reported() {
    let folder = Folder::new("gaps");
    let text = table(40, |row| {
        let time = 0.01 * row as f64 + if row > 20 { 1.0 } else { 0.0 };
        format!("{time},{},{}", 90.0 + 0.1 * row as f64, if row < 5 { 0.2 } else { 10.0 + row as f64 })
    });
    let recording = folder.recording(&text, "", "slack = \"0.5 N\"").unwrap_or_else(|error| panic!("{error}"));
    assert!(notes(&recording).contains("a gap of 1.0100 s"), "{}", notes(&recording));
    // 39 steps in 1.39 s.
    let rates = "40 readings, 28.0576 a second on average, 100 by the median step";
    assert!(notes(&recording).contains(rates), "{}", notes(&recording));
    let tension = recording.column(Quantity::Tension).expect("one");
    assert_eq!(tension.slack.iter().filter(|slack| **slack).count(), 5);
}

#[test]
fn parquet_is_read_as_csv_is() {
    use parquet::data_type::DoubleType;
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;
    let folder = Folder::new("parquet");
    let schema = parse_message_type("message run { required double t; required double L; required double F; }")
        .expect("a schema");
    let file = std::fs::File::create(folder.0.join("data.parquet")).expect("a file");
    let mut writer = SerializedFileWriter::new(file, schema.into(), Default::default()).expect("a writer");
    let mut group = writer.next_row_group().expect("a group");
    for column in [[0.0, 0.01, 0.02], [90.0, 91.0, f64::NAN], [1.0, 2.0, 3.0]] {
        let mut pages = group.next_column().expect("a column").expect("a column");
        pages.typed::<DoubleType>().write_batch(&column, None, None).expect("numbers");
        pages.close().expect("closed");
    }
    group.close().expect("closed");
    writer.close().expect("closed");
    let text = "[study]\nkind = \"force-map\"\nscenario = \"m.toml\"\n[columns.time]\nname = \"t\"\nunit = \"s\"\n[columns.length]\nname = \"L\"\nunit = \"mm\"\n\
                [[run]]\nfile = \"data.parquet\"\nheld = { gauge_pressure = \"2 bar\" }\nset = { \"load.mass\" = \"5 lb\" }\n";
    let study = folder.study(text).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(study.kind, Kind::ForceMap);
    let recording = study.recordings().unwrap_or_else(|error| panic!("{error}")).remove(0);
    assert_eq!(recording.channel(Quantity::Length).expect("a time series"), (vec![0.0, 0.01], vec![0.09, 0.091]));
    assert_eq!(recording.column(Quantity::GaugePressure).expect("held").values, vec![2e5; 2]);
    assert_eq!(recording.set, [("load.mass".to_owned(), "\"5 lb\"".to_owned())]);
}

#[test]
fn mistakes_are_shown_where_they_are() {
    let folder = Folder::new("mistakes");
    let head = "[study]\nkind = \"force-map\"\nscenario = \"m.toml\"\n";
    let run = "[[run]]\nfile = \"data.csv\"\n";
    for (text, line, words) in [
        ("[study]\nkind = \"force\"\nscenario = \"m.toml\"\n".to_owned() + run, Some(2), "force-map"),
        ("[study]\nkind = \"force-map\"\nscenari = \"m.toml\"\n".to_owned() + run, Some(3), "scenario"),
        (format!("{head}[columns.lenght]\nname = \"L\"\nunit = \"mm\"\n{run}"), None, "`lenght` is no quantity"),
        (format!("{head}[columns.length]\nname = \"L\"\nunit = \"psi\"\n{run}"), Some(6), "no unit of length"),
        (
            format!("{head}[columns.tension]\nname = \"F\"\nunit = \"N\"\nslack = \"1 mm\"\n{run}"),
            Some(7),
            "is no tension",
        ),
        (head.to_owned(), Some(1), "no runs"),
        (format!("{head}[[run]]\nname = \"a\"\n"), None, "has no file"),
        (
            format!("{}{run}[fit.\"columns.tension.offset\"]\n", head.replace("force-map", "hysteresis")),
            None,
            "is a parameter of a sensor, which only trajectories estimate",
        ),
        (format!("{head}[search]\nrobust = -1\n{run}"), None, "not above zero"),
    ] {
        let error = folder.study(&text).expect_err(&text);
        assert!(error.to_string().contains(words), "{error}");
        if line.is_some() {
            assert_eq!(error.line, line, "{error}");
        }
    }
    let columns = "[columns.length]\nname = \"L\"\nunit = \"mm\"\n";
    for (table, words) in [
        ("1,2\n3,4\n", "first line is numbers"),
        ("t,L\n0,nine\n", "`nine` in the column `L` is no number"),
        ("t,L\n0,9,3\n", "more or fewer cells"),
        ("t,M\n0,9\n", "has a column `L`"),
        ("t,L\n", "no readings"),
        ("", "data.csv: it is empty"),
        ("\n \n", "data.csv: it is empty"),
        ("# of the rig\n# in mm\n", "comments alone"),
        ("# of the rig\n1,2\n3,4\n", "data.csv, line 2: its first line is numbers"),
        ("# a, b\n# of the rig\nt,L\n0,9,3\n", "line 4: a line has more or fewer cells"),
        ("L,t,L\n9,0,8\n", "data.csv: it has 2 columns `L`, and the length is read from that"),
    ] {
        folder.write("data.csv", table);
        let study = folder.study(&format!("{head}{columns}{run}")).unwrap_or_else(|error| panic!("{error}"));
        let error = study.recordings().expect_err(table).to_string();
        assert!(error.contains(words), "{error}");
    }
    let missing = folder
        .study(&format!("{head}{columns}[[run]]\nfile = \"none.csv\"\n"))
        .unwrap_or_else(|error| panic!("{error}"));
    assert!(missing.recordings().expect_err("missing").to_string().contains("cannot be read"));
    let other = folder
        .study(&format!("{head}{columns}[[run]]\nfile = \"data.xlsx\"\n"))
        .unwrap_or_else(|error| panic!("{error}"));
    assert!(other.recordings().expect_err("format").to_string().contains(".parquet"));
}

#[test]
fn degrees_have_an_offset_and_their_differences_have_none() {
    let folder = Folder::new("degrees");
    folder.write("flow.csv", "T,Q\n20,60\n25,120\n");
    let study = |unit: &str, more: &str, flow: &str| {
        folder.study(&format!(
            "[study]\nkind = \"flow-curve\"\nscenario = \"m.toml\"\n[columns.temperature]\nname = \"T\"\nunit = \"{unit}\"\n{more}\n\
             [columns.volume_flow]\nname = \"Q\"\nunit = \"{flow}\"\n[[run]]\nfile = \"flow.csv\"\n"
        ))
    };
    for (unit, expected) in [("degC", [293.15, 298.15]), ("K", [20.0, 25.0]), ("degF", [479.67 / 1.8, 484.67 / 1.8])] {
        let recording = study(unit, "", "L/min ANR").and_then(|study| study.recordings()).expect("a table").remove(0);
        let read = &recording.column(Quantity::Temperature).expect("one").values;
        assert!(read.iter().zip(expected).all(|(read, exact)| (read - exact).abs() < 1e-9), "{read:?}");
        let flow = &recording.column(Quantity::VolumeFlow).expect("one").values;
        assert!((flow[0] - 1e-3).abs() < 1e-15 && (flow[1] - 2e-3).abs() < 1e-15, "{flow:?}");
    }
    let cooler = study("degC", "offset = \"2 K\"", "L/min ANR").and_then(|study| study.recordings()).expect("a table");
    assert!((cooler[0].column(Quantity::Temperature).expect("one").values[0] - 291.15).abs() < 1e-9);
    let error = study("degC", "deviation = \"0.1 degC\"", "L/min ANR").expect_err("no difference");
    assert_eq!(error.line, Some(7));
    assert!(error.to_string().contains("a difference is due"), "{error}");
    let error = study("degC", "", "L/min").expect_err("no air").to_string();
    assert!(error.contains("line 10") && error.contains("ISO 8778"), "{error}");
}

#[test]
fn sections_of_a_valve_are_read_to_si() {
    let folder = Folder::new("sections");
    folder.write("d.csv", "t,P\n0,1\n");
    let study = |kind: &str, section: &str| {
        folder.study(&format!(
            "[study]\nkind = \"{kind}\"\nscenario = \"m.toml\"\n[columns.time]\nname = \"t\"\nunit = \"s\"\n[[run]]\nfile = \"d.csv\"\n{section}\n"
        ))
    };
    let tank = "[tank]\nfind = \"valve\"\ntransfer = \"charge\"\nvolume = \"500 mL\"\ntemperature = \"20 degC\"\nbegins = \"10 ms\"\nwindows = 40";
    let read = study("tank", tank).expect("a study").tank.expect("a tank");
    assert_eq!((read.find, read.transfer), (TankTarget::Valve, Direction::Supply));
    assert_eq!((read.volume, read.temperature, read.begins, read.windows), (5e-4, Some(293.15), Some(0.01), Some(40)));
    let flow = study("steady-flow", "[flow]\nflow_path = \"exhaust\"\narea = \"3 mm^2\"").expect("a study").flow;
    assert_eq!((flow.flow_path, flow.area), (Direction::Exhaust, Some(3e-6)));
    let pulses = study("pulse-train", "[pulses]\nbegins = \"0.2 s\"\nthreshold = 2.5").expect("a study").pulses;
    assert_eq!((pulses.begins, pulses.threshold), (0.2, Some(2.5)));
    let fit = "[fit.\"valve.critical_ratio\"]\nfrom = 0.2\nto = 0.3";
    let horizon = "[search]\nhorizon = [\"0.1 s\"]";
    for (kind, section, key) in [
        ("tank", format!("{tank}\n{fit}"), "[fit.\"valve.critical_ratio\"]"),
        ("ring-down", fit.to_owned(), "[fit.\"valve.critical_ratio\"]"),
        ("flow-curve", "[search]\nrobust = 2.5".to_owned(), "`robust` in [search]"),
        ("pulse-train", "[search]\nmore_starts = 8".to_owned(), "`more_starts` in [search]"),
        ("steady-flow", "[search]\nmost_steps = 8".to_owned(), "`most_steps` in [search]"),
        ("ring-down", "[search]\nsegments = \"0.1 s\"".to_owned(), "`segments` in [search]"),
        ("hysteresis", horizon.to_owned(), "`horizon` in [search]"),
        ("force-map", horizon.to_owned(), "`horizon` in [search]"),
    ] {
        let error = study(kind, &section).expect_err("it is not read").to_string();
        let said = format!("a study of the kind \"{kind}\" does not read {key}");
        assert!(error.contains(&said) && error.contains("leave them out"), "{error}");
    }
    study("trajectories", &format!("{fit}\n{horizon}")).expect("it is read");
    for (kind, section) in [("force-map", "pulses"), ("flow-curve", "pulses"), ("trajectories", "flow")] {
        let error = study(kind, &format!("[{section}]")).expect_err("another kind").to_string();
        assert!(error.contains(&format!("`[{section}]` belongs to a study of the kind")), "{error}");
    }
}

/// Brackets and dots of TOML that are not meant.
#[test]
fn brackets_and_dots_that_are_not_meant_have_their_remedy() {
    let folder = Folder::new("study-syntax");
    let text = "[study]\nkind = \"trajectories\"\nscenario = \"m.toml\"\n[columns.time]\nname = \"t\"\nunit = \"s\"\n\
                [columns.\"flexor.length\"]\nname = \"L\"\nunit = \"m\"\n[[run]]\nfile = \"d.csv\"\n\
                [fit.\"load.mass\"]\nprior = { mean = \"5 lb\", deviation = \"1 lb\" }\n";
    for (right, wrong, remedy) in [
        ("[[run]]", "[run]", "write `[[run]]`, in two brackets"),
        ("[fit.\"load.mass\"]", "[fit.load.mass]", "`[fit.\"load.mass\"]`"),
        ("[columns.\"flexor.length\"]", "[columns.flexor.length]", "`[columns.\"flexor.length\"]`"),
    ] {
        let error = folder.study(&text.replace(right, wrong)).expect_err(wrong).to_string();
        assert!(error.contains(remedy), "{error}");
    }
    assert!(folder.study(text).is_ok());
}

/// A force map of 5 lengths and 4 pressures without times, as text, with one cell in another's place.
fn force_map(cell: Option<(usize, usize, &str)>) -> String {
    let mut text = "P,L,F\n".to_owned();
    for row in 0..20 {
        let (pressure, length) = (1.0 + (row / 5) as f64, 300.0 - 10.0 * (row % 5) as f64);
        let mut cells =
            [pressure.to_string(), length.to_string(), (200.0 * pressure - 2.0 * (300.0 - length)).to_string()];
        if let Some((_, column, value)) = cell.filter(|(of, ..)| *of == row) {
            cells[column] = value.to_owned();
        }
        text += &(cells.join(",") + "\n");
    }
    text
}

fn force_map_recording(folder: &Folder, table: &str, rule: &str) -> Result<Recording, StudyError> {
    folder.write("map.csv", table);
    let text = format!(
        "[study]\nkind = \"force-map\"\nscenario = \"m.toml\"\n[columns.gauge_pressure]\nname = \"P\"\nunit = \"bar\"\n{rule}\n\
         [columns.length]\nname = \"L\"\nunit = \"mm\"\n{rule}\n[columns.tension]\nname = \"F\"\nunit = \"N\"\n{rule}\n[[run]]\nfile = \"map.csv\"\n"
    );
    folder.study(&text)?.recordings().map(|mut all| all.remove(0))
}

/// A slack muscle reads as far above zero as below it. Three standard deviations of that noise are no tension, be they stated or taken from
/// the readings below zero; what a rig pushes with is no noise.
#[test]
fn noise_of_a_slack_muscle_is_no_tension() {
    let folder = Folder::new("slack-noise");
    let mut noise = Noise::new(5);
    // Every third place is slack; the others hold 6 N and more.
    let tensions: Vec<f64> =
        (0..60).map(|row| if row % 3 == 0 { 0.0 } else { 5.0 + f64::from(row) } + 0.09 * noise.normal()).collect();
    let slack = |tensions: &[f64], rule: &str| {
        let line = |(row, tension): (usize, &f64)| format!("{},{},{tension}\n", 1 + row / 10, 300 - 3 * (row % 10));
        let table: String = tensions.iter().enumerate().map(line).collect();
        folder.write("map.csv", &format!("P,L,F\n{table}"));
        let text = format!(
            "[study]\nkind = \"force-map\"\nscenario = \"m.toml\"\n[columns.gauge_pressure]\nname = \"P\"\nunit = \"bar\"\n\
             [columns.length]\nname = \"L\"\nunit = \"mm\"\n[columns.tension]\nname = \"F\"\nunit = \"N\"\n{rule}\n[[run]]\nfile = \"map.csv\"\n"
        );
        let recording = folder.study(&text).and_then(|study| study.recordings()).expect("a recording").remove(0);
        let tension = recording.column(Quantity::Tension).expect("one");
        (tension.slack.clone(), notes(&recording))
    };
    let every_third: Vec<bool> = (0..60).map(|row| row % 3 == 0).collect();
    assert!(tensions.iter().zip(&every_third).any(|(tension, slack)| *slack && *tension > 0.0));
    let (seen, said) = slack(&tensions, "");
    assert_eq!(seen, every_third);
    assert!(said.contains("20 readings of the tension are at or below "), "{said}");
    let noise =
        said.split("three times the noise of ").nth(1).and_then(|rest| rest.split(' ').next()?.parse::<f64>().ok());
    // By some ten readings below zero: known to a quarter, and 0.09 N lies within twice that.
    assert!(noise.is_some_and(|noise| (noise / 0.09 - 1.0).abs() < 0.5), "{said}");
    let (stated, said) = slack(&tensions, "deviation = \"0.09 N\"");
    assert_eq!(stated, every_third);
    assert!(said.contains("at or below 0.27 N, three times the noise of 0.09 N"), "{said}");
    // What the study says goes before: of one reading and no more.
    let least = tensions.iter().copied().fold(f64::INFINITY, f64::min);
    let (few, said) = slack(&tensions, &format!("slack = \"{least} N\""));
    assert_eq!(few.iter().filter(|slack| **slack).count(), 1, "{said}");
    // Pushes of a fifth of the largest tension.
    let pushes: Vec<f64> = tensions.iter().map(|tension| if *tension < 1.0 { -12.0 } else { *tension - 5.5 }).collect();
    let (of_pushes, said) = slack(&pushes, "");
    assert_eq!(of_pushes, every_third);
    assert!(
        said.contains("at or below 0 N: slack") && pushes.iter().any(|tension| (0.0..1.0).contains(tension)),
        "{said}"
    );
}

#[test]
fn a_bad_cell_is_refused_with_its_place_and_left_out_on_request() {
    let folder = Folder::new("cells");
    let whole = force_map_recording(&folder, &force_map(None), "").unwrap_or_else(|error| panic!("{error}"));
    assert!(!notes(&whole).contains("cannot be"), "{}", notes(&whole));
    let heads = ["P", "L", "F"];
    for (row, column, value) in [
        (7, 2, "1e8"),
        (7, 2, "-1e8"),
        (0, 2, "1e300"),
        (19, 1, "1e5"),
        (3, 1, "1e-3"),
        (3, 1, "0"),
        (3, 1, "-290"),
        (11, 0, "1e5"),
        (12, 0, "-6e4"),
    ] {
        let error = force_map_recording(&folder, &force_map(Some((row, column, value))), "").expect_err(value);
        // The head is the first line.
        assert_eq!(error.line, Some(row + 2), "{error}");
        assert!(error.to_string().contains(&format!("column `{}`", heads[column])), "{error}");
        assert!(error.remedy.contains("drop_outliers"), "{error}");
        let without = force_map_recording(&folder, &force_map(Some((row, column, value))), "drop_outliers = true");
        let without = without.unwrap_or_else(|error| panic!("{error}"));
        assert!(notes(&without).contains(&format!("(line {})", row + 2)), "{}", notes(&without));
        for (of, kept) in without.sheets[0].columns.iter().zip(&whole.sheets[0].columns) {
            let differ = (0..20).filter(|place| of.values[*place].to_bits() != kept.values[*place].to_bits());
            let expected =
                if of.quantity == kept.quantity && heads[column] == head(of.quantity) { vec![row] } else { vec![] };
            assert_eq!(differ.collect::<Vec<_>>(), expected, "{:?} for {value}", of.quantity);
        }
    }
    // What many cells say is no slip, and what is small may be: a muscle that is almost slack, a pressure of zero.
    for (row, column, value) in
        [(7, 2, "0.001"), (7, 2, "0"), (11, 0, "0"), (11, 0, "0.0001"), (11, 0, "40"), (3, 1, "900")]
    {
        let read = force_map_recording(&folder, &force_map(Some((row, column, value))), "");
        assert!(read.is_ok(), "{value}: {}", read.unwrap_err());
    }
}

fn head(of: Quantity) -> &'static str {
    match of {
        Quantity::GaugePressure => "P",
        Quantity::Length => "L",
        _ => "F",
    }
}

#[test]
fn over_time_a_lone_spike_and_a_jump_in_time_are_refused() {
    let folder = Folder::new("spikes");
    let spike = |rows: std::ops::Range<usize>, value: &'static str| {
        table(60, move |row| match rows.contains(&row) {
            true => format!("{},{},{value}", 0.01 * row as f64, 90.0 + (0.7 * row as f64).sin()),
            false => even(row),
        })
    };
    let error = folder.recording(&spike(30..31, "1e8"), "", "").expect_err("a spike");
    assert_eq!(error.line, Some(32), "{error}");
    // An impact is a few readings on end, and 300 times as large as the rest.
    assert!(folder.recording(&spike(30..33, "6000"), "", "").is_ok());
    assert!(folder.recording(&spike(30..31, "6000"), "", "").is_ok());
    let late = table(60, |row| if row == 59 { "1e8,90,20".to_owned() } else { even(row) });
    let error = folder.recording(&late, "", "").expect_err("a jump");
    assert!(error.line == Some(61) && error.to_string().contains("the time jumps"), "{error}");
    let early = table(60, |row| if row == 0 { "-1e8,90,20".to_owned() } else { even(row) });
    let error = folder.recording(&early, "", "").expect_err("a jump");
    assert!(error.line == Some(2) && error.to_string().contains("the time jumps"), "{error}");
    // A pause is none.
    let pause = table(60, |row| if row < 30 { even(row) } else { format!("{},90,20", 100.0 + 0.01 * row as f64) });
    assert!(folder.recording(&pause, "", "").is_ok());
}

/// A spreadsheet's Windows-1252, with an umlaut in the head of a column that the study does not use, and UTF-16.
#[test]
fn text_in_another_encoding_is_refused_with_what_to_do() {
    let folder = Folder::new("encoding");
    folder.recording(&table(20, even), "", "").unwrap_or_else(|error| panic!("{error}"));
    let text = table(20, even).replacen("t,L,F", "t,L,F,L\u{e4}nge", 1);
    let latin: Vec<u8> = text.chars().map(|letter| letter as u8).collect();
    let wide: Vec<u8> = std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    for bytes in [latin, wide] {
        std::fs::write(folder.0.join("data.csv"), bytes).expect("a file");
        let text = "[study]\nkind = \"trajectories\"\nscenario = \"m.toml\"\n[columns.time]\nname = \"t\"\nunit = \"s\"\n\
                    [columns.length]\nname = \"L\"\nunit = \"mm\"\n[[run]]\nfile = \"data.csv\"\n";
        let problem = folder.study(text).and_then(|study| study.recordings()).expect_err("no UTF-8").to_string();
        assert!(problem.contains("its text is not UTF-8; save it as UTF-8"), "{problem}");
    }
}
