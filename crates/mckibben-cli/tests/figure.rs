//! The figures of runs: which panels, curves, strips and marks they have, columns by name, and several files over each other.

use crate::common::{Folder, of_repository};
use mckibben_plot::{Colour, Dash, Extent, Figure, Reference};
use mckibben_run::axis::TrajectoryAxis;
use mckibben_run::figure::{self, Picture, Request};
use mckibben_run::run::{Finished, Ready};
use mckibben_run::settle::End;
use mckibben_scenario::Document;

const PULSED: &str = r#"
    [actuator]
    preset = "colbrunn-2001"
    [load]
    kind = "hanging-mass"
    mass = "5 lb"
    [valve]
    preset = "matrix-821"
    [supply]
    gauge_pressure = "60 psi"
    [command]
    kind = "pwm"
    frequency = "10 Hz"
    duty = 0.4
    [run]
    duration = "1 s"
"#;

fn run(text: &str) -> Finished {
    let document = Document::parse(text, "muscle.toml").expect("TOML");
    Ready::of(&document).expect("a scenario").run(&document, End::Duration, &mut |_| Ok(())).expect("a run").0
}

fn example(name: &str) -> Finished {
    run(&std::fs::read_to_string(of_repository(&format!("examples/{name}.toml"))).expect("an example"))
}

fn usual(run: &Finished) -> Picture {
    run.figure(TrajectoryAxis::Time, "").expect("a figure")
}

fn one(picture: Picture) -> Figure {
    match picture {
        Picture::One(figure) => *figure,
        Picture::SideBySide(_) => panic!("two figures"),
    }
}

fn panels(figure: &Figure) -> Vec<&str> {
    figure.panels.iter().map(|panel| panel.y.label.as_str()).collect()
}

#[test]
fn every_kind_of_run_has_the_usual_panels() {
    let of = |name: &str| usual(&example(name)).figures()[0].clone();
    assert_eq!(panels(&one(usual(&run(PULSED)))), ["length", "gauge pressure", "tension"]);
    assert_eq!(panels(&of("antagonistic-joint")), ["angle", "gauge pressure", "tension"]);
    assert_eq!(panels(&of("control/joint-air-mass"))[..2], ["angle", "stiffness"]);
    assert!(panels(&of("control/joint-air-mass")).contains(&"air mass"));
    assert!(panels(&of("plant/bottle")).contains(&"supply, gauge"));
    assert_eq!(panels(&of("plant/leg")), ["angle", "gauge pressure", "tension"]);
}

/// Between a mechanism and its tendon a muscle has a length that neither shows.
#[test]
fn a_muscle_on_a_tendon_in_a_mechanism_has_a_panel_of_its_length() {
    let text = "[supply]\ngauge_pressure = \"60 psi\"\n[valve]\nkind = \"two-way\"\nflow_area = \"0.5 mm^2\"\n[command]\n\
                kind = \"pwm\"\nfrequency = \"10 Hz\"\nduty = 0.5\n[mechanism]\nkind = \"mass\"\nmass = \"2 kg\"\n\
                position = \"100 mm\"\n[actuators.a]\npreset = \"colbrunn-2001\"\n\
                tendon = { stiffness = \"8 N/mm\", rest_length = \"5 mm\" }\n[run]\nduration = \"0.3 s\"\n";
    let figure = usual(&run(text)).figures()[0].clone();
    assert_eq!(panels(&figure), ["position", "length", "load distance", "gauge pressure", "tension"]);
}

/// What a muscle of a chain holds, it lets go of with the joints: the mark has a value on their curve.
#[test]
fn a_chain_that_breaks_away_is_marked_on_the_curve_of_its_joint() {
    let figure = usual(&example("plant/hose-joint")).figures()[0].clone();
    let is_it = |marks: &&mckibben_plot::Marks| {
        (marks.symbol, marks.filled) == (mckibben_plot::Symbol::Circle, false) && !marks.x.is_empty()
    };
    let marks: Vec<_> = figure.panels.iter().flat_map(|panel| &panel.marks).filter(is_it).collect();
    assert!(!marks.is_empty() && marks.iter().all(|marks| marks.y.len() == marks.x.len()), "{marks:?}");
}

#[test]
fn what_does_not_change_is_a_note_and_not_a_panel() {
    let figure = one(usual(&example("isometric-charge")));
    assert!(!panels(&figure).contains(&"length") && figure.note.contains("length: constant, "), "{}", figure.note);
    // A sealed muscle on a constant length has nothing that changes: one level line is left, in a range that says how large it is.
    let still = "[load]\nkind = \"isometric\"\n[initial]\nlength = \"3.5 in\"\ngauge_pressure = \"60 psi\"\n[run]\nduration = \"1 s\"";
    let figure = one(usual(&run(still)));
    let axis = &figure.panels[0].y;
    let span = axis.max.expect("an end") - axis.min.expect("an end");
    assert!(figure.panels.len() == 1 && span > 1e-2 * axis.max.unwrap(), "{axis:?}");
}

#[test]
fn agonist_and_antagonist_have_separate_colours_everywhere() {
    let figure = one(usual(&example("antagonistic-joint")));
    let (agonist, antagonist) = (Colour::Category(0), Colour::Category(1));
    for panel in &figure.panels[1..] {
        let colours: Vec<Colour> =
            panel.series.iter().filter(|series| !series.x.is_empty()).map(|series| series.colour).collect();
        assert_eq!(colours, [agonist, antagonist], "{}", panel.y.label);
    }
    // Both valves have a strip, also the antagonist's, and nothing is painted over the panels.
    for panel in &figure.panels {
        assert_eq!(panel.strips.iter().map(|strip| strip.colour).collect::<Vec<_>>(), [agonist, antagonist]);
        assert!(panel.spans.iter().all(|span| matches!(&span.length_regime, Extent::Horizontal(of) if of.is_empty())));
    }
    assert!(figure.panels[0].series.iter().all(|series| series.colour == Colour::Neutral), "the joint is neither");
}

#[test]
fn set_points_are_dotted_in_the_colour_of_what_they_are_of() {
    for (name, quantity) in [("control/joint-air-mass", "air mass"), ("plant/controlled", "gauge pressure")] {
        let picture = usual(&example(name));
        let panel = picture.figures()[0].panels.iter().find(|panel| panel.y.label == quantity).expect(quantity);
        let drawn: Vec<_> = panel.series.iter().filter(|series| !series.x.is_empty()).collect();
        let dotted: Vec<_> = drawn.iter().filter(|series| series.dash == Some(Dash::Dotted)).collect();
        assert!(!dotted.is_empty(), "{name}");
        for set_point in dotted {
            let of = drawn.iter().filter(|series| series.colour == set_point.colour);
            assert!(of.count() >= 2, "{name}: a set point without its curve");
        }
    }
}

/// Three muscles of two lengths: each line has the colour and the name of its curve, and what two share the names of both.
#[test]
fn limits_of_several_muscles_are_distinct() {
    let figure = one(usual(&example("plant/bottle")));
    let panel = figure.panels.iter().find(|panel| panel.y.label == "length").expect("a panel");
    let lines = panel.references.iter().filter_map(|reference| match reference {
        Reference::Horizontal { label, colour, .. } => Some((label.as_str(), *colour)),
        Reference::Vertical { .. } => None,
    });
    let lines: Vec<(&str, Colour)> = lines.collect();
    let of = |name: &str| panel.series.iter().find(|series| series.label == name).expect("a curve").colour;
    for words in ["max length, long", "min length, long"] {
        assert!(lines.contains(&(words, of("long"))), "{lines:?}");
    }
    assert!(lines.contains(&("max length, paper and thick", Colour::Neutral)), "{lines:?}");
    // One muscle has its limits without a name.
    let alone = one(usual(&example("fill-hold-exhaust")));
    let named = alone.panels.iter().flat_map(|panel| &panel.references);
    let is_plain = |of: &Reference| matches!(of, Reference::Horizontal { label, .. } if !label.contains(','));
    assert!(named.clone().count() > 0 && named.clone().all(is_plain), "{:?}", named.collect::<Vec<_>>());
}

/// Two muscles fall onto their taut braids at once: a kind of which there are too many about an instant is counted in the note.
#[test]
fn marks_do_not_pile_up() {
    let run = example("plant/bottle");
    let figure = one(usual(&run));
    let mut times: Vec<f64> = figure.panels[0].marks.iter().flat_map(|marks| marks.x.iter().copied()).collect();
    times.sort_by(f64::total_cmp);
    let most =
        times.iter().map(|from| times.iter().filter(|at| (*from..=from + 0.02 * 3.2).contains(at)).count()).max();
    assert!(most <= Some(8) && most > Some(1), "{times:?}");
    assert!(figure.note.contains("not marked: ") && figure.note.contains("rebound"), "{}", figure.note);
}

/// Every event is on the figure: as a mark, as the end of a strip, or by its number in the note.
#[test]
fn no_event_is_dropped_silently() {
    for name in ["antagonistic-joint", "line/tank", "paper/fig-12", "plant/arm", "friction/lugre", "tendon"] {
        let run = example(name);
        let picture = usual(&run);
        let figure = &picture.figures()[0];
        let note = match &picture {
            Picture::One(figure) => &figure.note,
            Picture::SideBySide(beside) => &beside.note,
        };
        let log = run.log();
        let mut counts = std::collections::BTreeMap::<&str, usize>::new();
        log.rows.iter().for_each(|row| *counts.entry(&row[0]).or_default() += 1);
        let strips: usize = figure.panels[0].strips.iter().map(|strip| strip.intervals.len()).sum();
        for (kind, count) in counts {
            let named = figure.panels.iter().flat_map(|panel| &panel.marks).find(|marks| marks.label == kind);
            let marked = |of: &mckibben_plot::Marks| {
                let all = figure.panels.iter().flat_map(|panel| &panel.marks);
                all.filter(|marks| (marks.symbol, marks.filled) == (of.symbol, of.filled))
                    .map(|marks| marks.x.len())
                    .sum()
            };
            let marked: usize = named.map_or(0, marked);
            let noted = note.contains(&format!("×\u{a0}{kind}"));
            assert!(
                marked == count || noted || (kind == "valve" && strips > 0),
                "{name}: {kind} {count} {marked} {note}"
            );
        }
    }
}

#[test]
fn fast_pulses_are_an_envelope_that_contains_every_sample() {
    let run = example("paper/fig-13");
    let Picture::SideBySide(beside) = usual(&run) else { panic!("no detail") };
    let panel = beside.figures[0].panels.iter().find(|panel| panel.y.label == "gauge pressure").expect("a panel");
    let Some(Extent::Between { x, lower, upper }) = panel.spans.iter().map(|span| &span.length_regime).next() else {
        panic!("no envelope")
    };
    let columns = run.columns().expect("columns");
    let numbers = |name: &str| match &columns.iter().find(|column| column.name == name).expect(name).values {
        mckibben_run::record::Values::Numbers(numbers) => numbers.clone(),
        mckibben_run::record::Values::Words(_) => panic!("words"),
    };
    let mut outside = 0;
    for (time, gauge) in numbers("time_s").iter().zip(numbers("gauge_pressure_pa")) {
        let node = x.partition_point(|at| at <= time).clamp(1, x.len() - 1);
        let part = (time - x[node - 1]) / (x[node] - x[node - 1]);
        let at = |edge: &[f64]| edge[node - 1] + part * (edge[node] - edge[node - 1]);
        // Between the points of the figure a smooth peak may be a little higher.
        outside += usize::from(!(at(lower) - 1e-3..=at(upper) + 1e-3).contains(&(gauge * 1e-5)));
    }
    assert_eq!(outside, 0);
    let right = &beside.figures[1];
    assert!(right.x.min.unwrap() > 0.9 * right.x.max.unwrap(), "the detail is the end");
    assert!(right.panels.iter().all(|panel| panel.spans.is_empty()));
}

/// A muscle that is stretched at 5 m/s for 2 ms and let back: friction adds to its tension up to the instant at which the motion turns,
/// and takes from it behind. Curves have both values at that instant, so that the peak is that of the run.
#[test]
fn a_curve_reaches_the_value_just_before_a_jump() {
    let text = r#"
        [actuator]
        preset = "colbrunn-2001"
        [load]
        kind = "prescribed-motion"
        time = ["0 s", "1 s", "1.002 s", "1.004 s", "10 s"]
        table_length = ["85 mm", "85 mm", "95 mm", "85 mm", "85 mm"]
        [initial]
        gauge_pressure = "2 bar"
        [run]
        duration = "10 s"
    "#;
    let run = run(text);
    // A nanosecond before it turns, on the way there, and as long after.
    let columns = run.columns_at(&[1.002 - 1e-9, 1.002 + 1e-9]).expect("columns");
    let tension = columns.iter().find(|column| column.name == "tension_n").expect("a tension");
    let mckibben_run::record::Values::Numbers(tension) = &tension.values else { panic!("words") };
    assert!(tension[0] > tension[1] + 10.0, "{tension:?}");
    let figure = one(usual(&run));
    let panel = figure.panels.iter().find(|panel| panel.y.label == "tension").expect("a panel");
    let curve = panel.series.iter().find(|series| !series.x.is_empty()).expect("a curve");
    let greatest = curve.y.iter().copied().fold(0.0, f64::max);
    assert!((greatest - tension[0]).abs() < 1e-5 * tension[0], "{greatest} {tension:?}");
    assert!(curve.x.is_sorted() && curve.x.windows(2).all(|pair| pair[0] < pair[1]));
    // So does the summary, and what is written of the figure.
    let summary = run.figures().expect("figures").summary();
    let value = |name: &str| summary.numbers.iter().find(|number| number.name == name).expect(name).value;
    assert!((value("tension.max") - tension[0]).abs() < 1e-5 * tension[0], "{}", value("tension.max"));
    let folder = Folder::new("jump");
    folder.file("jump.toml", text);
    let output = folder.mckibben().args(["simulate", "jump.toml", "-q", "--plot", "jump.html"]).output().expect("runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = std::fs::read_to_string(folder.path("jump.html")).expect("a page");
    let numbers = page.split(['[', ',', ']']).filter_map(|word| word.parse::<f64>().ok());
    let near = numbers.filter(|number| (number - tension[0]).abs() < 1e-4 * tension[0]).count();
    assert!(near > 0, "the page has no {}", tension[0]);
}

#[test]
fn columns_are_drawn_by_name_one_panel_for_each_quantity() {
    let line = example("line/hanging-mass");
    let names = ["hose_gauge_pressure_pa", "temperature_k", "gauge_pressure_pa"].map(str::to_owned);
    let request = Request { over: TrajectoryAxis::Time, title: "", columns: &names };
    let picture = figure::draw(&[("", &line)], &request).expect("a figure");
    assert_eq!(panels(&picture.figures()[0]), ["gauge pressure", "temperature"]);
    for (name, columns) in [
        ("antagonistic-joint", "antagonist_temperature_k,torque_n_m"),
        ("plant/arm", "biceps.temperature_k,tank.gauge_pressure_pa"),
    ] {
        let names: Vec<String> = columns.split(',').map(str::to_owned).collect();
        let request = Request { columns: &names, ..request };
        let picture = figure::draw(&[("", &example(name))], &request).expect("a figure");
        assert_eq!(picture.figures()[0].panels.len(), 2, "{name}");
    }
    let unknown = ["temprature_k".to_owned()];
    let failure = figure::draw(&[("", &line)], &Request { columns: &unknown, ..request }).expect_err("no column");
    let message = failure.to_string();
    assert!(message.contains("temprature_k") && failure.code() == 2, "{message}");
}

#[test]
fn several_files_are_drawn_over_each_other() {
    let folder = Folder::new("compare");
    folder.file("light.toml", &PULSED.replace("5 lb", "2 kg"));
    folder.file("heavy.toml", PULSED);
    let both = ["simulate", "light.toml", "heavy.toml"];
    let output = folder.mckibben().args(both).args(["--plot", "both.svg"]).output().expect("runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let places = ["light.toml", "heavy.toml", "wrote both.svg"].map(|words| text.find(words).expect(words));
    assert!(places.is_sorted(), "{text}");
    let svg = std::fs::read_to_string(folder.path("both.svg")).expect("a figure");
    assert!(svg.contains("load.mass = 2 kg") && svg.contains("load.mass = 5 lb"));
    for option in [&["--output", "run.csv"][..], &["--events"], &["--format", "json"], &["--events-output", "e.csv"]] {
        let output = folder.mckibben().args(both).args(option).output().expect("runs");
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(option[0]) && message.contains("one file at a time"), "{message}");
    }
    let output =
        folder.mckibben().args(["curves", "light.toml", "heavy.toml", "--plot", "curves.svg"]).output().expect("runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(folder.path("curves.svg").exists());
    let output = folder.mckibben().args(["curves", "light.toml", "heavy.toml", "-o", "c.csv"]).output().expect("runs");
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn a_page_for_a_browser_is_one_file() {
    let folder = Folder::new("page");
    folder.file("muscle.toml", PULSED);
    let output =
        folder.mckibben().args(["simulate", "muscle.toml", "-q", "--plot", "run.html"]).output().expect("runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = std::fs::read_to_string(folder.path("run.html")).expect("a page");
    assert!(
        page.contains("A muscle under a load of 2.268 kg, pulsed at 10 Hz and 40 %") && page.contains("\"panels\":[")
    );
    assert!(!page.contains("src=") && !page.contains("href="), "it loads nothing");
}
